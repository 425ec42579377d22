"""Centrifugal force on balls: contact equilibrium of balls that orbit in a bearing.

The centrifugal force F_c on an orbiting ball makes its two contact angles differ (Jones 1960; Harris and Kotzalas
2006). With f the force of the inner contact, the outer one carries f + F_c r, r the radial direction. A contact under
the force g reaches by A + c |g|^{2/3} from the ball to its groove's centre, c = K^{−2/3}, and both together reach from
centre to centre:

    (A_i + c_i |f|^{2/3}) f/|f| + (A_o + c_o |f + F_c r|^{2/3}) (f + F_c r)/|f + F_c r| = v

The left side is the gradient of a complementary energy that is convex in f,

    ψ(f) = A_i |f| + ⅗ c_i |f|^{5/3} + A_o |f + F_c r| + ⅗ c_o |f + F_c r|^{5/3},

so f minimises ψ(f) − f·v, the ball's energy is φ(v) = max over f of f·v − ψ(f), convex as every such maximum is, and

    ∂φ/∂v = f,   ∂²φ/∂v² = [∂²ψ/∂f²]⁻¹.

The ball leaves the inner ring, f = 0, where the outer groove alone holds it within the inner one's reach; far beyond
any groove, as in an iteration, it leaves the outer ring likewise, f = −F_c r. In terms of the ball's place the same
problem is a narrow curved valley, in which Newton's method is slow for slow balls. The gyroscopic moment, and with it
friction, is left out; the ball orbits at the speed of its nominal contact angle.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.trust_region import Local, minimise
from gearwhine.rotors.errors import EquilibriumError
from gearwhine.rotors.rolling_bearings.element_contacts import (
    ElementLoads,
    RowEnergy,
    ball_kinematics,
    ball_loads,
    row_energy,
)
from gearwhine.rotors.rolling_bearings.rows import BallRow

# Closure error of the contacts, as a part of the distance between the grooves' centres: target and largest accepted.
# The largest accepted error also limits the force error, relative to the larger of static and centrifugal force.
_CLOSURE_GOAL = 1e-15
_GAP_LIMIT = 1e-12
# Newton's method on all balls at once: a ball with an error below this has converged.
_CONVERGED_BALL_ERROR = 1e-14
_NEWTON_STEPS, _HALVINGS = 12, 6


@dataclass(frozen=True)
class CentrifugalBalls:
    """Contacts of a row of balls under a centrifugal force each, ``thrown`` [N]."""

    row: BallRow
    azimuths: FloatArray
    thrown: float

    def energy(self, q: FloatArray) -> RowEnergy:
        """Energy and its derivatives over q, every ball where its forces balance."""
        v, motion = self._vectors(q)
        force = self._inner_forces(v)
        values, _, hessians = self._reaches(force)
        value = (force * v).sum(axis=1) - values.sum(axis=0)
        # A ball in contact with one ring only adds no stiffness.
        hessian = np.zeros((self.row.count, 2, 2))
        both = force.any(axis=1) & (force + self._outwards).any(axis=1)
        hessian[both] = np.linalg.inv(hessians.sum(axis=0)[both])
        return row_energy(motion, value, force, hessian)

    def loads(self, q: FloatArray) -> ElementLoads:
        """Return the loads of every ball at both rings."""
        v, _ = self._vectors(q)
        inner = self._inner_forces(v)
        outer = inner + self._outwards
        inside, outside = np.linalg.norm(inner, axis=1), np.linalg.norm(outer, axis=1)
        approach = (inside / self.row.inner_contact.stiffness) ** (2.0 / 3.0)
        approach = approach + (outside / self.row.outer_contact.stiffness) ** (2.0 / 3.0)
        lines = np.where((inside > 0.0)[:, None], inner, v)
        return ball_loads(self.row, self.azimuths, (inside, outside), (lines, outer), approach)

    def _inner_forces(self, v: FloatArray) -> FloatArray:
        """Find the inner contacts' forces on the balls' grooves, (n, 2), N, by Newton's method on all balls at once.

        |∂ψ/∂f − v| falls along the Newton step of a convex ψ, so a step is halved until it does. The trust region takes
        the balls that this leaves open: those about to lose a contact, where ψ has a corner.
        """
        row, start = self.row, self._first_forces(v)
        force, (error, gradient, hessian) = start, self._closure(start, v)
        for _ in range(_NEWTON_STEPS):
            if (error <= _CONVERGED_BALL_ERROR).all():
                break
            step, share = np.linalg.solve(hessian, gradient[:, :, None])[:, :, 0], np.ones((row.count, 1))
            for _ in range(_HALVINGS):
                trial = force - share * step
                new_error, new_gradient, new_hessian = self._closure(trial, v)
                better = new_error < error
                if better[error > _CONVERGED_BALL_ERROR].all():
                    break
                share[~better] *= 0.5
            force = np.where(better[:, None], trial, force)
            error = np.where(better, new_error, error)
            gradient = np.where(better[:, None], new_gradient, gradient)
            hessian = np.where(better[:, None, None], new_hessian, hessian)
        for ball in np.flatnonzero(~(error <= _CONVERGED_BALL_ERROR) | ~start.any(axis=1)):
            force[ball] = self._inner_force(v[ball])
        return force

    def _first_forces(self, v: FloatArray) -> FloatArray:
        """First estimate of the inner contacts' forces, (n, 2) [N]; zero of a ball that the outer groove alone holds.

        Balls pressed by more than F_c have the static force. Others lean on the outer groove's A_o/F_c across and on
        the slope of its approach along the radius.
        """
        row, approach = self.row, (self.thrown / self.row.outer_contact.stiffness) ** (2.0 / 3.0)
        distance, gap = np.linalg.norm(v, axis=1), v - np.array([self._outer_arm + approach, 0.0])
        static = row.stiffness * np.maximum(distance - row.groove_distance, 0.0) ** 1.5
        open_by = np.linalg.norm(gap, axis=1)
        lean = gap / np.where(open_by > 0.0, open_by, 1.0)[:, None]
        soft = (self._outer_arm * lean[:, 1] ** 2 + approach * lean[:, 0] ** 2 / 1.5) / self.thrown
        light = np.clip((open_by - self._inner_arm) / soft, 0.0, self.thrown)[:, None] * lean
        pressed = static > self.thrown
        return np.asarray(
            np.where(pressed[:, None], (static / np.maximum(distance, self._inner_arm))[:, None] * v, light)
        )

    def _closure(self, force: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """∂ψ/∂f − v by its size over the distance of the grooves' centres, (n,), itself and its slope ∂²ψ/∂f²."""
        _, gradients, hessians = self._reaches(force)
        gradient = gradients[0] + gradients[1] - v
        error = np.hypot(gradient[:, 0], gradient[:, 1]) / self.row.groove_distance
        return error, gradient, hessians[0] + hessians[1]

    def _reaches(self, force: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """`_reach` of the inner and the outer contacts together under the inner contacts' forces, (2, n, ...)."""
        return _reach(*self._contacts, np.stack([force, force + self._outwards]))

    @cached_property
    def _contacts(self) -> tuple[FloatArray, FloatArray]:
        """Stiffness and arm of the contact at either ring, (2, 1)."""
        stiffness = (self.row.inner_contact.stiffness, self.row.outer_contact.stiffness)
        return np.array(stiffness)[:, None], np.array([self._inner_arm, self._outer_arm])[:, None]

    def _inner_force(self, v: FloatArray) -> FloatArray:
        """Force of the inner contact on one ball's groove, (2,) [N]."""
        row, radial = self.row, np.array([1.0, 0.0])
        alone = self._outer_arm + (self.thrown / row.outer_contact.stiffness) ** (2.0 / 3.0)
        gap = v - alone * radial
        if np.linalg.norm(gap) <= self._inner_arm:
            return np.zeros(2)
        inward = self._inner_arm + (self.thrown / row.inner_contact.stiffness) ** (2.0 / 3.0)
        if np.linalg.norm(v + inward * radial) <= self._outer_arm:
            return -self._outwards
        distance = float(np.linalg.norm(v))
        static = row.stiffness * max(distance - row.groove_distance, 0.0) ** 1.5
        scale = max(static, self.thrown)
        start = static / scale * v / distance if static > self.thrown else gap / float(np.linalg.norm(gap))

        def local(part: FloatArray) -> Local:
            force = scale * part[None]
            values, gradients, hessians = self._reaches(force)
            inside, outside, work = float(values[0, 0]), self._outer_rise(force[0]), float(force[0] @ v)
            return Local(
                value=(inside + outside - work) / scale,
                gradient=gradients[:, 0].sum(axis=0) - v,
                hessian=hessians[:, 0].sum(axis=0) * scale,
                noise=(inside + abs(outside) + abs(work)) / scale,
                force=row.groove_distance,
            )

        minimum = minimise(local, start, 0.5, _CLOSURE_GOAL)
        # The force of a ball that barely touches has no certain direction: then its possible error decides.
        closure = local(minimum.place)
        if (
            minimum.residual > _GAP_LIMIT
            and np.linalg.norm(np.linalg.solve(closure.hessian, closure.gradient)) > _GAP_LIMIT
        ):
            raise EquilibriumError(
                f"a ball's contacts miss their grooves by {minimum.residual:.3g} of their centres' distance after "
                f"{minimum.iterations} steps; expected {_GAP_LIMIT:g}: check that geometry and speed are in m and rad/s"
            )
        return np.asarray(scale * minimum.place)

    def _outer_rise(self, force: FloatArray) -> float:
        """Complementary energy of the outer contact under f + F_c r less that under F_c r, with a small f's digits."""
        total = float(np.linalg.norm(force + self._outwards))
        rise = (2.0 * self.thrown * force[0] + float(force @ force)) / (total + self.thrown)
        work = 0.6 * self.thrown * (self.thrown / self.row.outer_contact.stiffness) ** (2.0 / 3.0)
        part = rise / self.thrown
        grown = math.expm1(5.0 / 3.0 * math.log1p(part)) if part > -0.5 else (total / self.thrown) ** (5.0 / 3.0) - 1.0
        return float(self._outer_arm * rise + work * grown)

    @cached_property
    def _kinematics(self) -> tuple[FloatArray, FloatArray]:
        return ball_kinematics(self.row, self.azimuths)

    def _vectors(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        start, motion = self._kinematics
        return start + motion @ q, motion

    @property
    def _outwards(self) -> FloatArray:
        return np.array([self.thrown, 0.0])

    @property
    def _inner_arm(self) -> float:
        return (self.row.inner_groove - 0.5) * self.row.ball_diameter

    @property
    def _outer_arm(self) -> float:
        return (self.row.outer_groove - 0.5) * self.row.ball_diameter


def _reach(stiffness: FloatArray, arm: FloatArray, forces: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the complementary energy A |g| + ⅗ c |g|^{5/3} of every force g, its gradient and its Hessian.

    The shapes are (...), (..., 2) and (..., 2, 2) for forces (..., 2).
    """
    size = np.hypot(forces[..., 0], forces[..., 1])
    safe = np.where(size > 0.0, size, 1.0)
    normal = forces / safe[..., None]
    approach = np.cbrt(size / stiffness) ** 2
    reach = arm + approach
    across = reach / safe
    hessian = (approach / (1.5 * safe) - across)[..., None, None] * normal[..., :, None] * normal[..., None, :]
    hessian[..., 0, 0] += across
    hessian[..., 1, 1] += across
    return size * (arm + 0.6 * approach), reach[..., None] * normal, hessian
