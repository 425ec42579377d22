"""Parts of a sensor's lines against responses of the whole machine that were solved by themselves, and their names."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.case import load_case
from gearwhine.coupling import (
    CoupledMachine,
    CouplingError,
    MachineLoads,
    MountedBearing,
    Torque,
    Unbalance,
    assemble_machine,
    coupled_modes,
)
from gearwhine.coupling.linear.frequency_response import mesh_error_response
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.machine.loads import TorqueRipple
from gearwhine.coupling.signals import housing_paths, line_names, mode_parts
from gearwhine.coupling.time.histories import modal_record, transient_outputs, with_modal_rows
from gearwhine.from_case.gear_pairs import solve_gears
from gearwhine.solve.machine import build_machine

MODES = 4


def housing(seed: int = 2) -> HousingComponent:
    """Four modes and two attachments of no particular housing; its damping couples them."""
    random = np.random.default_rng(seed)
    frequencies = 2.0 * np.pi * np.array([300.0, 900.0, 1500.0, 2600.0, 9000.0, 12000.0])
    root = random.normal(size=(6, 2))
    return HousingComponent(
        name="housing",
        kinds=("housing",) * MODES + ("residual",) * 2,
        stiffness=np.diag(frequencies**2),
        damping=np.diag(0.04 * frequencies) + 5.0 * root @ root.T,
        gyroscopic=np.zeros((6, 6)),
        seats={name: 0.2 * random.normal(size=(6, 6)) for name in ("one", "two", "three", "four")},
        seat_z=dict.fromkeys(("one", "two", "three", "four"), 0.0),
        sensors={"top": 0.2 * random.normal(size=6), "end": 0.2 * random.normal(size=6)},
    )


@pytest.fixture(scope="module")
def grounded() -> CoupledMachine:
    case = load_case("spur-pair").case
    return build_machine(case, None, solve_gears(case))


def on_housing(machine: CoupledMachine, seed: int = 2) -> CoupledMachine:
    """The machine with its bearings in seats of the housing."""
    seats = ("one", "two", "three", "four")
    return assemble_machine(
        machine.rotors,
        housing(seed),
        speeds=machine.speeds,
        bearings=[
            MountedBearing(mounted.bearing, mounted.rotor, seat)
            for mounted, seat in zip(machine.bearings, seats, strict=True)
        ],
        meshes=machine.meshes,
        loads=MachineLoads(torques=[Torque(torque.rotor, torque.at, torque.value) for torque in machine.loads.torques]),
    )


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 1000), st.lists(st.floats(20.0, 4000.0), min_size=1, max_size=4))
def test_bearings_and_modes_add_up_to_the_line(grounded: CoupledMachine, seed: int, hertz: list[float]) -> None:
    """The machine's response to a transmission error is solved whole; the paths know its bearing forces alone."""
    machine = on_housing(grounded, seed)
    w = 2.0 * np.pi * np.array(hertz)
    response = mesh_error_response(machine, w)
    forces = {}
    ties = machine.system.linear[: len(machine.bearings)]
    for tie in ties:
        deflection = response.coordinates @ tie.directions
        forces[tie.name] = deflection @ tie.stiffness.T + (1j * w[:, None] * deflection) @ tie.damping.T
    found = housing_paths(machine, w, forces)
    assert found.bearings == tuple(tie.name for tie in ties)
    start = sum(part.size for part in machine.rotors)
    modal = -(w[:, None] ** 2) * response.coordinates[:, start : start + MODES]
    for sensor, line in response.sensor_acceleration.items():
        paths = found.at(sensor)
        close = {"rtol": 1e-9, "atol": 1e-9 * np.abs(line).max()}
        np.testing.assert_allclose(paths.by_bearing.sum(axis=1), line, **close)
        np.testing.assert_allclose(paths.total, line, **close)
        recorded = mode_parts(machine.housing, sensor, modal, line)
        np.testing.assert_allclose(recorded.sum(axis=1), line, **close)
        # By recorded motion and by receptance the modes put in the same, and so does what they leave out.
        np.testing.assert_allclose(paths.by_mode, recorded, rtol=1e-7, atol=1e-9 * np.abs(recorded).max())


def test_paths_that_cannot_be_followed(grounded: CoupledMachine) -> None:
    machine = on_housing(grounded)
    w = np.array([1000.0])
    with pytest.raises(CouplingError, match="no housing"):
        housing_paths(grounded, w, {})
    with pytest.raises(CouplingError, match="frequency of 0"):
        housing_paths(machine, 0.0 * w, {})
    with pytest.raises(CouplingError, match="forces of shape none"):
        housing_paths(machine, w, {})
    forces = {tie.name: np.ones((1, tie.directions.shape[1]), dtype=complex) for tie in machine.system.linear}
    with pytest.raises(CouplingError, match="no sensor 'side'; there are: top, end"):
        housing_paths(machine, w, forces).at("side")


def test_modal_rows_are_recorded_after_the_others(grounded: CoupledMachine) -> None:
    """Rows times a motion, by hand: the housing's coordinates themselves, and names of every rotor's modes."""
    machine = on_housing(grounded)
    plain = transient_outputs(machine)
    outputs = with_modal_rows(machine, plain, 2)
    assert len(outputs.acceleration) == len(plain.acceleration) + MODES
    q = np.random.default_rng(4).normal(size=machine.system.size)

    class Record:
        times = np.zeros(1)
        displacement = (outputs.displacement @ q)[None]
        velocity = (outputs.velocity @ q)[None]
        acceleration = (outputs.acceleration @ q)[None]
        compression = force = np.zeros((1, 1))

    found = modal_record(machine, Record(), 2)
    start = sum(part.size for part in machine.rotors)
    np.testing.assert_array_equal(found.housing_acceleration[0], q[start : start + MODES])
    assert found.coordinates["housing: mode 2"][0] == q[start + 1]
    torsion = 2 * machine.rotors[0].plane_size
    assert found.coordinates["input: torsion 1"][0] == q[torsion]
    assert [name for name in found.coordinates if name.startswith("input")] == [
        f"input: {kind}"
        for kind in ("torsion 1", "torsion 2", "bending 1, x", "bending 2, x", "bending 1, y", "bending 2, y")
    ]
    assert not modal_record(grounded, Record(), 0).coordinates


def imperfect(machine: CoupledMachine, **loads: Any) -> CoupledMachine:
    """The machine on its housing with loads of its own beside the torques."""
    torques = [Torque(torque.rotor, torque.at, torque.value) for torque in machine.loads.torques]
    return assemble_machine(
        machine.rotors,
        machine.housing,
        speeds=machine.speeds,
        bearings=machine.bearings,
        meshes=machine.meshes,
        loads=MachineLoads(**{"torques": torques} | loads),
    )


def with_pitch_errors(machine: CoupledMachine) -> CoupledMachine:
    """The machine with one tooth of its driver 5 µm off, which the mesh meets once a turn: every order of the shaft."""
    geometry = machine.meshes[0].geometry
    deviations = (5e-6, *(0.0,) * (geometry.driver.teeth - 1))
    uneven = replace(geometry, driver=replace(geometry.driver, pitch_deviations=deviations))
    return imperfect(replace(machine, meshes=(replace(machine.meshes[0], geometry=uneven),)))


def test_lines_are_named_after_what_excites_them(grounded: CoupledMachine) -> None:
    machine = with_pitch_errors(on_housing(grounded))
    modes = coupled_modes(machine.system)
    shafts = {name: abs(speed) / (2.0 * np.pi) for name, speed in machine.speeds.items()}
    mesh = shafts["input"] * machine.meshes[0].geometry.driver.teeth
    pair = f"{machine.meshes[0].driver.name} -> {machine.meshes[0].driven.name}"
    ringing = int(np.flatnonzero([kind == "housing" for kind in modes.kinds])[0])
    own = float(modes.eigenvalues[ringing].imag) / (2.0 * np.pi)
    frequencies = [0.0, mesh, 2.0 * mesh, mesh + shafts["input"], 2.0 * shafts["input"], own, 9.0 * shafts["input"]]
    found = line_names(machine, frequencies, 1e-3, modes)
    assert [line.kind for line in found] == ["mean", "mesh", "mesh", "sideband", "shaft", "mode", "shaft"]
    assert found[1].name == f"1× {pair}"
    assert found[2].name == f"2× {pair}"
    assert found[3].name == f"1× {pair} + 1× input"
    assert found[4].name == "2× input"
    assert found[5].mode == ringing
    assert found[5].name == "housing mode"
    assert found[6].name == "9× input"
    assert found[1].order == pytest.approx(machine.meshes[0].geometry.driver.teeth)
    (other,) = line_names(machine, [0.37 * shafts["input"]], 1e-3)
    assert (other.kind, other.name) == ("other", "0.37× input")
    with pytest.raises(CouplingError, match="within 0"):
        line_names(machine, [1.0], 0.0)


def test_orders_that_nothing_excites_name_no_line(grounded: CoupledMachine) -> None:
    """Shafts in balance with perfect teeth have no harmonics; unbalance has the first; a ripple its own order."""
    perfect = on_housing(grounded)
    turning = abs(perfect.speeds["input"]) / (2.0 * np.pi)
    mesh = turning * perfect.meshes[0].geometry.driver.teeth
    frequencies = [turning, 2.0 * turning, 6.0 * turning, mesh + turning, mesh]

    def kinds(machine: CoupledMachine) -> list[str]:
        return [line.kind for line in line_names(machine, frequencies, 1e-3)]

    assert kinds(perfect) == ["other", "other", "other", "other", "mesh"]
    unbalanced = imperfect(perfect, unbalances=[Unbalance("input", 0.0, 1e-5, 0.0)])
    assert kinds(unbalanced) == ["shaft", "other", "other", "sideband", "mesh"]
    assert kinds(imperfect(perfect, unbalances=[Unbalance("input", 0.0, 0.0, 0.0)])) == kinds(perfect)
    ripple = imperfect(perfect, torques=[*perfect.loads.torques, TorqueRipple("input", 0.0, 1.0, order=2.0)])
    assert kinds(ripple)[:2] == ["other", "shaft"]
    assert kinds(with_pitch_errors(perfect)) == ["shaft", "shaft", "shaft", "sideband", "mesh"]


def test_a_mode_that_is_nearer_than_an_order_names_the_line(grounded: CoupledMachine) -> None:
    """Between an order and a mode, each 1 Hz and less from a line, the nearer one is its cause."""
    plain = with_pitch_errors(on_housing(grounded))
    turning = abs(plain.speeds["input"]) / (2.0 * np.pi)
    modes = coupled_modes(plain.system)
    imaginary = modes.eigenvalues.imag[[kind == "housing" for kind in modes.kinds]] / (2.0 * np.pi)
    own = float(imaginary[np.argmin(np.abs(imaginary - 1500.0))])
    multiple = round(own / turning)
    assert multiple < plain.meshes[0].geometry.driver.teeth - 4  # no sideband
    # A speed of which this multiple is 1 Hz above the mode, which follows the speed a little.
    speed = plain.speeds["input"]
    for _ in range(4):
        machine = plain.at_speed(speed)
        modes = coupled_modes(machine.system)
        imaginary = modes.eigenvalues.imag / (2.0 * np.pi)
        own = float(imaginary[np.argmin(np.abs(imaginary - own))])
        speed = np.sign(speed) * 2.0 * np.pi * (own + 1.0) / multiple
    order = abs(machine.speeds["input"]) * multiple / (2.0 * np.pi)
    assert order == pytest.approx(own + 1.0, abs=0.01)
    near_mode, near_order = line_names(machine, [own + 0.2, order - 0.2], 2.0, modes)
    assert (near_mode.kind, near_order.kind) == ("mode", "shaft")
    assert near_order.name == f"{multiple}× input"
    # What the line's frequency is known within, and no more, is what an order may be off.
    assert line_names(machine, [order - 0.2], np.array([0.1]), None)[0].kind == "other"
