"""Operating point of a machine: static equilibrium under its mean load, lives of its bearings, and its plausibility.

The equilibrium is that of :meth:`gearwhine.coupling.Machine.operating_point`. This module adds the lives of its
bearings, and warnings: bearings beyond their ratings or tilts, faces that carry unevenly, and numbers of the case that
differ from those of the equilibrium.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.coupling import Machine
from gearwhine.coupling.analyses.gear_pairs import TakenMisalignment, taken_misalignments
from gearwhine.coupling.analyses.loaded_machine import NO_OPERATING_POINT
from gearwhine.coupling.analyses.operation_warnings import bearing_load_warnings, operation_warnings
from gearwhine.coupling.gears.geometry.pair import pair_label
from gearwhine.coupling.gears.loaded.gear_pair import load_gear_pair
from gearwhine.coupling.gears.loaded.transmission_error import LoadedMesh
from gearwhine.coupling.load_analysis.influences import LoadSensitivity
from gearwhine.coupling.statics.operating_point import BearingLoad, OperatingPoint, PairLoad, ShaftDeflection
from gearwhine.from_case.machine import misalignments_of_case, require_machine
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.rotors.rolling_bearings import BallRow, RollerRow, Row
from gearwhine.rotors.rolling_bearings.rated_life import BearingLife
from gearwhine.rotors.rolling_bearings.speed_factor import centrifugal_warnings

FloatArray = npt.NDArray[np.float64]

TORQUES = tuple(np.linspace(0.1, 1.5, 15).round(6).tolist())
"""Parts of the torque of operation at which the equilibrium is found over torque."""

_PLACES = 201  # places along a shaft at which its deflection is given
_ZERO_DEFLECTION = 1e-15  # deflection up to which it counts as zero [m]
_UNWARNED_DIFFERENCE = 0.1  # difference of two numbers up to which no warning is given, as a part of the larger one
# Difference of misalignments over the face up to which no warning is given, of the teeth's deflection.
_UNWARNED_MISALIGNMENT = 0.1
_UNEVEN_FACE_LOAD_FACTOR = 2.0  # K_Hβ above which a face carries unevenly
_SHORT_LIFE = 1000.0  # life below which a warning is given [h]
_WRONG_SIDE = 1e-3  # part of a bearing's force that balls in angular contact may carry against their angle
_ARC_MINUTE = math.radians(1.0 / 60.0)
# Largest angles between shaft and seat (SKF, Rolling Bearings, 2018: deep groove ball bearings 2' to 10', cylindrical
# roller bearings 3' or 4' by their series), and the pressures of the static rating (ISO 76) [Pa].
_BALL_TILT, _ROLLER_TILT = 10.0 * _ARC_MINUTE, 4.0 * _ARC_MINUTE
_BALL_PRESSURE, _SELF_ALIGNING_PRESSURE, _ROLLER_PRESSURE = 4.2e9, 4.6e9, 4.0e9


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
        """Loads of all elements on the outer ring, row after row [N]; None for bearings that are no rolling ones."""
        state = self.load.rolling
        return None if state is None else np.concatenate([row.outer_load for row in state.rows])


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
    """

    load: PairLoad
    misalignment: TakenMisalignment
    hunting: LoadedMesh | None = None


@dataclass(frozen=True, eq=False)
class SolvedLoad:
    """The operating point of a case.

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
    """

    machine: Machine
    point: OperatingPoint
    bearings: tuple[LoadedBearing, ...]
    pairs: tuple[LoadedPair, ...]
    over_torque: dict[float, OperatingPoint]
    sensitivity: LoadSensitivity | None = None

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
        The same places along z of the machine [m].
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

    Raises
    ------
    gearwhine.coupling.CouplingError
        Where a load drives a motion that nothing holds.
    gearwhine.coupling.EquilibriumNotFoundError
        Where no equilibrium is found.
    """
    progress("static equilibrium of the machine")
    point = machine.operating_point()
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
    bearings = tuple(
        LoadedBearing(
            bearing,
            None if bearing.rolling is None else BearingLife(bearing.rolling, machine.speeds[bearing.mounted.rotor]),
            preloads.get(bearing.name),
        )
        for bearing in point.bearings
    )
    pairs = tuple(map(LoadedPair, point.pairs, taken_misalignments(machine, point)))
    if over_hunting_period:
        pairs = tuple(
            replace(pair, hunting=_over_hunting_period(machine, number, pair.load)) for number, pair in enumerate(pairs)
        )
    return SolvedLoad(machine, point, bearings, pairs, points)


def _over_hunting_period(machine: Machine, number: int, load: PairLoad) -> LoadedMesh | None:
    """Return the static mesh of a pair over its hunting period, at the force and the gap of the operating point."""
    geometry = machine.pair_geometries[number]
    gears = (geometry.driver, geometry.driven)
    if load.force == 0.0 or not any(gear.pitch_deviations or gear.faults for gear in gears):
        return None
    # Inertias are for the damping alone.
    pair = replace(machine.gear_pairs[number], misalignment=0.0, face_gap=load.face_gap, damping=0.0)
    torque = math.copysign(load.force * geometry.driver.base_radius, machine.pair_torques[number])
    speed = machine.speeds[load.pair.driver.shaft]
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


def load_warnings(solved: SolvedLoad) -> list[dict[str, Any]]:
    """Warnings of an operating point that is formally right and physically doubtful."""
    machine = solved.machine
    of_loads = bearing_load_warnings(
        machine.bearings, {bearing.name: bearing.force[:3] for bearing in solved.point.bearings}, "the equilibrium"
    )
    loads = {entry["bearing"] for entry in of_loads}
    return [
        *operation_warnings(machine),
        *of_loads,
        *(entry for bearing in solved.bearings for entry in _bearing_warnings(bearing)),
        *_speed_warnings(solved),
        *_stiffness_warnings(solved, loads),
        *(entry for pair in solved.point.pairs for entry in _face_warnings(pair)),
        *_misalignment_warnings(solved),
        *_free_motion_warnings(solved),
    ]


def _bearing_warnings(bearing: LoadedBearing) -> Iterator[dict[str, Any]]:
    """Warn of a rolling bearing beyond its static rating, its tilt, or with a short life."""
    state, name = bearing.load.rolling, bearing.load.name
    if state is None:
        return
    first_row = state.bearing.rows[0]
    if isinstance(first_row, BallRow):
        most = _SELF_ALIGNING_PRESSURE if first_row.self_aligning else _BALL_PRESSURE
    else:
        most = _ROLLER_PRESSURE
    if state.peak_pressure > most:
        yield warning(
            "static rating",
            f'bearing "{name}": its elements are pressed with {1e-9 * state.peak_pressure:.3g} GPa, beyond the '
            f"{1e-9 * most:.2g} GPa of a static rating (ISO 76)",
            bearing=name,
            peak_pressure_pa=state.peak_pressure,
        )
    for row, thrust in zip(state.bearing.rows, state.row_thrusts, strict=True):
        angular = type(row) is BallRow and row.contact_angle > 0.0 and not row.self_aligning
        if angular and -thrust > _WRONG_SIDE * float(np.linalg.norm(bearing.load.force[:3])):
            way = "-z" if row.direction > 0 else "+z"
            yield warning(
                "thrust side",
                f'bearing "{name}": its balls carry {-thrust:.4g} N towards {way}, against their contact angle, on a '
                "shoulder that a bearing of this type does not have; turn it round (`carries`) or let another bearing "
                "take that thrust",
                bearing=name,
                thrust_n=-thrust,
            )
    limit, kind = _tilt_limit(first_row)
    if len(state.bearing.rows) == 1 and bearing.load.tilt > limit:
        yield warning(
            "bearing tilt",
            f'bearing "{name}": shaft and seat are {bearing.load.tilt / _ARC_MINUTE:.3g}\' out of line; {kind} '
            f"bearings usually take {limit / _ARC_MINUTE:.0f}' at most",
            bearing=name,
            tilt_rad=bearing.load.tilt,
        )
    rated = bearing.rated
    if rated is not None and rated.life is not None and rated.life < _SHORT_LIFE:
        source = "the case gives" if rated.rating_from == "case" else "its geometry has"
        yield warning(
            "bearing life",
            f'bearing "{name}": a rated life L10 of {rated.life:.3g} h, below {_SHORT_LIFE:.0f} h, by the dynamic '
            f"rating of {rated.rating:.4g} N that {source}",
            bearing=name,
            life_h=rated.life,
        )


def _tilt_limit(row: Row) -> tuple[float, str]:
    """Largest usual angle of shaft and seat [rad], and the kind of bearing; infinite where none is known."""
    if isinstance(row, RollerRow):
        return _ROLLER_TILT, "cylindrical roller"
    if type(row) is BallRow and row.contact_angle == 0.0 and not row.self_aligning:
        return _BALL_TILT, "deep groove ball"
    return math.inf, ""


def _speed_warnings(solved: SolvedLoad) -> list[dict[str, Any]]:
    """Warn of bearings so fast that the centrifugal force of their elements matters."""
    rolling = [
        (bearing.load.mounted, bearing.load.rolling) for bearing in solved.bearings if bearing.load.rolling is not None
    ]
    return centrifugal_warnings(
        [(mounted.bearing.name, state.bearing, solved.machine.speeds[mounted.rotor]) for mounted, state in rolling],
        {mounted.bearing.name: max(float(row.outer_load.max()) for row in state.rows) for mounted, state in rolling},
    )


def _stiffness_warnings(solved: SolvedLoad, warned: set[str]) -> Iterator[dict[str, Any]]:
    """Warn of bearings whose stiffness in the linear analyses differs from the tangent at the equilibrium.

    Bearings in ``warned`` have a warning that they are made for another load, and are left out.
    """
    for bearing in solved.bearings:
        mounted, name = bearing.load.mounted, bearing.load.name
        if mounted.design_load is None or name in warned or mounted.needs_load:
            continue
        assumed = np.diag(mounted.bearing.at_speed(solved.machine.speeds[mounted.rotor]).spatial_stiffness)[:3]
        tangent = np.diag(bearing.load.stiffness)[:3]
        apart = np.abs(assumed - tangent) > _UNWARNED_DIFFERENCE * np.maximum(assumed, tangent)
        # A direction in which the bearing is soft beside the others holds nothing there.
        apart &= np.maximum(assumed, tangent) > _UNWARNED_DIFFERENCE * max(assumed.max(), tangent.max())
        if apart.any():
            texts = [", ".join(f"{1e-6 * value:.4g}" for value in values.tolist()) for values in (assumed, tangent)]
            yield warning(
                "bearing stiffness",
                f'bearing "{name}": linear analyses take {texts[0]} N/µm along x, y, z, the equilibrium finds '
                f"{texts[1]} N/µm",
                bearing=name,
                taken_n_per_m=assumed.tolist(),
                found_n_per_m=tangent.tolist(),
            )


def _face_warnings(load: PairLoad) -> Iterator[dict[str, Any]]:
    label = load.pair.label
    if load.force == 0.0:
        return
    if load.k_h_beta > _UNEVEN_FACE_LOAD_FACTOR:
        yield warning(
            "uneven face",
            f"{label}: the face carries unevenly, K_Hβ = {load.k_h_beta:.3g}; its flanks are "
            f"{1e6 * load.misalignment * load.pair.geometry.face_width:.3g} µm out of line over the face: a helix "
            "modification or stiffer shafts and seats even it out",
            driver=load.pair.driver.name,
            driven=load.pair.driven.name,
            k_h_beta=load.k_h_beta,
        )
    if load.carrying_part < 1.0:
        yield warning(
            "part of the face",
            f"{label}: {100.0 * (1.0 - load.carrying_part):.3g} % of the face never touches under the mean load",
            driver=load.pair.driver.name,
            driven=load.pair.driven.name,
            carrying_part=load.carrying_part,
        )


def _misalignment_warnings(solved: SolvedLoad) -> Iterator[dict[str, Any]]:
    """Warn where the misalignment that the motion takes is not the one that the deflections make.

    Flanks of an idle pair have no deflection to hold the difference against.
    """
    for pair in solved.pairs:
        load, taken, at_equilibrium = pair.load, pair.misalignment.taken, pair.load.misalignment
        if pair.misalignment.origin == "operating point" or taken is None or load.force == 0.0:
            continue
        apart = abs(taken - at_equilibrium) * load.pair.geometry.face_width
        if apart <= _UNWARNED_MISALIGNMENT * load.tooth_deflection:
            continue
        driver, driven = load.names
        said = f"the case gives a misalignment of {1e6 * taken:.4g} µrad, which the motion takes"
        if pair.misalignment.origin == "default":
            said = "the motion takes the flanks as aligned, as no face_width is given"
        yield warning(
            "misalignment",
            f"{load.pair.label}: {said}; the equilibrium finds {1e6 * at_equilibrium:.4g} µrad, {1e6 * apart:.3g} µm "
            f"apart over the face, where the teeth deflect by {1e6 * load.tooth_deflection:.3g} µm",
            driver=driver,
            driven=driven,
            given_rad=taken,
            found_rad=at_equilibrium,
        )


def _free_motion_warnings(solved: SolvedLoad) -> Iterator[dict[str, Any]]:
    """Warn of motions that nothing holds; shafts without thrust may float along and rotate about their axis."""
    for motion in solved.point.free:
        if not motion.startswith(("the rotation", "the axial motion")):
            yield warning(
                "free motion", f"nothing holds {motion}; no load drives it, and it stays at zero", motion=motion
            )


def load_of_case(
    case: Case,
    machine: Machine,
    progress: Progress = silent,
    *,
    over_torque: bool = False,
    over_hunting_period: bool = False,
) -> SolvedLoad:
    """Find the static equilibrium of a case's machine, with what the case gives and leaves open of misalignments.

    The parameters are those of :func:`solve_load`.
    """
    solved = solve_load(machine, progress, over_torque=over_torque, over_hunting_period=over_hunting_period)
    taken = misalignments_of_case(case.parts, solved.point)
    pairs = [replace(pair, misalignment=one) for pair, one in zip(solved.pairs, taken, strict=False)]
    return replace(solved, pairs=tuple(pairs))


def find_load(
    case: Case, machine: Machine, progress: Progress = silent
) -> tuple[SolvedLoad | None, list[dict[str, Any]]]:
    """Find the operating point of a case beside another analysis, and its warnings.

    The point is None where nothing loads the machine. Where no equilibrium is found and the case does not need one, a
    warning gives the reason, and the analysis goes on.

    Parameters
    ----------
    case, machine, progress
        As :func:`load_of_case`.

    Raises
    ------
    gearwhine.coupling.CouplingError, gearwhine.coupling.EquilibriumNotFoundError, gearwhine.rotors.EquilibriumError
        Where bearings or flanks are left to an operating point that is not found.
    """
    if not case.is_loaded:
        return None, []
    try:
        solved = load_of_case(case, machine, progress)
    except NO_OPERATING_POINT as error:
        if case.parts.needs_operating_point:
            raise
        message = f"no operating point is found, against which to hold the loads that the case gives: {error}"
        aligned = [
            pair_label(pair.driver, pair.driven) for pair in case.gear_pair if case.parts.finds_misalignment(pair)
        ]
        if aligned:
            message += f"; the misalignment of {', '.join(aligned)} is taken as 0"
        return None, [warning("operating point", message)]
    return solved, load_warnings(solved)


def require_load(case: Case) -> None:
    """Refuse a case whose machine nothing loads, before anything is solved.

    Raises
    ------
    CaseError, gearwhine.coupling.CouplingError
        As :func:`load_of_case`.
    """
    require(case, "rotor", "bearing", "operation", command="load")
    if not case.is_loaded:
        expected = "a torque, a force or gravity, which load the shafts, or a preload of rolling bearings"
        raise CaseError([Problem("operation.torque", 0.0, expected)])
    require_machine(case)


def sensitivity_warnings(ranked: LoadSensitivity) -> Iterator[dict[str, Any]]:
    """Warnings of a ranking: what it leaves out, and mesh harmonics whose sound the pressure inside does not prove."""
    if ranked.note is not None:
        yield warning("sensitivity", ranked.note)
    if not ranked.loudest_lines:
        return
    # The acoustics' kernels are for these cases alone.
    from gearwhine.coupling.sound.proofs import doubts

    for harmonic in ranked.loudest_lines:
        yield from doubts(harmonic.sound, "a mesh harmonic")
