"""Errors of a REXS file: what is wrong, at which component, and what was expected."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field


class _Unsaid:
    """Value that a message leaves out."""

    def __repr__(self) -> str:
        return "nothing"


UNSAID = _Unsaid()
"""Value that a message leaves out: no single value is at fault."""


@dataclass(frozen=True)
class RexsProblem:
    """One thing wrong in a REXS file.

    Attributes
    ----------
    place : str
        Component with its attribute, relation, line or file, such as ``shaft 12 "input": rotational_speed``.
    expected : str
        Expected value, to be read after "expected".
    value
        Value there; :data:`UNSAID` where no single value is at fault.
    """

    place: str
    expected: str
    value: object = field(default=UNSAID, hash=False)


class RexsError(ValueError):
    """A REXS file cannot be read, or describes no gear unit that a case can hold.

    Attributes
    ----------
    problems : tuple of RexsProblem
    """

    def __init__(self, problems: Iterable[RexsProblem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(_sentence(problem) for problem in self.problems))


def wrong(place: str, expected: str, value: object = UNSAID) -> RexsError:
    """Return the error of one problem."""
    return RexsError([RexsProblem(place, expected, value)])


def _sentence(problem: RexsProblem) -> str:
    got = "" if problem.value is UNSAID else f", got {str(problem.value)[:80]!r}"
    return f"{problem.place}: expected {problem.expected}{got}"
