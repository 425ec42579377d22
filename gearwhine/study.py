"""Study: a machine, what its analyses take beside it, and the analyses, each a call that returns a labelled result.

The command line is made from the same methods: their parameters are its options, their first lines its help.
"""

import math
import os
import threading
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from gearwhine.numerics.findings import Finding, Instance, Number, Numbers, Rule, attribute_findings, refuse
from gearwhine.numerics.progress import Progress, silent

if TYPE_CHECKING:
    from gearwhine.analyses.machine_results import MachineUnderLoad
    from gearwhine.analyses.origin import Origin
    from gearwhine.analyses.result import Result
    from gearwhine.analyses.run_solution import RunSolution
    from gearwhine.coupling import Machine
    from gearwhine.coupling.analyses.gear_pairs import PairAnalysis
    from gearwhine.coupling.analyses.modes_and_responses import SolvedSystem
    from gearwhine.coupling.analyses.motion import MachineMotion
    from gearwhine.coupling.analyses.recording import TransientPlan
    from gearwhine.coupling.analyses.run_up import OrderTracking
    from gearwhine.coupling.analyses.steady_state import SolvedSteady
    from gearwhine.coupling.description.excitation import Run
    from gearwhine.coupling.gears.loaded.optimal_relief import ReliefAim
    from gearwhine.coupling.linear.complex_modes import CoupledModes
    from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
    from gearwhine.coupling.sound import Acoustics
    from gearwhine.coupling.sound.solution import SolvedSound
    from gearwhine.figures.rotors.assembly import RotorAssembly
    from gearwhine.housing import HousingModes
    from gearwhine.housing.correlation.comparison import Comparison
    from gearwhine.numerics.result_warnings import ResultWarning
    from gearwhine.rotors.analyses.solved_rotor import SolvedRotor


SIDEBANDS = Number(at_least=0, at_most=20, whole=True)
HARMONICS = Number(at_least=1, at_most=50, whole=True)
POINTS = Number(at_least=2, at_most=2000, whole=True)


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
    sound_in_run : bool, optional
        Whether ``run`` finds the sound of its motion with these acoustics; by default unless they are boundary
        elements, which take minutes.
    """

    title: str = ""
    transient: "TransientPlan | None" = None
    tracking: "OrderTracking | None" = None
    speeds: Sequence[float] = ()
    acoustics: "Acoustics | None" = None
    sound_in_run: bool | None = None

    def __post_init__(self) -> None:
        """Keep own copies, and check each of them."""
        from gearwhine.coupling.analyses.recording import TransientPlan
        from gearwhine.coupling.analyses.run_up import OrderTracking
        from gearwhine.coupling.errors import CouplingError
        from gearwhine.coupling.sound import Acoustics
        from gearwhine.numerics.own_copies import keep_tuples

        keep_tuples(self, "speeds")
        rules: dict[str, Rule] = {
            "title": Instance(str, "a text"),
            "transient": Instance(TransientPlan, "a TransientPlan, or None", optional=True),
            "tracking": Instance(OrderTracking, "an OrderTracking, or None", optional=True),
            "speeds": Numbers(each=Number(unit="rad/s")),
            "acoustics": Instance(Acoustics, "an Acoustics, or None", optional=True),
            "sound_in_run": Instance(bool, "a truth value, or None", optional=True),
        }
        refuse(attribute_findings(("settings", self.title), self, **rules), CouplingError)

    @property
    def is_sound_in_run(self) -> bool:
        """Whether ``run`` finds the sound of its motion."""
        if self.acoustics is None:
            return False
        return self.acoustics.method != "boundary-elements" if self.sound_in_run is None else self.sound_in_run


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

    def __init__(self, machine: "Machine", settings: Settings | None = None, progress: Progress = silent) -> None:
        from gearwhine.coupling import CouplingError
        from gearwhine.coupling import Machine as Described

        if not isinstance(machine, Described):
            raise CouplingError(f"a study is of a gearwhine.Machine, got {machine!r}; gearwhine.load reads a case")
        self._machine = machine
        self._settings = settings or Settings()
        self._start(progress)

    def _start(self, progress: Progress) -> None:
        self.progress = progress
        self._at_constant_speed: MachineUnderLoad | None = None
        self._lock = threading.RLock()

    def __repr__(self) -> str:
        """Return the machine's own words."""
        return f"<Study of {self.machine!r}>"

    @property
    def machine(self) -> "Machine":
        """The shafts, gears, bearings and gear pairs as one object, with all that loads it."""
        return self._machine

    @property
    def settings(self) -> Settings:
        """Title, stretch of the transient, and speeds of analyses over speed."""
        return self._settings

    def rotors(self, **settings: Any) -> "Result[tuple[SolvedRotor, ...]]":
        """Lateral and torsional modes, whirl and critical speeds of each rotor.

        Each is alone in its bearings on rigid seats. Campbell diagrams go over the speeds of the settings, by default
        up to 1.5 times the speed of the machine.

        Parameters
        ----------
        **settings
            See :class:`gearwhine.rotors.analyses.solved_rotor.RotorSettings`: ``mode_count=8``, ``orders=(2.0,)``.
        """
        from gearwhine.analyses.machine_results import rotors_result

        solved = self.solved_rotors(**settings)

        def assemblies() -> "list[RotorAssembly]":
            from gearwhine.figures.rotors import shaft_assembly

            return [shaft_assembly(self.machine, one.rotor.name, one.bearings) for one in solved]

        return rotors_result(solved, self.origin, assemblies)

    def gears(self, aims: "Sequence[ReliefAim]" = ()) -> "Result[tuple[PairAnalysis, ...]]":
        """Gear pairs: geometry, mesh stiffness, transmission error, load sharing, contact pressure, optimal tip relief.

        Parameters
        ----------
        aims : sequence of ReliefAim, optional
            Objective of the best relief of each pair; by default those of
            :func:`gearwhine.coupling.analyses.gear_pairs.default_aims`.

        Raises
        ------
        gearwhine.coupling.CouplingError, gearwhine.coupling.gears.GearError
            Where the machine has no gear pairs, there are more or fewer aims than pairs, or a pair cannot be solved.
        """
        from gearwhine.analyses.machine_results import gears_result, require_aims
        from gearwhine.coupling import CouplingError
        from gearwhine.coupling.analyses.gear_pairs import analyse_machine, default_aims, solve_over_torques
        from gearwhine.coupling.analyses.loaded_machine import point_of_flanks

        machine = self.machine
        if not machine.gear_pairs:
            raise CouplingError("gears: expected a machine with a gear pair")
        require_aims(aims, len(machine.gear_pairs))
        point = point_of_flanks(machine, self.progress)
        analysed = analyse_machine(machine, point, self.progress)
        chosen = aims or default_aims(machine, point, [pair.solved for pair in analysed], self.progress)
        analysed = tuple(replace(pair, aim_given=bool(aims)) for pair in analysed)
        seats = None if point is None or machine.housing is None else "housing"
        return gears_result(solve_over_torques(analysed, self.progress, chosen), self.origin, seats)

    def operating_point(
        self, *, over_torque: bool = False, sensitivity: bool = False, line: str | None = None
    ) -> "Result[SolvedLoad]":
        """Load on the whole machine at rest: bearing loads, deflections, misalignment and load of the gear faces.

        Parameters
        ----------
        over_torque : bool
            Also solve from 10 to 150 % of the torque.
        sensitivity : bool
            Also rank bearings, and the flat faces of a housing of :meth:`gearwhine.Housing.modes`, by what they change
            in gear pairs, in the lines of sensors and, with acoustics in the settings, in the sound power of the
            loudest lines.
        line : str, optional
            Line that is ranked: a sensor, or with its frequency in Hz, 'roof@1377'; or of the sound, 'sound@1377'. By
            default the highest, and the A-weighted sum of the loudest. It implies ``sensitivity``.

        Raises
        ------
        gearwhine.coupling.CouplingError
            Where nothing loads the machine, there is no such line, or a load drives a motion that nothing holds.
        gearwhine.coupling.EquilibriumNotFoundError
            Where no equilibrium is found.
        """
        from gearwhine.analyses.machine_results import load_result
        from gearwhine.coupling.load_analysis.ranking import rank_parts
        from gearwhine.coupling.load_analysis.solved_load import solve_load

        solved = solve_load(self.machine, self.progress, over_torque=over_torque, over_hunting_period=True)
        if sensitivity or line is not None:
            plan = self.settings.transient
            ranking = rank_parts(
                self.machine,
                solved.point,
                acoustics=self.settings.acoustics,
                run=None if plan is None else plan.run,
                line=line,
                progress=self.progress,
            )
            solved = replace(solved, sensitivity=ranking)
        return load_result(solved, self.origin)

    def system(
        self,
        *,
        campbell: bool = False,
        sidebands: Annotated[int, SIDEBANDS] = 0,
        mesh_harmonics: Annotated[int, HARMONICS] = 3,
        mesh_phase: float | None = None,
    ) -> "Result[SolvedSystem]":
        """Complex natural modes of the coupled machine, their damping and participation, and its transmissibility.

        Parameters
        ----------
        campbell : bool
            Also compute the Campbell diagram: over the speeds of the settings ([sweep]), else up to 1.5 times the
            operating speed. Speeds of the settings imply it.
        sidebands : int
            Number of shaft-order sidebands drawn on each side of every mesh order, up to 20.
        mesh_harmonics : int
            Number of harmonics of every mesh whose resonances the Campbell diagram lists and draws, up to 50.
        mesh_phase : float, optional
            Linearise about the mesh at this fraction of the first pair's mesh period (default: the mean).

        Raises
        ------
        gearwhine.coupling.CouplingError
            Where the parts do not make a machine, or a number is out of its range.
        gearwhine.coupling.ModesError
            Where the modes fail their certificate.
        """
        from gearwhine.analyses.machine_results import system_result
        from gearwhine.coupling.analyses.modes_and_responses import MESH_HARMONICS, solve_system

        _require_numbers("system", sidebands=(sidebands, SIDEBANDS), mesh_harmonics=(mesh_harmonics, HARMONICS))
        self.require("system" if mesh_phase is None else "system --mesh-phase")
        over_speed = campbell or sidebands > 0 or mesh_harmonics > MESH_HARMONICS or len(self.settings.speeds) > 1
        machine = self.under_load(self.settings.transient)
        solved = solve_system(
            machine.coupled,
            self.progress,
            mesh_phase=mesh_phase,
            over_speed=self._diagram_speeds() if over_speed else (),
            sidebands=sidebands,
            mesh_harmonics=mesh_harmonics,
        )
        return system_result(machine, solved, self.progress)

    def steady(
        self, *, curve: bool = False, down: bool = False, points: Annotated[int, POINTS] = 100, exact: bool = False
    ) -> "Result[SolvedSteady]":
        """Periodic steady state by shooting, its stability by Floquet multipliers, and its continuation over speed.

        The motion is that at the speed and torque of operation, also where the speed of the transient varies.

        Parameters
        ----------
        curve : bool
            Also continue the motion over speed, through folds: over the range of the settings' speeds ([sweep]), else
            from 0.5 to 1.5 times the operating speed.
        down : bool
            Continue from the highest speed downwards.
        points : int
            Number of points on a straight part of the curve, from 2 to 2000.
        exact : bool
            Solve over the common period of all excitations, however long; by default excitations without a short common
            period, such as the meshes of several stages, are solved one by one and superposed.

        Raises
        ------
        gearwhine.coupling.CouplingError
            Where the parts do not make a machine, or a number is out of its range.
        gearwhine.coupling.PeriodicError
            Where no periodic motion is found.
        """
        from gearwhine.analyses.machine_results import steady_result
        from gearwhine.coupling.analyses.steady_state import solve_steady

        _require_numbers("steady", points=(points, POINTS))
        self.require("steady")
        machine = self.under_load()
        speeds = self._branch_speeds(down=down) if curve or down else None
        solved = solve_steady(machine.coupled, self.progress, over_speed=speeds, points=points, exact=exact)
        if solved.curve is not None:
            solved = replace(solved, assumed_damping=self._assumed_mesh_damping())
        return steady_result(machine, solved, self.progress)

    def simulate(self, plan: "TransientPlan | None" = None, /, **stretch: Any) -> "Result[RunSolution]":
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
            Where there is no plan, or it cannot be followed.
        gearwhine.coupling.TransientError
            Where the motion cannot be followed or its energies do not balance.
        """
        from gearwhine.analyses.machine_results import motion_result
        from gearwhine.coupling import coupled_modes
        from gearwhine.coupling.analyses.recording import TransientPlan
        from gearwhine.coupling.statics.mean_mesh import mean_contact

        if plan is None and not stretch:
            self.require("simulate")
            plan = self.settings.transient
        plan = TransientPlan(**stretch) if plan is None else plan
        machine = self.under_load(plan)
        modes = coupled_modes(machine.coupled.system, mean_contact(machine.coupled.system))
        return motion_result(machine, self.motion(machine, plan, modes), modes)

    def sound(self, acoustics: "Acoustics | None" = None, /, **settings: Any) -> "Result[SolvedSound]":
        """Sound power, radiation efficiency and sound pressure of the housing's modes and of the steady motion's lines.

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
        from gearwhine.analyses.machine_results import radiating_housing, sound_result
        from gearwhine.coupling.sound import Acoustics

        if acoustics is None:
            given = self.settings.acoustics
            acoustics = Acoustics(**settings) if given is None or settings else given
        housing = radiating_housing(self.machine, acoustics, self.origin)
        warnings = self.left_out_of_sound(None)
        return sound_result(housing, None if warnings else self.under_load(), warnings, self.progress)

    def run(self) -> "Result[RunSolution]":
        """Find everything: rotors, gears, operating point, modes and responses, transient, and sound where it is asked.

        The motion is that of the settings' transient; without one there is none.
        """
        from gearwhine.analyses.run import WholeRun

        return WholeRun(self, self.settings.transient).result()

    def run_into(self, folder: str | os.PathLike[str], *, pictures: bool = True) -> "Result[RunSolution]":
        """Run all analyses, and write them into a folder; an interrupted run continues there from its last checkpoint.

        Parameters
        ----------
        folder : path
            Results folder. The blocks of the motion over time are stored in it until the results are written.
        pictures : bool
            Draw pictures; without them time is saved, and no renderer is needed.

        Raises
        ------
        gearwhine.housing.errors.RendererUnavailableError
            Where modes are to be drawn and no renderer is available.
        """
        from gearwhine.analyses.run import WholeRun

        with ExitStack() as until_written:
            run = WholeRun(self, self.settings.transient, Path(folder), until_written, pictures=pictures)
            return run.result().stored(Path(folder), pictures=pictures, progress=self.progress)

    # What follows is for the analyses: what the study is of, and what a study of a case does otherwise.

    @property
    def origin(self) -> "Origin":
        """What the results are of."""
        from gearwhine.analyses.origin import Origin

        return Origin(self.settings.title, self.machine.speed)

    @property
    def fresh(self) -> bool:
        """Whether to solve again what a results folder holds."""
        return False

    @property
    def has_housing(self) -> bool:
        """Whether a housing is solved for the results, with its modes among them."""
        return False

    @property
    def has_machine(self) -> bool:
        """Whether the parts are those of a machine."""
        return True

    def require(self, command: str) -> None:
        """Refuse a command that the study does not allow, before anything is solved."""
        from gearwhine.coupling import CouplingError

        if command == "steady" and self.machine.speed == 0.0:
            raise CouplingError("steady: expected a speed: what stands still has no motion that repeats")
        if command == "simulate" and self.settings.transient is None:
            example = "study.simulate(revolutions=40, discard=20), or Settings(transient=TransientPlan(...))"
            raise CouplingError(f"simulate: expected how far to integrate, such as {example}")

    def solved_rotors(self, **settings: Any) -> "tuple[SolvedRotor, ...]":
        """Solve each rotor, alone in its bearings on rigid seats."""
        from gearwhine.coupling.analyses.shafts_alone import solve_shafts

        return solve_shafts(self.machine, self.settings.speeds, self.progress, **settings)

    def solved_housing(self, folder: Path | None = None, *, with_sound: bool = False) -> "HousingModes | None":
        """Return the housing that is solved for the results; ``with_sound`` refuses acoustics that do not fit it.

        Modes that a ``folder`` keeps are read in place of solving.
        """
        return None

    def compared_modes(self, housing: "HousingModes") -> "Comparison | None":
        """Compare the modes of the housing with measured ones; None without such."""
        return None

    def under_load(self, plan: "TransientPlan | None" = None) -> "MachineUnderLoad":
        """Return the machine about its operating point, assembled for a plan; at constant speed it is made once."""
        if plan is not None and plan.run is not None:
            return self._put_under_load(plan.run)
        with self._lock:
            if self._at_constant_speed is None:
                self._at_constant_speed = self._put_under_load(None)
            return self._at_constant_speed

    def _put_under_load(self, run: "Run | None") -> "MachineUnderLoad":
        from gearwhine.analyses.machine_results import machine_under_load

        return machine_under_load(self.machine, self.origin, run, self.progress)

    def analysed_pairs(self, machine: "MachineUnderLoad | None") -> "tuple[PairAnalysis, ...]":
        """Analyse each gear pair as it stands in the machine under load."""
        from gearwhine.coupling.analyses.gear_pairs import analyse_machine

        if machine is None:
            return ()
        point = None if machine.load is None else machine.load.point
        return analyse_machine(self.machine, point, self.progress, pairs=machine.loaded.pairs)

    def motion(
        self,
        machine: "MachineUnderLoad",
        plan: "TransientPlan",
        modes: "CoupledModes",
        keep: Callable[[str], Any] | None = None,
    ) -> "MachineMotion":
        """Integrate the motion of the machine under load; ``keep`` stores its blocks."""
        from gearwhine.coupling.analyses.motion import solve_motion
        from gearwhine.coupling.analyses.run_up import OrderTracking

        tracking = self.settings.tracking or OrderTracking()
        return solve_motion(machine.loaded, plan, tracking, modes, self.progress, keep=keep)

    def left_out_of_sound(self, plan: "TransientPlan | None") -> "list[ResultWarning]":
        """Return the warning that the sound of the motion's lines is left out, and why; none where it is not."""
        from gearwhine.coupling.sound.motion_lines import left_out_warnings

        speed_changes = plan is not None and plan.run is not None
        return left_out_warnings(base_moves=self.machine.base is not None, speed_changes=speed_changes)

    def _assumed_mesh_damping(self) -> tuple[str, ...]:
        """Return the gear pairs whose mesh damping nobody gave."""
        return ()

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


def _require_numbers(verb: str, **given: tuple[object, Number]) -> None:
    """Refuse numbers that are not as their rules have them."""
    from gearwhine.coupling import CouplingError

    part = (verb, "")
    findings = (
        Finding(part, name, value, rule.expected) for name, (value, rule) in given.items() if not rule.accepts(value)
    )
    refuse(findings, CouplingError)
