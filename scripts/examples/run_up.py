"""Run-up of a gear pair on its shafts: the mesh order passes through a resonance of the machine."""

import sys
from pathlib import Path

import gearwhine as gw

CASE = Path(__file__).with_name("two_gears.toml")
RUN = {"from": "2200 rpm", "to": "3900 rpm", "time": "0.4 s"}

study = gw.load(CASE, {"operation.speed": "3900 rpm", "transient": {"run": RUN, "tolerance": 5e-3}})
run = study.simulate()
mesh_order = run.dataset["run_order_amplitude"].sel(run_signal="pinion -> wheel", named_order="1× pinion -> wheel")
peak_rpm = float(mesh_order.idxmax("order_speed"))

print(f"mesh force of the mesh order [N], peak, over speed [rpm]:\n{mesh_order.to_series()}")
print(f"largest at {peak_rpm:.0f} rpm, where the mesh frequency is {28 * peak_rpm / 60:.0f} Hz")
figure = run.plot("run-up-map-pinion-wheel")
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1])
