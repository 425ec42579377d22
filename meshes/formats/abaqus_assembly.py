"""Assemblies of Abaqus: parts and their instances, where these are moved to, and what they call their sets."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.formats.abaqus_cards import KEYWORDS_READ, Card
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True)
class Frame:
    """Where nodes stand: x = origin + axes' x', with the axes as rows."""

    axes: FloatArray
    origin: FloatArray

    def place(self, local: FloatArray) -> FloatArray:
        """Return where a point of local coordinates stands."""
        return np.asarray(self.origin + local @ self.axes)


@dataclass(frozen=True)
class Scope:
    """Names and numbers of a part instance, or of what stands outside of all.

    Attributes
    ----------
    name : str
        Name of the instance, empty outside.
    first : int
        Number that its node and element numbers are counted from.
    frame : Frame or None
        Where the instance is moved to; None where it is not.
    """

    name: str = ""
    first: int = 0
    frame: Frame | None = None


@dataclass
class Instance:
    """Card of an instance, and the cards within it."""

    card: Card
    cards: list[Card] = field(default_factory=list)


def parted(cards: Iterable[Card]) -> tuple[dict[str, list[Card]], list[Instance], list[Card]]:
    """Part the cards into those of each part, by its name in capitals, of each instance, and others."""
    parts: dict[str, list[Card]] = {}
    instances: list[Instance] = []
    outside: list[Card] = []
    target = outside
    for card in cards:
        if card.keyword == "PART":
            target = parts.setdefault(card.parameters.get("NAME", "").upper(), [])
        elif card.keyword == "INSTANCE":
            instances.append(Instance(card))
            target = instances[-1].cards
        elif card.keyword in ("END PART", "END INSTANCE"):
            target = outside
        else:
            target.append(card)
    return parts, instances, outside


def shared_names(owned: Sequence[Sequence[Card]]) -> set[str]:
    """Names of sets and surfaces, in capitals, that the cards of several instances have."""
    seen: set[str] = set()
    shared: set[str] = set()
    for cards in owned:
        given = {
            name.upper()
            for card in cards
            for key in ("NSET", "ELSET", "NAME")
            if card.keyword in KEYWORDS_READ and (name := card.parameters.get(key))
        }
        shared |= seen & given
        seen |= given
    return shared


def moved(card: Card) -> Frame | None:
    """Return the frame that an instance is moved to; None where it stays.

    It is shifted first, and then turned about the axis through two points by an angle in degrees.
    """
    lines = [[float(item or 0.0) for item in line] for line in card.lines]
    if not lines:
        return None
    shift = np.array((lines[0] + [0.0] * 3)[:3])
    if len(lines) == 1:
        return Frame(np.eye(3), shift)
    if len(lines) > 2 or len(lines[1]) != 7:
        raise GeometryError(f"{card.place}: an instance is moved by {len(lines)} lines; expected 3 numbers, and 7")
    start, end, angle = np.array(lines[1][:3]), np.array(lines[1][3:6]), math.radians(lines[1][6])
    length = np.linalg.norm(end - start)
    if not length > 0.0:
        raise GeometryError(f"{card.place}: an instance is turned about an axis of no length")
    x, y, z = (end - start) / length
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + math.sin(angle) * skew + (1.0 - math.cos(angle)) * skew @ skew  # Rodrigues
    return Frame(turn.T, start + turn @ (shift - start))


def local_system(card: Card) -> Frame:
    """Return the system of ``*SYSTEM``: its origin, a point of its x axis, and one of its x, y plane."""
    given = [float(item or 0.0) for line in card.lines for item in line]
    if len(given) == 3:
        return Frame(np.eye(3), np.array(given))
    if len(given) not in (6, 9):
        raise GeometryError(f"{card.place}: *SYSTEM has {len(given)} coordinates; expected those of 1, 2 or 3 points")
    origin, on_x = np.array(given[:3]), np.array(given[3:6]) - given[:3]
    # Without a third point the x axis turns about z.
    in_plane = np.array(given[6:9]) - origin if len(given) == 9 else np.cross([0.0, 0.0, 1.0], on_x)
    third = np.cross(on_x, in_plane)
    if not np.linalg.norm(third) > 1e-9 * np.linalg.norm(on_x) * np.linalg.norm(in_plane):
        raise GeometryError(f"{card.place}: the points of *SYSTEM lie on one line")
    x, z = on_x / np.linalg.norm(on_x), third / np.linalg.norm(third)
    return Frame(np.stack([x, np.cross(z, x), z]), origin)
