"""Modal identification from measured responses: poles by LSCF, a stability rule, shapes by LSFD.

The two estimators are those of sdypy-EMA (extra ``ema``): the least-squares complex frequency-domain method with a
common denominator (P. Verboven, dissertation, Vrije Universiteit Brussel, 2002), and the least-squares frequency-domain
residues. In place of a person who reads a stabilisation chart, a rule takes poles that are stable over rising orders as
modes.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import HousingError, MeasuredDataError
from gearwhine.housing.measured.survey_data import MeasuredModes, MeasuredResponses

ComplexArray = npt.NDArray[np.complex128]
FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class StabilityRule:
    """Criteria of the pole of a mode.

    A pole of one order continues one of the order before where the frequency and the damping ratio differ by no more
    than the two tolerances; each pole continues one at most, the nearest first. A mode is a line of poles that goes on
    over at least `share` of the upper half of the orders; the chosen pole is nearest to the line's medians.

    Attributes
    ----------
    orders : int
        Highest order: pairs of poles of the common denominator.
    frequency : float
        Largest change of the frequency from one order to the next, as a part.
    damping : float
        Largest change of the damping ratio from one order to the next, as a part.
    largest_damping : float
        Largest damping ratio of a pole; the least is 0.
    share : float
        Least part of the upper half of the orders that a mode's line covers.
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
_FORMS = {"displacement": "receptance", "velocity": "mobility", "acceleration": "accelerance"}


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
    """

    modes: MeasuredModes
    poles: ComplexArray
    stability: FloatArray
    misfit: float
    rank: FloatArray


_RULE = StabilityRule()


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
        those of the band, with a residual mass and a residual stiffness for the modes outside.
    rule : StabilityRule

    Raises
    ------
    MeasuredDataError
        Where frequencies are not evenly spaced, no mode is stable in the band, or a degree of freedom or reference has
        no response.
    HousingError
        Where sdypy-EMA is not installed.
    """
    try:
        from sdypy import EMA
    except ImportError as error:
        raise HousingError("modes of measured responses need sdypy-EMA: pip install 'gearwhine[ema]'") from error
    step, first = _spacing(responses.frequencies / (2.0 * np.pi))
    lowest, highest = step * max(first, 1), step * (first + len(responses.frequencies) - 1)
    low, high = (lowest, highest) if band is None else (band[0] / (2.0 * np.pi), band[1] / (2.0 * np.pi))
    low, high = max(low, lowest), min(high, highest)
    if not low < high:
        raise MeasuredDataError(f"the band {low:g} to {high:g} Hz holds none of the responses' frequencies")
    measured = np.asarray(~np.isnan(responses.values[:, :, 0]), dtype=np.bool_)
    if not measured.any(axis=1).all() or not measured.any(axis=0).all():
        raise MeasuredDataError(
            "a degree of freedom or a reference of the responses was measured with none of the others"
        )
    # Lines from 0 on, as the estimator's Fourier sums need them; those below the band carry no weight.
    rows = np.pad(responses.values[measured], ((0, 0), (first, 0)))
    hertz = step * np.arange(rows.shape[1])
    form = _FORMS[responses.motion]
    # Poles are those of all lines: a denominator of real coefficients is ill-posed on a narrow band.
    model = EMA.Model(rows, hertz, lower=lowest, upper=highest, pol_order_high=rule.orders, frf_form=form)
    model.get_poles(method="lscf", show_progress=False)
    lines = pole_lines(model.all_poles, rule, 2.0 * np.pi * low, 2.0 * np.pi * high)
    if not lines:
        raise MeasuredDataError(
            f"no pole between {low:g} and {high:g} Hz is stable over the orders up to {rule.orders}"
        )
    while True:
        fitted, residues = _residues(model, lines, low, min(high, float(model.freq[-1])))
        contributing = _contributing(lines, model.frf, residues, step, form, rule)
        if not contributing:
            raise MeasuredDataError(
                f"no stable pole between {low:g} and {high:g} Hz makes a good part of the responses"
            )
        if len(contributing) == len(lines):
            break
        lines = contributing
    poles = np.array([line.pole for line in lines])
    order = np.argsort(np.abs(poles))
    shapes, rank = _shapes(residues[:, order], measured)
    inside = (model.freq >= low) & (model.freq <= high)
    in_band = model.frf[:, inside]
    misfit = float(np.linalg.norm(fitted[:, inside] - in_band) / np.linalg.norm(in_band))
    modes = MeasuredModes(np.abs(poles)[order], (-poles.real / np.abs(poles))[order], shapes, responses.geometry)
    return IdentifiedModes(modes, poles[order], np.array([line.stability for line in lines])[order], misfit, rank)


def _spacing(hertz: FloatArray) -> tuple[float, int]:
    """Return the even spacing of frequencies [Hz], and the number of spacings from 0 to the first.

    Raises
    ------
    MeasuredDataError
        Where they are not whole multiples of one spacing, as the lines of an analyser are.
    """
    step = float((hertz[-1] - hertz[0]) / (len(hertz) - 1))
    numbers = hertz / step
    first = round(numbers[0])
    if np.abs(numbers - first - np.arange(len(hertz))).max() > 0.01:
        raise MeasuredDataError(
            "the frequencies of the responses are not whole multiples of one spacing, which finding modes needs"
        )
    return step, first


def _residues(model: Any, lines: list[PoleLine], low: float, high: float) -> tuple[ComplexArray, ComplexArray]:
    """Synthesised responses and residues, shape (n_rows, n_modes), of the chosen poles."""
    model.pole_ind = np.array([line.place for line in lines])
    fitted, residues = model.get_constants(method="lsfd", f_lower=low, f_upper=high)
    return np.asarray(fitted), np.asarray(residues)[:, : len(lines)]


def _contributing(
    lines: list[PoleLine], rows: ComplexArray, residues: ComplexArray, step: float, form: str, rule: StabilityRule
) -> list[PoleLine]:
    """Return the lines whose modes contribute enough to the responses at their own resonance."""
    contributing = []
    power = ("receptance", "mobility", "accelerance").index(form)
    for number, line in enumerate(lines):
        omega = abs(line.pole)
        index = min(round(omega / (2.0 * np.pi * step)), rows.shape[1] - 1)
        peak = omega**power * np.linalg.norm(residues[:, number]) / abs(line.pole.real)
        if peak**2 >= rule.contribution * float(np.linalg.norm(rows[:, index])) ** 2:
            contributing.append(line)
    return contributing


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
