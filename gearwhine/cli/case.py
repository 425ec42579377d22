"""Commands on a case as a whole: run, check, examples, report, export."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from gearwhine.cli.common import NONE_GIVEN, CaseName, Common, FreshRun, hand_over, on_case, results_folder, written

if TYPE_CHECKING:
    from gearwhine.case import Case
    from gearwhine.progress import Progress


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

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        return run_into(given, folder, fresh=fresh, pictures=pictures, progress=progress).document

    on_case(case, common, work, shown_by(sections, timed=True))


def check(case: CaseName, *, common: Common = NONE_GIVEN) -> None:
    """Check the case and show speeds, mesh frequencies, torques and sizes; solve nothing."""
    from gearwhine.analyses import case as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.check import sections

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        return written(analyses.check(given, progress=progress), common.output, progress)

    on_case(case, common, work, shown_by(sections))


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


def report(
    case: CaseName,
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
    """Write the results in OUT (default: ./<case>-results) as one HTML page without scripts, report.html."""
    from gearwhine.analyses.case import report_case
    from gearwhine.output.terminal import shown_by

    on_case(
        case,
        common,
        lambda given, progress: report_case(
            given, results_folder(case, common), interactive=interactive, progress=progress
        ),
        shown_by(lambda document: ()),
    )


def export(
    case: CaseName,
    *,
    csv: Annotated[bool, Parameter(name=["--csv"], negative=(), help="The report's tables, one file each.")] = False,
    uff: Annotated[
        bool,
        Parameter(
            name=["--uff"], negative=(), help="Histories, spectra and transmissibilities as universal files (58)."
        ),
    ] = False,
    wav: Annotated[
        bool, Parameter(name=["--wav"], negative=(), help="The sensors' acceleration as sound, with its full scale.")
    ] = False,
    all_signals: Annotated[
        bool,
        Parameter(name=["--all-signals"], negative=(), help="With --uff: forces and motions of the machine, too."),
    ] = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Write the results in OUT (default: ./<case>-results) in formats of other programs, into OUT/exports.

    Without --csv, --uff or --wav all three are written.
    """
    from gearwhine.analyses.case import Format, export_case, export_sections
    from gearwhine.output.terminal import shown_by

    asked: dict[Format, bool] = {"csv": csv, "uff": uff, "wav": wav}
    formats = [name for name, wanted in asked.items() if wanted] or list(asked)

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        return export_case(given, folder, formats, signals="all" if all_signals else "sensors")

    on_case(case, common, work, shown_by(export_sections))
