"""Study: a case and its analyses, each a call that returns a labelled result."""

from __future__ import annotations

import json
import math
import os
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.case import Case, CaseSource, LoadedCase, load_case
from gearwhine.numerics.findings import Instance, Number, Numbers, Rule, attribute_findings, refuse
from gearwhine.numerics.own_copies import keep_tuples
from gearwhine.numerics.progress import Progress, silent

if TYPE_CHECKING:
    from gearwhine.analyses.case import Format
    from gearwhine.analyses.of_machine import MachineUnderLoad
    from gearwhine.analyses.result import Result
    from gearwhine.analyses.run_solution import RunSolution
    from gearwhine.coupling import Machine
    from gearwhine.coupling.analyses.gear_pairs import PairAnalysis
    from gearwhine.coupling.analyses.modes_and_responses import SolvedSystem
    from gearwhine.coupling.analyses.recording import TransientPlan
    from gearwhine.coupling.analyses.run_up import OrderTracking
    from gearwhine.coupling.analyses.steady_state import SolvedSteady
    from gearwhine.coupling.gears.loaded.optimal_relief import ReliefAim
    from gearwhine.coupling.sound import Acoustics
    from gearwhine.coupling.sound.solution import SolvedSound
    from gearwhine.housing.correlation.comparison import Comparison
    from gearwhine.meshes import Mesh
    from gearwhine.mode_pictures import ModeFormat, View
    from gearwhine.output.export import Signals
    from gearwhine.rotors.analyses.solved_rotor import SolvedRotor
    from gearwhine.solve.case_summary import CheckedCase
    from gearwhine.solve.comparison import PlannedSurvey
    from gearwhine.solve.housing_modes import SolvedHousing
    from gearwhine.solve.operating_point import SolvedLoad
    from gearwhine.solve.updating import SolvedUpdate
    from gearwhine.sweep.run import SweptPoint


def load(source: str | os.PathLike[str], changes: Mapping[str, object] | Sequence[str] = ()) -> CaseStudy:
    """Read and check a case.

    Parameters
    ----------
    source : str or path
        Case file (TOML), or name of a bundled case.
    changes : mapping or sequence of str
        Keys and their new values, numbers, texts, lists or tables, ``{"housing.box.mesh_size": "20 mm"}``; or texts
        such as ``"housing.box.mesh_size=20 mm"``. An empty text removes a key.

    Raises
    ------
    CaseError
        With everything that is wrong.
    """
    return CaseStudy(load_case(os.fspath(source), _texts(changes)))


def build(folder: str | os.PathLike[str] = ".", /, **tables: object) -> CaseStudy:
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
    return CaseStudy(CaseSource({name: _plain(table) for name, table in tables.items()}, Path(folder)).changed())


@dataclass(frozen=True)
class Settings:
    """What analyses of a machine take beside it.

    Attributes
    ----------
    title : str
        Title of the results.
    transient : TransientPlan, optional
        Stretch of the motion over time; without one ``run`` has no motion.
    tracking : OrderTracking, optional
        Windows of the orders along a run.
    speeds : sequence of float
        Signed speeds of the first driver's shaft for analyses over speed [rad/s].
    acoustics : Acoustics, optional
        Method and medium, floor and microphones of the sound.
    """

    title: str = ""
    transient: TransientPlan | None = None
    tracking: OrderTracking | None = None
    speeds: Sequence[float] = ()
    acoustics: Acoustics | None = None

    def __post_init__(self) -> None:
        """Keep own copies, and check each of them."""
        from gearwhine.coupling.analyses.recording import TransientPlan
        from gearwhine.coupling.analyses.run_up import OrderTracking
        from gearwhine.coupling.errors import CouplingError
        from gearwhine.coupling.sound import Acoustics

        keep_tuples(self, "speeds")
        rules: dict[str, Rule] = {
            "title": Instance(str, "a text"),
            "transient": Instance(TransientPlan, "a TransientPlan, or None", optional=True),
            "tracking": Instance(OrderTracking, "an OrderTracking, or None", optional=True),
            "speeds": Numbers(each=Number(unit="rad/s")),
            "acoustics": Instance(Acoustics, "an Acoustics, or None", optional=True),
        }
        refuse(attribute_findings(("settings", self.title), self, **rules), CouplingError)


class Study:
    """A machine, what its analyses take beside it, and the analyses: each a call that returns a labelled result.

    The results are those of the same machine in a case: the same numbers, warnings, figures and files.

    Parameters
    ----------
    machine : Machine
        Machine; where its housing is the result of :meth:`gearwhine.Housing.modes`, it stands in that.
    settings : Settings, optional
        Title, stretch of the transient, and speeds of analyses over speed.
    progress : callable
        Receives the progress of long work in words; silent by default.

    Examples
    --------
    A shaft of 0.5 m on two stiff bearings:

    >>> import gearwhine as gw
    >>> shaft = gw.Shaft(gw.Rotor("shaft", [gw.Segment(0.5, 0.03, 0.0, gw.STEEL)]))
    >>> bearings = [gw.MountedBearing(gw.Bearing.isotropic(f"at {at}", at, 1e8), "shaft", None) for at in (0.02, 0.48)]
    >>> study = gw.Study(gw.Machine([shaft], bearings, speed=100.0), gw.Settings("a shaft"))
    >>> modes = study.system()
    >>> modes.dataset["system_frequency"].attrs["units"]
    'Hz'
    """

    def __init__(self, machine: Machine, settings: Settings | None = None, progress: Progress = silent) -> None:
        from gearwhine.coupling import CouplingError
        from gearwhine.coupling import Machine as Described

        if not isinstance(machine, Described):
            raise CouplingError(f"a study is of a gearwhine.Machine, got {machine!r}; gearwhine.load reads a case")
        self._machine = machine
        self._settings = settings or Settings()
        self.progress = progress
        self._under_load: MachineUnderLoad | None = None
        self._lock = threading.RLock()

    def __repr__(self) -> str:
        """Return the machine's own words."""
        return f"<Study of {self.machine!r}>"

    @property
    def machine(self) -> Machine:
        """The shafts, gears, bearings and gear pairs as one object, with all that loads it."""
        return self._machine

    @property
    def settings(self) -> Settings:
        """Title, stretch of the transient, and speeds of analyses over speed."""
        return self._settings

    def rotors(self, **settings: Any) -> Result[tuple[SolvedRotor, ...]]:
        """Find modes, whirl, critical speeds and responses of each shaft, alone in its bearings on rigid seats.

        Campbell diagrams go over the speeds of the settings, by default up to 1.5 times the speed of the machine.

        Parameters
        ----------
        **settings
            See :class:`gearwhine.rotors.analyses.solved_rotor.RotorSettings`: ``mode_count=8``, ``orders=(2.0,)``.
        """
        from gearwhine.analyses import of_machine

        return of_machine.rotors(
            self.machine, self.settings.title, speeds=self.settings.speeds, progress=self.progress, **settings
        )

    def gears(self, aims: Sequence[ReliefAim] = ()) -> Result[tuple[PairAnalysis, ...]]:
        """Analyse each gear pair, and find its best tip relief; see :func:`gearwhine.analyses.of_machine.gears`."""
        from gearwhine.analyses import of_machine

        return of_machine.gears(self.machine, self.settings.title, aims=aims, progress=self.progress)

    def operating_point(self, *, over_torque: bool = False) -> Result[SolvedLoad]:
        """Find the static equilibrium under load; see :func:`gearwhine.analyses.of_machine.operating_point`."""
        from gearwhine.analyses import of_machine

        return of_machine.operating_point(
            self.machine, self.settings.title, over_torque=over_torque, progress=self.progress
        )

    def system(
        self,
        *,
        campbell: bool = False,
        sidebands: int = 0,
        mesh_harmonics: int = 3,
        mesh_phase: float | None = None,
    ) -> Result[SolvedSystem]:
        """Find the complex modes of the coupled machine, and their course over the speeds of the settings.

        ``campbell`` follows them over speed without such speeds, too: up to 1.5 times the speed of the machine. See
        :func:`gearwhine.analyses.of_machine.system`.
        """
        from gearwhine.analyses import of_machine

        return of_machine.system(
            self._loaded(),
            mesh_phase=mesh_phase,
            over_speed=self._diagram_speeds() if campbell or len(self.settings.speeds) > 1 else (),
            sidebands=sidebands,
            mesh_harmonics=mesh_harmonics,
            progress=self.progress,
        )

    def steady(
        self, *, curve: bool = False, down: bool = False, points: int = 100, exact: bool = False
    ) -> Result[SolvedSteady]:
        """Find the periodic motion, and with ``curve`` its branch over the range of the settings' speeds.

        The branch goes by default from half to 1.5 times the speed of the machine; ``down`` follows it from the
        highest speed downwards. See :func:`gearwhine.analyses.of_machine.steady`.
        """
        from gearwhine.analyses import of_machine

        speeds = self._branch_speeds(down=down) if curve or down else None
        return of_machine.steady(self._loaded(), over_speed=speeds, points=points, exact=exact, progress=self.progress)

    def simulate(self, plan: TransientPlan | None = None, /, **stretch: Any) -> Result[RunSolution]:
        """Integrate the motion over time.

        Parameters
        ----------
        plan : TransientPlan, optional
            Stretch of the motion, by default that of the settings; or its attributes by name: ``revolutions=40,
            discard=20``.
        **stretch
            See :class:`gearwhine.coupling.analyses.recording.TransientPlan`.

        Raises
        ------
        gearwhine.coupling.CouplingError
            Where the plan cannot be followed.
        gearwhine.coupling.TransientError
            Where the motion cannot be followed or its energies do not balance.
        """
        from gearwhine.analyses import of_machine
        from gearwhine.coupling.analyses.recording import TransientPlan

        if plan is None:
            given = self.settings.transient
            plan = TransientPlan(**stretch) if given is None or stretch else given
        return of_machine.simulate(self._loaded(plan), plan, self.settings.tracking, self.progress)

    def run(self) -> Result[RunSolution]:
        """Find everything: rotors, gears, operating point, modes and responses, and the transient of the settings."""
        from gearwhine.analyses import of_machine

        plan = self.settings.transient
        rotors = self.rotors().solved
        return of_machine.run(self.machine, self._loaded(plan), rotors, plan, self.settings.tracking, self.progress)

    def sound(self, acoustics: Acoustics | None = None, /, **settings: Any) -> Result[SolvedSound]:
        """Find the sound that the housing radiates: of its modes, and of the lines of the steady motion.

        Parameters
        ----------
        acoustics : Acoustics, optional
            Method and medium, floor and microphones; or its attributes by name: ``method="erp", floor=-0.02``. By
            default those of the settings, else boundary elements in free air.
        **settings
            See :class:`gearwhine.coupling.sound.Acoustics`.

        Raises
        ------
        gearwhine.coupling.errors.AcousticsError
            Where the machine has no housing with a mesh, or the acoustics do not fit it.
        gearwhine.coupling.PeriodicError
            Where no periodic motion is found.
        gearwhine.housing.HousingError
            Where a solution fails its proofs.
        """
        from gearwhine.analyses import of_machine
        from gearwhine.coupling.sound import Acoustics
        from gearwhine.coupling.sound.motion_lines import left_out_warnings

        if acoustics is None:
            given = self.settings.acoustics
            acoustics = Acoustics(**settings) if given is None or settings else given
        housing = of_machine.radiating_housing(self.machine, acoustics, self.settings.title)
        warnings = left_out_warnings(base_moves=self.machine.base is not None, speed_changes=False)
        return of_machine.sound(housing, None if warnings else self._loaded(), warnings, self.progress)

    def _diagram_speeds(self) -> tuple[float, ...]:
        """Return the signed speeds of a diagram of the machine [rad/s], ascending in size."""
        from gearwhine.numerics.speed_ranges import campbell_speeds

        chosen = sorted(self.settings.speeds, key=abs)
        return tuple(chosen) or campbell_speeds(self.machine.speed, self._held_speeds())

    def _branch_speeds(self, *, down: bool) -> tuple[float, float]:
        """Return the signed speeds from which and to which a motion is followed [rad/s]."""
        from gearwhine.numerics.speed_ranges import BEYOND_OPERATION, SLOWEST_OF_BRANCH

        low, high = self._held_speeds()
        speeds = sorted(self.settings.speeds, key=abs)
        if not speeds:
            sense, size = math.copysign(1.0, self.machine.speed), abs(self.machine.speed)
            speeds = [sense * max(SLOWEST_OF_BRANCH * size, low), sense * min(BEYOND_OPERATION * size, high)]
        return (speeds[-1], speeds[0]) if down else (speeds[0], speeds[-1])

    def _held_speeds(self) -> tuple[float, float]:
        """Return the range of speeds of the first shaft, without sense, that the bearings' tables hold [rad/s]."""
        from gearwhine.coupling.analyses.shafts_alone import held_speeds

        return held_speeds(self.machine)

    def _loaded(self, plan: TransientPlan | None = None) -> MachineUnderLoad:
        """Return the machine about its operating point, assembled for a plan; at constant speed it is made once."""
        from gearwhine.analyses.of_machine import machine_under_load

        if plan is not None and plan.run is not None:
            return machine_under_load(self.machine, self.settings.title, plan.run, self.progress)
        with self._lock:
            if self._under_load is None:
                self._under_load = machine_under_load(self.machine, self.settings.title, progress=self.progress)
            return self._under_load


@dataclass
class _KeptHousing:
    """The solved housing that studies share; None until one of them needs it, whose thread holds the lock."""

    solved: SolvedHousing | None = None
    lock: threading.RLock = field(default_factory=threading.RLock)


class CaseStudy(Study):
    """A checked case and its analyses: a study of the machine that the case describes, with the case's settings.

    The housing is meshed and solved once, by the first analysis that needs its modes, and held by the study. Threads
    may share a study: who needs the housing while another thread solves it waits.

    Attributes
    ----------
    case : Case
        Checked case, in SI.
    warnings : tuple of str
        Allowed but implausible choices in the case.
    progress : callable
        Receives the progress of long work in words; silent by default.
    """

    def __init__(self, loaded: LoadedCase, progress: Progress = silent) -> None:
        self.case: Case = loaded.case
        self.warnings = loaded.warnings
        self.progress = progress
        self._source = loaded.source
        self._kept = _KeptHousing()

    def __repr__(self) -> str:
        """Return the case's title."""
        return f"<Study of {self.case.title or 'an untitled case'!r}>"

    def _repr_html_(self) -> str:
        from gearwhine.notebook import case_html

        return case_html(self.case)

    def changed(self, changes: Mapping[str, object] | Sequence[str]) -> CaseStudy:
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
        study = CaseStudy(self._source.changed(_texts(changes)), self.progress)
        if self.case.housing is not None and study.case.housing is not None:
            from gearwhine.solve.housing_modes import housing_key

            if housing_key(self.case) == housing_key(study.case):
                study._kept = self._kept
        return study

    @property
    def housing(self) -> SolvedHousing | None:
        """The solved housing, which the first call meshes and solves; None in a case without one."""
        return self._solved_housing(with_sound=False)

    def _solved_housing(self, *, with_sound: bool) -> SolvedHousing | None:
        """Return the solved housing; where its sound is wanted, what is wrong with `[acoustics]` is refused before."""
        with self._kept.lock:
            if self._kept.solved is None and self.case.housing is not None:
                from gearwhine.solve.acoustics import check_before_modes
                from gearwhine.solve.housing_modes import solve_housing

                before = check_before_modes(self.case) if with_sound else None
                self._kept.solved = solve_housing(self.case, self.progress, before=before)
            return self._kept.solved

    @property
    def machine(self) -> Machine:
        """The shafts, gears, bearings and gear pairs of the case as one object, with all that loads it.

        It stands in the solved housing of the case.
        """
        from gearwhine.from_case.machine import describe_machine
        from gearwhine.solve.machine import reduce_housing

        solved = self.housing
        if solved is None:
            return describe_machine(self.case, None)
        part = reduce_housing(self.case, solved, self.progress)
        return describe_machine(self.case, replace(part, displacement_field=solved.displacement_field))

    @property
    def settings(self) -> Settings:
        """Title, transient and speeds of the case: `gw.Study(study.machine, study.settings)` analyses its machine."""
        from gearwhine.case.analysis_speeds import with_sense_of
        from gearwhine.solve.acoustics import acoustics_of
        from gearwhine.solve.machine import plan_of, tracking_of

        case = self.case
        plan = None if case.transient is None else plan_of(case)
        speeds = () if case.sweep is None else with_sense_of(case.operation, case.sweep.speeds)
        acoustics = None if case.acoustics is None else acoustics_of(case)
        return Settings(case.title, plan, tracking_of(case), speeds, acoustics)

    def check(self) -> Result[CheckedCase]:
        """Derive ratios, mesh frequencies and sizes, solving nothing; see :func:`gearwhine.analyses.case.check`."""
        from gearwhine.analyses import case

        return case.check(self.case, progress=self.progress)

    def mesh(self, suffix: str = "msh") -> Result[Mesh]:
        """Mesh the housing; see :func:`gearwhine.analyses.housing.mesh`."""
        from gearwhine.analyses import housing

        return housing.mesh(self.case, suffix=suffix, progress=self.progress)

    def modes(self, *, detail: bool = False) -> Result[SolvedHousing]:
        """Find the natural modes of the housing, certified complete; see :func:`gearwhine.analyses.housing.modes`."""
        from gearwhine.analyses import housing

        return housing.modes(self.case, detail=detail, housing=self.housing, progress=self.progress)

    def compare(self) -> Result[Comparison]:
        """Compare natural modes with measured ones; see :func:`gearwhine.analyses.housing.compare`."""
        from gearwhine.analyses import housing

        return housing.compare(self.case, housing=self.housing, progress=self.progress)

    def survey(self, sensors: int, modes: int | None = None) -> Result[PlannedSurvey]:
        """Choose where to measure the modes; see :func:`gearwhine.analyses.housing.survey`."""
        from gearwhine.analyses import housing

        return housing.survey(self.case, sensors=sensors, modes=modes, housing=self.housing, progress=self.progress)

    def update(self, *, null: int = 0, held_back: bool = False) -> Result[SolvedUpdate]:
        """Fit the parameters of `[update]` to the measured modes; see :func:`gearwhine.analyses.housing.update`."""
        from gearwhine.analyses import housing

        return housing.update(self.case, null=null, held_back=held_back, progress=self.progress)

    def render(
        self,
        modes: str | None = None,
        *,
        view: View = "auto",
        mode_format: ModeFormat = "png",
        measured: bool = False,
    ) -> Result[SolvedHousing]:
        """Draw mode shapes, which the result writes; see :func:`gearwhine.analyses.housing.render`."""
        from gearwhine.analyses import housing

        return housing.render(
            self.case,
            modes,
            view=view,
            mode_format=mode_format,
            measured=measured,
            housing=self.housing,
            progress=self.progress,
        )

    def report(self, folder: str | os.PathLike[str], *, interactive: bool = False) -> Path:
        """Write all results in a folder as one HTML page; return the file.

        See :func:`gearwhine.analyses.case.write_report`.
        """
        from gearwhine.analyses.case import write_report

        written = write_report(Path(folder), self.case, interactive=interactive, progress=self.progress)
        return Path(folder) / str(written["files"][0])

    def rotors(self, **settings: Any) -> Result[tuple[SolvedRotor, ...]]:
        """Find modes, whirl and critical speeds of each rotor; see :func:`gearwhine.analyses.machine.rotors`."""
        from gearwhine.analyses import machine

        return machine.rotors(self.case, progress=self.progress, **settings)

    def gears(self, aims: Sequence[ReliefAim] = ()) -> Result[tuple[PairAnalysis, ...]]:
        """Analyse each gear pair; see :func:`gearwhine.analyses.machine.gears`."""
        from gearwhine.analyses import machine
        from gearwhine.solve.gear_pairs import aims_at_sensor

        housing = self.housing if aims_at_sensor(self.case) else self._kept.solved
        return machine.gears(self.case, aims=aims, housing=housing, progress=self.progress)

    def operating_point(
        self,
        *,
        over_torque: bool = False,
        sensitivity: bool = False,
        line: str | None = None,
        rigid_seats: bool = False,
    ) -> Result[SolvedLoad]:
        """Find the static equilibrium under load; see :func:`gearwhine.analyses.machine.operating_point`."""
        from gearwhine.analyses import machine

        return machine.operating_point(
            self.case,
            over_torque=over_torque,
            sensitivity=sensitivity,
            line=line,
            rigid_seats=rigid_seats,
            housing=None if rigid_seats else self._solved_housing(with_sound=sensitivity or line is not None),
            progress=self.progress,
        )

    def system(
        self,
        *,
        campbell: bool = False,
        sidebands: int = 0,
        mesh_harmonics: int = 3,
        mesh_phase: float | None = None,
    ) -> Result[SolvedSystem]:
        """Find the complex modes of the coupled machine; see :func:`gearwhine.analyses.machine.system`."""
        from gearwhine.analyses import machine

        return machine.system(
            self.case,
            campbell=campbell,
            sidebands=sidebands,
            mesh_harmonics=mesh_harmonics,
            mesh_phase=mesh_phase,
            housing=self.housing,
            progress=self.progress,
        )

    def steady(
        self, *, curve: bool = False, down: bool = False, points: int = 100, exact: bool = False
    ) -> Result[SolvedSteady]:
        """Find the periodic motion, its stability and branch; see :func:`gearwhine.analyses.machine.steady`."""
        from gearwhine.analyses import machine

        return machine.steady(
            self.case,
            curve=curve,
            down=down,
            points=points,
            exact=exact,
            housing=self.housing,
            progress=self.progress,
        )

    def sound(self, acoustics: Acoustics | None = None, /, **settings: Any) -> Result[SolvedSound]:
        """Find the sound that the housing radiates; see :func:`gearwhine.analyses.machine.sound`.

        An object, or its attributes by name, take the place of the case's `[acoustics]`.
        """
        from gearwhine.analyses import machine
        from gearwhine.coupling.sound import Acoustics

        acoustics = Acoustics(**settings) if settings else acoustics
        housing = self._solved_housing(with_sound=acoustics is None)
        return machine.sound(self.case, acoustics=acoustics, housing=housing, progress=self.progress)

    def simulate(self, plan: TransientPlan | None = None, /, **stretch: Any) -> Result[RunSolution]:
        """Integrate the motion over time, by default of `[transient]`; see :func:`gearwhine.analyses.run.simulate`.

        A plan, or the attributes of one, take the place of that of the case.
        """
        from gearwhine.analyses import run
        from gearwhine.coupling.analyses.recording import TransientPlan

        plan = TransientPlan(**stretch) if stretch else plan
        return run.simulate(self.case, plan=plan, housing=self.housing, progress=self.progress)

    def run(self) -> Result[RunSolution]:
        """Do everything that the case asks for; see :func:`gearwhine.analyses.run.run`."""
        from gearwhine.analyses import run
        from gearwhine.solve.acoustics import is_in_run

        housing = self._solved_housing(with_sound=is_in_run(self.case))
        return run.run(self.case, housing=housing, pictures=False, progress=self.progress)

    def sweep(
        self,
        over: Sequence[str] = (),
        *,
        folder: str | os.PathLike[str],
        workers: int | None = None,
        fresh: bool = False,
    ) -> Result[Sequence[SweptPoint]]:
        """Integrate the transient at every point of a sweep; see :func:`gearwhine.analyses.machine.sweep`.

        Parameters
        ----------
        over : sequence of str
            Values of keys, such as ``"operation.torque=10 N*m:100 N*m:10"``, beside the speeds of `[sweep]`.
        folder : path
            Folder of the points; those that it holds already are not solved again.
        workers : int, optional
            Number of processes; as many as cores by default.
        fresh : bool
            Whether to solve all points anew.

        Raises
        ------
        CaseError
            Where a key cannot be swept.
        """
        from gearwhine.analyses import machine

        return machine.sweep(
            self.case, self._source, over, Path(folder), workers=workers, fresh=fresh, progress=self.progress
        )

    def export(
        self,
        folder: str | os.PathLike[str],
        formats: Sequence[Format] = ("csv", "uff", "wav"),
        *,
        signals: Signals = "sensors",
        seconds: float | None = None,
    ) -> list[str]:
        """Write results in formats of other programs; see :func:`gearwhine.analyses.case.export_results`.

        Returns
        -------
        list of str
            The files, relative to the folder.
        """
        from gearwhine.analyses.case import export_results

        return list(export_results(Path(folder), formats, signals=signals, seconds=seconds)["files"])


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
