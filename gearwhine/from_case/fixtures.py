"""Fixtures of a case's housing on its mesh: supports, mounts, joints, masses, sensors; and their places."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from gearwhine.case import CaseError, Housing, Joint, LumpedMass, Material, Mount, Problem, Support
from gearwhine.case.errors import UNSAID
from gearwhine.from_case.mesh import cover_joints
from gearwhine.housing import HousingError
from gearwhine.housing.model.fixtures import Fixture
from gearwhine.housing.model.seats import sensor_port
from gearwhine.meshes import GeometryError, Mesh
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.names import one_of

_REACH = 0.05  # largest distance of a fixture or sensor from the surface, as a part of the housing's diagonal


def build_fixtures(table: Housing, materials: Mapping[str, Material]) -> list[Fixture]:
    """Build the supports, mounts, joints, bolts of the cover and masses of a housing."""
    return [
        *(support.build() for support in table.support),
        *(mount.build() for mount in table.mount),
        *(joint.build() for joint in table.joint),
        *cover_joints(table, materials),
        *(mass.build() for mass in table.mass),
    ]


def fixture_problems(table: Housing, error: HousingError) -> list[Problem]:
    """Return the findings of fixtures that do not fit the mesh as problems of their keys."""
    entries: dict[str, Sequence[Support | Mount | Joint | LumpedMass]] = {
        "support": table.support,
        "mount": table.mount,
        "joint": table.joint,
        "mass": table.mass,
    }
    problems = []
    for finding in error.findings:
        kind, name = finding.part
        index = next((place for place, entry in enumerate(entries.get(kind, ())) if entry.name == name), None)
        key, label = (
            ("housing.box.cover.bolts", name) if index is None else (f"housing.{kind}[{index}]", f'{kind} "{name}"')
        )
        problems.append(Problem(key, UNSAID, finding.expected, label=label))
    return problems


def check_places(table: Housing, mesh: Mesh) -> None:
    """Require a place on the mesh for every fixture and sensor of a housing.

    Raises
    ------
    CaseError
        With every one that has no place.
    """
    problems = list(_misplaced(table, mesh))
    for index, sensor in enumerate(table.sensor):
        nearest = sensor_port(mesh, sensor.build()).position
        key, label = f"housing.sensor[{index}].position", f'sensor "{sensor.name}"'
        problems += _check_reach(mesh, key, label, sensor.position, nearest)
    if problems:
        raise CaseError(problems)


def _check_reach(
    mesh: Mesh, key: str, label: str, position: tuple[float, float, float], nearest: FloatArray
) -> Iterator[Problem]:
    """Yield a problem for a position far from the surface, rather than move it there."""
    reach = _REACH * float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
    if np.linalg.norm(nearest - position) > reach:
        given_text, nearest_text = (
            ", ".join(f"{round(1e3 * value, 3) + 0.0:.6g}" for value in place) for place in (position, nearest)
        )
        expected = (
            f"a place within {1e3 * reach:.3g} mm of the surface; ({given_text}) mm is not, the nearest point of it is "
            f"({nearest_text}) mm"
        )
        yield Problem(key, UNSAID, expected, label=label)


def _misplaced(table: Housing, mesh: Mesh) -> Iterator[Problem]:
    """Yield problems of surfaces that the mesh does not have, boxes without surface, and points off the surface."""
    named: list[tuple[str, str, str]] = []
    fastened: list[tuple[str, int, Support | Mount | LumpedMass]] = []
    fastened += [("support", index, entry) for index, entry in enumerate(table.support)]
    fastened += [("mount", index, entry) for index, entry in enumerate(table.mount)]
    fastened += [("mass", index, entry) for index, entry in enumerate(table.mass)]
    for kind, index, entry in fastened:
        key, label = f"housing.{kind}[{index}]", f'{kind} "{entry.name}"'
        if entry.surface is not None:
            named.append((f"{key}.surface", label, entry.surface))
        elif entry.box is not None or entry.plane is not None:
            form, holds = ("box", "holds") if entry.plane is None else ("plane", "bears")
            try:
                entry.build_patch().facets(mesh)
            except GeometryError as error:
                yield Problem(
                    f"{key}.{form}", UNSAID, f"a {form} that {holds} some of the surface; {error}", label=label
                )
    for index, joint in enumerate(table.joint):
        for end, surface in enumerate(joint.surfaces or ()):
            named.append((f"housing.joint[{index}].surfaces[{end}]", f'joint "{joint.name}"', surface))
    surfaces = sorted(mesh.surfaces)
    for key, label, surface in named:
        if surface not in mesh.surfaces:
            yield Problem(key, surface, one_of("a surface of the mesh", surface, surfaces), label=label)
    for index, mass in enumerate(table.mass):
        if mass.position is not None:
            nearest = mass.build().place(mesh).position
            label = f'mass "{mass.name}"'
            yield from _check_reach(mesh, f"housing.mass[{index}].position", label, mass.position, nearest)
