"""The body under a tooth as an exact elastic ring, and what a rim on a web adds to it.

The load of a tooth is carried to the root circle as a force ``cos(beta)`` across the tooth's axis, ``sin(beta)`` along
it, and the torque ``rb`` about the gear's centre.  With the flexibility of the rigid root arc
(:mod:`coupling.gears.ring_body`) under (across, torque / r_f) and along,

    q = (f^T L f + R sin(beta)^2) / (E b),    f = (cos(beta), rb / r_f)

The ring is held at its bore.  A gear in one piece with its shaft (``bore = 0``) has no such place: its ring is held at
a third of the root circle, and the twist of the whole ring, which is the shaft's own, is left out.

A rim with a web of another width is two rings.  Its share is what they yield more than one ring of the teeth's width
down to the same bore; finite elements of two widths agree within 4 % (tests/validation).  All of it is in the plane of
the gear: a web that is not in the middle of the face, and spokes, also tilt the rim, which is not here.  A rim alone
(no web) is held at its inside.
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
from coupling.gears.ring_body import Annulus, root_flexibility

FloatArray = npt.NDArray[np.float64]

SOLID_HOLD = 1.0 / 3.0
"""Where a gear without a bore is held, in root circle radii."""


BodyCompliance = Callable[[FloatArray], FloatArray]
"""From radii of loaded points [m] to what the body yields there along the line of action [m/N], of the same shape."""


def solved_ring(gear: Gear, state: PlaneState = "plane-stress") -> BodyCompliance:
    """The body of the teeth's full width, solved once for loads at any radius.

    Parameters
    ----------
    gear : Gear
    state : {"plane-stress", "plane-strain"}
    """
    return _solved(gear, (Annulus(_hold(gear), 1.0, gear.face_width),), state, turning=held_radius(gear) is not None)


def solved_rim(gear: Gear, state: PlaneState = "plane-stress") -> BodyCompliance:
    """What the body yields beyond that of `solved_ring` because rim and web are not one, solved once.

    Zero for a gear without a rim or with a rim alone.

    Raises
    ------
    StiffnessModelError
        For a web that begins inside the bore's circle.
    """
    if gear.rim_inner_radius is None or gear.web_thickness is None:
        return lambda radius: np.zeros(np.shape(radius))
    held, inside = _hold(gear), gear.rim_inner_radius / gear.root_circle_radius
    if inside <= held:
        raise StiffnessModelError(
            f"gear {gear.name!r}: the inside of the rim ({gear.rim_inner_radius * 1e3:.4g} mm radius) must be outside "
            f"the circle where the body is held ({held * gear.root_circle_radius * 1e3:.4g} mm); leave out the rim"
        )
    rings = (Annulus(held, inside, gear.web_thickness), Annulus(inside, 1.0, gear.face_width))
    plain = (Annulus(held, 1.0, gear.face_width),)
    with_rim, without = (_solved(gear, body, state, turning=True) for body in (rings, plain))
    return lambda radius: with_rim(radius) - without(radius)


def _solved(gear: Gear, rings: tuple[Annulus, ...], state: PlaneState, turning: bool) -> BodyCompliance:
    """Work of a unit load on the root arc; `turning` keeps the twist of the whole body."""
    plane_modulus(gear, state)  # refuses an unknown state
    nu = gear.poisson_ratio
    kappa = (3.0 - nu) / (1.0 + nu) if state == "plane-stress" else 3.0 - 4.0 * nu
    arc = root_flexibility(rings, root_half_angle(gear), nu, kappa)
    torque = gear.base_radius / gear.root_circle_radius
    # Under a torque alone the whole ring twists by (1/r_i^2 - 1) / (4 pi G) per width, whatever the tractions.
    twist = 0.0 if turning else (1.0 + nu) / (2.0 * math.pi) * (rings[0].inner ** -2 - 1.0)

    def compliance(radius: FloatArray) -> FloatArray:
        beta = load_angle(gear, np.asarray(radius, dtype=np.float64))
        across, along = np.cos(beta), np.sin(beta)
        work = arc.lateral[0, 0] * across**2 + 2.0 * arc.lateral[0, 1] * across * torque + arc.lateral[1, 1] * torque**2
        work = work - twist * torque**2 + arc.radial * along**2
        return np.asarray(work / (gear.youngs_modulus * gear.face_width), dtype=np.float64)

    return compliance


def _hold(gear: Gear) -> float:
    """Where the body is held, in root circle radii."""
    held = held_radius(gear)
    return SOLID_HOLD if held is None else held / gear.root_circle_radius
