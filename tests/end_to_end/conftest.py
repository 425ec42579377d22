"""Runs of the real command, in this process or in one of its own; figures are rendered where a test is of them."""

import importlib.util
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import xarray as xr

import gearwhine as gw
from gearwhine.cli import run_command
from gearwhine.from_case import mesh
from gearwhine.meshes.gmsh_meshing import gmsh_session


@pytest.fixture(scope="module", autouse=True)
def _figures_unrendered(unrendered: None) -> None:
    """Render no figures, but in a module marked ``rendered``."""


@pytest.fixture(scope="module", autouse=True)
def _less_effort(request: pytest.FixtureRequest) -> None:
    """Find no mechanism's part of a line, and few points of responses, but in a module marked ``rendered``."""
    if not request.node.get_closest_marker("rendered"):
        request.getfixturevalue("mechanisms_left_out")
        request.getfixturevalue("few_points")


@pytest.fixture(scope="module", autouse=True)
def _texts_read_back(texts_read_back: None) -> None:
    """Hold the numbers in the texts of every result against its document."""


@pytest.fixture(scope="module", autouse=True)
def _solved_once(solved_once: None) -> None:
    """Solve nothing again that another test has solved."""


@pytest.fixture
def linear_drawings(monkeypatch: pytest.MonkeyPatch) -> None:
    """Mesh drawings by linear tetrahedra: their bolts, not the size of elements, say how many there are."""
    mesh_cad = mesh.mesh_cad
    monkeypatch.setattr(mesh, "mesh_cad", lambda *drawing, **how: mesh_cad(*drawing, **how | {"order": 1}))


@pytest.fixture
def drawing_script(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], ModuleType]:
    """``drawing_script(name)``: a module of `scripts`, which draws the housing of a bundled case."""
    scripts = Path(__file__).parents[2] / "scripts"
    monkeypatch.syspath_prepend(scripts)

    def load(name: str) -> ModuleType:
        spec = importlib.util.spec_from_file_location(name, scripts / f"{name}.py")
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, name, module)
        spec.loader.exec_module(module)
        return module

    return load


@pytest.fixture
def solid_measures() -> Callable[[Path], list[float]]:
    """``solid_measures(path)``: volume [mm³] and bounds [mm] of the only solid of a drawing."""

    def measure(path: Path) -> list[float]:
        with gmsh_session("file") as gmsh:
            ((dimension, tag),) = gmsh.model.occ.importShapes(str(path))
            gmsh.model.occ.synchronize()
            return [gmsh.model.occ.getMass(dimension, tag), *gmsh.model.getBoundingBox(dimension, tag)]

    return measure


@dataclass(frozen=True)
class Outcome:
    """What a run of the command left."""

    code: int
    out: str
    err: str

    @property
    def document(self) -> Any:
        return json.loads(self.out)


Command = Callable[..., Outcome]


@pytest.fixture
def gearwhine(capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Command:
    """The command in this process, with an empty working folder."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> Outcome:
        capfd.readouterr()
        code = run_command(list(arguments))
        captured = capfd.readouterr()
        return Outcome(code, captured.out, captured.err)

    return run


@pytest.fixture
def solved_rotor(gearwhine: Command, _answers: dict[tuple[str, ...], Outcome]) -> Callable[..., dict[str, Any]]:
    """``solved_rotor(case, *settings)``: the one rotor of a case in the document of the command ``rotors``."""

    def solve(case: str, *settings: str) -> dict[str, Any]:
        changes = [part for setting in settings for part in ("--set", setting)]
        file = Path(case)
        key = ("rotors of", file.read_text(encoding="utf-8") if file.is_file() else case, *settings)
        if key not in _answers:
            _answers[key] = gearwhine("rotors", case, "--json", "-q", *changes)
        outcome = _answers[key]
        assert outcome.code == 0, outcome.err
        (rotor,) = outcome.document["rotors"]
        return rotor

    return solve


@pytest.fixture
def rotor_curves() -> Callable[..., xr.Dataset]:
    """``rotor_curves(case, *settings)``: the arrays of the same, where its curves stand."""

    def solve(case: str, *settings: str) -> xr.Dataset:
        return gw.load(case, list(settings)).rotors().dataset

    return solve


@pytest.fixture(scope="session")
def _answers() -> dict[tuple[str, ...], Outcome]:
    return {}


@pytest.fixture
def answer(gearwhine: Command, _answers: dict[tuple[str, ...], Outcome]) -> Command:
    """The command where nothing but its answer counts: what was asked before, by any test, is not solved again."""

    def ask(*arguments: str) -> Outcome:
        assert not {"-o", "--output"} & set(arguments), "an answer from before leaves no files"
        if arguments not in _answers:
            _answers[arguments] = gearwhine(*arguments)
        return _answers[arguments]

    return ask


@pytest.fixture
def start_process(tmp_path: Path) -> Callable[..., "subprocess.Popen[str]"]:
    """The command as a process of its own, in an empty working folder."""
    root = Path(__file__).parent.parent.parent
    environment = os.environ | {"PYTHONPATH": str(root)}
    # Tests that a shell runs in the background ignore Ctrl-C, and so would the command, which they send it to.
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)

    def start(*arguments: str) -> "subprocess.Popen[str]":
        return subprocess.Popen(
            [sys.executable, "-m", "gearwhine", *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=tmp_path,
            env=environment,
        )

    return start
