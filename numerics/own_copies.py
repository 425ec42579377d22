"""Own copies of what a description is given, so that later changes of the caller's lists and arrays leave it alone.

Also copies of descriptions themselves, with changes that need no checks.
"""

from collections.abc import Collection
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np

Described = TypeVar("Described")


def unchecked(described: Described, kept: Collection[str] = (), **changes: Any) -> Described:
    """Return a frozen description with other attributes, for changes that none of its checks looks at.

    Parameters
    ----------
    described : dataclass
    kept : collection of str
        Cached properties that do not follow from the changes.
    **changes
        Attributes, as the description keeps them.
    """
    copied = object.__new__(type(described))
    known = {field.name for field in fields(described)}.union(kept)  # type: ignore[arg-type]
    copied.__dict__.update({name: value for name, value in described.__dict__.items() if name in known}, **changes)
    return copied


def keep_tuples(described: object, *attributes: str) -> None:
    """Replace the lists and arrays in attributes of a frozen description by tuples, those inside them too."""
    for attribute in attributes:
        object.__setattr__(described, attribute, _as_tuple(getattr(described, attribute)))


def keep_arrays(described: object, *attributes: str) -> None:
    """Replace the arrays in attributes of a frozen description by copies that can only be read; None stays."""
    for attribute in attributes:
        given = getattr(described, attribute)
        if given is not None:
            array = np.array(given)
            array.setflags(write=False)
            object.__setattr__(described, attribute, array)


def _as_tuple(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return tuple(map(_as_tuple, value)) if isinstance(value, list | tuple) else value
