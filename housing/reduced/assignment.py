"""Nodes at given places, and units of the matrices, by the rigid motions that a free stiffness leaves free.

A node at a wrong place, or lengths in other units, strain the rotations of a housing that nothing holds.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.certificate import RIGID_STRAIN, condensed_stiffness, rigid_motions_of
from gearwhine.housing.reduced.matrices import UNITS, LabelledMatrix, reduced_matrices
from gearwhine.numerics.findings import Finding, refuse

Point = tuple[float, float, float]

MOST_ORDERED = 6
"""Places up to which every order of the nodes is tried: 720 orders."""


@dataclass(frozen=True)
class Assignment:
    """Nodes of places.

    Attributes
    ----------
    nodes : tuple of int
        Node at each place.
    units : {"SI", "mm-t-s"}
    is_proved : bool
        Whether all six rigid motions are free by these. Otherwise the nodes are in their order, and the units those by
        which moments over forces of a node have a lever nearest to the places' distance from their centre.
    by_order : bool
        Whether the rows of the file belong to the nodes by order alone, six each.
    """

    nodes: tuple[int, ...]
    units: str
    is_proved: bool
    by_order: bool


def assign_nodes(matrices: Mapping[str, LabelledMatrix], places: Sequence[Point]) -> Assignment:
    """Assign the nodes with six motions to places, by the free rigid motions or else in their order.

    Parameters
    ----------
    matrices : mapping of str to LabelledMatrix
        As :func:`reduced_matrices` takes them. Files without node numbers have their first rows at the places.
    places : sequence of tuple of float
        Places that nodes stand at [m].

    Raises
    ------
    HousingError
        Where there are fewer nodes with six motions than places, or the matrices are not those of a housing.
    """
    by_order = matrices["stiffness"].coordinates is None
    numbers = tuple(range(1, len(places) + 1)) if by_order else ()
    extent = float(np.linalg.norm(np.subtract(places, np.mean(places, axis=0)), axis=1).max())
    unproved: list[tuple[float, Assignment]] = []
    for units in UNITS:
        made = reduced_matrices(matrices, numbers, units)
        nodes = [node for node in made.nodes if len(made.rows(node)) == 6]
        if len(nodes) < len(places):
            expected = f"{len(places)} nodes with six motions, one for each bearing; the file has {len(nodes)}"
            refuse([Finding(("reduced housing", "nodes"), "", None, expected)], HousingError)
        rows = [made.rows(node)[axis] for node in nodes for axis in range(1, 7)]
        stiffness = condensed_stiffness(made.stiffness, rows)
        diagonal = np.diag(stiffness).reshape(-1, 2, 3)
        lever = np.sqrt(np.median(diagonal[:, 1]) / max(float(np.median(diagonal[:, 0])), 1e-300))
        misfit = abs(np.log(max(lever, 1e-12) / max(extent, 1e-12)))
        first = Assignment(tuple(nodes[: len(places)]), units, is_proved=False, by_order=by_order)
        unproved.append((float(misfit), first))
        for order in _orders(nodes, len(places)):
            taken = [6 * nodes.index(node) + axis for node in order for axis in range(6)]
            if len(order) == len(nodes):
                part = stiffness[np.ix_(taken, taken)]
            else:
                part = condensed_stiffness(stiffness, taken)
            if _is_free(part, places):
                return Assignment(order, units, is_proved=True, by_order=by_order)
    return min(unproved, key=lambda one: one[0])[1]


def _orders(nodes: Sequence[int], count: int) -> Iterator[tuple[int, ...]]:
    """Yield orders of the nodes, the one in which they came first."""
    if len(nodes) > MOST_ORDERED:
        yield tuple(nodes[:count])
        return
    yield from permutations(nodes, count)


def _is_free(stiffness: np.ndarray, places: Sequence[Point]) -> bool:
    """Whether the rigid motions of nodes at these places are not resisted, about the places' centre."""
    motions = rigid_motions_of(np.subtract(places, np.mean(places, axis=0)))
    strain = np.abs(np.einsum("ia,ij,ja->a", motions, stiffness, motions))
    sizes = np.einsum("ia,ij,ja->a", np.abs(motions), np.abs(stiffness), np.abs(motions))
    return bool((strain <= RIGID_STRAIN * sizes).all())
