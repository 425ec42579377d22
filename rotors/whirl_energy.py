"""Strain energy of whirl modes in lengths of shaft, bearings and pedestals.

In motion Re[q̂ e^{λt}] strain energy swings at twice the frequency about a mean. Meant here is the mean over one turn of
the phase, with the growth or decay e^{Re λ t} left out, ¼ Re(q̂ᴴ K q̂): of the shaft

    ¼ ∫ |f_x|²/(κGA + P) + |f_y|²/(κGA + P) + (|m_x|² + |m_y|²)/EI + g P (|β_x|² + |β_y|²) + |n|²/EA dz

with its complex shear forces f, bending moments m, slopes β and axial force n; of a spring K between the shaft and its
carrier ¼ Re(δᴴ K δ) with the complex deflection δ, in which a skew part of K, which stores nothing, takes no part. As
circular coordinates r± = (x ± i y)/√2 are unitary, the sums over x and y are those over + and −.

Without damping a share is also the sensitivity of the mode's frequency to that stiffness: with λ = iω and Hermitian
matrices, ∂ω/∂ln k of a part is proportional to its energy.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .bearing import Bearing
from .chain import GAUSS_FRACTIONS, GAUSS_WEIGHTS
from .search import require_positions
from .shaft import merged_positions
from .spatial_field import ShaftMotion

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class StrainShares:
    """Shares of every mode's mean strain energy; their sum is one, or zero for a mode that strains nothing.

    Attributes
    ----------
    lengths
        (w, e): in lengths of shaft.
    bearings
        (w, b): in the bearings; the energy of a spring that drives, which would count as negative, included.
    pedestals
        (w, b): in the pedestals that the bearings stand on; zero where they have none.
    """

    lengths: FloatArray
    bearings: FloatArray
    pedestals: FloatArray


def strain_shares(motion: ShaftMotion, bearings: Sequence[Bearing], edges: npt.ArrayLike) -> StrainShares:
    """Shares of motions (w,) on bearings of constant coefficients, in lengths between ascending ``edges`` (e + 1,), m.

    Raises
    ------
    RotorError
        A position is not on the shaft.
    """
    lengths = _along(motion, require_positions(motion.chain.nodes, edges))
    held, grounded = np.zeros((2, motion.count, len(bearings)))
    for k, bearing in enumerate(bearings):
        held[:, k], grounded[:, k] = _in_springs(motion, bearing)
    whole = (lengths.sum(axis=1) + held.sum(axis=1) + grounded.sum(axis=1))[:, None]
    parts = (np.divide(part, whole, out=np.zeros_like(part), where=whole > 0.0) for part in (lengths, held, grounded))
    return StrainShares(*parts)


def _along(motion: ShaftMotion, edges: FloatArray) -> FloatArray:
    """Four times the mean strain energy of the shaft between the edges, (w, e), J."""
    chain = motion.chain
    cuts = merged_positions(chain.nodes, edges.tolist())
    widths = np.diff(cuts)
    places = (cuts[:-1, None] + widths[:, None] * GAUSS_FRACTIONS).ravel()
    weights = (widths[:, None] / chain.length_unit * GAUSS_WEIGHTS).ravel()
    bent = chain.coefficients_at(*chain.places(places)) * weights[:, None]
    density = np.zeros((motion.count, places.size))
    for states in motion.at(places):
        squared = np.abs(states) ** 2
        density += squared[:, :, 1] * bent[:, 5] + squared[:, :, 2] * bent[:, 0] + squared[:, :, 3] * bent[:, 1]
    if motion.rod is not None:
        stretched = motion.rod.coefficients_at(*motion.rod.places(places))[:, 0] * weights
        density += np.abs(motion.axial_at(places)[:, :, 1]) ** 2 * stretched
    cells = density.reshape(motion.count, widths.size, -1).sum(axis=2)
    owner = np.searchsorted(edges, 0.5 * (cuts[1:] + cuts[:-1])) - 1
    return np.stack([cells[:, owner == k].sum(axis=1) for k in range(edges.size - 1)], axis=1)


def _in_springs(motion: ShaftMotion, bearing: Bearing) -> tuple[FloatArray, FloatArray]:
    """Four times the mean strain energy in a bearing and in its pedestal, (w,) each, J."""
    x, y = (part[:, 0] for part in motion.evaluate([bearing.at]))
    slope_x, slope_y = (part[:, 0] for part in motion.evaluate_slopes([bearing.at]))
    along = np.zeros_like(x)
    if motion.rod is not None:
        along = motion.axial_at([bearing.at])[:, 0, 0] * motion.rod.displacement_unit[0]
    # The slope in x is the rotation about y, that in y minus the rotation about x.
    deflection = np.stack([x, y, along, -slope_y, slope_x], axis=1)
    stiffness, pedestal = bearing.spatial_stiffness, bearing.pedestal
    if pedestal is None:
        return _stored(stiffness, deflection), np.zeros(motion.count)
    at = motion.eigenvalues[:, None, None]
    dynamic = stiffness + at * bearing.spatial_damping
    ground = pedestal.stiffness + at * pedestal.damping + at**2 * pedestal.mass * np.eye(2)
    force = (dynamic[:, :2] @ deflection[:, :, None])[:, :, 0]
    foot = np.asarray(np.linalg.solve(ground + dynamic[:, :2, :2], force[:, :, None])[:, :, 0], np.complex128)
    deflection[:, :2] -= foot
    return _stored(stiffness, deflection), _stored(pedestal.stiffness, foot)


def _stored(stiffness: FloatArray, deflection: ComplexArray) -> FloatArray:
    """Re(δᴴ K δ) of deflections (w, n), (w,)."""
    return np.asarray(np.einsum("wi,ij,wj->w", deflection.conj(), stiffness, deflection).real)
