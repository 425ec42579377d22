"""Many boxes that have the measured frequencies of NASA's gear noise rig, judged by what was not fitted: its spectra.

Table II of NASA TM-104434 (Choy et al., 1991) lists eight measured frequencies of the housing, and its text says in
words what the spectra show. A box that is fitted to the eight frequencies is judged here by the text: 16 statements,
none of which was fitted. Whether the statements tell boxes apart shows in how differently boxes meet them that have
the eight frequencies equally well.

- ``box-1``, ``box-2``, ...: each starts at a draw of the prior of the case `nasa-gear-noise-rig-nominal` (seed =
  number), about which its own prior lies. It is fitted (:mod:`rig_box_fits`) until every frequency on elements of 12 mm
  is within 4.04 %, the largest error of the bundled box of seven parameters: such a box meets the table as well.
  Draws whose frequencies are far off are refused before they are fitted.
- ``stiff-walls``: another reading of the housing, fixed before it was run. The top is a plate of 6.35 mm, a quarter of
  an inch; walls and mounts are stiff, so that the mode of 658 Hz is the bending of the top. `gearwhine update` fits it.
- The bundled cases. Shafts, gears and bearings are those of `nasa-gear-noise-rig` for all.

Found: twenty of 110 draws meet the table and then 8 to 12 of the 16 statements; the mesh lines of such boxes scatter by
7 to 10 dB (one standard deviation). Eight frequencies do not fix a spectrum. Used in docs/rig-spectra.md, with its
tables and its figure (``--figure``).

    OMP_NUM_THREADS=1 python studies/rig_boxes.py                                # tables of what was found
    OMP_NUM_THREADS=1 python studies/rig_boxes.py --out boxes --until 20         # more boxes, until twenty meet it
    OMP_NUM_THREADS=1 python studies/rig_boxes.py --out boxes --other stiff-walls

Results are in `rig_boxes.json` beside this file, a line for each box. Boxes that are there already are not fitted
again.
"""

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import tomli_w
from matplotlib.lines import Line2D
from rig_box_fits import bias_of, fit_box

from gearwhine.case import Case, case_document, load_case
from gearwhine.case.units import amount
from gearwhine.figures.style import BLUE, FOOT, HEAD, RED, legend, panel_pair, panel_title, sheet
from gearwhine.from_case.parametric_housing import fitted_case, with_entry
from gearwhine.housing.acoustics.boundary_elements import surface_product
from gearwhine.housing.acoustics.surface_velocity import face_surface
from gearwhine.housing.updating.mesh_bias import MeshBias
from gearwhine.solve.comparison import compare_measured
from gearwhine.housing import HousingModes
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.updating import update_housing, updated_case

sys.path.append(str(Path(__file__).parents[1] / "tests" / "validation"))

from rig_statements import END, MESH_HZ, STATEMENTS, TOP, settled_runs

FloatArray = npt.NDArray[np.float64]

WITHIN = 0.0404
"""Largest error of a frequency that a box may have: that of the bundled box of seven parameters."""
FOUND = Path(__file__).with_suffix(".json")
"""Results of all boxes so far."""
_NOMINAL = "nasa-gear-noise-rig-nominal"
_BUNDLED = ("nasa-gear-noise-rig", "nasa-gear-noise-rig-updated")
_STIFF = "stiff-walls"
_SPREAD = 0.8  # of the draws, in standard deviations of the prior
_FIT = {
    "frequency_noise": 0.018,  # about half of the error that a box may have
    "gap": 0.1,
    "model_modes": {"below": "3 kHz", "least": 22, "most": 28},
}
_FITTED_ON, _JUDGED_ON = "16 mm", "12 mm"
_WALLS = ("left", "right", "bottom", "back", "front")
_STIFF_WALL, _STIFF_WALLS = "19 mm", ["12.7 mm", "32 mm"]
_STIFF_MOUNT, _STIFF_MOUNTS = "1e10 N/m", ["3e9 N/m", "1e11 N/m"]


def start_of_box(number: int) -> dict[str, Any]:
    """Case of a box at a draw of the prior, with the target of its fit."""
    fitted = fitted_case(load_case(_NOMINAL).case)
    generator = np.random.default_rng(number)
    document = dict(fitted.document)
    for one in fitted.numbers:
        drawn = one.parameter.nominal + _SPREAD * one.parameter.spread * generator.standard_normal()
        value = float(np.clip(drawn, one.parameter.low, one.parameter.high))
        if not one.given.factor:
            for location, entry in one.entries(value):
                document = with_entry(document, location, entry)
    document["update"] = {**document["update"], **_FIT}
    return document


def start_of_stiff_walls() -> dict[str, Any]:
    """Case of a box with stiff walls and mounts and a top of a quarter of an inch, which stays."""
    document = case_document(load_case(_NOMINAL).case)
    box = document["housing"]["box"]
    walls = dict.fromkeys(_WALLS, _STIFF_WALL) | {"top": "6.35 mm"}
    supports = [
        {**support, "stiffness": dict.fromkeys("xyz", _STIFF_MOUNT)} for support in document["housing"]["support"]
    ]
    document["housing"] = {
        **document["housing"],
        "box": {**box, "wall": walls, "mesh_size": _FITTED_ON},
        "support": supports,
    }
    parameters = []
    for parameter in document["update"]["parameter"]:
        key = parameter["keys"][0]
        if key == "housing.box.wall.top":
            continue
        if "wall" in key:
            parameter = {**parameter, "range": _STIFF_WALLS}
        if "stiffness" in key:
            parameter = {**parameter, "range": _STIFF_MOUNTS, "spread": "1e10 N/m"}
        parameters.append(parameter)
    document["update"] = {**document["update"], **_FIT, "explore": 3, "solves": 24, "parameter": parameters}
    return document


def top_bending(solved: HousingModes, mode: int) -> float:
    """Part of the top in the mean-square normal motion of the six outer faces, of a mode from 0."""
    moving = {}
    for name in ("top", *_WALLS):
        surface, points = face_surface(solved.mesh, solved.mesh.surface(name))
        normal = (points.transfer @ solved.modes.shapes[mode].ravel())[:, None]
        moving[name] = float(surface_product(surface, normal, normal)[0, 0].real)
    return moving["top"] / sum(moving.values())


def in_the_rig(box: str | Path) -> dict[str, Any]:
    """Case of the rig's machine in a fitted housing: shafts, bearings and sensors follow its seats and faces."""
    rig, fitted = case_document(load_case(_BUNDLED[0]).case), load_case(box).case
    housing = case_document(fitted)["housing"]
    assert fitted.housing is not None
    assert fitted.housing.box is not None
    seats = {seat.name: seat.center for seat in fitted.housing.seat}
    width, height, length = fitted.housing.box.size
    faces = {TOP: (1, height), END: (2, 0.5 * length), "side": (0, 0.5 * width)}
    for sensor in rig["housing"]["sensor"]:
        axis, place = faces[sensor["name"]]
        sensor["position"] = [place if axis == number else at for number, at in enumerate(sensor["position"])]
    for rotor in rig["rotor"]:
        rotor["axis"] = list(seats[f"{rotor['name']}-back"][:2])
    starts = {rotor["name"]: amount(rotor["start"]) for rotor in rig["rotor"]}
    for bearing in rig["bearing"]:
        bearing["at"] = seats[bearing["seat"]][2] - starts[bearing["rotor"]]
    rig["housing"] = {**housing, "sensor": rig["housing"]["sensor"]}
    return with_entry(rig, ("housing", "box", "mesh_size"), _JUDGED_ON)


def judged(path: str | Path) -> dict[str, Any]:
    """Return the errors of a box's frequencies [%], the count of modes, and whether each statement holds."""
    case = load_case(path).case
    solved = solve_housing(case)
    comparison = compare_measured(case.measured, solved).comparison
    runs = settled_runs(path, solved, [pair.mode - 1 for pair in comparison.pairs])
    first = comparison.pairs[0].mode - 1
    return {
        "errors_percent": [100.0 * (pair.model / pair.measured - 1.0) for pair in comparison.pairs],
        "gap": comparison.gap,
        "modes_below_3_khz": int(np.count_nonzero(solved.modes.frequencies_hz < 3000.0)),
        "top_bending_of_first": top_bending(solved, first),
        "statements": {name: bool(holds(runs)) for name, holds in STATEMENTS.items()},
        "mesh_lines": {sensor: {str(speed): runs(speed).mesh(sensor) for speed in MESH_HZ} for sensor in (TOP, END)},
    }


def fit(start: dict[str, Any], place: Path) -> None:
    """Fit a box by the whole of `gearwhine update` and write it as a case."""
    case = case_of(start, place)
    solved = update_housing(case, lambda message, part=None: print(f"  {message}", flush=True), threads=1)
    place.write_text(updated_case(solved), encoding="utf-8")


def case_of(start: dict[str, Any], place: Path) -> Case:
    """Write a start beside the place of its box, and read it."""
    begun = place.with_suffix(".start.toml")
    begun.write_text(tomli_w.dumps(start), encoding="utf-8")
    return load_case(begun).case


def judged_case(name: str | Path, place: Path) -> dict[str, Any]:
    """Judge a case by its name or file, put into the rig; ``place`` says where that is written."""
    rig = place.with_suffix(".rig.toml")
    rig.write_text(tomli_w.dumps(in_the_rig(name)), encoding="utf-8")
    return judged(rig)


def fitted_and_judged(number: int, folder: Path, bias: Callable[[], MeshBias]) -> dict[str, Any]:
    """Fit the box of a draw and judge it where it meets the frequencies."""
    place = folder / f"box-{number}.toml"
    fitted = fit_box(
        case_of(start_of_box(number), place), bias(), WITHIN, lambda message: print(f"  {message}", flush=True)
    )
    found: dict[str, Any] = {
        "outcome": fitted.outcome,
        "start_rms_percent": round(fitted.start_rms_percent, 1),
        "solves": fitted.solves,
        "fine_solves": fitted.fine_solves,
        "seconds": round(fitted.seconds),
    }
    if np.isfinite(fitted.largest_percent):
        found["largest_percent"] = fitted.largest_percent
    if fitted.document is None:
        return found
    place.write_text(tomli_w.dumps(fitted.document), encoding="utf-8")
    return found | {"parameters": fitted.parameters} | judged_case(place, place)


def main() -> None:
    """Fit and judge boxes, write what was found after each, and print it."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-o", "--out", type=Path, help="folder of the boxes' cases")
    parser.add_argument("--until", type=int, default=0, help="number of boxes that meet the table")
    parser.add_argument("--minutes", type=float, default=np.inf, help="time after which no box is begun")
    parser.add_argument("--other", choices=(*_BUNDLED, _STIFF), help="judge this one alone")
    parser.add_argument("--figure", type=Path, help="draw the mesh lines of what was found")
    given = parser.parse_args()
    found = read_found()
    if given.out is not None:
        given.out.mkdir(parents=True, exist_ok=True)
    if given.other:
        place = given.out / f"{given.other}.toml"
        if given.other == _STIFF and not place.exists():
            fit(start_of_stiff_walls(), place)
        found[given.other] = judged_case(place if given.other == _STIFF else given.other, place)
        write_found(found)
    bias = cache(lambda: bias_of(load_case(_NOMINAL).case))
    number, begin = 0, time.monotonic()
    while len(equal_boxes(found)) < given.until and time.monotonic() - begin < 60.0 * given.minutes:
        number += 1
        name = f"box-{number}"
        if name not in found:
            found[name] = fitted_and_judged(number, given.out, bias)
            write_found(found)
            print(f"{name}: {found[name]['outcome']}, {len(equal_boxes(found))} meet the table", flush=True)
    print_tables(found)
    if given.figure is not None:
        draw(found, given.figure)


def read_found() -> dict[str, dict[str, Any]]:
    """Read what was found, by box."""
    return dict(json.loads(FOUND.read_text(encoding="utf-8"))) if FOUND.exists() else {}


def write_found(found: dict[str, dict[str, Any]]) -> None:
    """Write what was found, a line for each box, to four digits."""
    rows = [f" {json.dumps(name)}: {json.dumps(rounded(box))}" for name, box in found.items()]
    FOUND.write_text("{\n" + ",\n".join(rows) + "\n}\n", encoding="utf-8")


def rounded(value: Any) -> Any:
    """Numbers of tables and lists to four digits."""
    if isinstance(value, dict):
        return {key: rounded(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [rounded(entry) for entry in value]
    return float(f"{value:.4g}") if isinstance(value, float) else value


def equal_boxes(found: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Boxes from draws that meet the frequencies as well as the bundled box of seven parameters."""
    return {
        name: box
        for name, box in found.items()
        if name.startswith("box-") and "statements" in box and np.abs(box["errors_percent"]).max() <= 100.0 * WITHIN
    }


def print_tables(found: dict[str, dict[str, Any]]) -> None:
    """Print the boxes judged, what became of the draws, and the tables of the documentation."""
    print(f"{'box':28} {'largest':>8} {'rms':>6} {'modes':>6} {'gap':>6} {'top':>5} {'met':>4}")
    for name, box in found.items():
        if "statements" in box:
            errors = np.array(box["errors_percent"])
            print(
                f"{name:28} {np.abs(errors).max():7.2f}% {np.sqrt((errors**2).mean()):5.2f}% "
                f"{box['modes_below_3_khz']:6d} {box['gap']:6.2f} {box['top_bending_of_first']:5.2f} "
                f"{sum(box['statements'].values()):4d}"
            )
    draws = [box for name, box in found.items() if name.startswith("box-")]
    outcomes = Counter(box["outcome"] for box in draws)
    told = ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items())
    print(f"\n{len(draws)} draws: {told}; {len(equal_boxes(found))} meet the table")
    if len(equal_boxes(found)) > 1 and _BUNDLED[0] in found:
        held = np.array([list(box["statements"].values()) for box in equal_boxes(found).values()], dtype=np.float64)
        met, part = held.sum(axis=1), held.mean(axis=0)
        print(
            f"statements met: {met.mean():.1f}, standard deviation {met.std(ddof=1):.1f}; "
            f"{np.sqrt((part * (1.0 - part)).sum()):.1f} if each held at random as often as it does"
        )
        print("", *statement_rows(found), "", *count_rows(found), "", *level_rows(found), sep="\n")


def statement_rows(found: dict[str, dict[str, Any]]) -> list[str]:
    """Table of the statements: how many of the boxes that meet Table II meet each, and whether the bundled box does."""
    equal, bundled = list(equal_boxes(found).values()), found[_BUNDLED[0]]
    rows = [f"| statement | of {len(equal)} boxes | `{_BUNDLED[0]}` |", "|---|---:|---|"]
    counts = {statement: sum(box["statements"][statement] for box in equal) for statement in STATEMENTS}
    for statement in sorted(STATEMENTS, key=lambda one: -counts[one]):
        rows.append(f"| {statement} | {counts[statement]} | {'yes' if bundled['statements'][statement] else 'no'} |")
    return rows


def count_rows(found: dict[str, dict[str, Any]]) -> list[str]:
    """Table of how many statements the boxes that meet Table II meet."""
    met = Counter(sum(box["statements"].values()) for box in equal_boxes(found).values())
    numbers = range(min(met), max(met) + 1)
    return [
        f"| statements met, of {len(STATEMENTS)} | {' | '.join(str(number) for number in numbers)} |",
        f"|---|{'---:|' * len(numbers)}",
        f"| boxes | {' | '.join(str(met[number]) for number in numbers)} |",
    ]


def level_rows(found: dict[str, dict[str, Any]]) -> list[str]:
    """Table of the mesh lines of the boxes that meet Table II: median, and levels about it."""
    equal = list(equal_boxes(found).values())
    rows = [
        f"| mesh line | median, m/s² | lowest and highest | quartiles | standard deviation | `{_BUNDLED[0]}` |",
        "|---|---:|---|---|---:|---:|",
    ]
    for sensor in (TOP, END):
        for speed in MESH_HZ:
            levels = mesh_levels(equal, sensor, speed)
            low, middle, high = np.quantile(levels, (0.25, 0.5, 0.75))
            (bundled,) = mesh_levels([found[_BUNDLED[0]]], sensor, speed)
            rows.append(
                f"| {sensor.split(' (')[0]}, {speed} rpm | {10.0 ** (middle / 20.0):.2g} "
                f"| {levels.min() - middle:+.0f} to {levels.max() - middle:+.0f} dB "
                f"| {low - middle:+.0f} to {high - middle:+.0f} dB | {levels.std(ddof=1):.0f} dB "
                f"| {bundled - middle:+.0f} dB |"
            )
    return rows


def mesh_levels(boxes: list[dict[str, Any]], sensor: str, speed: int) -> FloatArray:
    """Levels of the boxes' mesh lines [dB re 1 m/s²]."""
    return 20.0 * np.log10([box["mesh_lines"][sensor][str(speed)] for box in boxes])


def draw(found: dict[str, dict[str, Any]], place: Path) -> None:
    """Draw the mesh lines of the boxes that meet Table II, with those of the bundled case."""
    equal = list(equal_boxes(found).values())
    figure = sheet(
        62.0,
        "Mesh lines of boxes that have the same eight frequencies",
        f"{len(equal)} boxes, each within {100.0 * WITHIN:.2f} % of Table II. Acceleration at the mesh frequency; "
        "bars: median and quartiles.",
    )
    places = np.arange(len(MESH_HZ), dtype=np.float64)
    for axes, sensor in zip(panel_pair(figure, FOOT, 62.0 - FOOT - HEAD - 3.0), (TOP, END), strict=True):
        for place_of, speed in zip(places, MESH_HZ, strict=True):
            levels = mesh_levels(equal, sensor, speed)
            beside = 0.12 * np.linspace(-1.0, 1.0, len(levels))
            axes.plot(place_of + beside, levels, "o", ms=2.6, color=BLUE, mew=0.0, alpha=0.7)
            low, middle, high = np.quantile(levels, (0.25, 0.5, 0.75))
            axes.plot([place_of + 0.24] * 2, [low, high], color=BLUE, lw=1.4)
            axes.plot(place_of + 0.24, middle, "_", color=BLUE, ms=8.0, mew=1.4)
            (bundled,) = mesh_levels([found[_BUNDLED[0]]], sensor, speed)
            axes.plot(place_of - 0.24, bundled, "D", ms=4.0, color=RED, mew=0.0)
        axes.set_xticks(places, [f"{speed} rpm\n{hertz:.0f} Hz" for speed, hertz in MESH_HZ.items()])
        axes.set_xlim(-0.5, len(MESH_HZ) - 0.5)
        panel_title(axes, sensor.split(" (")[0])
        axes.set_ylabel("dB re 1 m/s²")
    handles = [
        Line2D([], [], color=BLUE, ls="", marker="o", ms=2.6, label="other boxes"),
        Line2D([], [], color=RED, ls="", marker="D", ms=4.0, label=_BUNDLED[0]),
    ]
    legend(figure, handles)
    figure.savefig(place)


if __name__ == "__main__":
    main()
