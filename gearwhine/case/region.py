"""Material regions of the housing, `[[housing.region]]`."""

from __future__ import annotations

from pydantic import model_validator

from gearwhine.case.fields import Name, Point, Table, wrong


class Region(Table):
    """The elements of a named volume of the mesh, or those whose middle is in a box [m], and their material."""

    name: Name
    material: Name
    volume: Name | None = None
    box: tuple[Point, Point] | None = None

    @model_validator(mode="after")
    def _one_of_each(self) -> Region:
        if (self.box is None) == (self.volume is None):
            raise wrong("exactly one of 'volume' and 'box'")
        return self
