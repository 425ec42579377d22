"""Harmonic response of a turning rotor, by the exact equations of both planes.

A load Re[F e^{iωt}] at a node stands on the right of the equations of `gearwhine.rotors.whirl.equations` at λ = iω,
with a negative sign in the node's force balance. No modes are summed, so nothing is truncated.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors.errors import require, require_finite
from gearwhine.rotors.model.bearing import Bearing
from gearwhine.rotors.model.loads import HarmonicForce
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.whirl.circular_coordinates import BLOCK_COORDINATES, CIRCULAR, coupled_motions
from gearwhine.rotors.whirl.equations import WhirlEquations, equations_at_speed, whirl_equations, whirl_reach
from gearwhine.rotors.whirl.motion import ShaftMotion

# Circular loads over r+, β+, r−, β−, z at some places and frequencies, (b, places, 5), N and N·m.
Loads = ComplexArray


@dataclass(frozen=True)
class Orbit:
    """Elliptic orbits of points of the shaft.

    Attributes
    ----------
    major, minor : ndarray
        Half axes [m]; the minor one is positive where the orbit runs counter-clockwise, negative where clockwise.
    inclination : ndarray
        Angle of the major axis from x, between −π/2 and π/2 [rad].
    """

    major: FloatArray
    minor: FloatArray
    inclination: FloatArray


@dataclass(frozen=True)
class HarmonicResponse:
    """Steady motion Re[X e^{iωt}] of a rotor, one for each frequency.

    Attributes
    ----------
    frequencies, speeds : ndarray, shape (b,)
        Frequencies ω and speeds of rotation Ω [rad/s].
    motion : ShaftMotion
        The shaft's exact motion.
    bearings : tuple of str
        Names of the bearings.
    bearing_forces : ndarray of complex, shape (b, bearings, 5)
        Force on the carrier of each bearing, over x, y, z [N] and about x and y [N·m].
    """

    frequencies: FloatArray
    speeds: FloatArray
    motion: ShaftMotion = field(repr=False)
    bearings: tuple[str, ...]
    bearing_forces: ComplexArray = field(repr=False)

    def evaluate(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex x and y at positions z [m], both (b, len(z)) [m]."""
        return self.motion.evaluate(z)

    def probe(self, z: float, angle: float) -> ComplexArray:
        """Complex amplitude along a direction at ``angle`` [rad] from x, (b,) [m]: abs is it.

        Its phase lag is −angle of `at_positive_frequency`.
        """
        x, y = self.motion.evaluate([z])
        return np.asarray(x[:, 0] * np.cos(angle) + y[:, 0] * np.sin(angle))

    def orbit(self, z: npt.ArrayLike) -> Orbit:
        """Orbits at positions z [m], axes (b, len(z))."""
        x, y = self.motion.evaluate(z)
        return orbit_of(x, y, self.frequencies[:, None])


def at_positive_frequency(amplitude: ComplexArray, frequencies: FloatArray) -> ComplexArray:
    """Amplitude of the same signal at |ω|, whose phase lag is −angle: Re[A e^{iωt}] = Re[conj(A) e^{i|ω|t}] for ω < 0.

    Parameters
    ----------
    amplitude : ndarray of complex, shape (b, ...)
        Amplitude A of the signals Re[A e^{iωt}].
    frequencies : ndarray, shape (b,)
        Frequencies ω [rad/s]; −0.0 is the limit of a clockwise rotor that comes to rest.
    """
    clockwise = np.signbit(frequencies).reshape(-1, *[1] * (amplitude.ndim - 1))
    return np.asarray(np.where(clockwise, amplitude.conj(), amplitude))


def orbit_of(x: ComplexArray, y: ComplexArray, frequencies: FloatArray) -> Orbit:
    """Ellipse of Re[X e^{iωt}], Re[Y e^{iωt}]: r = x + i y = R₊e^{iωt} + conj(R₋)e^{−iωt}, axes |R₊| ± |R₋|."""
    plus, minus = 0.5 * (x + 1j * y), 0.5 * (x - 1j * y)
    sense = np.where(frequencies < 0.0, -1.0, 1.0)
    inclination = 0.5 * (np.angle(plus) - np.angle(minus))
    turns = np.round(inclination / np.pi)
    return Orbit(
        np.abs(plus) + np.abs(minus), sense * (np.abs(plus) - np.abs(minus)), np.asarray(inclination - np.pi * turns)
    )


def harmonic_response(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    forces: Sequence[HarmonicForce],
    frequencies: npt.ArrayLike,
    speed: float = 0.0,
) -> HarmonicResponse:
    """Response to harmonic forces that do not turn with the rotor.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor and its bearings; tables over speed are read at ``speed``.
    forces : sequence of HarmonicForce
        Forces with their places and complex amplitudes.
    frequencies : array_like, shape (b,)
        Frequencies ω [rad/s].
    speed : float
        Speed of rotation Ω [rad/s].

    Raises
    ------
    RotorError
        A place off the shaft, or a number that is not finite.
    """
    omega = finite_values("frequencies", frequencies)
    loads = np.broadcast_to(
        np.array([force.circular for force in forces]).reshape(1, -1, 5), (omega.size, len(forces), 5)
    )
    return solve_harmonic(rotor, bearings, [f.at for f in forces], loads, omega, np.full(omega.size, float(speed)))


def frequency_response(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    loaded: Sequence[tuple[float, str]],
    read: Sequence[tuple[float, str]],
    frequencies: npt.ArrayLike,
    speed: float = 0.0,
) -> ComplexArray:
    """Receptance between places: displacement at each read place per unit force at each loaded one.

    Parameters
    ----------
    loaded, read : sequence of (float, str)
        Place in m and direction, "x" or "y".
    frequencies : array_like, shape (b,)
        Frequencies ω [rad/s].
    speed : float
        Speed of rotation Ω [rad/s].

    Returns
    -------
    ndarray of complex, shape (b, read, loaded)
        Receptances [m/N].

    Raises
    ------
    RotorError
        As `harmonic_response`, or another direction.
    """
    for _, direction in (*loaded, *read):
        require(direction in ("x", "y"), "direction", direction, "'x' or 'y'")
    columns = []
    for at, direction in loaded:
        force = HarmonicForce(at, x=1.0) if direction == "x" else HarmonicForce(at, y=1.0)
        x, y = harmonic_response(rotor, bearings, [force], frequencies, speed).evaluate([place for place, _ in read])
        chosen = [x[:, k] if way == "x" else y[:, k] for k, (_, way) in enumerate(read)]
        columns.append(np.stack(chosen, axis=1))
    return np.stack(columns, axis=2)


def solve_harmonic(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    places: Sequence[float],
    loads: Loads,
    frequencies: FloatArray,
    speeds: FloatArray,
) -> HarmonicResponse:
    """Response to loads (b, places, 5) over the circular coordinates, at every ω and Ω, (b,) each."""
    for bearing in bearings:
        rotor.require_on_shaft(f"bearing {bearing.name!r}", bearing.at)
    for place in places:
        rotor.require_on_shaft("load", place)
    tabled = any(bearing.speeds is not None for bearing in bearings)
    constant = [bearing.at_speed(float(speeds[0])) if tabled else bearing for bearing in bearings]
    # Tables may couple motions at one speed and not at another: then all are solved together.
    sets = coupled_motions([b.at_speed(float(s)) for s in speeds for b in bearings] if tabled else constant)
    highest = max(
        (whirl_reach(float(w), float(s)) for w, s in zip(np.abs(frequencies), speeds, strict=True)), default=0.0
    )
    eigenvalues = (1j * frequencies).astype(np.complex128)
    forces = np.zeros((frequencies.size, len(constant), 5), dtype=np.complex128)
    motion: ShaftMotion | None = None
    for blocks in sets:
        equations = whirl_equations(rotor, constant, blocks, max(highest, 1e-6), places)
        scale = equations.response_scale(eigenvalues)
        sides = _sides(equations, places, loads) / scale[:, None]
        solutions = np.empty((frequencies.size, equations.pattern.order), dtype=np.complex128)
        runs = (
            [(slice(k, k + 1), equations_at_speed(equations, bearings, float(s))) for k, s in enumerate(speeds)]
            if tabled
            else [(slice(None), equations)]
        )
        for run, own_equations in runs:
            values = own_equations.values(eigenvalues[run], speeds[run].astype(np.complex128), scale[run])
            solutions[run] = own_equations.pattern.solve(values, sides[run, None])[:, 0]
            forces[run] += bearing_forces(own_equations, solutions[run], scale[run])
        part = ShaftMotion.of(equations, eigenvalues, speeds.astype(np.complex128), solutions, scale)
        motion = part if motion is None else motion.plus(part)
    assert motion is not None
    return HarmonicResponse(frequencies, speeds, motion, tuple(bearing.name for bearing in bearings), forces)


def bearing_forces(equations: WhirlEquations, solutions: ComplexArray, scale: FloatArray) -> ComplexArray:
    """Return the bearing forces on the bearings' carriers, (b, bearings, 5), over x, y, z and about x and y, in SI."""
    length, angle = equations.bending.displacement_unit
    forces = np.zeros((solutions.shape[0], len(equations.node_bearings), 5), dtype=np.complex128)
    for index, (node_bearing, places) in enumerate(
        zip(equations.node_bearings, equations.layout.bearings, strict=True)
    ):
        force = np.zeros((solutions.shape[0], 5), dtype=np.complex128)
        force[:, list(node_bearing.directions)] = solutions[:, places.forces] * scale[:, None]
        if node_bearing.circular:
            # The change of coordinates is unitary: its inverse is its adjoint.
            force = (force / np.array([length, angle, length, angle, length])) @ CIRCULAR.conj()
        else:
            force = force / np.array([length, length, length, angle, angle])
        forces[:, index] = force
    return forces


def _sides(equations: WhirlEquations, places: Sequence[float], loads: Loads) -> ComplexArray:
    """Right-hand sides (b, order) of loads, before the scale of forces."""
    members = [member for block in equations.blocks for member in BLOCK_COORDINATES[block]]
    sides = np.zeros((loads.shape[0], equations.pattern.order), dtype=np.complex128)
    for index, place in enumerate(places):
        row = equations.layout.balances[equations.bending.node_at(place)]
        sides[:, row] -= loads[:, index][:, members] * equations.units
    return sides


def finite_values(label: str, values: npt.ArrayLike) -> FloatArray:
    """Return one or more finite values as a vector; ``label`` names them in the message of the error."""
    array = np.atleast_1d(np.asarray(values, dtype=np.float64))
    require(array.ndim == 1 and array.size > 0, f"{label} shape", array.shape, "one dimension and at least one value")
    for value in array.tolist():
        require_finite(label, value)
    return array
