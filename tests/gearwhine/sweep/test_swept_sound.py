"""Sound of a sweep's points, held against levels, weights and frequencies that this test computes on its own."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from sounding_gearbox import QUICK, sounding_gearbox, sounding_housing, swept_point

from gearwhine.case.swept_keys import swept_keys
from gearwhine.coupling.sound.solution import build_radiation
from gearwhine.coupling.sweep.line_sound import interpolated_line_sound
from gearwhine.coupling.sweep.reduced_motion import ReducedMotion
from gearwhine.solve.acoustics import acoustics_of
from gearwhine.sweep.solution import PointResult
from gearwhine.sweep.sound import _entry, add_sound

SPEEDS = (60.0, 90.0)  # of the first driver at the two points [Hz]
# Of each point: order of the line, its name by the order, housing mode that moves, and its rate.
LINES = (
    ((28.0, "1x", 3, 2e-4), (2.0, "shaft", 4, 5e-9), (14.0, "half", 5, 7e-4), (7.0, "quarter", 4, 3e-4)),
    ((3.5, "eighth", 6, 4e-4), (28.0, "1x", 3, 1e-3), (7.0, "quarter", 5, 1e-9), (20.0, "20x", 3, 6e-4)),
)
ORDERS = {name: order for point in LINES for order, name, *_ in point}


def a_weighting(hertz: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """A-weighting of IEC 61672-1:2013, equation E.6, with its rounded pole frequencies [dB]."""
    square = hertz**2
    poles = (square + 20.6**2) * np.sqrt((square + 107.7**2) * (square + 737.9**2)) * (square + 12194.0**2)
    return np.asarray(20.0 * np.log10(12194.0**2 * square**2 / poles) + 2.0)


def together(levels: npt.ArrayLike) -> float:
    """Level of the sum of powers [dB]."""
    return float(10.0 * np.log10(np.sum(10.0 ** (0.1 * np.asarray(levels)))))


@pytest.fixture(scope="module")
def sounds() -> list[dict[str, Any]]:
    """Two points of four lines, one of them too faint to be solved: neither the first nor the last."""
    case = sounding_gearbox(QUICK).case
    size = build_radiation(acoustics_of(case), sounding_housing().displacement_field).modal[0].shape[1]
    swept = []
    for speed, lines in zip(SPEEDS, LINES, strict=True):
        rates = np.zeros((len(lines), size, 2))
        for place, (_, _, mode, rate) in enumerate(lines):
            rates[place, mode, place % 2] = rate
        outcome = PointResult(
            {},
            ReducedMotion(
                np.zeros(0),
                line_frequencies=np.array([order * speed for order, *_ in lines]),
                line_rates=rates,
                line_names=tuple(name for _, name, *_ in lines),
                line_kinds=tuple("mesh" if "x" in name else "other" for _, name, *_ in lines),
            ),
        )
        turned = sounding_gearbox(QUICK | {"operation.speed": f"{60.0 * speed} rpm"}).case
        swept.append(swept_point(turned, f"{60.0 * speed} rpm", outcome))
    keys = swept_keys(case, [f"operation.speed={','.join(f'{60.0 * speed} rpm' for speed in SPEEDS)}"])
    add_sound(case, keys, swept, sounding_housing())
    return [one.outcome.document["sound"] for one in swept]


def test_a_line_has_its_own_name_frequency_and_order(sounds: list[dict[str, Any]]) -> None:
    for speed, sound, lines in zip(SPEEDS, sounds, LINES, strict=True):
        faint = min(lines, key=lambda line: line[3])[1]
        assert {line["name"] for line in sound["lines"]} == {name for _, name, *_ in lines} - {faint}
        for line in sound["lines"]:
            assert line["order"] == pytest.approx(ORDERS[line["name"]], rel=1e-12)
            assert line["frequency_hz"] == pytest.approx(ORDERS[line["name"]] * speed, rel=1e-12)
            assert line["kind"] == ("mesh" if "x" in line["name"] else "other")


def test_a_line_s_mode_is_the_one_that_moves(sounds: list[dict[str, Any]]) -> None:
    for sound, lines in zip(sounds, LINES, strict=True):
        moving = {name: mode + 1 for _, name, mode, _ in lines}
        for line in sound["lines"]:
            (part,) = line["contributions"]["housing_modes"]
            assert (part["name"], part["share"]) == (f"housing mode {moving[line['name']]}", pytest.approx(1.0))
        loudest = max(sound["lines"], key=lambda line: line["sound_power_db"])
        told = sound["loudest"]
        assert (told["name"], told["mode"]) == (loudest["name"], moving[loudest["name"]])
        natural = sounding_housing().modes.frequencies_hz[told["mode"] - 1]
        assert told["mode_frequency_hz"] == pytest.approx(natural, rel=1e-12)


def test_totals_are_sums_of_powers_without_and_with_the_weights_of_their_frequencies(
    sounds: list[dict[str, Any]],
) -> None:
    for sound in sounds:
        levels = np.array([line["sound_power_db"] for line in sound["lines"]])
        weights = a_weighting(np.array([line["frequency_hz"] for line in sound["lines"]]))
        assert [line["sound_power_db_a"] for line in sound["lines"]] == pytest.approx(levels + weights, abs=0.02)
        assert sound["total_db"] == pytest.approx(together(levels), abs=1e-9)
        assert sound["total_db_a"] == pytest.approx(together(levels + weights), abs=0.02)
        assert abs(sound["total_db_a"] - sound["total_db"]) > 0.5
        assert levels.tolist() == sorted(levels, reverse=True)


def test_a_rate_twice_as_large_is_six_decibels_louder(sounds: list[dict[str, Any]]) -> None:
    """Lines of one mode that differ in rate and frequency: 20 log of the rates, and of the efficiencies."""
    first, second = ({line["name"]: line for line in sound["lines"]} for sound in sounds)
    for one, other, ratio in (
        (second["1x"], first["1x"], 1e-3 / 2e-4),
        (second["20x"], second["1x"], 6e-4 / 1e-3),
    ):
        efficiencies = one["radiation_efficiency"] / other["radiation_efficiency"]
        found = one["sound_power_db"] - other["sound_power_db"]
        assert found == pytest.approx(20.0 * np.log10(ratio) + 10.0 * np.log10(efficiencies), abs=1e-6)


def test_an_interpolated_line_has_the_figures_of_its_table() -> None:
    """Powers of the far field and of the surface 2 % apart; pressures and proofs of their own at each place."""
    rates = np.array([3e-3 + 0.0j, 4e-3j])
    table: Any = SimpleNamespace(
        holds=lambda hertz: hertz == 1000.0,
        power=lambda hertz, _: (2e-6, 2.04e-6, 1e-3),
        pressure_error=1e-3,
        interior_residual=np.array([0.0125]),
        source_error=np.array([0.025]),
        source_rms=np.array([0.0075]),
        point_source_error=np.array([0.001]),
        around=lambda hertz, values: float(values[0]),
        pressure_at=lambda hertz: np.array([[[2.0, 0.0], [0.0, 50.0]]]),
        by_mode=lambda hertz, _: np.array([1.5e-6, 0.5e-6]),
    )
    radiation: Any = SimpleNamespace(method="boundary-elements", equivalent_power=lambda _: np.array([8e-6]))
    places = {"near": np.zeros(3), "far": np.ones(3)}
    line = interpolated_line_sound(table, radiation, 1000.0, rates, places)
    assert line is not None
    entry = _entry(line, 1)
    assert entry["sound_power_db"] == pytest.approx(10.0 * np.log10(2e-6 / 1e-12), abs=1e-9)
    # A-weighting is nothing at 1 kHz, by its definition.
    assert entry["sound_power_db_a"] == pytest.approx(entry["sound_power_db"], abs=0.01)
    assert entry["power_balance_db"] == pytest.approx(10.0 * np.log10(1.02), abs=1e-9)
    assert entry["radiation_efficiency"] == pytest.approx(0.25)
    assert (entry["interior_pressure"], entry["known_source_error"], entry["known_source_rms"]) == (
        0.0125,
        0.025,
        0.0075,
    )
    # Peak amplitudes of 6 mPa and 200 mPa, re 20 µPa rms.
    heard = {"near": 20.0 * np.log10(6e-3 / np.sqrt(2.0) / 20e-6), "far": 20.0 * np.log10(0.2 / np.sqrt(2.0) / 20e-6)}
    assert entry["microphones_db"] == pytest.approx(heard, abs=1e-9)
    assert entry["contributions"]["housing_modes"] == [
        {"name": "housing mode 1", "share": pytest.approx(0.75)},
        {"name": "local compliance", "share": pytest.approx(0.25)},
    ]
    assert interpolated_line_sound(table, radiation, 1001.0, rates, places) is None
