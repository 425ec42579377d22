"""The bundled cases, what follows from a case without solving it, and a results folder as a page or exported."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from gearwhine.case import Case, CaseError, Problem, load_case
from gearwhine.failures import DamagedResultsError
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.output import staging
from gearwhine.output.files import finish_moves
from gearwhine.output.manifest import require_as_written
from gearwhine.output.quantity import add_warnings
from gearwhine.output.sections import Column, Document, Section, table_of

if TYPE_CHECKING:
    from gearwhine.coupling.machine.components import HousingComponent
    from gearwhine.output.export import Signals

Format = Literal["csv", "uff", "wav"]


def write_report(
    folder: Path, case: Case | None = None, *, interactive: bool = False, progress: Progress = silent
) -> dict[str, Any]:
    """Write the results in a folder as one HTML page, which marks those that no longer fit the case.

    Parameters
    ----------
    folder : path
        Folder with results of one command or several.
    case : Case, optional
        Case of the results; by default that of the newest one.
    interactive : bool
        Whether shapes move, curves can be zoomed and tables be sorted: ``report-interactive.html`` in place of
        ``report.html``, which has no script.
    progress : callable

    Raises
    ------
    CaseError
        Where the folder holds no results, or a summary cannot be read.
    DamagedResultsError
        Where a file of the results is not as it was written.
    """
    from gearwhine.output.own_files import require_own
    from gearwhine.output.report import Contents, report_page
    from gearwhine.results import chapters_of
    from gearwhine.results.first_page import first_page

    # The page shows what the arrays hold, though without --interactive it does not read them.
    remarks = _checked(folder, lambda name: name.endswith((".json", ".nc", ".png", "case.toml")))
    name, shapes = "report.html", None
    if interactive:
        from gearwhine.mode_pictures import moving_shapes

        progress("modelling the shapes that move")
        name, shapes = "report-interactive.html", moving_shapes(folder)
    require_own(folder, [name])
    progress("packing the pictures into the page")
    with _as_this_build_writes(folder):
        page = report_page(folder, Contents(chapters_of, first_page), case or _stored_case(folder), shapes=shapes)
    with staging(folder) as place:
        (place / name).write_text(page, encoding="utf-8")
    document = {"folder": str(folder), "files": [name]}
    add_warnings(document, (warning("results folder", remark) for remark in remarks))
    return document


def _checked(folder: Path, are_read: Callable[[str], bool]) -> list[str]:
    """Check a results folder before it is read; return remarks on files that are missing, or damaged and not read.

    What a run that was killed while its files moved has left behind is moved first.
    """
    with suppress(PermissionError):  # a folder that may only be read is read as it is
        finish_moves(folder)
    return require_as_written(folder, are_read)


@contextmanager
def _as_this_build_writes(folder: Path) -> Iterator[None]:
    """Refuse results whose documents lack what this build reads: one of the same version may have written less."""
    try:
        yield
    except KeyError as missing:
        raise DamagedResultsError(
            f"{folder}: a result has no {missing}, which another build of Gearwhine left out; run its command again"
        ) from missing


def _stored_case(folder: Path) -> Case | None:
    """Return the case of the newest result in a folder; None where it, or a file that it names, cannot be read."""
    from gearwhine.output.store import stored_results

    for place, _ in stored_results(folder)[:1]:
        try:
            return load_case(folder / place / "case.toml").case
        except (CaseError, OSError):
            return None
    return None


_EXPORTS = "exports"


def export_results(
    folder: Path,
    formats: Sequence[Format] = ("csv", "uff", "wav"),
    *,
    signals: Signals = "sensors",
    seconds: float | None = None,
) -> dict[str, Any]:
    """Write the results in a folder in formats of other programs, into its sub-folder ``exports``.

    Parameters
    ----------
    folder : path
        Folder with results of one command or several.
    formats : sequence of {"csv", "uff", "wav"}
        Tables of the report; histories, spectra and transmissibilities as datasets 58; accelerations of the sensors
        and sound pressures of the microphones as sound.
    signals : {"sensors", "all"}
        Whether the universal files leave out forces and motions of bearings, gears and meshes.
    seconds : float, optional
        Least length of the sound file of a record that repeats [s], by default 5; 0 for one period. A record that does
        not repeat, such as a run-up, is as long as it is.

    Returns
    -------
    dict
        ``tables``, ``universal_files`` and ``sounds``, each a list of files with their contents, and ``warnings``.

    Raises
    ------
    CaseError
        Where the folder holds no results, or nothing that can be written in any of these formats, or the length is
        outside its range.
    DamagedResultsError
        Where a file of the results is not as it was written, or cannot be read.
    """
    from gearwhine.output import export
    from gearwhine.output.store import stored_results
    from gearwhine.results import chapters_of

    remarks = _checked(folder, lambda name: name.endswith((".json", "results.nc", "case.toml")))
    if not stored_results(folder):
        expected = f"a results folder, as `gearwhine run CASE -o {folder}` leaves it"
        raise CaseError([Problem("export", str(folder), expected)])
    document: dict[str, Any] = {}
    length = export.SOUND_SECONDS if seconds is None else seconds
    if not 0.0 <= length <= export.LONGEST_SOUND:
        expected = f"a length of sound files from 0 to {export.LONGEST_SOUND:g} s"
        raise CaseError([Problem("export --seconds", length, expected)])
    with _as_this_build_writes(folder), staging(folder) as place:
        exports = place / _EXPORTS
        exports.mkdir()
        if "csv" in formats:
            document["tables"] = export.write_tables(folder, chapters_of, exports)
        if "uff" in formats:
            document["universal_files"] = export.write_universal_files(folder, exports, signals)
        if "wav" in formats:
            document["sounds"] = export.write_sounds(folder, exports, seconds=length)
        files = sorted(path.relative_to(place).as_posix() for path in exports.iterdir())
        if not files:
            expected = f"results with what can be written as {', '.join(formats)}"
            how = "run the case with [transient], and with sensors, or with [acoustics], in_run = true and microphones"
            raise CaseError([Problem("export", str(folder), f"{expected}: {how}")])
    add_warnings(document, (warning("results folder", remark) for remark in remarks))
    add_warnings(document, _missing_points(document))
    return document | {"folder": str(folder), "files": files}


def export_rexs(case: Case, target: Path, folder: Path | None = None) -> dict[str, Any]:
    """Write the gear unit of a case as a REXS file, with a load case where its operating point is solved.

    Parameters
    ----------
    case : Case
    target : path
        File to write, which ends in ``.rexs``.
    folder : path, optional
        Results folder; the operating point in it is taken where ``gearwhine load`` solved it of this very case, and the
        static stiffness of the housing where it holds its modes. That of a reduced housing is always taken.

    Returns
    -------
    dict
        ``rexs`` with ``version``, ``components``, ``relations``, whether it has a ``load_case``, and ``notes`` on what
        is changed or left out.

    Raises
    ------
    CaseError
        Where the case has no gears on rotors, or a part that no component of the schema stands for, or the file stands
        there already.
    """
    from gearwhine.from_case.rexs import rexs_of

    if not target.name.lower().endswith(".rexs"):
        raise CaseError([Problem("export --rexs", str(target), "the name of a REXS file, which ends in .rexs")])
    if target.exists():
        raise CaseError([Problem("export --rexs", str(target), "a place where no file of that name stands yet")])
    load = None if folder is None else _solved_load(folder, case)
    exported = rexs_of(case, load, _solved_component(case, folder))
    with staging(target.parent, listed=False) as place:  # the file is the user's
        (place / target.name).write_text(exported.xml, encoding="utf-8")
    model = exported.model
    document: dict[str, Any] = {
        "folder": str(target.parent),
        "files": [target.name],
        "rexs": {
            "version": model.version,
            "components": len(model.components),
            "relations": len(model.relations),
            "load_case": load is not None,
            "notes": [{"kind": note.kind, "about": note.about, "text": note.text} for note in exported.notes],
        },
    }
    add_warnings(document)
    return document


def _solved_component(case: Case, folder: Path | None) -> HousingComponent | None:
    """Return the housing of a case as a component of its machine; None where it would have to be solved first."""
    from gearwhine.coupling.machine.components import component_of_housing
    from gearwhine.from_case.reduced_housing import reduced_component
    from gearwhine.solve.housing_modes import kept_housing

    if case.reduced_housing is not None:
        return reduced_component(case.reduced_housing, case.input_files)
    housing = kept_housing(case, folder)
    return None if housing is None else component_of_housing(housing, participates=False, with_coarser=False)


def _solved_load(folder: Path, case: Case) -> Document | None:
    """Return the operating point of a case from a results folder; None where that of this very case is not there."""
    from gearwhine.output.store import earlier_result

    if not folder.is_dir():
        return None
    _checked(folder, lambda name: name.endswith((".json", "case.toml")))
    found = earlier_result(folder, "load")
    if found is None:
        return None
    place, document = found
    try:
        return document if load_case(place / "case.toml").case == case else None
    except (CaseError, OSError):
        return None


def case_in(folder: Path) -> Case:
    """Return the case of the newest result in a folder.

    Raises
    ------
    CaseError
        Where there is none that can be read.
    """
    case = _stored_case(folder)
    if case is None:
        raise CaseError([Problem("export --rexs", str(folder), "a case, or a folder with results of one")])
    return case


def export_reduced(title: str, housing: HousingComponent, target: Path) -> dict[str, Any]:
    """Write the housing of a case as reduced matrices, and the tables by which another case takes them.

    Parameters
    ----------
    title : str
        Title of the case, which a refusal names.
    housing : HousingComponent
        The solved housing of the case.
    target : path
        File to write, ``.npz``, ``.nc``, ``.mtx``, ``.op4`` or ``.pch``; the tables stand beside it as ``.toml``.

    Returns
    -------
    dict
        ``reduced`` with ``order``, ``seats``, ``sensors`` and ``left_out``.

    Raises
    ------
    CaseError
        Where the ending is another one, a file stands there already, or the housing has no seats.
    """
    from gearwhine import __version__
    from gearwhine.coupling.errors import CouplingError
    from gearwhine.coupling.machine.reduced_component import interface_matrices
    from gearwhine.from_case.reduced_housing import tables_of
    from gearwhine.housing.reduced.writing import write_matrices

    refuse_target(target)
    try:
        reduced = interface_matrices(housing)
    except CouplingError as error:
        raise CaseError([Problem("export --reduced", title or str(target), str(error))]) from error
    with staging(target.parent, listed=False) as place:  # the files are the user's
        files = write_matrices(place / target.name, reduced.matrices)
        tables = place / f"{target.stem}.toml"
        origin_title = " ".join(title.split())
        origin = f"# Reduced by Gearwhine {__version__}{f' from {origin_title}' if origin_title else ''}.\n\n"
        tables.write_text(origin + tables_of(reduced, files, housing.complete_below), encoding="utf-8")
        names = sorted({path.name for path in (*files.values(), tables)})
        _refuse_standing([target.parent / name for name in names])
    document: dict[str, Any] = {
        "folder": str(target.parent),
        "files": names,
        "reduced": {
            "order": reduced.matrices.size,
            "seats": {seat.name: seat.node for seat in reduced.seats},
            "sensors": {sensor.name: sensor.node for sensor in reduced.sensors},
            "left_out": list(reduced.left_out),
        },
    }
    add_warnings(document)
    return document


def refuse_target(target: Path) -> None:
    """Refuse a file of reduced matrices by its ending or place, before a housing is solved for it."""
    from gearwhine.housing.reduced.writing import WRITTEN_ENDINGS

    if target.suffix.lower() not in WRITTEN_ENDINGS:
        expected = f"a file that ends in one of {', '.join(WRITTEN_ENDINGS)}"
        raise CaseError([Problem("export --reduced", str(target), expected)])
    _refuse_standing([target, target.with_suffix(".toml")])


def _refuse_standing(files: Sequence[Path]) -> None:
    """Refuse files of which one stands already."""
    for file in files:
        if file.exists():
            raise CaseError([Problem("export --reduced", str(file), "a place where no file of that name stands yet")])


def reduced_sections(document: Document) -> tuple[Section, ...]:
    """Return what the files of a reduced housing hold."""
    reduced = document["reduced"]
    nodes = [f"{name}: node {node}" for part in ("seats", "sensors") for name, node in reduced[part].items()]
    left = []
    if reduced["left_out"]:
        why = "their directions are along no axis, or other nodes move them"
        left = [f"sensors {', '.join(reduced['left_out'])} are left out: {why}"]
    note = f" mass, stiffness and damping of order {reduced['order']}, supports included, in SI"
    return (Section("Exported", (*nodes, *left), note=note),)


def rexs_sections(document: Document) -> tuple[Section, ...]:
    """Return what a REXS file holds, and what it does not."""
    from gearwhine.exchange.rexs.notes import Note, in_words

    unit = document["rexs"]
    count = f"REXS {unit['version']}: {unit['components']} components, {unit['relations']} relations"
    point = "with the operating point as a load case" if unit["load_case"] else "without an operating point"
    notes = [Note(note["kind"], note["about"], note["text"]) for note in unit["notes"]]
    return (Section("Exported", tuple(in_words(notes)), note=f" {count}, {point}"),)


def _missing_points(document: Document) -> Iterator[dict[str, Any]]:
    """Yield a warning for each universal file with sensors whose points are not known."""
    for row in document.get("universal_files", ()):
        if names := row.get("without_point"):
            sensors = ", ".join(f'"{name}"' for name in names)
            message = (
                f"{row['file']} has no points of sensors {sensors}: neither the result nor its case holds them; "
                "their functions are at node 0, direction 0"
            )
            yield warning("sensors without points", message, file=row["file"], sensors=names)


def _either(row: Document, quantity: str) -> float:
    """Return a quantity of a sound file in the unit of its signal."""
    return float(row.get(f"{quantity}_m_per_s2", row.get(f"{quantity}_pa", 0.0)))


def export_sections(document: Document) -> tuple[Section, ...]:
    """Return the exported files as tables."""
    sounds = (
        Column("file", "file"),
        Column("sensor or microphone", lambda row: str(row.get("sensor", row.get("microphone")))),
        Column("unit", lambda row: "Pa" if "microphone" in row else "m/s²"),
        Column("full scale", lambda row: f"{_either(row, 'full_scale'):g}"),
        Column("peak", lambda row: f"{_either(row, 'peak'):.3g}"),
        Column("rms", lambda row: f"{_either(row, 'rms'):.3g}"),
        Column("complete below [Hz]", "complete_below_hz", ".0f"),
        Column("length [s]", "seconds", ".3f"),
        Column("periods", "periods", "d"),
    )
    tables = (Column("file", "file"), Column("rows", "rows"))
    functions = (Column("file", "file"), Column("functions", "functions"))
    return (
        Section(
            "",
            (
                *table_of(tables, document.get("tables", ()), "Tables (CSV)"),
                *table_of(functions, document.get("universal_files", ()), "Universal files, datasets 58"),
                *table_of(sounds, document.get("sounds", ()), "Sounds of sensors and microphones (WAV)"),
            ),
        ),
    )
