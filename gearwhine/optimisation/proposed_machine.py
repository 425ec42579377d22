"""Proposed machines of Python: a function makes each of them by the values of a design, with scatter about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from gearwhine.coupling import CouplingError, Machine
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.numerics.arrays import FloatArray
from gearwhine.optimisation.design import AS_WRITTEN
from gearwhine.optimisation.scatter import Scatter
from gearwhine.optimisation.verification import Moving
from gearwhine.variation.machines import VariedMachine


@dataclass(frozen=True, eq=False)
class ProposedMachine(VariedMachine):
    """Machines of designs; a point has the coordinates of the design, then those of the scatter.

    Attributes
    ----------
    first : mapping of str to float
        Values of the start.
    scatter : Scatter or None
    plan : TransientPlan or None
        Stretch of the motion, by which proposed designs are checked.
    """

    first: Mapping[str, float] = field(default_factory=dict)
    scatter: Scatter | None = None
    plan: TransientPlan | None = None

    @cached_property
    def key(self) -> str:
        """Key of all that the evaluations depend on but their points."""
        return content_key({"designs": super().key, "first": dict(self.first), "scatter": repr(self.scatter)})

    def values(self, point: FloatArray) -> dict[str, float]:
        """Return the values of a design at a point, or of a machine of its scatter, by name."""
        own = point[: len(self.inputs)].tolist()
        designed = {one.name: one.value(at) for one, at in zip(self.inputs, own, strict=True) if at != AS_WRITTEN}
        values = dict(self.first) | designed
        if self.scatter is None:
            return values
        values = self.scatter.medians | values
        return values | self.scatter.about(values, point[len(own) :])

    def moving(self, point: FloatArray | None) -> Moving:
        """Return the machine of a design, and how its motion is found.

        Raises
        ------
        CouplingError
            Where it is none, or no stretch is given.
        """
        machine = self.made(point)
        if not isinstance(machine, Machine) or self.plan is None:
            raise CouplingError("optimise: expected a machine of the best values, as of the start")
        return machine, self.plan, None
