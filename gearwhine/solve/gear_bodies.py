"""Gear bodies of a case: modes of wheels with webs on a hub at rest, and which of them the machine follows."""

from typing import Any

from gearwhine.case import Case
from gearwhine.coupling.machine.gear_bodies import KEPT_BELOW, body_out_of_plane
from gearwhine.coupling.machine.parts import gear_inertia_on_shaft
from gearwhine.from_case.machine import build_shaft
from gearwhine.from_case.rotors import shaft_gears

_HERTZ = 6.283185307179586


def gear_body_document(case: Case) -> list[dict[str, Any]]:
    """Return the modes of every gear with a web for JSON: names, frequencies, and whether the machine follows them."""
    rows = []
    for rotor in case.rotor:
        for mounted in shaft_gears(case, rotor.name):
            if mounted.gear.web_thickness is None:
                continue
            shaft = build_shaft(case, rotor)
            body = body_out_of_plane(mounted.gear, gear_inertia_on_shaft(mounted, shaft.rotor), shaft.mode_limit)
            if body is None:
                continue
            rows.append(
                {
                    "gear": mounted.name,
                    "rotor": rotor.name,
                    "modes": [
                        {"name": mode.name, "frequency_hz": mode.frequency / _HERTZ, "kept": mode in body.kept}
                        for mode in body.modes
                    ],
                    "kept_below_hz": KEPT_BELOW * shaft.mode_limit / _HERTZ,
                    "damping_ratio": shaft.damping_ratio,
                }
            )
    return rows
