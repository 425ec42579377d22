"""Commands on rotors, gear pairs and the coupled machine: rotors, gears, load, system, steady, sound, sweep.

Each calls a function of :mod:`gearwhine.analyses.machine`, which makes the machine of the case and solves it by
:mod:`gearwhine.coupling.analyses` and :mod:`gearwhine.rotors.analyses`; ``run`` is in :mod:`gearwhine.cli.case`.
"""

from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from cyclopts.validators import Number

from gearwhine.cli.common import NONE_GIVEN, CaseName, Common, Fresh, on_case, on_loaded, results_folder, written

if TYPE_CHECKING:
    from gearwhine.case import Case, LoadedCase
    from gearwhine.numerics.progress import Progress


def rotors(
    case: CaseName,
    *,
    write_ross: Annotated[
        bool,
        Parameter(
            name=["--write-ross"],
            negative=(),
            help="Also write each rotor with its bearings as a ROSS file to OUT (default: ./<case>-results).",
        ),
    ] = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Lateral and torsional modes, whirl and critical speeds of each rotor; CASE may be a rotor saved by ROSS."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.rotors import sections

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common) if write_ross else common.output
        return written(analyses.rotors(loaded_case, write_ross=write_ross, progress=progress), folder, progress)

    on_case(case, common, work, shown_by(sections), "rotors")


def gears(case: CaseName, *, common: Common = NONE_GIVEN) -> None:
    """Gear pairs: geometry, mesh stiffness, transmission error, load sharing, contact pressure, optimal tip relief."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.gears import sections

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        return written(analyses.gears(loaded_case, folder=common.output, progress=progress), common.output, progress)

    on_case(case, common, work, shown_by(sections), "gears")


def load(
    case: CaseName,
    *,
    over_torque: Annotated[
        bool,
        Parameter(name=["--over-torque"], negative=(), help="Also solve from 10 to 150 % of the torque."),
    ] = False,
    sensitivity: Annotated[
        bool,
        Parameter(
            name=["--sensitivity"],
            negative=(),
            help="Also rank walls and bearings by what they change in gear pairs, in the lines of sensors and, with "
            "[acoustics], in the sound power of the loudest lines.",
        ),
    ] = False,
    line: Annotated[
        str | None,
        Parameter(
            name=["--line"],
            help="Line that --sensitivity ranks and draws: a sensor, or with its frequency in Hz, 'roof@1377'; or of "
            "the sound, 'sound@1377'. By default the highest, and the A-weighted sum of the loudest.",
        ),
    ] = None,
    rigid_seats: Annotated[
        bool,
        Parameter(name=["--rigid-seats"], negative=(), help="Hold the bearings in rigid seats; leave the housing out."),
    ] = False,
    fresh: Fresh = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Load on the whole machine at rest: bearing loads, deflections, misalignment and load of the gear faces."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.operating_point import sections

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        result = analyses.operating_point(
            loaded_case,
            over_torque=over_torque,
            sensitivity=sensitivity,
            line=line,
            rigid_seats=rigid_seats,
            folder=common.output,
            fresh=fresh,
            progress=progress,
        )
        return written(result, common.output, progress)

    on_case(case, common, work, shown_by(sections), "load")


def system(
    case: CaseName,
    *,
    campbell: Annotated[
        bool,
        Parameter(
            name=["--campbell"],
            negative=(),
            help="Also compute the Campbell diagram: over [sweep], else up to 1.5 times the operating speed.",
        ),
    ] = False,
    sidebands: Annotated[
        int,
        Parameter(
            help="Number of shaft-order sidebands drawn on each side of every mesh order.",
            validator=Number(gte=0, lte=20),
        ),
    ] = 0,
    mesh_harmonics: Annotated[
        int,
        Parameter(
            help="Number of harmonics of every mesh whose resonances the Campbell diagram lists and draws.",
            validator=Number(gte=1, lte=50),
        ),
    ] = 3,
    mesh_phase: Annotated[
        float | None,
        Parameter(
            help="Linearise about the mesh at this fraction of the first pair's mesh period (default: the mean)."
        ),
    ] = None,
    fresh: Fresh = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Complex natural modes of the coupled machine, their damping and participation, and its transmissibility."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.system import sections

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        result = analyses.system(
            loaded_case,
            mesh_phase=mesh_phase,
            campbell=campbell,
            sidebands=sidebands,
            mesh_harmonics=mesh_harmonics,
            folder=common.output,
            fresh=fresh,
            progress=progress,
        )
        return written(result, common.output, progress)

    on_case(case, common, work, shown_by(sections), "system")


def steady(
    case: CaseName,
    *,
    curve: Annotated[
        bool,
        Parameter(
            name=["--curve"],
            negative=(),
            help="Also continue the motion over speed, through folds: over the range of [sweep], else from 0.5 to 1.5 "
            "times the operating speed.",
        ),
    ] = False,
    down: Annotated[
        bool, Parameter(name=["--down"], negative=(), help="Continue from the highest speed downwards.")
    ] = False,
    points: Annotated[
        int, Parameter(help="Number of points on a straight part of the curve.", validator=Number(gte=2, lte=2000))
    ] = 100,
    exact: Annotated[
        bool,
        Parameter(
            name=["--exact"],
            negative=(),
            help="Solve over the common period of all excitations, however long; by default excitations without a "
            "short common period, such as the meshes of several stages, are solved one by one and superposed.",
        ),
    ] = False,
    fresh: Fresh = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Periodic steady state by shooting, its stability by Floquet multipliers, and its continuation over speed."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.steady_state import sections

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        result = analyses.steady(
            loaded_case,
            curve=curve,
            down=down,
            points=points,
            exact=exact,
            folder=common.output,
            fresh=fresh,
            progress=progress,
        )
        return written(result, common.output, progress)

    on_case(case, common, work, shown_by(sections), "steady")


def sound(case: CaseName, *, fresh: Fresh = False, common: Common = NONE_GIVEN) -> None:
    """Sound power, radiation efficiency and sound pressure of the housing's modes and of the steady motion's lines."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.sound import sections

    def work(loaded_case: "Case", progress: "Progress") -> dict[str, Any]:
        result = analyses.sound(loaded_case, folder=common.output, fresh=fresh, progress=progress)
        return written(result, common.output, progress)

    on_case(case, common, work, shown_by(sections), "sound")


def sweep(
    case: CaseName,
    *,
    over: Annotated[
        list[str],
        Parameter(
            name=["--over"],
            negative=(),
            consume_multiple=False,
            help="Vary a key: key.path=from:to:n or key.path=a,b,c, such as operation.torque='10 N*m:100 N*m:10'. "
            "Repeated, the keys and the speeds of [sweep] form a grid.",
        ),
    ] = [],  # noqa: B006 - read only
    workers: Annotated[
        int | None, Parameter(help="Number of processes (default: number of cores).", validator=Number(gte=1))
    ] = None,
    scheduler: Annotated[
        str | None, Parameter(help="Address of a running Dask scheduler; its workers replace the local ones.")
    ] = None,
    fresh: Annotated[
        bool, Parameter(name="--fresh", negative=(), help="Solve again the points and modes that OUT holds.")
    ] = False,
    common: Common = NONE_GIVEN,
) -> None:
    """Parallel transients over the speeds of [sweep] or over any keys; OUT (default: ./<case>-results) is resumed."""
    from gearwhine.analyses import machine as analyses
    from gearwhine.failures import PartlyFailedError
    from gearwhine.output.terminal import shown_by
    from gearwhine.results.sweep import sections

    def work(loaded: "LoadedCase", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common)
        result = analyses.sweep(
            loaded.case,
            loaded.source,
            over,
            folder,
            workers=workers,
            scheduler=scheduler,
            fresh=fresh,
            progress=progress,
        )
        return written(result, folder, progress)

    document = on_loaded(case, common, work, shown_by(sections, timed=True), "sweep")
    if document["failed"]:
        total = len(document["points"])
        raise PartlyFailedError(f"{document['failed']} of {total} points failed; they are tried again on the next run")
