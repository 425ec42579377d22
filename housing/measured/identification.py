"""Modal identification from measured responses: poles by LSCF, a stability rule, shapes by LSFD.

In place of a person who reads a stabilisation chart, a rule takes poles that are stable over rising orders as modes.
Poles beyond an edge of the band are no modes of it, but their residues are fitted with the others: their flanks reach
into the band, and a mode that is not in the fit goes into the shapes of its neighbours.
"""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import HousingError, MeasuredDataError
from gearwhine.housing.measured.common_denominator import CIRCLE_SHARE, common_denominator_poles
from gearwhine.housing.measured.residues import (
    POWERS,
    FittedResponses,
    fit_residues,
    pole_evidence,
    refine_poles,
)
from gearwhine.housing.measured.survey_data import MeasuredModes, MeasuredResponses
from gearwhine.numerics.arrays import ComplexArray, FloatArray


@dataclass(frozen=True)
class StabilityRule:
    """Criteria of the pole of a mode.

    A pole of one order continues one of the order before where the frequency and the damping ratio differ by no more
    than the two tolerances; each pole continues one at most, the nearest first. A mode is a line of poles that goes on
    over at least `share` of the upper half of the orders; the chosen pole is nearest to the line's medians.

    Attributes
    ----------
    orders : int
        Highest order: number of poles of the common denominator.
    frequency : float
        Largest change of the frequency from one order to the next, as a part.
    damping : float
        Largest change of the damping ratio from one order to the next, as a part.
    largest_damping : float
        Largest damping ratio of a pole; the least is 0.
    share : float
        Least part of the upper half of the orders that a mode's line covers.
    contribution : float
        Least part of the responses' energy near its resonance that a mode contributes.
    evidence : float
        Least F-statistic of a mode's residues against the misfit near it; a pole below fits noise.
    """

    orders: int = 40
    frequency: float = 0.005
    damping: float = 0.20
    largest_damping: float = 0.2
    share: float = 0.5
    contribution: float = 1e-3
    evidence: float = 10.0

    def __post_init__(self) -> None:
        """Check that orders, share and tolerances are within their ranges."""
        if not 2 <= self.orders <= 200 or not 0.0 < self.share <= 1.0 or min(self.frequency, self.damping) <= 0.0:
            raise HousingError(f"{self} is no rule; expected 2 to 200 orders, a share up to 1 and tolerances above 0")


@dataclass
class PoleLine:
    """Line of a stabilisation chart: poles that continue each other over the orders, added one by one.

    Attributes
    ----------
    poles : list of complex
        Poles [rad/s].
    places : list of tuple of int
        Each pole's order, from 0, and its place among the poles of that order.
    stability : float
        Part of the upper half of the orders that the line covers.
    chosen : int
        Index of the chosen pole.
    """

    poles: list[complex] = field(default_factory=list)
    places: list[tuple[int, int]] = field(default_factory=list)
    stability: float = 0.0
    chosen: int = 0

    @property
    def pole(self) -> complex:
        """The chosen pole [rad/s]."""
        return self.poles[self.chosen]

    @property
    def place(self) -> tuple[int, int]:
        """Order and place of the chosen pole."""
        return self.places[self.chosen]


def pole_lines(orders: list[ComplexArray], rule: StabilityRule, low: float, high: float) -> list[PoleLine]:
    """Return the lines of stable poles that are modes by a rule, each with its chosen pole, ascending in frequency.

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
    chosen_lines = []
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
            chosen_lines.append(line)
    return sorted(chosen_lines, key=lambda line: abs(line.pole))


_TURNS = 200  # iterations of the two least-squares problems
_NOTHING = 1e-12  # weight below which nothing was measured
_HALF_GAP = 0.5 * (1.0 / CIRCLE_SHARE - 1.0)  # part of the band's width within which poles beyond it are found


@dataclass(frozen=True)
class IdentifiedModes:
    """Modes identified from responses, and the quality of the fit.

    Attributes
    ----------
    modes : MeasuredModes
        Shapes are the residues over all references, scaled to 1 at their largest.
    poles : ndarray of complex, shape (n_modes,)
        Poles [rad/s].
    stability : ndarray, shape (n_modes,)
        Part of the upper half of the orders over which each mode's pole went on.
    misfit : float
        Root mean square difference of measured and synthesised responses in the band, as a part of the measured.
    rank : ndarray, shape (n_modes,)
        Part of each mode's residues that one shape and one participation explain; below 1 there is a close mode, or
        noise. With one reference always 1.
    beyond : ndarray of complex, shape (n_beyond,)
        Poles beyond an edge of the band, whose residues were fitted with those of the modes [rad/s].
    """

    modes: MeasuredModes
    poles: ComplexArray
    stability: FloatArray
    misfit: float
    rank: FloatArray
    beyond: ComplexArray


_RULE = StabilityRule()
_HERTZ = 2.0 * np.pi
_RESIDUAL_POLES = 2  # poles that are tried beyond each edge of the band
_OUTSIDE = 0.01  # part of the band's width from which they start


def identify_modes(
    responses: MeasuredResponses, *, band: tuple[float, float] | None = None, rule: StabilityRule = _RULE
) -> IdentifiedModes:
    """Identify the modes in measured responses.

    Parameters
    ----------
    responses : MeasuredResponses
        Responses at evenly spaced frequencies; pairs that were not measured are left out.
    band : tuple of float, optional
        Band of the modes [rad/s]; by default all measured frequencies. Poles are estimated on all lines; shapes on
        those of the band, with the poles beyond its edges, and a residual mass and stiffness for the modes further
        out. Modes whose half-power width an edge cuts are named in the modes' `cut_by_band`.
    rule : StabilityRule

    Raises
    ------
    MeasuredDataError
        Where frequencies are not evenly spaced, no mode is stable in the band, or a degree of freedom or reference has
        no response.
    """
    step, first = _spacing(responses.frequencies)
    lowest, highest = step * max(first, 1), step * (first + len(responses.frequencies) - 1)
    low, high = (lowest, highest) if band is None else band
    low, high = max(low, lowest), min(high, highest)
    if not low < high:
        raise MeasuredDataError(f"the band {low / _HERTZ:g} to {high / _HERTZ:g} Hz holds none of the responses")
    measured = np.asarray(~np.isnan(responses.values[:, :, 0]), dtype=np.bool_)
    if not measured.any(axis=1).all() or not measured.any(axis=0).all():
        raise MeasuredDataError(
            "a degree of freedom or a reference of the responses was measured with none of the others"
        )
    rows, omega = responses.values[measured], responses.frequencies
    if omega[0] == 0.0:
        rows, omega = rows[:, 1:], omega[1:]
    # Poles are those of all lines, and a little beyond.
    orders = common_denominator_poles(rows, float(omega[0]), step, rule.orders)
    margin = _HALF_GAP * (highest - lowest)
    lines = pole_lines(orders, rule, max(lowest - margin, 0.0), highest + margin)
    inside = (omega >= low) & (omega <= high)
    band_fit = _BandFit(rows[:, inside], omega[inside], POWERS[responses.motion], (low, high), rule)
    poles, stability = band_fit.standing(
        np.array([line.pole for line in lines]), np.array([line.stability for line in lines])
    )
    if not band_fit.in_band(poles).any():
        raise MeasuredDataError(
            f"no pole between {low / _HERTZ:g} and {high / _HERTZ:g} Hz is stable over the orders up to {rule.orders} "
            "and stands out of the noise: there are no modes"
        )
    poles = band_fit.with_residual_poles(poles)
    fit = band_fit.residues(poles)
    modal = np.flatnonzero(band_fit.in_band(poles[: len(stability)]))
    modal = modal[np.argsort(np.abs(poles[modal]))]
    shapes, rank = _shapes(fit.residues[:, modal], measured)
    found = poles[modal]
    sizes, half_widths = np.abs(found), -found.real
    cut = np.flatnonzero((sizes - half_widths < low) | (sizes + half_widths > high))
    modes = MeasuredModes(sizes, half_widths / sizes, shapes, responses.geometry, tuple(cut.tolist()))
    return IdentifiedModes(modes, found, stability[modal], fit.misfit, rank, np.delete(poles, modal))


@dataclass(frozen=True)
class _BandFit:
    """Fit of poles and residues to the lines of a band.

    Attributes
    ----------
    rows : ndarray of complex, shape (n_rows, n_lines)
    omega : ndarray, shape (n_lines,)
        Circular frequencies of the lines [rad/s].
    power : int
        Power of iω of the motion.
    band : tuple of float
        Edges [rad/s].
    rule : StabilityRule
    """

    rows: ComplexArray
    omega: FloatArray
    power: int
    band: tuple[float, float]
    rule: StabilityRule

    def residues(self, poles: ComplexArray) -> FittedResponses:
        return fit_residues(self.rows, self.omega, poles, self.power)

    def refined(self, poles: ComplexArray) -> ComplexArray:
        return refine_poles(self.rows, self.omega, poles, self.power)

    def in_band(self, poles: ComplexArray) -> npt.NDArray[np.bool_]:
        return np.asarray((np.abs(poles) >= self.band[0]) & (np.abs(poles) <= self.band[1]))

    def standing(self, poles: ComplexArray, stability: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """Refine the poles, and leave out those that are no modes until all others are; none where none is in band."""
        while self.in_band(poles).any():
            poles = self.refined(poles)
            kept = self._are_modes(poles)
            if kept.all():
                break
            poles, stability = poles[kept], stability[kept]
        return poles, stability

    def with_residual_poles(self, poles: ComplexArray) -> ComplexArray:
        """Append poles beyond each edge for as long as they explain more than noise does.

        Stable ones are there already. A mode just outside, of which the band has a flank alone, is seldom stable.
        """
        damping = float(np.median(-poles.real / np.abs(poles)))
        for edge, outward in ((self.band[0], -1.0), (self.band[1], 1.0)):
            for _ in range(_RESIDUAL_POLES):
                size = edge + outward * _OUTSIDE * (self.band[1] - self.band[0])
                if size <= 0.0:
                    break
                tried = self.refined(np.append(poles, size * complex(-damping, 1.0)))
                beyond = outward * (abs(tried[-1]) - edge) > 0.0
                same = np.array_equal(self.in_band(tried[:-1]), self.in_band(poles))
                if not (beyond and same and self._are_modes(tried).all()):
                    break
                poles = tried
        return poles

    def _are_modes(self, poles: ComplexArray) -> npt.NDArray[np.bool_]:
        """Whether each pole contributes enough to the responses, and more than a fit of noise."""
        fit = self.residues(poles)
        contribution = np.empty(len(poles))
        for number, pole in enumerate(poles):
            line = int(np.argmin(np.abs(self.omega - abs(pole))))
            size = np.linalg.norm(fit.residues[:, number]) / abs(1j * self.omega[line] - pole)
            contribution[number] = (self.omega[line] ** self.power * size / np.linalg.norm(self.rows[:, line])) ** 2
        evidence = pole_evidence(self.rows, self.omega, poles, self.power, fit)
        return np.asarray((contribution >= self.rule.contribution) & (evidence >= self.rule.evidence))


def _spacing(omega: FloatArray) -> tuple[float, int]:
    """Return the even spacing of frequencies [rad/s], and the number of spacings from 0 to the first.

    Raises
    ------
    MeasuredDataError
        Where they are not whole multiples of one spacing, as the lines of an analyser are.
    """
    step = float((omega[-1] - omega[0]) / (len(omega) - 1))
    numbers = omega / step
    first = round(numbers[0])
    if np.abs(numbers - first - np.arange(len(omega))).max() > 0.01:
        raise MeasuredDataError(
            "the frequencies of the responses are not whole multiples of one spacing, which finding modes needs"
        )
    return step, first


def _shapes(residues: ComplexArray, measured: npt.NDArray[np.bool_]) -> tuple[ComplexArray, FloatArray]:
    """Shapes from residues R = φ ψᵀ of all references, and the part of R that one pair explains."""
    shapes, parts = [], []
    for residue in residues.T:
        table = np.zeros(measured.shape, dtype=np.complex128)
        table[measured] = residue
        left, sizes, right = np.linalg.svd(table, full_matrices=False)
        shape, participation = left[:, 0], sizes[0] * right[0]
        if not measured.all():
            shape, participation = _completed(table, measured, shape, participation)
        left_over = np.linalg.norm((table - np.outer(shape, participation))[measured]) / np.linalg.norm(table)
        shapes.append(shape / shape[np.argmax(np.abs(shape))])
        parts.append(1.0 - left_over**2)
    return np.array(shapes), np.array(parts)


def _completed(
    table: ComplexArray, measured: npt.NDArray[np.bool_], shape: ComplexArray, participation: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Fit the pair φ, ψ of the least Σ |R - φ ψᵀ|² over the measured entries, by alternating least squares."""
    for _ in range(_TURNS):
        before = shape
        weight = measured.T @ np.abs(shape) ** 2
        participation = (table.T @ shape.conj()) / np.maximum(weight, _NOTHING)
        weight = measured @ np.abs(participation) ** 2
        shape = (table @ participation.conj()) / np.maximum(weight, _NOTHING * np.abs(participation).max() ** 2)
        scale = np.linalg.norm(shape)
        shape, participation = shape / scale, participation * scale
        if np.linalg.norm(shape - before) < 1e-12:
            break
    return shape, participation
