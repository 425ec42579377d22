"""What NASA TM-104434 (Choy et al., 1991) says in words of its rig's spectra, and runs to hold against it.

Figs. 4, 5, 10 and 11 are waterfalls without numbers; the text on them makes 16 statements. How much a peak must stand
out is ours. ``studies/rig_boxes.py`` judges other boxes by the same statements.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from gearwhine.case import load_case
from gearwhine.coupling import TransientOutputs, TransientSettings, simulate
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.machine.coupled_system import embed
from gearwhine.from_case.machine import describe_machine
from gearwhine.housing import HousingModes
from gearwhine.numerics.arrays import FloatArray
from gearwhine.solve.machine import reduce_housing

Runs = Callable[..., "Run"]

TOP, END = "top (node 21)", "end (node 40)"
TEETH = 28
MESH_HZ = {1500: 700.0, 3750: 1750.0, 5500: 2567.0}
"""Mesh frequencies at the speeds of the text, as printed; speed in rpm."""
LIMIT_HZ = 3200.0
# [s], until what is left of the start is below the smallest line looked at, a part of 1e-5 of the highest; and
# revolutions: pitch errors and runout repeat with each.
_SETTLING, _RECORDED = 0.6, 2
_SAMPLES = 16384  # a revolution


@dataclass(frozen=True)
class Run:
    """Settled motion: lines of the sensors by order of the shaft [m/s²], and each housing coordinate's part in them."""

    speed: float
    lines: dict[str, FloatArray]
    parts: dict[str, npt.NDArray[np.complex128]]
    mode_hz: FloatArray

    def at(self, sensor: str, order: int) -> float:
        """Line of a sensor at an order of the shaft [m/s²]."""
        return float(self.lines[sensor][order])

    def mesh(self, sensor: str) -> float:
        """Line of a sensor at the mesh frequency [m/s²]."""
        return self.at(sensor, TEETH)

    def highest(self, sensor: str) -> float:
        """Frequency of the highest line up to the housing's limit [Hz]."""
        within = self.lines[sensor][: int(LIMIT_HZ * 60.0 / self.speed) + 1]
        return float(1 + np.argmax(within[1:])) * self.speed / 60.0

    def shares(self, sensor: str) -> dict[float, float]:
        """By frequency of the housing mode [Hz], its part of the mesh line in phase with the whole."""
        parts = self.parts[sensor]
        whole = parts.sum()
        shares = (parts * np.conj(whole)).real / abs(whole) ** 2
        return dict(zip(self.mode_hz.tolist(), shares.tolist(), strict=False))


def settled_runs(name: str | Path, solved: HousingModes, dominant: list[int] | None = None) -> Runs:
    """Return ``runs(speed)`` in rpm of a rig's case; each is marched once.

    Parameters
    ----------
    name : str or Path
        Of the case.
    solved : HousingModes
        Its modes.
    dominant : list of int, optional
        Modes that ``runs(speed, eight=True)`` keeps alone, from 0, as the source did.
    """
    nominal = load_case(name).case
    whole = reduce_housing(nominal, solved)
    assert nominal.transient is not None
    given = nominal.transient

    @cache
    def run(speed: int, *, eight: bool = False) -> Run:
        case = load_case(name, (f"operation.speed={speed} rpm",)).case
        housing, frequencies = whole, whole.frequencies_hz
        if eight:
            assert dominant is not None
            housing, frequencies = _kept(whole, dominant), frequencies[dominant]
        machine = describe_machine(case, housing).assembled
        assert machine.housing is not None
        which = len(machine.rotors)
        own = np.array([embed(machine.system.components, which, row) for row in np.eye(machine.housing.size)])
        period = 60.0 / speed
        settled = int(np.ceil(_SETTLING / period))
        none = np.empty((0, machine.system.size))
        result = simulate(
            machine.system,
            TransientSettings(
                duration=(settled + _RECORDED) * period,
                record_from=settled * period,
                sample_interval=period / _SAMPLES,
                largest_step=period / given.points_per_revolution,
                tolerance=given.tolerance,
            ),
            TransientOutputs(none, none, own),
        )
        assert result.energy.error < 1e-3
        lines = np.fft.rfft(result.acceleration, axis=0)[::_RECORDED] * (2.0 / len(result.acceleration))
        return Run(
            speed=float(speed),
            lines={name: np.abs(lines @ row) for name, row in machine.housing.sensors.items()},
            parts={name: lines[TEETH] * row for name, row in machine.housing.sensors.items()},
            mode_hz=frequencies,
        )

    return run


def _kept(housing: HousingComponent, modes: list[int]) -> HousingComponent:
    """The housing on some of its modes, without attachments."""
    among = np.ix_(modes, modes)
    return replace(
        housing,
        kinds=tuple(housing.kinds[mode] for mode in modes),
        stiffness=housing.stiffness[among],
        damping=housing.damping[among],
        gyroscopic=housing.gyroscopic[among],
        seats={name: motions[modes] for name, motions in housing.seats.items()},
        sensors={name: motions[modes] for name, motions in housing.sensors.items()},
    )


def leads(run: Run, sensor: str) -> bool:
    """Whether the mesh line is the highest of the whole trace."""
    return abs(run.highest(sensor) - TEETH * run.speed / 60.0) < 1.0


def stands_out(run: Run, beside: Run, sensor: str) -> bool:
    """Whether a resonance is at least twice as high as the mesh line at a speed beside it."""
    return run.mesh(sensor) > 2.0 * beside.mesh(sensor)


def carried_near_1762_hz(run: Run) -> bool:
    """Whether the mode nearest to 1762 Hz, within 5 %, has more than half of the line on the top and the most."""
    shares = run.shares(TOP)
    nearest = min(shares, key=lambda mode: abs(mode - 1762.0))
    return abs(nearest / 1762.0 - 1.0) < 0.05 and shares[nearest] > 0.5 and shares[nearest] == max(shares.values())


def sidebands_reach_2962_hz(run: Run, sensor: str) -> bool:
    """Whether at 5750 rpm the mesh leads within 2 % of 2722 Hz, and a sideband within 2 % of 2962 Hz stands out."""
    orders = np.arange(TEETH + 1, TEETH + 6)
    near = int(orders[np.argmin(np.abs(orders * run.speed / 60.0 - 2962.0))])
    return (
        abs(run.highest(sensor) / 2722.0 - 1.0) < 0.02
        and abs(near * run.speed / 60.0 / 2962.0 - 1.0) < 0.02
        and run.at(sensor, near) > 2.0 * max(run.at(sensor, near - 1), run.at(sensor, near + 1))
    )


def peaks_rise(runs: Runs, sensor: str, **which: bool) -> bool:
    """Whether the mesh line rises with speed."""
    peaks = [runs(speed, **which).mesh(sensor) for speed in MESH_HZ]
    return peaks[0] < peaks[1] < peaks[2]


def unbalance_rises(runs: Runs, sensor: str) -> bool:
    """Whether the line at shaft speed rises with at least the square of speed."""
    lines = [runs(speed).at(sensor, 1) for speed in MESH_HZ]
    speeds = list(MESH_HZ)
    return all(lines[b] / lines[a] > (speeds[b] / speeds[a]) ** 2 for a, b in ((0, 1), (1, 2)))


STATEMENTS: dict[str, Callable[[Runs], bool]] = {
    **{
        f"mesh line leads on the {place}, {speed} rpm": (lambda runs, s=speed, n=sensor: leads(runs(s), n))
        for place, sensor in (("top", TOP), ("end", END))
        for speed in MESH_HZ
    },
    **{
        f"on the top {speed} rpm stands out beside {beside}": (
            lambda runs, s=speed, b=beside: stands_out(runs(s), runs(b), TOP)
        )
        for speed, beside in ((3750, 3500), (3750, 4000), (5500, 5750))
    },
    "a mode near 1762 Hz carries the line, 3750 rpm": lambda runs: carried_near_1762_hz(runs(3750)),
    **{
        f"sidebands reach 2962 Hz on the {place}, 5750 rpm": (
            lambda runs, n=sensor: sidebands_reach_2962_hz(runs(5750), n)
        )
        for place, sensor in (("top", TOP), ("end", END))
    },
    **{
        f"peaks on the {place} rise with speed": (lambda runs, n=sensor: peaks_rise(runs, n))
        for place, sensor in (("top", TOP), ("end", END))
    },
    **{
        f"unbalance on the {place} rises with the square of speed": (lambda runs, n=sensor: unbalance_rises(runs, n))
        for place, sensor in (("top", TOP), ("end", END))
    },
}
"""The text's statements on spectra, none of which was fitted."""
