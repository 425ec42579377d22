"""Stabilisation chart: the rule by which stable poles over rising orders are taken as modes."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError

ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class StabilityRule:
    """Criteria of the pole of a mode.

    A pole of one order continues one of the order before where the frequency and the damping ratio differ by no more
    than the two tolerances; each pole continues one at most, the nearest first. A mode is a line of poles that goes on
    over at least `share` of the upper half of the orders; the one taken is nearest to the line's medians.

    Attributes
    ----------
    orders : int
        Highest order: pairs of poles of the common denominator.
    frequency : float
        Largest change from one order to the next, as a part.
    damping : float
        The same of the damping ratio.
    largest_damping : float
        Ratios of poles lie between 0 and this.
    share : float
        Of the upper half of the orders that a mode's line covers at least.
    contribution : float
        Least part of the responses' energy near its resonance that a mode contributes; a pole that makes less is noise.
    """

    orders: int = 40
    frequency: float = 0.005
    damping: float = 0.20
    largest_damping: float = 0.2
    share: float = 0.5
    contribution: float = 1e-3

    def __post_init__(self) -> None:
        if not 2 <= self.orders <= 200 or not 0.0 < self.share <= 1.0 or min(self.frequency, self.damping) <= 0.0:
            raise HousingError(f"{self} is no rule; expected 2 to 200 orders, a share up to 1 and tolerances above 0")


@dataclass
class PoleLine:
    """Poles that continue each other over the orders; it grows while they are gone through.

    Attributes
    ----------
    poles : list of complex
        [rad/s].
    places : list of tuple of int
        Of each its order, from 0, and its place among the poles of that order.
    stability : float
        Part of the upper half of the orders that the line covers.
    chosen : int
        Index of the pole taken.
    """

    poles: list[complex] = field(default_factory=list)
    places: list[tuple[int, int]] = field(default_factory=list)
    stability: float = 0.0
    chosen: int = 0

    @property
    def pole(self) -> complex:
        """The pole taken [rad/s]."""
        return self.poles[self.chosen]

    @property
    def place(self) -> tuple[int, int]:
        """Order and place of the pole taken."""
        return self.places[self.chosen]


def pole_lines(orders: list[ComplexArray], rule: StabilityRule, low: float, high: float) -> list[PoleLine]:
    """The lines of poles that are modes by a rule, each with the pole taken, ascending in frequency.

    Parameters
    ----------
    orders : list of ndarray of complex
        The poles of each order, the lowest first [rad/s].
    rule : StabilityRule
    low, high : float
        Least and largest |λ| of poles that count [rad/s].
    """
    growing: list[PoleLine] = []
    ended: list[PoleLine] = []
    for order, poles in enumerate(orders):
        sizes = np.abs(poles)
        ratios = -poles.real / np.where(sizes > 0.0, sizes, 1.0)
        usable = (poles.imag > 0.0) & (ratios > 0.0) & (ratios < rule.largest_damping) & (sizes > low) & (sizes < high)
        free = {int(place) for place in np.flatnonzero(usable)}
        pairs = []
        for number, line in enumerate(growing):
            last = line.poles[-1]
            ratio = -last.real / abs(last)
            for place in free:
                apart = abs(sizes[place] / abs(last) - 1.0) / rule.frequency
                unlike = abs(ratios[place] / ratio - 1.0) / rule.damping
                if apart <= 1.0 and unlike <= 1.0:
                    pairs.append((apart + unlike, number, place))
        going: dict[int, int] = {}
        for _, number, place in sorted(pairs):
            if number not in going and place in free:
                going[number] = place
                free.discard(place)
        for number, line in enumerate(growing):
            if number in going:
                line.poles.append(complex(poles[going[number]]))
                line.places.append((order, going[number]))
        ended += [line for number, line in enumerate(growing) if number not in going]
        growing = [line for number, line in enumerate(growing) if number in going]
        growing += [PoleLine([complex(poles[place])], [(order, place)]) for place in sorted(free)]
    half = len(orders) // 2
    found = []
    for line in ended + growing:
        upper = [index for index, (order, _) in enumerate(line.places) if order >= half]
        line.stability = len(upper) / (len(orders) - half)
        if line.stability >= rule.share:
            poles = np.array(line.poles)[upper]
            sizes, ratios = np.abs(poles), -poles.real / np.abs(poles)
            unlike = (
                np.abs(sizes / np.median(sizes) - 1.0) / rule.frequency
                + np.abs(ratios / np.median(ratios) - 1.0) / rule.damping
            )
            line.chosen = upper[int(np.argmin(unlike))]
            found.append(line)
    return sorted(found, key=lambda line: abs(line.pole))
