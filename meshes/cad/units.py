"""Unit of length of a CAD file: stated by the file, given by the user, and checked against the part's size."""

import re
from dataclasses import dataclass
from pathlib import Path

from meshes.errors import GeometryError
from meshes.lengths import LARGEST, SMALLEST, UNITS, length_text, plausible

_PREFIXES = {"$": 1.0, "MILLI": 1e-3, "CENTI": 1e-2, "DECI": 0.1, "MICRO": 1e-6, "KILO": 1e3, "NANO": 1e-9}
_CONVERTED = {"INCH": 0.0254, "INCHES": 0.0254, "IN": 0.0254, "FOOT": 0.3048, "FEET": 0.3048, "FT": 0.3048}
_CONVERTED |= {"MILLIMETRE": 1e-3, "MILLIMETER": 1e-3, "MM": 1e-3, "METRE": 1.0, "METER": 1.0, "M": 1.0}
# The unit flags of IGES 5.3, section 2.2.4.3.14; flag 3 gives a name instead.
_IGES_FLAGS = {1: 0.0254, 2: 1e-3, 4: 0.3048, 5: 1609.344, 6: 1.0, 7: 1e3, 8: 2.54e-5, 9: 1e-6, 10: 1e-2, 11: 2.54e-8}


@dataclass(frozen=True)
class ChosenUnit:
    """The unit in which a file's numbers are read [m], and a remark on the choice for the user."""

    length: float
    remarks: tuple[str, ...] = ()


def stated_unit(path: Path, kind: str) -> float | None:
    """The unit of length that a STEP or IGES file itself states [m]; None where it states none, or several."""
    if kind == "brep":
        return None
    text = path.read_text(encoding="latin-1")
    return _step_unit(text) if kind == "step" else _iges_unit(text)


def _step_unit(text: str) -> float | None:
    """The length unit that the file's geometry is measured in, if there is but one.

    An inch is itself defined by way of a millimetre, so that converted units, where there are any, decide.
    """
    plain: set[float] = set()
    converted: set[float] = set()
    for found in re.finditer(r"LENGTH_UNIT\s*\(\s*\)", text):
        entity = text[text.rfind(";", 0, found.start()) + 1 : text.find(";", found.end())]
        by_name = re.search(r"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'", entity)
        by_prefix = re.search(r"SI_UNIT\s*\(\s*(\$|\.\w+\.)\s*,\s*\.METRE\.", entity)
        if by_name is not None:
            converted.add(_CONVERTED.get(by_name[1].strip().upper(), 0.0))
        elif by_prefix is not None:
            plain.add(_PREFIXES.get(by_prefix[1].strip("."), 0.0))
    units = converted or plain
    (unit,) = units if len(units) == 1 else (0.0,)
    return unit or None


def _iges_unit(text: str) -> float | None:
    """Parameter 14 of the global section: a flag."""
    section = "".join(line[:72] for line in text.splitlines() if line[72:73] == "G")
    fields: list[str] = []
    place, delimiter = 0, ","
    while place < len(section) and len(fields) < 14:
        string = re.match(r"\s*(\d+)H", section[place:])
        if string is not None:  # a string is preceded by its length
            begin = place + string.end()
            end = begin + int(string[1])
            fields.append(section[begin:end])
            place = section.find(delimiter, end) + 1 or len(section)
            if len(fields) == 1 and fields[0]:
                delimiter = fields[0]
                place = end + 1
        else:
            end = section.find(delimiter, place)
            end = len(section) if end < 0 else end
            fields.append(section[place:end].strip())
            place = end + 1
    flag = fields[13] if len(fields) == 14 else ""
    return _IGES_FLAGS.get(int(flag)) if flag.isdecimal() else None


def choose_unit(extent: float, stated: float | None, given: float | None) -> ChosenUnit:
    """Decide in which unit a file's numbers are read.

    Parameters
    ----------
    extent : float
        The longest side of the part in the file's own numbers.
    stated : float or None
        The unit that the file states [m].
    given : float or None
        The unit that the user names [m].

    Raises
    ------
    GeometryError
        Where neither unit gives a plausible size of a housing; the message asks for the unit that would.

    Notes
    -----
    The file's own unit takes precedence over the user's, unless it makes the part too small or too large and the
    user's unit makes its size plausible: a kernel that works in metres writes files that state millimetres.
    """
    unit = stated if stated is not None else (given if given is not None else UNITS["mm"])
    differs = stated is not None and given is not None and abs(given / stated - 1.0) > 1e-9
    if plausible(extent * unit):
        if differs:
            assert given is not None
            remark = f"the file states {_named(unit)} and is read so, against the unit given, {_named(given)}"
            return ChosenUnit(unit, (remark,))
        return ChosenUnit(unit)
    if differs and given is not None and plausible(extent * given):
        remark = (
            f"the file states {_named(unit)}, in which the part would be {length_text(extent * unit)} long; "
            f"it is read in {_named(given)}, the unit given"
        )
        return ChosenUnit(given, (remark,))
    fitting = [name for name, length in UNITS.items() if plausible(extent * length)]
    whose = "" if stated is None else f", in the {_named(stated)} that the file states"
    question = f"; is the unit {_named(UNITS[fitting[0]])}? (unit = {fitting[0]!r})" if fitting else ""
    raise GeometryError(
        f"the part is {length_text(extent * unit)} long{whose}{question}; "
        f"housings from {length_text(SMALLEST)} to {length_text(LARGEST)} are meshed"
    )


def _named(unit: float) -> str:
    names = {1.0: "metres", 1e-3: "millimetres", 1e-2: "centimetres", 0.0254: "inches", 0.3048: "feet"}
    return names.get(unit, f"units of {unit:g} m")
