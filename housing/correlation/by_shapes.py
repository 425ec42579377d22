"""Comparison by shapes: pairing of measured and model shapes, with all correlation criteria."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from housing.correlation.assurance import auto_mac, modal_assurance_criterion
from housing.correlation.comparison import Comparison, ModePair
from housing.correlation.complexity import phase_collinearity
from housing.correlation.coordinates import comac, enhanced_comac
from housing.correlation.evidence import CloseModes, LookAlikes, ShapeCorrelation
from housing.correlation.orthogonality import cross_orthogonality, outside_span
from housing.correlation.pairing import PairingRule, ShapePair, pair_modes
from housing.correlation.shape_sets import ComplexArray, ShapeArray, two_sets
from housing.correlation.subspaces import nearest_in_span, principal_angles
from housing.dominance import Dominance
from housing.errors import HousingError
from housing.measured import MeasuredModes

FloatArray = npt.NDArray[np.float64]

_ONE_FREQUENCY = 0.02  # parts of it by which two estimates of one mode may scatter


def compare_by_shapes(
    frequencies: FloatArray,
    shapes: npt.ArrayLike,
    measured: MeasuredModes,
    *,
    rule: PairingRule | None = None,
    strengths: Dominance | None = None,
) -> Comparison:
    """Pair measured modes with the model's by their shapes; see :mod:`housing.correlation.pairing`.

    Parameters
    ----------
    frequencies : ndarray, shape (n_modes,)
        Of the model, ascending [rad/s].
    shapes : array_like, shape (n_modes, n_dofs)
        The model's mass-normalised shapes at the measured degrees of freedom [1/√kg].
    measured : MeasuredModes
        With shapes.
    rule : PairingRule, optional
    strengths : Dominance, optional
        Of the model's modes, to stand beside each pair.

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
        pairing=f"MAC and frequency, best assignment, MAC at least {rule.least_mac:g}",
        band=band,
        shapes=_evidence(frequencies, phi, measured.frequencies, psi, pairs, rule, band),
    )


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
    found = []
    for place, i in enumerate(which):
        for j in which[place + 1 :]:
            if auto[i, j] >= least:
                near = bool(frequencies[j] - frequencies[i] <= _ONE_FREQUENCY * frequencies[j])
                found.append(LookAlikes(int(i) + 1, int(j) + 1, float(auto[i, j]), near))
    return tuple(found)


def _close(phi: ShapeArray, psi: ShapeArray, pairs: Sequence[ShapePair]) -> tuple[CloseModes, ...]:
    """Each group of close modes, of the model or of the test, with its partners, and the angle between both spaces."""
    found: dict[tuple[tuple[int, ...], tuple[int, ...]], CloseModes] = {}
    for pair in pairs:
        mates = [mate for mate in pairs if _together(pair, mate)]
        model = tuple(sorted({pair.model, *pair.close_model, *(mate.model for mate in mates)}))
        measured = tuple(sorted({pair.measured, *(mate.measured for mate in mates)}))
        if len(model) > 1 and (model, measured) not in found:
            seen = ~np.isnan(psi[list(measured)]).any(axis=0)
            known = seen.sum() > max(len(model), len(measured))
            angle = float(principal_angles(phi[list(model)], psi[list(measured)])[0]) if known else float("nan")
            numbers = tuple(i + 1 for i in model), tuple(j + 1 for j in measured)
            found[model, measured] = CloseModes(*numbers, angle)
    return tuple(found.values())


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
    except HousingError as error:  # of the survey: the pairs stand without it
        return None, None, str(error)
