"""Gear body compliance: an exact elastic ring under a tooth, and the additional compliance of a rim on a web.

The load of a tooth is carried to the root circle as a force ``cos(beta)`` across the tooth's axis, ``sin(beta)`` along
it, and the torque ``rb`` about the gear's centre.  With the flexibility of the rigid root arc
(:mod:`coupling.gears.ring_body`) under (across, torque / r_f) and along,

    q = (f^T L f + R sin(beta)^2) / (E b),    f = (cos(beta), rb / r_f)

The ring is held at its bore.  A gear in one piece with its shaft (``bore = 0``) has no such place: its ring is held at
a third of the root circle, and the twist of the whole ring, which is the shaft's own, is left out.

A rim with a web of another width is two rings.  Its share is their compliance less that of one ring of the teeth's
width down to the same bore; finite elements of two widths agree within 4 % (tests/validation).  The model is plane: a
web off the middle of the face, and spokes, also tilt the rim, which is left out.  A rim alone (no web) is held at its
inside.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from coupling.gears.beam_compliance import PlaneState, plane_modulus
from coupling.gears.errors import StiffnessModelError
from coupling.gears.foundation import held_radius
from coupling.gears.geometry import Gear
from coupling.gears.profile import load_angle, root_half_angle
from coupling.gears.ring_body import Annulus, neighbour_flexibility, root_flexibility, twist_flexibility

FloatArray = npt.NDArray[np.float64]

SOLID_HOLD = 1.0 / 3.0
"""Radius at which a gear without a bore is held, in root circle radii."""


BodyCompliance = Callable[[FloatArray], FloatArray]
"""From radii of loaded points [m] to the compliance of the body along the line of action [m/N], of the same shape."""
CrossCompliance = Callable[[FloatArray, FloatArray], FloatArray]
"""From radii of the loaded points of two teeth [m] to the motion of one by a unit load on the other [m/N]."""


def ring_compliance(gear: Gear, state: PlaneState = "plane-stress") -> BodyCompliance:
    """Compliance of a body of the teeth's full width, solved once for loads at any radius.

    Parameters
    ----------
    gear : Gear
    state : {"plane-stress", "plane-strain"}
    """
    return _solved(gear, (Annulus(_hold(gear), 1.0, gear.face_width),), state, twists=held_radius(gear) is not None)


def rim_compliance(gear: Gear, state: PlaneState = "plane-stress") -> BodyCompliance:
    """Additional compliance of a rim on a thinner web over `ring_compliance`, solved once for loads at any radius.

    Zero for a gear without a rim or with a rim alone.

    Raises
    ------
    StiffnessModelError
        For a web that begins inside the bore's circle.
    """
    if gear.rim_inner_radius is None or gear.web_thickness is None:
        return lambda radius: np.zeros(np.shape(radius))
    rings = _rings(gear)
    plain = (Annulus(_hold(gear), 1.0, gear.face_width),)
    with_rim, without = (_solved(gear, body, state, twists=True) for body in (rings, plain))
    return lambda radius: with_rim(radius) - without(radius)


def neighbour_compliance(gear: Gear, state: PlaneState = "plane-stress", *, twists: bool = True) -> CrossCompliance:
    """Cross compliance of two neighbouring teeth: motion of one flank by a load on the other, along the line of action.

    Both teeth are rigid on their root arcs, each loaded on the same side; their own flexure is not felt next door. The
    twist of the ring between the held circle and the root circle is felt by both teeth in full.

    Parameters
    ----------
    gear : Gear
        A spur gear.
    state : {"plane-stress", "plane-strain"}
    twists : bool
        Whether the twist of the whole body is counted; never that of a gear in one piece with its shaft. Without it the
        bore and the rim are left out too, as for a tooth on a half plane: the dent of a solid gear remains.

    Returns
    -------
    callable
        From radii [m] of the loads on a tooth and on the next one in the sense of the loads (shapes that broadcast) to
        the compliance.
    """
    rings = _rings(gear) if twists else (Annulus(SOLID_HOLD, 1.0, gear.face_width),)
    nu, kappa = gear.poisson_ratio, _kolosov(gear, state)
    cross = neighbour_flexibility(rings, root_half_angle(gear), nu, kappa, 2.0 * math.pi / gear.teeth)
    if not (twists and held_radius(gear) is not None):
        cross = cross.copy()
        cross[1, 1] -= _whole_twist(rings, nu)
    torque = gear.base_radius / gear.root_circle_radius

    def loads(radius: FloatArray) -> FloatArray:
        beta = load_angle(gear, np.asarray(radius, dtype=np.float64))
        return np.array([np.cos(beta), np.full(beta.shape, torque), -np.sin(beta)])

    def compliance(behind: FloatArray, ahead: FloatArray) -> FloatArray:
        work = np.einsum("i...,ij,j...->...", loads(behind), cross, loads(ahead))
        return np.asarray(work / (gear.youngs_modulus * gear.face_width), dtype=np.float64)

    return compliance


def _solved(gear: Gear, rings: tuple[Annulus, ...], state: PlaneState, twists: bool) -> BodyCompliance:
    """Work of a unit load on the root arc; `twists` keeps the twist of the whole body."""
    nu = gear.poisson_ratio
    arc = root_flexibility(rings, root_half_angle(gear), nu, _kolosov(gear, state))
    torque = gear.base_radius / gear.root_circle_radius
    twist = 0.0 if twists else _whole_twist(rings, nu)

    def compliance(radius: FloatArray) -> FloatArray:
        beta = load_angle(gear, np.asarray(radius, dtype=np.float64))
        across, along = np.cos(beta), np.sin(beta)
        work = arc.lateral[0, 0] * across**2 + 2.0 * arc.lateral[0, 1] * across * torque + arc.lateral[1, 1] * torque**2
        work = work - twist * torque**2 + arc.radial * along**2
        return np.asarray(work / (gear.youngs_modulus * gear.face_width), dtype=np.float64)

    return compliance


def _whole_twist(rings: tuple[Annulus, ...], nu: float) -> float:
    """Twist of the whole body under a torque alone, times E and width, independent of the tractions."""
    return (1.0 + nu) / (2.0 * math.pi) * twist_flexibility(rings)


def _kolosov(gear: Gear, state: PlaneState) -> float:
    plane_modulus(gear, state)  # refuses an unknown state
    nu = gear.poisson_ratio
    return (3.0 - nu) / (1.0 + nu) if state == "plane-stress" else 3.0 - 4.0 * nu


def _rings(gear: Gear) -> tuple[Annulus, ...]:
    """Divide the gear body into annuli, from the radius where it is held to the root circle.

    Raises
    ------
    StiffnessModelError
        For a web that begins inside the bore's circle.
    """
    held = _hold(gear)
    if gear.rim_inner_radius is None or gear.web_thickness is None:
        return (Annulus(held, 1.0, gear.face_width),)
    inside = gear.rim_inner_radius / gear.root_circle_radius
    if inside <= held:
        raise StiffnessModelError(
            f"gear {gear.name!r}: the inside of the rim ({gear.rim_inner_radius * 1e3:.4g} mm radius) must be outside "
            f"the circle where the body is held ({held * gear.root_circle_radius * 1e3:.4g} mm); leave out the rim"
        )
    return Annulus(held, inside, gear.web_thickness), Annulus(inside, 1.0, gear.face_width)


def _hold(gear: Gear) -> float:
    """Radius at which the body is held, in root circle radii."""
    held = held_radius(gear)
    return SOLID_HOLD if held is None else held / gear.root_circle_radius
