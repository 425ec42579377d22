"""The form in which something wrong with a mesh is told."""

from dataclasses import dataclass
from typing import Literal

from meshes.elements import FloatArray

Severity = Literal["error", "warning"]


@dataclass(frozen=True)
class Ailment:
    """One thing wrong with a mesh, or doubtful in it.

    Attributes
    ----------
    name : str
        Of a mesh: ``degenerate``, ``folded``, ``shape``, ``non-manifold``, ``overlapping``, ``disconnected``, ``slit``,
        ``non-conforming``, ``hinged``, ``unused nodes``, ``unit``. Of what it is used for: ``size``, ``locking``.
    severity : {"error", "warning"}
        Errors make the modes wrong or impossible; with warnings they may be good enough.
    message : str
        What, where, and what to do.
    count : int
        How many nodes, facets, elements or bodies.
    place : ndarray, shape (3,)
        Of the first or the worst of them [m].
    """

    name: str
    severity: Severity
    message: str
    count: int
    place: FloatArray


def ailment(
    name: str, severity: Severity, what: str, advice: str, count: int, place: FloatArray, *, which: str = "the first at"
) -> Ailment:
    """Make a defect whose message names the fault, one place, and the remedy."""
    return Ailment(name, severity, f"{what}, {which} {place_text(place)}; {advice}", int(count), place)


def place_text(place: FloatArray) -> str:
    """Write a place for a message."""
    return f"({place[0]:.6g}, {place[1]:.6g}, {place[2]:.6g}) m"
