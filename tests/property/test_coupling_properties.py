"""Laws of every coupled system: symmetry, stability of what is passive, and energies that add up."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.coupling import (
    CoupledSystem,
    TransientOutputs,
    TransientSettings,
    simulate,
    static_equilibrium,
)
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.time.transient import TransientResult

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
