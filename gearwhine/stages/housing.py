"""The housing of a case: geometry to mesh, mesh to certified modes, modes to strengths and comparison."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import housing as room
from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.case import Sensor as GivenSensor
from gearwhine.progress import Progress, silent
from gearwhine.stages.attachments import attach_all, build_supports, check_reach
from gearwhine.stages.geometry import build_mesh
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi


@dataclass(frozen=True)
class SolvedHousing:
    """The housing with everything that later stages take from it.

    Attributes
    ----------
    mesh : Mesh
    mass : float
        With the masses attached [kg].
    attached_mass : float
        Of these alone [kg].
    modes : housing.ModeSet
    damping_ratios : ndarray, shape (n_modes,)
        As the case gives them; see :attr:`total_damping_ratios`.
    damping_matrix : ndarray, shape (n_modes, n_modes), or None
        What dashpots, mounts and joints add in modal coordinates [1/s]; None where nothing damps.
    seats : dict of str to ndarray, shape (n_modes, 6)
        Modes' motions at each bearing seat.
    sensors : dict of str to housing.SensorPort
    survey : housing.Survey
    strengths : housing.Dominance or None
        None where there are no seats.
    seconds : dict of str to float
        Time taken by mesh, assembly, factorisation, eigensolver and in total.
    warnings : tuple of str
        What the user should know of the geometry.
    """

    mesh: Mesh
    mass: float
    attached_mass: float
    modes: room.ModeSet
    damping_ratios: FloatArray
    damping_matrix: FloatArray | None
    seats: dict[str, FloatArray]
    sensors: dict[str, room.SensorPort]
    survey: room.Survey
    strengths: room.Dominance | None
    seconds: dict[str, float]
    warnings: tuple[str, ...] = ()

    @property
    def total_damping_ratios(self) -> FloatArray:
        """Each mode's ratio with its own share of what is attached; the coupling of modes by it left aside."""
        if self.damping_matrix is None:
            return self.damping_ratios
        return room.damping_ratios(self.modes.frequencies, self.damping_ratios, self.damping_matrix)


def solve_housing(case: Case, progress: Progress = silent, *, command: str = "modes") -> SolvedHousing:
    """Mesh the housing and find its modes with their certificate.

    Raises
    ------
    CaseError, meshes.GeometryError, housing.HousingError
        Where the case cannot be solved as it stands.
    housing.IncompleteModesError
        Where the modes fail their certificate.
    """
    require(case, "housing", command=command)
    given = case.housing
    assert given is not None
    begin = time.perf_counter()
    progress("meshing the housing")
    warnings: list[str] = []
    mesh = build_mesh(case, warnings.append)
    meshed = time.perf_counter()
    progress(f"assembling {3 * len(mesh.points)} degrees of freedom")
    steel = case.material[given.material]
    material = room.Material(steel.youngs_modulus, steel.poisson_ratio, steel.density)
    free = room.assemble(mesh, material)
    matrices = attach_all(case, mesh, free)
    assembled = time.perf_counter()
    # Without a limit or a number, what a first look wants.
    count = given.modes if given.modes is not None else (None if given.frequency_limit is not None else 20)
    modes = room.solve_modes(
        matrices,
        room.fixed_freedoms(mesh, build_supports(case)),
        frequency_limit=None if given.frequency_limit is None else _HERTZ * given.frequency_limit,
        count=count,
        progress=progress,
    )
    seats = {seat.name: modes.project(room.seat_matrix(mesh, room.Seat(seat.name, seat.center))) for seat in given.seat}
    sensors = {entry.name: _sensor(mesh, index, entry) for index, entry in enumerate(given.sensor)}
    bounds = None if given.box is None else np.array([given.box.lower, given.box.upper])
    survey = room.survey_grid(mesh, bounds)
    strengths = None
    if seats:
        radial = np.stack([motion[:, :2] for motion in seats.values()], axis=1)
        strengths = room.dominance(modes.frequencies, radial, survey.normal_motion(modes.shapes))
    return SolvedHousing(
        mesh=mesh,
        mass=matrices.total_mass,
        attached_mass=sum(entry.mass for entry in given.mass),
        modes=modes,
        damping_ratios=_damping(case, modes.frequencies_hz),
        damping_matrix=room.modal_damping(modes, matrices) if matrices.damping.nnz else None,
        seats=seats,
        sensors=sensors,
        survey=survey,
        strengths=strengths,
        seconds={
            "mesh": meshed - begin,
            "assembly": assembled - meshed,
            **modes.seconds,
            "total": time.perf_counter() - begin,
        },
        warnings=tuple(warnings),
    )


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


def modes_document(solved: SolvedHousing) -> dict[str, Any]:
    """The modes as the command's JSON."""
    certificate = solved.modes.certificate
    strengths = solved.strengths
    return {
        "modes": [
            {
                "number": number,
                "frequency_hz": float(frequency),
                "damping_ratio": float(damping),
                "strength": None if strengths is None else float(strengths.acceleration[number - 1]),
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
        "mass_kg": solved.mass,
        "attached_mass_kg": solved.attached_mass,
        "warnings": list(solved.warnings),
        "seconds": solved.seconds,
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
