"""Draws faults over all statements of the product, and tells which of them the tests let through: drawn_faults.py

A list of faults from one's own memory holds what one has tested. Here a seed draws them: a sign, a factor, an index, a
name, a unit, a term, a comparison, two arguments. The tests of a fault are the fast ones that run its line, the
quickest first; of a statement that none runs, slow ones, too: those that import its file or are listed for it.
Verdicts are kept in ``build/drawn-faults``, so that a run goes on where it was. A fault that changes no result stands
with the reason in ``tests/faults/equivalent.toml``. None is drawn in a kernel's source: all kernels would be compiled::

    python benchmarks/drawn_faults.py --map                            # which test runs which lines, half an hour
    python benchmarks/drawn_faults.py --map tests/coupling/test_x.py   # of these tests anew
    python benchmarks/drawn_faults.py --number 60 --seed 1 --under gearwhine/results --under coupling
    python benchmarks/drawn_faults.py --survivors                      # again what survived before, of any seed
    python benchmarks/drawn_faults.py --types --seed 1                 # ... and whether the strict types refuse those
"""

import argparse
import ast
import json
import os
import random
import re
import subprocess
import sys
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from faults import LISTS, ROOT, Fault, caught, copy_tree, environment, read_faults
from traced_lines import ROOMS

BUILD = ROOT / "build" / "drawn-faults"
LINES, VERDICTS, TREE = BUILD / "lines.jsonl", BUILD / "verdicts.json", BUILD / "tree"
EQUIVALENT = LISTS / "equivalent.toml"
_SECONDS_OF_TESTS = 60.0  # of a fault's running tests by the map, which is made at about half the speed
_FILES_OF_TESTS = 15
# Tests that read the source of what they hold, or run it in processes of their own, by the beginning of its path: the
# map has no line of it.
_UNSEEN = {
    "tests/meshes/test_cad.py": ("meshes/cad/",),
    "tests/gearwhine/cli/test_interruption_handling.py": ("gearwhine/interruption.py", "gearwhine/drawing_process.py"),
    "tests/gearwhine/analyses/test_drawing_beside.py": ("gearwhine/drawing_process.py",),
    "tests/gearwhine/sweep/test_sweep_points.py": ("gearwhine/workers.py",),
    "tests/gearwhine/results/test_units_of_declarations.py": ("gearwhine/results/",),
    "tests/gearwhine/results/test_names_of_results.py": ("gearwhine/results/",),
    "tests/test_written_slips.py": tuple(f"{room}/" for room in ROOMS),
}
# Processor time of one run [s]: a fault that never ends is caught, however loaded the machine.
_LIMIT, _LIMIT_OF_SLOW = 300, 1800

_KEY = re.compile(r"[a-z][a-z0-9_]+")
_COUNT = re.compile(r"([ijkmn]|\w*(number|index|row|column|place|rank)) ?\W?.*")  # what a sequence is indexed by
_UNITS = {"µm": "nm", "mm": "µm", "nm": "µm", "Hz": "rpm", "kN": "N", "N m": "N", "dB(A)": "dB", "dB": "dB(A)"}
_UNITS |= {"m/s²": "m/s", "rpm": "Hz", "µrad": "mrad", "N/m": "N", "MPa": "GPa", "rad": "deg", "%": "‰"}
_UNIT = re.compile(r"(?<![\w/])(" + "|".join(sorted(map(re.escape, _UNITS), key=len, reverse=True)) + r")(?![\w/(])")
_SWAPPED: dict[type, tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Lt: ("<", ">"),
    ast.Gt: (">", "<"),
    ast.LtE: ("<=", ">="),
    ast.GtE: (">=", "<="),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
}


@dataclass(frozen=True)
class DrawnFault(Fault):
    """A piece of a file from ``begin`` on; ``area`` is the kind of the fault.

    ``spans`` are the first and last lines of the piece, of the statements around it, the innermost first, and of those
    that use a constant of the module.
    """

    begin: int = 0
    spans: tuple[tuple[int, int], ...] = ()
    source: str = ""  # the line of the file where it begins

    def changed(self, text: str) -> str:
        """The text of the file with the fault in it."""
        return text[: self.begin] + self.after + text[self.begin + len(self.before) :]

    @property
    def key(self) -> str:
        """Words that name the fault in kept verdicts, whatever the order in which it was drawn."""
        return f"{self.file}:{self.spans[0][0]} {self.before!r} -> {self.after!r}"


class Module:
    """A file of the product: its text, its tree, and the faults that it can have."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.text = (ROOT / name).read_text(encoding="utf-8")
        self.starts = [0]
        for line in self.text.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))
        self.rows = self.text.splitlines()
        self.words: dict[tuple[str, ...], set[str]] = defaultdict(set)  # strings of like places
        self.attributes: dict[str, set[str]] = defaultdict(set)  # attributes taken from one object
        tree = ast.parse(self.text)
        imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
        # Another function of a module, such as of numpy, is no slip of the pen.
        self.modules = {name.asname or name.name for node in imports for name in node.names}
        # No test runs the line of a constant of the module: it is the lines that use it that run.
        self.constants = {
            node.lineno: target.id
            for node in tree.body
            if isinstance(node, ast.Assign | ast.AnnAssign)
            for target in (node.targets if isinstance(node, ast.Assign) else [node.target])
            if isinstance(target, ast.Name)
        }
        self.uses: dict[str, list[tuple[int, int]]] = defaultdict(list)
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
                self.uses[node.id].append((node.lineno, node.lineno))
        self.nodes = list(self.walk(tree, (), ("",)))
        for node, _, place in self.nodes:
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                self.words[place].add(self.piece(node))
            elif isinstance(node, ast.Attribute):
                self.attributes[ast.unparse(node.value)].add(node.attr)

    def walk(
        self, node: ast.AST, spans: tuple[tuple[int, int], ...], place: tuple[str, ...]
    ) -> Iterator[tuple[ast.AST, tuple[tuple[int, int], ...], tuple[str, ...]]]:
        """Nodes that compute something, each with the lines of the statements around it and the place it stands in."""
        if isinstance(node, ast.Raise | ast.Import | ast.ImportFrom | ast.Assert | ast.JoinedStr | ast.ClassDef):
            if isinstance(node, ast.ClassDef):
                for child in node.body:
                    docstring = isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant)
                    if not isinstance(child, ast.AnnAssign) and not docstring:
                        yield from self.walk(child, spans, ("",))
            elif isinstance(node, ast.JoinedStr):
                yield node, spans, place
                for value in node.values:
                    yield from self.walk(value, spans, ("f-string",))
            return
        if isinstance(node, ast.stmt):
            header = getattr(node, "body", None)
            last = header[0].lineno - 1 if isinstance(header, list) and header else node.end_lineno
            spans = ((node.lineno, max(node.lineno, last or 0)), *spans)
        yield node, spans, place
        for field, value in ast.iter_fields(node):
            if field in ("annotation", "returns", "decorator_list", "bases", "type_comment"):
                continue
            for number, child in enumerate(value if isinstance(value, list) else [value]):
                docstring = isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant)
                checking = isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING"
                asserting = isinstance(child, ast.keyword) and child.arg == "strict"  # of what is never of two lengths
                if isinstance(child, ast.AST) and not docstring and not checking and not asserting:
                    where = place
                    if isinstance(node, ast.Call):
                        where = ("call", ast.unparse(node.func), str(number) if field == "args" else field)
                    elif isinstance(node, ast.keyword):
                        where = (*place, node.arg or "")
                    elif not isinstance(node, ast.expr_context | ast.Tuple | ast.List):
                        where = (type(node).__name__, field)
                    yield from self.walk(child, spans, where)

    def offset(self, line: int, column: int) -> int:
        """Offset in the text; the tree's columns count bytes."""
        return self.starts[line - 1] + len(self.rows[line - 1].encode()[:column].decode())

    def ends(self, node: ast.AST) -> tuple[int, int]:
        """Offsets of a node's first character and past its last."""
        assert isinstance(node, ast.expr | ast.stmt | ast.keyword)
        return self.offset(node.lineno, node.col_offset), self.offset(node.end_lineno or 0, node.end_col_offset or 0)

    def piece(self, node: ast.AST) -> str:
        """Text of a node."""
        begin, end = self.ends(node)
        return self.text[begin:end]

    def faults(self) -> list[DrawnFault]:
        """Every fault that the file can have and that is Python still."""
        found: dict[tuple[int, str, str], DrawnFault] = {}
        for node, spans, place in self.nodes:
            if not spans:
                continue
            for kind, begin, end, after in self.changes(node, place):
                before = self.text[begin:end]
                first = self.text.count("\n", 0, begin) + 1
                lines = (first, first + before.count("\n"))
                source = self.rows[first - 1].strip()
                used = self.uses.get(self.constants.get(spans[-1][0], ""), [])
                fault = DrawnFault(0, kind, self.name, before, after, begin, (lines, *spans, *used), source)
                if before != after:
                    found[begin, before, after] = fault
        return list(found.values())

    def changes(self, node: ast.AST, place: tuple[str, ...]) -> Iterator[tuple[str, int, int, str]]:
        """Kinds of fault of one node: kind, begin and end of the piece, and the text in its place."""
        match node:
            case ast.BinOp(left=left, op=op, right=right):
                texts = any(isinstance(side, ast.JoinedStr | ast.List | ast.Tuple) for side in (left, right))
                if not texts and not any(isinstance(getattr(side, "value", 0), str) for side in (left, right)):
                    kind = "factor" if isinstance(op, ast.Mult) else "sign"
                    yield from self.operator(kind, left, op, right)
                    yield "term", *self.ends(node), self.piece(left)
                    if isinstance(op, ast.Mult | ast.Div):
                        for factor in ("0.5", "2.0"):
                            yield "factor", *self.ends(node), f"({factor} * ({self.piece(node)}))"
            case ast.UnaryOp(op=ast.USub() | ast.Not(), operand=operand):
                yield "sign", *self.ends(node), self.piece(operand)
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                yield from self.operator("comparison", left, op, right)
            case ast.BoolOp(op=op, values=[first, second, *_]):
                yield from self.operator("comparison", first, op, second)
                yield "term", self.ends(first)[0], self.ends(second)[1], self.piece(first)
            case ast.Constant(value=bool(value)):
                yield "comparison", *self.ends(node), str(not value)
            case ast.Constant(value=int(value)) if place[0] != "f-string":
                yield "index", *self.ends(node), str(value + 1)
                if value > 0:
                    yield "index", *self.ends(node), str(value - 1)
            case ast.Constant(value=float(value)) if value:
                for factor in (0.5, 2.0):
                    yield "factor", *self.ends(node), repr(value * factor)
            case ast.Constant(value=str(value)) if place[0] != "f-string":
                if _KEY.fullmatch(value) or "[" in value:
                    for other in sorted(self.words[place] - {f'"{value}"', f"'{value}'"}):
                        if ("[" in other) == ("[" in value) and (_KEY.fullmatch(other[1:-1]) or "[" in value):
                            yield "name", *self.ends(node), other
                yield from self.units(node)
            case ast.JoinedStr():
                yield from self.units(node)
            case ast.Attribute(value=value, attr=attr, ctx=ast.Load()):
                begin, end = self.ends(node)
                if isinstance(value, ast.Name) and value.id in self.modules:
                    return
                for other in sorted(self.attributes[ast.unparse(value)] - {attr}):
                    yield "name", end - len(attr), end, other
            case ast.Subscript(slice=ast.Slice(lower=lower, upper=upper) as cut, ctx=ast.Load()):
                begin, end = self.ends(cut)
                low, high = ("" if side is None else self.piece(side) for side in (lower, upper))
                yield "index", begin, end, f"{low + ' + ' if low else ''}1:{high}"
                yield "index", begin, end, f"{low}:{high + ' - 1' if high else '-1'}"
            case ast.Subscript(slice=ast.Name() | ast.BinOp() as at, ctx=ast.Load()) if _COUNT.fullmatch(
                ast.unparse(at)
            ):
                yield "index", *self.ends(at), f"{self.piece(at)} - 1"
            case ast.Expr(value=ast.Call()):
                yield "term", *self.ends(node), "pass"
            case ast.AugAssign():
                yield "term", *self.ends(node), "pass"
            case ast.Call(func=func, args=args, keywords=keywords):
                yield from self.arguments(node, func, args, keywords)

    def alike(self, first: ast.expr, second: ast.expr) -> bool:
        """Whether both are constants by their names, or neither is."""
        return ast.unparse(first).isupper() == ast.unparse(second).isupper()

    def operator(self, kind: str, left: ast.AST, op: ast.AST, right: ast.AST) -> Iterator[tuple[str, int, int, str]]:
        """Another operator between two operands."""
        if type(op) in _SWAPPED:
            was, now = _SWAPPED[type(op)]
            begin, end = self.ends(left)[1], self.ends(right)[0]
            at = self.text.find(was, begin, end)
            if at >= 0:
                yield kind, at, at + len(was), now

    def units(self, node: ast.AST) -> Iterator[tuple[str, int, int, str]]:
        """Another unit in a text."""
        begin, end = self.ends(node)
        for found in _UNIT.finditer(self.text, begin, end):
            yield "unit", *found.span(), _UNITS[found[0]]

    def arguments(
        self, node: ast.AST, func: ast.expr, args: list[ast.expr], keywords: list[ast.keyword]
    ) -> Iterator[tuple[str, int, int, str]]:
        """Two arguments swapped, one dropped, or a function of one argument left out."""
        plain = ast.Name | ast.Attribute | ast.Subscript
        values = [*args, *(keyword.value for keyword in keywords if keyword.arg)]
        for first, second in pairwise(values):
            if isinstance(first, plain) and isinstance(second, plain) and self.alike(first, second):
                begin, middle = self.ends(first)
                other, end = self.ends(second)
                yield "arguments", begin, end, self.piece(second) + self.text[middle:other] + self.piece(first)
        if len(args) == 1 and not keywords and ast.unparse(func) in ("abs", "np.abs", "np.conj", "sorted", "np.sqrt"):
            yield "term", *self.ends(node), self.piece(args[0])
        for keyword in keywords:
            begin, end = self.ends(keyword)
            if keyword.arg not in (None, "strict") and self.text[:begin].rstrip().endswith(","):
                yield "term", len(self.text[:begin].rstrip()) - 1, end, ""


def draw(number: int, seed: int, under: list[str]) -> list[DrawnFault]:
    """Faults drawn over the files below some paths, each kind as often as the others, wrong names twice as often.

    A line is drawn first and then its fault, so that a long table of names is no likelier than its lines are.
    """
    from gearwhine.numerics.compiled import has_kernels, kernel_sources

    files = [path for room in ROOMS for path in (ROOT / room).rglob("*.py") if has_kernels(path)]
    kernels = {str(source.relative_to(ROOT)) for path in files for source in kernel_sources(ROOT, path)}
    names = [str(path.relative_to(ROOT)) for room in ROOMS for path in sorted((ROOT / room).rglob("*.py"))]
    modules = {name: Module(name) for name in names if name.startswith(tuple(under)) and name not in kernels}
    kinds: dict[str, dict[tuple[str, int], list[DrawnFault]]] = defaultdict(lambda: defaultdict(list))
    for name, module in modules.items():
        for fault in module.faults():
            kinds[fault.area][name, fault.spans[0][0]].append(fault)
    chance, drawn = random.Random(seed), list[DrawnFault]()
    while len(drawn) < number:
        lines = kinds[chance.choice([*sorted(kinds), "name"])]
        fault = chance.choice(lines[chance.choice(sorted(lines))])
        try:
            ast.parse(fault.changed(modules[fault.file].text))
        except SyntaxError:
            continue
        if fault.key not in {other.key for other in drawn}:
            drawn.append(fault)
    return drawn


def kept(keys: list[str]) -> list[DrawnFault]:
    """Faults of earlier draws by their keys, where the code has them still."""
    names = sorted({key.partition(":")[0] for key in keys})
    faults = {fault.key: fault for name in names if (ROOT / name).exists() for fault in Module(name).faults()}
    return [faults[key] for key in keys if key in faults]


def tests_of(fault: DrawnFault, lines: dict[str, dict[str, list[int]]], seconds: dict[str, float]) -> list[str]:
    """Test files that run the line of a fault, else its statement, else the file.

    Of each, those that import the file come first, then the quickest.
    """
    imported = imports_of(fault.file)

    def rank(test: str) -> tuple[bool, float]:
        return imported.search((ROOT / test).read_text(encoding="utf-8")) is None, seconds[test]

    ordered = dict[str, None]()
    for first, last in (*fault.spans, (0, 10**9)):
        touching = [test for test, files in lines.items() if any(first <= n <= last for n in files.get(fault.file, ()))]
        ordered |= dict.fromkeys(sorted((test for test in touching if (ROOT / test).exists()), key=rank))
    chosen, total = list[str](), 0.0
    for test in ordered:
        total += seconds.get(test, 0.0)
        if not chosen or (total <= _SECONDS_OF_TESTS and len(chosen) < _FILES_OF_TESTS):
            chosen.append(test)
    return list(dict.fromkeys([*chosen, *(test for test, places in _UNSEEN.items() if fault.file.startswith(places))]))


def slow_tests_of(fault: DrawnFault, lines: dict[str, dict[str, list[int]]]) -> list[str]:
    """Files whose slow tests may run a statement that no fast test runs; none of another statement."""
    spans = [*fault.spans[:2], *(span for span in fault.spans[2:] if span[0] == span[1])]
    run = {n for files in lines.values() for n in files.get(fault.file, ())}
    if any(first <= n <= last for first, last in spans for n in run):
        return []
    listed, tests = read_faults()
    of_lists = {name for area in {one.area for one in listed if one.file == fault.file} for name in tests[area]}
    imports, files = imports_of(fault.file), sorted((ROOT / "tests").rglob("test_*.py"))
    texts = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8") for path in files}
    slow = {name: text for name, text in texts.items() if "mark.slow" in text}
    return sorted((name for name in slow if name in of_lists or imports.search(slow[name])), key=of_lists.__contains__)


def imports_of(file: str) -> re.Pattern[str]:
    """Pattern of a line that imports from a file of the product."""
    module = file.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    return re.compile(rf"^ *from (gearwhine\.)?{re.escape(module)} import", re.MULTILINE)


def refused_by_types(fault: DrawnFault) -> bool:
    """Whether the strict types, which `make test` checks, refuse the copy with the fault in it."""
    before = fault.put_into(TREE)
    try:
        command = [sys.executable, "-m", "mypy", "--no-error-summary"]
        return subprocess.run(command, cwd=TREE, capture_output=True, check=False).returncode == 1
    finally:
        (TREE / fault.file).write_text(before, encoding="utf-8")


def trace(tests: list[str]) -> None:
    """Make the map of the fast tests, or of some of them anew."""
    kept = [json.loads(line) for line in LINES.read_text(encoding="utf-8").splitlines()] if LINES.exists() else []
    kept = [entry for entry in kept if not entry["test"].startswith(tuple(tests))]
    LINES.write_text("".join(json.dumps(entry) + "\n" for entry in kept), encoding="utf-8")
    surroundings = os.environ | {
        "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'benchmarks'}",
        "TRACED_LINES": str(LINES),
    }
    command = [sys.executable, "-m", "pytest", "-q", "-p", "traced_lines", "-m", "not slow", *tests]
    subprocess.run(command, cwd=ROOT, env=surroundings, check=False)


def main() -> None:
    """Draw faults, try those that have no verdict yet, and print a table by kind."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--map", nargs="*", metavar="TEST", help="trace the fast tests, or these")
    parser.add_argument("--number", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--under", action="append", help="only files of paths that begin so; may be repeated")
    parser.add_argument("--survivors", action="store_true", help="try again all that survived before")
    parser.add_argument("--types", action="store_true", help="hold what the tests let through against the types")
    parser.add_argument("--list", action="store_true", help="only print the drawn faults and their tests")
    given = parser.parse_args()
    BUILD.mkdir(parents=True, exist_ok=True)
    if given.map is not None:
        trace(given.map or ["tests"])
        return
    traced = [json.loads(line) for line in LINES.read_text(encoding="utf-8").splitlines()]
    lines = {entry["test"]: entry["lines"] for entry in traced}
    seconds = {entry["test"]: entry["seconds"] for entry in traced}
    verdicts = json.loads(VERDICTS.read_text(encoding="utf-8")) if VERDICTS.exists() else {}
    reasons = {
        tuple(entry[key] for key in ("file", "line", "before", "after")): entry["reason"]
        for entry in tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))["fault"]
    }
    survived = [key for key, verdict in verdicts.items() if verdict.startswith("SURVIVED")]
    drawn = kept(survived) if given.survivors else draw(given.number, given.seed, given.under or [""])
    if not given.list:
        copy_tree(TREE)
        if not (TREE / ".kernels").exists():
            subprocess.run([sys.executable, "scripts/compile_kernels.py"], cwd=TREE, env=environment(TREE), check=True)
    table: dict[str, Counter[str]] = defaultdict(Counter)
    for number, fault in enumerate(drawn, start=1):
        tests = tests_of(fault, lines, seconds)
        reason = reasons.get((fault.file, fault.source, fault.before, fault.after))
        verdict = verdicts.get(fault.key, "")
        if reason:
            verdict = "equivalent"
        elif given.list:
            verdict = verdict or f"{len(tests)} tests"
        elif not tests:
            verdict = "SURVIVED untested"
        elif not verdict or given.survivors:
            found, text = caught(TREE, fault, [tests], "-m", "not slow", limit=_LIMIT)
            if not found and (slow := slow_tests_of(fault, lines)):
                found, text = caught(TREE, fault, [slow], "-m", "slow", limit=_LIMIT_OF_SLOW)
            by = re.search(r"^(?:FAILED|ERROR) (\S+)", text, re.MULTILINE)
            verdict = f"caught by {by[1] if by else text[-60:].strip()}" if found else "SURVIVED"
            if given.types and not found and refused_by_types(fault):
                verdict = "refused by types"
            verdicts[fault.key] = verdict
            VERDICTS.write_text(json.dumps(verdicts, indent=1), encoding="utf-8")
        sys.stdout.write(f"{number:4d} {fault.area:10} {fault.key}: {verdict}{f' ({reason})' if reason else ''}\n")
        sys.stdout.flush()
        table[fault.area][verdict.split()[0]] += 1
        table["all"][verdict.split()[0]] += 1
    for kind in [*sorted(table.keys() - {"all"}), "all"]:
        sys.stdout.write(f"{kind:10} " + ", ".join(f"{count} {word}" for word, count in table[kind].items()) + "\n")


if __name__ == "__main__":
    main()
