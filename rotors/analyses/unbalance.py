"""Unbalance response and residual bow: exact synchronous motion with amplitude and phase.

An unbalance m e at the angle φ on the rotor is the force m e Ω² e^{iφ} that turns with it: x + i y of the force is
m e Ω² e^{i(Ωt + φ)}, which in circular coordinates loads r+ alone, by √2 m e Ω² e^{iφ}, and what anisotropic
bearings make of it. A bow b(z) is the stress-free shape of the shaft; the shaft's own stiffness acts on what
its motion u differs from it, K_s(u − b e^{iΩt}), so that K_s b loads the straight shaft. Of all curves through the
measured points the shaft's own takes the least strain energy; then K_s b is the reactions R_k that would hold a
straight shaft at the points, and only they are needed. One or two points define a rigid run-out: it loads nothing.

A probe reads the surface: at slow roll the run-out b itself, at speed b + u(Ω) − u(0). For a bow that vanishes at two
bearings u(0) = b, and the probe reads the motion u; of a rigid run-out it reads the run-out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import ComplexArray
from gearwhine.rotors.analyses.harmonic_response import HarmonicResponse, finite_values, solve_harmonic
from gearwhine.rotors.model.bearing import Bearing
from gearwhine.rotors.model.loads import Bow, Unbalance
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.transfer_matrix.rotor_shafts import bending_shaft
from gearwhine.rotors.whirl.modal_projection import slowest


@dataclass(frozen=True)
class SynchronousResponse(HarmonicResponse):
    """Steady motion at the speed of rotation, ω = Ω; times are counted from where the rotor's mark passes x.

    Attributes
    ----------
    slow_roll : HarmonicResponse or None
        Response at slow roll, whose motion is replaced by the bow at the probe; None without a bow.
    bow : BowShape or None
        The shaft's stress-free shape; None without one.
    """

    slow_roll: HarmonicResponse | None = field(default=None, repr=False)
    bow: "BowShape | None" = None

    def reading(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex x and y that probes at positions z [m] read, run-out included, both (b, len(z)) [m]."""
        x, y = self.motion.evaluate(z)
        if self.bow is None or self.slow_roll is None:
            return x, y
        slow_x, slow_y = self.slow_roll.motion.evaluate(z)
        runout = self.bow.evaluate(z)
        # x + i y = b e^{iΩt}: forward alone.
        return x - slow_x + runout, y - slow_y - 1j * runout


@dataclass(frozen=True)
class BowShape:
    """Bow of the whole shaft, and the loads that straighten it.

    Attributes
    ----------
    bow : Bow
        Points that the shape goes through.
    reactions : ndarray of complex, shape (k,)
        Forces at the points whose static response is the curve [N]; zero for a rigid run-out.
    strain_energy : float
        Strain energy of the straightened shaft [J].
    """

    bow: Bow
    reactions: ComplexArray
    strain_energy: float
    held: HarmonicResponse | None = field(repr=False)

    def evaluate(self, z: npt.ArrayLike) -> ComplexArray:
        """Offset times e^{i phase} at positions z [m], (k,) [m]."""
        positions = np.atleast_1d(np.asarray(z, dtype=np.float64))
        if self.held is None:
            return np.full(positions.size, self.bow.vectors[0])
        forward, _ = self.held.motion.at(positions)
        # The held response answers the forward load √2 R; r+ of a turning offset b is √2 b.
        return np.asarray(forward[0, :, 0] * self.held.motion.shaft.displacement_unit[0] * np.sqrt(0.5))


def bow_shape(rotor: Rotor, bow: Bow) -> BowShape:
    """Solve for the bow's shape: the curve of least strain energy through its points.

    Springs k to ground at the points, loaded by k w_k, give offsets A w there; w = A⁻¹ b makes them the measured
    ones, and the reactions are k(w − b). Any k serves; one of the shaft's own size keeps the digits.

    Raises
    ------
    RotorError
        A point off the shaft.
    """
    for at in bow.at.tolist():
        rotor.require_on_shaft("bow point", at)
    vectors = bow.vectors
    if vectors.size == 1:
        return BowShape(bow, np.zeros(1, dtype=np.complex128), 0.0, None)
    # The static axial force acts on the whole displacement, not on what the shaft is bent by.
    free = replace(rotor, segments=[replace(part, axial_force=0.0) for part in rotor.segments])
    # The stiffness of the springs is about EI / L³.
    stiffness = float(bending_shaft(rotor).displacement_unit[0]) ** -2
    springs = [Bearing.isotropic(f"point {k}", at, stiffness) for k, at in enumerate(bow.at.tolist())]
    places = bow.at.tolist()
    unit = np.zeros((len(places), len(places), 5), dtype=np.complex128)
    for k in range(len(places)):
        unit[k, k, 0] = np.sqrt(2.0) * stiffness
    still = np.zeros(len(places))
    answers = solve_harmonic(free, springs, places, unit, still, still)
    x, _ = answers.evaluate(places)
    weights = np.linalg.solve(x.T, vectors)
    reactions = stiffness * (weights - vectors)
    if vectors.size == 2:
        reactions = np.zeros(2, dtype=np.complex128)
    whole = np.zeros((1, len(places), 5), dtype=np.complex128)
    whole[0, :, 0] = np.sqrt(2.0) * stiffness * weights
    response = solve_harmonic(free, springs, places, whole, np.zeros(1), np.zeros(1))
    return BowShape(bow, reactions, float(0.5 * (reactions.conj() @ vectors).real), response)


def unbalance_response(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    unbalances: Sequence[Unbalance],
    speeds: npt.ArrayLike,
    *,
    bow: Bow | None = None,
) -> SynchronousResponse:
    """Solve for the unbalance response: the synchronous motion by unbalance and bow at every speed.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor and its bearings; tables over speed are read at each speed.
    unbalances : sequence of Unbalance
        Unbalances, any number.
    speeds : array_like, shape (b,)
        Speeds of rotation Ω [rad/s]; negative is clockwise, and the angles on the rotor stay counter-clockwise.
    bow : Bow, optional
        The shaft's stress-free shape.

    Raises
    ------
    RotorError
        A place off the shaft, a speed beyond a table or zero where nothing holds the rotor.
    """
    turning = finite_values("speeds", speeds)
    rotor.require_speed(float(turning[np.abs(turning).argmax()]))
    places = [unbalance.at for unbalance in unbalances]
    loads = np.zeros((turning.size, len(places), 5), dtype=np.complex128)
    for k, unbalance in enumerate(unbalances):
        loads[:, k, 0] = np.sqrt(2.0) * unbalance.vector * turning**2
    shape, slow = None, None
    if bow is not None:
        shape = bow_shape(rotor, bow)
        reactions = np.broadcast_to(np.sqrt(2.0) * shape.reactions, (turning.size, bow.at.size))
        straightening = np.zeros((turning.size, bow.at.size, 5), dtype=np.complex128)
        straightening[:, :, 0] = reactions
        places = [*places, *bow.at.tolist()]
        loads = np.concatenate([loads, straightening], axis=1)
        rolling = [bearing.at_speed(slowest(bearing)) for bearing in bearings]
        slow = solve_harmonic(rotor, rolling, bow.at.tolist(), straightening[:1], np.zeros(1), np.zeros(1))
    response = solve_harmonic(rotor, bearings, places, loads, turning, turning)
    return SynchronousResponse(
        response.frequencies,
        response.speeds,
        response.motion,
        response.bearings,
        response.bearing_forces,
        slow,
        shape,
    )
