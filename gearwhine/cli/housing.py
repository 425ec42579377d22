"""Commands on the housing: its mesh, its modes, and what was measured of it."""

from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter
from cyclopts.validators import Number

from gearwhine.cli.on_case import on_case, results_folder, written
from gearwhine.cli.options import NONE_GIVEN, CaseName, Common, Fresh

if TYPE_CHECKING:
    from gearwhine.case import Case
    from gearwhine.progress import Progress


def mesh(
    case: CaseName,
    *,
    format: Annotated[  # noqa: A002 - the name of the option
        Literal["msh", "vtu", "vtk", "inp", "med", "xdmf"], Parameter(help="Format of the mesh file.")
    ] = "msh",
    common: Common = NONE_GIVEN,
) -> None:
    """Mesh the housing and write the mesh file to OUT (default: ./<case>-results)."""
    from gearwhine.analyses import housing as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.mesh import sections

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        return written(analyses.mesh(given, suffix=format, progress=progress), folder, progress)

    on_case(case, common, work, shown_by(sections))


def modes(
    case: CaseName,
    *,
    detail: Annotated[
        bool,
        Parameter(
            name=["--detail"],
            negative=(),
            help="Also effective masses, what each support holds, and which modes carry the bearings' forces.",
        ),
    ] = False,
    fresh: Fresh = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Housing modes, proved complete, with a report on the model's health."""
    from gearwhine.analyses import housing as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.housing import detailed_sections, sections

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        found = analyses.modes(given, detail=detail, folder=common.output, fresh=fresh, progress=progress)
        return written(found, common.output, progress)

    on_case(case, common, work, shown_by(detailed_sections if detail else sections))


def compare(case: CaseName, *, fresh: Fresh = False, common: Common = NONE_GIVEN) -> None:
    """Model modes of the housing against measured ones."""
    from gearwhine.analyses import housing as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.comparison import sections

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        found = analyses.compare(given, folder=common.output, fresh=fresh, progress=progress)
        return written(found, common.output, progress)

    on_case(case, common, work, shown_by(sections))


def survey(
    case: CaseName,
    *,
    sensors: Annotated[
        int, Parameter(help="How many sensors, each along the surface's normal.", validator=Number(gte=1))
    ],
    modes: Annotated[
        int | None, Parameter(help="For how many of the lowest modes (default: all known).", validator=Number(gte=1))
    ] = None,
    fresh: Fresh = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Where to put sensors and the hammer for a modal survey, as files in OUT (default: ./<case>-results)."""
    from gearwhine.analyses import housing as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.survey import sections

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        found = analyses.survey(given, sensors=sensors, modes=modes, folder=folder, fresh=fresh, progress=progress)
        return written(found, folder, progress)

    on_case(case, common, work, shown_by(sections))


def update(
    case: CaseName,
    *,
    null: Annotated[
        int,
        Parameter(
            help="Also fit so many random sets of frequencies: how often the fit would be as good of nothing.",
            validator=Number(gte=0),
        ),
    ] = 0,
    held_back: Annotated[
        bool,
        Parameter(
            name=["--held-back"], negative=(), help="Also fit without each measured mode in turn, and predict that one."
        ),
    ] = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Fit the numbers of [update] to the measured modes; writes updated.toml to OUT (default: ./<case>-results)."""
    from gearwhine.analyses import housing as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.update import sections

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        return written(analyses.update(given, null=null, held_back=held_back, progress=progress), folder, progress)

    on_case(case, common, work, shown_by(sections))


def render(
    case: CaseName,
    *,
    modes: Annotated[
        str | None,
        Parameter(
            help="Which modes: 'dominant' (unless a line or --measured is asked for), 'all', or '1,4,9' or '1-6'."
        ),
    ] = None,
    line: Annotated[
        list[float],
        Parameter(
            name=["--line"],
            negative=(),
            consume_multiple=False,
            help="How the housing moves at the line nearest to a frequency [Hz] of the run in OUT. May be repeated.",
        ),
    ] = [],  # noqa: B006 - read only
    measured: Annotated[
        bool, Parameter(name=["--measured"], negative=(), help="Measured shapes beside the model's, at their points.")
    ] = False,
    view: Annotated[
        Literal["iso", "front", "back", "left", "right", "top"], Parameter(help="From where to look.")
    ] = "iso",
    format: Annotated[  # noqa: A002 - the name of the option
        Literal["png", "glb", "gif", "mp4"],
        Parameter(help="Pictures; glTF models that move in any 3D viewer; or films, MP4 where ffmpeg is installed."),
    ] = "png",
    fresh: Fresh = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Shapes of modes, of a run's lines, or measured: pictures, films, models in OUT (default: ./<case>-results)."""
    from gearwhine.analyses import housing as analyses
    from gearwhine.output.terminal import show_files

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        found = analyses.render(
            given,
            modes,
            view=view,
            mode_format=format,
            lines=line,
            measured=measured,
            folder=folder,
            fresh=fresh,
            progress=progress,
        )
        return written(found, folder, progress)

    on_case(case, common, work, show_files)
