"""Shapes are drawn in a process of their own while figures are drawn here; nothing of it outlives an interruption."""

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from gearwhine.analyses.result import Result
from gearwhine.drawing_process import one_process
from gearwhine.housing.errors import RendererUnavailableError


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
