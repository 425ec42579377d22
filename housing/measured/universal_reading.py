"""Reader of universal files: points, shapes and responses of a survey, in SI and one frame.

Cartesian, cylindrical and spherical coordinate systems of the file are resolved into the survey's frame.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured.survey_data import SurveyData
from gearwhine.housing.measured.universal_datasets import (
    SHAPES,
    Dataset,
    FileUnits,
    Frame,
    SurveyPoints,
    is_response,
    read_datasets,
    read_functions,
    read_shapes,
)
from gearwhine.meshes.lengths import UNITS
from gearwhine.numerics.arrays import FloatArray

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


def read_universal(
    path: str | Path | Sequence[str | Path], *, unit: str | None = None, shape_frame: Frame | None = None
) -> SurveyData:
    """Read a universal file: points (15, 2411), trace lines (82), shapes (55, 2414), responses (58), units (164).

    Parameters
    ----------
    path : path, or sequence of paths
        One file, or the files of one survey: points, shapes and responses may stand in files of their own. Each has its
        own units; one that states none has those of the first that does.
    unit : {"m", "mm", "cm", "in"}, optional
        Unit of the files' lengths, in place of their datasets 164. Without either a metre is assumed, with a remark.
    shape_frame : {"local", "global"}, optional
        Frame of the shapes where points have a displacement system of their own. The format calls the vectors
        of datasets 55 and 2414 global; programs for modal tests write dataset 55 in the points' own directions, as
        measured. So "local" is the default of dataset 55, and "global" of 2414. Functions (58) are always in the
        points' own directions.

    Raises
    ------
    MeasuredDataError
        Where a file is damaged, or names a point or coordinate system that none of them holds.
    """
    paths = [Path(path)] if isinstance(path, str | Path) else [Path(one) for one in path]
    names = " and ".join(one.name for one in paths)
    remarks: list[str] = []
    contents: list[_Content] = []
    for one in paths:
        datasets, passed_over = read_datasets(one)
        before = f"{one.name}: " if len(paths) > 1 else ""
        remarks += [before + remark for remark in passed_over]
        contents.append(_Content(one.name, datasets, _stated_units(datasets, one.name)))
    units = _units(contents, unit, remarks)
    datasets = [dataset for content in contents for dataset in content.datasets]
    points = _points(contents, units, remarks)
    modes = read_shapes([one["mode"] for one in datasets if one["type"] in SHAPES], points, shape_frame, remarks)
    if points is None:
        if any(one["type"] == 58 and is_response(one) for one in datasets):
            raise MeasuredDataError(
                f"{names} holds functions but no points (dataset 15 or 2411): nobody can tell where they were "
                "measured; where another file has the points, name both, in a list"
            )
        if modes is None:
            raise MeasuredDataError(
                f"{names} holds no points, no shapes of modes and no frequency responses to forces (datasets 15 or "
                "2411, 55 or 2414, 58)"
            )
        return SurveyData(None, modes, None, tuple(remarks))
    functions = [
        (dataset, scale)
        for content, scale in zip(contents, units, strict=True)
        for dataset in content.datasets
        if dataset["type"] == 58
    ]
    responses = read_functions(functions, points, remarks) if functions else None
    geometry = points.geometry([], [])
    if modes is not None and modes.geometry is not None:
        geometry = modes.geometry
    elif responses is not None:
        geometry = responses.geometry
    return SurveyData(geometry, modes, responses, tuple(remarks))


@dataclass(frozen=True)
class _Content:
    """Content of one of the files of a survey: its name, its datasets, and the units that it states."""

    name: str
    datasets: list[Dataset]
    units: FileUnits | None


def _stated_units(datasets: list[Dataset], name: str) -> FileUnits | None:
    stated = [dataset for dataset in datasets if dataset["type"] == 164]
    if len({(one["length"], one["force"]) for one in stated}) > 1:
        raise MeasuredDataError(f"{name} states several systems of units (dataset 164); expected one")
    return FileUnits(1.0 / stated[0]["length"], 1.0 / stated[0]["force"]) if stated else None


def _units(contents: Sequence[_Content], unit: str | None, remarks: list[str]) -> list[FileUnits]:
    """Units of each file."""
    stated = next((content.units for content in contents if content.units is not None), None)
    if unit is not None:
        if unit not in UNITS:
            raise MeasuredDataError(f"unit {unit!r}; expected one of {', '.join(UNITS)}")
        if stated is not None and not np.isclose(UNITS[unit], stated.length, rtol=1e-6):
            remarks.append(f"lengths taken in {unit}, as told, and not as the file's dataset 164 states")
        forces = [1.0 if content.units is None else content.units.force for content in contents]
        return [FileUnits(UNITS[unit], force) for force in forces]
    if stated is None:
        if any(dataset["type"] in (15, 2411, 58) for content in contents for dataset in content.datasets):
            remarks.append("no units stated (dataset 164): lengths taken in metres, forces in newtons")
        return [FileUnits() for _ in contents]
    for content in contents:
        if content.units is None and any(dataset["type"] in (15, 2411, 58) for dataset in content.datasets):
            remarks.append(f"{content.name} states no units (dataset 164): taken in those of the first file that does")
    return [stated if content.units is None else content.units for content in contents]


def _points(contents: Sequence[_Content], units: Sequence[FileUnits], remarks: list[str]) -> SurveyPoints | None:
    """Positions in metres and directions of the points, their systems resolved; None where there are none."""
    every = systems_of([dataset for content in contents for dataset in content.datasets])
    by_label: dict[str, tuple[FloatArray, FloatArray]] = {}
    for content, scale in zip(contents, units, strict=True):
        systems = every | systems_of(content.datasets)
        for dataset in content.datasets:
            if dataset["type"] not in (15, 2411):
                continue
            positions, directions = _resolved_points(dataset, systems, remarks)
            for label, position, axes in zip(dataset["node_nums"], scale.length * positions, directions, strict=True):
                name = str(int(label))
                known = by_label.setdefault(name, (position, axes))
                if known[0] is not position and not np.allclose(known[0], position, rtol=1e-5, atol=1e-9):
                    raise MeasuredDataError(f"point {name} stands twice in the file, at different places")
    if not by_label:
        return None
    labels = tuple(by_label)
    positions = np.array([position for position, _ in by_label.values()])
    directions = np.array([axes for _, axes in by_label.values()])
    datasets = [dataset for content in contents for dataset in content.datasets]
    if any(dataset["type"] == 2420 for dataset in datasets):
        remarks.append("coordinate systems of dataset 2420 read with their axes as the rows of the matrix")
    points = SurveyPoints(labels, positions, directions, ())
    lines = [line for dataset in datasets if dataset["type"] == 82 for line in _lines(dataset, points)]
    return SurveyPoints(labels, positions, directions, tuple(lines))


def _resolved_points(
    dataset: Dataset, systems: dict[int, CoordinateSystem], remarks: list[str]
) -> tuple[FloatArray, FloatArray]:
    """Positions in the file's unit of length, and directions of motion, of one dataset of points."""
    positions = np.stack([np.asarray(dataset[key], dtype=np.float64) for key in "xyz"], axis=1)
    directions = np.broadcast_to(np.eye(3), (len(positions), 3, 3)).copy()
    defined, moved = (np.asarray(dataset[key], dtype=np.int64) for key in ("def_cs", "disp_cs"))
    for number in np.unique(defined):
        chosen = np.flatnonzero(defined == number)
        system = _system(systems, number, str(int(dataset["node_nums"][chosen[0]])), remarks)
        # The coordinates of dataset 2411 are the part's, whatever system it was exported for.
        if dataset["type"] == 15 and system is not GLOBAL:
            positions[chosen] = [system.position(positions[place]) for place in chosen]
    for number in np.unique(moved):
        chosen = np.flatnonzero(moved == number)
        system = _system(systems, number, str(int(dataset["node_nums"][chosen[0]])), remarks)
        if system.kind == CARTESIAN:
            directions[chosen] = system.axes
        else:
            directions[chosen] = [system.directions(positions[place]) for place in chosen]
    return positions, directions


def _system(systems: Mapping[int, CoordinateSystem], number: float, label: str, remarks: list[str]) -> CoordinateSystem:
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
