"""Static equilibrium of two geared shafts: bearing forces, deflection, misalignment and load over the faces."""

import sys
from pathlib import Path

import gearwhine as gw

CASE = Path(__file__).with_name("two_gears.toml")

# The gears stand off the middle, nearer to the bearings at the back.
study = gw.load(CASE, {"gear.0.at": "45 mm", "gear.1.at": "45 mm"})
point = study.operating_point()
forces = point.dataset["bearing_mean_force"]
bent = point.dataset["shaft_displacement"].sel(deflected_shaft="input")
(pair,) = point.document["gear_pairs"]

print(forces.to_pandas().round(1))
print(f"the input shaft moves by {1e6 * float(abs(bent).max()):.2f} µm")
print(f"flanks {1e6 * pair['misalignment_over_face_m']:.2f} µm out of line, K_Hβ {pair['k_h_beta']:.3f}")
for cause, angle in pair["misalignment_by_cause_rad"].items():
    print(f"  by {cause}: {1e6 * angle:.2f} µrad")
figure = point.plot("load-face-pinion-wheel")
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1])
