"""Static transmission error of a spur gear pair over the amount of its tip relief."""

import math

import numpy as np

import gearwhine as gw
from coupling.gears import (
    GearPairGeometry,
    PotentialEnergyStiffness,
    TipRelief,
    static_transmission_error,
    tooth_contact,
)

FORCE = 2000.0  # along the line of action [N]


def peak_to_peak(amount: float) -> float:
    """Peak-to-peak transmission error [m] of two gears with a linear tip relief [m] from 0.44 rad of roll angle on."""
    relief = TipRelief(amount, start_roll_angle=0.44) if amount else None
    gears = (
        gw.Gear(name, 40, 3e-3, math.radians(20.0), face_width=20e-3, bore=40e-3, tip_relief=relief)
        for name in ("driver", "driven")
    )
    mesh = static_transmission_error(tooth_contact(GearPairGeometry(*gears), PotentialEnergyStiffness()), FORCE)
    return float(np.ptp(mesh.transmission_error))


amounts = np.linspace(0.0, 30e-6, 13)
errors = np.array([peak_to_peak(amount) for amount in amounts])
best = float(amounts[errors.argmin()])

for amount, error in zip(amounts, errors, strict=True):
    print(f"relief {1e6 * amount:5.1f} µm: transmission error {1e6 * error:6.3f} µm")
print(f"quietest at {1e6 * best:.1f} µm")
