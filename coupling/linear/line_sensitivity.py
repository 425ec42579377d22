r"""Sensitivity of spectral lines: adjoint gradients of outputs at mesh harmonics, at sensors and in the sound.

A line is an output J(q) of the motion q of :mod:`gearwhine.coupling.linear.mesh_harmonics`, Z q = f, such as the
amplitude of a sensor or the sound power (:mod:`gearwhine.coupling.linear.line_outputs`), with the adjoint load g: dJ =
Re gᵀ dq. One adjoint solve for each line gives its derivative by any parameter of the machine,

    Zᵀ μ = g,      dJ = Re [μᵀ (df - dZ q)] + ∂J

(Choi and Kim, *Structural Sensitivity Analysis and Optimization 1*, 2005, section 5.4, on the frequency response), with
∂J its change at the same motion. Of a sensor this is the gradient of one point, of the sound power one over the
housing's surface; the sound power is that of the same linear lines.

*Housing*: dZ has dK + iω dC - ω² dM of its coordinates, projected, and the motions of its ports
(:mod:`gearwhine.coupling.linear.housing_rates`). Its modes and residual modes are a fixed basis for the derivative. The
output errs by the product of what the basis lacks of the motion and of the adjoint field, the derivative by either. So
both fields must be exact in it, which residual modes of bearings and sensors are nearly, and the harmonic responses of
the housing's finite-element matrices to the loads of both fields make them
(:func:`gearwhine.housing.modes.residual_modes.missing_harmonic_responses`). What is differentiated is then the line of
these matrices, of which that of any other basis differs by second order.

*Operating point*: where the tangent of a rolling bearing and the gap of flanks are those of the static equilibrium,
these, and with them k, c, e and the shuttling, change with the deflections there. Their derivatives by bearing
deflections and approaches of flanks, central differences of the laws, are the gradient of the output by the static
coordinates; its adjoint (:mod:`gearwhine.coupling.statics.sensitivity`) gives the rest of the derivative. The energy of
the flanks has continuous first derivatives, so e and the shuttling have a derivative by the gap at every phase, to
which short steps converge. k is a second derivative: at each phase it has a step where a slice of the face comes into
touch. Its mean over a mesh period is continuous, its mean over some phases is constant but for such steps. So its
differences are taken over ten times as many phases and over many steps, and are good to a tenth of the derivative by a
tilt.

A first-order change is right for steps that move no resonance past the line. For others the response is solved anew
with the matrices changed to first order (:meth:`LineModel.stepped_housing`), which needs no new modes.

Left out are the change of mean mesh forces where meshes share a torque, that of the ratios ζ and of dashpots, friction
of the teeth, and all that is not linear about the mean mesh: contact loss and the variation of k over the mesh period
times the motion.
"""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import linalg

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears.contact.face_slices import FACE_STATIONS, face_stations, lagrange
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
from gearwhine.coupling.linear.housing_rates import HousingRates
from gearwhine.coupling.linear.line_outputs import LineOutput, SensorAmplitude
from gearwhine.coupling.linear.mesh_harmonics import HARMONICS, MeshHarmonicModel, Response, sum_of
from gearwhine.coupling.machine.components import seat_in_section
from gearwhine.coupling.machine.connectors import LinearConnector
from gearwhine.coupling.machine.mesh_face import MeshFace
from gearwhine.coupling.statics.operating_point import BearingLoad, OperatingPoint
from gearwhine.coupling.statics.sensitivity import deflection_slope, rigid_slope, section_slope
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors.rolling_bearings import rolling_state

_GAP_STEP = 1e-6  # step over the flanks' compression, in the differences of transmission error and shuttling
_STIFFNESS_STEP = 0.01  # the step in the differences of k, which jumps where a slice comes into touch
_STIFFNESS_POINTS = 2000  # number of phases of a mesh period in the differences of k
_BEARING_STEP = 1e-4  # step over a bearing's deflection, in the differences of its tangent


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
    """

    output: LineOutput
    value: float
    adjoint: ComplexArray


@dataclass(frozen=True, eq=False)
class _GapRates:
    """Derivatives of a loaded contact by the gap of its flanks at the j stations of the face.

    Attributes
    ----------
    stiffness : ndarray, shape (j, 3, 3)
        Derivative of the mesh's stiffness over mean approach, slope and tilt; of the first, k, [N/m per m].
    error : ndarray of complex, shape (j, harmonics)
        Derivative of e [m per m].
    shuttling : ndarray of complex, shape (j, harmonics, n)
        Derivative of the moments on the coordinates.
    """

    stiffness: FloatArray
    error: ComplexArray
    shuttling: ComplexArray


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
    """

    point: OperatingPoint
    pairs: tuple[LoadedGearPair, ...]
    found: tuple[bool, ...]

    def responses(self, limit: float) -> tuple[Response, ...]:
        """Solve the motions at the mesh harmonics with the carriers frozen, as adjoint states have them."""
        return self.frozen_responses(limit)

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
        adjoint = linalg.solve(self._dynamic(w).T, output.adjoint_load(w, motion))
        return Line(w, response.causes, motion, output, output.value(w, motion), adjoint)

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
            if number in self._gap_rates:
                contact = self.point.pairs[mesh].pair.contact
                by_gap = self._by_gap(line, number)
                # The gap is the mean approach less that at the stations.
                by_approach = float(by_gap.sum()) * contact.face_mean
                by_approach[:-1] -= by_gap
                total += tangent.pairs[mesh] @ by_approach
        return total

    def by_bearing_stiffness(self, line: Line, bearing: str) -> float:
        """Differentiate the output by a factor 1 + p on a bearing's tangent stiffness, at the same equilibrium."""
        law = self._connector(bearing)
        moved, adjoint = law.directions.T @ line.motion, law.directions.T @ line.adjoint
        return -float((self._with_damping(line, bearing) * (adjoint @ law.stiffness @ moved)).real)

    def by_bearing_position(self, line: Line, bearing: str) -> float:
        """Differentiate the output by a bearing's position on its shaft, towards +z, at the same static motions."""
        law, axes = self._connector(bearing), list(self._connector(bearing).axes)
        force = self._dynamic_force(law, line.frequency, line.motion)
        against = self._dynamic_force(law, line.frequency, line.adjoint, transposed=True)
        load = self.point.bearing(bearing)
        slope = self._bearing_slope(load)[axes]
        direct = -float(((slope @ line.adjoint) @ force + against @ (slope @ line.motion)).real)
        # The bearing's static deflection changes with its place too.
        return direct + float(self._by_bearing_deflection(line, bearing) @ deflection_slope(self.point, load))

    def by_housing(self, line: Line, rates: HousingRates) -> FloatArray:
        """Differentiate the output by parameters of the housing, at the same operating point, shape (p,)."""
        coordinates, w = self.housing, line.frequency
        motion, adjoint = line.motion[coordinates], line.adjoint[coordinates]
        dynamic = rates.stiffness - w**2 * rates.mass + 1j * w * rates.damping
        total = -np.einsum("a,pab,b->p", adjoint, dynamic, motion, optimize=True).real
        for number, bearings in enumerate(rates.bearings):
            for name, rows in bearings.items():
                law = self._connector(name)
                at_bearing = rows[list(law.axes)]
                force = self._dynamic_force(law, w, line.motion)
                against = self._dynamic_force(law, w, line.adjoint, transposed=True)
                total[number] += float(((at_bearing @ adjoint) @ force + against @ (at_bearing @ motion)).real)
            total[number] += self._by_seats(line, rates, number)
            total[number] += line.output.by_housing(rates, number, w, line.motion)
        return np.asarray(total)

    def stepped_bearing_stiffness(self, line: Line, bearing: str, part: float) -> float:
        """Change of the output by a factor 1 + part on a bearing's tangent, the response solved anew."""

        def dynamic() -> ComplexArray:
            law = self._connector(bearing)
            change = part * self._with_damping(line, bearing) * (law.directions @ law.stiffness @ law.directions.T)
            return self._dynamic(line.frequency) + change

        return self._solved_anew(line, ("bearing stiffness", bearing, part), dynamic)

    def stepped_bearing_position(self, line: Line, bearing: str, step: float) -> float:
        """Change of the output as a bearing moves along its shaft, the response solved anew."""
        law, load = self._connector(bearing), self.point.bearing(bearing)

        def dynamic() -> ComplexArray:
            inner = law.stiffness + 1j * line.frequency * law.damping
            moved = law.directions + step * self._bearing_slope(load)[list(law.axes)].T
            return self._dynamic(line.frequency) + moved @ inner @ moved.T - law.directions @ inner @ law.directions.T

        by_tangent = self._by_bearing_deflection(line, bearing) @ deflection_slope(self.point, load)
        return self._solved_anew(line, ("bearing position", bearing, step), dynamic) + step * float(by_tangent)

    def stepped_housing(self, line: Line, rates: HousingRates, number: int, step: float) -> float:
        """Change of the output by a step of a parameter of the housing, the response solved anew.

        Matrices and ports change to first order, so that resonances move with them.
        """
        coordinates, w = self.housing, line.frequency

        def dynamic() -> ComplexArray:
            total = self._dynamic(w)
            change = rates.stiffness[number] - w**2 * rates.mass[number] + 1j * w * rates.damping[number]
            total[coordinates, coordinates] += step * change
            for name, rows in rates.bearings[number].items():
                law = self._connector(name)
                moved = law.directions.copy()
                moved[coordinates] -= step * rows[list(law.axes)].T
                inner = law.stiffness + 1j * w * law.damping
                total += moved @ inner @ moved.T - law.directions @ inner @ law.directions.T
            return total

        change = self._solved_anew(line, (rates, number, step), dynamic, line.output.moved(rates, number, step))
        return change + step * self._by_seats(line, rates, number)

    def _by_seats(self, line: Line, rates: HousingRates, number: int) -> float:
        """Differentiate the output by the seats' motions in the static field, through the bearings' tangents."""
        # The deflection is that of the shaft against its seat.
        return -sum(
            float(self._by_bearing_deflection(line, name) @ moved) for name, moved in rates.static[number].items()
        )

    def _solved_anew(
        self, line: Line, change: Hashable, dynamic: Callable[[], ComplexArray], output: LineOutput | None = None
    ) -> float:
        """Change of the output with another dynamic stiffness, whose motion all lines of a frequency share.

        Parameters
        ----------
        line : Line
        change : hashable
            What changes, and by how much.
        dynamic : callable
            Returns the dynamic stiffness with the change, shape (n, n).
        output : LineOutput, optional
            Output with the change, where that moves it.
        """
        key = (line.frequency, line.causes, change)
        if key not in self._motions:
            self._motions[key] = linalg.solve(dynamic(), sum_of(self._loads(line.causes)))
        return (output or line.output).value(line.frequency, self._motions[key]) - line.value

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
    def _gap_rates(self) -> dict[int, _GapRates]:
        """Derivatives of the loaded contacts whose flanks follow the operating point."""
        rates = {}
        for number in self.loaded:
            mesh, back = self.machine.flanks(number)
            law = self.machine.meshes[mesh].contact
            # Even flanks, such as those of spur gears in the middle, have no slices and no first-order change.
            if self.found[mesh] and law.faces is not None:
                rates[number] = self._gap_rates_of(number, law, back)
        return rates

    def _gap_rates_of(self, number: int, law: ToothContact, back: bool) -> _GapRates:
        assert law.faces is not None
        assert self.contact.force is not None
        system, faces = self.machine.system, law.faces
        rate, force = abs(system.contacts[number].mesh_frequency), float(self.contact.force[number])
        compression = force / float(self.contact.stiffness[number])
        over = lagrange(face_stations(faces.face_width), faces.z)
        standing, face = system.contacts[number], self.machine.face(number, law)
        stiffness = np.zeros((FACE_STATIONS, 3, 3))
        error = np.zeros((FACE_STATIONS, HARMONICS), dtype=np.complex128)
        shuttling = np.zeros((FACE_STATIONS, HARMONICS, system.size), dtype=np.complex128)

        def moved(station: int, step: float) -> ToothContact:
            opened = replace(law, faces=replace(faces, gap=faces.gap + step * over[:, station]))
            return opened.back_flanks if back else opened

        for station in range(FACE_STATIONS):
            for way in (1.0, -1.0):
                step = way * _STIFFNESS_STEP * compression
                far = moved(station, step)
                mean = self._mesh(number, far, _STIFFNESS_POINTS).mean_mesh_stiffness
                stiffness[station] += face.with_contact(far).law(force, mean, _STIFFNESS_POINTS) / (2.0 * step)
                step = way * _GAP_STEP * compression
                near = moved(station, step)
                error[station] += self._error(number, self._mesh(number, near)) / (2.0 * step)
                moments = face.with_contact(near).shuttling(force, standing.phase, standing.mesh_frequency)
                for load in moments[1]:
                    order = round(load.frequency / (2.0 * np.pi * rate))
                    if order <= HARMONICS:
                        shuttling[station, order - 1] += load.amplitude / (2.0 * step)
        return _GapRates(stiffness, error, shuttling)

    def _by_gap(self, line: Line, number: int) -> FloatArray:
        """Differentiate the output by a contact's gap at the stations of the face, shape (j,)."""
        rates, mesh = self._gap_rates[number], self.machine.flanks(number)[0]
        stiffness, w = float(self.contact.stiffness[number]), line.frequency
        face, law = self._faces[number]
        along, deflection = face.rows @ line.adjoint, face.rows @ line.motion
        # The damping is c/k times the law: c = 2 ζ sqrt(k m), or given.
        lost = 1j * w * float(self.contact.damping[number]) / stiffness
        falls = 0.5 if self.pairs[mesh].pair.damping is None else 1.0
        change = (1.0 + lost) * rates.stiffness - falls * lost / stiffness * rates.stiffness[:, :1, :1] * law
        total = -(change @ deflection) @ along
        for cause, harmonic in line.causes:
            if cause == number:
                driven = np.outer(rates.error[:, harmonic - 1], law[0])
                driven = driven + rates.stiffness[:, 0] * self._errors[number][harmonic - 1]
                total = total + driven @ along + rates.shuttling[:, harmonic - 1] @ line.adjoint
        return np.asarray(total.real)

    @cached_property
    def _faces(self) -> dict[int, tuple[MeshFace, FloatArray]]:
        """Face of every contact with `_gap_rates`, and its linear law, shape (3, 3)."""
        assert self.contact.force is not None
        faces = {}
        for number in self._gap_rates:
            face = self.machine.face(number, self.machine.system.contacts[number].contact)
            law = face.law(float(self.contact.force[number]), float(self.contact.stiffness[number]))
            faces[number] = (face, law)
        return faces

    def _by_bearing_deflection(self, line: Line, bearing: str) -> FloatArray:
        """Differentiate the output by a bearing's static deflection, through its tangent, shape (5,)."""
        if bearing not in self._tangent_rates:
            return np.zeros(5)
        law = self._connector(bearing)
        among_axes = np.ix_(list(law.axes), list(law.axes))
        moved, adjoint = law.directions.T @ line.motion, law.directions.T @ line.adjoint
        factor = self._with_damping(line, bearing)
        return np.array(
            [-float((factor * (adjoint @ change[among_axes] @ moved)).real) for change in self._tangent_rates[bearing]]
        )

    def _with_damping(self, line: Line, bearing: str) -> complex:
        """Dynamic over static change 1 + iωτ of a bearing's tangent, whose damping is τ times its stiffness."""
        return 1.0 + 1j * line.frequency * self.point.bearing(bearing).mounted.damping_time

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
