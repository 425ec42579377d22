"""Slips of the pen that the source itself shows: a unit that is not its value's, a name or an argument in two places.

The source is read, not run, so that every sentence, table and message is held, whatever analysis it is of. Units of
declared columns are in ``tests/gearwhine/results/test_units_of_declarations.py``, whose tables of units these are.
"""

import ast
import gc
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from itertools import pairwise
from math import isclose, pi
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "tests" / "gearwhine" / "results"))

from shown_units import SHOWN, dimension_of  # noqa: E402
from test_units_of_declarations import NAMES, text_of  # noqa: E402

ROOMS = ("numerics", "meshes", "housing", "rotors", "coupling", "gearwhine")
UNITS = SHOWN | {"dB(A)": ("dB", 1.0), "kg m²": ("kg m2", 1.0), "deg": SHOWN["°"]}
_UNIT = re.compile(rf"\s?({'|'.join(sorted(map(re.escape, UNITS), key=len, reverse=True))})(?![\w/·*²(°-])")
_BETWEEN = (" to ", " and ", ", ", " ± ")  # of two numbers of one unit
WORDS = {"speed": "rpm", "torque": "N m", "force": "N", "frequency": "Hz"}
WORDS |= dict.fromkeys(("rpm", "speeds", "onset", "widest", "undamped"), "rpm")
WORDS |= dict.fromkeys(("hz", "hertz", "frequencies", "mesh_frequency", "limit", "trusted_limit", "spacing"), "Hz")
WORDS |= dict.fromkeys(("exciting", "held", "rate", "slowest", "modulating"), "Hz")
"""Names without a unit of values in the unit of the document."""
PARTS = {
    "share",
    "part",
    "covered",
    "axial_share",
    "damping_ratio",
    "load_share",
    "contact_loss_fraction",
    "margin",
    "accuracy",
    "fraction",
    "leak",
    "mode_share",
    "left_of_prior_spread",
    "least_residue",
    "kinetic_energy_share",
}
"""Names of parts of 1."""
IN_SI = {
    "m": "apart axial_offset backlash base base_radii_sum base_radius bore bounds center centre_distance close_holes "
    "compression compression_limit depth diameter distance distances eccentricity edge gap grip gyration hub inner "
    "lengths longest module offset outer pitch_diameter places radius reach refined_size rim rim_inner_radius shift "
    "thinnest tip_radius tooth_deflection working_centre_distance yielding",
    "s": "begin duration interval period seconds timeout total when",
    "N": "axial_force bearable load rating spring thrust typical wanted",
    "N m": "entering leaving input_torque",
    "Pa": "peak_pressure pressure shear_modulus youngs_modulus",
    "W": "power power_in power_out surface_power",
    "kg": "mass lightest heaviest",
    "kg m2": "moments",
    "m/s": "line_speed bursts fast",
    "rad": "misalignment at_equilibrium taken start_roll_angle end_roll_angle",
    "N/m": "specific_load",
    "h": "life short_life",
}
"""Names of values in SI units, in sentences converted to what is said; lives are in hours."""
OF_SI = {name: dimension for dimension, names in IN_SI.items() for name in names.split()}


class Source:
    """A file of the product: its tree, and the nodes of each kind in it."""

    def __init__(self, text: str) -> None:
        self.tree = ast.parse(text)
        self.kinds: defaultdict[type, list[Any]] = defaultdict(list)
        for node in ast.walk(self.tree):
            self.kinds[type(node)].append(node)

    def of(self, *kinds: type) -> Iterator[Any]:
        """Nodes of these kinds."""
        for kind in kinds:
            yield from self.kinds[kind]


Slips = Iterator[tuple[int, str]]


@cache
def sources() -> dict[str, Source]:
    """Files of the rooms by path; a room's link in ``gearwhine`` is not followed."""
    gc.disable()  # two million nodes are made that all stay
    try:
        return {
            str(path.relative_to(ROOT)): Source(path.read_text(encoding="utf-8"))
            for room in ROOMS
            for path in sorted((ROOT / room).rglob("*.py"))
            if not any(place.is_symlink() for place in (path, *path.parents))
        }
    finally:
        gc.enable()


def slips(check: Callable[[Source], Iterable[tuple[int, str]]]) -> list[str]:
    """What a check finds, with file and line."""
    return [f"{name}:{line}: {what}" for name, source in sources().items() for line, what in check(source)]


def constants(tree: ast.Module) -> dict[str, float]:
    """Numbers of a module by their names."""
    return {
        target.id: float(node.value.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant)
        if isinstance(node.value.value, int | float)
        for target in node.targets
        if isinstance(target, ast.Name)
    }


_CONSTANTS = {"MM": 1e3, "MILLI": 1e3, "MICRO": 1e6, "MEGA": 1e-6}
_TURN = {"TWO_PI", "HERTZ", "2.0 * np.pi", "2 * np.pi", "2.0 * math.pi"}
_TWICE = {"radius": 2.0, "strip": 2.0, "cell": 2.0, "face_width": 0.5, "lengths": 0.5, "modulus": 0.5}
"""What is shown by its double, as diameters are, or by its half."""


def scale_of(node: ast.expr) -> tuple[float, str]:
    """Product of the numbers of an expression, and what it is converted to from rad/s."""
    match node:
        case ast.Constant(value=int(number) | float(number)):
            return number, ""
        case ast.Name(id=name) if name.lstrip("_") in ("RPM", *_CONSTANTS):
            return _CONSTANTS.get(name.lstrip("_"), 1.0), "rpm" if name.endswith("RPM") else ""
        case ast.Call(func=func, args=[inner, *_]) if re.fullmatch("abs|float|_?round(ed)?|np.ceil", ast.unparse(func)):
            return scale_of(inner)
        case ast.Call(func=ast.Attribute(attr="degrees")):
            return 180.0 / pi, ""
        case ast.BinOp(left=left, op=ast.Mult() | ast.Div() as op, right=right):
            (first, to), (second, other) = scale_of(left), scale_of(right)
            if isinstance(op, ast.Div) and ast.unparse(right).lstrip("_") in _TURN:
                return (1.0, "rpm") if first == 60.0 else (first, "Hz")
            return first * second if isinstance(op, ast.Mult) else first / second, to or other
        case ast.UnaryOp(operand=inner):
            return scale_of(inner)
    return 1.0, ""


def factor_and_name(node: ast.expr, numbers: dict[str, float]) -> tuple[float, str] | None:
    """A number times a key, an attribute or a name; None of another expression."""
    if isinstance(node, ast.BinOp) and (scale := scale_of(node))[1]:
        return scale[0], f"converted_{scale[1].lower()}"
    match node:
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            for one, other in ((left, right), (right, left)):
                number = numbers.get(one.id) if isinstance(one, ast.Name) else getattr(one, "value", None)
                if isinstance(number, int | float) and (rest := factor_and_name(other, numbers)):
                    return number * rest[0], rest[1]
        case ast.Call(func=ast.Name(id="abs" | "float" | "max" | "min"), args=[inner], keywords=[]):
            return factor_and_name(inner, numbers)
        case ast.Subscript(slice=ast.Constant(value=str(key))):
            return 1.0, key
        case ast.Subscript(value=value):
            return factor_and_name(value, numbers)
        case ast.Attribute(attr=name) | ast.Name(id=name):
            return 1.0, name
    return None


def units_behind(source: Source) -> Iterator[tuple[ast.FormattedValue, str]]:
    """Values in texts that a unit follows, there or after the next value, with it."""
    for text in (node.values for node in source.of(ast.JoinedStr)):
        for place, part in enumerate(text):
            for after in text[place + 1 :: 2] if isinstance(part, ast.FormattedValue) else ():
                words = str(after.value) if isinstance(after, ast.Constant) else ""
                if unit := _UNIT.match(words):
                    yield part, unit[1]
                if unit or words not in _BETWEEN:
                    break


def values_with_units(source: Source) -> Iterator[tuple[int, str, float, str]]:
    """Line, name, factor and unit of each value of a name in a text that a unit follows."""
    numbers = constants(source.tree)
    for part, unit in units_behind(source):
        if found := factor_and_name(part.value, numbers):
            yield part.lineno, found[1], found[0], unit


def wrong_units(source: Source) -> Slips:
    """Values whose unit is not that of their name, times the factor."""
    for line, name, factor, shown in values_with_units(source):
        dimension, size = UNITS[shown]
        said = "%" if "percent" in name else "kg m2" if name.endswith("_kg_m2") else dimension_of(name)
        if name in PARTS and dimension == "%":
            said, size = "%", 1e-2 * size
        if (of := OF_SI.get(name.strip("_").lower())) and said is None:
            said = of
        if said is None:
            wrong = name in WORDS and dimension not in (WORDS[name], "%")
        else:
            wrong = said != dimension or not (isclose(factor * size, 1.0) or name.startswith("half_"))
        if wrong or (shown == "dB(A)" and not name.endswith(("_db_a", "level"))):
            yield line, f"{factor:g} {name} in {shown}"


def test_a_value_in_a_sentence_is_in_the_unit_that_follows_it() -> None:
    assert slips(wrong_units) == []
    assert sum(1 for source in sources().values() for _ in values_with_units(source)) > 250


_DECLARED = {"Quantity", "Column", "Rows", "Part"}
_PLACES = {"Quantity": ("key", "of", "name"), "Column": ("heading", "of"), "Rows": ("key", "of"), "Part": ("key",)}
ALIKE = {"static", "motions", "name", "level\n[dB]", "lambda solved: list(_MOTIONS)"}
"""Parts of which one is there; names of rows and of their parts; headings under two names of speeds; two dimensions."""


def declared_twice(source: Source) -> Slips:
    """Keys, attributes, names in the file and headings that two declarations of one list share."""
    for node in source.of(ast.Tuple, ast.List):
        calls = [one for one in node.elts if isinstance(one, ast.Call)]
        if not any(isinstance(call.func, ast.Name) and call.func.id in _DECLARED for call in calls):
            continue
        found: Counter[tuple[str, Any]] = Counter()
        for call in calls:
            kind = ast.unparse(call.func)
            given = dict(zip(_PLACES.get(kind, ()), call.args, strict=False))
            given |= {one.arg: one.value for one in call.keywords if one.arg in ("heading", "key", "of")}
            said = {(place, one.value) for place, one in given.items() if isinstance(one, ast.Constant) and one.value}
            getters = {("of", ast.unparse(value)) for value in call.args if isinstance(value, ast.Lambda)}
            found.update(said if kind == "Part" else said | getters)
        for (place, what), number in found.items():
            if number > 1 and what not in ALIKE:
                yield node.lineno, f"{place} {what!r} {number} times"


def exported_twice(source: Source) -> Slips:
    """Names that a list of public names has twice, in the place of another one."""
    for node in source.of(ast.Assign):
        if ast.unparse(node.targets[0]) == "__all__":
            for what, number in Counter(map(ast.unparse, getattr(node.value, "elts", ()))).items():
                if number > 1:
                    yield node.lineno, f"{what} {number} times"


def test_no_two_declarations_of_one_list_are_of_the_same() -> None:
    assert slips(declared_twice) == []
    assert slips(exported_twice) == []


def said_twice(source: Source) -> Slips:
    """The same value twice in one difference, quotient, order or condition, as a number of a text, or in one row."""
    for node in source.of(ast.JoinedStr, ast.Compare, ast.BinOp, ast.BoolOp, ast.Tuple, ast.Dict):
        values: list[Any] = []
        keyed = isinstance(node, ast.Tuple | ast.Dict)
        match node:
            case ast.JoinedStr(values=parts):
                values = [one.value for one in parts if isinstance(one, ast.FormattedValue) and one.format_spec]
            case ast.Compare(left=left, ops=[ast.Lt() | ast.LtE() | ast.Gt() | ast.GtE()], comparators=[right]):
                values = [left, right]
            case ast.BinOp(left=left, op=ast.Sub() | ast.Div(), right=right):
                values = [left, right]
            case ast.BoolOp(values=several) | ast.Tuple(elts=several, ctx=ast.Load()) | ast.Dict(values=several):
                values = several
        looked_up = [
            ast.unparse(one)
            for one in values
            if isinstance(one, ast.Subscript | ast.Attribute)
            if not keyed or (isinstance(one, ast.Subscript) and isinstance(getattr(one.slice, "value", 0), str))
        ]
        for what, number in Counter(looked_up).items():
            if number > 1:
                yield node.lineno, f"{what} twice in {ast.unparse(node)[:80]}"


def test_no_value_stands_twice_where_each_is_said_once() -> None:
    assert slips(said_twice) == []


@cache
def parameters() -> dict[str, set[tuple[str, ...]]]:
    """Parameters of the functions and fields of the dataclasses of a name."""
    found: defaultdict[str, set[tuple[str, ...]]] = defaultdict(set)
    for source in sources().values():
        for node in source.of(ast.FunctionDef, ast.ClassDef):
            if isinstance(node, ast.FunctionDef):
                names = [one.arg for one in (*node.args.posonlyargs, *node.args.args)]
                found[node.name].add(tuple(names[1:] if names[:1] in (["self"], ["cls"]) else names))
            else:
                fields = [ast.unparse(one.target) for one in node.body if isinstance(one, ast.AnnAssign)]
                inherits = {ast.unparse(base) for base in node.bases} - {"NamedTuple"}
                found[node.name].add(() if inherits else tuple(fields))
    return found


def word_of(node: ast.expr) -> str:
    """Name, attribute or key that an argument is, without its unit."""
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name) | ast.Subscript(slice=ast.Constant(value=str(name))):
            return without_unit(name)
    return ""


def without_unit(name: str) -> str:
    """A name without the unit at its end."""
    return re.sub(r"_(hz|rpm|n_m|rad|m|s|n)$", "", name.lstrip("_"))


MIRRORED = {"start", "pitch_gaps", "pair_variants", "first"}
"""Of a section seen from its other end, of flanks that become the back flanks, and of what overlaps either way."""


def swapped(source: Source) -> Slips:
    """Neighbours among the arguments that have each other's names, and a class in the place of its object."""
    for node in source.of(ast.Call):
        name = node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
        if name == "isinstance" and re.match(r"[A-Z]|(str|int|float|list|dict|tuple|bool)$", word_of(node.args[0])):
            yield node.lineno, ast.unparse(node)
        keywords = [(without_unit(one.arg), word_of(one.value)) for one in node.keywords if one.arg]
        for names in parameters().get(name, {()}):
            places = [*zip(map(without_unit, names), map(word_of, node.args), strict=False), *keywords]
            for (one, first), (other, second) in pairwise(places):
                if one != other and (first, second) == (other, one) and one not in MIRRORED:
                    yield node.lineno, f"{name}: {other} as {one}, {one} as {other}"


def test_arguments_stand_in_the_places_of_their_names() -> None:
    assert slips(swapped) == []


_SIDES = {"at_least": "≥", "at_most": "≤", "low": "≥", "high": "≤"}
_FILE_NAME = re.compile(r"[a-z]+(_[a-z]+)+")
_FILE_UNITS = {unit for units in NAMES.values() for unit in units if unit} | {"rad", "deg", "nm", "µm", "mm", "kN"}


def wrong_pairs(source: Source) -> Slips:
    """Signs of the wrong side of a limit, and units beside a name in the file whose last word has another."""
    for node in source.of(ast.Tuple, ast.Call):
        if isinstance(node, ast.Tuple):
            words = [one.value for one in node.elts if isinstance(one, ast.Constant)]
            if len(words) == len(node.elts) == 2 and words[1] in _SIDES.values() and _SIDES.get(words[0]) != words[1]:
                yield node.lineno, f"{words[0]}: {words[1]}"
        else:
            given = [*node.args, *(one.value for one in node.keywords if one.arg in ("unit", "units", "name"))]
            words = [one.value for one in given if isinstance(one, ast.Constant) and isinstance(one.value, str)]
            # What stands over a speed is no speed.
            named = [one.partition("_over_")[0].rpartition("_")[2] for one in words if _FILE_NAME.fullmatch(one)]
            units = [one for one in words if one in _FILE_UNITS]
            if len(units) == 1 and named and named[0] in NAMES and units[0] not in NAMES[named[0]]:
                yield node.lineno, f"{named[0]} in {units[0]}"


_RULES = {"stiffnesses": {"N/m"}, "radial": {"N/m"}, "tangential": {"N/m"}, "gravity": {"m/s²"}}
"""Names of numbers of a description: units that they have."""


def wrong_rules(source: Source) -> Slips:
    """Units of the rule of a number that its name has not."""
    for node in source.of(ast.Dict, ast.Call, ast.Assign):
        if isinstance(node, ast.Dict):
            entries = [(getattr(key, "value", ""), value) for key, value in zip(node.keys, node.values, strict=True)]
        elif isinstance(node, ast.Assign):
            entries = [(getattr(node.targets[0], "id", ""), node.value)]
        else:
            entries = [(keyword.arg or "", keyword.value) for keyword in node.keywords]
        for name, rule in entries:
            word = str(name).rpartition("_")[2]
            for number in ast.walk(rule) if isinstance(rule, ast.Call) else ():
                if isinstance(number, ast.Call) and ast.unparse(number.func) == "Number":
                    (unit,) = [ast.literal_eval(one.value) for one in number.keywords if one.arg == "unit"] or [""]
                    allowed = _RULES.get(word) or NAMES.get(word)
                    if unit and allowed and unit.partition(" per ")[0] not in allowed | {"rad/s", "N m/rad"}:
                        yield number.lineno, f"{name} in {unit}"


def wrong_frequencies(source: Source) -> Slips:
    """Units of an array in a file whose long name says a natural, a circular, or another frequency."""
    for node in source.of(ast.Call, ast.Tuple):
        words = [one.value for one in getattr(node, "args", getattr(node, "elts", ())) if isinstance(one, ast.Constant)]
        for unit, meaning in pairwise(one for one in words if isinstance(one, str)):
            right = "rad s-1" if re.search("circular|root of stiffness", meaning) else "Hz"
            if unit in {"Hz", "rpm", "rad s-1", "deg s-1"} - {right} and " " in meaning and "speed" not in meaning:
                yield node.lineno, f"{meaning} in {unit}"


def test_signs_and_units_fit_the_words_beside_them() -> None:
    assert slips(wrong_pairs) == []
    assert slips(wrong_rules) == []
    assert slips(wrong_frequencies) == []


_HEADINGS = {
    "Hz": "frequency frequencies torsion turning measured model predicted line back before after at below axis rest",
    "rpm": "speed speeds rotation at between width driver",
    "N": "force load preload radial axial tangential pin flanks z largest",
    "N·m": "torque moment driver y",
    "N/m": "stiffness",
    "N/µm": "stiffness force load z",
    "N/mm": "load pairs pair",
    "MPa": "contact pressure",
    "GPa": "pressure peak",
    "µm": "error displacement deflection deviation compression gap mean peak p amplitude largest "
    "misaligned operation load rms x y",
    "nm": "p",
    "mm": "diameter length face centres end point x y",
    "µrad": "misaligned misalignment tilt twist z",
    "mrad": "angle",
    "rad": "angle phase torsion",
    "°": "angle lag carrier driver turn tip",
    "ms": "time",
    "s": "time length",
    "kg": "mass total",
    "W": "power takes",
    "m/s²": "acceleration amplitude rms excited largest load",
    "dB": "level pressure octaves order damping weighted linear lines transient point L_W L_WA ERP",
    "%": "apart share error basis expected others ratio load before",
    "h": "L10 L10r",
}
"""Unit in brackets: words before it that have it. The nearest known word to its left counts."""
_WORDS_OF_HEADINGS = {word for words in _HEADINGS.values() for word in words.split()}
_HEADING = re.compile(
    rf"([^][]*)\[({'|'.join(sorted(map(re.escape, UNITS), key=len, reverse=True))})(?=[],;]| rms| re )"
)


def texts(source: Source) -> Iterator[tuple[int, str]]:
    """Texts that are no docstrings, with {} for what an f-string puts in."""
    left_out = {id(node.value) for node in source.of(ast.Expr)}
    left_out |= {id(part) for node in source.of(ast.JoinedStr) for part in node.values}
    for node in source.of(ast.Constant, ast.JoinedStr):
        if id(node) not in left_out and (text := text_of(node)) is not None:
            yield node.lineno, text


def wrong_headings(source: Source) -> Slips:
    """Units in brackets behind words that have others; parts not in per cent, torques not in N·m, places not in mm."""
    for line, text in texts(source):
        if "‰" in text or re.search(r"[\d}[] ?N m\b|\) (µm|nm)\b", text):
            yield line, text
        for before, unit in _HEADING.findall(text):
            words = [word for word in re.findall(r"[A-Za-z_0-9]+", before) if word in _WORDS_OF_HEADINGS]
            if "contact" in words:  # pressures of rolling bearings are in GPa
                words = ["contact"]
            if unit not in _HEADINGS or (words and words[-1] not in _HEADINGS[unit].split()):
                yield line, f"{before.strip()} in {unit}"


def test_units_in_brackets_fit_the_words_before_them() -> None:
    assert slips(wrong_headings) == []
    assert sum(1 for source in sources().values() for _, text in texts(source) if _HEADING.search(text)) > 200


_INSIDE = {"m", "N", "N m", "N/m", "rad", "Pa", "kg", "s", "W", "m/s2", "m2", "%"}
"""Dimensions whose values are in SI's unit, or parts of 1, wherever their names say nothing else."""
_SHOWN_AS = (
    "number listed least name value low high largest rms stiffness mean part swing named as_given without out_of_line "
    "percent worst nearest reached x y z mesh_size thickness shear outer_diameter roller_diameter"
)
"""Names of texts, and of values that are in the unit of a table or of a figure."""


def assigned(source: Source) -> dict[str, list[tuple[int, ast.expr]]]:
    """Lines and expressions that give a name its value; of a text, the value in it."""
    found: defaultdict[str, list[tuple[int, ast.expr]]] = defaultdict(list)
    for node in source.of(ast.Assign):
        target, value = node.targets[0], node.value
        several = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
        for one, given in zip(target.elts, value.elts, strict=False) if several else [(target, value)]:
            if isinstance(one, ast.Name):
                inside = [inner.value for inner in ast.walk(given) if isinstance(inner, ast.FormattedValue)]
                found[one.id].append((node.lineno, inside[0] if inside else given))
    return found


def unnamed(source: Source) -> Slips:
    """Values of expressions without a name whose factor is not that of the unit behind them."""
    numbers = constants(source.tree)
    for part, shown in units_behind(source):
        factor, (dimension, size) = scale_of(part.value)[0], UNITS[shown]
        if factor_and_name(part.value, numbers) or factor == 1.0:
            continue
        text, scale = ast.unparse(part.value), abs(factor) * size * (1e-2 if dimension == "%" else 1.0)
        known = [1.0, *(many for word, many in _TWICE.items() if word in text)]
        if dimension in _INSIDE and not any(isclose(scale, one) for one in known):
            yield part.lineno, f"{text} in {shown}"


def unscaled(source: Source) -> Slips:
    """Values of the inside, in SI, whose factor in a text is not that of the unit behind them."""
    numbers, named = constants(source.tree), assigned(source)
    for line, name, factor, shown in values_with_units(source):
        dimension, size = UNITS[shown]
        before = [given for at, given in named.get(name, ()) if at < line]
        if factor == 1.0 and before and (found := factor_and_name(before[-1], numbers)):
            factor, name = found
            if (said := dimension_of(name)) in _INSIDE and (said != dimension or not isclose(factor * size, 1.0)):
                yield line, f"{factor:g} {name} in {shown}"
        size *= 1e-2 if dimension == "%" else 1.0
        shown_so = factor not in (1e3, 1e6) and name in _SHOWN_AS.split()
        if dimension not in _INSIDE or dimension_of(name) is not None or shown_so:
            continue
        known = [
            1.0,
            2.0 if "radius" in name or name == "inside" else 1.0,
            size if "deg" in name or "angle" in name else 1.0,
        ]
        if not any(isclose(factor * size, one) for one in known):
            yield line, f"{factor:g} {name} in {shown}"


def test_values_of_the_inside_are_scaled_to_the_unit_behind_them() -> None:
    assert slips(unscaled) == []
    assert slips(unnamed) == []


_ATTRIBUTE = re.compile(r" +(\w+(?:, \w+)*) : ")
_BRACKETS = re.compile(r"\[([^]1]+)\]")
UNRULED = {("NodeSpring", "stiffness"), ("NodeSpring", "damping"), ("RingSupport", "count")}
"""Attributes of two units, and one that is checked where it is given."""


def documented_units(node: ast.ClassDef) -> dict[str, str]:
    """Units in the docstring of a class by attribute: the first in brackets behind its name."""
    found, names = dict[str, str](), list[str]()
    for line in (ast.get_docstring(node, clean=False) or "").splitlines():
        if begins := _ATTRIBUTE.match(line):
            names = begins[1].split(", ")
        if unit := _BRACKETS.search(line):
            found |= {name: unit[1] for name in names if name not in found}
    return found


def _calls(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == name


def rules_of(node: ast.ClassDef) -> Iterator[tuple[str, dict[str, str], bool]]:
    """Attribute, arguments and whether it is a row, of each `Number` that a class demands by name."""
    inside = [*ast.walk(node)]
    named = {ast.unparse(one.targets[0]): one.value for one in inside if isinstance(one, ast.Assign)}
    for one in inside:
        match one:
            case ast.Dict(keys=keys, values=values):
                entries = [
                    (key.value, rule) for key, rule in zip(keys, values, strict=True) if isinstance(key, ast.Constant)
                ]
            case ast.Call(keywords=keywords):
                entries = [(keyword.arg, keyword.value) for keyword in keywords]
            case _:
                continue
        for name, given in entries:
            rule = named.get(given.id, given) if isinstance(given, ast.Name) else given
            is_row = _calls(rule, "Numbers") and len(rule.args) == 2  # type: ignore[attr-defined]
            rule = rule.args[1] if is_row else rule  # type: ignore[attr-defined]
            if _calls(rule, "Number"):
                yield str(name), {str(one.arg): ast.unparse(one.value) for one in rule.keywords}, is_row


def undocumented_rules(source: Source) -> Slips:
    """Numbers whose unit is not that of the docstring, or which may be None where the annotation has none."""
    for node in source.of(ast.ClassDef) if any(_calls(call, "Number") for call in source.of(ast.Call)) else ():
        units = documented_units(node)
        kinds = {
            ast.unparse(one.target): ast.unparse(one.annotation) for one in node.body if isinstance(one, ast.AnnAssign)
        }
        for name, given, is_row in rules_of(node):
            if name not in kinds or (node.name, name) in UNRULED:
                continue
            if units and ast.literal_eval(given.get("unit", "''")) != units.get(name, ""):
                yield node.lineno, f"{node.name}.{name} in {given.get('unit')}, documented in {units.get(name)}"
            if not is_row and (given.get("optional") == "True") != ("None" in kinds[name]):
                yield node.lineno, f"{node.name}.{name} of {kinds[name]}, optional: {given.get('optional')}"


def test_numbers_are_demanded_in_the_units_of_their_docstrings() -> None:
    assert slips(undocumented_rules) == []
    (pins,) = (node for node in sources()["coupling/machine/pins.py"].of(ast.ClassDef) if node.name == "PinBeam")
    assert {name: given.get("unit") for name, given, _ in rules_of(pins)} == {"diameter": "'m'", "bore": "'m'"}
