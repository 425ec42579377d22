"""Reduced housing of a case as the library's description, and as a component of its machine."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from gearwhine.case import CaseError, Problem
from gearwhine.case.errors import UNSAID
from gearwhine.case.fields import unit_vector
from gearwhine.case.fixtures import amounts
from gearwhine.case.input_files import ChangedFileError, InputFiles
from gearwhine.case.reduced_housing import ReducedFiles
from gearwhine.case.reduced_housing import ReducedHousing as ReducedTable
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.machine.reduced_component import InterfaceMatrices, component_of_reduced_housing
from gearwhine.housing import HousingError
from gearwhine.housing.reduced import (
    LabelledMatrix,
    NodeSeat,
    NodeSensor,
    NodeSpring,
    ReducedHousing,
    read_matrix,
    reduced_matrices,
)
from gearwhine.housing.reduced.writing import NAMES

_TWO_PI = 6.283185307179586
_KEYS = {"limit": "housing.frequency_limit", "damping_ratio": "housing.damping_ratio"}


def reduced_component(table: ReducedTable | None, files: InputFiles) -> HousingComponent | None:
    """Return a reduced housing as a component of its machine; None without one.

    Raises
    ------
    CaseError
        As :func:`build_reduced_housing`.
    """
    if table is None:
        return None
    housing = build_reduced_housing(table, files)
    try:
        return component_of_reduced_housing(housing)
    except HousingError as error:
        raise CaseError(_problems(table, error)) from error


def build_reduced_housing(table: ReducedTable, files: InputFiles) -> ReducedHousing:
    """Read the matrices of a reduced housing and build its description.

    Raises
    ------
    CaseError
        With what is wrong with the files, their matrices, or with what is at their nodes.
    """
    read = _read(table.reduced, files)
    try:
        return ReducedHousing(
            reduced_matrices(read, table.reduced.nodes, table.reduced.units),
            [NodeSeat(seat.name, seat.node, seat.center) for seat in table.seat],
            [NodeSensor(one.name, one.node, one.position, unit_vector(one.direction)) for one in table.sensor],
            [
                NodeSpring(one.name, one.node, one.position, amounts(one.stiffness), amounts(one.damping))
                for one in table.support
            ],
            table.damping_ratio,
            limit=_TWO_PI * table.frequency_limit,
        )
    except HousingError as error:
        raise CaseError(_problems(table, error)) from error


def tables_of(reduced: InterfaceMatrices, files: Mapping[str, Path], limit: float | None) -> str:
    """Tables of a case, as TOML, that take reduced matrices from files.

    Parameters
    ----------
    reduced : InterfaceMatrices
    files : mapping of str to path
        Files of the matrices by kind.
    limit : float or None
        Frequency below which they are accurate [rad/s]; None where it is unknown.
    """
    frequency = f"{limit / _TWO_PI!r} Hz" if limit is not None else "… Hz"
    lines = ["[housing]", f'frequency_limit = "{frequency}"', "damping_ratio   = 0.0    # the matrix has it", ""]
    lines.append("[housing.reduced]")
    for kind, path in files.items():
        lines.append(f"{kind} = {json.dumps(path.name, ensure_ascii=False)}")
        if path.suffix.lower() != ".mtx":
            name = kind if path.suffix.lower() == ".npz" else NAMES[kind]
            lines.append(f'{kind}_name = "{name}"')
    if all(path.suffix.lower() in (".mtx", ".op4") for path in files.values()):
        lines.append(f"nodes = {[seat.node for seat in reduced.seats]}")

    def at(place: Sequence[float]) -> str:
        return "[" + ", ".join(f'"{number!r} m"' for number in map(float, place)) + "]"

    for seat in reduced.seats:
        name = json.dumps(seat.name, ensure_ascii=False)
        lines += ["", "[[housing.seat]]", f"name   = {name}", f"node   = {seat.node}", f"center = {at(seat.center)}"]
    for sensor in reduced.sensors:
        name = json.dumps(sensor.name, ensure_ascii=False)
        lines += ["", "[[housing.sensor]]", f"name      = {name}", f"node      = {sensor.node}"]
        lines += [f"position  = {at(sensor.position)}", f"direction = {[*map(float, sensor.direction)]}"]
    return "\n".join([*lines, ""])


def _read(table: ReducedFiles, files: InputFiles) -> dict[str, LabelledMatrix]:
    """Read the matrices; each file that cannot be used is a problem of its key."""
    read, problems = dict[str, LabelledMatrix](), []
    for kind in ("mass", "stiffness", "damping"):
        path = getattr(table, kind)
        if path is None:
            continue
        try:
            read[kind] = files.read(path, read_matrix, name=getattr(table, f"{kind}_name"))
        except (HousingError, ChangedFileError) as error:
            problems.append(Problem(f"housing.reduced.{kind}", path.name, f"a file of the {kind} matrix; {error}"))
    if problems:
        raise CaseError(problems)
    return read


def _problems(table: ReducedTable, error: HousingError) -> list[Problem]:
    """Return findings as problems of the keys that they come from."""
    names = {
        "seat": [seat.name for seat in table.seat],
        "sensor": [sensor.name for sensor in table.sensor],
        "support": [support.name for support in table.support],
    }
    problems = []
    for finding in error.findings:
        kind, name = finding.part
        value = UNSAID if finding.value is None else finding.value
        place = names[kind].index(name) if name in names.get(kind, ()) else None
        if place is not None:
            key, label = f"housing.{kind}[{place}].{finding.attribute}", f'{kind} "{name}"'
            problems.append(Problem(key, value, finding.expected, label=label))
            continue
        key = _KEYS.get(finding.attribute, "housing.reduced" + f".{name}" * bool(name))
        if finding.attribute in ReducedFiles.model_fields:
            key = f"housing.reduced.{finding.attribute}"
        label = "" if finding.attribute in (*_KEYS, *ReducedFiles.model_fields) else finding.attribute
        problems.append(Problem(key, value, finding.expected, label=label))
    return problems
