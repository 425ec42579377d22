"""Solution of a whole run of a case or a machine, with its labelled arrays and figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Self

from gearwhine.analyses.origin import Origin
from gearwhine.analyses.result import Result
from gearwhine.numerics.progress import Progress
from gearwhine.output.dataset import LabelledArrays, Labels, labelled
from gearwhine.results.condition import CONDITION
from gearwhine.results.gears import GEARS
from gearwhine.results.housing import HOUSING
from gearwhine.results.operating_point import LOAD
from gearwhine.results.rotors import ROTORS
from gearwhine.results.run import RUN_SIGNATURE, TRANSIENT, HistoryStream, TracedTransient
from gearwhine.results.sound import SOUND
from gearwhine.results.system import SYSTEM

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearwhine.coupling.analyses.gear_condition import MachineCondition
    from gearwhine.coupling.analyses.gear_pairs import PairAnalysis
    from gearwhine.coupling.analyses.modes_and_responses import SolvedSystem
    from gearwhine.coupling.analyses.motion import MachineMotion
    from gearwhine.coupling.analyses.run_up import RunSignature
    from gearwhine.coupling.analyses.signature import SolvedSignature
    from gearwhine.coupling.analyses.transient import SolvedTransient
    from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
    from gearwhine.coupling.sound.solution import SolvedSound
    from gearwhine.housing import HousingModes
    from gearwhine.housing.correlation import Comparison
    from gearwhine.rotors.analyses.solved_rotor import SolvedRotor


@dataclass(frozen=True)
class RunSolution:
    """Solution of a whole run, None or empty where an analysis is not asked for."""

    rotors: tuple[SolvedRotor, ...] = ()
    pairs: tuple[PairAnalysis, ...] = ()
    housing: HousingModes | None = None
    comparison: Comparison | None = None
    system: SolvedSystem | None = None
    transient: SolvedTransient | None = None
    signature: SolvedSignature | None = None
    run_signature: RunSignature | None = None
    load: SolvedLoad | None = None
    sound: SolvedSound | None = None
    condition: MachineCondition | None = None
    tones_hz: Mapping[str, float] = field(default_factory=dict)

    def with_motion(
        self, motion: MachineMotion | None, condition: MachineCondition | None, tones_hz: Mapping[str, float]
    ) -> Self:
        """Return the solution with a motion over time, what is read off its record, and the tones of its bearings."""
        if motion is None:
            return self
        return replace(
            self,
            transient=motion.transient,
            signature=motion.signature,
            run_signature=motion.run_signature,
            condition=condition,
            tones_hz=tones_hz,
        )

    def indicators(self, names: Sequence[str] = ()) -> MachineCondition:
        """Find condition indicators of the gears and bearings by sensor.

        Parameters
        ----------
        names : sequence of str
            Indicators of :data:`gearwhine.coupling.analyses.gear_condition.INDICATORS`; by default all of one record.

        Raises
        ------
        gearwhine.coupling.CouplingError
            Where there is no motion, or an indicator is none of them.
        """
        from gearwhine.coupling import CouplingError
        from gearwhine.coupling.analyses.condition_record import condition_record
        from gearwhine.coupling.analyses.gear_condition import OF_ONE_RECORD, machine_condition

        if self.transient is None:
            raise CouplingError("condition indicators: expected a motion over time, as of a case with [transient]")
        return machine_condition(condition_record(self.transient, self.tones_hz), tuple(names) or OF_ONE_RECORD)

    def result(self, command: str, origin: Origin, document: dict[str, Any], **written: Any) -> Result[RunSolution]:
        """Return the result of the analyses that were made; ``written`` are further fields of it."""
        return Result(
            command,
            origin.case,
            self,
            document,
            _arrays=lambda: self.arrays(origin.labels),
            _figures=partial(self.figures, origin.title),
            _housing=self.housing,
            _title=origin.title,
            **written,
        )

    def arrays(self, labels: Labels) -> LabelledArrays:
        """Return the labelled arrays of the analyses that were made."""
        streams = () if self.transient is None else (HistoryStream(self.transient),)
        return labelled(
            labels,
            (HOUSING, self.housing),
            (ROTORS, self.rotors),
            (GEARS, self.pairs),
            (LOAD, self.load),
            (SYSTEM, self.system),
            (TRANSIENT, None if self.transient is None else TracedTransient(self.transient, self.signature)),
            (RUN_SIGNATURE, self.run_signature),
            (SOUND, self.sound),
            (CONDITION, self.condition),
            streams=streams,
        )

    def figures(self, title: str, progress: Progress) -> Iterator[tuple[str, Figure]]:
        """Draw the figures of the analyses that were made, each with its name."""
        yield from self.figures_before_motion(title, progress)
        yield from self.figures_of_system(progress)
        yield from self.figures_of_motion(title, progress)

    def figures_before_motion(self, title: str, progress: Progress) -> Iterator[tuple[str, Figure]]:
        """Draw those of gear pairs, load and comparison with measured modes, which need no coupled machine."""
        from gearwhine import figures

        if self.pairs:
            yield from figures.draw_gear_pairs(self.pairs, progress)
        if self.load is not None:
            yield from figures.draw_load(self.load)
        if self.housing is not None and self.comparison is not None:
            progress("drawing the comparison with measured modes")
            yield from figures.draw_comparison_figures(title, self.comparison, self.housing.modes.frequencies)

    def figures_of_system(self, progress: Progress) -> Iterator[tuple[str, Figure]]:
        """Draw those of the coupled machine."""
        from gearwhine import figures

        if self.system is not None:
            progress("drawing the coupled system")
            yield from figures.draw_system(self.system)

    def figures_of_motion(self, title: str, progress: Progress) -> Iterator[tuple[str, Figure]]:
        """Draw those of its motion and sound."""
        from gearwhine import figures

        if self.condition is not None and self.condition.envelopes:
            yield "envelope", figures.draw_envelopes(title, self.condition)
        if self.transient is not None:
            progress("drawing the motion")
            parts_of_motion = self.transient, self.signature, self.housing, self.comparison
            yield from figures.draw_transient(title, *parts_of_motion)
        if self.transient is not None and self.run_signature is not None:
            yield from figures.draw_run(title, self.transient, self.run_signature)
        if self.sound is not None:
            progress("drawing the sound")
            yield from figures.draw_sound(title, self.sound)
