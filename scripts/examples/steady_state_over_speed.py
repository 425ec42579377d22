"""Periodic motion of a gear pair over speed, without marching: its branch through the mesh resonance."""

from pathlib import Path

import numpy as np

import gearwhine as gw

study = gw.load(Path(__file__).with_name("two_gears.toml"))
steady = study.steady(curve=True, points=40)
curve = steady.solved.curve
rpm = np.abs(curve.speeds) * 30.0 / np.pi
loudest = float(rpm[curve.rms_compression[:, 0].argmax()])

print(
    f"{len(rpm)} points from {rpm.min():.0f} to {rpm.max():.0f} rpm, {np.count_nonzero(~curve.stable)} of them unstable"
)
print(f"largest vibration of the teeth, {1e6 * curve.rms_compression.max():.3f} µm rms, at {loudest:.0f} rpm")
steady.plot("steady-curve")
