"""Two hundred damaged universal files: each is refused by the command with its name and exit code 2, quickly."""

import random
import re
import time
import tracemalloc
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from universal_layouts import (
    elements_2412,
    function_58,
    header,
    points_15,
    points_2411,
    results_2414,
    shape_55,
    systems_2420,
    trace_82,
    units,
)

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured import MeasuredGeometry, MeasuredResponses, SurveyData, read_universal, write_universal
from gearwhine.housing.measured.universal_datasets import LARGEST_FILE

CASE = """
title = "a box"

[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"

[housing]
material = "steel"
modes = 4

[housing.box]
size = ["200 mm", "160 mm", "240 mm"]
wall = "13 mm"
mesh_size = "50 mm"

[measured]
file = "survey.unv"
"""

REFUSED = 200
PLACES = {node: [float(node), 2.0 * node, 3.0] for node in range(101, 113)}
RNG = np.random.default_rng(11)


def shape(*, twisted: bool = False) -> dict[int, list[complex]]:
    values = RNG.normal(size=(12, 3)) + (1j * RNG.normal(size=(12, 3)) if twisted else 0.0)
    return dict(zip(PLACES, values.tolist(), strict=True))


def sources(folder: Path) -> dict[str, bytes]:
    """Three files: as NX writes one, as programs for modal tests do, and with functions in binary."""
    tilted = [[0, 1, 0], [-1, 0, 0], [0, 0, 1], [5, 0, 0]]
    response = RNG.normal(size=9) + 1j * RNG.normal(size=9)
    functions = [function_58(response, response=(node, 3), reference=(101, 3)) for node in (101, 105)]
    new = [header(), units(5, 1e3, 1e3), systems_2420({4: tilted}), points_2411(PLACES, 4)]
    new += [elements_2412({1: [101, 102, 103, 104]}), trace_82(list(PLACES)), *functions]
    new += [results_2414(shape(), hertz=658.0, viscous=0.01), results_2414(shape(twisted=True), eigenvalue=-9 + 4e3j)]
    old = [header(), units(1, 1.0, 1.0), points_15(PLACES), trace_82(list(PLACES))]
    old += [shape_55(shape(), hertz=658.0), shape_55(shape(twisted=True), eigenvalue=-9 + 4e3j)]
    old += [function_58(response, response=(node, 1), reference=(101, 3), even=False) for node in PLACES]
    geometry = MeasuredGeometry(("1", "2"), np.eye(3)[:2], np.array([0, 1]), np.eye(3)[:2])
    values = RNG.normal(size=(2, 1, 40)) + 1j * RNG.normal(size=(2, 1, 40))
    measured = MeasuredResponses(geometry, np.array([0]), np.eye(3)[:1], 1.0 + np.arange(40.0), values)
    write_universal(folder / "binary.uff", SurveyData(geometry, None, measured))
    text = {"as of NX": new, "as of a modal test": old}
    made = {name: "".join(datasets).encode("ascii") for name, datasets in text.items()}
    return made | {"binary": (folder / "binary.uff").read_bytes()}


STRANGE = (
    b"nan",
    b"inf",
    b"-1",
    b"0",
    b"x",
    b"1e400",
    b"999999999",
    b"-999999999",
    b"1.5",
    b"\xff\xfe",
    b"",
    b"********",
)


def flipped(content: bytes, draw: random.Random) -> bytes:
    changed = bytearray(content)
    for _ in range(draw.randint(1, 20)):
        changed[draw.randrange(len(changed))] = draw.randrange(256)
    return bytes(changed)


def ended(content: bytes, draw: random.Random) -> bytes:
    return content[: draw.randrange(len(content) - 100)]


def cut(content: bytes, draw: random.Random) -> bytes:
    start, end = sorted(draw.randrange(len(content)) for _ in range(2))
    return content[:start] + content[end:]


def doubled(content: bytes, draw: random.Random) -> bytes:
    start, end = sorted(draw.randrange(len(content)) for _ in range(2))
    return content[:end] + content[start:]


def lines_lost(content: bytes, draw: random.Random) -> bytes:
    lines = content.splitlines(keepends=True)
    for _ in range(draw.randint(1, 4)):
        del lines[draw.randrange(len(lines))]
    return b"".join(lines)


def numbers_changed(content: bytes, draw: random.Random) -> bytes:
    """Some numbers become strange ones of the same width."""
    places = list(re.finditer(rb"(?<= )-?\d[\d.+-EeDd]*", content))
    for match in sorted(draw.sample(places, draw.randint(1, 4)), key=lambda one: -one.start()):
        content = content[: match.start()] + draw.choice(STRANGE).rjust(len(match[0])) + content[match.end() :]
    return content


MUTATIONS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    *(flipped, ended, cut, doubled, lines_lost),
    *(numbers_changed, numbers_changed),
)


def refusal(path: Path) -> str | None:
    """Return what a file is refused with; None where it is read."""
    try:
        read_universal(path)
    except MeasuredDataError as error:
        return str(error)
    return None


@pytest.mark.slow
def test_two_hundred_damaged_files_are_refused_by_name(gearwhine, tmp_path: Path) -> None:
    draw = random.Random(7)
    (tmp_path / "box.toml").write_text(CASE, encoding="utf-8")
    path = tmp_path / "survey.unv"
    given = sources(tmp_path)
    refused: Counter[str] = Counter()
    drawn = 0
    while sum(refused.values()) < REFUSED:
        drawn += 1
        assert drawn < 3 * REFUSED, refused
        mutation = MUTATIONS[drawn % len(MUTATIONS)]
        path.write_bytes(mutation(draw.choice(list(given.values())), draw))
        start = time.process_time()
        tracemalloc.start()
        said = refusal(path)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        if said is None:
            continue  # the damage is in text that says nothing
        assert "survey.unv" in said or re.search(r"mode \d|function|point \d|trace line|coordinate|shape", said)
        outcome = gearwhine("check", "box.toml")
        assert outcome.code == 2, outcome.err
        assert "measured.file" in outcome.err
        assert "survey.unv" in outcome.err
        assert time.process_time() - start < 10.0
        assert peak < 2e8
        refused[mutation.__name__] += 1
    assert min(refused.values()) > 5


def test_a_file_of_a_gigabyte_is_refused_before_it_is_read(gearwhine, tmp_path: Path) -> None:
    (tmp_path / "box.toml").write_text(CASE, encoding="utf-8")
    with (tmp_path / "survey.unv").open("wb") as file:
        file.truncate(LARGEST_FILE + 1)
    tracemalloc.start()
    with pytest.raises(MeasuredDataError, match=r"survey\.unv has 500000001 bytes; expected at most 500 MB"):
        read_universal(tmp_path / "survey.unv")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1e6


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (2414, lambda: results_2414(shape(), hertz=1.0).replace("         3\n         0", " 999999999\n         0")),
        (55, lambda: shape_55(shape(), hertz=1.0).replace("         3\n         2", " 999999999\n         2")),
        (
            58,
            lambda: function_58([1j] * 9, response=(101, 3), reference=(101, 3)).replace("         9", " 999999999", 1),
        ),
    ],
)
def test_counts_that_no_file_holds_take_no_memory(tmp_path: Path, number: int, text: Callable[[], str]) -> None:
    path = tmp_path / "huge.unv"
    content = text()
    assert "999999999" in content
    path.write_text(points_15(PLACES) + content, encoding="ascii")
    tracemalloc.start()
    with pytest.raises(MeasuredDataError, match=rf"dataset 2 of huge\.unv \({number}, .*999999999"):
        read_universal(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1e7
