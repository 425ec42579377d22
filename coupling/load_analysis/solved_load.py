"""Operating point of a machine: static equilibrium under its mean load, and lives of its bearings.

The equilibrium is that of :meth:`gearwhine.coupling.Machine.operating_point`, its plausibility that of
:mod:`gearwhine.coupling.load_analysis.load_warnings`.
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearwhine.coupling.analyses.gear_pairs import TakenMisalignment, taken_misalignments
from gearwhine.coupling.gears.loaded.gear_pair import load_gear_pair
from gearwhine.coupling.gears.loaded.transmission_error import LoadedMesh
from gearwhine.coupling.load_analysis.influences import LoadSensitivity
from gearwhine.coupling.load_analysis.planetary_load import (
    CarrierTurn,
    PlanetaryLoad,
    over_carrier_turn,
    planetary_load,
)
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.statics.operating_point import BearingLoad, OperatingPoint, PairLoad, ShaftDeflection, flank_gap
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress, silent
from gearwhine.rotors.rolling_bearings.rated_life import BearingLife

TORQUES = tuple(np.linspace(0.1, 1.5, 15).round(6).tolist())
"""Parts of the torque of operation at which the equilibrium is found over torque."""

_PLACES = 201  # places along a shaft at which its deflection is given
_ZERO_DEFLECTION = 1e-15  # deflection up to which it counts as zero [m]


@dataclass(frozen=True, eq=False)
class LoadedBearing:
    """A bearing at the operating point.

    Attributes
    ----------
    load : BearingLoad
    rated : BearingLife or None
        Ratings and lives of a rolling bearing; None of others.
    preload : float or None
        Axial force with which its rows are pressed without torque and weight [N], the larger of two; None where no
        bearing of the shaft has an axial offset or a spring.
    """

    load: BearingLoad
    rated: BearingLife | None = None
    preload: float | None = None

    @property
    def given_load(self) -> FloatArray | None:
        """Force of the shaft along x, y, z for which its stiffness is made [N]; None where there is none."""
        load = self.load.mounted.design_load
        return None if load is None else np.array(load)

    @property
    def peak_pressure(self) -> float | None:
        """Greatest pressure of the rolling elements [Pa]; None for other bearings."""
        return None if self.load.rolling is None else self.load.rolling.peak_pressure

    @property
    def most_loaded(self) -> dict[str, float] | None:
        """Row and number of the most loaded element from 1, its azimuth [rad] and load on the outer ring [N]."""
        if self.load.rolling is None:
            return None
        loads = [row.outer_load for row in self.load.rolling.rows]
        row = int(np.argmax([load.max() for load in loads]))
        place = int(np.argmax(loads[row]))
        azimuth = float(self.load.rolling.rows[row].azimuths[place])
        return {"row": row + 1, "element": place + 1, "azimuth_rad": azimuth, "load_n": float(loads[row][place])}

    @property
    def element_loads(self) -> FloatArray | None:
        """Load of each rolling element on the outer ring, row after row [N]; None for other bearings."""
        state = self.load.rolling
        return None if state is None else np.concatenate([row.outer_load for row in state.rows])


@dataclass(frozen=True)
class OverTurn:
    """A number over a common turn of the carriers.

    Attributes
    ----------
    mean, least, most : float
    """

    mean: float
    least: float
    most: float

    @classmethod
    def of(cls, values: Sequence[float]) -> "OverTurn":
        """Return the mean and the range of values at the angles of a turn."""
        return cls(float(np.mean(values)), min(values), max(values))


@dataclass(frozen=True, eq=False)
class PairOverTurn:
    """A gear pair over a common turn of the carriers.

    Attributes
    ----------
    loads : tuple of PairLoad
        The pair at each angle.
    """

    loads: tuple[PairLoad, ...]

    @cached_property
    def force(self) -> OverTurn:
        """Mesh force [N]."""
        return OverTurn.of([load.force for load in self.loads])

    @cached_property
    def misalignment(self) -> OverTurn:
        """Misalignment of the flanks at the operating point [rad]."""
        return OverTurn.of([load.misalignment for load in self.loads])

    @cached_property
    def k_h_beta(self) -> OverTurn | None:
        """Face load factor K_Hβ at the angles where the flanks carry; None where they carry at none."""
        factors = [load.k_h_beta for load in self.loads if load.force > 0.0]
        return OverTurn.of(factors) if factors else None


@dataclass(frozen=True, eq=False)
class LoadedPair:
    """A gear pair at the operating point, and the misalignment that mesh stiffness and motion take.

    Attributes
    ----------
    load : PairLoad
        Of sound teeth without pitch deviations.
    misalignment : TakenMisalignment
    hunting : LoadedMesh or None
        Static mesh over the hunting period, of teeth with their pitch deviations and faults under the force and the gap
        of the operating point; None where all mesh periods are alike, and where it is not asked for.
    over_turn : PairOverTurn or None
        Loads as the carriers turn; None where nothing changes with their angle.
    """

    load: PairLoad
    misalignment: TakenMisalignment
    hunting: LoadedMesh | None = None
    over_turn: PairOverTurn | None = None


@dataclass(frozen=True, eq=False)
class PlanetaryLoadOverTurn:
    """Load sharing of a planetary set over a common turn of the carriers.

    Attributes
    ----------
    loads : tuple of PlanetaryLoad
        The set at each angle.
    """

    loads: tuple[PlanetaryLoad, ...]

    @property
    def mesh_load_factor(self) -> OverTurn:
        """Mesh load factor K_γ at each angle."""
        return OverTurn.of([load.mesh_load_factor for load in self.loads])

    @property
    def load_shares(self) -> tuple[OverTurn, ...]:
        """Load share of each planet."""
        shares = [[planet.load_share for planet in load.planets] for load in self.loads]
        return tuple(map(OverTurn.of, zip(*shares, strict=True)))


@dataclass(frozen=True, eq=False)
class SolvedLoad:
    """The operating point of a machine.

    Attributes
    ----------
    machine : Machine
    point : OperatingPoint
    bearings : tuple of LoadedBearing
    pairs : tuple of LoadedPair
    over_torque : dict of float to OperatingPoint
        Equilibria by the torque of the first driver [N m], where they are asked for.
    sensitivity : LoadSensitivity or None
        Gradients, where they are asked for.
    planetary : tuple of PlanetaryLoad
        Load sharing of each planetary set that carries a load, at the first angle of its carrier.
    planetary_over_turn : tuple of PlanetaryLoadOverTurn
        Load sharing of these sets as the carriers turn; none where nothing changes with their angle.
    carrier_turns : tuple of CarrierTurn
        Equilibria over a turn of each planet carrier, where they are asked for.
    """

    machine: Machine
    point: OperatingPoint
    bearings: tuple[LoadedBearing, ...]
    pairs: tuple[LoadedPair, ...]
    over_torque: dict[float, OperatingPoint]
    sensitivity: LoadSensitivity | None = None
    planetary: tuple[PlanetaryLoad, ...] = ()
    planetary_over_turn: tuple[PlanetaryLoadOverTurn, ...] = ()
    carrier_turns: tuple[CarrierTurn, ...] = ()

    @property
    def on_housing(self) -> bool:
        """Whether the compliance of a housing acts; seats are rigid without."""
        return self.machine.housing is not None

    @property
    def gravity(self) -> Sequence[float] | None:
        """Gravity along x, y, z [m/s²]."""
        return self.machine.gravity

    @cached_property
    def shafts(self) -> tuple["DeflectedShaft", ...]:
        """Deflection of each shaft along it."""
        return tuple(_deflected(shaft, self.machine) for shaft in self.point.shafts)


@dataclass(frozen=True, eq=False)
class DeflectedShaft:
    """Deflection of a shaft at places along it.

    Attributes
    ----------
    name : str
    at : ndarray, shape (n,)
        Places from the left end [m].
    z : ndarray, shape (n,)
        Places along z of the machine [m].
    motion : ndarray, shape (6, n)
        Displacements along x, y, z [m] and rotations about them [rad].
    """

    name: str
    at: FloatArray
    z: FloatArray
    motion: FloatArray

    @property
    def largest(self) -> tuple[float, float]:
        """Largest displacement across the axis [m], and its place from the left end [m]; zeros where it is rounding."""
        across = np.hypot(self.motion[0], self.motion[1])
        place = int(across.argmax())
        return (float(across[place]), float(self.at[place])) if across[place] > _ZERO_DEFLECTION else (0.0, 0.0)

    @property
    def twist(self) -> float:
        """Largest difference of the rotation about z along the shaft [rad]."""
        return float(np.ptp(self.motion[5]))


def _deflected(deflection: ShaftDeflection, machine: Machine) -> DeflectedShaft:
    at = np.linspace(0.0, machine.shaft(deflection.name).rotor.length, _PLACES)
    return DeflectedShaft(deflection.name, at, deflection.part.start + at, deflection.motions(at))


def solve_load(
    machine: Machine,
    progress: Progress = silent,
    *,
    over_torque: bool = False,
    over_hunting_period: bool = False,
    carrier_turn: bool = False,
    aligned_by_default: Collection[str] = (),
) -> SolvedLoad:
    """Find the static equilibrium of a machine under its torques and its weight.

    Parameters
    ----------
    machine : Machine
    progress : callable
    over_torque : bool
        Whether to solve for the equilibria at `TORQUES` as well.
    over_hunting_period : bool
        Whether to solve pairs with pitch deviations or damaged teeth over their hunting period, too.
    carrier_turn : bool
        Whether to solve for the equilibria over a turn of each planet carrier as well.
    aligned_by_default : collection of str
        Labels of the pairs that are aligned because nothing is said of their misalignment.

    Raises
    ------
    gearwhine.coupling.CouplingError
        Where a load drives a motion that nothing holds.
    gearwhine.coupling.EquilibriumNotFoundError
        Where no equilibrium is found.
    """
    progress("static equilibrium of the machine")
    point = machine.operating_point()
    if any(machine.speeds[shaft.carrier] != 0.0 for shaft in machine.shafts if shaft.carrier is not None):
        progress("static equilibrium over a turn of the carriers")
        point = replace(point, over_turn=machine.over_turn(point))
    points: dict[float, OperatingPoint] = {}
    for number, part in enumerate(TORQUES if over_torque and machine.torque != 0.0 else ()):
        progress("static equilibrium over torque", number / len(TORQUES))
        outputs = [
            output if output.torque is None else replace(output, torque=part * output.torque)
            for output in machine.outputs
        ]
        loaded = replace(machine, torque=part * machine.torque, outputs=outputs)
        points[part * machine.torque] = loaded.operating_point()
    preloads = _preloads(machine, progress)
    over_turn = zip(*(one.bearings for one in point.over_turn or (point,)), strict=True)
    bearings = tuple(
        LoadedBearing(bearing, _rated_life(machine, loads), preloads.get(bearing.name))
        for bearing, loads in zip(point.bearings, over_turn, strict=True)
    )
    pairs = tuple(map(LoadedPair, point.pairs, taken_misalignments(machine.gear_pairs, point, aligned_by_default)))
    if len(point.over_turn) > 1:
        by_pair = zip(*(one.pairs for one in point.over_turn), strict=True)
        pairs = tuple(replace(pair, over_turn=PairOverTurn(loads)) for pair, loads in zip(pairs, by_pair, strict=True))
    if over_hunting_period:
        pairs = tuple(
            replace(pair, hunting=_over_hunting_period(machine, number, pair.load)) for number, pair in enumerate(pairs)
        )
    loaded_sets = [
        placed
        for placed in machine.placed_sets
        if any(machine.carrying_pairs[one.number] and point.pairs[one.number].force > 0.0 for one in placed.meshes)
    ]
    by_angle = [[planetary_load(machine, placed, one) for one in point.over_turn or (point,)] for placed in loaded_sets]
    planetary = tuple(loads[0] for loads in by_angle)
    sharing = tuple(PlanetaryLoadOverTurn(tuple(loads)) for loads in by_angle if len(loads) > 1)
    carriers = dict.fromkeys(placed.of.carrier for placed in loaded_sets) if carrier_turn else {}
    turns = tuple(over_carrier_turn(machine, carrier, progress=progress) for carrier in carriers)
    return SolvedLoad(
        machine,
        point,
        bearings,
        pairs,
        points,
        planetary=planetary,
        planetary_over_turn=sharing,
        carrier_turns=turns,
    )


def _rated_life(machine: Machine, over_turn: Sequence[BearingLoad]) -> BearingLife | None:
    """Return the life of a bearing by its load at each angle of the carriers; None where it does not roll."""
    states = [load.rolling for load in over_turn if load.rolling is not None]
    if not states:
        return None
    return BearingLife(states[0], machine.bearing_speed(over_turn[0].mounted), tuple(states))


def _over_hunting_period(machine: Machine, number: int, load: PairLoad) -> LoadedMesh | None:
    """Return the static mesh of a pair over its hunting period, at the force and the gap of the operating point."""
    geometry = machine.pair_geometries[number]
    gears = (geometry.driver, geometry.driven)
    if load.force == 0.0 or not any(gear.pitch_deviations or gear.faults for gear in gears):
        return None
    # Inertias are for the damping alone.
    pair = replace(machine.gear_pairs[number], misalignment=0.0, damping=0.0, **flank_gap([load])._asdict())
    torque = math.copysign(load.force * abs(geometry.driver.base_radius), machine.pair_torques[number])
    speed = machine.mesh_speeds[number]
    return load_gear_pair(pair, geometry, torque=torque, inertias=(1.0, 1.0), speed=speed).hunting


def _preloads(machine: Machine, progress: Progress) -> dict[str, float]:
    """Axial force of each rolling bearing's rows without torque and weight [N], on shafts with a preloaded bearing."""
    elements = {mounted.bearing.name: mounted.elements for mounted in machine.bearings}
    preloaded = {
        mounted.rotor for mounted in machine.bearings if mounted.elements is not None and mounted.elements.is_preloaded
    }
    if not preloaded:
        return {}
    progress("preload of the bearings")
    preloads = {}
    for bearing in machine.preload_point().bearings:
        rolling = elements[bearing.name]
        if (
            bearing.rolling is not None
            and rolling is not None
            and rolling.thrust_senses
            and bearing.mounted.rotor in preloaded
        ):
            preloads[bearing.name] = max(map(abs, bearing.rolling.row_thrusts)) + 0.0
    return preloads
