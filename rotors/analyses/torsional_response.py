"""Torsional response of a rotor to harmonic torques, by exact transfer matrices.

Material damping is a complex shear modulus G (1 + 2iζ): at every frequency a shaft element loses the part of its
energy that a mode of damping ratio ζ loses. With c = 1 + 2iζ its equations θ' = τ/(c GJ), τ' = −ω²ρJ θ are those of
`gearwhine.rotors.transfer_matrix.timoshenko` for ω²/c with torques counted in units of c. Springs to ground carry k (1
+ 2iζ), dashpots iωc, and couplings, which are massless, k_θ (1 + 2iζ) + iωc_θ.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.banded import BandPattern
from gearwhine.rotors.analyses.harmonic_response import finite_values
from gearwhine.rotors.errors import require, require_finite
from gearwhine.rotors.model.bearing import AxisSpring
from gearwhine.rotors.model.segment import Coupling
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.transfer_matrix.discretised_shaft import DiscretisedShaft
from gearwhine.rotors.transfer_matrix.mode_shapes import require_positions
from gearwhine.rotors.transfer_matrix.rotor_shafts import rod_shaft


@dataclass(frozen=True)
class Torque:
    """A torque Re[T e^{iωt}] about the axis at a place [m]; ``amplitude`` is complex [N·m]."""

    at: float
    amplitude: complex

    def __post_init__(self) -> None:
        """Check that position and amplitude are finite."""
        require_finite("torque position", self.at, minimum=0.0)
        require(bool(np.isfinite(self.amplitude)), "torque amplitude", self.amplitude, "a finite complex number")


@dataclass(frozen=True)
class TorsionalDashpot:
    """A dashpot between the shaft at a place [m] and ground; ``coefficient`` in N·m·s/rad."""

    at: float
    coefficient: float

    def __post_init__(self) -> None:
        """Check that position and coefficient are finite and not negative."""
        require_finite("dashpot position", self.at, minimum=0.0)
        require_finite("dashpot coefficient", self.coefficient, minimum=0.0)


@dataclass(frozen=True)
class TorsionalResponse:
    """Steady torsion Re[θ e^{iωt}], one for each frequency.

    Attributes
    ----------
    frequencies : ndarray, shape (b,)
        Frequencies ω [rad/s].
    damping_ratio : float
        Damping ratio ζ of the shaft.
    softness : ndarray of complex, shape (p, b)
        Factor on the twist of each shaft element under a torque, from the dashpot of a coupling.
    """

    frequencies: FloatArray
    damping_ratio: float
    shaft: DiscretisedShaft = field(repr=False)
    states: ComplexArray = field(repr=False)
    softness: ComplexArray = field(repr=False)

    def angle(self, z: npt.ArrayLike) -> ComplexArray:
        """Complex angle at positions z [m], (b, len(z)) [rad]."""
        return np.asarray(self._at(z)[:, :, 0] * self.shaft.displacement_unit[0])

    def torque(self, z: npt.ArrayLike) -> ComplexArray:
        """Complex torque that the shaft carries, right of positions z [m], (b, len(z)) [N·m]."""
        return np.asarray(self._at(z)[:, :, 1] / self.shaft.displacement_unit[0])

    def _at(self, z: npt.ArrayLike) -> ComplexArray:
        numbers, fractions = self.shaft.places(require_positions(self.shaft.nodes, z))
        modulus = 1.0 + 2j * self.damping_ratio
        transfer_matrices = self.shaft.transfer_matrices_to(numbers, fractions, self.frequencies**2 / modulus)
        transfer_matrices = in_units_of(transfer_matrices, modulus)
        transfer_matrices[..., 0, 1] *= self.softness[numbers]
        return np.asarray(np.einsum("zbij,bzj->bzi", transfer_matrices, self.states[:, numbers]))


def torsional_response(
    rotor: Rotor,
    torques: Sequence[Torque],
    frequencies: npt.ArrayLike,
    *,
    springs: Sequence[AxisSpring] = (),
    dashpots: Sequence[TorsionalDashpot] = (),
    damping_ratio: float = 0.0,
) -> TorsionalResponse:
    """Response of a rotor's torsion to harmonic torques.

    Parameters
    ----------
    rotor : Rotor
        The shaft and its discs.
    torques : sequence of Torque
        Torques with their places and complex amplitudes.
    frequencies : array_like, shape (b,)
        Frequencies ω [rad/s]; positive, as a free shaft has no steady response to a constant torque.
    springs, dashpots : sequence of AxisSpring, sequence of TorsionalDashpot
        Springs and dashpots to ground.
    damping_ratio : float
        Damping ratio ζ of the shaft's material and of its couplings; springs to ground have dashpots beside them.

    Raises
    ------
    RotorError
        A place off the shaft, a negative damping ratio, or a frequency that is not positive.
    """
    omega = finite_values("frequencies", frequencies)
    require(bool((omega > 0.0).all()), "frequencies", omega.tolist(), "positive frequencies")
    require_finite("damping_ratio", damping_ratio, minimum=0.0)
    places = [*(torque.at for torque in torques), *(dashpot.at for dashpot in dashpots)]
    for place in places:
        rotor.require_on_shaft("torque or dashpot", place)
    bare = [AxisSpring(place, 0.0) for place in places]
    shaft = rod_shaft(rotor, [*springs, *bare], "torsion").cut(float(omega.max()))
    modulus, unit = 1.0 + 2j * damping_ratio, float(shaft.displacement_unit[0])
    dashed = np.zeros(shaft.nodes.size)
    for dashpot in dashpots:
        dashed[shaft.node_at(dashpot.at)] += dashpot.coefficient * unit**2
    terms = shaft.finite_stiffness[:, 0] + 1j * omega[:, None] * dashed
    terms = terms - omega[:, None] ** 2 * shaft.node_inertia[:, 0]
    transfer_matrices = in_units_of(shaft.transfer_matrices(omega**2 / modulus), modulus)
    softness = _softness(rotor, shaft, omega, modulus)
    transfer_matrices[..., 0, 1] *= softness
    order = 2 * shaft.nodes.size
    sides = np.zeros((omega.size, 1, order), dtype=np.complex128)
    for torque in torques:
        node = shaft.node_at(torque.at)
        if not shaft.constrained[node, 0]:
            sides[:, 0, 2 * node] -= torque.amplitude * unit
    solved = _pattern(shaft.nodes.size).solve(_values(shaft, terms, transfer_matrices), sides)
    return TorsionalResponse(omega, damping_ratio, shaft, solved.reshape(omega.size, -1, 2), softness)


def _softness(rotor: Rotor, shaft: DiscretisedShaft, omega: FloatArray, modulus: complex) -> ComplexArray:
    """Twist of every shaft element under a torque, relative to that without the dashpots of couplings, (p, b)."""
    factor = np.ones((shaft.lengths.size, omega.size), dtype=np.complex128)
    middles = 0.5 * (shaft.nodes[1:] + shaft.nodes[:-1])
    for left, part in zip(rotor.joints[:-1].tolist(), rotor.segments, strict=True):
        if isinstance(part, Coupling) and part.torsional_damping > 0.0:
            inside = (middles > left) & (middles < left + part.length)
            spring = modulus * part.torsional_stiffness
            factor[inside] = spring / (spring + 1j * omega * part.torsional_damping)
    return factor


def in_units_of(transfer_matrices: ComplexArray, unit: complex) -> ComplexArray:
    """Transfer matrices of a rod (..., 2, 2) in plain forces, from those with forces in a complex unit."""
    plain = transfer_matrices.astype(np.complex128)
    plain[..., 0, 1] /= unit
    plain[..., 1, 0] *= unit
    return plain


def _pattern(nodes: int) -> BandPattern:
    """Rows of multiple shooting: force balance 2i of node i, and displacement 2i − 1."""
    node, element = np.arange(nodes), np.arange(nodes - 1)
    last = np.array([2 * nodes - 1])
    rows = [2 * node, 2 * node, 2 * element + 1, *[2 * element + 1] * 2, *[2 * element + 2] * 2, last]
    columns = [2 * node, 2 * node + 1, 2 * element + 2, 2 * element, 2 * element + 1, 2 * element, 2 * element + 1]
    return BandPattern.of(np.concatenate(rows), np.concatenate([*columns, last]), 2 * nodes)


def _values(shaft: DiscretisedShaft, terms: ComplexArray, transfer_matrices: ComplexArray) -> ComplexArray:
    """Entries for `_pattern`; the equation of a constrained node is that its displacement is zero."""
    is_held, batch = shaft.constrained[:, 0], terms.shape[0]
    moved = np.moveaxis(transfer_matrices, 1, 0)
    free = np.where(is_held[1:], 0.0, 1.0)
    parts = [
        np.where(is_held, 1.0, -terms),
        np.broadcast_to(np.where(is_held, 0.0, 1.0), terms.shape),
        np.ones((batch, is_held.size - 1)),
        -moved[:, :, 0, 0],
        -moved[:, :, 0, 1],
        -moved[:, :, 1, 0] * free,
        -moved[:, :, 1, 1] * free,
        np.ones((batch, 1)),
    ]
    return np.ascontiguousarray(np.concatenate(parts, axis=1), dtype=np.complex128)
