"""Rotors of Friswell, Penny, Garvey & Lees, Dynamics of Rotating Machines (Cambridge, 2010).

Examples 5.9.1 and 5.9.2: a shaft of 1.5 m × 50 mm with two discs, on isotropic and on anisotropic bearings;
printed in rad/s for six beam elements, at rest and at 4000 rpm. Example 9.7.1: a torsional chain.

A finite-element model is too stiff, so an exact one lies at or below the printed value by the six elements'
own error, which grows with frequency: within 3e-5 (rounding, and a little) for the first two pairs, and
within 0.05 % for the third.
"""

import numpy as np
import pytest

from rotors import (
    Bearing,
    Disc,
    Rotor,
    Segment,
    ShaftMaterial,
    rest_frequencies,
    solve_torsional_chain,
    solve_torsional_modes,
    solve_whirl,
)

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
SHAFT = Rotor(
    "Friswell 5.9.1",
    [Segment(0.5, 0.05, 0.0, STEEL)] * 3,
    [Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, 7810.0), Disc.from_dimensions(1.0, 0.07, 0.35, 0.05, 7810.0)],
)
SPEED = 4000 * 2 * np.pi / 60


def bearings(k_yy: float) -> list[Bearing]:
    stiffness = np.diag([1e6, k_yy])
    return [Bearing(name, z, stiffness, np.zeros((2, 2))) for name, z in (("left", 0.0), ("right", 1.5))]


def assert_at_or_below(found: np.ndarray, printed: list[float]) -> None:
    np.testing.assert_array_less(found, np.array(printed) + 0.0051)
    np.testing.assert_allclose(found, printed, rtol=5e-4)
    low = found < 400.0
    np.testing.assert_allclose(found[low], np.array(printed)[low], rtol=3e-5, atol=0.005)


def test_isotropic_at_rest() -> None:
    found = rest_frequencies(SHAFT, bearings(1e6), count=6)
    assert_at_or_below(found.frequencies[[0, 2, 4]], [86.66, 274.31, 716.78])
    np.testing.assert_allclose(found.frequencies[::2], found.frequencies[1::2], rtol=1e-12)
    assert found.certificate.complete
    torsion = solve_torsional_modes(SHAFT, count=2).frequencies[1]
    assert torsion == pytest.approx(650.41, abs=0.0051)


def test_isotropic_at_speed() -> None:
    modes = solve_whirl(SHAFT, bearings(1e6), SPEED, count=5)
    assert_at_or_below(modes.frequencies, [85.39, 87.80, 251.78, 294.71, 600.18])
    np.testing.assert_allclose(modes.direction, [-1, 1, -1, 1, -1], atol=1e-9)


def test_anisotropic_at_rest() -> None:
    found = rest_frequencies(SHAFT, bearings(8e5), count=4).frequencies
    np.testing.assert_allclose(found, [82.65, 86.66, 254.52, 274.31], atol=0.0051)


def test_anisotropic_at_speed() -> None:
    modes = solve_whirl(SHAFT, bearings(8e5), SPEED, count=5)
    assert_at_or_below(modes.frequencies, [82.33, 86.86, 239.64, 287.25, 583.49])


def test_torsional_chain() -> None:
    modes = solve_torsional_chain([3.5e-3, 3.5e-3, 3.5e-3, 0.15, 0.05], [12e3, 12e3, 14e3, 10e3])
    printed = [0.0, 81.21, 141.21, 378.95, 536.36]
    np.testing.assert_allclose(modes.frequencies / (2 * np.pi), printed, atol=0.0051)
    assert modes.certificate.complete
    np.testing.assert_allclose(modes.angle[0], modes.angle[0, 0], rtol=1e-12)
