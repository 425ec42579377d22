"""Varied keys: what a distribution in a case changes, and what is refused."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

import gearwhine as gw
from gearwhine.analyses import optimisation_result, variation_result
from gearwhine.analyses.variation_result import name_problems, parts_of, wanted_of
from gearwhine.case import CaseError
from gearwhine.case.load import bundled_case, load_case
from gearwhine.case.variation import Variation, Varied
from gearwhine.results.check import summary
from gearwhine.variation.inputs import Input, correlation_matrix, varied_inputs
from gearwhine.variation.named_quantities import analysis_of, possible_quantities
from gearwhine.variation.quantities import Wanted
from gearwhine.variation.samples import VariedCase

HELIX = "errors.helix.slope"


def _inputs(tmp_path: Path, text: str, case: str = "helical-pair", changes: Sequence[str] = ()) -> tuple[Input, ...]:
    bundled = bundled_case(case)
    assert bundled is not None
    path = tmp_path / "case.toml"
    path.write_text(bundled.read_text() + "\n[variation]\n" + text)
    study = gw.load(path, list(changes))
    variation = study.case.variation
    assert variation is not None
    inputs = varied_inputs(study._source, variation)
    correlation_matrix(inputs, variation)
    return inputs


def test_tied_keys_have_one_value_times_their_factor(tmp_path: Path) -> None:
    text = 'vary = { "gear.*.helix_angle" = { uniform = ["12 deg", "16 deg"], factor = { wheel = -1 } } }'
    (one,) = _inputs(tmp_path, text)
    assert list(one.overrides(0.25)) == ["gear.pinion.helix_angle=13.0 deg", "gear.wheel.helix_angle=-13.0 deg"]


def test_a_star_stands_for_every_entry_that_takes_the_key(tmp_path: Path) -> None:
    """The pinion has a helix table, the wheel none; both are varied, each by itself, at its own tolerance."""
    pinion, wheel = _inputs(tmp_path, f'vary = {{ "gear.*.{HELIX}" = {{ class = 5, independent = true }} }}')
    assert (pinion.name, wheel.name) == (f"gear.pinion.{HELIX}", f"gear.wheel.{HELIX}")
    assert [key for key, _ in (*pinion.keys, *wheel.keys)] == [f"gear.pinion.{HELIX}", f"gear.wheel.{HELIX}"]
    for one, teeth in ((pinion, 23), (wheel, 41)):
        diameter = teeth * 3.0 / np.cos(np.radians(15.0))
        tolerance = 0.05 * np.sqrt(diameter) + 0.35 * np.sqrt(25.0) + 4.0
        cut = stats.truncnorm(-3.0, 3.0, 0.0, tolerance / 3.0)
        assert [one.value(at) for at in (0.1, 0.9)] == pytest.approx(cut.ppf([0.1, 0.9]), rel=1e-9)
        assert one.unit == "um"


def test_gears_that_are_named_by_numbers_are_varied_each_by_its_name(tmp_path: Path) -> None:
    bundled = bundled_case("spur-pair")
    assert bundled is not None
    text = bundled.read_text().replace('"pinion"', '"1"').replace('"wheel"', '"2"')
    path = tmp_path / "pair.toml"
    law = '{ uniform = ["10 um", "20 um"], independent = true }'
    path.write_text(f'{text}\n[variation.vary]\n"gear.*.tooth_thinning" = {law}\n')
    loaded = load_case(path)
    assert loaded.case.variation is not None
    for one, thinned in zip(varied_inputs(loaded.source, loaded.case.variation), "12", strict=True):
        gears = loaded.source.changed_case(list(one.overrides(0.5))).gear
        assert [gear.name for gear in gears if gear.tooth_thinning > 0.0] == [thinned]


def test_a_star_leaves_out_entries_that_do_not_take_the_key(tmp_path: Path) -> None:
    """Two of the four bearings have a matrix, which has no xx."""
    (one,) = _inputs(tmp_path, 'vary = { "bearing.*.stiffness.xx" = { uniform = ["1e8 N/m", "2e8 N/m"] } }')
    assert [key for key, _ in one.keys] == ["bearing.input-right.stiffness.xx", "bearing.output-right.stiffness.xx"]


def test_units_of_one_distribution_may_differ(tmp_path: Path) -> None:
    (one,) = _inputs(tmp_path, 'vary = { "gear.pinion.bore" = { triangular = ["39 mm", "0.04 m", "41000 um"] } }')
    assert one.unit == "mm"
    assert one.value(0.5) == pytest.approx(40.0)


@pytest.mark.parametrize(
    ("key", "fit", "size", "low", "high"),
    [("inner", "k6", "30 mm", 2.0, 15.0), ("outer", "H7", "62 mm", -30.0, 0.0), ("outer", "K7", "62 mm", -9.0, 21.0)],
)
def test_a_fit_of_an_interference_is_that_of_shaft_or_bore(
    tmp_path: Path, key: str, fit: str, size: str, low: float, high: float
) -> None:
    """ISO 286-2: 30 k6 is +2 to +15 um, 62 H7 is 0 to +30 um, 62 K7 is -21 to +9 um; a wider bore holds less."""
    place = f"bearing.input-left.stiffness.rolling.mounting.{key}_interference"
    rolling = (
        '{ catalogue = { type = "deep-groove", bore = "30 mm", outer_diameter = "62 mm", width = "16 mm" }, '
        'mounting = { inner_interference = "0 um" } }'
    )
    (one,) = _inputs(
        tmp_path,
        f'vary = {{ "{place}" = {{ fit = "{fit}", size = "{size}" }} }}',
        changes=[f"bearing.input-left.stiffness={{ rolling = {rolling} }}", "bearing.input-left.damping="],
    )
    ends = [1e3 * end for end in (one.law.low, one.law.high)]
    assert ends == pytest.approx([low, high], abs=0.6)


def test_fits_of_one_size_may_be_one_value(tmp_path: Path) -> None:
    """Both bearings have the same interference, as of one shaft; without a size each entry has its own length."""
    rolling = (
        '{ rolling = { catalogue = { type = "deep-groove", bore = "30 mm", outer_diameter = "62 mm", width = "16 mm" } '
        ', mounting = { inner_interference = "0 um" } } }'
    )
    changes = [
        change
        for name in ("input-left", "output-left")
        for change in (f"bearing.{name}.stiffness={rolling}", f"bearing.{name}.damping=")
    ]
    key = "bearing.*.stiffness.rolling.mounting.inner_interference"
    (one,) = _inputs(tmp_path, f'vary = {{ "{key}" = {{ fit = "k6", size = "30 mm" }} }}', changes=changes)
    assert len(one.keys) == 2


def test_entries_of_an_independent_key_are_correlated_by_their_names(tmp_path: Path) -> None:
    keys = [f"gear.{name}.{HELIX}" for name in ("pinion", "wheel")]
    varied = {f"gear.*.{HELIX}": Varied.model_validate({"class": 5, "independent": True})}
    pair = {"keys": keys, "coefficient": 0.5}
    variation = Variation.model_validate({"vary": varied, "correlation": [pair]})
    inputs = varied_inputs(load_case("helical-pair").source, variation)
    matrix = correlation_matrix(inputs, variation)
    assert matrix is not None
    assert matrix.tolist() == [[1.0, 0.5], [0.5, 1.0]]
    of_all = Variation.model_validate({"vary": varied, "correlation": [{**pair, "keys": [f"gear.*.{HELIX}", keys[0]]}]})
    with pytest.raises(
        CaseError, match=r"correlation\[0\].keys\[0\]: expected a key .* with one value, or an entry of"
    ):
        correlation_matrix(inputs, of_all)


def test_a_fit_lies_about_the_length_of_the_case(tmp_path: Path) -> None:
    """40 mm H7 is 0 to 25 µm; six standard deviations fill it."""
    (one,) = _inputs(tmp_path, 'vary = { "gear.pinion.bore" = { fit = "H7" } }')
    assert one.value(0.5) == pytest.approx(40.0125, rel=1e-12)
    cut = stats.truncnorm(-3.0, 3.0)
    assert one.value(cut.cdf(1.0)) == pytest.approx(40.0125 + 0.025 / 6.0, abs=1e-9)
    assert 40.0 <= one.value(1e-9) < one.value(1.0 - 1e-9) <= 40.025


def test_runout_is_rayleigh_all_but_27_of_10000_within_its_tolerance(tmp_path: Path) -> None:
    (one,) = _inputs(tmp_path, 'vary = { "gear.pinion.errors.runout" = { class = 7 } }')
    diameter = 23 * 3.0 / np.cos(np.radians(15.0))
    tolerance = 2.0 * 0.9 * (0.002 * diameter + 0.55 * np.sqrt(diameter) + 0.7 * 3.0 + 12.0)
    whole = stats.rayleigh(0.0, tolerance / stats.rayleigh().ppf(0.9973))
    assert one.value(0.5) == pytest.approx(whole.ppf(0.5 * 0.9973), rel=1e-9)


def test_pitch_deviations_are_those_of_all_teeth_and_stand_in_the_case(tmp_path: Path) -> None:
    (one,) = _inputs(tmp_path, 'vary = { "gear.pinion.errors.pitch" = { class = 6 } }')
    (first,), (second,) = list(one.overrides(0.3)), list(one.overrides(0.7))
    key, _, listed = first.partition("=")
    deviations = np.array([float(text) for text in listed.strip("[]").split(",")])
    assert key == "gear.pinion.errors.pitch"
    assert deviations.size == 23
    assert one.value(0.3) == np.ptp(deviations)
    assert first != second


def test_words_and_whole_numbers_are_written_as_they_stand(tmp_path: Path) -> None:
    text = 'vary = { "rotor.input.mass" = { values = ["lumped", "distributed"], weights = [1, 3] }, '
    mass, teeth = _inputs(tmp_path, text + '"gear.pinion.teeth" = { values = [22, 23] } }')
    assert [list(mass.overrides(at)) for at in (0.2, 0.3)] == [
        ["rotor.input.mass=lumped"],
        ["rotor.input.mass=distributed"],
    ]
    assert list(teeth.overrides(0.1)) == ["gear.pinion.teeth=22"]


def test_measured_values_come_from_a_column_with_its_unit(tmp_path: Path) -> None:
    (tmp_path / "measured.csv").write_text("bore [mm],part\n40.01,1\n40.03,2\n\n40.02,3\n")
    (one,) = _inputs(tmp_path, 'vary = { "gear.pinion.bore" = { file = "measured.csv", column = "bore" } }')
    assert (one.unit, one.value(0.5), one.value(0.75)) == ("mm", 40.02, pytest.approx(40.025))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('vary = { "gear.pinion.bore" = { normal = ["40 mm", "0 mm"] } }', "above 0"),
        ('vary = { "gear.pinion.bore" = { normal = ["40 mm", "1 N"] } }', "that measure the same as '40 mm'"),
        ('vary = { "gear.pinion.bore" = { uniform = ["41 mm", "40 mm"] } }', "above the low end 41"),
        ('vary = { "gear.pinion.bore" = { } }', "exactly one of 'normal'"),
        ('vary = { "gear.pinion.bore" = { uniform = [1, 2], normal = [1, 2] } }', "exactly one of 'normal'"),
        ('vary = { "gear.pinion.bore" = { uniform = [1, 2], weights = [1, 2] } }', "none without 'values'"),
        ('vary = { "gear.pinion.bore" = { uniform = ["a lot", "40 mm"] } }', "a quantity such as"),
        ('vary = { "gear.pinion.bore" = { fit = "z9" } }', "a letter of c, d, e, f, g"),
        ('vary = { "gear.pinion.bore" = { fit = "H7", size = "30 mm" } }', "no 'size' of gear[0].bore"),
        ('vary = { "gear.pinion.bore" = { values = ["30 mm"], size = "30 mm" } }', "none without 'fit'"),
        ('vary = { "gear.pinion.bore" = { class = 6 } }', "a key of the errors of a gear"),
        ('vary = { "gear.pinion.errors.phase" = { class = 6 } }', "one of the errors pitch"),
        ('vary = { "gear.pinion.errors.runout" = { class = 12 } }', "a whole number from 1 to 11"),
        ('vary = { "gears.pinion.bore" = { uniform = [1, 2] } }', "leads to something in the case"),
        ('vary = { "gear.pin*.bore" = { uniform = [1, 2] } }', "for a whole name, not for a part as in 'pin*'"),
        ('vary = { "gear.pinion.bore" = { uniform = [0.03, 0.04], factor = { pinon = 2 } } }', "did you mean 'pinion'"),
        ('vary = { "gear.*.bore" = { fit = "H7" } }', "independent = true"),
        ('vary = { "gear.*.root_relief.amount" = { uniform = ["1 um", "2 um"] } }', "'start_roll_angle' and 'length'"),
        ('vary = { "gear.pinion.bore" = { file = "none.csv" } }', "file"),
        (
            'vary = { "gear.pinion.bore" = { uniform = [0.03, 0.04] }, "gear.*.bore" = { uniform = [0.03, 0.04] } }',
            "each key once",
        ),
        ('vary = { "a b[" = { uniform = [1, 2] } }', "a key path"),
        ('vary = { "title" = { values = ["a", "b"] } }', "a key that a gearbox follows from"),
        ('vary = { "gear.pinion.bore" = { values = [0.03, 0.04], weights = [1] } }', "weights: expected one weight"),
        ('samples = 0\nvary = { "gear.pinion.bore" = { uniform = [0.03, 0.04] } }', "a whole number from 1"),
        ("limit = { x = { } }", "'at_most', 'at_least' or both"),
        ("limit = { x = { at_least = 2, at_most = 1 } }", "of at least 2"),
        (
            'correlation = [{ keys = ["gear.pinion.bore", "gear.wheel.bore"], coefficient = 0.5 }]',
            "a key of [variation.vary] with one value, or an entry of an independent one",
        ),
    ],
)
def test_what_cannot_be_varied_is_refused_by_name(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(CaseError) as refusal:
        _inputs(tmp_path, text)
    assert "variation" in str(refusal.value)
    assert said in str(refusal.value)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "a name in the first line of measured.csv, and two values or more below"),
        ("bore\n40\n", "two values"),
        ("40\n41\n42\n", "names of the columns in the first line of measured.csv, which has 40"),
        ("bore\n\n40\nnan\n", "a finite number in line 4 of measured.csv, column 'bore'"),
        ("bore\n40\n\xff\n", "a table of text in UTF-8; measured.csv is none"),
        ("bore [blorp]\n40\n41\n", "a known unit"),
        ("bore\n40\nwide\n", "line 3"),
        ("a,b\n1,2\n3,4\n", "one of the 2 columns"),
    ],
)
def test_tables_that_hold_no_distribution_are_refused(tmp_path: Path, content: str, said: str) -> None:
    (tmp_path / "measured.csv").write_text(content, encoding="latin-1")
    with pytest.raises(CaseError, match=said):
        _inputs(tmp_path, 'vary = { "gear.pinion.bore" = { file = "measured.csv" } }')


def test_names_of_quantities_are_refused_before_the_housing_is_solved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    meant = "did you mean 'top'?"
    wrong = {
        "sensor.tpo.level_db": meant,
        "mean of sensor.tpo.level_db": meant,
        "sensor.top.level": "level_db",
        "sensor.top.motion_level_db": "'motion' among the analyses",
        "bearing.input-bak.force_n": "did you mean 'input-back'?",
        "bearing.input-back.life_h": "a life is that of a rolling bearing",
        "gear_pair.pinion-whel.k_h_beta": "a gear pair of this case (pinion-wheel)",
        "gear_pair.*.contact_pressure_mpa": "did you mean 'contact_pressure_pa'?",
        "machine.mas_kg": "'mass_kg'",
        "boring.x": "a quantity of this case",
        "planetary.set.mesh_load_factor": "a planetary in the case, which has none",
        "quantile 2 of sensor.top.level_db": "'quantile 0.95 of', and the name of a quantity",
    }
    right = ["sensor.top.level_db", "quantile 0.95 of sensor.top.level_db", "sensor.*.level_db", "bearing.*.force_n"]
    case = load_case("small-gearbox").case
    wanted = wanted_of(case, Variation())
    problems = list(name_problems(case, wanted, ("variation", "limit"), [*right, *wrong]))
    assert [one.key for one in problems] == [f"variation.limit.'{name}'" for name in wrong]
    assert all(said in one.expected for one, said in zip(problems, wrong.values(), strict=True))
    few = replace(wanted, names=("gear_pair.*",))
    (left_out,) = name_problems(case, few, ("variation", "limit"), ["bearing.input-back.force_n"])
    assert "among the quantities" in left_out.expected

    for module in (variation_result, optimisation_result):
        monkeypatch.setattr(module, "in_solved_housing", lambda *_: pytest.fail("solved"))
    varied = {"operation.torque": {"uniform": ["40 N*m", "60 N*m"]}}
    designed = {"operation.torque": {"range": ["40 N*m", "60 N*m"]}}
    limits = {"sensor.tpo.level_db": {"at_most": 150}}
    aim = {"machine.mass_kg": {"sense": "least"}}
    changes = {
        "variation": {"vary": varied, "limit": limits},
        "optimisation": {"design": designed, "aim": aim, "limit": limits},
    }
    study = gw.load("small-gearbox", changes)
    with pytest.raises(CaseError, match=r"variation\.limit.*did you mean 'top'"):
        study.vary(2, folder=tmp_path)
    with pytest.raises(CaseError, match=r"optimisation\.limit.*did you mean 'top'"):
        study.optimise(2, folder=tmp_path)


def test_every_quantity_of_a_gearbox_may_be_named_in_a_limit() -> None:
    source = load_case("helical-pair").source
    wanted = Wanted(("gears", "load", "rotors", "mass"))
    found = VariedCase(source, (), wanted).evaluation(None).numbers
    named = dict(possible_quantities(parts_of(source.changed_case())))
    possible = {name for name, analysis in named.items() if analysis in wanted.analyses}
    lacking = {"rotor.output.critical_speed_3_rpm"}  # the shaft has two in the range that is searched
    assert set(found) == possible - lacking
    assert all(analysis_of(name) == analysis for name, analysis in named.items())


def test_check_refuses_studies_that_would_fail_later_and_names_their_keys() -> None:
    varied = {"operation.torque": {"uniform": ["100 N*m", "150 N*m"]}}
    limit = {"gear_pair.*.k_h_beta": {"at_most": 1.5}}
    study = gw.load("helical-pair", {"variation": {"samples": 8, "vary": varied, "limit": limit}})
    document = study.check().document
    assert document["variation"] == {"samples": 8, "limits": [*limit], "keys": [*varied]}
    shown = [text for section in summary(document) for text in (section.note, *section.content)]
    assert any("8 gearboxes" in str(text) for text in shown)
    for change, said in (
        ({"variation.vary": {}}, "a distribution of one key or more"),
        ({"variation.vary": {"operation.torqe": varied["operation.torque"]}}, "did you mean 'torque'"),
        ({"variation.vary": {"gear.pinion.teeth": {"uniform": [22, 24]}}}, "a whole number"),
        ({"variation.vary": {"rotor.input.mass": {"values": ["lumped", "distibuted"]}}}, "one of"),
        ({"variation.limit": {"bearing.left.force_n": {"at_most": 1.0}}}, "a bearing of this case"),
        ({"optimisation": {"design": {"operation.torque": {"values": [1, 2]}}}}, "the name of one quantity or more"),
    ):
        with pytest.raises(CaseError, match=said):
            gw.load("helical-pair", {"variation": {"vary": varied, "limit": limit}} | change).check()


def test_the_analysis_of_a_name_with_stars_is_that_of_all_quantities_that_it_may_mean() -> None:
    for name, analysis in {
        "bearing.*": "load",
        "bearing.*.life_h": "load",
        "*.transmission_error_*": "gears",
        "sensor.*.level_db": "lines",
        "sensor.*": None,  # lines and the motion have levels
        "rotor.input.*": None,  # mass and critical speeds
        "deflection_m": None,  # a number of somebody's own
        "housing.level_db": None,
    }.items():
        assert analysis_of(name) == analysis, name


def test_six_values_are_named_and_more_of_them_are_said_to_be_more() -> None:
    six = [str(number) for number in (3, 5, 7, 11, 13, 17)]
    assert Varied.model_validate({"values": [*map(int, six)]}).words == ", ".join(six)
    assert Varied.model_validate({"values": [*map(int, six), 19]}).words == ", ".join([*six, "…"])
