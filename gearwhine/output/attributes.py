"""Attributes of solved objects by name: their values, and what their docstrings say of them."""

import re
from functools import cache, cached_property
from inspect import cleandoc
from typing import Any


def value_at(solved: Any, path: str) -> Any:
    """Return an attribute of an object, such as ``load.force``, or a place in one, such as ``largest.0``.

    Parameters
    ----------
    solved : object
    path : str
        Attributes of each other, and places in tuples from 0, with points between; ``.`` is the object itself.

    Returns
    -------
    object or None
        None where one on the way is None.
    """
    if path == ".":
        return solved
    for step in path.split("."):
        if solved is None:
            return None
        solved = solved[int(step)] if step.isdecimal() else getattr(solved, step)
    return solved


def meaning_at(solved: Any, path: str) -> str:
    """Return what an attribute means by its docstring, see :func:`meaning_of`; empty for what is no attribute."""
    *before, attribute = path.split(".")
    if attribute.isdecimal() or (owner := value_at(solved, ".".join(before) or ".")) is None:
        return ""
    return meaning_of(type(owner), attribute)  # type: ignore[arg-type]


@cache
def meaning_of(kind: type, attribute: str) -> str:
    """Return the first sentence on an attribute of a class, without its unit; empty where nothing is written.

    It is that of the property's own docstring, or of the entry under ``Attributes`` in the docstring of the class that
    has the attribute.
    """
    for parent in kind.__mro__:
        member = vars(parent).get(attribute)
        described = member.__doc__ if isinstance(member, property | cached_property) else None
        if text := described or _entries(parent).get(attribute):
            return _first_sentence(text)
    return ""


@cache
def _entries(kind: type) -> dict[str, str]:
    """Return the descriptions of attributes in a class's docstring (numpydoc); of its parameters where it has none."""
    lines = iter(cleandoc(kind.__doc__ or "").splitlines())
    entries: dict[str, str] = {}
    names: list[str] = []
    for line in lines:
        if line == "Attributes":
            break
    for line in lines:
        if line and not line.startswith(" "):
            names = [name.strip() for name in line.partition(":")[0].split(",")]
        else:
            entries |= {name: f"{entries.get(name, '')} {line.strip()}".strip() for name in names}
    return entries


def _first_sentence(text: str) -> str:
    """Return a docstring's first sentence up to a semicolon, without its unit in brackets, shape and Sphinx's roles."""
    sentence = re.split(r"[.;](?=\s)", " ".join(text.split()), maxsplit=1)[0].removesuffix(".")
    sentence = re.sub(r"\s*\[[^\]]*\]|, (shape )?\(\w*,( \w+)*\)", "", sentence)
    sentence = re.sub(r":\w+:`~?(?:[\w.]*\.)?(\w+)`", r"\1", sentence).replace("`", "")
    return sentence[:1].lower() + sentence[1:]
