"""Matrices as text of Abaqus, CalculiX and Ansys, and of NetCDF: written by another program or from the manuals."""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from reduced_frames import FRAME_COORDINATES, frame
from solver_text import write_abaqus_terms, write_ansys_mapping, write_harwell_boeing, write_user_element

from gearwhine.housing import HousingError
from gearwhine.housing.reduced import LabelledMatrix, RowLabels, read_matrix, read_row_labels, reduced_matrices

MASS, STIFFNESS = frame()

# CalculiX 2.20: one tetrahedron of 1, 2 and 1.5 mm along x, y, z at the origin, its nodes 1 (the origin) and 2 (along
# x) held. SOLVER=MATRIXSTORAGE writes the first two, SUBSTRUCTURE GENERATE with 24.1 to 24.3 and 13.2 the third,
# which is of the other motions held.
TERMS_OF_CALCULIX = """\
1 1  1.0096153846154e+04
1 2  0.0000000000000e+00
2 2  3.5336538461539e+04
1 3  0.0000000000000e+00
2 3  0.0000000000000e+00
3 3  1.0096153846154e+04
1 4  0.0000000000000e+00
2 4  0.0000000000000e+00
3 4  0.0000000000000e+00
4 4  1.7948717948718e+04
1 5  0.0000000000000e+00
2 5  0.0000000000000e+00
3 5  1.3461538461538e+04
4 5  0.0000000000000e+00
5 5  1.7948717948718e+04
1 6  0.0000000000000e+00
2 6  2.0192307692308e+04
3 6  0.0000000000000e+00
4 6  0.0000000000000e+00
5 6  0.0000000000000e+00
6 6  6.2820512820513e+04
"""
ROWS_OF_CALCULIX = "13.1\n13.2\n13.3\n24.1\n24.2\n24.3\n"
ELEMENT_OF_CALCULIX = """\
**
** GENERATION OF SUBSTRUCTURE
*USER ELEMENT,NODES=          4,LINEAR
** ELEMENT NODES
**        24,        24,        24,        13,
         1
         2,         2
         3,         3
         4,         2
*MATRIX,TYPE=STIFFNESS
 0.1794871794872E+05,
 0.0000000000000E+00, 0.1794871794872E+05,
 0.0000000000000E+00, 0.0000000000000E+00, 0.6282051282051E+05,
 0.0000000000000E+00, 0.0000000000000E+00, 0.2019230769231E+05, 0.3533653846154E+05,
"""


def tetrahedron() -> dict[tuple[tuple[int, int], tuple[int, int]], float]:
    """Stiffness of nodes 13, along y, and 24, along z [N/mm]: V (λ ∂iN ∂jN' + μ (∂jN ∂iN' + δij ∂kN ∂kN')).

    The shape functions are y/2 and z/1.5, so that only their derivatives along y and z differ from zero.
    """
    lame, shear, volume = 2.1e5 * 0.3 / (1.3 * 0.4), 2.1e5 / 2.6, 0.5
    slopes = {13: np.array([0.0, 1.0 / 2.0, 0.0]), 24: np.array([0.0, 0.0, 1.0 / 1.5])}
    found = {}
    for one, left in slopes.items():
        for other, right in slopes.items():
            block = lame * np.outer(left, right) + shear * (np.outer(right, left) + left @ right * np.eye(3))
            for i, j in np.ndindex(3, 3):
                found[(one, i + 1), (other, j + 1)] = float(volume * block[i, j])
    return found


def test_terms_and_rows_of_calculix(tmp_path: Path) -> None:
    (tmp_path / "k.sti").write_text(TERMS_OF_CALCULIX)
    (tmp_path / "k.dof").write_text(ROWS_OF_CALCULIX)
    read = read_matrix(tmp_path / "k.sti").with_rows(read_row_labels(tmp_path / "k.dof"), "k.sti")
    closed = tetrahedron()
    assert read.coordinates is not None
    expected = [[closed[one, other] for other in read.coordinates] for one in read.coordinates]
    np.testing.assert_allclose(read.values, expected, rtol=1e-12)


def test_a_user_element_of_calculix(tmp_path: Path) -> None:
    (tmp_path / "k.mtx").write_text(ELEMENT_OF_CALCULIX)
    read = read_matrix(tmp_path / "k.mtx", kind="stiffness")
    assert read.coordinates == ((24, 1), (24, 2), (24, 3), (13, 2))
    closed = tetrahedron()
    expected = [[closed[one, other] for other in read.coordinates] for one in read.coordinates]
    np.testing.assert_allclose(read.values, expected, rtol=1e-12)


INTERNAL = [*FRAME_COORDINATES, (1, 0), (2, 0)]


def with_internal(matrix: np.ndarray) -> np.ndarray:
    """Matrix with two internal coordinates more, that are coupled with the first one."""
    values = np.zeros((14, 14))
    values[:12, :12] = matrix
    values[12:, 12:] = [[2.0, -1.0], [-1.0, 3.0]]
    values[0, 12:] = values[12:, 0] = [0.25, -0.5]
    return values


def in_order(read: LabelledMatrix) -> np.ndarray:
    """Values by the order of the frame's coordinates; internal ones follow as they are numbered."""
    assert read.coordinates is not None
    assert [one for one in sorted(read.coordinates) if one[1]] == sorted(FRAME_COORDINATES)
    internal = sorted(one for one in read.coordinates if not one[1])
    rows = [read.coordinates.index(one) for one in [*FRAME_COORDINATES, *internal]]
    return read.values[np.ix_(rows, rows)]


def test_both_triangles_are_taken_as_they_stand(tmp_path: Path) -> None:
    """Where any term has its mirror, one without is not mirrored: the matrix is refused later, as not symmetric."""
    (tmp_path / "k.sti").write_text("1 1 4.0\n1 2 1.0\n2 1 1.0\n2 2 4.0\n2 3 -2.0\n3 3 4.0\n")
    expected = [[4.0, 1.0, 0.0], [1.0, 4.0, -2.0], [0.0, 0.0, 4.0]]
    np.testing.assert_array_equal(read_matrix(tmp_path / "k.sti").values, expected)


@pytest.mark.parametrize("triangle", [True, False])
def test_terms_of_abaqus(tmp_path: Path, triangle: bool) -> None:
    for name, matrix in (("k", with_internal(STIFFNESS)), ("m", with_internal(MASS))):
        path = write_abaqus_terms(tmp_path / f"{name}.mtx", matrix, INTERNAL, triangle=triangle)
        np.testing.assert_allclose(in_order(read_matrix(path)), matrix, rtol=1e-15)


def test_a_substructure_of_abaqus(tmp_path: Path) -> None:
    both = {"stiffness": with_internal(STIFFNESS), "mass": with_internal(MASS)}
    path = write_user_element(tmp_path / "z1.mtx", both, INTERNAL)
    for kind, matrix in both.items():
        np.testing.assert_allclose(in_order(read_matrix(path, kind=kind)), matrix, rtol=1e-13)
        np.testing.assert_allclose(in_order(read_matrix(path, name=kind.upper())), matrix, rtol=1e-13)
    with pytest.raises(HousingError, match="expected the name of one of its matrices; it has 'STIFFNESS', 'MASS'"):
        read_matrix(path)


def test_motions_that_abaqus_holds_are_left_out(tmp_path: Path) -> None:
    """A boundary condition has 1e36 on the diagonal of the stiffness alone."""
    held = STIFFNESS.copy()
    held[4, 4] = 1e36
    k = read_matrix(write_abaqus_terms(tmp_path / "k.mtx", held, FRAME_COORDINATES))
    m = read_matrix(write_abaqus_terms(tmp_path / "m.mtx", MASS, FRAME_COORDINATES))
    made = reduced_matrices({"stiffness": k, "mass": m})
    assert made.coordinates == tuple(one for one in FRAME_COORDINATES if one != FRAME_COORDINATES[4])
    np.testing.assert_allclose(made.stiffness, np.delete(np.delete(STIFFNESS, 4, 0), 4, 1), rtol=1e-14)
    np.testing.assert_allclose(np.diag(made.mass), np.delete(np.diag(MASS), 4))


@pytest.mark.parametrize("kind", ["RSA", "RUA"])
@pytest.mark.parametrize("rhs", [True, False])
def test_harwell_boeing_of_ansys(tmp_path: Path, kind: str, rhs: bool) -> None:
    path = write_harwell_boeing(tmp_path / "k.matrix", with_internal(STIFFNESS), kind=kind, rhs=rhs)
    read = read_matrix(path)
    np.testing.assert_allclose(read.values, with_internal(STIFFNESS), rtol=1e-14)
    rows = read_row_labels(write_ansys_mapping(tmp_path / "k.mapping", INTERNAL))
    np.testing.assert_array_equal(in_order(read.with_rows(rows, "k.matrix")), read.values)


def test_netcdf_of_xarray(tmp_path: Path) -> None:
    nodes, axes = np.array(FRAME_COORDINATES).T
    arrays = {"K": (("i", "j"), STIFFNESS), "M": (("i", "j"), MASS), "nodes": ("i", nodes), "axes": ("i", axes)}
    xr.Dataset(arrays).to_netcdf(tmp_path / "box.nc", engine="h5netcdf")
    for kind, matrix in (("stiffness", STIFFNESS), ("mass", MASS)):
        read = read_matrix(tmp_path / "box.nc", kind=kind)
        np.testing.assert_array_equal(read.values, matrix)
        assert read.coordinates == tuple(FRAME_COORDINATES)


def large_netcdf(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset("k", (9_000_000, 9_000_000), "f8", chunks=(1000, 1000))


def text(*lines: str) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        path.write_text("\n".join([*lines, ""]))

    return write


ELEMENT = ("*USER ELEMENT, NODES=2, LINEAR", "** ELEMENT NODES", "** 4, 5")
HB = ("title", "  5 1 1 3", "RSA 2 2 3 0", "(3I4) (3I4) (1E12.4)", "   1   3   4", "   1   2   2")
HB_VALUES = ("  1.0000E+00", "  1.0000E-01", "  2.0000E+00")


def changed(number: int, line: str) -> Callable[[Path], None]:
    lines = [*HB, *HB_VALUES]
    lines[number] = line
    return text(*lines)


@pytest.mark.parametrize(
    ("name", "write", "words"),
    [
        ("k.mtx", text("** nothing"), "expected the terms of a matrix; it has none"),
        ("k.mtx", text("*CLOAD, REAL", "2,3, 5.4"), r"or a \*USER ELEMENT; it has \*CLOAD, REAL"),
        ("k.mtx", text("1,1, 1,1, 2.0", "1,1, 1"), "equally many in each line"),
        ("k.mtx", text("1,1, 1,1, many"), "expected numbers alone"),
        ("k.mtx", text("1,1, 1,1, nan"), "expected finite numbers"),
        ("k.mtx", text("1,1, 1,1"), "expected five numbers a line .* got 4"),
        ("k.mtx", text("1,1.5, 1,1, 2.0"), "expected whole numbers of rows and columns"),
        ("k.mtx", text("1,0, 1,1, 2.0"), "expected degrees of freedom from 1 to 499"),
        ("k.mtx", text("1,1, 1,1, 2.0", "1,1, 1,1, 2.0"), "expected each term once; row 1, column 1"),
        ("k.sti", text("0 1 2.0"), "expected rows and columns from 1 on"),
        ("k.sti", text("1 900000000 2.0"), "has 900000000 coordinates; expected at most 3000"),
        ("k.sti", text("1 9e99 2.0"), "expected whole numbers of rows"),
        ("k.mtx", text(*ELEMENT), r"and a \*MATRIX after them"),
        ("k.mtx", text(*ELEMENT, "1", "3, 2", "*MATRIX,TYPE=MASS", "1.0"), "degrees of freedom of each of the 2 nodes"),
        ("k.mtx", text(*ELEMENT, "*MATRIX,TYPE=MASS", "1.0"), "degrees of freedom of each of the 2 nodes"),
        (
            "k.mtx",
            text(*ELEMENT, "1", "*MATRIX,TYPE=MASS", "1.0, 0.5"),
            "3 numbers of its 2 degrees of freedom.* got 2",
        ),
        (
            "k.mtx",
            text(*ELEMENT, "1", "*MATRIX,TYPE=MASS", "1.0, x, 2.0"),
            "numbers in the matrix of type MASS",
        ),
        ("k.mtx", text(*ELEMENT, "one"), "line 4: expected whole numbers; got 'one'"),
        ("k.mtx", text(*ELEMENT, "1", *ELEMENT), r"line 5: expected one \*USER ELEMENT"),
        (
            "k.mtx",
            text(*ELEMENT[:2], "** 4, 4", "1", "*MATRIX,TYPE=MASS", "1"),
            "each degree of freedom of a node once",
        ),
        ("k.mtx", text(*ELEMENT, "1", "*MATRIX", "1"), r"line 5: expected \*MATRIX with a type"),
        ("k.mtx", text(*ELEMENT[:2], f"** {10**12}"), "line 3: expected numbers of nodes up to 1e"),
        ("k.hb", text("title"), "begins with four lines"),
        ("k.hb", changed(2, "CSA 2 2 3 0"), r"type RSA or RUA \(real, assembled\); got 'CSA'"),
        ("k.hb", changed(2, "RSA 2 3 3 0"), "holds 2 x 3; expected a square matrix"),
        ("k.hb", changed(2, "RSA 90000 90000 3 0"), "order 1 to 3000"),
        ("k.hb", changed(2, "RSA 2 2 900 0"), "from 1 to 4 entries; got 900"),
        ("k.hb", changed(3, "free"), "expected the formats of the numbers; got 'free'"),
        ("k.hb", changed(1, "  5 1 1 2"), "expected 3 numbers in 2 lines after line 6; got 2"),
        ("k.hb", changed(4, "   1   4   3"), "pointers that ascend from 1 to 4"),
        ("k.hb", changed(5, "   1   2   9"), "row indices from 1 to 2"),
        ("k.hb", changed(6, "  1.0000F+00"), "expected real numbers"),
        ("k.hb", changed(6, "       1e999"), "expected finite numbers"),
        ("k.hb", changed(1, "  5 1 1 many"), "expected whole numbers"),
        ("k.nc", text("no file of HDF5"), "expected variables of a NetCDF4 file"),
        ("k.nc", large_netcdf, "holds 9000000 x 9000000"),
    ],
)
def test_damaged_files(tmp_path: Path, name: str, write: Callable[[Path], None], words: str) -> None:
    write(tmp_path / name)
    with pytest.raises(HousingError, match=words):
        read_matrix(tmp_path / name)


def test_the_example_of_damage_is_whole_where_nothing_is_changed(tmp_path: Path) -> None:
    text(*HB, *HB_VALUES)(tmp_path / "k.hb")
    np.testing.assert_array_equal(read_matrix(tmp_path / "k.hb").values, [[1.0, 0.1], [0.1, 2.0]])


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (("nothing",), "from 1 to 3000; got 0"),
        (("1 5 UX", "3 5 UY"), "expected equation 2; got 3"),
        (("7.1",) * 3001, "from 1 to 3000; got 3001"),
    ],
)
def test_damaged_mappings(tmp_path: Path, lines: tuple[str, ...], words: str) -> None:
    text(*lines)(tmp_path / "k.mapping")
    with pytest.raises(HousingError, match=words):
        read_row_labels(tmp_path / "k.mapping")


def test_rows_of_another_number_or_named_twice(tmp_path: Path) -> None:
    read, rows = LabelledMatrix(MASS), RowLabels(tuple(FRAME_COORDINATES))
    with pytest.raises(HousingError, match=r"m.hb is of order 12; expected 2, the rows of the mapping"):
        read.with_rows(RowLabels(((1, 1), (1, 2))), "m.hb")
    with pytest.raises(HousingError, match=r"m.hb names its nodes itself"):
        read.with_rows(rows, "m.hb").with_rows(rows, "m.hb")
