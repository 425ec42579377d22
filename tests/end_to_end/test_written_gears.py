"""What `gears` writes of two unlike pairs, each number held against the physics that it claims to show."""

import json
from math import acos, cos, pi, sqrt, tan
from typing import Any, NamedTuple

import numpy as np
import pytest
import xarray as xr
from lopsided_case import GEARS, MODULE, PAIRS, PRESSURE_ANGLE, SPEEDS, TORQUES, force, lopsided

from gearwhine.cli import run_command

pytestmark = pytest.mark.slow

RELIEF = 6e-6
"""Amount at the tip of gear a [m]."""
PITCH_ERROR = 4e-6
"""Of one tooth of gear c [m]."""
SHAPES = {
    "mesh_stiffness": (("gear_pair", "mesh_phase"), "N/m"),
    "loaded_flank_stiffness": (("gear_pair", "mesh_phase"), "N/m"),
    "transmission_error": (("gear_pair", "mesh_phase"), "m"),
    "unloaded_transmission_error": (("gear_pair", "mesh_phase"), "m"),
    "transmission_error_harmonic": (("gear_pair", "harmonic"), "m"),
    "tooth_pair_position": (("gear_pair", "mesh_phase", "tooth_pair"), "1"),
    "load_share": (("gear_pair", "mesh_phase", "tooth_pair"), "1"),
    "contact_pressure": (("gear_pair", "mesh_phase", "tooth_pair"), "Pa"),
    "contact_point_position": (("gear_pair", "contact_point"), "1"),
    "contact_point_roll_angle": (("gear_pair", "side", "contact_point"), "rad"),
    "contact_point_radius": (("gear_pair", "side", "contact_point"), "m"),
    "contact_point_sliding": (("gear_pair", "side", "contact_point"), "1"),
    "flank_roll_angle": (("gear_pair", "side", "flank_place"), "rad"),
    "flank_deviation": (("gear_pair", "side", "flank_place"), "m"),
    "hunting_phase": (("gear_pair", "hunting_step"), "1"),
    "hunting_transmission_error": (("gear_pair", "hunting_step"), "m"),
    "harris_torque": (("gear_pair", "harris_load"), "N m"),
    "harris_phase": (("gear_pair", "harris_step"), "1"),
    "harris_transmission_error": (("gear_pair", "harris_load", "harris_step"), "m"),
}


class Written(NamedTuple):
    """A results file and the pairs of the summary."""

    data: xr.Dataset
    pairs: list[dict[str, Any]]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    folder = tmp_path_factory.mktemp("lopsided")
    case = folder / "lopsided.toml"
    case.write_text(lopsided(housing=False), encoding="utf-8")
    cumulative = ", ".join('"4 um"' if tooth == 3 else '"0 um"' for tooth in range(21))
    settings = (
        f"gear.a.tip_relief={{amount='{RELIEF} m', start_roll_angle='24 deg'}}",
        f"gear.c.errors={{pitch=[{cumulative}]}}",
        # Formulas of flanks that stand in line: under load these shafts, on bearings of unlike stiffness, tilt.
        "gear_pair.*.misalignment=0 rad",
    )
    changes = [part for setting in settings for part in ("--set", setting)]
    assert run_command(["gears", str(case), "-q", "-o", str(folder / "out"), *changes]) == 0
    summary = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))
    # As a whole: each quantity that is looked at would be sought in the file anew.
    return Written(xr.load_dataset(folder / "out" / "results.nc"), summary["pairs"])


def test_every_quantity_has_its_dimensions_and_unit(written: Written) -> None:
    found = {name: (written.data[name].dims, written.data[name].attrs["units"]) for name in SHAPES}
    assert found == SHAPES
    assert written.data.gear_pair.values.tolist() == [" -> ".join(pair) for pair in PAIRS]
    assert written.data.side.values.tolist() == ["driver", "driven"]


def test_pairs_are_told_by_their_teeth_and_torques(written: Written) -> None:
    for pair, told in zip(PAIRS, written.pairs, strict=True):
        driver = GEARS[pair[0]]
        assert (told["driver"], told["driven"]) == pair
        assert told["torque_n_m"] == pytest.approx(TORQUES[pair])
        assert told["mean_force_n"] == pytest.approx(force(pair))
        assert told["mesh_frequency_hz"] == pytest.approx(abs(SPEEDS[driver.rotor]) * driver.teeth / (2.0 * pi))
        for name, gear in zip(pair, told["gears"], strict=True):
            assert (gear["name"], gear["teeth"], gear["face_width_m"]) == (name, GEARS[name].teeth, 0.018)
            diameters = gear["diameters_m"]
            assert diameters["base"] == pytest.approx(2.0 * GEARS[name].base_radius)
            assert diameters["tip"] == pytest.approx(MODULE * (GEARS[name].teeth + 2))
        period = 2.0 * pi / driver.teeth
        rolled = np.array(told["roll_angle_rad"])
        assert rolled[0] == 0.0
        assert 0.98 * period < rolled[-1] <= period * (1.0 + 1e-9)


def test_curves_are_what_their_names_say(written: Written) -> None:
    """Under the load teeth yield: k TE is the force where two flanks are alike and all that touch, as of c and d."""
    for number, told in enumerate(written.pairs):
        row = written.data.isel(gear_pair=number)
        stiffness, loaded, error, unloaded = (
            row[name].values
            for name in (
                "mesh_stiffness",
                "loaded_flank_stiffness",
                "transmission_error",
                "unloaded_transmission_error",
            )
        )
        # Between the pairs that are on the path, by the summary's own curve.
        phases = np.array(told["roll_angle_rad"]) / (2.0 * pi / GEARS[told["driver"]].teeth)
        expected = np.interp(0.31, row.mesh_phase.values, stiffness)
        assert np.interp(0.31, phases, told["stiffness"]) == pytest.approx(expected, rel=1e-3)
        figures = told["stiffness_n_per_m"]
        assert figures["min"] == pytest.approx(stiffness.min(), rel=0.02)
        assert figures["max"] == pytest.approx(stiffness.max(), rel=0.02)
        assert figures["mean"] == pytest.approx(stiffness.mean(), rel=0.01)
        assert figures["loaded_mean"] == pytest.approx(loaded.mean(), rel=0.01)
        # The relief of a keeps some of the path from touching under load; corners of c beyond it touch.
        assert np.abs(loaded - stiffness).max() > 0.02 * stiffness.max()
        assert error.mean() - unloaded.mean() == pytest.approx(told["mean_force_n"] / loaded.mean(), rel=0.25)
        harmonics = 2.0 * np.abs(np.fft.rfft(error))[1:9] / error.size
        assert row.transmission_error_harmonic.values == pytest.approx(harmonics, rel=0.05, abs=0.01 * harmonics[0])
        assert told["transmission_error_m"]["harmonics"] == row.transmission_error_harmonic.values.tolist()
        assert told["transmission_error_m"]["peak_to_peak"] == pytest.approx(np.ptp(error), rel=0.02)


def test_pairs_of_teeth_share_the_load_and_press(written: Written) -> None:
    """A pair's pressure goes by Hertz with the root of its load per radius of curvature in series."""
    for pair, number in zip(PAIRS, range(2), strict=True):
        row = written.data.isel(gear_pair=number)
        share = row.load_share.values
        assert np.nansum(share, axis=1) == pytest.approx(1.0)
        driver, driven = (GEARS[name].base_radius for name in pair)
        pitch = pi * MODULE * cos(PRESSURE_ANGLE)
        start = row.contact_point_radius.sel(side="driver").values[0]
        rho = sqrt(start**2 - driver**2) + row.tooth_pair_position.values * pitch
        whole = (driver + driven) * tan(PRESSURE_ANGLE)
        relative = rho * (whole - rho) / whole
        modulus = 206e9 / (1.0 - 0.3**2) / 2.0
        expected = np.sqrt(share * force(pair) * modulus / (pi * 0.018 * relative))
        found = row.contact_pressure.values
        inside = np.isfinite(found) & (share > 0.05) & (row.tooth_pair_position.values > 0.05)
        assert np.count_nonzero(inside) > 400
        assert found[inside] == pytest.approx(expected[inside], rel=0.02)
        positions = row.tooth_pair_position.values
        known = np.isfinite(row.path_position.values)
        place, along, roll = (
            row[name].values[known] for name in ("path_position", "path_load_share", "path_roll_angle")
        )
        assert (np.diff(place) >= 0.0).all()
        # A base pitch on the line of action is that arc of the base circle.
        assert np.ptp(roll) == pytest.approx(np.ptp(place) * pitch / driver)
        assert written.pairs[number]["load_sharing"]["largest_share"] == pytest.approx(along.max())
        for at in (0.1, 0.5, 1.0, 1.4):
            nearest = np.nanargmin(np.abs(positions - at))
            assert np.interp(at, place, along) == pytest.approx(share.ravel()[nearest], abs=0.03)
        assert written.pairs[number]["contact_pressure_pa"]["max"] == pytest.approx(np.nanmax(found), rel=0.1)


def test_points_of_the_path_lie_on_both_gears(written: Written) -> None:
    for pair, number in zip(PAIRS, range(2), strict=True):
        row = written.data.isel(gear_pair=number)
        driver, driven = (GEARS[name] for name in pair)
        tips = [0.5 * MODULE * (gear.teeth + 2) for gear in (driver, driven)]
        radii = row.contact_point_radius
        # It ends at the driver's tip, and begins at the driven gear's.
        assert radii.sel(side="driver").values[-1] == pytest.approx(tips[0])
        assert radii.sel(side="driven").values[0] == pytest.approx(tips[1])
        for side, gear in (("driver", driver), ("driven", driven)):
            roll = np.tan([acos(gear.base_radius / radius) for radius in radii.sel(side=side).values])
            assert row.contact_point_roll_angle.sel(side=side).values == pytest.approx(roll)
        sliding = row.contact_point_sliding
        # Of the driver, behind the pitch point what recedes slides backwards.
        assert sliding.sel(side="driver").values[0] < 0.0 < sliding.sel(side="driver").values[-1]
        assert sliding.sel(side="driven").values[0] > 0.0 > sliding.sel(side="driven").values[-1]
        told = written.pairs[number]["path_of_contact"]
        for side in ("driver", "driven"):
            assert [one[f"{side}_radius_m"] for one in told] == radii.sel(side=side).values.tolist()
            assert [one[f"{side}_specific_sliding"] for one in told] == sliding.sel(side=side).values.tolist()


def test_relief_takes_material_from_the_tip(written: Written) -> None:
    flanks = written.data.flank_deviation
    relieved = flanks.sel(gear_pair="a -> b", side="driver").values
    assert relieved[-1] == pytest.approx(-RELIEF)
    assert relieved[0] == 0.0
    assert np.abs(flanks.sel(gear_pair="a -> b", side="driven").values).max() == 0.0
    assert np.abs(flanks.sel(gear_pair="c -> d").values).max() == 0.0


def test_one_tooth_out_of_place_shows_over_the_hunting_period(written: Written) -> None:
    data = written.data.sel(gear_pair="c -> d")
    assert written.pairs[0]["transmission_error_m"]["over_hunting_period"] is None
    assert np.isnan(written.data.hunting_transmission_error.sel(gear_pair="a -> b").values).all()
    told = written.pairs[1]["transmission_error_m"]["over_hunting_period"]
    error = data.hunting_transmission_error.values
    assert told["peak_to_peak"] == pytest.approx(np.nanmax(error) - np.nanmin(error), rel=1e-9)
    assert told["peak_to_peak"] > written.pairs[1]["transmission_error_m"]["peak_to_peak"] + 0.3 * PITCH_ERROR
    assert np.nanmax(data.hunting_phase.values) <= 21 * 50


def test_harris_maps_go_by_torque(written: Written) -> None:
    for pair, number in zip(PAIRS, range(2), strict=True):
        row, told = written.data.isel(gear_pair=number), written.pairs[number]["harris_map"]
        assert row.harris_torque.values == pytest.approx(told["torque_n_m"])
        assert row.harris_torque.values[[0, -1]] == pytest.approx([0.1 * TORQUES[pair], 2.0 * TORQUES[pair]])
        errors = row.harris_transmission_error.values
        swings = np.nanmax(errors, axis=1) - np.nanmin(errors, axis=1)
        assert told["peak_to_peak_m"] == pytest.approx(swings.tolist(), rel=0.05)
        assert told["quietest_torque_n_m"] == told["torque_n_m"][int(np.argmin(told["peak_to_peak_m"]))]


def test_the_best_relief_beside_none(written: Written) -> None:
    for pair, told in zip(PAIRS, written.pairs, strict=True):
        best = told["optimal_tip_relief"]
        assert best["torque_n_m"] == pytest.approx(TORQUES[pair])
        assert best["aim"]["without_relief"] == pytest.approx(best["peak_to_peak_without_relief_m"], rel=1e-6)
        assert best["aim"]["best"] == pytest.approx(best["peak_to_peak_m"], rel=1e-6)
        assert best["aim"]["best"] < 0.5 * best["aim"]["without_relief"]
        as_given = told["transmission_error_m"]["peak_to_peak"]
        if pair == ("a", "b"):
            assert best["peak_to_peak_as_given_m"] == pytest.approx(as_given, rel=0.02)
            assert as_given < best["peak_to_peak_without_relief_m"]
