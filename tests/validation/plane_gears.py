"""Plane finite elements of gears: whole gears held at their bores, teeth loaded on their flanks.

Quadratic triangles with curved edges, finest along the loaded flank and its fillets. The load is Hertz's pressure over
a strip, in the direction of the line of action; the motion of a tooth is read where that line crosses its axis.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any, NamedTuple

import numpy as np
import skfem
from scipy.sparse.linalg import SuperLU, splu
from skfem.helpers import ddot, div, sym_grad, trace

from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.geometry.profile import load_angle, tooth_outline
from gearwhine.coupling.gears.stiffness.beam import PlaneState
from gearwhine.meshes.gmsh_meshing import gmsh_session

STRIP = 0.05
"""Half width of the loaded strip, in modules."""
POINTS = 25
"""Of the outline, on each fillet and each flank."""


@dataclass(frozen=True)
class Deflections:
    """Per unit load along the line of action [m/N], at each radius."""

    axis: np.ndarray
    surface: np.ndarray
    dofs: int
    next_axis: np.ndarray
    """Of the next tooth's axis in the sense of the load, (loads, places)."""


def loaded_radii(gear: Gear, count: int = 7) -> np.ndarray:
    """From the start of the active profile (of the gear with its like) to two strips below the tip [m]."""
    start = float(GearPairGeometry(gear, gear).driver_radius(0.0))
    return np.linspace(start, gear.tip_radius - 2.0 * STRIP * gear.module, count)


@cache
def gear_mesh(gear: Gear, fineness: float) -> skfem.MeshTri2:
    """The whole gear; tooth 0 stands along +y and is loaded on its flank at x > 0."""
    side = tooth_outline(gear, POINTS)[: 2 * POINTS - 1] * np.array([-1.0, 1.0])  # right, root to tip
    with gmsh_session("a gear") as gmsh:
        occ = gmsh.model.occ
        centre = occ.addPoint(0.0, 0.0, 0.0)

        def spline(points: np.ndarray, first: int, last: int) -> int:
            return occ.addSpline([first, *(occ.addPoint(x, y, 0.0) for x, y in points[1:-1]), last])

        curves, tagged, feet = [], [], []
        for tooth in range(gear.teeth):
            angle = -2.0 * math.pi * tooth / gear.teeth  # clockwise: left side up, right side down
            turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
            left, right = (side * np.array([-1.0, 1.0])) @ turn, side[::-1] @ turn
            ends = [occ.addPoint(*point, 0.0) for point in (left[0], left[POINTS - 1], left[-1])]
            ends += [occ.addPoint(*point, 0.0) for point in (right[0], right[POINTS - 1], right[-1])]
            if feet:
                curves.append(occ.addCircleArc(feet[-1], centre, ends[0]))
            feet += [ends[0], ends[-1]]
            around = [
                spline(left[:POINTS], ends[0], ends[1]),
                spline(left[POINTS - 1 :], ends[1], ends[2]),
                occ.addCircleArc(ends[2], centre, ends[3]),
                spline(right[:POINTS], ends[3], ends[4]),
                spline(right[POINTS - 1 :], ends[4], ends[5]),
            ]
            curves += around
            tagged = tagged or around
        curves.append(occ.addCircleArc(feet[-1], centre, feet[0]))
        bore = occ.addCurveLoop([occ.addCircle(0.0, 0.0, 0.0, 0.5 * gear.bore)])
        surface = occ.addPlaneSurface([occ.addCurveLoop(curves), bore])
        inside = None if gear.rim_inner_radius is None else occ.addCircle(0.0, 0.0, 0.0, gear.rim_inner_radius)
        occ.synchronize()
        if inside is not None:
            gmsh.model.mesh.embed(1, [inside], 2, surface)
        refine(gmsh, gear.module, fineness, flank=[tagged[3]], tooth=[tagged[0], tagged[1], tagged[3], tagged[4]])
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(2)
        return curved_mesh(gmsh, surface)


def refine(gmsh: Any, module: float, fineness: float, flank: list[int], tooth: list[int]) -> None:
    """Size the elements by their distance from curves: the loaded flank, and all of the tooth's flanks and fillets."""
    fields = gmsh.model.mesh.field
    far = 0.7 * fineness * module
    sizes = []
    for curves, near, reach in ((flank, module / 50.0, 4.0), (tooth, module / 14.0, 5.0)):
        distance, size = fields.add("Distance"), fields.add("Threshold")
        fields.setNumbers(distance, "CurvesList", curves)
        fields.setNumber(distance, "Sampling", 400)
        for name, value in (
            ("InField", distance),
            ("SizeMin", fineness * near),
            ("SizeMax", far),
            ("DistMin", 0.05 * module),
            ("DistMax", reach * module),
        ):
            fields.setNumber(size, name, value)
        sizes.append(size)
    least = fields.add("Min")
    fields.setNumbers(least, "FieldsList", sizes)
    fields.setAsBackgroundMesh(least)
    for option in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
        gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)


def curved_mesh(gmsh: Any, surface: int) -> skfem.MeshTri2:
    """gmsh's six-node triangles as scikit-fem's: corners first, middle nodes where the facets' own numbers say."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    elements = gmsh.model.mesh.getElements(2, surface)[2][0].reshape(-1, 6).astype(int)
    places = np.zeros((int(tags.max()) + 1, 2))
    places[tags.astype(int)] = coordinates.reshape(-1, 3)[:, :2]
    corners, corner_number = np.unique(elements[:, :3], return_inverse=True)
    straight = skfem.MeshTri1(places[corners].T.copy(), corner_number.reshape(-1, 3).T.copy())
    middle: dict[tuple[int, int], int] = {}
    numbers = corner_number.reshape(-1, 3)
    for first, second, node in ((0, 1, 3), (1, 2, 4), (2, 0, 5)):
        edge = np.sort(numbers[:, [first, second]], axis=1)
        middle.update(zip(map(tuple, edge.tolist()), elements[:, node].tolist(), strict=True))
    mesh = skfem.MeshTri2.from_mesh(straight)
    nodes = mesh.doflocs.copy()
    nodes[:, mesh.dofs.facet_dofs[0]] = places[[middle[tuple(pair)] for pair in straight.facets.T.tolist()]].T
    return skfem.MeshTri2(nodes, mesh.t)


class HeldBody(NamedTuple):
    """The basis on a body's mesh, its degrees of freedom that are not held, and their factored stiffness."""

    basis: skfem.Basis
    free: np.ndarray
    factor: SuperLU


def elasticity(
    basis: skfem.Basis, gear: Any, state: PlaneState, width: Callable[[np.ndarray], Any] = lambda radius: 1.0
) -> Any:
    """Stiffness matrix per face width; `width` is that of the body at a radius over that of the face."""
    young, nu = gear.youngs_modulus, gear.poisson_ratio
    shear = young / (2.0 * (1.0 + nu))
    dilatation = young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu) if state == "plane-strain" else 1.0 - nu**2)

    @skfem.BilinearForm
    def stiffness(u: Any, v: Any, w: Any) -> Any:
        strain = sym_grad(u)
        isotropic = dilatation * trace(strain) * div(v) + 2.0 * shear * ddot(strain, sym_grad(v))
        return width(np.hypot(w.x[0], w.x[1])) * isotropic

    return stiffness.assemble(basis)


def held_body(basis: skfem.Basis, matrix: Any, facets: np.ndarray) -> HeldBody:
    """Hold a body at boundary facets, and factor its stiffness."""
    free = basis.complement_dofs(basis.get_dofs(facets))
    inside = matrix[free][:, free].tocsc()
    return HeldBody(
        basis, free, splu(inside, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    )


@lru_cache(maxsize=2)
def held_gear(gear: Gear, fineness: float, state: PlaneState) -> HeldBody:
    """A gear held at its bore."""
    mesh = gear_mesh(gear, fineness)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTriP2()), intorder=4)
    web = (gear.web_thickness or gear.face_width) / gear.face_width
    inside = gear.rim_inner_radius or 0.0
    matrix = elasticity(basis, gear, state, lambda radius: np.where(radius < inside, web, 1.0))
    bore = mesh.facets_satisfying(lambda x: np.hypot(x[0], x[1]) < 0.51 * gear.bore, boundaries_only=True)
    return held_body(basis, matrix, bore)


def deflections(
    gear: Gear, radii: np.ndarray, fineness: float = 1.4, state: PlaneState = "plane-strain"
) -> Deflections:
    """Motion of the tooth's axis and mean sinking of the loaded strip under unit loads at `radii`."""

    def along_flank(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Arc of the involute from the base circle, and distance from the loaded flank."""
        radius = np.hypot(x[0], x[1])
        roll = np.sqrt(np.maximum((radius / gear.base_radius) ** 2 - 1.0, 0.0))
        half_angle = gear.base_half_angle - (roll - np.arctan(roll))
        flank = radius > gear.form_radius
        return 0.5 * gear.base_radius * roll**2, np.where(
            flank, radius * np.abs(np.arctan2(x[0], x[1]) - half_angle), 1
        )

    angles = load_angle(gear, radii)
    return loaded_flank(
        held_gear(gear, fineness, state),
        along_flank,
        places=0.5 * gear.base_radius * ((radii / gear.base_radius) ** 2 - 1.0),
        directions=np.array([-np.cos(angles), -np.sin(angles)]).T,
        heights=gear.base_radius / np.cos(angles),
        pitch=2.0 * math.pi / gear.teeth,
        module=gear.module,
        width=gear.face_width,
    )


@lru_cache(maxsize=4)
def straight_body(basis: skfem.Basis) -> skfem.Basis:
    """The same motions by elements with straight edges."""
    mesh = basis.mesh
    return skfem.Basis(skfem.MeshTri1(np.ascontiguousarray(mesh.p[:, : mesh.nvertices]), mesh.t), basis.elem)


def loaded_flank(
    body: HeldBody,
    along_flank: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    *,
    places: np.ndarray,
    directions: np.ndarray,
    heights: np.ndarray,
    pitch: float,
    module: float,
    width: float,
) -> Deflections:
    """Motions under unit loads on a tooth that stands on the y axis, on its flank at x > 0.

    `along_flank` gives the arc along the involute and the distance from the flank of points; `places` the arcs of the
    loads, `directions` their unit vectors, `heights` where their lines of action cross the tooth's axis.
    """
    basis, free, factor = body
    mesh = basis.mesh
    facets = mesh.facets_satisfying(lambda x: along_flank(x)[1] < 2e-3 * module, boundaries_only=True)
    flank = skfem.FacetBasis(mesh, basis.elem, facets=facets, intorder=10)
    arc, _ = along_flank(np.asarray(flank.global_coordinates()))
    loads = []
    for place, direction in zip(places, directions, strict=True):
        pressure = np.sqrt(np.maximum(1.0 - ((arc - place) / (STRIP * module)) ** 2, 0.0))

        @skfem.LinearForm
        def load(v: Any, w: Any, n: np.ndarray = direction) -> Any:
            return w["pressure"] * (n[0] * v[0] + n[1] * v[1])

        loads.append(load.assemble(flank, pressure=pressure / np.sum(pressure * flank.dx)))
    right_sides = np.array(loads).T
    motion = np.zeros_like(right_sides)
    motion[free] = factor.solve(right_sides[free])
    # Inside the tooth edges are straight, so the straight mesh finds the element of a point.
    inside = straight_body(basis)
    probed = inside.probes(np.array([np.zeros_like(heights), heights])) @ motion
    # The load pushes the tooth from +y towards -x, where the next one stands a pitch on.
    turn = np.array([[math.cos(pitch), -math.sin(pitch)], [math.sin(pitch), math.cos(pitch)]])
    beside = inside.probes(turn @ np.array([np.zeros_like(heights), heights])) @ motion
    count = places.size
    at_axis = np.array([[probed[i, i], probed[count + i, i]] for i in range(count)])
    return Deflections(
        axis=np.einsum("ij,ij->i", at_axis, directions) / width,
        surface=np.einsum("ij,ij->j", right_sides, motion) / width,
        dofs=basis.N,
        next_axis=np.einsum("jc,cji->ij", directions @ turn.T, beside.reshape(2, count, count)) / width,
    )
