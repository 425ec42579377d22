"""Patches of the housing surface: a named surface, or the surface in a box or on a plane."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

from pydantic import model_validator

from gearwhine.case.fields import Length, Name, Point, Table, wrong

if TYPE_CHECKING:
    import housing


class Plane(Table):
    """A plane at right angles to an axis, where it meets it [m]."""

    axis: Literal["x", "y", "z"]
    at: Length


class Patch(Table):
    """Patch of the housing surface for a fixture: exactly one of the keys in `places`."""

    places: ClassVar[tuple[str, ...]] = ("box", "surface", "plane")
    """The keys that can say where; exactly one of them must."""

    box: tuple[Point, Point] | None = None
    surface: Name | None = None
    plane: Plane | None = None

    @model_validator(mode="after")
    def _one_place(self) -> Patch:
        if sum(getattr(self, key) is not None for key in self.places) != 1:
            *first, last = (f"'{key}'" for key in self.places)
            raise wrong(f"exactly one of {', '.join(first)} and {last}")
        return self

    @property
    def corners(self) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
        """The box's corners of least and of greatest x, y, z [m], whichever two opposite ones were given."""
        if self.box is None:
            return None
        (x1, y1, z1), (x2, y2, z2) = self.box
        return (min(x1, x2), min(y1, y2), min(z1, z2)), (max(x1, x2), max(y1, y2), max(z1, z2))

    @property
    def point_and_normal(self) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
        """A point of the plane [m] and its unit normal."""
        if self.plane is None:
            return None
        x, y, z = (float(axis == self.plane.axis) for axis in "xyz")
        return (x * self.plane.at, y * self.plane.at, z * self.plane.at), (x, y, z)

    def build_patch(self) -> housing.Patch:
        """The patch of the mesh's surface."""
        from housing import Patch as BuiltPatch

        return BuiltPatch(self.surface, self.corners, self.point_and_normal)
