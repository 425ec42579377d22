"""Mode shapes: null vectors of the transfer equations of the whole shaft at once.

A shape integrated from one end loses a mode that is localised at the other end. All node states are therefore
unknowns together (multiple shooting): the equations u_{i+1} = T₁₁ u_i + T₁₂ f_i, the same for forces with
the node's springs and inertias added, and free ends. A held displacement takes the place of its force balance. Node by
node, this matrix is a band; in the chain's units it is well conditioned for any number of pieces, and inverse
iteration on it with as many vectors as the root's multiplicity gives every shape, localised or not.
"""

from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy import linalg

from .chain import DiscretisedShaft
from .errors import IncompleteModesError, RotorError
from .fields import ShaftFields
from .root_count import shaft_arrays

FloatArray = npt.NDArray[np.float64]

# Roots closer than this share one null space, at their mean: the frequencies are good to 1e-12. Shapes err by as much,
# which a heavy disc amplifies.
ONE_NULL_SPACE = 2e-12
# Roots closer than this are multiples of one root: a set of modes holds all of them or none.
SAME_ROOT = 1e-10
# Smallest share of a rigid motion in an elastic mode, as a part of its norm, that is removed.
LEAST_SHARE = 1e-12
# Shapes of roots closer than this mix in rounding, and are separated again by their energies.
NEAR_ROOT = 1e-4


def groups(frequencies: FloatArray, tolerance: float) -> list[slice]:
    """Groups of ascending frequencies whose neighbours differ by less than ``tolerance`` of their value."""
    breaks = np.flatnonzero(np.diff(frequencies) > tolerance * frequencies[1:]) + 1
    edges = [0, *breaks.tolist(), frequencies.size]
    return [slice(left, right) for left, right in pairwise(edges) if right > left]


def responses(chain: DiscretisedShaft, loads: list[tuple[int, int]], frequency_squared: float) -> FloatArray:
    """Node states under unit forces at one ω² off the roots, each on a node and a component, (loads, p + 1, 2n)."""
    from .shape_kernels import shooting_responses

    n = chain.size
    sides = np.zeros((len(loads), 2 * n * chain.nodes.size))
    for load, (node, component) in enumerate(loads):
        # The force balance of a displacement at a node; an external force stands in it with a negative sign.
        sides[load, 2 * n * node + component] = -1.0
    return np.asarray(shooting_responses(frequency_squared, sides, *shaft_arrays(chain)))


def rigid_states(chain: DiscretisedShaft) -> FloatArray:
    """Node states of the rigid motions, orthonormal in mass, (zero modes, p + 1, 2n).

    Raises
    ------
    RotorError
        A rigid motion moves no inertia, so that it has no frequency.
    """
    shapes = chain.rigid_shapes
    states = np.concatenate([shapes, np.zeros_like(shapes)], axis=-1)
    if states.shape[0] == 0:
        return states
    mass, _ = ShaftFields(chain, np.zeros(states.shape[0]), states).energies()
    size = np.sqrt(np.diag(mass))
    if size.min() == 0.0 or linalg.eigvalsh(mass / np.outer(size, size))[0] < 1e-13:
        raise RotorError(
            "a rigid motion of the free shaft moves no inertia; expected a disc with diametral inertia, "
            "a shaft with density, or another support"
        )
    lower = linalg.cholesky(mass, lower=True)
    return np.asarray(np.einsum("ij,jkl->ikl", linalg.inv(lower), states))


def shared_roots(elastic: FloatArray) -> FloatArray:
    """Ascending natural frequencies (m,), those that share one null space at their mean."""
    if not has_neighbours(elastic):
        return elastic
    shared = elastic.copy()
    for group in groups(elastic, ONE_NULL_SPACE):
        shared[group] = elastic[group].mean()
    return shared


def has_neighbours(elastic: FloatArray) -> bool:
    """Whether any two neighbouring roots are closer than `NEAR_ROOT`."""
    return bool(np.count_nonzero(elastic[1:] - elastic[:-1] <= NEAR_ROOT * elastic[1:]))


def solve_mode_shapes(
    chain: DiscretisedShaft, frequencies: FloatArray
) -> tuple[ShaftFields, FloatArray, FloatArray, FloatArray]:
    """Fields of the modes at the given natural frequencies, the mixture that makes them orthonormal, and its energies.

    Parameters
    ----------
    chain
        The shaft.
    frequencies
        (m,): ascending, rad/s, the rigid motions' zeros first.

    Returns
    -------
    fields
        m fields.
    mixture
        (m, m): modes are ``mixture @ fields``; block diagonal over groups of near roots, but for the rigid motions'
        share that is taken out of the others where rounding has left one.
    mass, stiffness
        (m, m): integrated anew where modes are combinations of fields, so that what cancels keeps its digits.
    """
    from .shape_kernels import null_states

    zeros = min(chain.rigid_shapes.shape[0], frequencies.size)
    shared, elastic, near = frequencies, frequencies[zeros:], []
    if has_neighbours(elastic):
        shared, near = np.concatenate([frequencies[:zeros], shared_roots(elastic)]), groups(elastic, NEAR_ROOT)
    squared = shared**2
    states = null_states(squared[zeros:], *shaft_arrays(chain))
    if zeros:
        states = np.concatenate([rigid_states(chain)[:zeros], states])
    fields = ShaftFields(chain, squared, states)
    mass, stiffness = fields.energies()
    scale = 1.0 / np.sqrt(mass.diagonal())
    scale[:zeros] = 1.0
    mixture = np.diag(scale)
    # Beside a very heavy disc the share of a rigid motion in an elastic shape is rounding, but not negligible.
    rigid = scale[zeros:, None] * mass[zeros:, :zeros]
    leaning = zeros > 0 and np.abs(rigid).max(initial=0.0) > LEAST_SHARE
    if not near and not leaning:
        both = scale[:, None] * scale
        return fields, mixture, both * mass, both * stiffness
    for group in near:
        if group.stop - group.start > 1:
            part = slice(group.start + zeros, group.stop + zeros)
            mixture[part, part] = ritz_vectors(mass[part, part], stiffness[part, part])[1].T
    if leaning:
        mixture[zeros:, :zeros] = -mixture[zeros:, zeros:] @ mass[zeros:, :zeros]
    return fields, mixture, *fields.energies(mixture)


def ritz_vectors(mass: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Ascending ω² and mass-orthonormal columns of the small eigenproblem K q = ω² M q.

    Raises
    ------
    IncompleteModesError
        The mass matrix is singular: the shapes are not independent.
    """
    size = np.sqrt(np.diag(mass))
    scaled = mass / np.outer(size, size)
    if np.linalg.eigvalsh(scaled)[0] < 1e-12:
        raise IncompleteModesError("shapes of near roots are not independent; this is a defect, please report")
    values, vectors = linalg.eigh(stiffness / np.outer(size, size), scaled)
    return np.asarray(values), np.asarray(vectors / size[:, None])
