"""References in docstrings lead somewhere: a module that has moved takes its references along."""

import importlib
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
ROOMS = ("numerics", "meshes", "rotors", "housing", "coupling")
_REFERENCE = re.compile(r":(?:mod|class|func|meth|attr|data|exc):`~?([\w.\s]+)`")


def modules() -> dict[str, Path]:
    """Files of the package by the name of their module, each once."""
    own = {path: path.relative_to(ROOT) for path in (ROOT / "gearwhine").rglob("*.py")}
    files = {path: at for path, at in own.items() if at.parts[1] not in ROOMS}
    for room in ROOMS:
        files |= {path: Path("gearwhine") / path.relative_to(ROOT) for path in (ROOT / room).rglob("*.py")}
    return {".".join(at.with_suffix("").parts).removesuffix(".__init__"): path for path, at in files.items()}


def leads_somewhere(reference: str, module: str) -> bool:
    """Whether a name with dots is of the package, or of what the module itself has."""
    parts = reference.split(".")
    if parts[0] != "gearwhine":
        return has(importlib.import_module(module), parts)
    for count in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:count]))
        except ModuleNotFoundError:
            continue
        return has(found, parts[count:])
    return False


def has(owner: Any, names: list[str]) -> bool:
    for name in names:
        if not hasattr(owner, name):
            return name in getattr(owner, "__dataclass_fields__", {}) and name == names[-1]
        owner = getattr(owner, name)
    return True


def test_references_with_dots_lead_somewhere() -> None:
    lost = []
    for module, path in modules().items():
        # A reference may be broken over two lines.
        for (reference,) in (match.groups() for match in _REFERENCE.finditer(path.read_text(encoding="utf-8"))):
            name = re.sub(r"\s+", "", reference)
            if "." in name and not leads_somewhere(name, module):
                lost.append(f"{path.relative_to(ROOT)}: {name}")
    assert not lost, "\n".join(lost)


def test_a_lost_reference_is_seen() -> None:
    assert not leads_somewhere("gearwhine.coupling.machine.no_such_module", "gearwhine.coupling")
    assert not leads_somewhere("coupling.Machine", "gearwhine.coupling")
    assert leads_somewhere("gearwhine.coupling.Machine.speeds", "gearwhine.coupling")
