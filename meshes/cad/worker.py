"""Worker process that reads and meshes a CAD file.

OpenCASCADE writes to standard output and may end its process with a segmentation fault on a damaged file; so it has a
process of its own. Data go through a folder: ``request.json`` in; ``stage`` (the work in progress), ``answer.json``
and the mesh's arrays out. The worker ends when the caller does, for whatever reason, and removes the folder.
"""

import json
import os
import shutil
import sys
import threading
import time
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from gearwhine.meshes.cad.shape import Shape, choose_unit, conforming, extent, read_solids
from gearwhine.meshes.errors import GeometryError, MesherUnavailableError, MeshSizeError
from gearwhine.meshes.gmsh_meshing import Tetrahedra, check_mesh_size, coarse_size, collect, gmsh_session, mesh_solids

STARTING, READING, JOINING, MESHING = "starting", "reading it", "joining its solids", "meshing it"
FORESEEN_FILE = "foreseen"  # the file with the number of elements to come
SPENT_FILE = "spent"  # the file with the seconds of processor time so far

_FILLING = 10.0  # tetrahedra in a cube of their edge length, about
_WATCH = 0.5  # seconds between looks at the parent
_BLEND = 3.0  # elements grow to their full size over this many of the small ones


@dataclass(frozen=True)
class Request:
    """File to read, and how to mesh it.

    Attributes
    ----------
    path : str
    kind : {"step", "iges", "brep"}
    mesh_size : float or None
        Mesh size [m]; None for one by the thickness of the walls.
    order : {1, 2}
    stated, given : float or None
        Units of length [m], as of :func:`gearwhine.meshes.cad.shape.choose_unit`.
    glue : bool
        Whether solids that touch become one piece.
    places : list of (x, y, z, diameter)
        Bores to refine around [m].
    place_size : float or None
        Element size around these bores [m].
    """

    path: str
    kind: str
    mesh_size: float | None
    order: int
    stated: float | None
    given: float | None
    glue: bool
    places: list[tuple[float, float, float, float]]
    place_size: float | None


def end_with(parent: int, folder: Path) -> None:
    """Watch the parent process from a thread, and tell the time spent; once it is gone, end, the folder removed.

    A process whose parent has died gets another one. The parent's number is handed over, because the parent may be
    gone before this begins. A thread is enough: gmsh's calls leave Python's lock to it while they last.
    """

    def watch() -> None:
        while os.getppid() == parent:
            with suppress(OSError):
                (folder / SPENT_FILE).write_text(f"{time.process_time()}", encoding="utf-8")
            time.sleep(_WATCH)
        shutil.rmtree(folder, ignore_errors=True)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def main(folder: Path) -> None:
    """Answer the request in a folder."""
    request = Request(**json.loads((folder / "request.json").read_text(encoding="utf-8")))
    try:
        answer = _answer(request, folder)
    except MesherUnavailableError as error:
        answer = {"unavailable": str(error)}
    except MeshSizeError as error:
        answer = {"size": str(error)}
    except GeometryError as error:
        answer = {"error": str(error)}
    (folder / "answer.json").write_text(json.dumps(answer), encoding="utf-8")


def _answer(request: Request, folder: Path) -> dict[str, Any]:
    def at(stage: str) -> None:
        (folder / "stage").write_text(stage, encoding="utf-8")

    with gmsh_session("it") as gmsh:
        at(READING)
        solids = read_solids(gmsh, request.path, request.kind)
        # The kernel converts STEP and IGES to millimetres by their stated unit; BREP is read unchanged.
        stated = request.stated if request.stated is not None else (None if request.kind == "brep" else 1e-3)
        numbers = extent(gmsh) / (1.0 if stated is None else stated / 1e-3)
        chosen = choose_unit(numbers, stated, request.given)
        unit = chosen.length if stated is None else chosen.length * 1e-3 / stated
        at(JOINING)
        shape = conforming(gmsh, solids, glue=request.glue)
        filled = sum(abs(gmsh.model.occ.getMass(3, tag)) for tags in shape.solids.values() for tag in tags)
        size, given = request.mesh_size, request.mesh_size is not None
        if size is None:
            area = sum(gmsh.model.occ.getMass(2, tag) for _, tag in gmsh.model.getEntities(2))
            size = coarse_size(filled * unit**3, area * unit**2, extent(gmsh) * unit)
            request = replace(request, mesh_size=size)
        check_mesh_size(filled * unit**3, extent(gmsh) * unit, size)
        (folder / FORESEEN_FILE).write_text(f"{_foreseen(request, filled * unit**3):.0f}", encoding="utf-8")
        at(MESHING)
        _refine(gmsh, request, unit)
        for last in (size,) if given else (size, 0.7 * size, 0.5 * size):
            request = replace(request, mesh_size=last)
            try:
                _mesh(gmsh, shape, request, unit)
                break
            except GeometryError:
                # Walls that a coarse mesh bridges or folds: a first mesh may be finer.
                if given or last < 0.6 * size:
                    raise
                gmsh.model.mesh.clear()
        at("collecting its mesh")
        arrays = _save(folder, collect(gmsh, request.order, shape.faces, shape.solids, unit=unit))
        return {"solids": list(shape.solids), "unit": chosen.length, "remarks": chosen.remarks, "arrays": arrays}


def _size(request: Request) -> float:
    assert request.mesh_size is not None
    return request.mesh_size


def _foreseen(request: Request, volume: float) -> float:
    """Upper estimate of the number of elements in a volume [m³], refined places included."""
    finest = request.place_size if request.places and request.place_size is not None else _size(request)
    return _FILLING * volume / _size(request) ** 3 * (_size(request) / finest) ** 3


def _refine(gmsh: Any, request: Request, unit: float) -> None:
    """Refine the elements in a ball around each place."""
    if request.place_size is None or not request.places:
        return
    field, balls = gmsh.model.mesh.field, []
    for *center, diameter in request.places:
        ball = field.add("Ball")
        for key, value in zip(("XCenter", "YCenter", "ZCenter"), center, strict=True):
            field.setNumber(ball, key, value / unit)
        field.setNumber(ball, "Radius", 0.75 * diameter / unit)
        field.setNumber(ball, "Thickness", _BLEND * _size(request) / unit)
        field.setNumber(ball, "VIn", request.place_size / unit)
        field.setNumber(ball, "VOut", _size(request) / unit)
        balls.append(ball)
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", balls)
    field.setAsBackgroundMesh(least)


def _mesh(gmsh: Any, shape: Shape, request: Request, unit: float) -> None:
    """Mesh the solids; the error names the one that cannot be meshed."""
    smallest = min(_size(request), request.place_size or _size(request)) / unit
    trouble = ""
    try:
        mesh_solids(gmsh, _size(request) / unit, request.order, smallest=smallest)
    except Exception as error:  # gmsh raises bare Exception for every failure of its kernel
        if type(error) is not Exception:
            raise
        trouble = f": {error}"
    empty = [
        name
        for name, tags in shape.solids.items()
        if any(not any(len(found) for found in gmsh.model.mesh.getElements(3, tag)[1]) for tag in tags)
    ]
    if empty or trouble:
        which = ", ".join(repr(name) for name in empty) or "it"
        raise GeometryError(
            f"{which} cannot be meshed with elements of {1e3 * _size(request):.4g} mm{trouble}; "
            "try a smaller mesh_size, and let the CAD program check and heal the solid"
        )


def _save(folder: Path, mesh: Tetrahedra) -> list[str]:
    """Write the arrays of a mesh as ``0.npy`` and on, and return their names in that order."""
    arrays = {"points": mesh.points, "cells": mesh.cells}
    arrays |= {f"surface:{name}": facets for name, facets in mesh.surfaces.items()}
    arrays |= {f"volume:{name}": members for name, members in mesh.volumes.items()}
    for number, array in enumerate(arrays.values()):
        np.save(folder / f"{number}.npy", array, allow_pickle=False)
    return list(arrays)


if __name__ == "__main__":
    end_with(int(sys.argv[2]), Path(sys.argv[1]))
    main(Path(sys.argv[1]))
