"""Optimised designs: the optimum of closed forms, the best of a grid, scatter, and what is refused."""

import json
import math
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from coupled_cases import sensor_level

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.case.load import bundled_case
from gearwhine.case.optimisation import Aim
from gearwhine.cli import run_command
from gearwhine.failures import MissingExtraError
from gearwhine.figures.optimisation import draw_optimisation
from gearwhine.numerics.distributions import Discrete, Normal, Uniform
from gearwhine.numerics.result_warnings import warning
from gearwhine.results.optimisation import sections
from gearwhine.variation.samples import FOLDER, VariedCase
from tests.machines.belted_shaft import BELTED_SHAFT

SHAFT = (
    BELTED_SHAFT
    + """
[optimisation]
evaluations = 50
[optimisation.design]
"operation.force[0].x" = { range = ["800 N", "1200 N"] }
"operation.force[1].x" = { range = ["100 N", "900 N"] }
[optimisation.aim]
"bearing.right.force_n" = { sense = "least" }
[optimisation.limit]
"bearing.left.force_n" = { at_least = 1000 }
"""
)
LEFT, RIGHT = "bearing.left.force_n", "bearing.right.force_n"
LIMIT = '"bearing.left.force_n" = { at_least = 1000 }'
KEYS = ("operation.force[0].x", "operation.force[1].x")
SCATTER = """
[optimisation.robust]
samples = 8
deviations = 2
[variation.vary]
"operation.force[1].x" = { normal = ["500 N", "50 N"] }
"""


def _study(tmp_path: Path, text: str = SHAFT, changes: list[str] | None = None) -> gw.CaseStudy:
    path = tmp_path / "shaft.toml"
    path.write_text(text)
    return gw.load(path, changes or [])


def _optimised(tmp_path: Path, text: str = SHAFT, *, out: str = "out", **options: object) -> gw.Result:
    return _study(tmp_path, text).optimise(folder=tmp_path / out, workers=1, **options)


def _forces(found: gw.Result) -> np.ndarray:
    return np.array([float(row["designs"][0].split()[0]) for row in found.document["keys"]])


def test_the_optimum_of_two_forces_is_the_corner_of_bound_and_limit(tmp_path: Path) -> None:
    """F1 at its largest, and F2 as large as the limit needs: 0.8 · 1200 + 0.2 F2 = 1000."""
    found = _optimised(tmp_path)
    assert _forces(found) == pytest.approx([1200.0, 200.0], rel=2e-3)
    (aim,) = found.document["aims"]
    assert aim["start"] == pytest.approx(0.2 * 1000.0 + 0.8 * 500.0, rel=1e-9)
    assert aim["designs"][0] == pytest.approx(0.2 * 1200.0 + 0.8 * 200.0, rel=2e-3)
    (limit,) = found.document["limits"]
    assert limit["start"] == pytest.approx(900.0, rel=1e-9)
    assert 1000.0 <= limit["designs"][0] < 1001.0
    assert limit["active"] is True
    assert [row["at_bound"] for row in found.document["keys"]] == ["largest", ""]
    assert [row["start"] for row in found.document["keys"]] == ["1000 N", "500 N"]
    # Every design is the closed form of its forces.
    forces = found.dataset["input_value"].values
    right = found.dataset["value"].sel(quantity=RIGHT, side="high").values
    assert np.allclose(right, forces @ [0.2, 0.8], rtol=1e-9)
    left = forces @ [0.8, 0.2]
    excess = found.dataset["excess"].values
    assert np.allclose(excess, np.maximum(0.0, 1000.0 - left) / 1000.0, atol=1e-12)
    assert found.document["within_limits"] == int(np.sum(left >= 1000.0))
    # The start is the first design that is tried.
    assert forces[0] == pytest.approx([1000.0, 500.0])


@pytest.mark.slow
def test_a_robust_optimum_keeps_two_standard_deviations_from_the_limit(tmp_path: Path) -> None:
    """F2 scatters with 50 N about its designed value: the left force by 10 N, the right one by 40 N."""
    found = _optimised(tmp_path, SHAFT + SCATTER)
    deviation = float(np.std(Normal(0.0, 50.0).quantile(_points(8, 1)[:, 0]), ddof=1))
    mean = float(np.mean(Normal(0.0, 50.0).quantile(_points(8, 1)[:, 0])))
    assert deviation == pytest.approx(50.0, rel=0.3)
    # 0.8 · 1200 + 0.2 (F2 + mean) - 2 · 0.2 deviation = 1000.
    second = (1000.0 - 960.0 + 0.4 * deviation) / 0.2 - mean
    assert _forces(found) == pytest.approx([1200.0, second], rel=3e-3)
    (aim,) = found.document["aims"]
    right = 240.0 + 0.8 * (second + mean)
    assert aim["designs"][0] == pytest.approx(right + 2.0 * 0.8 * deviation, rel=3e-3)
    assert found.document["gearboxes_about_each"] == 8
    assert len(_lines(tmp_path / "out")) == 8 * (found.document["designs"] + 1)


def _points(count: int, dimension: int) -> np.ndarray:
    from gearwhine.numerics.sampling import sobol_points

    return sobol_points(count, dimension, 1)


def _lines(out: Path) -> list[bytes]:
    return [line for record in (out / FOLDER).glob("*.jsonl") for line in record.read_bytes().splitlines()]


def test_a_quantile_takes_the_side_that_is_worse(tmp_path: Path) -> None:
    text = (SHAFT + SCATTER).replace("deviations = 2", "quantile = 0.9")
    text = text.replace('normal = ["500 N", "50 N"]', 'uniform = ["400 N", "600 N"]')
    found = _optimised(tmp_path, text, evaluations=40)
    drawn = -100.0 + 200.0 * _points(8, 1)[:, 0]
    # Nine in ten have a left force above the limit, and a right one below the aim.
    low, high = np.quantile(drawn, [0.1, 0.9])
    second = 200.0 - low
    assert _forces(found) == pytest.approx([1200.0, second], rel=5e-3)
    assert found.document["aims"][0]["designs"][0] == pytest.approx(240.0 + 0.8 * (second + high), rel=5e-3)


def test_a_designed_key_scatters_about_its_designed_value(tmp_path: Path) -> None:
    """F1 is designed and scatters with 20 N about the design, whatever the mean of its distribution in the case is."""
    scatter = SCATTER.replace("deviations = 2", "deviations = 3").replace(KEYS[1], KEYS[0])
    text = (SHAFT + scatter).replace('["500 N", "50 N"]', '["0.9 kN", "20 N"]')
    found = _optimised(tmp_path, text, evaluations=20)
    drawn = Normal(0.0, 20.0).quantile(_points(8, 1)[:, 0])
    forces = found.dataset["input_value"].values
    mean = forces @ [0.8, 0.2] + 0.8 * drawn.mean()
    reach = 3.0 * 0.8 * drawn.std(ddof=1)
    values = found.dataset["value"].sel(quantity=LEFT).values
    assert values == pytest.approx(np.stack([mean - reach, mean + reach], axis=1), rel=1e-9)
    # The start scatters as the case says, about 900 N.
    start = found.solved.start.sides[LEFT]
    assert np.mean(start) == pytest.approx(0.8 * (900.0 + drawn.mean()) + 0.2 * 500.0, rel=1e-9)


def test_designs_with_words_have_no_scatter(tmp_path: Path) -> None:
    text = (SHAFT + SCATTER).replace('range = ["100 N", "900 N"]', "values = [100, 900]")
    with pytest.raises(CaseError, match="no scatter of"):
        _optimised(tmp_path, text)


def test_a_tolerance_zone_lies_about_the_designed_length(tmp_path: Path) -> None:
    """k6 of ISO 286-2 is 2 to 15 µm above 20 and 30 mm: the mass ρ π d² l / 4 tells the diameters that were drawn."""
    key = "rotor.shaft.segments[0].diameter"
    text = SHAFT[: SHAFT.index("[optimisation]")] + (
        "[optimisation]\n[optimisation.robust]\nsamples = 8\nquantile = 0.9\n"
        f'[optimisation.design]\n"{key}" = {{ values = ["30 mm", "20 mm"] }}\n'
        '[optimisation.aim]\n"rotor.shaft.mass_kg" = { sense = "least" }\n'
        f'[variation.vary]\n"{key}" = {{ fit = "k6" }}\n'
    )
    found = _optimised(tmp_path, text)
    masses = found.dataset["value"].sel(quantity="rotor.shaft.mass_kg").values
    deviations = np.sqrt(4.0 * masses / (np.pi * 7850.0 * 0.5)) - np.array([[0.030], [0.020]])
    assert np.all(deviations > 2e-6)
    assert np.all(deviations < 15e-6)
    assert deviations.mean(axis=1) == pytest.approx(8.5e-6, abs=1.5e-6)
    assert np.all(np.diff(deviations, axis=1) > 2e-6)
    assert found.document["keys"][0]["designs"] == ["20 mm"]


def test_limits_that_nothing_meets_are_named_with_what_is_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """At most 0.8 · 1200 + 0.2 · 900 = 1140 N are to be had."""
    text = SHAFT.replace(LIMIT, '"bearing.*.force_n" = { at_least = 1150 }')
    found = _optimised(tmp_path, text)
    left, right = found.document["missed"]
    assert (left["name"], right["name"]) == (LEFT, RIGHT)
    assert left["by"] == pytest.approx(10.0, rel=1e-2)
    assert right["by"] == pytest.approx(1150.0 - 0.2 * 1200.0 - 0.8 * 900.0, rel=1e-2)
    assert found.document["within_limits"] == 0
    assert any("no design meets all limits" in message for message in found.warnings)
    command = ["optimise", str(tmp_path / "shaft.toml"), "-o", str(tmp_path / "out"), "-q", "--workers", "1"]
    assert run_command(command) == 2
    shown = capsys.readouterr()
    assert "bearing left, force [N]: 1140, at least 1150 is asked for: missed by 10" in shown.err
    assert (tmp_path / "out" / "nearest.toml").is_file()
    assert not (tmp_path / "out" / "best.toml").exists()


def test_two_aims_have_the_front_of_the_closed_form(tmp_path: Path) -> None:
    """The most on the left at the least on the right: F2 at its least and any F1, or F1 at its largest and any F2."""
    pytest.importorskip("pymoo")
    text = SHAFT.replace(LIMIT, "").replace("[optimisation.limit]", f'"{LEFT}" = {{ sense = "most" }}')
    found = _optimised(tmp_path, text, evaluations=120)
    front = np.array([row["aims"] for row in found.document["front"]])
    right, left = front.T
    exact = np.where(right < 0.2 * 1200.0 + 80.0, 4.0 * (right - 80.0) + 20.0, 960.0 + 0.25 * (right - 240.0))
    assert np.all(left <= exact + 1e-6)
    assert np.mean(exact - left) < 12.0
    assert len(front) > 15
    assert np.all(np.diff(right) > 0.0)
    assert np.all(np.diff(left) > 0.0)
    labels = [row["design"] for row in found.document["chosen"]]
    assert labels == ["balanced", f"least {RIGHT}", f"most {LEFT}"]
    by_label = np.array([row["designs"] for row in found.document["aims"]]).T
    assert by_label[1].tolist() == front[0].tolist()
    assert by_label[2].tolist() == front[-1].tolist()
    # With weights their sum is the one aim: 1 N on the right is worth 2 N on the left, so F2 is least and F1 largest.
    weighted = text.replace('"least" }', '"least", weight = 2 }').replace('"most" }', '"most", weight = 1 }')
    found = _optimised(tmp_path, weighted, evaluations=50)
    assert _forces(found) == pytest.approx([1200.0, 100.0], rel=5e-3)


def test_a_grid_is_every_combination_and_the_search_is_no_worse_than_its_best(tmp_path: Path) -> None:
    text = SHAFT.replace('["100 N", "900 N"]', '["100 N", "900 N"], levels = 4')
    found = _optimised(tmp_path, text, method="grid")
    forces = found.dataset["input_value"].values
    expected = [[a, b] for a in np.linspace(800.0, 1200.0, 5) for b in np.linspace(100.0, 900.0, 4)]
    assert forces == pytest.approx(np.array(expected))
    right = forces @ [0.2, 0.8]
    within = forces @ [0.8, 0.2] >= 1000.0
    assert found.document["aims"][0]["designs"][0] == pytest.approx(np.min(right[within]), rel=1e-9)
    assert found.document["ended"] == "complete"
    searched = _optimised(tmp_path, text, evaluations=len(expected) * 2)
    assert searched.document["aims"][0]["designs"][0] < found.document["aims"][0]["designs"][0]


def test_an_aim_of_several_quantities_is_that_of_the_worst(tmp_path: Path) -> None:
    text = SHAFT.replace('"bearing.right.force_n" = { sense', '"bearing.*.force_n" = { sense').replace(
        LIMIT, '"bearing.left.force_n" = { at_least = 700 }'
    )
    found = _optimised(tmp_path, text, method="grid")
    forces = found.dataset["input_value"].values
    larger = np.maximum(forces @ [0.8, 0.2], forces @ [0.2, 0.8])
    assert found.dataset["aim_value"].values[:, 0] == pytest.approx(larger, rel=1e-9)
    most = _optimised(tmp_path, text.replace('"least"', '"most"'), method="grid")
    smaller = np.minimum(forces @ [0.8, 0.2], forces @ [0.2, 0.8])
    assert most.dataset["aim_value"].values[:, 0] == pytest.approx(smaller, rel=1e-9)
    assert most.document["aims"][0]["designs"][0] == pytest.approx(smaller.max(), rel=1e-9)


def test_an_interrupted_search_goes_on_with_the_designs_on_file(tmp_path: Path) -> None:
    first = _optimised(tmp_path, evaluations=30)
    lines = _lines(tmp_path / "out")
    assert len(lines) == 31
    (record,) = (tmp_path / "out" / FOLDER).glob("*.jsonl")
    record.write_bytes(b"\n".join(lines[:17]) + b"\n" + lines[17][:20])
    again = _optimised(tmp_path, evaluations=30)
    assert again.document["resumed"] == 17
    assert np.array_equal(again.dataset["input_value"].values, first.dataset["input_value"].values)
    assert np.array_equal(again.dataset["aim_value"].values, first.dataset["aim_value"].values)
    # Another limit asks for the same quantities of the same designs; another seed begins with other ones.
    other = _optimised(tmp_path, SHAFT.replace("at_least = 1000", "at_least = 990"), evaluations=8)
    assert other.document["resumed"] == 9
    assert _optimised(tmp_path, evaluations=8, seed=5).document["resumed"] == 2
    assert _optimised(tmp_path, evaluations=8, fresh=True).document["resumed"] == 0


def test_failed_designs_are_passed_over_and_named(tmp_path: Path) -> None:
    """Pinions of 27 and 29 teeth do not fit between the shafts of 28 and 28; 28 and 28 of a finer module do neither."""
    bundled = bundled_case("spur-pair")
    assert bundled is not None
    name = "gear_pair.pinion-wheel.transmission_error_peak_to_peak_m"
    text = bundled.read_text() + (
        "[optimisation]\nverify = false\n[optimisation.design]\n"
        '"gear.pinion.teeth" = { values = [28, 40] }\n'
        '"gear.pinion.tip_relief.amount" = { values = ["0 um", "10 um", "25 um"] }\n'
        f'[optimisation.aim]\n"{name}" = {{ sense = "least" }}\n'
    )
    study = _study(tmp_path, text)
    found = study.optimise(folder=tmp_path / "out", workers=1)
    assert [row["number"] for row in found.document["failed"]] == [4, 5, 6]
    assert all("gear" in row["message"] for row in found.document["failed"])
    assert found.document["keys"][0]["designs"] == ["28"]
    single = [
        study.changed([f"gear.pinion.tip_relief.amount={amount} um"])
        .gears(without=("harris-map", "relief"))
        .document["pairs"][0]
        for amount in (0, 10, 25)
    ]
    sizes = [pair["transmission_error_m"]["peak_to_peak"] for pair in single]
    assert found.document["aims"][0]["designs"][0] == pytest.approx(min(sizes), rel=1e-9)
    assert found.dataset["aim_value"].values[:3, 0] == pytest.approx(sizes, rel=1e-9)
    change = f"→ {1e6 * min(sizes):.5g}"
    assert any(change in str(one) and "µm" in str(one) for one in sections(found.document)[0].content)


BAD = {
    "unknown key": ('"operation.force[0].x"', '"operation.forze[0].x"', "did you mean 'force'"),
    "no number": (
        '"operation.force[0].x"',
        '"rotor.shaft.name"',
        "a key with a quantity or a number; rotor.shaft.name is",
    ),
    "of no gearbox": ('"operation.force[0].x"', '"optimisation.seed"', "a key that a gearbox follows from"),
    "upside down": ('["800 N", "1200 N"]', '["1200 N", "800 N"]', "force[0].x'.range: expected a number above"),
    "expression": ('["800 N", "1200 N"]', '["2*400 N", "1200 N"]', "range[0]: expected"),
    "other unit": ('["800 N", "1200 N"]', '["800 N", "1200 mm"]', "numbers that measure the same"),
    "impossible end": (
        '"operation.force[0].x" = { range = ["800 N", "1200 N"]',
        '"rotor.shaft.segments[0].diameter" = { range = ["-1 mm", "30 mm"]',
        "a length",
    ),
    "no aim": ('"bearing.right.force_n" = { sense = "least" }', "", "the name of one quantity or more"),
    "unknown aim": ('"bearing.right.force_n"', '"bearing.rihgt.force_n"', "did you mean 'right'"),
    "unknown limit": ('"bearing.left.force_n"', '"bearing.*.weight_kg"', "a quantity of bearing.* (force_n)"),
    "sense": ('sense = "least"', 'sense = "lowest"', "one of 'least' or 'most'"),
    "two kinds": ('["100 N", "900 N"]', '["100 N", "900 N"], values = [1.0]', "either 'range' or 'values'"),
    "lists apart": (
        '{ range = ["100 N", "900 N"] }',
        '{ values = ["100 N", "900 N"], with = { "operation.speed" = ["1 rpm"] } }',
        "2 values, one for each of 'values'",
    ),
    "key twice": ('"operation.force[1].x"', '"operation.force.*.x"', "each key once"),
    "no scatter": (
        "[optimisation.limit]",
        "[optimisation.robust]\ndeviations = 1\n[optimisation.limit]",
        "under [variation.vary]",
    ),
    "one weight": (
        '"least" }',
        '"least", weight = 1 }\n"bearing.left.force_n" = { sense = "most" }',
        "a weight beside those",
    ),
}


@pytest.mark.parametrize("kind", BAD)
def test_what_cannot_be_is_named_with_its_key(kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before, after, message = BAD[kind]
    assert SHAFT.count(before) == 1
    path = tmp_path / "shaft.toml"
    path.write_text(SHAFT.replace(before, after))
    assert run_command(["optimise", str(path), "-o", str(tmp_path / "out"), "-q", "-n", "4", "--workers", "1"]) == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_a_case_without_optimisation_and_several_aims_without_their_library_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(CaseError, match=r"needs \[optimisation\]"):
        gw.load("spur-pair").optimise(folder=tmp_path / "out")
    monkeypatch.setattr("gearwhine.optimisation.search.find_spec", lambda name: None)
    text = SHAFT.replace(LIMIT, "").replace("[optimisation.limit]", f'"{LEFT}" = {{ sense = "most" }}')
    with pytest.raises(MissingExtraError, match="several aims need pymoo"):
        _optimised(tmp_path, text)
    assert len(_lines(tmp_path / "out")) == 0


def test_the_lightest_shaft_above_a_critical_speed_is_that_of_the_closed_form() -> None:
    """A disc in the middle of a light shaft in rigid bearings: ω² = 48 E π d⁴ / (64 l³ m), lowered by shear by 1 %."""
    steel = gw.ShaftMaterial(207e9, 80e9, 100.0)
    length, mass = 0.5, 20.0

    def made(values: dict[str, float]) -> gw.Machine:
        if values["diameter"] > 0.0495:
            raise ValueError("a shaft that does not fit its hub")
        disc = gw.Disc(0.5 * length, mass, 1e-6, 5e-7)
        rotor = gw.Rotor("shaft", [gw.Segment(length, values["diameter"], 0.0, steel)], [disc])
        bearings = [gw.MountedBearing(gw.Bearing.isotropic(f"{at}", at, 1e12), "shaft", None) for at in (0.0, length)]
        return gw.Machine([gw.Shaft(rotor)], bearings, speed=10.0)

    name = "rotor.shaft.critical_speed_1_rpm"
    limits = {name: (3000.0, None)}
    laws = {"diameter": Uniform(0.01, 0.05)}
    found = gw.optimise(made, laws, {"machine.mass_kg": "least"}, limits=limits, evaluations=40)
    omega = 3000.0 * np.pi / 30.0
    thin = (omega**2 * mass * 64.0 * length**3 / (48.0 * 207e9 * np.pi)) ** 0.25
    best = found.solved.best
    assert best is not None
    diameter = found.solved.inputs[0].value(float(best.point[0]))
    assert thin < diameter < 1.01 * thin
    assert best.sides[name][0] == pytest.approx(3000.0, rel=1e-3)
    expected = mass + 100.0 * np.pi / 4.0 * diameter**2 * length
    assert best.sides["machine.mass_kg"][0] == pytest.approx(expected, rel=1e-12)
    assert best.sides["rotor.shaft.mass_kg"] == best.sides["machine.mass_kg"]
    assert all("does not fit" in row["message"] for row in found.document["failed"])
    # The same by a list of diameters of a catalogue: the least one above the closed form.
    catalogue = Discrete([0.020, 0.025, 0.030, 0.035, 0.040, 0.045])
    found = gw.optimise(made, {"diameter": catalogue}, {"machine.mass_kg": "least"}, limits=limits)
    best = found.solved.best
    assert best is not None
    assert found.solved.inputs[0].value(float(best.point[0])) == min(d for d in catalogue.values if d > 1.003 * thin)
    assert found.document["ended"] == "complete"


def test_quantities_of_your_own_are_taken_and_wrong_ones_refused() -> None:
    def beam(values: dict[str, float]) -> dict[str, float]:
        width, height = values["width"], values["height"]
        return {"area_m2": width * height, "stiffness": width * height**3}

    ranges = {"width": Uniform(0.1, 1.0), "height": Uniform(0.1, 1.0)}
    found = gw.optimise(beam, ranges, {"area_m2": "least"}, limits={"stiffness": (0.2, None)}, evaluations=60)
    best = found.solved.best
    assert best is not None
    # As high as can be: width h³ = 0.2 at h = 1.
    assert best.sides["area_m2"][0] == pytest.approx(0.2, rel=1e-3)
    assert found.solved.at_bounds == {"height": "largest"}
    for problem, message in (
        ({"aims": {"area_m2": "smallest"}}, 'expected "least" or "most"'),
        ({"laws": {"width": Normal(0.5, 0.1)}}, "expected Uniform"),
        ({"laws": {}}, "expected the range of one value or more"),
        ({"start": {"width": 0.5}}, "a value of each of width, height"),
        ({"limits": {"stiffness": 0.2}}, "'stiffness' is 0.2; expected a least value and a largest one"),
        ({"aims": {"area_m2": "least", "stiffness": Aim(sense="most", weight=1.0)}}, "expected one on all"),
        ({"analyses": ["noise"]}, "expected some of gears"),
        ({"evaluations": 0}, "evaluations is 0; expected a whole number of at least 1"),
        ({"method": "random"}, "method is 'random'; expected one of search, grid"),
    ):
        given = {"laws": ranges, "aims": {"area_m2": "least"}, **problem}
        with pytest.raises(gw.CouplingError, match=message):
            gw.optimise(beam, given.pop("laws"), given.pop("aims"), **given)
    with pytest.raises(CaseError, match="did you mean 'area_m2'"):
        gw.optimise(beam, ranges, {"area_m": "least"})


def test_an_infinite_life_is_within_its_limit_and_a_design_without_values_is_told() -> None:
    def strip(values: Mapping[str, float]) -> dict[str, float]:
        return {"width_m": values["width"], "life_h": math.inf if values["width"] > 1.5 else 1.0}

    def find(aim: str) -> Any:
        ranges, limits = {"width": Uniform(1.0, 2.0)}, {"life_h": (5.0, None)}
        return gw.optimise(strip, ranges, {aim: "least"}, limits=limits, method="grid", levels=11)

    best = find("width_m").solved.best
    assert best is not None
    assert best.sides["width_m"][0] == pytest.approx(1.6)
    (told,) = find("life_h").document["warnings"][:1]
    assert told["message"].startswith("5 of 11 designs have no finite value")


def test_a_key_whose_values_make_no_gearbox_alone_is_warned_of_before_the_search(tmp_path: Path) -> None:
    bundled = bundled_case("helical-pair")
    assert bundled is not None
    helix = '"gear.pinion.helix_angle" = { values = ["12 deg", "14 deg"]'
    aim = '}\n[optimisation.aim]\n"machine.mass_kg" = { sense = "least" }\n'
    for step, count in (("", 1), (', with = { "gear.wheel.helix_angle" = ["-12 deg", "-14 deg"] }', 0)):
        path = tmp_path / "pair.toml"
        path.write_text(f"{bundled.read_text()}\n[optimisation.design]\n{helix}{step} {aim}")
        told = [one for one in gw.load(path).check().document["warnings"] if one["name"] == "values alone"]
        assert len(told) == count
        assert all("gear_pair[0].driven" in one["message"] and "equal helix angle" in one["message"] for one in told)


def test_keys_in_step_ends_of_lists_and_numbers_of_designs_are_told_as_the_case_names_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The force on the right bearing, 0.2 F1 + 0.8 F2, is the least at the last of falling pairs of forces."""
    design = '"operation.force[0].x" = { range = ["800 N", "1200 N"] }\n"operation.force[1].x" = { range = ["100 N", '
    design += '"900 N"] }'
    listed = '"operation.force[1].x" = { values = ["900 N", "500 N", "100 N"], with = { "operation.speed" = '
    listed += '["900 rpm", "1000 rpm", "1100 rpm"] } }\n"rotor.shaft.segments[0].diameter" = { values = ["28 mm", '
    listed += '"30 mm", "29 mm"] }'
    path, out = tmp_path / "shaft.toml", tmp_path / "out"
    limited = SHAFT[: SHAFT.index("[optimisation.limit]")]
    path.write_text(limited.replace(design, listed).replace("evaluations = 50", 'method = "grid"'))
    assert run_command(["optimise", str(path), "-o", str(out), "-q", "--workers", "1"]) == 0
    shown = capsys.readouterr().out
    document = json.loads((out / "summary.json").read_text())
    force, diameter = document["keys"]
    assert force["at_bound"] == "last of its list"
    assert "operation.force[1].x is the last of its list: a longer list may be better." in shown
    assert diameter["at_bound"] == ""  # of a list that neither rises nor falls
    (along,) = force["with"]
    assert (along["key"], along["designs"]) == ("operation.speed", ["1100 rpm"])
    (row,) = [line for line in shown.splitlines() if line.startswith(" operation.speed ")]
    assert "1100 rpm" in row
    assert row.rstrip().endswith("operation.force[1].x")
    # The number in the table, in the title of the case and in the file is one, and counts from 1.
    (chosen,) = document["chosen"]
    assert f"Design {chosen['number']} (best of {document['designs']})" in shown
    assert tomllib.loads((out / "best.toml").read_text())["title"].endswith(f"design {chosen['number']}")
    with xr.open_dataset(out / "optimise.nc") as found:
        aims = found["aim_value"].values[:, 0]
        assert aims[chosen["number"] - 1] == aims.min()
        assert int(found["design"][0]) == 1


def test_warnings_of_the_start_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(VariedCase, "start_warnings", [warning("overload", "the start is doubtful")])
    found = _optimised(tmp_path, SHAFT.replace("evaluations = 50", "evaluations = 3"))
    assert "the start is doubtful" in [one["message"] for one in found.document["warnings"]]


def test_the_picture_of_convergence_counts_designs_as_the_file_does() -> None:
    found = gw.optimise(lambda values: {"area_m2": values["x"]}, {"x": Uniform(0.1, 1.0)}, {"area_m2": "least"})
    figures = dict(draw_optimisation("Area", found.solved))
    (axes,) = figures["optimise-convergence"].axes
    drawn = {(float(x), float(y)) for line in axes.lines[:2] for x, y in line.get_xydata()}
    assert drawn == {(float(number), float(one.aims[0])) for number, one in enumerate(found.solved.designs, start=1)}
    level = gw.optimise(
        lambda values: {"sensor.roof.level_db": values["x"]},
        {"x": Uniform(0.1, 1.0)},
        {"sensor.roof.level_db": "least"},
        evaluations=4,
    )
    (axes,) = dict(draw_optimisation("Level", level.solved))["optimise-convergence"].axes
    assert axes.get_title(loc="left") == "sensor roof, highest level over speed"
    assert axes.get_ylabel() == "dB re 1 µm/s²"


def test_the_command_writes_designs_that_give_their_values_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = tmp_path / "shaft.toml", tmp_path / "out"
    path.write_text(SHAFT)
    assert run_command(["optimise", str(path), "-n", "30", "-o", str(out), "-q", "--workers", "1"]) == 0
    shown = capsys.readouterr().out
    assert "operation.force[0].x is at its largest value: a wider range may be better." in shown
    document = json.loads((out / "summary.json").read_text())
    assert set(document["files"]) >= {"optimise.nc", "optimise-convergence.png", "optimise-keys.png", "best.toml"}
    best = gw.load(out / "best.toml")
    assert best.case.optimisation == gw.load(path).case.optimisation
    forces = [np.linalg.norm(one["force_n"]) for one in best.operating_point().document["bearings"]]
    assert forces[0] == pytest.approx(document["limits"][0]["designs"][0], rel=1e-9)
    assert forces[1] == pytest.approx(document["aims"][0]["designs"][0], rel=1e-9)
    assert run_command(["report", str(out)]) == 0
    (first, _) = (out / "report.html").read_text().split(">gearwhine optimise</h2>")
    assert "Optimised design in short" in first
    assert 'href="best.toml"' in first


SMALL = """
[optimisation]
method = "grid"
speed = ["2500 rpm", "5500 rpm"]
[optimisation.design]
"housing.box.wall" = { values = ["8 mm", "12 mm"] }
"gear.pinion.helix_angle" = { values = ["0 deg", "10 deg"], with = { "gear.wheel.helix_angle" = ["0 deg", "-10 deg"], \
"gear.*.module" = ["3.175 mm", "3.12676460 mm"] } }
"gear.*.tip_relief.amount" = { range = ["10 um", "30 um"], levels = 2 }
[optimisation.aim]
"sensor.*.level_db" = { sense = "least" }
[optimisation.limit]
"housing.mass_kg" = { at_most = 50 }
""".replace("\\\n", "")


@pytest.mark.slow
def test_designs_of_walls_and_gears_equal_the_single_calculations_and_the_transient_is_that_of_simulate(
    tmp_path: Path,
) -> None:
    bundled = bundled_case("small-gearbox")
    assert bundled is not None
    thrust = "[[0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, '1e8 N/m', 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0]]"
    plain = 'stiffness = { xx = "1.2e8 N/m", yy = "1.2e8 N/m" }\ndamping = { xx = "500 N*s/m", yy = "500 N*s/m" }'
    held = f"stiffness = {{ matrix = {thrust} }}".replace("[[0,", "[['1.2e8 N/m',").replace(
        "], [0, 0, 0, 0, 0], [0, 0, '1e8", "], [0, '1.2e8 N/m', 0, 0, 0], [0, 0, '1e8"
    )
    text = bundled.read_text().replace(plain, held)
    short = ["housing.box.mesh_size=60 mm", "transient.revolutions=2", "transient.discard=1"]
    study = _study(tmp_path, text + SMALL, short)
    found = study.optimise(folder=tmp_path / "out", workers=1)
    assert found.document["designs"] == 8
    assert found.document["failed"] == []
    levels = found.dataset["value"].sel(side="high")
    # The last one: a thick wall, oblique teeth with their module, much relief.
    last = [
        "housing.box.wall=12 mm",
        "gear.pinion.helix_angle=10 deg",
        "gear.wheel.helix_angle=-10 deg",
        "gear.*.module=3.12676460 mm",
        "gear.*.tip_relief.amount=30 um",
    ]
    single = study.changed(last)
    housing = single.modes().document
    assert float(levels.sel(quantity="housing.mass_kg")[7]) == pytest.approx(housing["mass_kg"], rel=1e-9)
    masses = [housing["mass_kg"], *(row["mass_kg"] for row in single.rotors().document["rotors"])]
    assert float(levels.sel(quantity="machine.mass_kg")[7]) == pytest.approx(sum(masses), rel=1e-9)
    for sensor in ("top", "right wall"):
        at_speeds = [sensor_level(single.changed([f"operation.speed={speed} rpm"]), sensor) for speed in (2500, 5500)]
        assert float(levels.sel(quantity=f"sensor.{sensor}.level_db")[7]) == pytest.approx(max(at_speeds), abs=1e-6)
    aims = found.dataset["aim_value"].values[:, 0]
    both = [levels.sel(quantity=f"sensor.{sensor}.level_db").values for sensor in ("top", "right wall")]
    assert np.array_equal(aims, np.max(both, axis=0))
    assert found.document["aims"][0]["designs"][0] == aims.min()
    # Start and best in motion.
    checked = found.document["verification"]
    assert checked["speeds_rpm"] == pytest.approx([2500.0, 5500.0])
    motion = {"top": [], "right wall": []}
    for speed in (2500, 5500):
        for sensor in study.changed([f"operation.speed={speed} rpm"]).simulate().document["sensors"]:
            motion[sensor["name"]].append(20.0 * np.log10(sensor["rms_m_per_s2"] / 1e-6))
    for sensor, of_speeds in motion.items():
        assert checked["start"]["motion_level_db"][sensor] == pytest.approx(max(of_speeds), abs=1e-6)
        start = found.solved.start.sides[f"sensor.{sensor}.level_db"][1]
        assert checked["start"]["linear_level_db"][sensor] == pytest.approx(start, abs=1e-6)
