"""Housing mesh of a case, from a box, a CAD file or a mesh file, with bearing seats and each element's material."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from gearwhine.case import CaseError, Problem
from gearwhine.case import Housing as HousingTable
from gearwhine.case import Material as MaterialTable
from gearwhine.case.box import FACES, Box
from gearwhine.case.checks.housing import box_geometry
from gearwhine.case.errors import UNSAID
from gearwhine.case.housing import Region
from gearwhine.case.input_files import ChangedFileError, InputFiles
from gearwhine.housing import Joint, Material
from gearwhine.housing.fem.nearest_point import NearestOnSurface
from gearwhine.housing.fem.surface import flat_faces
from gearwhine.housing.model.cover_bolts import cover_joint
from gearwhine.meshes import GeometryError, Mesh, find_bores, mesh_box, mesh_cad, read_mesh, with_bore
from gearwhine.meshes.bores import CylindricalBore
from gearwhine.meshes.errors import MeshSizeError
from gearwhine.meshes.lengths import UNITS, length_text
from gearwhine.meshes.quality import WaveCarrier
from gearwhine.numerics.names import one_of


def ignore_warning(warning: str) -> None:
    """Ignore a warning."""


def build_mesh(
    table: HousingTable,
    materials: Mapping[str, MaterialTable],
    files: InputFiles,
    warn: Callable[[str], None] = ignore_warning,
    *,
    order: int = 2,
) -> Mesh:
    """Mesh the housing of a case with finite elements.

    Parameters
    ----------
    table : gearwhine.case.Housing
    materials : mapping of str to gearwhine.case.Material
    files : InputFiles
        Files that the case names.
    warn : callable
        Receives warnings, a sentence each.
    order : {1, 2}
        Order of the elements, where they are meshed and not read.

    Raises
    ------
    CaseError
        Where its shape cannot be meshed or its file not read or not the one any more that the case was read with, or a
        seat is not found in it.
    """
    if table.box is not None:
        with _at_fault("housing.box", "a box that can be meshed"):
            size = box_mesh_size(table.box, materials[table.material], table.frequency_limit)
            return mesh_box(box_geometry(table.box, table.seat), size, order=order)
    if table.mesh is not None:
        with _at_fault("housing.mesh", "a mesh of solid elements", file=True):
            with files.unchanged(table.mesh.file):
                mesh = read_mesh(table.mesh.file, unit=UNITS[table.mesh.unit])
            mesh = mesh.rotated(np.array(table.mesh.rotation))
        return _with_faces(table, _with_seats(table, mesh))
    if table.cad is None:
        expected = "[housing.box], [housing.cad] or [housing.mesh]: what is asked for needs the mesh of a solid"
        raise CaseError([Problem("housing", UNSAID, expected)])
    turn = np.array(table.cad.rotation)
    with (
        _at_fault("housing.cad", "a solid that can be meshed", file=True),
        files.unchanged(table.cad.file),
    ):
        meshed = mesh_cad(
            table.cad.file,
            table.cad.mesh_size,
            glue=table.cad.glue,
            unit=None if table.cad.unit is None else UNITS[table.cad.unit],
            order=order,
            refine=[(_in_the_file(seat.center, turn), seat.diameter) for seat in table.seat],
            refined_size=table.cad.seat_mesh_size,
        )
    for remark in meshed.remarks:
        warn(f"{table.cad.file.name}: {remark}")
    return _with_faces(table, _with_seats(table, meshed.mesh.rotated(turn)))


_ON_FACE = 0.01  # distance of a named face's point from the surface, as a part of the housing's diagonal
_WAVES = 5.0  # elements to a bending wave in a first mesh, whose estimated error says how much smaller they are to be
_WALLS = 2.0  # and their least size over the wall's thickness


def box_mesh_size(box: Box, material: MaterialTable, limit_hz: float | None) -> float:
    """Return the size of a box's elements [m]; with an accuracy in its place, that of a first, coarse mesh.

    Parameters
    ----------
    box : gearwhine.case.box.Box
    material : gearwhine.case.Material
        Material of its walls.
    limit_hz : float or None
        Frequency below which modes are wanted [Hz].
    """
    if box.mesh_size is not None:
        return box.mesh_size
    thinnest: float = min(getattr(box.walls, face) for face in FACES)
    size: float = _WALLS * thinnest
    if limit_hz is not None:
        omega = 2.0 * np.pi * limit_hz
        carrier = WaveCarrier(material.youngs_modulus, material.poisson_ratio, material.density, omega)
        size = max(size, carrier.shortest_wave(thinnest) / _WAVES)
    return min(size, min(box.size) / 2.0)


def _in_the_file(place: tuple[float, float, float], turn: npt.NDArray[np.float64]) -> tuple[float, float, float]:
    """Coordinates of a point of the machine in the frame of the file."""
    x, y, z = (turn.T @ np.array(place)).tolist()
    return x, y, z


@contextmanager
def _at_fault(key: str, expected: str, *, file: bool = False) -> Iterator[None]:
    """Raise a geometry error as a problem of its key."""
    try:
        yield
    except MeshSizeError as error:
        raise CaseError([Problem(f"{key}.mesh_size", UNSAID, f"another size of elements; {error}")]) from error
    except ChangedFileError as error:
        raise CaseError([Problem(f"{key}.file", UNSAID, str(error))]) from error
    except GeometryError as error:
        raise CaseError([Problem(f"{key}.file" if file else key, UNSAID, f"{expected}; {error}")]) from error


def _with_seats(table: HousingTable, mesh: Mesh) -> Mesh:
    """Return the mesh with a surface for each seat: its own of that name, or the bore by centre and diameter.

    Raises
    ------
    CaseError
        With every seat that is not found.
    """
    problems = []
    for index, seat in enumerate(table.seat):
        try:
            mesh = with_bore(mesh, seat.name, seat.center, seat.diameter)
        except GeometryError as error:
            key, label = f"housing.seat[{index}]", f'seat "{seat.name}"'
            problems.append(
                Problem(key, UNSAID, f"a bore of the housing, by centre and diameter; {error}", label=label)
            )
    if problems:
        raise CaseError(problems)
    return mesh


def _with_faces(table: HousingTable, mesh: Mesh) -> Mesh:
    """Return the mesh with a surface for each named face: the flat face that its point is on.

    Raises
    ------
    CaseError
        With every face whose name a surface of the file has, or whose point is beside the surface.
    """
    if not table.face:
        return mesh
    faces, boundary = flat_faces(mesh), NearestOnSurface(mesh, mesh.boundary)
    near = _ON_FACE * float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
    surfaces, problems = dict(mesh.surfaces), []
    for index, named in enumerate(table.face):
        key, label = f"housing.face[{index}]", f'face "{named.name}"'
        point = boundary.point(np.array(named.at))
        if named.name in surfaces:
            expected = f"a name of its own; the surfaces are {', '.join(sorted(surfaces))}"
            problems.append(Problem(f"{key}.name", named.name, expected, label=label))
        elif (off := float(np.linalg.norm(point.position - named.at))) > near:
            expected = f"a point on the surface; this one is {length_text(off)} from it"
            problems.append(Problem(f"{key}.at", UNSAID, expected, label=label))
        else:
            facet = set(point.nodes.tolist())
            (surfaces[named.name],) = [
                face.facets
                for face in faces
                if any(facet == set(nodes) for block in face.facets for nodes in block.nodes.tolist())
            ]
    if problems:
        raise CaseError(problems)
    return replace(mesh, surfaces=surfaces)


def cover_joints(table: HousingTable, materials: Mapping[str, MaterialTable]) -> list[Joint]:
    """Return the bolts of a box's cover, each a joint of its two patches."""
    if table.box is None or table.box.cover is None or table.box.cover.bolts is None:
        return []
    box = box_geometry(table.box, table.seat)
    bolt_material = material_of(materials, table.box.cover.bolts.material or table.material)
    joints = []
    for bolt in box.bolts:
        # The middles of what the bolt clamps say in which region each part is.
        middle, axis, of_body = np.array(bolt.position), np.array(bolt.axis), bolt.grip - bolt.cover_grip
        body = _material_at(table, materials, "body", middle - axis * of_body / 2.0)
        cover = _material_at(table, materials, "cover", middle + axis * bolt.cover_grip / 2.0)
        joints.append(cover_joint(box, bolt, body, bolt_material, cover))
    return joints


def _material_at(
    table: HousingTable, materials: Mapping[str, MaterialTable], volume: str, place: npt.NDArray[np.float64]
) -> Material:
    """Return the material at a place within a volume of a box: that of its region, else that of the housing."""
    for region in table.region:
        low, high = np.sort(np.array(region.box or np.full((2, 3), np.nan)), axis=0)
        if region.volume == volume or ((place >= low) & (place <= high)).all():
            return material_of(materials, region.material)
    return material_of(materials, table.material)


def material_of(materials: Mapping[str, MaterialTable], name: str) -> Material:
    """Return a material of the case, for a solid.

    Raises
    ------
    CaseError
        Where its shear modulus is not that of an isotropic one.
    """
    steel = materials[name]
    if not steel.is_isotropic:
        expected = f"E / (2 (1 + ν)) = {steel.youngs_modulus / (2.0 * (1.0 + steel.poisson_ratio)):.5g} Pa in a housing"
        value = f"{steel.shear_modulus:.5g} Pa"
        raise CaseError([Problem(f"material.{name}.shear_modulus", value, f"{expected}, whose solids are isotropic")])
    return Material(steel.youngs_modulus, steel.poisson_ratio, steel.density)


def bores_along_axes(mesh: Mesh) -> list[tuple[str, CylindricalBore]]:
    """Return the mesh's bores along each axis: first along z, where shafts are, then others, the widest first."""
    return [
        (axis, bore)
        for axis, direction in zip("zxy", np.eye(3)[[2, 0, 1]], strict=True)
        for bore in find_bores(mesh, axis=direction)
    ]


def materials_of(
    table: HousingTable, materials: Mapping[str, MaterialTable], mesh: Mesh
) -> tuple[Mesh, Material, dict[str, Material]]:
    """Return the mesh with the case's regions as volumes, the material of the rest, and that of each region.

    Raises
    ------
    CaseError
        Where regions name volumes that the mesh does not have, hold no element, or overlap; with all of them.
    """
    rest = material_of(materials, table.material)
    if not table.region:
        return mesh, rest, {}
    problems: list[Problem] = []
    members: dict[str, npt.NDArray[np.int64]] = {}
    region_of = np.full(mesh.n_elements, -1)
    for index, region in enumerate(table.region):
        elements = _elements(mesh, index, region, problems)
        overlapped = np.unique(region_of[elements])
        for rival in overlapped[overlapped >= 0].tolist():
            count = int(np.count_nonzero(region_of[elements] == rival))
            expected = (
                f'elements of its own ({count} of its {len(elements)} are in region "{table.region[rival].name}" too)'
            )
            problems.append(_problem(index, region, expected))
        region_of[elements] = index
        members[region.name] = elements
    if problems:
        raise CaseError(problems)
    of_regions = {region.name: material_of(materials, region.material) for region in table.region}
    return replace(mesh, volumes=members), rest, of_regions


def _elements(mesh: Mesh, index: int, region: Region, problems: list[Problem]) -> npt.NDArray[np.int64]:
    if region.volume is not None:
        if region.volume not in mesh.volumes:
            volumes = sorted(mesh.volumes)
            expected = one_of("a volume of the mesh", region.volume, volumes)
            problems.append(_problem(index, region, expected))
        return np.asarray(mesh.volumes.get(region.volume, np.empty(0, dtype=np.int64)))
    assert region.box is not None
    low, high = np.sort(np.array(region.box), axis=0)
    elements = np.flatnonzero(((mesh.centers >= low) & (mesh.centers <= high)).all(axis=1))
    if not len(elements):
        span = [f"{1e3 * a:.4g} to {1e3 * b:.4g}" for a, b in mesh.bounds.T]
        expected = f"a box with the middle of an element in it; the housing spans {' x '.join(span)} mm"
        problems.append(_problem(index, region, expected))
    return elements


def _problem(index: int, region: Region, expected: str) -> Problem:
    key, value = ("volume", region.volume) if region.volume is not None else ("box", region.box)
    return Problem(f"housing.region[{index}].{key}", value, expected, label=f'region "{region.name}"')
