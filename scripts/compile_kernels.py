"""Compile the numerical kernels ahead, so that no first run has to: compile_kernels.py

Numba compiles a kernel when it is first called, and keeps it beside the source. Two processes call them side by side,
on machines as small as there are. What this leaves out is compiled when it is first used: nothing depends on it.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from gearwhine.cli import run_command
from gearwhine.coupling import CoupledSystem, TransientOutputs, TransientSettings, simulate
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force_history
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.periodic import periodic_response
from gearwhine.coupling.time.settings import Method
from gearwhine.housing.acoustics.boundary_elements import BoundaryElements
from gearwhine.housing.acoustics.boundary_integrals import solid_angles
from gearwhine.housing.acoustics.medium import HardPlane
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.fem.block_products import BlockProduct
from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial, solve_whirl

MASS = Component("mass", ("torsion",), np.zeros((1, 1)), np.full((1, 1), 0.2), np.zeros((1, 1)))
HELD = Component("mass", ("torsion",), np.ones((1, 1)), np.full((1, 1), 0.2), np.zeros((1, 1)))


def small_machine() -> CoupledSystem:
    """A mass that a tooth of varying stiffness holds."""
    stiffness = piecewise.tabulated(lambda s: 1.0 + 0.1 * np.cos(2.0 * np.pi * s), 1.0, tolerance=1e-3)
    contact = ToothContact(1.0, stiffness, piecewise.constant(0.0, 1.0))
    tooth = ContactConnector("contact", np.ones(1), contact, 0.0, 0.1, np.empty((0, 3)))
    return CoupledSystem((MASS,), (0.0,), contacts=(tooth,), load=np.ones(1))


UNEVEN = np.diag([2e6, 1e6])
COUPLED = np.diag([2e6, 2e6, 1e7, 1e4, 1e4]) + np.fliplr(np.diag(np.full(5, 1e3)))


def turn_in_bearings() -> None:
    """Whirl of a shaft in bearings that are not alike in x and y, which the case's are, and in some of five motions."""
    shaft = Rotor("shaft", [Segment(1.0, 0.05, 0.0, ShaftMaterial(2.1e11, 8.1e10, 7800.0))])
    for stiffness in (UNEVEN, COUPLED):
        damping = 10.0 * np.eye(len(stiffness))
        bearings = [Bearing(name, at, stiffness, damping) for name, at in (("left", 0.0), ("right", 1.0))]
        solve_whirl(shaft, bearings, 10.0, count=3)


def rotors_and_gears() -> None:
    turn_in_bearings()
    tell("rotors")
    tell("gears")
    short = ("transient.revolutions=1", "transient.discard=0", "gear_pair.0.friction=0.05")
    tell("run", "--no-pictures", *(part for change in short for part in ("--set", change)))


def radiate() -> None:
    """Sound of a square plate of 0.1 m in a baffle."""
    square = RadiatingSurface(
        0.1 * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]])
    )
    baffle = HardPlane(np.zeros(3), np.array([0.0, 0.0, 1.0]))
    solved = BoundaryElements(square, plane=baffle).solve(100.0, np.ones((6, 1)))
    solved.far_field(np.eye(3))
    solid_angles(square, np.ones((1, 3)))


def multiply() -> None:
    """Products of stiffness and mass of one node, as of a large housing, by its blocks."""
    node = np.zeros(1, dtype=np.int32)
    product = BlockProduct(np.array([0, 1], dtype=np.int32), node, np.eye(3)[None], np.ones(1), np.arange(3))
    for columns in (1, 16):
        product @ np.ones((3, columns))
    for precision in (np.float32, np.float64):
        product.with_inertia(np.ones((3, 1), precision))


def motions() -> None:
    for method in METHODS:
        settings = TransientSettings(20.0, 0.0, 0.1, 0.1, method=method)
        for machine in (small_machine(), CoupledSystem((HELD,), (0.0,))):
            simulate(machine, settings, TransientOutputs(*[np.ones((1, 1))] * 3))
    periodic_response(small_machine())
    (tooth,) = small_machine().contacts
    tooth_force_history(np.zeros(2), np.ones(2), np.zeros(2), *tooth.contact.kernel_arguments)
    radiate()
    multiply()


def tell(command: str, *options: str) -> None:
    """Have a command work on a small case, and leave nothing."""
    with tempfile.TemporaryDirectory() as folder:
        code = run_command([command, "spur-pair", "--quiet", "--output", str(Path(folder) / "out"), *options])
    if code:
        sys.exit(code)


EVERY = 15.0
"""Time between two signs of life [s]."""
METHODS: tuple[Method, ...] = ("newmark", "exact")
PARTS = (rotors_and_gears, motions)


def main() -> int:
    command = [sys.executable, __file__]
    running = [subprocess.Popen([*command, str(part)], stdout=subprocess.DEVNULL) for part in range(len(PARTS))]
    start = told = time.monotonic()
    while any(process.poll() is None for process in running):
        time.sleep(0.2)
        if time.monotonic() - told >= EVERY:
            told = time.monotonic()
            print(f"  still compiling after {told - start:.0f} s", flush=True)
    return max([process.wait() for process in running])


if __name__ == "__main__":
    if sys.argv[1:]:
        PARTS[int(sys.argv[1])]()
    else:
        sys.exit(main())
