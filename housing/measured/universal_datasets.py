"""Datasets of a universal file, read by pyuff and checked: points (15, 2411), mode shapes (55), responses (58).

pyuff also reads files that break the format: a truncated block comes back as arrays of unlike lengths, a binary block
of the other byte order as meaningless numbers, a last block without its end not at all: of a survey cut short at sixty
places pyuff 2.5.8 reads every one without an error. So everything is checked against the numbers that the file itself
states, and 59 of the sixty are refused.

Each point has three directions of motion. Mode shapes are real or complex, frequency response functions ASCII or
binary.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured.survey_data import MeasuredGeometry, MeasuredModes, MeasuredResponses, Motion

FloatArray = npt.NDArray[np.float64]

Dataset = dict[str, Any]

USED = {15: "points", 2411: "points", 18: "coordinate systems", 2420: "coordinate systems", 82: "trace lines"}
USED |= {55: "shapes", 58: "functions", 164: "units"}
"""Dataset numbers that are read, and their content."""

HEADER = 151  # program and date of the file; not used

_MARKER = re.compile(rb"    -1(?=[\r\n]| {74}|\Z)")
_SANE = {8: 1e60, 4: 1e30}  # no measured number is larger than this nor, unless it is 0, smaller than its inverse


def read_datasets(path: Path) -> tuple[list[Dataset], tuple[str, ...]]:
    """Read the datasets in use here, in their order, and list the others.

    Raises
    ------
    MeasuredDataError
        Where the file cannot be read, is no universal file, is truncated, or a dataset contradicts its number.
    """
    import pyuff

    try:
        content = path.read_bytes()
    except OSError as error:
        raise MeasuredDataError(f"{path.name} cannot be read: {error.strerror}") from error
    markers = len(_MARKER.findall(content))
    if markers == 0:
        raise MeasuredDataError(f"{path.name} is no universal file: no line in it is '    -1', which parts datasets")
    if markers % 2:
        raise MeasuredDataError(f"{path.name} is cut short: its last dataset has no end, a line '    -1'")
    try:
        file = pyuff.UFF(str(path))
    except Exception as error:  # pyuff raises nothing narrower
        raise MeasuredDataError(f"{path.name} cannot be read as a universal file") from error
    datasets: list[Dataset] = []
    others: dict[int, int] = {}
    for index, number in enumerate(int(kind) for kind in file.get_set_types()):
        if number <= 0:
            raise MeasuredDataError(
                f"dataset {index + 1} of {path.name} has no number: the lines '    -1' do not stand in pairs, or what "
                "is between them is not text"
            )
        if number in USED:
            datasets.append(_read_one(file, index, number, path.name))
        elif number != HEADER:
            others[number] = others.get(number, 0) + 1
    remarks = [f"{count} of dataset {number} not read" for number, count in sorted(others.items())]
    return datasets, tuple(remarks)


def _read_one(file: Any, index: int, number: int, name: str) -> Dataset:
    where = f"dataset {index + 1} of {name} ({number}, {USED[number]})"
    try:
        dataset: Dataset = file.read_sets(index)
    except Exception as error:  # pyuff raises nothing narrower
        raise MeasuredDataError(
            f"{where} cannot be read: its lines are not those of the format, or cut short"
        ) from error
    _CHECKS[number](dataset, where)
    return dataset


def _check_points(dataset: Dataset, where: str) -> None:
    keys = ("node_nums", "def_cs", "disp_cs", "x", "y", "z")
    _check_lengths(dataset, keys, where)
    for key in keys:
        _check_finite(np.asarray(dataset[key], dtype=np.float64), where)


def _check_systems(dataset: Dataset, where: str) -> None:
    if dataset["type"] == 18:
        _check_lengths(dataset, ("cs_num", "cs_type", "ref_cs_num", "ref_o", "x_point", "xz_point"), where)
    else:
        _check_lengths(dataset, ("CS_sys_labels", "CS_types", "CS_matrices"), where)


def _check_lines(dataset: Dataset, where: str) -> None:
    if len(dataset["nodes"]) < dataset["n_nodes"]:
        raise MeasuredDataError(
            f"{where} says {dataset['n_nodes']} points and holds {len(dataset['nodes'])}: cut short"
        )


def _check_shapes(dataset: Dataset, where: str) -> None:
    components = [key for key in ("r1", "r2", "r3") if key in dataset]
    if len(components) < 3:
        raise MeasuredDataError(f"{where} has no three components of motion at each point")
    _check_lengths(dataset, ("node_nums", *components), where)
    for key in components:
        _check_finite(np.asarray(dataset[key]), where)


def _check_function(dataset: Dataset, where: str) -> None:
    values, places = np.asarray(dataset["data"]), np.asarray(dataset["x"], dtype=np.float64)
    if len(values) != dataset["num_pts"] or len(places) != len(values):
        raise MeasuredDataError(f"{where} says {dataset['num_pts']} values and holds {len(values)}: cut short")
    if not dataset["binary"]:
        _check_finite(values, where)
        return
    size = 4 if dataset["ord_data_type"] in (2, 5) else 8
    numbers = np.concatenate([values.real, values.imag, places if dataset["abscissa_spacing"] == 0 else []])
    if _is_sane(numbers, size):
        return
    with np.errstate(over="ignore", invalid="ignore"):
        swapped = numbers.astype(f"f{size}").byteswap()
    if _is_sane(swapped, size):
        order = "little" if dataset["byte_ordering"] == 1 else "big"
        raise MeasuredDataError(
            f"the bytes of {where} are swapped: it says that they are {order}-endian, and they make sense the other way"
        )
    raise MeasuredDataError(f"{where} holds numbers of no meaning: {numbers[:3]}; its binary part is not what it says")


def _check_units(dataset: Dataset, where: str) -> None:
    for key in ("length", "force"):
        if not (np.isfinite(dataset[key]) and dataset[key] > 0.0):
            raise MeasuredDataError(f"{where} has {dataset[key]!r} as its factor of {key}; expected a number above 0")


_CHECKS: dict[int, Callable[[Dataset, str], None]] = {
    15: _check_points,
    2411: _check_points,
    18: _check_systems,
    2420: _check_systems,
    82: _check_lines,
    55: _check_shapes,
    58: _check_function,
    164: _check_units,
}


def _check_lengths(dataset: Dataset, keys: tuple[str, ...], where: str) -> None:
    lengths = {key: len(dataset[key]) for key in keys}
    if len(set(lengths.values())) > 1:
        raise MeasuredDataError(f"{where} is cut short: it holds {lengths}, expected as many of each")


def _check_finite(values: npt.NDArray[Any], where: str) -> None:
    if not np.all(np.isfinite(values)):
        raise MeasuredDataError(f"{where} holds a value that is not finite")


def _is_sane(numbers: npt.NDArray[Any], size: int) -> bool:
    """Whether numbers may have been measured: finite, and none absurdly large or small."""
    sizes = np.abs(numbers[numbers != 0.0])
    limit = _SANE[size]
    return bool(np.all(np.isfinite(sizes)) and np.all((sizes < limit) & (sizes > 1.0 / limit)))


@dataclass(frozen=True)
class SurveyPoints:
    """The points of a universal file.

    Attributes
    ----------
    labels : tuple of str
    positions : ndarray, shape (n_points, 3)
        Positions [m].
    directions : ndarray, shape (n_points, 3, 3)
        The point's own three directions of motion, as rows.
    lines : tuple of tuple of int
    """

    labels: tuple[str, ...]
    positions: FloatArray
    directions: FloatArray
    lines: tuple[tuple[int, ...], ...]

    def index(self, node: float, where: str) -> int:
        """Return the index of a node in the list; an unknown node is an error."""
        try:
            return self.labels.index(str(int(node)))
        except ValueError:
            raise MeasuredDataError(f"{where} names node {int(node)}, which is not among the survey's points") from None

    def geometry(self, points: list[int], directions: list[FloatArray]) -> MeasuredGeometry:
        """Return the measured geometry of these points with some degrees of freedom."""
        return MeasuredGeometry(
            self.labels,
            self.positions,
            np.array(points, dtype=np.int64),
            np.array(directions, dtype=np.float64).reshape(-1, 3),
            self.lines,
        )


NORMAL, COMPLEX_FIRST, COMPLEX_SECOND = 2, 3, 7  # analysis types that are modes
_COMPONENTS = ("r1", "r2", "r3")


def read_shapes(
    datasets: list[Dataset], points: SurveyPoints, directions: FloatArray, remarks: list[str]
) -> MeasuredModes | None:
    """Read the mode shapes of datasets 55; None where none of them is a mode.

    A direction in which every mode is exactly zero was not measured: the format has no other way to say so. A point
    left out of a mode, but not of all, is zero in it.

    Parameters
    ----------
    datasets : list of dict
    points : SurveyPoints
    directions : ndarray, shape (n_points, 3, 3)
        The directions, as rows, that the three components of a point stand along.
    remarks : list of str
        Remarks for the user; the reader appends to it.

    Raises
    ------
    MeasuredDataError
        Where a node is unknown, or an eigenvalue is none of a vibration.
    """
    modal = [dataset for dataset in datasets if dataset["analysis_type"] in (NORMAL, COMPLEX_FIRST, COMPLEX_SECOND)]
    if len(modal) < len(datasets):
        remarks.append(f"{len(datasets) - len(modal)} of dataset 55 not read: no modes")
    if any("r4" in one for one in modal):
        remarks.append("rotations of the shapes not read")
    if not modal:
        return None
    components = np.zeros((len(modal), len(points.labels), 3), dtype=np.complex128)
    frequencies, ratios = np.empty(len(modal)), np.empty(len(modal))
    for number, dataset in enumerate(modal):
        where = f"mode {number + 1}"
        frequencies[number], ratios[number] = _pole(dataset, where)
        rows = [points.index(node, where) for node in dataset["node_nums"]]
        components[number, rows] = np.stack([dataset[key] for key in _COMPONENTS], axis=-1)
    order = np.argsort(frequencies, kind="stable")
    measured = np.argwhere(np.any(components != 0.0, axis=0))
    if not len(measured):
        raise MeasuredDataError("every shape of the file is zero everywhere")
    geometry = points.geometry(measured[:, 0].tolist(), [directions[point, component] for point, component in measured])
    return MeasuredModes(
        frequencies=frequencies[order],
        damping_ratios=ratios[order] if np.any(ratios != 0.0) else None,
        shapes=components[order][:, measured[:, 0], measured[:, 1]],
        geometry=geometry,
    )


def _pole(dataset: Dataset, where: str) -> tuple[float, float]:
    """Natural frequency [rad/s] and damping ratio of one mode."""
    if dataset["analysis_type"] == NORMAL:
        frequency, ratio = 2.0 * np.pi * float(dataset["freq"]), float(dataset["modal_damp_vis"])
    else:
        eigenvalue = complex(dataset["eig"])
        frequency = abs(eigenvalue)
        ratio = -eigenvalue.real / frequency if frequency else 0.0
    if not (np.isfinite(frequency) and frequency > 0.0 and abs(ratio) < 1.0):
        raise MeasuredDataError(
            f"{where} has frequency {frequency / (2.0 * np.pi):g} Hz and damping ratio {ratio:g}; expected those of a "
            "vibration"
        )
    return frequency, ratio


RESPONSE_FUNCTION = 4  # function type of a frequency response
FORCE = 13  # specific data type of an excitation force
MOTIONS: dict[int, Motion] = {8: "displacement", 11: "velocity", 12: "acceleration"}
"""Measured quantity, by specific data type."""

_SPACING = 1e-6  # largest difference of two functions' frequencies, as a part of the highest: six digits are written
_GRAVITY = 9.80665
_LABELS = {
    "m": 1.0,
    "mm": 1e-3,
    "cm": 1e-2,
    "in": 0.0254,
    "ft": 0.3048,
    "m/s": 1.0,
    "mm/s": 1e-3,
    "cm/s": 1e-2,
    "in/s": 0.0254,
    "ft/s": 0.3048,
    "m/s^2": 1.0,
    "m/s2": 1.0,
    "mm/s^2": 1e-3,
    "mm/s2": 1e-3,
    "cm/s^2": 1e-2,
    "cm/s2": 1e-2,
    "in/s^2": 0.0254,
    "in/s2": 0.0254,
    "ft/s^2": 0.3048,
    "ft/s2": 0.3048,
    "g": _GRAVITY,
    "n": 1.0,
    "kn": 1e3,
    "lbf": 4.4482216152605,
}  # units as their labels are written
_HERTZ = {"hz": 1.0, "khz": 1e3, "rpm": 1.0 / 60.0, "cpm": 1.0 / 60.0}
_HERTZ |= dict.fromkeys(("rad/s", "rad/sec", "rads/s", "rads/sec"), 1.0 / (2.0 * np.pi))
"""Units of frequency by their labels [Hz]."""
_UNLABELLED = ("", "none")

_Key = tuple[int, int]


def read_functions(
    datasets: list[Dataset], points: SurveyPoints, length: float, force: float, remarks: list[str]
) -> MeasuredResponses | None:
    """Read the frequency responses to forces from datasets 58; None where there are none.

    Parameters
    ----------
    datasets : list of dict
    points : SurveyPoints
    length, force : float
        Metres and newtons in the file's units; an axis that names its own unit goes before them.
    remarks : list of str
        Remarks for the user; the reader appends to it.

    Raises
    ------
    MeasuredDataError
        Where a node is unknown, a pair stands twice, or functions have different frequencies or kinds of motion.
    """
    functions = [dataset for dataset in datasets if _is_response(dataset)]
    if len(functions) < len(datasets):
        remarks.append(
            f"{len(datasets) - len(functions)} of dataset 58 not read: no frequency responses of motion to force"
        )
    if not functions:
        return None
    places = _frequencies(functions[0], remarks)
    motion = _motion(functions, remarks)
    rows: dict[_Key, int] = {}
    columns: dict[_Key, int] = {}
    cells: dict[tuple[int, int], FloatArray] = {}
    for dataset in functions:
        frequencies = _frequencies(dataset, remarks)
        name = f"the function {dataset['rsp_node']}:{dataset['rsp_dir']} by {dataset['ref_node']}:{dataset['ref_dir']}"
        if len(frequencies) != len(places) or np.abs(frequencies - places).max() > _SPACING * places[-1]:
            raise MeasuredDataError(f"{name} has other frequencies than the first of the file")
        row = rows.setdefault((points.index(dataset["rsp_node"], name), int(dataset["rsp_dir"])), len(rows))
        column = columns.setdefault((points.index(dataset["ref_node"], name), int(dataset["ref_dir"])), len(columns))
        if (row, column) in cells:
            raise MeasuredDataError(f"{name} stands twice in the file")
        cells[row, column] = np.asarray(dataset["data"]) * _factor(dataset, length, force, remarks)
    values = np.full((len(rows), len(columns), len(places)), np.nan, dtype=np.complex128)
    for (row, column), cell in cells.items():
        values[row, column] = cell
    return MeasuredResponses(
        geometry=points.geometry([point for point, _ in rows], [_direction(points, key) for key in rows]),
        reference_points=np.array([point for point, _ in columns], dtype=np.int64),
        reference_directions=np.array([_direction(points, key) for key in columns]),
        frequencies=places,
        values=values,
        motion=motion,
    )


def _is_response(dataset: Dataset) -> bool:
    """Whether a function is the frequency response of a translation to a force; a denominator not named is one."""
    translations = all(1 <= abs(int(dataset[key])) <= 3 for key in ("rsp_dir", "ref_dir"))
    by_force = int(dataset.get("orddenom_spec_data_type", 0)) in (0, FORCE)
    return bool(dataset["func_type"] == RESPONSE_FUNCTION and translations and by_force)


def _direction(points: SurveyPoints, key: _Key) -> FloatArray:
    point, component = key
    return np.asarray(np.sign(component) * points.directions[point, abs(component) - 1])


def _motion(datasets: list[Dataset], remarks: list[str]) -> Motion:
    types = {int(dataset.get("ordinate_spec_data_type", 0)) for dataset in datasets}
    if len(types) > 1:
        raise MeasuredDataError(
            f"the functions are of several kinds (specific data types {sorted(types)}); expected one"
        )
    number = types.pop()
    if number not in MOTIONS:
        remarks.append(f"functions of specific data type {number} taken for accelerations")
    return MOTIONS.get(number, "acceleration")


def _factor(dataset: Dataset, length: float, force: float, remarks: list[str]) -> float:
    """Factor from the function's unit to SI."""
    factors = []
    for axis, by_system in (("ordinate", length), ("orddenom", force)):
        label = _label(dataset, axis)
        by_label = _LABELS.get(label, by_system)
        if label not in _LABELS and label not in _UNLABELLED:
            _remark(remarks, f"functions' unit {label!r} not known, taken in the file's system of units")
        elif not np.isclose(by_label, by_system, rtol=1e-6):
            _remark(remarks, f"functions taken in {label}, as their axis says, and not in the file's system of units")
        factors.append(by_label)
    return float(factors[0] / factors[1])


def _frequencies(dataset: Dataset, remarks: list[str]) -> FloatArray:
    """Frequencies of a function [rad/s]: the format has them in hertz, unless their axis names another unit."""
    label = _label(dataset, "abscissa")
    hertz = _HERTZ.get(label, 1.0)
    if label not in _HERTZ and label not in _UNLABELLED:
        _remark(remarks, f"unit {label!r} of the functions' frequencies not known, taken in Hz")
    elif hertz != 1.0:
        _remark(remarks, f"frequencies of the functions taken in {label}, as their axis says")
    return np.asarray(2.0 * np.pi * hertz * np.asarray(dataset["x"], dtype=np.float64))


def _label(dataset: Dataset, axis: str) -> str:
    """Return the unit that an axis names, in small letters and without blanks."""
    written = str(dataset.get(f"{axis}_axis_units_lab", ""))
    return written.strip().lower().replace(" ", "").replace("**", "^")


def _remark(remarks: list[str], remark: str) -> None:
    if remark not in remarks:
        remarks.append(remark)
