"""Two geared shafts on their bearings, from a list of parts to the spectrum of the mesh force."""

import math

import numpy as np

import gearwhine as gw
from coupling.gears import SquareStiffness

steel = gw.ShaftMaterial(youngs_modulus=211e9, shear_modulus=81.2e9, density=7810.0)
teeth = {"pinion": 28, "wheel": 42}
gears = {name: gw.Gear(name, z, 3e-3, math.radians(20.0), face_width=15e-3) for name, z in teeth.items()}
distance = 1.5e-3 * sum(teeth.values())

machine = gw.Machine(
    shafts=[
        gw.Shaft(gw.Rotor("input", [gw.Segment(0.25, 0.03, 0.0, steel)]), axis=(0.0, 0.0), damping_ratio=0.02),
        gw.Shaft(gw.Rotor("output", [gw.Segment(0.25, 0.03, 0.0, steel)]), axis=(distance, 0.0), damping_ratio=0.02),
    ],
    gears=[gw.ShaftGear(gears["pinion"], "input", at=0.125), gw.ShaftGear(gears["wheel"], "output", at=0.125)],
    gear_pairs=[gw.GearPair("pinion", "wheel", SquareStiffness(1.5e8), damping_ratio=0.06)],
    bearings=[
        gw.MountedBearing(gw.Bearing(f"{shaft} {at}", at, np.diag([2e8, 2e8]), np.diag([500.0, 500.0])), shaft, None)
        for shaft in ("input", "output")
        for at in (0.0, 0.25)
    ],
    speed=gw.rpm(2400.0),
    torque=60.0,
)
motion = machine.simulate(revolutions=30, discard=20)
spectrum = motion.spectrum("mesh_force", "pinion -> wheel")
mesh_line = int(np.argmin(np.abs(spectrum.frequencies - machine.mesh_frequencies[0])))

print({name: f"{speed * 30 / math.pi:.0f} rpm" for name, speed in machine.speeds.items()})
print(f"mesh frequency {machine.mesh_frequencies[0]:.1f} Hz, amplitude {spectrum.amplitude[mesh_line]:.1f} N")
print(motion.dataset["mesh_force"].mean("time").values, "N on average; energy error", motion.energy_error)
