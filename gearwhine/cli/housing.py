"""Commands on the housing: mesh, modes, compare, survey, update, render."""

from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter
from cyclopts.validators import Number

from gearwhine.cli.common import NONE_GIVEN, CaseName, Common, Fresh, on_case, results_folder, written
from gearwhine.view_names import View

if TYPE_CHECKING:
    from gearwhine.case import Case
    from gearwhine.numerics.progress import Progress


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

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        return written(analyses.mesh(loaded_case, suffix=format, progress=progress), folder, progress)

    on_case(case, common, work, shown_by(sections), "mesh", writes=(f"mesh.{format}", "mesh.h5"))


def modes(
    case: CaseName,
    *,
    detail: Annotated[
        bool,
        Parameter(
            name=["--detail"],
            negative=(),
            help="Also show effective masses, support reactions, and the modes dominant between bearings and sensors.",
        ),
    ] = False,
    fresh: Fresh = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Natural modes of the housing, certified complete, with checks of the model."""
    from gearwhine.analyses import housing as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.housing import detailed_sections, sections

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        result = analyses.modes(loaded_case, detail=detail, folder=common.output, fresh=fresh, progress=progress)
        return written(result, common.output, progress)

    on_case(case, common, work, shown_by(detailed_sections if detail else sections), "modes")


def compare(case: CaseName, *, fresh: Fresh = False, common: Common = NONE_GIVEN) -> None:
    """Compare the housing's modes with measured ones: frequencies, MAC, frequency responses."""
    from gearwhine.analyses import housing as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.comparison import sections

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        result = analyses.compare(loaded_case, folder=common.output, fresh=fresh, progress=progress)
        return written(result, common.output, progress)

    on_case(case, common, work, shown_by(sections), "compare")


def survey(
    case: CaseName,
    *,
    sensors: Annotated[int, Parameter(help="Number of sensors, each normal to the surface.", validator=Number(gte=1))],
    modes: Annotated[
        int | None, Parameter(help="Number of lowest modes to survey (default: all known).", validator=Number(gte=1))
    ] = None,
    fresh: Fresh = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Plan a modal survey: sensor and hammer positions, as files in OUT (default: ./<case>-results)."""
    from gearwhine.analyses import housing as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.survey import sections

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        result = analyses.survey(
            loaded_case, sensors=sensors, modes=modes, folder=folder, fresh=fresh, progress=progress
        )
        return written(result, folder, progress)

    on_case(case, common, work, shown_by(sections), "survey")


def update(
    case: CaseName,
    *,
    null: Annotated[
        int,
        Parameter(
            help="Number of random frequency sets to fit as well; their fits are the null hypothesis.",
            validator=Number(gte=0),
        ),
    ] = 0,
    held_back: Annotated[
        bool,
        Parameter(
            name=["--held-back"],
            negative=(),
            help="Also leave out each measured mode in turn and predict it.",
        ),
    ] = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Fit the parameters of [update] to the measured modes; write updated.toml to OUT (default: ./<case>-results)."""
    from gearwhine.analyses import housing as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.update import sections

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        return written(
            analyses.update(loaded_case, null=null, held_back=held_back, progress=progress), folder, progress
        )

    on_case(case, common, work, shown_by(sections), "update")


def render(
    case: CaseName,
    *,
    modes: Annotated[
        str | None,
        Parameter(help="Modes to draw: 'dominant' (default without --line and --measured), 'all', '1,4,9' or '1-6'."),
    ] = None,
    line: Annotated[
        list[float],
        Parameter(
            name=["--line"],
            negative=(),
            consume_multiple=False,
            help="Draw the operating shape at the line of the run in OUT nearest to a frequency [Hz]. May be repeated.",
        ),
    ] = [],  # noqa: B006 - read only
    measured: Annotated[
        bool, Parameter(name=["--measured"], negative=(), help="Draw measured shapes beside the model's.")
    ] = False,
    view: Annotated[
        View,
        Parameter(help="Direction of view; 'auto': for each shape the corner from which most of its motion is seen."),
    ] = "auto",
    format: Annotated[  # noqa: A002 - the name of the option
        Literal["png", "glb", "gif", "mp4"],
        Parameter(help="Picture, animated glTF model, or film (MP4 needs ffmpeg)."),
    ] = "png",
    fresh: Fresh = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Draw mode shapes, operating shapes or measured shapes into OUT (default: ./<case>-results)."""
    from gearwhine.analyses import housing as analyses
    from gearwhine.output.terminal import show_files

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        result = analyses.render(
            loaded_case,
            modes,
            view=view,
            mode_format=format,
            lines=line,
            measured=measured,
            folder=folder,
            fresh=fresh,
            progress=progress,
        )
        return written(result, folder, progress)

    on_case(case, common, work, show_files, "render")
