"""Gear outlines: whole gears as polygons for drawing, alone and placed in mesh.

Placing a pair: at phase p the pair of teeth with number 0 touches at p base pitches along the path of contact.  Seen
from its gear's centre, a flank point of roll angle ``u`` is ``atan(u)`` beyond the tangent point of the line of action
and ``psi - inv(atan(u))`` from its tooth's axis, psi half the tooth's angle on the base circle; so the axis is
``u - psi`` beyond the tangent point.  The tangent points are at the working pressure angle w from the line of centres.
With that line at ``zeta`` from x, and the driver rotating in
the sense s = +1 (counter-clockwise) or -1, the axes of the two teeth stand at

    driver:  zeta + s (u_k - w - psi_k)          driven:  zeta + pi + s (u_i - w - psi_i).
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from coupling.gears.errors import GearError
from coupling.gears.geometry import Gear
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.profile import root_half_angle, tooth_side

FloatArray = npt.NDArray[np.float64]


def gear_outline(
    gear: Gear,
    rotation: float = 0.0,
    centre: tuple[float, float] = (0.0, 0.0),
    *,
    axial_position: float = 0.0,
    points: int = 30,
) -> FloatArray:
    """Outline of a whole gear: fillets, flanks, tips and root arcs of all teeth.

    Parameters
    ----------
    gear : Gear
    rotation : float
        Angle from x of the axis of tooth 0 [rad], in the plane z = 0.
    centre : tuple of float
        Where the gear's centre is [m].
    axial_position : float
        Which transverse plane of a helical gear [m]: a right-hand tooth rotates by ``tan(beta) z / r``.
    points : int
        Points on each fillet and each flank, at least 2.

    Returns
    -------
    ndarray, shape (n, 2)
        x and y of the corners of a closed polygon [m], counter-clockwise; the first point is not repeated.
    """
    if points < 2:
        raise GearError(f"gear {gear.name!r}: an outline needs at least 2 points on each curve, got {points!r}")
    tooth = _tooth_and_space(gear, points)
    twist = math.tan(gear.helix_angle) * axial_position / gear.pitch_radius
    angles = rotation + twist + 2.0 * math.pi * np.arange(gear.teeth) / gear.teeth
    rotated = tooth[None, :] * np.exp(1j * angles)[:, None]
    outline = rotated.ravel() + complex(*centre)
    return np.column_stack([outline.real, outline.imag])


def meshing_rotations(
    pair: GearPairGeometry, phase: float, *, centre_line_angle: float = 0.0, sense: int = 1
) -> tuple[float, float]:
    """Rotation angles of driver and driven gear at a phase, with their working flanks in contact.

    Parameters
    ----------
    pair : GearPairGeometry
    phase : float
        In mesh periods: where along the path of contact the teeth with number 0 touch [base pitches].
    centre_line_angle : float
        Angle from x of the line from the driver's centre to the driven's [rad].
    sense : int
        +1 where the driver turns counter-clockwise, -1 where clockwise.

    Returns
    -------
    tuple of float
        Angles from x of the axes of the two teeth with number 0 [rad].
    """
    if sense not in (1, -1):
        raise GearError(f"{pair.label}: sense must be +1 or -1, got {sense!r}")
    angle = pair.working_pressure_angle
    driver = float(pair.driver_roll_angle(phase)) - angle - pair.driver.base_half_angle
    driven = float(pair.driven_roll_angle(phase)) - angle - pair.driven.base_half_angle
    return centre_line_angle + sense * driver, centre_line_angle + math.pi + sense * driven


def pair_outlines(
    pair: GearPairGeometry, phase: float, *, centre_line_angle: float = 0.0, sense: int = 1, points: int = 30
) -> tuple[FloatArray, FloatArray]:
    """Outlines of driver and driven gear in mesh, the driver's centre at the origin.

    Parameters
    ----------
    pair, phase, centre_line_angle, sense
        As in `meshing_rotations`.
    points : int
        As in `gear_outline`.

    Returns
    -------
    tuple of ndarray, each of shape (n, 2)
        Closed polygons [m].
    """
    driver, driven = meshing_rotations(pair, phase, centre_line_angle=centre_line_angle, sense=sense)
    distance = pair.working_centre_distance
    other = (distance * math.cos(centre_line_angle), distance * math.sin(centre_line_angle))
    return (
        gear_outline(pair.driver, driver, points=points),
        gear_outline(pair.driven, driven, other, points=points),
    )


def _tooth_and_space(gear: Gear, points: int) -> npt.NDArray[np.complex128]:
    """The outline from the root of the tooth on the x axis to the root of the next one, in complex coordinates."""
    across, along = tooth_side(gear, points)
    side = along + 1j * across
    arc = np.linspace(-1.0, 1.0, max(3, points // 4))[1:-1]
    tip = gear.tip_radius * np.exp(1j * gear.tip_half_angle * arc)
    middle = math.pi / gear.teeth
    space = gear.root_circle_radius * np.exp(1j * (middle + (middle - root_half_angle(gear)) * arc))
    return np.concatenate([side.conj(), tip, side[::-1], space])
