"""Mode cache: housing modes in the results folder, read again while the housing is unchanged.

Modes are known again by the content of what they were solved from: the whole ``[housing]`` of the case but for the keys
that do not enter the modes, the materials it names, the places of the bearings for which the modes have attachments,
the content of its files, and the versions and source of the code.
A new key of the housing therefore counts until somebody says that it does not.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import gearwhine
import housing as room
import meshes
from gearwhine.case import Case
from gearwhine.stages.contents import file_contents, installed, source_digest, texts_in, with_contents
from gearwhine.stages.housing_checks import bearing_places

MODE_CACHE_FILE = "modes.nc"

# Keys of [housing] that change no mode: damping is laid on the modes, sensors are put on the kept mesh afresh.
_WITHOUT_EFFECT = frozenset({"damping_ratio", "sensor"})
_LIBRARIES = ("gmsh", "numpy", "scipy", "scikit-fem", "rslab", "pypardiso")


def mode_cache_inputs(case: Case, mesh: meshes.Mesh | None = None) -> dict[str, Any]:
    """Inputs of a case's housing modes; their content key is that of the modes.

    Parameters
    ----------
    case : Case
        With a housing.
    mesh : Mesh, optional
        The mesh of ``[housing.mesh]``: it counts as it was read, so that neither the file's name nor its format
        matters, and what a file refers to does.
    """
    given = case.housing
    assert given is not None
    files = file_contents(given.model_dump())
    if given.mesh is not None and mesh is not None:
        files[str(given.mesh.file)] = {"mesh": room.mesh_digest(mesh)}
    bearings = {name: list(place) for name, place in bearing_places(case).items()}
    written = given.model_dump(mode="json", by_alias=True, exclude_none=True, exclude=set(_WITHOUT_EFFECT))
    named = texts_in(written)
    return {
        "housing": with_contents(written, files),
        "bearings": bearings,
        "attachment_orders": room.RESPONSE_ORDERS,
        "material": {name: one.model_dump(mode="json") for name, one in case.material.items() if name in named},
        "versions": {"gearwhine": gearwhine.__version__} | {name: installed(name) for name in _LIBRARIES},
        "source": source_digest(meshes, room, gearwhine),
    }


def read_mode_cache(folder: Path, inputs: Mapping[str, Any]) -> tuple[room.ModeRecord | None, str | None]:
    """Cached modes of these inputs, or None; and a warning where the file cannot be used."""
    path = folder / MODE_CACHE_FILE
    if not path.exists():
        return None, None
    try:
        record = room.read_modes(path)
    except room.ModeFileError as error:
        return None, f"{error}; the modes are solved again"
    return (record if record.key == room.content_key(inputs) else None), None
