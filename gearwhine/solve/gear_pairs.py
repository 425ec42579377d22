"""Analysis of a gear pair under the case's torque: load sharing, contact pressure, transmission error.

Analyses over a range of torques give Harris maps and the optimal tip relief, whose aim is peak to peak, weighted
harmonics, or the level at a sensor.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, CaseError, Problem, force_origins, require
from gearwhine.case import GearPair as GivenPair
from gearwhine.case.errors import NOTHING
from gearwhine.case.gears import ReliefAim as GivenAim
from gearwhine.coupling.gears import (
    GearPairGeometry,
    LoadedMesh,
    ToothContact,
    harris_map,
    loaded_transmission_error,
    mesh_stiffness,
    optimal_tip_relief,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import FaceSlices
from gearwhine.coupling.gears.contact.tooth_pair import flank_gap
from gearwhine.coupling.gears.loaded.contact_pressure import mesh_pressure
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
from gearwhine.coupling.gears.loaded.optimal_relief import (
    HarrisMap,
    PeakToPeak,
    ReliefAim,
    ReliefOptimum,
    WeightedHarmonics,
    transmission_error_harmonics,
)
from gearwhine.coupling.gears.loaded.transmission_error import mesh_period_phases
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.coupling.linear.sensor_level import SensorLevel
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.from_case.gear_pairs import TakenMisalignment, misalignments_of_case
from gearwhine.numerics.progress import Progress, silent
from gearwhine.solve.housing_modes import SolvedHousing, solve_housing
from gearwhine.solve.machine import described_machine, reduce_housing

FloatArray = npt.NDArray[np.float64]

HARMONICS = 8
_PHASES = 400  # even phases of the mesh period, for the curves of all pairs
_PLACES = 200  # places along a flank
_AIMED_AT = 8  # harmonics of the mesh frequency, where the case does not name them


@dataclass(frozen=True, eq=False)
class MeshPeriodCurves:
    """A gear pair at even phases of its mesh period, (n,), with every pair of teeth (n, m); NaN where one is absent.

    Attributes
    ----------
    phases : ndarray, shape (n,)
        Parts of the mesh period of the flanks that carry; back flanks pass through theirs in the opposite order.
    mesh : LoadedMesh
        Loaded mesh under the case's torque.
    stiffness : ndarray, shape (n,)
        Mesh stiffness of all pairs on the path of contact [N/m].
    unloaded : ndarray, shape (n,)
        Transmission error without load [m].
    position : ndarray, shape (n, m)
        Place on the path of contact [base pitches].
    share : ndarray, shape (n, m)
        Part of the load on each tooth pair.
    pressure : ndarray, shape (n, m)
        Hertzian pressure, the largest over the face [Pa]; NaN where it is not known.
    face_place : ndarray, shape (s,), or None
        Distance of each slice from the middle of the face [m]; None where loads are even along it.
    """

    phases: FloatArray
    mesh: LoadedMesh
    stiffness: FloatArray
    unloaded: FloatArray
    position: FloatArray
    share: FloatArray
    pressure: FloatArray
    face_place: FloatArray | None


@dataclass(frozen=True, eq=False)
class PairAnalysis:
    """A solved gear pair with its loaded and unloaded curves, contact pressure, Harris map and optimal relief.

    Attributes
    ----------
    given : GearPair
        Table of the pair in the case.
    solved : LoadedGearPair
    misalignment : TakenMisalignment
        Misalignment of the flanks.
    widths_given : tuple of bool
        Whether the case gives the face width of the driver and of the driven gear; no pressure follows from a default.
    unloaded : ndarray, shape (n,)
        Transmission error without load at the phases of ``solved.static`` [m]: where the first teeth just touch.
    pressure : ndarray, shape (n, m) or (n, m, s), or None
        Hertzian pressure of every pair at every phase [Pa], see
        `gearwhine.coupling.gears.loaded.contact_pressure.mesh_pressure`. None without load, single pairs or face widths
        in the case.
    pitch_pressure : float or None
        Largest pressure at the pitch point [Pa]; None also where that is not on the path of contact.
    harris : HarrisMap or None
        Map from a tenth to twice the case's torque, with all teeth alike: without pitch deviations and damage. None
        unless asked for, and without a torque.
    optimum : ReliefOptimum or None
        Best relief for the case's torque, with all teeth alike; None unless asked for, and without a torque or
        single pairs.
    aim : ReliefAim
        Objective of the best relief.
    force_origin : str
        See :func:`gearwhine.case.force_origins`.
    """

    given: GivenPair
    solved: LoadedGearPair
    misalignment: TakenMisalignment
    widths_given: tuple[bool, bool]
    unloaded: FloatArray
    pressure: FloatArray | None
    pitch_pressure: float | None
    harris: HarrisMap | None = None
    optimum: ReliefOptimum | None = None
    aim: ReliefAim = field(default_factory=PeakToPeak)
    force_origin: str = "torques"

    @property
    def label(self) -> str:
        """The pair's gears."""
        return f"{self.solved.pair.driver} → {self.solved.pair.driven}"

    @cached_property
    def stiffness(self) -> FloatArray:
        """Mesh stiffness of all pairs on the path of contact at the phases of ``solved.static`` [N/m], (n,)."""
        return mesh_stiffness(self.solved.carrying_flanks, self.solved.static.phases)

    @property
    def flanks(self) -> tuple[FloatArray, FloatArray]:
        """Roll angles [rad] of driver and driven gear from form circle to tip, and the material over the involute [m].

        Both of shape (2, n).
        """
        gears = (self.solved.geometry.driver, self.solved.geometry.driven)
        ends = [(gear.roll_angle(gear.form_radius), gear.roll_angle(gear.tip_radius)) for gear in gears]
        rolls = [np.linspace(low, high, _PLACES) for low, high in ends]
        return np.array(rolls), np.array([-flank_gap(gear, roll) for gear, roll in zip(gears, rolls, strict=True)])

    @property
    def shares(self) -> tuple[FloatArray, FloatArray] | None:
        """Part of the load that a pair of teeth has along its path: places [base pitches] in order, and parts.

        None without load or single pairs.
        """
        static = self.solved.static
        if static.force == 0.0 or not self.solved.has_single_pairs:
            return None
        present = self.solved.carrying_flanks.pairs(static.phases).present
        order = np.argsort(static.positions[present], kind="stable")
        return static.positions[present][order], static.load_shares[present][order]

    @property
    def largest_pressure(self) -> tuple[float, float] | None:
        """The largest Hertzian pressure on the path of contact [Pa], and the driver's roll angle there [rad]."""
        if self.pressure is None:
            return None
        geometry, faces = self.solved.geometry, self.solved.carrying_flanks.faces
        positions = self.solved.static.positions
        if faces is not None:
            positions = positions[..., None] + faces.shift
        pressure = np.nan_to_num(self.pressure, nan=0.0, posinf=np.inf)
        place = np.unravel_index(int(pressure.argmax()), pressure.shape)
        return float(pressure[place]), float(geometry.driver_roll_angle(positions[place]))

    def curves(self) -> MeshPeriodCurves:
        """Return the pair's curves at even phases of the mesh period."""
        phases = np.arange(_PHASES) / _PHASES
        contact = self.solved.carrying_flanks
        faces = contact.faces
        mesh = loaded_transmission_error(contact, self.solved.static.force, phases)
        absent = ~contact.pairs(phases).present
        pressure = np.full(mesh.positions.shape, np.nan)
        if self.pressure is not None:
            whole = mesh_pressure(self.solved.geometry, contact, mesh)
            # Over the face the largest; what lies off the path has none.
            pressure = whole if whole.ndim == 2 else np.fmax.reduce(whole, axis=2)
        return MeshPeriodCurves(
            phases=phases,
            mesh=mesh,
            stiffness=mesh_stiffness(contact, phases),
            unloaded=first_touch(contact, phases),
            position=np.where(absent, np.nan, mesh.positions),
            share=np.where(absent, np.nan, mesh.load_shares),
            pressure=np.where(absent, np.nan, pressure),
            face_place=None if faces is None or mesh.line_loads is None else faces.z,
        )

    @property
    def harmonics(self) -> FloatArray:
        """Amplitudes of the transmission error at the mesh frequency and its multiples [m], (8,).

        They are of the whole hunting period where mesh periods differ: other frequencies average out.
        """
        mesh, hunting = self.solved.static, self.solved.hunting
        if hunting is not None:
            periods = self.solved.contact.hunting_period
            over = hunting.transmission_error.reshape(periods, -1).mean(axis=0)
            mesh = replace(hunting, phases=hunting.phases[: over.size], transmission_error=over)
        return transmission_error_harmonics(mesh, HARMONICS)

    @property
    def unloaded_harmonics(self) -> FloatArray:
        """Harmonics of the transmission error without load, over the mesh period of ``solved.static`` [m], (8,)."""
        return transmission_error_harmonics(replace(self.solved.static, transmission_error=self.unloaded), HARMONICS)

    @property
    def aimed_as_given(self) -> float:
        """Value of the aim with the given flanks, all teeth alike."""
        return self.aim.of(*_mesh_as_given(self.solved))

    @property
    def as_given(self) -> float | None:
        """Peak to peak at the case's torque with all teeth alike [m]; None without a Harris map."""
        if self.harris is None:
            return None
        return float(self.harris.peak_to_peak[np.abs(self.harris.forces - self.solved.static.force).argmin()])

    @property
    def pairs_in_contact(self) -> dict[int, float]:
        """Part of the mesh period by number of pairs that carry; a phase counts up to half way to its neighbours."""
        static = self.solved.static
        touching = (static.pair_forces > 0.0).sum(axis=1)
        around = np.concatenate([[static.phases[-1] - 1.0], static.phases, [static.phases[0] + 1.0]])
        part = 0.5 * (around[2:] - around[:-2])
        return {int(count): float(part[touching == count].sum()) for count in np.unique(touching)}

    @property
    def loaded_contact_ratio(self) -> float:
        """Mean number of pairs in contact: less than the contact ratio by relief, more by corner contact."""
        return sum(count * part for count, part in self.pairs_in_contact.items())

    @property
    def corner_force(self) -> float:
        """The largest force that a pair's corners carry, outside its path of contact [N]."""
        static, end = self.solved.static, self.solved.geometry.contact_ratio
        faces = self.solved.carrying_flanks.faces
        if faces is None or static.line_loads is None:
            outside = (static.positions < 0.0) | (static.positions > end)
            return float(static.pair_forces[outside].max(initial=0.0))
        places = static.positions[..., None] + faces.shift
        carried = np.where((places < 0.0) | (places > end), static.line_loads, 0.0)
        return float(carried.sum(axis=-1).max(initial=0.0)) * faces.width


def analyse_pairs(
    case: Case, solved: Sequence[LoadedGearPair], point: OperatingPoint | None = None
) -> tuple[PairAnalysis, ...]:
    """Analyse each solved gear pair under the case's torque and without load.

    ``point`` is the machine's operating point, where it is solved.
    """
    rows = zip(case.gear_pair, solved, misalignments_of_case(case, point), strict=True)
    analysed = (_analysis(case, entry, pair, misalignment) for entry, pair, misalignment in rows)
    origins = force_origins(case)
    return tuple(replace(pair, force_origin=origin) for pair, origin in zip(analysed, origins, strict=True))


def first_touch(contact: ToothContact, phases: FloatArray) -> FloatArray:
    """Transmission error without load at `phases` (n,): the least gap of the pairs there [m]."""
    return np.asarray(contact.pairs(phases).deviation.min(axis=1), dtype=np.float64)


def _analysis(case: Case, entry: GivenPair, pair: LoadedGearPair, misalignment: TakenMisalignment) -> PairAnalysis:
    unloaded = first_touch(pair.carrying_flanks, pair.static.phases)
    driver, driven = case.gear_named(pair.pair.driver), case.gear_named(pair.pair.driven)
    widths_given = driver.face_width is not None, driven.face_width is not None
    if pair.static.force == 0.0 or not pair.has_single_pairs or not all(widths_given):
        return PairAnalysis(entry, pair, misalignment, widths_given, unloaded, None, None)
    pressure = mesh_pressure(pair.geometry, pair.carrying_flanks, pair.static)
    return PairAnalysis(entry, pair, misalignment, widths_given, unloaded, pressure, _pitch_pressure(pair))


def _pitch_pressure(pair: LoadedGearPair) -> float | None:
    """Return the largest pressure as a pair, or a slice of its face, passes the pitch point [Pa]; None off the path."""
    pitch, contact = pair.geometry.pitch_point_position, pair.carrying_flanks
    if not 0.0 <= pitch < pair.geometry.contact_ratio:
        return None
    shift = np.zeros(1) if contact.faces is None else contact.faces.shift
    mesh = loaded_transmission_error(contact, pair.static.force, np.unique((pitch - shift) % 1.0))
    pressure = mesh_pressure(pair.geometry, contact, mesh).reshape(*mesh.positions.shape, -1)
    passing = np.isclose(mesh.positions[..., None] + shift, pitch, rtol=0.0, atol=1e-9)
    return float(pressure[passing].max())


_SEARCHED_SLICES = 21  # slices of a face in the search for the best relief
_LEAST, _MOST, _TORQUES = 0.1, 2.0, 20  # range of a Harris map as parts of the case's torque, and number of torques


def solve_over_torques(
    pairs: Sequence[PairAnalysis], progress: Progress = silent, aims: Sequence[ReliefAim] = ()
) -> tuple[PairAnalysis, ...]:
    """Add Harris maps and optimal reliefs to analysed pairs, where the case has a torque.

    ``aims`` are those of the reliefs, one for each pair; all peak to peak where not given.
    """
    analysed = []
    for pair, aim in zip(pairs, aims or [PeakToPeak()] * len(pairs), strict=True):
        if pair.solved.static.force > 0.0:
            progress(f"Harris map of {pair.label}")
            pair = replace(pair, harris=_harris_map(pair.solved))
            if pair.solved.has_single_pairs:
                progress(f"best tip relief of {pair.label}")
                pair = replace(pair, optimum=_best_relief(pair.solved, aim), aim=aim)
        analysed.append(pair)
    return tuple(analysed)


def _harris_map(pair: LoadedGearPair) -> HarrisMap:
    contact = pair.carrying_flanks
    if contact.hunting_period > 1:
        contact = tooth_contact(
            _alike(pair.geometry), pair.model, corner_contact=contact.has_corner_contact, faces=contact.faces
        )
    return harris_map(contact, pair.static.force * np.linspace(_LEAST, _MOST, _TORQUES))


def _best_relief(pair: LoadedGearPair, aim: ReliefAim) -> ReliefOptimum:
    relief = pair.geometry.driver.tip_relief or pair.geometry.driven.tip_relief
    geometry, force, faces = _alike(pair.geometry), pair.static.force, pair.carrying_flanks.faces
    corners = pair.contact.has_corner_contact
    return optimal_tip_relief(
        geometry,
        pair.model,
        [force],
        shape="linear" if relief is None else relief.shape,
        corner_contact=corners,
        faces=faces,
        searched_faces=None if faces is None else with_coarser_slices(faces, _SEARCHED_SLICES),
        aim=aim,
    )


def with_coarser_slices(faces: FaceSlices, count: int) -> FaceSlices:
    """Return the same face in at most `count` slices: faster to search with, and as good for finding a place."""
    if faces.z.size <= count:
        return faces
    z = faces.face_width * ((np.arange(count) + 0.5) / count - 0.5)
    shift, gap = (np.interp(z, faces.z, values) for values in (faces.shift, faces.gap))
    return replace(faces, z=z, width=faces.face_width / count, shift=shift, gap=gap)


def _alike(pair: GearPairGeometry) -> GearPairGeometry:
    """Return the pair with all teeth of a gear alike: a relief is cut for all of them."""
    driver, driven = (replace(gear, pitch_deviations=(), faults=()) for gear in (pair.driver, pair.driven))
    return replace(pair, driver=driver, driven=driven)


def relief_aims(
    case: Case,
    pairs: tuple[LoadedGearPair, ...],
    progress: Progress = silent,
    *,
    point: OperatingPoint | None = None,
    housing: SolvedHousing | None = None,
    folder: Path | None = None,
) -> tuple[ReliefAim, ...]:
    """Objective of the tip-relief search for each pair.

    ``point`` is the machine's operating point, where it is solved already.

    The aim at a sensor is the root mean square of its acceleration over the multiples n of the mesh frequency,
    √(½ Σ (w_n a_n)²), with a_n the linear response to transmission error and load shuttling together about the case's
    mean load, see :class:`gearwhine.coupling.linear.sensor_level.SensorLevel`. By default it is the sensor at which the
    given flanks are loudest, where ``housing`` is given and the machine turns, else the peak-to-peak transmission
    error. Where the case names a sensor, the housing is solved for it if it is not given.

    Raises
    ------
    CaseError
        Where a sensor is aimed at and the pair does not turn, or no multiple lies below the model's limit.
    CouplingError
        Where the machine's loads cannot balance, so that a pair has no mean force in it.
    """
    aims = [entry.relief_aim for entry in case.gear_pair]
    if not aims_at_sensor(case) and (housing is None or not _may_aim_at_sensors(case)):
        return tuple(_without_sensor(aim) for aim in aims)
    require(case, "rotor", "operation", "housing", command="gears with the aim at a sensor")
    housing = housing or solve_housing(case, progress, folder=folder)
    described = described_machine(case, reduce_housing(case, housing, progress))
    if point is None and described.needs_operating_point:
        point = described.operating_point()
    machine = described.linearised(point)
    model = MeshHarmonicModel(machine.assemble(pairs, machine.rotor_components(progress=progress)))
    rows = zip(range(len(aims)), pairs, aims, strict=True)
    return tuple(_aim_of(model, housing, number, pair, aim) for number, pair, aim in rows)


def _aim_of(
    model: MeshHarmonicModel, housing: SolvedHousing, number: int, pair: LoadedGearPair, aim: GivenAim | None
) -> ReliefAim:
    """Return the objective of a pair in a machine: at a sensor, by default at the loudest one."""
    if pair.static.force == 0.0:
        return PeakToPeak()  # a pair without load has no best relief
    if aim is not None and aim.sensor is None:
        return _without_sensor(aim)
    limit, key = housing.trusted_limit_hz, f"gear_pair[{number}].relief_aim"
    if not pair.mesh_frequency:
        if aim is None:
            return PeakToPeak()
        raise CaseError([Problem(key, NOTHING, "a speed: the level at a sensor is of gears that turn")])
    given = {} if aim is None else aim.weights
    all_weights = given or dict.fromkeys(range(1, _AIMED_AT + 1), 1.0)
    weights = {n: weight for n, weight in all_weights.items() if weight and n * pair.mesh_frequency <= limit}
    if not weights:
        if aim is None:
            return PeakToPeak()
        expected = f"multiples of the mesh frequency of {pair.mesh_frequency:.5g} Hz below {limit:.5g} Hz"
        raise CaseError(
            [Problem(f"{key}.harmonics", list(all_weights), f"{expected}, up to which the modes are known")]
        )
    follows = pair.pair.damping is None
    sensors = tuple(housing.sensors) if aim is None or aim.sensor is None else (aim.sensor,)
    levels = [SensorLevel(model, number, sensor, weights, damping_follows=follows) for sensor in sensors]
    if len(levels) == 1:
        return levels[0]
    mesh, flanks = _mesh_as_given(pair)
    return max(levels, key=lambda level: level.of(mesh, flanks))


def _mesh_as_given(pair: LoadedGearPair) -> tuple[LoadedMesh, ToothContact]:
    """Return the loaded mesh of the flanks that carry, all teeth alike, and their contact law."""
    flanks = pair.carrying_flanks.teeth_alike
    return loaded_transmission_error(flanks, pair.static.force, mesh_period_phases(flanks)), flanks


def _may_aim_at_sensors(case: Case) -> bool:
    """Whether a case has what the level at a sensor needs: a machine that turns in a housing with sensors."""
    turns = case.operation is not None and case.operation.speed != 0.0 and bool(case.rotor)
    return turns and case.housing is not None and bool(case.housing.sensor)


def aims_at_sensor(case: Case) -> bool:
    """Whether the tip relief of a gear pair aims at a sensor, for which the housing is solved."""
    return any(pair.relief_aim is not None and pair.relief_aim.sensor is not None for pair in case.gear_pair)


def _without_sensor(aim: GivenAim | None) -> ReliefAim:
    return PeakToPeak() if aim is None or aim.peak_to_peak else WeightedHarmonics(aim.weights)
