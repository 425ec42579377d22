"""Laws of every coupled system: symmetry, stability of what is passive, and energies that add up."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.coupling import (
    CoupledSystem,
    TransientOutputs,
    TransientSettings,
    amplitude_spectrum,
    coupled_modes,
    simulate,
    static_equilibrium,
)
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.statics.mean_mesh import linear_matrices, mean_contact
from gearwhine.coupling.time.transient import EnergyBalance, TransientResult
from gearwhine.numerics.arrays import FloatArray

patient = settings(deadline=None, max_examples=15)


@st.composite
def components(draw: st.DrawFn, rng: np.random.Generator, name: str) -> Component:
    """Passive: stiffness positive definite, damping positive semidefinite, gyroscopic matrix skew."""
    n = draw(st.integers(1, 3))
    stiffness, damping, gyroscopic = rng.normal(size=(3, n, n))
    kind = draw(st.sampled_from(["rotor", "torsion", "housing"]))
    return Component(
        name,
        (kind,) * n,
        stiffness @ stiffness.T + 0.5 * np.eye(n),
        0.05 * (damping @ damping.T),
        0.5 * (gyroscopic - gyroscopic.T),
    )


@st.composite
def contacts(draw: st.DrawFn, size: int, rng: np.random.Generator, lossless: bool) -> ContactConnector:
    """A pair whose stiffness and relief vary along its path, with runout."""
    ratio = draw(st.sampled_from([1.3, 1.6, 1.9, 2.4]))
    ends, middle, relief = draw(st.floats(0.3, 1.5)), draw(st.floats(1.5, 4.0)), draw(st.floats(0.0, 0.3))
    gap = piecewise.polyline(ratio * np.array([0.0, 0.2, 0.8, 1.0]), np.array([relief, 0.0, 0.0, relief]))
    harmonics = np.array([[draw(st.floats(0.0, 0.1)), draw(st.floats(0.1, 2.0)), draw(st.floats(0.0, 6.0))]])
    return ContactConnector(
        "contact",
        rng.normal(size=size) / np.sqrt(size),
        ToothContact(
            ratio, piecewise.quadratic(ends, middle, ends, ratio), gap, 0.0 if lossless else draw(st.floats(0.0, 0.1))
        ),
        phase=draw(st.floats(0.0, 1.0)),
        mesh_frequency=draw(st.sampled_from([0.21, 0.1, -0.15])),
        errors=harmonics,
    )


@st.composite
def systems(draw: st.DrawFn, *, symmetric: bool = False, lossless: bool = False) -> CoupledSystem:
    """Two components, a bearing between them or to ground, a contact that the load presses, a harmonic load."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    parts = tuple(draw(components(rng, name)) for name in ("one", "two"))
    n = sum(part.size for part in parts)
    stiffness, damping = rng.normal(size=(2, 2, 2))
    stiffness, damping = stiffness @ stiffness.T, 0.05 * damping @ damping.T
    if not symmetric:
        stiffness = stiffness + draw(st.floats(-0.02, 0.02)) * np.array([[0.0, 1.0], [-1.0, 0.0]])
    if lossless:
        parts, damping = tuple(replace(part, damping=0.0 * part.damping) for part in parts), 0.0 * damping
    bearing = LinearConnector("bearing", rng.normal(size=(n, 2)), stiffness, damping)
    contact = draw(contacts(n, rng, lossless))
    turning = HarmonicLoad(draw(st.floats(0.1, 3.0)), (0.1 + 0.0j) * (rng.normal(size=n) + 1j * rng.normal(size=n)))
    speeds = (draw(st.floats(-2.0, 2.0)), draw(st.floats(-2.0, 2.0)))
    load = 4.0 * contact.direction
    return CoupledSystem(parts, speeds, (bearing,), (contact,), load, (turning,))


def run(system: CoupledSystem, tolerance: float, duration: float = 60.0) -> TransientResult:
    rows = np.eye(system.size)
    chosen = TransientSettings(duration, 0.0, 0.05, 0.2, tolerance=tolerance)
    return simulate(system, chosen, TransientOutputs(rows, rows, rows))


@patient
@given(systems(symmetric=True))
def test_symmetric_parts_make_a_symmetric_whole(system: CoupledSystem) -> None:
    for matrix in (system.stiffness, system.mean_stiffness):
        np.testing.assert_allclose(matrix, matrix.T, rtol=0.0, atol=1e-13 * np.abs(matrix).max())
        assert np.linalg.eigvalsh(matrix).min() > 0.0
    # What is skew in the damping is the gyroscopic part, and it does no work.
    skew = 0.5 * (system.damping - system.damping.T)
    expected = np.zeros_like(skew)
    start = 0
    for part, speed in zip(system.components, system.speeds, strict=True):
        block = slice(start, start + part.size)
        expected[block, block] = speed * part.gyroscopic
        start += part.size
    np.testing.assert_allclose(skew, expected, atol=1e-13)


@patient
@given(systems(symmetric=True))
def test_passive_systems_do_not_grow(system: CoupledSystem) -> None:
    modes = coupled_modes(system)
    assert modes.damping_ratios.min() > -1e-9
    np.testing.assert_allclose(np.linalg.norm(modes.shapes, axis=1), 1.0, rtol=1e-12)
    stiffness, damping = linear_matrices(system, mean_contact(system))
    assert np.all(np.diff(modes.frequencies_hz) >= -1e-12)
    for value, shape in zip(modes.eigenvalues, modes.shapes, strict=True):
        left = value**2 * shape + value * damping @ shape + stiffness @ shape
        assert np.abs(left).max() < 1e-8 * np.abs(stiffness).max()
    # Every root once: n pairs, a pair of real ones counting as two.
    real = np.count_nonzero(modes.eigenvalues.imag == 0.0)
    assert 2 * (modes.eigenvalues.size - real) + real == 2 * system.size


@patient
@given(systems(symmetric=True, lossless=True))
def test_lossless_systems_only_swing(system: CoupledSystem) -> None:
    np.testing.assert_allclose(coupled_modes(system).damping_ratios, 0.0, atol=1e-8)


@patient
@given(systems())
def test_static_equilibrium_balances(system: CoupledSystem) -> None:
    """The load against springs and teeth, the contact's law written out pair by pair."""
    q = static_equilibrium(system)
    (contact,) = system.contacts
    error = np.sum(contact.errors[:, 0] * np.cos(contact.errors[:, 2]))
    force = contact.contact.pair_forces(contact.phase + 1e-9, contact.direction @ q - error).sum()
    residual = system.load - system.stiffness @ q - force * contact.direction
    assert np.abs(residual).max() < 1e-6 * np.abs(system.load).max()


@patient
@given(systems())
def test_energies_add_up(system: CoupledSystem) -> None:
    """Unsymmetric bearings, relief, runout, parametric stiffness and loss of contact included."""
    coarse, fine = run(system, 1e-3), run(system, 5e-5)
    assert coarse.error <= 1e-3
    assert fine.error <= 5e-5
    assert fine.energy.error < 2e-4
    # Second order: the measure is the square of the step, and so is what the energies lack, rounding apart.
    assert fine.energy.error < 0.5 * coarse.energy.error + 1e-5
    assert fine.steps > coarse.steps


@patient
@given(systems(), st.floats(0.1, 10.0))
def test_scale(system: CoupledSystem, factor: float) -> None:
    """Loads, clearances and errors all greater by a factor: so are motion and forces, and energies by its square."""
    (contact,) = system.contacts
    gap = contact.contact.deviation
    law = replace(contact.contact, deviation=replace(gap, coefficients=factor * gap.coefficients))
    larger = replace(
        system,
        contacts=(replace(contact, contact=law, errors=contact.errors * np.array([factor, 1.0, 1.0])),),
        load=factor * system.load,
        harmonic_loads=tuple(replace(load, amplitude=factor * load.amplitude) for load in system.harmonic_loads),
    )
    one, other = run(system, 1e-4, 10.0), run(larger, 1e-4, 10.0)
    assert other.steps == one.steps
    size = np.abs(one.displacement).max()
    np.testing.assert_allclose(other.displacement, factor * one.displacement, atol=1e-7 * factor * size)
    np.testing.assert_allclose(other.peak_force, factor * one.peak_force, rtol=1e-6)

    def parts(balance: EnergyBalance) -> FloatArray:
        return np.array([balance.change, balance.loads, balance.lost, balance.teeth])

    scale = one.energy.scale
    np.testing.assert_allclose(parts(other.energy), factor**2 * parts(one.energy), atol=1e-6 * factor**2 * scale)


@patient
@given(st.integers(0, 2**32 - 1), st.integers(2, 300), st.floats(1e-5, 10.0))
def test_parseval(seed: int, count: int, interval: float) -> None:
    signal = np.random.default_rng(seed).normal(0.3, 1.0, count)
    spectrum = amplitude_spectrum(signal, interval)
    weights = np.full(spectrum.amplitude.size, 0.5)
    weights[0] = 1.0
    if count % 2 == 0:
        weights[-1] = 1.0
    np.testing.assert_allclose(weights @ spectrum.amplitude**2, np.mean(signal**2), rtol=1e-10)
