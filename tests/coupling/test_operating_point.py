"""Operating point: machines that have none, symmetries, causes of misalignment, and what a pair tells of its load."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from own_statics import FULL, STEEL, STIFFNESS, TEETH, distance, linear_bearing, one_stage, toothed

from gearwhine.coupling import CouplingError, GapLaw, Machine, MountedBearing, Output, Shaft, ShaftForce, ShaftGear
from gearwhine.coupling.assembly import assemble_machine
from gearwhine.coupling.errors import EquilibriumNotFoundError
from gearwhine.coupling.gears import ConstantStiffness, Spall, loaded_transmission_error, tooth_contact
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.gears.stiffness.models import stiffness_under_load
from gearwhine.coupling.machine.components import HousingComponent, PedestalComponent
from gearwhine.coupling.statics.operating_point import CAUSES, flank_gaps
from gearwhine.coupling.statics.static_equilibrium import static_equilibrium
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import EquilibriumError, Pedestal, Rotor, Segment
from gearwhine.rotors.model.profile import StiffnessDiameter
from gearwhine.rotors.rolling_bearings import BallRow, RollingBearing, TaperedRollerRow

RADIAL = 1e8 * np.eye(2)
ISOTROPIC = np.diag([2e8, 2e8, 5e7, 3e4, 3e4])
BALL = RollingBearing([BallRow(9, 11e-3, 46e-3, clearance=12e-6)])


def idler(housing: HousingComponent | None = None, **changes: Any) -> Machine:
    """Three equal gears in a row: as much torque leaves the machine as enters it."""
    apart = distance(23, 23, 0.0)
    names = ("one", "two", "three")
    seats = {name: None if housing is None else f"{name}" for name in names}
    shafts = [Shaft(Rotor(name, [Segment(0.2, 0.04, 0.0, STEEL)]), (n * apart, 0.0)) for n, name in enumerate(names)]
    held = [
        MountedBearing(
            linear_bearing(f"{name} {at}", at, FULL),
            name,
            None if seats[name] is None else f"{name} {at}",
        )
        for name in names
        for at in (0.02, 0.17)
    ]
    gears = [ShaftGear(toothed(name, 23), name, 0.08) for name in names]
    pairs = [GearPair(*names[n : n + 2], ConstantStiffness(STIFFNESS)) for n in (0, 1)]
    parts: dict[str, Any] = {"speed": 100.0, "torque": 80.0, "housing": housing}
    return Machine(shafts, held, gears, pairs, **parts | changes)


def rigid_housing(machine: Machine, mass: float = 30.0) -> HousingComponent:
    """A housing free in space that does not deform: six modes at rest."""
    seats, heights, axes = {}, {}, {}
    for one in machine.bearings:
        axis = machine.shaft(one.rotor).axis
        centre = np.array([*axis, one.bearing.at])
        turns = np.cross(np.eye(3), centre)  # motion of the centre by rotations about x, y, z
        seats[one.bearing.name] = np.block([[np.eye(3), np.zeros((3, 3))], [turns, np.eye(3)]]) / math.sqrt(mass)
        heights[one.bearing.name], axes[one.bearing.name] = one.bearing.at, axis
    return HousingComponent(
        "box",
        ("housing",) * 6,
        np.zeros((6, 6)),
        np.zeros((6, 6)),
        np.zeros((6, 6)),
        seats=seats,
        seat_z=heights,
        sensors={},
        seat_axes=axes,
    )


def test_a_free_housing_carries_what_balances_and_nothing_else() -> None:
    grounded = idler()
    box = rigid_housing(grounded)
    free = idler(box)
    point, expected = free.operating_point(), grounded.operating_point()
    for one in expected.bearings:
        np.testing.assert_allclose(point.bearing(one.name).force, one.force, atol=1e-6 * expected.pairs[0].force)
    assert sum("the housing" in words for words in point.free) >= 1
    # With gears of other sizes the housing has to be held against the difference of the torques.
    expected_words = r"nothing holds the motion of the housing .*, and the loads drive it; .* \[\[housing.support\]\]"
    with pytest.raises(CouplingError, match=expected_words):
        idler(box, outputs=[Output("two", 80.0)]).operating_point()
    with pytest.raises(CouplingError, match="box: expected its participation in rigid motions, for its weight"):
        replace(free, gravity=(0.0, -9.81, 0.0)).operating_point()


def spur(stiffness: npt.ArrayLike = RADIAL, **changes: Any) -> Machine:
    return one_stage(hand=0.0, stiffness=stiffness, **changes)


def test_machines_without_an_operating_point_are_refused() -> None:
    with pytest.raises(
        CouplingError,
        match=r"nothing holds the axial motion of shaft '(in|out)', and the loads drive it; expected a bearing",
    ):
        replace(spur(), gravity=(0.0, 0.0, -9.81)).operating_point()
    unloaded = spur(torque=0.0)
    (pair,) = unloaded.gear_pairs
    assert unloaded.at_operating_point().gear_pairs == (pair,)
    with pytest.raises(CouplingError, match="'pinion' -> 'wheel': no flanks carry a load without a torque, so no mis"):
        flank_gaps([unloaded.operating_point()], [pair.label])
    machine = spur()
    missing = replace(machine, bearings=machine.bearings[1:])
    with pytest.raises(
        EquilibriumNotFoundError, match=r"out of balance on shaft '(in|out)' after \d+ steps; expected at most"
    ):
        missing.operating_point()
    with pytest.raises(CouplingError, match=r"nothing holds the .* of shaft 'in', and the loads drive it"):
        replace(machine, bearings=machine.bearings[2:]).operating_point()


def rolling(machine: Machine, *which: int) -> Machine:
    held = [
        replace(one, bearing=linear_bearing(one.bearing.name, one.bearing.at, np.zeros((5, 5))), rolling=BALL)
        if number in which
        else one
        for number, one in enumerate(machine.bearings)
    ]
    return replace(machine, bearings=held)


def test_an_overloaded_rolling_bearing_is_refused() -> None:
    machine = replace(rolling(spur(ISOTROPIC), 0), torque=4e4)
    with pytest.raises(EquilibriumError, match=r"'in 0.016': the elements of row 1 are pressed by .* % of their diam"):
        machine.operating_point()


def test_a_shaft_loose_in_its_play_bears_nothing() -> None:
    """An idle branch in bearings with clearance finds some place; its bearings and teeth carry no load."""
    machine = idler(outputs=[Output("two", 80.0)])
    point = rolling(machine, 4, 5).operating_point()
    for at in (0.02, 0.17):
        assert np.abs(point.bearing(f"three {at}").force).max() < 1e-6 * point.pairs[0].force
    assert point.pairs[1].force < 1e-6 * point.pairs[0].force


@pytest.mark.parametrize("torque", [0.25, 4.0, -60.0])
def test_light_loads_float_in_the_play_of_all_bearings(torque: float) -> None:
    """Shafts move by their play, far more than they bend, and the bearings balance the force of the teeth."""
    teeth = [GearPair("pinion", "wheel", "weber-banaschek", backlash=1e-4)]
    machine = rolling(one_stage(gear_pairs=teeth), 0, 1, 2, 3)
    point = replace(machine, torque=torque).operating_point()
    assert point.residual < 1e-8
    (pair,) = point.pairs
    for name, side in (("in", -1.0), ("out", 1.0)):
        total = sum(one.force for one in point.bearings if one.mounted.rotor == name)[:3]
        push = np.array([*pair.pair.push, pair.pair.axial]) * pair.force * side
        np.testing.assert_allclose(total, push, rtol=0.0, atol=1e-7 * pair.force)


def test_gaps_alone_hold_a_loaded_shaft() -> None:
    """A ring with play bears along the load as deep as its law says: F (depth)^n beyond the gap."""
    law = GapLaw(2000.0, 2e-5, 1.5, 8e-6)
    machine = spur()
    point = replace(machine, bearings=[replace(one, law=law) for one in machine.bearings]).operating_point()
    for bearing in point.bearings:
        size, reach = np.hypot(*bearing.force[:2]), np.hypot(*bearing.deflection[:2])
        assert reach == pytest.approx(law.gap + law.depth * (size / law.force) ** (1.0 / law.exponent), rel=1e-9)
        np.testing.assert_allclose(bearing.force[:2] / size, bearing.deflection[:2] / reach, atol=1e-9)
        np.testing.assert_allclose(bearing.stiffness[:2, :2], law.tangent(bearing.force[:2]), rtol=1e-6)
    total = sum(bearing.force for bearing in point.bearings if bearing.mounted.rotor == "in")
    assert np.hypot(*total[:2]) == pytest.approx(point.pairs[0].force, rel=1e-9)


@settings(max_examples=4)
@given(st.floats(-math.pi, math.pi), st.sampled_from([-1, 1]), st.floats(20.0, 300.0))
def test_the_machine_may_stand_at_any_angle(angle: float, sense: int, torque: float) -> None:
    """About its first axis, on bearings alike in all directions: forces turn with it, and nothing else changes."""
    teeth = [GearPair("pinion", "wheel", "weber-banaschek", backlash=1e-4)]
    apart = distance(*TEETH, 1.0)
    still = one_stage(stiffness=ISOTROPIC, gear_pairs=teeth, torque=sense * torque)
    turned = replace(
        still,
        shafts=[still.shafts[0], replace(still.shafts[1], axis=(apart * math.cos(angle), apart * math.sin(angle)))],
    )
    one, other = still.operating_point(), turned.operating_point()
    c, s = math.cos(angle - 0.4), math.sin(angle - 0.4)
    whole = np.zeros((5, 5))
    whole[:2, :2] = whole[3:, 3:] = [[c, -s], [s, c]]
    whole[2, 2] = 1.0
    for first, second in zip(one.bearings, other.bearings, strict=True):
        np.testing.assert_allclose(second.force, whole @ first.force, atol=1e-7 * one.pairs[0].force)
    assert other.pairs[0].misalignment == pytest.approx(one.pairs[0].misalignment, rel=1e-6)
    assert other.pairs[0].k_h_beta == pytest.approx(one.pairs[0].k_h_beta, rel=1e-6)


def test_stiff_parts_have_no_share_in_the_misalignment() -> None:
    """Each cause vanishes with the compliance that makes it, and the shares are the whole."""
    hard = np.diag([1e13, 1e13, 1e13, 1e11, 1e11])
    soft = spur(ISOTROPIC)
    (given,) = soft.operating_point().pairs
    assert set(given.misalignment_by_cause) == set(CAUSES)
    assert sum(given.misalignment_by_cause.values()) == pytest.approx(given.misalignment, rel=1e-9)
    assert given.misalignment_by_cause["housing"] == 0.0
    (stiff,) = spur(hard).operating_point().pairs
    assert abs(stiff.misalignment_by_cause["bearings"]) < 1e-4 * abs(stiff.misalignment)
    material = replace(STEEL, youngs_modulus=1e3 * STEEL.youngs_modulus, shear_modulus=1e3 * STEEL.shear_modulus)
    shafts = [
        replace(
            one, rotor=replace(one.rotor, segments=[replace(part, material=material) for part in one.rotor.segments])
        )  # type: ignore[arg-type]
        for one in soft.shafts
    ]
    # The bodies of the gears are stiff as well; the mesh has its stiffness given.
    bodies = [replace(one, gear=replace(one.gear, youngs_modulus=1e3 * one.gear.youngs_modulus)) for one in soft.gears]
    (rigid,) = replace(soft, shafts=shafts, gears=bodies).operating_point().pairs
    for cause in ("shafts", "bodies"):
        assert abs(rigid.misalignment_by_cause[cause]) < 2e-3 * abs(given.misalignment_by_cause[cause])
    # Rigid shafts tilt as their bearings give: by the difference of their deflections over their distance.
    point = replace(soft, shafts=shafts, gears=bodies).operating_point()
    tilt = 0.0
    for shaft, side, (left, right) in (("in", 1.0, (0.016, 0.164)), ("out", -1.0, (0.01, 0.154))):
        first, last = (point.bearing(f"{shaft} {at}").deflection[:2] for at in (left, right))
        tilt += side * float(np.array(rigid.pair.push) @ (last - first)) / (right - left)
    assert rigid.misalignment == pytest.approx(-tilt, rel=1e-2)


def test_five_stations_over_the_face_are_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    machine = one_stage(gear_pairs=[GearPair("pinion", "wheel", "weber-banaschek")])
    (coarse,) = machine.operating_point().pairs
    monkeypatch.setattr("gearwhine.coupling.gears.contact.face_slices.FACE_STATIONS", 9)
    (fine,) = machine.operating_point().pairs
    assert coarse.misalignment == pytest.approx(fine.misalignment, rel=2e-3)
    assert coarse.k_h_beta == pytest.approx(fine.k_h_beta, rel=5e-3)
    assert coarse.misalignment_by_cause["bodies"] == pytest.approx(fine.misalignment_by_cause["bodies"], rel=1.5e-2)


def test_a_train_at_rest_is_one_that_hardly_turns() -> None:
    """Three gears: the second pair's driver turns backwards, and stands with the same flanks in touch."""
    turning, still = (idler(speed=speed) for speed in (1e-9, 0.0))
    senses = [math.copysign(1.0, value) for value in still.speeds.values()]
    assert senses == [1.0, -1.0, 1.0]
    for first, second in zip(turning.assembled.system.contacts, still.assembled.system.contacts, strict=True):
        np.testing.assert_allclose(second.direction, first.direction, rtol=1e-12, atol=1e-12)
    first, second = (np.abs(machine.modes().eigenvalues) for machine in (turning, still))
    np.testing.assert_allclose(second, first, rtol=1e-6, atol=1e-2)
    forces = [[one.force for one in machine.operating_point().pairs] for machine in (turning, still)]
    assert forces[1] == pytest.approx(forces[0])
    parts = still.assembled
    alike = assemble_machine(parts.rotors, None, speeds=dict.fromkeys(still.speeds, 0.0), meshes=parts.meshes)
    for first, second in zip(parts.system.contacts, alike.system.contacts, strict=True):
        np.testing.assert_array_equal(second.direction, first.direction)


def belt_drive(force: tuple[float, float, float], stiffness: npt.ArrayLike = RADIAL) -> Machine:
    """A shaft on two bearings 120 mm apart, pulled 40 mm beside the left one."""
    held = [
        MountedBearing(linear_bearing(name, at, stiffness), "shaft", None) for name, at in (("l", 0.05), ("r", 0.17))
    ]
    shaft = Shaft(Rotor("shaft", [Segment(0.2, 0.03, 0.0, STEEL)]))
    return Machine([shaft], held, speed=100.0, forces=[ShaftForce("shaft", 0.01, force)])


@pytest.mark.parametrize("moving", [False, True], ids=["operating point", "coupled system"])
def test_a_belt_pulls_on_an_overhung_shaft_end(moving: bool) -> None:
    """By the lever: 4/3 of the pull on the near bearing and -1/3 on the far one, on springs of 1e8 N/m."""
    machine = belt_drive((900.0, -600.0, 0.0))
    if moving:
        system = machine.assembled.system
        q = static_equilibrium(system)
        left, right = (one.stiffness @ (one.directions.T @ q) for one in system.linear)
    else:
        left, right = (one.force[:2] for one in machine.operating_point().bearings)
    assert left == pytest.approx([1200.0, -800.0], rel=1e-6)
    assert right == pytest.approx([-300.0, 200.0], rel=1e-6)


def test_a_belt_bends_an_overhung_shaft_end() -> None:
    """Its end sags by F a² (l + a) / 3 E I, by the shear of the overhang and the span, and by the springs."""
    machine, (a, span) = belt_drive((900.0, 0.0, 0.0)), (0.04, 0.12)
    second, area, ratio = math.pi / 64 * 0.03**4, math.pi / 4 * 0.03**2, STEEL.poisson_ratio
    sheared = 6 * (1 + ratio) / (7 + 6 * ratio) * STEEL.shear_modulus * area
    bent = a**2 * (span + a) / (3.0 * STEEL.youngs_modulus * second) + a * (1.0 + a / span) / sheared
    sunk = ((1.0 + a / span) ** 2 + (a / span) ** 2) / 1e8
    (found,) = machine.operating_point().shafts[0].motions([0.01])[0]
    assert found == pytest.approx(900.0 * (bent + sunk), rel=1e-6)


def test_forces_move_bearings_of_the_coupled_system_as_the_operating_point() -> None:
    """What forces across and along the axis add to the bearings' loads, beside the teeth of a helical pair.

    The loads themselves differ more: the modal shafts stand without solid gears, and their teeth on one section.
    """
    forces = [ShaftForce("in", 0.0, (900.0, -600.0, 0.0)), ShaftForce("out", 0.16, (0.0, 700.0, -400.0))]
    machines = one_stage(forces=forces), one_stage()
    points, systems = [one.operating_point() for one in machines], [one.assembled.system for one in machines]
    moved = [static_equilibrium(system) for system in systems]
    for number, name in enumerate(one.name for one in points[0].bearings):
        added = points[0].bearing(name).force[:3] - points[1].bearing(name).force[:3]
        linear = [system.linear[number] for system in systems]
        ours, none = (one.stiffness @ (one.directions.T @ q) for one, q in zip(linear, moved, strict=True))
        assert (ours - none)[:3] == pytest.approx(added, abs=0.005 * 900.0)
    again = machines[0].assembled.at_speed(machines[0].speed).system
    np.testing.assert_allclose(again.load, systems[0].load, rtol=1e-12)


@pytest.mark.parametrize("moving", [False, True], ids=["operating point", "coupled system"])
def test_a_pedestal_sinks_by_its_own_weight_and_that_of_its_shaft(moving: bool) -> None:
    """By the lever the right bearing, 50 mm from the middle of the shaft, carries 5/12 of it; g lies across, too."""
    mass, stiffness = 7.0, np.diag([4e6, 3e6])
    gravity = np.array([2.0, -9.0, 0.0])
    plain = belt_drive((0.0, 0.0, 0.0))
    right = plain.bearings[1]
    on_pedestal = replace(right.bearing, pedestal=Pedestal(stiffness, np.zeros((2, 2)), mass))
    machine = replace(plain, bearings=[plain.bearings[0], replace(right, bearing=on_pedestal)], gravity=gravity)
    carried = 5.0 / 12.0 * math.pi / 4 * 0.03**2 * 0.2 * STEEL.density
    sunk = np.linalg.solve(stiffness, (mass + carried) * gravity[:2])
    if moving:
        parts = machine.assemble()
        (pedestal,) = (one for one in parts.system.components if isinstance(one, PedestalComponent))
        q = static_equilibrium(parts.system)
        found = pedestal.motion @ q[-2:]
    else:
        found = machine.operating_point().bearings[1].seat_motion[:2]
    np.testing.assert_allclose(found, sunk, rtol=1e-6)


def test_forces_off_the_shafts_or_that_nothing_holds_are_refused() -> None:
    with pytest.raises(
        CouplingError, match=r"forces\[0\].rotor is 'belt'; expected the name of a shaft of this machine .'in', 'out'"
    ):
        one_stage(forces=[ShaftForce("belt", 0.0, (1.0, 0.0, 0.0))])
    with pytest.raises(CouplingError, match=r"forces\[0\].at is 0.5; expected a station on rotor"):
        one_stage(forces=[ShaftForce("in", 0.5, (1.0, 0.0, 0.0))])
    pushed = belt_drive((0.0, 0.0, 50.0))
    with pytest.raises(CouplingError, match="a force of 50 N along z on rotor 'shaft', which no bearing holds"):
        _ = pushed.assembled
    with pytest.raises(CouplingError, match="nothing holds the axial motion of shaft 'shaft', and the loads drive it"):
        pushed.operating_point()


def test_tapered_rollers_hold_a_shaft_between_them() -> None:
    """One row at each end, each for one sense of thrust (O arrangement), pressed together by a small interference.

    Every radial load of a tapered row makes a thrust of its own, so both rows carry; their difference is the gears'.
    """
    row = TaperedRollerRow(15, 8e-3, 12e-3, 55e-3, angle=0.25)
    machine = one_stage()
    held = [
        MountedBearing(
            linear_bearing(one.bearing.name, one.bearing.at, np.zeros((5, 5))),
            one.rotor,
            None,
            rolling=RollingBearing([replace(row, direction=direction, axial_offset=10e-6)], name=one.bearing.name),
        )
        for one, direction in zip(machine.bearings, (1, -1, 1, -1), strict=True)
    ]
    point = replace(machine, bearings=held).operating_point()
    assert point.residual <= 1e-9
    thrust = abs(point.pairs[0].thrust)
    for shaft in ("in", "out"):
        left, right = (one.force[2] for one in point.bearings if one.mounted.rotor == shaft)
        assert left > 0.0 > right
        assert abs(left + right) == pytest.approx(thrust, rel=1e-6)


@pytest.mark.parametrize("beside", [-8e-6, -6e-6, -4e-6, -2e-6, 2e-6, 4e-6, 6e-6, 8e-6, 14e-6, 20e-6])
def test_a_bearing_may_stand_micrometres_beside_a_force(beside: float) -> None:
    """A span so short is 1e12 times as stiff as ball bearings in their play, which carry what the force adds."""
    rollers = TaperedRollerRow(15, 8e-3, 12e-3, 55e-3, angle=0.25)
    balls = RollingBearing([BallRow(9, 11e-3, 53.5e-3, clearance=8e-6)])
    elements = [
        RollingBearing([replace(rollers, axial_offset=20e-6)]),
        RollingBearing([replace(rollers, direction=-1)]),
        replace(balls, floating=True),
        balls,
    ]
    pulled, pull = 0.14, (800.0, -1500.0, 0.0)
    machine = one_stage(forces=[ShaftForce("out", pulled, pull)])
    held = [
        MountedBearing(
            linear_bearing(one.bearing.name, one.bearing.at if place < 3 else pulled + beside, np.zeros((5, 5))),
            one.rotor,
            None,
            rolling=bearing,
        )
        for place, (one, bearing) in enumerate(zip(machine.bearings, elements, strict=True))
    ]
    point = replace(machine, bearings=held).operating_point()
    carried = sum(one.force[:3] for one in point.bearings if one.mounted.rotor == "out")
    assert carried == pytest.approx(point.gear_forces(0)[1][:3] + pull, abs=1e-4)


def test_flanks_and_bearings_hold_each_shaft_in_balance() -> None:
    """Forces and moments about the left end, of the gear at its middle and of the bearings at theirs; torque by T."""
    machine = one_stage(gear_pairs=[GearPair("pinion", "wheel", "weber-banaschek", backlash=1e-4)])
    point = machine.operating_point()
    (pair,) = point.pairs
    torques = {one.rotor: one.value for one in machine.constant_torques}
    for gear, flanks in zip((pair.pair.driver, pair.pair.driven), point.gear_forces(0), strict=True):
        total = flanks + moved(flanks, gear.at)
        for one in point.bearings:
            if one.mounted.rotor == gear.shaft:
                force = -np.append(one.force, 0.0)
                total += force + moved(force, one.mounted.bearing.at)
        total[5] += torques[gear.shaft]
        assert total[:3] == pytest.approx(np.zeros(3), abs=1e-7 * pair.force)
        assert total[3:] == pytest.approx(np.zeros(3), abs=1e-8 * pair.force)
        # The thrust at the pitch point tilts the shaft: without moments the balance would miss this much.
        radius = pair.pair.geometry.working_pitch_radii[int(gear is pair.pair.driven)]
        assert float(np.hypot(*flanks[3:5])) == pytest.approx(abs(pair.thrust) * radius, rel=0.3)


def moved(force: FloatArray, at: float) -> FloatArray:
    """Moment about the left end of a force at a place on the axis, in six components."""
    return np.array([0.0, 0.0, 0.0, -at * force[1], at * force[0], 0.0])


def test_a_gear_with_a_rim_does_not_stiffen_its_shaft() -> None:
    """A solid pinion bends with its shaft and stiffens it; a rim on a web stands on one section of the bare shaft."""
    solid = one_stage()
    rims = [replace(one, gear=replace(one.gear, rim_thickness=4e-3, web_thickness=5e-3)) for one in solid.gears]
    webbed = replace(solid, gears=rims)
    places = np.linspace(0.02, 0.14, 9)
    for first, second in zip(solid.operating_point().shafts, webbed.operating_point().shafts, strict=True):
        assert np.ptp(first.motions(places)[:2]) < np.ptp(second.motions(places)[:2])
    (pair,) = webbed.operating_point().pairs
    assert pair.misalignment_by_cause["bodies"] == pytest.approx(0.0, abs=1e-15)


def test_the_load_of_a_pair_is_that_of_flanks_with_its_gap() -> None:
    """Spur teeth see the machine's deflection as a gap over the face, as if their flanks had been ground so."""
    machine = spur(gear_pairs=[GearPair("pinion", "wheel", "weber-banaschek")])
    (pair,) = machine.operating_point().pairs
    geometry = pair.pair.geometry
    assert pair.force == pytest.approx(150.0 / geometry.driver.base_radius, rel=1e-9)
    model = stiffness_under_load("weber-banaschek", geometry, pair.force)
    contact = tooth_contact(geometry, model, corner_contact=True, faces=replace(face_slices(geometry), gap=pair.gap))
    ground = loaded_transmission_error(contact, pair.force, pair.fine.phases)
    assert ground.line_loads is not None
    load = ground.line_loads.sum(axis=1).mean(axis=0)
    assert float(load.max() / load.mean()) == pytest.approx(pair.line_load.max() / pair.line_load.mean(), rel=1e-6)
    # K_Hβ is that at the end of the face, half a slice further.
    heavy = load if load[0] > load[-1] else load[::-1]
    step = heavy[0] - heavy[1]
    assert pair.k_h_beta * load.mean() - heavy[0] == pytest.approx(0.5 * step, rel=0.2)
    np.testing.assert_allclose(pair.transmission_error, ground.transmission_error, rtol=1e-6)
    assert pair.mean_stiffness == pytest.approx(ground.tangent_stiffness.mean(), rel=1e-6)
    assert pair.gap.mean() == pytest.approx(0.0, abs=1e-12)
    assert np.polyfit(pair.z, pair.gap, 1)[0] == pytest.approx(pair.misalignment, rel=1e-9)
    # The flanks carry more where the gap is less.
    assert (pair.line_load.argmax() == 0) == (pair.misalignment > 0.0)


def test_the_common_face_carries_wherever_it_lies() -> None:
    """A wheel wider than its pinion is pressed where the pinion is, 8 mm off its own middle or not.

    Its teeth go on far enough at either side to support those in mesh alike. Its shaft is stiffer than its body, so
    that the place of the body does not matter.
    """
    machine = spur(gear_pairs=[GearPair("pinion", "wheel", "weber-banaschek")])
    moduli = STEEL.youngs_modulus, STEEL.shear_modulus
    stiff = [StiffnessDiameter(0.0, 0.16, 0.14, 0.14, *moduli)]
    thick = replace(machine.shafts[1], rotor=replace(machine.shafts[1].rotor, stiffness_diameters=stiff))
    wide = replace(machine.gears[1], gear=replace(machine.gears[1].gear, face_width=90e-3))
    centred, moved = (
        replace(
            machine, shafts=[machine.shafts[0], thick], gears=[machine.gears[0], replace(wide, at=wide.at + shift)]
        ).operating_point()
        for shift in (0.0, 8e-3)
    )
    for one, other in zip(centred.bearings, moved.bearings, strict=True):
        np.testing.assert_allclose(other.force, one.force, rtol=0.0, atol=1e-7 * centred.pairs[0].force)
    assert moved.pairs[0].misalignment == pytest.approx(centred.pairs[0].misalignment, rel=1e-7)


def test_a_face_beyond_the_end_of_its_shaft_is_rigid_on_it() -> None:
    """On a shaft that is hard under the pinion it is the same, whether the shaft ends within the face or after it."""
    hard = replace(STEEL, youngs_modulus=1e4 * STEEL.youngs_modulus, shear_modulus=1e4 * STEEL.shear_modulus)
    machine = spur(ISOTROPIC, gear_pairs=[GearPair("pinion", "wheel", "weber-banaschek")])
    held = [replace(one, bearing=replace(one.bearing, at=0.5 * one.bearing.at)) for one in machine.bearings[:2]]
    gears = [replace(machine.gears[0], at=0.1), replace(machine.gears[1], at=0.1)]
    found = []
    for beyond in (-1e-3, 5e-3):
        segments = [Segment(0.0875, 0.03, 0.0, STEEL), Segment(0.025 + beyond, 0.06, 0.0, hard)]
        parts = [replace(machine.shafts[0], rotor=Rotor("in", segments)), machine.shafts[1]]
        given = replace(machine, shafts=parts, bearings=[*held, *machine.bearings[2:]], gears=gears)
        found.append(given.operating_point().pairs[0])
    within, after = found
    assert within.pair.driver.arms[-1] - after.pair.driver.arms[-1] == pytest.approx(1e-3)
    assert within.misalignment == pytest.approx(after.misalignment, rel=1e-3)
    assert abs(within.misalignment) > 1e-5


def test_braking_gears_first_turn_through_their_backlash() -> None:
    """The mean approach of the back flanks is the backlash and the deflection of the teeth."""
    teeth = [GearPair("pinion", "wheel", "weber-banaschek", backlash=1.3e-4)]
    drive, brake = (spur(ISOTROPIC, gear_pairs=teeth, torque=torque).operating_point().pairs[0] for torque in (90, -90))
    for pair, gap in ((drive, 0.0), (brake, 1.3e-4)):
        mean = float(pair.pair.contact.face_mean @ pair.approach)
        assert mean == pytest.approx(gap + pair.mean.deflection.mean(), rel=1e-6)
    assert brake.force == pytest.approx(drive.force, rel=1e-8)


def test_the_mean_load_is_that_of_sound_teeth() -> None:
    """One pitted tooth and pitch deviations move the teeth as they pass, and not the mean over a hunting period."""
    teeth = [GearPair("pinion", "wheel", "weber-banaschek")]
    machine = spur(ISOTROPIC, gear_pairs=teeth)
    damaged = replace(machine.gears[0].gear, faults=(Spall(0, 0.3, 0.45, 50e-6),), pitch_deviations=(5e-6, *[0.0] * 22))
    (expected,) = machine.operating_point().pairs
    (found,) = (
        replace(machine, gears=[replace(machine.gears[0], gear=damaged), machine.gears[1]]).operating_point().pairs
    )
    np.testing.assert_array_equal(found.line_load, expected.line_load)
    assert found.misalignment == expected.misalignment
