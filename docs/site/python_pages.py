"""Pages of the Python reference: one for each public name of the packages, and one for each package with its names.

What a package's ``__init__`` imports or defines without an underscore is public. A name that stands in several packages
has its page where it comes from: ``gearwhine.Housing`` is ``gearwhine.housing.Housing``.
"""

import ast
import inspect
from functools import cache
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from types import ModuleType

ROOMS = ("gearwhine", "gearwhine.meshes", "gearwhine.housing", "gearwhine.rotors", "gearwhine.coupling")
"""In the order of the reference: the front door, then as the physics goes."""

_INSIDE = ("analyses", "case", "cases", "cli", "from_case", "output", "results", "solve", "sweep")
"""Packages of the front door that commands are made of; nothing in them is to be called by a user."""


def packages(root: Path) -> list[str]:
    """Every package that has public names, rooms first, each followed by the packages in it."""
    found = []
    for room in ROOMS:
        folder = root / room.replace(".", "/")
        for init in sorted(folder.rglob("__init__.py"), key=lambda path: path.parent.as_posix()):
            parts = init.parent.relative_to(root).parts
            if parts[1:2] and parts[1] in _INSIDE:
                continue
            name = ".".join(parts)
            if public_names(name):
                found.append(name)
    return found


def public_names(package: str) -> list[str]:
    """Public names of a package, sorted without regard to case."""
    module = import_module(package)
    listed = getattr(module, "__all__", None)
    names = listed if listed is not None else [name for name in vars(module) if _is_ours(module, name)]
    return sorted((name for name in names if not name.startswith("_")), key=str.casefold)


def _is_ours(module: ModuleType, name: str) -> bool:
    value = getattr(module, name)
    if name.startswith("_") or isinstance(value, ModuleType):
        return False
    # Constants do not know where they come from: those in capitals are meant.
    return value.__module__.split(".")[0] == "gearwhine" if callable(value) else name.isupper()


@cache
def origin(package: str, name: str) -> str:
    """Module that a name is defined in."""
    module = import_module(package)
    value = getattr(module, name)
    if callable(value):
        return str(value.__module__)
    lazily = getattr(module, "_HOME_OF", {}).get(name)
    if lazily is not None:
        return origin(lazily, name)
    for line in ast.parse(inspect.getsource(module)).body:
        if isinstance(line, ast.ImportFrom) and any(alias.name == name for alias in line.names):
            return origin(str(line.module), name)
    return package


def homes(names_of: dict[str, list[str]]) -> dict[tuple[str, str], str]:
    """For each package and name, the package that has its page: the innermost one around its module, else any room."""
    places: dict[tuple[str, str], list[str]] = {}
    for package, names in names_of.items():
        for name in names:
            places.setdefault((origin(package, name), name), []).append(package)
    found = {}
    for (module, name), holders in places.items():
        around = [package for package in holders if f"{module}.".startswith(f"{package}.")] or holders
        home = max(around, key=lambda package: (package != "gearwhine", len(package)))
        found.update({(package, name): home for package in holders})
    return found


def directive(package: str, name: str) -> str:
    """Return the directive of `sphinx.ext.autodoc` that documents a name."""
    value = getattr(import_module(package), name)
    if inspect.isclass(value):
        bases = "" if value.__bases__ == (object,) else "\n   :show-inheritance:"
        return f".. autoclass:: {name}\n   :members:{bases}"
    if callable(value):
        return f".. autofunction:: {name}"
    return f".. autodata:: {origin(package, name)}.{name}\n   :no-value:"


def summary(package: str, name: str) -> str:
    """First paragraph of a name's docstring, of a constant the text below it."""
    value = getattr(import_module(package), name)
    text = (inspect.getdoc(value) or "") if callable(value) else _text_below(origin(package, name), name)
    return text.split("\n\n")[0].replace("\n", " ").replace("|", "\\|")


def _text_below(module: str, name: str) -> str:
    for line, text in pairwise(ast.parse(inspect.getsource(import_module(module))).body):
        targets = line.targets if isinstance(line, ast.Assign) else [getattr(line, "target", None)]
        if any(isinstance(target, ast.Name) and target.id == name for target in targets) and isinstance(text, ast.Expr):
            return inspect.cleandoc(str(ast.literal_eval(text.value)))
    return "Constant."


def write_pages(root: Path, folder: Path) -> dict[str, list[str]]:
    """Write all pages into a folder; return for each name the packages that have its page."""
    names_of = {package: public_names(package) for package in packages(root)}
    home_of = homes(names_of)
    pages = {}
    for package, names in names_of.items():
        own = [name for name in names if home_of[package, name] == package]
        inner = [other for other in names_of if other.rpartition(".")[0] == package]
        pages[f"{package}.rst"] = _package_page(package, names, own, inner, home_of)
        for name in own:
            pages[f"{package}.{name}.rst"] = (
                f"{_title(f'{package}.{name}')}\n.. currentmodule:: {package}\n\n{directive(package, name)}\n"
            )
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.glob("*.rst"):
        if path.name not in pages:
            path.unlink()
    for file, text in pages.items():
        path = folder / file
        # An unchanged page keeps its time, so that the next build takes it from the last one.
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    pages_of: dict[str, list[str]] = {}
    for (package, name), home in home_of.items():
        if home == package:
            pages_of.setdefault(name, []).append(home)
    return pages_of


def _title(text: str) -> str:
    return f"{text}\n{'=' * len(text)}\n"


def _package_page(
    package: str, names: list[str], own: list[str], inner: list[str], home_of: dict[tuple[str, str], str]
) -> str:
    lines = [_title(package), f".. automodule:: {package}", "   :no-members:", ""]
    lines += [".. list-table::", "   :widths: 30 70", ""]
    for name in names:
        home = home_of[package, name]
        shown = name if home == package else f"{home}.{name}"
        lines += [f"   * - :doc:`{shown} <{home}.{name}>`", f"     - {summary(package, name)}"]
    lines += ["", ".. toctree::", "   :hidden:", ""]
    lines += [f"   {name} <{package}.{name}>" for name in own]
    lines += [f"   {other}" for other in inner]
    return "\n".join([*lines, ""])
