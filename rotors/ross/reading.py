"""Reading of a ROSS file: the rotor, its bearings and seals, and their supports as pedestals."""

import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.errors import RotorError
from gearwhine.rotors.model.bearing import Bearing, Pedestal
from gearwhine.rotors.model.shaft import Disc, Rotor
from gearwhine.rotors.ross.shafts import COUPLING, SHAFT, ReadShaft, read_shaft
from gearwhine.rotors.ross.tables import Entry, Remarks, read_entries

# Row, column of ROSS's coefficients in the matrix over x, y, z and the rotations about x and y.
PLACES = {"xx": (0, 0), "xy": (0, 1), "yx": (1, 0), "yy": (1, 1), "zz": (2, 2)}

_ROUNDING = 1e-6  # negative damping over the largest of a table, below which it is zero
_COEFFICIENT = re.compile(r"[kcm](x|y|z|alpha|beta|theta){2}")


def is_bearing(entry: Entry) -> bool:
    """Whether an element is a bearing or a seal: ROSS has many kinds, and all save their coefficients."""
    return "kxx" in entry.values


def read_bearing(entry: Entry, at: float, pedestal: Pedestal | None, remarks: Remarks) -> Bearing:
    """Read a bearing at a position [m] from its saved coefficients.

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
    """Mass of a `PointMass`, which must be the same in x and in y [kg]."""
    if not {"mx", "my", "mz"} & entry.values.keys():
        return entry.number("m")
    mass = entry.number("mx")
    if entry.number("my") != mass:
        raise entry.error("my", f"{mass:g}, the value of mx: a mass that differs between x and y has no place here")
    return mass


def _tables(entry: Entry, remarks: Remarks) -> tuple[FloatArray | None, dict[str, FloatArray]]:
    """Speeds, or None where the coefficients are constant, and each coefficient over them."""
    speed, frequency = (
        None if entry.values.get(name) is None else np.array(entry.series(name)) for name in ("speed", "frequency")
    )
    if speed is not None and frequency is not None and len(speed) > 1 and len(frequency) > 1:
        return _synchronous(entry, speed, frequency, remarks)
    # An axis of one value is none.
    axis = frequency if speed is None or (len(speed) == 1 and frequency is not None) else speed
    size = 1 if axis is None else len(axis)
    if axis is frequency and size > 1 and entry.of_ross_3:
        remarks.add(
            entry.place, "table over the frequency of whirl, taken over the speed of rotation, as if synchronous"
        )
    tables = {}
    for letter in "kcm":
        for place in PLACES:
            name = letter + place
            # As in ROSS, y defaults to x, which must be given.
            fallback = letter + "xx" if place == "yy" and name not in entry.values else name
            values = np.ravel(entry.nested(fallback, default=None if fallback in ("kxx", "cxx") else 0.0))
            if len(values) == 1:
                values = np.repeat(values, size)
            if len(values) != size:
                what = "speed or frequency" if entry.of_ross_3 else "frequency"
                count = "one value" if size == 1 else f"{size} values, one for each {what}"
                raise entry.error(fallback, count)
            tables[name] = values
    _remark_on_the_rest(entry, tables, remarks)
    return (None if size == 1 else axis), tables


def _synchronous(
    entry: Entry, speed: FloatArray, frequency: FloatArray, remarks: Remarks
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Coefficients of a table over speed and frequency where both are the same, over the speeds within both axes."""
    inside = (speed >= frequency[0]) & (speed <= frequency[-1])
    if np.any(np.diff(frequency) <= 0.0) or np.count_nonzero(inside) < 2:
        raise entry.error("frequency", "ascending frequencies, with two or more of the table's speeds between them")
    remarks.add(
        entry.place, "table over speed and frequency of whirl, taken where both are the same, as if synchronous"
    )
    if not inside.all():
        remarks.add(entry.place, "speeds outside of the table's frequencies are left out")
    shape = (len(speed), len(frequency))
    tables = {}
    for letter in "kcm":
        for place in PLACES:
            name = letter + place
            fallback = letter + "xx" if place == "yy" and name not in entry.values else name
            values = entry.nested(fallback, default=None if fallback in ("kxx", "cxx") else 0.0)
            if values.size == 1:
                values = np.full(shape, values.item())
            if values.shape != shape:
                raise entry.error(fallback, f"one value, or {shape[0]} lists of {shape[1]}")
            along = PchipInterpolator(frequency, values, axis=1)
            tables[name] = np.array([along(at)[row] for row, at in enumerate(speed) if inside[row]])
    _remark_on_the_rest(entry, tables, remarks)
    return speed[inside], tables


def _matrix(tables: dict[str, FloatArray], letter: str, speeds: FloatArray | None) -> FloatArray:
    """Stiffness or damping, (2, 2) without axial coefficients and (5, 5) with them, or a table of these."""
    size = 5 if any(tables[kind + "zz"].any() for kind in "kc") else 2
    count = 1 if speeds is None else speeds.size
    table = np.zeros((count, size, size))
    for place, (row, column) in PLACES.items():
        if row < size:
            table[:, row, column] = tables[letter + place]
    if letter == "c":
        # Magnetic bearings of ROSS have the difference of two large numbers as their damping.
        direct = table[:, range(2), range(2)]
        is_rounding = (direct < 0.0) & (direct > -_ROUNDING * direct.max(initial=0.0))
        table[:, range(2), range(2)] = np.where(is_rounding, 0.0, direct)
    return table[0] if speeds is None else table


def _remark_on_the_rest(entry: Entry, tables: dict[str, FloatArray], remarks: Remarks) -> None:
    """Remark on coefficients that a linear bearing of springs and dashpots does not have."""
    for name, values in tables.items():
        if name.startswith("m") and values.any():
            largest = float(np.abs(values).max())
            remarks.add(entry.place, f"{name} is up to {largest:g} kg; the added mass is left out")
    for name in entry.values:
        if name not in tables and _COEFFICIENT.fullmatch(name) and np.any(entry.nested(name)):
            remarks.add(entry.place, f"{name} is not read")
    if entry.values.get("interpolation", "pchip") != "pchip" and any(
        np.ptp(values) > 0.0 for values in tables.values()
    ):
        text = f"interpolation is {entry.values['interpolation']!r}; here the table follows a monotone cubic"
        remarks.add(entry.place, text)


DISC = "DiskElement"
GEARS = ("GearElement", "GearElementTVMS")
POINT_MASS = "PointMass"


class RossModel(NamedTuple):
    """A rotor read from ROSS's file.

    Attributes
    ----------
    rotor : Rotor
        Rotor named after the file; it has a segment for every element, and a disc for every disk, gear and point mass
        on the shaft.
    bearings : tuple of Bearing
        Every bearing and seal that holds the shaft.
    warnings : tuple of str
        Properties of the file that the rotor lacks or has in another form, a sentence each.
    """

    rotor: Rotor
    bearings: tuple[Bearing, ...]
    warnings: tuple[str, ...]


def read_ross(path: str | os.PathLike[str]) -> RossModel:
    """Read a rotor saved by ROSS, as TOML or (``.json``) JSON.

    ROSS itself is not needed. Elements become exact segments, cones included, so that frequencies are those that ROSS
    approaches as its mesh is refined. A bearing with ``n_link`` stands on a pedestal: the point mass at that node,
    on the bearings from there to the ground. Tables over ``speed`` (ROSS 3) or ``frequency`` become tables over the
    speed of rotation, as ROSS takes them at whirl speed; between their speeds ROSS 2 follows a spline, and ROSS 3 and
    a `gearwhine.rotors.Bearing` a monotone cubic. Elements between the same two nodes, as a sleeve on its shaft,
    become one segment.

    Parameters
    ----------
    path : str or os.PathLike[str]
        The file.

    Raises
    ------
    RotorError
        Names file, key and value of what is malformed, or has no place in a `Rotor` and would change its motion at
        large: two shafts, a coupling that leaves the shafts apart, a support that is no plain pedestal.
    """
    remarks = Remarks()
    entries = read_entries(path, remarks)
    file = Path(path).name
    chosen = _sorted_by_kind(entries)
    if not chosen[SHAFT]:
        raise RotorError(f"{file}: no {SHAFT}; expected a rotor with a shaft")
    shaft = read_shaft(chosen[SHAFT], remarks)
    on_shaft, on_links = _parted(chosen[POINT_MASS], shaft)
    bearings_on_shaft, supports = _parted(chosen["bearing"], shaft)

    discs = list(shaft.discs)
    discs += [_disc(entry, shaft, remarks) for entry in chosen[DISC]]
    discs += [Disc(shaft.position(entry.required_node()), lateral_mass(entry)) for entry in on_shaft]
    bearings = []
    linked: set[int] = set()
    for entry in bearings_on_shaft:
        pedestal = _pedestal_of(entry, on_links, supports, shaft, linked, remarks)
        bearings.append(read_bearing(entry, shaft.position(entry.required_node()), pedestal, remarks))
    for entry in [*on_links, *supports]:
        if entry.node() not in linked:
            raise entry.error("n", f"a node of the shaft, at most {shaft.last_node}, or the n_link of a bearing")
    try:
        rotor = Rotor(Path(path).stem, shaft.segments, discs)
    except RotorError as error:
        raise RotorError(f"{file}: {error}") from None
    return RossModel(rotor, tuple(bearings), remarks.sentences())


def _sorted_by_kind(entries: Sequence[Entry]) -> dict[str, list[Entry]]:
    """Elements sorted by kind; raises for an unknown kind."""
    chosen: dict[str, list[Entry]] = {SHAFT: [], DISC: [], POINT_MASS: [], "bearing": []}
    tests: list[tuple[str, Callable[[Entry], bool]]] = [
        (SHAFT, lambda entry: entry.kind in (SHAFT, COUPLING)),
        (DISC, lambda entry: entry.kind in (DISC, *GEARS)),
        (POINT_MASS, lambda entry: entry.kind == POINT_MASS),
        ("bearing", is_bearing),
    ]
    for entry in entries:
        for name, belongs in tests:
            if belongs(entry):
                chosen[name].append(entry)
                break
        else:
            raise RotorError(
                f"{entry.file}: {entry.key} is an element of class {entry.kind!r}; expected a shaft element, coupling, "
                "disk, gear, point mass, or a bearing or seal with its coefficients (kxx, cxx)"
            )
    return chosen


def _parted(entries: Sequence[Entry], shaft: ReadShaft) -> tuple[list[Entry], list[Entry]]:
    """Elements on the shaft's nodes, and those on nodes beyond it."""
    on_shaft: list[Entry] = []
    beyond: list[Entry] = []
    for entry in entries:
        node = entry.required_node()
        if node < shaft.first_node:
            raise entry.error("n", f"a node of the shaft, from {shaft.first_node}")
        (on_shaft if node <= shaft.last_node else beyond).append(entry)
    return on_shaft, beyond


def _disc(entry: Entry, shaft: ReadShaft, remarks: Remarks) -> Disc:
    node = entry.required_node()
    if not shaft.first_node <= node <= shaft.last_node:
        raise entry.error("n", f"a node of the shaft, {shaft.first_node} to {shaft.last_node}")
    if entry.kind in GEARS:
        remarks.add(entry.place, "is read as a disc; its teeth are left out")
    try:
        return Disc(shaft.position(node), entry.number("m"), entry.number("Ip"), entry.number("Id"))
    except RotorError as error:
        raise error if entry.file in str(error) else RotorError(f"{entry.file}: {entry.key}: {error}") from None


def _pedestal_of(
    entry: Entry,
    masses: Sequence[Entry],
    supports: Sequence[Entry],
    shaft: ReadShaft,
    linked: set[int],
    remarks: Remarks,
) -> Pedestal | None:
    """Pedestal of a bearing, whose node is added to ``linked``; None for the ground."""
    link = entry.node("n_link")
    if link is None:
        return None
    if link <= shaft.last_node:
        raise entry.error("n_link", f"a node beyond the shaft's last, {shaft.last_node}, as a support has")
    if link in linked:
        raise entry.error("n_link", "a node of its own: two bearings on one moving support have no place here")
    linked.add(link)
    below = [support for support in supports if support.node() == link]
    for support in below:
        if support.node("n_link") is not None:
            raise support.error("n_link", "nothing: a support on a further support has no place here")
    return read_pedestal([mass for mass in masses if mass.node() == link], below, entry, remarks)
