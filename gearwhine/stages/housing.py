"""The housing of a case: geometry to mesh, mesh to certified modes, modes to strengths and comparison."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import sparse

import housing as room
from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.case import Sensor as GivenSensor
from gearwhine.progress import Progress, silent
from gearwhine.stages.attachments import attach_all, build_supports, check_reach
from gearwhine.stages.housing_checks import (
    bearing_places,
    bearing_port,
    housing_checks,
    selection_document,
    static_error_document,
)
from gearwhine.stages.kept_modes import MODES_FILE, find_modes, solution_inputs
from meshes import Bore, Boss, BoxGeometry, Feet, Mesh, WallThickness, mesh_box, read_mesh

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi
_COORDINATES = ("coordinate", "other_coordinate")
_DAMPING = "modal_damping"  # its name in a mode-set file
_UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}


@dataclass(frozen=True)
class SolvedHousing:
    """The housing with everything that later stages take from it.

    Attributes
    ----------
    mesh : Mesh
    rigid : housing.RigidBody
        Mass, centre of mass and inertia, with the masses attached.
    attached_mass : float
        Of these alone [kg].
    solid : housing.MassProperties
        Of the solid alone, from its geometry.
    modes : housing.ModeSet
    damping_ratios : ndarray, shape (n_modes,)
        As the case gives them; see :attr:`total_damping_ratios`.
    damping_matrix : ndarray, shape (n_modes, n_modes), or None
        What dashpots, mounts and joints add in modal coordinates [1/s]; None where nothing damps.
    seats : dict of str to ndarray, shape (n_modes, 6)
        Modes' motions at each bearing seat.
    seat_ports : dict of str to sparse array, shape (6, 3 n_nodes)
        The seats' motions from the nodes'.
    loaded : dict of str to sparse array, shape (2, 3 n_nodes)
        x and y of each place where the machine bears on the housing: the modes' attachments are for these.
    sensors : dict of str to housing.SensorPort
    survey : housing.Survey
    strengths : housing.Dominance or None
        None where there are no seats.
    checks : dict
        Health report and effective masses as their documents.
    seconds : dict of str to float
        Time taken by mesh, assembly, factorisation, eigensolver and in total; also by reading, where the modes were.
    record : housing.ModeRecord
        What a mode-set file holds of it.
    source : Path or None
        The file that the modes were read from; None where they were solved.
    source_holds : bool
        Whether that file also holds these sensors, so that it need not be written again.
    warnings : tuple of str
        What the user should know, a sentence each.
    """

    mesh: Mesh
    rigid: room.RigidBody
    attached_mass: float
    solid: room.MassProperties
    modes: room.ModeSet
    damping_ratios: FloatArray
    damping_matrix: FloatArray | None
    seats: dict[str, FloatArray]
    seat_ports: dict[str, sparse.csr_array]
    loaded: dict[str, sparse.csr_array]
    sensors: dict[str, room.SensorPort]
    survey: room.Survey
    strengths: room.Dominance | None
    checks: dict[str, Any]
    seconds: dict[str, float]
    record: room.ModeRecord
    source: Path | None = None
    source_holds: bool = False
    warnings: tuple[str, ...] = ()

    @property
    def total_damping_ratios(self) -> FloatArray:
        """Each mode's ratio with its own share of what is attached; the coupling of modes by it left aside."""
        if self.damping_matrix is None:
            return self.damping_ratios
        return room.damping_ratios(self.modes.frequencies, self.damping_ratios, self.damping_matrix)


def build_mesh(case: Case) -> Mesh:
    """The housing's finite-element mesh.

    Raises
    ------
    CaseError
        Where the case has no housing, or one from a CAD file.
    meshes.GeometryError
        Where the shape cannot be meshed or the file not read.
    """
    require(case, "housing", command="mesh")
    assert case.housing is not None
    if case.housing.box is not None:
        return mesh_box(box_geometry(case), case.housing.box.mesh_size)
    if case.housing.mesh is not None:
        return read_mesh(case.housing.mesh.file, unit=UNITS[case.housing.mesh.unit])
    raise CaseError([Problem("housing.cad", str(case.housing.cad and case.housing.cad.file), _NO_CAD)])


_NO_CAD = "[housing.box] or [housing.mesh]: geometry from CAD comes in a later version"


def box_geometry(case: Case) -> BoxGeometry:
    """The box of a case as the mesher's geometry."""
    assert case.housing is not None
    box = case.housing.box
    assert box is not None
    walls = box.walls
    return BoxGeometry(
        size=box.size,
        wall=WallThickness(walls.left, walls.right, walls.bottom, walls.top, walls.back, walls.front),
        bores=tuple(
            Bore(
                seat.name, seat.center, seat.diameter, Boss(seat.boss.diameter, seat.boss.length) if seat.boss else None
            )
            for seat in case.housing.seat
        ),
        feet=Feet(box.feet.size) if box.feet else None,
    )


def solve_housing(
    case: Case,
    progress: Progress = silent,
    *,
    command: str = "modes",
    folder: Path | None = None,
    fresh: bool = False,
) -> SolvedHousing:
    """Mesh the housing and find its modes with their certificate; or read them where they are kept.

    Parameters
    ----------
    case : Case
    progress : callable
        Told in words what happens next.
    command : str
        On whose behalf, for messages.
    folder : path, optional
        A results folder; modes of the same housing kept there are read in place of solving.
    fresh : bool
        Solve also where they are.

    Raises
    ------
    CaseError, meshes.GeometryError, housing.HousingError
        Where the case cannot be solved as it stands.
    housing.IncompleteModesError, housing.ReductionError, housing.HealthError
        Where the modes fail their certificate, their static compliance its proof, or the model its checks.
    """
    require(case, "housing", command=command)
    given = case.housing
    assert given is not None
    begin = time.perf_counter()
    mesh = build_mesh(case) if given.mesh is not None else None
    inputs = solution_inputs(case, mesh)
    kept, warning = find_modes(folder, inputs) if folder is not None and not fresh else (None, None)
    if kept is not None and folder is not None:
        mesh = kept.mesh
        progress(f"modes read from {folder / MODES_FILE} (unchanged housing)")
    elif mesh is None:
        progress("meshing the housing")
        mesh = build_mesh(case)
    meshed = time.perf_counter() - begin
    # Ports before modes: what is wrong with them is found out before the long work.
    seats = tuple(room.Seat(seat.name, seat.center) for seat in given.seat)
    seat_ports = {seat.name: room.seat_matrix(mesh, seat) for seat in seats}
    loaded = {name: bearing_port(seat_ports[seat], arm) for name, (seat, arm) in bearing_places(case).items()}
    sensors = {entry.name: _sensor(mesh, index, entry) for index, entry in enumerate(given.sensor)}
    bounds = None if given.box is None else np.array([given.box.lower, given.box.upper])
    survey = room.survey_grid(mesh, bounds)
    if kept is None:
        modes, mass, damping_matrix, checks, seconds = _solve_modes(case, mesh, loaded, progress)
        seconds = {"mesh": meshed, **seconds}
    else:
        modes, mass, checks = kept.modes, kept.mass, kept.notes["checks"]
        damping_matrix = kept.extras[_DAMPING].values if _DAMPING in kept.extras else None
        seconds = {"mesh": 0.0, "assembly": 0.0, "factorisation": 0.0, "eigensolver": 0.0, "reading": meshed}
    seats_in_modes = {name: modes.project(matrix) for name, matrix in seat_ports.items()}
    strengths = None
    if seats:
        radial = np.stack([motion[:, :2] for motion in seats_in_modes.values()], axis=1)
        strengths = room.dominance(modes.frequencies, radial, survey.normal_motion(modes.shapes))
    seconds["total"] = time.perf_counter() - begin
    record = kept or room.ModeRecord(
        mesh,
        modes,
        mass,
        seats=seats,
        seat_motions=np.stack(list(seats_in_modes.values()), axis=1) if seats else np.empty((0, 0, 6)),
        inputs=inputs,
        notes={"seconds": seconds, "checks": checks},
        extras={} if damping_matrix is None else {_DAMPING: _damping_array(damping_matrix)},
    )
    record = room.with_sensors(record, sensors.values())
    return SolvedHousing(
        mesh=mesh,
        mass=mass,
        attached_mass=sum(entry.mass for entry in given.mass),
        modes=modes,
        damping_ratios=_damping(case, modes.frequencies_hz),
        damping_matrix=damping_matrix,
        seats=seats_in_modes,
        seat_ports=seat_ports,
        loaded=loaded,
        sensors=sensors,
        survey=survey,
        strengths=strengths,
        checks=checks,
        seconds=seconds,
        record=record,
        source=None if kept is None or folder is None else folder / MODES_FILE,
        source_holds=kept is not None and kept.sensors == record.sensors,
        warnings=() if warning is None else (warning,),
    )


def _damping_array(matrix: FloatArray) -> room.LabelledArray:
    return room.LabelledArray(_COORDINATES, matrix, "s-1", "damping of what is fastened, by modes and attachments")


def _solve_modes(
    case: Case, mesh: Mesh, loaded: dict[str, sparse.csr_array], progress: Progress
) -> tuple[room.ModeSet, float, FloatArray | None, dict[str, Any], dict[str, float]]:
    """The modes, the housing's mass [kg], what damps it in its modes, its checks, and the seconds of each step."""
    given = case.housing
    assert given is not None
    begin = time.perf_counter()
    progress(f"assembling {3 * len(mesh.points)} degrees of freedom")
    parted, material, materials = materials_of(case, mesh)
    free = room.assemble(parted, material, materials)
    matrices = attach_all(case, mesh, free)
    assembled = time.perf_counter() - begin
    # Without a limit or a number, what a first look wants.
    count = given.modes if given.modes is not None else (None if given.frequency_limit is not None else 20)
    modes = room.solve_modes(
        matrices,
        room.fixed_freedoms(mesh, build_supports(case)),
        frequency_limit=None if given.frequency_limit is None else _HERTZ * given.frequency_limit,
        count=count,
        ports=sparse.vstack(list(loaded.values()), format="csr") if loaded else None,
        progress=progress,
    )
    damping = room.modal_damping(modes, matrices) if matrices.damping.nnz else None
    progress("checking the housing against its geometry")
    begin = time.perf_counter()
    checks = housing_checks(case, mesh, free, matrices, modes)
    seconds = {"assembly": assembled, **modes.seconds, "checks": time.perf_counter() - begin}
    return modes, matrices.total_mass, damping, checks, seconds


def compare_housing(case: Case, solved: SolvedHousing) -> room.Comparison:
    """Pair the model's dominant modes with the measured ones.

    Raises
    ------
    CaseError
        Where nothing is measured or the housing has no seats to be driven at.
    housing.HousingError
        Where the model has too few modes in the band.
    """
    require(case, "measured", command="compare")
    assert case.measured is not None
    if solved.strengths is None:
        raise CaseError(
            [Problem("housing.seat", (), "bearing seats: dominance is the strength between seats and skin")]
        )
    comparison = room.compare_by_dominance(_HERTZ * np.array(case.measured.frequencies), solved.strengths)
    limit = solved.modes.certificate.limit
    if limit < comparison.band[1]:
        expected = (
            f"at least {comparison.band[1] / _HERTZ:.5g} Hz: dominant modes are looked for up to there, and the "
            "model's are known only below the limit"
        )
        raise CaseError([Problem("housing.frequency_limit", f"{limit / _HERTZ:.5g} Hz", expected)])
    return comparison


def strongest_modes(solved: SolvedHousing, count: int) -> list[int]:
    """Numbers of the strongest modes, from 1; the lowest ones where there are no seats to be driven at."""
    if solved.strengths is None:
        return list(range(1, min(count, len(solved.modes.frequencies)) + 1))
    return [int(mode) + 1 for mode in solved.strengths.strongest(count, (0.0, np.inf))]


def modes_document(solved: SolvedHousing, *, detail: bool = False) -> dict[str, Any]:
    """The modes as the command's JSON; in detail also which of them carry the motion from bearings to sensors."""
    certificate = solved.modes.certificate
    strengths = solved.strengths
    masses = solved.checks["effective_mass"]
    document = {
        "modes": [
            {
                "number": number,
                "frequency_hz": float(frequency),
                "damping_ratio": float(damping),
                "strength": None if strengths is None else float(strengths.acceleration[number - 1]),
                "effective_mass": masses["fractions"][number - 1],
            }
            for number, (frequency, damping) in enumerate(
                zip(solved.modes.frequencies_hz, solved.total_damping_ratios, strict=True), start=1
            )
        ],
        "certificate": {
            "limit_hz": certificate.limit / _HERTZ,
            "expected": certificate.expected,
            "found": certificate.found,
            "complete": certificate.complete,
            "max_residual": certificate.max_residual,
            "max_overlap": certificate.max_overlap,
        },
        "mesh": {
            "nodes": len(solved.mesh.points),
            "elements": solved.mesh.n_elements,
            "dofs": 3 * len(solved.mesh.points),
        },
        "mass_kg": solved.rigid.mass,
        "center_of_mass_m": solved.rigid.center.tolist(),
        "attached_mass_kg": solved.attached_mass,
        "effective_mass": {key: value for key, value in masses.items() if key != "fractions"},
        "static_error": static_error_document(solved.modes, solved.loaded),
        "health": solved.checks["health"],
        "seconds": solved.seconds,
        **origin_document(solved),
    }
    if detail:
        ratios = solved.total_damping_ratios
        document["selection"] = selection_document(solved.modes, ratios, solved.loaded, solved.sensors)
    return document


def origin_document(solved: SolvedHousing | None) -> dict[str, Any]:
    """Where a housing's modes come from, as every command's JSON says it; nothing without a housing."""
    if solved is None:
        return {}
    if solved.source is None:
        return {"reused": False, "warnings": list(solved.warnings)}
    return {
        "reused": True,
        "modes_read_from": str(solved.source),
        "seconds_when_solved": solved.record.notes["seconds"],
        "warnings": list(solved.warnings),
    }


def comparison_document(comparison: room.Comparison, solved: SolvedHousing) -> dict[str, Any]:
    """The comparison as the command's JSON."""
    # Counted below the next full kilohertz over the measured modes, as far as the model's modes are known.
    highest = float(np.ceil(comparison.pairs[-1].measured / _HERTZ / 1000.0) * 1000.0)
    highest = min(highest, solved.modes.certificate.limit / _HERTZ)
    return {
        "pairs": [
            {
                "measured_hz": pair.measured / _HERTZ,
                "model_hz": pair.model / _HERTZ,
                "error_percent": pair.error_percent,
                "mode": pair.mode,
                "mac": None,
                "strength": pair.strength,
            }
            for pair in comparison.pairs
        ],
        "rms_error_percent": comparison.rms_error_percent,
        "max_error_percent": comparison.max_error_percent,
        "pairing": comparison.pairing,
        "band_hz": [edge / _HERTZ for edge in comparison.band],
        "gap": comparison.gap,
        "measures_agree": comparison.measures_agree,
        "model_modes": {
            "below_hz": highest,
            "count": int(np.count_nonzero(solved.modes.frequencies_hz < highest)),
        },
    }


def _sensor(mesh: Mesh, index: int, entry: GivenSensor) -> room.SensorPort:
    """A sensor on the surface; one that is not meant to sit there is refused rather than moved far."""
    port = room.sensor_port(mesh, room.Sensor(entry.name, entry.position, entry.unit_vector))
    key, label = f"housing.sensor[{index}].position", f'sensor "{entry.name}"'
    if problems := list(check_reach(mesh, key, label, entry.position, port.position)):
        raise CaseError(problems)
    return port


def _damping(case: Case, frequencies_hz: FloatArray) -> FloatArray:
    """Damping ratio of each mode: one for all, one for each, or by a table of frequency."""
    assert case.housing is not None
    given = case.housing.damping_ratio
    if case.housing.damping_points:
        places, ratios = np.array(case.housing.damping_points).T
        return np.asarray(np.interp(frequencies_hz, places, ratios))
    if isinstance(given, tuple):
        if len(given) < len(frequencies_hz):
            expected = f"a ratio for each of the {len(frequencies_hz)} modes found"
            raise CaseError([Problem("housing.damping_ratio", f"{len(given)} ratios", expected)])
        return np.array(given[: len(frequencies_hz)])
    assert isinstance(given, float | int)
    return np.full(len(frequencies_hz), float(given))
