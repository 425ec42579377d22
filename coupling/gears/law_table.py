r"""The curves of a contact law, laid out for the compiled kernel.

One row holds all that the kernel reads of an interval of positions: where it begins, how wide it is, and the cubics
of the gap and of the stiffness there. An interval is found by an index instead of a search: the whole range is cut
into as many equal parts as it has intervals, and row i names the interval in which part i begins too; from there it
is few steps forward, none where the knots are even.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

COLUMNS = 11
_HAIR = 1e-14
"""In ranges: by rounding alone an even part must not begin in the interval before its own."""


def law_table(knots: FloatArray, gap: FloatArray, stiffness: FloatArray) -> tuple[float, float, float, FloatArray]:
    """First and last position, equal parts per base pitch, and the table of every kind of pair.

    Parameters
    ----------
    knots : ndarray, shape (m + 1,)
        Increasing positions [base pitches].
    gap, stiffness : ndarray, shape (v, m, 4)
        Of every kind, coefficients c0 ... c3 on each interval in a variable from 0 to 1 [m], [N/m].

    Returns
    -------
    start, end : float
        The outer knots.
    parts : float
        m / (end - start).
    table : ndarray, shape (v, m + 1, 11)
        Columns: the interval in which the row's equal part begins; where the row's own interval begins; one over its
        width; the gap's coefficients; the stiffness's. The last row begins at infinity, where the steps end.
    """
    start, end, count = float(knots[0]), float(knots[-1]), knots.size - 1
    begins = np.linspace(start, end, count + 1)
    table = np.zeros((gap.shape[0], count + 1, COLUMNS))
    first = np.searchsorted(knots, begins + _HAIR * (end - start), side="right") - 1
    table[:, :, 0] = np.minimum(first, count - 1)
    table[:, :-1, 1], table[:, -1, 1] = knots[:-1], np.inf
    table[:, :-1, 2] = 1.0 / np.diff(knots)
    table[:, :-1, 3:7], table[:, :-1, 7:] = gap, stiffness
    return start, end, count / (end - start), table
