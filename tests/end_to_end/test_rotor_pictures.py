"""The pictures that `gearwhine rotors` leaves: which files there are, that all are listed, and how they are named."""

from pathlib import Path

import pytest
from PIL import Image

from gearwhine.output import file_stems

pytestmark = pytest.mark.rendered

KINDS = {"shaft", "modes", "torsion", "whirl", "campbell", "unbalance", "static"}


@pytest.mark.slow
def test_rotors_are_drawn_into_the_folder(gearwhine, tmp_path: Path) -> None:
    document = gearwhine("rotors", "friswell-rotor", "--json", "-q", "-o", "out").document
    present = {path.name for path in (tmp_path / "out").glob("[!.]*")}
    assert present == set(document["files"])
    assert {name for name in present if name.endswith(".png")} == {f"rotor-shaft-{kind}.png" for kind in KINDS}
    for path in (tmp_path / "out").glob("*.png"):
        with Image.open(path) as image:
            assert image.width == pytest.approx(160 / 25.4 * 200, abs=1)
            assert len(image.convert("RGB").reduce(4).getcolors(maxcolors=1 << 24) or ()) > 50


def test_without_a_speed_there_is_no_whirl_to_draw(gearwhine) -> None:
    still = ("--set", "operation=", "--set", "sweep=")
    document = gearwhine("rotors", "friswell-rotor", "--json", "-q", "-o", "out", *still).document
    pictures = {name for name in document["files"] if name.endswith(".png")}
    assert pictures == {f"rotor-shaft-{kind}.png" for kind in ("shaft", "modes", "torsion", "static")}


@pytest.mark.slow
def test_the_critical_speed_map_is_drawn_where_it_is_asked_for(gearwhine) -> None:
    few = ("rotor_analysis.modes=4", "sweep=", "rotor.0.unbalance=")
    settings = [part for change in few for part in ("--set", change)]
    given = ("--set", "rotor_analysis.stiffness_map={from='1e5 N/m', to='1e7 N/m', points=3}")
    document = gearwhine("rotors", "friswell-rotor", "--json", "-q", "-o", "out", *settings, *given).document
    assert "rotor-shaft-critical-map.png" in document["files"]
    assert "rotor-shaft-unbalance.png" not in document["files"]


def test_names_of_files_are_plain_short_and_unlike() -> None:
    stems = file_stems(["input", "Input", "轴", "轴 2", "..", "a" * 98, "a" * 99, "x*y", "x?y"], "rotor-")
    assert len({stem.lower() for stem in stems}) == len(stems)
    assert stems[0] == "rotor-input"
    assert all(stem.isascii() and len(stem) < 80 and not set(stem) & set('/\\:*?"<>| ') for stem in stems)
