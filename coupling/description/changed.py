"""Changed copies of a description made of nested frozen parts, such as a machine, by the paths of attributes.

A path is as Python writes it, with the name of a part in place of its number where it has one:
``gears[pinion].gear.bore``, ``bearings['left end'].bearing.stiffness[0][0]``, ``torque``; or as the key path of a case,
``gears.pinion.gear.bore``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeVar

import numpy as np

from gearwhine.coupling.errors import CouplingError
from gearwhine.numerics.findings import FINITE
from gearwhine.numerics.names import did_you_mean, one_of

Described = TypeVar("Described")
_STEP = re.compile(r"""\.?(?:([^.\[\]'"]+)|'([^']*)'|"([^"]*)")|\[(?:'([^']*)'|"([^"]*)"|([^\[\]'"]*))\]""")


def changed(description: Described, changes: Mapping[str, object]) -> Described:
    """Return a description with other values at some paths, all of them at once.

    Parameters
    ----------
    description : dataclass
    changes : mapping of str to object
        Values by path.

    Raises
    ------
    CouplingError
        Where a path leads nowhere, or two lead to one place or one into the other.
    ValueError
        What the constructors of the changed parts refuse.
    """
    parsed = [(path_steps(path), path, value) for path, value in changes.items()]
    return _changed(description, parsed, 0)  # type: ignore[no-any-return]  # of its own class


def value_at(description: object, path: str) -> Any:
    """Return the value at a path of a description.

    Raises
    ------
    CouplingError
        Where the path leads nowhere.
    """
    found: Any = description
    steps = path_steps(path)
    for depth in range(len(steps)):
        place = _place(found, (steps, path, None), depth)
        found = found[place] if isinstance(place, int) else getattr(found, place)
    return found


def number_at(description: object, path: str) -> float:
    """Return the number at a path of a description.

    Raises
    ------
    CouplingError
        Where the path leads nowhere, or to no number.
    """
    found = value_at(description, path)
    if not FINITE.accepts(found):
        raise CouplingError(f"{path!r} is {found!r:.60}; expected a number")
    return float(found)


_Change = tuple[tuple[str, ...], str, object]


def path_steps(path: str) -> tuple[str, ...]:
    """Return the steps of a path: attributes, and names or numbers of parts.

    Raises
    ------
    CouplingError
    """
    found = list(_STEP.finditer(path))
    if not path or "".join(one.group() for one in found) != path:
        raise CouplingError(f"{path!r}: expected a path of attributes, such as gears[pinion].gear.bore")
    return tuple(next(step for step in one.groups() if step is not None) for one in found)


def _changed(owner: Any, changes: Sequence[_Change], depth: int) -> Any:
    """Return an object with the changes at their steps from a depth on."""
    ending = [path for steps, path, _ in changes if len(steps) == depth]
    if ending:
        if len(changes) > 1:
            other = next(path for _, path, _ in changes if path != ending[0])
            raise CouplingError(f"{ending[0]!r}, {other!r}: expected each place once, and none inside another")
        return changes[0][2]
    inside: dict[str | int, list[_Change]] = {}
    for change in changes:
        inside.setdefault(_place(owner, change, depth), []).append(change)
    if isinstance(owner, np.ndarray | Sequence):
        entries = list(owner)
        for place, of_place in inside.items():
            entries[int(place)] = _changed(entries[int(place)], of_place, depth + 1)
        return np.array(entries) if isinstance(owner, np.ndarray) else tuple(entries)
    values = {str(name): _changed(getattr(owner, str(name)), of_name, depth + 1) for name, of_name in inside.items()}
    return replace(owner, **values)


def _place(owner: Any, change: _Change, depth: int) -> str | int:
    """Return the attribute, or the number of the entry, that a change's step names.

    Raises
    ------
    CouplingError
    """
    steps, path, _ = change
    step = steps[depth]
    before = "".join(f".{one}" if one.isidentifier() else f"[{one}]" for one in steps[:depth]).removeprefix(".")
    if is_dataclass(owner):
        names = [field.name for field in fields(owner) if field.init]
        if step in names:
            return step
        raise CouplingError(f"{path!r}: expected {one_of(f'an attribute of {type(owner).__name__}', step, names)}")
    if isinstance(owner, np.ndarray | Sequence) and not isinstance(owner, str):
        labels = [*_labels(owner)]
        if step in labels:
            return labels.index(step)
        if step.isdecimal() and int(step) < len(owner):
            return int(step)
        named = list(filter(None, labels))
        counted = f"; there are {len(owner)}"
        hint = f" ({', '.join(named)}){did_you_mean(step, named)}" if named else counted
        raise CouplingError(f"{path!r}: expected the name or number of an entry of {before}{hint}")
    what = "None" if owner is None else f"a {type(owner).__name__}, without attributes"
    raise CouplingError(f"{path!r}: {before} is {what}; expected a path that ends there, or a part in its place")


def _labels(entries: Any) -> Iterator[str]:
    """Yield the name of each part, of a gear pair ``driver-driven``; empty of what has none."""
    for entry in entries:
        part = getattr(entry, "bearing", entry)
        ends = getattr(entry, "driver", None), getattr(entry, "driven", None)
        name = getattr(part, "name", "") if ends == (None, None) else "-".join(map(str, ends))
        yield name if isinstance(name, str) else ""
