"""Shapes are drawn in a process of their own while figures are drawn here; nothing of it outlives an interruption."""

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

import gearwhine as gw
from gearwhine.analyses.result import Result
from gearwhine.drawing_process import draw_in_process, early_pictures, one_process
from gearwhine.housing.errors import RendererUnavailableError
from gearwhine.housing.pictures.drawn_shapes import DrawnHousing, DrawnShape
from gearwhine.housing.pictures.scene import find_renderer
from gearwhine.numerics.progress import silent
from gearwhine.whole_run import WholeRun


def result_of(figures: Callable[[Any], Iterator[tuple[str, Figure]]], files: Callable[..., Mapping[str, Any]]) -> Any:
    return Result("test", None, None, {"warnings": []}, _figures=figures, _files=files)


def test_figures_and_shapes_are_drawn_side_by_side(tmp_path: Path) -> None:
    """Each waits for the other to have begun."""
    shapes, figures = threading.Event(), threading.Event()

    def draw(progress: Any) -> Iterator[tuple[str, Figure]]:
        figures.set()
        assert shapes.wait(20.0)
        yield "curve", Figure()

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        shapes.set()
        assert figures.wait(20.0)
        (place / "shape.txt").write_text("drawn")
        return {"shapes": 1}

    stored = result_of(draw, files).stored(tmp_path / "out")
    assert stored.document["files"] == ["curve.png", "shape.txt"]
    assert stored.document["shapes"] == 1


@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError("no room")])
def test_an_error_among_the_figures_stops_the_shapes(tmp_path: Path, error: BaseException) -> None:
    ended: list[str] = []
    begun = threading.Event()

    def draw(progress: Any) -> Iterator[tuple[str, Figure]]:
        assert begun.wait(20.0)
        raise error
        yield

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        begun.set()
        limit = time.monotonic() + 20.0
        with one_process() as drawing:
            while not drawing._is_stopped and time.monotonic() < limit:
                time.sleep(0.01)
            with pytest.raises(RendererUnavailableError, match="stopped"):
                drawing.answer("nowhere", lambda message, fraction=None: None)
        ended.append("stopped")
        return {}

    with pytest.raises(type(error)):
        result_of(draw, files).stored(tmp_path / "out")
    assert ended == ["stopped"]
    assert not (tmp_path / "out").exists()


def test_an_error_among_the_shapes_is_told(tmp_path: Path) -> None:
    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        raise OSError(28, "No space left on device")

    def draw(progress: Any) -> Iterator[tuple[str, Figure]]:
        yield "curve", Figure()

    with pytest.raises(OSError, match="No space left"):
        result_of(draw, files).stored(tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_early_pictures_are_drawn_while_other_work_goes_on(tmp_path: Path) -> None:
    work, drawn = threading.Event(), threading.Event()

    def draw(name: str, *, place: Path, progress: Any) -> None:
        assert work.wait(20.0)
        (place / f"{name}.png").write_text(name)
        drawn.set()

    with early_pictures() as early:
        early.draw(draw, "mode-01")
        work.set()
        assert drawn.wait(20.0)
        assert early.move_to(tmp_path) == {"mode-01"}
        assert (tmp_path / "mode-01.png").read_text() == "mode-01"
        assert early.move_to(tmp_path) == set()


def test_an_error_among_early_pictures_is_told_where_they_are_taken(tmp_path: Path) -> None:
    def draw(*, place: Path, progress: Any) -> None:
        raise OSError(28, "No space left on device")

    with early_pictures() as early:
        early.draw(draw)
        with pytest.raises(OSError, match="No space left"):
            early.move_to(tmp_path)


def test_early_pictures_end_with_the_work_that_fails() -> None:
    """What is being drawn is stopped, and nothing waits for it."""
    begun = threading.Event()
    stopped: list[str] = []

    def draw(*, place: Path, progress: Any) -> None:
        with one_process() as drawing:
            begun.set()
            limit = time.monotonic() + 20.0
            while not drawing._is_stopped and time.monotonic() < limit:
                time.sleep(0.01)
            assert place.exists()
            stopped.append("stopped" if drawing._is_stopped else "late")

    def fail() -> None:
        with early_pictures() as early:
            early.draw(draw)
            assert begun.wait(20.0)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    assert stopped == ["stopped"]


def test_early_figures_end_with_the_one_in_hand(tmp_path: Path) -> None:
    begun, ended, drawn = threading.Event(), threading.Event(), list[str]()

    def figures() -> Iterator[tuple[str, Figure]]:
        for name in ("first", "second", "third"):
            drawn.append(name)
            begun.set()
            if name == "second":
                assert ended.wait(20.0)
            yield name, Figure()

    with early_pictures() as early:
        early.draw_figures(figures)
        assert begun.wait(20.0)
        threading.Timer(0.2, ended.set).start()
    assert drawn[-1] != "third"
    with early_pictures() as early:
        early.draw_figures(figures)
        assert early.move_to(tmp_path) == {"first", "second", "third"}


@pytest.mark.slow
def test_a_run_that_is_written_twice_has_all_pictures_twice(tmp_path: Path) -> None:
    try:
        find_renderer()
    except RendererUnavailableError as error:
        pytest.skip(str(error))
    changes = {"housing.box.mesh_size": "60 mm", "transient.revolutions": "4", "transient.discard": "2"}
    found = gw.load("small-gearbox", changes).run_into(tmp_path / "first")
    found.stored(tmp_path / "second")
    first, second = ({path.name for path in (tmp_path / name).glob("*.png")} for name in ("first", "second"))
    drawn = ("gears-pinion-wheel-stiffness", "load-shaft-input", "transmissibility-pinion-wheel", "spectrum", "modes")
    assert {f"{name}.png" for name in drawn} <= first
    assert first == second


def test_shapes_that_are_drawn_already_stand_on_the_sheet_as_they_are(tmp_path: Path) -> None:
    try:
        find_renderer()
    except RendererUnavailableError as error:
        pytest.skip(str(error))
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    housing = DrawnHousing(corners, triangles, np.arange(4), (0.0, 1.0, 0.0))
    shapes = [DrawnShape(name, name, "", 0.1 * corners) for name in ("first", "second")]
    Image.new("RGB", (1000, 780), "red").save(tmp_path / "first.png")
    files = draw_in_process(housing, shapes, tmp_path, "png", "iso", silent, sheet="all.png", drawn={"first"})
    assert files == ["second.png", "all.png"]
    with Image.open(tmp_path / "all.png") as sheet:
        assert sheet.size == (1040, 406)
        assert sheet.getpixel((260, 203)) == (255, 0, 0)


def test_a_run_draws_every_figure_once_early_or_late_and_all_for_a_further_folder() -> None:
    def drawer(*kinds: str) -> Callable[..., Iterator[str]]:
        return lambda *given: (f"{kind} of {given[0]}" if len(given) == 2 else kind for kind in kinds)

    early = SimpleNamespace(drawn=[], pictures=[], waited=[])
    early.draw_figures = lambda figures: early.drawn.extend(figures())
    early.wait = lambda: early.waited.append(len(early.drawn))
    solution = SimpleNamespace(
        housing="housing",
        load="load",
        comparison="comparison",
        figures_before_motion=drawer("gears", "load"),
        figures_of_system=drawer("system"),
        figures_of_motion=drawer("motion", "sound"),
        figures=drawer("gears", "load", "system", "motion", "sound"),
    )
    early.draw = lambda draw, housing, *of, **_: early.pictures.append((draw.__name__, housing, of[0]))
    run: Any = SimpleNamespace(solution=solution, study=SimpleNamespace(origin=SimpleNamespace(title="T")))
    run._early, run._has_early_figures = early, False
    WholeRun._draw_early(run)
    assert early.pictures == [("draw_modes", "housing", "comparison"), ("draw_load_pictures", "housing", "load")]
    early.draw_figures(partial(solution.figures_of_system, silent))
    left = list(WholeRun._figures_left(run, silent))
    assert early.waited == [3]
    every = ["gears of T", "load of T", "system", "motion of T", "sound of T"]
    assert [*early.drawn, *left] == every
    assert len(list(WholeRun._figures_left(run, silent))) == len(every)
    # Without a housing there is nothing to draw beside the motion.
    alone: Any = SimpleNamespace(solution=SimpleNamespace(**vars(solution) | {"housing": None}), study=run.study)
    alone._early, alone._has_early_figures = early, False
    WholeRun._draw_early(alone)
    assert (len(early.drawn), alone._has_early_figures) == (3, False)
