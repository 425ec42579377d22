"""Parametric housing: modes at any values of the fitted parameters, and surrogates about solved ones.

The parameters of a case's `[update]` are numbers of the case; each sets one or more places in it.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy import sparse

from gearwhine.case import Case, CaseError, Housing, Problem, UpdateParameter, case_document, parse_case
from gearwhine.case.box import wall_by_face
from gearwhine.case.checks.housing import box_geometry
from gearwhine.case.errors import Location, key_of, look_up
from gearwhine.case.input_files import InputFiles
from gearwhine.case.overrides import matching_places, parse_key_path
from gearwhine.case.units import amount, si_amount
from gearwhine.from_case.fixtures import build_fixtures
from gearwhine.from_case.given_housing import GivenHousing, given_housing
from gearwhine.from_case.housing import build_seats, refused_by_key
from gearwhine.from_case.mesh import build_mesh, materials_of
from gearwhine.housing import HousingError, assemble, attach_fixtures, solve_modes
from gearwhine.housing.fem.matrices import Additions
from gearwhine.housing.material import element_constants
from gearwhine.housing.measured.survey_planning import survey_grid
from gearwhine.housing.model.seats import seat_matrix
from gearwhine.housing.updating import (
    ModalState,
    ModelSensitivity,
    Parameter,
    Surrogate,
    modal_sensitivities,
    values_at,
)
from gearwhine.meshes import BoxGeometry, BoxMorph, GeometryError, Mesh, mesh_quality
from gearwhine.meshes.box.morph import MorphError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress, silent

_SPREAD = 1.0 / 3.0  # default spread over the larger distance from the nominal value to an end of the range
_SAME_NUMBER_DIFFERENCE = 1e-9  # relative difference of numbers written in different units

RATE_STEP = 1e-4
"""Step in z of the central differences by a parameter."""

_COMMAND = "update"
_WORST_SHAPE = 0.12  # shape number below which a moved mesh is given up for a new one


@dataclass(frozen=True)
class FittedNumber:
    """A parameter of the case, and the places that it sets.

    Attributes
    ----------
    given : UpdateParameter
    parameter : gearwhine.housing.updating.Parameter
        Parameter with its range and prior [SI].
    places : tuple of locations
    own : tuple of float
        Value at each place before the fit [SI].
    """

    given: UpdateParameter
    parameter: Parameter
    places: tuple[Location, ...]
    own: tuple[float, ...]

    @property
    def start(self) -> float:
        """Value in the case as it stands [SI]; 1 of a factor."""
        return 1.0 if self.given.factor else self.own[0]

    def as_written(self, value: float) -> float:
        """Return a value as the updated case has it: five digits in the unit of its range."""
        unit = unit_in_si(self.given)
        return float(f"{value / unit:.5g}") * unit

    def entries(self, value: float) -> Iterator[tuple[Location, float]]:
        """Yield the places to set and their numbers for a value [SI]."""
        for place, before in zip(self.places, self.own, strict=True):
            yield place, before * value if self.given.factor else value


@dataclass(frozen=True)
class FittedCase:
    """A case with fitted numbers, which makes the case of any values.

    Attributes
    ----------
    document : dict
        The case resolved, with a wall of its own for each face.
    numbers : tuple of FittedNumber
    files : InputFiles
        Input files of the case, which are not read again.
    """

    document: dict[str, Any]
    numbers: tuple[FittedNumber, ...]
    files: InputFiles

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Fitted parameters."""
        return tuple(number.parameter for number in self.numbers)

    @property
    def start(self) -> FloatArray:
        """Coordinates z of the case as it stands."""
        return np.array([number.parameter.coordinate(number.start) for number in self.numbers])

    def at(self, values: Sequence[float]) -> Case:
        """Return the case with these values in place.

        Raises
        ------
        CaseError
            Where the values make no valid case.
        """
        return parse_case(self.document_at(values), source="update", files=self.files.copy())

    def housing_at(self, values: Sequence[float]) -> GivenHousing:
        """Return the housing of the case with these values in place; raises as :meth:`at`."""
        return given_housing(self.at(values), _COMMAND)

    def document_at(self, values: Sequence[float]) -> dict[str, Any]:
        """Return the document of the case with these values, as tables and lists."""
        document = self.document
        for number, value in zip(self.numbers, values, strict=True):
            for place, entry in number.entries(value):
                document = with_entry(document, place, entry)
        return document


_WALL: Location = ("housing", "box", "wall")


def fitted_case(
    case: Case, mesh_size: float | None = None, parameters: Sequence[UpdateParameter] | None = None
) -> FittedCase:
    """Return the case with its fitted parameters, or with ``parameters``; ``mesh_size`` [m] replaces that of a box.

    Raises
    ------
    CaseError
        With every key that leads to no number, is set twice, or whose number is outside its range, and every parameter
        whose keys have different numbers and no factor.
    """
    if parameters is None:
        parameters = () if case.update is None else case.update.parameter
    document = case_document(case)
    box = document.get("housing", {}).get("box")
    if box is not None:
        box["wall"] = wall_by_face(box["wall"])
    if box is not None and mesh_size is not None:
        box["mesh_size"] = mesh_size
    problems: list[Problem] = []
    numbers, owner_of = [], dict[Location, str]()
    for index, parameter in enumerate(parameters):
        label = f'parameter "{parameter.name}"'
        places = list[Location]()
        values = list[float]()
        for position, key in enumerate(parameter.keys):
            where = f"update.parameter[{index}].keys[{position}]"
            steps = parse_key_path(key)
            matches = list(matching_places(document, steps or ()))
            if not matches:
                problems.append(Problem(where, key, "the key path of a number in this case", label))
            if matches == [_WALL]:  # one thickness for all walls
                matches = [(*_WALL, face) for face in document["housing"]["box"]["wall"]]
            for place in matches:
                value = si_amount(look_up(document, place))
                if value is None:
                    problems.append(Problem(where, key, f"a number; {key_of(place)} is none", label))
                elif place in owner_of:
                    problems.append(Problem(where, key, f"a key that no other sets ({owner_of[place]!r} does)", label))
                else:
                    owner_of[place] = parameter.name
                    places.append(place)
                    values.append(value)
        if places and len(values) == len(places):
            number = _number(parameter, tuple(places), tuple(values), index, label, problems)
            numbers += [] if number is None else [number]
    if problems:
        raise CaseError(problems)
    return FittedCase(document, tuple(numbers), case.input_files)


def _number(
    entry: UpdateParameter,
    places: tuple[Location, ...],
    values: tuple[float, ...],
    index: int,
    label: str,
    problems: list[Problem],
) -> FittedNumber | None:
    low, high = entry.bounds
    if not entry.factor and not np.allclose(values, values[0], rtol=_SAME_NUMBER_DIFFERENCE, atol=0.0):
        other = next(
            place
            for place, value in enumerate(values)
            if not np.isclose(value, values[0], rtol=_SAME_NUMBER_DIFFERENCE, atol=0.0)
        )
        shown = " and ".join(f"{key_of(places[place])} is {values[place]:g}" for place in (0, other))
        expected = f"keys with one number in the case, or 'factor = true'; {shown} (SI)"
        problems.append(Problem(f"update.parameter[{index}].keys", list(entry.keys), expected, label))
        return None
    start = 1.0 if entry.factor else values[0]
    nominal = start if entry.nominal is None else amount(entry.nominal)
    if not low <= start <= high or not low <= nominal <= high:
        expected = f"a range with the case's own {start:g} in it (SI)"
        problems.append(Problem(f"update.parameter[{index}].range", list(entry.range), expected, label))
        return None
    spread = _SPREAD * max(high - nominal, nominal - low) if entry.spread is None else amount(entry.spread)
    return FittedNumber(entry, Parameter(entry.name, low, high, nominal, spread), places, values)


def unit_in_si(parameter: UpdateParameter) -> float:
    """SI value of the unit that a parameter is written in."""
    return amount(f"1 {parameter.unit}") if parameter.unit else 1.0


def with_entry(document: Any, place: Location, value: Any) -> Any:
    """Return tables and lists with one entry replaced; parts beside the path to it are shared."""
    if not place:
        return value
    step, *rest = place
    copy = document.copy()
    copy[step] = with_entry(document[step], tuple(rest), value)
    return copy


@dataclass(frozen=True)
class MeshedParameters:
    """A fitted case at coordinates z on a mesh: derivatives of the housing's model by its parameters.

    Attributes
    ----------
    fitted : FittedCase
    coordinates : ndarray, shape (n_parameters,)
    given : GivenHousing
        Housing at the coordinates.
    mesh : Mesh
        Its mesh.
    """

    fitted: FittedCase
    coordinates: FloatArray
    given: GivenHousing
    mesh: Mesh

    def beside(self, number: int) -> tuple[GivenHousing, GivenHousing]:
        """Return the housings `RATE_STEP` above and below in one coordinate."""
        either = []
        for way in (1.0, -1.0):
            # The step is not limited by the range, at whose end the case's own value may stand.
            parameter = self.fitted.parameters[number]
            values = values_at(self.fitted.parameters, self.coordinates)
            values[number] += parameter.deviation(float(self.coordinates[number]), way * RATE_STEP)
            either.append(self.fitted.housing_at(values.tolist()))
        return either[0], either[1]

    def rates(self) -> list[ModelSensitivity]:
        """Differentiate the model by each coordinate: central differences of quantities linear in small steps."""
        return [self._rate(number) for number in range(len(self.coordinates))]

    def _rate(self, number: int) -> ModelSensitivity:
        above, below = self.beside(number)
        velocity = self._velocity(above, below)
        return ModelSensitivity(
            velocity, self._constants_rate(above, below), *self._attached_rates(above, below, velocity)
        )

    def _velocity(self, above: GivenHousing, below: GivenHousing) -> FloatArray | None:
        upper, lower = geometry_of(above.table), geometry_of(below.table)
        if upper is None or lower is None or upper == lower:
            return None
        apart = self.morph.displacement(upper) - self.morph.displacement(lower)
        return np.asarray(apart / (2.0 * RATE_STEP))

    @cached_property
    def morph(self) -> BoxMorph:
        """Morphing of the mesh to other dimensions of its box.

        Raises
        ------
        meshes.box.morph.MorphError
            Where the housing is no box, or one whose mesh cannot follow.
        """
        geometry = geometry_of(self.given.table)
        if geometry is None:
            raise MorphError("the housing is no box: expected one, whose mesh follows its dimensions")
        return BoxMorph(self.mesh, geometry)

    def _constants_rate(self, above: GivenHousing, below: GivenHousing) -> FloatArray | None:
        if above.materials == below.materials:
            return None
        constants = []
        for given in (above, below):
            parted, material, materials = materials_of(given.table, given.materials, self.mesh)
            constants.append(element_constants(parted, material, materials))
        return np.asarray((constants[0] - constants[1]) / (2.0 * RATE_STEP))

    def _attached_rates(
        self, above: GivenHousing, below: GivenHousing, velocity: FloatArray | None
    ) -> tuple[sparse.csr_array | None, sparse.csr_array | None]:
        # What is built is compared, not its tables: bolts of a cover depend on materials and on the box, too.
        fixtures = [build_fixtures(given.table, given.materials) for given in (above, below)]
        if velocity is None and fixtures[0] == fixtures[1]:
            return None, None
        matrices = []
        for built, way in zip(fixtures, (1.0, -1.0), strict=True):
            mesh = self.mesh
            if velocity is not None:
                mesh = replace(mesh, points=mesh.points + way * RATE_STEP * velocity)
            total = sum((fixture.additions(mesh) for fixture in built), Additions())
            n = len(mesh.points)
            matrices.append((total.stiffness.matrix(n), total.mass.matrix(n)))
        stiffness, mass = ((upper - lower) / (2.0 * RATE_STEP) for upper, lower in zip(*matrices, strict=True))
        return sparse.csr_array(stiffness), sparse.csr_array(mass)


def geometry_of(table: Housing) -> BoxGeometry | None:
    """Return the dimensions of the box that is a housing; None for another one."""
    return None if table.box is None else box_geometry(table.box, table.seat)


@dataclass(frozen=True)
class ParametricHousing:
    """Solves the housing of a case at coordinates z of its parameters.

    Attributes
    ----------
    case : FittedCase
    modes : int
        Number of modes, rigid ones counted.
    measured : callable, optional
        Returns for a mesh the matrix of the degrees of freedom where shapes were measured, shape (n_dofs, 3 n_nodes).
    threads : int
    progress : callable
    draft : bool
        Whether modes are solved without proof, as within a search (:func:`gearwhine.housing.solve_modes`).
    as_written : bool
        Whether values are rounded as an updated case has them, so that the solved design is the written one: other last
        digits may lead to another mesh, and change frequencies by some 0.03 %.
    """

    case: FittedCase
    modes: int
    measured: Callable[[Mesh], sparse.csr_array] | None = None
    threads: int = 2
    progress: Progress = silent
    draft: bool = False
    as_written: bool = False

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Fitted parameters."""
        return self.case.parameters

    @property
    def start(self) -> FloatArray:
        """Coordinates z of the case as it stands."""
        return self.case.start

    def housing_at(self, coordinates: FloatArray) -> GivenHousing:
        """Return the housing at coordinates."""
        values = values_at(self.parameters, coordinates).tolist()
        if self.as_written:
            values = [number.as_written(value) for number, value in zip(self.case.numbers, values, strict=True)]
        return self.case.housing_at(values)

    def solve(self, coordinates: FloatArray, near: "HousingAtParameters | None" = None) -> "HousingAtParameters":
        """Solve at coordinates, on the mesh of a neighbour where that can follow, else on a new one.

        Raises
        ------
        gearwhine.housing.HousingError
            Where the values make no valid housing.
        """
        try:
            given = self.housing_at(coordinates)
            followed = None if near is None else _followed(near, given.table)
            if followed is not None:
                try:
                    return self._solved(coordinates, given, followed)
                except HousingError:
                    pass  # the move may have folded an element, which a new mesh avoids
            return self._solved(coordinates, given, build_mesh(given.table, given.materials, given.files))
        except (CaseError, GeometryError) as error:
            raise HousingError(str(error)) from error

    def _solved(self, coordinates: FloatArray, given: GivenHousing, mesh: Mesh) -> "HousingAtParameters":
        """Solve the modes of a housing on its mesh."""
        table = given.table
        parted, material, materials = materials_of(table, given.materials, mesh)
        free = assemble(parted, material, materials, threads=self.threads)
        with refused_by_key(table):
            matrices = attach_fixtures(free, mesh, build_fixtures(table, given.materials))
        every = solve_modes(matrices, count=self.modes, draft=self.draft, threads=self.threads)
        n_rigid = int(np.count_nonzero(every.frequencies == 0.0))
        if n_rigid == len(every.frequencies):
            raise HousingError(f"all {n_rigid} modes are rigid: expected elastic ones too; ask for more (update.modes)")
        # Rigid modes are left out once, here: state, shapes and rates number the same modes.
        solved = replace(every, frequencies=every.frequencies[n_rigid:], shapes=every.shapes[n_rigid:])
        ports = [seat_matrix(mesh, seat) for seat in build_seats(table)]
        seats = (
            np.stack([solved.project(port)[:, :2] for port in ports], axis=1)
            if ports
            else np.empty((len(solved.frequencies), 0, 2))
        )
        bounds = None if table.box is None else np.array([table.box.lower, table.box.upper])
        skin = survey_grid(mesh, bounds).normal_motion(solved.shapes)
        measured = None if self.measured is None else solved.project(self.measured(mesh))
        state = ModalState(solved.frequencies, seats, skin, measured, n_rigid)
        return HousingAtParameters(self, np.asarray(coordinates), given, mesh, state, solved.shapes)


@dataclass(frozen=True)
class HousingAtParameters:
    """A housing solved at coordinates z.

    Attributes
    ----------
    designs : ParametricHousing
        The parametric housing.
    coordinates : ndarray, shape (n_parameters,)
    given : GivenHousing
    mesh : Mesh
    state : gearwhine.housing.updating.ModalState
    shapes : ndarray, shape (n_modes, n_nodes, 3), or None
        Mass-normalised shapes of the state's modes [1/√kg]; None once they are dropped.
    known : Surrogate or None
        Surrogate about these coordinates, where it is computed already.
    """

    designs: ParametricHousing
    coordinates: FloatArray
    given: GivenHousing
    mesh: Mesh
    state: ModalState
    shapes: FloatArray | None
    known: Surrogate | None = None

    def surrogate(self) -> Surrogate:
        """Return the surrogate about these coordinates, by the exact rates of stiffness and mass."""
        return self._surrogate if self.known is None else self.known

    def light(self) -> "HousingAtParameters":
        """Return a copy for another process, with its surrogate and without its shapes: a twentieth of the size."""
        return replace(self, shapes=None, known=self.surrogate())

    @cached_property
    def _surrogate(self) -> Surrogate:
        assert self.shapes is not None
        parted, material, materials = materials_of(self.given.table, self.given.materials, self.mesh)
        constants = element_constants(parted, material, materials)
        rates = modal_sensitivities(self.mesh, constants, self.shapes, self.rates())
        return Surrogate.about(self.coordinates, self.state, rates)

    def rates(self) -> list[ModelSensitivity]:
        """Differentiate the model by each coordinate: central differences of quantities linear in small steps."""
        return self._meshed.rates()

    @cached_property
    def _meshed(self) -> MeshedParameters:
        return MeshedParameters(self.designs.case, self.coordinates, self.given, self.mesh)


def _followed(near: HousingAtParameters, table: Housing) -> Mesh | None:
    """Return the neighbour's mesh, moved to the geometry of a table; None where it cannot or should not be."""
    geometry = geometry_of(table)
    if geometry is None or geometry == geometry_of(near.given.table):
        return near.mesh
    try:
        mesh = near._meshed.morph.moved(geometry)
    except MorphError:
        return None
    return mesh if mesh_quality(mesh).shape[0] > _WORST_SHAPE else None
