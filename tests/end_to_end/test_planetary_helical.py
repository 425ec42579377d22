"""The bundled planetary and helical unit: its drawing, power flow, statics by hand, lines of both stages."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearwhine.case import load_case
from gearwhine.coupling.signals.line_names import line_names

NAME = "planetary-helical"
COARSE = ("--set", "housing.cad.mesh_size=26 mm", "--set", "housing.frequency_limit=900 Hz")

# Teeth of sun, planet and ring; of the helical pair, its module and distance [m], its helix [rad].
SUN, PLANET, RING, PINION, WHEEL = 24, 33, 90, 22, 69
MODULE, DISTANCE, HELIX = 3e-3, 0.140, math.radians(12.0)
CARRIER_TURN = 3000.0 / 60.0 / (1.0 + RING / SUN)
"""Turns of the carrier in a second, by Willis."""
TORQUE = 60.0
"""Torque at the sun [N m]."""


def test_the_script_draws_the_bundled_file(drawing_script: Any, solid_measures: Any, tmp_path: Path) -> None:
    script = drawing_script("make_planetary_helical")
    script.write(tmp_path / "drawn.step")
    bundled, size = solid_measures(script.TARGET), script.Unit()
    assert bundled == pytest.approx(solid_measures(tmp_path / "drawn.step"), rel=1e-6, abs=1e-4)
    ends = [size.neck.z[0], max(end for boss in size.bosses for end in boss.z)]
    assert bundled[3::3] == pytest.approx(ends, abs=1e-5)
    assert bundled[2::3] == pytest.approx([0.0, size.box[1][1]], abs=1e-5)


@pytest.mark.slow
def test_check_has_speeds_torques_and_mesh_frequencies_of_both_stages(gearwhine: Any) -> None:
    document = gearwhine("check", NAME, "-q", "--json").document
    assert document["warnings"] == []  # each bearing stands in the bore of its own seat
    speeds = {rotor["name"]: rotor["speed_rpm"] for rotor in document["rotors"]}
    assert speeds["carrier"] == pytest.approx(60.0 * CARRIER_TURN)
    assert speeds["output"] == pytest.approx(-60.0 * CARRIER_TURN * PINION / WHEEL)
    ratio = (1.0 + RING / SUN) * WHEEL / PINION
    outputs = {one["rotor"]: one["torque_n_m"] for one in document["operation"]["torques"]}
    assert outputs["output"] == pytest.approx(TORQUE * ratio, rel=1e-9)
    frequencies = {(pair["driver"], pair["driven"]): pair["mesh_frequency_hz"] for pair in document["gear_pairs"]}
    assert frequencies["pinion", "wheel"] == pytest.approx(PINION * CARRIER_TURN)
    assert [frequencies["s", f"p {n}"] for n in (1, 2, 3)] == pytest.approx(3 * [RING * CARRIER_TURN])
    assert [frequencies[f"p {n}", "r"] for n in (1, 2, 3)] == pytest.approx(3 * [RING * CARRIER_TURN])
    (stage,) = document["planetary"]
    torques = {member["role"]: member["torque_n_m"] for member in stage["members"]}
    by_hand = [TORQUE, TORQUE * RING / SUN, -TORQUE * (1.0 + RING / SUN)]
    assert [torques[role] for role in ("sun", "ring", "carrier")] == pytest.approx(by_hand)


def _mesh_force(on_wheel: bool) -> np.ndarray:
    """Force of the helical pair on pinion or wheel [N]: the normal of involute flanks, at the torque of the carrier.

    The carrier turns counter-clockwise about z, so that the pinion pushes the wheel, which stands at +x of it, along y;
    both are pressed apart. A left-handed pinion that turns so is a left-handed screw: it pushes its nut along z.
    """
    transverse = math.atan(math.tan(math.radians(20.0)) / math.cos(HELIX))
    radius = MODULE * PINION / (2.0 * math.cos(HELIX))
    base = radius * math.cos(transverse)
    working = math.acos(base / (DISTANCE * PINION / (PINION + WHEEL)))
    across = TORQUE * (1.0 + RING / SUN) / base
    base_helix = math.atan(math.tan(HELIX) * math.cos(transverse))
    force = across * np.array([math.sin(working), math.cos(working), math.tan(base_helix)])
    return force if on_wheel else -force


@pytest.mark.slow
@pytest.mark.usefixtures("linear_drawings")
def test_bearings_carry_both_stages(gearwhine: Any, tmp_path: Path) -> None:
    """Reactions of the bearings by the equilibrium of each shaft, from the planets' shares and the helical mesh."""
    document = gearwhine("load", NAME, "-o", str(tmp_path / "out"), *COARSE, "-q", "--json").document
    bearings = {bearing["name"]: bearing for bearing in document["bearings"]}
    (stage,) = document["planetary"]
    shares = np.array([planet["load_share"] for planet in stage["planets"]])
    assert shares.sum() == pytest.approx(1.0, abs=1e-9)
    forces = {(pair["driver"], pair["driven"]): pair["force_n"] for pair in document["gear_pairs"]}
    base = 2e-3 * SUN / 2.0 * math.cos(math.radians(20.0))
    assert [forces["s", f"p {n}"] for n in (1, 2, 3)] == pytest.approx(TORQUE / base * shares, rel=1e-6)
    transverse = np.hypot(*_mesh_force(True)[:2])
    assert forces["pinion", "wheel"] == pytest.approx(transverse, rel=1e-6)

    width = DISTANCE / (PINION + WHEEL)
    on_output = [((-width * WHEEL, 0.0, 0.103), _mesh_force(True))]
    # The planets push their pins, 57 mm out, around with the carrier.
    on_carrier = [((width * PINION, 0.0, 0.103), _mesh_force(False))]
    for number, share in enumerate(shares):
        angle = 2.0 * math.pi * number / 3
        push = TORQUE * (1.0 + RING / SUN) / 0.057 * share * np.array([-math.sin(angle), math.cos(angle), 0.0])
        on_carrier.append(((0.057 * math.cos(angle), 0.057 * math.sin(angle), 0.0), push))
    offsets = []
    for shaft, loads, locating in (("output", on_output, "output-front"), ("carrier", on_carrier, "carrier-back")):
        forces_on_shaft, couples = list(loads), np.zeros(3)
        for name, z in ((f"{shaft}-back", 0.062), (f"{shaft}-front", 0.146)):
            # The shaft feels the opposite of its forces on the bearings; the deep-groove one holds its tilt too.
            forces_on_shaft.append(((0.0, 0.0, z), -np.array(bearings[name]["force_n"])))
            couples[:2] -= bearings[name]["moment_n_m"][:2]
        mesh = loads[0][1]
        assert sum(force for _, force in forces_on_shaft) == pytest.approx(np.zeros(3), abs=1e-4 * np.linalg.norm(mesh))
        assert bearings[locating]["force_n"][2] == pytest.approx(mesh[2], rel=1e-4)
        moment = sum((np.cross(point, force) for point, force in forces_on_shaft), couples)[:2]
        # What is left is the mesh force beside the middle of the face, as the misaligned flanks carry unevenly.
        arm = np.cross([0.0, 0.0, 1.0], mesh)[:2]
        offsets.append(-moment @ arm / (arm @ arm))
        left = moment + offsets[-1] * arm
        assert left == pytest.approx(np.zeros(2), abs=0.01 * 0.084 * np.linalg.norm(mesh)), (shaft, left)
    assert offsets[0] == pytest.approx(offsets[1], abs=2e-4), offsets
    assert abs(offsets[0]) < 0.042 / 6.0  # within the core of the face, all of which carries


@pytest.mark.slow
def test_lines_of_both_stages_have_their_names() -> None:
    """Multiples of the carrier's turns: every 22nd of the helical pair, the 90th and its neighbours of the planets."""
    machine = load_case(NAME).case.parts.machine
    assert machine is not None
    assembled = machine.at_operating_point().assembled
    turns = (PINION, 2 * PINION, RING, RING + 1, RING - 1, 8 * PINION + 2)
    names = [one.name for one in line_names(assembled, [turn * CARRIER_TURN for turn in turns], 0.01)]
    assert names[0] == "1× pinion -> wheel"
    assert names[1] == "2× pinion -> wheel"
    assert names[2].startswith("1× planets' meshes")
    for name, side in zip(names[3:5], ("+ 1×", "- 1×"), strict=True):
        assert f"1× planets' meshes {side} carrier" in name
    # The pinion turns with the carrier: what both modulate twice has one name.
    assert names[5] == "2× planets' meshes - 2× carrier, 8× pinion -> wheel + 2× carrier"
