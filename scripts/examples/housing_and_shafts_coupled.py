"""A box-shaped housing under two geared shafts: modes of the coupled machine, and what its sensor hears."""

import math

import numpy as np

import gearwhine as gw
from coupling import coupled_modes, mesh_error_response
from coupling.gears import ConstantStiffness
from meshes import BoxGeometry
from meshes.box import Bore, WallThickness

DISTANCE = 3e-3 * 30
walls = WallThickness(*[0.012] * 6)
places = {"input": -DISTANCE / 2, "output": DISTANCE / 2}
bores = [Bore(f"{name}-{z:+.2f}", (x, 0.1, z), 0.05) for name, x in places.items() for z in (-0.1, 0.1)]
steel = gw.Material(youngs_modulus=207e9, poisson_ratio=0.3, density=7850.0)
floor = gw.Support("floor", surface="bottom", fixed=(True, True, True))
housing = gw.Housing.from_box(
    BoxGeometry((0.24, 0.2, 0.2), walls, tuple(bores)),
    0.025,
    steel,
    fixtures=[floor],
    sensors=[gw.Sensor("top", (0.0, 0.2, 0.03))],
    damping_ratio=0.01,
)
bearing_at = {f"{name}-{z:+.2f}": (name, z + 0.1) for name in places for z in (-0.1, 0.1)}
modes = housing.modes(below_hz=3000.0)

shaft_steel = gw.ShaftMaterial(youngs_modulus=211e9, shear_modulus=81.2e9, density=7810.0)
machine = gw.Machine(
    shafts=[
        gw.Shaft(gw.Rotor(name, [gw.Segment(0.2, 0.03, 0.0, shaft_steel)]), axis=(x, 0.1), start=-0.1)
        for name, x in places.items()
    ],
    gears=[gw.ShaftGear(gw.Gear(name, 30, 3e-3, math.radians(20.0), 15e-3), name, at=0.1) for name in places],
    gear_pairs=[gw.GearPair("input", "output", ConstantStiffness(1.5e8))],
    bearings=[
        gw.MountedBearing(gw.Bearing(seat, at, np.diag([2e8, 2e8]), np.diag([400.0, 400.0])), shaft, seat)
        for seat, (shaft, at) in bearing_at.items()
    ],
    speed=gw.rpm(3000.0),
    torque=50.0,
    housing=modes,
)
coupled = machine.assemble()
found = coupled_modes(coupled.system)
heard = mesh_error_response(coupled, 2.0 * np.pi * np.array([machine.mesh_frequencies[0]]))

print(f"housing alone {modes.frequencies_hz[0]:.0f} Hz; {len(found.frequencies_hz)} coupled modes")
print(f"top sensor: {1e-6 * abs(heard.sensor_acceleration['top'][0]):.4f} m/s² for 1 µm at the mesh frequency")
