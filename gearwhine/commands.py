"""Commands on a case, each declared once: its method and options, what it writes, and the tables that it reads.

The command line, the results folder, and the report's remarks on results that no longer fit their case are made of it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

_FRESH_MODES = "Solve the housing's modes again, even if OUT holds them."
_FRESH_RUN = "Start again, even if OUT holds the housing's modes or an interrupted transient."
_FRESH_POINTS = "Solve again the points and modes that OUT holds."
_FRESH_SAMPLES = "Solve again the gearboxes and modes that OUT holds."
_FRESH_DESIGNS = "Solve again the designs and modes that OUT holds."


@dataclass(frozen=True)
class Command:
    """A command that is made of a method of a study.

    Attributes
    ----------
    name : str
        Name of the command.
    sections : str
        Module of :mod:`gearwhine.results` and function in it that compose what the terminal shows, by default
        ``sections`` of the one with the command's name; empty for files alone.
    method : str
        Method of `gearwhine.case_study.CaseStudy`; that of the command's name by default.
    chapters : tuple of (str, str)
        Chapters of the report in their order: a key of the document that has one, and the module of
        :mod:`gearwhine.results` with the function in it that composes it.
    files : tuple of str
        Patterns of the names of the files that it writes; none where it leaves no results for a report.
    needs : tuple of str
        Tables of the case that it does not go without, where the method does not tell.
    reads : tuple of str
        Tables of the case that it reads, of those that not all commands read.
    unread : tuple of str
        Tables that it does not read, of the others.
    longer : tuple of str
        Option that shows more, and the module and function that compose it.
    always_writes : bool
        Whether results are written without ``--output``, too.
    writes_with : str
        Option with which they are.
    stores : bool
        Whether the method takes the folder and stores the result itself.
    adds : bool
        Whether its pictures are added to its earlier ones.
    names : mapping of str to str
        Options by another name than that of the parameter.
    without : sequence of str
        Parameters that are no options.
    fresh : str
        Help of ``--fresh``; empty where there is no such option.
    timed : bool
        Whether the terminal shows the time.
    draws : bool
        Whether pictures are written beside the data, and may be left out.
    """

    name: str
    sections: str | None = None
    method: str = ""
    chapters: tuple[tuple[str, str], ...] = ()
    files: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()
    longer: tuple[str, str] = ("", "")
    always_writes: bool = False
    writes_with: str = ""
    stores: bool = False
    adds: bool = False
    names: Mapping[str, str] = field(default_factory=dict)
    without: Sequence[str] = ()
    fresh: str = ""
    timed: bool = False
    draws: bool = True


_CASE = ("case.toml", "summary.json")
_MODES = (*_CASE, "modes.nc")
_DATA = (*_MODES, "results.nc")
_SHAPES = (
    "modes.png",
    *(f"{kind}Hz.{ending}" for kind in ("mode-[0-9]*", "line-[0-9]*") for ending in ("png", "glb", "gif", "mp4")),
)
_COMPARED = ("comparison.csv", "comparison.png", "mac.*", "auto-mac.png", "cross-orthogonality.png", "comac.*")
_LOAD, _SYSTEM, _SOUND = "load-*.png", ("system*.png", "transmissibility-*.png"), "sound-*.png"
_RUN = (
    *(*_DATA, "modes.vtu", *_SHAPES, *_COMPARED, _LOAD, *_SYSTEM, _SOUND),
    *("gears-*.png", "rotor-*.png", "run-up-*.png", "spectrum.png", "contributions.png", "mesh-force.png"),
    *("orbits.png", "modal-coordinates.png"),
)
INCLUDED = frozenset({"housing", "compare", "load", "system", "sound"})
"""Keys of a document under which it holds that of another analysis."""
_LOADED = ("load", "operating_point.report")
_CHAPTERS_OF_RUN = (
    ("housing", "housing.report"), ("compare", "comparison.report"), ("rotors", "rotors.report"),
    ("pairs", "gears.report"), _LOADED, ("system", "system.report"), ("steps", "run.report"), ("sound", "sound.report")
)  # fmt: skip
_OF_MACHINE = ("transient", "gear", "gear_pair")
_OF_MANY: dict[str, Any] = {"always_writes": True, "without": ("folder", "fresh"), "timed": True}
"""Of a study of many solutions, which keeps them in the folder, see :class:`gearwhine.study_folder.FolderOptions`."""

STUDY_COMMANDS = (
    Command(
        "run", method="run_into", chapters=_CHAPTERS_OF_RUN,
        files=_RUN, reads=("acoustics", "measured", "rotor_analysis", "sweep"),
        always_writes=True, stores=True, without=("folder",), fresh=_FRESH_RUN, timed=True
    ),
    Command(
        "check", "check.summary", files=_CASE, reads=("acoustics", "measured", "rotor_analysis", "sweep", "update"),
        longer=("verbose", "check.sections"), draws=False
    ),
    Command("mesh", always_writes=True, names={"suffix": "format"}, draws=False),
    Command(
        "modes", chapters=(("certificate", "housing.report"), ("reduced_housing", "modes.report")),
        files=(*_DATA, "modes.vtu"), unread=_OF_MACHINE, longer=("detail", "modes.detailed_sections"),
        fresh=_FRESH_MODES
    ),
    Command(
        "rotors", chapters=(("rotors", "rotors.report"),),
        files=(*_CASE, "results.nc", "rotor-*.png"), needs=("rotor",), reads=("rotor_analysis", "sweep"),
        unread=("transient", "gear_pair"), writes_with="write_ross"
    ),
    Command(
        "gears", chapters=(("pairs", "gears.report"),),
        files=(*_DATA, "gears-*.png"), needs=("gear_pair",), unread=("transient",), without=("aims",)
    ),
    Command(
        "load", "operating_point.sections", "operating_point", chapters=(("gear_pairs", "operating_point.report"),),
        files=(*_DATA, _LOAD),
        needs=("rotor", "bearing", "operation"), reads=("acoustics", "update"), fresh=_FRESH_MODES
    ),
    Command(
        "system", chapters=(_LOADED, ("stability", "system.report")),
        files=(*_DATA, *_SYSTEM), needs=("rotor", "operation"), reads=("sweep",), fresh=_FRESH_MODES
    ),
    Command(
        "steady", "steady_state.sections", chapters=(_LOADED, ("motions", "steady_state.report")),
        files=(*_DATA, "steady-*.png"), needs=("rotor", "operation"),
        reads=("sweep",), fresh=_FRESH_MODES
    ),
    Command(
        "sound", chapters=(("total_db_a", "sound.report"),),
        files=(*_DATA, _SOUND), needs=("housing",), reads=("acoustics",), without=("acoustics",),
        fresh=_FRESH_MODES
    ),
    Command(
        "sweep", chapters=(("points", "sweep.report"),),
        files=(*_DATA, "sweep-*.png", "waterfall-*.png"), reads=("acoustics", "sweep"), fresh=_FRESH_POINTS,
        **_OF_MANY
    ),
    Command(
        "vary", "variation.sections", chapters=(("quantities", "variation.report"),),
        files=(*_CASE, "vary.nc", "vary-*.png", "worst-*.toml"),
        reads=("sweep", "variation"), names={"samples": "n"}, fresh=_FRESH_SAMPLES, **_OF_MANY
    ),
    Command(
        "detect", "detection.sections", chapters=(("detectability", "detection.report"),),
        files=(*_MODES, "detect.nc", "detection-*.png"),
        reads=("variation", "detection"), fresh=_FRESH_SAMPLES, **_OF_MANY
    ),
    Command(
        "optimise", "optimisation.sections",
        chapters=(("designs", "optimisation.report"),),
        files=(*_CASE, "optimise.nc", "optimise-*.png", "best.toml", "nearest.toml", "front-*.toml"),
        reads=("sweep", "variation", "optimisation"), names={"evaluations": "n"}, fresh=_FRESH_DESIGNS, **_OF_MANY
    ),
    Command(
        "compare", "comparison.sections", chapters=(("pairing", "comparison.report"),),
        files=(*_MODES, *_COMPARED, "comparison.nc", "frac.csv"),
        reads=("measured",), unread=_OF_MACHINE, fresh=_FRESH_MODES
    ),
    Command(
        "survey", files=(*_MODES, "survey.uff", "survey.csv"), unread=_OF_MACHINE, always_writes=True,
        fresh=_FRESH_MODES
    ),
    Command(
        "update", chapters=(("parameters", "update.report"),),
        files=(*_CASE, "update.nc", "updated.toml"), reads=("measured", "update"), unread=_OF_MACHINE,
        always_writes=True, draws=False
    ),
    Command(
        "render", "", chapters=(("command", "housing.render_report"),),
        files=(*_MODES, *_SHAPES, "measured-and-model.png"), reads=("measured",), unread=_OF_MACHINE,
        always_writes=True, adds=True, names={"mode_format": "format"}, fresh=_FRESH_MODES, draws=False
    ),
)  # fmt: skip
"""Commands on a case, in the order of the help."""

_SIMULATE = Command(
    "simulate", chapters=_CHAPTERS_OF_RUN, files=_RUN, needs=("rotor", "operation"), reads=("acoustics",)
)
COMMANDS = {command.name: command for command in (*STUDY_COMMANDS, _SIMULATE) if command.files}
"""Analyses that leave results in the output folder, by name: the commands, and `simulate` of Python."""
