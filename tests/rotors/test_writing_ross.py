"""Rotors written in the form of ROSS's files: what is read back, what is remarked on, what is refused.

That ROSS itself loads them and solves the same rotor, `tests/validation/test_against_ross.py` shows.
"""

import dataclasses
import tempfile
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.rotors import (
    Bearing,
    Coupling,
    Disc,
    Pedestal,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    read_ross,
    write_ross,
)

OURS = ShaftMaterial(211e9, 81.2e9, 7810.0)
PLAIN = Rotor("plain", [Segment(0.4, 0.05, 0.0, OURS), Segment(0.6, 0.06, 0.02, OURS)], [Disc(0.7, 5.0, 0.1, 0.06)])


def test_written_elements_are_as_short_as_asked_and_meet_every_station(tmp_path: Path) -> None:
    bearings = [Bearing.isotropic("left", 0.1, 1e7), Bearing.isotropic("right", 0.95, 1e7)]
    for longest in (None, 0.3, 0.01):
        assert write_ross(tmp_path / "r.toml", PLAIN, bearings, element_length=longest) == ()
        rotor, held, remarks = read_ross(tmp_path / "r.toml")
        assert max(segment.length for segment in rotor.segments) <= (longest or 0.05) * (1.0 + 1e-9)
        for place in (0.1, 0.4, 0.7, 0.95, 1.0):
            assert np.abs(rotor.joints - place).min() < 1e-12
        assert [bearing.at for bearing in held] == pytest.approx([0.1, 0.95], rel=1e-12)
        assert (rotor.mass, rotor.centre_of_mass) == pytest.approx((PLAIN.mass, PLAIN.centre_of_mass), rel=1e-12)
        assert remarks == ()


def test_cones_couplings_tables_and_pedestals_come_back(tmp_path: Path) -> None:
    cone = Segment(0.3, 0.08, 0.04, OURS, "cowper", 0.05, 0.0, axial_force=-300.0)
    coupling = Coupling(0.1, 1e8, 1e5, 2e5, 3e7, mass=4.0, polar_inertia=0.04, diametral_inertia=0.03)
    for number, what in enumerate(("lateral", "tilt", "torsional", "axial"), 1):
        coupling = dataclasses.replace(coupling, **{f"{what}_damping": 7.0 * number})
    rotor = Rotor("r", [cone, coupling, Segment(0.2, 0.05, 0.0, OURS, 1e9)], [Disc(0.15, 2.0)])
    stand = Pedestal(np.diag([1e8, 2e8]), np.array([[10.0, 1.0], [-1.0, 20.0]]), 6.0)
    table = np.stack([np.diag([1e6, 2e6, 3e6, 0.0, 0.0]), np.diag([2e6, 3e6, 4e6, 0.0, 0.0])])
    bearings = (
        Bearing("left", 0.0, table, 100.0 * np.eye(2), speeds=np.array([0.0, 500.0])),
        Bearing("right", 0.6, np.array([[1e7, 1e6], [-2e6, 2e7]]), np.diag([5.0, 6.0]), pedestal=stand),
    )
    assert len(write_ross(tmp_path / "r.toml", rotor, bearings, element_length=0.05)) == 1  # the coupling's
    found = read_ross(tmp_path / "r.toml")
    assert found.bearings[1] == bearings[1]
    np.testing.assert_array_equal(found.bearings[0].stiffness, table)
    np.testing.assert_array_equal(found.bearings[0].damping[:, :2, :2], [100.0 * np.eye(2)] * 2)
    assert found.rotor.segments[6] == coupling
    assert found.rotor.segments[7].shear_coefficient == 1e9
    assert found.rotor.discs == rotor.discs
    for number, segment in enumerate(found.rotor.segments[:6]):
        for side, place in enumerate((number / 6, (number + 1) / 6)):
            ours = cone.section(place)
            assert segment.end_diameters[side] == pytest.approx((ours.outer_diameter, ours.inner_diameter), rel=1e-12)
        assert segment.axial_force == -300.0


@pytest.mark.parametrize(("right", "passed"), [(-300.0, True), (200.0, False), (0.0, False)])
def test_the_axial_force_of_a_coupling_is_told_and_comes_back_where_both_shafts_have_it(
    right: float, passed: bool, tmp_path: Path
) -> None:
    shafts = [Segment(0.3, 0.05, 0.0, OURS, axial_force=force) for force in (-300.0, right)]
    joint = Coupling(0.1, 1e8, 1e5, 2e5, 3e7, axial_force=-300.0)
    lone, told = write_ross(tmp_path / "r.toml", Rotor("r", [shafts[0], joint, joint, shafts[1]]), element_length=1.0)
    assert "has no length in ROSS" in lone
    assert told == (
        "rotor 'r' segment 1 and 1 more: the axial force of -300 N is left out: couplings of ROSS carry none"
    )
    found = read_ross(tmp_path / "r.toml")
    assert [part.axial_force for part in found.rotor.segments] == [-300.0, *[-300.0 * passed] * 2, right]
    text = (
        "carries the axial force of -300 N of the shafts beside it, which ROSS leaves out there"
        if passed
        else f"carries no axial force, between a shaft with -300 N and one with {right:g} N"
    )
    assert f"r.toml: CouplingElement_Coupling 1 and 1 more: {text}" in found.warnings
    free = dataclasses.replace(joint, axial_force=0.0)
    write_ross(tmp_path / "end.toml", Rotor("r", [shafts[0], free]), element_length=1.0)
    assert read_ross(tmp_path / "end.toml").rotor.segments[1].axial_force == 0.0
    assert len(write_ross(tmp_path / "r.toml", Rotor("r", [shafts[0], free, shafts[1]]), element_length=1.0)) == 1


def test_what_ross_has_no_place_for_is_said(tmp_path: Path) -> None:
    rotor = Rotor("r", [Segment(0.5, 0.05, 0.0, OURS, 0.9), Segment(0.5, 0.05, 0.0, OURS, "hutchinson")])
    tilting = Bearing("b", 0.0, np.diag([1e7, 1e7, 0.0, 1e4, 1e4]), np.zeros((2, 2)))
    plain, formula, tilt = write_ross(tmp_path / "r.toml", rotor, [tilting])
    assert "segment 0: shear coefficient 0.9 is none of ROSS's" in plain
    assert "segment 1: shear coefficient 0.92" in formula
    assert tilt == "bearing 'b': ROSS has no tilting stiffness, nor any that couples it; left out"


@pytest.mark.parametrize(
    ("rotor", "bearings", "options", "said"),
    [
        (Rotor("r", PLAIN.segments, mass_model="lumped"), [], {}, "mass_model is 'lumped'"),
        (PLAIN, [], {"element_length": 0.0}, "element_length is 0.0; expected a positive number"),
        (PLAIN, [Bearing.isotropic("b", 2.0, 1e6)], {}, "bearing 'b' position is 2.0"),
        (PLAIN, [Bearing.isotropic("b", 0.0, 1e6)] * 2, {}, "name of an element is 'b'"),
        (
            Rotor("r", [PLAIN.segments[0], Coupling(0.1, 1e8, 1e5, 2e5, 3e7)], [Disc(0.45, 1.0)]),
            [],
            {},
            "outside the coupling",
        ),
        (
            PLAIN,
            [Bearing("b", 0.0, np.eye(2), np.eye(2), pedestal=Pedestal(np.eye(2), np.eye(2)))],
            {},
            "mass of the pedestal of bearing 'b' is 0.0",
        ),
    ],
)
def test_what_ross_cannot_solve_is_not_written(
    rotor: Rotor, bearings: list[Bearing], options: dict[str, float], said: str, tmp_path: Path
) -> None:
    with pytest.raises(RotorError, match=said):
        write_ross(tmp_path / "r.toml", rotor, bearings, **options)
    assert list(tmp_path.iterdir()) == []


lengths = st.floats(0.01, 2.0)
diameters = st.floats(0.005, 0.3)


@settings(deadline=None, max_examples=25)
@given(st.lists(st.tuples(lengths, diameters, st.floats(0.0, 0.9)), min_size=1, max_size=5), st.floats(0.02, 1.0))
def test_any_rotor_keeps_its_mass_and_inertia(pieces: list[tuple[float, float, float]], part: float) -> None:
    rotor = Rotor("r", [Segment(length, outer, outer * bore, OURS) for length, outer, bore in pieces])
    with tempfile.TemporaryDirectory() as folder:
        write_ross(Path(folder) / "r.toml", rotor, element_length=part * rotor.length)
        found = read_ross(Path(folder) / "r.toml").rotor
    assert found.mass == pytest.approx(rotor.mass, rel=1e-11)
    assert found.polar_inertia == pytest.approx(rotor.polar_inertia, rel=1e-11)
    assert found.centre_of_mass == pytest.approx(rotor.centre_of_mass, rel=1e-11)


def test_the_file_is_plain_toml_of_known_classes(tmp_path: Path) -> None:
    write_ross(tmp_path / "r.toml", PLAIN, [Bearing.isotropic('the "left" one', 0.0, 1e6)])
    document = tomllib.loads((tmp_path / "r.toml").read_text(encoding="utf-8"))
    kinds = {key.partition("_")[0] for key in document} - {"ross", "parameters"}
    assert kinds == {"ShaftElement", "DiskElement", "BearingElement"}
    assert document["parameters"] == {}
    # Others than the arguments of its class ROSS refuses.
    (bearing,) = (element for key, element in document.items() if key.startswith("BearingElement"))
    coefficients = {letter + place for letter in "kc" for place in ("xx", "xy", "yx", "yy", "zz")}
    assert set(bearing) - {"n", "tag"} == coefficients
    assert (bearing["kyy"], bearing["kzz"]) == ([1e6], [0.0])
