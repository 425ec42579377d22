"""Housing of a case with what of the rest of the case enters its solution, and the content key of its modes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import gearwhine
from gearwhine.case import Case, Housing, Material
from gearwhine.case.input_files import InputFiles
from gearwhine.case.model import housing_table
from gearwhine.from_case.housing import bearing_places, upwards
from gearwhine.housing.housing import RESPONSE_ORDERS
from gearwhine.housing.storage.mesh_arrays import mesh_digest
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.meshes import Mesh
from gearwhine.numerics.source_digest import installed, source_digest
from gearwhine.output.files import texts_in, with_contents

# Keys of [housing] that change no mode: damping is laid on the modes, sensors are put on the cached mesh afresh.
_WITHOUT_EFFECT = frozenset({"damping_ratio", "sensor"})
MODES_CODE = (
    "gearwhine.numerics",
    "gearwhine.meshes",
    "gearwhine.housing.errors",
    "gearwhine.housing.housing",
    "gearwhine.housing.material",
    "gearwhine.housing.mesh_refinement",
    "gearwhine.housing.fem",
    "gearwhine.housing.model",
    "gearwhine.housing.model_warnings",
    "gearwhine.housing.modes",
    "gearwhine.housing.storage",
    "gearwhine.case",
    "gearwhine.from_case.fixtures",
    "gearwhine.from_case.given_housing",
    "gearwhine.from_case.housing",
    "gearwhine.from_case.mesh",
    "gearwhine.from_case.mesh_health",
    "gearwhine.solve.housing_modes",
)
"""Code that the modes are solved by: a change of any other, such as that of figures, leaves them cached."""
_LIBRARIES = ("gmsh", "numpy", "scipy", "scikit-fem", "rslab")


@dataclass(frozen=True)
class GivenHousing:
    """The housing of a case, and what of the rest of the case enters its solution.

    Attributes
    ----------
    table : gearwhine.case.Housing
    materials : mapping of str to gearwhine.case.Material
        Materials of the case.
    files : InputFiles
        Files that the case names.
    bearings : mapping of str to (str, float)
        Places of the bearings, see :func:`gearwhine.from_case.housing.bearing_places`.
    up : tuple of float
        Unit vector that points upwards in pictures.
    """

    table: Housing
    materials: Mapping[str, Material]
    files: InputFiles
    bearings: Mapping[str, tuple[str, float]]
    up: tuple[float, float, float]

    def cache_inputs(self, mesh: Mesh | None = None) -> dict[str, Any]:
        """Return the inputs of the modes; their content key is that of the modes.

        Parameters
        ----------
        mesh : Mesh, optional
            Mesh of ``[housing.mesh]``: its content counts, not the name or the format of its file.
        """
        files = dict(self.files.contents)
        if self.table.mesh is not None and mesh is not None:
            files[str(self.table.mesh.file)] = {"mesh": mesh_digest(mesh)}
        written = self.table.model_dump(mode="json", by_alias=True, exclude_none=True, exclude=set(_WITHOUT_EFFECT))
        named = texts_in(written)
        return {
            "housing": with_contents(written, files),
            "bearings": {name: list(place) for name, place in self.bearings.items()},
            "attachment_orders": RESPONSE_ORDERS,
            "material": {
                name: material.model_dump(mode="json") for name, material in self.materials.items() if name in named
            },
            "versions": {"gearwhine": gearwhine.__version__} | {name: installed(name) for name in _LIBRARIES},
            "source": source_digest(*MODES_CODE),
        }


def given_housing(case: Case, command: str = "modes") -> GivenHousing:
    """Return the housing of a case with what enters its solution.

    Raises
    ------
    CaseError
        Where the case has no housing, which ``command`` needs.
    """
    table = housing_table(case, command)
    gravity = None if case.operation is None else case.operation.gravity
    places = bearing_places(table.seat, case.bearing, case.rotor)
    return GivenHousing(table, case.material, case.input_files, places, upwards(table, gravity))


def housing_key(given: GivenHousing) -> str:
    """Return the content key of all that a machine takes of its solved housing: modes, damping, seats and sensors."""
    return content_key({"modes": content_key(given.cache_inputs()), "housing": given.table.model_dump(mode="json")})
