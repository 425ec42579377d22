"""Writer of universal files: points, shapes and functions, written whole or not at all.

Points go out in double precision (2411) or, where a program asks for it, in single (15); directions that are not
along the axes as coordinate systems (18); shapes as dataset 55 in the points' own directions; responses, histories and
spectra as dataset 58 in binary, whose header and length of binary part are written here, because pyuff 2.5 counts
complex values as half.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured.nodal_data import COMPLEX_FIRST, NORMAL
from gearwhine.housing.measured.survey_data import MeasuredGeometry, MeasuredModes, MeasuredResponses, SurveyData
from gearwhine.housing.measured.universal_datasets import FORCE, MOTIONS, RESPONSE_FUNCTION
from gearwhine.housing.storage.atomic_file import atomic_file
from gearwhine.numerics.arrays import FloatArray

_SI = {"type": 164, "units_code": 1, "units_description": "SI: Meter (newton)", "temp_mode": 1}
_SI |= {"length": 1.0, "force": 1.0, "temp": 1.0, "temp_offset": 273.15}
_UNIT_LABELS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s^2"}
_AXES = np.eye(3)
_LONGEST_LINE = 250  # points of a trace line, by the format


def write_universal(path: str | Path, survey: SurveyData, *, points: Literal[15, 2411] = 2411) -> None:
    """Write points, trace lines, shapes and responses in SI.

    Parameters
    ----------
    path : path
    survey : SurveyData
    points : {15, 2411}
        Dataset of the points; 15 holds six digits and is read by every program, 2411 holds all.

    Raises
    ------
    MeasuredDataError
        Where there are no points, labels are not whole numbers above 0, a point's directions are not perpendicular to
        each other, or shapes lack values at single degrees of freedom, none of which the format can express.
    """
    import pyuff

    path = Path(path)
    geometry = survey.geometry
    if geometry is None:
        raise MeasuredDataError("a universal file needs points; write frequencies alone as a table (CSV)")
    measured = [geometry] + [one.geometry for one in (survey.modes, survey.responses) if one and one.geometry]
    nodes = _nodes(geometry)
    frames = _frames(geometry, measured, survey.responses)
    turned = np.flatnonzero(np.any(frames != _AXES, axis=(1, 2)))
    datasets: list[dict[str, Any]] = [{"type": 151, **_HEADER}, dict(_SI)]
    systems = np.zeros(len(nodes), dtype=np.int64)
    if len(turned):
        systems[turned] = 2 + np.arange(len(turned))  # 1 is some programs' own global frame
        datasets.append(_systems(systems[turned], frames[turned]))
    datasets.append(_points(points, nodes, geometry.positions, systems))
    datasets += _lines(geometry, nodes)
    if survey.modes is not None and survey.modes.shapes is not None:
        datasets += _shapes(survey.modes, nodes, frames)
    with atomic_file(path) as staged:
        pyuff.UFF(str(staged)).write_sets(datasets, "overwrite")
        if survey.responses is not None:
            with staged.open("ab") as file:
                for block in _functions(survey.responses, nodes, frames):
                    file.write(block)


_HEADER: dict[str, Any] = {
    "model_name": "survey",
    "description": "NONE",
    "db_app": "gearwhine",
    "date_db_created": "NONE",
}
_HEADER |= {"time_db_created": "NONE", "version_db1": 0, "version_db2": 0, "file_type": 0, "program": "gearwhine"}
_HEADER |= {"date_db_saved": "NONE", "time_db_saved": "NONE", "date_file_written": "NONE", "time_file_written": "NONE"}


def _nodes(geometry: MeasuredGeometry) -> list[int]:
    """Return the labels as the format's numbers."""
    wrong = [label for label in geometry.labels if not (label.isdecimal() and 0 < int(label) < 10**9)]
    if wrong:
        raise MeasuredDataError(f"point {wrong[0]!r}: a universal file knows points by whole numbers above 0")
    return [int(label) for label in geometry.labels]


def _frames(
    geometry: MeasuredGeometry, measured: list[MeasuredGeometry], responses: MeasuredResponses | None
) -> FloatArray:
    """For each point three perpendicular directions, as rows, that hold all directions measured there."""
    seen: list[list[FloatArray]] = [[] for _ in geometry.labels]
    for measurement in measured:
        if measurement.labels != geometry.labels or not np.array_equal(measurement.positions, geometry.positions):
            raise MeasuredDataError("shapes and responses of one file need the same points; write two files")
        for point, direction in zip(measurement.points, measurement.directions, strict=True):
            seen[point].append(direction)
    if responses is not None:
        for point, direction in zip(responses.reference_points, responses.reference_directions, strict=True):
            seen[point].append(direction)
    return np.array([_frame(label, given) for label, given in zip(geometry.labels, seen, strict=True)])


def _frame(label: str, directions: list[FloatArray]) -> FloatArray:
    """Return the global axes where the directions lie along them, else the directions completed to three."""
    if all(np.any(np.abs(_AXES @ direction) > 1.0 - 1e-12) for direction in directions):
        return _AXES
    frame: list[FloatArray] = []
    for direction in directions:
        shares = np.array([direction @ axis for axis in frame])
        if len(frame) and np.any(np.abs(shares) > 1.0 - 1e-9):
            continue
        if len(frame) == 3 or np.any(np.abs(shares) > 1e-6):
            raise MeasuredDataError(
                f"the directions at point {label} are not perpendicular to each other: no coordinate system holds them"
            )
        frame.append(direction)
    if len(frame) == 1:
        helper = _AXES[np.argmin(np.abs(frame[0]))]
        across = np.cross(frame[0], helper)
        frame.append(across / np.linalg.norm(across))
    third = np.cross(frame[0], frame[1])
    return np.stack([frame[0], frame[1], third / np.linalg.norm(third)])


def _systems(numbers: npt.NDArray[np.int64], frames: FloatArray) -> dict[str, Any]:
    """Dataset 18: origin, a point on +x, a point on the +xz plane."""
    zeros = np.zeros((len(numbers), 3))
    return {
        "type": 18,
        "cs_num": numbers,
        "ref_cs_num": np.zeros(len(numbers), dtype=np.int64),
        "cs_name": [f"point system {number}" for number in numbers],
        "ref_o": zeros,
        "x_point": frames[:, 0],
        "xz_point": frames[:, 2],
    }


def _points(kind: int, nodes: list[int], positions: FloatArray, systems: npt.NDArray[np.int64]) -> dict[str, Any]:
    zeros = np.zeros(len(nodes), dtype=np.int64)
    numbers = {"node_nums": np.array(nodes), "def_cs": zeros, "disp_cs": systems, "color": zeros}
    return {"type": kind, **numbers, "x": positions[:, 0], "y": positions[:, 1], "z": positions[:, 2]}


def _lines(geometry: MeasuredGeometry, nodes: list[int]) -> list[dict[str, Any]]:
    pieces = [
        line[start : start + _LONGEST_LINE]
        for line in geometry.lines
        for start in range(0, len(line) - 1, _LONGEST_LINE - 1)  # the next piece begins where the last one ends
    ]
    return [
        {
            "type": 82,
            "trace_num": number,
            "color": 1,
            "id": "NONE",
            "nodes": np.array([nodes[point] for point in piece]),
        }
        for number, piece in enumerate(pieces, start=1)
    ]


def _shapes(modes: MeasuredModes, nodes: list[int], frames: FloatArray) -> list[dict[str, Any]]:
    """Dataset 55 for each mode; real where all shapes are."""
    assert modes.shapes is not None
    assert modes.geometry is not None
    lacking = np.isnan(modes.shapes)
    partly = np.flatnonzero(lacking.any(axis=0) & ~lacking.all(axis=0))
    if len(partly):
        point = modes.geometry.labels[modes.geometry.points[partly[0]]]
        raise MeasuredDataError(
            f"a direction at point {point} was measured in some modes only, which a universal file cannot say; "
            "write a table (CSV)"
        )
    real = not np.any(np.nan_to_num(modes.shapes).imag)
    ratios = np.zeros(len(modes.frequencies)) if modes.damping_ratios is None else modes.damping_ratios
    measured = sorted(set(modes.geometry.points.tolist()))
    rows = {point: row for row, point in enumerate(measured)}
    datasets = []
    for number, (frequency, ratio, shape) in enumerate(
        zip(modes.frequencies, ratios, np.nan_to_num(modes.shapes), strict=True), start=1
    ):
        motion = np.zeros((len(measured), 3), dtype=np.complex128)
        for point, direction, value in zip(modes.geometry.points, modes.geometry.directions, shape, strict=True):
            component, sign = _component(frames[point], direction)
            motion[rows[point], component] = sign * value
        columns = motion.real if real else motion
        dataset = {
            "type": 55,
            "id1": f"mode {number}",
            "data_ch": 2,
            "spec_data_type": 8,
            "load_case": 1,
            "mode_n": number,
            "node_nums": [nodes[point] for point in measured],
            **{f"r{component + 1}": columns[:, component].copy() for component in range(3)},
        }
        if real:
            dataset |= {"analysis_type": NORMAL, "freq": frequency / (2.0 * np.pi), "modal_damp_vis": ratio}
        else:
            pole = frequency * complex(-ratio, np.sqrt(1.0 - ratio**2))
            dataset |= {"analysis_type": COMPLEX_FIRST, "eig": pole}
        datasets.append(dataset)
    return datasets


def _component(frame: FloatArray, direction: FloatArray) -> tuple[int, int]:
    """Index of this direction among a point's three, and its sign."""
    shares = frame @ direction
    component = int(np.argmax(np.abs(shares)))
    return component, 1 if shares[component] > 0.0 else -1


@dataclass(frozen=True)
class UniversalFunction:
    """Function of time or frequency, for a dataset 58.

    Attributes
    ----------
    kind : {"time response", "frequency response function", "spectrum"}
    abscissa : ndarray, shape (n,)
        Time [s] or frequency [Hz].
    values : ndarray, shape (n,)
        Values, real or complex.
    unit : str
        Unit of the values: m, m/s, m/s2, N, Pa or another, which the file then calls general.
    label : str
        Name of the quantity.
    titles : tuple of str
        Lines of text, at most five.
    response : tuple of (str, int, int)
        Name, number of the point, 0 for none, and direction there: 1, 2, 3 for x, y, z, with a sign; 0 for another.
    reference : tuple of (str, int, int)
        The excitation's name, point and direction.
    reference_unit, reference_label : str
        Unit and name of the excitation's quantity; empty for none.
    """

    kind: Literal["time response", "frequency response function", "spectrum"]
    abscissa: FloatArray
    values: npt.NDArray[Any]
    unit: str
    label: str
    titles: tuple[str, ...] = ()
    response: tuple[str, int, int] = ("NONE", 0, 0)
    reference: tuple[str, int, int] = ("NONE", 0, 0)
    reference_unit: str = ""
    reference_label: str = ""


def write_functions(
    path: str | Path, functions: Iterable[UniversalFunction], points: Sequence[tuple[float, float, float]] = ()
) -> None:
    """Write functions in SI, with the points 1, 2, … that they may name.

    A time axis is written as even, by its first value and its spacing; a frequency axis value by value. Values are in
    double precision.

    Parameters
    ----------
    path : path
    functions : iterable of UniversalFunction
    points : sequence of (float, float, float)
        Places [m].
    """
    import pyuff

    datasets: list[dict[str, Any]] = [{"type": 151, **_HEADER}, dict(_SI)]
    if len(points):
        positions = np.array(points, dtype=np.float64)
        numbers = list(range(1, len(positions) + 1))
        datasets.append(_points(2411, numbers, positions, np.zeros(len(positions), dtype=np.int64)))
    with atomic_file(Path(path)) as staged:
        pyuff.UFF(str(staged)).write_sets(datasets, "overwrite")
        with staged.open("ab") as file:
            for function in functions:
                file.write(_function(function))


def _functions(responses: MeasuredResponses, nodes: list[int], frames: FloatArray) -> Iterable[bytes]:
    """Dataset 58 for each measured response function."""
    geometry = responses.geometry
    for row, (point, direction) in enumerate(zip(geometry.points, geometry.directions, strict=True)):
        component, sign = _component(frames[point], direction)
        for column, reference in enumerate(responses.reference_points):
            values = responses.values[row, column]
            if np.any(np.isnan(values)):
                continue
            other, other_sign = _component(frames[reference], responses.reference_directions[column])
            yield _function(
                UniversalFunction(
                    "frequency response function",
                    responses.frequencies / (2.0 * np.pi),
                    values,
                    _UNIT_LABELS[responses.motion],
                    responses.motion,
                    response=("NONE", nodes[point], sign * (component + 1)),
                    reference=("NONE", nodes[reference], other_sign * (other + 1)),
                    reference_unit="N",
                    reference_label="force",
                )
            )


def _function(function: UniversalFunction) -> bytes:
    """Dataset 58 in binary, double precision: no digit of the values is lost."""
    values = np.asarray(function.values)
    is_complex = np.iscomplexobj(values)
    columns = [values.real, values.imag] if is_complex else [values]
    start, spacing, is_even = 0.0, 0.0, function.kind == "time response"
    if is_even:
        start = float(function.abscissa[0])
        spacing = float((function.abscissa[-1] - start) / max(len(values) - 1, 1))
    else:
        columns.insert(0, function.abscissa)
    content = np.stack(columns, axis=1).astype("<f8").tobytes()
    titles = [*(_ascii(line, 80) for line in function.titles[:5]), *["NONE"] * 5][:5]
    axis, unit = (17, "s") if is_even else (18, "Hz")
    lines = [
        f"{-1:6d}",
        f"{58:6d}b{1:6d}{2:6d}{11:12d}{len(content):12d}{0:6d}{0:6d}{0:12d}{0:12d}",
        *titles,
        f"{_FUNCTIONS[function.kind]:5d}{0:10d}{0:5d}{0:10d}{_place(*function.response)}{_place(*function.reference)}",
        f"{6 if is_complex else 4:10d}{len(values):10d}{int(is_even):10d}{start:13.5e}{spacing:13.5e}{0.0:13.5e}",
        _axis(axis, "Time" if is_even else "Frequency", unit),
        _axis(_QUANTITIES.get(function.unit, _GENERAL), function.label, function.unit),
        _axis(_EXCITATIONS.get(function.reference_unit, 0), function.reference_label, function.reference_unit),
        _axis(0, "", ""),
    ]
    return "".join(f"{line:<80}\n" for line in lines).encode("ascii") + content + b"    -1\n"


_FUNCTIONS = {"time response": 1, "frequency response function": RESPONSE_FUNCTION, "spectrum": 12}
_GENERAL, _REACTION, _PRESSURE = 1, 9, 15  # specific data types: any quantity, a reaction force, a pressure
_QUANTITIES = {_UNIT_LABELS[motion]: number for number, motion in MOTIONS.items()} | {
    "m/s2": 12,
    "N": _REACTION,
    "Pa": _PRESSURE,
}
_EXCITATIONS = {"N": FORCE, "m": 8}


def _place(name: str, point: int, direction: int) -> str:
    return f" {_ascii(name, 10):<10}{point:10d}{direction:4d}"


def _axis(kind: int, label: str, unit: str) -> str:
    return f"{kind:10d}{0:5d}{0:5d}{0:5d} {_ascii(label, 20) or 'NONE':<20} {_ascii(unit, 20) or 'NONE':<20}"


def _ascii(text: str, longest: int) -> str:
    return text.encode("ascii", "replace").decode("ascii")[:longest].strip()
