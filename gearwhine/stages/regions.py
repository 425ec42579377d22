"""Material regions of a case's mesh: the material of each element."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

import housing as room
from gearwhine.case import Case, CaseError, Problem
from gearwhine.case.problems import did_you_mean
from gearwhine.case.region import Region
from gearwhine.stages.geometry import material_of
from meshes import Mesh


def materials_of(case: Case, mesh: Mesh) -> tuple[Mesh, room.Material, dict[str, room.Material]]:
    """The mesh with the case's regions as its volumes, the material of the rest, and that of each region.

    Raises
    ------
    CaseError
        Where a region names a volume that the mesh does not have, holds no element, or shares some with another; all
        of them at once.
    """
    given = case.housing
    assert given is not None
    rest = material_of(case, given.material)
    if not given.region:
        return mesh, rest, {}
    problems: list[Problem] = []
    members: dict[str, npt.NDArray[np.int64]] = {}
    taken = np.full(mesh.n_elements, -1)
    for index, region in enumerate(given.region):
        elements = _elements(mesh, index, region, problems)
        other = np.unique(taken[elements])
        for rival in other[other >= 0].tolist():
            count = int(np.count_nonzero(taken[elements] == rival))
            expected = (
                f'elements of its own ({count} of its {len(elements)} are in region "{given.region[rival].name}" too)'
            )
            problems.append(_problem(index, region, expected))
        taken[elements] = index
        members[region.name] = elements
    if problems:
        raise CaseError(problems)
    materials = {region.name: material_of(case, region.material) for region in given.region}
    return replace(mesh, volumes=members), rest, materials


def _elements(mesh: Mesh, index: int, region: Region, problems: list[Problem]) -> npt.NDArray[np.int64]:
    if region.volume is not None:
        if region.volume not in mesh.volumes:
            known = sorted(mesh.volumes)
            expected = f"a volume of the mesh ({', '.join(known) or 'it has none'})" + did_you_mean(
                region.volume, known
            )
            problems.append(_problem(index, region, expected))
        return np.asarray(mesh.volumes.get(region.volume, np.empty(0, dtype=np.int64)))
    assert region.box is not None
    low, high = np.sort(np.array(region.box), axis=0)
    elements = np.flatnonzero(((mesh.centers >= low) & (mesh.centers <= high)).all(axis=1))
    if not len(elements):
        span = [f"{1e3 * a:.4g} to {1e3 * b:.4g}" for a, b in mesh.bounds.T]
        expected = f"a box with the middle of an element in it; the housing spans {' x '.join(span)} mm"
        problems.append(_problem(index, region, expected))
    return elements


def _problem(index: int, region: Region, expected: str) -> Problem:
    key, value = ("volume", region.volume) if region.volume is not None else ("box", region.box)
    return Problem(f"housing.region[{index}].{key}", value, expected, label=f'region "{region.name}"')
