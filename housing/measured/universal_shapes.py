"""Mode shapes of a universal file: dataset 55, real or complex."""

import numpy as np
import numpy.typing as npt

from housing.errors import MeasuredDataError
from housing.measured.modes import MeasuredModes
from housing.measured.survey_points import SurveyPoints
from housing.measured.universal_datasets import Dataset

FloatArray = npt.NDArray[np.float64]

NORMAL, COMPLEX_FIRST, COMPLEX_SECOND = 2, 3, 7  # analysis types that are modes
_COMPONENTS = ("r1", "r2", "r3")


def read_shapes(
    datasets: list[Dataset], points: SurveyPoints, directions: FloatArray, remarks: list[str]
) -> MeasuredModes | None:
    """The modes of some datasets 55; None where none of them is a mode.

    A direction in which every mode is exactly zero was not measured: the format has no other way to say so. A point
    left out of a mode, but not of all, is zero in it.

    Parameters
    ----------
    datasets : list of dict
    points : SurveyPoints
    directions : ndarray, shape (n_points, 3, 3)
        The directions, as rows, that the three components of a point stand along.
    remarks : list of str
        Is added to.

    Raises
    ------
    MeasuredDataError
        Where a node is unknown, or an eigenvalue is none of a vibration.
    """
    kept = [one for one in datasets if one["analysis_type"] in (NORMAL, COMPLEX_FIRST, COMPLEX_SECOND)]
    if len(kept) < len(datasets):
        remarks.append(f"{len(datasets) - len(kept)} of dataset 55 not read: no modes")
    if any("r4" in one for one in kept):
        remarks.append("rotations of the shapes not read")
    if not kept:
        return None
    components = np.zeros((len(kept), len(points.labels), 3), dtype=np.complex128)
    frequencies, ratios = np.empty(len(kept)), np.empty(len(kept))
    for number, dataset in enumerate(kept):
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
