"""Housing modes of a case: mesh, certified natural modes, damping, seats, sensors, dominance; their cache and checks.

The mode cache is a file in the results folder that is read again while the housing is unchanged. Modes are identified
by the content of what they were solved from: the whole ``[housing]`` of the case but for the keys that do not enter the
modes, the materials it names, the places of the bearings for which the modes have attachments, the content of its
files, and the versions of the code and the source of what solves them.
A new key of the housing therefore counts until it is listed as one that changes no mode.
"""

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import sparse

import gearwhine
from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.case.errors import UNSAID
from gearwhine.from_case.fixtures import attach_all, build_attachments, check_places
from gearwhine.from_case.mesh import box_mesh_size, build_mesh, materials_of
from gearwhine.from_case.mesh_health import (
    discretisation_warnings,
    noted_on_failure,
    require_meshable,
    surface_point_warnings,
)
from gearwhine.housing import (
    HealthReport,
    Housing,
    HousingError,
    ModeSet,
    effective_mass,
    modal_damping,
    read_modes,
    write_modes,
)
from gearwhine.housing.errors import ModeFileError
from gearwhine.housing.housing import RESPONSE_ORDERS, bearing_port, certified_modes
from gearwhine.housing.material import mass_properties
from gearwhine.housing.measured.survey_planning import Survey, survey_grid
from gearwhine.housing.model.seats import SensorPort
from gearwhine.housing.modes.dominance import Dominance, dominance
from gearwhine.housing.modes.effective_mass import EffectiveMass
from gearwhine.housing.modes.effective_mass import damping_ratios as housing_damping_ratios
from gearwhine.housing.modes.housing_field import HousingField
from gearwhine.housing.modes.receptance import Selection, select_modes
from gearwhine.housing.storage.mesh_arrays import mesh_digest
from gearwhine.housing.storage.mode_file import ModeRecord, with_sensors
from gearwhine.housing.storage.netcdf import LabelledArray, content_key
from gearwhine.meshes import Mesh, mesh_quality
from gearwhine.meshes.lengths import length_text
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.numerics.source_digest import installed, source_digest
from gearwhine.output.files import MODE_CACHE_FILE, texts_in, with_contents
from gearwhine.solve.mesh_refinement import RefinementStep, next_size

FloatArray = npt.NDArray[np.float64]


# Keys of [housing] that change no mode: damping is laid on the modes, sensors are put on the cached mesh afresh.
_WITHOUT_EFFECT = frozenset({"damping_ratio", "sensor"})
MODES_CODE = (
    "gearwhine.numerics",
    "gearwhine.meshes",
    "gearwhine.housing.errors",
    "gearwhine.housing.housing",
    "gearwhine.housing.material",
    "gearwhine.housing.fem",
    "gearwhine.housing.model",
    "gearwhine.housing.modes",
    "gearwhine.housing.storage",
    "gearwhine.case",
    "gearwhine.from_case.fixtures",
    "gearwhine.from_case.mesh",
    "gearwhine.from_case.mesh_health",
    "gearwhine.solve.housing_modes",
    "gearwhine.solve.mesh_refinement",
)
"""Code that the modes are solved by: a change of any other, such as that of figures, leaves them cached."""
_LIBRARIES = ("gmsh", "numpy", "scipy", "scikit-fem", "rslab")
_TWO_PI = 2.0 * np.pi
_COORDINATES = ("coordinate", "other_coordinate")
_SELECTION_TOLERANCE = 0.05  # of the largest receptance between bearings and sensors, for the selection of modes
_DAMPING = "modal_damping"  # name of the damping matrix in a mode-set file
_DIRECTIONS = ("x", "y", "z", "rotation_x", "rotation_y", "rotation_z")


def mode_cache_inputs(case: Case, mesh: Mesh | None = None) -> dict[str, Any]:
    """Return the inputs of a case's housing modes; their content key is that of the modes.

    Parameters
    ----------
    case : Case
        Case with a housing.
    mesh : Mesh, optional
        Mesh of ``[housing.mesh]``: its content counts, not the name or the format of its file.
    """
    table = case.housing
    assert table is not None
    files = dict(case.input_files.contents)
    if table.mesh is not None and mesh is not None:
        files[str(table.mesh.file)] = {"mesh": mesh_digest(mesh)}
    bearings = {name: list(place) for name, place in bearing_places(case).items()}
    written = table.model_dump(mode="json", by_alias=True, exclude_none=True, exclude=set(_WITHOUT_EFFECT))
    named = texts_in(written)
    return {
        "housing": with_contents(written, files),
        "bearings": bearings,
        "attachment_orders": RESPONSE_ORDERS,
        "material": {
            name: material.model_dump(mode="json") for name, material in case.material.items() if name in named
        },
        "versions": {"gearwhine": gearwhine.__version__} | {name: installed(name) for name in _LIBRARIES},
        "source": source_digest(*MODES_CODE),
    }


def housing_key(case: Case) -> str:
    """Return the content key of all that a machine takes of its solved housing: modes, damping, seats and sensors."""
    assert case.housing is not None
    inputs = {"modes": content_key(mode_cache_inputs(case)), "housing": case.housing.model_dump(mode="json")}
    return content_key(inputs)


def read_mode_cache(folder: Path, inputs: Mapping[str, Any]) -> tuple[ModeRecord | None, str | None]:
    """Read the cached modes of these inputs, or None; and a warning where the file cannot be used."""
    path = folder / MODE_CACHE_FILE
    if not path.exists():
        return None, None
    try:
        record = read_modes(path)
    except ModeFileError as error:
        return None, f"{error}; the modes are solved again"
    return (record if record.key == content_key(inputs) else None), None


def _upwards(case: Case) -> tuple[float, ...]:
    """Return the unit vector that points upwards: against gravity, else the file's z of a part turned about it, else y.

    A file whose shafts lie along its x or y has its z upwards, as programs for design have it; `shafts_along = "y"`
    makes that the machine's x.
    """
    gravity = None if case.operation is None else case.operation.gravity
    if gravity is not None and any(gravity):
        size = math.hypot(*gravity)
        return tuple(-part / size for part in gravity)
    housing = case.housing
    form = None if housing is None else housing.cad or housing.mesh
    return (1.0, 0.0, 0.0) if form is not None and form.shafts_along == "y" else (0.0, 1.0, 0.0)


@dataclass(frozen=True)
class SolvedHousing:
    """Solved housing: mesh, modes, damping, seats, sensors, dominance and checks.

    Attributes
    ----------
    mesh : Mesh
    mass : float
        Mass with the attached masses [kg].
    attached_mass : float
        Sum of the attached masses [kg].
    modes : gearwhine.housing.ModeSet
    damping_ratios : ndarray, shape (n_modes,)
        Damping ratios that the case gives; see :attr:`total_damping_ratios`.
    damping_matrix : ndarray, shape (n_modes, n_modes), or None
        Modal damping matrix of dashpots, mounts and joints [1/s]; None where nothing damps.
    seats : dict of str to ndarray, shape (n_modes, 6)
        Modes' motions at each bearing seat.
    seat_ports : dict of str to sparse array, shape (6, 3 n_nodes)
        The seats' motions from the nodes'.
    loaded : dict of str to sparse array, shape (5, 3 n_nodes)
        Motions of each place where the machine bears on the housing, see
        :func:`gearwhine.housing.housing.bearing_port`: the modes' attachments are for these.
    sensors : dict of str to SensorPort
    survey : Survey
    strengths : Dominance or None
        Dominance of the modes; None without seats.
    checks : dict
        Health report, effective masses and the mass of the solid as their documents.
    seconds : dict of str to float
        Times of mesh, assembly, factorisation, eigensolver and of all [s]; of reading, where the modes are read.
    record : ModeRecord
        Content of its mode-set file.
    source : Path or None
        The file that the modes were read from; None where they were solved.
    source_holds : bool
        Whether that file also holds these sensors, so that it need not be written again.
    warnings : list of dict
        Warnings, as in the documents.
    up : tuple of float
        Unit vector that points upwards in pictures.
    widest_bore : float or None
        Diameter of its widest seat [m]; None without seats.
    """

    mesh: Mesh
    mass: float
    attached_mass: float
    modes: ModeSet
    damping_ratios: FloatArray
    damping_matrix: FloatArray | None
    seats: dict[str, FloatArray]
    seat_ports: dict[str, sparse.csr_array]
    loaded: dict[str, sparse.csr_array]
    sensors: dict[str, SensorPort]
    survey: Survey
    strengths: Dominance | None
    checks: dict[str, Any]
    seconds: dict[str, float]
    record: ModeRecord
    source: Path | None = None
    source_holds: bool = False
    warnings: list[dict[str, Any]] = field(default_factory=list)
    up: tuple[float, ...] = (0.0, 1.0, 0.0)
    widest_bore: float | None = None

    @property
    def trusted_limit_hz(self) -> float:
        """Frequency below which the modes are complete [Hz]."""
        return self.modes.certificate.limit / _TWO_PI

    @property
    def displacement_field(self) -> HousingField:
        """Its mesh, and the shapes of modes and residual modes on that."""
        return HousingField(self.mesh, self.modes, self.widest_bore)

    @property
    def total_damping_ratios(self) -> FloatArray:
        """Damping ratio of each mode with the diagonal of the damping matrix; the coupling of modes is left out."""
        return housing_damping_ratios(self.modes.frequencies, self.damping_ratios, self.damping_matrix)

    @property
    def refinement(self) -> list[dict[str, Any]]:
        """Meshes that were solved until the modes had the accuracy asked for, the last one this; else empty."""
        return list(self.record.notes.get("refinement", ()))

    @property
    def survey_shapes(self) -> FloatArray:
        """Mode shapes at the survey points, mass-normalised, shape (n_modes, n_points, 3) [1/√kg]."""
        count = len(self.modes.frequencies)
        return (self.survey.matrix @ self.modes.shapes.reshape(count, -1).T).T.reshape(count, -1, 3)

    @property
    def missing_compliance(self) -> FloatArray:
        """Part of the static compliance that the modes lack without attachments, shape (n_loaded, 5).

        Raises
        ------
        ValueError
            Where there are no attachments.
        """
        if self.modes.residual_modes is None:
            raise ValueError("static compliance of a housing without attachments")
        return self.modes.residual_modes.proof.missing_parts.reshape(len(self.loaded), -1)

    @cached_property
    def selection(self) -> Selection | None:
        """Modes that carry forces across the shafts from the bearings to the sensors; None where there are not both."""
        ratios = self.total_damping_ratios
        if not self.loaded or not self.sensors or not (ratios > 0.0).all():
            return None
        # Forces across the shafts alone: receptances by moments have another unit, and no common scale with these.
        forces = sparse.csr_array(sparse.vstack([motions[:2] for motions in self.loaded.values()], format="csr"))
        motions = sparse.csr_array(sparse.vstack([sensor.matrix for sensor in self.sensors.values()], format="csr"))
        # From just above rest, where a free housing has no receptance.
        limit = self.modes.certificate.limit
        return select_modes(self.modes, ratios, forces, motions, (0.01 * limit, limit), _SELECTION_TOLERANCE)


def solve_housing(
    case: Case,
    progress: Progress = silent,
    *,
    command: str = "modes",
    folder: Path | None = None,
    fresh: bool = False,
    before: Callable[[Case, Mesh], None] | None = None,
) -> SolvedHousing:
    """Mesh the housing and solve its certified modes, or read them from the mode cache.

    Parameters
    ----------
    case : Case
    progress : callable
        Receives the next step in words.
    command : str
        Command that needs the modes, for messages.
    folder : path, optional
        A results folder; modes of the same housing cached there are read in place of solving.
    fresh : bool
        Whether to solve the modes even where they are cached.
    before : callable, optional
        Check of the rest of a case on the mesh, made before the modes are solved.

    Raises
    ------
    CaseError, gearwhine.housing.HousingError
        Where the case cannot be solved as it stands.
    gearwhine.housing.IncompleteModesError, gearwhine.housing.ReductionError, gearwhine.housing.HealthError
        Where the modes fail their certificate, their static compliance its proof, or the model its checks.
    """
    require(case, "housing", command=command)
    table = case.housing
    assert table is not None
    if table.accuracy is not None:
        inputs = mode_cache_inputs(case)
        if fresh or folder is None or read_mode_cache(folder, inputs)[0] is None:
            return _refined(case, progress, inputs, before=before)
    return _solve_on_one_mesh(case, progress, folder=folder, fresh=fresh, before=before)


def _refined(
    case: Case,
    progress: Progress,
    inputs: dict[str, Any],
    *,
    before: Callable[[Case, Mesh], None] | None,
) -> SolvedHousing:
    """Solve the housing on finer and finer meshes, until every mode's estimated error is within the accuracy."""
    table = case.housing
    assert table is not None
    assert table.accuracy is not None
    steps: list[RefinementStep] = []
    begin, size = time.perf_counter(), box_mesh_size(case) if table.box is not None else None
    while True:
        trial = case if size is None else case.model_copy(update={"housing": table.meshed_by(size)})
        # Without a size the mesher takes a coarse one by the walls' thickness.
        solved = _solve_on_one_mesh(trial, progress, folder=None, fresh=True, before=before)
        errors = solved.modes.discretisation_errors
        assert errors is not None
        size = mesh_quality(solved.mesh).edge_length[1] if size is None else size
        worst = int(np.argmax(errors))
        steps.append(RefinementStep(size, 3 * len(solved.mesh.points), len(errors), float(errors[worst])))
        progress(
            f"elements of {length_text(size)}, {steps[-1].dofs} degrees of freedom: mode {worst + 1} has the largest "
            f"estimated error, {100 * errors[worst]:.3g} %; {100 * table.accuracy:g} % is wanted"
        )
        if errors[worst] <= table.accuracy:
            break
        size = next_size(steps, table.accuracy)
    seconds = solved.seconds | {"total": time.perf_counter() - begin}
    # What was asked for is reached: no advice on the size of elements.
    noted = [entry for entry in solved.record.notes["warnings"] if entry["name"] != "discretisation"]
    steps_made = [step.document for step in steps]
    notes = {**solved.record.notes, "warnings": noted, "seconds": seconds, "refinement": steps_made}
    return replace(
        solved,
        seconds=seconds,
        record=replace(solved.record, inputs=inputs, notes=notes),
        warnings=[entry for entry in solved.warnings if entry["name"] != "discretisation"],
    )


def _solve_on_one_mesh(
    case: Case,
    progress: Progress,
    *,
    folder: Path | None,
    fresh: bool,
    before: Callable[[Case, Mesh], None] | None,
) -> SolvedHousing:
    """Mesh the housing and solve its modes, or read them from the mode cache; see :func:`solve_housing`."""
    table = case.housing
    assert table is not None
    begin = time.perf_counter()
    remarks: list[str] = []
    mesh = build_mesh(case, remarks.append) if table.mesh is not None else None
    inputs = mode_cache_inputs(case, mesh)
    cached, spoilt = read_mode_cache(folder, inputs) if folder is not None and not fresh else (None, None)
    if cached is not None and folder is not None:
        mesh, warnings = cached.mesh, list(cached.notes["warnings"])
        progress(f"modes read from {folder / MODE_CACHE_FILE} (unchanged housing)")
    else:
        if mesh is None:
            progress("meshing the housing")
            mesh = build_mesh(case, remarks.append)
        warnings = [warning("geometry", remark) for remark in remarks] + require_meshable(case, mesh)
    meshed = time.perf_counter() - begin
    with noted_on_failure(warnings):
        # Places and ports come before the modes: their errors appear before the long work.
        check_places(case, mesh)
        if before is not None:
            before(case, mesh)
        described = describe_housing(case, mesh)
        seat_ports = described.seat_ports()
        loaded = {name: bearing_port(seat_ports[seat], arm) for name, (seat, arm) in bearing_places(case).items()}
        sensors = described.sensor_ports()
        bounds = None if table.box is None else np.array([table.box.lower, table.box.upper])
        survey = survey_grid(mesh, bounds)
        if cached is None:
            modes, mass, damping_matrix, checks, seconds = _solve_modes(case, described, loaded, progress)
            seconds = {"mesh": meshed, **seconds}
            warnings += discretisation_warnings(case, mesh, modes)
        else:
            modes, mass, checks = cached.modes, cached.mass, cached.notes["checks"]
            damping_matrix = cached.extras[_DAMPING].values if _DAMPING in cached.extras else None
            seconds = {"mesh": 0.0, "assembly": 0.0, "factorisation": 0.0, "eigensolver": 0.0, "reading": meshed}
    seats_in_modes = {name: modes.project(matrix) for name, matrix in seat_ports.items()}
    strengths = None
    if seat_ports:
        radial = np.stack([motion[:, :2] for motion in seats_in_modes.values()], axis=1)
        strengths = dominance(modes.frequencies, radial, survey.normal_motion(modes.shapes))
    seconds["total"] = time.perf_counter() - begin
    record = cached or ModeRecord(
        mesh,
        modes,
        mass,
        seats=tuple(described.seats),
        seat_motions=np.stack(list(seats_in_modes.values()), axis=1) if seat_ports else np.empty((0, 0, 6)),
        inputs=inputs,
        notes={"seconds": seconds, "checks": checks, "warnings": warnings},
        extras={} if damping_matrix is None else {_DAMPING: _damping_array(damping_matrix)},
    )
    record = with_sensors(record, sensors.values())
    return SolvedHousing(
        mesh=mesh,
        mass=mass,
        attached_mass=sum(entry.mass for entry in table.mass),
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
        source=None if cached is None or folder is None else folder / MODE_CACHE_FILE,
        source_holds=cached is not None and cached.sensors == record.sensors,
        up=_upwards(case),
        widest_bore=max((seat.diameter for seat in table.seat), default=None),
        warnings=warnings
        + _health_warnings(checks)
        + list(surface_point_warnings(case, mesh))
        + ([] if spoilt is None else [warning("modes file", spoilt)])
        + _surplus_damping(case, len(modes.frequencies)),
    )


def kept_housing(case: Case, folder: Path | None, progress: Progress = silent) -> SolvedHousing | None:
    """Return the housing of a case from the modes that a results folder keeps; None where it keeps none of it.

    Raises
    ------
    CaseError, gearwhine.housing.HousingError
        As :func:`solve_housing`.
    """
    if folder is None or case.housing is None or not (folder / MODE_CACHE_FILE).exists():
        return None
    mesh = build_mesh(case) if case.housing.mesh is not None else None
    record, _ = read_mode_cache(folder, mode_cache_inputs(case, mesh))
    return None if record is None else solve_housing(case, progress, folder=folder)


def _damping_array(matrix: FloatArray) -> LabelledArray:
    return LabelledArray(_COORDINATES, matrix, "s-1", "damping of what is fastened, by modes and attachments")


def _solve_modes(
    case: Case, described: Housing, loaded: dict[str, sparse.csr_array], progress: Progress
) -> tuple[ModeSet, float, FloatArray | None, dict[str, Any], dict[str, float]]:
    """Solve the modes; return them, the mass [kg], the damping matrix, the checks, and the seconds of each step."""
    table = case.housing
    assert table is not None
    begin, mesh = time.perf_counter(), described.mesh
    progress(f"assembling {3 * len(mesh.points)} degrees of freedom")
    free = described.free_matrices()
    matrices = attach_all(case, mesh, free)
    assembled = time.perf_counter() - begin
    key = "modes" if table.frequency_limit is None else "frequency_limit"
    try:
        modes = certified_modes(
            matrices,
            loaded,
            below_hz=table.frequency_limit,
            count=table.modes,
            solver=table.solver,
            progress=progress,
        )
    except HousingError as error:
        raise CaseError([Problem(f"housing.{key}", UNSAID, f"what this model has; {error}")]) from error
    damping = modal_damping(modes, matrices) if matrices.damping.nnz else None
    progress("estimating the error by the mesh")
    begin = time.perf_counter()
    modes = described.with_discretisation_errors(free, matrices, modes)
    estimated = time.perf_counter() - begin
    progress("checking the housing against its geometry")
    begin = time.perf_counter()
    health = described.health(free, matrices, modes)
    health.require()
    checks = housing_checks(described, health, effective_mass(matrices, mesh.points, modes))
    checked = time.perf_counter() - begin
    seconds = {"assembly": assembled, **modes.seconds, "error_estimate": estimated, "checks": checked}
    return modes, matrices.total_mass, damping, checks, seconds


def describe_housing(case: Case, mesh: Mesh) -> Housing:
    """Build the library's description of a case's housing on its mesh.

    Raises
    ------
    CaseError
        Where a region has no elements of its own.
    gearwhine.housing.HousingError
        As :class:`gearwhine.housing.Housing`.
    """
    parted, material, materials = materials_of(case, mesh)
    fixtures = [fixture for _, _, fixture in build_attachments(case)]
    table = case.housing
    assert table is not None
    seats, sensors = tuple(seat.build() for seat in table.seat), tuple(sensor.build() for sensor in table.sensor)
    return Housing(parted, material, materials, fixtures, seats, sensors)


def write_mode_cache(place: Path, solved: SolvedHousing) -> None:
    """Write a solved housing's modes, unless the file that they were read from holds them, sensors and all."""
    if not solved.source_holds:
        write_modes(place / MODE_CACHE_FILE, solved.record)


def base_participation(case: Case, mesh: Mesh, modes: ModeSet) -> FloatArray:
    """Participation of modes and attachments in the motions of the ground, about the origin, shape (n, 6) [√kg, √kg m].

    See :meth:`gearwhine.housing.Housing.participation`.
    """
    described = describe_housing(case, mesh)
    return described.participation(described.matrices(), modes)


def strongest_modes(solved: SolvedHousing, count: int) -> list[int]:
    """Numbers of the strongest modes, from 1; the lowest ones where there are no seats to be driven at."""
    if solved.strengths is None:
        return list(range(1, min(count, len(solved.modes.frequencies)) + 1))
    return [int(mode) + 1 for mode in solved.strengths.strongest(count, (0.0, np.inf))]


def _damping(case: Case, frequencies_hz: FloatArray) -> FloatArray:
    """Damping ratio of each mode: one for all, one for each, or by a table of frequency."""
    assert case.housing is not None
    ratio = case.housing.modal_damping
    if case.housing.damping_points:
        places, ratios = np.array(case.housing.damping_points).T
        return np.asarray(np.interp(frequencies_hz, places, ratios))
    if isinstance(ratio, tuple):
        if len(ratio) < len(frequencies_hz):
            expected = f"a ratio for each of the {len(frequencies_hz)} modes found"
            raise CaseError([Problem("housing.damping_ratio", f"{len(ratio)} ratios", expected)])
        return np.array(ratio[: len(frequencies_hz)])
    assert isinstance(ratio, float | int)
    return np.full(len(frequencies_hz), float(ratio))


def _surplus_damping(case: Case, n_modes: int) -> list[dict[str, Any]]:
    """Warn of a list of damping ratios that is longer than the modes below the frequency limit."""
    assert case.housing is not None
    ratios = case.housing.damping_ratio
    if not isinstance(ratios, tuple) or len(ratios) <= n_modes:
        return []
    message = (
        f"damping_ratio lists {len(ratios)} ratios for {n_modes} modes: the first {n_modes} are taken in order, "
        "the others are not used; the list needs one for each mode from the lowest on, rigid motions included"
    )
    return [warning("damping", message, count=len(ratios) - n_modes)]


def bearing_places(case: Case) -> dict[str, tuple[str, float]]:
    """Bearing positions on the housing: by bearing, its seat and its distance along z from the seat's centre [m].

    Without bearings in seats, each seat stands for a bearing at its centre. The housing's attachments are for these.
    """
    assert case.housing is not None
    centers = {seat.name: seat.center[2] for seat in case.housing.seat}
    places = {
        bearing.name: (bearing.seat, case.rotor_named(bearing.rotor).start + bearing.at - centers[bearing.seat])
        for bearing in case.bearing
        if bearing.seat in centers
    }
    return places or {name: (name, 0.0) for name in centers}


def _health_warnings(checks: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Warn of every check of the housing's model that misses its bound, but the one that has a warning of its own."""
    return [
        warning(
            "health",
            f"{line['name']} is {line['value']:.3g}, beyond its bound of {line['bound']:.3g}: {line['why']}",
            check=line["name"],
            value=line["value"],
            bound=line["bound"],
        )
        for line in checks["health"]["lines"]
        # Of the error by the mesh ``discretisation_warnings`` tells more, unless the case asks for an accuracy.
        if not line["ok"] and line["bound"] is not None and line["name"] != "discretisation"
    ]


def housing_checks(described: Housing, health: HealthReport, masses: EffectiveMass) -> dict[str, Any]:
    """Return health report, effective masses and the solid's mass, for the documents and the mode cache."""
    solid = mass_properties(described.mesh, described.material, described.materials)
    return {
        "health": _health_document(health),
        "effective_mass": _mass_document(masses),
        "solid": {"mass_kg": solid.mass, "center_of_mass_m": solid.center.tolist()},
    }


def _health_document(health: HealthReport) -> dict[str, Any]:
    body, grounding = health.body, health.grounding
    return {
        "ok": health.ok,
        "lines": [
            {
                "name": line.name,
                "value": line.value,
                "bound": line.bound,
                "ok": line.ok,
                "essential": line.essential,
                "why": line.why,
            }
            for line in health.lines
        ],
        "mass_kg": body.mass,
        "center_of_gravity_m": body.center.tolist(),
        "inertia_kg_m2": body.inertia.tolist(),
        "free_motions": grounding.free_motions,
        "supports": [
            {
                "name": support.name,
                "fixes": support.fixes,
                "stiffness_n_per_m": support.stiffness[:3].tolist(),
                "stiffness_n_m_per_rad": support.stiffness[3:].tolist(),
                "share": dict(zip(_DIRECTIONS, support.share.tolist(), strict=True)),
            }
            for support in grounding.supports
        ],
    }


def _mass_document(masses: EffectiveMass) -> dict[str, Any]:
    return {
        "directions": list(_DIRECTIONS),
        "fractions": masses.fractions.tolist(),
        "captured": masses.captured.tolist(),
        "missing": masses.missing.tolist(),
        "held_by_supports": (1.0 - masses.free / masses.total).tolist(),
    }
