"""The rooms' arrows: meshes -> housing -> coupling <- rotors, numerics below them, and gearwhine in front of all."""

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ALLOWED = {
    "numerics": set(),
    "meshes": {"numerics"},
    "rotors": {"numerics"},
    "housing": {"numerics", "meshes"},
    "coupling": {"numerics", "meshes", "housing", "rotors"},
    "gearwhine": {"numerics", "meshes", "rotors", "housing", "coupling"},
}


@cache
def imports_in(path: Path) -> tuple[ast.Import | ast.ImportFrom, ...]:
    """Import statements anywhere in a file, also late or for types alone."""
    found: list[ast.Import | ast.ImportFrom] = []
    blocks: list[ast.AST] = [ast.parse(path.read_text(encoding="utf-8"))]
    while blocks:
        # Only statements hold statements: expressions, most of a tree, are not looked at.
        for node in ast.iter_child_nodes(blocks.pop()):
            if isinstance(node, ast.Import | ast.ImportFrom):
                found.append(node)
            elif not isinstance(node, ast.expr):
                blocks.append(node)
    return tuple(found)


def imported_rooms(path: Path) -> set[str]:
    names: set[str] = set()
    for node in imports_in(path):
        if isinstance(node, ast.Import):
            names |= {room_of(alias.name) for alias in node.names}
        elif node.level == 0 and node.module:
            names |= {room_of(f"{node.module}.{alias.name}") for alias in node.names}
    return names & set(ALLOWED)


def room_of(module: str) -> str:
    """Return the room of a module: gearwhine.housing.modes is of housing, gearwhine.case of the front door."""
    parts = module.split(".")
    return parts[1] if parts[0] == "gearwhine" and parts[1:2] and parts[1] in ALLOWED else parts[0]


@pytest.mark.parametrize("room", ALLOWED)
def test_a_room_imports_only_what_its_arrows_allow(room: str) -> None:
    files = sorted((ROOT / room).rglob("*.py"))
    assert files, f"{room} has no modules"
    for path in files:
        forbidden = imported_rooms(path) - ALLOWED[room] - {room}
        assert not forbidden, f"{path.relative_to(ROOT)} imports {sorted(forbidden)}"


def test_the_rooms_are_imported_as_parts_of_the_package() -> None:
    """PyPI has a ``housing``, a ``coupling`` and a ``meshes`` of others, and a user's folder may have such a file."""
    folders = (*ALLOWED, "tests", "scripts", "benchmarks", "docs")
    for path in (path for folder in folders for path in sorted((ROOT / folder).rglob("*.py"))):
        for node in imports_in(path):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) and node.level == 0 else []
            bare = {name for name in names if name.partition(".")[0] in set(ALLOWED) - {"gearwhine"}}
            assert not bare, f"{path.relative_to(ROOT)} imports {sorted(bare)}; expected gearwhine.…"


HEAVY = ["gmsh", "meshio", "vtk", "vtkmodules", "pyvista", "PIL", "matplotlib", "skfem", "rslab", "numba"]
HEAVY += ["pydantic", "pint", "xarray"]
IMPORTS = {
    "the front door": {
        "gearwhine": ["numpy", "scipy", "pydantic", "xarray"],
        "gearwhine.case": [
            "numpy",
            "scipy",
            "pint",
            "gmsh",
            *(f"gearwhine.{room}" for room in ("meshes", "housing", "rotors", "coupling")),
        ],
    },
    "the rooms": {
        "gearwhine.meshes": [*HEAVY, "scipy.optimize", "scipy.spatial"],
        "gearwhine.housing": [*HEAVY, "scipy.optimize", "scipy.spatial"],
        "gearwhine.rotors": HEAVY,
        "gearwhine.coupling.gears": HEAVY,
    },
}
"""Modules imported one after the other, and what none of them up to there may bring."""


@pytest.mark.parametrize("door", IMPORTS)
def test_an_import_brings_neither_mesher_nor_renderer_nor_compiler(door: str) -> None:
    code = "import importlib, sys\n"
    code += f"for name, heavy in {IMPORTS[door]!r}.items():\n    importlib.import_module(name)\n"
    code += "    print(name, *(one for one in heavy if one in sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout.splitlines() == list(IMPORTS[door])


def test_help_imports_nothing_that_takes_long() -> None:
    heavy = {"gmsh", "vtkmodules", "pyvista", "matplotlib", "numba", "scipy", "numpy", "pint", "xarray", "skfem"}
    statement = "from gearwhine.cli import run_command\nassert run_command(['--help']) == 0"
    code = f"{statement}\nimport sys\nprint(' '.join(sorted(sys.modules)), file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert "Usage" in done.stdout
    assert not {name.split(".")[0] for name in done.stderr.split()} & heavy


def module_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    parts = parts if parts[0] == "gearwhine" else ("gearwhine", *parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported_modules(path: Path, known: set[str]) -> set[str]:
    """Modules of ours that a file imports anywhere in it, also late or for types alone; its own packages left out."""
    own = module_of(path)
    package = own if path.name == "__init__.py" else own.rpartition(".")[0]
    found: set[str] = set()
    for node in imports_in(path):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        else:
            base = package.rsplit(".", node.level - 1)[0] if node.level > 1 else package
            module = node.module or "" if node.level == 0 else ".".join(filter(None, (base, node.module)))
            inner = {f"{module}.{alias.name}" for alias in node.names}
            found |= {one if one in known else module for one in inner}
    # A package's own face re-exports what its modules have: only modules can be in a circle with each other.
    return {one for one in found & known if not (own == one or own.startswith(f"{one}."))}


def circles(arrows: dict[str, set[str]]) -> list[list[str]]:
    """Sets of modules that import each other, by Tarjan's strongly connected components."""
    order: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(one: str) -> None:
        order[one] = low[one] = len(order)
        stack.append(one)
        for other in sorted(arrows[one]):
            if other not in order:
                visit(other)
                low[one] = min(low[one], low[other])
            elif other in stack:
                low[one] = min(low[one], order[other])
        if low[one] == order[one]:
            at = stack.index(one)
            if len(stack) - at > 1:
                found.append(sorted(stack[at:]))
            del stack[at:]

    for one in sorted(arrows):
        if one not in order:
            visit(one)
    return found


def topic_arrows(arrows: dict[str, set[str]]) -> dict[str, dict[str, set[str]]]:
    """Arrows between what stands side by side in each folder: a file, or a sub-folder with all that it holds.

    An import from a package's face is one from the package.
    """
    found: dict[str, dict[str, set[str]]] = {}
    for one, others in arrows.items():
        for other in others:
            pairs = list(zip(one.split("."), other.split("."), strict=False))
            shared = next(n for n, (mine, theirs) in enumerate(pairs) if mine != theirs)
            folder = found.setdefault(".".join(one.split(".")[:shared]), {})
            folder.setdefault(pairs[shared][0], set()).add(pairs[shared][1])
            folder.setdefault(pairs[shared][1], set())
    return found


def arrows(*, faces: bool) -> dict[str, set[str]]:
    """Modules that each module imports, with the packages whose faces it imports from."""
    files = [path for room in ALLOWED for path in sorted((ROOT / room).rglob("*.py"))]
    modules = [path for path in files if path.name != "__init__.py"]
    known = {module_of(path) for path in (files if faces else modules)}
    return {module_of(path): imported_modules(path, known) for path in modules}


def test_no_topic_imports_itself_by_way_of_others() -> None:
    """The files and sub-folders of each folder have an order from the ground up."""
    inner = {"a.b.c": {"a.d.e"}, "a.d.f": {"a.b.g"}, "a.d.e": set[str](), "a.b.g": set[str]()}
    assert circles(topic_arrows(inner)["a"]) == [["b", "d"]]
    topics = topic_arrows(arrows(faces=True))
    assert {"gearwhine", "gearwhine.coupling.gears", "gearwhine.housing", "gearwhine.solve"} <= set(topics)
    assert {folder: circles(inner) for folder, inner in topics.items() if circles(inner)} == {}


def test_no_module_imports_itself_by_way_of_others() -> None:
    """Neither between rooms nor inside one, whether at the top of a file, in a function or for types."""
    modules = arrows(faces=False)
    assert sum(map(len, modules.values())) > 800
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == [["b", "c"]]
    assert circles(modules) == []
