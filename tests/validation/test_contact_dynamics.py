"""One mass on one tooth contact, against the theory of nonlinear and of parametric oscillation.

Free vibration with loss of contact, x'' + max(x, 0) = 1, amplitude a in contact over the static deflection: half a
period is spent on the spring for π/2 + asin(1/a) and in free flight for √(a² - 1), so that

    ω/ω_n = π / (π/2 + asin(1/a) + √(a² - 1)).

Mathieu's equation x'' + 2ζ x' + (1 + ε cos 2t) x = 0: the principal instability sets in at ε ≈ 4ζ; to four digits at
.040001, .120024 and .200109 for ζ = .01, .03 and .05.
"""

from collections.abc import Callable

import numpy as np
import pytest

from gearwhine.coupling import CoupledSystem, TransientOutputs, TransientSettings, simulate
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.time.transient import TransientResult
from gearwhine.numerics.arrays import FloatArray

Published = Callable[..., None]

BACKBONE = "Free vibration with loss of contact, closed form"
MATHIEU = "Mathieu's equation, edge of the principal instability"

ROW = np.ones((1, 1))
OUTPUTS = TransientOutputs(ROW, ROW, ROW)


def one_mass(contact: ToothContact, *, load: float, rate: float = 0.0, damping: float = 0.0) -> CoupledSystem:
    """A unit mass that only the contact holds."""
    mass = Component("mass", ("torsion",), np.zeros((1, 1)), np.full((1, 1), damping), np.zeros((1, 1)))
    tooth = ContactConnector("contact", np.ones(1), contact, 0.0, rate, np.empty((0, 3)))
    return CoupledSystem((mass,), (0.0,), contacts=(tooth,), load=np.array([load]))


def released(system: CoupledSystem, settings: TransientSettings, displacement: float) -> TransientResult:
    return simulate(system, settings, OUTPUTS, initial=(np.array([displacement]), np.zeros(1)))


def crossings(times: FloatArray, signal: FloatArray) -> FloatArray:
    """Times at which a finely sampled signal rises through zero."""
    before = np.flatnonzero((signal[:-1] < 0.0) & (signal[1:] >= 0.0))
    part = signal[before] / (signal[before] - signal[before + 1])
    return np.asarray(times[before] + part * (times[before + 1] - times[before]))


@pytest.mark.parametrize(("amplitude", "ratio"), [(1.25, 0.967212), (1.5, 0.918982), (2.0, 0.821021), (3.0, 0.662915)])
def test_backbone_with_contact_loss(amplitude: float, ratio: float, published: Published) -> None:
    system = one_mass(ToothContact(1.0, piecewise.constant(1.0, 1.0), piecewise.constant(0.0, 1.0)), load=1.0)
    period = 2.0 * np.pi / ratio
    settings = TransientSettings(20.0 * period, 0.0, 0.005, 0.05, tolerance=1e-5)
    result = released(system, settings, 1.0 + amplitude)
    rising = crossings(result.times, result.displacement[:, 0] - 1.0)
    assert rising.size >= 19
    found = 2.0 * np.pi / np.diff(rising).mean()
    published(BACKBONE, f"ω/ω_n at amplitude {amplitude:g}", ratio, found, rel=1e-4)
    # In flight for √(a² - 1) of every half period.
    flight = np.sqrt(amplitude**2 - 1.0)
    loss = 2.0 * flight / period
    published(BACKBONE, f"time out of contact at amplitude {amplitude:g}", loss, result.contact_loss[0], rel=2e-3)
    assert result.peak_force[0] == pytest.approx(1.0 + amplitude, rel=1e-4)
    # Over whole periods the contact carries the load, or the mass would drift.
    assert result.mean_force[0] == pytest.approx(1.0, rel=1e-3)


def test_no_contact_loss_below_the_static_deflection() -> None:
    system = one_mass(ToothContact(1.0, piecewise.constant(1.0, 1.0), piecewise.constant(0.0, 1.0)), load=1.0)
    result = released(system, TransientSettings(200.0, 0.0, 0.005, 0.05, tolerance=1e-5), 1.9)
    rising = crossings(result.times, result.displacement[:, 0] - 1.0)
    assert np.diff(rising).mean() == pytest.approx(2.0 * np.pi, rel=3e-5)
    assert result.contact_loss[0] == 0.0


def growth(damping_ratio: float, depth: float) -> float:
    """Mean rate of growth of a small disturbance, per radian, with a stiffness 1 + ε cos 2t.

    The preload keeps the contact closed, so that two motions differ by a solution of Mathieu's equation.
    """
    stiffness = piecewise.tabulated(lambda s: 1.0 + depth * np.cos(2.0 * np.pi * s), 1.0, tolerance=1e-7)
    contact = ToothContact(1.0, stiffness, piecewise.constant(0.0, 1.0))
    system = one_mass(contact, load=1.0, rate=1.0 / np.pi, damping=2.0 * damping_ratio)
    half = np.pi * np.ceil(6.0 / damping_ratio / np.pi)
    settings = TransientSettings(2.0 * half + 2.0 * np.pi, 0.0, np.pi / 50.0, np.pi / 100.0, tolerance=1.0)
    start = 1.0 / (1.0 + depth)
    still, stirred = (released(system, settings, start + extra) for extra in (0.0, 1e-2))
    assert still.contact_loss[0] == stirred.contact_loss[0] == 0.0
    difference = stirred.displacement[:, 0] - still.displacement[:, 0]
    per_period = 100
    first = round(half / settings.sample_interval)
    early, late = (np.abs(difference[i : i + per_period]).max() for i in (first, 2 * first))
    return float(np.log(late / early) / half)


@pytest.mark.parametrize(("damping_ratio", "threshold"), [(0.01, 0.040001), (0.03, 0.120024), (0.05, 0.200109)])
def test_parametric_instability(damping_ratio: float, threshold: float, published: Published) -> None:
    below, above = growth(damping_ratio, 0.97 * threshold), growth(damping_ratio, 1.03 * threshold)
    assert below < 0.0 < above
    # The rate is ε/4 - ζ near the threshold, so the root of the line through the two is the threshold itself.
    root = threshold * (0.97 + 0.06 * below / (below - above))
    published(MATHIEU, f"ε at ζ = {damping_ratio:g}", threshold, root, rel=5e-3)
    assert above - below == pytest.approx(0.06 * threshold / 4.0, rel=0.1)
