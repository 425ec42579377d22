"""Sets of mode shapes as matrices: one row a mode, one column a degree of freedom."""

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
ComplexArray = npt.NDArray[np.complex128]
ShapeArray: TypeAlias = npt.NDArray[np.inexact[Any]]


def shape_set(shapes: npt.ArrayLike, name: str) -> ShapeArray:
    """A set of shapes as a matrix, real where it is real.

    Parameters
    ----------
    shapes : array_like, shape (n_modes, n_dofs) or (n_dofs,)
        Real or complex; NaN where a degree of freedom was not measured. One shape alone is a set of one.
    name : str
        Whose shapes, for messages.

    Raises
    ------
    HousingError
        Where it is no such matrix, an entry is infinite, or a mode has no entry at all.
    """
    given = np.asarray(shapes)
    kind = np.complex128 if np.iscomplexobj(given) else np.float64
    array: ShapeArray = np.atleast_2d(given.astype(kind))
    if array.ndim != 2 or array.shape[1] == 0:
        raise HousingError(f"{name} shapes have the shape {given.shape}; expected (modes, degrees of freedom)")
    if np.isinf(array).any():
        raise HousingError(f"{name} shape {int(np.argwhere(np.isinf(array))[0, 0]) + 1} has an infinite entry")
    blank = np.flatnonzero(np.isnan(array).all(axis=1))
    if blank.size:
        raise HousingError(f"{name} shape {int(blank[0]) + 1} was measured at no degree of freedom")
    return array


def two_sets(
    first: npt.ArrayLike, second: npt.ArrayLike, names: tuple[str, str] = ("the first set's", "the second set's")
) -> tuple[ShapeArray, ShapeArray]:
    """Two sets over the same degrees of freedom; see :func:`shape_set`.

    Raises
    ------
    HousingError
        Also where they have not as many degrees of freedom.
    """
    one, other = shape_set(first, names[0]), shape_set(second, names[1])
    if one.shape[1] != other.shape[1]:
        raise HousingError(
            f"{names[0]} shapes have {one.shape[1]} degrees of freedom and {names[1]} {other.shape[1]}; "
            "expected the same ones in both"
        )
    return one, other


def filled(shapes: ShapeArray) -> tuple[ShapeArray, BoolArray]:
    """Each shape over its largest entry, against overflow of squares, zero where not measured; and where it was."""
    seen = ~np.isnan(shapes)
    known = np.where(seen, shapes, 0.0)
    largest = np.abs(known).max(axis=1, keepdims=True)
    return known / np.where(largest > 0.0, largest, 1.0), seen


def alike_measured(seen: BoolArray) -> list[tuple[BoolArray, npt.NDArray[np.int64]]]:
    """Degrees of freedom measured, and the modes measured at exactly these: most surveys have one such group."""
    patterns, group = np.unique(seen, axis=0, return_inverse=True)
    return [(pattern, np.flatnonzero(group.ravel() == number)) for number, pattern in enumerate(patterns)]
