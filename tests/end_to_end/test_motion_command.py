"""The machine in motion by the command: methods of marching, friction's history, signatures of a run-up."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled

from gearwhine.case import load_case
from gearwhine.coupling.analyses.transient import solve_transient
from gearwhine.output.manifest import opened_dataset
from gearwhine.results.run import transient_document
from gearwhine.solve.machine import plan_of

FEW = ("--set", "rotor.input.modes=2", "--set", "rotor.output.modes=2")
SHORT = (*FEW, "--set", "transient.revolutions=3", "--set", "transient.discard=1")
RUN = (
    *("--set", "transient.run={ from = '1500 rpm', to = '4500 rpm', time = '0.6 s' }"),
    *("--set", "transient.revolutions=", "--set", "transient.discard=0"),
)


MARCHED = {"newmark": "newmark", "exact": "exact", "auto": "exact"}


@pytest.fixture(scope="module")
def documents() -> dict[str, dict[str, Any]]:
    """What a march by each method tells, by the stages of the run: what it draws of them is looked at below."""
    found = {}
    for method in MARCHED:
        case = load_case("spur-pair", (*SHORT[1::2], f"transient.method='{method}'")).case
        machine = coupled(case)
        found[method] = transient_document(solve_transient(machine, plan_of(case)))
    return found


@pytest.mark.parametrize("asked", MARCHED)
def test_the_method_that_the_case_asks_for(documents: dict[str, dict[str, Any]], asked: str) -> None:
    """By either method the same machine: forces whose mean is the torque over the base radius."""
    document = documents[asked]
    assert document["method"] == MARCHED[asked]
    assert document["energy_error"] < 1e-3
    expected = 71.77 / (0.5 * 28 * 3.175e-3 * np.cos(np.radians(20.0)))
    assert document["gear_pairs"][0]["mean_force_n"] == pytest.approx(expected, rel=2e-3)
    assert document["gear_pairs"][0]["contact_loss_fraction"] == 0.0
    # Newmark's steps resolve the modes, elements only what the teeth do.
    assert (document["steps"] < 5000) == (MARCHED[asked] == "exact")


def test_methods_agree(documents: dict[str, dict[str, Any]]) -> None:
    """Lines of the mesh force by the exact march and by Newmark's: as far as the latter's tolerance goes."""
    newmark, exact = (documents[method]["gear_pairs"][0] for method in ("newmark", "exact"))
    assert exact["peak_force_n"] == pytest.approx(newmark["peak_force_n"], rel=5e-3)
    lines = [[line["amplitude_n"] for line in pair["force_peaks"][:4]] for pair in (newmark, exact)]
    assert lines[1] == pytest.approx(lines[0], rel=2e-2)


def test_the_exact_march_says_why_it_does_not_apply(gearwhine: Any) -> None:
    exact = ("--set", "transient.method='exact'")
    for command in ("run", "check"):
        outcome = gearwhine(command, "spur-pair", *SHORT, *exact, "--set", "gear_pair.0.friction=0.05", "-q")
        assert outcome.code == 2
        assert "friction between the teeth (gear_pair[0])" in outcome.err
        outcome = gearwhine(command, "spur-pair", *FEW, *exact, *RUN, "-q")
        assert outcome.code == 2
        assert "a speed that varies" in outcome.err


@pytest.mark.slow
def test_friction_over_time(gearwhine: Any, tmp_path: Path) -> None:
    """The power's history sums up to what the march counted step by step; the force turns at the pitch point."""
    two = ("--set", "transient.revolutions=2", "--set", "transient.discard=0")
    rubbing = (*FEW, *two, "--set", "gear_pair.0.friction=0.06")
    outcome = gearwhine("run", "spur-pair", *rubbing, "--json", "-q", "-o", "out")
    assert outcome.code == 0, outcome.err
    document = outcome.document
    friction = document["gear_pairs"][0]["friction"]
    seconds = 2 * 60.0 / 5500.0
    assert friction["mean_power_w"] * seconds == pytest.approx(document["energy_j"]["friction"], rel=5e-3)
    assert "friction.png" in document["files"]
    with opened_dataset(tmp_path / "out" / "results.nc") as data:
        force, power = data["friction_force"].values[0], data["friction_power"].values[0]
        pressed = data["mesh_force"].values[0]
        assert data["friction_power"].attrs["units"] == "W"
    assert np.all(power >= -1e-6 * power.max())
    assert force.min() < 0.0 < force.max()
    assert np.all(np.abs(force) <= 0.06 * pressed * (1.0 + 1e-5))
    # One pair alone carries the force, on one side of the pitch point: all of mu F.
    assert np.abs(force / pressed).max() == pytest.approx(0.06, rel=1e-5)


@pytest.mark.slow
def test_a_run_up_shows_its_orders(gearwhine: Any, tmp_path: Path) -> None:
    """The mesh order over speed, against a projection of the mesh force on the turned angle, window by window."""
    loose = ("--set", "transient.tolerance=4e-3")
    outcome = gearwhine("run", "spur-pair", *FEW, *RUN, *loose, "--json", "-q", "-o", "out")
    assert outcome.code == 0, outcome.err
    document = outcome.document
    rows = {(row["signal"], row["name"]): row for row in document["run_signature"]["orders"]}
    mesh = next(row for (_, name), row in rows.items() if name.startswith("1× pinion"))
    assert mesh["order"] == 28.0
    assert mesh["frequency_hz"] == pytest.approx(28.0 * mesh["at_rpm"] / 60.0)
    files = set(document["files"])
    assert {"run-up-map-pinion-wheel.png", "run-up-orders-pinion-wheel.png"} <= files
    with opened_dataset(tmp_path / "out" / "results.nc") as data:
        times, force = data["time"].values, data["mesh_force"].values[0].astype(np.float64)
        signal = list(data["run_signal"].values).index(mesh["signal"])
        speeds, orders = data["order_speed"].values, data["order"].values
        map_of = data["run_orders"].values[signal]
        named = list(data["named_order"].values).index(mesh["name"])
        assert data["run_order_number"].values[named] == 28.0
        followed = data["run_order_amplitude"].values[signal, named]
    along = map_of[:, np.argmin(np.abs(orders - 28.0))]
    # The line of a window is a mean over it, the cut is the amplitude at its middle.
    assert np.median(along / followed) == pytest.approx(1.0, abs=0.1)
    assert speeds[[0, -1]] == pytest.approx([1500.0, 4500.0], rel=0.01)
    # Speed rises evenly: n turns are done at the time that solves n = (a t + b t²/2) / 2π.
    begin, rise = 25.0, 50.0 / 0.6
    angle = begin * times + 0.5 * rise * times**2
    for number in (len(along) // 3, 2 * len(along) // 3):
        at = (speeds[number] / 60.0 - begin) / rise
        middle = begin * at + 0.5 * rise * at**2
        turns = document["run_signature"]["window_turns"]
        span = np.abs(angle - middle) < 0.5 * turns
        share = (0.5 + 0.5 * np.cos(2.0 * np.pi / turns * (angle[span] - middle))) * np.gradient(angle[span])
        line = 2.0 * abs(np.sum(share * force[span] * np.exp(-2j * np.pi * 28.0 * angle[span]))) / share.sum()
        assert line == pytest.approx(along[number], rel=0.02)
    report = gearwhine("report", "spur-pair", "-o", "out", "-q")
    assert report.code == 0
    page = (tmp_path / "out" / "report.html").read_text()
    assert "Orders along the run" in page
    assert "Level over frequency and speed: lines through the origin" in page


@pytest.mark.slow
def test_resonances_of_more_mesh_harmonics(gearwhine: Any, answer: Any) -> None:
    """By default those of three harmonics of the mesh of 28 teeth; the table says so, and how to see more."""
    orders = {}
    for count in (3, 5):
        asked = ("--campbell",) if count == 3 else ("--mesh-harmonics", "5")
        document = answer("system", "spur-pair", *FEW, *asked, "--json", "-q").document
        orders[count] = {round(line["order"]) for line in document["campbell"]["lines"] if line["kind"] == "mesh"}
        met = {crossing["line"] for crossing in document["campbell"]["crossings"]}
        assert ("5× pinion -> wheel" in met) is (count == 5)
    assert orders == {3: {28, 56, 84}, 5: {28, 56, 84, 112, 140}}
    shown = " ".join(gearwhine("system", "spur-pair", *FEW, "--mesh-harmonics", "5", "-q").out.split())
    assert "mesh orders up to 5× (more: --mesh-harmonics):" in shown


@pytest.mark.slow
def test_sidebands_in_the_diagram_over_speed(answer: Any) -> None:
    document = answer("system", "spur-pair", *FEW, "--campbell", "--sidebands", "1", "--json", "-q").document
    kinds = {(line["kind"], line["order"]) for line in document["campbell"]["lines"]}
    assert {("mesh", 28.0), ("sideband", 27.0), ("sideband", 29.0)} <= {
        (kind, round(order, 9)) for kind, order in kinds
    }
