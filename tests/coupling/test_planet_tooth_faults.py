"""Faulty teeth of planetary sets meet every mate when the turning of the gears brings them there, counted by hand.

A tooth of the planet touches the sun with one flank and, half a turn on the carrier later, the ring with the other. Its
middle is a quarter of a pitch past the line of centres when its flank behind is at the pitch point, and as much before
it when its flank ahead is: from the sun to the ring are (z_p - 1) / 2 mesh periods. A tooth of the sun or the ring
meets the planets one after another, z / N mesh periods apart.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from planetary_machines import set_parts

from gearwhine.coupling import Machine
from gearwhine.coupling.gears import MissingTooth, PotentialEnergyStiffness, Spall, ToothCrack, Wear
from gearwhine.coupling.gears.geometry.gear import Fault
from gearwhine.coupling.signals import line_names

SUN, PLANET, RING, COUNT = 25, 31, 87, 4
TOOTH = 7
SPALL = Spall(TOOTH, 0.3, 0.35, 5e-6)


def machine(on: str, *faults: Fault, **errors: Any) -> Machine:
    parts = set_parts(sun=SUN, planet=PLANET, count=COUNT)
    parts["gears"] = [
        replace(one, gear=replace(one.gear, faults=faults, **errors)) if one.gear.name == on else one
        for one in parts["gears"]
    ]
    parts["gear_pairs"] = [
        replace(pair, stiffness=PotentialEnergyStiffness(), misalignment=0.0, corner_contact=True)
        for pair in parts["gear_pairs"]
    ]
    return Machine(**parts)


def passes(made: Machine, pair: int, *, of: int) -> npt.NDArray[np.float64]:
    """Mesh periods from t = 0 at which a faulty pair of teeth is at the pitch point; they repeat after ``of``."""
    loaded = made.loaded_pairs()[pair]
    (numbers,) = np.nonzero(loaded.contact.pair_variants)
    assert loaded.contact.hunting_period in (1, of)
    return np.asarray((numbers + loaded.geometry.pitch_point_position - made.mesh_phases[pair]) % of)


def test_a_tooth_of_the_planet_meets_sun_and_ring_once_each_in_its_turn_on_the_carrier() -> None:
    made = machine("p 2", Wear(4e-6, tooth=TOOTH))
    (at_sun,), (at_ring,) = passes(made, 1, of=PLANET), passes(made, COUNT + 1, of=PLANET)
    assert (at_ring - at_sun) % PLANET == pytest.approx(0.5 * (PLANET - 1), abs=1e-9)
    others = [number for number in range(2 * COUNT) if number not in (1, COUNT + 1)]
    assert all(passes(made, number, of=PLANET).size == 0 for number in others)


@pytest.mark.parametrize(("flank", "meets"), [("working", 0), ("back", COUNT)])
@pytest.mark.parametrize("kind", ["spall", "crack"])
def test_a_fault_of_one_flank_meets_the_mate_on_that_side(kind: str, flank: Any, meets: int) -> None:
    fault: Fault = replace(SPALL, flank=flank) if kind == "spall" else ToothCrack(TOOTH, 1e-3, flank=flank)
    made = machine("p 1", fault)
    assert [passes(made, number, of=PLANET).size for number in (0, COUNT)] == [int(meets == n) for n in (0, COUNT)]
    loaded = made.loaded_pairs()[meets].contact
    # Behind the flank that works in this mesh is the sound one.
    assert not loaded.back_pair_variants.any()


def test_a_missing_tooth_is_missing_on_both_sides() -> None:
    loaded = machine("p 1", MissingTooth(TOOTH)).loaded_pairs()
    assert [np.count_nonzero(loaded[number].contact.pair_variants) for number in (0, COUNT)] == [1, 1]
    assert np.count_nonzero(loaded[0].contact.back_pair_variants) == 1


@pytest.mark.parametrize(
    ("on", "teeth", "first", "order"),
    # Relative to the carrier the sun turns towards the second planet, the ring towards the last one.
    [("s", SUN, 0, (0, 1, 2, 3)), ("r", RING, COUNT, (0, 3, 2, 1))],
)
def test_a_tooth_of_sun_or_ring_meets_the_planets_one_after_another(
    on: str, teeth: int, first: int, order: tuple[int, ...]
) -> None:
    made = machine(on, replace(SPALL, start_roll_angle=0.3 if on == "s" else 0.36, end_roll_angle=0.4))
    times = [float(passes(made, first + planet, of=teeth)[0]) for planet in order]
    expected = [n * teeth / COUNT for n in range(COUNT)]
    np.testing.assert_allclose((np.array(times) - times[0] + 1e-9) % teeth, expected, atol=1e-8)


def test_a_tooth_out_of_its_place_leads_on_one_side_and_lags_on_the_other() -> None:
    """A planet's tooth displaced by f along the pitch circle moves by f cos(w) on either line of action."""
    error = 6e-6
    made = machine("p 3", pitch_deviations=tuple(error if n == TOOTH else 0.0 for n in range(PLANET)))
    sun, ring = (made.loaded_pairs()[number].contact for number in (2, COUNT + 2))
    lead = error * math.cos(math.radians(20.0))
    assert sun.pitch_gaps[sun.pitch_gaps != 0.0] == pytest.approx([-lead])
    assert ring.pitch_gaps[ring.pitch_gaps != 0.0] == pytest.approx([lead])
    assert np.count_nonzero(made.loaded_pairs()[0].contact.pitch_gaps) == 0
    at_sun, at_ring = (
        float(np.flatnonzero(law.pitch_gaps)[0]) + geometry.pitch_point_position - made.mesh_phases[number]
        for law, geometry, number in zip(
            (sun, ring), (made.pair_geometries[2], made.pair_geometries[COUNT + 2]), (2, COUNT + 2), strict=True
        )
    )
    assert (at_ring - at_sun) % PLANET == pytest.approx(0.5 * (PLANET - 1), abs=1e-9)


def test_a_reversed_train_meets_the_planets_in_the_other_order() -> None:
    """Turned backwards the sun leads the tooth towards the last planet; numbers count in the order of entering."""
    made = machine("s", SPALL)
    parts = {name: getattr(made, name) for name in ("shafts", "bearings", "gears", "gear_pairs", "planetary_sets")}
    back = Machine(**parts, torque_supports=made.torque_supports, speed=-100.0, torque=50.0)
    times = [float(passes(back, planet, of=SUN)[0]) for planet in (0, 3, 2, 1)]
    np.testing.assert_allclose(
        (np.array(times) - times[0] + 1e-9) % SUN, [n * SUN / COUNT for n in range(COUNT)], atol=1e-8
    )


@pytest.mark.parametrize(("on", "rotation"), [("s", "s in c"), ("p 2", "p 2 in c"), ("r", "r in c")])
def test_lines_of_a_faulty_gear_have_its_turn_on_the_carrier_and_the_turn_of_that(on: str, rotation: str) -> None:
    """Around the mesh harmonics, at n f_mesh ± k |f - f_c| ± m f_c; at its own multiples below them."""
    made = machine(on, MissingTooth(TOOTH))
    assembled = made.assemble()
    turns = {name: speed / (2.0 * math.pi) for name, speed in made.speeds.items()}
    carrier, turn = turns["c"], abs(turns[on] - turns["c"])
    mesh = SUN * (turns["s"] - turns["c"])
    asked = {
        2.0 * mesh + 2.0 * turn - carrier: f"2× {{}} + 2× {rotation} - 1× c",
        mesh - turn: f"1× {{}} - 1× {rotation}",
        7.0 * turn: f"7× {rotation}",
    }
    if on == "r":
        # The ring is held: it turns as fast on the carrier as the carrier does.
        asked = {mesh - turn: "1× {} - 1× c", 7.0 * turn: f"7× {rotation}"}
    for frequency, expected in asked.items():
        (found,) = line_names(assembled, [frequency], 1e-3)
        pairs = [pair for pair in made.gear_pairs if on in (pair.driver, pair.driven)]
        named = [expected.format(f"{one.driver} -> {one.driven}") for one in pairs]
        if on == "r":
            # All meshes have this line, and are named together.
            named = [expected.format("planets' meshes")]
        assert found.name.split(", ")[0] in named
