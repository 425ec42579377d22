"""Records that hold whole periods of all that excites the machine, and records that do not: windows and names."""

import numpy as np
import pytest

import gearwhine as gw
from coupling.signals.spectrum import Spectrum
from coupling.signals.tones import hann_tones
from gearwhine.case import load_case
from gearwhine.solve.machine import solve_machine
from gearwhine.solve.transient_record import Sampling, sampling

SHAFT = 5500.0 / 60.0  # both shafts of the pair [Hz]
# 9 balls of 9 mm on a pitch circle of 46 mm pass 9/2 (1 - 9/46) = 333/92 times in a revolution.
BALLS = '{rolling={count=9, element_diameter="9 mm", pitch_diameter="46 mm", clearance="6 um", law="nonlinear"}}'


def ripple(pace: str) -> str:
    return f"operation.ripple=[{{amplitude='10 N*m', {pace}}}]"


def over_time(revolutions: float) -> str:
    """A torque that rises until the end of a revolution."""
    return f"operation.over_time={{time=['0 s','{revolutions / SHAFT:.9g} s'], torque=['0 N*m','5 N*m']}}"


def sampled(*settings: str, recorded: int = 7, largest: int = 1 << 27) -> Sampling:
    """Sampling of the spur pair's record of some revolutions after seven."""
    turns = (f"transient.revolutions={7 + recorded}", "transient.discard=7")
    case = load_case("spur-pair", (*turns, *settings)).case
    _, _, machine = solve_machine(case)
    return sampling(case, machine.system, None, 1e3, 40, 200, largest=largest)


@pytest.mark.parametrize(
    ("setting", "recorded", "window"),
    [
        (ripple("order=2"), 7, "uniform"),
        (ripple("order=2.5"), 7, "hann"),
        (ripple("order=2.5"), 8, "uniform"),
        (ripple("frequency='412.5 Hz'"), 7, "hann"),  # 4.5 times in a revolution
        (ripple("frequency='412.5 Hz'"), 8, "uniform"),
        ("operation.base.harmonic=[{frequency='412.5 Hz', x='1 m/s^2'}]", 7, "hann"),
        ("operation.base.harmonic=[{frequency='412.5 Hz', x='1 m/s^2'}]", 8, "uniform"),
        (over_time(6.5), 7, "uniform"),
        (over_time(9.0), 7, "hann"),
        (f"bearing.input-back.stiffness={BALLS}", 10, "hann"),
        (f"bearing.input-back.stiffness={BALLS}", 92, "uniform"),
    ],
)
def test_lines_are_exact_where_every_excitation_makes_whole_periods(setting: str, recorded: int, window: str) -> None:
    assert sampled(recorded=recorded).window == "uniform"  # the shafts alone turn whole times
    assert sampled(setting, recorded=recorded).window == window


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
    settings |= {"operation.ripple": [{"amplitude": "10 N*m", "frequency": "412.5 Hz"}]}
    result = gw.load("spur-pair", settings).run()
    solved = result.solved.transient
    assert solved is not None
    name = next(contact.name for contact in solved.machine.system.contacts if contact.loaded)
    force, times = solved.histories.mesh_force[name], solved.histories.times
    teeth = [28.0 * harmonic for harmonic in range(1, 9)]
    orders = [4.5, *range(1, 9), *teeth, *(order + side for order in teeth[:3] for side in (-4.5, 4.5))]
    angles = 2.0 * np.pi * SHAFT * np.outer(times, orders)
    parts = np.linalg.lstsq(np.column_stack([np.cos(angles), np.sin(angles), np.ones(len(times))]), force)[0]
    expected = np.hypot(parts[0], parts[len(orders)])
    spectrum = solved.force_spectra[name]
    row = Spectrum(spectrum.frequencies, spectrum.amplitude[None], spectrum.phase[None], spectrum.window)
    tones = hann_tones(row, [1.0])
    (near,) = np.flatnonzero(np.abs(tones.frequencies - 412.5) < 6.0)
    assert tones.frequencies[near] == pytest.approx(412.5, abs=0.1)
    assert abs(tones.amplitudes[0, near]) == pytest.approx(expected, rel=0.01)
    peaks = {peak["name"]: peak for peak in result.document["gear_pairs"][0]["force_peaks"]}
    told = peaks["1× ripple of 412.5 Hz on input"]
    assert told["kind"] == "load"
    assert told["frequency_hz"] == pytest.approx(412.5, abs=0.1)
    assert told["amplitude_n"] == pytest.approx(expected, rel=0.01)
    assert peaks["2× pinion -> wheel - 1× ripple of 412.5 Hz on input"]["kind"] == "sideband"
    assert "mode" not in {peak["kind"] for peak in peaks.values()}
