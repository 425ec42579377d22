"""Checks of acoustics on a housing's mesh, before its modes are known: radiating surface, floor and microphones.

:func:`acoustics_findings` wraps the housing as the solution will and finds every microphone that is not in the air,
triangles that are too large, and a floor above the soles, so that none of them ends an analysis after the long work.
"""

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from gearwhine.coupling.errors import AcousticsError
from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.housing import HousingError
from gearwhine.housing.acoustics.boundary_elements import BoundaryElements
from gearwhine.housing.acoustics.medium import HardPlane
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.acoustics.radiation import coarsest_edge, set_down, wrapped
from gearwhine.housing.acoustics.surface_velocity import face_surface
from gearwhine.housing.errors import TriangleSizeError
from gearwhine.housing.fem.surface import FlatFace, flat_face_of_surface
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Part, in_mm, refuse
from gearwhine.numerics.names import one_of
from gearwhine.numerics.result_warnings import ResultWarning, warning

_PART: Part = ("acoustics", "")
_COARSE = 20.0  # triangles along the housing where neither their size nor a frequency is known
_DEEP = 20.0  # depth of a floor below the housing above which it is doubtful, in sizes of the housing
_FAR = 200.0  # distance of a microphone above which it is doubtful, in sizes of the housing
_IN_METRES = "a number without a unit is in m"


def require_acoustics(acoustics: Acoustics, mesh: Mesh, widest_bore: float | None, limit_hz: float | None) -> None:
    """Refuse a radiating surface or microphones that cannot be, before the modes are solved.

    Parameters
    ----------
    acoustics : Acoustics
    mesh : Mesh
        Mesh of the housing; straight elements suffice.
    widest_bore : float or None
        Diameter of its widest seat [m].
    limit_hz : float or None
        Highest frequency of the sound, where it is known [Hz].

    Raises
    ------
    AcousticsError
        With everything that is wrong.
    """
    findings = surface_findings(acoustics, mesh)
    if acoustics.method == "rayleigh":
        findings += _face_findings(acoustics, mesh, limit_hz) if not findings else []
    elif acoustics.method == "boundary-elements":
        findings += _wrap_findings(acoustics, mesh, widest_bore, limit_hz)
    refuse(findings, AcousticsError)


def surface_findings(acoustics: Acoustics, mesh: Mesh) -> list[Finding]:
    """Return the names of surfaces that the housing does not have."""
    surfaces = tuple(mesh.surfaces)
    return [
        Finding(_PART, f"{attribute}.{place}", name, one_of("a surface of the housing", name, surfaces))
        for attribute in ("still", "faces")
        for place, name in enumerate(getattr(acoustics, attribute))
        if name not in surfaces
    ]


def radiating_faces(acoustics: Acoustics, mesh: Mesh) -> dict[str, FlatFace]:
    """Return the flat faces that radiate by Rayleigh's integral, by their names.

    Raises
    ------
    AcousticsError
        Where a surface is not flat.
    """
    faces = {name: flat_face_of_surface(mesh, name) for name in acoustics.faces}
    refuse(
        (
            Finding(_PART, f"faces.{place}", name, "a flat surface, for Rayleigh's integral")
            for place, (name, face) in enumerate(faces.items())
            if face is None
        ),
        AcousticsError,
    )
    return {name: face for name, face in faces.items() if face is not None}


def microphone_findings(
    acoustics: Acoustics, positions: Mapping[str, FloatArray], require_in_air: Callable[[FloatArray], None]
) -> Iterator[Finding]:
    """Yield the microphones at which the sound pressure cannot be found.

    Parameters
    ----------
    acoustics : Acoustics
    positions : mapping of str to ndarray, shape (3,)
        Positions of :meth:`Acoustics.microphones` [m].
    require_in_air : callable
        Raises `HousingError` where points, shape (n, 3), are not in the air.
    """
    for number, (name, place) in enumerate(positions.items()):
        try:
            require_in_air(place[None])
        except HousingError as error:
            if number < len(acoustics.microphone):
                yield Finding(("microphone", name), "position", tuple(place.tolist()), f"a point in the air; {error}")
            else:
                expected = f"a distance at which microphone {name!r} is in the air; {error}"
                yield Finding(_PART, "microphone_box", acoustics.microphone_box, expected)


def acoustics_warnings(acoustics: Acoustics, bounds: FloatArray, limit_hz: float | None) -> list[ResultWarning]:
    """Return warnings about values of acoustics that are allowed but implausible.

    Parameters
    ----------
    acoustics : Acoustics
    bounds : ndarray, shape (2, 3)
        Lowest and highest corner of the housing [m].
    limit_hz : float or None
        Frequency up to which its modes are complete, where that is known [Hz].
    """
    warnings = []
    size = float(np.ptp(bounds, axis=0).max())
    large = f"the size of the housing, {in_mm(size)}"
    if acoustics.floor is not None and (depth := float(bounds[0, 1]) - acoustics.floor) > _DEEP * size:
        message = (
            f"acoustics.floor lies {depth:.3g} m below the housing, {depth / size:.0f} times {large}: there it hardly "
            f"counts; {_IN_METRES}, so that a floor under the soles is floor = '{1e3 * float(bounds[0, 1]):.4g} mm'"
        )
        warnings.append(warning("acoustics floor", message, below_m=depth))
    middle = 0.5 * (bounds[0] + bounds[1])
    for microphone in acoustics.microphone:
        distance = float(np.linalg.norm(np.array(microphone.position) - middle))
        if distance > _FAR * size:
            message = (
                f'acoustics.microphone "{microphone.name}" is {distance:.3g} m from the housing, '
                f"{distance / size:.0f} times {large}; {_IN_METRES}"
            )
            warnings.append(warning("acoustics microphone", message, distance_m=distance))
    if acoustics.microphone_box is not None and acoustics.microphone_box > _FAR * size:
        message = (
            f"acoustics.microphone_box of {acoustics.microphone_box:.3g} m is "
            f"{acoustics.microphone_box / size:.0f} times {large}; {_IN_METRES}"
        )
        warnings.append(warning("acoustics microphone", message, distance_m=acoustics.microphone_box))
    highest = acoustics.highest_frequency
    if highest is not None and limit_hz is not None and highest > limit_hz * (1.0 + 1e-9):
        message = (
            f"acoustics.highest_frequency of {highest:.5g} Hz is above {limit_hz:.5g} Hz, up to which the housing's "
            "modes are complete: between them the sound lacks modes and may be too low by any amount; raise "
            f"housing.frequency_limit to {highest:.5g} Hz or more, or leave the highest frequency out"
        )
        warnings.append(warning("acoustics frequency", message, highest_hz=highest, complete_below_hz=limit_hz))
    return warnings


def _face_findings(acoustics: Acoustics, mesh: Mesh, limit_hz: float | None) -> list[Finding]:
    """Return faces that are not flat, and microphones that are not in front of the one that there is."""
    try:
        faces = radiating_faces(acoustics, mesh)
    except AcousticsError as error:
        return list(error.findings)
    findings = [] if limit_hz is None else list(_coarse_faces(acoustics, mesh, faces, limit_hz))
    positions, _ = acoustics.microphones(mesh.bounds)
    if len(faces) == 1 and positions:
        (face,) = faces.values()
        findings += microphone_findings(acoustics, positions, _face_elements(acoustics, mesh, face).require_in_air)
    return findings


def _coarse_faces(
    acoustics: Acoustics, mesh: Mesh, faces: Mapping[str, FlatFace], limit_hz: float
) -> Iterator[Finding]:
    """Yield faces whose elements are too large for the highest frequency [Hz]."""
    for place, (name, face) in enumerate(faces.items()):
        # Straight elements stand for curved ones, whose middle nodes halve their edges.
        straight = all(block.nodes.shape == block.corners.shape for block in face.facets)
        try:
            _face_elements(acoustics, mesh, face).require_resolved(limit_hz, elements=1.5 if straight else 3.0)
        except TriangleSizeError as error:
            expected = f"a face of smaller elements, whose sides are the triangles of 'rayleigh'; {error}"
            yield Finding(_PART, f"faces.{place}", name, expected)


def _face_elements(acoustics: Acoustics, mesh: Mesh, face: FlatFace) -> BoundaryElements:
    surface, _ = face_surface(mesh, face.facets)
    return BoundaryElements(surface, acoustics.medium, HardPlane(face.center, face.normal))


def _wrap_findings(
    acoustics: Acoustics, mesh: Mesh, widest_bore: float | None, limit_hz: float | None
) -> Iterator[Finding]:
    """Yield what is wrong with the wrap of boundary elements, the floor and the microphones."""
    coarse = float(np.ptp(mesh.bounds, axis=0).max()) / _COARSE
    is_size_known = acoustics.mesh_size is not None or limit_hz is not None
    edge = acoustics.mesh_size or (coarse if limit_hz is None else acoustics.edge(limit_hz))
    longest = coarsest_edge(mesh)
    if acoustics.mesh_size is not None and edge > longest:
        expected = f"an edge of at most {in_mm(longest)}, three along the shortest side of the housing"
        yield Finding(_PART, "mesh_size", edge, expected)
        return
    try:
        surface = wrapped(mesh, edge, acoustics.closed_holes(edge, widest_bore))
    except HousingError as error:
        yield unwrapped(acoustics, edge, error)
        return
    elements = _elements_on(surface, acoustics, edge)
    positions, _ = acoustics.microphones(mesh.bounds)
    if elements is None:
        lowest = in_mm(float(mesh.bounds[0, 1]))
        yield Finding(_PART, "floor", acoustics.floor, f"a height at or below the soles, y = {lowest}")
        elements = BoundaryElements(surface, acoustics.medium)
        # The box stands on the floor, so that its microphones cannot be checked.
        positions = {microphone.name: positions[microphone.name] for microphone in acoustics.microphone}
    if is_size_known:
        try:
            elements.require_few()
            if limit_hz is not None:
                elements.require_resolved(limit_hz)
        except TriangleSizeError as error:
            yield unwrapped(acoustics, edge, error)
    yield from microphone_findings(acoustics, positions, elements.require_in_air)


def unwrapped(acoustics: Acoustics, edge: float, error: HousingError) -> Finding:
    """Return the finding of a housing that triangles of an edge [m] do not wrap."""
    if isinstance(error, TriangleSizeError):
        return Finding(_PART, "mesh_size", edge, f"an edge that suits the housing and its frequencies; {error}")
    return Finding(_PART, "", acoustics.method, f"a housing that can be wrapped; {error}")


def _elements_on(surface: RadiatingSurface, acoustics: Acoustics, edge: float) -> BoundaryElements | None:
    """Return the boundary elements of a wrap on or above its floor, if any; None where it cannot stand there."""
    floor = acoustics.floor_plane
    try:
        standing = surface if floor is None else set_down(surface, floor, edge)
        return BoundaryElements(standing, acoustics.medium, floor)
    except HousingError:
        return None
