"""Loads of a REXS file as `[operation]` and `[sweep]`: speed, torque, outputs, forces and weight of one load case.

A file states the speed of one shaft and the torque or power of one load, perhaps on another shaft. The case has both at
the shaft where power comes in: speeds follow from the ratios of the train, torques from the power.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from gearwhine.exchange.rexs.errors import wrong
from gearwhine.exchange.rexs.gear_unit import GearUnit
from gearwhine.exchange.rexs.model import Component, LoadCase, RexsModel
from gearwhine.exchange.rexs.placement import along
from gearwhine.exchange.rexs.quantities import of, rpm
from gearwhine.exchange.rexs.shafts import Bodies, Body

_STANDARD_GRAVITY = 9.80665
FORCES = (("z", "force_u_direction"), ("x", "force_v_direction"), ("y", "force_w_direction"))
"""Key of a force along an axis of the machine, and attribute, in the order u, v, w."""
GRAVITY = tuple(f"direction_vector_gravity_{axis}" for axis in "vwu")
"""Attributes of the direction of gravity along x, y, z."""
_DURATIONS = ("operating_time_fraction", "load_duration_fraction")


@dataclass(frozen=True)
class Load:
    """An external load on a body: its component, its shaft, height [m], torque [N m] and power [W] about +z."""

    component: Component
    shaft: Component
    body: Body
    z: float
    torque: float | None
    power: float | None


def chosen_load_case(model: RexsModel, chosen: str) -> LoadCase | None:
    """Return the load case of a number, by default the first; None in a file without any.

    Raises
    ------
    RexsError
        Where there is none of this number.
    """
    if not chosen:
        return next(iter(model.load_cases), None)
    for load_case in model.load_cases:
        if str(load_case.number) == chosen.strip():
            return load_case
    numbers = ", ".join(str(one.number) for one in model.load_cases[:20]) or "the file has none"
    raise wrong("load_spectrum", f"a load case among {numbers}", chosen)


def loads_of(unit: GearUnit, bodies: Bodies) -> list[Load]:
    """Return the external loads on the bodies of the case."""
    found = []
    for component in unit.model.of_kind("external_load"):
        shaft = unit.model.assembly_of(component.number, "shaft")
        body = bodies.of(shaft)
        if shaft is None or body is None:
            unit.notes.left_out(component.label, "it is on no shaft of the case")
            continue
        at = component.number_of("u_coordinate_on_shaft", "m")
        if at is None:
            unit.notes.assumed(component.label, "no u_coordinate_on_shaft: the left end of its shaft")
            at = 0.0
        torque = component.number_of("torque_around_u_axis", "N*m")
        power = component.number_of("power", "W")
        sense = along(unit.placement(shaft))
        found.append(
            Load(component, shaft, body, unit.height(shaft, at), None if torque is None else sense * torque, power)
        )
    return found


def speed_of(unit: GearUnit, bodies: Bodies) -> tuple[Body, float] | None:
    """Return the body whose speed the file states, and this speed about +z [rad/s]; None where it states none."""
    shafts = [shaft for shaft in unit.model.of_kind("shaft") if shaft.number_of("rotational_speed", "rad/s")]
    shafts.sort(key=lambda shaft: shaft.flag("defines_speed") is not True)
    for shaft in shafts:
        body = bodies.of(shaft)
        if body is not None:
            return body, along(unit.placement(shaft)) * (shaft.number_of("rotational_speed", "rad/s") or 0.0)
    return None


@dataclass(frozen=True)
class Drive:
    """Where power comes in: body, speed about +z [rad/s] and torque [N m], and the load that states the power."""

    body: Body
    speed: float
    torque: float
    load: Load | None


def find_drive(unit: GearUnit, speed: tuple[Body, float], loads: list[Load], ratios: Mapping[str, float]) -> Drive:
    """Return where power comes in.

    Parameters
    ----------
    unit
    speed : tuple of Body and float
        Body whose speed is stated, and this speed [rad/s].
    loads : list of Load
    ratios : mapping of str to float
        Speed of each body over that of the body whose speed is stated, by name.
    """
    speeds = {name: ratio * speed[1] for name, ratio in ratios.items()}
    stated = [load for load in loads if load.torque or load.power]
    stated.sort(key=lambda load: load.component.flag("defines_torque") is not True)
    powered = list[tuple[Load, float]]()
    for load in stated:
        if turns := speeds.get(load.body.name):
            power = load.torque * turns if load.torque else load.power
            powered += [(load, power)] if power else []
    if not powered:
        unit.notes.assumed("loads", "no torque: 0 N·m", "operation", "torque")
        return Drive(speed[0], speed[1], 0.0, None)
    first, power = powered[0]
    if power > 0.0:
        return Drive(first.body, speeds[first.body.name], power / abs(speeds[first.body.name]), first)
    # It is taken out there: it comes in at the load that gives power, or at the one that passes torque on.
    inputs = [load for load, given in powered if given > 0.0]
    others = [load for load in loads if load.body is not first.body and _passes_torque(load, speeds)]
    for load in (*inputs, *others):
        return Drive(load.body, speeds[load.body.name], -power / abs(speeds[load.body.name]), load)
    if speed[0] is not first.body:
        return Drive(speed[0], speed[1], -power / abs(speed[1]), None)
    unit.notes.changed(first.component.label, "it brakes the only shaft with a speed: taken as driving it")
    return Drive(first.body, speeds[first.body.name], -power / abs(speeds[first.body.name]), first)


def _passes_torque(load: Load, speeds: Mapping[str, float]) -> bool:
    """Whether a load stands on a body that turns, and is no mere force."""
    return bool(speeds.get(load.body.name)) and load.component.flag("transmits_torque") is not False


def operation_table(unit: GearUnit, drive: Drive, loads: list[Load], speeds: Mapping[str, float]) -> dict[str, Any]:
    """Return `[operation]`.

    Parameters
    ----------
    unit, drive, loads
    speeds : mapping of str to float
        Speed of each body about +z [rad/s], by name.
    """
    table: dict[str, Any] = {
        "speed": rpm(drive.speed),
        "rotor": drive.body.name,
        "torque": of(drive.torque, "N*m"),
    }
    if drive.load is not None:
        table["at"] = drive.body.station(drive.load.z, drive.load.component.label)
    outputs = _outputs(unit, drive, loads, speeds)
    if outputs:
        table["output"] = outputs
    forces = [force for load in loads if (force := _force(unit, load)) is not None]
    if forces:
        table["force"] = forces
    gravity = _gravity(unit)
    if gravity is not None:
        table["gravity"] = gravity
    return table


def _outputs(unit: GearUnit, drive: Drive, loads: list[Load], speeds: Mapping[str, float]) -> list[dict[str, Any]]:
    """Return the torques that are taken off, where the file has loads for them; together they take the power."""
    power = drive.torque * abs(drive.speed)
    taken = [
        load
        for load in loads
        if load.body is not drive.body
        and _passes_torque(load, speeds)
        and (load.torque or load.power or load.component.flag("transmits_torque"))
    ]
    if power == 0.0 or not taken:
        return []
    shares = [-(load.torque * speeds[load.body.name] if load.torque else load.power or 0.0) for load in taken]
    if any(share <= 0.0 for share in shares):
        stated = sum(max(share, 0.0) for share in shares)
        lacking = [index for index, share in enumerate(shares) if share <= 0.0]
        rest = power - stated
        if rest <= 0.0:
            return []
        for index in lacking:
            shares[index] = rest / len(lacking)
        if len(lacking) > 1:
            unit.notes.assumed("loads", "no torque of several outputs: equal powers", "operation", "output")
    scale = power / sum(shares)
    if abs(scale - 1.0) > 0.005:
        text = f"the outputs take {1.0 / scale:.4g} of the power that comes in: scaled to all of it"
        unit.notes.changed("loads", text, "operation", "output")
    return [
        {
            "rotor": load.body.name,
            "torque": of(share * scale / abs(speeds[load.body.name]), "N*m"),
            "at": load.body.station(load.z, load.component.label),
        }
        for load, share in zip(taken, shares, strict=True)
    ]


def _force(unit: GearUnit, load: Load) -> dict[str, Any] | None:
    """Return the force of a load in x, y, z; None where it has none."""
    component = load.component
    along_axes = [component.number_of(name, "N") or 0.0 for _, name in FORCES]
    for name in ("torque_around_v_axis", "torque_around_w_axis"):
        if component.number_of(name, "N*m"):
            unit.notes.left_out(f"{component.label}: {name}", "loads of a case have no moment across the shaft")
    if not any(along_axes):
        return None
    if component.positive("width_of_external_load", "m") is not None:
        unit.notes.changed(component.label, "a line load is a force in its middle")
    axes = unit.placement(load.shaft).axes
    x, y, z = (axes @ along_axes).tolist()
    parts = {key: of(value, "N") for key, value in (("x", x), ("y", y), ("z", z)) if abs(value) > 1e-9}
    return {"rotor": load.body.name, "at": load.body.station(load.z, component.label), **parts}


def _gravity(unit: GearUnit) -> list[str] | None:
    """Return the acceleration of gravity along x, y, z; None where the file does not account for it."""
    gear_unit = next(unit.model.of_kind("gear_unit"), None)
    if gear_unit is None or gear_unit.flag("account_for_gravity") is not True:
        return None
    direction = [gear_unit.number_of(name) or 0.0 for name in GRAVITY]
    length = sum(part * part for part in direction) ** 0.5
    if not 1e-9 < length < 1e9:
        return None
    amount = gear_unit.positive("gravitational_acceleration", "m/s^2") or _STANDARD_GRAVITY
    return [of(amount * part / length, "m/s^2") for part in direction]


def swept_speeds(unit: GearUnit, bodies: Bodies, model: RexsModel, ratio: float) -> list[float]:
    """Return the speeds of all load cases at the input [rad/s], ascending.

    Parameters
    ----------
    unit, bodies
    model : RexsModel
        Model of the file, without a chosen load case.
    ratio : float
        Speed at the input over that of the shaft whose speed is stated.
    """
    found: dict[str, float] = {}
    for load_case in model.load_cases:
        shown = GearUnit(model.in_load_case(load_case), unit.places, unit.names)
        speed = speed_of(shown, bodies)
        if speed is not None:
            amount = abs(speed[1] * ratio)
            found.setdefault(f"{amount:.11g}", amount)
    return sorted(found.values())


def described_load_case(model: RexsModel, load_case: LoadCase) -> str:
    """Return a load case in words: its number, share of time, speeds and torques."""
    parts = []
    for component in load_case.components:
        for name in _DURATIONS:
            share = component.number_of(name)
            if share is not None:
                parts.append(f"{100.0 * share:g} % of the time")
        for name, measure, text in (
            ("rotational_speed", "rad/s", rpm),
            ("torque_around_u_axis", "N*m", lambda value: of(value, "N m")),
            ("power", "W", lambda value: of(value / 1e3, "kW")),
        ):
            value = component.number_of(name, measure)
            if value:
                name_shown = model.components[component.number].name or component.label
                parts.append(f"{text(value)} at {name_shown}")
    return f"load case {load_case.number}: {', '.join(parts) or 'no speed and no load'}"
