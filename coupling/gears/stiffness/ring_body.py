r"""Gear body compliance by an exact elastic ring under the teeth, with the additional compliance of a rim on a web.

The body is the ring of :mod:`gearwhine.coupling.gears.stiffness.elastic_ring` between the root circle and the circle
where it is held, under teeth whose root arcs stay rigid.

The load of a tooth is carried to the root circle as a force ``cos(beta)`` across the tooth's axis, ``sin(beta)`` along
it, and the torque ``rb`` about the gear's centre. The gear body compliance follows from the flexibility L of the rigid
root arc under (across, torque / r_f) and R along,

    q = (f^T L f + R sin(beta)^2) / (E b),    f = (cos(beta), rb / r_f)

The ring is held at its bore.  A gear in one piece with its shaft (``bore = 0``) has no such place: its ring is held at
a third of the root circle, and the twist of the whole ring, which is the shaft's own, is left out.

A rim with a web of another width is two rings.  Its share is their compliance less that of one ring of the teeth's
width down to the same bore; finite elements of two widths agree within 4 % (tests/validation).  The model is plane: a
web off the middle of the face, and spokes, also tilt the rim, which is left out.  A rim alone (no web) is held at its
inside.

An internal gear is a ring that is held at its outside, with all its teeth as rigid arcs
(:mod:`gearwhine.coupling.gears.stiffness.toothed_ring`). Here it is clamped there, as a tooth feels it in its normal
section. What a yielding support adds moves the ring in its plane: `support_compliance`, of the transverse section.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from gearwhine.coupling.gears.errors import StiffnessModelError
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.profile import load_angle, root_half_angle, tooth_side
from gearwhine.coupling.gears.stiffness.beam import PlaneState, plane_modulus
from gearwhine.coupling.gears.stiffness.elastic_ring import (
    Annulus,
    neighbour_flexibility,
    root_flexibility,
    twist_flexibility,
)
from gearwhine.coupling.gears.stiffness.foundation import held_radius
from gearwhine.coupling.gears.stiffness.toothed_ring import RingSection, ring_flexibility
from gearwhine.numerics.arrays import FloatArray

_OUTLINE = 40
"""Points on each curve of an internal tooth's outline."""
SOLID_HOLD = 1.0 / 3.0
"""Radius at which a gear without a bore is held, in root circle radii; an internal one at its inverse."""

BodyCompliance = Callable[[FloatArray], FloatArray]
"""Function of the radii of loaded points [m] that gives the body's compliance along the line of action [m/N]."""
CrossCompliance = Callable[[FloatArray, FloatArray], FloatArray]
"""Function of the radii of two teeth's loaded points [m]: motion of one tooth by a unit load on the other [m/N]."""


def ring_compliance(gear: Gear, state: PlaneState = "plane-stress") -> BodyCompliance:
    """Compliance of a body of the teeth's full width, solved once for loads at any radius.

    Parameters
    ----------
    gear : Gear
    state : {"plane-stress", "plane-strain"}
    """
    if gear.is_internal:
        return _alone(work_of_loads(gear, ring_flexibility(ring_section(gear, state, supported=False)).own[0]))
    return _solved(gear, (Annulus(held_at(gear), 1.0, gear.face_width),), state, twists=held_radius(gear) is not None)


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
    rings = body_rings(gear)
    plain = (Annulus(held_at(gear), 1.0, gear.face_width),)
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
        Maps radii [m] of the loads on a tooth and on the next one in the sense of the loads (shapes that broadcast) to
        the compliance.
    """
    if gear.is_internal and twists:
        return work_of_loads(gear, ring_flexibility(ring_section(gear, state, supported=False)).beside[0])
    rings = body_rings(gear) if twists else solid_rings(gear)
    nu, kappa = gear.poisson_ratio, kolosov(gear, state)
    cross = neighbour_flexibility(rings, abs(root_half_angle(gear)), nu, kappa, abs(2.0 * math.pi / gear.teeth))
    if not (twists and held_radius(gear) is not None):
        cross = cross.copy()
        cross[1, 1] -= _whole_twist(rings, nu)
    return work_of_loads(gear, cross)


def work_of_loads(gear: Gear, flexibility: FloatArray) -> CrossCompliance:
    """Compliance [m/N] from the flexibility of two root arcs under `root_loads`, times E and width, (3, 3)."""

    def compliance(behind: FloatArray, ahead: FloatArray) -> FloatArray:
        work = np.einsum("i...,ij,j...->...", root_loads(gear, behind), flexibility, root_loads(gear, ahead))
        return np.asarray(work / (gear.youngs_modulus * gear.face_width), dtype=np.float64)

    return compliance


def root_loads(gear: Gear, radius: FloatArray) -> FloatArray:
    """Resultants on the root arc of unit loads at radii [m] on the flank: the loads of `neighbour_flexibility`.

    Returns
    -------
    ndarray, shape (3, ...)
        Force across the tooth's axis, torque about the gear's centre over the root radius, and force outward along the
        axis: a load presses an external tooth to the centre, an internal one outward.
    """
    beta = load_angle(gear, np.asarray(radius, dtype=np.float64))
    torque = gear.base_radius / gear.root_circle_radius
    return np.array([np.cos(beta), np.full(beta.shape, torque), -gear.sign * np.sin(beta)])


def _alone(compliance: CrossCompliance) -> BodyCompliance:
    return lambda radius: compliance(radius, radius)


class SupportCompliance(NamedTuple):
    """Compliance that the support of an internal gear's rim adds to a clamped one.

    Attributes
    ----------
    own, beside : callable
        Of a tooth, and between it and the next one in the sense of the loads, see `neighbour_compliance`.
    """

    own: BodyCompliance
    beside: CrossCompliance


def support_compliance(gear: Gear, state: PlaneState = "plane-stress", place: float | None = None) -> SupportCompliance:
    """Compliance that the support of an internal gear's rim adds to a clamped outside; zero for external gears.

    It is that of the transverse section, of helical teeth too: along the transverse line of action.

    Parameters
    ----------
    gear : Gear
    state : {"plane-stress", "plane-strain"}
    place : float or None
        Angle of the loaded tooth from a bolt or pin, in the sense of the load [rad]; None for the mean over all places.
    """
    if gear.ring_support is None or gear.ring_support.kind in ("clamped", "housing"):
        return SupportCompliance(
            lambda radius: np.zeros(np.shape(radius)),
            lambda behind, ahead: np.zeros(np.broadcast_shapes(np.shape(behind), np.shape(ahead))),
        )
    held, clamped = (ring_flexibility(ring_section(gear, state, supported=there)) for there in (True, False))
    bolts = gear.ring_support.count
    own, beside = (
        _at_place(matrices, place, bolts) - still[0]
        for matrices, still in ((held.own, clamped.own), (held.beside, clamped.beside))
    )
    return SupportCompliance(_alone(work_of_loads(gear, own)), work_of_loads(gear, beside))


def _at_place(matrices: FloatArray, place: float | None, bolts: int | None) -> FloatArray:
    """Mean over the places between two bolts, or the value at an angle from a bolt by the harmonics of their number."""
    if place is None or bolts is None:
        return np.asarray(matrices.mean(axis=0), dtype=np.float64)
    count = len(matrices)
    harmonics = np.fft.fft(matrices, axis=0) / count
    phases = np.exp(1j * bolts * place * np.fft.fftfreq(count, 1.0 / count))
    return np.asarray(np.tensordot(phases, harmonics, axes=1).real, dtype=np.float64)


def ring_section(gear: Gear, state: PlaneState, *, supported: bool = True) -> RingSection:
    """Ring of an internal gear with its support; clamped at its outside where the support is not counted."""
    width, outside = gear.face_width, held_at(gear)
    across, along = tooth_side(gear, _OUTLINE)
    outline = np.array([np.hypot(across, along) / abs(gear.root_circle_radius), np.arctan2(across, -along)]).T
    clamped = RingSection(
        abs(gear.teeth),
        abs(root_half_angle(gear)),
        outside,
        tuple((radius, angle) for radius, angle in outline.tolist()),
        gear.poisson_ratio,
        kolosov(gear, state),
    )
    support = gear.ring_support
    if support is None or not supported or support.kind in ("clamped", "housing"):
        return clamped
    stiffness = support.radial_stiffness, support.tangential_stiffness
    radial, tangential = (0.0 if each is None else gear.youngs_modulus * width / each for each in stiffness)
    if support.kind == "springs":
        around = 2.0 * math.pi * outside
        return replace(clamped, bed=(around * radial, around * tangential))
    assert support.count is not None
    assert support.seat_width is not None
    return replace(
        clamped,
        bolts=support.count,
        seat=0.5 * support.seat_width / (abs(gear.root_circle_radius) * outside),
        bolt=(radial, tangential),
        pinned=support.kind == "pins",
    )


def twist_compliance(gear: Gear, *, supported: bool = True) -> float:
    """Twist of a spur gear's body between the circle where it is held and the root circle [m/N].

    Along the line of action, by the torque of a unit load alone: ``rb^2 sum (1/a^2 - 1/b^2) / (4 pi G w)`` over the
    rings from a to b of width w. Zero for a gear in one piece with its shaft. Of an internal gear it is that of the
    ring with its teeth and, unless it is not counted, its support, in the transverse section.
    """
    if held_radius(gear) is None:
        return 0.0
    torque = gear.base_radius / gear.root_circle_radius
    if gear.is_internal:
        section = ring_section(gear, "plane-stress", supported=supported)
        return torque**2 * ring_flexibility(section).twist / (gear.youngs_modulus * gear.face_width)
    return torque**2 * _whole_twist(body_rings(gear), gear.poisson_ratio) / (gear.youngs_modulus * gear.face_width)


def _solved(gear: Gear, rings: tuple[Annulus, ...], state: PlaneState, twists: bool) -> BodyCompliance:
    """Work of a unit load on the root arc; `twists` keeps the twist of the whole body."""
    nu = gear.poisson_ratio
    arc = root_flexibility(rings, abs(root_half_angle(gear)), nu, kolosov(gear, state))
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


def kolosov(gear: Gear, state: PlaneState) -> float:
    """Kolosov's constant of a gear's material in a plane state."""
    plane_modulus(gear, state)  # refuses an unknown state
    nu = gear.poisson_ratio
    return (3.0 - nu) / (1.0 + nu) if state == "plane-stress" else 3.0 - 4.0 * nu


def body_rings(gear: Gear) -> tuple[Annulus, ...]:
    """Divide the gear body into annuli, from the radius where it is held to the root circle.

    An internal gear is clamped at its outside here; what its support yields is in
    `support_compliance`.

    Raises
    ------
    StiffnessModelError
        For a web that begins inside the bore's circle.
    """
    hub = held_at(gear)
    if gear.rim_inner_radius is None or gear.web_thickness is None:
        return (Annulus(hub, 1.0, gear.face_width),)
    inside = gear.rim_inner_radius / gear.root_circle_radius
    if inside <= hub:
        raise StiffnessModelError(
            f"gear {gear.name!r}: the inside of the rim ({gear.rim_inner_radius * 1e3:.4g} mm radius) must be outside "
            f"the circle where the body is held ({hub * gear.root_circle_radius * 1e3:.4g} mm); leave out the rim"
        )
    rim = Annulus(inside, 1.0, gear.face_width)
    if gear.hub_diameter is None:
        return Annulus(hub, inside, gear.web_thickness), rim
    around = 0.5 * gear.hub_diameter / gear.root_circle_radius
    boss = Annulus(hub, around, gear.hub_width or gear.face_width)
    return boss, Annulus(around, inside, gear.web_thickness), rim


def solid_rings(gear: Gear) -> tuple[Annulus, ...]:
    """Ring in place of a half plane: of the teeth's width, held far from the root circle."""
    return (Annulus(1.0 / SOLID_HOLD if gear.is_internal else SOLID_HOLD, 1.0, gear.face_width),)


def held_at(gear: Gear) -> float:
    """Radius at which the body is held, in root circle radii."""
    radius = held_radius(gear)
    return SOLID_HOLD if radius is None else radius / gear.root_circle_radius
