"""Study: the analyses of a machine, each a call that returns a labelled result.

The command line is made from the same methods: their parameters are its options, their docstrings its help.
"""

import os
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from gearwhine.housing_study import HousingAnalyses
from gearwhine.numerics.findings import Instance, Number, Numbers, Rule, Text, argument_findings, refuse
from gearwhine.numerics.result_warnings import warning
from gearwhine.studied_machine import StudiedMachine
from gearwhine.view_names import GearPart

if TYPE_CHECKING:
    from gearwhine.analyses.result import Result
    from gearwhine.analyses.run_solution import RunSolution
    from gearwhine.case.optimisation import Aim
    from gearwhine.coupling.analyses.gear_pairs import PairAnalysis
    from gearwhine.coupling.analyses.modes_and_responses import SolvedSystem
    from gearwhine.coupling.analyses.recording import TransientPlan
    from gearwhine.coupling.analyses.steady_state import SolvedSteady
    from gearwhine.coupling.gears.loaded.optimal_relief import ReliefAim
    from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
    from gearwhine.coupling.sound import Acoustics
    from gearwhine.coupling.sound.solution import SolvedSound
    from gearwhine.detection.detectability import DetectionResult
    from gearwhine.figures.rotors.assembly import RotorAssembly
    from gearwhine.housing import HousingModes
    from gearwhine.numerics.distributions import Discrete, Distribution, Uniform
    from gearwhine.optimisation.optimised import Optimised
    from gearwhine.optimisation.scatter import Scatter
    from gearwhine.output.export import Signals
    from gearwhine.results_folder import Format
    from gearwhine.rotors.analyses.solved_rotor import SolvedRotor
    from gearwhine.solve.case_summary import CheckedCase, CheckedMachine
    from gearwhine.sweep.grid import SweptPoint
    from gearwhine.sweep.points import GridPoint
    from gearwhine.variation.statistics import VariedResult


SIDEBANDS = Number(at_least=0, at_most=20, whole=True)
HARMONICS = Number(at_least=1, at_most=50, whole=True)
POINTS = Number(at_least=2, at_most=2000, whole=True)
AT_LEAST_ONE = Number(at_least=1, whole=True)
NOT_NEGATIVE = Number(at_least=0, whole=True)
_SPEEDS = Numbers(each=Number(unit="rad/s"))


class Study(StudiedMachine, HousingAnalyses):
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

    def rotors(self, **settings: Any) -> "Result[tuple[SolvedRotor, ...]]":
        """Lateral and torsional modes, whirl and critical speeds of each rotor.

        Each is alone in its bearings on rigid seats. Campbell diagrams go over the speeds of the settings, by default
        up to 1.5 times the speed of the machine.

        Parameters
        ----------
        **settings
            Attributes of :class:`gearwhine.rotors.analyses.solved_rotor.RotorSettings`: ``mode_count=8`` (by default
            12), ``orders=(2.0,)`` of further critical speeds, ``gravity``, ``forces``, ``unbalances``, ``bow``,
            ``probes``, ``torsion``, ``stiffness_map``; ``operation``, ``whirl_speeds``, ``diagram_speeds`` and
            ``response_speeds`` [rad/s], for all rotors alike in place of those of the machine.
        """
        from gearwhine.analyses.machine_results import rotors_result

        solved = self.solved_rotors(**settings)

        def assemblies() -> "list[RotorAssembly]":
            from gearwhine.figures.rotors import shaft_assembly

            return [shaft_assembly(self.machine, one.rotor.name, one.bearings) for one in solved]

        carriers = {shaft.name: shaft.carrier for shaft in self.machine.shafts if shaft.carrier is not None}
        return rotors_result(solved, self.origin, assemblies, carriers)

    def gears(
        self, aims: "Sequence[ReliefAim]" = (), *, without: Sequence[GearPart] = ()
    ) -> "Result[tuple[PairAnalysis, ...]]":
        """Gear pairs: geometry, mesh stiffness, transmission error, load sharing, contact pressure, optimal tip relief.

        Parameters
        ----------
        aims : sequence of ReliefAim, optional
            Objective of the best relief of each pair; by default those of
            :func:`gearwhine.coupling.analyses.gear_pairs.default_aims`.
        without : sequence of {"harris-map", "relief"}
            What to leave out: the Harris maps, or the search for the best tip relief, which takes most of the time.

        Raises
        ------
        gearwhine.coupling.CouplingError, gearwhine.coupling.gears.GearError
            Where the machine has no gear pairs, there are more or fewer aims than pairs, or a pair cannot be solved.
        """
        from gearwhine.analyses.machine_results import gears_result, require_aims, require_parts
        from gearwhine.coupling import CouplingError
        from gearwhine.coupling.analyses.gear_pairs import analyse_machine, default_aims
        from gearwhine.coupling.analyses.loaded_machine import point_of_flanks

        machine = self.machine
        if not machine.gear_pairs:
            raise CouplingError("gears: expected a machine with a gear pair")
        require_aims(aims, len(machine.gear_pairs))
        require_parts(without, aims)
        point = point_of_flanks(machine, self.progress)
        analysed = analyse_machine(machine, point, self.progress)
        chosen = aims
        if not aims and "relief" not in without:
            chosen = default_aims(machine, point, [pair.solved for pair in analysed], self.progress)
        analysed = tuple(replace(pair, aim_given=bool(aims)) for pair in analysed)
        seats = None if point is None or machine.housing is None else "housing"
        return gears_result(analysed, chosen, without, self.origin, seats, self.progress)

    def operating_point(
        self,
        *,
        over_torque: bool = False,
        sensitivity: bool = False,
        line: str | None = None,
        rigid_seats: bool = False,
        carrier_turn: bool = False,
    ) -> "Result[SolvedLoad]":
        """Load on the whole machine at rest: bearing loads, deflections, misalignment and load of the gear faces.

        Parameters
        ----------
        over_torque : bool
            Also solve from 10 to 150 % of the torque.
        sensitivity : bool
            Also rank walls and bearings by what they change in gear pairs, in the lines of sensors and, with
            [acoustics], in the sound power of the loudest lines.
        line : str, optional
            Line that --sensitivity ranks and draws: a sensor, or with its frequency in Hz, 'roof@1377'; or of the
            sound, 'sound@1377'. By default the highest, and the A-weighted sum of the loudest.
        rigid_seats : bool
            Hold the bearings in rigid seats; leave the housing out.
        carrier_turn : bool
            Also solve over a turn of each planet carrier.

        Raises
        ------
        gearwhine.coupling.CouplingError
            Where the parts do not make a machine, nothing loads it, there is no such line, or a load drives a motion
            that nothing holds.
        gearwhine.coupling.EquilibriumNotFoundError
            Where no equilibrium is found.
        """
        from gearwhine.analyses.machine_results import load_result
        from gearwhine.coupling.load_analysis.solved_load import solve_load

        _require_arguments("load", line=(line, Text(optional=True)))
        self.require("load")
        ranked = sensitivity or line is not None
        housing = None if rigid_seats else self.solved_housing(with_sound=ranked)
        machine = self.on_rigid_seats() if rigid_seats else self.machine
        solved = solve_load(
            machine,
            self.progress,
            over_torque=over_torque,
            over_hunting_period=True,
            carrier_turn=carrier_turn,
            aligned_by_default=self.aligned_by_default,
        )
        if ranked:
            ranking = self.ranked_parts(machine, solved.point, line)
            solved = replace(solved, sensitivity=ranking)
            if housing is not None and ranking.lines is not None:
                housing = housing.with_responses(ranking.lines.responses)
        return load_result(solved, replace(self.origin, housing=housing), self.progress)

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
            Also compute the Campbell diagram, the responses to unbalance and the mesh harmonics of the sensors over
            speed: over the speeds of the settings ([sweep]), else up to 1.5 times the operating speed. Two or more
            speeds of the settings imply it.
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

        _require_arguments("system", sidebands=(sidebands, SIDEBANDS), mesh_harmonics=(mesh_harmonics, HARMONICS))
        _require_arguments("system", mesh_phase=(mesh_phase, Number(optional=True)))
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
        self,
        *,
        curve: bool = False,
        down: bool = False,
        points: Annotated[int, POINTS] = 100,
        exact: bool = False,
        superpose: bool = False,
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
            period, such as the meshes of several stages and the unequal teeth of two gears whose hunting period is
            longer than 300 mesh cycles, are solved one by one and superposed.
        superpose : bool
            Superpose them however short the common period is; not together with ``exact``.

        Raises
        ------
        gearwhine.coupling.CouplingError
            Where the parts do not make a machine, or a number is out of its range.
        gearwhine.coupling.PeriodicError
            Where no periodic motion is found.
        """
        from gearwhine.analyses.machine_results import steady_result
        from gearwhine.coupling.analyses.steady_state import solve_steady

        _require_arguments("steady", points=(points, POINTS))
        self.require("steady")
        machine = self.under_load()
        speeds = self._branch_speeds(down=down) if curve or down else None
        solved = solve_steady(
            machine.coupled, self.progress, over_speed=speeds, points=points, exact=exact, superpose=superpose
        )
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
            Attributes of :class:`gearwhine.coupling.analyses.recording.TransientPlan`: ``revolutions`` or ``run``,
            ``discard`` (by default half of the revolutions), ``points_per_revolution=200``, ``tolerance=5e-4``,
            ``start="equilibrium"``, ``method="newmark"``, ``modal_coordinates=0``, ``indicators=False``.

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

        plans = Instance(TransientPlan, "a TransientPlan, or None", optional=True)
        _require_arguments("simulate", plan=(plan, plans))
        require_either("simulate", "a TransientPlan", plan, stretch)
        if plan is None and not stretch:
            self.require("simulate")
            plan = self.settings.transient
        else:
            self.require("simulate with a plan")
        plan = TransientPlan(**stretch) if plan is None else plan
        machine = self.under_load(plan)
        modes = coupled_modes(machine.coupled.system, mean_contact(machine.coupled.system))
        return motion_result(machine, self.motion(machine, plan, modes), modes)

    def sweep(
        self, speeds: Sequence[float] = (), plan: "TransientPlan | None" = None
    ) -> "Result[Sequence[SweptPoint[GridPoint]]]":
        """Integrate the motion over time at each of several speeds, one after the other.

        The sound of the motions is no part of it; :meth:`sound` finds that at one speed.

        Parameters
        ----------
        speeds : sequence of float
            Signed speeds of the first driver's shaft [rad/s]; by default those of the settings.
        plan : TransientPlan, optional
            Stretch of the motion, by default that of the settings.

        Raises
        ------
        gearwhine.coupling.CouplingError
            Where there is no plan or no speed, or a speed is 0. A speed at which no motion is found has its failure in
            the result.
        """
        from gearwhine.analyses.sweep_result import solve_speed_sweep
        from gearwhine.coupling.analyses.recording import TransientPlan

        plans = Instance(TransientPlan, "a TransientPlan, or None", optional=True)
        _require_arguments("sweep", speeds=(speeds, _SPEEDS), plan=(plan, plans))
        if plan is None:
            self.require("sweep")
            plan = self.settings.transient
        assert plan is not None
        message = "the sound is left out of a sweep of a machine of Python; study.sound() finds it at one speed"
        warnings = [] if self.settings.acoustics is None else [warning("sound_of_sweep", message)]
        return solve_speed_sweep(
            self.machine, tuple(speeds) or self.settings.speeds, plan, self.origin, warnings, self.progress
        )

    def changed(self, changes: Mapping[str, object]) -> "Study":
        """Return a study of the same machine with other values of some attributes; this one stays as it is.

        Parameters
        ----------
        changes : mapping of str to object
            Values, in SI, or parts by the paths of attributes of the machine, with names of parts in brackets:
            ``{"torque": 80.0, "gears[pinion].gear.bore": 0.02}``.

        Raises
        ------
        ValueError
            Where a path leads nowhere, or the machine cannot be.
        """
        from gearwhine.coupling.description.changed import changed

        return Study(changed(self.machine, changes), self.settings, self.progress)

    def check(self) -> "Result[CheckedMachine] | Result[CheckedCase]":
        """Check the machine and show speeds, mesh frequencies, torques and sizes; solve nothing.

        Raises
        ------
        gearwhine.coupling.gears.GearError
            Where a fault is not one of its gear.
        """
        from gearwhine.output.quantity import document_of
        from gearwhine.results.check import CHECKED_MACHINE
        from gearwhine.solve.case_summary import check_machine

        checked = check_machine(self.machine, self.settings)
        return self.origin.result("check", checked, document_of(CHECKED_MACHINE, checked))

    def vary(
        self,
        laws: "Mapping[str, Distribution]",
        samples: Annotated[int, AT_LEAST_ONE] = 256,
        *,
        analyses: Sequence[str] | None = None,
        quantities: Sequence[str] = (),
        limits: "Mapping[str, tuple[float | None, float | None]] | None" = None,
        correlations: "Mapping[tuple[str, str], float] | None" = None,
        indices: bool = False,
        widen: float | None = None,
        seed: Annotated[int, NOT_NEGATIVE] = 1,
        folder: str | os.PathLike[str] | None = None,
        workers: Annotated[int | None, AT_LEAST_ONE] = None,
        scheduler: str | None = None,
        fresh: bool = False,
    ) -> "Result[VariedResult]":
        """Many machines as production makes them, by the distributions of attributes: scatter, causes and yield.

        The speeds of levels, the transient and the acoustics are those of the settings. :func:`gearwhine.vary` varies
        machines that a function makes.

        Parameters
        ----------
        laws : mapping of str to Distribution
            Distributions of :mod:`gearwhine.numerics.distributions` in SI, by paths as of :meth:`changed`.
        samples : int
            Number of machines.
        analyses, quantities, limits, correlations, indices, widen, seed, folder, workers, scheduler, fresh
            As of :func:`gearwhine.vary`. Processes are started where they are worth it, as many as cores.

        Raises
        ------
        gearwhine.coupling.CouplingError
            Where a path leads nowhere, or an analysis is none of the machine.
        CaseError
            Where a limit is of a quantity that the machines do not have.
        gearwhine.failures.WorkersError
            Where the processes do not start.
        """
        from gearwhine.analyses.variation_result import (
            Drawn,
            correlation_of_laws,
            inputs_of_laws,
            study_folder,
            vary_machine,
        )
        from gearwhine.coupling.description.changed import changed
        from gearwhine.variation.machines import made

        drawn = Drawn(samples, seed, indices, widen, correlation_of_laws(laws, correlations))
        inputs, make = inputs_of_laws("vary", laws), partial(changed, self.machine)
        made(make, {one.name: one.value(0.5) for one in inputs})
        origin = replace(self.origin, housing=self.solved_housing())
        with study_folder(self.progress, folder, workers, scheduler, fresh=fresh) as place:
            return vary_machine(
                make, self.machine, inputs, drawn, self.settings, place,
                origin=origin, analyses=analyses, quantities=quantities, limits=limits,
            )  # fmt: skip

    def detect(
        self,
        fault: str,
        sizes: Sequence[float],
        laws: "Mapping[str, Distribution] | None" = None,
        *,
        folder: str | os.PathLike[str] | None = None,
        workers: Annotated[int | None, AT_LEAST_ONE] = None,
        scheduler: str | None = None,
        fresh: bool = False,
        **keys: Any,
    ) -> "Result[DetectionResult]":
        """Which sensor sees a fault by which indicator, and from which size on, with what probability.

        Healthy machines give the threshold, those with the fault the probability of detection. The motion is that of
        the settings' transient.

        Parameters
        ----------
        fault : str
            Path of the fault's size as of :meth:`changed`, such as ``gears[pinion].gear.faults[0].depth``. Of a damage
            of a tooth or of a bearing a healthy machine is without it; else it has the value of the machine.
        sizes : sequence of float
            Sizes of the fault in SI, ascending.
        laws : mapping of str to Distribution, optional
            Distributions of varied attributes by path; without any all machines are alike, and records differ by noise.
        folder, workers, scheduler, fresh
            As of :meth:`vary`.
        **keys
            Keys of `[detection]` in SI: ``sensor_noise=0.1, healthy=64, faulty=8, indicators=["fm4"]``; ``between``
            has paths.

        Raises
        ------
        CaseError
            Where a key cannot be, a size is beyond what the model allows, there is no such sensor or gear, or the
            record holds too few turns.
        gearwhine.coupling.CouplingError
            Where a path leads nowhere or to no number, there is no transient, or the machine has no record.
        gearwhine.failures.WorkersError
            Where the processes do not start.
        """
        from gearwhine.analyses.detection_result import detect_in_machine
        from gearwhine.analyses.variation_result import inputs_of_laws, study_folder
        from gearwhine.coupling.description.changed import changed
        from gearwhine.variation.machines import made

        inputs = inputs_of_laws("detect", laws) if laws else ()
        make = partial(changed, self.machine)
        made(make, {one.name: one.value(0.5) for one in inputs})
        origin = replace(self.origin, housing=self.solved_housing())
        with study_folder(self.progress, folder, workers, scheduler, fresh=fresh) as place:
            return detect_in_machine(
                make, self.machine, fault, sizes, inputs, self.settings, place, origin, **keys
            )  # fmt: skip

    def optimise(
        self,
        laws: "Mapping[str, Uniform | Discrete]",
        aims: "Mapping[str, str | Aim]",
        evaluations: Annotated[int, AT_LEAST_ONE] = 100,
        *,
        limits: "Mapping[str, tuple[float | None, float | None]] | None" = None,
        analyses: Sequence[str] | None = None,
        scatter: "Scatter | None" = None,
        method: Literal["search", "grid"] = "search",
        levels: int = 5,
        seed: Annotated[int, NOT_NEGATIVE] = 1,
        folder: str | os.PathLike[str] | None = None,
        workers: Annotated[int | None, AT_LEAST_ONE] = None,
        scheduler: str | None = None,
        fresh: bool = False,
    ) -> "Result[Optimised]":
        """Which machine is best, by ranges of attributes, aims and limits; several aims have a Pareto front.

        The search starts from the values of the machine. The speeds of levels, the transient and the acoustics are
        those of the settings. :func:`gearwhine.optimise` designs machines that a function makes.

        Parameters
        ----------
        laws : mapping of str to Uniform or Discrete
            Ranges or lists of values in SI, by paths as of :meth:`changed`.
        aims : mapping of str to str or Aim
            "least" or "most" by the name of a quantity.
        evaluations : int
            Largest number of designs that a search tries.
        limits, analyses, scatter, method, levels, seed, folder, workers, scheduler, fresh
            As of :func:`gearwhine.optimise`. Processes are started where they are worth it, as many as cores.

        Raises
        ------
        gearwhine.coupling.CouplingError
            Where a path leads nowhere or to no number, or an aim, a limit or a range cannot be.
        CaseError
            Where an aim or a limit is of a quantity that the machines do not have.
        gearwhine.failures.MissingExtraError
            Where several aims need a package that is not installed.
        gearwhine.failures.WorkersError
            Where the processes do not start.
        """
        from gearwhine.analyses.optimisation_result import SearchSettings, designed_inputs, optimise_machine
        from gearwhine.analyses.variation_result import study_folder
        from gearwhine.coupling.description.changed import changed, number_at
        from gearwhine.variation.machines import made

        search = SearchSettings(method, evaluations, seed)
        inputs, make = designed_inputs(laws, levels), partial(changed, self.machine)
        first = {path: number_at(self.machine, path) for path in laws}
        made(make, first | ({} if scatter is None else scatter.medians))
        with study_folder(self.progress, folder, workers, scheduler, fresh=fresh) as place:
            return optimise_machine(
                make, self.machine, inputs, first, aims, search, self.settings, place,
                origin=replace(self.origin, housing=self.solved_housing()),
                limits=limits, analyses=analyses, scatter=scatter,
            )  # fmt: skip

    def sound(self, acoustics: "Acoustics | None" = None, /, **settings: Any) -> "Result[SolvedSound]":
        """Sound power, radiation efficiency and sound pressure of the housing's modes and of the steady motion's lines.

        Parameters
        ----------
        acoustics : Acoustics, optional
            Method and medium, floor and microphones; or its attributes by name: ``method="erp", floor=-0.02``. By
            default those of the settings, else boundary elements in free air.
        **settings
            Attributes of :class:`gearwhine.coupling.sound.Acoustics`: ``method="boundary-elements"``, ``density``,
            ``speed_of_sound``, ``mesh_size``, ``highest_frequency``, ``close_holes``, ``caps="move"``, ``floor``,
            ``still``, ``faces``, ``microphone``, ``microphone_box``, ``lines=40``.

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

        require_either("sound", "an Acoustics", acoustics, settings)
        if acoustics is None:
            given = self.settings.acoustics
            acoustics = Acoustics(**settings) if given is None or settings else given
        housing = radiating_housing(self.machine, acoustics)
        warnings = [*self.left_out_of_sound(None), *self.doubts_of_acoustics(acoustics)]
        machine = None if self.left_out_of_sound(None) else self.under_load()
        return sound_result(housing, acoustics, self.origin, machine, warnings, self.progress)

    def run(self) -> "Result[RunSolution]":
        """Find everything: rotors, gears, operating point, modes and responses, transient, and sound where it is asked.

        The motion is that of the settings' transient; without one there is none.
        """
        from gearwhine.whole_run import WholeRun

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
        from gearwhine.whole_run import WholeRun

        with ExitStack() as until_written:
            run = WholeRun(self, self.settings.transient, Path(folder), until_written, pictures=pictures)
            return run.result().stored(Path(folder), pictures=pictures, progress=self.progress)

    def report(self, folder: str | os.PathLike[str], *, interactive: bool = False) -> Path:
        """Write all results in a folder as one HTML page; return the file.

        See :func:`gearwhine.results_folder.write_report`.
        """
        from gearwhine.results_folder import write_report

        written = write_report(Path(folder), self.origin.case, interactive=interactive, progress=self.progress)
        return Path(folder) / str(written["files"][0])

    def export(
        self,
        folder: str | os.PathLike[str],
        formats: "Sequence[Format]" = ("csv", "uff", "wav"),
        *,
        signals: "Signals" = "sensors",
        seconds: float | None = None,
    ) -> list[str]:
        """Write results in formats of other programs; see :func:`gearwhine.results_folder.export_results`.

        Returns
        -------
        list of str
            The files, relative to the folder.
        """
        from gearwhine.results_folder import export_results

        return list(export_results(Path(folder), formats, signals=signals, seconds=seconds)["files"])

    def required_housing(self, command: str) -> "HousingModes":
        """Return the solved housing of the machine; where there is none, the command is refused.

        Raises
        ------
        gearwhine.coupling.CouplingError
        """
        from gearwhine.coupling import CouplingError

        housing = self.solved_housing()
        if housing is None:
            expected = "a machine whose housing is solved, as gearwhine.Housing.modes gives"
            raise CouplingError(f"{command}: expected {expected}")
        return housing


def require_either(verb: str, kind: str, given: object, named: Mapping[str, object]) -> None:
    """Refuse an object beside its attributes by name.

    Raises
    ------
    gearwhine.coupling.CouplingError
    """
    from gearwhine.coupling import CouplingError

    if given is not None and named:
        raise CouplingError(
            f"{verb}: expected {kind} or its attributes by name, got both: {', '.join(named)} beside it"
        )


def _require_arguments(verb: str, **given: tuple[object, Rule]) -> None:
    """Refuse arguments that are not as their rules have them."""
    from gearwhine.coupling import CouplingError

    refuse(argument_findings((verb, ""), given), CouplingError)
