"""Settings of a time integration, and its output rows."""

from dataclasses import dataclass, fields
from typing import Literal, get_args

import numpy as np

from gearwhine.coupling.errors import CouplingError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Choice, Finding, Number, Rule, attribute_findings, refuse

Method = Literal["newmark", "exact", "auto"]


@dataclass(frozen=True)
class TransientSettings:
    """Settings of a time integration.

    Attributes
    ----------
    duration : float
        Duration from static equilibrium at t = 0 [s].
    record_from : float
        Start of samples and contact figures [s].
    sample_interval : float
        Even spacing at which outputs are written, whatever the steps [s].
    largest_step : float
        Largest step [s].
    tolerance : float
        Largest local error of a step, relative; see :mod:`gearwhine.coupling.time.integration`.
    beta, gamma : float
        Newmark's parameters; only with 1/4 and 1/2 the method neither gains nor loses energy.
    method : "newmark", "exact" or "auto"
        Newmark's method; exponential collocation of :mod:`gearwhine.coupling.time.exponential_collocation`, for
        constant speeds and loads without tables over time; or the exact method where it applies, else Newmark's.
    """

    duration: float
    record_from: float
    sample_interval: float
    largest_step: float
    tolerance: float = 1e-4
    beta: float = 0.25
    gamma: float = 0.5
    method: Method = "newmark"

    def __post_init__(self) -> None:
        """Require a recorded part of the duration, positive step sizes and tolerance, and a known method."""
        part = ("time integration", "")
        rules: dict[str, Rule] = dict.fromkeys(
            ("duration", "sample_interval", "largest_step", "tolerance", "beta", "gamma"), Number(above=0.0)
        )
        rules |= {"record_from": Number(at_least=0.0, unit="s"), "method": Choice(get_args(Method))}
        findings = [*attribute_findings(part, self, **rules)]
        if not findings and self.record_from >= self.duration:
            findings.append(Finding(part, "record_from", self.record_from, f"a part of the {self.duration:g} s"))
        refuse(findings, CouplingError)

    @property
    def samples(self) -> int:
        """Number of samples from ``record_from`` up to, not including, the end."""
        return int(np.ceil((self.duration - self.record_from) / self.sample_interval - 1e-6))


@dataclass(frozen=True, eq=False)
class MotionRecord:
    """Record of a transient or a periodic response at even spacing; s samples, c contacts.

    Attributes
    ----------
    times : ndarray, shape (s,)
        Times [s].
    displacement, velocity, acceleration : ndarray, shapes (s, k)
        Output rows, see :class:`TransientOutputs`.
    compression : ndarray, shape (s, c)
        Compression δ of each contact [m].
    force : ndarray, shape (s, c)
        Force of each contact [N].
    """

    times: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    compression: FloatArray
    force: FloatArray


RECORDED = tuple(field.name for field in fields(MotionRecord))


@dataclass(frozen=True)
class TransientOutputs:
    """Output rows of a time integration: each a linear combination of the n coordinates.

    Attributes
    ----------
    displacement, velocity, acceleration : ndarray, shapes (k, n)
        Rows over the coordinates, their rates, and their accelerations.
    """

    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
