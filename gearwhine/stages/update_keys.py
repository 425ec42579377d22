"""Parameters of a case's `[update]`: the numbers of the case that each one sets, and their values."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from gearwhine.case import Case, CaseError, Problem, UpdateParameter, case_document, parse_case
from gearwhine.case.box import FACES
from gearwhine.case.overrides import matching_places, parse_key_path
from gearwhine.case.problems import Location, key_of, look_up
from gearwhine.case.units import amount, si_amount
from housing.updating import Parameter

_SPREAD = 1.0 / 3.0  # of the larger distance from the nominal value to an end of the range


@dataclass(frozen=True)
class FittedNumber:
    """A parameter of the case, and the places that it sets.

    Attributes
    ----------
    given : UpdateParameter
    parameter : housing.updating.Parameter
        In SI.
    places : tuple of locations
    own : tuple of float
        Value before the fit, in SI.
    """

    given: UpdateParameter
    parameter: Parameter
    places: tuple[Location, ...]
    own: tuple[float, ...]

    @property
    def start(self) -> float:
        """Its value in the case as it stands."""
        return 1.0 if self.given.factor else self.own[0]

    def as_written(self, value: float) -> float:
        """A value as the updated case has it: five digits in the unit of its range."""
        unit = unit_in_si(self.given)
        return float(f"{value / unit:.5g}") * unit

    def entries(self, value: float) -> Iterator[tuple[Location, float]]:
        """Numbers to set and their places, in SI, for a value."""
        for place, own in zip(self.places, self.own, strict=True):
            yield place, own * value if self.given.factor else value


@dataclass(frozen=True)
class FittedCase:
    """A case whose numbers are fitted: it makes the case of any values.

    Attributes
    ----------
    document : dict
        The case resolved, with a wall of its own for each face.
    numbers : tuple of FittedNumber
    """

    document: dict[str, Any]
    numbers: tuple[FittedNumber, ...]

    def at(self, values: Sequence[float]) -> Case:
        """The case with these values in place.

        Raises
        ------
        CaseError
            Where they make no sound case.
        """
        return parse_case(self.document_at(values), source="update")

    def document_at(self, values: Sequence[float]) -> dict[str, Any]:
        """The same as tables and lists."""
        document = self.document
        for number, value in zip(self.numbers, values, strict=True):
            for place, entry in number.entries(value):
                document = with_entry(document, place, entry)
        return document


def fitted_case(case: Case, mesh_size: float | None = None) -> FittedCase:
    """The parameters of a case, with elements of another size if wanted [m].

    Raises
    ------
    CaseError
        With every key that leads to no number, is set twice, or whose number is outside its range.
    """
    assert case.update is not None
    document = case_document(case)
    box = document.get("housing", {}).get("box")
    if box is not None and not isinstance(box["wall"], Mapping):
        box["wall"] = dict.fromkeys(FACES, box["wall"])
    if box is not None and mesh_size is not None:
        box["mesh_size"] = mesh_size
    problems: list[Problem] = []
    numbers, taken = [], dict[Location, str]()
    for index, given in enumerate(case.update.parameter):
        label = f'parameter "{given.name}"'
        places = list[Location]()
        own = list[float]()
        for position, key in enumerate(given.keys):
            where = f"update.parameter[{index}].keys[{position}]"
            steps = parse_key_path(key)
            found = list(matching_places(document, steps or ()))
            if not found:
                problems.append(Problem(where, key, "the key path of a number in this case", label))
            for place in found:
                value = si_amount(look_up(document, place))
                if value is None:
                    problems.append(Problem(where, key, f"a number; {key_of(place)} is none", label))
                elif place in taken:
                    problems.append(Problem(where, key, f"a key that no other sets ({taken[place]!r} does)", label))
                else:
                    taken[place] = given.name
                    places.append(place)
                    own.append(value)
        if places and len(own) == len(places):
            number = _number(given, tuple(places), tuple(own), index, label, problems)
            numbers += [] if number is None else [number]
    if problems:
        raise CaseError(problems)
    return FittedCase(document, tuple(numbers))


def _number(
    given: UpdateParameter,
    places: tuple[Location, ...],
    own: tuple[float, ...],
    index: int,
    label: str,
    problems: list[Problem],
) -> FittedNumber | None:
    low, high = given.bounds
    start = 1.0 if given.factor else own[0]
    nominal = start if given.nominal is None else amount(given.nominal)
    if not low <= start <= high or not low <= nominal <= high:
        expected = f"a range with the case's own {start:g} in it (SI)"
        problems.append(Problem(f"update.parameter[{index}].range", list(given.range), expected, label))
        return None
    spread = _SPREAD * max(high - nominal, nominal - low) if given.spread is None else amount(given.spread)
    return FittedNumber(given, Parameter(given.name, low, high, nominal, spread), places, own)


def unit_in_si(given: UpdateParameter) -> float:
    """SI value of the unit that a parameter is written in."""
    return amount(f"1 {given.unit}") if given.unit else 1.0


def with_entry(document: Any, place: Location, value: Any) -> Any:
    """Tables and lists with one entry replaced; what is not on the way to it is shared."""
    if not place:
        return value
    step, *rest = place
    copy = document.copy()
    copy[step] = with_entry(document[step], tuple(rest), value)
    return copy
