"""Datasets of a universal file, checked: points (15, 2411), mode shapes (55, 2414), responses (58).

Points and functions are read by pyuff, which also reads files that break the format: a truncated block comes back as
arrays of unlike lengths, a binary block of the other byte order as meaningless numbers, a last block without its end
not at all: of a survey cut short at sixty places pyuff 2.5.8 reads every one without an error. So everything is checked
against the numbers that the file itself states, and 59 of the sixty are refused. Shapes are read in `nodal_data`.

Each point has three directions of motion. Mode shapes are real or complex, frequency response functions ASCII or
binary.
"""

import mmap
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured.nodal_data import NodalMode, read_nodal_mode
from gearwhine.housing.measured.survey_data import MeasuredGeometry, MeasuredModes, MeasuredResponses, Motion
from gearwhine.numerics.arrays import FloatArray

Dataset = dict[str, Any]

USED = {15: "points", 2411: "points", 18: "coordinate systems", 2420: "coordinate systems", 82: "trace lines"}
USED |= {55: "shapes", 2414: "analysis results", 58: "functions", 164: "units"}
"""Dataset numbers that are read, and their content."""

SHAPES = (55, 2414)
"""Dataset numbers with motions at nodes, each as a :class:`NodalMode` under the key ``mode``."""

LARGEST_FILE = 500_000_000
"""Size of the largest file that is read [bytes]."""

HEADER = 151  # program and date of the file; not used

_LONGEST_NUMBER_LINE = 200  # bytes within which a dataset's number stands
_MARKER = re.compile(rb"    -1(?=[\r\n]| {74}|\Z)")
_FIELDS_A_LINE = 6
_SANE = {8: 1e60, 4: 1e30}  # no measured number is larger than this nor, unless it is 0, smaller than its inverse


def read_datasets(path: Path) -> tuple[list[Dataset], tuple[str, ...]]:
    """Read the datasets in use here, in their order, and list the others.

    Raises
    ------
    MeasuredDataError
        Where the file cannot be read, is no universal file, is truncated, or a dataset contradicts its number.
    """
    import pyuff

    blocks = _blocks(path)
    try:
        file = pyuff.UFF(str(path))
        numbers = [int(kind) for kind in file.get_set_types()]
    except Exception as error:  # pyuff raises nothing narrower
        raise MeasuredDataError(f"{path.name} cannot be read as a universal file") from error
    if len(numbers) != len(blocks):
        raise MeasuredDataError(f"{path.name} cannot be read as a universal file: its lines '    -1' are not all alike")
    datasets: list[Dataset] = []
    others: dict[int, int] = {}
    for index, (number, block) in enumerate(zip(numbers, blocks, strict=True)):
        if number <= 0:
            raise MeasuredDataError(
                f"dataset {index + 1} of {path.name} has no number: the lines '    -1' do not stand in pairs, or what "
                "is between them is not text"
            )
        dataset = _read_one(file, block, index, number, path.name) if number in USED else None
        if dataset is not None:
            datasets.append(dataset)
        elif number != HEADER:
            others[number] = others.get(number, 0) + 1
    reasons = {55: ": no modes", 2414: ": no modes with motions at nodes"}
    remarks = [
        f"{count} of dataset {number} not read{reasons.get(number, '')}" for number, count in sorted(others.items())
    ]
    return datasets, tuple(remarks)


def _blocks(path: Path) -> list[bytes]:
    """Contents of the datasets that `nodal_data` reads, from the lines with their numbers on; of the others nothing."""
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE:
            raise MeasuredDataError(f"{path.name} has {size} bytes; expected at most {LARGEST_FILE // 10**6} MB")
        with path.open("rb") as file:
            content = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) if size else b""
            places = [(match.start(), match.end()) for match in _MARKER.finditer(content)]
            if not places:
                raise MeasuredDataError(
                    f"{path.name} is no universal file: no line in it is '    -1', which parts datasets"
                )
            if len(places) % 2:
                raise MeasuredDataError(f"{path.name} is cut short: its last dataset has no end, a line '    -1'")
            blocks = []
            for (_, start), (end, _) in zip(places[::2], places[1::2], strict=True):
                block = content[start : min(end, start + _LONGEST_NUMBER_LINE)].lstrip()
                shapes = block.split(maxsplit=1)[:1] in ([str(number).encode()] for number in SHAPES)
                blocks.append(content[start:end].lstrip() if shapes else b"")
            return blocks
    except OSError as error:
        raise MeasuredDataError(f"{path.name} cannot be read: {error.strerror}") from error


def _read_one(file: Any, block: bytes, index: int, number: int, name: str) -> Dataset | None:
    """Read a dataset; None of shapes that are no modes."""
    where = f"dataset {index + 1} of {name} ({number}, {USED[number]})"
    if number in SHAPES:
        mode = read_nodal_mode(block, number, where)
        return None if mode is None else {"type": number, "mode": mode}
    try:
        dataset: Dataset = file.read_sets(index)
    except Exception as error:  # pyuff raises nothing narrower
        raise MeasuredDataError(
            f"{where} cannot be read: its lines are not those of the format, or cut short"
        ) from error
    try:
        _CHECKS[number](dataset, where)
    except MeasuredDataError:
        raise
    except (KeyError, TypeError, ValueError) as error:  # what pyuff leaves of lines that are not those of the format
        raise MeasuredDataError(f"{where} cannot be read: its lines are not those of the format") from error
    return dataset


def _check_points(dataset: Dataset, where: str) -> None:
    keys = ("node_nums", "def_cs", "disp_cs", "x", "y", "z")
    _check_lengths(dataset, keys, where)
    for key in keys:
        _check_finite(np.asarray(dataset[key], dtype=np.float64), where)


def _check_systems(dataset: Dataset, where: str) -> None:
    keys: tuple[str, ...] = ("CS_sys_labels", "CS_types", "CS_matrices")
    if dataset["type"] == 18:
        keys = ("cs_num", "cs_type", "ref_cs_num", "ref_o", "x_point", "xz_point")
    _check_lengths(dataset, keys, where)
    for key in keys:
        _check_finite(np.asarray(dataset[key], dtype=np.float64), where)


def _check_lines(dataset: Dataset, where: str) -> None:
    if len(dataset["nodes"]) < dataset["n_nodes"]:
        raise MeasuredDataError(
            f"{where} says {dataset['n_nodes']} points and holds {len(dataset['nodes'])}: cut short"
        )


def _check_function(dataset: Dataset, where: str) -> None:
    _drop_filling(dataset)
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


def _drop_filling(dataset: Dataset) -> None:
    """Leave out zeros that fill the last line: some programs write every line whole, whatever the number of values."""
    count, values = int(dataset["num_pts"]), np.asarray(dataset["data"])
    surplus = len(values) - count
    if 0 < surplus < _FIELDS_A_LINE and not np.any(values[count:]):
        dataset |= {"data": values[:count], "x": dataset["x"][:count]}


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

    @cached_property
    def _places(self) -> dict[str, int]:
        return {label: place for place, label in enumerate(self.labels)}

    def index(self, node: float, where: str) -> int:
        """Return the index of a node in the list; an unknown node is an error."""
        place = self._places.get(str(int(node))) if np.isfinite(node) else None
        if place is None:
            raise MeasuredDataError(f"{where} names node {node:.9g}, which is not among the survey's points")
        return place

    def geometry(self, points: list[int], directions: list[FloatArray]) -> MeasuredGeometry:
        """Return the measured geometry of these points with some degrees of freedom."""
        return MeasuredGeometry(
            self.labels,
            self.positions,
            np.array(points, dtype=np.int64),
            np.array(directions, dtype=np.float64).reshape(-1, 3),
            self.lines,
        )


Frame = Literal["local", "global"]


def read_shapes(
    modes: Sequence[NodalMode], points: SurveyPoints | None, frame: Frame | None, remarks: list[str]
) -> MeasuredModes | None:
    """Make measured modes of those of a file; None where none of them vibrates.

    A direction in which every mode is exactly zero was not measured: the format has no other way to say so. A point
    left out of a mode, but not of all, is zero in it. Modes without points, or whose shapes are all zero, have
    frequencies and damping alone.

    Parameters
    ----------
    modes : sequence of NodalMode
    points : SurveyPoints or None
    frame : {"local", "global"}, optional
        Whether the three components of a point stand along its own directions, or along the axes; by default "local"
        of datasets 55 and "global" of datasets 2414.
    remarks : list of str
        Remarks for the user; the reader appends to it.

    Raises
    ------
    MeasuredDataError
        Where a node is unknown.
    """
    if rigid := sum(mode.frequency == 0.0 for mode in modes):
        what = "a rigid motion" if rigid == 1 else "rigid motions"
        remarks.append(f"{rigid} mode{'s' * (rigid > 1)} at 0 Hz not read: {what}")
    if any(mode.rotations for mode in modes):
        remarks.append("rotations of the shapes not read")
    if any(mode.hysteretic for mode in modes):
        remarks.append("damping ratios taken as half of the hysteretic ones, which are all that is given")
    modes = sorted((mode for mode in modes if mode.frequency > 0.0), key=lambda mode: mode.frequency)
    if not modes:
        return None
    frequencies = np.array([mode.frequency for mode in modes])
    ratios = np.array([mode.damping_ratio for mode in modes])
    damping = ratios if np.any(ratios != 0.0) else None
    if not any(np.any(mode.motions) for mode in modes):
        remarks.append("the shapes are zero everywhere: frequencies and damping are read alone")
        return MeasuredModes(frequencies, damping)
    if points is None:
        remarks.append("no points (dataset 15 or 2411): frequencies and damping are read without the shapes")
        return MeasuredModes(frequencies, damping)
    local = {55: frame != "global", 2414: frame == "local"}
    turned = bool(np.any(np.abs(points.directions - np.eye(3)) > 1e-12))
    if turned:
        for number in sorted({mode.number for mode in modes}):
            whose = "own" if local[number] else "common"
            remarks.append(f"shapes of dataset {number} taken to stand in the points' {whose} frame")
    # Where the frames differ, shapes in the common one are turned into the points' own.
    own = any(local[mode.number] for mode in modes)
    directions = points.directions if own else np.broadcast_to(np.eye(3), points.directions.shape)
    components = np.zeros((len(modes), len(points.labels), 3), dtype=np.complex128)
    for number, mode in enumerate(modes):
        rows = [points.index(node, f"mode {number + 1}") for node in mode.nodes]
        to_turn = own and not local[mode.number]
        motions = np.einsum("pij,pj->pi", points.directions[rows], mode.motions) if to_turn else mode.motions
        components[number, rows] = motions
    measured = np.argwhere(np.any(components != 0.0, axis=0))
    return MeasuredModes(
        frequencies=frequencies,
        damping_ratios=damping,
        shapes=components[:, measured[:, 0], measured[:, 1]],
        geometry=points.geometry(measured[:, 0].tolist(), list(directions[measured[:, 0], measured[:, 1]])),
    )


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


@dataclass(frozen=True)
class FileUnits:
    """Metres and newtons in the units of a file.

    Attributes
    ----------
    length, force : float
    """

    length: float = 1.0
    force: float = 1.0


def read_functions(
    datasets: Sequence[tuple[Dataset, FileUnits]], points: SurveyPoints, remarks: list[str]
) -> MeasuredResponses | None:
    """Read the frequency responses to forces from datasets 58; None where there are none.

    Parameters
    ----------
    datasets : sequence of (dict, FileUnits)
        Datasets, each with the units of its file; an axis that names its own unit goes before them.
    points : SurveyPoints
    remarks : list of str
        Remarks for the user; the reader appends to it.

    Raises
    ------
    MeasuredDataError
        Where a node is unknown, a pair stands twice, or functions have different frequencies or kinds of motion.
    """
    functions = [(dataset, units) for dataset, units in datasets if is_response(dataset)]
    if len(functions) < len(datasets):
        remarks.append(
            f"{len(datasets) - len(functions)} of dataset 58 not read: no frequency responses of motion to force"
        )
    if not functions:
        return None
    places = _frequencies(functions[0][0], remarks)
    motion = _motion([dataset for dataset, _ in functions], remarks)
    rows: dict[_Key, int] = {}
    columns: dict[_Key, int] = {}
    cells: dict[tuple[int, int], FloatArray] = {}
    for dataset, units in functions:
        frequencies = _frequencies(dataset, remarks)
        name = f"the function {dataset['rsp_node']}:{dataset['rsp_dir']} by {dataset['ref_node']}:{dataset['ref_dir']}"
        if len(frequencies) != len(places) or np.abs(frequencies - places).max() > _SPACING * places[-1]:
            raise MeasuredDataError(f"{name} has other frequencies than the first of the file")
        row = rows.setdefault((points.index(dataset["rsp_node"], name), int(dataset["rsp_dir"])), len(rows))
        column = columns.setdefault((points.index(dataset["ref_node"], name), int(dataset["ref_dir"])), len(columns))
        if (row, column) in cells:
            raise MeasuredDataError(f"{name} stands twice in the file")
        cells[row, column] = np.asarray(dataset["data"]) * _factor(dataset, units, remarks)
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


def is_response(dataset: Dataset) -> bool:
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


def _factor(dataset: Dataset, units: FileUnits, remarks: list[str]) -> float:
    """Factor from the function's unit to SI."""
    factors = []
    for axis, by_system in (("ordinate", units.length), ("orddenom", units.force)):
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
