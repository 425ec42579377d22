"""Wittrick–Williams root count: the number of natural frequencies below a frequency, and each of them by that count.

The count of Wittrick and Williams (Q. J. Mech. Appl. Math. 24, 1971) for a structure with dynamic
stiffness K(ω) is J = J₀ + s(K), with J₀ the clamped members' own modes below ω, here none by
construction (`gearwhine.rotors.transfer_matrix.discretised_shaft`), and s(K) the number of negative eigenvalues.
Eliminating the nodes of a shaft from the left turns s(K) into a sum over nodes: with S the dynamic stiffness of
everything left of a node (the node included) and K₁₁ that of the next element with its far end clamped,

    s(K) = Σ_nodes s(S + K₁₁) + s(S_last).

Dynamic stiffness and transfer matrix are two readings of one shaft element: with T in blocks,
K₁₁ = T₁₂⁻¹ T₁₁ and K₁₂ = −T₁₂⁻¹. Written with stiffness, the recursion S ← K₂₂ − K₂₁ (S + K₁₁)⁻¹ K₁₂
subtracts numbers of order EI/h³ and loses all digits on many short elements. Written with the transfer
matrix it does not: (U, F), n independent states that the left part admits with S = F U⁻¹, moves on as

    [U; F] ← T [U; F],        S + K₁₁ = T₁₂⁻¹ U_right U_left⁻¹ ,

where every term is of its natural size. For n = 2 the signs of the two eigenvalues follow from the
determinant and, if that is positive, the trace. Each det U enters two neighbouring nodes, as divisor and
as dividend; it is evaluated once, so that a rounded sign of a vanishing one cancels from the sum.

The states are renormalised at each node by combinations of positive determinant, which change nothing
above. Before a spring or an inertia is added to a displacement, the pair is rotated until one state alone
has this displacement; a spring then touches that state only, and of an infinite spring the limit is the
pure reaction (displacement 0, force 1). So supports of any stiffness keep all digits.

The determinant itself, det F of the orthonormal states right of the last node, does not depend on how the states
were combined on the way: it is a smooth function of ω between −1 and 1, zero at the natural frequencies alone, with
the count's parity as its sign. Where the count shows one root between two frequencies, steps on it converge fast.
"""

from collections.abc import Sequence

import numpy as np

from gearwhine.numerics.arrays import FloatArray, IndexArray
from gearwhine.rotors.errors import IncompleteModesError
from gearwhine.rotors.transfer_matrix.discretised_shaft import DiscretisedShaft

# Part of the limit above which all motions but the rigid ones must lie.
LOWEST = 1e-16


def shaft_arrays(shaft: DiscretisedShaft) -> tuple[FloatArray, FloatArray, IndexArray, FloatArray, FloatArray]:
    """Return the arrays of a discretised shaft in the order of compiled functions."""
    table = shaft.table
    return table.lengths, table.coefficients, shaft.element, shaft.node_stiffness, shaft.node_inertia


def wittrick_williams_count(shaft: DiscretisedShaft, frequency: float) -> int:
    """Return the Wittrick-Williams count: natural frequencies strictly below one, with multiplicity.

    Parameters
    ----------
    shaft : DiscretisedShaft
        The shaft; its `highest` must not be exceeded.
    frequency : float
        Frequency, positive [rad/s]. Rigid motions at zero count as below.
    """
    return wittrick_williams_counts([shaft], frequency)[0]


def wittrick_williams_counts(shafts: Sequence[DiscretisedShaft], frequency: float) -> list[int]:
    """Return the Wittrick-Williams count of several shafts."""
    from gearwhine.rotors.transfer_matrix.wittrick_williams_kernels import wittrick_williams_count_of

    return [int(wittrick_williams_count_of(frequency, *shaft_arrays(shaft))) for shaft in shafts]


def lowest_natural_frequencies(shaft: DiscretisedShaft, wanted: int, limit: float) -> FloatArray:
    """Solve for the lowest ``wanted`` natural frequencies of a shaft, each to a relative 1e-13 or so.

    Rigid motions are zeros; a root of multiplicity r stands r times.

    Parameters
    ----------
    shaft : DiscretisedShaft
        The shaft.
    wanted : int
        Number of frequencies; the count at the limit must not be less.
    limit : float
        Limit [rad/s].

    Raises
    ------
    IncompleteModesError
        The count does not reach ``wanted`` at the limit, or exceeds the rigid motions even at 1e-16 of it.
    """
    from gearwhine.rotors.transfer_matrix.wittrick_williams_kernels import lowest_roots

    zeros = shaft.rigid_shapes.shape[0]
    if wanted <= zeros:
        return np.zeros(wanted)
    lowest = LOWEST * limit
    first, last, roots = lowest_roots(wanted, zeros, lowest, limit, *shaft_arrays(shaft))
    if roots.size < wanted - zeros:
        raise IncompleteModesError(
            f"the root count is {first} at {lowest:g} rad/s and {last} at {limit:g} rad/s, but "
            f"{zeros} rigid motions and {wanted} modes were expected between; check support stiffnesses "
            "that are absurdly soft, or stiff beyond a constraint (use an infinite stiffness there)"
        )
    # Brackets of one multiple root may end in either order, a rounding apart.
    roots = np.maximum.accumulate(roots)
    return np.concatenate([np.zeros(zeros), roots]) if zeros else roots
