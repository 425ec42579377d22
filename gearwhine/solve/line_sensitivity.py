"""Sensitivity of a case's sensor lines: the machine linear about its operating point, and its housing's derivatives.

The gradients are those of :mod:`coupling.linear.sensor_lines`, whose motion and adjoint fields must be exact in the
housing's basis. Residual modes of the sensors, which the modes of a solved housing do not have, bring the fields close;
then the responses of the housing's finite-element matrices at the lines' frequencies to the loads in both fields join
the basis, and the lines are solved again.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from coupling import Machine
from coupling.linear.sensor_lines import HousingRates, LineModel, SensorLine
from coupling.statics.operating_point import OperatingPoint
from gearwhine.case import Case
from gearwhine.from_case.fixtures import attach_all
from gearwhine.from_case.gear_pairs import solve_gears
from gearwhine.from_case.machine import driving, full_housing_component
from gearwhine.progress import Progress
from gearwhine.solve.housing_modes import SolvedHousing, describe_housing
from housing import ModeSet, modal_damping
from housing.model.housing import RESPONSE_ORDERS
from housing.modes.natural_modes import ModeSetExtension
from housing.updating import ModelSensitivity, modal_sensitivities
from housing.updating.static_sensitivity import PortRates

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

LINES = 3
"""Lines of each sensor, the highest."""

_TWO_PI = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class SolvedLines:
    """Lines of a case's sensors, with the model that they are of.

    Attributes
    ----------
    model : LineModel
    lines : tuple of SensorLine
        The highest first.
    housing : SolvedHousing
        With residual modes of the sensors, and the harmonic responses at the lines.
    """

    model: LineModel
    lines: tuple[SensorLine, ...]
    housing: SolvedHousing

    def cause(self, line: SensorLine) -> str:
        """Return the mesh harmonics that drive a line, in words."""
        contacts = self.model.machine.system.contacts
        return " and ".join(f"{harmonic}× {contacts[number].name}" for number, harmonic in line.causes)

    @property
    def held(self) -> str | None:
        """Parts that the case fixes, so that they do not follow the operating point, in words."""
        pairs = [one.geometry.label for one, found in zip(self.model.pairs, self.model.found, strict=True) if not found]
        bearings = [
            one.name for one in self.model.point.bearings if one.rolling is not None and not one.mounted.needs_load
        ]
        parts = [f"the flanks of {', '.join(pairs)} (misalignment)"] if pairs else []
        parts += [f"the stiffness of bearings {', '.join(bearings)}"] if bearings else []
        return " and ".join(parts) or None

    def field(self, coordinates: ComplexArray) -> ComplexArray:
        """Displacement of the housing's nodes by the coordinates of the machine, shape (n_nodes, 3)."""
        assert self.model.machine.housing is not None
        name = self.model.machine.housing.name
        own = self.model.machine.rows(name, np.eye(self.model.machine.housing.size)) @ coordinates
        every = np.arange(len(self.housing.mesh.points))
        displacement = self.housing.modes.displacement
        return np.asarray(displacement(own.real, every) + 1j * displacement(own.imag, every))

    def rates(
        self,
        constants: FloatArray,
        rates: Sequence[ModelSensitivity],
        bearings: Sequence[PortRates],
        sensors: Sequence[PortRates],
        displacement: FloatArray,
    ) -> HousingRates:
        """Project derivatives of the housing by some parameters on its modes and residual modes.

        Parameters
        ----------
        constants : ndarray, shape (3, n_elements)
            λ, μ [Pa] and ρ [kg/m³].
        rates : sequence of ModelSensitivity
        bearings, sensors : sequence of mapping
            Of each parameter, the change of the ports of bearings and of sensors.
        displacement : ndarray, shape (n_nodes, 3)
            At the operating point [m].
        """
        modes, ratios = self.housing.modes, self.housing.damping_ratios
        shapes, omega = modes.shapes, modes.frequencies
        assert modes.residual_modes is not None
        shapes = np.concatenate([shapes, modes.residual_modes.shapes])
        # As in the housing's component.
        extra = len(modes.residual_modes.frequencies)
        omega = np.concatenate([omega, modes.residual_modes.frequencies])
        ratios = np.concatenate([ratios, np.full(extra, ratios.max(initial=0.0))])
        found = modal_sensitivities(self.housing.mesh, constants, shapes, rates)
        flat = shapes.reshape(len(shapes), -1).T
        return HousingRates(
            omega,
            ratios,
            found.stiffness,
            found.mass,
            [{name: np.asarray(rows @ flat) for name, rows in one.items()} for one in bearings],
            [{name: np.asarray(rows @ flat)[0] for name, rows in one.items()} for one in sensors],
            [{name: np.asarray(rows @ displacement.ravel()) for name, rows in one.items()} for one in bearings],
        )


def solve_lines(
    case: Case,
    machine: Machine,
    point: OperatingPoint,
    housing: SolvedHousing | None,
    progress: Progress,
    *,
    count: int = LINES,
) -> SolvedLines | None:
    """Solve the highest lines of each sensor at the mesh harmonics; None where no mesh drives any sensor.

    Parameters
    ----------
    case : Case
    machine : Machine
        Of the case.
    point : OperatingPoint
        Of the machine.
    housing : SolvedHousing or None
        That the machine stands in.
    progress : callable
    count : int
        Lines of each sensor.
    """
    if housing is None or not housing.sensors or not case.gear_pair or machine.speed == 0.0:
        return None
    progress("residual modes of the sensors")
    matrices = attach_all(case, housing.mesh, describe_housing(case, housing.mesh).free_matrices())
    extension = ModeSetExtension(matrices, housing.modes)
    ports = [one.matrix for one in housing.sensors.values()]
    modes = extension.with_ports(housing.modes, ports, orders=RESPONSE_ORDERS)
    about = machine.at_operating_point(point)
    pairs = solve_gears(case, progress, {one.names: one.station_gap for one in point.pairs})
    components = about.rotor_components(progress=progress)
    excitation = driving(case, components)
    found = tuple(pair.misalignment is None for pair in machine.gear_pairs)

    def solved(modes: ModeSet) -> SolvedLines:
        damping = modal_damping(modes, matrices) if matrices.damping.nnz else None
        extended = replace(housing, modes=modes, damping_matrix=damping)
        stands = replace(about, housing=full_housing_component(case, extended, progress))
        model = LineModel(stands.assemble(pairs, components, excitation), point, pairs, found)
        return SolvedLines(model, model.lines(_TWO_PI * housing.trusted_limit_hz, count), extended)

    progress("lines of the sensors")
    first = solved(modes)
    if not first.lines:
        return None
    progress("responses of the housing at the lines")
    return solved(extension.with_harmonic_responses(modes, _housing_loads(first)))


def _housing_loads(solved: SolvedLines) -> list[tuple[float, FloatArray]]:
    """Return the loads on the housing's nodes in the motions and adjoint fields of lines, by frequency.

    Returns
    -------
    list of (float, ndarray of shape (3 n_nodes, m))
        Frequencies [rad/s], and real and imaginary parts of the loads.
    """
    found: dict[float, list[ComplexArray]] = {}
    limit = solved.housing.modes.certificate.limit
    # At the limit itself residual modes have the responses.
    for line in (one for one in solved.lines if one.frequency < limit):
        motion = np.zeros(3 * len(solved.housing.mesh.points), dtype=np.complex128)
        against = line.weight * solved.housing.sensors[line.sensor].matrix.toarray()[0]
        for name, port in solved.housing.loaded.items():
            load, adjoint = solved.model.bearing_loads(line, name)
            motion += np.asarray(port.T @ load)
            against = against + np.asarray(port.T @ adjoint)
        # The motion is the same for every sensor.
        found.setdefault(line.frequency, [motion]).append(against)
    return [(w, np.concatenate([np.array(one).real, np.array(one).imag]).T) for w, one in found.items()]
