"""Response of a rotor to an unbalance of its disc, through the first critical speed."""

import sys

import numpy as np

import gearwhine as gw
from gearwhine.figures import ProbeResponse, draw_unbalance_response
from gearwhine.rotors import Unbalance, critical_speeds, unbalance_response

steel = gw.ShaftMaterial(youngs_modulus=211e9, shear_modulus=81.2e9, density=7810.0)
disc = gw.Disc(at=0.4, mass=20.0, polar_inertia=0.2, diametral_inertia=0.11)
rotor = gw.Rotor("rotor", [gw.Segment(0.8, 0.05, 0.0, steel)], [disc])
stiffness, damping = 2e7 * np.eye(2), 5e3 * np.eye(2)
bearings = [gw.Bearing(name, at, stiffness, damping) for name, at in (("left", 0.0), ("right", 0.8))]

first = critical_speeds(rotor, bearings, speed_limit=gw.rpm(8000.0)).forward[0]
speeds = np.linspace(0.5, 1.5, 201) * first
response = unbalance_response(rotor, bearings, [Unbalance(at=0.4, moment=2e-4)], speeds)
motion = response.reading([0.4])[0][:, 0]  # along x, complex [m]
orbit = np.abs(motion)  # radius of a circle, since the bearings are isotropic
resonance = float(speeds[orbit.argmax()])

print(f"first forward critical speed {gw.to_rpm(first):.0f} rpm")
print(f"largest orbit {1e6 * orbit.max():.0f} µm at {gw.to_rpm(resonance):.0f} rpm")
probe = ProbeResponse("disc, along x", motion)
figure = draw_unbalance_response("Disc with unbalance", speeds, [probe], critical_speeds=[first])
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1])
