"""A frame of two bodies on a beam as mass and stiffness matrices, and writers of matrices for other programs."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from gearwhine.numerics.arrays import FloatArray

YOUNGS_MODULUS, SHEAR_MODULUS = 2.1e11, 8.0e10
LENGTH, AREA, SECOND_MOMENT, TORSION_CONSTANT = 0.4, 1.2e-3, 4.0e-7, 6.0e-7
MASS, TILT_INERTIA, POLAR_INERTIA = 12.0, 0.05, 0.08
FRAME_COORDINATES = [(node, axis) for node in (101, 205) for axis in range(1, 7)]
PLACES = {101: (0.0, 0.0, 0.0), 205: (0.0, 0.0, LENGTH)}


def frame(length: float = 1.0, mass: float = 1.0) -> tuple[FloatArray, FloatArray]:
    """Mass and stiffness of the frame along z, (12, 12), in units of a length [m] and a mass [kg] with seconds."""
    force = mass * length
    e, g = YOUNGS_MODULUS * length**2 / force, SHEAR_MODULUS * length**2 / force
    span, area = LENGTH / length, AREA / length**2
    second, torsion = SECOND_MOMENT / length**4, TORSION_CONSTANT / length**4
    stiffness = np.zeros((12, 12))
    for row, amount in ((2, e * area / span), (5, g * torsion / span)):
        stiffness[np.ix_([row, row + 6], [row, row + 6])] += amount * np.array([[1.0, -1.0], [-1.0, 1.0]])
    bending = (
        e
        * second
        / span**3
        * np.array(
            [
                [12.0, 6.0 * span, -12.0, 6.0 * span],
                [6.0 * span, 4.0 * span**2, -6.0 * span, 2.0 * span**2],
                [-12.0, -6.0 * span, 12.0, -6.0 * span],
                [6.0 * span, 2.0 * span**2, -6.0 * span, 4.0 * span**2],
            ]
        )
    )
    # The slope of x along z is a rotation about +y, that of y one about -x.
    for rows, signs in (([0, 4, 6, 10], np.ones(4)), ([1, 3, 7, 9], np.array([1.0, -1.0, 1.0, -1.0]))):
        stiffness[np.ix_(rows, rows)] += signs[:, None] * bending * signs
    tilt, polar = TILT_INERTIA / (mass * length**2), POLAR_INERTIA / (mass * length**2)
    body = [MASS / mass] * 3 + [tilt, tilt, polar]
    return np.diag(body * 2), stiffness


def write_matrix_market(path: Path, matrix: FloatArray) -> Path:
    """Write the lower triangle of a symmetric matrix, one entry a line."""
    rows, columns = np.nonzero(np.tril(matrix))
    lines = [f"{i + 1} {j + 1} {float(matrix[i, j])!r}" for i, j in zip(rows, columns, strict=True)]
    header = ["%%MatrixMarket matrix coordinate real symmetric", f"{len(matrix)} {len(matrix)} {len(lines)}"]
    path.write_text("\n".join([*header, *lines]) + "\n")
    return path


def write_dmig(
    path: Path,
    matrices: dict[str, FloatArray],
    coordinates: Sequence[tuple[int, int]],
    *,
    field: str = "large",
    is_symmetric: bool = True,
) -> Path:
    """Write DMIG entries in free, small or large fields, a continuation for each group of terms."""
    lines = ["$ reduced by another program", "BEGIN BULK"]
    for name, matrix in matrices.items():
        lines.append(
            _line(field, ["DMIG", name, "0", "6" if is_symmetric else "1", "2", "0", "", "", str(len(matrix))])
        )
        for column, (node, axis) in enumerate(coordinates):
            rows = [row for row in range(column if is_symmetric else 0, len(matrix)) if matrix[row, column]]
            if not rows:
                continue
            terms = [[*map(str, coordinates[row]), _number(field, float(matrix[row, column]))] for row in rows]
            head = ["DMIG" + "*" * (field == "large"), name, str(node), str(axis), ""]
            if field == "large":
                lines.append(_line(field, head))
                lines += [_line(field, ["*", *term]) for term in terms]
            else:
                lines.append(_line(field, [*head, *terms[0]]))
                lines += [_line(field, ["", *term]) for term in terms[1:]]
    path.write_text("\n".join([*lines, "ENDDATA"]) + "\n")
    return path


def _number(field: str, value: float) -> str:
    if field == "free":
        return repr(value).replace("e", "D") if "e" in repr(value) else repr(value)
    if field == "large":
        return f"{value:.9E}"
    mantissa, exponent = f"{value:.2E}".split("E")  # as 1.23+7: eight characters have no room for the letter
    return f"{mantissa}{int(exponent):+d}"


def _line(field: str, fields: list[str]) -> str:
    if field == "free":
        return ",".join(fields)
    width = 16 if fields[0].endswith("*") else 8
    return f"{fields[0]:8}" + "".join(f"{one:>{width}}" for one in fields[1:])
