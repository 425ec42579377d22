"""Correlation of model and measured modes: assurance criteria, orthogonality, pairing of modes, comparison.

Shapes are rows, degrees of freedom columns; NaN where not measured; complex where measured so.

- :func:`modal_assurance_criterion` (MAC), :func:`auto_mac`, :func:`pole_weighted_mac`, :func:`modal_scale_factor` --
  likeness of two shapes.
- :func:`comac`, :func:`enhanced_comac` -- coordinate criteria: difference of paired shapes at each degree of freedom.
- :func:`cross_orthogonality`, :func:`self_orthogonality`, :func:`modal_coordinates`, :func:`outside_span`,
  :func:`serep_mass` -- likeness weighted by the model's mass, reduced to the survey.
- :func:`phase_collinearity`, :func:`complexity_factor`, :func:`mean_phase`, :func:`phase_deviation`,
  :func:`real_shapes` -- complexity of a shape, and the real shape nearest to it.
- :func:`close_modes`, :func:`span_mac`, :func:`nearest_in_span`, :func:`principal_angles` -- close modes as spaces.
- :func:`pair_modes` by a :class:`PairingRule` -- pairs of measured and model modes.
- :func:`compare_by_shapes`, :func:`compare_by_dominance` -- a :class:`Comparison` of model and measured modes.
- :func:`frac`, :func:`fdac`, :func:`response_vector_assurance`, :func:`amplitude_correlation`,
  :func:`synthesised_responses` -- likeness of frequency responses.
"""

from housing.correlation.assurance import (
    auto_mac,
    largest_off_diagonal,
    modal_assurance_criterion,
    modal_scale_factor,
    pole_weighted_mac,
)
from housing.correlation.by_dominance import compare_by_dominance, dominance_band
from housing.correlation.by_shapes import compare_by_shapes
from housing.correlation.comparison import Comparison, ModePair
from housing.correlation.complexity import (
    complexity_factor,
    mean_phase,
    phase_collinearity,
    phase_deviation,
    real_shapes,
)
from housing.correlation.coordinates import comac, enhanced_comac
from housing.correlation.evidence import CloseModes, LookAlikes, ShapeCorrelation
from housing.correlation.orthogonality import (
    cross_orthogonality,
    modal_coordinates,
    outside_span,
    self_orthogonality,
    serep_mass,
)
from housing.correlation.pairing import PairingRule, ShapePair, pair_modes
from housing.correlation.responses import (
    amplitude_correlation,
    fdac,
    frac,
    response_vector_assurance,
    synthesised_responses,
)
from housing.correlation.subspaces import close_modes, nearest_in_span, principal_angles, span_mac

__all__ = [
    "CloseModes",
    "Comparison",
    "LookAlikes",
    "ModePair",
    "PairingRule",
    "ShapeCorrelation",
    "ShapePair",
    "amplitude_correlation",
    "auto_mac",
    "close_modes",
    "comac",
    "compare_by_dominance",
    "compare_by_shapes",
    "complexity_factor",
    "cross_orthogonality",
    "dominance_band",
    "enhanced_comac",
    "fdac",
    "frac",
    "largest_off_diagonal",
    "mean_phase",
    "modal_assurance_criterion",
    "modal_coordinates",
    "modal_scale_factor",
    "nearest_in_span",
    "outside_span",
    "pair_modes",
    "phase_collinearity",
    "phase_deviation",
    "pole_weighted_mac",
    "principal_angles",
    "real_shapes",
    "response_vector_assurance",
    "self_orthogonality",
    "serep_mass",
    "span_mac",
    "synthesised_responses",
]
