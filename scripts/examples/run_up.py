"""Run-up of a gear pair on its shafts: the mesh order passes through a resonance."""

import sys
from pathlib import Path

import gearwhine as gw

CASE = Path(__file__).with_name("two_gears.toml")
RUN = {"from": "1500 rpm", "to": "4500 rpm", "time": "0.5 s"}

study = gw.load(CASE, {"operation.speed": "4500 rpm", "transient": {"run": RUN, "tolerance": 5e-3}})
run = study.simulate()
print(run.dataset)
print([n for n,_ in run.figures()])
for k,v in run.dataset.data_vars.items(): print(k, v.dims, v.shape, v.attrs.get("units"))
