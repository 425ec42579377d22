"""Comparison of model and measured modes: pairs, frequency errors, shape correlation, and confidence in the pairs.

Three comparisons:

- by shapes (:func:`compare_by_shapes`): measured and model shapes are paired by
  :mod:`gearwhine.housing.correlation.pairing` and judged by all criteria of shape correlation: the MAC of every pair,
  unpaired modes, modes that are alike, close modes, orthogonality, quality of the survey;
- by dominance (:func:`compare_by_dominance`): measured frequencies without shapes are paired with the model's dominant
  modes (:mod:`gearwhine.housing.modes.dominance`);
- by frequency (:func:`compare_by_frequency`): measured frequencies are paired in their order, the first with the first
  or the nearest ones.

When 25 model modes fill 3 kHz, any measured frequency has one within a few per cent, so the nearest one proves
little; :attr:`Comparison.chance_error_percent` says how little. Where the dominant modes are the measured ones, the
n dominant modes of the model, in order of frequency, are the stronger evidence.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from gearwhine.housing.correlation.modal_assurance_criterion import (
    ShapeArray,
    auto_mac,
    comac,
    enhanced_comac,
    largest_off_diagonal,
    modal_assurance_criterion,
    phase_collinearity,
    two_sets,
)
from gearwhine.housing.correlation.orthogonality import cross_orthogonality, outside_span
from gearwhine.housing.correlation.pairing import PairingRule, ShapePair, nearest_in_order, pair_modes
from gearwhine.housing.correlation.subspaces import nearest_in_span, principal_angles
from gearwhine.housing.errors import HousingError
from gearwhine.housing.measured import MeasuredModes
from gearwhine.housing.modes.dominance import Dominance
from gearwhine.numerics.arrays import ComplexArray, FloatArray

Pairing = Literal["order", "nearest", "dominance", "shapes"]
"""How measured modes are paired with the model's."""


@dataclass(frozen=True)
class LookAlikes:
    """Two modes of one set whose shapes the survey finds alike.

    Attributes
    ----------
    first, second : int
        Numbers of the modes, from 1.
    mac : float
        MAC of the two shapes.
    one_frequency : bool
        Whether they are as close in frequency as close modes are, or an estimate's scatter: two modes of a test are
        then most likely one mode found twice. Otherwise the survey has too few points, or in the wrong places, to
        distinguish them.
    """

    first: int
    second: int
    mac: float
    one_frequency: bool


@dataclass(frozen=True)
class CloseModes:
    """Modes close to each other, of the model or of the test, and their partners, compared as spaces.

    Attributes
    ----------
    model, measured : tuple of int
        Numbers of the modes, from 1.
    largest_angle : float
        Between the spaces that they span [rad]: 0 where the measured ones are combinations of the model's; NaN where
        they were measured at too few degrees of freedom in common.
    """

    model: tuple[int, ...]
    measured: tuple[int, ...]
    largest_angle: float


@dataclass(frozen=True)
class ShapeCorrelation:
    """Correlation of all model shapes with all measured ones.

    Attributes
    ----------
    model_frequencies, measured_frequencies : ndarray, shapes (a,) and (b,)
        Circular frequencies [rad/s].
    mac : ndarray, shape (a, b)
    model_auto_mac, measured_auto_mac : ndarray, shapes (a, a) and (b, b)
        The survey cannot distinguish modes with large values off the diagonal.
    unpaired_measured : tuple of int
        Numbers of measured modes that no model mode is like: the model lacks them, or they are no modes.
    unpaired_model : tuple of int
        Numbers of model modes between the first and the last measured frequency without a measured mode: the test
        missed them, or they are wrong.
    measured_look_alikes, model_look_alikes : tuple of LookAlikes
    close : tuple of CloseModes
    comac, enhanced_comac : ndarray, shape (n_dofs,), or None
        Over the pairs, close modes turned to each other; None without pairs.
    collinearity : ndarray, shape (b,)
        Modal phase collinearity of each measured shape: 1 where it is real.
    cross_orthogonality : ndarray, shape (c, b), or None
        Cross-orthogonality of the measured shapes with the modes ``orthogonality_modes``, in the SEREP-reduced mass.
    orthogonality_modes : tuple of int
        Numbers of the model's modes, c of them.
    outside : ndarray, shape (b,), or None
        Part of each measured shape that these modes do not span.
    no_orthogonality : str
        Reason where there is no cross-orthogonality; else empty.
    """

    model_frequencies: FloatArray
    measured_frequencies: FloatArray
    mac: FloatArray
    model_auto_mac: FloatArray
    measured_auto_mac: FloatArray
    unpaired_measured: tuple[int, ...]
    unpaired_model: tuple[int, ...]
    measured_look_alikes: tuple[LookAlikes, ...]
    model_look_alikes: tuple[LookAlikes, ...]
    close: tuple[CloseModes, ...]
    comac: FloatArray | None
    enhanced_comac: FloatArray | None
    collinearity: FloatArray
    cross_orthogonality: FloatArray | None
    orthogonality_modes: tuple[int, ...]
    outside: FloatArray | None
    no_orthogonality: str = ""

    @property
    def largest_measured_likeness(self) -> float:
        """Largest MAC between different measured modes."""
        return largest_off_diagonal(self.measured_auto_mac)

    @property
    def largest_model_likeness(self) -> float:
        """Largest MAC between different modes of the model in the band: those far outside need not be distinguished."""
        which = np.array(self.orthogonality_modes, dtype=np.int64) - 1
        return largest_off_diagonal(self.model_auto_mac[np.ix_(which, which)]) if which.size else 0.0


@dataclass(frozen=True)
class ModePair:
    """Pair of a measured mode and a model mode.

    Attributes
    ----------
    measured, model : float
        Circular frequencies [rad/s].
    measured_mode, mode : int
        Numbers of the measured and of the model mode, from 1.
    strength : float or None
        The model mode's lateral acceleration strength [1/kg]; None where nothing drives the housing.
    mac : float or None
        Modal assurance criterion, with the close modes together where there are any; None without shapes.
    confidence : float or None
        Margin of this pair over the next best assignment, from 0 to 1, not a probability; None without shapes.
    close_modes : tuple of int
        Numbers of the close model modes to which the pair's mode belongs; empty where it stands apart.
    mixed : bool
        Whether shapes cannot identify the single modes of the close group.
    """

    measured: float
    model: float
    measured_mode: int
    mode: int
    strength: float | None
    mac: float | None = None
    confidence: float | None = None
    close_modes: tuple[int, ...] = ()
    mixed: bool = False

    @property
    def error_percent(self) -> float:
        """Model minus measured, in per cent of measured."""
        return 100.0 * (self.model / self.measured - 1.0)


@dataclass(frozen=True)
class UnpairedMode:
    """Mode without a partner.

    Attributes
    ----------
    number : int
        Number of the mode, from 1.
    frequency : float
        Circular frequency [rad/s].
    """

    number: int
    frequency: float


@dataclass(frozen=True)
class Comparison:
    """Pairs of measured and model modes, and the confidence of the pairing.

    Attributes
    ----------
    pairs : tuple of ModePair
        Ascending in the measured frequency.
    pairing : {"order", "nearest", "dominance", "shapes"}
    rule : str
        The rule by which they were paired, in words.
    band : tuple of float
        Band of possible partners [rad/s].
    gap : float or None
        In a pairing by dominance, ln(strength of the last chosen mode / strength of the first left out); below 0.1 the
        choice is a coin toss.
    measures_agree : bool or None
        In a pairing by dominance, whether acceleration, velocity and mean absolute strength all choose these modes.
    shapes : ShapeCorrelation or None
        Correlation of the shapes, where there are any.
    unpaired_measured, unpaired_model : tuple of UnpairedMode, or None
        In a pairing by frequency, the measured modes without a partner, and those of the model between the first and
        the last measured frequency.
    chance_error_percent : float or None
        In the pairing "nearest", the root-mean-square distance from the nearest mode of the model at which a
        frequency lies that is drawn at random in the band, uniform in the logarithm. Errors that are not clearly
        smaller are no evidence for the model.
    """

    pairs: tuple[ModePair, ...]
    pairing: Pairing
    rule: str
    band: tuple[float, float]
    gap: float | None = None
    measures_agree: bool | None = None
    shapes: ShapeCorrelation | None = None
    unpaired_measured: tuple[UnpairedMode, ...] | None = None
    unpaired_model: tuple[UnpairedMode, ...] | None = None
    chance_error_percent: float | None = None

    @property
    def rms_error_percent(self) -> float:
        """Root-mean-square of the errors; NaN without pairs."""
        errors = [pair.error_percent**2 for pair in self.pairs]
        return float(np.sqrt(np.mean(errors))) if errors else float("nan")

    @property
    def max_error_percent(self) -> float:
        """Largest absolute error; NaN without pairs."""
        return max((abs(pair.error_percent) for pair in self.pairs), default=float("nan"))


# Ends of the band of dominant modes, as parts of the first and the last measured frequency.
_BAND = (0.75, 1.05)


def dominance_band(measured: FloatArray) -> tuple[float, float]:
    """Band of the dominant modes: 0.75 of the first to 1.05 of the last measured frequency, in their unit."""
    return _BAND[0] * float(measured[0]), _BAND[1] * float(measured[-1])


def compare_by_dominance(
    measured: FloatArray, strengths: Dominance, *, band: tuple[float, float] | None = None
) -> Comparison:
    """Pair the measured modes with as many dominant modes of the model, in order of frequency.

    Parameters
    ----------
    measured : ndarray, shape (n,)
        Measured circular frequencies, ascending [rad/s].
    strengths : Dominance
        Strengths of the model's modes.
    band : tuple of float, optional
        Band that is searched for dominant modes [rad/s]; by default that of :func:`dominance_band`.

    Raises
    ------
    HousingError
        Where nothing was measured, the measured frequencies do not ascend, or the model has fewer modes in the band.
    """
    if len(measured) == 0 or measured[0] <= 0.0 or np.any(np.diff(measured) <= 0.0):
        raise HousingError(f"measured frequencies {measured} rad/s must be positive and ascending")
    low, high = band or dominance_band(measured)
    chosen = strengths.strongest(len(measured), (low, high))
    if len(chosen) < len(measured):
        hertz = 2.0 * np.pi
        raise HousingError(
            f"{len(measured)} measured modes, but the model has only {len(chosen)} between {low / hertz:.0f} and "
            f"{high / hertz:.0f} Hz; raise the housing's frequency_limit or correct the model"
        )
    pairs = tuple(
        ModePair(
            float(frequency),
            float(strengths.frequencies[mode]),
            number,
            int(mode) + 1,
            float(strengths.acceleration[mode]),
        )
        for number, (frequency, mode) in enumerate(zip(measured, chosen, strict=True), start=1)
    )
    return Comparison(
        pairs=pairs,
        pairing="dominance",
        rule="dominance in order of frequency",
        band=(low, high),
        gap=strengths.gap(len(measured), (low, high)),
        measures_agree=strengths.measures_agree(len(measured), (low, high)),
    )


def compare_by_frequency(
    measured: FloatArray,
    frequencies: FloatArray,
    pairing: Literal["order", "nearest"] = "nearest",
    *,
    strengths: Dominance | None = None,
) -> Comparison:
    """Pair measured modes with the model's elastic ones in order of frequency.

    Parameters
    ----------
    measured : ndarray, shape (n,)
        Measured circular frequencies, ascending [rad/s].
    frequencies : ndarray, shape (n_modes,)
        Circular frequencies of the model, ascending [rad/s]; rigid motion, at zero, is paired with nothing.
    pairing : {"order", "nearest"}
        The first with the first and so on, or by :func:`gearwhine.housing.correlation.pairing.nearest_in_order`: modes
        of the model are left out where that makes the squared errors less.
    strengths : Dominance, optional
        Strengths of the model's modes, to stand beside each pair.

    Raises
    ------
    HousingError
        Where nothing was measured, the measured frequencies do not ascend, or the model has no elastic mode.
    """
    if len(measured) == 0 or measured[0] <= 0.0 or np.any(np.diff(measured) < 0.0):
        raise HousingError(f"measured frequencies {measured} rad/s must be positive and ascending")
    elastic = np.flatnonzero(frequencies > 0.0)
    if elastic.size == 0:
        raise HousingError(f"{len(measured)} measured modes, but the model has no elastic one; raise its limit")
    if pairing == "order":
        order = np.arange(min(len(elastic), len(measured)))
        chosen = np.column_stack((order, order))
    else:
        chosen = nearest_in_order(frequencies[elastic], measured)
    pairs = tuple(
        ModePair(
            measured=float(measured[j]),
            model=float(frequencies[elastic[i]]),
            measured_mode=int(j) + 1,
            mode=int(elastic[i]) + 1,
            strength=None if strengths is None else float(strengths.acceleration[elastic[i]]),
        )
        for i, j in chosen
    )
    band = dominance_band(measured)
    between = elastic[(frequencies[elastic] >= measured[0]) & (frequencies[elastic] <= measured[-1])]
    missed, lone = set(range(len(measured))) - set(chosen[:, 1].tolist()), np.setdiff1d(between, elastic[chosen[:, 0]])
    return Comparison(
        pairs=pairs,
        pairing=pairing,
        rule=_BY_FREQUENCY[pairing],
        band=band,
        unpaired_measured=tuple(UnpairedMode(j + 1, float(measured[j])) for j in sorted(missed)),
        unpaired_model=tuple(UnpairedMode(int(i) + 1, float(frequencies[i])) for i in lone),
        chance_error_percent=_chance_error(frequencies[elastic], band) if pairing == "nearest" else None,
    )


_BY_FREQUENCY = {"order": "order of frequency, the first with the first", "nearest": "nearest frequencies in order"}


def _chance_error(model: FloatArray, band: tuple[float, float]) -> float:
    """Distance of a random frequency in a band from the nearest model frequency, root mean square [%].

    With x = ln ω uniform in the band, the mean of (x - x_k)² over each mode's own cell, up to midway to its neighbours.
    """
    places = np.log(model)
    low, high = np.log(band)
    edges = np.concatenate(([low], np.clip(0.5 * (places[1:] + places[:-1]), low, high), [high]))
    cubes = (edges[1:] - places) ** 3 - (edges[:-1] - places) ** 3
    return float(100.0 * np.sqrt(cubes.sum() / 3.0 / (high - low)))


_ONE_FREQUENCY = 0.02  # part of a frequency by which two estimates of one mode may scatter


def compare_by_shapes(
    frequencies: FloatArray,
    shapes: npt.ArrayLike,
    measured: MeasuredModes,
    *,
    rule: PairingRule | None = None,
    strengths: Dominance | None = None,
) -> Comparison:
    """Pair measured modes with the model's by their shapes; see :mod:`gearwhine.housing.correlation.pairing`.

    Parameters
    ----------
    frequencies : ndarray, shape (n_modes,)
        Circular frequencies of the model, ascending [rad/s].
    shapes : array_like, shape (n_modes, n_dofs)
        The model's mass-normalised shapes at the measured degrees of freedom [1/√kg].
    measured : MeasuredModes
        Measured modes with shapes.
    rule : PairingRule, optional
    strengths : Dominance, optional
        Strengths of the model's modes, to stand beside each pair.

    Raises
    ------
    HousingError
        Where nothing was measured but frequencies, sets do not fit together, or shapes have too few degrees of freedom.
    """
    if measured.shapes is None:
        raise HousingError("measured modes without shapes are paired by dominance, not by shape")
    rule = rule or PairingRule()
    phi, psi = two_sets(shapes, measured.shapes, ("the model's", "the measured"))
    pairs = pair_modes(frequencies, phi, measured.frequencies, psi, rule)
    reach = np.exp(rule.window * np.array([-1.0, 1.0]))
    band = (float(reach[0] * measured.frequencies[0]), float(reach[1] * measured.frequencies[-1]))
    return Comparison(
        pairs=tuple(_named(pair, frequencies, measured.frequencies, strengths) for pair in pairs),
        pairing="shapes",
        rule=f"MAC and frequency, best assignment, MAC at least {rule.least_mac:g}",
        band=band,
        shapes=_evidence(frequencies, phi, measured.frequencies, psi, pairs, rule, band),
    )


def with_shapes(
    comparison: Comparison, frequencies: FloatArray, shapes: npt.ArrayLike, measured: MeasuredModes
) -> Comparison:
    """Return a comparison whose pairs were made without shapes, with the correlation of the shapes beside it.

    Parameters
    ----------
    comparison : Comparison
    frequencies, shapes, measured
        See :func:`compare_by_shapes`.

    Raises
    ------
    HousingError
        Where nothing was measured but frequencies, or sets do not fit together.
    """
    if measured.shapes is None:
        raise HousingError("measured modes without shapes have no MAC")
    phi, psi = two_sets(shapes, measured.shapes, ("the model's", "the measured"))
    table = modal_assurance_criterion(phi, psi)
    pairs = tuple(replace(pair, mac=float(table[pair.mode - 1, pair.measured_mode - 1])) for pair in comparison.pairs)
    alone = [
        ShapePair(pair.mode - 1, pair.measured_mode - 1, float(pair.mac or 0.0), np.nan, (), (), mixed=False)
        for pair in pairs
    ]
    evidence = _evidence(frequencies, phi, measured.frequencies, psi, alone, PairingRule(), comparison.band)
    return replace(comparison, pairs=pairs, shapes=evidence, unpaired_measured=None, unpaired_model=None)


def _named(pair: ShapePair, model: FloatArray, measured: FloatArray, strengths: Dominance | None) -> ModePair:
    return ModePair(
        measured=float(measured[pair.measured]),
        model=float(model[pair.model]),
        measured_mode=pair.measured + 1,
        mode=pair.model + 1,
        strength=None if strengths is None else float(strengths.acceleration[pair.model]),
        mac=pair.mac,
        confidence=pair.confidence,
        close_modes=tuple(other + 1 for other in pair.close_model),
        mixed=pair.mixed,
    )


def _evidence(
    model: FloatArray,
    phi: ShapeArray,
    measured: FloatArray,
    psi: ShapeArray,
    pairs: Sequence[ShapePair],
    rule: PairingRule,
    band: tuple[float, float],
) -> ShapeCorrelation:
    within = np.flatnonzero((model >= band[0]) & (model <= band[1]))
    auto_model, auto_measured = auto_mac(phi), auto_mac(psi)
    paired_model, paired_measured = {pair.model for pair in pairs}, {pair.measured for pair in pairs}
    between = np.flatnonzero((model >= measured[0]) & (model <= measured[-1]))
    crossed, outside, refused = _orthogonality(phi[within], psi)
    nearest, partners = _partners(phi, psi, pairs)
    return ShapeCorrelation(
        model_frequencies=model,
        measured_frequencies=measured,
        mac=modal_assurance_criterion(phi, psi),
        model_auto_mac=auto_model,
        measured_auto_mac=auto_measured,
        unpaired_measured=tuple(j + 1 for j in range(len(psi)) if j not in paired_measured),
        unpaired_model=tuple(int(i) + 1 for i in between if int(i) not in paired_model),
        measured_look_alikes=_look_alikes(auto_measured, measured, np.arange(len(psi)), rule.duplicate_mac),
        model_look_alikes=_look_alikes(auto_model, model, within, rule.duplicate_mac),
        close=_close(phi, psi, pairs),
        comac=comac(nearest, partners) if pairs else None,
        enhanced_comac=enhanced_comac(nearest, partners) if pairs else None,
        collinearity=phase_collinearity(psi),
        cross_orthogonality=crossed,
        orthogonality_modes=tuple(int(i) + 1 for i in within),
        outside=outside,
        no_orthogonality=refused,
    )


def _look_alikes(
    auto: FloatArray, frequencies: FloatArray, which: npt.NDArray[np.int64], least: float
) -> tuple[LookAlikes, ...]:
    look_alikes = []
    for place, i in enumerate(which):
        for j in which[place + 1 :]:
            if auto[i, j] >= least:
                near = bool(frequencies[j] - frequencies[i] <= _ONE_FREQUENCY * frequencies[j])
                look_alikes.append(LookAlikes(int(i) + 1, int(j) + 1, float(auto[i, j]), near))
    return tuple(look_alikes)


def _close(phi: ShapeArray, psi: ShapeArray, pairs: Sequence[ShapePair]) -> tuple[CloseModes, ...]:
    """Each group of close modes, of the model or of the test, with its partners, and the angle between both spaces."""
    close_groups: dict[tuple[tuple[int, ...], tuple[int, ...]], CloseModes] = {}
    for pair in pairs:
        mates = [mate for mate in pairs if _together(pair, mate)]
        model = tuple(sorted({pair.model, *pair.close_model, *(mate.model for mate in mates)}))
        measured = tuple(sorted({pair.measured, *(mate.measured for mate in mates)}))
        if len(model) > 1 and (model, measured) not in close_groups:
            seen = ~np.isnan(psi[list(measured)]).any(axis=0)
            is_known = seen.sum() > max(len(model), len(measured))
            angle = float(principal_angles(phi[list(model)], psi[list(measured)])[0]) if is_known else float("nan")
            numbers = tuple(i + 1 for i in model), tuple(j + 1 for j in measured)
            close_groups[model, measured] = CloseModes(*numbers, angle)
    return tuple(close_groups.values())


def _together(pair: ShapePair, other: ShapePair) -> bool:
    return other.model in pair.close_model or other.measured in pair.close_measured


def _partners(phi: ShapeArray, psi: ShapeArray, pairs: Sequence[ShapePair]) -> tuple[ComplexArray, ComplexArray]:
    """Shapes of the pairs, row by row; close modes of the model combined as they are nearest to the test's."""
    model = np.empty((len(pairs), phi.shape[1]), dtype=np.complex128)
    measured = np.empty_like(model)
    for row, pair in enumerate(pairs):
        model[row], measured[row] = phi[pair.model], psi[pair.measured]
        if pair.close_model:
            model[row] = nearest_in_span(phi[list(pair.close_model)], psi[pair.measured])[0]
    return model, measured


def _orthogonality(phi: ShapeArray, psi: ShapeArray) -> tuple[FloatArray | None, FloatArray | None, str]:
    if len(phi) == 0:
        return None, None, "the model has no mode in the band"
    try:
        return cross_orthogonality(phi, psi), outside_span(phi, psi), ""
    except HousingError as error:  # a fault of the survey: the pairs stand without the check
        return None, None, str(error)
