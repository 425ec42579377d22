"""The housing reduced to its ports: what its modes lack there, added as residual attachment modes.

Kept modes Φ (φᵀ M φ = 1, eigenvalues λ) answer a static port load f = Pᵀ with Σ φ φᵀ f / λ. All the discarded ones
together answer with the *residual vectors*

    X = Σ_discarded φ φᵀ Pᵀ / λ,        K X = F,   F = (I - M Φ Φᵀ) Pᵀ,   Φᵀ M X = 0,                    (1)

which need no discarded mode to be known: on the M-orthogonal complement of Φ the stiffness is positive definite,
free body or not, since a free body's rigid modes are among Φ. There (1) is solved with the factor of
A = K - σM, σ < 0, that the eigensolution has at hand. In the sweep

    X <- X + A⁻¹ (F - K X)                                                                               (2)

the error becomes (I - A⁻¹ K) E. Both matrices are diagonal in the modes, so that each discarded mode's part shrinks by
1 - λ / (λ - σ) = |σ| / (λ + |σ|), at most by |σ| / (λ_first discarded + |σ|): for a shift at 6 % of the limit's
circular frequency by a factor of 280, whatever the mesh. Conjugate gradients preconditioned by A⁻¹ take the same
sweeps, need fewer of them, and bear a shift that lies further below.

The span of X is then made a set of modes of its own: orthonormal in M to Φ and in itself, with a diagonal stiffness
(Craig and Kurdila, *Fundamentals of Structural Dynamics*, 2006, chapter 17, on residual attachment modes; after
MacNeal 1971 and Rubin 1975). By Galerkin's argument its compliance at the ports errs by the square of the error
of X. Modes and attachments side by side are a component with the unit mass, a diagonal stiffness and the exact static
compliance at its ports.

The compliance spoken of is the elastic one: modes with λ <= |σ| are left out of it, rigid and nearly rigid ones. For a
free body this is its inertia-relief compliance Aᵀ G A with A = I - M Φ_rigid Φ_rigidᵀ: the load is balanced by the
inertia of the accelerated body. A body on mounts that are soft beside the limit is held to the same, stricter measure.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import linalg, sparse

from housing.errors import HousingError, ReductionError

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
Solve = Callable[[FloatArray], FloatArray]

STATIC_BOUND = 1e-10
OVERLAP_BOUND = 1e-8
_SETTLED = 1e-9  # part of a port's whole response, in energy, that a last sweep may still move
_PROBE_SETTLED = 1e-6  # the probes' compliance errs by the square of this
_NOTHING_NEW = 1e-12  # part of the ports' compliance below which a direction is rounding or known already
_MOST_SWEEPS = 200
_PROBES = 4  # loads that the proof solves for: every port alone, or so many random combinations of all


@dataclass(frozen=True)
class StaticProof:
    """The static compliance at the ports, and how it was proved; r port motions.

    Attributes
    ----------
    compliance : ndarray, shape (r, r)
        Elastic compliance: motion of one port by a unit load on another [m/N, rad/N, rad/(N m)].
    missing : ndarray, shape (r, r)
        The part of it that the kept modes alone lack.
    error : float
        Largest |C_ab - C'_ab| / sqrt(C_aa C_bb) over probing loads a, b, with C' by modes and attachments and C by
        solves of K x = f that know of neither.
    overlap : float
        Largest |φᵀ M ψ| of two different vectors among modes and attachments, and |ψᵀ M ψ - 1|.
    sweeps : int
        Solves with the factor of A for all ports at once.
    """

    compliance: FloatArray
    missing: FloatArray
    error: float
    overlap: float
    sweeps: int

    @property
    def missing_parts(self) -> FloatArray:
        """Part of each port's own compliance that the kept modes lack, shape (r,): the error without attachments."""
        own = self.compliance.diagonal()
        return np.asarray(self.missing.diagonal() / np.where(own > 0.0, own, 1.0))


@dataclass(frozen=True)
class Attachments:
    """Residual attachment modes: k of them, at most one for each port motion.

    Attributes
    ----------
    frequencies : ndarray, shape (k,)
        ω with ψᵀ K ψ = ω² [rad/s], ascending. Where the stiffness of what the modes lack balances its mass: not a
        natural frequency of the housing, and above all of the kept ones.
    shapes : ndarray, shape (k, n_nodes, 3)
        ψᵀ M ψ = 1 [1/√kg], and no mass in common with the modes or each other.
    proof : StaticProof
    """

    frequencies: FloatArray
    shapes: FloatArray
    proof: StaticProof

    def project(self, port: sparse.csr_array) -> FloatArray:
        """The attachments' motions at a port, shape (k, n_motions)."""
        return np.asarray((port @ self.shapes.reshape(len(self.shapes), port.shape[1]).T).T)


def residual_attachments(
    stiffness: sparse.csr_array,
    mass: sparse.csr_array,
    solve: Solve,
    shift: float,
    values: FloatArray,
    vectors: FloatArray,
    ports: sparse.csr_array,
    *,
    free: IntArray,
    n_nodes: int,
) -> Attachments:
    """Residual attachment modes of a set of modes, proved to make the static compliance at the ports exact.

    Parameters
    ----------
    stiffness, mass : scipy.sparse.csr_array, shape (n, n)
        K [N/m] and M [kg] on the free degrees of freedom.
    solve : callable
        X = A⁻¹ B with A = K - shift M, for B of shape (n, m).
    shift : float
        σ < 0 [rad²/s²].
    values : ndarray, shape (p,)
        λ = ω² of the kept modes [rad²/s²], every one below some limit.
    vectors : ndarray, shape (n, p)
        Φ, with Φᵀ M Φ = I.
    ports : scipy.sparse.csr_array, shape (r, n)
        P: motions at the ports from the free degrees of freedom; loads act by its transpose.
    free : ndarray of int, shape (n,)
        Where these degrees of freedom stand among the mesh's 3 n_nodes.
    n_nodes : int
        Nodes of the mesh.

    Raises
    ------
    HousingError
        Where the shapes of the arrays do not fit, or the shift is not negative.
    ReductionError
        Where the sweeps do not settle or the result fails its proof.
    """
    n = stiffness.shape[0]
    if ports.shape[1] != n or vectors.shape != (n, len(values)) or len(free) != n:
        raise HousingError(
            f"ports of shape {ports.shape}, modes of shape {vectors.shape} with {len(values)} values and {len(free)} "
            f"places for a stiffness of order {n}; expected (r, {n}), ({n}, p) with p values, and {n} places"
        )
    if not shift < 0.0:
        raise HousingError(f"a shift of {shift:g} rad²/s²; expected it below zero, where K - shift M is definite")
    inertia = np.asarray(mass @ vectors)
    loads = np.asarray(ports.T.toarray(), dtype=np.float64)
    motions = vectors.T @ loads
    elastic = values > -shift
    modal = (motions[elastic].T / values[elastic]) @ motions[elastic]

    residual, sweeps = _static_response(stiffness, solve, loads, vectors, inertia, _SETTLED, modal.diagonal())
    squared, shapes = _orthonormal(stiffness, mass, residual, modal.diagonal(), vectors, inertia)
    found = (ports @ shapes).T
    missing = (found.T / squared) @ found
    proof = StaticProof(
        compliance=modal + missing,
        missing=missing,
        error=_probed_error(stiffness, solve, loads, vectors[:, ~elastic], inertia[:, ~elastic], modal + missing),
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
    return Attachments(np.sqrt(squared), full.reshape(len(squared), n_nodes, 3), proof)


def _static_response(
    stiffness: sparse.csr_array,
    solve: Solve,
    loads: FloatArray,
    vectors: FloatArray,
    inertia: FloatArray,
    settled: float,
    known: FloatArray | float = 0.0,
) -> tuple[FloatArray, int]:
    """X with K X = (I - M V Vᵀ) F and Vᵀ M X = 0 for some modes V, and the sweeps it took.

    Conjugate gradients in the M-orthogonal complement of V, preconditioned by A⁻¹, each column by itself, until a
    sweep moves no column by more than a part ``settled`` in the norm of the strain energy. ``known`` [m/N] is
    compliance beside the columns' own to measure against, where little may be left.
    """
    x = np.zeros_like(loads)
    left = loads - inertia @ (vectors.T @ loads)
    direction, before = np.zeros_like(loads), np.ones(loads.shape[1])
    for sweep in range(1, _MOST_SWEEPS + 1):
        step = solve(left)
        step -= vectors @ (inertia.T @ step)
        power = np.einsum("ij,ij->j", left, step)
        direction = step + direction * (_ratio(power, before) if sweep > 1 else 0.0)
        before = power
        product = np.asarray(stiffness @ direction)
        length = _ratio(power, np.einsum("ij,ij->j", direction, product))
        x += direction * length
        left = left - product * length
        if np.all(length * power <= settled**2 * (known + np.einsum("ij,ij->j", loads, x))):
            return x - vectors @ (inertia.T @ x), sweep
    raise ReductionError(
        f"the static response to the ports' loads has not settled after {_MOST_SWEEPS} sweeps: the stiffness is not "
        "positive semidefinite, or the modes are not its own"
    )


def _orthonormal(
    stiffness: sparse.csr_array,
    mass: sparse.csr_array,
    residual: FloatArray,
    known: FloatArray,
    vectors: FloatArray,
    inertia: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """ω² and M-orthonormal shapes that span the residual vectors and diagonalise K in them, ascending.

    Loads are measured by the response that they find, so that a port of rotations counts like one of translations;
    combinations of them whose response adds less than a part of 1e-12 to the ports' compliance are dropped.
    """
    energy = residual.T @ (stiffness @ residual)
    whole = known + energy.diagonal()
    scale = 1.0 / np.sqrt(np.where(whole > 0.0, whole, 1.0))
    shares, mixture = linalg.eigh(scale[:, None] * (0.5 * (energy + energy.T)) * scale)
    new = shares > _NOTHING_NEW
    shapes = (residual * scale) @ (mixture[:, new] / np.sqrt(shares[new]))
    # Twice: the first pass mixes vectors of very different mass, whose rounding the second takes off.
    squared = np.zeros(shapes.shape[1])
    for _ in range(2):
        shapes = shapes - vectors @ (inertia.T @ shapes)
        squared, mixture = linalg.eigh(shapes.T @ (stiffness @ shapes), shapes.T @ (mass @ shapes))
        shapes = shapes @ mixture
    largest = shapes[np.argmax(np.abs(shapes), axis=0), np.arange(shapes.shape[1])]
    return squared, np.asarray(shapes * np.sign(largest))


def _overlap(mass: sparse.csr_array, shapes: FloatArray, inertia: FloatArray) -> float:
    own = shapes.T @ (mass @ shapes) - np.eye(shapes.shape[1])
    return float(max(np.abs(own).max(initial=0.0), np.abs(inertia.T @ shapes).max(initial=0.0)))


def _probed_error(
    stiffness: sparse.csr_array,
    solve: Solve,
    loads: FloatArray,
    soft: FloatArray,
    soft_inertia: FloatArray,
    compliance: FloatArray,
) -> float:
    """What independent solves find wrong with the compliance; see :class:`StaticProof`.

    They are made in the complement of the rigid and soft modes alone, where A⁻¹ K has its eigenvalues between one half
    and one: no other mode has a part in them. The compliance of two loads, aᵀ y + xᵀ b - xᵀ K y, errs by the product
    of the errors of x and y.
    """
    own = compliance.diagonal()
    size = 1.0 / np.sqrt(np.where(own > 0.0, own, 1.0))
    r = len(own)
    chosen = np.eye(r) if r <= _PROBES else np.random.default_rng(0).choice([-1.0, 1.0], size=(r, _PROBES))
    probes = size[:, None] * chosen
    right = loads @ probes
    x, _ = _static_response(stiffness, solve, right, soft, soft_inertia, _PROBE_SETTLED)
    cross = right.T @ x
    exact = cross + cross.T - x.T @ (stiffness @ x)
    claimed = probes.T @ compliance @ probes
    diagonal = np.where(exact.diagonal() > 0.0, exact.diagonal(), 1.0)
    return float(np.abs((exact - claimed) / np.sqrt(np.outer(diagonal, diagonal))).max(initial=0.0))


def _ratio(top: FloatArray, bottom: FloatArray) -> FloatArray:
    """top / bottom, and 0 where a column has settled to nothing."""
    return np.asarray(np.divide(top, bottom, out=np.zeros_like(top), where=bottom > 0.0))
