"""Means over turns of carriers: forces, gaps and bearings do not depend on where the carriers start."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from gearwhine.coupling import Machine
from gearwhine.coupling.gears.contact.face_slices import FaceSlices, face_equilibrium
from gearwhine.coupling.load_analysis.planetary_load import ANGLES, over_carrier_turn
from gearwhine.coupling.machine.coupled_system import times_over_turn
from gearwhine.coupling.machine.loads import ShaftForce
from gearwhine.coupling.statics.mean_mesh import mean_meshes
from gearwhine.coupling.statics.operating_point import BearingLoad
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Rotor, Segment
from tests.coupling.test_displaced_pins import machine as machine_on_rollers
from tests.machines.plane_planetary_set import STEEL, equal_angles, plane_set

ERROR = 40e-6  # m, of the first pin of each set, along the circle


@pytest.mark.parametrize("rates", [(30.0,), (30.0, -142.5), (10.0, 10.0 * 114.0 / 23.0), (7.0, 7.0 * np.pi)])
def test_times_over_turn_average_the_waves_of_all_carriers_away(rates: tuple[float, ...]) -> None:
    """Six waves of each, four of two together; up to the whole turns of speeds without a common one."""
    times = times_over_turn(rates)
    assert times.size < 30
    for waves in itertools.product(range(-6, 7), repeat=len(rates)):
        single = np.count_nonzero(waves) == 1
        if any(waves) and np.abs(waves).sum() <= (6 if single else 4):
            assert abs(np.exp(1j * times * np.dot(waves, rates)).mean()) < 1e-2, waves


def _named(parts: dict[str, Any], letter: str, start: float) -> dict[str, Any]:
    """Return the parts of a set with a letter before their names, along the axis."""

    def name(text: str) -> str:
        return f"{letter} {text}"

    shafts = [
        replace(
            shaft,
            rotor=replace(shaft.rotor, name=name(shaft.name)),
            start=start,
            carrier=None if shaft.carrier is None else name(shaft.carrier),
            pin_error=(0.0, ERROR if shaft.name == "planet 1" else 0.0),
        )
        for shaft in parts["shafts"]
    ]
    return {
        "shafts": [replace(shaft, pin_error=(0.0, 0.0)) if shaft.carrier is None else shaft for shaft in shafts],
        "bearings": [
            replace(one, rotor=name(one.rotor), bearing=replace(one.bearing, name=name(one.bearing.name)))
            for one in parts["bearings"]
        ],
        "gears": [
            replace(one, shaft=name(one.shaft), gear=replace(one.gear, name=name(one.gear.name)))
            for one in parts["gears"]
        ],
        "gear_pairs": [replace(one, driver=name(one.driver), driven=name(one.driven)) for one in parts["gear_pairs"]],
        "torque_supports": [replace(one, shaft=name(one.shaft)) for one in parts["torque_supports"]],
        "outputs": [replace(one, shaft=name(one.shaft)) for one in parts["outputs"]],
    }


@cache
def two_sets() -> Machine:
    """Two sets in a row: the carrier of the first is the sun's shaft of the second; a pin of each is off its place."""
    of_set = {"pressure_angle": np.radians(20.0), "with_ring": True, "material": STEEL, "diameter": 0.05}
    first, second = (
        _named(plane_set(equal_angles(3), **of_set), letter, start) for letter, start in (("a", 0.0), ("b", 0.2))
    )
    shafts = {shaft.name: shaft for shaft in (*first["shafts"], *second["shafts"])}
    del shafts["b sun"]
    carrier = shafts["a carrier"].rotor
    long = Rotor("a carrier", [*carrier.segments, Segment(0.2, 0.05, 0.0, STEEL)], carrier.discs)
    shafts["a carrier"] = replace(shafts["a carrier"], rotor=long)
    gears = [
        replace(one, shaft="a carrier", at=0.25) if one.shaft == "b sun" else one
        for one in (*first["gears"], *second["gears"])
    ]
    bearings = [one for one in (*first["bearings"], *second["bearings"]) if one.rotor != "b sun"]
    return Machine(
        shafts=list(shafts.values()),
        bearings=bearings,
        gears=gears,
        gear_pairs=[*first["gear_pairs"], *second["gear_pairs"]],
        torque_supports=[*first["torque_supports"], *second["torque_supports"]],
        outputs=second["outputs"],
        speed=300.0,
        torque=100.0,
    )


@pytest.mark.slow
def test_mean_forces_of_two_carriers_are_those_of_independent_angles() -> None:
    """Statics at five angles of each. At equal angles the sets stand alike all round, with a pin's error in place."""
    machine = two_sets()
    ways = [2.0 * np.pi * number / 5 for number in range(5)]
    forces = np.array(
        [
            [pair.force for pair in machine.turned(one, "a carrier").turned(two, "b carrier").operating_point().pairs]
            for one, two in itertools.product(ways, ways)
        ]
    )
    found = [pair.mean_force for pair in machine.linearised(machine.operating_point()).gear_pairs]
    assert found == pytest.approx(forces.mean(axis=0), rel=1e-4)
    at_equal_angles = forces.reshape(5, 5, -1)[range(5), range(5)].mean(axis=0)
    assert np.abs(at_equal_angles / found - 1.0).max() > 0.03


@cache
def past_a_force(angle: float = 0.0) -> Machine:
    """Planets on rollers and flanks that their deflection tilts, on a carrier that a force pulls down as it turns."""
    base = machine_on_rollers("linear")
    pairs = [replace(pair, misalignment=None) for pair in base.gear_pairs]
    forces = [ShaftForce("carrier", 0.1, (0.0, -6000.0, 0.0))]
    return replace(base, gear_pairs=pairs, forces=forces).turned(angle, "carrier")


@pytest.mark.slow
def test_flanks_and_bearings_are_the_means_of_statics_over_a_turn() -> None:
    """Statics at 24 angles, from which the first one's gaps are 7 µm off and its rollers' stiffness by a tenth."""
    points = over_carrier_turn(past_a_force(), "carrier").points
    gaps = np.array([[pair.station_gap for pair in point.pairs] for point in points])
    stiffness = np.array([_along_carrier(point.bearings, turn) for turn, point in enumerate(points)])
    assert np.abs(gaps[0] - gaps.mean(axis=0)).max() > 5e-6
    assert np.abs(stiffness[0] - stiffness.mean(axis=0)).max() > 0.09 * stiffness.max()
    # Under the mean force.
    more = np.array([[pair.force for pair in point.pairs] for point in points])
    more -= more.mean(axis=0)
    approach = np.array([[pair.pair.contact.face_mean @ pair.approach for pair in point.pairs] for point in points])
    approach -= more / [[pair.mean_stiffness for pair in point.pairs] for point in points]
    for angle in (0.9, 0.0):
        about = past_a_force(angle).at_operating_point()
        found = [pair.face_gap for pair in about.gear_pairs]
        np.testing.assert_allclose(found, gaps.mean(axis=0), atol=1e-8)
        tangents = _planes([one.bearing.spatial_stiffness for one in about.bearings if one.elements], angle)
        np.testing.assert_allclose(tangents, stiffness.mean(axis=0), atol=0.03 * stiffness.max())
    # At the first angle the flanks are nearer than in the mean by what they approach more.
    changes = np.array([pair.gap_changes[0] for pair in about.gear_pairs])
    nearer = [pair.pair.contact.face_mean[:-1] @ change for pair, change in zip(points[0].pairs, changes, strict=True)]
    np.testing.assert_allclose(nearer, approach.mean(axis=0) - approach[0], atol=3e-8)
    assert np.abs(nearer).max() > 3e-7
    forces = np.mean([[pair.force for pair in point.pairs] for point in points], axis=0)
    means = [mean for mean in mean_meshes(about.assembled.system) if mean]
    assert [mean.force for mean in means] == pytest.approx(forces, rel=1e-3)
    rises = np.array([[pair.mean_stiffness for pair in point.pairs] for point in points])
    assert [mean.stiffness for mean in means] == pytest.approx(rises.mean(axis=0), rel=0.03)
    assert np.all(rises.mean(axis=0) < 0.93 * rises.max(axis=0))


HALF, WHOLE, LOAD = 0.02, 4e8, 800.0
"""Half of a face [m], its stiffness where all of it carries [N/m], and its load [N]."""


def _force(approach: float, slope: float) -> tuple[float, float]:
    """Force and stiffness of flanks that stand open by a slope [rad] and carry over a part of their face."""
    end = abs(slope) * HALF
    if approach >= end:
        return WHOLE * approach, WHOLE
    carrying = max(0.0, approach + end) / abs(slope)
    return WHOLE * carrying**2 * abs(slope) / (4.0 * HALF), WHOLE * carrying / (2.0 * HALF)


def _approach(slope: float) -> float:
    """Approach at which the load is carried [m]."""
    end = abs(slope) * HALF
    even = LOAD / WHOLE
    return even if even >= end else math.sqrt(4.0 * HALF * LOAD * abs(slope) / WHOLE) - end


def _swinging(slopes: FloatArray, moved: FloatArray) -> tuple[float, float]:
    """Approach and stiffness of slices under the load, with gaps at several angles and the approach there."""
    n = 241
    z = HALF * ((2.0 * np.arange(n) + 1.0) / n - 1.0)
    line = WHOLE / (2.0 * HALF)
    slices = FaceSlices(
        z, 2.0 * HALF / n, 0.0 * z, 0.0 * z, 2.0 * line, 0.0, changes=np.outer(slopes, z) - moved[:, None]
    )
    ones, owner = np.ones((1, n)), np.zeros(1, dtype=np.intp)
    at, loads = face_equilibrium(slices, 2.0 * line * ones, 0.0 * ones, ones > 0.0, owner, np.array([LOAD]))
    assert float(loads.force[0]) == pytest.approx(LOAD, rel=1e-8)
    return float(at[0]), float(loads.tangent[0])


def test_a_face_has_the_mean_force_of_its_gaps_at_one_approach() -> None:
    """By the integral over the part that carries; at one of the gaps the flanks are apart."""
    slopes, moved = np.array([2e-4, -1e-4, 3e-5, 1e-4]), np.array([0.0, 2e-7, -3e-7, -8e-6])
    approach, stiffness = _swinging(slopes, moved)
    each = [_force(approach + more, slope) for slope, more in zip(slopes, moved, strict=True)]
    assert each[-1][0] == 0.0
    assert np.mean([force for force, _ in each]) == pytest.approx(LOAD, rel=1e-3)
    assert stiffness == pytest.approx(np.mean([rise for _, rise in each]), rel=0.01)


def test_lines_at_the_mesh_frequency_are_those_of_the_mean_over_swinging_gaps() -> None:
    """A mass on flanks that swing once in 90 mesh periods by more than their deflection, integrated as it is."""
    slope, waves, steps = 3e-6 / HALF, 90, 40
    angles = 2.0 * np.pi * np.arange(7) / 7
    at_each = np.array([_approach(slope * math.cos(angle)) for angle in angles])
    _, mean = _swinging(slope * np.cos(angles), at_each - at_each.mean())
    damping, error = 0.1 * math.sqrt(WHOLE), 2e-8  # of a mass of 1 kg
    frequency = 2.0 * math.sqrt(WHOLE)

    def acceleration(time: float, place: float, speed: float) -> float:
        phase = frequency * time
        force, _ = _force(place - error * math.cos(phase), slope * math.cos(phase / waves))
        return LOAD - force - damping * (speed + error * frequency * math.sin(phase))

    step, place, speed = 2.0 * math.pi / frequency / steps, _approach(slope), 0.0
    places = []
    for number in range(2 * waves * steps):
        time = number * step
        a = acceleration(time, place, speed)
        b = acceleration(time + 0.5 * step, place + 0.5 * step * speed, speed + 0.5 * step * a)
        c = acceleration(time + 0.5 * step, place + 0.5 * step * (speed + 0.5 * step * a), speed + 0.5 * step * b)
        d = acceleration(time + step, place + step * (speed + 0.5 * step * b), speed + step * c)
        place, speed = place + step * (speed + step * (a + b + c) / 6.0), speed + step * (a + 2.0 * (b + c) + d) / 6.0
        places.append(place)
    line = 2.0 * abs(np.fft.rfft(places[waves * steps :])[waves]) / (waves * steps)

    def answer(stiffness: float) -> float:
        return error * abs(1.0 / (1.0 - frequency**2 / (stiffness + 1j * frequency * damping)))

    assert answer(mean) == pytest.approx(line, rel=0.005)
    assert abs(answer(WHOLE) / line - 1.0) > 0.05  # by the mean gap, which is none


def _along_carrier(loads: Sequence[BearingLoad], turn: int) -> FloatArray:
    """Tangents of the planets' rollers over the carrier's first x and y after a part of its turn, (b, 2, 2)."""
    return _planes([load.stiffness for load in loads if load.mounted.elements], turn * 2.0 * np.pi / ANGLES)


def _planes(stiffness: Sequence[FloatArray], angle: float) -> FloatArray:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.array([turn.T @ one[:2, :2] @ turn for one in stiffness])
