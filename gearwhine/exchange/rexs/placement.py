"""Places of the components of a gear unit in the machine's frame.

A component has its origin, ``support_vector``, and its axes u and w in the frame of another one; v closes the
right-handed frame u, v, w. The case's shafts lie along z, so that its x, y, z are v, w, u of the gear unit.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from gearwhine.exchange.rexs.errors import wrong
from gearwhine.exchange.rexs.model import Component, RexsModel
from gearwhine.numerics.arrays import FloatArray

_PARALLEL = 1e-6  # sine of the angle within which axes are parallel


@dataclass(frozen=True)
class Placement:
    """Origin [m], (3,), and axes of a component, the columns u, v, w of (3, 3)."""

    origin: FloatArray
    axes: FloatArray

    def within(self, outer: Placement) -> Placement:
        """Return the placement in the frame of which `outer` is the placement of its own."""
        return Placement(outer.origin + outer.axes @ self.origin, outer.axes @ self.axes)


ORIGIN = Placement(np.zeros(3), np.eye(3))


@dataclass
class Placements:
    """Placements of the components of a model in the machine's frame, x, y, z."""

    model: RexsModel
    _known: dict[int, Placement] = field(default_factory=dict)

    def of(self, component: Component) -> Placement:
        """Return the placement of a component: its origin and the directions of u, v, w in x, y, z.

        Raises
        ------
        RexsError
            Where its axes are none, or its place is by way of others relative to itself.
        """
        placed = self._in_file(component, ())
        # x, y, z are v, w, u of the gear unit.
        to_machine = np.roll(self._unit.axes, -1, axis=1).T
        return Placement(to_machine @ (placed.origin - self._unit.origin), to_machine @ placed.axes)

    @property
    def _unit(self) -> Placement:
        unit = next(self.model.of_kind("gear_unit"), None)
        return ORIGIN if unit is None else self._in_file(unit, ())

    def _in_file(self, component: Component, asked: tuple[int, ...]) -> Placement:
        """Return the placement in the frame of the file."""
        if component.number in self._known:
            return self._known[component.number]
        if component.number in asked:
            raise wrong(component.label, "a place that is not relative to itself, by way of others either")
        placed = Placement(np.array(component.vector("support_vector") or (0.0, 0.0, 0.0)), _axes(component))
        reference = component.whole("reference_component_for_position")
        if reference is not None and reference != component.number:
            other = self.model.components.get(reference)
            if other is None:
                raise wrong(
                    f"{component.label}: reference_component_for_position", "the number of a component", reference
                )
            if len(asked) > 100:
                raise wrong(component.label, "a place relative to few others")
            placed = placed.within(self._in_file(other, (*asked, component.number)))
        self._known[component.number] = placed
        return placed


def _axes(component: Component) -> FloatArray:
    """Return the columns u, v, w of a component; those of its reference where it has none."""
    u = np.array(component.vector("u_axis_vector", None) or (1.0, 0.0, 0.0))
    w = np.array(component.vector("w_axis_vector", None) or (0.0, 0.0, 1.0))
    lengths = np.hypot.reduce(u), np.hypot.reduce(w)
    if min(lengths) == 0.0 or not np.all(np.isfinite(lengths)):
        raise wrong(component.label, "a u_axis_vector and a w_axis_vector with a direction")
    u, w = u / lengths[0], w / lengths[1]
    w = w - (w @ u) * u
    length = np.hypot.reduce(w)
    if length < _PARALLEL:
        raise wrong(component.label, "a w_axis_vector that is not along its u_axis_vector")
    w = w / length
    return np.column_stack([u, np.cross(w, u), w])


def along(placement: Placement) -> int:
    """Return whether u points along z, 1, or against it, -1; 0 where it lies across."""
    u = placement.axes[:, 0]
    return 0 if np.hypot(u[0], u[1]) > _PARALLEL else 1 if u[2] > 0.0 else -1
