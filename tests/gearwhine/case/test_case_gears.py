"""Gears of a case: sizes given in several ways, helices, rims, and what `check` and `gears` say of them."""

import math
import tomllib
from typing import Any

import pytest

from gearwhine.case import CaseError, dump_case, parse_case
from gearwhine.coupling.analyses.gear_pairs import solve_over_torques
from gearwhine.coupling.gears import RingSupport
from gearwhine.from_case.machine import solve_gears
from gearwhine.output.terminal import show, shown_by
from gearwhine.results import check
from gearwhine.results.check import check_document
from gearwhine.results.gears import gears_document, sections
from gearwhine.solve.gear_pairs import analyse_pairs

pytestmark = pytest.mark.usefixtures("few_reliefs_tried")
STEEL = {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}
TOOTH = {"module": "3.175 mm", "face_width": "30 mm", "material": "steel"}


def case_of(pinion: dict[str, Any], wheel: dict[str, Any], **pair: Any) -> Any:
    document = {
        "title": "gears",
        "material": {"steel": STEEL},
        "gear": [{"name": "pinion", "teeth": 20} | pinion, {"name": "wheel", "teeth": 61} | wheel],
        "gear_pair": [{"driver": "pinion", "driven": "wheel"} | pair],
        "operation": {"speed": "1500 rpm", "torque": "10 N*m"},
    }
    return parse_case(document, source="gears.toml")


HELICAL = case_of(TOOTH | {"helix_angle": "15 deg"}, TOOTH | {"helix_angle": "-15 deg", "rim": "9 mm", "web": "8 mm"})


def test_three_ways_of_saying_the_size() -> None:
    rest = {"face_width": "30 mm", "helix_angle": "15 deg", "material": "steel"}
    transverse = math.atan(math.tan(math.radians(20.0)) / math.cos(math.radians(15.0)))
    base_radius = 0.5 * 20 * 3.175e-3 / math.cos(math.radians(15.0)) * math.cos(transverse)
    for size in ({"module": "3.175 mm"}, {"diametral_pitch": "8 1/in"}, {"base_radius": base_radius}):
        case = case_of(rest | size, TOOTH | {"helix_angle": "-15 deg"})
        given = case.gear_named("pinion")
        gear = case.parts.gears["pinion"]
        assert gear.module == pytest.approx(3.175e-3, rel=1e-13)
        assert gear.base_radius == pytest.approx(base_radius, rel=1e-13)
        # What the case knows by itself agrees with the gear that is built.
        assert given.tooth_module == pytest.approx(gear.module, rel=1e-13)


def test_a_gear_without_a_material_is_of_the_case_s_only_one() -> None:
    """Teeth of aluminium yield 207/70 as much as those of steel: the models' stiffness goes with Young's modulus."""
    teeth = {key: value for key, value in TOOTH.items() if key != "material"}
    document = {
        "title": "gears",
        "material": {"aluminium": {"youngs_modulus": "70 GPa", "poisson_ratio": 0.3, "density": "2700 kg/m^3"}},
        "gear": [{"name": "pinion", "teeth": 20} | teeth, {"name": "wheel", "teeth": 61} | teeth],
        "gear_pair": [{"driver": "pinion", "driven": "wheel"}],
    }
    case = parse_case(document)
    gear = case.parts.gears["wheel"]
    assert (gear.youngs_modulus, gear.density) == (70e9, 2700.0)
    steel = case_of(TOOTH, TOOTH).parts.gears["wheel"]
    assert gear.mass == pytest.approx(steel.mass * 2700.0 / 7850.0, rel=1e-12)


def test_gears_that_cannot_be_made_are_named_by_their_keys() -> None:
    """A rack cuts away the foot of 8 teeth; a tip beyond the start of the other's involute finds no flank."""
    with pytest.raises(CaseError) as caught:
        case_of(TOOTH | {"teeth": 8}, TOOTH)
    (line,) = str(caught.value).splitlines()
    assert line.startswith(
        'gears.toml: gear[0].profile_shift (gear "pinion"): expected 0.5321 or more, with which 8 teeth'
    )
    with pytest.raises(CaseError) as caught:
        case_of(TOOTH | {"teeth": 18}, TOOTH | {"addendum": 1.2, "root_radius": "1.3 mm"})
    (line,) = str(caught.value).splitlines()
    assert line.startswith('gears.toml: gear_pair[0] ("pinion" to "wheel"): expected gears that can mesh; ')


def test_every_key_reaches_the_gear_and_the_resolved_case() -> None:
    keys = {
        "addendum": 0.9,
        "dedendum": 1.3,
        "profile_shift": 0.1,
        "helix_angle": "-15 deg",
        "root_radius": "0.8 mm",
        "tooth_thinning": "0.05 mm",
        "bore": "30 mm",
        "rim": "9 mm",
        "web": "8 mm",
    }
    case = case_of(TOOTH | {"helix_angle": "15 deg", "teeth": 14, "allow_undercut": True}, TOOTH | keys)
    wheel, pinion = (case.parts.gears[name] for name in ("wheel", "pinion"))
    assert (wheel.addendum, wheel.dedendum, wheel.root_radius) == (0.9, 1.3, pytest.approx(0.8e-3))
    assert (wheel.rim_thickness, wheel.web_thickness) == (pytest.approx(9e-3), pytest.approx(8e-3))
    assert wheel.tooth_thinning == pytest.approx(0.05e-3)
    assert pinion.is_undercut
    assert parse_case(tomllib.loads(dump_case(case)), source="resolved.toml") == case


@pytest.mark.slow
def test_the_support_of_a_ring_reaches_its_gear_and_makes_its_mesh_softer() -> None:
    pinion = TOOTH | {"profile_shift": 0.3, "teeth": 28}
    ring = TOOTH | {"teeth": -82, "profile_shift": -0.3, "addendum": 0.8, "rim": "8 mm"}
    bolts = {"kind": "bolts", "count": 6, "seat_width": "15 mm", "radial_stiffness": "2e9 N/m", "first": "10 deg"}
    cases = [case_of(pinion, ring | more) for more in ({}, {"ring_support": bolts})]
    support = cases[1].parts.gears["wheel"].ring_support
    assert support == RingSupport("bolts", 6, 15e-3, 2e9, None, math.radians(10.0))
    assert parse_case(tomllib.loads(dump_case(cases[1])), source="resolved.toml") == cases[1]
    clamped, bolted = (
        gears_document(analyse_pairs(case, solve_gears(case.parts)))["pairs"][0]["stiffness_n_per_m"] for case in cases
    )
    assert bolted["mean"] < 0.8 * clamped["mean"]
    springs = {"kind": "springs", "radial_stiffness": "2e10 N/m", "tangential_stiffness": "2e10 N/m"}
    for model, words in (("elastic-ring", "between the 6 bolts"), ("iso6336", "does not know the support")):
        doubts = check_document(case_of(pinion, ring | {"ring_support": bolts}, stiffness={"model": model}))["warnings"]
        assert [words in one["message"] for one in doubts if one["name"] == "ring support"] == [True]
    even = check_document(case_of(pinion, ring | {"ring_support": springs}))
    assert "ring support" not in [one["name"] for one in even.get("warnings", [])]


def test_check_and_gears_take_helical_gears(capsys: pytest.CaptureFixture[str]) -> None:
    geometry = HELICAL.parts.pair_geometries[0]
    document = check_document(HELICAL)
    (pair,) = document["gear_pairs"]
    assert pair["overlap_ratio"] == pytest.approx(30e-3 * math.sin(math.radians(15.0)) / (math.pi * 3.175e-3))
    assert pair["total_contact_ratio"] == geometry.total_contact_ratio
    angles = [math.degrees(gear["helix_angle_rad"]) for gear in pair["geometry"]["gears"]]
    assert angles == pytest.approx([15.0, -15.0])
    assert [point["point"] for point in pair["geometry"]["path_of_contact"]][::4] == ["SAP", "EAP"]
    shown_by(check.sections)(document)
    document = gears_document(solve_over_torques(analyse_pairs(HELICAL, solve_gears(HELICAL.parts))))
    assert document["pairs"][0]["transmission_error_m"]["peak_to_peak"] > 0.0
    show(document, sections(document))
    shown = " ".join(capsys.readouterr().out.split())
    assert "+ overlap" in shown
    assert "helix 15° left" in shown
    assert "helix angle 15°, the driver's right-hand" in shown


def test_undercut_and_thin_tips_are_warned_of() -> None:
    case = case_of(TOOTH | {"teeth": 12, "allow_undercut": True}, TOOTH | {"addendum": 0.6})
    (warning,) = check_document(case)["warnings"]
    assert (warning["name"], "'pinion'" in warning["message"]) == ("undercut", True)
    case = case_of(TOOTH | {"teeth": 12, "profile_shift": 0.7}, TOOTH)
    (warning,) = check_document(case)["warnings"]
    assert (warning["name"], "'pinion'" in warning["message"]) == ("thin tip", True)


def test_backlash_is_that_of_thinned_teeth() -> None:
    """Both thinned by 40 µm along the reference circle, at nominal distance: 80 µm cos 20° along the line of action."""
    thin = TOOTH | {"tooth_thinning": "0.04 mm"}
    (nominal,) = solve_gears(case_of(TOOTH, TOOTH).parts)
    assert nominal.backlash is None
    (thinned,) = solve_gears(case_of(thin, thin).parts)
    expected = 80e-6 * math.cos(math.radians(20.0))
    assert thinned.backlash == pytest.approx(expected, rel=1e-9)
    (given,) = solve_gears(case_of(thin, thin, backlash="0.1 mm").parts)
    assert given.backlash == 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("helix", [0.0, 20.0])
def test_backlash_has_its_three_sizes_under_their_names(helix: float) -> None:
    """Thinned along the reference circle by s / cos β in the transverse plane, on gears at their nominal distance.

    j_wt is on the pitch circles, j_bn = j_wt cos α_t cos β_b the distance of the flanks (ISO 21771).
    """
    thin = TOOTH | {"tooth_thinning": "0.04 mm"}
    case = case_of(thin | {"helix_angle": f"{helix} deg"}, thin | {"helix_angle": f"{-helix} deg"})
    beta = math.radians(helix)
    transverse = math.atan(math.tan(math.radians(20.0)) / math.cos(beta))
    base = math.asin(math.sin(beta) * math.cos(math.radians(20.0)))
    around = 80e-6 / math.cos(beta)
    along = around * math.cos(transverse)
    named = {"along_line_of_action": along, "circumferential": around, "normal": along * math.cos(base)}
    (checked,) = check_document(case)["gear_pairs"]
    (analysed,) = gears_document(analyse_pairs(case, solve_gears(case.parts)))["pairs"]
    for document in (checked, analysed):
        assert document["backlash_m"] == pytest.approx(named, rel=1e-6)
    sizes = f"j_wt {1e3 * around:.4g} mm on the working pitch circle, j_bn {1e3 * named['normal']:.4g} mm normal"
    (section,) = sections(gears_document(solve_over_torques(analyse_pairs(case, solve_gears(case.parts)))))
    assert any(text.startswith(f"Backlash {sizes}") for text in section.sentences)
    lines = [line for part in check.sections(check_document(case)) for line in part.sentences]
    assert any(f"backlash {sizes}" in line for line in lines)
    case = case_of(thin, thin, backlash="0.3 mm")
    (checked,) = check_document(case)["gear_pairs"]
    (analysed,) = gears_document(analyse_pairs(case, solve_gears(case.parts)))["pairs"]
    assert checked["backlash_m"]["along_line_of_action"] == 3e-4
    assert checked["backlash_m"] == pytest.approx(analysed["backlash_m"], rel=1e-12)
    bare = case_of(TOOTH, TOOTH)
    assert gears_document(analyse_pairs(bare, solve_gears(bare.parts)))["pairs"][0]["backlash_m"] is None


def test_a_backlash_that_is_not_the_geometrys_is_doubted() -> None:
    thin = TOOTH | {"tooth_thinning": "0.04 mm"}
    for backlash, doubted in (("0.2 mm", True), ("0.075 mm", False), ("0 mm", True)):
        names = [one["name"] for one in check_document(case_of(thin, thin, backlash=backlash)).get("warnings", [])]
        assert ("backlash" in names) is doubted
    assert "warnings" not in check_document(case_of(TOOTH, TOOTH, backlash="0.1 mm"))
