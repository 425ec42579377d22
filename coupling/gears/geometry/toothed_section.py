"""Section of a gear with its teeth, in one piece with its shaft, as round shafts that bend and twist alike.

**Bending and tension.** The section has the second moment of area I of its outline, near that of the reference circle.
Helical teeth lie at the angle β to the axis. As the shaft stretches by ε and contracts by ν ε, a tooth, whose sides are
free, stretches by ``ε (cos²β − ν sin²β)`` along itself, and its force is ``cos²β`` of that of a straight tooth along
the axis:

    I = I_root + cos²β (cos²β − ν sin²β) (I_outline − I_root).

Finite elements of solid pinions, `studies/helical_pinion.py`, agree within 2 % up to 30°.

The stress of the teeth builds up from the ends of the face, so that some length of it is without them,
`ToothedSection.end_length`.

**Torsion.** In Saint-Venant's torsion the teeth are nearly without stress. The section is as stiff as a circle a third
of a transverse module outside the root circle: 0.33 modules for 18 teeth, 0.35 for 60, whatever the helix angle.

**A body wider than its shaft.** The stress of a shaft of diameter d spreads into a body of diameter D and width b. This
adds a length e to the bare shaft at each end of the body (the equivalent length of a shoulder; Nestorides, A Handbook
on Torsional Vibration, 1958):

    e = α g d (1 − exp(−b / (2 α g d))),    g = 1 − (d/D)³,

α = 0.243 in bending and 0.158 in torsion, by finite elements of bodies of revolution with sharp corners. The compliance
of the body is theirs within 3 % of that of the bare shaft over its width, within 8 % where it is thinner than half a
shaft diameter. A thin disc hardly stiffens its shaft.
"""

import math
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.profile import gear_outline

_POINTS = 6  # number of outline points on each fillet and each flank
_TORSION_DEPTH = 0.335  # transverse modules, by finite elements of sections
_SPREAD_BENDING, _SPREAD_TORSION = 0.243, 0.158  # shaft diameters, by finite elements at ν = 0.3
_END_LENGTH = 1.9  # modules, by finite elements of solid pinions of 20 teeth, faces of 10 and 20 modules; 2.3 of 40


@dataclass(frozen=True)
class ToothedSection:
    """Round shafts that are as stiff as a gear with its teeth.

    Attributes
    ----------
    bending_diameter : float
        Diameter of the shaft equivalent in bending, shear and tension [m].
    torsion_diameter : float
        [m]
    end_length : float
        Length at each end of the face in which the shaft has its root circle alone [m].
    """

    bending_diameter: float
    torsion_diameter: float
    end_length: float


def toothed_section(gear: Gear) -> ToothedSection:
    """Round shafts as stiff as a gear in one piece with its shaft.

    Parameters
    ----------
    gear : Gear
        A gear of one body, without a rim on a web.
    """
    root = gear.root_circle_radius
    of_root = math.pi / 4.0 * root**4
    x, y = gear_outline(gear, points=_POINTS).T
    x_next, y_next = np.roll(x, -1), np.roll(y, -1)
    # Second moment of a polygon about x; three teeth or more have the same about every axis.
    outline = float(((x * y_next - x_next * y) * (y**2 + y * y_next + y_next**2)).sum()) / 12.0
    along, across = math.cos(gear.helix_angle) ** 2, math.sin(gear.helix_angle) ** 2
    second = of_root + along * (along - gear.poisson_ratio * across) * (outline - of_root)
    return ToothedSection(
        bending_diameter=2.0 * (4.0 / math.pi * second) ** 0.25,
        torsion_diameter=2.0 * (root + _TORSION_DEPTH * gear.transverse_module),
        end_length=_END_LENGTH * gear.module,
    )


def bare_lengths(shaft_diameter: float, body_diameter: float, width: float) -> tuple[float, float]:
    """Lengths at one end of a body over which its shaft, in one piece with it, is as soft as without the body.

    Parameters
    ----------
    shaft_diameter, body_diameter : float
        [m]
    width : float
        Width of the body along the shaft [m].

    Returns
    -------
    tuple of float
        Lengths in bending and in torsion [m], at most half of the width; 0 where the body is not wider than the shaft.
    """
    step = max(1.0 - (shaft_diameter / body_diameter) ** 3, 0.0) * shaft_diameter
    lengths = []
    for spread in (_SPREAD_BENDING * step, _SPREAD_TORSION * step):
        lengths.append(-spread * math.expm1(-0.5 * width / spread) if spread > 0.0 else 0.0)
    return lengths[0], lengths[1]
