"""Signs of the structure: how far results walk from the case, how often a run derives the same, how long all of it is.

    python benchmarks/structure.py            # reads the sources; one run of spur-pair counts what it makes
    python benchmarks/structure.py --no-run

The numbers are signs, not aims: they say where two ways lead to the same physics.
"""

import ast
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("numerics", "meshes", "housing", "rotors", "coupling", "gearwhine")
FRONT = ("solve", "sweep", "from_case")

Function = ast.FunctionDef | ast.AsyncFunctionDef


def sources(folder: str) -> list[Path]:
    """Python files of a folder, without those behind the links of the front door."""
    return sorted(path for path in (ROOT / folder).rglob("*.py"))


def lines(folder: str) -> int:
    return sum(len(path.read_text(encoding="utf-8").splitlines()) for path in sources(folder))


def functions(folder: str) -> Iterator[Function]:
    for path in sources(folder):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, Function):
                yield node


def case_parameters(function: Function) -> list[str]:
    """Names of the parameters that are a whole case."""
    given = [*function.args.args, *function.args.kwonlyargs]
    return [one.arg for one in given if one.annotation is not None and ast.unparse(one.annotation) == "Case"]


def attributes_read(function: Function, name: str) -> set[str]:
    return {
        node.attr
        for node in ast.walk(function)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == name
    }


def none_asserts(folder: str) -> int:
    return sum(
        isinstance(node, ast.Assert) and ast.unparse(node.test).endswith("is not None")
        for path in sources(folder)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    )


def case_free_lines() -> tuple[int, int]:
    """Lines of functions and classes that name no case, and all lines, between the case and the results."""
    free = total = 0
    for folder in FRONT:
        for path in sources(f"gearwhine/{folder}"):
            text = path.read_text(encoding="utf-8")
            total += len(text.splitlines())
            for node in ast.parse(text).body:
                if isinstance(node, Function | ast.ClassDef) and "case" not in ast.unparse(node).lower():
                    free += (node.end_lineno or node.lineno) - node.lineno + 1
    return free, total


@contextmanager
def counted(counts: Counter[str]) -> Iterator[None]:
    """Count the trains that are derived, and the gears, bearings and machines that are made."""
    from gearwhine import coupling, rotors
    from gearwhine.coupling.description import gear_train
    from gearwhine.coupling.gears import Gear

    made: list[tuple[Any, str]] = [
        (Gear, "gears"),
        (rotors.Bearing, "bearings"),
        (coupling.Machine, "machines"),
        (gear_train.GearTrain, "gear trains"),
    ]
    originals = [kind.__init__ for kind, _ in made]

    def counting(original: Any, name: str) -> Any:
        def init(self: Any, *args: Any, **options: Any) -> None:
            counts[name] += 1
            original(self, *args, **options)

        return init

    for (kind, name), original in zip(made, originals, strict=True):
        kind.__init__ = counting(original, name)
    try:
        yield
    finally:
        for (kind, _), original in zip(made, originals, strict=True):
            kind.__init__ = original


def main() -> None:
    whole = [(one, name) for one in functions("gearwhine") for name in case_parameters(one)]
    few = sum(len(attributes_read(function, name)) <= 1 for function, name in whole)
    free, total = case_free_lines()
    product = sum(map(lines, ROOMS))
    rows = {
        "functions of gearwhine that take a whole case": len(whole),
        "... that read at most one of its attributes": few,
        "asserts 'is not None' in gearwhine": none_asserts("gearwhine"),
        "asserts 'is not None' in coupling": none_asserts("coupling"),
        "lines of solve, sweep, from_case": total,
        "... in functions and classes that name no case": free,
        "lines of gearwhine": lines("gearwhine"),
        "lines of the product": product,
        "lines of the tests": lines("tests"),
    }
    if "--no-run" not in sys.argv:
        import gearwhine as gw

        study, counts = gw.load("spur-pair", {"transient.revolutions": 4, "transient.discard": 2}), Counter[str]()
        with counted(counts):
            study.run()
        rows |= {f"{name} made by one run of spur-pair": count for name, count in sorted(counts.items())}
    width = max(map(len, rows))
    for name, count in rows.items():
        print(f"{name:<{width}} {count:>8}")


if __name__ == "__main__":
    main()
