"""Names of lines whose frequency several causes are near."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled
from reducer_case import reducer

from gearwhine.case import load_case
from gearwhine.coupling.linear.carriers.carrier_sidebands import Sideband
from gearwhine.coupling.linear.mesh_harmonics import causes_in_words
from gearwhine.coupling.periodic.superposition import _name_of
from gearwhine.coupling.signals.line_names import line_names
from gearwhine.figures.machine.system import _place_beside_harmonic
from tests.machines.turning_set import TEETH, turning_machine

WAVES = np.random.default_rng(2).normal(size=56)
OUTPUT, STAGE = 19 * 21 / 72 / 56, 19 * 21 / 72
"""Turns of the output and cycles of the second mesh in a turn of the input."""


@pytest.mark.parametrize(
    ("order", "name"),
    [
        (6.0, "6× input"),
        (STAGE + 4.0 * OUTPUT, "1× c -> d + 4× output"),
        (STAGE + OUTPUT, "1× c -> d + 1× output"),
        (7.0, "7× input"),
        (2.0 * STAGE + 21.0, "1× a -> b + 2× c -> d"),
        (21.0 - 2.0 * STAGE, "1× a -> b - 2× c -> d"),
        (6.0 * STAGE - 21.0, "6× c -> d - 1× a -> b"),
    ],
)
def test_a_whole_order_of_another_shaft_beside_a_sideband_has_its_own_name(
    tmp_path: Path, order: float, name: str
) -> None:
    """The sideband at 5.94 turns of the input is within the tolerance of its sixth order, which pitch errors excite."""
    place = tmp_path / "reducer.toml"
    place.write_text(reducer(), encoding="utf-8")
    listed = {
        key: "[" + ", ".join(f'"{one:.3f} um"' for one in WAVES[:teeth]) + "]" for key, teeth in (("a", 21), ("d", 56))
    }
    machine = coupled(load_case(str(place), [f"gear.{key}.errors.pitch={one}" for key, one in listed.items()]).case)
    (found,) = line_names(machine, [50.0 * order], 4.0)
    assert found.name == name


def test_a_line_many_turns_of_the_carrier_from_a_harmonic_is_told_by_them_with_their_sign() -> None:
    machine = turning_machine((900.0, 1300.0))
    turn, cycles = abs(machine.speeds["carrier"]) / (2.0 * np.pi), TEETH[0] + 2 * TEETH[1]
    found = line_names(machine, [turn * (2 * cycles + beside) for beside in (-25.0, 25.0, 25.5)], 0.1)
    assert [one.name for one in found[:2]] == [f"2× planets' meshes {sense} 25× carrier" for sense in "-+"]
    assert [one.kind for one in found] == ["sideband", "sideband", "other"]


def test_the_harmonic_that_a_line_is_the_fewest_turns_off_comes_first() -> None:
    names = ("a -> b", "c -> d")
    meshes = [SimpleNamespace(carrier=None, name=name) for name in names]
    machine: Any = SimpleNamespace(meshes=meshes, system=SimpleNamespace(contacts=meshes), flanks=lambda n: (n, 0))
    sidebands = [Sideband((("carrier", turns),)) for turns in (5.0, -1.0)]
    expected = ["2× c -> d - 1× carrier", "8× a -> b + 5× carrier"]
    causes = [(0, 8), (1, 2)]
    assert causes_in_words(machine, causes, sidebands) == expected
    line: Any = SimpleNamespace(causes=causes, sidebands=sidebands)
    assert _place_beside_harmonic(line) == "2 -1"


def test_of_two_meshes_the_much_nearer_one_is_named_and_both_where_neither_is(tmp_path: Path) -> None:
    """Five times the first mesh frequency, 105 a turn, is near 19 times the second one; 19 and 72 times are equal."""
    place = tmp_path / "reducer.toml"
    place.write_text(reducer(), encoding="utf-8")
    machine = coupled(load_case(str(place)).case)
    orders = [105.01, 19.0 * STAGE - 0.01, 0.5 * (105.0 + 19.0 * STAGE), 19.0 * 21.0]
    names = [one.name for one in line_names(machine, [50.0 * order for order in orders], 15.0)]
    assert names == ["5× a -> b", "19× c -> d", "5× a -> b, 19× c -> d", "19× a -> b, 72× c -> d"]


def test_excitations_of_a_motion_are_named_by_the_part_that_turns_or_their_frequency() -> None:
    parts = [SimpleNamespace(name=name) for name in ("input", "held", "output")]
    system: Any = SimpleNamespace(contacts=[], components=parts, speeds=[-10.0, 0.0, 25.0])
    group: Any = SimpleNamespace(meshes=(), turn=0.0, frequencies=(10.0, 25.0, 80.0 * np.pi))
    assert _name_of(system, group) == "rotation of input, rotation of output, load at 40 Hz"
