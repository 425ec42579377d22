"""Residual attachment modes (MacNeal, Rubin): they complete the static compliance of the kept modes at the ports.

Kept modes Φ (φᵀ M φ = 1, eigenvalues λ) answer a static port load f = Pᵀ with Σ φ φᵀ f / λ. All the discarded ones
together answer with the *residual vectors*

    X = Σ_discarded φ φᵀ Pᵀ / λ,        K X = F,   F = (I - M Φ Φᵀ) Pᵀ,   Φᵀ M X = 0,                    (1)

which need no discarded mode to be known: on the M-orthogonal complement of Φ the stiffness is positive definite,
free body or not, since a free body's rigid modes are among Φ. There (1) is solved with the factor of A = K - σM that
the eigensolution has at hand, σ below all modes or between the kept and the discarded ones, so that A is positive
definite on the complement too. In the sweep

    X <- X + A⁻¹ (F - K X)                                                                               (2)

the error becomes (I - A⁻¹ K) E. Both matrices are diagonal in the modes, so that each discarded mode's part is
multiplied by -σ / (λ - σ): small for σ slightly below zero, where the plain sweep settles quickly, and for modes well
above a positive σ. Conjugate gradients preconditioned by A⁻¹ take the same sweeps, need fewer of them, and converge for
the modes just above a positive σ too: a handful of eigenvalues λ / (λ - σ) of A⁻¹ K apart from a cluster at one. The
directions of all loads serve each of them (block conjugate gradients, O'Leary 1980, Linear Algebra and its
Applications 29), so that with r loads r - 1 of these eigenvalues take no sweeps of their own.

The span of X is then made a set of modes of its own: orthonormal in M to Φ and in itself, with a diagonal stiffness
(Craig and Kurdila, *Fundamentals of Structural Dynamics*, 2006, chapter 17, on residual attachment modes; after
MacNeal 1971 and Rubin 1975). By Galerkin's argument its compliance at the ports errs by the square of the error
of X. Modes and residual modes together are a component with the unit mass, a diagonal stiffness and the exact static
compliance at its ports.

*Near the limit* the discarded modes no longer answer statically: their part in a receptance is Σ φ φᵀ / (λ - ω²), from
which the static response differs by ω² / λ of each mode's part, by all of it at a mode just above the limit. The factor
of A with σ at the limit gives the response there and its derivatives by ω²,

    X_1 = A⁻¹ F,    X_j = A⁻¹ M X_{j-1},        A = K - σM on the complement.                             (5)

With X and X_1 to X_j in the basis, Galerkin's receptance from a port to any point is exact at rest and at the limit
(a rational Krylov space: de Villemagne and Skelton 1987; Grimme 1997). They take no solutions of their own: since
A⁻¹ K = I + σ A⁻¹ M, the directions of the first j sweeps span X_1 to X_j. Where the search for the modes began with the
loads, its Krylov space has all of them (:mod:`gearwhine.housing.modes.eigensolver`), and a sweep checks X. The residual
modes of the lowest frequencies then come close to the modes just above the limit, as far as the ports drive them.

Computed modes have a residual, K φ = λ M φ + r, and ψᵀ K φ = ψᵀ r is a coupling that a diagonal stiffness leaves out:
an error of first order, 2 |ψᵀ r| / √(λ ω²) of a port's compliance at most, the greater the softer the mode beside the
limit. Rayleigh-Ritz in the space of both removes it. To first order it rotates each pair by

    s = ψᵀ r / (λ - ω²),        φ <- φ + s ψ,   ψ <- ψ - s φ,                                             (3)

which moves φ towards the exact mode, and leaves couplings of second order. The rotation is no more than the error of a
certified mode; modes with larger errors are left as they are, and the proof refuses them.

*Proof.* Let U be the displacements by modes and residual modes for the loads F of all ports, and R = F - K U the
unbalanced loads. For any U the exact compliance is

    C = Uᵀ F + Fᵀ U - Uᵀ K U + Rᵀ K⁻¹ R,                                                                 (4)

all of it computable but the last term, of second order, which is bounded by one more solve: the kept modes' part of R
divided by λ, and for the rest rᵀ K⁻¹ r <= (1 + |min(σ, 0)| / λ_kept) rᵀ A⁻¹ r, since A differs from K by σM. The error
reported is the difference of this C from the compliance by U, plus the bound.

The compliance is the elastic one: modes with λ <= floor are left out of it, rigid and nearly rigid ones. For
a free body this is its inertia-relief compliance Sᵀ G S with S = I - M Φ_rigid Φ_rigidᵀ: the load is balanced by the
inertia of the accelerated body. A body on mounts that are soft beside the limit is held to the same, stricter measure.

*Smaller sets* span the responses of lower order to loads at the ports. A set of residual modes that holds the static
response of the discarded modes and their responses at the limit (Eq. 5) holds them too. In its own coordinates, with
frequencies ω and motions p of the ports, the response to a load is p / ω² at rest, p / (ω² - σ) at ω² = σ, and
p / (ω² - σ)^j its derivatives there. These span the set of fewer orders; the difference between the two sets shows what
the further orders contribute.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg, sparse

from gearwhine.housing.errors import HousingError, ReductionError
from gearwhine.housing.fem.linear_algebra import BlockAlgebra, Operator
from gearwhine.housing.modes.certificate import RESIDUAL_BOUND
from gearwhine.numerics.arrays import FloatArray, IntArray

Solve = Callable[[FloatArray], FloatArray]

STATIC_BOUND = 1e-10
OVERLAP_BOUND = 1e-8
_HARMONIC_SETTLED = 1e-7  # part of a whole harmonic response by which a last sweep may still move its missing part
# Part of a port's whole response, in the norm of strain energy, that a last sweep may still move; a tenth is left.
_SETTLED_RESPONSE_SHARE = 1e-7
_NOTHING_NEW = 1e-12  # part of the ports' compliance below which a direction is rounding or known already
_ADDS_NOTHING = 1e-12  # part of a dynamic response's strain energy below which its contribution is rounding
_ROUNDING_ENERGY_SHARE = 1e-12  # part of the largest energy of a sweep's directions below which one is rounding
_MOST_SWEEPS = 200


@dataclass(frozen=True)
class StaticProof:
    """The static compliance at the ports, and the bound of its error; r port motions.

    Attributes
    ----------
    compliance : ndarray, shape (r, r)
        Elastic compliance: motion of one port by a unit load on another [m/N, rad/N, rad/(N m)].
    missing : ndarray, shape (r, r)
        Residual part of the compliance, which the kept modes alone do not hold.
    error : float
        Bound on |C_ab - C'_ab| / sqrt(C_aa C_bb) over all pairs of motions, with C' by modes and residual modes and C
        the exact compliance of Eq. (4).
    overlap : float
        Largest |φᵀ M ψ| of two different vectors among modes and residual modes, and |ψᵀ M ψ - 1|.
    sweeps : int
        Solves with the factor of A for all ports at once, before the last one for the bound.
    """

    compliance: FloatArray
    missing: FloatArray
    error: float
    overlap: float
    sweeps: int

    @property
    def missing_parts(self) -> FloatArray:
        """Residual part of each port's own compliance, shape (r,): the error of the kept modes alone."""
        diagonal = self.compliance.diagonal()
        return np.asarray(self.missing.diagonal() / np.where(diagonal > 0.0, diagonal, 1.0))


@dataclass(frozen=True)
class ResidualModes:
    """Residual attachment modes: k of them, at most one for each port motion and order of response.

    Attributes
    ----------
    frequencies : ndarray, shape (k,)
        ω with ψᵀ K ψ = ω² [rad/s], ascending: the Rayleigh quotients of the residual modes, above all kept
        frequencies; no natural frequencies of the housing.
    shapes : ndarray, shape (k, n_nodes, 3)
        ψᵀ M ψ = 1 [1/√kg], and no mass in common with the modes or each other.
    proof : StaticProof
    """

    frequencies: FloatArray
    shapes: FloatArray
    proof: StaticProof

    def project(self, port: sparse.csr_array) -> FloatArray:
        """Project a port on the residual modes: their motions at it, shape (k, n_motions)."""
        return port_motions(port, self.shapes)


def port_motions(port: sparse.csr_array, shapes: FloatArray) -> FloatArray:
    """Motions at a port, shape (r, 3 n_nodes), by shapes (k, n_nodes, 3): shape (k, r).

    Only the entries of the shapes that the port has are read: a product with whole shapes begins with a copy of them.
    """
    places, columns = np.unique(port.indices, return_inverse=True)
    port_shapes = shapes.reshape(len(shapes), port.shape[1])[:, places]
    narrow = sparse.csr_array((port.data, columns, port.indptr), shape=(port.shape[0], len(places)))
    return np.asarray((narrow @ port_shapes.T).T)


def residual_attachment_modes(
    stiffness: Operator,
    mass: Operator,
    solve: Solve,
    values: FloatArray,
    vectors: FloatArray,
    ports: sparse.csr_array,
    *,
    shift: float,
    floor: float,
    free: IntArray,
    n_nodes: int,
    orders: int = 1,
    begin: Sequence[FloatArray] = (),
    solve_approximately: Solve | None = None,
    threads: int = 2,
    progress: Callable[[str], None] = lambda message: None,
) -> tuple[ResidualModes, FloatArray]:
    """Compute residual attachment modes, and prove that they make the static compliance at the ports exact.

    Parameters
    ----------
    stiffness, mass : matrix or operator, shape (n, n)
        K [N/m] and M [kg] on the free degrees of freedom.
    solve : callable
        X = A⁻¹ B with A = K - shift M, for B of shape (n, m).
    values : ndarray, shape (p,)
        λ = ω² of the kept modes [rad²/s²], every one below some limit.
    vectors : ndarray, shape (n, p)
        Φ, with Φᵀ M Φ = I.
    ports : scipy.sparse.csr_array, shape (r, n)
        P: motions at the ports from the free degrees of freedom; loads act by its transpose.
    shift : float
        σ [rad²/s²]: below zero, or above every kept eigenvalue and below every discarded one.
    floor : float
        λ up to which a mode counts as rigid [rad²/s²].
    free : ndarray of int, shape (n,)
        Places of these degrees of freedom among the mesh's 3 n_nodes.
    n_nodes : int
        Nodes of the mesh.
    orders : int
        Responses for each port motion: 1, the static one; 2, that at ω² = shift beside it; more, its derivatives by ω²
        there too, see Eq. (5).
    begin : sequence of ndarray, shape (n, r)
        X, from which the sweeps start, then X_1 and so on, where they are known; whatever they have of Φ is taken off.
    solve_approximately : callable, optional
        X ≈ A⁻¹ B, positive definite on the complement, for the sweeps whose directions Eq. (5) does not need.
    threads : int
        Threads of the products of block vectors; the numbers are the same for any.
    progress : callable
        Called with a line of text before each step after the static response.

    Returns
    -------
    residual_modes : ResidualModes
    vectors : ndarray, shape (n, p)
        Φ, turned by Eq. (3).

    Raises
    ------
    HousingError
        Where the shapes of the arrays do not fit, or the shift stands among the kept modes.
    ReductionError
        Where the sweeps do not converge or the result fails its proof.
    """
    n = stiffness.shape[0]
    if ports.shape[1] != n or vectors.shape != (n, len(values)) or len(free) != n:
        raise HousingError(
            f"ports of shape {ports.shape}, modes of shape {vectors.shape} with {len(values)} values and {len(free)} "
            f"places for a stiffness of order {n}; expected (r, {n}), ({n}, p) with p values, and {n} places"
        )
    if not (shift < 0.0 or shift > values.max(initial=0.0)):
        raise HousingError(f"a shift of {shift:g} rad²/s²; expected it below zero or above every kept mode")
    algebra = BlockAlgebra(n, threads)
    inertia = np.asarray(mass @ vectors)
    loads = np.asarray(ports.T.toarray(), dtype=np.float64)
    motions = vectors.T @ loads
    elastic = values > floor
    modal = (motions[elastic].T / values[elastic]) @ motions[elastic]

    beyond = loads - inertia @ motions
    static = _ConjugateGradients(beyond, 0.0, _SETTLED_RESPONSE_SHARE, modal.diagonal(), algebra, orders - 1)
    if begin:
        for response in begin:
            algebra.subtract(response, vectors, algebra.products(inertia, response))
        static.begin([(response, np.asarray(stiffness @ response)) for response in begin])
    solves = [solve] * (orders - 1) + [solve_approximately or solve]
    sweeps = _sweep_until_settled(stiffness, mass, solves, [static], vectors, inertia, algebra, progress)
    residual = static.x
    algebra.subtract(residual, vectors, algebra.products(inertia, residual))
    span = _independent(np.asarray(stiffness @ residual), residual, modal.diagonal(), algebra)
    for directions, products in static.first:
        span = _extended(stiffness, span, directions, products, algebra)
    progress("orthonormal shapes")
    squared, shapes, products, weights = _orthonormal(stiffness, mass, span, vectors, inertia, algebra)
    turn = _turn(algebra.products(products, vectors), squared, values)
    inertia += algebra.combined(weights, turn)
    vectors, shapes = vectors + algebra.combined(shapes, turn), shapes - algebra.combined(vectors, turn.T)
    motions = vectors.T @ loads
    modal = (motions[elastic].T / values[elastic]) @ motions[elastic]
    port_motions_of_modes = (ports @ shapes).T
    missing = (port_motions_of_modes.T / squared) @ port_motions_of_modes
    # Each load without the part that accelerates rigid modes, and the displacements found for it.
    balanced = loads - inertia[:, ~elastic] @ motions[~elastic]
    claimed = vectors[:, elastic] @ (motions[elastic] / values[elastic][:, None]) + shapes @ (
        port_motions_of_modes / squared[:, None]
    )
    progress("proof")
    slack = 1.0 + max(-shift, 0.0) / max(float(values.max(initial=0.0)), floor)
    proof = StaticProof(
        compliance=modal + missing,
        missing=missing,
        error=_static_error(stiffness, solve, balanced, claimed, modal + missing, values, vectors, inertia, slack),
        overlap=_overlap(mass, shapes, inertia),
        sweeps=sweeps,
    )
    if not (proof.error <= STATIC_BOUND and proof.overlap <= OVERLAP_BOUND):
        raise ReductionError(
            f"modes and residual attachments miss the static compliance at the ports by {proof.error:.1e} and overlap "
            f"by {proof.overlap:.1e}, bounds {STATIC_BOUND:.0e} and {OVERLAP_BOUND:.0e}: the modes are not exact "
            "ones of this stiffness and mass; solve for them again"
        )
    full = np.zeros((len(squared), 3 * n_nodes))
    full[:, free] = shapes.T
    return ResidualModes(np.sqrt(squared), full.reshape(len(squared), n_nodes, 3), proof), vectors


def extended_residual_modes(
    stiffness: Operator,
    mass: Operator,
    residual_modes: ResidualModes,
    further: FloatArray,
    vectors: FloatArray,
    free: IntArray,
    threads: int = 2,
) -> ResidualModes:
    """Extend residual modes so that they span further displacements of the discarded modes too.

    Parameters
    ----------
    stiffness, mass : matrix or operator, shape (n, n)
        Matrices on the free degrees of freedom.
    residual_modes : ResidualModes
    further : ndarray, shape (n, m)
    vectors : ndarray, shape (n, p)
        Kept modes, orthonormal in M.
    free : ndarray of int, shape (n,)
        Places of the free degrees of freedom among all.
    threads : int
        Threads of the products of block vectors.

    Returns
    -------
    ResidualModes
        Extended modes, with the proof of the given ones, whose static compliance at their ports they keep.
    """
    frequencies, count = residual_modes.frequencies, len(residual_modes.frequencies)
    shapes = residual_modes.shapes.reshape(count, -1).T[free]
    algebra = BlockAlgebra(len(free), threads)
    added = _extended(stiffness, shapes / frequencies, further, np.asarray(stiffness @ further), algebra)[:, count:]
    # The given modes are orthonormal to the kept ones already, so that only what is added is made so.
    inertia = np.asarray(mass @ vectors)
    for _ in range(2):
        algebra.subtract(added, vectors, algebra.products(inertia, added))
    force, weight = np.asarray(stiffness @ added), np.asarray(mass @ added)
    energy, inert = np.diag(np.append(frequencies**2, np.zeros(added.shape[1]))), np.eye(count + added.shape[1])
    energy[:count, count:], inert[:count, count:] = algebra.products(shapes, force), algebra.products(shapes, weight)
    energy[count:, count:], inert[count:, count:] = algebra.products(added, force), algebra.products(added, weight)
    squared, mixture = linalg.eigh(energy, inert, lower=False)
    joined = algebra.combined(shapes, mixture[:count])
    joined += algebra.combined(added, mixture[count:])
    full = np.zeros((len(squared), residual_modes.shapes[0].size))
    full[:, free] = (joined * _signs(joined)).T
    return ResidualModes(
        np.sqrt(squared), full.reshape(len(squared), *residual_modes.shapes.shape[1:]), residual_modes.proof
    )


def missing_harmonic_responses(
    stiffness: Operator,
    mass: Operator,
    solve: Solve,
    loads: Sequence[tuple[float, FloatArray]],
    vectors: FloatArray,
    inertia: FloatArray,
    shapes: FloatArray,
    frequencies: FloatArray,
    threads: int = 2,
    progress: Callable[[str], None] = lambda message: None,
) -> list[FloatArray]:
    """Compute what residual modes lack of the undamped responses of the discarded modes to harmonic loads.

    The response X of (K - ω²M) X = (I - M Φ Φᵀ) F in the complement of the kept modes, where K - ω²M is positive
    definite with ω below the limit, less that by the residual modes. Conjugate gradients as at rest find it, those of
    all frequencies side by side: a solve reads the whole factor, for few columns or many.

    Parameters
    ----------
    stiffness, mass : matrix or operator, shape (n, n)
        Matrices on the free degrees of freedom.
    solve : callable
        X ≈ A⁻¹ B with A = K - σM, σ between the kept and the discarded modes.
    loads : sequence of (float, ndarray of shape (n, m))
        ω below the limit [rad/s], and F [N].
    vectors, inertia : ndarray, shape (n, p)
        Φ and M Φ.
    shapes : ndarray, shape (n, k)
        Residual modes.
    frequencies : ndarray, shape (k,)
        Their frequencies [rad/s].
    threads : int
        Threads of the products of block vectors.
    progress : callable
        Called with a line of text before each sweep.

    Returns
    -------
    list of ndarray, shape (n, <= m)
        For each frequency displacements that span the missing ones to a part of 1e-6 of the whole responses, in the
        norm of strain energy.

    Raises
    ------
    ReductionError
        Where the sweeps do not converge.
    """
    searches, energies, algebra = [], [], BlockAlgebra(len(vectors), threads)
    for w, load in loads:
        static = algebra.combined(shapes, algebra.products(shapes, load) / (frequencies**2 - w**2)[:, None])
        energy = np.einsum("ij,ij->j", load, static)
        left = load - (np.asarray(stiffness @ static) - w**2 * np.asarray(mass @ static))
        algebra.subtract(left, inertia, algebra.products(vectors, left))
        searches.append(_ConjugateGradients(left, w**2, _HARMONIC_SETTLED, energy, algebra))
        energies.append(energy)
    _sweep_until_settled(stiffness, mass, [solve], searches, vectors, inertia, algebra, progress)
    missing = []
    for search, energy in zip(searches, energies, strict=True):
        x = search.x
        algebra.subtract(x, vectors, algebra.products(inertia, x))
        product = np.asarray(stiffness @ x) - search.squared * np.asarray(mass @ x)
        missing.append(_independent(product, x, energy, algebra))
    return missing


class _ConjugateGradients:
    """Block conjugate gradients for loads F at one ω² in the M-orthogonal complement of some modes V.

    Each sweep minimises the energy of every column over all columns' directions D, with Dᵀ (K - ω²M) D = I. The
    iteration has settled where a sweep moves no column by more than a part ``settled`` in the norm of the strain
    energy. ``covered`` [m/N] is the compliance held already, added to the columns' own as the measure where little is
    left. The directions of the sweeps up to a number ``kept`` stay in ``first``, each with its product.
    """

    def __init__(
        self,
        loads: FloatArray,
        squared: float,
        settled: float,
        covered: FloatArray | float,
        algebra: BlockAlgebra,
        kept: int = 0,
    ) -> None:
        self.x = np.zeros_like(loads)
        self.first: list[tuple[FloatArray, FloatArray]] = []
        self._algebra, self._kept = algebra, kept
        self.squared, self.left = squared, loads
        self._loads, self._settled, self._covered = loads.copy(), settled, covered
        self._directions = self._products = np.zeros((len(loads), 0))
        self._scale: FloatArray | None = None

    def begin(self, known: Sequence[tuple[FloatArray, FloatArray]]) -> None:
        """Begin with a response in place of none, and with directions of the first sweeps, each with its product."""
        (self.x, product), *self.first = known
        self.left = self._loads - product

    def take(self, step: FloatArray, product: FloatArray) -> bool:
        """Take a sweep from the preconditioned loads left, and their product; whether it has settled."""
        algebra = self._algebra
        if self._directions.shape[1]:
            before = algebra.products(self._products, step)
            algebra.subtract(step, self._directions, before)
            algebra.subtract(product, self._products, before)
        energy = algebra.products(step, product)
        if self._scale is None:
            # Loads are scaled by their response, so that forces and moments count alike.
            self._scale = _ratio(np.ones(len(energy)), np.sqrt(np.maximum(energy.diagonal(), 0.0)))
        scale = self._scale
        shares, mixture = np.linalg.eigh(scale[:, None] * (0.5 * (energy + energy.T)) * scale)
        # A direction that the others have already waits until it is no longer rounding beside them.
        new = shares > _ROUNDING_ENERGY_SHARE * max(shares.max(initial=0.0), 0.0)
        mixture = scale[:, None] * mixture[:, new] / np.sqrt(shares[new])
        self._directions, self._products = algebra.combined(step, mixture), algebra.combined(product, mixture)
        if len(self.first) < self._kept:
            self.first.append((self._directions, self._products))
        length = algebra.products(self._directions, self.left)
        algebra.subtract(self.x, self._directions, -length)
        algebra.subtract(self.left, self._products, length)
        moved = np.einsum("ij,ij->j", length, length)
        own = np.einsum("ij,ij->j", self._loads, self.x)
        return len(self.first) == self._kept and bool(np.all(moved <= self._settled**2 * (self._covered + own)))


def _sweep_until_settled(
    stiffness: Operator,
    mass: Operator,
    solves: Sequence[Solve],
    searches: Sequence[_ConjugateGradients],
    vectors: FloatArray,
    inertia: FloatArray,
    algebra: BlockAlgebra,
    progress: Callable[[str], None],
) -> int:
    """Sweep several searches side by side until each has settled, and return the number of sweeps.

    These are preconditioned by A⁻¹, each by a solve of its own, the last one also those beyond it.
    """
    unsettled = list(searches)
    for sweep in range(1, _MOST_SWEEPS + 1):
        progress(f"sweep {sweep}")
        left = [search.left for search in unsettled]
        solve = solves[min(sweep, len(solves)) - 1]
        steps = solve(left[0] if len(left) == 1 else np.hstack(left))
        algebra.subtract(steps, vectors, algebra.products(inertia, steps))
        products = np.asarray(stiffness @ steps)
        weighted = np.asarray(mass @ steps) if any(search.squared for search in unsettled) else steps
        remaining, first = [], 0
        for search in unsettled:
            columns = slice(first, first := first + search.left.shape[1])
            product = np.ascontiguousarray(products[:, columns])
            if search.squared:
                product -= search.squared * weighted[:, columns]
            if not search.take(np.ascontiguousarray(steps[:, columns]), product):
                remaining.append(search)
        unsettled = remaining
        if not unsettled:
            return sweep
    raise ReductionError(
        f"the static response to the ports' loads has not settled after {_MOST_SWEEPS} sweeps: the stiffness is not "
        "positive semidefinite, or the modes are not its own"
    )


def _independent(
    product: FloatArray, residual: FloatArray, known_energy: FloatArray, algebra: BlockAlgebra
) -> FloatArray:
    """Residual vectors orthonormal in K, whose ``product`` with them is given, that span the given ones.

    Loads are measured by the response that they find, so that a port of rotations counts like one of translations;
    combinations of them whose response adds less than a part of 1e-12 to the ports' compliance are dropped.
    """
    energy = algebra.products(residual, product)
    whole = known_energy + energy.diagonal()
    scale = 1.0 / np.sqrt(np.where(whole > 0.0, whole, 1.0))
    shares, mixture = linalg.eigh(scale[:, None] * (0.5 * (energy + energy.T)) * scale)
    new = shares > _NOTHING_NEW
    return algebra.combined(residual, scale[:, None] * mixture[:, new] / np.sqrt(shares[new]))


def _extended(
    stiffness: Operator, span: FloatArray, further: FloatArray, force: FloatArray, algebra: BlockAlgebra
) -> FloatArray:
    """Extend vectors orthonormal in K by the part of further ones, whose product with K is given, outside their span.

    A combination that adds less than the part `_ADDS_NOTHING` of its own strain energy is dropped.
    """
    energy_before = np.einsum("ij,ij->j", further, force)
    scale = _ratio(np.ones(len(energy_before)), np.sqrt(np.maximum(energy_before, 0.0)))
    further = further * scale
    algebra.subtract(further, span, algebra.products(span, force) * scale)
    # Once more, for the rounding that the first time leaves.
    force = np.asarray(stiffness @ further)
    algebra.subtract(further, span, algebra.products(span, force))
    energy = algebra.products(further, force)  # the span's part of this product is in no direction left
    shares, mixture = linalg.eigh(0.5 * (energy + energy.T))
    new = shares > _ADDS_NOTHING
    return np.hstack([span, algebra.combined(further, mixture[:, new] / np.sqrt(shares[new]))])


def _orthonormal(
    stiffness: Operator,
    mass: Operator,
    shapes: FloatArray,
    vectors: FloatArray,
    inertia: FloatArray,
    algebra: BlockAlgebra,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """ω² and M-orthonormal shapes with the span of the given ones, less the modes', that diagonalise K, ascending.

    Their products with K and M come behind them.
    """
    # Twice: the first pass mixes vectors of very different mass, whose rounding the second takes off.
    squared, products, weights = np.zeros(shapes.shape[1]), shapes, shapes
    for _ in range(2):
        algebra.subtract(shapes, vectors, algebra.products(inertia, shapes))
        products, weights = np.asarray(stiffness @ shapes), np.asarray(mass @ shapes)
        squared, mixture = linalg.eigh(algebra.products(shapes, products), algebra.products(shapes, weights))
        shapes = algebra.combined(shapes, mixture)
    signs = _signs(shapes)
    products, weights = (algebra.combined(columns, mixture * signs) for columns in (products, weights))
    return squared, shapes * signs, products, weights


def _signs(shapes: FloatArray) -> FloatArray:
    """Signs of the largest entries of shapes (n, k), shape (k,)."""
    return np.asarray(np.sign(shapes[np.argmax(np.abs(shapes), axis=0), np.arange(shapes.shape[1])]))


def _turn(coupling: FloatArray, squared: FloatArray, values: FloatArray) -> FloatArray:
    """Return s of Eq. (3) from ψᵀ K φ, shape (k, p) both; 0 beyond the error of a certified mode."""
    apart = values - squared[:, None]
    small = np.abs(coupling) <= RESIDUAL_BOUND * np.abs(apart)
    return np.asarray(np.divide(coupling, apart, out=np.zeros_like(coupling), where=small & (apart != 0.0)))


def _overlap(mass: Operator, shapes: FloatArray, inertia: FloatArray) -> float:
    deviation = shapes.T @ (mass @ shapes) - np.eye(shapes.shape[1])
    return float(max(np.abs(deviation).max(initial=0.0), np.abs(inertia.T @ shapes).max(initial=0.0)))


def _static_error(
    stiffness: Operator,
    solve: Solve,
    loads: FloatArray,
    claimed: FloatArray,
    compliance: FloatArray,
    values: FloatArray,
    vectors: FloatArray,
    inertia: FloatArray,
    slack: float,
) -> float:
    """Bound the error of :class:`StaticProof` by Eq. (4), from the displacements claimed for the balanced loads."""
    force = np.asarray(stiffness @ claimed)
    left = loads - force
    cross = claimed.T @ loads
    exact = cross + cross.T - claimed.T @ force
    along = vectors.T @ left
    beyond = left - inertia @ along
    solved = solve(beyond)
    unknown = slack * np.maximum(np.einsum("ij,ij->j", beyond, solved - vectors @ (inertia.T @ solved)), 0.0)
    elastic = values > 0.0
    unknown += (along[elastic] ** 2 / values[elastic][:, None]).sum(axis=0)
    diagonal = compliance.diagonal()
    size = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    rest = np.sqrt(unknown)
    return float(((np.abs(exact - compliance) + np.outer(rest, rest)) / np.outer(size, size)).max(initial=0.0))


def _ratio(top: FloatArray, bottom: FloatArray) -> FloatArray:
    """Return top / bottom, and 0 in a column that has converged to zero."""
    return np.asarray(np.divide(top, bottom, out=np.zeros_like(top), where=bottom > 0.0))


# Part of a response's strain energy, in its root, below which it adds nothing to others.
_REDUNDANT_RESPONSE_SHARE = 1e-6


def leading_residual_modes(
    residual_modes: ResidualModes, ports: sparse.csr_array, shift: float, orders: int
) -> tuple[ResidualModes, FloatArray]:
    """Extract the residual modes of fewer orders from a set of more orders.

    Parameters
    ----------
    residual_modes : ResidualModes
        A set of k residual modes.
    ports : scipy.sparse.csr_array, shape (r, 3 n_nodes)
        Motions of the ports that they belong to.
    shift : float
        σ [rad²/s²] of their dynamic responses: the square of the limit of the modes that they join.
    orders : int
        Responses kept for each port motion: 1, the static one; 2, that at the limit too; and so on.

    Returns
    -------
    residual_modes : ResidualModes
        A set of l <= k residual modes, with the proof of the whole set, whose static compliance they share.
    mixture : ndarray, shape (k, l)
        Coefficients of the new modes in terms of the given ones.

    Raises
    ------
    HousingError
        For less than one order.
    """
    if orders < 1:
        raise HousingError(f"{orders} orders of response; expected 1 or more")
    squared = residual_modes.frequencies**2
    if not squared.size:
        return residual_modes, np.zeros((0, 0))
    response = residual_modes.project(ports)
    parts = [response / squared[:, None]]
    for _ in range(orders - 1):
        response = response / (squared - shift)[:, None]
        parts.append(response)
    # In coordinates of unit strain energy, each response of unit length.
    strained = np.hstack(parts) * residual_modes.frequencies[:, None]
    length = np.linalg.norm(strained, axis=0)
    directions, sizes, _ = np.linalg.svd(strained[:, length > 0.0] / length[length > 0.0], full_matrices=False)
    span = (
        directions[:, sizes > _REDUNDANT_RESPONSE_SHARE * sizes.max(initial=0.0)] / residual_modes.frequencies[:, None]
    )
    squares, turned = linalg.eigh(span.T @ (squared[:, None] * span), span.T @ span)
    mixture = span @ turned
    shapes = (mixture.T @ residual_modes.shapes.reshape(len(squared), -1)).reshape(-1, *residual_modes.shapes.shape[1:])
    return ResidualModes(np.sqrt(squares), shapes, residual_modes.proof), mixture
