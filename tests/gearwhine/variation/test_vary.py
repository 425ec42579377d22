"""Varied gearboxes: each equals the single calculation, known distributions come out, and nothing found is lost."""

import json
import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coupled_cases import sensor_level
from scipy import stats

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.case.load import bundled_case
from gearwhine.cli import run_command
from gearwhine.coupling.machine.loads import ShaftForce
from gearwhine.numerics.distributions import Normal, Uniform
from gearwhine.numerics.sampling import sobol_points
from gearwhine.output.report.elements import fragment
from gearwhine.results.variation import report
from gearwhine.rotors.rolling_bearings import catalogue_bearing
from gearwhine.variation import run
from gearwhine.variation.samples import FOLDER
from gearwhine.variation.statistics import QuantityStatistics
from tests.machines.belted_shaft import BELTED_SHAFT

SHAFT = (
    BELTED_SHAFT
    + """
[variation]
samples = 256
[variation.vary]
"operation.force[0].x" = { uniform = ["800 N", "1200 N"] }
"operation.force[1].x" = { uniform = ["100 N", "900 N"] }
[variation.limit]
"bearing.left.force_n" = { at_most = 940 }
"""
)
LEFT = "bearing.left.force_n"
LIVES = ("life_h", "reference_life_h")
TE = "gear_pair.pinion-wheel.transmission_error_peak_to_peak_m"


def _written(tmp_path: Path, case: str, text: str) -> Path:
    bundled = bundled_case(case)
    assert bundled is not None
    path = tmp_path / "case.toml"
    path.write_text(bundled.read_text() + text)
    return path


def _shaft(tmp_path: Path, text: str = SHAFT) -> Path:
    path = tmp_path / "shaft.toml"
    path.write_text(text)
    return path


def test_gears_without_shafts_and_shafts_without_gears_are_varied(tmp_path: Path) -> None:
    text = '[variation]\nsamples = 3\nvary = { "gear.*.profile_shift" = { uniform = [0.0, 0.02] } }\n'
    found = gw.load(_written(tmp_path, "gear-62-62", text)).vary(folder=tmp_path / "gears", workers=1)
    assert not found.document["failed"]
    names = [row["name"].rpartition(".")[2] for row in found.document["quantities"]]
    assert names[0] == "transmission_error_peak_to_peak_m"
    bare = SHAFT[: SHAFT.index("[operation]")] + "[variation.vary]\n"
    bare += '"rotor.shaft.segments[0].diameter" = { uniform = ["29 mm", "31 mm"] }\n'
    shafts = gw.load(_shaft(tmp_path, bare + "[operation]\nspeed = '100 rpm'\n"))
    found = shafts.vary(3, folder=tmp_path / "shafts", workers=1)
    assert [row["name"] for row in found.document["quantities"]][:1] == ["rotor.shaft.critical_speed_1_rpm"]


@pytest.mark.parametrize(
    ("key", "low", "high"), [("bearing.input-back.at", "21 mm", "24 mm"), ("housing.box.wall", "7 mm", "9 mm")]
)
def test_a_key_of_the_housing_gives_each_gearbox_a_housing_of_its_own(
    tmp_path: Path, key: str, low: str, high: str
) -> None:
    """Walls, and places of bearings, which enter its static responses: a sample equals the case with the value."""
    text = '[variation]\nsamples = 1\nanalyses = ["load"]\n'
    text += f'vary = {{ "{key}" = {{ uniform = ["{low}", "{high}"] }} }}\n'
    study = gw.load(_written(tmp_path, "small-gearbox", text), {"housing.box.mesh_size": "60 mm"})
    found = study.vary(folder=tmp_path / "out", workers=1)
    value = float(found.dataset["input_value"].values[0, 0])
    single = gw.load(tmp_path / "case.toml", [f"{key}={value!r} mm", "housing.box.mesh_size=60 mm"])
    for bearing in single.operating_point().document["bearings"]:
        force = found.dataset["value"].sel(quantity=f"bearing.{bearing['name']}.force_n")
        assert float(force[0]) == pytest.approx(np.linalg.norm(bearing["force_n"]), rel=1e-12)
    pair = single.operating_point().document["gear_pairs"][0]
    misalignment = found.dataset["value"].sel(quantity="gear_pair.pinion-wheel.misalignment_rad")
    assert float(misalignment[0]) == pytest.approx(pair["misalignment_rad"], rel=1e-9)


def test_the_level_of_the_motion_is_that_of_simulate(tmp_path: Path) -> None:
    text = '[variation]\nsamples = 1\nanalyses = ["motion"]\n'
    text += 'vary = { "operation.torque" = { uniform = ["50 N*m", "80 N*m"] } }\n'
    short = {"housing.box.mesh_size": "60 mm", "transient.revolutions": 2, "transient.discard": 1}
    study = gw.load(_written(tmp_path, "small-gearbox", text), short)
    found = study.vary(folder=tmp_path / "out", workers=1)
    torque = float(found.dataset["input_value"].values[0, 0])
    sensors = study.changed([f"operation.torque={torque!r} N*m"]).simulate().document["sensors"]
    assert len(sensors) == 2
    for sensor in sensors:
        level = found.dataset["value"].sel(quantity=f"sensor.{sensor['name']}.motion_level_db")
        assert float(level[0]) == pytest.approx(20.0 * np.log10(sensor["rms_m_per_s2"] / 1e-6), abs=1e-6)


@pytest.mark.parametrize(
    ("values", "mean", "deviation"),
    [([1.0, np.nan, 3.0], 2.0, np.sqrt(2.0)), ([np.nan, 4.0], 4.0, np.nan), ([np.nan], np.nan, np.nan)],
)
def test_statistics_of_few_gearboxes_leave_out_those_that_failed(
    values: list[float], mean: float, deviation: float
) -> None:
    found = QuantityStatistics("force_n", 0.0, np.array(values), np.zeros((len(values), 1)), ("key",))
    assert [found.mean, found.deviation] == pytest.approx([mean, deviation], nan_ok=True)


def _by_hand(forces: np.ndarray) -> np.ndarray:
    """Forces on the bearings of the shaft, left and right, (n, 2)."""
    return forces @ np.array([[0.8, 0.2], [0.2, 0.8]])


@pytest.mark.slow
def test_each_gearbox_equals_the_single_calculation(tmp_path: Path) -> None:
    text = """
[sweep]
speed = ["2500 rpm", "5500 rpm"]
[variation]
samples = 2
[variation.vary]
"gear.*.errors.helix.slope" = { class = 8, independent = true }
"gear.pinion.errors.runout" = { class = 8 }
"bearing.input-back.stiffness.xx" = { uniform = ["0.8e8 N/m", "1.4e8 N/m"] }
"operation.torque" = { normal = ["70 N*m", "5 N*m"], within = ["60 N*m", "80 N*m"] }
"""
    path = _written(tmp_path, "small-gearbox", text)
    study = gw.load(path, {"housing.box.mesh_size": "60 mm"})
    found = study.vary(folder=tmp_path / "out", workers=1)
    table = found.dataset["value"].to_series().unstack()
    inputs = found.dataset["input_value"].to_series().unstack()
    assert list(inputs.columns) == [row["key"] for row in found.document["inputs"]]
    units = dict(zip(found.dataset["input"].values, found.dataset["input_unit"].values, strict=True))
    for number in [1]:
        changes = [f"{key}={value!r} {units[key]}" for key, value in inputs.loc[number].items()]
        single = study.changed(["housing.box.mesh_size=60 mm", *changes])
        load = single.operating_point().document
        pair = load["gear_pairs"][0]
        row = table.loc[number]
        assert row["gear_pair.pinion-wheel.k_h_beta"] == pytest.approx(pair["k_h_beta"], rel=1e-9)
        assert row["gear_pair.pinion-wheel.misalignment_rad"] == pytest.approx(pair["misalignment_rad"], rel=1e-9)
        for bearing in load["bearings"]:
            force = np.linalg.norm(bearing["force_n"])
            assert row[f"bearing.{bearing['name']}.force_n"] == pytest.approx(force, rel=1e-9)
        gears = single.gears(without=("harris-map", "relief")).document["pairs"][0]
        assert row[TE] == pytest.approx(gears["transmission_error_m"]["peak_to_peak"], rel=1e-9)
        # The lines of a sensor at each speed are those of `system` there.
        for place, speed in enumerate((2500, 5500)):
            there = single.changed([f"operation.speed={speed} rpm"])
            for sensor in ("top", "right wall"):
                level = sensor_level(there, sensor)
                curve = found.dataset["value_over_speed"].sel(curve=f"sensor.{sensor}.level_db")
                assert float(curve[number, place]) == pytest.approx(level, abs=1e-6)


def test_the_share_within_a_limit_is_that_of_the_known_distribution(tmp_path: Path) -> None:
    """The left bearing carries 0.8 F1 + 0.2 F2, a sum of two uniform parts."""
    found = gw.load(_shaft(tmp_path)).vary(folder=tmp_path / "out", workers=1)
    first, second = found.dataset["input_value"].values.T
    values = found.dataset["value"].sel(quantity=LEFT).values
    assert np.allclose(values, 0.8 * first + 0.2 * second, rtol=1e-9)
    assert first.min() > 800.0
    assert second.max() < 900.0
    # 640 to 960 N with a trapezoidal density: the share above 940 by its corner.
    widths = np.array([0.8 * 400.0, 0.2 * 800.0])
    corner = 0.8 * 1200.0 + 0.2 * 900.0 - 940.0
    assert corner > widths[1]
    above = (corner - 0.5 * widths[1]) / widths[0]
    share = found.document["yield"]
    assert share["low"] < 1.0 - above < share["high"]
    assert abs(share["share"] - (1.0 - above)) < 0.01
    (row,) = [row for row in found.document["quantities"] if row["name"] == LEFT]
    assert row["nominal"] == pytest.approx(900.0, rel=1e-9)
    assert row["mean"] == pytest.approx(900.0, rel=2e-3)
    assert row["std"] == pytest.approx(np.hypot(*widths) / np.sqrt(12.0), rel=0.02)
    assert row["quantiles"]["0.5"] == pytest.approx(900.0, rel=5e-3)
    assert row["within"] == share
    assert row["rank_correlation"]["operation.force[0].x"] == pytest.approx(
        stats.spearmanr(first, values).statistic, abs=1e-12
    )
    # The worst are the highest, and their cases give the value again.
    order = np.argsort(-values)[:3]
    assert row["worst"] == order.tolist()
    worst = next(iter(sorted((tmp_path).glob("nothing"))), None)
    assert worst is None


@pytest.mark.slow
def test_sobol_indices_of_a_linear_machine_are_those_of_the_closed_form(tmp_path: Path) -> None:
    found = gw.load(_shaft(tmp_path)).vary(128, indices=True, folder=tmp_path / "out", workers=1)
    assert found.document["samples"] == 128 * 4
    (row,) = [row for row in found.document["quantities"] if row["name"] == LEFT]
    parts = np.array([0.8 * 400.0, 0.2 * 800.0]) ** 2
    for key, expected in zip(("operation.force[0].x", "operation.force[1].x"), parts / parts.sum(), strict=True):
        for which in ("sobol_first", "sobol_total"):
            value, low, high = row[which][key]
            assert low <= expected <= high
            assert value == pytest.approx(expected, abs=0.05)
    # The yield is of the gearboxes that stand for the production, not of those made for the indices.
    assert int(found.dataset["representative"].sum()) == 256


def test_correlated_forces_scatter_as_their_sum_does(tmp_path: Path) -> None:
    keys = 'keys = ["operation.force[0].x", "operation.force[1].x"]'
    text = SHAFT.replace("uniform", "normal").replace('"800 N", "1200 N"', '"1000 N", "50 N"')
    text = text.replace('"100 N", "900 N"', '"500 N", "100 N"')
    text += f"[[variation.correlation]]\n{keys}\ncoefficient = -0.6\n"
    found = gw.load(_shaft(tmp_path, text)).vary(256, folder=tmp_path / "out", workers=1)
    (row,) = [row for row in found.document["quantities"] if row["name"] == LEFT]
    variance = (0.8 * 50.0) ** 2 + (0.2 * 100.0) ** 2 - 2.0 * 0.6 * (0.8 * 50.0) * (0.2 * 100.0)
    assert row["std"] == pytest.approx(np.sqrt(variance), rel=0.03)
    with pytest.raises(CaseError, match="independent inputs alone"):
        gw.load(_shaft(tmp_path, text)).vary(8, indices=True, folder=tmp_path / "out", workers=1)


def test_impossible_gearboxes_fail_by_themselves_and_say_why(tmp_path: Path) -> None:
    """Pinions of 27 and 29 teeth do not fit between the shafts of 28 and 28."""
    text = '[variation]\nsamples = 16\nanalyses = ["gears"]\n[variation.vary]\n'
    text += '"gear.pinion.teeth" = { values = [28, 40] }\n"operation.torque" = { uniform = ["60 N*m", "80 N*m"] }\n'
    found = gw.load(_written(tmp_path, "spur-pair", text)).vary(folder=tmp_path / "out", workers=1)
    failed = [row["number"] for row in found.document["failed"]]
    teeth = sobol_points(16, 2, 1)[:, 0]
    assert failed == np.flatnonzero(teeth >= 0.5).tolist()
    assert all("gear" in row["message"] for row in found.document["failed"])
    values = found.dataset["value"].sel(quantity=TE).values
    assert np.isnan(values[failed]).all()
    assert np.isfinite(np.delete(values, failed)).all()
    assert any("cannot be solved" in text for text in found.warnings)


def test_a_study_goes_on_where_it_ended_and_a_torn_record_costs_its_last_line(tmp_path: Path) -> None:
    path, out = _shaft(tmp_path), tmp_path / "out"
    first = gw.load(path).vary(20, folder=out, workers=1)
    (record,) = (out / FOLDER).glob("*.jsonl")
    lines = record.read_bytes().splitlines(keepends=True)
    assert len(lines) == 20
    record.write_bytes(b"".join(lines[:12]) + lines[12][:30])
    again = gw.load(path).vary(30, folder=out, workers=1)
    assert again.document["resumed"] == 12
    assert np.array_equal(again.dataset["value"].values[:20], first.dataset["value"].values)
    assert len(record.read_bytes().splitlines()) == 30
    # Other points are other samples: of another seed, or of the design for indices.
    seeded = gw.load(path).vary(30, seed=9, folder=out, workers=1)
    assert seeded.document["resumed"] == 0
    assert np.allclose(seeded.dataset["value"].values, _by_hand(seeded.dataset["input_value"].values), rtol=1e-9)
    # The first point of two sequences of one seed may be the same.
    assert gw.load(path).vary(8, indices=True, folder=out, workers=1).document["resumed"] <= 1
    assert gw.load(path).vary(30, folder=out, workers=1).document["resumed"] == 30
    # Another distribution is another record, and the old one goes.
    other = gw.load(path, ["variation.vary.'operation.force[0].x'.uniform=['700 N', '1200 N']"])
    assert other.vary(5, folder=out, workers=1).document["resumed"] == 0
    assert [one != record for one in (out / FOLDER).glob("*.jsonl")] == [True]


def test_workers_that_are_asked_for_are_taken_however_short_the_study_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def alone(varied: Any, points: np.ndarray, batches: Any, folder: Path, workers: int, *_: object) -> Iterator[Any]:
        asked.append(workers)
        for batch in batches:
            yield [(number, varied.solve(points[number])) for number in batch]

    monkeypatch.setattr(run, "_solved_by_workers", alone)
    study = gw.load(_shaft(tmp_path))
    for workers in (2, None, 1):
        assert not study.vary(6, folder=tmp_path / f"by {workers}", workers=workers).document["failed"]
    assert asked == [2]


def test_limits_of_unknown_quantities_and_analyses_without_their_tables_are_refused(tmp_path: Path) -> None:
    wrong = SHAFT.replace(LEFT, "bearing.lift.force_n")
    with pytest.raises(CaseError, match=r"a bearing of this case \(left, right\); did you mean 'left'"):
        gw.load(_shaft(tmp_path, wrong)).vary(4, folder=tmp_path / "out", workers=1)
    with pytest.raises(CaseError, match="at least one pair of gears"):
        gw.load(_shaft(tmp_path, SHAFT.replace("samples = 256", 'analyses = ["gears"]'))).vary(folder=tmp_path / "o")
    with pytest.raises(CaseError, match=r"needs \[variation\]"):
        gw.load("spur-pair").vary(folder=tmp_path / "o")


def test_a_median_that_the_key_does_not_take_is_refused_before_anything_is_solved(tmp_path: Path) -> None:
    wrong = SHAFT.replace(
        '"operation.force[1].x" = { uniform = ["100 N", "900 N"] }',
        '"rotor.shaft.start" = { uniform = ["1 N", "2 N"] }',
    )
    with pytest.raises(CaseError, match=r"variation\.vary, rotor\.shaft\.start: .*expected a length"):
        gw.load(_shaft(tmp_path, wrong)).vary(4, folder=tmp_path / "out", workers=1)


def test_an_end_that_makes_no_gearbox_is_refused_before_anything_is_solved(tmp_path: Path) -> None:
    """Teeth thinned by 2 mm are undercut, though the key takes any length."""
    text = '[variation.vary]\n"gear.pinion.tooth_thinning" = { uniform = ["0 mm", "2 mm"] }\n'
    pattern = r"case\.toml: variation\.vary, gear\.pinion\.tooth_thinning = 2\.0 mm: gear\[0\]"
    with pytest.raises(CaseError, match=pattern):
        gw.load(_written(tmp_path, "spur-pair", text)).check()


def test_machines_of_python_are_varied_by_the_same_statistics() -> None:
    """The critical speed of a stiff disc on a massless shaft in short bearings goes as the square of its diameter."""
    steel = gw.ShaftMaterial(207e9, 80e9, 1e-3)

    def made(values: dict[str, float]) -> gw.Machine:
        if values["diameter"] > 0.0203:
            raise ValueError("a shaft that does not fit its hub")
        disc = gw.Disc(0.25, values["mass"], 1e-6, 5e-7)
        rotor = gw.Rotor("shaft", [gw.Segment(0.5, values["diameter"], 0.0, steel)], [disc])
        bearings = [gw.MountedBearing(gw.Bearing.isotropic(f"{at}", at, 1e12), "shaft", None) for at in (0.0, 0.5)]
        return gw.Machine([gw.Shaft(rotor)], bearings, speed=10.0)

    laws = {"diameter": Normal(0.02, 1e-4), "mass": Uniform(1.9, 2.1)}
    name = "rotor.shaft.critical_speed_1_rpm"
    limits = {name: (1.0, None)}
    found = gw.vary(made, laws, 64, analyses=["rotors"], limits=limits, title="discs")
    diameter, mass = found.dataset["input_value"].values.T
    values = found.dataset["value"].sel(quantity=name).values
    assert [row["number"] for row in found.document["failed"]] == np.flatnonzero(diameter > 0.0203).tolist()
    stiffness = 48.0 * 207e9 * np.pi * diameter**4 / 64.0 / 0.5**3
    expected = np.sqrt(stiffness / mass) * 30.0 / np.pi
    solved = np.isfinite(values)
    # The shear of the shaft lowers it, alike for all.
    ratio = values[solved] / expected[solved]
    assert np.ptp(ratio) < 1e-4
    assert 0.99 < ratio.mean() < 1.0
    assert found.document["yield"]["share"] == 1.0
    with pytest.raises(gw.CouplingError, match="expected some of gears, load"):
        gw.vary(made, laws, 4, analyses=["noise"])
    for given, said in (
        ({"laws": {}}, "a distribution of one value or more"),
        ({"samples": 0}, "samples is 0; expected a whole number of at least 1"),
        ({"samples": "16"}, "samples is '16'"),
        ({"seed": -1}, "seed is -1; expected a whole number of at least 0"),
        ({"workers": 0}, "workers is 0"),
    ):
        with pytest.raises(ValueError, match=said):
            gw.vary(made, **{"laws": laws, "samples": 4, **given})
    with pytest.raises(gw.CouplingError, match="no quantity of gears"):
        gw.vary(made, laws, 4, analyses=["gears"])
    with pytest.raises(
        gw.CouplingError, match=r"critical_speed_1_rpm' is \(2.0, 1.0\); expected a least value and a largest one"
    ):
        gw.vary(made, laws, 4, limits={name: (2.0, 1.0)})


def test_quantities_of_your_own_scatter_by_their_closed_form_and_infinite_ones_stay_such(tmp_path: Path) -> None:
    """Of a width from 1 to 2 m: the area has the moments of the uniform law; a strip above 1.5 m lasts for ever."""

    def strip(values: Mapping[str, float]) -> dict[str, float]:
        return {"area_m2": 2.0 * values["width"], "life_h": math.inf if values["width"] > 1.5 else 1.0}

    for _ in range(2):  # the second time from the folder
        found = gw.vary(strip, {"width": Uniform(1.0, 2.0)}, 64, limits={"life_h": (5.0, None)}, folder=tmp_path)
        area, _ = found.solved.quantities
        assert (area.mean, area.deviation) == pytest.approx((3.0, 2.0 / math.sqrt(12.0)), rel=0.01)
        assert found.document["yield"]["share"] == 0.5
    assert found.document["resumed"] == 64
    ranges = {name: Normal(1.0, size) for name, size in (("a", 0.1), ("b", 0.2))}
    pair = {("b", "a"): -0.5}
    (total,) = gw.vary(lambda v: {"sum_m": v["a"] + v["b"]}, ranges, 512, correlations=pair).solved.quantities
    assert total.deviation == pytest.approx(math.sqrt(0.1**2 + 0.2**2 - 2.0 * 0.5 * 0.1 * 0.2), rel=0.02)
    for pair, said in (({("a", "c"): 0.5}, r"\('a', 'c'\); expected two of a, b"), ({("a", "b"): 1.5}, "from -1 to 1")):
        with pytest.raises(gw.CouplingError, match=said):
            gw.vary(lambda v: {"sum_m": v["a"] + v["b"]}, ranges, 4, correlations=pair)
    with pytest.raises(gw.CouplingError, match="returned 'wide' as 'width_m'; expected a number"):
        gw.vary(lambda _: {"width_m": "wide"}, {"width": Uniform(1.0, 2.0)}, 4)


def test_lives_of_varied_bearings_are_those_of_iso_281_and_of_the_operating_point() -> None:
    """`life_h` is (C / P)³ of the force of statics, as in `load`; `reference_life_h` that of the elements' loads."""
    rating = 29.6e3

    def made(values: dict[str, float]) -> gw.Machine:
        ball = catalogue_bearing("deep-groove", 0.03, 0.072, 0.019, clearance=8e-6, dynamic=rating)
        held = [
            gw.MountedBearing.from_elements(name, at, "shaft", None, replace(ball, floating=True))
            for name, at in (("left", 0.0), ("right", 0.5))
        ]
        rotor = gw.Rotor("shaft", [gw.Segment(0.5, 0.03, 0.0, gw.STEEL)])
        pull = ShaftForce("shaft", 0.1, (values["pull"], 0.0, 0.0))
        return gw.Machine([gw.Shaft(rotor)], held, speed=gw.rpm(1000.0), forces=[pull])

    found = gw.vary(made, {"pull": Uniform(900.0, 2400.0)}, 2, analyses=["load"])
    for sample in (0, 1):
        (pull,) = found.dataset["input_value"].values[sample]
        point = gw.Study(made({"pull": float(pull)})).operating_point().document
        for share, bearing in zip((0.8, 0.2), point["bearings"], strict=True):
            values = found.dataset["value"].sel(quantity=[f"bearing.{bearing['name']}.{key}" for key in LIVES])
            life, reference = values.values[sample]
            assert life == pytest.approx((rating / (share * pull)) ** 3 * 1e6 / 60.0 / 1000.0, rel=0.03)
            assert [life, reference] == pytest.approx([bearing[key] for key in LIVES], rel=1e-9)
            assert reference != pytest.approx(life, rel=0.01)


def test_the_command_writes_the_study_and_its_worst_gearboxes_as_cases(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert run_command(["vary", str(_shaft(tmp_path)), "-n", "64", "-o", str(out), "-q"]) == 0
    shown = capsys.readouterr().out
    assert "Yield:" in shown
    document = json.loads((out / "summary.json").read_text())
    assert set(document["files"]) >= {"vary.nc", "vary-distributions.png", "vary-importance.png", "vary-scatter-1.png"}
    (row,) = [row for row in document["quantities"] if row["name"] == LEFT]
    worst = gw.load(out / f"worst-{LEFT}-1.toml")
    load = worst.operating_point().document["bearings"][0]
    assert np.linalg.norm(load["force_n"]) == pytest.approx(max(row["quantiles"].values()), rel=0.05)
    assert tomllib.loads((out / "worst-bearing.left.force_n-1.toml").read_text())["title"].startswith("A shaft")
    assert {row["case"] for row in document["worst"]} == {path.name for path in out.glob("worst-*.toml")}
    first = gw.load(out / document["worst"][0]["case"])
    assert f"gearbox {document['worst'][0]['gearbox']}, " in first.case.title
    assert f'<a href="{document["worst"][0]["case"]}">' in fragment([report(document)])
    assert run_command(["vary", str(_shaft(tmp_path)), "-n", "64", "-o", str(out), "--json", "-q"]) == 0
    assert json.loads(capsys.readouterr().out)["resumed"] == 64
    assert run_command(["vary", "spur-pair", "-o", str(out)]) == 2
    assert "variation" in capsys.readouterr().err
