"""Records that hold whole periods of all that excites the machine, and records that do not: windows and names."""

import numpy as np
import pytest
from coupled_cases import about_operating_point

import gearwhine as gw
from gearwhine.case import load_case
from gearwhine.coupling import CouplingError
from gearwhine.coupling.analyses.recording import Sampling, TransientPlan, sampling
from gearwhine.coupling.signals.spectrum import Spectrum, amplitude_spectrum
from gearwhine.coupling.signals.tones import hann_tones
from gearwhine.solve.machine import plan_of
from tests.machines.turning_set import turning_machine

pytestmark = pytest.mark.usefixtures("mechanisms_left_out")

SHAFT = 5500.0 / 60.0  # both shafts of the pair [Hz]
# 9 balls of 9 mm on a pitch circle of 46 mm pass 9/2 (1 - 9/46) = 333/92 times in a revolution.
BALLS = '{rolling={count=9, element_diameter="9 mm", pitch_diameter="46 mm", clearance="6 um", law="nonlinear"}}'


def ripple(pace: str) -> str:
    return f"operation.ripple=[{{amplitude='10 N*m', {pace}}}]"


def over_time(revolutions: float) -> str:
    """A torque that rises until the end of a revolution."""
    return f"operation.over_time={{time=['0 s','{revolutions / SHAFT:.9g} s'], torque=['0 N*m','5 N*m']}}"


# Of the machine its excitations count here: teeth of one stiffness and shafts of few modes have them all.
PLAIN = ("gear_pair.0.stiffness={model='constant', value='2e8 N/m'}", "rotor.*.modes=2")


def sampled(*settings: str, recorded: float = 7, largest: int = 1 << 27) -> Sampling:
    """Sampling of the spur pair's record of some revolutions after seven."""
    turns = (f"transient.revolutions={7 + recorded}", "transient.discard=7")
    case = load_case("spur-pair", (*turns, *PLAIN, *settings)).case
    machine = about_operating_point(case).coupled
    return sampling(machine, plan_of(case), 1e3, 40, 200, largest=largest)


@pytest.mark.parametrize(
    ("setting", "recorded", "window", "turns"),
    [
        (ripple("order=2"), 7, "uniform", 7),
        (ripple("order=2.5"), 7, "uniform", 6),
        (ripple("order=2.5"), 8, "uniform", 8),
        (ripple("order=2.5"), 1, "hann", 1),
        (ripple("frequency='412.5 Hz'"), 7, "uniform", 6),  # 4.5 times in a revolution
        (ripple("frequency='412.51 Hz'"), 7, "hann", 7),
        (ripple("order=2"), 10.3, "uniform", 10),
        (ripple("order=2.5"), 10.3, "uniform", 10),
        (ripple("frequency='412.51 Hz'"), 10.3, "hann", 10),  # the teeth meet whole times in it
        (ripple("order=2"), 0.3, "hann", 0.3),
        ("operation.base.harmonic=[{frequency='412.5 Hz', x='1 m/s^2'}]", 7, "uniform", 6),
        ("operation.base.harmonic=[{frequency='412.51 Hz', x='1 m/s^2'}]", 7, "hann", 7),
        (over_time(6.5), 7, "uniform", 7),
        (over_time(9.0), 7, "hann", 7),
        (over_time(9.0), 7.4, "hann", 7),
        (f"bearing.input-back.stiffness={BALLS}", 10, "hann", 10),
        (f"bearing.input-back.stiffness={BALLS}", 92, "uniform", 92),
    ],
)
def test_lines_are_exact_where_every_excitation_makes_whole_periods(
    setting: str, recorded: float, window: str, turns: float
) -> None:
    chosen = sampled(setting, recorded=recorded)
    assert chosen.window == window
    assert chosen.stretch * chosen.interval * SHAFT == pytest.approx(turns, rel=1e-3)


TURN = 1.0 / SHAFT


def zigzag(cycles: int) -> str:
    """A torque that rises and falls so often in the eighth revolution."""
    times = [f"{TURN * (7.0 + 0.5 * number / cycles):.12g} s" for number in range(2 * cycles)]
    values = [f"{10.0 * (-1) ** number:g} N*m" for number in range(len(times))]
    return f"operation.over_time={{time={times}, torque={values}}}"


@pytest.mark.parametrize(
    ("setting", "highest"),
    [
        (ripple("frequency='600 kHz'"), 600e3),
        (ripple("order=4000"), 4000.0 * SHAFT),
        ("operation.base.harmonic=[{frequency='600 kHz', x='1 m/s^2'}]", 600e3),
        (zigzag(4000), 4000.0 * SHAFT),
    ],
)
def test_no_excitation_folds_down_to_a_lower_line(setting: str, highest: float) -> None:
    """Sampling theorem: half the sampling rate lies above all that excites, and above its third harmonic."""
    assert 0.5 / sampled(recorded=1).settings.sample_interval < highest
    assert 0.5 / sampled(setting, recorded=1).settings.sample_interval > 3.0 * highest


def test_a_step_over_time_asks_for_no_more_than_its_own_spectrum() -> None:
    """The lines of a step fall as 1 / f: that it takes a nanosecond says nothing of its height there."""
    step = "operation.over_time={time=['0.1 s','0.100000001 s'], torque=['0 N*m','5 N*m']}"
    plain, stepped = sampled(recorded=7), sampled(step, recorded=7)
    assert stepped.settings.samples <= 4 * plain.settings.samples


def test_samples_without_end_are_refused() -> None:
    with pytest.raises(CouplingError, match="an excitation at 1e\\+07 Hz"):
        sampled(ripple("frequency='10 MHz'"), recorded=3000)


@pytest.mark.parametrize("recorded", [10.3, 7.71])
def test_a_tone_keeps_its_height_in_a_record_of_no_whole_number_of_revolutions(recorded: float) -> None:
    """A tone of the teeth, 28 a turn, beside one of the shaft: each exact in the last whole revolutions."""
    chosen = sampled(recorded=recorded)
    times = chosen.settings.record_from + chosen.interval * np.arange(chosen.settings.samples)
    tone = 81.1 * np.cos(2.0 * np.pi * 28.0 * SHAFT * times + 0.3) + 7.0 * np.sin(2.0 * np.pi * SHAFT * times) + 900.0
    spectrum = amplitude_spectrum(tone[-chosen.stretch :], chosen.interval, chosen.window)
    for order, height in ((28.0, 81.1), (1.0, 7.0), (0.0, 900.0)):
        nearest = int(np.argmin(np.abs(spectrum.frequencies - order * SHAFT)))
        assert spectrum.amplitude[nearest] == pytest.approx(height, rel=1e-4)


@pytest.mark.parametrize(
    ("setting", "revolutions"), [(ripple("frequency='412.5 Hz'"), 2), (f"bearing.input-back.stiffness={BALLS}", 92)]
)
def test_stretches_of_a_long_record_hold_whole_periods(setting: str, revolutions: int) -> None:
    chosen = sampled(setting, recorded=2000, largest=0)
    turns = chosen.stretch * chosen.interval * SHAFT
    assert chosen.window == "uniform"
    assert turns == pytest.approx(revolutions * round(turns / revolutions), rel=1e-9)
    # 412.51 Hz repeats with the shafts after 27500 revolutions only.
    assert sampled(ripple("frequency='412.51 Hz'"), recorded=2000, largest=0).window == "hann"


@pytest.mark.slow
def test_a_ripple_between_the_lines_has_its_frequency_its_height_and_its_name() -> None:
    """Its height by least squares on the history, at the frequencies that the ripple and the teeth can make."""
    settings = {"transient.revolutions": 14, "transient.discard": 7, "transient.tolerance": 1e-3}
    # No number of revolutions of this record has whole periods of it.
    settings |= {"operation.ripple": [{"amplitude": "10 N*m", "frequency": "412.51 Hz"}]}
    result = gw.load("spur-pair", settings).run()
    solved = result.solved.transient
    assert solved is not None
    name = next(contact.name for contact in solved.machine.system.contacts if contact.loaded)
    force, times = solved.histories.mesh_force[name], solved.histories.times
    teeth = [28.0 * harmonic for harmonic in range(1, 9)]
    paced = 412.51 / SHAFT
    orders = [paced, *range(1, 9), *teeth, *(order + side for order in teeth[:3] for side in (-paced, paced))]
    angles = 2.0 * np.pi * SHAFT * np.outer(times, orders)
    parts = np.linalg.lstsq(np.column_stack([np.cos(angles), np.sin(angles), np.ones(len(times))]), force)[0]
    expected = np.hypot(parts[0], parts[len(orders)])
    spectrum = solved.force_spectra[name]
    row = Spectrum(spectrum.frequencies, spectrum.amplitude[None], spectrum.phase[None], spectrum.window)
    tones = hann_tones(row, [1.0])
    (near,) = np.flatnonzero(np.abs(tones.frequencies - 412.51) < 6.0)
    assert tones.frequencies[near] == pytest.approx(412.51, abs=0.1)
    assert abs(tones.amplitudes[0, near]) == pytest.approx(expected, rel=0.01)
    peaks = {peak["name"]: peak for peak in result.document["gear_pairs"][0]["force_peaks"]}
    told = peaks["1× ripple of 412.51 Hz on input"]
    assert told["kind"] == "load"
    assert told["frequency_hz"] == pytest.approx(412.51, abs=0.1)
    assert told["amplitude_n"] == pytest.approx(expected, rel=0.01)
    assert peaks["2× pinion -> wheel - 1× ripple of 412.51 Hz on input"]["kind"] == "sideband"
    assert "mode" not in {peak["kind"] for peak in peaks.values()}


@pytest.mark.slow
def test_the_spectrum_of_a_run_of_no_whole_number_of_revolutions_is_that_of_its_last_whole_ones() -> None:
    """The mesh's line by least squares on the history of the same whole turns."""
    settings = {"transient.revolutions": 5.3, "transient.discard": 2, "transient.tolerance": 1e-3}
    solved = gw.load("spur-pair", settings).run().solved.transient
    assert solved is not None
    name = next(contact.name for contact in solved.machine.system.contacts if contact.loaded)
    spectrum, histories = solved.force_spectra[name], solved.histories
    assert spectrum.window == "uniform"
    assert len(histories.times) * (histories.times[1] - histories.times[0]) * SHAFT == pytest.approx(3.0, rel=1e-9)
    assert histories.times[-1] * SHAFT == pytest.approx(5.3, abs=0.01)
    mesh = 28.0 * SHAFT
    (at,) = np.flatnonzero(np.abs(spectrum.frequencies - mesh) < 1e-6 * mesh)
    fitted = 2.0 * np.mean(histories.mesh_force[name] * np.exp(-2j * np.pi * mesh * histories.times))
    assert spectrum.amplitude[at] == pytest.approx(abs(fitted), rel=1e-6)


@pytest.mark.parametrize(("recorded", "window"), [(108, "uniform"), (100, "hann")])
def test_a_record_of_whole_turns_of_the_carrier_is_whole_whatever_planets_turn(recorded: int, window: str) -> None:
    """A sun of 25 teeth in a ring of 83: the carrier turns 25 times in 108, a planet of 29 after 29 of these."""
    plan = TransientPlan(108 + recorded, discard=108)
    chosen = sampling(turning_machine((900.0, 1300.0)), plan, 1e3, 1, 1, largest=1 << 40)
    assert chosen.window == window
    if window == "uniform":
        turns = chosen.stretch * chosen.settings.sample_interval * 300.0 / (2.0 * np.pi)
        assert turns == pytest.approx(recorded, rel=1e-9)
