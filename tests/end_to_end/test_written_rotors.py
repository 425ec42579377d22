"""What `rotors` writes of shafts with nothing alike, each number held against the physics that it claims to show."""

import json
import tomllib
from math import pi, remainder
from typing import Any, NamedTuple

import numpy as np
import pytest
import xarray as xr
from lopsided_case import AXES, DENSITY, GEARS, HELD_AT, SPEEDS, UNBALANCES, bearing_share, lopsided

from gearwhine.case import parse_case
from gearwhine.cli import run_command
from gearwhine.rotors.analyses.solved_rotor import _largest_over_cycle
from gearwhine.solve.rotors import solve_rotors

pytestmark = pytest.mark.slow

ANALYSIS = """
[rotor_analysis]
modes = 6
speed = { from = "300 rpm", to = "60000 rpm", step = "3000 rpm" }
orders = [2]
stiffness_map = { from = "2e7 N/m", to = "5e8 N/m", points = 3, modes = 3, whirl = "backward" }
gravity = ["3 m/s^2", "-9 m/s^2", "0 m/s^2"]

[rotor_analysis.unbalance_response]
speed = ["600 rpm", "3000 rpm", "45000 rpm"]
probes = [
    { name = "one", rotor = "input", at = "50 mm", angle = "25 deg" },
    { name = "two", rotor = "output", at = "150 mm", angle = "-40 deg" },
]

[rotor_analysis.torsional_response]
torques = [
    { rotor = "input", at = "60 mm", amplitude = "2 N*m", phase = "20 deg" },
    { rotor = "output", at = "130 mm", amplitude = "5 N*m", phase = "-50 deg" },
]
frequency = { from = "5 Hz", to = "9005 Hz", points = 10 }
damping_ratio = 0.02
"""
SHAPES = {
    "rotor_rest_frequency": (("rotor", "rest_mode"), "Hz"),
    "rotor_torsional_frequency": (("rotor", "torsional_mode"), "Hz"),
    "rotor_place": (("rotor", "place"), "m"),
    "rotor_lateral_shape": (("rotor", "lateral_mode", "place"), "kg-0.5"),
    "rotor_torsional_shape": (("rotor", "torsional_mode", "place"), "kg-0.5 m-1"),
    "campbell_speed": (("rotor", "campbell_step"), "rpm"),
    "campbell_frequency": (("rotor", "campbell_step", "whirl_branch"), "Hz"),
    "campbell_log_decrement": (("rotor", "campbell_step", "whirl_branch"), "1"),
    "campbell_direction": (("rotor", "campbell_step", "whirl_branch"), "1"),
    "campbell_axial_share": (("rotor", "campbell_step", "whirl_branch"), "1"),
    "static_place": (("rotor", "static_step"), "m"),
    "static_deflection": (("rotor", "plane", "static_step"), "m"),
    "rotor_segment_strain_share": (("rotor", "lateral_mode", "strained_segment"), "1"),
    "rotor_bearing_strain_share": (("rotor", "lateral_mode", "strained_bearing"), "1"),
    "whirl_speed": (("whirl_state",), "rpm"),
    "whirl_frequency": (("whirl_state", "whirl_number"), "Hz"),
    "whirl_segment_strain_share": (("whirl_state", "whirl_number", "strained_segment"), "1"),
    "whirl_bearing_strain_share": (("whirl_state", "whirl_number", "strained_bearing"), "1"),
    "unbalance_bearing_speed": (("unbalance_bearing", "response_step"), "rpm"),
    "unbalance_bearing_force": (("unbalance_bearing", "plane", "response_step"), "N"),
    "map_stiffness": (("map_step",), "N/m"),
    "map_critical_speed": (("rotor", "map_step", "map_curve"), "rpm"),
    "response_speed": (("probe", "response_step"), "rpm"),
    "probe_amplitude": (("probe", "response_step"), "m"),
    "probe_phase_lag": (("probe", "response_step"), "rad"),
    "orbit_major_axis": (("probe", "response_step"), "m"),
    "torsion_frequency": (("torsion_probe", "torsion_step"), "Hz"),
    "torsion_angle": (("torsion_probe", "torsion_step"), "rad"),
    "torsion_angle_phase": (("torsion_probe", "torsion_step"), "rad"),
    "torsion_torque": (("torsion_probe", "torsion_step"), "N m"),
    "torsion_torque_phase": (("torsion_probe", "torsion_step"), "rad"),
    "rotor_whirl_deflection": (("rotor", "whirl_mode", "place"), "kg-0.5"),
    "rotor_whirl_moment": (("rotor", "whirl_mode", "place"), "N kg-0.5"),
}


class Written(NamedTuple):
    """A results file, and each rotor's part of the summary by its name."""

    data: xr.Dataset
    rotors: dict[str, Any]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    folder = tmp_path_factory.mktemp("lopsided")
    case = folder / "lopsided.toml"
    case.write_text(lopsided(housing=False, more=ANALYSIS), encoding="utf-8")
    assert run_command(["rotors", str(case), "-q", "-o", str(folder / "out")]) == 0
    summary = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))
    # As a whole: each quantity that is looked at would be sought in the file anew.
    return Written(
        xr.load_dataset(folder / "out" / "results.nc"), {rotor["name"]: rotor for rotor in summary["rotors"]}
    )


def test_every_quantity_has_its_dimensions_and_unit(written: Written) -> None:
    found = {name: (written.data[name].dims, written.data[name].attrs["units"]) for name in SHAPES}
    assert found == SHAPES
    assert written.data.rotor.values.tolist() == list(written.rotors) == list(AXES)
    assert written.data.probe.values.tolist() == ["input: one", "output: two"]
    assert "backward" in written.data.map_critical_speed.attrs["long_name"]


def weight(rotor: str, bearing: str) -> float:
    """Mass [kg] that a bearing carries of the shaft and its gears, by the lever."""
    pieces = [(0.045, 0.09 * 0.032**2), (0.145, 0.11 * 0.026**2)]
    pieces += [
        (gear.at, 0.018 * ((2e-3 * gear.teeth) ** 2 - 0.024**2)) for gear in GEARS.values() if gear.rotor == rotor
    ]
    return sum(DENSITY * pi / 4.0 * volume * bearing_share(bearing, at) for at, volume in pieces)


def test_bearings_carry_the_weight(written: Written) -> None:
    for name, rotor in written.rotors.items():
        static = rotor["static"]
        assert rotor["mass_kg"] == pytest.approx(sum(weight(name, end) for end in HELD_AT), rel=1e-6)
        loads = {bearing["name"]: bearing for bearing in static["bearings"]}
        for end in HELD_AT:
            expected = weight(name, end) * np.array([3.0, -9.0, 0.0])
            assert loads[f"{name}-{end}"]["load_n"] == pytest.approx(expected.tolist(), rel=1e-6, abs=1e-9)
            assert loads[f"{name}-{end}"]["moment_n_m"] == pytest.approx([0.0, 0.0], abs=1e-9)
        row = written.data.sel(rotor=name)
        across, up = (row.static_deflection.sel(plane=plane).values for plane in "xy")
        sag = np.hypot(across, up)
        assert static["largest_deflection_m"] == pytest.approx(np.nanmax(sag))
        assert static["largest_deflection_at_m"] == float(row.static_place[int(np.nanargmax(sag))])
        # It sags along the weight.
        assert np.nanmean(across) > 0.0 > np.nanmean(up)


def campbell_at(row: xr.Dataset, speed: float) -> dict[str, np.ndarray]:
    """Quantities of each branch of a rotor's diagram at a speed [rpm] without its sense, between two of the diagram."""
    rising = np.argsort(np.abs(row.campbell_speed.values))
    speeds = np.abs(row.campbell_speed.values[rising])
    return {
        name: np.array([np.interp(speed, speeds, branch) for branch in row[name].values[rising].T])
        for name in ("campbell_frequency", "campbell_log_decrement", "campbell_direction", "campbell_axial_share")
    }


def test_whirl_over_speed(written: Written) -> None:
    for name, rotor in written.rotors.items():
        row, told = written.data.sel(rotor=name), rotor["campbell"]
        ratio = SPEEDS[name] / SPEEDS["input"]
        assert row.campbell_speed.values[np.abs(row.campbell_speed.values).argmin()] == pytest.approx(300.0 * ratio)
        assert row.campbell_speed.values == pytest.approx(told["speed_rpm"])
        # At operation, between two speeds of the diagram, the whirl modes lie on its branches.
        (now,) = (one for one in rotor["whirl"] if one["speed_rpm"] == pytest.approx(SPEEDS[name] * 30.0 / pi))
        found = campbell_at(row, abs(SPEEDS[name]) * 30.0 / pi)
        branches = np.argsort(found["campbell_frequency"])[: len(now["frequency_hz"])]
        for key, variable, near in (
            ("frequency_hz", "campbell_frequency", 5e-3),
            ("log_decrement", "campbell_log_decrement", 0.05),
            ("direction", "campbell_direction", 0.05),
            ("axial_share", "campbell_axial_share", 0.05),
        ):
            assert found[variable][branches] == pytest.approx(now[key], rel=near, abs=near), variable
        # Gyroscopic moments stiffen what whirls with the rotation and soften what whirls against it.
        order = np.argsort(np.abs(row.campbell_speed.values))
        hertz = row.campbell_frequency.values[order]
        along = row.campbell_direction.values[order] * np.sign(ratio)
        rises = {}
        for branch in range(hertz.shape[1]):
            half = slice(hertz.shape[0] // 2, None)
            if np.isfinite(hertz[half, branch]).all() and (np.abs(along[half, branch]) > 0.5).all():
                rises[branch] = (hertz[-1, branch] > hertz[half, branch][0]) == (along[-1, branch] > 0.0)
        assert len(rises) >= 2, name
        assert all(rises.values()), (name, rises)


def test_whirl_at_operation(written: Written) -> None:
    for name, rotor in written.rotors.items():
        (whirl,) = (one for one in rotor["whirl"] if one["speed_rpm"] == pytest.approx(SPEEDS[name] * 30.0 / pi))
        ratio = np.array(whirl["damping_ratio"])
        assert whirl["log_decrement"] == pytest.approx((2.0 * pi * ratio / np.sqrt(1.0 - ratio**2)).tolist())
        place, shape = (written.data[key].sel(rotor=name).values for key in ("rotor_place", "rotor_whirl_deflection"))
        moment = written.data.rotor_whirl_moment.sel(rotor=name).values
        state = written.data.sel(whirl_state=f"{name} at {whirl['speed_rpm']:.6g} rpm")
        assert float(state.whirl_speed) == pytest.approx(whirl["speed_rpm"])
        assert state.whirl_frequency.values == pytest.approx(whirl["frequency_hz"])
        shares = state.whirl_bearing_strain_share.values
        whole = shares.sum(axis=1) + np.nansum(state.whirl_segment_strain_share.values, axis=1)
        assert whole == pytest.approx(1.0)
        assert rotor["bearings"] == [f"{name}-{end}" for end in HELD_AT]
        at = [int(np.abs(place - at).argmin()) for at in HELD_AT.values()]
        for mode in range(3):
            # A free end carries no moment.
            assert abs(moment[mode, [0, -1]]).max() < 1e-6 * moment[mode].max()
            # What bends the thinner length is the curvature of what the mode does, EI w''.
            bent = (place > 0.14) & (place < 0.163)
            curve = np.polyfit(place[bent], shape[mode, bent], 4)
            expected = 206e9 * pi / 64.0 * 0.026**4 * np.abs(np.polyval(np.polyder(curve, 2), place[bent]))
            if mode == 0:
                assert moment[mode, bent] == pytest.approx(expected, rel=0.25)
            # The bearing that the shaft moves more in takes more, as their stiffnesses are of one size.
            moved = shape[mode, at] ** 2
            if moved.max() > 4.0 * moved.min():
                assert shares[mode].argmax() == moved.argmax(), (name, mode)
        assert rotor["operation_rpm"] == pytest.approx(SPEEDS[name] * 30.0 / pi)
        margins = [abs(speed / rotor["operation_rpm"]) - 1.0 for speed in rotor["critical_speeds_rpm"]]
        assert rotor["critical_margins"] == pytest.approx(margins)
        orders = rotor["campbell"]["orders"]
        assert [one["order"] for one in orders] == [2.0]
        for crossing in [*rotor["campbell"]["critical_speeds"], *orders[0]["critical_speeds"]]:
            assert crossing["margin"] == pytest.approx(abs(crossing["speed_rpm"] / rotor["operation_rpm"]) - 1.0)


def test_the_largest_deflection_of_an_orbit_is_its_long_half_axis() -> None:
    angles = np.linspace(0.0, 2.0 * pi, 20_001)
    rng = np.random.default_rng(3)
    x, y = (rng.normal(size=8) + 1j * rng.normal(size=8) for _ in range(2))
    orbit = np.hypot(*(np.real(each[:, None] * np.exp(1j * angles)) for each in (x, y)))
    assert _largest_over_cycle(x, y) == pytest.approx(orbit.max(axis=1), rel=1e-6)


def test_modes_have_unit_norm_in_mass(written: Written) -> None:
    """∫ρA(|x|² + |y|²)dz of a mode of all but one plane is nearly 1, and its amplitude the whole of it."""
    for name in AXES:
        place, shape = (written.data[key].sel(rotor=name).values for key in ("rotor_place", "rotor_whirl_deflection"))
        lateral = written.data.rotor_lateral_shape.sel(rotor=name).values
        area = np.where(place < 0.09, 0.032**2, 0.026**2) * pi / 4.0
        gears = [gear for gear in GEARS.values() if gear.rotor == name]
        for rows, least in ((lateral[:1], 0.75), (shape[:2], 0.38)):
            for row in rows:
                norm = float(np.trapezoid(DENSITY * area * row**2, place))
                for gear in gears:
                    ring = DENSITY * pi / 4.0 * 0.018 * ((2e-3 * gear.teeth) ** 2 - 0.024**2)
                    norm += ring * float(np.interp(gear.at, place, row)) ** 2
                # Rotary inertia has the rest; of a circle either plane has a half.
                assert least < norm < 1.01


def test_readings_of_probes(written: Written) -> None:
    """Slowly turned, the shaft follows its unbalance: half the lag of the probe's angle, U w² and the levers."""
    for number, (rotor, (at, moment, phase)) in enumerate(UNBALANCES.items()):
        told, row = written.rotors[rotor]["unbalance_response"], written.data.isel(probe=number)
        (probe,) = told["probes"]
        ratio = SPEEDS[rotor] / SPEEDS["input"]
        speeds, amplitude = row.response_speed.values, row.probe_amplitude.values
        assert speeds == pytest.approx(np.array([600.0, 3000.0, 45000.0]) * ratio)
        assert (told["from_rpm"], told["to_rpm"]) == pytest.approx((speeds[0], speeds[-1]))
        lag = np.degrees(row.probe_phase_lag.values)
        # Half the length of the orbit is no less than what a probe reads of it.
        assert (row.orbit_major_axis.values >= amplitude * (1.0 - 1e-9)).all()
        angle = {"one": 25.0, "two": -40.0}[probe["name"]]
        assert probe["angle_deg"] == pytest.approx(angle)
        # The high spot is at the unbalance, whose angle is counter-clockwise; unlike bearings turn it a little.
        assert remainder(lag[0] - (angle - phase), 360.0) == pytest.approx(0.0, abs=15.0)
        assert amplitude[1] / amplitude[0] == pytest.approx(25.0, rel=0.02)
        assert probe["largest_at_rpm"] == pytest.approx(speeds[int(np.argmax(amplitude))])
        assert probe["operation_amplitude_m"] == pytest.approx(amplitude[1])
        assert probe["operation_phase_lag_deg"] == pytest.approx(lag[1])
        largest = {bearing["name"]: bearing["largest_force_n"] for bearing in told["bearings"]}
        slow = speeds[0] * pi / 30.0
        for end in HELD_AT:
            force = written.data.unbalance_bearing_force.sel(unbalance_bearing=f"{rotor}-{end}")
            expected = moment * slow**2 * bearing_share(end, at)
            assert force.isel(response_step=0).values == pytest.approx(expected, rel=0.01)
            assert force.max("response_step").values == pytest.approx(largest[f"{rotor}-{end}"])


def test_torsion_of_free_shafts(written: Written) -> None:
    """At 5 Hz a free shaft turns as a rigid body, T = -J w² θ; beside the torque it carries what turns beyond it."""
    for rotor, torque, phase in (("input", 2.0, 20.0), ("output", 5.0, -50.0)):
        told = written.rotors[rotor]["torsional_response"]
        own = [row for row, name in enumerate(written.data.torsion_probe.values) if name.startswith(f"{rotor}: ")]
        names = [str(written.data.torsion_probe.values[row]).partition(": ")[2] for row in own]
        assert [probe["name"] for probe in told["probes"]] == names
        inertia = sum(
            DENSITY * length * pi / 32.0 * (outer**4 - inner**4)
            for length, outer, inner in [
                (0.09, 0.032, 0.0),
                (0.11, 0.026, 0.0),
                *[(0.018, 2e-3 * gear.teeth, 0.024) for gear in GEARS.values() if gear.rotor == rotor],
            ]
        )
        for row, probe in zip(own, told["probes"], strict=True):
            of = written.data.isel(torsion_probe=row)
            assert of.torsion_frequency.values[[0, -1]] == pytest.approx([told["from_hz"], told["to_hz"]])
            assert of.torsion_angle.values.max() == pytest.approx(probe["largest_angle_rad"])
            assert of.torsion_torque.values.max() == pytest.approx(probe["largest_torque_n_m"], abs=1e-9)
            assert float(of.torsion_angle[0]) == pytest.approx(torque / (inertia * (10.0 * pi) ** 2), rel=2e-3)
            lag = np.degrees(float(of.torsion_angle_phase[0]))
            assert remainder(lag - phase - 180.0, 360.0) == pytest.approx(0.0, abs=0.1)
        torques = written.data.torsion_torque.values[own]
        assert told["largest_torque_n_m"] >= torques.max() * (1.0 - 1e-9)
        # Nearer to its modes it carries more.
        assert told["largest_torque_at_hz"] in written.data.torsion_frequency.values[own[0], 1:]


def test_critical_speeds_over_stiffness(written: Written) -> None:
    assert written.data.map_stiffness.values == pytest.approx([2e7, 1e8, 5e8], rel=1e-6)
    for name, rotor in written.rotors.items():
        told = np.array(rotor["stiffness_map"]["backward_critical_speeds_rpm"], dtype=float)
        assert written.data.map_critical_speed.sel(rotor=name).values == pytest.approx(told, nan_ok=True)
        # Rigid in soft bearings: some sqrt(2 k / m), and higher in stiffer ones.
        rigid = np.sqrt(2.0 * 2e7 / rotor["mass_kg"]) * 30.0 / pi
        assert told[0, 0] == pytest.approx(rigid, rel=0.3)
        assert (np.diff(told[:, 0]) > 0.0).all()


def test_the_torque_s_phase_is_its_own(written: Written) -> None:
    """As the library's response has it at each probe; somewhere it is far from that of the angle."""
    apart = 0.0
    for one in solve_rotors(parse_case(tomllib.loads(lopsided(housing=False, more=ANALYSIS)))):
        if one.torsion is None:
            continue
        for probe in written.rotors[one.rotor.name]["torsional_response"]["probes"]:
            row = written.data.sel(torsion_probe=f"{one.rotor.name}: {probe['name']}")
            exact = one.torsion.response.torque([probe["at_m"]])[:, 0]
            found = row.torsion_torque.values * np.exp(1j * row.torsion_torque_phase.values)
            np.testing.assert_allclose(found, exact, rtol=1e-6, atol=1e-9 * np.abs(exact).max())
            size = row.torsion_torque.values > 1e-6
            angles = (row.torsion_angle_phase - row.torsion_torque_phase).values[size]
            apart = max(apart, *np.abs(np.sin(angles / 2.0)).tolist(), 0.0)
    assert apart > 0.5
