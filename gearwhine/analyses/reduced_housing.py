"""Analyses of a housing of reduced matrices: its natural modes, and these beside measured ones."""

from typing import TYPE_CHECKING

from gearwhine.analyses.housing import comparison_result
from gearwhine.analyses.origin import Origin
from gearwhine.analyses.result import Result
from gearwhine.housing.correlation.comparison import Comparison
from gearwhine.housing.measured import MeasuredModes
from gearwhine.housing.modal_test import ComparedTest, comparison_warnings
from gearwhine.housing.reduced import ReducedHousing
from gearwhine.numerics.result_warnings import warning
from gearwhine.output.quantity import add_warnings
from gearwhine.results.comparison import comparison_document, responses_document
from gearwhine.results.modes import REDUCED_MODES, reduced_modes_document

if TYPE_CHECKING:
    pass


def reduced_modes_result(housing: ReducedHousing, origin: Origin) -> Result[ReducedHousing]:
    """Return the result of the natural modes of a reduced housing."""
    document = reduced_modes_document(housing)
    add_warnings(document, housing.result_warnings)
    return origin.result("modes", housing, document, (REDUCED_MODES, housing))


def reduced_compare_result(
    housing: ReducedHousing, compared: ComparedTest, measured: MeasuredModes, origin: Origin
) -> Result[Comparison]:
    """Return the result of measured modes beside those of a reduced housing.

    Parameters
    ----------
    housing : ReducedHousing
    compared : ComparedTest
        Its test has the motions that were compared.
    measured : MeasuredModes
        All that were measured.
    origin : Origin
    """
    comparison, kept = compared.comparison, compared.test.modes
    document = comparison_document(comparison, housing)
    if compared.responses is not None:
        document["responses"] = responses_document(compared.responses)
    add_warnings(document, comparison_warnings(comparison, housing.modes, kept))
    if measured.geometry is not None and kept.geometry is not None:
        left_out = len(measured.geometry.points) - len(kept.geometry.points)
        if left_out:
            message = (
                f"{left_out} of {len(measured.geometry.points)} measured motions are left out: they are far from nodes "
                "of known place and from recovered points"
            )
            add_warnings(document, [warning("survey", message, left_out=left_out)])

    known = housing.modes.frequencies[: housing.modes.known]
    return comparison_result(origin, comparison, document, known, kept.geometry)
