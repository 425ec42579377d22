"""Torsional and axial modes of a shaft: rod modes, and the modes of inertias and torsion springs in a row (Holzer).

Both motions obey the equation of a rod. Axial modes are longitudinal waves in the segments, with the discs as masses.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.certificate import ModeCertificate
from gearwhine.rotors.errors import require
from gearwhine.rotors.model.bearing import AxisSpring
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.transfer_matrix.discretised_shaft import ContinuousShaft
from gearwhine.rotors.transfer_matrix.mode_shapes import ShaftFields, SolvedModes, find_modes, require_positions
from gearwhine.rotors.transfer_matrix.rotor_shafts import rod_shaft


@dataclass(frozen=True)
class RodModes:
    """Inertia-orthonormal modes with one motion at a station, Φᵀ M Φ = I and Φᵀ K Φ = diag(ω²).

    Attributes
    ----------
    frequencies : ndarray, shape (m,)
        Free torsional natural frequencies, ascending [rad/s]; the rigid motion of a free shaft is a zero.
    stations : ndarray, shape (s,)
        Segment ends, discs and springs from the left end [m]; for a chain of inertias 0, 1, 2, ...
    amplitude : ndarray, shape (m, s)
        Angle [rad] or displacement [m] at the stations, per unit modal coordinate.
    certificate : ModeCertificate
        Proof of completeness.
    """

    frequencies: FloatArray
    stations: FloatArray
    amplitude: FloatArray
    certificate: ModeCertificate
    fields: ShaftFields = field(repr=False)
    mixture: FloatArray = field(repr=False)

    @property
    def count(self) -> int:
        """Number of modes m."""
        return int(self.frequencies.size)

    def evaluate(self, z: npt.ArrayLike) -> FloatArray:
        """Amplitude of every mode at positions z [m], (m, len(z)), by the exact field.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        states = self.fields.at(require_positions(self.stations, z))[:, :, 0]
        return np.asarray(self.mixture @ states * self.fields.shaft.displacement_unit[0])


Modes = TypeVar("Modes", bound=RodModes)


def rod_modes(kind: type[Modes], solved: SolvedModes) -> Modes:
    """Modes of a kind from the solved modes; the largest amplitude of each is positive."""
    shaft = solved.fields.shaft
    nodal = solved.mixture @ solved.fields.at(shaft.stations)[:, :, 0]
    largest = np.take_along_axis(nodal, np.abs(nodal).argmax(axis=1)[:, None], axis=1)
    sign = np.where(largest < 0.0, -1.0, 1.0)
    return kind(
        frequencies=solved.frequencies,
        stations=shaft.stations,
        amplitude=sign * nodal * shaft.displacement_unit[0],
        certificate=solved.certificate,
        fields=solved.fields,
        mixture=sign * solved.mixture,
    )


@dataclass(frozen=True)
class TorsionalModes(RodModes):
    """Torsional modes, orthonormal in polar inertia; a free shaft's first is its rigid rotation."""

    @property
    def angle(self) -> FloatArray:
        """Angle θ at the stations, (m, s) [rad per unit modal coordinate]."""
        return self.amplitude


def solve_torsional_modes(
    rotor: Rotor,
    springs: Sequence[AxisSpring] = (),
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
) -> TorsionalModes:
    """Every torsional mode below a limit, or the lowest ones.

    Parameters
    ----------
    rotor : Rotor
        The shaft and its discs; couplings are springs between its parts.
    springs : sequence of AxisSpring
        Springs to ground [N·m/rad]; without them the shaft is free, and its rigid rotation is the first mode.
    frequency_limit : float, optional
        All modes strictly below [rad/s].
    count : int, optional
        Number of modes, a rigid rotation included; with neither, 10 or all there are.

    Raises
    ------
    RotorError
        A spring off the shaft, both a limit and a count, a rotor without polar inertia, or more modes than a
        lumped rotor has.
    IncompleteModesError
        The modes fail their own proof.
    """
    require(rotor.polar_inertia > 0.0, f"rotor {rotor.name!r} polar inertia", 0.0, "a positive inertia")
    return rod_modes(TorsionalModes, find_modes(rod_shaft(rotor, springs, "torsion"), frequency_limit, count))


def solve_torsional_chain(
    inertias: Sequence[float], stiffnesses: Sequence[float], ground: Sequence[float] | None = None
) -> TorsionalModes:
    """All modes of rigid inertias in a row, joined by massless springs, by the same transfer matrices.

    Parameters
    ----------
    inertias : sequence of float, shape (s,)
        Polar moments of inertia [kg·m²]; zero is allowed, not everywhere.
    stiffnesses : sequence of float, shape (s − 1,)
        Stiffnesses of the springs between neighbours [N·m/rad].
    ground : sequence of float, shape (s,), optional
        Stiffness of the spring from each inertia to ground, zero for none, infinite for a fixed one [N·m/rad].

    Raises
    ------
    RotorError
        Numbers that are negative or do not match in count.
    """
    masses, springs = np.array(inertias, dtype=np.float64), np.array(stiffnesses, dtype=np.float64)
    fitting = masses.ndim == 1 and springs.shape == (masses.size - 1,) and springs.size > 0
    expected = "two or more inertias and one spring between each two"
    require(fitting, "torsional chain shapes", (masses.shape, springs.shape), expected)
    positive = bool(np.isfinite(masses).all() and (masses >= 0.0).all() and masses.any())
    require(positive, "torsional chain inertias", list(inertias), "not negative, and not all zero")
    stiff = bool(np.isfinite(springs).all() and (springs > 0.0).all())
    require(stiff, "torsional chain stiffnesses", list(stiffnesses), "positive numbers")
    ground_stiffness = np.zeros(masses.size) if ground is None else np.array(ground, dtype=np.float64)
    fitting = ground_stiffness.shape == masses.shape and bool((ground_stiffness >= 0.0).all())
    require(
        fitting, "torsional chain ground", ground_stiffness.tolist(), "one stiffness for each inertia, none negative"
    )

    moment = float(np.exp(np.log(springs).mean()))
    continuous_shaft = ContinuousShaft(
        label="torsional chain",
        nodes=np.arange(masses.size, dtype=np.float64),
        stations=np.arange(masses.size, dtype=np.float64),
        kind=np.arange(springs.size),
        start=np.zeros(springs.size),
        end=np.ones(springs.size),
        lengths=np.ones(springs.size),
        coefficients=np.stack([moment / springs, np.zeros(springs.size)], axis=1)[:, :, None],
        uniform=np.ones(springs.size, dtype=np.bool_),
        stiffness=springs[:, None],
        inertia=np.zeros((springs.size, 1)),
        force=np.zeros(springs.size),
        node_inertia=masses[:, None] / moment,
        node_stiffness=ground_stiffness[:, None] / moment,
        node_polar=np.zeros(masses.size),
        length_unit=1.0,
        displacement_unit=np.array([1.0 / np.sqrt(moment)]),
    )
    return rod_modes(TorsionalModes, find_modes(continuous_shaft, None, int(continuous_shaft.available_modes)))


@dataclass(frozen=True)
class AxialModes(RodModes):
    """Axial modes, orthonormal in mass; a free shaft's first is its rigid motion."""

    @property
    def displacement(self) -> FloatArray:
        """Displacement along the shaft at the stations, (m, s) [m per unit modal coordinate]."""
        return self.amplitude


def solve_axial_modes(
    rotor: Rotor,
    springs: Sequence[AxisSpring] = (),
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
) -> AxialModes:
    """Every axial mode below a limit, or the lowest ones.

    Segments are rods of EA and ρA (without the lateral contraction that slows waves as short as the diameter),
    discs are masses, couplings are springs.

    Parameters
    ----------
    rotor : Rotor
        The shaft and its discs.
    springs : sequence of AxisSpring
        Springs to ground [N/m], such as a thrust bearing's stiffness; without them the shaft is free.
    frequency_limit : float, optional
        All modes strictly below [rad/s].
    count : int, optional
        Number of modes, a rigid motion included; with neither, 10 or all there are.

    Raises
    ------
    RotorError
        A spring off the shaft, both a limit and a count, or more modes than a lumped rotor has.
    IncompleteModesError
        The modes fail their own proof.
    """
    return rod_modes(AxialModes, find_modes(rod_shaft(rotor, springs, "axial"), frequency_limit, count))
