"""Sound pressure over time of records that do not repeat: levels as they are, ends without clicks."""

import numpy as np
import numpy.typing as npt
import pytest
from sounding_gearbox import sounding_machine

from gearwhine.coupling import CoupledMachine
from gearwhine.coupling.signals.transfer_paths import housing_paths
from gearwhine.coupling.sound.microphones import FADE, fading_weights, microphone_histories
from gearwhine.housing.acoustics.modal_radiation import ModalRadiation
from gearwhine.numerics.arrays import FloatArray

_INTERVAL, _COUNT, _TONE = 1e-4, 8000, 517.3


def transfer(machine: CoupledMachine) -> ModalRadiation:
    """Of two microphones 1 and 2 m off, the rates of the first three modes with other weights."""
    assert machine.housing is not None
    values = np.zeros((5, 2, machine.housing.size), dtype=complex)
    values[:, 0, :3] = [30.0, 20.0, -10.0]
    values[:, 1, :3] = [15.0, 10.0j, 5.0]
    nothing = np.zeros((5, machine.housing.size, machine.housing.size))
    delays = np.array([1.0, 2.0]) / 343.2
    zeros = np.zeros(5)
    return ModalRadiation(
        *(np.linspace(20.0, 3000.0, 5), nothing, nothing, nothing, values, delays),
        *(zeros, zeros, zeros, np.zeros((5, len(delays)))),
    )


def forces_of(machine: CoupledMachine, signal: FloatArray) -> dict[str, FloatArray]:
    """Forces along y of a signal at one bearing, none at the others."""
    shapes = {one.name: one.directions.shape[1] for one in machine.system.linear[: len(machine.bearings)]}
    found = {name: np.zeros((len(signal), axes)) for name, axes in shapes.items()}
    found["input-back"][:, 1] = signal
    return found


def pressure(signal: FloatArray, *, repeats: bool = False) -> FloatArray:
    one = sounding_machine()
    times = _INTERVAL * np.arange(len(signal))
    return microphone_histories(one, transfer(one), times, forces_of(one, signal), repeats=repeats).pressure


def expected() -> npt.NDArray[np.complex128]:
    """Steady complex amplitude at the microphones of a tone of 1 N, from its one line and the way through the air."""
    one = sounding_machine()
    forces = {name: force.astype(complex) for name, force in forces_of(one, np.ones(1)).items()}
    omega = 2.0 * np.pi * np.array([_TONE])
    rates = housing_paths(one, omega, forces).acceleration.sum(axis=1) / (1j * omega[:, None])
    late = np.exp(-1j * omega * np.array([1.0, 2.0]) / 343.2)
    return np.asarray(transfer(one).pressure[0] @ rates[0] * late)


def expected_amplitude() -> FloatArray:
    return np.abs(expected())


def amplitude(heard: FloatArray, within: slice) -> FloatArray:
    """Amplitude of the tone in a stretch, under Hann's window."""
    part = heard[:, within]
    times = _INTERVAL * np.arange(part.shape[1])
    window = np.hanning(part.shape[1])
    return np.asarray(2.0 * np.abs((part * window) @ np.exp(-2j * np.pi * _TONE * times)) / window.sum())


@pytest.mark.slow
def test_a_tone_keeps_its_level_away_from_the_ends_which_are_quiet() -> None:
    heard = pressure(np.cos(2.0 * np.pi * _TONE * _INTERVAL * np.arange(_COUNT) + 0.4))
    steady = expected_amplitude()
    levels = 20.0 * np.log10(amplitude(heard, slice(_COUNT // 4, 3 * _COUNT // 4)) / steady)
    assert np.abs(levels).max() < 0.1
    few = round(0.1 * FADE / _INTERVAL)
    assert np.abs(heard[:, :few]).max() < 0.03 * steady.min()
    assert np.abs(heard[:, -few:]).max() < 0.03 * steady.max()
    assert not heard[:, 0].any()
    # Up to the end of the record less what fades there is the tone.
    late = slice(_COUNT - round(FADE / _INTERVAL) - 1500, _COUNT - round(FADE / _INTERVAL))
    assert np.abs(20.0 * np.log10(amplitude(heard, late) / steady)).max() < 0.1


@pytest.mark.slow
def test_a_load_that_rises_is_no_sound() -> None:
    """A ramp from 0 to 2 kN under a tone of 1 N: its step at the end would be a click."""
    times = _INTERVAL * np.arange(_COUNT)
    tone = np.cos(2.0 * np.pi * _TONE * times)
    assert pressure(tone + 2500.0 * times + 300.0) == pytest.approx(
        pressure(tone), abs=1e-3 * expected_amplitude().max()
    )


def test_nothing_is_louder_than_the_tone_where_it_begins_and_ends() -> None:
    heard = pressure(np.cos(2.0 * np.pi * _TONE * _INTERVAL * np.arange(_COUNT)))
    assert np.all(np.abs(heard).max(axis=1) < 1.15 * expected_amplitude())


def test_whole_periods_do_not_fade() -> None:
    """A record of whole periods begins as it ends."""
    whole = round(200.0 / (_TONE * _INTERVAL))
    interval = 200.0 / _TONE / whole
    one = sounding_machine()
    times = interval * np.arange(whole)
    signal = np.cos(2.0 * np.pi * _TONE * times)
    heard = microphone_histories(one, transfer(one), times, forces_of(one, signal), repeats=True).pressure
    turned = np.exp(-2j * np.pi * _TONE * times)
    steady = 2.0 * (heard @ turned) / whole
    np.testing.assert_allclose(steady, expected(), rtol=1e-6)
    assert heard == pytest.approx((steady[:, None] * turned.conj()).real, abs=1e-6 * expected_amplitude().max())


def test_a_short_record_fades_over_half_of_itself_at_most() -> None:
    weights = fading_weights(100, 1e-3)
    assert (weights[0], weights[-1]) == (0.0, 0.0)
    assert np.all(weights[20:80] == 1.0)
    assert np.all(weights[:20] < 1.0)
    assert weights[10] == pytest.approx(0.5)
    assert np.flatnonzero(fading_weights(16, 1e-3) == 1.0).tolist() == list(range(4, 12))
