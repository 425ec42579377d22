"""Box geometry: the box of a case as an object of `meshes`, and its misfits as findings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from gearwhine.case.box import FACES, Box
from gearwhine.case.housing import Seat
from gearwhine.case.problems import UNSAID, Finding

if TYPE_CHECKING:
    from meshes import BoxGeometry

_IN_THE_FILE = {"start": "from", "end": "to"}


def box_geometry(box: Box, seats: Sequence[Seat]) -> BoxGeometry:
    """Return the box with the bores of its seats.

    Raises
    ------
    meshes.GeometryError
        Where its parts do not fit each other.
    """
    import meshes

    walls, cover = box.walls, box.cover
    bores = []
    for seat in seats:
        boss = meshes.Boss(seat.boss.diameter, seat.boss.length) if seat.boss else None
        bores.append(meshes.Bore(seat.name, seat.center, seat.diameter, boss))
    flange = cover.flange if cover is not None else None
    bolts = cover.bolts if cover is not None else None
    return meshes.BoxGeometry(
        size=box.size,
        wall=meshes.WallThickness(**{face: getattr(walls, face) for face in FACES}),
        bores=tuple(bores),
        feet=meshes.Feet(box.feet.size, box.feet.bolt_patch) if box.feet else None,
        ribs=tuple(meshes.Rib(**rib.model_dump()) for rib in box.ribs),
        cover=None
        if cover is None
        else meshes.Cover(
            face=cover.face,
            flange=meshes.Flange(**flange.model_dump()) if flange else None,
            bolts=meshes.CoverBolts(**bolts.model_dump(exclude={"material"})) if bolts else None,
            bonded=cover.bonded,
        ),
        fillets=meshes.Fillets(box.fillets.inside, box.fillets.outside),
    )


def box_findings(box: Box, seats: Sequence[tuple[int, Seat]]) -> Iterator[Finding]:
    """Yield what does not fit among the parts of a box.

    Parameters
    ----------
    box
        The box.
    seats
        Its seats, each with its place in the case.
    """
    from meshes import BoxMisfitError, GeometryError, MeshSizeError, check_mesh_size

    try:
        box_geometry(box, [seat for _, seat in seats])
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
    """Material of the plain walls [m³], without bores and without what is added to them."""
    walls, (x, y, z) = box.walls, box.size
    inside = (x - walls.left - walls.right) * (y - walls.bottom - walls.top) * (z - walls.back - walls.front)
    return x * y * z - inside
