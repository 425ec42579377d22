"""Names that users' programs read from summaries and files: none is lost or renamed by accident.

``names_of_results.txt`` lists them, with the unit in the file where a declaration says one. A name that is to go leaves
the list and has a line in the changelog. This file as a program adds new ones.
"""

import ast
import re
from collections import Counter
from pathlib import Path
from textwrap import fill

ROOT = Path(__file__).parents[3]
LISTED = Path(__file__).with_name("names_of_results.txt")
_PLACES = {
    "Quantity": ("key", "", "name", "", "unit"),
    "in_file": ("name", "", "", "", "unit"),
    "Rows": ("key",),
    "Part": ("key",),
}
_WORD = re.compile(r"[a-z][a-z0-9_]*|[A-Z%][A-Za-z0-9/ -]{0,12}[A-Za-z0-9]|[A-Z%]")


def declared() -> Counter[str]:
    """Keys, names in the file with their units, and how often each is declared."""
    found: Counter[str] = Counter()
    for path in sorted((ROOT / "gearwhine" / "results").glob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        lists = [node.elts for node in ast.walk(tree) if isinstance(node, ast.Tuple | ast.List)]
        within = {id(call) for several in lists if any(map(_declares, several)) for call in several}
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and _declares(node):
                found.update(_of_declaration(node))
            elif isinstance(node, ast.Call) and id(node) in within:  # a function that declares
                words = [one.value for one in node.args if isinstance(one, ast.Constant) and isinstance(one.value, str)]
                found.update(filter(None, [" ".join(word for word in words if _WORD.fullmatch(word))]))
    return found


def _declares(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _PLACES


def _of_declaration(call: ast.Call) -> list[str]:
    """Key, and name with unit, of one declaration."""
    assert isinstance(call.func, ast.Name)
    given = dict(zip(_PLACES[call.func.id], call.args, strict=False))
    given |= {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg}
    said = {place: one.value for place, one in given.items() if isinstance(one, ast.Constant) and one.value}
    named = f"{said['name']} in {said['unit']}" if {"name", "unit"} <= said.keys() else said.get("name", "")
    return [word for word in (str(said.get("key", "")), str(named)) if word]


def listed() -> Counter[str]:
    """Names of the list; one that is declared in several places stands as often."""
    return Counter(LISTED.read_text(encoding="utf-8").strip().replace("\n", " ").split("; "))


def test_no_name_of_the_results_is_lost() -> None:
    assert listed() - declared() == Counter()
    assert listed().total() > 800


if __name__ == "__main__":
    words = "; ".join(sorted(declared().elements()))
    LISTED.write_text(fill(words, 120, break_long_words=False, break_on_hyphens=False) + "\n", encoding="utf-8")
