"""External superelements of Nastran: the order of rows by EXTRN, and axes of motions, by a writer of our own."""

from pathlib import Path

import numpy as np
import pytest
from reduced_frames import PLACES, frame
from scipy.spatial.transform import Rotation

from gearwhine.housing import HousingError
from gearwhine.housing.reduced import LabelledMatrix, read_row_labels, reduced_matrices
from gearwhine.numerics.arrays import FloatArray

MASS, STIFFNESS = frame()
SCALARS = (9001, 9002, 9003)
TURN = Rotation.from_euler("zyx", [0.4, -0.7, 1.1]).as_matrix()
"""Axes of the coordinate system 7 as columns, in the basic one."""
ORIGIN = np.array([0.02, -0.03, 0.05])


def punch(path: Path, boundary: str, motion_system: str = "7", kind: str = "R") -> Path:
    """Write what EXTSEOUT writes: node 205, whose place is given in system 7, moves along the axes of a system."""
    points = [ORIGIN, ORIGIN + TURN[:, 2], ORIGIN + TURN[:, 0] + 0.3 * TURN[:, 2]]
    numbers = [f"{one:<16.12f}" for point in points for one in point]
    local = TURN.T @ (np.array(PLACES[205]) - ORIGIN)
    if kind == "C":
        local = np.array([np.hypot(*local[:2]), np.degrees(np.arctan2(local[1], local[0])), local[2]])
    if kind == "S":
        radius = np.linalg.norm(local)
        angles = np.arccos(local[2] / radius), np.arctan2(local[1], local[0])
        local = np.array([radius, *np.degrees(angles)])
    first, second, third = (f"{one:<16.11f}" for one in local)
    lines = ["$ EXTERNAL SUPERELEMENT", "BEGIN SUPER       75", "$"]
    lines += [f"CORD2{kind}*  {'7':<16}{'0':<16}{numbers[0]}{numbers[1]}", "*       " + "".join(numbers[2:6])]
    lines += ["*       " + "".join(numbers[6:9]), boundary]
    lines += ["GRID         101              0.      0.      0."]
    lines += [
        f"GRID*   {'205':<16}{'7':<16}{first}{second}",
        f"*       {third}{motion_system:<16}",
        "ASET     205  123",
    ]
    path.write_text("\n".join(lines) + "\n")
    return path


EXTRN = """\
EXTRN        205  123456    9001       0     101  123456    9002    THRU
            9003       0"""
ORDER = [(205, axis) for axis in range(1, 7)] + [(9001, 0)] + [(101, axis) for axis in range(1, 7)]
ORDER += [(9002, 0), (9003, 0)]


def local_axes(kind: str) -> FloatArray:
    """Axes of node 205 as rows: of the system itself, or radially, around and along its axis."""
    if kind == "R":
        return TURN.T
    away = np.array(PLACES[205]) - ORIGIN
    axis = TURN[:, 2]
    radial = away - axis * (axis @ away)
    radial /= np.linalg.norm(radial)
    around = np.cross(axis, radial)
    if kind == "C":
        return np.array([radial, around, axis])
    outward = away / np.linalg.norm(away)
    return np.array([outward, np.cross(around, outward), around])


def as_nastran_has_it(matrix: FloatArray, internal: FloatArray, kind: str) -> FloatArray:
    """Rows in the order of EXTRN, node 205 along its own axes: A K Aᵀ of its motions."""
    turn = np.eye(12)
    turn[6:9, 6:9] = turn[9:12, 9:12] = local_axes(kind)
    local = turn @ matrix @ turn.T
    whole = np.zeros((15, 15))
    whole[:12, :12], whole[12:, 12:] = local, np.diag(internal)
    rows = [*range(6, 12), 12, *range(6), 13, 14]
    return whole[np.ix_(rows, rows)]


@pytest.mark.parametrize("kind", ["R", "C", "S"])
def test_rows_and_axes_of_an_external_superelement(tmp_path: Path, kind: str) -> None:
    """With the axes of all nodes those of the basic system, the frame's own matrices come back."""
    labels = read_row_labels(punch(tmp_path / "se.pch", EXTRN, kind=kind))
    assert labels.coordinates == tuple(ORDER)
    assert set(labels.axes) == {205}
    np.testing.assert_allclose(labels.axes[205], local_axes(kind), atol=1e-9)
    read = {}
    for name, matrix in (("mass", MASS), ("stiffness", STIFFNESS)):
        given = as_nastran_has_it(matrix, np.array([2.0, 3.0, 4.0]), kind)
        read[name] = LabelledMatrix(given).with_rows(labels, "se.op4")
    made = reduced_matrices(read)
    rows = [made.rows(node)[axis] for node in (101, 205) for axis in range(1, 7)]
    for found, matrix in ((made.mass, MASS), (made.stiffness, STIFFNESS)):
        scale = np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))
        np.testing.assert_allclose(found[np.ix_(rows, rows)] / scale, matrix / scale, atol=1e-8)
    assert sorted(np.diag(made.stiffness)[-3:]) == [2.0, 3.0, 4.0]


def test_motions_along_the_basic_axes_stay_as_they_are(tmp_path: Path) -> None:
    labels = read_row_labels(punch(tmp_path / "se.asm", EXTRN, motion_system="0"))
    assert labels.coordinates == tuple(ORDER)
    assert not labels.axes


def test_default_system_of_motions(tmp_path: Path) -> None:
    """GRDSET gives the system of motions to nodes whose own field is blank."""
    path = punch(tmp_path / "se.bdf", EXTRN, motion_system="")
    path.write_text(path.read_text() + "GRDSET,,0,,,,7\n")
    labels = read_row_labels(path)
    assert set(labels.axes) == {101, 205}
    np.testing.assert_allclose(labels.axes[101], TURN.T, atol=1e-9)


@pytest.mark.parametrize(
    ("boundary", "words"),
    [
        ("EXTRN        205  123456     101", "card EXTRN has point '101' with components ''"),
        ("EXTRN        205     789", "card EXTRN has point '205' with components '789'"),
        ("EXTRN        x     123", "card EXTRN has point 'x'"),
        ("EXTRN        205  123456     205  123456", "point 205 stands twice in the card EXTRN"),
        ("EXTRN       9001    THRU99999999       0", "expected at most 3000 points"),
        ("EXTRN       9009    THRU    9001       0", "card EXTRN has point '9009'"),
        ("$", "has no card EXTRN"),
    ],
)
def test_wrong_boundaries(tmp_path: Path, boundary: str, words: str) -> None:
    path = punch(tmp_path / "se.pch", boundary)
    with pytest.raises(HousingError, match=f"se.pch: expected the punch file of EXTSEOUT; .*{words}"):
        read_row_labels(path)


def test_an_unknown_system_and_motions_that_cannot_be_turned(tmp_path: Path) -> None:
    with pytest.raises(HousingError, match="coordinate system 8, and no card of"):
        read_row_labels(punch(tmp_path / "se.pch", EXTRN, motion_system="8"))
    labels = read_row_labels(punch(tmp_path / "se.pch", "EXTRN        205   12456"))
    with pytest.raises(HousingError, match=r"k.op4: node 205 has 2 of its motions 1 to 3, along axes of its own"):
        LabelledMatrix(np.eye(5)).with_rows(labels, "k.op4")
