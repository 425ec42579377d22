"""Files that appear whole or not at all."""

import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

_STAGING = ".partial-"


@contextmanager
def staging(folder: Path) -> Iterator[Path]:
    """A folder inside the output folder whose files move out to it, one by one and whole, at the end.

    Where the work fails or is interrupted, the output folder keeps what it had. What a killed run left behind is
    cleared away first.
    """
    made = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    for stale in folder.glob(f"{_STAGING}*"):
        if stale.is_dir() and not stale.is_symlink():
            shutil.rmtree(stale, ignore_errors=True)
    place = Path(tempfile.mkdtemp(prefix=_STAGING, dir=folder))
    try:
        yield place
        # The summary moves last: where it is new, all is new.
        for path in sorted(place.rglob("*"), key=lambda path: (path.name == "summary.json", path)):
            if path.is_file():
                target = folder / path.relative_to(place)
                target.parent.mkdir(parents=True, exist_ok=True)
                os.replace(path, target)
    finally:
        shutil.rmtree(place, ignore_errors=True)
        if made and not any(folder.iterdir()):
            folder.rmdir()


def json_text(document: Mapping[str, Any]) -> str:
    """A document as JSON, refusing values that JSON has no word for."""
    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)


def finite(value: Any) -> Any:
    """The same document with infinities and NaN as null, since JSON knows neither."""
    if isinstance(value, Mapping):
        return {key: finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    if isinstance(value, float) and (value != value or value in (float("inf"), float("-inf"))):
        return None
    return value
