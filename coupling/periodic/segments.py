r"""Multiple shooting: Newton's correction of a motion in segments, condensed to the state at its start.

A period of many mesh periods is integrated segment by segment, each from a state of its own. With the pieces
A_k = ∂(end of segment k) / ∂(its start) and the closure errors r_k = end of k - start of k + 1, the corrections d_k
of the starts and a change p of the speed have

    d_{k+1} = A_k d_k + r_k + s_k p,        d_K = d_0,

s_k the derivative of the closure errors by speed. Over the period that is d_K = M d_0 + R + S p with the monodromy
M = A_{K-1} ... A_0. An unstable disturbance grows over one segment only before it is corrected, so motions are found
from which an integration over the whole period would depart at once.

- U. M. Ascher, R. M. M. Mattheij, R. D. Russell, *Numerical Solution of Boundary Value Problems for Ordinary
  Differential Equations*, 1988, chapter 4.
"""

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


def product(pieces: FloatArray) -> FloatArray:
    """The monodromy of pieces (K, 2 N, 2 N) that follow each other, shape (2 N, 2 N)."""
    whole = pieces[0]
    for piece in pieces[1:]:
        whole = piece @ whole
    return np.asarray(whole)


def carried(pieces: FloatArray, first: FloatArray, sources: FloatArray) -> FloatArray:
    """d_0 ... d_K of d_{k+1} = A_k d_k + source k, shape (K + 1, 2 N)."""
    found = np.empty((len(pieces) + 1, len(first)))
    found[0] = first
    for k, (piece, source) in enumerate(zip(pieces, sources, strict=True)):
        found[k + 1] = piece @ found[k] + source
    return found


def correction(pieces: FloatArray, misses: FloatArray, monodromy: FloatArray, *, least: bool = False) -> FloatArray:
    """Newton correction that closes a motion at its speed, shape (K, 2 N).

    With ``least``, the smallest one where a multiplier is 1.

    Raises
    ------
    numpy.linalg.LinAlgError
        Where a multiplier is 1, without ``least``.
    """
    zero = np.zeros(misses.shape[1])
    rest = carried(pieces, zero, misses)[-1]
    matrix = monodromy - np.eye(len(zero))
    first = np.linalg.lstsq(matrix, -rest, rcond=1e-14)[0] if least else np.linalg.solve(matrix, -rest)
    return carried(pieces, first, misses)[:-1]


def bordered_correction(
    pieces: FloatArray,
    monodromy: FloatArray,
    misses: FloatArray,
    by_speed: FloatArray,
    along: FloatArray,
    along_speed: float,
    behind: float,
) -> tuple[FloatArray, float]:
    """Newton correction that closes a motion and moves it along a direction.

    Parameters
    ----------
    pieces : ndarray, shape (K, 2 N, 2 N)
    monodromy : ndarray, shape (2 N, 2 N)
        Their product.
    misses, by_speed : ndarray, shape (K, 2 N)
        r and s.
    along : ndarray, shape (K, 2 N)
    along_speed : float
        The direction among the states and the speed.
    behind : float
        Required growth of Σ along · d + along_speed p.

    Returns
    -------
    corrections : ndarray, shape (K, 2 N)
    change : float
        Of the speed.

    Raises
    ------
    numpy.linalg.LinAlgError
        Where the bordered system is singular.
    """
    size = misses.shape[1]
    zero = np.zeros(size)
    rest, change = carried(pieces, zero, misses), carried(pieces, zero, by_speed)
    row = np.zeros(size)
    for piece, direction in zip(pieces[::-1], along[::-1], strict=True):
        row = direction + row @ piece
    matrix = np.zeros((size + 1, size + 1))
    matrix[:size, :size] = monodromy - np.eye(size)
    matrix[:size, size] = change[-1]
    matrix[size, :size], matrix[size, size] = row, float(np.sum(along * change[:-1])) + along_speed
    right = np.append(-rest[-1], behind - float(np.sum(along * rest[:-1])))
    # Growth over the period would swamp the row of the direction.
    scale = np.abs(matrix).max(axis=1)
    found = np.linalg.solve(matrix / scale[:, None], right / scale)
    move = float(found[size])
    return carried(pieces, found[:size], misses + move * by_speed)[:-1], move
