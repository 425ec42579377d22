"""Numbers with units in the texts of a result are in its document, and the heights of its curves in its file.

Sentences and tables are composed from the document by hand, for the terminal and the report. Whatever result a fast
test makes, its texts are composed here and read back: a factor, a unit or a sign that is wrong in one of them leaves a
number which the document does not have. The other way round, a warning says the figures that belong to it. A figure
that a test draws is looked at in the same way: the highest point of a curve, or its swing, is that of an array of the
results file in the unit of the axis, and no curve leaves its axes. No column of a table shows what another does, and
the variables of every file have units that fit their names, see ``shown_units.mislabelled``.
"""

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from math import hypot, pi
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pytest
from shown_units import SHOWN, dimension_of, mislabelled

from gearwhine.output.sections import Section, Table

_UNITS = SHOWN | {"dB(A)": ("dB(A)", 1.0), "": ("1", 1.0)}
_NUMBER = r"(?<![\w.,/-])[-+]?\d+(?:\.\d+)?(?:e[+-]?\d+)?"
_NAMES = "|".join(sorted(map(re.escape, filter(None, _UNITS)), key=len, reverse=True))
# A unit may stand behind the second of two numbers.
_WITH_UNIT = re.compile(rf"({_NUMBER})(?=(?:(?: to | and | ± ){_NUMBER})? ?({_NAMES})(?![\w/·*²(°-]))")
_BOUNDS = re.compile(r"(above|below|within|beyond|less than|up to|by|±|>) $|±$")
"""Words before a number of the settings, or of the sentence itself, which need not be in the document."""
_OF_SENTENCES = re.compile(
    r"95 % (interval|of)|1 µm (at|of|alone)|100 %|% of critical|failed: |planets at |dB (with|re) |20 µPa|1 pW|damping"
    r"|falls to|^\+1(0 %| mm)$"
)
_OF_MANY = ("optimise", "vary", "detect", "sweep")
"""Commands whose numbers have the units of the case's keys, which their names do not say."""


class Shown(NamedTuple):
    """A number of a text: the text, the number's words and its unit."""

    text: str
    number: str
    unit: str


def leaves(value: Any, path: str = "") -> Iterator[tuple[str, float]]:
    """Numbers of a document by their paths, and the lengths of vectors."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from leaves(inner, f"{path}.{key}")
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from leaves(inner, path)
        numbers = [one for one in value if isinstance(one, float)]
        if len(numbers) == len(value) and len(value) in (2, 3, 5):
            yield from ((path, hypot(*numbers[:count])) for count in (2, 3))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path, float(value)


def shown_in(section: Section) -> Iterator[Shown]:
    """Numbers with units in the sentences and tables of a section."""
    for item in section.content:
        if isinstance(item, Table):
            yield from shown_in_table(item)
        else:
            yield from shown_in_text(str(item))
    for inner in section.inner:
        yield from shown_in(inner)


def shown_in_text(text: str) -> Iterator[Shown]:
    """Numbers with units in a text."""
    if _OF_SENTENCES.search(text):
        return
    for found in _WITH_UNIT.finditer(text):
        if not _BOUNDS.search(text[: found.start()]):
            yield Shown(text, found[1], found[2])


def shown_in_table(table: Table) -> Iterator[Shown]:
    """Numbers in cells, in the unit behind them or else in that of the heading."""
    columns, rows = table.filled()
    for place, column in enumerate(columns):
        heading = column.heading.replace("\n", " ")
        unit = heading.rpartition("[")[2].partition("]")[0].split(",")[0].removesuffix(" rms").split(" re ")[0]
        for row in rows:
            text = f"{heading}: {row[place]}"
            if own := list(shown_in_text(row[place])):
                yield from own
            elif "[" in heading and unit and unit in _UNITS and not row[place].startswith(">"):
                yield from (Shown(text, number, unit) for number in re.findall(_NUMBER, row[place]))


def known_numbers(document: Mapping[str, Any]) -> defaultdict[str, list[float]]:
    """Numbers of a document by their dimensions; parts of 1, and those of no dimension, in per cent."""
    known: defaultdict[str, list[float]] = defaultdict(list)
    for path, value in leaves(document):
        dimension, factor = _unit_of(path)
        known[dimension].append(factor * value)
        if path.endswith("_db_a"):  # a heading may say in words that it is weighted
            known["dB(A)"].append(value)
    return known


def foreign_numbers(document: Mapping[str, Any], sections: Iterable[Section]) -> list[Shown]:
    """Numbers of texts that the document does not have."""
    known = known_numbers(document)
    shown = [one for section in sections for one in shown_in(section)]
    foreign = [one for one in shown if one.number == "-0" or not _is_known(one, known)]
    words = list(texts_in(document)) if foreign else []  # which are quoted
    return [one for one in foreign if not any(one.number in text and text in one.text for text in words)]


def untrusted_lines(document: Mapping[str, Any]) -> list[str]:
    """Peaks of sensors and mesh harmonics with sidebands above the frequency up to which a model is complete."""
    limit = document.get("trusted_below_hz") or np.inf
    lines = ((path, value) for path, value in leaves(document) if _TRUSTED.search(path))
    return [f"{path} = {value:.6g} Hz" for path, value in lines if value > limit * (1.0 + 1e-6)]


def repeated_columns(sections: Iterable[Section]) -> list[str]:
    """Headings of columns that show what another column of their table shows."""
    several = list(sections)
    repeated = [one for section in several for one in repeated_columns(section.inner)] if several else []
    for table in (table for section in several for table in section.tables):
        shown = Counter((column.of, column.shown) for column in table.columns)
        repeated += [column.heading for column in table.columns if shown[column.of, column.shown] > 1]
    return repeated


def texts_in(value: Any) -> Iterator[str]:
    """Texts of a document."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | list | tuple):
        for inner in value.values() if isinstance(value, Mapping) else value:
            yield from texts_in(inner)


def unsaid_figures(entry: Mapping[str, Any]) -> list[str]:
    """Figures of a warning that its message does not say, in their unit or bare; a part also by its rest."""
    named = {key: value for key, value in entry.items() if isinstance(value, Mapping)}
    entry = {key: value for key, value in entry.items() if key not in named}
    entry |= {f"{key}.{name}": value for key, values in named.items() for name, value in values.items()}
    message = str(entry["message"])
    said = [Shown(message, number, unit) for number, unit in _WITH_UNIT.findall(message)]
    bare = [Shown(message, number, "") for number in re.findall(_NUMBER, message)]
    unsaid = []
    for key, value in entry.items():
        if isinstance(value, float):
            known = known_numbers({key: value})
            known["%"] += [100.0 * (1.0 - value)]
            known["1"] += [value, 10800.0 / pi * value]  # an angle also in minutes of arc
            if not any(_is_known(one, known) for one in [*said, *bare]):
                unsaid.append(f"{key} = {value:.6g} in {message!r}")
    return unsaid


@cache
def _unit_of(path: str) -> tuple[str, float]:
    """Dimension of a number at a path, and the factor to the unit of the table."""
    if ".seconds" in path:
        return "s", 1.0
    if path.endswith(".stiffness"):
        return "N/m", 1.0
    if path.endswith("_deg"):
        return "rad", SHOWN["°"][1]
    dimension = dimension_of(path[1:])
    return ("%", 100.0 if dimension is None else 1.0) if dimension in (None, "percent") else (dimension, 1.0)


def _is_known(one: Shown, known: defaultdict[str, list[float]]) -> bool:
    dimension, size = _UNITS[one.unit]
    mantissa, _, exponent = one.number.partition("e")
    step = size * 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    if mantissa.isdigit() and not mantissa[3:].strip("0"):  # of three significant digits
        step *= 10.0 ** len(mantissa[3:])
    value = size * float(one.number)
    if "⌀" in one.text:
        value, step = 0.5 * value, 0.5 * step
    if one.unit == "%" and "% below" in one.text:
        value = -value
    if dimension == "rpm":  # of either sense
        value = abs(value)
        return any(abs(value - abs(other)) <= 0.51 * step + 1e-9 * value for other in known[dimension])
    return any(abs(value - other) <= 0.51 * step + 1e-9 * abs(value) for other in known[dimension])


@cache
def _composers() -> dict[str, list[Callable[[Any], Iterable[Section]]]]:
    """Functions that compose the texts of each command."""
    from gearwhine.cli.study_commands import composer_of
    from gearwhine.commands import STUDY_COMMANDS
    from gearwhine.results import chapters_of, composer

    longer = {"check": "check.sections"}  # of what every document holds
    return {
        entry.name: [chapters_of, *(composer(one) for one in (composer_of(entry), longer.get(entry.name)) if one)]
        for entry in STUDY_COMMANDS
        if entry.name not in _OF_MANY
    }


_OWN_TEXTS = re.compile(r"cross-orthogonality|-shaft|load-shaft|-static|-pattern|transmission-error|orbits")
"""Figures whose texts have sums, means, and components in the plane of the figure."""
_OWN_CURVES = re.compile(
    r"diameter|phase|critical-map crit|transmissibility.* bearing|flanks|steady-motion|mesh-force|spectrum"
)
"""Figures, with the label of the axis, of curves whose highest points are not in the file."""
_CUT = re.compile("campbell|steady-motion|-teeth")
"""Figures whose highest branches, further periods, or lines of action lie beyond the axes."""
_TRUSTED = re.compile(r"^\.sensors\.peaks\.frequency_hz$|\.carrier_hz$")
_FILE_UNITS = {"m s-2": "m/s2", "m s-2 m-1": "m/s2", "N m-1": "N/m", "1": "%", "": "%", "percent": "%"}
_FEWEST_POINTS, _ROUNDING, _EDGE = 8, 1e-12, 1e-6
_NEAR = 4e-3  # part by which a curve that is drawn smoothly may rise above its samples

Heights = Mapping[str, npt.NDArray[np.float64]]


def heights_of(dataset: Any) -> Heights:
    """Highest values and swings of arrays along their first and longest dimensions, by the dimension of the unit."""
    found: defaultdict[str, list[npt.NDArray[np.float64]]] = defaultdict(list)
    for variable in dataset.variables.values():
        if variable.dtype.kind not in "fc" or variable.size < 2:
            continue
        unit = variable.attrs.get("units", "")
        factor = {"rad s-1": 30.0 / pi, "percent": 0.01}.get(unit, 1.0)
        values = variable.values
        for part in (np.abs(values), values.real, values.imag) if variable.dtype.kind == "c" else (values,):
            scaled = factor * np.nan_to_num(part)
            several = [np.abs(scaled).max()]
            for along in {0, int(np.argmax(scaled.shape))}:
                several += [np.abs(scaled).max(axis=along), np.ptp(scaled, axis=along)]
            found["rpm" if unit == "rad s-1" else _FILE_UNITS.get(unit, unit)] += [np.ravel(one) for one in several]
    return {dimension: np.concatenate(several) for dimension, several in found.items()}


def foreign_curves(name: str, figure: Any, heights: Heights) -> list[str]:
    """Curves of a figure that are neither as high nor swing as far as an array of the unit of their axis."""
    foreign = []
    for axes in figure.axes:
        label = axes.get_ylabel()
        dimension, size = SHOWN.get(label.rpartition("[")[2].partition("]")[0].split(",")[0], ("", 1.0))
        if dimension not in heights or _OWN_CURVES.search(f"{name} {label}"):
            continue
        for line in axes.get_lines():
            drawn = np.asarray(line.get_ydata(), dtype=float) * size * (1e-2 if dimension == "%" else 1.0)
            drawn = drawn[np.isfinite(drawn)]
            if drawn.size < _FEWEST_POINTS or np.abs(drawn).max() < _ROUNDING:
                continue
            high = np.array([[np.abs(drawn).max()], [np.ptp(drawn)]])
            if not (np.abs(heights[dimension] - high) <= _NEAR * high).any():
                foreign.append(f"{line.get_label()} over {label}, up to {high[0, 0]:.4g} in SI")
    return foreign


def cut_curves(name: str, figure: Any) -> list[str]:
    """Curves that leave the axes to the left, to the right or above; what is small may lie below an axis of decades."""
    cut = []
    for axes in figure.axes:
        (left, right), top = sorted(axes.get_xlim()), max(axes.get_ylim())
        bottom = min(axes.get_ylim()) if axes.get_yscale() == "linear" else -np.inf
        for line in axes.get_lines():
            if line.get_transform() != axes.transData:
                continue
            x, y = (np.asarray(values, dtype=float)[np.isfinite(values)] for values in line.get_data(orig=False))
            near_x, near_y = _EDGE * (right - left), _EDGE * (top - max(bottom, 0.0))
            beyond = (x < left - near_x).any() or (x > right + near_x).any()
            if beyond or (y > top + near_y).any() or (y < bottom - near_y).any():
                cut.append(f"{line.get_label()} over {axes.get_ylabel()}")
    return cut


def foreign_in_texts(name: str, figure: Any, document: Mapping[str, Any]) -> list[Shown]:
    """Numbers in the texts of a figure that the document does not have."""
    from matplotlib.text import Text

    if _OWN_TEXTS.search(name):
        return []
    known = known_numbers(document)
    texts = [text.get_text() for text in figure.findobj(Text)]
    return [one for text in texts for one in shown_in_text(text) if not _is_known(one, known)]


@contextmanager
def numbers_held(is_on: Callable[[], bool]) -> Iterator[None]:
    """Read the texts of every result that is made, and look at every figure that is drawn, while it is on."""
    result = import_module("gearwhine.analyses.result").Result
    arrays = import_module("gearwhine.output.dataset").LabelledArrays
    as_made, drawn, labelled = result.__post_init__, result.figures, arrays.__init__

    def read_back(self: Any) -> None:
        as_made(self)
        if self.solved is None or not is_on():  # one without is made up by a test
            return
        document = {"command": self.command} | self.document
        unsaid = [one for entry in document["warnings"] for one in unsaid_figures(entry)]
        assert not unsaid, f"{self.command}: not in the message of the warning: {unsaid}"
        beyond = untrusted_lines(document)
        assert not beyond, f"{self.command}: lines beyond the frequency up to which they are trusted: {beyond}"
        for compose in _composers().get(self.command, ()):
            composed = list(compose(document))
            foreign = foreign_numbers(document, composed)
            assert not foreign, f"{self.command}: not in the document: {foreign}"
            repeated = repeated_columns(composed)
            assert not repeated, f"{self.command}: two columns of one table show the same: {repeated}"

    def looked_at(self: Any, *given: Any) -> Iterator[tuple[str, Any]]:
        is_held = is_on() and self.solved is not None and self.command in _composers()
        heights = heights_of(self.dataset) if is_held else {}
        for name, figure in drawn(self, *given):
            if heights:
                foreign = [*foreign_curves(name, figure, heights), *foreign_in_texts(name, figure, self.document)]
                assert not foreign, f"{self.command}, {name}: neither in the file nor in the document: {foreign}"
                cut = [] if _CUT.search(name) else cut_curves(name, figure)
                assert not cut, f"{self.command}, {name}: cut by the axes: {cut}"
            yield name, figure

    def labels_held(self: Any, variables: Any, *given: Any, **more: Any) -> None:
        labelled(self, variables, *given, **more)
        wrong = mislabelled(variables)
        assert not wrong, f"labels of a file: {wrong}"

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(arrays, "__init__", labels_held)
        patch.setattr(result, "__post_init__", read_back)
        patch.setattr(result, "figures", looked_at)
        yield
