"""Damping that the case leaves out: its default, what is said of it, and the band of each line that goes with it."""

import json
import tomllib
from typing import Any

import numpy as np
import pytest
from coupled_cases import about_operating_point

import gearwhine as gw
from gearwhine.case import CaseError, dump_case, parse_case
from gearwhine.results.check import sections
from gearwhine.results.motion import amplitude_words, band_words, level_words
from gearwhine.rotors.rolling_bearings import ROLLING_DAMPING_TIME, catalogue_bearing
from gearwhine.solve.damping import damping_warnings, part_dampings

BALLS = {"catalogue": {"type": "deep-groove", "bore": "30 mm", "outer_diameter": "72 mm", "width": "19 mm"}}

BEARING = catalogue_bearing("deep-groove", 30e-3, 72e-3, 19e-3)


def document(**bearing: Any) -> dict[str, Any]:
    """Two shafts with a spur pair between two deep-groove ball bearings each."""
    return {
        "material": {"steel": {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}},
        "rotor": [
            {"name": name, "axis": [x, "0 m"], "start": "0 m", "material": "steel"}
            | {"segments": [{"length": "180 mm", "diameter": "30 mm"}]}
            for name, x in (("in", "0 m"), ("out", "75 mm"))
        ],
        "bearing": [
            {"name": f"{rotor} {end}", "rotor": rotor, "at": at, "stiffness": {"rolling": BALLS}} | bearing
            for rotor in ("in", "out")
            for end, at in (("left", "20 mm"), ("right", "160 mm"))
        ],
        "gear": [
            {"name": name, "rotor": name, "at": "90 mm", "teeth": teeth, "module": "2 mm", "face_width": "15 mm"}
            for name, teeth in (("in", 25), ("out", 50))
        ],
        "gear_pair": [{"driver": "in", "driven": "out"}],
        "operation": {"speed": "1500 rpm", "torque": "60 N*m"},
    }


@pytest.mark.parametrize(
    ("given", "time"),
    [({}, ROLLING_DAMPING_TIME), ({"damping": {"over_stiffness": "20 us"}}, 2e-5), ({"damping": {"xx": 0.0}}, 0.0)],
)
def test_a_rolling_bearing_is_damped_by_its_stiffness(given: dict[str, Any], time: float) -> None:
    """C = τ K of the tangent under load, in all directions; from Python as from a case."""
    case = parse_case(document(**given))
    machine = about_operating_point(case).coupled
    for mounted in machine.bearings:
        stiffness, damping = mounted.bearing.spatial_stiffness, mounted.bearing.spatial_damping
        assert stiffness[0, 0] > 1e7
        np.testing.assert_allclose(damping, time * stiffness, rtol=1e-12, atol=1e-12)
        assert np.linalg.eigvalsh(damping).min() >= -1e-9 * np.abs(damping).max()
    assert parse_case(json.loads(json.dumps(document(**given)))) == case
    assert gw.MountedBearing.from_elements("b", 0.0, "in", None, BEARING).damping_time == ROLLING_DAMPING_TIME
    assert gw.MountedBearing.from_elements("b", 0.0, "in", None, BEARING, damping=5.0).damping_time == 0.0
    # Krämer's range (1993): 0.25e-5 to 2.5e-5 s.
    assert pytest.approx(np.sqrt(0.25e-5 * 2.5e-5), rel=0.02) == ROLLING_DAMPING_TIME


@pytest.mark.parametrize(("word", "decrement"), [("welded", 0.02), ("bolted", 0.03), ("cast", None)])
def test_a_word_is_damping_with_a_source(word: str, decrement: float | None) -> None:
    """An oscillator of this damping decays by the standard's logarithmic decrement in a period."""
    coarse = {"housing.box.mesh_size": "60 mm", "housing.damping_ratio": word}
    study = gw.load("steel-box", coarse)
    housing = study.housing
    assert housing is not None
    ratios = housing.damping_ratios
    assert np.ptp(ratios) == 0.0
    if decrement is None:
        assert 0.02 <= ratios[0] <= 0.04  # as printed for metal structures of one piece
    else:
        period = 2.0 * np.pi / np.sqrt(1.0 - ratios[0] ** 2)  # over the undamped angular frequency
        assert ratios[0] * period == pytest.approx(decrement, rel=1e-12)
    (told,) = [one for one in study.check().document["damping"] if one["part"] == "housing"]
    assert told["given"]
    assert told["damping"].startswith(f"{100.0 * ratios[0]:.3g} % of critical in every mode ({word}: ")
    assert ("EN 1991-1-4" if decrement else "Adams and Askenazi") in told["damping"]
    again = parse_case(tomllib.loads(dump_case(study.case)))
    assert again.housing is not None
    assert again.housing.damping_ratio == word


def test_another_word_is_refused_with_those_that_are_known() -> None:
    with pytest.raises(CaseError, match=r"housing\.damping_ratio.*'welded', 'bolted' or 'cast'"):
        gw.load("steel-box", {"housing.damping_ratio": "riveted"})


def test_damping_that_nobody_gave_is_told() -> None:
    """By `check`, and as a warning of every motion; none is left where the case gives all."""
    study = gw.build(**document())
    checked = study.check().document
    lines = [text for section in sections(checked) for text in (section.note or "", *section.sentences)]
    assert any("rotor in, rotor out: 0.5 % of critical (default)" in line for line in lines)
    assert any(line.endswith("8 µs times its stiffness (default)") for line in lines)
    solved = study.system().document
    assert solved["damping"] == checked["damping"]
    (entry,) = [one for one in solved["warnings"] if one["name"] == "damping"]
    assert entry["message"].startswith(
        "damping that nobody gave: rotor in, rotor out: 0.5 % of critical; bearing in left"
    )
    assert "gear_pair[0].damping_ratio" in entry["keys"]
    given = document(damping={"xx": "500 N*s/m", "yy": "500 N*s/m"})
    given["gear_pair"][0]["damping_ratio"] = 0.05
    for rotor in given["rotor"]:
        rotor["damping_ratio"] = 0.005
    case = parse_case(given)
    assert damping_warnings(part_dampings(case)) == []
    assert all(part.is_given for part in part_dampings(case))


def test_digits_follow_the_band() -> None:
    line = {"amplitude_m_per_s2": 199.4, "level_db": 163.04}
    assert (amplitude_words(line), level_words(line), band_words(line)) == ("199", "163.0", "")
    line["band_db"] = [-0.6, 0.9]
    assert (amplitude_words(line), level_words(line), band_words(line)) == ("200", "163", "-0.6 +0.9")
    assert amplitude_words(line | {"amplitude_m_per_s2": 0.01964, "band_db": [-5.9, 5.8]}) == "0.02"
    assert amplitude_words(line | {"amplitude_m_per_s2": 34.96, "band_db": [-5.9, 5.8]}) == "35"


@pytest.mark.slow
def test_a_band_is_the_line_of_cases_with_half_and_twice_the_damping() -> None:
    """On a housing, of misaligned teeth, where load shuttling excites beside the transmission error."""
    changes = {"housing.box.mesh_size": "50 mm", "gear_pair.0.misalignment": "0.3 mrad", "operation.speed": "900 rpm"}

    def lines(scale: float) -> list[dict[str, Any]]:
        dampings: dict[str, Any] = {"housing.damping_ratio": 0.01, "rotor.*.damping_ratio": 0.005}
        dampings |= {"gear_pair.*.damping_ratio": 0.05}
        dampings = {key: scale * value for key, value in dampings.items()}
        dampings |= {f"bearing.*.damping.{key}": 500.0 * scale for key in ("xx", "yy")}
        found: list[dict[str, Any]] = gw.load("small-gearbox", changes | dampings).system().document["mesh_lines"]
        return found

    found = list(map(lines, (1.0, 0.5, 2.0)))
    assert len(found[0]) >= 3
    for line, *others in zip(*found, strict=True):
        for sensor, level in line["sensor_acceleration_m_per_s2"]["together"].items():
            moved = [one["sensor_acceleration_m_per_s2"]["together"][sensor] for one in others]
            parts = 20.0 * np.log10(np.array(moved) / level)
            assert line["band_db"][sensor] == pytest.approx([min(*parts, 0.0), max(*parts, 0.0)], abs=2e-3)
