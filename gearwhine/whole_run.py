"""The whole run of a study: every analysis that it asks for, one after the other, and their common document."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from contextvars import copy_context
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.analyses.machine_results import MachineUnderLoad, condition_of, modes_of_run, motion_document
from gearwhine.analyses.result import Result
from gearwhine.analyses.run_solution import RunSolution
from gearwhine.coupling.analyses.condition_record import bearing_tones
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.drawing_process import EarlyPictures, early_pictures, one_process
from gearwhine.housing.modal_test import comparison_warnings
from gearwhine.mode_pictures import draw_load_pictures, draw_modes, draw_operating_shapes, draw_sound_pictures
from gearwhine.numerics.progress import Progress, silent
from gearwhine.output import staging
from gearwhine.output.checkpoints import stored_record
from gearwhine.output.files import MODE_CACHE_FILE
from gearwhine.output.quantity import Document, add_warnings, joined
from gearwhine.results.comparison import comparison_document, write_comparison
from gearwhine.results.gears import gears_document
from gearwhine.results.housing import modes_document, origin_document, write_shapes
from gearwhine.results.motion import leading_lines
from gearwhine.results.rotors import rotors_document
from gearwhine.results.run import SOUND_LEFT_OUT
from gearwhine.results.sound import sound_document
from gearwhine.solve.housing_modes import write_mode_cache
from gearwhine.solve.operating_shapes import highest_lines

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearwhine.studied_machine import StudiedMachine

_DRAWN_LINES = 6  # operating shapes of a run


class WholeRun:
    """Every analysis of a study: rotors, housing, load, gears, comparison, coupled modes, motion, sound.

    Parameters
    ----------
    study : StudiedMachine
    plan : TransientPlan or None
        Stretch of the motion over time; None for no motion.
    folder : path, optional
        Results folder in which the housing's modes and the blocks of the motion are stored before the results are
        written, so that a run that dies continues from there when it is started again.
    until_written : ExitStack, optional
        Closed by the caller when the results are written; the blocks are stored until then.
    pictures : bool
        Whether modes are to be drawn: a missing renderer then raises before the work, and the drawing process starts
        beside it.
    """

    def __init__(
        self,
        study: StudiedMachine,
        plan: TransientPlan | None,
        folder: Path | None = None,
        until_written: ExitStack | None = None,
        *,
        pictures: bool = False,
    ) -> None:
        study.require("run")
        if pictures and study.has_housing:
            _require_renderer()
        self.study, self.plan, self.folder, self.until_written = study, plan, folder, until_written
        self._pictures = pictures
        self._early: EarlyPictures | None = None
        self._has_early_figures = False
        if pictures and study.has_housing and until_written is not None:
            self._early = until_written.enter_context(early_pictures())
        self.document: Document = {"title": study.origin.title}
        self.solution = RunSolution()
        self.machine: MachineUnderLoad | None = None
        self._seconds: dict[str, float] = {}
        self._started = time.perf_counter()

    def result(self) -> Result[RunSolution]:
        """Make the analyses, and return their result.

        Raises
        ------
        CaseError, gearwhine.housing.HousingError, gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError
            Where an analysis cannot be made as the study stands.
        """
        analyses: tuple[tuple[str, Callable[[], Document | None]], ...] = (
            ("housing", self._solve_parts),
            ("rotors_and_gears", self._rotors),
            ("load", self._load),
            ("rotors_and_gears", self._gears),
            ("housing", self._housing),
            ("pictures", self._draw_early),
            ("system", self._system),
            ("transient", self._motion),
            ("sound", self._sound),
        )
        for name, analysis in analyses:
            begin = time.perf_counter()
            document = analysis()
            if document is not None:
                self.document = joined(self.document, document)
                self._seconds[name] = self._seconds.get(name, 0.0) + time.perf_counter() - begin
        if self.solution.transient is not None:
            self._seconds["time_stepping"] = self.solution.transient.result.seconds
        self.document["seconds"] = self._seconds | {"total": time.perf_counter() - self._started}
        files = partial(_write_files, self.solution, self.document, self.study.progress, self._early)
        return self.solution.result(
            "run",
            self.study.origin,
            self.document,
            _files=files,
            _figures_left=self._figures_left if self._has_early_figures else None,
            _started=self._started,
        )

    def _solve_parts(self) -> Document:
        """Solve the housing, and the rotors while that is meshed: where one of these fails, no modes are sought."""
        if self._early is not None:
            self._early.load_figures()
        study = self.study
        with ThreadPoolExecutor(1) as beside:
            rotors = beside.submit(copy_context().run, study.solved_rotors)
            housing = study.solved_housing(self.folder, with_sound=self._has_sound, before=rotors.result)
            self.solution = replace(self.solution, rotors=rotors.result(), housing=housing)
        return {}

    def _rotors(self) -> Document:
        return rotors_document(self.solution.rotors) if self.solution.rotors else {}

    def _load(self) -> Document:
        if self.study.has_machine:
            self.machine = self.study.under_load(self.plan)
            self.solution = replace(self.solution, load=self.machine.load)
        return {}

    def _gears(self) -> Document:
        self.solution = replace(self.solution, pairs=self.study.analysed_pairs(self.machine))
        return gears_document(self.solution.pairs) if self.solution.pairs else {}

    def _housing(self) -> Document:
        """Return the modes of the housing, and these beside measured ones."""
        housing = self.solution.housing
        if housing is None:
            return {}
        document = joined({"housing": modes_document(housing)}, origin_document(housing))
        compared = self.study.compared_modes(housing)
        if compared is not None:
            self.solution = replace(self.solution, comparison=compared.comparison)
            document["compare"] = comparison_document(compared.comparison, housing)
            add_warnings(document, comparison_warnings(compared.comparison, housing.modes, compared.test.modes))
        return document

    def _draw_early(self) -> None:
        """Have figures, modes that are shown in any case and the housing under load drawn beside other work."""
        solution, early = self.solution, self._early
        if early is None or solution.housing is None:
            return
        early.draw(draw_modes, solution.housing, solution.comparison, "dominant", "auto", "png", with_sheet=False)
        if solution.load is not None:
            early.draw(draw_load_pictures, solution.housing, solution.load)
        early.draw_figures(partial(solution.figures_before_motion, self.study.origin.title, silent))
        self._has_early_figures = True

    def _figures_left(self, progress: Progress) -> Iterator[tuple[str, Figure]]:
        """Draw the figures that were not drawn early, after these: one at a time takes the interpreter.

        The early ones go into the first folder that the results are written into: for a further one all are drawn.
        """
        title = self.study.origin.title
        if self._early is None or not self._has_early_figures:
            yield from self.solution.figures(title, progress)
            return
        self._has_early_figures = False
        self._early.wait()
        yield from self.solution.figures_of_motion(title, progress)

    def _system(self) -> Document | None:
        if self.machine is None:
            return None
        system, document = modes_of_run(self.machine, self.study.progress)
        self.solution = replace(self.solution, system=system)
        if self._early is not None and self._has_early_figures:
            self._early.draw_figures(partial(self.solution.figures_of_system, silent))
        return document

    def _motion(self) -> Document | None:
        machine, plan, system = self.machine, self.plan, self.solution.system
        if machine is None or plan is None or system is None:
            return None
        self._keep_modes()
        motion = self.study.motion(machine, plan, system.modes, keep=self._checkpoints())
        condition = condition_of(machine, motion)
        self.solution = self.solution.with_motion(motion, condition, bearing_tones(machine.loaded.machine))
        return motion_document(machine, motion, condition)

    def _keep_modes(self) -> None:
        """Cache the modes before the results, so that a long motion that is resumed need not solve them again."""
        housing = self.solution.housing
        if self.folder is None or housing is None or housing.source_holds:
            return
        with staging(self.folder) as place:
            write_mode_cache(place, housing)
        housing = replace(housing, source=self.folder / MODE_CACHE_FILE, source_holds=True)
        self.solution = replace(self.solution, housing=housing)

    def _checkpoints(self) -> Callable[[str], Any] | None:
        folder, until_written = self.folder, self.until_written
        if folder is None or until_written is None:
            return None
        stays = not self._pictures
        return lambda key: until_written.enter_context(stored_record(folder, key, fresh=self.study.fresh, stays=stays))

    @property
    def _has_sound(self) -> bool:
        return self.study.has_housing and self.study.settings.is_sound_in_run

    def _sound(self) -> Document | None:
        """Return the sound of the housing's modes and of the lines of the motion."""
        settings, housing = self.study.settings, self.solution.housing
        if settings.acoustics is None or housing is None:
            return None
        if not self._has_sound:
            return {"sound_not_solved": SOUND_LEFT_OUT}
        from gearwhine.coupling.sound.motion_lines import AUDIBLE, lines_of_run
        from gearwhine.coupling.sound.solution import with_histories
        from gearwhine.solve.kept_radiation import kept_radiation

        acoustics, field, progress = settings.acoustics, housing.displacement_field, self.study.progress
        transient, lines, left_out = self.solution.transient, None, []
        if transient is not None and not (left_out := self.study.left_out_of_sound(self.plan)):
            lines = lines_of_run(transient, acoustics.estimated_below_hz(field))
        machine = None if self.machine is None else self.machine.coupled
        sound, housing = self.study.solved_sound(acoustics, housing, lines, machine)
        # A moving base drives the housing beside its bearings.
        if transient is not None and sound.microphones and self.study.machine.base is None:
            between = AUDIBLE, sound.limit_hz
            transfer, housing = kept_radiation(acoustics, housing, sound.radiation, sound.places, between, progress)
            sound = with_histories(sound, transient, transfer)
        self.solution = replace(self.solution, sound=sound, housing=housing)
        document = {"sound": sound_document(sound)}
        add_warnings(document, [*left_out, *sound.warnings(), *self.study.doubts_of_acoustics(acoustics)])
        return document


def _write_files(
    solved: RunSolution,
    document: Document,
    progress: Progress,
    early: EarlyPictures | None,
    place: Path,
    *,
    pictures: bool,
) -> dict[str, Any]:
    """Write the mode shapes and the comparison of a run, and draw its pictures."""
    housing, comparison = solved.housing, solved.comparison
    if housing is None:
        return {}
    if comparison is not None:
        write_comparison(place, comparison)
    if pictures:
        _draw_pictures(solved, document, progress, early, place)
    write_shapes(place / "modes.vtu", housing)
    return {}


def _draw_pictures(
    solved: RunSolution, document: Document, progress: Progress, early: EarlyPictures | None, place: Path
) -> None:
    """Draw the pictures of a run that were not drawn early."""
    housing, comparison = solved.housing, solved.comparison
    if housing is None:
        return
    drawn = set() if early is None else early.move_to(place)
    with one_process():
        # The tables of lines name modes, and the report links their pictures.
        lines_told = leading_lines(document.get("sensors", ()), "peaks")
        named = {row["by_mode"] for row in lines_told if row["by_mode"] is not None}
        draw_modes(housing, comparison, "dominant", "auto", "png", place, progress, named, drawn=drawn)
        if solved.load is not None and "load-housing" not in drawn:
            draw_load_pictures(housing, solved.load, place, progress)
        if solved.sound is not None:
            draw_sound_pictures(solved.sound, place, progress, housing.up)
        if solved.transient is not None and solved.signature is not None:
            lines = highest_lines(solved.signature, solved.transient.trusted_limit, _DRAWN_LINES)
            if lines:
                draw_operating_shapes(housing, lines, "auto", "png", place, progress)


def _require_renderer() -> None:
    from gearwhine.housing.errors import RendererUnavailableError
    from gearwhine.housing.pictures.scene import find_renderer

    try:
        find_renderer()
    except RendererUnavailableError as error:
        raise RendererUnavailableError(f"{error}\nor do without pictures: --no-pictures") from error
