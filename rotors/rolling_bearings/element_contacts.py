"""Contact energy of rows of balls, its gradient and its Hessian, and the loads of rolling elements.

At the azimuth ψ the centre of the inner groove's curvature stands from that of the outer one by the vector v
in the ball's own plane (radial, axial), v = v₀ + B q, with σ the row's direction, A the distance of the centres when a
ball just touches both grooves, s the clearance, e the axial offset and (R, z) the radius and place of the inner
centres:

    v₀ = (A cos α − s/2,  σ (A sin α + e))
    B  = [[cos ψ, sin ψ, 0, −z sin ψ,  z cos ψ],
          [0,     0,     1,  R sin ψ, −R cos ψ]]

(De Mul, Vree and Maas 1989; ISO 16281 for one plane). A ball without inertia feels two forces in one line, its contacts
in series, and the approach is δ = |v| − A:

    φ = ⅖ K δ^{5/2},  ∂φ/∂v = K δ^{3/2} n,  ∂²φ/∂v² = 3/2 K δ^{1/2} n nᵀ + (K δ^{3/2} / |v|) (I − n nᵀ),  n = v / |v|

for δ > 0 and nothing otherwise. The length of a vector is convex, and so is an increasing convex function of it: the
energy is convex in q. Friction is left out.

`gearwhine.rotors.rolling_bearings.roller_slices` has rollers.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.rolling_bearings.rows import BallRow


@dataclass(frozen=True)
class RowEnergy:
    """Energy [J], its gradient (5,) and Hessian (5, 5) over the inner ring's displacement q.

    ``force`` is the sum of the elements' loads [N]: the scale of the gradient's rounding.
    """

    value: float
    gradient: FloatArray
    hessian: FloatArray
    force: float


@dataclass(frozen=True)
class ElementLoads:
    """Loads, contact angles and pressures of each rolling element of a row.

    Attributes
    ----------
    azimuths : ndarray, shape (n,)
        Azimuths from x towards y [rad].
    inner_load, outer_load : ndarray, shape (n,)
        Loads of the contacts with either ring [N]; they differ only with centrifugal forces.
    inner_angle, outer_angle : ndarray, shape (n,)
        Contact angles, in the row's direction [rad].
    inner_pressure, outer_pressure : ndarray, shape (n,)
        Greatest Hertzian pressure [Pa]; for a roller that of its worst slice.
    inner_semi_axes, outer_semi_axes : ndarray, shape (n, 2)
        Semi-axes of a ball's contact ellipses, across the groove and along it [m]; for a roller's worst slice half the
        slice's length and half the contact's width.
    approach : ndarray, shape (n,)
        Approach of the rings through the element [m]; for a roller at its worst slice.
    slice_loads : ndarray, shape (n, slices) or None
        Loads of the slices of rollers at the inner ring [N].
    rib_load : ndarray, shape (n,) or None
        Loads of tapered rollers on the rib, and of cylindrical rollers on flanges [N].

    For balls in four-point contact n is twice their number: first the diagonal that a push along the row loads, then
    the other one, with negative contact angles.
    """

    azimuths: FloatArray
    inner_load: FloatArray
    outer_load: FloatArray
    inner_angle: FloatArray
    outer_angle: FloatArray
    inner_pressure: FloatArray
    outer_pressure: FloatArray
    inner_semi_axes: FloatArray
    outer_semi_axes: FloatArray
    approach: FloatArray
    slice_loads: FloatArray | None = None
    rib_load: FloatArray | None = None

    @property
    def loaded(self) -> int:
        """Number of elements that press on the inner ring."""
        return int(np.unique(self.azimuths[self.inner_load > 0.0]).size)

    @property
    def peak_pressure(self) -> float:
        """Greatest pressure in the row [Pa]."""
        return float(max(self.inner_pressure.max(), self.outer_pressure.max()))


class RowContacts(Protocol):
    """Contacts of a row with its elements at given azimuths."""

    def energy(self, q: FloatArray) -> RowEnergy:
        """Energy and its derivatives at the inner ring's displacement q, (5,)."""

    def loads(self, q: FloatArray) -> ElementLoads:
        """Element loads at that displacement."""


def ball_kinematics(row: BallRow, azimuths: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Vector v₀, (2,), and matrices B, (balls, 2, 5)."""
    radius, place = row.inner_groove_centre
    cosine, sine, zero = np.cos(azimuths), np.sin(azimuths), np.zeros_like(azimuths)
    motion = np.array(
        [
            [cosine, sine, zero, -place * sine, place * cosine],
            [zero, zero, zero + 1.0, radius * sine, -radius * cosine],
        ]
    )
    return np.array(row.groove_offset), np.moveaxis(motion, 2, 0)


@dataclass(frozen=True)
class StaticBalls:
    """Contacts of a row of balls without inertia: both contacts of every ball in series."""

    row: BallRow
    azimuths: FloatArray

    def energy(self, q: FloatArray) -> RowEnergy:
        """Energy and its derivatives over q."""
        # Imported here: numba is not needed to read a case.
        from gearwhine.rotors.rolling_bearings.ball_kernels import ball_energy

        gradient, hessian = np.zeros(5), np.zeros((5, 5))
        start, motion = self._kinematics
        value, force = ball_energy(start, motion, *self._lengths, q, gradient, hessian)
        return RowEnergy(value, gradient, hessian, force)

    def loads(self, q: FloatArray) -> ElementLoads:
        """Return the loads of every ball."""
        v, _, approach = self._state(q)
        load = self.row.stiffness * np.maximum(approach, 0.0) ** 1.5
        return ball_loads(self.row, self.azimuths, (load, load), (v, v), approach)

    @cached_property
    def _lengths(self) -> tuple[float, float, float]:
        """Contact constant K, and A and |v₀|² − A² of the grooves' centres."""
        return self.row.stiffness, self.row.groove_distance, self.row.groove_excess

    @cached_property
    def _kinematics(self) -> tuple[FloatArray, FloatArray]:
        return ball_kinematics(self.row, self.azimuths)

    def _state(self, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        start, motion = self._kinematics
        moved = motion @ q
        v, nominal = start + moved, self.row.groove_distance
        excess = self.row.groove_excess + 2.0 * moved @ start + (moved**2).sum(axis=1)
        return v, motion, excess / (np.linalg.norm(v, axis=1) + nominal)


def row_energy(motion: FloatArray, value: FloatArray, force: FloatArray, hessian: FloatArray) -> RowEnergy:
    """Energy of the row over the ring's coordinates, from the energies in every ball's plane."""
    return RowEnergy(
        value=float(value.sum()),
        gradient=np.einsum("bi,bij->j", force, motion),
        hessian=np.einsum("bik,bij,bjl->kl", motion, hessian, motion),
        force=float(np.linalg.norm(force, axis=1).sum()),
    )


def ball_loads(
    row: BallRow,
    azimuths: FloatArray,
    loads: tuple[FloatArray, FloatArray],
    vectors: tuple[FloatArray, FloatArray],
    approach: FloatArray,
) -> ElementLoads:
    """Element loads of a row from the inner and outer contact loads and their lines of action."""
    contacts = (row.inner_contact, row.outer_contact)
    angles = [np.arctan2(row.direction * vector[:, 1], vector[:, 0]) for vector in vectors]
    roots = [np.cbrt(load) for load in loads]
    pressures = [contact.unit_pressure * root for contact, root in zip(contacts, roots, strict=True)]
    semi_axes = [
        np.outer(root, [contact.unit_semi_major, contact.unit_semi_minor])
        for contact, root in zip(contacts, roots, strict=True)
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
