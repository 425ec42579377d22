"""Odd but sound machines are not refused: by the reader, by what `check` builds, and some by what is solved."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from odd_but_sound import MACHINES, on_balls

import gearwhine as gw
from gearwhine.case import parse_case
from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.loaded.gear_pair import GearPair, load_gear_pair
from gearwhine.housing.material import STEEL
from gearwhine.rotors import Bearing, Rotor, Segment
from gearwhine.rotors.analyses.rest_frequencies import rest_frequencies
from gearwhine.solve.case_summary import check_case


def test_there_are_sixty() -> None:
    assert len(MACHINES) >= 60


@pytest.mark.parametrize("name", MACHINES)
def test_an_odd_but_sound_machine_is_accepted(name: str) -> None:
    check_case(parse_case(MACHINES[name]))


def test_helical_teeth_carry_on_as_less_than_one_pair_meets_in_a_plane() -> None:
    """From a transverse contact ratio above 1 to one below nothing jumps: the faces overlap by more than two pairs."""
    stiffness = {}
    for angle in (45.0, 46.0, 47.0):
        driver, driven = (
            Gear(name, teeth, 2e-3, math.radians(20.0), 20e-3, helix_angle=math.radians(hand * angle))
            for name, teeth, hand in (("p", 20, 1.0), ("w", 40, -1.0))
        )
        geometry = GearPairGeometry(driver, driven)
        mesh = load_gear_pair(GearPair("p", "w", "weber-banaschek"), geometry, torque=50.0, inertias=(1e-3, 1e-2))
        stiffness[angle] = mesh.static.mean_mesh_stiffness
        assert (geometry.contact_ratio > 1.0) == (angle < 45.5)
        assert mesh.static.tangent_stiffness.min() > 0.9 * stiffness[angle]  # some teeth carry at every phase
    assert stiffness[46.0] == pytest.approx(0.5 * (stiffness[45.0] + stiffness[47.0]), rel=2e-3)


def test_a_damper_and_a_seal_change_the_shaft_by_what_they_do() -> None:
    """A damper leaves the frequencies at rest; a seal lowers the first one as a spring of the other sign raises it."""
    rotor = Rotor("s", [Segment(1.0, 50e-3, 0.0, STEEL)])
    ends = [Bearing.isotropic("l", 0.0, 1e7), Bearing.isotropic("r", 1.0, 1e7)]
    alone, damped, sealed, sprung = (
        rest_frequencies(rotor, [*ends, *middle], count=4).frequencies[0]
        for middle in (
            [],
            [Bearing.isotropic("m", 0.5, 0.0, 2e4)],
            [Bearing.isotropic("m", 0.5, -1e5)],
            [Bearing.isotropic("m", 0.5, 1e5)],
        )
    )
    assert damped == pytest.approx(alone, rel=1e-9)
    # Rayleigh: equal and opposite springs move the square of a frequency equally and oppositely.
    assert alone**2 - sealed**2 == pytest.approx(sprung**2 - alone**2, rel=0.02)
    assert sealed < alone < sprung


def test_a_belt_loads_its_ball_bearings_by_the_lever() -> None:
    case: dict[str, Any] = on_balls(force=[{"rotor": "s", "at": "0.05 m", "y": "-4000 N"}])
    point = gw.build(**case).operating_point()
    forces = {entry["name"]: entry["force_n"] for entry in point.document["bearings"]}
    np.testing.assert_allclose([forces["l"][1], forces["r"][1]], [-3000.0, -1000.0], rtol=0.02)
