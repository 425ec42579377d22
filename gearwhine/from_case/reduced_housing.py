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
from gearwhine.exchange.file_names import is_rexs_file
from gearwhine.housing import HousingError
from gearwhine.housing.reduced import (
    LabelledMatrix,
    NodeSeat,
    NodeSensor,
    NodeSpring,
    ReducedHousing,
    ReducedMatrices,
    RowLabels,
    read_matrix,
    read_row_labels,
    reduced_matrices,
    static_stiffness,
)
from gearwhine.housing.reduced.recovery import RecoveredPoints, RecoveryFile, read_recovery
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
    read, labels, recovery = _read(table.reduced, files)
    static = read.pop("static", None)
    try:
        matrices = reduced_matrices(read, table.reduced.nodes, table.reduced.units)
        return ReducedHousing(
            matrices,
            [NodeSeat(seat.name, seat.node, seat.center) for seat in table.seat],
            [NodeSensor(one.name, one.node, one.position, unit_vector(one.direction)) for one in table.sensor],
            [
                NodeSpring(one.name, one.node, one.position, amounts(one.stiffness), amounts(one.damping))
                for one in table.support
            ],
            table.damping_ratio,
            limit=_TWO_PI * table.frequency_limit,
            static=None if static is None else static_stiffness(static, table.reduced.nodes, table.reduced.units),
            recovered=None if recovery is None else _recovered(recovery, matrices, read["stiffness"], labels, table),
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
    lines = ["[housing]"]
    if limit is not None:
        lines.append(f'frequency_limit = "{limit / _TWO_PI!r} Hz"')
    else:
        lines.append("# frequency_limit, below which the matrices are accurate, is not known: please state it")
    lines += ["damping_ratio   = 0.0    # the matrix has it", ""]
    lines.append("[housing.reduced]")
    for kind, path in files.items():
        lines.append(f"{kind} = {json.dumps(path.name, ensure_ascii=False)}")
        if path.suffix.lower() not in (".mtx", ".dof"):
            name = kind if path.suffix.lower() in (".npz", ".nc") else NAMES[kind]
            lines.append(f'{kind}_name = "{name}"')

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


def _recovered(
    recovery: RecoveryFile,
    matrices: ReducedMatrices,
    stiffness: LabelledMatrix,
    labels: RowLabels | None,
    table: ReducedTable,
) -> RecoveredPoints:
    """Return recovered points, columns that their file does not name in the order of the rows of the stiffness.

    Raises
    ------
    CaseError
        Where they do not fit the matrices.
    """
    if labels is None and stiffness.coordinates is not None:
        labels = RowLabels(stiffness.coordinates)
    try:
        return recovery.points(matrices.coordinates, labels, table.reduced.units)
    except HousingError as error:
        name = "" if table.reduced.recovery is None else table.reduced.recovery.name
        raise CaseError([Problem("housing.reduced.recovery", name, f"rows of the matrices; {error}")]) from error


def _read(
    table: ReducedFiles, files: InputFiles
) -> tuple[dict[str, LabelledMatrix], RowLabels | None, RecoveryFile | None]:
    """Read the matrices, labels of their rows, and recovery rows; each file that cannot be used is a problem."""
    read, problems, labels, recovery = dict[str, LabelledMatrix](), [], None, None
    if table.mapping is not None:
        try:
            labels = files.read(table.mapping, read_row_labels)
        except (HousingError, ChangedFileError) as error:
            expected = f"a file of the nodes of rows; {error}"
            problems.append(Problem("housing.reduced.mapping", table.mapping.name, expected))
    for kind, name in (
        ("mass", table.mass_name),
        ("stiffness", table.stiffness_name),
        ("damping", table.damping_name),
        ("static", ""),
    ):
        path = getattr(table, kind)
        if path is None:
            continue
        try:
            if is_rexs_file(path):
                matrix = files.read(path, _casing_stiffness)
            else:
                matrix = files.read(path, read_matrix, name=name, kind=kind.replace("static", "stiffness"))
            read[kind] = matrix if labels is None or kind == "static" else matrix.with_rows(labels, path.name)
        except (HousingError, ChangedFileError) as error:
            problems.append(Problem(f"housing.reduced.{kind}", path.name, f"a file of the {kind} matrix; {error}"))
    if table.recovery is not None:
        try:
            recovery = files.read(table.recovery, read_recovery)
        except (HousingError, ChangedFileError) as error:
            problems.append(Problem("housing.reduced.recovery", table.recovery.name, f"recovery rows; {error}"))
    if problems:
        raise CaseError(problems)
    return read, labels, recovery


def _casing_stiffness(path: Path) -> LabelledMatrix:
    """Read the reduced stiffness of the casing in a REXS file.

    Raises
    ------
    HousingError
        Where it has none, or is no REXS file.
    """
    from gearwhine.exchange.rexs.errors import RexsError
    from gearwhine.exchange.rexs.reading import read_rexs
    from gearwhine.exchange.rexs.reduced_casing import casing_stiffness

    try:
        return casing_stiffness(read_rexs(path))
    except RexsError as error:
        raise HousingError(str(error)) from error


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
