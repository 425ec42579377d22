"""Operating deflection shapes of a stored run at the spectral lines nearest to given frequencies."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import KDTree

from gearwhine.case import CaseError, Problem
from gearwhine.coupling.signals.spectrum import at_time_zero
from gearwhine.coupling.signals.tones import tones_at
from gearwhine.housing import HousingError, HousingModes
from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.housing.modes.receptance import OperatingShape
from gearwhine.housing.pictures.drawn_shapes import DrawnHousing, DrawnShape, peak_displacement
from gearwhine.housing.storage.mode_file import ModeRecord
from gearwhine.housing.storage.netcdf import read_netcdf
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.output.manifest import opened_dataset, require_as_written
from gearwhine.output.sections import arrowed

if TYPE_CHECKING:
    from gearwhine.coupling.analyses.signature import SolvedSignature

RESULTS_FILE = "results.nc"
_TWO_PI = 2.0 * np.pi
_MICRO = 1e6
_LONGEST_TITLE = 54  # letters of a title in one line; a longer name stands in the note
_LISTED_MODES = 2  # modes in a picture
# Part by which shapes at the nodes nearest to survey points may differ from those at the points.
_LARGEST_SHAPE_DIFFERENCE = 0.1
_OF_LINES = (
    "housing_line",
    "housing_acceleration_spectrum",
    "line_frequency",
    "line_name",
    "survey_shape",
    "survey_position",
)  # arrays of a results file that its operating shapes follow from
_SAME_HOUSING_DIFFERENCE = 1e-9  # relative difference of frequencies and shapes up to which a run's housing is this one


@dataclass(frozen=True)
class RunLine:
    """A line of a run's spectra.

    Attributes
    ----------
    shape : housing.modes.receptance.OperatingShape
    name : str
        Name, such as ``2x mesh``, where a sensor's line there has a name; else empty.
    """

    shape: OperatingShape
    name: str

    @property
    def hertz(self) -> float:
        """Frequency [Hz]."""
        return self.shape.frequency / _TWO_PI


def read_spectrum_lines(folder: Path, frequencies: Sequence[float], solved: HousingModes) -> list[RunLine]:
    """Read the spectral lines nearest to frequencies [Hz] from a results folder, each once, ascending.

    Raises
    ------
    CaseError
        Where there is no run on file, or not of this housing at steady speed, or no line there.
    """
    path = folder / RESULTS_FILE
    if not path.is_file():
        raise _missing(folder, "a results folder with a run: give it by -o, after 'gearwhine run'")
    require_as_written(folder, lambda name: name == RESULTS_FILE)
    with opened_dataset(path) as dataset:
        content = dataset.load()
    if "housing_acceleration_spectrum" not in content:
        raise _missing(folder, "a run at steady speed on ground at rest, whose spectra have lines; 'gearwhine run' it")
    survey = solved.survey.matrix @ solved.modes.shapes.reshape(len(solved.modes.shapes), -1).T
    stored = content["survey_shape"].values.reshape(len(content["housing_mode"]), -1).T
    # Signs count too: amplitudes are those of these very shapes.
    if stored.shape != survey.shape or np.abs(stored - survey).max() > _SAME_HOUSING_DIFFERENCE * np.abs(survey).max():
        raise _missing(folder, "a run with this housing; these results are another's: 'gearwhine run' again")
    lines = content["housing_line"].values
    spacing = float(lines[1] - lines[0])
    spectrum = content["housing_acceleration_spectrum"].values
    listed = content["line_frequency"].values if "line_frequency" in content else np.zeros(0)
    chosen = dict[int, float]()
    for frequency in frequencies:
        place = int(np.argmin(np.abs(lines - frequency)))
        if place == 0 or abs(lines[place] - frequency) > 0.5 * spacing * (1.0 + 1e-9):
            span = f"a line from {lines[1]:.6g} to {lines[-1]:.6g} Hz, which stand {spacing:.4g} Hz apart"
            raise CaseError([Problem("--line", f"{frequency:g}", span)])
        # A tone of the sensors between the lines, where there is one.
        near = listed[np.abs(listed - lines[place]) < 0.5 * spacing]
        chosen[place] = float(near[0]) if near.size else float(lines[place])
    attributes = content["housing_acceleration_spectrum"].attrs
    named = [(chosen[place], _name(content, chosen[place], spacing)) for place in sorted(chosen)]
    start = float(attributes.get("record_start_s", 0.0))
    return _run_lines(
        spectrum[..., 0] + 1j * spectrum[..., 1], spacing, attributes.get("window", "uniform"), start, named
    )


def _run_lines(
    lines: ComplexArray, spacing: float, window: str, start: float, named: Sequence[tuple[float, str]]
) -> list[RunLine]:
    """Operating shapes at frequencies [Hz] with names, from the lines of the housing's modes, shape (n_modes, m).

    Phases are those at t = 0; a tone stands in lines beside each other by their phases at the record's start [s].
    """
    since_start = at_time_zero(lines, np.arange(lines.shape[-1]) * np.float64(spacing), -start)
    frequencies, tones = tones_at(since_start, spacing, [hertz for hertz, _ in named], window)
    modal = at_time_zero(tones, frequencies, start).T
    return [
        RunLine(OperatingShape(_TWO_PI * hertz, motion), name)
        for hertz, motion, (_, name) in zip(frequencies.tolist(), modal, named, strict=True)
        if motion.any()
    ]


def _chosen(listed: Iterable[tuple[float, str]], spacing: float, most: int) -> list[tuple[float, str]]:
    """Return the first frequencies of a list with their names, ascending, each line or tone once."""
    chosen: list[tuple[float, str]] = []
    for hertz, name in listed:
        if len(chosen) < most and all(abs(hertz - other) >= 0.5 * spacing for other, _ in chosen):
            chosen.append((hertz, name))
    return sorted(chosen)


def highest_lines(signature: "SolvedSignature", limit: float, most: int) -> list[RunLine]:
    """Return the lines of a run at which its sensors move most, ascending.

    Parameters
    ----------
    signature : SolvedSignature
        Signature of the run, with traced lines.
    limit : float
        Frequency up to which the modes are complete [Hz].
    most : int
        Number of lines: the highest of each sensor come first, then the second ones, each frequency once.
    """
    housing_lines = signature.housing_lines(limit)
    if housing_lines is None or len(housing_lines[0]) < 2:
        return []
    frequencies, spectrum, window = housing_lines
    ranks = range(max(map(len, signature.lines.values()), default=0))
    listed = (
        (lines[rank].frequency, lines[rank].named.name)
        for rank in ranks
        for lines in signature.lines.values()
        if rank < len(lines)
    )
    spacing = float(frequencies[1])
    return _run_lines(spectrum, spacing, window, signature.record_start, _chosen(listed, spacing, most))


def stored_lines(folder: Path, record: ModeRecord, most: int) -> list[RunLine]:
    """Return the lines of a stored run at which its sensors move most, ascending; none without a run of this housing.

    Parameters
    ----------
    folder : path
        A results folder.
    record : gearwhine.housing.storage.mode_file.ModeRecord
        The housing's modes.
    most : int
        Number of lines, as :func:`highest_lines` chooses them.
    """
    # Without xarray, which would open all of about a hundred arrays.
    try:
        stored, _ = read_netcdf(folder / RESULTS_FILE, _OF_LINES)
    except (OSError, ValueError, KeyError):
        return []
    if len(stored) < len(_OF_LINES):
        return []
    lines, spectrum, listed, names, shapes, positions = (stored[name].values for name in _OF_LINES)
    if not _same_shapes(shapes, positions, record):
        return []
    pairs = zip(listed.T.ravel().tolist(), map(str, names.T.ravel()), strict=True)
    spacing, attributes = float(lines[1]), stored["housing_acceleration_spectrum"].attributes
    chosen = _chosen(((hertz, name) for hertz, name in pairs if np.isfinite(hertz)), spacing, most)
    start = float(attributes.get("record_start_s", 0.0))
    return _run_lines(
        spectrum[..., 0] + 1j * spectrum[..., 1], spacing, attributes.get("window", "uniform"), start, chosen
    )


def _same_shapes(stored: FloatArray, positions: FloatArray, record: ModeRecord) -> bool:
    """Whether the modes of a run are these, with the same signs: by the nodes nearest to its survey points."""
    _, nodes = KDTree(record.mesh.points).query(positions)
    shapes = record.modes.shapes[:, np.asarray(nodes)]
    if stored.shape != shapes.shape:
        return False
    alike = np.sum(stored * shapes, axis=(1, 2)) / np.maximum(np.sum(shapes**2, axis=(1, 2)), np.finfo(float).tiny)
    return bool(np.all(np.abs(alike - 1.0) < _LARGEST_SHAPE_DIFFERENCE))


def operating_shape_of_line(line: RunLine, modes: ModeSet, housing: DrawnHousing) -> DrawnShape:
    """Return a line's operating shape in micrometres, with the modes that have most of its kinetic energy."""
    try:
        motion = line.shape.displacement(modes, housing.nodes)
        largest = float(peak_displacement(motion).max())
        shares = _leading(line, modes)
        listed = ", ".join(f"{number} ({hertz:.0f} Hz) {100.0 * share:.0f} %" for number, hertz, share in shares)
        title, name = f"Operating shape at {line.hertz:.1f} Hz", arrowed(line.name or "")
        fits = len(title) + len(name) < _LONGEST_TITLE
        return DrawnShape(
            f"line-{line.hertz:.1f}Hz",
            f"{title}   {name}" if name and fits else title,
            ("" if fits else f"{name}\n")
            + f"largest {_MICRO * largest:.3g} µm, {largest * line.shape.frequency**2:.3g} m/s² (peak)\n"
            f"kinetic energy: modes {listed}",
            motion,
            "Displacement [µm], peak",
            _MICRO * largest,
        )
    except HousingError as error:
        raise CaseError(
            [Problem("--line", f"{line.hertz:g}", f"a line at which the housing moves; {error}")]
        ) from error


def lines_document(lines: list[RunLine], solved: HousingModes, housing: DrawnHousing) -> list[dict[str, Any]]:
    """Return the lines as the command's JSON."""
    document = []
    for line in lines:
        largest = float(peak_displacement(line.shape.displacement(solved.modes, housing.nodes)).max())
        shares = line.shape.kinetic_shares
        document.append(
            {
                "frequency_hz": line.hertz,
                "name": line.name,
                "largest_displacement_m": largest,
                "largest_acceleration_m_per_s2": largest * line.shape.frequency**2,
                "modes": [
                    {
                        "number": int(mode) + 1,
                        "frequency_hz": float(solved.modes.frequencies_hz[mode]),
                        "kinetic_energy_share": float(shares[mode]),
                        "phase_rad": float(np.angle(line.shape.modal[mode])),
                    }
                    for mode in np.argsort(-shares, kind="stable")
                ],
            }
        )
    return document


def _leading(line: RunLine, modes: ModeSet) -> list[tuple[int, float, float]]:
    """Return number, frequency [Hz] and share of the first few modes."""
    shares = line.shape.kinetic_shares
    return [
        (int(mode) + 1, float(modes.frequencies_hz[mode]), float(shares[mode]))
        for mode in np.argsort(-shares, kind="stable")[:_LISTED_MODES]
    ]


def _name(content: Any, frequency: float, spacing: float) -> str:
    """Name of the line in the sensors' tables, if it is listed there."""
    if "line_name" not in content:
        return ""
    near = np.abs(content["line_frequency"].values - frequency) < 0.5 * spacing
    names = [str(name) for name in content["line_name"].values[near]]
    return names[0] if names else ""


def _missing(folder: Path, expected: str) -> CaseError:
    return CaseError([Problem("--line", str(folder / RESULTS_FILE), expected)])
