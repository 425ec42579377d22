"""From the keys of a case to the machine: each number arrives where it belongs, in its sense and its unit."""

import tomllib
from collections.abc import Callable
from math import pi, radians
from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled
from lopsided_case import AXES, GEARS, MODULE, PAIRS, SPEEDS, START, STIFFNESS, UNBALANCES, lopsided

from gearwhine.case import Case, parse_case
from gearwhine.coupling import CoupledMachine, GapLaw, Torque
from gearwhine.coupling.machine.base_motion import BaseHarmonic
from gearwhine.coupling.machine.loads import TorqueRipple
from gearwhine.solve.housing_modes import solve_housing

Change = Callable[[dict[str, Any]], None]


def case_with(change: Change = lambda document: None, **keys: Any) -> Case:
    """The lopsided gearbox on the ground, changed."""
    document = tomllib.loads(lopsided(housing=False, **keys))
    change(document)
    return parse_case(document)


def machine_of(change: Change = lambda document: None) -> CoupledMachine:
    case = case_with(change)
    return coupled(case)


def entry(document: dict[str, Any], table: str, name: str) -> dict[str, Any]:
    (found,) = (one for one in document[table] if one["name"] == name)
    return found


def test_shafts_stand_and_turn_as_the_case_says() -> None:
    machine = machine_of()
    assert machine.speeds == pytest.approx(SPEEDS)
    for rotor in machine.rotors:
        assert rotor.axis == pytest.approx(AXES[rotor.name])
        assert rotor.start == START
        # One part in a hundred of critical damping on every mode of the free shaft.
        omega = np.sqrt(np.diag(rotor.stiffness))
        assert np.diag(rotor.damping) == pytest.approx(0.02 * omega)
        assert omega.max() > 0.0
    for bearing in machine.bearings:
        rotor_name, end = bearing.bearing.name.split("-")
        xx, yy, xy, yx = STIFFNESS[rotor_name, end]
        assert bearing.rotor == rotor_name
        assert bearing.bearing.stiffness.tolist() == [[xx, xy], [yx, yy]]
        assert bearing.bearing.damping.tolist() == [[900.0, 0.0], [0.0, 600.0]]


def test_unbalances_turn_with_their_shaft_from_their_phase() -> None:
    """x + iy of the force is U Ω² e^{i(Ωt + φ)}."""
    machine = machine_of()
    cuts = np.cumsum([0, *(part.size for part in machine.system.components)])
    for number, rotor in enumerate(machine.rotors):
        if rotor.name not in UNBALANCES:
            continue
        at, moment, phase = UNBALANCES[rotor.name]
        speed = SPEEDS[rotor.name]
        load = sum(
            one.amplitude[cuts[number] : cuts[number + 1]]
            for one in machine.system.harmonic_loads
            if one.frequency == pytest.approx(speed) and np.any(one.amplitude[cuts[number] : cuts[number + 1]])
        )
        turning = moment * speed**2 * np.exp(1j * radians(phase))
        expected = turning * (rotor.direction(at, 0) - 1j * rotor.direction(at, 1))
        np.testing.assert_allclose(load, expected, atol=1e-12 * np.abs(expected).max())


def test_gravity_and_the_base_act_on_the_shafts() -> None:
    base = {
        "point": ["30 mm", "-20 mm", "50 mm"],
        "harmonic": [{"frequency": "40 Hz", "x": "2 m/s^2", "rz": "5 rad/s^2", "phase": "35 deg"}],
    }
    gravity = ["1 m/s^2", "-9 m/s^2", "0 m/s^2"]
    machine = machine_of(lambda document: document["operation"].update(base=base, gravity=gravity))
    assert machine.loads.gravity == (1.0, -9.0, 0.0)
    assert machine.loads.base is not None
    assert machine.loads.base.point == pytest.approx((0.03, -0.02, 0.05))
    (harmonic,) = machine.loads.base.parts
    assert isinstance(harmonic, BaseHarmonic)
    assert harmonic.frequency == pytest.approx(80.0 * pi)
    turned = np.exp(1j * radians(35.0))
    np.testing.assert_allclose(harmonic.amplitude, np.array([2.0, 0, 0, 0, 0, 5.0]) * turned, rtol=1e-12)
    still = machine_of().system.load
    assert np.abs(machine.system.load - still).max() > 1.0


def test_torques_swing_where_and_when_the_case_says() -> None:
    def change(document: dict[str, Any]) -> None:
        document["operation"] |= {
            "ripple": [{"amplitude": "3 N*m", "phase": "25 deg", "frequency": "60 Hz"}],
            "output": [
                {
                    "rotor": "output",
                    "torque": "209 N*m",
                    "ripple": [{"amplitude": "7 N*m", "phase": "-15 deg", "order": 2}],
                }
            ],
        }
        # In the ratio of the teeth.
        ratio = 47 / 23 * 50 / 21
        document["operation"]["torque"] = f"{209 / ratio} N*m"

    ripples = [torque for torque in machine_of(change).loads.torques if isinstance(torque, TorqueRipple)]
    (entering,) = (one for one in ripples if one.rotor == "input")
    (leaving,) = (one for one in ripples if one.rotor == "output")
    assert (entering.amplitude, entering.phase, entering.order) == (3.0, pytest.approx(radians(25.0)), None)
    assert entering.frequency == pytest.approx(120.0 * pi)
    # In the sense of its torque, which holds the output back.
    assert (leaving.amplitude, leaving.phase, leaving.order) == (-7.0, pytest.approx(radians(-15.0)), 2.0)
    constant = {torque.rotor: torque.value for torque in machine_of(change).loads.torques if isinstance(torque, Torque)}
    assert constant["input"] > 0.0 > constant["output"]


def test_a_coupling_s_dashpots_stand_at_its_hubs() -> None:
    coupling = {
        "lateral_stiffness": "5e6 N/m",
        "axial_stiffness": "5e6 N/m",
        "tilt_stiffness": "5e4 N*m/rad",
        "torsional_stiffness": "2e4 N*m/rad",
        "lateral_damping": "60 N*s/m",
        "torsional_damping": "4 N*m*s/rad",
        "tilt_damping": "2 N*m*s/rad",
        "axial_damping": "70 N*s/m",
    }

    def change(document: dict[str, Any]) -> None:
        document["rotor"][0]["segments"].insert(2, {"length": "20 mm", "coupling": coupling})
        document["rotor"][0]["segments"].append({"length": "40 mm", "diameter": "20 mm"})
        for end in ("left", "right"):
            document["bearing"].append(
                {
                    "name": f"motor-{end}",
                    "rotor": "input",
                    "at": "230 mm" if end == "left" else "255 mm",
                    "stiffness": {"xx": "1e8 N/m", "yy": "1e8 N/m"},
                }
            )

    (dashpots,) = machine_of(change).dashpots
    assert dashpots.rotor == "input"
    values = [value for value in vars(dashpots).values() if isinstance(value, float)]
    assert values == pytest.approx([0.2, 0.22, 60.0, 2.0, 4.0, 70.0])


def test_a_bearing_s_table_is_read_at_its_own_shaft_s_speed() -> None:
    """The middle shaft turns at half the input's speed, beyond which its table knows nothing."""

    def change(document: dict[str, Any]) -> None:
        bearing = entry(document, "bearing", "middle-back")
        bearing["speeds"] = ["1200 rpm", "1600 rpm"]
        bearing["stiffness"] = {"xx": ["1e8 N/m", "2e8 N/m"], "yy": "1e8 N/m"}

    (tabled,) = (one for one in machine_of(change).system.linear if one.name == "middle-back")
    speed = abs(SPEEDS["middle"]) * 30.0 / pi
    assert tabled.stiffness[0, 0] == pytest.approx(1e8 * (1.0 + (speed - 1200.0) / 400.0), rel=1e-9)
    assert tabled.stiffness[1, 1] == pytest.approx(1e8)


def test_pedestals_have_their_own_matrices() -> None:
    pedestal = {
        "stiffness": {"xx": "3e7 N/m", "xy": "2e6 N/m", "yx": "-1e6 N/m", "yy": "4e7 N/m"},
        "damping": {"xx": "300 N*s/m", "yy": "500 N*s/m"},
        "mass": "4 kg",
    }
    case = case_with(lambda document: entry(document, "bearing", "middle-front").update(pedestal=pedestal))
    built = {bearing.name: bearing for bearing in case.parts.bearings_on("middle")}["middle-front"].pedestal
    assert built is not None
    assert built.stiffness.tolist() == [[3e7, 2e6], [-1e6, 4e7]]
    assert built.damping.tolist() == [[300.0, 0.0], [0.0, 500.0]]
    assert built.mass == 4.0


def test_stops_and_rolling_bearings_have_the_laws_that_are_given() -> None:
    stop = {"force": "900 N", "depth": "30 um", "exponent": 2.0, "gap": "15 um"}
    rolling = {
        "catalogue": {"type": "angular-contact", "bore": "25 mm", "outer_diameter": "52 mm", "width": "15 mm"},
        "preload": "500 N",
    }

    def change(document: dict[str, Any]) -> None:
        entry(document, "bearing", "input-front").update(stiffness={"stop": stop}, load={"x": "300 N", "y": "-200 N"})
        for end, carries in (("back", "+z"), ("front", "-z")):
            held = entry(document, "bearing", f"output-{end}")
            held.update(stiffness={"rolling": {**rolling, "carries": carries}}, load={"x": "60 N", "y": "-20 N"})

    case = case_with(change)
    (law,) = (mounted.law for mounted in case.parts.bearings if mounted.bearing.name == "input-front")
    assert isinstance(law, GapLaw)
    assert (law.force, law.depth, law.exponent, law.gap) == pytest.approx((900.0, 30e-6, 2.0, 15e-6))
    back, front = (bearing.stiffness for bearing in case.parts.bearings_on("output"))
    # Mirrored at the x-y plane: what ties z or tilts to x and y changes its sign, all else stays.
    mirror = np.diag([1.0, 1.0, -1.0, -1.0, -1.0])
    np.testing.assert_allclose(front, mirror @ back @ mirror, rtol=1e-6, atol=1e-6 * back.max())
    assert abs(back[0, 2]) > 1e-3 * back[2, 2]


def test_gears_are_built_of_their_own_numbers() -> None:
    def change(document: dict[str, Any]) -> None:
        document["material"]["bronze"] = {"youngs_modulus": "110 GPa", "poisson_ratio": 0.35, "density": "8800 kg/m^3"}
        entry(document, "gear", "d").update(material="bronze", bore="40 mm")
        entry(document, "gear", "a")["errors"] = {"eccentricity": "9 um", "phase": "70 deg"}
        entry(document, "gear", "b")["errors"] = {"runout": "8 um"}

    case = case_with(change)
    a, b, _, d = (case.parts.gears[gear.name] for gear in case.gear)
    assert (d.youngs_modulus, d.poisson_ratio, d.density, d.bore) == (110e9, 0.35, 8800.0, 0.04)
    assert (a.eccentricity, a.eccentricity_phase) == pytest.approx((9e-6, radians(70.0)))
    assert (b.eccentricity, b.bore) == pytest.approx((4e-6, 0.024))
    assert [gear.teeth for gear in (a, b, d)] == [GEARS[name].teeth for name in "abd"]
    assert a.module == MODULE


def test_friction_is_the_pair_s_own() -> None:
    machine = machine_of(lambda document: document["gear_pair"][1].update(friction=0.07))
    assert [mesh.friction for mesh in machine.meshes] == [0.0, 0.07]
    assert [(mesh.driver.name, mesh.driven.name) for mesh in machine.meshes] == list(PAIRS)
    assert [contact.sliding is None for contact in machine.system.contacts] == [True, False]


def test_helical_gears_push_a_shaft_by_its_exact_axial_compliance() -> None:
    """Thrust goes from the gear through the shaft to the bearing that holds it: 1/k_z + L / EA."""
    stiff = [[1e8 if i == j < 3 else 0.0 for j in range(5)] for i in range(5)]
    free = [[1e8 if i == j < 2 else 0.0 for j in range(5)] for i in range(5)]

    def change(document: dict[str, Any]) -> None:
        for name, angle in zip("abcd", ("12 deg", "-12 deg", "12 deg", "-12 deg"), strict=True):
            gear = entry(document, "gear", name)
            # The same transverse teeth, so that the centre distances stay.
            gear["module"] = f"{MODULE * np.cos(radians(12.0))} m"
            gear["helix_angle"] = angle
            gear["stiffens_shaft"] = False
        for bearing in document["bearing"]:
            bearing["stiffness"] = {"matrix": stiff if bearing["name"].endswith("front") else free}

    machine = machine_of(change)
    for rotor in machine.rotors:
        held = rotor.motions(0.18)[2]
        for gear in (one for one in GEARS.values() if one.rotor == rotor.name):
            pushed = rotor.motions(gear.at)[2]
            moved = np.linalg.solve(
                np.diag(np.where(held != 0.0, np.diag(rotor.stiffness), 1.0)) + 1e8 * np.outer(held, held), pushed
            )
            area = [pi / 4.0 * diameter**2 for diameter in (0.032, 0.026)]
            lengths = max(0.09 - gear.at, 0.0), 0.18 - max(gear.at, 0.09)
            expected = 1e-8 + sum(length / (206e9 * a) for length, a in zip(lengths, area, strict=True))
            assert pushed @ moved == pytest.approx(expected, rel=1e-6)


def test_a_housing_has_its_damping_sensors_and_masses() -> None:
    document = tomllib.loads(lopsided())
    document["housing"] |= {
        "damping_ratio": {"500 Hz": 0.01, "2500 Hz": 0.05},
        "mass": [{"name": "pump", "position": ["0 mm", "150 mm", "0 mm"], "mass": "3 kg"}],
    }
    document["housing"]["sensor"][0]["direction"] = [0, -1, 0]
    case = parse_case(document)
    solved = solve_housing(case)
    hertz = solved.modes.frequencies_hz
    assert solved.damping_ratios == pytest.approx(np.interp(hertz, [500.0, 2500.0], [0.01, 0.05]))
    assert solved.housing.attached_mass == pytest.approx(3.0)
    assert solved.sensors["cover"].direction.tolist() == [0.0, -1.0, 0.0]
    assert solved.sensors["wall"].direction.tolist() == [1.0, 0.0, 0.0]
    # Three orders of response attached to thirty motions, less what depends on others.
    assert solved.modes.residual_modes is not None
    assert len(solved.modes.residual_modes.frequencies) > 60
