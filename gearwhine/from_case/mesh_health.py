"""Mesh checks: defects of a housing's mesh as errors of the case, and warnings of its size and quality."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearwhine.case import CaseError, Housing, Material, Problem
from gearwhine.case.box import Box
from gearwhine.case.checks.housing import wall_volume
from gearwhine.case.errors import UNSAID
from gearwhine.case.input_files import InputFiles
from gearwhine.from_case.fixtures import build_fixtures, check_places
from gearwhine.from_case.mesh import box_mesh_size, build_mesh, cover_joints, material_of, materials_of
from gearwhine.housing import Joint
from gearwhine.housing import Material as SolidMaterial
from gearwhine.housing.housing import joined_nodes
from gearwhine.housing.model.fixtures import Fixture
from gearwhine.housing.model_warnings import defect_warnings, resolution_warnings, wave_carrier
from gearwhine.meshes import Mesh, MeshDefect, diagnose
from gearwhine.meshes.gmsh_meshing import expected_elements
from gearwhine.meshes.lengths import UNITS
from gearwhine.meshes.quality import resolving_size
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning

_UNKNOWNS_EACH = 4.2  # degrees of freedom for each 10-node tetrahedron of a bulky solid; in thin walls up to 6
_MANY_UNKNOWNS = 1.5e6


def allowed_defects(table: Housing, fixtures: Sequence[Fixture], mesh: Mesh) -> tuple[MeshDefect, ...]:
    """Return the defects of a housing's mesh that are no errors.

    Bodies that touch without being joined, or whose elements do not match there, are wrong or doubtful unless joints of
    the case connect them.

    Raises
    ------
    CaseError
        With all errors of the mesh.
    """
    source = table.mesh or table.cad
    unit = None if source is None or source.unit is None else UNITS[source.unit]
    defects = diagnose(mesh, unit=unit, joined=[*joined_nodes(fixtures, mesh)])
    wrong = [defect for defect in defects if defect.severity == "error"]
    if wrong:
        key = "housing.mesh.file" if table.mesh else "housing.cad.file" if table.cad else "housing.box"
        value: object = UNSAID if source is None else str(source.file)
        raise CaseError([Problem(key, value, f"a sound mesh; {defect.name}: {defect.message}") for defect in wrong])
    return defects


@dataclass(frozen=True)
class MeshPreview:
    """Mesh of a case's housing as far as it is known before anything is solved.

    Attributes
    ----------
    size : ndarray, shape (3,)
        Size of the housing along x, y and z [m].
    mesh_size : float or None
        Length of the elements, where the housing is meshed and not read [m].
    bolts : list of gearwhine.housing.Joint, or None
        Bolts of a box's cover.
    mesh : Mesh or None
        Mesh of a file; that of a CAD file has straight elements, which show its bores as well and are made sooner.
    """

    size: FloatArray
    mesh_size: float | None
    bolts: list[Joint] | None = None
    mesh: Mesh | None = None


def preview_mesh(
    table: Housing, materials: Mapping[str, Material], files: InputFiles, progress: Progress = silent
) -> tuple[MeshPreview, list[dict[str, Any]]]:
    """Preview the mesh: its size and warnings about it, before anything is solved.

    A CAD or mesh file is read and checked whole; for a box the element size is compared with the shortest wave.

    Raises
    ------
    CaseError
        Where the file cannot be read, its mesh is wrong, or a fixture or sensor has no place on it.
    """
    if table.box is not None:
        size = box_mesh_size(table.box, materials[table.material], table.frequency_limit)
        load = _preview_load(expected_elements(wall_volume(table.box), size))
        preview = MeshPreview(np.array(table.box.size), table.box.mesh_size, bolts=cover_joints(table, materials))
        return preview, _preview_size(table.box, material_of(materials, table.material), table.frequency_limit) + load
    remarks: list[str] = []
    progress("meshing the drawing" if table.mesh is None else "reading the mesh")
    mesh = build_mesh(table, materials, files, remarks.append, order=1)
    warnings = [warning("geometry", remark) for remark in remarks]
    warnings += defect_warnings(allowed_defects(table, build_fixtures(table, materials), mesh))
    with noted_on_failure(warnings):
        materials_of(table, materials, mesh)
        check_places(table, mesh)
    preview = MeshPreview(np.ptp(mesh.bounds, axis=0), None if table.cad is None else table.cad.mesh_size, mesh=mesh)
    if table.cad is not None:
        return preview, warnings + _preview_load(mesh.n_elements)
    solid = material_of(materials, table.material)
    return preview, warnings + resolution_warnings(mesh, solid, table.frequency_limit)


def _preview_size(box: Box, material: SolidMaterial, limit: float | None) -> list[dict[str, Any]]:
    """Warn of elements that are long for the shortest wave at the frequency limit [Hz]."""
    if limit is None or box.mesh_size is None:
        return []
    walls = box.walls
    thinnest = min(walls.left, walls.right, walls.bottom, walls.top, walls.back, walls.front)
    length = wave_carrier(material, limit).shortest_wave(thinnest)
    size = resolving_size(length, 2)
    if box.mesh_size <= size:
        return []
    message = (
        f"elements of {1e3 * box.mesh_size:.3g} mm are longer than 1/{length / size:g} of the shortest wave, "
        f"{1e3 * length:.3g} mm at {limit:.4g} Hz in the wall of {1e3 * thinnest:.3g} mm; modes near "
        f"that frequency come out some per cent too high: use a mesh_size of at most {1e3 * size:.3g} mm, "
        "the most by the wave alone; bores, bosses and corners may need smaller ones, as `gearwhine modes` tells by "
        "the estimated error of each mode"
    )
    return [warning("size", message)]


def _preview_load(elements: float) -> list[dict[str, Any]]:
    """Warning about a mesh too large for most computers."""
    unknowns = _UNKNOWNS_EACH * elements
    if unknowns < _MANY_UNKNOWNS:
        return []
    message = (
        f"about {elements:.1g} elements or more, that is {unknowns:.1g} degrees of freedom: modes of so many take tens "
        "of gigabytes of memory and long; a larger mesh_size takes less"
    )
    return [warning("load", message)]


@contextmanager
def noted_on_failure(warnings: Sequence[dict[str, Any]]) -> Iterator[None]:
    """Add the warnings so far to an exception as notes: one of them may be its cause."""
    try:
        yield
    except Exception as error:
        for entry in warnings:
            error.add_note(f"warning: {entry['message']}")
        raise
