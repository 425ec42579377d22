r"""Exact elastic ring under the root arcs of teeth.

The body is a flat ring between the root circle (radius 1 here) and a circle where it is held.  Tractions on the root
circle are split into waves ``n`` around it.  In one wave the displacements are combinations of powers of ``r`` that
follow from the complex potentials ``z^k`` (Kolosov; Muskhelishvili 1953), with ``kappa = (3 - nu)/(1 + nu)`` in plane
stress, ``3 - 4 nu`` in plane strain:

    2 mu (u_r + i u_t) = e^{-i t} (kappa phi(z) - z conj(phi'(z)) - conj(psi(z)))
    s_r - i s_rt       = phi' + conj(phi') - e^{2 i t} (conj(z) phi'' + psi')

so that each wave has four coefficients: two conditions at the held circle, two at the root circle.  A rim on a thinner
web is two such rings, one in the other: the flexibility of the web at its outer circle is the condition at the rim's
inner one.

The tooth stands on the arc ``|t| < theta``.  A beam's sections stay plane, so the arc moves as a rigid one, and the
tractions under it are those that make the energy least among all that carry the load (Castigliano): those of a rigid
stamp.  They are sought as ``T_k(t/theta) / sqrt(1 - (t/theta)^2)``, whose waves are Bessel functions,
``pi theta J_k(n theta)``; a few terms give all digits that matter.

The arc of another tooth, an angle away on the same ring, moves with the ring.  Tractions ``s`` of waves ``s_n`` shifted
by the angle D do the work ``1/pi sum_n Re(conj(s_n) H_n s'_n e^{-i n D})`` on the displacement of the tractions ``s'``,
H_n the wave's flexibility, Hermitian in this form.  With the tractions of each arc alone this is the cross flexibility
of two teeth; with the flexibility of each it is the energy of real tractions, so positive definite.

An internal gear is the same ring turned inside out: its root circle, of radius 1, is the inside, and it is held at its
outside. Tractions on an inner circle are the stresses there with the other sign; all else stands. The outside may lie
on an elastic bed, whose displacement under the ring's tractions is the condition there; bolts are in
:mod:`gearwhine.coupling.gears.stiffness.toothed_ring`. Lengths and angles are positive here, whatever the sign of the
gear's radii.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray

_SHAPES = 8
"""Chebyshev polynomials in each traction: the compliance is within 1e-4 of its limit."""
_WAVES_ACROSS = 60.0
"""Value n theta of the last wave that is summed; shorter waves act on a half plane and are summed in closed form."""

_POINTS = 100
"""Points of quadrature on the arc, an even number, enough beyond `_WAVES_ACROSS` for all digits."""
_FADED = 25.0
"""A wave n with n ln(outer / inner) above this has decayed to 1e-11 at the inside."""


@dataclass(frozen=True)
class Annulus:
    """A flat ring of one width.

    Attributes
    ----------
    held, loaded : float
        Radii of the circle towards the place where the body is held and of that towards the teeth, in root circle
        radii: inside and outside of an external gear's ring, outside and inside of an internal one's.
    width : float
        Width, in the unit of the other rings' widths.
    bed : tuple of float
        Radial and tangential displacement (times 2 mu) of the held circle under a traction of 1 on what holds it; zero
        where another ring does, or nothing yields.
    """

    held: float
    loaded: float
    width: float
    bed: tuple[float, float] = (0.0, 0.0)

    @property
    def sign(self) -> float:
        """Sign of the loaded circle's outward normal along r: 1 of an external gear, -1 of an internal one."""
        return 1.0 if self.loaded > self.held else -1.0


@dataclass(frozen=True, eq=False)
class RootFlexibility:
    """Flexibility of the rigid root arc, times E and width.

    Attributes
    ----------
    lateral : ndarray, shape (2, 2)
        Flexibility under (force across the tooth's axis, torque about the gear's centre over root radius).
    radial : float
        Flexibility under a force along the tooth's axis.
    """

    lateral: FloatArray
    radial: float


@dataclass(frozen=True, eq=False)
class RootStamp:
    """The tractions under a rigid root arc, for unit resultants (across, torque, along).

    Attributes
    ----------
    waves : ndarray of complex, shape (3, n, 2)
        ``int s e^{-i n t} dt`` of the radial and the tangential traction, n = 1, 2, ...
    uniform : ndarray, shape (3, 2)
        The integral for n = 0.
    flexibility : ndarray, shape (n, 2, 2)
        Flexibility of each wave, see `wave_flexibility`.
    even : ndarray, shape (2,)
        Breathing and twist: displacement under uniform tractions.
    own : RootFlexibility
    """

    waves: npt.NDArray[np.complex128]
    uniform: FloatArray
    flexibility: FloatArray
    even: FloatArray
    own: RootFlexibility


def root_flexibility(
    rings: tuple[Annulus, ...], half_angle: float, poisson_ratio: float, kappa: float
) -> RootFlexibility:
    """Flexibility of the arc that one tooth stands on.

    Parameters
    ----------
    rings : tuple of Annulus
        Rings from the held circle outward, each beginning where the last ends; the last ends at the root circle, 1.
    half_angle : float
        Half angle of the tooth on the root circle [rad].
    poisson_ratio, kappa : float
        Poisson's ratio of the material, and Kolosov's constant.

    Returns
    -------
    RootFlexibility
    """
    return root_stamp(rings, half_angle, poisson_ratio, kappa).own


def neighbour_flexibility(
    rings: tuple[Annulus, ...], half_angle: float, poisson_ratio: float, kappa: float, angle: float
) -> FloatArray:
    """Motion of one root arc under loads on another one of the same ring, times E and width.

    Parameters
    ----------
    rings, half_angle, poisson_ratio, kappa
        As for `root_flexibility`.
    angle : float
        Angle from the middle of the first arc to that of the second [rad], in the sense of the force across.

    Returns
    -------
    ndarray, shape (3, 3)
        Row: motion of the first arc in the sense of (force across the tooth's axis, torque about the gear's centre over
        root radius, force outward along the axis); column: these loads on the second arc.
    """
    stamp = root_stamp(rings, half_angle, poisson_ratio, kappa)
    numbers = np.arange(1, stamp.waves.shape[1] + 1)
    hermitian = stamp.flexibility.astype(np.complex128)
    hermitian[:, 0, 1] *= 1j
    hermitian[:, 1, 0] *= -1j
    moved = np.einsum("nab,jnb,n->jna", hermitian, stamp.waves, np.exp(-1j * numbers * angle))
    work = np.einsum("ina,jna->ij", stamp.waves.conj(), moved).real / math.pi
    work += (stamp.uniform * stamp.even) @ stamp.uniform.T / (2.0 * math.pi)
    return np.asarray((1.0 + poisson_ratio) * work, dtype=np.float64)


@lru_cache(maxsize=16)
def root_stamp(rings: tuple[Annulus, ...], half_angle: float, poisson_ratio: float, kappa: float) -> RootStamp:
    """Solve the rigid stamp on a ring."""
    last = last_wave(half_angle)
    waves = np.arange(1, last + 1)
    # Waves much shorter than the thickness of the outermost ring do not reach its inside.
    deep = math.ceil(_FADED / abs(math.log(rings[-1].loaded / rings[-1].held)))
    flexibility = np.concatenate(
        [
            wave_flexibility(rings, waves[:1], kappa),
            wave_flexibility(rings, waves[1:deep], kappa),
            _short_wave_flexibility(waves[max(1, deep) :], kappa, rings[-1].sign),
        ]
    )
    even, odd = np.arange(0, _SHAPES, 2), np.arange(1, _SHAPES, 2)
    content = _arc_content(half_angle, last)
    # Beyond, J_k J_l averages to +-1 / (pi n theta) and the flexibility falls as 1/n: all terms of a block alike.
    tail = half_angle * last / (last + 0.5) * np.diagonal(flexibility[-1])
    twist, breathing = twist_flexibility(rings), breathing_flexibility(rings, kappa)
    # Across the axis: radial tractions odd, tangential ones even.  Shifted by a quarter wave, tangential changes sign.
    lateral = _energy(content[1], content[0], flexibility, -1.0, tail)
    whole = np.where(even == 0, math.pi * half_angle, 0.0)
    lateral[odd.size :, odd.size :] += np.outer(whole, whole) / (2.0 * math.pi) * twist
    radial = _energy(content[0], content[1], flexibility, 1.0, tail)
    radial[: even.size, : even.size] += np.outer(whole, whole) / (2.0 * math.pi) * breathing
    first_even, first_odd = content[0][:, 0], content[1][:, 0]
    across = np.array([np.concatenate([first_odd, first_even]), np.concatenate([np.zeros(odd.size), whole])])
    along = np.concatenate([first_even, -first_odd])[None, :]
    scale = 1.0 + poisson_ratio  # E / (2 mu)
    least, sideways = _least_work(lateral, across)
    outward, upright = _least_work(radial, along)
    lateral_flexibility = np.asarray(scale * least, dtype=np.float64)
    lateral_flexibility.setflags(write=False)
    # Of even shapes e^{-i n t} leaves the cosine, of odd ones -i times the sine; across the axis the radial are odd.
    waves = np.array(
        [
            *([-1j * tractions[: odd.size] @ content[1], tractions[odd.size :] @ content[0]] for tractions in sideways),
            [upright[0, : even.size] @ content[0], -1j * upright[0, even.size :] @ content[1]],
        ]
    )
    uniform = np.zeros((3, 2))
    uniform[:2, 1], uniform[2, 0] = sideways[:, odd.size :] @ whole, upright[0, : even.size] @ whole
    return RootStamp(
        waves=np.ascontiguousarray(waves.swapaxes(1, 2), dtype=np.complex128),
        uniform=uniform,
        flexibility=flexibility,
        even=np.array([breathing, twist]),
        own=RootFlexibility(lateral=lateral_flexibility, radial=float(scale * outward[0, 0])),
    )


def last_wave(half_angle: float) -> int:
    """Return the number of the last wave that is summed under tractions on an arc."""
    return math.ceil(_WAVES_ACROSS / half_angle)


def _arc_content(half_angle: float, last: int) -> list[FloatArray]:
    """``int f_k cos(n t) dt`` for even k and ``int f_k sin(n t) dt`` for odd k, n = 1 ... `last`, each (k, n)."""
    # By Gauss and Chebyshev: many times faster than jv. Shape times wave is even in t, so half the points do.
    even, odd = np.arange(0, _SHAPES, 2), np.arange(1, _SHAPES, 2)
    phase = math.pi * (np.arange(_POINTS // 2) + 0.5) / _POINTS
    turns, weight = _multiples(last, half_angle * np.cos(phase)), 2.0 * math.pi * half_angle / _POINTS
    return [
        weight * np.cos(np.outer(even, phase)) @ turns.real.T,
        weight * np.cos(np.outer(odd, phase)) @ turns.imag.T,
    ]


def arc_waves(half_angle: float, last: int) -> npt.NDArray[np.complex128]:
    """Waves ``int f_k e^{-i n t} dt`` of the shapes of a traction on an arc, n = 0 ... `last`, (waves, shapes)."""
    waves = np.zeros((last + 1, _SHAPES), dtype=np.complex128)
    waves[0, 0] = math.pi * half_angle
    waves[1:, 0::2], waves[1:, 1::2] = (part.T for part in _arc_content(half_angle, last))
    waves[:, 1::2] *= -1j
    return waves


def _multiples(last: int, angle: FloatArray) -> npt.NDArray[np.complex128]:
    """``e^{i n angle}`` for n = 1 ... `last`, (last, points), as products of few exponentials."""
    few = math.ceil(math.sqrt(last))
    ones, tens = np.outer(np.arange(1, few + 1), angle), np.outer(few * np.arange(few), angle)
    turns = np.exp(1j * tens)[:, None] * np.exp(1j * ones)
    return np.asarray(turns.reshape(-1, angle.size)[:last], dtype=np.complex128)


def _energy(
    radial: FloatArray, tangential: FloatArray, flexibility: FloatArray, sign: float, tail: FloatArray
) -> FloatArray:
    """Work of each traction on each other's displacement, radial shapes first, waves of n >= 1."""
    blocks = [
        [np.einsum("in,n,jn->ij", a, flexibility[:, i, j], b) / math.pi for j, b in enumerate((radial, tangential))]
        for i, a in enumerate((radial, tangential))
    ]
    return np.block([[blocks[0][0] + tail[0], sign * blocks[0][1]], [sign * blocks[1][0], blocks[1][1] + tail[1]]])


def _least_work(energy: FloatArray, resultants: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Flexibility (r, r) under r resultants with the tractions of least energy, and those of unit resultants (r, k)."""
    free = np.linalg.solve(energy, resultants.T)
    flexibility = np.asarray(np.linalg.inv(resultants @ free), dtype=np.float64)
    return flexibility, np.asarray((free @ flexibility).T, dtype=np.float64)


def root_motion(rings: tuple[Annulus, ...], wave: int, kappa: float, tractions: FloatArray) -> FloatArray:
    """Displacement (u_r, u_t) of the root circle, times 2 mu, under (s_r cos n t, s_rt sin n t) on it, n from 1."""
    return np.asarray(wave_flexibility(rings, np.array([wave]), kappa)[0] @ tractions)


def ring_motions(
    rings: tuple[Annulus, ...], wave: int, kappa: float, tractions: FloatArray, places: Sequence[FloatArray]
) -> list[FloatArray]:
    """Displacement (u_r, u_t) within each ring, times 2 mu, under (s_r cos n t, s_rt sin n t) on the root circle.

    Parameters
    ----------
    rings, kappa
        As for `root_flexibility`.
    wave : int
        n, from 1.
    tractions : ndarray, shape (2,)
        s_r and s_rt.
    places : sequence of ndarray
        Radii in each of the rings, in root circle radii.

    Returns
    -------
    list of ndarray, shape (places, 2) each
    """
    n, load, motions = np.array([wave]), np.asarray(tractions, dtype=np.float64), list[FloatArray]()
    for number in range(len(rings) - 1, -1, -1):
        ring, inside = rings[number], rings[:number]
        support = wave_flexibility(inside, n, kappa) if inside else np.diag(ring.bed)[None]
        ratio = ring.width / inside[-1].width if inside else 1.0
        motion, stress = ring_fields(ring.held, ring, n, kappa)
        stress = ring.sign * stress
        loaded = ring.sign * ring_fields(ring.loaded, ring, n, kappa)[1]
        conditions = np.vstack([(motion - ratio * support @ stress)[0], loaded[0]])
        solution = np.linalg.solve(conditions, np.concatenate([np.zeros(2), load]))
        motions.append(np.array([ring_fields(r, ring, n, kappa)[0][0] @ solution for r in places[number].tolist()]))
        load = ratio * stress[0] @ solution
    return motions[::-1]


def wave_flexibility(rings: tuple[Annulus, ...], waves: npt.NDArray[np.int64], kappa: float) -> FloatArray:
    """Displacement (u_r, u_t), times 2 mu, under unit tractions (s_r cos n t, s_rt sin n t) on the last ring.

    Shape (waves, 2, 2).
    """
    support = np.broadcast_to(np.diag(rings[0].bed), (waves.size, 2, 2))
    for ring, inside in zip(rings, (None, *rings[:-1]), strict=True):
        held_motion, held_stress = ring_fields(ring.held, ring, waves, kappa)
        motion, stress = ring_fields(ring.loaded, ring, waves, kappa)
        ratio = 1.0 if inside is None else ring.width / inside.width
        support_conditions = held_motion - ratio * support @ (ring.sign * held_stress)
        conditions = np.concatenate([support_conditions, ring.sign * stress], axis=1)
        loads = np.broadcast_to(np.vstack([np.zeros((2, 2)), np.eye(2)]), (waves.size, 4, 2))
        support = motion @ np.linalg.solve(conditions, loads)
    return support


def _short_wave_flexibility(waves: npt.NDArray[np.int64], kappa: float, sign: float = 1.0) -> FloatArray:
    """`wave_flexibility` of a full disc of radius 1, of the growing solutions alone, or of a plane with such a hole.

    Around a hole (sign -1) the solutions are z^(1-n) and z^(-n-1): those of the disc with -n for n, where the sines and
    the tractions change their signs.
    """
    n = sign * waves.astype(np.float64)
    # Rows: weights of z^(n+1) and z^(n-1) under each traction, from the inverse of their two tractions.
    determinant = 2.0 * (n**2 - 1.0)
    first = np.array([n - 1.0, n - 1.0]) / determinant
    second = np.array([-(n + 1.0) * n, (n + 1.0) * (2.0 - n)]) / determinant
    radial = (kappa - n - 1.0) * first - second
    tangential = (kappa + n + 1.0) * first + second
    flexibility = np.moveaxis(np.array([radial, tangential]), 2, 0)
    return flexibility if sign > 0.0 else flexibility * np.array([[-1.0, 1.0], [1.0, -1.0]])


def ring_fields(
    radius: float, ring: Annulus, waves: npt.NDArray[np.int64], kappa: float
) -> tuple[FloatArray, FloatArray]:
    """Displacements and stresses of the four solutions of a wave at `radius`, each shape (waves, 2, 4).

    Two grow outward and are one at the ring's outside, two fade outward and are one at its inside, so that no power
    overflows.
    """
    n = waves.astype(np.float64)
    ones, zeros = np.ones_like(n), np.zeros_like(n)
    outward, inward = radius / max(ring.held, ring.loaded), min(ring.held, ring.loaded) / radius
    grow, fade = outward**n, inward**n
    r = radius
    if waves.size == 1 and waves[0] == 1:
        # z^0 is the rigid-body motion of the ring, and the resultant force of wave 1 needs a logarithm.
        log, inside = math.log(outward), inward**2
        columns = [
            _potential(2.0 * ones, grow * outward, grow * outward / r, kappa, 1.0),
            (
                (2.0 * kappa * log - 1.0) * ones,
                -(2.0 * kappa * log + 1.0) * ones,
                (3.0 + kappa) / r * ones,
                (1.0 - kappa) / r * ones,
            ),
            (-inside * ones, -inside * ones, 2.0 * inside / r * ones, 2.0 * inside / r * ones),
            (ones, -ones, zeros, zeros),
        ]
    else:
        columns = [
            _potential(n + 1.0, grow * outward, grow * outward / r, kappa, 1.0),
            _potential(1.0 - n, fade / inward, fade / inward / r, kappa, -1.0),
            (-grow / outward, grow / outward, -(n - 1.0) * grow / outward / r, (n - 1.0) * grow / outward / r),
            (-fade * inward, -fade * inward, (n + 1.0) * fade * inward / r, (n + 1.0) * fade * inward / r),
        ]
    table = np.moveaxis(np.array(columns), 0, -1)  # (4 quantities, waves, 4 solutions)
    return np.moveaxis(table[:2], 0, 1), np.moveaxis(table[2:], 0, 1)


def _potential(
    k: FloatArray, power: FloatArray, rate: FloatArray, kappa: float, side: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Fields of ``phi = z^k``: `power` is r^k, `rate` r^(k-1), `side` +1 for k > 0 and -1 for k < 0."""
    return (kappa - k) * power, side * (kappa + k) * power, k * (3.0 - k) * rate, side * k * (k - 1.0) * rate


def twist_flexibility(rings: tuple[Annulus, ...]) -> float:
    """Rotation of the root circle (times 2 mu) under a uniform tangential traction 1 on it."""
    outermost, first = rings[-1].width, rings[0]
    elastic = sum(outermost / ring.width * abs(ring.held**-2 - ring.loaded**-2) for ring in rings)
    return elastic + outermost / first.width * first.bed[1] / first.held**3


def breathing_flexibility(rings: tuple[Annulus, ...], kappa: float) -> float:
    """Radial displacement of the root circle (times 2 mu) under a uniform radial traction 1 on it."""
    support, width = rings[0].bed[0], rings[0].width
    for ring in rings:
        a, b = ring.held, ring.loaded
        held_condition = np.array([(kappa - 1.0) * a, -1.0 / a]) - ring.width / width * support * ring.sign * np.array(
            [2.0, a**-2]
        )
        amplitude = np.linalg.solve(np.array([held_condition, [2.0, b**-2]]), np.array([0.0, ring.sign]))
        support, width = float(np.array([(kappa - 1.0) * b, -1.0 / b]) @ amplitude), ring.width
    return support
