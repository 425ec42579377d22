"""Campbell diagram of an overhung rotor by exact transfer matrices, with its critical speeds."""

import numpy as np

import gearwhine as gw
from rotors import campbell

steel = gw.ShaftMaterial(youngs_modulus=211e9, shear_modulus=81.2e9, density=7810.0)
disc = gw.Disc(at=0.6, mass=12.0, polar_inertia=0.12, diametral_inertia=0.07)
rotor = gw.Rotor("fan", [gw.Segment(0.6, 0.04, 0.0, steel)], [disc])
bearings = [gw.Bearing.isotropic(name, at, 5e7) for name, at in (("left", 0.0), ("right", 0.4))]

speeds = np.linspace(0.0, gw.rpm(15000.0), 31)
diagram = campbell(rotor, bearings, speeds, count=4)
critical_rpm = [crossing.speed * 30.0 / np.pi for crossing in diagram.crossings()]

for speed, frequencies in zip(speeds[::10], diagram.frequencies[::10], strict=True):
    print(f"{speed * 30 / np.pi:6.0f} rpm: " + "  ".join(f"{f / (2 * np.pi):7.2f} Hz" for f in frequencies[:4]))
print("critical speeds: " + ", ".join(f"{speed:.0f} rpm" for speed in critical_rpm))
