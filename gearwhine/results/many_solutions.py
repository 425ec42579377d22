"""Studies of many gearboxes or designs: quantities and sentences of those that failed, which all of them have."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.output.quantity import Quantity, Rows, in_file
from gearwhine.output.sections import Document

_MOST_FAILURES = 5  # told one by one


def failed_solutions(first: int = 0) -> Rows:
    """Declare the solutions that failed by their number in the study, which counts from ``first``."""
    return Rows(
        "failed",
        lambda study: list(study.failures.items()),
        (
            Quantity("number", lambda row: first + row[0]),
            Quantity("message", "1.message"),
            Quantity("traceback", lambda row: row[1].traceback or None, optional=True),
        ),
    )


def finite(value: float) -> float | None:
    """Return a number; None in place of NaN and infinity."""
    return value if np.isfinite(value) else None


def numbered(dimension: str, count: Callable[[Any], int], long_name: str, first: int = 0) -> tuple[Quantity, Quantity]:
    """Declare the numbers of a study's solutions from ``first``, and why there is no result, for the file."""

    def failures(study: Any) -> list[str]:
        return [study.failures[n].message if n in study.failures else "" for n in range(count(study))]

    return (
        in_file(dimension, dimension, lambda study: first + np.arange(count(study)), long_name),
        in_file("failure", dimension, failures, "why there is no result"),
    )


def failed_warnings(study: Any, total: int, name: str, nouns: str) -> Iterator[ResultWarning]:
    """Yield the warning of that name that some of all solutions failed, with the reason of the first."""
    if failed := len(study.failures):
        message = f"{failed} of {total} {nouns} cannot be solved: {next(iter(study.failures.values())).message}"
        yield warning(name, message, failed=failed)


def failed_sentences(document: Document, noun: str) -> Iterator[str]:
    """Yield a sentence on each of the first solutions that failed, and the number of the others."""
    for failure in document["failed"][:_MOST_FAILURES]:
        yield f"{noun.capitalize()} {failure['number']} failed: {failure['message']}"
    if len(document["failed"]) > _MOST_FAILURES:
        yield f"and {len(document['failed']) - _MOST_FAILURES} more"


def ending(document: Document) -> str:
    """Return how many solutions an earlier run had found, and how many failed, as the end of a sentence."""
    resumed = f", {document['resumed']} of them by an earlier run" if document["resumed"] else ""
    return resumed + (f"; {len(document['failed'])} failed" if document["failed"] else "")
