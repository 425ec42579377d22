"""Run-up of a gear pair on its shafts: orders of the mesh force over speed."""

from pathlib import Path

import gearwhine as gw

CASE = Path(__file__).with_name("two_gears.toml")
RUN = "{ run = { from = '1500 rpm', to = '4500 rpm', time = '0.5 s' }, tolerance = 5e-3 }"

study = gw.load(CASE, {"operation.speed": "4500 rpm", "transient": RUN})
run = study.simulate()
signature = run.solved.run_signature
orders = signature.orders["mesh force pinion-wheel"]
peak_speed = orders.speeds_rpm[orders.amplitudes[:, orders.orders.searchsorted(28.0)].argmax()]

print(f"{signature.speeds_rpm[0]:.0f} to {signature.speeds_rpm[-1]:.0f} rpm; orders of {list(signature.orders)}")
run.plot(next(name for name, _ in run.figures() if name.startswith("run-up-waterfall")))
