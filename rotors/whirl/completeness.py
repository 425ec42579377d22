"""Completeness of whirl modes: the inertia count of whirl frequencies, and the search for roots that are missing.

The count is that of the frequencies below a frequency, for rotors without damping or driving forces. Let stiffness be
Hermitian and positive semidefinite and damping absent. At λ = iω the dynamic stiffness of the turning rotor over both
planes is the Hermitian D(ω) = K − ω²M + ωG, with G Hermitian in circular coordinates and proportional to the speed Ω,
or to ω where the speed follows the frequency. At a root, with D v = 0,

    vᴴ D' v = −2ω vᴴMv + vᴴGv = −ω vᴴMv − vᴴKv / ω < 0,

because vᴴGv = ω vᴴMv − vᴴKv / ω there. (For Ω = ω, D = K − ω²(M − G') and vᴴD'v = −2 vᴴKv / ω.) Each eigenvalue
of D that passes zero as ω grows passes downwards, so the roots between two frequencies number exactly the
difference of s(D), the negative eigenvalues: Wittrick and Williams' count, carried over to any speed. Roots that move
no stiffness, the free rotor's at zero, lie below both.

Eliminating nodes from the left, with (U, F) the n states that the left part admits, S = F U⁻¹, and K₁₁ = T₁₂⁻¹T₁₁
of the next shaft element, s(D) = Σ s(S + K₁₁) + s(S_last), as in `gearwhine.rotors.transfer_matrix.wittrick_williams`.
Congruence with U spares the inverse:

    s(S + K₁₁) = s(Uᴴ T₁₂⁻¹ U_right).

Pedestals are eliminated first: the negative eigenvalues of each one's own matrix count, and the bearing becomes the
Schur complement.

Damped or driven rotors are counted by the argument principle (`gearwhine.rotors.whirl.argument_principle`). Where the
count exceeds the roots found, the missing ones are searched for again.
"""

from collections.abc import Sequence

import numpy as np

from gearwhine.numerics.arrays import ComplexArray, FloatArray, IndexArray
from gearwhine.rotors.certificate import ModeCertificate
from gearwhine.rotors.errors import IncompleteModesError
from gearwhine.rotors.model.bearing import Bearing
from gearwhine.rotors.whirl.argument_principle import NONE, RootOnContourError, Sector, count_by_argument_principle
from gearwhine.rotors.whirl.circular_coordinates import NodeBearing
from gearwhine.rotors.whirl.eigenvalues import ExactRoots, Speed, distinct, refine_roots, with_circle
from gearwhine.rotors.whirl.equations import WhirlEquations

# Part of a bearing's largest eigenvalue by which its smallest may lie below zero from rounding.
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
            # The matrix is scaled to a unit diagonal, as forces and moments differ in unit.
            size = np.sqrt(np.maximum(np.diag(stiffness), 0.0))
            unit = np.divide(stiffness, np.outer(size, size), out=stiffness * 0.0, where=np.outer(size, size) > 0.0)
            if bool((stiffness[np.outer(size, size) == 0.0] != 0.0).any()):
                return False
            if np.linalg.eigvalsh(unit)[0] < -ROUNDING:
                return False
    return True


def negative_count(equations: WhirlEquations, frequencies: FloatArray, speed: Speed) -> IndexArray:
    """Negative eigenvalues s(D(ω)) of the undamped dynamic stiffness at every ω [rad/s], (b,)."""
    eigenvalues = (1j * frequencies).astype(np.complex128)
    # One unit of force for all frequencies: with that of a frequency near zero every bearing would seem rigid.
    speeds, scale = speed(eigenvalues), np.full(frequencies.size, equations.force_scale(eigenvalues).max())
    n, batch = equations.size, frequencies.size
    nodes, added = _node_matrices(equations, eigenvalues, speeds, scale)
    transfer_matrices = equations.dense_transfers(eigenvalues, speeds, scale)
    displacements = np.broadcast_to(np.eye(n, dtype=np.complex128), (batch, n, n))
    forces = np.zeros((batch, n, n), dtype=np.complex128)
    for element in range(nodes.shape[1] - 1):
        forces = forces + nodes[:, element] @ displacements
        transfer = transfer_matrices[element]
        moved = transfer @ np.concatenate([displacements, forces], axis=1)
        reaction = np.linalg.solve(transfer[:, :n, n:], moved[:, :n])
        added += _negatives(_adjoint(displacements) @ reaction)
        states = np.linalg.qr(moved)[0]
        displacements, forces = states[:, :n], states[:, n:]
    forces = forces + nodes[:, -1] @ displacements
    return added + _negatives(_adjoint(displacements) @ forces)


def _node_matrices(
    equations: WhirlEquations, eigenvalues: ComplexArray, speeds: ComplexArray, scale: FloatArray
) -> tuple[ComplexArray, IndexArray]:
    """Dynamic stiffness at every node, (b, p + 1, n, n), and the pedestals' own negative eigenvalues, (b,)."""
    terms = equations.node_terms(eigenvalues, speeds) / scale[:, None, None]
    nodes = terms[..., None] * np.eye(equations.size)
    negatives = np.zeros(eigenvalues.size, dtype=np.intp)
    for node_bearing in equations.node_bearings:
        reduced, pedestal_negatives = _reduced(node_bearing, eigenvalues)
        nodes[:, node_bearing.node] += reduced / scale[:, None, None]
        negatives += pedestal_negatives
    return nodes, negatives


def _reduced(node_bearing: NodeBearing, eigenvalues: ComplexArray) -> tuple[ComplexArray, IndexArray]:
    bearing, ground = node_bearing.dynamic_stiffness(eigenvalues)
    turned = node_bearing.frame.conj().T
    if not node_bearing.foot:
        return turned @ bearing @ node_bearing.frame, np.zeros(eigenvalues.size, dtype=np.intp)
    foot = list(node_bearing.foot)
    whole = ground + bearing[:, foot][:, :, foot]
    reduced = bearing - bearing[:, :, foot] @ np.linalg.solve(whole, bearing[:, foot])
    return turned @ reduced @ node_bearing.frame, _negatives(whole)


def _negatives(matrices: ComplexArray) -> IndexArray:
    hermitian = 0.5 * (matrices + _adjoint(matrices))
    return np.asarray((np.linalg.eigvalsh(hermitian) < 0.0).sum(axis=-1))


def _adjoint(matrices: ComplexArray) -> ComplexArray:
    return np.asarray(np.swapaxes(matrices, -1, -2).conj())


# The sector of oscillating motions begins this far from the real axis, rad, and at this part of the lowest frequency.
NO_OSCILLATION = 1e-6
MOST_MISSING = 3
MOST_CUTS = 24
MOST_NUDGES = 6


def oscillating(least: float, most: float, angle: float = NO_OSCILLATION) -> Sector:
    """Return the sector of motions that oscillate, stable or not: λ by more than an angle [rad] off the real axis."""
    return Sector(least, most, angle, np.pi - angle)


def certified_roots(
    equations: WhirlEquations,
    roots: ExactRoots,
    speed: Speed,
    sector: Sector,
    conservative: bool,
    beyond: ComplexArray = NONE,
) -> tuple[ExactRoots, ModeCertificate]:
    """All roots in a sector, starting from the known ones, and the proof; approximate roots ``beyond`` reduce its work.

    Raises
    ------
    IncompleteModesError
        The count and the roots do not agree even after a search.
    """
    method = "inertia" if conservative else "winding"
    inside = roots.take(sector.holds(roots.eigenvalues))
    expected = count_roots(equations, speed, sector, conservative, np.concatenate([roots.eigenvalues, beyond]))
    if inside.eigenvalues.size < expected:
        inside = search(equations, roots, speed, sector)
    count = inside.eigenvalues.size
    certificate = ModeCertificate(sector.most, expected, count, max(inside.residuals.tolist(), default=0.0), method)
    if not certificate.complete:
        raise IncompleteModesError(
            f"{count} whirl modes are found below {sector.most:g} rad/s, but the exact equations have {expected} "
            f"by their {method} count; choose a limit a little apart, or check the model for parts that differ by many "
            "orders of magnitude in stiffness or damping"
        )
    return inside, certificate


def count_roots(
    equations: WhirlEquations, speed: Speed, sector: Sector, conservative: bool, known_roots: ComplexArray = NONE
) -> int:
    """Count the roots in a sector: by inertia for a conservative rotor, else by the argument principle."""
    if conservative:
        edges = np.array([sector.least, sector.most])
        low, high = negative_count(equations, edges, speed).tolist()
        return int(high - low)
    return count_by_argument_principle(equations, sector, speed, known_roots).count


def search(equations: WhirlEquations, known_roots: ExactRoots, speed: Speed, sector: Sector) -> ExactRoots:
    """All roots in a sector: the known ones, and the missing ones by the argument principle and power sums."""
    roots, waiting, cuts = known_roots, [sector], 0
    while waiting:
        part = waiting.pop()
        counted = count_by_argument_principle(equations, part, speed, roots.eigenvalues)
        inside = roots.eigenvalues[part.holds(roots.eigenvalues)]
        missing = counted.count - inside.size
        if missing <= 0:
            continue
        if missing <= MOST_MISSING:
            starts = counted.missing(missing)
            roots = distinct(roots.joined(refine_roots(equations, starts, speed)))
            for start in starts:
                if int(part.holds(roots.eigenvalues).sum()) == counted.count:
                    break
                roots = with_circle(equations, roots, complex(start), speed)
            if int(part.holds(roots.eigenvalues).sum()) == counted.count:
                continue
        if cuts >= MOST_CUTS:
            break
        cuts += 1
        waiting += _cut(equations, part, speed, roots.eigenvalues)
    return roots.take(sector.holds(roots.eigenvalues))


def _cut(equations: WhirlEquations, sector: Sector, speed: Speed, known_roots: ComplexArray) -> list[Sector]:
    """Two parts of a sector without a root on their common side."""
    for nudge in range(MOST_NUDGES):
        halves = sector.halves(0.5 + 0.037 * nudge)
        try:
            count_by_argument_principle(equations, halves[0], speed, known_roots)
        except RootOnContourError:
            continue
        return list(halves)
    raise RootOnContourError(
        f"whirl modes about |λ| = {sector.most:g} rad/s lie too close to each other to be told apart; "
        "choose a lower limit"
    )
