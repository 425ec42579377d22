"""Gearboxes with and without a fault: the case of each, and the record of its sensors' condition.

A sample's point is a point of the unit cube with three numbers before it: its kind, the size of its fault, and the
number of its record, by which each record has another course of its cages' slip. The samples of a size do not depend on
the other sizes of a study, so that a study with a further one solves that alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from gearwhine.case import Case
from gearwhine.coupling import Machine
from gearwhine.coupling.analyses.condition_record import condition_record
from gearwhine.coupling.analyses.loaded_machine import load_machine
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.analyses.transient import solve_transient
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.load_analysis.load_warnings import load_or_reason
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.rolling_bearings import BearingDamage
from gearwhine.solve.machine import plan_of
from gearwhine.variation.machines import VariedMachine
from gearwhine.variation.quantities import Evaluation
from gearwhine.variation.samples import Outcome, VariedCase, outcome_of

REFERENCE, HEALTHY, FAULTY, BASELINE = 0.0, 1.0, 2.0, 3.0
"""Kinds of samples: the case without its fault and without other changes; a healthy gearbox; a faulty one; an earlier
record of one of these without the fault."""
SIGNAL, AVERAGE = "signal of ", "average of "
"""Beginnings of the names of a sample's curves, before that of the sensor."""
_DIGITS = 9
_SEEDS = 2**31


@dataclass(frozen=True)
class Watched:
    """What a record is watched by.

    Attributes
    ----------
    gear : str
        Gear by whose shaft signals are averaged.
    spall : (str, BearingDamage) or None
        Name of the bearing, and its spall, where that is the fault.
    is_averaged : bool
        Whether an indicator takes the average over the turns of the gear's shaft, which those of planetary sets have
        not.
    """

    gear: str
    spall: tuple[str, BearingDamage] | None = None
    is_averaged: bool = True


@dataclass(frozen=True, eq=False)
class DetectionCase:
    """A case with a fault of some sizes in gearboxes that vary.

    Attributes
    ----------
    varied : VariedCase
        The case with its varied inputs, of which there may be none.
    fault : str
        Key of the fault's size.
    without : str
        Change ``key.path=value`` that makes a healthy gearbox; empty where the case is one.
    written : dict of float to str
        Sizes as the case writes them, by their value in SI.
    watched : Watched
    slips : tuple of (str, int)
        Key and value of the seed of each slip that scatters.
    """

    varied: VariedCase
    fault: str
    without: str
    written: dict[float, str]
    watched: Watched
    slips: tuple[tuple[str, int], ...] = ()

    def case(self, point: FloatArray) -> Case:
        """Return the case of a sample at a point (3 + d,).

        Raises
        ------
        CaseError
            Where its values make no machine.
        """
        kind, size, record = point[:3].tolist()
        changes = [] if kind == REFERENCE else self.varied.overrides(point[3:])
        changes += [f"{key}={seed}" for key, seed in _seeds(self.slips, record)]
        if kind == FAULTY:
            changes.append(f"{self.fault}={self.written[size]}")
        elif self.without:
            changes.append(self.without)
        return self.varied.source.changed_case(changes)

    def solve(self, point: FloatArray) -> Outcome:
        """Find the record of a sample; errors are returned as failures, not raised."""
        return outcome_of(lambda: self.evaluation(point))

    def evaluation(self, point: FloatArray) -> Evaluation:
        """Find the record of a sample.

        Raises
        ------
        gearwhine.coupling.CouplingError
            Where the gear has no average that an indicator takes, or the machine cannot be solved.
        """
        case = self.case(point)
        machine, is_needed = self.varied.machine(case), case.parts.needs_operating_point
        return _recorded(machine, plan_of(case), self.watched, is_needed=is_needed)

    @cached_property
    def key(self) -> str:
        """Key of all that the samples depend on but their points."""
        return content_key(
            {"varied": self.varied.key, "fault": [self.fault, self.without, repr(self.watched), *self.slips]}
        )


@dataclass(frozen=True, eq=False)
class DetectionMachine:
    """A machine of Python with a fault of some sizes, by the paths of its attributes, in machines that vary.

    Attributes
    ----------
    varied : VariedMachine
        The machine with its varied inputs, of which there may be none; it makes a machine of values by path.
    fault : str
        Path of the fault's size.
    without : mapping of str to object
        Changes that make a healthy machine; empty where it is one.
    watched : Watched
    slips : tuple of (str, int)
        Path and value of the seed of each slip that scatters.
    plan : TransientPlan
    """

    varied: VariedMachine
    fault: str
    without: Mapping[str, object]
    watched: Watched
    slips: tuple[tuple[str, int], ...]
    plan: TransientPlan

    def machine(self, point: FloatArray) -> Machine:
        """Return the machine of a sample at a point (3 + d,).

        Raises
        ------
        ValueError
            Where its values make no machine.
        """
        kind, size, record = point[:3].tolist()
        changes: dict[str, Any] = {} if kind == REFERENCE else dict(self.varied.values(point[3:]))
        changes |= dict(_seeds(self.slips, record))
        changes |= {self.fault: size} if kind == FAULTY else self.without
        made: Machine = self.varied.make(changes)  # type: ignore[assignment]  # of a machine's paths
        return made

    def solve(self, point: FloatArray) -> Outcome:
        """Find the record of a sample; errors are returned as failures, not raised."""
        return outcome_of(lambda: _recorded(self.machine(point), self.plan, self.watched))

    @cached_property
    def key(self) -> str:
        """Key of all that the samples depend on but their points."""
        fault = [self.fault, sorted(self.without), repr(self.watched), repr(self.plan), *self.slips]
        return content_key({"varied": self.varied.key, "fault": fault})


def _seeds(slips: Sequence[tuple[str, int]], record: float) -> list[tuple[str, int]]:
    """Return the seeds of the slips in a record, each by its key."""
    return [(key, (seed + round(record)) % _SEEDS) for key, seed in slips]


def _recorded(machine: Machine, plan: TransientPlan, watched: Watched, *, is_needed: bool | None = None) -> Evaluation:
    """Return the record of a machine.

    Raises
    ------
    gearwhine.coupling.CouplingError
        Where the gear has no average that an indicator takes, or the machine cannot be solved.
    """
    load = load_or_reason(machine, is_needed=is_needed)[0] if machine.is_loaded else None
    loaded = load_machine(machine, None if load is None else load.point, plan.run)
    record = condition_record(solve_transient(loaded.coupled, plan))
    gear = next(one for one in record.gears if one.gear == watched.gear)
    if gear.undefined and watched.is_averaged:
        raise CouplingError(f"no average of gear {gear.gear!r}: {gear.undefined}")
    numbers = {
        "limit_hz": record.limit_hz,
        "interval_s": record.interval,
        "turn_hz": gear.turn_hz,
        "teeth": float(gear.teeth),
        "steady": float(record.is_steady),
        "turns": float(gear.turns),
    }
    if watched.spall is not None:
        name, spall = watched.spall
        mounted = next(one for one in machine.bearings if one.bearing.name == name)
        if mounted.elements is not None:
            row = mounted.elements.rows[spall.row]
            numbers["tone_hz"] = spall.tone(row, machine.bearing_speed(mounted), mounted.slip) / (2.0 * np.pi)
    numbers |= {f"teeth of another gear, {place}": float(teeth) for place, teeth in enumerate(gear.others)}
    curves = {f"{SIGNAL}{name}": _rounded(signal) for name, signal in record.signals.items()}
    if watched.is_averaged:
        curves |= {f"{AVERAGE}{name}": _rounded(record.averages[gear.shaft, name]) for name in record.sensors}
    return Evaluation(numbers, curves)


def _rounded(values: FloatArray) -> FloatArray:
    """Round a curve to nine digits of its largest value, which its file then holds in half the room."""
    largest = float(np.abs(values).max(initial=0.0))
    if largest == 0.0:
        return values
    return np.asarray(np.round(values, _DIGITS - int(np.ceil(np.log10(largest)))))


@dataclass(frozen=True, eq=False)
class Design:
    """Samples of a study: the reference first, then the gearboxes, then their earlier records.

    Attributes
    ----------
    points : ndarray, shape (n, 3 + d)
    sizes : ndarray, shape (g,)
        Size of the fault of each gearbox; 0 of a healthy one.
    has_baselines : bool
        Whether each gearbox has an earlier record.
    """

    points: FloatArray
    sizes: FloatArray
    has_baselines: bool

    def gearbox(self, number: int) -> int:
        """Return the number of a gearbox' sample."""
        return 1 + number

    def baseline(self, number: int) -> int:
        """Return the number of the sample that a gearbox is compared with: its earlier record, or the reference."""
        return 1 + len(self.sizes) + number if self.has_baselines else 0


def detection_design(
    cube: FloatArray, sizes: Sequence[float], healthy: int, faulty: int, between: Sequence[int] | None = None
) -> Design:
    """Return the samples of a study.

    Parameters
    ----------
    cube : ndarray, shape (m, d)
        Points of the unit cube, one for each gearbox: those with a fault are other ones than the healthy ones.
    sizes : sequence of float
    healthy, faulty : int
        Numbers of gearboxes without the fault, and at each size.
    between : sequence of int, optional
        Coordinates that an earlier record of a gearbox has of its own; None where there are no earlier records.
    """
    of_each = np.array([0.0] * healthy + [size for size in sizes for _ in range(faulty)])
    count, dimensions = len(of_each), cube.shape[1]
    kinds = np.where(of_each > 0.0, FAULTY, HEALTHY)
    reference = np.concatenate([[REFERENCE, 0.0, 0.0], np.full(dimensions, 0.5)])
    records = 1.0 + 2.0 * np.arange(count)  # beside each the earlier one
    rows = [reference[None], np.column_stack([kinds, of_each, records, cube[:count]])]
    if between is not None:
        earlier = cube[:count].copy()
        # Those of the gearbox before it: of the same distribution, and of another record.
        earlier[:, list(between)] = np.roll(cube[:count], 1, axis=0)[:, list(between)]
        rows.append(np.column_stack([np.full(count, BASELINE), np.zeros(count), records + 1.0, earlier]))
    return Design(np.vstack(rows), of_each, between is not None)
