"""Analysis of a gear pair under its mean torque: load sharing, contact pressure, transmission error.

Analyses over a range of torques give Harris maps and the optimal tip relief, whose aim is peak to peak, weighted
harmonics, or the level at a sensor.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.description.gear_train import EQUAL_MESHES, GearTrain
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
from gearwhine.coupling.gears.contact.tooth_pair import flank_gap
from gearwhine.coupling.gears.errors import ThinTipError
from gearwhine.coupling.gears.geometry.gear import require_tip_thickness
from gearwhine.coupling.gears.loaded.contact_pressure import mesh_pressure
from gearwhine.coupling.gears.loaded.gear_pair import GearPair, LoadedGearPair
from gearwhine.coupling.gears.loaded.optimal_relief import (
    HarrisMap,
    PeakToPeak,
    ReliefAim,
    ReliefOptimum,
    transmission_error_harmonics,
)
from gearwhine.coupling.gears.loaded.transmission_error import (
    MeshStiffnessFigures,
    along_one_pair,
    mesh_period_phases,
    mesh_stiffness_figures,
)
from gearwhine.coupling.gears.stiffness.models import ring_support_warning
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.coupling.linear.sensor_level import SensorLevel
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress, silent

HARMONICS = 8
_TWO_PI = 2.0 * np.pi
_PHASES = 400  # even phases of the mesh period, for the curves of all pairs
_PLACES = 200  # places along a flank
_AIMED_AT = 8  # harmonics of the mesh frequency, where none are named


@dataclass(frozen=True)
class TakenMisalignment:
    """Misalignment that mesh stiffness and motion of a gear pair take.

    Attributes
    ----------
    taken : float or None
        Misalignment that mesh stiffness and motion take [rad]; None where the operating point gives it and is not
        solved.
    origin : str
        Origin of that misalignment: ``operating point``, ``case`` where the case gives it, or ``default``, which is 0.
    found : float or None
        Misalignment at the operating point [rad], of planets at their carriers' first angle; None where that is not
        solved.
    over_turn : tuple of float or None
        Least and greatest over a turn of planet carriers, of which ``taken`` is the mean [rad]; None where it stays,
        and where the turn is not solved.
    """

    taken: float | None
    origin: str
    found: float | None
    over_turn: tuple[float, float] | None = None


def taken_misalignments(
    pairs: Sequence[GearPair],
    point: OperatingPoint | None,
    aligned_by_default: Collection[str] = (),
    *,
    is_sought: bool = True,
) -> tuple[TakenMisalignment, ...]:
    """Misalignment of every gear pair of a machine, beside that of its operating point where it is solved.

    ``aligned_by_default`` are the labels of pairs that are aligned because nothing is said of their misalignment, and
    ``is_sought`` is false before the point is sought: flanks that are left to it are not yet taken as aligned.
    """
    misalignments = []
    for number, pair in enumerate(pairs):
        points = () if point is None or not point.pairs else point.over_turn or (point,)
        every = [one.pairs[number].misalignment for one in points]
        found = every[0] if every else None
        if pair.misalignment is not None and pair.label not in aligned_by_default:
            misalignments.append(TakenMisalignment(pair.misalignment, "case", found))
        elif pair.misalignment is None and not (is_sought and found is None):
            taken = float(np.mean(every)) if every else None
            over_turn = (min(every), max(every)) if len(every) > 1 else None
            misalignments.append(TakenMisalignment(taken, "operating point", found, over_turn))
        else:
            misalignments.append(TakenMisalignment(0.0, "default", found))
    return tuple(misalignments)


@dataclass(frozen=True, eq=False)
class MeshPeriodCurves:
    """A gear pair at even phases of its mesh period, (n,), with every pair of teeth (n, m); NaN where one is absent.

    Attributes
    ----------
    phases : ndarray, shape (n,)
        Parts of the mesh period of the flanks that carry; back flanks pass through theirs in the opposite order.
    mesh : LoadedMesh
        Loaded mesh under the mean torque.
    stiffness : ndarray, shape (n,)
        Mesh stiffness of all pairs on the path of contact [N/m].
    unloaded : ndarray, shape (n,)
        Transmission error without load, along the line of action [m].
    position : ndarray, shape (n, m)
        Place on the path of contact in base pitches [1].
    share : ndarray, shape (n, m)
        Part of the load on each tooth pair.
    pressure : ndarray, shape (n, m)
        Largest Hertzian pressure over the face [Pa]; NaN where it is not known.
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
    solved : LoadedGearPair
    misalignment : TakenMisalignment
        Misalignment of the flanks.
    unloaded : ndarray, shape (n,)
        Transmission error without load at the phases of ``solved.static`` [m]: where the first teeth just touch.
    pressure : ndarray, shape (n, m) or (n, m, s), or None
        Hertzian pressure of every pair at every phase [Pa], see
        `gearwhine.coupling.gears.loaded.contact_pressure.mesh_pressure`. None without load, single pairs or known face
        widths.
    pitch_pressure : float or None
        Largest pressure at the pitch point [Pa]; None also where that is not on the path of contact.
    harris : HarrisMap or None
        Map from a tenth to twice the mean torque, with all teeth alike: without pitch deviations and damage. None
        unless asked for, and without a torque.
    optimum : ReliefOptimum or None
        Best relief for the mean torque, with all teeth alike; None unless asked for, and without a torque or
        single pairs.
    aim : ReliefAim
        Objective of the best relief.
    aim_given : bool
        Whether that is asked for, and not chosen by default.
    force_origin : str
        What the mean force follows from: ``torques`` alone, or in a loop of pairs ``operating point``, or
        ``equal meshes`` where there is none.
    """

    solved: LoadedGearPair
    misalignment: TakenMisalignment
    unloaded: FloatArray
    pressure: FloatArray | None
    pitch_pressure: float | None
    harris: HarrisMap | None = None
    optimum: ReliefOptimum | None = None
    aim: ReliefAim = field(default_factory=PeakToPeak)
    aim_given: bool = False
    force_origin: str = "torques"

    @property
    def label(self) -> str:
        """The pair's gears."""
        return f"{self.solved.pair.driver} → {self.solved.pair.driven}"

    @cached_property
    def stiffness(self) -> FloatArray:
        """Mesh stiffness of all pairs on the path of contact at the phases of ``solved.static`` [N/m], (n,)."""
        return mesh_stiffness(self.solved.carrying_flanks, self.solved.static.phases)

    @cached_property
    def stiffness_figures(self) -> MeshStiffnessFigures:
        """Mean, least and greatest mesh stiffness of all teeth."""
        return mesh_stiffness_figures(self.solved.carrying_flanks, self.solved.static, self.solved.hunting)

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
        if self.solved.static.force == 0.0 or not self.solved.has_single_pairs:
            return None
        mesh, present = self.along_one_pair
        order = np.argsort(mesh.positions[present], kind="stable")
        return mesh.positions[present][order], mesh.load_shares[present][order]

    @cached_property
    def along_one_pair(self) -> tuple[LoadedMesh, npt.NDArray[np.bool_]]:
        """The mesh as a pair of teeth runs along its path, and where that is, see `transmission_error`."""
        return along_one_pair(self.solved.carrying_flanks, self.solved.static)

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
        """Peak amplitudes of the transmission error at the mesh frequency and its multiples [m], shape (8,).

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
        """Peak to peak at the mean torque with all teeth alike [m]; None without a Harris map or a best relief."""
        if self.harris is None:
            return None if self.optimum is None else _mesh_as_given(self.solved)[0].peak_to_peak_transmission_error
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


def first_touch(contact: ToothContact, phases: FloatArray) -> FloatArray:
    """Transmission error without load at `phases` (n,): the least gap of the pairs there [m]."""
    return np.asarray(contact.pairs(phases).deviation.min(axis=1), dtype=np.float64)


def analyse_pair(pair: LoadedGearPair, misalignment: TakenMisalignment) -> PairAnalysis:
    """Analyse a solved gear pair under its mean torque and without load.

    A misalignment of the operating point is the mean over a turn of planet carriers, where the gap changes over it.
    """
    slopes = pair.pair.gap_slopes(pair.geometry)
    if slopes.size and misalignment.origin == "operating point":
        over_turn = float(slopes.min()), float(slopes.max())
        misalignment = replace(misalignment, taken=float(slopes.mean()), over_turn=over_turn)
    unloaded = first_touch(pair.carrying_flanks, pair.static.phases)
    if pair.static.force == 0.0 or not pair.has_single_pairs or not pair.geometry.has_face:
        return PairAnalysis(pair, misalignment, unloaded, None, None)
    pressure = mesh_pressure(pair.geometry, pair.carrying_flanks, pair.static)
    return PairAnalysis(pair, misalignment, unloaded, pressure, _pitch_pressure(pair))


def force_origins(train: GearTrain, point: OperatingPoint | None) -> tuple[str, ...]:
    """Return what the mean force of each pair follows from; ``point`` is their operating point, if they have one.

    See :attr:`PairAnalysis.force_origin`.
    """
    shared = EQUAL_MESHES if point is None else "operating point"
    return tuple(shared if origin == EQUAL_MESHES else origin for origin in train.force_origins)


def analyse_machine(
    machine: Machine,
    point: OperatingPoint | None = None,
    progress: Progress = silent,
    *,
    pairs: Sequence[LoadedGearPair] | None = None,
) -> tuple[PairAnalysis, ...]:
    """Analyse every gear pair of a machine; ``point`` is its operating point, where it has one.

    ``pairs`` are those of the machine about that point, where they are loaded already.
    """
    pairs = machine.with_flanks_of(point).loaded_pairs(progress) if pairs is None else pairs
    rows = zip(pairs, taken_misalignments(machine.gear_pairs, point), force_origins(machine.train, point), strict=True)
    return tuple(replace(analyse_pair(pair, misalignment), force_origin=origin) for pair, misalignment, origin in rows)


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
_LEAST, _MOST, _TORQUES = 0.1, 2.0, 20  # range of a Harris map as parts of the mean torque, and number of torques


def solve_over_torques(
    pairs: Sequence[PairAnalysis],
    progress: Progress = silent,
    aims: Sequence[ReliefAim] = (),
    *,
    harris_map: bool = True,
    relief: bool = True,
) -> tuple[PairAnalysis, ...]:
    """Add Harris maps and optimal reliefs to analysed pairs, where they carry a torque.

    ``aims`` are those of the reliefs, one for each pair; all peak to peak where not given. Either may be left out.
    """
    analysed = []
    for pair, aim in zip(pairs, aims or [PeakToPeak()] * len(pairs), strict=True):
        if pair.solved.static.force > 0.0 and harris_map:
            progress(f"Harris map of {pair.label}")
            pair = replace(pair, harris=_harris_map(pair.solved))
        if pair.solved.static.force > 0.0 and pair.solved.has_single_pairs and relief:
            work = f"best tip relief of {pair.label}"
            progress(work)
            pair = replace(pair, optimum=_best_relief(pair.solved, aim, partial(progress, work)), aim=aim)
        analysed.append(pair)
    return tuple(analysed)


def _harris_map(pair: LoadedGearPair) -> HarrisMap:
    contact = pair.carrying_flanks
    if contact.hunting_period > 1:
        contact = tooth_contact(
            _alike(pair.geometry), pair.model, corner_contact=contact.has_corner_contact, faces=contact.faces
        )
    return harris_map(contact, pair.static.force * np.linspace(_LEAST, _MOST, _TORQUES))


def _best_relief(pair: LoadedGearPair, aim: ReliefAim, tried: Callable[[float], None]) -> ReliefOptimum:
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
        # Fewer slices are faster to search with, and as good for finding a place.
        searched_faces=None if faces is None else faces.in_slices(min(_SEARCHED_SLICES, faces.z.size)),
        aim=aim,
        tried=tried,
    )


def _alike(pair: GearPairGeometry) -> GearPairGeometry:
    """Return the pair with all teeth of a gear alike: a relief is cut for all of them."""
    driver, driven = (replace(gear, pitch_deviations=(), faults=()) for gear in (pair.driver, pair.driven))
    return replace(pair, driver=driver, driven=driven)


def default_aims(
    machine: Machine, point: OperatingPoint | None, pairs: Sequence[LoadedGearPair], progress: Progress = silent
) -> tuple[ReliefAim, ...]:
    """Objective of the best relief of each pair of a machine, where none is asked for.

    It is the sensor at which the given flanks are loudest, see :func:`level_at_sensors`; in a machine without sensors
    or at rest, and where every multiple of the mesh frequency lies beyond the model's limit, the peak-to-peak
    transmission error.
    """
    housing = machine.housing_component
    if housing is None or not housing.sensors or not housing.complete_below or machine.speed == 0.0:
        return tuple(PeakToPeak() for _ in pairs)
    limit_hz = housing.complete_below / _TWO_PI
    model = sensor_model(machine, point, pairs, progress)
    aims: list[ReliefAim] = []
    for number, pair in enumerate(pairs):
        weights = weights_below(limit_hz, pair)
        aims.append(level_at_sensors(model, number, pair, tuple(housing.sensors), weights) if weights else PeakToPeak())
    return tuple(aims)


def sensor_model(
    machine: Machine, point: OperatingPoint | None, pairs: Sequence[LoadedGearPair], progress: Progress = silent
) -> MeshHarmonicModel:
    """Return the machine that is linear about its operating point, whose sensors answer to the mesh harmonics."""
    if point is None and machine.needs_operating_point:
        point = machine.operating_point()
    linear = machine.linearised(point)
    return MeshHarmonicModel(linear.assemble(pairs, linear.rotor_components(progress=progress)))


def weights_below(
    limit_hz: float, pair: LoadedGearPair, weights: Mapping[int, float] | None = None
) -> dict[int, float]:
    """Return the weights of the multiples of a pair's mesh frequency that lie below a limit [Hz].

    None have a pair without load, and one that does not turn.
    """
    if pair.static.force == 0.0 or not pair.mesh_frequency:
        return {}
    every = weights or dict.fromkeys(range(1, _AIMED_AT + 1), 1.0)
    return {n: weight for n, weight in every.items() if weight and n * pair.mesh_frequency <= limit_hz}


def level_at_sensors(
    model: MeshHarmonicModel, number: int, pair: LoadedGearPair, sensors: Sequence[str], weights: Mapping[int, float]
) -> SensorLevel:
    """Return the level at the sensor that the given flanks of a pair make loudest.

    It is the root mean square of the acceleration over the multiples n of the mesh frequency, √(½ Σ (w_n a_n)²), with
    a_n the linear response to transmission error and load shuttling together about the mean load, see
    :class:`gearwhine.coupling.linear.sensor_level.SensorLevel`.
    """
    follows = pair.pair.damping is None
    levels = [SensorLevel(model, number, sensor, weights, damping_follows=follows) for sensor in sensors]
    if len(levels) == 1:
        return levels[0]
    mesh, flanks = _mesh_as_given(pair)
    return max(levels, key=lambda level: level.of(mesh, flanks))


def _mesh_as_given(pair: LoadedGearPair) -> tuple[LoadedMesh, ToothContact]:
    """Return the loaded mesh of the flanks that carry, all teeth alike, and their contact law."""
    flanks = pair.carrying_flanks.teeth_alike
    return loaded_transmission_error(flanks, pair.static.force, mesh_period_phases(flanks)), flanks


def geometry_warnings(pair: GearPair, geometry: GearPairGeometry) -> list[dict[str, str]]:
    """Return warnings of gears that run but are doubtful."""
    warnings = []
    for gear in (geometry.driver, geometry.driven):
        try:
            require_tip_thickness(gear)
        except ThinTipError as error:
            warnings.append({"name": "thin tip", "message": str(error)})
        if gear.is_undercut:
            message = (
                f"gear {gear.name!r}: the teeth are undercut, their flanks begin at a diameter of "
                f"{2e3 * gear.form_radius:.6g} mm; a profile_shift of "
                f"{gear.least_generating_shift + gear.profile_shift - gear.generating_shift:.4g} avoids it"
            )
            warnings.append({"name": "undercut", "message": message})
    doubts = {
        "ring support": ring_support_warning(pair.stiffness, geometry),
        "backlash": pair.backlash_warning(geometry),
    }
    return [*warnings, *({"name": name, "message": text} for name, text in doubts.items() if text is not None)]
