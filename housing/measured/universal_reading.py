"""Reader of universal files: points, shapes and responses of a survey, in SI and one frame.

Cartesian, cylindrical and spherical coordinate systems of the file are resolved into the survey's frame.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured.survey_data import MeasuredModes, SurveyData
from gearwhine.housing.measured.universal_datasets import (
    Dataset,
    SurveyPoints,
    read_datasets,
    read_functions,
    read_shapes,
)
from gearwhine.meshes.lengths import UNITS

FloatArray = npt.NDArray[np.float64]

CARTESIAN, CYLINDRICAL, SPHERICAL = 0, 1, 2
_DEEPEST = 100  # systems within each other, beyond which they count as a circle


@dataclass(frozen=True)
class CoordinateSystem:
    """A coordinate system: kind, origin and axes.

    Attributes
    ----------
    axes : ndarray, shape (3, 3)
        The frame's x, y, z axes as rows, unit vectors in the survey's frame.
    origin : ndarray, shape (3,)
        Origin in the file's unit of length.
    kind : {0, 1, 2}
        Cartesian; cylindrical r, θ, z; spherical r, θ (about z, from x), φ (from z); angles in degrees.
    """

    axes: FloatArray
    origin: FloatArray
    kind: int = CARTESIAN

    def position(self, coordinates: FloatArray) -> FloatArray:
        """Return the place in the survey's frame of three coordinates in this system."""
        local = coordinates
        if self.kind != CARTESIAN:
            radius, turn = coordinates[0], np.deg2rad(coordinates[1])
            height = coordinates[2]
            if self.kind == SPHERICAL:
                tilt = np.deg2rad(coordinates[2])
                radius, height = radius * np.sin(tilt), radius * np.cos(tilt)
            local = np.array([radius * np.cos(turn), radius * np.sin(turn), height])
        return np.asarray(self.origin + local @ self.axes)

    def directions(self, position: FloatArray) -> FloatArray:
        """Return the three directions of motion at a place of the survey's frame, as rows, shape (3, 3)."""
        if self.kind == CARTESIAN:
            return self.axes
        x, y, z = self.axes @ (position - self.origin)
        turn = np.arctan2(y, x)
        outward = np.array([np.cos(turn), np.sin(turn), 0.0])
        around = np.array([-np.sin(turn), np.cos(turn), 0.0])
        if self.kind == CYLINDRICAL:
            return np.asarray(np.stack([outward, around, [0.0, 0.0, 1.0]]) @ self.axes)
        tilt = np.arctan2(np.hypot(x, y), z)
        upward = np.array([0.0, 0.0, 1.0])
        radial = np.sin(tilt) * outward + np.cos(tilt) * upward
        downward = np.cos(tilt) * outward - np.sin(tilt) * upward
        return np.asarray(np.stack([radial, around, downward]) @ self.axes)


GLOBAL = CoordinateSystem(np.eye(3), np.zeros(3))


def systems_of(datasets: list[dict[str, Any]]) -> dict[int, CoordinateSystem]:
    """Read the coordinate systems of a universal file, datasets 18 and 2420, by number; 0 is the survey's own frame.

    Dataset 18 gives the origin, a point on +x and a point on the +xz plane in another system. Dataset 2420 gives a
    matrix of four rows, read as row vectors are multiplied: rows 1 to 3 are the axes x, y, z, row 4 the origin.

    Raises
    ------
    MeasuredDataError
        Where axes are not perpendicular unit vectors, points coincide or systems refer to each other in a circle.
    """
    systems: dict[int, tuple[int, CoordinateSystem]] = {}
    for dataset in datasets:
        if dataset["type"] == 18:
            for index, number in enumerate(dataset["cs_num"]):
                axes = _axes_from_points(
                    int(number), *(np.asarray(dataset[key][index]) for key in ("ref_o", "x_point", "xz_point"))
                )
                system = CoordinateSystem(axes, np.asarray(dataset["ref_o"][index]), _kind(dataset["cs_type"][index]))
                systems[int(number)] = (int(dataset["ref_cs_num"][index]), system)
        elif dataset["type"] == 2420:
            for number, kind, matrix in zip(
                dataset["CS_sys_labels"], dataset["CS_types"], dataset["CS_matrices"], strict=True
            ):
                if np.abs(matrix[:3] @ matrix[:3].T - np.eye(3)).max() > 1e-4:
                    raise MeasuredDataError(f"the axes of coordinate system {number} are no perpendicular unit vectors")
                systems[int(number)] = (0, CoordinateSystem(_square(matrix[:3]), matrix[3], _kind(kind)))
    return {0: GLOBAL} | {number: _resolved(number, systems) for number in systems}


def _resolved(number: int, systems: Mapping[int, tuple[int, CoordinateSystem]]) -> CoordinateSystem:
    """Resolve a coordinate system into the survey's frame, through the systems in which it is given."""
    within, system = systems[number]
    for _ in range(_DEEPEST):
        if within == 0 or within == number or within not in systems:
            return system
        outer_within, outer = systems[within]
        system = CoordinateSystem(system.axes @ outer.axes, outer.origin + system.origin @ outer.axes, system.kind)
        within = outer_within
    raise MeasuredDataError(f"coordinate system {number} is given in others that refer to each other in a circle")


def _axes_from_points(number: int, origin: FloatArray, on_x: FloatArray, on_xz: FloatArray) -> FloatArray:
    x, xz = on_x - origin, on_xz - origin
    y = np.cross(xz, x)
    if not np.linalg.norm(y) > 1e-9 * np.linalg.norm(x) * np.linalg.norm(xz):
        raise MeasuredDataError(f"the three points of coordinate system {number} lie on one line")
    x, y = x / np.linalg.norm(x), y / np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)])


def _square(axes: FloatArray) -> FloatArray:
    """Return the perpendicular unit vectors nearest to three that are perpendicular within a file's digits."""
    left, _, right = np.linalg.svd(axes)
    return np.asarray(left @ right)


def _kind(number: float) -> int:
    if int(number) not in (CARTESIAN, CYLINDRICAL, SPHERICAL):
        raise MeasuredDataError(
            f"coordinate system of type {number:g}; expected 0 (Cartesian), 1 (cylindrical) or 2 (spherical)"
        )
    return int(number)


Frame = Literal["local", "global"]


def read_universal(path: str | Path, *, unit: str | None = None, shape_frame: Frame = "local") -> SurveyData:
    """Read a universal file: points (15, 2411), trace lines (82), shapes (55), responses (58), units (164).

    Parameters
    ----------
    path : path
    unit : {"m", "mm", "cm", "in"}, optional
        Unit of the file's lengths, in place of its dataset 164. Without either a metre is assumed, with a remark.
    shape_frame : {"local", "global"}
        Frame of the shapes where points have a displacement system of their own. The format calls the vectors
        of dataset 55 global; programs for modal tests write them in the points' own directions, as measured.
        Functions (58) are always in the points' own directions.

    Raises
    ------
    MeasuredDataError
        Where the file is damaged, or names a point or coordinate system that it does not hold.
    """
    path = Path(path)
    datasets, passed_over = read_datasets(path)
    remarks = list(passed_over)
    length, force = _units(datasets, unit, remarks)
    points = _points(datasets, length, remarks)
    holds = {dataset["type"] for dataset in datasets}
    if points is None:
        if holds & {55, 58}:
            content = "shapes" if 55 in holds else "functions"
            raise MeasuredDataError(
                f"{path.name} holds {content} but no points (dataset 15 or 2411): nobody can tell where they were "
                "measured"
            )
        raise MeasuredDataError(f"{path.name} holds no points, shapes or functions (datasets 15 or 2411, 55, 58)")
    geometry = points.geometry([], [])
    modes: MeasuredModes | None = None
    turned = bool(np.any(np.abs(points.directions - np.eye(3)) > 1e-12))
    if 55 in holds:
        if turned:
            remarks.append(
                f"shapes taken to stand in the points' {'own' if shape_frame == 'local' else 'common'} frame"
            )
        directions = (
            points.directions if shape_frame == "local" else np.broadcast_to(np.eye(3), points.directions.shape)
        )
        modes = read_shapes([dataset for dataset in datasets if dataset["type"] == 55], points, directions, remarks)
    responses = None
    if 58 in holds:
        functions = [dataset for dataset in datasets if dataset["type"] == 58]
        responses = read_functions(functions, points, length, force, remarks)
    if modes is not None and modes.geometry is not None:
        geometry = modes.geometry
    elif responses is not None:
        geometry = responses.geometry
    return SurveyData(geometry, modes, responses, tuple(remarks))


def _units(datasets: list[Dataset], unit: str | None, remarks: list[str]) -> tuple[float, float]:
    """Metres in the file's unit of length, and newtons in its unit of force."""
    stated = [dataset for dataset in datasets if dataset["type"] == 164]
    if len({(one["length"], one["force"]) for one in stated}) > 1:
        raise MeasuredDataError("the file states several systems of units (dataset 164); expected one")
    force = 1.0 / stated[0]["force"] if stated else 1.0
    if unit is not None:
        if unit not in UNITS:
            raise MeasuredDataError(f"unit {unit!r}; expected one of {', '.join(UNITS)}")
        if stated and not np.isclose(UNITS[unit] * stated[0]["length"], 1.0, rtol=1e-6):
            remarks.append(f"lengths taken in {unit}, as told, and not as the file's dataset 164 states")
        return UNITS[unit], force
    if stated:
        return 1.0 / stated[0]["length"], force
    remarks.append("no units stated (dataset 164): lengths taken in metres, forces in newtons")
    return 1.0, force


def _points(datasets: list[Dataset], length: float, remarks: list[str]) -> SurveyPoints | None:
    """Positions in metres and directions of the points, their systems resolved; None where there are none."""
    systems = systems_of(datasets)
    by_label: dict[str, tuple[FloatArray, FloatArray]] = {}
    for dataset in datasets:
        if dataset["type"] not in (15, 2411):
            continue
        places = np.stack([np.asarray(dataset[key], dtype=np.float64) for key in "xyz"], axis=1)
        for index, place in enumerate(places):
            label = str(int(dataset["node_nums"][index]))
            defined = _system(systems, dataset["def_cs"][index], label, remarks)
            moved = _system(systems, dataset["disp_cs"][index], label, remarks)
            # The coordinates of dataset 2411 are the part's, whatever system it was exported for.
            position = defined.position(place) if dataset["type"] == 15 else place
            if label in by_label and not np.allclose(by_label[label][0], position, rtol=1e-5, atol=1e-9):
                raise MeasuredDataError(f"point {label} stands twice in the file, at different places")
            by_label[label] = (position, moved.directions(position))
    if not by_label:
        return None
    labels = tuple(by_label)
    positions = length * np.array([position for position, _ in by_label.values()])
    directions = np.array([axes for _, axes in by_label.values()])
    if any(dataset["type"] == 2420 for dataset in datasets):
        remarks.append("coordinate systems of dataset 2420 read with their axes as the rows of the matrix")
    points = SurveyPoints(labels, positions, directions, ())
    lines = [line for dataset in datasets if dataset["type"] == 82 for line in _lines(dataset, points)]
    return SurveyPoints(labels, positions, directions, tuple(lines))


def _system(systems: dict[int, CoordinateSystem], number: float, label: str, remarks: list[str]) -> CoordinateSystem:
    """Return the coordinate system of a number; an undefined number 1 is the program's own global frame."""
    if int(number) in systems:
        return systems[int(number)]
    if int(number) == 1:
        remark = "coordinate system 1, which the file does not define, taken for the survey's own frame"
        if remark not in remarks:
            remarks.append(remark)
        return GLOBAL
    raise MeasuredDataError(f"point {label} stands in coordinate system {int(number)}, which the file does not hold")


def _lines(dataset: Dataset, points: SurveyPoints) -> list[tuple[int, ...]]:
    """Read the trace lines of one dataset 82, in which a 0 starts a new line."""
    lines: list[list[int]] = [[]]
    for node in dataset["nodes"]:
        if node == 0:
            lines.append([])
        else:
            lines[-1].append(points.index(node, "a trace line"))
    return [tuple(line) for line in lines if len(line) > 1]
