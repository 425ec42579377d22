"""Digest of this program's code, and versions of libraries: what stored numbers depend on beside their inputs."""

import hashlib
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path


@cache
def installed(library: str) -> str | None:
    """Return the version of a library; None where it is not installed."""
    try:
        return version(library)
    except PackageNotFoundError:
        return None


@cache
def source_digest(*names: str, without: tuple[str, ...] = ()) -> str:
    """SHA-256 of the text of packages and modules, which changes between releases under one version number.

    Code in them that does not affect the result counts too: that costs an unneeded solution at times, but misses none.

    Parameters
    ----------
    *names : str
        Dotted names of packages, with all that they hold, and of modules.
    without : tuple of str
        Dotted names of packages and modules that are left out.
    """
    total = hashlib.sha256()
    left_out = {file for name in without for _, file in _source_files(name)}
    for name in names:
        for place, file in _source_files(name):
            if file not in left_out:
                total.update(f"{place}\0".encode())
                total.update(file.read_bytes())
    return total.hexdigest()


def _source_files(name: str) -> list[tuple[str, Path]]:
    """Return the files of a package or a module, each with its place in the tree."""
    spec = find_spec(name)
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(f"no package or module {name!r}")
    file = Path(spec.origin)
    top = file.parents[name.count(".") + (file.name == "__init__.py")]
    files = sorted(file.parent.rglob("*.py")) if file.name == "__init__.py" else [file]
    return [(path.relative_to(top).as_posix(), path) for path in files]
