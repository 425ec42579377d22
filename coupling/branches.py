"""Coupled modes followed from speed to speed, through places where they cross and where they veer.

Two modes of neighbouring speeds are held for one where both of their left and right vectors say so. With the
normalisation pᴴ (2 λ I + C) q = 1 the modes of one speed have pᵢᴴ ((λᵢ + λⱼ) I + C) qⱼ = δᵢⱼ, so that

    likeness = |pᵢᴴ ((λᵢ + μⱼ) I + C) rⱼ · sⱼᴴ ((λᵢ + μⱼ) I + D) qᵢ|

of a mode (λ, q, p) of C and one (μ, r, s) of D is 1 for one and the same and 0 for two of one system: the modal
assurance criterion of damped, gyroscopic modes. Where it decides nothing, speeds are put between: near enough to each
other, modes that veer change their shapes little by little, and those that cross keep them.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rotors.branch_following import paired_modes

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]

_ALIKE = 0.8  # likeness from which two modes are one beyond doubt
_ONE = 1e-6  # eigenvalues nearer to each other than this part of them are not told apart
_JUMP = 0.05  # a step of an eigenvalue by this part of it weighs as much as no likeness at all
_MOST_JUMPS = 4.0  # such steps, beyond which the length of a step makes no further difference
_FARTHEST = 0.3  # a branch that would have to jump by this part of its frequency has ended
_HALVINGS = 6  # of a step of speed


@dataclass(frozen=True)
class ModesAtSpeed:
    """Oscillating modes at a speed, m of them.

    Attributes
    ----------
    speed : float
        [rad/s].
    values : ndarray of complex, shape (m,)
    right, left : ndarray of complex, shapes (m, n)
        Normalised as in :class:`coupling.eigenpairs.Eigenpairs`.
    damping : ndarray, shape (n, n)
        C at that speed.
    """

    speed: float
    values: ComplexArray
    right: ComplexArray
    left: ComplexArray
    damping: FloatArray


def likeness(one: ModesAtSpeed, other: ModesAtSpeed) -> FloatArray:
    """How far each mode of one is each of the other, shape (m, m'), 0 to 1."""
    return np.asarray(np.minimum(np.abs(_products(one, other)), 1.0))


def _products(one: ModesAtSpeed, other: ModesAtSpeed) -> ComplexArray:
    """The likeness with its phase: over modes of one eigenvalue it may be added up, whatever vectors they have."""
    sums = one.values[:, None] + other.values[None, :]
    there = sums * (one.left.conj() @ other.right.T) + one.left.conj() @ one.damping @ other.right.T
    back = sums * (one.right @ other.left.conj().T) + one.right @ other.damping.T @ other.left.conj().T
    return np.asarray(there * back)


def matched(
    one: ModesAtSpeed,
    other: ModesAtSpeed,
    solve: Callable[[float], ModesAtSpeed],
    limit: float,
    halvings: int = _HALVINGS,
) -> IntArray:
    """For each mode of one the place of the same mode in the other, or -1, shape (m,).

    Parameters
    ----------
    one, other : ModesAtSpeed
    solve : callable
        The modes at a speed between.
    limit : float
        Modes above it [rad/s] need not be told apart.
    halvings : int
        How often the step may be halved.
    """
    products = _products(one, other)
    alike = np.minimum(np.abs(products), 1.0)
    jump = np.abs(other.values[None, :] - one.values[:, None]) / np.abs(one.values)[:, None]
    found = paired_modes(
        jump, alike, jump_scale=_JUMP, most_jumps=_MOST_JUMPS, longest_jump=_FARTHEST, sure_likeness=_ALIKE
    )
    wanted = np.abs(one.values) < limit
    # Of modes that have one frequency at every speed, as of equal shafts, no step tells which is which: nor need it.
    gaps = np.abs(other.values[:, None] - other.values[None, :])
    together = np.abs(products @ (gaps <= _ONE * np.abs(other.values)))
    surest = np.where(found >= 0, together[np.arange(found.size), found], 0.0)
    if halvings == 0 or not np.any(wanted & (surest < _ALIKE)):
        return found
    middle = solve(0.5 * (one.speed + other.speed))
    first = matched(one, middle, solve, limit, halvings - 1)
    second = matched(middle, other, solve, limit, halvings - 1)
    return np.where(first >= 0, second[first], -1)
