"""Outputs of a machine's lines and the loudest of them by sound: closed forms, differences, weighting A."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearwhine.coupling.linear.line_outputs import LineOutput, SensorAmplitude, SoundPower
from gearwhine.coupling.linear.mesh_harmonics import Response
from gearwhine.coupling.sound import mesh_harmonics

GENERATOR = np.random.default_rng(4)
W, HOUSING = 2.0 * np.pi * 800.0, slice(1, 4)
ROOT = GENERATOR.normal(size=(3, 3))
RESISTANCE = ROOT @ ROOT.T
ROW, SHIFT = np.array([0.0, 0.4, -1.2, 0.7, 0.0]), np.array([0.3, 0.1, -0.2])
MOTION, WAY = (GENERATOR.normal(size=5) + 1j * GENERATOR.normal(size=5) for _ in range(2))
OUTPUTS: dict[str, LineOutput] = {
    "sensor": SensorAmplitude("top", ROW, HOUSING),
    "sound": SoundPower(W, RESISTANCE, HOUSING),
}
RATES: Any = SimpleNamespace(sensors=[{"side": SHIFT}, {"top": SHIFT}], powers=[{W: 0.7}, {2.0 * W: 5.0}])


def test_an_amplitude_is_of_the_sensor_and_a_power_of_the_housing_s_rates() -> None:
    assert OUTPUTS["sensor"].value(W, MOTION) == pytest.approx(abs(-(W**2) * ROW @ MOTION), rel=1e-12)
    rates = 1j * W * MOTION[HOUSING]
    power = 0.5 * (rates.conj() @ RESISTANCE @ rates).real
    assert OUTPUTS["sound"].value(W, MOTION) == pytest.approx(power, rel=1e-12)
    # Ten times the motion.
    for output, more in ((OUTPUTS["sensor"], 10.0), (OUTPUTS["sound"], 100.0)):
        ratio = output.value(W, 10.0 * MOTION) / output.value(W, MOTION)
        assert (ratio, output.decibels * np.log10(ratio)) == pytest.approx((more, 20.0))


@pytest.mark.parametrize("name", OUTPUTS)
def test_adjoint_loads_and_slopes_are_those_of_differences(name: str) -> None:
    output, step = OUTPUTS[name], 1e-6
    more, less = (output.value(W, MOTION + way * WAY) for way in (step, -step))
    assert (output.adjoint_load(W, MOTION) @ WAY).real == pytest.approx((more - less) / (2.0 * step), rel=1e-6)
    # Number of the parameter that moves this sensor, or has a power at this frequency, which is linear in its step.
    of_own, step = {"sensor": (1, 1e-6), "sound": (0, 1e3)}[name]
    for number in (0, 1):
        more, less = (output.moved(RATES, number, way).value(W, MOTION) for way in (step, -step))
        slope = output.by_housing(RATES, number, W, MOTION)
        assert slope == pytest.approx((more - less) / (2.0 * step), rel=1e-4, abs=1e-6)
        assert (slope != 0.0) is (number == of_own)


@dataclass(frozen=True)
class Gradient:
    """Power gradient of a housing whose three coordinates radiate alike."""

    frequency_hz: float

    @property
    def resistance(self) -> Any:
        return np.eye(3)

    @property
    def unit(self) -> Any:
        return self

    def sound(self, rates: Any) -> Any:
        return SimpleNamespace(require_proofs=lambda: PROVED.append((self.frequency_hz, rates)))


PROVED: list[Any] = []


def test_the_loudest_lines_are_those_of_the_most_weighted_power(monkeypatch: pytest.MonkeyPatch) -> None:
    """IEC 61672 takes 19.1 dB from 100 Hz and 3.2 dB from 500 Hz, and gives 1.2 dB to 2 kHz and 1.0 dB to 4 kHz."""
    weights = {100.0: -19.1, 500.0: -3.2, 1000.0: 0.0, 2000.0: 1.2, 4000.0: 1.0}
    levels = {100.0: 98.0, 500.0: 88.0, 1000.0: 80.0, 2000.0: 85.0, 4000.0: 50.0, 10.0: 150.0}
    direction = np.array([0.0, 0.6, 0.0, 0.8, 0.0])
    responses = []
    for hertz, level in levels.items():
        w = 2.0 * np.pi * hertz
        responses.append(Response(w, (), np.sqrt(2.0 * 10.0 ** (0.1 * level - 12.0)) / w * direction + 0j))

    def line(output: SoundPower, response: Response) -> Any:
        value = output.value(response.frequency, response.motion)
        return SimpleNamespace(output=output, value=value, frequency=response.frequency, motion=response.motion)

    def responses_below(limit: float) -> list[Response]:
        asked.append(limit)
        return responses

    asked: list[float] = []
    model: Any = SimpleNamespace(housing=HOUSING, responses=responses_below, line=line)
    radiation: Any = SimpleNamespace(
        area=0.5,
        medium=SimpleNamespace(speed_of_sound=343.0),
        equivalent_power=lambda rates: 0.5 * np.sum(np.abs(rates) ** 2, axis=0),
    )
    monkeypatch.setattr(mesh_harmonics.PowerGradient, "at", staticmethod(lambda _, hertz: Gradient(hertz)))
    PROVED.clear()
    found = mesh_harmonics.loudest_lines(model, radiation, 9.0)
    assert asked == [9.0]
    hertz = [one.line.frequency / (2.0 * np.pi) for one in found]
    expected = sorted(weights, key=lambda one: -levels[one] - weights[one])[:3]
    assert expected == [2000.0, 500.0, 1000.0]
    assert hertz == pytest.approx(expected)
    for one, at in zip(found, expected, strict=True):
        assert 10.0 * np.log10(one.weighting) == pytest.approx(weights[at], abs=0.06)
        assert 10.0 * np.log10(one.line.value / 1e-12) == pytest.approx(levels[at], abs=1e-6)
    # Those that are taken are proved, by the rates of their own motion.
    for (at, rates), one in zip(PROVED, found, strict=True):
        assert 2.0 * np.pi * at == pytest.approx(one.line.frequency)
        np.testing.assert_allclose(rates, 1j * one.line.frequency * one.line.motion[HOUSING])
    (known,) = mesh_harmonics.loudest_lines(model, radiation, 9.0, [responses[4].frequency])
    assert known.line.frequency == responses[4].frequency
