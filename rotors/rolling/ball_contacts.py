"""The elastic energy of a row of balls and its derivatives.

At the azimuth ψ the centre of the inner groove's curvature stands from that of the outer one by the vector v in the
ball's own plane (radial, axial), v = v₀ + B q, with σ the row's direction, A the distance of the centres when a ball just
touches both grooves, s the clearance, e the axial offset and (R, z) the radius and place of the inner centres:

    v₀ = (A cos α − s/2,  σ (A sin α + e))
    B  = [[cos ψ, sin ψ, 0, −z sin ψ,  z cos ψ],
          [0,     0,     1,  R sin ψ, −R cos ψ]]

(De Mul, Vree and Maas 1989; ISO 16281 for one plane). A ball without inertia feels two forces in one line, its contacts
in series, and the approach is δ = |v| − A:

    φ = ⅖ K δ^{5/2},  ∂φ/∂v = K δ^{3/2} n,  ∂²φ/∂v² = 3/2 K δ^{1/2} n nᵀ + (K δ^{3/2} / |v|) (I − n nᵀ),  n = v / |v|

for δ > 0 and nothing otherwise. A turning ball is thrown outwards by F_c and its contacts stand at two angles (Jones 1960).
Its own place b from the outer centre joins the unknowns, with A = A_i + A_o:

    φ = ⅖ K_o (|b| − A_o)^{5/2} + ⅖ K_i (|v − b| − A_i)^{5/2} − F_c b_r

The length of a vector is convex, and so is an increasing convex function of it: both energies are convex in (q, b) together.
The balls' gyroscopic moment, and friction, are left out.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .energy import ElementLoads, RowEnergy
from .hertz import PointContact
from .rows import BallRow

FloatArray = npt.NDArray[np.float64]


def ball_kinematics(row: BallRow, azimuths: FloatArray) -> tuple[FloatArray, FloatArray]:
    """v₀, (2,), and B, (balls, 2, 5)."""
    angle, sense = row.contact_angle, row.direction
    radial = row.groove_distance * math.cos(angle) - 0.5 * row.clearance
    start = np.array([radial, sense * (row.groove_distance * math.sin(angle) + row.axial_offset)])
    arm = (row.inner_groove - 0.5) * row.ball_diameter
    radius = 0.5 * row.pitch_diameter + arm * math.cos(angle)
    place = row.position + sense * arm * math.sin(angle)
    cosine, sine, zero = np.cos(azimuths), np.sin(azimuths), np.zeros_like(azimuths)
    motion = np.array(
        [
            [cosine, sine, zero, -place * sine, place * cosine],
            [zero, zero, zero + 1.0, radius * sine, -radius * cosine],
        ]
    )
    return start, np.moveaxis(motion, 2, 0)


@dataclass(frozen=True)
class BallsAtRest:
    """A row whose balls have no inertia: every ball's contacts in series."""

    row: BallRow
    azimuths: FloatArray
    unknowns: int = 0

    def start(self) -> FloatArray:
        """No unknowns of its own."""
        return np.zeros(0)

    def energy(self, q: FloatArray, own: FloatArray) -> RowEnergy:
        """Energy and its derivatives over q."""
        v, motion, approach = self._state(q)
        distance = np.linalg.norm(v, axis=1)
        value, force, hessian = _spring(self.row.stiffness, v / distance[:, None], approach, distance)
        return RowEnergy(
            value=float(value.sum()),
            gradient=np.einsum("bi,bij->j", force, motion),
            hessian=np.einsum("bik,bij,bjl->kl", motion, hessian, motion),
            force=float(np.linalg.norm(force, axis=1).sum()),
        )

    def loads(self, q: FloatArray, own: FloatArray) -> ElementLoads:
        """What every ball carries."""
        v, _, approach = self._state(q)
        load = self.row.stiffness * np.maximum(approach, 0.0) ** 1.5
        return _loads(self.row, self.azimuths, (load, load), (v, v), approach)

    def _state(self, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        start, motion = ball_kinematics(self.row, self.azimuths)
        moved = motion @ q
        v, nominal = start + moved, self.row.groove_distance
        # |v₀|² − A² by its terms: |v| − A itself would lose the digits that A has and δ has not.
        angle, clearance, offset = self.row.contact_angle, self.row.clearance, self.row.axial_offset
        before = 0.25 * clearance**2 - nominal * clearance * math.cos(angle)
        before += 2.0 * nominal * offset * math.sin(angle) + offset**2
        excess = before + 2.0 * moved @ start + (moved**2).sum(axis=1)
        return v, motion, excess / (np.linalg.norm(v, axis=1) + nominal)


@dataclass(frozen=True)
class BallsInMotion:
    """A row whose balls are thrown outwards by a force each (N): two unknowns a ball, radial before axial."""

    row: BallRow
    azimuths: FloatArray
    thrown: float

    @property
    def unknowns(self) -> int:
        """Two for each ball."""
        return 2 * self.row.count

    def start(self) -> FloatArray:
        """Every ball where the outer groove alone holds it."""
        sunk = (self.thrown / self.row.outer_contact.stiffness) ** (2.0 / 3.0)
        return np.tile([_arm(self.row.outer_groove, self.row) + sunk, 0.0], self.row.count)

    def energy(self, q: FloatArray, own: FloatArray) -> RowEnergy:
        """Energy and its derivatives over q and the balls' places."""
        outer, inner, motion = self._state(q, own)
        values, forces, hessians = zip(
            *(
                _spring(contact.stiffness, vector / np.linalg.norm(vector, axis=1)[:, None], approach, length)
                for contact, vector, approach, length in (
                    (self.row.outer_contact, *self._approach(outer, self.row.outer_groove)),
                    (self.row.inner_contact, *self._approach(inner, self.row.inner_groove)),
                )
            ),
            strict=True,
        )
        count = self.row.count
        hessian = np.zeros((5 + 2 * count, 5 + 2 * count))
        hessian[:5, :5] = np.einsum("bik,bij,bjl->kl", motion, hessians[1], motion)
        for ball in range(count):
            own_rows = slice(5 + 2 * ball, 7 + 2 * ball)
            hessian[own_rows, own_rows] = hessians[0][ball] + hessians[1][ball]
            hessian[own_rows, :5] = -hessians[1][ball] @ motion[ball]
            hessian[:5, own_rows] = hessian[own_rows, :5].T
        on_balls = forces[0] - forces[1] - np.array([self.thrown, 0.0])
        return RowEnergy(
            value=float(values[0].sum() + values[1].sum() - self.thrown * own[::2].sum()),
            gradient=np.concatenate([np.einsum("bi,bij->j", forces[1], motion), on_balls.ravel()]),
            hessian=hessian,
            force=float(np.linalg.norm(forces[0], axis=1).sum()),
        )

    def loads(self, q: FloatArray, own: FloatArray) -> ElementLoads:
        """What every ball carries, inside and outside."""
        outer, inner, _ = self._state(q, own)
        deep = self._approach(outer, self.row.outer_groove)[1], self._approach(inner, self.row.inner_groove)[1]
        stiffness = self.row.outer_contact.stiffness, self.row.inner_contact.stiffness
        outside, inside = (k * np.maximum(d, 0.0) ** 1.5 for k, d in zip(stiffness, deep, strict=True))
        return _loads(self.row, self.azimuths, (inside, outside), (inner, outer), deep[0] + np.maximum(deep[1], 0.0))

    def _state(self, q: FloatArray, own: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        start, motion = ball_kinematics(self.row, self.azimuths)
        balls = own.reshape(self.row.count, 2)
        return balls, start + motion @ q - balls, motion

    def _approach(self, vector: FloatArray, groove: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        length = np.linalg.norm(vector, axis=1)
        return vector, length - _arm(groove, self.row), length


def _arm(groove: float, row: BallRow) -> float:
    """From a ball's centre to that of a groove's curvature when they just touch, m."""
    return (groove - 0.5) * row.ball_diameter


def _spring(
    stiffness: float, normal: FloatArray, approach: FloatArray, distance: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """⅖ K δ^{5/2} of every ball, (n,), and its first and second derivatives by the vector, (n, 2) and (n, 2, 2)."""
    deep = np.maximum(approach, 0.0)
    load = stiffness * deep**1.5
    along = normal[:, :, None] * normal[:, None, :]
    hessian = (1.5 * stiffness * np.sqrt(deep))[:, None, None] * along
    hessian = hessian + (load / distance)[:, None, None] * (np.eye(2) - along)
    return 0.4 * load * deep, load[:, None] * normal, hessian


def _loads(
    row: BallRow,
    azimuths: FloatArray,
    loads: tuple[FloatArray, FloatArray],
    vectors: tuple[FloatArray, FloatArray],
    approach: FloatArray,
) -> ElementLoads:
    """The result of a row from the inner and outer loads and their lines of action."""
    contacts: tuple[PointContact, PointContact] = (row.inner_contact, row.outer_contact)
    angles = [np.arctan2(row.direction * vector[:, 1], vector[:, 0]) for vector in vectors]
    roots = [np.cbrt(load) for load in loads]
    pressures = [contact.unit_pressure * root for contact, root in zip(contacts, roots, strict=True)]
    semi_axes = [
        np.outer(root, [contact.semi_major, contact.semi_minor]) for contact, root in zip(contacts, roots, strict=True)
    ]
    return ElementLoads(
        azimuths=azimuths,
        inner_load=loads[0],
        outer_load=loads[1],
        inner_angle=angles[0],
        outer_angle=angles[1],
        inner_pressure=pressures[0],
        outer_pressure=pressures[1],
        inner_semi_axes=semi_axes[0],
        outer_semi_axes=semi_axes[1],
        approach=np.maximum(approach, 0.0),
    )
