"""Input files of a case, each read once: their contents as digests, and what readers have made of them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationInfo

Made = TypeVar("Made")


class ChangedFileError(ValueError):
    """An input file is not the one any more that the case was read with."""

    def __init__(self) -> None:
        super().__init__(
            "the file as it was when the case was read; it has changed since or is gone: read the case again"
        )


@dataclass(frozen=True)
class InputFiles:
    """Input files as they were when a case first named them; a case that is changed from another one takes them over.

    Attributes
    ----------
    contents : dict
        Content of each file by its path, see :func:`file_contents`.
    """

    contents: dict[str, Any] = field(default_factory=dict)
    _made: dict[tuple[object, ...], Any] = field(default_factory=dict, compare=False, repr=False)

    def add(self, path: Path) -> None:
        """Take a file's content, unless it is known already.

        Raises
        ------
        OSError
            Where the file cannot be read.
        """
        if str(path) not in self.contents:
            self.contents.update(file_contents([path]))

    def among(self, paths: Iterable[Path]) -> InputFiles:
        """Return these files; the content of those that are not known is taken now."""
        chosen = InputFiles(_made=self._made)
        for path in sorted(paths):
            known = self.contents.get(str(path))
            chosen.contents.update(file_contents([path]) if known is None else {str(path): known})
        return chosen

    def copy(self) -> InputFiles:
        """Return the same files, to which others can be added apart from these."""
        return InputFiles(dict(self.contents), self._made)

    @contextmanager
    def unchanged(self, path: Path) -> Iterator[None]:
        """Hold a file to its content while it is read.

        Raises
        ------
        ChangedFileError
            Where it has changed before the reading or during it, or is gone.
        """
        self._require(path)
        yield
        self._require(path)

    def read(self, path: Path | tuple[Path, ...], reader: Callable[..., Made], **options: object) -> Made:
        """Return what a reader makes of a file, or of several together, which it reads once for the same options.

        Raises
        ------
        ChangedFileError
            As :meth:`unchanged`.
        """
        paths = path if isinstance(path, tuple) else (path,)
        for one in paths:
            self.add(one)
        # By their content: a case that was changed to another file of this name has its own.
        contents = [repr(self.contents[str(one)]) for one in paths]
        key = (*map(str, paths), *contents, reader.__qualname__, *sorted(options.items()))
        if key not in self._made:
            with ExitStack() as held:
                for one in paths:
                    held.enter_context(self.unchanged(one))
                made = reader(path, **options)
            self._made[key] = made
        kept: Made = self._made[key]
        return kept

    def _require(self, path: Path) -> None:
        try:
            unchanged = file_contents([path])[str(path)] == self.contents[str(path)]
        except OSError:
            unchanged = False
        if not unchanged:
            raise ChangedFileError


def files_of(info: ValidationInfo) -> InputFiles:
    """Return the files that a validation takes its input from: those of its context, else none that are known."""
    known = (info.context or {}).get("files")
    return known if isinstance(known, InputFiles) else InputFiles()


def file_contents(table: Any) -> dict[str, Any]:
    """Return a digest of the bytes, and the ending, of each file that a table names, however deep.

    The ending counts because a file's reader is chosen by it. A mesh file has the digests of its companions, too, the
    files that are read with it.
    """
    return {str(path): _file_content(path) for path in sorted(paths_in(table))}


_WITHOUT_PATHS = frozenset((float, str, int, bool, type(None)))


def paths_in(value: Any) -> set[Path]:
    """Return every path in a table, however deep."""
    found, left = set[Path](), [value]
    while left:
        one = left.pop()
        if isinstance(one, Path):
            found.add(one)
            continue
        if isinstance(one, BaseModel):
            inner: Iterable[Any] = one.__dict__.values()
        elif isinstance(one, list | tuple):
            inner = one
        else:
            inner = one.values() if isinstance(one, Mapping) else ()
        left += [entry for entry in inner if type(entry) not in _WITHOUT_PATHS]
    return found


def _file_content(path: Path) -> dict[str, Any]:
    # Imported here: commands without files need no meshes.
    from gearwhine.meshes.formats.companions import companion_files

    content: dict[str, Any] = {"sha256": _file_digest(path), "ending": path.suffix.lower()}
    if companions := [_file_digest(companion) for companion in companion_files(path)]:
        content["companions"] = companions
    return content


def _file_digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
