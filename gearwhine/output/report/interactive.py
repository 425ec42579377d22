"""Interactive parts of a report: shapes that turn and move, curves to zoom and hover, tables to sort and copy.

All that runs is part of the page: the libraries of :mod:`gearwhine.output.viewers` and ``interactive.js``. The page's
policy allows these scripts alone, by their digests, and no connection to anywhere.

Only ``interactive.js`` runs while the page opens. Libraries, models and the data of curves are packed blocks, which a
browser does not run: it parses and evaluates a library for half a second, so that waits until something needs it.
"""

import base64
import gzip
import hashlib
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.output.manifest import opened_dataset
from gearwhine.output.report.elements import NO_BREAK, in_cell
from gearwhine.output.sections import Curves, Section, arrowed

_RESULTS = "results.nc"
_POINTS = 4000  # largest number of points of a curve; longer ones show the largest of each stretch
_CELLS = 240, 600  # largest numbers of cells of colours over two axes
_DIGITS = 4
_LIBRARIES = {"model-viewer": "model-viewer.min.js", "plotly": "plotly-cartesian.min.js"}
_EXPONENT, _RAISED = re.compile(r"(?<=[A-Za-z])-?\d"), str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_LIMIT = "trusted_below_hz"  # attribute: values along the abscissa end there


@dataclass(frozen=True)
class MovingShape:
    """Shape of the housing as an animated 3D model.

    Attributes
    ----------
    name : str
        Name of the picture of the same shape, without ending.
    title, note : str
    model : bytes
        Content of the GLB file.
    """

    name: str
    title: str
    note: str
    model: bytes

    @property
    def place(self) -> str:
        """Name of its place in the report: that of its picture."""
        return f"picture {self.name}"


@dataclass
class Scripts:
    """Scripts of a page and data for them, as they are collected."""

    shapes: Sequence[MovingShape] = ()
    _drawings: list[dict[str, Any]] = field(default_factory=list)

    def curves(self, dataset: Any, section: Section) -> str:
        """Return frames for the curves that a section declares and a results file holds; keep their data."""
        try:
            drawings = [drawing for declared in section.curves for drawing in _drawings(dataset, declared)]
        except (OSError, ValueError):
            return ""
        frames = []
        for drawing in drawings:
            caption = escape(arrowed(drawing["caption"]))
            frames.append(
                f'<figure class="live"><div class="plot" data-plot="{len(self._drawings)}" role="img" '
                f'aria-label="{caption}"></div>'
                f"<figcaption>{caption} Drag to zoom, double-click to return.</figcaption></figure>\n"
            )
            self._drawings.append(drawing)
        return "".join(frames)

    def viewer(self, identifiers: Sequence[str]) -> str:
        """Return the viewer of the shapes, each listed under its identifier."""
        if not self.shapes:
            return ""
        entries = "".join(
            f'<li id="{identifier}"><button type="button" data-shape="{number}" '
            f'data-picture="{escape(shape.name)}">{in_cell(" ".join(shape.title.split()))}</button></li>\n'
            for number, (identifier, shape) in enumerate(zip(identifiers, self.shapes, strict=True))
        )
        return (
            f'<div class="viewer"><div class="stage"><model-viewer camera-controls autoplay interaction-prompt="none" '
            f'shadow-intensity="0" camera-orbit="35deg 70deg auto" field-of-view="28deg" environment-image="neutral" '
            f'alt="Moving shape of the housing"></model-viewer>'
            f'<p class="told" aria-live="polite"></p><p><button type="button" class="pause">Pause</button> '
            f'<span class="note">Drag to turn, scroll to zoom. Yellow moves most; the motion is enlarged.</span></p>'
            f'</div>\n<ol class="shapes">{entries}</ol></div>\n'
        )

    def policy(self) -> str:
        """Return the content security policy of a page with these scripts."""
        digests = " ".join(
            f"'sha256-{base64.b64encode(hashlib.sha256(text.encode('utf-8')).digest()).decode('ascii')}'"
            for text in (*self._libraries().values(), _own_script())
        )
        return (
            # The viewer of shapes has a decoder in WebAssembly.
            f"default-src 'none'; script-src {digests} 'wasm-unsafe-eval'; style-src 'unsafe-inline'; "
            "img-src data: blob:; connect-src blob: data:; base-uri 'none'; form-action 'none'"
        )

    def written(self) -> str:
        """Return the scripts and their data as HTML, for the end of the page."""
        parts = [
            _block("library", text.encode("utf-8"), f' data-name="{name}"') for name, text in self._libraries().items()
        ]
        parts += [
            _block(
                "model",
                shape.model,
                f' data-title="{escape(arrowed(shape.title))}" data-note="{escape(arrowed(shape.note))}"',
            )
            for shape in self.shapes
        ]
        parts += [
            _block("drawing", json.dumps(drawing, separators=(",", ":"), allow_nan=False).encode("utf-8"))
            for drawing in self._drawings
        ]
        return "".join(parts) + f"<script>{_own_script()}</script>\n"

    def _libraries(self) -> dict[str, str]:
        """Return the libraries that this page needs, by name."""
        needed = {"model-viewer": bool(self.shapes), "plotly": bool(self._drawings)}
        viewers = files("gearwhine.output.viewers")
        return {name: (viewers / _LIBRARIES[name]).read_text(encoding="utf-8") for name in needed if needed[name]}


def _own_script() -> str:
    return (files(__package__) / "interactive.js").read_text(encoding="utf-8")


def _block(kind: str, content: bytes, attributes: str = "") -> str:
    """Return content as a block that no browser runs, packed; its letters cannot end the block."""
    packed = base64.b64encode(gzip.compress(content, 9, mtime=0)).decode("ascii")
    return f'<script type="application/gzip" class="{kind}"{attributes}>{packed}</script>\n'


def _drawings(dataset: Any, declared: Curves) -> list[dict[str, Any]]:
    """Return the drawings of an array: one of all its curves, or one of colours for each of its signals."""
    if declared.variable not in dataset or not set(declared.along) <= set(dataset[declared.variable].dims):
        return []
    array = dataset[declared.variable].load()
    if (limit := array.attrs.get(_LIMIT)) is not None:
        array = array.isel({declared.along[0]: dataset[declared.along[0]].values <= limit})
    other_axes = [str(name) for name in array.dims if name not in declared.along]
    stacked = array.stack(signal=other_axes).transpose("signal", *declared.along[::-1])
    varying = [place for place, name in enumerate(other_axes) if array.sizes[name] > 1]
    labels = [label if isinstance(label, tuple) else (label,) for label in stacked["signal"].values]
    names = [", ".join(str(label[place]) for place in varying or range(len(label))) for label in labels]
    values = np.asarray(stacked.values, dtype=np.float64)
    live = np.nanmax(np.abs(values), axis=tuple(range(1, values.ndim)), initial=0.0) > 0.0
    names, values = [name for name, moves in zip(names, live, strict=True) if moves], values[live]
    if not names:
        return []
    axes = [np.asarray(dataset[name].values, dtype=np.float64)[: array.sizes[name]] for name in declared.along]
    common = {
        "caption": declared.caption,
        "logarithmic": declared.logarithmic,
        "value": _named(array, declared.caption),
        "axes": [_named(dataset[name], name.replace("_", " ")) for name in declared.along],
    }
    if len(declared.along) == 1:
        x, curves = _coarse_curves(axes[0], values)
        lines = [{"name": arrowed(name), "y": _listed(curve)} for name, curve in zip(names, curves, strict=True)]
        return [common | {"x": _listed(x), "curves": lines}]
    drawings = []
    for name, table in zip(names, values, strict=True):
        x, y, z = _coarse_table(axes[0], axes[1], table)
        colours = {"x": _listed(x), "y": _listed(y), "z": [_listed(row) for row in z]}
        drawings.append(common | colours | {"caption": f"{declared.caption.rstrip('.')}: {name}."})
    return drawings


def _named(array: Any, otherwise: str) -> str:
    unit = array.attrs.get("units", "")
    name = str(array.attrs.get("long_name", otherwise)).rstrip(".")
    # Signals that differ in their unit refer to another variable for it.
    return f"{name} [{_read(unit)}]" if unit and unit != "1" and not unit.startswith("see ") else name


def _read(unit: str) -> str:
    """Return a unit as it is read, on one line: ``m s-2`` has a raised exponent."""
    raised = _EXPONENT.sub(lambda match: match[0].translate(_RAISED), unit)
    return raised.replace(" ", NO_BREAK)


def _listed(values: npt.NDArray[np.float64]) -> list[float | None]:
    """Return numbers to a few digits; None where there is none."""
    return [float(f"{value:.{_DIGITS + 2}g}") if np.isfinite(value) else None for value in values]


def _coarse_curves(
    x: npt.NDArray[np.float64], curves: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return at most `_POINTS` points of each curve: of each stretch the largest, at one abscissa."""
    step = -(-len(x) // _POINTS)
    if step <= 1:
        return x, curves
    starts = np.arange(0, len(x), step)
    return x[starts], np.fmax.reduceat(curves, starts, axis=1)


def _coarse_table(
    x: npt.NDArray[np.float64], y: npt.NDArray[np.float64], z: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return at most `_CELLS` columns and rows: of each cell the largest value."""
    rows, columns = (
        np.arange(0, len(axis), max(-(-len(axis) // most), 1)) for axis, most in zip((y, x), _CELLS, strict=True)
    )
    return x[columns], y[rows], np.fmax.reduceat(np.fmax.reduceat(z, rows, axis=0), columns, axis=1)


def live_parts(scripts: Scripts | None, place: Path, sections: Sequence[Section]) -> Mapping[int, str]:
    """Return the curves of sections and of those in them as HTML, by the identity of the section."""
    declaring = [section for section in _all_sections(sections) if section.curves]
    if scripts is None or not declaring or not (place / _RESULTS).is_file():
        return {}
    # Opened once for all sections: opening a file of a hundred arrays takes longer than reading those of a section.
    with opened_dataset(place / _RESULTS) as dataset:
        return {id(section): scripts.curves(dataset, section) for section in declaring}


def _all_sections(sections: Sequence[Section]) -> Iterator[Section]:
    """Yield each section before those in it."""
    for section in sections:
        yield section
        yield from _all_sections(section.inner)
