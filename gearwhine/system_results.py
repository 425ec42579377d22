"""The coupled system's part of the results file: its modes and shares, their course over speed, frequency responses."""

import numpy as np
import numpy.typing as npt

from coupling import FrequencyResponse, SystemCampbell
from gearwhine.stages.system import SolvedSystem
from housing.netcdf import Variables

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi
_RPM = 60.0 / _HERTZ


def write_system(solved: SolvedSystem, variables: Variables, coordinates: Variables) -> None:
    """Add the linear analyses. Complex responses stand as amplitude and phase."""
    _modes(solved, variables, coordinates)
    if solved.responses:
        frequencies = solved.responses[0].frequencies / _HERTZ
        coordinates["response_frequency"] = ("response_frequency", frequencies, _unit("Hz", "frequency"))
        coordinates["mesh_error"] = ("mesh_error", [one.excitation for one in solved.responses], {})
        _responses("transmissibility", "mesh_error", "response_frequency", solved.responses, "m-1", variables)
        _names(solved.responses[0], "transmissibility", coordinates)
    if solved.unbalance and solved.unbalance_speeds is not None:
        speeds = solved.unbalance_speeds * _RPM
        coordinates["unbalance_speed"] = ("unbalance_speed", speeds, _unit("rpm", "speed of the first driver"))
        coordinates["unbalance_of"] = ("unbalance_of", [one.excitation for one in solved.unbalance], {})
        _responses("unbalance_response", "unbalance_of", "unbalance_speed", solved.unbalance, "", variables)
        _names(solved.unbalance[0], "unbalance_response", coordinates)
    if solved.campbell is not None:
        _campbell(solved.campbell, variables)


def _modes(solved: SolvedSystem, variables: Variables, coordinates: Variables) -> None:
    modes, shares = solved.modes, solved.modes.shares
    components = [component.name for component in solved.machine.system.components]
    coordinates["machine_component"] = ("machine_component", components, {"long_name": "component of the machine"})
    parts = [f"{part.kind}: {part.name}" for part in shares.parts]
    coordinates["machine_part"] = ("machine_part", parts, {"long_name": "component, connector or contact"})
    for name, dimensions, values, unit, what in (
        ("frequency", (), modes.frequencies_hz, "Hz", "coupled natural frequency"),
        ("damping_ratio", (), modes.damping_ratios, "1", "coupled damping ratio"),
        ("kinetic_share", ("machine_component",), shares.kinetic, "1", "share of the kinetic energy"),
        ("strain_share", ("machine_part",), shares.strain, "1", "share of the strain energy"),
        ("damping_share", ("machine_part",), shares.damping, "1", "part of the damping ratio"),
        ("whirl", ("machine_component",), modes.whirl, "1", "bending: 1 counter-clockwise, -1 clockwise circles"),
    ):
        variables[f"system_{name}"] = (("system_mode", *dimensions), values, _unit(unit, what))
    variables["system_kind"] = ("system_mode", list(modes.kinds), {"long_name": "what moves most"})
    variables["system_where"] = ("system_mode", list(modes.where), {"long_name": "where it moves most"})


def _responses(
    name: str,
    excitation: str,
    abscissa: str,
    responses: tuple[FrequencyResponse, ...],
    per: str,
    variables: Variables,
) -> None:
    loads = _each(responses, "bearing_load").reshape(len(responses), -1, len(responses[0].frequencies), 5)
    for part, kind, dimensions, unit, what, tables in (
        (
            "sensor",
            "acceleration",
            (),
            "m s-2",
            "acceleration along the sensor",
            _each(responses, "sensor_acceleration"),
        ),
        ("bearing", "force", ("plane",), "N", "force of the shaft on its bearing", loads[..., :2]),
        ("bearing", "axial_force", (), "N", "force of the shaft on its bearing along z", loads[..., 2]),
        ("bearing", "moment", ("plane",), "N m", "moment of the shaft on its bearing about x and y", loads[..., 3:]),
        ("mesh", "force", (), "N", "gear-mesh force along the line of action", _each(responses, "mesh_force")),
    ):
        if not tables.size:
            continue
        along = (excitation, f"{name}_{part}", abscissa, *dimensions)
        variables[f"{name}_{part}_{kind}"] = (along, np.abs(tables), _unit(f"{unit} {per}".strip(), f"{what}, peak"))
        variables[f"{name}_{part}_{kind}_phase"] = (along, np.angle(tables), _unit("rad", f"phase of the {what}"))


def _each(responses: tuple[FrequencyResponse, ...], kind: str) -> npt.NDArray[np.complex128]:
    """One kind of signals of all responses, shape (r, n, f, ...)."""
    return np.array([list(getattr(one, kind).values()) for one in responses], dtype=np.complex128)


def _names(response: FrequencyResponse, name: str, coordinates: Variables) -> None:
    for kind, values in (
        ("sensor", response.sensor_acceleration),
        ("bearing", response.bearing_load),
        ("mesh", response.mesh_force),
    ):
        if values:
            coordinates[f"{name}_{kind}"] = (f"{name}_{kind}", list(values), {})
    if response.bearing_load:
        coordinates["plane"] = ("plane", ["x", "y"], {})


def _campbell(campbell: SystemCampbell, variables: Variables) -> None:
    step, branch = "system_speed", "system_branch"
    variables["system_campbell_speed"] = (step, campbell.speeds * _RPM, _unit("rpm", "speed of the first driver"))
    for name, values, what, unit in (
        ("frequency", campbell.frequencies_hz, "damped frequency of the coupled modes over speed", "Hz"),
        ("damping_ratio", campbell.damping_ratios, "damping ratio of the coupled modes over speed", "1"),
        ("whirl", campbell.whirl, "sense of the rotor that bends most, 1 counter-clockwise", "1"),
        ("teeth", campbell.teeth, "share of the gear meshes in the strain energy", "1"),
    ):
        variables[f"system_campbell_{name}"] = ((step, branch), values, _unit(unit, what))
    for name, words in (("kind", campbell.kinds), ("where", campbell.where)):
        variables[f"system_campbell_{name}"] = ((step, branch), words.astype(str), {"long_name": name})
    if not campbell.crossings:
        return
    found = campbell.crossings
    for name, numbers, unit, what in (
        ("speed", [one.speed * _RPM for one in found], "rpm", "speed of the first driver at the crossing"),
        ("frequency", [one.eigenvalue.imag / _HERTZ for one in found], "Hz", "damped frequency at the crossing"),
        ("order", [one.line.order for one in found], "1", "over the speed of the first driver"),
        ("damping_ratio", [one.damping_ratio for one in found], "1", "damping ratio at the crossing"),
    ):
        variables[f"system_crossing_{name}"] = ("system_crossing", np.array(numbers), _unit(unit, what))
    variables["system_crossing_line"] = ("system_crossing", [one.line.name for one in found], {"long_name": "order"})


def _unit(unit: str, what: str) -> dict[str, str]:
    return {"units": unit, "long_name": what}
