"""Commands on rotors and gears, and on the machine that they make with the housing."""

from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from cyclopts.validators import Number

from gearwhine.cli.on_case import on_case, results_folder, written
from gearwhine.cli.options import NONE_GIVEN, CaseName, Common, Fresh

if TYPE_CHECKING:
    from gearwhine.case import Case
    from gearwhine.progress import Progress


def rotors(
    case: CaseName,
    *,
    write_ross: Annotated[
        bool,
        Parameter(
            name=["--write-ross"],
            negative=(),
            help="Also each rotor with its bearings as a file that ROSS loads, in OUT (default: ./<case>-results).",
        ),
    ] = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Each rotor's lateral and torsional modes, whirl and critical speeds; of a case, or of a rotor saved by ROSS."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.rotors import sections

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common) if write_ross else common.output
        return written(analyses.rotors(given, write_ross=write_ross, progress=progress), folder, progress)

    on_case(case, common, work, shown_by(sections))


def gears(case: CaseName, *, common: Common = NONE_GIVEN) -> None:
    """Each gear pair: geometry, stiffness, transmission error, load sharing, pressure, Harris map, best tip relief."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.gears import sections

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        return written(analyses.gears(given, folder=common.output, progress=progress), common.output, progress)

    on_case(case, common, work, shown_by(sections))


def system(
    case: CaseName,
    *,
    campbell: Annotated[
        bool,
        Parameter(
            name=["--campbell"],
            negative=(),
            help="Also the modes over speed: over the case's [sweep], else up to half again the speed of operation.",
        ),
    ] = False,
    sidebands: Annotated[
        int,
        Parameter(
            help="Of this many on either side of each mesh order, by the shafts' turning, the diagram has lines too.",
            validator=Number(gte=0, lte=20),
        ),
    ] = 0,
    mesh_phase: Annotated[
        float | None,
        Parameter(help="About the contact with the first pair's teeth at this part of their period, not its mean."),
    ] = None,
    fresh: Fresh = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Complex natural modes of the whole coupled system, who moves and damps; what reaches bearings and sensors."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.system import sections

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        found = analyses.system(
            given,
            mesh_phase=mesh_phase,
            over_speed=campbell,
            sidebands=sidebands,
            folder=common.output,
            fresh=fresh,
            progress=progress,
        )
        return written(found, common.output, progress)

    on_case(case, common, work, shown_by(sections))


def steady(
    case: CaseName,
    *,
    curve: Annotated[
        bool,
        Parameter(
            name=["--curve"],
            negative=(),
            help="Also follow the motion over speed, through folds: over the range of the case's [sweep], else from "
            "half the speed of operation to half again.",
        ),
    ] = False,
    down: Annotated[
        bool, Parameter(name=["--down"], negative=(), help="Follow it from the highest speed downwards.")
    ] = False,
    points: Annotated[
        int, Parameter(help="Points of the curve where it runs straight.", validator=Number(gte=2, lte=2000))
    ] = 100,
    exact: Annotated[
        bool,
        Parameter(
            name=["--exact"],
            negative=(),
            help="Solve the common period of all excitations however long it is; by default excitations without a "
            "short one, as the meshes of several stages, have a motion each, and these are superposed.",
        ),
    ] = False,
    fresh: Fresh = False,
    common: Common = NONE_GIVEN,
) -> None:
    """The motion that repeats with the excitation, without marching to it; whether it is stable, and over speed."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.steady import sections

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        found = analyses.steady(
            given,
            over_speed=curve,
            downwards=down,
            points=points,
            exact=exact,
            folder=common.output,
            fresh=fresh,
            progress=progress,
        )
        return written(found, common.output, progress)

    on_case(case, common, work, shown_by(sections))


def sweep(
    case: CaseName,
    *,
    over: Annotated[
        list[str],
        Parameter(
            name=["--over"],
            negative=(),
            consume_multiple=False,
            help="Go through values of a key: key.path=from:to:n or =a,b,c, such as "
            "operation.torque='10 N*m:100 N*m:10'. Several make a grid, with the speeds of [sweep] too.",
        ),
    ] = [],  # noqa: B006 - read only
    workers: Annotated[
        int | None, Parameter(help="How many processes (default: as many as cores).", validator=Number(gte=1))
    ] = None,
    scheduler: Annotated[
        str | None, Parameter(help="Address of a running Dask scheduler, whose workers are used instead.")
    ] = None,
    fresh: Annotated[
        bool, Parameter(name="--fresh", negative=(), help="Do also the points and modes that OUT holds.")
    ] = False,
    common: Common = NONE_GIVEN,
) -> None:
    """The transient over the speeds of [sweep] or any keys, in parallel; resumes in OUT (default: ./<case>-results)."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.failures import PartlyFailedError
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.sweep import sections

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        source = (case, tuple(common.settings))
        found = analyses.sweep(
            given, source, over, folder, workers=workers, scheduler=scheduler, fresh=fresh, progress=progress
        )
        return written(found, folder, progress)

    document = on_case(case, common, work, shown_by(sections, timed=True))
    if document["failed"]:
        total = len(document["points"])
        raise PartlyFailedError(f"{document['failed']} of {total} points failed; they are tried again on the next run")
