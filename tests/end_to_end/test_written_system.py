"""What `system` writes of a machine with nothing alike, each number held against the physics that it claims to show."""

import json
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
    UNBALANCES,
    bearing_share,
    force,
    imbalance,
    lopsided,
    polar_inertia,
)

from gearwhine.cli import run_command

pytestmark = pytest.mark.slow

SWEPT = (2000.0, 3000.0, 4000.0)
CONTACTS = [" -> ".join(pair) for pair in PAIRS]
SHAPES = {
    "response_frequency": (("response_frequency",), "Hz"),
    "unbalance_speed": (("unbalance_speed",), "rpm"),
    "system_frequency": (("system_mode",), "Hz"),
    "system_damping_ratio": (("system_mode",), "1"),
    "system_kinetic_share": (("system_mode", "machine_component"), "1"),
    "system_strain_share": (("system_mode", "machine_part"), "1"),
    "system_damping_share": (("system_mode", "machine_part"), "1"),
    "system_whirl": (("system_mode", "machine_component"), "1"),
    "system_campbell_speed": (("system_speed",), "rpm"),
    "system_campbell_frequency": (("system_speed", "system_branch"), "Hz"),
    "system_campbell_damping_ratio": (("system_speed", "system_branch"), "1"),
    "system_crossing_speed": (("system_crossing",), "rpm"),
    "system_crossing_frequency": (("system_crossing",), "Hz"),
    "system_crossing_order": (("system_crossing",), "1"),
    "system_crossing_damping_ratio": (("system_crossing",), "1"),
}
KINDS = {
    "sensor_acceleration": ((), "m s-2"),
    "bearing_force": (("plane",), "N"),
    "bearing_axial_force": ((), "N"),
    "bearing_moment": (("plane",), "N m"),
    "mesh_force": ((), "N"),
}


class Written(NamedTuple):
    """A results file, its summary, and the housing's modes."""

    data: xr.Dataset
    summary: dict[str, Any]
    modes: xr.Dataset

    def response(self, name: str) -> xr.DataArray:
        """A complex response from its amplitude and its phase."""
        amplitude, phase = self.data[name], self.data[f"{name}_phase"]
        return amplitude * np.exp(1j * phase)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    folder = tmp_path_factory.mktemp("lopsided")
    case = folder / "lopsided.toml"
    speeds = ", ".join(f'"{speed} rpm"' for speed in SWEPT)
    text = lopsided(spatial=True, limit=5000.0, more=f"[sweep]\nspeed = [{speeds}]\n")
    case.write_text(text, encoding="utf-8")
    assert run_command(["system", str(case), "-q", "-o", str(folder / "out")]) == 0
    summary = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))
    # As a whole: each quantity that is looked at would be sought in the file anew.
    data, modes = (xr.load_dataset(folder / "out" / name) for name in ("results.nc", "modes.nc"))
    return Written(data, summary, modes)


def test_every_quantity_has_its_dimensions_and_unit(written: Written) -> None:
    expected = dict(SHAPES)
    for name, excitation, abscissa, per in (
        ("transmissibility", "mesh_error", "response_frequency", " m-1"),
        ("unbalance_response", "unbalance_of", "unbalance_speed", ""),
    ):
        for kind, (dimensions, unit) in KINDS.items():
            along = (excitation, f"{name}_{kind.split('_')[0]}", abscissa, *dimensions)
            expected[f"{name}_{kind}"] = (along, unit + per)
            expected[f"{name}_{kind}_phase"] = (along, "rad")
    found = {name: (written.data[name].dims, written.data[name].attrs["units"]) for name in expected}
    assert found == expected
    assert written.data.mesh_error.values.tolist() == [f"transmission error of {name}" for name in CONTACTS]
    assert written.data.unbalance_of.values.tolist() == [f"unbalance of {rotor}" for rotor in UNBALANCES]
    assert written.data.plane.values.tolist() == ["x", "y"]
    assert written.summary["trusted_below_hz"] == pytest.approx(5000.0)


def test_a_slow_error_turns_the_shafts_as_rigid_bodies(written: Written) -> None:
    """Shafts of inertias J, teeth that hold: A F = -w² e, A by free bodies along the lines of action.

    δ = s (r θ + r' θ') of either pair, s the driver's sense; F turns the driver back by s r F and the other likewise.
    """
    rows = np.zeros((2, 3))
    for row, pair in zip(rows, PAIRS, strict=True):
        for name in pair:
            gear = GEARS[name]
            row[list(AXES).index(gear.rotor)] = np.sign(SPEEDS[GEARS[pair[0]].rotor]) * gear.base_radius
    mobility = rows / [polar_inertia(rotor) for rotor in AXES] @ rows.T
    w = 2.0 * np.pi * float(written.data.response_frequency[0])
    expected = w**2 * np.linalg.inv(mobility)
    found = written.response("transmissibility_mesh_force").isel(response_frequency=0)
    assert w < 2.0 * np.pi * 30.0
    assert found.transmissibility_mesh.values.tolist() == CONTACTS
    assert np.abs(found.values - expected).max() < 5e-3 * np.abs(expected).max()


def test_bearings_balance_the_meshes_at_low_frequency(written: Written) -> None:
    """The forces on a shaft, and their moments about its left end, each with its phase."""
    forces = written.response("transmissibility_bearing_force").isel(response_frequency=0)
    moments = written.response("transmissibility_bearing_moment").isel(response_frequency=0)
    meshes = written.response("transmissibility_mesh_force").isel(response_frequency=0)
    for number in range(2):
        of_meshes = dict(zip(PAIRS, meshes.values[number], strict=True))
        of_bearings, about = (
            {
                str(name): row
                for name, row in zip(table.transmissibility_bearing.values, table.values[number], strict=True)
            }
            for table in (forces, moments)
        )
        given = np.abs(meshes.values[number]).max()
        couples = []
        for rotor in AXES:
            left = np.array(imbalance(rotor, of_meshes, of_bearings, about))
            assert np.abs(left[:2]).max() < 5e-3 * given, rotor
            # Shafts that bend carry the force of a mesh off the middle of its face, both of them alike.
            assert np.abs(left[2:]).max() < HALF_FACE * given, rotor
            couples.append(left[2:])
        assert np.abs(sum(couples)).max() < 5e-3 * 0.1 * given
    largest = np.abs(moments.sel(transmissibility_bearing="output-back").values).max()
    assert largest > 1e-4 * np.abs(forces.values).max()


def test_sensors_answer_the_bearings_by_the_housing_s_modes(written: Written) -> None:
    """At the highest peak of a sensor the modes carry most of what the bearings' forces make it do, in its phase."""
    forces = written.response("transmissibility_bearing_force")
    axial = written.response("transmissibility_bearing_axial_force")
    moments = written.response("transmissibility_bearing_moment")
    frequency = 2.0 * np.pi * written.modes.frequency.values
    for number in range(2):
        for sensor in ("cover", "wall"):
            found = written.response("transmissibility_sensor_acceleration").sel(transmissibility_sensor=sensor)
            # Far below the limit, where what lies above it adds little.
            band = np.flatnonzero(
                (found.response_frequency.values > 800.0) & (found.response_frequency.values < 2200.0)
            )
            at = int(band[np.abs(found.values[number, band]).argmax()])
            w = 2.0 * np.pi * float(found.response_frequency[at])
            driven = np.zeros(len(frequency), dtype=complex)
            for bearing in forces.transmissibility_bearing.values:
                motion = written.modes.seat_motion.sel(seat=bearing).values
                driven += motion[:, :2] @ forces.sel(transmissibility_bearing=bearing).values[number, at]
                driven += motion[:, 2] * axial.sel(transmissibility_bearing=bearing).values[number, at]
                driven += motion[:, 3:5] @ moments.sel(transmissibility_bearing=bearing).values[number, at]
            modal = -(w**2) * driven / (frequency**2 - w**2 + 2j * 0.02 * frequency * w)
            expected = modal @ written.modes.sensor_motion.sel(sensor=sensor).values
            assert found.values[number, at] == pytest.approx(expected, rel=0.2), (number, sensor)


def test_slow_unbalance_is_carried_by_the_levers(written: Written) -> None:
    """U w² with the phase of the mark in x, a quarter turn later in y, in the sense of rotation."""
    found = written.response("unbalance_response_bearing_force").isel(unbalance_speed=0)
    speed = float(written.data.unbalance_speed[0]) * np.pi / 30.0
    for number, (rotor, (at, moment, phase)) in enumerate(UNBALANCES.items()):
        own = speed * SPEEDS[rotor] / SPEEDS["input"]
        if rotor == "output":
            continue  # held by moments too
        for end in HELD_AT:
            x, y = found.sel(unbalance_response_bearing=f"{rotor}-{end}").values[number]
            expected = moment * own**2 * bearing_share(end, at) * np.exp(1j * np.radians(phase))
            assert x == pytest.approx(expected, rel=0.08)
            assert y == pytest.approx(-1j * expected, rel=0.08)


def test_modes_in_the_summary_are_those_of_the_file(written: Written) -> None:
    data = written.data
    parts = data.machine_part.values.tolist()
    kinds = {"components": "component", "bearings": "connector", "gear_meshes": "contact"}
    for number, mode in enumerate(written.summary["modes"]):
        row = data.isel(system_mode=number)
        assert mode["frequency_hz"] == pytest.approx(float(row.system_frequency))
        assert mode["damping_ratio"] == pytest.approx(float(row.system_damping_ratio))
        if abs(mode["damping_ratio"]) < 0.99 and mode["kind"] != "rigid":
            damped = mode["frequency_hz"] * np.sqrt(1.0 - mode["damping_ratio"] ** 2)
            assert mode["damped_frequency_hz"] == pytest.approx(damped, rel=1e-9)
        if (most := mode["strained_most"]) is not None:
            place = int(np.argmax(row.system_strain_share.values))
            assert parts[place] == f"{kinds[most['kind']]}: {most['name']}"
            assert most["share"] == pytest.approx(float(row.system_strain_share[place]))
        assert float(row.system_kinetic_share.sum()) == pytest.approx(1.0)
        if mode["kind"] == "housing":
            most_moved = int(np.argmax(row.system_kinetic_share.values))
            assert mode["where"] == "housing" == data.machine_component.values[most_moved]
        assert ("whirl" in mode) <= (mode["kind"] == "rotor")
        if "whirl" in mode:
            assert mode["whirl"] == pytest.approx(float(row.system_whirl.sel(machine_component=mode["where"])))
        if mode["kind"] != "rigid":
            assert sum(row.system_strain_share.values) == pytest.approx(1.0)
            assert sum(row.system_damping_share.values) == pytest.approx(mode["damping_ratio"])


def test_peaks_in_the_summary_are_those_of_the_curves(written: Written) -> None:
    for name, key, abscissa in (
        ("transmissibility", "frequency_hz", written.data.response_frequency),
        ("unbalance_response", "speed_rpm", written.data.unbalance_speed),
    ):
        for number, told in enumerate(written.summary[name]):
            tables = {
                **{("mesh_force", mesh, ""): peaks for mesh, peaks in told["mesh_force_n"].items()},
                **{
                    ("sensor_acceleration", sensor, ""): peaks
                    for sensor, peaks in told["sensor_acceleration_m_per_s2"].items()
                },
                **{
                    (kind, bearing, axis): peaks
                    for kind, group in (("bearing_force", "bearing_force_n"), ("bearing_moment", "bearing_moment_n_m"))
                    for bearing, axes in told[group].items()
                    for axis, peaks in axes.items()
                },
            }
            for (kind, label, axis), peaks in tables.items():
                variable = f"{name}_{kind}"
                chosen = written.data[variable][number].sel({f"{name}_{kind.split('_')[0]}": label})
                if axis == "z":
                    chosen = written.data[f"{name}_bearing_axial_force"][number].sel({f"{name}_bearing": label})
                elif axis:
                    chosen = chosen.sel(plane=axis)
                for peak in peaks:
                    at = int(np.abs(abscissa.values - peak[key]).argmin())
                    assert peak["amplitude"] == pytest.approx(float(chosen[at]), rel=1e-9), (kind, label, axis)


def test_courses_over_speed(written: Written) -> None:
    data, diagram = written.data, written.summary["campbell"]
    assert data.system_campbell_speed.values == pytest.approx(SWEPT)
    assert diagram["speeds_rpm"] == pytest.approx(SWEPT)
    own = np.array([mode["damped_frequency_hz"] for mode in written.summary["modes"]])
    ratios = np.array([mode["damping_ratio"] for mode in written.summary["modes"]])
    found = 0
    for number, branch in enumerate(diagram["branches"]):
        column = data.isel(system_branch=number)
        assert branch["frequency_hz"] == pytest.approx(column.system_campbell_frequency.values.tolist(), nan_ok=True)
        hertz, ratio = (float(column[f"system_campbell_{name}"][1]) for name in ("frequency", "damping_ratio"))
        if np.isfinite(hertz) and 100.0 < hertz < 2000.0:
            near = int(np.abs(own - hertz).argmin())
            assert hertz == pytest.approx(own[near], rel=1e-6)
            assert ratio == pytest.approx(ratios[near], rel=1e-4)
            found += 1
    assert found > 5
    assert len(diagram["crossings"]) == data.sizes["system_crossing"] > 0
    for number, crossing in enumerate(diagram["crossings"]):
        row = data.isel(system_crossing=number)
        assert float(row.system_crossing_speed) == pytest.approx(crossing["speed_rpm"])
        assert float(row.system_crossing_frequency) == pytest.approx(crossing["frequency_hz"])
        assert crossing["frequency_hz"] == pytest.approx(crossing["order"] * crossing["speed_rpm"] / 60.0, rel=1e-6)
        assert crossing["margin"] == pytest.approx(crossing["speed_rpm"] / 3000.0 - 1.0)
        assert float(row.system_crossing_order) == pytest.approx(crossing["order"])


def test_mesh_stiffness_with_and_without_load(written: Written) -> None:
    for pair, told in zip(PAIRS, written.summary["mesh_stiffness"], strict=True):
        assert told["name"] == " -> ".join(pair)
        assert told["force_n"] == pytest.approx(force(pair), rel=1e-6)
        assert told["taken"] == "mean under load"
        # Teeth of steel, 18 mm wide, and their bodies: some 14 to 17 N/(µm mm); under load a little more of the path
        # touches. What is told lies between the rims, in series with the bodies behind them.
        unloaded, loaded = (
            1.0 / (1.0 / told[key] + 1.0 / told["bodies_n_per_m"])
            for key in ("unloaded_mean_n_per_m", "stiffness_n_per_m")
        )
        assert 0.018 * 13e9 < unloaded < loaded < 0.018 * 17e9
