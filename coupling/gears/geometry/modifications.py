"""Flank modifications (tip and root relief) and flank deviations (profile and helix, ISO 1328-1).

Tip relief and root relief take material off the flank on purpose. Their depths are normal to the flank, so along the
line of action, and grow with the roll angle from nothing where the relief begins to the full amount where the flank
ends: in proportion (``"linear"``) or with the square of it (``"parabolic"``), which leaves no corner in the profile.

Flank deviations (ISO 1328-1) are those of a made flank from its design. They are normal to the flank in the transverse
plane, so along the line of action, and positive where there is too much material. Profile deviations vary with the roll
angle from the form circle to the tip, helix deviations across the face.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from gearwhine.coupling.gears.errors import GearError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import FINITE, Choice, Finding, Number, Rule, attribute_findings, refuse
from gearwhine.numerics.own_copies import keep_tuples

ReliefShape = Literal["linear", "parabolic"]

_POWER = {"linear": 1, "parabolic": 2}
_FROM_ZERO = Number(at_least=0.0, unit="m")


@dataclass(frozen=True)
class TipRelief:
    """Material taken off the flank near the tip.

    Parameters
    ----------
    amount : float
        Depth at the tip, normal to the flank [m].
    start_roll_angle : float or None
        Roll angle where the relief begins [rad]; zero roll is the base circle.
    length : float or None
        Distance from the tip to the start of the relief, along the line of action [m]; in place of `start_roll_angle`.
    shape : {"linear", "parabolic"}

    Raises
    ------
    GearError
        Unless exactly one of `start_roll_angle` and `length` is given, and all are finite and not negative.
    """

    amount: float
    start_roll_angle: float | None = None
    length: float | None = None
    shape: ReliefShape = "linear"

    def __post_init__(self) -> None:
        """Check the amount and the start."""
        _check("tip relief", self)

    def start(self, tip_roll_angle: float, base_radius: float) -> float:
        """Roll angle where the relief begins [rad], on a gear of given roll angle at the tip and base radius [m]."""
        if self.start_roll_angle is not None:
            return self.start_roll_angle
        assert self.length is not None
        return tip_roll_angle - self.length / base_radius

    def depth(self, roll_angle: FloatArray, tip_roll_angle: float, base_radius: float) -> FloatArray:
        """Material taken off [m] at roll angles [rad]."""
        start = self.start(tip_roll_angle, base_radius)
        return _depth(self, (roll_angle - start) / (tip_roll_angle - start))


@dataclass(frozen=True)
class RootRelief:
    """Material taken off the flank near its foot; parameters as for `TipRelief`.

    The full `amount` is reached at the form circle, where the involute begins, and `length` is counted from there.
    """

    amount: float
    start_roll_angle: float | None = None
    length: float | None = None
    shape: ReliefShape = "linear"

    def __post_init__(self) -> None:
        """Check the amount and the start."""
        _check("root relief", self)

    def start(self, form_roll_angle: float, base_radius: float) -> float:
        """Roll angle where the relief begins [rad], on a gear of given roll angle at the form circle."""
        if self.start_roll_angle is not None:
            return self.start_roll_angle
        assert self.length is not None
        return form_roll_angle + self.length / base_radius

    def depth(self, roll_angle: FloatArray, form_roll_angle: float, base_radius: float) -> FloatArray:
        """Material taken off [m] at roll angles [rad]."""
        start = self.start(form_roll_angle, base_radius)
        return _depth(self, (start - roll_angle) / (start - form_roll_angle))


def _depth(relief: TipRelief | RootRelief, part: FloatArray) -> FloatArray:
    return np.asarray(relief.amount * np.maximum(0.0, part) ** _POWER[relief.shape], dtype=np.float64)


def _check(name: str, relief: TipRelief | RootRelief) -> None:
    part = (name, "")
    rules: dict[str, Rule] = {
        "amount": _FROM_ZERO,
        "start_roll_angle": Number(at_least=0.0, optional=True, unit="rad"),
        "length": Number(above=0.0, optional=True, unit="m"),
        "shape": Choice(tuple(_POWER)),
    }
    findings = list(attribute_findings(part, relief, **rules))
    if (relief.start_roll_angle is None) == (relief.length is None):
        findings.append(Finding(part, "", None, "exactly one of 'start_roll_angle' and 'length'"))
    refuse(findings, GearError)


@dataclass(frozen=True)
class ProfileDeviation:
    """Deviation of all flanks of a gear along the profile.

    With ``u`` running from -1 at the form circle to 1 at the tip in proportion to the roll angle, the deviation is
    ``slope u / 2 + form sin(pi waves u + phase) / 2 - crowning u^2``, plus that of the table.

    Parameters
    ----------
    slope : float
        Profile slope deviation f_Halpha [m]: excess of the tip over the form circle.
    form : float
        Profile form deviation f_falpha [m]: height of the waves from trough to crest.
    waves : float
        Number of waves over the flank.
    phase : float
        Phase of the waves at the middle of the flank [rad].
    crowning : float
        Profile crowning C_alpha [m]: material removed at both ends.
    table : tuple of (float, float)
        A measured profile: roll angle [rad], deviation [m]; straight lines between, held beyond its ends.
    """

    slope: float = 0.0
    form: float = 0.0
    waves: float = 3.0
    phase: float = 0.0
    crowning: float = 0.0
    table: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        """Check the deviations and the table."""
        keep_tuples(self, "table")
        part = ("profile deviation", "")
        finite = dict.fromkeys(("slope", "phase", "crowning"), FINITE)
        findings = list(attribute_findings(part, self, **finite, form=_FROM_ZERO, waves=Number(at_least=0.0)))
        ascends = all(before < after for (before, _), (after, _) in pairwise(self.table))
        if self.table and (len(self.table) < 2 or not ascends or not np.all(np.isfinite(self.table))):
            expected = "two rows or more of a roll angle and a deviation, the roll angles increasing"
            findings.append(Finding(part, "table", self.table, expected))
        refuse(findings, GearError)

    @property
    def corners(self) -> tuple[float, ...]:
        """Roll angles where the profile has corners [rad]."""
        return tuple(roll for roll, _ in self.table)

    def at(self, roll_angle: FloatArray, form_roll_angle: float, tip_roll_angle: float) -> FloatArray:
        """Deviation [m] at roll angles [rad] of a gear whose flank reaches from the form circle to the tip."""
        u = 2.0 * (roll_angle - form_roll_angle) / (tip_roll_angle - form_roll_angle) - 1.0
        waves = np.sin(math.pi * self.waves * u + self.phase) if self.form else 0.0
        deviation = 0.5 * self.slope * u + 0.5 * self.form * waves - self.crowning * u**2
        if self.table:
            rolls, values = np.array(self.table).T
            deviation = deviation + np.interp(roll_angle, rolls, values)
        return np.asarray(deviation, dtype=np.float64)


@dataclass(frozen=True)
class HelixDeviation:
    """Deviation of all flanks of a gear across the face.

    With ``v`` running from -1 at the face's left end (smallest z) to 1 at its right end, the deviation is
    ``slope v / 2 - crowning v^2``, less the end relief, which grows linearly to its amount at either end.

    Parameters
    ----------
    slope : float
        Helix slope deviation f_Hbeta [m]: excess of the right end over the left one.
    crowning : float
        Lead crowning C_beta [m]: material removed at both ends.
    end_relief, end_relief_length : float
        Amount of the relief at the ends, and its length from each end [m].
    """

    slope: float = 0.0
    crowning: float = 0.0
    end_relief: float = 0.0
    end_relief_length: float = 0.0

    def __post_init__(self) -> None:
        """Check the deviations and the end relief."""
        part = ("helix deviation", "")
        rules = {"slope": FINITE, "crowning": FINITE, "end_relief": _FROM_ZERO, "end_relief_length": _FROM_ZERO}
        findings = list(attribute_findings(part, self, **rules))
        if not findings and self.end_relief > 0.0 and self.end_relief_length == 0.0:
            findings.append(Finding(part, "end_relief_length", 0.0, "the length of the end relief, above 0"))
        refuse(findings, GearError)

    @property
    def is_straight(self) -> bool:
        """Whether the flank is straight and true across the face."""
        return self == HelixDeviation(end_relief_length=self.end_relief_length)

    def at(self, z: FloatArray, face_width: float) -> FloatArray:
        """Deviation [m] at places across the face [m], counted from its middle."""
        v = 2.0 * z / face_width
        deviation = 0.5 * self.slope * v - self.crowning * v**2
        if self.end_relief > 0.0:
            from_end = 0.5 * face_width - np.abs(z)
            deviation = deviation - self.end_relief * np.maximum(0.0, 1.0 - from_end / self.end_relief_length)
        return np.asarray(deviation, dtype=np.float64)
