"""A rotor on its bearings at rest, and its critical speeds."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from .bearing import Bearing
from .buckling import require_unbuckled
from .campbell import campbell
from .certificate import ModeCertificate
from .chain import Chain
from .errors import require, require_count, require_finite
from .exact_roots import ACCEPTED, synchronous_speed
from .lateral import LateralModes
from .lines import Line
from .projection import DEFAULT_COUNT, Projection, basis_for, slowest
from .root_count import count_below
from .rotor_lines import bending_line
from .search import certified_modes, chain_that_holds
from .shaft import Rotor
from .shapes import SAME_ROOT
from .spatial_field import SpatialMotion
from .spatial_ties import block_sets
from .whirl import certified_whirl, solve_whirl
from .whirl_certificate import NO_OSCILLATION, WhirlCertificate

# Speeds at which tables are looked at for critical ones, and how far beyond them branches are followed.
TABLE_SPEEDS = 60
TABLE_REACH = 1.2

FloatArray = npt.NDArray[np.float64]

# Bisections after which roots of both planes that are not parted yet are one.
MOST_HALVINGS = 50
# Part of the frequency scale below which there are rigid motions only.
STANDSTILL = 1e-12


@dataclass(frozen=True)
class RestFrequencies:
    """Undamped natural frequencies of both planes at rest.

    Attributes
    ----------
    frequencies
        (m,): ascending, rad/s; an isotropic root stands twice.
    certificate
        Proof of completeness over both planes.
    """

    frequencies: FloatArray
    certificate: ModeCertificate | WhirlCertificate


@dataclass(frozen=True)
class CriticalSpeeds:
    """Speeds at which the rotor whirls once per turn.

    Attributes
    ----------
    speeds
        (c,): ascending, rad/s.
    direction
        (c,): 1 circular forward, −1 circular backward, 0 planar, as in `rotors.WhirlModes`.
    certificate
        Proof that none is missing.
    """

    speeds: FloatArray
    direction: FloatArray
    certificate: WhirlCertificate

    @property
    def forward(self) -> FloatArray:
        """The speeds that unbalance excites: those whose whirl is not purely backward."""
        return np.asarray(self.speeds[self.direction > -1.0 + 1e-6])


def rest_frequencies(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
) -> RestFrequencies:
    """Undamped natural frequencies of both planes of a rotor that does not turn.

    Without cross-coupled stiffness each plane is solved exactly with its own k_xx or k_yy. With it, the
    planes are coupled on the modal basis of `rotors.solve_whirl`.

    Parameters
    ----------
    rotor, bearings
        The rotor and what holds it; no bearings leave it free. Of tables the lowest speed is taken.
    frequency_limit
        rad/s: all frequencies strictly below.
    count
        How many over both planes, instead of a limit; with neither, 12. Multiple roots stay whole.

    Raises
    ------
    RotorError, IncompleteModesError
        As `rotors.solve_lateral_modes`.
    """
    bearings = [bearing.at_speed(slowest(bearing)) for bearing in bearings]
    if not all(_is_planar(bearing) for bearing in bearings):
        undamped = [_undamped(bearing) for bearing in bearings]
        modes = solve_whirl(rotor, undamped, 0.0, frequency_limit=frequency_limit, count=count)
        return RestFrequencies(modes.damped_frequencies, modes.certificate)

    wanted = count
    if frequency_limit is None and count is None:
        wanted = DEFAULT_COUNT
    require_count("count of frequencies", wanted)
    planes = [tuple(bearing.plane_support(direction) for bearing in bearings) for direction in (0, 1)]
    for held in planes:
        require_unbuckled(rotor, held)
    lines = [bending_line(rotor, held) for held in planes]
    if frequency_limit is not None:
        require(count is None, "frequency_limit and count", (frequency_limit, count), "one of the two")
        require_finite("frequency_limit", frequency_limit, positive=True)
        chains = [line.cut(frequency_limit) for line in lines]
        shares = [count_below(chain, frequency_limit) for chain in chains]
    else:
        chains, shares = _shares(lines, wanted or DEFAULT_COUNT)
    alike = planes[0] == planes[1]
    solved = [
        certified_modes(chain, share, frequency_limit)
        for chain, share in list(zip(chains, shares, strict=True))[: 1 if alike else 2]
        if share
    ]
    merged = np.sort(
        np.concatenate([modes.frequencies for modes in (solved * 2 if alike else solved)] or [np.zeros(0)])
    )
    if count is not None:
        expected = f"at most {merged.size}, all this lumped rotor has"
        require(count <= merged.size, "count of frequencies", count, expected)
    if frequency_limit is not None:
        limit = frequency_limit
    else:
        # Just above the last one wanted, and taking in its twins; rigid motions' zeros are below every limit.
        last = float(merged[min(wanted or DEFAULT_COUNT, merged.size) - 1])
        limit = last * (1.0 + 2.0 * SAME_ROOT) if last > 0.0 else STANDSTILL * chains[0].highest
        merged = merged[merged <= limit]
    certificate = ModeCertificate(
        limit=limit,
        expected=sum(count_below(chain, limit) for chain in chains),
        found=merged.size,
        max_residual=max((modes.certificate.max_residual for modes in solved), default=0.0),
        orthonormality=max((modes.certificate.orthonormality for modes in solved), default=0.0),
    )
    return RestFrequencies(merged, certificate)


def critical_speeds(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    *,
    speed_limit: float | None = None,
    count: int | None = None,
    basis: LateralModes | None = None,
) -> CriticalSpeeds:
    """Undamped critical speeds: where a whirl frequency equals the speed of rotation.

    With Ω = ω the gyroscopic term joins the mass, and all of them are roots of one eigenproblem,

        K q = ω² [[M, −i G], [i G, M]] q

    over both planes; a disc whose polar inertia exceeds its diametral one takes its forward root away.
    Where bearings have tables over speed, these are the crossings of a diagram of 60 speeds in the range that the
    tables share. With cross-coupled stiffness that is not symmetric the roots are complex (self-excited or decaying whirl),
    and the real part of ω is given. Damping is left out, which is the usual definition; the damped whirl
    frequency crosses a little lower.

    Parameters
    ----------
    rotor, bearings
        The rotor and what holds it.
    speed_limit
        rad/s: all critical speeds strictly below.
    count
        How many, instead of a limit; with neither, 12.
    basis
        From `rotors.whirl_basis`, to spare building it.

    Raises
    ------
    RotorError, IncompleteModesError
        As `rotors.solve_whirl`.
    """
    chosen = basis_for(rotor, bearings, speed_limit, count, basis)
    undamped = [_undamped(bearing) for bearing in bearings]
    if any(bearing.speeds is not None for bearing in undamped):
        return _tabled_critical_speeds(rotor, undamped, speed_limit, count, chosen)
    sets = [Projection.of(rotor, undamped, blocks, chosen) for blocks in block_sets(undamped)]
    motion, certificate = certified_criticals(rotor, undamped, sets, speed_limit, count)
    shares = motion.shares()
    order = np.argsort(motion.eigenvalues.imag)
    direction = (shares[:, 0] - shares[:, 1]) / shares.sum(axis=1)
    return CriticalSpeeds(motion.eigenvalues.imag[order], direction[order], certificate)


def _tabled_critical_speeds(
    rotor: Rotor, bearings: Sequence[Bearing], limit: float | None, count: int | None, basis: LateralModes
) -> CriticalSpeeds:
    """Crossings of a Campbell diagram whose stiffness follows the speed, within all tables."""
    tables = [bearing.speeds for bearing in bearings if bearing.speeds is not None]
    low, high = max(float(table[0]) for table in tables), min(float(table[-1]) for table in tables)
    high = min(high, limit or np.inf)
    require(low < high, "speeds of the bearings' tables", (low, high), "a range of speeds that they share")
    diagram = campbell(
        rotor, bearings, np.linspace(low, high, TABLE_SPEEDS), frequency_limit=TABLE_REACH * high, basis=basis
    )
    found = [crossing for crossing in diagram.crossings() if crossing.speed < (limit or np.inf)][:count]
    speeds = np.array([crossing.speed for crossing in found])
    proof = WhirlCertificate(high, speeds.size, speeds.size, ACCEPTED, "crossings")
    return CriticalSpeeds(speeds, np.array([crossing.direction for crossing in found]), proof)


def certified_criticals(
    rotor: Rotor, bearings: Sequence[Bearing], sets: Sequence[Projection], limit: float | None, count: int | None
) -> tuple[SpatialMotion, WhirlCertificate]:
    """Synchronous whirl of undamped bearings below a limit, or the lowest few, for some sets of tied motions."""
    return certified_whirl(
        rotor,
        bearings,
        [(one.blocks, one.critical(bearings)) for one in sets],
        synchronous_speed,
        None,
        NO_OSCILLATION * sets[0].floor,
        limit,
        None if limit is not None else count or DEFAULT_COUNT,
    )


def _undamped(bearing: Bearing) -> Bearing:
    """The bearing and its pedestal without damping."""
    pedestal = bearing.pedestal
    if pedestal is not None:
        pedestal = replace(pedestal, damping=np.zeros((2, 2)))
    return replace(bearing, damping=np.zeros_like(bearing.damping), pedestal=pedestal)


def _is_planar(bearing: Bearing) -> bool:
    """Whether each plane has its own springs, and the ground behind them."""
    stiffness = bearing.spatial_stiffness
    return bearing.pedestal is None and bool((stiffness[~np.eye(5, dtype=np.bool_)] == 0.0).all())


def _shares(lines: list[Line], count: int) -> tuple[list[Chain], list[int]]:
    """Chains of the planes, and how many modes each gives to the lowest ``count`` of both.

    Of a lumped rotor that has fewer, all.
    """
    available = [line.available_modes for line in lines]
    if sum(available) <= count:
        most = [int(number) for number in available]
        return [chain_that_holds(line, number) for line, number in zip(lines, most, strict=True)], most
    low, high = 0.0, lines[0].likely_frequency((count + 1) // 2)
    while True:
        chains = [line.cut(high) for line in lines]
        shares = [count_below(chain, high) for chain in chains]
        if sum(shares) >= count:
            break
        low, high = high, 2.0 * high
    for _ in range(MOST_HALVINGS):
        # One too many costs less than the search for the gap between the last two.
        if sum(shares) <= count + 1:
            break
        middle = 0.5 * (low + high)
        fewer = [count_below(chain, middle) for chain in chains]
        if sum(fewer) >= count:
            high, shares = middle, fewer
        else:
            low = middle
    return chains, shares
