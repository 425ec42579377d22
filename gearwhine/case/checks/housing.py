"""Checks of a case's housing: one geometry, a box whose parts fit, fixtures and sensors in their places.

The box of a case is built as an object of `meshes`, and parts that do not fit are yielded as findings. Seats, supports,
sensors and masses are checked against it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from gearwhine.case.box import FACES, Box
from gearwhine.case.errors import NOTHING, UNSAID, Finding, Location
from gearwhine.case.fields import Patch
from gearwhine.case.housing import GEOMETRIES, Seat
from gearwhine.case.model import Draft
from gearwhine.numerics.findings import in_mm
from gearwhine.numerics.names import one_of

if TYPE_CHECKING:
    from gearwhine.meshes import BoxGeometry

_IN_THE_FILE = {"start": "from", "end": "to"}


def box_geometry(box: Box, seats: Sequence[Seat]) -> BoxGeometry:
    """Return the box with the bores of its seats.

    Raises
    ------
    gearwhine.meshes.GeometryError
        Where its parts do not fit each other.
    """
    from gearwhine.meshes import Bore, Boss, BoxGeometry, Cover, CoverBolts, Feet, Fillets, Flange, Rib, WallThickness

    walls, cover = box.walls, box.cover
    bores = []
    for seat in seats:
        boss = Boss(seat.boss.diameter, seat.boss.length) if seat.boss else None
        bores.append(Bore(seat.name, seat.center, seat.diameter, boss))
    flange = cover.flange if cover is not None else None
    bolts = cover.bolts if cover is not None else None
    return BoxGeometry(
        size=box.size,
        wall=WallThickness(**{face: getattr(walls, face) for face in FACES}),
        bores=tuple(bores),
        feet=Feet(box.feet.size, box.feet.bolt_patch) if box.feet else None,
        ribs=tuple(Rib(**rib.model_dump()) for rib in box.ribs),
        cover=None
        if cover is None
        else Cover(
            face=cover.face,
            flange=Flange(**flange.model_dump()) if flange else None,
            bolts=CoverBolts(**bolts.model_dump(exclude={"material"})) if bolts else None,
            bonded=cover.bonded,
        ),
        fillets=Fillets(box.fillets.inside, box.fillets.outside),
    )


def box_findings(box: Box, seats: Sequence[tuple[int, Seat]]) -> Iterator[Finding]:
    """Yield parts of a box that do not fit each other.

    Parameters
    ----------
    box : Box
    seats : sequence of (int, Seat)
        Seats of the box, each with its place in the case.
    """
    from gearwhine.meshes import GeometryError, check_mesh_size
    from gearwhine.meshes.box.geometry import BoxMisfitError
    from gearwhine.meshes.errors import MeshSizeError

    try:
        box_geometry(box, [seat for _, seat in seats])
        if box.mesh_size is not None:
            check_mesh_size(wall_volume(box), max(box.size), box.mesh_size)
    except MeshSizeError as error:
        yield Finding(("housing", "box", "mesh_size"), f"another size of elements; {error}")
    except BoxMisfitError as error:
        for misfit in error.misfits:
            kind, *steps = misfit.location
            if kind == "bores":
                number, *rest = steps
                assert isinstance(number, int)
                yield Finding(("housing", "seat", seats[number][0], *rest), misfit.expected)
            else:
                inner = (_IN_THE_FILE.get(str(step), step) for step in misfit.location)
                yield Finding(("housing", "box", *inner), misfit.expected)
    except GeometryError as error:
        yield Finding(("housing", "box"), f"parts that fit each other; {error}", UNSAID)


def wall_volume(box: Box) -> float:
    """Return the volume of the plain walls [m³], without bores and other parts."""
    walls, (x, y, z) = box.walls, box.size
    inside = (x - walls.left - walls.right) * (y - walls.bottom - walls.top) * (z - walls.back - walls.front)
    return x * y * z - inside


_SLACK = 1e-9
"""Room for rounding where two lengths may just touch [m]."""


def check_housing_form(draft: Draft) -> Iterator[Finding]:
    """Yield choices that are not made exactly once: the geometry, and the number of modes."""
    housing = draft.document.get("housing")
    if not isinstance(housing, Mapping):
        return
    forms = [key for key in (*GEOMETRIES, "reduced") if key in housing]
    if forms == ["reduced"]:
        return
    if len(forms) != 1:
        value = forms or NOTHING
        *others, last = (f"[housing.{key}]" for key in (*GEOMETRIES, "reduced"))
        expected = f"exactly one of {', '.join(others)} and {last}"
        yield Finding(("housing",), expected, value)
    limits = [key for key in ("frequency_limit", "modes") if key in housing]
    if len(limits) != 1:
        expected = "exactly one of 'frequency_limit' (such as '3.2 kHz') and 'modes' (such as 25)"
        yield Finding(("housing",), expected, limits or NOTHING)
    yield from _check_resolution(housing)
    if "box" in housing and housing.get("face"):
        yield Finding(("housing", "face"), f"none of a box, whose faces are named already: {', '.join(FACES)}", UNSAID)
    ratios, modes = housing.get("damping_ratio"), housing.get("modes")
    if isinstance(ratios, list) and isinstance(modes, int) and len(ratios) != modes:
        yield Finding(("housing", "damping_ratio"), f"a ratio for each of the {modes} modes (there are {len(ratios)})")


def _check_resolution(housing: Mapping[str, object]) -> Iterator[Finding]:
    """Yield a size of elements and an accuracy that are both given, or neither, or of a mesh that is there already."""
    accuracy = "accuracy" in housing
    if accuracy and "mesh" in housing:
        expected = "none with [housing.mesh], whose elements are as they are; `gearwhine modes` estimates their error"
        yield Finding(("housing", "accuracy"), expected)
    for key in ("box", "cad"):
        source = housing.get(key)
        if not isinstance(source, Mapping):
            continue
        if not accuracy and "mesh_size" not in source:
            expected = "a length above 0 m such as '6.35 mm', or an accuracy in [housing] such as '2 %'"
            yield Finding(("housing", key, "mesh_size"), expected, NOTHING)
        for size in ("mesh_size", "seat_mesh_size"):
            if accuracy and size in source:
                yield Finding(("housing", key, size), "none beside an accuracy in [housing], by which it is found")


def check_box(draft: Draft) -> Iterator[Finding]:
    """Yield findings on a box: its walls and parts, seats, supports and sensors."""
    box = draft.box
    if box is None:
        return
    yield from box_findings(box, draft.seats)
    yield from _check_surfaces(draft, box)
    boss = max((seat.boss.length for _, seat in draft.seats if seat.boss is not None), default=0.0)
    for location, patch in _patches(draft):
        yield from _check_patch(box, location, patch, boss)
    for index, sensor in draft.sensors:
        location = ("housing", "sensor", index, "position")
        yield from _check_on_surface(draft, box, location, sensor.position, in_bores=True)
    for index, mass in draft.masses:
        if mass.position is not None:
            location = ("housing", "mass", index, "position")
            yield from _check_on_surface(draft, box, location, mass.position, in_bores=False)


def _patches(draft: Draft) -> Iterator[tuple[Location, Patch]]:
    """Yield all fixtures on one patch, with their places in the case."""
    for kind, entries in (("support", draft.supports), ("mount", draft.mounts), ("mass", draft.masses)):
        for index, entry in entries:
            yield ("housing", kind, index), entry


def _check_surfaces(draft: Draft, box: Box) -> Iterator[Finding]:
    """Yield surfaces that the box does not have, under supports and other fixtures."""
    seats = draft.names("housing", "seat")
    surfaces = sorted((*box.surfaces, *seats), key=lambda name: name.startswith("bolt-"))
    named: list[tuple[Location, str | None]] = [
        ((*place, "surface"), patch.surface) for place, patch in _patches(draft)
    ]
    for index, joint in draft.joints:
        for end, surface in enumerate(joint.surfaces or ()):
            named.append((("housing", "joint", index, "surfaces", end), surface))
    for location, name in named:
        if name is not None and name not in surfaces:
            feet = "" if box.feet is not None else "; it has no feet"
            yield Finding(location, one_of(f"a surface of the box{feet}", name, surfaces))
    for index, region in draft.raw_entries("housing", "region"):
        name, volumes = region.get("volume"), ("housing",) if box.cover is None else ("body", "cover")
        if isinstance(name, str) and name not in volumes:
            yield Finding(("housing", "region", index, "volume"), one_of("a volume of the box", name, volumes))


def _check_patch(box: Box, place: Location, patch: Patch, boss: float) -> Iterator[Finding]:
    """Yield a patch whose box holds no material: outside the housing, or all in its cavity.

    ``boss`` is how far the longest boss stands out of the end walls [m].
    """
    foot, out = box.feet.size[1] if box.feet is not None else 0.0, box.stands_out
    bottom = (box.lower[0] - out, box.lower[1] - max(foot, out), box.lower[2] - max(boss, out))
    top = (box.upper[0] + out, box.upper[1] + out, box.upper[2] + max(boss, out))
    if patch.plane is not None:
        normal, at = "xyz".index(patch.plane.axis), patch.plane.at
        if not bottom[normal] - _SLACK <= at <= top[normal] + _SLACK:
            spans = f"{patch.plane.axis} = {in_mm(bottom[normal])} to {in_mm(top[normal])}"
            yield Finding((*place, "plane", "at"), f"a plane that meets the housing, which spans {spans}")
    if patch.corners is None:
        return
    low, high = patch.corners
    walls = box.walls
    inside_low = (box.lower[0] + walls.left, box.lower[1] + walls.bottom, box.lower[2] + walls.back)
    inside_high = (box.upper[0] - walls.right, box.upper[1] - walls.top, box.upper[2] - walls.front)
    location = (*place, "box")
    for axis, least, most, begin, end in zip("xyz", low, high, bottom, top, strict=True):
        if least > end + _SLACK or most < begin - _SLACK:
            expected = f"a box that meets the housing, which spans {axis} = {in_mm(begin)} to {in_mm(end)}"
            yield Finding(location, expected)
            return
    if not box.furnished and all(
        a > b and c < d for a, b, c, d in zip(low, inside_low, high, inside_high, strict=True)
    ):
        yield Finding(location, "a box that meets the housing's walls; this one is all in its cavity")


def _check_on_surface(
    draft: Draft, box: Box, location: Location, position: tuple[float, float, float], *, in_bores: bool
) -> Iterator[Finding]:
    """Yield a point that is further from the box's surface than its walls are thick, or in the air of a bore."""
    from gearwhine.meshes.box.surface_points import point_off_surface

    boss = max((seat.boss.length for _, seat in draft.seats if seat.boss is not None), default=0.0)
    foot = box.feet.size[1] if box.feet is not None else 0.0
    expected = point_off_surface(
        position,
        box.size,
        {face: getattr(box.walls, face) for face in FACES},
        stands_out=max(boss, foot, box.stands_out),
        furnished=box.furnished,
        bores=[(seat.name, seat.center, seat.diameter) for _, seat in draft.seats] if in_bores else (),
    )
    if expected:
        yield Finding(location, expected)
