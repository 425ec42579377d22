"""Signals, lines and warnings of steady motions, and of motions in time, in closed form: the numbers are put in."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearwhine.coupling.analyses import steady_state
from gearwhine.coupling.analyses.condition_record import _gears
from gearwhine.coupling.analyses.modes_and_responses import SolvedSystem
from gearwhine.coupling.analyses.motion_warnings import beyond_limit_warnings, settling_warnings
from gearwhine.coupling.analyses.steady_state import SolvedSteady, SteadyMotion, spectra_of_sum
from gearwhine.coupling.linear.campbell import _error_of_frozen_carriers
from gearwhine.coupling.linear.excitation_orders import _harmonic_loads, excited_shaft_orders
from gearwhine.coupling.load_analysis.influences import Influence
from gearwhine.coupling.machine.base_motion import BaseHarmonic, BaseMotion
from gearwhine.coupling.machine.loads import TorqueRipple
from gearwhine.coupling.periodic.continuation import Bifurcation, ResponseCurve
from gearwhine.coupling.periodic.superposition import ExcitationGroup
from gearwhine.coupling.signals.spectrum import Spectrum, amplitude_spectrum

RPM = 30.0 / np.pi


def motion(period: float, limit: float, weight: int = 1, **histories: Any) -> SteadyMotion:
    """A motion of which the period and some signals are known."""
    response: Any = SimpleNamespace(period=period)
    given: Any = SimpleNamespace(**histories)
    return SteadyMotion(1.0, response, given, limit, group=ExcitationGroup(weight=weight))


def tone(period: float, samples: int, *lines: tuple[int, float, float]) -> Any:
    """Cosines of so many cycles, an amplitude and a phase."""
    turns = 2.0 * np.pi * np.arange(samples) / samples
    return sum(size * np.cos(cycles * turns + phase) for cycles, size, phase in lines)


def test_a_signal_has_its_lines_its_rms_and_its_values_between_samples() -> None:
    signal = tone(0.5, 64, (3, 2.0, 0.4), (7, 5.0, -1.1), (20, 1e-12, 0.0)) + 9.0
    one = motion(0.5, 10.0, sensor_acceleration={"top": signal})
    highest, second = one.lines(signal)
    assert highest == pytest.approx((14.0, 5.0, -1.1))
    assert second == pytest.approx((6.0, 2.0, 0.4))
    assert one.lines(signal, 10.0) == [pytest.approx(second)]
    assert one.sensor_rms == {"top": pytest.approx(2.0 / np.sqrt(2.0))}
    finer = one.resampled(signal, 256)
    np.testing.assert_allclose(finer, tone(0.5, 256, (3, 2.0, 0.4), (7, 5.0, -1.1)) + 9.0, atol=1e-9)
    assert one.resampled(signal, 64) is signal


def test_a_line_of_two_motions_is_one_of_their_sum() -> None:
    """Periods of 1/2 and 1/3 s share 6 Hz, and their multiples; the second counts twice, against."""
    first = tone(0.5, 32, (1, 1.0, 0.0), (3, 4.0, 0.3))
    second = tone(1.0 / 3.0, 32, (1, 2.0, 0.0), (2, 1.5, 0.3), (4, 1.0, -0.6))
    motions = [
        motion(0.5, 20.0, sensor_acceleration={"top": first}),
        motion(1.0 / 3.0, 20.0, -2, sensor_acceleration={"top": second}),
    ]
    of_first, of_second = spectra_of_sum(motions, [first, second])
    assert of_first.amplitude[[1, 3]] == pytest.approx([1.0, 1.0])
    assert of_first.phase[3] == pytest.approx(0.3)  # 4 - 2 1.5
    assert of_second.amplitude[[1, 2, 4]] == pytest.approx([4.0, 0.0, 0.0], abs=1e-12)
    assert of_first.amplitude[6] == pytest.approx(2.0)
    expected = np.sqrt(0.5 * (1.0**2 + 1.0**2 + 2.0**2 + 4.0**2))
    machine: Any = None
    assert SolvedSteady(machine, tuple(motions)).rms_of_sum("top") == pytest.approx(expected)


def test_narrow_ranges_without_a_motion_are_told_together() -> None:
    """Of 1000 rpm two gaps of 4 and 6 rpm are narrow, and one of 100 rpm is not."""
    ends = np.array([1000.0, 1200.0, 1204.0, 1400.0, 1500.0, 1700.0, 1706.0, 2000.0])
    system_at: Any = None
    for sense in (1.0, -1.0):
        curve = ResponseCurve(
            sense * ends / RPM,
            (),
            (),
            system_at,
            begin=sense * 1000.0 / RPM,
            aim=sense * 2000.0 / RPM,
            pieces=(0, 2, 4, 6),
        )
        machine: Any = None
        wide, narrow = SolvedSteady(machine, (), curve).branch_warnings()
        assert wide["message"].startswith(
            "no motion was followed between 1400 and 1500 rpm of 1000 to 2000: the branch"
        )
        assert (wide["name"], wide["from_rpm"], wide["to_rpm"]) == (
            "branch range",
            pytest.approx(1400.0),
            pytest.approx(1500.0),
        )
        assert narrow["message"] == (
            "no motion was followed in 2 narrow ranges, 10 rpm together, the widest 1700 to 1706 rpm: resonances that "
            "next to nothing damps, or flanks that graze"
        )
        assert narrow["name"] == "branch ranges"
        assert np.sort(np.ravel(narrow["ranges_rpm"])) == pytest.approx([1200.0, 1204.0, 1700.0, 1706.0])


def test_pieces_and_gaps_of_a_branch_are_told() -> None:
    """Six pieces of two points, of which four are told one by one, and as many of the five gaps, the widest."""
    ends = np.array([10.0, 20.0, 21.0, 30.0, 32.0, 40.0, 43.0, 50.0, 54.0, 60.0, 65.0, 70.0])
    folds = (Bifurcation(3, "fold", 25.0), Bifurcation(4, "period doubling", 33.0), Bifurcation(5, "fold", 33.0))
    system_at: Any = None
    endings: Any = ("lost", "end", "points", "end", "end", "end")
    curve = ResponseCurve(ends, (), folds, system_at, 1, endings, 10.0, 70.0, (0, 2, 4, 6, 8, 10))
    first, second, third, fourth, more, none = curve.description(0.5, "rpm").split(". ")
    assert first.startswith("followed from 20 to 40 rpm: 2 points, 0 folds; ")
    assert second == "begun anew and followed from 42 to 60 rpm: 2 points, 1 fold"
    assert third.startswith("begun anew and followed from 64 to 80 rpm: 2 points, 1 fold; ")
    assert fourth == "begun anew and followed from 86 to 100 rpm: 2 points, 0 folds"
    assert more == "2 more pieces with 12 points in all"
    assert none == (
        "Nothing was followed between 60 and 64, between 80 and 86, between 100 and 108, between 120 and 130 rpm, nor "
        "in 1 narrower range"
    )
    assert curve.piece_numbers.tolist() == [1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6]


def test_gears_without_an_average_say_why() -> None:
    """Shafts of 10, 20 and 0 turns a second, and a planet's; 30 teeth at 10 Hz are 300 Hz, 31 at 10 Hz no multiple."""

    def mesh(*sides: tuple[str, str, int]) -> Any:
        parts = [SimpleNamespace(name=gear, tooth_count=teeth) for gear, _, teeth in sides]
        mounted = [SimpleNamespace(rotor=shaft) for _, shaft, _ in sides]
        geometry = SimpleNamespace(driver=parts[0], driven=parts[1])
        return SimpleNamespace(driver=mounted[0], driven=mounted[1], geometry=geometry)

    meshes = [
        mesh(("pinion", "slow", 30), ("wheel", "fast", 15)),
        mesh(("sun", "slow", 31), ("planet", "carried", 20)),
        mesh(("quick", "fast", 20), ("ring", "held", 40)),
    ]
    contacts = [SimpleNamespace(mesh_frequency=hertz) for hertz in (-300.0, 200.0, 400.0)]
    speeds = {"slow": -20.0 * np.pi, "fast": 40.0 * np.pi, "carried": 5.0, "held": 0.0}
    rotors = [SimpleNamespace(name=name, carrier="c" if name == "carried" else None) for name in speeds]
    system = SimpleNamespace(contacts=contacts)
    machine = SimpleNamespace(rotors=rotors, meshes=meshes, system=system, speeds=speeds)
    transient: Any = SimpleNamespace(machine=machine, trusted_limit=419.0)
    gears = {gear.gear: gear for gear in _gears(transient)}
    assert {name: gear.undefined for name, gear in gears.items()} == {
        "pinion": "",
        "sun": "the gear meshes with planets: its mesh frequency is no multiple of its shaft's turns",
        "wheel": "",
        "quick": "its mesh frequency, 400 Hz, with sidebands is beyond the trusted limit of 419 Hz; raise the "
        "housing's frequency_limit, or take a lower speed",
        "planet": "the axis of the gear turns with its carrier",
        "ring": "the shaft stands still",
    }
    assert [(one.shaft, one.teeth, one.others, one.turn_hz) for one in (gears["pinion"], gears["quick"])] == [
        ("slow", 30, (31,), pytest.approx(10.0)),
        ("fast", 20, (15,), pytest.approx(20.0)),
    ]
    transient.trusted_limit = 420.0
    assert next(gear.undefined for gear in _gears(transient) if gear.gear == "quick") == ""


def test_a_doubtful_sum_is_told_of_each_contact_and_sensor() -> None:
    names, loaded = ("a -> b", "a -> b, back", "c -> d", "c -> d, back", "e -> f"), (True, False, True, False, True)
    contacts = [SimpleNamespace(name=name, loaded=one) for name, one in zip(names, loaded, strict=True)]
    machine: Any = SimpleNamespace(system=SimpleNamespace(contacts=contacts))
    parts = {
        "contact_loss": np.array([0.25, 1.0, 0.0, 0.96, 0.0]),
        "neglected_part": np.array([0.5, 0.5, 0.2, 0.3, 0.1]),
    }
    superposed: Any = SimpleNamespace(**parts)
    signals = {"top": tone(0.5, 64, (3, 2.0, 0.0)), "side": tone(0.5, 64, (3, 4.0, 0.0))}
    lost = {name: Spectrum(np.array([6.0]), np.array([1.0]), np.zeros(1), "uniform") for name in signals}
    solved = SolvedSteady(
        machine,
        (motion(0.5, 10.0, sensor_acceleration=signals),),
        superposed=superposed,
        neglected_acceleration=lost,
    )
    told = solved.superposition_warnings()
    instead = "hold them against run or steady --exact"
    assert [one["message"].removeprefix("superposed motions are doubtful at ") for one in told] == [
        f"a -> b: its flanks are apart 25 % of the time under all excitations together; {instead}",
        f"c -> d: the sum leaves out 20 % of its varying force; {instead}",
        f"c -> d, back: these flanks touch 4 % of the time under all excitations together; {instead}",
        f"sensor top: what the sum leaves out makes some 50 % of its acceleration, rms; {instead}",
    ]
    assert {one["name"] for one in told} == {"superposition"}
    assert [one.get("contact_loss") for one in told] == [0.25, 0.0, 0.96, None]
    assert [one["neglected_part"] for one in told] == [0.5, 0.2, 0.3, pytest.approx(0.5)]
    assert replace(solved, superposed=None, neglected_acceleration={}).superposition_warnings() == []


def test_frozen_carriers_err_by_what_the_exponents_say() -> None:
    """Of three modes two have exponents, of 99 and 101 Hz: frozen at 100 and 99 Hz they are 1 and -2 % off."""
    turns = 2.0j * np.pi
    warned = ({"name": "of the modes", "message": ""},)
    modes = SimpleNamespace(
        eigenvalues=turns * np.array([90.0, 100.0, 99.0]), labels=["first", "second", "third"], warnings=warned
    )
    ring, other, still = (SimpleNamespace(name=f"part {n}", turning=n < 3) for n in (1, 2, 3))
    rates = 2.0 * np.pi * np.array([5.0, -3.0])
    system = SimpleNamespace(turns=True, linear=(still, ring), contacts=(other,), turning_rates=rates)
    solved: Any = SimpleNamespace(exponents=None, modes=modes, machine=SimpleNamespace(system=system))
    assert SolvedSystem._frozen_warnings(solved) == warned
    solved.exponents = np.full(3, complex(np.nan, np.nan))
    assert SolvedSystem._frozen_warnings(solved) == warned
    solved.exponents = np.array([np.nan, 99.0 * turns, 1e-3 + 101.0 * turns])
    (told,) = SolvedSystem._frozen_warnings(solved)
    assert told["message"] == (
        "natural modes, damping ratios and stability are those with the carriers frozen as they stand at the start, as "
        "part 1 and 1 more connectors turn at 3 Hz against parts that are not alike all round; of 2 modes whose "
        "exponents with turning carriers are solved too, the largest error of a frequency is -2 % (third, 101 Hz "
        "turning); turning, these grow by themselves: third"
    )
    assert (told["turning"], told["turning_hz"]) == (["part 1", "part 2"], pytest.approx(3.0))
    assert (told["mode"], told["frequency_hz"]) == ("third", pytest.approx(101.0))
    assert told["largest_error"] == pytest.approx(99.0 / 101.0 - 1.0)

    # Over speed: of six modes four have exponents, at two of three speeds.
    exact = turns * np.array([[99.0, np.nan], [np.nan, np.nan], [50.0, 198.0]])
    frozen = turns * np.array([[100.0, 200.0], [100.0, 200.0], [50.0, 192.06]])
    assert _error_of_frozen_carriers(np.array([10.0, 20.0, -30.0]) / RPM, frozen, exact) == (
        "beside them stand the exponents with turning carriers at 2 speeds, from which the largest error of a "
        "frequency is -3 %, of the mode at 198 Hz and 30 rpm"
    )
    assert _error_of_frozen_carriers(np.ones(3), frozen, exact * np.nan) is None


def test_loads_have_their_names_and_orders() -> None:
    """The first driver turns at 100 rad/s, the output the other way at 40 rad/s."""
    torques = (
        TorqueRipple("input", 0.0, 1.0, frequency=30.0 * np.pi),
        TorqueRipple("output", 0.0, 2.0, order=3.0),
        TorqueRipple("output", 0.0, 0.0, order=5.0),
        TorqueRipple("held", 0.0, 1.0, order=2.0),
    )
    base = BaseMotion((BaseHarmonic(50.0 * np.pi, np.ones(6, dtype=np.complex128)),))
    bows = [SimpleNamespace(rotor=rotor, forces=np.array([size])) for rotor, size in (("input", 0.0), ("bent", 1.0))]
    unbalances = [SimpleNamespace(rotor=rotor, moment=size) for rotor, size in (("input", 1e-5), ("held", 0.0))]
    loads = SimpleNamespace(torques=torques, base=base, bows=bows, unbalances=unbalances)
    speeds, system = {"input": 100.0, "output": -40.0, "held": 0.0}, SimpleNamespace(nonlinear=False)
    machine: Any = SimpleNamespace(loads=loads, speeds=speeds, meshes=(), system=system)
    named = dict(_harmonic_loads(machine, 100.0))
    assert named == {
        "ripple of 15 Hz on input": pytest.approx(0.3 * np.pi),
        "ripple of order 3 on output": pytest.approx(1.2),
        "base of 25 Hz": pytest.approx(0.5 * np.pi),
    }
    excited = excited_shaft_orders(machine)
    assert {rotor: set(one.orders) for rotor, one in excited.items()} == {
        "input": {1.0},
        "bent": {1.0},
        "output": {3.0},
        "held": {2.0},
    }
    assert not any(one.every for one in excited.values())
    system.nonlinear = True
    assert all(one.every for one in excited_shaft_orders(machine).values())


def test_a_line_near_a_mode_that_rings_and_power_that_is_not_modelled_are_told() -> None:
    """A mode of 200 Hz that falls by exp(-5 t) has exp(-1) = 37 % left of its start after 0.2 s.

    To 2 % it falls in ln(50) / 5 = 0.782 s, which is 15.6 turns of 20 Hz.
    """
    kinds = ((0, "mesh", "1× a -> b"), (1, "mesh", "2× a -> b"), (2, "mode", "mode 3"))
    named = [SimpleNamespace(mode=mode, kind=kind, name=name) for mode, kind, name in kinds]
    lines = [
        SimpleNamespace(frequency=hertz, named=one) for hertz, one in zip((201.0, 50.0, 300.0), named, strict=True)
    ]
    signature: Any = SimpleNamespace(
        lines={"top": lines, "side": [SimpleNamespace(frequency=202.0, named=named[0])]},
        modes=SimpleNamespace(
            eigenvalues=np.array([-5.0 + 1e3j, -1e3 + 1e3j, 1.0 + 1e3j]), frequencies_hz=np.array([200.0, 51.0, 301.0])
        ),
    )
    spectra = {
        name: amplitude_spectrum(tone(1.0, 256, (40, 3.0, 0.0), (90, above, 0.0)), 1.0 / 256.0)
        for name, above in (("top", 4.0), ("side", 1.0))
    }
    record = SimpleNamespace(sampling=SimpleNamespace(settings=SimpleNamespace(record_from=0.2), is_long=False))
    transient: Any = SimpleNamespace(record=record, speed=-40.0 * np.pi, trusted_limit=60.0, sensor_spectra=spectra)
    (rings,) = settling_warnings(transient, signature)
    assert rings["message"] == (
        "1× a -> b at 201 Hz stands near a coupled mode of 200 Hz whose free vibration has fallen to 37 % of its start "
        "when the record begins, so the line may be off: take transient.discard = 16 revolutions for 2 %, or `steady`"
    )
    assert (rings["name"], rings["frequency_hz"], rings["mode_hz"]) == ("settling", 201.0, 200.0)
    assert rings["left"] == pytest.approx(np.exp(-1.0))
    (beyond,) = beyond_limit_warnings(transient)
    assert "lies above 60 Hz, where modes of the housing are missing (top 64 %): rms" in beyond["message"]
    assert (beyond["trusted_below_hz"], beyond["parts"]) == (60.0, {"top": pytest.approx(0.64)})
    record.sampling.is_long = True
    assert beyond_limit_warnings(transient) == []


@pytest.mark.parametrize(
    ("kind", "step", "thick", "words"),
    [
        ("housing", 1e-3, True, ("1 mm thicker", "1 mm thinner")),
        ("bearing position", 2.5e-4, False, ("0.25 mm to +z", "0.25 mm to -z")),
        ("bearing stiffness", 0.1, False, ("10 % stiffer", "10 % softer")),
        ("housing", 0.05, False, ("5 % more", "5 % less")),
    ],
)
def test_steps_of_parameters_are_named(kind: str, step: float, thick: bool, words: tuple[str, str]) -> None:
    none = np.zeros((0, 3))
    one = Influence("p", kind, step, "mm" in words[0], none, none, none, none, is_thickness=thick)
    assert one.words == words
    assert one.step_text == "+" + " ".join(words[0].split()[:2])


def test_the_loudest_point_of_each_sensor_is_at_its_own_speed_and_of_its_own_mode(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two modes move two sensors; at the second of three speeds the one is loudest, at the third the other.

    A mode's share in a line is its acceleration there, by the sensor's row, over that of the sensor, in phase.
    """
    period, samples, speeds = 0.5, 64, np.array([10.0, 20.0, 40.0])
    modal = {
        20.0: np.array([tone(period, samples, (4, 6.0, 0.0)), tone(period, samples, (4, 1.0, 0.0), (9, 2.0, 1.0))]),
        40.0: np.array([tone(period, samples, (4, 1.0, 0.5)), tone(period, samples, (9, 5.0, 1.0), (4, 0.5, 0.5))]),
    }
    rows = {"top": np.array([2.0, -1.0, 0.0]), "side": np.array([0.5, 3.0, 0.0]), "still": np.zeros(3)}
    stiffness = np.diag((2.0 * np.pi * np.array([300.0, 700.0, 900.0])) ** 2)

    def at_speed(speed: float) -> Any:
        return SimpleNamespace(housing=SimpleNamespace(sensors=rows, stiffness=stiffness), speed=speed)

    def motion_at(machine: Any, speed: float, response: Any) -> SteadyMotion:
        assert (machine.speed, response) == (speed, speed)
        histories = {name: row[:2] @ modal[speed] for name, row in rows.items()}
        moved = motion(period, 100.0, sensor_acceleration=histories, times=np.arange(samples))
        response = SimpleNamespace(period=period, record=lambda outputs, count: (outputs, count))
        return replace(moved, response=response)

    def modal_record(machine: Any, record: Any) -> Any:
        assert record == (machine.speed, samples)
        return SimpleNamespace(housing_acceleration=modal[machine.speed].T)

    monkeypatch.setattr(steady_state, "_motion", motion_at)
    monkeypatch.setattr(steady_state, "transient_outputs", lambda machine: machine.speed)
    monkeypatch.setattr(steady_state, "with_modal_rows", lambda machine, outputs: outputs)
    monkeypatch.setattr(steady_state, "modal_record", modal_record)

    def named(machine: Any, lines: list[float], within: float) -> list[Any]:
        return [SimpleNamespace(name=f"{lines[0]:g} Hz at {machine.speed:g}")]

    monkeypatch.setattr(steady_state, "line_names", named)
    rms = {"top": np.array([1.0, 9.0, 3.0]), "side": np.array([1.0, 4.0, 11.0]), "still": np.zeros(3)}
    machine: Any = SimpleNamespace(at_speed=at_speed)
    curve: Any = SimpleNamespace(speeds=speeds, motion=lambda place: speeds[place])
    top, side = steady_state._loudest(machine, curve, rms)
    assert (top.sensor, top.speed, top.rms, top.mode) == ("top", 20.0, 9.0, 1)
    assert (side.sensor, side.speed, side.rms, side.mode) == ("side", 40.0, 11.0, 2)
    assert (top.mode_hz, side.mode_hz) == pytest.approx((300.0, 700.0))
    # 2 × 6 - 1 × 1 in phase; 3 × 5 of the second mode alone.
    assert (top.frequency, top.amplitude, top.share) == pytest.approx((8.0, 11.0, 12.0 / 11.0))
    assert (side.frequency, side.amplitude, side.share) == pytest.approx((18.0, 15.0, 1.0))
    assert (top.excitation, side.excitation) == ("8 Hz at 20", "18 Hz at 40")
