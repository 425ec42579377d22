"""The rotors' part of the results file: modes at rest, the Campbell diagram, and the response to unbalance and bow."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from gearwhine.stages.rotors import SolvedRotor
from housing.netcdf import Variables

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_HERTZ = 2.0 * np.pi
_RPM = 60.0 / (2.0 * np.pi)
_PLACES = 101  # along a rotor


def write_rotors(solved: tuple[SolvedRotor, ...], variables: Variables, coordinates: Variables) -> None:
    """Add what is known of the rotors; where one has fewer modes or speeds than another, the rest is NaN."""
    coordinates["rotor"] = ("rotor", [one.rotor.name for one in solved], {})
    variables["rotor_rest_frequency"] = (
        ("rotor", "rest_mode"),
        padded([one.rest.frequencies / _HERTZ for one in solved]),
        _unit("Hz", "lateral natural frequencies at rest, both planes"),
    )
    variables["rotor_torsional_frequency"] = (
        ("rotor", "torsional_mode"),
        padded([one.torsional.frequencies / _HERTZ for one in solved]),
        _unit("Hz", "free torsional natural frequencies"),
    )
    places = [np.linspace(0.0, one.rotor.length, _PLACES) for one in solved]
    variables["rotor_place"] = (("rotor", "place"), np.array(places), _unit("m", "distance from the rotor's left end"))
    for kind, unit, shapes in (
        ("lateral", "kg-0.5", [one.lateral.evaluate(z)[0] for one, z in zip(solved, places, strict=True)]),
        ("torsional", "kg-0.5 m-1", [one.torsional.evaluate(z) for one, z in zip(solved, places, strict=True)]),
    ):
        variables[f"rotor_{kind}_shape"] = (
            ("rotor", f"{kind}_mode", "place"),
            padded(shapes),
            _unit(unit, f"orthonormal {kind} mode shapes"),
        )
    if any(one.campbell is not None for one in solved):
        _campbell(solved, variables)
    if any(one.stiffness_map is not None for one in solved):
        _stiffness_map(solved, variables)
    if any(one.response is not None for one in solved):
        _response(solved, variables, coordinates)
    if any(one.torsion is not None for one in solved):
        _torsion(solved, variables, coordinates)
    if any(one.operation is not None for one in solved):
        _whirl_loads(solved, places, variables)


def _campbell(solved: tuple[SolvedRotor, ...], variables: Variables) -> None:
    """Whirl over speed; a branch keeps its place through its crossings."""
    diagrams = [one.campbell for one in solved]
    speeds = [np.empty(0) if diagram is None else diagram.speeds * _RPM for diagram in diagrams]
    variables["campbell_speed"] = (("rotor", "campbell_step"), padded(speeds), _unit("rpm", "speed of the rotor"))
    none = np.empty((0, 0))
    for name, unit, what, values in (
        ("frequency", "Hz", "natural frequency of whirl", [none if d is None else d.frequencies for d in diagrams]),
        ("log_decrement", "1", "log decrement of whirl", [none if d is None else d.log_decrements for d in diagrams]),
        ("direction", "1", "1 counter-clockwise, -1 clockwise", [none if d is None else d.direction for d in diagrams]),
    ):
        table = padded(values) / (_HERTZ if unit == "Hz" else 1.0)
        variables[f"campbell_{name}"] = (("rotor", "campbell_step", "whirl_branch"), table, _unit(unit, what))


def _stiffness_map(solved: tuple[SolvedRotor, ...], variables: Variables) -> None:
    """Critical speeds over the stiffness of all bearings, which is the same for every rotor."""
    maps = [one.stiffness_map for one in solved]
    known = next(one for one in maps if one is not None)
    whirl = "forward" if known.direction > 0 else "backward"
    variables["map_stiffness"] = ("map_step", known.stiffnesses, _unit("N/m", "stiffness of every bearing"))
    variables["map_critical_speed"] = (
        ("rotor", "map_step", "map_curve"),
        padded([np.empty((0, 0)) if one is None else one.speeds * _RPM for one in maps]),
        _unit("rpm", f"undamped critical speeds of {whirl} whirl"),
    )


def _response(solved: tuple[SolvedRotor, ...], variables: Variables, coordinates: Variables) -> None:
    """What each probe reads over speed; probes of all rotors in one row."""
    rows = [
        (one.rotor.name, one.response.response.speeds, reading)
        for one in solved
        if one.response is not None
        for reading in one.response.readings
    ]
    coordinates["probe"] = ("probe", [f"{rotor}: {reading.probe.name}" for rotor, _, reading in rows], {})
    for name, unit, what, values in (
        ("response_speed", "rpm", "speed of the rotor", [speeds * _RPM for _, speeds, _ in rows]),
        (
            "probe_amplitude",
            "m",
            "reading of the probe, zero to peak",
            [np.abs(reading.amplitude) for *_, reading in rows],
        ),
        ("probe_phase_lag", "rad", "lag of the reading behind the mark", [reading.phase_lag for *_, reading in rows]),
        ("orbit_major_axis", "m", "half the length of the orbit", [reading.major_axis for *_, reading in rows]),
    ):
        variables[name] = (("probe", "response_step"), padded(values), _unit(unit, what))


def _torsion(solved: tuple[SolvedRotor, ...], variables: Variables, coordinates: Variables) -> None:
    """Angle and torque at each probe over frequency; probes of all rotors in one row."""
    rows = [
        (one.rotor.name, one.torsion.response.frequencies, reading)
        for one in solved
        if one.torsion is not None
        for reading in one.torsion.readings
    ]
    coordinates["torsion_probe"] = ("torsion_probe", [f"{name}: {reading.probe.name}" for name, _, reading in rows], {})
    for name, unit, what, values in (
        ("torsion_frequency", "Hz", "frequency of the torques", [omega / _HERTZ for _, omega, _ in rows]),
        ("torsion_angle", "rad", "angle, zero to peak", [np.abs(reading.angle) for *_, reading in rows]),
        ("torsion_angle_phase", "rad", "phase of the angle", [np.angle(reading.angle) for *_, reading in rows]),
        (
            "torsion_torque",
            "N m",
            "torque in the shaft, zero to peak",
            [np.abs(reading.torque) for *_, reading in rows],
        ),
        ("torsion_torque_phase", "rad", "phase of that torque", [np.angle(reading.torque) for *_, reading in rows]),
    ):
        variables[name] = (("torsion_probe", "torsion_step"), padded(values), _unit(unit, what))


def _whirl_loads(solved: tuple[SolvedRotor, ...], places: Sequence[FloatArray], variables: Variables) -> None:
    """Along each rotor the largest deflection and bending moment over a cycle of its whirl modes at operation."""
    deflections, moments = [], []
    for one, z in zip(solved, places, strict=True):
        if one.operation is None:
            deflections.append(np.empty((0, 0)))
            moments.append(np.empty((0, 0)))
        else:
            deflections.append(_largest_over_cycle(*one.whirl[0].evaluate(z)))
            moments.append(_largest_over_cycle(*one.whirl[0].section_loads(z)[1]))
    for name, unit, what, values in (
        ("deflection", "kg-0.5", "deflection", deflections),
        ("moment", "N kg-0.5", "bending moment", moments),
    ):
        variables[f"rotor_whirl_{name}"] = (
            ("rotor", "whirl_mode", "place"),
            padded(values),
            _unit(unit, f"largest {what} over a cycle of the whirl modes at operation, of unit norm in mass"),
        )


def _largest_over_cycle(x: ComplexArray, y: ComplexArray) -> FloatArray:
    """Half the long axis of an ellipse: what turns one way and what turns the other, where they meet."""
    return np.asarray((np.abs(x + 1j * y) + np.abs(x - 1j * y)) / 2.0)


def padded(arrays: Sequence[FloatArray]) -> FloatArray:
    """Arrays of one number of dimensions in one, filled up with NaN behind each."""
    shape = tuple(max(lengths) for lengths in zip(*(array.shape for array in arrays), strict=True))
    whole = np.full((len(arrays), *shape), np.nan)
    for target, array in zip(whole, arrays, strict=True):
        target[tuple(slice(length) for length in array.shape)] = array
    return whole


def _unit(unit: str, what: str) -> dict[str, str]:
    return {"units": unit, "long_name": what}
