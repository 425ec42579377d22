"""Static transmission error of a spur gear pair over the amount of its tip relief."""

import math
import sys

import numpy as np
from matplotlib.figure import Figure

import gearwhine as gw
from gearwhine.coupling import gears

RELIEF_FROM = 0.41  # roll angle where the relief begins [rad]


def peak_to_peak(amount: float, force: float) -> float:
    """Peak-to-peak transmission error [m] of two gears with a tip relief [m], under a force along the path [N]."""
    relief = gears.TipRelief(amount, start_roll_angle=RELIEF_FROM) if amount else None
    gear = gw.Gear("gear", 40, 3e-3, math.radians(20.0), face_width=20e-3, bore=40e-3, tip_relief=relief)
    contact = gears.tooth_contact(gears.GearPairGeometry(gear, gear), gears.PotentialEnergyStiffness())
    return float(np.ptp(gears.loaded_transmission_error(contact, force).transmission_error))


amounts = np.linspace(0.0, 15e-6, 31)
errors = {force: np.array([peak_to_peak(amount, force) for amount in amounts]) for force in (1000.0, 2000.0)}
best = {force: float(amounts[error.argmin()]) for force, error in errors.items()}

figure = Figure(layout="constrained")
axes = figure.subplots()
for force, error in errors.items():
    least = f"{1e6 * error.min():.2f} µm with {1e6 * best[force]:.1f} µm"
    print(f"{force:.0f} N: transmission error {1e6 * error[0]:.2f} µm without relief, {least} of it")
    axes.plot(1e6 * amounts, 1e6 * error, label=f"{force:.0f} N")
axes.set(xlabel="tip relief [µm]", ylabel="transmission error, peak to peak [µm]")
axes.legend()
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1])
