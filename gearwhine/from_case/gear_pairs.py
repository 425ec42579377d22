"""Gear pairs of a case: geometry, contact law, and static transmission error under the mean torque."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, CaseError, Problem, pair_torques, require, rotor_speeds, shaft_of
from gearwhine.case import GearPair as GivenPair
from gearwhine.case.errors import UNSAID
from gearwhine.case.input_files import ChangedFileError
from gearwhine.coupling.analyses.gear_pairs import TakenMisalignment
from gearwhine.coupling.description.gear_train import LARGEST_OFFSET
from gearwhine.coupling.description.parts import inertia_with_discs
from gearwhine.coupling.gears import GearPairGeometry, StiffnessModel, stiffness_model
from gearwhine.coupling.gears.geometry.pair import pair_label
from gearwhine.coupling.gears.loaded.gear_pair import GearPair, LoadedGearPair, load_gear_pair
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.from_case.rotors import build_gear, shaft_gears
from gearwhine.numerics.progress import Progress, silent

FloatArray = npt.NDArray[np.float64]


def solve_gears(
    case: Case, progress: Progress = silent, gaps: Mapping[tuple[str, str], tuple[float, ...]] | None = None
) -> tuple[LoadedGearPair, ...]:
    """Solve every gear pair of the case.

    ``gaps`` are those of the flanks over the face by driver and driven gear, where the misalignment is to be found.
    Without one, flanks whose misalignment the case leaves out are aligned.

    Raises
    ------
    CaseError, gearwhine.coupling.gears.GearError
        Where the case has no gear pairs, or one cannot be solved as it stands.
    """
    require(case, "gear_pair", command="gears")
    torques = pair_torques(case) if case.operation else (0.0,) * len(case.gear_pair)
    speeds = rotor_speeds(case) if case.operation else {}
    solved = []
    for number, (entry, torque) in enumerate(zip(case.gear_pair, torques, strict=True)):
        progress(f"gear pair {entry.driver} -> {entry.driven}")
        loaded = load_gear_pair(
            aligned_pair(build_pair(case, entry, number), gaps or {}),
            pair_geometry(case, entry),
            torque=torque,
            inertias=(_inertia(case, entry.driver), _inertia(case, entry.driven)),
            speed=speeds.get(shaft_of(case.gear_named(entry.driver))),
        )
        solved.append(loaded)
    return tuple(solved)


def misalignments_of_case(
    case: Case, point: OperatingPoint | None, *, is_sought: bool = True
) -> tuple[TakenMisalignment, ...]:
    """Misalignment of every gear pair of the case, beside that of its operating point where it is solved.

    ``is_sought`` is false before that point is sought: flanks that are left to it are not yet taken as aligned.
    """
    misalignments = []
    for number, entry in enumerate(case.gear_pair):
        at_operating_point = None if point is None or not point.pairs else point.pairs[number].misalignment
        if case.finds_misalignment(entry) and not (is_sought and at_operating_point is None):
            misalignments.append(TakenMisalignment(at_operating_point, "operating point", at_operating_point))
        elif isinstance(entry.misalignment, float | int):
            misalignments.append(TakenMisalignment(entry.misalignment, "case", at_operating_point))
        else:
            misalignments.append(TakenMisalignment(0.0, "default", at_operating_point))
    return tuple(misalignments)


def aligned_by_default(case: Case) -> tuple[str, ...]:
    """Return the labels of the pairs whose misalignment the case leaves out, and no operating point has."""
    return tuple(
        pair_label(pair.driver, pair.driven)
        for pair in case.gear_pair
        if pair.misalignment is None and not case.finds_misalignment(pair)
    )


def build_pair(case: Case, entry: GivenPair, number: int = 0) -> GearPair:
    """Build a gear pair of the case for `coupling.gears`; ``number`` is its place in the list, for messages."""
    angle = None if case.finds_misalignment(entry) or entry.misalignment == "found" else entry.misalignment or 0.0
    stiffness: StiffnessModel | str = entry.stiffness.model
    if entry.stiffness.file is not None:
        key = f"gear_pair[{number}].stiffness.file"
        try:
            position, values = case.input_files.read(entry.stiffness.file, _table, key=key)
        except ChangedFileError as error:
            raise CaseError([Problem(key, UNSAID, str(error))]) from error
        stiffness = stiffness_model("table", position=position, stiffness=values)
    elif entry.stiffness.value is not None:
        stiffness = stiffness_model(entry.stiffness.model, value=entry.stiffness.value)
    return GearPair(
        driver=entry.driver,
        driven=entry.driven,
        stiffness=stiffness,
        damping_ratio=entry.damping_ratio,
        damping=entry.damping,
        backlash=entry.backlash,
        friction=entry.friction,
        misalignment=angle,
        corner_contact=entry.corner_contact,
    )


def aligned_pair(pair: GearPair, gaps: Mapping[tuple[str, str], tuple[float, ...]]) -> GearPair:
    """Give a pair whose misalignment is to be found the gap of its flanks over the face, if there is one."""
    if pair.misalignment is not None or (pair.driver, pair.driven) not in gaps:
        return pair
    return replace(pair, misalignment=0.0, face_gap=gaps[pair.driver, pair.driven])


def pair_geometries(case: Case) -> tuple[GearPairGeometry, ...]:
    """Return the geometry of every gear pair of the case."""
    return tuple(pair_geometry(case, pair) for pair in case.gear_pair)


def pair_geometry(case: Case, pair: GivenPair) -> GearPairGeometry:
    """Return the pair's geometry at the centre distance of its shafts, or without backlash where shafts are missing."""
    driver, driven = (build_gear(case, case.gear_named(name)) for name in (pair.driver, pair.driven))
    offset = case.axial_offset(pair)
    return GearPairGeometry(driver, driven, case.centre_distance(pair), offset if abs(offset) > LARGEST_OFFSET else 0.0)


def _table(path: Path, key: str) -> tuple[FloatArray, FloatArray]:
    """Return two columns of a CSV file, with or without a line of names: position [base pitches], stiffness [N/m]."""
    rows = []
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise CaseError([Problem(key, str(path), "a text file in UTF-8")]) from error
    for number, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            first, second = (float(part) for part in line.split(","))
        except ValueError as error:
            if number == 1:
                continue
            expected = f"two numbers with a comma between in line {number} of {path}"
            raise CaseError([Problem(key, line[:60], expected)]) from error
        rows.append((first, second))
    if len(rows) < 2:
        raise CaseError([Problem(key, str(path), "at least two rows: position in base pitches, stiffness in N/m")])
    columns = np.array(rows, dtype=np.float64).T
    return columns[0], columns[1]


def _inertia(case: Case, name: str) -> float:
    """Polar inertia that rotates with a gear [kg m²], with the discs at its station."""
    entry = case.gear_named(name)
    if entry.rotor is None:
        return entry.polar_inertia or build_gear(case, entry).polar_inertia
    gears = shaft_gears(case, entry.rotor)
    (gear,) = (shaft_gear for shaft_gear in gears if shaft_gear.name == name)
    return inertia_with_discs(gear, case.rotor_named(entry.rotor).build(case.material), gears)
