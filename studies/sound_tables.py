"""Tables of docs/sound.md that the bundled cases fill: methods side by side, refinement, missed peaks, moved walls.

Found: what the estimates by Rayleigh's integral and by velocity err by, how far triangles and speeds have to be refined,
and how well gradients foretell a moved wall. Used in docs/sound.md.

    OMP_NUM_THREADS=1 python studies/sound_tables.py                 # all, three quarters of an hour
    OMP_NUM_THREADS=1 python studies/sound_tables.py --only modes    # speeds, modes, refinement, peaks, walls, face

``refinement`` solves the lines of a motion on triangles of two sizes; ``peaks`` sweeps the rig over eight speeds, then
with those speeds too at which the first sweep tells of peaks that it passes by; ``walls`` and ``face`` move a wall by a
millimetre, and solve mesh, modes, operating point, lines and sound anew.
"""

import sys
import tempfile
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

import gearwhine as gw
from gearwhine.from_case.mesh import build_mesh
from gearwhine.meshes import Mesh
from gearwhine.solve import housing_modes
from gearwhine.solve.sensitivity.housing_changes import face_changes

sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))

from timing import arguments, machine, timed

RIG = "nasa-gear-noise-rig"
OUTER = ["top", "bottom", "front", "back", "left", "right"]
RPM = (1500, 3750, 5500, 5750)
REFINED: dict[str, tuple[dict[str, object], tuple[str, str]]] = {
    RIG: ({}, ("26 mm", "19 mm")),
    "small-gearbox": ({}, ("24 mm", "17 mm")),
    "two-stage-reducer": ({"acoustics.highest_frequency": "2 kHz"}, ("36 mm", "27 mm")),
    "two-stage-reducer, finer": ({"acoustics.highest_frequency": "2 kHz"}, ("27 mm", "21 mm")),
}
"""Changes of a case, and two edges of triangles."""
SWEPT = {"acoustics.mesh_size": "30 mm"}
REDUCER = {"acoustics.mesh_size": "26 mm"}
FACE = "+z at 11, 165, -72 mm"


def loaded(name: str, changes: dict[str, object]) -> gw.CaseStudy:
    """A bundled case, named before the first comma."""
    return gw.load(name.split(",")[0], changes)


def methods(changes: dict[str, object], faces: list[str]) -> list[gw.CaseStudy]:
    """A case by boundary elements, the equivalent power and Rayleigh's integral of some faces."""
    ways: list[dict[str, object]] = [{}, {"acoustics.method": "erp"}]
    ways.append({"acoustics.method": "rayleigh", "acoustics.faces": faces})
    return [gw.load(RIG, changes | way) for way in ways]


def speeds() -> None:
    """Sound power of the rig at four speeds, by three methods."""
    print("\n| speed [rpm] | boundary elements | A-weighted | ERP | Rayleigh, top alone | top's share | loudest line |")
    for rpm in RPM:
        found = [study.sound().document for study in methods({"operation.speed": f"{rpm} rpm"}, ["top"])]
        whole = found[0]
        share = whole["faces_w"]["top"] / sum(whole["faces_w"].values())
        line = max(whole["lines"], key=lambda one: one["sound_power_db"])
        levels = [whole["total_db"], whole["total_db_a"], found[1]["total_db"], found[2]["total_db"]]
        shown = " | ".join(f"{one:.1f}" for one in levels)
        part = line["contributions"]["housing_modes"][0]["name"]
        print(f"| {rpm} | {shown} | {share:.0%} | {line['name']}, {line['frequency_hz']:.0f} Hz, {part} |", flush=True)


def modes() -> None:
    """Power of each mode of the rig by the estimates over that of the boundary elements."""
    found = [study.sound().solved for study in methods({}, OUTER)]
    radiations, frequencies = [one.radiation for one in found], found[0].mode_frequencies
    print("\n| mode | σ | ERP | Rayleigh, six walls |")
    for number, hertz in enumerate(frequencies):
        rates = np.zeros((radiations[0].modal[0].shape[1], 1), complex)
        rates[number] = 1.0
        exact, erp, rayleigh = (one.solve(float(hertz), rates) for one in radiations)
        apart = [10.0 * np.log10(one.power / exact.power) for one in (erp, rayleigh)]
        print(f"| {hertz:.0f} Hz | {exact.radiation_efficiency:.2f} | {apart[0]:+.2f} | {apart[1]:+.2f} |", flush=True)


def refinement() -> None:
    """Lines on finer triangles, of those that carry all but 1e-3 of the power."""
    for name, (changes, edges) in REFINED.items():
        coarse, fine = (loaded(name, changes | {"acoustics.mesh_size": edge}).sound().document for edge in edges)
        sizes = [one["surface"]["triangles"] for one in (coarse, fine)]
        print(f"\n{name}: {sizes[0]} and {sizes[1]} triangles, six edges a wavelength up to "
              f"{coarse['surface']['resolved_below_hz']:.0f} Hz", flush=True)  # fmt: skip
        for one, other in zip(coarse["lines"], fine["lines"], strict=True):
            apart = one["sound_power_db"] - other["sound_power_db"]
            told = f"{one['sound_power_db']:.2f} {apart:+.3f} dB, known source {one['known_source_error']:.0%}"
            print(f"  {one['frequency_hz']:7.1f} Hz {told} and {other['known_source_error']:.0%}  {one['name']}")
        print(f"  together {coarse['total_db']:.2f} {coarse['total_db'] - fine['total_db']:+.3f} dB", flush=True)


def peaks() -> None:
    """Peaks that a sweep passes by, as told and as found by one that has their speeds."""
    with tempfile.TemporaryDirectory() as folder:
        told = swept(np.linspace(1500.0, 5500.0, 8).tolist(), Path(folder) / "first")
        levels = {point["settings"]["operation.speed"]: point["sound"]["total_db"] for point in told["points"]}
        print(f"\n{levels}\n| speed | line | estimate | found, loudest line | all lines | rise over the louder point |")
        found = swept(told["speeds_to_add_rpm"], Path(folder) / "second")["points"]
    for peak, point in zip(sorted(told["missed_peaks"], key=lambda one: one["speed_rpm"]), found, strict=True):
        loudest = point["sound"]["loudest"]
        heard = f"{loudest['name']} {loudest['sound_power_db']:.1f} | {point['sound']['total_db']:.1f}"
        print(
            f"| {peak['speed_rpm']:.0f} | {peak['line']} | {peak['level_db']:.1f} | {heard} | {peak['rise_db']:.1f} |"
        )


def swept(speeds: list[float], folder: Path) -> dict[str, Any]:
    """Document of the rig's sweep over speeds [rpm]."""
    texts = [f"{speed:g} rpm" for speed in sorted(speeds)]
    return gw.load(RIG, SWEPT | {"sweep.speed": texts}).sweep(folder=folder).document


def line_levels(study: gw.CaseStudy, mesh: Mesh | None = None) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Document of the operating point with its sensitivity, and its loudest lines; on a mesh where one is given."""
    given = nullcontext() if mesh is None else mock.patch.object(housing_modes, "build_mesh", return_value=mesh)
    with given:
        document = study.operating_point(sensitivity=True).document
    return document, document["loudest_lines"]


def compared(before: dict[str, Any], row: dict[str, Any], others: list[list[dict[str, Any]]]) -> None:
    """Print what a row of the sensitivity tells beside what was found for the step, and for the reverse one."""
    for number, line in enumerate(before["loudest_lines"]):
        told = row["sound"][number]
        shown = f"{told['first_order_db']:+.2f} {told['level_db']:+.2f}"
        for lines, key in zip(others, ("level_db", "reverse_level_db"), strict=False):
            (same,) = [one for one in lines if abs(one["frequency_hz"] - line["frequency_hz"]) < 1.0]
            found = same["sound_power_db"] - line["sound_power_db"]
            shown += f"  {key} {told[key]:+.2f} found {found:+.2f}"
        print(f"  {line['frequency_hz']:.0f} Hz {line['sound_power_db_a']:.1f} dB(A) first order, level {shown}")


def walls() -> None:
    """The small gearbox's walls by a millimetre either way."""
    study = gw.load("small-gearbox", REDUCER)
    before, _ = line_levels(study)
    for row in before["sensitivity"]:
        if row["kind"] != "housing" or not row["parameter"].endswith(" wall"):
            continue
        face = row["parameter"].removesuffix(" wall")
        others = [line_levels(gw.load("small-gearbox", REDUCER | {f"housing.box.wall.{face}": edge}))[1]
                  for edge in ("11 mm", "9 mm")]  # fmt: skip
        print(f"{face}", flush=True)
        compared(before, row, others)


def face() -> None:
    """The outside of the reducer's front wall by a millimetre."""
    study = gw.load("two-stage-reducer", REDUCER)
    before, lines = line_levels(study)
    (row,) = [one for one in before["sensitivity"] if one["parameter"] == FACE]
    mesh = build_mesh(study.case.housing, study.case.material, study.case.input_files)
    (velocity,) = [one.rate.velocity for one in face_changes(mesh, [seat.name for seat in study.case.housing.seat]) if one.parameter == FACE]
    assert velocity is not None
    moved = replace(mesh, points=mesh.points + 1e-3 * velocity)
    _, after = line_levels(gw.load("two-stage-reducer", REDUCER), moved)
    print(f"\n{FACE}", flush=True)
    compared(before, row, [after])
    either = [10.0 * np.log10(sum(10.0 ** (0.1 * one["sound_power_db_a"]) for one in some)) for some in (lines, after)]
    print(f"  together {either[0]:.1f} dB(A), told {row['sound_a']}, found {either[1] - either[0]:+.2f}")


TABLES: dict[str, Callable[[], None]] = {
    "speeds": speeds,
    "modes": modes,
    "refinement": refinement,
    "peaks": peaks,
    "walls": walls,
    "face": face,
}


def main() -> None:
    """Print the tables."""
    given = arguments(__doc__ or "", only=(str, "", f"one table: {', '.join(TABLES)}"))
    print(machine())
    for name, table in TABLES.items():
        if given.only in ("", name):
            _, seconds = timed(table)
            print(f"{name}: {seconds:.0f} s", flush=True)


if __name__ == "__main__":
    main()
