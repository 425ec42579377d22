"""Mode shapes as null vectors of the whole chain at once, and the proof that they are modes.

Marching a shape from one end finds no mode that lives at the other. All node states are therefore
unknowns together (multiple shooting): the equations u_{i+1} = T₁₁ u_i + T₁₂ f_i, the same for forces with
the node's springs and inertias added, and free ends. In the chain's units this matrix is well conditioned
for any number of pieces, and inverse iteration on it with as many vectors as the root's multiplicity gives
every shape, wherever it lives and whatever nodes it has.
"""

from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy import linalg, sparse
from scipy.sparse.linalg import SuperLU, splu

from .chain import Chain
from .errors import IncompleteModesError, RotorError
from .fields import Fields

FloatArray = npt.NDArray[np.float64]

# Roots closer than this share one null space; the frequencies themselves are good to 1e-12.
SAME_ROOT = 1e-10
# Shapes of roots closer than this mix in rounding, and are separated again by their energies.
NEAR_ROOT = 1e-4
INVERSE_ITERATIONS = 4


def groups(frequencies: FloatArray, tolerance: float) -> list[slice]:
    """Runs of ascending frequencies whose neighbours differ by less than ``tolerance`` of their value."""
    breaks = np.flatnonzero(np.diff(frequencies) > tolerance * frequencies[1:]) + 1
    edges = [0, *breaks.tolist(), frequencies.size]
    return [slice(left, right) for left, right in pairwise(edges) if right > left]


def shooting_matrix(chain: Chain, frequency_squared: float) -> sparse.csc_array:
    """Multiple-shooting matrix of a chain at ω², square of order 2n(p + 1), and regular off the roots.

    Its rows are the left end's condition (n), then for every piece the right node's 2n states, then
    the right end's. Row 2n i + j, for j at least n, is the force balance of displacement j − n at
    node i: its right-hand side is an external force there, with a negative sign.
    """
    n, nodes = chain.size, chain.nodes.size
    held = chain.constrained
    # Forces right of a node are those left of it plus terms times its displacements, so that a force row
    # reads f - terms u - (T y)_force = 0; a held displacement takes that row for itself.
    own = np.tile(np.eye(2 * n), (nodes, 1, 1))
    terms = chain.finite_stiffness - frequency_squared * chain.node_inertia
    carried = -chain.transfers(np.array([frequency_squared]))[:, 0]
    for component in range(n):
        is_held = held[:, component]
        own[:, n + component, component] = np.where(is_held, 1.0, -terms[:, component])
        own[is_held, n + component, n + component] = 0.0
        carried[is_held[1:], n + component] = 0.0

    rows, columns = np.meshgrid(np.arange(2 * n), np.arange(2 * n), indexing="ij")
    start = 2 * n * np.arange(nodes)[:, None, None]
    last = 2 * n * nodes - n + np.arange(n)
    values = np.concatenate([own.ravel(), carried.ravel(), np.ones(n)])
    row = np.concatenate([(start + rows - n).ravel(), (start[1:] + rows - n).ravel(), last])
    column = np.concatenate([(start + columns).ravel(), (start[:-1] + columns).ravel(), last])
    # The first node has no piece to its left, hence no equations for its displacements.
    kept = (row >= 0) & (values != 0.0)
    order = 2 * n * nodes
    return sparse.csc_array((values[kept], (row[kept], column[kept])), shape=(order, order))


def null_states(chain: Chain, frequency: float, multiplicity: int) -> FloatArray:
    """Node states of the ``multiplicity`` shapes at a natural frequency (rad/s), (multiplicity, p + 1, 2n)."""
    factor = _factor(chain, frequency)
    order = 2 * chain.size * chain.nodes.size
    vectors = np.random.default_rng(1989).standard_normal((order, multiplicity))
    for _ in range(INVERSE_ITERATIONS):
        left = np.linalg.qr(factor.solve(vectors, trans="T"))[0]  # type: ignore[call-overload]
        vectors = np.linalg.qr(factor.solve(left))[0]
    return np.ascontiguousarray(vectors.T.reshape(multiplicity, chain.nodes.size, 2 * chain.size))


def _factor(chain: Chain, frequency: float) -> SuperLU:
    # At a root met to the last digit a pivot can be exactly zero: a nudge in the last digits mends that.
    for nudge in (0.0, 1e-15, -1e-15, 4e-15):
        try:
            return splu(shooting_matrix(chain, (frequency * (1.0 + nudge)) ** 2))
        except RuntimeError:
            continue
    raise IncompleteModesError(
        f"the shapes at {frequency:g} rad/s cannot be separated from each other; "
        "check the model for parts that are not connected or carry no inertia"
    )


def rigid_states(chain: Chain) -> FloatArray:
    """Node states of the rigid motions, orthonormal in mass, (zero modes, p + 1, 2n).

    Raises
    ------
    RotorError
        A rigid motion moves no inertia, so that it has no frequency.
    """
    shapes = chain.rigid_shapes()
    states = np.concatenate([shapes, np.zeros_like(shapes)], axis=-1)
    if states.shape[0] == 0:
        return states
    mass, _ = Fields(chain, np.zeros(states.shape[0]), states).energies(np.eye(states.shape[0]))
    size = np.sqrt(np.diag(mass))
    if size.min() == 0.0 or linalg.eigvalsh(mass / np.outer(size, size))[0] < 1e-13:
        raise RotorError(
            "a rigid motion of the free shaft moves no inertia; expected a disc with diametral inertia, "
            "a shaft with density, or another support"
        )
    lower = linalg.cholesky(mass, lower=True)
    return np.asarray(np.einsum("ij,jkl->ikl", linalg.inv(lower), states))


def mode_fields(chain: Chain, frequencies: FloatArray, zeros: int) -> tuple[Fields, FloatArray]:
    """Fields of the modes at the given natural frequencies, and the mixture that makes them orthonormal.

    Parameters
    ----------
    chain
        The shaft.
    frequencies
        (m,): ascending, rad/s, of which the first ``zeros`` are rigid motions.

    Returns
    -------
    fields
        m fields.
    mixture
        (m, m): modes are ``mixture @ fields``; block diagonal over groups of near roots.
    """
    states = [rigid_states(chain)[:zeros]]
    shared = frequencies.copy()
    for group in groups(frequencies[zeros:], SAME_ROOT):
        members = frequencies[zeros:][group]
        shared[zeros:][group] = members.mean()
        states.append(null_states(chain, float(members.mean()), members.size))
    fields = Fields(chain, shared**2, np.concatenate(states))
    mass, stiffness = fields.energies(np.eye(frequencies.size))
    mixture = np.zeros_like(mass)
    mixture[:zeros, :zeros] = np.eye(zeros)
    for group in groups(frequencies[zeros:], NEAR_ROOT):
        near = slice(group.start + zeros, group.stop + zeros)
        mixture[near, near] = ritz_vectors(mass[near, near], stiffness[near, near])[1].T
    return fields, mixture


def ritz_vectors(mass: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Ascending ω² and mass-orthonormal columns of the small eigenproblem K q = ω² M q.

    Raises
    ------
    IncompleteModesError
        The mass matrix is singular: the shapes are not independent.
    """
    size = np.sqrt(np.diag(mass))
    scaled = mass / np.outer(size, size)
    if linalg.eigvalsh(scaled)[0] < 1e-12:
        raise IncompleteModesError("shapes of near roots are not independent; this is a defect, please report")
    values, vectors = linalg.eigh(stiffness / np.outer(size, size), scaled)
    return np.asarray(values), np.asarray(vectors / size[:, None])
