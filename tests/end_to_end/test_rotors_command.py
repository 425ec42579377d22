"""`gearwhine rotors` on cases of its own: what is new in the JSON, and each key of the case doing what it says."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.output.manifest import opened_dataset

RPM = math.pi / 30.0

# A shaft so short and thick that it is rigid beside its bearings, which makes a Jeffcott rotor of it.
JEFFCOTT = """
title = "Rigid rotor between two alike bearings"

[material.stiff]
youngs_modulus = "21 TPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"

[[rotor]]
name = "shaft"
material = "stiff"
segments = [{ length = "100 mm", diameter = "80 mm" }]
discs = [{ at = "50 mm", mass = "10 kg", polar_inertia = "0.04 kg*m^2", diametral_inertia = "0.02 kg*m^2" }]

[[bearing]]
name = "left"
rotor = "shaft"
at = "0 mm"
speeds = ["1000 rpm", "2000 rpm", "3000 rpm"]
stiffness = { xx = ["1e6 N/m", "2e6 N/m", "4e6 N/m"], yy = ["1e6 N/m", "2e6 N/m", "4e6 N/m"] }
damping = { xx = "200 N*s/m", yy = "200 N*s/m" }

[[bearing]]
name = "right"
rotor = "shaft"
at = "100 mm"
speeds = ["1000 rpm", "2000 rpm", "3000 rpm"]
stiffness = { xx = ["1e6 N/m", "2e6 N/m", "4e6 N/m"], yy = ["1e6 N/m", "2e6 N/m", "4e6 N/m"] }
damping = { xx = "200 N*s/m", yy = "200 N*s/m" }

[operation]
speed = "2000 rpm"

[rotor_analysis]
modes = 4
speed = ["1000 rpm", "2000 rpm"]
"""
MASS = 10.0 + 7850.0 * math.pi / 4.0 * 0.08**2 * 0.1


@pytest.fixture
def jeffcott(tmp_path: Path) -> str:
    (tmp_path / "jeffcott.toml").write_text(JEFFCOTT, encoding="utf-8")
    return "jeffcott.toml"


def test_tables_hold_at_their_own_speeds(solved_rotor: Any, jeffcott: str) -> None:
    """Bouncing at ω² = 2k / m with k of the speed, damped by ζ = c / √(k m / 2) / 2 of two alike bearings."""
    rotor = solved_rotor(jeffcott, "sweep={speed=['1000 rpm','3000 rpm']}")
    for whirl, stiffness in zip(rotor["whirl"], (2e6, 1e6, 4e6), strict=True):
        frequency = math.sqrt(2.0 * stiffness / MASS)
        ratio = 2.0 * 200.0 / (2.0 * MASS * frequency)
        bounce = [place for place, f in enumerate(whirl["frequency_hz"]) if abs(f * 2 * math.pi / frequency - 1) < 1e-4]
        assert len(bounce) == 2  # both planes
        for place in bounce:
            assert whirl["damping_ratio"][place] == pytest.approx(ratio, rel=1e-4)
            expected = 2.0 * math.pi * ratio / math.sqrt(1.0 - ratio**2)
            assert whirl["log_decrement"][place] == pytest.approx(expected, rel=1e-4)
    assert rotor["rest_bearings_at_rpm"] == pytest.approx(1000.0)
    assert rotor["static"]["bearings_at_rpm"] == pytest.approx(2000.0)
    assert rotor["lateral_hz"][0] * 2 * math.pi == pytest.approx(math.sqrt(2e6 / MASS), rel=1e-4)


def test_a_campbell_diagram_stands_without_being_asked_for(solved_rotor: Any, jeffcott: str) -> None:
    campbell = solved_rotor("friswell-rotor", "sweep=", "rotor_analysis.modes=2")["campbell"]
    assert campbell["speed_rpm"] == pytest.approx(np.linspace(0.0, 6000.0, 51).tolist(), abs=1e-9)
    assert campbell["unstable_from_rpm"] is None
    assert solved_rotor(jeffcott, "operation=", "rotor_analysis.speed=")["campbell"] is None
    chosen = solved_rotor(jeffcott)["campbell"]
    assert chosen["speed_rpm"] == pytest.approx([1000.0, 2000.0])


def test_the_onset_of_instability_is_that_of_the_cross_coupled_jeffcott_rotor(solved_rotor: Any, jeffcott: str) -> None:
    """Forward whirl of the bounce grows where the cross stiffness exceeds c ω, ω² = 2k / m, between two speeds."""
    threshold = 200.0 * math.sqrt(2.0 * 1e6 / MASS)
    cross = f"['{0.6 * threshold} N/m', '{1.2 * threshold} N/m', '{1.8 * threshold} N/m']"
    negative = cross.replace("['", "['-").replace(" '", " '-")
    springs = f"{{xx='1e6 N/m', yy='1e6 N/m', xy={cross}, yx={negative}}}"
    settings = [f"bearing.{name}.stiffness={springs}" for name in ("left", "right")]
    loud = solved_rotor(jeffcott, *settings, "rotor_analysis.speed=['3000 rpm', '1000 rpm', '2900 rpm']")
    assert loud["campbell"]["unstable_from_rpm"] == pytest.approx(1000.0 / 0.6, rel=1e-4)
    assert [whirl["stable"] for whirl in loud["whirl"]] == [False]  # at 2000 rpm
    slow = solved_rotor(jeffcott, *settings, "rotor_analysis.speed=['1000 rpm', '1600 rpm']")
    assert slow["campbell"]["unstable_from_rpm"] is None


def test_bearings_carry_the_weight_in_equal_shares_and_sag_by_it(solved_rotor: Any, jeffcott: str) -> None:
    static = solved_rotor(jeffcott)["static"]
    share = MASS * 9.80665 / 2.0
    for bearing in static["bearings"]:
        assert bearing["load_n"] == pytest.approx([0.0, -share, 0.0], abs=1e-6)
    assert static["largest_deflection_m"] == pytest.approx(share / 2e6, rel=1e-4)
    sideways = solved_rotor(jeffcott, "rotor_analysis.gravity=['9.81 m/s^2', 0, 0]")["static"]
    assert sideways["bearings"][0]["load_n"] == pytest.approx([MASS * 9.81 / 2.0, 0.0, 0.0], abs=1e-6)
    free = solved_rotor("friswell-rotor", "bearing=[]", "provenance=", "rotor_analysis.modes=6")
    assert "free to move" in free["static"]["why_not"]


def test_constant_forces_load_the_bearings_by_the_lever(solved_rotor: Any, jeffcott: str) -> None:
    pull = "{ rotor = 'shaft', at = '25 mm', x = '400 N', y = '-80 N' }"
    static = solved_rotor(jeffcott, f"operation.force=[{pull}]")["static"]
    share = MASS * 9.80665 / 2.0
    for bearing, part in zip(static["bearings"], (0.75, 0.25), strict=True):
        assert bearing["load_n"] == pytest.approx([400.0 * part, -share - 80.0 * part, 0.0], abs=1e-6)
    assert static["forces"] == [{"at_m": 0.025, "force_n": [400.0, -80.0, 0.0]}]
    # Nothing holds the shaft along its axis.
    along = solved_rotor(jeffcott, f"operation.force=[{pull.replace('x', 'z')}]")["static"]
    assert "free to move" in along["why_not"]


def test_one_speed_makes_no_campbell_diagram(gearwhine: Any, jeffcott: str, tmp_path: Path) -> None:
    same = "rotor_analysis.speed=['2000 rpm', '2000 rpm']"
    outcome = gearwhine("rotors", jeffcott, "-q", "--json", "-o", "out", "--set", same)
    assert outcome.code == 0, outcome.err
    (rotor,) = outcome.document["rotors"]
    assert "expected two or more different speeds" in rotor["campbell"]["why_no_critical_speeds"]
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert "rotor-shaft-modes.png" in names
    assert not any("campbell" in name for name in names)


def test_the_response_to_unbalance_is_that_of_the_jeffcott_rotor(
    solved_rotor: Any, rotor_curves: Any, jeffcott: str
) -> None:
    """m e Ω² / (2k − M Ω² + 2 i c Ω): amplitude and lag of a disc that does not tilt, through resonance."""
    settings = (
        "rotor.shaft.unbalance=[{at='50 mm', moment='1e-4 kg*m', phase='30 deg'}]",
        "rotor_analysis.unbalance_response={speed=['1000 rpm', '3000 rpm'], probes=["
        "{name='x', rotor='shaft', at='50 mm'}, {name='y', rotor='shaft', at='50 mm', angle='90 deg'}]}",
    )
    response, data = solved_rotor(jeffcott, *settings)["unbalance_response"], rotor_curves(jeffcott, *settings)
    assert (response["from_rpm"], response["to_rpm"]) == pytest.approx((1000.0, 3000.0))

    def expected(rpm: float, stiffness: float) -> complex:
        speed = rpm * RPM
        return complex(1e-4 * speed**2 / (2 * stiffness - MASS * speed**2 + 2j * 200.0 * speed))

    for place, (rpm, stiffness) in enumerate([(1000.0, 1e6), (3000.0, 4e6)]):
        motion = expected(rpm, stiffness)
        lag = (-math.degrees(np.angle(motion)) - 30.0) % 360.0
        assert float(data.probe_amplitude[0, place]) == pytest.approx(abs(motion), rel=1e-4)
        assert float(data.orbit_major_axis[0, place]) == pytest.approx(abs(motion), rel=1e-4)
        lags = np.degrees(data.probe_phase_lag.values[:, place])
        assert lags == pytest.approx([lag, (lag + 90.0) % 360.0], abs=0.01)
        force = abs(motion) * abs(stiffness + 200j * rpm * RPM)
        of_left = data.unbalance_bearing_force.sel(unbalance_bearing="left", plane="x")
        assert float(of_left[place]) == pytest.approx(force, rel=1e-4)
        assert data.unbalance_bearing_speed.values[0, place] == pytest.approx(rpm)
    largest = data.unbalance_bearing_force.max("response_step").values
    assert np.array([one["largest_force_n"] for one in response["bearings"]]) == pytest.approx(largest)
    along_x = response["probes"][0]
    assert along_x["operation_amplitude_m"] == pytest.approx(abs(expected(2000.0, 2e6)), rel=1e-4)
    assert solved_rotor(jeffcott)["unbalance_response"] is None


@pytest.mark.slow
@pytest.mark.parametrize("sense", [1, -1])
def test_a_clockwise_rotor_lags_as_its_mirror_image(solved_rotor: Any, jeffcott: str, sense: int) -> None:
    """The mirrored disc's unbalance and probe stand at the negative angles: its probe reads the same at all times."""
    response = solved_rotor(
        jeffcott,
        f"operation.speed={2000 * sense} rpm",
        f"rotor.shaft.unbalance=[{{at='50 mm', moment='1e-4 kg*m', phase='{30 * sense} deg'}}]",
        "rotor_analysis.unbalance_response={probes=[{name='x', rotor='shaft', at='50 mm'}, "
        f"{{name='y', rotor='shaft', at='50 mm', angle='{90 * sense} deg'}}]}}",
    )["unbalance_response"]
    speed = 2000.0 * RPM
    motion = 1.0 / complex(2 * 2e6 - MASS * speed**2, 2 * 200.0 * speed)
    lag = -math.degrees(np.angle(motion)) - 30.0
    lags = [probe["operation_phase_lag_deg"] for probe in response["probes"]]
    assert lags == pytest.approx([lag % 360.0, (lag + 90.0) % 360.0], abs=0.01)


@pytest.mark.parametrize("sense", [1, -1])
def test_the_response_over_speed_is_in_the_sense_of_operation(solved_rotor: Any, jeffcott: str, sense: int) -> None:
    """m e Ω² / (2k − M Ω² + 2i (c Ω − q)): cross-coupling q feeds forward whirl of one sense, and damps the other's."""
    q = 2e4
    stiffness = f"{{xx='2e6 N/m', yy='2e6 N/m', xy='{q} N/m', yx='{-q} N/m'}}"
    (probe,) = solved_rotor(
        jeffcott,
        f"operation.speed={5500 * sense} rpm",
        "bearing.*.speeds=",
        f"bearing.*.stiffness={stiffness}",
        "rotor.shaft.unbalance=[{at='50 mm', moment='1e-4 kg*m'}]",
        "rotor_analysis.unbalance_response={speed=['5500 rpm', '500 rpm'], "
        "probes=[{name='x', rotor='shaft', at='50 mm'}]}",
    )["unbalance_response"]["probes"]
    speed = sense * 5500.0 * RPM
    motion = 1e-4 * speed**2 / complex(2 * 2e6 - MASS * speed**2, 2.0 * (200.0 * speed - q))
    assert probe["operation_amplitude_m"] == pytest.approx(abs(motion), rel=1e-3)
    assert probe["largest_amplitude_m"] == pytest.approx(abs(motion), rel=1e-3)
    assert probe["largest_at_rpm"] == pytest.approx(sense * 5500.0)


@pytest.mark.parametrize("sense", [1, -1])
def test_phase_of_a_clockwise_rotor_in_the_system_is_that_of_its_signal(
    tmp_path: Path, jeffcott: str, sense: int
) -> None:
    """Bearings carry half of m e w² cos(|w| t + phase) along x each, where the rotor turns slowly."""
    settings = [
        f"operation.speed={1000 * sense} rpm",
        "bearing.*.speeds=",
        "bearing.*.stiffness={xx='1e8 N/m', yy='1e8 N/m'}",
        "rotor.shaft.unbalance=[{at='50 mm', moment='1e-4 kg*m', phase='30 deg'}]",
        "sweep={speed=['100 rpm', '200 rpm']}",
    ]
    data = gw.load(tmp_path / jeffcott, settings).system().dataset
    x, y = np.degrees(data.unbalance_response_bearing_force_phase.values[0, 0, 0])
    assert x == pytest.approx(30.0 * sense, abs=0.1)
    # Counter-clockwise y comes a quarter turn after x, clockwise a quarter turn before it.
    assert y == pytest.approx(30.0 * sense - 90.0 * sense, abs=0.1)
    found = data.unbalance_response_bearing_force.values[0, 0, 0]
    assert found == pytest.approx([0.5e-4 * (100.0 * RPM) ** 2] * 2, rel=1e-3)


def test_probes_stand_at_bearings_and_unbalances_unless_named(solved_rotor: Any, rotor_curves: Any) -> None:
    quick = ("rotor_analysis.modes=2", "sweep={speed=['1000 rpm', '2000 rpm']}")
    response = solved_rotor("friswell-rotor", *quick)["unbalance_response"]
    assert [(probe["name"], probe["at_m"]) for probe in response["probes"]] == [
        ("left", 0.0),
        ("unbalance 1", 0.5),
        ("right", 1.5),
    ]
    assert (response["from_rpm"], response["to_rpm"]) == pytest.approx((1000.0, 2000.0))
    assert rotor_curves("friswell-rotor", *quick).response_speed.shape == (3, 301)


def test_a_bow_is_read_as_it_is_where_the_rotor_turns_slowly(rotor_curves: Any) -> None:
    bow = "rotor.shaft.bow=[{at='0 m', amplitude=0}, {at='0.5 m', amplitude='10 um'}, {at='1.5 m', amplitude=0}]"
    slow = "rotor_analysis={modes=2, speed=['1 rpm', '2 rpm'], unbalance_response={speed=['1 rpm']}}"
    amplitude = rotor_curves("friswell-rotor", "sweep=", bow, slow).probe_amplitude
    assert float(amplitude.sel(probe="shaft: unbalance 1")[0]) == pytest.approx(10e-6, rel=1e-4)


def test_the_stiffness_map_of_a_rigid_rotor_rises_with_the_root_of_the_stiffness(
    solved_rotor: Any, jeffcott: str
) -> None:
    """The bounce's √(2k / M) at every stiffness; the disc's polar inertia takes the forward tilting mode away."""
    settings = "rotor_analysis.stiffness_map={from='1e5 N/m', to='1e7 N/m', points=3}"
    given = solved_rotor(jeffcott, settings)["stiffness_map"]
    assert given["stiffness_n_per_m"] == pytest.approx([1e5, 1e6, 1e7])
    for stiffness, speeds in zip(given["stiffness_n_per_m"], given["forward_critical_speeds_rpm"], strict=True):
        assert speeds[0] * RPM == pytest.approx(math.sqrt(2.0 * stiffness / MASS), rel=1e-4)
    assert solved_rotor(jeffcott)["stiffness_map"] is None


def test_the_results_file_holds_diagram_and_response_with_units(gearwhine: Any) -> None:
    quick = ("--set", "rotor_analysis.modes=3", "--set", "sweep={speed=['0 rpm', '1000 rpm', '2000 rpm']}")
    document = gearwhine("rotors", "friswell-rotor", "--json", "-q", "-o", "out", *quick).document
    (rotor,) = document["rotors"]
    with opened_dataset("out/results.nc") as data:
        assert data.campbell_frequency.dims == ("rotor", "campbell_step", "whirl_branch")
        assert data.campbell_frequency.attrs["units"] == "Hz"
        # The document has the frequencies at each speed, rising; the diagram has them by branch.
        for whirl, row in zip(rotor["whirl"][-3:], data.campbell_frequency.values[0], strict=True):
            assert np.sort(row)[:3] == pytest.approx(whirl["frequency_hz"], rel=1e-6)
        reading, told = data.sel(probe="shaft: unbalance 1"), rotor["unbalance_response"]["probes"][1]
        assert float(reading.probe_amplitude.max()) == told["largest_amplitude_m"]
        largest = int(np.argmax(reading.probe_amplitude.values))
        assert float(reading.response_speed[largest]) == told["largest_at_rpm"]


def test_margins_are_of_the_critical_speeds_beside_operation(solved_rotor: Any) -> None:
    rotor = solved_rotor("friswell-rotor")
    expected = np.array(rotor["critical_speeds_rpm"]) / 4000.0 - 1.0
    assert rotor["critical_margins"] == pytest.approx(expected.tolist(), rel=1e-9)
    assert solved_rotor("friswell-rotor", "operation=")["critical_margins"] is None


def test_as_many_lateral_modes_are_shown_as_are_asked_for(solved_rotor: Any) -> None:
    rotor = solved_rotor("friswell-rotor", "rotor_analysis.modes=4")
    assert len(rotor["lateral_hz"]) == len(rotor["whirl"][0]["frequency_hz"]) == 4
    assert rotor["certificate"]["complete"] is True


def test_a_bow_is_for_the_coupled_system_too(gearwhine: Any) -> None:
    bow = ("--set", "rotor.shaft.bow=[{at='0.5 m', amplitude='10 um'}, {at='0 m', amplitude=0}]")
    for command in ("check", "rotors", "system"):
        assert gearwhine(command, "friswell-rotor", "-q", *bow).code == 0


def test_the_coupled_system_keeps_what_the_rotor_says(gearwhine: Any) -> None:
    def coordinates(*settings: str) -> int:
        changes = [part for setting in settings for part in ("--set", setting)]
        return int(gearwhine("system", "spur-pair", "--json", "-q", *changes).document["coordinates"])

    few, more = coordinates("rotor.input.modes=3"), coordinates("rotor.input.modes=5")
    assert more - few == 2 * 2 + 2  # two bending modes in each of two planes, and two torsional ones
    # The shaft's bending modes lie at 1.4, 3.1, 4.2, 7.3, 12.6 kHz, its elastic torsional ones at 8.0 and 9.1 kHz.
    low, high = (coordinates(f"rotor.input.frequency_limit='{limit} kHz'") for limit in (12, 14))
    assert high - low == 2


def test_the_overhung_fan_has_all_of_it(solved_rotor: Any) -> None:
    """Its bearings carry what it weighs, the fan side's more than the impeller; its modes are all found."""
    few = (
        "rotor_analysis.speed=['1000 rpm', '1400 rpm', '1800 rpm']",
        "rotor_analysis.stiffness_map.points=2",
        "rotor_analysis.unbalance_response.speed=['1000 rpm', '2000 rpm']",
        "rotor_analysis.modes=4",
    )
    fan = solved_rotor("overhung-fan", *few)
    loads = {bearing["name"]: bearing["load_n"][1] for bearing in fan["static"]["bearings"]}
    assert sum(loads.values()) == pytest.approx(-fan["mass_kg"] * 9.80665, rel=1e-9)
    assert loads["fan side"] < -250.0 * 9.80665
    assert fan["static"]["largest_deflection_at_m"] == 0.0
    assert fan["certificate"]["complete"] is True
    assert [len(row) for row in fan["stiffness_map"]["forward_critical_speeds_rpm"]] == [4, 4]
    assert len(fan["unbalance_response"]["probes"]) == 5


def test_check_says_what_a_rotor_and_its_bearings_are_made_of(gearwhine: Any) -> None:
    out = gearwhine("check", "overhung-fan", "--verbose").out
    assert "fan: 2570 mm with 1 coupling" in out
    assert "by a pedestal of 150 kg, tables over 200 to 2500 rpm" in out
    assert "Campbell diagram at 47 speeds, 200 to 2500 rpm" in out
    assert "response to unbalance and bow at 231 speeds" in out


@pytest.mark.parametrize("tie", [0.0, 2e3])
def test_motion_along_the_axis_is_neither_bending_nor_critical(solved_rotor: Any, jeffcott: str, tie: float) -> None:
    """k/m of a thrust bearing, tied to its tilt or not: told as axial, and no part of critical speeds and margins."""
    matrix = f"[[1e6,0,0,0,0],[0,1e6,0,0,0],[0,0,2.5e5,0,{tie}],[0,0,0,1e3,0],[0,0,{tie},0,1e3]]"
    springs = [f"bearing.left.stiffness={{ matrix = {matrix} }}", "bearing.right.stiffness={ xx = 1e6, yy = 1e6 }"]
    untabled = [f"bearing.{name}.speeds=" for name in ("left", "right")]
    rotor = solved_rotor(jeffcott, "bearing.left.damping=", *untabled, *springs, "rotor_analysis.modes=5")
    bounce = math.sqrt(2.5e5 / MASS) / (2.0 * math.pi)
    assert rotor["axial_hz"][0] == pytest.approx(bounce, rel=1e-2)
    assert min(abs(frequency / bounce - 1.0) for frequency in rotor["lateral_hz"]) > 0.1
    assert min(abs(speed / 60.0 / bounce - 1.0) for speed in rotor["critical_speeds_rpm"]) > 0.1
    assert len(rotor["critical_margins"]) == len(rotor["critical_speeds_rpm"])
    crossed = [abs(each["speed_rpm"]) / 60.0 for each in rotor["campbell"]["critical_speeds"]]
    assert all(abs(speed / bounce - 1.0) > 0.1 for speed in crossed)
    shares = rotor["whirl"][0]["axial_share"]
    assert (max(shares) > 0.9) == (tie > 0.0)


def test_damping_of_a_coupling_that_whirl_is_told_without_is_warned_of(gearwhine: Any, tmp_path: Path) -> None:
    """Rotating damping makes forward whirl grow at speed: `system` has it, `rotors` says that it has not."""
    soft = "lateral_stiffness = 1e9, axial_stiffness = 1e9, tilt_stiffness = 1e7, torsional_stiffness = 1e6"
    plain = 'segments = [{ length = "100 mm", diameter = "80 mm" }]'
    half = '{ length = "49 mm", diameter = "80 mm" }'
    for damping, told in (("lateral_damping = 50", True), ("torsional_damping = 5", False)):
        coupling = f'{{ length = "2 mm", coupling = {{ {soft}, {damping} }} }}'
        text = JEFFCOTT.replace(plain, f"segments = [{half}, {coupling}, {half}]")
        (tmp_path / "coupled.toml").write_text(text, encoding="utf-8")
        outcome = gearwhine("rotors", "coupled.toml", "--json", "-q")
        assert outcome.code == 0, outcome.err
        found = [one["message"] for one in outcome.document["warnings"] if one["name"] == "rotating damping"]
        assert bool(found) == told
        assert all("with it by `gearwhine system`" in message for message in found)


@pytest.mark.slow
def test_a_written_ross_file_of_a_rotor_with_bearing_tables_is_a_case_of_its_own(gearwhine: Any) -> None:
    """Where the case names no speeds, those of its tables are taken, whose lowest stands for rest."""
    few = ("--set", "rotor_analysis.modes=2", "-q")
    assert gearwhine("rotors", "overhung-fan", "--write-ross", "-o", "ross", *few).code == 0
    outcome = gearwhine("rotors", "ross/fan.ross.toml", "--json", "-o", "again", *few)
    assert outcome.code == 0, outcome.err
    (rotor,) = outcome.document["rotors"]
    assert rotor["rest_bearings_at_rpm"] == pytest.approx(200.0)
