"""Internal gears of a case: the keys, what `check` and `gears` say and draw of them, and what is refused."""

import math
import tomllib
from typing import Any

import numpy as np
import pytest

from gearwhine.case import CaseError, dump_case, parse_case
from gearwhine.coupling.analyses.gear_pairs import solve_over_torques
from gearwhine.figures.gears import draw_tooth_pair
from gearwhine.from_case.machine import solve_gears
from gearwhine.results import check
from gearwhine.results.check import check_document
from gearwhine.results.gears import gears_document, sections
from gearwhine.solve.gear_pairs import analyse_pairs

STEEL = {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}
TOOTH = {"module": "2 mm", "face_width": "20 mm", "material": "steel"}
RELIEF = {"tip_relief": {"amount": "8 um", "length": "2 mm"}}


def case_of(ring: dict[str, Any] | None = None, pinion: dict[str, Any] | None = None, **pair: Any) -> Any:
    document = {
        "title": "ring and pinion",
        "material": {"steel": STEEL},
        "gear": [
            {"name": "pinion", "teeth": 20} | TOOTH | RELIEF | (pinion or {}),
            {"name": "ring", "teeth": -60, "addendum": 0.75, "rim": "10 mm"} | TOOTH | RELIEF | (ring or {}),
        ],
        "gear_pair": [{"driver": "pinion", "driven": "ring"} | pair],
        "operation": {"speed": "1500 rpm", "torque": "50 N*m"},
    }
    return parse_case(document, source="gears.toml")


def test_both_ways_of_saying_that_a_gear_is_internal() -> None:
    negative, said = case_of(), case_of({"teeth": 60, "internal": True})
    for case in (negative, said, case_of({"internal": True}), parse_case(tomllib.loads(dump_case(said)))):
        gear = case.parts.gears["ring"]
        assert gear.teeth == -60
        assert gear.rim_thickness == 10e-3
        assert gear.outer_radius == pytest.approx(72.5e-3)
    by_base_radius = case_of({"module": None, "base_radius": f"{60.0 * math.cos(math.radians(20.0))} mm"})
    assert by_base_radius.parts.gears["ring"].module == pytest.approx(2e-3)
    assert case_of(centre_distance="39.9 mm").parts.pair_geometries[0].working_centre_distance == -39.9e-3


@pytest.mark.parametrize(
    ("ring", "words"),
    [
        ({"teeth": -4}, "gear[1].teeth (gear \"ring\"): expected a whole number from 5 to 2000, or -2000 to -5"),
        ({"teeth": 4}, "expected a whole number from 5 to 2000, got 4"),
        ({"internal": False}, "gear[1].internal (gear \"ring\"): expected true, or left out, with a"),
        ({"bore": "20 mm"}, "gear[1].bore (gear \"ring\"): expected none of an internal gear, a ring"),
        ({"teeth": -22}, "the tip circle of 41 mm lies inside the base circle of 41.34"),
        ({"teeth": -25, "addendum": 0.4}, "the tips of the teeth foul each other by"),
        ({"addendum": 1.0}, "below the involute of 'pinion'"),
        ({"helix_angle": "10 deg"}, 'gears of equal helix angle and one hand with an internal gear; "pinion" has +0'),
        ({"errors": {"pitch": ["1 um"]}}, "expected one deviation for each of 60 teeth, or none"),
    ],
)  # fmt: skip
def test_internal_gears_that_cannot_be(ring: dict[str, Any], words: str) -> None:
    with pytest.raises(CaseError) as caught:
        case_of(ring)
    assert words in str(caught.value)


def test_axes_at_a_distance_that_does_not_fit() -> None:
    with pytest.raises(
        CaseError, match=r"the teeth jam at a centre distance of 41 mm; they mesh without backlash at 40 mm"
    ):
        case_of(centre_distance="41 mm")


def test_check_says_lengths_without_a_sign() -> None:
    document = check_document(case_of())
    (pair,) = document["gear_pairs"]
    assert pair["ratio"] == pytest.approx(3.0)
    assert pair["centre_distance_m"] == pytest.approx(40e-3)
    assert pair["mesh_frequency_hz"] == pytest.approx(500.0)
    lines = [line for part in check.sections(document) for line in part.sentences]
    assert any("shafts 40 mm apart" in line for line in lines)


def test_gears_say_the_measures_and_the_load_of_the_pair() -> None:
    case = case_of()
    document = gears_document(solve_over_torques(analyse_pairs(case, solve_gears(case.parts))))
    (pair,) = document["pairs"]
    ring = pair["gears"][1]
    assert ring["teeth"] == -60
    radii = {"tip": 58.5, "reference": 60.0, "base": 60.0 * math.cos(math.radians(20.0)), "root": 62.5}
    for name, radius in radii.items():
        assert ring["diameters_m"][name] == pytest.approx(2e-3 * radius)
    assert ring["over_balls"]["length_m"] < ring["diameters_m"]["tip"]
    assert pair["mean_force_n"] == pytest.approx(50.0 / (20e-3 * math.cos(math.radians(20.0))))
    assert all(point["driven_radius_m"] > 58e-3 for point in pair["path_of_contact"])
    best = pair["optimal_tip_relief"]
    assert best["peak_to_peak_m"] < best["peak_to_peak_without_relief_m"]
    # The relief of both gears begins towards their tips, of the ring at larger rolls than its tip's.
    assert best["driven_start_roll_angle_rad"] > pair["path_of_contact"][0]["driven_roll_angle_rad"]
    (section,) = sections(document)
    assert any("shafts 40.0000 mm apart" in text for text in section.sentences)


@pytest.mark.parametrize("gears", [("pinion", "ring"), ("ring", "pinion")])
def test_points_of_contact_are_drawn_on_both_flanks(gears: tuple[str, str]) -> None:
    geometry = case_of(driver=gears[0], driven=gears[1]).parts.pair_geometries[0]
    axes = draw_tooth_pair(geometry).axes[0]
    (contact,) = (line for line in axes.lines if line.get_label() == "_contact")
    outlines = [artist.get_xy() for artist in axes.get_children() if artist.get_label() == "_outline"]
    assert len(outlines) == 2
    for place in contact.get_xydata():
        for outline in outlines:
            assert np.hypot(*(outline - place).T).min() < 0.1


def test_picture_has_the_ring_around_its_pinion() -> None:
    geometry = case_of().parts.pair_geometries[0]
    axes = draw_tooth_pair(geometry).axes[0]
    pinion, ring = (artist.get_xy() for artist in axes.get_children() if artist.get_label() == "_outline")
    # The driver is below, the ring's body above the pitch point out to its rim, and open below.
    assert ring[:, 1].max() == pytest.approx(72.5 - 60.0, abs=1e-3)
    assert pinion[:, 1].max() == pytest.approx(2.0, abs=0.05)
    across = np.abs(ring[:, 0]) < 1.0
    assert ring[across & (ring[:, 1] > -20.0), 1].min() > -1.6
