"""Units of declared quantities and columns: the key's unit, that of the file and that of the heading are one.

A key says its unit, ``force_n``; the file's unit is that or said beside it, and a heading has a unit, with a factor to
it that follows from both or is said. What is declared in functions is read too: the calls are taken from the source.
"""

import ast
import importlib
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import pytest
from numbers_of_texts import repeated_columns
from shown_units import NAMES, SHOWN, dimension_of, mislabelled

import gearwhine.results as results
from gearwhine.coupling.linear.line_mechanisms import MECHANISMS
from gearwhine.output.quantity import factor_of, unit_of
from gearwhine.output.sections import Column, Section, Table
from gearwhine.results.line_columns import MECHANISMS as WORDS

_WITHIN = {"harmonics", "mean", "maximum", "peak", "peak_of_tooth_pair"}
"""Keys within another that says their unit: of ``transmission_error_m`` and ``line_load_n_per_m``."""


class Declared(NamedTuple):
    """A call that declares a column or a quantity: where, key, name in the file, heading, unit there, and factor."""

    where: str
    key: str
    name: str
    heading: str
    unit: str | None
    scale: float
    converted: bool  # from the file's unit to the key's


def text_of(node: ast.expr | None) -> str | None:
    """Text of a literal, with {} for what an f-string puts in; None for another expression."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return None


def number_of(node: ast.expr | None, module: ModuleType) -> float | None:
    """Number of a literal or of a constant of the module; None for another expression."""
    if isinstance(node, ast.Constant):
        return float(node.value)
    return float(getattr(module, node.id)) if isinstance(node, ast.Name) and hasattr(module, node.id) else None


def declared(module: ModuleType) -> Iterator[Declared]:
    """Columns and quantities of a module that are shown or filed as they are, not through a function."""
    assert module.__file__ is not None
    places = {"Column": ("heading", "of", "form", "scale"), "Quantity": ("key", "of", "name", "dimensions", "unit")}
    for node in ast.walk(ast.parse(Path(module.__file__).read_text(encoding="utf-8"))):
        if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in places):
            continue
        given = dict(zip(places[node.func.id], node.args, strict=False))
        given |= {keyword.arg: keyword.value for keyword in node.keywords if keyword.arg}
        key = text_of(given.get("of" if node.func.id == "Column" else "key"))
        heading = text_of(given.get("heading")) or ""
        scale = number_of(given["scale"], module) if "scale" in given else factor_of(key or "", heading)
        through = "shown" in given and text_of(given["shown"]) is None
        if key is not None and scale is not None:
            where, name = f"{Path(module.__file__).name}:{node.lineno}", text_of(given.get("name")) or ""
            unit = text_of(given.get("unit")) or (unit_of(key) or None if name else None)
            yield Declared(where, key, name, "" if through else heading, unit, scale, "document" in given)


MODULES = sorted(path.stem for path in Path(results.__path__[0]).glob("[a-z]*.py"))
DECLARED = [one for name in MODULES for one in declared(importlib.import_module(f"gearwhine.results.{name}"))]


def test_a_factor_takes_the_key_s_unit_to_that_of_the_heading() -> None:
    wrong, held = [], 0
    for one in DECLARED:
        shown = one.heading.rpartition("[")[2].partition("]")[0].split(",")[0].removesuffix(" rms").split(" re ")[0]
        dimension = "%" if "percent" in one.key else dimension_of(one.key)
        unit, size = SHOWN.get(shown, (None, 1.0))
        if "[" not in one.heading or (dimension is None and unit != "%"):
            continue
        if dimension is None:  # a part of 1
            dimension, size = "%", 1e-2 * size
        held += 1
        if unit != dimension or one.scale * size != pytest.approx(1.0, rel=1e-12):
            wrong.append((one.where, one.key, one.heading, one.scale))
    assert wrong == []
    assert held > 100


def test_the_unit_in_the_file_is_one_of_what_its_name_says() -> None:
    named = [(one, one.name.rpartition("_")[2]) for one in DECLARED if one.unit is not None and one.name]
    held = [(one, word) for one, word in named if word in NAMES]
    assert [(one.where, one.name, one.unit) for one, word in held if one.unit not in NAMES[word]] == []
    assert len(held) > 30


def test_the_unit_in_the_file_is_that_of_the_key() -> None:
    own = {"m/s2", "m/s", "N/m", "N m", "kg", "rad", "Hz", "rpm", "Pa", "N", "m", "m2", "s", "h", "W", "dB"}
    compared = [(one, dimension_of(one.key)) for one in DECLARED if one.unit and one.key and not one.converted]
    wrong = [(one.where, one.key, one.unit) for one, key in compared if key is not None and one.unit != key]
    assert wrong == []
    # A unit of the file without one in the key is the document's loss.
    unsaid = [
        (one.where, one.key, one.unit)
        for one, key in compared
        if key is None and one.unit in own and one.key not in _WITHIN
    ]
    assert unsaid == []
    assert len(compared) > 50


def test_a_level_is_said_to_be_a_weighted_where_it_is() -> None:
    levels = [one for one in DECLARED if dimension_of(one.key) == "dB" and one.heading]
    assert len(levels) > 8
    for one in levels:
        weighted = any(word in one.heading for word in ("L_WA", "L_pA", "A-weighted", "dB(A)"))
        assert weighted == one.key.endswith("_db_a"), one


def test_every_mechanism_has_words_of_its_own() -> None:
    assert set(WORDS) == set(MECHANISMS)
    assert len(set(WORDS.values())) == len(WORDS)
    for mechanism, words in WORDS.items():
        assert mechanism.split("_")[0] in words


@pytest.mark.parametrize(
    ("unit", "meaning", "wrong"),
    [
        ("N", "mean force", []),
        ("m", "mean force", ["bearing_force is in 'm'"]),
        ("mean force", "N", ["bearing_force has the unit 'mean force'", "bearing_force means 'N'"]),
    ],
)
def test_a_variable_whose_label_does_not_fit_its_name_is_found(unit: str, meaning: str, wrong: list[str]) -> None:
    labels = {"units": unit, "long_name": meaning}
    variables = {"bearing_force": (("bearing",), [1.0, 2.0], labels), "bearing": (("bearing",), ["a", "b"], {})}
    assert mislabelled(variables) == wrong


def test_a_column_that_shows_what_another_does_is_found() -> None:
    mean, peak, same = Column("mean [N]", "mean_n"), Column("peak [N]", "peak_n"), Column("least [N]", "mean_n")
    inner = Section("", (Table((mean, peak, same), ()),))
    assert repeated_columns([Section("", (Table((mean, peak), ()),), inner=(inner,))]) == ["mean [N]", "least [N]"]
