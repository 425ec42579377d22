"""Change of a housing by one parameter: derivatives of its model and of the ports of bearings and sensors."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.housing.fem.surface import flat_faces
from gearwhine.housing.updating.sensitivities import ModelSensitivity
from gearwhine.housing.updating.static_sensitivity import PortRates, StaticSensitivity
from gearwhine.meshes import Mesh
from gearwhine.meshes.box.morph import with_middles
from gearwhine.numerics.arrays import FloatArray

_LEAST_FACE = 0.01  # part of the whole surface from which a flat face is a parameter


@dataclass(frozen=True, eq=False)
class HousingChange:
    """Change of a housing by one parameter.

    Derivatives are by the parameter's coordinate: z of :class:`gearwhine.housing.updating.Parameter` for a fitted
    number, and the shift along the normal [m] for a face.

    Attributes
    ----------
    parameter : str
    kind : str
        ``housing`` or ``face``.
    rate : ModelSensitivity
        Derivative of the housing's model.
    bearings, sensors : mapping of str to scipy.sparse.csr_array
        Derivatives of the ports of bearings and of sensors; empty where they stay.
    slope : float
        Derivative of the parameter [SI] by its coordinate; 1 of a face.
    reference : float or None
        Value that the parameter's relative steps refer to [SI]; None of a length, whose steps are lengths.
    thickness : float or None
        Thickness of a wall [m], infinite of a face, whose wall is not known; None of other parameters.
    """

    parameter: str
    kind: str
    rate: ModelSensitivity
    bearings: PortRates
    sensors: PortRates
    slope: float
    reference: float | None
    thickness: float | None


def slopes_of(changes: Sequence[HousingChange]) -> FloatArray:
    """Return the derivatives of parameters by their coordinates [SI], shape (n_parameters,)."""
    return np.array([change.slope for change in changes])


def by_changes(fields: StaticSensitivity, changes: Sequence[HousingChange]) -> FloatArray:
    """Differentiate each outcome by the parameters of changes [outcome/SI], shape (n_adjoints, n_parameters)."""
    by_coordinates = fields.by_parameters([change.rate for change in changes], [change.bearings for change in changes])
    return np.asarray(by_coordinates / slopes_of(changes))


def face_changes(mesh: Mesh, seats: Sequence[str]) -> tuple[HousingChange, ...]:
    """Differentiate the model of a housing by material on the large flat faces of its surface.

    A face moves along its normal with the layer of elements on it; seats and fixtures stay. It is named as
    :func:`gearwhine.housing.fem.surface.flat_face_names` has it, such as ``inside of bottom at 0, 10, 0 mm``.

    Parameters
    ----------
    mesh : Mesh
    seats : sequence of str
        Names of the bearing seats' surfaces.
    """
    surfaces = [mesh.surface(seat) for seat in seats]
    held_nodes = np.unique(
        np.concatenate([block.nodes.ravel() for surface in surfaces for block in surface] or [np.empty(0, int)])
    )
    faces = flat_faces(mesh)
    whole = sum(face.area for face in faces)
    changes = []
    for face in faces:
        if face.area < _LEAST_FACE * whole:
            continue
        velocity = np.zeros_like(mesh.points)
        velocity[np.unique(np.concatenate([block.corners.ravel() for block in face.facets]))] = face.normal
        velocity[held_nodes] = 0.0
        rate = ModelSensitivity(with_middles(mesh, velocity))
        changes.append(HousingChange(face.name, "face", rate, {}, {}, slope=1.0, reference=None, thickness=math.inf))
    return tuple(changes)
