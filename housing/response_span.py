"""Subset of residual modes that spans the responses of lower order to loads at the ports.

A set of residual modes that holds the static response of the discarded modes and their responses at the limit
(:mod:`housing.reduction`, Eq. 5) holds smaller sets too. In its own coordinates, with frequencies ω and motions p of
the ports, the response to a load is p / ω² at rest, p / (ω² - σ) at ω² = σ, and p / (ω² - σ)^j its derivatives there.
These span the set of fewer orders; the difference between the two sets shows what the further orders contribute.
"""

import numpy as np
import numpy.typing as npt
from scipy import linalg, sparse

from housing.errors import HousingError
from housing.reduction import ResidualModes

FloatArray = npt.NDArray[np.float64]

_SAME = 1e-6  # part of a response's strain energy, in its root, below which it adds nothing to others


def leading_residual_modes(
    residual_modes: ResidualModes, ports: sparse.csr_array, shift: float, orders: int
) -> tuple[ResidualModes, FloatArray]:
    """The residual modes of fewer orders that a set of more orders holds.

    Parameters
    ----------
    attachments : Attachments
        k of them.
    ports : scipy.sparse.csr_array, shape (r, 3 n_nodes)
        Motions of the ports that they belong to.
    shift : float
        σ [rad²/s²] of their dynamic responses: the square of the limit of the modes that they join.
    orders : int
        Responses kept for each port motion: 1, the static one; 2, that at the limit too; and so on.

    Returns
    -------
    attachments : Attachments
        l <= k of them, with the proof of the whole set, whose static compliance they share.
    mixture : ndarray, shape (k, l)
        Their coefficients in terms of the given ones.

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
    span = directions[:, sizes > _SAME * sizes.max(initial=0.0)] / residual_modes.frequencies[:, None]
    found, turned = linalg.eigh(span.T @ (squared[:, None] * span), span.T @ span)
    mixture = span @ turned
    shapes = (mixture.T @ residual_modes.shapes.reshape(len(squared), -1)).reshape(-1, *residual_modes.shapes.shape[1:])
    return ResidualModes(np.sqrt(found), shapes, residual_modes.proof), mixture
