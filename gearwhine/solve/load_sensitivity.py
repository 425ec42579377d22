"""Sensitivity of a case's operating point: change of gear pairs, sensors' lines and sound power by walls and bearings.

The gradients are those of :mod:`coupling.statics.sensitivity` and :mod:`coupling.linear.mesh_harmonics`. Parameters of
the housing are those of the case's ``[update]``, else the walls of a box; of any other housing, the flat faces of its
surface.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy import sparse

from coupling import Machine
from coupling.linear.line_outputs import SensorAmplitude
from coupling.linear.mesh_harmonics import Line
from coupling.statics.operating_point import OperatingPoint
from coupling.statics.sensitivity import OUTCOMES, Adjoint, adjoint, pair_adjoints
from gearwhine.case import Case, CaseError, Problem, UpdateParameter
from gearwhine.case.box import FACES
from gearwhine.case.overrides import parse_key_path
from gearwhine.case.units import kind_of
from gearwhine.from_case.mesh import materials_of
from gearwhine.from_case.parametric_housing import RATE_STEP, MeshedParameters, fitted_case
from gearwhine.progress import Progress, silent
from gearwhine.solve.housing_modes import SolvedHousing, bearing_places
from gearwhine.solve.line_sensitivity import SolvedLines, solve_lines
from housing.fem.surface import flat_faces
from housing.model.housing import bearing_port
from housing.model.material import element_constants
from housing.model.seats import seat_matrix, sensor_port
from housing.updating import ModelSensitivity
from housing.updating.static_sensitivity import PortRates, StaticSensitivity, harmonic_surface_density
from meshes import Mesh
from meshes.box.morph import MorphError, with_middles

if TYPE_CHECKING:
    from gearwhine.solve.sound.mesh_harmonics import HarmonicSound

FloatArray = npt.NDArray[np.float64]
Ports = dict[str, sparse.csr_array]

_LENGTH, _PART = 1e-3, 0.1  # steps of the table: of lengths [m], and relative ones
_OUT = 1e-3  # part of a line below which it is not told
_OFF, _SIGN = 1.0, 0.3  # differences of a level from the first order that are large, and where the signs differ [dB]
_SOUND = "sound"  # of --line, beside the sensors
_TWO_PI = 2.0 * np.pi
_LEAST_FACE = 0.01  # part of the whole surface from which a flat face is told


@dataclass(frozen=True, eq=False)
class Influence:
    """Influence of a parameter on every gear pair and every line, to first order.

    Attributes
    ----------
    parameter : str
    kind : str
        ``housing``, ``face``, ``bearing stiffness`` or ``bearing position``.
    step : float
        Change of the parameter: a length [m], or a part of its value.
    is_length : bool
    changes : ndarray, shape (n_pairs, 3)
        Of the `OUTCOMES` by the step; NaN for the last two of an idle pair.
    lines : ndarray, shape (n_lines,)
        Of the lines by the step to first order: amplitudes of sensors [m/s²], then powers of the sound [W].
    stepped, reversed : ndarray, shape (n_lines,)
        The same with the response at the step solved anew, and at the reverse step; NaN where there is nothing left to
        take away.
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
        """The step and its reverse in words, such as ``1 mm thicker`` and ``1 mm thinner``."""
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
        Of the value to first order.
    change, reverse : float
        Of the value by the step and by the reverse step, the response solved anew; NaN where there is none.
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
        """Change of its level, the response solved anew [dB]."""
        return self._level(self.change)

    @property
    def reverse_level(self) -> float | None:
        """The same by the reverse step; None where there is nothing left to take away [dB]."""
        return None if math.isnan(self.reverse) else self._level(self.reverse)

    @property
    def first_order_is_off(self) -> bool:
        """Whether the level at either step is far from the first order: a resonance moves within it."""
        reverse = self.reverse_level
        pairs = [(self.level, self.first_order_level)]
        pairs += [] if reverse is None else [(reverse, -self.first_order_level)]
        return any(
            abs(level - first) > _OFF or (level * first < 0.0 and abs(level - first) > _SIGN) for level, first in pairs
        )

    def _level(self, change: float) -> float:
        # The part by the equilibrium is linear: a line that it would put out is as good as out.
        return self.decibels * math.log10(max(1.0 + change / self.value, _OUT))


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
        weights, own = _sound_weights(self.loudest_lines, None), self.sound_changes(influence)
        value, first, change, reverse = (
            float(weights @ [getattr(one, of) for one in own]) for of in ("value", "first_order", "change", "reverse")
        )
        return LineChange(value, own[0].decibels, first, change, reverse)

    def _changes(self, influence: Influence) -> list[LineChange]:
        lines = () if self.lines is None else self.lines.lines
        each = (influence.lines.tolist(), influence.stepped.tolist(), influence.reversed.tolist())
        changes = zip(lines, *each, strict=True)
        return [
            LineChange(line.value, line.output.decibels, first, anew, back, line) for line, first, anew, back in changes
        ]


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
    chosen, chosen_sound = _chosen(line, solved)
    progress("adjoint states of gear pairs and lines")
    pairs = pair_adjoints(point)
    places = [(n, OUTCOMES.index(name)) for n, pair in enumerate(pairs) for name in pair]
    adjoints = [one for pair in pairs for one in pair.values()]
    model, lines = (None, ()) if solved is None else (solved.model, solved.lines)
    adjoints += [adjoint(point, model.by_static(one)) for one in lines if model is not None]

    def influence(
        parameter: str,
        kind: str,
        step: tuple[float, bool],
        derivatives: FloatArray,
        direct: FloatArray,
        anew: tuple[FloatArray, FloatArray],
    ) -> Influence:
        """Gather derivatives by the equilibrium, those of lines at the same equilibrium, and lines at either step."""
        changes = np.full((len(pairs), len(OUTCOMES)), np.nan)
        size = step[0]
        for place, derivative in zip(places, derivatives, strict=False):
            changes[place] = size * derivative
        static = size * derivatives[len(places) :]
        there, back = anew
        return Influence(parameter, kind, *step, changes, static + size * direct, static + there, back - static)

    def either(stepped: Callable[..., float], *what: object, size: float) -> tuple[FloatArray, FloatArray]:
        """Return the changes of the lines by a step and by its reverse, the response solved anew."""
        there, back = (np.array([stepped(one, *what, step) for one in lines]) for step in (size, -size))
        return there, back

    none = np.zeros(0), np.zeros(0)
    found = []
    for name in (bearing.name for bearing in point.bearings):
        derivatives = np.array([one.by_bearing_stiffness(name) for one in adjoints])
        direct = np.array([model.by_bearing_stiffness(one, name) for one in lines if model is not None])
        anew = none if model is None else either(model.stepped_bearing_stiffness, name, size=_PART)
        found.append(influence(name, "bearing stiffness", (_PART, False), derivatives, direct, anew))
        derivatives = np.array([one.by_bearing_position(name) for one in adjoints])
        direct = np.array([model.by_bearing_position(one, name) for one in lines if model is not None])
        anew = none if model is None else either(model.stepped_bearing_position, name, size=_LENGTH)
        found.append(influence(name, "bearing position", (_LENGTH, True), derivatives, direct, anew))
    density, note, line_density, sound_density = None, None, None, None
    if adjoints and housing is not None and point.housing is not None:
        progress("gradients by the housing")
        fields = housing_fields(case, housing, point, adjoints)
        surface = fields.surface_density()
        density = surface[[n for n, (_, outcome) in enumerate(places) if outcome == 0]]
        if solved is not None:
            by_equilibrium, first_sound = surface[len(places) :], len(solved.of_sensors)
            if solved.of_sensors:
                line_density = by_equilibrium[chosen] + _harmonic_density(solved, fields, lines[chosen])
            if solved.sound:
                sound_density = np.zeros(len(fields.mesh.points))
                for n, weight in enumerate(_sound_weights(solved.sound, chosen_sound), start=first_sound):
                    if weight > 0.0:
                        sound_density += weight * (by_equilibrium[n] + _harmonic_density(solved, fields, lines[n]))
        parameters = housing_parameters(case)
        try:
            changes = case_changes(case, fields.mesh, parameters) if parameters else face_changes(case, fields.mesh)
        except MorphError as error:
            parameters, changes = (), face_changes(case, fields.mesh)
            note = f"the mesh of the box does not follow its walls, so that flat faces stand in their place: {error}"
        kind = "housing" if parameters else "face"
        derivatives = fields.by_parameters(changes.rates, changes.bearings) / changes.slopes
        steps = np.array([_LENGTH if size is None else _PART * size for size in changes.sizes])
        own = np.zeros((len(lines), len(steps)))
        each = [none] * len(steps)
        if solved is not None:
            rates = solved.rates(
                fields.constants, changes.rates, changes.bearings, changes.sensors, fields.displacement
            )
            own = np.array([solved.model.by_housing(one, rates) for one in lines]) / changes.slopes
            each = [
                either(solved.model.stepped_housing, rates, n, size=inner)
                for n, inner in enumerate((steps / changes.slopes).tolist())
            ]
        for n, (name, size) in enumerate(zip(changes.names, changes.sizes, strict=True)):
            step = (float(steps[n]), size is None)
            one = influence(name, kind, step, derivatives[:, n], own[:, n], each[n])
            thickness = changes.thicknesses[n]
            one = replace(one, is_thickness=thickness is not None, step=step[0] if size is None else _PART)
            if thickness is not None and thickness <= steps[n]:
                one = replace(one, reversed=np.full(len(lines), np.nan))
            found.append(one)
    widths = np.array([pair.pair.geometry.face_width for pair in point.pairs])
    found.sort(key=lambda one: -float(np.abs(widths * one.changes[:, 0]).max(initial=0.0)))
    return LoadSensitivity(tuple(found), density, note, solved, chosen, line_density, chosen_sound, sound_density)


def _harmonic_density(solved: SolvedLines, fields: StaticSensitivity, line: Line) -> FloatArray:
    """Density of a line's output by material added on the surface at the same equilibrium, shape (n_nodes,)."""
    motion, adjoint = solved.field(line.motion), solved.field(line.adjoint)
    return harmonic_surface_density(fields.mesh, fields.constants, motion, adjoint, line.frequency)


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


def housing_fields(
    case: Case, housing: SolvedHousing, point: OperatingPoint, adjoints: Sequence[Adjoint]
) -> StaticSensitivity:
    """Return the displacements of a housing's nodes at an operating point and of adjoint states, with their forces."""
    assert point.housing is not None
    parted, material, materials = materials_of(case, housing.mesh)
    every = np.arange(len(housing.mesh.points))
    gravity = point.shafts[0].gravity
    return StaticSensitivity(
        housing.mesh,
        element_constants(parted, material, materials),
        housing.modes.displacement(point.housing, every),
        np.array([housing.modes.displacement(one.housing, every) for one in adjoints]),
        {one.name: one.force for one in point.bearings},
        {bearing.name: np.array([one.force(bearing.name) for one in adjoints]) for bearing in point.bearings},
        np.zeros(3) if gravity is None else np.array(gravity),
    )


def housing_parameters(case: Case) -> tuple[UpdateParameter, ...]:
    """Return the parameters of a case's ``[update]``, else a thickness for every wall of its box; none for others."""
    if case.update is not None:
        return tuple(case.update.parameter)
    if case.housing is None or case.housing.box is None:
        return ()
    box = case.housing.box
    made = []
    for face in FACES:
        thickness = getattr(box.walls, face)
        is_cover = box.cover is not None and box.cover.face == face and box.cover.thickness is not None
        key = "housing.box.cover.thickness" if is_cover else f"housing.box.wall.{face}"
        span = (f"{0.5 * thickness:.9g} m", f"{2.0 * thickness:.9g} m")
        made.append(UpdateParameter(name=f"{face} wall", keys=(key,), range=span))
    return tuple(made)


@dataclass(frozen=True, eq=False)
class HousingChanges:
    """Changes of a housing by some parameters, in SI.

    Attributes
    ----------
    names : tuple of str
    rates : tuple of ModelSensitivity
        Per unit of the coordinate that a parameter has.
    bearings, sensors : tuple of mapping
        Change of the ports of bearings and of sensors; empty where they stay.
    slopes : ndarray, shape (n_parameters,)
        Change of each parameter by a unit of its coordinate.
    sizes : tuple of float or None
        Value of each parameter; None of a length.
    thicknesses : tuple of float or None
        Thickness of each wall [m], infinite of a face, whose wall is not known; None of other parameters.
    """

    names: tuple[str, ...]
    rates: tuple[ModelSensitivity, ...]
    bearings: tuple[PortRates, ...]
    sensors: tuple[PortRates, ...]
    slopes: FloatArray
    sizes: tuple[float | None, ...]
    thicknesses: tuple[float | None, ...]


def by_case_parameters(case: Case, fields: StaticSensitivity, parameters: Sequence[UpdateParameter]) -> FloatArray:
    """Differentiate outcomes by numbers of a case's housing, in SI, shape (n_adjoints, n_parameters).

    Raises
    ------
    CaseError, meshes.box.morph.MorphError
        As :func:`case_changes`.
    """
    if not parameters:
        return np.zeros((len(fields.adjoint), 0))
    changes = case_changes(case, fields.mesh, parameters)
    return np.asarray(fields.by_parameters(changes.rates, changes.bearings) / changes.slopes)


def case_changes(case: Case, mesh: Mesh, parameters: Sequence[UpdateParameter]) -> HousingChanges:
    """Differentiate the model of a case's housing, its bearings' and its sensors' ports by numbers of the case.

    Raises
    ------
    CaseError
        As :func:`gearwhine.from_case.parametric_housing.fitted_case`.
    meshes.box.morph.MorphError
        Where the mesh of a box cannot follow.
    """
    fitted = fitted_case(case, parameters=parameters)
    meshed = MeshedParameters(fitted, fitted.start, case, mesh)
    rates = meshed.rates()
    ports = [_port_rates(meshed, number, rate) for number, rate in enumerate(rates)]
    slopes = [one.deviation(z, 1.0) for one, z in zip(fitted.parameters, fitted.start.tolist(), strict=True)]
    return HousingChanges(
        tuple(one.name for one in fitted.parameters),
        tuple(rates),
        tuple(bearings for bearings, _ in ports),
        tuple(sensors for _, sensors in ports),
        np.array(slopes),
        tuple(None if _is_length(number.given) else number.start for number in fitted.numbers),
        tuple(number.start if _is_thickness(number.given) else None for number in fitted.numbers),
    )


def _is_length(given: UpdateParameter) -> bool:
    return not given.factor and kind_of(given.range[0]) == kind_of("1 m")


def _is_thickness(given: UpdateParameter) -> bool:
    """Whether a parameter is the thickness of a wall, or of several, and no factor on them."""
    steps = [parse_key_path(key) or () for key in given.keys]
    return _is_length(given) and all({"wall", "thickness"} & set(path[-2:]) for path in steps)


def _port_rates(meshed: MeshedParameters, number: int, rate: ModelSensitivity) -> tuple[PortRates, PortRates]:
    """Differentiate the ports of all bearings and sensors by a coordinate; empty where they stay."""
    above, below = meshed.beside(number)
    assert above.housing is not None
    assert below.housing is not None
    still = rate.velocity is None
    if still and above.housing.seat == below.housing.seat and above.housing.sensor == below.housing.sensor:
        return {}, {}
    ports: list[tuple[Ports, Ports]] = []
    for case, way in ((above, 1.0), (below, -1.0)):
        assert case.housing is not None
        mesh = (
            meshed.mesh
            if rate.velocity is None
            else replace(meshed.mesh, points=meshed.mesh.points + way * RATE_STEP * rate.velocity)
        )
        seats = {seat.name: seat.build() for seat in case.housing.seat}
        places = bearing_places(case)
        ports.append(
            (
                {name: bearing_port(seat_matrix(mesh, seats[seat]), arm) for name, (seat, arm) in places.items()},
                {one.name: sensor_port(mesh, one.build()).matrix for one in case.housing.sensor},
            )
        )
    bearings, sensors = (
        {name: (port - after[name]) / (2.0 * RATE_STEP) for name, port in before.items()}
        for before, after in zip(*ports, strict=True)
    )
    return bearings, sensors


def face_changes(case: Case, mesh: Mesh) -> HousingChanges:
    """Differentiate the model of a case's housing by material on the large flat faces of its surface, in words.

    A face moves along its normal with the layer of elements on it; seats and what is fastened stay.
    """
    assert case.housing is not None
    seats = [mesh.surface(seat.name) for seat in case.housing.seat]
    held = np.unique(np.concatenate([block.nodes.ravel() for seat in seats for block in seat] or [np.empty(0, int)]))
    faces = flat_faces(mesh)
    whole = sum(face.area for face in faces)
    names, rates = [], []
    for face in faces:
        if face.area < _LEAST_FACE * whole:
            continue
        velocity = np.zeros_like(mesh.points)
        velocity[np.unique(np.concatenate([block.corners.ravel() for block in face.facets]))] = face.normal
        velocity[held] = 0.0
        rates.append(ModelSensitivity(with_middles(mesh, velocity)))
        axis = int(np.abs(face.normal).argmax())
        way = f"{'-+'[int(face.normal[axis] > 0.0)]}{'xyz'[axis]}"
        x, y, z = (1e3 * face.center).round().astype(int).tolist()
        names.append(f"{way} at {x}, {y}, {z} mm")
    still: tuple[PortRates, ...] = ({},) * len(rates)
    endless = (math.inf,) * len(rates)
    return HousingChanges(tuple(names), tuple(rates), still, still, np.ones(len(rates)), (None,) * len(rates), endless)
