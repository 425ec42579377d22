"""Gear bodies between shaft and rim: stiffness, inertia, and which motions of the rims are coordinates.

What a gear's body yields as a whole is strained near its bore, while most of its inertia is near the rim: it lies
between the shaft and the teeth with their inertia, and not between the teeth of two gears. In motion the rotation of
the rim against the hub, and its shift across the shaft, are coordinates of the shaft's component
(:func:`coupling.machine.components.rotor_component`), and the law of the contact loses that part of the compliance
which pairs of teeth share. Springs in series have the same deflection in either place, so the static equilibrium of one
pair of gears is that of the complete contact law.

A gear that several pairs share has one rim, which all of them move: an idler passes its torque on without a twist, and
paths that part at a gear feel its twist alike. Its springs are the stiffest that one of its pairs has by the width of
the common face, and what is left stays in the others' contact laws. The static machine has such rims, too
(:func:`coupling.statics.operating_point_search.solve_operating_point`).

The spring stays in the contact law where a body has no inertia of its own at its place, so that there is nothing beside
the shaft that it could move. Of a gear in one pair it stays there also where the rim on a hub at rest vibrates far
above the frequencies of the shaft's modes: it responds statically in any place then. The frequency f of a mesh mode
errs by about half of (f / f_rim)² of itself.

*Out of the plane* the rim of a wheel with a web moves along the axis (umbrella) and tilts, and has modes with two and
three nodal diameters (:mod:`coupling.gears.stiffness.wheel_modes`). Those whose frequency on a hub at rest is below
`KEPT_BELOW` times the limit of the shaft's modes are kept; above, and of a disc without a web, the body is rigid in
them. Axial motion and tilt are springs of the rim as the rotation and the shift are, and the static machine has them
too: helical teeth tilt a thin wheel. A mode with nodal diameters is a cosine and a sine in directions at rest. Its
shape rotates with the body, so the rates in the body are D q = q' + n Ω J q, J = [0, 1; -1, 0], and with g of
:mod:`coupling.gears.stiffness.wheel_modes`, the part c = n - g of the Coriolis force, and the damping ζ of its
material,

    q'' + 2 ζ ω q' + ω² q + 2 Ω g J q' + (n² - 2 n g) Ω² q + 2 ζ ω n Ω J q = f.

Without Coriolis force g = n: an observer at rest sees a standing wave of the body as two, at ω ± n Ω.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, pi, sqrt

import numpy as np
import numpy.typing as npt

from coupling.gears import Gear
from coupling.gears.stiffness.rim_on_hub import RimShares
from coupling.gears.stiffness.wheel_modes import PlateMode, RimMotion, WheelModes, wheel_modes, wheel_section

FloatArray = npt.NDArray[np.float64]

STATIC_BEYOND = 10.0
"""Frequency of the rim on a hub at rest, over the limit of the shaft's modes, above which its spring is static."""

KEPT_BELOW = 2.0
"""Frequency out of the plane on a hub at rest, over the limit of the shaft's modes, below which a motion is kept."""


@dataclass(frozen=True)
class RimSpring:
    """A motion of a rim on its hub: rotation about the shaft, shift across it, motion along it, or tilt.

    Attributes
    ----------
    stiffness : float
        [N m] of a rotation or a tilt, [N/m] of a shift.
    coupling_inertia : float
        S [kg m²] or [kg], see :mod:`coupling.gears.stiffness.rim_on_hub`.
    rim_inertia : float
        J_r [kg m²] or M_r [kg].
    coupling_spin, rim_spin : float
        The same of the gyroscopic moment of a tilt [kg m²].
    """

    stiffness: float
    coupling_inertia: float
    rim_inertia: float
    coupling_spin: float = 0.0
    rim_spin: float = 0.0

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
    axial, tilt : RimSpring or None
        Motion along the shaft, and tilt about any direction across it; None where the body is rigid in it.
    plates : tuple of PlateMode
        Modes with two nodal diameters or more, on a hub at rest.
    limit : float
        Frequency below which motions out of the plane vibrate, and above which they respond statically [rad/s].
    """

    gear: str
    at: float
    twist: RimSpring | None
    shift: RimSpring | None
    axial: RimSpring | None = None
    tilt: RimSpring | None = None
    plates: tuple[PlateMode, ...] = ()
    limit: float = 0.0

    @property
    def out_of_plane(self) -> "GearBody | None":
        """The body with its motions out of the plane alone; None without any."""
        if self.axial is None and self.tilt is None and not self.plates:
            return None
        return replace(self, twist=None, shift=None)

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
class BodyMotion:
    """A motion of a gear's body out of the plane, on its hub at rest.

    Attributes
    ----------
    name : str
        ``umbrella``, ``1 nodal diameter``, ``2 nodal diameters``, ...
    frequency : float
        Natural frequency [rad/s].
    kept : bool
        Whether the machine follows it; else the body is rigid in it.
    """

    name: str
    frequency: float
    kept: bool


@dataclass(frozen=True)
class BodyOutOfPlane:
    """Motions of a gear's body out of the plane, by its inertia on the shaft.

    Attributes
    ----------
    modes : WheelModes
    inertia : tuple of float
        Mass [kg], polar and diametral inertia [kg m²] beside those of the shaft.
    mass_ratio : float
        Mass over that of the body's geometry.
    limit : float
        Limit of the shaft's modes [rad/s].
    flexible : bool
        Whether the body has a web.
    """

    modes: WheelModes
    inertia: tuple[float, float, float]
    mass_ratio: float
    limit: float
    flexible: bool

    def _keeps(self, frequency: float) -> bool:
        return self.flexible and frequency < KEPT_BELOW * self.limit * sqrt(self.mass_ratio)

    @property
    def motions(self) -> tuple[BodyMotion, ...]:
        """All motions, by their nodal diameters."""
        frequencies = [self.modes.axial.frequency, self.modes.tilt.frequency]
        frequencies += [mode.frequency for mode in self.modes.plates]
        names = ["umbrella", *(f"{n} nodal diameter{'s' * (n > 1)}" for n in range(1, len(frequencies)))]
        return tuple(
            BodyMotion(name, frequency / sqrt(self.mass_ratio), self._keeps(frequency))
            for name, frequency in zip(names, frequencies, strict=True)
        )

    @property
    def axial(self) -> RimSpring | None:
        """Spring of the rim's motion along the axis, where it is kept."""
        return self._spring(self.modes.axial, self.inertia[0], 0.0)

    @property
    def tilt(self) -> RimSpring | None:
        """Spring of the rim's tilt, where it is kept."""
        return self._spring(self.modes.tilt, self.inertia[2], self.inertia[1])

    @property
    def plates(self) -> tuple[PlateMode, ...]:
        """Modes with two nodal diameters or more that are kept."""
        return tuple(mode.scaled(self.mass_ratio) for mode in self.modes.plates if self._keeps(mode.frequency))

    def _spring(self, motion: RimMotion, inertia: float, polar: float) -> RimSpring | None:
        if inertia <= 0.0 or not self._keeps(motion.frequency):
            return None
        inertias = motion.coupling * inertia, motion.rim * inertia
        return RimSpring(motion.stiffness, *inertias, motion.coupling_spin * polar, motion.rim_spin * polar)


def body_out_of_plane(gear: Gear, inertia: tuple[float, float, float], limit: float) -> BodyOutOfPlane | None:
    """Motions of a gear's body out of the plane; None of a gear without inertia, or in one piece with its shaft.

    Parameters
    ----------
    gear : Gear
    inertia : tuple of float
        Mass [kg], polar and diametral inertia [kg m²] beside those of the shaft, distributed as by the geometry.
    limit : float
        Limit of the shaft's modes [rad/s].
    """
    section = wheel_section(gear)
    if section is None or min(inertia) <= 0.0:
        return None
    return BodyOutOfPlane(
        wheel_modes(section), inertia, inertia[0] / gear.mass, limit, flexible=gear.web_thickness is not None
    )


def transport(mode: PlateMode, damping_ratio: float, speed: float) -> tuple[FloatArray, FloatArray]:
    """Stiffness and damping by the rotation of a mode with nodal diameters, over its cosine and sine, (2, 2) each.

    Parameters
    ----------
    mode : PlateMode
    damping_ratio : float
    speed : float
        Ω [rad/s].
    """
    n, g = mode.nodal_diameters, mode.rotation
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    circulating = 2.0 * damping_ratio * mode.frequency * n * speed * turn
    return (n**2 - 2.0 * n * g) * speed**2 * np.eye(2) + circulating, 2.0 * speed * g * turn
