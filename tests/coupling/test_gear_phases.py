"""Pairs that share a gear mesh where its teeth put them: its outlines, drawn for either pair, agree."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from coupled_cases import coupled
from hypothesis import given, settings
from hypothesis import strategies as st
from idler_case import idler
from scipy.spatial import cKDTree

from gearwhine.case import load_case
from gearwhine.coupling import CouplingError
from gearwhine.coupling.description.gear_train import mesh_phases
from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.geometry.profile import pair_outlines
from gearwhine.numerics.arrays import FloatArray


def gear(name: str, teeth: int, profile_shift: float = 0.0) -> Gear:
    return Gear(
        name, teeth=teeth, module=3e-3, pressure_angle=math.radians(20.0), face_width=0.02, profile_shift=profile_shift
    )


def pair(one: Gear, other: Gear) -> GearPairGeometry:
    return GearPairGeometry(one, other)


def same_outline(one: FloatArray, other: FloatArray) -> float:
    """Largest distance of a point of either outline from the nearest of the other [m]."""
    return float(max(cKDTree(one).query(other)[0].max(), cKDTree(other).query(one)[0].max()))


angles = st.floats(-math.pi, math.pi)
teeth = st.integers(18, 40)
senses = st.sampled_from([1, -1])


@settings(max_examples=25, deadline=None)
@given(teeth, teeth, teeth, angles, angles, senses)
def test_one_gear_drives_two(n1: int, n2: int, n3: int, to_2: float, to_3: float, sense: int) -> None:
    first, second = pair(gear("a", n1), gear("b", n2)), pair(gear("a", n1), gear("c", n3, 0.2))
    phases = mesh_phases(["a", "a"], ["b", "c"], [first, second], [to_2, to_3], [sense, sense])
    assert phases[0] == 0.0
    drawn = [
        pair_outlines(geometry, phase, centre_line_angle=line, sense=sense, points=12)[0]
        for geometry, phase, line in zip((first, second), phases, (to_2, to_3), strict=True)
    ]
    assert same_outline(*drawn) < 1e-9


@settings(max_examples=25, deadline=None)
@given(teeth, teeth, teeth, angles, angles, senses)
def test_an_idler_hands_on(n1: int, n2: int, n3: int, to_2: float, to_3: float, sense: int) -> None:
    """The idler is driven on one flank and drives with the other: its thickness is in the answer."""
    first, second = pair(gear("a", n1), gear("b", n2, 0.1)), pair(gear("b", n2, 0.1), gear("c", n3))
    phases = mesh_phases(["a", "b"], ["b", "c"], [first, second], [to_2, to_3], [sense, -sense])
    driven = pair_outlines(first, phases[0], centre_line_angle=to_2, sense=sense, points=12)[1]
    distance = first.working_centre_distance
    centre = np.array([distance * math.cos(to_2), distance * math.sin(to_2)])
    drives = pair_outlines(second, phases[1], centre_line_angle=to_3, sense=-sense, points=12)[0]
    assert same_outline(driven - centre, drives) < 1e-9


def test_by_hand() -> None:
    """The place of the second mesh is reached a quarter turn later or sooner: 36 teeth are 9 pitches, 38 are 9.5."""
    for count, part in ((36, 0.0), (38, 0.5)):
        one = pair(gear("a", count), gear("b", 30))
        phases = mesh_phases(["a", "a"], ["b", "c"], [one, one], [0.0, math.pi / 2.0], [1, 1])
        assert phases[1] % 1.0 == pytest.approx(part, abs=1e-9) or phases[1] % 1.0 == pytest.approx(
            1.0 + part, abs=1e-9
        )


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
def test_a_chain_is_in_mesh_in_any_order_of_its_pairs(order: tuple[int, ...]) -> None:
    """An open chain can always be assembled, and both pairs of an idler draw its teeth at the same place."""
    chain = [gear(name, count) for name, count in (("a", 21), ("b", 26), ("c", 31), ("d", 24))]
    lines, senses = (0.0, 0.7, -0.4), (1, -1, 1)
    pairs = [pair(chain[n], chain[n + 1]) for n in order]
    listed = mesh_phases(
        [chain[n].name for n in order],
        [chain[n + 1].name for n in order],
        pairs,
        [lines[n] for n in order],
        [senses[n] for n in order],
    )
    drawn = {
        n: pair_outlines(geometry, phase, centre_line_angle=lines[n], sense=senses[n], points=12)
        for n, geometry, phase in zip(order, pairs, listed, strict=True)
    }
    for n in (0, 1):
        away = pair(chain[n], chain[n + 1]).working_centre_distance
        centre = away * np.array([math.cos(lines[n]), math.sin(lines[n])])
        assert same_outline(drawn[n][1] - centre, drawn[n + 1][0]) < 1e-9


@pytest.mark.parametrize("whole", range(9, 26))
def test_loops_must_fit(whole: int) -> None:
    """Sun, two planets, wheel at the corners of a rhombus whose angle at the sun is twice the tilt.

    Round a loop the arcs between the meshes, in pitches and with the sense of each gear, add up to a whole number. At
    the corners stand angles 2θ, π - 2θ, 2θ, π - 2θ: so 2θ (N_s + N_w) - 2 (π - 2θ) N_p = 2π k, or
    θ = π k' / (N_s + N_w + 2 N_p).
    """
    inner, outer = pair(gear("sun", 24), gear("p", 20)), pair(gear("p", 20), gear("wheel", 24))
    names = ["sun", "p", "sun", "q"], ["p", "wheel", "q", "wheel"]

    def assembled(tilt: float) -> list[float]:
        lines = [tilt, -tilt, -tilt, tilt]
        return mesh_phases(*names, [inner, outer, inner, outer], lines, [1, -1, 1, -1])

    assert len(assembled(math.pi * whole / 88.0)) == 4
    with pytest.raises(CouplingError, match=r"wheel would stand 0.300 pitches beside"):
        assembled(math.pi * (whole + 0.3) / 88.0)


def test_back_flanks_of_a_machine_stand_at_the_other_sides_of_the_same_teeth(tmp_path: Path) -> None:
    """Each mesh, drawn by the phase of its drive flanks and, turning the other way, by that of its back flanks."""
    # The third axis stands at an angle, so that the second mesh is at no multiple of half a pitch.
    aside = [f"{44.45 + 88.9 * math.cos(0.87):.6f} mm", f"{88.9 * math.sin(0.87):.6f} mm"]
    changes = ["gear_pair.1.backlash=0.1 mm", f"rotor.third.axis={aside}"]
    machine = coupled(load_case(str(idler(tmp_path)), changes).case)
    contacts = {contact.name: contact for contact in machine.system.contacts}
    phases = [contacts[mesh.name].phase for mesh in machine.meshes]
    assert abs(2.0 * phases[1] - round(2.0 * phases[1])) > 0.01
    for mesh, phase in zip(machine.meshes, phases, strict=True):
        back = contacts[f"{mesh.name}, back"]
        assert back.mesh_frequency == -contacts[mesh.name].mesh_frequency
        drawn = pair_outlines(mesh.geometry, phase, centre_line_angle=0.3, sense=1, points=12)
        mirrored = pair_outlines(mesh.geometry, back.phase, centre_line_angle=0.3, sense=-1, points=12)
        for one, other in zip(drawn, mirrored, strict=True):
            assert same_outline(one, other) < 1e-9
