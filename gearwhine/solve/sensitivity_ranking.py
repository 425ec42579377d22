"""Sensitivity ranking at an operating point: change of gear pairs, sensors' lines and sound by walls and bearings.

The gradients are those of :mod:`coupling.statics.sensitivity` and :mod:`coupling.linear.mesh_harmonics`. Parameters of
the housing are those of :mod:`gearwhine.solve.housing_changes`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from coupling import Machine
from coupling.linear.line_outputs import SensorAmplitude
from coupling.linear.mesh_harmonics import Line, LineModel
from coupling.statics.operating_point import OperatingPoint
from coupling.statics.sensitivity import OUTCOMES, Adjoint, adjoint, pair_adjoints
from gearwhine.case import Case, CaseError, Problem
from gearwhine.progress import Progress, silent
from gearwhine.solve.housing_changes import HousingChange, by_changes, housing_changes, housing_fields, slopes_of
from gearwhine.solve.housing_modes import SolvedHousing
from gearwhine.solve.line_model import SolvedLines, solve_lines
from housing.updating.static_sensitivity import StaticSensitivity, harmonic_surface_density

if TYPE_CHECKING:
    from gearwhine.solve.sound.mesh_harmonics import HarmonicSound

FloatArray = npt.NDArray[np.float64]

_LENGTH_STEP = 1e-3  # step of the parameters that are lengths [m]
_RELATIVE_STEP = 0.1  # step of the others, relative to their value
_LEAST_RATIO = 1e-3  # of a line after a step to the line before it
_LARGE_ERROR = 1.0  # of a level to first order [dB]
_LARGE_ERROR_OF_SIGN = 0.3  # the same where the first order has the wrong sign [dB]
_SOUND = "sound"  # name of the sound's lines in --line, beside the sensors
_TWO_PI = 2.0 * np.pi


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
        The same with the response solved again at the step, and at the reverse step; NaN where the reverse step would
        take away a whole wall.
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
        None of a sum.
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
        """The same by the reverse step [dB]; None where there is none."""
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
        Misalignment by material added on the housing's surface, by its thickness and area [rad/m³].
    note : str or None
        Why flat faces stand in place of walls.
    lines : SolvedLines or None
        Lines of the sensors and of the sound; None where no mesh drives any.
    line : int
        Number of the sensor's line that is ranked and drawn.
    line_density : ndarray, shape (n_nodes,), or None
        Of that line, its amplitude by material added on the surface [(m/s²)/m³].
    sound_line : int or None
        Number of the sound's line that is ranked and drawn; None for the A-weighted sum of several.
    sound_density : ndarray, shape (n_nodes,), or None
        Of that line or sum, its power by material added on the surface [W/m³].
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
        return _sound_weights(self.loudest_lines, self.sound_line)

    @property
    def sound_power(self) -> float:
        """Power that is ranked: of one line, or A-weighted of all [W]."""
        return float(self.sound_weights @ [one.line.value for one in self.loudest_lines])

    def sensor_changes(self, influence: Influence) -> list[LineChange]:
        """Pair the sensors' lines with their changes by the step of a parameter."""
        return self._changes(influence)[: len(self.sensor_lines)]

    def sound_changes(self, influence: Influence) -> list[LineChange]:
        """Pair the sound's lines with their changes by the step of a parameter."""
        return self._changes(influence)[len(self.sensor_lines) :]

    def total_sound_change(self, influence: Influence) -> LineChange:
        """Change of the A-weighted power of the sound's lines together by the step of a parameter."""
        weights, changes = _sound_weights(self.loudest_lines, None), self.sound_changes(influence)
        value, first_order, change, reverse = (
            float(weights @ [getattr(one, attribute) for one in changes])
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


@dataclass(frozen=True, eq=False)
class Ranking:
    """Influences of a machine's parameters on its gear pairs and lines, from the adjoint state of each of these.

    Attributes
    ----------
    point : OperatingPoint
    solved : SolvedLines or None
        Lines of the sensors and of the sound.
    """

    point: OperatingPoint
    solved: SolvedLines | None

    @property
    def lines(self) -> tuple[Line, ...]:
        """Lines of the sensors, and then of the sound; empty where no mesh drives any."""
        return () if self.solved is None else self.solved.lines

    @property
    def model(self) -> LineModel:
        """Model of the lines, where there are any."""
        assert self.solved is not None
        return self.solved.model

    @cached_property
    def pair_adjoints(self) -> tuple[dict[str, Adjoint], ...]:
        """Adjoint states of each gear pair by outcome."""
        return pair_adjoints(self.point)

    @cached_property
    def adjoints(self) -> tuple[Adjoint, ...]:
        """Adjoint states of all outcomes of the gear pairs, and then of the lines."""
        of_pairs = [state for pair in self.pair_adjoints for state in pair.values()]
        return (*of_pairs, *(adjoint(self.point, self.model.by_static(line)) for line in self.lines))

    @property
    def outcomes(self) -> list[tuple[int, int]]:
        """Row and column in `Influence.changes` of each adjoint state of a gear pair."""
        return [(row, OUTCOMES.index(name)) for row, pair in enumerate(self.pair_adjoints) for name in pair]

    def by_bearing_stiffness(self, bearing: str) -> Influence:
        """Influence of a factor on a bearing's stiffness."""
        step = _RELATIVE_STEP
        return self._influence(
            bearing,
            "bearing stiffness",
            step,
            [state.by_bearing_stiffness(bearing) for state in self.adjoints],
            [self.model.by_bearing_stiffness(line, bearing) for line in self.lines],
            [self.model.stepped_bearing_stiffness(line, bearing, step) for line in self.lines],
            [self.model.stepped_bearing_stiffness(line, bearing, -step) for line in self.lines],
            relative_to=1.0,
        )

    def by_bearing_position(self, bearing: str) -> Influence:
        """Influence of a bearing's position along its shaft."""
        step = _LENGTH_STEP
        return self._influence(
            bearing,
            "bearing position",
            step,
            [state.by_bearing_position(bearing) for state in self.adjoints],
            [self.model.by_bearing_position(line, bearing) for line in self.lines],
            [self.model.stepped_bearing_position(line, bearing, step) for line in self.lines],
            [self.model.stepped_bearing_position(line, bearing, -step) for line in self.lines],
        )

    def by_housing(self, fields: StaticSensitivity, changes: Sequence[HousingChange]) -> list[Influence]:
        """Influences of parameters of the housing.

        Parameters
        ----------
        fields : StaticSensitivity
            Displacements of the housing at the operating point and in all adjoint states.
        changes : sequence of HousingChange
        """
        slopes = slopes_of(changes)
        by_equilibrium = by_changes(fields, changes)
        rates = None if self.solved is None else self.solved.rates(fields, changes)
        by_response = np.zeros((len(self.lines), len(changes)))
        if rates is not None:
            by_response = np.array([self.model.by_housing(line, rates) for line in self.lines]) / slopes
        found = []
        for number, change in enumerate(changes):
            step = _LENGTH_STEP if change.reference is None else _RELATIVE_STEP * change.reference
            # Derivatives of the housing are by the parameter's coordinate.
            in_coordinate = step / change.slope
            stepped, reverse = (
                [] if rates is None else [self.model.stepped_housing(line, rates, number, size) for line in self.lines]
                for size in (in_coordinate, -in_coordinate)
            )
            found.append(
                self._influence(
                    change.parameter,
                    change.kind,
                    step,
                    by_equilibrium[:, number],
                    by_response[:, number],
                    stepped,
                    reverse,
                    relative_to=change.reference,
                    thickness=change.thickness,
                )
            )
        return found

    def _influence(
        self,
        parameter: str,
        kind: str,
        step: float,
        by_equilibrium: Sequence[float] | FloatArray,
        by_response: Sequence[float] | FloatArray,
        stepped: Sequence[float],
        reverse: Sequence[float],
        *,
        relative_to: float | None = None,
        thickness: float | None = None,
    ) -> Influence:
        """Join the change of gear pairs and lines through the equilibrium with that of the lines' own responses.

        Parameters
        ----------
        parameter, kind : str
        step : float
            Change of the parameter [SI].
        by_equilibrium : sequence of float, shape (n_adjoints,)
            Derivatives of all outcomes through the equilibrium [outcome/SI].
        by_response : sequence of float, shape (n_lines,)
            Derivatives of the lines at the same equilibrium.
        stepped, reverse : sequence of float, shape (n_lines,)
            Changes of the lines by the step and by its reverse at the same equilibrium, their responses solved again.
        relative_to : float, optional
            Value that the step is shown relative to; a length is shown as it is.
        thickness : float, optional
            Of a parameter that is a thickness [m].
        """
        derivatives = np.asarray(by_equilibrium)
        changes = np.full((len(self.point.pairs), len(OUTCOMES)), np.nan)
        for place, derivative in zip(self.outcomes, derivatives, strict=False):
            changes[place] = step * derivative
        static = step * derivatives[len(self.outcomes) :]
        has_reverse = thickness is None or thickness > step
        return Influence(
            parameter,
            kind,
            step if relative_to is None else _RELATIVE_STEP,
            relative_to is None,
            changes,
            static + step * np.asarray(by_response),
            static + np.asarray(stepped),
            np.asarray(reverse) - static if has_reverse else np.full(len(self.lines), np.nan),
            is_thickness=thickness is not None,
        )

    def densities(
        self, fields: StaticSensitivity, sensor_line: int, sound_line: int | None
    ) -> tuple[FloatArray, FloatArray | None, FloatArray | None]:
        """Return the changes by material added on the housing's surface, by its thickness and area.

        Parameters
        ----------
        fields : StaticSensitivity
            As for :meth:`by_housing`.
        sensor_line : int
            Number of the sensor's line.
        sound_line : int or None
            Number of the sound's line; None for the A-weighted sum of all.

        Returns
        -------
        misalignments : ndarray, shape (n_pairs, n_nodes)
            [rad/m³].
        amplitude : ndarray, shape (n_nodes,), or None
            Of the sensor's line [(m/s²)/m³].
        power : ndarray, shape (n_nodes,), or None
            Of the sound [W/m³].
        """
        by_equilibrium = fields.surface_density()
        misalignments = by_equilibrium[[n for n, (_, outcome) in enumerate(self.outcomes) if outcome == 0]]
        if self.solved is None:
            return misalignments, None, None
        by_equilibrium = by_equilibrium[len(self.outcomes) :]
        amplitude, power = None, None
        if self.solved.of_sensors:
            amplitude = by_equilibrium[sensor_line] + self._response_density(fields, self.lines[sensor_line])
        if self.solved.sound:
            power = np.zeros(len(fields.mesh.points))
            weights = _sound_weights(self.solved.sound, sound_line)
            for number, weight in enumerate(weights, start=len(self.solved.of_sensors)):
                if weight > 0.0:
                    density = by_equilibrium[number] + self._response_density(fields, self.lines[number])
                    power += weight * density
        return misalignments, amplitude, power

    def _response_density(self, fields: StaticSensitivity, line: Line) -> FloatArray:
        """Change of a line by material added on the surface at the same equilibrium, shape (n_nodes,)."""
        assert self.solved is not None
        motion, adjoint_motion = self.solved.field(line.motion), self.solved.field(line.adjoint)
        return harmonic_surface_density(fields.mesh, fields.constants, motion, adjoint_motion, line.frequency)


def solve_load_sensitivity(
    case: Case,
    machine: Machine,
    point: OperatingPoint,
    housing: SolvedHousing | None,
    progress: Progress = silent,
    *,
    line: str | None = None,
) -> LoadSensitivity:
    """Compute the gradients of an operating point, and of the sensors' lines and the sound about it, ranked.

    Parameters
    ----------
    case : Case
    machine : Machine
        Of the case.
    point : OperatingPoint
        Of the machine.
    housing : SolvedHousing or None
        That the machine stands in.
    progress : callable
    line : str, optional
        The line that is ranked and drawn, such as ``roof``, ``roof@1377`` or ``sound@1377``; by default the highest of
        a sensor, and the A-weighted power of the sound.

    Raises
    ------
    CaseError
        Where there is no such line, or the radiating surface cannot be made.
    housing.HousingError
        Where a line fails its proofs, see :meth:`housing.acoustics.radiation.RadiatedSound.require_proofs`.
    """
    solved = solve_lines(case, machine, point, housing, progress)
    sensor_line, sound_line = _chosen(line, solved)
    progress("adjoint states of gear pairs and lines")
    ranking = Ranking(point, solved)
    influences = []
    for bearing in point.bearings:
        influences += [ranking.by_bearing_stiffness(bearing.name), ranking.by_bearing_position(bearing.name)]
    density, line_density, sound_density, note = None, None, None, None
    if ranking.adjoints and housing is not None and point.housing is not None:
        progress("gradients by the housing")
        fields = housing_fields(case, housing, point, ranking.adjoints)
        density, line_density, sound_density = ranking.densities(fields, sensor_line, sound_line)
        changes, note = housing_changes(case, fields.mesh)
        influences += ranking.by_housing(fields, changes)
    widths = np.array([pair.pair.geometry.face_width for pair in point.pairs])
    influences.sort(key=lambda one: -float(np.abs(widths * one.changes[:, 0]).max(initial=0.0)))
    return LoadSensitivity(
        tuple(influences), density, note, solved, sensor_line, line_density, sound_line, sound_density
    )


def _sound_weights(lines: "Sequence[HarmonicSound]", chosen: int | None) -> FloatArray:
    """Weights of the sound's lines: one for a chosen line, else those of the frequency weighting A."""
    return np.array([one.weighting if chosen is None else float(n == chosen) for n, one in enumerate(lines)])


def _chosen(text: str | None, solved: SolvedLines | None) -> tuple[int, int | None]:
    """Return the numbers of the sensor's line and of the sound's line, None for several, that a text chooses.

    It is a sensor's name or ``sound``, alone or with ``@`` and a frequency [Hz].
    """
    together = 0 if solved is not None and len(solved.sound) == 1 else None
    if text is None:
        return 0, together
    names: dict[str, tuple[int, int | None]] = {}
    for n, line in enumerate(() if solved is None else solved.of_sensors):
        assert isinstance(line.output, SensorAmplitude)
        names.setdefault(line.output.sensor, (n, together))
        names.setdefault(f"{line.output.sensor}@{line.frequency / _TWO_PI:.0f}", (n, together))
    for n, one in enumerate(() if solved is None else solved.sound):
        names.setdefault(_SOUND, (0, together))
        names.setdefault(f"{_SOUND}@{one.line.frequency / _TWO_PI:.0f}", (0, n))
    if text not in names:
        known = ", ".join(repr(name) for name in names) or "none: no mesh drives a sensor or a sound"
        raise CaseError([Problem("--line", text, f"one of the highest lines: {known}")])
    return names[text]
