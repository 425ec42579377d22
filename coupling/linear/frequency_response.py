"""Frequency response of a machine: receptance, mesh forces, bearing loads and sensors under harmonic excitation.

A transmission error e = e^{iwt} at one mesh compresses its contact by δ = dᵀq - e. It drives the coordinates with the
load (k + iwc) d e, and every contact carries F = (k + iwc)(dᵀq - e), the error being its own alone: the dynamic mesh
force by unit error, d.c. limit k of the mesh in series with the dynamic compliance of the machine behind it.

The receptance H of the coupled system about a contact state is found by direct solution or by mode superposition: q =
H(s) f, H(s) = (s² I + s C + K)⁻¹ and s = iw. Superposition uses the expansion of
:mod:`gearwhine.coupling.linear.eigenpairs`,

    H(s) = X / s² - (Σ q pᴴ) / s + Σ q pᴴ / (s - λ),

over all modes, rigid-body motions included, so that both ways give one function; nothing is truncated.

The modal truncation error of frequency responses is estimated from two modal bases of one machine: the error of a basis
is estimated from another basis that differs from it by the part least well represented. Both are coupled to the same
bearings, teeth and loads, and excited alike: with the response H by the one and H' by the other at a frequency w, the
relative error of a sensor's line there is about

    u(w) = max(2 max |H'(v) - H(v)| / |H(v)|, 0.5 %),        v within 1.5 % of w,

the norms over all excitations that make lines. The difference of whole machines holds the shift of a resonance too,
which turns small errors into large ones. The neighbourhood covers lines at frequencies where the two curves cross by
chance; the factor of two covers directions in which the other basis is no better; and the least value covers errors
that both bases share, such as the one damping ratio of all modes above the limit.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError, ModesError
from gearwhine.coupling.linear.carriers.carrier_sidebands import CarrierSidebands
from gearwhine.coupling.linear.carriers.turning_response import Excitation, Order, TurningResponse
from gearwhine.coupling.linear.complex_modes import CoupledModes
from gearwhine.coupling.linear.eigenpairs import Eigenpairs, quadratic_eigenpairs
from gearwhine.coupling.linear.modal_superposition import SUM_RULE, superposed
from gearwhine.coupling.machine.connectors import TurningPart
from gearwhine.coupling.machine.coordinates import CoordinateLoads, MachineCoordinates
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.statics.mean_mesh import ContactState, linear_matrices, mean_contact
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.progress import Progress, silent
from gearwhine.rotors.analyses.harmonic_response import at_positive_frequency

_EVEN_POINTS = 600  # evenly spaced points of a band, in addition to those of each resonance
_FAINT_SIDEBAND = 1e-3  # part of a sensor's highest amplitude up to which a sideband of unbalance is left out
_AROUND = np.array([-8.0, -4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0, 8.0])  # half-power half-widths

_COARSE_EVEN_POINTS, _COARSELY_AROUND = 200, np.array([-1.0, 0.0, 1.0])  # the same of a coarse grid


def receptance(
    system: CoupledSystem,
    outputs: FloatArray,
    inputs: FloatArray,
    frequencies: FloatArray,
    *,
    contact: ContactState | None = None,
    modes: CoupledModes | None = None,
) -> ComplexArray:
    """Motions along output directions by unit harmonic forces along input directions.

    Parameters
    ----------
    system : CoupledSystem
    outputs, inputs : ndarray, shapes (o, n) and (i, n)
        Directions of motion over the coordinates; see :func:`gearwhine.coupling.machine.coupled_system.embed` for a
        component's.
    frequencies : ndarray, shape (f,)
        w [rad/s], not 0; the response at -w is the conjugate.
    contact : ContactState, optional
        State of the contacts; by default the mean contact.
    modes : CoupledModes, optional
        Modes about the same contact, to be superposed; by default the system is solved at every frequency.

    Returns
    -------
    ndarray of complex, shape (f, o, i)
        [m/N] between translations.

    Raises
    ------
    CouplingError
        For directions of another length, or a frequency of 0.
    ModesError
        Where the modes are not complete, or an undamped mode is driven at its own frequency.
    """
    for label, rows in (("outputs", outputs), ("inputs", inputs)):
        if rows.ndim != 2 or rows.shape[1] != system.size:
            raise CouplingError(f"{label} of shape {rows.shape}; expected (any, {system.size})")
    loads = np.broadcast_to(inputs, (len(frequencies), *inputs.shape))
    moved = response(system, loads, frequencies, contact, _pairs_of(modes))
    return np.asarray(np.einsum("fin,on->foi", moved, outputs))


def response(
    system: CoupledSystem,
    loads: npt.NDArray[np.float64] | ComplexArray,
    frequencies: FloatArray,
    contact: ContactState | None = None,
    pairs: Eigenpairs | None = None,
) -> ComplexArray:
    """Coordinates H(iw) f under loads f of shape (f, i, n): shape (f, i, n). See :func:`receptance`.

    Of a machine whose directions turn they are the motions at w, without the sidebands beside it
    (:mod:`gearwhine.coupling.linear.carriers.turning_response`).
    """
    w = np.asarray(frequencies, dtype=np.float64)
    if not np.all(np.isfinite(w)) or np.any(w == 0.0):
        raise CouplingError("frequencies that are 0 or not finite; expected others: a free machine drifts at 0")
    if system.turns:
        model = TurningResponse(system, mean_contact(system) if contact is None else contact)
        excitations_at: list[list[Excitation]] = [[({model.still: load}, {}) for load in at] for at in loads]
        moved = [model.respond(at, each, [model.still]) for at, each in zip(w.tolist(), excitations_at, strict=True)]
        return np.array([each[model.still] for each in moved]).reshape(loads.shape)
    if pairs is not None:
        return superposed(pairs, loads, w)
    stiffness, damping = linear_matrices(system, mean_contact(system) if contact is None else contact)
    amplitudes = np.empty(loads.shape, dtype=np.complex128)
    for number, (frequency, load) in enumerate(zip(w, loads, strict=True)):
        dynamic = stiffness + 1j * frequency * damping
        dynamic[np.diag_indices(system.size)] -= frequency**2
        try:
            amplitudes[number] = np.linalg.solve(dynamic, load.T).T
        except np.linalg.LinAlgError as error:
            raise ModesError(
                f"an undamped mode is driven at its own frequency, {frequency / (2.0 * np.pi):.6g} Hz; give it damping "
                "or leave that frequency out"
            ) from error
    return amplitudes


def _pairs_of(modes: CoupledModes | None) -> Eigenpairs | None:
    return None if modes is None else modes.pairs


def resonance_grid(modes: CoupledModes, low: float, high: float, *, coarse: bool = False) -> FloatArray:
    """Frequency grid of a band that resolves every resonance, ascending [rad/s].

    A coarse one, for responses that take long, has a third of the points.

    Raises
    ------
    CouplingError
        Unless 0 < low < high.
    """
    if not 0.0 < low < high:
        raise CouplingError(f"a band from {low:g} to {high:g} rad/s; expected 0 < from < to")
    swinging = modes.eigenvalues[modes.eigenvalues.imag > 0.0]
    near = swinging.imag[:, None] + np.abs(swinging.real)[:, None] * (_COARSELY_AROUND if coarse else _AROUND)
    points = _COARSE_EVEN_POINTS if coarse else _EVEN_POINTS
    grid = np.unique(np.concatenate([np.linspace(low, high, points), near.ravel()]))
    # An undamped mode has no finite response at its own frequency.
    undamped = swinging.imag[np.abs(swinging.real) <= 1e-12 * np.abs(swinging)]
    return np.asarray(grid[(grid >= low) & (grid <= high) & ~np.isin(grid, undamped)])


@dataclass(frozen=True)
class FrequencyResponse:
    """Complex amplitudes under a harmonic excitation at f frequencies; the signals are the real parts of a e^{iwt}.

    Attributes
    ----------
    excitation : str
        Name of the excitation.
    unit : str
        Unit of the excitation, which has the amplitude 1.
    frequencies : ndarray, shape (f,)
        w [rad/s].
    coordinates : ndarray of complex, shape (f, n)
        Amplitudes of the whole system.
    sensor_acceleration : dict of str to ndarray of complex, shape (f,)
        Acceleration along each sensor [m/s²].
    bearing_load : dict of str to ndarray of complex, shape (f, 5)
        Load of each shaft on its bearing: forces along x, y, z [N], moments about x and y [N m]; 0 along free axes.
    mesh_force : dict of str to ndarray of complex, shape (f,)
        Force along each line of action [N]; contacts that do not touch are left out.
    """

    excitation: str
    unit: str
    frequencies: FloatArray
    coordinates: ComplexArray
    sensor_acceleration: dict[str, ComplexArray]
    bearing_load: dict[str, ComplexArray]
    mesh_force: dict[str, ComplexArray]

    @property
    def bearing_force(self) -> dict[str, ComplexArray]:
        """Force of each shaft on its bearing along x and y [N], shape (f, 2) each."""
        return {name: load[:, :2] for name, load in self.bearing_load.items()}

    def at_positive_frequencies(self) -> "FrequencyResponse":
        """Return the same signals as real parts of a e^{i|w|t}: conjugate amplitudes where w is negative."""

        def positive(amplitude: ComplexArray) -> ComplexArray:
            return at_positive_frequency(amplitude, self.frequencies)

        return replace(
            self,
            frequencies=np.abs(self.frequencies),
            coordinates=positive(self.coordinates),
            sensor_acceleration={name: positive(signal) for name, signal in self.sensor_acceleration.items()},
            bearing_load={name: positive(load) for name, load in self.bearing_load.items()},
            mesh_force={name: positive(force) for name, force in self.mesh_force.items()},
        )

    def peaks(self, curve: ComplexArray, count: int = 8) -> npt.NDArray[np.int64]:
        """Return the indices of the highest maxima of a curve's magnitude (f,), the highest first."""
        size = np.abs(curve)
        tops = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])) + 1
        return np.asarray(tops[np.argsort(-size[tops], kind="stable")][:count])


def touching_meshes(machine: CoupledMachine, contact: ContactState) -> tuple[int, ...]:
    """Numbers of the gear meshes whose loaded flanks touch, drive flanks or, in a braked pair, back flanks."""
    return tuple(mesh for mesh, flanks in enumerate(machine.loaded_contacts) if contact.stiffness[flanks] > 0.0)


def mesh_error_response(
    machine: CoupledMachine,
    frequencies: FloatArray,
    *,
    mesh: int = 0,
    contact: ContactState | None = None,
    modes: CoupledModes | None = None,
) -> FrequencyResponse:
    """Response to a unit transmission error of the loaded flanks of a mesh, along their line of action [1/m].

    Of a machine whose directions turn it is the motion at the frequency of the error, without its sidebands.

    Parameters
    ----------
    machine : CoupledMachine
    frequencies : ndarray, shape (f,)
        w > 0 [rad/s].
    mesh : int
        Number of the gear mesh.
    contact : ContactState, optional
        State of the contacts; by default the mean contact.
    modes : CoupledModes, optional
        Modes about the same contact, to be superposed; by default the system is solved at every frequency.

    Raises
    ------
    CouplingError
        Where the machine has no such mesh, or it does not touch.
    ModesError
        As :func:`gearwhine.coupling.linear.frequency_response`.
    """
    return mesh_error_responses(machine, frequencies, meshes=[mesh], contact=contact, modes=modes)[0]


def mesh_error_responses(
    machine: CoupledMachine,
    frequencies: FloatArray,
    *,
    meshes: Sequence[int],
    contact: ContactState | None = None,
    modes: CoupledModes | None = None,
    progress: Progress = silent,
) -> tuple[FrequencyResponse, ...]:
    """Responses as of `mesh_error_response` to the errors of several meshes, each alone."""
    state = mean_contact(machine.system) if contact is None else contact
    contacts = machine.system.contacts
    for mesh in meshes:
        if not 0 <= mesh < len(machine.meshes):
            raise CouplingError(f"gear mesh number {mesh} of {len(machine.meshes)}; expected one of those, from 0")
        if state.stiffness[machine.loaded_contacts[mesh]] == 0.0:
            tooth = contacts[machine.loaded_contacts[mesh]]
            raise CouplingError(f"{tooth.name} does not touch; expected a contact that carries an error on")
    flanks = [machine.loaded_contacts[mesh] for mesh in meshes]
    if machine.system.turns:
        model = TurningResponse(machine.system, state)
        solved = []
        for number, w in enumerate(frequencies.tolist()):
            solved.append(model.respond(w, [({}, {flank: 1.0}) for flank in flanks]))
            progress("responses to the errors of the meshes", (number + 1) / len(frequencies))
        motions: list[_Motion] = [
            _turning_motion(model, [{order: moved[place] for order, moved in at.items()} for at in solved])
            for place in range(len(flanks))
        ]
    else:
        laws = [state.stiffness[number] + 1j * frequencies * state.damping[number] for number in flanks]
        motions = [
            _Motion(
                response(
                    machine.system,
                    law[:, None, None] * contacts[number].direction,
                    frequencies,
                    state,
                    _pairs_of(modes),
                )[:, 0]
            )
            for number, law in zip(flanks, laws, strict=True)
        ]
    return tuple(
        _named(machine, state, frequencies, motion, f"transmission error of {contacts[number].name}", "m", number)
        for number, motion in zip(flanks, motions, strict=True)
    )


def sensor_force_response(
    machine: CoupledMachine,
    frequencies: FloatArray,
    *,
    sensor: str,
    contact: ContactState | None = None,
    modes: CoupledModes | None = None,
) -> FrequencyResponse:
    """Response to a unit force along a sensor [1/N], as of a hammer blow.

    Raises
    ------
    CouplingError
        Where the housing has no such sensor.
    ModesError
        As :func:`gearwhine.coupling.linear.frequency_response`.
    """
    rows = machine.sensor_rows
    if sensor not in rows:
        raise CouplingError(f"no sensor {sensor!r}; there are: {', '.join(rows) or 'none'}")
    state = mean_contact(machine.system) if contact is None else contact
    if machine.system.turns:
        model = TurningResponse(machine.system, state)
        load = {model.still: rows[sensor].astype(np.complex128)}
        by_order = [
            {order: moved[0] for order, moved in model.respond(w, [(load, {})]).items()} for w in frequencies.tolist()
        ]
        return _named(machine, state, frequencies, _turning_motion(model, by_order), f"force at {sensor}", "N")
    loads = np.broadcast_to(rows[sensor], (len(frequencies), 1, machine.system.size))
    moved = response(machine.system, loads, frequencies, state, _pairs_of(modes))[:, 0]
    return _named(machine, state, frequencies, _Motion(moved), f"force at {sensor}", "N")


def unbalance_response(
    machine: CoupledMachine,
    speeds: Sequence[float] | FloatArray,
    *,
    rotor: str,
    contact: ContactState | None = None,
) -> FrequencyResponse:
    """Unbalance response of a rotor with its own unbalances alone, over the speed of the leading rotor.

    The machine is assembled at each speed: gyroscopic terms and bearings with tables follow. Of a machine whose
    directions turn it is the motion at the frequency of the unbalance in space, which the housing feels; see
    `unbalance_responses` for its sidebands, in which bearings and meshes that turn have their forces.

    Parameters
    ----------
    machine : CoupledMachine
    speeds : sequence of float
        Speeds of the leading rotor [rad/s], none 0.
    rotor : str
    contact : ContactState, optional
        Contact at every speed; by default the mean contact under the machine's load.

    Returns
    -------
    FrequencyResponse
        Response with w the signed speeds of that rotor: amplitudes rotate with it. Where its coordinates turn with a
        carrier and no directions turn against them, w is the speed over the carrier's.

    Raises
    ------
    CouplingError
        Where the rotor has no unbalance, or a speed is 0.
    """
    return unbalance_responses(machine, speeds, rotor=rotor, contact=contact)[0]


def unbalance_responses(
    machine: CoupledMachine,
    speeds: Sequence[float] | FloatArray,
    *,
    rotor: str,
    contact: ContactState | None = None,
) -> tuple[FrequencyResponse, ...]:
    """Unbalance response of a rotor, as of `unbalance_response`, and its sidebands by the turning of carriers.

    The unbalance of a planet, at Ω in space, shakes the planets and their meshes at Ω - f, seen from the carrier, which
    turns at f: the sideband by one turn. The housing feels it at Ω, and the others as far as it is not alike all round.

    Returns
    -------
    tuple of FrequencyResponse
        The response, and each sideband at which a sensor moves by more than a thousandth of its highest amplitude, the
        highest first; its name says by how many turns of which carriers it is off. Frequencies w of a sideband may have
        the other sign.

    Raises
    ------
    CouplingError
        As `unbalance_response`.
    """
    own = [load for load in machine.loads.unbalances if load.rotor == rotor and load.moment != 0.0]
    if not own:
        raise CouplingError(f"rotor {rotor!r} has no unbalance; expected one")
    at_speeds = [machine.at_speed(float(speed)) for speed in speeds]
    if any(at_speed.speeds[rotor] == 0.0 for at_speed in at_speeds):
        raise CouplingError("a speed of 0, where an unbalance has no force; expected others")
    state = mean_contact(at_speeds[0].system) if contact is None else contact
    named, unit = f"unbalance of {rotor}", "unbalance as it is"
    by_sideband: dict[str, list[FrequencyResponse]] = {}
    for at_speed in at_speeds:
        acting = CoordinateLoads(np.zeros(at_speed.system.size))
        for unbalance in own:
            MachineCoordinates(at_speed.system.components, at_speed.speeds).add_unbalance(acting, unbalance)
        turning, w = CarrierSidebands(at_speed, state), at_speed.speeds[rotor]
        rotating = replace(acting.harmonic[0], amplitude=np.sum([each.amplitude for each in acting.harmonic], axis=0))
        if not at_speed.system.turns:
            # Where the rotor's coordinates turn with a carrier, so do those of all that is coupled to it.
            (load,) = turning.frames.harmonics(rotating, 0.0)
            at = np.array([load.frequency])
            motion = _Motion(response(at_speed.system, load.amplitude[None, None, :], at, state)[:, 0])
            by_sideband.setdefault("", []).append(_named(at_speed, state, at, motion, named, unit))
            continue
        solved = turning.respond(w, [turning.by_order(w, rotating, 0.0)])
        moved = [{order: q[0] for order, q in solved.items()}]
        for order in turning.model.orders:
            at, words = np.array([w + turning.model.shift(order)]), turning.sideband(order).words
            motion = _turning_motion(turning.model, moved, order)
            by_sideband.setdefault(words, []).append(_named(at_speed, state, at, motion, named + words, unit))
    joined = {words: _along_speeds(parts) for words, parts in by_sideband.items()}
    main = joined.pop("")
    highest = {
        name: max(float(np.abs(one.sensor_acceleration[name]).max()) for one in (main, *joined.values()))
        for name in main.sensor_acceleration
    }

    def share(one: FrequencyResponse) -> float:
        parts = [
            float(np.abs(signal).max()) / highest[name]
            for name, signal in one.sensor_acceleration.items()
            if highest[name] > 0.0
        ]
        return max(parts, default=0.0)

    seen = [one for one in joined.values() if share(one) > _FAINT_SIDEBAND]
    return (main, *sorted(seen, key=lambda one: -share(one)))


def _along_speeds(parts: Sequence[FrequencyResponse]) -> FrequencyResponse:
    """Join responses at single speeds."""
    first = parts[0]
    return FrequencyResponse(
        excitation=first.excitation,
        unit=first.unit,
        frequencies=np.concatenate([part.frequencies for part in parts]),
        coordinates=np.concatenate([part.coordinates for part in parts]),
        sensor_acceleration=_joined([part.sensor_acceleration for part in parts]),
        bearing_load=_joined([part.bearing_load for part in parts]),
        mesh_force=_joined([part.mesh_force for part in parts]),
    )


def _joined(responses: list[dict[str, ComplexArray]]) -> dict[str, ComplexArray]:
    return {name: np.concatenate([part[name] for part in responses]) for name in responses[0]}


@dataclass(frozen=True)
class _Motion:
    """Coordinates (f, n) of a motion, and the deflections of connectors in it, shape (f, d)."""

    coordinates: ComplexArray

    def deflection(self, directions: FloatArray, turning: Sequence[TurningPart]) -> ComplexArray:
        """Deflection of a connector of directions (n, d), which stand still."""
        return np.asarray(self.coordinates @ directions)


@dataclass(frozen=True)
class _TurningMotion(_Motion):
    """Motion at one order of a machine whose directions turn, with its coordinates by all orders."""

    model: TurningResponse
    by_order: Mapping[Order, ComplexArray]
    order: Order

    def deflection(self, directions: FloatArray, turning: Sequence[TurningPart]) -> ComplexArray:
        """Deflection at the order, by motions of the orders from which the directions turn them to it."""
        return self.model.deflection(self.by_order, directions, turning, self.order)


def _turning_motion(
    model: TurningResponse, motions: Sequence[Mapping[Order, ComplexArray]], order: Order | None = None
) -> _TurningMotion:
    """Motion at an order, by default the excitation's, from coordinates (n,) by order at each frequency."""
    at = model.still if order is None else order
    by_order = {one: np.array([motion[one] for motion in motions]) for one in motions[0]}
    return _TurningMotion(by_order[at], model, by_order, at)


def _named(
    machine: CoupledMachine,
    state: ContactState,
    frequencies: FloatArray,
    motion: _Motion,
    excitation: str,
    unit: str,
    erring: int | None = None,
) -> FrequencyResponse:
    """Response at sensors, bearings and meshes from a motion; one contact may have a unit error."""
    system, rate, moved = machine.system, 1j * frequencies, motion.coordinates
    loads = {}
    for connector in system.linear[: len(machine.bearings)]:
        deflection = motion.deflection(connector.directions, connector.turning)
        loads[connector.name] = np.zeros((len(moved), 5), dtype=np.complex128)
        loads[connector.name][:, list(connector.axes or range(deflection.shape[1]))] = (
            deflection @ connector.stiffness.T + (rate[:, None] * deflection) @ connector.damping.T
        )
    mesh_forces = {}
    for number, tooth in enumerate(system.contacts):
        if state.stiffness[number] != 0.0 or state.damping[number] != 0.0:
            compression = motion.deflection(tooth.direction[:, None], tooth.turning)[:, 0]
            compression = compression - (1.0 if number == erring else 0.0)
            mesh_forces[tooth.name] = (state.stiffness[number] + rate * state.damping[number]) * compression
    return FrequencyResponse(
        excitation=excitation,
        unit=unit,
        frequencies=np.asarray(frequencies),
        coordinates=moved,
        sensor_acceleration={name: -(frequencies**2) * (moved @ row) for name, row in machine.sensor_rows.items()},
        bearing_load=loads,
        mesh_force=mesh_forces,
    )


_NEIGHBOURHOOD = np.linspace(-0.015, 0.015, 7)  # relative frequencies at which the two bases are compared
_SAFETY = 2.0
_LEAST_LINE_ERROR = 0.005
_LARGEST_LINE_ERROR = 10.0  # errors beyond ten times the line carry no information


@dataclass(frozen=True)
class BasisError:
    """Modal truncation error of a machine, by the same machine on another basis.

    Directions that turn are frozen in both: what a basis lacks does not depend on the angle of the carriers.

    Attributes
    ----------
    machine : CoupledMachine
        Machine on the basis whose error is estimated.
    other : CoupledMachine
        The same machine on another basis, its sensors, meshes and bearings in the same order.
    """

    machine: CoupledMachine
    other: CoupledMachine

    def at(self, frequencies: Sequence[float] | FloatArray) -> dict[str, FloatArray]:
        """Relative error of the motion of each sensor.

        Parameters
        ----------
        frequencies : ndarray, shape (f,)
            w > 0 [rad/s].

        Returns
        -------
        dict of str to ndarray, shape (f,)
            Relative error by name of the sensor, between 0.005 and 10.

        Raises
        ------
        CouplingError
            Where a frequency is 0.
        ModesError
            Where an undamped mode is driven at its own frequency.
        """
        requested = np.asarray(frequencies, dtype=np.float64)
        if not requested.size or not self.machine.sensor_rows:
            return {name: np.zeros(requested.size) for name in self.machine.sensor_rows}
        w = (requested[:, None] * (1.0 + _NEIGHBOURHOOD)).ravel()
        pairs, other_pairs = self._pairs
        ours, others = _sensor_responses(self.machine, pairs, w), _sensor_responses(self.other, other_pairs, w)
        errors = {}
        for name, motion in ours.items():
            size = np.linalg.norm(motion, axis=1)
            apart = np.linalg.norm(motion - others[name], axis=1)
            part = np.divide(apart, size, out=np.zeros_like(apart), where=size > 0.0)
            errors[name] = np.clip(
                _SAFETY * part.reshape(requested.size, -1).max(axis=1), _LEAST_LINE_ERROR, _LARGEST_LINE_ERROR
            )
        return errors

    @cached_property
    def _pairs(self) -> tuple[Eigenpairs | None, Eigenpairs | None]:
        """Eigenpairs of both machines: superposing them costs a hundredth of solving at each of many frequencies."""
        return _superposable(self.machine.system), _superposable(self.other.system)


def _superposable(system: CoupledSystem) -> Eigenpairs | None:
    """Eigenpairs about the mean contact; None where they fail their proof, since the system can always be solved."""
    try:
        pairs = quadratic_eigenpairs(*linear_matrices(system.standing(0.0), mean_contact(system)))
    except ModesError:
        return None
    return pairs if pairs.sum_rule <= SUM_RULE else None


def _sensor_responses(
    machine: CoupledMachine, pairs: Eigenpairs | None, frequencies: FloatArray
) -> dict[str, ComplexArray]:
    """Motion along each sensor by each excitation, shape (f, e): by superposition where there are eigenpairs."""
    loads_of_lines = excitations(machine)
    loads = np.broadcast_to(loads_of_lines, (len(frequencies), *loads_of_lines.shape))
    moved = response(machine.system.standing(0.0), loads, frequencies, pairs=pairs)
    return {name: moved @ row for name, row in machine.sensor_rows.items()}


def excitations(machine: CoupledMachine) -> FloatArray:
    """Return unit loads, shape (e, n): along each line of action; without gears, at each bearing."""
    loaded = [contact.direction for contact in machine.system.contacts if contact.loaded]
    if loaded:
        return np.array(loaded)
    across = [connector.directions[:, :2].T for connector in machine.system.linear[: len(machine.bearings)]]
    return np.concatenate(across) if across else np.zeros((0, machine.system.size))
