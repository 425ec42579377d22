"""Housing mesh of a case, from a box, a CAD file or a mesh file, with a surface for each seat."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import numpy.typing as npt

import housing as room
from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.case.box_shape import box_geometry
from gearwhine.case.problems import UNSAID
from meshes import (
    UNITS,
    CylindricalBore,
    GeometryError,
    Mesh,
    MeshSizeError,
    find_bores,
    mesh_box,
    mesh_cad,
    read_mesh,
    with_bore,
)


def ignore_warning(warning: str) -> None:
    """Ignore a warning."""


def build_mesh(case: Case, warn: Callable[[str], None] = ignore_warning, *, order: int = 2) -> Mesh:
    """The housing's finite-element mesh.

    Parameters
    ----------
    case : Case
    warn : callable
        Receives warnings, a sentence each.
    order : {1, 2}
        Of the elements, where they are made here and not read.

    Raises
    ------
    CaseError
        Where the case has no housing, its shape cannot be meshed or its file not read, or a seat is not found in it.
    """
    require(case, "housing", command="mesh")
    given = case.housing
    assert given is not None
    if given.box is not None:
        with _at_fault("housing.box", "a box that can be meshed"):
            return mesh_box(box_geometry(given.box, given.seat), given.box.mesh_size, order=order)
    if given.mesh is not None:
        with _at_fault("housing.mesh", "a mesh of solid elements", file=True):
            mesh = read_mesh(given.mesh.file, unit=UNITS[given.mesh.unit])
            mesh = mesh.rotated(np.array(given.mesh.rotation))
        return _with_seats(case, mesh)
    assert given.cad is not None
    turn = np.array(given.cad.rotation)
    with _at_fault("housing.cad", "a solid that can be meshed", file=True):
        found = mesh_cad(
            given.cad.file,
            given.cad.mesh_size,
            glue=given.cad.glue,
            unit=None if given.cad.unit is None else UNITS[given.cad.unit],
            order=order,
            refine=[(_in_the_file(seat.center, turn), seat.diameter) for seat in given.seat],
            refined_size=given.cad.seat_mesh_size,
        )
    for remark in found.remarks:
        warn(f"{given.cad.file.name}: {remark}")
    return _with_seats(case, found.mesh.rotated(turn))


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
    except GeometryError as error:
        raise CaseError([Problem(f"{key}.file" if file else key, UNSAID, f"{expected}; {error}")]) from error


def _with_seats(case: Case, mesh: Mesh) -> Mesh:
    """The mesh with a surface for each seat: its own of that name, or the bore by centre and diameter.

    Raises
    ------
    CaseError
        With every seat that is not found.
    """
    assert case.housing is not None
    problems = []
    for index, seat in enumerate(case.housing.seat):
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


def cover_joints(case: Case) -> list[room.Joint]:
    """The bolts of a box's cover, each tying its two patches."""
    given = case.housing
    if given is None or given.box is None or given.box.cover is None or given.box.cover.bolts is None:
        return []
    box = box_geometry(given.box, given.seat)
    parts = material_of(case, given.material)
    own = material_of(case, given.box.cover.bolts.material or given.material)
    return room.cover_joints(box, parts, own)


def material_of(case: Case, name: str) -> room.Material:
    """A material of the case, for a solid.

    Raises
    ------
    CaseError
        Where its shear modulus is not that of an isotropic one.
    """
    steel = case.material[name]
    if not steel.is_isotropic:
        expected = f"E / (2 (1 + ν)) = {steel.youngs_modulus / (2.0 * (1.0 + steel.poisson_ratio)):.5g} Pa in a housing"
        shown = f"{steel.shear_modulus:.5g} Pa"
        raise CaseError([Problem(f"material.{name}.shear_modulus", shown, f"{expected}, whose solids are isotropic")])
    return room.Material(steel.youngs_modulus, steel.poisson_ratio, steel.density)


def bores_along_axes(mesh: Mesh) -> list[tuple[str, CylindricalBore]]:
    """The bores along each axis that a mesh has: those along z, where shafts are, then others, the widest first."""
    return [
        (axis, bore)
        for axis, direction in zip("zxy", np.eye(3)[[2, 0, 1]], strict=True)
        for bore in find_bores(mesh, axis=direction)
    ]
