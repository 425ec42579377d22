"""Reduced matrices from files of other programs, each written here without the readers; damaged ones are refused."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from reduced_frames import FRAME_COORDINATES, frame, write_dmig, write_matrix_market
from scipy import io as scipy_io

from gearwhine.housing import HousingError
from gearwhine.housing.reduced import read_matrix

MASS, STIFFNESS = frame()


def test_matrix_market_by_triangle_and_by_array(tmp_path: Path) -> None:
    sparse = read_matrix(write_matrix_market(tmp_path / "k.mtx", STIFFNESS))
    scipy_io.mmwrite(tmp_path / "dense.mtx", STIFFNESS, precision=17)
    dense = read_matrix(tmp_path / "dense.mtx")
    assert sparse.coordinates is None
    np.testing.assert_array_equal(sparse.values, STIFFNESS)
    np.testing.assert_array_equal(dense.values, STIFFNESS)


def test_arrays_by_name(tmp_path: Path) -> None:
    np.savez(tmp_path / "both.npz", m=MASS, k=STIFFNESS)
    np.savez_compressed(tmp_path / "one.npz", k=STIFFNESS)
    np.testing.assert_array_equal(read_matrix(tmp_path / "both.npz", name="m").values, MASS)
    np.testing.assert_array_equal(read_matrix(tmp_path / "one.npz").values, STIFFNESS)
    with pytest.raises(HousingError, match=r"both.npz: expected the name of one of its matrices; it has 'k', 'm'"):
        read_matrix(tmp_path / "both.npz")


@pytest.mark.parametrize(("field", "tolerance"), [("free", 1e-15), ("large", 1e-9), ("small", 5e-3)])
@pytest.mark.parametrize("is_symmetric", [True, False])
def test_dmig_in_each_field(tmp_path: Path, field: str, tolerance: float, is_symmetric: bool) -> None:
    matrices = {"KAAX": STIFFNESS, "MAAX": MASS}
    path = write_dmig(tmp_path / "r.pch", matrices, FRAME_COORDINATES, field=field, is_symmetric=is_symmetric)
    for name, matrix in matrices.items():
        read = read_matrix(path, name=name)
        assert read.coordinates == tuple(FRAME_COORDINATES)
        np.testing.assert_allclose(read.values, matrix, rtol=tolerance)


def test_terms_in_one_line_and_scalar_points(tmp_path: Path) -> None:
    """Two terms in a line of free fields, with the imaginary part left empty; a scalar point comes last."""
    text = "DMIG,K,0,6,1,0,,,3\nDMIG,K,7,0,,7,0,5.\nDMIG,K,9,1,,9,1,4.+1\n,9,2,-1.5-1,,7,,2.D0\nDMIG,K,9,2,,9,2,3.\n"
    (tmp_path / "k.bdf").write_text(text)
    read = read_matrix(tmp_path / "k.bdf")
    assert read.coordinates == ((9, 1), (9, 2), (7, 0))
    np.testing.assert_array_equal(read.values, [[40.0, -0.15, 2.0], [-0.15, 3.0, 0.0], [2.0, 0.0, 5.0]])


HEAD = "DMIG,K,0,6,2,0,,,1\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "expected a matrix 'K'; it has none at all"),
        ("DMIG,M,0,6,2,0,,,1\n", "expected a matrix 'K'; it has 'M'"),
        ("DMIG,K,0,2,2,0,,,1\n", r"line 1: expected a form of 1 \(square\) or 6"),
        ("DMIG,K,0,6,4,0,,,1\n", r"line 1: expected a type of 1 or 2 \(real\); got '4'"),
        (HEAD, "expected columns of the matrix 'K'"),
        (HEAD + "DMIG,K,1,1,,1,1\n", "line 2: expected a real number; got ''"),
        (HEAD + "DMIG,K,1,1,,1,1,1.2.3\n", "line 2: expected a real number; got '1.2.3'"),
        (HEAD + "DMIG,K,1,1,,1,1,nan\n", "line 2: expected a finite number"),
        (HEAD + "DMIG,K,1,7,,1,1,2.\n", "component from 0 to 6; got '1' and '7'"),
        (HEAD + "DMIG,K,1,1,,1,1,2.\nDMIG,K,1,1,,1,1,2.\n", "line 3: expected each term once"),
        (HEAD + "DMIG,K,1,1,,1,2,2.\nDMIG,K,1,2,,1,1,2.\n", "expected one triangle"),
        (HEAD + "DMIG,K,1,1\n", "line 2: expected terms in the column"),
    ],
)
def test_damaged_dmig(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "k.pch").write_text(text)
    with pytest.raises(HousingError, match=words):
        read_matrix(tmp_path / "k.pch", name="K")


def cut_short(path: Path) -> None:
    write_matrix_market(path, STIFFNESS)
    path.write_text(path.read_text()[:200])


def complex_numbers(path: Path) -> None:
    path.write_text("%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1.0 2.0\n")


def too_large(path: Path) -> None:
    path.write_text("%%MatrixMarket matrix array real general\n9000000 9000000\n1.0\n")


def not_square(path: Path) -> None:
    path.write_text("%%MatrixMarket matrix array real general\n2 1\n1.0\n1.0\n")


def too_many_entries(path: Path) -> None:
    path.write_text("%%MatrixMarket matrix coordinate real general\n2 2 4000000000\n1 1 1.0\n")


def of_objects(path: Path) -> None:
    np.savez(path, k=np.array([[{}]], dtype=object))


def large_array(path: Path) -> None:
    """A header that announces 648 TB."""
    header = b"\x93NUMPY\x01\x00" + (118).to_bytes(2, "little")
    header += b"{'descr': '<f8', 'fortran_order': False, 'shape': (9000000, 9000000), }".ljust(117) + b"\n"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("k.npy", header)


def no_archive(path: Path) -> None:
    path.write_bytes(b"PK\x03\x04 and no more")


@pytest.mark.parametrize(
    ("name", "write", "words"),
    [
        ("k.mtx", cut_short, "expected a Matrix Market file, complete to its end"),
        ("k.mtx", complex_numbers, "holds complex numbers; expected real ones"),
        ("k.mtx", too_large, "holds 9000000 x 9000000; expected a square matrix of order 1 to 3000"),
        ("k.mtx", not_square, "holds 2 x 1; expected a square matrix"),
        ("k.mtx", too_many_entries, "announces 4000000000 entries; expected at most 4"),
        ("k.npz", of_objects, "is of object; expected real numbers"),
        ("k.npz", large_array, "holds 9000000 x 9000000"),
        ("k.npz", no_archive, "expected arrays as numpy.savez writes them"),
        ("k.csv", complex_numbers, "expected a file that ends in one of .mtx, .npz"),
        ("none.mtx", lambda path: None, r"expected a readable file \(No such file"),
    ],
)
def test_damaged_files(tmp_path: Path, name: str, write: Callable[[Path], None], words: str) -> None:
    write(tmp_path / name)
    with pytest.raises(HousingError, match=words):
        read_matrix(tmp_path / name)


@pytest.mark.parametrize(("name", "megabytes"), [("k.pch", 100), ("k.mtx", 100), ("k.npz", 300)])
def test_a_file_too_large_is_not_read(tmp_path: Path, name: str, megabytes: int) -> None:
    with (tmp_path / name).open("wb") as file:
        file.truncate(megabytes * 10**6 + 1)  # a sparse file, which takes no room on the disk
    with pytest.raises(HousingError, match=f"{name}: expected a file of at most {megabytes} MB"):
        read_matrix(tmp_path / name)
