"""Plain arrays for the kernels of exponential collocation, by name.

Amplitudes are kept as 2 m real numbers, the real parts and then the imaginary ones. c contacts, s Gauss points in an
element, h harmonics, k sizes of elements.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]

_LARGEST_BATCH = 24  # elements whose powers are found at once, within the processor's caches
_BY_ONE_THREAD = 2**18  # of numbers: larger products of matrices OpenBLAS shares out among threads, at a loss


class Reference(NamedTuple):
    """The linear machine at its mean mesh stiffness, by the motion at its contacts.

    The amplitudes of its modes are followed by those of its steady response to the loads, an amplitude e^{iwt} for each
    harmonic and a constant 1, which no contact changes.
    """

    eigenvalue: ComplexArray  # (m,) λ; iw; 0
    source: ComplexArray  # (m, c) rate of each amplitude by a force of each contact, to be subtracted
    displacement: FloatArray  # (c, 2 m) compression of each contact: its product with the amplitudes
    rate: FloatArray  # (c, 2 m) its rate
    stiffness: FloatArray  # (c,) of the reference, k̄
    damping: FloatArray  # (c,) of the reference, c̄
    full_damping: FloatArray  # (c,) the law's damping where it has faded in


class Steps(NamedTuple):
    """Matrices of an element of each size.

    First the sizes that occur, then a geometric ladder of sizes, so that every other length is near one of them; these
    are filled in when first needed. Rows of compressions and rates: place by place, contact
    by contact.
    """

    size: FloatArray  # (k,)
    filled: IntArray  # (k,) whether
    ladder: IntArray  # (1,) index of its first size
    decay: FloatArray  # (k, 2, m) exp(λ h), real and imaginary part
    felt: FloatArray  # (k, 2 s c, 2 m) compressions at the places from the amplitudes at the start; rates
    flexibility: FloatArray  # (k, 2 s c, s c) compressions at the places from the forces there, to be subtracted; rates
    source: FloatArray  # (k, s c, 2 m) amplitudes at the end from the forces, to be subtracted
    missed: FloatArray  # (k, 2 c, 2 m) the same from the defect of their polynomial at the start and at the end
    inner_decay: FloatArray  # (k, s, 2, m) exp(λ h u) at the places; of no sizes where not needed ...
    inner_source: FloatArray  # (k, s, s c, 2 m) ... amplitudes there from the forces, to be subtracted


class Trace(NamedTuple):
    """Motion by elements, with room for e of them."""

    start: FloatArray  # (e,)
    size: FloatArray  # (e,) from the start to the next one's
    part: FloatArray  # (e,) this as a part of the size that the places are of
    slot: IntArray  # (e,) of that size
    state: FloatArray  # (e, 2 m) amplitudes at the start
    excess: FloatArray  # (e, s, c) forces beyond the reference's
    compression: FloatArray  # (e, s, c)
    force: FloatArray  # (e, s, c)
    loss: FloatArray  # (e, s, c) power that the contacts' damping takes [W]
    turning: FloatArray  # (e, s, c) change of the teeth's energy with the phase [J per mesh period]
    energy: FloatArray  # (e, 2) held in the teeth just after the start and just before the end [J]
    apart: FloatArray  # (e, c) 1 where the flanks are apart
    error: FloatArray  # (e, 2) square of the error of the modes' amplitudes at the end; square of the amplitudes


def empty_trace(room: int, m: int, s: int, c: int) -> Trace:
    """Room for some elements."""
    places = (room, s, c)
    return Trace(
        start=np.empty(room),
        size=np.empty(room),
        part=np.empty(room),
        slot=np.empty(room, dtype=np.int64),
        state=np.empty((room, 2 * m)),
        excess=np.empty(places),
        compression=np.empty(places),
        force=np.empty(places),
        loss=np.empty(places),
        turning=np.empty(places),
        energy=np.empty((room, 2)),
        apart=np.empty((room, c)),
        error=np.empty((room, 2)),
    )


def first_elements(trace: Trace, count: int) -> Trace:
    """The elements that a trace holds, in its own memory."""
    return Trace._make(rows[:count] for rows in trace)


def empty_steps(sizes: FloatArray, ladder: int, m: int, s: int, c: int, *, inner: bool = False) -> Steps:
    """Room for some sizes of elements, of which the ladder begins at a number."""
    k, n = len(sizes), s * c
    within = k if inner else 0
    return Steps(
        size=sizes,
        filled=np.zeros(k, dtype=np.int64),
        ladder=np.array([ladder], dtype=np.int64),
        decay=np.empty((k, 2, m)),
        felt=np.empty((k, 2 * n, 2 * m)),
        flexibility=np.empty((k, 2 * n, n)),
        source=np.empty((k, n, 2 * m)),
        missed=np.empty((k, 2 * c, 2 * m)),
        inner_decay=np.empty((within, s, 2, m)),
        inner_source=np.empty((within, s, n, 2 * m)),
    )


class FreeMotion(NamedTuple):
    """r rigid-body motions beside the reference's own: uniformly accelerated from a time on."""

    time: FloatArray  # (1,) [s]
    place: FloatArray  # (r,)
    rate: FloatArray  # (r,)
    acceleration: FloatArray  # (r,)

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places and rates, shapes (t, r)."""
        after = (times - self.time)[:, None]
        return (
            self.place + after * (self.rate + 0.5 * self.acceleration * after),
            self.rate + self.acceleration * after,
        )


class Powers(NamedTuple):
    """Rows for powers from amplitudes, in the n principal directions of the damping matrix."""

    rate: FloatArray  # (2 m + r, n) rates of the amplitudes, and of the rigid-body motions
    loss: FloatArray  # (n,) principal values: the squares of the rates times these give the loss
    skew: FloatArray  # (2 m, n) forces of a stiffness that is not symmetric, twice; (0, n) where it is symmetric
    riding: IntArray  # (k,) amplitudes that carry loads ...
    pushing: FloatArray  # (k, n) ... and these


class PowersRoom(NamedTuple):
    """Room for the powers of a batch of b elements."""

    amplitude: FloatArray  # (b s, 2 m + r)
    rate: FloatArray  # (b s, n)
    along: FloatArray  # (2 m,)
    weights: FloatArray  # (b, s)


def powers_room(size: int, n: int, s: int) -> PowersRoom:
    """Room for as many elements, with ``size`` amplitudes each, as BLAS multiplies in one thread."""
    batch = max(1, min(_LARGEST_BATCH, _BY_ONE_THREAD // (s * size * n)))
    return PowersRoom(np.zeros((batch * s, size)), np.zeros((batch * s, n)), np.zeros(size), np.zeros((batch, s)))
