"""Directions that turn, as sums of constant columns: D(s) = V M(s), with few columns in V and few entries in M(s).

A law's direction with turning parts is (D(0) - Σ A) + Σ (A cos w s + B sin w s). The columns of all directions, D(0) -
Σ A, every A and every B, mostly depend on each other: the two directions of a bearing turn into each other, the meshes
of a sun push it in a plane. A column that is a sum of earlier ones is taken as that.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwhine.coupling.connector_forces.kernel_arrays import Bearings, Turning
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.connectors import LinearConnector, SpeedTable, TurningPart
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.numerics.arrays import FloatArray, IntArray

_DEPENDENT = 1e-13  # part of a column that may be left of it beside a sum of others
_WELL_POSED = 100.0  # largest factor of a column of the same size in such a sum
_MOST_AXES = 5  # directions of a law in the kernels' arrays


@dataclass(frozen=True, eq=False)
class LawDirections:
    """Directions of one law, shape (n, d), and their parts that turn."""

    directions: FloatArray
    turning: tuple[TurningPart, ...] = ()


def law_directions(system: CoupledSystem) -> list[LawDirections]:
    """Directions of all laws in the order of the kernels: contacts, nonlinear bearings, turning linear, friction."""
    laws = [LawDirections(one.direction[:, None], one.turning) for one in system.contacts]
    laws += [LawDirections(one.directions, one.turning) for one in system.nonlinear]
    laws += [LawDirections(one.directions, one.turning) for one in turning_laws(system)]
    slidings = [one.sliding for one in system.contacts if one.sliding is not None]
    return laws + [LawDirections(one.directions, one.turning) for one in slidings]


def turning_laws(system: CoupledSystem) -> list[LinearConnector]:
    """Linear connectors that turn, without directions in which nothing can move.

    Raises
    ------
    CouplingError
        Where a connector has more directions than the kernels' arrays hold.
    """
    laws = []
    for connector in system.linear:
        if not connector.turning:
            continue
        parts = [connector.directions, *(part for one in connector.turning for part in (one.cosine, one.sine))]
        moving = np.flatnonzero(np.any([np.any(part != 0.0, axis=0) for part in parts], axis=0))
        if len(moving) > _MOST_AXES:
            raise CouplingError(
                f"{connector.name}: {len(moving)} directions that turn; expected at most {_MOST_AXES} of one connector"
            )
        laws.append(_among(connector, moving))
    return laws


def _among(connector: LinearConnector, moving: IntArray) -> LinearConnector:
    """Reduce a linear connector to some of its directions."""
    square = np.ix_(moving, moving)
    table = connector.over_speed
    if table is not None:
        tables = (table.stiffness[:, moving][:, :, moving], table.damping[:, moving][:, :, moving])
        table = SpeedTable(table.speed_ratios, *tables)
    return replace(
        connector,
        directions=connector.directions[:, moving],
        stiffness=connector.stiffness[square],
        damping=connector.damping[square],
        over_speed=table,
        axes=(),
        offset=None,
        turning=tuple(TurningPart(one.rate, one.cosine[:, moving], one.sine[:, moving]) for one in connector.turning),
    )


def turning_arrays(system: CoupledSystem, nonlinear: Bearings) -> tuple[Turning, FloatArray | None, Bearings]:
    """Arrays of the directions of all laws, the columns' rows Vᵀ, shape (m, n), and bearings with the linear laws.

    Without connectors that turn the arrays are empty, there are no rows, and ``nonlinear`` is returned as it is.
    """
    if not system.turning_names:
        floats, ints = np.zeros(0), np.zeros(0, dtype=np.int64)
        tables = np.zeros((0, 0, 5, 5))
        still = Turning(floats, ints, ints, ints, floats, floats, floats, floats, tables, tables)
        return still, None, nonlinear
    laws = law_directions(system)
    rates = np.unique([part.rate for law in laws for part in law.turning]).astype(np.float64)
    raw, at = [], []
    for number, (direction, rate, which, column) in enumerate(_raw_columns(laws, rates)):
        raw.append(column)
        at.append((direction, rate, which, number))
    columns, factors = _shared_columns(np.array(raw))
    sums: dict[tuple[int, int, int], FloatArray] = {}
    for direction, rate, which, number in at:
        for place in np.flatnonzero(factors[number]).tolist():
            parts = sums.setdefault((rate, direction, place), np.zeros(3))
            parts[which] += factors[number, place]
    entries = [(*key, parts) for key, parts in sorted(sums.items(), key=lambda item: item[0])]
    coefficients = np.array([parts for *_, parts in entries])
    of_rate = np.array([rate for rate, *_ in entries])
    bearings, ratios, over_speed = _with_linear_laws(nonlinear, turning_laws(system))
    turning = Turning(
        rates=rates,
        first_of_rate=np.searchsorted(of_rate, np.arange(len(rates) + 1)).astype(np.int64),
        direction=np.array([direction for _, direction, *_ in entries], dtype=np.int64),
        column=np.array([column for _, _, column, _ in entries], dtype=np.int64),
        constant=np.ascontiguousarray(coefficients[:, 0]),
        cosine=np.ascontiguousarray(coefficients[:, 1]),
        sine=np.ascontiguousarray(coefficients[:, 2]),
        speed_ratios=ratios,
        linear=over_speed[0],
        damping=over_speed[1],
    )
    return turning, columns, bearings


def _raw_columns(laws: Sequence[LawDirections], rates: FloatArray) -> Iterator[tuple[int, int, int, FloatArray]]:
    """Yield number of the direction, number of the rate, 0 to 2 for constant, cosine and sine, and column (n,)."""
    first = 0
    for law in laws:
        still = law.directions - sum((part.cosine for part in law.turning), np.zeros_like(law.directions))
        whole = [(0, 0, still)]
        for part in law.turning:
            rate = int(np.searchsorted(rates, part.rate))
            whole += [(rate, 1, part.cosine), (rate, 2, part.sine)]
        for rate, which, columns in whole:
            for k in range(columns.shape[1]):
                if np.any(columns[:, k]):
                    yield first + k, rate, which, columns[:, k]
        first += law.directions.shape[1]


def _shared_columns(raw: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rows Vᵀ (m, n) of which all rows (p, n) are well-posed sums, and the factors (p, m)."""
    sizes = np.linalg.norm(raw, axis=1)
    touched = np.flatnonzero(np.any(raw, axis=0))
    unit = raw[:, touched] / sizes[:, None]
    kept: list[int] = []
    factors = np.zeros((len(raw), len(raw)))
    for number, column in enumerate(unit):
        if kept:
            sums = np.linalg.lstsq(unit[kept].T, column, rcond=None)[0]
            sums[np.abs(sums) < _DEPENDENT] = 0.0
            left = np.linalg.norm(column - sums @ unit[kept])
            if left <= _DEPENDENT * max(1.0, np.abs(sums).max()) and np.abs(sums).max() < _WELL_POSED:
                factors[number, : len(kept)] = sums * sizes[number] / sizes[kept]
                continue
        factors[number, len(kept)] = 1.0
        kept.append(number)
    return np.ascontiguousarray(raw[kept]), factors[:, : len(kept)]


def _with_linear_laws(
    nonlinear: Bearings, laws: Sequence[LinearConnector]
) -> tuple[Bearings, FloatArray, tuple[FloatArray, FloatArray]]:
    """Bearings with linear laws beside the nonlinear ones; speeds of tables, and `linear` and `damping` at these."""
    before, count = nonlinear.preload.size, nonlinear.preload.size + len(laws)
    tables = [law.over_speed for law in laws if law.over_speed is not None]
    ratios = np.unique(np.concatenate([table.speed_ratios for table in tables])) if tables else np.zeros(0)
    linear, damping = np.zeros((1 + len(ratios), count, 5, 5)), np.zeros((1 + len(ratios), count, 5, 5))
    linear[:, :before] = nonlinear.linear
    for number, law in enumerate(laws, before):
        own = slice(0, law.directions.shape[1])
        for row, ratio in enumerate([1.0, *ratios.tolist()]):
            stiffness, resistance = law.stiffness, law.damping
            if law.over_speed is not None:
                stiffness, resistance = law.over_speed.at(ratio)
            linear[row, number, own, own], damping[row, number, own, own] = -stiffness, resistance
    axes = [np.arange(law.directions.shape[1]) for law in laws]
    ends = nonlinear.first[-1] + np.cumsum([len(one) for one in axes], dtype=np.int64)
    bearings = nonlinear._replace(
        axis=np.concatenate([nonlinear.axis, *axes]).astype(np.int64),
        first=np.concatenate([nonlinear.first, ends]).astype(np.int64),
        linear=np.ascontiguousarray(linear[0]),
        damping=np.ascontiguousarray(damping[0]),
        fixed=np.concatenate([nonlinear.fixed, np.zeros((len(laws), 5))]),
        preload=np.concatenate([nonlinear.preload, np.zeros(len(laws))]),
        floating=np.concatenate([nonlinear.floating, np.zeros(len(laws), dtype=np.bool_)]),
        first_row=np.concatenate([nonlinear.first_row, np.full(len(laws), nonlinear.first_row[-1])]).astype(np.int64),
    )
    return bearings, ratios, (np.ascontiguousarray(linear[1:]), np.ascontiguousarray(damping[1:]))


def with_own_laws(bearings: Bearings) -> Bearings:
    """Bearings with own copies of the linear laws, which the kernels change with the speed."""
    return bearings._replace(linear=bearings.linear.copy(), damping=bearings.damping.copy())


def mixing(turning: Turning, nominal_time: float) -> tuple[FloatArray, FloatArray]:
    """M and M' at a nominal time, shapes (m, k), as in the kernels."""
    rates = np.repeat(turning.rates, np.diff(turning.first_of_rate))
    cosine, sine = np.cos(rates * nominal_time), np.sin(rates * nominal_time)
    where = turning.column, turning.direction
    mix = np.zeros((int(turning.column.max()) + 1, int(turning.direction.max()) + 1))
    mix_rate = np.zeros_like(mix)
    np.add.at(mix, where, turning.constant + turning.cosine * cosine + turning.sine * sine)
    np.add.at(mix_rate, where, rates * (turning.sine * cosine - turning.cosine * sine))
    return mix, mix_rate
