"""Results of `steady` of a machine whose carriers turn: period, proofs, and lines of the turns of the carrier."""

from typing import Any

import numpy as np
import pytest

from gearwhine.coupling.analyses.steady_state import solve_steady
from gearwhine.results.steady_state import curve_sentences, sections, steady_document
from tests.machines.turning_set import TEETH, turning_machine


@pytest.mark.slow
def test_a_settled_motion_has_its_period_and_proofs() -> None:
    machine = turning_machine((900.0, 1300.0))
    document = steady_document("turning", solve_steady(machine))
    turn = 2.0 * np.pi / machine.speeds["carrier"]
    (motion,) = document["motions"]
    assert document["method"] == "settled"
    assert motion["period_s"] == pytest.approx(turn, rel=1e-9)
    assert motion["stability"] == "stable"
    assert 0.0 < motion["largest_multiplier"] + motion["largest_multiplier_error"] < 1.0
    assert motion["residual"] < 1e-4
    assert motion["error"] < 1e-2
    assert "switches" not in motion  # which steps of a time integration do not count
    lines = motion["sensors"][0]["lines"]
    orders = np.array([line["frequency_hz"] for line in lines]) * turn
    assert orders == pytest.approx(np.round(orders), abs=1e-6)
    # Equal planets keep every third line: of 83 teeth of the ring 84 and 165 or 166 with its neighbours.
    ring = TEETH[0] + 2 * TEETH[1]
    assert round(orders[0]) % 3 == 0
    assert min(abs(orders[0] - ring), abs(orders[0] - 2 * ring)) <= 2.0
    (section,) = sections(document)
    said = next(part for part in section.content if isinstance(part, str) and "period" in part and "closes" in part)
    assert said.endswith("with steps half as long")
    assert f"(largest Floquet multiplier {motion['largest_multiplier']:.4g} ± " in said
    # The same motion, did its largest multiplier's interval contain one.
    open_ = motion | {"stable": False, "stability": "not decided", "instability": None}
    (section,) = sections(document | {"motions": [open_]})
    assert any(isinstance(part, str) and "stability not decided (largest" in part for part in section.content)


def test_points_over_speed_whose_stability_is_open_are_counted_apart() -> None:
    curve: dict[str, Any] = {
        "speed_rpm": [1000.0, 1500.0, 2000.0, 2500.0],
        "stable": [True, False, False, False],
        "stability": ["stable", "not decided", "unstable", "not decided"],
        "ending": "end",
        "gear_pairs": [],
        "bifurcations": [],
    }
    (sentence,) = curve_sentences(curve)
    assert sentence == "Followed from 1000 to 2500 rpm in 4 points, 1 of them unstable, 2 not decided"
    (sentence,) = curve_sentences(curve | {"stability": ["stable", "unstable", "unstable", "unstable"]})
    assert sentence == "Followed from 1000 to 2500 rpm in 4 points, 3 of them unstable"
