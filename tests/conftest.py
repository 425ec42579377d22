"""Shared by all tests: blocks of all elements, published values beside ours with their page, what runs first."""

import gc
import json
import logging
import os
import pickle
from base64 import b64decode
from collections import OrderedDict, defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from hashlib import sha256
from itertools import combinations_with_replacement
from math import floor, log10
from pathlib import Path
from tempfile import NamedTemporaryFile, TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import settings
from hypothesis.internal.conjecture import providers

from gearwhine.meshes import ElementBlock, Mesh
from gearwhine.meshes.elements import KINDS, ElementKind

# The same examples in every run, however slow the machine; `--hypothesis-profile=explore` looks for new ones.
settings.register_profile("fixed", deadline=None, derandomize=True, max_examples=50)
settings.register_profile("explore", deadline=None)
settings.load_profile("fixed")
# Examples would have numbers of the source of whatever modules are loaded by then, which take seconds to read.
providers.is_local_module_file = lambda path: False

Published = Callable[..., None]
BlockOf = Callable[..., Mesh]

_SHARED = "GEARWHINE_SOLVED_BY_TESTS"
_VALUE = "published value"
_REMARK = "remark on a source"
_HEAD = """\
# Validation

Published values beside ours, as the tests in `tests/validation` met them. Each value has a tolerance of its own,
absolute (in the value's unit) or relative (in per cent): the digits printed, or the source's own scatter. A test fails
beyond it, and nothing is written then. `make validation` writes this page and the values, `docs/validation.json`, which
`make docs` sets below.
"""


class Row(NamedTuple):
    """A published value and ours; the tolerance is relative where that is how it was given."""

    source: str
    quantity: str
    value: float
    ours: float
    unit: str
    tolerance: float
    relative: bool

    @property
    def difference(self) -> float:
        """Ours less the published value, in the terms of the tolerance."""
        return (self.ours - self.value) / (abs(self.value) if self.relative else 1.0)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--validation-table",
        metavar="FILE",
        help="write sources and remarks to a Markdown file, and the published values beside ours to JSON of its name",
    )


# Files and folders that take long, the longest first.
_LONG = (
    "end_to_end/test_pages_with_commands.py",
    "validation/test_nasa_rig.py",
    "end_to_end/test_sweep_command.py",
    "gearwhine/solve/sound/test_sound.py",
    "gearwhine/solve/sensitivity",
    "end_to_end/test_interruption_in_phases.py",
    "gearwhine/detection",
    "validation",
    "end_to_end",
    "examples",
    "property",
    "housing",
)


def pytest_configure(config: pytest.Config) -> None:
    # xdist would begin with the files of many tests, and those of few and long ones would keep one process at the end.
    config.option.loadscopereorder = False
    # As in the command: the garbage collector looks less often at objects that stay.
    gc.set_threshold(20_000, 20, 20)
    if not hasattr(config, "workerinput"):
        folder = TemporaryDirectory(prefix="solved-by-tests-")
        os.environ[_SHARED] = folder.name  # which the processes of the run inherit
        config.add_cleanup(folder.cleanup)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Do not import files without slow tests where these alone are run."""
    if config.option.markexpr == "slow" and collection_path.suffix == ".py":
        return b"mark.slow" not in collection_path.read_bytes() or None
    return None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with long files, so that processes that share the files end together."""
    tests = Path(__file__).parent

    @cache
    def turn(file: Path) -> int:
        name = file.relative_to(tests).as_posix() if file.is_relative_to(tests) else ""
        return next((place for place, long in enumerate(_LONG) if name.startswith(long)), len(_LONG))

    items.sort(key=lambda item: turn(item.path))


def pytest_collection_finish() -> None:
    # Modules and thousands of items stay to the end: the garbage collector need not look at them again and again.
    gc.collect()
    gc.freeze()


@pytest.fixture
def published(record_property: Callable[[str, object], None]) -> Published:
    """Compare our value with a published one, and keep the row for the validation table.

    ``published(source, quantity, value, ours, unit, rel=...)`` or ``abs=...`` fails where they differ by more. A
    relative tolerance has no absolute floor, unlike that of ``pytest.approx``, whose 1e-12 is vast beside a tooth's
    compliance in m/N.
    """

    def compare(
        source: str,
        quantity: str,
        value: float,
        ours: float,
        unit: str = "",
        *,
        rel: float | None = None,
        abs: float | None = None,  # noqa: A002 - as in pytest.approx
    ) -> None:
        if (rel is None) == (abs is None):
            raise TypeError(f"{source}: {quantity} needs one tolerance, rel or abs")
        tolerance = rel if abs is None else abs
        if tolerance <= 0.0 or (rel is not None and value == 0.0):
            raise ValueError(f"{source}: {quantity} = {value} needs a tolerance above zero, got rel={rel}, abs={abs}")
        record_property(_VALUE, [source, quantity, float(value), float(ours), unit, tolerance, abs is None])
        assert ours == pytest.approx(value, rel=rel or 0.0, abs=abs or 0.0), f"{source}: {quantity}"

    return compare


@pytest.fixture
def remark(record_property: Callable[[str, object], None]) -> Callable[[str, str], None]:
    """Keep what a reader of the validation table must know of a source: ``remark(source, text)``."""
    return lambda source, text: record_property(_REMARK, [source, text])


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    target = terminalreporter.config.getoption("--validation-table")
    if not target:
        return
    if terminalreporter.stats.get("failed") or terminalreporter.stats.get("error"):
        terminalreporter.write_line(f"{target} not written: a table without the failures would mislead")
        return
    rows: dict[str, list[Row]] = defaultdict(list)
    remarks: dict[str, list[str]] = defaultdict(list)
    # In the order of the files, whichever process was first.
    for report in sorted(
        terminalreporter.stats.get("passed", []), key=lambda report: (*report.location[:2], report.nodeid)
    ):
        for key, kept in report.user_properties:
            if key == _VALUE:
                row = Row(*kept)
                rows[row.source].append(row)
            elif key == _REMARK and kept[1] not in remarks[kept[0]]:
                remarks[kept[0]].append(kept[1])
    Path(target).write_text(_page(rows, remarks), encoding="utf-8")
    Path(target).with_suffix(".json").write_text(_values(rows), encoding="utf-8")
    terminalreporter.write_line(f"{sum(map(len, rows.values()))} published values written to {target}")


def _page(rows: dict[str, list[Row]], remarks: dict[str, list[str]]) -> str:
    lines = [_HEAD, "| source | values | largest part of its tolerance that a value takes |", "|---|---:|---:|"]
    for source, group in _sorted(rows):
        worst = max(abs(row.difference) / row.tolerance for row in group)
        lines.append(f"| {source} | {len(group)} | {100 * worst:.0f} % |")
    lines += ["", "## Remarks on sources", ""]
    for source, _ in _sorted(rows):
        if remarks[source]:
            lines.append("\n\n".join([f"**{source}**", *remarks[source]]) + "\n")
    return "\n".join([*lines, "## Values", "", "<!-- values -->", ""])


def _sorted(rows: dict[str, list[Row]]) -> list[tuple[str, list[Row]]]:
    return sorted(rows.items(), key=lambda section: section[0].casefold())


def _values(rows: dict[str, list[Row]]) -> str:
    """JSON of the cells of each value by source, a line for each value."""
    sources = []
    for source, group in _sorted(rows):
        lines = ",\n".join(f"   {json.dumps(_cells(row), ensure_ascii=False)}" for row in group)
        sources.append(f" {json.dumps(source, ensure_ascii=False)}: [\n{lines}\n ]")
    return "{\n" + ",\n".join(sources) + "\n}\n"


def _cells(row: Row) -> list[str]:
    """Quantity, published value, ours, unit, difference and tolerance."""
    allowed = row.tolerance * abs(row.value) if row.relative else row.tolerance
    decimals = max(0, 1 - floor(log10(allowed)))
    ours = f"{row.ours:.0f}" if row.ours.is_integer() else f"{row.ours:.{decimals}f}"
    value = f"{round(row.value, decimals + 2):.12g}"
    scale, sign = (100.0, " %") if row.relative else (1.0, "")
    difference, tolerance = f"{scale * row.difference:+.2g}{sign}", f"±{scale * row.tolerance:.2g}{sign}"
    return [row.quantity, value, ours, row.unit, difference, tolerance]


_KEPT_HERE = 20  # shapes of modes take memory

# A single white point, in place of a rendered figure.
_POINT = b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGP4DwABAQEAsTj2FAAAAABJRU5ErkJggg==")


@pytest.fixture(scope="module")
def unrendered(request: pytest.FixtureRequest) -> Iterator[None]:
    """Build the figures of a module's results and leave files of one point each: to render them takes long.

    A module marked ``rendered`` is of the pictures, and has them as users do.
    """
    if request.node.get_closest_marker("rendered"):
        yield
        return
    from matplotlib.figure import Figure

    from gearwhine import drawing_process

    def shapes_unrendered(
        housing: Any, shapes: Any, folder: Path, *_: Any, sheet: str | None = None, drawn: Any = (), **__: Any
    ) -> list[str]:
        names = [f"{shape.name}.png" for shape in shapes if shape.name not in drawn]
        names += [] if sheet is None else [sheet]
        for name in names:
            (folder / name).write_bytes(_POINT)
        return names

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "savefig", lambda figure, path, **how: Path(path).write_bytes(_POINT))
        patch.setattr(drawing_process, "draw_in_process", shapes_unrendered)
        yield


@pytest.fixture(scope="module")
def mechanisms_left_out() -> Iterator[None]:
    """Do not find each mechanism's part of a line, a fifth of a run and more where carriers turn.

    What is told of them is in `tests/gearwhine/solve/test_line_mechanisms_told.py`.
    """
    from gearwhine.analyses import machine_results

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(machine_results, "add_mechanisms", lambda *_: None)
        yield


@pytest.fixture(scope="module")
def few_points() -> Iterator[None]:
    """Solve responses at a quarter of the points between resonances, and those to unbalance at as few speeds."""
    from gearwhine.coupling.analyses import modes_and_responses
    from gearwhine.coupling.linear import frequency_response

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(frequency_response, "_EVEN_POINTS", 150)
        patch.setattr(modes_and_responses, "_UNBALANCE_STEPS", 50)
        yield


@pytest.fixture(scope="module")
def few_slices() -> Iterator[None]:
    """Cut faces of gears into 15 slices, a quarter of what is usual: for machines with many pairs, of whole teeth."""
    from gearwhine.coupling.gears.contact import contact_law, face_slices
    from gearwhine.coupling.gears.loaded import gear_pair
    from gearwhine.coupling.machine import face_compliance

    with pytest.MonkeyPatch.context() as patch:
        for module in (contact_law, face_slices, gear_pair):
            patch.setattr(module, "DEFAULT_SLICES", 15)
        patch.setattr(face_compliance, "_EVEN_FACE_PLACES", 2.0 * (np.arange(15) + 0.5) / 15.0 - 1.0)
        yield


_RUNNING = {"slow": False}


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Know in fixtures of a session whether a slow test is running."""
    _RUNNING["slow"] = item.get_closest_marker("slow") is not None


@pytest.fixture(scope="session")
def texts_read_back() -> Iterator[None]:
    """Hold texts and curves of the results of fast tests against their numbers, see ``numbers_of_texts.py``."""
    from numbers_of_texts import numbers_held

    with numbers_held(lambda: not _RUNNING["slow"]):
        yield


@pytest.fixture(scope="module")
def swept_here() -> Iterator[None]:
    """Solve the points of a sweep in a thread of this process, not in one of its own, which takes seconds to start.

    Processes, how they start, die and are interrupted, are in ``tests/end_to_end/test_sweep_command.py``.
    """
    from distributed import Client, LocalCluster

    from gearwhine import workers

    @contextmanager
    def thread(number: int, scratch: str, plugins: Any) -> Iterator[Client]:
        threads = {"processes": False, "n_workers": number, "threads_per_worker": 1}
        # A port that nobody else has, as in the product: two processes of the suite may sweep at once.
        threads |= {"dashboard_address": "127.0.0.1:0", "scheduler_kwargs": {"dashboard": False}}
        with (
            LocalCluster(**threads, local_directory=scratch, silence_logs=logging.CRITICAL) as cluster,
            Client(cluster, set_as_default=False) as client,
        ):
            yield client

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(workers, "_own_processes", thread)
        yield


class Kept:
    """What a run of the tests has solved: in a folder that its processes share, the last of it here."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._last = folder, OrderedDict[str, Any]()

    def once(self, key: str, solve: Callable[[], Any], *, shared: bool = True) -> Any:
        """What was found for a key, by any process of the run where it is shared, or else is solved now."""
        path = self._folder / key
        if key not in self._last:
            if path.exists():
                self._last[key] = pickle.loads(path.read_bytes())  # noqa: S301 - of this run
            else:
                self._last[key] = solve()
                if shared:
                    with NamedTemporaryFile(dir=self._folder, delete=False) as file:
                        pickle.dump(self._last[key], file)
                    Path(file.name).replace(path)
            if len(self._last) > _KEPT_HERE:
                self._last.popitem(last=False)
        self._last.move_to_end(key)
        return self._last[key]


@pytest.fixture(scope="session")
def kept() -> Kept:
    """What the processes of this run have solved."""
    return Kept(Path(os.environ[_SHARED]))


@pytest.fixture(scope="module")
def modes_solved_once(kept: Kept) -> Iterator[None]:
    """Mesh a housing, and solve its modes, once for the cases of a run that differ in the rest.

    The key of modes is that of those which a results folder keeps. What the solution says of its progress is said
    again.
    """
    from gearwhine.from_case import mesh
    from gearwhine.housing.storage.netcdf import content_key
    from gearwhine.solve import housing_modes

    solve, mesh_box, mesh_cad = housing_modes._solve_modes, mesh.mesh_box, mesh.mesh_cad

    def solved(given: Any, described: Any, defects: Any, progress: Any) -> Any:
        nodes = described.mesh.points.tobytes().hex()

        def told() -> Any:
            said: list[str] = []
            known = solve(given, described, defects, said.append)
            return known.record, known.seconds, said

        key = content_key({"inputs": given.cache_inputs(described.mesh), "nodes": nodes})
        record, seconds, said = kept.once(f"modes-{key}", told)
        for text in said:
            progress(text)
        return replace(housing_modes._of_record(given, described, record), seconds=seconds)

    def box(*of: Any, **how: Any) -> Any:
        key = sha256(pickle.dumps((of, how))).hexdigest()
        return kept.once(f"box-{key}", lambda: mesh_box(*of, **how))

    def cad(path: Path, *of: Any, **how: Any) -> Any:
        key = sha256(path.read_bytes() + pickle.dumps((path.suffix, of, how))).hexdigest()
        return kept.once(f"cad-{key}", lambda: mesh_cad(path, *of, **how))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(housing_modes, "_solve_modes", solved)
        patch.setattr(mesh, "mesh_box", box)
        patch.setattr(mesh, "mesh_cad", cad)
        yield


@pytest.fixture(scope="module")
def periodic_motions_found_once(kept: Kept) -> Iterator[None]:
    """Find the periodic motion of a machine once for the cases of a process that differ in the rest.

    The key has every number that the search takes: matrices, contacts, period, segments, elements, start and tolerance.
    At ten megabytes each motions are not shared by processes.
    """
    from gearwhine.coupling.periodic import shooting
    from gearwhine.coupling.time.transient import fingerprint

    search, refine = shooting._search, shooting.refined

    def once(solve: Callable[[], Any], ready: Any, *more: Any) -> Any:
        coarsest = shooting.coarsest_element(ready.system, ready.period)
        key = fingerprint(ready.part, ready.contacts, ready.recovery, ready.period, ready.segments, coarsest, more)
        return kept.once(f"motion-{key}", solve, shared=False)

    def searched(ready: Any, level: int, state: Any) -> Any:
        return once(lambda: search(ready, level, state), ready, "search", level, state)

    def refined(ready: Any, motion: Any, level: int, tolerance: float, steps: int, *, near: bool = False) -> Any:
        more = motion.start, level, tolerance, steps, near
        found = once(lambda: refine(ready, motion, level, tolerance, steps, near=near), ready, "refine", *more)
        return replace(found, system=ready.system)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(shooting, "_search", searched)
        patch.setattr(shooting, "refined", refined)
        yield


@pytest.fixture(scope="module")
def reliefs_found_once(kept: Kept) -> Iterator[None]:
    """Search the best relief of a pair of gears once for the cases of a run that differ in the rest."""
    from gearwhine.coupling.analyses import gear_pairs
    from gearwhine.coupling.gears.loaded import optimal_relief

    search = gear_pairs.optimal_tip_relief

    def found(*of: Any, tried: Any, **how: Any) -> Any:
        key = sha256(pickle.dumps((of, how, optimal_relief._GRID, optimal_relief._MOST_REFINED))).hexdigest()
        tried(0.0)  # as a search begins
        return kept.once(f"relief-{key}", lambda: search(*of, tried=tried, **how))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(gear_pairs, "optimal_tip_relief", found)
        yield


@pytest.fixture(scope="module")
def few_reliefs_tried() -> Iterator[None]:
    """Try so few reliefs that the best of them says nothing: for tests that only have it searched."""
    from gearwhine.coupling.gears.loaded import optimal_relief

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(optimal_relief, "_GRID", 3)
        patch.setattr(optimal_relief, "_MOST_REFINED", 10)
        yield


@pytest.fixture(scope="module")
def solved_once(modes_solved_once: None, periodic_motions_found_once: None, reliefs_found_once: None) -> None:
    """Solve no housing, motion or relief of a case again that another test of this run has solved."""


@pytest.fixture(scope="session")
def block_of() -> BlockOf:
    """``block_of(kind, size, cells, bend)``: a block from the origin, of one kind of solid element.

    Bricks in a grid, each cut into two wedges or six tetrahedra where the kind asks for it, the cut the same in all, so
    that faces match. ``bend`` maps the nodes, middle ones too, so that edges become curved. Nothing here uses the
    package's own shape functions: middle nodes are means of corners.
    """
    return _block_of


# Of a brick's corners in VTK's order: both wedges along z, and three tetrahedra in each wedge.
_WEDGES = [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]]
_TETRAHEDRA = [[0, 1, 2, 6], [0, 5, 1, 6], [0, 4, 5, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6]]
_CUTS = {"hexahedron": [list(range(8))], "wedge": _WEDGES, "tetra": _TETRAHEDRA}


def _block_of(
    kind: str,
    size: tuple[float, float, float] = (1.0, 1.0, 1.0),
    cells: tuple[int, int, int] = (1, 1, 1),
    bend: Callable[[npt.NDArray[np.float64]], npt.NDArray[np.float64]] = lambda points: points,
) -> Mesh:
    of = KINDS[kind]
    brick = np.array(KINDS["hexahedron"].places)
    grid = np.stack(np.meshgrid(*map(np.arange, cells), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    corners = (grid + brick)[:, _CUTS[of.corners]].reshape(-1, of.n_corners, 3)
    ends = _ends(of)
    nodes = np.stack([corners[:, pair].mean(axis=1) for pair in ends], axis=1)
    lattice, inverse = np.unique(np.round(4 * nodes).astype(int).reshape(-1, 3), axis=0, return_inverse=True)
    points = bend(lattice / 4 * np.array(size) / np.array(cells))
    return Mesh(points, (ElementBlock(kind, inverse.reshape(len(corners), -1)),))


@cache
def _ends(of: ElementKind) -> list[list[int]]:
    """Two corners whose mean each node is, the same one twice where it is a corner: in a regular grid all are such."""
    corners = np.array(KINDS[of.corners].places)
    pairs = np.array(list(combinations_with_replacement(range(len(corners)), 2)))
    off = np.abs(corners[pairs].mean(axis=1) - np.array(of.places)[:, None]).max(axis=2)
    assert (off.min(axis=1) < 1e-12).all()
    return [list(map(int, pairs[chosen])) for chosen in off.argmin(axis=1)]
