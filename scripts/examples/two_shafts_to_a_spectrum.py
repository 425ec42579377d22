"""Two geared shafts on their bearings, from a list of parts to the spectrum of the tooth force."""

import math
from dataclasses import replace

import numpy as np

import gearwhine as gw
from gearwhine.coupling.gears import SquareStiffness

TEETH = {"pinion": 28, "wheel": 42}
DISTANCE = 3e-3 * sum(TEETH.values()) / 2  # of the shafts, at module 3 mm [m]

steel = gw.ShaftMaterial(youngs_modulus=211e9, shear_modulus=81.2e9, density=7810.0)
rotors = [gw.Rotor(name, [gw.Segment(0.25, 0.03, 0.0, steel)]) for name in ("input", "output")]
gears = [gw.Gear(name, teeth, 3e-3, math.radians(20.0), face_width=15e-3) for name, teeth in TEETH.items()]
ends = [gw.Bearing(name, at, 2e8 * np.eye(2), 500.0 * np.eye(2)) for name, at in (("left", 0.0), ("right", 0.25))]

machine = gw.Machine(
    shafts=[gw.Shaft(rotors[0], axis=(0.0, 0.0)), gw.Shaft(rotors[1], axis=(DISTANCE, 0.0))],
    gears=[gw.ShaftGear(gears[0], "input", at=0.125), gw.ShaftGear(gears[1], "output", at=0.125)],
    gear_pairs=[gw.GearPair("pinion", "wheel", SquareStiffness(1.5e8), damping_ratio=0.06)],
    bearings=[
        gw.MountedBearing(replace(end, name=f"{rotor.name} {end.name}"), rotor.name, None)
        for rotor in rotors
        for end in ends
    ],
    speed=gw.rpm(2400.0),
    torque=60.0,
)
motion = machine.simulate(revolutions=12, discard=8, tolerance=2e-3)
spectrum = motion.spectrum("mesh_force", "pinion -> wheel")
mean_force = float(motion.dataset["mesh_force"].sel(contact="pinion -> wheel").mean())

print({name: f"{gw.to_rpm(speed):.0f} rpm" for name, speed in machine.speeds.items()})
for harmonic in range(1, 6):
    frequency = harmonic * machine.mesh_frequencies[0]
    amplitude = np.interp(frequency, spectrum.frequencies, spectrum.amplitude)
    print(f"{frequency:7.1f} Hz {amplitude:8.2f} N")
print(f"{mean_force:.1f} N on average; energy balance closes to {motion.energy_error:.1e}")
