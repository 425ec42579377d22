r"""Points of the unit cube: Sobol' sequences, and the designs that tell what the scatter follows from.

A scrambled Sobol' sequence covers the cube more evenly than random points, so that means converge with nearly 1/n in
place of 1/√n (Owen 1997). The first n points of a seed are the same for whatever number is asked: a study goes on where
it ended.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt
from scipy.stats import qmc

from gearwhine.numerics.arrays import BoolArray, FloatArray

Scalar = TypeVar("Scalar", bound=np.generic)
_BITS = 30
MOST_POINTS = 2**_BITS
"""Number of points of a sequence."""


def sobol_points(count: int, dimension: int, seed: int) -> FloatArray:
    """Points of a scrambled Sobol' sequence inside the unit cube, shape (count, dimension).

    Parameters
    ----------
    count : int
        From 1 to `MOST_POINTS`; powers of two are the most even.
    dimension : int
    seed : int
        Seed of the scrambling.
    """
    sequence = qmc.Sobol(dimension, scramble=True, bits=_BITS, rng=np.random.default_rng(seed))
    with warnings.catch_warnings():
        # The balance of powers of two is lost by other numbers; the study says how many are good.
        warnings.simplefilter("ignore", UserWarning)
        points = sequence.random(count)
    # Each point stands for a cell of the sequence; its middle is never on the cube's face.
    return np.asarray(points + 0.5 / MOST_POINTS)


@dataclass(frozen=True, eq=False)
class IndexPoints:
    """Points for Sobol' indices of k inputs: two matrices A and B, and for each input A with its columns from B.

    After Saltelli (2002): ``n (k + 2)`` points give the first-order and the total-order index of all inputs.

    Attributes
    ----------
    rows : int
        Number n of rows of A and of B.
    inputs : tuple of tuple of int
        Coordinates of each input; an input of several coordinates changes them together.
    points : ndarray, shape (n (k + 2), d)
        Row by row: that of A, that of B, and that of A with each input from B.
    """

    rows: int
    inputs: tuple[tuple[int, ...], ...]
    points: FloatArray

    @property
    def representative(self) -> BoolArray:
        """Mask of the points that are drawn as the inputs are: those of A and of B."""
        return np.asarray(np.arange(len(self.points)) % (len(self.inputs) + 2) < 2)

    def split(self, values: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return values at the points as those of A and B, (n, ...), and of A with each input from B, (k, n, ...)."""
        blocks = values.reshape(self.rows, len(self.inputs) + 2, *values.shape[1:])
        return blocks[:, 0], blocks[:, 1], np.moveaxis(blocks[:, 2:], 1, 0)


def index_points(rows: int, inputs: tuple[tuple[int, ...], ...], seed: int) -> IndexPoints:
    """Return the points for Sobol' indices of inputs, each of one or more coordinates.

    Parameters
    ----------
    rows : int
    inputs : tuple of tuple of int
        Coordinates of each input: every coordinate from 0 in one of them.
    seed : int
    """
    dimension = sum(map(len, inputs))
    # A row of one sequence of twice the dimension has a row of A and one of B, so that neither repeats the other.
    both = sobol_points(rows, 2 * dimension, seed)
    first, second = both[:, :dimension], both[:, dimension:]
    blocks = np.empty((rows, len(inputs) + 2, dimension))
    blocks[:, 0], blocks[:, 1] = first, second
    for number, coordinates in enumerate(inputs):
        changed = list(coordinates)
        blocks[:, 2 + number] = first
        blocks[:, 2 + number, changed] = second[:, changed]
    return IndexPoints(rows, inputs, blocks.reshape(-1, dimension))


@dataclass(frozen=True, eq=False)
class WidenedPoints:
    """Points at which one input after the other has a wider distribution, beside those where none has.

    All rows of a block have the same point of the unit cube, so that differences between them have no scatter but by
    the wider distribution.

    Attributes
    ----------
    rows : int
        Number n of blocks.
    inputs : tuple of int
        Numbers of the k inputs that are widened.
    points : ndarray, shape (n (k + 1), d + 1)
        Block by block: the point without a wider input, and with each. The last column is the number of the input that
        is wider, from 1, and 0 for none.
    """

    rows: int
    inputs: tuple[int, ...]
    points: FloatArray

    @property
    def representative(self) -> BoolArray:
        """Mask of the points that are drawn as the inputs are: those without a wider one."""
        return np.asarray(self.points[:, -1] == 0.0)

    def split(self, values: npt.NDArray[Scalar]) -> tuple[npt.NDArray[Scalar], npt.NDArray[Scalar]]:
        """Return values at the points as those without a wider input, (n,), and with each, (k, n)."""
        blocks = values.reshape(self.rows, len(self.inputs) + 1)
        return blocks[:, 0], blocks[:, 1:].T


def widened_points(points: FloatArray, inputs: Sequence[int]) -> WidenedPoints:
    """Return the points that tell what wider inputs cost.

    Parameters
    ----------
    points : ndarray, shape (n, d)
        Points of the inputs as they are.
    inputs : sequence of int
        Numbers of the inputs that are widened, from 0.
    """
    number = np.array([0.0, *(1.0 + place for place in inputs)])
    repeated = np.repeat(points, number.size, axis=0)
    return WidenedPoints(len(points), tuple(inputs), np.column_stack([repeated, np.tile(number, len(points))]))
