"""Response of a rotor to an unbalance of its disc, through its first critical speed."""

import numpy as np

import gearwhine as gw
from rotors import Unbalance, critical_speeds, unbalance_response

steel = gw.ShaftMaterial(youngs_modulus=211e9, shear_modulus=81.2e9, density=7810.0)
disc = gw.Disc(at=0.4, mass=20.0, polar_inertia=0.2, diametral_inertia=0.11)
rotor = gw.Rotor("rotor", [gw.Segment(0.8, 0.035, 0.0, steel)], [disc])
damped = np.diag([800.0, 800.0])
bearings = [gw.Bearing(name, at, np.diag([3e7, 3e7]), damped) for name, at in (("left", 0.0), ("right", 0.8))]

first = critical_speeds(rotor, bearings, speed_limit=gw.rpm(6000.0)).speeds[0]
speeds = np.linspace(0.5, 1.5, 201) * first
response = unbalance_response(rotor, bearings, [Unbalance(at=0.4, moment=2e-4)], speeds)
orbit = np.abs(response.reading([0.4])[0][:, 0])
peak_rpm = float(speeds[orbit.argmax()]) * 30.0 / np.pi

print(
    f"first critical speed {first * 30 / np.pi:.0f} rpm; largest orbit {1e6 * orbit.max():.1f} µm at {peak_rpm:.0f} rpm"
)
