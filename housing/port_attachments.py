"""Residual attachment modes for an existing mode set, read from a file or solved for with other ports."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy import sparse

from housing.factorization import Backend, Factorization, Factorizer
from housing.free_system import FreeSystem
from housing.matrices import Matrices
from housing.modes import ModeSet
from housing.reduction import residual_attachment_modes

IntArray = npt.NDArray[np.int64]


def add_residual_modes(
    matrices: Matrices,
    modes: ModeSet,
    ports: Sequence[sparse.csr_array] | sparse.csr_array,
    *,
    factor: Factorization | None = None,
    shift: float | None = None,
    backend: Backend | None = None,
    threads: int = 2,
) -> ModeSet:
    """Add residual modes to a mode set, so that the static compliance at the ports is exact.

    The shapes stay the same to the error of their certificate, which Eq. (3) of :mod:`housing.reduction` reduces.

    Parameters
    ----------
    matrices : Matrices
        The matrices of the modes, supports included.
    modes : ModeSet
        Complete up to its limit; its own residual modes are replaced.
    ports : sparse array of shape (r, 3 n_nodes), or a sequence of them
        Such as those of :func:`housing.seat_matrix`; the static compliance has their order.
    factor, shift : Factorization and float, optional
        A factor of K - shift M on the free degrees of freedom, where one is at hand, and its shift [rad²/s²]; both or
        neither.
    backend, threads
        See :class:`housing.factorization.Factorizer`; used where no factor is given.

    Raises
    ------
    HousingError, ReductionError
        See :func:`housing.reduction.residual_attachment_modes`.
    """
    system = FreeSystem(matrices, threads=threads)
    floor = system.floor(modes.certificate.limit)
    if factor is None or shift is None:
        shift = -floor
        factor = Factorizer(backend=backend, threads=threads).factor(system.shifted(shift))
    residual_modes, vectors = residual_attachment_modes(
        system.stiffness,
        system.mass,
        factor.solve,
        modes.frequencies**2,
        modes.shapes.reshape(len(modes.shapes), -1).T[system.free],
        stacked(ports)[:, system.free],
        shift=shift,
        floor=floor,
        free=system.free,
        n_nodes=system.n_nodes,
    )
    return replace(modes, shapes=system.expand(vectors), residual_modes=residual_modes)


def stacked(ports: Sequence[sparse.csr_array] | sparse.csr_array) -> sparse.csr_array:
    """Several ports as one, their motions in order."""
    if isinstance(ports, sparse.csr_array):
        return ports
    return sparse.csr_array(sparse.vstack(list(ports), format="csr"))
