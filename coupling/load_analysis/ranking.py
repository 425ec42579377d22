"""Sensitivity ranking at an operating point: gear pairs, sensors' lines and sound by wall thickness and bearings.

The gradients are those of :mod:`gearwhine.coupling.statics.sensitivity` and
:mod:`gearwhine.coupling.linear.line_sensitivity`. Parameters of the housing are
given as changes of its model, :mod:`gearwhine.housing.updating.housing_change`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from gearwhine.coupling.description.excitation import Run
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.linear.line_outputs import SensorAmplitude
from gearwhine.coupling.linear.line_sensitivity import Line, LineModel
from gearwhine.coupling.load_analysis.box_walls import wall_changes
from gearwhine.coupling.load_analysis.housing_fields import housing_fields
from gearwhine.coupling.load_analysis.influences import Influence, LoadSensitivity, sound_weights
from gearwhine.coupling.load_analysis.line_model import SolvedLines, solve_lines, turning_carriers
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.coupling.statics.sensitivity import OUTCOMES, Adjoint, adjoint, pair_adjoints
from gearwhine.housing import Housing, HousingModes
from gearwhine.housing.updating.housing_change import HousingChange, by_changes, face_changes, slopes_of
from gearwhine.housing.updating.static_sensitivity import StaticSensitivity, harmonic_surface_density
from gearwhine.meshes.box.morph import MorphError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress, silent

if TYPE_CHECKING:
    from gearwhine.coupling.sound.acoustics import Acoustics

FACES_IN_PLACE_OF_WALLS = "the mesh of the box does not follow its walls, so that flat faces stand in their place"

_LENGTH_STEP = 1e-3  # step of the parameters that are lengths [m]
_RELATIVE_STEP = 0.1  # step of the others, relative to their value
_SOUND = "sound"  # name of the sound's lines in --line, beside the sensors
_TWO_PI = 2.0 * np.pi
_FAINT_FIELD = 1e-4  # product of motion and adjoint state, over the largest, up to which a harmonic is left out


@dataclass(frozen=True)
class _Step:
    """Step of a parameter.

    Attributes
    ----------
    reference : float or None
        Value of the parameter that the step is relative to [SI]; None of a length.
    thickness : float or None
        Thickness, of a parameter that is one [m].
    """

    reference: float | None
    thickness: float | None = None

    @property
    def shown(self) -> float:
        """The step as it is shown: a length [m], or relative to the reference."""
        return _LENGTH_STEP if self.reference is None else _RELATIVE_STEP

    @property
    def size(self) -> float:
        """Change of the parameter [SI]."""
        return self.shown if self.reference is None else self.shown * self.reference

    @property
    def has_reverse(self) -> bool:
        """Whether the reverse step leaves anything of a wall."""
        return self.thickness is None or self.thickness > self.size


@dataclass(frozen=True, eq=False)
class Ranking:
    """Influences of a machine's parameters on its gear pairs and lines, from the adjoint state of each of these.

    Attributes
    ----------
    point : OperatingPoint
    solved : SolvedLines or None
        Lines of the sensors and of the sound.
    progress : callable
    """

    point: OperatingPoint
    solved: SolvedLines | None
    progress: Progress = silent

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
        found = [state for pair in self.pair_adjoints for state in pair.values()]
        for number, line in enumerate(self.lines):
            self.progress("adjoint states of gear pairs and lines", number / len(self.lines))
            found.append(adjoint(self.point, self.model.by_static(line)))
        return tuple(found)

    @property
    def outcomes(self) -> list[tuple[int, int]]:
        """Row and column in `Influence.changes` of each adjoint state of a gear pair."""
        return [(row, OUTCOMES.index(name)) for row, pair in enumerate(self.pair_adjoints) for name in pair]

    def by_bearing_stiffness(self, bearing: str) -> Influence:
        """Influence of a factor on a bearing's stiffness."""
        step = _Step(reference=1.0)
        return self._influence(
            bearing,
            "bearing stiffness",
            step,
            [state.by_bearing_stiffness(bearing) for state in self.adjoints],
            [self.model.by_bearing_stiffness(line, bearing) for line in self.lines],
            [self.model.stepped_bearing_stiffness(line, bearing, step.size) for line in self.lines],
            [self.model.stepped_bearing_stiffness(line, bearing, -step.size) for line in self.lines],
        )

    def by_bearing_position(self, bearing: str) -> Influence:
        """Influence of a bearing's position along its shaft."""
        step = _Step(reference=None)
        return self._influence(
            bearing,
            "bearing position",
            step,
            [state.by_bearing_position(bearing) for state in self.adjoints],
            [self.model.by_bearing_position(line, bearing) for line in self.lines],
            [self.model.stepped_bearing_position(line, bearing, step.size) for line in self.lines],
            [self.model.stepped_bearing_position(line, bearing, -step.size) for line in self.lines],
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
        report = partial(self.progress, "gradients of the housing's modes by its walls")
        rates = None if self.solved is None else self.solved.rates(fields, changes, report)
        by_response = np.zeros((len(self.lines), len(changes)))
        if rates is not None:
            by_response = np.array([self.model.by_housing(line, rates) for line in self.lines]) / slopes
        influences = []
        for number, change in enumerate(changes):
            self.progress("lines at a step of each wall", number / len(changes))
            step = _Step(change.reference, change.thickness)
            # Derivatives of the housing are by the parameter's coordinate.
            in_coordinate = step.size / change.slope
            stepped, reverse = (
                [] if rates is None else [self.model.stepped_housing(line, rates, number, size) for line in self.lines]
                for size in (in_coordinate, -in_coordinate)
            )
            influences.append(
                self._influence(
                    change.parameter,
                    change.kind,
                    step,
                    by_equilibrium[:, number],
                    by_response[:, number],
                    stepped,
                    reverse,
                )
            )
        return influences

    def _influence(
        self,
        parameter: str,
        kind: str,
        step: _Step,
        by_equilibrium: Sequence[float] | FloatArray,
        by_response: Sequence[float] | FloatArray,
        stepped: Sequence[float],
        reverse: Sequence[float],
    ) -> Influence:
        """Join the change of gear pairs and lines through the equilibrium with that of the lines' own responses.

        Parameters
        ----------
        parameter, kind : str
        step : _Step
        by_equilibrium : sequence of float, shape (n_adjoints,)
            Derivatives of all outcomes through the equilibrium [outcome/SI].
        by_response : sequence of float, shape (n_lines,)
            Derivatives of the lines at the same equilibrium.
        stepped, reverse : sequence of float, shape (n_lines,)
            Changes of the lines by the step and by its reverse at the same equilibrium, their responses solved again.
        """
        derivatives = np.asarray(by_equilibrium)
        changes = np.full((len(self.point.pairs), len(OUTCOMES)), np.nan)
        for place, derivative in zip(self.outcomes, derivatives, strict=False):
            changes[place] = step.size * derivative
        static = step.size * derivatives[len(self.outcomes) :]
        return Influence(
            parameter,
            kind,
            step.shown,
            step.reference is None,
            changes,
            static + step.size * np.asarray(by_response),
            static + np.asarray(stepped),
            np.asarray(reverse) - static if step.has_reverse else np.full(len(self.lines), np.nan),
            is_thickness=step.thickness is not None,
        )

    def densities(
        self, fields: StaticSensitivity, sensor_line: int, sound_line: int | None
    ) -> tuple[FloatArray, FloatArray | None, FloatArray | None]:
        """Return the changes by material added on the housing's surface, by its thickness and area.

        Parameters
        ----------
        fields : StaticSensitivity
            Displacements as for :meth:`by_housing`.
        sensor_line : int
            Number of the sensor's line.
        sound_line : int or None
            Number of the sound's line; None for the A-weighted sum of all.

        Returns
        -------
        misalignments : ndarray, shape (n_pairs, n_nodes)
            Changes of the misalignments [rad/m³].
        amplitude : ndarray, shape (n_nodes,), or None
            Change of the amplitude of the sensor's line [(m/s²)/m³].
        power : ndarray, shape (n_nodes,), or None
            Change of the power of the sound [W/m³].
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
            weights = sound_weights(self.solved.sound, sound_line)
            for number, weight in enumerate(weights, start=len(self.solved.of_sensors)):
                if weight > 0.0:
                    density = by_equilibrium[number] + self._response_density(fields, self.lines[number])
                    power += weight * density
        return misalignments, amplitude, power

    def _response_density(self, fields: StaticSensitivity, line: Line) -> FloatArray:
        """Change of a line by material added on the surface at the same equilibrium, shape (n_nodes,).

        It is the sum over the line's own harmonic and those that the stiffness that varies couples with it.
        """
        assert self.solved is not None
        density = np.zeros(len(fields.mesh.points))
        sizes = [np.linalg.norm(one.motion) * np.linalg.norm(one.adjoint) for one in line.fields]
        for one, size in zip(line.fields, sizes, strict=True):
            if size > _FAINT_FIELD * max(sizes):
                motion, against = self.solved.field(one.motion), self.solved.field(one.adjoint)
                density += harmonic_surface_density(fields.mesh, fields.constants, motion, against, one.frequency)
        return density


def solve_load_sensitivity(
    machine: Machine,
    point: OperatingPoint,
    housing: HousingModes | None = None,
    changes: Sequence[HousingChange] = (),
    *,
    acoustics: "Acoustics | None" = None,
    run: Run | None = None,
    line: str | None = None,
    note: str | None = None,
    progress: Progress = silent,
) -> LoadSensitivity:
    """Compute the gradients of an operating point, and of the sensors' lines and the sound about it, ranked.

    Parameters
    ----------
    machine : Machine
    point : OperatingPoint
        Operating point of the machine.
    housing : HousingModes, optional
        Housing that the machine stands in; without one bearings alone are ranked, by what they change in gear pairs.
    changes : sequence of HousingChange
        Parameters of the housing that are ranked.
    acoustics : Acoustics, optional
        Method and medium of the sound, whose lines are ranked by where it is given.
    run : SpeedRun or FreeRun, optional
        Course of the speed that the machine is assembled for.
    line : str, optional
        Line that is ranked and drawn, such as ``roof``, ``roof@1377`` or ``sound@1377``; by default the highest of
        a sensor, and the A-weighted power of the sound.
    note : str, optional
        Parts that are left out or stand in place of others, in words.
    progress : callable

    Raises
    ------
    UnknownLineError
        Where there is no such line.
    gearwhine.coupling.errors.AcousticsError
        Where the radiating surface cannot be made.
    gearwhine.housing.HousingError
        Where a line fails its proofs, see :meth:`gearwhine.housing.acoustics.radiation.RadiatedSound.require_proofs`.
    """
    solved = solve_lines(machine, point, housing, acoustics, run, progress)
    sensor_line, sound_line = _chosen(line, solved)
    progress("adjoint states of gear pairs and lines")
    ranking = Ranking(point, solved, progress)
    adjoints, influences = ranking.adjoints, list[Influence]()
    for number, bearing in enumerate(point.bearings):
        progress("lines at a step of each bearing", number / len(point.bearings))
        influences.append(ranking.by_bearing_stiffness(bearing.name))
        if not point.is_on_elastic_pin(bearing):
            influences.append(ranking.by_bearing_position(bearing.name))
    density, line_density, sound_density = None, None, None
    if adjoints and housing is not None and point.housing is not None:
        progress("gradients by the housing")
        fields = housing_fields(housing, point, adjoints)
        density, line_density, sound_density = ranking.densities(fields, sensor_line, sound_line)
        influences += ranking.by_housing(fields, changes)
    widths = np.array([pair.pair.geometry.face_width for pair in point.pairs])
    influences.sort(key=lambda influence: -float(np.abs(widths * influence.changes[:, 0]).max(initial=0.0)))
    of_carriers = None if housing is None else _note_of_carriers(machine)
    note = "; ".join(filter(None, (note, of_carriers, _note_of_pins(point)))) or None
    return LoadSensitivity(
        tuple(influences), density, note, solved, sensor_line, line_density, sound_line, sound_density
    )


def rank_parts(
    machine: Machine,
    point: OperatingPoint,
    *,
    acoustics: "Acoustics | None" = None,
    run: Run | None = None,
    line: str | None = None,
    progress: Progress = silent,
) -> LoadSensitivity:
    """Rank the bearings of a machine, and the walls of its housing where that has a finite-element model.

    Walls are those of a box of :meth:`gearwhine.housing.Housing.from_box`; of any other housing they are the flat faces
    of its surface.

    The parameters, and what is raised, are those of :func:`solve_load_sensitivity`.
    """
    housing, changes, note = None, tuple[HousingChange, ...](), None
    if isinstance(machine.housing, HousingModes):
        housing = machine.housing
        changes, note = _walls(housing.housing, machine)
    elif machine.housing is not None:
        note = (
            "walls are not ranked, nor are lines of sensors and sound looked at: the machine has a reduced housing, "
            "without the finite-element model that gearwhine.Housing.modes() keeps"
        )
    return solve_load_sensitivity(
        machine, point, housing, changes, acoustics=acoustics, run=run, line=line, note=note, progress=progress
    )


def _note_of_carriers(machine: Machine) -> str | None:
    """Say that lines are not ranked, and why, where a carrier turns."""
    carriers = turning_carriers(machine)
    if not carriers:
        return None
    names = " and ".join(map(repr, carriers))
    verb = "s" if len(carriers) == 1 else ""
    plural = "" if len(carriers) == 1 else "s"
    return f"lines of sensors and sound are not ranked, as the carrier{plural} {names} turn{verb}"


def _note_of_pins(point: OperatingPoint) -> str | None:
    """Say that positions of bearings are not ranked, and why, where they sit on elastic pins."""
    names = [repr(load.name) for load in point.bearings if point.is_on_elastic_pin(load)]
    return f"positions of bearings {', '.join(names)} are not ranked, as they sit on elastic pins" if names else None


def _walls(housing: Housing, machine: Machine) -> tuple[tuple[HousingChange, ...], str | None]:
    """Differentiate a housing by its walls, or by its flat faces, and say why where these stand in their place."""
    note = None
    if housing.box is not None:
        try:
            return wall_changes(housing, housing.box, machine), None
        except MorphError as error:
            note = f"{FACES_IN_PLACE_OF_WALLS}: {error}"
    return face_changes(housing.mesh, [seat.name for seat in housing.seats]), note


class UnknownLineError(CouplingError):
    """A line that is asked for and that no sensor and no sound has.

    Attributes
    ----------
    line : str
    expected : str
        Lines that there are, in words.
    """

    def __init__(self, line: str, expected: str) -> None:
        super().__init__(f"line {line!r}: expected {expected}")
        self.line, self.expected = line, expected


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
    for n, harmonic in enumerate(() if solved is None else solved.sound):
        names.setdefault(_SOUND, (0, together))
        names.setdefault(f"{_SOUND}@{harmonic.line.frequency / _TWO_PI:.0f}", (0, n))
    if text not in names:
        listed = ", ".join(repr(name) for name in names) or "none: no mesh drives a sensor or a sound"
        raise UnknownLineError(text, f"one of the highest lines: {listed}")
    return names[text]
