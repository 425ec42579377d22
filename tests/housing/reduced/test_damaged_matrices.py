"""Damaged files of matrices, with seeded mutations: two hundred and more are refused by name, the others read."""

import random
import time
import tracemalloc
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from reduced_frames import FRAME_COORDINATES, frame, write_dmig, write_matrix_market
from solver_text import write_abaqus_terms, write_ansys_mapping, write_harwell_boeing, write_user_element

from gearwhine.housing import HousingError
from gearwhine.housing.reduced import ReducedMatrices, read_matrix, read_row_labels, reduced_matrices, write_matrices
from gearwhine.housing.reduced.matrices import MOST_COORDINATES

MASS, STIFFNESS = frame()
TIMES_A_FORMAT = 40
STRANGE = ("0", "-1", "1e308", "nan", "inf", "9" * 30, "9" * 6, "1e9", "", "x", "*MATRIX", "2147483647", "-2147483648")


def sources(folder: Path) -> list[Path]:
    """A file of each format."""
    both = ReducedMatrices(MASS, STIFFNESS, tuple(FRAME_COORDINATES))
    for name in ("box.npz", "box.nc", "box.op4", "box.pch"):
        write_matrices(folder / name, both)
    write_dmig(folder / "free.bdf", {"KAAX": STIFFNESS}, FRAME_COORDINATES, field="free")
    write_matrix_market(folder / "market.mtx", STIFFNESS)
    write_abaqus_terms(folder / "terms.mtx", STIFFNESS, FRAME_COORDINATES)
    write_user_element(folder / "element.mtx", {"stiffness": STIFFNESS, "mass": MASS}, FRAME_COORDINATES)
    write_harwell_boeing(folder / "k.matrix", STIFFNESS)
    write_ansys_mapping(folder / "k.mapping", FRAME_COORDINATES)
    return sorted(folder.iterdir())


def damaged(content: bytes, draw: random.Random) -> bytes:
    """A few bytes, a piece, or numbers changed."""
    kind = draw.randrange(4)
    start, end = sorted(draw.randrange(len(content)) for _ in range(2))
    if kind == 0:
        changed = bytearray(content)
        for _ in range(draw.randint(1, 12)):
            changed[draw.randrange(len(changed))] = draw.randrange(256)
        return bytes(changed)
    if kind == 1:
        return content[:start] + content[end:]
    if kind == 2:
        return content[:end] + content[start:]
    parts = content.split(b" ")
    for _ in range(draw.randint(1, 4)):
        parts[draw.randrange(len(parts))] = draw.choice(STRANGE).encode()
    return b" ".join(parts)


def test_damaged_files_are_refused_by_name_or_read(tmp_path: Path) -> None:
    (tmp_path / "whole").mkdir()
    (tmp_path / "damaged").mkdir()
    outcome, slowest, largest = Counter[str](), 0.0, 0
    for file in sources(tmp_path / "whole"):
        content = file.read_bytes()
        for seed in range(TIMES_A_FORMAT):
            path = tmp_path / "damaged" / file.name
            path.write_bytes(damaged(content, random.Random(f"{file.name} {seed}")))
            tracemalloc.start()
            begin = time.process_time()
            try:
                if file.suffix in (".mapping", ".dof"):
                    assert len(read_row_labels(path).coordinates) <= MOST_COORDINATES
                else:
                    read = read_matrix(path, kind="stiffness")
                    assert read.values.shape[0] == read.values.shape[1] <= MOST_COORDINATES
                    nodes = [] if read.coordinates is not None else [1]
                    reduced_matrices({"mass": read, "stiffness": read}, nodes)
                outcome["read"] += 1
            except HousingError as error:
                told = file.name in str(error) or "reduced housing" in str(error)
                outcome["refused" if told else f"without a name: {error}"] += 1
            slowest = max(slowest, time.process_time() - begin)
            largest = max(largest, tracemalloc.get_traced_memory()[1])
            tracemalloc.stop()
    assert set(outcome) == {"refused", "read"}, outcome
    assert outcome["refused"] >= 200
    assert slowest < 10.0
    assert largest < 1e9


def test_whole_files_are_read(tmp_path: Path) -> None:
    for file in sources(tmp_path):
        if file.suffix in (".mapping", ".dof"):
            assert read_row_labels(file).coordinates == tuple(FRAME_COORDINATES)
        else:
            np.testing.assert_allclose(read_matrix(file, kind="stiffness").values, STIFFNESS, rtol=1e-9)


def test_an_archive_that_unpacks_to_much_is_refused_before_it_does(tmp_path: Path) -> None:
    """A megabyte of zeros packs into a thousandth: the array of order 9000 is refused by its header."""
    np.savez_compressed(tmp_path / "bomb.npz", k=np.zeros((9000, 900)))
    with pytest.raises(HousingError, match=r"bomb.npz: array 'k' holds 9000 x 900; expected a square matrix"):
        read_matrix(tmp_path / "bomb.npz")
