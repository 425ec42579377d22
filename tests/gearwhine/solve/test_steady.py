"""The steady state by the command: the motion that the transient settles to, and its branch over speed."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled

import gearwhine as gw
from gearwhine.case import CaseError, load_case
from gearwhine.cli import run_command
from gearwhine.coupling import CouplingError
from gearwhine.coupling.analyses.steady_state import solve_steady
from gearwhine.coupling.analyses.transient import solve_transient
from gearwhine.figures.machine.steady_state import draw_response_curve
from gearwhine.output.manifest import opened_dataset
from gearwhine.results.steady_state import curve_sentences
from gearwhine.solve.machine import plan_of

FEW = ("rotor.input.modes=2", "rotor.output.modes=2")
BALANCED = "rotor.input.unbalance="  # so that all repeats with the mesh


@pytest.mark.slow
def test_the_transient_settles_to_it() -> None:
    """Newmark's march, after twenty revolutions: their forces agree as far as its own tolerance goes."""
    changes = [*FEW, BALANCED, "transient.revolutions=21", "transient.discard=20", "transient.tolerance=1e-5"]
    case = load_case("spur-pair", changes).case
    machine = coupled(case)
    marched = solve_transient(machine, plan_of(case))
    (motion,) = solve_steady(machine).motions
    (settled,) = (force for name, force in marched.histories.mesh_force.items() if "back" not in name)
    (steady,) = (force for name, force in motion.histories.mesh_force.items() if "back" not in name)
    assert motion.response.period == pytest.approx(60.0 / 5500.0 / 28, rel=1e-12)
    assert motion.response.stable
    times = np.mod(marched.histories.times, motion.response.period)
    expected = np.interp(times, motion.histories.times, steady, period=motion.response.period)
    assert np.sqrt(np.mean((settled - expected) ** 2)) < 2e-3 * np.std(steady)


@pytest.mark.slow
def test_the_command_follows_the_motion_over_speed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    changes = [*FEW, BALANCED, "sweep.speed=['5000 rpm', '6000 rpm']"]
    arguments = ["steady", "spur-pair", "--curve", "--points", "8", "-q", "--json", "-o", str(tmp_path)]
    for change in changes:
        arguments += ["--set", change]
    assert run_command(arguments) == 0
    document = json.loads(capsys.readouterr().out)
    curve, (motion,) = document["curve"], document["motions"]
    speeds = curve["speed_rpm"]
    assert speeds[0] == pytest.approx(5000.0)
    assert speeds[-1] == pytest.approx(6000.0)
    assert len(speeds) >= 8
    assert curve["ending"] == "end"
    assert curve["account"] == f"followed from 5000 to 6000 rpm: {len(speeds)} points, 0 folds"
    assert motion["stable"]
    assert 1e3 * motion["period_s"] == pytest.approx(60e3 / 5500.0 / 28, rel=1e-12)
    # The mean force is the torque over the base radius, whatever the speed.
    expected = 71.77 / (0.5 * 28 * 3.175e-3 * np.cos(np.radians(20.0)))
    assert motion["gear_pairs"][0]["mean_force_n"] == pytest.approx(expected, rel=1e-9)
    # Its lines stand at multiples of the mesh frequency.
    orders = [line["frequency_hz"] / (28 * 5500.0 / 60.0) for line in motion["gear_pairs"][0]["force_lines"]]
    assert orders == pytest.approx(np.round(orders), abs=1e-9)
    assert {"steady-motion.png", "steady-curve.png", "results.nc"} <= {path.name for path in tmp_path.iterdir()}
    with opened_dataset(tmp_path / "results.nc") as data:
        np.testing.assert_allclose(data["branch_speed"], speeds)
        assert data["branch_speed"].attrs["ending"] == "end"
        assert data["branch_peak_force"].attrs["units"] == "N"
        moduli = np.hypot(*data["floquet_multiplier"].values[0].T)
        assert moduli.max() == pytest.approx(motion["largest_multiplier"], rel=1e-12)


def test_a_branch_shows_parting_teeth_only_where_drive_flanks_part() -> None:
    """The back flanks are apart all the time, which says nothing."""
    study = gw.load("spur-pair", [*FEW, BALANCED, "sweep.speed=['5000 rpm', '5200 rpm']"])
    figure = study.steady(curve=True, points=3).plot("steady-curve")
    assert [axes.get_ylabel() for axes in figure.axes] == ["compression, a.c. rms [µm]", "largest mesh force [N]"]


def test_names_stand_once_and_marks_whole_on_a_branch_of_two_pairs() -> None:
    speeds = np.linspace(100.0, 200.0, 5)
    both = np.column_stack([np.linspace(1.0, 2.0, 5), np.linspace(2.0, 3.0, 5)])
    loss = 0.1 * np.column_stack([np.arange(5.0), np.zeros(5)])
    curve: Any = SimpleNamespace(
        rms_compression=1e-6 * both,
        peak_force=1e3 * both,
        contact_loss=loss,
        speeds=speeds,
        stable=np.ones(5, dtype=bool),
        ending="end",
        gaps=(),
        slices=(slice(0, 5),),
        bifurcations=[SimpleNamespace(kind="fold", index=2)],
    )
    solved: Any = SimpleNamespace(
        machine=SimpleNamespace(
            system=SimpleNamespace(contacts=[SimpleNamespace(name="a -> b"), SimpleNamespace(name="b -> c")]),
            loaded_contacts=[0, 1],
        ),
        branch_rms={"top": np.arange(5.0), "end": np.arange(5.0)},
        motions=[SimpleNamespace(speed=150.0, trusted_limit=1500.0)],
    )
    figure = draw_response_curve("Branch", solved, curve)
    assert figure.texts[1].get_text() == "955 to 1910 rpm; dash-dotted: speed of operation"
    solved.motions[0].speed = 250.0
    assert draw_response_curve("Branch", solved, curve).texts[1].get_text() == "955 to 1910 rpm"
    named = {axes.get_ylabel(): axes.get_legend() for axes in figure.axes}
    texts = {name: [text.get_text() for text in one.get_texts()] for name, one in named.items() if one is not None}
    assert texts == {
        "compression, a.c. rms [µm]": ["a → b", "b → c"],
        "acceleration, rms 0–1500 Hz [m/s²]": ["top", "end"],
    }
    # The second pair never parts: its fold lies on the axis, and is not cut there.
    (apart,) = [axes for axes in figure.axes if axes.get_ylabel() == "teeth apart [%]"]
    marks = [line for line in apart.lines if line.get_marker() == "o"]
    assert [line.get_ydata() for line in marks] == [pytest.approx([20.0]), pytest.approx([0.0])]
    assert not any(line.get_clip_on() for line in marks)


def test_a_period_of_many_teeth_is_drawn_in_part() -> None:
    """With unbalance the motion repeats after a turn, which is 28 mesh periods: too many to be told apart."""
    study = gw.load("spur-pair", FEW)
    (left, _) = study.steady().plot("steady-motion").axes
    assert left.get_title(loc="left").endswith(": 6 mesh periods")
    assert left.get_xlim() == pytest.approx((0.0, 6e3 * 60.0 / 5500.0 / 28))


def test_a_branch_that_is_left_is_told_on_screen() -> None:
    left = {
        "speed_rpm": [3000.0, 3500.0],
        "stable": [True, True],
        "ending": "tries",
        "account": "followed from 3000 to 3500 rpm; as many tries as were allowed",
        "gear_pairs": [],
        "bifurcations": [],
    }
    told = "\n".join(curve_sentences(left))
    assert "Left before the end of the range: followed from 3000 to 3500 rpm; as many" in told
    assert "Left before" not in "\n".join(curve_sentences(left | {"ending": "end"}))


def test_what_stands_still_or_has_no_range_is_refused() -> None:
    with pytest.raises(CaseError, match=r"sweep\.speed: expected a range of speeds"):
        gw.load("spur-pair", [*FEW, "sweep.speed=['3000 rpm']"]).steady(curve=True)
    still = load_case("spur-pair", [*FEW, "operation.speed=0 rpm", "transient="]).case
    with pytest.raises(CouplingError, match="stands still"):
        solve_steady(coupled(still))
    with pytest.raises(CaseError, match=r"operation\.speed.*stands still"):
        gw.load("spur-pair", {"operation.speed": "0 rpm", "transient": ""}).steady()


@pytest.mark.slow
def test_a_sensor_is_loudest_where_the_mesh_meets_the_mode_it_sits_on() -> None:
    """The top's own mode: its resonance carries nearly all of the line, at the mesh frequency."""
    coarse = {"housing.box.mesh_size": "60 mm", "rotor.*.unbalance": ""}
    study = gw.load("small-gearbox", coarse)
    assert study.housing is not None
    top = study.machine.housing_component.sensors["top"]  # type: ignore[union-attr]
    frequencies = study.housing.modes.frequencies_hz
    mode = int(np.abs(top[: len(frequencies)]).argmax())
    speeds = [f"{frequencies[mode] * 60.0 / 28 * part:.3f} rpm" for part in (0.97, 1.03)]
    swept = study.changed({"sweep.speed": speeds})
    assert swept.housing is study.housing
    result = swept.steady(curve=True, points=6)
    found = {one["sensor"]: one for one in result.document["curve"]["loudest"]}["top"]
    assert found["housing_mode"] == mode + 1
    assert found["mode_hz"] == pytest.approx(frequencies[mode])
    assert found["share"] == pytest.approx(1.0, abs=0.05)
    assert found["excitation"] == "1× pinion -> wheel"
    # At 1 % of damping the peak is within a half-power bandwidth of the mode.
    assert found["frequency_hz"] == pytest.approx(frequencies[mode], rel=0.02)
    assert found["frequency_hz"] == pytest.approx(28 * found["speed_rpm"] / 60.0)
    assert found["amplitude_m_per_s2"] == pytest.approx(np.sqrt(2.0) * found["rms_m_per_s2"], rel=0.01)
    branch = {one["name"]: one["rms_m_per_s2"] for one in result.document["curve"]["sensors"]}["top"]
    assert found["rms_m_per_s2"] == max(branch)
    # Bearings of a shaft carry its mesh force along the line of action between them, in the file as in the document.
    (motion,) = result.document["motions"]
    force = motion["gear_pairs"][0]["mean_force_n"]
    for shaft in ("input", "output"):
        parts = [one["mean_force_n"] for one in motion["bearings"] if one["name"].startswith(shaft)]
        assert len(parts) == 2
        assert np.hypot(*np.sum(parts, axis=0)[:2]) == pytest.approx(force, rel=1e-3)
    data = result.dataset["steady_bearing_force"]
    assert (data.dims, data.attrs["units"]) == (("steady_motion", "bearing", "direction", "period_time"), "N")
    for one in motion["bearings"]:
        own = data.sel(bearing=one["name"])[0]
        assert own.mean("period_time").values == pytest.approx(one["mean_force_n"], abs=1e-6 * force)
        assert own.std("period_time").values == pytest.approx(one["rms_force_n"], abs=1e-6 * force)
        moment = result.dataset["steady_bearing_moment"].sel(bearing=one["name"])[0].mean("period_time")
        assert moment.values == pytest.approx(one["mean_moment_n_m"], abs=1e-6 * force)


def test_decay_of_disturbances_by_the_floquet_multiplier() -> None:
    """Falls by a tenth each period of 20 ms: to a tenth in log 10 / log (1 / 0.9) = 21.85 of them."""
    from gearwhine.results.steady_state import _decay

    assert _decay(0.9, 0.02) == "the slowest disturbance falls to a tenth in 0.437 s"
    assert _decay(0.1, 0.02) == "the slowest disturbance falls to a tenth in 0.02 s"
    assert _decay(0.0, 0.02) == "disturbances fall at once"
    assert _decay(1.0, 0.02) == "the slowest disturbance stays"


@pytest.mark.slow
def test_a_motor_and_its_load_leave_the_steady_motion_as_it_is() -> None:
    """A free run and a run-up have the steady motion of their speed and torque of operation."""
    few = {"rotor.*.modes": 2}
    line = {"speed": ["0 rpm", "3000 rpm", "3300 rpm"], "torque": ["300 N*m", "150 N*m", "0 N*m"]}
    at_speed = gw.load("helical-pair", few).steady().document["motions"]
    free = {"transient.run": {"from": "2000 rpm", "time": "1 s"}, "operation.motor": line, "operation.load": line}
    up = {"transient.run": {"from": "2000 rpm", "to": "4000 rpm", "time": "1 s"}}
    for run in (free, up):
        changes = {**few, "transient.revolutions": "", "transient.discard": "", **run}
        assert gw.load("helical-pair", changes).steady().document["motions"] == at_speed
