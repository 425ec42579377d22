"""Two geared shafts in a box-shaped housing: modes of the coupled machine, and the response of a sensor on its top."""

import numpy as np

import gearwhine as gw
from gearwhine.coupling.gears import ConstantStiffness
from gearwhine.meshes import Bore, BoxGeometry, WallThickness

AXES = {"input": (-0.045, 0.1), "output": (0.045, 0.1)}  # x, y [m]: 90 mm apart
seats = {f"{shaft} {side}": (*axis, z) for shaft, axis in AXES.items() for side, z in (("back", -0.1), ("front", 0.1))}
bores = tuple(Bore(name, center, diameter=0.05) for name, center in seats.items())
box = BoxGeometry((0.24, 0.2, 0.2), WallThickness.uniform(0.012), bores)
cast_iron = gw.Material(youngs_modulus=130e9, poisson_ratio=0.26, density=7200.0)
floor = gw.Support("floor", surface="bottom", fixed=(True, True, True))
top = gw.Sensor("top", (0.0, 0.2, 0.03))
housing = gw.Housing.from_box(box, 0.025, cast_iron, fixtures=[floor], sensors=[top], damping_ratio=0.01)

steel = gw.ShaftMaterial(youngs_modulus=211e9, shear_modulus=81.2e9, density=7810.0)
segment = gw.Segment(0.2, 0.03, 0.0, steel)
shafts = [gw.Shaft(gw.Rotor(name, [segment]), axis, start=-0.1) for name, axis in AXES.items()]
bearings = [gw.Bearing(name, z + 0.1, 2e8 * np.eye(2), 400.0 * np.eye(2)) for name, (_, _, z) in seats.items()]
gears = [gw.Gear(name, teeth=30, module=3e-3, pressure_angle=np.radians(20.0), face_width=15e-3) for name in AXES]
machine = gw.Machine(
    shafts=shafts,
    gears=[gw.ShaftGear(gear, gear.name, at=0.1) for gear in gears],
    gear_pairs=[gw.GearPair("input", "output", ConstantStiffness(1.5e8))],
    bearings=[gw.MountedBearing(bearing, bearing.name.split()[0], seat=bearing.name) for bearing in bearings],
    speed=gw.rpm(3000.0),
    torque=50.0,
    housing=housing.modes(below_hz=3000.0),
)
modes = machine.modes()
response = machine.mesh_error_response(2.0 * np.pi * np.array(machine.mesh_frequencies))
acceleration = 1e-6 * abs(response.sensor_acceleration["top"][0])  # of 1 µm

print(f"{len(modes.frequencies_hz)} coupled modes, the first elastic one at {modes.frequencies_hz[1]:.0f} Hz")
print(f"top: {acceleration:.3f} m/s² for 1 µm of transmission error at {machine.mesh_frequencies[0]:.0f} Hz")
