r"""Sensitivity of the operating point: gradients of misalignment, K_Hβ and transmission error by the adjoint method.

Let R(x, p) = 0 be the equilibrium of the static machine (:mod:`gearwhine.coupling.statics.operating_point`) and K_T =
∂R/∂x its tangent, bearings and flanks included. For an outcome y(x) with the gradient c = ∂y/∂x, one adjoint solve

    K_Tᵀ λ = c      gives      dy/dp = -λᵀ ∂R/∂p

for every parameter p (Haug, Choi and Komkov, Design Sensitivity Analysis of Structural Systems, 1986, section 1.2).

- Bearing with the deflection δ = Eᵀ x and the force f, its law multiplied by 1 + p: dy/dp = -(Eᵀ λ) · f.
- Bearing moved along its shaft by p, its seat staying: with w' the slope of the shaft's motions along z less that of
  the seat's rigid motion, and t = ∂f/∂δ, dy/dp = -w'(λ) · f - (Eᵀ λ) · t w'(x). Strains of the shaft jump at a bearing;
  the mean of both sides is exact, as the jumps of the two fields are alike.
- Housing: :mod:`gearwhine.housing.updating.static_sensitivity`, by the fields of λ and x in it and the forces of the
  bearings.

Outcomes of the flanks follow by the chain rule from the approach over the face, on which they depend alone.
"""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy import linalg

from gearwhine.coupling.gears.loaded.face_load import face_load_factor
from gearwhine.coupling.statics.operating_point import BearingLoad, OperatingPoint, PairLoad, ShaftDeflection

FloatArray = npt.NDArray[np.float64]

OUTCOMES = ("misalignment", "k_h_beta", "transmission_error")
"""Outcomes of a gear pair: misalignment [rad], K_Hβ, and peak-to-peak transmission error under load [m]."""

_STEP = 1e-6  # step over the flanks' compression under load, in the differences of K_Hβ and transmission error
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
        """Differentiate the outcome by a bearing's position on its shaft, towards +z [outcome/m]."""
        load = self.point.bearing(bearing)
        shaft = self.point.shaft(load.mounted.rotor)
        adjoint = ShaftDeflection(
            replace(shaft.part, acceleration=None), self.values[self.point.tangent.shafts[shaft.name]]
        )
        moved = _slope(adjoint, load) - _seat_slope(self.point, load, self.housing)
        return -float(moved @ load.force + self.force(bearing) @ deflection_slope(self.point, load))


def adjoint(point: OperatingPoint, gradient: FloatArray) -> Adjoint:
    """Solve the adjoint state of an outcome.

    Parameters
    ----------
    point : OperatingPoint
    gradient : ndarray, shape (n,)
        Gradient c of the outcome by the coordinates of the static machine.
    """
    return Adjoint(point, np.asarray(linalg.solve(point.tangent.stiffness.T, gradient)))


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
    return _slope(point.shaft(load.mounted.rotor), load) - _seat_slope(point, load, point.housing)


def _face_gradients(pair: PairLoad) -> FloatArray:
    """Gradients of K_Hβ and peak-to-peak transmission error by the approach, by central differences, (2, m)."""
    contact = pair.pair.contact
    # Coordinates of the static machine move the flanks against each other without that of shared rims on their hubs.
    approach = pair.approach - (pair.pair.clearance + pair.pair.behind_rims * pair.force) * contact.uniform

    def outcomes(approach: FloatArray) -> FloatArray:
        shape = approach - contact.uniform * float(contact.face_mean @ approach)
        fine = contact.under_force(pair.pair.between_rims.at(approach).force, shape, pair.fine.phases)
        return np.array([face_load_factor(fine, pair.even), np.ptp(fine.deflection)])

    step = _STEP * pair.force / pair.mean_stiffness
    steps = step * np.eye(contact.size)
    # The tilt has another unit; its step moves the ends of the path of contact by as much.
    steps[-1] /= pair.pair.geometry.base_pitch
    sizes = np.diag(steps)
    return np.array(
        [
            (outcomes(approach + way) - outcomes(approach - way)) / (2.0 * size)
            for way, size in zip(steps, sizes, strict=True)
        ]
    ).T


def _slope(shaft: ShaftDeflection, load: BearingLoad) -> FloatArray:
    """Differentiate a shaft's motions at a bearing along z, as the mean of its two sides, shape (5,)."""
    at, step = load.mounted.bearing.at, _SHAFT_STEP * shaft.part.shaft.length
    ways = [way for way in (1.0, -1.0) if 0.0 <= at + 2.0 * way * step <= shaft.part.shaft.length]
    # All places at once: to find the motions of one takes nearly as long.
    places = [at, *(at + way * step * part for way in ways for part in (1.0, 2.0))]
    middle, *beside = shaft.motions(places)[:5].T
    sides = [
        (4.0 * near - far - 3.0 * middle) / (2.0 * way * step)
        for way, near, far in zip(ways, beside[::2], beside[1::2], strict=True)
    ]
    # Beyond the shaft's end there is no strain.
    sides += [rigid_slope(middle)] * (2 - len(ways))
    return np.asarray(0.5 * (sides[0] + sides[1]))


def _seat_slope(point: OperatingPoint, load: BearingLoad, coordinates: FloatArray | None) -> FloatArray:
    """Differentiate a seat's rigid motion along z, by the housing's coordinates, shape (5,)."""
    if coordinates is None:
        return np.zeros(5)
    rows = point.tangent.bearings[load.name][point.tangent.housing]
    return rigid_slope(-rows.T @ coordinates)


def rigid_slope(motions: FloatArray) -> FloatArray:
    """Differentiate the motions of a rigid body along z by its rotations about x and y, shape (5, ...)."""
    still = np.zeros_like(motions[0])
    return np.array([motions[4], -motions[3], still, still, still])
