"""Natural frequencies of varied machines: each is that of the same mode, whatever its place among the others."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.coupling.linear.tracked_modes import ObservedModes
from gearwhine.numerics.distributions import Uniform

LENGTH, MASS = 0.5, 2.0


def _shafts(values: Mapping[str, float]) -> gw.Machine:
    """Two shafts on rigid bearings with a disc in the middle, apart from each other."""
    shafts, held = [], []
    for name, diameter in (("fixed", 0.02), ("varied", values["diameter"])):
        disc = gw.Disc(0.5 * LENGTH, MASS, 1e-6, 5e-7)
        shafts.append(gw.Shaft(gw.Rotor(name, [gw.Segment(LENGTH, diameter, 0.0, gw.STEEL)], [disc])))
        ends = [gw.Bearing.isotropic(f"{name} {at}", at, 1e12) for at in (0.0, LENGTH)]
        held += [gw.MountedBearing(one, name, None) for one in ends]
    return gw.Machine(shafts, held, speed=1.0)


def _bending(diameter: Any) -> Any:
    """f = sqrt(48 E I / L³ / (m + 17/35 m_shaft)) / 2π by Rayleigh's quotient with the static deflection [Hz]."""
    stiffness = 48.0 * gw.STEEL.youngs_modulus * np.pi * diameter**4 / 64.0 / LENGTH**3
    own = gw.STEEL.density * np.pi * diameter**2 / 4.0 * LENGTH
    return np.sqrt(stiffness / (MASS + 17.0 / 35.0 * own)) / (2.0 * np.pi)


def test_frequencies_keep_their_modes_where_these_cross() -> None:
    """Below 20 mm the varied shaft is the lower one, above it the upper one.

    The round shafts bend in both planes at one frequency: modes 1 and 2 are the fixed one, 3 and 4 the varied one.
    """
    varied = gw.vary(_shafts, {"diameter": Uniform(0.0192, 0.0212)}, 16, analyses=["modes"])
    study, names = varied.solved, [f"machine.natural_frequency_{number}_hz" for number in (1, 2, 3, 4)]
    found, diameter = np.array([study.all_values(name) for name in names]), study.values[:, 0]
    assert np.any(diameter < 0.0198)
    assert np.ptp(found[:2]) < 1e-6 * found[0, 0]
    # Shear lowers them by less than a per cent.
    assert found[:2] == pytest.approx(np.full((2, 16), _bending(0.02)), rel=0.01)
    assert found[2:] == pytest.approx(np.array([_bending(diameter)] * 2), rel=0.01)
    assert varied.document["warnings"] == []


def test_modes_of_one_frequency_are_found_together_and_others_by_their_shapes_alone() -> None:
    basis = np.eye(6)
    turned = np.array([[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]]) / 3.0
    nominal = ObservedModes(np.array([10.0, 10.0, 10.0, 12.0, 14.0]), basis[:5].astype(complex))
    other = ObservedModes(np.array([12.9, 13.0, 13.0, 13.0]), np.vstack([basis[3], turned @ basis[:3]]) * np.exp(0.3j))
    # Three of one frequency, of which none is like another by half, have moved above the fourth; the fifth is missing.
    assert nominal.found_in(other) == pytest.approx([13.0, 13.0, 13.0, 12.9, np.nan], nan_ok=True)
