"""What a study tells of its cost before it is spent, and how it ends where most gearboxes cannot be."""

import io
import re
import time
import tomllib
from pathlib import Path

import pytest

from gearwhine.case.load import bundled_case
from gearwhine.cli import run_command
from gearwhine.solutions import StudyProgress, duration
from gearwhine.variation import cost
from gearwhine.variation.cost import cost_of_study
from gearwhine.variation.quantities import Evaluation, Wanted, _evaluation

PAIR = "gear_pair.pinion-wheel"
HUNTING, FIRST = f"{PAIR}.transmission_error_over_hunting_period_m", f"{PAIR}.transmission_error_peak_to_peak_m"
HARMONIC, LIFE = f"{PAIR}.transmission_error_harmonic_1_m", "bearing.left.life_h"


def test_times_are_told_in_the_unit_that_a_reader_takes() -> None:
    assert [duration(one) for one in (42.4, 89.0, 240.0, 5000.0, 9000.0)] == [
        "42 s",
        "89 s",
        "4 min",
        "83 min",
        "2.5 h",
    ]


def test_progress_counts_what_an_earlier_run_had_found_and_estimates_the_rest_by_this_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock, said = [100.0], list[tuple[str, float | None]]()
    monkeypatch.setattr(time, "perf_counter", lambda: clock[0])
    reached = StudyProgress(lambda text, fraction=None: said.append((text, fraction)), "gearboxes", 10, before=4)
    for clock[0], done, news in ((100.0, 4, ""), (101.0, 5, ""), (103.0, 6, ", 1 failed"), (103.5, 10, "")):
        reached.report(done, news)
    assert said == [
        ("gearboxes: 4 of 10", 0.4),
        ("gearboxes: 6 of 10, 1 failed, about 6 s left", 0.6),  # two in 3 s, and four to come
        ("gearboxes: 10 of 10", 1.0),
    ]


def test_the_key_that_is_told_leaves_out_what_takes_most_and_nothing_else() -> None:
    seconds = {HUNTING: 8.0, HARMONIC: 1.0, "gears": 0.4, "load": 0.6}
    first = Evaluation(dict.fromkeys((HUNTING, FIRST, HARMONIC, LIFE), 1.0), {}, seconds)
    text = cost_of_study(first, 7200.0, 720, "gearboxes", "variation")
    assert text.startswith("720 gearboxes take some 2.0 h by the first of them, 90 % of it for ")
    assert text.endswith("which leaves 12 min")
    (listed,) = re.findall(r"quantities = \[.*\]", text)
    left = Wanted(("gears", "load"), names=tuple(tomllib.loads(listed)["quantities"]))
    assert [name for name in first.numbers if left.has(name)] == [FIRST, LIFE]


def test_an_analysis_that_takes_most_is_left_out_by_its_name() -> None:
    first = Evaluation({LIFE: 1.0}, {}, {"gears": 1.0, "load": 1.0, "lines": 6.0})
    text = cost_of_study(first, 800.0, 100, "gearboxes", "variation")
    assert '75 % of it for \'lines\'; without it: [variation] analyses = ["gears", "load"], which leaves 3 min' in text
    # Alone it is what is asked for; and what is short, or evenly spent, needs no advice.
    alone = Evaluation({LIFE: 1.0}, {}, {"lines": 6.0})
    assert "without" not in cost_of_study(alone, 800.0, 100, "gearboxes", "variation")
    assert cost_of_study(first, 50.0, 100, "gearboxes", "variation") == ""
    even = Evaluation({LIFE: 1.0}, {}, {"gears": 1.0, "load": 1.0, "lines": 1.0})
    assert (
        cost_of_study(even, 800.0, 100, "gearboxes", "variation")
        == "100 gearboxes take some 13 min by the first of them"
    )


def test_the_time_of_a_quantity_is_its_own() -> None:
    def slow() -> float:
        time.sleep(0.05)
        return 1.0

    found = _evaluation(Wanted(("gears",), names=("a", "b")), {"gears": iter([("a", 1.0), ("b", slow), ("c", slow)])})
    assert found.numbers == {"a": 1.0, "b": 1.0}
    assert found.seconds["b"] >= 0.05
    assert found.seconds["gears"] < 0.03


def test_a_long_study_is_told_by_its_first_gearbox(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = _pair(tmp_path, '"operation.torque" = { uniform = ["60 N*m", "80 N*m"] }', samples=3)
    monkeypatch.setattr(cost, "_WORTH_TELLING", 0.0)
    written = io.StringIO()
    monkeypatch.setattr("sys.stderr", written)
    assert run_command(["vary", str(text), "-o", str(tmp_path / "out"), "--workers", "1"]) == 0
    assert "3 gearboxes take some " in written.getvalue()


def _pair(tmp_path: Path, varied: str, samples: int) -> Path:
    bundled = bundled_case("spur-pair")
    assert bundled is not None
    path = tmp_path / "pair.toml"
    study = f'\n[variation]\nsamples = {samples}\nanalyses = ["gears"]\n[variation.vary]\n{varied}\n'
    path.write_text(bundled.read_text() + study)
    return path


@pytest.mark.parametrize(("weights", "code"), [([3, 1], 0), ([1, 3], 1)])
def test_a_study_ends_well_with_up_to_half_of_its_gearboxes_failed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], weights: list[int], code: int
) -> None:
    path = _pair(tmp_path, f'"gear.pinion.teeth" = {{ values = [28, 40], weights = {weights} }}', samples=8)
    assert run_command(["vary", str(path), "-o", str(tmp_path / "out"), "-q", "--workers", "1"]) == code
    said = "6 of 8 gearboxes cannot be solved" in capsys.readouterr().err
    assert said == (code == 1)
    assert (tmp_path / "out" / "summary.json").is_file()
