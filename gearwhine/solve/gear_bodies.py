"""Gear bodies of a machine: modes of wheels with webs on a hub at rest, and which of them the machine follows."""

from typing import Any

from gearwhine.coupling import Machine
from gearwhine.coupling.machine.gear_bodies import KEPT_BELOW

_HERTZ = 6.283185307179586


def gear_body_document(machine: Machine) -> list[dict[str, Any]]:
    """Return the modes of every gear with a web for JSON: names, frequencies, and whether the machine follows them."""
    rows = []
    for mounted in machine.gears:
        body = machine.bodies_out_of_plane.get(mounted.name)
        if mounted.gear.web_thickness is None or body is None:
            continue
        shaft = machine.shaft(mounted.shaft)
        rows.append(
            {
                "gear": mounted.name,
                "rotor": shaft.name,
                "modes": [
                    {"name": mode.name, "frequency_hz": mode.frequency / _HERTZ, "kept": mode in body.kept}
                    for mode in body.modes
                ],
                "kept_below_hz": KEPT_BELOW * shaft.mode_limit / _HERTZ,
                "damping_ratio": shaft.damping_ratio,
            }
        )
    return rows
