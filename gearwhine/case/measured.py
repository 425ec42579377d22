"""Measured modes of a case, `[measured]`: frequencies, or a modal survey and its alignment with the model."""

from __future__ import annotations

from dataclasses import dataclass, field
from hashlib import sha256
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Discriminator, Field, PrivateAttr, StrictBool, Tag, model_validator

from gearwhine.case import units
from gearwhine.case.fields import (
    MOST_ENTRIES,
    CaseFile,
    DampingRatio,
    Name,
    Point,
    PositiveFrequency,
    PositiveLength,
    Quantity,
    Table,
    wrong,
)

if TYPE_CHECKING:
    from housing.measured import SurveyData


@dataclass(frozen=True)
class _Content:
    """Content of a file when it was read: two cases are equal where its bytes are."""

    digest: str
    survey: SurveyData = field(compare=False)


class Landmark(Table):
    """`[[measured.align.landmarks]]`: a point of the survey, by its label, and where it is on the model [m]."""

    point: Name
    position: Point


class Align(Table):
    """`[measured.align]`: the survey's frame in the model's, by three or more points."""

    landmarks: tuple[Landmark, ...] = Field(min_length=3, max_length=MOST_ENTRIES)

    @model_validator(mode="after")
    def _each_once(self) -> Align:
        for index, landmark in enumerate(self.landmarks):
            if landmark.point in [other.point for other in self.landmarks[:index]]:
                raise wrong("a point that is not among the landmarks before it", "landmarks", index, "point")
        return self


class Pairing(Table):
    """`[measured.pairing]`: what makes a pair of a measured shape and a model's; see `housing.PairingRule`.

    `least_mac` is the MAC below which a measured mode stays alone, `frequency_spread` the relative spread of frequency
    that a pair may well have, `closeness` within which neighbours are close modes, and `duplicate_mac` from which on
    two measured modes may be one.
    """

    least_mac: Annotated[float, Quantity(units.RATIO, above=0.0, at_most=1.0)] = 0.5
    frequency_spread: Annotated[float, Quantity(units.RATIO, above=0.0)] = 0.2
    closeness: Annotated[float, Quantity(units.RATIO, at_least=0.0, below=1.0)] = 0.01
    duplicate_mac: Annotated[float, Quantity(units.RATIO, above=0.0, at_most=1.0)] = 0.9


def _table_or_flag(value: Any) -> str:
    return "~table" if isinstance(value, (dict, Table)) else "~flag"


FlagOrAlign = Annotated[
    Annotated[StrictBool, Tag("~flag")] | Annotated[Align, Tag("~table")], Discriminator(_table_or_flag)
]
"""Whether to align, or by what."""

_OF_A_FILE = ("unit", "shape_frame", "align", "tolerance", "pairing")
"""Keys that say how a file is read and laid on the model."""


class Measured(Table):
    """`[measured]`: frequencies of measured modes [Hz], ascending, and their damping ratios; or a `file` of them.

    The file is a universal file or a table, see `housing.measured`; `unit` is that of its lengths where it states none
    or a wrong one, `shape_frame` that of its shapes. With `align` the survey is brought on to the model, by the
    surface (true) or by landmarks; else it stands in the model's frame. Points farther from the surface than the
    `tolerance` [m] are named (None: 2 % of the housing's diagonal). `pairing` says what makes a pair of shapes.
    """

    frequencies: tuple[PositiveFrequency, ...] | None = Field(default=None, min_length=1, max_length=MOST_ENTRIES)
    damping_ratios: tuple[DampingRatio, ...] | None = Field(default=None, max_length=MOST_ENTRIES)
    file: CaseFile | None = None
    unit: Literal["m", "mm", "cm", "in"] | None = None
    shape_frame: Literal["local", "global"] = "local"
    align: FlagOrAlign = False
    tolerance: PositiveLength | None = None
    pairing: Pairing = Pairing()

    _content: _Content | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _one_source(self) -> Measured:
        if (self.frequencies is None) == (self.file is None):
            raise wrong("either 'frequencies' or a 'file' of measured modes", "frequencies")
        if self.file is None:
            for key in _OF_A_FILE:
                # A resolved case states its defaults.
                if getattr(self, key) != type(self).model_fields[key].default:
                    raise wrong("no such key without a file, whose survey it is about", key)
            return self._ascending()
        if self.damping_ratios is not None:
            raise wrong("no damping ratios beside a file, which holds its own", "damping_ratios")
        return self._read()

    def _ascending(self) -> Measured:
        given = self.frequencies or ()
        for index in range(1, len(given)):
            if given[index] <= given[index - 1]:
                raise wrong("a frequency above the one before it", "frequencies", index)
        if self.damping_ratios is not None and len(self.damping_ratios) != len(given):
            raise wrong(f"a ratio for each of the {len(given)} frequencies", "damping_ratios")
        return self

    def _read(self) -> Measured:
        from housing import HousingError
        from housing.measured import read_survey

        assert self.file is not None
        try:
            survey = read_survey(self.file, unit=self.unit, shape_frame=self.shape_frame)
        except HousingError as error:
            raise wrong(f"a file of measured modes; {error}", "file") from None
        if survey.modes is None and survey.responses is None:
            raise wrong("a file of measured modes or responses; this one holds points alone", "file")
        if survey.geometry is None and self.align:
            raise wrong("no alignment: the file holds frequencies and no points", "align")
        self._content = _Content(sha256(self.file.read_bytes()).hexdigest(), survey)
        return self

    @property
    def survey(self) -> SurveyData | None:
        """Content of the file, in SI; None where the modes are listed in the case."""
        return None if self._content is None else self._content.survey
