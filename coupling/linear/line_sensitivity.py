r"""Sensitivity of spectral lines: adjoint gradients of outputs at mesh harmonics, at sensors and in the sound.

A line is an output J(q) of the motion q of :mod:`gearwhine.coupling.linear.mesh_harmonics`, Z q = f, such as the
amplitude of a sensor or the sound power (:mod:`gearwhine.coupling.linear.line_outputs`), with the adjoint load g: dJ =
Re gᵀ dq. One adjoint solve for each line gives its derivative by any parameter of the machine,

    Zᵀ μ = g,      dJ = Re [μᵀ (df - dZ q)] + ∂J

(Choi and Kim, *Structural Sensitivity Analysis and Optimization 1*, 2005, section 5.4, on the frequency response), with
∂J its change at the same motion. Of a sensor this is the gradient of one point, of the sound power one over the
housing's surface; the sound power is that of the same linear lines.

*Stiffness that varies*: the harmonics n of a mesh are coupled (:mod:`gearwhine.coupling.linear.parametric_stiffness`),
Z_n q_n = f_n - d Σ_m κ_{n-m} u_m with u_m = dᵀ q_m - e_m, and so are the adjoint states of a line at the harmonic ν,

    Z_mᵀ μ_m = δ_{mν} g - d h_m,      h_m = Σ_n κ_{n-m} dᵀ μ_n,
    dJ = Re Σ_n [μ_nᵀ (df_n - dZ_n q_n - d Σ_m dκ_{n-m} u_m) + h_n de_n] + ∂J,

over positive and negative harmonics, which the static force is no part of.

*Housing*: dZ has dK + iω dC - ω² dM of its coordinates, projected, and the motions of its ports
(:mod:`gearwhine.coupling.linear.housing_rates`). Its modes and residual modes are a fixed basis for the derivative. The
output errs by the product of what the basis lacks of the motion and of the adjoint field, the derivative by either. So
both fields must be exact in it, which residual modes of bearings and sensors are nearly, and the harmonic responses of
the housing's finite-element matrices to the loads of both fields make them
(:func:`gearwhine.housing.modes.residual_modes.missing_harmonic_responses`). What is differentiated is then the line of
these matrices, of which that of any other basis differs by second order.

*Operating point*: where the tangent of a rolling bearing, the gap of flanks and a share of a torque are those of the
static equilibrium, these, and with them k, c, e, the shuttling and friction, change with the deflections there. Their
derivatives by bearing deflections, approaches of flanks and mesh forces, central differences of the laws, are the
gradient of the output by the static coordinates, by which a mesh force that is a share of a torque has the derivative
of :attr:`gearwhine.coupling.statics.operating_point.PairLoad.force_slope`; its adjoint
(:mod:`gearwhine.coupling.statics.sensitivity`) gives the rest of the derivative. The energy of the flanks has
continuous first derivatives, so e and the shuttling have a derivative by the gap at every phase, to which short steps
converge. k is a second derivative: at each phase it has a step where a slice of the face comes into touch. Its mean
over a mesh period is continuous, its mean over some phases is constant but for such steps. So its differences are taken
over ten times as many phases and over many steps, and are good to a tenth of the derivative by a tilt.

A first-order change is right for steps that move no resonance past the line. For others the response is solved anew
with the matrices changed to first order (:meth:`LineModel.stepped_housing`), which needs no new modes.

Left out are the change of the ratios ζ and of dashpots, that of the housing's fields at other harmonics than the line's
beyond its basis, and all that is not linear about the mean mesh: contact loss.
"""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears.contact.contact_law import law_between_rims, with_path_slope
from gearwhine.coupling.gears.contact.face_slices import FACE_STATIONS, FaceSlices, face_stations, lagrange
from gearwhine.coupling.gears.contact.sliding_friction import sliding_friction
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair, load_gear_pair
from gearwhine.coupling.linear.housing_rates import HousingRates
from gearwhine.coupling.linear.line_outputs import LineOutput, SensorAmplitude
from gearwhine.coupling.linear.mesh_harmonics import (
    HARMONICS,
    MeshHarmonicModel,
    Response,
    friction_force,
    mesh_under,
    sum_of,
)
from gearwhine.coupling.linear.parametric_stiffness import LEAST_REACH, Cause, VaryingMesh, varying_mesh
from gearwhine.coupling.linear.unequal_teeth import DampedMachine, StiffnessForce
from gearwhine.coupling.machine.components import seat_in_section
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector
from gearwhine.coupling.machine.mesh_face import MeshFace
from gearwhine.coupling.machine.tooth_friction import alike_teeth
from gearwhine.coupling.statics.operating_point import BearingLoad, OperatingPoint
from gearwhine.coupling.statics.sensitivity import deflection_slope, rigid_slope, section_slope
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors.rolling_bearings import rolling_state

_GAP_STEP = 1e-6  # step over the flanks' compression, in the differences of transmission error and shuttling
_FORCE_STEP = 1e-4  # step over the mean force, in the same differences
_STIFFNESS_STEP = 0.01  # the step in the differences of k, which jumps where a slice comes into touch
_STIFFNESS_POINTS = 2000  # number of phases of a mesh period in the differences of k
_BEARING_STEP = 1e-4  # step over a bearing's deflection, in the differences of its tangent
_SAME_FREQUENCY = 1e-6  # relative difference below which a field is at a harmonic

IntArray = npt.NDArray[np.intp]


class LineField(NamedTuple):
    """Motion of a line at a mesh harmonic, and its adjoint state.

    Attributes
    ----------
    frequency : float
        Circular frequency ω, below 0 of a negative harmonic [rad/s].
    motion, adjoint : ndarray of complex, shape (n,)
        q and μ, output per unit of a load.
    """

    frequency: float
    motion: ComplexArray
    adjoint: ComplexArray


class _LineMesh(NamedTuple):
    """A contact whose stiffness varies, in a line: its harmonics are those of `fields`.

    Attributes
    ----------
    fields : tuple of LineField
    places : ndarray of int, shape (f,)
        Place of each field's harmonic among the orders -J ... J.
    compression, force : ndarray of complex, shape (2 J + 1,)
        u [m] and g [N], twice their two-sided amplitudes.
    adjoint, coupled : ndarray of complex, shape (2 J + 1,)
        dᵀ μ [output/N] and h [output/m].
    """

    fields: tuple[LineField, ...]
    places: IntArray
    compression: ComplexArray
    force: ComplexArray
    adjoint: ComplexArray
    coupled: ComplexArray


class _CoupledMeshes(NamedTuple):
    """Meshes of one frequency, coupled with a line by their stiffness that varies.

    Attributes
    ----------
    meshes : tuple of VaryingMesh
    rate : float
        Their frequency [rad/s].
    reach : int
        Number J of their harmonics.
    adjoint, coupled : ndarray of complex, shape (meshes, 2 J + 1)
        As of a `_LineMesh`.
    """

    meshes: tuple[VaryingMesh, ...]
    rate: float
    reach: int
    adjoint: ComplexArray
    coupled: ComplexArray


@dataclass(frozen=True, eq=False)
class Line(Response):
    """Line of an output at a mesh harmonic, with the response.

    Attributes
    ----------
    output : LineOutput
    value : float
        Output J, in its unit.
    adjoint : ndarray of complex, shape (n,)
        Adjoint state μ, output per unit of a load.
    further : tuple of LineField
        Motions and adjoint states at the other harmonics, which the stiffness that varies couples with the line.
    meshes : mapping of int to _LineMesh
        Contacts whose stiffness varies, by number.
    """

    output: LineOutput
    value: float
    adjoint: ComplexArray
    further: tuple[LineField, ...] = field(default=(), kw_only=True)
    meshes: Mapping[int, _LineMesh] = field(default_factory=dict, kw_only=True)

    @property
    def fields(self) -> tuple[LineField, ...]:
        """Motion and adjoint state of the line, and those at other harmonics."""
        return (LineField(self.frequency, self.motion, self.adjoint), *self.further)


@dataclass(frozen=True, eq=False)
class _FlankRates:
    """Derivatives of a loaded contact by p quantities: the gap of its flanks at stations of the face, or its force.

    Attributes
    ----------
    stiffness : ndarray, shape (p, 3, 3)
        Derivative of the mesh's stiffness over mean approach, slope and tilt; of the first, k, [N/m].
    error : ndarray of complex, shape (p, J)
        Derivative of e [m].
    loads : ndarray of complex, shape (p, harmonics, n)
        Derivative of the moments of load shuttling and of friction on the coordinates.
    varying : ndarray of complex, shape (p, 4 J + 1)
        Derivative of the stiffness k̄ + κ by its two-sided amplitudes [N/m].
    """

    stiffness: FloatArray
    error: ComplexArray
    loads: ComplexArray
    varying: ComplexArray


class _Flanks(NamedTuple):
    """Flanks under a mean force [N]: their law, and the slices of the face by which they resist tilting."""

    contact: ToothContact
    faces: FaceSlices | None
    force: float


@dataclass(frozen=True, eq=False)
class LineModel(MeshHarmonicModel):
    """A machine linear about its operating point, driven by its loaded meshes.

    Attributes
    ----------
    machine : CoupledMachine
        Machine assembled about the operating point.
    point : OperatingPoint
    pairs : tuple of LoadedGearPair
        Loaded pairs of the machine's meshes.
    found : tuple of bool
        Whether the gap of each pair's flanks is that of the operating point.
    shared : tuple of bool
        Whether the mean force of each pair is its share of a torque at the operating point.
    """

    point: OperatingPoint
    pairs: tuple[LoadedGearPair, ...]
    found: tuple[bool, ...]
    shared: tuple[bool, ...]

    def lines(self, limit: float, count: int) -> tuple[Line, ...]:
        """Return the highest lines of each sensor, the highest of all first.

        Parameters
        ----------
        limit : float
            Highest frequency [rad/s].
        count : int
            Number of lines of each sensor.

        Raises
        ------
        CouplingError
            For less than one line, and as :meth:`line`.
        """
        if count < 1:
            raise CouplingError(f"{count} lines of each sensor; expected 1 or more")
        responses = self.responses(limit)
        lines = []
        for name, row in self.machine.sensor_rows.items():
            output = SensorAmplitude(name, row, self.housing)
            heard = [(output.value(response.frequency, response.motion), response) for response in responses]
            heard.sort(key=lambda pair: -pair[0])
            lines += [self.line(output, one) for value, one in heard[:count] if value > 0.0]
        return tuple(sorted(lines, key=lambda one: -one.value))

    def line(self, output: LineOutput, response: Response) -> Line:
        """Take an output of a motion, and solve its adjoint state.

        Raises
        ------
        CouplingError
            For a machine with connectors that turn with a carrier: its lines have sidebands, and no gradient by
            constant matrices.
        """
        if self.machine.system.turns:
            raise CouplingError(
                "a gradient of the lines of a machine whose planets turn with their carrier; expected carriers that "
                "stand still"
            )
        w, motion = response.frequency, response.motion
        mean = self.damped.motion(w, output.adjoint_load(w, motion), transposed=True)
        groups = [self._coupled(group, w, mean) for group in self._groups(response.causes)]
        # The harmonic of the line in each group; 0 above those that are coupled.
        harmonics = [n if (n := round(w / group.rate)) <= group.reach else 0 for group in groups]
        changes = [self._adjoint_at(group, n) for group, n in zip(groups, harmonics, strict=True) if n]
        own = LineField(w, motion, mean + sum(changes, np.zeros_like(mean)))
        meshes, further = dict[int, _LineMesh](), list[LineField]()
        for group, harmonic in zip(groups, harmonics, strict=True):
            orders = [n for n in range(-group.reach, group.reach + 1) if n != 0]
            fields = tuple(own if n == harmonic else self._field_at(group, n) for n in orders)
            further += [one for one in fields if one is not own]
            places = np.array(orders) + group.reach
            for row, mesh in enumerate(group.meshes):
                force = self._stiffness_forces[mesh.number]
                compression, pressed = 2.0 * force.compression, -2.0 * force.amplitudes[0]
                meshes[mesh.number] = _LineMesh(
                    fields, places, compression, pressed, group.adjoint[row], group.coupled[row]
                )
        value = output.value(w, motion)
        return Line(w, response.causes, motion, output, value, own.adjoint, further=tuple(further), meshes=meshes)

    def _groups(self, causes: Sequence[Cause]) -> list[list[VaryingMesh]]:
        """Meshes whose stiffness varies, those of one mesh frequency together, for each that drives a line."""
        varying = self.varying_harmonics
        rates = {round(varying[number].rate, 6) for number, _ in causes if number in varying}
        return [[mesh for mesh in varying.values() if round(mesh.rate, 6) == rate] for rate in sorted(rates)]

    def _coupled(self, meshes: Sequence[VaryingMesh], w: float, adjoint: ComplexArray) -> _CoupledMeshes:
        """Couple the adjoint state of a line at ω [rad/s] with the mean mesh stiffness, (n,), with other harmonics."""
        reach, rate = meshes[0].reach, meshes[0].rate
        orders = np.arange(-reach, reach + 1)
        along = self.machine.system.contact_directions[:, [mesh.number for mesh in meshes]]
        size, harmonic = len(orders), round(w / rate)
        matrix = np.eye(len(meshes) * size, dtype=np.complex128)
        given = np.zeros((len(meshes), size), dtype=np.complex128)
        if harmonic <= reach:
            given[:, reach + harmonic] = adjoint @ along
        for column, mesh in enumerate(meshes):
            # dᵀ Z⁻ᵀ d of the mesh and every other is dᵀ Z⁻¹ d the other way round.
            answer = self.damped.answers(along.T, along[:, column], rate * np.abs(orders))
            answer = np.where(orders < 0, answer.conj(), answer)
            # As in the motion, a free train turns until its mesh carries the mean force again.
            answer[:, reach] = 0.0
            answer[column, reach] = 1.0 / float(self.contact.stiffness[mesh.number])
            for row, other in enumerate(meshes):
                block = slice(column * size, (column + 1) * size), slice(row * size, (row + 1) * size)
                matrix[block] += answer[row][:, None] * other.coupling[0].T
        pressed: ComplexArray = np.asarray(np.linalg.solve(matrix, given.ravel())).reshape(given.shape)
        coupled = np.array([mesh.coupling[0].T @ one for mesh, one in zip(meshes, pressed, strict=True)])
        return _CoupledMeshes(tuple(meshes), rate, reach, pressed, coupled)

    def _adjoint_at(self, group: _CoupledMeshes, order: int) -> ComplexArray:
        """Adjoint state -Z⁻ᵀ Σ d h at a harmonic, shape (n,)."""
        along = self.machine.system.contact_directions[:, [mesh.number for mesh in group.meshes]]
        load = -(along @ group.coupled[:, group.reach + order])
        moved = self.damped.motion(abs(order) * group.rate, load if order > 0 else load.conj(), transposed=True)
        return moved if order > 0 else moved.conj()

    def _field_at(self, group: _CoupledMeshes, order: int) -> LineField:
        """Motion and adjoint state at another harmonic than the line's."""
        motion = self._motion_at(group.meshes, abs(order))
        return LineField(order * group.rate, motion if order > 0 else motion.conj(), self._adjoint_at(group, order))

    def _motion_at(self, group: Sequence[VaryingMesh], harmonic: int) -> ComplexArray:
        """Motion at a harmonic of meshes of one frequency."""
        key = group[0].number, harmonic
        if key not in self._harmonic_motions:
            w, known = harmonic * group[0].rate, self._driven
            if key in known:
                load = sum_of(self._loads(known[key]))
            else:
                numbers = [mesh.number for mesh in group]
                errors = [2.0 * mesh.error[0, mesh.reach + harmonic] for mesh in group]
                forces = [self._stiffness_forces[number].harmonic(harmonic) for number in numbers]
                through = self.contact.stiffness[numbers] * np.array(errors) + np.array(forces)
                load = self.machine.system.contact_directions[:, numbers] @ through
            self._harmonic_motions[key] = self.damped.motion(w, load)
        return self._harmonic_motions[key]

    @cached_property
    def _driven(self) -> dict[Cause, tuple[Cause, ...]]:
        """All causes of the line that a cause has a part in."""
        return {cause: causes for _, causes in self._harmonics(np.inf) for cause in causes}

    @cached_property
    def _harmonic_motions(self) -> dict[Cause, ComplexArray]:
        """Motions of `_motion_at`."""
        return {}

    def bearing_loads(self, line: Line, bearing: str) -> tuple[ComplexArray, ComplexArray]:
        """Return the loads of a bearing on its seat, x, y, z and about x, y, in the motion and in the adjoint field.

        Returns
        -------
        load : ndarray of complex, shape (5,)
            Load [N, N m].
        adjoint : ndarray of complex, shape (5,)
            Output per unit of the seat's motion [1/m, 1/rad].
        """
        law = self._connector(bearing)
        loads = np.zeros((2, 5), dtype=np.complex128)
        loads[0, list(law.axes)] = self._dynamic_force(law, line.frequency, line.motion)
        loads[1, list(law.axes)] = self._dynamic_force(law, line.frequency, line.adjoint, transposed=True)
        return loads[0], loads[1]

    def by_static(self, line: Line) -> FloatArray:
        """Differentiate a line's output by the coordinates of the static machine, shape (n_static,)."""
        tangent = self.point.tangent
        total = np.zeros(len(tangent.stiffness))
        for load in self.point.bearings:
            total += tangent.bearings[load.name] @ self._by_bearing_deflection(line, load.name)
        for number in self.loaded:
            mesh, _ = self.machine.flanks(number)
            pair = self.point.pairs[mesh]
            by_approach = np.zeros(pair.pair.contact.size)
            if number in self._gap_rates:
                *by_gap, by_rise = self._by_flanks(line, number, self._gap_rates[number])
                # The gap is the mean approach less that at the stations, and its slope along the path that by the tilt.
                by_approach += sum(by_gap) * pair.pair.contact.face_mean
                by_approach[:-1] -= by_gap
                by_approach[-1] += pair.pair.axial * pair.pair.geometry.base_pitch * by_rise
            if number in self._force_rates:
                by_approach += float(self._by_flanks(line, number, self._force_rates[number])[0]) * pair.force_slope
            total += tangent.pairs[mesh] @ by_approach
        return total

    def by_bearing_stiffness(self, line: Line, bearing: str) -> float:
        """Differentiate the output by a factor 1 + p on a bearing's tangent stiffness, at the same equilibrium."""
        return -float(np.sum(self._connector(bearing).stiffness * self._tangent_weights(line, bearing)))

    def by_bearing_position(self, line: Line, bearing: str) -> float:
        """Differentiate the output by a bearing's position on its shaft, towards +z, at the same static motions."""
        law, load = self._connector(bearing), self.point.bearing(bearing)
        direct = -self._by_moved_bearing(line, law, self._bearing_slope(load)[list(law.axes)])
        # The bearing's static deflection changes with its place too.
        return direct + float(self._by_bearing_deflection(line, bearing) @ deflection_slope(self.point, load))

    def by_housing(self, line: Line, rates: HousingRates) -> FloatArray:
        """Differentiate the output by parameters of the housing, at the same operating point, shape (p,)."""
        coordinates, w = self.housing, np.array([one.frequency for one in line.fields])[:, None]
        motion = np.array([one.motion[coordinates] for one in line.fields])
        adjoint = np.array([one.adjoint[coordinates] for one in line.fields])
        total = np.zeros(len(rates.stiffness))
        for matrices, factor in ((rates.stiffness, 1.0 + 0.0 * w), (rates.mass, -(w**2)), (rates.damping, 1j * w)):
            total -= np.tensordot(matrices, ((factor * adjoint).T @ motion).real, 2)
        for number, bearings in enumerate(rates.bearings):
            for name, rows in bearings.items():
                law = self._connector(name)
                moved = np.zeros((len(law.axes), self.machine.system.size))
                moved[:, coordinates] = rows[list(law.axes)]
                total[number] += self._by_moved_bearing(line, law, moved)
            total[number] += self._by_seats(line, rates, number)
            total[number] += line.output.by_housing(rates, number, line.frequency, line.motion)
        return np.asarray(total)

    def _by_moved_bearing(self, line: Line, law: LinearConnector, moved: FloatArray) -> float:
        """Differentiate the output as the motions of a bearing's place change by rows, shape (axes, n)."""
        return sum(
            float(
                (
                    (moved @ adjoint) @ self._dynamic_force(law, w, motion)
                    + self._dynamic_force(law, w, adjoint, transposed=True) @ (moved @ motion)
                ).real
            )
            for w, motion, adjoint in line.fields
        )

    def stepped_bearing_stiffness(self, line: Line, bearing: str, part: float) -> float:
        """Change of the output by a factor 1 + part on a bearing's tangent, the response solved anew."""

        def machine() -> DampedMachine:
            law, (stiffness, damping) = self._connector(bearing), self._matrices
            change = part * (law.directions @ law.stiffness @ law.directions.T)
            time = self.point.bearing(bearing).mounted.damping_time
            return DampedMachine(stiffness + change, damping + time * change)

        return self._solved_anew(line, ("bearing stiffness", bearing, part), machine)

    def stepped_bearing_position(self, line: Line, bearing: str, step: float) -> float:
        """Change of the output as a bearing moves along its shaft, the response solved anew."""
        law, load = self._connector(bearing), self.point.bearing(bearing)

        def machine() -> DampedMachine:
            moved = law.directions + step * self._bearing_slope(load)[list(law.axes)].T
            stiffness, damping = (
                matrix + moved @ inner @ moved.T - law.directions @ inner @ law.directions.T
                for matrix, inner in zip(self._matrices, (law.stiffness, law.damping), strict=True)
            )
            return DampedMachine(stiffness, damping)

        by_tangent = self._by_bearing_deflection(line, bearing) @ deflection_slope(self.point, load)
        return self._solved_anew(line, ("bearing position", bearing, step), machine) + step * float(by_tangent)

    def stepped_housing(self, line: Line, rates: HousingRates, number: int, step: float) -> float:
        """Change of the output by a step of a parameter of the housing, the response solved anew.

        Matrices and ports change to first order, so that resonances move with them.
        """
        coordinates = self.housing

        def machine() -> DampedMachine:
            stiffness, damping = (matrix.copy() for matrix in self._matrices)
            mass = np.eye(len(stiffness))
            for matrix, rate in ((stiffness, rates.stiffness), (damping, rates.damping), (mass, rates.mass)):
                matrix[coordinates, coordinates] += step * rate[number]
            for name, rows in rates.bearings[number].items():
                law = self._connector(name)
                moved = law.directions.copy()
                moved[coordinates] -= step * rows[list(law.axes)].T
                for matrix, inner in ((stiffness, law.stiffness), (damping, law.damping)):
                    matrix += moved @ inner @ moved.T - law.directions @ inner @ law.directions.T
            return DampedMachine(stiffness, damping, mass)

        change = self._solved_anew(line, (rates, number, step), machine, line.output.moved(rates, number, step))
        return change + step * self._by_seats(line, rates, number)

    def _by_seats(self, line: Line, rates: HousingRates, number: int) -> float:
        """Differentiate the output by the seats' motions in the static field, through the bearings' tangents."""
        # The deflection is that of the shaft against its seat.
        return -sum(
            float(self._by_bearing_deflection(line, name) @ moved) for name, moved in rates.static[number].items()
        )

    def _solved_anew(
        self, line: Line, change: Hashable, machine: Callable[[], DampedMachine], output: LineOutput | None = None
    ) -> float:
        """Change of the output with another machine, whose motion all lines of a frequency share.

        Parameters
        ----------
        line : Line
        change : hashable
            What changes, and by how much.
        machine : callable
            Returns the machine with the change and the mean mesh stiffness.
        output : LineOutput, optional
            Output with the change, where that moves it.
        """
        key = (line.frequency, line.causes, change)
        if key not in self._motions:
            if change not in self._machines:
                self._machines.clear()
                self._machines[change] = machine(), {}
            (changed, known), load = self._machines[change], sum_of(self._mean_loads(line.causes))
            for group in self._groups(line.causes):
                first = group[0].number
                if first not in known:
                    known[first] = self.stiffness_forces(group, changed)
                load = load + self._stiffness_load([one for one in line.causes if one[0] in known[first]], known[first])
            self._motions[key] = changed.motion(line.frequency, load)
        return (output or line.output).value(line.frequency, self._motions[key]) - line.value

    @cached_property
    def _machines(self) -> dict[Hashable, tuple[DampedMachine, dict[int, dict[int, StiffnessForce]]]]:
        """The last machine with a change, and forces by the varying stiffness there by first mesh of a frequency."""
        return {}

    @cached_property
    def _motions(self) -> dict[Hashable, ComplexArray]:
        """Motions with a change, shape (n,), by frequency and change."""
        return {}

    @cached_property
    def housing(self) -> slice:
        """Place of the housing among the coordinates."""
        components = self.machine.system.components
        place = next(n for n, part in enumerate(components) if part is self.machine.housing)
        first = sum(part.size for part in components[:place])
        return slice(first, first + components[place].size)

    @cached_property
    def _gap_rates(self) -> dict[int, _FlankRates]:
        """Derivatives of the loaded contacts whose flanks follow the operating point.

        They are by the gap at the stations and by what it rises along the line of action in a base pitch [m].
        """
        rates = {}
        for number in self.loaded:
            mesh, back = self.machine.flanks(number)
            law = self.machine.meshes[mesh].contact
            # Even flanks, such as those of spur gears in the middle, have no slices and no first-order change.
            if self.found[mesh] and law.faces is not None:
                rates[number] = self._rates_by_gap(number, law, law.faces, back)
        return rates

    def _rates_by_gap(self, number: int, law: ToothContact, faces: FaceSlices, back: bool) -> _FlankRates:
        over, force = lagrange(face_stations(faces.face_width), faces.z), self._force(number)

        geometry = self.pairs[self.machine.flanks(number)[0]].geometry

        def opened(station: int, step: float) -> _Flanks:
            contact = (
                replace(law, faces=replace(faces, gap=faces.gap + step * over[:, station]))
                if station < FACE_STATIONS
                else with_path_slope(law, geometry, step / geometry.base_pitch)
            )
            contact = contact.back_flanks if back else contact
            return _Flanks(contact, contact.faces, force)

        compression = force / float(self.contact.stiffness[number])
        steps = (_STIFFNESS_STEP * compression, _GAP_STEP * compression)
        return self._rates_of(number, [partial(opened, station) for station in range(FACE_STATIONS + 1)], steps)

    @cached_property
    def _force_rates(self) -> dict[int, _FlankRates]:
        """Derivatives of the loaded contacts that share a torque, by their mean force."""
        return {
            number: self._rates_by_force(number)
            for number in self.loaded
            if self.shared[self.machine.flanks(number)[0]]
        }

    def _rates_by_force(self, number: int) -> _FlankRates:
        (place, back), force = self.machine.flanks(number), self._force(number)
        mesh, loaded = self.machine.meshes[place], self.pairs[place]
        speed, torque = self.machine.speeds[mesh.driver.rotor], loaded.undamped.mean_load

        def pressed(step: float) -> _Flanks:
            pair = replace(loaded.pair, mean_force=loaded.static.force + step)
            stiff = load_gear_pair(pair, loaded.geometry, torque=torque, inertias=loaded.inertias, speed=speed)
            contact = law_between_rims(stiff.contact, mesh.behind_rims)
            contact = contact.back_flanks if back else contact
            return _Flanks(contact, contact.faces or stiff.tilting_faces, force + step)

        return self._rates_of(number, [pressed], (_STIFFNESS_STEP * force, _FORCE_STEP * force))

    def _rates_of(
        self, number: int, stepped: Sequence[Callable[[float], _Flanks]], steps: tuple[float, float]
    ) -> _FlankRates:
        """Differentiate a contact by quantities, each by its flanks at a step of it; steps of k, and of the rest."""
        system, count = self.machine.system, len(stepped)
        standing = system.contacts[number]
        face, mesh_of = self.machine.face(number, standing.contact), self.varying_harmonics.get(number)
        stiffness = np.zeros((count, 3, 3))
        varying = np.zeros((count, 1 if mesh_of is None else mesh_of.stiffness.shape[1]), dtype=np.complex128)
        error = np.zeros((count, LEAST_REACH), dtype=np.complex128)
        loads = np.zeros((count, HARMONICS, system.size), dtype=np.complex128)
        for place, at in enumerate(stepped):
            for way in (1.0, -1.0):
                step = way * steps[0]
                far, faces, force = at(step)
                mean = mesh_under(far, force, _STIFFNESS_POINTS).mean_mesh_stiffness
                tilted = face.with_contact(replace(far, faces=faces))
                stiffness[place] += tilted.law(force, mean, _STIFFNESS_POINTS) / (2.0 * step)
                step = way * steps[1]
                near, _, force = at(step)
                mesh, moved = mesh_under(near, force), self._with_flanks(number, near)
                error[place] += self._error(number, mesh, LEAST_REACH) / (2.0 * step)
                if mesh_of is not None:
                    apart = varying_mesh(number, moved, 0.0, mesh, between=False)
                    varying[place] += apart.stiffness[0] / (2.0 * step)
                moments = self.shuttling_loads(number, face.with_contact(near), force)
                alike = (mesh, None) if moved.sliding is None else alike_teeth(moved, force)
                for order in range(1, HARMONICS + 1):
                    rubbed = friction_force(moved, *alike, order)
                    load = moments.get(order, 0.0) + (0.0 if rubbed is None else rubbed.load)
                    loads[place, order - 1] += load / (2.0 * step)
        return _FlankRates(stiffness, error, loads, varying)

    def _with_flanks(self, number: int, law: ToothContact) -> ContactConnector:
        """Contact of a number with another law of its flanks, by which its teeth share the friction, too."""
        contact, mesh = self.machine.system.contacts[number], self.machine.meshes[self.machine.flanks(number)[0]]
        if contact.sliding is None:
            return replace(contact, contact=law)
        friction = sliding_friction(mesh.geometry, law, mesh.friction)
        return replace(contact, contact=law, sliding=replace(contact.sliding, friction=friction))

    def _by_flanks(self, line: Line, number: int, rates: _FlankRates) -> FloatArray:
        """Differentiate the output by the quantities of a contact's rates, shape (p,)."""
        mesh = self.machine.flanks(number)[0]
        stiffness = float(self.contact.stiffness[number])
        rate = 2.0 * np.pi * abs(self.machine.system.contacts[number].mesh_frequency)
        face, law = self._faces[number]
        falls = 0.5 if self.pairs[mesh].pair.damping is None else 1.0
        total, errors = np.zeros(len(rates.stiffness), dtype=np.complex128), self._errors[number]
        for w, motion, adjoint in line.fields:
            along, deflection = face.rows @ adjoint, face.rows @ motion
            # The damping is c/k times the law: c = 2 ζ sqrt(k m), or given.
            lost = 1j * w * float(self.contact.damping[number]) / stiffness
            change = (1.0 + lost) * rates.stiffness - falls * lost / stiffness * rates.stiffness[:, :1, :1] * law
            total -= (change @ deflection) @ along
            harmonic, conjugate = round(abs(w) / rate), np.conj if w < 0.0 else np.asarray
            if harmonic > LEAST_REACH or abs(harmonic * rate - abs(w)) > _SAME_FREQUENCY * abs(w):
                continue
            driven = np.outer(rates.error[:, harmonic - 1], law[0]) + rates.stiffness[:, 0] * errors[harmonic - 1]
            total += conjugate(driven) @ along
            if harmonic <= HARMONICS:
                total += conjugate(rates.loads[:, harmonic - 1]) @ adjoint
        if (varying := line.meshes.get(number)) is not None:
            total += self._by_varying_stiffness(varying, rates, face, law)
        return np.asarray(total.real)

    def _by_varying_stiffness(
        self, line: _LineMesh, rates: _FlankRates, face: MeshFace, law: FloatArray
    ) -> ComplexArray:
        """Differentiate the output by the quantities of a contact's rates, by what they change of κ, e and d there."""
        size, k = len(line.compression), law[0, 0]
        reach, places = size // 2, np.arange(size)
        # -Σ v_n dκ_{n-m} u_m, and h_n de_n at the harmonics on either side.
        changed = rates.varying.copy()
        changed[:, 2 * reach] -= rates.stiffness[:, 0, 0]
        total = -np.einsum(
            "n,jnm,m->j", line.adjoint, changed[:, places[:, None] - places + 2 * reach], line.compression
        )
        # At rest the mesh carries the mean force: k u = -g.
        total -= line.adjoint[reach] * line.compression[reach] * rates.stiffness[:, 0, 0]
        known = min(reach, rates.error.shape[1])
        total += rates.error[:, :known] @ line.coupled[reach + 1 : reach + 1 + known]
        total += rates.error[:, :known].conj() @ line.coupled[reach - known : reach][::-1]
        # The force -g acts along d, a row of the law over k, which u is taken along, too.
        turned = (rates.stiffness[:, 0] - rates.stiffness[:, 0, :1] * law[0] / k) / k
        for place, (_, motion, adjoint) in zip(line.places.tolist(), line.fields, strict=True):
            total -= line.force[place] * (turned @ (face.rows @ adjoint))
            total -= line.coupled[place] * (turned @ (face.rows @ motion))
        return np.asarray(total)

    @cached_property
    def _faces(self) -> dict[int, tuple[MeshFace, FloatArray]]:
        """Face of every loaded contact, and its linear law, shape (3, 3)."""
        faces = {}
        for number in self.loaded:
            face = self.machine.face(number, self.machine.system.contacts[number].contact)
            law = face.law(self._force(number), float(self.contact.stiffness[number]))
            faces[number] = (face, law)
        return faces

    def _by_bearing_deflection(self, line: Line, bearing: str) -> FloatArray:
        """Differentiate the output by a bearing's static deflection, through its tangent, shape (5,)."""
        if bearing not in self._tangent_rates:
            return np.zeros(5)
        axes = list(self._connector(bearing).axes)
        changes = self._tangent_rates[bearing][:, axes][:, :, axes]
        return -np.tensordot(changes, self._tangent_weights(line, bearing), 2)

    def _tangent_weights(self, line: Line, bearing: str) -> FloatArray:
        """Fall of the output by each entry of a bearing's tangent, whose damping is τ times its stiffness."""
        law, time = self._connector(bearing), self.point.bearing(bearing).mounted.damping_time
        return np.asarray(
            sum(
                ((1.0 + 1j * w * time) * np.outer(law.directions.T @ adjoint, law.directions.T @ motion)).real
                for w, motion, adjoint in line.fields
            )
        )

    @cached_property
    def _tangent_rates(self) -> dict[str, FloatArray]:
        """Derivatives of the tangents that follow the equilibrium by the bearing's deflection, shape (5, 5, 5) each."""
        loads = self.point.bearings
        return {
            load.name: _tangent_rate(load) for load in loads if load.mounted.needs_load and load.rolling is not None
        }

    def _connector(self, bearing: str) -> LinearConnector:
        number = next(n for n, one in enumerate(self.machine.bearings) if one.bearing.name == bearing)
        return self.machine.system.linear[number]

    def _dynamic_force(
        self, law: LinearConnector, w: float, field: ComplexArray, *, transposed: bool = False
    ) -> ComplexArray:
        """Dynamic force (K + iωC) Dᵀ q of a bearing, or that of the transposed law."""
        dynamic = law.stiffness + 1j * w * law.damping
        return np.asarray((dynamic.T if transposed else dynamic) @ (law.directions.T @ field))

    def _bearing_slope(self, load: BearingLoad) -> FloatArray:
        """Slope along z of a bearing's deflection as it moves along its shaft, by the coordinates, shape (5, n)."""
        mounted = load.mounted
        shaft = self.point.shaft(mounted.rotor).part
        z = shaft.start + mounted.bearing.at
        slope = self._section_slope(mounted.rotor, z)[:5]
        holder = self.point.shaft_around(load)
        if holder is not None:
            arm = np.subtract(shaft.axis, self.point.shaft(holder).part.axis)
            slope = slope - seat_in_section(self._section_slope(holder, z), arm, 0.0)
        elif mounted.seat is not None and self.machine.housing is not None:
            seat = self.machine.housing.seat_motions(mounted.seat, z)
            slope = slope - self.machine.rows(self.machine.housing.name, rigid_slope(seat))
        return np.asarray(slope)

    def _section_slope(self, name: str, z: float) -> FloatArray:
        """Slope along z of the motions of a shaft's sections at a place along z, by the coordinates, shape (6, n)."""
        rotor = next(rotor for rotor in self.machine.rotors if rotor.name == name)

        def motions(places: Sequence[float]) -> FloatArray:
            return np.array([np.vstack([rotor.motions(place), rotor.rotation(place)]) for place in places])

        length = self.point.shaft(name).part.shaft.length
        return self.machine.rows(name, section_slope(motions, z - rotor.start, length))


def _tangent_rate(load: BearingLoad) -> FloatArray:
    """Differentiate a rolling bearing's tangent by its deflection, shape (5, 5, 5)."""
    assert load.rolling is not None
    bearing = load.rolling.bearing
    step = _BEARING_STEP * float(np.linalg.norm(load.deflection[:3]))
    # Step of the tilts by which the elements move as much.
    steps = np.array([step] * 3 + [2.0 * step / bearing.rows[0].pitch_diameter] * 2)
    rate = np.zeros((5, 5, 5))
    for axis, size in enumerate(steps):
        for way in (1.0, -1.0):
            place = load.deflection + way * size * np.eye(5)[axis]
            rate[axis] += way / (2.0 * size) * rolling_state(bearing, place).stiffness
    return rate
