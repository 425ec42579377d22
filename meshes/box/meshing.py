"""Meshing of a box housing with tetrahedra by gmsh: solid model, named surfaces, mesh.

The solid model is made in gmsh's OpenCASCADE kernel: a body, and a cover where it is a separate plate. Named surfaces
are the faces of the finished solid, found by their places.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearwhine.meshes.box import layout
from gearwhine.meshes.box.geometry import BoxGeometry
from gearwhine.meshes.box.layout import Block
from gearwhine.meshes.box.parts import FACES, Cover
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.gmsh_meshing import check_mesh_request, check_mesh_size, collect, gmsh_session, mesh_solids
from gearwhine.meshes.mesh import Mesh
from gearwhine.numerics.arrays import FloatArray

Entities = list[tuple[int, int]]


@dataclass(frozen=True)
class BoxSolid:
    """Numbers of the finished solids in the gmsh model: the body, and the cover if there is one."""

    body: tuple[int, ...]
    cover: tuple[int, ...] = ()


def build_solid(gmsh: Any, box: BoxGeometry) -> BoxSolid:
    """Build the shape in the current gmsh model.

    Raises
    ------
    GeometryError
        Where it falls into several parts.
    """
    body = _body(gmsh, box)
    plate: Entities = [] if box.cover is None else _plate(gmsh, box, box.cover)
    if len(body) != 1 or len(plate) > 1:
        raise GeometryError("the box falls into several parts; its walls, bores and feet must hang together")
    if box.feet is not None and box.feet.bolt_patch is not None:
        circles = [
            _disk(gmsh, ((foot.low[0] + foot.high[0]) / 2, foot.low[1], (foot.low[2] + foot.high[2]) / 2), 1, radius)
            for radius in (box.feet.bolt_patch / 2,)
            for foot in layout.foot_blocks(box)
        ]
        body = _imprinted(gmsh, body, circles)
    if box.cover is not None and box.cover.bonded:
        _, (below, above) = gmsh.model.occ.fragment(body, plate)
        body, plate = below, above
    elif box.cover is not None:
        # Each part takes the circles by itself, so that the two share no face and hence no node.
        body = _imprinted(gmsh, body, _bolt_circles(gmsh, box, box.cover))
        plate = _imprinted(gmsh, plate, _bolt_circles(gmsh, box, box.cover))
    gmsh.model.occ.synchronize()
    return BoxSolid(tuple(tag for _, tag in body), tuple(tag for _, tag in plate))


def _body(gmsh: Any, box: BoxGeometry) -> Entities:
    """Walls, feet, bosses and ribs, without the cover, less the cavity and the bores."""
    occ = gmsh.model.occ
    sharp_face = None if box.cover is None else box.cover.face
    body = [_rounded(gmsh, layout.body_block(box), box.fillets.outside, sharp_face)]
    additions = []
    for foot in layout.foot_blocks(box):
        # Under rounded edges a foot reaches up beside the rounding, or it would hang on half of its top.
        raised = foot.high[1] + 1.5 * box.fillets.outside
        additions.append(_block(gmsh, foot.replaced(1, high=raised)))
    for bore in box.bores:
        if bore.boss is not None and (box.cover is None or box.end_wall(bore) != box.cover.face):
            additions.append(_cylinder(gmsh, box, bore.center, bore.boss.diameter, box.bore_span(bore)))
    for rib in box.ribs:
        if rib.side == "outside" and not layout.on_cover(box, rib):
            additions.append(_block(gmsh, layout.sunk_rib_block(box, rib)))
    if box.cover is not None and box.cover.flange is not None and box.cover.flange.side == "outside":
        flange = layout.flange_block(box, box.cover)
        assert flange is not None
        additions.append(_rounded(gmsh, flange, box.fillets.outside, box.cover.face, sides_only=True))
    if additions:
        body, _ = occ.fuse(body, additions)
    body, _ = occ.cut(body, _cavity(gmsh, box) + _bores(gmsh, box))
    return list(body)


def _cavity(gmsh: Any, box: BoxGeometry) -> Entities:
    """Make the cavity less the parts inside it; below a cover it is open, and reaches beyond the joint."""
    block = layout.cavity_block(box)
    cover = box.cover
    if cover is not None:
        normal, way = FACES[cover.face]
        beyond = box.wall.of(cover.face)
        end = (block.high if way > 0 else block.low)[normal] + way * beyond
        block = block.replaced(normal, high=end) if way > 0 else block.replaced(normal, low=end)
    cavity = [_rounded(gmsh, block, box.fillets.inside, None if cover is None else cover.face)]
    standing = [
        _block(gmsh, layout.sunk_rib_block(box, rib))
        for rib in box.ribs
        if rib.side == "inside" and not layout.on_cover(box, rib)
    ]
    if cover is not None and cover.flange is not None and cover.flange.side == "inside":
        standing += _inside_flange(gmsh, box, cover)
    if standing:
        cavity, _ = gmsh.model.occ.cut(cavity, standing)
    return list(cavity)


def _inside_flange(gmsh: Any, box: BoxGeometry, cover: Cover) -> Entities:
    """Make the frame of an inside flange, its hole rounded as the cavity is."""
    layer = layout.flange_block(box, cover)
    assert layer is not None
    normal, way = FACES[cover.face]
    opening = layout.opening_block(box, cover)
    beyond = box.wall.of(cover.face)
    # The hole is longer than the frame is thick, and the frame reaches past the joint as the cavity does.
    low, high = layer.low[normal], layer.high[normal]
    frame = layer.replaced(normal, high=high + 2 * beyond) if way > 0 else layer.replaced(normal, low=low - 2 * beyond)
    hole = opening.replaced(normal, low=frame.low[normal] - beyond, high=frame.high[normal] + beyond)
    rounded = _rounded(gmsh, hole, box.fillets.inside, cover.face, sides_only=True)
    cut, _ = gmsh.model.occ.cut([_block(gmsh, frame)], [rounded])
    return list(cut)


def _plate(gmsh: Any, box: BoxGeometry, cover: Cover) -> Entities:
    """Make the cover with its bosses and ribs, less the bores."""
    occ = gmsh.model.occ
    plate = [_rounded(gmsh, layout.plate_block(box, cover), box.fillets.outside, cover.face, sides_only=True)]
    additions = [_block(gmsh, layout.sunk_rib_block(box, rib)) for rib in box.ribs if layout.on_cover(box, rib)]
    additions += [
        _cylinder(gmsh, box, bore.center, bore.boss.diameter, box.bore_span(bore))
        for bore in box.bores
        if bore.boss is not None and box.end_wall(bore) == cover.face
    ]
    if additions:
        plate, _ = occ.fuse(plate, additions)
    if any(box.end_wall(bore) == cover.face for bore in box.bores):
        plate, _ = occ.cut(plate, _bores(gmsh, box, cover))
    return list(plate)


def _bores(gmsh: Any, box: BoxGeometry, cover: Cover | None = None) -> Entities:
    """Make the cylinders that the bores cut out: all of them, or those in the cover."""
    cuts = []
    for bore in box.bores:
        if cover is None or box.end_wall(bore) == cover.face:
            start, end = box.bore_span(bore)
            margin = 0.1 * (end - start)
            cuts.append(_cylinder(gmsh, box, bore.center, bore.diameter, (start, end), margin))
    return cuts


def _cylinder(
    gmsh: Any,
    box: BoxGeometry,
    center: tuple[float, float, float],
    diameter: float,
    span: tuple[float, float],
    margin: float = 0.0,
) -> tuple[int, int]:
    (x, y, _), (start, end) = center, span
    length = end - start + 2 * margin
    return 3, gmsh.model.occ.addCylinder(x, y, start - margin, 0.0, 0.0, length, diameter / 2)


def _block(gmsh: Any, block: Block) -> tuple[int, int]:
    return 3, gmsh.model.occ.addBox(*block.low, *block.size)


def _rounded(
    gmsh: Any, block: Block, radius: float, sharp_face: str | None, *, sides_only: bool = False
) -> tuple[int, int]:
    """Make a block with rounded edges, except those around one face; or only those at right angles to that face."""
    entity = _block(gmsh, block)
    if radius == 0.0:
        return entity
    gmsh.model.occ.synchronize()
    chosen = []
    faces = gmsh.model.getBoundary([entity], oriented=False)
    for _, edge in sorted(set(gmsh.model.getBoundary(faces, combined=False, oriented=False))):
        bounds = gmsh.model.getBoundingBox(1, edge)
        middle = [(a + b) / 2 for a, b in zip(bounds[:3], bounds[3:], strict=True)]
        if sharp_face is not None:
            axis, way = next(place for face, place in FACES.items() if face == sharp_face)
            near, far = (block.high, block.low) if way > 0 else (block.low, block.high)
            slack = 1e-3 * block.size[axis]
            if abs(middle[axis] - near[axis]) < slack or (sides_only and abs(middle[axis] - far[axis]) < slack):
                continue
        chosen.append(edge)
    ((dimension, tag),) = gmsh.model.occ.fillet([entity[1]], chosen, [radius])
    return dimension, tag


def _disk(gmsh: Any, center: tuple[float, float, float], normal: int, radius: float) -> tuple[int, int]:
    axis = [float(direction == normal) for direction in range(3)]
    return 2, gmsh.model.occ.addDisk(*center, radius, radius, zAxis=axis)


def _bolt_circles(gmsh: Any, box: BoxGeometry, cover: Cover) -> Entities:
    normal, _ = FACES[cover.face]
    return [_disk(gmsh, bolt.position, normal, bolt.patch_diameter / 2) for bolt in layout.cover_bolts(box)]


def _imprinted(gmsh: Any, solid: Entities, circles: Entities) -> Entities:
    """Imprint circles on the surface of a solid as separate faces."""
    _, pieces = gmsh.model.occ.fragment(solid, circles)
    return [entity for entity in pieces[0] if entity[0] == 3]


Test = Callable[[str, FloatArray], bool]


def named_faces(gmsh: Any, box: BoxGeometry, solid: BoxSolid) -> dict[str, list[int]]:
    """Find the faces of the current gmsh model that make up each named surface.

    Raises
    ------
    GeometryError
        Where a surface has no face left.
    """
    named = _matching(gmsh, gmsh.model.getEntities(2), _outer_tests(box))
    if box.bolts:
        # The two circles of a bolt coincide: they are distinguished by the part that they bound.
        body = gmsh.model.getBoundary([(3, tag) for tag in solid.body], oriented=False)
        cover = gmsh.model.getBoundary([(3, tag) for tag in solid.cover], oriented=False)
        slack = _slack(box)
        circles = {
            bolt.name: _inside(_around(bolt.position, bolt.patch_diameter / 2, bolt.axis), slack, kind="Plane")
            for bolt in box.bolts
        }
        on_body, on_cover = _matching(gmsh, body, circles), _matching(gmsh, cover, circles)
        for bolt in box.bolts:
            named |= {bolt.cover_surface: on_cover[bolt.name], bolt.body_surface: on_body[bolt.name]}
    missing = [name for name, faces in named.items() if not faces]
    if missing:
        raise GeometryError(f"no face of the finished shape makes up {', '.join(missing)}: the parts cover it")
    return named


def _outer_tests(box: BoxGeometry) -> dict[str, Test]:
    """Make the tests for the surfaces that are found by their places alone."""
    outer, slack = layout.outer_block(box), _slack(box)
    tests: dict[str, Test] = {
        face: _on_plane(axis, (outer.high if way > 0 else outer.low)[axis], slack)
        for face, (axis, way) in FACES.items()
    }
    for number, foot in enumerate(layout.foot_blocks(box), start=1):
        underside = foot.replaced(1, high=foot.low[1])
        tests[f"foot-{number}"] = _inside(underside, slack, kind="Plane")
        if box.feet is not None and box.feet.bolt_patch is not None:
            middle = ((foot.low[0] + foot.high[0]) / 2, foot.low[1], (foot.low[2] + foot.high[2]) / 2)
            patch = _around(middle, box.feet.bolt_patch / 2, (0.0, 1.0, 0.0))
            tests[f"foot-{number}-bolt"] = _inside(patch, slack, kind="Plane")
    for bore in box.bores:
        start, end = box.bore_span(bore)
        x, y, _ = bore.center
        r = bore.diameter / 2
        tests[bore.name] = _inside(Block((x - r, y - r, start), (2 * r, 2 * r, end - start)), slack, kind="Cylinder")
    return tests


def _matching(gmsh: Any, faces: list[tuple[int, int]], tests: dict[str, Test]) -> dict[str, list[int]]:
    named: dict[str, list[int]] = {name: [] for name in tests}
    for _, face in faces:
        kind = gmsh.model.getType(2, face)
        # OpenCASCADE widens its bounding boxes by its own tolerance of 1e-7, in the model's unit.
        bounds = np.array(gmsh.model.getBoundingBox(2, face)).reshape(2, 3) + [[1e-7] * 3, [-1e-7] * 3]
        for name, belongs in tests.items():
            if belongs(kind, bounds):
                named[name].append(face)
    return named


def _slack(box: BoxGeometry) -> float:
    return 1e-7 * max(box.size) + 1e-6


def _around(center: tuple[float, float, float], radius: float, axis: tuple[float, float, float]) -> Block:
    """Return the bounding block of a circle."""
    low = [c - radius * (1.0 - abs(a)) for c, a in zip(center, axis, strict=True)]
    size = [2 * radius * (1.0 - abs(a)) for a in axis]
    return Block((low[0], low[1], low[2]), (size[0], size[1], size[2]))


def _on_plane(axis: int, value: float, slack: float) -> Test:
    def belongs(kind: str, bounds: FloatArray) -> bool:
        return kind == "Plane" and bool(np.all(np.abs(bounds[:, axis] - value) < slack))

    return belongs


def _inside(block: Block, slack: float, *, kind: str) -> Test:
    def belongs(face_kind: str, bounds: FloatArray) -> bool:
        return face_kind == kind and bool(
            np.all(bounds[0] > np.array(block.low) - slack) and np.all(bounds[1] < np.array(block.high) + slack)
        )

    return belongs


def mesh_box(geometry: BoxGeometry, mesh_size: float, *, order: int = 2) -> Mesh:
    """Mesh a box housing with tetrahedra.

    Parameters
    ----------
    geometry : BoxGeometry
    mesh_size : float
        Edge length aimed at [m].
    order : {1, 2}
        Polynomial order of the elements; with 2, middle nodes lie on the bores' cylinders.

    Returns
    -------
    Mesh
        Mesh with the surfaces left, right, bottom, top, back, front (plane outer faces), the undersides of the feet and
        their bolts' circles, the two circles of each bolt of a cover, and one surface for each bore under its own
        name. The volume housing is all of it; with a cover, body and cover stand in its place, which share nodes
        only where the cover is bonded.

    Raises
    ------
    MeshSizeError
        See :func:`gearwhine.meshes.check_mesh_size`.
    GeometryError
        Where gmsh cannot build or mesh the shape.
    """
    check_mesh_request(mesh_size, order)
    with gmsh_session("housing box") as gmsh:
        solid = build_solid(gmsh, geometry)
        surfaces = named_faces(gmsh, geometry, solid)
        # Either the parts or the whole: some formats know one volume for each element.
        volumes = {"body": [*solid.body], "cover": [*solid.cover]} if solid.cover else {"housing": [*solid.body]}
        filled = sum(gmsh.model.occ.getMass(3, tag) for tag in (*solid.body, *solid.cover))
        check_mesh_size(filled, max(geometry.size), mesh_size)
        mesh_solids(gmsh, mesh_size, order)
        return collect(gmsh, order, surfaces, volumes).mesh()
