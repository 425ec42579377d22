"""Exponents of machines with turning carriers against multipliers of one turn, integrated anew; and frozen pictures."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from gearwhine.coupling import CoupledMachine, Machine
from gearwhine.coupling.assembly import assemble_machine
from gearwhine.coupling.linear import campbell
from gearwhine.coupling.linear.campbell import system_campbell
from gearwhine.coupling.linear.carriers.floquet_exponents import floquet_exponents, observed_frequencies
from gearwhine.coupling.linear.carriers.turning_response import TurningResponse
from gearwhine.coupling.linear.complex_modes import coupled_modes
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import LinearConnector, TurningPart
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.statics.mean_mesh import mean_contact
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from tests.machines.plane_planetary_set import STEEL, TEETH, equal_angles, plane_set
from tests.machines.turning_set import turning_machine


def _directions(at_start: FloatArray, parts: tuple[TurningPart, ...], time: float) -> tuple[FloatArray, FloatArray]:
    """Directions at a time, and their rates."""
    now, rate = at_start.copy(), np.zeros_like(at_start)
    for part in parts:
        angle = part.rate * time
        now += part.cosine * (np.cos(angle) - 1.0) + part.sine * np.sin(angle)
        rate += part.rate * (part.sine * np.cos(angle) - part.cosine * np.sin(angle))
    return now, rate


def _state_matrix(system: CoupledSystem, time: float) -> FloatArray:
    """First-order matrix of q and q' at a time: a connector has the force k Dᵀq + c (Dᵀq)'."""
    state, size = mean_contact(system), system.size
    stiffness, damping = system.own_stiffness.copy(), system.own_damping + system.gyroscopic
    laws = [(one.directions, one.stiffness, one.damping, one.turning) for one in system.linear]
    laws += [
        (tooth.direction[:, None], np.diag([k]), np.diag([c]), tooth.turning)
        for tooth, k, c in zip(system.contacts, state.stiffness, state.damping, strict=True)
    ]
    for directions, k, c, turning in laws:
        now, rate = _directions(directions, turning, time)
        stiffness += now @ (k @ now.T + c @ rate.T)
        damping += now @ c @ now.T
    return np.block([[np.zeros((size, size)), np.eye(size)], [-stiffness, -damping]])


def multipliers(system: CoupledSystem, period: float, steps: int) -> ComplexArray:
    """Eigenvalues of the monodromy over a period, by Magnus's series to the fourth order."""
    step, places = period / steps, (0.5 - np.sqrt(3.0) / 6.0, 0.5 + np.sqrt(3.0) / 6.0)
    whole = np.eye(2 * system.size)
    for number in range(steps):
        first, second = (_state_matrix(system, (number + place) * step) for place in places)
        exponent = 0.5 * step * (first + second)
        exponent += np.sqrt(3.0) / 12.0 * step**2 * (second @ first - first @ second)
        whole = expm(exponent) @ whole
    return np.asarray(np.linalg.eigvals(whole))


def _farthest(exponents: ComplexArray, found: ComplexArray, period: float) -> float:
    """Largest distance of an exponent, over the rate of turning, from those of the multipliers, modulo that rate."""
    apart = []
    for value in exponents:
        logarithms = np.log(found * np.exp(-value * period)) / period
        apart.append(np.abs(logarithms).min())
    return float(max(apart)) * period / (2.0 * np.pi)


def isotropic_machine(carrier_speed: float, *, standing: bool) -> CoupledMachine:
    """A set alike all round, its sun and carrier in the carrier's coordinates or in such as stand still."""
    parts = plane_set(
        equal_angles(3),
        pressure_angle=np.radians(20.0),
        with_ring=False,
        damping=1e-5,
        material=STEEL,
        diameter=0.05,
        mode_count=1,
    )
    # A bearing with a force of its own, even of zero, is not taken as alike all round.
    parts["bearings"] = [
        replace(one, offset=np.zeros(5)) if standing and one.rotor == "sun" else one for one in parts["bearings"]
    ]
    machine = Machine(**parts)
    ratios = {"sun": 3.0, "carrier": 1.0}
    ratios |= {shaft.name: 1.0 - 2.0 * TEETH[0] / TEETH[1] for shaft in machine.shafts if shaft.carrier}
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


def test_frozen_coordinates_of_the_carrier_are_exact_where_all_is_alike_all_round() -> None:
    speed = 1500.0
    constant, turning = (isotropic_machine(speed, standing=standing).system for standing in (False, True))
    assert turning.turns
    assert not constant.turns
    found = multipliers(turning, 2.0 * np.pi / speed, 120)

    def error(system: CoupledSystem) -> float:
        modes = coupled_modes(system)
        chosen = (modes.eigenvalues.imag > 0.0) & (np.abs(modes.eigenvalues) < 3e4)
        assert np.count_nonzero(chosen) > 15
        return _farthest(modes.eigenvalues[chosen], found, 2.0 * np.pi / speed)

    # Modes in the carrier's coordinates are those of the turning machine, and no modes of frozen directions are.
    assert error(constant) < 1e-3
    assert error(turning) > 0.05
    assert not coupled_modes(constant).warnings
    assert coupled_modes(turning).warnings[0]["name"] == "carrier frozen"


def test_a_campbell_diagram_with_turning_carriers_is_that_of_the_carriers_coordinates(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Equal planets on isotropic supports: in the frame of the carrier nothing turns, and eigenvalues are exact."""
    frame, still = (isotropic_machine(1500.0, standing=standing) for standing in (False, True))
    assert frame.leading_rotor == still.leading_rotor
    ratio = abs(frame.speeds["carrier"] / frame.speed)
    speeds = np.array([1000.0, 1060.0]) / ratio
    exact = system_campbell(frame, speeds, frequency_limit=1.8e4)
    told: list[float] = []
    diagram = system_campbell(
        still,
        speeds,
        frequency_limit=1.2e4,
        progress=lambda message, fraction=None: told.append(fraction or 0.0) if "exponents" in message else None,
    )
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert exact.exponents is None
    assert diagram.exponents is not None
    assert diagram.observed is None  # as nothing has a sensor
    assert diagram.turning_frequencies_hz == pytest.approx(diagram.exponents.imag / (2.0 * np.pi), nan_ok=True)
    # Of more modes the lowest are solved, and the others have no frequency.
    monkeypatch.setattr(campbell, "_TURNING_MODES", 3)
    few = system_campbell(still, speeds, frequency_limit=1.2e4)
    assert few.turning_frequencies_hz is not None
    assert np.count_nonzero(np.isfinite(few.turning_frequencies_hz), axis=1).tolist() == [3, 3]
    checked = 0
    for number, speed in enumerate((ratio * speeds).tolist()):
        families = (exact.eigenvalues[number][:, None] + 1j * speed * np.arange(-4, 5)).ravel()
        families = families[~np.isnan(families)]
        for value, frozen in zip(diagram.exponents[number], diagram.eigenvalues[number], strict=True):
            if not np.isnan(value):
                assert np.abs(families - value).min() < 1e-4 * abs(value)
                checked += np.abs(families - frozen).min() > 1e-3 * abs(frozen)
    assert checked > 5  # that no frozen picture has
    (told,) = diagram.warnings
    percent = 100.0 * (np.abs(diagram.eigenvalues) / np.abs(diagram.exponents) - 1.0)
    worst = percent.ravel()[np.nanargmax(np.abs(percent))]
    assert f"at 2 speeds, from which the largest error of a frequency is {worst:+.2g} %" in str(told["message"])


@pytest.mark.parametrize("turn", [0.4, 1.1])
def test_a_fixed_sensor_sees_a_mode_of_a_turning_frame_beside_its_frequency(turn: float) -> None:
    """z = R(Ωt) z_r e^{λt} is (z_x ± i z_y)/2 at λ ± iΩ: both are seen along x, and the larger acceleration counts."""
    ground, springs = 30.0 * np.eye(2), np.array([[40.0, 0.0], [0.0, 90.0]])
    dashpots = np.array([[0.2, 0.0], [0.0, 0.5]])
    quarter, zeros = np.array([[0.0, -1.0], [1.0, 0.0]]), np.zeros((2, 2))
    held = LinearConnector("springs", np.eye(2), springs, dashpots, turning=(TurningPart(turn, np.eye(2), quarter),))
    system = CoupledSystem((Component("body", ("rotor",) * 2, ground, zeros, zeros),), (0.0,), (held,))
    state = np.zeros((4, 4))
    state[:2, 2:] = np.eye(2)
    state[2:, :2] = turn**2 * np.eye(2) - ground - springs
    state[2:, 2:] = -dashpots - 2.0 * turn * quarter
    rotating, vectors = np.linalg.eig(state)
    expected = []
    for value, (x, y) in zip(rotating, vectors[:2].T, strict=True):
        if value.imag > 0.0:
            at = {value + 1j * turn: abs(x + 1j * y), value - 1j * turn: abs(x - 1j * y)}
            expected.append(abs(max(at, key=lambda one: abs(one) ** 2 * at[one]).imag))
    modes = coupled_modes(system)
    model = TurningResponse(system, mean_contact(system))
    chosen = modes.eigenvalues.imag > 0.0
    exponents = floquet_exponents(model, modes.eigenvalues[chosen], modes.shapes[chosen], modes.left[chosen])
    seen = observed_frequencies(model, exponents, modes.shapes[chosen], np.array([[1.0, 0.0]]))
    assert sorted(seen) == pytest.approx(sorted(expected), rel=1e-5)
    unsolved = observed_frequencies(model, np.array([np.nan + 0j]), modes.shapes[:1], np.array([[1.0, 0.0]]))
    assert np.isnan(unsolved).all()


@pytest.mark.slow
def test_exponents_are_those_of_the_multipliers_of_a_turn() -> None:
    machine = turning_machine((900.0, 1300.0), angles_deg=(0.0, 130.0, 240.0), speed=3000.0)
    system, period = machine.system, 2.0 * np.pi / machine.speeds["carrier"]
    modes = coupled_modes(system)
    chosen = np.flatnonzero((modes.eigenvalues.imag > 0.0) & (np.abs(modes.eigenvalues) < 9000.0))
    model = TurningResponse(system, mean_contact(system))
    frozen = modes.eigenvalues[chosen]
    exponents = floquet_exponents(model, frozen, modes.shapes[chosen], modes.left[chosen])
    solved = ~np.isnan(exponents)
    assert np.count_nonzero(solved) >= 12
    found = multipliers(system, period, 120)
    assert _farthest(exponents[solved], found, period) < 5e-3
    assert _farthest(frozen[solved], found, period) > 0.05


@pytest.mark.parametrize("turn", [0.05, 0.4])
def test_mass_on_springs_that_turn_has_the_exponents_of_its_rotating_frame(turn: float) -> None:
    ground, springs = 30.0 * np.eye(2), np.array([[4.0, 0.5], [0.5, 9.0]])
    dashpots = np.array([[0.2, 0.0], [0.0, 0.5]])
    quarter, zeros = np.array([[0.0, -1.0], [1.0, 0.0]]), np.zeros((2, 2))
    held = LinearConnector(
        "springs", np.eye(2), springs, dashpots, turning=(TurningPart(turn, np.eye(2), quarter @ np.eye(2)),)
    )
    system = CoupledSystem((Component("body", ("rotor",) * 2, ground, zeros, zeros),), (0.0,), (held,))
    # In the frame of the springs: z'' + (C + 2ΩJ) z' + (K + k - Ω²) z = 0.
    state = np.zeros((4, 4))
    state[:2, 2:] = np.eye(2)
    state[2:, :2] = turn**2 * np.eye(2) - ground - springs
    state[2:, 2:] = -dashpots - 2.0 * turn * quarter
    rotating = np.linalg.eigvals(state)
    modes = coupled_modes(system)
    model = TurningResponse(system, mean_contact(system))
    found = floquet_exponents(model, modes.eigenvalues, modes.shapes, modes.left)
    families = rotating[:, None] + 1j * turn * np.arange(-3, 4)
    for value, frozen in zip(found, modes.eigenvalues, strict=True):
        assert np.abs(families - value).min() < 1e-7
        assert np.abs(families - frozen).min() > 1e-4
    (warning,) = modes.warnings
    assert warning["turning"] == ["springs"]
    assert warning["turning_hz"] == pytest.approx(turn / (2.0 * np.pi))
