"""Contact energy of a row of rollers in slices, its gradient and Hessian, and the loads of rollers and slices.

`gearwhine.rotors.rolling_bearings.roller_rows` has the approach δ of every slice and its sources. Without centrifugal
force a slice has the energy 9/19 c' δ^{19/9}, c' = c/n. With the part f of it the approaches u at the inner and w = δ −
u at the outer raceway balance,

    c_r u^{10/9} + f = c_r w^{10/9},   c_r = 2^{10/9} c',

a root of u + (u^{10/9} + f/c_r)^{0.9} = δ, whose left side is increasing and convex in u: Newton's method from δ/2,
which is not below it, converges in one direction. Its energy 9/19 c_r (u^{19/9} + w^{19/9}) − f w is convex in δ, as
every minimum over a part of a convex function's variables is, and has the slope c_r u^{10/9}. Flanges of cylindrical
rollers and the constant push of thrown rollers on the rib of tapered ones add to it.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.rolling_bearings.element_contacts import ElementLoads, RowEnergy
from gearwhine.rotors.rolling_bearings.roller_rows import LineContactRow, RollerRow, TaperedRollerRow

_POWER = 10.0 / 9.0
# Newton's steps of a slice with centrifugal force: its error squares in each, from at most a half.
_STEPS = 7


@dataclass(frozen=True)
class RollerSlices:
    """Contacts of a row of rollers cut into slices, with the centrifugal force ``thrown`` [N] on each roller."""

    row: LineContactRow
    azimuths: FloatArray
    thrown: float = 0.0

    def energy(self, q: FloatArray) -> RowEnergy:
        """Energy and its derivatives over q."""
        motion, deep = self._motion, self._approach(q)
        value, load, tangent = self._slices(deep)
        energy, gradient = float(value.sum()), load @ motion
        hessian = motion.T @ (tangent[:, None] * motion)
        force = float(load.sum()) + self.row.count * self.thrown
        gradient, energy = gradient + self._push, energy + float(self._push @ q)
        for side in self._flanges:
            axial, deep = self._flange(q, side)
            stiffness = self._flange_stiffness
            energy += 0.5 * stiffness * float((deep**2).sum())
            gradient = gradient + stiffness * deep @ axial
            hessian = hessian + stiffness * axial.T @ ((deep > 0.0)[:, None] * axial)
            force += stiffness * float(deep.sum())
        return RowEnergy(energy, gradient, hessian, force)

    def loads(self, q: FloatArray) -> ElementLoads:
        """Return the loads of every roller and slice; pressures of the worst slice by Hertz's line contact.

        p = (w E* Σρ / π)^{1/2} and half the width b = 2 w / (π p), w the load per length.
        """
        row, shape = self.row, (self.row.count, self.row.slices)
        deep = self._approach(q)
        inner = self._slices(deep)[1].reshape(shape)
        outer = inner + self._slice_force
        pressures, axes = [], []
        for load, curvature in ((inner, 1.0 / (1.0 - row.gamma)), (outer, 1.0 / (1.0 + row.gamma))):
            worst = load.max(axis=1) * row.slices / row.length
            curvature *= 2.0 / row.roller_diameter
            pressure = np.sqrt(worst * row.elasticity.contact_modulus * curvature / math.pi)
            width = np.divide(2.0 * worst, math.pi * pressure, out=np.zeros_like(worst), where=pressure > 0.0)
            pressures.append(pressure)
            axes.append(np.column_stack([np.full(row.count, 0.5 * row.length / row.slices), width]))
        return ElementLoads(
            azimuths=self.azimuths,
            inner_load=inner.sum(axis=1),
            outer_load=outer.sum(axis=1),
            inner_angle=np.full(row.count, row.contact_angle - 2.0 * row.roller_angle),
            outer_angle=np.full(row.count, row.contact_angle),
            inner_pressure=pressures[0],
            outer_pressure=pressures[1],
            inner_semi_axes=axes[0],
            outer_semi_axes=axes[1],
            approach=np.maximum(deep, 0.0).reshape(shape).max(axis=1),
            slice_loads=inner,
            rib_load=self._rib_loads(q, inner.sum(axis=1), outer.sum(axis=1)),
        )

    def _rib_loads(self, q: FloatArray, inner: FloatArray, outer: FloatArray) -> FloatArray | None:
        if isinstance(self.row, TaperedRollerRow):
            axis = self.row.contact_angle - self.row.roller_angle
            return np.asarray((inner + outer) * math.sin(self.row.roller_angle) + self.thrown * math.sin(axis))
        if not self._flanges:
            return None
        return np.asarray(self._flange_stiffness * sum(self._flange(q, side)[1] for side in self._flanges))

    def _slices(self, deep: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy, inner load and tangent of slices with the approaches ``deep``."""
        stiffness = self.row.stiffness / self.row.slices
        if self.thrown == 0.0:
            in_contact = np.maximum(deep, 0.0)
            # The tangent is weakly singular at first touch; an untouched slice has none.
            root = in_contact ** (_POWER - 1.0)
            load = stiffness * root * in_contact
            return load * in_contact / (1.0 + _POWER), load, _POWER * stiffness * root
        raceway, thrown = 2.0**_POWER * stiffness, self._slice_force
        outwards = thrown / raceway
        alone = outwards ** (1.0 / _POWER)
        on_both = deep > alone
        inner = 0.5 * np.where(on_both, deep, 2.0 * alone)
        for _ in range(_STEPS):
            root = inner ** (_POWER - 1.0)
            both = root * inner + outwards
            outer = both ** (1.0 / _POWER)
            inner = np.maximum(inner - (inner + outer - deep) / (1.0 + root * outer / both), 0.0)
        inner = np.where(on_both, inner, 0.0)
        outer = np.where(on_both, deep - inner, alone)
        root, outer_root = inner ** (_POWER - 1.0), outer ** (_POWER - 1.0)
        load = raceway * root * inner
        # The outer approach under the centrifugal force alone has no energy.
        value = load * inner + raceway * (outer_root * outer**2 - outwards * alone)
        value = value / (1.0 + _POWER) - thrown * (outer - alone)
        return value, load, _POWER * raceway * root * outer_root / (root + outer_root)

    @property
    def _slice_force(self) -> float:
        """Part f of the centrifugal force along the outer normal that a slice bears [N]."""
        angle, half = self.row.contact_angle, self.row.roller_angle
        return self.thrown * math.cos(angle - half) / math.cos(half) / self.row.slices

    @cached_property
    def _motion(self) -> FloatArray:
        """Slope of every slice's approach by q, (rollers · slices, 5)."""
        row = self.row
        cosine, sine = (np.repeat(f(self.azimuths), row.slices) for f in (np.cos, np.sin))
        arm = np.tile(row.tilt_arms, row.count)
        along, across = math.cos(row.contact_angle), row.direction * math.sin(row.contact_angle)
        return np.column_stack([along * cosine, along * sine, np.full_like(cosine, across), -arm * sine, arm * cosine])

    @cached_property
    def _free(self) -> FloatArray:
        return np.tile(self.row.free_approach - 2.0 * self.row.slice_drops, self.row.count)

    def _approach(self, q: FloatArray) -> FloatArray:
        """Approach of the raceways at every slice, negative where it is open, (rollers · slices,)."""
        return np.asarray(self._motion @ q + self._free)

    @cached_property
    def _push(self) -> FloatArray:
        """Gradient of thrown tapered rollers that lean on the rib, (5,): −F_c sin α / cos β along the axis of each."""
        row, push = self.row, np.zeros(5)
        if isinstance(row, TaperedRollerRow) and self.thrown > 0.0:
            # Over the whole circle the radial parts cancel, and so do the moments.
            along = row.direction * math.cos(row.contact_angle - row.roller_angle)
            push[2] = row.count * self.thrown * math.sin(row.contact_angle) / math.cos(row.roller_angle) * along
        return push

    @cached_property
    def _flanges(self) -> tuple[int, ...]:
        """Directions, +1 along z, in which flanges hold the inner ring."""
        if not isinstance(self.row, RollerRow) or self.row.flanges == "none":
            return ()
        return (self.row.direction,) if self.row.flanges == "one" else (1, -1)

    @property
    def _flange_stiffness(self) -> float:
        return self.row.flange_stiffness if isinstance(self.row, RollerRow) else 0.0

    def _flange(self, q: FloatArray, side: int) -> tuple[FloatArray, FloatArray]:
        """Slopes (rollers, 5) by q of the flanges' approach at each roller towards one side, and the approach."""
        row = self.row
        radius = (-0.5 if row.outer_turns else 0.5) * row.pitch_diameter
        play = 0.5 * row.axial_clearance if isinstance(row, RollerRow) else 0.0
        zero = np.zeros(row.count)
        axial = np.column_stack(
            [zero, zero, zero + 1.0, radius * np.sin(self.azimuths), -radius * np.cos(self.azimuths)]
        )
        free = side * row.direction * row.axial_offset - play
        return side * axial, np.maximum(side * axial @ q + free, 0.0)
