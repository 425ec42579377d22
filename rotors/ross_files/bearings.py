"""Bearings, seals and their supports in a ROSS file."""

import re
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from rotors.bearing import Bearing, Pedestal
from rotors.errors import RotorError

from .remarks import Remarks
from .tables import Entry

FloatArray = npt.NDArray[np.float64]

# Row, column of ROSS's coefficients in the matrix over x, y, z and the rotations about x and y.
PLACES = {"xx": (0, 0), "xy": (0, 1), "yx": (1, 0), "yy": (1, 1), "zz": (2, 2)}

_COEFFICIENT = re.compile(r"[kcm](x|y|z|alpha|beta|theta){2}")


def is_bearing(entry: Entry) -> bool:
    """Whether an element is a bearing or a seal: ROSS has many kinds, and all save their coefficients."""
    return "kxx" in entry.values


def read_bearing(entry: Entry, at: float, pedestal: Pedestal | None, remarks: Remarks) -> Bearing:
    """Read a bearing at a position (m) from its saved coefficients.

    Raises
    ------
    RotorError
        Coefficients that do not fit each other, or are invalid.
    """
    speeds, tables = _tables(entry, remarks)
    stiffness, damping = (_matrix(tables, letter, speeds) for letter in "kc")
    if pedestal is not None and stiffness.shape[-1] == 5:
        remarks.add(entry.place, "kzz stands on the ground here; the support moves in x and y alone")
    try:
        return Bearing(entry.tag, at, stiffness, damping, speeds=speeds, pedestal=pedestal)
    except RotorError as error:
        raise RotorError(f"{entry.file}: {entry.key}: {error}") from None


def read_pedestal(masses: Sequence[Entry], supports: Sequence[Entry], bearing: Entry, remarks: Remarks) -> Pedestal:
    """Read a bearing's pedestal: the point masses at its ``n_link``, and the bearings from there to the ground.

    Raises
    ------
    RotorError
        A support that is not one mass on constant springs and dashpots.
    """
    if not supports:
        raise bearing.error("n_link", "a node that another bearing holds to the ground")
    stiffness, damping = np.zeros((2, 2)), np.zeros((2, 2))
    for entry in supports:
        speeds, tables = _tables(entry, remarks)
        if speeds is not None:
            raise entry.error("frequency", "one value of each coefficient: a support under a bearing has no table")
        stiffness += _matrix(tables, "k", None)[:2, :2]
        damping += _matrix(tables, "c", None)[:2, :2]
    try:
        return Pedestal(stiffness, damping, sum(lateral_mass(entry) for entry in masses))
    except RotorError as error:
        raise RotorError(f"{bearing.file}: {supports[0].key}: {error}") from None


def lateral_mass(entry: Entry) -> float:
    """Mass of a `PointMass`, which must be the same in x and in y, kg."""
    if not {"mx", "my", "mz"} & entry.values.keys():
        return entry.number("m")
    mass = entry.number("mx")
    if entry.number("my") != mass:
        raise entry.error("my", f"{mass:g}, the value of mx: a mass that differs between x and y has no place here")
    return mass


def _tables(entry: Entry, remarks: Remarks) -> tuple[FloatArray | None, dict[str, FloatArray]]:
    """Speeds, or None where the coefficients are constant, and each coefficient over them."""
    frequency = None if entry.values.get("frequency") is None else entry.series("frequency")
    size = 1 if frequency is None else len(frequency)
    tables = {}
    for letter in "kcm":
        for place in PLACES:
            name = letter + place
            # As in ROSS, y defaults to x, which must be given.
            fallback = letter + "xx" if place == "yy" and name not in entry.values else name
            values = entry.series(fallback, default=None if fallback in ("kxx", "cxx") else 0.0)
            if len(values) == 1:
                values = values * size
            if len(values) != size:
                count = "one value" if size == 1 else f"{size} values, one for each frequency"
                raise entry.error(fallback, count)
            tables[name] = np.array(values)
    _remark_on_the_rest(entry, tables, remarks)
    if size == 1:
        return None, tables
    assert frequency is not None
    return np.array(frequency), tables


def _matrix(tables: dict[str, FloatArray], letter: str, speeds: FloatArray | None) -> FloatArray:
    """Stiffness or damping, (2, 2) without axial coefficients and (5, 5) with them, or a table of these."""
    size = 5 if any(tables[kind + "zz"].any() for kind in "kc") else 2
    count = 1 if speeds is None else speeds.size
    table = np.zeros((count, size, size))
    for place, (row, column) in PLACES.items():
        if row < size:
            table[:, row, column] = tables[letter + place]
    return table[0] if speeds is None else table


def _remark_on_the_rest(entry: Entry, tables: dict[str, FloatArray], remarks: Remarks) -> None:
    """Remark on coefficients that a linear bearing of springs and dashpots does not have."""
    for name, values in tables.items():
        if name.startswith("m") and values.any():
            largest = float(np.abs(values).max())
            remarks.add(entry.place, f"{name} is up to {largest:g} kg; the added mass is left out")
    for name in entry.values:
        if name not in tables and _COEFFICIENT.fullmatch(name) and any(entry.series(name)):
            remarks.add(entry.place, f"{name} is not read")
