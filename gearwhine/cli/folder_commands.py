"""Commands on bundled cases and on results folders: examples, report, export."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from gearwhine.cli.common import NONE_GIVEN, Common, hand_over, on_case, results_folder

if TYPE_CHECKING:
    from gearwhine.case import LoadedCase
    from gearwhine.numerics.progress import Progress
    from gearwhine.output.sections import Document, Section


def examples(
    action: Annotated[Literal["list", "copy"], Parameter(help="List the cases, or copy one.")] = "list",
    name: Annotated[str | None, Parameter(help="Name of the bundled case to copy.")] = None,
    *,
    common: Common = NONE_GIVEN,
) -> None:
    """List the bundled cases, or copy one here (or to OUT) to change it: examples copy NAME."""
    from gearwhine.output.terminal import show_files, shown_by

    if action == "list":
        hand_over(_list_examples(), common, shown_by(_example_sections))
    else:
        hand_over(_copy_example(name, common.output or Path()), common, show_files)


def _list_examples() -> dict[str, Any]:
    """Return the names and titles of the bundled cases."""
    from gearwhine.case import bundled_cases

    return {"examples": [{"name": name, "title": title} for name, title in bundled_cases().items()], "warnings": []}


def _example_sections(document: "Document") -> "tuple[Section, ...]":
    """Return the bundled cases as a table."""
    from gearwhine.output.sections import Column, Section, table_of

    columns = (Column("name", "name"), Column("what it is", "title"))
    usage = ("Run one:   gearwhine run NAME", "Change one: gearwhine examples copy NAME")
    return (Section("", (*table_of(columns, document["examples"]), *usage)),)


def _copy_example(name: str | None, folder: Path) -> dict[str, Any]:
    """Copy a bundled case into a folder, with the files that it reads; none of their names may stand there yet."""
    from gearwhine.case import CaseError, Problem, bundled_cases, bundled_files
    from gearwhine.output import staging

    names = ", ".join(bundled_cases())
    sources = bundled_files(name) if name is not None else ()
    if not sources:
        raise CaseError([Problem("examples copy", name, f"one of: {names}")])
    existing = [str(folder / source.name) for source in sources if (folder / source.name).exists()]
    if existing:
        expected = "a place where no file of that name stands yet"
        raise CaseError([Problem("examples copy", target, expected) for target in existing])
    with staging(folder, listed=False) as place:  # the copies are the user's
        for source in sources:
            (place / source.name).write_bytes(source.read_bytes())
    return {"folder": str(folder), "files": [source.name for source in sources], "warnings": []}


_Results = Annotated[str, Parameter(help="A results folder; or a case, for its OUT.")]


def report(
    results: _Results,
    *,
    interactive: Annotated[
        bool,
        Parameter(
            negative=(), help="Write report-interactive.html: shapes move, curves can be zoomed and tables sorted."
        ),
    ] = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Write all results in a folder as one HTML page without scripts, report.html: of a folder, or of a case's OUT.

    OUT is ./<case>-results by default. Results that do not fit the case, or that of the newest result, are marked.
    """
    from gearwhine.output.terminal import shown_by
    from gearwhine.results_folder import write_report

    def work(folder: Path, loaded: "LoadedCase | None", progress: "Progress") -> dict[str, Any]:
        return write_report(folder, None if loaded is None else loaded.case, interactive=interactive, progress=progress)

    _on_results(results, common, work, shown_by(lambda document: ()))


def _on_results(
    results: str,
    common: Common,
    work: Callable[[Path, "LoadedCase | None", "Progress"], dict[str, Any]],
    show: Callable[[dict[str, Any]], None],
) -> None:
    """Do work on a results folder, or on that of a case, and hand its document over."""
    from gearwhine.case import CaseError, Problem
    from gearwhine.case.load import bundled_names
    from gearwhine.numerics.names import did_you_mean
    from gearwhine.output.terminal import say_warning
    from gearwhine.progress import shown

    if not Path(results).exists() and results not in (names := bundled_names()):
        expected = f"a folder of results, or a case that has one; there is none here{did_you_mean(results, names)}"
        raise CaseError([Problem("RESULTS", results, expected)])
    if not Path(results).is_dir():
        on_case(
            results,
            common,
            lambda loaded, progress: work(results_folder(results, common), loaded, progress),
            show,
            "report",
        )
        return
    if common.output is not None:
        raise CaseError([Problem("--output", str(common.output), f"none beside the results folder {results!r}")])
    if common.settings:
        raise CaseError([Problem("--set", common.settings[0], f"none beside the results folder {results!r}")])
    with shown(quiet=common.quiet) as progress:
        document = work(Path(results), None, progress)
    for warning in document["warnings"]:
        say_warning(warning["message"])
    hand_over(document, common, show)


def export(
    results: _Results,
    *,
    csv: Annotated[bool, Parameter(negative=(), help="The report's tables, one file each.")] = False,
    uff: Annotated[
        bool,
        Parameter(negative=(), help="Histories, spectra and transmissibilities as universal files (58)."),
    ] = False,
    wav: Annotated[
        bool,
        Parameter(
            negative=(),
            help="Accelerations of sensors and sound pressures of microphones as sound, with their full scale.",
        ),
    ] = False,
    seconds: Annotated[
        float | None,
        Parameter(
            help="With --wav: least length of a steady record, which is repeated without a seam; 0 for one period. "
            "Default: 5. A run-up is as long as it is."
        ),
    ] = None,
    all_signals: Annotated[
        bool,
        Parameter(negative=(), help="With --uff: forces and motions of the machine, too."),
    ] = False,
    rexs: Annotated[
        Path | None,
        Parameter(
            help="The case's gear unit as this REXS file (.rexs), with the operating point that `load` left in OUT."
        ),
    ] = None,
    reduced: Annotated[
        Path | None,
        Parameter(
            help="The case's housing as reduced matrices (.npz, .nc, .pch, .op4, .mtx), with a case's tables for them."
        ),
    ] = None,
    common: Common = NONE_GIVEN,
) -> None:
    """Write the results in a folder in formats of other programs: of a folder, or of a case's OUT.

    OUT is ./<case>-results by default; the files go to OUT/exports. Without --csv, --uff or --wav all are written.
    With --rexs it is the gear unit of the case that is written, with --reduced its housing at seats and sensors; no
    results are needed.
    """
    from gearwhine.case import CaseError, Problem
    from gearwhine.output.terminal import shown_by
    from gearwhine.results_folder import Format, export_results, export_sections

    for option, target, write in (("--rexs", rexs, _export_rexs), ("--reduced", reduced, _export_reduced)):
        if target is None:
            continue
        if csv or uff or wav or (rexs is not None and reduced is not None):
            raise CaseError([Problem(option, str(target), "no other format beside it")])
        write(results, target, common)
        return
    if common.settings:
        expected = "none: results are exported as they are, of the case that they were solved with"
        raise CaseError([Problem("--set", common.settings[0], expected)])
    requested: dict[Format, bool] = {"csv": csv, "uff": uff, "wav": wav}
    formats = [name for name, is_requested in requested.items() if is_requested] or list(requested)

    def work(folder: Path, loaded: "LoadedCase | None", progress: "Progress") -> dict[str, Any]:
        return export_results(folder, formats, signals="all" if all_signals else "sensors", seconds=seconds)

    _on_results(results, common, work, shown_by(export_sections))


def _export_reduced(results: str, target: Path, common: Common) -> None:
    from gearwhine.case import CaseError, Problem
    from gearwhine.case_study import CaseStudy
    from gearwhine.output.terminal import shown_by
    from gearwhine.results_folder import reduced_sections

    def work(folder: Path, loaded: "LoadedCase | None", progress: "Progress") -> dict[str, Any]:
        if loaded is None:
            expected = "a case, whose housing's modes are taken from its folder where they are there"
            raise CaseError([Problem("export --reduced", str(folder), expected)])
        study = CaseStudy(loaded, progress, folder=folder if folder.is_dir() else None)
        return study.export_reduced(target)

    _on_results(results, common, work, shown_by(reduced_sections))


def _export_rexs(results: str, target: Path, common: Common) -> None:
    from gearwhine.output.terminal import shown_by
    from gearwhine.results_folder import case_in, export_rexs, rexs_sections

    def work(folder: Path, loaded: "LoadedCase | None", progress: "Progress") -> dict[str, Any]:
        return export_rexs(case_in(folder) if loaded is None else loaded.case, target, folder)

    _on_results(results, common, work, shown_by(rexs_sections))
