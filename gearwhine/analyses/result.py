"""Result of an analysis: labelled data, proofs, figures, and the folder that it is written to."""

from __future__ import annotations

import copy
import shutil
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import wait
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Self, TypeVar

from gearwhine.case import Case
from gearwhine.case.checks.whole_case import warnings_of
from gearwhine.commands import COMMANDS
from gearwhine.failures import DamagedResultsError
from gearwhine.housing.storage.netcdf import Variables, write_netcdf
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.output import finite, json_text, staging
from gearwhine.output.files import finish_moves
from gearwhine.output.manifest import require_as_written
from gearwhine.output.quantity import add_warnings
from gearwhine.output.store import Kept, Option, earlier_result, kept_options, store_results

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from gearwhine.housing import HousingModes
    from gearwhine.output.dataset import LabelledArrays

# Lists of parts that are proved one by one; modes and lines of a spectrum have one proof together.
_LISTED = ("rotors", "pairs", "motions")

Solved = TypeVar("Solved")

_PROOFS = {
    "certificate",
    "complete",
    "energy_error",
    "health",
    "interior_pressure",
    "known_source_error",
    "known_source_rms",
    "max_residual",
    "power_balance_db",
    "residual",
    "static_error",
    "trusted_below_hz",
    "uncertainty",
}


def no_figures(progress: Progress) -> Iterable[tuple[str, Figure]]:
    """Draw no figures."""
    return ()


def no_files(place: Path, *, pictures: bool) -> Mapping[str, Any]:
    """Write nothing beside the data and the figures."""
    return {}


@dataclass(frozen=True, eq=False)
class Result(Generic[Solved]):
    """Result of an analysis of a case, or of a machine of Python.

    Attributes
    ----------
    command : str
        Name of the analysis.
    case : Case or None
        Case that is analysed; None for objects of Python.
    solved
        Objects of the library: solved housing, rotors, gear pairs, coupled modes, motion.
    document : dict
        Numbers and texts as the command prints them with ``--json``; units stand in the keys.

    Notes
    -----
    A result can be pickled, with all its arrays. One that comes back from a pickle draws no figures and pictures, and
    writes none.
    """

    command: str
    case: Case | None
    solved: Solved
    document: dict[str, Any]
    _arrays: Callable[[], LabelledArrays | xr.Dataset] | None = None
    _figures: Callable[[Progress], Iterable[tuple[str, Figure]]] = no_figures
    _files: Callable[..., Mapping[str, Any]] = no_files
    _housing: HousingModes | None = None
    _data_file: str = "results.nc"
    _started: float | None = None
    _options: tuple[Sequence[Option], Sequence[str]] = ((), ())
    _title: str = ""
    # Of a run, those that were not drawn beside its work.
    _figures_left: Callable[[Progress], Iterable[tuple[str, Figure]]] | None = None

    def __post_init__(self) -> None:
        """Take a copy of the document with its list of warnings, with those of the case."""
        of_case = () if self.case is None else warnings_of(self.case)
        document = dict(self.document)
        add_warnings(document, [warning("case", text) for text in of_case])
        object.__setattr__(self, "document", document)

    @property
    def title(self) -> str:
        """Title of the case or the machine."""
        return self._title if self.case is None else self.case.title

    def __getstate__(self) -> dict[str, Any]:
        """Return the fields for a pickle: the arrays themselves, in place of the functions that make and draw them."""
        state = {field.name: getattr(self, field.name) for field in fields(self)}
        arrays = None if self._arrays is None else partial(copy.copy, self.dataset)
        functions = {"_figures": no_figures, "_figures_left": None, "_files": no_files}
        return state | functions | {"_arrays": arrays, "_options": ((), ())}

    def __repr__(self) -> str:
        """Return the command, the case's title and the keys of the document."""
        return f"<Result of {self.command!r} on {self.title!r}: {', '.join(self.document)}>"

    def _repr_html_(self) -> str:
        from gearwhine.notebook import result_html

        return result_html(self.command, self.title, self.document)

    @cached_property
    def dataset(self) -> xr.Dataset:
        """Every quantity with its dimensions, unit and long name, as in the NetCDF file; changes of it stay in it."""
        if self._arrays is None:
            import xarray as xr

            return xr.Dataset(attrs={"title": self.title})
        from gearwhine.output.dataset import LabelledArrays

        arrays = self._arrays()
        return arrays.dataset() if isinstance(arrays, LabelledArrays) else arrays.copy(deep=True)

    @property
    def warnings(self) -> list[str]:
        """Warnings about the result, a sentence each."""
        return [str(entry["message"]) for entry in self.document["warnings"]]

    @property
    def proofs(self) -> dict[str, Any]:
        """Certificates, residuals and error estimates of the document, by their path in it."""
        return dict(_proofs(self.document, ""))

    def figures(self, progress: Progress = silent) -> Iterator[tuple[str, Figure]]:
        """Draw the figures of the analysis, one after the other, each with its name."""
        yield from self._figures(progress)

    def plot(self, name: str | None = None) -> Figure:
        """Draw one figure.

        Parameters
        ----------
        name : str, optional
            One of the names that :meth:`figures` yields, or the end of one alone, ``campbell`` of
            ``rotor-input-campbell``; the first one by default.

        Raises
        ------
        KeyError
            Where there is no figure of that name; the message lists those there are.
        """
        names, ending = [], []
        for figure_name, figure in self.figures():
            if name in (None, figure_name):
                return figure
            if figure_name.endswith(f"-{name}"):
                ending.append(figure)
            names.append(figure_name)
        if len(ending) == 1:
            return ending[0]
        listed = ", ".join(names) or "none"
        raise KeyError(f"no figure {name!r} of {self.command!r}; there are: {listed}")

    def json(self) -> str:
        """Return the document as JSON, as the command prints it with ``--json``."""
        return json_text(finite(self.document))

    def write(self, folder: str | Path, *, pictures: bool = True, progress: Progress = silent) -> list[str]:
        """Write data, document, case and figures into a folder, beside what other analyses left there.

        Parameters
        ----------
        folder : path
            Results folder, which is made where it does not exist.
        pictures : bool
            Whether to draw pictures.
        progress : callable
            Receives the next step in words.

        Returns
        -------
        list of str
            Files of the result, relative to the folder.

        Raises
        ------
        OSError
            Where the folder cannot be written to; what it held stays as it was.
        """
        return list(self.stored(folder, pictures=pictures, progress=progress).document["files"])

    def stored(self, folder: str | Path, *, pictures: bool = True, progress: Progress = silent) -> Self:
        """Write the result as :meth:`write`, and return it as it stands in the folder.

        Its document has the folder's name, the files, what the folder keeps of earlier results of the same command, and
        warnings of drawing.
        """
        begin = time.perf_counter()
        kept, document = Kept(), dict(self.document)
        options, same = self._options
        finish_moves(Path(folder))
        if self.case is not None and options and (earlier := earlier_result(Path(folder), self.command)) is not None:
            place = earlier[0].relative_to(folder)
            try:
                require_as_written(Path(folder), lambda name: Path(name).parent == place)
            except DamagedResultsError as error:
                text = f"{error}; the parts of those results that this one would keep are left out"
                add_warnings(document, [warning("results folder", text)])
            else:
                kept = kept_options(options, same, self.case, document, *earlier)
                document.update(kept.document)

        def write(place: Path) -> None:
            progress("writing results")
            for file in kept.files:
                shutil.copyfile(file, place / file.name)
            if pictures:
                added = self._write_and_draw(place, kept.variables, progress)
            else:
                self._write_data(place, kept.variables)
                added = dict(self._files(place, pictures=False))
            add_warnings(document, added.pop("warnings", ()))
            document.update(added)
            if self._started is not None:
                now = time.perf_counter()
                document["seconds"] = document["seconds"] | {"writing": now - begin, "total": now - self._started}

        def write_with_modes(place: Path) -> None:
            write(place)
            if self._housing is not None and self.case is not None:
                from gearwhine.solve.housing_modes import write_mode_cache

                write_mode_cache(place, self._housing)

        if self.command in COMMANDS:
            cached = self._housing is not None and self._housing.source is not None
            store_results(self.command, document, self.case, Path(folder), write_with_modes, modes_stored=cached)
        else:
            with staging(Path(folder)) as place:
                write(place)
                files = sorted(path.relative_to(place).as_posix() for path in place.rglob("*") if path.is_file())
            document.update(folder=str(folder), files=files)
        return replace(self, document=document)

    def _write_and_draw(self, place: Path, kept_arrays: Variables, progress: Progress) -> dict[str, Any]:
        """Write the data and draw the figures, while a process of its own draws the shapes among the further files.

        Returns what these add to the document.
        """
        if self._files is no_files:
            self._write_data(place, kept_arrays)
            self._draw_figures(place, progress)
            return {}
        from gearwhine.drawing_process import one_process

        with one_process() as drawing:
            files = drawing.beside(self._files, place, pictures=True)
            try:
                self._write_data(place, kept_arrays)
                self._draw_figures(place, progress)
                return dict(files.result())
            except BaseException:
                drawing.stop()
                wait([files])
                raise

    def _draw_figures(self, place: Path, progress: Progress) -> None:
        for name, figure in (self._figures_left or self.figures)(progress):
            # Loaded where there is a figure: matplotlib takes as long as the modes of a small housing.
            from gearwhine.figures.style import save

            save(figure, place / f"{name}.png")

    def _write_data(self, place: Path, kept_arrays: Variables) -> None:
        if self._arrays is None:
            return
        from gearwhine.output.dataset import LabelledArrays

        arrays = self._arrays()
        if isinstance(arrays, LabelledArrays):
            replace(arrays, variables={**arrays.variables, **kept_arrays}).write(place / self._data_file)
        else:
            variables, coordinates = (
                {str(name): (array.dims, array.values, dict(array.attrs)) for name, array in part.items()}
                for part in (arrays.data_vars, arrays.coords)
            )
            write_netcdf(place / self._data_file, variables, arrays.attrs, coordinates=coordinates)


def _proofs(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            inner_path = f"{path}.{key}" if path else str(key)
            if key in _PROOFS:
                yield inner_path, inner
            else:
                yield from _proofs(inner, inner_path)
    elif isinstance(value, list) and path in _LISTED:
        for number, inner in enumerate(value):
            yield from _proofs(inner, f"{path}[{number}]")
