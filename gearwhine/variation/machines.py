"""Varied machines of Python: a function makes each of them by the values of its inputs."""

from __future__ import annotations

import hashlib
import inspect
import sys
import uuid
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property, partial
from numbers import Real
from typing import Any

import numpy as np

from gearwhine.coupling import CouplingError, Machine
from gearwhine.coupling.linear.tracked_modes import ObservedModes
from gearwhine.coupling.load_analysis.load_warnings import find_load
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.result_warnings import ResultWarning
from gearwhine.solutions import solution_key
from gearwhine.solve.radiated_power import Radiations
from gearwhine.variation.inputs import Input, Wider, inputs_at
from gearwhine.variation.quantities import UNDER_LOAD, Evaluation, Wanted, evaluate, modes_of
from gearwhine.variation.samples import Outcome, outcome_of

Made = Machine | Mapping[str, float]
"""A machine, or quantities of its own by name, which are taken as they are."""
Maker = Callable[[Mapping[str, float]], Made]


@dataclass(frozen=True, eq=False)
class VariedMachine:
    """Machines that a function makes of drawn values.

    Attributes
    ----------
    make : callable
        Makes a machine of the values by name; what it cannot make raises `ValueError`.
    inputs : tuple of Input
    wanted : Wanted
    radiations : Radiations
        Radiation of the housings, where the sound is wanted.
    start : Machine or mapping of str to float
        What it makes without changes.
    wider : sequence of (Input or None)
        See :func:`gearwhine.variation.inputs.inputs_at`.
    """

    make: Maker
    inputs: tuple[Input, ...]
    wanted: Wanted
    radiations: Radiations
    start: Made
    wider: Wider = ()

    def values(self, point: FloatArray) -> dict[str, float]:
        """Return the values of a sample at a point of the unit cube, by name."""
        return {one.name: one.value(at) for one, at in inputs_at(self.inputs, point, self.wider)}

    def made(self, point: FloatArray | None) -> Made:
        """Return what is made at a point; of None the start."""
        return self.start if point is None else made(self.make, self.values(point))

    def evaluation(self, point: FloatArray | None) -> Evaluation:
        """Find the quantities of a sample; of None those of the start."""
        found = self.made(point)
        if not isinstance(found, Machine):
            return Evaluation({name: float(value) for name, value in found.items() if self.wanted.has(name)})
        modes = None if point is None else lambda: self.nominal_modes
        return evaluate(found, self.wanted, self.radiations.of(found) if self.wanted.has_sound else None, modes)

    @cached_property
    def nominal_modes(self) -> ObservedModes:
        """Modes of the start."""
        if not isinstance(self.start, Machine):
            raise CouplingError("modes: expected a start that is a machine, as the others")
        return modes_of(self.start, self.wanted)

    def solve(self, point: FloatArray | None) -> Outcome:
        """Find the quantities of a sample; errors are returned as failures, not raised."""
        return outcome_of(lambda: self.evaluation(point))

    @cached_property
    def start_warnings(self) -> list[ResultWarning]:
        """Warnings of the operating point of the start; none where no sample has one."""
        if not isinstance(self.start, Machine) or not (self.start.is_loaded and UNDER_LOAD & set(self.wanted.analyses)):
            return []
        return find_load(self.start)[1]

    @cached_property
    def key(self) -> str:
        """Key of all that the samples depend on but their points: start, function, inputs, libraries and our code."""
        inputs = [repr(one) for one in (*self.inputs, *self.wider)]
        acoustics = repr(self.radiations.acoustics)
        content = [_content(self.start), _content_of_function(self.make), acoustics]
        return solution_key(made=content, inputs=inputs, wanted=repr(self.wanted))


def made(make: Maker, values: Mapping[str, float]) -> Made:
    """Return what a function makes of values.

    Raises
    ------
    CouplingError
        Where it cannot make it, or that is neither a machine nor numbers by name.
    """
    try:
        found = make(values)
    except ValueError as error:
        raise CouplingError(str(error)) from error
    if not isinstance(found, Machine | Mapping):
        raise CouplingError(f"{make!r} returned {found!r:.60}; expected a gearwhine.Machine, or numbers by name")
    for name, value in found.items() if isinstance(found, Mapping) else ():
        if not isinstance(value, Real):
            raise CouplingError(f"{make!r} returned {value!r:.60} as {name!r}; expected a number")
    return found


def _content_of_function(make: Callable[..., object]) -> object:
    """Return a function's text and that of its module, with the values that it holds on to.

    Of one without a text, as in an interactive session, it is another one each time.
    """
    if isinstance(make, partial):
        return [_content_of_function(make.func), _content(make.args), _content(make.keywords)]
    module = sys.modules.get(getattr(make, "__module__", ""), None)
    if module is not None and module.__name__.startswith("gearwhine."):
        return getattr(make, "__qualname__", repr(type(make)))
    try:
        text = inspect.getsource(make)
        around = "" if module is None or not getattr(module, "__file__", None) else inspect.getsource(module)
        held = inspect.getclosurevars(make).nonlocals
    except (OSError, TypeError):
        return str(uuid.uuid4())
    return [text, around, _content(held)]


def _content(value: Any) -> Any:
    """Return what a description consists of, in plain values; arrays by a digest of their bytes."""
    if isinstance(value, Machine):
        # Of a solved housing what the machine takes of it, without the time that it took.
        attributes = [field.name for field in fields(value) if field.name != "housing"]
        return [*((name, _content(getattr(value, name))) for name in attributes), _content(value.housing_component)]
    if is_dataclass(value) and not isinstance(value, type):
        return [type(value).__name__, *((field.name, _content(getattr(value, field.name))) for field in fields(value))]
    if isinstance(value, np.ndarray):
        return [str(value.dtype), list(value.shape), hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()]
    if isinstance(value, Mapping):
        return [[str(key), _content(one)] for key, one in value.items()]
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_content(one) for one in value]
    if callable(value) and not isinstance(value, type):
        return _content_of_function(value)
    inside = getattr(value, "__dict__", None)
    return repr(value) if not inside or isinstance(value, type) else [type(value).__name__, _content(inside)]
