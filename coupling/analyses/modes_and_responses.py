"""Linear analyses of the coupled system: modes, Campbell diagram, responses at gears and sensors to mesh errors."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError, ModesError
from gearwhine.coupling.linear.campbell import SystemCampbell, system_campbell
from gearwhine.coupling.linear.carriers.floquet_exponents import floquet_exponents
from gearwhine.coupling.linear.carriers.frozen_directions import FROZEN_MODES, frozen_warnings
from gearwhine.coupling.linear.carriers.turning_response import TurningResponse
from gearwhine.coupling.linear.complex_modes import CoupledModes, Stability, coupled_modes
from gearwhine.coupling.linear.complex_modes import stability as coupled_stability
from gearwhine.coupling.linear.excitation_orders import excitation_lines
from gearwhine.coupling.linear.frequency_response import (
    FrequencyResponse,
    mesh_error_responses,
    resonance_grid,
    touching_meshes,
    unbalance_responses,
)
from gearwhine.coupling.linear.lines_over_speed import LinesOverSpeed, lines_over_speed
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel, ResponseParts
from gearwhine.coupling.statics.mean_mesh import ContactState, contact_at, mean_contact, time_of_phase, unloaded_contact
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning, warning

_TWO_PI = 2.0 * np.pi

MESH_HARMONICS = 3
"""Harmonics of each mesh in a Campbell diagram, by default."""

_LOWEST_HZ = 20.0  # lowest frequency of a response
_HARMONICS = 4.0  # mesh harmonics that a response covers where no housing limits the model
_MODES = 6  # least number of modes in a diagram
_UNBALANCE_STEPS = 200  # speeds of the response to unbalance
_SLOWEST_OF_LINES = 0.1  # part of the highest speed below which lines of the meshes are left out
_DIRECT = 24  # frequencies at which superposition is compared with the solved system
_EXPONENTS = 24  # lowest modes whose exponents with turning carriers are solved
_NAMED_MODES = 5  # growing modes named one by one


@dataclass(frozen=True)
class SolvedSystem:
    """The coupled system of a machine, linear about a contact.

    Attributes
    ----------
    machine : gearwhine.coupling.CoupledMachine
    mesh_phase : float or None
        Phase of the first mesh at which the contact stands; None for the mean contact.
    contact : ContactState
        Contact about which modes and responses to mesh errors are linear.
    modes : CoupledModes
    stability : Stability
    responses : tuple of FrequencyResponse
        Responses to a unit transmission error of each mesh.
    superposition_error : float or None
        Largest difference of these from direct solutions, at some frequencies, as a part of the largest amplitude; None
        where they are solved directly.
    campbell : SystemCampbell or None
        Campbell diagram, where it is asked for.
    unbalance : tuple of FrequencyResponse
        Responses to the unbalances of each rotor that has any, over the speeds of the diagram, at w > 0; where
        directions turn, each is followed by its sidebands at the sensors.
    unbalance_speeds : ndarray, shape (u,)
        Speeds of the leading rotor [rad/s].
    lines : tuple of ResponseParts
        Motions at the mesh harmonics of operation by transmission error and load shuttling, with a housing that has
        sensors, about the mean contact.
    order_lines : LinesOverSpeed or None
        Mesh harmonics at the housing's sensors at the speeds of the diagram, at its resonances and in operation; None
        without a diagram, and of machines whose directions turn, whose sidebands are not these lines.
    exponents : ndarray of complex, shape (m,), or None
        Floquet exponent of each mode [1/s], of the lowest oscillating ones of a machine whose directions turn; NaN of
        others.
    """

    machine: CoupledMachine
    mesh_phase: float | None
    contact: ContactState
    modes: CoupledModes
    stability: Stability
    responses: tuple[FrequencyResponse, ...]
    superposition_error: float | None
    campbell: SystemCampbell | None = None
    unbalance: tuple[FrequencyResponse, ...] = ()
    unbalance_speeds: FloatArray | None = None
    lines: tuple[ResponseParts, ...] = ()
    order_lines: LinesOverSpeed | None = None
    exponents: ComplexArray | None = None

    @property
    def speed(self) -> float:
        """Speed of the first driver's shaft [rad/s]."""
        return self.machine.speed

    @property
    def warnings(self) -> tuple[ResultWarning, ...]:
        """Warnings of the modes and of the diagram."""
        of_diagram = () if self.campbell is None else self.campbell.warnings
        return (*unstable_modes_warnings(self.stability), *self._frozen_warnings(), *of_diagram)

    def _frozen_warnings(self) -> tuple[ResultWarning, ...]:
        """Warnings of modes with frozen carriers, with the error that their exponents show."""
        if self.exponents is None:
            return self.modes.warnings
        solved = np.flatnonzero(~np.isnan(self.exponents))
        if not solved.size:
            return self.modes.warnings
        frozen, exact = self.modes.eigenvalues[solved], self.exponents[solved]
        errors = np.abs(frozen) / np.abs(exact) - 1.0
        most = int(np.argmax(np.abs(errors)))
        hertz, label = float(abs(exact[most])) / _TWO_PI, self.modes.labels[solved[most]]
        effect = (
            f"of {solved.size} modes whose exponents with turning carriers are solved too, the largest error of a "
            f"frequency is {100.0 * errors[most]:+.2g} % ({label}, {hertz:.5g} Hz turning)"
        )
        growing = [self.modes.labels[number] for number in solved if self.exponents[number].real > 0.0]
        if growing:
            effect += f"; turning, these grow by themselves: {', '.join(growing)}"
        system, largest = self.machine.system, float(errors[most])
        return frozen_warnings(system, FROZEN_MODES, effect, largest_error=largest, frequency_hz=hertz, mode=label)

    @property
    def unloaded(self) -> ContactState:
        """The contact with the mean mesh stiffness without load."""
        return unloaded_contact(self.machine.system)


def solve_system(
    machine: CoupledMachine,
    progress: Progress = silent,
    *,
    mesh_phase: float | None = None,
    over_speed: Sequence[float] = (),
    sidebands: int = 0,
    mesh_harmonics: int = MESH_HARMONICS,
) -> SolvedSystem:
    """Modes, stability and frequency responses at the speed of operation; where asked, the modes over speed.

    Parameters
    ----------
    machine : CoupledMachine
    progress : callable
    mesh_phase : float, optional
        Phase at which the teeth of the first pair stand, 0 to 1; by default the mean contact.
    over_speed : sequence of float
        Signed speeds of the first driver's shaft [rad/s], two or more, ascending in size, over which to solve the
        Campbell diagram and the response to unbalance as well; none by default.
    sidebands : int
        Number of shaft-order sidebands of either gear, drawn on each side of every mesh order.
    mesh_harmonics : int
        Number of harmonics of each mesh whose resonances the diagram has.

    Raises
    ------
    gearwhine.coupling.CouplingError
        Where a phase is asked for without gears that turn.
    gearwhine.coupling.ModesError
        Where modes fail their proof.
    """
    progress("modes of the coupled system")
    system = machine.system
    contact = mean_contact(system) if mesh_phase is None else _instant(machine, mesh_phase)
    modes = coupled_modes(system, contact)
    responses, error = _mesh_responses(machine, modes, contact, progress)
    lines = _sensor_lines(machine) if mesh_phase is None else ()
    solved = SolvedSystem(machine, mesh_phase, contact, modes, coupled_stability(modes), responses, error, lines=lines)
    if system.turns:
        solved = replace(solved, exponents=_exponents(solved, progress))
    return _over_speed(solved, over_speed, progress, sidebands, mesh_harmonics) if over_speed else solved


def _instant(machine: CoupledMachine, phase: float) -> ContactState:
    """Return the state of contact when the first pair's teeth stand at a phase."""
    if not machine.system.contacts or machine.system.contacts[0].mesh_frequency == 0.0:
        raise CouplingError("a phase of teeth that do not turn; expected gear pairs, and a speed")
    if not 0.0 <= phase <= 1.0:
        raise CouplingError(f"a mesh phase of {phase:g}; expected a part of the mesh period, 0 to 1")
    return contact_at(machine.system, time_of_phase(machine.system, phase))


def _exponents(solved: SolvedSystem, progress: Progress) -> ComplexArray:
    """Solve the Floquet exponents of the lowest oscillating modes of a machine whose directions turn, shape (m,)."""
    modes = solved.modes
    limit = _TWO_PI * _frequency_limit(solved.machine)
    proper = np.array([kind not in ("residual", "rigid") for kind in modes.kinds])
    swinging = proper & (modes.eigenvalues.imag > 0.0) & (np.abs(modes.eigenvalues) <= limit)
    chosen = np.flatnonzero(swinging)[:_EXPONENTS]
    exponents = np.full(len(modes.kinds), complex(np.nan, np.nan))
    model = TurningResponse(solved.machine.system, solved.contact)
    exponents[chosen] = floquet_exponents(
        model, modes.eigenvalues[chosen], modes.shapes[chosen], modes.left[chosen], progress
    )
    return exponents


def _mesh_responses(
    machine: CoupledMachine,
    modes: CoupledModes,
    contact: ContactState,
    progress: Progress,
) -> tuple[tuple[FrequencyResponse, ...], float | None]:
    """Return responses to the error of each mesh by superposition, and their largest error against direct solutions.

    Of a machine whose directions turn, where modes are no basis of responses, they are direct solutions themselves.
    """
    touching = touching_meshes(machine, contact)
    if not touching:
        return (), None
    limit = _frequency_limit(machine)
    turns = machine.system.turns
    frequencies = resonance_grid(modes, _TWO_PI * min(_LOWEST_HZ, 0.1 * limit), _TWO_PI * limit, coarse=turns)
    if turns:
        # They are solved directly, by harmonic balance.
        return mesh_error_responses(machine, frequencies, meshes=touching, contact=contact, progress=progress), None
    try:
        responses = mesh_error_responses(machine, frequencies, meshes=touching, contact=contact, modes=modes)
    except ModesError:
        # Nearly parallel modes cannot be superposed; the system itself can always be solved.
        return mesh_error_responses(machine, frequencies, meshes=touching, contact=contact), None
    chosen = np.unique(np.linspace(0, frequencies.size - 1, _DIRECT).astype(int))
    largest = 0.0
    directs = mesh_error_responses(machine, frequencies[chosen], meshes=touching, contact=contact)
    for direct, by_modes in zip(directs, responses, strict=True):
        difference = np.abs(by_modes.coordinates[chosen] - direct.coordinates)
        largest = max(largest, float(difference.max() / np.abs(direct.coordinates).max()))
    return responses, largest


def _sensor_lines(machine: CoupledMachine) -> tuple[ResponseParts, ...]:
    """Motions at the mesh harmonics below the housing's limit; none without a sensor, a load or a speed."""
    housing = machine.housing
    if housing is None or not housing.sensors or housing.complete_below is None:
        return ()
    return MeshHarmonicModel(machine).parts(housing.complete_below)


def _frequency_limit(machine: CoupledMachine) -> float:
    """Return the upper frequency of responses [Hz]: that of the housing's modes, or some harmonics of the meshes."""
    if machine.housing is not None and machine.housing.complete_below is not None:
        return machine.housing.complete_below / _TWO_PI
    highest = max((abs(contact.mesh_frequency) for contact in machine.system.contacts), default=0.0)
    return _HARMONICS * highest if highest > 0.0 else 1000.0


def _over_speed(
    solved: SolvedSystem,
    speeds: Sequence[float],
    progress: Progress,
    sidebands: int,
    mesh_harmonics: int,
) -> SolvedSystem:
    machine = solved.machine
    lines = excitation_lines(machine, mesh_harmonics=range(1, mesh_harmonics + 1), sidebands=sidebands)
    mean = solved.contact if solved.mesh_phase is None else mean_contact(machine.system)
    if machine.housing is not None and machine.housing.complete_below is not None:
        limit = machine.housing.complete_below
    else:
        swinging = np.abs(solved.modes.eigenvalues[solved.modes.eigenvalues.imag > 0.0])
        lowest = float(np.sort(swinging)[:_MODES][-1]) if swinging.size else 0.0
        limit = 1.05 * max(lowest, max(line.order for line in lines) * abs(speeds[-1]))
    campbell = system_campbell(
        machine,
        speeds,
        frequency_limit=limit,
        lines=lines,
        contact=mean,
        progress=progress,
    )
    driven = list(dict.fromkeys(unbalance.rotor for unbalance in machine.loads.unbalances if unbalance.moment != 0.0))
    turning = np.linspace(speeds[0] or speeds[-1] / _UNBALANCE_STEPS, speeds[-1], _UNBALANCE_STEPS)
    unbalance = []
    for rotor in driven:
        if machine.speeds[rotor] == 0.0:
            continue
        progress(f"response to the unbalance of {rotor}")
        responses = unbalance_responses(machine, turning, rotor=rotor, contact=mean)
        # A clockwise rotor's phases are those of its signals, not of e^{iwt} at its negative speed.
        unbalance += [response.at_positive_frequencies() for response in responses]
    over = None
    if solved.lines and not machine.system.turns:
        met = [one.speed for one in campbell.crossings if one.line.kind == "mesh"]  # where a line is about highest
        here = [machine.speed] if abs(machine.speed) <= abs(speeds[-1]) else []
        every = np.array(sorted({*speeds, *met, *here}, key=abs))
        # Slower than a part of the highest speed lines have more harmonics below the limit than are followed.
        loud = every[np.abs(every) >= _SLOWEST_OF_LINES * abs(speeds[-1])]
        over = lines_over_speed(machine, loud.tolist(), limit, progress=progress)
    return replace(solved, campbell=campbell, unbalance=tuple(unbalance), unbalance_speeds=turning, order_lines=over)


def unstable_modes_warnings(stability: Stability) -> list[ResultWarning]:
    """One warning for each growing mode, the fastest first; beyond a few they are counted."""
    warnings = []
    for mode in stability.growing[:_NAMED_MODES]:
        frequency = abs(mode.eigenvalue) / _TWO_PI
        where = f" ({mode.where})" if mode.where else ""
        fed = ", ".join(part.name for part, _ in mode.feeders[:3])
        warnings.append(
            warning(
                "unstable mode",
                f"the coupled {mode.kind} mode{where} at {frequency:.5g} Hz has the damping ratio "
                f"{mode.damping_ratio:.3g}: it grows by itself"
                + (f", fed by {fed}" if fed else "")
                + "; motions of this machine mean nothing beyond its onset",
                frequency_hz=frequency,
                damping_ratio=mode.damping_ratio,
                kind=mode.kind,
                where=mode.where,
            )
        )
    if len(stability.growing) > _NAMED_MODES:
        warnings.append(
            warning("unstable mode", f"{len(stability.growing) - _NAMED_MODES} further coupled modes grow as well")
        )
    return warnings


def machine_warnings(machine: CoupledMachine) -> list[ResultWarning]:
    """Warnings of the modes of a machine about its mean contact: those that grow, and frozen carriers.

    Raises
    ------
    gearwhine.coupling.ModesError
        Where modes fail their proof.
    """
    system = machine.system
    modes = coupled_modes(system, mean_contact(system))
    return [*unstable_modes_warnings(coupled_stability(modes)), *modes.warnings]
