"""The gears' part of the results file: curves over the mesh period, over torque and along the flanks."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

import coupling.gears as room
from gearwhine.stages.gear_analysis import PairAnalysis, first_touch
from housing.netcdf import Variables

FloatArray = npt.NDArray[np.float64]

_PHASES = 400  # of the mesh period
_PLACES = 200  # along a flank


def write_gears(pairs: Sequence[PairAnalysis], variables: Variables, coordinates: Variables) -> None:
    """Add what is known of the gear pairs; where one has fewer pairs of teeth or slices than another, NaN."""
    grid = np.arange(_PHASES) / _PHASES
    coordinates["gear_pair"] = ("gear_pair", [pair.label.replace("→", "->") for pair in pairs], {})
    coordinates["mesh_phase"] = ("mesh_phase", grid, _unit("1", "part of the mesh period"))
    contacts = [pair.solved.contact for pair in pairs]
    loaded = [room.static_transmission_error(pair.solved.contact, pair.solved.static.force, grid) for pair in pairs]
    over_phases = ("gear_pair", "mesh_phase")
    for name, unit, what, rows in (
        (
            "mesh_stiffness",
            "N/m",
            "mesh stiffness of all pairs on the path of contact",
            [room.mesh_stiffness(contact, grid) for contact in contacts],
        ),
        (
            "loaded_mesh_stiffness",
            "N/m",
            "stiffness of the pairs that touch under the mean torque",
            [mesh.tangent_stiffness for mesh in loaded],
        ),
        (
            "transmission_error",
            "m",
            "static transmission error under the mean torque, along the line of action",
            [mesh.transmission_error for mesh in loaded],
        ),
        (
            "unloaded_transmission_error",
            "m",
            "transmission error without load, along the line of action",
            [first_touch(contact, grid) for contact in contacts],
        ),
    ):
        variables[name] = (over_phases, np.array(rows), _unit(unit, what))
    variables["transmission_error_harmonic"] = (
        ("gear_pair", "harmonic"),
        np.array([pair.harmonics for pair in pairs]),
        _unit("m", "peak amplitude of the transmission error at whole multiples of the mesh frequency, from the first"),
    )
    _tooth_pairs(pairs, loaded, variables)
    _path(pairs, variables, coordinates)
    _flanks(pairs, variables, coordinates)
    if any(pair.solved.hunting is not None for pair in pairs):
        _hunting(pairs, variables)
    if any(pair.harris is not None for pair in pairs):
        _harris(pairs, variables)


def _tooth_pairs(pairs: Sequence[PairAnalysis], loaded: Sequence[room.StaticMesh], variables: Variables) -> None:
    """Every pair of teeth over the mesh period: its place, its share, its pressure, and its face where it is uneven."""
    over = ("gear_pair", "mesh_phase", "tooth_pair")
    places, shares, pressures, line_loads = [], [], [], []
    for pair, mesh in zip(pairs, loaded, strict=True):
        solved = pair.solved
        absent = ~solved.contact.pairs(mesh.phases).present
        places.append(np.where(absent, np.nan, mesh.positions))
        shares.append(np.where(absent, np.nan, mesh.load_shares))
        pressure = np.full(mesh.positions.shape, np.nan)
        if pair.pressure is not None:
            whole = room.mesh_pressure(solved.geometry, solved.contact, mesh)
            # Over the face the largest; what lies off the path has none.
            pressure = whole if whole.ndim == 2 else np.fmax.reduce(whole, axis=2)
        pressures.append(np.where(absent, np.nan, pressure))
        line_loads.append(np.empty((0, 0, 0)) if mesh.line_loads is None else mesh.line_loads)
    for name, unit, what, values in (
        ("tooth_pair_position", "1", "place on the path of contact in base pitches", places),
        ("load_share", "1", "part of the load on the pair", shares),
        ("contact_pressure", "Pa", "Hertzian pressure of the pair, the largest over its face", pressures),
    ):
        variables[name] = (over, padded(values), _unit(unit, what))
    if any(loads.size for loads in line_loads):
        faces = [pair.solved.contact.faces for pair in pairs]
        variables["face_place"] = (
            ("gear_pair", "slice"),
            padded([np.empty(0) if face is None else face.z for face in faces]),
            _unit("m", "distance of the slice from the middle of the face"),
        )
        variables["line_load"] = ((*over, "slice"), padded(line_loads), _unit("N/m", "transverse load per face width"))


def _path(pairs: Sequence[PairAnalysis], variables: Variables, coordinates: Variables) -> None:
    """The named points of the path of contact."""
    coordinates["contact_point"] = ("contact_point", list(room.POINTS_OF_CONTACT), {"long_name": "of the driver"})
    paths = [room.path_of_contact(pair.solved.geometry) for pair in pairs]
    variables["contact_point_position"] = (
        ("gear_pair", "contact_point"),
        np.array([path.position for path in paths]),
        _unit("1", "place on the path of contact in base pitches"),
    )
    for name, unit, what in (
        ("roll_angle", "rad", "roll angle"),
        ("radius", "m", "distance from the gear's centre"),
        ("sliding", "1", "specific sliding"),
    ):
        sides = [np.array([getattr(path, f"{side}_{name}") for side in ("driver", "driven")]) for path in paths]
        variables[f"contact_point_{name}"] = (
            ("gear_pair", "side", "contact_point"),
            np.array(sides),
            _unit(unit, f"{what} of the point"),
        )


def _flanks(pairs: Sequence[PairAnalysis], variables: Variables, coordinates: Variables) -> None:
    """What both flanks stand out over the involute, from the form circle to the tip."""
    coordinates["side"] = ("side", ["driver", "driven"], {})
    rolls, deviations = [], []
    for pair in pairs:
        gears = (pair.solved.geometry.driver, pair.solved.geometry.driven)
        ends = [(gear.roll_angle(gear.form_radius), gear.roll_angle(gear.tip_radius)) for gear in gears]
        own = [np.linspace(low, high, _PLACES) for low, high in ends]
        rolls.append(own)
        deviations.append([-room.flank_gap(gear, roll) for gear, roll in zip(gears, own, strict=True)])
    over = ("gear_pair", "side", "flank_place")
    variables["flank_roll_angle"] = (over, np.array(rolls), _unit("rad", "roll angle from form circle to tip"))
    variables["flank_deviation"] = (over, np.array(deviations), _unit("m", "material over the involute"))


def _hunting(pairs: Sequence[PairAnalysis], variables: Variables) -> None:
    """The transmission error over the whole hunting period."""
    meshes = [pair.solved.hunting for pair in pairs]
    none = np.empty(0)
    for name, unit, what, rows in (
        ("hunting_phase", "1", "mesh periods", [none if mesh is None else mesh.phases for mesh in meshes]),
        (
            "hunting_transmission_error",
            "m",
            "static transmission error under the mean torque",
            [none if mesh is None else mesh.transmission_error for mesh in meshes],
        ),
    ):
        variables[name] = (("gear_pair", "hunting_step"), padded(rows), _unit(unit, what))


def _harris(pairs: Sequence[PairAnalysis], variables: Variables) -> None:
    """The transmission error over the mesh period for a range of torques."""
    maps = [pair.harris for pair in pairs]
    radii = [pair.solved.geometry.driver.base_radius for pair in pairs]
    none, empty = np.empty(0), np.empty((0, 0))
    torques = [none if one is None else one.forces * radius for one, radius in zip(maps, radii, strict=True)]
    variables["harris_torque"] = (("gear_pair", "harris_load"), padded(torques), _unit("N m", "torque on the driver"))
    variables["harris_phase"] = (
        ("gear_pair", "harris_step"),
        padded([none if one is None else one.phases for one in maps]),
        _unit("1", "part of the mesh period"),
    )
    variables["harris_transmission_error"] = (
        ("gear_pair", "harris_load", "harris_step"),
        padded([empty if one is None else one.transmission_error for one in maps]),
        _unit("m", "static transmission error under the torque"),
    )


def padded(arrays: Sequence[FloatArray]) -> FloatArray:
    """Arrays of one number of dimensions in one, filled up with NaN behind each."""
    shape = tuple(max(lengths) for lengths in zip(*(array.shape for array in arrays), strict=True))
    whole = np.full((len(arrays), *shape), np.nan)
    for target, array in zip(whole, arrays, strict=True):
        target[tuple(slice(length) for length in array.shape)] = array
    return whole


def _unit(unit: str, what: str) -> dict[str, str]:
    return {"units": unit, "long_name": what}
