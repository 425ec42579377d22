"""Mesh defects: name, severity, message, number and place."""

from dataclasses import dataclass
from typing import Literal

from meshes.elements import FloatArray

Severity = Literal["error", "warning"]


@dataclass(frozen=True)
class MeshDefect:
    """A defect of a mesh, or a doubt about it.

    Attributes
    ----------
    name : str
        Of the mesh itself: ``degenerate``, ``folded``, ``shape``, ``non-manifold``, ``overlapping``, ``disconnected``,
        ``slit``, ``non-conforming``, ``hinged``, ``unused nodes``, ``unit``. Of its resolution: ``size``, ``locking``.
    severity : {"error", "warning"}
        Errors make the modes wrong or impossible; warnings leave the judgement to the user.
    message : str
        The defect, its place, and the remedy.
    count : int
        Number of nodes, facets, elements or bodies.
    place : ndarray, shape (3,)
        Of the first or the worst of them [m].
    """

    name: str
    severity: Severity
    message: str
    count: int
    place: FloatArray


def mesh_defect(
    name: str, severity: Severity, what: str, advice: str, count: int, place: FloatArray, *, which: str = "the first at"
) -> MeshDefect:
    """Make a defect whose message names the fault, one place, and the remedy."""
    return MeshDefect(name, severity, f"{what}, {which} {place_text(place)}; {advice}", int(count), place)


def place_text(place: FloatArray) -> str:
    """Write a place for a message."""
    return f"({place[0]:.6g}, {place[1]:.6g}, {place[2]:.6g}) m"
