"""Library objects of a case's tables, each made once: gear train, gears, shafts, bearings, gear pairs, machine.

Rolling bearings are linearised about their equilibrium under a load that the case gives; one whose load follows from
the machine's operating point has no stiffness yet.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from gearwhine.case.bearings import (
    Bearing,
    MatrixDamping,
    RadialDamping,
    RollingStiffness,
    StopStiffness,
    operation_loads,
)
from gearwhine.case.errors import UNSAID, CaseError, Problem
from gearwhine.case.gears import Gear, GearPair, distance_of_axes, readable_pairs, shaft_of, train_of_pairs
from gearwhine.case.housing import Material
from gearwhine.case.input_files import ChangedFileError, InputFiles
from gearwhine.case.operation import Operation
from gearwhine.case.planetary import HeldMember, Planetary, held_members, train_members
from gearwhine.case.rotors import Rotor
from gearwhine.coupling import Machine, MountedBearing, RollingLaw, Shaft, ShaftGear, TorqueSupport
from gearwhine.coupling.description.axial_location import AxialLocation, axial_support
from gearwhine.coupling.description.gear_train import LARGEST_OFFSET, GearTrain
from gearwhine.coupling.description.parts import LATERAL_LIMIT_HZ, inertia_with_discs, on_rigid_seats, rotor_with_gears
from gearwhine.coupling.description.planetary import PlacedSet, SetParts, placed_set, set_findings
from gearwhine.coupling.gears import Gear as BuiltGear
from gearwhine.coupling.gears import GearPairGeometry, StiffnessModel, stiffness_model
from gearwhine.coupling.gears.geometry.pair import signed_distance
from gearwhine.coupling.gears.loaded.gear_pair import GearPair as BuiltPair
from gearwhine.coupling.machine.bearing_laws import BearingLaw
from gearwhine.coupling.machine.loads import Torque
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding as PartFinding
from gearwhine.rotors import Bearing as RotorBearing
from gearwhine.rotors import EquilibriumError, Segment
from gearwhine.rotors import Rotor as BuiltRotor
from gearwhine.rotors import rolling_bearings as rolling
from gearwhine.rotors.analyses.solved_rotor import table_range

_TWO_PI = 2.0 * np.pi

# Shafts keep every bending mode up to LATERAL_LIMIT_HZ, or several times the housing's limit where that is higher;
# further modes respond statically, through attachment vectors at bearings and gears.
_HOUSING_FACTOR = 2.5


@dataclass(frozen=True, eq=False)
class Parts:
    """Library objects of the tables of a checked case, each made when it is first needed, and held.

    Attributes
    ----------
    material, rotor, bearing, gear, gear_pair, operation
        Tables of the case, by their names there; what is made of them has the plural.
    files : InputFiles
        The files that the case names.
    housing_limit_hz : float
        Frequency limit of the housing's modes [Hz]; 0 without one.
    planetary : sequence of Planetary
    """

    material: Mapping[str, Material]
    rotor: Sequence[Rotor]
    bearing: Sequence[Bearing]
    gear: Sequence[Gear]
    gear_pair: Sequence[GearPair]
    operation: Operation | None
    files: InputFiles
    housing_limit_hz: float = 0.0
    planetary: Sequence[Planetary] = ()
    torque_support: Sequence[HeldMember] = ()

    @cached_property
    def train(self) -> GearTrain:
        """The gear train; without gear pairs every shaft turns at the speed of the first.

        Its shafts have the names of rotors, or in a case without rotors those of gears.
        """
        shafts = [rotor.name for rotor in self.rotor] or [gear.name for gear in self.gear]
        held = held_members(self.planetary, self.torque_support)
        members = train_members(self.rotor, self.gear, held, self.operation)
        return train_of_pairs(readable_pairs(self.gear, enumerate(self.gear_pair)), shafts, members)

    @cached_property
    def speeds(self) -> dict[str, float]:
        """Speed of each shaft [rad/s], positive counter-clockwise from +z; empty without an operation."""
        if self.operation is None:
            return {}
        return {name: self.operation.speed * float(ratio) for name, ratio in self.train.ratios.items()}

    @cached_property
    def mesh_frequencies(self) -> tuple[float, ...]:
        """Tooth-mesh frequency of each gear pair [Hz]; empty without an operation."""
        return () if self.operation is None else self.train.mesh_frequencies(self.operation.speed)

    @cached_property
    def mesh_speeds(self) -> tuple[float | None, ...]:
        """Speed of the driver of each gear pair [rad/s], relative to the carrier of a planet; None where unknown."""
        speeds, pairs = self.speeds, self.train.pairs
        if len(pairs) < len(self.gear_pair):
            return tuple(speeds.get(shaft_of(self._tables_of(pair)[0])) for pair in self.gear_pair)
        return tuple(float(pair.relative_speed(speeds)) if speeds else None for pair in pairs)

    @cached_property
    def torques(self) -> tuple[Torque, ...]:
        """Torques from outside: the input first, then the outputs; empty without an operation.

        Without an `at`, the input is at the left end of its rotor, an output at the right end; in a case without
        rotors shafts have no length, and every torque is at 0.
        """
        lengths = {rotor.name: rotor.length for rotor in self.rotor}
        return () if self.operation is None else self.operation.applied_torques(self.train, lengths)

    @cached_property
    def pair_torques(self) -> tuple[float, ...]:
        """Mean torque that each gear pair takes off its driver [N m], positive where power flows to the driven gear.

        Zero without an operation.
        """
        if self.operation is None:
            return (0.0,) * len(self.gear_pair)
        return self.train.mean_pair_torques(self.torques, self.operation.speed)

    @cached_property
    def gears(self) -> dict[str, BuiltGear]:
        """Gears by name, of their materials.

        Raises
        ------
        gearwhine.coupling.gears.GearError
            Where there is no such gear.
        """
        return {gear.name: gear.build(self.material_of(gear)) for gear in self.gear}

    def material_of(self, gear: Gear) -> Material | None:
        """Return a gear's material: its own, else its rotor's, without a rotor the case's only one; or None."""
        if gear.rotor is not None and gear.at is not None:
            return self._rotor(gear.rotor).material_of(gear.material, gear.at, self.material)
        if gear.material is None and len(self.material) == 1:
            return next(iter(self.material.values()))
        return self.material[gear.material] if gear.material is not None else None

    @cached_property
    def shaft_gears(self) -> tuple[ShaftGear, ...]:
        """Gears on their shafts, rotor by rotor, in the order of the file."""
        return tuple(
            ShaftGear(
                self.gears[gear.name],
                rotor.name,
                gear.at,
                gear.given_inertia,
                stiffens_shaft=gear.stiffens_shaft and gear.face_width is not None,
            )
            for rotor in self.rotor
            for gear in self.gear
            if gear.rotor == rotor.name and gear.at is not None
        )

    @cached_property
    def shafts(self) -> tuple[Shaft, ...]:
        """Rotors, without their gears, as shafts of the machine."""
        return tuple(
            Shaft(
                rotor.build(self.material),
                rotor.axis,
                rotor.start,
                rotor.damping_ratio,
                rotor.build_unbalance(),
                rotor.build_bow(),
                *_retained_modes(rotor, self.housing_limit_hz),
                carrier=rotor.carrier,
                pin_error=rotor.pin_error,
                pin=rotor.build_pin(self.material),
                rim_seat=rotor.rim_seat,
                internal_damping=rotor.internal_damping,
            )
            for rotor in self.rotor
        )

    @cached_property
    def rotors(self) -> tuple[BuiltRotor, ...]:
        """Rotors with their gears on them as discs that stiffen them."""
        return tuple(rotor_with_gears(shaft.rotor, self.gears_on(shaft.name)) for shaft in self.shafts)

    def gears_on(self, rotor: str) -> list[ShaftGear]:
        """Return the gears on a rotor."""
        return [gear for gear in self.shaft_gears if gear.shaft == rotor]

    def finds_load(self, bearing: Bearing) -> bool:
        """Whether the load of a rolling bearing follows from the machine's operating point."""
        if self.operation is None:
            return False
        loaded = self.operation.loaded_rotors([one.name for one in self.rotor], geared=bool(self.gear_pair))
        return operation_loads(bearing, self.bearing, loaded)

    @cached_property
    def unloaded_bearings(self) -> tuple[MountedBearing, ...]:
        """Bearings of the file in their seats, a rolling one by its elements alone.

        Raises
        ------
        gearwhine.rotors.RotorError
            For a rolling bearing that cannot exist.
        """
        return tuple(self._unloaded(entry) for entry in self.bearing)

    def _unloaded(self, entry: Bearing) -> MountedBearing:
        stiffness, law, elements = np.zeros((5, 5)), None, None
        if isinstance(entry.stiffness, RollingStiffness):
            elements = entry.stiffness.rolling.build(entry.name, on_pin=self._is_around_pin(entry.rotor))
        elif isinstance(entry.stiffness, StopStiffness):
            law = entry.stiffness.stop.build()
            stiffness = law.tangent(_given_load(entry)[:2])
        else:
            stiffness = entry.stiffness.build()
        depends = isinstance(entry.stiffness, RollingStiffness | StopStiffness) and not self.finds_load(entry)
        return MountedBearing(
            _linear_bearing(entry, stiffness),
            entry.rotor,
            None if entry.grounded else entry.seat,
            law,
            elements,
            damping_time=entry.damping_time,
            design_load=_given_load(entry) if depends else None,
            seat_error=entry.seat_error.build(),
        )

    def _is_around_pin(self, rotor: str) -> bool:
        """Whether a rotor is a planet with a bore."""
        shaft = next(shaft for shaft in self.shafts if shaft.name == rotor)
        return shaft.carrier is not None and any(
            segment.inner_diameter for segment in shaft.rotor.segments if isinstance(segment, Segment)
        )

    @cached_property
    def rolling_states(self) -> dict[str, rolling.RollingState]:
        """Equilibria of rolling bearings under the load that the case gives, by name, each in line with its seat.

        Raises
        ------
        CaseError
            For a rolling bearing that cannot exist with its load.
        """
        states = {}
        for index, (entry, mounted) in enumerate(zip(self.bearing, self.unloaded_bearings, strict=True)):
            if mounted.rolling is not None and not self.finds_load(entry):
                load = [*_given_load(entry), 0.0, 0.0]
                try:
                    states[entry.name] = rolling.rolling_equilibrium(mounted.rolling, load, held={"rx": 0.0, "ry": 0.0})
                except EquilibriumError as error:
                    raise _refused(entry, index, error) from error
        return states

    @cached_property
    def bearings(self) -> tuple[MountedBearing, ...]:
        """Bearings in their seats, rotor by rotor: those of the rotor's own file on the ground, then those of the case.

        A bearing of the case takes the place of one of the same name in the rotor's file. Rolling bearings are
        linearised under the load that the case gives; one whose load is found has no stiffness.

        Raises
        ------
        CaseError
            For a rolling bearing that cannot exist with its load.
        """
        of_case = tuple(map(self._loaded, range(len(self.bearing))))
        return self._with_those_of_files(of_case)

    def _loaded(self, index: int) -> MountedBearing:
        """Return a bearing under the load that the case gives."""
        entry, mounted = self.bearing[index], self.unloaded_bearings[index]
        if entry.rolling is None or mounted.rolling is None:
            return mounted
        state = self.rolling_states.get(entry.name)
        law: BearingLaw | None = None
        if entry.rolling.law == "nonlinear":
            # A bearing whose load is left to the operating point is undeflected until then.
            undeflected = rolling.rolling_state(mounted.rolling, np.zeros(5))
            spalls = tuple(fault.build() for fault in entry.fault)
            slip = rolling.NO_SLIP if entry.slip is None else entry.slip.build()
            law = RollingLaw(undeflected if state is None else state, spalls=spalls, slip=slip)
        if state is None:
            return mounted if law is None else replace(mounted, law=law)
        try:
            stiffness = rolling.linearised_bearing(state, entry.name, entry.at).stiffness
        except EquilibriumError as error:
            raise _refused(entry, index, error) from error
        return replace(mounted, bearing=_linear_bearing(entry, stiffness), law=law)

    def _with_those_of_files(self, of_case: Sequence[MountedBearing]) -> tuple[MountedBearing, ...]:
        found = list[MountedBearing]()
        for rotor in self.rotor:
            on_it = [one for one in of_case if one.rotor == rotor.name]
            replaced = {one.bearing.name for one in on_it}
            saved = rotor.saved.bearings if rotor.saved is not None else ()
            found += [MountedBearing(one, rotor.name, None) for one in saved if one.name not in replaced]
            found += on_it
        return tuple(found)

    def bearings_on(self, rotor: str) -> tuple[RotorBearing, ...]:
        """Return the bearings of one rotor as those of a rotor alone."""
        return tuple(one.bearing for one in self.bearings if one.rotor == rotor)

    @cached_property
    def axial_locations(self) -> tuple[AxialLocation, ...]:
        """Axial location of each rotor by its bearings."""
        held = self._with_those_of_files(self.unloaded_bearings)
        return tuple(
            AxialLocation(rotor.name, [axial_support(one) for one in held if one.rotor == rotor.name])
            for rotor in self.rotor
        )

    def table_range(self, rotor: str) -> tuple[float, float]:
        """Return the lowest and the highest speed, without sense, that the tables of a rotor's bearings hold [rad/s].

        Zero and infinity for bearings without tables.
        """
        held = self._with_those_of_files(self.unloaded_bearings)
        return table_range([one.bearing for one in held if one.rotor == rotor])

    def finds_misalignment(self, pair: GearPair) -> bool:
        """Whether the misalignment of a gear pair follows from the machine's operating point.

        By default it does if a torque loads the flanks of gears with a face on shafts in bearings; else it is 0.
        """
        if pair.misalignment is None:
            loaded = self.operation is not None and self.operation.torque != 0.0
            have_faces = all(gear.rotor is not None and gear.face_width is not None for gear in self._tables_of(pair))
            return loaded and have_faces and bool(self.bearing)
        return pair.misalignment == "found"

    @property
    def is_loaded(self) -> bool:
        """Whether torque, force, weight or preload loads the machine, so that it has an operating point."""
        operation = self.operation
        if operation is None or not self.rotor or not self.bearing:
            return False
        rolling = [entry.rolling for entry in self.bearing if entry.rolling is not None]
        preloaded = any(one.pressed or one.mounting is not None or one.axial_offset != 0.0 for one in rolling)
        return operation.torque != 0.0 or bool(operation.force) or operation.gravity is not None or preloaded

    @property
    def needs_operating_point(self) -> bool:
        """Whether there is no machine without its operating point: bearings or flanks are left to it explicitly.

        A misalignment that is left out does not count: where no equilibrium is found, it is taken as 0.
        """
        unaligned = any(pair.misalignment == "found" for pair in self.gear_pair)
        return unaligned or any(self.finds_load(bearing) for bearing in self.bearing)

    @cached_property
    def gear_pairs(self) -> tuple[BuiltPair, ...]:
        """Gear pairs with their contact.

        Raises
        ------
        CaseError
            Where the file of a stiffness has changed or is no table.
        """
        return tuple(self._build_pair(number, pair) for number, pair in enumerate(self.gear_pair))

    def _build_pair(self, number: int, entry: GearPair) -> BuiltPair:
        angle = None if self.finds_misalignment(entry) or entry.misalignment == "found" else entry.misalignment or 0.0
        stiffness: StiffnessModel | str = entry.stiffness.model
        if entry.stiffness.file is not None:
            key = f"gear_pair[{number}].stiffness.file"
            try:
                position, values = self.files.read(entry.stiffness.file, _stiffness_table, key=key)
            except ChangedFileError as error:
                raise CaseError([Problem(key, UNSAID, str(error))]) from error
            stiffness = stiffness_model("table", position=position, stiffness=values)
        elif entry.stiffness.value is not None:
            stiffness = stiffness_model(entry.stiffness.model, value=entry.stiffness.value)
        return BuiltPair(
            driver=entry.driver,
            driven=entry.driven,
            stiffness=stiffness,
            damping_ratio=entry.damping_ratio,
            damping=entry.damping,
            backlash=entry.backlash,
            friction=entry.friction,
            misalignment=angle,
            corner_contact=entry.corner_contact,
        )

    @cached_property
    def pair_geometries(self) -> tuple[GearPairGeometry, ...]:
        """Geometry of every gear pair at the distance of its shafts, or without backlash where shafts are missing.

        Raises
        ------
        gearwhine.coupling.gears.GearError
            Where the gears do not mesh.
        """
        return tuple(map(self._geometry, self.gear_pair))

    def _geometry(self, pair: GearPair) -> GearPairGeometry:
        driver, driven = self._tables_of(pair)
        offset = 0.0
        if driver.rotor is None or driver.at is None or driven.rotor is None or driven.at is None:
            distance = pair.centre_distance
        else:
            first, second = self._rotor(driver.rotor), self._rotor(driven.rotor)
            distance = distance_of_axes(first.axis, second.axis)
            offset = (second.start + driven.at) - (first.start + driver.at)
        offset = offset if abs(offset) > LARGEST_OFFSET else 0.0
        gears = self.gears[pair.driver], self.gears[pair.driven]
        return GearPairGeometry(*gears, None if distance is None else signed_distance(*gears, distance), offset)

    def rotating_inertias(self, pair: GearPair) -> tuple[float, float]:
        """Return the polar inertia that rotates with driver and driven gear [kg m²], with the discs at their places."""
        driver, driven = self._tables_of(pair)
        return self._inertia(driver), self._inertia(driven)

    def _inertia(self, entry: Gear) -> float:
        if entry.rotor is None:
            return entry.polar_inertia or self.gears[entry.name].polar_inertia
        gears = self.gears_on(entry.rotor)
        (gear,) = (shaft_gear for shaft_gear in gears if shaft_gear.name == entry.name)
        (shaft,) = (shaft for shaft in self.shafts if shaft.name == entry.rotor)
        return inertia_with_discs(gear, shaft.rotor, gears)

    def _tables_of(self, pair: GearPair) -> tuple[Gear, Gear]:
        tables = {gear.name: gear for gear in self.gear}
        return tables[pair.driver], tables[pair.driven]

    def _rotor(self, name: str) -> Rotor:
        return next(rotor for rotor in self.rotor if rotor.name == name)

    @cached_property
    def placed_sets(self) -> tuple[PlacedSet, ...]:
        """Planetary sets with their gears at their places."""
        return tuple(placed_set(one.build(), self._set_parts) for one in self.planetary)

    def set_findings(self) -> Iterator[PartFinding]:
        """Yield what is wrong or unlikely of the planetary sets and their carriers."""
        yield from set_findings([one.build() for one in self.planetary], self._set_parts)

    @property
    def _set_parts(self) -> SetParts:
        return SetParts(self.shafts, self.shaft_gears, self.gear_pair, self.unloaded_bearings)

    @cached_property
    def torque_supports(self) -> tuple[TorqueSupport, ...]:
        """Supports that hold members of planetary sets and other rotors from turning."""
        return tuple(one.build(self.gear) for one in held_members(self.planetary, self.torque_support))

    @cached_property
    def machine(self) -> Machine | None:
        """The machine with all that loads it, on rigid seats; None without rotors or an operation.

        Raises
        ------
        CaseError, gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError, gearwhine.coupling.gears.GearError
            Where the parts do not make a machine.
        """
        operation = self.operation
        if operation is None or not self.rotor:
            return None
        return Machine(
            **on_rigid_seats(self.shafts, self.bearings, self.torque_supports),
            gears=self.shaft_gears,
            gear_pairs=self.gear_pairs,
            speed=operation.speed,
            torque=operation.torque,
            outputs=[output.build() for output in operation.output],
            planetary_sets=[one.build() for one in self.planetary],
            input_shaft=operation.rotor,
            given_speeds=[drive.build() for drive in operation.drive],
            torque_at=operation.at or 0.0,
            forces=[force.build() for force in operation.force],
            torque_over_time=None if operation.over_time is None else operation.over_time.build(),
            ripple=[ripple.build() for ripple in operation.ripple],
            motor=None if operation.motor is None else operation.motor.build(),
            load=None if operation.load is None else operation.load.build(),
            base=None if operation.base is None else operation.base.build(),
            gravity=operation.gravity,
        )


def _retained_modes(rotor: Rotor, housing_limit_hz: float) -> tuple[float | None, int | None]:
    """Retained modes of a rotor: a frequency limit [rad/s], or a number of each kind."""
    if rotor.modes is not None:
        return None, rotor.modes
    if rotor.frequency_limit is not None:
        return _TWO_PI * rotor.frequency_limit, None
    return _TWO_PI * max(LATERAL_LIMIT_HZ, _HOUSING_FACTOR * housing_limit_hz), None


def _linear_bearing(entry: Bearing, stiffness: FloatArray) -> RotorBearing:
    damping = entry.damping_time * stiffness
    if isinstance(entry.damping, RadialDamping | MatrixDamping):
        damping = entry.damping.build()
    return RotorBearing(
        entry.name,
        entry.at,
        stiffness,
        damping,
        None if entry.speeds is None else np.array(entry.speeds),
        None if entry.pedestal is None else entry.pedestal.build(),
    )


def _given_load(entry: Bearing) -> tuple[float, float, float]:
    return (0.0, 0.0, 0.0) if entry.load is None else (entry.load.x, entry.load.y, entry.load.z)


def _refused(entry: Bearing, index: int, error: Exception) -> CaseError:
    expected = f"a bearing that its elements hold under its load; {error}"
    key, label = f"bearing[{index}].stiffness.rolling", f'bearing "{entry.name}"'
    return CaseError([Problem(key, UNSAID, expected, label=label)])


def _stiffness_table(path: Path, key: str) -> tuple[FloatArray, FloatArray]:
    """Return two columns of a CSV file, with or without a line of names: position [base pitches], stiffness [N/m]."""
    rows = []
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise CaseError([Problem(key, str(path), "a text file in UTF-8")]) from error
    for number, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            first, second = (float(part) for part in line.split(","))
        except ValueError as error:
            if number == 1:
                continue
            expected = f"two numbers with a comma between in line {number} of {path}"
            raise CaseError([Problem(key, line[:60], expected)]) from error
        rows.append((first, second))
    if len(rows) < 2:
        raise CaseError([Problem(key, str(path), "at least two rows: position in base pitches, stiffness in N/m")])
    columns = np.array(rows, dtype=np.float64).T
    return columns[0], columns[1]
