"""Planetary sets over the parts of a machine: assembly, clearance, phasing, members, planets made of one."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planetary_machines import AXIS, MODULE, bearings, changed, gear, machine, planets, set_parts, shaft, spring

from gearwhine.coupling import CouplingError, Machine
from gearwhine.coupling.description.gear_train import Output
from gearwhine.coupling.description.parts import TorqueSupport
from gearwhine.coupling.description.planet_copies import planet_copies
from gearwhine.coupling.description.planetary import PlanetarySet, part_of_period, placed_set


@pytest.fixture(scope="module")
def three() -> Machine:
    return machine()


def test_planets_made_of_one_stand_around_the_carrier(three: Machine) -> None:
    distance = 0.5 * MODULE * 54
    for number, one in enumerate(three.shafts[3:]):
        angle = 2.0 * math.pi * number / 3.0
        assert one.name == f"p {number + 1}"
        assert one.carrier == "c"
        place = AXIS[0] + distance * math.cos(angle), AXIS[1] + distance * math.sin(angle)
        assert one.axis == pytest.approx(place, abs=1e-15)
    assert [(pair.driver, pair.driven) for pair in three.gear_pairs] == [
        *(("s", f"p {n}") for n in (1, 2, 3)),
        *((f"p {n}", "r") for n in (1, 2, 3)),
    ]
    assert [one.bearing.name for one in three.bearings[6:8]] == ["p 0.01 1", "p 0.05 1"]
    assert {one.seat for one in three.bearings} == {None}


def test_pin_errors_stay_on_the_shafts() -> None:
    made = planets(30, 0.054, shaft("c"), [], pin_errors=[0.0, 20e-6, (5e-6, -3e-6)])
    assert [one.pin_error for one in made.shafts] == [(0.0, 0.0), (0.0, 20e-6), (5e-6, -3e-6)]
    with pytest.raises(CouplingError, match="pin errors of 2 planets; expected one for each of 3"):
        planets(30, 0.054, shaft("c"), [], pin_errors=[0.0, 20e-6])
    with pytest.raises(CouplingError, match=r"pin_error .* of a shaft without a carrier"):
        shaft("s", pin_error=(1e-6, 0.0))


def test_members_by_willis(three: Machine) -> None:
    """Speeds, torques T_s : T_r : T_c = z_s : |z_r| : -(z_s + |z_r|), and their power."""
    found = {one.shaft: one for one in three.members_of(three.placed_sets[0])}
    assert found["c"].speed == pytest.approx(100.0 * 24 / 108, rel=1e-14)
    assert found["p 2"].relative_speed == pytest.approx(-24 / 30 * (100.0 - 100.0 * 24 / 108), rel=1e-14)
    assert found["r"].torque == pytest.approx(50.0 * 84 / 24, rel=1e-12)
    assert found["c"].torque == pytest.approx(-50.0 * 108 / 24, rel=1e-12)
    assert sum(one.power for one in found.values()) == pytest.approx(0.0, abs=1e-12 * 5e3)
    assert sum(one.rolling_power for one in found.values()) == pytest.approx(0.0, abs=1e-12 * 5e3)
    assert found["s"].rolling_power == pytest.approx(50.0 * 100.0 * 84 / 108, rel=1e-12)
    assert [one.state for one in found.values()] == ["driving", "held", "driven", "free", "free", "free"]
    assert three.support_torques == {"r": pytest.approx(175.0, rel=1e-12)}


@pytest.mark.parametrize("held", ["r", "s", "c"])
@pytest.mark.parametrize("speed", [100.0, -100.0])
@pytest.mark.parametrize(
    ("sun", "planet", "places"), [(25, 29, (0, 36, 72)), (24, 30, (0, 37, 71)), (26, 30, (0, 22, 56, 84))]
)
def test_phases_by_parker_and_lin(held: str, speed: float, sun: int, planet: int, places: Sequence[int]) -> None:
    """γ_sn and γ_rn of the formula against the phases of teeth that stand in each other's gaps; places in steps E."""
    angles = [math.pi * place / (sun + planet) for place in places]
    of = replace(machine(sun=sun, planet=planet, held=held, angles=angles), speed=speed)
    placed, number = of.placed_sets[0], len(of.shafts) - 3
    for kind, first in (("sun", 0), ("ring", number)):
        phases = np.array(of.mesh_phases[first : first + number])
        expected = placed.phases(kind, placed.sense(kind, of.speeds))  # type: ignore[arg-type]
        apart = phases - phases[0] - np.array(expected)
        np.testing.assert_allclose(apart, np.round(apart), atol=1e-6)
    for sense in (0, 2, 7):
        with pytest.raises(CouplingError, match=f"sense is {sense}; expected 1 or -1"):
            placed.phases("sun", sense)


@pytest.mark.slow
def test_phases_are_those_of_the_assembled_machine() -> None:
    of = machine(count=2, sun=25, planet=29)
    contacts = of.assembled.system.contacts
    assert of.mesh_phases == pytest.approx([contact.phase for contact in contacts], abs=1e-9)
    assert of.mesh_frequencies == pytest.approx([contact.mesh_frequency for contact in contacts], rel=1e-12)


def test_phasing_suppresses_modes() -> None:
    """Parker's rules by k = mod(l z_s, N): 0 rotational, 1 or N - 1 translational, else planet modes alone."""
    for sun, planet, count in ((24, 30, 3), (25, 26, 3), (26, 30, 4), (25, 31, 4)):
        placed = machine(sun=sun, planet=planet, count=count).placed_sets[0]
        for harmonic in range(1, 7):
            left = harmonic * sun % count
            excited = {0: "rotational", 1: "translational", count - 1: "translational"}.get(left)
            kinds = {"rotational", "translational"} - set(placed.suppressed(harmonic))
            assert kinds == ({excited} if excited else set())
            assert placed.excitation(harmonic, "ring") == pytest.approx(placed.excitation(harmonic), abs=1e-9)


def test_assembly_numbers_of_stepped_and_double_planets() -> None:
    """E = (z_s z_p2 + |z_r| z_p1) / gcd(z_p1, z_p2), and |z_r| - z_s."""
    carrier = shaft("c", start=0.1)
    stepped = planet_copies(
        shaft("p"),
        [gear("big", "p", 40), gear("small", "p", 24)],
        bearings("p"),
        carrier=carrier,
        count=4,
        distance=0.06,
        gear_pairs=[spring("s", "big"), spring("small", "r")],
    )
    of = PlanetarySet("stage", stepped.gear_names, "c", sun="s", ring="r")
    placed = placed_set(of, _Parts([shaft("s"), shaft("r"), carrier], [("s", 20), ("r", -84)], stepped))
    assert placed.assembly_number == (20 * 24 + 84 * 40) // 8
    assert not placed.planets_in_one_piece
    reach, turn = 0.05, 0.6
    inner = replace(shaft("i"), axis=(AXIS[0] + reach, AXIS[1]))
    outer = replace(shaft("o"), axis=(AXIS[0] + 0.08 * math.cos(turn), AXIS[1] + 0.08 * math.sin(turn)))
    double = planet_copies(
        [inner, outer],
        [gear("i", "i", 18), gear("o", "o", 20)],
        [*bearings("i"), *bearings("o")],
        carrier=carrier,
        count=3,
        gear_pairs=[spring("s", "i"), spring("i", "o"), spring("o", "r")],
    )
    of = PlanetarySet("stage", double.gear_names, "c", sun="s", ring="r")
    placed = placed_set(of, _Parts([shaft("s"), shaft("r"), carrier], [("s", 30), ("r", -90)], double))
    assert [group.shafts for group in placed.groups] == [(f"i {n}", f"o {n}") for n in (1, 2, 3)]
    assert placed.assembly_number == 60
    assert placed.can_be_assembled
    assert [mesh.kind for mesh in placed.meshes[::3]] == ["sun", "planets", "ring"]


class _Parts:
    """Parts of a set without a machine around them."""

    def __init__(self, shafts: Any, central: Any, made: Any) -> None:
        self.shafts = [*shafts, *made.shafts]
        self.gears = [*(gear(name, name, teeth) for name, teeth in central), *made.gears]
        self.gear_pairs, self.bearings = made.gear_pairs, made.bearings


@given(st.integers(18, 40), st.integers(24, 40), st.integers(0, 8))
@settings(max_examples=12)
def test_the_assembly_condition_is_that_of_the_phases(sun: int, planet: int, place: int) -> None:
    """A second planet on a grid finer than the steps: refused where a loop of teeth does not close, nowhere else."""
    steps = 2 * (sun + planet)
    angle = math.pi + 2.0 * math.pi * place / (3.0 * steps)
    parts = set_parts(sun=sun, planet=planet, angles=[0.0, angle])
    fits = (angle * steps / (2.0 * math.pi) + 1e-6) % 1.0 < 2e-6
    if fits:
        assert len(Machine(**parts).mesh_phases) == 4
        return
    with pytest.raises(CouplingError, match=rf"planets at multiples of 360/{steps} deg"):
        Machine(**parts)
    with pytest.raises(CouplingError, match="cannot be assembled"):
        _ = Machine(**{**parts, "planetary_sets": []}).mesh_phases


def test_planets_that_reach_over_the_axis_of_their_ring_leave_room_for_one() -> None:
    """40 teeth in a ring of 60: the axes of two are 40 mm apart, the tips of each reach 42 mm from its own."""
    carrier = shaft("c")
    made = planets(40, 0.5 * MODULE * 20, carrier, [("p", "r")], count=2)
    parts = _Parts([shaft("r"), carrier], [("r", -60)], made)
    (touching, *_) = placed_set(PlanetarySet("stage", made.gear_names, "c", ring="r"), parts).findings()
    assert "axes are 40 mm apart, and their tip circles need 84 mm" in touching.expected
    assert "room for 1 of them" in touching.expected
    # Of three, each of which touches both others, the first two are named.
    made = planets(40, 0.5 * MODULE * 20, carrier, [("p", "r")], count=3)
    parts = _Parts([shaft("r"), carrier], [("r", -60)], made)
    found = placed_set(PlanetarySet("stage", made.gear_names, "c", ring="r"), parts).findings()
    assert [one.value for one in found if "clear of each other" in one.expected] == [made.gear_names[:2]]


@pytest.mark.parametrize(
    ("phase", "part"), [(3.0 - 1e-12, 0.0), (-1e-12, 0.0), (1e-12, 0.0), (-0.25, 0.75), (2.4, 0.4), (-7.0, 0.0)]
)
def test_a_phase_is_a_part_of_a_period_without_rounding_about_whole_ones(phase: float, part: float) -> None:
    assert part_of_period(phase) == pytest.approx(part, abs=0.0 if part == 0.0 else 1e-12)


@pytest.mark.parametrize("attribute", ["name", "planets", "carrier", "sun", "ring"])
def test_what_is_no_name_is_refused(attribute: str) -> None:
    given: dict[str, Any] = {"name": "stage", "planets": ["p"], "carrier": "c", "sun": "s", "ring": "r"}
    PlanetarySet(**given)
    with pytest.raises(CouplingError, match=rf"{attribute} is .*; expected (a|names)"):
        PlanetarySet(**given | {attribute: [3] if attribute == "planets" else 3})


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "touching": (
        {"count": 6},
        r"'p 1', 'p 2'.*axes are 54 mm apart.*need 64 mm; .* room for 4 of them",
    ),
    "assembly": (
        {"sun": 25, "count": 4},
        r"multiples of 360/110 deg, as 0, 91.6364, .* 5 or 2 of them|or teeth whose number E = 110 .* is 108 or 112; "
        r"their teeth stand 0.500 of a step",
    ),
    "small ring": ({"ring": -70}, r"ring is 'r'; expected a ring around sun and planets, of 84 teeth .* 70, smaller: "),
}


@pytest.mark.parametrize(("how", "match"), REFUSED.values(), ids=REFUSED)
def test_sets_that_cannot_be_are_refused(how: dict[str, Any], match: str) -> None:
    with pytest.raises(CouplingError, match=match):
        machine(**how)


def _refusals() -> dict[str, tuple[dict[str, Any], str]]:
    parts = set_parts()
    pairs = parts["gear_pairs"]
    few = [one for one in parts["bearings"] if one.rotor not in ("p 2",)]
    loose = [one for one in parts["bearings"] if one.rotor[0] == "p"]
    seated = [replace(one, seat="wall") if one.rotor == "p 1" else one for one in parts["bearings"]]
    return {
        "free member": ({**parts, "torque_supports": []}, "2 degrees of freedom .* expected 1 more of 'c', 'r' held"),
        "two held": (
            {**parts, "torque_supports": [TorqueSupport("r"), TorqueSupport("c")]},
            r"cannot turn: .* one of the held shafts \('r', 'c'\) free",
        ),
        "no bearing": ({**parts, "bearings": few}, r"shaft 'p 2': carrier is 'c'; expected a bearing on its pin"),
        "ground": ({**parts, "bearings": seated}, "seat is 'wall'; expected a bearing on the carrier, seat None or"),
        "located": ({**parts, "bearings": loose}, "expected a bearing that locates it, .* 'c', 'r', 's'"),
        "axis": (changed(parts, "shafts", "r", axis=(AXIS[0], 0.0)), "'r': axis is .* it is 20 mm off"),
        "output": ({**parts, "outputs": [Output("r")]}, "output on shaft 'r', which stands still"),
        "held planet": ({**parts, "torque_supports": [TorqueSupport("p 1")]}, 'its axis|carrier "c"'),
        "carrier": (changed(parts, "shafts", "p 1", carrier="p 2"), "expected a shaft whose own axis stands still"),
        "sun": (
            {**parts, "planetary_sets": [replace(parts["planetary_sets"][0], sun="r", ring="s")]},
            "sun is 'r'; expected an external gear, of positive teeth; it has -84",
        ),
        "unknown": (
            {**parts, "planetary_sets": [replace(parts["planetary_sets"][0], ring="x")]},
            "ring is 'x'; expected the name of a gear of this machine",
        ),
        "unmeshed": (
            {**parts, "gear_pairs": [one for one in pairs if "p 3" not in (one.driver, one.driven)]},
            "planets is 'p 3'; expected a gear in mesh with 's' or 'r'",
        ),
        "reversed": (
            {**parts, "gear_pairs": [*pairs[:3], *(replace(one, driver="r", driven=one.driver) for one in pairs[3:])]},
            "power to flow from driver to driven, in the frame of planets' carrier; swap the two names",
        ),
    }


@pytest.mark.parametrize("case", _refusals())
def test_machines_that_cannot_be_are_refused(case: str) -> None:
    parts, match = _refusals()[case]
    with pytest.raises(CouplingError, match=match):
        Machine(**parts)


@pytest.mark.parametrize("change", [{"module": 2.5e-3}, {"helix_angle": 0.2}])
def test_unequal_module_or_helix_is_refused(change: dict[str, float]) -> None:
    parts = set_parts()
    ring = next(one for one in parts["gears"] if one.name == "r")
    with pytest.raises(ValueError, match=r"module|helix"):
        Machine(**changed(parts, "gears", "r", gear=replace(ring.gear, **change)))
