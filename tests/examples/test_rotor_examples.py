"""The worked examples of rotors and gear teeth against published values and closed forms."""

from typing import Any

import numpy as np
import pytest

from gearwhine.coupling import gears
from gearwhine.coupling.gears.loaded.transmission_error import mesh_period_phases


def test_campbell_diagram_has_the_published_frequencies(example: Any) -> None:
    """Friswell, Penny, Garvey and Lees (2010), example 5.9.1, at 4000 rpm: lateral frequencies of six elements."""
    found = example("campbell_diagram_of_a_rotor", "campbell.png")
    printed = [85.39, 87.80, 251.78, 294.71, 600.18]  # rad/s
    # Six elements are stiffer than the exact shaft, at most in the last one.
    assert np.sort(found["diagram"].frequencies[-1])[:5] == pytest.approx(printed, rel=2e-4)
    for crossing in found["crossings"]:
        assert crossing.eigenvalue.imag == pytest.approx(crossing.speed, rel=1e-9)


def test_unbalance_response_is_that_of_a_jeffcott_rotor(example: Any) -> None:
    """U Ω² / |k − m Ω²|: shaft and bearings in series, and the shaft's mass by its static shape (Rayleigh)."""
    found = example("unbalance_response", "unbalance.png")
    speed = found["speeds"][0]
    bending = 0.8**3 / (48.0 * 211e9 * np.pi / 64.0 * 0.05**4)
    poisson = 211.0 / (2.0 * 81.2) - 1.0
    cowper = 6.0 * (1.0 + poisson) / (7.0 + 6.0 * poisson)
    shear = 0.8 / (4.0 * cowper * 81.2e9 * np.pi / 4.0 * 0.05**2)
    bearing = 2e7 + 5e3j * speed
    stiffness = 1.0 / (bending + shear + 1.0 / (2.0 * bearing))
    rigid = 0.25e-7 / (bending + shear + 0.25e-7)  # part of the deflection that the bearings give
    bent = 1.0 - rigid  # of a shape whose mean is 5/8 and whose mean square is 17/35
    share = rigid**2 + 2.0 * rigid * bent * 5.0 / 8.0 + bent**2 * 17.0 / 35.0
    mass = 20.0 + share * 7810.0 * np.pi / 4.0 * 0.05**2 * 0.8
    expected = 2e-4 * speed**2 / abs(stiffness - mass * speed**2)
    # At half the critical speed, where higher modes and rotary inertia add little.
    assert found["orbit"][0] == pytest.approx(expected, rel=2e-3)
    assert found["resonance"] == pytest.approx(found["first"], rel=0.01)


def test_transmission_error_over_relief_follows_mesh_stiffness_and_load(example: Any) -> None:
    found = example("transmission_error_over_relief", "relief.png")
    gear = gears.Gear("gear", 40, 3e-3, np.radians(20.0), face_width=20e-3, bore=40e-3)
    contact = gears.tooth_contact(gears.GearPairGeometry(gear, gear), gears.PotentialEnergyStiffness())
    stiffness = gears.mesh_stiffness(contact, mesh_period_phases(contact))
    # Without relief the teeth deflect by F/k; deflections and reliefs in one proportion scale the error.
    for force, errors in found["errors"].items():
        assert errors[0] == pytest.approx(force * (1.0 / stiffness.min() - 1.0 / stiffness.max()), rel=1e-3)
    peak_to_peak = found["peak_to_peak"]
    assert peak_to_peak(8e-6, 2000.0) == pytest.approx(2.0 * peak_to_peak(4e-6, 1000.0), rel=1e-6)
    assert found["best"][2000.0] == pytest.approx(2.0 * found["best"][1000.0], abs=1e-6)
