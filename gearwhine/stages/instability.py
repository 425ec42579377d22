"""Warnings of unstable coupled modes: negative damping, or negative stiffness."""

from typing import Any

import numpy as np

import coupling as room
from gearwhine.doubtful import warning

_HERTZ = 2.0 * np.pi
_TOLD = 5  # growing modes named one by one


def unstable_modes_warnings(stability: room.Stability) -> list[dict[str, Any]]:
    """One warning for each growing mode, the fastest first; beyond a few they are counted."""
    found = []
    for mode in stability.growing[:_TOLD]:
        frequency = abs(mode.eigenvalue) / _HERTZ
        where = f" ({mode.where})" if mode.where else ""
        fed = ", ".join(part.name for part, _ in mode.feeders[:3])
        found.append(
            warning(
                "unstable mode",
                f"the coupled {mode.kind} mode{where} at {frequency:.5g} Hz has the damping ratio "
                f"{mode.damping_ratio:.3g}: it grows by itself"
                + (f", fed by {fed}" if fed else "")
                + "; motions of this machine mean nothing beyond its onset",
                frequency_hz=frequency,
                damping_ratio=mode.damping_ratio,
                kind=mode.kind,
                where=mode.where,
            )
        )
    if len(stability.growing) > _TOLD:
        found.append(warning("unstable mode", f"{len(stability.growing) - _TOLD} further coupled modes grow as well"))
    return found


def machine_warnings(machine: room.CoupledMachine) -> list[dict[str, Any]]:
    """Warnings of the growing modes of a machine about its mean contact.

    Raises
    ------
    coupling.ModesError
        Where modes fail their proof.
    """
    system = machine.system
    return unstable_modes_warnings(room.stability(room.coupled_modes(system, room.mean_contact(system))))
