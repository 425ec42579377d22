"""Periodic motion of a gear pair over speed, found directly: its branch through a resonance of the machine."""

import sys
from pathlib import Path

import gearwhine as gw

CASE = Path(__file__).with_name("two_gears.toml")
SWEEP = {"from": "2700 rpm", "to": "3300 rpm", "step": "600 rpm"}

study = gw.load(CASE, {"sweep.speed": SWEEP})
steady = study.steady(curve=True, points=20)
curve = steady.dataset.isel(contact=0)
peak_rpm = float(curve["branch_speed"][curve["branch_peak_force"].values.argmax()])
unstable = int((~curve["branch_stable"].astype(bool)).sum())

print(f"{curve.sizes['branch_point']} points of the branch, {unstable} of them unstable")
print(f"largest tooth force {float(curve['branch_peak_force'].max()):.0f} N at {peak_rpm:.0f} rpm")
figure = steady.plot("steady-curve")
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1])
