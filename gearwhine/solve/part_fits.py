"""Fits of a case's parts: bearings in seats and on shafts, gears on shafts and face to face, sensors on the surface.

Fits are checked where the case gives both sizes. A part that does not fit is no error: the model takes neither diameter
from the other, so that one of them is a slip of the pen or stands for a sleeve that the case leaves out.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from gearwhine.case import Bearing, Gear, GearPair, Housing, Seat
from gearwhine.case.bearings import RollingCatalogue
from gearwhine.case.checks.housing import box_geometry
from gearwhine.case.parts import Parts
from gearwhine.housing.model_warnings import surface_point_warnings
from gearwhine.meshes import Mesh, find_bores
from gearwhine.meshes.bores import CylindricalBore
from gearwhine.numerics.findings import in_mm
from gearwhine.numerics.result_warnings import warning
from gearwhine.rotors import Rotor, Segment

_FIT_TOLERANCE = 1e-4  # difference up to which two diameters, or a place and an end, fit [m]
_TOUCHING_OVERLAP = 1e-6  # overlap of a part and a shaft segment up to which it counts as none [m]


def fit_warnings(parts: Parts, housing: Housing | None, mesh: Mesh | None = None) -> list[dict[str, Any]]:
    """Warn of diameters that do not fit, bearings beside seats, gears beside their mates, sensors off the surface.

    Parameters
    ----------
    parts : Parts
        Tables of the machine's parts, and the rotors that are made of them.
    housing : Housing or None
    mesh : Mesh or None
        Mesh of a housing from a CAD or mesh file, in which the bores of the seats are found.
    """
    bores = () if mesh is None else find_bores(mesh, axis=(0.0, 0.0, 1.0))
    rotors = {rotor.name: rotor for rotor in parts.rotors}
    starts = {rotor.name: rotor.start for rotor in parts.rotor}
    warnings = list[dict[str, Any]]()
    for bearing in parts.bearing:
        bore, _, width = _rings(bearing)
        if bore is not None:
            warnings += _on_shaft(f'bearing "{bearing.name}"', bore, rotors[bearing.rotor], bearing.at, width or 0.0)
        seat = None if housing is None else next((one for one in housing.seat if one.name == bearing.seat), None)
        if housing is not None and seat is not None:
            warnings += _in_seat(bearing, starts[bearing.rotor] + bearing.at, seat, _span(housing, seat, bores))
    for gear in parts.gear:
        if gear.bore and gear.rotor is not None and gear.at is not None:
            on = rotors[gear.rotor]
            warnings += _on_shaft(f'gear "{gear.name}"', gear.bore, on, gear.at, gear.face_width or 0.0)
    warnings += _of_faces(parts.gear, parts.gear_pair, starts)
    if mesh is not None and housing is not None:
        sensors, masses = [sensor.build() for sensor in housing.sensor], [mass.build() for mass in housing.mass]
        warnings += surface_point_warnings(mesh, sensors, masses)
    return warnings


def _in_seat(bearing: Bearing, z: float, seat: Seat, span: tuple[float, float] | None) -> Iterator[dict[str, Any]]:
    """Warn of a bearing at z that does not fit its seat, or stands beside the bore, whose ends may be known [m]."""
    label = f'bearing "{bearing.name}"'
    _, outside, width = _rings(bearing)
    if outside is not None and abs(outside - seat.diameter) > _FIT_TOLERANCE:
        yield warning(
            "bearing seat",
            f"{label}: its outside diameter of {in_mm(outside)} is not the {in_mm(seat.diameter)} of the bore of seat "
            f'"{seat.name}"',
            bearing=bearing.name,
            outside_diameter_m=outside,
            seat_diameter_m=seat.diameter,
        )
    if span is not None:
        off, where = max(span[0] - z, z - span[1]), f"the bore, z = {in_mm(span[0])} to {in_mm(span[1])}"
    else:
        half = 0.5 * (width or 0.0)
        off, where = (
            abs(z - seat.center[2]) - half,
            f"the seat's centre, z = {in_mm(seat.center[2])}, by half its width",
        )
        if not half:
            return
    if off > _FIT_TOLERANCE:
        yield warning(
            "bearing place",
            f'{label}: its middle at z = {in_mm(z)} lies {in_mm(off)} beyond {where}, of seat "{seat.name}"; the seat '
            "moves there as a rigid extension of its bore",
            bearing=bearing.name,
            beyond_m=off,
        )


def _rings(bearing: Bearing) -> tuple[float | None, float | None, float | None]:
    """Bore, outside diameter and width of a rolling bearing [m], as far as the case gives them."""
    rolling = bearing.rolling
    if rolling is None:
        return None, None, None
    if isinstance(rolling, RollingCatalogue):
        size = rolling.catalogue
        rows = rolling.spacing or 0.0
        return size.bore, size.outer_diameter, size.width + rows
    mounting = rolling.mounting
    return (None, None, None) if mounting is None else (mounting.bore, mounting.outer_diameter, None)


def _span(housing: Housing, seat: Seat, bores: Sequence[CylindricalBore]) -> tuple[float, float] | None:
    """Return the ends of a seat's bore along z [m]: of a box by its walls and bosses, else of the bore found there."""
    if housing.box is not None:
        box = box_geometry(housing.box, housing.seat)
        low, high = box.bore_span(next(bore for bore in box.bores if bore.name == seat.name))
        return low, high
    spans = []
    for bore in bores:
        apart = max(abs(bore.center[axis] - seat.center[axis]) for axis in range(2))
        ends = bore.center[2] - 0.5 * bore.length, bore.center[2] + 0.5 * bore.length
        alike = apart <= 10 * _FIT_TOLERANCE and abs(bore.diameter - seat.diameter) <= 0.02 * seat.diameter
        if alike and ends[0] - seat.diameter <= seat.center[2] <= ends[1] + seat.diameter:
            spans.append(ends)
    return min(spans, key=lambda ends: max(ends[0] - seat.center[2], seat.center[2] - ends[1]), default=None)


def _of_faces(
    tables: Sequence[Gear], pairs: Sequence[GearPair], starts: Mapping[str, float]
) -> Iterator[dict[str, Any]]:
    """Warn of gears so far apart along z that less than the narrower face meets the other."""
    gears = {gear.name: gear for gear in tables}
    for pair in pairs:
        ends = []
        for gear in (gears[pair.driver], gears[pair.driven]):
            if gear.rotor is None or gear.at is None or gear.face_width is None:
                break
            middle = starts[gear.rotor] + gear.at
            ends.append((middle - 0.5 * gear.face_width, middle + 0.5 * gear.face_width))
        else:
            common = min(end for _, end in ends) - max(start for start, _ in ends)
            whole = min(end - start for start, end in ends)
            if whole - common > _FIT_TOLERANCE:
                ranges = " and ".join(f"{in_mm(start)} to {in_mm(end)}" for start, end in ends)
                yield warning(
                    "gear faces",
                    f'gear pair "{pair.driver}" to "{pair.driven}": the faces, z = {ranges}, have {in_mm(common)} in '
                    f"common, which carries; the narrower one is {in_mm(whole)} wide",
                    common_m=common,
                    narrower_m=whole,
                )


def _on_shaft(label: str, bore: float, rotor: Rotor, at: float, width: float) -> Iterator[dict[str, Any]]:
    """Warn where no segment under a part has its bore, a cone somewhere along it."""
    left, right = at - 0.5 * width, at + 0.5 * width
    segment_ends = []
    for part, start, end in zip(rotor.segments, rotor.joints, rotor.joints[1:], strict=False):
        overlaps = min(end, right) - max(start, left) > _TOUCHING_OVERLAP or start <= left == right <= end
        if isinstance(part, Segment) and overlaps:
            segment_ends.append(tuple(outer for outer, _ in part.end_diameters))
    if not segment_ends or any(
        min(ends) - _FIT_TOLERANCE <= bore <= max(ends) + _FIT_TOLERANCE for ends in segment_ends
    ):
        return
    diameters = list(dict.fromkeys(diameter for ends in segment_ends for diameter in ends))
    listed = " and ".join(in_mm(diameter) for diameter in diameters)
    yield warning(
        "part on shaft",
        f'{label}: its bore of {in_mm(bore)} is not the diameter of rotor "{rotor.name}" at {in_mm(at)}, {listed}',
        bore_m=bore,
        shaft_diameters_m=diameters,
    )
