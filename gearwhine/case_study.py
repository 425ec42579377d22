"""Study of a case: a machine, its housing and its settings as a case file describes them, and the analyses of all."""

import json
import os
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Unpack

from gearwhine.commands import COMMANDS
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.settings import Settings
from gearwhine.study import AT_LEAST_ONE, NOT_NEGATIVE, Study, require_either
from gearwhine.study_folder import FolderOptions, StudyFolder
from gearwhine.view_names import GearPart, ModeFormat, View

if TYPE_CHECKING:
    from gearwhine.analyses.machine_results import MachineUnderLoad
    from gearwhine.analyses.origin import Origin
    from gearwhine.analyses.result import Result
    from gearwhine.case import Case, LoadedCase
    from gearwhine.coupling import CoupledMachine, Machine
    from gearwhine.coupling.analyses.gear_pairs import PairAnalysis
    from gearwhine.coupling.analyses.motion import MachineMotion
    from gearwhine.coupling.analyses.recording import TransientPlan
    from gearwhine.coupling.gears.loaded.optimal_relief import ReliefAim
    from gearwhine.coupling.linear.complex_modes import CoupledModes
    from gearwhine.coupling.load_analysis.influences import LoadSensitivity
    from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
    from gearwhine.coupling.machine.components import HousingComponent
    from gearwhine.coupling.sound import Acoustics
    from gearwhine.coupling.sound.motion_lines import MotionLines
    from gearwhine.coupling.sound.solution import SolvedSound
    from gearwhine.coupling.statics.operating_point import OperatingPoint
    from gearwhine.detection.detectability import DetectionResult
    from gearwhine.exchange.rexs.notes import Note
    from gearwhine.figures.rotors.assembly import RotorAssembly
    from gearwhine.housing import HousingModes
    from gearwhine.housing.correlation.comparison import Comparison
    from gearwhine.housing.modal_test import ComparedTest, PlannedSurvey
    from gearwhine.housing.reduced import ReducedHousing
    from gearwhine.meshes import Mesh
    from gearwhine.optimisation.optimised import Optimised
    from gearwhine.rotors.analyses.solved_rotor import SolvedRotor
    from gearwhine.solve.case_summary import CheckedCase
    from gearwhine.solve.updating import SolvedUpdate
    from gearwhine.sweep.grid import SweptPoint
    from gearwhine.sweep.points import Point
    from gearwhine.variation.statistics import VariedResult

# Tables of a case that some options of a command need besides.
_NEEDS_BESIDES = {"system --mesh-phase": ("gear_pair",), "simulate": ("transient",)}


def load(
    source: str | os.PathLike[str],
    changes: Mapping[str, object] | Sequence[str] = (),
    *,
    folder: str | os.PathLike[str] | None = None,
) -> "CaseStudy":
    """Read and check a case.

    Parameters
    ----------
    source : str or path
        Case file (TOML), name of a bundled case, or a gear unit in a REXS file.
    changes : mapping or sequence of str
        Keys and their new values, numbers, texts, lists or tables, ``{"housing.box.mesh_size": "20 mm"}``; or texts
        such as ``"housing.box.mesh_size=20 mm"``. An empty text removes a key.
    folder : path, optional
        Results folder, whose modes of the same housing are read in place of solving.

    Raises
    ------
    CaseError
        With everything that is wrong.
    """
    from gearwhine.case import load_case

    return CaseStudy(load_case(os.fspath(source), _texts(changes)), folder=None if folder is None else Path(folder))


def build(folder: str | os.PathLike[str] = ".", /, **tables: object) -> "CaseStudy":
    """Check a case given as Python objects in place of a file.

    Parameters
    ----------
    folder : path
        Folder in which relative file names start.
    **tables
        The tables of a case: dictionaries with the keys of a case file, or the classes of :mod:`gearwhine.case`.
        Quantities are numbers in SI or texts with units.

    Raises
    ------
    CaseError
        With everything that is wrong, in the words of the case reader.

    Examples
    --------
    >>> import gearwhine as gw
    >>> study = gw.build(
    ...     material={"steel": {"youngs_modulus": 207e9, "poisson_ratio": 0.3, "density": 7850.0}},
    ...     rotor=[
    ...         {
    ...             "name": "shaft",
    ...             "material": "steel",
    ...             "segments": [{"length": "500 mm", "diameter": "30 mm"}],
    ...         }
    ...     ],
    ...     bearing=[
    ...         {"name": name, "rotor": "shaft", "at": at, "seat": "ground", "stiffness": {"xx": 1e8, "yy": 1e8}}
    ...         for name, at in (("left", "20 mm"), ("right", "480 mm"))
    ...     ],
    ... )
    >>> round(study.rotors().document["rotors"][0]["mass_kg"], 4)
    2.7744
    """
    from gearwhine.case import CaseSource

    return CaseStudy(CaseSource({name: _plain(table) for name, table in tables.items()}, Path(folder)).changed())


@dataclass
class _KeptHousing:
    """The solved housing that studies share; None until one of them needs it, whose thread holds the lock."""

    solved: "HousingModes | None" = None
    lock: threading.RLock = field(default_factory=threading.RLock)


class CaseStudy(Study):
    """A checked case and its analyses: a study of the machine that the case describes, with the case's settings.

    The housing is meshed and solved once, by the first analysis that needs its modes, and held by the study. Threads
    may share a study: who needs the housing while another thread solves it waits.

    Parameters
    ----------
    loaded : LoadedCase
    progress : callable
        Receives the progress of long work in words; silent by default.
    folder : path, optional
        Results folder, whose modes of the same housing are read in place of solving.
    fresh : bool
        Whether to solve again what that folder holds.

    Attributes
    ----------
    case : Case
        Checked case, in SI.
    folder : path or None
        Results folder that modes are read from.
    """

    def __init__(
        self, loaded: "LoadedCase", progress: Progress = silent, *, folder: Path | None = None, fresh: bool = False
    ) -> None:
        self.case: Case = loaded.case
        self._warnings = loaded.warnings
        self._source = loaded.source
        self._kept = _KeptHousing()
        self._described: Machine | None = None
        self.folder, self._is_fresh = folder, fresh
        self._start(progress)

    def __repr__(self) -> str:
        """Return the case's title."""
        return f"<Study of {self.case.title or 'an untitled case'!r}>"

    def _repr_html_(self) -> str:
        from gearwhine.notebook import case_html

        return case_html(self.case)

    def changed(self, changes: Mapping[str, object] | Sequence[str]) -> "CaseStudy":
        """Return a study of the same case with other values of some keys; this one stays as it is.

        The case is the one that was read: neither its file nor those that it names are read again, and one that has
        changed before it was needed, such as that of a mesh, is refused. Both studies share one solved housing, where
        its modes, damping, seats and sensors stay as they are. Changes of torque, gears, bearing stiffness and preload
        leave them so; a change of a bearing's position does not.

        Parameters
        ----------
        changes : mapping or sequence of str
            As of :func:`load`.

        Raises
        ------
        CaseError
            With everything that is wrong.
        """
        study = CaseStudy(self._source.changed(_texts(changes)), self.progress, folder=self.folder, fresh=self.fresh)
        if self.case.housing is not None and study.case.housing is not None:
            from gearwhine.from_case.given_housing import given_housing, housing_key

            given, changed = given_housing(self.case), given_housing(study.case)
            # The pictures of a housing stand upright by what is up, which no machine takes.
            if housing_key(given) == housing_key(changed) and given.up == changed.up:
                study._kept = self._kept
        return study

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on choices of the case that are allowed and unlikely."""
        return self._warnings

    @property
    def housing(self) -> "HousingModes | None":
        """The solved housing, which the first call meshes and solves; None in a case without one."""
        return self.solved_housing()

    @cached_property
    def _reduced_housing(self) -> "ReducedHousing | None":
        """Description of the housing of reduced matrices; None in a case without one."""
        from gearwhine.from_case.reduced_housing import build_reduced_housing

        table = self.case.reduced_housing
        return None if table is None else build_reduced_housing(table, self.case.input_files)

    @cached_property
    def _reduced(self) -> "HousingComponent | None":
        """The housing of reduced matrices; None in a case without one."""
        from gearwhine.from_case.reduced_housing import reduced_component

        return reduced_component(self.case.reduced_housing, self.case.input_files)

    @property
    def machine(self) -> "Machine":
        """The shafts, gears, bearings and gear pairs of the case as one object, with all that loads it.

        It stands in the solved housing of the case.
        """
        from gearwhine.from_case.machine import describe_machine

        with self._lock:
            if self._described is None:
                self._described = describe_machine(self.case, self.housing or self._reduced)
            return self._described

    @property
    def settings(self) -> Settings:
        """Title, transient and speeds of the case: `gw.Study(study.machine, study.settings)` analyses its machine."""
        from gearwhine.case.analysis_speeds import with_sense_of
        from gearwhine.solve.acoustics import acoustics_of
        from gearwhine.solve.machine import plan_of, tracking_of

        case = self.case
        plan = None if case.transient is None else plan_of(case)
        speeds = () if case.sweep is None else with_sense_of(case.operation, case.sweep.speeds)
        acoustics, in_run = None, None
        if case.acoustics is not None:
            acoustics, in_run = acoustics_of(case), case.acoustics.in_run
        return Settings(case.title, plan, tracking_of(case.transient), speeds, acoustics, in_run)

    def check(self) -> "Result[CheckedCase]":
        """Check the case and show speeds, mesh frequencies, torques and sizes; solve nothing.

        Raises
        ------
        CaseError, gearwhine.housing.HousingError, gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError
            Where something in the case cannot be built.
        """
        from gearwhine.analyses.result import Result
        from gearwhine.output.quantity import document_of
        from gearwhine.results.check import CHECK
        from gearwhine.solve.case_summary import check_case

        warnings = list[ResultWarning]()
        if self.case.variation is not None:
            from gearwhine.analyses.variation_result import plan_variation
            from gearwhine.results.variation import runout_twice_warnings

            inputs, _ = plan_variation(self.case, self._source)
            warnings = list(runout_twice_warnings(inputs, self.case.gear))
        if self.case.detection is not None:
            from gearwhine.analyses.detection_result import plan_detection

            plan_detection(self._source)
        if self.case.optimisation is not None:
            from gearwhine.analyses.optimisation_result import plan_optimisation
            from gearwhine.optimisation.design import alone_warnings

            designed, *_ = plan_optimisation(self._source, self.case.optimisation)
            warnings += alone_warnings(self._source.without("variation", "optimisation"), designed)
        checked = check_case(self.case, self.progress, self._source.imported)
        checked.warnings.extend(warnings)
        return Result("check", self.case, checked, document_of(CHECK, checked))

    def mesh(self, suffix: Literal["msh", "vtu", "vtk", "inp", "med", "xdmf"] = "msh") -> "Result[Mesh]":
        """Mesh the housing.

        Parameters
        ----------
        suffix : {"msh", "vtu", "vtk", "inp", "med", "xdmf"}
            Format of the mesh file.

        Raises
        ------
        CaseError
            Where the housing cannot be meshed.
        """
        from gearwhine.analyses import housing

        return housing.mesh(self.case, suffix=suffix, progress=self.progress)

    def modes(self, *, detail: bool = False) -> "Result[HousingModes] | Result[ReducedHousing]":
        """Natural modes of the housing, certified complete, with checks of the model.

        Of a housing of reduced matrices the modes of these, with what is proved of them.

        Parameters
        ----------
        detail : bool
            Also show effective masses, support reactions, and the modes dominant between bearings and sensors.

        Raises
        ------
        CaseError, gearwhine.housing.HousingError
            Where the case cannot be solved as it stands.
        gearwhine.housing.IncompleteModesError, gearwhine.housing.ReductionError, gearwhine.housing.HealthError
            Where the modes fail their proofs.
        """
        from gearwhine.analyses.housing import modes_result

        if (reduced := self._reduced_housing) is not None:
            from gearwhine.analyses.reduced_housing import reduced_modes_result

            return reduced_modes_result(reduced, self.origin)
        return modes_result(self.required_housing("modes"), self.origin, detail=detail)

    def compare(  # type: ignore[override]  # a case has its measured modes
        self,
    ) -> "Result[Comparison]":
        """Compare the housing's modes with measured ones: frequencies, MAC, frequency responses.

        Raises
        ------
        CaseError, gearwhine.housing.HousingError
            Where the case has nothing measured, or its modes are not known as high as the measured ones.
        """
        from gearwhine.analyses.housing import compare_result
        from gearwhine.case.model import measured_table
        from gearwhine.solve.comparison import compare_measured, require_comparable

        measured = measured_table(self.case, "compare")
        if (reduced := self._reduced_housing) is not None:
            from gearwhine.analyses.reduced_housing import reduced_compare_result
            from gearwhine.housing.reduced_modal_test import compare_reduced
            from gearwhine.solve.comparison import modal_test_of, refused_by_key

            test = modal_test_of(measured, self.progress)
            with refused_by_key():
                compared = compare_reduced(reduced, test)
            return reduced_compare_result(reduced, compared, test.modes, self.origin)
        require_comparable(measured, self.case.housing)
        housing = self.required_housing("compare")
        compared = compare_measured(measured, housing, self.progress, with_responses=True)
        return compare_result(housing, compared, self.origin)

    def survey(
        self, sensors: Annotated[int | None, AT_LEAST_ONE] = None, modes: Annotated[int | None, AT_LEAST_ONE] = None
    ) -> "Result[PlannedSurvey]":
        """Plan a modal survey: sensor and hammer positions, as files.

        Parameters
        ----------
        sensors : int, optional
            Number of sensors, each normal to the surface (default: three for two modes).
        modes : int, optional
            Number of lowest modes to survey (default: all known).

        Raises
        ------
        CaseError
            Where the sensors cannot separate the modes.
        """
        from gearwhine.case import CaseError, Problem
        from gearwhine.housing import HousingError

        _ = self.required_housing("survey")  # whose errors are its own
        try:
            return super().survey(sensors, modes)
        except HousingError as error:
            raise CaseError(
                [Problem("--sensors", str(sensors), f"sensors that tell the modes apart, or fewer --modes; {error}")]
            ) from error

    def update(self, *, null: Annotated[int, NOT_NEGATIVE] = 0, held_back: bool = False) -> "Result[SolvedUpdate]":
        """Fit the parameters of [update] to the measured modes, and write the case with them as updated.toml.

        Parameters
        ----------
        null : int
            Number of random frequency sets to fit as well; their fits are the null hypothesis.
        held_back : bool
            Also leave out each measured mode in turn and predict it.

        Raises
        ------
        CaseError, gearwhine.housing.HousingError
            Where the case has nothing to fit, or its housing cannot be solved.
        """
        from gearwhine.analyses import housing

        return housing.update(self.case, null=null, held_back=held_back, progress=self.progress)

    def render(
        self,
        modes: str | None = None,
        *,
        line: Sequence[float] = (),
        measured: bool = False,
        view: View = "auto",
        mode_format: ModeFormat = "png",
    ) -> "Result[HousingModes]":
        """Draw mode shapes, operating shapes or measured shapes.

        Parameters
        ----------
        modes : str, optional
            Modes to draw: 'dominant' (default without lines and measured shapes), 'all', '1,4,9' or '1-6'.
        line : sequence of float
            Draw the operating shape at the line, nearest to a frequency [Hz], of the run in the results folder. May be
            repeated.
        measured : bool
            Draw measured shapes beside the model's.
        view : str
            Direction of view; 'auto': for each shape the corner from which most of its motion is seen.
        mode_format : {"png", "glb", "gif", "mp4"}
            Picture, animated glTF model, or film (MP4 needs ffmpeg).

        Raises
        ------
        CaseError
            Where something is asked for that cannot be drawn.
        gearwhine.housing.errors.RendererUnavailableError, gearwhine.housing.errors.EncoderUnavailableError
            Where no renderer or encoder is available.
        """
        from gearwhine.analyses import housing
        from gearwhine.case import CaseError, Problem
        from gearwhine.case.model import measured_table
        from gearwhine.housing import HousingError
        from gearwhine.mode_pictures import check_request, require_survey
        from gearwhine.solve.comparison import require_comparable

        if line and self.folder is None:
            expected = "the results folder of a run, such as `gearwhine.load(case, folder=...)`"
            raise CaseError([Problem("render: line", list(line), expected)])
        modes = modes or (None if line or measured else "dominant")
        if measured:
            require_survey(measured_table(self.case, "render --measured"))
            require_comparable(self.case.measured, self.case.housing)
        check_request(modes, mode_format, line)
        solved, compared = self.required_housing("render"), None
        try:
            compared = self.compared_modes(solved)
        except (CaseError, HousingError):
            if measured:
                raise  # else the modes are drawn without their measured partners
        return housing.render(
            solved,
            self.origin,
            modes,
            view=view,
            mode_format=mode_format,
            compared=compared,
            lines=line,
            measured=measured,
            folder=self.folder,
            progress=self.progress,
        )

    def rotors(self, *, write_ross: bool = False, **settings: Any) -> "Result[tuple[SolvedRotor, ...]]":
        """Lateral and torsional modes, whirl and critical speeds of each rotor; CASE may be a rotor saved by ROSS.

        Parameters
        ----------
        write_ross : bool
            Also write each rotor with its bearings as a file that ROSS loads.
        **settings
            Attributes of :class:`gearwhine.rotors.analyses.solved_rotor.RotorSettings` in place of those of the case.

        Raises
        ------
        CaseError, gearwhine.rotors.RotorError
            Where the case has no rotors, or one cannot be solved as it stands.
        gearwhine.rotors.IncompleteModesError
            Where modes fail their certificate.
        """
        from gearwhine.analyses.machine_results import rotors_result
        from gearwhine.solve.rotors import write_ross_files

        self.require("rotors")
        solved = self.solved_rotors(**settings)

        def assemblies() -> "list[RotorAssembly]":
            from gearwhine.figures.rotors import rotor_assembly

            return [rotor_assembly(self.case, one.rotor, one.bearings) for one in solved]

        def ross_files(place: Path, *, pictures: bool) -> dict[str, Any]:
            return {"warnings": [warning("ross", remark) for remark in write_ross_files(place, solved)]}

        carriers = {rotor.name: rotor.carrier for rotor in self.case.rotor if rotor.carrier is not None}
        result = rotors_result(solved, self.origin, assemblies, carriers)
        return replace(result, _files=ross_files) if write_ross else result

    def gears(
        self, aims: "Sequence[ReliefAim]" = (), *, without: Sequence[GearPart] = ()
    ) -> "Result[tuple[PairAnalysis, ...]]":
        """Gear pairs: geometry, mesh stiffness, transmission error, load sharing, contact pressure, optimal tip relief.

        The housing is solved for a tip relief whose aim names a sensor. Else it takes part where it is solved already,
        or the results folder keeps its modes; without one a misalignment that is found is that of rigid seats, with a
        warning, and the best relief aims at no sensor.

        Parameters
        ----------
        aims : sequence of ReliefAim, optional
            Objective of the best relief of each pair, in place of those of the case.
        without : sequence of {"harris-map", "relief"}
            What to leave out: the Harris maps, or the search for the best tip relief, which takes most of the time.

        Raises
        ------
        CaseError, gearwhine.coupling.gears.GearError, gearwhine.coupling.CouplingError
            Where the case has no gear pairs, or one cannot be solved as it stands, or in the machine where a tip relief
            aims at a sensor.
        """
        from gearwhine.analyses.machine_results import gears_result, require_aims, require_parts
        from gearwhine.solve.gear_pairs import analyse_pairs, relief_aims
        from gearwhine.solve.machine import solve_pairs

        case, progress = self.case, self.progress
        self.require("gears")
        require_parts(without, aims)
        housing = self._housing_of_gears(for_relief="relief" not in without and not aims)
        loaded, point = solve_pairs(case, housing or self._reduced, progress)
        analysed = analyse_pairs(case, loaded, point)
        if aims:
            require_aims(aims, len(analysed))
            analysed = tuple(replace(pair, aim_given=True) for pair in analysed)
        elif "relief" not in without:
            aims = relief_aims(case, loaded, progress, point=point, housing=housing)
        is_housed = housing is not None or self._reduced is not None
        has_seats = case.housing is not None or case.reduced_housing is not None
        seats = None if point is None or not has_seats else "housing" if is_housed else "rigid"
        return gears_result(analysed, aims, without, self.origin, seats, progress)

    def _housing_of_gears(self, *, for_relief: bool) -> "HousingModes | None":
        """Return the housing where it takes part in the analysis of gear pairs or in the aims of their reliefs."""
        from gearwhine.solve.gear_pairs import aims_at_sensor
        from gearwhine.solve.housing_modes import kept_housing

        case = self.case
        if case.housing is None or not case.rotor or case.operation is None:
            return None
        if for_relief and aims_at_sensor(case.gear_pair):
            return self.housing
        finds_misalignment = any(case.parts.finds_misalignment(pair) for pair in case.gear_pair)
        takes_part = finds_misalignment or (for_relief and bool(case.housing.sensor))
        with self._kept.lock:
            if self._kept.solved is None and takes_part and not self.fresh:
                self._kept.solved = kept_housing(case, self.folder, self.progress)
            return self._kept.solved

    def sound(self, acoustics: "Acoustics | None" = None, /, **settings: Any) -> "Result[SolvedSound]":
        """Sound power, radiation efficiency and sound pressure of the housing's modes and of the steady motion's lines.

        Without rotors and an operation the sound is that of the modes alone.

        Parameters
        ----------
        acoustics : Acoustics, optional
            Method and medium, floor and microphones, in place of those of `[acoustics]`; or its attributes by name. A
            case without them has boundary elements in free air.
        **settings
            See :class:`gearwhine.coupling.sound.Acoustics`.

        Raises
        ------
        CaseError, gearwhine.coupling.CouplingError, gearwhine.coupling.PeriodicError
            Where the parts do not make a machine, no periodic motion is found, or the housing cannot be wrapped.
        gearwhine.housing.HousingError
            Where the power through the surface and in the far field differ by more than 10 %, or a known source inside
            is lost at a vertex of the surface.
        """
        from gearwhine.analyses.machine_results import sound_result
        from gearwhine.coupling.sound import Acoustics

        # The checks of the surface are for this analysis alone.
        from gearwhine.coupling.sound.acoustics_checks import require_acoustics
        from gearwhine.solve.acoustics import acoustics_of, refused_by_key

        require_either("sound", "an Acoustics", acoustics, settings)
        self.require("sound")
        given = Acoustics(**settings) if settings else acoustics
        housing = self.required_housing("sound", with_sound=given is None)
        field = housing.displacement_field
        if given is not None:
            require_acoustics(given, field.mesh, field.widest_bore, given.limit_hz(field))
        chosen = given or acoustics_of(self.case)
        warnings, machine = self.doubts_of_acoustics(chosen), None
        if self.has_machine:
            left_out = self.left_out_of_sound(None)
            machine = None if left_out else self.under_load()
            warnings = [*left_out, *warnings]
        with refused_by_key(chosen) if given is None else nullcontext():
            return sound_result(housing, chosen, self.origin, machine, warnings, self.progress)

    def sweep(  # type: ignore[override]  # a case is swept over its keys, with files and workers
        self, over: Sequence[str] = (), **options: Unpack[FolderOptions]
    ) -> "Result[Sequence[SweptPoint[Point]]]":
        """Parallel transients over the speeds of [sweep] or over any keys; a sweep in the same folder is resumed.

        Parameters
        ----------
        over : sequence of str
            Vary a key: key.path=from:to:n or key.path=a,b,c, such as operation.torque='10 N*m:100 N*m:10'. Repeated,
            the keys and the speeds of [sweep] form a grid.
        **options
            See :class:`gearwhine.study_folder.FolderOptions`.

        Raises
        ------
        CaseError
            Where a key cannot be swept.
        gearwhine.failures.WorkersError
            Where the processes do not start.
        """
        from gearwhine.analyses.sweep_result import solve_sweep
        from gearwhine.case import swept_keys

        return solve_sweep(self.origin, self._source, swept_keys(self.case, over), self._study_folder(**options))

    def vary(  # type: ignore[override]  # a case has distributions of its keys
        self,
        samples: Annotated[int | None, AT_LEAST_ONE] = None,
        *,
        indices: bool = False,
        widen: float | None = None,
        seed: Annotated[int | None, NOT_NEGATIVE] = None,
        **options: Unpack[FolderOptions],
    ) -> "Result[VariedResult]":
        """Many gearboxes as production makes them, by the distributions of [variation]: scatter, causes and yield.

        A study in the same folder is resumed, with more gearboxes, too.

        Parameters
        ----------
        samples : int, optional
            Number of gearboxes (default: that of [variation]).
        indices : bool
            Find Sobol' indices, the parts of the variance by each input, with their intervals. Of d inputs and n
            samples, n (d + 2) gearboxes are solved.
        widen : float, optional
            Factor by which the distribution of each input in turn is made wider, to tell what it costs in yield; 1.4 is
            a class of ISO 1328. Of d inputs and n samples, n (d + 1) gearboxes are solved.
        seed : int, optional
            Seed of the samples (default: that of [variation]).
        **options
            See :class:`gearwhine.study_folder.FolderOptions`.

        Raises
        ------
        CaseError
            Where a key cannot be varied, or a distribution or a limit cannot be.
        gearwhine.failures.WorkersError
            Where the processes do not start.
        """
        from gearwhine.analyses.variation_result import solve_variation

        return solve_variation(
            self.case,
            self._source,
            self._study_folder(**options),
            samples=samples,
            indices=indices,
            widen=widen,
            seed=seed,
        )

    def detect(  # type: ignore[override]  # a case has its fault under [detection]
        self, **options: Unpack[FolderOptions]
    ) -> "Result[DetectionResult]":
        """Which sensor sees the fault of [detection] by which indicator, and from which size on, with what probability.

        Healthy gearboxes give the threshold, those with the fault the probability of detection.

        A study in the same folder is resumed, with more sizes or another noise, too.

        Parameters
        ----------
        **options
            See :class:`gearwhine.study_folder.FolderOptions`.

        Raises
        ------
        CaseError
            Where the case has no such fault or sensor, a size is beyond what the model allows, the record holds too few
            turns, or there are too few healthy gearboxes for the false-alarm rate.
        gearwhine.coupling.CouplingError
            Where the gearbox without the fault has no record.
        gearwhine.failures.WorkersError
            Where the processes do not start.
        """
        from gearwhine.analyses.detection_result import solve_detection

        return solve_detection(self._source, self._study_folder(**options))

    def optimise(  # type: ignore[override]  # a case has ranges of its keys
        self,
        evaluations: Annotated[int | None, AT_LEAST_ONE] = None,
        *,
        method: Literal["search", "grid"] | None = None,
        seed: Annotated[int | None, NOT_NEGATIVE] = None,
        **options: Unpack[FolderOptions],
    ) -> "Result[Optimised]":
        """Which design is best, by the keys, aims and limits of [optimisation]; several aims have a Pareto front.

        A search in the same folder takes the designs that it holds already. The transient checks the proposed ones.

        Parameters
        ----------
        evaluations : int, optional
            Largest number of designs that a search tries (default: that of [optimisation]).
        method : {"search", "grid"}, optional
            Search, or every combination of values and levels (default: that of [optimisation]).
        seed : int, optional
            Seed of the search (default: that of [optimisation]).
        **options
            See :class:`gearwhine.study_folder.FolderOptions`.

        Raises
        ------
        CaseError
            Where a key cannot be designed, or an aim, a limit or a range cannot be.
        gearwhine.failures.MissingExtraError
            Where several aims need a package that is not installed.
        gearwhine.failures.WorkersError
            Where the processes do not start.
        """
        from gearwhine.analyses.optimisation_result import solve_optimisation

        return solve_optimisation(
            self._source,
            self._study_folder(**options),
            evaluations=evaluations,
            method=method,
            seed=seed,
        )

    def export_rexs(
        self, file: str | os.PathLike[str], folder: str | os.PathLike[str] | None = None
    ) -> "tuple[Note, ...]":
        """Write the gear unit as a REXS file; see :func:`gearwhine.results_folder.export_rexs`.

        Parameters
        ----------
        file : path
            File to write, which ends in ``.rexs``.
        folder : path, optional
            Results folder whose operating point becomes a load case.

        Returns
        -------
        tuple of Note
            What is changed or left out.
        """
        from gearwhine.exchange.rexs.notes import Note
        from gearwhine.results_folder import export_rexs

        document = export_rexs(self.case, Path(file), None if folder is None else Path(folder))
        return tuple(Note(**note) for note in document["rexs"]["notes"])

    def export_reduced(self, file: str | os.PathLike[str]) -> dict[str, Any]:
        """Write the housing as reduced matrices; see :func:`gearwhine.results_folder.export_reduced`.

        Parameters
        ----------
        file : path
            File to write, which ends in ``.npz``, ``.nc``, ``.pch``, ``.op4`` or ``.mtx``.

        Returns
        -------
        dict
            ``files``, and ``reduced`` with the order and the nodes of seats and sensors.
        """
        from gearwhine.coupling.machine.components import component_of_housing
        from gearwhine.results_folder import export_reduced, refuse_target

        refuse_target(Path(file))
        housing = self.required_housing("export --reduced")
        component = component_of_housing(housing, participates=False, with_coarser=False)
        return export_reduced(self.case.title, component, Path(file))

    def _study_folder(
        self,
        *,
        folder: str | os.PathLike[str],
        workers: int | None = None,
        scheduler: str | None = None,
        fresh: bool = False,
    ) -> StudyFolder:
        return StudyFolder(Path(folder), workers, scheduler, fresh or self.fresh, self.progress)

    # What the analyses of a machine ask of its study, as the case has it.

    @property
    def origin(self) -> "Origin":
        """What the results are of; results with the housing have that beside it."""
        from gearwhine.analyses.origin import Origin

        return Origin(self.case.title, case=self.case)

    @property
    def fresh(self) -> bool:
        """Whether to solve again what a results folder holds."""
        return self._is_fresh

    @property
    def has_housing(self) -> bool:
        """Whether the case has a housing."""
        return self.case.housing is not None

    @property
    def has_machine(self) -> bool:
        """Whether the case has rotors and an operation."""
        return bool(self.case.rotor) and self.case.operation is not None

    def require(self, command: str) -> None:
        """Refuse a command that the case does not allow, before anything is solved."""
        from gearwhine.case import CaseError, Problem, require
        from gearwhine.solve.comparison import require_comparable

        needs = (*COMMANDS[command.partition(" ")[0]].needs, *_NEEDS_BESIDES.get(command, ()))
        require(self.case, *needs, command=command)
        operation = self.case.operation
        if command == "run":
            if self.case.transient is not None:
                require(self.case, "rotor", "operation", command="run")
            require_comparable(self.case.measured, self.case.housing)
        if command == "load" and not self.case.parts.is_loaded:
            expected = "a torque, a force or gravity, which load the shafts, or a preload of rolling bearings"
            raise CaseError([Problem("operation.torque", 0.0, expected)])
        if command == "steady" and operation is not None and operation.speed == 0.0:
            raise CaseError([Problem("operation.speed", 0.0, "a speed: what stands still has no motion that repeats")])
        if command not in ("rotors", "gears"):
            _ = self.case.parts.machine  # parts that do not make a machine are refused

    def solved_rotors(self, **settings: Any) -> "tuple[SolvedRotor, ...]":
        """Solve each rotor with the settings of `[rotor_analysis]`; none in a case without rotors."""
        from gearwhine.solve.rotors import solve_rotors

        return solve_rotors(self.case, self.progress, **settings) if self.case.rotor else ()

    def solved_housing(
        self, folder: Path | None = None, *, with_sound: bool = False, before: Callable[[], object] | None = None
    ) -> "HousingModes | None":
        """Return the solved housing; where its sound is wanted, what is wrong with `[acoustics]` is refused before."""
        return None if self.case.housing is None else self.required_housing("modes", folder, with_sound, before)

    def required_housing(
        self,
        command: str,
        folder: Path | None = None,
        with_sound: bool = False,
        before: Callable[[], object] | None = None,
    ) -> "HousingModes":
        """Return the solved housing; a case without one is refused in the name of a command."""
        from gearwhine.solve.acoustics import check_before_modes
        from gearwhine.solve.housing_modes import solve_housing

        refuse = check_before_modes(self.case.acoustics, self.case.housing) if with_sound else None

        def check(mesh: "Mesh") -> None:
            if before is not None:
                before()
            if refuse is not None:
                refuse(mesh)

        with self._kept.lock:
            if self._kept.solved is None:
                place = folder or self.folder
                self._kept.solved = solve_housing(
                    self.case, self.progress, command=command, folder=place, fresh=self.fresh, before=check
                )
            else:
                check(self._kept.solved.mesh)
            return self._kept.solved

    def compared_modes(self, housing: "HousingModes") -> "ComparedTest | None":
        """Compare the modes of the housing with those of `[measured]`; None without."""
        from gearwhine.solve.comparison import compare_measured

        measured = self.case.measured
        return None if measured is None else compare_measured(measured, housing, self.progress)

    def found_load(self) -> "tuple[SolvedLoad | None, Sequence[ResultWarning]]":
        """Find the operating point; where the case does not need one that is not found, a warning gives the reason."""
        from gearwhine.solve.machine import load_of_case

        return load_of_case(self.case.parts, self.machine, self.progress)

    @property
    def aligned_by_default(self) -> "Sequence[str]":
        """Labels of the pairs whose misalignment the case leaves out, and no operating point has."""
        from gearwhine.from_case.machine import aligned_by_default

        return aligned_by_default(self.case.parts)

    def on_rigid_seats(self) -> "Machine":
        """Return the machine without its housing, which is not solved for it."""
        from gearwhine.from_case.machine import describe_machine

        return describe_machine(self.case)

    def ranked_parts(self, machine: "Machine", point: "OperatingPoint", line: str | None) -> "LoadSensitivity":
        """Rank the parts of the machine; a line that there is not is refused by its option."""
        from gearwhine.case import CaseError, Problem
        from gearwhine.coupling.load_analysis.ranking import UnknownLineError, solve_load_sensitivity
        from gearwhine.solve.acoustics import acoustics_of, refused_by_key
        from gearwhine.solve.machine import run_of
        from gearwhine.solve.sensitivity.housing_changes import housing_changes

        housing = self.housing if machine.housing is not None else None
        changes, note = ((), None) if housing is None else housing_changes(self.case, housing.mesh)
        acoustics = acoustics_of(self.case)
        try:
            with refused_by_key(acoustics):
                return solve_load_sensitivity(
                    machine,
                    point,
                    housing,
                    changes,
                    acoustics=None if self.case.acoustics is None else acoustics,
                    run=run_of(self.case.transient),
                    line=line,
                    note=note,
                    progress=self.progress,
                )
        except UnknownLineError as error:
            raise CaseError([Problem("--line", error.line, error.expected)]) from error

    def doubts_of_acoustics(self, acoustics: "Acoustics") -> "list[ResultWarning]":
        """Return warnings of unlikely numbers of acoustics that are not the case's, which has its own."""
        return [] if acoustics == self.settings.acoustics else super().doubts_of_acoustics(acoustics)

    def solved_sound(
        self,
        acoustics: "Acoustics",
        housing: "HousingModes",
        lines: "MotionLines | None",
        machine: "CoupledMachine | None",
    ) -> "tuple[SolvedSound, HousingModes]":
        """Solve the sound; acoustics that do not fit the housing are refused by their keys."""
        from gearwhine.solve.acoustics import refused_by_key

        with refused_by_key(acoustics):
            return super().solved_sound(acoustics, housing, lines, machine)

    def analysed_pairs(self, machine: "MachineUnderLoad | None") -> "tuple[PairAnalysis, ...]":
        """Analyse each gear pair as it stands in the machine under load, or alone."""
        from gearwhine.from_case.machine import solve_gears
        from gearwhine.solve.gear_pairs import analyse_pairs

        if machine is None:
            return analyse_pairs(self.case, solve_gears(self.case.parts, self.progress)) if self.case.gear_pair else ()
        return analyse_pairs(self.case, machine.loaded.pairs, None if machine.load is None else machine.load.point)

    def motion(
        self,
        machine: "MachineUnderLoad",
        plan: "TransientPlan",
        modes: "CoupledModes",
        keep: Callable[[str], Any] | None = None,
    ) -> "MachineMotion":
        """Integrate the motion; under a load that no tooth bears the case is refused in place of the integration."""
        from gearwhine.case.checks.plausible import overload
        from gearwhine.coupling.errors import TransientError

        try:
            return super().motion(machine, plan, modes, keep)
        except TransientError as error:
            # Under such a load the advice of the integration is beside the point.
            if overloaded := overload(self.case):
                raise TransientError(f"{overloaded}; no motion under this load is found") from error
            raise

    def _assumed_mesh_damping(self) -> tuple[str, ...]:
        from gearwhine.solve.damping import assumed_mesh_damping

        return assumed_mesh_damping(self.case.gear_pair)

    def _no_speeds(self, attribute: str, expected: str) -> Exception:
        from gearwhine.case import CaseError, Problem
        from gearwhine.case.errors import UNSAID

        key = {"speed": "operation.speed", "speeds": "sweep.speed", "bearings": "bearing"}[attribute]
        return CaseError([Problem(key, UNSAID, expected)])


def _texts(changes: Mapping[str, object] | Sequence[str]) -> tuple[str, ...]:
    """Return changes of keys as ``key=value``."""
    if isinstance(changes, Mapping):
        return tuple(f"{key}={_text(value)}" for key, value in changes.items())
    return tuple(changes)


def _text(value: object) -> str:
    """Return a value as it stands behind ``--set KEY=``, where a text needs no quotes."""
    return value if isinstance(value, str) else _toml(value)


def _toml(value: object) -> str:
    """Return a value in TOML, on one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{json.dumps(key)} = {_toml(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, str):
        return json.dumps(value)
    return str(value).lower() if isinstance(value, bool) else str(value)


def _plain(value: object) -> object:
    """Return a table as plain dictionaries and lists, as TOML gives it."""
    from pydantic import BaseModel

    if isinstance(value, BaseModel):
        return value.model_dump(exclude_unset=True, by_alias=True)
    if isinstance(value, Mapping):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    return value
