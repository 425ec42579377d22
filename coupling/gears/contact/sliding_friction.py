r"""Sliding friction of a gear pair: sliding velocity of the flanks along the path of contact, for the contact law.

A pair of teeth at the position s along the path of contact, in base pitches, touches ``xi_k = xi_k0 + s p_b`` from the
driver's tangent point and ``xi_i = xi_i0 - s p_b`` from the driven gear's. Its flanks slide along each other across the
line of action by

    w(s) = w_k xi_k - w_i xi_i = W_a + s W_b,        W_a = w_k xi_k0 - w_i xi_i0,    W_b = (w_k + w_i) p_b

(speeds w by their magnitude), which reverses at the pitch point. Coulomb's friction on the pair's normal force
``F_j / cos(beta_b)``, F_j in the transverse plane, is ``mu F_j / cos(beta_b) sgn(w(s_j))``; see
:mod:`gearwhine.coupling.gears.contact.tooth_force_kernels` for the sum over the pairs.

On a helical face every slice has its own position x on the path, its own load q and its own reversal. The
contributions of a pair to the sums are then integrals over its line of contact,

    E_j = int q dz,      int q sgn(x - s_C) dz,      int q x sgn(x - s_C) dz,

functions of the position of the face's middle and of the compression beyond first touch alone, as the force itself is:
they are tables of the same kind (:mod:`gearwhine.coupling.gears.contact.lookup_tables`). A slice that contains the
pitch point counts by its parts before and behind it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears.contact.contact_law import ToothContact
from gearwhine.coupling.gears.contact.lookup_tables import Weight, face_force_table, law_table
from gearwhine.coupling.gears.errors import GearError, require_finite
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.numerics.arrays import FloatArray

LARGEST_COEFFICIENT = 0.5


@dataclass(frozen=True, eq=False)
class SlidingFriction:
    """Coulomb friction of a gear pair: coefficient and position along the path of contact at which it reverses.

    Attributes
    ----------
    coefficient : float
        mu over the cosine of the base helix angle: friction force over the pair's force in the transverse plane.
    pitch_point : float
        Position at which the sliding reverses [base pitches].
    path_end : float
        End of the path of contact, where corners slide [base pitches].
    shares : ndarray
        Numbers of `gearwhine.coupling.gears.contact.lookup_tables` for the three integrals over a line of contact that
        reverses slice by slice, in three variants of pairs for each variant; empty where lines of contact reverse as a
        whole.
    """

    coefficient: float
    pitch_point: float
    path_end: float
    shares: FloatArray = field(default_factory=lambda: np.zeros(0), repr=False)

    @property
    def event_phases(self) -> tuple[float, ...]:
        """Phases in [0, 1) at which the friction force steps, for lines of contact that reverse as a whole."""
        return () if self.shares.size else (self.pitch_point % 1.0,)

    def under(self, contact: ToothContact) -> SlidingFriction:
        """Return the friction of flanks with another contact law, such as with another gap over the face."""
        return replace(self, shares=_shares(contact, self)) if contact.enters_by_slices else self


def sliding_friction(geometry: GearPairGeometry, contact: ToothContact, coefficient: float) -> SlidingFriction:
    """Friction of a gear pair.

    Parameters
    ----------
    geometry : GearPairGeometry
    contact : ToothContact
        Contact law of the flanks that slide.
    coefficient : float
        Coefficient of friction, mu.

    Raises
    ------
    GearError
        For a coefficient outside 0 to 0.5, or a contact law without single pairs of teeth.
    """
    require_finite("friction coefficient", coefficient, minimum=0.0)
    if coefficient > LARGEST_COEFFICIENT:
        raise GearError(f"friction coefficient must be from 0 to {LARGEST_COEFFICIENT:g}, got {coefficient!r}")
    if not math.isclose(contact.contact_ratio, geometry.contact_ratio, rel_tol=1e-9):
        raise GearError(
            f"{geometry.label}: friction needs the place of each pair of teeth, over a contact ratio of "
            f"{geometry.contact_ratio:.6g}; got a stiffness of the whole mesh, over {contact.contact_ratio:.6g}"
        )
    across = coefficient / math.cos(geometry.driver.base_helix_angle)
    return SlidingFriction(across, geometry.pitch_point_position, geometry.contact_ratio).under(contact)


def sliding_direction_means(
    place: npt.ArrayLike, half: float, pitch_point: float, path_end: float
) -> tuple[FloatArray, FloatArray]:
    """Means of sgn(x - s_C) and of x sgn(x - s_C) over the part of ``place - half <= x <= place + half`` on the path.

    Beyond the path the corner slides, at the end of the path.

    Parameters
    ----------
    place : array_like
        Places along the path [base pitches].
    half, pitch_point, path_end : float
        [base pitches]; `half` 0 for a line of contact that reverses as a whole.
    """
    at = np.asarray(place, dtype=np.float64)
    low, high = np.clip(at - half, 0.0, path_end), np.clip(at + half, 0.0, path_end)
    reversal = np.clip(pitch_point, low, high)
    length = high - low
    point = length <= 0.0
    length = np.where(point, 1.0, length)
    sign = np.where(point, np.sign(low - pitch_point), (high + low - 2.0 * reversal) / length)
    moment = np.where(point, low * np.sign(low - pitch_point), (0.5 * (high**2 + low**2) - reversal**2) / length)
    return sign, moment


def _shares(contact: ToothContact, friction: SlidingFriction) -> FloatArray:
    """Tabulate the three friction integrals over a line of contact, in the layout of a contact law."""
    faces = contact.table_faces
    assert faces is not None

    def share(which: int) -> Weight:
        return lambda place: sliding_direction_means(place, faces.half_span, friction.pitch_point, friction.path_end)[
            which
        ]

    weights = (np.ones_like, share(0), share(1))
    table = face_force_table(faces, contact.variant_curves, contact.module, weights, breaks=(friction.pitch_point,))
    entering = contact.entering * [1.0, len(weights)]
    return law_table(table, entering, 0.0, 0.0, contact.shared_compliance, contact.body_tilt, contact.tooth_tilts)
