"""Writers of matrices as Abaqus and Ansys print them, written from their manuals without the readers."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Coordinates = Sequence[tuple[int, int]]

ANSYS = dict(enumerate(("MODE", "UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ")))


def abaqus_label(node: int, axis: int) -> tuple[int, int]:
    """Node and degree of freedom; internal coordinates are the first degree of freedom of nodes below 0."""
    return (node, axis) if axis else (-node, 1)


def write_abaqus_terms(path: Path, matrix: FloatArray, coordinates: Coordinates, *, triangle: bool = True) -> Path:
    """Write ``*MATRIX OUTPUT`` in the format of ``*MATRIX INPUT``: a line for each term that is not zero."""
    lines = ["** Assembled matrix"]
    for column, row in np.argwhere(np.triu(matrix) if triangle else matrix):
        labels = [*abaqus_label(*coordinates[row]), *abaqus_label(*coordinates[column])]
        lines.append("{},{}, {},{}, {:.15e}".format(*labels, matrix[row, column]))
    path.write_text("\n".join([*lines, ""]))
    return path


def write_user_element(path: Path, matrices: Mapping[str, FloatArray], coordinates: Coordinates) -> Path:
    """Write a substructure as a linear user element; nodes whose degrees of freedom differ are told by their place."""
    labels = [abaqus_label(*one) for one in coordinates]
    nodes = list(dict.fromkeys(node for node, _ in labels))
    lines = ["** ABAQUS SUBSTRUCTURE", f"*USER ELEMENT, NODES={len(nodes)}, LINEAR", "** ELEMENT NODES"]
    lines += [
        "** " + ", ".join(map(str, nodes[at : at + 8])) + "," * (at + 8 < len(nodes)) for at in range(0, len(nodes), 8)
    ]
    before: list[int] = []
    for place, node in enumerate(nodes, start=1):
        active = [axis for one, axis in labels if one == node]
        if active != before:
            lines.append(", ".join(map(str, active if place == 1 else [place, *active])))
        before = active
    for kind, matrix in matrices.items():
        lines.append(f"*MATRIX,TYPE={kind.upper()}")
        for row in range(len(matrix)):
            part = [f"{one:.14g}" for one in matrix[row, : row + 1].tolist()]
            lines += [" , ".join(part[at : at + 4]) + " ," * (row % 2) for at in range(0, row + 1, 4)]
    path.write_text("\n".join([*lines, ""]))
    return path


def write_harwell_boeing(path: Path, matrix: FloatArray, *, kind: str = "RSA", rhs: bool = False) -> Path:
    """Write a matrix by columns, whole or its lower triangle, a number a line for its values."""
    pointers, indices, values = [1], list[int](), list[float]()
    for column, numbers in enumerate(matrix.T):
        rows = [row for row in np.flatnonzero(numbers).tolist() if kind == "RUA" or row >= column]
        indices += [row + 1 for row in rows]
        values += numbers[rows].tolist()
        pointers.append(len(indices) + 1)
    parts = [
        [f"{one:14d}" for one in pointers],
        ["".join(f"{one:10d}" for one in indices[at : at + 6]) for at in range(0, len(indices), 6)],
        [f"{one:25.15E}".replace("E", "D") for one in values],
        ["  0.0"] * len(matrix) if rhs else [],
    ]
    counts = [len(part) for part in parts]
    lines = [f"{'Stiffness of a housing':72}KEY", "".join(f"{one:14d}" for one in (sum(counts), *counts))]
    lines.append(f"{kind:14}{len(matrix):14d}{len(matrix):14d}{len(values):14d}{0:14d}")
    lines.append(f"{'(1I14)':16}{'(6I10)':16}{'(1P,1D25.15)':20}{'(1E25.15)':20}")
    lines += [f"{'F':14}{1:14d}{0:14d}"] * rhs
    path.write_text("\n".join([*lines, *(line for part in parts for line in part), ""]))
    return path


def write_ansys_mapping(path: Path, coordinates: Coordinates) -> Path:
    """Write the node and degree of freedom of each equation."""
    lines = [f"{row:12d}{node:12d}    {ANSYS[axis]}" for row, (node, axis) in enumerate(coordinates, start=1)]
    path.write_text("\n".join(["  Matrix Eqn        Node    DOF", *lines, ""]))
    return path
