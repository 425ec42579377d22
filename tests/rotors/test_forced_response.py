"""Unbalance, bow, harmonic forces, weight and torsional response: closed forms, reciprocity, an independent model."""

import dataclasses
import math

import numpy as np
import pytest
from finite_element_whirl import spatial_matrices
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gearwhine.rotors import (
    AxisSpring,
    Bearing,
    Coupling,
    Disc,
    Pedestal,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    Unbalance,
    solve_torsional_modes,
    static_deflection,
    torsional_response,
    unbalance_response,
)
from gearwhine.rotors.analyses.harmonic_response import at_positive_frequency, frequency_response, harmonic_response
from gearwhine.rotors.analyses.statics import StaticForce
from gearwhine.rotors.analyses.torsional_response import Torque, TorsionalDashpot
from gearwhine.rotors.analyses.unbalance import bow_shape
from gearwhine.rotors.model.loads import Bow, HarmonicForce

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
SPRING = ShaftMaterial(211e9, 81.2e9, 0.0)
GRAVITY = 9.80665
ZERO = np.zeros((2, 2))
SHAFT = Rotor(
    "s",
    [
        Segment(0.3, 0.05, 0.0, STEEL),
        Segment(0.4, 0.06, 0.02, STEEL, right_outer_diameter=0.04),
        Segment(0.2, 0.04, 0.0, STEEL),
    ],
    [Disc(0.3, 12.0, 0.09, 0.05), Disc(0.9, 5.0, 0.04, 0.022)],
)
CROSSED = [
    Bearing("a", 0.05, np.array([[2e7, 6e6], [-4e6, 1.5e7]]), np.array([[9e3, 1e3], [5e2, 7e3]])),
    Bearing(
        "b", 0.75, np.array([[3e7, 1e6], [2e6, 1e7]]), 2e3 * np.eye(2), pedestal=Pedestal(1e8 * np.eye(2), ZERO, 8.0)
    ),
]


def jeffcott(damping: float) -> tuple[Rotor, list[Bearing], float, float]:
    """A disc amid a massless shaft on rigid-like bearings, damped at the disc; its mass and stiffness."""
    shaft = Rotor("jeffcott", [Segment(0.5, 0.03, 0.0, SPRING)] * 2, [Disc(0.5, 20.0)])
    part = shaft.segments[0].section(0.0)
    compliance = 1.0 / (48 * part.bending_stiffness) + 1.0 / (4 * part.shear_stiffness) + 0.5e-9
    bearings = [Bearing.isotropic("l", 0.0, 1e9), Bearing.isotropic("r", 1.0, 1e9)]
    return shaft, [*bearings, Bearing("air", 0.5, ZERO, damping * np.eye(2))], 20.0, 1.0 / compliance


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_jeffcott_rotor_through_resonance(sense: float) -> None:
    # x + i y = m_e Ω² e^{i(Ωt + φ)} / (k − mΩ² + i c Ω), turning with the rotor.
    shaft, bearings, mass, stiffness = jeffcott(300.0)
    natural = math.sqrt(stiffness / mass)
    speeds = sense * natural * np.array([0.1, 0.5, 0.9, 1.0, 1.1, 2.0, 5.0])
    moment, phase = 2e-4, 0.7
    found = unbalance_response(shaft, bearings, [Unbalance(0.5, moment, phase)], speeds)
    expected = moment * speeds**2 * np.exp(1j * phase) / (stiffness - mass * speeds**2 + 300j * speeds)
    np.testing.assert_allclose(found.probe(0.5, 0.0), expected, rtol=1e-10)
    np.testing.assert_allclose(found.probe(0.5, math.pi / 2), -1j * expected, rtol=1e-10)
    orbit = found.orbit([0.5])
    np.testing.assert_allclose(orbit.major[:, 0], np.abs(expected), rtol=1e-10)
    np.testing.assert_allclose(orbit.minor[:, 0], sense * np.abs(expected), rtol=1e-10)
    # At resonance the phase lags by a quarter turn, wherever the mark is.
    assert np.angle(found.probe(0.5, 0.0)[3]) - phase == pytest.approx(-sense * math.pi / 2)
    # The mirrored rotor's probe along x reads the same over time: only the sense of its mark's angles is another.
    mirrored = moment * speeds**2 * np.exp(1j * sense * phase) / (stiffness - mass * speeds**2 + 300j * np.abs(speeds))
    np.testing.assert_allclose(at_positive_frequency(found.probe(0.5, 0.0), found.frequencies), mirrored, rtol=1e-10)
    # What the bearings feel: half of the shaft's force each.
    shaft_force = (stiffness * expected)[:, None] / 2.0
    np.testing.assert_allclose(found.bearing_forces[:, :2, 0], np.repeat(shaft_force, 2, axis=1), rtol=1e-8)


def test_response_is_that_of_converged_finite_elements() -> None:
    model = spatial_matrices(SHAFT, CROSSED, 4000.0)
    speeds = np.array([0.0, 250.0, 700.0, -1100.0])
    found = unbalance_response(SHAFT, CROSSED, [Unbalance(0.3, 1e-4, 0.4), Unbalance(0.9, 5e-5, 2.0)], speeds[1:])
    places = [0.0, 0.3, 0.75, 0.9]
    x, y = found.evaluate(places)
    for k, speed in enumerate(speeds[1:]):
        vector = {0.3: 1e-4 * np.exp(0.4j), 0.9: 5e-5 * np.exp(2j)}
        expected = _fe_response(
            model, speed, {at: (value * speed**2, -1j * value * speed**2) for at, value in vector.items()}, speed
        )
        for column, place in enumerate(places):
            np.testing.assert_allclose([x[k, column], y[k, column]], expected(place), rtol=1e-7)


def _fe_response(model, frequency, forces, speed):
    from finite_element_rotor import bending_model

    plane = bending_model(SHAFT, [], 4000.0, places=[b.at for b in CROSSED])
    n = plane.held.size
    side = np.zeros(model.mass.shape[0], dtype=complex)
    for at, (x, y) in forces.items():
        side[2 * plane.elements.node(at)] += x
        side[n + 2 * plane.elements.node(at)] += y
    dynamic = model.stiffness + 1j * frequency * (model.damping + speed * model.gyroscopic) - frequency**2 * model.mass
    answer = np.linalg.solve(dynamic, side)
    return lambda at: (answer[2 * plane.elements.node(at)], answer[n + 2 * plane.elements.node(at)])


def test_forces_balance_and_work_is_what_bearings_dissipate() -> None:
    force = HarmonicForce(0.6, x=3.0 + 1.0j, y=-2.0j, slope_x=0.4)
    omega = np.array([100.0, 800.0])
    found = harmonic_response(SHAFT, CROSSED, [force], omega, speed=500.0)
    x, y = found.evaluate([0.6])
    slope, _ = found.motion.evaluate_slopes([0.6])
    power = (
        0.5
        * omega
        * (
            force.x * np.conj(1j * x[:, 0])
            + force.y * np.conj(1j * y[:, 0])
            + force.slope_x * np.conj(1j * slope[:, 0])
        ).real
    )
    at_bearings = np.zeros(2)
    for k, bearing in enumerate(CROSSED):
        bx, by = found.evaluate([bearing.at])
        carried = found.bearing_forces[:, k, :2]
        moved = np.stack([bx[:, 0], by[:, 0]], axis=1)
        at_bearings += 0.5 * omega * (carried * np.conj(1j * moved)).real.sum(axis=1)
    np.testing.assert_allclose(power, at_bearings, rtol=1e-9)


@settings(max_examples=10, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.floats(0.0, 0.9), st.floats(0.0, 0.9), st.floats(10.0, 3000.0), st.floats(-1500.0, 1500.0))
def test_receptance_is_reciprocal_with_the_rotation_reversed(a: float, b: float, omega: float, speed: float) -> None:
    # Symmetric bearings: H_ab(Ω) = H_ba(−Ω), as the gyroscopic matrix changes sign by transposition.
    bearings = [
        dataclasses.replace(bearing, stiffness=0.5 * (bearing.stiffness + bearing.stiffness.T)) for bearing in CROSSED
    ]
    bearings = [
        dataclasses.replace(bearing, damping=0.5 * (bearing.damping + bearing.damping.T)) for bearing in bearings
    ]
    ends = [(a, "x"), (b, "y")]
    forward = frequency_response(SHAFT, bearings, ends, ends, [omega], speed)[0]
    reverse = frequency_response(SHAFT, bearings, ends, ends, [omega], -speed)[0]
    np.testing.assert_allclose(forward, reverse.T, rtol=1e-7, atol=1e-9 * np.abs(forward).max())


def test_bow_is_the_least_strained_curve_and_reads_as_measured_at_slow_roll() -> None:
    # Between two ends, one point off the middle of a uniform slender shaft bends it as a central force does.
    bar = Rotor("bar", [Segment(1.0, 0.01, 0.0, STEEL)])
    shape = bow_shape(bar, Bow([0.0, 0.5, 1.0], [0.0, 1e-3, 0.0]))
    section = bar.segments[0].section(0.0)
    compliance = 1.0 / (48 * section.bending_stiffness) + 1.0 / (4 * section.shear_stiffness)
    np.testing.assert_allclose(shape.reactions, np.array([-0.5, 1.0, -0.5]) * 1e-3 / compliance, rtol=1e-9)
    assert shape.strain_energy == pytest.approx(0.5 * 1e-6 / compliance, rel=1e-9)
    z = np.linspace(0.0, 0.5, 6)
    slender = 1e-3 * (3 * z - 4 * z**3)
    np.testing.assert_allclose(shape.evaluate(z).real, slender, atol=1e-3 * 1e-3)
    bearings = [Bearing.isotropic("l", 0.0, 1e7), Bearing.isotropic("r", 1.0, 1e7)]
    roll = unbalance_response(bar, bearings, [], [1e-3], bow=Bow([0.0, 0.5, 1.0], [0.0, 1e-3, 0.0], [0.0, 0.3, 0.0]))
    x, y = roll.reading([0.5])
    np.testing.assert_allclose([x[0, 0], y[0, 0]], 1e-3 * np.exp(0.3j) * np.array([1.0, -1j]), rtol=1e-9)


def test_bowed_jeffcott_rotor() -> None:
    # (k − mΩ² + i c Ω) r = k b: at resonance as large as k / cΩ, at high speed straight
    # (Nicholas, Gunter & Allaire 1976).
    shaft, bearings, mass, stiffness = jeffcott(300.0)
    natural = math.sqrt(stiffness / mass)
    speeds = natural * np.array([0.01, 0.5, 1.0, 3.0])
    found = unbalance_response(shaft, bearings, [], speeds, bow=Bow([0.0, 0.5, 1.0], [0.0, 2e-4, 0.0]))
    # The bow bends the shaft; the bearings' own compliance is beside it.
    expected = stiffness * 2e-4 / (stiffness - mass * speeds**2 + 300j * speeds)
    np.testing.assert_allclose(found.probe(0.5, 0.0), expected, rtol=1e-9)
    # An unbalance opposite to the bow, m e = −m b (ω₀/Ω)², cancels it at one speed.
    balance = Unbalance(0.5, stiffness * 2e-4 / speeds[1] ** 2, math.pi)
    still = unbalance_response(shaft, bearings, [balance], speeds[1:2], bow=Bow([0.0, 0.5, 1.0], [0.0, 2e-4, 0.0]))
    assert abs(still.probe(0.5, 0.0)[0]) < 1e-12


def test_rigid_runout_loads_nothing_and_is_read() -> None:
    for bow, expected in ((Bow([0.2], [1e-4]), 1e-4), (Bow([0.0, 0.9], [1e-4, 3e-4]), 2e-4)):
        found = unbalance_response(SHAFT, CROSSED, [], [50.0, 700.0], bow=bow)
        assert np.abs(found.bearing_forces).max() == 0.0
        np.testing.assert_allclose(found.evaluate([0.45])[0], 0.0, atol=1e-18)
        x, y = found.reading([0.45])
        np.testing.assert_allclose(x, expected, rtol=1e-9)
        np.testing.assert_allclose(y, -1j * expected, rtol=1e-9)


def test_uniform_bar_under_its_weight() -> None:
    # Pinned: 5 q L⁴/384 EI + q L²/8 κGA; clamped and overhung: q L⁴/8 EI + q L²/2 κGA.
    bar = Rotor("bar", [Segment(0.37, 0.05, 0.01, STEEL), Segment(0.63, 0.05, 0.01, STEEL)])
    section = bar.segments[0].section(0.0)
    q, ei, ga = section.mass_per_length * GRAVITY, section.bending_stiffness, section.shear_stiffness
    pins = [Bearing.isotropic("l", 0.0, 1e16), Bearing.isotropic("r", 1.0, 1e16)]
    sag = static_deflection(bar, pins)
    assert sag.evaluate([0.5])[1, 0] == pytest.approx(-(5 * q / (384 * ei) + q / (8 * ga)), rel=1e-9)
    assert sag.bending_moments([0.5])[1, 0] == pytest.approx(q / 8.0, rel=1e-9)
    assert sag.shear_forces([0.25])[1, 0] == pytest.approx(-q / 4.0, rel=1e-9)
    np.testing.assert_allclose(sag.bearing_loads[:, 1], -q / 2.0, rtol=1e-9)
    assert sag.slopes([0.0])[1, 0] == pytest.approx(-q / (24 * ei), rel=1e-6)
    clamp = Bearing("clamp", 0.0, np.diag([1e16, 1e16, 0.0, 1e16, 1e16]), np.zeros((5, 5)))
    hung = static_deflection(bar, [clamp], gravity=(GRAVITY, 0.0, 0.0))
    assert hung.evaluate([1.0])[0, 0] == pytest.approx(q / (8 * ei) + q / (2 * ga), rel=1e-9)
    # Moment about y of a force along x at a distance z: positive.
    np.testing.assert_allclose(hung.bearing_loads[0], [q, 0.0, 0.0, 0.0, q / 2.0], rtol=1e-9, atol=1e-9 * q)


def test_bearing_loads_are_those_of_statics_in_any_direction() -> None:
    pull = (3.0, -9.0, 4.0)
    row = np.diag([3e7, 2e7, 5e7, 1e4, 2e4])
    bearings = [Bearing("a", 0.05, row, np.zeros((5, 5))), Bearing("b", 0.75, np.diag([1e7, 4e7]), ZERO)]
    force = StaticForce(0.45, x=100.0, y=-50.0, z=20.0, about_x=7.0, about_y=-3.0)
    hung = static_deflection(SHAFT, bearings, [force], gravity=pull)
    weight = SHAFT.mass * np.array(pull)
    np.testing.assert_allclose(hung.bearing_loads[:, :3].sum(axis=0), weight + [100.0, -50.0, 20.0], rtol=1e-10)
    arms = np.array([0.05, 0.75])
    about_y = (arms * hung.bearing_loads[:, 0]).sum() + hung.bearing_loads[:, 4].sum()
    assert about_y == pytest.approx(SHAFT.centre_of_mass * weight[0] + 0.45 * 100.0 - 3.0, rel=1e-9)
    about_x = -(arms * hung.bearing_loads[:, 1]).sum() + hung.bearing_loads[:, 3].sum()
    assert about_x == pytest.approx(-SHAFT.centre_of_mass * weight[1] + 0.45 * 50.0 + 7.0, rel=1e-9)
    # The axial force stretches the shaft: at the held place, load over stiffness.
    assert hung.evaluate([0.05])[2, 0] == pytest.approx(hung.bearing_loads[0, 2] / 5e7, rel=1e-9)


def test_weight_of_cones_and_couplings_and_a_pedestal() -> None:
    joint = Coupling(0.05, 5e7, 1e4, 1e4, 1e7, mass=2.0, polar_inertia=1e-3, diametral_inertia=6e-4)
    shaft = Rotor("c", [SHAFT.segments[1], joint, SHAFT.segments[0]], [Disc(0.1, 3.0)])
    pedestal = Pedestal(np.diag([2e7, 2e7]), ZERO, 5.0)
    bearings = [
        Bearing.isotropic("a", 0.0, 1e7),
        Bearing("b", 0.5, 1e7 * np.eye(2), ZERO, pedestal=pedestal),
        Bearing.isotropic("c", 0.75, 1e7),
    ]
    hung = static_deflection(shaft, bearings)
    assert hung.bearing_loads[:, 1].sum() == pytest.approx(-shaft.mass * GRAVITY, rel=1e-10)
    # Cutting the cone changes nothing.
    cone = SHAFT.segments[1]
    middle = cone.section(0.5)
    halves = [
        dataclasses.replace(
            cone, length=0.2, right_outer_diameter=middle.outer_diameter, right_inner_diameter=middle.inner_diameter
        ),
        dataclasses.replace(
            cone, length=0.2, outer_diameter=middle.outer_diameter, inner_diameter=middle.inner_diameter
        ),
    ]
    cut = static_deflection(Rotor("c", [*halves, joint, SHAFT.segments[0]], [Disc(0.1, 3.0)]), bearings)
    z = np.linspace(0.0, 0.75, 11)
    np.testing.assert_allclose(cut.evaluate(z), hung.evaluate(z), rtol=1e-9, atol=1e-15)


def test_torsional_response_of_two_inertias_and_of_a_damped_rod() -> None:
    # Two discs on a massless shaft, k = GJ/L: θ₂/T = −k / [ω²(J₁J₂ω² − k(J₁ + J₂))]·(−1), undamped.
    pair = Rotor("pair", [Segment(0.8, 0.04, 0.0, SPRING)], [Disc(0.0, 1.0, 0.3), Disc(0.8, 1.0, 0.5)])
    k = pair.segments[0].section(0.0).torsional_stiffness / 0.8
    omega = np.array([50.0, 300.0, 900.0])
    for ratio in (0.0, 0.02):
        found = torsional_response(pair, [Torque(0.0, 10.0)], omega, damping_ratio=ratio)
        complex_k = k * (1 + 2j * ratio)
        matrix = np.array([[complex_k, -complex_k], [-complex_k, complex_k]]) - omega[:, None, None] ** 2 * np.diag(
            [0.3, 0.5]
        )
        expected = np.linalg.solve(matrix, np.array([[10.0], [0.0]]))[:, :, 0]
        np.testing.assert_allclose(found.angle([0.0, 0.8]), expected, rtol=1e-9)
        np.testing.assert_allclose(found.torque([0.4])[:, 0], complex_k * (expected[:, 1] - expected[:, 0]), rtol=1e-9)
    # A uniform rod, held at its left and driven at its right end: tan(aL)/(GJ a), a = ω √(ρ/G).
    rod = Rotor("rod", [Segment(2.0, 0.05, 0.0, STEEL)])
    held = torsional_response(rod, [Torque(2.0, 1.0)], [4000.0, 9000.0], springs=[AxisSpring(0.0, math.inf)])
    wave = np.array([4000.0, 9000.0]) * math.sqrt(7810.0 / 81.2e9)
    expected = np.tan(2.0 * wave) / (rod.segments[0].section(0.0).torsional_stiffness * wave)
    np.testing.assert_allclose(held.angle([2.0])[:, 0], expected, rtol=1e-9)
    # A matched dashpot ρ c J at the other end swallows the wave: amplitude T / (J √(Gρ) ω) everywhere.
    impedance = rod.segments[0].section(0.0).torsional_stiffness * math.sqrt(7810.0 / 81.2e9)
    absorbed = torsional_response(rod, [Torque(2.0, 1.0)], [4000.0], dashpots=[TorsionalDashpot(0.0, impedance)])
    np.testing.assert_allclose(np.abs(absorbed.angle([0.0, 0.7, 2.0])), 1.0 / (impedance * 4000.0), rtol=1e-9)


def test_a_spring_to_ground_has_no_damping_of_the_shaft() -> None:
    """A disc on a stiff rod and a spring: θ = T / (k + iωc - ω²J), c of the dashpot beside the spring alone."""
    stiff = ShaftMaterial(211e15, 81.2e15, 0.0)
    rod = Rotor("rod", [Segment(0.1, 0.2, 0.0, stiff)], [Disc(0.1, 1.0, 0.3)])
    spring, omega = AxisSpring(0.0, 2e4), np.array([50.0, 250.0, 400.0])
    for dashpots, c in (((), 0.0), ((TorsionalDashpot(0.0, 5.0),), 5.0)):
        found = torsional_response(
            rod, [Torque(0.1, 3.0)], omega, springs=[spring], dashpots=dashpots, damping_ratio=0.02
        )
        expected = 3.0 / (2e4 + 1j * omega * c - omega**2 * 0.3)
        np.testing.assert_allclose(found.angle([0.1])[:, 0], expected, rtol=1e-6)


def test_torsional_resonance_is_at_the_natural_frequency() -> None:
    natural = solve_torsional_modes(SHAFT, count=3).frequencies[1]
    ratio = 0.01
    omega = natural * np.linspace(0.95, 1.05, 201)
    size = np.abs(torsional_response(SHAFT, [Torque(0.0, 1.0)], omega, damping_ratio=ratio).angle([0.0])[:, 0])
    assert omega[size.argmax()] == pytest.approx(natural, rel=1e-3)
    half_power = omega[size > size.max() / math.sqrt(2.0)]
    assert (half_power[-1] - half_power[0]) / natural == pytest.approx(2 * ratio, rel=0.06)


@pytest.mark.parametrize(
    ("request_it", "message"),
    [
        (lambda: unbalance_response(SHAFT, CROSSED, [Unbalance(1.5, 1e-4)], [10.0]), "load position is 1.5"),
        (lambda: Unbalance(0.1, math.nan), "unbalance: moment is nan"),
        (lambda: Bow([0.1, 0.1], [1.0, 2.0]), "bow positions"),
        (lambda: Bow([0.1, 0.2], [1.0]), "bow shapes"),
        (lambda: static_deflection(SHAFT, CROSSED[:1]), "free to move"),
        (lambda: static_deflection(SHAFT, CROSSED, gravity=(0.0, 0.0, 9.8)), "free to move"),
        (lambda: frequency_response(SHAFT, CROSSED, [(0.1, "z")], [(0.1, "x")], [1.0]), "direction is 'z'"),
        (lambda: harmonic_response(SHAFT, CROSSED, [], [math.inf]), "frequencies is inf"),
        (lambda: torsional_response(SHAFT, [Torque(0.0, 1.0)], [0.0]), "frequencies"),
        (lambda: torsional_response(SHAFT, [Torque(0.0, 1.0)], [1.0], damping_ratio=-0.1), "damping_ratio is -0.1"),
    ],
)
def test_wrong_input_is_named(request_it, message: str) -> None:
    with pytest.raises(RotorError, match=message):
        request_it()
