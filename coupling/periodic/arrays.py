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
    return Trace(
        start=np.zeros(room),
        size=np.zeros(room),
        state=np.zeros((room, m), dtype=np.complex128),
        excess=np.zeros((room, s, c)),
        compression=np.zeros((room, s, c)),
        rate=np.zeros((room, s, c)),
        force=np.zeros((room, s, c)),
        apart=np.zeros((room, c)),
    )


def first_elements(trace: Trace, count: int) -> Trace:
    """The elements that a trace holds."""
    return Trace._make(rows[:count].copy() for rows in trace)


def empty_steps(k: int, m: int, s: int, c: int) -> Steps:
    """Room for some sizes of elements."""
    return Steps(
        size=np.zeros(k),
        decay=np.zeros((k, m), dtype=np.complex128),
        displacement=np.zeros((k, s, c, m), dtype=np.complex128),
        rate=np.zeros((k, s, c, m), dtype=np.complex128),
        flexibility=np.zeros((k, s * c, s * c)),
        rate_flexibility=np.zeros((k, s * c, s * c)),
        source=np.zeros((k, m, s * c), dtype=np.complex128),
    )
