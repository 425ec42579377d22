"""Lateral modes of a shaft: undamped bending in one plane, and buckling under its axial forces.

The modes are the modal basis of the rotor (TM-101442 Eqs. 7–13). The buckling factor is found by the Wittrick-Williams
root count at standstill.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.certificate import ModeCertificate
from gearwhine.rotors.errors import require
from gearwhine.rotors.model.bearing import RadialSupport
from gearwhine.rotors.model.segment import Coupling
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.transfer_matrix.mode_shapes import ShaftFields, find_modes, require_positions
from gearwhine.rotors.transfer_matrix.rotor_shafts import bending_shaft
from gearwhine.rotors.transfer_matrix.wittrick_williams import wittrick_williams_count

# Part of the frequency scale √(stiffness / mass) that replaces zero at standstill: a free shaft's rigid motion is at
# zero.
STANDSTILL = 1e-9
RELATIVE_WIDTH = 1e-13
MOST_DOUBLINGS = 100
# Factor below which it is zero: a shaft that is free to tilt buckles under any compression.
LEAST_FACTOR = 1e-9
# Deviation from a unit motion of the whole shaft at a support below which the modes follow it.
FOLLOWED = 1e-6


def buckling_factor(rotor: Rotor, supports: Sequence[RadialSupport] = ()) -> float:
    """Solve for the buckling factor: the least factor on all axial forces at which a rotor buckles in one plane.

    Compression lowers the natural frequencies. Where one has reached zero the shaft buckles: beyond, the root count at
    standstill exceeds the number of rigid motions.

    Parameters
    ----------
    rotor : Rotor
        The shaft, with the axial forces of its segments and couplings.
    supports : sequence of RadialSupport
        Springs to ground in this plane.

    Returns
    -------
    float
        Buckling factor, accurate to 1e-13; infinite without compression, zero for a shaft that is free to tilt.

    Raises
    ------
    RotorError
        A support off the shaft; or compression would have to exceed half of the shear stiffness κGA of a segment first,
        which no material bears.
    """
    if not rotor.is_compressed:
        return np.inf
    low, high = 0.0, 1.0
    for _ in range(MOST_DOUBLINGS):
        if _has_buckled(rotor, supports, high):
            break
        low, high = high, 2.0 * high
    if _has_buckled(rotor, supports, LEAST_FACTOR):
        return 0.0
    while high - low > RELATIVE_WIDTH * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _has_buckled(rotor, supports, middle) else (middle, high)
    return 0.5 * (low + high)


def require_unbuckled(rotor: Rotor, supports: Sequence[RadialSupport]) -> None:
    """Raise `RotorError` with the buckling factor if the rotor's own axial forces buckle it."""
    if rotor.is_compressed:
        buckled = _has_buckled(rotor, supports, 1.0)
        factor = buckling_factor(rotor, supports) if buckled else np.inf
        require(
            not buckled,
            f"rotor {rotor.name!r} axial force",
            min(part.axial_force for part in rotor.segments),
            f"compression that it bears: it buckles at {factor:.6g} times its axial forces",
        )


def _has_buckled(rotor: Rotor, supports: Sequence[RadialSupport], factor: float) -> bool:
    parts = [replace(part, axial_force=factor * part.axial_force) for part in rotor.segments]
    if any(isinstance(part, Coupling) and -part.axial_force >= part.clamped_buckling_load for part in parts):
        return True
    continuous_shaft = bending_shaft(replace(rotor, segments=parts), supports)
    # The shaft has one scale at every frequency; the elements of a standstill are the longest.
    shaft = continuous_shaft.cut(STANDSTILL * continuous_shaft.likely_frequency(1))
    return wittrick_williams_count(shaft, shaft.highest) > int(shaft.rigid_shapes.shape[0])


@dataclass(frozen=True, eq=False)
class LateralModes:
    """Mass-orthonormal planar modes, Φᵀ M Φ = I and Φᵀ K Φ = diag(ω²).

    M holds the shaft's translational and rotary inertia along its length as well as the discs; K the
    shaft and the supports.

    Attributes
    ----------
    frequencies : ndarray, shape (m,)
        Natural frequencies, ascending [rad/s]; rigid motions of a free shaft are zeros.
    stations : ndarray, shape (s,)
        Segment ends, discs and supports from the left end [m].
    displacement, slope : ndarray, shape (m, s)
        Displacement x [m] and rotation [rad] of the section at the stations, per unit modal coordinate.
    polar_inertia_matrix : ndarray, shape (m, m)
        Integral ∫ ρI_p βᵢβⱼ dz plus Σ I_p βᵢβⱼ of the discs: the gyroscopic matrix per rad/s.
    supports : tuple of RadialSupport
        The springs in K, which a coupled model removes again.
    certificate : ModeCertificate
        Proof of completeness. It does not cover the attachment modes of
        `gearwhine.rotors.modes.residual_modes.add_attachment_modes`.
    """

    frequencies: FloatArray
    stations: FloatArray
    displacement: FloatArray
    slope: FloatArray
    polar_inertia_matrix: FloatArray
    supports: tuple[RadialSupport, ...]
    certificate: ModeCertificate
    fields: ShaftFields = field(repr=False)
    mixture: FloatArray = field(repr=False)

    @property
    def count(self) -> int:
        """Number of modes m."""
        return int(self.frequencies.size)

    def evaluate(self, z: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Displacement and slope of every mode at positions z [m], both (m, len(z)), by the exact field.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        positions = require_positions(self.stations, z)
        states = np.tensordot(self.mixture, self.fields.at(positions)[:, :, :2], axes=1)
        unit = self.fields.shaft.displacement_unit
        return states[:, :, 0] * unit[0], states[:, :, 1] * unit[1]

    def section_loads(self, z: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Shear force and bending moment of every mode at positions z [m], both (m, len(z)).

        f = κGA (x' − β) + P x' in N and EI β' in N·m, per unit modal coordinate, just right of a position; at the
        shaft's right end just left of it.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        positions = require_positions(self.stations, z)
        states = np.tensordot(self.mixture, self.fields.at(positions)[:, :, 2:], axes=1)
        unit = self.fields.shaft.displacement_unit
        return states[:, :, 0] / unit[0], states[:, :, 1] / unit[1]

    def strain_energy_shares(self, edges: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Shares of every mode's strain energy in lengths of shaft and in its supports; their sum is one.

        A mode's strain energy is ½ ω² at unit modal coordinate. Rigid motions have none, and zeros here.

        Parameters
        ----------
        edges : array_like, shape (e + 1,)
            Ascending positions that divide the shaft [m]: `Rotor.joints` for its segments.

        Returns
        -------
        lengths, supports : ndarray, shapes (m, e) and (m, supports)
            Shares in lengths and supports; a support that is infinitely stiff stores nothing.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        places = require_positions(self.stations, edges)
        fields = self.fields.on(self.fields.shaft.with_nodes(places))
        nodes = fields.shaft.nodes
        owner = np.searchsorted(places, 0.5 * (nodes[1:] + nodes[:-1])) - 1
        elements = fields.strain_of_elements(self.mixture)
        lengths = np.stack([elements[:, owner == k].sum(axis=1) for k in range(places.size - 1)], axis=1)
        supports = np.zeros((self.count, len(self.supports)))
        for k, support in enumerate(self.supports):
            for stiffness, motion in zip(
                (support.stiffness, support.tilt_stiffness), self.evaluate([support.at]), strict=True
            ):
                if np.isfinite(stiffness):
                    supports[:, k] += stiffness * motion[:, 0] ** 2
        whole = np.where(self.frequencies > 0.0, self.frequencies**2, np.inf)[:, None]
        return lengths / whole, supports / whole

    @property
    def free_stiffness(self) -> FloatArray:
        """Stiffness of the shaft alone, diag(ω²) less the supports, (m, m) [1/s²]."""
        return np.diag(self.frequencies**2) - self.support_matrix

    @property
    def rigid_motions(self) -> FloatArray:
        """Modal coordinates of the motions of the shaft as a whole, orthonormal, (m, 2): its shift, then its tilt.

        They are the nearest in mass that the modes contain. A single mode has one of them.
        """
        return np.asarray(np.linalg.qr(self.fields.bending_participation(self.mixture))[0])

    @property
    def unresisted_motions(self) -> int:
        """Number of `rigid_motions`, from the first, for which `free_stiffness` is exactly zero.

        An axial force acts on the tilt. The modes contain a motion where they are followed by attachment modes at
        every support; but the supports of a lumped rotor may stand between its masses, where no mode follows it.
        """
        shaft, along = self.fields.shaft, self.fields.bending_participation(self.mixture)
        follows = np.array([True, not shaft.has_axial_force])
        for support in self.supports:
            exact = np.array([[1.0, (support.at - shaft.nodes[0]) / shaft.length_unit], [0.0, 1.0]])
            motions = [
                part[:, 0] / unit
                for part, unit in zip(self.evaluate([support.at]), shaft.displacement_unit, strict=True)
            ]
            errors = np.abs(np.array(motions) @ along - exact)
            held = np.array([support.stiffness, support.tilt_stiffness]) > 0.0
            follows &= (errors[held] < FOLLOWED).all(axis=0)
        return min(int(np.logical_and.accumulate(follows).sum()), self.count)

    @property
    def support_matrix(self) -> FloatArray:
        """Stiffness Φᵀ k Φ of the finite supports, (m, m) [N/m per unit modal mass]."""
        total = np.zeros((self.count, self.count))
        if not self.supports:
            return total
        springs = np.array([(support.stiffness, support.tilt_stiffness) for support in self.supports])
        springs[np.isinf(springs)] = 0.0
        for stiffness, motion in zip(springs.T, self.evaluate([support.at for support in self.supports]), strict=True):
            total += (motion * stiffness) @ motion.T
        return total


def solve_lateral_modes(
    rotor: Rotor,
    supports: Sequence[RadialSupport] = (),
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
) -> LateralModes:
    """Every planar bending mode below a limit, or the lowest ones, without gyroscopic effects.

    Parameters
    ----------
    rotor : Rotor
        The shaft and its discs.
    supports : sequence of RadialSupport
        Springs to ground in this plane; none leaves the shaft free, with two rigid motions at zero.
    frequency_limit : float, optional
        Limit strictly below which all modes are found [rad/s].
    count : int, optional
        Number of modes, instead of a limit; with neither, 10 (or all that a lumped rotor has). A multiple root at the
        end is kept whole, so that the result may hold a mode or two more.

    Raises
    ------
    RotorError
        A support off the shaft, both a limit and a count, more modes than a lumped rotor has, or axial forces that
        buckle the shaft.
    IncompleteModesError
        The modes fail their own proof.
    """
    springs = tuple(supports)
    require_unbuckled(rotor, springs)
    solved = find_modes(bending_shaft(rotor, springs), frequency_limit, count)
    return lateral_modes(solved.frequencies, solved.fields, solved.mixture, springs, solved.certificate)


def lateral_modes(
    frequencies: FloatArray,
    fields: ShaftFields,
    mixture: FloatArray,
    supports: tuple[RadialSupport, ...],
    certificate: ModeCertificate,
) -> LateralModes:
    """Assemble the result from fields in the shaft's scaled units and the mixture that makes modes of them."""
    shaft = fields.shaft
    at_stations = fields.at(shaft.stations)[:, :, :2]
    # Sums over fields also hold without any field, as below a limit under the first mode.
    nodal = np.tensordot(mixture, at_stations, axes=1)
    # The largest displacement is positive, so that a shape does not depend on the solver's start.
    shapes = nodal[:, :, 0]
    largest = np.abs(shapes).argmax(axis=1)
    sign = np.where(shapes[np.arange(largest.size), largest] < 0.0, -1.0, 1.0)
    mixture = sign[:, None] * mixture
    nodal = sign[:, None, None] * nodal * shaft.displacement_unit
    # Polar inertia and rotary mass share one unit, so that the unit modal mass carries it over unchanged.
    polar = fields.polar_matrix(mixture)
    return LateralModes(
        frequencies=frequencies,
        stations=shaft.stations,
        displacement=nodal[:, :, 0],
        slope=nodal[:, :, 1],
        polar_inertia_matrix=0.5 * (polar + polar.T),
        supports=supports,
        certificate=certificate,
        fields=fields,
        mixture=mixture,
    )
