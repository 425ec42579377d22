"""Named surfaces of a box: the faces of its finished solid, found by their places."""

from collections.abc import Callable
from typing import Any

import numpy as np

from meshes.box import layout
from meshes.box.geometry import BoxGeometry
from meshes.box.layout import Block
from meshes.box.parts import FACES
from meshes.box.solid import BoxSolid
from meshes.elements import FloatArray
from meshes.errors import GeometryError

Test = Callable[[str, FloatArray], bool]


def named_faces(gmsh: Any, box: BoxGeometry, solid: BoxSolid) -> dict[str, list[int]]:
    """The faces of the current gmsh model that make up each named surface.

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
    """Tests for the surfaces that are found by their places alone."""
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
    """The block around a circle."""
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
