"""A moving base and gravity, from the case to the coupled system."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled

import gearwhine as gw
from gearwhine.case import CaseError, dump_case, parse_case
from gearwhine.coupling.analyses.transient import solve_transient
from gearwhine.output.terminal import shown_by
from gearwhine.results import check
from gearwhine.results.check import check_document
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import plan_of

BASE = {
    "point": ["10 mm", "0 mm", "0 mm"],
    "harmonic": [{"frequency": "30 Hz", "y": "2 m/s^2", "rz": "1 rad/s^2", "phase": "20 deg"}],
    "over_time": {"time": [0, "5 ms"], "x": [0, "1 m/s^2"]},
}


def document_of(name: str, **operation: Any) -> dict[str, Any]:
    document = tomllib.loads(files("gearwhine.cases").joinpath(f"{name}.toml").read_text(encoding="utf-8"))
    del document["provenance"]
    return document | {"operation": document["operation"] | operation}


def test_written_cases_load_back_equal(capsys: pytest.CaptureFixture[str]) -> None:
    case = parse_case(document_of("spur-pair", base=BASE, gravity=["0 m/s^2", "-9.81 m/s^2", 0]))
    assert parse_case(tomllib.loads(dump_case(case))) == case
    shown_by(check.sections)(check_document(case))
    out = capsys.readouterr().out
    assert "gravity: 0, -9.81, 0 m/s²" in out
    assert "base moves: 30 Hz, a table over time" in out


@pytest.mark.parametrize(
    ("base", "message"),
    [
        ({"harmonic": [{"x": 1}]}, "operation.base.harmonic[0].frequency: expected a frequency above 0 Hz"),
        ({"over_time": {"time": [0, 1], "x": [1]}}, "operation.base.over_time.x: expected one value for each of the 2"),
        ({"over_time": {"time": [1, 0]}}, "operation.base.over_time.time: expected times that ascend"),
        (
            {"harmonic": [{"frequency": 1, "rx": "1 m/s^2"}]},
            "operation.base.harmonic[0].rx: expected an angular acceleration",
        ),
    ],
)
def test_bases_that_make_no_sense(base: dict[str, Any], message: str) -> None:
    with pytest.raises(CaseError) as caught:
        parse_case(document_of("spur-pair", base=base))
    assert message in str(caught.value)


def test_no_run_on_a_base_that_tilts() -> None:
    document = document_of("spur-pair", base={"harmonic": [{"frequency": "1 Hz", "rx": 1}]})
    document["transient"] = {"run": {"from": "600 rpm", "to": "900 rpm", "time": 1}}
    with pytest.raises(CaseError, match=r"operation\.base: expected no turning about x or y during a"):
        parse_case(document)


def test_a_free_housing_takes_part_as_a_rigid_body() -> None:
    """Of a free housing the rigid modes carry its mass, and its first moments about the origin."""
    document = document_of("small-gearbox")
    document["housing"] |= {"support": [], "modes": 8, "damping_ratio": 0.01}
    document["housing"].pop("frequency_limit")
    document["housing"]["box"]["mesh_size"] = "60 mm"
    case = parse_case(document)
    solved = solve_housing(case)
    held = solved.participation
    product = held.T @ held
    np.testing.assert_allclose(product[:3, :3], solved.mass * np.eye(3), atol=1e-6 * solved.mass)
    x, y, z = np.array(solved.health.body.center)
    moments = solved.mass * np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
    np.testing.assert_allclose(product[:3, 3:], moments, atol=1e-6 * solved.mass)


def test_sensors_show_the_motion_in_space() -> None:
    """On a base that is accelerated evenly, and long after the start, everything moves with the base."""
    base = {"over_time": {"time": [0, "1 ms"], "y": [0, "300 m/s^2"]}}
    document = document_of("small-gearbox", base=base, torque="5 N*m", gravity=[0, -9.81, 0])
    document["housing"] |= {"modes": 8, "damping_ratio": 0.5}
    document["housing"].pop("frequency_limit")
    document["housing"]["box"]["mesh_size"] = "60 mm"
    document["gear_pair"][0]["stiffness"] = {"model": "constant", "value": "2e8 N/m"}
    document["transient"] = {"revolutions": 3, "discard": 2}
    case = parse_case(document)
    housing = solve_housing(case)
    machine = coupled(case, housing)
    solved = solve_transient(machine, plan_of(case))
    assert np.mean(solved.histories.sensor_acceleration["top"]) == pytest.approx(300.0, rel=0.02)
    # Sideways, along the right wall's normal, it does not.
    assert abs(np.mean(solved.histories.sensor_acceleration["right wall"])) < 6.0


@pytest.mark.parametrize("hertz", [5500.0 / 240.0, pytest.param(23.7, marks=pytest.mark.slow)])
def test_sensors_of_a_steady_motion_show_it_in_space(hertz: float) -> None:
    """Far below all modes everything moves with the base, in one motion of four turns and in superposed ones."""
    base = {"harmonic": [{"frequency": f"{hertz!r} Hz", "y": "5 m/s^2", "phase": "20 deg"}]}
    document = document_of("small-gearbox", base=base)
    document["housing"]["box"]["mesh_size"] = "60 mm"
    document["gear_pair"][0]["stiffness"] = {"model": "constant", "value": "2e8 N/m"}
    result = gw.build(**document).steady()
    assert (result.solved.superposed is None) == (hertz < 23.0)
    motion, told = result.solved.motions[-1], result.document["motions"][-1]
    (line,) = [one for one in motion.lines(motion.histories.sensor_acceleration["top"]) if abs(one[0] - hertz) < 0.1]
    assert line[1] == pytest.approx(5.0, rel=0.01)
    times = motion.histories.times
    expected = 5.0 * np.cos(2.0 * np.pi * hertz * times + np.radians(20.0))
    turned = np.exp(-2j * np.pi * hertz * times)
    assert np.angle(motion.histories.sensor_acceleration["top"] @ turned) == pytest.approx(
        np.angle(expected @ turned), abs=0.01
    )
    (sensor,) = [row for row in told["sensors"] if row["name"] == "top"]
    assert sensor["rms_m_per_s2"] > 0.99 * 5.0 / np.sqrt(2.0)
    # Sideways, along the right wall's normal, the base does not move it.
    side = motion.histories.sensor_acceleration["right wall"]
    assert abs(2.0 * np.mean(side * turned)) < 0.1
    # The other motions, of excitations that are not the base's, have none of it.
    for other in result.solved.motions[:-1]:
        assert other.sensor_rms["top"] < 1.0
