"""Surveys for the tests of universal files: of our own making, and as pyuff writes them."""

from pathlib import Path
from typing import Any

import numpy as np
import pyuff

from gearwhine.housing.measured import MeasuredGeometry, MeasuredModes, MeasuredResponses, SurveyData, write_universal

SIX_DIGITS = 1e-5  # of E13.5, in which shapes and frequencies are written


def survey(*, seed: int = 0, complex_shapes: bool = True, damping: bool = True) -> SurveyData:
    """Eight points with one to three directions each, some of them askew; two modes and responses to two forces."""
    rng = np.random.default_rng(seed)
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    points = np.array([0, 0, 0, 1, 2, 3, 3, 4, 5, 6, 7])
    directions = np.array([*np.eye(3), [0, 0, -1], [0, 1, 0], frame[0], frame[1], frame[2], *-np.eye(3)])
    geometry = MeasuredGeometry(
        tuple(str(number) for number in (11, 12, 13, 14, 15, 16, 17, 28)),
        rng.normal(size=(8, 3)),
        points,
        directions,
        ((0, 1, 2, 3, 0), (4, 5)),
    )
    shapes = rng.normal(size=(2, 11)) + (1j * rng.normal(size=(2, 11)) if complex_shapes else 0.0)
    modes = MeasuredModes(
        2 * np.pi * np.array([658.123, 1049.5]), np.array([0.01, 0.02]) if damping else None, shapes + 0j, geometry
    )
    values = rng.normal(size=(11, 2, 50)) + 1j * rng.normal(size=(11, 2, 50))
    responses = MeasuredResponses(
        geometry,
        np.array([1, 3]),
        np.array([[0, 0, -1.0], frame[0]]),
        2 * np.pi * np.arange(1, 51) * 1.00019535,
        values,
        "acceleration",
    )
    return SurveyData(geometry, modes, responses)


def one_function(path: Path) -> Path:
    given = survey().responses
    geometry = MeasuredGeometry(
        given.geometry.labels, given.geometry.positions, given.geometry.points[:1], given.geometry.directions[:1]
    )
    only = MeasuredResponses(geometry, np.array([1]), np.array([[0, 0, -1.0]]), given.frequencies, given.values[:1, :1])
    write_universal(path, SurveyData(geometry, None, only))
    return path


def motion(geometry: MeasuredGeometry, values: Any) -> dict[tuple[str, int], Any]:
    """Motion of each point along the survey's axes, whatever directions say it, shape (..., 3)."""
    found: dict[tuple[str, int], Any] = {}
    for dof, (point, direction) in enumerate(zip(geometry.points, geometry.directions, strict=True)):
        for axis in range(3):
            key = (geometry.labels[point], axis)
            found[key] = found.get(key, 0.0) + values[dof] * direction[axis]
    return found


def same_motion(one: dict[Any, Any], other: dict[Any, Any], tolerance: float) -> None:
    assert set(one) == set(other)
    for key, values in one.items():
        np.testing.assert_allclose(other[key], values, atol=tolerance)


def by_pyuff(path: Path, *datasets: dict[str, Any]) -> Path:
    pyuff.UFF(str(path)).write_sets([dict(dataset) for dataset in datasets], "overwrite")
    return path


POINTS = {"type": 15, "node_nums": [1, 2, 3], "x": [0.0, 100.0, 0.0], "y": [0.0, 0.0, 200.0], "z": [5.0, 5.0, 5.0]}
MILLIMETRES = {"type": 164, "units_code": 5, "length": 1000.0, "force": 1000.0, "temp": 1.0, "temp_offset": 273.15}
SHAPE = {"type": 55, "analysis_type": 2, "data_ch": 2, "spec_data_type": 8, "load_case": 1, "mode_n": 1, "freq": 120.0}
SHAPE |= {"node_nums": [1, 2, 3], "r1": np.zeros(3), "r2": np.array([1.0, 2.0, 3.0]), "r3": np.array([0.0, 0.5, 0.0])}
FUNCTION = {"type": 58, "func_type": 4, "rsp_node": 2, "rsp_dir": 3, "ref_node": 1, "ref_dir": -2, "binary": 0}
FUNCTION |= {"ordinate_spec_data_type": 12, "orddenom_spec_data_type": 13, "abscissa_spacing": 1}
FUNCTION |= {"x": np.arange(1.0, 11.0), "data": np.arange(10) + 1j * np.arange(10, 20)}
