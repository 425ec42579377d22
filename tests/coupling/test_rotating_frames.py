"""Rotors in the frame of a carrier against independent equations, and connectors that turn against a rotating frame."""

from collections.abc import Collection
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from planetary_machines import set_parts
from scipy.linalg import expm

from gearwhine.coupling import (
    CoupledMachine,
    CoupledSystem,
    CouplingError,
    Machine,
    TransientOutputs,
    TransientSettings,
    simulate,
)
from gearwhine.coupling.analyses import modes_and_responses
from gearwhine.coupling.assembly import assemble_machine
from gearwhine.coupling.linear.carriers.turning_response import TurningResponse
from gearwhine.coupling.linear.complex_modes import coupled_modes, stability
from gearwhine.coupling.linear.frequency_response import response
from gearwhine.coupling.machine.base_motion import BaseHistory, BaseMotion
from gearwhine.coupling.machine.components import RotorComponent, rotor_component
from gearwhine.coupling.machine.connectors import LinearConnector, SpeedTable
from gearwhine.coupling.machine.coordinates import CoordinateLoads
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.machine.frames import Frames, in_frame, orders_and_quarter_turn, stiffness_in_frame
from gearwhine.coupling.machine.loads import TorqueOverTime
from gearwhine.coupling.machine.shaft_dashpots import ShaftDashpots, shaft_dashpots
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.statics.mean_mesh import mean_contact
from gearwhine.rotors import Disc, Rotor, Segment, ShaftMaterial, modal_rotor
from tests.machines.plane_planetary_set import (
    TEETH,
    eigenvalues,
    equal_angles,
    independent_matrices,
    plane_set,
)

PRESSURE_ANGLE = np.radians(20.0)
SUN_RATIO = 3  # speed of the sun over the carrier's


@cache
def _described(count: int, standing: tuple[str, ...] = (), damping: float = 0.0) -> Machine:
    """A set without a ring; the coordinates of some rotors are made to stand still."""
    parts = plane_set(equal_angles(count), pressure_angle=PRESSURE_ANGLE, with_ring=False, damping=damping)
    # A bearing with a force of its own, even of zero, is not alike all round.
    parts["bearings"] = [
        replace(mounted, offset=np.zeros(5)) if mounted.rotor in standing else mounted for mounted in parts["bearings"]
    ]
    return Machine(**parts)


def _assembled(machine: Machine, carrier_speed: float, speed_range: tuple[float, float] = (1.0, 1.0)) -> CoupledMachine:
    """The machine with sun and carrier driven at two speeds."""
    ratios = {"sun": float(SUN_RATIO), "carrier": 1.0}
    planet = 1.0 - (SUN_RATIO - 1.0) * TEETH[0] / TEETH[1]
    ratios |= {shaft.name: planet for shaft in machine.shafts if shaft.carrier}
    components = machine.rotor_components()
    return assemble_machine(
        components,
        None,
        speeds={name: ratio * carrier_speed for name, ratio in ratios.items()},
        bearings=machine.bearings,
        meshes=[machine._mesh(pair, components) for pair in machine.loaded_pairs()],
        torque_supports=machine.torque_supports,
        speed_ratios=ratios,
        speed_range=speed_range,
    )


@pytest.mark.parametrize(("count", "speed"), [(3, 0.0), (3, 300.0), (4, 1000.0)])
def test_frequencies_in_the_carriers_frame_are_those_of_independent_equations(count: int, speed: float) -> None:
    # Tilts of the bodies are no part of the plane; they are far from coinciding with its frequencies.
    found = np.sort(coupled_modes(_assembled(_described(count), speed).system).eigenvalues.imag)
    mass, coriolis, stiffness = independent_matrices(
        equal_angles(count), pressure_angle=PRESSURE_ANGLE, with_ring=False, carrier_speed=speed
    )
    expected = eigenvalues(mass, coriolis, stiffness).imag
    expected = np.sort(expected[expected > 1.0])
    near = found[np.argmin(np.abs(found[:, None] - expected), axis=0)]
    assert np.abs(near / expected - 1.0).max() < 1e-4
    assert len(expected) > 3 * count


@pytest.mark.parametrize("standing", [("sun",), ("carrier",), ("sun", "carrier")])
def test_response_does_not_depend_on_the_frames_of_the_coordinates(standing: Collection[str]) -> None:
    speed, w = 300.0, 2.0 * np.pi * 1210.0
    turning = _assembled(_described(3, tuple(standing), 1e-5), speed).system
    constant = _assembled(_described(3, (), 1e-5), speed).system
    assert any(part.turning for part in (*turning.linear, *turning.contacts))
    assert not any(part.turning for part in (*constant.linear, *constant.contacts))
    state, tooth = mean_contact(constant), constant.contacts[0]
    law = complex(state.stiffness[0], w * state.damping[0])
    expected = response(constant, (law * tooth.direction)[None, None, :], np.array([w]), state)[0, 0]
    model = TurningResponse(turning, mean_contact(turning), sidebands=3)
    found = {order: moved[0] for order, moved in model.respond(w, [({}, {0: 1.0})]).items()}
    start = 0
    for part in constant.components:
        size, m = part.size, part.plane_size
        x, y = expected[start : start + m], expected[start + m : start + 2 * m]
        scale = np.abs(expected[start : start + size]).max()
        if part.name == "sun" and "sun" in standing:
            # x + iy of a motion in the frame turns by e^{ift}: each circular part has its own frequency.
            for order, circle in ((1, 0.5 * (x + 1j * y)), (-1, 0.5 * (x - 1j * y))):
                assert np.abs(found[(order,)][start : start + m] - circle).max() < 1e-9 * scale
        else:
            assert np.abs(found[(0,)][start : start + size] - expected[start : start + size]).max() < 1e-9 * scale
        torsion = slice(start + 2 * m, start + size)
        assert np.abs(found[(0,)][torsion] - expected[torsion]).max() < 1e-9 * scale
        start += size


# ------------------------------------------------------------------------------------ a disc that runs up, in a frame

SPIN, FRAME = 300.0, 110.0
RUN = SpeedProfile(np.array([0.0, 0.06]), np.array([0.4, 1.6]))
SPRINGS, DASHPOT = 4e4, 30.0


def _disc() -> RotorComponent:
    steel = ShaftMaterial(210e9, 80e9, 7800.0)
    shaft = Rotor("disc", [Segment(0.4, 0.012, 0.0, steel)], [Disc(0.1, 3.0, 0.06, 0.033)])
    return rotor_component("disc", modal_rotor(shaft, [], count=3), start=0.0, damping_ratio=0.03)


def _running_up(frame: float) -> CoupledSystem:
    """The disc on springs and dashpots, alike all round, with an unbalance and a weight, in coordinates of a frame."""
    disc = _disc()
    where = np.vstack([disc.motions(at)[:2] for at in (0.0, 0.4)])
    coupling = ShaftDashpots("coupling", "disc", 0.1, 0.4, lateral=20.0, tilt=0.5)
    stretched, dashpots = shaft_dashpots(coupling, disc, SPIN - frame, (0.4, 1.6))
    plane = disc.motions(0.1)[:2]
    unbalance = HarmonicLoad(SPIN, 2.0 * (plane[0] - 1j * plane[1]), "unbalance")
    frames = Frames([disc], {"disc": frame})
    acting = frames.loads(CoordinateLoads(-30.0 * plane[1], [unbalance]))
    spring = np.kron(np.eye(2), stiffness_in_frame(SPRINGS * np.eye(5), DASHPOT * np.eye(5), frame)[:2, :2])
    damping = DASHPOT * np.eye(4)
    rates = np.array([0.4, 1.6])
    skew = spring - SPRINGS * np.eye(4)
    table = SpeedTable(rates, SPRINGS * np.eye(4) + rates[:, None, None] * skew, np.stack([damping, damping]))
    return CoupledSystem(
        (in_frame(disc, SPIN, frame),),
        (SPIN,),
        (
            LinearConnector("springs", where.T, spring, damping, table),
            replace(dashpots, directions=stretched.T),
        ),
        load=acting.constant,
        harmonic_loads=tuple(acting.harmonic),
        acceleration_load=np.zeros(disc.size) + acting.angular,
        centrifugal_load=np.zeros(disc.size) + acting.centrifugal,
    )


@pytest.mark.parametrize("frame", [FRAME, SPIN])
def test_a_run_up_does_not_depend_on_the_frame_of_the_coordinates(frame: float) -> None:
    """Coriolis, centripetal and gyroscopic terms, those of the angular acceleration, and all loads, by the speed."""
    disc = _disc()
    orders, quarter = orders_and_quarter_turn(disc)
    turn = orders[:, None] * quarter
    rng = np.random.default_rng(3)
    q, v = 1e-3 * rng.normal(size=disc.size) * orders, 0.1 * rng.normal(size=disc.size) * orders
    settings = TransientSettings(0.06, 0.0, 1e-3, 1e-4, tolerance=2e-6)
    outputs = TransientOutputs(np.eye(disc.size), np.eye(disc.size), np.eye(disc.size))
    still = simulate(_running_up(0.0), settings, outputs, speed_profile=RUN, initial=(q, v))
    start = q, v - 0.4 * frame * turn @ q
    moving = simulate(_running_up(frame), settings, outputs, speed_profile=RUN, initial=start)
    angles = frame * RUN.at(moving.times)[0]
    found = np.array([expm(angle * turn) @ y for angle, y in zip(angles, moving.displacement, strict=True)])
    size = np.abs(still.displacement).max(axis=0)
    assert np.abs(found - still.displacement).max() < 2e-4 * size.max()
    assert moving.energy.error < 1e-4
    assert still.energy.error < 1e-4


def test_the_rotation_of_a_set_as_a_whole_neither_grows_nor_decays() -> None:
    """Centripetal terms and the geometric stiffness of the pins cancel on it, whatever the speed."""
    modes = Machine(**set_parts() | {"speed": 3000.0}).modes()
    assert np.sum(modes.eigenvalues == 0.0) == 1
    assert stability(modes).growing == ()


def test_responses_with_directions_that_turn_are_no_superposition_of_modes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modes_and_responses, "resonance_grid", lambda *_, **__: np.array([2e3, 5e3]))
    turning, constant = (_assembled(_described(2, standing, 1e-5), 300.0) for standing in (("sun",), ()))
    assert modes_and_responses.solve_system(turning).superposition_error is None
    found = modes_and_responses.solve_system(constant).superposition_error
    assert found is not None
    assert 0.0 < found < 1e-6


def test_a_base_that_moves_over_time_under_a_turning_carrier_is_refused() -> None:
    """Its inertia loads would turn in the carrier's frame; harmonics are turned, as their frequencies are shifted."""
    parts = plane_set(equal_angles(3), pressure_angle=PRESSURE_ANGLE, with_ring=True)
    shaken = np.zeros((2, 6))
    shaken[:, 1] = 3.0
    over_time = BaseMotion((BaseHistory(np.array([0.0, 1.0]), shaken),))
    machine = Machine(**parts, speed=300.0, torque=200.0)
    with pytest.raises(CouplingError, match=r"over time moves 'sun', .* expected a base motion given by harmonics"):
        _ = replace(machine, base=over_time).assembled
    # Torques are the same in any frame, and the frames of a machine at rest are the ground's.
    twisted = TorqueOverTime(np.array([0.0, 1.0]), np.array([0.0, 5.0]))
    assert replace(machine, torque_over_time=twisted).assembled.system.timed_loads
    assert replace(machine, base=over_time, speed=0.0, torque=0.0).assembled.system.timed_loads


@pytest.mark.parametrize("standing", [(), ("sun",)])
def test_a_run_up_has_at_each_speed_the_terms_of_a_machine_at_that_speed(
    standing: tuple[str, ...],
) -> None:
    """Bearings' dashpots in a frame, the geometric stiffness of the pins, the planets' centrifugal forces."""
    described, speed = _described(3, standing, 2e-4), 400.0
    running = _assembled(described, speed, (0.3, 1.5)).system
    # Between the ends a term of s'^2 is a table's chord.
    for part, error in ((0.3, 1e-12), (1.0, 1e-3), (1.5, 1e-12)):
        steady = _assembled(described, part * speed).system
        assert [one.name for one in running.linear] == [one.name for one in steady.linear]
        followed = 0
        for found, expected in zip(running.linear, steady.linear, strict=True):
            table = found.over_speed
            laws = (found.stiffness, found.damping) if table is None else table.at(part)
            followed += table is not None
            for law, constant in zip(laws, (expected.stiffness, expected.damping), strict=True):
                assert np.allclose(law, constant, rtol=error, atol=error * np.abs(constant).max())
        # Three pins and the shafts' bearings with dashpots that are alike all round.
        assert followed > 3
        centrifugal = (part**2 - 1.0) * running.centrifugal_load
        assert np.abs(running.centrifugal_load).max() > 1.0
        assert np.allclose(running.load + centrifugal, steady.load, rtol=1e-12, atol=1e-9)
