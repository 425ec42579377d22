"""Parameter study over two keys, torque and mesh damping: the dynamic factor of the tooth force, with a plot."""

import sys
import tempfile
from pathlib import Path

from matplotlib.figure import Figure

import gearwhine as gw

CASE = Path(__file__).with_name("two_gears.toml")
OVER = ["operation.torque=20 N*m:80 N*m:2", "gear_pair.0.damping_ratio=0.03,0.06,0.1"]

folder = sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp()
sweep = gw.load(CASE, {"sweep": ""}).sweep(OVER, folder=folder, workers=1)
data = sweep.dataset.isel(contact=0)
dynamic_factor = data["mesh_force_peak"] / data["mesh_force_mean"]

figure = Figure(layout="constrained")
axes = figure.subplots()
for torque, factor in dynamic_factor.groupby("operation_torque"):
    axes.plot(data["gear_pair_0_damping_ratio"], factor.squeeze(), "o-", label=f"{torque:.0f} N m")
axes.set(xlabel="damping ratio of the mesh", ylabel="largest over mean tooth force")
axes.legend()
figure.savefig(Path(folder) / "dynamic-factor.png")
print(dynamic_factor.to_series())
