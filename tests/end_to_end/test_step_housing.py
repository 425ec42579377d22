"""A housing built apart from the package, written as STEP by gmsh's own kernel, beside the same shape as a box case.

Ribs outside and inside, a rounded cavity, feet, bores with bosses, a cover on a flange as a solid of its own on bolts.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearwhine.meshes.gmsh_meshing import gmsh_session

# All in mm. The origin is the middle of the box in x and z, the underside of its base in y.
X, Y, Z, WALL, FILLET = 140.0, 110.0, 130.0, 12.0, 8.0
PLATE, FLANGE, RIM = 12.0, 14.0, 12.0  # the cover's thickness; how far the flange stands out, and its own thickness
BORE, BOSS, STANDS = 40.0, 60.0, 8.0
BOLT = 8.0  # the bolts' diameter, and the radius of what they clamp
BOLTS = [(x, z) for x in (-70.0, 0.0, 70.0) for z in (-65.0, 65.0)]
FOOT = (34.0, 12.0, 34.0)
MESH = 32.0

HEAD = """
[material.iron]
youngs_modulus = "110 GPa"
poisson_ratio = 0.27
density = "7200 kg/m^3"
[housing]
material = "iron"
modes = 6
"""
SEATS = f"""
[[housing.seat]]
name = "drive end"
center = ["10 mm", "50 mm", "{Z / 2} mm"]
diameter = "{BORE} mm"
{{boss}}
[[housing.seat]]
name = "free end"
center = ["10 mm", "50 mm", "{-Z / 2} mm"]
diameter = "{BORE} mm"
{{boss}}
"""
BOX = f"""
[housing.box]
size = ["{X} mm", "{Y} mm", "{Z} mm"]
wall = "{WALL} mm"
mesh_size = "{MESH} mm"
feet = {{ size = ["{FOOT[0]} mm", "{FOOT[1]} mm", "{FOOT[2]} mm"] }}
fillets = {{ inside = "{FILLET} mm" }}
ribs = [
    {{ face = "left", along = "y", at = "5 mm", height = "14 mm", thickness = "10 mm", to = "80 mm" }},
    {{ face = "bottom", side = "inside", along = "x", at = "-8 mm", height = "16 mm", thickness = "10 mm" }},
]
[housing.box.cover]
face = "top"
flange = {{ width = "{FLANGE} mm", thickness = "{RIM} mm" }}
"""


def _written(path: Path) -> None:
    """The solid as a STEP file, with the cover as a second one that touches it; what bolts clamp are faces."""
    with gmsh_session("housing") as gmsh:
        occ = gmsh.model.occ

        def block(low: tuple[float, float, float], high: tuple[float, float, float]) -> tuple[int, int]:
            return 3, occ.addBox(*low, *(b - a for a, b in zip(low, high, strict=True)))

        top, half_x, half_z = Y - PLATE, X / 2, Z / 2
        wide_x, wide_z = half_x + FLANGE, half_z + FLANGE
        body = block((-half_x, 0, -half_z), (half_x, top, half_z))
        more = [block((-wide_x, top - RIM, -wide_z), (wide_x, top, wide_z))]
        for x in (-half_x, half_x - FOOT[0]):
            for z in (-half_z, half_z - FOOT[2]):
                more.append(block((x, -FOOT[1], z), (x + FOOT[0], 0, z + FOOT[2])))
        more.append(block((-half_x - 14, 0, 0), (-half_x, 80, 10)))
        for start in (half_z, -half_z - STANDS):
            more.append((3, occ.addCylinder(10, 50, start, 0, 0, STANDS, BOSS / 2)))
        body, *_ = occ.fuse([body], more)[0]

        cavity = block((WALL - half_x, WALL, WALL - half_z), (half_x - WALL, top + 5, half_z - WALL))
        occ.synchronize()
        edges = {abs(tag) for _, tag in gmsh.model.getBoundary(gmsh.model.getBoundary([cavity]), combined=False)}
        inside = [edge for edge in edges if gmsh.model.occ.getCenterOfMass(1, edge)[1] < top]
        rounded = occ.fillet([cavity[1]], inside, [FILLET])
        bores = [(3, occ.addCylinder(10, 50, end * (half_z - WALL - 3), 0, 0, end * 30, BORE / 2)) for end in (1, -1)]
        body, *_ = occ.cut([body], [*rounded, *bores])[0]
        rib = block((-half_x + 6, 6, -13), (half_x - 6, WALL + 16, -3))
        body, *_ = occ.fuse([body], [rib])[0]
        cover = block((-wide_x, top, -wide_z), (wide_x, Y, wide_z))
        for solid in (body, cover):
            disks = [(2, occ.addDisk(x, top, z, BOLT, BOLT, zAxis=[0, 1, 0])) for x, z in BOLTS]
            occ.fragment([solid], disks)
        occ.synchronize()
        assert len(gmsh.model.getEntities(3)) == 2
        gmsh.write(str(path))


def _case(folder: Path, geometry: str, *, boss: str = "", more: str = "") -> str:
    (folder / "case.toml").write_text(HEAD + geometry + SEATS.format(boss=boss) + FEET + more)
    return str(folder / "case.toml")


def _modes(gearwhine: Any, case: str) -> Any:
    """The document of ``gearwhine modes``."""
    outcome = gearwhine("modes", case, "--json", "-q")
    assert outcome.code == 0, outcome.err
    assert outcome.document["certificate"]["complete"]
    return outcome.document


FEET = f"""
[[housing.support]]
name = "feet"
plane = {{ axis = "y", at = "{-FOOT[1]} mm" }}
fixed = ["x", "y", "z"]
"""
WITH_BOSS = f'boss = {{ diameter = "{BOSS} mm", length = "{STANDS} mm" }}'


@pytest.mark.slow
def test_a_step_file_of_two_parts_on_bolts_has_the_modes_of_the_same_box(gearwhine: Any, tmp_path: Path) -> None:
    """Parts that touch are left apart; circles that bolts clamp are found by place and tied by the box's springs."""
    _written(tmp_path / "bolted.step")
    positions = ", ".join(f'["{x} mm", "{z} mm"]' for x, z in BOLTS)
    bolted = f'{BOX}bolts = {{ diameter = "{BOLT} mm", positions = [{positions}] }}\n'
    case = _case(tmp_path, bolted, boss=WITH_BOSS)
    box = _modes(gearwhine, case)
    bolts = gearwhine("check", case, "--json", "-q").document["housing"]["cover_bolts"]
    assert len(bolts) == len(BOLTS)

    joints = ""
    for bolt in bolts:
        springs = bolt["stiffness_n_per_m"] | bolt["stiffness_n_m_per_rad"]
        joints += f'[[housing.joint]]\nname = "{bolt["name"]}"\naxis = "y"\ndiameter = "{2 * BOLT} mm"\n'
        joints += f"center = {bolt['position_m']}\n"
        joints += "stiffness = {" + ", ".join(f"{key} = {value}" for key, value in springs.items()) + "}\n"
    cad = f'[housing.cad]\nfile = "bolted.step"\nmesh_size = "{MESH} mm"\nglue = false\n'
    step = _modes(gearwhine, _case(tmp_path, cad, more=joints))
    assert step["mass_kg"] == pytest.approx(box["mass_kg"], rel=2e-3)
    hertz, expected = ([mode["frequency_hz"] for mode in document["modes"]] for document in (step, box))
    np.testing.assert_allclose(hertz, expected, rtol=0.005)
