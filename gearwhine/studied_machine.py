"""Machine of a study, and what its analyses ask of the study.

A study of a case answers some of it otherwise, see :mod:`gearwhine.case_study`.
"""

import math
import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.numerics.progress import Progress, silent
from gearwhine.settings import Settings

if TYPE_CHECKING:
    from gearwhine.analyses.machine_results import MachineUnderLoad
    from gearwhine.analyses.origin import Origin
    from gearwhine.coupling import CoupledMachine, Machine
    from gearwhine.coupling.analyses.gear_pairs import PairAnalysis
    from gearwhine.coupling.analyses.motion import MachineMotion
    from gearwhine.coupling.analyses.recording import TransientPlan
    from gearwhine.coupling.description.excitation import Run
    from gearwhine.coupling.linear.complex_modes import CoupledModes
    from gearwhine.coupling.load_analysis.influences import LoadSensitivity
    from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
    from gearwhine.coupling.sound import Acoustics
    from gearwhine.coupling.sound.motion_lines import MotionLines
    from gearwhine.coupling.sound.solution import SolvedSound
    from gearwhine.coupling.statics.operating_point import OperatingPoint
    from gearwhine.housing import HousingModes
    from gearwhine.housing.modal_test import ComparedTest
    from gearwhine.numerics.result_warnings import ResultWarning
    from gearwhine.rotors.analyses.solved_rotor import SolvedRotor


class StudiedMachine:
    """A machine and its settings, and what analyses ask: origin of results, what is solved before, what is refused.

    Parameters
    ----------
    machine : Machine
    settings : Settings, optional
    progress : callable
        Receives the progress of long work in words; silent by default.
    """

    def __init__(self, machine: "Machine", settings: Settings | None = None, progress: Progress = silent) -> None:
        from gearwhine.coupling import CouplingError
        from gearwhine.coupling import Machine as Described

        if not isinstance(machine, Described):
            raise CouplingError(f"a study is of a gearwhine.Machine, got {machine!r:.60}; gearwhine.load reads a case")
        if not isinstance(settings, Settings | None):
            raise CouplingError(f"a study takes gearwhine.Settings, such as Settings('a title'), got {settings!r:.60}")
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

    def _repr_html_(self) -> str:
        from gearwhine.notebook import machine_html

        return machine_html(self.machine)

    @property
    def machine(self) -> "Machine":
        """The shafts, gears, bearings and gear pairs as one object, with all that loads it."""
        return self._machine

    @property
    def settings(self) -> Settings:
        """Title, stretch of the transient, and speeds of analyses over speed."""
        return self._settings

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on inputs that are allowed and unlikely."""
        return self.machine.warnings

    @property
    def origin(self) -> "Origin":
        """What the results are of."""
        from gearwhine.analyses.origin import Origin
        from gearwhine.numerics.result_warnings import warning

        doubts = [warning("input", text) for text in self.machine.warnings]
        return Origin(self.settings.title, self.machine.speed, warnings=doubts)

    @property
    def fresh(self) -> bool:
        """Whether to solve again what a results folder holds."""
        return False

    @property
    def has_housing(self) -> bool:
        """Whether the machine stands in a housing that is meshed, whose modes are among the results."""
        return self.solved_housing() is not None

    @property
    def has_machine(self) -> bool:
        """Whether the parts are those of a machine."""
        return True

    def require(self, command: str) -> None:
        """Refuse a command that the study does not allow, before anything is solved."""
        from gearwhine.coupling import CouplingError

        if command == "steady" and self.machine.speed == 0.0:
            raise CouplingError("steady: expected a speed: what stands still has no motion that repeats")
        if command in ("simulate", "sweep") and self.settings.transient is None:
            example = "a plan, gw.TransientPlan(revolutions=40, discard=20), or Settings(transient=...)"
            raise CouplingError(f"{command}: expected how far to integrate, such as {example}")

    def solved_rotors(self, **settings: Any) -> "tuple[SolvedRotor, ...]":
        """Solve each rotor, alone in its bearings on rigid seats."""
        from gearwhine.coupling.analyses.shafts_alone import solve_shafts

        return solve_shafts(self.machine, self.settings.speeds, self.progress, **settings)

    def solved_housing(
        self, folder: Path | None = None, *, with_sound: bool = False, before: Callable[[], object] | None = None
    ) -> "HousingModes | None":
        """Return the housing that the machine stands in, where that is meshed and solved.

        ``with_sound`` refuses acoustics that do not fit it; modes that a ``folder`` keeps are read in place of solving,
        and ``before`` is called once the mesh is known, before the long work.
        """
        from gearwhine.coupling.sound.acoustics_checks import require_acoustics
        from gearwhine.housing import HousingModes

        housing, acoustics = self.machine.housing, self.settings.acoustics
        if not isinstance(housing, HousingModes):
            return None
        if with_sound and acoustics is not None:
            field = housing.displacement_field
            require_acoustics(acoustics, field.mesh, field.widest_bore, acoustics.limit_hz(field))
        return housing

    def compared_modes(self, housing: "HousingModes") -> "ComparedTest | None":
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
        from gearwhine.analyses.machine_results import MachineUnderLoad
        from gearwhine.coupling.analyses.loaded_machine import load_machine

        load, warnings = self.found_load()
        loaded = load_machine(self.machine, None if load is None else load.point, run, self.progress)
        return MachineUnderLoad(replace(self.origin, housing=self.solved_housing()), loaded, load, warnings)

    def found_load(self) -> "tuple[SolvedLoad | None, Sequence[ResultWarning]]":
        """Find the operating point of the machine where something loads it, and its warnings."""
        from gearwhine.coupling.load_analysis.load_warnings import find_load

        return find_load(self.machine, self.progress) if self.machine.is_loaded else (None, ())

    @property
    def aligned_by_default(self) -> "Sequence[str]":
        """Labels of the pairs that are aligned because nothing is said of their misalignment."""
        return ()

    def on_rigid_seats(self) -> "Machine":
        """Return the machine without its housing, each bearing in a rigid seat."""
        from gearwhine.coupling.description.parts import on_rigid_seats

        machine = self.machine
        seated = on_rigid_seats(machine.shafts, machine.bearings, machine.torque_supports)
        return replace(machine, **seated, housing=None)

    def ranked_parts(self, machine: "Machine", point: "OperatingPoint", line: str | None) -> "LoadSensitivity":
        """Rank the parts of the machine by what they change in gear pairs and in a line."""
        from gearwhine.coupling.load_analysis.ranking import rank_parts

        plan = self.settings.transient
        run = None if plan is None else plan.run
        acoustics = self.settings.acoustics
        return rank_parts(machine, point, acoustics=acoustics, run=run, line=line, progress=self.progress)

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

    def doubts_of_acoustics(self, acoustics: "Acoustics") -> "list[ResultWarning]":
        """Return warnings of numbers of the acoustics that are unlikely."""
        from gearwhine.numerics.result_warnings import warning

        return [warning("acoustics", str(finding)) for finding in acoustics.findings]

    def solved_sound(
        self,
        acoustics: "Acoustics",
        housing: "HousingModes",
        lines: "MotionLines | None",
        machine: "CoupledMachine | None",
    ) -> "tuple[SolvedSound, HousingModes]":
        """Solve the sound of a housing's modes, and of the lines of a motion; the housing holds that of its modes."""
        from gearwhine.solve.kept_radiation import sound_of_housing

        return sound_of_housing(acoustics, housing, lines, machine, self.progress)

    def _assumed_mesh_damping(self) -> tuple[str, ...]:
        """Return the gear pairs whose mesh damping nobody gave."""
        return ()

    def _diagram_speeds(self) -> tuple[float, ...]:
        """Return the signed speeds of a diagram [rad/s], ascending in size: the settings', else up beyond operation."""
        from gearwhine.numerics.speed_ranges import campbell_speeds

        if self.machine.speed == 0.0:
            raise self._no_speeds("speed", "a speed: a diagram over speed is of a machine that turns")
        chosen = tuple(sorted(set(self.settings.speeds), key=abs))
        speeds = chosen or campbell_speeds(self.machine.speed, self._held_speeds())
        if len(speeds) < 2:
            raise self._no_speeds("speeds" if chosen else "bearings", "two or more speeds for a diagram over speed")
        return speeds

    def _branch_speeds(self, *, down: bool) -> tuple[float, float]:
        """Return the signed speeds from which and to which a motion is followed [rad/s], by default about operation."""
        from gearwhine.numerics.speed_ranges import BEYOND_OPERATION, SLOWEST_OF_BRANCH

        low, high = self._held_speeds()
        speeds = sorted(self.settings.speeds, key=abs)
        if not speeds:
            sense, size = math.copysign(1.0, self.machine.speed), abs(self.machine.speed)
            speeds = [sense * max(SLOWEST_OF_BRANCH * size, low), sense * min(BEYOND_OPERATION * size, high)]
        first, last = speeds[0], speeds[-1]
        if not 0.0 < abs(first) < abs(last) or min(speeds) * max(speeds) <= 0.0:
            expected = "a range of speeds above zero, of one sense, over which a motion is followed"
            raise self._no_speeds("speeds" if self.settings.speeds else "bearings", expected)
        return (last, first) if down else (first, last)

    def _no_speeds(self, attribute: str, expected: str) -> Exception:
        """Return the refusal of an analysis over speed; its speeds follow from the attribute."""
        from gearwhine.coupling import CouplingError

        where = {"speeds": "the speeds of the settings", "bearings": "the tables of the bearings"}
        return CouplingError(f"{where.get(attribute, attribute)}: expected {expected}")

    def _held_speeds(self) -> tuple[float, float]:
        """Return the range of speeds of the first shaft, without sense, that the bearings' tables hold [rad/s]."""
        from gearwhine.coupling.analyses.shafts_alone import held_speeds

        return held_speeds(self.machine)
