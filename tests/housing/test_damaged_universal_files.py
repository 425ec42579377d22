"""Universal files damaged in every way: cut, swapped, of other bytes, or without what they name."""

import contextlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from universal_surveys import FUNCTION, POINTS, SHAPE, by_pyuff, one_function, survey

from gearwhine.housing import HousingError
from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured import read_universal, write_universal


def damaged(path: Path, change: Callable[[bytes], bytes]) -> Path:
    path.write_bytes(change(path.read_bytes()))
    return path


def swap(content: bytes) -> bytes:
    """Turn the bytes of the binary part around, and leave the header as it is."""
    start = content.index(b"    58b")
    start = start + 12 * 81
    numbers = np.frombuffer(content[start : start + 50 * 3 * 8], dtype="<f8")
    return content[:start] + numbers.astype(">f8").tobytes() + content[start + 50 * 3 * 8 :]


def test_swapped_bytes_are_named(tmp_path: Path) -> None:
    with pytest.raises(MeasuredDataError, match=r"swapped.*little-endian"):
        read_universal(damaged(one_function(tmp_path / "swapped.uff"), swap))


def test_bytes_of_no_meaning_are_named(tmp_path: Path) -> None:
    def scramble(content: bytes) -> bytes:
        start = content.index(b"    58b") + 12 * 81
        rng = np.random.default_rng(0)
        noise = bytes(rng.integers(128, 255, 50 * 3 * 8).astype(np.uint8))
        return content[:start] + noise + content[start + 50 * 3 * 8 :]

    with pytest.raises(MeasuredDataError, match=r"58, functions.*no meaning"):
        read_universal(damaged(one_function(tmp_path / "noise.uff"), scramble))


@pytest.mark.parametrize("part", [0.2, 0.5, 0.9, 0.97])
def test_a_file_cut_short_is_refused_wherever_it_ends(tmp_path: Path, part: float) -> None:
    path = tmp_path / "cut.uff"
    write_universal(path, survey())
    with pytest.raises(MeasuredDataError, match=r"cut short|cannot be read"):
        read_universal(damaged(path, lambda content: content[: int(part * len(content))]))


@pytest.mark.parametrize(("kind", "lines"), [("15", 1), ("55", 1), ("55", 3)])
def test_a_dataset_that_lost_lines_is_named(tmp_path: Path, kind: str, lines: int) -> None:
    path = by_pyuff(tmp_path / "lines.uff", POINTS, SHAPE)

    def lose(content: bytes) -> bytes:
        rows = content.split(b"\n")
        start = next(index for index, row in enumerate(rows) if row.strip() == kind.encode())
        stop = next(index for index in range(start, len(rows)) if rows[index].strip() == b"-1")
        kept = rows[stop - lines][:30] if kind == "15" else b""
        return b"\n".join([*rows[: stop - lines], *([kept] if kept else []), *rows[stop:]])

    with pytest.raises(MeasuredDataError, match=rf"\({kind}, .*cut short"):
        read_universal(damaged(path, lose))


def test_a_function_of_fewer_values_than_it_says_is_named(tmp_path: Path) -> None:
    path = by_pyuff(tmp_path / "few.uff", POINTS, FUNCTION)
    with pytest.raises(MeasuredDataError, match=r"58, functions.*says 12 values and holds 10: cut short"):
        read_universal(
            damaged(path, lambda content: content.replace(b"        10         1  1.0", b"        12         1  1.0"))
        )


@pytest.mark.parametrize("content", [b"", b"not a universal file", b"\x00\xff" * 500, b"    -1\n    -1\n"])
def test_nonsense_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "nonsense.uff"
    path.write_bytes(content)
    with pytest.raises(MeasuredDataError, match=r"no universal file|has no number"):
        read_universal(path)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_file_with_any_bytes_changed_is_read_or_refused_by_name(tmp_path: Path, data: st.DataObject) -> None:
    path = tmp_path / "fuzz.uff"
    write_universal(path, survey())
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(bytes(content))
    with contextlib.suppress(HousingError):  # and not a stumble of pyuff or numpy
        read_universal(path)


def test_functions_without_points_are_refused(tmp_path: Path) -> None:
    with pytest.raises(MeasuredDataError, match=r"holds functions but no points.*name both, in a list"):
        read_universal(by_pyuff(tmp_path / "functions.uff", FUNCTION))
    with pytest.raises(MeasuredDataError, match="holds no points, no shapes of modes and no frequency responses"):
        read_universal(by_pyuff(tmp_path / "history.uff", FUNCTION | {"func_type": 1}))


def test_unknown_nodes_are_named(tmp_path: Path) -> None:
    with pytest.raises(MeasuredDataError, match="mode 1 names node 9, which is not among"):
        read_universal(by_pyuff(tmp_path / "s.uff", POINTS, SHAPE | {"node_nums": [1, 2, 9]}))
    with pytest.raises(MeasuredDataError, match="the function 9:3 by 1:-2 names node 9"):
        read_universal(by_pyuff(tmp_path / "f.uff", POINTS, FUNCTION | {"rsp_node": 9}))
    with pytest.raises(MeasuredDataError, match="coordinate system 7, which the file does not hold"):
        read_universal(by_pyuff(tmp_path / "p.uff", POINTS | {"def_cs": [0, 7, 0]}))
