"""Manifest of a results folder: the files that runs wrote there, each with the SHA-256 of its bytes.

It is the hidden file ``.gearwhine.json`` of the output folder, which lists the files of its sub-folders too. A run's
files move to their places under the folder's lock, the manifest last (:mod:`gearwhine.output.files`).

A file *is ours* where the manifest lists it (:func:`listed_digests`), whatever became of it since; it *is as it was
written* where its bytes have the listed digest (:func:`is_as_written`), so that one that a user has edited is not.
Folders of versions without manifests have none: there the summary of each command lists its files under ``files``
(:func:`gearwhine.output.files.listed_files`). Points of sweeps, in ``points``, are not listed: each file ends with a
checksum of its own, as ``modes.nc`` does; :func:`gearwhine.housing.storage.atomic_file.checksum_holds` is None for a
foreign one.
"""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.failures import DamagedResultsError
from gearwhine.housing.storage.netcdf import content_key

if TYPE_CHECKING:
    import xarray as xr

MANIFEST = ".gearwhine.json"
_FORMAT = "files of gearwhine results"


def file_digest(path: Path) -> str:
    """SHA-256 of a file's bytes, as hexadecimal digits.

    Raises
    ------
    OSError
        Where the file cannot be read.
    """
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def listed_digests(folder: Path) -> dict[str, str]:
    """Return the digest of each file that a manifest lists, by its name relative to the folder; none without one.

    Raises
    ------
    DamagedResultsError
        Where the manifest cannot be read, or is not as it was written.
    """
    path = folder / MANIFEST
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, RecursionError) as error:
        raise DamagedResultsError(f"{path} is damaged: {error}") from error
    files = document.get("files") if isinstance(document, Mapping) else None
    if not isinstance(files, Mapping) or document != _document(files):
        raise DamagedResultsError(f"{path} is damaged: its content does not have its digest")
    return {str(name): str(digest) for name, digest in files.items()}


def manifest_text(files: Mapping[str, str]) -> str:
    """Return a manifest's text from the digests of files by their names."""
    return json.dumps(_document(files), ensure_ascii=False, indent=1, sort_keys=True) + "\n"


def _document(files: Mapping[str, Any]) -> dict[str, Any]:
    return {"format": _FORMAT, "files": dict(files), "digest": content_key(files)}


def is_as_written(folder: Path, name: str, digests: Mapping[str, str]) -> bool:
    """Whether a file has the digest that is listed for it; False where none is listed, or the file cannot be read."""
    try:
        return name in digests and file_digest(folder / name) == digests[name]
    except OSError:
        return False


def require_as_written(folder: Path, are_read: Callable[[str], bool] = lambda name: True) -> list[str]:
    """Check files of a folder against its manifest.

    Parameters
    ----------
    folder : path
    are_read : callable
        Whether the caller reads the file of a name, relative to the folder.

    Returns
    -------
    list of str
        Sentences on read files that are missing, and on others that are not as they were written.

    Raises
    ------
    DamagedResultsError
        Where a file that is read is not as it was written: the message names each.
    """
    digests = listed_digests(folder)
    there = [name for name in sorted(digests) if (folder / name).exists()]
    changed = [name for name in there if not is_as_written(folder, name, digests)]
    if damaged := [str(folder / name) for name in changed if are_read(name)]:
        are, them = ("is", "it") if len(damaged) == 1 else ("are", "them")
        raise DamagedResultsError(
            f"{', '.join(damaged)} {are} damaged, or changed since gearwhine wrote {them}: the bytes do not have the "
            f"digest in {folder / MANIFEST}; run the command anew"
        )
    missing = [f"{folder / name} is missing" for name in sorted(set(digests) - set(there)) if are_read(name)]
    return missing + [f"{folder / name} is damaged, or changed since gearwhine wrote it" for name in changed]


@contextmanager
def opened_dataset(path: Path) -> Iterator["xr.Dataset"]:
    """Open a NetCDF file of results, read as its arrays are asked for.

    Raises
    ------
    DamagedResultsError
        Where the file is damaged, or of another kind, as far as its reader notices.
    """
    import xarray as xr

    from gearwhine.output.stored_dataset import StoredResults

    try:
        data = xr.open_dataset(path, engine=StoredResults)
    except Exception as error:  # readers raise exceptions of many kinds on a damaged file
        raise DamagedResultsError(f"{path} is no NetCDF4 file, or a damaged one: {error}") from error
    with data:
        try:
            yield data
        except OSError as error:
            if error.errno is not None:  # of another file
                raise
            raise DamagedResultsError(f"{path} is damaged: {error}") from error
