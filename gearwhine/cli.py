"""The command line: ``gearwhine COMMAND CASE [-o OUT] [--json] [--set key.path=value ...] [-q]``.

Every command is a few lines: read the case, run the stages, hand the result on. What takes long to import is
imported where it is used, so that ``--help`` answers at once.
"""

import os
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import App, CycloptsError, Parameter
from cyclopts.validators import Number

from gearwhine import __version__
from gearwhine.interruption import interruptible

if TYPE_CHECKING:
    from gearwhine.case import Case
    from gearwhine.progress import Progress

app = App(
    name="gearwhine",
    version=__version__,
    help="Gearbox vibration: from the geometry of housing, rotors and gears to the spectrum at an accelerometer.",
    help_epilogue="Try: gearwhine examples, then gearwhine run small-gearbox",
    help_format="plaintext",
    # An interruption unwinds to run_command, which has a sentence for it.
    suppress_keyboard_interrupt=False,
)


@Parameter(name="*")
@dataclass(frozen=True)
class Common:
    """What every command on a case takes."""

    output: Annotated[Path | None, Parameter(name=["--output", "-o"], help="Folder for the results.")] = None
    json: Annotated[bool, Parameter(name="--json", negative=(), help="Print one JSON document and nothing else.")] = (
        False
    )
    settings: Annotated[
        list[str],
        Parameter(
            name=["--set"],
            negative=(),
            consume_multiple=False,
            help="Change the case: key.path=value, such as --set housing.box.mesh_size='20 mm'. May be repeated.",
        ),
    ] = field(default_factory=list)
    quiet: Annotated[bool, Parameter(name=["--quiet", "-q"], negative=(), help="Show no progress.")] = False


_DEFAULTS = Common()
Fresh = Annotated[
    bool, Parameter(name="--fresh", negative=(), help="Solve the housing's modes also where OUT keeps them unchanged.")
]
FreshRun = Annotated[
    bool,
    Parameter(
        name="--fresh",
        negative=(),
        help="Begin anew also where OUT keeps the housing's modes, or a transient that was interrupted.",
    ),
]
CaseName = Annotated[str, Parameter(help="A case file (TOML), or the name of a bundled case.")]


@app.command
def run(case: CaseName, *, fresh: FreshRun = False, common: Common = _DEFAULTS) -> None:
    """Everything the case asks for, start to end; results go to OUT (default: ./<case>-results).

    A run that was interrupted or killed goes on from its last checkpoint when the same case is run into OUT again.
    """
    from gearwhine.screen import show_run
    from gearwhine.work import run_case

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        return run_case(given, _folder(case, common), progress, fresh=fresh)

    _on_case(case, common, work, show_run)


@app.command
def check(case: CaseName, *, common: Common = _DEFAULTS) -> None:
    """Read the case and say what it means; solves nothing."""
    from gearwhine.screen import show_check
    from gearwhine.stages.summary import check_document

    _on_case(case, common, check_document, show_check)


@app.command
def mesh(
    case: CaseName,
    *,
    format: Annotated[  # noqa: A002 - the name of the option
        Literal["msh", "vtu", "vtk", "inp", "med", "xdmf"], Parameter(help="Format of the mesh file.")
    ] = "msh",
    common: Common = _DEFAULTS,
) -> None:
    """Mesh the housing and write the mesh file to OUT (default: ./<case>-results)."""
    from gearwhine.screen import show_mesh
    from gearwhine.work import mesh_case

    _on_case(case, common, lambda given, progress: mesh_case(given, _folder(case, common), format, progress), show_mesh)


@app.command
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
    common: Common = _DEFAULTS,
) -> None:
    """Housing modes, proved complete, with a report on the model's health."""
    from gearwhine.screen import show_modes, show_modes_in_detail
    from gearwhine.work import modes_case

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        return modes_case(given, common.output, progress, detail=detail, fresh=fresh)

    _on_case(case, common, work, show_modes_in_detail if detail else show_modes)


@app.command
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
    common: Common = _DEFAULTS,
) -> None:
    """Each rotor's lateral and torsional modes, whirl and critical speeds; of a case, or of a rotor saved by ROSS."""
    from gearwhine.screen import show_rotors
    from gearwhine.work import rotors_case

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        folder = _folder(case, common) if write_ross else common.output
        return rotors_case(given, folder, progress, write_ross=write_ross)

    _on_case(case, common, work, show_rotors)


@app.command
def gears(case: CaseName, *, common: Common = _DEFAULTS) -> None:
    """Each gear pair: geometry, stiffness, transmission error, load sharing, pressure, Harris map, best tip relief."""
    from gearwhine.screen import show_gears
    from gearwhine.work import gears_case

    _on_case(case, common, lambda given, progress: gears_case(given, common.output, progress), show_gears)


@app.command
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
    common: Common = _DEFAULTS,
) -> None:
    """Complex natural modes of the whole coupled system, who moves and damps; what reaches bearings and sensors."""
    from gearwhine.screen import show_system
    from gearwhine.work import system_case

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        return system_case(
            given,
            common.output,
            progress,
            mesh_phase=mesh_phase,
            over_speed=campbell or sidebands > 0,
            sidebands=sidebands,
            fresh=fresh,
        )

    _on_case(case, common, work, show_system)


@app.command
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
    fresh: Fresh = False,
    common: Common = _DEFAULTS,
) -> None:
    """The motion that repeats with the excitation, without marching to it; whether it is stable, and over speed."""
    from gearwhine.screen import show_steady
    from gearwhine.work import steady_case

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        over_speed = curve or down
        return steady_case(
            given, common.output, progress, over_speed=over_speed, downwards=down, points=points, fresh=fresh
        )

    _on_case(case, common, work, show_steady)


@app.command
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
    common: Common = _DEFAULTS,
) -> None:
    """The transient over the speeds of [sweep] or any keys, in parallel; resumes in OUT (default: ./<case>-results)."""
    from gearwhine.failures import PartlyFailedError
    from gearwhine.screen import show_sweep
    from gearwhine.work import sweep_case

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        folder = _folder(case, common)
        source = (case, tuple(common.settings))
        return sweep_case(given, source, over, folder, progress, workers=workers, scheduler=scheduler, fresh=fresh)

    document = _on_case(case, common, work, show_sweep)
    if document["failed"]:
        total = len(document["points"])
        raise PartlyFailedError(f"{document['failed']} of {total} points failed; they are tried again on the next run")


@app.command
def compare(case: CaseName, *, fresh: Fresh = False, common: Common = _DEFAULTS) -> None:
    """Model modes of the housing against measured ones."""
    from gearwhine.screen import show_comparison
    from gearwhine.work import compare_case

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        return compare_case(given, common.output, progress, fresh=fresh)

    _on_case(case, common, work, show_comparison)


@app.command
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
    common: Common = _DEFAULTS,
) -> None:
    """Where to put sensors and the hammer for a modal survey, as files in OUT (default: ./<case>-results)."""
    from gearwhine.screen import show_survey
    from gearwhine.work import survey_case

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        return survey_case(given, sensors, modes, _folder(case, common), progress, fresh=fresh)

    _on_case(case, common, work, show_survey)


@app.command
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
    common: Common = _DEFAULTS,
) -> None:
    """Fit the numbers of [update] to the measured modes; writes updated.toml to OUT (default: ./<case>-results)."""
    from gearwhine.screen import show_update
    from gearwhine.work import update_case

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        return update_case(given, _folder(case, common), progress, null=null, held_back=held_back)

    _on_case(case, common, work, show_update)


@app.command
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
    common: Common = _DEFAULTS,
) -> None:
    """Shapes of modes, of a run's lines, or measured: pictures, films, models in OUT (default: ./<case>-results)."""
    from gearwhine.screen import show_files
    from gearwhine.work import render_case

    def work(given: "Case", progress: "Progress") -> dict[str, Any]:
        return render_case(
            given,
            _folder(case, common),
            modes,
            view,
            progress,
            mode_format=format,
            lines=line,
            measured=measured,
            fresh=fresh,
        )

    _on_case(case, common, work, show_files)


@app.command
def examples(
    action: Annotated[Literal["list", "copy"], Parameter(help="What to do.")] = "list",
    name: Annotated[str | None, Parameter(help="Which bundled case to copy.")] = None,
    *,
    common: Common = _DEFAULTS,
) -> None:
    """List the bundled cases, or copy one here (or to OUT) to change it: examples copy NAME."""
    from gearwhine.screen import show_examples, show_files
    from gearwhine.work import copy_example, list_examples

    if action == "list":
        _hand_over(list_examples(), common, show_examples)
    else:
        _hand_over(copy_example(name, common.output or Path()), common, show_files)


@app.command
def report(case: CaseName, *, common: Common = _DEFAULTS) -> None:
    """The results folder OUT (default: ./<case>-results) as one HTML page, report.html in it."""
    from gearwhine.screen import show_files
    from gearwhine.work import report_case

    _on_case(case, common, lambda given, progress: report_case(_folder(case, common)), show_files)


def run_command(arguments: list[str]) -> int:
    """Run the command line; 0 when done, 2 where the user's input is wrong, 1 for anything else.

    Only what nobody foresaw leaves a traceback.
    """
    with interruptible():
        return _run_command(arguments)


def _run_command(arguments: list[str]) -> int:
    from gearwhine.failures import explain

    try:
        app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
    except CycloptsError as error:
        sys.stderr.write(f"gearwhine: {error}\nTry 'gearwhine --help'.\n")
        return 2
    except KeyboardInterrupt as stop:
        sys.stderr.write("gearwhine: interrupted; the output folder holds no half-written file\n")
        for note in getattr(stop, "__notes__", ()):
            sys.stderr.write(f"gearwhine: {note}\n")
        return 130
    except BrokenPipeError:
        return 1
    except Exception as error:
        code, message = explain(error)
        if message is None:
            raise
        for note in getattr(error, "__notes__", ()):
            sys.stderr.write(f"{note}\n")
        sys.stderr.write(f"gearwhine: {message}\n")
        return code
    return 0


def _on_case(
    name: str,
    common: Common,
    work: Callable[["Case", "Progress"], dict[str, Any]],
    show: Callable[[dict[str, Any]], None],
) -> dict[str, Any]:
    """Read the case, do the work under a progress display, hand the result over and return it."""
    from gearwhine.case import load_case
    from gearwhine.progress import shown

    loaded = load_case(name, common.settings)
    if common.output is not None:
        _check_folder(common.output)
    for warning in loaded.warnings:
        sys.stderr.write(f"warning: {warning}\n")
    with shown(quiet=common.quiet) as progress:
        document = work(loaded.case, progress)
    for warning in document.get("warnings", ()):
        sys.stderr.write(f"warning: {warning['message']}\n")
    _hand_over(document, common, show)
    return document


def _check_folder(folder: Path) -> None:
    """Refuse a place where no results can go before the work begins, and make nothing yet."""
    from gearwhine.case import CaseError, Problem

    place = folder
    while not place.exists() and place != place.parent:
        place = place.parent
    if not place.is_dir() or not os.access(place, os.W_OK):
        what = "is a file" if place.is_file() else "cannot be written to"
        raise CaseError([Problem("--output", str(folder), f"a folder for the results; {place} {what}")])


def _hand_over(document: dict[str, Any], common: Common, show: Callable[[dict[str, Any]], None]) -> None:
    from gearwhine.output import finite, json_text

    if common.json:
        sys.stdout.write(json_text(finite(document)) + "\n")
    else:
        show(document)


def _folder(case: str, common: Common) -> Path:
    """The folder for a command that always writes, once it is known to take files."""
    folder = common.output if common.output is not None else Path(f"{Path(case).stem}-results")
    _check_folder(folder)
    return folder
