"""Sweep points: the case with each combination of the swept values, checked before anything is solved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

from gearwhine.case import SPEED_KEY, Case, CaseError, CaseSource, Problem, SweptKey, require
from gearwhine.from_case.given_housing import given_housing, housing_key
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.output import file_stems
from gearwhine.solutions import case_content, solution_key

_WITHOUT_EFFECT = frozenset(
    {
        "title",
        "notes",
        "sweep",
        "rotor_analysis",
        "measured",
        "variation",
        "detection",
        "optimisation",
        "provenance",
    }
)
"""Tables that no transient depends on."""


@dataclass(frozen=True)
class GridPoint:
    """One combination of the swept values.

    Attributes
    ----------
    place : tuple of int
        Index along each swept key.
    texts : tuple of str
        Value of each swept key, as ``--set`` takes it.
    speed : float
        Signed speed of the first driver [rad/s].
    file : str
        Name of its file; empty where it is not on file.
    """

    place: tuple[int, ...]
    texts: tuple[str, ...]
    speed: float
    file: str


@dataclass(frozen=True)
class Point(GridPoint):
    """One combination of the swept values of a case.

    Attributes
    ----------
    case : Case
        Case with these values.
    key : str
        Key of the content that its result depends on: case, files, libraries and our code.
    modes_key : str or None
        Key of the inputs of its housing's modes; None without a housing.
    housing_key : str or None
        Key of all that its machine takes of the housing, with damping and sensors.
    duration : float
        Duration of its transient [s].
    refusal : str
        Why the case with these values is no machine; empty for one that can be solved. ``case`` is then that of the
        sweep.
    """

    case: Case
    key: str
    modes_key: str | None
    housing_key: str | None
    duration: float
    refusal: str = ""


def sweep_points(source: CaseSource, keys: Sequence[SweptKey]) -> tuple[Point, ...]:
    """Return every point of the grid, the last key fastest.

    A combination of values that makes an impossible machine, such as gears that overlap, is refused by itself, and the
    grid goes on. A value that its own key does not take is an error.

    Parameters
    ----------
    source : CaseSource
        The case, as it was read.
    keys : sequence of SweptKey
        Keys of :func:`gearwhine.case.swept_keys`.

    Raises
    ------
    CaseError
        With the problems of all points, each once, where a value is wrong by itself or no point can be solved.
    """
    grid = list(product(*(range(len(key.texts)) for key in keys)))
    stems = file_stems([_described(keys, place) for place in grid])
    points, problems, wrong = list[Point](), dict[Problem, None](), False
    for place, stem in zip(grid, stems, strict=True):
        overrides = [override for key, index in zip(keys, place, strict=True) for override in key.overrides[index]]
        try:
            case = source.changed(overrides).case
            require(case, "rotor", "operation", "transient", command="sweep")
            refusal = ""
        except CaseError as error:
            problems_of_sweep = [_of_the_sweep(problem, overrides) for problem in error.problems]
            wrong = wrong or any(
                one.source != before.source for one, before in zip(problems_of_sweep, error.problems, strict=True)
            )
            problems |= dict.fromkeys(problems_of_sweep)
            # Stands for the refused case where a point must have one.
            case, refusal = source.changed([]).case, "; ".join(map(str, problems_of_sweep))
        texts = tuple(key.texts[index] for key, index in zip(keys, place, strict=True))
        points.append(replace(_point(place, texts, case, stem), refusal=refusal))
    if wrong or all(point.refusal for point in points):
        raise CaseError(problems)
    return tuple(points)


def axis_name(key: str) -> str:
    """Return a swept key as a dimension's name: ``speed`` for the speed, else letters, digits and underscores."""
    if key == SPEED_KEY:
        return "speed"
    return "_".join("".join(letter if letter.isalnum() else " " for letter in key).split())


def _point(place: tuple[int, ...], texts: tuple[str, ...], case: Case, stem: str) -> Point:
    assert case.transient is not None
    assert case.operation is not None
    key, speed = solution_key(case=case_content(case, _WITHOUT_EFFECT)), case.operation.speed
    given = None if case.housing is None else given_housing(case)
    modes_key = None if given is None else content_key(given.cache_inputs())
    whole = None if given is None else housing_key(given)
    duration = case.transient.build().duration(2.0 * math.pi / abs(speed))
    return Point(place, texts, speed, f"{stem}-{key[:12]}.nc", case, key, modes_key, whole, duration)


def _described(keys: Sequence[SweptKey], place: tuple[int, ...]) -> str:
    return "_".join(f"{axis_name(key.key)}-{key.texts[index]}" for key, index in zip(keys, place, strict=True))


def _of_the_sweep(problem: Problem, overrides: Sequence[str]) -> Problem:
    """Return a problem with a swept value as a problem of the sweep."""
    text = problem.source.removeprefix("--set ")
    return replace(problem, source=f"sweep, {text}") if text in overrides else problem
