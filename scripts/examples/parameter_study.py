"""Parameter study over two keys, torque and backlash, side by side in processes, with a plot."""

import sys
import tempfile
from pathlib import Path

import gearwhine as gw

CASE = Path(__file__).with_name("two_gears.toml")
OVER = ["operation.torque=20 N*m:80 N*m:3", "gear_pair.0.damping_ratio=0.03,0.1"]

folder = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp())
sweep = gw.load(CASE).sweep(OVER, folder=folder, workers=1)
peak = sweep.dataset["mesh_force_peak"].isel(contact=0).squeeze()
mean = sweep.dataset["mesh_force_mean"].isel(contact=0).squeeze()
figure = sweep.plot("sweep-mesh-force")
figure.savefig(folder / "mesh-force.png")

print((peak / mean).to_series())
