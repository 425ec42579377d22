"""The housing's mesh, examined: what makes it useless is an error of the case, what is doubtful a warning."""

from typing import Any

import numpy as np

from gearwhine.case import Case, CaseError, Problem
from gearwhine.case.problems import UNSAID
from gearwhine.stages.regions import materials_of
from meshes import Ailment, Mesh, WaveCarrier, diagnose, read_mesh, resolution_ailments

_HERTZ = 2.0 * np.pi
UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
"""Units of length of geometry files [m]."""


def examine(case: Case, mesh: Mesh) -> tuple[Ailment, ...]:
    """Doubts about the mesh of a case.

    Bodies that touch without being joined are wrong unless the case has joints, which may be what joins them.

    Raises
    ------
    CaseError
        Where it is wrong; with everything that is, at once.
    """
    given = case.housing
    assert given is not None
    source = given.mesh or given.cad
    found = diagnose(mesh, unit=None if source is None else UNITS[source.unit])
    meant = {"disconnected"} if given.joint else set()
    wrong = [one for one in found if one.severity == "error" and one.name not in meant]
    if wrong:
        key = "housing.mesh.file" if given.mesh else "housing.cad.file" if given.cad else "housing.box"
        value: object = UNSAID if source is None else str(source.file)
        raise CaseError([Problem(key, value, f"a sound mesh; {one.name}: {one.message}") for one in wrong])
    return tuple(one for one in found if one.name not in meant)


def doubt_resolution(case: Case, mesh: Mesh, limit_hz: float | None) -> tuple[Ailment, ...]:
    """Doubts about the size of the elements, for modes up to a frequency; without one, about their kind alone."""
    # Without a limit, one so low that no element is too large for it.
    return resolution_ailments(mesh, _wave(case, limit_hz if limit_hz else 1e-6))


def _wave(case: Case, limit_hz: float) -> WaveCarrier:
    assert case.housing is not None
    given = case.material[case.housing.material]
    return WaveCarrier(given.youngs_modulus, given.poisson_ratio, given.density, _HERTZ * limit_hz)


def foresee(case: Case) -> dict[str, Any]:
    """What can be said of the mesh before anything is solved: of a file all, of a box whether its elements will do.

    Raises
    ------
    CaseError, meshes.GeometryError
        Where the file cannot be read, or its mesh is wrong.
    """
    given = case.housing
    assert given is not None
    if given.mesh is not None:
        mesh = read_mesh(given.mesh.file, unit=UNITS[given.mesh.unit])
        materials_of(case, mesh)
        warnings = examine(case, mesh) + doubt_resolution(case, mesh, given.frequency_limit)
        return {
            "mesh": {"nodes": len(mesh.points), "elements": mesh.n_elements, "dofs": 3 * len(mesh.points)},
            "kinds": mesh.kinds,
            "surfaces": sorted(mesh.surfaces),
            "volumes": sorted(mesh.volumes),
            "size_m": np.ptp(mesh.bounds, axis=0).tolist(),
            "warnings": warnings_document(warnings),
        }
    if given.box is None or given.frequency_limit is None:
        return {"warnings": []}
    walls = given.box.walls
    thinnest = min(walls.left, walls.right, walls.bottom, walls.top, walls.back, walls.front)
    length = _wave(case, given.frequency_limit).shortest_wave(thinnest)
    if given.box.mesh_size <= length / 3.0:
        return {"warnings": []}
    message = (
        f"elements of {1e3 * given.box.mesh_size:.3g} mm are longer than 1/3 of the shortest wave, "
        f"{1e3 * length:.3g} mm at {given.frequency_limit:.4g} Hz in the wall of {1e3 * thinnest:.3g} mm; modes near "
        f"that frequency come out too high: use a mesh_size of at most {1e3 * length / 3.0:.3g} mm"
    )
    return {"warnings": [{"name": "size", "message": message}]}


def warnings_document(ailments: tuple[Ailment, ...]) -> list[dict[str, Any]]:
    """Doubts as the command's JSON."""
    return [
        {"name": one.name, "message": one.message, "count": one.count, "place_m": one.place.tolist()}
        for one in ailments
    ]
