"""Measured modes of a case, `[measured]`, and model updating by them, `[update]`.

Measured are frequencies alone, or a modal survey with its alignment on the model. An update has the parameters that
are fitted, and the modes that they are fitted to.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import (
    Field,
    PrivateAttr,
    StrictBool,
    Tag,
    ValidationInfo,
    model_validator,
)

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
    Rule,
    Table,
    Whole,
    by_list,
    by_table,
    wrong,
)
from gearwhine.case.input_files import ChangedFileError, InputFiles, files_of
from gearwhine.case.overrides import parse_key_path

if TYPE_CHECKING:
    from gearwhine.housing.measured import SurveyData


@dataclass(frozen=True)
class _Content:
    """Content of the files at the time of reading; two cases are equal where their bytes are equal."""

    digests: tuple[str, ...]
    survey: SurveyData = field(compare=False)


class Landmark(Table):
    """`[[measured.align.landmarks]]`: a point of the survey, by its label, and where it is on the model [m]."""

    point: Name
    """Label of the point in the survey."""
    position: Point
    """Its position on the model."""


class Align(Table):
    """`[measured.align]`: the survey's frame in the model's, by three or more points."""

    landmarks: tuple[Landmark, ...] = Field(min_length=3, max_length=MOST_ENTRIES)
    """Three points or more whose places on the model are known."""

    @model_validator(mode="after")
    def _each_once(self) -> Align:
        for index, landmark in enumerate(self.landmarks):
            if landmark.point in [other.point for other in self.landmarks[:index]]:
                raise wrong("a point that is not among the landmarks before it", "landmarks", index, "point")
        return self


class Pairing(Table):
    """`[measured.pairing]`: pairing by shapes, with conditions for a pair of a measured shape and a model's.

    See `gearwhine.housing.correlation.pairing.PairingRule`.
    """

    least_mac: Annotated[float, Quantity(units.RATIO, above=0.0, at_most=1.0)] = 0.5
    """MAC below which a measured mode stays alone."""
    frequency_spread: Annotated[float, Quantity(units.RATIO, above=0.0)] = 0.2
    """Relative spread of frequency; pairs are made within twice that."""
    closeness: Annotated[float, Quantity(units.RATIO, at_least=0.0, below=1.0)] = 0.01
    """Relative distance within which neighbours are close modes."""
    duplicate_mac: Annotated[float, Quantity(units.RATIO, above=0.0, at_most=1.0)] = 0.9
    """MAC from which on two measured modes may be one."""


FileOrFiles = Annotated[
    Annotated[CaseFile, Tag("~file")]
    | Annotated[tuple[CaseFile, ...], Field(min_length=1, max_length=MOST_ENTRIES), Tag("~list")],
    by_list("~file"),
]
"""A file, or several of one survey."""

FlagOrAlign = Annotated[Annotated[StrictBool, Tag("~flag")] | Annotated[Align, Tag("~table")], by_table("~flag")]
"""Whether to align, or by what."""

WordOrPairing = Annotated[
    Annotated[Literal["order", "nearest", "dominance", "shapes"], Tag("~word")] | Annotated[Pairing, Tag("~table")],
    by_table("~word"),
]
"""How modes are paired, or the conditions of a pair of shapes."""

_OF_A_FILE = ("unit", "shape_frame", "align", "tolerance")
"""Keys that say how a file is read and laid on the model."""


class Measured(Table):
    """`[measured]`: frequencies of measured modes [Hz], ascending, and their damping ratios; or a `file` of them.

    The file is a universal file or a table, see `gearwhine.housing.measured`.
    """

    frequencies: tuple[PositiveFrequency, ...] | None = Field(default=None, min_length=1, max_length=MOST_ENTRIES)
    """Frequencies of the measured modes, ascending. One of this and `file`."""
    damping_ratios: tuple[DampingRatio, ...] | None = Field(default=None, max_length=MOST_ENTRIES)
    """Damping ratio of each measured mode."""
    file: FileOrFiles | None = None
    """Survey: a universal file (`.uff`, `.unv`), a list of those that hold its points, shapes and responses apart, or a
    table (`.csv`), relative to the case file. One of this and `frequencies`."""
    unit: Literal["m", "mm", "cm", "in"] | None = None
    """Unit of the file's lengths, in place of the stated one. Default: the stated one, else m."""
    shape_frame: Literal["local", "global"] | None = None
    """Frame in which shapes stand at points with a displacement system of their own. Default: "local" of data set 55,
    as programs for modal tests write it, "global" of 2414."""
    align: FlagOrAlign = False
    """true: bring the survey on to the model's surface; or landmarks; false: it stands in the model's frame."""
    tolerance: PositiveLength | None = None
    """Distance from the surface beyond which points are named in a warning. Default: 2 % of the housing's diagonal."""
    pairing: WordOrPairing | None = None
    """How measured modes are paired with the model's: "shapes", by the assignment of greatest MAC; "nearest", in order
    of frequency with the least sum of squared logarithmic errors, some modes of the model left out; "order", the first
    with the first; "dominance", in order of frequency with the modes that are strongest between bearing seats and skin.
    A table has the conditions of "shapes". Default: "shapes" where shapes are measured, else "nearest"."""

    _content: _Content | None = PrivateAttr(default=None)

    @property
    def frequencies_hz(self) -> tuple[float, ...]:
        """Frequencies of the measured modes, ascending [Hz]; none where they are yet to be identified."""
        modes = None if self.survey is None else self.survey.modes
        if self.frequencies is not None or modes is None:
            return self.frequencies or ()
        return tuple(sorted((modes.frequencies / (2.0 * math.pi)).tolist()))

    @model_validator(mode="after")
    def _one_source(self, info: ValidationInfo) -> Measured:
        if (self.frequencies is None) == (self.file is None):
            raise wrong("either 'frequencies' or a 'file' of measured modes", "frequencies")
        if self.file is None:
            for key in _OF_A_FILE:
                # A resolved case states its defaults.
                if getattr(self, key) != type(self).model_fields[key].default:
                    raise wrong("no such key without a file, whose survey it is about", key)
            return self._ascending()._with_a_pairing()
        if self.damping_ratios is not None:
            raise wrong("no damping ratios beside a file, which holds its own", "damping_ratios")
        return self._read(self.file, files_of(info))._with_a_pairing()

    def _with_a_pairing(self) -> Measured:
        # The defaults as a table are what older resolved cases state of frequencies alone.
        by_shapes = self.pairing == "shapes" or (isinstance(self.pairing, Pairing) and self.pairing != Pairing())
        if by_shapes and not self.has_shapes:
            raise wrong(
                "'nearest', 'order' or 'dominance': no shapes are measured, by which modes are paired", "pairing"
            )
        return self

    def _ascending(self) -> Measured:
        frequencies = self.frequencies or ()
        for index in range(1, len(frequencies)):
            if frequencies[index] <= frequencies[index - 1]:
                raise wrong("a frequency above the one before it", "frequencies", index)
        if self.damping_ratios is not None and len(self.damping_ratios) != len(frequencies):
            raise wrong(f"a ratio for each of the {len(frequencies)} frequencies", "damping_ratios")
        return self

    def _read(self, file: Path | tuple[Path, ...], files: InputFiles) -> Measured:
        from gearwhine.housing import HousingError
        from gearwhine.housing.measured import read_survey

        try:
            survey = files.read(file, read_survey, unit=self.unit, shape_frame=self.shape_frame)
        except HousingError as error:
            raise wrong(f"a file of measured modes; {error}", "file") from None
        except ChangedFileError as error:
            raise wrong(str(error), "file") from None
        if survey.modes is None and survey.responses is None:
            raise wrong("a file of measured modes or responses; this one holds points alone", "file")
        if survey.geometry is None and self.align:
            raise wrong("no alignment: the file holds frequencies and no points", "align")
        paths = file if isinstance(file, tuple) else (file,)
        self._content = _Content(tuple(files.contents[str(path)]["sha256"] for path in paths), survey)
        return self

    @property
    def file_names(self) -> str:
        """Paths of the files, in a line."""
        return " and ".join(map(str, self.file)) if isinstance(self.file, tuple) else str(self.file)

    @property
    def survey(self) -> SurveyData | None:
        """Content of the file, in SI; None where the modes are listed in the case."""
        return None if self._content is None else self._content.survey

    @property
    def has_shapes(self) -> bool:
        """Whether shapes are measured, or responses from which they are found."""
        survey = self.survey
        return survey is not None and (survey.modes is None or survey.modes.shapes is not None)

    @property
    def paired_by(self) -> Literal["order", "nearest", "dominance", "shapes"]:
        """How measured modes are paired with the model's."""
        if isinstance(self.pairing, str):
            return self.pairing
        return "shapes" if self.has_shapes else "nearest"


class _AmountRule(Rule):
    """Validates a quantity of any kind, left as it is written: text with a unit, or a plain number in SI."""

    def validate(self, value: object) -> str | float:
        if units.si_amount(value) is None:
            raise wrong("a quantity such as '12 mm', or a plain number in SI")
        assert isinstance(value, (str, int, float))
        return value if isinstance(value, str) else float(value)


class _KeyRule(Rule):
    """Validates a key path."""

    def validate(self, value: object) -> str:
        if not isinstance(value, str) or parse_key_path(value) is None:
            raise wrong("a key path of this case, such as 'housing.box.wall.top' ('*' stands for any entry)")
        return value


Amount = Annotated[str | float, _AmountRule()]
KeyPath = Annotated[str, _KeyRule()]


class UpdateParameter(Table):
    """`[[update.parameter]]`: a number that is fitted, at one key path or several that take the same value."""

    name: Name
    """Name of the parameter."""
    keys: tuple[KeyPath, ...] = Field(min_length=1, max_length=1000)
    """Key paths that take the value, `*` for any entry; without `factor` they have one value in the case already."""
    range: tuple[Amount, Amount]
    """Two quantities that it stays between."""
    nominal: Amount | None = None
    """Mean of the prior. Default: the case's own value, 1 of a factor."""
    spread: Amount | None = None
    """Standard deviation of the prior. Default: a third of the larger distance from `nominal` to an end of the
    range."""
    factor: StrictBool = False
    """The keys' own numbers are multiplied by the parameter."""

    @model_validator(mode="after")
    def _of_one_kind(self) -> UpdateParameter:
        entries = [
            ("range", self.range[0]),
            ("range", self.range[1]),
            ("nominal", self.nominal),
            ("spread", self.spread),
        ]
        if len({units.kind_of(value) for _, value in entries if value is not None}) > 1:
            raise wrong("range, nominal and spread that measure the same", "range")
        low, high = self.bounds
        if not low < high:
            raise wrong("a range that ascends", "range")
        if self.nominal is not None and not low <= units.amount(self.nominal) <= high:
            raise wrong("a nominal value within the range", "nominal")
        if self.spread is not None and units.amount(self.spread) <= 0.0:
            raise wrong("a spread above 0", "spread")
        if self.factor and low <= 0.0:
            raise wrong("factors above 0", "range")
        return self

    @property
    def bounds(self) -> tuple[float, float]:
        """The range in SI."""
        return units.amount(self.range[0]), units.amount(self.range[1])

    @property
    def unit(self) -> str:
        """Unit in which it is written; empty for plain numbers."""
        parts = units.split_quantity(self.range[0]) if isinstance(self.range[0], str) else None
        return parts[1] if parts is not None else ""


class ModelModes(Table):
    """Number of model modes below a frequency [Hz]: from `least` to `most`."""

    below: PositiveFrequency
    """Frequency below which modes are counted."""
    least: Annotated[int, Whole(0, MOST_ENTRIES)]
    """Least number."""
    most: Annotated[int, Whole(0, MOST_ENTRIES)]
    """Largest number."""

    @model_validator(mode="after")
    def _ascends(self) -> ModelModes:
        if self.most < self.least:
            raise wrong(f"at least the {self.least} of 'least'", "most")
        return self


class Update(Table):
    """`[update]`: the parameters, how well frequencies were measured, and what else the model has to meet."""

    parameter: tuple[UpdateParameter, ...] = Field(min_length=1, max_length=200)
    """Parameters that are fitted, `[[update.parameter]]`."""
    frequency_noise: Annotated[float, Quantity(units.RATIO, above=0.0, below=1.0)] = 0.005
    """Relative standard deviation of a measured frequency, model error included."""
    shape_noise: Annotated[float, Quantity(units.RATIO, above=0.0, below=1.0)] = 0.05
    """Standard deviation of each motion of a measured shape, as a part of the shape's root mean square; with shapes
    modes are paired by MAC and `gap` is not used."""
    mesh_size: PositiveLength | None = None
    """Element size of the search, coarser than the housing's own: its bias is learned and taken off, and the own mesh
    judges. Default: that of the housing."""
    gap: Annotated[float, Quantity(units.RATIO, at_least=0.0)] = 0.15
    """Least gap of dominance, ln(strength of the last chosen mode / of the first left out)."""
    model_modes: ModelModes | None = None
    """Number of modes that the model must have, the rigid ones of a free housing counted."""
    modes: Annotated[int, Whole(2, 1000)] = 48
    """Number of modes that each design is solved for, the rigid ones of a free housing counted: about twice those up to
    the band's end."""
    solves: Annotated[int, Whole(1, 10_000)] = 40
    """Largest number of designs solved on the search's mesh, shared by all starts; the own mesh takes some more."""
    explore: Annotated[int, Whole(0, 10_000)] = 0
    """Number of starts beside the case's own, drawn from the prior and improved on its surrogate: three rounds, after
    each the better half continues."""
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 1
    """Seed of the random starts; another may end in another basin."""

    @model_validator(mode="after")
    def _named_once(self) -> Update:
        names = [parameter.name for parameter in self.parameter]
        for index, name in enumerate(names):
            if name in names[:index]:
                raise wrong("a name of its own for each parameter", "parameter", index, "name")
        return self
