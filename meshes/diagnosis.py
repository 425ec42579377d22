"""Mesh diagnosis: the defects of a mesh by name, with their places and remedies."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from meshes.ailments import MeshDefect, Severity, mesh_defect
from meshes.connections import connection_defects
from meshes.elements import FloatArray, IntArray
from meshes.lengths import UNITS, length_text, plausible
from meshes.mapping import determinants, jacobians
from meshes.mesh import Mesh
from meshes.quality import edge_lengths, shape_numbers
from meshes.shapes import quadrature, shape_functions

LEAST_SHAPE = 0.05
"""Shape number below which an element spoils the stresses around it."""

_LIKELY = 0.5  # of several possible units, the one that makes the housing nearest to this is proposed [m]
_NO_VOLUME = 1e-9  # of the cube of an element's longest edge


def diagnose(mesh: Mesh, *, unit: float | None = None) -> tuple[MeshDefect, ...]:
    """Find the defects of a mesh, errors first.

    Parameters
    ----------
    mesh : Mesh
    unit : float, optional
        The unit of length of the file that it came from [m]; with it, implausible sizes are reported too.

    Notes
    -----
    Inverted and flat elements are not among them, because :class:`Mesh` refuses them.
    """
    defects = [*_elements(mesh), *connection_defects(mesh), *_nodes(mesh), *_unit(mesh, unit)]
    return tuple(sorted(defects, key=lambda one: one.severity != "error"))


def _elements(mesh: Mesh) -> Iterator[MeshDefect]:
    """Elements that are degenerate, folded, or of a bad shape."""
    repeats, edges, least, least_at_nodes = [], [], [], []
    for block in mesh.blocks:
        ordered = np.sort(block.nodes, axis=1)
        repeats.append((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
        edges.append(edge_lengths(mesh.points, block).max(axis=1))
        least.append(_least_determinant(mesh, block.nodes, block.kind, quadrature(block.kind, 2 * block.of.order)[0]))
        at_nodes = np.array(block.of.places, dtype=np.float64).T
        least_at_nodes.append(_least_determinant(mesh, block.nodes, block.kind, at_nodes))
    repeated, shape = np.concatenate(repeats), shape_numbers(mesh)
    flat = (mesh.corner_volumes < _NO_VOLUME * np.concatenate(edges) ** 3) & ~repeated
    folded = (np.concatenate(least) <= 0.0) & ~repeated & ~flat
    creased = (np.concatenate(least_at_nodes) <= 0.0) & ~repeated & ~flat & ~folded
    bad = (shape < LEAST_SHAPE) & ~repeated & ~flat
    cases: tuple[tuple[npt.NDArray[np.bool_], str, Severity, str, str], ...] = (
        (repeated, "degenerate", "error", "name a node twice", "write collapsed bricks as wedges or tetrahedra"),
        (flat, "degenerate", "error", "have next to no volume", "remove them or mesh anew"),
        (folded, "folded", "error", "are folded by their middle nodes", "refine where it is curved, or use order 1"),
        (creased, "folded", "warning", "are folded at a node by their middle nodes", "refine where it is curved"),
    )
    for which, name, severity, what, advice in cases:
        if which.any():
            number = int(which.sum())
            yield mesh_defect(
                name, severity, f"{number} elements {what}", advice, number, mesh.centers[np.argmax(which)]
            )
    if bad.any():
        worst, number = int(np.argmin(np.where(bad, shape, np.inf))), int(bad.sum())
        what = f"{number} elements have a shape number below {LEAST_SHAPE} (1 is ideal, 0 is flat)"
        advice = "mesh anew with a smaller or more even size there"
        which_one = f"the worst with {shape[worst]:.2g} at"
        yield mesh_defect("shape", "warning", what, advice, number, mesh.centers[worst], which=which_one)


def _least_determinant(mesh: Mesh, nodes: IntArray, kind: str, places: FloatArray) -> FloatArray:
    """Compute the least Jacobian determinant of each element at some reference places, shape (n_elements,)."""
    gradients = shape_functions(kind, places)[1]
    return np.asarray(determinants(jacobians(mesh.points, nodes, gradients)).min(axis=1))


def _nodes(mesh: Mesh) -> Iterator[MeshDefect]:
    unused = np.setdiff1d(np.arange(len(mesh.points)), mesh.used_nodes)
    if len(unused):
        what = f"{len(unused)} nodes belong to no element"
        yield mesh_defect("unused nodes", "error", what, "leave them out", len(unused), mesh.points[unused[0]])


def _unit(mesh: Mesh, unit: float | None) -> Iterator[MeshDefect]:
    """Implausible sizes of a housing, with the unit that would make them plausible."""
    length = float(np.ptp(mesh.bounds, axis=0).max())
    if unit is None or plausible(length):
        return
    name = next((name for name, value in UNITS.items() if np.isclose(value, unit)), f"{unit:g} m")
    other = {other: length / unit * value for other, value in UNITS.items() if other != name}
    believed = sorted(
        (other for other, size in other.items() if plausible(size)),
        key=lambda name: abs(np.log(other[name] / _LIKELY)),
    )
    message = f"the part is {length_text(length)} long; is the unit {name!r}?"
    if believed:
        message += f" With {believed[0]!r} it would be {length_text(other[believed[0]])}"
    yield MeshDefect("unit", "warning", message, 1, mesh.bounds.mean(axis=0))
