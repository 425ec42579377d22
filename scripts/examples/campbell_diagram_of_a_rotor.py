"""Campbell diagram of a rotor with two discs by exact transfer matrices, with its critical speeds.

The rotor is example 5.9.1 of Friswell, Penny, Garvey and Lees, Dynamics of Rotating Machines (2010).
"""

import sys

import numpy as np

import gearwhine as gw
from gearwhine.figures import draw_campbell
from gearwhine.rotors import campbell

steel = gw.ShaftMaterial(youngs_modulus=211e9, shear_modulus=81.2e9, density=7810.0)
discs = [gw.Disc.from_dimensions(at, 0.07, diameter, 0.05, 7810.0) for at, diameter in ((0.5, 0.28), (1.0, 0.35))]
rotor = gw.Rotor("rotor", [gw.Segment(1.5, 0.05, 0.0, steel)], discs)
bearings = [gw.Bearing.isotropic(name, at, 1e6) for name, at in (("left", 0.0), ("right", 1.5))]

speeds = gw.rpm(1.0) * np.linspace(0.0, 4000.0, 41)
diagram = campbell(rotor, bearings, speeds, count=6)
crossings = diagram.crossings()

for speed, frequencies in zip(speeds[::10], diagram.frequencies[::10], strict=True):
    print(f"{gw.to_rpm(speed):6.0f} rpm: " + "  ".join(f"{f:7.2f} rad/s" for f in np.sort(frequencies)))
print("critical speeds: " + ", ".join(f"{gw.to_rpm(crossing.speed):.0f} rpm" for crossing in crossings))
figure = draw_campbell("Two discs", diagram)
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1])
