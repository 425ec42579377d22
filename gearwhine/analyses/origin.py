"""Origin of a result: the case, in its solved housing, or the machine of Python that it is of."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

from gearwhine.analyses.result import Result, no_figures, no_files
from gearwhine.numerics.progress import Progress
from gearwhine.numerics.result_warnings import ResultWarning
from gearwhine.output.dataset import Labels, labelled, labels_of
from gearwhine.output.quantity import Fields, joined
from gearwhine.results.housing import HOUSING, origin_document

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from gearwhine.case import Case
    from gearwhine.housing import HousingModes
    from gearwhine.output.store import Option

Solved = TypeVar("Solved")


@dataclass(frozen=True)
class Origin:
    """What a result is of, and what that adds to its files and its document.

    Attributes
    ----------
    title : str
    speed : float or None
        Speed of the first driver [rad/s]; None where there is none.
    case : Case or None
        None where Python describes the machine.
    housing : HousingModes or None
        The solved housing of the case, which takes part in the result.
    warnings : sequence of ResultWarning
        Warnings of the inputs of Python; those of a case are given where it is read.
    """

    title: str
    speed: float | None = None
    case: Case | None = None
    housing: HousingModes | None = None
    warnings: Sequence[ResultWarning] = ()

    @property
    def labels(self) -> Labels:
        """Labels of the files."""
        return Labels(self.title, self.speed) if self.case is None else labels_of(self.case)

    def result(
        self,
        command: str,
        solved: Solved,
        document: dict[str, Any],
        *arrays: tuple[Fields, Any],
        figures: Callable[[Progress], Iterable[tuple[str, Figure]]] = no_figures,
        files: Callable[..., Mapping[str, Any]] = no_files,
        options: tuple[Sequence[Option], Sequence[str]] = ((), ()),
        data_file: str = "results.nc",
    ) -> Result[Solved]:
        """Return the result of an analysis.

        Parameters
        ----------
        command : str
            Name of the analysis.
        solved
            Its solution.
        document : dict
        *arrays : tuple
            Declarations of quantities, each with the object that they are of, for its file; without any it has none.
            Beside them stand those of the housing, in a file of the usual name.
        figures, files, options, data_file
            As the fields of :class:`gearwhine.analyses.result.Result`.
        """
        of_housing: tuple[tuple[Fields, Any], ...] = ((HOUSING, self.housing),)
        labels = self.labels
        if data_file != "results.nc":
            of_housing, labels = (), replace(labels, speed=None)
        return Result(
            command,
            self.case,
            solved,
            joined(document, origin_document(self.housing), {"warnings": self.warnings}),
            _arrays=(lambda: labelled(labels, *of_housing, *arrays)) if arrays else None,
            _figures=figures,
            _files=files,
            _housing=self.housing,
            _data_file=data_file,
            _options=options,
            _title=self.title,
        )

    def study_result(
        self,
        command: str,
        solved: Solved,
        document: dict[str, Any],
        arrays: Callable[[], xr.Dataset] | Fields,
        figures: Callable[[Progress], Iterable[tuple[str, Figure]]],
        begun: float,
        files: Callable[..., Mapping[str, Any]] = no_files,
        warnings: Sequence[ResultWarning] = (),
    ) -> Result[Solved]:
        """Return the result of a study of many solutions, whose data file has the name of the command.

        Parameters
        ----------
        command, solved, document, figures, files
            As of :meth:`result`.
        arrays : callable or tuple of Quantity, Part or Rows
            Returns the dataset; or the quantities of the solution, which are declared.
        begun : float
            Time of the performance counter at which the study began [s].
        warnings : sequence of ResultWarning
            Warnings beside those of the document and of the housing.
        """
        return Result(
            command,
            self.case,
            solved,
            joined(
                {"title": self.title} | document | {"seconds": {"total": time.perf_counter() - begun}},
                {"warnings": [*warnings, *self.warnings]},
                {"warnings": [] if self.housing is None else self.housing.result_warnings},
            ),
            _arrays=arrays
            if callable(arrays)
            else lambda: labelled(replace(self.labels, speed=None), (arrays, solved)),
            _figures=figures,
            _files=files,
            _housing=self.housing,
            _data_file=f"{command}.nc",
            _started=begun,
            _title=self.title,
        )
