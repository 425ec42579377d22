"""Data sets of universal files, laid out column by column after the published formats; not with the writer under test.

Source: universal file formats, Structural Dynamics Research Laboratory, University of Cincinnati. A record's FORTRAN
format stands beside it.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

Rows = Sequence[Sequence[float]]


def integers(*values: int) -> str:
    """Return nI10."""
    return "".join(f"{value:10d}" for value in values)


def reals(values: Iterable[float], width: int = 13, digits: int = 5, a_line: int = 6, letter: str = "E") -> list[str]:
    """Return lines of nE13.5 and the like; the last one as long as it comes."""
    texts = [f"{value:{width}.{digits}E}".replace("E", letter) for value in values]
    return ["".join(texts[start : start + a_line]) for start in range(0, len(texts), a_line)]


def dataset(number: int, lines: Iterable[str], *, mark: str = "") -> str:
    return "\n".join([f"{-1:6d}", f"{number:6d}{mark}", *lines, f"{-1:6d}"]) + "\n"


def header() -> str:
    """Data set 151, seven records of text."""
    return dataset(
        151, ["box", "a test", "PROGRAM X", "01-JAN-26  10:00:00", "NONE", "PROGRAM X 1.0", "01-JAN-26  10:00:00"]
    )


def units(code: int, length: float, force: float) -> str:
    """Data set 164: I10, 20A1, I10; 3D25.17; D25.17. Factors from SI to the file's units."""
    lines = [f"{code:10d}{'Some units':20s}{2:10d}"]
    lines += reals([length, force, 1.0], 25, 16, 3, "D") + reals([273.15], 25, 16, 1, "D")
    return dataset(164, lines)


def points_15(places: Mapping[int, Sequence[float]], system: int = 0) -> str:
    """Data set 15: 4I10, 3E13.5."""
    return dataset(15, [integers(node, 0, system, 7) + reals(xyz)[0] for node, xyz in places.items()])


def points_2411(places: Mapping[int, Sequence[float]], system: int = 0) -> str:
    """Data set 2411: 4I10; 3D25.16."""
    lines: list[str] = []
    for node, xyz in places.items():
        lines += [integers(node, system, system, 11), *reals(xyz, 25, 16, 3, "D")]
    return dataset(2411, lines)


def systems_2420(systems: Mapping[int, Rows]) -> str:
    """Data set 2420: I10; 40A2; then for each 3I10; 40A2; four rows of 3D25.16."""
    lines = [integers(1), "Part1"]
    for number, rows in systems.items():
        lines += [integers(number, 0, 2), f"CS{number}"]
        for row in rows:
            lines += reals(row, 25, 16, 3, "D")
    return dataset(2420, lines)


def elements_2412(elements: Mapping[int, Sequence[int]]) -> str:
    """Data set 2412: 6I10; 8I10. Four-node shells."""
    lines: list[str] = []
    for number, nodes in elements.items():
        lines += [integers(number, 94, 1, 1, 7, len(nodes)), integers(*nodes)]
    return dataset(2412, lines)


def trace_82(nodes: Sequence[int]) -> str:
    """Data set 82: 3I10; 80A1; 8I10."""
    rows = [integers(*nodes[start : start + 8]) for start in range(0, len(nodes), 8)]
    return dataset(82, [integers(1, len(nodes), 2), "NONE", *rows])


def _node_records(shape: Mapping[int, Sequence[complex]], is_complex: bool) -> list[str]:
    lines: list[str] = []
    for node, values in shape.items():
        given = [part for value in values for part in (np.real(value), np.imag(value))] if is_complex else values
        lines += [integers(node), *reals(float(np.real(value)) for value in given)]
    return lines


def shape_55(
    shape: Mapping[int, Sequence[complex]],
    *,
    hertz: float = 0.0,
    viscous: float = 0.0,
    loss: float = 0.0,
    eigenvalue: complex | None = None,
    mode: int = 1,
) -> str:
    """Data set 55: five ID lines; 6I10; 8I10; 6E13.5; then for each node I10, and its values as 6E13.5."""
    is_complex = any(isinstance(value, complex) for values in shape.values() for value in values)
    count = len(next(iter(shape.values()), [0.0] * 3))
    analysis = 2 if eigenvalue is None else 3
    given = [hertz, 1.0, viscous, loss]
    if eigenvalue is not None:
        given = [eigenvalue.real, eigenvalue.imag, 1.0, 0.0, 1.0, 0.0]
    lines = ["NONE"] * 5
    lines += [integers(1, analysis, 2 if count == 3 else 3, 8, 5 if is_complex else 2, count)]
    lines += [integers(2, len(given), 1, mode), *reals(given), *_node_records(shape, is_complex)]
    return dataset(55, lines)


def results_2414(
    shape: Mapping[int, Sequence[complex]],
    *,
    hertz: float = 0.0,
    viscous: float = 0.0,
    loss: float = 0.0,
    eigenvalue: complex | None = None,
    mode: int = 1,
    location: int = 1,
    result: int = 8,
    analysis: int | None = None,
) -> str:
    """Data set 2414: I10; 40A2; I10; five ID lines; 6I10; 8I10; 8I10; 6E13.5; 6E13.5; then nodes as data set 55."""
    is_complex = any(isinstance(value, complex) for values in shape.values() for value in values)
    count = len(next(iter(shape.values()), [0.0] * 3))
    if analysis is None:
        analysis = 2 if eigenvalue is None else 3
    pole = 0j if eigenvalue is None else eigenvalue
    lines = [integers(mode), f"Mode shape record {mode}", integers(location), *["NONE"] * 5]
    lines += [integers(1, analysis, 2 if count == 3 else 3, result, 5 if is_complex else 2, count)]
    lines += [integers(0, 0, 1, 0, 0, mode, 0, 0), integers(0, 0)]
    lines += reals([0.0, hertz, 0.0, 1.0, viscous, loss]) + reals([pole.real, pole.imag, 0.0, 0.0, 0.0, 0.0])
    return dataset(2414, [*lines, *_node_records(shape, is_complex)])


def function_58(
    values: Sequence[complex],
    *,
    response: tuple[int, int],
    reference: tuple[int, int],
    start: float = 1.0,
    step: float = 1.0,
    even: bool = True,
    double: bool = False,
    filling: float | None = None,
    labels: tuple[str, str] = ("", ""),
) -> str:
    """Data set 58 of accelerance, complex, in ASCII.

    Record 6: 2(I5,I10),2(1X,10A1,I10,I4); 7: 3I10,3E13.5; 8 to 11: I10,3I5,2(1X,20A1); values even as 6E13.5 or
    4E20.12, uneven as 6E13.5 or E13.5,2E20.12. `filling` fills the last line, as programs do that write whole lines.
    """
    count = len(values)
    numbers = [part for value in values for part in (np.real(value), np.imag(value))]
    if not even:
        places = start + step * np.arange(count)
        numbers = [
            part for x, value in zip(places, values, strict=True) for part in (x, np.real(value), np.imag(value))
        ]
    a_line = (4 if even else 3) if double else 6
    if filling is not None:
        numbers += [filling] * (-len(numbers) % a_line)
    if double and not even:
        rows = [f"{x:13.5E}{a:20.12E}{b:20.12E}" for x, a, b in np.reshape(numbers, (-1, 3))]
    else:
        rows = reals(numbers, 20, 12, 4) if double else reals(numbers)
    lines = ["NONE"] * 5
    lines.append(
        f"{4:5d}{1:10d}{1:5d}{0:10d} {'NONE':10s}{response[0]:10d}{response[1]:4d} {'NONE':10s}{reference[0]:10d}"
        f"{reference[1]:4d}"
    )
    lines.append(integers(6 if double else 5, count, int(even)) + reals([start, step, 0.0])[0])
    for kind, label, unit in (
        (18, "Frequency", "Hz"),
        (12, "Acceleration", labels[0]),
        (13, "Force", labels[1]),
        (0, "", ""),
    ):
        lines.append(f"{kind:10d}{0:5d}{0:5d}{0:5d} {label or 'NONE':20s} {unit or 'NONE':20s}")
    return dataset(58, [*lines, *rows])


def write(path: Path, *datasets: str, ending: str = "\n", **_: Any) -> Path:
    path.write_bytes("".join(datasets).replace("\n", ending).encode("ascii"))
    return path
