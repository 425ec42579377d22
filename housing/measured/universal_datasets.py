"""Datasets of a universal file, read by pyuff and each checked to be whole.

pyuff also reads files that break the format: a truncated block comes back as arrays of unlike lengths, a binary block
of the other byte order as meaningless numbers, a last block without its end not at all. So everything is checked
against the numbers that the file itself states.
"""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from housing.errors import MeasuredDataError

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
    found: list[Dataset] = []
    others: dict[int, int] = {}
    for index, number in enumerate(int(kind) for kind in file.get_set_types()):
        if number <= 0:
            raise MeasuredDataError(
                f"dataset {index + 1} of {path.name} has no number: the lines '    -1' do not stand in pairs, or what "
                "is between them is not text"
            )
        if number in USED:
            found.append(_read_one(file, index, number, path.name))
        elif number != HEADER:
            others[number] = others.get(number, 0) + 1
    remarks = [f"{count} of dataset {number} not read" for number, count in sorted(others.items())]
    return found, tuple(remarks)


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
