"""Plane finite elements of internal gears: whole rings, clamped outside, on springs or on bolts, a tooth loaded.

The outline is written here from the involute alone, with radii as lengths: at radius r a tooth has the half angle

    psi(r) = s / d + inv(alpha_r) - inv(alpha),     s = m (pi/2 + 2 x tan(alpha)),   cos(alpha_r) = rb / r,

and the fillet is the arc that touches the flank and the root circle. The flank's normal at r leans by
``beta = alpha_r + psi(r)`` from the direction across the tooth, towards the root, and crosses the tooth's axis ``rb /
cos(beta)`` from the centre.
"""

import math
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

import numpy as np
import skfem
from plane_gears import (
    POINTS,
    STRIP,
    Deflections,
    HeldBody,
    curved_mesh,
    elasticity,
    held_body,
    loaded_flank,
    refine,
)

from gearwhine.coupling.gears.stiffness.beam import PlaneState
from gearwhine.meshes.gmsh_meshing import gmsh_session

OUTSIDE_FACETS = 720
"""Elements on the outside of the ring, from the x axis: the ends of bolts' seats lie on half degrees."""


@dataclass(frozen=True)
class Ring:
    """A ring with internal teeth: lengths [m], all positive."""

    teeth: int
    module: float
    rim: float
    """From the root circle to the outside."""
    fillet: float
    face_width: float
    shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    pressure_angle: float = math.radians(20.0)
    youngs_modulus: float = 206e9
    poisson_ratio: float = 0.3

    @property
    def reference(self) -> float:
        return 0.5 * self.module * self.teeth

    @property
    def base(self) -> float:
        return self.reference * math.cos(self.pressure_angle)

    @property
    def tip(self) -> float:
        return self.reference - (self.addendum + self.shift) * self.module

    @property
    def root(self) -> float:
        return self.reference + (self.dedendum - self.shift) * self.module

    @property
    def outside(self) -> float:
        return self.root + self.rim

    @property
    def form(self) -> float:
        """Radius at which the fillet leaves the flank."""
        along = self.fillet + math.sqrt((self.root - self.fillet) ** 2 - self.base**2)
        return math.hypot(self.base, along)

    def half_angle(self, radius: Any) -> np.ndarray:
        roll = np.sqrt(np.maximum((np.asarray(radius) / self.base) ** 2 - 1.0, 0.0))
        at_reference = (math.pi / 2.0 + 2.0 * self.shift * math.tan(self.pressure_angle)) / self.teeth
        involute = math.tan(self.pressure_angle) - self.pressure_angle
        return at_reference + roll - np.arctan(roll) - involute

    def lean(self, radius: Any) -> np.ndarray:
        return np.arccos(self.base / np.asarray(radius)) + self.half_angle(radius)

    def side(self) -> tuple[np.ndarray, np.ndarray]:
        """Flank from tip to form circle, and fillet from there to the root, at x > 0 of a tooth on the y axis."""
        radius = np.linspace(self.tip, self.form, POINTS)
        flank = radius[:, None] * np.array([np.sin(self.half_angle(radius)), np.cos(self.half_angle(radius))]).T
        lean = float(self.lean(self.form))
        centre = flank[-1] - self.fillet * np.array([-math.cos(lean), math.sin(lean)])
        # From the flank's normal into the tooth to the radial direction.
        start, end = math.pi - lean, math.atan2(centre[1], centre[0])
        turn = np.linspace(start, end, POINTS)
        return flank, centre + self.fillet * np.array([np.cos(turn), np.sin(turn)]).T


@dataclass(frozen=True)
class Held:
    """How the outside of a ring is held: all of it clamped where there is neither `springs` nor `bolts`."""

    bolts: int = 0
    """Seats at equal angles that are clamped."""
    first: float = 0.0
    """Angle from the loaded tooth to the first bolt in the sense of the load [degrees]."""
    seat: float = 6.0
    """Angle of each seat [degrees]."""
    springs: float = 0.0
    """Stiffness per area in both directions [N/m^3]."""


@cache
def ring_mesh(ring: Ring, fineness: float) -> skfem.MeshTri2:
    """The whole ring; tooth 0 stands on the y axis and is loaded on its flank at x > 0."""
    flank, fillet = ring.side()
    mirror = np.array([-1.0, 1.0])
    with gmsh_session("a ring") as gmsh:
        occ = gmsh.model.occ
        centre = occ.addPoint(0.0, 0.0, 0.0)

        def spline(points: np.ndarray, first: int, last: int) -> int:
            return occ.addSpline([first, *(occ.addPoint(x, y, 0.0) for x, y in points[1:-1]), last])

        curves, tagged, feet = [], [], []
        for tooth in range(ring.teeth):
            angle = -2.0 * math.pi * tooth / ring.teeth  # clockwise: left side from the root to the tip, then down
            turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
            left = [(piece * mirror)[::-1] @ turn for piece in (fillet, flank)]
            right = [piece @ turn for piece in (flank, fillet)]
            pieces = [*left, *right]
            ends = [occ.addPoint(*left[0][0], 0.0), occ.addPoint(*left[1][0], 0.0), occ.addPoint(*left[1][-1], 0.0)]
            ends += [occ.addPoint(*right[0][0], 0.0), occ.addPoint(*right[1][0], 0.0)]
            ends.append(occ.addPoint(*right[1][-1], 0.0))
            if feet:
                curves.append(occ.addCircleArc(feet[-1], centre, ends[0]))
            feet += [ends[0], ends[-1]]
            around = [
                spline(pieces[0], ends[0], ends[1]),
                spline(pieces[1], ends[1], ends[2]),
                occ.addCircleArc(ends[2], centre, ends[3]),
                spline(pieces[2], ends[3], ends[4]),
                spline(pieces[3], ends[4], ends[5]),
            ]
            curves += around
            tagged = tagged or around
        curves.append(occ.addCircleArc(feet[-1], centre, feet[0]))
        outside = occ.addCircle(0.0, 0.0, 0.0, ring.outside)
        surface = occ.addPlaneSurface([occ.addCurveLoop([outside]), occ.addCurveLoop(curves)])
        occ.synchronize()
        gmsh.model.mesh.setTransfiniteCurve(outside, OUTSIDE_FACETS + 1)
        refine(gmsh, ring.module, fineness, flank=[tagged[3]], tooth=[tagged[0], tagged[1], tagged[3], tagged[4]])
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(2)
        return curved_mesh(gmsh, surface)


@lru_cache(maxsize=4)
def free_ring(ring: Ring, fineness: float, state: PlaneState) -> tuple[skfem.Basis, Any]:
    """Displacements of a ring that nothing holds, and its stiffness."""
    basis = skfem.Basis(ring_mesh(ring, fineness), skfem.ElementVector(skfem.ElementTriP2()), intorder=4)
    return basis, elasticity(basis, ring, state)


@lru_cache(maxsize=12)
def held_ring(ring: Ring, held: Held, fineness: float, state: PlaneState) -> HeldBody:
    """A ring held at its outside."""
    basis, matrix = free_ring(ring, fineness, state)
    mesh = basis.mesh
    outside = mesh.facets_satisfying(lambda x: np.hypot(x[0], x[1]) > ring.root + 0.9 * ring.rim, boundaries_only=True)
    if held.springs:

        @skfem.BilinearForm
        def bed(u: Any, v: Any, w: Any) -> Any:
            return held.springs * (u[0] * v[0] + u[1] * v[1])

        matrix = matrix + bed.assemble(skfem.FacetBasis(mesh, basis.elem, facets=outside, intorder=4))
        return held_body(basis, matrix, np.zeros(0, dtype=int))
    if held.bolts:
        x, y = mesh.p[:, mesh.facets[:, outside]].mean(axis=1)
        # Counter-clockwise from the tooth, modulo the bolts' pitch.
        pitch = 360.0 / held.bolts
        away = (np.degrees(np.arctan2(y, x)) - 90.0 - held.first + 0.5 * pitch) % pitch - 0.5 * pitch
        outside = outside[np.abs(away) < 0.5 * held.seat]
    return held_body(basis, matrix, outside)


def ring_deflections(
    ring: Ring, radii: np.ndarray, held: Held = Held(), fineness: float = 2.0, state: PlaneState = "plane-stress"
) -> Deflections:
    """Motion of the tooth's axis and mean sinking of the loaded strip under unit loads at `radii` (lengths)."""

    def along_flank(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Arc of the involute from the base circle, and distance from the loaded flank."""
        radius = np.hypot(x[0], x[1])
        off = radius * np.abs(np.arctan2(x[0], x[1]) - ring.half_angle(radius))
        arc = 0.5 * ring.base * ((radius / ring.base) ** 2 - 1.0)
        return arc, np.where(radius < ring.form, off, np.inf)

    lean = ring.lean(radii)
    return loaded_flank(
        held_ring(ring, held, fineness, state),
        along_flank,
        places=0.5 * ring.base * ((radii / ring.base) ** 2 - 1.0),
        directions=np.array([-np.cos(lean), np.sin(lean)]).T,
        heights=ring.base / np.cos(lean),
        pitch=2.0 * math.pi / ring.teeth,
        module=ring.module,
        width=ring.face_width,
    )


def loaded_radii(ring: Ring, count: int) -> np.ndarray:
    """From two strips beyond the tip to a quarter of a module from the form circle, as far as pinions' tips reach."""
    return np.linspace(ring.tip + 2.0 * STRIP * ring.module, ring.form - 0.25 * ring.module, count)
