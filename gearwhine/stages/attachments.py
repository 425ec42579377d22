"""What is fastened to a case's housing, as the housing room's; and whether it fits the mesh."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

import housing as room
from gearwhine.case import (
    AxialDashpots,
    AxialSprings,
    Bushing,
    Case,
    CaseError,
    Joint,
    LumpedMass,
    Mount,
    Patch,
    Problem,
    Support,
    amounts,
    did_you_mean,
)
from gearwhine.case.directions import unit_vector
from gearwhine.case.problems import UNSAID
from gearwhine.stages.geometry import cover_joints
from meshes import GeometryError, Mesh

FloatArray = npt.NDArray[np.float64]

_REACH = 0.05  # farthest that what sits on the surface may be given from it, as a part of the housing's diagonal


def build_supports(case: Case) -> list[room.Support]:
    """The supports of a case, in the order of the file."""
    assert case.housing is not None
    return [_support(entry) for entry in case.housing.support]


def build_attachments(case: Case) -> Iterator[tuple[str, str, room.Attachment]]:
    """All that is fastened, each with its key and label."""
    given = case.housing
    assert given is not None
    for index, support in enumerate(given.support):
        yield f"housing.support[{index}]", f'support "{support.name}"', _support(support)
    for index, mount in enumerate(given.mount):
        fastened = room.Mount(mount.name, _patch(mount), _bushing(mount), mount.center)
        yield f"housing.mount[{index}]", f'mount "{mount.name}"', fastened
    for index, joint in enumerate(given.joint):
        first, second = _ends(joint)
        tied = room.Joint(joint.name, first, second, _bushing(joint), joint.center)
        yield f"housing.joint[{index}]", f'joint "{joint.name}"', tied
    for tied in cover_joints(case):
        yield "housing.box.cover.bolts", tied.name, tied
    for index, mass in enumerate(given.mass):
        yield f"housing.mass[{index}]", f'mass "{mass.name}"', _mass(mass)


def check_places(case: Case, mesh: Mesh) -> None:
    """See that all that is fastened to a case's housing, and every sensor, finds its place on the mesh.

    Raises
    ------
    CaseError
        With every one that does not.
    """
    given = case.housing
    assert given is not None
    problems = list(_misplaced(case, mesh))
    for index, sensor in enumerate(given.sensor):
        found = room.sensor_port(mesh, room.Sensor(sensor.name, sensor.position, sensor.unit_vector)).position
        key, label = f"housing.sensor[{index}].position", f'sensor "{sensor.name}"'
        problems += _check_reach(mesh, key, label, sensor.position, found)
    if problems:
        raise CaseError(problems)


def attach_all(case: Case, mesh: Mesh, free: room.Matrices) -> room.Matrices:
    """The free housing's matrices with supports, mounts, joints and masses of a case on it.

    Raises
    ------
    CaseError
        With every one of them that does not fit the mesh.
    """
    problems: list[Problem] = []
    additions = room.Additions()
    for key, label, attachment in build_attachments(case):
        try:
            additions += attachment.additions(mesh)
        except (room.HousingError, GeometryError) as error:
            problems.append(Problem(key, UNSAID, f"what fits the mesh; {error}", label=label))
    if problems:
        raise CaseError(problems)
    return free.plus(additions)


def _check_reach(
    mesh: Mesh, key: str, label: str, asked: tuple[float, float, float], found: FloatArray
) -> Iterator[Problem]:
    """Yield a place that is not meant to be on the surface, rather than move it far."""
    reach = _REACH * float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
    if np.linalg.norm(found - asked) > reach:
        given, nearest = (
            ", ".join(f"{round(1e3 * value, 3) + 0.0:.6g}" for value in place) for place in (asked, found)
        )
        expected = (
            f"a place within {1e3 * reach:.3g} mm of the surface; ({given}) mm is not, the nearest point of it is "
            f"({nearest}) mm"
        )
        yield Problem(key, UNSAID, expected, label=label)


def _misplaced(case: Case, mesh: Mesh) -> Iterator[Problem]:
    """Surfaces that the mesh does not have, boxes without surface, points off the surface."""
    given = case.housing
    assert given is not None
    named: list[tuple[str, str, str]] = []
    fastened: list[tuple[str, int, Support | Mount | LumpedMass]] = []
    fastened += [("support", index, entry) for index, entry in enumerate(given.support)]
    fastened += [("mount", index, entry) for index, entry in enumerate(given.mount)]
    fastened += [("mass", index, entry) for index, entry in enumerate(given.mass)]
    for kind, index, entry in fastened:
        key, label = f"housing.{kind}[{index}]", f'{kind} "{entry.name}"'
        if entry.surface is not None:
            named.append((f"{key}.surface", label, entry.surface))
        elif entry.box is not None or entry.plane is not None:
            form, holds = ("box", "holds") if entry.plane is None else ("plane", "bears")
            try:
                _patch(entry).facets(mesh)
            except GeometryError as error:
                yield Problem(
                    f"{key}.{form}", UNSAID, f"a {form} that {holds} some of the surface; {error}", label=label
                )
    for index, joint in enumerate(given.joint):
        for end, surface in enumerate(joint.surfaces or ()):
            named.append((f"housing.joint[{index}].surfaces[{end}]", f'joint "{joint.name}"', surface))
    known = sorted(mesh.surfaces)
    for key, label, surface in named:
        if surface not in mesh.surfaces:
            listed = ", ".join(known[:20]) + (", …" if len(known) > 20 else "")
            expected = f"a surface of the mesh ({listed or 'it names none'})" + did_you_mean(surface, known)
            yield Problem(key, surface, expected, label=label)
    for index, mass in enumerate(given.mass):
        if mass.position is not None:
            found = _mass(mass).place(mesh).position
            label = f'mass "{mass.name}"'
            yield from _check_reach(mesh, f"housing.mass[{index}].position", label, mass.position, found)


def _ends(joint: Joint) -> tuple[room.Patch, room.Patch]:
    """The two patches of a joint: named, or circles on the faces that look along its axis and against it."""
    if joint.surfaces is not None:
        first, second = joint.surfaces
        return room.Patch(first), room.Patch(second)
    assert joint.center is not None
    assert joint.axis is not None
    assert joint.diameter is not None
    x, y, z = unit_vector(joint.axis)
    return (
        room.Patch(circle=(joint.center, (x, y, z), joint.diameter)),
        room.Patch(circle=(joint.center, (-x, -y, -z), joint.diameter)),
    )


def _patch(entry: Patch) -> room.Patch:
    return room.Patch(entry.surface, entry.corners, entry.point_and_normal)


def _support(entry: Support) -> room.Support:
    springs, dashpots, fixed = entry.stiffness, entry.damping, entry.fixed or ()
    return room.Support(
        name=entry.name,
        surface=entry.surface,
        box=entry.corners,
        plane=entry.point_and_normal,
        fixed=("x" in fixed, "y" in fixed, "z" in fixed),
        stiffness=(springs.x, springs.y, springs.z) if springs else (0.0, 0.0, 0.0),
        damping=(dashpots.x, dashpots.y, dashpots.z) if dashpots else (0.0, 0.0, 0.0),
    )


def _bushing(entry: Bushing) -> room.Bushing:
    springs, dashpots = entry.stiffness, entry.damping
    if entry.axis is not None:
        along = [
            room.Axial(*amounts(table)) if isinstance(table, AxialSprings | AxialDashpots) else room.Axial()
            for table in (springs, dashpots)
        ]
        return room.Bushing.along(unit_vector(entry.axis), *along)
    own = entry.own_axes
    axes = room.GLOBAL_AXES if own is None else room.axes_along(*own)
    nothing = (0.0,) * 6
    stiffness, damping = (nothing if table is None else amounts(table) for table in (springs, dashpots))
    return room.Bushing(_six(stiffness), _six(damping), axes)


def _six(values: tuple[float, ...]) -> tuple[float, float, float, float, float, float]:
    x, y, z, rx, ry, rz = values
    return x, y, z, rx, ry, rz


def _mass(entry: LumpedMass) -> room.LumpedMass:
    return room.LumpedMass(
        name=entry.name,
        mass=entry.mass,
        patch=None if entry.position is not None else _patch(entry),
        position=entry.position,
        inertia=entry.inertia.rows if entry.inertia else room.NO_INERTIA,
        offset=entry.offset or (0.0, 0.0, 0.0),
    )
