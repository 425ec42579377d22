"""Draw the housing of the bundled planetary cases and write it as STEP.

    python scripts/make_planetary_stage.py [FILE]

A housing of one planetary stage: a tube whose bore holds the ring gear, an end wall at either side with a neck for two
bearings, of the sun's shaft at the back and of the carrier in front, four ribs along the tube and feet below. Bolts,
seals and the split between tube and walls are left out: tightened joints are taken for one piece.

Lengths are in mm. The frame is the machine's: z along the shafts from the sun's side to the carrier's, y up, the feet's
undersides at y = 0, the middle of the ring at z = 0. The same dimensions give the same file, byte for byte.
"""

import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from make_two_stage_reducer import Drawing, Entity, compact, with_names

from gearwhine.meshes.gmsh_meshing import gmsh_session

TARGET = Path(__file__).parents[1] / "gearwhine" / "cases" / "planetary-stage.step"


@dataclass(frozen=True)
class Neck:
    """A neck on an end wall: bore of its bearings, outer diameter, and length from the wall [mm]."""

    bore: float
    outer: float
    length: float


@dataclass(frozen=True)
class Stage:
    """Dimensions of the housing [mm]."""

    height: float = 150.0  # of the axis above the feet
    ring_bore: float = 206.0
    ring_length: float = 36.0
    outer: float = 232.0  # diameter of the tube
    inner: float = 214.0  # and of its inside beside the ring
    half: float = 62.0  # half the length over the end walls
    wall: float = 12.0
    back: Neck = Neck(62.0, 88.0, 58.0)
    front: Neck = Neck(110.0, 140.0, 78.0)
    rib: tuple[float, float] = (10.0, 14.0)  # thickness, height above the tube
    foot: tuple[float, float, float] = (90.0, 60.0, 20.0)  # x from the middle to its outer end, width in z, height
    web: float = 16.0  # thickness of the feet's uprights


def draw(gmsh: Any, s: Stage) -> list[Entity]:
    """Draw the housing in one piece."""
    d = Drawing(gmsh)

    def rod(z: float, length: float, diameter: float) -> Entity:
        return d.rod((0.0, s.height, z), (0.0, 0.0, length), 0.5 * diameter)

    parts = [rod(-s.half, 2.0 * s.half, s.outer)]
    parts.append(rod(-s.half - s.back.length, s.back.length + s.wall, s.back.outer))
    parts.append(rod(s.half - s.wall, s.front.length + s.wall, s.front.outer))
    thick, high = s.rib
    reach = 0.5 * s.outer + high
    for angle in (45.0, 135.0):
        a = math.radians(angle)
        across, along = (math.cos(a), math.sin(a)), (-math.sin(a), math.cos(a))
        ends = [(i * reach, 0.5 * k * thick) for i, k in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
        corners = [tuple(i * u + k * v for u, v in zip(across, along, strict=True)) for i, k in ends]
        parts.append(d.prism([(x, s.height + y, -s.half) for x, y in corners], (0.0, 0.0, 2.0 * s.half)))
    out, wide, foot = s.foot
    for side in (-1.0, 1.0):
        for z in (-1.0, 1.0):
            middle = z * (s.half - 0.5 * wide)
            ends = (out + 40.0, out - 50.0)
            low, high = (
                (side * x, y, middle + 0.5 * k * wide) for x, y, k in zip(ends, (0.0, foot), (-1, 1), strict=True)
            )
            parts.append(d.block(low, high))
        parts.append(d.block((side * out, 0.0, -s.half), (side * (out - s.web), s.height, s.half)))
    body = d.fuse(parts)
    cuts = [
        rod(-s.half + s.wall, 2.0 * (s.half - s.wall), s.inner),
        rod(-2.0 * s.half - s.back.length, 2.0 * s.half + s.back.length, s.back.bore),
        rod(0.0, 2.0 * s.half + s.front.length, s.front.bore),
    ]
    body = list(d.occ.cut(body, cuts)[0])
    # The land of the ring stands in from the tube.
    around, within = rod(-0.5 * s.ring_length, s.ring_length, s.inner + 2.0), rod(-s.half, 2.0 * s.half, s.ring_bore)
    land = d.occ.cut([around], [within])
    return list(d.fuse([*body, *land[0]]))


def write(path: Path, sizes: Stage = Stage()) -> None:
    """Write the housing as a STEP file."""
    with gmsh_session("planetary-stage") as gmsh:
        solids = draw(gmsh, sizes)
        gmsh.model.occ.synchronize()
        if len(solids) != 1 or set(gmsh.model.getEntities(3)) != set(solids):
            raise RuntimeError(f"the drawing has the solids {gmsh.model.getEntities(3)}; expected one")
        gmsh.write(str(path))
    text = with_names(path.read_text(encoding="ascii"), ("planetary stage",))
    path.write_text(compact(text, "planetary-stage"), encoding="ascii")


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else TARGET)
