"""Completeness of whirl modes: roots counted, and searched for again where one is missing."""

import numpy as np
import numpy.typing as npt

from .certificate import ModeCertificate
from .coalesced_roots import refine_roots, with_circle
from .errors import IncompleteModesError
from .exact_roots import ExactRoots, Speed, distinct
from .spatial_chain import WhirlEquations
from .whirl_count import negative_count
from .winding import NONE, RootOnContourError, Sector, count_by_argument_principle

ComplexArray = npt.NDArray[np.complex128]

# The sector of oscillating motions begins this far from the real axis, rad, and at this part of the lowest frequency.
NO_OSCILLATION = 1e-6
MOST_MISSING = 3
MOST_CUTS = 24
MOST_NUDGES = 6


def oscillating(least: float, most: float) -> Sector:
    """The sector of motions that oscillate, stable or not."""
    return Sector(least, most, NO_OSCILLATION, np.pi - NO_OSCILLATION)


def certified_roots(
    chain: WhirlEquations,
    roots: ExactRoots,
    speed: Speed,
    sector: Sector,
    conservative: bool,
    beyond: ComplexArray = NONE,
) -> tuple[ExactRoots, ModeCertificate]:
    """All roots in a sector, starting from the known ones, and the proof; approximate roots ``beyond`` reduce its work.

    Raises
    ------
    IncompleteModesError
        The count and the roots do not agree even after a search.
    """
    method = "inertia" if conservative else "winding"
    held = roots.take(sector.holds(roots.eigenvalues))
    expected = count_roots(chain, speed, sector, conservative, np.concatenate([roots.eigenvalues, beyond]))
    if held.eigenvalues.size < expected:
        held = search(chain, roots, speed, sector)
    found = held.eigenvalues.size
    certificate = ModeCertificate(sector.most, expected, found, max(held.residuals.tolist(), default=0.0), method)
    if not certificate.complete:
        raise IncompleteModesError(
            f"{found} whirl modes are found below {sector.most:g} rad/s, but the exact equations have {expected} "
            f"by their {method} count; choose a limit a little apart, or check the model for parts that differ by many "
            "orders of magnitude in stiffness or damping"
        )
    return held, certificate


def count_roots(
    chain: WhirlEquations, speed: Speed, sector: Sector, conservative: bool, known: ComplexArray = NONE
) -> int:
    """Number of roots in a sector: by inertia for a conservative rotor, else by the argument principle."""
    if conservative:
        edges = np.array([sector.least, sector.most])
        low, high = negative_count(chain, edges, speed).tolist()
        return int(high - low)
    return count_by_argument_principle(chain, sector, speed, known).count


def search(chain: WhirlEquations, known: ExactRoots, speed: Speed, sector: Sector) -> ExactRoots:
    """All roots in a sector: the known ones, and the missing ones by the argument principle and power sums."""
    roots, waiting, cuts = known, [sector], 0
    while waiting:
        part = waiting.pop()
        winding = count_by_argument_principle(chain, part, speed, roots.eigenvalues)
        inside = roots.eigenvalues[part.holds(roots.eigenvalues)]
        missing = winding.count - inside.size
        if missing <= 0:
            continue
        if missing <= MOST_MISSING:
            starts = winding.missing(missing)
            roots = distinct(roots.joined(refine_roots(chain, starts, speed)))
            for start in starts:
                if int(part.holds(roots.eigenvalues).sum()) == winding.count:
                    break
                roots = with_circle(chain, roots, complex(start), speed)
            if int(part.holds(roots.eigenvalues).sum()) == winding.count:
                continue
        if cuts >= MOST_CUTS:
            break
        cuts += 1
        waiting += _cut(chain, part, speed, roots.eigenvalues)
    return roots.take(sector.holds(roots.eigenvalues))


def _cut(chain: WhirlEquations, sector: Sector, speed: Speed, known: ComplexArray) -> list[Sector]:
    """Two parts of a sector without a root on their common side."""
    for nudge in range(MOST_NUDGES):
        halves = sector.halves(0.5 + 0.037 * nudge)
        try:
            count_by_argument_principle(chain, halves[0], speed, known)
        except RootOnContourError:
            continue
        return list(halves)
    raise RootOnContourError(
        f"whirl modes about |λ| = {sector.most:g} rad/s lie too close to each other to be told apart; "
        "choose a lower limit"
    )
