"""Periodic motions found directly, against the theory of nonlinear and of parametric oscillation.

Free vibration with loss of contact, x'' + max(x, 0) = 1, amplitude a in contact over the static deflection: half a
period is spent on the spring for π/2 + asin(1/a) and in free flight for √(a² - 1), so that

    ω/ω_n = π / (π/2 + asin(1/a) + √(a² - 1)).

A weak undamped force in phase with the motion lowers its frequency by as much as one against it raises it, to the
first order; the mean of the squares is the backbone's but for the second.

Mathieu's equation x'' + 2ζ x' + (1 + ε cos 2t) x = 0: the principal instability sets in where a Floquet multiplier
passes -1; to six decimals at ε = .040001, .120024 and .200109 for ζ = .01, .03 and .05.
"""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import brentq, newton

from gearwhine.coupling import CoupledSystem
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.periodic import PeriodicResponse, periodic_response

Published = Callable[..., None]

BACKBONE = "Free vibration with loss of contact, closed form, by periodic motions"
MATHIEU = "Mathieu's equation, edge of the principal instability, by Floquet multipliers"
FORCE = 3e-3


def one_mass(contact: ToothContact, rate: float, damping: float, harmonic: tuple[HarmonicLoad, ...]) -> CoupledSystem:
    """A unit mass that only the contact holds, pressed by a unit force."""
    mass = Component("mass", ("torsion",), np.zeros((1, 1)), np.full((1, 1), damping), np.zeros((1, 1)))
    teeth = ContactConnector("contact", np.ones(1), contact, 0.0, rate, np.empty((0, 3)))
    return CoupledSystem((mass,), (0.0,), contacts=(teeth,), load=np.ones(1), harmonic_loads=harmonic)


def forced(frequency: float, force: float, amplitude: float) -> PeriodicResponse:
    """Nearly free vibration, the force at the frequency of the motion."""
    contact = ToothContact(1.0, piecewise.constant(1.0, 1.0), piecewise.constant(0.0, 1.0))
    load = HarmonicLoad(frequency, np.array([force + 0.0j]))
    start = (np.array([1.0 + amplitude]), np.zeros(1))
    return periodic_response(one_mass(contact, 0.0, 0.0, (load,)), start=start, tolerance=1e-7)


@pytest.mark.parametrize(("amplitude", "ratio"), [(1.25, 0.967212), (1.5, 0.918982), (2.0, 0.821021), (3.0, 0.662915)])
def test_backbone_with_contact_loss(amplitude: float, ratio: float, published: Published) -> None:
    found = []
    for force in (FORCE, -FORCE):

        def too_far(frequency: float, force: float = force) -> float:
            return float(forced(frequency, force, amplitude).displacement[0]) - 1.0 - amplitude

        # As far off as a spring of this frequency would be.
        guess = ratio - force / (2.0 * amplitude * ratio)
        found.append(float(newton(too_far, guess, x1=guess - 0.1 * (guess - ratio), tol=1e-9)))
    assert found[1] - found[0] > 1e-4
    published(BACKBONE, f"ω/ω_n at amplitude {amplitude:g}", ratio, float(np.sqrt(np.mean(np.square(found)))), rel=1e-4)
    response = forced(found[0], FORCE, amplitude)
    flight = 2.0 * np.sqrt(amplitude**2 - 1.0) * ratio / (2.0 * np.pi)
    published(BACKBONE, f"time out of contact at amplitude {amplitude:g}", flight, response.contact_loss[0], rel=1e-2)


@pytest.mark.parametrize(("damping_ratio", "threshold"), [(0.01, 0.040001), (0.03, 0.120024), (0.05, 0.200109)])
def test_parametric_instability(damping_ratio: float, threshold: float, published: Published) -> None:
    def margin(depth: float) -> float:
        """det(M + I), which passes zero where a multiplier passes -1."""
        stiffness = piecewise.tabulated(lambda s: 1.0 + depth * np.cos(2.0 * np.pi * s), 1.0, tolerance=1e-8)
        contact = ToothContact(1.0, stiffness, piecewise.constant(0.0, 1.0))
        response = periodic_response(one_mass(contact, 1.0 / np.pi, 2.0 * damping_ratio, ()))
        assert response.contact_loss[0] == 0.0
        stable.append((depth, response.stable))
        return float(np.prod(1.0 + response.floquet.values).real)

    stable: list[tuple[float, bool]] = []
    found = float(brentq(margin, 0.97 * threshold, 1.03 * threshold, xtol=1e-9))
    published(MATHIEU, f"ε at ζ = {damping_ratio:g}", threshold, found, rel=2e-5)
    assert all(verdict == (depth < found) for depth, verdict in stable if abs(depth - found) > 1e-5)
