r"""Load distribution across the face of a gear: a tooth pair as coupled slices (thin-slice model with shear coupling).

Where the flanks are not alike across the face (helical, crowned, misaligned), the load spreads along the contact
line as the teeth yield. The face of width b is cut into slices at places z, each with its own position on the path
of contact, ``s + eps_beta z / b``, and its own gap. The deflection ``w(z)`` of both teeth and their bodies is
that of a foundation with shear stiffness (Pasternak's; for gears: Ajmi and Velex, Mech. Mach. Theory 40, 2005),

    k_b w - T w'' = q,        w' = 0 at the ends of the face,

with q the load per width, k_b the stiffness of the teeth per width without the flattening of their contact, and T
their coupling; contact adds, wherever there is any,

    q = k_h (delta - gap - w) >= 0,

k_h the stiffness of the flattening per width. So a loaded slice deflects its neighbours, and the free ends of a
tooth are softer. Uniform across the face it is the spur gear's law exactly.

A given spring knows no teeth that could deflect their neighbours: its slices have no coupling, T = 0, and each acts
with the part of it that lies on the path of contact. The force of such a pair is then in proportion to the length of
its contact line, without steps as slices come into touch.

T is that of both teeth in series, each of them from the shear coupling of neighbouring slices.

The gap of a planet's mesh swings as the carrier turns, slowly beside the mesh frequency. About the compression that its
load has at each angle the mesh is another spring: what acts on lines at the mesh harmonics is the mean of these over
the turn. So where a face has gaps at several angles, its loads at a compression are the means of those at each, and so
is its stiffness. The gaps contain the approach at each angle beside the mean one, so that each carries its own load at
the common compression.

A tooth whose deflection varies across the face, ``W(z) phi(y)``, is a plate of thickness t(y) held at its foot. phi is
the deflection of a slice as a beam under a load at the middle of the path of contact, with its bending and its shear,
psi the rotation of its sections; both are 1 in the measure of the loaded point's deflection. Where W has a slope, the
plate's normals rotate across the face by ``chi(y) W'`` with the least energy (Mindlin's plate):

    T = min over chi of  int 5/6 G t (phi - chi)^2 + G t^3/12 (psi + chi')^2 dy,        chi = 0 at the foot,

the first part shear across the face, the second twist. T is then the shear force that the face passes on for each unit
of W'. The stiffness of the plate against curvature across the face, of higher order, is left out, and so is the body.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import solveh_banded

from gearwhine.coupling.gears.errors import ContactAccuracyError
from gearwhine.coupling.gears.geometry.faults import Spall
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.coupling.gears.geometry.profile import tooth_side
from gearwhine.coupling.gears.stiffness.beam import shear_modulus
from gearwhine.coupling.gears.stiffness.hertz import hertz_compliance
from gearwhine.numerics.arrays import BoolArray, FloatArray, IndexArray

_OUTLINE = 200
_LAYERS = 300

DEFAULT_SLICES = 61
FINE_SLICES = 241
"""Number of slices where steep edges cross the face. A slice is inside or outside a pit: as the edge moves, the load
steps by the share of one slice, a few per cent of the mesh's with `DEFAULT_SLICES`."""
FACE_STATIONS = 5
"""Stations over the face of a gear at which it follows its shaft."""
_NO_SPAN = 1e-6
"""Span of a line of contact along the path below which it counts as one point [base pitches]."""
_MOST_ROUNDS = 200
_ALONE_ROUNDS = 8
_SETTLED_SHARE, _LEAST_SHARE = 1e-9, 1e-6
"""Change of a load in a step at which gaps of several angles share it, and load of a mesh that is about to part, over
the whole."""
_UNSETTLED = "the iteration for the touching slices of the face does not converge; take fewer slices"
_UNBOUNDED = "the slices of the face yield without bound; check the stiffness of the teeth"


def tooth_coupling(gear: Gear, radius: float) -> float:
    """Shear coupling T of one tooth across its face [N], with the load at `radius` [m]."""
    return _tooth_coupling(gear.sound, radius)


@lru_cache(maxsize=64)  # gears of one drawing differ in their flanks alone
def _tooth_coupling(gear: Gear, radius: float) -> float:
    across, along = tooth_side(gear, _OUTLINE)
    height = along - along[0]
    load = float(np.interp(radius, gear.sign * np.hypot(across, along), height))
    edges = np.linspace(0.0, height[-1], _LAYERS + 1)
    step = edges[1]
    y = 0.5 * (edges[1:] + edges[:-1])
    thickness = 2.0 * np.interp(y, height, across)
    shear = shear_modulus(gear)
    # The slice as a beam: section rotation psi, deflection phi, of a unit load.
    below = y < load
    rotation = _summed(np.where(below, (load - y) * 12.0 / (gear.youngs_modulus * thickness**3), 0.0) * step)
    psi = 0.5 * (rotation[1:] + rotation[:-1])
    deflection = _summed((psi + np.where(below, 1.2 / (shear * thickness), 0.0)) * step)
    unit = float(np.interp(load, edges, deflection))
    phi, psi = 0.5 * (deflection[1:] + deflection[:-1]) / unit, psi / unit
    # Least energy by linear elements for chi, from the foot up: a tridiagonal system.
    across_shear, twist = 5.0 / 6.0 * shear * thickness * step, shear * thickness**3 / 12.0 * step
    diagonal, beside = 0.25 * across_shear + twist / step**2, 0.25 * across_shear - twist / step**2
    right, up = 0.5 * across_shear * phi, twist * psi / step
    bands = np.zeros((2, _LAYERS))
    bands[1] = diagonal + np.append(diagonal[1:], 0.0)
    bands[0, 1:] = beside[1:]
    side = right - up + np.append(right[1:] + up[1:], 0.0)
    chi = solveh_banded(bands, side)
    return float(np.sum(across_shear * phi**2 + twist * psi**2) - side @ chi)


def _summed(values: FloatArray) -> FloatArray:
    """Sum `values` (n,) cumulatively from zero, (n + 1,)."""
    return np.concatenate([[0.0], np.cumsum(values)])


@dataclass(frozen=True, eq=False)
class FaceSlices:
    """Slices of a pair's common face.

    Attributes
    ----------
    z : ndarray, shape (n,)
        Middles of the slices, from the middle of the face [m].
    width : float
        Width of each slice [m].
    shift : ndarray, shape (n,)
        Offset of each slice from the position of the pair [base pitches].
    gap : ndarray, shape (n,)
        Gap of the flanks there, in addition to that of their profiles [m].
    flattening : float
        k_h, load per width over the flattening of the contact [N/m per m].
    coupling : float
        T, shear force over slope [N]; 0 for independent slices.
    shared : ndarray, shape (m, m)
        Compliance that pairs in contact at once share, of loads and deflections like `shapes` [m/N]; (0, 0) for none.
    changes : ndarray, shape (t, n)
        Gaps at t angles of a carrier beside `gap` [m]. Loads at a compression are the means over them.
    path_slope : float
        Slope of the gap along the line of action, where it is 0 at the pitch point [1].
    """

    z: FloatArray
    width: float
    shift: FloatArray
    gap: FloatArray
    flattening: float
    coupling: float
    shared: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    changes: FloatArray = field(default_factory=lambda: np.zeros((1, 1)))
    path_slope: float = 0.0

    @property
    def face_width(self) -> float:
        """Width of all slices together [m]."""
        return self.width * self.z.size

    @cached_property
    def shapes(self) -> FloatArray:
        """Polynomials of degree 1 to m over the slices, of mean 0 and mean square 1 and without mean products, (n, m).

        Fewer than m where the slices are fewer.
        """
        n = self.z.size
        degrees = min(len(self.shared), n - 1)
        polynomials, triangle = np.linalg.qr(np.polynomial.legendre.legvander(2.0 * self.z / self.face_width, degrees))
        return np.asarray(math.sqrt(n) * (polynomials * np.sign(np.diagonal(triangle)))[:, 1:])

    @property
    def link(self) -> float:
        """T over the square of a slice's width [N/m per m]."""
        return self.coupling / self.width**2

    @property
    def half_span(self) -> float:
        """Half the span of a slice along the path of contact [base pitches]; 0 for a spur gear."""
        span = float(np.ptp(self.shift))
        return 0.5 * span / (self.z.size - 1) if span > _NO_SPAN else 0.0

    @property
    def reach(self) -> float:
        """Distance along the path from the middle of the face to its last point in contact [base pitches].

        Coupled slices are on the path or off it with their middles, independent ones with their ends.
        """
        return float(np.abs(self.shift).max()) + (0.0 if self.coupling > 0.0 else self.half_span)

    def part_within(self, position: FloatArray, start: float, end: float) -> FloatArray:
        """Part of slices with middles at `position` that lies on the range of the path from `start` to `end`.

        All or nothing at both ends of the range for slices without a span along the path.
        """
        half = self.half_span
        if half == 0.0:
            return np.asarray((position >= start) & (position <= end), dtype=np.float64)
        first, last = np.clip(position - half, start, end), np.clip(position + half, start, end)
        return np.asarray((last - first) / (2.0 * half), dtype=np.float64)

    def in_slices(self, count: int) -> FaceSlices:
        """Return the same face in another number of slices; gaps are interpolated linearly.

        Slices of helical teeth come into touch one by one, which ripples force and deflection with one wave per slice
        in a base pitch. The ripple's amplitude falls with the square of the slices' width.
        """
        z = self.face_width * ((np.arange(count) + 0.5) / count - 0.5)
        below = np.clip(np.searchsorted(self.z, z) - 1, 0, self.z.size - 2)
        part = (z - self.z[below]) / self.width
        changes = np.broadcast_to(self.changes, (len(self.changes), self.z.size))
        rows = np.vstack([self.shift, self.gap, changes])
        shift, gap, *changed = rows[:, below] + part * (rows[:, below + 1] - rows[:, below])
        width = self.face_width / count
        return replace(self, z=z, width=width, shift=shift, gap=gap, changes=np.array(changed))


@dataclass(frozen=True, eq=False)
class FaceLoads:
    """Loaded faces of p pairs.

    Attributes
    ----------
    line_load, line_tangent : ndarray, shape (p, n)
        Load per width [N/m], transverse, and its derivative by compression [N/m per m].
    touching : ndarray of bool, shape (p, n)
        Slices in contact.
    width : float
        Width of the slices [m].
    """

    line_load: FloatArray
    line_tangent: FloatArray
    touching: BoolArray
    width: float

    @property
    def force(self) -> FloatArray:
        """Force of each pair [N], shape (p,)."""
        return np.asarray(self.width * self.line_load.sum(axis=1))

    @property
    def tangent(self) -> FloatArray:
        """Derivative of the force of each pair by compression [N/m], shape (p,)."""
        return np.asarray(self.width * self.line_tangent.sum(axis=1))

    def where(self, closed: BoolArray) -> FaceLoads:
        """Return the loads of the pairs that are closed (p,), none on the others."""
        rows = closed[:, None]
        return FaceLoads(self.line_load * rows, self.line_tangent * rows, self.touching & rows, self.width)


def face_stations(width: float) -> FloatArray:
    """Stations over a face of a width [m], from its middle: Chebyshev points with both ends, shape (j,)."""
    steps = np.arange(FACE_STATIONS)[::-1] / (FACE_STATIONS - 1)
    return np.asarray(0.5 * width * np.cos(np.pi * steps))


def lagrange(stations: FloatArray, z: FloatArray) -> FloatArray:
    """Lagrange polynomials over the stations (j,), evaluated at z (s,), shape (s, j)."""
    weights = np.ones((z.size, stations.size))
    for j, node in enumerate(stations):
        for i, other in enumerate(stations):
            if i != j:
                weights[:, j] *= (z - other) / (node - other)
    return weights


def mean_and_slope(stations: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Mean at places z (s,) of a polynomial through stations (j,), and slope of its best straight line, rows (j,)."""
    by_stations = lagrange(stations, z)
    return np.asarray(by_stations.mean(axis=0)), np.asarray(z @ by_stations / float(z @ z))


def face_slices(
    geometry: GearPairGeometry,
    *,
    sense: int = 1,
    misalignment: float = 0.0,
    face_gap: Sequence[float] = (),
    gap_changes: Sequence[Sequence[float]] = (),
    path_slope: float = 0.0,
    count: int | None = None,
) -> FaceSlices:
    """Slices of a gear pair's face.

    Parameters
    ----------
    geometry : GearPairGeometry
    sense : int
        +1 where the driver turns counter-clockwise seen from +z, -1 where clockwise: a right-hand helix then leads at
        the end of larger z, or lags there.
    misalignment : float
        Angle between the flanks in the plane of action [rad], open towards +z where it is positive.
    face_gap : sequence of float
        Gap of the flanks at `face_stations` [m] that comes with it, such as that of bent and twisted shafts; empty for
        none.
    gap_changes : sequence of sequence of float
        Gaps there at angles of a carrier beside it [m]; empty for none.
    path_slope : float
        Slope of the gap along the line of action, where it is 0 at the pitch point [1].
    count : int or None
        Number of slices; None for `DEFAULT_SLICES`, or `FINE_SLICES` of helical teeth with a spall across their face.
    """
    b = geometry.face_width
    if count is None:
        count = FINE_SLICES if geometry.overlap_ratio > 0.0 and _has_pits(geometry) else DEFAULT_SLICES
    z = b * ((np.arange(count) + 0.5) / count - 0.5)
    hand = math.copysign(1.0, geometry.driver.helix_angle) * sense
    gap = misalignment * z
    over = lagrange(face_stations(b), z)
    if face_gap:
        gap = gap + over @ np.array(face_gap)
    for gear, middle in zip((geometry.driver, geometry.driven), geometry.common_middles, strict=True):
        if gear.helix_deviation is not None:
            gap = gap - gear.helix_deviation.at(z + middle, gear.face_width)
    couplings = [
        tooth_coupling(gear, radius)
        for gear, radius in zip((geometry.driver, geometry.driven), _middle_radii(geometry), strict=True)
    ]
    return FaceSlices(
        z=z,
        width=b / count,
        shift=hand * geometry.overlap_ratio * z / b,
        gap=np.asarray(gap, dtype=np.float64),
        flattening=1.0 / (hertz_compliance(geometry) * b),
        coupling=1.0 / sum(1.0 / coupling for coupling in couplings) if count > 1 else 0.0,
        changes=np.array(gap_changes) @ over.T if gap_changes else np.zeros((1, 1)),
        path_slope=path_slope,
    )


def aligned_slices(geometry: GearPairGeometry, *, sense: int = 1) -> FaceSlices | None:
    """Slices of aligned flanks; None of spur teeth that are even over the face: they carry uniformly without them.

    Parameters
    ----------
    geometry : GearPairGeometry
    sense : int
        See `face_slices`; the transmission error of flanks that are symmetric over the face is the same in both senses.
    """
    deviations = (geometry.driver.helix_deviation, geometry.driven.helix_deviation)
    even = all(deviation is None or deviation.is_straight for deviation in deviations)
    return None if even and geometry.driver.helix_angle == 0.0 else face_slices(geometry, sense=sense)


def _has_pits(geometry: GearPairGeometry) -> bool:
    faults = (*geometry.driver.faults, *geometry.driven.faults)
    return any(isinstance(fault, Spall) and fault.across_face(geometry.face_width) for fault in faults)


def slice_stiffness(slices: FaceSlices, stiffness: FloatArray) -> FloatArray:
    """k_b [N/m per m] from the stiffness of a pair over its whole face [N/m], flattening included.

    The flattening takes at most half of the pair's compliance.
    """
    whole = stiffness / slices.face_width
    return np.asarray(1.0 / np.maximum(1.0 / whole - 1.0 / slices.flattening, 0.5 / whole), dtype=np.float64)


def face_loads(
    slices: FaceSlices, base: FloatArray, gap: FloatArray, meeting: BoolArray, compression: FloatArray
) -> FaceLoads:
    """Solve the load distribution across the faces of p tooth pairs at given compressions.

    Parameters
    ----------
    slices : FaceSlices
    base : ndarray, shape (p, n)
        k_b of each slice [N/m per m].
    gap : ndarray, shape (p, n)
        [m]; finite where slices meet.
    meeting : ndarray of bool, shape (p, n)
        Whether the slice is in the range of contact.
    compression : ndarray, shape (p,)
        Compression of the slice [m].

    Raises
    ------
    ContactAccuracyError
        Where the set of touching slices does not converge.
    """
    return _mean_loads(
        [_face_loads(slices, base, gap + change, meeting, compression) for change in slices.changes], slices.width
    )


def _mean_loads(loads: Sequence[FaceLoads], width: float) -> FaceLoads:
    """Mean of the loads at several gaps; slices touch that do so at one of them."""
    if len(loads) == 1:
        return loads[0]
    load, tangent = (np.mean([getattr(one, name) for one in loads], axis=0) for name in ("line_load", "line_tangent"))
    return FaceLoads(load, tangent, np.any([one.touching for one in loads], axis=0), width)


def _face_loads(
    slices: FaceSlices, base: FloatArray, gap: FloatArray, meeting: BoolArray, compression: FloatArray
) -> FaceLoads:
    touching = meeting & (compression[:, None] > gap)
    fixed, rising = _even(slices, base, gap, touching)
    unsettled = np.arange(compression.size)
    for _ in range(_MOST_ROUNDS):
        excess = fixed[unsettled] + compression[unsettled, None] * rising[unsettled]
        touches = meeting[unsettled] & (excess > 0.0)
        changed = (touches != touching[unsettled]).any(axis=1)
        unsettled, touches = unsettled[changed], touches[changed]
        if not unsettled.size:
            return _loads(slices, touching, compression[:, None], fixed, rising)
        touching[unsettled] = touches
        fixed[unsettled], rising[unsettled] = _even(slices, base[unsettled], gap[unsettled], touches)
    raise ContactAccuracyError(_UNSETTLED)


def face_equilibrium(
    slices: FaceSlices,
    base: FloatArray,
    gap: FloatArray,
    meeting: BoolArray,
    owner: IndexArray,
    force: FloatArray,
    *,
    touching: BoolArray | None = None,
) -> tuple[FloatArray, FaceLoads]:
    """Compressions (m,) at which the pairs of m meshes carry their loads, and the loaded faces.

    Parameters
    ----------
    slices, base, gap, meeting
        Arrays of all pairs of all meshes, see `face_loads`.
    owner : ndarray of int, shape (p,)
        Mesh of each pair.
    force : ndarray, shape (m,)
        Load of each mesh along the line of action [N].
    touching : ndarray of bool, shape (p, n), optional
        Slices in contact at the start of the search, such as those at a similar load.

    Raises
    ------
    ContactAccuracyError
        Where the set of touching slices does not converge, or the loads do not balance to rounding.
    """
    meshes = [SlicedMeshes(slices, base, gap + change, meeting, owner, force.size) for change in slices.changes]
    balanced = [mesh.balance(force, touching=touching) for mesh in meshes]
    if len(meshes) == 1:
        return balanced[0].compression, balanced[0].faces
    carried = np.tile(force, (len(meshes), 1))
    for _ in range(_MOST_ROUNDS):
        compression, compliance = (
            np.array([getattr(one, name) for one in balanced]) for name in ("compression", "compliance")
        )
        # Newton's method for the common compression; a mesh that would pull there is apart.
        apart = np.zeros(carried.shape, dtype=np.bool_)
        while True:
            stiffness = np.where(apart, 0.0, 1.0 / compliance)
            held = np.where(apart, 0.0, carried - stiffness * compression)
            common = (len(meshes) * force - held.sum(axis=0)) / stiffness.sum(axis=0)
            pulls = ~apart & (held + stiffness * common < 0.0)
            if not pulls.any():
                break
            apart |= pulls
        changed = np.where(apart, 0.0, held + stiffness * common)
        if np.all(apart | (np.abs(changed - carried) <= _SETTLED_SHARE * force)):
            loads = [one.faces.where(~gone[owner]) for one, gone in zip(balanced, apart, strict=True)]
            return common, _mean_loads(loads, slices.width)
        carried = np.maximum(changed, _LEAST_SHARE * force)
        balanced = [
            mesh.balance(load, touching=one.faces.touching)
            for mesh, load, one in zip(meshes, carried, balanced, strict=True)
        ]
    raise ContactAccuracyError(_UNSETTLED)


@dataclass(frozen=True, eq=False)
class BalancedMeshes:
    """Equilibrium of m meshes of p pairs under their loads.

    Attributes
    ----------
    compression : ndarray, shape (m,)
        Compression [m], the deflections that all pairs of the mesh share excluded.
    compliance : ndarray, shape (m,)
        Derivative of the compression by the load [m/N].
    faces : FaceLoads
        Loaded faces of the pairs.
    loads : ndarray, shape (m, a)
        Loads conjugate to the approaches [N, N m].
    tangents : ndarray, shape (m, a, a)
        Their derivatives by the approaches; empty unless several are given.
    energy : ndarray, shape (m,)
        Energy of the teeth and their bodies [J].
    """

    compression: FloatArray
    compliance: FloatArray
    faces: FaceLoads
    loads: FloatArray
    tangents: FloatArray
    energy: FloatArray


class SlicedMeshes:
    """Pairs of m meshes whose flanks approach unevenly over the face.

    What resists the approaches of a pair follows from its touching slices alone, and is kept for the next equilibrium.

    Parameters
    ----------
    slices, base, gap, meeting
        Arrays of all p pairs of all meshes, see `face_loads`.
    owner : ndarray of int, shape (p,)
        Mesh of each pair, ascending.
    meshes : int
    approaches : ndarray, shape (p, n, a), optional
        Approaches B of each pair; by default the even one.
    even : ndarray, shape (a,)
        Sum of them that is 1 all over the face.
    """

    def __init__(
        self,
        slices: FaceSlices,
        base: FloatArray,
        gap: FloatArray,
        meeting: BoolArray,
        owner: IndexArray,
        meshes: int,
        approaches: FloatArray | None = None,
        even: FloatArray | None = None,
    ) -> None:
        self._slices, self._base, self._gap, self._meeting, self._owner = slices, base, gap, meeting, owner
        self._first = np.searchsorted(owner, np.arange(meshes + 1))
        shapes, count = slices.shapes, len(owner)
        if approaches is None or even is None:
            approaches, even = np.ones((1, slices.z.size, 1)), np.ones(1)
        self._even = even
        repeated = np.broadcast_to(shapes, (len(approaches), *shapes.shape))
        self._motions = np.concatenate([approaches, repeated], axis=2)
        self._shared = np.ascontiguousarray(slices.shared[: shapes.shape[1], : shapes.shape[1]])
        # As the whole matrix is: the kernels are compiled apart for arrays that may be written to.
        self._shared.flags.writeable = False
        # Approaches of all pairs alone are of meshes that are solved once.
        rows = count if len(approaches) > 1 else int(np.diff(self._first).max(initial=1))
        size = self._motions.shape[2]
        self._touching, self._known = np.zeros(gap.shape, dtype=np.bool_), np.zeros(count, dtype=np.bool_)
        self._fields = np.empty((rows, slices.z.size, 1 + size))
        self._slopes, self._constants = np.empty((rows, size, size)), np.empty((rows, size))

    def balance(
        self,
        force: FloatArray,
        shape: FloatArray | None = None,
        touching: BoolArray | None = None,
        *,
        resumed: bool = False,
    ) -> BalancedMeshes:
        """Find the equilibrium under loads (m,) [N].

        Parameters
        ----------
        force : ndarray, shape (m,)
        shape : ndarray, shape (a,), optional
            Approach but for the compression [m]; none by default.
        touching : ndarray of bool, shape (p, n), optional
            Slices in contact at the start of the search, such as those at a similar load.
        resumed : bool
            Whether the search starts from the slices that were last in contact.

        Raises
        ------
        ContactAccuracyError
            Where the set of touching slices does not converge, or the loads do not balance to rounding.
        """
        # Imported here: numba is not needed to read a case.
        from gearwhine.coupling.gears.contact.face_slice_kernels import balance_meshes

        slices, gap, width = self._slices, self._gap, self._slices.width
        if not resumed:
            self._start(touching)
        load, tangent = np.empty(gap.shape), np.empty(gap.shape)
        own, size = self._even.size, self._motions.shape[2]
        results, loads = np.empty((6, force.size)), np.empty((force.size, size))
        tangents = np.empty((force.size if own > 1 else 0, own, own))
        failure = balance_meshes(
            self._first,
            self._base,
            gap,
            self._meeting,
            self._touching,
            slices.flattening,
            slices.link,
            width,
            self._motions,
            self._even,
            np.zeros(own) if shape is None else shape,
            self._shared,
            force,
            (_MOST_ROUNDS, _ALONE_ROUNDS if touching is None and not resumed else 0),
            self._known,
            self._fields,
            self._slopes,
            self._constants,
            load,
            tangent,
            results,
            loads,
            tangents,
        )
        if failure:
            raise ContactAccuracyError(_UNSETTLED if failure == 1 else _UNBOUNDED)
        compression, compliance, energy, carried, least, stiffness = results
        rounding = 1e-9 * (force + stiffness * np.abs(compression)) + 1e-300
        if np.any(np.abs(carried - force) > rounding) or least.min() < -rounding.max():
            raise ContactAccuracyError(
                "the slices of the face do not balance the load; check the stiffness and the gaps"
            )
        faces = FaceLoads(load, tangent, self._touching.copy(), width)
        return BalancedMeshes(compression, compliance, faces, loads[:, :own], tangents, energy)

    def tangents(self, touching: BoolArray) -> FloatArray:
        """Return the derivatives of the loads of each mesh by the approaches where slices (p, n) touch, (m, a, a).

        They are the sums of ``w Bᵀ k_h (B - W)`` over the touching slices. The shapes of the shared deflection are
        approaches too, and are condensed.

        Raises
        ------
        ContactAccuracyError
            Where the slices yield without bound.
        """
        from gearwhine.coupling.gears.contact.face_slice_kernels import condense_all

        self._start(touching)
        _find_fields(
            self._slices,
            np.flatnonzero(~self._known),
            self._base,
            self._gap,
            self._touching,
            self._motions,
            self._fields,
            self._slopes,
            self._constants,
        )
        self._known[:] = True
        tangents = np.empty((self._first.size - 1, self._even.size, self._even.size))
        condense_all(self._first, self._slices.width, self._slopes, self._shared, tangents)
        return tangents

    def _start(self, touching: BoolArray | None) -> None:
        """Start from slices in contact; what is known of pairs with the same ones is kept."""
        if touching is None or len(self._fields) < len(self._known):
            self._known[:] = False
        if touching is not None:
            touching = touching & self._meeting
            self._known &= (touching == self._touching).all(axis=1)
            self._touching[:] = touching


def _loads(
    slices: FaceSlices, touching: BoolArray, deep: FloatArray, fixed: FloatArray, rising: FloatArray
) -> FaceLoads:
    """Evaluate the face loads from what the flattening yields, ``fixed + deep * rising``, at compressions (p, 1)."""
    load = np.where(touching, slices.flattening * (fixed + deep * rising), 0.0)
    tangent = np.where(touching, slices.flattening * rising, 0.0)
    return FaceLoads(load, tangent, touching, slices.width)


def _even(slices: FaceSlices, base: FloatArray, gap: FloatArray, touching: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Solve ``compression - gap - w = fixed + compression * rising`` of each pair, (p, n) both."""
    fields, pairs = np.empty((*gap.shape, 2)), len(gap)
    motions = np.ones((1, slices.z.size, 1))
    slopes, constants = np.empty((pairs, 1, 1)), np.empty((pairs, 1))
    _find_fields(slices, np.arange(pairs), base, gap, touching, motions, fields, slopes, constants)
    return fields[:, :, 0], fields[:, :, 1]


def _find_fields(
    slices: FaceSlices,
    pairs: IndexArray,
    base: FloatArray,
    gap: FloatArray,
    touching: BoolArray,
    motions: FloatArray,
    fields: FloatArray,
    slopes: FloatArray,
    constants: FloatArray,
) -> None:
    """Find the rows of some pairs in the last three arrays, see the kernel."""
    from gearwhine.coupling.gears.contact.face_slice_kernels import deflect_under_motions

    arrays = base, gap, touching, slices.flattening, slices.link, motions, fields, slopes, constants
    if not deflect_under_motions(pairs, *arrays):
        raise ContactAccuracyError(_UNBOUNDED)


def _middle_radii(geometry: GearPairGeometry) -> tuple[float, float]:
    middle = 0.5 * geometry.contact_ratio
    return float(geometry.driver_radius(middle)), float(geometry.driven_radius(middle))
