r"""The contact law of a gear pair: what its teeth answer to a compression of the mesh.

At phase ``p`` (mesh periods of the driver) the pairs in contact are at ``s_j = frac(p) + j < eps``.  Each has
a stiffness ``k(s)`` and a profile deviation ``d(s) >= 0``, the gap that tip relief leaves it.  With the
compression ``delta`` of the mesh along the line of action and its rate ``v``:

    F = sum_j k(s_j) max(0, delta - d(s_j)) + c r v,    r = min(1, max_j(delta - d(s_j)) / depth)
    U = sum_j 1/2 k(s_j) max(0, delta - d(s_j))^2

The damping fades in over the first ``depth`` of compression: full at first touch, the force would jump at every
impact, and would pull just before the teeth part.  ``dU/d delta = F - c r v``; the teeth's turning does the work
``dU/dp`` per mesh period on the contact besides (the parametric power ``dU/dp * dp/dt``), which an energy balance
of a prescribed speed has to carry.
The mesh never pulls: where the damping would take F below zero, F is zero and the springs' power is lost.  The whole
mesh may separate, and returns through the same law.

Pitch deviations add a gap ``f_n`` to the pair that enters at phase n, so to the pair j at phase p the gap of
``n = floor(p) - j``: ``d(s_j) + f_n`` then stands for ``d(s_j)`` above (:mod:`coupling.gears.pitch_gaps`).  It is
constant while the pair is in contact, so ``dU/dp`` keeps its form, and repeats with the hunting period.

The idle flanks are the same law in a mirror: phase ``back_flank_offset - p``, their own compression (the
motion projected on the mirrored line of action, less the backlash), and ``dU/dp`` of opposite sign; their own
pitch gaps come with `ToothContact.back_flanks`.

Contact is taken on the theoretical path: a deflected tooth without relief comes in and goes out with a
step in force, as in the sources.  The step stands exactly at `event_phases`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from coupling.gears import piecewise
from coupling.gears.deviation import tip_relief_deviation
from coupling.gears.errors import GearError
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.piecewise import PiecewiseCubic
from coupling.gears.pitch_gaps import back_flank_pitch_gaps, pitch_gaps
from coupling.gears.stiffness_models import StiffnessModel

FloatArray = npt.NDArray[np.float64]
KernelArguments = tuple[float, FloatArray, FloatArray, FloatArray, float, FloatArray, float]


@dataclass(frozen=True, eq=False)
class PairStates:
    """The pairs of teeth at some phases, at most m of them at once.

    Attributes
    ----------
    position : ndarray, shape (n, m)
        Position on the path of contact, base pitches.
    present : ndarray of bool, shape (n, m)
        Whether the pair is on its path of contact.
    stiffness : ndarray, shape (n, m)
        [N/m], 0 where absent.
    deviation : ndarray, shape (n, m)
        Gap by profile and pitch [m], infinite where absent.
    """

    position: FloatArray
    present: npt.NDArray[np.bool_]
    stiffness: FloatArray
    deviation: FloatArray


@dataclass(frozen=True, eq=False)
class ToothContact:
    """The contact law's numbers, ready for the kernels.

    Attributes
    ----------
    contact_ratio : float
        Length of a pair's contact in base pitches.
    stiffness : PiecewiseCubic
        Stiffness of one pair [N/m] over [0, contact_ratio], equally spaced knots.
    deviation : PiecewiseCubic
        Gap of one pair [m] over [0, contact_ratio], any knots.
    damping : float
        Damping coefficient while the mesh is pressed together [N s/m].
    back_flank_offset : float
        Phase of the idle flanks, see `GearPairGeometry.back_flank_offset`.
    pitch_gaps, back_pitch_gaps : ndarray, shape (h,)
        What pitch deviations add to the gap of the pair that enters at phase n, at n mod h [m], on the working and
        on the idle flanks; empty for none.
    damping_depth : float
        Compression up to which the damping fades in [m]; 0 for all of it at first touch.
    """

    contact_ratio: float
    stiffness: PiecewiseCubic
    deviation: PiecewiseCubic
    damping: float = 0.0
    back_flank_offset: float = 0.0
    pitch_gaps: FloatArray = field(default_factory=lambda: np.zeros(0))
    back_pitch_gaps: FloatArray = field(default_factory=lambda: np.zeros(0))
    damping_depth: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.contact_ratio) and self.contact_ratio >= 1.0):
            raise GearError(f"tooth contact: contact_ratio must be at least 1, got {self.contact_ratio!r}")
        if not (math.isfinite(self.damping) and self.damping >= 0.0):
            raise GearError(f"tooth contact: damping must be at least 0 N s/m, got {self.damping!r}")
        if not (math.isfinite(self.damping_depth) and self.damping_depth >= 0.0):
            raise GearError(f"tooth contact: damping_depth must be at least 0 m, got {self.damping_depth!r}")
        for name, curve in (("stiffness", self.stiffness), ("deviation", self.deviation)):
            ends = curve.knots[[0, -1]]
            if not np.allclose(ends, [0.0, self.contact_ratio], rtol=1e-12, atol=1e-12):
                raise GearError(
                    f"tooth contact: {name} must cover 0 to {self.contact_ratio:.6g} base pitches, "
                    f"got {ends[0]:.6g} to {ends[1]:.6g}"
                )
        for name, gaps in (("pitch_gaps", self.pitch_gaps), ("back_pitch_gaps", self.back_pitch_gaps)):
            if gaps.ndim != 1 or not np.all(np.isfinite(gaps)):
                raise GearError(f"tooth contact: {name} must be a row of finite numbers, got shape {gaps.shape}")
        spacing = np.diff(self.stiffness.knots)
        if not np.allclose(spacing, spacing[0], rtol=1e-9, atol=0.0):
            raise GearError("tooth contact: the stiffness needs equally spaced knots")
        if np.any(self.stiffness(np.linspace(0.0, self.contact_ratio, 4 * spacing.size + 1)) <= 0.0):
            raise GearError("tooth contact: the stiffness of a pair must be positive everywhere")

    @property
    def kernel_arguments(self) -> KernelArguments:
        """Everything `coupling.gears.kernels.tooth_force` wants after phase, compression and rate."""
        return (
            float(self.contact_ratio),
            np.ascontiguousarray(self.stiffness.coefficients, dtype=np.float64),
            np.ascontiguousarray(self.deviation.knots, dtype=np.float64),
            np.ascontiguousarray(self.deviation.coefficients, dtype=np.float64),
            float(self.damping),
            np.ascontiguousarray(self.pitch_gaps, dtype=np.float64),
            float(self.damping_depth),
        )

    @property
    def largest_pair_count(self) -> int:
        """The most pairs that are ever on the path of contact at once."""
        return math.ceil(self.contact_ratio)

    @property
    def hunting_period(self) -> int:
        """Mesh periods after which the law repeats: 1 but for pitch deviations."""
        return max(1, self.pitch_gaps.size)

    @property
    def mean_stiffness(self) -> float:
        """Mean over a mesh period of the stiffness with all pairs touching [N/m]."""
        return self.stiffness.mean * self.contact_ratio

    @property
    def event_phases(self) -> tuple[float, ...]:
        """Phases in [0, 1) where a pair enters (0) or leaves, ascending.

        Empty for a mesh that is one unchanging number of pairs, i.e. a whole contact ratio with a stiffness
        and a deviation that join up at the period's ends in value and slope, and no pitch deviations.
        """
        leaving = self.contact_ratio % 1.0
        if leaving > 1e-12 and 1.0 - leaving > 1e-12:
            return (0.0, leaving)
        steady = all(
            math.isclose(*curve(np.array([0.0, self.contact_ratio]), derivative), rel_tol=1e-9, abs_tol=floor)
            for derivative in (0, 1)
            for curve, floor in ((self.stiffness, 1e-9 * self.stiffness.mean), (self.deviation, 1e-15))
        )
        return () if steady and not self.pitch_gaps.size else (0.0,)

    @property
    def back_flank_event_phases(self) -> tuple[float, ...]:
        """Phases in [0, 1) where a pair of idle flanks would enter or leave, ascending."""
        return tuple(sorted((self.back_flank_offset - phase) % 1.0 for phase in self.event_phases))

    @property
    def corner_phases(self) -> tuple[float, ...]:
        """Phases in [0, 1) where a deviation's slope jumps (tip relief begins), ascending."""
        knots = self.deviation.knots[1:-1]
        widths = np.diff(self.deviation.knots)
        coefficients = self.deviation.coefficients
        after = coefficients[1:, 1] / widths[1:]
        before = (coefficients[:-1] @ np.array([0.0, 1.0, 2.0, 3.0])) / widths[:-1]
        jumps = np.abs(after - before) > 1e-9 * max(float(np.max(np.abs(after), initial=0.0)), 1e-30)
        return tuple(sorted({float(phase) for phase in knots[jumps] % 1.0}))

    @property
    def back_flanks(self) -> ToothContact:
        """The law of the idle flanks by their own phase: the same, with their own pitch gaps."""
        if not (self.pitch_gaps.size or self.back_pitch_gaps.size):
            return self
        return replace(self, pitch_gaps=self.back_pitch_gaps, back_pitch_gaps=self.pitch_gaps)

    def with_damping(self, damping: float, depth: float = 0.0) -> ToothContact:
        """The same contact with another damping coefficient [N s/m], fading in over a depth [m]."""
        return replace(self, damping=damping, damping_depth=depth)

    def pairs(self, phases: npt.ArrayLike) -> PairStates:
        """Where the pairs are at `phases` (n,), and how stiff and how relieved they are."""
        phase = np.atleast_1d(np.asarray(phases, dtype=np.float64))
        number = np.floor(phase)
        fraction = phase - number
        number = np.where(fraction >= 1.0, number + 1.0, number)
        fraction = np.where(fraction >= 1.0, 0.0, fraction)
        behind = np.arange(self.largest_pair_count)
        position = fraction[:, None] + behind
        present = position < self.contact_ratio
        deviation = self.deviation(position)
        if self.pitch_gaps.size:
            entered = number.astype(np.int64)[:, None] - behind
            deviation = deviation + self.pitch_gaps[entered % self.pitch_gaps.size]
        return PairStates(
            position=position,
            present=present,
            stiffness=np.where(present, self.stiffness(position), 0.0),
            deviation=np.where(present, deviation, np.inf),
        )

    def pair_forces(self, phases: npt.ArrayLike, compression: npt.ArrayLike) -> FloatArray:
        """Elastic force of each pair [N], shape (n, m), at `phases` (n,) and `compression` (n,) [m]."""
        states = self.pairs(phases)
        approach = np.atleast_1d(np.asarray(compression, dtype=np.float64))[:, None] - states.deviation
        return np.asarray(states.stiffness * np.maximum(0.0, approach), dtype=np.float64)


def tooth_contact(geometry: GearPairGeometry, model: StiffnessModel, damping: float = 0.0) -> ToothContact:
    """Contact law of a gear pair.

    Parameters
    ----------
    geometry : GearPairGeometry
    model : StiffnessModel
        See `coupling.gears.stiffness_models`.  A model of the whole mesh (range exactly one base pitch, when
        the contact ratio is not) leaves no single pairs to relieve: the deviation is then zero.  Pitch deviations
        remain, as if each mesh period were one pair's alone.
    damping : float
        Damping coefficient [N s/m], e.g. from `mesh_damping`.

    Returns
    -------
    ToothContact
    """
    stiffness = model.pair_stiffness(geometry)
    length = float(stiffness.knots[-1])
    whole_mesh = length == 1.0
    deviation = piecewise.constant(0.0, length) if whole_mesh else tip_relief_deviation(geometry, length)
    return ToothContact(
        length,
        stiffness,
        deviation,
        damping,
        geometry.back_flank_offset,
        pitch_gaps(geometry),
        back_flank_pitch_gaps(geometry),
    )
