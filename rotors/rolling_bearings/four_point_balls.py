"""Balls in four-point contact: energy of each over the place of its centre in a Gothic arch, four contacts at most.

In its plane (radial, axial) a ball's centre stands at p between two arcs of the outer ring with the centres c_o± and
two of the inner ring with c_i±, arc by arc as far as `FourPointRow.arcs` places them, c_i = c_o + v₀ + B q with the v₀
and B of `gearwhine.rotors.rolling_bearings.element_contacts`. The ball presses an arc by the length of c − p beyond the
arc's radius less the ball's, so with all four and the centrifugal force F_c

    φ(q) = min over p of Σ ⅖ K (|c − p| − (f − ½) D)^{5/2} − F_c p_r.

The sum is convex in p and q together, and so is its least value over p. With the forces g and slopes k of the contacts,
k_pp the sum of all four slopes,

    ∂φ/∂q = Σ_i Bᵀ g,   ∂²φ/∂q² = Σ_i Bᵀ k B − (Σ_i Bᵀ k) k_pp⁻¹ (Σ_i k B),

i the inner contacts. To first order in δ/A and without F_c the two diagonals are independent rows of balls, whose
places start the iteration. Friction and gyroscopic moments are left out.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.trust_region import Local, minimise
from gearwhine.rotors.errors import EquilibriumError
from gearwhine.rotors.rolling_bearings.element_contacts import ElementLoads, RowEnergy, ball_kinematics
from gearwhine.rotors.rolling_bearings.rows import FourPointRow

# Force out of balance on a ball, relative to its loads: where Newton's method on all balls at once ends, and the
# largest accepted.
_ROUNDED, _OPEN = 1e-13, 1e-10
_NEWTON_STEPS, _HALVINGS = 10, 6
# Part of E* D² that counts as the load of an unloaded ball, as in a bearing's equilibrium.
_LEAST_FORCE = 1e-9
# Part of that force that a ball may be out of balance whatever its loads: 1e-8 N for a ball of 10 mm.
_NOTHING = 1e-6


@dataclass(frozen=True)
class FourPointBalls:
    """Contacts of a row of balls with up to four arcs each, under a centrifugal force ``thrown`` [N] each."""

    row: FourPointRow
    azimuths: FloatArray
    thrown: float = 0.0

    def energy(self, q: FloatArray) -> RowEnergy:
        """Energy and its derivatives over q, every ball where its forces balance."""
        centres = self._centres(q)
        place = self._places(centres)
        value, force, slope = self._contacts(centres, place)
        inner_force, inner_slope = force[:2], slope[:2]
        total = slope.sum(axis=0)
        # A ball without contact has no stiffness.
        is_held = np.abs(np.linalg.det(total)) > 0.0
        total[~is_held] = np.eye(2)
        motion = self._motion
        mixed = np.einsum("mbij,mbjk->bik", inner_slope, motion)
        hessian = np.einsum("mbij,mbik,mbkl->jl", motion, inner_slope, motion)
        hessian = hessian - np.einsum("bij,bik->jk", mixed, np.linalg.solve(total, mixed))
        return RowEnergy(
            value=float(value.sum() - self.thrown * place[:, 0].sum()),
            gradient=np.einsum("mbi,mbij->j", inner_force, motion),
            hessian=hessian,
            force=float(np.linalg.norm(force, axis=2).sum()) + self.row.count * self.thrown,
        )

    def loads(self, q: FloatArray) -> ElementLoads:
        """Return the loads of every ball, first of the diagonal that a push along the row loads, then of the other."""
        centres = self._centres(q)
        away = centres - self._places(centres)
        loads = np.linalg.norm(self._contacts(centres, centres - away)[1], axis=2)
        # Inner arcs 0 and 1, outer arcs 2 and 3; a diagonal is an inner and the outer arc of the same number.
        inner, outer = loads[:2].ravel(), loads[2:].ravel()
        lines = np.concatenate([away[:2], -away[2:]])
        angles = np.arctan2(self.row.direction * lines[..., 1], lines[..., 0])
        contacts = self.row.inner_contact, self.row.outer_contact
        approach = sum(
            (load / contact.stiffness) ** (2.0 / 3.0) for load, contact in zip((inner, outer), contacts, strict=True)
        )
        roots = [np.cbrt(load) for load in (inner, outer)]
        axes = [
            np.outer(root, [contact.unit_semi_major, contact.unit_semi_minor])
            for root, contact in zip(roots, contacts, strict=True)
        ]
        return ElementLoads(
            azimuths=np.tile(self.azimuths, 2),
            inner_load=inner,
            outer_load=outer,
            inner_angle=angles[:2].ravel(),
            outer_angle=angles[2:].ravel(),
            inner_pressure=contacts[0].unit_pressure * roots[0],
            outer_pressure=contacts[1].unit_pressure * roots[1],
            inner_semi_axes=axes[0],
            outer_semi_axes=axes[1],
            approach=np.asarray(approach),
        )

    @cached_property
    def _kinematics(self) -> tuple[FloatArray, FloatArray]:
        """Centres (4, n, 2) of the inner and outer arcs at rest, and motion (2, n, 2, 5) of the inner ones."""
        centres, motions = [], []
        for arc in self.row.arcs:
            offset, motion = ball_kinematics(arc, self.azimuths)
            arm = (arc.outer_groove - 0.5) * arc.ball_diameter
            outer = -arm * np.array([np.cos(arc.contact_angle), arc.direction * np.sin(arc.contact_angle)])
            centres.append((outer + offset, outer))
            motions.append(motion)
        (first, first_outer), (second, second_outer) = centres
        places = np.array([first, second, first_outer, second_outer])
        return np.repeat(places[:, None, :], self.row.count, axis=1), np.array(motions)

    @property
    def _motion(self) -> FloatArray:
        return self._kinematics[1]

    @cached_property
    def _arms(self) -> FloatArray:
        """Groove radius less the ball's of every arc, (4, 1) [m]."""
        row = self.row
        arms = (row.inner_groove - 0.5) * row.ball_diameter, (row.outer_groove - 0.5) * row.ball_diameter
        return np.repeat(arms, 2)[:, None]

    @cached_property
    def _stiffness(self) -> FloatArray:
        return np.repeat([self.row.inner_contact.stiffness, self.row.outer_contact.stiffness], 2)[:, None]

    def _centres(self, q: FloatArray) -> FloatArray:
        rest, motion = self._kinematics
        centres = rest.copy()
        centres[:2] += motion @ q
        return centres

    def _contacts(self, centres: FloatArray, place: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy (4, n), force on the arcs' centres (4, n, 2) and its slope (4, n, 2, 2); balls at ``place`` (n, 2)."""
        lines = centres - place
        length = np.linalg.norm(lines, axis=2)
        deep = np.maximum(length - self._arms, 0.0)
        normal = lines / np.maximum(length, 1e-300)[..., None]
        load = self._stiffness * deep**1.5
        along = normal[..., :, None] * normal[..., None, :]
        flat = load / np.maximum(length, self._arms)
        slope = (1.5 * self._stiffness * np.sqrt(deep) - flat)[..., None, None] * along
        slope = slope + flat[..., None, None] * np.eye(2)
        return 0.4 * load * deep, load[..., None] * normal, slope

    def _places(self, centres: FloatArray) -> FloatArray:
        """Place of every ball's centre where its forces balance, (n, 2) [m]."""
        place = self._first_places(centres)
        error, out, slope = self._balance(centres, place)
        for _ in range(_NEWTON_STEPS):
            if (error <= _ROUNDED).all():
                break
            singular = np.abs(np.linalg.det(slope)) == 0.0
            step = np.linalg.solve(np.where(singular[:, None, None], np.eye(2), slope), out[:, :, None])[:, :, 0]
            share = np.ones((self.row.count, 1))
            for _ in range(_HALVINGS):
                trial = place - share * step
                new_error, new_out, new_slope = self._balance(centres, trial)
                better = np.linalg.norm(new_out, axis=1) < np.linalg.norm(out, axis=1)
                if better[error > _ROUNDED].all():
                    break
                share[~better] *= 0.5
            place = np.where(better[:, None], trial, place)
            error = np.where(better, new_error, error)
            out = np.where(better[:, None], new_out, out)
            slope = np.where(better[:, None, None], new_slope, slope)
        for ball in np.flatnonzero(error > _ROUNDED):
            place[ball] = self._place(centres[:, ball : ball + 1], place[ball])
        return place

    def _balance(self, centres: FloatArray, place: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Force out of balance on balls at ``place``, relative (n,) and in N (n, 2), and its slope (n, 2, 2)."""
        _, force, slope = self._contacts(centres, place)
        out = -force.sum(axis=0) - np.array([self.thrown, 0.0])
        return np.linalg.norm(out, axis=1) / self._scale(force, slope), out, slope.sum(axis=0)

    def _scale(self, force: FloatArray, slope: FloatArray) -> FloatArray:
        """Force on each ball against which its balance counts, (n,), N, from those of its contacts and their slopes."""
        # A contact's depth is a difference of lengths of its arm, which limits the digits of its force.
        blur = 1e-3 * float(self._arms.max()) * np.einsum("mbii->b", slope)
        least = _LEAST_FORCE * self.row.elasticity.contact_modulus * self.row.ball_diameter**2
        return np.asarray(np.linalg.norm(force, axis=2).sum(axis=0) + self.thrown + blur + least)

    def _first_places(self, centres: FloatArray) -> FloatArray:
        """Estimate the places: both diagonals between alike forces; thrown balls no lower than on the outer arcs."""
        inner, outer = centres[:2], centres[2:]
        line = inner - outer
        length = np.linalg.norm(line, axis=2)
        normal = line / np.maximum(length, 1e-300)[..., None]
        arms, soft = self._arms, self._stiffness ** (-2.0 / 3.0)
        part = soft[2] / (soft[0] + soft[2])
        along = np.einsum("mbi,mbi->mb", normal, outer) + arms[2] + part * (length - arms[0] - arms[2])
        place = np.linalg.solve(np.moveaxis(normal, 0, 1), along.T[:, :, None])[:, :, 0]
        if self.thrown > 0.0:
            cosine = np.cos(self.row.contact_angle)
            share = 0.5 * self.thrown / cosine
            rest = (share / self.row.outer_contact.stiffness) ** (2.0 / 3.0) / cosine
            place[:, 0] = np.maximum(place[:, 0], rest)
        return np.asarray(place)

    def _place(self, centres: FloatArray, start: FloatArray) -> FloatArray:
        """Place of one ball's centre by the trust region, from ``start`` (2,); its centres are (4, 1, 2)."""
        length = self.row.ball_diameter

        def local(part: FloatArray) -> Local:
            value, force, slope = self._contacts(centres, (length * part)[None])
            work = self.thrown * length * float(part[0])
            size = float(self._scale(force, slope)[0])
            return Local(
                value=float(value.sum()) - work,
                gradient=-length * (force.sum(axis=(0, 1)) + [self.thrown, 0.0]),
                hessian=length**2 * slope.sum(axis=(0, 1)),
                noise=float(value.sum()) + abs(work) + size * 0.1 * length,
                force=length * size,
            )

        minimum = minimise(local, start / length, 1e-3, _ROUNDED)
        place = length * minimum.place
        _, out, _ = self._balance(centres, place[None])
        # Of a ball under a force near rounding, such as that of a slow turn, the last digits are none of the bearing's.
        nothing = _NOTHING * _LEAST_FORCE * self.row.elasticity.contact_modulus * length**2
        if minimum.residual > _OPEN and float(np.linalg.norm(out)) > nothing:
            raise EquilibriumError(
                f"a ball in four-point contact is {minimum.residual:.3g} of its loads out of balance after "
                f"{minimum.iterations} steps; expected {_OPEN:g}: check that geometry and speed are in m and rad/s"
            )
        return np.asarray(place)
