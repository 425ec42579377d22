"""Samples of a varied case, their solution, and the record that keeps each of them as it is found.

The record is a file of JSON lines, one for each sample, which is only ever appended to: whatever ends the study, the
samples that were found before are in it, and the study goes on from there.
"""

from __future__ import annotations

import gc
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np

from gearwhine.case import Case, CaseSource
from gearwhine.coupling import Machine
from gearwhine.coupling.linear.tracked_modes import ObservedModes
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.from_case.given_housing import given_housing, housing_key
from gearwhine.from_case.machine import describe_machine
from gearwhine.from_case.reduced_housing import reduced_component
from gearwhine.housing import HousingModes
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.result_warnings import ResultWarning
from gearwhine.solutions import Failure, case_content, failure_of, solution_key
from gearwhine.solve.acoustics import acoustics_of
from gearwhine.solve.housing_modes import solve_housing, with_modes_of
from gearwhine.solve.machine import load_of_case, plan_of, reduce_housing, solve_pairs
from gearwhine.solve.radiated_power import radiated_power_of
from gearwhine.variation.inputs import Input, Wider, inputs_at
from gearwhine.variation.quantities import UNDER_LOAD, Evaluation, Wanted, evaluate, evaluate_pairs, modes_of
from gearwhine.workers import require_same_code

if TYPE_CHECKING:  # with kernels of its own
    from gearwhine.coupling.sweep.line_sound import RadiatedPower

_REMARKS = frozenset({"title", "notes", "provenance"})
_KEPT_HOUSINGS = 50  # kilobytes each
FOLDER = "samples"
"""Folder of the record within the results folder."""


Outcome = Evaluation | Failure


def outcome_of(find: Callable[[], Evaluation]) -> Outcome:
    """Return what a function finds of a sample, or its error as a failure."""
    try:
        return find()
    except Exception as error:
        return failure_of(error)


_Housing: TypeAlias = "tuple[HousingComponent, RadiatedPower | None]"


@dataclass(frozen=True, eq=False)
class VariedCase:
    """A case, its varied inputs, and what is found of each sample.

    Attributes
    ----------
    source : CaseSource
        Content that the case is made of, without its variation.
    inputs : tuple of Input
    wanted : Wanted
    solved : HousingModes or None
        Solved housing of the case without changes, whose modes serve samples of other damping and sensors; None
        without one.
    housing : HousingComponent or None
        The same, reduced.
    housing_key : str
        Key of all that a machine takes of this housing; samples of another key have a housing of their own.
    wider : sequence of (Input or None)
        See :func:`gearwhine.variation.inputs.inputs_at`.
    radiated : RadiatedPower or None
        Radiation of this housing, where the sound is wanted.
    housings : dict of str to tuple
        Last housings of other samples with their radiation by their key, so that samples with the same walls share one.
    """

    source: CaseSource
    inputs: tuple[Input, ...]
    wanted: Wanted
    solved: HousingModes | None = field(default=None, repr=False)
    housing: HousingComponent | None = None
    housing_key: str = ""
    wider: Wider = ()
    radiated: RadiatedPower | None = field(default=None, repr=False)
    housings: dict[str, _Housing] = field(default_factory=dict, repr=False)

    def overrides(self, point: FloatArray) -> list[str]:
        """Return the ``key.path=value`` of a sample at a point of the unit cube."""
        return [text for one, at in inputs_at(self.inputs, point, self.wider) for text in one.overrides(at)]

    def case(self, point: FloatArray | None) -> Case:
        """Return the case of a sample; of None the one without changes.

        Raises
        ------
        CaseError
            Where its values make no machine.
        """
        return self.source.changed_case([] if point is None else self.overrides(point))

    def solve(self, point: FloatArray | None) -> Outcome:
        """Find the quantities of a sample; errors are returned as failures, not raised."""
        return outcome_of(lambda: self.evaluation(point))

    def evaluation(self, point: FloatArray | None) -> Evaluation:
        """Find the quantities of a sample; of None those of the case without changes."""
        case = self.case(point)
        if not case.rotor or case.operation is None:
            return evaluate_pairs(solve_pairs(case, None)[0], self.wanted)
        wanted = replace(self.wanted, needs_load=case.parts.needs_operating_point)
        if "motion" in wanted.analyses:
            wanted = replace(wanted, plan=plan_of(case))
        machine = self.machine(case)
        modes = None if point is None else lambda: self.nominal_modes
        return evaluate(machine, wanted, self.radiated_by(machine.housing_component), modes)

    @cached_property
    def nominal_modes(self) -> ObservedModes:
        """Modes of the case without changes."""
        return modes_of(self.machine(self.case(None)), self.wanted)

    @cached_property
    def start_warnings(self) -> list[ResultWarning]:
        """Warnings of the operating point of the case without changes; none where no sample has one."""
        case = self.case(None)
        if not case.rotor or case.operation is None or not UNDER_LOAD & set(self.wanted.analyses):
            return []
        return load_of_case(case.parts, self.machine(case))[1]

    def machine(self, case: Case) -> Machine:
        """Return the machine of a case of the study, in its housing."""
        housing = self.housing
        if case.housing is not None and (key := self.key_of_housing(case)) != self.housing_key:
            if key not in self.housings:
                if len(self.housings) >= _KEPT_HOUSINGS:
                    self.housings.pop(next(iter(self.housings)))
                known = None if self.solved is None else with_modes_of(case, self.solved, "vary")
                solved = known or solve_housing(case, command="vary")
                radiated = radiated_power_of(acoustics_of(case), solved)[0] if self.wanted.has_sound else None
                self.housings[key] = reduce_housing(case, solved, with_coarser=False), radiated
            housing = self.housings[key][0]
        return describe_machine(case, housing or reduced_component(case.reduced_housing, case.input_files))

    def key_of_housing(self, case: Case) -> str:
        """Return the key of all that a machine takes of its housing, places of bearings and materials included.

        Where the sound is wanted, so are the settings by which the housing radiates.
        """
        key = housing_key(given_housing(case, "vary"))
        if not self.wanted.has_sound or case.acoustics is None:
            return key
        return content_key({"housing": key, "acoustics": case.acoustics.model_dump(mode="json")})

    def radiated_by(self, housing: HousingComponent | None) -> RadiatedPower | None:
        """Return the radiation of a housing of the study; None where the sound is not wanted."""
        others = (radiated for other, radiated in self.housings.values() if other is housing)
        return self.radiated if housing is self.housing else next(others, None)

    @cached_property
    def key(self) -> str:
        """Key of all that the samples depend on but their points: case, files, inputs, libraries and our code."""
        inputs = [repr(one) for one in (*self.inputs, *self.wider)]
        content = case_content(self.case(None), _REMARKS)
        return solution_key(case=content, inputs=inputs, wanted=repr(self.wanted))


class Sampled(Protocol):
    """Gearboxes that are solved by their points."""

    @property
    def key(self) -> str:
        """Key of all that the samples depend on but their points."""

    def solve(self, point: FloatArray, /) -> Outcome:
        """Find what is wanted of a sample; errors are returned as failures, not raised."""


class Varied(Sampled, Protocol):
    """Gearboxes by their inputs: of a case, or as a function makes them."""

    @property
    def inputs(self) -> tuple[Input, ...]:
        """Inputs, each with a coordinate of the points."""

    @property
    def wanted(self) -> Wanted:
        """What is found of each."""

    @property
    def wider(self) -> Wider:
        """See :func:`gearwhine.variation.inputs.inputs_at`."""

    @property
    def start_warnings(self) -> list[ResultWarning]:
        """Warnings of the gearbox without changes."""

    def evaluation(self, point: FloatArray | None, /) -> Evaluation:
        """Find what is wanted of a sample, of None of the gearbox without changes."""


def solve_samples(varied: Sampled, points: Sequence[tuple[int, FloatArray]], code: str) -> list[tuple[int, Outcome]]:
    """Solve some samples on a worker, by their numbers and points.

    Parameters
    ----------
    varied : Sampled
    points : sequence of (int, ndarray)
    code : str
        Digest of the caller's code; other code on the worker could give other numbers.
    """
    require_same_code(code)
    solved = [(number, varied.solve(point)) for number, point in points]
    _leave_to_process()
    return solved


@cache
def _leave_to_process() -> None:
    """Take modules and what is kept for all samples out of the worker's garbage collections, once."""
    gc.collect()
    gc.freeze()


class Record:
    """Record of samples in a results folder.

    Parameters
    ----------
    folder : path
        Results folder.
    key : str
        Key of all that the samples depend on; a record of another key is another file.
    place : str
        Folder of the record within the results folder.
    """

    def __init__(self, folder: Path, key: str, place: str = FOLDER) -> None:
        self.file = folder / place / f"{key[:16]}.jsonl"
        self._sound_bytes = 0

    def read(self, points: FloatArray) -> dict[int, Outcome]:
        """Return the samples at points (n, d) that are on file, by number; what an interruption left unfinished is not.

        A sample of another point, as of another seed, is none of these.
        """
        return {
            number: outcome
            for number, point, outcome in self.entries()
            if number < len(points) and point == points[number].tolist()
        }

    def entries(self) -> Iterator[tuple[int, list[float], Outcome]]:
        """Yield number, point and outcome of each sample on file, in the order in which they were found."""
        self._sound_bytes = 0
        if not self.file.is_file():
            return
        with self.file.open("rb") as stream:
            for line in stream:
                if not line.endswith(b"\n"):
                    break
                try:
                    entry = json.loads(line)
                    number, outcome = _of_line(entry)
                    point = [float(at) for at in entry["point"]]
                except (ValueError, KeyError, TypeError):
                    break
                self._sound_bytes += len(line)
                yield number, point, outcome

    def append(self, solved: Iterable[tuple[int, Outcome]], points: FloatArray | Mapping[int, FloatArray]) -> None:
        """Add samples at points (n, d) behind those that :meth:`read` has found, on the disk when this returns."""
        self.file.parent.mkdir(parents=True, exist_ok=True)
        lines = b"".join(
            json.dumps(_line(number, points[number], outcome)).encode() + b"\n" for number, outcome in solved
        )
        with self.file.open("r+b" if self.file.exists() else "w+b") as stream:
            stream.truncate(self._sound_bytes)
            stream.seek(self._sound_bytes)
            stream.write(lines)
            stream.flush()
            os.fsync(stream.fileno())
        self._sound_bytes += len(lines)

    def remove_others(self) -> None:
        """Remove records of the case as it was, or of other inputs."""
        for path in self.file.parent.glob("*.jsonl"):
            if path != self.file:
                path.unlink(missing_ok=True)


def _line(number: int, point: FloatArray, outcome: Outcome) -> dict[str, Any]:
    begin: dict[str, Any] = {"number": number, "point": point.tolist()}
    if isinstance(outcome, Failure):
        return begin | {"failure": outcome.message, "traceback": outcome.traceback}
    numbers = {name: None if np.isnan(value) else value for name, value in outcome.numbers.items()}
    curves = {name: curve.tolist() for name, curve in outcome.curves.items()}
    return begin | {"numbers": numbers} | ({"curves": curves} if curves else {})


def _of_line(line: Mapping[str, Any]) -> tuple[int, Outcome]:
    number = int(line["number"])
    if "failure" in line:
        return number, Failure(str(line["failure"]), str(line["traceback"]))
    numbers = {str(name): np.nan if value is None else float(value) for name, value in line["numbers"].items()}
    curves = {str(name): np.array(curve, dtype=np.float64) for name, curve in line.get("curves", {}).items()}
    return number, Evaluation(numbers, curves)
