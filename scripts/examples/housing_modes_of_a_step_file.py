"""Natural modes of a housing from a STEP file, clamped under its floor, certified complete."""

import tempfile
from pathlib import Path

import gmsh

import gearwhine as gw

# A casting would come from CAD; here gmsh draws a box with one bore in its front wall.
step = Path(tempfile.mkdtemp()) / "case.step"
gmsh.initialize(interruptible=False)
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
outside = occ.addBox(-100, 0, -80, 200, 120, 160)
inside = occ.addBox(-90, 10, -70, 180, 100, 140)
bore = occ.addCylinder(0, 60, 60, 0, 0, 30, 25)
occ.cut([(3, outside)], [(3, inside), (3, bore)])
occ.synchronize()
gmsh.write(str(step))
gmsh.finalize()

steel = gw.Material(youngs_modulus=207e9, poisson_ratio=0.3, density=7850.0)
floor = gw.Support("floor", plane=((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)), fixed=(True, True, True))
seat = gw.Seat("front", center=(0.0, 0.06, 0.075), diameter=0.05)
housing = gw.Housing.from_step(step, 0.02, steel, seats=[seat], fixtures=[floor], damping_ratio=0.01)
modes = housing.modes(below_hz=4000.0)

print(f"{modes.modes.certificate.found} modes below 4 kHz, complete: {modes.modes.certificate.complete}")
print("  ".join(f"{frequency:.0f} Hz" for frequency in modes.frequencies_hz))
