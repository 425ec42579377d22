r"""Parametric stiffness of meshes that turn: forces by stiffness that varies, at mesh harmonics and their sidebands.

As of :mod:`gearwhine.coupling.linear.parametric_stiffness` the stiffness κ of a mesh varies with its phase, of
frequency Ω. Where directions turn with carriers at rates f, a mesh is compressed at all nΩ + m·f: what stands still is
not alike all round. With h the force that the stiffness adds along the mesh and S(n) the compressions at nΩ + m·f by
unit forces at nΩ + m'·f (:meth:`gearwhine.coupling.linear.carriers.turning_response.TurningResponse.compressions`),

    h_{n,m} = -Σ_j κ_{n-j} u_{j,m},      u_{n,m} = u°_{n,m} + Σ_m' S_{m m'}(n) h_{n,m'},

u° with the mean stiffness. At rest the load of a planet swings as its carrier turns: u°_{0,m}, m not 0, is the swing of
the compression under the constant load, with which κ makes sidebands, and the harmonic itself where the planet's
direction turns with its load. κ couples the mesh harmonics, and S the meshes and the turns m: this is Hill's method for
two periods. The unknowns are thousands, and κ varies by a part of its mean: GMRES solves them in some tens of steps.

Where the gap of a mesh swings with its load (:mod:`gearwhine.coupling.statics.flank_swing`), e and κ have the orders m
too, and κ couples them.

κ is that of the mesh harmonics: what pitch deviations change in it is left out here.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.linear.carriers.turning_response import Order, TurningResponse, plus
from gearwhine.coupling.linear.parametric_stiffness import VaryingMesh, coupled
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.statics.flank_swing import forces_over_turn, turn_waves
from gearwhine.coupling.statics.mean_mesh import MeanMesh
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_TOLERANCE = 1e-10  # of the compressions, relative
_STEPS = 200  # of GMRES


@dataclass(frozen=True, eq=False)
class SwingingMesh:
    """A mesh whose flanks swing, by the turns m of the carriers (:mod:`gearwhine.coupling.statics.flank_swing`).

    Attributes
    ----------
    errors : mapping of order to ndarray of complex, shape (2 J + 1,)
        Transmission error e_{n,m} at n = -J ... J, two-sided [m].
    stiffness : mapping of order to ndarray of complex, shape (4 J + 1,)
        κ_{n,m} less the mean mesh stiffness at n = -2 J ... 2 J [N/m].
    """

    errors: Mapping[Order, ComplexArray]
    stiffness: Mapping[Order, ComplexArray]


def by_order(of_shifts: Mapping[float, ComplexArray], model: TurningResponse) -> dict[Order, ComplexArray]:
    """Values by the order of their shifts of frequency [rad/s]; those of orders that are followed."""
    found = {model.order_of(shift): value for shift, value in of_shifts.items()}
    return {order: value for order, value in found.items() if order is not None}


@dataclass(frozen=True, eq=False)
class TurningStiffnessForce:
    """Force of a mesh by its stiffness that varies, along its line of action.

    Attributes
    ----------
    orders : tuple of order
        Turns m.
    amplitudes : ndarray of complex, shape (J + 1, m)
        By e^{i(nΩ + m·f)t} from n = 0 on [N].
    """

    orders: tuple[Order, ...]
    amplitudes: ComplexArray

    def at(self, harmonic: int) -> dict[Order, complex]:
        """Amplitudes beside a mesh harmonic by order [N]; none beyond those that are known."""
        if harmonic >= len(self.amplitudes):
            return {}
        return dict(zip(self.orders, self.amplitudes[harmonic].tolist(), strict=True))


def swings_at_rest(
    system: CoupledSystem, means: Sequence[MeanMesh | None], motions: FloatArray, model: TurningResponse
) -> dict[int, dict[Order, complex]]:
    """Swing of the compression of each loaded contact under the constant load, two-sided by turns of the carriers [m].

    At rest a contact yields along its mean curve, by the harmonic mean of its stiffness. That is the answer of the mean
    stiffness and of its variation together, of which u° = F/k is the former. Flanks that are parted are not compressed.

    Parameters
    ----------
    system : CoupledSystem
    means, motions
        See `gearwhine.coupling.statics.mean_mesh.equilibrium_over_turn`.
    model : TurningResponse
    """
    waves, found = by_order(turn_waves(system), model), dict[int, dict[Order, complex]]()
    for number, force in forces_over_turn(system, (means, motions)).items():
        mean = means[number]
        assert mean is not None
        found[number] = {
            order: complex(wave @ force) / mean.stiffness for order, wave in waves.items() if order != model.still
        }
    return found


def turning_stiffness_forces(
    meshes: Sequence[VaryingMesh],
    model: TurningResponse,
    loads: Callable[[int], Mapping[Order, ComplexArray]],
    swings: Mapping[int, Mapping[Order, complex]],
    flanks: Mapping[int, SwingingMesh],
) -> dict[int, TurningStiffnessForce]:
    """Solve the forces of meshes of one frequency by their stiffness that varies, by contact.

    Parameters
    ----------
    meshes : sequence of VaryingMesh
        Of one frequency and reach J.
    model : TurningResponse
        The machine with the mean mesh stiffness.
    loads : callable
        Loads of the meshes at a harmonic n of their frequency on the machine with the mean stiffness, by the order of
        their frequency, one-sided by e^{i(nΩ + m·f)t}.
    swings : mapping of int to mapping of order to complex
        See `swings_at_rest`.
    flanks : mapping of int to SwingingMesh
        Meshes whose flanks swing, by contact.

    Raises
    ------
    CouplingError
        Where the forces are not found, as of a machine that is about to grow on its own.
    """
    reach, rate, numbers = meshes[0].reach, meshes[0].rate, [mesh.number for mesh in meshes]
    opposite = [model.orders.index(tuple(-turn for turn in order)) for order in model.orders]
    places = {order: place for place, order in enumerate(model.orders)}
    shape = 2 * reach + 1, len(model.orders), len(meshes)
    width = shape[1] * shape[2]
    free = np.zeros(shape, dtype=np.complex128)
    compliance = np.zeros((2 * reach + 1, width, width), dtype=np.complex128)
    # The motion is real: what is at -n and -m is the conjugate of that at n and m.
    for harmonic in range(reach + 1):
        by_forces, by_loads = model.compressions(harmonic * rate, numbers, loads(harmonic) if harmonic else {})
        compliance[reach - harmonic] = by_forces[opposite][:, :, opposite].conj().reshape(width, width)
        compliance[reach + harmonic] = by_forces.reshape(width, width)
        if harmonic:
            free[reach + harmonic] = 0.5 * by_loads
            for place, mesh in enumerate(meshes):
                errors = flanks[mesh.number].errors if mesh.number in flanks else {model.still: mesh.error[0]}
                for order, error in errors.items():
                    free[reach + harmonic, places[order], place] -= error[reach + harmonic]
            free[reach - harmonic] = free[reach + harmonic][opposite].conj()
    for place, number in enumerate(numbers):
        for order, swing in swings.get(number, {}).items():
            free[reach, places[order], place] += swing
    varying = []
    for place, mesh in enumerate(meshes):
        own = flanks[mesh.number].stiffness if mesh.number in flanks else {model.still: mesh.stiffness[0]}
        for turns, stiffness in own.items():
            steps = [(places.get(plus(order, turns)), source) for order, source in places.items()]
            at = np.array([pair for pair in steps if pair[0] is not None], dtype=np.intp)
            varying.append((place, at[:, 0], at[:, 1], coupled(stiffness)))

    def forces(compression: ComplexArray) -> ComplexArray:
        found, pressed = np.zeros(shape, dtype=np.complex128), compression.reshape(shape)
        for place, acted, acting, stiffness in varying:
            found[:, acted, place] -= stiffness @ pressed[:, acting, place]
        return found

    def less_that_of_forces(compression: ComplexArray) -> ComplexArray:
        by_forces = compliance @ forces(compression).reshape(len(compliance), width, 1)
        return np.asarray(compression - by_forces.ravel())

    operator = LinearOperator((free.size, free.size), less_that_of_forces, dtype=np.complex128)
    solved, unsolved = gmres(operator, free.ravel(), rtol=_TOLERANCE, restart=_STEPS, maxiter=1)
    if unsolved:
        raise CouplingError(
            f"forces by the mesh stiffness that varies at {rate / (2.0 * np.pi):.6g} Hz: GMRES has not settled in "
            f"{_STEPS} steps; expected a machine that is stable with its varying stiffness"
        )
    found = 2.0 * forces(solved)[reach:]
    return {number: TurningStiffnessForce(model.orders, found[:, :, place]) for place, number in enumerate(numbers)}
