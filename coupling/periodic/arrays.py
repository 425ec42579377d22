"""The plain arrays that the kernels of the periodic response take, by name.

m eigenvalues, c contacts, s places in an element, h harmonics, k sizes of elements.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]


class Reference(NamedTuple):
    """The linear machine with its teeth at their mean, as the contacts see it."""

    eigenvalue: ComplexArray  # (m,) λ
    source: ComplexArray  # (m, c) what a force of each contact adds to each amplitude's rate, taken off
    displacement: ComplexArray  # (c, m) compression of each contact: the real part of the sum
    rate: ComplexArray  # (c, m) its rate
    stiffness: FloatArray  # (c,) of the reference, k̄
    damping: FloatArray  # (c,) of the reference, c̄
    mean: FloatArray  # (c,) compression in the reference's own response: mean ...
    frequency: FloatArray  # (h,) ... and at these circular frequencies ...
    phasor: ComplexArray  # (c, h) ... with these amplitudes
    phase: FloatArray  # (c,) mesh phase at t = 0
    mesh_rate: FloatArray  # (c,) mesh periods a second
    full_damping: FloatArray  # (c,) the law's damping where it has faded in
    scale: FloatArray  # (c,) a compression that is not small


class Steps(NamedTuple):
    """What an element of each size needs; the last two places are for sizes that switches ask for."""

    size: FloatArray  # (k,)
    decay: ComplexArray  # (k, m) exp(λ h)
    displacement: ComplexArray  # (k, s, c, m) compressions at the places from the amplitudes at the start
    rate: ComplexArray  # (k, s, c, m)
    flexibility: FloatArray  # (k, s c, s c) compressions at the places from the forces there, taken off
    rate_flexibility: FloatArray  # (k, s c, s c)
    source: ComplexArray  # (k, m, s c) amplitudes at the end from the forces, taken off


class Trace(NamedTuple):
    """The motion over a period, element by element; e of them have room."""

    start: FloatArray  # (e,)
    size: FloatArray  # (e,)
    state: ComplexArray  # (e, m) amplitudes at the start
    excess: FloatArray  # (e, s, c) forces beyond the reference's
    compression: FloatArray  # (e, s, c)
    rate: FloatArray  # (e, s, c)
    force: FloatArray  # (e, s, c)
    apart: FloatArray  # (e, c) 1 where the flanks are apart


def empty_trace(room: int, m: int, s: int, c: int) -> Trace:
    """Room for some elements."""
    at_places = [np.zeros((room, s, c)) for _ in range(4)]
    state = np.zeros((room, m), dtype=np.complex128)
    return Trace(np.zeros(room), np.zeros(room), state, *at_places, np.zeros((room, c)))


def empty_steps(k: int, m: int, s: int, c: int) -> Steps:
    """Room for some sizes of elements."""
    rows = [np.zeros((k, s, c, m), dtype=np.complex128) for _ in range(2)]
    squares = [np.zeros((k, s * c, s * c)) for _ in range(2)]
    decay, source = np.zeros((k, m), dtype=np.complex128), np.zeros((k, m, s * c), dtype=np.complex128)
    return Steps(np.zeros(k), decay, *rows, *squares, source)
