"""Whirl eigenvalues of a Campbell diagram: exact roots at many speeds at once, and their proof."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .certificate import ACCEPTED
from .coalesced_roots import refine_roots
from .exact_roots import NEAR, ExactRoots, Speed, apart, constant_speed, distinct, refine_each
from .spatial_chain import WhirlEquations
from .whirl_certificate import certified_roots, oscillating
from .whirl_count import negative_count

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]

# Damped sets are proved at this many speeds, spread over the range.
PROOFS = 3
# Branches are followed this far beyond the limit at every speed.
WINDOW = 1.1
# Narrower gaps between starting values may vanish between the roots.
WIDE_GAP = 1e-3


def limits_behind(starts: Sequence[ComplexArray], frequency_limit: float | None, count: int | None) -> FloatArray:
    """At every speed a frequency in a gap above the wanted branches, (s,)."""
    sizes = np.sort(np.abs(np.concatenate(starts, axis=1)), axis=1)
    if count is None:
        assert frequency_limit is not None
        return np.full(sizes.shape[0], frequency_limit)
    limits = np.empty(sizes.shape[0])
    for k, row in enumerate(sizes):
        ascending = row[np.isfinite(row)]
        last = min(count, ascending.size)
        # Starting values are not exact: a gap must be wide enough to be one.
        while last < ascending.size and ascending[last] < ascending[last - 1] * (1.0 + WIDE_GAP):
            last += 1
        beyond = ascending[last] if last < ascending.size else 1.01 * ascending[-1]
        limits[k] = np.sqrt(ascending[last - 1] * beyond)
    return limits


def roots_at_speeds(
    chains: Sequence[WhirlEquations], values: ComplexArray, speeds: FloatArray, limits: FloatArray
) -> list[ExactRoots]:
    """Exact roots at every speed: separated ones of all speeds in one batch, clusters at their own speed."""
    chosen = [row[np.abs(row) < WINDOW * limit] for row, limit in zip(values, limits, strict=True)]
    same = all(chain is chains[0] for chain in chains)
    near = [not same or not apart(row, NEAR) for row in chosen]
    owner = np.concatenate([np.full(row.size, k) for k, row in enumerate(chosen)])
    alone = ~np.array(near)[owner]
    batch = refine_each(chains[0], np.concatenate(chosen)[alone], speeds[owner[alone]])
    batch_owner = owner[alone]
    roots = []
    for k, row in enumerate(chosen):
        if near[k]:
            roots.append(refine_roots(chains[k], row, constant_speed(float(speeds[k]))))
        else:
            own = batch.take(batch_owner == k)
            good = own.residuals <= ACCEPTED
            if not good.all():
                own = refine_roots(chains[k], own.eigenvalues, constant_speed(float(speeds[k])))
            roots.append(distinct(own))
    return roots


def proved_at(
    chains: Sequence[WhirlEquations],
    roots: list[ExactRoots],
    speeds: FloatArray,
    least: float,
    limits: FloatArray,
    undriven: bool,
    prove_all: bool,
) -> BoolArray:
    """Prove the number of roots at every speed, or at a few; where one is missing it is searched for."""
    if undriven:
        chosen = np.arange(speeds.size)
        expected = _expected(chains, speeds, least, limits)
        found = [
            int(oscillating(least, float(limit)).holds(one.eigenvalues).sum())
            for one, limit in zip(roots, limits, strict=True)
        ]
        doubtful = np.flatnonzero(expected != np.array(found))
    else:
        chosen = np.arange(speeds.size) if prove_all else np.linspace(0, speeds.size - 1, PROOFS).round().astype(int)
        doubtful = np.unique(chosen)
    for k in doubtful.tolist():
        sector = oscillating(least, float(limits[k]))
        inside, _ = certified_roots(chains[k], roots[k], constant_speed(float(speeds[k])), sector, undriven)
        beyond = roots[k].take(~sector.holds(roots[k].eigenvalues))
        roots[k] = inside.joined(beyond)
    proved = np.zeros(speeds.size, dtype=np.bool_)
    proved[chosen] = True
    return proved


def _expected(
    chains: Sequence[WhirlEquations], speeds: FloatArray, least: float, limits: FloatArray
) -> npt.NDArray[np.intp]:
    """Roots below the limits by inertia, (s,)."""
    if all(chain is chains[0] for chain in chains):
        twice = np.tile(speeds, 2).astype(np.complex128)
        counts = negative_count(chains[0], np.concatenate([limits, np.full(speeds.size, least)]), Speed(twice))
        return np.asarray(counts[: speeds.size] - counts[speeds.size :])
    rows = [
        negative_count(chain, np.array([limit, least]), constant_speed(float(speed)))
        for chain, limit, speed in zip(chains, limits, speeds, strict=True)
    ]
    return np.array([row[0] - row[1] for row in rows])
