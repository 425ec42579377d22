"""Plain arrays for the kernels of exponential collocation: Gauss points, quadrature weights, elements, scratch.

Amplitudes are kept as 2 m real numbers, the real parts and then the imaginary ones. c contacts, s Gauss points in an
element, h harmonics, k sizes of elements.

An element of time is solved by Gauss collocation. Gauss points, here called places, and polynomials are in u, which
runs from 0 to 1 over the element.
"""

import math
from typing import NamedTuple

import numpy as np

from gearwhine.numerics.arrays import ComplexArray, FloatArray, IntArray

ORDER = 5
"""Gauss points (places) in an element; the error at its end is of order 2 ORDER + 1 in the element's size."""


def _barycentric(points: FloatArray) -> FloatArray:
    apart = points[:, None] - points[None, :] + np.eye(len(points))
    return np.asarray(1.0 / apart.prod(axis=1))


def _missing(places: FloatArray) -> FloatArray:
    """Polynomials that vanish at the places: the first is 1 at the start and 0 at the end, the second 0 and 1."""
    whole = np.polynomial.polynomial.polyfromroots(places)
    first = np.polynomial.polynomial.polymul(whole, [1.0, -1.0]) / whole[0]
    last = np.polynomial.polynomial.polymul(whole, [0.0, 1.0]) / whole.sum()
    return np.ascontiguousarray([first, last])


PLACES: FloatArray = 0.5 * (1.0 + np.polynomial.legendre.leggauss(ORDER)[0])
"""Gauss-Legendre points, ascending, shape (ORDER,)."""

MONOMIALS: FloatArray = np.ascontiguousarray(np.linalg.inv(np.vander(PLACES, increasing=True)).T)
"""Coefficients of u⁰, u¹, ... of the polynomial that is 1 at place j and 0 at the others, shape (ORDER, ORDER)."""

GAUSS: FloatArray = np.ascontiguousarray(0.5 * np.polynomial.legendre.leggauss(ORDER)[1])
"""Weights of an integral over the whole element, shape (ORDER,)."""

POINTS: FloatArray = np.concatenate([[0.0], PLACES, [1.0]])
"""Both ends and the places: interpolation points of a compression within an element, shape (ORDER + 2,)."""

BARYCENTRIC: FloatArray = _barycentric(POINTS)
"""Weights of the barycentric formula on `POINTS`, shape (ORDER + 2,)."""

INSIDE = 1e-6
"""Offset of an evaluation at an end into the element, over its length: events and switches are at the very end."""

AT_ENDS: FloatArray = np.ascontiguousarray(np.vander([INSIDE, 1.0 - INSIDE], ORDER, increasing=True) @ MONOMIALS.T)
"""Weights of the values at the places for their polynomial just inside both ends, shape (2, ORDER)."""

MISSING: FloatArray = _missing(PLACES)
"""Coefficients of a polynomial's defect for a defect of 1 at the start or at the end, shape (2, ORDER + 2)."""


BINOMIAL: FloatArray = np.array([[float(math.comb(j, k)) for k in range(ORDER)] for j in range(ORDER)])
"""Coefficients of (u + v)ʲ, shape (ORDER, ORDER)."""

AT_END: FloatArray = np.ascontiguousarray(MONOMIALS @ BINOMIAL)
"""Coefficients of (u - 1)⁰, (u - 1)¹, ... of the polynomial that is 1 at place j, shape (ORDER, ORDER)."""


def weights_to(part: FloatArray) -> FloatArray:
    """Quadrature weights (e, ORDER) at the places for integrals from 0 to ``part`` (e,); the Gauss weights for 1."""
    powers = np.arange(1, ORDER + 1)
    return np.asarray((part[:, None] ** powers / powers) @ MONOMIALS.T)


_LADDER = 1.1  # ratio of neighbouring sizes of the ladder
_RUNGS = 100  # number of ladder sizes: the smallest is a ten-thousandth of the largest
_LARGEST_BATCH = 24  # number of elements whose powers are evaluated at once, within the processor's caches
_BY_ONE_THREAD = 2**18  # operand size; OpenBLAS splits larger matrix products among threads, at a loss


class Reference(NamedTuple):
    """The linear machine at its mean mesh stiffness, by the motion at its contacts.

    The amplitudes of the modes come first; the amplitudes of the steady response to the loads follow, e^{iwt} for each
    harmonic and a constant 1. No contact changes the amplitudes of the response.
    """

    eigenvalue: ComplexArray  # (m,) λ; iw; 0
    source: ComplexArray  # (m, c) rate of each amplitude by a force of each contact, to be subtracted
    displacement: FloatArray  # (c, 2 m) its product with the amplitudes is the compression of each contact
    rate: FloatArray  # (c, 2 m) its product with the amplitudes is the rate of the compression
    stiffness: FloatArray  # (c,) k̄, the mean stiffness
    damping: FloatArray  # (c,) c̄, the mean damping
    full_damping: FloatArray  # (c,) the contact law's damping beyond its fade-in depth


class Steps(NamedTuple):
    """Matrices of an element of each size.

    The sizes that occur come first, then a geometric ladder of sizes, so that every other length is near one of them.
    Ladder matrices are filled in when first needed. Rows of compressions and rates are ordered by place, then by
    contact.
    """

    size: FloatArray  # (k,)
    filled: IntArray  # (k,) 1 where the matrices are filled in
    ladder: IntArray  # (1,) index of the first size of the ladder
    decay: FloatArray  # (k, 2, m) exp(λ h), real and imaginary part
    free_response: FloatArray  # (k, 2 s c, 2 m) compressions at the places from the amplitudes at the start; rates
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
    phase_slope: FloatArray  # (e, s, c) change of the teeth's energy with the phase [J per mesh period]
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
        phase_slope=np.empty(places),
        energy=np.empty((room, 2)),
        apart=np.empty((room, c)),
        error=np.empty((room, 2)),
    )


def first_elements(trace: Trace, count: int) -> Trace:
    """Copy the elements that a trace holds."""
    return Trace._make(rows[:count] for rows in trace)


def empty_steps(reference: Reference, values: FloatArray, largest: float, *, inner: bool = False) -> Steps:
    """Room for elements of some sizes [s], and for a ladder of sizes from the largest down."""
    sizes = np.concatenate([values, largest / _LADDER ** np.arange(_RUNGS)])
    m, s, c = reference.eigenvalue.size, ORDER, reference.stiffness.size
    k, n = len(sizes), s * c
    within = k if inner else 0
    return Steps(
        size=sizes,
        filled=np.zeros(k, dtype=np.int64),
        ladder=np.array([len(values)], dtype=np.int64),
        decay=np.empty((k, 2, m)),
        free_response=np.empty((k, 2 * n, 2 * m)),
        flexibility=np.empty((k, 2 * n, n)),
        source=np.empty((k, n, 2 * m)),
        missed=np.empty((k, 2 * c, 2 * m)),
        inner_decay=np.empty((within, s, 2, m)),
        inner_source=np.empty((within, s, n, 2 * m)),
    )


class FreeMotion(NamedTuple):
    """r uniformly accelerated rigid-body motions, added to the reference's response."""

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
    riding: IntArray  # (k,) indices of the amplitudes that loads are proportional to
    pushing: FloatArray  # (k, n) load of each of these amplitudes


class PowersRoom(NamedTuple):
    """Room for the powers of a batch of b elements."""

    amplitude: FloatArray  # (b s, 2 m + r)
    rate: FloatArray  # (b s, n)
    along: FloatArray  # (2 m,)
    weights: FloatArray  # (b, s)


def powers_room(size: int, n: int, s: int) -> PowersRoom:
    """Allocate room for the largest batch of elements, ``size`` amplitudes each, that BLAS multiplies in one thread."""
    batch = max(1, min(_LARGEST_BATCH, _BY_ONE_THREAD // (s * size * n)))
    return PowersRoom(np.zeros((batch * s, size)), np.zeros((batch * s, n)), np.zeros(size), np.zeros((batch, s)))


class Work(NamedTuple):
    """Scratch arrays: n = s c unknown forces of an element, m amplitudes, c contacts, s places."""

    base: FloatArray  # (2 n,) compressions and rates without the excess forces
    excess: FloatArray  # (n,)
    move: FloatArray  # (n,) last Newton step
    slope: FloatArray  # (n,) derivative of the excess by compression
    rate_slope: FloatArray  # (n,) derivative of the excess by rate
    delta: FloatArray  # (s + 2, c) compressions at the places and both ends
    rate: FloatArray  # (s + 2, c)
    looked: FloatArray  # (4, c) compressions and rates just after the start, and just before the end
    laws: FloatArray  # (n + 2 c + 1, 6) rows at the places, just after the start, at the end, and one for trials
    matrix: FloatArray  # (n, n)
    right: FloatArray  # (n, 1)
    end: FloatArray  # (2 m,) amplitudes
    end_error: FloatArray  # (2 m,)
    measure: FloatArray  # (2,)
    cut_decay: FloatArray  # (1, 2, m) decay over a part of an element
    cut_source: FloatArray  # (1, n, 2 m)
    integral: ComplexArray  # (s + 2,)
    values: ComplexArray  # (s,)
    coefficient: FloatArray  # (s, c) coefficients of the excess as a power series
    term: FloatArray  # (2 m,) term of the amplitudes' power series
    shares: FloatArray  # (n, 2 n) (I + S F)⁻¹ S: sensitivity of the forces to compressions and rates
    force_rows: FloatArray  # (n, 2 m) sensitivity of the forces; (0, 2 m) without disturbances, as the next two
    end_response: FloatArray  # (n, 2 m) response of the amplitudes at the end to the forces
    decay: FloatArray  # (2, m) decay of the disturbances
    moved: FloatArray  # (n,)
    active: IntArray  # (n,) rows of forces that disturbances change


def element_work(m: int, s: int, c: int, *, varied: bool = False) -> Work:
    """Scratch arrays for elements of some shape, and for their disturbances."""
    n = s * c
    rows = n if varied else 0
    return Work(
        base=np.zeros(2 * n),
        excess=np.zeros(n),
        move=np.zeros(n),
        slope=np.zeros(n),
        rate_slope=np.zeros(n),
        delta=np.zeros((s + 2, c)),
        rate=np.zeros((s + 2, c)),
        looked=np.zeros((4, c)),
        laws=np.zeros((n + 2 * c + 1, 6)),
        matrix=np.zeros((n, n)),
        right=np.zeros((n, 1)),
        end=np.zeros(2 * m),
        end_error=np.zeros(2 * m),
        measure=np.zeros(2),
        cut_decay=np.zeros((1, 2, m)),
        cut_source=np.zeros((1, n, 2 * m)),
        integral=np.zeros(s + 2, dtype=np.complex128),
        values=np.zeros(s, dtype=np.complex128),
        coefficient=np.zeros((s, c)),
        term=np.zeros(2 * m),
        shares=np.zeros((rows, 2 * n)),
        force_rows=np.zeros((rows, 2 * m)),
        end_response=np.zeros((rows, 2 * m)),
        decay=np.zeros((2, m)),
        moved=np.zeros(n),
        active=np.zeros(n, dtype=np.int64),
    )
