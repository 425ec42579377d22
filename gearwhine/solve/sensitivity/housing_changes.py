"""Changes of a case's housing by its parameters: derivatives of its model and of the ports of bearings and sensors.

Parameters are those of the case's ``[update]``, else the walls of a box; of any other housing, the flat faces of its
surface.
"""

from collections.abc import Sequence
from dataclasses import replace

from scipy import sparse

from gearwhine.case import Case, UpdateParameter
from gearwhine.case.box import FACES, Box
from gearwhine.case.measured import Update
from gearwhine.case.model import housing_table
from gearwhine.case.overrides import parse_key_path
from gearwhine.case.units import kind_of
from gearwhine.coupling.load_analysis.ranking import FACES_IN_PLACE_OF_WALLS
from gearwhine.from_case.given_housing import GivenHousing, given_housing
from gearwhine.from_case.housing import build_seats
from gearwhine.from_case.parametric_housing import RATE_STEP, MeshedParameters, fitted_case
from gearwhine.housing.model.seats import bearing_port, seat_matrix, sensor_port
from gearwhine.housing.updating import ModelSensitivity
from gearwhine.housing.updating.housing_change import HousingChange, face_changes
from gearwhine.housing.updating.static_sensitivity import PortRates
from gearwhine.meshes import Mesh
from gearwhine.meshes.box.morph import MorphError

_COMMAND = "load --sensitivity"


def housing_parameters(update: Update | None, box: Box | None) -> tuple[UpdateParameter, ...]:
    """Return the parameters of ``[update]``, else a thickness for every wall of a box; none for another housing."""
    if update is not None:
        return update.parameter
    if box is None:
        return ()
    parameters = []
    for face in FACES:
        thickness = getattr(box.walls, face)
        is_cover = box.cover is not None and box.cover.face == face and box.cover.thickness is not None
        key = "housing.box.cover.thickness" if is_cover else f"housing.box.wall.{face}"
        span = (f"{0.5 * thickness:.9g} m", f"{2.0 * thickness:.9g} m")
        parameters.append(UpdateParameter(name=f"{face} wall", keys=(key,), range=span))
    return tuple(parameters)


def housing_changes(case: Case, mesh: Mesh) -> tuple[tuple[HousingChange, ...], str | None]:
    """Differentiate the model of a case's housing by the parameters that are ranked.

    Returns
    -------
    tuple of HousingChange
    str or None
        Why flat faces stand in place of walls, where they do.
    """
    table = housing_table(case, _COMMAND)
    parameters, seats = housing_parameters(case.update, table.box), [seat.name for seat in table.seat]
    if not parameters:
        return face_changes(mesh, seats), None
    try:
        return case_changes(case, mesh, parameters), None
    except MorphError as error:
        note = f"{FACES_IN_PLACE_OF_WALLS}: {error}"
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
    meshed = MeshedParameters(fitted, fitted.start, given_housing(case, _COMMAND), mesh)
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
    if is_rigid and above.table.seat == below.table.seat and above.table.sensor == below.table.sensor:
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


def _ports(given: GivenHousing, mesh: Mesh) -> tuple[dict[str, sparse.csr_array], dict[str, sparse.csr_array]]:
    """Assemble the ports of a housing's bearings and of its sensors on a mesh."""
    seats = {seat.name: seat for seat in build_seats(given.table)}
    return (
        {name: bearing_port(seat_matrix(mesh, seats[seat]), arm) for name, (seat, arm) in given.bearings.items()},
        {sensor.name: sensor_port(mesh, sensor.build()).matrix for sensor in given.table.sensor},
    )
