"""Changes of a case's housing by its parameters: derivatives of its model and of the ports of bearings and sensors.

Parameters are those of the case's ``[update]``, else the walls of a box; of any other housing, the flat faces of its
surface.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.case import Case, UpdateParameter
from gearwhine.case.box import FACES
from gearwhine.case.model import housing_table
from gearwhine.case.overrides import parse_key_path
from gearwhine.case.units import kind_of
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.coupling.statics.sensitivity import Adjoint
from gearwhine.from_case.housing import bearing_places, build_seats
from gearwhine.from_case.parametric_housing import RATE_STEP, MeshedParameters, fitted_case
from gearwhine.housing import HousingModes
from gearwhine.housing.fem.surface import flat_faces
from gearwhine.housing.material import element_constants
from gearwhine.housing.model.seats import bearing_port, seat_matrix, sensor_port
from gearwhine.housing.updating import ModelSensitivity
from gearwhine.housing.updating.static_sensitivity import PortRates, StaticSensitivity
from gearwhine.meshes import Mesh
from gearwhine.meshes.box.morph import MorphError, with_middles

FloatArray = npt.NDArray[np.float64]

_COMMAND = "load --sensitivity"
_LEAST_FACE = 0.01  # part of the whole surface from which a flat face is a parameter


def housing_fields(housing: HousingModes, point: OperatingPoint, adjoints: Sequence[Adjoint]) -> StaticSensitivity:
    """Return the displacements of a housing's nodes at an operating point and of adjoint states, with their forces."""
    assert point.housing is not None
    described = housing.housing
    every = np.arange(len(housing.mesh.points))
    gravity = point.shafts[0].gravity
    return StaticSensitivity(
        housing.mesh,
        element_constants(described.mesh, described.material, described.materials),
        housing.modes.displacement(point.housing, every),
        np.array([housing.modes.displacement(adjoint.housing, every) for adjoint in adjoints]),
        {bearing.name: bearing.force for bearing in point.bearings},
        {bearing.name: np.array([adjoint.force(bearing.name) for adjoint in adjoints]) for bearing in point.bearings},
        np.zeros(3) if gravity is None else np.array(gravity),
    )


def housing_parameters(case: Case) -> tuple[UpdateParameter, ...]:
    """Return the parameters of a case's ``[update]``, else a thickness for every wall of its box; none for others."""
    if case.update is not None:
        return tuple(case.update.parameter)
    if case.housing is None or case.housing.box is None:
        return ()
    box = case.housing.box
    parameters = []
    for face in FACES:
        thickness = getattr(box.walls, face)
        is_cover = box.cover is not None and box.cover.face == face and box.cover.thickness is not None
        key = "housing.box.cover.thickness" if is_cover else f"housing.box.wall.{face}"
        span = (f"{0.5 * thickness:.9g} m", f"{2.0 * thickness:.9g} m")
        parameters.append(UpdateParameter(name=f"{face} wall", keys=(key,), range=span))
    return tuple(parameters)


@dataclass(frozen=True, eq=False)
class HousingChange:
    """Change of a housing by one parameter.

    Derivatives are by the parameter's coordinate: z of :class:`gearwhine.housing.updating.Parameter` for a number of
    the case, and the shift along the normal [m] for a face.

    Attributes
    ----------
    parameter : str
    kind : str
        ``housing`` or ``face``.
    rate : ModelSensitivity
        Derivative of the housing's model.
    bearings, sensors : mapping of str to scipy.sparse.csr_array
        Derivatives of the ports of bearings and of sensors; empty where they stay.
    slope : float
        Derivative of the parameter [SI] by its coordinate; 1 of a face.
    reference : float or None
        Value that the parameter's relative steps refer to [SI]; None of a length, whose steps are lengths.
    thickness : float or None
        Thickness of a wall [m], infinite of a face, whose wall is not known; None of other parameters.
    """

    parameter: str
    kind: str
    rate: ModelSensitivity
    bearings: PortRates
    sensors: PortRates
    slope: float
    reference: float | None
    thickness: float | None


def slopes_of(changes: Sequence[HousingChange]) -> FloatArray:
    """Return the derivatives of parameters by their coordinates [SI], shape (n_parameters,)."""
    return np.array([change.slope for change in changes])


def by_changes(fields: StaticSensitivity, changes: Sequence[HousingChange]) -> FloatArray:
    """Differentiate each outcome by the parameters of changes [outcome/SI], shape (n_adjoints, n_parameters)."""
    by_coordinates = fields.by_parameters([change.rate for change in changes], [change.bearings for change in changes])
    return np.asarray(by_coordinates / slopes_of(changes))


def by_case_parameters(case: Case, fields: StaticSensitivity, parameters: Sequence[UpdateParameter]) -> FloatArray:
    """Differentiate outcomes by numbers of a case's housing, in SI, shape (n_adjoints, n_parameters).

    Raises
    ------
    CaseError, meshes.box.morph.MorphError
        As :func:`case_changes`.
    """
    if not parameters:
        return np.zeros((len(fields.adjoint), 0))
    return by_changes(fields, case_changes(case, fields.mesh, parameters))


def housing_changes(case: Case, housing: HousingModes) -> tuple[tuple[HousingChange, ...], str | None]:
    """Differentiate the model of a case's housing by the parameters that are ranked.

    Returns
    -------
    tuple of HousingChange
    str or None
        Why flat faces stand in place of walls, where they do.
    """
    mesh, seats = housing.mesh, [seat.name for seat in housing.housing.seats]
    parameters = housing_parameters(case)
    if not parameters:
        return face_changes(mesh, seats), None
    try:
        return case_changes(case, mesh, parameters), None
    except MorphError as error:
        note = f"the mesh of the box does not follow its walls, so that flat faces stand in their place: {error}"
        return face_changes(mesh, seats), note


def case_changes(case: Case, mesh: Mesh, parameters: Sequence[UpdateParameter]) -> tuple[HousingChange, ...]:
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
    changes = []
    for number, (rate, entry, z) in enumerate(zip(meshed.rates(), fitted.numbers, fitted.start.tolist(), strict=True)):
        bearings, sensors = _port_rates(meshed, number, rate)
        changes.append(
            HousingChange(
                entry.parameter.name,
                "housing",
                rate,
                bearings,
                sensors,
                slope=entry.parameter.deviation(z, 1.0),
                reference=None if _is_length(entry.given) else entry.start,
                thickness=entry.start if _is_thickness(entry.given) else None,
            )
        )
    return tuple(changes)


def _is_length(parameter: UpdateParameter) -> bool:
    return not parameter.factor and kind_of(parameter.range[0]) == kind_of("1 m")


def _is_thickness(parameter: UpdateParameter) -> bool:
    """Whether a parameter is the thickness of a wall, or of several, and no factor on them."""
    steps = [parse_key_path(key) or () for key in parameter.keys]
    return _is_length(parameter) and all({"wall", "thickness"} & set(path[-2:]) for path in steps)


def _port_rates(meshed: MeshedParameters, number: int, rate: ModelSensitivity) -> tuple[PortRates, PortRates]:
    """Differentiate the ports of all bearings and sensors by a coordinate; empty where they stay.

    By central differences: a parameter may be any number of the case, which moves a port by the seat's centre, by the
    facets of its surface and by the nearest point of the surface to a sensor, and so has no formula of its own.
    """
    above, below = meshed.beside(number)
    is_rigid = rate.velocity is None
    tables = [housing_table(case, _COMMAND) for case in (above, below)]
    if is_rigid and tables[0].seat == tables[1].seat and tables[0].sensor == tables[1].sensor:
        return {}, {}
    meshes = [meshed.mesh] * 2
    if rate.velocity is not None:
        shift = RATE_STEP * rate.velocity
        meshes = [replace(meshed.mesh, points=meshed.mesh.points + sign * shift) for sign in (1.0, -1.0)]
    bearings, sensors = (
        {name: (port - ports_below[name]) / (2.0 * RATE_STEP) for name, port in ports_above.items()}
        for ports_above, ports_below in zip(_ports(above, meshes[0]), _ports(below, meshes[1]), strict=True)
    )
    return bearings, sensors


def _ports(case: Case, mesh: Mesh) -> tuple[dict[str, sparse.csr_array], dict[str, sparse.csr_array]]:
    """Assemble the ports of a case's bearings and of its sensors on a mesh."""
    table = housing_table(case, _COMMAND)
    seats = {seat.name: seat for seat in build_seats(table)}
    places = bearing_places(table.seat, case.bearing, case.rotor)
    return (
        {name: bearing_port(seat_matrix(mesh, seats[seat]), arm) for name, (seat, arm) in places.items()},
        {sensor.name: sensor_port(mesh, sensor.build()).matrix for sensor in table.sensor},
    )


def face_changes(mesh: Mesh, seats: Sequence[str]) -> tuple[HousingChange, ...]:
    """Differentiate the model of a housing by material on the large flat faces of its surface.

    A face moves along its normal with the layer of elements on it; seats and fixtures stay. It is named as
    :func:`gearwhine.housing.fem.surface.flat_face_names` has it, such as ``inside of bottom at 0, 10, 0 mm``.
    """
    held = [block.nodes.ravel() for seat in seats for block in mesh.surface(seat)]
    held_nodes = np.unique(np.concatenate(held or [np.empty(0, int)]))
    faces = flat_faces(mesh)
    whole = sum(face.area for face in faces)
    changes = []
    for face in faces:
        if face.area < _LEAST_FACE * whole:
            continue
        velocity = np.zeros_like(mesh.points)
        velocity[np.unique(np.concatenate([block.corners.ravel() for block in face.facets]))] = face.normal
        velocity[held_nodes] = 0.0
        rate = ModelSensitivity(with_middles(mesh, velocity))
        changes.append(HousingChange(face.name, "face", rate, {}, {}, slope=1.0, reference=None, thickness=math.inf))
    return tuple(changes)
