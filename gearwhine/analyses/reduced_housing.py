"""Analyses of a housing of reduced matrices: its natural modes, and these beside measured ones."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.analyses.origin import Origin
from gearwhine.analyses.result import Result
from gearwhine.housing.correlation.comparison import Comparison
from gearwhine.housing.measured import MeasuredModes
from gearwhine.housing.modal_test import ComparedTest, comparison_warnings
from gearwhine.housing.reduced import ReducedHousing
from gearwhine.numerics.progress import Progress
from gearwhine.numerics.result_warnings import warning
from gearwhine.output.dataset import LabelledArrays, arrays_of, file_attributes, labelled
from gearwhine.output.quantity import add_warnings
from gearwhine.results.comparison import COMPARISON, comparison_document, responses_document, write_comparison
from gearwhine.results.modes import REDUCED_MODES, reduced_modes_document

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def reduced_modes_result(housing: ReducedHousing, origin: Origin) -> Result[ReducedHousing]:
    """Return the result of the natural modes of a reduced housing."""
    document = reduced_modes_document(housing)
    add_warnings(document, housing.warnings)
    return Result(
        "modes",
        origin.case,
        housing,
        document,
        _arrays=lambda: labelled(origin.labels, (REDUCED_MODES, housing)),
        _title=origin.title,
    )


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

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        write_comparison(place, comparison, kept.geometry)
        return {}

    def figures(progress: Progress) -> "Iterator[tuple[str, Figure]]":
        from gearwhine.figures import draw_comparison_figures

        known = housing.modes.frequencies[: housing.modes.known]
        return draw_comparison_figures(origin.title, comparison, known, kept.geometry)

    return Result(
        "compare",
        origin.case,
        comparison,
        document,
        _arrays=lambda: LabelledArrays(arrays_of(COMPARISON, comparison), {}, file_attributes(origin.labels)),
        _figures=figures,
        _files=files,
        _data_file="comparison.nc",
        _title=origin.title,
    )
