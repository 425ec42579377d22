"""Residual attachments for modes that are there already: read from a file, or solved for with other ports."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy import sparse

from housing.factorization import Backend, Factorization, Factorizer
from housing.matrices import Matrices
from housing.modes import ModeSet
from housing.reduction import residual_attachments

IntArray = npt.NDArray[np.int64]

_FLOOR = 0.06  # part of the modes' limit: a shift so far below zero needs few sweeps
_ROUNDING = 3e-8  # part of the largest K_ii / M_ii, below which the shift would drown in the rounding of K


def attach_ports(
    matrices: Matrices,
    fixed: IntArray | None,
    modes: ModeSet,
    ports: Sequence[sparse.csr_array] | sparse.csr_array,
    *,
    factor: Factorization | None = None,
    shift: float | None = None,
    backend: Backend | None = None,
    threads: int = 2,
) -> ModeSet:
    """The same modes with residual attachments, so that the static compliance at the ports is exact.

    Parameters
    ----------
    matrices : Matrices
        Of which the modes are, springs included.
    fixed : ndarray of int, optional
        Degrees of freedom held at zero.
    modes : ModeSet
        Complete up to its limit; attachments that it has are replaced.
    ports : sparse array of shape (r, 3 n_nodes), or a sequence of them
        Such as those of :func:`housing.seat_matrix`; the attachments' order follows theirs.
    factor, shift : Factorization and float, optional
        A factor of K - shift M on the free degrees of freedom, where one is at hand, and its shift [rad²/s²]; both or
        neither.
    backend, threads
        See :class:`housing.factorization.Factorizer`; used where no factor is given.

    Raises
    ------
    HousingError, ReductionError
        See :func:`housing.reduction.residual_attachments`.
    """
    held = np.zeros(3 * matrices.n_nodes, dtype=bool)
    if fixed is not None:
        held[fixed] = True
    free = np.flatnonzero(~held)
    stiffness = _reduced(matrices.stiffness, free)
    mass = _reduced(matrices.mass, free)
    floor = max(
        (_FLOOR * modes.certificate.limit) ** 2, _ROUNDING * float(np.max(stiffness.diagonal() / mass.diagonal()))
    )
    if factor is None or shift is None:
        shift = -floor
        definite = _reduced(matrices.shifted(shift), free)
        factor = Factorizer(definite, backend=backend, threads=threads).factor(definite)
    attachments = residual_attachments(
        stiffness,
        mass,
        factor.solve,
        modes.frequencies**2,
        modes.shapes.reshape(len(modes.shapes), -1).T[free],
        stacked(ports)[:, free],
        shift=shift,
        floor=floor,
        free=free,
        n_nodes=matrices.n_nodes,
    )
    return replace(modes, attachments=attachments)


def stacked(ports: Sequence[sparse.csr_array] | sparse.csr_array) -> sparse.csr_array:
    """Several ports as one, their motions in order."""
    if isinstance(ports, sparse.csr_array):
        return ports
    return sparse.csr_array(sparse.vstack(list(ports), format="csr"))


def _reduced(matrix: sparse.csr_array, free: IntArray) -> sparse.csr_array:
    return matrix if len(free) == matrix.shape[0] else sparse.csr_array(matrix[free][:, free])
