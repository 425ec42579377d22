"""Contact energy of a row of cylindrical rollers, its gradient and its Hessian.

Slice k of the roller at ψ, at the place z_k along the axis, is pressed between the raceways by

    δ_jk = x cos ψ + y sin ψ + z_k (θ_y cos ψ − θ_x sin ψ) − s/2 − 2 P(x_k)

with s the clearance and P the profile: a roller tilts by half of what the rings do, so that either raceway sees half of
each slice's approach. It carries c/n δ_jk^{10/9} (ISO 16281), the energy is 9/19 of c/n δ_jk^{19/9}: convex in q.
Rollers skewing about the radius, friction on ribs and centrifugal forces are left out.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .energy import ElementLoads, RowEnergy
from .roller_row import RollerRow

FloatArray = npt.NDArray[np.float64]

_POWER = 10.0 / 9.0


@dataclass(frozen=True)
class RollerSlices:
    """Contacts of a row of rollers cut into slices."""

    row: RollerRow
    azimuths: FloatArray

    def energy(self, q: FloatArray) -> RowEnergy:
        """Energy and its derivatives over q."""
        motion, deep = self._state(q)
        load = self._slice_stiffness * deep**_POWER
        # The tangent is weakly singular at first touch; an untouched slice has none.
        tangent = np.where(deep > 0.0, _POWER * load / np.where(deep > 0.0, deep, 1.0), 0.0)
        return RowEnergy(
            value=float((load * deep).sum()) / (1.0 + _POWER),
            gradient=np.einsum("jk,jki->i", load, motion),
            hessian=np.einsum("jk,jki,jkl->il", tangent, motion, motion),
            force=float(load.sum()),
        )

    def loads(self, q: FloatArray) -> ElementLoads:
        """Loads of every roller and slice; pressures of the worst slice by Hertz's line contact.

        p = (w E* Σρ / π)^{1/2} and half the width b = 2 w / (π p), w the load per length.
        """
        row = self.row
        _, deep = self._state(q)
        load = self._slice_stiffness * deep**_POWER
        worst = load.max(axis=1) * row.slices / row.length
        gamma = row.roller_diameter / row.pitch_diameter
        pressures, axes = [], []
        for curvature in (2.0 / row.roller_diameter / (1.0 - gamma), 2.0 / row.roller_diameter / (1.0 + gamma)):
            pressure = np.sqrt(worst * row.elasticity.contact_modulus * curvature / math.pi)
            width = np.divide(2.0 * worst, math.pi * pressure, out=np.zeros_like(worst), where=pressure > 0.0)
            pressures.append(pressure)
            axes.append(np.column_stack([np.full(row.count, 0.5 * row.length / row.slices), width]))
        level = np.zeros(row.count)
        return ElementLoads(
            azimuths=self.azimuths,
            inner_load=load.sum(axis=1),
            outer_load=load.sum(axis=1),
            inner_angle=level,
            outer_angle=level,
            inner_pressure=pressures[0],
            outer_pressure=pressures[1],
            inner_semi_axes=axes[0],
            outer_semi_axes=axes[1],
            approach=deep.max(axis=1),
            slice_loads=load,
        )

    @property
    def _slice_stiffness(self) -> float:
        return self.row.stiffness / self.row.slices

    def _state(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Motion of the slices, (rollers, slices, 5), and their approaches, (rollers, slices)."""
        row = self.row
        place = row.position + row.slice_places
        cosine, sine = (np.repeat(f(self.azimuths)[:, None], row.slices, axis=1) for f in (np.cos, np.sin))
        motion = np.stack([cosine, sine, np.zeros_like(cosine), -place * sine, place * cosine], axis=2)
        return motion, np.maximum(motion @ q - 0.5 * row.clearance - 2.0 * row.slice_drops, 0.0)
