"""Mode file: a solved housing as labelled NetCDF4, written whole and read back with its proof.

The file opens in xarray, ncdump and every other reader of NetCDF4 or HDF5. It holds the mesh, the modes with their
certificate, the motions of bearing seats and sensors, the inputs of the solution, and a digest.

The certificate was made with the stiffness and mass matrices at hand. The digest (SHA-256 over every array, label and
attribute) proves on reading that the content is, bit for bit, that of the certified set. It detects damage; it is no
signature against forgery.
"""

from pathlib import Path
from typing import Any

from housing.atomic_file import atomic_file
from housing.errors import HousingError, ModeFileError
from housing.labelled import LabelledArray, digest
from housing.mode_record import ModeRecord, record_arrays, record_attributes, record_of
from housing.netcdf import read_netcdf, write_netcdf
from housing.seals import checksum_holds, write_checksum

FORMAT = "gearwhine mode set"
SCHEMA = "1"


def write_modes(path: str | Path, record: ModeRecord) -> None:
    """Write a mode set; the file appears whole or not at all.

    Raises
    ------
    HousingError
        Where an array of the record does not fit its labels.
    OSError
        Where the file cannot be written.
    """
    path = Path(path)
    arrays = record_arrays(record)
    attributes = {
        "title": "Natural modes of a gearbox housing",
        "format": FORMAT,
        "schema": SCHEMA,
        **record_attributes(record),
    }
    attributes["digest"] = digest(arrays, attributes)
    variables = {
        name: (array.dimensions, array.values, {"units": array.units, "long_name": array.long_name, **array.attributes})
        for name, array in arrays.items()
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_file(path) as staged:
        try:
            # Without a fill value no number is taken for a missing one.
            write_netcdf(staged, variables, attributes, fill=False)
            write_checksum(staged)
        except ValueError as error:
            raise HousingError(f"the arrays of a mode set do not fit each other: {error}") from error


def read_modes(path: str | Path) -> ModeRecord:
    """Read a mode set, and check it against its digest.

    Raises
    ------
    ModeFileError
        Where the file is missing, damaged, of another kind or schema, or its certificate is not complete.
    """
    path = Path(path)
    arrays, attributes = _open(path)
    try:
        record = record_of(arrays, attributes)
    except (KeyError, ValueError, TypeError, IndexError) as error:
        raise ModeFileError(f"mode file {path} lacks a part or holds a wrong one: {error}") from error
    if not record.modes.certificate.complete:
        raise ModeFileError(f"mode file {path} holds modes whose certificate is not complete; solve them again")
    return record


def _open(path: Path) -> tuple[dict[str, LabelledArray], dict[str, Any]]:
    """The arrays and attributes of a file, once its kind, schema and digest are found right."""
    import h5py

    if not path.is_file():
        raise ModeFileError(f"mode file {path}: no such file")
    try:
        # Copies by other programs have no seal; the digest is theirs too.
        if checksum_holds(path) is False:
            raise ModeFileError(f"mode file {path} is damaged: its bytes do not have the digest at its end")
        # Opened by HDF5 alone first: on a truncated file it fails silently, and the layers above it print errors.
        with h5py.File(path, "r") as file:
            kind, schema = file.attrs.get("format"), file.attrs.get("schema")
        if kind != FORMAT:
            raise ModeFileError(f"{path} holds something else than a mode set of gearwhine")
        if schema != SCHEMA:
            raise ModeFileError(f"mode file {path} has schema {schema}; this version reads schema {SCHEMA}")
        # Undecoded: bytes as they stand, no unit of time turned into dates.
        arrays, attributes = read_netcdf(path)
        claimed = attributes.pop("digest", None)
        whole = digest(arrays, attributes) == claimed
    except ModeFileError:
        raise
    except Exception as error:  # readers raise exceptions of many kinds on a damaged file
        raise ModeFileError(f"mode file {path} is no NetCDF4 file, or a damaged one: {error}") from error
    if not whole:
        raise ModeFileError(f"mode file {path} is damaged or was changed: its content does not have its digest")
    return arrays, attributes
