"""Coordinate systems of a universal file: Cartesian, cylindrical or spherical, resolved into the survey's frame."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from housing.errors import MeasuredDataError

FloatArray = npt.NDArray[np.float64]

CARTESIAN, CYLINDRICAL, SPHERICAL = 0, 1, 2
_DEEPEST = 100  # systems within each other beyond which they run in a circle


@dataclass(frozen=True)
class CoordinateSystem:
    """A coordinate system: kind, origin and axes.

    Attributes
    ----------
    axes : ndarray, shape (3, 3)
        Its x, y, z axes as rows, unit vectors in the survey's frame.
    origin : ndarray, shape (3,)
        In the file's unit of length.
    kind : {0, 1, 2}
        Cartesian; cylindrical r, θ, z; spherical r, θ (about z, from x), φ (from z); angles in degrees.
    """

    axes: FloatArray
    origin: FloatArray
    kind: int = CARTESIAN

    def position(self, coordinates: FloatArray) -> FloatArray:
        """A place in the survey's frame from its three coordinates in this system."""
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
        """The three directions of motion at a place of the survey's frame, as rows, shape (3, 3)."""
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
    """The coordinate systems of a universal file by number: datasets 18 and 2420; 0 is the survey's own frame.

    Dataset 18 gives the origin, a point on +x and a point on the +xz plane in another system. Dataset 2420 gives a
    matrix of four rows, read as row vectors are multiplied: rows 1 to 3 are the axes x, y, z, row 4 the origin.

    Raises
    ------
    MeasuredDataError
        Where axes are not perpendicular unit vectors, points coincide or systems refer to each other in a circle.
    """
    given: dict[int, tuple[int, CoordinateSystem]] = {}
    for dataset in datasets:
        if dataset["type"] == 18:
            for index, number in enumerate(dataset["cs_num"]):
                axes = _axes_from_points(
                    int(number), *(np.asarray(dataset[key][index]) for key in ("ref_o", "x_point", "xz_point"))
                )
                system = CoordinateSystem(axes, np.asarray(dataset["ref_o"][index]), _kind(dataset["cs_type"][index]))
                given[int(number)] = (int(dataset["ref_cs_num"][index]), system)
        elif dataset["type"] == 2420:
            for number, kind, matrix in zip(
                dataset["CS_sys_labels"], dataset["CS_types"], dataset["CS_matrices"], strict=True
            ):
                if np.abs(matrix[:3] @ matrix[:3].T - np.eye(3)).max() > 1e-4:
                    raise MeasuredDataError(f"the axes of coordinate system {number} are no perpendicular unit vectors")
                given[int(number)] = (0, CoordinateSystem(_square(matrix[:3]), matrix[3], _kind(kind)))
    return {0: GLOBAL} | {number: _resolved(number, given) for number in given}


def _resolved(number: int, given: Mapping[int, tuple[int, CoordinateSystem]]) -> CoordinateSystem:
    """A system in the survey's frame, through those that it is given in."""
    within, system = given[number]
    for _ in range(_DEEPEST):
        if within == 0 or within == number or within not in given:
            return system
        outer_within, outer = given[within]
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
    """The perpendicular unit vectors nearest to three that are so within a file's digits."""
    left, _, right = np.linalg.svd(axes)
    return np.asarray(left @ right)


def _kind(number: float) -> int:
    if int(number) not in (CARTESIAN, CYLINDRICAL, SPHERICAL):
        raise MeasuredDataError(
            f"coordinate system of type {number:g}; expected 0 (Cartesian), 1 (cylindrical) or 2 (spherical)"
        )
    return int(number)
