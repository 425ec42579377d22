"""Nodes at given places, and units of the matrices, by the rigid motions that a free stiffness leaves free.

A node at a wrong place, or lengths in other units, strain the rotations of a housing that nothing holds.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.certificate import RIGID_STRAIN, condensed_stiffness, rigid_motions_of
from gearwhine.housing.reduced.matrices import UNITS, LabelledMatrix, reduced_matrices
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, refuse

Point = tuple[float, float, float]

_FREE = 1e-3  # sixth least eigenvalue over the seventh, below which six motions are free and no more
_NEAR = 0.05  # largest distance of a node from its place, over the extent of all places


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
    others : mapping of int to tuple of float
        Places of the other nodes with six motions [m], where the free rigid motions tell and prove them.
    """

    nodes: tuple[int, ...]
    units: str
    is_proved: bool
    by_order: bool
    others: Mapping[int, Point] = field(default_factory=dict)


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
        positions = free_positions(stiffness)
        for order in _orders(positions, nodes, places):
            taken = [6 * nodes.index(node) + axis for node in order for axis in range(6)]
            if len(order) == len(nodes):
                part = stiffness[np.ix_(taken, taken)]
            else:
                part = condensed_stiffness(stiffness, taken)
            if _is_free(part, places):
                others = _places_of_others(stiffness, positions, nodes, dict(zip(order, places, strict=True)))
                return Assignment(order, units, is_proved=True, by_order=by_order, others=others)
    return min(unproved, key=lambda one: one[0])[1]


def _places_of_others(
    stiffness: FloatArray, positions: FloatArray | None, nodes: Sequence[int], known: Mapping[int, Point]
) -> dict[int, Point]:
    """Places of nodes beside those of known place; none where they do not keep the rigid motions of all free."""
    if positions is None or len(known) == len(nodes):
        return {}
    shift = np.mean([np.subtract(place, positions[nodes.index(node)]) for node, place in known.items()], axis=0)
    placed = {node: tuple((positions[row] + shift).tolist()) for row, node in enumerate(nodes)} | dict(known)
    if not _is_free(stiffness, [placed[node] for node in nodes]):
        return {}
    return {node: place for node, place in placed.items() if node not in known}


def _orders(positions: FloatArray | None, nodes: Sequence[int], places: Sequence[Point]) -> Iterator[tuple[int, ...]]:
    """Yield orders of the nodes: the one in which they came, and that by their positions."""
    yield tuple(nodes[: len(places)])
    if positions is not None and (at := _nearest(positions, np.asarray(places))) is not None:
        yield tuple(nodes[place] for place in at)


def free_positions(stiffness: FloatArray) -> FloatArray | None:
    """Positions of nodes beside the first one, by the motions that a free stiffness leaves free.

    A free motion of all nodes has the translations t + θ x r of a node at r and the rotation θ, which is that of all.
    Those with θ along x, y and z have the translations W of a node beside those of the first, of columns e_k x d: the
    position d follows from the antisymmetric part of W.

    Parameters
    ----------
    stiffness : ndarray, shape (6 n, 6 n)
        Of three translations and three rotations of each node.

    Returns
    -------
    ndarray, shape (n, 3), or None
        None where the stiffness leaves other motions free than six.
    """
    size = 1.0 / np.sqrt(np.maximum(np.diag(stiffness), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(size[:, None] * stiffness * size)
    if len(values) < 7 or not abs(values[5]) < _FREE * values[6]:
        return None
    free = (size[:, None] * vectors[:, :6]).reshape(-1, 2, 3, 6)
    about_axes = np.linalg.pinv(free[:, 1].mean(axis=0))
    moved = free[:, 0] @ about_axes
    beside = moved - moved[0]
    pairs = [beside[:, second, third] - beside[:, third, second] for second, third in ((1, 2), (2, 0), (0, 1))]
    return 0.5 * np.stack(pairs, axis=1)


def _nearest(positions: FloatArray, places: FloatArray) -> list[int] | None:
    """Rows of the positions that have places, up to a shift of all; None where they are far from them."""
    extent = float(np.linalg.norm(places - places.mean(axis=0), axis=1).max())
    best, least = None, _NEAR * extent
    for first in positions:
        away = np.linalg.norm(positions[None] - (first + places - places[0])[:, None], axis=2)
        rows = away.argmin(axis=1).tolist()
        farthest = float(away.min(axis=1).max())
        if farthest < least and len(set(rows)) == len(rows):
            best, least = rows, farthest
    return best


def _is_free(stiffness: FloatArray, places: Sequence[Point]) -> bool:
    """Whether the rigid motions of nodes at these places are not resisted, about the places' centre."""
    motions = rigid_motions_of(np.subtract(places, np.mean(places, axis=0)))
    strain = np.abs(np.einsum("ia,ij,ja->a", motions, stiffness, motions))
    sizes = np.einsum("ia,ij,ja->a", np.abs(motions), np.abs(stiffness), np.abs(motions))
    return bool((strain <= RIGID_STRAIN * sizes).all())
