"""What a study of varied gearboxes tells first, on samples made by hand: each number is one that the hand counts."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from coupled_cases import sensor_level
from matplotlib.text import Text
from scipy import stats

import gearwhine as gw
from gearwhine.case.load import bundled_case
from gearwhine.case.variation import Limit
from gearwhine.cli import run_command
from gearwhine.figures.variation import draw_variation
from gearwhine.numerics.distributions import Discrete, Normal
from gearwhine.numerics.sampling import sobol_points, widened_points
from gearwhine.output.sections import Document, Table
from gearwhine.results.first_page import first_page
from gearwhine.results.variation import runout_twice_warnings, sections, varied_document
from gearwhine.variation.inputs import Input
from gearwhine.variation.quantities import Evaluation
from gearwhine.variation.statistics import VariedResult

LEVEL, SPEED = "sensor.top.level_db", "sensor.top.loudest_speed_rpm"
RPM = 30.0 / np.pi
SPEEDS = np.array([-2000.0, -2500.0, -3000.0]) / RPM


def told(levels: np.ndarray, values: np.ndarray | None = None, limit: float | None = None) -> VariedResult:
    """A study of gearboxes with these levels over three speeds, (n, 3), and inputs (n, d)."""
    inputs = np.zeros((len(levels), 1)) if values is None else values
    law = Normal(0.0, 1.0)
    names = [f"gear.pinion.errors.e{number}" for number in range(inputs.shape[1])]
    found = [
        Evaluation({LEVEL: float(row.max()), SPEED: float(-RPM * SPEEDS[row.argmax()])}, {LEVEL: row})
        for row in np.asarray(levels, dtype=float)
    ]
    return VariedResult(
        inputs=tuple(Input(name, law, "um", (), (), "class 7") for name in names),
        points=np.zeros_like(inputs),
        values=inputs,
        nominal=found[0],
        outcomes=tuple(found),
        limits={} if limit is None else {LEVEL: Limit(at_most=limit)},
        speeds=SPEEDS,
        design=None,
        resumed=0,
    )


def shown(document: Document) -> tuple[list[str], dict[str, list[dict[str, str]]]]:
    """Sentences of a study, and the rows of its tables by the first words of their captions."""
    tables, sentences = {}, []
    for item in sections(document)[0].content:
        if isinstance(item, Table):
            columns, rows = item.filled()
            named = [dict(zip([column.heading for column in columns], row, strict=True)) for row in rows]
            tables[" ".join(item.caption.split()[:2]).rstrip(";,")] = named
        else:
            sentences.append(str(item))
    return sentences, tables


TEN = np.array([[90.0, 91.0 + number, 92.0 - number] for number in range(10)])


def test_the_study_begins_with_the_gearboxes_beyond_each_limit_and_the_worst() -> None:
    document = {"command": "vary"} | varied_document(told(TEN, limit=97.5))
    sentences, tables = shown(document)
    # Levels 92, 92, 93, ..., 100: of ten three are above 97.5. Interval of 7 of 10 by Clopper and Pearson.
    assert sentences[0] == "Yield: 7 of 10 gearboxes are within all limits, 70.0 % (95 % interval 34.8 to 93.3 %)."
    (row,) = tables["Gearboxes beyond"]
    assert (row["of"], row["limit"], row["beyond"]) == ("sensor top", "≤ 97.5", "3 of 10")
    worst = tables["Worst gearboxes"]
    assert [(one["gearbox"], one["value"], one["at [rpm]"]) for one in worst] == [
        ("9", "100", "2500"),
        ("8", "99", "2500"),
        ("7", "98", "2500"),
    ]
    assert "3 speeds of the first driver: 2000 to 3000 rpm." in sentences
    (key,) = tables["Varied keys"]
    assert key["tolerance"] == "class 7"
    first = first_page(None, [document], [])[0]
    assert first.title == "Varied gearboxes in short"
    assert str(first.content[0]) == sentences[0]


def test_the_transmission_error_that_is_told_is_that_of_all_teeth() -> None:
    """Over the hunting period where pairs of teeth differ; without a limit, which would say what is wanted."""
    one, other = (f"gear_pair.{name}.transmission_error_peak_to_peak_m" for name in "ab")
    alike, whole = (name.replace("peak_to_peak", "over_hunting_period") for name in (one, other))
    found = [Evaluation({one: 1.0 + n, alike: 1.0 + n, other: 2.0 + n, whole: 9.0 - n}, {}) for n in range(4)]
    study = replace(told(np.zeros((4, 3)), np.zeros((4, 1))), nominal=found[0], outcomes=tuple(found))
    assert [row.name for row in study.headlines] == [one, whole]


def test_a_class_of_pitches_beside_a_varied_runout_is_warned_of() -> None:
    keys = ("gear.pinion.errors.pitch", "gear.pinion.errors.runout", "gear.wheel.errors.pitch")
    pitch, runout, other = (Input(key, Normal(0.0, 1.0), "um", (), ((key, 1.0),), "class 7") for key in keys)
    (warned,) = runout_twice_warnings([pitch, runout, other])
    assert "gear.pinion.errors.pitch is varied and gear.pinion.errors.runout is varied" in warned["message"]
    assert not list(runout_twice_warnings([pitch, other]))


def test_a_class_of_pitches_beside_a_runout_of_the_case_is_warned_of(tmp_path: Path) -> None:
    bundled = bundled_case("spur-pair")
    assert bundled is not None
    text = bundled.read_text().replace('name = "wheel"', 'name = "wheel"\nerrors = { runout = "20 um" }', 1)
    varied = '[variation.vary]\n"gear.*.errors.pitch" = { class = 7, independent = true }\n'
    path = tmp_path / "case.toml"
    path.write_text(f"{text}\n{varied}")
    twice = [text for text in gw.load(path).check().warnings if "counts twice" in text]
    assert len(twice) == 1
    assert "gear.wheel.errors.pitch is varied and gear.wheel.errors.runout is written" in twice[0]


def test_a_nominal_beyond_its_limit_and_too_few_samples_are_said_before_the_varied_keys() -> None:
    study = told(TEN, np.zeros((10, 2)), limit=97.5)
    study = replace(study, nominal=Evaluation({LEVEL: 110.0}, study.nominal.curves))
    sentences, _ = shown(varied_document(study))
    assert (
        "The gearbox without changes itself is beyond the limit of sensor top, highest level over speed." in sentences
    )
    assert "10 gearboxes are too few to rank 2 inputs: take 20 or more." in sentences
    assert any("lies outside 5 to 95 % of the production" in one and "a class adds" in one for one in sentences)


def test_a_limit_far_from_all_gearboxes_is_within_the_axis_of_the_distributions() -> None:
    (_, figure) = next(
        one for one in draw_variation("By hand", told(TEN, limit=50.0)) if one[0] == "vary-distributions"
    )
    low, high = figure.axes[0].get_xlim()
    assert low < 50.0 < 100.0 < high


def widened_study() -> VariedResult:
    """Forty gearboxes in three ways: as they are, and each of two inputs wider; the level is uniform up to 100."""
    points = widened_points(np.zeros((40, 2)), (0, 1))
    levels = np.linspace(90.0, 100.0, 40)
    # Both lose one gearbox of those below 97.6; the second scatters half as much again.
    ways = np.array([levels, levels + 0.2, 95.0 + 1.5 * (levels - 95.0)])
    ways[2, 27:31] = levels[27:31] + 0.2
    study = told(np.column_stack([np.full(120, 80.0), ways.T.ravel(), np.full(120, 70.0)]), np.zeros((120, 2)), 97.6)
    return replace(study, design=points, widening=1.4, points=points.points)


def test_wider_inputs_are_told_with_their_factor_and_by_what_they_change_where_the_yield_does_not() -> None:
    study = widened_study()
    document = varied_document(study)
    sentences, tables = shown(document)
    captions = [item.caption for item in sections(document)[0].content if isinstance(item, Table)]
    assert any(caption.startswith("What tolerances wider by a factor of 1.4 cost") for caption in captions)
    first, second = document["widened"]
    assert first["change"]["difference"] == second["change"]["difference"] == pytest.approx(-1.0 / 40.0)
    # Of equal changes of the yield the one that scatters more is the dearer.
    assert first["input"].endswith("e1")
    # -1 of 40: interval -0.1 to 0.05 about; half over the change to the square, times 40.
    low, high = (100.0 * first["change"][end] for end in ("low", "high"))
    assert low < 0.0 < high
    assert tables["What tolerances"][0]["95 % interval"] == f"{low:+.1f} to {high:+.1f}"
    (said,) = [one for one in sentences if one.startswith("No change of the yield is proven")]
    half = 0.005 * (high - low)
    assert f"About {float(f'{40.0 * (half * 40.0) ** 2:.1g}'):.0f} gearboxes of each in place of 40" in said
    (_, figure) = next(one for one in draw_variation("By hand", study) if one[0] == "vary-widening")
    assert any("by a factor of 1.4" in text.get_text() for text in figure.texts)


def test_a_rank_correlation_beyond_chance_is_told_and_drawn_where_no_part_is_explained() -> None:
    """A weak trend in 128 gearboxes, whose classes do not differ enough: coefficient and chance as scipy finds them."""
    x, noise = sobol_points(128, 2, 1), np.random.default_rng(1).normal(size=128)
    trend = x[:, 1] + noise
    study = told(np.column_stack([np.full(128, -9.0), trend, np.full(128, -9.0)]), x)
    (top,) = [one for one in study.quantities if one.name == LEVEL]
    reference = stats.spearmanr(x[:, 1], trend)
    assert top.explained == {}
    assert top.leading_ranks == {"gear.pinion.errors.e1": pytest.approx(reference.statistic)}
    assert top.rank_chances["gear.pinion.errors.e1"] == pytest.approx(reference.pvalue, rel=1e-9)
    sentences, tables = shown(varied_document(study))
    (row,) = tables["What matters:"]
    assert row["rank correlation (p: by chance)"] == f"{reference.statistic:+.2f} (p = {reference.pvalue:.0e})"
    assert not [one for one in sentences if one.startswith("No input alone")]
    figures = dict(draw_variation("By hand", study))
    (axes,) = figures["vary-importance"].axes
    assert axes.get_xlabel() == "rank correlation"
    assert [bar.get_width() for bar in axes.patches] == [pytest.approx(reference.statistic)]


def test_a_loudest_speed_at_an_end_of_the_speeds_is_warned_of_with_its_part() -> None:
    at_end = np.tile([80.0, 90.0, 85.0], (20, 1)) + np.linspace(0.0, 1.0, 20)[:, None]
    at_end[:3, 2] = 95.0
    (warned,) = varied_document(told(at_end))["warnings"]
    assert (warned["name"], warned["share"]) == ("loudest speed", 0.15)
    assert (
        "sensor top is the loudest at an end of the speeds, 2000 to 3000 rpm, in 15 % of the gearboxes"
        in (warned["message"])
    )
    at_end[:3, 2] = 70.0
    assert varied_document(told(at_end))["warnings"] == []


def test_pitch_deviations_are_said_to_be_judged_by_their_range() -> None:
    """What a range does not explain is not what all pitches do not do."""
    plain = told(TEN)
    pitched = replace(plain, inputs=(replace(plain.inputs[0], name="gear.pinion.errors.pitch"),))
    for study, is_said in ((plain, False), (pitched, True)):
        sentences, _ = shown({"command": "vary"} | varied_document(study))
        assert any("judged by their range" in one for one in sentences) is is_said


def test_what_has_no_mean_is_left_out_and_lives_are_shown_to_their_bound() -> None:
    study = told(TEN)
    both = (("bearing.a.clearance", 1.0), ("bearing.b.clearance", 1.0))
    words = Input("bearing.*.clearance", Discrete([0.0, 1.0]), "", ("C2", "C3"), both, "C2, C3")
    document = varied_document(replace(study, inputs=(words,)))
    (key,) = shown(document)[1]["Varied keys"]
    tolerance = "C2, C3; one value for 2 entries"
    assert (key["tolerance"], key.get("mean", ""), key.get("std", "")) == (tolerance, "", "")
    # Of pitches the file holds the range of the cumulative deviations, whose mean says nothing of the tolerance.
    pitches = document["inputs"][0] | {
        "unit": "m",
        "distribution": "pitches",
        "mean": 1.8e-5,
        "tolerance": "class 7",
        "entries": 1,
    }
    (key,) = shown(document | {"inputs": [pitches]})[1]["Varied keys"]
    assert (key["tolerance"], key.get("mean", "")) == ("class 7", "")
    document["quantities"].append(document["quantities"][0] | {"name": "bearing.left.life_h", "mean": 4.5764e6})
    rows = shown(document)[1]["Distributions; nominal:"]
    assert rows[-1]["mean"] == "> 1e6"


@pytest.mark.parametrize(
    ("written", "words"),
    [
        ({"class": 7}, "class 7"),
        ({"fit": "k6"}, "fit k6"),
        ({"normal": ["12 um", "2 um"], "within": ["6 um", "18 um"]}, "normal 12 um ± 2 um, within 6 um to 18 um"),
        ({"uniform": ["1 mm", "2 mm"]}, "uniform 1 mm to 2 mm"),
        ({"values": ["C2", "C3"]}, "C2, C3"),
    ],
)
def test_a_tolerance_is_told_as_the_case_gives_it(written: dict[str, object], words: str) -> None:
    from gearwhine.case.variation import Varied

    assert Varied.model_validate(written).words == words


def test_the_case_of_the_worst_gearbox_has_the_level_of_its_title_when_it_is_opened(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The level is that of the lines of the case as it stands."""
    bundled = bundled_case("small-gearbox")
    assert bundled is not None
    path, out = tmp_path / "case.toml", tmp_path / "out"
    text = '[variation]\nsamples = 2\nanalyses = ["lines"]\nspeed = ["2500 rpm", "4000 rpm"]\n'
    text += 'vary = { "gear.*.errors.helix.slope" = { class = 7, independent = true } }\n'
    path.write_text(bundled.read_text() + text)
    command = ["vary", str(path), "-o", str(out), "--set", "housing.box.mesh_size=60 mm", "-q", "--workers", "1"]
    assert run_command(command) == 0
    document = json.loads((out / "summary.json").read_text())
    # What the mesh and the operating point warn of is in the study as `load` has it, each once.
    messages = [one["message"] for one in document["warnings"]]
    of_load = gw.load(path, {"housing.box.mesh_size": "60 mm"}, folder=out).operating_point().document["warnings"]
    assert any("this mesh makes" in one["message"] for one in of_load)
    assert [messages.count(one["message"]) for one in of_load] == [1] * len(of_load)
    told_once = capsys.readouterr().err
    assert told_once.count("this mesh makes") == 1
    rows = document["worst"]
    worst = next(row for row in rows if row["quantity"] == LEVEL)
    study = gw.load(out / f"worst-{LEVEL}-1.toml")
    assert sensor_level(study, "top") == pytest.approx(worst["value"], abs=1e-3)
    assert study.case.operation is not None
    assert abs(study.case.operation.speed) * RPM == pytest.approx(worst["speed_rpm"])
    assert f"{worst['value']:.6g} at {worst['speed_rpm']:.5g} rpm" in study.case.title
    assert f"{worst['speed_rpm']:.5g} rpm" in study.case.notes


def test_pictures_keep_titles_off_the_note_and_the_ends_of_long_keys() -> None:
    x = sobol_points(64, 1, 1)
    study = told(np.array([80.0, 90.0, 85.0]) + 5.0 * x, x)
    key = "bearing.in-front.stiffness.rolling.catalogue.clearance"
    figures = dict(draw_variation("By hand", replace(study, inputs=(replace(study.inputs[0], name=key),))))
    (scatter,) = figures["vary-scatter-1"].axes
    assert scatter.get_xlabel().startswith("bearing.in-front")
    assert scatter.get_xlabel().endswith("clearance [µm]")
    over_speed = figures["vary-speeds"]
    over_speed.canvas.draw()
    (axes,) = over_speed.axes
    (title,) = [one for one in axes.get_children() if isinstance(one, Text) and one.get_text().startswith("sensor")]
    assert not any(title.get_window_extent().overlaps(note.get_window_extent()) for note in over_speed.texts)


def test_a_speed_without_a_line_is_a_gap_in_the_picture() -> None:
    study = told(np.array([80.0, 90.0, 85.0]) + 5.0 * sobol_points(64, 1, 1), sobol_points(64, 1, 1))
    (name,) = study.nominal.curves
    silent = replace(study.nominal, curves={name: np.array([80.0, -120.0, 85.0])})
    (axes,) = dict(draw_variation("By hand", replace(study, nominal=silent)))["vary-speeds"].axes
    assert axes.get_ylim()[0] > 70.0
    assert np.isfinite(axes.lines[1].get_ydata()).tolist() == [True, False, True]


def test_the_solved_housing_survives_an_interruption_of_the_samples(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    torque = {"variation.vary": {"operation.torque": {"uniform": ["50 N*m", "90 N*m"]}}, "variation.analyses": ["mass"]}
    said = list[str]()
    study = gw.load("small-gearbox", {"housing.box.mesh_size": "60 mm"} | torque)
    study.progress = lambda text, *_: said.append(text)
    with monkeypatch.context() as patched:
        patched.setattr("gearwhine.analyses.variation_result.run_samples", interrupted)
        with pytest.raises(KeyboardInterrupt):
            study.vary(2, folder=tmp_path)
    study.vary(2, folder=tmp_path)
    assert f"modes read from {tmp_path / 'modes.nc'} (unchanged housing)" in said
