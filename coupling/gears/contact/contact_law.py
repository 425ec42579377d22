r"""Tooth contact law of a gear pair: contact force, mesh stiffness and stored energy by the compression of the mesh.

:class:`ToothContact` holds the law; :func:`gearwhine.coupling.gears.contact.tooth_force_kernels.tooth_force` evaluates
its force.

At phase ``p`` (mesh periods of the driver) pairs are at ``s_j = frac(p) + j``, j all whole numbers with positions
in the range of contact.  Each has a stiffness ``k(s)`` and a profile deviation ``d(s)``, its gap in
nominal motion.  With the compression ``delta`` of the mesh along the line of action and its rate ``v``:

    F = E + c r v,        E = sum_j k'(s_j) max(0, x - d(s_j)),        delta = x + C E,        1/k' = 1/k - C
    U = sum_j 1/2 k'(s_j) max(0, x - d(s_j))^2 + 1/2 C E^2,            r = min(1, max_j(x - d(s_j)) / depth)

C is the compliance that the pairs share: the twist of both gears' bodies, which moves all teeth of a gear alike, and
the dent of the body under a neighbouring tooth (:mod:`gearwhine.coupling.gears.stiffness.ring_body`). It carries the
whole load, so it is in series with the pairs, which are in parallel, and x is their compression without it. One pair
alone has its own k again; the compliance of two pairs is the matrix with 1/k(s_j) on its diagonal and C beside it. With
C = 0, of models that state a pair's stiffness without its bodies, k' = k and x = delta.

The damping fades in over the first ``depth`` of compression: full at first touch, the force would jump at every
impact, and would pull just before the teeth part.  ``dU/d delta = F - c r v``; the rotation of the teeth also does the
work ``dU/dp`` per mesh period on the contact (the parametric power ``dU/dp * dp/dt``), which an energy balance at a
prescribed speed has to include.
The mesh never pulls: where the damping would take F below zero, F is zero and the springs' power is lost.  The whole
mesh may separate, and returns through the same law.

Pitch deviations add a gap ``f_n`` to the pair that enters at phase n, so to the pair j at phase p the gap of
``n = floor(p) - j``: ``d(s_j) + f_n`` then stands for ``d(s_j)`` above
(:mod:`gearwhine.coupling.gears.geometry.pitch_deviations`).  It is constant while the pair is in contact, so ``dU/dp``,
at a fixed delta ``sum_j 1/2 dk'/dp (x - d_j)^2 - k' (x - d_j) dd/dp``, keeps its form, and repeats with the hunting
period.

Backlash is two one-sided contacts, of the drive flanks and of the back flanks, each with this law; between them lies a
clearance. The back flanks are the same law in a mirror: phase ``back_flank_offset - p``, their own compression (the
motion projected on the mirrored line of action, less the backlash), and ``dU/dp`` of opposite sign; their own
pitch gaps come with `ToothContact.back_flanks`.

Where contact is held to the theoretical path, ``0 <= s < eps``, a deflected tooth without relief comes in and goes
out with a step in force, as in the sources.  The step is exactly at `event_phases`.  With corner contact
(:mod:`gearwhine.coupling.gears.geometry.path_of_contact`) pairs touch beyond the path too, over a gap that grows with
the distance from it, and the force has no steps; ``k`` is held there at what it is at the end of the path.

Pairs of damaged teeth (:mod:`gearwhine.coupling.gears.geometry.faults`) have a ``k`` and a ``d`` of their own.
`tooth_contact` makes the law of two gears from a tooth stiffness model.

Where the load is uneven across the face, the bodies that pairs share also tilt and bend over it
(:mod:`gearwhine.coupling.gears.stiffness.body_over_face`). Static solutions
(:func:`gearwhine.coupling.gears.loaded.transmission_error.loaded_transmission_error`) have that at every load. The
table that motion follows holds one pair alone, and pairs of which each tilts the bodies under the others are no sum of
such pairs. There the tilt counts at the mean load F of the mesh: a deflection g(p) adds to all gaps,

    g(p) = delta_tilting(p; F) - delta_even(p; F),

both by the equilibrium of the slices, with and without tilt. So at the mean load motion has the deflection of the
static solution at every phase, and near it the tangent of bodies that do not tilt, whose mean is within one per cent.
g is some ten to a hundred nanometres, of the size of the transmission error of good helical gears. It repeats with the
mesh, and where teeth differ with the hunting period: pitch deviations move the load along the face. Apart from the mean
load it stays as it is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline

from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.contact.face_slices import DEFAULT_SLICES, FaceSlices, aligned_slices, face_equilibrium
from gearwhine.coupling.gears.contact.lookup_tables import (
    FaceSliceStates,
    face_force_table,
    face_slice_states,
    law_table,
)
from gearwhine.coupling.gears.contact.tooth_pair import (
    Flattening,
    ToothPairCurves,
    is_whole_mesh,
    pair_deviation,
    slope_jumps,
    tooth_pair_curves,
    without_shared_compliance,
)
from gearwhine.coupling.gears.errors import GearError
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.coupling.gears.geometry.pitch_deviations import back_flank_pitch_gaps, pair_variants, pitch_gaps
from gearwhine.coupling.gears.piecewise_cubic import PiecewiseCubic
from gearwhine.coupling.gears.stiffness.compliant_teeth import CompliantTeeth
from gearwhine.coupling.gears.stiffness.hertz import hertz_compliance
from gearwhine.coupling.gears.stiffness.models import GIVEN_SPRINGS, StiffnessModel, shared_compliance
from gearwhine.numerics.arrays import FloatArray, IntArray

KernelArguments = tuple[FloatArray, int]

_MEAN_PHASES = 256
"""Phases for the mean stiffness of helical teeth, whose mesh stiffness is smooth."""
_TRIED = 5
"""Points of an interval of a given stiffness at which its greatest value is looked for."""
_TILT_PHASES, _TILT_HARMONICS, _TILT_KNOTS = 128, 20, 80
"""Phases at which the tilt of the bodies is solved, number of mesh harmonics retained, and knots of their spline."""
_TOOTH_TILT_PARTS = 32
"""Parts of a mesh period at whose ends the tilt is solved tooth by tooth."""
_MOST_HUNTING = 4000
"""Mesh periods of a hunting period that is solved whole: some seconds, and 4 MB."""


@dataclass(frozen=True, eq=False)
class PairPositions:
    """Positions of the pairs of teeth at n phases, at most m pairs at once.

    Attributes
    ----------
    position : ndarray, shape (n, m)
        Position along the path of contact, base pitches.
    present : ndarray of bool, shape (n, m)
        Whether the pair is in the range of contact.
    variant : ndarray of int, shape (n, m)
        Number of the variant of pair.
    entered : ndarray of int, shape (n, m)
        Phase at which the pair entered.
    """

    position: FloatArray
    present: npt.NDArray[np.bool_]
    variant: IntArray
    entered: IntArray


@dataclass(frozen=True, eq=False)
class PairStates(PairPositions):
    """Positions, stiffness and deviation of the pairs of teeth.

    Attributes
    ----------
    stiffness : ndarray, shape (n, m)
        Stiffness without the shared compliance [N/m]; 0 where absent, and for an uneven face, whose slices have theirs.
    deviation : ndarray, shape (n, m)
        Gap by profile and pitch [m], infinite where absent; for an uneven face the gap at first touch.
    pitch_gap : ndarray, shape (n, m)
        Gap by pitch deviations alone [m].
    faces : FaceSliceStates or None
        For an uneven face, the slices of the pairs that are present, row by row, without their pitch gaps.
    """

    stiffness: FloatArray
    deviation: FloatArray
    pitch_gap: FloatArray
    faces: FaceSliceStates | None = None


@dataclass(frozen=True, eq=False)
class ToothContact:
    """Tooth contact law of a gear pair.

    Attributes
    ----------
    contact_ratio : float
        Length of a pair's contact in base pitches.
    stiffness : PiecewiseCubic
        Stiffness of one pair that carries alone, its gears' bodies included [N/m], over its range of contact:
        [0, contact_ratio], or more with corner contact.
    deviation : PiecewiseCubic
        Gap of one pair [m] over the same range.
    damping : float
        Damping coefficient while the mesh is compressed [N s/m].
    back_flank_offset : float
        Phase of the back flanks, see `GearPairGeometry.back_flank_offset`.
    pitch_gaps, back_pitch_gaps : ndarray, shape (h,)
        Gap by pitch deviations of the pair that enters at phase n, at n mod h [m], on the working and on the
        back flanks; empty for none.
    damping_depth : float
        Compression up to which the damping fades in [m]; 0 for full damping at first touch.
    variants : tuple of ToothPairCurves
        Curves of the pairs of damaged teeth, numbered from 1; pairs of sound teeth are number 0.
    pair_variants, back_pair_variants : ndarray of int, shape (h,)
        Variant of the pair that enters at phase n, at n mod h; empty where all are alike.
    faces : FaceSlices or None
        Slices of the face where it is not loaded evenly; positions are then those of the middle of the face.
    module : float
        Normal module of the gears [m]: it sets the depth of the table for the kernels. Only used with `faces`.
    shared_compliance : float
        Compliance that pairs in contact at once share, C [m/N]; below that of any pair alone.
    mean_load : float
        Mean mesh force along the line of action, negative where the back flanks carry it [N]; the tilt of bodies under
        an uneven load counts in motion at this load, tooth by tooth.
    tooth_counts : tuple of int
        Numbers of teeth of the driver and the driven gear; zeros where the pairs are not known by gears.
    """

    contact_ratio: float
    stiffness: PiecewiseCubic
    deviation: PiecewiseCubic
    damping: float = 0.0
    back_flank_offset: float = 0.0
    pitch_gaps: FloatArray = field(default_factory=lambda: np.zeros(0))
    back_pitch_gaps: FloatArray = field(default_factory=lambda: np.zeros(0))
    damping_depth: float = 0.0
    variants: tuple[ToothPairCurves, ...] = ()
    pair_variants: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    back_pair_variants: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    faces: FaceSlices | None = None
    module: float = 0.0
    shared_compliance: float = 0.0
    mean_load: float = 0.0
    tooth_counts: tuple[int, int] = (0, 0)

    def __post_init__(self) -> None:
        """Check the values, the curves of the pairs, the pitch gaps and the indices of variants."""
        least = 0.0 if self.enters_by_slices else 1.0  # the next pair of helical teeth enters at the other end
        if not (math.isfinite(self.contact_ratio) and self.contact_ratio >= least):
            raise GearError(f"tooth contact: contact_ratio must be at least {least:g}, got {self.contact_ratio!r}")
        if not (math.isfinite(self.damping) and self.damping >= 0.0):
            raise GearError(f"tooth contact: damping must be at least 0 N s/m, got {self.damping!r}")
        if not (math.isfinite(self.damping_depth) and self.damping_depth >= 0.0):
            raise GearError(f"tooth contact: damping_depth must be at least 0 m, got {self.damping_depth!r}")
        if not (math.isfinite(self.shared_compliance) and self.shared_compliance >= 0.0):
            raise GearError(f"tooth contact: shared_compliance must be at least 0 m/N, got {self.shared_compliance!r}")
        if not math.isfinite(self.mean_load):
            raise GearError(f"tooth contact: mean_load must be a finite number of newtons, got {self.mean_load!r}")
        for curves in self._single_pair_curves:
            self._check_curves(curves)
        for name, gaps in (("pitch_gaps", self.pitch_gaps), ("back_pitch_gaps", self.back_pitch_gaps)):
            if gaps.ndim != 1 or not np.all(np.isfinite(gaps)):
                raise GearError(f"tooth contact: {name} must be a row of finite numbers, got shape {gaps.shape}")
        for name, numbers in (("pair_variants", self.pair_variants), ("back_pair_variants", self.back_pair_variants)):
            if numbers.size and not (numbers.min() >= 0 and numbers.max() <= len(self.variants)):
                raise GearError(f"tooth contact: {name} must be 0 to {len(self.variants)}, got {numbers.max()}")

    def _check_curves(self, curves: ToothPairCurves) -> None:
        start, end = self._slice_range
        if not (start <= 1e-12 and end >= self.contact_ratio * (1.0 - 1e-12)):
            raise GearError(
                f"tooth contact: the stiffness must cover 0 to {self.contact_ratio:.6g} base pitches, "
                f"got {start:.6g} to {end:.6g}"
            )
        for name, curve in (("stiffness", curves.stiffness), ("deviation", curves.deviation)):
            ends = curve.knots[[0, -1]]
            if not max(abs(ends[0] - start), abs(ends[1] - end)) <= 1e-12 * (1.0 + abs(end)):
                raise GearError(
                    f"tooth contact: {name} must cover {start:.6g} to {end:.6g} base pitches, "
                    f"got {ends[0]:.6g} to {ends[1]:.6g}"
                )
        least, largest = _extremes(curves.stiffness)
        if least <= 0.0:
            raise GearError("tooth contact: the stiffness of a pair must be positive everywhere")
        if largest * self.shared_compliance >= 1.0:
            raise GearError(
                f"tooth contact: pairs of teeth cannot share {self.shared_compliance:.4g} m/N where one of them alone "
                f"yields {1.0 / largest:.4g} m/N; expected less"
            )

    @property
    def kernel_arguments(self) -> KernelArguments:
        """Arguments of `coupling.gears.contact.tooth_force_kernels.tooth_force` after phase, compression and rate.

        The row of numbers of `gearwhine.coupling.gears.contact.lookup_tables`, and the index at which it begins.
        """
        return self._law, 0

    @cached_property
    def _law(self) -> FloatArray:
        curves = (
            self.variant_curves
            if self.table_faces is None
            else face_force_table(self.table_faces, self.variant_curves, self.module)
        )
        return law_table(
            curves,
            self.entering,
            self.damping,
            self.damping_depth,
            self.shared_compliance,
            self.body_tilt,
            self.tooth_tilts,
        )

    @property
    def table_faces(self) -> FaceSlices | None:
        """Slices of the face for the lookup table, twice as many as those of static solutions.

        The ripple of coarser slices as they come into touch aliases, on the table's positions along the path, to low
        mesh harmonics: some nanometres.
        """
        faces = self.faces
        if faces is None or faces.half_span == 0.0 or faces.z.size > DEFAULT_SLICES:
            return faces
        return faces.in_slices(2 * faces.z.size)

    @cached_property
    def body_tilt(self) -> PiecewiseCubic | None:
        """Deflection g of the mesh by tilting gear bodies at the mean load [m], over the phase from 0 to 1.

        That of teeth alike; `tooth_tilts` have what differs. None where the face is loaded evenly or the bodies are not
        known, and of flanks without a mean load.
        """
        if not self._bodies_tilt:
            return None
        deflection = self.teeth_alike._tilt_at(np.arange(_TILT_PHASES) / _TILT_PHASES)
        # Slices come into touch one by one: higher harmonics are their steps.
        harmonics = np.fft.rfft(deflection)[: _TILT_HARMONICS + 1]
        values = np.fft.irfft(harmonics, _TILT_KNOTS) * (_TILT_KNOTS / deflection.size)
        return PiecewiseCubic(np.arange(_TILT_KNOTS + 1.0) / _TILT_KNOTS, _periodic_cubics(values))

    @cached_property
    def tooth_tilts(self) -> tuple[FloatArray, ...]:
        """Deflection of the mesh by tilting bodies [m] beside `body_tilt`, as the teeth in mesh differ.

        Cubics on even parts of each mesh period of the hunting period, (h, k, 4). Where that is long, those of the
        driver's teeth and of the driven gear's, whose sum lacks what the teeth of both do together.
        """
        if not (self._bodies_tilt and self.hunting_numbers):
            return ()
        by_gear = self.teeth_of(driver=True), self.teeth_of(driven=True)
        whole = self.hunting_numbers <= max(_MOST_HUNTING, *(law.hunting_numbers for law in by_gear))
        tilts = []
        # At the same phases and unsmoothed, unlike `body_tilt`: the difference vanishes where pairs are alike.
        alike = self.teeth_alike._tilt_at(np.arange(_TOOTH_TILT_PARTS) / _TOOTH_TILT_PARTS)
        for law in (self,) if whole else by_gear:
            phases = np.arange(law.hunting_numbers * _TOOTH_TILT_PARTS) / _TOOTH_TILT_PARTS
            # Some periods at once, for the memory of their slices.
            few = np.array_split(phases, math.ceil(phases.size / _TILT_PHASES))
            beside = np.concatenate([law._tilt_at(part) for part in few]) - np.tile(alike, law.hunting_numbers)
            tilts.append(_periodic_cubics(beside).reshape(-1, _TOOTH_TILT_PARTS, 4))
        return tuple(tilts)

    @property
    def _bodies_tilt(self) -> bool:
        return self.faces is not None and self.faces.shared.size > 0 and self.mean_load > 0.0

    def _tilt_at(self, phases: FloatArray) -> FloatArray:
        """Deflection of the mesh by tilting bodies at the mean load [m], at `phases` (n,), from the statics."""
        assert self.faces is not None
        places = self.pairs(phases)
        slices = places.faces
        assert slices is not None
        owner, column = np.nonzero(places.present)
        gap = slices.gap + places.pitch_gap[owner, column][:, None]
        force = np.full(phases.size, self.mean_load)
        level = replace(self.faces, shared=np.zeros((0, 0)))
        even, loads = face_equilibrium(level, slices.base, gap, slices.meeting, owner, force)
        tilting, _ = face_equilibrium(
            self.faces, slices.base, gap, slices.meeting, owner, force, touching=loads.touching
        )
        return tilting - even

    @property
    def entering(self) -> FloatArray:
        """Gap [m] and variant of every pair of the hunting period, shape (h, 2)."""
        entering = np.zeros((self.hunting_numbers, 2))
        if self.pitch_gaps.size:
            entering[:, 0] = self.pitch_gaps
        if self.pair_variants.size:
            entering[:, 1] = self.pair_variants
        return entering

    @cached_property
    def variant_curves(self) -> tuple[ToothPairCurves, ...]:
        """Curves of every variant of tooth pair without the shared compliance, that of sound teeth first."""
        return tuple(without_shared_compliance(curves, self.shared_compliance) for curves in self._single_pair_curves)

    @property
    def _single_pair_curves(self) -> tuple[ToothPairCurves, ...]:
        """Curves of every variant of tooth pair, as of one pair in contact: the shared compliance included."""
        return (ToothPairCurves(self.stiffness, self.deviation), *self.variants)

    @property
    def contact_range(self) -> tuple[float, float]:
        """Range of contact of a pair [base pitches]: from 0 to the contact ratio, or wider with corner contact."""
        start, end = self._slice_range
        reach = 0.0 if self.faces is None else self.faces.reach
        return start - reach, end + reach

    @property
    def enters_by_slices(self) -> bool:
        """Whether the lines of contact lie across the path, so that a pair enters and leaves slice by slice.

        The whole face of a spur gear enters at once, evenly loaded or not.
        """
        return self.faces is not None and self.faces.half_span > 0.0

    @property
    def has_corner_contact(self) -> bool:
        """Whether pairs touch beyond their path of contact."""
        return self._slice_range[0] < 0.0

    @property
    def _slice_range(self) -> tuple[float, float]:
        return float(self.stiffness.knots[0]), float(self.stiffness.knots[-1])

    @property
    def hunting_numbers(self) -> int:
        """Number of different pairs of the hunting period, h: 0 where all are alike."""
        return max(self.pitch_gaps.size, self.pair_variants.size)

    @property
    def hunting_period(self) -> int:
        """Mesh periods after which the law repeats: 1 where all pairs are alike."""
        return max(1, self.hunting_numbers)

    @cached_property
    def unloaded_mean_mesh_stiffness(self) -> float:
        """Mean mesh stiffness over a mesh period, with all pairs on the path in contact, whatever the load [N/m]."""
        inner = self.stiffness.knots[(self.stiffness.knots > 0.0) & (self.stiffness.knots < self.contact_ratio)]
        if self.shared_compliance == 0.0:
            on_path = self.stiffness.on_knots(np.concatenate([[0.0], inner, [self.contact_ratio]]))
            return on_path.mean * self.contact_ratio
        if self.faces is not None:
            spread = self.faces.shift.tobytes(), self.faces.coupling > 0.0
            return _mean_over_face(self.contact_ratio, self.stiffness, self.shared_compliance, *spread)
        # Between the hundreds of knots of any pair the mesh is smooth: midpoints are good to 1e-6.
        knots = np.unique(np.concatenate([[0.0, 1.0, self.contact_ratio % 1.0], inner % 1.0]))
        return float(np.diff(knots) @ self.mesh_stiffness(0.5 * (knots[:-1] + knots[1:])))

    def mesh_stiffness(self, phases: npt.ArrayLike, *, sound: bool = True) -> FloatArray:
        """Mesh stiffness with all pairs on the path of contact touching, as without profile deviations [N/m].

        Parameters
        ----------
        phases : array_like, shape (n,)
            Mesh periods.
        sound : bool
            Whether to treat all teeth as sound.
        """
        start, end = self.contact_range
        half = 0.0 if self.faces is None else self.faces.half_span
        # The end slices of a face are on the path in part before their middles are.
        places = self._positions(phases, start - half, end + half)
        if self.faces is not None and half > 0.0:
            at = places.position[..., None] + self.faces.shift
            part = self.faces.part_within(at, 0.0, self.contact_ratio)
        else:
            at = places.position[..., None]
            part = ((at >= 0.0) & (at < self.contact_ratio)).astype(np.float64)
        total = np.zeros(at.shape[0])
        for number, curves in enumerate(self.variant_curves[:1] if sound else self.variant_curves):
            these = part > 0.0
            if not sound:
                these &= (places.variant == number)[..., None]
            total += np.bincount(np.nonzero(these)[0], part[these] * curves.stiffness(at[these]), total.size)
        total /= at.shape[-1]
        return np.asarray(total / (1.0 + self.shared_compliance * total), dtype=np.float64)

    @property
    def event_phases(self) -> tuple[float, ...]:
        """Phases in [0, 1) at which a pair enters its path of contact (0) or leaves it, ascending.

        Empty for helical teeth, whose pairs enter and leave slice by slice, and for a constant number of pairs: a
        whole contact ratio with a stiffness and a deviation that continue over the period's ends in value and slope,
        and all pairs alike.
        """
        if self.enters_by_slices:
            return ()
        leaving = self.contact_ratio % 1.0
        if leaving > 1e-12 and 1.0 - leaving > 1e-12:
            return (0.0, leaving)
        steady = all(
            math.isclose(*curve(np.array([0.0, self.contact_ratio]), derivative), rel_tol=1e-9, abs_tol=floor)
            for derivative in (0, 1)
            for curve, floor in ((self.stiffness, 1e-9 * self.stiffness.mean), (self.deviation, 1e-15))
        )
        return () if steady and not self.hunting_numbers else (0.0,)

    @property
    def corner_phases(self) -> tuple[float, ...]:
        """Phases in [0, 1) at which the slope of a deviation or a stiffness jumps (a relief begins), ascending.

        Empty for helical teeth, whose slices pass the corner one after another.
        """
        if self.enters_by_slices:
            return ()
        phases: set[float] = set()
        for curves in self.variant_curves:
            for curve in (curves.deviation, curves.stiffness):
                phases.update((slope_jumps(curve) % 1.0).tolist())
        return tuple(sorted(phases))

    @property
    def teeth_alike(self) -> ToothContact:
        """The same law without pitch deviations and damaged teeth."""
        if self.hunting_period == 1:
            return self
        nothing, sound = np.zeros(0), np.zeros(0, dtype=np.int64)
        return replace(
            self,
            pitch_gaps=nothing,
            back_pitch_gaps=nothing,
            variants=(),
            pair_variants=sound,
            back_pair_variants=sound,
        )

    def teeth_of(self, *, driver: bool = False, driven: bool = False) -> ToothContact:
        """Return the law in which only the teeth of the named gears differ: its part with their period.

        Gaps are means over the pairs that the period has at one place, so that those of the driver and of the driven
        gear together, less those of neither, are those of both. The variant is the one that most of these pairs have.
        """
        z1, z2 = self.tooth_counts
        if not self.hunting_numbers or not z1 or (driver and driven):
            return self
        period = math.gcd(z1 if driver else z2 if driven else math.gcd(z1, z2), self.hunting_numbers)

        def most(variants: IntArray) -> IntArray:
            pairs = variants.reshape(-1, period).T if variants.size else variants
            return np.array([np.bincount(row).argmax() for row in pairs], dtype=np.int64)

        def mean(gaps: FloatArray) -> FloatArray:
            return np.asarray(gaps.reshape(-1, period).mean(axis=0)) if gaps.size else gaps

        return replace(
            self,
            pitch_gaps=mean(self.pitch_gaps),
            back_pitch_gaps=mean(self.back_pitch_gaps),
            pair_variants=most(self.pair_variants),
            back_pair_variants=most(self.back_pair_variants),
        )

    @property
    def back_flanks(self) -> ToothContact:
        """Contact law of the back flanks by their own phase: the same law, with gaps and variants of their own pairs.

        A helical face passes through the mesh from its other end.
        """
        if not self.hunting_numbers and self.faces is None:
            return self
        return replace(
            self,
            mean_load=-self.mean_load,
            faces=None if self.faces is None else replace(self.faces, shift=-self.faces.shift),
            pitch_gaps=self.back_pitch_gaps,
            back_pitch_gaps=self.pitch_gaps,
            pair_variants=self.back_pair_variants,
            back_pair_variants=self.pair_variants,
        )

    @property
    def carrying_flanks(self) -> ToothContact:
        """Contact law of the flanks that carry the mean load, by their own phase; see `back_flanks`."""
        return self.back_flanks if self.mean_load < 0.0 else self

    def with_damping(self, damping: float, depth: float = 0.0) -> ToothContact:
        """Return the same contact with another damping coefficient [N s/m], fading in over a depth [m]."""
        return replace(self, damping=damping, damping_depth=depth)

    def under_load(self, force: float) -> ToothContact:
        """Return the same contact with another mean load [N], negative where the back flanks carry it."""
        return replace(self, mean_load=force)

    def pair_positions(self, phases: npt.ArrayLike) -> PairPositions:
        """Positions of the pairs at `phases` (n,)."""
        return self._positions(phases, *self.contact_range)

    def _positions(self, phases: npt.ArrayLike, start: float, end: float) -> PairPositions:
        """Positions of the pairs at `phases` (n,); those from `start` to `end` are present."""
        phase = np.atleast_1d(np.asarray(phases, dtype=np.float64))
        number = np.floor(phase)
        fraction = phase - number
        number = np.where(fraction >= 1.0, number + 1.0, number)
        fraction = np.where(fraction >= 1.0, 0.0, fraction)
        behind = np.arange(math.floor(start), math.ceil(end))
        position = fraction[:, None] + behind
        present = (position >= start) & (position < end)
        entered = number.astype(np.int64)[:, None] - behind
        variant = self.pair_variants[entered % self.pair_variants.size] if self.pair_variants.size else entered * 0
        return PairPositions(position, present, variant, entered)

    def pairs(self, phases: npt.ArrayLike) -> PairStates:
        """Positions, stiffness and deviation of the pairs at `phases` (n,)."""
        places = self.pair_positions(phases)
        position, present, variant, entered = places.position, places.present, places.variant, places.entered
        stiffness, deviation = np.zeros(position.shape), np.full(position.shape, np.inf)
        state = None
        if self.faces is None:
            for number, curves in enumerate(self.variant_curves):
                these = present & (variant == number)
                stiffness[these] = curves.stiffness(position[these])
                deviation[these] = curves.deviation(position[these])
        else:
            state = face_slice_states(self.faces, self.variant_curves, position[present], variant[present])
            nearest = state.gap + self.faces.changes.min(axis=0)
            deviation[present] = np.where(state.meeting, nearest, np.inf).min(axis=1)
        gap = self.pitch_gaps[entered % self.pitch_gaps.size] if self.pitch_gaps.size else np.zeros(position.shape)
        return PairStates(position, present, variant, entered, stiffness, deviation + gap, gap, state)

    def pair_forces(self, phases: npt.ArrayLike, compression: npt.ArrayLike) -> FloatArray:
        """Elastic force of each pair [N], shape (n, m), at `phases` (n,) and `compression` (n,) [m]."""
        states = self.pairs(phases)
        total = np.atleast_1d(np.asarray(compression, dtype=np.float64))
        after_shared = total
        # The pairs' force is convex in their own compression: from above Newton's method only releases pairs.
        for _ in range(states.stiffness.shape[1] + 1):
            touching = states.stiffness * (states.deviation < after_shared[:, None])
            depth = np.where(touching > 0.0, after_shared[:, None] - states.deviation, 0.0)
            excess = after_shared - total + self.shared_compliance * (touching * depth).sum(axis=1)
            after_shared = after_shared - excess / (1.0 + self.shared_compliance * touching.sum(axis=1))
        return np.asarray(
            states.stiffness * np.maximum(0.0, after_shared[:, None] - states.deviation), dtype=np.float64
        )


def _periodic_cubics(values: FloatArray) -> FloatArray:
    """Cubics of a spline through values on even parts of a period, (n, 4), each in a variable from 0 to 1."""
    curve = CubicSpline(np.arange(values.size + 1.0), np.append(values, values[0]), bc_type="periodic")
    return piecewise.unit_coefficients(curve)


@lru_cache(maxsize=64)  # keyed by identity of the curve, which many contacts share
def _extremes(stiffness: PiecewiseCubic) -> tuple[float, float]:
    """Least and largest value of a stiffness at its knots and between them [N/m]."""
    knots = stiffness.knots
    between = np.concatenate([knots[:-1] + part * np.diff(knots) for part in (0.0, 0.25, 0.5, 0.75)])
    values = stiffness(np.append(between, knots[-1]))
    return float(values.min()), float(values.max())


@lru_cache(maxsize=64)  # keyed by identity of the curve: pairs that differ in their flanks alone share it
def _mean_over_face(
    contact_ratio: float, stiffness: PiecewiseCubic, shared: float, shift: bytes, coupled: bool
) -> float:
    """Mean mesh stiffness with all slices on the path in contact, whatever their gaps [N/m]."""
    shifts = np.frombuffer(shift)
    faces = FaceSlices(shifts, 1.0, shifts, 0.0 * shifts, 1.0, float(coupled))
    contact = ToothContact(contact_ratio, stiffness, stiffness, faces=faces, shared_compliance=shared)
    return float(contact.mesh_stiffness((np.arange(_MEAN_PHASES) + 0.5) / _MEAN_PHASES).mean())


@lru_cache(maxsize=16)  # keyed by identity of the contact, whose table for the kernels is kept with the result
def law_between_rims(contact: ToothContact, behind: float) -> ToothContact:
    """Contact law of a pair without that part of its shared compliance which lies behind the rims, `behind` [m/N].

    The law of the pairs without what they share stays the same.
    """
    if behind == 0.0:
        return contact
    return replace(
        contact,
        stiffness=without_shared_compliance(ToothPairCurves(contact.stiffness, contact.deviation), behind).stiffness,
        variants=tuple(without_shared_compliance(curves, behind) for curves in contact.variants),
        shared_compliance=contact.shared_compliance - behind,
    )


def contact_flattening(model: StiffnessModel, geometry: GearPairGeometry) -> Flattening:
    """Compliance of the contact of two flanks in a model [m/N], by position in base pitches.

    Other models than those of teeth have the flattening of Yang and Sun's constant.
    """
    if isinstance(model, CompliantTeeth):
        return partial(model.contact_compliance, geometry)
    constant = hertz_compliance(geometry) / math.cos(geometry.driver.base_helix_angle)
    return lambda position: np.full_like(position, constant)


def slices_of_teeth(faces: FaceSlices, model: StiffnessModel, geometry: GearPairGeometry) -> FaceSlices:
    """Return slices with the contact flattening and the shared body compliance of a tooth model.

    Given springs lie evenly over the face, each slice for itself; one of the whole mesh is everywhere at the same part
    of its period, whatever the helix. Other models leave the slices as they are, with the flattening of Yang and Sun's
    constant.
    """
    if isinstance(model, GIVEN_SPRINGS):
        stiffness = model.pair_stiffness(geometry)
        knots = stiffness.knots
        between = knots[:-1, None] + np.linspace(0.0, 1.0, _TRIED) * np.diff(knots)[:, None]
        # The law of the slices splits a spring into teeth and flattening: any split with the same sum does.
        flattening = 2.0 * float(stiffness(between).max()) / geometry.face_width
        shift = 0.0 * faces.shift if is_whole_mesh(float(knots[-1]), geometry) else faces.shift
        return replace(faces, flattening=flattening, coupling=0.0, shift=shift)
    if not isinstance(model, CompliantTeeth):
        return faces
    return replace(
        faces,
        flattening=1.0 / (model.mean_flattening(geometry) * geometry.face_width),
        shared=model.shared_over_face(geometry),
    )


def tooth_contact(
    geometry: GearPairGeometry,
    model: StiffnessModel,
    damping: float = 0.0,
    *,
    corner_contact: bool = False,
    faces: FaceSlices | None = None,
) -> ToothContact:
    """Contact law of a gear pair.

    Parameters
    ----------
    geometry : GearPairGeometry
    model : StiffnessModel
        See `gearwhine.coupling.gears.stiffness.models`.  A model of the whole mesh (range exactly one base pitch, when
        the contact ratio is not) has no single pairs: the profile deviation is then zero.  Pitch deviations remain,
        one pair for each mesh period.  Weber's contact is frozen at the model's own ``force``, without one at 300 N/mm
        of face width: give it the mesh force that the contact is loaded with, as
        ``ElasticRingStiffness(force=...)`` or by `stiffness_under_load`, else the transmission error is off by some per
        cent.
    damping : float
        Damping coefficient [N s/m], e.g. from `mesh_damping`.
    corner_contact : bool
        Whether pairs touch beyond their path of contact as well, where a load closes the gap to a corner.
    faces : FaceSlices or None
        Slices of the face; None for those of aligned flanks, see `aligned_slices`: with slices where the teeth are
        helical or the flanks uneven over the face, a uniform load else.

    Returns
    -------
    ToothContact

    Raises
    ------
    GearError
        Damaged teeth or corner contact with a model of the whole mesh, which has no single pairs.
    """
    if faces is None:
        faces = aligned_slices(geometry)
    variants = pair_variants(geometry)
    stiffness = model.pair_stiffness(geometry)
    flattening = contact_flattening(model, geometry)
    curves = tooth_pair_curves(geometry, stiffness, flattening, variants.faults, corner_contact=corner_contact)
    none = np.zeros(0)
    deviating = any(geometry.driver.pitch_deviations) or any(geometry.driven.pitch_deviations)
    contact = ToothContact(
        float(stiffness.knots[-1]),
        curves[0].stiffness,
        curves[0].deviation,
        damping,
        geometry.back_flank_offset,
        pitch_gaps(geometry) if deviating else none,
        back_flank_pitch_gaps(geometry) if deviating else none,
        variants=curves[1:],
        pair_variants=variants.of_pair if len(curves) > 1 else none.astype(np.int64),
        back_pair_variants=variants.of_back_pair if len(curves) > 1 else none.astype(np.int64),
        faces=None if faces is None else slices_of_teeth(faces, model, geometry),
        module=geometry.driver.module,
        shared_compliance=shared_compliance(model, geometry),
        tooth_counts=(abs(geometry.driver.tooth_count), abs(geometry.driven.tooth_count)),
    )
    return contact if faces is None else with_path_slope(contact, geometry, faces.path_slope)


def with_path_slope(contact: ToothContact, geometry: GearPairGeometry, slope: float) -> ToothContact:
    """Return a contact whose gaps rise along the line of action by a slope [1] from the pitch point.

    The spring of a whole mesh has no place on it, and stays as it is.
    """
    if slope == 0.0 or is_whole_mesh(contact.contact_ratio, geometry):
        return contact
    scale = slope * geometry.base_pitch
    start, rise = -scale * geometry.pitch_point_position, scale * geometry.contact_ratio / contact.contact_ratio
    variants = tuple(replace(curves, deviation=curves.deviation.plus(start, rise)) for curves in contact.variants)
    return replace(contact, deviation=contact.deviation.plus(start, rise), variants=variants)


def places_on_line_of_action(contact: ToothContact, geometry: GearPairGeometry, positions: FloatArray) -> FloatArray:
    """Places of the slices along the line of action, from the pitch point [m], shape (..., s).

    The spring of a whole mesh stands in the middle of the path of contact, as it has no place of its own.

    Parameters
    ----------
    contact : ToothContact
        Contact with slices of its face.
    geometry : GearPairGeometry
    positions : ndarray, shape (...)
        Positions of the middle of the face [base pitches].
    """
    assert contact.faces is not None
    at = positions[..., None] + contact.faces.shift
    if is_whole_mesh(contact.contact_ratio, geometry):
        at = np.full_like(at, 0.5)
    # A model with a contact ratio of its own has its load on the teeth's whole path.
    path = geometry.base_pitch * geometry.contact_ratio / contact.contact_ratio
    return np.asarray(at * path - geometry.base_pitch * geometry.pitch_point_position)


def with_flanks_of(contact: ToothContact, geometry: GearPairGeometry) -> ToothContact:
    """Return a contact with the deviations of a pair that differs only in the modifications of its flanks.

    The result equals `tooth_contact` of that pair; stiffness and reach of the teeth are reused.
    """
    if is_whole_mesh(contact.contact_ratio, geometry):
        return contact  # the deviation of a whole-mesh model is zero
    start, end = float(contact.stiffness.knots[0]), float(contact.stiffness.knots[-1])
    sound, *others = (
        pair_deviation(geometry, start, end, corner_contact=contact.has_corner_contact, faults=faults_of_variant)
        for faults_of_variant in pair_variants(geometry).faults
    )
    variants = (
        replace(variant, deviation=faults_of_variant)
        for variant, faults_of_variant in zip(contact.variants, others, strict=True)
    )
    other = replace(contact, deviation=sound, variants=tuple(variants))
    return other if contact.faces is None else with_path_slope(other, geometry, contact.faces.path_slope)
