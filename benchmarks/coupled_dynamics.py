"""The transient: steps a second against ROSS and against scipy's integrators, and by the number of coordinates.

    python benchmarks/coupled_dynamics.py

Two equal shafts with the gear noise rig's 28 teeth on each, four bearings on the ground. ROSS gets the same shafts in
six elements, gears by its own energy method, and recalculates its mesh stiffness at every step. scipy gets the very
system that we march, its right-hand side compiled, and each of its methods the tolerance at which it is fastest and
errs no more than we do, by Newmark's method and by the exact march at several tolerances; the error is that of the
whole state at the end, against DOP853 with steps of 1/200 mesh period. Timed is the whole call of ``simulate``, its
static equilibrium, eigenvectors and proofs included, of a system that it has not seen; of scipy the call of
``solve_ivp``. The ratio is the median of three, each of runs that follow each other: a machine that is shared changes
its speed. Everything compiled is compiled before it is timed.
"""

import contextlib
import io
import math
import statistics
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
from numba import njit
from scipy.integrate import solve_ivp
from timing import arguments, machine, timed

from gearwhine.coupling import (
    CoupledMachine,
    CoupledSystem,
    GearMesh,
    MachineLoads,
    MountedBearing,
    MountedGear,
    Torque,
    TransientOutputs,
    TransientSettings,
    Unbalance,
    assemble_machine,
    simulate,
    static_equilibrium,
)
from gearwhine.coupling.gears import Gear, GearPairGeometry, PotentialEnergyStiffness, tooth_contact
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force
from gearwhine.coupling.machine.components import rotor_component
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.time.settings import Method
from gearwhine.rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial, modal_rotor

FloatArray = npt.NDArray[np.float64]

STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
TEETH, MODULE, WIDTH, BORE, PRESSURE_ANGLE = 28, 3.175e-3, 6.35e-3, 0.04, math.radians(20.0)
LENGTH, DIAMETER, PIECES = 0.33, 0.04, 6
STIFFNESS, DAMPING = 1.2e8, 5e3
SPEED = 5500 * 2 * math.pi / 60
TORQUE = 71.77
UNBALANCE = 2e-5
FRICTION = 0.06
MESH_PERIOD = 2.0 * math.pi / SPEED / TEETH
METHODS = ("RK45", "DOP853", "LSODA", "Radau", "BDF")
NEWMARK, EXACT = (1e-4,), (1e-3, 1e-5, 1e-7, 1e-8)  # tolerances
LONGEST = 15.0  # s: a method is asked for no more once it takes so long
TURNS, COMPARED = 3, 3


def two_shafts(modes: int, *, corners: bool, friction: float = 0.0) -> CoupledMachine:
    """Two shafts of so many planar and torsional modes each on the ground, in mesh."""
    gears = [Gear(name, TEETH, MODULE, PRESSURE_ANGLE, WIDTH, bore=BORE) for name in ("pinion", "wheel")]
    pair = GearPairGeometry(*gears)
    contact = tooth_contact(pair, PotentialEnergyStiffness(), 300.0, corner_contact=corners)
    rotors, bearings, mounted = [], [], []
    for number, (name, gear) in enumerate(zip(("input", "output"), gears, strict=True)):
        disc = Disc(LENGTH / 2, gear.mass, gear.polar_inertia, gear.diametral_inertia)
        shaft = Rotor(name, [Segment(LENGTH / PIECES, DIAMETER, 0.0, STEEL)] * PIECES, [disc])
        held = [
            Bearing.isotropic(f"{name} {end}", at, STIFFNESS, DAMPING) for end, at in (("back", 0.0), ("front", LENGTH))
        ]
        modal = modal_rotor(shaft, held, count=modes, gears_at=[LENGTH / 2])
        rotors.append(rotor_component(name, modal, start=0.0, damping_ratio=0.01))
        bearings += [MountedBearing(bearing, name, None) for bearing in held]
        mounted.append(MountedGear(gear.name, name, LENGTH / 2, (number * pair.working_centre_distance, 0.0)))
    return assemble_machine(
        rotors,
        None,
        speeds={"input": SPEED, "output": -SPEED},
        bearings=bearings,
        meshes=[GearMesh(mounted[0], mounted[1], pair, contact, friction=friction)],
        loads=MachineLoads(
            unbalances=[Unbalance("input", LENGTH / 2, UNBALANCE, 0.0)],
            torques=[Torque("input", 0.0, TORQUE), Torque("output", LENGTH, TORQUE)],
        ),
    )


def no_rows(system: CoupledSystem) -> TransientOutputs:
    """Forces alone are recorded."""
    none = np.zeros((0, system.size))
    return TransientOutputs(none, none, none)


def steps_a_second(machine: CoupledMachine, periods: int, tolerance: float = 1e-4) -> tuple[float, int]:
    """Of the march alone, its samples (a hundred each mesh period) included; the best of five runs."""
    settings = TransientSettings(periods * MESH_PERIOD, 0.0, MESH_PERIOD / 100, MESH_PERIOD / 8, tolerance)
    best, steps = 0.0, 0
    for _ in range(5):
        result = simulate(machine.system, settings, no_rows(machine.system))
        best, steps = max(best, result.steps / result.seconds), result.steps
    return best, steps


def ross_steps_a_second(steps: int) -> tuple[float, int]:
    """ROSS on the same shafts, a hundred steps a mesh period; also its degrees of freedom."""
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        import ross

        steel = ross.Material("steel", rho=7850.0, E=207e9, Poisson=0.3)

        def rotor(of: float) -> Any:
            shaft = [ross.ShaftElement(LENGTH / PIECES, 0.0, DIAMETER, material=steel, n=i) for i in range(PIECES)]
            gear = ross.GearElementTVMS(PIECES // 2, steel, WIDTH, BORE, MODULE, TEETH, PRESSURE_ANGLE)
            held = [ross.BearingElement(n, kxx=STIFFNESS, cxx=DAMPING) for n in (0, PIECES)]
            return ross.Rotor(shaft, [gear], held, tag=str(of))

        both = ross.MultiRotor(
            rotor(1.0), rotor(2.0), coupled_nodes=(PIECES // 2, PIECES // 2), update_mesh_stiffness=True
        )
        times = np.arange(steps) * MESH_PERIOD / 100
        forces = np.zeros((steps, both.ndof))
        forces[:, 5] = TORQUE
        forces[:, -1] = TORQUE
        _, seconds = timed(lambda: both.run_time_response(SPEED, forces, times, method="newmark"))
    return steps / seconds, both.ndof


@dataclass(frozen=True)
class Compiled:
    """The right-hand side of the very system that we march."""

    system: CoupledSystem

    def slope(self) -> Any:
        """A function of time and state, compiled."""
        system = self.system
        (contact,) = system.contacts
        (unbalance,) = system.harmonic_loads
        assert isinstance(unbalance, HarmonicLoad)
        stiffness, damping, load = system.stiffness, system.damping, system.load
        cosine, sine, frequency = unbalance.amplitude.real.copy(), unbalance.amplitude.imag.copy(), unbalance.frequency
        direction, phase, rate = contact.direction, contact.phase, contact.mesh_frequency
        law = tuple(
            np.ascontiguousarray(a) if isinstance(a, np.ndarray) else a for a in contact.contact.kernel_arguments
        )

        @njit
        def slope(time: float, state: FloatArray) -> FloatArray:
            n = load.size
            q, v = np.ascontiguousarray(state[:n]), np.ascontiguousarray(state[n:])
            force = tooth_force(phase + rate * time, np.dot(direction, q), np.dot(direction, v), *law)[0]
            out = np.empty(2 * n)
            out[:n] = v
            out[n:] = load - force * direction - np.dot(stiffness, q) - np.dot(damping, v)
            out[n:] += math.cos(frequency * time) * cosine - math.sin(frequency * time) * sine
            return out

        return slope


@dataclass(frozen=True)
class Run:
    """One integration: how long it took [s], how far off its end is, its steps or calls, and what does it again."""

    name: str
    seconds: float
    error: float
    count: int
    again: Callable[[], Any]


def ratio(theirs: Run, own: Run) -> float:
    """How many times as long theirs takes."""
    found = []
    for _ in range(TURNS):
        ours = statistics.median(timed(own.again)[1] for _ in range(5))
        found.append(timed(theirs.again)[1] / ours)
    return statistics.median(found)


def against_scipy(machine: CoupledMachine, periods: int) -> list[tuple[Run, list[tuple[Run, float]]]]:
    """Ours, and beside each the runs of every scipy method that err no more, by their time, with its ratio."""
    system = machine.system
    end = periods * MESH_PERIOD
    rows = np.eye(system.size)
    outputs = TransientOutputs(rows, rows, np.zeros((0, system.size)))
    start = np.concatenate([static_equilibrium(system), np.zeros(system.size)])
    slope = Compiled(system).slope()
    slope(0.0, start)
    exact = solve_ivp(slope, (0.0, end), start, "DOP853", rtol=1e-12, atol=1e-16, max_step=MESH_PERIOD / 200).y[:, -1]
    moved = exact - start

    def error(state: FloatArray) -> float:
        # Displacements and rates count alike, each by its own size.
        halves = [
            np.linalg.norm((state - exact)[h]) / np.linalg.norm(moved[h])
            for h in (slice(system.size), slice(system.size, None))
        ]
        return float(max(halves))

    def ours(method: Method, tolerance: float) -> Run:
        settings = TransientSettings(end * 1.0001, end, end, MESH_PERIOD / 8, tolerance, method=method)

        def again() -> Any:
            # A system of its own: what one knows of itself it has not kept from another call.
            return simulate(replace(system), settings, outputs)

        again()
        found, seconds = timed(again)
        reached = error(np.concatenate([found.displacement[0], found.velocity[0]]))
        return Run(f"{method} {tolerance:.0e}", seconds, reached, found.steps, again)

    scale = np.repeat([np.abs(start).max(), SPEED * np.abs(start).max()], system.size)

    def theirs(method: str) -> list[Run]:
        runs = []
        for rtol in 10.0 ** -np.arange(2.0, 12.0, 0.5):
            options: dict[str, Any] = {"t_eval": [end], "rtol": rtol, "atol": rtol * 1e-2 * scale}
            again = partial(solve_ivp, slope, (0.0, end), start, method, **options)
            found, seconds = timed(again)
            if found.success:
                runs.append(Run(f"{method} {rtol:.0e}", seconds, error(found.y[:, -1]), found.nfev, again))
            if seconds > LONGEST:
                break
        return runs

    scipys = [theirs(method) for method in METHODS]
    table = []
    for own in [*(ours("newmark", one) for one in NEWMARK), *(ours("exact", one) for one in EXACT)]:
        as_good = [[run for run in runs if run.error <= own.error] for runs in scipys]
        fastest = sorted((min(runs, key=lambda run: run.seconds) for runs in as_good if runs), key=lambda r: r.seconds)
        # The slowest methods are far from the point, and would take the most of the time.
        table.append((own, [(run, ratio(run, own)) for run in fastest[:COMPARED]]))
    return table


def main() -> None:
    given = arguments(__doc__, ross_steps=(int, 1500, "steps of ROSS"), periods=(int, 200, "mesh periods for scipy"))
    print(machine())
    print("\nsteps a second, by modes of each kind and rotor")
    speeds = {}
    for modes in (3, 6, 9, 16):
        built = two_shafts(modes, corners=True)
        speeds[modes] = steps_a_second(built, 600)
        print(f"  {built.system.size:4d} coordinates: {speeds[modes][0]:12,.0f}   ({speeds[modes][1]} steps)")
    rubbing = two_shafts(6, corners=True, friction=FRICTION)
    rate, steps = steps_a_second(rubbing, 600)
    share = f"{rate / speeds[6][0]:.2f} of those without"
    print(
        f"  with friction between the teeth, {rubbing.system.size} coordinates: {rate:,.0f}   ({steps} steps), {share}"
    )
    theirs, freedoms = ross_steps_a_second(given.ross_steps)
    ours = speeds[6][0]
    print(f"\nROSS with time-varying mesh stiffness, {freedoms} degrees of freedom: {theirs:,.0f} steps a second")
    print(f"ours with {two_shafts(6, corners=True).system.size} coordinates: {ours / theirs:,.0f} times as many")
    built = two_shafts(3, corners=True)
    print(f"\n{given.periods} mesh periods at equal error, {built.system.size} coordinates")
    for own, others in against_scipy(built, given.periods):
        print(f"  {own.name:14s} {1e3 * own.seconds:9.2f} ms   error {own.error:.1e}   {own.count:8d} steps")
        for run, times in others:
            told = f"error {run.error:.1e}   {run.count:8d} calls   x {times:.0f}"
            print(f"    {run.name:12s} {1e3 * run.seconds:9.2f} ms   {told}")


if __name__ == "__main__":
    main()
