"""Detectability by records whose indicators are known: noise, earlier records, thresholds and sizes that are seen."""

import numpy as np
import pytest

from gearwhine.coupling.analyses.gear_condition import INDICATORS
from gearwhine.detection.detectability import Monitor, Observation, detectability, detected_parts
from gearwhine.detection.records import band_noise, indicator_values, watched_signal
from gearwhine.detection.samples import AVERAGE, BASELINE, FAULTY, HEALTHY, REFERENCE, SIGNAL, detection_design
from gearwhine.variation.quantities import Evaluation

N, TEETH, TURN, LIMIT = 256, 23, 20.0, 2000.0
ANGLES = 2.0 * np.pi * np.arange(N) / N


def _record(pulse: float, mesh: float = 3.0) -> Evaluation:
    """A mesh tone and an order 41 of some size, at 12 turns."""
    average = mesh * np.cos(TEETH * ANGLES) + pulse * np.cos(41 * ANGLES)
    numbers = {"limit_hz": LIMIT, "interval_s": 1.0 / (N * TURN), "turn_hz": TURN, "teeth": float(TEETH)}
    curves = {f"{SIGNAL}{name}": np.tile(average, 12) for name in ("near", "far")}
    curves |= {f"{AVERAGE}near": average, f"{AVERAGE}far": 0.1 * average}
    return Evaluation(numbers | {"steady": 1.0, "turns": 12.0}, curves)


def test_noise_has_its_rms_value_below_its_band_and_none_above() -> None:
    rng = np.random.default_rng(1)
    for count, band in ((4096, 0.25), (4097, 0.1), (256, 0.39)):
        noise = np.array([band_noise(rng, count, band, 2.0) for _ in range(200)])
        assert np.sqrt(np.mean(noise**2)) == pytest.approx(2.0, rel=0.02)
        lines = np.abs(np.fft.rfft(noise, axis=1)).max(axis=0)
        assert lines[np.fft.rfftfreq(count) > band].max() < 1e-9 * lines.max()


def test_the_noise_of_an_average_falls_with_the_root_of_its_turns() -> None:
    rng = np.random.default_rng(2)
    clean = watched_signal(_record(0.0), "near")
    parts = [watched_signal(_record(0.0), "near", 0.8, 64, rng) for _ in range(300)]
    of_average = [np.std(one.average.samples - clean.average.samples) for one in parts]
    of_signal = [np.std(one.signal - clean.signal) for one in parts]
    assert np.sqrt(np.mean(np.square(of_average))) == pytest.approx(0.8 / 8.0, rel=0.02)
    assert np.sqrt(np.mean(np.square(of_signal))) == pytest.approx(0.8, rel=0.02)


def test_indicators_are_those_over_the_earlier_record() -> None:
    now, before = _record(0.6), _record(0.2)
    earlier = watched_signal(before, "near")
    watched = watched_signal(now, "near", healthy=earlier.average)
    names = ["difference_rms", "change_rms", "na4", "rms", "fm4", "spectral_kurtosis"]
    values, reasons = indicator_values(watched, names, earlier)
    # Of a cosine: mean square a²/2 and fourth moment 3/8 a⁴.
    assert values[0] == pytest.approx(3.0, rel=1e-9)
    assert values[1] == pytest.approx(0.4 / np.sqrt(2.0), rel=1e-9)
    assert values[2] == pytest.approx(0.375 * 0.6**4 / (0.5 * 0.2**2) ** 2, rel=1e-9)
    assert values[3] == pytest.approx(np.sqrt((9.0 + 0.36) / (9.0 + 0.04)), rel=1e-9)
    assert values[4] == pytest.approx(1.0, rel=1e-9)
    alone, _ = indicator_values(watched, ["spectral_kurtosis"])
    other, _ = indicator_values(earlier, ["spectral_kurtosis"])
    assert values[5] == pytest.approx(alone[0] - other[0])
    assert not any(reasons)
    # A healthy gear without a residual has nothing to compare with.
    perfect = watched_signal(_record(0.0), "near")
    values, reasons = indicator_values(watched_signal(now, "near", healthy=perfect.average), ["fm4"], perfect)
    assert np.isnan(values[0])
    assert "sidebands alone" in reasons[0]


def _monitor(**changes: object) -> Monitor:
    of = {"sensors": ("near", "far"), "indicators": ("difference_rms", "change_rms", "fm4")} | changes
    return Monitor(**({"sensor_noise": 0.1, "averages": 1, "false_alarm": 0.01, "law": "log-normal", "seed": 3} | of))


def _observations(healthy: int = 200, faulty: int = 30) -> list[Observation]:
    sizes = [0.0] * healthy + [size for size in (1.0, 2.0, 3.0, 4.0, 5.0) for _ in range(faulty)]
    shown = {size: _record(0.05 * size) for size in set(sizes)}
    return [Observation(shown[size], shown[0.0], size, number) for number, size in enumerate(sizes)]


def test_the_sensor_that_hears_more_sees_the_smaller_fault() -> None:
    """Order 41 of 0.05 a and, at the far sensor, a tenth of it, in noise of 0.1: only the near one rises above that."""
    parts = detected_parts(_monitor(), _observations())
    by = {(one.sensor, one.indicator): one for one in parts}
    assert list(by) == [(s, i) for s in ("near", "far") for i in ("difference_rms", "change_rms", "fm4")]
    near, far = by["near", "change_rms"], by["far", "change_rms"]
    assert far.a90 is None
    assert near.a90 is not None
    assert near.a90_95 is not None
    # Threshold: noise of both records, 0.1 √2, less the lines left out; the fault adds a²/2 of a known phase.
    assert near.threshold is not None
    assert near.threshold.value == pytest.approx(0.1 * np.sqrt(2.0), rel=0.15)
    level = (near.threshold.value**2 - np.mean(near.healthy) ** 2) ** 0.5
    assert near.a90 == pytest.approx(np.sqrt(2.0) * level / 0.05, rel=0.35)
    assert near.healthy.shape == (200,)
    assert near.responses.shape == (150,)
    again = detected_parts(_monitor(), _observations())
    assert [one.a90 for one in again] == [one.a90 for one in parts]
    other = detected_parts(_monitor(seed=4), _observations())
    assert other[1].threshold != parts[1].threshold


def test_a_fault_against_the_fleet_takes_no_earlier_record() -> None:
    parts = detected_parts(_monitor(has_own_baseline=False), _observations())
    change = next(one for one in parts if (one.sensor, one.indicator) == ("near", "difference_rms"))
    assert change.healthy.mean() == pytest.approx(0.1, rel=0.1)
    assert change.responses[-30:].mean() == pytest.approx(np.sqrt(0.1**2 + 0.25**2 / 2.0), rel=0.05)


def test_indicators_that_are_undefined_of_healthy_gearboxes_have_no_threshold() -> None:
    parts = detected_parts(_monitor(sensor_noise=0.0), _observations(20, 2))
    assert parts[2].threshold is None
    assert "sidebands alone" in parts[2].undefined
    negative = np.random.default_rng(5).normal(size=50)
    found = detectability("s", "spectral_kurtosis", negative, np.repeat([1.0, 2.0], 9), np.ones(18), 0.01, "log-normal")
    assert found.threshold is not None
    assert found.threshold.law == "normal"


def test_the_samples_of_a_study_are_other_gearboxes_with_earlier_records() -> None:
    cube = np.random.default_rng(6).random((9, 3))
    design = detection_design(cube, [1e-3, 2e-3], 5, 2, [2])
    kinds = design.points[:, 0]
    assert kinds.tolist() == [REFERENCE] + [HEALTHY] * 5 + [FAULTY] * 4 + [BASELINE] * 9
    assert design.points[6:10, 1].tolist() == [1e-3, 1e-3, 2e-3, 2e-3]
    for number in range(9):
        own, earlier = design.points[design.gearbox(number), 3:], design.points[design.baseline(number), 3:]
        assert own.tolist() == cube[number].tolist()
        assert earlier[:2].tolist() == own[:2].tolist()
        assert earlier[2] != own[2]
    # Every record has a number of its own, which a further size leaves as it is.
    assert len(set(design.points[:, 2])) == len(design.points)
    less = detection_design(cube[:7], [1e-3], 5, 2, [2])
    for number in range(7):
        for place in ("gearbox", "baseline"):
            same = [one.points[getattr(one, place)(number), 2] for one in (less, design)]
            assert same[0] == same[1]
    fleet = detection_design(cube, [1e-3, 2e-3], 5, 2)
    assert len(fleet.points) == 10
    assert {fleet.baseline(number) for number in range(9)} == {0}
    assert set(INDICATORS) >= {"fm0", "fm4", "m6a", "m8a", "na4", "energy_ratio", "sideband_index"}


def _spalled(size: float, tone: float = 87.3) -> Evaluation:
    """A carrier that a bearing's tone modulates wholly, heard by three sensors: A = size, size / 2 and size / 4."""
    times = np.arange(12 * N) / (N * TURN)
    struck = size * (1.0 + np.cos(2.0 * np.pi * tone * times)) * np.cos(2.0 * np.pi * 0.75 * LIMIT * times)
    numbers = {"limit_hz": LIMIT, "interval_s": 1.0 / (N * TURN), "turn_hz": TURN, "teeth": float(TEETH)}
    gains = {"near": 1.0, "middle": 0.5, "far": 0.25}
    curves = {f"{SIGNAL}{name}": gain * struck for name, gain in gains.items()}
    curves |= {f"{AVERAGE}{name}": np.cos(TEETH * ANGLES) for name in gains}
    return Evaluation(numbers | {"steady": 1.0, "turns": 12.0, "tone_hz": tone}, curves)


def test_sensors_see_a_spalled_bearing_in_the_order_in_which_they_hear_it() -> None:
    """The squared envelope has 2 A² at the tone over a mean of 3/2 A² + σ²: sizes that are seen are as 1, 2 and 4.

    The spectral kurtosis, -1/18 of this modulation alone and lower than that of noise, sees it at none.
    """
    sizes = 0.02 * 2.0 ** (0.5 * np.arange(9))
    shown = {float(size): _spalled(float(size)) for size in (0.0, *sizes)}
    of_each = [0.0] * 100 + [float(size) for size in sizes for _ in range(6)]
    monitor = _monitor(
        sensors=("far", "near", "middle"), indicators=("envelope", "spectral_kurtosis"), has_own_baseline=False
    )
    parts = detected_parts(monitor, [Observation(shown[size], shown[0.0], size, n) for n, size in enumerate(of_each)])
    seen = {one.sensor: one for one in parts if one.indicator == "envelope"}
    found = {sensor: one.a90 or np.inf for sensor, one in seen.items()}
    assert found["middle"] / found["near"] == pytest.approx(2.0, rel=0.2)
    assert found["far"] / found["middle"] == pytest.approx(2.0, rel=0.2)
    assert all(one.a90 is None for one in parts if one.indicator == "spectral_kurtosis")
    largest = seen["near"].responses[-6:].mean()
    assert largest == pytest.approx(2.0 * sizes[-1] ** 2 / (1.5 * sizes[-1] ** 2 + 0.1**2), rel=0.03)
