"""Designed keys of a case: a point of the unit cube becomes changes of the case, with scatter about it or without."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property

from gearwhine.case import CaseError, CaseSource, Problem, case_document
from gearwhine.case.errors import NOTHING, UNSAID, Refusal, key_of, look_up
from gearwhine.case.optimisation import Optimisation
from gearwhine.case.overrides import matching_places, parse_key_path
from gearwhine.case.units import si_amount, unit_ratio
from gearwhine.case.variation import Variation, Varied
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.distributions import Discrete, Uniform
from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.optimisation.search import Space
from gearwhine.optimisation.verification import Moving
from gearwhine.solve.machine import plan_of
from gearwhine.variation.inputs import Input, Pitches, inputs_of, refusals, varied_inputs
from gearwhine.variation.samples import VariedCase

AS_WRITTEN = -1.0
"""Coordinate of a key that keeps the value of the case."""
_SAME = 1e-9  # part by which a value may differ from one of a list
_MOST_CHECKED = 100  # values of a list that are checked before any design is solved
_TABLE = ("optimisation", "design")


@dataclass(frozen=True)
class DesignInput(Input):
    """A designed quantity; its law is uniform over a range, or discrete.

    Attributes
    ----------
    along : tuple of Input
        Inputs of other keys that change in step with it.
    levels : int
        Number of values of a range that a grid takes.
    """

    along: tuple[Input, ...] = ()
    levels: int = 1

    @property
    def count(self) -> int:
        """Number of discrete values; 0 of a range."""
        return len(self.law.values) if isinstance(self.law, Discrete) else 0

    def overrides(self, coordinate: float) -> Iterator[str]:
        """Yield the ``key.path=value`` of every key at a coordinate; none of one as written."""
        if coordinate != AS_WRITTEN:
            yield from super().overrides(coordinate)
            for one in self.along:
                yield from one.overrides(coordinate)

    def coordinate_of(self, value: object) -> float | None:
        """Return the coordinate of a value of the case; None where it is none of those that the key may have."""
        if self.words:
            number = next((n for n, word in enumerate(self.words) if word == str(value)), None)
            return None if number is None else (number + 0.5) / self.count
        amount, scale = si_amount(value), si_amount(f"1 {self.unit}") if self.unit else 1.0
        if amount is None or scale is None:
            return None
        number_in_unit = amount / scale
        if isinstance(self.law, Uniform):
            at = (number_in_unit - self.law.low) / (self.law.high - self.law.low)
            return min(max(at, 0.0), 1.0) if -_SAME <= at <= 1.0 + _SAME else None
        values = self.law.values if isinstance(self.law, Discrete) else ()
        near = (n for n, one in enumerate(values) if math.isclose(one, number_in_unit, rel_tol=_SAME))
        number = next(near, None)
        return None if number is None else (number + 0.5) / self.count


def space_of(inputs: Sequence[DesignInput]) -> Space:
    """Return the space of the inputs' coordinates."""
    return Space(tuple(one.count for one in inputs))


def design_inputs(
    source: CaseSource, optimisation: Optimisation, refusal: Refusal | None = None
) -> tuple[DesignInput, ...]:
    """Return the inputs of a design, in its order; with a ``refusal`` those without the problems that it keeps.

    Raises
    ------
    CaseError
        With every key that leads nowhere or is no number, and every range that cannot be.
    """
    document = case_document(source.changed_case())
    inputs, refused = list[DesignInput](), Refusal() if refusal is None else refusal
    for key, designed in optimisation.design.items():
        try:
            varied = Varied(
                uniform=designed.range, values=designed.values, factor=designed.factor, independent=designed.independent
            )
            found = inputs_of(source, {key: varied}, _TABLE)
            along = [
                one
                for path, values in designed.along.items()
                for one in inputs_of(source, {path: Varied(values=values)}, (*_TABLE, key, "with"))
            ]
        except CaseError as error:
            refused.add(*(replace(one, key=_as_written(one.key)) for one in error.problems))
            continue
        for one in found:
            values = {field.name: getattr(one, field.name) for field in fields(Input)}
            inputs.append(DesignInput(**values, along=tuple(along), levels=designed.levels))
            written = written_value(document, inputs[-1])
            if designed.range is not None and written is not NOTHING and si_amount(written) is None:
                place = key_of((*_TABLE, key, "range"))
                refused.add(Problem(place, UNSAID, f"a key with a quantity or a number; {key} is {written!r}"))
    taken = dict[str, str]()
    for one in inputs:
        for path in [path for part in (one, *one.along) for path, _ in part.keys]:
            if path in taken:
                expected = f"each key once: {path} is designed by {taken[path]!r}, too"
                refused.add(Problem(key_of((*_TABLE, one.name)), UNSAID, expected))
            taken[path] = one.name
    if refusal is None:
        refused.require_none()
    return tuple(inputs)


def _as_written(key: str) -> str:
    """Return the key of a problem of a distribution as the design has it."""
    return key.removesuffix(".uniform") + ".range" if key.endswith(".uniform") else key


def written_value(document: Mapping[str, object], one: Input) -> object:
    """Return the value that the case has at the first key of an input; `NOTHING` where it has none."""
    place = next(matching_places(document, parse_key_path(one.keys[0][0]) or ()), None)
    return NOTHING if place is None else look_up(document, place)


def start_point(source: CaseSource, inputs: Sequence[DesignInput]) -> list[float | None]:
    """Return the coordinates of the case as it is written; None of a value that the design does not have."""
    document = case_document(source.changed_case())
    points = list[float | None]()
    for one in inputs:
        value, factor = written_value(document, one), one.keys[0][1]
        amount = si_amount(value)
        plain = value if one.words or amount is None or factor == 1.0 else amount / factor
        points.append(None if value is NOTHING else one.coordinate_of(plain))
    return points


@dataclass(frozen=True, eq=False)
class ProposedCase(VariedCase):
    """A case whose designs are evaluated; its points have the coordinates of the design, then those of the scatter.

    A key that is designed and scatters keeps the deviation of a draw from the median, about the designed value; that of
    a tolerance zone lies about it already.

    Attributes
    ----------
    variation : Variation or None
        Scatter about each design.
    """

    variation: Variation | None = None
    _scatter: dict[tuple[float, ...], tuple[tuple[Input, bool], ...]] = field(default_factory=dict, repr=False)

    @property
    def designed(self) -> tuple[DesignInput, ...]:
        """Inputs of the design."""
        return tuple(one for one in self.inputs if isinstance(one, DesignInput))

    @cached_property
    def key(self) -> str:
        """Key of all that the evaluations depend on but their points."""
        return content_key({"designs": super().key, "variation": repr(self.variation)})

    def overrides(self, point: FloatArray) -> list[str]:
        """Return the ``key.path=value`` of a design at a point, or of a gearbox of its scatter."""
        count = len(self.inputs)
        own = [float(at) for at in point[:count]]
        design = [text for one, at in zip(self.inputs, own, strict=True) for text in one.overrides(at)]
        if self.variation is None or all(at == AS_WRITTEN for at in point[count:]):
            return design
        values = {
            path: (factor * one.value(at), one.unit)
            for one, at in zip(self.designed, own, strict=True)
            if at != AS_WRITTEN and not one.words
            for path, factor in one.keys
        }
        scatter = self._scatter_about(tuple(own), design)
        texts = [
            text
            for (one, keeps), at in zip(scatter, point[count:], strict=True)
            for text in _scattered(one, float(at), {} if keeps else values)
        ]
        return [*design, *texts]

    def moving(self, point: FloatArray | None) -> Moving:
        """Return the machine of a design, and how its motion is found."""
        case = self.case(point)
        return self.machine(case), plan_of(case), case.parts.needs_operating_point

    def _scatter_about(self, own: tuple[float, ...], design: Sequence[str]) -> tuple[tuple[Input, bool], ...]:
        """Return the inputs of the scatter about a design, each with whether it lies about the designed value."""
        if own not in self._scatter:
            self._scatter.clear()
            source = replace(self.source, changes=(*self.source.changes, *design))
            self._scatter[own] = tuple(scatter_inputs(source, self.variation or Variation()))
        return self._scatter[own]


def scatter_inputs(source: CaseSource, variation: Variation) -> Iterator[tuple[Input, bool]]:
    """Yield the inputs of a variation, each with whether its distribution lies about the value of the case."""
    zones = {key for key, varied in variation.vary.items() if varied.fit is not None}
    for key in variation.vary:
        part = variation.model_copy(update={"vary": {key: variation.vary[key]}})
        for one in varied_inputs(source, part):
            yield one, key in zones


def _scattered(one: Input, coordinate: float, designed: Mapping[str, tuple[float, str]]) -> Iterator[str]:
    """Yield the ``key.path=value`` of an input of the scatter, about the designed values of its keys."""
    if isinstance(one.law, Pitches) or one.words or not any(path in designed for path, _ in one.keys):
        yield from one.overrides(coordinate)
        return
    value, middle = one.value(coordinate), one.value(0.5)
    for path, factor in one.keys:
        amount = factor * value
        if path in designed:
            number, unit = designed[path]
            amount = number * float(unit_ratio(unit, one.unit) or math.nan) + factor * (value - middle)
        yield f"{path}={one.text(amount)}"


def value_problems(source: CaseSource, inputs: Sequence[DesignInput]) -> Iterator[Problem]:
    """Yield problems of values that their key does not take; see :func:`alone_warnings` of those of other keys."""
    for one in inputs:
        for texts in _tried(one):
            own, _ = refusals(source, texts)
            yield from (replace(problem, source=f"{source.name}: {key_of((*_TABLE, one.name))}") for problem in own)
            if own and not one.count:  # the other end of a range has the same
                break


def alone_warnings(source: CaseSource, inputs: Sequence[DesignInput]) -> Iterator[ResultWarning]:
    """Warn of keys of which no value fits the rest of the case: designs fail unless other keys change with them."""
    for one in inputs:
        tried = [(texts, refusals(source, texts)[1]) for texts in _tried(one)]
        if tried and all(others for _, others in tried):
            texts, others = tried[0]
            message = (
                f"{texts[0]} alone makes no gearbox, nor do the other values tried of {one.name}: {others[0]}; designs "
                "fail where no other key of [optimisation.design], or of 'with', changes as it has to"
            )
            yield warning("values alone", message, key=one.name)


def _tried(one: DesignInput) -> Iterator[list[str]]:
    """Yield the changes by values of a key: of a list all, of a range both ends."""
    places = [(number + 0.5) / one.count for number in range(min(one.count, _MOST_CHECKED))]
    yield from (list(one.overrides(at)) for at in places or (0.0, 1.0))


def require_scatter(inputs: Sequence[DesignInput], source: CaseSource, variation: Variation) -> None:
    """Refuse a scatter of keys whose designed values are words, or that has none to deviate from.

    Raises
    ------
    CaseError
        Of a variation that cannot be, too.
    """
    varied_inputs(source, variation)
    words = {path for one in inputs for part in (one, *one.along) if part.words for path, _ in part.keys}
    expected = "no scatter of {}, which [optimisation.design] takes from a list of words or whole numbers"
    problems = [
        Problem(key_of(("variation", "vary", one.name)), UNSAID, expected.format(path))
        for one, _ in scatter_inputs(source, variation)
        for path, _ in one.keys
        if path in words
    ]
    if problems:
        raise CaseError(problems)
