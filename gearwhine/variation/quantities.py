"""Quantities of one varied gearbox: numbers with names that end in their unit, and curves over speed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from gearwhine.coupling import CoupledMachine
from gearwhine.coupling.analyses.loaded_machine import LoadedMachine, load_machine
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.analyses.shafts_alone import bearings_on_rigid_seats
from gearwhine.coupling.analyses.transient import SolvedTransient, solve_transient
from gearwhine.coupling.description.parts import gear_disc
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
from gearwhine.coupling.gears.loaded.transmission_error import LoadedMesh, transmission_error_phasors
from gearwhine.coupling.linear.lines_over_speed import LinesOverSpeed, housing_rates, lines_over_speed, sensor_rms
from gearwhine.coupling.linear.tracked_modes import ObservedModes, observed_modes
from gearwhine.coupling.load_analysis.load_warnings import load_or_reason
from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.signals.spectrum import ACCELERATION_REFERENCE
from gearwhine.numerics.arrays import FloatArray
from gearwhine.output.quantity import RPM
from gearwhine.rotors.analyses.critical_speeds import critical_speeds
from gearwhine.variation.named_quantities import CRITICAL_SPEEDS, HARMONICS, TRACKED_MODES

if TYPE_CHECKING:  # with kernels of its own
    from gearwhine.coupling.sweep.line_sound import RadiatedPower

_SILENCE = 1e-12  # acceleration that stands for none [m/s²]
_NO_SOUND = -100.0  # sound power level that stands for none [dB]


@dataclass(frozen=True)
class Wanted:
    """What is found of each gearbox.

    Attributes
    ----------
    analyses : tuple of str
        Names of :data:`ANALYSES`, in the order wanted.
    speeds : tuple of float
        Signed speeds of lines [rad/s].
    plan : TransientPlan, optional
        Stretch of the motion.
    needs_load : bool, optional
        Whether parts of the machine are left to the operating point explicitly; by default as
        :func:`gearwhine.coupling.load_analysis.load_warnings.load_or_reason` has it.
    names : tuple of str
        Names of the quantities, in which ``*`` stands for any part; all of the analyses by default.
    """

    analyses: tuple[str, ...]
    speeds: tuple[float, ...] = ()
    plan: TransientPlan | None = None
    needs_load: bool | None = None
    names: tuple[str, ...] = ()

    @property
    def has_sound(self) -> bool:
        """Whether the sound is wanted, which needs the radiation of the housing."""
        return "sound" in self.analyses

    def has(self, name: str) -> bool:
        """Whether a quantity is wanted."""
        return not self.names or any(fnmatchcase(name, pattern) for pattern in self.names)


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Quantities of a gearbox.

    Attributes
    ----------
    numbers : dict of str to float
        By name.
    curves : dict of str to ndarray, shape (s,)
        Over the speeds.
    seconds : dict of str to float
        Time that took each quantity which is found by itself, and each analysis beside these [s]; empty of one on file.
    """

    numbers: dict[str, float]
    curves: dict[str, FloatArray] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)


Named = Iterator[tuple[str, float | FloatArray | Callable[[], float]]]
"""Quantities by name; a function finds one that takes long."""


def evaluate(
    machine: Machine,
    wanted: Wanted,
    radiated: RadiatedPower | None = None,
    modes: Callable[[], ObservedModes] | None = None,
) -> Evaluation:
    """Find the quantities of a gearbox.

    Parameters
    ----------
    machine : Machine
    wanted : Wanted
    radiated : RadiatedPower or None
        Radiation of its housing, which its sound needs.
    modes : callable or None
        Gives the modes of the gearbox without changes, by which its own are named; None of that itself.

    Raises
    ------
    gearwhine.coupling.CouplingError, gearwhine.coupling.gears.GearError, ...
        Where a machine with these values cannot be solved.
    """
    gearbox = _Gearbox(machine, wanted, radiated, modes)
    return _evaluation(wanted, {analysis: ANALYSES[analysis].find(gearbox) for analysis in wanted.analyses})


def _evaluation(wanted: Wanted, by_analysis: Mapping[str, Named]) -> Evaluation:
    """Return the wanted ones among quantities; others that are functions are not called."""
    numbers, curves, seconds = dict[str, float](), dict[str, FloatArray](), dict[str, float]()
    for analysis, named in by_analysis.items():
        start, alone = time.perf_counter(), 0.0
        for name, found in named:
            if not wanted.has(name):
                continue
            begin = time.perf_counter()
            value = found() if callable(found) else found
            if callable(found):
                seconds[name] = time.perf_counter() - begin
                alone += seconds[name]
            if isinstance(value, np.ndarray):
                curves[name] = value
            else:
                numbers[name] = float(value)
        seconds[analysis] = time.perf_counter() - start - alone
    return Evaluation(numbers, curves, seconds)


@dataclass(frozen=True, eq=False)
class _Gearbox:
    """A machine, and what several analyses have in common of it."""

    machine: Machine
    wanted: Wanted
    radiated: RadiatedPower | None = None
    modes: Callable[[], ObservedModes] | None = None

    @cached_property
    def load(self) -> SolvedLoad | None:
        """Operating point; None where nothing loads the machine or none is found."""
        if not self.machine.is_loaded:
            return None
        is_needed = True if "load" in self.wanted.analyses else self.wanted.needs_load
        return load_or_reason(self.machine, is_needed=is_needed)[0]

    @cached_property
    def loaded(self) -> LoadedMachine:
        """Machine about its operating point."""
        return load_machine(self.machine, None if self.load is None else self.load.point)

    @cached_property
    def observed_modes(self) -> ObservedModes:
        """Modes about the operating point."""
        masses = {shaft.name: self.machine.rotor(shaft.name).mass for shaft in self.machine.shafts}
        return observed_modes(self.loaded.coupled, masses)

    @cached_property
    def speeds(self) -> tuple[float, ...]:
        """Signed speeds of the lines [rad/s]."""
        return self.wanted.speeds or (self.loaded.coupled.speed,)

    @cached_property
    def limit(self) -> float:
        """Frequency up to which lines are complete [rad/s]."""
        housing = self.machine.housing_component
        if housing is None or housing.complete_below is None:
            raise CouplingError("lines: expected a housing whose modes are complete up to a known frequency")
        return housing.complete_below

    @cached_property
    def over_speed(self) -> LinesOverSpeed | None:
        """Lines at all speeds; None of sidebands and of tables over speed, with a machine of their own at each."""
        coupled = self.loaded.coupled
        if coupled.system.turns or any(one.bearing.speeds is not None for one in self.machine.bearings):
            return None
        return lines_over_speed(coupled, self.speeds, self.limit, of_housing=self.wanted.has_sound)

    @cached_property
    def at_speeds(self) -> tuple[CoupledMachine, ...]:
        """The machine at each speed."""
        point = None if self.load is None else self.load.point
        return tuple(load_machine(replace(self.machine, speed=speed), point).coupled for speed in self.speeds)

    @cached_property
    def pairs(self) -> Sequence[LoadedGearPair]:
        """Gear pairs under load; of an assembled machine those of it."""
        if {"modes", "lines", "sound", "motion"} & set(self.wanted.analyses):
            return self.loaded.pairs
        left_to_load = any(pair.misalignment is None for pair in self.machine.gear_pairs)
        if not left_to_load or self.load is None:
            return self.machine.linearised(None).loaded_pairs()
        for bearing in self.load.point.bearings:
            bearing.require_held()  # as where the stiffness of bearings is wanted, too, which no pair has a part in
        return self.machine.with_flanks_of(self.load.point).loaded_pairs()


def evaluate_pairs(pairs: Sequence[LoadedGearPair], wanted: Wanted) -> Evaluation:
    """Find the quantities of gear pairs without shafts."""
    return _evaluation(wanted, {"gears": _of_pairs(pairs)})


def _of_gears(gearbox: _Gearbox) -> Named:
    yield from _of_pairs(gearbox.pairs)


def _of_pairs(pairs: Sequence[LoadedGearPair]) -> Named:
    for pair in pairs:
        name, over = f"gear_pair.{pair.geometry.driver.name}-{pair.geometry.driven.name}", _OverAllPeriods(pair)
        yield f"{name}.transmission_error_peak_to_peak_m", pair.static.peak_to_peak_transmission_error
        yield f"{name}.transmission_error_over_hunting_period_m", over.peak_to_peak
        for number in range(1, HARMONICS + 1):
            yield f"{name}.transmission_error_harmonic_{number}_m", partial(over.harmonic, number)
        yield f"{name}.mesh_stiffness_n_per_m", over.stiffness


@dataclass(frozen=True, eq=False)
class _OverAllPeriods:
    """Static mesh of a pair over all mesh periods that differ, solved where a quantity of it is wanted."""

    pair: LoadedGearPair

    @property
    def periods(self) -> int:
        """Number of mesh periods."""
        return self.pair.carrying_flanks.hunting_period

    @property
    def mesh(self) -> LoadedMesh:
        """Mesh over these periods."""
        return self.pair.hunting or self.pair.static

    @cached_property
    def _harmonics(self) -> FloatArray:
        return np.abs(transmission_error_phasors(self.mesh, HARMONICS, self.periods))

    def peak_to_peak(self) -> float:
        """Peak-to-peak transmission error [m]."""
        return self.mesh.peak_to_peak_transmission_error

    def stiffness(self) -> float:
        """Mean mesh stiffness [N/m]."""
        return self.mesh.mean_mesh_stiffness

    def harmonic(self, number: int) -> float:
        """Amplitude of a mesh harmonic of the transmission error [m]."""
        return float(self._harmonics[number - 1])


def _of_load(gearbox: _Gearbox) -> Named:
    load = gearbox.load
    if load is None:
        raise CouplingError("load: nothing loads the machine; expected a torque, a force or weight")
    for pair in load.point.pairs:
        if pair.force == 0.0:
            continue
        name = f"gear_pair.{pair.names[0]}-{pair.names[1]}"
        yield f"{name}.k_h_beta", partial(getattr, pair, "k_h_beta")
        yield f"{name}.misalignment_rad", pair.misalignment
        if pair.known_face:
            yield f"{name}.contact_pressure_pa", partial(getattr, pair, "peak_pressure")
    for bearing in load.bearings:
        name = f"bearing.{bearing.load.name}"
        yield f"{name}.force_n", float(np.linalg.norm(bearing.load.force[:3]))
        if bearing.rated is not None and bearing.rated.life is not None:
            yield f"{name}.life_h", bearing.rated.life
        if bearing.rated is not None and bearing.rated.reference_life is not None:
            yield f"{name}.reference_life_h", bearing.rated.reference_life
    for one in load.planetary:
        yield f"planetary.{one.name}.mesh_load_factor", one.mesh_load_factor


def _of_rotors(gearbox: _Gearbox) -> Named:
    machine = gearbox.machine
    for name, (bearings, _) in bearings_on_rigid_seats(machine).items():
        found = critical_speeds(machine.rotor(name), bearings, count=2 * CRITICAL_SPEEDS).forward
        for number, speed in enumerate(found[:CRITICAL_SPEEDS], start=1):
            yield f"rotor.{name}.critical_speed_{number}_rpm", RPM * float(speed)


def _of_mass(gearbox: _Gearbox) -> Named:
    machine, housing = gearbox.machine, gearbox.machine.housing_component
    for mounted in machine.gears:
        yield f"gear.{mounted.gear.name}.mass_kg", gear_disc(mounted, machine.shaft(mounted.shaft).rotor).mass
    rotors = {shaft.name: machine.rotor(shaft.name).mass for shaft in machine.shafts}
    for name, mass in rotors.items():
        yield f"rotor.{name}.mass_kg", mass
    if housing is None:
        yield "machine.mass_kg", sum(rotors.values())
    elif housing.mass is not None:
        yield "housing.mass_kg", housing.mass
        yield "machine.mass_kg", housing.mass + sum(rotors.values())


def modes_of(machine: Machine, wanted: Wanted) -> ObservedModes:
    """Return the modes of the gearbox without changes, by which those of the others are named."""
    return _Gearbox(machine, wanted).observed_modes


def _of_modes(gearbox: _Gearbox) -> Named:
    nominal = gearbox.observed_modes if gearbox.modes is None else gearbox.modes()
    found = nominal.found_in(gearbox.observed_modes)[:TRACKED_MODES] / (2.0 * np.pi)
    for number, frequency in enumerate(found.tolist(), start=1):
        yield f"machine.natural_frequency_{number}_hz", frequency


def _of_lines(gearbox: _Gearbox) -> Named:
    over = gearbox.over_speed
    rms = np.array([sensor_rms(one, gearbox.limit) for one in gearbox.at_speeds]).T if over is None else over.rms
    for sensor, levels in zip(gearbox.loaded.coupled.sensor_rows, level_of(rms), strict=True):
        yield from _highest(gearbox, f"sensor.{sensor}.level_db", f"sensor.{sensor}.loudest_speed_rpm", levels)


def _highest(gearbox: _Gearbox, name: str, name_of_speed: str, levels: FloatArray) -> Named:
    """Yield the highest of the levels at the speeds, the speed at which it is, and all."""
    place = int(np.argmax(levels))
    yield name, float(levels[place])
    if len(levels) > 1:
        yield name_of_speed, RPM * abs(float(gearbox.speeds[place]))
    yield name, levels


def _of_sound(gearbox: _Gearbox) -> Named:
    radiated, over = gearbox.radiated, gearbox.over_speed
    if radiated is None:
        raise CouplingError("sound: expected a housing with its modes on a mesh, whose surface radiates")
    if over is None:
        lines = [housing_rates(one, gearbox.limit) for one in gearbox.at_speeds]
    else:
        lines = [over.housing_lines(place) for place in range(len(over.speeds))]
    levels = np.array([radiated.levels(frequencies / (2.0 * np.pi), rates) for frequencies, rates in lines]).T
    for name, of_name in zip(("sound_power_db", "sound_power_db_a"), np.maximum(levels, _NO_SOUND), strict=True):
        yield from _highest(gearbox, f"housing.{name}", f"housing.{name}_speed_rpm", of_name)


def level_of(rms: FloatArray) -> FloatArray:
    """Level of an acceleration by its root mean square [dB re 1 µm/s²]."""
    return np.asarray(20.0 * np.log10(np.maximum(rms, _SILENCE) / ACCELERATION_REFERENCE))


def _of_motion(gearbox: _Gearbox) -> Named:
    plan = gearbox.wanted.plan
    if plan is None:
        raise CouplingError("motion: expected a transient, such as revolutions = 40")
    loaded = gearbox.loaded
    if plan.run is not None:
        loaded = load_machine(gearbox.machine, None if gearbox.load is None else gearbox.load.point, plan.run)
    solved: SolvedTransient = solve_transient(loaded.coupled, plan)
    for sensor in solved.sensor_spectra:
        yield f"sensor.{sensor}.motion_level_db", float(level_of(np.array(solved.sensor_rms(sensor))))


@dataclass(frozen=True)
class Analysis:
    """Analysis of a varied gearbox.

    Attributes
    ----------
    find : callable
        Yields its quantities.
    needs : tuple of str
        Tables that it needs of a case.
    """

    find: Callable[[_Gearbox], Named]
    needs: tuple[str, ...]


ANALYSES: Mapping[str, Analysis] = {
    "gears": Analysis(_of_gears, ("gear_pair",)),
    "load": Analysis(_of_load, ("rotor", "bearing", "operation")),
    "rotors": Analysis(_of_rotors, ("rotor",)),
    "mass": Analysis(_of_mass, ("rotor", "operation")),
    "modes": Analysis(_of_modes, ("rotor", "operation")),
    "lines": Analysis(_of_lines, ("rotor", "operation", "gear_pair")),
    "sound": Analysis(_of_sound, ("housing", "rotor", "operation", "gear_pair")),
    "motion": Analysis(_of_motion, ("rotor", "operation", "transient")),
}
"""Analyses by name, in the order of their quantities."""

UNDER_LOAD = frozenset({"gears", "load", "modes", "lines", "sound", "motion"})
"""Analyses about an operating point."""


def usual_analyses(*, has_pairs: bool, is_loaded: bool, listens: bool) -> tuple[str, ...]:
    """Return what is found of a gearbox by default: gears, load and lines as far as it has them, else critical speeds.

    Parameters
    ----------
    has_pairs : bool
        Whether there are gear pairs.
    is_loaded : bool
    listens : bool
        Whether the housing has sensors.
    """
    held = {"gears": has_pairs, "load": is_loaded, "lines": has_pairs and is_loaded and listens}
    return tuple(name for name in held if held[name]) or ("rotors",)
