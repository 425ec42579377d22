"""Records of a machine's condition of known signals: averages by the turns of each shaft, and indicators of gears."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearwhine.coupling import CouplingError
from gearwhine.coupling.analyses.condition_record import ConditionRecord, condition_record
from gearwhine.coupling.analyses.gear_condition import INDICATORS, envelope_at, machine_condition
from gearwhine.coupling.machine.speed_profile import SpeedProfile

LIMIT = 2000.0
TEETH = (23, 31)
TURN = 20.0  # of the pinion's shaft [Hz]
WHEEL_TURN = TURN * 23.0 / 31.0
MESH = TURN * 23.0


def _transient(signal: Any, rate: float, seconds: float, **changes: Any) -> Any:
    """A motion of two shafts, whose sensor has a signal over time [s]."""
    times = np.arange(round(rate * seconds)) / rate + 3.0
    of = {"carrier": None, "profile": None, "mesh": MESH, "teeth": TEETH, "limit": LIMIT} | changes
    gears = [SimpleNamespace(name=name, tooth_count=teeth) for name, teeth in zip("pw", of["teeth"], strict=True)]
    mounted = [SimpleNamespace(rotor=name) for name in ("input", "output")]
    mesh = SimpleNamespace(
        driver=mounted[0], driven=mounted[1], geometry=SimpleNamespace(driver=gears[0], driven=gears[1])
    )
    machine = SimpleNamespace(
        rotors=[SimpleNamespace(name="input", carrier=of["carrier"]), SimpleNamespace(name="output", carrier=None)],
        meshes=[mesh],
        speeds={"input": 2.0 * np.pi * TURN, "output": -2.0 * np.pi * WHEEL_TURN},
        system=SimpleNamespace(contacts=[SimpleNamespace(mesh_frequency=of["mesh"])]),
    )
    return SimpleNamespace(
        histories=SimpleNamespace(times=times, sensor_acceleration={"top": signal(times)}),
        trusted_limit=of["limit"],
        speed_profile=of["profile"],
        machine=machine,
        record=SimpleNamespace(sampling=SimpleNamespace(interval=1.0 / rate)),
    )


def _pulses(times: np.ndarray, turn: float, orders: range) -> np.ndarray:
    """A pulse in each turn, of unit harmonics of some orders."""
    return np.sum([np.cos(2.0 * np.pi * k * turn * times) for k in orders], axis=0)


def _values(found: Any, gear: str) -> dict[str, Any]:
    return next(one.sensors[0].values for one in found.gears if one.gear.gear == gear)


@pytest.mark.parametrize("rate", [200e3, 8e3])
def test_one_pulse_a_turn_is_in_the_average_of_its_shaft_alone(rate: float) -> None:
    """A pulse of the orders 40 to 80 of the pinion, over a mesh tone: n harmonics of unit size, rms √(n/2)."""
    orders = range(40, 81)

    def signal(times: np.ndarray) -> np.ndarray:
        return 5.0 * np.cos(2.0 * np.pi * MESH * times) + _pulses(times, TURN, orders)

    record = condition_record(_transient(signal, rate, 4.0))
    found = machine_condition(record)
    own, other = _values(found, "p"), _values(found, "w")
    # The mesh harmonics 46 and 69 with their sidebands, 6 of the 41 orders, are no part of the difference signal.
    assert own["difference_rms"] == pytest.approx(np.sqrt((41 - 6) / 2.0), rel=2e-3)
    assert own["rms"] == pytest.approx(np.sqrt(5.0**2 / 2.0 + 41 / 2.0), rel=2e-3)
    assert own["fm4"] > 15.0
    # In 59 turns of the other shaft it falls anywhere.
    assert other["difference_rms"] < 0.2 * own["difference_rms"]
    # No part of the pulse is beside the mesh frequency itself.
    assert own["sideband_index"] < 0.01
    shafts = {gear.gear: (gear.shaft, gear.teeth, gear.turns) for gear in record.gears}
    assert shafts["p"] == ("input", 23, 79)
    assert shafts["w"][0] == "output"
    assert record.signals["top"].size * record.interval == pytest.approx(4.0, abs=0.1)


def test_what_is_beyond_the_limit_is_left_out() -> None:
    def signal(times: np.ndarray) -> np.ndarray:
        return np.cos(2.0 * np.pi * MESH * times) + 9.0 * np.cos(2.0 * np.pi * 120 * TURN * times)

    record = condition_record(_transient(signal, 100e3, 2.0))
    assert _values(machine_condition(record), "p")["rms"] == pytest.approx(np.sqrt(0.5), rel=1e-3)
    assert np.std(record.signals["top"]) == pytest.approx(np.sqrt(0.5), rel=2e-2)


def test_averages_of_a_run_go_by_the_angle() -> None:
    """A speed that rises by half from 3 to 7 s: an order stays one, and spectra of time are undefined."""
    profile = SpeedProfile(np.array([3.0, 7.0]), np.array([1.0, 1.5]))

    def signal(times: np.ndarray) -> np.ndarray:
        angle = 2.0 * np.pi * TURN * profile.at(times)[0]
        return np.cos(23 * angle) + 0.25 * np.cos(41 * angle)

    found = machine_condition(condition_record(_transient(signal, 100e3, 4.0, profile=profile)))
    values = _values(found, "p")
    assert values["difference_rms"] == pytest.approx(0.25 / np.sqrt(2.0), rel=2e-3)
    reasons = found.gears[0].sensors[0].undefined
    assert values["envelope"] is None
    assert "speed varies" in reasons["envelope"] + reasons["spectral_kurtosis"]


@pytest.mark.parametrize(
    ("changes", "seconds", "said"),
    [
        ({}, 0.16, "3 turns"),
        ({"carrier": "carrier"}, 2.0, "turns with its carrier"),
        ({"mesh": 17.0 * TURN}, 2.0, "meshes with planets"),
        ({"limit": 400.0}, 2.0, "beyond the trusted limit"),
    ],
)
def test_gears_without_an_average_say_why(changes: dict[str, Any], seconds: float, said: str) -> None:
    transient = _transient(lambda times: np.cos(2.0 * np.pi * MESH * times), 100e3, seconds, **changes)
    found = machine_condition(condition_record(transient)).gears[0]
    assert said in found.gear.undefined
    assert not found.sensors


def test_a_residual_that_the_turns_do_not_share_is_undefined() -> None:
    """What dies away is no part of a turn; a healthy mesh tone alone has no residual."""

    def settling(times: np.ndarray) -> np.ndarray:
        fading = np.exp(-3.0 * (times - 3.0)) * np.cos(2.0 * np.pi * 40 * TURN * times)
        return np.cos(2.0 * np.pi * MESH * times) + fading

    one = machine_condition(condition_record(_transient(settling, 100e3, 2.0))).gears[0].sensors[0]
    assert one.values["fm4"] is None
    assert "turns differ by" in one.undefined["fm4"]
    assert one.values["fm0"] == pytest.approx(2.0, rel=0.3)
    bare = ConditionRecord(
        LIMIT,
        1e-4,
        condition_record(_transient(settling, 100e3, 2.0)).gears,
        {"top": np.cos(2.0 * np.pi * MESH * 1e-4 * np.arange(20000))},
        {
            (shaft, "top"): np.cos(2.0 * np.pi * teeth * np.arange(512) / 512)
            for shaft, teeth in zip(("input", "output"), TEETH, strict=True)
        },
    )
    tone = machine_condition(bare, ["fm4", "energy_ratio", "na4"]).gears[1].sensors[0]
    assert tone.values["fm4"] is None
    assert "sidebands alone" in tone.undefined["na4"]
    assert tone.values["energy_ratio"] == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(CouplingError, match="expected some of rms"):
        machine_condition(bare, ["fm5"])


@pytest.mark.parametrize("shift", [0.0, 1.0 / 256.0, 1.0 / 384.0])
def test_fm0_finds_peaks_between_coarse_samples(shift: float) -> None:
    """Peak to peak of pulses of orders up to the limit, wherever in the turn they come."""
    orders, fine = range(15, 25), np.arange(4096) / 4096.0
    transient = _transient(lambda times: _pulses(times - shift / TURN, TURN, orders), 100e3, 2.0, limit=25.0 * TURN)
    found = machine_condition(condition_record(transient), ["fm0"])
    assert _values(found, "p")["fm0"] == pytest.approx(np.ptp(_pulses(fine, 1.0, orders)), rel=0.02)


def test_a_bearing_tone_is_a_line_of_the_envelope() -> None:
    """(1 + m cos)² a² has the mean a² (1 + m²/2) and a line of 2 m a²."""
    m, tone = 0.4, 137.0

    def signal(times: np.ndarray) -> np.ndarray:
        return (1.0 + m * np.cos(2.0 * np.pi * tone * times)) * np.cos(2.0 * np.pi * 1500.0 * times) + np.cos(
            2.0 * np.pi * MESH * times
        )

    record = condition_record(_transient(signal, 100e3, 2.0), {"left: outer raceway": tone, "left: cage": 0.8})
    struck, slow = machine_condition(record).tones
    assert struck.amplitudes["top"] == pytest.approx(2.0 * m / (1.0 + 0.5 * m**2), rel=0.02)
    assert slow.amplitudes["top"] is None
    with pytest.raises(CouplingError, match="1 periods"):
        envelope_at(record.signals["top"], record.interval, LIMIT, 0.8)


def test_growth_is_against_an_earlier_record() -> None:
    assert INDICATORS["rms"].grown(3.0, 2.0) == 1.5
    assert INDICATORS["spectral_kurtosis"].grown(-0.2, -0.5) == pytest.approx(0.3)
    assert INDICATORS["na4"].grown(3.0, 2.0) == 3.0
    assert np.isnan(INDICATORS["fm4"].grown(3.0, 0.0))
