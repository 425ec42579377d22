"""Gear bodies between shaft and rim: stiffness, inertia, and which motions of the rims are coordinates.

What a gear's body yields as a whole is strained near its bore, while most of its inertia is near the rim: it lies
between the shaft and the teeth with their inertia, and not between the teeth of two gears. In motion the rotation of
the rim against the hub, and its shift across the shaft, are coordinates of the shaft's component
(:func:`gearwhine.coupling.machine.components.rotor_component`), and the law of the contact loses that part of the
compliance which pairs of teeth share. Springs in series have the same deflection in either place, so the static
equilibrium of one pair of gears is that of the complete contact law.

A gear that several pairs share has one rim, which all of them move: an idler passes its torque on without a twist, and
paths that part at a gear feel its twist alike. Its springs are the stiffest that one of its pairs has by the width of
the common face, and what is left stays in the others' contact laws. The static machine has such rims, too
(:func:`gearwhine.coupling.statics.operating_point_search.solve_operating_point`).

The spring stays in the contact law where a body has no inertia of its own at its place, so that there is nothing beside
the shaft that it could move. Of a gear in one pair it stays there also where the rim on a hub at rest vibrates far
above the frequencies of the shaft's modes: it responds statically in any place then. The frequency f of a mesh mode
errs by about half of (f / f_rim)² of itself.

*Out of the plane* a wheel with a web has modes on its hub (:mod:`gearwhine.coupling.gears.stiffness.wheel_modes`): the
umbrella, tilt and others with nodal diameters. Those below `KEPT_BELOW` times the limit of the shaft's modes are kept;
in the others the body is rigid, as a disc without a web is. The static machine has them, too: helical teeth tilt a
thin wheel. The umbrella joins the motion of the shaft along its axis and one nodal diameter its tilt in both planes,
with their coupling inertia and gyroscopic moment, as rims do. A mode with more nodal diameters is a cosine and a sine
in directions at rest. Its shape rotates with the body, so the rates in the body are D q = q' + n Ω J q, with
J = [0, 1; -1, 0], and with g of :mod:`gearwhine.coupling.gears.stiffness.wheel_modes`, the part c = n - g of the
Coriolis force, and the damping ζ of its material,

    q'' + 2 ζ ω q' + ω² q + 2 Ω g J q' + (n² - 2 n g) Ω² q + 2 ζ ω n Ω J q = f.

Without Coriolis force g = n: an observer at rest sees a standing wave of the body as two, at ω ± n Ω. Of one nodal
diameter the term of Ω² is left out: what the centrifugal force does to a rim that tilts rigidly cancels it.

Laws of contact count, under loads that vary over the face, the tilt of a body of the full face width
(:mod:`gearwhine.coupling.gears.stiffness.body_over_face`), beside that of the web here: about (web / face)³ of it
twice.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, pi, sqrt

import numpy as np

from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.stiffness.rim_on_hub import RimShares
from gearwhine.coupling.gears.stiffness.wheel_modes import PlateMode, wheel_modes, wheel_section
from gearwhine.numerics.arrays import FloatArray

STATIC_BEYOND = 10.0
"""Frequency of the rim on a hub at rest, over the limit of the shaft's modes, above which its spring is static."""

KEPT_BELOW = 2.0
"""Frequency out of the plane on a hub at rest, over the limit of the shaft's modes, below which a motion is kept."""


@dataclass(frozen=True)
class RimSpring:
    """A motion of a rim on its hub: rotation about the shaft, or shift across it.

    Attributes
    ----------
    stiffness : float
        [N m] of a rotation, [N/m] of a shift.
    coupling_inertia : float
        S [kg m²] or [kg], see :mod:`gearwhine.coupling.gears.stiffness.rim_on_hub`.
    rim_inertia : float
        J_r [kg m²] or M_r [kg].
    """

    stiffness: float
    coupling_inertia: float
    rim_inertia: float

    @property
    def frequency_hz(self) -> float:
        """Natural frequency of the rim on a hub at rest [Hz]."""
        return sqrt(self.stiffness / self.rim_inertia) / (2.0 * pi)


@dataclass(frozen=True)
class GearBody:
    """The body of a gear between its hub, which moves with the shaft, and its rim.

    Attributes
    ----------
    gear : str
        Name of the gear.
    at : float
        Station of the hub, from the left end of the shaft [m].
    twist, shift : RimSpring or None
        Rotation about the shaft, and shift along any direction across it; None where it is static.
    plates : tuple of PlateMode
        Modes out of the plane on a hub at rest that are kept.
    limit : float
        Frequency below which these vibrate, and above which they respond statically [rad/s].
    """

    gear: str
    at: float
    twist: RimSpring | None
    shift: RimSpring | None
    plates: tuple[PlateMode, ...] = ()
    limit: float = 0.0

    def plates_with(self, nodal_diameters: int) -> list[PlateMode]:
        """Modes with a number of nodal diameters."""
        return [mode for mode in self.plates if mode.nodal_diameters == nodal_diameters]

    def compliance(self, base_radius: float) -> float:
        """Motion of the teeth by that of the rim on the hub, along the line of action [m/N]."""
        twist = 0.0 if self.twist is None else base_radius**2 / self.twist.stiffness
        return twist + (0.0 if self.shift is None else 1.0 / self.shift.stiffness)


def rim_spring(stiffness: float, inertia: float, shares: RimShares, frequency_limit: float) -> RimSpring | None:
    """Make the spring of a rim; None where it is static.

    Parameters
    ----------
    stiffness : float
        Stiffness between hub and rim [N m] or [N/m]; infinite for a rim that does not move.
    inertia : float
        Polar inertia [kg m²] or mass [kg] of the body beside those of the shaft, distributed as by its geometry.
    shares : RimShares
    frequency_limit : float
        Limit of the shaft's modes [rad/s]; infinite to have the rim as a coordinate at any frequency.
    """
    if inertia <= 0.0 or stiffness == inf or stiffness >= (STATIC_BEYOND * frequency_limit) ** 2 * shares.rim * inertia:
        return None
    return RimSpring(stiffness, shares.coupling * inertia, shares.rim * inertia)


def stiffest(compliances: Sequence[float]) -> float:
    """Stiffness of the stiffest of some springs by their compliances; infinite where one is zero, or without any."""
    return inf if min(compliances, default=0.0) <= 0.0 else 1.0 / min(compliances)


@dataclass(frozen=True)
class BodyOutOfPlane:
    """Modes of a gear's body out of the plane, on its hub at rest.

    Attributes
    ----------
    modes : tuple of PlateMode
        The first one with up to three nodal diameters, and all that are kept.
    below : float
        Frequency below which they are kept [rad/s].
    """

    modes: tuple[PlateMode, ...]
    below: float

    @property
    def kept(self) -> tuple[PlateMode, ...]:
        """Modes that the machine follows; in the others the body is rigid."""
        return tuple(mode for mode in self.modes if mode.frequency < self.below)


def body_out_of_plane(gear: Gear, inertia: tuple[float, float, float], limit: float) -> BodyOutOfPlane | None:
    """Modes of a gear's body out of the plane; None of a gear without a web on a hub, or without inertia.

    Parameters
    ----------
    gear : Gear
    inertia : tuple of float
        Mass [kg], polar and diametral inertia [kg m²] beside those of the shaft, distributed as by the geometry.
    limit : float
        Limit of the shaft's modes [rad/s].
    """
    section = wheel_section(gear)
    if gear.web_thickness is None or section is None or min(inertia) <= 0.0:
        return None
    below = KEPT_BELOW * limit
    ratio = inertia[0] / gear.mass
    found = wheel_modes(section, below * sqrt(ratio))
    tilting = inertia[2] / found.diametral_inertia
    modes = (mode.scaled(tilting if mode.nodal_diameters == 1 else ratio) for mode in found.modes)
    return BodyOutOfPlane(tuple(modes), below)


def transport(mode: PlateMode, damping_ratio: float, speed: float, frame: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """Stiffness and damping by the rotation of a mode with nodal diameters, over its cosine and sine, (2, 2) each.

    Parameters
    ----------
    mode : PlateMode
    damping_ratio : float
    speed : float
        Ω [rad/s].
    frame : float
        Speed f of the frame of the coordinates [rad/s], which turns these forces of the velocity: f C n J, J the
        quarter turn, joins the stiffness.
    """
    n, g = mode.nodal_diameters, mode.rotation
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    circulating = 2.0 * damping_ratio * mode.frequency * n * speed * turn
    damping = 2.0 * speed * g * turn
    return (n**2 - 2.0 * n * g) * speed**2 * np.eye(2) + circulating - n * frame * damping @ turn, damping
