"""Parametric housing: modes at any values of the fitted parameters, and surrogates about solved ones."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import sparse

import housing as room
from gearwhine.case import Case, CaseError
from gearwhine.case.box_shape import box_geometry
from gearwhine.progress import Progress, silent
from gearwhine.stages.attachments import attach_all, build_attachments
from gearwhine.stages.geometry import build_mesh
from gearwhine.stages.regions import materials_of
from gearwhine.stages.update_keys import FittedCase
from housing.material import element_constants
from housing.updating import ModalState, ModelSensitivity, Parameter, Surrogate, modal_sensitivities, values_at
from meshes import BoxGeometry, BoxMorph, GeometryError, Mesh, MorphError, mesh_quality

FloatArray = npt.NDArray[np.float64]

_STEP = 1e-4  # in z, of the differences that give the rates of what a parameter changes
_WORST_SHAPE = 0.12  # shape number below which a moved mesh is given up for a new one


@dataclass(frozen=True)
class ParametricHousing:
    """Solves the housing of a case at coordinates z of its parameters.

    Attributes
    ----------
    case : FittedCase
    modes : int
        Number of modes.
    measured : callable, optional
        From a mesh to the matrix of the degrees of freedom where shapes were measured, shape (n_dofs, 3 n_nodes).
    threads : int
    progress : callable
    draft : bool
        Whether modes go without their proof, which on a search's way they may (:func:`housing.solve_modes`).
    as_written : bool
        Whether values are rounded as an updated case has them, so that the design solved is the one written: where the
        last digits differ the mesher may well go another way, and frequencies with it by some 0.03 %.
    """

    case: FittedCase
    modes: int
    measured: Callable[[Mesh], sparse.csr_array] | None = None
    threads: int = 2
    progress: Progress = silent
    draft: bool = False
    as_written: bool = False

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Fitted parameters."""
        return tuple(number.parameter for number in self.case.numbers)

    @property
    def start(self) -> FloatArray:
        """z of the case as it stands."""
        return np.array([number.parameter.coordinate(number.start) for number in self.case.numbers])

    def case_at(self, coordinates: FloatArray) -> Case:
        """The case at coordinates."""
        values = values_at(self.parameters, coordinates).tolist()
        if self.as_written:
            values = [number.as_written(value) for number, value in zip(self.case.numbers, values, strict=True)]
        return self.case.at(values)

    def solve(self, coordinates: FloatArray, near: "HousingAtParameters | None" = None) -> "HousingAtParameters":
        """Solve at coordinates, on the mesh of a neighbour where that can follow, else on a new one.

        Raises
        ------
        housing.HousingError
            Where the values make no sound housing.
        """
        try:
            case = self.case_at(coordinates)
            followed = None if near is None else _followed(near, case)
            if followed is not None:
                try:
                    return self._solved(coordinates, case, followed)
                except room.HousingError:
                    pass  # the move may have folded an element, of which a new mesh knows nothing
            return self._solved(coordinates, case, build_mesh(case))
        except (CaseError, GeometryError) as error:
            raise room.HousingError(str(error)) from error

    def _solved(self, coordinates: FloatArray, case: Case, mesh: Mesh) -> "HousingAtParameters":
        """The case on a mesh of its housing."""
        parted, material, materials = materials_of(case, mesh)
        matrices = attach_all(case, mesh, room.assemble(parted, material, materials, threads=self.threads))
        solved = room.solve_modes(matrices, count=self.modes, draft=self.draft, threads=self.threads)
        given = case.housing
        assert given is not None
        ports = [room.seat_matrix(mesh, seat.build()) for seat in given.seat]
        seats = (
            np.stack([solved.project(port)[:, :2] for port in ports], axis=1)
            if ports
            else np.empty((len(solved.frequencies), 0, 2))
        )
        bounds = None if given.box is None else np.array([given.box.lower, given.box.upper])
        skin = room.survey_grid(mesh, bounds).normal_motion(solved.shapes)
        measured = None if self.measured is None else solved.project(self.measured(mesh))
        state = ModalState(solved.frequencies, seats, skin, measured)
        return HousingAtParameters(self, np.asarray(coordinates), case, mesh, state, solved.shapes)


@dataclass(frozen=True)
class HousingAtParameters:
    """A housing solved at coordinates z.

    Attributes
    ----------
    designs : HousingDesigns
        The parametric housing.
    coordinates : ndarray, shape (n_parameters,)
    case : Case
    mesh : Mesh
    state : housing.updating.ModalState
    shapes : ndarray, shape (n_modes, n_nodes, 3), or None
        Mass-normalised [1/√kg]; None once they are let go.
    known : Surrogate, or None
        Its neighbourhood where that was worked out before.
    """

    designs: ParametricHousing
    coordinates: FloatArray
    case: Case
    mesh: Mesh
    state: ModalState
    shapes: FloatArray | None
    known: Surrogate | None = None

    def surrogate(self) -> Surrogate:
        """Its neighbourhood, by the exact rates of stiffness and mass."""
        return self._surrogate if self.known is None else self.known

    def light(self) -> "HousingAtParameters":
        """The same with its neighbourhood and without its shapes, a twentieth of the size, for another process."""
        return replace(self, shapes=None, known=self.surrogate())

    @cached_property
    def _surrogate(self) -> Surrogate:
        assert self.shapes is not None
        parted, material, materials = materials_of(self.case, self.mesh)
        constants = element_constants(parted, material, materials)
        rates = modal_sensitivities(self.mesh, constants, self.shapes, self.rates())
        return Surrogate.about(self.coordinates, self.state, rates)

    def rates(self) -> list[ModelSensitivity]:
        """Derivatives of the model by each coordinate, by central differences of quantities linear in small steps."""
        return [self._rate(number) for number in range(len(self.coordinates))]

    def _rate(self, number: int) -> ModelSensitivity:
        either = []
        for way in (1.0, -1.0):
            beside = self.coordinates.copy()
            beside[number] += way * _STEP
            # Not by the case's own values, which stop at the end of the range.
            parameter = self.designs.parameters[number]
            values = values_at(self.designs.parameters, self.coordinates)
            values[number] += parameter.deviation(float(self.coordinates[number]), way * _STEP)
            either.append(self.designs.case.at(values.tolist()))
        above, below = either
        velocity = self._velocity(above, below)
        return ModelSensitivity(
            velocity, self._constants_rate(above, below), *self._attached_rates(above, below, velocity)
        )

    def _velocity(self, above: Case, below: Case) -> FloatArray | None:
        geometries = [_geometry(case) for case in (above, below)]
        if geometries[0] == geometries[1]:
            return None
        assert geometries[0] is not None
        assert geometries[1] is not None
        apart = self._morph.displacement(geometries[0]) - self._morph.displacement(geometries[1])
        return np.asarray(apart / (2.0 * _STEP))

    @cached_property
    def _morph(self) -> BoxMorph:
        geometry = _geometry(self.case)
        assert geometry is not None
        return BoxMorph(self.mesh, geometry)

    def _constants_rate(self, above: Case, below: Case) -> FloatArray | None:
        if above.material == below.material:
            return None
        constants = []
        for case in (above, below):
            parted, material, materials = materials_of(case, self.mesh)
            constants.append(element_constants(parted, material, materials))
        return np.asarray((constants[0] - constants[1]) / (2.0 * _STEP))

    def _attached_rates(
        self, above: Case, below: Case, velocity: FloatArray | None
    ) -> tuple[sparse.csr_array | None, sparse.csr_array | None]:
        assert above.housing is not None
        assert below.housing is not None
        same = all(
            getattr(above.housing, key) == getattr(below.housing, key) for key in ("support", "mount", "joint", "mass")
        )
        if same and velocity is None:
            return None, None
        matrices = []
        for case, way in ((above, 1.0), (below, -1.0)):
            mesh = self.mesh
            if velocity is not None:
                mesh = replace(mesh, points=mesh.points + way * _STEP * velocity)
            total = sum((attachment.additions(mesh) for *_, attachment in build_attachments(case)), room.Additions())
            n = len(mesh.points)
            matrices.append((total.stiffness.matrix(n), total.mass.matrix(n)))
        stiffness, mass = ((one - other) / (2.0 * _STEP) for one, other in zip(*matrices, strict=True))
        return sparse.csr_array(stiffness), sparse.csr_array(mass)


def _geometry(case: Case) -> BoxGeometry | None:
    given = case.housing
    assert given is not None
    return None if given.box is None else box_geometry(given.box, given.seat)


def _followed(near: HousingAtParameters, case: Case) -> Mesh | None:
    """The neighbour's mesh, moved to a case's geometry; None where it cannot or should not be."""
    geometry, before = _geometry(case), _geometry(near.case)
    if geometry is None or geometry == before:
        return near.mesh
    try:
        mesh = near._morph.moved(geometry)
    except MorphError:
        return None
    return mesh if mesh_quality(mesh).shape[0] > _WORST_SHAPE else None
