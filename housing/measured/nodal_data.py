"""Data at nodes of a universal file: mode shapes as data set 55 and as analysis results, data set 2414.

Both have header records in columns of ten and thirteen characters, and then for each node a record with its number and
one or more with its values, six a line, real or complex. Data set 55 is what programs for modal tests write; 2414
replaced it in I-DEAS, and is what NX, Simcenter and solvers write. They differ in where the header has what:

| | data set 55 | data set 2414 |
|---|---|---|
| kind of data: analysis, characteristic, result, number type, values a node | record 6 | record 9, after the location |
| frequency and damping of a normal mode | record 8, fields 1, 3, 4 | record 12, fields 2, 5, 6 |
| eigenvalue of a complex mode | record 8, fields 1 and 2 | record 13, fields 1 and 2 |

(Universal file formats of the Structural Dynamics Research Laboratory, University of Cincinnati.)
"""

import re
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.numerics.arrays import ComplexArray, FloatArray

NORMAL, COMPLEX_FIRST, COMPLEX_SECOND = 2, 3, 7  # analysis types that are modes
_MODES = (NORMAL, COMPLEX_FIRST, COMPLEX_SECOND)
_AT_NODES = 1
_VECTORS = (3, 6)  # values a node: translations, and these with rotations
_COMPLEX = (5, 6)  # number types
_MOTIONS_OF_2414 = (8, 11, 12, 95, 96)  # displacement, velocity, acceleration; unknown vectors of 3 and 6 values
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d+)?")
_FIELDS_A_LINE = 6


@dataclass(frozen=True)
class NodalMode:
    """One mode of a universal file.

    Attributes
    ----------
    number : {55, 2414}
        Data set.
    frequency : float
        Undamped natural frequency [rad/s]; 0 of a rigid motion.
    damping_ratio : float
    hysteretic : bool
        Whether the damping ratio is half of a hysteretic loss factor, the only damping that is given.
    nodes : ndarray of int, shape (n_nodes,)
    motions : ndarray of complex, shape (n_nodes, 3)
        Translations.
    rotations : bool
        Whether the data set has rotations, too.
    """

    number: int
    frequency: float
    damping_ratio: float
    hysteretic: bool
    nodes: npt.NDArray[np.int64]
    motions: ComplexArray
    rotations: bool


def read_nodal_mode(block: bytes, number: int, where: str) -> NodalMode | None:
    """Read a data set 55 or 2414; None where it is no mode, or has other values than motions at nodes.

    Parameters
    ----------
    block : bytes
        The data set, from its line with the number on.
    number : {55, 2414}
    where : str
        Its name in messages.

    Raises
    ------
    MeasuredDataError
        Where the data set is cut short, or not what its header says.
    """
    lines = block.decode("utf-8", errors="replace").splitlines()[1:]
    while lines and not lines[-1].strip():
        lines.pop()
    first = 5 if number == 55 else 8
    end_of_header = first + (3 if number == 55 else 5)
    if len(lines) < end_of_header:
        raise MeasuredDataError(f"{where} is cut short: its header has {len(lines)} of {end_of_header} lines")
    kind = _integers(lines[first], 6, where)
    analysis, characteristic, result, number_type, values = kind[1:6]
    at_nodes = number == 55 or _integers(lines[2], 1, where)[0] == _AT_NODES
    if analysis not in _MODES or not at_nodes or (number == 2414 and result not in _MOTIONS_OF_2414):
        return None
    if values not in _VECTORS:
        if number == 2414 and characteristic not in (2, 3):
            return None
        raise MeasuredDataError(f"{where} has no three components of motion at each point, but {values}")
    frequency, ratio, hysteretic = _pole(lines, number, analysis, where)
    parts = 2 if number_type in _COMPLEX else 1
    nodes, table = _records(lines[end_of_header:], values * parts, where)
    motions = table[:, : 3 * parts]
    shapes: ComplexArray = motions[:, ::2] + 1j * motions[:, 1::2] if parts == 2 else motions.astype(np.complex128)
    return NodalMode(number, frequency, ratio, hysteretic, nodes, shapes, values > 3)


def _pole(lines: list[str], number: int, analysis: int, where: str) -> tuple[float, float, bool]:
    """Natural frequency [rad/s], damping ratio, and whether that is half a loss factor."""
    eigenvalue = 0.0 + 0.0j
    hertz = viscous = loss = 0.0
    if number == 55:
        reals = _reals(lines[7], where)
        if analysis == NORMAL:
            hertz, _, viscous, loss = reals[:4]
        else:
            eigenvalue = complex(reals[0], reals[1])
    else:
        of_normal, of_complex = _reals(lines[11], where), _reals(lines[12], where)
        hertz, viscous, loss = of_normal[1], of_normal[4], of_normal[5]
        if analysis != NORMAL:
            eigenvalue = complex(of_complex[0], of_complex[1])
    frequency, ratio = 2.0 * np.pi * hertz, viscous
    if eigenvalue != 0.0:
        frequency = abs(eigenvalue)
        ratio = -eigenvalue.real / frequency
    hysteretic = ratio == 0.0 and loss != 0.0
    ratio = 0.5 * loss if hysteretic else ratio
    if not (np.isfinite(frequency) and frequency >= 0.0 and abs(ratio) < 1.0):
        raise MeasuredDataError(
            f"{where} has frequency {frequency / (2.0 * np.pi):g} Hz and damping ratio {ratio:g}; expected those of a "
            "vibration"
        )
    return frequency, ratio, hysteretic


def _records(lines: list[str], count: int, where: str) -> tuple[npt.NDArray[np.int64], FloatArray]:
    """Nodes, and `count` real numbers at each."""
    stride = 1 + -(-count // _FIELDS_A_LINE)
    if len(lines) % stride:
        raise MeasuredDataError(
            f"{where} is cut short: it has {len(lines)} lines of nodes and values; expected {stride} for each node"
        )
    try:
        nodes = np.array([int(line[:10]) for line in lines[::stride]], dtype=np.int64)
    except (ValueError, OverflowError):
        raise MeasuredDataError(
            f"{where} cannot be read: a line has no node's number in its first ten columns"
        ) from None
    values = []
    for offset in range(1, stride):
        expected = min(_FIELDS_A_LINE, count - (offset - 1) * _FIELDS_A_LINE)
        values.append(_columns(lines[offset::stride], expected, where))
    return nodes, np.concatenate(values, axis=1) if values else np.empty((len(nodes), 0))


def _columns(lines: list[str], expected: int, where: str) -> FloatArray:
    """Real numbers of lines, each of which has as many; numbers may touch, as 1.0E+00-1.0E+00."""
    try:
        table = np.array(" ".join(lines).split(), dtype=np.float64).reshape(len(lines), expected)
    except ValueError:
        rows = []
        for line in lines:
            found = _NUMBER.findall(line)
            if len(found) != expected or _NUMBER.sub("", line).strip():
                raise MeasuredDataError(
                    f"{where} is cut short or broken: a node has {line.strip()!r}; expected {expected} numbers"
                ) from None
            rows.append([float(text.upper().replace("D", "E")) for text in found])
        table = np.array(rows, dtype=np.float64).reshape(len(lines), expected)
    if not np.all(np.isfinite(table)):
        raise MeasuredDataError(f"{where} holds a value that is not finite")
    return table


def _integers(line: str, count: int, where: str) -> list[int]:
    """Whole numbers in columns of ten characters."""
    fields = [line[10 * place : 10 * place + 10].strip() for place in range(count)]
    try:
        return [int(text) for text in fields]
    except ValueError:
        raise MeasuredDataError(
            f"{where} cannot be read: a line of its header is {line.strip()!r}; expected {count} whole numbers"
        ) from None


def _reals(line: str, where: str) -> list[float]:
    """Six real numbers of a header, those that are missing 0."""
    found = [float(text.upper().replace("D", "E")) for text in _NUMBER.findall(line)]
    if _NUMBER.sub("", line).strip() or not np.all(np.isfinite(found)):
        raise MeasuredDataError(f"{where} cannot be read: a line of its header is {line.strip()!r}; expected numbers")
    return (found + [0.0] * _FIELDS_A_LINE)[:_FIELDS_A_LINE]
