"""Housing modes kept in the results folder, and read again in place of solving where the housing is unchanged.

Modes are known again by the content of what they were solved from: the whole ``[housing]`` of the case but for the keys
that do not enter the modes, the materials it names, the places of the bearings for which the modes have attachments,
the content of its files, and the versions and source of the code.
A new key of the housing therefore counts until somebody says that it does not.
"""

import hashlib
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gearwhine
import housing as room
import meshes
from gearwhine.case import Case
from gearwhine.stages.housing_checks import bearing_places

if TYPE_CHECKING:
    from gearwhine.stages.housing import SolvedHousing

MODES_FILE = "modes.nc"

# Keys of [housing] that change no mode: damping is laid on the modes, sensors are put on the kept mesh afresh.
_WITHOUT_EFFECT = frozenset({"damping_ratio", "sensor"})
_LIBRARIES = ("gmsh", "numpy", "scipy", "scikit-fem", "rslab", "pypardiso")


def solution_inputs(case: Case, mesh: meshes.Mesh | None = None) -> dict[str, Any]:
    """What the modes of a case's housing are solved from; its content key is that of the modes.

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
    files = {str(path): _file_content(path) for path in _paths(given.model_dump())}
    if given.mesh is not None and mesh is not None:
        files[str(given.mesh.file)] = {"mesh": room.mesh_digest(mesh)}
    bearings = {name: list(place) for name, place in bearing_places(case).items()}
    written = given.model_dump(mode="json", by_alias=True, exclude_none=True, exclude=set(_WITHOUT_EFFECT))
    named = _texts(written)
    return {
        "housing": _with_contents(written, files),
        "bearings": bearings,
        "material": {name: one.model_dump(mode="json") for name, one in case.material.items() if name in named},
        "versions": {"gearwhine": gearwhine.__version__} | {name: _installed(name) for name in _LIBRARIES},
        "source": _source_digest(),
    }


def find_modes(folder: Path, inputs: Mapping[str, Any]) -> tuple[room.ModeRecord | None, str | None]:
    """The kept modes of these inputs, or None; and a warning where a file is there but cannot be used."""
    path = folder / MODES_FILE
    if not path.exists():
        return None, None
    try:
        record = room.read_modes(path)
    except room.ModeFileError as error:
        return None, f"{error}; the modes are solved again"
    return (record if record.key == room.content_key(inputs) else None), None


def keep_modes(place: Path, solved: "SolvedHousing") -> None:
    """Write a solved housing's modes, unless the file that they were read from holds them, sensors and all."""
    if not solved.source_holds:
        room.write_modes(place / MODES_FILE, solved.record)


def _paths(value: Any) -> set[Path]:
    """Every file that a table names, however deep."""
    if isinstance(value, Path):
        return {value}
    return set().union(*(_paths(inner) for inner in _inner(value)))


def _texts(value: Any) -> set[str]:
    """Every text in a table, however deep: the names of its materials are among them."""
    if isinstance(value, str):
        return {value}
    return set().union(*(_texts(inner) for inner in _inner(value)))


def _inner(value: Any) -> list[Any]:
    if isinstance(value, Mapping):
        return list(value.values())
    return list(value) if isinstance(value, list | tuple) else []


def _with_contents(value: Any, files: Mapping[str, Any]) -> Any:
    """The same table with each file's content in place of its name."""
    if isinstance(value, Mapping):
        return {key: _with_contents(inner, files) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_with_contents(inner, files) for inner in value]
    return files.get(value, value) if isinstance(value, str) else value


def _file_content(path: Path) -> dict[str, str]:
    """A file's bytes, and the ending by which its reader is chosen."""
    with path.open("rb") as file:
        return {"sha256": hashlib.file_digest(file, "sha256").hexdigest(), "ending": path.suffix.lower()}


def _installed(library: str) -> str | None:
    try:
        return version(library)
    except PackageNotFoundError:
        return None


def _source_digest() -> str:
    """SHA-256 of the code between case and modes, which changes between releases under one version number.

    Whole rooms count, what does not bear on modes too: that costs a solution now and then, and forgets nothing.
    """
    total = hashlib.sha256()
    for package in (meshes.__file__, room.__file__, gearwhine.__file__):
        folder = Path(package).parent
        for path in sorted(folder.rglob("*.py")):
            total.update(f"{path.relative_to(folder.parent).as_posix()}\0".encode())
            total.update(path.read_bytes())
    return total.hexdigest()
