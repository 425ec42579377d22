"""Plausibility of a machine's operating point: warnings of doubtful loads beside those that the inputs give.

Warned of are bearings beyond their ratings or tilts, faces that carry unevenly, and given numbers that differ from
those of the equilibrium; and a point that is not found beside another analysis.
"""

import math
from collections.abc import Collection, Iterator, Sequence

import numpy as np

from gearwhine.coupling.analyses.loaded_machine import NO_OPERATING_POINT
from gearwhine.coupling.analyses.operation_warnings import bearing_load_warnings, operation_warnings
from gearwhine.coupling.load_analysis.influences import LoadSensitivity
from gearwhine.coupling.load_analysis.solved_load import LoadedBearing, SolvedLoad, solve_load
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.statics.operating_point import OperatingPoint, PairLoad
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.rotors.rolling_bearings import BallRow, RollerRow, Row
from gearwhine.rotors.rolling_bearings.speed_factor import centrifugal_warnings

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


def find_load(
    machine: Machine,
    progress: Progress = silent,
    *,
    is_needed: bool | None = None,
    aligned_by_default: Collection[str] = (),
) -> tuple[SolvedLoad | None, list[ResultWarning]]:
    """Find the operating point of a loaded machine beside another analysis, and its warnings.

    Where no equilibrium is found and the machine does not need one, the point is None, and a warning gives the reason.
    Parameters and errors are those of :func:`load_or_reason`.
    """
    solved, message = load_or_reason(machine, progress, is_needed=is_needed, aligned_by_default=aligned_by_default)
    return solved, [warning("operating point", message)] if solved is None else load_warnings(solved)


def load_or_reason(
    machine: Machine,
    progress: Progress = silent,
    *,
    is_needed: bool | None = None,
    aligned_by_default: Collection[str] = (),
) -> tuple[SolvedLoad | None, str]:
    """Find the operating point of a loaded machine beside another analysis, or why there is none.

    Where no equilibrium is found and the machine does not need one, the point is None, and the analysis goes on.

    Parameters
    ----------
    machine : Machine
    progress : callable
    is_needed : bool, optional
        Whether parts are left to the operating point explicitly; by default where a bearing has its stiffness from its
        load.
    aligned_by_default : collection of str
        As :func:`solve_load`.

    Raises
    ------
    gearwhine.coupling.CouplingError, gearwhine.coupling.EquilibriumNotFoundError, gearwhine.rotors.EquilibriumError
        Where bearings or flanks are left to an operating point that is not found.
    """
    try:
        return solve_load(machine, progress, aligned_by_default=aligned_by_default), ""
    except NO_OPERATING_POINT as error:
        if any(one.needs_load for one in machine.bearings) if is_needed is None else is_needed:
            raise
        message = f"no operating point is found, against which to hold the loads that the case gives: {error}"
        aligned = [pair.label for pair in machine.gear_pairs if pair.misalignment is None]
        if aligned:
            message += f"; the misalignment of {', '.join(aligned)} is taken as 0"
        return None, message


def load_warnings(solved: SolvedLoad) -> list[ResultWarning]:
    """Warnings of an operating point that is formally right and physically doubtful."""
    machine, points = solved.machine, solved.point.over_turn or (solved.point,)
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
        *(
            entry
            for number, carries in zip(range(len(solved.pairs)), solved.machine.carrying_pairs, strict=False)
            for entry in (_face_warnings(number, points) if carries else ())
        ),
        *_misalignment_warnings(solved),
        *_free_motion_warnings(solved),
    ]


def _bearing_warnings(bearing: LoadedBearing) -> Iterator[ResultWarning]:
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


def _speed_warnings(solved: SolvedLoad) -> list[ResultWarning]:
    """Warn of bearings so fast that the centrifugal force of their elements matters."""
    rolling = [
        (bearing.load.mounted, bearing.load.rolling) for bearing in solved.bearings if bearing.load.rolling is not None
    ]
    return centrifugal_warnings(
        [(mounted.bearing.name, state.bearing, solved.machine.bearing_speed(mounted)) for mounted, state in rolling],
        {mounted.bearing.name: max(float(row.outer_load.max()) for row in state.rows) for mounted, state in rolling},
    )


def _stiffness_warnings(solved: SolvedLoad, warned: set[str]) -> Iterator[ResultWarning]:
    """Warn of bearings whose stiffness in the linear analyses differs from the tangent at the equilibrium.

    Bearings in ``warned`` have a warning that they are made for another load, and are left out.
    """
    for bearing in solved.bearings:
        mounted, name = bearing.load.mounted, bearing.load.name
        if mounted.design_load is None or name in warned or mounted.needs_load:
            continue
        assumed = np.diag(mounted.bearing.at_speed(solved.machine.bearing_speed(mounted)).spatial_stiffness)[:3]
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


def _face_warnings(number: int, points: Sequence[OperatingPoint]) -> Iterator[ResultWarning]:
    """Warn of the flanks of a pair that part or carry unevenly, at points over a turn of the carriers or at one."""
    loads = [point.pairs[number] for point in points]
    label, carriers = loads[0].pair.label, list(points[-1].turned_by)
    gears = {"driver": loads[0].pair.driver.name, "driven": loads[0].pair.driven.name}
    parted = [point for point, load in zip(points, loads, strict=True) if load.force == 0.0]
    if parted:
        message = (
            f"{label}: the mean load holds the flanks apart, and the pairs that share the torque carry its part; "
            "linear analyses have no stiffness there"
            if len(parted) == len(points)
            else f"{label}: the load holds the flanks apart with {_angles(parted, carriers)}, "
            "and the pairs that share the torque carry its part; linear analyses have the mean stiffness of the turn "
            "at all angles, and their lines may be as far off as the highest of them is high; motion has the parting, "
            "but not the swing of these flanks"
        )
        yield warning("lost contact", message, **gears, angles_rad=[dict(point.turned_by) for point in parted])
    if len(parted) == len(points):
        return
    point, load = max(zip(points, loads, strict=True), key=lambda one: _greatest_load(one[1]))
    if load.k_h_beta > _UNEVEN_FACE_LOAD_FACTOR:
        where = f" with {_angles([point], carriers)}, where its line load is greatest," if len(points) > 1 else ""
        yield warning(
            "uneven face",
            f"{label}:{where} the face carries unevenly, K_Hβ = {load.k_h_beta:.3g}; its flanks are "
            f"{1e6 * load.misalignment * load.pair.geometry.face_width:.3g} µm out of line over the face: a helix "
            "modification or stiffer shafts and seats even it out",
            **gears,
            k_h_beta=load.k_h_beta,
        )
    touching = np.max([one.fine.line_load.max(axis=0) for one in loads if one.force > 0.0], axis=0) > 0.0
    if not np.all(touching):
        yield warning(
            "part of the face",
            f"{label}: {100.0 * (1.0 - touching.mean()):.3g} % of the face never touches under the mean load",
            **gears,
            carrying_part=float(touching.mean()),
        )


def _greatest_load(load: PairLoad) -> float:
    """Force by which pairs of one face compare in their greatest mean line load [N]."""
    return load.k_h_beta * load.force if load.force > 0.0 else 0.0


def _angles(points: Sequence[OperatingPoint], carriers: Collection[str]) -> str:
    """Return the angles that the carriers have turned by at some points in words."""
    rows = [[f"{math.degrees(point.turned_by.get(name, 0.0)) % 360.0:.0f}°" for name in carriers] for point in points]
    return f"{' and '.join(carriers)} turned by {', '.join(' and '.join(row) for row in rows)}"


def _misalignment_warnings(solved: SolvedLoad) -> Iterator[ResultWarning]:
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
        yield warning(
            "misalignment",
            f"{load.pair.label}: {said}; the equilibrium finds {1e6 * at_equilibrium:.4g} µrad, {1e6 * apart:.3g} µm "
            f"apart over the face, where the teeth deflect by {1e6 * load.tooth_deflection:.3g} µm",
            driver=driver,
            driven=driven,
            given_rad=taken,
            found_rad=at_equilibrium,
        )


def _free_motion_warnings(solved: SolvedLoad) -> Iterator[ResultWarning]:
    """Warn of motions that nothing holds; shafts without thrust may float along and rotate about their axis."""
    for motion in solved.point.free:
        if not motion.startswith(("the rotation", "the axial motion")):
            yield warning(
                "free motion", f"nothing holds {motion}; no load drives it, and it stays at zero", motion=motion
            )


def sensitivity_warnings(ranked: LoadSensitivity) -> Iterator[ResultWarning]:
    """Warnings of a ranking: what it leaves out, and mesh harmonics whose sound is not proved."""
    if ranked.note is not None:
        yield warning("sensitivity", ranked.note)
    if not ranked.loudest_lines:
        return
    # The acoustics' kernels are for these cases alone.
    from gearwhine.coupling.sound.proofs import doubts

    for harmonic in ranked.loudest_lines:
        yield from doubts(harmonic.sound, "a mesh harmonic")
