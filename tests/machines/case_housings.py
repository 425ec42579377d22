"""Meshes, descriptions and components of the housings of cases."""

from gearwhine.case import Case
from gearwhine.case.model import housing_table
from gearwhine.coupling.machine.components import HousingComponent, component_of_housing
from gearwhine.from_case.housing import describe_housing
from gearwhine.from_case.mesh import build_mesh, materials_of
from gearwhine.housing import Housing, HousingModes, Material
from gearwhine.meshes import Mesh


def mesh_of(case: Case, *, order: int = 2) -> Mesh:
    return build_mesh(housing_table(case, "mesh"), case.material, case.input_files, order=order)


def materials_on(case: Case, mesh: Mesh) -> tuple[Mesh, Material, dict[str, Material]]:
    return materials_of(housing_table(case, "mesh"), case.material, mesh)


def described_housing(case: Case, mesh: Mesh) -> Housing:
    return describe_housing(housing_table(case, "mesh"), case.material, mesh)


def full_component(case: Case, housing: HousingModes) -> HousingComponent:
    """Return the housing with all its residual modes, and no coarser one."""
    operation = case.operation
    moves = operation is not None and (operation.base is not None or operation.gravity is not None)
    return component_of_housing(housing, participates=moves, with_coarser=False)
