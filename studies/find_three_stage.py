"""Find shafts that have the frequencies of TM-101442, Table I: find_three_stage.py

Prints, for each stage of the bundled case `three-stage`, the frequencies found and the changes of the case that give
them. The memorandum prints fifteen frequencies and no dimension, so this is an inverse problem with many answers; the
one taken is the nearest to a nominal design: least squares over the logarithms of twelve sizes a stage,

    Σ (ln(f / f_table) / 0.001)² + Σ (ln(p / p_nominal) / spread)²,

the first sum over the stage's five frequencies: three lateral ones in a plane on averaged supports, and two elastic
torsional ones of the free shaft. Lengths are rounded to 1 mm first, then diameters to 0.1 mm, then bearing stiffnesses
to three digits, what is left free being fitted again each time. There is no chance in the search: it always ends alike.

Found: rotors whose fifteen frequencies are within 0.2 % of the table, one solution of many. Used in the bundled case
`three-stage` (gearwhine/cases/three-stage.toml), which tests/validation/test_three_stage.py holds against the table,
and in docs/three-stage.md.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

import gearwhine as gw
from gearwhine.rotors import solve_lateral_modes, solve_torsional_modes

FloatArray = npt.NDArray[np.float64]

_CLOSE = 0.001  # how near the frequencies are to come, as a part of them
_SPREADS = {
    "left overhang": 0.15,
    "bearing to gear": 0.15,
    "gear to bearing": 0.15,
    "right overhang": 0.15,
    "left stub": 0.1,
    "left shaft": 0.1,
    "right shaft": 0.1,
    "right stub": 0.1,
    "left disc": 0.1,
    "right disc": 0.1,
    "left stiffness": 0.2,
    "right stiffness": 0.2,
}
"""How far each size may stray from its nominal value: about so many parts of it."""

_ROUNDING: tuple[tuple[Callable[[str], bool], Callable[[float], float]], ...] = (
    (lambda size: size.endswith(("overhang", "gear", "bearing")), lambda length: round(length, 3)),
    (lambda size: size.endswith(("stub", "shaft", "disc")), lambda diameter: round(diameter, 4)),
    (lambda size: size.endswith("stiffness"), lambda stiffness: float(f"{stiffness:.3g}")),
)


@dataclass(frozen=True)
class Stage:
    """A stage of the example: its row of Table I, and the design that the search starts from and stays near.

    Attributes
    ----------
    number : int
    disc_width : float
        [m], not varied.
    lateral_hz, torsional_hz : tuple of float
        Table I.
    nominal : tuple of float
        Lengths and diameters [m], then stiffnesses [N/m], in the order of the spreads.
    """

    number: int
    disc_width: float
    lateral_hz: tuple[float, float, float]
    torsional_hz: tuple[float, float]
    nominal: tuple[float, ...]

    @property
    def table_hz(self) -> FloatArray:
        """The five frequencies [Hz], lateral ones first."""
        return np.array(self.lateral_hz + self.torsional_hz)


STAGES = (
    Stage(
        number=1,
        disc_width=0.1,
        lateral_hz=(115, 145, 190),
        torsional_hz=(355, 1090),
        nominal=(0.225, 0.44, 0.53, 0.225, 0.18, 0.138, 0.138, 0.18, 0.3, 0.3, 9.5e7, 1.5e8),
    ),
    Stage(
        number=2,
        disc_width=0.05,
        lateral_hz=(160, 189, 264),
        torsional_hz=(550, 1610),
        nominal=(0.13, 0.25, 0.55, 0.18, 0.117, 0.117, 0.09, 0.09, 0.168, 0.2, 1e8, 7.5e7),
    ),
    Stage(
        number=3,
        disc_width=0.05,
        lateral_hz=(110, 200, 260),
        torsional_hz=(280, 820),
        nominal=(0.13, 0.2, 0.4, 0.21, 0.077, 0.077, 0.067, 0.067, 0.177, 0.247, 6.5e7, 4e7),
    ),
)


def drawn(stage: Stage, sizes: Mapping[str, float]) -> list[str]:
    """A stage's sizes as changes of the case: shafts from stub to gear to stub, with a disc flush with either end."""
    lengths = [sizes[size] for size in ("left overhang", "bearing to gear", "gear to bearing", "right overhang")]
    joints = np.cumsum([0.0, *lengths])
    gear, end, half = joints[2], joints[4], 0.5 * stage.disc_width
    rotor = f"rotor.stage-{stage.number}"
    changes = {f"{rotor}.start": -gear, f"{rotor}.unbalance.0.at": gear, f"gear.gear-{stage.number}.at": gear}
    if stage.number == 1:
        changes["operation.at"] = end  # the torque comes in at the right end
    shafts = [sizes[size] for size in ("left stub", "left shaft", "right shaft", "right stub")]
    for number, (length, diameter) in enumerate(zip(lengths, shafts, strict=True)):
        segment = f"{rotor}.segments.{number}"
        changes |= {f"{segment}.length": length, f"{segment}.diameter": diameter}
    places = {"left": (half, joints[1]), "right": (end - half, joints[3])}
    for number, (side, (disc, bearing)) in enumerate(places.items()):
        changes[f"{rotor}.discs.{number}.at"] = disc
        changes[f"{rotor}.discs.{number}.width"] = stage.disc_width
        changes[f"{rotor}.discs.{number}.diameter"] = sizes[f"{side} disc"]
        changes[f"{rotor}.discs.{number}.bore"] = sizes[f"{side} stub"]
        held = f"bearing.stage-{stage.number}-{side}"
        changes[f"{held}.at"] = bearing
        changes |= {f"{held}.stiffness.{axis}": sizes[f"{side} stiffness"] for axis in ("xx", "yy")}
    return [f"{key}={value:.12g}" for key, value in changes.items()]


def own_frequencies(machine: gw.Machine, name: str) -> FloatArray:
    """A rotor's first three lateral frequencies in a plane and first two elastic torsional ones [Hz], uncoupled."""
    rotor = machine.rotor(name)
    supports = [mounted.bearing.mean_support for mounted in machine.bearings if mounted.rotor == name]
    lateral = solve_lateral_modes(rotor, supports, count=3).frequencies[:3]
    torsional = solve_torsional_modes(rotor, count=3).frequencies[1:3]
    return np.concatenate([lateral, torsional]) / (2.0 * math.pi)


def find(stage: Stage) -> dict[str, float]:
    """The sizes of a stage that meet Table I nearest to its nominal design, rounded."""
    nominal = dict(zip(_SPREADS, stage.nominal, strict=True))
    sizes, free = dict(nominal), list(_SPREADS)
    for is_rounded, rounding in _ROUNDING:
        sizes |= _fitted(stage, sizes, nominal, free)
        sizes |= {size: rounding(sizes[size]) for size in free if is_rounded(size)}
        free = [size for size in free if not is_rounded(size)]
    return sizes


def _fitted(
    stage: Stage, sizes: Mapping[str, float], nominal: Mapping[str, float], free: list[str]
) -> dict[str, float]:
    """The free sizes, fitted with the others held."""
    middle = np.log([nominal[size] for size in free])
    spread = np.array([_SPREADS[size] for size in free])

    def trial(logarithms: FloatArray) -> dict[str, float]:
        return dict(zip(free, np.exp(logarithms).tolist(), strict=True))

    def misfit(logarithms: FloatArray) -> FloatArray:
        study = gw.load("three-stage", drawn(stage, {**sizes, **trial(logarithms)}))
        found = own_frequencies(study.machine, f"stage-{stage.number}")
        return np.concatenate([np.log(found / stage.table_hz) / _CLOSE, (logarithms - middle) / spread])

    start = np.log([sizes[size] for size in free])
    return trial(least_squares(misfit, start, diff_step=np.full(len(free), 1e-6), x_scale=spread).x)


def main() -> None:
    for stage in STAGES:
        changes = drawn(stage, find(stage))
        found = own_frequencies(gw.load("three-stage", changes).machine, f"stage-{stage.number}")
        errors = 100.0 * (found / stage.table_hz - 1.0)
        print(
            f"stage {stage.number}:", ", ".join(f"{f:.2f} Hz ({e:+.2f} %)" for f, e in zip(found, errors, strict=True))
        )
        print("\n".join(f"    {change}" for change in changes))


if __name__ == "__main__":
    main()
