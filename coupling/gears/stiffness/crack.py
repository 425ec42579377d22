r"""Tooth root crack: its geometry, and the additional compliance of the cracked tooth.

The crack runs from the root circle on the loaded side into the tooth, straight, across the whole face. Material beyond
it carries no bending: above the crack the section that is left reaches from the sound flank to a line through the
crack's tip along the tooth's axis (Wu, Zuo and Parey, J. Sound Vib. 317, 2008, and many after them). Where that line
would not come out of the loaded flank, because the crack's tip is nearer to the axis than the tooth's corner, or beyond
the axis, it leans so as to end at that corner: a line along the axis would leave no section there to carry the load.
With the half thickness x at height y, that at the root x_r, at the tip x_a, and depth q at the angle a to the axis,

    t(y) = min(2 x, x + x_c + max(0, x_a - x_c) (y - y_r) / (y_a - y_r)),    x_c = x_r - q sin(a),

takes the place of 2 x in the bending, shear and compression of :mod:`gearwhine.coupling.gears.stiffness.beam`. The
flanks' contact and the body below are as in a sound tooth. The section is the normal one of helical teeth, as for sound
teeth (:mod:`gearwhine.coupling.gears.stiffness.normal_section`): depth and angle of the crack are measured in it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from gearwhine.coupling.gears.errors import GearError, require_finite
from gearwhine.coupling.gears.geometry.faults import check_flank, check_tooth_number
from gearwhine.coupling.gears.geometry.gear import Fault, Flank, Gear
from gearwhine.coupling.gears.geometry.profile import fillet_points, flank_points, load_angle
from gearwhine.coupling.gears.stiffness.beam import ROOT_CIRCLE, shear_modulus, tooth_sections
from gearwhine.coupling.gears.stiffness.normal_section import normal_section_gears, transverse_compliance
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, in_mm, refuse

_LEAST_LEFT = 0.1
"""Least part of any section that a crack may leave."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_PANELS = 24


@dataclass(frozen=True)
class ToothCrack(Fault):
    """A crack at the foot of one tooth.

    Parameters
    ----------
    tooth : int
        Number of the tooth from 0, in the order in which the teeth come into mesh.
    depth : float
        Length of the crack in the normal section [m].
    angle : float
        Angle between the crack and the tooth's axis [rad].
    flank : {"working", "back"}
        Loaded side from which it runs: that of the first pair of the gear, or the one behind it. Under a load on the
        other side the crack closes, and the tooth is as stiff as a sound one.
    """

    tooth: int
    depth: float
    angle: float = math.radians(70.0)
    flank: Flank = "working"

    def __post_init__(self) -> None:
        """Check the tooth number, the flank, the depth and the angle."""
        check_tooth_number("crack", self.tooth)
        check_flank("crack", self.flank)
        require_finite("crack depth", self.depth, minimum=0.0)
        if not 0.0 < self.angle <= math.pi / 2.0:
            raise GearError(f"crack angle must be above 0 and at most 90 degrees in rad, got {self.angle!r} rad")

    def findings(self, gear: Gear, attribute: str) -> Iterator[Finding]:
        """Yield a tooth that the gear does not have, and a depth that leaves too little of the tooth's foot.

        That is less than a tenth of any section, or with a warning less than half of the foot.

        What is left of half the foot bends under more than four times the stress: a section t has a modulus b t² / 6.
        """
        yield from super().findings(gear, attribute)
        for spur, _ in normal_section_gears(gear) if gear.helix_angle else ((gear, 1.0),):
            root = float(fillet_points(spur, np.array(ROOT_CIRCLE)).half_thickness)
            middle, deepest = (float(depth / math.sin(self.angle)) for depth in (root, root - _least_left(spur)))
            part, key = ("gear", gear.name), f"{attribute}.depth" if attribute else "depth of a crack"
            if self.depth > deepest:
                expected = f"at most {in_mm(deepest)} at this angle, or a missing tooth: it goes through the foot"
                yield Finding(part, key, self.depth, expected)
                return
            if self.depth > middle:
                expected = (
                    f"at most {in_mm(middle)}, half of the tooth's foot: what is left bears more than four times the "
                    "bending stress, and such a tooth breaks off soon (a missing tooth is a fault of its own)"
                )
                yield Finding(part, key, self.depth, expected, "warning")
                return

    def extra_compliance(self, gear: Gear, roll_angle: FloatArray) -> FloatArray:
        """Additional compliance of the tooth [m/N] for loads at roll angles [rad].

        Raises
        ------
        GearError
            For a crack that leaves less than a tenth of any section of the tooth.
        """
        refuse(self.findings(gear, ""), GearError)
        radius = gear.base_radius * np.sqrt(1.0 + np.asarray(roll_angle, dtype=np.float64) ** 2)
        return transverse_compliance(gear, lambda spur: partial(self._in_section, spur))(radius)

    def _in_section(self, gear: Gear, radius: FloatArray) -> FloatArray:
        """Additional compliance of the tooth of a spur gear [m/N] for loads at radii [m]."""
        low = fillet_points(gear, np.array(ROOT_CIRCLE))
        root = float(low.half_thickness)
        left = root - self.depth * math.sin(self.angle)
        beta = load_angle(gear, np.clip(radius, gear.form_radius, gear.tip_radius))[..., None]
        load = flank_points(gear, beta)
        sine, cosine = np.sin(beta), np.cos(beta)
        # The section has a corner where it meets the crack's line: panels keep the quadrature exact enough.
        edges = np.linspace(0.0, 1.0, _PANELS + 1)
        part = (0.5 * (edges[1:] + edges[:-1])[:, None] + 0.5 / _PANELS * _NODES).ravel()
        weight = np.tile(0.5 / _PANELS * _WEIGHTS, _PANELS)
        modulus, shear = gear.youngs_modulus * gear.face_width, shear_modulus(gear) * gear.face_width
        corner = flank_points(gear, load_angle(gear, np.array(gear.tip_radius)))
        lean = np.maximum(0.0, corner.half_thickness - left) / (corner.height - low.height)
        total = np.zeros(radius.shape)
        for points, climb in tooth_sections(gear, beta, ROOT_CIRCLE, part, weight):
            whole = 2.0 * points.half_thickness
            remaining = np.minimum(whole, points.half_thickness + left + lean * (points.height - low.height))
            moment = cosine * (load.height - points.height) - sine * load.half_thickness
            bending = 12.0 * moment**2 * (remaining**-3 - whole**-3) / modulus
            stretching = (1.2 * cosine**2 / shear + sine**2 / modulus) * (1.0 / remaining - 1.0 / whole)
            total = total + np.sum(climb * (bending + stretching), axis=-1)
        return np.asarray(total, dtype=np.float64)


def _least_left(gear: Gear) -> float:
    """Least x_c [m] with which every section keeps its least part p: ``x_c >= -((1 - 2 p) x + x_a v) / (1 - v)``.

    ``v`` runs from 0 at the root circle to 1 at the tooth's corner; that is ``t >= 2 p x`` with the leaning line.
    """
    low = fillet_points(gear, np.array(math.pi / 2.0))
    ends = load_angle(gear, np.array([gear.form_radius, gear.tip_radius]))
    corner = flank_points(gear, ends[1])
    half, height = (
        np.concatenate(
            [
                getattr(part, name)
                for part in (
                    fillet_points(gear, np.linspace(math.pi / 2.0, gear.fillet_end, 100)),
                    flank_points(gear, np.linspace(ends[0], ends[1], 100)[:-1]),
                )
            ]
        )
        for name in ("half_thickness", "height")
    )
    up = (height - low.height) / (corner.height - low.height)
    return float(np.max(-((1.0 - 2.0 * _LEAST_LEFT) * half + corner.half_thickness * up) / (1.0 - up)))
