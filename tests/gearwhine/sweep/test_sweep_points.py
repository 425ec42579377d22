"""Points of a sweep: identification, what a machine takes of a housing, and the collected dataset."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from case_housings import mesh_of
from coupled_cases import coupled
from matplotlib.figure import Figure

import gearwhine
from gearwhine.case import CaseError, load_case, swept_keys
from gearwhine.case.input_files import file_contents
from gearwhine.coupling.analyses.transient import solve_transient
from gearwhine.coupling.sweep.reduced_motion import ReducedMotion
from gearwhine.figures.machine.sweep import _draw_mesh_orders
from gearwhine.figures.spectra import draw_waterfall
from gearwhine.meshes import read_mesh, write_mesh
from gearwhine.solutions import Failure
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import plan_of, reduce_housing
from gearwhine.study_folder import StudyFolder
from gearwhine.sweep import PointResult, SweptPoint, collected_sweep, sweep_document, sweep_points
from gearwhine.sweep.run import run_sweep
from gearwhine.sweep.solution import outdated_points, read_point, solve_point, write_point
from gearwhine.workers import code_digest

COARSE = ("housing.box.mesh_size=50 mm", "transient.revolutions=2", "transient.discard=1", "transient.tolerance=1e-3")


def points_of(*settings: str, over: tuple[str, ...] = ("operation.speed=3000 rpm,6000 rpm",)):
    loaded = load_case("small-gearbox", settings)
    return sweep_points(loaded.source, swept_keys(loaded.case, over))


def test_a_point_is_known_again_by_what_bears_on_it() -> None:
    """Titles, measured modes and other points do not; the torque does, and each part of the case its own modes."""
    slow, fast = points_of()
    assert slow.key != fast.key
    assert (slow.modes_key, slow.housing_key) == (fast.modes_key, fast.housing_key)
    assert [point.key for point in points_of("title=Another", "measured=")] == [slow.key, fast.key]
    grown = points_of(over=("operation.speed=3000 rpm,4000 rpm,6000 rpm",))
    assert [grown[0].file, grown[2].file] == [slow.file, fast.file]
    assert points_of("operation.torque=50 N*m")[0].key != slow.key
    damped = points_of("housing.damping_ratio=0.02")[0]
    assert damped.modes_key == slow.modes_key
    assert damped.housing_key != slow.housing_key
    assert points_of("housing.box.wall=11 mm")[0].modes_key != slow.modes_key


def test_a_point_is_another_one_where_a_file_read_with_its_mesh_has_changed(tmp_path: Path) -> None:
    """A box 10 % longer in the deck that the named one includes: other points, other modes, another housing."""
    source = (Path(gearwhine.__file__).parent / "cases" / "small-gearbox.toml").read_text()
    begin, end = source.index("[housing.box]"), source.index("[[housing.seat]]")
    case_file = tmp_path / "meshed.toml"
    case_file.write_text(f'{source[:begin]}[housing.mesh]\nfile = "deck.inp"\n\n{source[end:]}')
    write_mesh(mesh_of(load_case("small-gearbox", COARSE[:1]).case), tmp_path / "box.inp")
    (tmp_path / "deck.inp").write_text("*INCLUDE, INPUT=box.inp\n")
    loaded = load_case(str(case_file))
    keys = swept_keys(loaded.case, ["operation.torque=50 N*m,60 N*m"])
    before = sweep_points(loaded.source, keys)
    digests = file_contents([tmp_path / "deck.inp"])
    mesh = read_mesh(tmp_path / "box.inp")
    write_mesh(replace(mesh, points=mesh.points * np.array([1.0, 1.1, 1.0])), tmp_path / "box.inp")
    assert sweep_points(loaded.source, keys) == before  # of the case that was read
    after = sweep_points(load_case(str(case_file)).source, keys)
    for old, new in zip(before, after, strict=True):
        assert old.key != new.key
        assert old.modes_key != new.modes_key
        assert old.housing_key != new.housing_key
    assert file_contents([tmp_path / "deck.inp"]) != digests


def test_a_grid_goes_through_its_last_key_first() -> None:
    points = points_of(over=("operation.speed=3000 rpm,6000 rpm", "operation.torque=10 N*m:30 N*m:3"))
    assert [point.place for point in points] == [(i, j) for i in range(2) for j in range(3)]
    assert [point.case.operation.torque for point in points[:3]] == [10.0, 20.0, 30.0]  # type: ignore[union-attr]
    assert len({point.file for point in points}) == 6


def test_what_is_wrong_at_several_points_is_said_together() -> None:
    with pytest.raises(CaseError) as caught:
        points_of(over=("gear.pinion.teeth=1,28", "operation.torque=ten,71"))
    assert len(caught.value.problems) == 2
    assert all(str(problem).startswith("sweep, ") for problem in caught.value.problems)


@pytest.fixture(scope="module")
def solved() -> tuple:
    (point, _) = points_of(*COARSE, "acoustics.method=erp", "acoustics.mesh_size=40 mm")
    housing = solve_housing(point.case)
    result = solve_point(point.case, reduce_housing(point.case, housing), code_digest())
    assert isinstance(result, PointResult)
    return point, housing, result


@pytest.mark.slow
def test_a_point_is_the_main_job_bit_for_bit(solved: tuple) -> None:
    point, housing, result = solved
    machine = coupled(point.case, housing)
    whole = solve_transient(machine, plan_of(point.case))
    motion = result.motion
    for name, spectrum in whole.sensor_spectra.items():
        np.testing.assert_array_equal(motion.sensor_spectra[name], spectrum.amplitude[: motion.orders.size])
    # Orders are cycles for each turn: one turn is recorded, so they are whole numbers.
    assert motion.orders == pytest.approx(np.arange(motion.orders.size), abs=1e-9)


def test_a_point_on_file_reads_back_the_same(solved: tuple, tmp_path: Path) -> None:
    point, _, result = solved
    write_point(tmp_path, tmp_path, point, result)
    back = read_point(tmp_path, point)
    assert isinstance(back, PointResult)
    assert back.document == result.document
    found, written = back.motion, result.motion
    for group in ("sensor_spectra", "force_spectra", "bearing_force_mean", "bearing_force_rms"):
        assert list(getattr(found, group)) == list(getattr(written, group))
        for name, values in getattr(written, group).items():
            np.testing.assert_array_equal(getattr(found, group)[name], values)
    np.testing.assert_array_equal(found.orders, written.orders)
    assert written.resonances is not None
    assert found.resonances is not None
    assert written.resonances.mode_rates.shape[2] == written.resonances.line_rates.shape[1] > 0
    for field in fields(written.resonances):
        np.testing.assert_array_equal(getattr(found.resonances, field.name), getattr(written.resonances, field.name))
    # Another content under the same name is not this point, nor is half a file.
    assert read_point(tmp_path, replace(point, key="another")) is None
    file = tmp_path / "points" / point.file
    file.write_bytes(file.read_bytes()[:100])
    assert read_point(tmp_path, point) is None
    assert outdated_points(tmp_path, (point,)) == []
    assert outdated_points(tmp_path, ()) == [file]


def test_a_damaged_point_is_no_point(solved: tuple, tmp_path: Path) -> None:
    """Whichever bits of its file have flipped, and wherever it was cut: it is solved again, and never waited for."""
    point, _, result = solved
    write_point(tmp_path, tmp_path, point, result)
    file = tmp_path / "points" / point.file
    whole, random = file.read_bytes(), np.random.default_rng(5)
    for place in random.integers(0, len(whole), 300):
        damaged = bytearray(whole)
        damaged[place] ^= 1 << int(random.integers(8))
        file.write_bytes(damaged)
        assert read_point(tmp_path, point) is None
        file.write_bytes(whole[:place])
        assert read_point(tmp_path, point) is None
    file.write_bytes(whole)
    assert read_point(tmp_path, point) is not None
    # Whoever reads NetCDF reads it.
    with xr.open_dataset(file) as opened:
        np.testing.assert_array_equal(opened["order"], result.motion.orders)


def test_a_failure_on_file_reads_back_the_same(solved: tuple, tmp_path: Path) -> None:
    failure = Failure("it diverged", "a traceback")
    write_point(tmp_path, tmp_path, solved[0], failure)
    assert read_point(tmp_path, solved[0]) == failure


def test_a_worker_with_other_code_solves_nothing(solved: tuple) -> None:
    failure = solve_point(solved[0].case, None, "of another version")
    assert isinstance(failure, Failure)
    assert "another version of gearwhine" in failure.message
    assert failure.traceback == ""


def test_spectra_of_unlike_lengths_meet_on_their_orders(solved: tuple) -> None:
    """Two turns recorded give lines at every half order: both stand on the finer axis, the coarser with gaps."""
    point, _, result = solved
    case = load_case("small-gearbox", COARSE).case
    keys = swept_keys(case, ["transient.discard=1,0"])
    motion = replace(
        result.motion,
        orders=np.arange(5) / 2.0,
        sensor_spectra={name: np.arange(5.0) for name in result.motion.sensor_spectra},
        force_spectra={name: np.arange(5.0) for name in result.motion.force_spectra},
    )
    finer = replace(result, motion=motion)
    swept = [
        SweptPoint(replace(point, place=(0,)), result),
        SweptPoint(replace(point, place=(1,)), finer, False),
    ]
    data = collected_sweep(case, keys, swept)
    assert data.order.values[:5].tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    top = data.sensor_spectrum.sel(sensor="top")
    np.testing.assert_array_equal(top[1, :5], np.arange(5.0))
    np.testing.assert_array_equal(top[0, [0, 2, 4]], result.motion.sensor_spectra["top"][:3])
    assert np.isnan(top[0, [1, 3]]).all()
    assert np.isnan(top[1, 5:]).all()


def test_words_are_swept_too(solved: tuple) -> None:
    point, _, result = solved
    keys = swept_keys(point.case, ["rotor.input.mass=lumped,distributed"])
    swept = [
        SweptPoint(replace(point, place=(0,)), result),
        SweptPoint(replace(point, place=(1,)), Failure("no"), False),
    ]
    data = collected_sweep(point.case, keys, swept)
    assert data.rotor_input_mass.values.tolist() == ["lumped", "distributed"]
    assert data.done.values.tolist() == [True, False]
    assert data.failure.values.tolist() == ["", "no"]


def test_a_waterfall_draws_a_row_for_each_spectrum() -> None:
    frequencies = np.outer([1.0, 2.0, 3.0], np.arange(50.0))
    heights = np.full((3, 50), 1e-3)
    heights[2] = np.nan
    figure = draw_waterfall("three", [1, 2, 3], frequencies, heights, value_name="speed", unit="m/s²")
    rows = [line for line in figure.axes[0].lines if len(line.get_xdata()) > 10]
    assert len(rows) == 2
    # The second spectrum reaches twice as far as the first.
    assert [float(max(line.get_xdata())) for line in rows] == [49.0, 98.0]
    with pytest.raises(ValueError, match="no spectrum"):
        draw_waterfall("none", [1, 2, 3], frequencies, np.nan * heights, value_name="speed", unit="m/s²")
    with pytest.raises(ValueError, match="not"):
        draw_waterfall("unlike", [1, 2], frequencies, heights, value_name="speed", unit="m/s²")


def made_up(number: int) -> PointResult:
    """A result whose every figure tells its point."""
    load = number + np.array([0.1, 0.2, 0.3, 0.4, 0.5])
    pairs = [
        {
            "mean_force_n": 100.0 * number + one,
            "peak_force_n": 200.0 * number + one,
            "mesh_frequency_hz": 300.0 * number + one,
            "contact_loss_fraction": 0.01 * number + 0.001 * one,
        }
        for one in (1, 2)
    ]
    peaks = [{"frequency_hz": 10.0 * number, "amplitude_m_per_s2": 0.5 * number}]
    return PointResult(
        document={
            "speed_rpm": -60.0 * (number + 1),
            "trusted_below_hz": 900.0 + number,
            "energy_error": 1e-5 * number,
            "steps": 1000 + number,
            "sensors": [{"name": "top", "rms_m_per_s2": 7.0 * number, "peaks": peaks}],
            "gear_pairs": pairs,
        },
        motion=ReducedMotion(
            orders=np.array([0.0, 1.0, 2.5]),
            sensor_spectra={"top": number + np.array([0.0, 1.0, 2.0])},
            force_spectra={"a -> b": number + np.array([3.0, 4.0, 5.0]), "c -> d": number + np.array([6.0, 7.0, 8.0])},
            bearing_force_mean={"left": load, "right": -load},
            bearing_force_rms={"left": 10.0 * load, "right": 20.0 * load},
            window="hann",
        ),
    )


def test_every_figure_of_a_point_stands_at_its_place() -> None:
    """On a square grid, where rows and columns could be taken for each other."""
    over = ("operation.speed=-3000 rpm,-6000 rpm", "operation.torque=10 N*m,30 N*m")
    points = points_of(over=over)
    keys = swept_keys(load_case("small-gearbox").case, over)
    swept = [SweptPoint(point, made_up(number), resumed=number == 2) for number, point in enumerate(points)]
    data = collected_sweep(points[0].case, keys, swept)
    for number, (i, j) in enumerate([(0, 0), (0, 1), (1, 0), (1, 1)]):
        at = data.isel(speed=i, operation_torque=j)
        assert float(at.rotation_speed) == -60.0 * (number + 1)
        # Orders of a machine that turns clockwise have frequencies as well.
        assert at.frequency.values == pytest.approx((number + 1) * np.array([0.0, 1.0, 2.5]))
        assert (float(at.trusted_limit), float(at.steps)) == (900.0 + number, 1000 + number)
        assert at.sensor_spectrum.values.tolist() == [[number + one for one in (0.0, 1.0, 2.0)]]
        assert at.mesh_force_spectrum.sel(contact="c -> d").values.tolist() == [number + one for one in (6.0, 7.0, 8.0)]
        assert float(at.sensor_rms.sel(sensor="top")) == 7.0 * number
        assert float(at.sensor_peak_frequency[0, 0]) == 10.0 * number
        assert float(at.sensor_peak_amplitude[0, 0]) == 0.5 * number
        for which, contact in enumerate(("a -> b", "c -> d"), start=1):
            pair = at.sel(contact=contact)
            assert float(pair.mesh_force_mean) == 100.0 * number + which
            assert float(pair.mesh_force_peak) == 200.0 * number + which
            assert float(pair.mesh_frequency) == 300.0 * number + which
            assert float(pair.contact_loss) == 0.01 * number + 0.001 * which
        for name, mean, rms in (("left", 1.0, 10.0), ("right", -1.0, 20.0)):
            load = number + np.array([0.1, 0.2, 0.3, 0.4, 0.5])
            bearing = at.sel(bearing=name)
            assert bearing.bearing_force_mean.values == pytest.approx(mean * load[:3])
            assert bearing.bearing_moment_mean.values == pytest.approx(mean * load[3:])
            assert bearing.bearing_force_rms.values == pytest.approx(rms * load[:3])
            assert bearing.bearing_moment_rms.values == pytest.approx(rms * load[3:])
    units = {name: data[name].attrs["units"] for name in ("speed", "operation_torque", "frequency", "mesh_frequency")}
    assert units == {"speed": "rpm", "operation_torque": "N*m", "frequency": "Hz", "mesh_frequency": "Hz"}
    assert {data[f"bearing_{kind}_mean"].attrs["units"] for kind in ("force", "moment")} == {"N", "N m"}
    document = sweep_document(keys, swept)
    assert (document["done"], document["failed"], document["resumed"]) == (4, 0, 1)
    assert [row["resumed"] for row in document["points"]] == [False, False, True, False]
    assert [row["values"]["operation_torque"] for row in document["points"]] == [10.0, 30.0, 10.0, 30.0]


def test_frequencies_of_a_machine_that_turns_the_other_way_are_positive() -> None:
    """An order of 2.5 at 6000 rpm is a line at 250 Hz, in either sense."""
    over = ("operation.speed=-3000 rpm,-6000 rpm",)
    points = points_of(over=over)
    keys = swept_keys(load_case("small-gearbox").case, over)
    results = [made_up(1), made_up(2)]
    for result, rpm in zip(results, (-3000.0, -6000.0), strict=True):
        result.document["speed_rpm"] = rpm
        for pair in result.document["gear_pairs"]:
            pair["mesh_frequency_hz"] = 28.0 * abs(rpm) / 60.0
    swept = [SweptPoint(point, result, False) for point, result in zip(points, results, strict=True)]
    data = collected_sweep(points[0].case, keys, swept)
    assert data.rotation_speed.values.tolist() == [-3000.0, -6000.0]
    assert data.frequency.values == pytest.approx(np.outer([50.0, 100.0], [0.0, 1.0, 2.5]))
    # The multiples of the mesh frequency are straight lines from standstill to the fastest point.
    axes = Figure().subplots()
    _draw_mesh_orders(axes, data, 3000.0)
    ends = np.array([line.get_xydata()[1] for line in axes.get_lines()])
    assert ends[:2] == pytest.approx(np.array([[-6000.0, 2800.0], [-3000.0 * 60.0 / 56.0, 3000.0]]))


def test_points_of_other_code_are_not_taken_up(monkeypatch: pytest.MonkeyPatch) -> None:
    before = points_of()[0].key
    monkeypatch.setattr("gearwhine.solutions.code_digest", lambda: "another")
    assert points_of()[0].key != before


def test_points_of_the_case_as_it_was_are_cleared_away(tmp_path: Path) -> None:
    """What is on file is taken up, without workers; a point that the sweep no longer has goes."""
    slow, fast = points_of()
    for number, point in enumerate((slow, fast)):
        write_point(tmp_path, tmp_path, point, made_up(number))
    (taken,) = run_sweep([slow], StudyFolder(tmp_path, workers=1))
    assert taken.resumed
    assert [path.name for path in (tmp_path / "points").iterdir()] == [slow.file]
