"""Cross-validation of an update: modes left out in turn, and random frequency sets as the null hypothesis.

Each is the whole search again. On the housing's own mesh it would take as long as the update itself, so all are made on
the coarser one, as if that were the housing; the measured set too, with which the random ones are compared.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from statistics import median

from gearwhine.progress import Progress
from gearwhine.stages.designs import HousingAtParameters
from housing.updating import Each, Effort, LeftOutMode, NullFit, Procedure, Target, leave_one_out, null_fits

_CLEAR = 0.1  # gap of dominance from which the choice of modes is a clear one


@dataclass(frozen=True)
class NullTest:
    """Random sets fitted, and the measured one in the same way.

    Attributes
    ----------
    measured : NullFit
    fits : list of NullFit
    """

    measured: NullFit
    fits: list[NullFit]

    @property
    def as_good_in_rms(self) -> float:
        """Part of the random sets whose root-mean-square error is no larger than that of the measured one."""
        return self._part(fit.rms_percent <= self.measured.rms_percent for fit in self.fits)

    @property
    def all_met(self) -> float:
        """Part of the random sets for which all that is asked for is met."""
        return self._part(fit.is_met for fit in self.fits)

    @property
    def median_rms_percent(self) -> float:
        """Median of the random sets' root-mean-square errors."""
        return median(fit.rms_percent for fit in self.fits)

    def within(self, percent: float, *, clear: bool = False) -> float:
        """Part of the random sets fitted within an error, if asked for with a clear choice of modes."""
        return self._part(
            fit.max_percent <= percent and (not clear or (fit.gap >= _CLEAR and fit.measures_agree))
            for fit in self.fits
        )

    def _part(self, met: Iterable[bool]) -> float:
        return sum(met) / len(self.fits)


def full_update_search(start: HousingAtParameters, effort: Effort, count: int) -> Procedure[HousingAtParameters]:
    """The update's search as it is made on the mesh of one design alone, by one thread, from there.

    Parameters
    ----------
    start : HousingDesign
    effort : Effort
        Of the update.
    count : int
        Number of starts of the multistart search, this one included.
    """
    designs = replace(start.designs, threads=1, draft=True)
    return Procedure(designs.solve, designs.parameters, start.light(), effort, count)


def leave_one_out_modes(
    procedure: Procedure[HousingAtParameters], target: Target, each: Each, progress: Progress
) -> list[LeftOutMode]:
    """Each mode predicted by a fit to the others; see :func:`housing.updating.leave_one_out`."""
    progress(f"holding back {len(target.noise)} modes, one at a time")
    return leave_one_out(procedure, target, each, progress)


def random_frequency_sets(
    procedure: Procedure[HousingAtParameters], target: Target, count: int, each: Each, progress: Progress
) -> NullTest:
    """Random sets fitted, and the measured one; see :func:`housing.updating.null_fits`."""
    progress(f"fitting the measured and {count} random sets of {len(target.noise)} frequencies")
    return NullTest(*null_fits(procedure, target, count, each=each, progress=progress))
