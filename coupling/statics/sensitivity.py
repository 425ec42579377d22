r"""Sensitivity of the operating point: gradients of misalignment, K_Hβ and transmission error by the adjoint method.

Let R(x, p) = 0 be the equilibrium of the static machine (:mod:`gearwhine.coupling.statics.operating_point`) and K_T =
∂R/∂x its tangent, bearings and flanks included. For an outcome y(x) with the gradient c = ∂y/∂x, one adjoint solve

    K_Tᵀ λ = c      gives      dy/dp = -λᵀ ∂R/∂p

for every parameter p (Haug, Choi and Komkov, Design Sensitivity Analysis of Structural Systems, 1986, section 1.2).

- Bearing with the deflection δ = Eᵀ x and the force f, its law multiplied by 1 + p: dy/dp = -(Eᵀ λ) · f.
- Bearing moved along its shaft by p, its seat staying: with w' the slope along z of the shaft's motions less that of
  the seat's, and t = ∂f/∂δ, dy/dp = -w'(λ) · f - (Eᵀ λ) · t w'(x). A seat of the housing moves rigidly, one in another
  shaft, such as a planet's on its carrier, with that shaft's sections. Strains of a shaft jump at a bearing; the mean
  of both sides is exact, as the jumps of the two fields are alike.
- Housing: :mod:`gearwhine.housing.updating.static_sensitivity`, by the fields of λ and x in it and the forces of the
  bearings.

Outcomes of the flanks follow by the chain rule from the approach over the face, on which they depend alone.

Teeth that share a torque are as stiff as under their own mesh force F. With the loads f(y, F) of a pair under the
approach y, T = ∂f/∂y and F = cᵀ f, where c sums the forces,

    dF = cᵀ T dy / (1 - cᵀ ∂f/∂F),      df = T dy + ∂f/∂F dF,

so that K_T has the pair's own tangent T + ∂f/∂F (dF/dy)ᵀ, which is not symmetric, and an outcome that of F, too.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears.loaded.face_load import FaceContact, FaceLoad, face_load_factor
from gearwhine.coupling.machine.components import seat_in_section
from gearwhine.coupling.statics.operating_point import BearingLoad, OperatingPoint, PairLoad, ShaftDeflection
from gearwhine.numerics.arrays import FloatArray

OUTCOMES = ("misalignment", "k_h_beta", "transmission_error")
"""Outcomes of a gear pair: misalignment [rad], K_Hβ, and peak-to-peak transmission error under load [m]."""

_STEP = 1e-6  # step over the flanks' compression under load, in the differences of K_Hβ and transmission error
_FORCE_STEP = 1e-5  # step over the mesh force, in the same differences
_SHAFT_STEP = 1e-6  # step over the shaft's length, in the one-sided differences of its motions


@dataclass(frozen=True, eq=False)
class Adjoint:
    """Adjoint state λ of an outcome at an operating point.

    Attributes
    ----------
    point : OperatingPoint
    values : ndarray, shape (n,)
        Adjoint state λ by the coordinates of the static machine: outcome per load [outcome/N, outcome/(N m)].
    """

    point: OperatingPoint
    values: FloatArray

    @property
    def housing(self) -> FloatArray:
        """Adjoint state λ by the housing's coordinates, shape (h,)."""
        return self.values[self.point.tangent.housing]

    def deflection(self, bearing: str) -> FloatArray:
        """Deflection Eᵀ λ of a bearing in the adjoint field, shape (5,)."""
        return np.asarray(self.point.tangent.bearings[bearing].T @ self.values)

    def force(self, bearing: str) -> FloatArray:
        """Force tᵀ Eᵀ λ of a bearing in the adjoint field, shape (5,)."""
        return np.asarray(self.point.bearing(bearing).stiffness.T @ self.deflection(bearing))

    def by_bearing_stiffness(self, bearing: str) -> float:
        """Differentiate the outcome by the factor 1 + p on a bearing's force and tangent, its preload included."""
        return -float(self.deflection(bearing) @ self.point.bearing(bearing).force)

    def by_bearing_position(self, bearing: str) -> float:
        """Differentiate the outcome by a bearing's position on its shaft, towards +z [outcome/m].

        Raises
        ------
        CouplingError
            For a bearing on an elastic pin, whose stiffness depends on its place.
        """
        load = self.point.bearing(bearing)
        if self.point.is_on_elastic_pin(load):
            raise CouplingError(
                f"bearing {bearing!r}: no derivative by its place on an elastic pin; expected a rigid one"
            )
        moved = _deflection_slope(self.point, load, self._shaft, self.housing)
        return -float(moved @ load.force + self.force(bearing) @ deflection_slope(self.point, load))

    def _shaft(self, name: str) -> ShaftDeflection:
        """Adjoint state of a shaft, whose mass nothing accelerates."""
        part = replace(self.point.shaft(name).part, acceleration=None)
        return ShaftDeflection(part, self.values[self.point.tangent.shafts[name]])


def adjoint(point: OperatingPoint, gradient: FloatArray) -> Adjoint:
    """Solve the adjoint state of an outcome.

    Parameters
    ----------
    point : OperatingPoint
    gradient : ndarray, shape (n,)
        Gradient c of the outcome by the coordinates of the static machine.
    """
    return Adjoint(point, np.asarray(linalg.solve(point.settled_stiffness.T, gradient)))


def pair_adjoints(point: OperatingPoint) -> tuple[dict[str, Adjoint], ...]:
    """Solve the adjoint states of the `OUTCOMES` of each gear pair; for an idle pair only that of misalignment."""
    adjoints = []
    for pair, rows in zip(point.pairs, point.tangent.pairs, strict=True):
        gradients = {"misalignment": -pair.pair.contact.face_slope}
        if pair.force > 0.0:
            gradients |= dict(zip(OUTCOMES[1:], _face_gradients(pair), strict=True))
        adjoints.append({name: adjoint(point, rows @ gradient) for name, gradient in gradients.items()})
    return tuple(adjoints)


def tilt_adjoint(point: OperatingPoint, bearing: str) -> Adjoint:
    """Solve the adjoint state of the angle between a shaft and its seat [rad]; its tilt must not be zero."""
    load = point.bearing(bearing)
    return adjoint(point, point.tangent.bearings[bearing][:, 3:] @ (load.deflection[3:] / load.tilt))


def deflection_slope(point: OperatingPoint, load: BearingLoad) -> FloatArray:
    """Differentiate a bearing's deflection by its position on its shaft at the equilibrium's motions, shape (5,)."""
    return _deflection_slope(point, load, point.shaft, point.housing)


def _face_gradients(pair: PairLoad) -> FloatArray:
    """Gradients of K_Hβ and peak-to-peak transmission error by the approach, by central differences, (2, m).

    Both follow from the shape of the approach over the face and the mesh force.
    """
    contact, under = pair.pair.contact, pair.pair.under

    def outcomes(contact: FaceContact, force: float, shape: FloatArray, even: FaceLoad | None = None) -> FloatArray:
        fine = contact.under_force(force, shape, pair.fine.phases)
        even = contact.evenly(force, fine.phases) if even is None else even
        return np.array([face_load_factor(fine, even), np.ptp(fine.deflection)])

    step = _STEP * pair.force / pair.mean_stiffness
    steps = step * np.eye(contact.size)
    # The tilt has another unit; its step moves the ends of the path of contact by as much.
    steps[-1] /= pair.pair.geometry.base_pitch
    either = [
        [outcomes(contact, pair.force, pair.shape + way * one, pair.even) for way in (1.0, -1.0)] for one in steps
    ]
    by_shape = np.array(
        [(more - less) / (2.0 * size) for (more, less), size in zip(either, np.diag(steps), strict=True)]
    )
    by_shape -= np.outer(contact.face_mean, contact.uniform @ by_shape)
    forces = [(1.0 + way) * pair.force for way in (_FORCE_STEP, -_FORCE_STEP)]
    more, less = (outcomes(contact if under is None else under(force).contact, force, pair.shape) for force in forces)
    return np.asarray(by_shape + np.outer(pair.force_slope, (more - less) / (forces[0] - forces[1]))).T


def _deflection_slope(
    point: OperatingPoint,
    load: BearingLoad,
    shaft_of: Callable[[str], ShaftDeflection],
    housing: FloatArray | None,
) -> FloatArray:
    """Differentiate a bearing's deflection by its position on its shaft in a field of the static machine, shape (5,).

    Parameters
    ----------
    point : OperatingPoint
    load : BearingLoad
    shaft_of : callable
        Motion of the shaft of a name in the field.
    housing : ndarray, shape (h,), or None
        The field by the housing's coordinates.
    """
    shaft, at = shaft_of(load.mounted.rotor), load.mounted.bearing.at
    own = _section_slope(shaft, at)[:5]
    holder = point.shaft_around(load)
    if holder is not None:
        along = _section_slope(shaft_of(holder), shaft.part.start + at - point.shaft(holder).part.start)
        arm = np.subtract(shaft.part.axis, point.shaft(holder).part.axis)
        return own - seat_in_section(along, arm, 0.0)
    if housing is None:
        return own
    rows = point.tangent.bearings[load.name][point.tangent.housing]
    return own - rigid_slope(-rows.T @ housing)


def _section_slope(shaft: ShaftDeflection, at: float) -> FloatArray:
    """Differentiate the motions of a shaft's sections along z at a distance from its left end [m], shape (6,)."""

    def motions(places: Sequence[float]) -> FloatArray:
        return shaft.motions(places).T

    return section_slope(motions, at, shaft.part.shaft.length)


def section_slope(motions: Callable[[Sequence[float]], FloatArray], at: float, length: float) -> FloatArray:
    """Differentiate the motions of a shaft's sections along z, as the mean of both sides; shape (6, ...).

    Beyond an end of the shaft there is no strain: what is held there moves as one body with the end.

    Parameters
    ----------
    motions : callable
        Motions along and about x, y, z of sections at positions from the left end [m], shape (m, 6, ...) for m of them.
    at : float
        Position from the left end [m], on the shaft or beyond its ends.
    length : float
        Length of the shaft [m].
    """
    step, end = _SHAFT_STEP * length, min(max(at, 0.0), length)
    # Rounding may put a place at an end beside it.
    is_on_shaft = abs(at - end) <= step
    ways = [way for way in (1.0, -1.0) if is_on_shaft and 0.0 <= end + 2.0 * way * step <= length]
    # All places at once: to find the motions of one takes nearly as long.
    middle, *beside = motions([end, *(end + way * step * part for way in ways for part in (1.0, 2.0))])
    sides = [
        (4.0 * near - far - 3.0 * middle) / (2.0 * way * step)
        for way, near, far in zip(ways, beside[::2], beside[1::2], strict=True)
    ]
    sides += [rigid_slope(middle)] * (2 - len(ways))
    return np.asarray(0.5 * (sides[0] + sides[1]))


def rigid_slope(motions: FloatArray) -> FloatArray:
    """Differentiate the motions of a rigid body along z by its rotations about x and y, shape as the motions'."""
    slope = np.zeros_like(motions)
    slope[0], slope[1] = motions[4], -motions[3]
    return slope
