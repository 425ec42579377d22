"""Scatter about designed values in Python: machines that differ as production makes them, the same draws for all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from gearwhine.case.optimisation import Robust
from gearwhine.coupling import CouplingError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.distributions import Distribution
from gearwhine.numerics.sampling import sobol_points
from gearwhine.optimisation.design import AS_WRITTEN


@dataclass(frozen=True)
class Scatter:
    """Machines about each design, by which :func:`gearwhine.optimise` judges it.

    A value that is designed keeps the deviation of a draw from the median about its designed value; others are drawn.

    Attributes
    ----------
    laws : mapping of str to Distribution
        Distribution of each value, of :mod:`gearwhine.numerics.distributions`.
    samples : int
        Number of machines about each design.
    deviations, quantile : float or None
        What counts of the scatter, as of `[optimisation.robust]` in a case.
    good : mapping of str to tuple
        Least and largest value of a good machine by quantity, None where there is none, for the ``yield``.
    seed : int

    Raises
    ------
    CouplingError
    """

    laws: Mapping[str, Distribution]
    samples: int = 16
    deviations: float | None = None
    quantile: float | None = None
    good: Mapping[str, tuple[float | None, float | None]] = field(default_factory=dict)
    seed: int = 1

    def __post_init__(self) -> None:
        """Refuse what is no distribution, and a measure that cannot be."""
        wrong = [name for name, law in self.laws.items() if not hasattr(law, "quantile")]
        if wrong or not self.laws:
            named = f"{wrong[0]!r} as {self.laws[wrong[0]]!r}" if wrong else "no values"
            raise CouplingError(f"scatter: {named}; expected distributions by name, such as Normal(1.0, 0.1)")
        try:
            self.robust  # noqa: B018 - its own checks
        except ValueError as error:
            text = f"samples = {self.samples}, deviations = {self.deviations}, quantile = {self.quantile}"
            expected = "2 machines or more, and deviations of 0 or more or a quantile between 0.5 and 1"
            raise CouplingError(f"scatter: {text}; expected {expected}") from error

    @cached_property
    def robust(self) -> Robust:
        """What counts of the scatter."""
        return Robust(samples=self.samples, deviations=self.deviations, quantile=self.quantile)

    @cached_property
    def points(self) -> FloatArray:
        """Points of the machines about each design in the unit cube, shape (samples, d)."""
        return sobol_points(self.samples, len(self.laws), self.seed)

    @cached_property
    def medians(self) -> dict[str, float]:
        """Median of each value."""
        return {name: float(law.quantile(np.array([0.5]))[0]) for name, law in self.laws.items()}

    def about(self, values: Mapping[str, float], point: FloatArray) -> dict[str, float]:
        """Return the values that scatter, about designed ones, at a point of the unit cube (d,); none as written."""
        return {
            name: values[name] + (float(law.quantile(np.array([at]))[0]) - self.medians[name])
            for (name, law), at in zip(self.laws.items(), point.tolist(), strict=True)
            if at != AS_WRITTEN
        }
