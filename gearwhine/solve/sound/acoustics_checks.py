"""Checks of a case's `[acoustics]` before its modes are known: radiating surface, floor and microphones.

:func:`require_acoustics` wraps the housing as the solution will and finds every microphone that is not in the air,
triangles that are too large, and a floor above the soles, so that none of them ends a command after the long work.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, CaseError, Problem
from gearwhine.case.acoustics import Acoustics
from gearwhine.case.errors import one_of
from gearwhine.housing import HousingError
from gearwhine.housing.acoustics.boundary_elements import BoundaryElements
from gearwhine.housing.acoustics.medium import HardPlane, Medium
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.acoustics.radiation import coarsest_edge, set_down, wrapped
from gearwhine.housing.acoustics.sound_levels import measurement_box
from gearwhine.housing.acoustics.surface_velocity import face_surface
from gearwhine.housing.errors import TriangleSizeError
from gearwhine.housing.fem.surface import FlatFace, flat_faces
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import pick_facets
from gearwhine.numerics.findings import in_mm
from gearwhine.numerics.result_warnings import warning

FloatArray = npt.NDArray[np.float64]

_HOLES = 1.1  # diameter of holes that are closed by default, over that of the widest seat
_COARSE = 20.0  # triangles along the housing where the case gives neither their size nor a frequency
_DEEP = 20.0  # depth of a floor below the housing above which it is doubtful, in sizes of the housing
_FAR = 200.0  # distance of a microphone above which it is doubtful, in sizes of the housing
_IN_METRES = "a number without a unit is in m"


def highest_known_frequency(case: Case) -> float | None:
    """Return the highest frequency of a case's sound as far as the case gives it [Hz]."""
    assert case.acoustics is not None
    limit = None if case.housing is None else case.housing.frequency_limit
    return case.acoustics.highest_frequency or limit


def wrap_settings(case: Case, limit_hz: float) -> tuple[float, float, HardPlane | None]:
    """Return the edge of the triangles and the diameter of the holes that are closed [m], and the floor.

    Parameters
    ----------
    case : Case
        Case with `[acoustics]`.
    limit_hz : float
        Highest frequency of the sound [Hz].
    """
    acoustics = case.acoustics
    assert acoustics is not None
    edge = acoustics.mesh_size or acoustics.speed_of_sound / (6.0 * limit_hz)
    seats = [seat.diameter for seat in case.housing.seat if seat.diameter] if case.housing is not None else []
    holes = acoustics.close_holes or _HOLES * max(seats, default=edge)
    floor = (
        None if acoustics.floor is None else HardPlane(np.array([0.0, acoustics.floor, 0.0]), np.array([0.0, 1.0, 0.0]))
    )
    return edge, holes, floor


def surface_names(case: Case, mesh: Mesh) -> list[Problem]:
    """Return the names of surfaces in `[acoustics]` that the housing does not have."""
    surfaces = tuple(mesh.surfaces)
    return [
        Problem(
            f"acoustics.{key}[{place}]",
            name,
            one_of("a surface of the housing", name, surfaces),
        )
        for key in ("still", "faces")
        for place, name in enumerate(getattr(case.acoustics, key))
        if name not in surfaces
    ]


def flat_face(mesh: Mesh, name: str, place: int) -> FlatFace:
    """Return a surface of a mesh as a flat face; ``place`` is its number in the case.

    Raises
    ------
    CaseError
        Where it is not flat.
    """
    surface = mesh.surfaces[name]
    wanted_facets = {tuple(sorted(nodes)) for block in surface for nodes in block.nodes.tolist()}
    for face in flat_faces(mesh):
        face_facets = [tuple(sorted(nodes)) for block in face.facets for nodes in block.nodes.tolist()]
        if wanted_facets & set(face_facets):
            chosen = np.array([nodes in wanted_facets for nodes in face_facets])
            if len(wanted_facets) > chosen.sum():
                break
            return replace(face, facets=pick_facets(face.facets, chosen))
    raise CaseError([Problem(f"acoustics.faces[{place}]", name, "a flat surface, for Rayleigh's integral")])


def microphones_of(case: Case, mesh: Mesh) -> tuple[dict[str, FloatArray], float | None]:
    """Positions of a case's microphones [m], and the area of the box that the last nine stand on [m²]."""
    assert case.acoustics is not None
    microphones = {microphone.name: np.array(microphone.position) for microphone in case.acoustics.microphone}
    if case.acoustics.microphone_box is None:
        return microphones, None
    assert case.acoustics.floor is not None
    low, high = (np.array(corner) for corner in mesh.bounds)
    low[1] = case.acoustics.floor
    positions, area = measurement_box(low, high, case.acoustics.microphone_box)
    return microphones | {f"box {number}": place for number, place in enumerate(positions, start=1)}, area


def microphone_problems(
    case: Case, positions: Mapping[str, FloatArray], require_in_air: Callable[[FloatArray], None]
) -> Iterator[Problem]:
    """Yield the microphones at which the sound pressure cannot be found.

    Parameters
    ----------
    case : Case
    positions : mapping of str to ndarray, shape (3,)
        Positions of :func:`microphones_of` [m].
    require_in_air : callable
        Raises `HousingError` where points, shape (n, 3), are not in the air.
    """
    assert case.acoustics is not None
    in_case = len(case.acoustics.microphone)
    for number, (name, place) in enumerate(positions.items()):
        try:
            require_in_air(place[None])
        except HousingError as error:
            if number < in_case:
                key = f'acoustics.microphone[{number}].position (microphone "{name}")'
                value = ", ".join(map(in_mm, place.tolist()))
                yield Problem(key, value, f"a point in the air; {error}")
            else:
                expected = f"a distance at which microphone {name!r} is in the air; {error}"
                yield Problem("acoustics.microphone_box", in_mm(case.acoustics.microphone_box or 0.0), expected)


def require_acoustics(case: Case, mesh: Mesh) -> None:
    """Refuse a radiating surface or microphones that cannot be, before the modes are solved.

    Parameters
    ----------
    case : Case
        Case; without `[acoustics]` there is nothing to refuse.
    mesh : Mesh
        Mesh of its housing; straight elements suffice.

    Raises
    ------
    CaseError
        With everything that is wrong.
    """
    if case.acoustics is None:
        return
    problems = surface_names(case, mesh)
    if case.acoustics.method == "rayleigh":
        problems += _face_problems(case, mesh) if not problems else []
    elif case.acoustics.method == "boundary-elements":
        problems += _surface_problems(case, case.acoustics, mesh)
    if problems:
        raise CaseError(problems)


def acoustics_warnings(case: Case, bounds: FloatArray, limit_hz: float | None) -> list[dict[str, Any]]:
    """Return warnings about values of `[acoustics]` that are allowed but implausible.

    Parameters
    ----------
    case : Case
        Case; without `[acoustics]` there is no warning.
    bounds : ndarray, shape (2, 3)
        Lowest and highest corner of the housing [m].
    limit_hz : float or None
        Frequency up to which its modes are complete, where that is known [Hz].
    """
    acoustics = case.acoustics
    if acoustics is None:
        return []
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


def _face_problems(case: Case, mesh: Mesh) -> list[Problem]:
    """Return faces that are not flat, and microphones that are not in front of the one that there is."""
    assert case.acoustics is not None
    problems, faces = list[Problem](), list[FlatFace]()
    for place, name in enumerate(case.acoustics.faces):
        try:
            faces.append(flat_face(mesh, name, place))
        except CaseError as error:
            problems += error.problems
    limit = highest_known_frequency(case)
    for place, face in enumerate(faces if limit is not None and not problems else ()):
        assert limit is not None
        # Straight elements stand for curved ones, whose middle nodes halve their edges.
        straight = all(block.nodes.shape == block.corners.shape for block in face.facets)
        try:
            _face_elements(case.acoustics, mesh, face).require_resolved(limit, elements=1.5 if straight else 3.0)
        except TriangleSizeError as error:
            expected = f"a face of smaller elements, whose sides are the triangles of 'rayleigh'; {error}"
            problems.append(Problem(f"acoustics.faces[{place}]", case.acoustics.faces[place], expected))
    positions, _ = microphones_of(case, mesh)
    if len(faces) == 1 and positions:
        problems += microphone_problems(case, positions, _face_elements(case.acoustics, mesh, faces[0]).require_in_air)
    return problems


def _face_elements(acoustics: Acoustics, mesh: Mesh, face: FlatFace) -> BoundaryElements:
    surface, _ = face_surface(mesh, face.facets)
    return BoundaryElements(surface, _medium(acoustics), HardPlane(face.center, face.normal))


def _surface_problems(case: Case, acoustics: Acoustics, mesh: Mesh) -> Iterator[Problem]:
    """Yield the problems of the wrap of boundary elements, the floor and the microphones."""
    limit = highest_known_frequency(case)
    coarse = float(np.ptp(mesh.bounds, axis=0).max()) / _COARSE
    is_size_known = acoustics.mesh_size is not None or limit is not None
    edge, holes, floor = wrap_settings(case, limit or acoustics.speed_of_sound / (6.0 * coarse))
    written = f"{1e3 * edge:.4g} mm"
    longest = coarsest_edge(mesh)
    if acoustics.mesh_size is not None and edge > longest:
        expected = f"an edge of at most {in_mm(longest)}, three along the shortest side of the housing"
        yield Problem("acoustics.mesh_size", written, expected)
        return
    try:
        surface = wrapped(mesh, edge, holes)
    except TriangleSizeError as error:
        yield Problem("acoustics.mesh_size", written, f"another edge; {error}")
        return
    except HousingError as error:
        yield Problem("acoustics", acoustics.method, f"a housing that can be wrapped; {error}")
        return
    elements = _elements_on(surface, acoustics, edge, floor)
    positions, _ = microphones_of(case, mesh)
    if elements is None:
        lowest = in_mm(float(mesh.bounds[0, 1]))
        yield Problem("acoustics.floor", in_mm(acoustics.floor or 0.0), f"a height at or below the soles, y = {lowest}")
        elements = BoundaryElements(surface, _medium(acoustics))
        # The box stands on the floor, so that its microphones cannot be checked.
        positions = {microphone.name: positions[microphone.name] for microphone in acoustics.microphone}
    if is_size_known:
        try:
            elements.require_few()
            if limit is not None:
                elements.require_resolved(limit)
        except TriangleSizeError as error:
            yield Problem("acoustics.mesh_size", written, f"another edge; {error}")
    yield from microphone_problems(case, positions, elements.require_in_air)


def _elements_on(
    surface: RadiatingSurface, acoustics: Acoustics, edge: float, floor: HardPlane | None
) -> BoundaryElements | None:
    """Return the boundary elements of a wrap on or above its floor, if any; None where it cannot stand there."""
    try:
        standing = surface if floor is None else set_down(surface, floor, edge)
        return BoundaryElements(standing, _medium(acoustics), floor)
    except HousingError:
        return None


def _medium(acoustics: Acoustics) -> Medium:
    return Medium(acoustics.density, acoustics.speed_of_sound)
