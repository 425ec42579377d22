"""Mesh of the housing: quantities of its size, quality and bores, and how the terminal shows them."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from gearwhine.from_case.mesh import bores_along_axes
from gearwhine.meshes import Mesh, mesh_quality
from gearwhine.meshes.bores import CylindricalBore
from gearwhine.output.quantity import Part, Quantity, Rows, document_of
from gearwhine.output.sections import Document, Section
from gearwhine.results.housing import MESH_SIZE


class BoreAlongAxis(NamedTuple):
    """Name of an axis, and a bore along it."""

    axis: str
    bore: CylindricalBore


def bores(mesh: Mesh) -> list[BoreAlongAxis]:
    """Return the mesh's bores along each axis: first along z, where shafts are, then others, the widest first."""
    return [BoreAlongAxis(*each) for each in bores_along_axes(mesh)]


BORE = (
    Quantity("center_m", "bore.center"),
    Quantity("diameter_m", "bore.diameter"),
    Quantity("length_m", "bore.length"),
    Quantity("axis"),
)
"""Quantities of a bore; a row is a :class:`BoreAlongAxis`."""

QUALITY = (
    Quantity("volume_m3", "volume"),
    Quantity("edge_length_m", lambda quality: dict(zip(("min", "median", "max"), quality.edge_length, strict=True))),
    Quantity("shape_number", lambda quality: dict(zip(("min", "median"), quality.shape, strict=True))),
)
"""Quality of the elements: the shape number is 1 at best."""

MESH = (
    Part("mesh", ".", MESH_SIZE),
    Quantity("order"),
    Quantity("kinds"),
    Quantity("surfaces", lambda mesh: {name: sum(map(len, facets)) for name, facets in sorted(mesh.surfaces.items())}),
    Quantity("volumes", lambda mesh: {name: len(members) for name, members in sorted(mesh.volumes.items())}),
    Part("", mesh_quality, QUALITY),
    Rows("bores", bores, BORE),
)
"""Quantities of a mesh: elements by kind, facets of each surface, elements of each volume, quality and bores."""


def mesh_document(mesh: Mesh, warnings: Sequence[Document]) -> dict[str, Any]:
    """Return the mesh as the command's JSON."""
    return document_of(MESH, mesh) | {"warnings": list(warnings)}


_KINDS = {
    "tetra": "tetrahedra of 4 nodes",
    "tetra10": "tetrahedra of 10 nodes",
    "hexahedron": "bricks of 8 nodes",
    "hexahedron20": "bricks of 20 nodes",
    "hexahedron27": "bricks of 27 nodes",
    "wedge": "wedges of 6 nodes",
    "wedge15": "wedges of 15 nodes",
}


def sections(document: Document) -> tuple[Section, ...]:
    """Return the mesh's size and quality in words."""
    return (Section("", tuple(_sentences(document))),)


def _sentences(document: Document) -> Iterator[str]:
    edge, shape = document["edge_length_m"], document["shape_number"]
    yield f"{document['mesh']['nodes']} nodes, {kinds_of_elements(document['kinds'])}"
    yield f"Volume {document['volume_m3']:.6g} m³; median edge {1e3 * edge['median']:.3g} mm"
    yield f"Shape number (1 is ideal): median {shape['median']:.2f}, smallest {shape['min']:.2f}"
    yield f"Surfaces: {', '.join(document['surfaces']) or 'none named'}"
    yield f"Volumes: {', '.join(document['volumes']) or 'none named'}"
    for bore in document["bores"]:
        yield bore_line(bore).capitalize()


def kinds_of_elements(kinds: Mapping[str, int]) -> str:
    """Return the number of elements of each kind, in words."""
    return " and ".join(f"{count} {_KINDS[kind]}" for kind, count in kinds.items())


def bore_line(bore: Document) -> str:
    """Return a bore's diameter, axis, place and length in words."""
    place = ", ".join(f"{round(1e3 * value, 3) + 0.0:.6g}" for value in bore["center_m"])
    along = "" if bore["axis"] == "z" else f" along {bore['axis']}"
    return f"bore of {1e3 * bore['diameter_m']:.5g} mm{along} at ({place}) mm, {1e3 * bore['length_m']:.4g} mm long"
