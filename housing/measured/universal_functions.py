"""Frequency response functions of a universal file: dataset 58, ASCII or binary."""

import numpy as np
import numpy.typing as npt

from housing.errors import MeasuredDataError
from housing.measured.responses import MeasuredResponses, Motion
from housing.measured.survey_points import SurveyPoints
from housing.measured.universal_datasets import Dataset

FloatArray = npt.NDArray[np.float64]

RESPONSE_FUNCTION = 4  # function type of a frequency response
FORCE = 13  # specific data type of an excitation force
MOTIONS: dict[int, Motion] = {8: "displacement", 11: "velocity", 12: "acceleration"}
"""Measured quantity, by specific data type."""

_SPACING = 1e-6  # largest difference of two functions' frequencies, as a part of the highest: six digits are written
_GRAVITY = 9.80665
_LABELS = {
    "m": 1.0,
    "mm": 1e-3,
    "in": 0.0254,
    "m/s": 1.0,
    "mm/s": 1e-3,
    "in/s": 0.0254,
    "m/s^2": 1.0,
    "m/s2": 1.0,
    "mm/s^2": 1e-3,
    "mm/s2": 1e-3,
    "in/s^2": 0.0254,
    "g": _GRAVITY,
    "n": 1.0,
    "kn": 1e3,
    "lbf": 4.4482216152605,
}  # units as their labels are written

_Key = tuple[int, int]


def read_functions(
    datasets: list[Dataset], points: SurveyPoints, length: float, force: float, remarks: list[str]
) -> MeasuredResponses | None:
    """The frequency responses to forces among some functions; None where there are none.

    Parameters
    ----------
    datasets : list of dict
    points : SurveyPoints
    length, force : float
        Metres and newtons in the file's units; an axis that names its own unit goes before them.
    remarks : list of str
        Is added to.

    Raises
    ------
    MeasuredDataError
        Where a node is unknown, a pair stands twice, or functions have different frequencies or kinds of motion.
    """
    kept = [one for one in datasets if _is_response(one)]
    if len(kept) < len(datasets):
        remarks.append(f"{len(datasets) - len(kept)} of dataset 58 not read: no frequency responses of motion to force")
    if not kept:
        return None
    places = 2.0 * np.pi * np.asarray(kept[0]["x"], dtype=np.float64)
    motion = _motion(kept, remarks)
    rows: dict[_Key, int] = {}
    columns: dict[_Key, int] = {}
    cells: dict[tuple[int, int], FloatArray] = {}
    for dataset in kept:
        here = 2.0 * np.pi * np.asarray(dataset["x"], dtype=np.float64)
        name = f"the function {dataset['rsp_node']}:{dataset['rsp_dir']} by {dataset['ref_node']}:{dataset['ref_dir']}"
        if len(here) != len(places) or np.abs(here - places).max() > _SPACING * places[-1]:
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
    found = {int(one.get("ordinate_spec_data_type", 0)) for one in datasets}
    if len(found) > 1:
        raise MeasuredDataError(
            f"the functions are of several kinds (specific data types {sorted(found)}); expected one"
        )
    number = found.pop()
    if number not in MOTIONS:
        remarks.append(f"functions of specific data type {number} taken for accelerations")
    return MOTIONS.get(number, "acceleration")


def _factor(dataset: Dataset, length: float, force: float, remarks: list[str]) -> float:
    """From the function's unit to SI."""
    factors = []
    for axis, by_system in (("ordinate", length), ("orddenom", force)):
        label = str(dataset.get(f"{axis}_axis_units_lab", "")).strip().lower().replace(" ", "").replace("**", "^")
        own = _LABELS.get(label, by_system)
        if not np.isclose(own, by_system, rtol=1e-6):
            remark = f"functions taken in {label}, as their axis says, and not in the file's system of units"
            if remark not in remarks:
                remarks.append(remark)
        factors.append(own)
    return float(factors[0] / factors[1])
