"""Reduced static stiffness of the casing in a REXS file: an assembly group whose reduction points carry bearings.

An ``assembly_group`` that the casing refers to has a ``reduced_static_stiffness_matrix`` of six motions at each of its
reduction points, along and about its axes u, v, w, in the order of its ``ordered_assembly`` relations. A reduction
point refers to the bearing that it carries. The schema has no unit for the matrix: N, mm and rad are taken, as for most
of its lengths and forces.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearwhine.exchange.rexs.errors import wrong
from gearwhine.exchange.rexs.gear_unit import BEARINGS, GearUnit
from gearwhine.exchange.rexs.model import Component, RexsModel, finite_number
from gearwhine.exchange.rexs.placement import Placements
from gearwhine.exchange.rexs.quantities import of
from gearwhine.housing.reduced import LabelledMatrix

MATRIX, GROUNDED = "reduced_static_stiffness_matrix", "matrix_with_inertial_environment_boundary"
LIMIT = 1000.0
"""Frequency limit that a static stiffness is given [Hz]: it has no modes of its own."""
UNITS = "mm-t-s"
_LARGEST = 3000


@dataclass(frozen=True)
class ReducedCasing:
    """An assembly group with a stiffness matrix, and its reduction points in the order of the rows."""

    group: Component
    points: tuple[Component, ...]

    def stiffness(self, places: Placements) -> LabelledMatrix:
        """Return the stiffness along and about x, y, z of the machine, in N, mm and rad.

        With the axes A of the group in x, y, z a motion at a point is diag(A, A) times that along u, v, w.

        Raises
        ------
        RexsError
            Where it is no matrix of finite numbers, or has no six rows for each reduction point.
        """
        place = f"{self.group.label}: {MATRIX}"
        n = 6 * len(self.points)
        rows = self.group.attributes[MATRIX].value
        expected = f"a matrix of {n} x {n} numbers, six for each of {len(self.points)} reduction points"
        if not isinstance(rows, tuple | list) or len(rows) != n or not 0 < n <= _LARGEST:
            raise wrong(place, expected)
        values = np.zeros((n, n))
        for row, entries in enumerate(rows):
            if not isinstance(entries, tuple | list) or len(entries) != n:
                raise wrong(place, expected)
            numbers = [finite_number(entry) for entry in entries]
            if None in numbers:
                raise wrong(place, "finite numbers", entries[numbers.index(None)])
            values[row] = numbers
        axes = np.kron(np.eye(2 * len(self.points)), places.of(self.group).axes)
        coordinates = tuple((point.number, axis) for point in self.points for axis in range(1, 7))
        return LabelledMatrix(axes @ values @ axes.T, coordinates)


def casing_of(model: RexsModel) -> ReducedCasing | None:
    """Return the stiffness of the casing; None where the file has none, or one without a boundary to the ground."""
    for casing in model.of_kind("gear_casing"):
        for group in model.referenced(casing.number, "assembly_group"):
            points = model.parts_of(group.number, "reduction_point")
            if group.has(MATRIX) and points and group.flag(GROUNDED) is not False:
                return ReducedCasing(group, tuple(points))
    return None


def casing_stiffness(model: RexsModel) -> LabelledMatrix:
    """Return the stiffness of the casing of a model, as a file of a matrix.

    Raises
    ------
    RexsError
        Where it has none.
    """
    casing = casing_of(model)
    if casing is None:
        raise wrong("the file", f"a gear_casing with an assembly_group that has reduction points and a {MATRIX}")
    return casing.stiffness(Placements(model))


def housing_table(unit: GearUnit, casing: ReducedCasing, file: str, bearings: dict[int, dict[str, Any]]) -> Any:
    """Return `[housing]` of a casing's stiffness, and stand the bearings at its points on it; None where it has none.

    Parameters
    ----------
    unit, casing
    file : str
        Name of the file, in which the matrix stays.
    bearings : dict of int to dict
        Tables of the case's bearings on the ground, by the number of their component.
    """
    _ = casing.stiffness(unit.places)  # what is wrong with it is told by the component
    seats = []
    for point in casing.points:
        for bearing in unit.model.referenced(point.number, *BEARINGS):
            table = bearings.get(bearing.number)
            if table is None or table["seat"] != "ground":
                unit.notes.left_out(point.label, f"{bearing.label} stands on no ground of the case")
                continue
            table["seat"] = name = f"{table['name']} seat"
            center = [of(value, "m") for value in unit.places.of(point).origin.tolist()]
            seats.append({"name": name, "node": point.number, "center": center})
    if not seats:
        unit.notes.left_out(casing.group.label, "no reduction point refers to a bearing of the case")
        return None
    text = "a matrix in N, mm and rad, since the schema states no unit"
    unit.notes.assumed(casing.group.label, text, "housing", "reduced", "units")
    text = "a static stiffness has no modes: the housing follows without resonances of its own"
    unit.notes.assumed(casing.group.label, text, "housing", "frequency_limit")
    reduced = {"stiffness": file, "units": UNITS}
    return {"frequency_limit": of(LIMIT, "Hz"), "damping_ratio": 0.0, "reduced": reduced, "seat": seats}
