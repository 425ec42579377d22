"""Round shafts that stand for a gear with its teeth, against finite elements of the section and of solid pinions."""

import math
from dataclasses import replace

import numpy as np
import pytest
import skfem
from scipy import sparse
from skfem.helpers import dot, grad

from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.geometry.profile import gear_outline
from gearwhine.coupling.gears.geometry.toothed_section import toothed_section
from gearwhine.housing import Material, assemble
from gearwhine.housing.fem.factorization import Factorizer
from gearwhine.meshes import Mesh
from gearwhine.meshes.gmsh_meshing import gmsh_session

MODULE = 3e-3
PINION = Gear("pinion", 20, MODULE, math.radians(20.0), 20 * MODULE)
ROOT = PINION.root_circle_radius
NU = PINION.poisson_ratio


def torsion_constant(gear: Gear) -> float:
    """Prandtl's stress function has −∇²φ = 2 in the section and φ = 0 around it; J is twice its volume."""
    corners = gear_outline(gear, points=6)
    with gmsh_session(gear.name) as gmsh:
        points = [gmsh.model.geo.addPoint(*corner, 0.0, gear.module) for corner in corners.tolist()]
        lines = [gmsh.model.geo.addLine(*ends) for ends in zip(points, [*points[1:], points[0]], strict=True)]
        gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(lines)])
        gmsh.model.geo.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.option.setNumber("Mesh.MeshSizeMax", gear.module)
        gmsh.model.mesh.generate(2)
        mesh = skfem.MeshTri(*elements(gmsh, 2, 3))
    basis = skfem.Basis(mesh, skfem.ElementTriP2())
    stiffness = skfem.BilinearForm(lambda u, v, _: dot(grad(u), grad(v))).assemble(basis)
    load = skfem.LinearForm(lambda v, _: 2.0 * v).assemble(basis)
    return float(load @ skfem.solve(*skfem.condense(stiffness, load, D=basis.get_dofs())))


def elements(gmsh, kind: int, corners: int) -> tuple[np.ndarray, np.ndarray]:  # type: ignore[no-untyped-def]
    tags, places, _ = gmsh.model.mesh.getNodes()
    numbers = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    numbers[tags] = np.arange(tags.size)
    found = numbers[gmsh.model.mesh.getElementsByType(kind)[1]].reshape(-1, corners)
    used, own = np.unique(found, return_inverse=True)
    return places.reshape(-1, 3)[used, : corners - 1].T.copy(), own.reshape(found.shape).T.copy()


@pytest.mark.parametrize(("teeth", "helix", "shift"), [(18, 0.0, 0.0), (20, 20.0, 0.3), (45, 0.0, 0.0)])
def test_torsion_of_the_section(teeth: int, helix: float, shift: float) -> None:
    gear = replace(PINION, teeth=teeth, helix_angle=math.radians(helix), profile_shift=shift)
    exact = torsion_constant(gear)
    assert math.pi / 32.0 * toothed_section(gear).torsion_diameter ** 4 == pytest.approx(exact, rel=0.01)
    # The root circle alone is 4 to 19 % too soft, the reference circle much too stiff.
    assert math.pi / 2.0 * gear.root_circle_radius**4 < 0.97 * exact
    assert math.pi / 2.0 * gear.pitch_radius**4 > 1.1 * exact


def test_the_section_of_straight_teeth_bends_as_the_reference_circle() -> None:
    for teeth in (18, 20, 60):
        gear = replace(PINION, teeth=teeth)
        section = toothed_section(gear)
        # The moments of thin rings of their arcs.
        radii = np.linspace(gear.root_circle_radius, gear.tip_radius, 20001)
        outline = gear_outline(gear, points=200)
        angle, radius = np.arctan2(outline[:, 1], outline[:, 0]), np.hypot(*outline.T)
        # Half the angle of a tooth at each radius: the outermost corner of its side there.
        first = np.abs(angle) < math.pi / teeth
        side = np.argsort(radius[first & (angle >= 0.0)])
        half = np.interp(radii, radius[first & (angle >= 0.0)][side], angle[first & (angle >= 0.0)][side])
        second = math.pi / 4.0 * gear.root_circle_radius**4 + teeth * np.trapezoid(half * radii**3, radii)
        assert math.pi / 64.0 * section.bending_diameter**4 == pytest.approx(second, rel=2e-3)
        assert section.bending_diameter == pytest.approx(2.0 * gear.pitch_radius, rel=5e-3)


def bending_compliance(gear: Gear, stub: float) -> float:
    """Rotation of the ends of a solid pinion with round stubs by a unit moment, E = 1, by an eighth of it.

    Plane bending is symmetric to the plane in which it bends and to the middle of the face, and antisymmetric to the
    third plane.
    """
    half, root, far = 0.5 * gear.face_width, gear.root_circle_radius, 4.0 * gear.tip_radius
    with gmsh_session(gear.name) as gmsh:
        occ = gmsh.model.occ
        points = [occ.addPoint(*corner, 0.0) for corner in gear_outline(gear, points=4).tolist()]
        lines = [occ.addLine(*ends) for ends in zip(points, [*points[1:], points[0]], strict=True)]
        face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        toothed = [entity for entity in occ.extrude([(2, face)], 0.0, 0.0, half) if entity[0] == 3]
        end = (3, occ.addCylinder(0.0, 0.0, half, 0.0, 0.0, stub, root))
        whole, _ = occ.fragment(toothed, [end])
        occ.intersect(whole, [(3, occ.addBox(0.0, 0.0, 0.0, far, far, far))])
        occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", max(1.2, 0.05 * gear.teeth) * gear.module)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.model.mesh.generate(3)
        mesh = skfem.MeshTet(*elements(gmsh, 4, 4))
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTetP2()), intorder=1)
    nodes = skfem.Basis(mesh, skfem.ElementTetP2(), intorder=1)
    solid = Mesh.of_tetrahedra(nodes.doflocs.T, right_handed(mesh, nodes.element_dofs.T))
    modulus = 1e9
    stiffness = assemble(solid, Material(modulus, NU, 1000.0), threads=1).stiffness / modulus
    second = math.pi / 4.0 * root**4
    loaded = mesh.facets_satisfying(lambda x: np.isclose(x[2], half + stub), boundaries_only=True)
    load = skfem.LinearForm(lambda v, w: v[2] * w.x[0] / second).assemble(
        skfem.FacetBasis(mesh, basis.elem, facets=loaded)
    )
    held = []
    for axis, components in ((0, ("u^2", "u^3")), (1, ("u^2",)), (2, ("u^3",))):
        facets = mesh.facets_satisfying(lambda x, axis=axis: np.isclose(x[axis], 0.0, atol=1e-9), boundaries_only=True)
        held.append(basis.get_dofs(facets).all(list(components)))
    middle = int(np.argmin((mesh.p**2).sum(axis=0)))  # the whole may move along x
    held.append(basis.nodal_dofs[:1, middle])
    matrix, right, *_ = skfem.condense(stiffness, load, D=np.unique(np.concatenate(held)))
    motion = Factorizer(threads=1).factor(sparse.csr_array(matrix)).solve(right[:, None])
    return 8.0 * float(right @ motion[:, 0])


def right_handed(mesh: skfem.MeshTet, cells: np.ndarray) -> np.ndarray:
    """Cells of ten nodes, two corners exchanged where they are left-handed; skfem sorts the corners of each."""
    first, *others = np.moveaxis(mesh.p[:, mesh.t], 1, 0)
    left = np.linalg.det(np.moveaxis([one - first for one in others], 2, 0)) < 0.0
    found = cells.copy()
    found[left] = cells[left][:, [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]]
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("teeth", "width"), [(20, 10.0), (20, 20.0), (40, 10.0)])
def test_a_solid_pinion_bends_as_the_round_one(teeth: int, width: float) -> None:
    """With teeth that carry nothing at the ends of the face, by 20 of them; 40 were not looked at for that."""
    gear = replace(PINION, teeth=teeth, face_width=width * MODULE)
    stub = gear.root_circle_radius
    section = toothed_section(gear)
    of_root = math.pi / 4.0 * gear.root_circle_radius**4
    found = bending_compliance(gear, stub) - 2.0 * stub / of_root
    within = gear.face_width - 2.0 * section.end_length
    round_one = within / (math.pi / 64.0 * section.bending_diameter**4) + 2.0 * section.end_length / of_root
    assert round_one == pytest.approx(found, rel=0.03)
    # The root circle alone is too soft, the section all over the face too stiff.
    assert gear.face_width / of_root > (1.3 if teeth == 20 else 1.1) * found
    assert gear.face_width / (math.pi / 64.0 * section.bending_diameter**4) < 0.92 * found


@pytest.mark.parametrize(("degrees", "elements"), [(15.0, 1.039), (30.0, 1.136)])
def test_helical_teeth_carry_less(degrees: float, elements: float) -> None:
    """Compliance over that of straight teeth, each by its root circle, as `studies/helical_pinion.py` finds it.

    Of whole pinions of 20 teeth, face of 10 modules. Teeth that carried as much as straight ones would give 1.01 and
    1.05.
    """
    found = []
    for helix in (0.0, degrees):
        gear = replace(PINION, helix_angle=math.radians(helix), face_width=10.0 * MODULE)
        section = toothed_section(gear)
        teeth = gear.face_width - 2.0 * section.end_length
        part = (2.0 * gear.root_circle_radius / section.bending_diameter) ** 4
        found.append((teeth * part + 2.0 * section.end_length) / gear.face_width)
    assert found[1] / found[0] == pytest.approx(elements, rel=0.02)
    assert found[1] / found[0] > 1.0 + 0.8 * (elements - 1.0)
