"""Draw the housing of the bundled case ``two-stage-reducer`` and write it as STEP.

    python scripts/make_two_stage_reducer.py [FILE]

A cast housing of a two-stage helical reducer, split in the plane of its three shafts: a lower and an upper housing and
the cover of an inspection opening. They are three solids that touch, because they are three parts: a case may give each
its own material, and tie them by joints instead of by common nodes (``glue = false``). Bolts of the split and their
holes, bearing caps, plugs and seals are left out: a tightened joint is taken for one piece.

Lengths are in mm. The frame is the machine's: z along the shafts, y up, the feet's undersides at y = 0, the middle of
the casting at x = z = 0. The same dimensions give the same file, byte for byte.
"""

import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearwhine.meshes.gmsh_meshing import gmsh_session

TARGET = Path(__file__).parents[1] / "gearwhine" / "cases" / "two-stage-reducer.step"
SOLIDS = ("lower housing", "upper housing", "inspection cover")
Entity = tuple[int, int]


@dataclass(frozen=True)
class Shaft:
    """A shaft's place, the bore of its bearings, and the boss around it [mm]."""

    x: float
    bore: float
    boss: float


@dataclass(frozen=True)
class Reducer:
    """Dimensions of the casting [mm]; x, y and z are half lengths where the casting is symmetric."""

    shafts: tuple[Shaft, ...] = (Shaft(-174.0, 72.0, 106.0), Shaft(-74.0, 80.0, 116.0), Shaft(86.0, 110.0, 150.0))
    shaft_height: float = 180.0
    x: float = 240.0
    z: float = 83.0
    wall: float = 11.0
    end_wall: float = 10.0
    floor: tuple[float, float] = (14.0, 26.0)
    # The roof's upper side: level from its right end to x = 0, from there sloping down to the left end.
    roof: float = 336.0
    roof_left: float = 272.0
    corners: tuple[float, float, float] = (30.0, 80.0, 40.0)  # radii: at the floor, at the roof's right and left end
    rounding: float = 12.0  # of the outer edges; the inner ones have what keeps the wall even, at least 6
    boss_face: float = 124.0  # z of the bosses' machined faces
    flange: tuple[float, float, float, float] = (26.0, 23.0, 18.0, 16.0)  # beyond end and side walls; below, above
    columns: tuple[float, ...] = (-228.0, -2.0, 166.0)  # x of the bolt columns beside the bores
    column: tuple[float, float, float, float] = (92.0, 22.0, 58.0, 52.0)  # z, radius, height below and above the split
    rib: tuple[float, float] = (10.0, 100.0)  # thickness, and z to which the ribs stand out
    foot: tuple[float, float, float, float, float] = (160.0, 256.0, 60.0, 146.0, 28.0)  # x and z from, to; height
    bolt: tuple[float, float, float, float] = (224.0, 118.0, 18.0, 40.0)  # x, z, hole and clamped circle of a foot
    opening: tuple[float, float, float, float] = (118.0, 55.0, 38.0, 20.0)  # place down the slope; halves; rim's width
    rim: float = 10.0  # height of the opening's rim above the roof
    plate: float = 8.0  # thickness of its cover
    lug: tuple[float, float, float] = (26.0, 11.0, 18.0)  # radius, its hole's, thickness
    drain: tuple[float, float, float] = (46.0, 18.0, 12.0)  # height, radius and length of the drain plug's boss

    @property
    def slope(self) -> float:
        """Angle of the sloping part of the roof against the horizontal [rad]."""
        return float(np.arctan2(self.roof - self.roof_left, self.x))


class Drawing:
    """Solids in gmsh's kernel of CAD."""

    def __init__(self, gmsh: Any) -> None:
        self.gmsh, self.occ = gmsh, gmsh.model.occ

    def block(self, low: Sequence[float], high: Sequence[float]) -> Entity:
        """A block between two corners, given in any order."""
        a, b = np.minimum(low, high), np.maximum(low, high)
        return 3, self.occ.addBox(*a, *(b - a))

    def rod(self, foot: Sequence[float], axis: Sequence[float], radius: float) -> Entity:
        return 3, self.occ.addCylinder(*foot, *axis, radius)

    def prism(self, points: Sequence[Sequence[float]], along: Sequence[float]) -> Entity:
        """A plane polygon drawn out along a vector."""
        tags = [self.occ.addPoint(*point) for point in points]
        lines = [self.occ.addLine(a, b) for a, b in zip(tags, tags[1:] + tags[:1], strict=True)]
        face = self.occ.addPlaneSurface([self.occ.addCurveLoop(lines)])
        return next(e for e in self.occ.extrude([(2, face)], *along) if e[0] == 3)

    def rounded(self, solid: Entity, radius: Callable[[Any, Any], float]) -> Entity:
        """A solid with rounded edges: the radius of each by the corners of its bounds; 0 leaves it sharp."""
        self.occ.synchronize()
        edges, radii = [], []
        faces = self.gmsh.model.getBoundary([solid], oriented=False)
        for edge in sorted({tag for _, tag in self.gmsh.model.getBoundary(faces, combined=False, oriented=False)}):
            bounds = np.array(self.occ.getBoundingBox(1, edge))
            size = radius(bounds[:3], bounds[3:])
            if size > 0.0:
                edges.append(edge)
                radii.append(size)
        ((dimension, tag),) = self.occ.fillet([solid[1]], edges, radii)
        return dimension, tag

    def fuse(self, parts: Sequence[Entity]) -> list[Entity]:
        return list(self.occ.fuse([parts[0]], list(parts[1:]))[0])


def draw(gmsh: Any, sizes: Reducer) -> list[Entity]:
    """Draw the three solids, in the order of their names."""
    d, s = Drawing(gmsh), sizes
    parts = [_hollow(d, s, 0.0), *_split_flange(d, s), *_bosses(d, s), *_ribs(d, s), *_feet(d, s), *_roof(d, s)]
    body = d.fuse(parts)
    cavity = _hollow(d, s, s.wall)
    cuts = [cavity, *_holes(d, s)]
    body = list(d.occ.cut(body, cuts)[0])
    far = 2.0 * (s.x + s.z + s.roof)
    below = d.block((-far, -far, -far), (far, s.shaft_height, far))
    lower = d.occ.intersect(body, [below], removeObject=False, removeTool=False)[0]
    upper = d.occ.cut(body, [below])[0]
    lower = [part for part in d.occ.fragment(lower, _clamped(d, s))[0] if part[0] == 3]
    return [*lower, *upper, *_cover(d, s)]


def _hollow(d: Drawing, s: Reducer, depth: float) -> Entity:
    """The casting's plain outside, or with the walls' depth its cavity: a rounded prism along z."""
    floor = s.floor[1] if depth else s.floor[0]
    end = s.x - (s.end_wall if depth else 0.0)
    half = s.z - depth
    fall = depth / np.cos(s.slope) if depth else 0.0
    left = s.roof - fall - end * np.tan(s.slope)
    profile = [(-end, floor, -half), (end, floor, -half), (end, s.roof - depth, -half)]
    # The roof's inner bend lies on the bisector of the outer one.
    bend = depth * np.tan(0.5 * s.slope)
    profile += [(bend, s.roof - depth, -half), (-end, left, -half)]
    solid = d.prism(profile, (0.0, 0.0, 2.0 * half))
    radii = dict(zip(((-1, 0), (1, 0), (1, 1), (-1, 1)), (s.corners[0], s.corners[0], *s.corners[1:]), strict=True))

    def along_z(low: Any, high: Any) -> float:
        if high[2] - low[2] < half or abs(low[0]) < 0.5 * s.x:
            return 0.0
        return radii[int(np.sign(low[0])), int(low[1] > s.shaft_height)] - depth

    solid = d.rounded(solid, along_z)
    rim = max(s.rounding - depth, 6.0)
    return d.rounded(solid, lambda low, high: rim if high[2] - low[2] < half else 0.0)


def _split_flange(d: Drawing, s: Reducer) -> list[Entity]:
    """Flanges of both halves with rounded corners, and the columns for the bolts beside the bores."""
    end, side, below, above = s.flange
    x, z, y = s.x + end, s.z + side, s.shaft_height
    plate = d.block((-x, y - below, -z), (x, y + above, z))
    plate = d.rounded(
        plate,
        lambda low, high: (
            30.0
            if high[1] - low[1] > 0.5 * (below + above) and high[0] - low[0] < 1.0 and high[2] - low[2] < 1.0
            else 0.0
        ),
    )
    at, radius, down, up = s.column
    columns = [d.rod((x, y - down, sign * at), (0.0, down + up, 0.0), radius) for x in s.columns for sign in (1, -1)]
    return [plate, *columns]


def _bosses(d: Drawing, s: Reducer) -> list[Entity]:
    face = s.boss_face
    bosses = [d.rod((one.x, s.shaft_height, -face), (0.0, 0.0, 2.0 * face), 0.5 * one.boss) for one in s.shafts]
    height, radius, length = s.drain
    return [*bosses, d.rod((s.x - 5.0, height, 0.0), (length + 5.0, 0.0, 0.0), radius)]


def _ribs(d: Drawing, s: Reducer) -> list[Entity]:
    """Ribs under the bosses down to the floor's rail, and tapered ones above them."""
    half, out = 0.5 * s.rib[0], s.rib[1]
    inside, ribs = s.z - 0.5 * s.wall, []
    for shaft in s.shafts:
        top = _roof_at(s, shaft.x) - 2.2 * s.rounding
        for sign in (1, -1):
            low, high = (shaft.x - half, s.floor[0], sign * inside), (shaft.x + half, s.shaft_height, sign * out)
            ribs.append(d.block(low, high))
            outline = [(s.shaft_height, inside), (s.shaft_height, out), (top, s.z + 3.0), (top, inside)]
            points = [(shaft.x - half, y, sign * z) for y, z in outline]
            ribs.append(d.prism(points, (2.0 * half, 0.0, 0.0)))
    for sign in (1, -1):  # of the end walls
        outline = [(s.floor[0] + 30.0, 0.5 * s.wall), (s.shaft_height, 0.5 * s.wall), (s.shaft_height, -18.0)]
        ribs.append(d.prism([(sign * (s.x - x), y, -half) for y, x in outline], (0.0, 0.0, 2.0 * half)))
    return ribs


def _roof_at(s: Reducer, x: float) -> float:
    return s.roof + min(x, 0.0) * float(np.tan(s.slope))


def _feet(d: Drawing, s: Reducer) -> list[Entity]:
    """Four feet with gussets, and the rails between them along the side walls."""
    begin, end, inner, outer, height = s.foot
    half, parts = 0.5 * s.rib[0], []
    for x in (1, -1):
        for z in (1, -1):
            foot = d.block((x * begin, 0.0, z * inner), (x * end, height, z * outer))

            def upright(low: Any, high: Any) -> float:
                return 16.0 if high[1] - low[1] > 0.5 * height and abs(low[2]) + abs(high[2]) > 2 * s.z else 0.0

            parts.append(d.rounded(foot, upright))
            outline = [
                (height - 4.0, s.z - 5.0),
                (height - 4.0, outer - 8.0),
                (height + 4.0, outer - 8.0),
                (height + 62.0, s.z + 2.0),
                (height + 62.0, s.z - 5.0),
            ]
            at = x * (begin + 16.0)
            parts.append(d.prism([(at - half, y, z * out) for y, out in outline], (2.0 * half, 0.0, 0.0)))
    side = s.z + s.flange[1]
    parts += [d.block((-begin - 10, s.floor[0], z * inner), (begin + 10, height, z * side)) for z in (1, -1)]
    return parts


def _on_slope(d: Drawing, s: Reducer, solid: Entity) -> Entity:
    """Move a solid that is drawn about the origin, its y the normal, to the opening on the sloping roof."""
    down = s.opening[0]
    d.occ.rotate([solid], 0, 0, 0, 0, 0, 1, s.slope)
    d.occ.translate([solid], -down * np.cos(s.slope), s.roof - down * np.sin(s.slope), 0.0)
    return solid


def _slab(d: Drawing, s: Reducer, x: float, z: float, low: float, high: float, radius: float) -> Entity:
    """A slab with rounded corners on the sloping roof, between two heights above it."""
    slab = d.block((-x, low, -z), (x, high, z))
    corner = lambda a, b: radius if max(b[0] - a[0], b[2] - a[2]) < 1.0 else 0.0  # noqa: E731
    return _on_slope(d, s, d.rounded(slab, corner))


def _roof(d: Drawing, s: Reducer) -> list[Entity]:
    """Rim of the inspection opening, and a lug to lift by at each end."""
    _, x, z, width = s.opening
    rim = _slab(d, s, x + width, z + width, -4.0, s.rim, 14.0)
    lugs = []
    for (at, height), foot in zip(_lugs(s), (s.roof_left - 32.0, s.roof - 46.0), strict=True):
        radius, _, thick = s.lug
        lugs.append(d.rod((at, height, -0.5 * thick), (0.0, 0.0, thick), radius))
        lugs.append(d.block((at - radius, foot, -0.5 * thick), (at + radius, height, 0.5 * thick)))
    return [rim, *lugs]


def _lugs(s: Reducer) -> tuple[tuple[float, float], tuple[float, float]]:
    """Centres of the lugs' holes, left and right."""
    return (-s.x + 18.0, s.roof_left + 20.0), (s.x - 10.7, s.roof - 10.7)


def _holes(d: Drawing, s: Reducer) -> list[Entity]:
    """Bores of the bearings, holes of the foot bolts and the lugs, and the inspection opening."""
    far = 2.0 * s.boss_face
    holes = [d.rod((one.x, s.shaft_height, -far), (0.0, 0.0, 2.0 * far), 0.5 * one.bore) for one in s.shafts]
    x, z, bolt, _ = s.bolt
    holes += [d.rod((i * x, -5.0, k * z), (0.0, 2.0 * s.foot[-1], 0.0), 0.5 * bolt) for i in (1, -1) for k in (1, -1)]
    holes += [d.rod((at, height, -far), (0.0, 0.0, 2.0 * far), s.lug[1]) for at, height in _lugs(s)]
    return [*holes, _slab(d, s, s.opening[1], s.opening[2], -2.0 * s.wall, 2.0 * s.rim, 10.0)]


def _clamped(d: Drawing, s: Reducer) -> list[Entity]:
    """Rings under the feet that their bolts clamp, which become faces of their own."""
    x, z, hole, ring = s.bolt
    rings = []
    for i in (1, -1):
        for k in (1, -1):
            whole, gap = (
                (2, d.occ.addDisk(i * x, 0.0, k * z, r, r, zAxis=[0, 1, 0])) for r in (0.5 * ring, 0.5 * hole)
            )
            rings += d.occ.cut([whole], [gap])[0]
    return rings


def _cover(d: Drawing, s: Reducer) -> list[Entity]:
    _, x, z, width = s.opening
    inset = 0.3 * width
    return [_slab(d, s, x + width - inset, z + width - inset, s.rim, s.rim + s.plate, 10.0)]


_ENTITY = re.compile(r"#(\d+) = (.*?);\n", re.DOTALL)
_GEOMETRY = ("CARTESIAN_POINT", "DIRECTION", "VECTOR", "AXIS2_PLACEMENT_3D", "LINE", "CIRCLE", "PLANE")


def compact(text: str, title: str = "two-stage-reducer") -> str:
    """Shorten a STEP file of OpenCASCADE's: no curves in surfaces' parameters, no entity twice, a neutral header.

    An edge keeps its curve in space alone, from which a reader finds those in the parameters of its two surfaces. Equal
    points, directions and curves are one entity, and points are rounded. The header has no date, so that the file
    depends on nothing but the dimensions.
    """
    head, data = text.split("DATA;\n", 1)
    entities = {int(number): " ".join(body.split()) for number, body in _ENTITY.findall(data)}
    same = {}
    for number, body in entities.items():
        curve = re.match(r"(?:SURFACE|SEAM)_CURVE\('',#(\d+),", body)
        if curve is not None:
            same[number] = int(curve[1])

    def refer(body: str, names: dict[int, int]) -> str:
        return re.sub(r"#(\d+)", lambda found: f"#{names.get(int(found[1]), int(found[1]))}", body)

    entities = {number: refer(body, same) for number, body in entities.items() if number not in same}
    entities = {n: _rounded(body) if body.startswith("CARTESIAN_POINT") else body for n, body in entities.items()}
    while True:
        first: dict[str, int] = {}
        twice: dict[int, int] = {}
        for number, body in entities.items():
            if body.startswith(_GEOMETRY) and first.setdefault(body, number) != number:
                twice[number] = first[body]
        if not twice:
            break
        entities = {number: refer(body, twice) for number, body in entities.items() if number not in twice}
    used = _reached(entities)
    names = {number: place for place, number in enumerate((n for n in entities if n in used), start=1)}
    lines = [f"#{names[number]}={refer(body, names)};" for number, body in entities.items() if number in used]
    name = f"FILE_NAME('{title}','',(''),(''),'','gearwhine','');"
    head = re.sub(r"FILE_NAME\(.*?\);", name, head, flags=re.DOTALL)
    return head + "DATA;\n" + "\n".join(lines) + "\nENDSEC;\nEND-ISO-10303-21;\n"


def _rounded(body: str) -> str:
    """Round a point's coordinates to 0.01 nm, far below the 0.1 nm within which the kernel takes points for one."""
    return re.sub(r"-?\d+\.\d*(?:E[-+]?\d+)?", lambda found: f"{round(float(found[0]), 8) + 0.0:.8f}".rstrip("0"), body)


def _reached(entities: dict[int, str]) -> set[int]:
    """Entities that the shapes and the products need."""
    roots = ("SHAPE_DEFINITION_REPRESENTATION", "PRODUCT_RELATED_PRODUCT_CATEGORY", "CONTEXT_DEPENDENT_SHAPE")
    roots += ("APPLICATION_PROTOCOL_DEFINITION",)
    waiting = [number for number, body in entities.items() if body.startswith(roots)]
    used = set(waiting)
    while waiting:
        for found in re.findall(r"#(\d+)", entities[waiting.pop()]):
            if int(found) not in used:
                used.add(int(found))
                waiting.append(int(found))
    return used


def with_names(text: str, names: Sequence[str]) -> str:
    """Name the products, the first of which is the assembly of the others."""
    for number, name in enumerate(names):
        # The kernel counts the files that a process writes, and the parts of each.
        given = r"Open CASCADE STEP translator [\d.]+ \d+" + (rf"\.{number}" if number else "")
        text, count = re.subn(rf"PRODUCT\('{given}',\s*'{given}'", f"PRODUCT('{name}','{name}'", text)
        if count != 1:
            raise RuntimeError(f"{count} products of the STEP file are the {name}; expected one")
    return text


def write(path: Path, sizes: Reducer = Reducer()) -> None:
    """Write the casting as a STEP file."""
    with gmsh_session("two-stage-reducer") as gmsh:
        solids = draw(gmsh, sizes)
        gmsh.model.occ.synchronize()
        if len(solids) != len(SOLIDS) or set(gmsh.model.getEntities(3)) != set(solids):
            raise RuntimeError(f"the drawing has the solids {gmsh.model.getEntities(3)}; expected {len(SOLIDS)}")
        gmsh.write(str(path))
        names = [SOLIDS[solids.index(solid)] for solid in sorted(solids)]  # the kernel writes them by their tags
    text = path.read_text(encoding="ascii")
    path.write_text(compact(with_names(text, ("two-stage reducer", *names))), encoding="ascii")


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else TARGET)
