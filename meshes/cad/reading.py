"""CAD meshing: solids of STEP, IGES and BREP files to a mesh of tetrahedra, in a worker process with time limits."""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from gearwhine.meshes.cad.shape import stated_unit
from gearwhine.meshes.cad.worker import FORESEEN_FILE, JOINING, MESHING, READING, SPENT_FILE, STARTING, Request
from gearwhine.meshes.errors import GeometryError, MesherUnavailableError, MeshSizeError
from gearwhine.meshes.gmsh_meshing import Tetrahedra, check_mesh_request
from gearwhine.meshes.mesh import Mesh

_LONGEST_READING = 3600.0  # seconds for a file in all
# Seconds to read and join solids, and more by the byte: a sound file of 20 kB takes a tenth of a second, a damaged one
# may keep the kernel busy for ever.
_READING, _READING_PER_BYTE = 5.0, 3e-4
# Seconds to mesh them, and more by the element that is foreseen: gmsh makes some ten thousand of them a second.
_MESHING, _MESHING_PER_ELEMENT = 6.0, 2e-3
_LOOK = 0.2  # seconds between looks at the worker

KINDS = {".step": "step", ".stp": "step", ".iges": "iges", ".igs": "iges", ".brep": "brep"}
"""Kind of file by its ending."""


@dataclass(frozen=True)
class CadMesh:
    """The mesh of a CAD file, and the names and unit of the file.

    Attributes
    ----------
    mesh : Mesh
        Solids under their own names as volumes; faces that carry a name in the file as surfaces.
    solids : tuple of str
        Names of the solids; those without are ``solid-1`` and so on.
    unit : float
        Unit of the file's numbers [m].
    remarks : tuple of str
        Remarks for the user, such as a unit that contradicts the file's own.
    """

    mesh: Mesh
    solids: tuple[str, ...]
    unit: float
    remarks: tuple[str, ...]


def mesh_cad(
    path: str | Path,
    mesh_size: float | None,
    *,
    unit: float | None = None,
    glue: bool = True,
    order: int = 2,
    refine: Sequence[tuple[tuple[float, float, float], float]] = (),
    refined_size: float | None = None,
    time_limit: float | None = None,
) -> CadMesh:
    """Mesh the solids of a CAD file with tetrahedra.

    Parameters
    ----------
    path : path
        A STEP, IGES or BREP file.
    mesh_size : float or None
        Edge length aimed at [m]; None for a coarse one by the thickness of the walls.
    unit : float, optional
        Unit of the file's numbers [m], where it states none itself (BREP; default a millimetre). What a STEP or
        IGES file states holds, unless the part would then be no housing by its size and is one in this unit.
    glue : bool
        Whether solids share their nodes where they touch, as one piece; else they are apart until joints tie them.
    order : {1, 2}
        Polynomial order of the elements.
    refine : sequence of (center, diameter)
        Bores around which the elements are to be smaller [m].
    refined_size : float, optional
        Edge length aimed at around these bores [m].
    time_limit : float, optional
        Seconds after which the attempt is given up, meshing included; by default an hour. Reading and joining
        the solids is given five seconds of processor time and five minutes for each megabyte of the file, meshing six
        seconds and two for each thousand elements foreseen.

    Raises
    ------
    MeshSizeError
        See :func:`gearwhine.meshes.check_mesh_size`.
    GeometryError
        Where the file is missing, of another kind, broken, without a solid, in a mistaken unit, or where a solid
        cannot be meshed.
    MesherUnavailableError
        Where gmsh cannot be loaded.
    """
    check_mesh_request(mesh_size, order)
    if refined_size is not None and (mesh_size is None or not 0.0 < refined_size <= mesh_size):
        raise GeometryError(f"refined mesh size {refined_size} m must be positive and at most {mesh_size} m")
    path = Path(path)
    kind = KINDS.get(path.suffix.lower())
    if kind is None:
        raise GeometryError(f"CAD file {path}: its ending is none of {' '.join(KINDS)}")
    try:
        stated = stated_unit(path, kind)
    except OSError as error:
        raise GeometryError(f"CAD file {path} cannot be read: {error.strerror or error}") from error
    places = [(*center, diameter) for center, diameter in refine]
    request = Request(str(path.resolve()), kind, mesh_size, order, stated, unit, glue, places, refined_size)
    with tempfile.TemporaryDirectory(prefix="gearwhine-cad-") as name:
        folder = Path(name)
        (folder / "request.json").write_text(json.dumps(asdict(request)), encoding="utf-8")
        longest = _LONGEST_READING if time_limit is None else time_limit
        _work(folder, path, min(_reading_limit(path), longest), longest)
        answer = json.loads((folder / "answer.json").read_text(encoding="utf-8"))
        if "unavailable" in answer:
            raise MesherUnavailableError(answer["unavailable"])
        if "size" in answer:
            raise MeshSizeError(f"CAD file {path}: {answer['size']}")
        if "error" in answer:
            raise GeometryError(f"CAD file {path}: {answer['error']}")
        mesh = _load(folder, answer["arrays"]).mesh()
    return CadMesh(mesh, tuple(answer["solids"]), answer["unit"], tuple(answer["remarks"]))


def _reading_limit(path: Path) -> float:
    """Seconds in which the solids of a file of this size are to be read and joined."""
    return min(_READING + _READING_PER_BYTE * path.stat().st_size, _LONGEST_READING)


def _work(folder: Path, path: Path, reading_limit: float, time_limit: float) -> None:
    """Run the worker on the request in a folder, and make sure that it answered."""
    room = Path(__file__).resolve().parents[2]
    search = os.pathsep.join(part for part in (str(room), os.environ.get("PYTHONPATH", "")) if part)
    with subprocess.Popen(
        [sys.executable, "-m", "gearwhine.meshes.cad.worker", str(folder), str(os.getpid())],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": search},
    ) as worker:
        try:
            errors = _errors_of(worker, folder, reading_limit, time_limit)
        except subprocess.TimeoutExpired as error:
            raise GeometryError(
                f"CAD file {path}: given up after {error.timeout:.0f} s while {_stage(folder)}; "
                "a larger mesh_size, or a simpler or healed solid, may help"
            ) from error
        finally:
            worker.kill()
    if (folder / "answer.json").is_file():
        return
    if worker.returncode < 0:
        raise GeometryError(
            f"CAD file {path}: the CAD kernel broke down (signal {-worker.returncode}) while {_stage(folder)}; "
            "the file is damaged: export it anew"
        )
    last = errors.decode(errors="replace").strip().rpartition("\n")[2]
    raise GeometryError(f"CAD file {path}: the CAD kernel failed while {_stage(folder)}: {last}")


def _errors_of(worker: subprocess.Popen[bytes], folder: Path, reading_limit: float, time_limit: float) -> bytes:
    """Return the error output of a worker that ends within the time limits, each stage timed from its beginning.

    Stages are given processor time, so that what else runs on the machine does not matter.
    """
    begin = time.monotonic()
    since = dict[str, float]()
    while True:
        try:
            return worker.communicate(timeout=_LOOK)[1]
        except subprocess.TimeoutExpired as error:
            now, stage = _number(folder / SPENT_FILE), _stage(folder)
            # Reading and joining count as one stage.
            spent = now - since.setdefault(READING if stage == JOINING else stage, now)
            limit = {READING: reading_limit, JOINING: reading_limit, MESHING: _meshing_limit(folder)}.get(
                stage, _LONGEST_READING
            )
            if time.monotonic() - begin > time_limit or spent > limit:
                raise subprocess.TimeoutExpired(error.cmd, min(limit, time_limit)) from error


def _meshing_limit(folder: Path) -> float:
    """Seconds in which the elements that the worker foresees are to be made."""
    return min(_MESHING + _MESHING_PER_ELEMENT * _number(folder / FORESEEN_FILE), _LONGEST_READING)


def _number(path: Path) -> float:
    """Return the number in a file of the worker, which may be there before its number is; 0 without one."""
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    return float(text) if text.strip() else 0.0


def _stage(folder: Path) -> str:
    stage = folder / "stage"
    return stage.read_text(encoding="utf-8") if stage.is_file() else STARTING


def _load(folder: Path, names: list[str]) -> Tetrahedra:
    """Load the mesh from the arrays that the worker wrote, in the order of their names."""
    arrays = {name: np.load(folder / f"{number}.npy", allow_pickle=False) for number, name in enumerate(names)}
    return Tetrahedra(
        points=arrays["points"],
        cells=arrays["cells"],
        surfaces={name.removeprefix("surface:"): a for name, a in arrays.items() if name.startswith("surface:")},
        volumes={name.removeprefix("volume:"): a for name, a in arrays.items() if name.startswith("volume:")},
    )
