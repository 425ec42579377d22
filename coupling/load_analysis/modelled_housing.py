"""Housing with its finite-element model and its modes, by which gradients of walls and lines are taken."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.coupling.machine.components import HousingComponent, SensorPlace, housing_component
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.coupling.statics.sensitivity import Adjoint
from gearwhine.housing import Housing, HousingModes, ModeSet, modal_damping
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.housing import bearing_port
from gearwhine.housing.material import element_constants
from gearwhine.housing.model.seats import SensorPort
from gearwhine.housing.modes.housing_field import HousingField
from gearwhine.housing.updating.static_sensitivity import StaticSensitivity
from gearwhine.meshes import Mesh

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ModelledHousing:
    """A housing as its finite-element model, with its modes.

    Attributes
    ----------
    housing : Housing
    modes : ModeSet
        Certified modes, with residual modes for the bearings of a machine.
    damping_ratios : ndarray, shape (n_modes,)
        Fraction of critical damping of each mode, without the dashpots of the fixtures.
    """

    housing: Housing
    modes: ModeSet
    damping_ratios: FloatArray

    @classmethod
    def of(cls, modes: HousingModes) -> "ModelledHousing":
        """Take the natural modes of a housing, see :meth:`gearwhine.housing.Housing.modes`."""
        ratios = np.full(len(modes.mode_set.frequencies), modes.housing.damping_ratio)
        return cls(modes.housing, modes.mode_set, ratios)

    @property
    def mesh(self) -> Mesh:
        """Finite-element mesh."""
        return self.housing.mesh

    @cached_property
    def matrices(self) -> Matrices:
        """Stiffness, mass and damping with every fixture on the solid."""
        return self.housing.matrices()

    @cached_property
    def seat_ports(self) -> dict[str, sparse.csr_array]:
        """Rigid motion of each seat at its centre from the nodes' displacements, shape (6, 3 n_nodes)."""
        return self.housing.seat_ports()

    @cached_property
    def sensors(self) -> dict[str, SensorPort]:
        """Each sensor on the mesh."""
        return self.housing.sensor_ports()

    @property
    def field(self) -> HousingField:
        """Mesh, and shapes of the modes and residual modes on that."""
        bores = [seat.diameter for seat in self.housing.seats if seat.diameter is not None]
        return HousingField(self.mesh, self.modes, max(bores, default=None))

    def bearing_ports(self, machine: Machine) -> dict[str, sparse.csr_array]:
        """Motions of the places where a machine bears on the housing from the nodes', shape (5, 3 n_nodes) each."""
        centers = {seat.name: seat.center[2] for seat in self.housing.seats}
        return {
            one.bearing.name: bearing_port(
                self.seat_ports[one.seat], machine.shaft(one.rotor).start + one.bearing.at - centers[one.seat]
            )
            for one in machine.bearings
            if one.seat is not None
        }

    def component(self, modes: ModeSet, *, weighs: bool) -> HousingComponent:
        """Make the housing's component of a machine from other modes and residual modes.

        Parameters
        ----------
        modes : ModeSet
        weighs : bool
            Whether the participation in motions of the ground is taken, which weight and base motion need.
        """
        seats = self.housing.seats
        return housing_component(
            modes,
            self.damping_ratios,
            seats={name: modes.project_all(port) for name, port in self.seat_ports.items()},
            seat_z={seat.name: seat.center[2] for seat in seats},
            seat_axes={seat.name: seat.center[:2] for seat in seats},
            damping_matrix=modal_damping(modes, self.matrices) if self.matrices.damping.nnz else None,
            sensors={name: modes.project_all(port.matrix)[:, 0] for name, port in self.sensors.items()},
            sensor_places={name: SensorPlace(port.position, port.direction) for name, port in self.sensors.items()},
            participation=self.housing.participation(self.matrices, modes) if weighs else None,
        )

    def fields(self, point: OperatingPoint, adjoints: Sequence[Adjoint]) -> StaticSensitivity:
        """Return the displacements of the nodes at an operating point and of adjoint states, with their forces."""
        assert point.housing is not None
        every = np.arange(len(self.mesh.points))
        gravity = point.shafts[0].gravity
        return StaticSensitivity(
            self.mesh,
            element_constants(self.mesh, self.housing.material, self.housing.materials),
            self.modes.displacement(point.housing, every),
            np.array([self.modes.displacement(adjoint.housing, every) for adjoint in adjoints]),
            {load.name: load.force for load in point.bearings},
            {load.name: np.array([adjoint.force(load.name) for adjoint in adjoints]) for load in point.bearings},
            np.zeros(3) if gravity is None else np.array(gravity),
        )
