"""Writer of input decks of Abaqus and CalculiX."""

import re
from pathlib import Path

import numpy as np

from meshes.abaqus import BRICK_27, FACE_LABELS, SOLID_TYPES
from meshes.content import corner_rows, find_faces
from meshes.elements import ElementBlock
from meshes.errors import GeometryError
from meshes.mesh import Mesh


def write_abaqus(mesh: Mesh, path: Path) -> None:
    """Write an input deck: elements of full integration, volumes as element sets, surfaces of element faces.

    Raises
    ------
    GeometryError
        Where a facet of a named surface is no face of an element, or a name cannot stand in a deck.
    """
    names = {kind: f"C3D{number}" for number, kind in SOLID_TYPES.items()}
    with path.open("w", encoding="utf-8") as file:
        file.write("*NODE\n")
        for number, place in enumerate(mesh.points.tolist(), start=1):
            file.write(f"{number}, " + ", ".join(map(repr, place)) + "\n")
        first = 1
        for block in mesh.blocks:
            file.write(f"*ELEMENT, TYPE={names[block.kind]}\n")
            order = BRICK_27 if block.kind == "hexahedron27" else slice(None)
            for number, nodes in enumerate((block.nodes[:, order] + 1).tolist(), start=first):
                # At most 16 numbers in a line.
                lines = [[number, *nodes[:15]], nodes[15:]] if len(nodes) > 15 else [[number, *nodes]]
                file.write(",\n".join(", ".join(map(str, line)) for line in lines) + "\n")
            first += len(block)
        for name, members in mesh.volumes.items():
            file.write(f"*ELSET, ELSET={_quoted(name)}\n")
            file.writelines(f"{number}\n" for number in (np.sort(members) + 1).tolist())
        for name, facets in mesh.surfaces.items():
            file.write(f"*SURFACE, TYPE=ELEMENT, NAME={_quoted(name)}\n")
            for block in facets:
                found = find_faces(mesh, corner_rows(block))
                if (found < 0).any():
                    raise GeometryError(f"surface {name!r} has facets that are no faces of elements")
                for number, place in zip(mesh.faces.element[found] + 1, mesh.faces.source[found], strict=True):
                    file.write(f"{number}, {_label(mesh.blocks[place[0]], int(place[2]))}\n")


def _quoted(name: str) -> str:
    if '"' in name or "\n" in name:
        raise GeometryError(f"the name {name!r} cannot stand in an input deck: it has a quotation mark or a line break")
    return name if re.fullmatch(r"\w+", name) else f'"{name}"'


def _label(block: ElementBlock, face: int) -> str:
    """S1, S2, ... of a face in our order."""
    corners = {corner + 1 for corner in block.of.corner_faces[face]}
    labels = [{int(corner) for corner in label} for label in FACE_LABELS[block.of.corners]]
    return f"S{labels.index(corners) + 1}"
