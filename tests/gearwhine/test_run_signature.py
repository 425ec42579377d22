"""Orders along a run, whatever the tooth numbers: windows need no whole turns of every shaft."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from coupling import SpeedProfile
from gearwhine.case import Case, load_case, mesh_frequencies
from gearwhine.figures.machine.transient import _speed
from gearwhine.from_case.gear_pairs import solve_gears
from gearwhine.output.quantity import document_of
from gearwhine.results.run import RUN, run_signature_document
from gearwhine.solve.machine import build_machine
from gearwhine.solve.run_up import run_signature_warnings, solve_run_signature
from gearwhine.solve.transient import SolvedTransient, solve_transient

FEW = ("rotor.input.modes=2", "rotor.output.modes=2", "transient.tolerance=1e-2", "transient.discard=0")


def run_up(teeth: tuple[int, int], seconds: float, *more: str) -> tuple[Case, SolvedTransient]:
    """The spur pair with other tooth numbers, of the same sum, along a run-up to 4500 rpm."""
    changes = (
        *FEW,
        f"gear.0.teeth={teeth[0]}",
        f"gear.1.teeth={teeth[1]}",
        f"transient.run={{ from = '1500 rpm', to = '4500 rpm', time = '{seconds} s' }}",
        "transient.revolutions=",
        *more,
    )
    case = load_case("spur-pair", changes).case
    machine = build_machine(case, None, solve_gears(case))
    return case, solve_transient(case, machine, mesh_frequencies(case))


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [(27, 29), (26, 30)])
def test_tooth_numbers_without_common_turns_have_their_orders(teeth: tuple[int, int]) -> None:
    case, solved = run_up(teeth, 0.6)
    found = solve_run_signature(case, solved)
    assert found is not None
    rows = run_signature_document(found)["orders"]
    assert {row["order"] for row in rows} >= {teeth[0], 2 * teeth[0]}
    # 30 turns do not part one shaft from another that turns 27/29 or 26/30 times: it is said.
    (told,) = run_signature_warnings(case, solved)
    assert told["name"] == "run signature"
    assert "output" in told["message"]
    for orders in found.orders.values():
        assert len(orders.speeds) >= 8
        assert np.all(np.diff(orders.speeds) > 0.0)


def test_a_run_too_short_for_orders_says_so() -> None:
    case, solved = run_up((27, 29), 0.06)
    assert solve_run_signature(case, solved) is None
    (told,) = run_signature_warnings(case, solved)
    assert "no spectra and orders along the run" in told["message"]


def test_captions_of_a_run_name_its_speeds() -> None:
    assert _speed(*run_up((27, 29), 0.06)) == "1500 to 4500 rpm, averaged over the run"


def long_run(solved: SolvedTransient, orders: dict[float, float]) -> SolvedTransient:
    """The same machine along 660 turns from 600 to 6000 rpm, its mesh force with these amplitudes at these orders."""
    turning = SpeedProfile(np.array([0.0, 12.0]), np.array([600.0, 6000.0]) / 5500.0)
    times = np.arange(0.0, 12.0, 1.0 / 7000.0)
    turns = 5500.0 / 60.0 * turning.at(times)[0]
    force = 1000.0 + sum(size * np.cos(2.0 * np.pi * order * turns + order) for order, size in orders.items())
    name = solved.machine.system.contacts[0].name
    histories = replace(solved.histories, times=times, sensor_acceleration={}, mesh_force={name: force})
    return replace(solved, turning=turning, signals=replace(solved.signals, histories=histories))


@pytest.mark.parametrize(("teeth", "within"), [((27, 29), 0.01), ((26, 30), 1e-4)])
def test_a_long_run_has_every_order_at_its_amplitude(teeth: tuple[int, int], within: float) -> None:
    """Of 26/30 teeth 15 turns are whole ones of both shafts, and each order is a line; of 27/29 it lies between."""
    case, solved = run_up(teeth, 0.06)
    ratio = teeth[0] / teeth[1]
    given = {1.0: 60.0, ratio: 40.0, float(teeth[0]): 200.0, 2.0 * teeth[0]: 30.0}
    run = long_run(solved, given)
    found = solve_run_signature(case, run)
    assert found is not None
    rows: list[dict[str, Any]] = run_signature_document(found)["orders"]
    assert sorted(row["order"] for row in rows) == pytest.approx(sorted([*given, 3.0 * teeth[0]]))
    for order, size in given.items():
        (row,) = [row for row in rows if abs(row["order"] - order) < 1e-9]
        assert row["highest_amplitude"] == pytest.approx(size, rel=within)
    assert run_signature_warnings(case, run) == []


def test_a_run_in_the_other_sense_has_its_speeds_below_zero() -> None:
    """As those of the run itself are; frequencies are none the less positive, and lines stand where they did."""
    case, solved = run_up((26, 30), 0.06, "operation.speed=-5500 rpm")
    run = long_run(solved, {26.0: 200.0})
    found = solve_run_signature(case, run)
    assert found is not None
    document = run_signature_document(found)
    whole = document_of(RUN, run)
    assert whole["from_rpm"] == pytest.approx(-600.0)
    assert whole["to_rpm"] == pytest.approx(-6000.0)
    # The first and last stretch lie within the run.
    assert -1000.0 < document["from_rpm"] < whole["from_rpm"]
    assert whole["to_rpm"] < document["to_rpm"] < -5500.0
    (row,) = [row for row in document["orders"] if row["order"] == 26.0]
    assert row["highest_amplitude"] == pytest.approx(200.0, rel=1e-4)
    assert -6000.0 < row["at_rpm"] < -600.0
    assert row["frequency_hz"] == pytest.approx(26.0 * -row["at_rpm"] / 60.0)
    (spectra,) = found.spectra.values()
    for speed, amplitude in zip(found.speeds_rpm, spectra.amplitude, strict=True):
        peak = spectra.frequencies[1 + int(np.argmax(amplitude[1:]))]
        assert peak == pytest.approx(26.0 * -speed / 60.0, rel=0.05)
