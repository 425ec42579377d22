"""Operation of a case as loads of a REXS model, and its operating point as a load case."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from gearwhine.case import Case, Operation
from gearwhine.exchange.rexs.model import Attribute
from gearwhine.exchange.rexs.operation import FORCES, GRAVITY
from gearwhine.from_case.rexs.shafts import Shafts
from gearwhine.from_case.rexs.sheet import plain, quantities, quantity

_SPEED = "rotational_speed"
_SAME_SPEED = 1e-9  # part by which speeds may differ and are one
_HELD = ("speed", "rotor", "torque", "at", "output", "force", "gravity")


def gravity_of(operation: Operation | None) -> dict[str, Attribute]:
    """Return the attributes of a gear unit on its weight."""
    gravity = None if operation is None else operation.gravity
    if gravity is None or not any(gravity):
        return {}
    amount = math.hypot(*gravity)
    return {
        "account_for_gravity": plain(True),
        "gravitational_acceleration": quantity(amount, "m/s^2"),
        **{name: plain(part / amount) for name, part in zip(GRAVITY, gravity, strict=True)},
    }


def add_loads(case: Case, shafts: Shafts) -> dict[int, dict[str, Attribute]]:
    """Add speed, torques and forces; return those of the operating point that a load case has, by component."""
    operation, sheet = case.operation, shafts.sheet
    if operation is None:
        return {}
    given: dict[int, dict[str, Attribute]] = {}
    torques = case.parts.torques
    for rotor, speed in case.parts.speeds.items():
        for piece in shafts.pieces[rotor]:
            given[piece.number] = {_SPEED: quantity(speed, "rad/s")}
    driven = torques[0].rotor if torques else operation.rotor or next(iter(case.parts.speeds))
    for place, torque in enumerate(torques):
        shaft, at = shafts.place(torque.rotor, torque.at)
        amount = {"torque_around_u_axis": quantity(torque.value, "N*m")}
        flags = {"defines_torque": plain(place == 0), "transmits_torque": plain(True)}
        attributes = {"u_coordinate_on_shaft": quantity(at, "m"), **amount, **flags}
        given[sheet.part(shaft, "external_load", attributes=attributes)] = amount
    for force in operation.force:
        shaft, at = shafts.place(force.rotor, force.at)
        forces = quantities({name: getattr(force, key) for key, name in FORCES}, "N")
        attributes = {"u_coordinate_on_shaft": quantity(at, "m"), **forces, "transmits_torque": plain(False)}
        given[sheet.part(shaft, "external_load", attributes=attributes)] = forces
    _state_speed(shafts, driven, operation.speed)
    sheet.left_out("operation", operation, _HELD)
    for place, output in enumerate(operation.output):
        sheet.left_out(f"operation.output.{place}", output, ("rotor", "torque", "at"))
    return given


def _state_speed(shafts: Shafts, rotor: str, speed: float) -> None:
    """State the speed of the rotor where power comes in; those of others follow from the train."""
    number = shafts.first(rotor)
    stated = {_SPEED: quantity(speed, "rad/s"), "defines_speed": plain(True)}
    shafts.sheet.components[number - 1] = shafts.sheet.components[number - 1].changed(stated)


def add_sweep(case: Case, shafts: Shafts, given: Mapping[int, Mapping[str, Attribute]]) -> bool:
    """Add a load case for the operation and one for each other speed of its sweep, with its torques; return whether.

    A sweep without the speed of the operation is no spectrum of it, and is not written.
    """
    sheet, operation = shafts.sheet, case.operation
    if case.sweep is None or operation is None or operation.speed == 0.0:
        return False
    ratios = [abs(speed / operation.speed) for speed in case.sweep.speeds]
    if not any(abs(ratio - 1.0) < _SAME_SPEED for ratio in ratios):
        return False
    for number, attributes in given.items():
        sheet.in_load_case(number, attributes)
    for ratio in ratios:
        if abs(ratio - 1.0) < _SAME_SPEED:
            continue
        sheet.further.append(
            {
                number: {name: _scaled(one, ratio) if name == _SPEED else one for name, one in attributes.items()}
                for number, attributes in given.items()
            }
        )
    return True


def _scaled(attribute: Attribute, ratio: float) -> Attribute:
    return Attribute(attribute.value * ratio, attribute.unit)


def add_load_case(
    shafts: Shafts, given: Mapping[int, Mapping[str, Attribute]], bearings: Mapping[str, int], load: Mapping[str, Any]
) -> None:
    """Add the operating point as a load case: speeds, torques, and what acts on shafts and casing in the bearings.

    Parameters
    ----------
    shafts : Shafts
    given : mapping of int to mapping
        Speeds and loads, by component.
    bearings : mapping of str to int
        Components of the bearings, by name.
    load : mapping
        Document of the operating point, with the force [N] and moment [N m] of the shaft on each of its ``bearings``.
    """
    sheet = shafts.sheet
    for number, attributes in given.items():
        sheet.in_load_case(number, attributes)
    for bearing in load["bearings"]:
        if bearing["name"] not in bearings:
            continue
        # The shaft is the inner side: what acts on the outer one is the force of the shaft on its bearing.
        for side, sign in (("outer", 1.0), ("inner", -1.0)):
            x, y, z = (sign * part + 0.0 for part in bearing["force_n"])
            about_x, about_y = (sign * part + 0.0 for part in bearing["moment_n_m"])
            name = f"acting_on_{side}_component"
            forces = {f"force_{name}_u": z, f"force_{name}_v": x, f"force_{name}_w": y}
            moments = {f"torque_{name}_v": about_x, f"torque_{name}_w": about_y}
            sheet.in_load_case(bearings[bearing["name"]], quantities(forces, "N") | quantities(moments, "N*m"))
