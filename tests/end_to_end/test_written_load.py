"""What `load` writes of a machine in its housing, each number held against statics, the case, or another command.

The machine has nothing alike: two gear pairs, three shafts, six bearings, unequal in all, in a coarse box.
"""

import json
from math import pi
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
import xarray as xr
from lopsided_case import (
    AXES,
    GEARS,
    HALF_FACE,
    HELD_AT,
    PAIRS,
    SPEEDS,
    START,
    STIFFNESS,
    TORQUE,
    TORQUES,
    bearing_forces,
    force,
    imbalance,
    lopsided,
)

import gearwhine as gw
from gearwhine.case import load_case
from gearwhine.output.sections import Table
from gearwhine.results.operating_point import sections
from gearwhine.solve.housing_modes import solve_housing

pytestmark = pytest.mark.slow

WIDTH = 2.0 * HALF_FACE
UNHEARD = ["housing.sensor=[]"]
BEARINGS = [f"{rotor}-{end}" for rotor in AXES for end in HELD_AT]


class Written(NamedTuple):
    """The summary and the arrays of the operating point, and the case's file."""

    summary: dict[str, Any]
    data: xr.Dataset
    case: Path


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    folder = tmp_path_factory.mktemp("lopsided")
    case = folder / "lopsided.toml"
    case.write_text(lopsided(limit=1500.0), encoding="utf-8")
    # Without sensors, whose lines take most of the time.
    gw.load(case, UNHEARD).operating_point(over_torque=True, sensitivity=True).write(folder / "out", pictures=False)
    (summary,), (data,) = ((folder / "out").rglob(name) for name in ("summary.json", "results.nc"))
    return Written(json.loads(summary.read_text(encoding="utf-8")), xr.load_dataset(data), case)


def named(rows: list[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    return {row["name"]: row for row in rows}


def test_teeth_and_bearings_carry_what_statics_says(written: Written) -> None:
    """By the levers, but for the place of the force on the face; and in balance with the moments."""
    pairs = {(row["driver"], row["driven"]): row for row in written.summary["gear_pairs"]}
    assert list(pairs) == list(PAIRS)
    for pair, row in pairs.items():
        assert row["force_n"] == pytest.approx(force(pair), rel=1e-8)
    bearings = named(written.summary["bearings"])
    assert list(bearings) == BEARINGS
    by_levers = bearing_forces({pair: force(pair) + 0.0j for pair in PAIRS})
    for name, row in bearings.items():
        assert row["shaft"] == name.split("-")[0]
        assert row["seat"] == name
        expected = np.real(by_levers[name])
        # The force may stand anywhere on the face, half of it from the middle.
        np.testing.assert_allclose(row["force_n"][:2], expected, atol=HALF_FACE / 0.16 * sum(map(force, PAIRS)))
        assert row["force_n"][2] == pytest.approx(0.0, abs=1e-6)
    forces = {name: [complex(value) for value in row["force_n"][:2]] for name, row in bearings.items()}
    moments = {name: [complex(value) for value in row["moment_n_m"]] for name, row in bearings.items()}
    for rotor in AXES:
        left = np.real(imbalance(rotor, {pair: force(pair) + 0.0j for pair in PAIRS}, forces, moments))
        np.testing.assert_allclose(left[:2], 0.0, atol=1e-6 * TORQUE)
        assert np.abs(left[2:]).max() <= HALF_FACE * sum(map(force, PAIRS))


def test_a_bearing_yields_by_its_own_stiffness(written: Written) -> None:
    for (rotor, end), (xx, yy, xy, yx) in STIFFNESS.items():
        row = named(written.summary["bearings"])[f"{rotor}-{end}"]
        own = np.linalg.solve([[xx, xy], [yx, yy]], row["force_n"][:2])
        np.testing.assert_allclose(row["displacement_m"][:2], own, rtol=1e-8)
        np.testing.assert_allclose(np.array(row["stiffness"])[:2, :2], [[xx, xy], [yx, yy]], rtol=1e-9)
        assert row["tilt_rad"] == pytest.approx(np.hypot(*row["rotation_rad"]), rel=1e-9)


def test_shafts_stand_in_their_bearings_and_these_in_their_seats(written: Written) -> None:
    """A shaft's motion at a bearing is that of the seat and the bearing's own deflection together."""
    data, bearings = written.data, named(written.summary["bearings"])
    for rotor in AXES:
        shaft = data.sel(deflected_shaft=rotor)
        for end, at in HELD_AT.items():
            row = bearings[f"{rotor}-{end}"]
            places = shaft.shaft_position.values
            for axis in (0, 1):
                moved = np.interp(at, places, shaft.shaft_displacement.values[axis])
                expected = row["seat_displacement_m"][axis] + row["displacement_m"][axis]
                assert moved == pytest.approx(expected, rel=2e-3, abs=2e-9), (rotor, end, axis)
            assert np.abs(row["seat_displacement_m"]).max() > 0.02 * np.abs(row["displacement_m"]).max()


def test_seats_yield_by_the_modes_of_the_housing(written: Written) -> None:
    """The work of the forces on the seats is that of the modes and, for a part, of what is left to higher ones."""
    housing = solve_housing(load_case(str(written.case), UNHEARD).case)
    bearings = named(written.summary["bearings"])
    forces = np.array([row["force_n"] + row["moment_n_m"] for row in bearings.values()])
    motions = np.array([row["seat_displacement_m"] + row["seat_rotation_rad"] for row in bearings.values()])
    work = float(np.sum(forces * motions))
    by_modes = np.einsum("bm,nbm->n", forces, housing.record.seat_motions[:, :, :5])
    omega = 2.0 * pi * housing.modes.frequencies_hz
    carried = float(np.sum((by_modes[: omega.size] / omega) ** 2))
    assert 0.2 * work < carried < 1.001 * work


def test_a_pair_s_misalignment_is_the_sum_of_its_causes_and_over_the_face(written: Written) -> None:
    rows = written.summary["gear_pairs"]
    for row, pair in zip(rows, PAIRS, strict=True):
        causes = row["misalignment_by_cause_rad"]
        assert row["misalignment_rad"] == pytest.approx(sum(causes.values()), rel=1e-9)
        assert row["misalignment_over_face_m"] == pytest.approx(WIDTH * row["misalignment_rad"], rel=1e-9)
        assert row["line_load_n_per_m"]["mean"] == pytest.approx(force(pair) / WIDTH, rel=1e-8)
        assert row["line_load_n_per_m"]["maximum"] == pytest.approx(row["k_h_beta"] * force(pair) / WIDTH, rel=1e-6)
        assert all(causes[name] != 0.0 for name in ("shafts", "bearings", "housing"))
    assert abs(rows[0]["misalignment_rad"]) != pytest.approx(abs(rows[1]["misalignment_rad"]), rel=0.05)


def test_the_file_has_the_numbers_of_the_summary_by_their_names(written: Written) -> None:
    data = written.data
    for row in written.summary["bearings"]:
        own = data.sel(loaded_bearing=row["name"])
        for name, key in (
            ("bearing_mean_force", "force_n"),
            ("bearing_mean_moment", "moment_n_m"),
            ("bearing_displacement", "displacement_m"),
            ("seat_displacement", "seat_displacement_m"),
            ("seat_rotation", "seat_rotation_rad"),
            ("bearing_tilt", "tilt_rad"),
        ):
            np.testing.assert_allclose(own[name].values, row[key], rtol=1e-12)
    for number, row in enumerate(written.summary["gear_pairs"]):
        own = data.isel(loaded_pair=number)
        assert float(own.misalignment) == row["misalignment_rad"]
        for cause, value in row["misalignment_by_cause_rad"].items():
            assert float(own.misalignment_by_cause.sel(cause=cause)) == value
        # The line load on the face carries the pair's force.
        mean = float(own.face_mean_line_load.mean())
        assert mean == pytest.approx(force(PAIRS[number]) / WIDTH, rel=0.02)


def test_over_torque_a_machine_of_springs_yields_as_the_torque(written: Written) -> None:
    """Twice the torque is twice the misalignment, but for the teeth's contact, whose small part is not linear."""
    data = written.data
    torques = data.load_torque.values
    assert np.isclose(torques, TORQUE).any()
    own = [row["misalignment_rad"] for row in written.summary["gear_pairs"]]
    over = data.misalignment_over_torque.transpose("load_torque", "loaded_pair").values
    at = int(np.argmin(np.abs(torques - TORQUE)))
    np.testing.assert_allclose(over[at], own, rtol=1e-6)
    np.testing.assert_allclose(over / torques[:, None], np.broadcast_to(over[at] / TORQUE, over.shape), rtol=0.03)


def test_tables_show_each_number_in_its_row_and_unit(written: Written) -> None:
    tables = [table for one in sections(written.summary) for table in one.content if isinstance(table, Table)]
    cells = {}
    for table in tables:
        columns, rows = table.filled()
        headings = [column.heading.replace("\n", " ") for column in columns]
        for row in rows:
            cells.setdefault(table.caption.split(",")[0], []).append(dict(zip(headings, row, strict=True)))
    shown = {row["bearing"]: row for row in cells["Force and tilting moment of the shafts on their bearings"]}
    for name, row in named(written.summary["bearings"]).items():
        for axis, value in zip("xy", row["force_n"], strict=False):
            assert float(shown[name][f"{axis} [N]"]) == pytest.approx(value, abs=0.51)
        assert float(shown[name]["tilt [µrad]"]) == pytest.approx(1e6 * row["tilt_rad"], abs=0.51)
    ranked = [row for caption, rows in cells.items() if caption.startswith("Change by a step") for row in rows]
    assert {row["pair"] for row in ranked} == {"a → b", "c → d"}
    changes = {
        (
            influence["parameter"],
            influence["kind"].removeprefix("bearing "),
            f"{one['driver']} → {one['driven']}",
        ): one
        for influence in written.summary["sensitivity"]
        for one in influence["gear_pairs"]
    }
    for row in ranked:
        pair = changes[row["parameter"], row["of"], row["pair"]]
        assert float(row["misaligned [µrad]"]) == pytest.approx(1e6 * pair["misalignment_rad"], abs=6e-4)
        nanometres = 1e9 * pair["transmission_error_peak_to_peak_m"]
        assert float(row["TE p-p [nm]"]) == pytest.approx(nanometres, abs=6e-3)


def test_a_stiffer_bearing_changes_the_pairs_as_ranked(written: Written) -> None:
    """A bearing's step of the table, solved anew: to first order of a hundredth of it."""
    name = "middle-front"
    number = BEARINGS.index(name)
    xx, yy, xy, yx = (1.001 * value for value in STIFFNESS["middle", "front"])
    stiffer = f"bearing.{number}.stiffness={{ xx = {xx}, yy = {yy}, xy = {xy}, yx = {yx} }}"
    found = gw.load(written.case, [*UNHEARD, stiffer]).operating_point().document
    (row,) = [
        one for one in written.summary["sensitivity"] if (one["parameter"], one["kind"]) == (name, "bearing stiffness")
    ]
    assert row["step"] == "+10 %"
    for before, after, told in zip(written.summary["gear_pairs"], found["gear_pairs"], row["gear_pairs"], strict=True):
        change = after["misalignment_rad"] - before["misalignment_rad"]
        assert change == pytest.approx(0.01 * told["misalignment_rad"], rel=0.02, abs=1e-12)


def test_names_of_the_case_are_the_machine_s() -> None:
    """What these tests rest on: no two shafts, bearings or pairs have a number in common."""
    assert len(set(STIFFNESS.values())) == len(STIFFNESS) == len(BEARINGS)
    assert len(set(map(abs, SPEEDS.values()))) == len(SPEEDS)
    assert len({gear.teeth for gear in GEARS.values()}) == len(GEARS)
    assert len(set(TORQUES.values())) == len(TORQUES)
    assert START < 0.0
