"""Pytest plugin that records which lines of the product each test file runs: pytest -p traced_lines

One line of JSON for each test file is appended to the file ``TRACED_LINES``, so that a run which is interrupted goes on
where it was. Only Python's lines are seen: what compiled kernels and other processes run is not. A line is recorded for
the first file that runs it for a fixture of the whole session.
"""

import json
import os
import sys
import threading
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import pytest

ROOMS = ("numerics", "meshes", "housing", "rotors", "coupling", "gearwhine")
_ROOT = Path(__file__).parent.parent
_EVENTS = 2000  # of one function in one test file, after which it is watched no longer: what it has not run is rare


class LinesOfFiles:
    """Lines of each product file that ran since :meth:`begin`; functions all of whose lines ran cost nothing more."""

    def __init__(self) -> None:
        self.files: dict[str, str] = {}
        self.begin()

    def begin(self) -> None:
        """Forget what ran."""
        self.left: dict[int, int] = {}  # events that a function may still cause, by the id of its code
        self.seen: dict[int, tuple[CodeType, set[int]]] = {}

    def product_file(self, name: str) -> str:
        """Path of a product file below the checkout, through no link; empty for another file."""
        if name not in self.files:
            path = Path(os.path.realpath(name))
            within = path.is_relative_to(_ROOT) and path.relative_to(_ROOT).parts[0] in ROOMS
            self.files[name] = str(path.relative_to(_ROOT)) if within else ""
        return self.files[name]

    def on_call(self, frame: FrameType, event: str, argument: Any) -> Any:
        """Trace function of `sys.settrace`: watch the lines of a function of the product."""
        code = frame.f_code
        key = id(code)
        if key not in self.left:
            watched = code.co_name != "<module>" and self.product_file(code.co_filename)
            self.left[key] = _EVENTS if watched else 0
            self.seen[key] = code, set()
        return self.on_line if self.left[key] > 0 else None

    def on_line(self, frame: FrameType, event: str, argument: Any) -> Any:
        """Trace function of a frame."""
        key = id(frame.f_code)
        if event == "line" and key in self.seen:
            self.seen[key][1].add(frame.f_lineno)
            self.left[key] -= 1
            if self.left[key] <= 0:
                frame.f_trace_lines = False
        return self.on_line

    def lines(self) -> dict[str, list[int]]:
        """Return the lines that ran, by product file."""
        found: dict[str, set[int]] = defaultdict(set)
        for code, lines in self.seen.values():
            if lines:
                found[self.product_file(code.co_filename)] |= lines
        return {name: sorted(lines) for name, lines in sorted(found.items())}


_TRACED = LinesOfFiles()
_SECONDS: defaultdict[str, float] = defaultdict(float)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> Iterator[None]:
    """Trace a test, and write down what its file ran when it was the file's last."""
    threading.settrace(_TRACED.on_call)
    sys.settrace(_TRACED.on_call)
    try:
        return (yield)
    finally:
        sys.settrace(None)
        threading.settrace(None)  # type: ignore[arg-type]
        if nextitem is None or nextitem.path != item.path:
            name = str(item.path.relative_to(_ROOT))
            entry = {"test": name, "seconds": round(_SECONDS[name], 2), "lines": _TRACED.lines()}
            with Path(os.environ["TRACED_LINES"]).open("a", encoding="utf-8") as target:
                target.write(json.dumps(entry) + "\n")
            _TRACED.begin()


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Add up how long the tests of a file take, their fixtures included."""
    _SECONDS[report.location[0]] += report.duration
