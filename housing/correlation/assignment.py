"""Linear assignment of rows to columns by their scores, and its margin over the next best assignment."""

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


def best_assignment(scores: FloatArray) -> list[tuple[int, int]]:
    """Rows and columns, each at most once, with the largest sum of scores; pairs without a score are left out.

    Parameters
    ----------
    scores : ndarray, shape (n, m)
        Zero or above; zero forbids.

    Returns
    -------
    list of (row, column)
        Ascending in the rows.
    """
    rows, columns = linear_sum_assignment(scores, maximize=True)
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if scores[i, j] > 0.0]


def margin(scores: FloatArray, row: int, columns: BoolArray) -> float:
    """Relative loss of the best assignment where a row may not take any of some columns.

    The best sum with the row in one of these columns, less the best sum with it in none of them, over the row's score
    in the former; clipped to 0. 1: the other rows gain nothing. 0: another assignment is as good.

    It measures the clearness of the choice, not its probability: a row with one poor partner and no other has 1.

    Parameters
    ----------
    scores : ndarray, shape (n, m)
        Zero or above.
    row : int
    columns : ndarray of bool, shape (m,)
        In one of which it scores above zero.
    """
    within, without = scores.copy(), scores.copy()
    # A bonus larger than any sum keeps the row in these columns, and is taken off again.
    bonus = 1.0 + float(scores.sum())
    within[row] = np.where(columns & (scores[row] > 0.0), scores[row] + bonus, 0.0)
    without[row, columns] = 0.0
    pairs = best_assignment(within)
    own = next(scores[i, j] for i, j in pairs if i == row)
    kept = sum(scores[i, j] for i, j in pairs)
    lost = kept - sum(scores[i, j] for i, j in best_assignment(without))
    return float(np.clip(lost / own, 0.0, 1.0))
