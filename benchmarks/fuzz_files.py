"""Sound files of every format that a command reads, for `fuzz.py` to damage."""

import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import meshio
import numpy as np

from gearwhine.housing import measured
from gearwhine.meshes.gmsh_meshing import gmsh_session
from gearwhine.rotors import write_ross

Files = dict[str, bytes]

STEEL = """
title = "A block"
[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
"""
HOUSING = STEEL + '[housing]\nmaterial = "steel"\nmodes = 4\n'
COARSE = ("--set", "housing.box.mesh_size=60 mm")


def readable_files(folder: Path, formats: Sequence[str] = ()) -> Iterator[tuple[str, Files, str, list[str]]]:
    """For each format its name, all files of a folder, which of them to damage, and the command to run there.

    Where formats are given, those alone: of CAD, meshes and surveys, which are made in a moment.
    """
    made = folder / "sound"
    made.mkdir(exist_ok=True)
    sources = (_geometry, _surveys) if formats else (_geometry, _surveys, _tables, _ours)
    for source in sources:
        for one in source(made):
            if not formats or one[0] in formats:
                yield one


def _geometry(made: Path) -> Iterator[tuple[str, Files, str, list[str]]]:
    """A block with a bore, as CAD and as meshes."""
    with gmsh_session("the block") as gmsh:
        block = gmsh.model.occ.addBox(0.0, 0.0, 0.0, 200.0, 100.0, 100.0)
        bore = gmsh.model.occ.addCylinder(100.0, 50.0, -10.0, 0.0, 0.0, 120.0, 20.0)
        gmsh.model.occ.cut([(3, block)], [(3, bore)])
        gmsh.model.occ.synchronize()
        for ending in ("step", "iges", "brep"):
            gmsh.write(str(made / f"block.{ending}"))
        gmsh.option.setNumber("Mesh.MeshSizeMax", 40.0)
        gmsh.model.mesh.generate(3)
        gmsh.write(str(made / "block.msh"))
        tags, points, _ = gmsh.model.mesh.getNodes()
        _, nodes = gmsh.model.mesh.getElementsByType(4)
    order = np.argsort(tags)
    cells = np.searchsorted(tags[order], nodes.reshape(-1, 4))
    mesh = meshio.Mesh(points.reshape(-1, 3)[order], [("tetra", cells)])
    endings = ["step", "iges", "brep", "msh"]
    for ending in ("vtu", "vtk", "inp", "bdf", "med"):
        meshio.write(made / f"block.{ending}", mesh)
        endings.append(ending)
    for ending in endings:
        name = f"block.{ending}"
        table = 'cad]\nmesh_size = "50 mm"' if ending in ("step", "iges", "brep") else 'mesh]\nunit = "mm"'
        case = f'{HOUSING}[housing.{table}\nfile = "{name}"\n'
        yield ending, {name: (made / name).read_bytes(), "case.toml": case.encode()}, name, ["mesh", "case.toml", "-q"]


def _surveys(made: Path) -> Iterator[tuple[str, Files, str, list[str]]]:
    """Measured modes as a universal file and as a table."""
    random = np.random.default_rng(0)
    geometry = measured.MeasuredGeometry(
        tuple("1234"), 0.1 * random.normal(size=(4, 3)), np.repeat(np.arange(4), 3), np.tile(np.eye(3), (4, 1)), ()
    )
    shapes = random.normal(size=(3, 12)) + 0j
    modes = measured.MeasuredModes(2.0 * np.pi * np.array([500.0, 700.0, 900.0]), np.full(3, 0.01), shapes, geometry)
    case = HOUSING + '[housing.box]\nsize = ["0.2 m", "0.1 m", "0.1 m"]\nwall = "10 mm"\nmesh_size = "40 mm"\n'
    for name in ("survey.unv", "survey.csv"):
        measured.write_survey(made / name, measured.SurveyData(geometry, modes, None))
        files = {name: (made / name).read_bytes(), "case.toml": f'{case}[measured]\nfile = "{name}"\n'.encode()}
        yield name.partition(".")[2], files, name, ["check", "case.toml", "-q"]


def _tables(made: Path) -> Iterator[tuple[str, Files, str, list[str]]]:
    """A mesh stiffness over a period, and a rotor as ROSS saves it."""
    from gearwhine.case import dump_case, load_case

    pair = load_case("gear-62-62", ["gear_pair.0.stiffness={ model = 'square', value = '3e8 N/m' }"]).case
    table = "\n".join(f"{position:.3f},{3e8 * (1.5 - position):.6g}" for position in np.linspace(0.0, 1.0, 11))
    text = dump_case(pair).replace('model = "square"', 'model = "table"')
    text = "\n".join(line for line in text.splitlines() if not line.startswith("value ="))
    text = text.replace('model = "table"', 'model = "table"\nfile = "stiffness.csv"')
    files = {"stiffness.csv": table.encode(), "case.toml": text.encode()}
    yield "stiffness table", files, "stiffness.csv", ["gears", "case.toml", "-q"]
    case = load_case("friswell-rotor").case
    write_ross(made / "shaft.toml", case.parts.rotors[0], case.parts.bearings_on(case.rotor[0].name))
    yield "ROSS", {"shaft.toml": (made / "shaft.toml").read_bytes()}, "shaft.toml", ["rotors", "shaft.toml", "-q"]


def _ours(made: Path) -> Iterator[tuple[str, Files, str, list[str]]]:
    """What commands leave for the next one: modes, points of a sweep, blocks of an interrupted march."""
    modes = ["modes", "steel-box", "-q", "-o", "out", *COARSE]
    _ran(made / "modes", modes)
    yield "modes", _all(made / "modes"), "out/modes.nc", modes
    short = ("--set", "transient.revolutions=3", "--set", "transient.discard=1")
    sweep = ["sweep", "spur-pair", "-q", "-o", "out", *short, "--set", "sweep.speed=['3000 rpm', '3600 rpm']"]
    _ran(made / "sweep", sweep)
    files = _all(made / "sweep")
    yield "sweep point", files, next(name for name in sorted(files) if "points" in name), sweep
    few = ("--set", "transient.revolutions=60", "--set", "transient.discard=0", "--no-pictures")
    march = ["run", "spur-pair", "-q", "-o", "out", *few]
    files = _interrupted(made / "march", march)
    blocks = [name for name in sorted(files) if "block" in name]
    if blocks:
        yield "block of a march", files, blocks[len(blocks) // 2], march


def _ran(folder: Path, arguments: list[str]) -> None:
    folder.mkdir(exist_ok=True)
    subprocess.run([sys.executable, "-m", "gearwhine", *arguments], cwd=folder, check=True, capture_output=True)


def _interrupted(folder: Path, arguments: list[str]) -> Files:
    """What a run leaves that is killed behind some blocks of its march."""
    folder.mkdir(exist_ok=True)
    command = [sys.executable, "-m", "gearwhine", *arguments]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as child:
        while child.poll() is None and len(list(folder.rglob("block-*.npz"))) < 3:
            time.sleep(0.01)
        child.send_signal(signal.SIGKILL)
    return _all(folder)


def _all(folder: Path) -> Files:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
