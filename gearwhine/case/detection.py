"""Detectability of a fault, `[detection]`: which sensor sees it, by which indicator, and from which size on."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from gearwhine.case import units
from gearwhine.case.fields import Name, Quantity, Table, Whole, wrong
from gearwhine.case.measured import Amount, KeyPath

MOST_GEARBOXES = 100_000
_AccelerationFromZero = Annotated[float, Quantity(units.ACCELERATION, at_least=0.0)]


class Detection(Table):
    """`[detection]`: a fault that grows, and what is told of it at the sensors."""

    fault: KeyPath
    """Key of the fault's size, such as "gear.driver.fault.depth" or "bearing.left.fault.length". Of a damaged tooth or
    bearing a healthy gearbox is without this fault; else, as of an unbalance, it has the value of the case."""
    severities: Annotated[tuple[Amount, ...], Field(min_length=2, max_length=1000)]
    """Sizes of the fault, ascending."""
    gear: Name | None = None
    """Gear by whose shaft signals are averaged. Default: the one of `fault`, or one on the shaft of the bearing, else
    the first driver."""
    sensors: Annotated[tuple[Name, ...], Field(max_length=1000)] = ()
    """Names of sensors. Default: all."""
    indicators: Annotated[tuple[Annotated[str, Field(max_length=100)], ...], Field(max_length=100)] = ()
    """Condition indicators: rms, residual_rms, difference_rms, fm0, fm4, m6a, m8a, na4, energy_ratio, sideband_index,
    sideband_level_factor, spectral_kurtosis, envelope, change_rms. Default: all; of a bearing's fault those of the
    signal over time, spectral_kurtosis and envelope."""
    baseline: Literal["own", "fleet"] = "own"
    """What a record is compared with: "own", an earlier record of the same gearbox without the fault, by the ratios of
    the indicators (of spectral_kurtosis by the difference), NA4 and change_rms by its average; or "fleet", the records
    of healthy gearboxes alone."""
    between: Annotated[tuple[KeyPath, ...], Field(max_length=500)] = ()
    """Keys of `[variation.vary]` that differ between two records of one gearbox, such as "operation.torque"; the others
    differ from gearbox to gearbox."""
    healthy: Annotated[int, Whole(10, MOST_GEARBOXES)] = 64
    """Number of healthy gearboxes, drawn from `[variation]`; without it as many records of the one gearbox, which
    differ by the noise."""
    faulty: Annotated[int, Whole(1, MOST_GEARBOXES)] = 8
    """Number of other gearboxes at each severity, or of records."""
    sensor_noise: _AccelerationFromZero = 0.0
    """Rms value of white noise at each sensor, between 0 Hz and the trusted limit."""
    averages: Annotated[int, Whole(1, 1_000_000)] = 100
    """Number of turns over which a monitor averages: the noise of an average is `sensor_noise` over its root."""
    false_alarm: Annotated[float, Quantity(units.RATIO, at_least=1e-6, at_most=0.4)] = 0.01
    """Probability that a healthy gearbox is above the threshold of an indicator."""
    threshold: Literal["log-normal", "normal", "order"] = "log-normal"
    """How the threshold follows from the healthy values: from a "log-normal" or a "normal" distribution fitted to them,
    or by their "order", which holds for any distribution and takes 1 / `false_alarm` - 1 of them or more. Indicators
    that are not all positive have a normal one in place of a log-normal one."""
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 1
    """Seed of the gearboxes and of the noise."""

    @field_validator("indicators", mode="after")
    @classmethod
    def _known(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        from gearwhine.coupling.analyses.gear_condition import INDICATORS
        from gearwhine.numerics.names import did_you_mean

        for number, name in enumerate(names):
            if name not in INDICATORS:
                raise wrong(f"one of {', '.join(INDICATORS)}{did_you_mean(name, INDICATORS)}", number)
        if len(set(names)) < len(names):
            raise wrong("each indicator once")
        return names

    @model_validator(mode="after")
    def _severities_ascend(self) -> Detection:
        sizes = list[float]()
        for number, written in enumerate(self.severities):
            size = units.si_amount(written)
            if size is None or (sizes and size <= sizes[-1]) or size <= 0.0:
                raise wrong("sizes above 0 with their units, ascending", "severities", number)
            sizes.append(size)
        return self

    @model_validator(mode="after")
    def _enough_healthy(self) -> Detection:
        from gearwhine.numerics.detection_probability import least_healthy

        least = least_healthy(self.false_alarm, self.threshold)
        if self.healthy < least:
            expected = f"{least} or more: a false-alarm rate of {self.false_alarm:g} by threshold = '{self.threshold}'"
            raise wrong(f"{expected} takes as many", "healthy")
        return self

    @property
    def sizes(self) -> tuple[float, ...]:
        """Severities in SI."""
        return tuple(units.si_amount(written) or 0.0 for written in self.severities)
