"""Orders along a run, whatever the tooth numbers: windows need no whole turns of every shaft."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled
from idler_case import idler

from gearwhine.case import Case, load_case
from gearwhine.coupling import SpeedProfile
from gearwhine.coupling.analyses.run_up import RunSignature, run_signature_warnings, solve_run_signature
from gearwhine.coupling.analyses.transient import SolvedTransient, solve_transient
from gearwhine.coupling.signals.spectrum import amplitude_spectrum
from gearwhine.figures.machine.run_up import draw_order_slices, draw_run
from gearwhine.figures.machine.transient import _speed
from gearwhine.output.dataset import arrays_of
from gearwhine.output.quantity import document_of
from gearwhine.output.sections import Table
from gearwhine.results.run import RUN, RUN_SIGNATURE, report, run_signature_document, sections, transient_document
from gearwhine.solve.machine import plan_of, tracking_of

FEW = ("rotor.input.modes=2", "rotor.output.modes=2", "transient.tolerance=5e-3", "transient.discard=0")


@cache
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
    machine = coupled(case)
    return case, solve_transient(machine, plan_of(case))


@pytest.mark.slow
def test_tooth_numbers_without_common_turns_have_their_orders() -> None:
    case, solved = run_up((27, 29), 0.6)
    found = solve_run_signature(solved, tracking_of(case.transient))
    assert found is not None
    rows = run_signature_document(found)["orders"]
    assert {row["order"] for row in rows} >= {27, 54}
    # 30 turns do not part one shaft from another that turns 27/29 times: it is said.
    (told,) = run_signature_warnings(solved, tracking_of(case.transient))
    assert told["name"] == "run signature"
    assert "output" in told["message"]
    for orders in found.orders.values():
        assert len(orders.speeds) >= 8
        assert np.all(np.diff(orders.speeds) > 0.0)


def test_a_run_too_short_for_orders_says_so() -> None:
    case, solved = run_up((27, 29), 0.06)
    assert solve_run_signature(solved, tracking_of(case.transient)) is None
    (told,) = run_signature_warnings(solved, tracking_of(case.transient))
    # 50 turns a second on average over 0.06 s.
    assert "no spectra and orders along the run: 3 turns of the leading shaft in the record" in told["message"]
    assert "3 whole ones; expected 4 or more" in told["message"]


def test_four_turns_are_enough_for_orders() -> None:
    """From 1500 to 4500 rpm in 0.08 s the leading shaft turns four times, from one whole turn to another."""
    case, solved = run_up((26, 30), 0.08)
    found = solve_run_signature(solved, tracking_of(case.transient))
    assert found is not None
    assert {26.0, 52.0, 78.0} <= set(found.named.values())


def test_captions_of_a_run_name_its_speeds() -> None:
    assert _speed(run_up((27, 29), 0.06)[1]) == "1500 to 4500 rpm, averaged over the run"


def long_run(solved: SolvedTransient, orders: dict[float, float]) -> SolvedTransient:
    """The same machine along 660 turns from 600 to 6000 rpm, its mesh force with these amplitudes at these orders."""
    turning = SpeedProfile(np.array([0.0, 12.0]), np.array([600.0, 6000.0]) / 5500.0)
    times = np.arange(0.0, 12.0, 1.0 / 7000.0)
    turns = 5500.0 / 60.0 * turning.at(times)[0]
    force = 1000.0 + sum(size * np.cos(2.0 * np.pi * order * turns + order) for order, size in orders.items())
    name = solved.machine.system.contacts[0].name
    histories = replace(solved.histories, times=times, sensor_acceleration={}, mesh_force={name: force})
    return replace(
        solved,
        machine=replace(solved.machine, speed_profile=turning),
        signals=replace(solved.signals, histories=histories),
    )


@pytest.mark.slow
@pytest.mark.parametrize(("teeth", "within"), [((27, 29), 0.01), ((26, 30), 1e-4)])
def test_a_long_run_has_every_order_at_its_amplitude(teeth: tuple[int, int], within: float) -> None:
    """Of 26/30 teeth 15 turns are whole ones of both shafts, and each order is a line; of 27/29 it lies between."""
    case, solved = run_up(teeth, 0.06)
    ratio = teeth[0] / teeth[1]
    given = {1.0: 60.0, ratio: 40.0, float(teeth[0]): 200.0, 2.0 * teeth[0]: 30.0}
    run = long_run(solved, given)
    found = solve_run_signature(run, tracking_of(case.transient))
    assert found is not None
    rows: list[dict[str, Any]] = run_signature_document(found)["orders"]
    assert sorted(row["order"] for row in rows) == pytest.approx(sorted([*given, 3.0 * teeth[0]]))
    for order, size in given.items():
        (row,) = [row for row in rows if abs(row["order"] - order) < 1e-9]
        assert row["highest_amplitude"] == pytest.approx(size, rel=within)
    assert run_signature_warnings(run, tracking_of(case.transient)) == []


@pytest.mark.slow
def test_a_run_in_the_other_sense_has_its_speeds_below_zero() -> None:
    """As those of the run itself are; frequencies are none the less positive, and lines stand where they did."""
    case, solved = run_up((26, 30), 0.06, "operation.speed=-5500 rpm")
    run = long_run(solved, {26.0: 200.0})
    found = solve_run_signature(run, tracking_of(case.transient))
    assert found is not None
    document = run_signature_document(found)
    whole = document_of(RUN, run)
    assert whole["from_rpm"] == pytest.approx(-600.0)
    assert whole["to_rpm"] == pytest.approx(-6000.0)
    # Spectra and orders reach from the first speed of the run to the last.
    assert document["from_rpm"] == pytest.approx(-600.0)
    assert document["to_rpm"] == pytest.approx(-6000.0, rel=1e-3)
    speeds = 60.0 * next(iter(found.orders.values())).speeds
    assert speeds[[0, -1]] == pytest.approx([-600.0, -6000.0], rel=1e-2)
    (row,) = [row for row in document["orders"] if row["order"] == 26.0]
    assert row["highest_amplitude"] == pytest.approx(200.0, rel=1e-4)
    assert -6000.0 <= row["at_rpm"] <= -600.0
    assert row["frequency_hz"] == pytest.approx(26.0 * -row["at_rpm"] / 60.0)
    (spectra,) = found.spectra.values()
    for speed, amplitude in zip(found.speeds_rpm, spectra.amplitude, strict=True):
        peak = spectra.frequencies[1 + int(np.argmax(amplitude[1:]))]
        assert peak == pytest.approx(26.0 * -speed / 60.0, rel=0.05)


LIMIT = 2000.0


def with_sensor(solved: SolvedTransient) -> SolvedTransient:
    """The long run with a sensor whose orders 27 and 81 rise with the speed, the same signal as its mesh force.

    The latter ends at 2500 rpm, short of half the sampling rate.
    """
    run = long_run(solved, {})
    assert run.speed_profile is not None
    times = run.histories.times
    turned, ratio, _ = run.speed_profile.at(times)
    turns = 5500.0 / 60.0 * turned
    third = np.where(5500.0 * ratio < 2500.0, 50.0 * ratio * np.cos(2.0 * np.pi * 81.0 * turns), 0.0)
    signal = 10.0 * ratio * np.cos(2.0 * np.pi * 27.0 * turns) + third
    (force,) = run.histories.mesh_force
    histories = replace(run.histories, sensor_acceleration={"top": signal}, mesh_force={force: signal})
    spectrum = amplitude_spectrum(signal, float(times[1] - times[0]), "hann")
    return replace(
        run,
        signals=replace(run.signals, histories=histories),
        sensor_spectra={"top": spectrum},
        force_spectra={force: spectrum},
        trusted_limit=LIMIT,
    )


@cache
def heard_run_up() -> tuple[Case, SolvedTransient, RunSignature]:
    """The long run with a sensor, and its orders."""
    case, solved = run_up((27, 29), 0.06)
    run = with_sensor(solved)
    found = solve_run_signature(run, tracking_of(case.transient))
    assert found is not None
    return case, run, found


@pytest.mark.slow
def test_orders_of_a_sensor_end_where_the_model_is_complete() -> None:
    """An order that rises with the speed is highest at the limit; a mesh force goes on to the end of the run."""
    case, run, found = heard_run_up()
    rows = {(row["signal"], row["order"]): row for row in run_signature_document(found)["orders"]}
    # The amplitude is that at the speed, not a mean over the window.
    for order, slope, within in ((27.0, 10.0, 0.01), (81.0, 50.0, 0.01)):
        row, speeds = rows["top", order], found.orders["top"].speeds
        assert row["at_rpm"] == pytest.approx(60.0 * speeds[order * speeds <= LIMIT].max())
        assert row["highest_amplitude"] == pytest.approx(slope * row["at_rpm"] / 5500.0, rel=within)
    assert rows["pinion -> wheel", 27.0]["frequency_hz"] > 0.9 * 27.0 * 100.0
    # What is drawn and stored is what is known.
    arrays = arrays_of(RUN_SIGNATURE, found)
    _, amplitude, attributes = arrays["run_order_amplitude"]
    assert attributes["units"] == "see run_unit"
    assert attributes["sensors_complete_below_hz"] == LIMIT
    speeds = arrays["order_speed"][1] / 60.0
    for number, order in enumerate(found.named.values()):
        np.testing.assert_array_equal(np.isnan(amplitude[0, number]), order * speeds > LIMIT)
        assert not np.isnan(amplitude[1, number]).any()
    beyond = np.outer(speeds, arrays["order"][1]) > LIMIT
    np.testing.assert_array_equal(np.isnan(arrays["run_orders"][1][0]), beyond)
    assert arrays["run_orders"][2]["units"] == arrays["run_spectrum"][2]["units"] == "see run_unit"
    figures = dict(draw_run(case.title, run, found))
    for stem, ends in (("top", True), ("pinion-wheel", False)):
        figure = figures[f"run-up-orders-{stem}"]
        notes = " ".join(" ".join(text.get_text() for text in figure.texts).split())
        assert ("up to 2000 Hz, where the model is complete" in notes) is ends


@pytest.mark.slow
def test_an_order_beyond_the_limit_all_along_has_no_row() -> None:
    case, solved = run_up((27, 29), 0.06)
    run = replace(with_sensor(solved), trusted_limit=500.0)
    found = solve_run_signature(run, tracking_of(case.transient))
    assert found is not None
    rows = {(row["signal"], row["order"]) for row in run_signature_document(found)["orders"]}
    assert 54.0 * found.orders["top"].speeds.min() > 500.0
    assert ("top", 27.0) in rows
    assert not rows & {("top", 54.0), ("top", 81.0)}
    assert ("pinion -> wheel", 81.0) in rows


def words(document: dict[str, Any]) -> str:
    """Headings and sentences of a run on the terminal and in the report."""
    shown = [*sections(document), report(document)]
    content = [part for section in shown for part in section.content]
    tables = [part for part in content if isinstance(part, Table)]
    headings = [column.heading for table in tables for column in table.filled()[0]]
    return " | ".join([*headings, *(table.caption for table in tables), *(p for p in content if isinstance(p, str))])


@pytest.mark.slow
def test_peaks_of_a_run_are_the_highest_of_its_orders() -> None:
    """Not lines of the whole record, in which an order is smeared over all frequencies that it passes."""
    _, run, found = heard_run_up()
    document = transient_document(run, None, found)
    (sensor,), (pair,) = document["sensors"], document["gear_pairs"]
    told = {(row.signal, row.name): row for row in found.highest()}
    for signal, key, peaks in (
        ("top", "amplitude_m_per_s2", sensor["peaks"]),
        ("pinion -> wheel", "amplitude_n", pair["force_peaks"]),
    ):
        assert len(peaks) == sum(name == signal for name, _ in told)
        assert [peak[key] for peak in peaks] == sorted((peak[key] for peak in peaks), reverse=True)
        for peak in peaks:
            row = told[signal, peak["name"]]
            assert peak["kind"] == "highest of an order along the run"
            assert (peak[key], peak["frequency_hz"]) == (row.highest_amplitude, row.frequency_hz)
            assert (peak["order"], peak["at_rpm"]) == (row.order, row.at_rpm)
    assert sensor["peaks"][0]["amplitude_m_per_s2"] == pytest.approx(50.0 * LIMIT / 81.0 * 60.0 / 5500.0, rel=0.1)
    shown = words(document | {"run_signature": run_signature_document(found)})
    assert "highest lines" not in shown.lower()
    assert "Highest of the orders along the run" in shown
    assert "Orders of sensors up to 2000 Hz, where the model is complete" in shown


def test_a_run_without_orders_says_that_its_lines_are_means() -> None:
    """The tone of a short run is smeared: its highest line is far below its amplitude."""
    _, solved = run_up((27, 29), 0.06)
    run = with_sensor(solved)
    document = transient_document(run)
    assert run.sensor_spectra["top"].amplitude.max() < 5.0
    for rows in (document["sensors"][0]["peaks"], document["gear_pairs"][0]["force_peaks"]):
        assert {row["kind"] for row in rows} == {"mean over the run"}
    shown = words(document)
    assert "highest lines" not in shown.lower()
    assert "means over the run: Hz (m/s², peak)" in shown
    (highest,) = [
        row[[column.heading for column in columns].index("means over the run: Hz (m/s², peak)")]
        for section in sections(document)
        for columns, (row,) in (table.filled() for table in section.tables if "sensor" in table.columns[0].heading)
    ]
    assert highest.startswith(f"{document['sensors'][0]['peaks'][0]['frequency_hz']:.0f} (")
    assert shown.count("means over its speeds") == 2
    steady = transient_document(replace(run, machine=replace(run.machine, speed_profile=None)))
    assert "kind" not in steady["sensors"][0]["peaks"][0]
    assert "highest lines: Hz (m/s², peak)" in words(steady)


def test_pairs_that_share_an_order_share_its_curve(tmp_path: Path) -> None:
    """An idler passes its tooth frequency on: one order for both of its meshes, and one for shafts of one speed."""
    run = "transient.run={ from = '1500 rpm', to = '4500 rpm', time = '0.1 s' }"
    case = load_case(idler(tmp_path), (*FEW, "rotor.third.modes=2", "transient.revolutions=", run)).case
    solved = solve_transient(coupled(case), plan_of(case))
    found = solve_run_signature(solved, tracking_of(case.transient))
    assert found is not None
    meshes = {f"{n}× pinion -> wheel, {n}× wheel -> end": 28.0 * n for n in (1, 2, 3)}
    assert found.named == {"1× input, output, third": 1.0} | meshes
    document = run_signature_document(found)
    assert len(document["orders"]) == 2 * 4
    # The first mesh's force at its own order, of which there is one curve.
    figure = draw_order_slices("x", found.orders["pinion -> wheel"], found.named, unit="N")
    assert len(figure.axes[0].lines) <= 4
    assert sum("pinion" in str(line.get_label()) for line in figure.axes[0].lines) == 3
