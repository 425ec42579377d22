"""Commands on a case as a whole: run, check, examples, report, export.

The physics of ``run``: :func:`gearwhine.analyses.run.run` solves housing, rotors and gear pairs in turn, the coupled
motion by :func:`gearwhine.coupling.analyses.transient.solve_transient`, which integrates in time with
:func:`gearwhine.coupling.time.transient.integrate_blocks`.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from gearwhine.cli.common import NONE_GIVEN, CaseName, Common, FreshRun, hand_over, on_case, results_folder, written

if TYPE_CHECKING:
    from gearwhine.case import Case
    from gearwhine.numerics.progress import Progress


def run(
    case: CaseName,
    *,
    fresh: FreshRun = False,
    pictures: Annotated[
        bool, Parameter(name=["--pictures"], help="Draw pictures; --no-pictures saves time and needs no renderer.")
    ] = True,
    common: Common = NONE_GIVEN,
) -> None:
    """Run all analyses of the case; results go to OUT (default: ./<case>-results).

    An interrupted run continues from its last checkpoint when the same case is run into OUT again.
    """
    from gearwhine.analyses.run import run_into
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.run import sections

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        return run_into(loaded_case, folder, fresh=fresh, pictures=pictures, progress=progress).document

    on_case(case, common, work, shown_by(sections, timed=True), "run")


def check(
    case: CaseName,
    *,
    verbose: Annotated[
        bool, Parameter(name=["--verbose", "-v"], negative=(), help="Show every part, with the origin of its values.")
    ] = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Check the case and show speeds, mesh frequencies, torques and sizes; solve nothing."""
    from gearwhine.analyses import case as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.check import sections, summary

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        return written(analyses.check(loaded_case, progress=progress), common.output, progress)

    on_case(case, common, work, shown_by(sections if verbose else summary), "check")


def examples(
    action: Annotated[Literal["list", "copy"], Parameter(help="List the cases, or copy one.")] = "list",
    name: Annotated[str | None, Parameter(help="Name of the bundled case to copy.")] = None,
    *,
    common: Common = NONE_GIVEN,
) -> None:
    """List the bundled cases, or copy one here (or to OUT) to change it: examples copy NAME."""
    from gearwhine.analyses.case import copy_example, list_examples, sections
    from gearwhine.output.terminal import show_files, shown_by

    if action == "list":
        hand_over(list_examples(), common, shown_by(sections))
    else:
        hand_over(copy_example(name, common.output or Path()), common, show_files)


_Results = Annotated[str, Parameter(help="A results folder; or a case, for its OUT.")]


def report(
    results: _Results,
    *,
    interactive: Annotated[
        bool,
        Parameter(
            name="--interactive",
            negative=(),
            help="Write report-interactive.html: shapes move, curves can be zoomed and tables sorted.",
        ),
    ] = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Write all results in a folder as one HTML page without scripts, report.html: of a folder, or of a case's OUT.

    OUT is ./<case>-results by default. Results that do not fit the case, or that of the newest result, are marked.
    """
    from gearwhine.analyses.case import write_report
    from gearwhine.output.terminal import shown_by

    def work(folder: Path, loaded_case: "Case | None", progress: "Progress") -> dict[str, Any]:
        return write_report(folder, loaded_case, interactive=interactive, progress=progress)

    _on_results(results, common, work, shown_by(lambda document: ()))


def _on_results(
    results: str,
    common: Common,
    work: Callable[[Path, "Case | None", "Progress"], dict[str, Any]],
    show: Callable[[dict[str, Any]], None],
) -> None:
    """Do work on a results folder, or on that of a case, and hand its document over."""
    from gearwhine.case import CaseError, Problem
    from gearwhine.progress import shown

    if not Path(results).is_dir():
        on_case(
            results,
            common,
            lambda loaded_case, progress: work(results_folder(results, common), loaded_case, progress),
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
        sys.stderr.write(f"warning: {warning['message']}\n")
    hand_over(document, common, show)


def export(
    results: _Results,
    *,
    csv: Annotated[bool, Parameter(name=["--csv"], negative=(), help="The report's tables, one file each.")] = False,
    uff: Annotated[
        bool,
        Parameter(
            name=["--uff"], negative=(), help="Histories, spectra and transmissibilities as universal files (58)."
        ),
    ] = False,
    wav: Annotated[
        bool,
        Parameter(
            name=["--wav"],
            negative=(),
            help="Accelerations of sensors and sound pressures of microphones as sound, with their full scale.",
        ),
    ] = False,
    seconds: Annotated[
        float | None,
        Parameter(
            name=["--seconds"],
            help="With --wav: least length of a steady record, which is repeated without a seam; 0 for one period. "
            "Default: 5. A run-up is as long as it is.",
        ),
    ] = None,
    all_signals: Annotated[
        bool,
        Parameter(name=["--all-signals"], negative=(), help="With --uff: forces and motions of the machine, too."),
    ] = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Write the results in a folder in formats of other programs: of a folder, or of a case's OUT.

    OUT is ./<case>-results by default; the files go to OUT/exports. Without --csv, --uff or --wav all are written.
    """
    from gearwhine.analyses.case import Format, export_results, export_sections
    from gearwhine.case import CaseError, Problem
    from gearwhine.output.terminal import shown_by

    if common.settings:
        expected = "none: results are exported as they are, of the case that they were solved with"
        raise CaseError([Problem("--set", common.settings[0], expected)])
    requested: dict[Format, bool] = {"csv": csv, "uff": uff, "wav": wav}
    formats = [name for name, is_requested in requested.items() if is_requested] or list(requested)

    def work(folder: Path, loaded_case: "Case | None", progress: "Progress") -> dict[str, Any]:
        return export_results(folder, formats, signals="all" if all_signals else "sensors", seconds=seconds)

    _on_results(results, common, work, shown_by(export_sections))
