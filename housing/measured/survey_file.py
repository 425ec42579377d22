"""Survey files: universal files and CSV tables, chosen by their ending."""

from pathlib import Path

from housing.errors import MeasuredDataError
from housing.measured.survey_data import SurveyData
from housing.measured.tables import read_table, write_table
from housing.measured.universal_reading import Frame, read_universal
from housing.measured.universal_writing import write_universal

UNIVERSAL = (".uff", ".unv", ".uf", ".bunv")
TABLES = (".csv", ".tsv", ".txt")


def read_survey(path: str | Path, *, unit: str | None = None, shape_frame: Frame = "local") -> SurveyData:
    """Read a universal file or a table; see :func:`read_universal` and :func:`read_table`.

    Raises
    ------
    MeasuredDataError
        Where the ending is of neither kind, or the file cannot be used.
    """
    path = Path(path)
    if path.suffix.lower() in UNIVERSAL:
        return read_universal(path, unit=unit, shape_frame=shape_frame)
    if path.suffix.lower() in TABLES:
        return read_table(path, unit=unit)
    raise MeasuredDataError(
        f"{path.name}: expected a universal file ({', '.join(UNIVERSAL)}) or a table ({', '.join(TABLES)})"
    )


def write_survey(path: str | Path, survey: SurveyData) -> None:
    """Write a universal file or a table, whole or not at all; see :func:`write_universal` and :func:`write_table`."""
    path = Path(path)
    if path.suffix.lower() in UNIVERSAL:
        write_universal(path, survey)
    elif path.suffix.lower() in TABLES:
        write_table(path, survey)
    else:
        raise MeasuredDataError(f"{path.name}: expected an ending {', '.join(UNIVERSAL + TABLES)}")
