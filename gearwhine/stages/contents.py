"""Content digests: files by their content, libraries by version, own code by its text."""

import hashlib
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import ModuleType
from typing import Any


def file_contents(table: Any) -> dict[str, Any]:
    """Each file that a table names, however deep: from its name to a digest of its bytes and its ending.

    The ending counts because a file's reader is chosen by it.
    """
    return {str(path): _file_content(path) for path in _paths(table)}


def with_contents(value: Any, files: Mapping[str, Any]) -> Any:
    """The same table with each file's content in place of its name."""
    if isinstance(value, Mapping):
        return {key: with_contents(inner, files) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [with_contents(inner, files) for inner in value]
    return files.get(value, value) if isinstance(value, str) else value


def texts_in(value: Any) -> set[str]:
    """Every text in a table, however deep: the names of its materials are among them."""
    if isinstance(value, str):
        return {value}
    return set().union(*(texts_in(inner) for inner in _inner(value)))


@cache
def installed(library: str) -> str | None:
    """The version of a library; None where it is not there."""
    try:
        return version(library)
    except PackageNotFoundError:
        return None


def source_digest(*packages: ModuleType) -> str:
    """SHA-256 of the text of whole packages, which changes between releases under one version number.

    What does not bear on the result counts too: that costs a solution now and then, and forgets nothing.
    """
    return _source_digest(tuple(str(package.__file__) for package in packages))


@cache
def _source_digest(files: tuple[str, ...]) -> str:
    total = hashlib.sha256()
    for file in files:
        folder = Path(file).parent
        for path in sorted(folder.rglob("*.py")):
            total.update(f"{path.relative_to(folder.parent).as_posix()}\0".encode())
            total.update(path.read_bytes())
    return total.hexdigest()


def _paths(value: Any) -> set[Path]:
    if isinstance(value, Path):
        return {value}
    return set().union(*(_paths(inner) for inner in _inner(value)))


def _inner(value: Any) -> list[Any]:
    if isinstance(value, Mapping):
        return list(value.values())
    return list(value) if isinstance(value, list | tuple) else []


def _file_content(path: Path) -> dict[str, str]:
    with path.open("rb") as file:
        return {"sha256": hashlib.file_digest(file, "sha256").hexdigest(), "ending": path.suffix.lower()}
