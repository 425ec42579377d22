"""Damped, gyroscopic whirl of a rotor on its bearings: exact, and complete by proof.

Speed Ω is positive counter-clockwise from +z; motion e^{λt} whirls forward, with the rotation for Ω > 0, when y
lags x by a quarter turn. Starting values come from a projection on planar modes (`rotors.projection`); each
root is then refined on the exact transfer equations of both planes (`rotors.spatial_chain`, `rotors.exact_roots`),
and their number is proved (`rotors.whirl_certificate`).
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from .bearing import Bearing
from .coalesced_roots import refine_roots
from .errors import require_finite
from .exact_roots import ExactRoots, Speed, constant_speed
from .lateral import LateralModes
from .planar_basis import DEFAULT_COUNT
from .projection import basis_for, pencils
from .shaft import Rotor
from .spatial_chain import SpatialChain, whirl_chain, whirl_reach
from .spatial_field import SpatialMotion
from .whirl_certificate import NO_OSCILLATION, WhirlCertificate, certified_roots, oscillating
from .whirl_count import is_conservative
from .whirl_energy import StrainShares, strain_shares

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

# How far beyond the limit starting values are still followed: the projection's lie above the roots.
START_REACH = 1.2
# Behind the modes asked for, starting values are followed to the first that lies this far from the one before it: the
# proof's limit finds its gap there.
WIDE_GAP = 0.01
# Part of a motion's kinetic energy above which it is called axial. One with less along the axis is still driven by
# unbalance, by the root of what is left for the motion across it.
MOSTLY_AXIAL = 0.9
# A damping ratio nearer to zero is rounding: the mode neither grows nor decays.
NEUTRAL = 1e-9
# A limit in a gap narrower than this would be too near a root to count by.
LEAST_GAP = 1e-6


@dataclass(frozen=True)
class WhirlModes:
    """Complex modes at one speed of rotation, ascending in frequency; overdamped motions are left out.

    Attributes
    ----------
    speed
        Ω, rad/s.
    eigenvalues
        (w,) complex, rad/s, with positive imaginary part: exact to about 1e-13 of each.
    certificate
        Proof that none is missing.
    bearings
        What the shapes stand on, with the coefficients of this speed.
    roots
        The same eigenvalues as roots of the exact equations, with their vectors, of which `motion` makes the shapes.
    """

    speed: float
    eigenvalues: ComplexArray
    certificate: WhirlCertificate
    bearings: tuple[Bearing, ...] = field(repr=False)
    roots: "WhirlRoots" = field(repr=False)

    @cached_property
    def motion(self) -> SpatialMotion:
        """The exact shapes, of unit norm in the inertias of shaft and nodes, m per √kg; made when first asked for."""
        motion = self.roots.motion
        return motion.scaled(1.0 / np.sqrt(motion.shares.sum(axis=1)).astype(np.complex128))

    @property
    def direction(self) -> FloatArray:
        """How circular the whirl is, the inertia-weighted mean over the shaft, (w,).

        1 is circular and counter-clockwise (forward for positive speed), −1 circular and clockwise, 0 planar.
        """
        return self.roots.motion.direction

    @property
    def axial_share(self) -> FloatArray:
        """Part of the kinetic energy that is along the axis, (w,): 0 where no bearing ties it to the others."""
        return self.roots.motion.axial_share

    @property
    def frequencies(self) -> FloatArray:
        """Natural frequency |λ|, rad/s, (w,)."""
        return np.asarray(np.abs(self.eigenvalues))

    @property
    def damped_frequencies(self) -> FloatArray:
        """Im λ, rad/s, (w,)."""
        return np.asarray(self.eigenvalues.imag)

    @property
    def damping_ratios(self) -> FloatArray:
        """−Re λ / |λ|, (w,); negative is unstable."""
        return np.asarray(-self.eigenvalues.real / np.abs(self.eigenvalues))

    @property
    def log_decrements(self) -> FloatArray:
        """Logarithmic decrement −2π Re λ / Im λ, (w,)."""
        return np.asarray(-2.0 * np.pi * self.eigenvalues.real / self.eigenvalues.imag)

    @property
    def stable(self) -> bool:
        """Whether no mode grows by itself."""
        return bool((self.damping_ratios >= -NEUTRAL).all())

    def evaluate(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex x and y of every mode at positions z (m), both (w, len(z)), by the exact field."""
        return self.motion.evaluate(z)

    def section_loads(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex shear forces and bending moments of every mode at positions z (m), both (2, w, len(z)) over x and y.

        f = κGA (x' − β) + P x' in N and EI β' in N·m, for the motion that `evaluate` gives; just right of a position,
        and at the shaft's right end just left of it. Over a cycle the bending moment's vector goes round an ellipse.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        return self.motion.section_loads(z)

    def strain_energy_shares(self, edges: npt.ArrayLike) -> StrainShares:
        """Parts of every mode's strain energy, in the mean of a cycle, in lengths of shaft and what holds it.

        The mean is that of the swinging ¼ q̂ᴴKq̂ with growth or decay left out; of a bearing the symmetric part of its
        stiffness stores energy (`rotors.whirl_energy`).

        Parameters
        ----------
        edges
            (e + 1,): ascending positions that part the shaft, m: `Rotor.joints` for its segments.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        return strain_shares(self.motion, self.bearings, edges)

    def direction_at(self, z: npt.ArrayLike) -> FloatArray:
        """Whirl at positions z (m), (w, len(z)): 1 circular counter-clockwise, 0 planar, −1 circular clockwise."""
        forward, backward = (np.abs(part[:, :, 0]) ** 2 for part in self.motion.at(z))
        total = forward + backward
        return np.asarray(np.divide(forward - backward, total, out=np.zeros_like(total), where=total > 0.0))


def solve_whirl(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    speed: float,
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
    basis: LateralModes | None = None,
) -> WhirlModes:
    """Complex modes of the turning rotor on grounded bearings or pedestals, certified complete.

    Parameters
    ----------
    rotor, bearings
        The rotor and what holds it; tables over speed are read at ``speed``.
    speed
        Ω, rad/s; negative is clockwise.
    frequency_limit
        rad/s: modes whose natural frequency |λ| is below it.
    count
        How many modes, the lowest in |λ|, instead of a limit; with neither, 12. A rotor with less has less.
    basis
        From `rotors.whirl_basis`, of the same rotor and bearings; without it the rotor makes and holds one of its own.

    Raises
    ------
    RotorError
        Wrong arguments, or a basis with other supports.
    IncompleteModesError
        The modes fail their own proof, or the basis does.
    """
    require_finite("speed", speed)
    chosen = basis_for(rotor, bearings, frequency_limit, count, basis)
    constant = tuple(bearing.at_speed(speed) for bearing in bearings)
    turning = np.array([speed])
    wanted = None if frequency_limit is not None else count or DEFAULT_COUNT
    roots, certificate = certified_whirl(
        rotor,
        constant,
        [(one.blocks, one.eigenvalues(turning)[0]) for one in rotor.once(pencils, constant, chosen)],
        constant_speed(speed),
        speed,
        NO_OSCILLATION * chosen.floor,
        frequency_limit,
        wanted,
    )
    return WhirlModes(speed, roots.eigenvalues, certificate, constant, roots)


@dataclass(frozen=True)
class WhirlRoots:
    """Whirl as roots of the exact equations of every set of tied motions, from which shapes are made.

    Attributes
    ----------
    chains, parts
        The equations of the sets, and their roots.
    speed
        Of rotation.
    order
        (w,): where each root stands among all, one set after another.
    """

    chains: Sequence[SpatialChain]
    parts: Sequence[ExactRoots]
    speed: Speed
    order: npt.NDArray[np.intp]

    @property
    def eigenvalues(self) -> ComplexArray:
        """λ of every root, rad/s, (w,)."""
        return _all([roots.eigenvalues for roots in self.parts])[self.order]

    @cached_property
    def motion(self) -> SpatialMotion:
        """The exact motion of every root, as it comes; made when first asked for."""
        motions = [
            SpatialMotion.of(chain, one.eigenvalues, self.speed(one.eigenvalues), one.solutions, one.scales)
            for chain, one in zip(self.chains, self.parts, strict=True)
        ]
        motion = motions[0]
        for more in motions[1:]:
            motion = motion.joined(more)
        return motion.take(self.order)


def certified_whirl(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    starts: Sequence[tuple[tuple[int, ...], ComplexArray]],
    speed: Speed,
    turning: float | None,
    least: float,
    limit: float | None,
    count: int | None,
) -> tuple[WhirlRoots, WhirlCertificate]:
    """Every motion below a limit, or the lowest ``count``, from starting values for every set of tied motions.

    ``turning`` is the speed at which pieces must be short enough, rad/s; None where it follows the frequency.
    """
    from .place_kernels import ascending

    kept = [ascending(values, least, NO_OSCILLATION) for _, values in starts]
    sizes: list[list[float]] = [np.abs(values).tolist() for values in kept]
    if limit is None:
        assert count is not None
        reach = _reach_behind(sorted(size for own in sizes for size in own), count)
    else:
        reach = START_REACH * limit
    highest = max(START_REACH * reach, 10.0 * least)
    highest = whirl_reach(highest, highest if turning is None else turning)
    chains = [whirl_chain(rotor, bearings, blocks, highest) for blocks, _ in starts]
    near = [bisect_right(own, reach) for own in sizes]
    refined = [refine_roots(chain, values[:k], speed) for chain, values, k in zip(chains, kept, near, strict=True)]
    if limit is None:
        assert count is not None
        sector = oscillating(least, _limit_behind(refined, least, count))
    else:
        sector = oscillating(least, limit)
    conservative = rotor.once(is_undriven, tuple(bearings))
    parts = [
        certified_roots(chain, roots, speed, sector, conservative, values[k:])
        for chain, roots, values, k in zip(chains, refined, kept, near, strict=True)
    ]
    found = _all([roots.eigenvalues for roots, _ in parts])
    order = np.lexsort((found.imag, np.abs(found)))[:count]
    proofs = [proof for _, proof in parts]
    certificate = WhirlCertificate(
        sector.most,
        sum(proof.expected for proof in proofs),
        sum(proof.found for proof in proofs),
        max(proof.max_residual for proof in proofs),
        proofs[0].method,
    )
    return WhirlRoots(chains, [roots for roots, _ in parts], speed, order), certificate


def is_undriven(rotor: Rotor, bearings: Sequence[Bearing]) -> bool:
    """Whether roots may be counted by inertia: nothing damps or drives, and all stiffness is positive."""
    # Under compression the shaft's own stiffness may fail to be.
    return not rotor.is_compressed and is_conservative(bearings)


def _reach_behind(ascending: Sequence[float], count: int) -> float:
    """The size of starting values that holds the lowest ``count``, their twins, and one behind them."""
    if not ascending:
        return 1.0
    last = min(count, len(ascending) - 1)
    while last < len(ascending) - 1 and ascending[last] <= ascending[last - 1] * (1.0 + WIDE_GAP):
        last += 1
    return ascending[last] * (1.0 + LEAST_GAP)


def _limit_behind(refined: Sequence[ExactRoots], least: float, count: int) -> float:
    """A frequency in a gap behind the lowest ``count`` roots, or behind all there are."""
    from .place_kernels import ascending

    sizes = np.abs(ascending(_all([roots.eigenvalues for roots in refined]), least, NO_OSCILLATION)).tolist()
    if not sizes:
        return 10.0 * least
    for last in range(count, len(sizes)):
        if sizes[last] > sizes[last - 1] * (1.0 + LEAST_GAP):
            return math.sqrt(sizes[last] * sizes[last - 1])
    return float(sizes[-1]) * (1.0 + 0.01)


def _all(parts: Sequence[ComplexArray]) -> ComplexArray:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)
