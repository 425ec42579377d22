"""Own copies of what a description is given, so that later changes of the caller's lists and arrays leave it alone."""

from typing import Any

import numpy as np


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
