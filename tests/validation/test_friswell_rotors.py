"""Rotors of Friswell, Penny, Garvey & Lees, Dynamics of Rotating Machines (Cambridge, 2010).

Examples 5.9.1 and 5.9.2: a shaft of 1.5 m × 50 mm with two discs, on isotropic and on anisotropic bearings;
printed in rad/s for six beam elements, at rest and at 4000 rpm. Examples 5.9.3 to 5.9.5: the same on bearings of very
different stiffness, with cross-coupling, and with dashpots of 3 kN s/m; printed in Hz. Example 5.9.7: the first rotor
under axial loads. Example 5.9.9: an overhung disc. Example 9.7.1: a torsional chain. The values of 5.9.3 to 5.9.9 are
taken from the tests and pages of ROSS.

A finite-element model is too stiff, so an exact one lies at or below the printed value by the six elements'
own error, which grows with frequency: within 3e-5 (rounding, and a little) for the first two pairs, and
within 0.05 % for the third.
"""

from collections.abc import Callable

import numpy as np
import pytest

from gearwhine.rotors import (
    Bearing,
    Disc,
    Rotor,
    Segment,
    ShaftMaterial,
    rest_frequencies,
    solve_torsional_modes,
    solve_whirl,
)
from gearwhine.rotors.modes.torsional_and_axial import solve_torsional_chain

Published = Callable[..., None]

BOOK = "Friswell, Penny, Garvey & Lees (2010)"
ISOTROPIC, ANISOTROPIC, MIXED, CROSS_COUPLED, DAMPED, OVERHUNG, CHAIN = (
    f"{BOOK}, example {number}" for number in ("5.9.1", "5.9.2", "5.9.3", "5.9.4", "5.9.5", "5.9.9", "9.7.1")
)
SIX_ELEMENTS = (
    "Printed for six beam elements. The model here is exact, so it lies at or below by the elements' own error, which "
    "grows with frequency; the tests hold that side too."
)

AXIAL_LOAD = f"{BOOK}, example 5.9.7, as ROSS's example 22 prints it"

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)


def disc_of_350_mm(at: float) -> Disc:
    return Disc.from_dimensions(at, 0.07, 0.35, 0.05, 7810.0)


SHAFT = Rotor(
    "Friswell 5.9.1",
    [Segment(0.5, 0.05, 0.0, STEEL)] * 3,
    [Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, 7810.0), disc_of_350_mm(1.0)],
)
SPEED = 4000 * 2 * np.pi / 60


def bearings(k_yy: float) -> list[Bearing]:
    stiffness = np.diag([1e6, k_yy])
    return [Bearing(name, z, stiffness, np.zeros((2, 2))) for name, z in (("left", 0.0), ("right", 1.5))]


def assert_at_or_below(
    published: Published,
    source: str,
    quantities: list[str],
    printed: list[float],
    found: np.ndarray,
    rel: float = 5e-4,
) -> None:
    """Below by the six elements' error, never above by more than the last digit's half."""
    np.testing.assert_array_less(found, np.array(printed) + 0.0051)
    for quantity, value, ours in zip(quantities, printed, found, strict=True):
        tolerance = {"abs": 0.005 + 3e-5 * value} if value < 400.0 else {"rel": rel}
        published(source, quantity, value, ours, "rad/s", **tolerance)


def numbered(count: int, state: str) -> list[str]:
    return [f"lateral {number}, {state}" for number in range(1, count + 1)]


def test_isotropic_at_rest(published: Published, remark: Callable[[str, str], None]) -> None:
    remark(ISOTROPIC, SIX_ELEMENTS)
    found = rest_frequencies(SHAFT, bearings(1e6), count=6)
    pairs = ["lateral 1 and 2, at rest", "lateral 3 and 4, at rest", "lateral 5 and 6, at rest"]
    assert_at_or_below(published, ISOTROPIC, pairs, [86.66, 274.31, 716.78], found.frequencies[[0, 2, 4]])
    np.testing.assert_allclose(found.frequencies[::2], found.frequencies[1::2], rtol=1e-12)
    assert found.certificate.complete
    torsion = solve_torsional_modes(SHAFT, count=2).frequencies[1]
    published(ISOTROPIC, "torsional 1", 650.41, torsion, "rad/s", abs=0.0051)


def test_isotropic_at_speed(published: Published) -> None:
    modes = solve_whirl(SHAFT, bearings(1e6), SPEED, count=5)
    printed = [85.39, 87.80, 251.78, 294.71, 600.18]
    assert_at_or_below(published, ISOTROPIC, numbered(5, "4000 rpm"), printed, modes.frequencies)
    np.testing.assert_allclose(modes.direction, [-1, 1, -1, 1, -1], atol=1e-9)


def test_anisotropic_at_rest(published: Published, remark: Callable[[str, str], None]) -> None:
    remark(ANISOTROPIC, SIX_ELEMENTS)
    found = rest_frequencies(SHAFT, bearings(8e5), count=4).frequencies
    printed = [82.65, 86.66, 254.52, 274.31]
    for quantity, value, ours in zip(numbered(4, "at rest"), printed, found, strict=True):
        published(ANISOTROPIC, quantity, value, ours, "rad/s", abs=0.0051)


def test_anisotropic_at_speed(published: Published) -> None:
    modes = solve_whirl(SHAFT, bearings(8e5), SPEED, count=5)
    printed = [82.33, 86.86, 239.64, 287.25, 583.49]
    assert_at_or_below(published, ANISOTROPIC, numbered(5, "4000 rpm"), printed, modes.frequencies)


@pytest.mark.parametrize(
    ("source", "stiffness", "speed", "printed"),
    [
        (MIXED, [[1e6, 0.0], [0.0, 2e5]], SPEED, [8.545, 13.77, 22.35, 44.06, 78.76, 120.4]),
        (CROSS_COUPLED, [[1e6, 5e5], [5e5, 1e6]], 0.0, [11.66, 14.80, 33.97, 49.19, 97.97, 126.61]),
    ],
)
def test_mixed_modes_and_coupled_bearings(
    published: Published, source: str, stiffness: list[list[float]], speed: float, printed: list[float]
) -> None:
    held = [Bearing(name, z, np.array(stiffness), np.zeros((2, 2))) for name, z in (("left", 0.0), ("right", 1.5))]
    found = solve_whirl(SHAFT, held, speed, count=6).frequencies / (2 * np.pi)
    for quantity, value, ours in zip(numbered(6, f"{speed * 30 / np.pi:.0f} rpm"), printed, found, strict=True):
        published(source, quantity, value, ours, "Hz", **({"abs": 0.0051} if value < 60.0 else {"rel": 6e-4}))


@pytest.mark.parametrize(
    ("speed", "natural", "damped"),
    [
        (0.0, [13.91, 13.91, 48.18, 48.18, 137.06, 137.06], [13.89, 13.89, 46.54, 46.54, 103.22, 103.22]),
        (SPEED, [13.70, 14.09, 43.61, 52.18, 122.37], [13.68, 14.07, 41.98, 50.65, 104.25]),
    ],
)
def test_damped_bearings(published: Published, speed: float, natural: list[float], damped: list[float]) -> None:
    """|λ| and Im λ; with dashpots six elements may lie on either side."""
    held = [Bearing(name, z, 1e6 * np.eye(2), 3e3 * np.eye(2)) for name, z in (("left", 0.0), ("right", 1.5))]
    modes = solve_whirl(SHAFT, held, speed, count=6)
    for kind, printed, found in (
        ("natural", natural, modes.frequencies),
        ("damped", damped, modes.damped_frequencies),
    ):
        state = f"{kind}, {speed * 30 / np.pi:.0f} rpm"
        for quantity, value, ours in zip(numbered(len(printed), state), printed, found / (2 * np.pi), strict=False):
            published(DAMPED, quantity, value, ours, "Hz", **({"abs": 0.0051} if value < 60.0 else {"rel": 2e-3}))


@pytest.mark.parametrize(
    ("kilonewtons", "at_rest", "at_speed"),
    [
        (10, [13.935788, 43.913150, 114.759565], [13.739728, 14.111493, 40.330147, 47.154123, 96.087639, 132.403364]),
        (100, [15.020440, 46.132265, 120.620287], [14.867629, 15.156882, 42.570013, 49.325073, 100.969101, 139.063735]),
        (-10, [13.642635, 43.401542, 113.394556], [13.434622, 13.829336, 39.813547, 46.654356, 94.950323, 130.856441]),
    ],
)
def test_axial_load(kilonewtons: int, at_rest: list[float], at_speed: list[float], published: Published) -> None:
    """Six elements, whose errors grow with frequency; the load is along the whole shaft, tension positive."""
    segments = [Segment(0.5, 0.05, 0.0, STEEL, axial_force=1e3 * kilonewtons)] * 3
    rotor = Rotor("Friswell 5.9.7", segments, SHAFT.discs)
    for speed, printed, state in ((0.0, at_rest, "at rest"), (SPEED, at_speed, "4000 rpm")):
        found = solve_whirl(rotor, bearings(1e6), speed, count=6).frequencies / (2.0 * np.pi)
        for number, (value, ours) in enumerate(zip(printed, found[:: 6 // len(printed)], strict=True), start=1):
            assert ours < value
            quantity = f"frequency {number} under {kilonewtons} kN, {state}"
            published(AXIAL_LOAD, quantity, value, ours, "Hz", rel=3e-5 if value < 60.0 else 6e-4)


def test_overhung_disc(published: Published) -> None:
    rotor = Rotor("overhung", [Segment(1.0, 0.05, 0.0, STEEL), Segment(0.5, 0.05, 0.0, STEEL)], [disc_of_350_mm(1.5)])
    held = [Bearing.isotropic("end", 0.0, 1e7), Bearing.isotropic("inner", 1.0, 1e7)]
    rest = rest_frequencies(rotor, held, count=6).frequencies
    assert_at_or_below(published, OVERHUNG, numbered(6, "at rest")[::2], [90.14, 630.73, 830.43], rest[::2])
    whirl = solve_whirl(rotor, held, SPEED, count=6).frequencies
    printed = [76.19, 103.91, 565.99, 634.23, 647.75, 1174.2]
    assert_at_or_below(published, OVERHUNG, numbered(6, "4000 rpm"), printed, whirl, rel=6e-4)


def test_torsional_chain(published: Published) -> None:
    modes = solve_torsional_chain([3.5e-3, 3.5e-3, 3.5e-3, 0.15, 0.05], [12e3, 12e3, 14e3, 10e3])
    printed = [0.0, 81.21, 141.21, 378.95, 536.36]
    for number, (value, ours) in enumerate(zip(printed, modes.frequencies / (2 * np.pi), strict=True)):
        published(CHAIN, f"torsional {number}" if number else "rigid rotation", value, ours, "Hz", abs=0.0051)
    assert modes.certificate.complete
    np.testing.assert_allclose(modes.angle[0], modes.angle[0, 0], rtol=1e-12)
