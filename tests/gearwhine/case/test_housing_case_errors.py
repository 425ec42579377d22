"""Every kind of wrong housing, seat, support, sensor or measured mode is reported by path, value and expectation."""

from __future__ import annotations

from typing import Any

import pytest
from broken_cases import GONE, check_one_wrong, check_several_wrong

NOWHERE_BOX = [["1 m", "1 m", "1 m"], ["2 m", "2 m", "2 m"]]
CAVITY_BOX = [["-10 mm", "70 mm", "-10 mm"], ["10 mm", "90 mm", "10 mm"]]

ONE_WRONG = {
    # units and numbers
    "boolean": ("housing.box.mesh_size", True, "housing.box.mesh_size", "a length"),
    "not a number": ("housing.box.mesh_size", float("nan"), "housing.box.mesh_size", "finite"),
    "rpm for a frequency": ("housing.frequency_limit", "3000 rpm", "housing.frequency_limit", "a frequency"),
    "box in metres": ("housing.box.size.0", 220, "housing.box.size[0]", "at most 20 m such as '6.35 mm'; plain"),
    "box of a hair": ("housing.box.size.1", "0.1 mm", "housing.box.size[1]", "of at least 0.001 m"),
    # ranges
    "damping per cent": ("housing.damping_ratio", 2, "housing.damping_ratio", "of at least 0 and below 1"),
    # keys, forms and choices
    "measured file": ("measured.file", "survey.uff", "measured.file", "an existing file"),
    "short vector": ("housing.box.size", ["1 m", "1 m"], "housing.box.size[2]", "a length"),
    "seat named ground": ("housing.seat.0.name", "ground", "housing.seat[0].name", "another name than 'ground'"),
    "seat named as a face": ("housing.seat.0.name", "front", "housing.seat[0].name", "of a face or foot"),
    "no such surface": ("housing.support.0.surface", "lid", "housing.support[0].surface", "left, right, bottom, top"),
    "direction": ("housing.sensor.0.direction", "up", "housing.sensor[0].direction", "'x', 'y' or 'z'"),
    "null direction": ("housing.sensor.0.direction", [0, 0, 0], "housing.sensor[0].direction", "a vector with a"),
    "two patches": ("housing.support.0.box", CAVITY_BOX, "housing.support[0]", "exactly one of 'box', 'surface'"),
    "held and sprung": ("housing.support.0.fixed", ["x"], "housing.support[0]", "either 'fixed', or"),
    "mesh file": ("housing.mesh", {"file": "none.msh"}, "housing.mesh.file", "an existing file"),
    "measured order": ("measured.frequencies", ["9 Hz", "3 Hz"], "measured.frequencies[1]", "above the one before"),
    "measured zero": ("measured.frequencies.0", "0 Hz", "measured.frequencies[0]", "above 0 Hz"),
    "damping table": ("housing.damping_ratio", {"often": 0.01}, "housing.damping_ratio", "such as '658 Hz' as a key"),
    # names
    "material": ("housing.material", "steal", "housing.material", "did you mean 'steel'?"),
    # places
    "seat in no wall": ("housing.seat.0.center.2", "0 mm", "housing.seat[0].center[2]", "in the back wall, -80 mm to"),
    "bore beyond": ("housing.seat.0.diameter", "150 mm", "housing.seat[0].diameter", "beyond the edge"),
    "boss beyond": (
        "housing.seat.0.boss",
        {"diameter": "180 mm", "length": "5 mm"},
        "housing.seat[0].boss.diameter",
        "a boss within its wall",
    ),
    "boss in its bore": (
        "housing.seat.0.boss",
        {"diameter": "52 mm", "length": "5 mm"},
        "housing.seat[0].boss.diameter",
        "wider than its bore",
    ),
    "bores touch": ("housing.seat.2.diameter", "127 mm", "housing.seat[2].diameter", "overlap by 0.6 mm"),
    "thick walls": ("housing.box.wall", "80 mm", "housing.box.wall", "leave room inside the 160 mm"),
    "large feet": ("housing.box.feet.size.0", "111 mm", "housing.box.feet.size[0]", "half the base along x, 110 mm"),
    "no feet": ("housing.box.feet", GONE, "housing.support[0].surface", "it has no feet"),
    "fifth foot": ("housing.support.0.surface", "foot-5", "housing.support[0].surface", "did you mean 'foot-"),
    "no such volume": (
        "housing.region",
        [{"name": "r", "material": "steel", "volume": "lid"}],
        "housing.region[0].volume",
        "a volume of the box (housing)",
    ),
    "sensor outside": ("housing.sensor.0.position.1", "300 mm", "housing.sensor[0].position", "140 mm outside"),
    "sensor in cavity": ("housing.sensor.0.position.1", "80 mm", "housing.sensor[0].position", "from the front face"),
    "no geometry": ("housing.box", GONE, "housing", "exactly one of [housing.box], [housing.cad]"),
    "how many modes": ("housing.modes", 5, "housing", "'modes' (such as 25), got ['frequency_limit', 'modes']"),
}

SEVERAL_WRONG: dict[str, tuple[list[tuple[str, Any]], str, str]] = {
    "support that misses": (
        [("housing.support.0.surface", GONE), ("housing.support.0.box", NOWHERE_BOX)],
        "housing.support[0].box",
        "spans x = -110 mm to 110 mm",
    ),
    "support in the cavity": (
        [("housing.support.0.surface", GONE), ("housing.support.0.box", CAVITY_BOX)],
        "housing.support[0].box",
        "all in its cavity",
    ),
    "damping for each mode": (
        [("housing.frequency_limit", GONE), ("housing.modes", 3), ("housing.damping_ratio", [0.01, 0.02])],
        "housing.damping_ratio",
        "each of the 3 modes (there are 2)",
    ),
    "two geometries": (
        [("housing.cad", {"file": "a.step", "mesh_size": "9 mm"})],
        "housing",
        "['box', 'cad']",
    ),
    "coarser at the seats": (
        [
            ("housing.box", GONE),
            ("housing.cad", {"file": __file__, "mesh_size": "9 mm", "seat_mesh_size": "10 mm"}),
        ],
        "housing.cad.seat_mesh_size",
        "at most the mesh_size",
    ),
}


@pytest.mark.parametrize("kind", ONE_WRONG)
def test_one_wrong_value_is_named_with_its_place_and_what_was_expected(kind: str) -> None:
    check_one_wrong(*ONE_WRONG[kind])


@pytest.mark.parametrize("kind", SEVERAL_WRONG)
def test_what_does_not_go_together_is_named(kind: str) -> None:
    check_several_wrong(*SEVERAL_WRONG[kind])
