"""The housing as a component: its own damping and what dashpots on it add."""

import numpy as np
import pytest

from gearwhine.coupling import CouplingError, assemble_machine, coupled_modes
from gearwhine.coupling.machine.components import HousingComponent, housing_component
from gearwhine.housing import Certificate, ModeSet
from gearwhine.numerics.arrays import FloatArray

OMEGA = np.array([100.0, 180.0])
RATIOS = np.array([0.01, 0.02])


@pytest.fixture(scope="module")
def modes() -> ModeSet:
    """Two masses of 1 kg in their modal coordinates: only frequencies matter here."""
    return ModeSet(OMEGA, np.zeros((2, 1, 3)), Certificate(200.0, 2, 2, 0.0, 0.0), {}, "rslab", 0.0, 1)


def _component(modes: ModeSet, matrix: FloatArray | None) -> HousingComponent:
    return housing_component(modes, RATIOS, seats={}, seat_z={}, sensors={}, damping_matrix=matrix)


def test_a_dashpot_between_modes_couples_them(modes: ModeSet) -> None:
    """s² + diag(2ζω) s + g c gᵀ s + diag(ω²) = 0 as a polynomial of degree four in s, for one dashpot along g."""
    g, c = np.array([0.8, -0.6]), 30.0
    component = _component(modes, c * np.outer(g, g))
    first, second = (np.array([1.0, 2 * z * w + c * v * v, w * w]) for z, w, v in zip(RATIOS, OMEGA, g, strict=True))
    across = np.array([c * g[0] * g[1], 0.0])
    roots = np.roots(np.polysub(np.polymul(first, second), np.polymul(across, across)))
    system = assemble_machine([], component, speeds={}).system
    found = coupled_modes(system).eigenvalues
    expected = np.sort_complex(roots[roots.imag > 0.0])
    np.testing.assert_allclose(np.sort_complex(found), expected, rtol=1e-9)


def test_without_dashpots_each_mode_has_its_own_ratio(modes: ModeSet) -> None:
    assert np.array_equal(_component(modes, None).damping, np.diag(2 * RATIOS * OMEGA))


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (np.zeros((3, 3)), r"shape \(3, 3\) for 2 housing modes"),
        (np.array([[1.0, 0.5], [0.0, 1.0]]), "not symmetric"),
        (np.array([[1.0, np.nan], [np.nan, 1.0]]), "not finite"),
        (np.array([[1.0, 2.0], [2.0, 1.0]]), "feeds energy in"),
    ],
)
def test_damping_that_is_none_is_refused(modes: ModeSet, matrix: FloatArray, words: str) -> None:
    with pytest.raises(CouplingError, match=words):
        _component(modes, matrix)
