"""Draw the housing of the bundled case ``planetary-helical`` and write it as STEP.

    python scripts/make_planetary_helical.py [FILE]

A housing of a planetary stage with a helical stage behind it: the tube around the ring gear with the neck of the sun's
bearings, as of the single stage in ``make_planetary_stage.py``, and in front of it a box with the helical pair. Two
walls of the box hold the bearings of the carrier, whose shaft is the pinion's too, and of the output shaft beside it.
Bolts, seals, openings and the splits between tube, box and its front wall are left out: tightened joints are taken for
one piece.

Lengths are in mm. The frame is the machine's: z along the shafts from the sun's side to the output's, y up, the feet's
undersides at y = 0, the middle of the ring at z = 0. The same dimensions give the same file, byte for byte.
"""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from make_two_stage_reducer import Drawing, Entity, compact, with_names

from gearwhine.meshes.gmsh_meshing import gmsh_session

TARGET = Path(__file__).parents[1] / "gearwhine" / "cases" / "planetary-helical.step"


@dataclass(frozen=True)
class Boss:
    """A bearing's boss in a wall of the box: place, bore and outer diameter, from and to along z [mm]."""

    x: float
    bore: float
    outer: float
    z: tuple[float, float]


@dataclass(frozen=True)
class Unit:
    """Dimensions of the housing [mm]."""

    height: float = 150.0  # of both axes above the feet
    distance: float = 140.0  # between them
    ring_bore: float = 206.0
    ring_length: float = 36.0
    outer: float = 232.0  # diameter of the tube
    inner: float = 214.0  # and of its inside beside the ring
    back: float = -62.0  # z of the tube's end wall
    wall: float = 12.0
    neck: Boss = Boss(0.0, 62.0, 88.0, (-120.0, -50.0))  # of the sun's bearings, through the end wall
    box: tuple[tuple[float, float, float], tuple[float, float, float]] = ((-124.0, 14.0, 50.0), (270.0, 280.0, 152.0))
    bosses: tuple[Boss, ...] = (
        Boss(0.0, 110.0, 134.0, (50.0, 74.0)),
        Boss(0.0, 90.0, 116.0, (128.0, 164.0)),
        Boss(140.0, 100.0, 124.0, (50.0, 74.0)),
        Boss(140.0, 100.0, 124.0, (128.0, 164.0)),
    )
    rib: tuple[float, float] = (12.0, 90.0)  # thickness of the ribs between tube and box, their reach along the tube
    foot: tuple[float, float] = (20.0, 60.0)  # height, length along z
    tube_feet: tuple[float, float] = (60.0, 130.0)  # x from, to, on either side
    box_feet: tuple[tuple[float, float], ...] = ((-164.0, -90.0), (230.0, 310.0))  # x from, to
    web: float = 16.0  # thickness of the uprights below the tube


def draw(gmsh: Any, s: Unit) -> list[Entity]:
    """Draw the housing in one piece."""
    d = Drawing(gmsh)

    def rod(x: float, begin: float, end: float, diameter: float) -> Entity:
        return d.rod((x, s.height, begin), (0.0, 0.0, end - begin), 0.5 * diameter)

    low, high = s.box
    joint, wall = low[2], s.wall
    parts = [rod(0.0, s.back, joint + wall, s.outer), rod(s.neck.x, *s.neck.z, s.neck.outer)]
    parts.append(d.block(low, high))
    parts += _feet(d, s)
    thick, reach = s.rib
    for side in (-1.0, 1.0):
        at = side * (0.5 * s.outer - 0.5 * wall)
        outline = [(at, joint), (at, joint - reach), (side * (0.5 * s.outer + 4.0), joint)]
        points = [(x, s.height - 0.5 * thick, z) for x, z in outline]
        parts.append(d.prism(points, (0.0, thick, 0.0)))
    body = d.fuse(parts)
    inside = [rod(0.0, s.back + wall, joint, s.inner)]
    inside.append(d.block([a + wall for a in low], [a - wall for a in high]))
    body = list(d.occ.cut(body, inside)[0])
    body = d.fuse([*body, *(rod(boss.x, *boss.z, boss.outer) for boss in s.bosses)])
    bores = [rod(boss.x, boss.z[0], boss.z[1] + 1.0, boss.bore) for boss in s.bosses]
    bores.append(rod(s.neck.x, s.neck.z[0] - 1.0, s.neck.z[1] + 1.0, s.neck.bore))
    body = list(d.occ.cut(body, bores)[0])
    # The land of the ring stands in from the tube.
    half = 0.5 * s.ring_length
    land = d.occ.cut([rod(0.0, -half, half, s.inner + 2.0)], [rod(0.0, -half - 1.0, half + 1.0, s.ring_bore)])
    return list(d.fuse([*body, *land[0]]))


def _feet(d: Drawing, s: Unit) -> list[Entity]:
    """Feet below the tube, with uprights to its axis, and below the box."""
    high, long = s.foot
    near, far = s.tube_feet
    parts = []
    for side in (-1.0, 1.0):
        parts.append(d.block((side * near, 0.0, s.back), (side * far, high, s.back + long)))
        upright = 0.5 * (near + far)
        ends = (side * (upright - 0.5 * s.web), side * (upright + 0.5 * s.web))
        parts.append(d.block((ends[0], 0.0, s.back), (ends[1], s.height, s.box[0][2] + s.wall)))
    front = s.box[1][2]
    parts += [d.block((begin, 0.0, front - long), (end, high, front)) for begin, end in s.box_feet]
    return parts


def write(path: Path, sizes: Unit = Unit()) -> None:
    """Write the housing as a STEP file."""
    with gmsh_session("planetary-helical") as gmsh:
        solids = draw(gmsh, sizes)
        gmsh.model.occ.synchronize()
        if len(solids) != 1 or set(gmsh.model.getEntities(3)) != set(solids):
            raise RuntimeError(f"the drawing has the solids {gmsh.model.getEntities(3)}; expected one")
        gmsh.write(str(path))
    text = with_names(path.read_text(encoding="ascii"), ("planetary and helical stage",))
    path.write_text(compact(text, "planetary-helical"), encoding="ascii")


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else TARGET)
