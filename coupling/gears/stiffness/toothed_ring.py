r"""Ring of an internal gear under its teeth: an exact elastic ring with all its elastic teeth, and its support.

The ring between the root circle (radius 1 here) and its outside is that of
:mod:`gearwhine.coupling.gears.stiffness.elastic_ring`. The roots of internal teeth cover most of the root circle,
and they stiffen the rim between them: in its dent under a loaded tooth, and in its bending between bolts. So each of
the z teeth has tractions on its root arc here, with the resultants of its load: none of an unloaded tooth. Under what
they are besides these the tooth is elastic (:mod:`gearwhine.coupling.gears.stiffness.elastic_tooth`): of the
rims of 1.6 and 3.3 modules between six bolts that were tried (tests/validation), rigid arcs would make the teeth 20 to
30 % too stiff, and a smooth rim 15 to 40 % too soft.

Teeth are alike and stand at equal angles ``t_l = 2 pi l / z``. Tractions ``x_l`` (coefficients of their shapes) with
``x_l = 1/z sum_k X_k e^{i k t_l}`` have the waves n = k, k ± z, k ± 2 z, ... around the ring alone. With ``w_n`` the
waves of the shapes, H_n the ring's flexibility, Hermitian in this form, and T that of a tooth, their energy is

    1/2 sum_k X_k^H A_k X_k,     A_k = 1/(2 pi) sum_(n = k mod z) w_n^H H_n w_n + T / z,

and the tractions of least energy (Castigliano) with the resultants ``R X_k = F_k`` have

    1/2 sum_k F_k^H M_k F_k,     M_k = (R A_k^-1 R^T)^-1.

A load on one tooth has the same F_k for all k: the flexibility of a tooth's root is ``sum_k M_k``, and that between a
tooth and the next one ``sum_k M_k e^{-2 pi i k / z}``.

*Support.* A clamped outside, or one on an elastic bed, is in H_n. Bolts hold a ring that is free outside: their seats
are rigid arcs too, with tractions q of least energy that hold the ring still there. With ``v_n`` the waves of their
tractions the energy is

    sum_k (1/2 X_k^H A_k X_k + Re X_k^H B_k q) + 1/2 q^T D q,

A, B and D of the blocks of H_n between the two circles, under the three conditions of equilibrium of all loads. The
free ring moves as a rigid body, without energy; H_0 and H_1 are taken for balanced loads. The compliance of the bolts
adds to D; a bolt of radial stiffness k_r on a seat of width w resists the seat's rotation with ``k_r w^2 / 12``. A pin
transmits no moment: the mean motion of its seat is held alone.

The compliance of a tooth then depends on its place between the bolts; the teeth pass them as the ring turns against the
load. The mean over all places enters the stiffness of the mesh,
`gearwhine.coupling.gears.stiffness.ring_body.support_compliance` gives its course.

Planetary gears' rings were so far mostly curved beams on elastic supports (Chen and Shao, Mechanism and Machine Theory
62, 2013); a ring as thick as a tooth is no beam. Finite elements of whole rings (tests/validation) are the reference.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears.stiffness.elastic_ring import (
    Annulus,
    arc_waves,
    breathing_flexibility,
    last_wave,
    ring_fields,
    twist_flexibility,
    wave_flexibility,
)
from gearwhine.coupling.gears.stiffness.elastic_tooth import tooth_flexibility
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_PLACES = 24
"""Places of a tooth between two bolts at which its compliance is solved."""
_FADED = 25.0
"""A wave n with n ln(outer / inner) above this has decayed to 1e-11 at the other circle."""
_HERMITIAN = np.array([1.0, 1j, 1.0, 1j])
"""Factors of (radial, tangential) quantities on both circles, since tangential waves are a quarter wave behind."""


@dataclass(frozen=True)
class RingSection:
    """A ring, its teeth and its support, in root circle radii.

    Attributes
    ----------
    teeth : int
    half_angle : float
        Half angle of a tooth on the root circle [rad].
    outside : float
        Radius of the outside.
    outline : tuple of (float, float)
        Radii and half angles of a tooth's outline from the root circle to the tip.
    poisson_ratio, kappa : float
        Poisson's ratio, and Kolosov's constant.
    bed : tuple of float
        Radial and tangential displacement of the outside, times E, under a traction of 1; a clamped one has none.
    bolts : int
        Number of bolts; 0 for a ring that is held all around.
    seat : float
        Half angle of a bolt's seat [rad].
    bolt : tuple of float
        Radial and tangential compliance of a bolt, times E and width.
    pinned : bool
        Whether the bolts carry no moment.
    """

    teeth: int
    half_angle: float
    outside: float
    outline: tuple[tuple[float, float], ...]
    poisson_ratio: float
    kappa: float
    bed: tuple[float, float] = (0.0, 0.0)
    bolts: int = 0
    seat: float = 0.0
    bolt: tuple[float, float] = (0.0, 0.0)
    pinned: bool = False


@dataclass(frozen=True, eq=False)
class RingFlexibility:
    """Flexibility of a ring's root arcs, times E and width, at places of the loaded tooth between two bolts.

    Loads and motions are (force across the tooth's axis, torque about the centre over the root radius, force outward).

    Attributes
    ----------
    own, beside : ndarray, shape (places, 3, 3)
        Of a tooth, and between it and the next one in the sense of the force across (row: this tooth's motion; column:
        the next one's load); at equal steps from a bolt to the next one, or at a single place of a ring that is held
        all around.
    twist, shift : float
        Of the whole root circle: rotation times the radius, and displacement, under a tangential force and under a
        force across the shaft, spread over all teeth.
    """

    own: FloatArray
    beside: FloatArray
    twist: float
    shift: float


@lru_cache(maxsize=32)
def ring_flexibility(section: RingSection) -> RingFlexibility:
    """Solve the flexibility of a ring with all its teeth."""
    z = section.teeth
    turns = -(-last_wave(min(section.half_angle, section.seat or section.half_angle)) // z)
    ring = _free_ring(section, turns * z) if section.bolts else _held_ring(section, turns * z)
    shapes = _two_sided(arc_waves(section.half_angle, turns * z), z)
    resultants = _resultants(shapes[turns, 1], section.half_angle)
    energy = _energy(shapes, _two_sided(ring[:, :2, :2], z), section.half_angle)
    radius, half_angle = np.array(section.outline).T
    energy = energy + tooth_flexibility(radius, half_angle, section.kappa, resultants) / z
    softness = np.linalg.inv(energy).astype(np.complex128)
    stiff = np.linalg.inv(resultants @ softness @ resultants.T).astype(np.complex128)
    loads = _loads(z)
    moved = stiff @ loads
    flexibility = np.einsum("kic,kid->cd", loads.conj(), moved).real[None]
    if section.bolts:
        flexibility = flexibility + _by_bolts(section, ring, shapes, softness @ resultants.T, stiff, softness)
    flexibility = (1.0 + section.poisson_ratio) * flexibility
    twist, shift = np.mean(flexibility[:, [6, 7], [6, 7]], axis=0).tolist()
    return RingFlexibility(flexibility[:, :3, :3], flexibility[:, :3, 3:6], twist, shift)


def _loads(teeth: int) -> ComplexArray:
    """Return the loads F_k, (k, 3, 8): three on tooth 0 and three on the next, a torque and a force on all."""
    loads = np.zeros((teeth, 3, 8), dtype=np.complex128)
    loads[:, :, :3] = np.eye(3)
    loads[:, :, 3:6] = np.exp(-2j * math.pi / teeth * np.arange(teeth))[:, None, None] * np.eye(3)
    loads[0, :2, 6] = 1.0
    loads[1, :, 7] = 0.5j, 0.5j, 0.5
    loads[-1, :, 7] = loads[1, :, 7].conj()
    return loads


def _two_sided(values: npt.NDArray[np.inexact], teeth: int) -> ComplexArray:
    """Waves of either sign from those of n = 0 ... `turns` z, shape (2 turns, teeth, ...): n = (row - turns) z + k."""
    both = np.concatenate([values[:0:-1].conj(), values[:-1]])
    return both.reshape(-1, teeth, *values.shape[1:]).astype(np.complex128)


def _energy(shapes: ComplexArray, flexibility: ComplexArray, half_angle: float) -> ComplexArray:
    """Energy of an arc's tractions, radial shapes first, for waves (q, k): (k, shapes, shapes), that of waves n = k."""
    turns, teeth, count = shapes.shape[0] // 2, *shapes.shape[1:]
    moved = np.einsum("qkab,qkj->qkabj", flexibility, shapes)
    energy = np.einsum("qki,qkabj->kaibj", shapes.conj(), moved) / (2.0 * math.pi)
    # Beyond, J_k J_l averages to 1 / (pi n theta) and the flexibility falls as 1/n, in waves of the arc alone.
    last = turns * teeth
    alike = (np.add.outer(np.arange(count), np.arange(count)) % 2 == 0) / teeth
    for a in (0, 1):
        energy[:, a, :, a] += half_angle * last / (last + 0.5) * flexibility[0, 0, a, a].real * alike
    return np.asarray(energy.reshape(teeth, 2 * count, 2 * count), dtype=np.complex128)


def _resultants(first: ComplexArray, half_angle: float, radius: float = 1.0) -> FloatArray:
    """Resultants (across, torque, along) of an arc's shapes from their wave 1, radial shapes first, (3, shapes)."""
    whole = np.zeros(first.size)
    whole[0] = math.pi * half_angle * radius
    rows = [(-first.imag, first.real), (np.zeros(first.size), whole), (first.real, first.imag)]
    return np.array([np.concatenate(row) for row in rows])


def _held_ring(section: RingSection, last: int) -> ComplexArray:
    """Hermitian flexibility of the root circle of a ring that is held all around, n = 0 ... `last`, (n, 2, 2)."""
    # Displacements are times 2 mu there.
    radial, tangential = (each / (1.0 + section.poisson_ratio) for each in section.bed)
    rings = (Annulus(section.outside, 1.0, 1.0, (radial, tangential)),)
    flexibility = np.zeros((last + 1, 2, 2))
    flexibility[0] = np.diag([breathing_flexibility(rings, section.kappa), twist_flexibility(rings)])
    for waves in (np.array([1]), np.arange(2, last + 1)):
        flexibility[waves] = wave_flexibility(rings, waves, section.kappa)
    return np.asarray(flexibility * np.outer(_HERMITIAN[:2].conj(), _HERMITIAN[:2]), dtype=np.complex128)


def _free_ring(section: RingSection, last: int) -> ComplexArray:
    """Hermitian flexibility of a free ring, loads per angle on the root circle and the outside, (n, 4, 4)."""
    ring = Annulus(section.outside, 1.0, 1.0)
    flexibility = np.zeros((last + 1, 4, 4))
    for waves in (np.array([1]), np.arange(2, last + 1)):
        inside, outside = (ring_fields(radius, ring, waves, section.kappa) for radius in (1.0, section.outside))
        motion = np.concatenate([inside[0], outside[0]], axis=1)
        load = np.concatenate([-inside[1], section.outside * outside[1]], axis=1)
        if waves[0] > 1:
            flexibility[waves] = motion @ np.linalg.inv(load)
    # Wave 1 balances a force on one circle by one on the other: a rigid motion works on none of its loads.
    rigid = np.array([1.0, -1.0, 1.0, -1.0])
    balanced = np.eye(4) - np.outer(rigid, rigid) / 4.0
    inside, outside = (ring_fields(radius, ring, np.array([1]), section.kappa) for radius in (1.0, section.outside))
    motion, load = np.vstack([inside[0][0], outside[0][0]]), np.vstack([-inside[1][0], section.outside * outside[1][0]])
    flexibility[1] = balanced @ motion @ np.linalg.pinv(load) @ balanced
    # Wave 0: breathing, and a torque on one circle by one on the other.
    kappa, around = section.kappa, section.outside
    motion = np.array([[kappa - 1.0, -1.0], [(kappa - 1.0) * around, -1.0 / around]])
    load = np.array([[-2.0, -1.0], [2.0 * around, 1.0 / around]])
    flexibility[0, ::2, ::2] = motion @ np.linalg.inv(load)
    flexibility[0, 1, 1] = 1.0 - around**-2
    return np.asarray(flexibility * np.outer(_HERMITIAN.conj(), _HERMITIAN), dtype=np.complex128)


def _by_bolts(
    section: RingSection,
    ring: ComplexArray,
    shapes: ComplexArray,
    lever: ComplexArray,
    stiff: ComplexArray,
    softness: ComplexArray,
) -> FloatArray:
    """Return what bolts add to the flexibility of the free ring under `_loads`, (places, 8, 8)."""
    z, bolts, around = section.teeth, section.bolts, section.outside
    turns = shapes.shape[0] // 2
    number = (np.arange(2 * turns)[:, None] - turns) * z + np.arange(z)
    seat = _two_sided(arc_waves(section.seat, turns * z)[:, : 1 if section.pinned else None], z)
    unknowns = 2 * seat.shape[2]
    whole = _two_sided(ring, z)
    # Waves that reach from one circle to the other.
    reach = min(turns, math.ceil(_FADED / (z * math.log(around))) + 1)
    near = slice(turns - reach, turns + reach)
    across = np.einsum("qki,qkab,qkj->kaibjq", shapes[near].conj(), whole[near, :, :2, 2:], seat[near])
    across = across.reshape(z, -1, 2 * reach) / (2.0 * math.pi)
    # Between the bolts.
    places = 2.0 * math.pi / bolts * np.arange(bolts)
    moved = np.einsum("qki,qkab,qkj->aibjqk", seat.conj(), whole[:, :, 2:, 2:], seat, optimize=True)
    apart = moved.reshape(unknowns**2, -1) @ np.exp(1j * np.outer(number.ravel(), places)) / (2.0 * math.pi)
    apart = apart.real.reshape(unknowns, unknowns, bolts)
    own = _energy(seat, whole[:, :, 2:, 2:], section.seat).sum(axis=0).real
    among = np.zeros((bolts, unknowns, bolts, unknowns))
    holding = _resultants(seat[turns, 1], section.seat, around)
    # Radial and tangential force, and moment about the seat, whose stiffness is even over its width w: k_r w^2 / 12.
    forces = np.array([holding[2], holding[0], holding[1] - around * holding[0]])
    softnesses = np.array([*section.bolt, 12.0 * section.bolt[0] / (2.0 * section.seat * around) ** 2])
    yielding = forces.T @ (softnesses[:, None] * forces) / (1.0 + section.poisson_ratio)
    for first in range(bolts):
        for second in range(bolts):
            same = first == second
            among[first, :, second] = own + yielding if same else apart[:, :, (first - second) % bolts]
    among = among.reshape(bolts * unknowns, -1)
    lifted = np.swapaxes(lever.conj(), 1, 2)
    to_teeth = np.concatenate(list(_loads(z).conj().swapaxes(1, 2) @ stiff @ lifted), axis=1)
    inner = lever @ stiff @ lifted - softness
    pitch = 2.0 * math.pi / z
    on_teeth = np.column_stack([_balance(np.eye(3), 0.0), _balance(np.eye(3), pitch), [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    added = []
    for place in 2.0 * math.pi / bolts / _PLACES * np.arange(_PLACES):
        at = places - place
        phases = np.exp(-1j * number[near].T[:, :, None] * at)
        coupling = (across @ phases).reshape(z, 2 * shapes.shape[2], unknowns, bolts).swapaxes(2, 3)
        coupling = coupling.reshape(z, 2 * shapes.shape[2], -1)
        flat = coupling.reshape(-1, coupling.shape[-1])
        to_loads = (to_teeth @ flat).real
        seats = among + (flat.conj().T @ (inner @ coupling).reshape(flat.shape)).real
        held = np.hstack([_balance(holding, angle) for angle in at])
        matrix = np.block([[seats, held.T], [held, np.zeros((3, 3))]])
        right = np.vstack([to_loads.T, on_teeth])
        added.append(-right.T @ np.linalg.solve(matrix, right))
    return np.array(added)


def _balance(resultants: FloatArray, angle: float) -> FloatArray:
    """Force along x and y and torque of (across, torque, along) on an arc at an angle from x [rad]."""
    across, torque, along = resultants
    return np.array(
        [
            along * math.cos(angle) - across * math.sin(angle),
            along * math.sin(angle) + across * math.cos(angle),
            torque,
        ]
    )
