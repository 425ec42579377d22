"""Reading of a rotor that ROSS saved."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from rotors.bearing import Bearing, Pedestal
from rotors.errors import RotorError
from rotors.shaft import Disc, Rotor

from .bearings import is_bearing, lateral_mass, read_bearing, read_pedestal
from .remarks import Remarks
from .shafts import COUPLING, SHAFT, ReadShaft, read_shaft
from .tables import Entry, read_entries

DISC = "DiskElement"
GEARS = ("GearElement", "GearElementTVMS")
POINT_MASS = "PointMass"


class RossModel(NamedTuple):
    """A rotor read from ROSS's file.

    Attributes
    ----------
    rotor
        Named after the file; a segment for every element, a disc for every disk, gear and point mass on the shaft.
    bearings
        Every bearing and seal that holds the shaft.
    warnings
        Properties of the file that the rotor does not have or has otherwise, a sentence each.
    """

    rotor: Rotor
    bearings: tuple[Bearing, ...]
    warnings: tuple[str, ...]


def read_ross(path: str | os.PathLike[str]) -> RossModel:
    """Read a rotor saved by ROSS, as TOML or (``.json``) JSON.

    ROSS itself is not needed. Elements become exact segments, cones included, so that frequencies are those that ROSS
    approaches as its mesh is refined. A bearing with ``n_link`` stands on a pedestal: the point mass at that node,
    on the bearings from there to the ground. Tables over ``frequency`` become tables over the speed of rotation, as
    ROSS takes them at whirl speed; between their speeds ROSS follows a spline, and a `rotors.Bearing` a monotone cubic.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    RotorError
        Names file, key and value of what is malformed, or has no place in a `Rotor` and would change its motion at
        large: two shafts, elements side by side, a coupling that leaves the shafts apart, a support that is no plain
        pedestal.
    """
    remarks = Remarks()
    entries = read_entries(path, remarks)
    file = Path(path).name
    chosen = _sorted_by_kind(entries)
    if not chosen[SHAFT]:
        raise RotorError(f"{file}: no {SHAFT}; expected a rotor with a shaft")
    shaft = read_shaft(chosen[SHAFT], remarks)
    on_shaft, on_links = _parted(chosen[POINT_MASS], shaft)
    held, supports = _parted(chosen["bearing"], shaft)

    discs = list(shaft.discs)
    discs += [_disc(entry, shaft, remarks) for entry in chosen[DISC]]
    discs += [Disc(shaft.position(entry.required_node()), lateral_mass(entry)) for entry in on_shaft]
    bearings = []
    linked: set[int] = set()
    for entry in held:
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
    """Elements sorted by their kind here; raises for an unknown kind."""
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
