"""Warnings of a comparison with measured modes: the numbers are put in."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearwhine.housing.correlation.comparison import Comparison, ModePair, UnpairedMode
from gearwhine.housing.modal_test import comparison_warnings

HERTZ = 2.0 * np.pi


def compared(*errors: float, chance: float | None = None, unpaired: tuple[float, ...] = ()) -> Comparison:
    """Modes of 100, 200 ... Hz, measured lower by errors in percent; and further measured ones [Hz]."""
    frequencies = HERTZ * 100.0 * np.arange(1.0, len(errors) + 1.0)
    pairs = tuple(
        ModePair(float(model / (1.0 + 0.01 * error)), float(model), number, number, None)
        for number, (model, error) in enumerate(zip(frequencies, errors, strict=True), start=1)
    )
    lone = tuple(UnpairedMode(len(pairs) + n, HERTZ * hertz) for n, hertz in enumerate(unpaired, start=1))
    return Comparison(pairs, "nearest", "", (0.0, 1.0), unpaired_measured=lone, chance_error_percent=chance)


def told(
    comparison: Comparison, errors: Any = None, frequencies: Any = (), cut: tuple[int, ...] = ()
) -> dict[str, Any]:
    """Warnings by their names; those of modes measured at 300, 310 and 320 Hz, some of which the band cuts."""
    modes: Any = SimpleNamespace(discretisation_errors=errors, frequencies=HERTZ * np.array(frequencies))
    measured: Any = SimpleNamespace(cut_by_band=cut, frequencies=HERTZ * np.array([300.0, 310.0, 320.0]))
    return {one["name"]: one for one in comparison_warnings(comparison, modes, measured)}


def test_modes_without_a_partner_and_weak_pairs_are_told() -> None:
    """Errors of 3 and 4 % are 3.5 % rms: half of 7.1 % at random is more, half of 7 % is less."""
    warned = told(compared(3.0, 4.0, chance=7.1, unpaired=(301.5, 425.25)))
    assert list(warned) == ["unpaired modes", "weak pairing"]
    assert warned["unpaired modes"]["message"] == (
        "the model has fewer modes than were measured; without a partner: 3 (301.5 Hz), 4 (425.25 Hz)"
    )
    assert warned["unpaired modes"]["modes"] == 2
    weak = (
        "paired by nearest frequencies, which is weak evidence: a frequency at random in the band is 7.1 % from a mode "
        "of the model (rms), the measured ones are 3.5 %"
    )
    assert warned["weak pairing"]["message"] == weak
    assert warned["weak pairing"]["rms_error_percent"] == pytest.approx(np.sqrt(12.5))
    assert warned["weak pairing"]["chance_error_percent"] == 7.1
    worse = told(compared(3.0, 4.0, chance=7.0))["weak pairing"]["message"]
    assert worse == weak.replace("7.1", "7") + "; such errors do not tell this model from another: measure shapes"
    assert told(compared(3.0, 4.0)) == {}


def test_edges_of_the_band_and_pairs_that_hang_on_the_mesh_are_told() -> None:
    """The mode at 200 Hz may fall to 184 Hz, below that at 185 Hz; those at 100 and 300 Hz stay alone."""
    assert told(compared(1.0), cut=(1,))["edge of the band"]["message"] == (
        "an edge of the measured band cuts the half-power width of measured mode 2 (310 Hz), whose shape and damping "
        "are less sure; responses measured further tell"
    )
    both = told(compared(1.0), cut=(0, 2))["edge of the band"]
    assert "measured modes 1 (300 Hz), 3 (320 Hz), whose" in both["message"]
    assert both["modes"] == [1, 3]
    errors, frequencies = np.array([0.01, 0.08, 0.01, 0.0]), (100.0, 200.0, 300.0, 185.0)
    by_mesh = told(compared(1.0, 1.0, 1.0), errors, frequencies)["pairs by the mesh"]
    assert by_mesh["message"] == (
        "pairs may change with the mesh: model mode 2 may change places with neighbours, which lie nearer than the "
        "estimated errors by the mesh; a smaller mesh_size tells"
    )
    assert by_mesh["modes"] == [2]
    assert told(compared(1.0, 1.0, 1.0), 0.5 * errors, frequencies) == {}
    # A mode of 300 Hz that may be 285 Hz leaves the measured 297 Hz to another, of 296 Hz and no error.
    nearer = told(compared(0.0, 0.0, 1.0), np.array([0.0, 0.0, 0.05, 0.0]), (100.0, 200.0, 300.0, 301.0))
    assert nearer["pairs by the mesh"]["modes"] == [3]
