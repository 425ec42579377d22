"""Mesh checks: defects of a housing's mesh as errors of the case, and warnings of its size and quality."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, CaseError, Problem
from gearwhine.case.box import Box
from gearwhine.case.checks.housing import wall_volume
from gearwhine.case.errors import UNSAID
from gearwhine.from_case.fixtures import check_places
from gearwhine.from_case.mesh import box_mesh_size, build_mesh, cover_joints, materials_of
from gearwhine.housing import HousingError, Joint, ModeSet
from gearwhine.housing.model.seats import sensor_port
from gearwhine.housing.modes.health import DISCRETISATION_BOUND
from gearwhine.meshes import GeometryError, Mesh, MeshDefect, diagnose, resolution_defects
from gearwhine.meshes.gmsh_meshing import expected_elements
from gearwhine.meshes.lengths import UNITS, length_text
from gearwhine.meshes.quality import WaveCarrier, resolving_size, wall_thickness
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning

FloatArray = npt.NDArray[np.float64]

_TWO_PI = 2.0 * np.pi
_UNKNOWNS_EACH = 4.2  # degrees of freedom for each 10-node tetrahedron of a bulky solid; in thin walls up to 6
_MANY_UNKNOWNS = 1.5e6
_ORDER_AT_INNER_EDGES = 2.0 * 0.545
_BEYOND_ESTIMATE = 0.3  # estimated error from which it is a lower bound: the mode's shape itself is another one
_BESIDE = 0.01  # distance of a point from the surface above which a warning is given, over the housing's diagonal


def require_meshable(case: Case, mesh: Mesh) -> list[dict[str, Any]]:
    """Warnings about the mesh of a case.

    Bodies that touch without being joined, or whose elements do not match there, are wrong or doubtful unless joints of
    the case connect them.

    Raises
    ------
    CaseError
        With all errors of the mesh.
    """
    table = case.housing
    assert table is not None
    source = table.mesh or table.cad
    unit = None if source is None or source.unit is None else UNITS[source.unit]
    defects = diagnose(mesh, unit=unit, joined=list(_joined_nodes(case, mesh)))
    wrong = [defect for defect in defects if defect.severity == "error"]
    if wrong:
        key = "housing.mesh.file" if table.mesh else "housing.cad.file" if table.cad else "housing.box"
        value: object = UNSAID if source is None else str(source.file)
        raise CaseError([Problem(key, value, f"a sound mesh; {defect.name}: {defect.message}") for defect in wrong])
    return _warnings(defects)


def _joined_nodes(case: Case, mesh: Mesh) -> Iterator[npt.NDArray[np.int64]]:
    """Yield the nodes of each joint."""
    assert case.housing is not None
    for joint in (*(table.build() for table in case.housing.joint), *cover_joints(case)):
        try:
            yield joint.nodes(mesh)
        except (HousingError, GeometryError):
            # What it was to connect is not known; that it has no place is said where fixtures are placed.
            yield np.arange(len(mesh.points))


def resolution_warnings(case: Case, mesh: Mesh, limit_hz: float | None) -> list[dict[str, Any]]:
    """Warnings about element size for modes up to a frequency; without one, about the kind of element alone."""
    # Without a limit a frequency is taken that is so low that no element is too large for it.
    return _warnings(resolution_defects(mesh, _wave(case, limit_hz if limit_hz else 1e-6)))


def discretisation_warnings(case: Case, mesh: Mesh, modes: ModeSet) -> list[dict[str, Any]]:
    """Warnings about modes whose estimated error by the mesh is too large, with the size of elements that suffices.

    The size of elements is judged by the modes themselves here; what their kind does to them is told besides.
    """
    table, errors = case.housing, modes.discretisation_errors
    assert table is not None
    warnings = [entry for entry in resolution_warnings(case, mesh, None) if entry["name"] != "size"]
    if errors is None or not (coarse := errors > DISCRETISATION_BOUND).any():
        return warnings
    worst, count = int(np.argmax(errors)), int(coarse.sum())
    # So coarse a mesh that the mode is another one: how much too high it is no stress field of its own can tell.
    least = "at least " if errors[worst] > _BEYOND_ESTIMATE else ""
    finer = size_for(errors[worst], DISCRETISATION_BOUND)
    advice, figures = f"use elements of at most {finer:.2g} of their size", {}
    if table.mesh_size is not None:
        # Elements that are larger than the walls' waves say little of smaller ones.
        wave = _wave(case, float(modes.frequencies_hz[worst])).shortest_wave(wall_thickness(mesh))
        size = min(table.mesh_size * finer, resolving_size(wave, mesh.order))
        advice, figures = f"use a mesh_size of about {length_text(size)}", {"mesh_size_m": size}
    missing = "" if table.frequency_limit is None else ", and higher ones that belong below the limit may be missing"
    message = (
        f"this mesh makes {count} of {len(errors)} modes more than {100 * DISCRETISATION_BOUND:g} % too high by an "
        f"estimate from their own stresses, mode {worst + 1} at {modes.frequencies_hz[worst]:.4g} Hz by {least}"
        f"{100 * errors[worst]:.2g} %{missing}; {advice}"
    )
    found = warning("discretisation", message, count=count, largest_error=float(errors[worst]), **figures)
    return [found, *warnings]


def size_for(error: float, wanted: float) -> float:
    """Return the size of elements that brings an error down to what is wanted, as a part of their size.

    The error of a smooth mode's frequency falls with h² or h⁴, by elements of order 1 or 2. At a right-angled inner
    edge, as walls have where they meet, stresses grow with r^(0.545 - 1) (Williams 1952), and it falls with h^1.09 in
    the end, whatever the order (Strang and Fix 1973, chapter 8); that is taken.
    """
    return float((wanted / error) ** (1.0 / _ORDER_AT_INNER_EDGES))


def _wave(case: Case, limit_hz: float) -> WaveCarrier:
    assert case.housing is not None
    material = case.material[case.housing.material]
    return WaveCarrier(material.youngs_modulus, material.poisson_ratio, material.density, _TWO_PI * limit_hz)


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


def preview_mesh(case: Case, progress: Progress = silent) -> tuple[MeshPreview, list[dict[str, Any]]]:
    """Preview the mesh: its size and warnings about it, before anything is solved.

    A CAD or mesh file is read and checked whole; for a box the element size is compared with the shortest wave.

    Raises
    ------
    CaseError
        Where the file cannot be read, its mesh is wrong, or a fixture or sensor has no place on it.
    """
    table = case.housing
    assert table is not None
    if table.box is not None:
        load = _preview_load(expected_elements(wall_volume(table.box), box_mesh_size(case)))
        preview = MeshPreview(np.array(table.box.size), table.box.mesh_size, bolts=cover_joints(case))
        return preview, _preview_size(case, table.box) + load
    remarks: list[str] = []
    progress("meshing the drawing" if table.mesh is None else "reading the mesh")
    mesh = build_mesh(case, remarks.append, order=1)
    warnings = [warning("geometry", remark) for remark in remarks] + require_meshable(case, mesh)
    with noted_on_failure(warnings):
        materials_of(case, mesh)
        check_places(case, mesh)
    preview = MeshPreview(np.ptp(mesh.bounds, axis=0), None if table.cad is None else table.cad.mesh_size, mesh=mesh)
    if table.cad is not None:
        return preview, warnings + _preview_load(mesh.n_elements)
    return preview, warnings + resolution_warnings(case, mesh, table.frequency_limit)


def _preview_size(case: Case, box: Box) -> list[dict[str, Any]]:
    assert case.housing is not None
    limit = case.housing.frequency_limit
    if limit is None or box.mesh_size is None:
        return []
    walls = box.walls
    thinnest = min(walls.left, walls.right, walls.bottom, walls.top, walls.back, walls.front)
    length = _wave(case, limit).shortest_wave(thinnest)
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


def _warnings(defects: tuple[MeshDefect, ...]) -> list[dict[str, Any]]:
    """Mesh defects as warnings of the command's JSON."""
    return [
        warning(defect.name, defect.message, count=defect.count, place_m=defect.place.tolist()) for defect in defects
    ]


def surface_point_warnings(case: Case, mesh: Mesh) -> Iterator[dict[str, Any]]:
    """Warn of sensors and lumped masses that are given beside the housing's surface, with the point where they sit."""
    if case.housing is None:
        return
    far = _BESIDE * float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
    placed = [
        *(("sensor", one.name, one.position, sensor_port(mesh, one.build()).position) for one in case.housing.sensor),
        *(
            ("mass", one.name, one.position, one.build().place(mesh).position)
            for one in case.housing.mass
            if one.position is not None
        ),
    ]
    for kind, name, position, place in placed:
        off = float(np.linalg.norm(place - position))
        if off > far:
            at = ", ".join(f"{round(1e3 * float(value), 3) + 0.0:.6g}" for value in place)
            yield warning(
                f"{kind} place",
                f'{kind} "{name}": its position is {1e3 * off:.3g} mm from the surface; it sits at ({at}) mm',
                **{kind: name, "beside_m": off},
            )
