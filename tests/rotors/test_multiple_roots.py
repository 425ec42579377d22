"""Double and nearly double roots, modes that live in one part of a shaft, and stations where nothing moves."""

import math

import numpy as np
import pytest

from gearwhine.rotors import (
    Disc,
    IncompleteModesError,
    RadialSupport,
    Rotor,
    Segment,
    ShaftMaterial,
    solve_lateral_modes,
)
from gearwhine.rotors.certificate import certify
from gearwhine.rotors.modes.torsional_and_axial import solve_torsional_chain

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
PIN = math.inf


def assert_orthonormal_by_energy(modes: object) -> None:
    assert modes.certificate.complete  # type: ignore[attr-defined]
    assert modes.certificate.orthonormality < 1e-9  # type: ignore[attr-defined]
    assert modes.certificate.max_residual < 1e-10  # type: ignore[attr-defined]


def test_two_overhangs_joined_by_a_pinned_middle_are_an_exact_double() -> None:
    # Sixty pins between them decouple the two ends far below rounding: every root is double.
    shaft = Rotor(
        "twin", [Segment(0.5, 0.05, 0.0, STEEL), Segment(3.0, 0.05, 0.0, STEEL), Segment(0.5, 0.05, 0.0, STEEL)]
    )
    pins = [RadialSupport(z, PIN) for z in np.linspace(0.5, 3.5, 60)]
    modes = solve_lateral_modes(shaft, pins, count=3)
    assert modes.count == 4, "a double root at the end is kept whole"
    np.testing.assert_allclose(modes.frequencies[::2], modes.frequencies[1::2], rtol=1e-12)
    assert_orthonormal_by_energy(modes)
    # Two independent shapes span both ends.
    ends = modes.displacement[:2][:, [0, -1]]
    assert np.linalg.matrix_rank(ends, tol=0.1 * np.abs(ends).max()) == 2


@pytest.mark.parametrize("difference", [0.0, 1e-13, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2])
@pytest.mark.parametrize("pins", [6, 12, 24])
def test_nearly_equal_ends(difference: float, pins: int) -> None:
    shaft = Rotor(
        "near twin",
        [Segment(0.5, 0.05, 0.0, STEEL), Segment(1.0, 0.05, 0.0, STEEL), Segment(0.5, 0.05, 0.0, STEEL)],
        [Disc(0.0, 3.0, 0.02, 0.01), Disc(2.0, 3.0 * (1.0 + difference), 0.02, 0.01)],
    )
    middle = [RadialSupport(z, PIN) for z in np.linspace(0.5, 1.5, pins)]
    modes = solve_lateral_modes(shaft, middle, count=4)
    assert_orthonormal_by_energy(modes)
    # Shapes of displacement and slope at the pins: nothing moves there.
    np.testing.assert_allclose(modes.evaluate(np.linspace(0.5, 1.5, pins))[0], 0.0, atol=1e-12)


def test_torsional_chain_with_an_inertialess_joint() -> None:
    # Springs in series around a zero inertia act as one.
    joint = solve_torsional_chain([2.0, 0.0, 3.0], [100.0, 300.0])
    np.testing.assert_allclose(joint.frequencies, [0.0, math.sqrt(75.0 * (1 / 2 + 1 / 3))], rtol=1e-12)


def test_certificate_refuses_what_is_not_a_mode_set() -> None:
    frequencies = np.array([1.0, 2.0])
    assert certify(3.0, 2, frequencies, np.eye(2), np.diag([1.0, 4.0])).complete
    for expected, mass, stiffness in [
        (3, np.eye(2), np.diag([1.0, 4.0])),  # one mode missing
        (2, np.ones((2, 2)), np.diag([1.0, 4.0])),  # the same shape twice
        (2, np.eye(2), np.diag([1.0, 4.1])),  # a shape with another frequency's energies
    ]:
        with pytest.raises(IncompleteModesError, match=f"of {expected} modes below 3"):
            certify(3.0, expected, frequencies, mass, stiffness)
