"""The commands and programs of tutorials and how-to pages run in their order; commands of all other pages are read.

A page runs in an empty folder, as a reader would follow it. Only the effort is less: boxes of larger elements, drawings
of linear ones, and shorter runs.
"""

import re
import shlex
from pathlib import Path
from typing import Any

import pytest
from chromium import Browser, find_chromium
from looked_at import HOSTILE, look_at, look_at_shapes, with_hostile_names
from lopsided_case import FEW_WHIRLS

from gearwhine.analyses.result import Result
from gearwhine.case import bundled_case
from gearwhine.cli.command_line import app
from gearwhine.from_case import mesh

ROOT = Path(__file__).parents[2]
RUN = [*sorted((ROOT / "docs" / "tutorials").glob("*.md")), *sorted((ROOT / "docs" / "how-to").glob("*.md"))]
READ = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "benchmarks/README.md")),
    *sorted((ROOT / "docs").glob("*.md")),
]

_SHORT = ("transient.revolutions=2", "transient.discard=1", "transient.tolerance=5e-3", FEW_WHIRLS)
LESS_EFFORT = {
    "nasa-gear-noise-rig": _SHORT,
    "small-gearbox": (
        *_SHORT,
        "optimisation.evaluations=3",
        "acoustics.lines=2",
    ),
    "two-stage-reducer": (
        "housing.cad.mesh_size=18 mm",
        "housing.frequency_limit=600 Hz",
        'sweep.speed=["700 rpm", "1450 rpm"]',
        *_SHORT,
    ),
    "helical-pair": ("variation.samples=8",),
    "planetary-stage": (
        "housing.cad.mesh_size=24 mm",
        "housing.frequency_limit=600 Hz",
        "transient.revolutions=1",
        "transient.discard=0",
        "transient.tolerance=5e-2",
    ),
    "planetary-helical": (
        "housing.cad.mesh_size=26 mm",
        "housing.frequency_limit=600 Hz",
    ),
    "steel-box": (),
    "friswell-rotor": (),
}
"""Settings that are added to the commands on a case."""
COARSE = 0.05
"""Least size of the elements of a box [m]."""
FEWER_POINTS = {"rpm:19": "rpm:2", "N*m:10": "N*m:2"}
"""Ranges of a sweep that are cut."""
FEWER_SPEEDS = ('to = "6000 rpm"', 'to = "2100 rpm"')
"""Range of an optimisation, whose check takes steps of a per cent."""
FEWER_SIZES = 'detection.severities=["1 mm", "2 mm"]'
REPORTED = "rig"
"""Page whose report is looked at in a browser, in the folder of the page's name."""
_WITHOUT_A_CASE = ("examples",)


def steps(page: Path) -> list[tuple[str, str]]:
    """Fenced blocks of a page in their order: language, or ``append FILE`` where a comment says so, and text."""
    text = page.read_text(encoding="utf-8")
    found = re.findall(r"(?:^<!-- append: (\S+) -->\n)?^```([^\n]*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    return [(f"append {file}" if file else language, block) for file, language, block in found]


def commands(block: str) -> list[list[str]]:
    """Words of each command of a block, comments left out."""
    return [words for line in block.splitlines() if (words := shlex.split(line, comments=True))]


def with_less_effort(words: list[str]) -> list[str]:
    if words[0] in _WITHOUT_A_CASE or words[0] == "report":
        return words
    case = Path(words[1]).stem
    settings = LESS_EFFORT["steel-box" if case == "updated" else case]
    if words[0] == "update":
        settings = ("update.modes=12",)
    if words[0] == "detect":
        # A record of fewer turns has no averages.
        settings = ("transient.revolutions=12", "transient.discard=6", "transient.tolerance=5e-3", FEWER_SIZES)
    changes = [part for setting in settings for part in ("--set", setting)]
    # The tests of the planetary stage solve a turn of its carrier.
    words = [word for word in words if word != "--carrier-turn"]
    for many, few in FEWER_POINTS.items():
        words = [word.replace(many, few) for word in words]
    if words[0] == "sweep":
        words = [*words, "--workers", "1"]
    return [*words, *changes]


def _look_at_report(gearwhine: Any, folder: Path, place: Path) -> None:
    """The interactive report of a folder in a browser, where all names are hostile and longer than they were."""
    if (program := find_chromium()) is None:
        return
    with_hostile_names(folder, place / "hostile")
    outcome = gearwhine("report", str(place / "hostile"), "--interactive", "-q")
    assert outcome.code == 0, outcome.err
    with Browser(program, place / "profile") as browser:
        page = place / "hostile" / "report-interactive.html"
        look_at(browser, page, interactive=True)
        assert browser.value("document.body.textContent").count(HOSTILE) > 20
        look_at_shapes(browser)


@pytest.mark.slow
@pytest.mark.usefixtures("linear_drawings", "swept_here", "few_reliefs_tried", "few_slices")
@pytest.mark.parametrize("page", RUN, ids=lambda page: page.stem)
def test_a_page_runs_from_its_first_line_to_its_last(
    gearwhine: Any, tmp_path: Path, page: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import matplotlib.pyplot as plt

    mesh_box = mesh.mesh_box
    monkeypatch.setattr(mesh, "mesh_box", lambda box, size, **how: mesh_box(box, max(size, COARSE), **how))
    if page.stem != REPORTED and ".png" not in page.read_text(encoding="utf-8"):
        # Figures of these commands have tests of their own.
        monkeypatch.setattr(Result, "_draw_figures", lambda *_: None)

    names: dict[str, Any] = {"__name__": "__main__"}
    done = 0
    for kind, block in steps(page):
        if kind == "":
            for program, *words in commands(block):
                assert program == "gearwhine", program
                outcome = gearwhine(*with_less_effort(words))
                assert outcome.code == 0, f"{words}: {outcome.err}"
                done += 1
        elif kind == "python":
            exec(compile(block, page.name, "exec"), names)  # noqa: S102 - the page is ours
            plt.close("all")
        elif kind.startswith("append "):
            with (tmp_path / kind.removeprefix("append ")).open("a", encoding="utf-8") as file:
                file.write(f"\n{block.replace(*FEWER_SPEEDS)}")
        else:
            assert kind in ("toml", "text"), kind
    assert done >= 2
    if page.stem == "measured":
        import gearwhine as gw

        modulus = gw.load("fit/updated.toml").case.material["steel"].youngs_modulus
        assert modulus == pytest.approx(196e9, rel=2e-3)
    if page.stem == REPORTED:
        _look_at_report(gearwhine, tmp_path / page.stem, tmp_path)
    for named in re.findall(r"`((?:rig|reducer|plan|fit|small-gearbox-results)/[\w.-]+)`", page.read_text("utf-8")):
        assert (tmp_path / named).exists(), named


@pytest.mark.parametrize("page", READ, ids=lambda page: page.stem)
def test_commands_of_a_page_are_ones_that_can_be_given(page: Path) -> None:
    made = set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    copied: set[str] = set()
    for kind, block in steps(page):
        for program, *words in commands(block) if kind == "" else []:
            if program == "make":
                assert words[0] in made, words
            elif program.endswith(("python", "pytest")):
                scripts = [word for word in words if word.endswith(".py")]
                assert all((ROOT / script).is_file() for script in scripts), words
            elif program == "gearwhine" and words[0].islower():
                app.parse_args(words, exit_on_error=False, print_error=False)
                if words[0] == "examples":
                    copied.update(f"{name}.toml" for name in words[2:3])
                elif words[1].endswith(".rexs"):
                    copied.update(words[place + 1] for place, word in enumerate(words) if word == "-o")
                elif words[0] in ("report", "export") and "-o" not in words:
                    assert not words[1].startswith("-"), words  # of a results folder
                elif not words[1].endswith("updated.toml"):
                    assert words[1] in copied or bundled_case(words[1]).is_file(), words
