"""A planetary set whose ring stands in a housing of two modes, one along x and one along y, with sensors along both."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.coupling import CoupledMachine, Machine
from gearwhine.coupling.gears import TableStiffness
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.rotors import Unbalance
from tests.machines.plane_planetary_set import MESH_STIFFNESS, STEEL, equal_angles, plane_set

PRESSURE_ANGLE = np.radians(20.0)
TEETH = (25, 29)
"""Sun and planets; the ring has 83, which three planets do not divide."""
RIPPLE = 0.002
"""Part of the mesh stiffness by which its first two harmonics vary: transmission error, and hardly parametric."""
STRONG_RIPPLE = 0.1
"""One that is parametric: it makes lines of harmonics that the transmission error hardly has."""


def housing(natural_hz: Sequence[float], shape: float = 0.2, damping_ratio: float = 0.03) -> HousingComponent:
    """Housing that moves as a body along x and y, each against its own spring."""
    natural = 2.0 * np.pi * np.asarray(natural_hz)
    seat = np.zeros((2, 6))
    seat[0, 0] = seat[1, 1] = shape
    return HousingComponent(
        name="housing",
        kinds=("housing",) * 2,
        stiffness=np.diag(natural**2),
        damping=np.diag(2.0 * damping_ratio * natural),
        gyroscopic=np.zeros((2, 2)),
        seats={"seat": seat},
        seat_z={"seat": 0.05},
        sensors={"x": np.array([shape, 0.0]), "y": np.array([0.0, shape])},
        complete_below=2.0 * np.pi * 3000.0,
    )


def wave(position: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Variation of the mesh stiffness over a mesh period, of two harmonics."""
    return np.asarray(np.cos(2.0 * np.pi * position) + np.sin(4.0 * np.pi * position))


def turning_set(
    natural_hz: Sequence[float],
    *,
    speed: float = 300.0,
    angles_deg: Sequence[float] | None = None,
    ripple: float = RIPPLE,
    unbalanced: str | None = None,
    damping: float = 1.0,
    mode_count: int | None = 1,
) -> Machine:
    """Sun, carrier and planets on rigid ground, the ring in the housing; by default three planets at equal angles.

    Shafts have one mode of each kind beside their attachments, by default: 85 coordinates in place of 139 below the
    usual limit, whose steps and multipliers take a third of the time.

    Where a shaft is unbalanced, its unbalance is all that varies: the mesh stiffness is constant. All damping is
    multiplied by ``damping``.
    """
    parts = plane_set(
        equal_angles(3) if angles_deg is None else np.radians(angles_deg),
        pressure_angle=PRESSURE_ANGLE,
        with_ring=True,
        damping=1e-5 * damping,
        material=STEEL,
        diameter=0.05,
        teeth=TEETH,
        mode_count=mode_count,
    )
    parts["bearings"] = [
        replace(mounted, seat="seat") if mounted.rotor == "ring" else mounted for mounted in parts["bearings"]
    ]
    position = np.linspace(0.0, 1.0, 401)
    law = TableStiffness(position, MESH_STIFFNESS * (1.0 + (0.0 if unbalanced else ripple) * wave(position)))
    parts["shafts"] = [
        replace(shaft, unbalances=[Unbalance(0.05, 1e-4, 0.4)]) if shaft.name == unbalanced else shaft
        for shaft in parts["shafts"]
    ]
    parts["gear_pairs"] = [replace(pair, stiffness=law) for pair in parts["gear_pairs"]]
    return Machine(**parts, housing=housing(natural_hz, damping_ratio=0.03 * damping), speed=speed, torque=200.0)


@cache
def turning_machine(natural_hz: Sequence[float], **how: Any) -> CoupledMachine:
    """The machine of `turning_set`, assembled: one for all tests of a process."""
    return turning_set(natural_hz, **how).assembled
