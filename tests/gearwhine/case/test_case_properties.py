"""Any dictionary is a case or a case error; any case written as TOML loads back equal; bundled cases are sound."""

from __future__ import annotations

import copy
import math
import tomllib
from importlib.resources import files
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.case import Bearing, Case, CaseError, MatrixDamping, bundled_cases, dump_case, load_case, parse_case

EXAMPLES = (
    "friswell-rotor",
    "gear-62-62",
    "helical-pair",
    "overhung-fan",
    "small-gearbox",
    "spur-pair",
    "steel-box",
    "two-stage-reducer",
)


def document_of(name: str) -> dict[str, Any]:
    return tomllib.loads(files("gearwhine.cases").joinpath(f"{name}.toml").read_text(encoding="utf-8"))


def keys_of(value: Any) -> set[str]:
    """Return every key at any depth."""
    if isinstance(value, dict):
        return set(value).union(*map(keys_of, value.values()))
    return set().union(*map(keys_of, value)) if isinstance(value, list) else set()


KEYS = sorted(set().union(*(keys_of(document_of(name)) for name in EXAMPLES)))
SCALARS = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=8)
    | st.sampled_from(["3 mm", "3 kg", "20 deg", "3 rpm", "3 kHz", "3 N/m", "steel", "ground", "x", "foot-1", "input"])
    | st.dates()
)
TABLES = st.recursive(
    SCALARS,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(KEYS) | st.text(max_size=4), inner, max_size=4)
    ),
    max_leaves=12,
)


@pytest.mark.slow
@given(st.dictionaries(st.sampled_from(KEYS), TABLES, max_size=5))
@settings(max_examples=75, deadline=None)
def test_any_dictionary_is_a_case_or_a_case_error(document: dict[str, Any]) -> None:
    check_survives(document)


@given(st.data())
@settings(max_examples=100, deadline=None)
def test_a_sound_case_with_anything_anywhere_is_a_case_or_a_case_error(data: st.DataObject) -> None:
    document = copy.deepcopy(document_of("small-gearbox"))
    for _ in range(data.draw(st.integers(1, 3))):
        here: Any = document
        while True:
            steps = sorted(here) if isinstance(here, dict) else list(range(len(here)))
            if not steps:
                break
            step = data.draw(st.sampled_from(steps))
            if isinstance(here[step], (dict, list)) and data.draw(st.booleans()):
                here = here[step]
                continue
            if data.draw(st.booleans()):
                here[step] = data.draw(TABLES)
            else:
                del here[step]
            break
    check_survives(document)


def check_survives(document: dict[str, Any]) -> None:
    """Assert that a document makes a case, or an error whose every line names a place and an expectation."""
    try:
        case = parse_case(document, source="any.toml")
    except CaseError as error:
        lines = str(error).split("\n")
    else:
        assert isinstance(case, Case)
        lines = []
    assert all(line.startswith("any.toml: ") and ": expected " in line for line in lines)
    assert len(lines) == len(set(lines))


LENGTHS = st.floats(1e-4, 1.0)
SEGMENTS = st.lists(
    st.builds(
        # Shafts, not wires.
        lambda length, d, part: {"length": min(length, 900.0 * d), "diameter": d, "bore": d * part},
        LENGTHS,
        LENGTHS,
        st.floats(0, 0.9),
    ),
    min_size=1,
    max_size=4,
)


@given(
    segments=SEGMENTS,
    speed=st.floats(-1e4, 1e4),
    angle=st.floats(-10.0, 10.0),
    stiffness=st.floats(1e3, 1e12),
    ratio=st.floats(0.0, 0.99),
    title=st.text(st.characters(exclude_categories=["Cs"]), max_size=20),
    name=st.from_regex(r"[A-Za-z0-9äß][A-Za-z0-9 .\"'=-]{0,10}[a-z]", fullmatch=True),
)
@settings(deadline=None)
def test_a_case_of_any_numbers_loads_back_equal(
    segments: list[dict[str, float]],
    speed: float,
    angle: float,
    stiffness: float,
    ratio: float,
    title: str,
    name: str,
) -> None:
    case = parse_case(
        {
            "title": title,
            "material": {"steel": {"youngs_modulus": stiffness, "poisson_ratio": ratio / 2, "density": 7850}},
            "rotor": [
                {
                    "name": name,
                    "material": "steel",
                    "segments": segments,
                    "damping_ratio": ratio,
                    "unbalance": [{"at": 0.0, "moment": ratio, "phase": angle}],
                }
            ],
            "bearing": [
                {
                    "name": name,
                    "rotor": name,
                    "at": segments[0]["length"],
                    "stiffness": {"xx": stiffness, "yy": stiffness, "xy": -stiffness * ratio},
                },
            ],
            "operation": {"speed": speed},
            "provenance": {f"rotor.{name!r}".replace("\\", "") if '"' not in name else "rotor.*": "nominal"}
            if "'" not in name
            else {},
        }
    )
    assert parse_case(tomllib.loads(dump_case(case))) == case


def test_forms_for_later_versions_are_read_and_written_already() -> None:
    """The checks refuse them in a whole case; the models know them."""
    rows = [[1e5 * (row == column) for column in range(5)] for row in range(5)]
    given = {"name": "b", "rotor": "r", "at": "3 mm", "stiffness": {"matrix": rows}, "damping": {"matrix": rows}}
    bearing = Bearing.model_validate(given)
    assert isinstance(bearing.damping, MatrixDamping)
    assert bearing.damping.matrix[3] == (0.0, 0.0, 0.0, 1e5, 0.0)
    assert Bearing.model_validate(bearing.model_dump(mode="json", exclude_none=True)) == bearing


@pytest.mark.parametrize("name", EXAMPLES)
def test_bundled_cases_load_without_warnings_and_load_back_equal(name: str) -> None:
    loaded = load_case(name)
    assert loaded.warnings == ()
    assert bundled_cases()[name] == loaded.case.title != ""
    text = dump_case(loaded.case)
    assert parse_case(tomllib.loads(text)) == loaded.case
    assert dump_case(parse_case(tomllib.loads(text))) == text


def test_dumped_quantities_carry_their_units_and_defaults_are_written_out() -> None:
    document = tomllib.loads(dump_case(load_case("spur-pair").case))
    assert document["rotor"][0]["segments"][0]["length"] == "0.1 m"
    assert document["operation"]["speed"] == "5500 rpm"
    assert document["gear"][0]["pressure_angle"] == "20 deg"
    assert document["rotor"][0]["mass"] == "distributed"
    assert document["bearing"][0]["seat"] == "ground"
    assert document["rotor"][0]["damping_ratio"] == 0.005


def test_values_are_in_si_inside() -> None:
    """The case file's own example of the interface: each number against its unit's definition."""
    case = load_case("small-gearbox").case
    assert case.material["steel"].youngs_modulus == 207e9
    assert case.housing is not None
    assert case.housing.box is not None
    assert (case.housing.frequency_limit, case.housing.box.walls.top) == (3000.0, 0.01)
    assert (case.housing.box.lower, case.housing.box.upper) == ((-0.11, 0.0, -0.08), (0.11, 0.16, 0.08))
    assert case.operation is not None
    assert case.operation.speed == pytest.approx(5500 * 2 * math.pi / 60, rel=1e-15)
    assert case.parts.gears["pinion"].base_radius == pytest.approx(0.04445 * math.cos(math.radians(20)))
    assert {seat.name: seat.center for seat in case.housing.seat}["input-back"] == (-0.04445, 0.08, -0.08)
    assert case.parts.material_of(case.gear[0]) is case.material["steel"]
    assert case.rotor_named("output").length == 0.2
    with pytest.raises(KeyError):
        case.rotor_named("none")


def test_a_damping_table_is_sorted_by_frequency() -> None:
    document = document_of("steel-box")
    document["housing"]["damping_ratio"] = {"3 kHz": 0.02, "658 Hz": 0.01}
    housing = parse_case(document).housing
    assert housing is not None
    assert housing.damping_points == ((658.0, 0.01), (3000.0, 0.02))


def test_what_is_likely_not_meant_is_a_warning() -> None:
    document = document_of("small-gearbox")
    del document["housing"]["sensor"]
    from gearwhine.case.checks.whole_case import warnings_of

    assert any("no [[housing.sensor]]" in warning for warning in warnings_of(parse_case(document)))
