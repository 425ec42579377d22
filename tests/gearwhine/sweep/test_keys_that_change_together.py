"""Keys that change together: `*` in a change, and several keys of one `--over`; materials whose shear is their own."""

import pytest
from coupled_cases import coupled

from gearwhine.case import CaseError, Material, load_case, swept_keys
from gearwhine.from_case.mesh import material_of
from gearwhine.sweep.points import sweep_points


def test_a_star_stands_for_every_entry_that_has_the_key() -> None:
    case = load_case("spur-pair", ["bearing.*.stiffness.xx=3e8 N/m"]).case
    assert {bearing.stiffness.xx for bearing in case.bearing} == {3e8}
    assert {bearing.stiffness.yy for bearing in case.bearing} != {3e8}
    with pytest.raises(CaseError, match=r"bearing\[3\]\.hardness .*no such key"):
        load_case("spur-pair", ["bearing.*.hardness=1"])


def test_a_star_stands_for_what_is_by_default_too() -> None:
    """As in [update]: of two rotors one has the key in writing, or none."""
    for written in (["rotor.0.damping_ratio=0.01"], []):
        case = load_case("spur-pair", [*written, "rotor.*.damping_ratio=0.02"]).case
        assert [rotor.damping_ratio for rotor in case.rotor] == [0.02, 0.02]
    (key, *_) = swept_keys(load_case("spur-pair").case, ["rotor.*.damping_ratio=0.01,0.02"])
    points = sweep_points(load_case("spur-pair", ["rotor.1.damping_ratio=0.03"]).source, [key])
    assert [[rotor.damping_ratio for rotor in point.case.rotor] for point in points] == [[0.01] * 2, [0.02] * 2]
    # What is there by default alone cannot be taken away.
    assert load_case("spur-pair", ["rotor.0.damping_ratio=0.01", "rotor.*.damping_ratio="]).case.rotor[0].damping_ratio


def test_a_key_under_two_names_is_gone_through_once() -> None:
    case = load_case("spur-pair").case
    name = case.bearing[0].name
    for other in ("bearing[0].stiffness.xx", f"bearing.{name}.stiffness.xx"):
        with pytest.raises(CaseError, match="each key once"):
            swept_keys(case, ["bearing.*.stiffness.xx=1e8,2e8", f"{other}=3e8,4e8"])
    with pytest.raises(CaseError, match="that some entries of the case have"):
        swept_keys(case, ["bearing.*.hardness=1,2"])


def test_keys_with_commas_between_move_together() -> None:
    case = load_case("spur-pair").case
    over = "bearing.*.stiffness.xx, bearing.*.stiffness.yy=1e8 N/m:3e8 N/m:3"
    keys = [key for key in swept_keys(case, [over]) if key.key != "operation.speed"]
    (key,) = keys
    assert key.keys == ("bearing.*.stiffness.xx", "bearing.*.stiffness.yy")
    points = sweep_points(load_case("spur-pair", ["transient.revolutions=2", "transient.discard=1"]).source, keys)
    stiffnesses = [{(b.stiffness.xx, b.stiffness.yy) for b in point.case.bearing} for point in points]
    assert stiffnesses == [{(1e8, 1e8)}, {(2e8, 2e8)}, {(3e8, 3e8)}]
    with pytest.raises(CaseError, match="each key once"):
        swept_keys(case, ["bearing.0.at,bearing.0.at=10 mm,12 mm"])


def test_a_key_with_a_factor_takes_the_values_times_it() -> None:
    loaded = load_case("helical-pair", ["transient.revolutions=2", "transient.discard=1"])
    over = "gear.pinion.helix_angle, gear.wheel.helix_angle*-1=12 deg:16 deg:3"
    keys = [key for key in swept_keys(loaded.case, [over]) if key.key != "operation.speed"]
    (key,) = keys
    assert key.keys == ("gear.pinion.helix_angle", "gear.wheel.helix_angle")
    assert key.overrides[1] == ("gear.pinion.helix_angle=14 deg", "gear.wheel.helix_angle=-14 deg")
    for wrong in ("gear.pinion.helix_angle*2=1 deg,2 deg", "rotor.0.material,rotor.1.material*2=steel,iron"):
        with pytest.raises(CaseError, match="--over"):
            swept_keys(loaded.case, [wrong])


def test_a_point_that_makes_no_machine_is_refused_by_itself() -> None:
    """At a centre distance of 93 mm a shaft of 120 mm runs through the other; the grid goes on."""
    loaded = load_case("spur-pair", ["transient.revolutions=2", "transient.discard=1"])
    keys = swept_keys(loaded.case, ["rotor.input.segments.*.diameter=30 mm,32 mm,190 mm"])
    points = sweep_points(loaded.source, keys)
    assert [bool(point.refusal) for point in points] == [False, False, True]
    assert "190 mm" in points[2].refusal or "input" in points[2].refusal
    with pytest.raises(CaseError):
        sweep_points(loaded.source, swept_keys(loaded.case, ["rotor.input.segments.*.diameter=190 mm,200 mm"]))


def test_a_shear_modulus_of_its_own_is_that_of_shafts_alone() -> None:
    steel = Material(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
    assert steel.is_isotropic
    # Bodies of gears, which stiffen the shaft, are isotropic as the housing's.
    changes = ["material.steel.shear_modulus=70 GPa", "gear.*.stiffens_shaft=false"]
    case = load_case("spur-pair", changes).case
    assert case.material["steel"].shear_modulus == 70e9
    rotor = coupled(case).rotors[0]
    stiff_steel = load_case("spur-pair", ["material.steel.shear_modulus=90 GPa", *changes[1:]]).case
    stiffer = coupled(stiff_steel).rotors[0]
    # Elastic torsion goes with the root of the shear modulus.
    ratio = stiffer.modal.torsional.frequencies[1] / rotor.modal.torsional.frequencies[1]
    assert ratio == pytest.approx((90.0 / 70.0) ** 0.5, rel=1e-9)
    with pytest.raises(CaseError, match="in a housing, whose solids are isotropic"):
        material_of(load_case("small-gearbox", changes[:1]).case.material, "steel")
    with pytest.raises(CaseError, match="of a material of this Young's modulus"):
        load_case("spur-pair", ["material.steel.shear_modulus=7 GPa"])


def test_shear_coefficients_may_be_above_one() -> None:
    loaded = load_case("spur-pair", ["rotor.0.shear_coefficient=1.2"])
    assert loaded.case.rotor[0].shear_coefficient == 1.2
    assert any("is its reciprocal meant?" in warning for warning in loaded.warnings)
    with pytest.raises(CaseError, match=r"above 0 and of at most 1\.5"):
        load_case("spur-pair", ["rotor.0.shear_coefficient=1.6"])
