"""Correlation of model and measured modes: assurance criteria, orthogonality, pairing of modes, comparison.

Shapes are rows, degrees of freedom columns; NaN where not measured; complex where measured so.

- :func:`modal_assurance_criterion` (MAC), :func:`auto_mac`, :func:`modal_scale_factor` -- likeness of two shapes.
- :func:`comac`, :func:`enhanced_comac` -- coordinate criteria: difference of paired shapes at each degree of freedom.
- :func:`cross_orthogonality`, :func:`outside_span` -- likeness weighted by the model's mass, reduced to the survey.
- :func:`phase_collinearity`, :func:`real_shapes` -- complexity of a shape, and the real shape nearest to it.
- :func:`span_mac`, :func:`principal_angles` -- close modes as spaces.
- :func:`pair_modes` by a :class:`PairingRule` -- pairs of measured and model modes.
- :func:`compare_by_shapes`, :func:`compare_by_dominance`, :func:`compare_by_frequency` -- a :class:`Comparison` of
  model and measured modes.
- :func:`frac`, :func:`synthesised_responses` -- likeness of frequency responses.
"""

from gearwhine.housing.correlation.comparison import Comparison as Comparison
from gearwhine.housing.correlation.comparison import LookAlikes as LookAlikes
from gearwhine.housing.correlation.comparison import ModePair as ModePair
from gearwhine.housing.correlation.comparison import ShapeCorrelation as ShapeCorrelation
from gearwhine.housing.correlation.comparison import compare_by_dominance as compare_by_dominance
from gearwhine.housing.correlation.comparison import compare_by_frequency as compare_by_frequency
from gearwhine.housing.correlation.comparison import compare_by_shapes as compare_by_shapes
from gearwhine.housing.correlation.comparison import dominance_band as dominance_band
from gearwhine.housing.correlation.frequency_responses import frac as frac
from gearwhine.housing.correlation.frequency_responses import synthesised_responses as synthesised_responses
from gearwhine.housing.correlation.modal_assurance_criterion import auto_mac as auto_mac
from gearwhine.housing.correlation.modal_assurance_criterion import comac as comac
from gearwhine.housing.correlation.modal_assurance_criterion import enhanced_comac as enhanced_comac
from gearwhine.housing.correlation.modal_assurance_criterion import largest_off_diagonal as largest_off_diagonal
from gearwhine.housing.correlation.modal_assurance_criterion import (
    modal_assurance_criterion as modal_assurance_criterion,
)
from gearwhine.housing.correlation.modal_assurance_criterion import modal_scale_factor as modal_scale_factor
from gearwhine.housing.correlation.modal_assurance_criterion import phase_collinearity as phase_collinearity
from gearwhine.housing.correlation.modal_assurance_criterion import real_shapes as real_shapes
from gearwhine.housing.correlation.orthogonality import cross_orthogonality as cross_orthogonality
from gearwhine.housing.correlation.orthogonality import outside_span as outside_span
from gearwhine.housing.correlation.pairing import PairingRule as PairingRule
from gearwhine.housing.correlation.pairing import pair_modes as pair_modes
from gearwhine.housing.correlation.subspaces import principal_angles as principal_angles
from gearwhine.housing.correlation.subspaces import span_mac as span_mac
