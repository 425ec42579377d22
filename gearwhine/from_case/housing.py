"""Housing of a case as the library's description: mesh, materials, fixtures, seats, sensors and damping."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager

from gearwhine.case import Bearing, CaseError, Material, Problem, Rotor
from gearwhine.case import Housing as HousingTable
from gearwhine.case import Seat as HousingSeat
from gearwhine.case.checks.housing import box_geometry
from gearwhine.case.errors import UNSAID
from gearwhine.from_case.fixtures import build_fixtures, fixture_problems
from gearwhine.from_case.mesh import materials_of
from gearwhine.housing import Housing, HousingError, Seat
from gearwhine.housing.housing import DampingRatio
from gearwhine.meshes import Mesh

Point = tuple[float, float, float]

_UPWARDS: Point = (0.0, 1.0, 0.0)


def describe_housing(
    table: HousingTable, materials: Mapping[str, Material], mesh: Mesh, up: Point = _UPWARDS
) -> Housing:
    """Build the library's description of a case's housing on its mesh.

    Raises
    ------
    CaseError
        Where a region has no elements of its own.
    gearwhine.housing.HousingError
        As :class:`gearwhine.housing.Housing`.
    """
    parted, material, of_regions = materials_of(table, materials, mesh)
    return Housing(
        parted,
        material,
        of_regions,
        build_fixtures(table, materials),
        build_seats(table),
        [sensor.build() for sensor in table.sensor],
        _damping_ratio(table),
        table.mesh_size,
        None if table.box is None else (table.box.lower, table.box.upper),
        up,
    )


def build_seats(table: HousingTable) -> list[Seat]:
    """Build the bearing seats; a box knows the depth of each bore."""
    if table.box is None:
        return [Seat(seat.name, seat.center, seat.diameter, ring_orders=seat.ring_orders or 0) for seat in table.seat]
    box, rings = box_geometry(table.box, table.seat), {seat.name: seat.ring_orders or 0 for seat in table.seat}
    return [Seat(bore.name, bore.center, bore.diameter, box.bore_depth(bore), rings[bore.name]) for bore in box.bores]


def _damping_ratio(table: HousingTable) -> DampingRatio:
    """Return the damping ratio, that of each mode, or those by frequency [Hz]."""
    ratio = table.modal_damping
    return dict(table.damping_points) if isinstance(ratio, Mapping) else ratio


@contextmanager
def refused_by_key(table: HousingTable) -> Iterator[None]:
    """Refuse what a housing's solution finds wrong with it by the keys of its table.

    Raises
    ------
    CaseError
        With every fixture that does not fit the mesh, modes that the model does not have, too few damping ratios, an
        accuracy that no mesh reaches, or a solver that cannot be started.
    """
    keys = {"count": "modes", "below_hz": "frequency_limit"}  # others have the attribute's name
    try:
        yield
    except HousingError as error:
        if not error.findings:
            raise
        if error.findings[0].part[0] != "housing":
            raise CaseError(fixture_problems(table, error)) from error
        problems = []
        for finding in error.findings:
            value = f"{len(finding.value)} ratios" if isinstance(finding.value, tuple) else finding.value or UNSAID
            problems.append(
                Problem(f"housing.{keys.get(finding.attribute, finding.attribute)}", value, finding.expected)
            )
        raise CaseError(problems) from error


def bearing_places(
    seats: Iterable[HousingSeat], bearings: Sequence[Bearing], rotors: Iterable[Rotor]
) -> dict[str, tuple[str, float]]:
    """Bearing positions on a housing: by bearing, its seat and its distance along z from the seat's centre [m].

    Without bearings in seats, each seat stands for a bearing at its centre. The housing's residual modes are for these.
    """
    centers = {seat.name: seat.center[2] for seat in seats}
    starts = {rotor.name: rotor.start for rotor in rotors}
    places = {
        bearing.name: (bearing.seat, starts[bearing.rotor] + bearing.at - centers[bearing.seat])
        for bearing in bearings
        if bearing.seat in centers
    }
    return places or {name: (name, 0.0) for name in centers}


def upwards(table: HousingTable, gravity: Point | None) -> Point:
    """Return the unit vector that points upwards: against gravity, else the file's z of a part turned about it, else y.

    A file whose shafts lie along its x or y has its z upwards, as programs for design have it; `shafts_along = "y"`
    makes that the machine's x.
    """
    if gravity is not None and any(gravity):
        size = math.hypot(*gravity)
        x, y, z = (-part / size for part in gravity)
        return x, y, z
    form = table.cad or table.mesh
    return (1.0, 0.0, 0.0) if form is not None and form.shafts_along == "y" else _UPWARDS
