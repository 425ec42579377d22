"""Rotors in the frame of a carrier against independent equations, and connectors that turn against a rotating frame."""

from collections.abc import Collection
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from planetary_machines import set_parts

from gearwhine.coupling import CoupledMachine, CouplingError, Machine
from gearwhine.coupling.analyses import modes_and_responses
from gearwhine.coupling.assembly import assemble_machine
from gearwhine.coupling.linear.complex_modes import coupled_modes, stability
from gearwhine.coupling.linear.frequency_response import mesh_error_response, response
from gearwhine.coupling.linear.turning_response import TurningResponse
from gearwhine.coupling.machine.base_motion import BaseHistory, BaseMotion
from gearwhine.coupling.machine.loads import TorqueOverTime
from gearwhine.coupling.statics.mean_mesh import mean_contact
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


def _assembled(machine: Machine, carrier_speed: float) -> CoupledMachine:
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
    found = {order: moved[0] for order, moved in model.respond(w, [model.mesh_error(0, w)]).items()}
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


def test_the_rotation_of_a_set_as_a_whole_neither_grows_nor_decays() -> None:
    """Centripetal terms and the geometric stiffness of the pins cancel on it, whatever the speed."""
    modes = Machine(**set_parts() | {"speed": 3000.0}).modes()
    assert np.sum(modes.eigenvalues == 0.0) == 1
    assert stability(modes).growing == ()


def test_responses_with_directions_that_turn_are_no_superposition_of_modes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modes_and_responses, "resonance_grid", lambda *_: np.array([2e3, 5e3]))
    turning, constant = (_assembled(_described(2, standing, 1e-5), 300.0) for standing in (("sun",), ()))
    solved = modes_and_responses.solve_system(turning)
    assert solved.superposition_error is None
    for number, found_together in enumerate(solved.responses):
        alone = mesh_error_response(turning, np.array([2e3, 5e3]), mesh=number)
        scale = np.abs(alone.coordinates).max()
        assert found_together.excitation == alone.excitation
        assert found_together.coordinates == pytest.approx(alone.coordinates, abs=1e-9 * scale)
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
