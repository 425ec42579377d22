"""Changes from the command line: which value, where, and what is said when they lead nowhere."""

from __future__ import annotations

from pathlib import Path

import pytest

from gearwhine.case import Case, CaseError, dump_case, load_case, swept_keys
from gearwhine.case.load import bundled_case
from gearwhine.sweep import sweep_points


def changed(*overrides: str) -> Case:
    return load_case("small-gearbox", overrides).case


@pytest.mark.parametrize(
    ("key", "thinned"),
    [("gear.1", "1"), ("gear.0", "0"), ("gear[1]", "0"), ("gear[0]", "1"), ("gear.*", "10"), ('gear."1"', "1")],
)
def test_a_number_is_a_name_first_and_in_brackets_a_place(key: str, thinned: str, tmp_path: Path) -> None:
    """The first gear is called 1, the second 0; whoever names them by counting from 1 has the same trap."""
    bundled = bundled_case("spur-pair")
    assert bundled is not None
    path = tmp_path / "pair.toml"
    path.write_text(bundled.read_text().replace('"pinion"', '"1"').replace('"wheel"', '"0"'))
    gears = load_case(path, [f"{key}.tooth_thinning=15 um"]).case.gear
    assert "".join(gear.name for gear in gears if gear.tooth_thinning == 15e-6) == thinned


def test_values_are_toml_or_bare_words_and_quantities() -> None:
    case = changed(
        "housing.box.wall=12 mm",
        "rotor.input.mass=lumped",
        'rotor[1].mass="lumped"',
        "gear_pair.0.damping_ratio=0.07",
        "bearing.0.damping.xx=600 N*s/m",
        "rotor.output.segments.0.diameter='31 mm'",
        'housing.support.0.stiffness={ x = "1e8 N/m" }',
        'housing.sensor."right wall".direction=[-2, 3, 6]',
        "title=Two words",
        "bearing.input-front.stiffness.xy=-10",
    )
    assert case.housing is not None
    assert case.housing.box is not None
    assert case.housing.box.wall == 0.012
    assert [rotor.mass for rotor in case.rotor] == ["lumped", "lumped"]
    assert case.gear_pair[0].damping_ratio == 0.07
    assert case.bearing[0].damping.xx == 600.0  # type: ignore[union-attr]
    assert case.rotor[1].segments[0].diameter == 0.031
    assert case.housing.support[0].stiffness is not None
    assert case.housing.support[0].stiffness.x == 1e8
    assert case.housing.sensor[1].unit_vector == (-2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0)
    assert case.title == "Two words"
    assert case.bearing[1].stiffness.xy == -10.0  # type: ignore[union-attr]


def test_keys_that_are_not_there_yet_are_added_and_an_empty_value_takes_away() -> None:
    case = changed(
        "sweep.speed=[1, 2]", "housing.frequency_limit=", "housing.modes=7", "gear.0.errors.eccentricity=1 um"
    )
    assert case.sweep is not None
    assert case.sweep.speeds == (1.0, 2.0)
    assert case.housing is not None
    assert (case.housing.modes, case.housing.frequency_limit) == (7, None)
    assert case.gear[0].errors.eccentricity == 1e-6


def test_later_overrides_go_before_earlier_ones() -> None:
    assert (
        changed("gear_pair.0.damping_ratio=0.07", "gear_pair.0.damping_ratio=0.08").gear_pair[0].damping_ratio == 0.08
    )


def test_one_thickness_of_all_walls_is_written_out_where_one_wall_is_set() -> None:
    before = changed("housing.box.wall=12 mm").housing
    assert before is not None
    assert before.box is not None
    assert before.box.wall == 0.012
    box = changed("housing.box.wall=12 mm", "housing.box.wall.back=9 mm", "housing.box.wall.top=15 mm").housing.box  # type: ignore[union-attr]
    assert box is not None
    assert box.wall.model_dump() == {  # type: ignore[union-attr]
        "left": 0.012,
        "right": 0.012,
        "bottom": 0.012,
        "top": 0.015,
        "back": 0.009,
        "front": 0.012,
    }
    every = changed("housing.box.wall.*=7 mm").housing.box  # type: ignore[union-attr]
    assert every is not None
    assert set(every.wall.model_dump().values()) == {0.007}  # type: ignore[union-attr]
    any_table = changed("housing.*.wall.back=8 mm").housing.box  # type: ignore[union-attr]
    assert any_table is not None
    assert (any_table.walls.back, any_table.walls.front) == (0.008, 0.01)
    with pytest.raises(CaseError, match=r"housing\.box\.wall\.bakc: expected no such key; did you mean 'back'"):
        changed("housing.box.wall.bakc=3 mm")
    with pytest.raises(CaseError, match=r"housing\.box\.wall\.back: "):
        changed("housing.box.wall.back=")


def test_a_sweep_goes_through_one_wall_of_all() -> None:
    source = load_case("small-gearbox").case
    keys = swept_keys(source, ["housing.box.wall.back=8 mm:12 mm:3"])
    thick = [point.case.housing.box.walls for point in sweep_points(load_case("small-gearbox").source, keys)]  # type: ignore[union-attr]
    assert [walls.back for walls in thick] == [0.008, 0.01, 0.012]
    assert {walls.front for walls in thick} == {0.01}


def test_a_key_that_no_entry_of_a_list_has_is_set_in_all() -> None:
    bare = ("gear.0.tip_relief=", "gear.1.tip_relief=")
    relief = "{ amount = '12 um', length = '1 mm' }"
    assert [gear.tip_relief.amount for gear in changed(*bare, f"gear.*.tip_relief={relief}").gear] == [12e-6, 12e-6]  # type: ignore[union-attr]
    assert [gear.errors.helix.crowning for gear in changed("gear.*.errors.helix.crowning=5 um").gear] == [5e-6, 5e-6]  # type: ignore[union-attr]
    # Those that one has are changed where they stand.
    assert changed(bare[0], f"gear.*.tip_relief={relief}").gear[0].tip_relief is None
    with pytest.raises(CaseError, match=r"gear\[1\]\.tip_releif .*no such key; did you mean 'tip_relief'"):
        changed("gear.*.tip_releif=5 um")
    with pytest.raises(CaseError, match=r"rotor\.\*\.x\.y: expected a path with \*|no such key"):
        changed("rotor.*.x.y=5 um")


LEADS_NOWHERE = {
    "no equals sign": ("housing.box.wall", "expected key.path=value"),
    "no key": ("=3", "expected key.path=value"),
    "not a path": ("housing..box=3", "expected key.path=value"),
    "no such entry": ("rotor.inptu.mass=lumped", "one of 'input', 'output'; did you mean 'input'?, got 'inptu'"),
    "beyond the list": ("bearing.7.at=3", "expected a place from 0 to 3"),
    "beyond the only entry": ("rotor.input.unbalance.moment=3", "expected 0, the only place, got 'moment'"),
    "into a value": ("housing.box.mesh_size.x=3", "housing.box.mesh_size is a value, not a table"),
    "nothing to take away": ("housing.frequency=", "a key to take away; did you mean 'frequency_limit'?"),
    "unknown key": ("housing.box.walls=3 mm", "housing.box.walls: expected no such key; did you mean 'wall'?"),
    "unknown table": ("hosing.box.wall=3 mm", "hosing: expected no such key; did you mean 'housing'?"),
    "wrong value": ("gear.0.teeth=3", 'gear[0].teeth (gear "pinion"): expected a whole number from 5'),
    "wrong unit": ("housing.box.wall=3 kg", "got '3 kg' (mass)"),
    "unfinished list": ("housing.box.size=[1", "housing.box.size: expected a list, got '[1'"),
    "two lines": ("gear.0.teeth=28\nrotor=3", "expected a whole number from 5 to 2000"),
}


@pytest.mark.parametrize("kind", LEADS_NOWHERE)
def test_an_override_that_is_wrong_is_named(kind: str) -> None:
    override, expected = LEADS_NOWHERE[kind]
    with pytest.raises(CaseError) as caught:
        changed(override)
    assert expected in str(caught.value)
    assert override.split("\n")[0] in str(caught.value)
    assert "--set" in str(caught.value)


def test_all_wrong_overrides_come_at_once() -> None:
    with pytest.raises(CaseError) as caught:
        changed("rotor.x.mass=lumped", "bearing.9.at=3", "gear")
    assert len(caught.value.problems) == 3


def test_the_bundled_case_itself_is_not_changed() -> None:
    before = load_case("small-gearbox").case
    changed("title=other")
    assert load_case("small-gearbox").case == before


STANDING = load_case("small-gearbox").case.provenance


def test_a_changed_value_loses_its_provenance_and_the_others_keep_theirs() -> None:
    assert {"housing.*", "gear.*.bore", "gear.*.teeth"} <= set(STANDING)
    for override in ("gear.pinion.bore=21 mm", "gear.0.bore=21 mm", "gear.0.bore="):
        assert set(STANDING) - set(changed(override).provenance) == {"gear.*.bore"}
    assert "housing.*" not in changed("housing.box.wall=12 mm").provenance  # an entry above the change
    assert changed("title=other").provenance == STANDING


def test_a_key_taken_away_takes_its_provenance_along() -> None:
    assert set(STANDING) - set(changed("measured=").provenance) == {"measured"}
    lost = set(STANDING) - set(changed("gear.0.tip_relief=", "gear.1.tip_relief=").provenance)
    assert lost == {"gear.*.tip_relief"}  # an entry that would lead nowhere


def test_provenance_from_the_command_line_stays() -> None:
    case = changed("gear.0.bore=21 mm", "provenance.'gear.*.bore'=found")
    assert case.provenance["gear.*.bore"] == "found"
    assert changed("measured=", "provenance={ title = 'nominal' }").provenance == {"title": "nominal"}


def test_provenance_that_led_nowhere_before_is_still_an_error(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(dump_case(load_case("small-gearbox").case).replace('measured = "', 'measurd = "'), "utf-8")
    with pytest.raises(CaseError, match=r"provenance\.measurd: expected as a key the path"):
        load_case(path, ["title=other"])


def test_a_gear_pair_goes_by_its_gears() -> None:
    """Quantities of `vary` and limits name it so, too."""
    assert changed("gear_pair.pinion-wheel.damping_ratio=0.08").gear_pair[0].damping_ratio == 0.08
    with pytest.raises(CaseError, match="one of 'pinion-wheel'; did you mean 'pinion-wheel'"):
        changed("gear_pair.pinion-weel.damping_ratio=0.08")
