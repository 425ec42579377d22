"""Comparison files: the tables of a comparison of modes as CSV, and its pictures."""

import csv
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from gearwhine.solve.comparison import ResponseCorrelation
from housing.correlation.comparison import Comparison, ShapeCorrelation
from housing.measured import MeasuredGeometry

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi
_ALONG = 1e-4  # by which a direction may miss an axis and still be named after it


def write_comparison(folder: Path, comparison: Comparison, geometry: MeasuredGeometry | None = None) -> list[str]:
    """Write ``comparison.csv``; with shapes also the MAC matrix, and COMAC at each point.

    Parameters
    ----------
    folder : path
    comparison : Comparison
    geometry : housing.measured.MeasuredGeometry, optional
        Of the survey, which names the degrees of freedom; else they are numbered.

    Returns
    -------
    list of str
        The files' names: ``mac.csv`` with shapes, ``comac.csv`` where there are pairs.
    """
    _write_table(folder / "comparison.csv", *_pairs(comparison))
    files, shapes = ["comparison.csv"], comparison.shapes
    if shapes is not None:
        files.append(_write_mac(folder, shapes))
        if shapes.comac is not None:
            files.append(_write_coordinates(folder, shapes, geometry))
    return files


def draw_comparison_figures(
    title: str,
    comparison: Comparison,
    model_frequencies: FloatArray,
    geometry: MeasuredGeometry | None = None,
) -> "Iterator[tuple[str, Figure]]":
    """Draw measured and model modes beside each other; with shapes also the matrices, and COMAC at each point.

    Parameters
    ----------
    title : str
        Of the case.
    comparison, geometry
        See :func:`write_comparison`.
    model_frequencies : ndarray, shape (n,)
        Of all the model's modes [rad/s].

    Yields
    ------
    str
        Name of the figure: ``comparison``; ``mac`` with shapes, ``auto-mac`` of the measured ones,
        ``cross-orthogonality`` where the survey allows it, ``comac`` where there are pairs.
    matplotlib.figure.Figure
    """
    from gearwhine.figures import draw_comparison

    yield "comparison", draw_comparison(f"Measured and model modes: {title}", comparison, model_frequencies)
    if comparison.shapes is not None:
        yield from _draw_matrices(title, comparison, comparison.shapes)
        if comparison.shapes.comac is not None:
            yield "comac", _draw_coordinates(title, comparison.shapes, geometry)


def write_response_correlation(folder: Path, likeness: ResponseCorrelation) -> str:
    """Write ``frac.csv``, a row for each degree of freedom and a column for each force; the file's name."""
    heads = ["response", *dof_names(likeness.references)]
    rows = [
        [name, *("" if np.isnan(value) else _short(value) for value in values)]
        for name, values in zip(dof_names(likeness.geometry), likeness.frac, strict=True)
    ]
    _write_table(folder / "frac.csv", heads, rows)
    return "frac.csv"


def dof_names(geometry: MeasuredGeometry) -> list[str]:
    """Each measured degree of freedom by its point and direction, such as ``12 +z`` or ``12 (0.71 0.00 0.71)``."""
    names = []
    for point, direction in zip(geometry.points, geometry.directions, strict=True):
        axis = int(np.argmax(np.abs(direction)))
        sign = "-" if direction[axis] < 0.0 else "+"
        along = f"{sign}{'xyz'[axis]}"
        if np.abs(np.delete(direction, axis)).max() > _ALONG:
            along = "({:.2f} {:.2f} {:.2f})".format(*direction)
        names.append(f"{geometry.labels[point]} {along}")
    return names


def _pairs(comparison: Comparison) -> tuple[list[str], list[list[object]]]:
    """Return the source's Table II with the evidence for each pair: heads and rows."""
    heads = ["measured_mode", "measured_hz", "model_hz", "error_percent", "mode", "mac", "confidence", "strength"]
    rows: list[list[object]] = [
        [
            pair.measured_mode,
            _short(pair.measured / _HERTZ),
            _short(pair.model / _HERTZ),
            _short(pair.error_percent),
            pair.mode,
            _short(pair.mac),
            _short(pair.confidence),
            _short(pair.strength),
        ]
        for pair in comparison.pairs
    ]
    shapes = comparison.shapes
    for number in () if shapes is None else shapes.unpaired_measured:
        assert shapes is not None
        rows.append([number, _short(shapes.measured_frequencies[number - 1] / _HERTZ), *[""] * 6])
    rows.sort(key=lambda row: int(str(row[0])))
    return heads, rows


def _write_mac(folder: Path, shapes: ShapeCorrelation) -> str:
    heads = ["mode", "model_hz", *(f"measured_{number + 1}" for number in range(len(shapes.measured_frequencies)))]
    model = shapes.model_frequencies / _HERTZ
    table = [[mode + 1, _short(model[mode]), *map(_short, shapes.mac[mode])] for mode in range(len(model))]
    _write_table(folder / "mac.csv", heads, table)
    return "mac.csv"


def _draw_matrices(title: str, comparison: Comparison, shapes: ShapeCorrelation) -> "Iterator[tuple[str, Figure]]":
    from gearwhine.figures import draw_mac_matrix

    model, measured = shapes.model_frequencies / _HERTZ, shapes.measured_frequencies / _HERTZ
    paired = {pair.mode - 1: pair.measured_mode - 1 for pair in comparison.pairs}
    near = (model >= 0.9 * measured[0]) & (model <= 1.1 * measured[-1])
    shown = [int(mode) for mode in range(len(model)) if near[mode] or mode in paired]
    columns = _names(range(len(measured)), measured)
    if shown:
        outlined = [(row, paired[mode]) for row, mode in enumerate(shown) if mode in paired]
        note = "pairs outlined; close modes are paired by their span, not by the single values"
        figure = draw_mac_matrix(
            f"MAC: {title}", shapes.mac[shown], _names(shown, model), columns, outlined=outlined, note=note
        )
        yield "mac", figure
    note = "large values off the diagonal: modes found twice, or that the survey cannot tell apart"
    named = ("measured mode", "measured mode")
    figure = draw_mac_matrix(
        f"Auto-MAC of the test: {title}", shapes.measured_auto_mac, columns, columns, axes_named=named, note=note
    )
    yield "auto-mac", figure
    if shapes.cross_orthogonality is not None:
        modes = [number - 1 for number in shapes.orthogonality_modes]
        note = "in the model's mass, reduced to the survey by SEREP; squares of a column add up to 1"
        outlined = [(row, paired[mode]) for row, mode in enumerate(modes) if mode in paired]
        figure = draw_mac_matrix(
            f"Cross-orthogonality: {title}",
            shapes.cross_orthogonality,
            _names(modes, model),
            columns,
            outlined=outlined,
            named="cross-orthogonality",
            note=note,
        )
        yield "cross-orthogonality", figure


def _write_coordinates(folder: Path, shapes: ShapeCorrelation, geometry: MeasuredGeometry | None) -> str:
    assert shapes.comac is not None
    assert shapes.enhanced_comac is not None
    names = _coordinate_names(len(shapes.comac), geometry)
    table = [
        [name, _short(plain), _short(enhanced)]
        for name, plain, enhanced in zip(names, shapes.comac, shapes.enhanced_comac, strict=True)
    ]
    _write_table(folder / "comac.csv", ["degree_of_freedom", "comac", "enhanced_comac"], table)
    return "comac.csv"


def _draw_coordinates(title: str, shapes: ShapeCorrelation, geometry: MeasuredGeometry | None) -> "Figure":
    from gearwhine.figures import draw_coordinate_criteria

    assert shapes.comac is not None
    assert shapes.enhanced_comac is not None
    names = _coordinate_names(len(shapes.comac), geometry)
    return draw_coordinate_criteria(f"Where shapes differ: {title}", shapes.comac, shapes.enhanced_comac, names)


def _coordinate_names(count: int, geometry: MeasuredGeometry | None) -> list[str]:
    return [str(dof + 1) for dof in range(count)] if geometry is None else dof_names(geometry)


def _names(modes: Iterable[int], hertz: FloatArray) -> list[str]:
    return [f"{mode + 1}   {hertz[mode]:.0f} Hz" for mode in modes]


def _short(value: float | None) -> str:
    """Six digits, which is more than any measurement has; nothing where there is none."""
    return "" if value is None or not np.isfinite(value) else f"{value:.6g}"


def _write_table(path: Path, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(heads)
        writer.writerows(rows)
