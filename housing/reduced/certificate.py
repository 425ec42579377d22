"""Certificate of a reduced housing: what its matrices prove, and whether a static stiffness agrees."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import linalg

from gearwhine.housing.reduced.matrices import MASSLESS, ReducedMatrices, StaticStiffness, scaled
from gearwhine.numerics.arrays import FloatArray

RIGID_STRAIN = 1e-5
"""Largest strain energy of a free rigid motion, over that of its node motions one by one."""

_SINGULAR = 1e-12  # eigenvalue of a stiffness with a diagonal of ones: a motion that nothing resists


@dataclass(frozen=True)
class ReducedCertificate:
    """What is proved of reduced matrices.

    Attributes
    ----------
    least_mass_eigenvalue, least_stiffness_eigenvalue : float
        Least eigenvalues of the matrices with a diagonal of ones.
    massless_count : int
        Number of coordinates without mass, which respond statically.
    rigid_strain : ndarray, shape (6,)
        Strain energy Rᵀ K R of the rigid motions along and about x, y, z through the nodes' centre, each over the sum
        of |K_ij R_i R_j|; zero of a motion that is free.
    rigid_mass : ndarray, shape (6, 6)
        Rᵀ M R of the rigid motions through the origin: mass [kg], static moment [kg m] and inertia [kg m²].
    held_frequency : float or None
        Highest natural frequency with all nodes held, that of the last fixed-interface mode which the reduction kept
        [rad/s]; None without internal coordinates that have mass.
    static_difference : float or None
        Largest difference of the interface's static stiffness from a given one, see :func:`static_difference`.
    """

    least_mass_eigenvalue: float
    least_stiffness_eigenvalue: float
    massless_count: int
    rigid_strain: FloatArray
    rigid_mass: FloatArray
    held_frequency: float | None = None
    static_difference: float | None = None

    @property
    def free_motions(self) -> int:
        """Number of rigid motions that the matrices do not resist."""
        return int((self.rigid_strain <= RIGID_STRAIN).sum())

    @property
    def is_free(self) -> bool:
        """Whether all six rigid motions are free, so that nothing inside the matrices holds the housing."""
        return self.free_motions == 6

    @property
    def mass(self) -> float:
        """Mass by its translations, the mean of the three [kg]; exact of a free housing."""
        return float(np.diag(self.rigid_mass)[:3].mean())


def rigid_motions(matrices: ReducedMatrices, positions: dict[int, tuple[float, float, float]]) -> FloatArray:
    """Rigid motions along and about x, y, z through the origin, shape (n, 6).

    Nodes of known place k move with them; all other coordinates o follow without a load, K_oo X_o = -K_ok R_k. Those of
    fixed-interface modes stay at rest, and a node of unknown place moves with a free housing, wherever it is.

    Parameters
    ----------
    matrices : ReducedMatrices
    positions : dict of int to tuple of float
        Place of each node that is known [m].
    """
    motions = np.zeros((matrices.size, 6))
    known = np.array([axis > 0 and node in positions for node, axis in matrices.coordinates])
    numbers = list(positions)
    of_nodes = rigid_motions_of(np.array([positions[node] for node in numbers]))
    for row in np.flatnonzero(known):
        node, axis = matrices.coordinates[row]
        motions[row] = of_nodes[6 * numbers.index(node) + axis - 1]
    motions[~known] = _following(matrices.stiffness, known) @ motions[known]
    return motions


def rigid_motions_of(places: FloatArray) -> FloatArray:
    """Rigid motions through the origin of nodes with six motions each, at places (m, 3) [m]; shape (6 m, 6).

    A rotation θ about the origin displaces a node at r by θ × r, and turns it by θ.
    """
    motions = np.tile(np.eye(6), (len(places), 1))
    x, y, z = np.asarray(places, dtype=np.float64).T
    motions[0::6, 4], motions[0::6, 5] = z, -y
    motions[1::6, 3], motions[1::6, 5] = -z, x
    motions[2::6, 3], motions[2::6, 4] = y, -x
    return motions


def condensed_stiffness(stiffness: FloatArray, rows: Sequence[int]) -> FloatArray:
    """Return the static stiffness of some coordinates, in their order, with the others following; shape (m, m)."""
    led = np.zeros(len(stiffness), dtype=bool)
    led[rows] = True
    static = stiffness[np.ix_(led, led)] + stiffness[np.ix_(led, ~led)] @ _following(stiffness, led)
    place = np.cumsum(led) - 1
    return np.asarray(static[np.ix_(place[rows], place[rows])])


def _following(stiffness: FloatArray, led: npt.NDArray[np.bool_]) -> FloatArray:
    """Return static motions of the other coordinates by those that are led, -K_oo⁻¹ K_ol, shape (n_other, n_led).

    Motions that nothing resists stay out of it.
    """
    inner = stiffness[np.ix_(~led, ~led)]
    if not inner.size:
        return np.zeros((0, int(led.sum())))
    diagonal = np.diag(inner)
    per_row = np.divide(1.0, np.sqrt(diagonal), out=np.zeros(len(inner)), where=diagonal > 0.0)
    loads, ones = per_row[:, None] * stiffness[np.ix_(~led, led)], scaled(inner)
    try:
        factor = linalg.cholesky(ones, lower=True)
    except linalg.LinAlgError:
        factor = np.zeros((1, 1))
    if np.diag(factor).min() ** 2 > _SINGULAR * len(ones):
        following = linalg.cho_solve((factor, True), loads)
    else:
        values, vectors = linalg.eigh(ones)
        resisted = values > _SINGULAR * values[-1]
        following = vectors[:, resisted] @ (vectors[:, resisted].T @ loads / values[resisted, None])
    return np.asarray(-per_row[:, None] * following)


def static_difference(matrices: ReducedMatrices, given: StaticStiffness) -> float:
    """Largest difference of the static stiffness at the interface from a given one.

    The static stiffness is K_kk + K_ko X with the others following, X = -K_oo⁻¹ K_ok (Guyan 1965, AIAA Journal 3(2)).
    The difference is that of each entry over the square root of its row's and its column's diagonal in the given one.

    Parameters
    ----------
    matrices : ReducedMatrices
    given : StaticStiffness
        Of coordinates that the matrices have.
    """
    rows = [matrices.coordinates.index(one) for one in given.coordinates]
    static = condensed_stiffness(matrices.stiffness, rows)
    size = np.sqrt(np.abs(np.diag(given.values)))
    size = np.outer(size, size)
    difference = np.abs(static - given.values)
    return float(np.max(np.divide(difference, size, out=difference.copy(), where=size > 0.0)))


def _held_frequency(matrices: ReducedMatrices) -> float | None:
    """Highest natural frequency of the internal coordinates with the nodes held [rad/s]; None where none has mass."""
    inner = np.array([axis == 0 for _, axis in matrices.coordinates])
    mass, stiffness = matrices.mass[np.ix_(inner, inner)], matrices.stiffness[np.ix_(inner, inner)]
    if not mass.size:
        return None
    last = len(mass) - 1
    try:
        (square,) = linalg.eigh(stiffness, mass, eigvals_only=True, subset_by_index=[last, last])
    except linalg.LinAlgError:  # some have no mass: those that have some follow
        values, vectors = np.linalg.eigh(mass)
        heavy = values > MASSLESS * values[-1]
        if values[-1] <= 0.0:
            return None
        basis = vectors[:, heavy] / np.sqrt(values[heavy])
        square = np.linalg.eigvalsh(basis.T @ stiffness @ basis)[-1]
    return float(np.sqrt(max(float(square), 0.0)))


def certify(
    matrices: ReducedMatrices,
    positions: dict[int, tuple[float, float, float]],
    static: StaticStiffness | None = None,
) -> ReducedCertificate:
    """Certify reduced matrices with nodes at these places [m], and a static stiffness of their interface."""
    motions = rigid_motions(matrices, positions)
    center = np.mean(list(positions.values()), axis=0)
    # A rotation about the centre c displaces by θ × r - θ × c.
    about_center = motions.copy()
    about_center[:, 3:] -= motions[:, :3] @ np.cross(np.eye(3), center).T
    strain = np.einsum("ia,ij,ja->a", about_center, matrices.stiffness, about_center)
    sizes = np.einsum("ia,ij,ja->a", np.abs(about_center), np.abs(matrices.stiffness), np.abs(about_center))
    mass_eigenvalues = np.linalg.eigvalsh(scaled(matrices.mass))
    return ReducedCertificate(
        float(mass_eigenvalues[0]),
        float(np.linalg.eigvalsh(scaled(matrices.stiffness))[0]),
        int((mass_eigenvalues < MASSLESS).sum()),
        np.abs(strain) / np.maximum(sizes, 1e-300),
        np.asarray(motions.T @ matrices.mass @ motions),
        _held_frequency(matrices),
        None if static is None else static_difference(matrices, static),
    )
