"""Solutions of a study of many: the key of what they depend on, the failure in place of one, how many are done."""

from __future__ import annotations

import time
import traceback
from collections.abc import Container
from dataclasses import dataclass, replace
from typing import Any

import gearwhine
from gearwhine.case import Case, CaseError, case_document
from gearwhine.failures import explain
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.numerics.progress import Progress
from gearwhine.numerics.source_digest import installed
from gearwhine.output.files import with_contents
from gearwhine.workers import OtherCodeError, code_digest

_LIBRARIES = ("gmsh", "numpy", "scipy", "scikit-fem", "numba")
_MINUTE, _HOUR = 60.0, 3600.0
_REPORTED_EACH = 2.0  # least time between two reports of progress [s]


@dataclass(frozen=True)
class Failure:
    """A solution that there is not.

    Attributes
    ----------
    message : str
        Sentence on the failure, with a remedy where one is known.
    traceback : str
        Traceback of an unexpected error; empty otherwise.
    """

    message: str
    traceback: str = ""


def failure_of(error: Exception) -> Failure:
    """Return the failure of a solution by its error, with the traceback of an unexpected one."""
    if isinstance(error, CaseError):
        return Failure("; ".join(str(replace(problem, source="")) for problem in error.problems))
    _, message = explain(error)
    if message is None and not isinstance(error, OtherCodeError):
        return Failure(f"unexpected {type(error).__name__}: {error}", "".join(traceback.format_exception(error)))
    return Failure(message or str(error))


def case_content(case: Case, unread: Container[str]) -> dict[str, Any]:
    """Return the content of a case and of its files, without the tables that a solution does not depend on."""
    document = {name: table for name, table in case_document(case).items() if name not in unread}
    content: dict[str, Any] = with_contents(document, case.input_files.contents)
    return content


def solution_key(**content: Any) -> str:
    """Return the key of all that a solution depends on: its content, libraries and our code."""
    return content_key(
        {
            "versions": {"gearwhine": gearwhine.__version__} | {name: installed(name) for name in _LIBRARIES},
            "source": code_digest(),
            **content,
        }
    )


def duration(seconds: float) -> str:
    """Return a time in words: ``45 s``, ``12 min``, ``3.4 h``."""
    if seconds < 1.5 * _MINUTE:
        return f"{seconds:.0f} s"
    return f"{seconds / _MINUTE:.0f} min" if seconds < 1.5 * _HOUR else f"{seconds / _HOUR:.1f} h"


class StudyProgress:
    """Progress of a study of many solutions: how many are done, and how long the others will take.

    Parameters
    ----------
    progress : callable
    nouns : str
        What the solutions are of: ``"gearboxes"``.
    total : int
    before : int
        Number of those that an earlier run had found.
    """

    def __init__(self, progress: Progress, nouns: str, total: int, before: int = 0) -> None:
        self._progress, self._nouns, self._total, self._before = progress, nouns, total, before
        self._start, self._reported = time.perf_counter(), -_REPORTED_EACH

    def report(self, done: int, news: str = "") -> None:
        """Report the number of solutions that are done, with news of them, where the last report is old enough."""
        passed = time.perf_counter() - self._start
        if passed - self._reported < _REPORTED_EACH and done < self._total:
            return
        self._reported = passed
        left = passed * (self._total - done) / max(done - self._before, 1)
        remaining = f", about {duration(left)} left" if left >= 1.0 and done > self._before else ""
        self._progress(f"{self._nouns}: {done} of {self._total}{news}{remaining}", done / self._total)
