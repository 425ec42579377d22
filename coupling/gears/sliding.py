r"""How the flanks of a gear pair slide, as the contact law's friction needs it.

A pair of teeth at the position s along the path of contact, in base pitches, touches ``xi_k = xi_k0 + s p_b`` from the
driver's tangent point and ``xi_i = xi_i0 - s p_b`` from the driven gear's. Its flanks slide along each other across the
line of action by

    w(s) = w_k xi_k - w_i xi_i = W_a + s W_b,        W_a = w_k xi_k0 - w_i xi_i0,    W_b = (w_k + w_i) p_b

(speeds w by their amounts), which turns at the pitch point. Coulomb's friction on the pair's normal force
``F_j / cos(beta_b)``, F_j in the transverse plane, is ``mu F_j / cos(beta_b) sgn(w(s_j))``; see
:mod:`coupling.gears.friction_kernels` for the sum over the pairs. On a helical face, whose contact line spans
``s - h <= x <= s + h``, the load is taken as even over what of it lies on the path. Most faces carry less towards the
ends of the path, so this overstates the loss; :func:`coupling.gears.mesh_friction` follows every slice, for a load that
stands still.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from coupling.gears.errors import GearError, require_finite
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.tooth_contact import ToothContact

LARGEST_COEFFICIENT = 0.5


@dataclass(frozen=True)
class SlidingFriction:
    """Coulomb friction of a pair of gears: how much, and where along the path of contact it turns.

    Attributes
    ----------
    coefficient : float
        mu over the cosine of the base helix angle: friction force by the pair's force in the transverse plane.
    pitch_point : float
        Where the sliding turns [base pitches].
    half_line : float
        h, half of what a contact line spans along the path [base pitches]; 0 for spur gears.
    path_end : float
        End of the path of contact, where corners slide [base pitches].
    """

    coefficient: float
    pitch_point: float
    half_line: float
    path_end: float

    @property
    def event_phases(self) -> tuple[float, ...]:
        """Phases in [0, 1) at which the force steps, turning all at once with a straight line of contact."""
        return (self.pitch_point % 1.0,) if self.half_line == 0.0 else ()


def sliding_friction(geometry: GearPairGeometry, contact: ToothContact, coefficient: float) -> SlidingFriction:
    """Friction of a gear pair.

    Parameters
    ----------
    geometry : GearPairGeometry
    contact : ToothContact
        The law of its teeth.
    coefficient : float
        Of friction, mu.

    Raises
    ------
    GearError
        For a coefficient that is not from 0 to 0.5, or a contact that knows no single pairs of teeth.
    """
    require_finite("friction coefficient", coefficient, minimum=0.0)
    if coefficient > LARGEST_COEFFICIENT:
        raise GearError(f"friction coefficient must be from 0 to {LARGEST_COEFFICIENT:g}, got {coefficient!r}")
    if not math.isclose(contact.contact_ratio, geometry.contact_ratio, rel_tol=1e-9):
        raise GearError(
            f"{geometry.label}: friction needs the place of each pair of teeth, over a contact ratio of "
            f"{geometry.contact_ratio:.6g}; got a stiffness of the whole mesh, over {contact.contact_ratio:.6g}"
        )
    return SlidingFriction(
        coefficient / math.cos(geometry.driver.base_helix_angle),
        geometry.pitch_point_position,
        0.0 if contact.faces is None else 0.5 * geometry.overlap_ratio,
        geometry.contact_ratio,
    )
