"""OUTPUT4 files of Nastran: files of another program, files of a writer of our own, and damaged ones."""

import base64
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.housing import HousingError
from gearwhine.housing.reduced import read_matrix

FloatArray = npt.NDArray[np.float64]

STIFFNESS = np.array([[4.0, -1.0, 0.0, 0.0], [-1.0, 5.0, 0.0, 2.5], [0.0, 0.0, 3e-7, 0.0], [0.0, 2.5, 0.0, 1e9]])
MASS = np.array([[1.0, 0.0, 0.0, 0.25], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 3.0, 0.0], [0.25, 0.0, 0.0, 4.0]])

# Both by pyyeti 1.4.7, `pyyeti.nastran.op4.write`: strings with two numbers in their heads, and with one.
TEXT_OF_PYYETI = """\
       4      -4       6       2KAA     1P,3E23.16
       1       0       6
       5       1
 4.0000000000000000E+00-1.0000000000000000E+00
       2       0      10
       5       1
-1.0000000000000000E+00 5.0000000000000000E+00
       3       4
 2.5000000000000000E+00
       3       0       4
       3       3
 2.9999999999999999E-07
       4       0       8
       3       2
 2.5000000000000000E+00
       3       4
 1.0000000000000000E+09
       5       1       1
 1.4142135623730951E+00
"""
RECORDS_OF_PYYETI = """
GAAAAAQAAAAEAAAABgAAAAIAAABLQUEgICAgIBgAAAAgAAAAAQAAAAAAAAAFAAAAAQAFAAAAAAAAABBAAAAAAAAA8L8gAAAALAAA
AAIAAAAAAAAACAAAAAEABQAAAAAAAADwvwAAAAAAABRABAADAAAAAAAAAARALAAAABgAAAADAAAAAAAAAAMAAAADAAMAdoMN9PUh
lD4YAAAAJAAAAAQAAAAAAAAABgAAAAIAAwAAAAAAAAAEQAQAAwAAAAAAZc3NQSQAAAAUAAAABQAAAAEAAAACAAAAzTt/Zp6g9j8U
AAAAGAAAAAQAAAAEAAAABgAAAAIAAABNQUEgICAgIBgAAAAkAAAAAQAAAAAAAAAGAAAAAQADAAAAAAAAAPA/BAADAAAAAAAAANA/
JAAAABgAAAACAAAAAAAAAAMAAAACAAMAAAAAAAAAAEAYAAAAGAAAAAMAAAAAAAAAAwAAAAMAAwAAAAAAAAAIQBgAAAAkAAAABAAA
AAAAAAAGAAAAAQADAAAAAAAAANA/BAADAAAAAAAAABBAJAAAABQAAAAFAAAAAQAAAAIAAADNO39mnqD2PxQAAAA=
"""


def test_files_of_another_program(tmp_path: Path) -> None:
    text, records = tmp_path / "text.op4", tmp_path / "records.op4"
    text.write_text(TEXT_OF_PYYETI)
    records.write_bytes(base64.b64decode(RECORDS_OF_PYYETI))
    np.testing.assert_array_equal(read_matrix(text).values, STIFFNESS)
    np.testing.assert_array_equal(read_matrix(records, name="kaa").values, STIFFNESS)
    np.testing.assert_array_equal(read_matrix(records, name="MAA").values, MASS)


def strings(column: FloatArray) -> list[tuple[int, FloatArray]]:
    """First row, from 1, and numbers of each run of a column that is not zero."""
    filled = np.flatnonzero(column)
    runs = np.split(filled, np.flatnonzero(np.diff(filled) > 1) + 1) if filled.size else []
    return [(int(run[0]) + 1, column[run]) for run in runs]


def binary(matrix: FloatArray, *, order: str = "<", single: bool = False, sparse: str = "", word: int = 4) -> bytes:
    def record(*parts: bytes) -> bytes:
        content = b"".join(parts)
        size = struct.pack(order + "i", len(content))
        return size + content + size

    def whole(*numbers: int) -> bytes:
        return struct.pack(f"{order}{len(numbers)}{'i' if word == 4 else 'q'}", *numbers)

    words, kind = (1, "f4") if single and word == 4 else (8 // word, "f8")
    rows = -len(matrix) if sparse == "two" else len(matrix)
    content = record(whole(len(matrix.T), rows, 2, 1 if single else 2), b"KGG".ljust(2 * word))
    for number, column in enumerate(matrix.T, start=1):
        parts = strings(column)
        if not sparse and parts:
            first, last = parts[0][0], parts[-1][0] + len(parts[-1][1]) - 1
            parts = [(first, column[first - 1 : last])]
        data = b""
        for first, numbers in parts:
            length = words * len(numbers) + 1
            head = {"": b"", "one": whole(first + 65536 * length), "two": whole(length, first)}[sparse]
            data += head + numbers.astype(order + kind).tobytes()
        if parts:
            content += record(whole(number, 0 if sparse else parts[0][0], len(data) // word), data)
    return content + record(whole(len(matrix.T) + 1, 1, 1), np.array([1.0], order + kind).tobytes())


@pytest.mark.parametrize("sparse", ["", "one", "two"])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("word", [4, 8])
def test_binary_files_of_each_kind(tmp_path: Path, sparse: str, order: str, single: bool, word: int) -> None:
    rng = np.random.default_rng(5)
    matrix = np.where(rng.random((30, 30)) < 0.4, rng.normal(size=(30, 30)), 0.0).astype(
        np.float32 if single else float
    )
    content = binary(matrix.astype(float), order=order, single=single, sparse=sparse, word=word)
    (tmp_path / "k.op4").write_bytes(content)
    np.testing.assert_array_equal(read_matrix(tmp_path / "k.op4", name="kgg").values, matrix)


def test_text_without_strings_and_other_exponents(tmp_path: Path) -> None:
    lines = ["       2       2       2       2KGG     1P,2D13.5"]
    lines += ["       1       1       2", "  1.50000D+03 -2.50000D+00", "       2       2       1", "  4.00000D-01"]
    (tmp_path / "k.op4").write_text("\n".join([*lines, "       3       1       1", "  1.00000D+00", ""]))
    np.testing.assert_array_equal(read_matrix(tmp_path / "k.op4").values, [[1500.0, 0.0], [-2.5, 0.4]])


def test_strings_of_single_precision_as_text(tmp_path: Path) -> None:
    """A string of two numbers of one word each, from row 1 on: 1 + 65536 (2 + 1)."""
    lines = ["       2       2       2       1KGG     1P,5E16.9", "       1       0       3", "      196609"]
    lines += [" 4.500000000E+00-1.500000000E+00", "       3       1       1", " 1.000000000E+00", ""]
    (tmp_path / "k.op4").write_text("\n".join(lines))
    np.testing.assert_array_equal(read_matrix(tmp_path / "k.op4").values, [[4.5, 0.0], [-1.5, 0.0]])


def text(*lines: str) -> Callable[[], bytes]:
    return lambda: "\n".join([*lines, ""]).encode()


HEAD = "       2       2       2       2KGG     1P,2E13.5"


def empty(name: bytes, rows: int, columns: int, kind: int) -> bytes:
    """A matrix without an entry: its head, and the record behind its last column."""
    head = struct.pack("<5i8si", 24, columns, rows, 2, kind, name.ljust(8), 24)
    return head + struct.pack("<4idi", 20, columns + 1, 1, 1, 1.0, 20)


def renamed(content: bytes, name: bytes) -> bytes:
    return content.replace(b"KGG     ", name.ljust(8), 1)


def test_external_superelements_have_loads_recovery_and_empty_matrices_beside_stiffness_and_mass(
    tmp_path: Path,
) -> None:
    """In the order of EXTSEOUT with MATOP4: K, M, empty B and K4, loads, and complex ones where there are any."""
    parts = [renamed(binary(STIFFNESS), b"KAA"), renamed(binary(MASS, sparse="one"), b"MAA"), empty(b"BXX", 1, 1, 2)]
    parts += [empty(b"PA", 4, 1, 2), empty(b"QHH", 4, 4, 4), renamed(binary(STIFFNESS[:3]), b"MUG1")]
    (tmp_path / "se.op4").write_bytes(b"".join(parts))
    np.testing.assert_array_equal(read_matrix(tmp_path / "se.op4", kind="stiffness").values, STIFFNESS)
    np.testing.assert_array_equal(read_matrix(tmp_path / "se.op4", kind="mass").values, MASS)
    with pytest.raises(HousingError, match=r"se.op4: MUG1 is 3 x 4; expected a square matrix"):
        read_matrix(tmp_path / "se.op4", name="mug1")
    with pytest.raises(HousingError, match=r"expected the name of one of its matrices; it has 'KAA', 'MAA'$"):
        read_matrix(tmp_path / "se.op4", kind="damping")
    (tmp_path / "twice.op4").write_bytes(2 * parts[0])
    with pytest.raises(HousingError, match="expected one matrix 'KAA'; it has 2 of this name"):
        read_matrix(tmp_path / "twice.op4", name="kaa")


def test_names_of_eight_byte_words_of_which_four_are_filled(tmp_path: Path) -> None:
    """MSC Nastran 2017 with integers of eight bytes writes LAMB, four blanks, DA and six blanks."""
    for name, read in (
        (b"LAMB    DA      ", "LAMBDA"),
        (b"LAMBDA          ", "LAMBDA"),
        (b"STIFFNESS       ", "stiffness"),
    ):
        content = binary(STIFFNESS, word=8).replace(b"KGG".ljust(16), name, 1)
        (tmp_path / "k.op4").write_bytes(content)
        np.testing.assert_array_equal(read_matrix(tmp_path / "k.op4", name=read).values, STIFFNESS)


def test_complex_numbers_of_single_precision_beside_real_ones(tmp_path: Path) -> None:
    """A string of two complex numbers as text has four real ones of a word each: 1 + 65536 (4 + 1)."""
    lines = ["       2       2       2       3B       1P,5E16.9", "       1       0       5", "      327681"]
    lines += [" 4.500000000E+00-1.500000000E+00 1.000000000E+00 2.000000000E+00", "       3       1       1"]
    lines += [" 1.000000000E+00", "       1       1       2       2KGG     1P,5E16.9", "       1       1       2"]
    lines += [" 7.000000000E+00", "       2       1       1", " 1.000000000E+00", ""]
    (tmp_path / "k.op4").write_text("\n".join(lines))
    np.testing.assert_array_equal(read_matrix(tmp_path / "k.op4").values, [[7.0]])


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (lambda: b"", "expected an OUTPUT4 file"),
        (lambda: b"not a matrix at all, but a sentence that goes on", "expected an OUTPUT4 file"),
        (lambda: binary(STIFFNESS)[:-30], "expected whole records"),
        (lambda: binary(STIFFNESS)[:100], "expected whole records"),
        (lambda: binary(STIFFNESS[:, :3]), "is 4 x 3; expected a square matrix"),
        (lambda: struct.pack("<i", 48) + bytes(60), "that at byte 0 is cut off"),
        (lambda: binary(np.where(STIFFNESS == 5.0, np.nan, STIFFNESS)), "not finite"),
        (lambda: binary(STIFFNESS, sparse="one").replace(struct.pack("<i", 1 + 65536 * 5), bytes(4)), "whole strings"),
        (
            lambda: binary(STIFFNESS, sparse="two").replace(struct.pack("<2i", 5, 1), struct.pack("<2i", 5, 4)),
            "rows 4 to 5 of column 1",
        ),
        (lambda: empty(b"KGG", 2, 2, 4), "matrix KGG is of type 4; expected 1 or 2"),
        (lambda: empty(b"KGG", 90000, 90000, 2), "order 1 to 3000"),
        (text(HEAD, "       1       1       2", "  1.50000E+03"), "complete to its end"),
        (text(HEAD, "       1       1       3", "  1.0 2.0 3.0"), "numbers 13 wide"),
        (text(HEAD, "       1       1 many"), "expected 3 whole numbers"),
        (text(HEAD.replace("1P,2E13.5", "free")), "expected the format of the numbers"),
        (text(HEAD, "       1       0       3", "  196609", "  1.50000E+03  1.50000E+03"), "1 numbers in a string"),
    ],
)
def test_damaged_files(tmp_path: Path, content: Callable[[], bytes], words: str) -> None:
    (tmp_path / "k.op4").write_bytes(content())
    with pytest.raises(HousingError, match=words):
        read_matrix(tmp_path / "k.op4")


def test_which_matrix_is_asked(tmp_path: Path) -> None:
    (tmp_path / "k.op4").write_bytes(base64.b64decode(RECORDS_OF_PYYETI))
    with pytest.raises(HousingError, match="expected the name of one of its matrices; it has 'KAA', 'MAA'"):
        read_matrix(tmp_path / "k.op4")
    with pytest.raises(HousingError, match="expected a matrix 'KGG'; it has 'KAA', 'MAA'"):
        read_matrix(tmp_path / "k.op4", name="kgg")


def test_cut_anywhere_a_file_is_refused_or_read(tmp_path: Path) -> None:
    whole = base64.b64decode(RECORDS_OF_PYYETI)
    for content in (whole, TEXT_OF_PYYETI.encode()):
        for length in range(0, len(content), 3):
            (tmp_path / "k.op4").write_bytes(content[:length])
            try:
                read_matrix(tmp_path / "k.op4", name="kaa")
            except HousingError:
                continue
