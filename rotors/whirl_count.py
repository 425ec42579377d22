"""Inertia count of whirl frequencies below a frequency, for rotors without damping or driving forces.

Let stiffness be Hermitian and positive semidefinite and damping absent. At λ = iω the dynamic stiffness of the
turning rotor over both planes is the Hermitian D(ω) = K − ω²M + ωG, with G Hermitian in circular coordinates and
proportional to the speed Ω, or to ω where the speed follows the frequency. At a root, with D v = 0,

    vᴴ D' v = −2ω vᴴMv + vᴴGv = −ω vᴴMv − vᴴKv / ω < 0,

because vᴴGv = ω vᴴMv − vᴴKv / ω there. (For Ω = ω, D = K − ω²(M − G') and vᴴD'v = −2 vᴴKv / ω.) Each eigenvalue
of D that passes zero as ω grows passes downwards, so the roots between two frequencies number exactly the
difference of s(D), the negative eigenvalues: Wittrick and Williams' count, carried over to any speed. Roots that move
no stiffness, the free rotor's at zero, lie below both.

Eliminating nodes from the left, with (U, F) the n states that the left part admits, S = F U⁻¹, and K₁₁ = T₁₂⁻¹T₁₁
of the next piece, s(D) = Σ s(S + K₁₁) + s(S_last), as in `rotors.root_count`. Congruence with U spares the inverse:

    s(S + K₁₁) = s(Uᴴ T₁₂⁻¹ U_right).

Pedestals are eliminated first: the negative eigenvalues of each one's own matrix count, and the bearing becomes the
Schur complement.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .bearing import Bearing
from .exact_roots import Speed
from .spatial_chain import WhirlEquations
from .spatial_ties import NodeBearing

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]

# A bearing's smallest eigenvalue may lie this far below zero beside its largest, from rounding.
ROUNDING = 1e-12


def is_conservative(bearings: Sequence[Bearing]) -> bool:
    """Whether bearings and pedestals are undamped with symmetric, positive semidefinite stiffness."""
    for bearing in bearings:
        stiffnesses, dampings = [bearing.spatial_stiffness], [bearing.spatial_damping]
        if bearing.pedestal is not None:
            stiffnesses.append(bearing.pedestal.stiffness)
            dampings.append(bearing.pedestal.damping)
        if any(bool(damping.any()) for damping in dampings):
            return False
        for stiffness in stiffnesses:
            if not np.array_equal(stiffness, stiffness.T):
                return False
            # Scaled to a unit diagonal, as forces and moments differ in unit.
            size = np.sqrt(np.maximum(np.diag(stiffness), 0.0))
            unit = np.divide(stiffness, np.outer(size, size), out=stiffness * 0.0, where=np.outer(size, size) > 0.0)
            if bool((stiffness[np.outer(size, size) == 0.0] != 0.0).any()):
                return False
            if np.linalg.eigvalsh(unit)[0] < -ROUNDING:
                return False
    return True


def negative_count(chain: WhirlEquations, frequencies: FloatArray, speed: Speed) -> IntArray:
    """Negative eigenvalues s(D(ω)) of the undamped dynamic stiffness at every ω (rad/s), (b,)."""
    eigenvalues = (1j * frequencies).astype(np.complex128)
    # One unit of force for all frequencies: with that of a frequency near zero every bearing would seem rigid.
    speeds, scale = speed(eigenvalues), np.full(frequencies.size, chain.force_scale(eigenvalues).max())
    n, batch = chain.size, frequencies.size
    nodes, added = _node_matrices(chain, eigenvalues, speeds, scale)
    transfer_matrices = chain.dense_transfers(eigenvalues, speeds, scale)
    displacements = np.broadcast_to(np.eye(n, dtype=np.complex128), (batch, n, n))
    forces = np.zeros((batch, n, n), dtype=np.complex128)
    for piece in range(nodes.shape[1] - 1):
        forces = forces + nodes[:, piece] @ displacements
        transfer = transfer_matrices[piece]
        moved = transfer @ np.concatenate([displacements, forces], axis=1)
        reaction = np.linalg.solve(transfer[:, :n, n:], moved[:, :n])
        added += _negatives(_adjoint(displacements) @ reaction)
        states = np.linalg.qr(moved)[0]
        displacements, forces = states[:, :n], states[:, n:]
    forces = forces + nodes[:, -1] @ displacements
    return added + _negatives(_adjoint(displacements) @ forces)


def _node_matrices(
    chain: WhirlEquations, eigenvalues: ComplexArray, speeds: ComplexArray, scale: FloatArray
) -> tuple[ComplexArray, IntArray]:
    """Dynamic stiffness at every node, (b, p + 1, n, n), and the pedestals' own negative eigenvalues, (b,)."""
    terms = chain.node_terms(eigenvalues, speeds) / scale[:, None, None]
    nodes = terms[..., None] * np.eye(chain.size)
    negatives = np.zeros(eigenvalues.size, dtype=np.intp)
    for tie in chain.ties:
        reduced, own = _reduced(tie, eigenvalues)
        nodes[:, tie.node] += reduced / scale[:, None, None]
        negatives += own
    return nodes, negatives


def _reduced(tie: NodeBearing, eigenvalues: ComplexArray) -> tuple[ComplexArray, IntArray]:
    bearing, ground = tie.dynamic_stiffness(eigenvalues)
    turned = tie.frame.conj().T
    if not tie.foot:
        return turned @ bearing @ tie.frame, np.zeros(eigenvalues.size, dtype=np.intp)
    foot = list(tie.foot)
    whole = ground + bearing[:, foot][:, :, foot]
    reduced = bearing - bearing[:, :, foot] @ np.linalg.solve(whole, bearing[:, foot])
    return turned @ reduced @ tie.frame, _negatives(whole)


def _negatives(matrices: ComplexArray) -> IntArray:
    hermitian = 0.5 * (matrices + _adjoint(matrices))
    return np.asarray((np.linalg.eigvalsh(hermitian) < 0.0).sum(axis=-1))


def _adjoint(matrices: ComplexArray) -> ComplexArray:
    return np.asarray(np.swapaxes(matrices, -1, -2).conj())
