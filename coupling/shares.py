"""Modal energy shares: kinetic energy, strain energy and damping of a mode by component, bearing and gear mesh.

A mode λ = σ + iω with shape q has a quadratic form in each matrix: m = qᴴ q, c = qᴴ C q and k = qᴴ K q. The
symmetric parts of C and K give their real parts; gyroscopic terms do no work, and the circulatory part of K, that of
cross-coupled bearings, gives i k_c. The real part of λ* qᴴ (λ² + λ C + K) q = 0 is the balance of power, so that

    σ = - Σ (|λ|² c + ω k_c) / (|λ|² m + k),

a sum over all parts of the machine: each one's part in the damping ratio -σ/|λ|, exactly, however strongly damped.

Shapes of eigenvalues that agree to rounding are any basis of the space that they span, and so would be their shares.
Each mode of such a group has the group's means over an orthonormal basis: traces, which do not depend on the basis.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import numpy.typing as npt

from coupling.contact_state import ContactState
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

# Relative distance of eigenvalues within which rounding mixes their shapes: by the eigensolver's error over this.
# Forward and backward whirl of a round shaft that hardly turns are further apart.
_SAME = 1e-8
_INDEPENDENT = 1e-6  # of the largest singular value of a group's shapes, above which a direction is one of theirs
_NOTHING = 1e-12  # strain or total energy below this part of the kinetic one is none


@dataclass(frozen=True)
class Part:
    """A part of the machine with strain energy and damping: a component, a connector, or a tooth contact."""

    kind: Literal["component", "connector", "contact"]
    name: str


@dataclass(frozen=True)
class ModeShares:
    """Energy shares of m modes, by c components and p parts.

    Attributes
    ----------
    parts : tuple of Part
        Components (shafts, housing, pedestals with their own supports), then linear connectors, then contacts.
    moving : ndarray, shape (m, n)
        Kinetic energy by coordinate.
    kinetic : ndarray, shape (m, c)
        The same by component.
    strain : ndarray, shape (m, p)
        Strain energy by part; zeros for a rigid-body motion, negative where a part's stiffness is.
    damping : ndarray, shape (m, p)
        Damping ratio by part; the sum is the mode's. Negative where a part feeds energy into the mode.
    stiffness : ndarray, shape (m,)
        Re qᴴ K q / qᴴ q [1/s²]; negative where the springs as a whole destabilise the mode.
    """

    parts: tuple[Part, ...]
    moving: FloatArray
    kinetic: FloatArray
    strain: FloatArray
    damping: FloatArray
    stiffness: FloatArray


def mode_shares(
    system: CoupledSystem, contact: ContactState, eigenvalues: ComplexArray, shapes: ComplexArray
) -> ModeShares:
    """Energy shares of modes, shapes (m, n) along the rows, in the order of their frequencies."""
    groups = _groups(eigenvalues)
    eigenvalues = _over_groups(eigenvalues, groups)
    shapes, means = _bases(shapes, groups)
    motion = means @ np.abs(shapes) ** 2
    mass = motion.sum(axis=1)
    parts: list[Part] = []
    kinetic, works = [], []
    start = 0
    for component in system.components:
        rows = slice(start, start + component.size)
        start += component.size
        parts.append(Part("component", component.name))
        kinetic.append(motion[:, rows].sum(axis=1))
        # The gyroscopic terms, which are skew, take no part in any of the three.
        works.append(_work(shapes[:, rows], component.stiffness, component.damping))
    for connector in system.linear:
        parts.append(Part("connector", connector.name))
        works.append(_work(shapes @ connector.directions, connector.stiffness, connector.damping))
    for tooth, k, c in zip(system.contacts, contact.stiffness, contact.damping, strict=True):
        parts.append(Part("contact", tooth.name))
        compression = np.abs(shapes @ tooth.direction) ** 2
        works.append((k * compression, 0.0 * compression, c * compression))
    strained, fed, lost = (np.array(rows) @ means.T for rows in zip(*works, strict=True))
    size = np.abs(eigenvalues)
    strain = strained.sum(axis=0)
    total = size**2 * mass + strain
    # Real eigenvalues of an undamped system with a negative stiffness have no total energy.
    safe = np.where(np.abs(total) > _NOTHING * size**2 * mass, total * np.where(size > 0.0, size, 1.0), np.inf)
    damping_shares = (size**2 * lost + eigenvalues.imag * fed) / safe
    held = np.abs(strained).sum(axis=0)
    return ModeShares(
        parts=tuple(parts),
        moving=motion / mass[:, None],
        kinetic=np.array(kinetic).T / mass[:, None],
        strain=(strained / np.where((size > 0.0) & (held > 0.0) & (strain != 0.0), strain, np.inf)).T,
        damping=np.where(size > 0.0, damping_shares, 0.0).T,
        stiffness=np.where(size > 0.0, strain / mass, 0.0),
    )


def _groups(eigenvalues: ComplexArray) -> list[slice]:
    """Runs of modes, ascending in frequency, whose eigenvalues agree to rounding; rigid motions stand alone."""
    size = np.abs(eigenvalues)
    apart = np.abs(np.diff(eigenvalues)) > _SAME * np.minimum(size[1:], size[:-1])
    edges = [0, *(np.flatnonzero(apart | (size[1:] == 0.0) | (size[:-1] == 0.0)) + 1).tolist(), len(eigenvalues)]
    return [slice(begin, end) for begin, end in pairwise(edges) if end > begin]


def _over_groups(values: ComplexArray, groups: list[slice]) -> ComplexArray:
    """Each group's mean in place of its values."""
    return np.concatenate([np.full(len(values[one]), values[one].mean()) for one in groups] or [values])


def group_bases(eigenvalues: ComplexArray, shapes: ComplexArray) -> tuple[ComplexArray, FloatArray]:
    """Orthonormal bases of the spaces of groups of modes, (b, n), and the averaging weights of each mode, (m, b).

    A quadratic form of the shapes, summed over an orthonormal basis of a group's space, depends on no choice of it.
    """
    return _bases(shapes, _groups(eigenvalues))


def _bases(shapes: ComplexArray, groups: list[slice]) -> tuple[ComplexArray, FloatArray]:
    """Orthonormal basis of each group's shapes, (b, n), and the averaging weights of each mode, (m, b)."""
    bases: list[ComplexArray] = []
    means = np.zeros((len(shapes), 0))
    for one in groups:
        basis = shapes[one]
        if len(basis) > 1:
            _, sizes, rows = np.linalg.svd(basis, full_matrices=False)
            basis = rows[sizes > _INDEPENDENT * sizes[0]]
        mean = np.zeros((len(shapes), len(basis)))
        mean[one] = 1.0 / len(basis)
        bases.append(basis)
        means = np.hstack([means, mean])
    return (np.concatenate(bases) if bases else shapes), means


def _work(
    deflections: ComplexArray, stiffness: FloatArray, damping: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Re qᴴ K q, Im qᴴ K q and Re qᴴ C q of deflections along the rows, shape (m,) each."""
    symmetric, skew = 0.5 * (stiffness + stiffness.T), 0.5 * (stiffness - stiffness.T)

    def form(matrix: FloatArray) -> ComplexArray:
        return np.asarray(np.sum(deflections.conj() * (deflections @ matrix.T), axis=1))

    return form(symmetric).real, form(skew).imag, form(0.5 * (damping + damping.T)).real
