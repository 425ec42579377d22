"""Commands on a case as a whole: run, check, examples, report."""

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
    case: Annotated[str, Parameter(help="A results folder; or a case, whose changes since its results are named.")],
    *,
    common: Common = NONE_GIVEN,
) -> None:
    """Write all results in a folder as one HTML page, report.html: of a folder, or of a case's OUT.

    OUT is ./<case>-results by default.
    """
    from gearwhine.analyses.case import report_case, report_folder
    from gearwhine.output.terminal import show_files, shown_by

    if Path(case).is_dir():
        hand_over(report_folder(Path(case), other=common.output), common, show_files)
        return
    on_case(
        case,
        common,
        lambda given, progress: report_case(given, results_folder(case, common)),
        shown_by(lambda document: ()),
    )
