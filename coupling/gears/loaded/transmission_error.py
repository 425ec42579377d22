"""Loaded transmission error: static equilibrium of the mesh under a steady load, with mesh stiffness and load sharing.

At each phase the pairs' forces balance the load, ``sum_j k'_j max(0, x - d_j) = F``, x their compression.  The left
side is piecewise linear and increasing, so with the pairs sorted by deviation the answer is exact: with the n
least relieved pairs touching ``x = (F + sum k'_j d_j) / sum k'_j``, and n is the number for which this lies
above the n-th and not above the next deviation.  The shared compliance adds, ``delta = x + C F``
(:mod:`gearwhine.coupling.gears.contact.contact_law`): under a constant load it is constant, and only shifts the
transmission error.

Over the hunting period each different mesh period is solved once. Mesh periods differ by the pairs that can touch in
them: by their pitch gaps and their damaged teeth. One cracked tooth makes a few mesh periods different from all others,
however long the hunting period is; only pitch deviations of both gears make every mesh period different.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears.contact.contact_law import PairStates, ToothContact
from gearwhine.coupling.gears.contact.face_slices import FaceSlices, face_equilibrium, face_loads
from gearwhine.coupling.gears.errors import ContactAccuracyError, GearError
from gearwhine.coupling.gears.geometry.faults import NO_CONTACT_GAP
from gearwhine.numerics.arrays import ComplexArray, FloatArray, IntArray

EVEN_PHASES = 400
"""Equally spaced phases of a mesh period, of the static mesh by itself and in its machine."""
_HAIR = 1e-9
"""Compression for the tangent stiffness of an unloaded face [m]."""
_EVENT_DISTANCE = 1e-9
"""Distance from an event of the phases for both limits of a step, in mesh periods."""


@dataclass(frozen=True, eq=False)
class LoadedMesh:
    """A loaded mesh at n phases, up to m pairs.

    Attributes
    ----------
    force : float
        Load along the line of action [N].
    phases : ndarray, shape (n,)
        Mesh periods.
    transmission_error : ndarray, shape (n,)
        Static transmission error under the load, along the line of action [m]: the lag of the driven gear.
    positions : ndarray, shape (n, m)
        Positions of the pairs along the path of contact [base pitches].
    pair_forces : ndarray, shape (n, m)
        Force of each pair [N].
    tangent_stiffness : ndarray, shape (n,)
        Stiffness of the tooth pairs that touch under the load, dF/d delta [N/m].
    secant_stiffness : ndarray, shape (n,)
        Load over the compression beyond first touch [N/m]; the tangent at no load.
    line_loads : ndarray, shape (n, m, s), or None
        Transverse load per face width on every slice of each tooth pair [N/m]; None for a uniform load.
    """

    force: float
    phases: FloatArray
    transmission_error: FloatArray
    positions: FloatArray
    pair_forces: FloatArray
    tangent_stiffness: FloatArray
    secant_stiffness: FloatArray
    line_loads: FloatArray | None = None

    @property
    def load_shares(self) -> FloatArray:
        """Fraction of the load on each pair, shape (n, m); zero everywhere at no load."""
        return self.pair_forces / self.force if self.force > 0.0 else np.zeros_like(self.pair_forces)

    @property
    def mean_transmission_error(self) -> float:
        """Mean over the whole periods that `phases` cover [m]."""
        return period_mean(self.phases, self.transmission_error)

    @property
    def peak_to_peak_transmission_error(self) -> float:
        """Peak-to-peak transmission error [m]."""
        return float(np.ptp(self.transmission_error))

    @property
    def mean_mesh_stiffness(self) -> float:
        """Mean mesh stiffness under the load: mean tangent stiffness over the whole periods of `phases` [N/m]."""
        return self.mean_stiffness_without(0.0)

    def mean_stiffness_without(self, compliance: float) -> float:
        """Mean mesh stiffness under the load without a compliance in series with the pairs, `compliance` [m/N]."""
        return period_mean(self.phases, self.tangent_stiffness / (1.0 - compliance * self.tangent_stiffness))


def even_phases(points: int = EVEN_PHASES) -> FloatArray:
    """Return the middles of equal parts of a mesh period, shape (n,)."""
    return (np.arange(points) + 0.5) / points


def mesh_period_phases(contact: ToothContact, points: int = EVEN_PHASES, periods: int = 1) -> FloatArray:
    """Phases over whole mesh periods, with both sides of every step and every corner among them.

    Parameters
    ----------
    contact : ToothContact
    points : int
        Equally spaced phases of a period before the events are added.
    periods : int
        Mesh periods; `ToothContact.hunting_period` for all pitch deviations.

    Returns
    -------
    ndarray, shape (n,)
        Ascending, in [0, periods).
    """
    even = even_phases(points)
    events = np.array(contact.event_phases)
    limits = np.concatenate([events - _EVENT_DISTANCE, events + _EVENT_DISTANCE, np.array(contact.corner_phases)]) % 1.0
    period = np.unique(np.concatenate([even, limits]))
    return np.asarray((np.arange(periods)[:, None] + period).ravel(), dtype=np.float64)


def loaded_transmission_error(
    contact: ToothContact, force: float, phases: npt.ArrayLike | None = None, *, states: PairStates | None = None
) -> LoadedMesh:
    """Equilibrium of the mesh under a load, phase by phase.

    Parameters
    ----------
    contact : ToothContact
    force : float
        Load along the line of action, torque over base radius [N], at least 0.
    phases : array_like, shape (n,), or None
        Mesh periods; None for one period, `mesh_period_phases`: with pitch deviations the one in which teeth 0 enter;
        means over the hunting period need its phases given.
    states : PairStates or None
        ``contact.pairs(phases)``, computed once for many loads at the same phases.

    Returns
    -------
    LoadedMesh

    Raises
    ------
    GearError
        For a negative or non-finite load, or where too many teeth are missing for any to meet.
    ContactAccuracyError
        If the pairs' forces miss the load by more than rounding.
    """
    if not (math.isfinite(force) and force >= 0.0):
        raise GearError(f"static mesh: the load must be at least 0 N, got {force!r}")
    at = mesh_period_phases(contact) if phases is None else np.atleast_1d(np.asarray(phases, dtype=np.float64))
    states = contact.pairs(at) if states is None else states
    _require_teeth(states, at)
    if contact.faces is not None:
        return _balanced_faces(contact.faces, contact.shared_compliance, force, at, states)
    order = np.argsort(states.deviation, axis=1)
    stiffness = np.take_along_axis(states.stiffness, order, axis=1)
    gap = np.take_along_axis(states.deviation, order, axis=1)
    # Counted from first touch, so that rounding never puts the equilibrium before it.
    first = gap[:, :1]
    later = np.where(np.isfinite(gap), gap - first, 0.0)
    sum_stiffness = np.cumsum(stiffness, axis=1)
    candidate = first + (force + np.cumsum(stiffness * later, axis=1)) / sum_stiffness
    # The n-th candidate holds while it exceeds the n-th gap; the first always does (or equals it).
    holds = (candidate > gap) & np.isfinite(gap)
    holds[:, 0] = True
    touching = np.argmin(np.column_stack([holds, np.zeros(at.size, dtype=bool)]), axis=1) - 1
    rows = np.arange(at.size)
    compression = candidate[rows, touching]
    tangent = sum_stiffness[rows, touching]

    forces = states.stiffness * np.maximum(0.0, compression[:, None] - states.deviation)
    # Rounding of delta - d, times the stiffness, is the least residual of any solution.
    rounding = 64.0 * np.finfo(np.float64).eps * (force + tangent * np.abs(compression))
    imbalance = np.abs(forces.sum(axis=1) - force)
    if np.any(imbalance > rounding + 1e-300):
        raise ContactAccuracyError(
            f"static mesh: the teeth carry {imbalance.max():.3e} N more or less than the load of {force:.6g} N; "
            "check the contact's stiffness and deviation for extreme values"
        )
    compression = compression + contact.shared_compliance * force
    tangent = tangent / (1.0 + contact.shared_compliance * tangent)
    beyond = compression - first[:, 0]
    secant = np.where(beyond > 0.0, force / np.where(beyond > 0.0, beyond, 1.0), tangent)
    return LoadedMesh(force, at, compression, states.position, forces, tangent, secant)


def _require_teeth(states: PairStates, at: FloatArray) -> None:
    """Raise `GearError` at a phase where every pair that could touch lacks a tooth."""
    apart = states.deviation.min(axis=1) > 0.5 * NO_CONTACT_GAP
    if np.any(apart):
        raise GearError(
            f"static mesh: no teeth meet at phase {at[apart][0]:.4g}, counted in mesh periods; so many neighbours are "
            "missing that the gears turn free until the next ones strike. Let fewer neighbouring teeth be missing"
        )


def _balanced_faces(faces: FaceSlices, shared: float, force: float, at: FloatArray, states: PairStates) -> LoadedMesh:
    """Solve the static mesh with an uneven load across the face."""
    assert states.faces is not None
    rows, columns = np.nonzero(states.present)
    base, meeting = states.faces.base, states.faces.meeting
    gap = states.faces.gap + states.pitch_gap[rows, columns][:, None]
    if force > 0.0:
        compression, loads = face_equilibrium(faces, base, gap, meeting, rows, np.full(at.size, force))
    else:
        # Without load the first slice just touches; the stiffness is that at a small compression.
        compression = states.deviation.min(axis=1)
        loads = face_loads(faces, base, gap, meeting, compression[rows] + _HAIR)
        loads = replace(loads, line_load=0.0 * loads.line_load)
    forces, tangents = np.zeros(states.position.shape), np.zeros(states.position.shape)
    line_loads = np.zeros((*states.position.shape, faces.z.size))
    forces[rows, columns], tangents[rows, columns] = loads.force, loads.tangent
    line_loads[rows, columns] = loads.line_load
    compression = compression + shared * force
    beyond = compression - states.deviation.min(axis=1)
    tangent = tangents.sum(axis=1)
    tangent = tangent / (1.0 + shared * tangent)
    secant = np.where(beyond > 0.0, force / np.where(beyond > 0.0, beyond, 1.0), tangent)
    return LoadedMesh(force, at, compression, states.position, forces, tangent, secant, line_loads)


def mesh_stiffness(contact: ToothContact, phases: npt.ArrayLike) -> FloatArray:
    """Mesh stiffness with all pairs on the path of contact touching [N/m], at `phases` (n,)."""
    return contact.mesh_stiffness(phases, sound=False)


@dataclass(frozen=True)
class MeshStiffnessFigures:
    """Figures of the mesh stiffness of all teeth: over a mesh period, or the hunting period where these differ.

    Attributes
    ----------
    mean, least, greatest : float
        Of all pairs on the path of contact, whatever the load [N/m].
    loaded_mean : float
        Mean of the pairs that touch under the load [N/m].
    sound_mean : float or None
        Mean of all pairs on the path if no tooth were damaged [N/m]; None where none is.
    over_hunting_period : bool
        Whether mesh periods differ, by damage or pitch deviations, so that the figures are of the hunting period.
    """

    mean: float
    least: float
    greatest: float
    loaded_mean: float
    sound_mean: float | None
    over_hunting_period: bool


def mesh_stiffness_figures(
    contact: ToothContact, static: LoadedMesh, hunting: LoadedMesh | None = None
) -> MeshStiffnessFigures:
    """Mean, least and greatest mesh stiffness of a mesh under its load.

    Parameters
    ----------
    contact : ToothContact
        Contact law of the flanks that carry.
    static : LoadedMesh
        Statics over the first mesh period.
    hunting : LoadedMesh, optional
        Statics over the hunting period, where mesh periods differ.
    """
    mesh, sound = hunting or static, contact.unloaded_mean_mesh_stiffness
    damaged = hunting is not None and len(contact.variant_curves) > 1
    # Pitch deviations move teeth against each other, but stiffen none.
    phases = mesh.phases if damaged else static.phases
    on_path = mesh_stiffness(contact, phases)
    return MeshStiffnessFigures(
        mean=period_mean(phases, on_path) if damaged else sound,
        least=float(on_path.min()),
        greatest=float(on_path.max()),
        loaded_mean=mesh.mean_mesh_stiffness,
        sound_mean=sound if damaged else None,
        over_hunting_period=hunting is not None,
    )


def period_mean(phases: FloatArray, values: FloatArray) -> float:
    """Mean of a periodic curve by the trapezoidal rule on ascending phases, over the whole periods they lie in."""
    periods = max(1, math.ceil(phases[-1] - phases[0] - 1e-9))
    closed_phases = np.append(phases, phases[0] + periods)
    closed_values = np.append(values, values[0])
    return float(np.sum(0.5 * np.diff(closed_phases) * (closed_values[1:] + closed_values[:-1]))) / float(periods)


def transmission_error_phasors(mesh: LoadedMesh, count: int, periods: int = 1) -> ComplexArray:
    """Complex amplitudes c_h of the mesh harmonics of the transmission error [m], shape (count,).

    At the phase p the transmission error is its mean plus Re Σ c_h e^{2πihp}.

    Exact for the polygon through the points of the mesh periods: a curve with a step has the harmonics of a step.

    Parameters
    ----------
    mesh : LoadedMesh
    count : int
        Number of harmonics, from the first.
    periods : int
        Mesh periods that the phases cover.

    Raises
    ------
    GearError
        Where the phases do not return in each of these periods.
    """
    curve = HuntingCurve.through(mesh.phases, mesh.transmission_error, periods)
    return curve.amplitudes(periods * np.arange(1, count + 1))


def polygon_phasors(phases: FloatArray, values: FloatArray, orders: npt.ArrayLike, periods: int = 1) -> ComplexArray:
    """Complex amplitudes c of curves that repeat with the mesh, exact for the polygon through their points.

    At the phase p a curve is its mean plus Re Σ c e^{2πi r p} over the orders r.

    Parameters
    ----------
    phases : ndarray, shape (n,)
        Mesh periods, ascending, within the period of the curves.
    values : ndarray, shape (n,) or (n, m)
        One curve or m.
    orders : array_like, shape (r,)
        Multiples of the mesh frequency, not 0: whole ones over ``periods``.
    periods : int
        Mesh periods after which the curves repeat.

    Returns
    -------
    ndarray of complex, shape (r,) or (m, r)

    Raises
    ------
    GearError
        Where the phases do not lie in these periods, ascending.
    """
    if phases[-1] - phases[0] >= periods or np.any(np.diff(phases) <= 0.0):
        span = "one mesh period" if periods == 1 else f"{periods} mesh periods"
        raise GearError(f"harmonics: phases of {span} are needed, ascending and without its end")
    x = np.append(phases, phases[0] + periods)
    y = np.concatenate([values, values[:1]]).T[..., None, :]
    w = 2.0 * np.pi * np.asarray(orders, dtype=np.float64)[:, None]
    phasor = np.exp(-1j * w * x)
    # Integral of a straight segment times e^{-iwx}, by parts.
    slope = np.diff(y) / np.diff(x)
    moved = y * phasor
    integral = (moved[..., :-1] - moved[..., 1:]) / (1j * w) + slope * (phasor[:, 1:] - phasor[:, :-1]) / w**2
    return np.asarray(2.0 / periods * integral.sum(axis=-1))


@dataclass(frozen=True, eq=False)
class HuntingCurve:
    """Harmonics of a curve over H mesh periods whose n phases return in each: of a few or of all, at little cost.

    A polygon has the changes of slope s_j for its second derivative, so that its amplitude at the order k/H is

        c = -(2/H) / θ² Σ_j s_j e^{-iθ x_j},      θ = 2π k / H,

    exactly as of `polygon_phasors`, and the sum over the mesh periods is one Fourier transform for all k.

    Attributes
    ----------
    phases : ndarray, shape (n,)
        Phases of the first mesh period.
    changes : ndarray of complex, shape (H, n)
        Σ s e^{-iθx} over the mesh periods at each phase, for k = 0 ... H - 1.
    """

    phases: FloatArray
    changes: ComplexArray

    @classmethod
    def through(cls, phases: FloatArray, values: FloatArray, periods: int) -> HuntingCurve:
        """Return the polygon through points at phases of ``periods`` mesh periods, shape (H n,) each, ascending.

        Raises
        ------
        GearError
            Where the phases do not return in each mesh period.
        """
        first = phases[: phases.size // periods]
        every = (np.arange(periods)[:, None] + first).ravel()
        widths = np.diff(first, append=first[0] + 1.0)
        if phases.size != every.size or np.any(widths <= 0.0) or not np.allclose(phases, every, atol=_SAME_PHASE):
            raise GearError("harmonics: ascending phases that return in each mesh period are needed")
        slope = (np.diff(values, append=values[0]).reshape(periods, -1) / widths).ravel()
        changes = np.fft.fft((slope - np.roll(slope, 1)).reshape(periods, -1), axis=0)
        return cls(first, changes * np.exp(-2j * np.pi / periods * np.arange(periods)[:, None] * first))

    def amplitudes(self, cycles: IntArray) -> ComplexArray:
        """Complex amplitudes at the orders k / H, k the whole numbers ``cycles`` above 0, shape (k,)."""
        periods, found = len(self.changes), np.empty(len(cycles), dtype=np.complex128)
        whole, rest = np.divmod(cycles, periods)
        for harmonic in np.unique(whole).tolist():
            of_harmonic = whole == harmonic
            found[of_harmonic] = self.changes[rest[of_harmonic]] @ np.exp(-2j * np.pi * harmonic * self.phases)
        return np.asarray(-periods / (2.0 * np.pi**2 * cycles.astype(np.float64) ** 2) * found)


_SAME_PHASE = 1e-9  # of a mesh period

_AT_ONCE = 1000
"""Number of phases solved together: more, with face slices, exceed the processor's cache."""


_DIGITS = 2.0**40

_SAME_FORCE = 1e-9  # relative difference of forces that differ by rounding
_solved_periods: WeakKeyDictionary[ToothContact, tuple[int, LoadedMesh]] = WeakKeyDictionary()


def along_one_pair(contact: ToothContact, mesh: LoadedMesh) -> tuple[LoadedMesh, npt.NDArray[np.bool_]]:
    """Return the mesh as a pair of teeth runs along its whole path, and where in it that pair is, shape (n, m).

    Where all pairs are alike, those of one mesh period stand for one along its path; else the pairs before and behind
    have other pitches, and it is the pair that enters at phase 0 of a mesh under the same load.
    """
    if contact.hunting_period == 1:
        return mesh, contact.pairs(mesh.phases).present
    start, end = contact.contact_range
    periods = np.arange(math.floor(start), math.ceil(end))
    phases = (periods[:, None] + mesh.phases % 1.0).ravel()
    places = contact.pair_positions(phases)
    return loaded_transmission_error(contact, mesh.force, phases), places.present & (places.entered == 0)


def hunting_period_mesh(contact: ToothContact, force: float, points: int = 60) -> LoadedMesh:
    """Equilibrium of the mesh under a load over the hunting period.

    Parameters
    ----------
    contact : ToothContact
    force : float
        Load along the line of action [N], at least 0.
    points : int
        Equally spaced phases of a mesh period, see `mesh_period_phases`.

    Returns
    -------
    LoadedMesh
        Result of `loaded_transmission_error` at the phases of ``contact.hunting_period`` mesh periods, without the
        loads over the face. The last one of a contact is kept, and serves for forces that differ by rounding: an
        analysis asks some times for a mesh that takes seconds.

    Raises
    ------
    GearError, ContactAccuracyError
        See `loaded_transmission_error`.
    """
    known = _solved_periods.get(contact)
    if known is not None and known[0] == points and abs(known[1].force - force) <= _SAME_FORCE * force:
        return known[1]
    mesh = _over_hunting_period(contact, force, points)
    _solved_periods[contact] = points, mesh
    return mesh


def _over_hunting_period(contact: ToothContact, force: float, points: int) -> LoadedMesh:
    """Solve as `hunting_period_mesh` does."""
    # Of so many binary digits that phases of later mesh periods are exact: the places of the pairs return in each.
    period = np.round(_DIGITS * mesh_period_phases(contact, points)) / _DIGITS
    first, which = different_periods(contact)
    at = (first[:, None] + period).ravel()
    together = period.size * max(1, _AT_ONCE // period.size)
    parts = [
        loaded_transmission_error(contact, force, at[begin : begin + together]) for begin in range(0, at.size, together)
    ]

    def over_all(rows: list[FloatArray]) -> FloatArray:
        solved = np.concatenate(rows)
        return solved.reshape(first.size, period.size, *solved.shape[1:])[which].reshape(-1, *solved.shape[1:])

    return replace(
        parts[0],
        phases=(np.arange(which.size)[:, None] + period).ravel(),
        transmission_error=over_all([part.transmission_error for part in parts]),
        positions=over_all([part.positions for part in parts]),
        pair_forces=over_all([part.pair_forces for part in parts]),
        tangent_stiffness=over_all([part.tangent_stiffness for part in parts]),
        secant_stiffness=over_all([part.secant_stiffness for part in parts]),
        line_loads=None,
    )


def different_periods(contact: ToothContact) -> tuple[IntArray, IntArray]:
    """First mesh period of every variant, and the variant of each mesh period of the hunting period.

    Mesh periods are of one variant where the same pitch gaps and damaged teeth can touch in them.
    """
    start, end = contact.contact_range
    entered = np.arange(contact.hunting_period)[:, None] - np.arange(math.floor(start), math.ceil(end))
    by_pair = [
        values[entered % values.size]
        for values in (contact.pitch_gaps, contact.pair_variants.astype(np.float64))
        if values.size
    ]
    if not by_pair:
        return np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64)
    _, first, which = np.unique(np.concatenate(by_pair, axis=1), axis=0, return_index=True, return_inverse=True)
    return first, which.reshape(-1)
