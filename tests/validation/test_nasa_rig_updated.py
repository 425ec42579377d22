"""The housing of the gear noise rig after updating against Table II of NASA TM-104434 (Choy et al., 1991).

Fitted, not predicted: eighteen numbers to these eight frequencies, a clear choice of eight and the count of modes. What
is held here is that the housing in the case has, on a mesh made anew, what its update reports.
"""

from collections.abc import Callable

import numpy as np
import pytest

from gearwhine.case import load_case
from gearwhine.from_case import given_housing
from gearwhine.solve.comparison import compare_measured
from gearwhine.solve.housing_modes import solve_housing

TABLE_II = "NASA TM-104434 (Choy et al., 1991), Table II, housing modes, after updating"
MEASURED_HZ = [658.0, 1049.0, 1710.0, 2000.0, 2276.0, 2536.0, 2722.0, 2962.0]

pytestmark = pytest.mark.slow


@pytest.mark.slow
def test_dominant_modes_after_updating(
    published: Callable[..., None], remark: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    # Static attachments of bearings would take two fifths of the time, and change no mode.
    monkeypatch.setattr(given_housing, "bearing_places", lambda *tables: {})
    case = load_case("nasa-gear-noise-rig-updated").case
    solved = solve_housing(case)
    comparison = compare_measured(case.measured, solved).comparison
    remark(
        TABLE_II,
        "Fitted, not predicted: eighteen numbers of a box to these eight frequencies, a clear choice of eight and the "
        "count of modes. Other boxes meet them nearly as well; see docs/updating.md.",
    )
    errors = []
    for number, (measured, pair) in enumerate(zip(MEASURED_HZ, comparison.pairs, strict=True), start=1):
        model_hz = pair.model / (2.0 * np.pi)
        published(TABLE_II, f"measured mode {number} (ours {pair.mode})", measured, model_hz, "Hz", rel=0.01)
        errors.append(model_hz / measured - 1.0)
    assert np.sqrt(np.mean(np.square(errors))) < 0.005
    published(
        TABLE_II, "number of modes below 3 kHz", 25, np.count_nonzero(solved.modes.frequencies_hz < 3000.0), abs=2
    )
    assert comparison.gap is not None
    assert comparison.gap >= 0.1
    assert comparison.measures_agree
