"""Whirl modes: damped, gyroscopic modes of a rotor on its bearings, exact and complete by proof.

Speed Ω is positive counter-clockwise from +z; motion e^{λt} whirls forward, with the rotation for Ω > 0, when y
lags x by a quarter turn. Starting values come from a projection on planar modes
(`gearwhine.rotors.whirl.modal_projection`); each root is then refined on the exact transfer equations of both planes
(`gearwhine.rotors.whirl.equations`, `gearwhine.rotors.whirl.eigenvalues`), and their number is proved
(`gearwhine.rotors.whirl.completeness`).
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeVar, cast

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors.certificate import ModeCertificate, combined_certificate
from gearwhine.rotors.model.bearing import Bearing
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.whirl.completeness import NO_OSCILLATION, certified_roots, is_conservative, oscillating
from gearwhine.rotors.whirl.eigenvalues import ExactRoots, Speed, constant_speed, refine_roots
from gearwhine.rotors.whirl.equations import WhirlEquations, reach_step, whirl_equations_in_runs, whirl_reach
from gearwhine.rotors.whirl.modal_projection import Pencil, pencils
from gearwhine.rotors.whirl.motion import ShaftMotion, StrainShares, strain_shares
from gearwhine.rotors.whirl.planar_basis import DEFAULT_COUNT, PlanarBasis, planar_basis

Made = TypeVar("Made")

# Multiple of the limit up to which starting values are refined: those of the projection lie above the roots.
START_REACH = 1.2
# Beyond the modes wanted, starting values are refined up to the first gap of this relative width, in which the proof's
# limit is placed.
WIDE_GAP = 0.01
# Share of axial kinetic energy above which a motion is called axial. Unbalance still drives one with less, in
# proportion to the root of its lateral share.
MOSTLY_AXIAL = 0.9
# Magnitude of a damping ratio below which it is rounding: the mode neither grows nor decays.
NEUTRAL = 1e-9
# Least relative gap for a limit: in a narrower one it would be too close to a root for the count.
LEAST_GAP = 1e-6
# Number of the latest results that a solver keeps.
MOST_HELD = 16


class ComplexFrequencies:
    """Frequencies and damping that complex eigenvalues λ [rad/s] stand for, of one speed or of a Campbell diagram.

    All arrays have the shape of ``eigenvalues``, with NaN at the same places.
    """

    eigenvalues: ComplexArray

    @property
    def frequencies(self) -> FloatArray:
        """Natural frequency of whirl, |λ| [rad/s]."""
        return np.asarray(np.abs(self.eigenvalues))

    @property
    def damped_frequencies(self) -> FloatArray:
        """Damped frequency Im λ [rad/s]."""
        return np.asarray(self.eigenvalues.imag)

    @property
    def damping_ratios(self) -> FloatArray:
        """Damping ratio −Re λ / |λ|; negative where a mode grows."""
        return np.asarray(-self.eigenvalues.real / np.abs(self.eigenvalues))

    @property
    def log_decrements(self) -> FloatArray:
        """Logarithmic decrement of whirl, −2π Re λ / Im λ."""
        return np.asarray(-2.0 * np.pi * self.eigenvalues.real / self.eigenvalues.imag)


@dataclass(frozen=True)
class WhirlModes(ComplexFrequencies):
    """Complex modes at one speed of rotation, ascending in frequency, without overdamped motions.

    Attributes
    ----------
    speed : float
        Speed of rotation Ω of the rotor [rad/s].
    eigenvalues : ndarray of complex, shape (w,)
        Eigenvalues [rad/s], with positive imaginary part: exact to about 1e-13 of each.
    certificate : ModeCertificate
        Proof that none is missing.
    bearings : tuple of Bearing
        The bearings, with their coefficients at this speed.
    roots : WhirlRoots
        The eigenvalues as roots of the exact equations, with the vectors from which `motion` makes the shapes.
    """

    speed: float
    eigenvalues: ComplexArray
    certificate: ModeCertificate
    bearings: tuple[Bearing, ...] = field(repr=False)
    roots: "WhirlRoots" = field(repr=False)

    @cached_property
    def motion(self) -> ShaftMotion:
        """The exact mode shapes, of unit norm in the inertias of shaft and nodes, m per √kg."""
        motion = self.roots.motion
        return motion.scaled(1.0 / np.sqrt(motion.shares.sum(axis=1)).astype(np.complex128))

    @property
    def direction(self) -> FloatArray:
        """Direction and circularity of the whirl, the inertia-weighted mean over the shaft, (w,).

        1 is circular and counter-clockwise (forward for positive speed), −1 circular and clockwise, 0 planar.
        """
        return self.roots.motion.direction

    @property
    def axial_share(self) -> FloatArray:
        """Share of the kinetic energy along the axis, (w,): 0 where no bearing couples axial and lateral motion."""
        return self.roots.motion.axial_share

    @property
    def stable(self) -> bool:
        """Whether no mode grows by itself."""
        return bool((self.damping_ratios >= -NEUTRAL).all())

    def evaluate(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex x and y of every mode at positions z [m], both (w, len(z)), by the exact field."""
        return self.motion.evaluate(z)

    def evaluate_axial(self, z: npt.ArrayLike) -> ComplexArray:
        """Complex displacement along the axis of every mode at positions z [m], (w, len(z)), by the exact field.

        Zeros where no bearing couples axial and lateral motion.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        return self.motion.evaluate_axial(z)

    def section_loads(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex shear forces and bending moments of every mode at positions z [m], both (2, w, len(z)) over x and y.

        f = κGA (x' − β) + P x' in N and EI β' in N·m, for the motion that `evaluate` gives; just right of a position,
        and at the shaft's right end just left of it. Over a cycle the bending moment's vector goes round an ellipse.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        return self.motion.section_loads(z)

    def strain_energy_shares(self, edges: npt.ArrayLike) -> StrainShares:
        """Shares of every mode's mean strain energy in lengths of shaft, bearings and pedestals.

        The mean over a cycle is ¼ q̂ᴴKq̂ without growth or decay; of a bearing's stiffness the symmetric part stores
        energy (`gearwhine.rotors.whirl.motion`).

        Parameters
        ----------
        edges : array_like, shape (e + 1,)
            Ascending positions that divide the shaft [m]: `Rotor.joints` for its segments.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        return strain_shares(self.motion, self.bearings, edges)


@dataclass(frozen=True, eq=False)
class WhirlSolver:
    """Whirl of one rotor on its bearings at many speeds.

    The planar basis, the projected systems and the exact equations do not change with the speed: the solver makes them
    when they are first needed and holds them.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor and its bearings; tables over speed are read at each speed.

    Examples
    --------
    >>> solver = WhirlSolver(shaft, bearings)                         # doctest: +SKIP
    >>> modes = [solver.modes(speed, count=8) for speed in speeds]    # doctest: +SKIP
    """

    rotor: Rotor
    bearings: Sequence[Bearing]
    _held: dict[tuple[Hashable, ...], object] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        """Keep the bearings as a tuple."""
        object.__setattr__(self, "bearings", tuple(self.bearings))

    def modes(self, speed: float, *, frequency_limit: float | None = None, count: int | None = None) -> WhirlModes:
        """Complex modes at a speed of rotation [rad/s], certified complete; arguments and errors of `solve_whirl`."""
        self.rotor.require_speed(speed)
        basis = self.planar_basis(frequency_limit, count)
        constant = tuple(bearing.at_speed(speed) for bearing in self.bearings)
        turning = np.array([speed])
        roots, certificate = certified_whirl(
            self,
            constant,
            [(one.blocks, one.eigenvalues(turning)[0]) for one in self._pencils(constant, basis)],
            constant_speed(speed),
            speed,
            NO_OSCILLATION * basis.floor,
            frequency_limit,
            None if frequency_limit is not None else count or DEFAULT_COUNT,
        )
        return WhirlModes(speed, roots.eigenvalues, certificate, constant, roots)

    def planar_basis(self, frequency_limit: float | None, count: int | None) -> PlanarBasis:
        """Planar basis for whirl below a limit [rad/s], or for the lowest ``count`` modes."""
        return self._hold(
            ("basis", frequency_limit, count),
            lambda: planar_basis(self.rotor, self.bearings, frequency_limit, count),
        )

    def equations(self, bearings: Sequence[Bearing], blocks: tuple[int, ...], highest: float) -> WhirlEquations:
        """Exact equations of coupled motions on bearings of constant coefficients; see `whirl_equations_in_runs`."""
        return self._hold(
            ("equations", tuple(bearings), blocks, reach_step(highest)),
            lambda: whirl_equations_in_runs(self.rotor, bearings, blocks, highest),
        )

    def is_conservative_rotor(self, bearings: Sequence[Bearing]) -> bool:
        """Whether roots may be counted by inertia: nothing damps or drives, and all stiffness is positive."""
        return self._hold(("undriven", tuple(bearings)), lambda: is_conservative_rotor(self.rotor, bearings))

    def _pencils(self, bearings: tuple[Bearing, ...], basis: PlanarBasis) -> list[Pencil]:
        return self._hold(("pencils", bearings, basis), lambda: pencils(self.rotor, bearings, basis))

    def _hold(self, key: tuple[Hashable, ...], make: Callable[[], Made]) -> Made:
        if key not in self._held:
            made = make()
            if len(self._held) >= MOST_HELD:
                self._held.pop(next(iter(self._held)), None)
            self._held[key] = made
        return cast(Made, self._held[key])


def solve_whirl(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    speed: float,
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
) -> WhirlModes:
    """Complex modes of the turning rotor on grounded bearings or pedestals, certified complete.

    For several speeds of one rotor a `WhirlSolver` holds what they share.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor and its bearings; tables over speed are read at ``speed``.
    speed : float
        Ω [rad/s]; negative is clockwise.
    frequency_limit : float, optional
        Limit of the natural frequency |λ| of the modes [rad/s].
    count : int, optional
        Number of modes, the lowest in |λ|, instead of a limit; with neither, 12. A rotor with fewer gives all.

    Raises
    ------
    RotorError
        Wrong arguments.
    IncompleteModesError
        The modes fail their own proof.
    """
    return WhirlSolver(rotor, bearings).modes(speed, frequency_limit=frequency_limit, count=count)


@dataclass(frozen=True)
class WhirlRoots:
    """Whirl as roots of the exact equations of every set of coupled motions.

    Attributes
    ----------
    equation_sets, parts : sequence of WhirlEquations, sequence of ExactRoots
        The equations of the sets, and their roots.
    speed : Speed
        Speed of rotation.
    order : ndarray of int, shape (w,)
        Index of each root among the roots of all sets.
    """

    equation_sets: Sequence[WhirlEquations]
    parts: Sequence[ExactRoots]
    speed: Speed
    order: npt.NDArray[np.intp]

    @property
    def eigenvalues(self) -> ComplexArray:
        """Eigenvalue λ of every root [rad/s], (w,)."""
        return _all([roots.eigenvalues for roots in self.parts])[self.order]

    @cached_property
    def motion(self) -> ShaftMotion:
        """The exact motion of every root, without normalisation."""
        motions = [
            ShaftMotion.of(equations, roots.eigenvalues, self.speed(roots.eigenvalues), roots.solutions, roots.scales)
            for equations, roots in zip(self.equation_sets, self.parts, strict=True)
        ]
        motion = motions[0]
        for more in motions[1:]:
            motion = motion.joined(more)
        return motion.take(self.order)


def certified_whirl(
    solver: WhirlSolver,
    bearings: Sequence[Bearing],
    starts: Sequence[tuple[tuple[int, ...], ComplexArray]],
    speed: Speed,
    turning: float | None,
    least: float,
    limit: float | None,
    count: int | None,
    angle: float = NO_OSCILLATION,
) -> tuple[WhirlRoots, ModeCertificate]:
    """Every motion below a limit, or the lowest ``count``, on bearings of constant coefficients.

    ``starts`` are starting values for every set of coupled motions.

    ``turning`` is the speed at which elements must be short enough [rad/s]; None where it follows the frequency.
    ``angle`` is that of the least λ to the real axis [rad].
    """
    from gearwhine.rotors.whirl.eigenvalue_kernels import ascending

    oscillating_starts = [ascending(values, least, math.sin(angle)) for _, values in starts]
    sizes: list[list[float]] = [np.abs(values).tolist() for values in oscillating_starts]
    if limit is None:
        assert count is not None
        reach = _reach_behind(sorted(size for own in sizes for size in own), count)
    else:
        reach = START_REACH * limit
    highest = max(START_REACH * reach, 10.0 * least)
    highest = whirl_reach(highest, highest if turning is None else turning)
    equation_sets = [solver.equations(bearings, blocks, highest) for blocks, _ in starts]
    near = [bisect_right(own, reach) for own in sizes]
    refined = [
        refine_roots(equations, values[:k], speed)
        for equations, values, k in zip(equation_sets, oscillating_starts, near, strict=True)
    ]
    if limit is None:
        assert count is not None
        sector = oscillating(least, _limit_behind(refined, least, count, angle), angle)
    else:
        sector = oscillating(least, limit, angle)
    conservative = solver.is_conservative_rotor(bearings)
    parts = [
        certified_roots(equations, roots, speed, sector, conservative, values[k:])
        for equations, roots, values, k in zip(equation_sets, refined, oscillating_starts, near, strict=True)
    ]
    eigenvalues = _all([roots.eigenvalues for roots, _ in parts])
    order = np.lexsort((eigenvalues.imag, np.abs(eigenvalues)))[:count]
    proofs = [proof for _, proof in parts]
    certificate = combined_certificate(proofs, sector.most, proofs[0].method)
    return WhirlRoots(equation_sets, [roots for roots, _ in parts], speed, order), certificate


def is_conservative_rotor(rotor: Rotor, bearings: Sequence[Bearing]) -> bool:
    """Whether roots may be counted by inertia: nothing damps or drives, and all stiffness is positive."""
    # Under compression the shaft's own stiffness may fail to be.
    return not rotor.is_compressed and is_conservative(bearings)


def _reach_behind(ascending: Sequence[float], count: int) -> float:
    """Modulus below which the lowest ``count`` starting values lie, with multiples of the last, and one more."""
    if not ascending:
        return 1.0
    last = min(count, len(ascending) - 1)
    while last < len(ascending) - 1 and ascending[last] <= ascending[last - 1] * (1.0 + WIDE_GAP):
        last += 1
    return ascending[last] * (1.0 + LEAST_GAP)


def _limit_behind(refined: Sequence[ExactRoots], least: float, count: int, angle: float) -> float:
    """Return a frequency in a gap above the lowest ``count`` roots, or above all of them."""
    from gearwhine.rotors.whirl.eigenvalue_kernels import ascending

    sizes = np.abs(ascending(_all([roots.eigenvalues for roots in refined]), least, math.sin(angle))).tolist()
    if not sizes:
        return 10.0 * least
    for last in range(count, len(sizes)):
        if sizes[last] > sizes[last - 1] * (1.0 + LEAST_GAP):
            return math.sqrt(sizes[last] * sizes[last - 1])
    return float(sizes[-1]) * (1.0 + 0.01)


def _all(parts: Sequence[ComplexArray]) -> ComplexArray:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)
