"""How many natural frequencies lie below a frequency, and from that count each of them.

The count of Wittrick and Williams (Q. J. Mech. Appl. Math. 24, 1971) for a structure with dynamic
stiffness K(ω) is J = J₀ + s(K), with J₀ the clamped members' own modes below ω, here none by
construction (`rotors.chain`), and s(K) the number of negative eigenvalues. Eliminating the nodes of a
chain from the left turns s(K) into a sum over nodes: with S the dynamic stiffness of everything left of
a node (the node included) and K₁₁ that of the next piece with its far end clamped,

    s(K) = Σ_nodes s(S + K₁₁) + s(S_last).

Dynamic stiffness and transfer matrix are two readings of one piece: with T in blocks,
K₁₁ = T₁₂⁻¹ T₁₁ and K₁₂ = −T₁₂⁻¹. Written with stiffness, the recursion S ← K₂₂ − K₂₁ (S + K₁₁)⁻¹ K₁₂
subtracts numbers of order EI/h³ and loses all digits on many short pieces. Written with the transfer
matrix it does not: (U, F), n independent states that the left part admits with S = F U⁻¹, moves on as

    [U; F] ← T [U; F],        S + K₁₁ = T₁₂⁻¹ U_right U_left⁻¹ ,

where every term is of its natural size. For n = 2 the signs of the two eigenvalues follow from the
determinant and, if that is positive, the trace. Each det U enters two neighbouring nodes, as divisor and
as dividend; it is evaluated once, so that a rounded sign of a vanishing one cancels from the sum.

The states are renormalised at each node by combinations of positive determinant, which change nothing
above. Before a spring or an inertia is added to a displacement, the pair is rotated until one state alone
has this displacement; a spring then touches that state only, and of an infinite spring the limit is the
pure reaction (displacement 0, force 1). So supports of any stiffness keep all digits.
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from .chain import Chain
from .errors import IncompleteModesError

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
Count = Callable[[FloatArray], IntArray]

# Bytes of transfer matrices held at a time: frequencies beyond this go in turns.
BATCH_BYTES = 48_000_000
SECTIONS = 15
RELATIVE_WIDTH = 2e-13
MOST_ROUNDS = 40


def count_below(chain: Chain, frequencies: FloatArray) -> IntArray:
    """Number of natural frequencies strictly below each frequency, with multiplicity.

    Parameters
    ----------
    chain
        The shaft; its `highest` must not be exceeded.
    frequencies
        (b,): positive, rad/s. Rigid motions at zero count as below each.

    Returns
    -------
    (b,) integers.
    """
    one = 8 * (2 * chain.size) ** 2 * chain.lengths.size
    batch = max(1, BATCH_BYTES // one)
    parts: list[IntArray] = [_count(chain, frequencies[i : i + batch]) for i in range(0, frequencies.size, batch)]
    return np.concatenate(parts) if parts else np.zeros(0, dtype=np.intp)


def isolate(count: Count, wanted: int, zeros: int, limit: float) -> FloatArray:
    """The lowest ``wanted`` natural frequencies, from the count alone, to about 1e-13 of each.

    Every root keeps a bracket of its own, from ``count(low) <= k`` to ``count(high) > k``; all brackets are
    cut into sections together. A root of multiplicity r stands r times.

    Parameters
    ----------
    count
        Counts roots strictly below each of several frequencies.
    wanted
        How many; ``count(limit)`` must not be less.
    zeros
        How many of them are at zero exactly.
    limit
        rad/s.

    Raises
    ------
    IncompleteModesError
        The count does not reach ``wanted`` at the limit, or is above ``zeros`` even at 1e-16 of it.
    """
    probes = limit * 10.0 ** np.arange(-16.0, 1.0)
    counts = count(probes)
    if wanted > counts[-1] or (wanted > zeros and counts[0] > zeros):
        raise IncompleteModesError(
            f"the root count is {counts[0]} at {probes[0]:g} rad/s and {counts[-1]} at {limit:g} rad/s, but "
            f"{zeros} rigid motions and {wanted} modes were expected between; check support stiffnesses "
            "that are absurdly soft, or stiff beyond a constraint (use an infinite stiffness there)"
        )
    roots = np.arange(min(zeros, wanted), wanted)
    if roots.size == 0:
        return np.zeros(wanted)
    above = np.array([int(np.argmax(counts > root)) for root in roots])
    low, high = probes[above - 1], probes[above]
    fractions = np.arange(1, SECTIONS + 1) / (SECTIONS + 1)
    for _ in range(MOST_ROUNDS):
        if bool((high - low <= RELATIVE_WIDTH * high).all()):
            break
        inner = low[:, None] * (high / low)[:, None] ** fractions
        is_above = count(inner.ravel()).reshape(inner.shape) > roots[:, None]
        edges = np.concatenate([low[:, None], inner, high[:, None]], axis=1)
        first = np.where(is_above.any(axis=1), np.argmax(is_above, axis=1), SECTIONS)
        rows = np.arange(roots.size)
        low, high = edges[rows, first], edges[rows, first + 1]
    found = np.sqrt(low) * np.sqrt(high)
    # Brackets of one multiple root may end in either order, a rounding apart.
    return np.concatenate([np.zeros(min(zeros, wanted)), np.maximum.accumulate(found)])


def _count(chain: Chain, frequencies: FloatArray) -> IntArray:
    n = chain.size
    squared = frequencies**2
    node_terms = chain.node_stiffness[:, :, None] - chain.node_inertia[:, :, None] * squared
    transfers = chain.transfers(squared)
    states = np.zeros((n, 2 * n, squared.size))
    states[np.arange(n), np.arange(n)] = 1.0
    sign = np.ones(squared.size)
    total = np.zeros(squared.size, dtype=np.intp)
    constrained = chain.constrained
    for piece, transfer in enumerate(np.moveaxis(transfers, 1, -1)):
        states = _add_node(states, node_terms[piece])
        moved = np.einsum("ijb,sjb->sib", transfer, states)
        moved_sign = _sign(_determinant(moved[:, :n]))
        negative = moved_sign * sign < 0.0
        total += negative
        if n == 2 and not constrained[piece].any():
            near, far = transfer[:2, :2], transfer[:2, 2:]
            trace = _adjugate_trace(far, near) / _determinant(far)
            total += 2 * (~negative & (_total_sign(trace, states, sign) < 0.0))
        states, sign = _normalised(moved), moved_sign
    states = _add_node(states, node_terms[-1])
    negative = _sign(_determinant(states[:, n:])) * sign < 0.0
    total += negative
    if n == 2 and not constrained[-1].any():
        total += 2 * (~negative & (_total_sign(np.zeros_like(sign), states, sign) < 0.0))
    return total


def _add_node(states: FloatArray, terms: FloatArray) -> FloatArray:
    """Add a node's springs and inertias, ``terms`` (n, b), to the forces of the admitted states."""
    n = terms.shape[0]
    for row in range(n):
        term = terms[row]
        if not bool(np.any(term != 0.0)):
            continue
        if n == 2:
            first, second = states[0, row], states[1, row]
            size = np.hypot(first, second)
            safe = np.where(size > 0.0, size, 1.0)
            cosine, sine = np.where(size > 0.0, first / safe, 1.0), second / safe
            states = np.stack([cosine * states[0] + sine * states[1], cosine * states[1] - sine * states[0]])
            states[1, row] = 0.0
        if bool(np.isinf(term).any()):
            states[0] = 0.0
            states[0, n + row] = 1.0
        else:
            states[0, n + row] += term * states[0, row]
        states = _normalised(states)
    return states


def _normalised(states: FloatArray) -> FloatArray:
    """The same admitted states, as orthonormal vectors of the same orientation."""
    first = states[0] / np.sqrt((states[0] ** 2).sum(axis=0))
    if states.shape[0] == 1:
        return np.stack([first])
    second = states[1] / np.sqrt((states[1] ** 2).sum(axis=0))
    second = second - (first * second).sum(axis=0) * first
    return np.stack([first, second / np.sqrt((second**2).sum(axis=0))])


def _determinant(matrix: FloatArray) -> FloatArray:
    """Determinant over the first two axes, (n, n, b) to (b,)."""
    if matrix.shape[0] == 1:
        return np.asarray(matrix[0, 0])
    return np.asarray(matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0])


def _adjugate_trace(left: FloatArray, right: FloatArray) -> FloatArray:
    """Trace of adj(left) right for 2×2 matrices over the first two axes."""
    diagonal = left[1, 1] * right[0, 0] + left[0, 0] * right[1, 1]
    return np.asarray(diagonal - left[0, 1] * right[1, 0] - left[1, 0] * right[0, 1])


def _sign(values: FloatArray) -> FloatArray:
    return np.where(values < 0.0, -1.0, 1.0)


def _total_sign(trace: FloatArray, states: FloatArray, sign: FloatArray) -> FloatArray:
    """A number with the sign of tr(K₁₁ + F U⁻¹), free of the division by |det U|."""
    displacements, forces = states[:, :2], states[:, 2:]
    size = np.abs(_determinant(displacements))
    return np.asarray(trace * size + sign * _adjugate_trace(displacements, forces))
