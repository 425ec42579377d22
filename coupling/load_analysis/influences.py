"""Influences of a machine's parameters at an operating point: changes of gear pairs, lines and sound by a step.

:mod:`gearwhine.coupling.load_analysis.ranking` makes and ranks them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gearwhine.coupling.linear.line_sensitivity import Line
from gearwhine.coupling.load_analysis.line_model import SolvedLines
from gearwhine.numerics.arrays import FloatArray

if TYPE_CHECKING:
    from gearwhine.coupling.sound.mesh_harmonics import HarmonicSound

_LEAST_RATIO = 1e-3  # least ratio of a line after a step to the line before it
_LARGE_ERROR = 1.0  # large error of a level to first order [dB]
_LARGE_ERROR_OF_SIGN = 0.3  # large error where the first order has the wrong sign [dB]


@dataclass(frozen=True, eq=False)
class Influence:
    """Influence of a parameter on every gear pair and every line, to first order.

    Attributes
    ----------
    parameter : str
    kind : str
        ``housing``, ``face``, ``bearing stiffness`` or ``bearing position``.
    step : float
        Change of the parameter: a length [m], or relative to its value.
    is_length : bool
        Whether the step is a length.
    changes : ndarray, shape (n_pairs, 3)
        Changes of the `OUTCOMES` by the step [rad, 1, m]; NaN for the last two of an idle pair.
    lines : ndarray, shape (n_lines,)
        Changes of the lines by the step to first order: amplitudes of sensors [m/s²], then powers of the sound [W].
    stepped, reversed : ndarray, shape (n_lines,)
        Changes of the lines with the response solved again at the step, and at the reverse step; NaN where the reverse
        step would remove a whole wall.
    is_thickness : bool
        Whether the parameter adds and takes away material along the normal of a wall or a face.
    """

    parameter: str
    kind: str
    step: float
    is_length: bool
    changes: FloatArray
    lines: FloatArray
    stepped: FloatArray
    reversed: FloatArray
    is_thickness: bool = False

    @property
    def step_text(self) -> str:
        """The step with its unit."""
        return f"+{self._size}"

    @property
    def words(self) -> tuple[str, str]:
        """The step and its reverse as text, such as ``1 mm thicker`` and ``1 mm thinner``."""
        if self.is_thickness:
            return f"{self._size} thicker", f"{self._size} thinner"
        if self.kind == "bearing stiffness":
            return f"{self._size} stiffer", f"{self._size} softer"
        if self.kind == "bearing position":
            return f"{self._size} to +z", f"{self._size} to -z"
        return f"{self._size} more", f"{self._size} less"

    @property
    def _size(self) -> str:
        return f"{1e3 * self.step:.3g} mm" if self.is_length else f"{100.0 * self.step:.3g} %"


@dataclass(frozen=True, eq=False)
class LineChange:
    """Change of a line, or of a weighted sum of lines, by a step of a parameter.

    Attributes
    ----------
    value : float
        The line: amplitude of a sensor [m/s²], or sound power [W].
    decibels : float
        Change of its level for a factor of ten [dB].
    first_order : float
        Change of the value to first order, in its unit.
    change, reverse : float
        Change of the value by the step and by the reverse step, the response solved again; NaN where there is none.
    line : Line or None
        Line; None of a sum.
    """

    value: float
    decibels: float
    first_order: float
    change: float
    reverse: float
    line: Line | None = None

    @property
    def first_order_level(self) -> float:
        """Change of its level to first order [dB]."""
        return self.decibels / math.log(10.0) * self.first_order / self.value

    @property
    def level(self) -> float:
        """Change of its level, the response solved again [dB]."""
        return self._level(self.change)

    @property
    def reverse_level(self) -> float | None:
        """Change of its level by the reverse step, the response solved again [dB]; None without such a step."""
        return None if math.isnan(self.reverse) else self._level(self.reverse)

    @property
    def first_order_is_off(self) -> bool:
        """Whether the level at either step is far from the first order: a resonance moves within it."""
        reverse = self.reverse_level
        pairs = [(self.level, self.first_order_level)]
        pairs += [] if reverse is None else [(reverse, -self.first_order_level)]
        return any(
            abs(level - first) > _LARGE_ERROR or (level * first < 0.0 and abs(level - first) > _LARGE_ERROR_OF_SIGN)
            for level, first in pairs
        )

    def _level(self, change: float) -> float:
        # The part by the equilibrium is linear, so that the estimate may fall below zero: the reduction is limited, to
        # 60 dB of an amplitude and 30 dB of a power.
        return self.decibels * math.log10(max(1.0 + change / self.value, _LEAST_RATIO))


@dataclass(frozen=True, eq=False)
class LoadSensitivity:
    """Sensitivity of an operating point.

    Attributes
    ----------
    influences : tuple of Influence
        The largest change of a misalignment over the face first.
    density : ndarray, shape (n_pairs, n_nodes), or None
        Derivative of the misalignment by material added on the housing's surface, by thickness and area [rad/m³].
    note : str or None
        Parts that are left out or stand in place of others, and why.
    lines : SolvedLines or None
        Lines of the sensors and of the sound; None where no mesh drives any.
    line : int
        Number of the sensor's line that is ranked and drawn.
    line_density : ndarray, shape (n_nodes,), or None
        Derivative of that line's amplitude by material added on the surface [(m/s²)/m³].
    sound_line : int or None
        Number of the sound's line that is ranked and drawn; None for the A-weighted sum of several.
    sound_density : ndarray, shape (n_nodes,), or None
        Derivative of the power of that line or sum by material added on the surface [W/m³].
    """

    influences: tuple[Influence, ...]
    density: FloatArray | None
    note: str | None = None
    lines: SolvedLines | None = None
    line: int = 0
    line_density: FloatArray | None = None
    sound_line: int | None = None
    sound_density: FloatArray | None = None

    @property
    def sensor_lines(self) -> tuple[Line, ...]:
        """Lines of the sensors, the highest first."""
        return () if self.lines is None else self.lines.of_sensors

    @property
    def loudest_lines(self) -> "tuple[HarmonicSound, ...]":
        """Lines of the sound, the loudest first."""
        return () if self.lines is None else self.lines.sound

    @property
    def sound_weights(self) -> FloatArray:
        """Weights of the sound's lines in the power that is ranked, shape (n_loudest_lines,)."""
        return sound_weights(self.loudest_lines, self.sound_line)

    @property
    def sound_power(self) -> float:
        """Power that is ranked: of one line, or A-weighted of all [W]."""
        return float(self.sound_weights @ [loud_line.line.value for loud_line in self.loudest_lines])

    def sensor_changes(self, influence: Influence) -> list[LineChange]:
        """Pair the sensors' lines with their changes by the step of a parameter."""
        return self._changes(influence)[: len(self.sensor_lines)]

    def sound_changes(self, influence: Influence) -> list[LineChange]:
        """Pair the sound's lines with their changes by the step of a parameter."""
        return self._changes(influence)[len(self.sensor_lines) :]

    def total_sound_change(self, influence: Influence) -> LineChange:
        """Change of the A-weighted power of the sound's lines together by the step of a parameter."""
        weights, changes = sound_weights(self.loudest_lines, None), self.sound_changes(influence)
        value, first_order, change, reverse = (
            float(weights @ [getattr(change, attribute) for change in changes])
            for attribute in ("value", "first_order", "change", "reverse")
        )
        return LineChange(value, changes[0].decibels, first_order, change, reverse)

    def _changes(self, influence: Influence) -> list[LineChange]:
        lines = () if self.lines is None else self.lines.lines
        changes = (influence.lines.tolist(), influence.stepped.tolist(), influence.reversed.tolist())
        return [
            LineChange(line.value, line.output.decibels, first_order, change, reverse, line)
            for line, first_order, change, reverse in zip(lines, *changes, strict=True)
        ]


def sound_weights(lines: "Sequence[HarmonicSound]", chosen: int | None) -> FloatArray:
    """Weights of the sound's lines: one for a chosen line, else those of the frequency weighting A."""
    return np.array([line.weighting if chosen is None else float(n == chosen) for n, line in enumerate(lines)])
