"""Cross-validation of an update: modes left out in turn, and random frequency sets as the null hypothesis.

Each is the whole search again. On the housing's own mesh it would take as long as the update itself, so all are made on
the coarser one, as if that were the housing; the measured set too, with which the random ones are compared.
"""

from dataclasses import dataclass, replace

from gearwhine.progress import Progress
from gearwhine.stages.designs import HousingDesign
from housing.updating import Each, Effort, HeldBack, NullFit, Procedure, Target, hold_back, null_fits


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


def whole_search(start: HousingDesign, effort: Effort, count: int) -> Procedure[HousingDesign]:
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


def held_back_modes(
    procedure: Procedure[HousingDesign], target: Target, each: Each, progress: Progress
) -> list[HeldBack]:
    """Each mode predicted by a fit to the others; see :func:`housing.updating.hold_back`."""
    progress(f"holding back {len(target.noise)} modes, one at a time")
    return hold_back(procedure, target, each, progress)


def random_sets(
    procedure: Procedure[HousingDesign], target: Target, count: int, each: Each, progress: Progress
) -> NullTest:
    """Random sets fitted, and the measured one; see :func:`housing.updating.null_fits`."""
    progress(f"fitting the measured and {count} random sets of {len(target.noise)} frequencies")
    return NullTest(*null_fits(procedure, target, count, each=each, progress=progress))
