"""Exact transfer matrices of a shaft element: Timoshenko beam in bending, rod in torsion or along its axis.

The equations; :mod:`gearwhine.rotors.transfer_matrix.timoshenko_kernels` has them compiled.

Bending, at circular frequency ω, with the section's displacement x and rotation β, under a static axial
force P (tension positive). From the energy ½ ∫ κGA (x' − β)² + EI β'² + P x'² dz the transverse force is
``f_x = κGA (x' − β) + P x'`` and the bending moment ``f_β = EI β'``; with g = κGA / (κGA + P)::

    x'   = g β + f_x / (κGA + P)        f_x' = −ω² ρA x
    β'   = f_β / EI                     f_β' = −(ω² ρI − g P) β − g f_x

or y' = A(z) y with y = (x, β, f_x, f_β). A rod is the same with y = (u, f): u' = f/EA, f' = −ω² ρA u, and in
torsion with GJ and ρJ. ω² may differ between translation and rotation, and be complex: this is how a
turning or damped shaft enters.

**A uniform element** has T = exp(A h). The characteristic polynomial of A h holds only even powers,
λ⁴ − e₁ λ² + e₂, so that

    T = C₀ I + C₁ (A h) + C₂ (A h)² + C₃ (A h)³

where, by reducing the exponential series modulo that polynomial,

    C₂ = Σ_{k≥1} h_{k−1}/(2k)!        C₀ = 1 − e₂ Σ_{k≥2} h_{k−2}/(2k)!
    C₃ = Σ_{k≥1} h_{k−1}/(2k+1)!      C₁ = 1 − e₂ Σ_{k≥2} h_{k−2}/(2k+1)!

with h_k = e₁ h_{k−1} − e₂ h_{k−2}, h_0 = 1, h_{−1} = 0 (the complete homogeneous polynomials of the
two roots λ²). These series are entire: they need no square root, so the cut-off frequency √(κGA/ρI),
where the second wave number turns real, the massless field of Myklestad and Prohl's lumped shaft (ρ = 0),
the static state (ω = 0) and negative ω² (a shifted, positive definite problem) are no special cases.
They are used on elements short enough (`gearwhine.rotors.transfer_matrix.discretised_shaft`) that |λ²| stays below 5,
where thirteen terms are exact to rounding and no hyperbolic function can overflow.

**A tapering element** has coefficients that are polynomials in s, from −1 at its left end to 1
(`gearwhine.rotors.model.profile` makes them, exact to rounding). Its solution is an entire function, whose power series
about the middle is summed, y(s) = Φ(s) y(0); then T = Φ(1) Φ(−1)⁻¹. Both equations are Hamiltonian (reciprocity), hence
Φ symplectic, and its inverse is a transposition: T is symplectic to rounding too.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray, IndexArray

NumberArray = npt.NDArray[Any]

WHOLE = np.ones(1)


@dataclass(frozen=True)
class ShaftElements:
    """Shaft elements that differ from each other, in any consistent units.

    Attributes
    ----------
    lengths : ndarray, shape (e,)
        Lengths of the elements.
    coefficients : ndarray, shape (e, 6, j) or (e, 2, j)
        Coefficients; in bending 1/(κGA + P), 1/EI, ρA, ρI, g and g P; for a rod 1/EA and ρA, or 1/GJ and ρJ. The last
        axis has the coefficients of 1, s, s², ...; j is 1 where all elements are uniform.
    """

    lengths: FloatArray
    coefficients: FloatArray

    @property
    def size(self) -> int:
        """Number n of displacements at an end: 2 in bending, 1 for a rod."""
        return 2 if self.coefficients.shape[1] == 6 else 1

    def transfer_matrices(
        self, translation: npt.ArrayLike, rotation: npt.ArrayLike | None = None, fractions: FloatArray = WHOLE
    ) -> NumberArray:
        """Transfer matrices from the left end to fractions of the length: state there = T · state at the left.

        Parameters
        ----------
        translation : array_like, shape (b,)
            Factor ω² of the mass, real or complex, of a size for which the elements are short enough.
        rotation : array_like, shape (b,), optional
            Factor ω² of the rotary inertia, unused for a rod; by default ``translation``.
        fractions : ndarray, shape (k,), optional
            Fractions of every element's length; by default the whole length.

        Returns
        -------
        ndarray, shape (b, e, k, 2n, 2n)
            Rows and columns in the order displacement, rotation, force, moment; or angle, torque.
        """
        from gearwhine.rotors.transfer_matrix.timoshenko_kernels import table_transfer_matrices

        moving, turning = _pair(translation, rotation)
        shape = (moving.size, self.lengths.size, fractions.size, 2 * self.size, 2 * self.size)
        out = np.empty(shape, moving.dtype)
        table_transfer_matrices(self.lengths, self.coefficients, moving, turning, fractions, out)
        return out

    def transfer_matrices_to(
        self,
        element: IndexArray,
        fractions: FloatArray,
        translation: npt.ArrayLike,
        rotation: npt.ArrayLike | None = None,
    ) -> NumberArray:
        """Transfer matrices to one fraction (z,) each of some elements (z,), at every ω² (b,), (z, b, 2n, 2n)."""
        from gearwhine.rotors.transfer_matrix.timoshenko_kernels import place_transfer_matrices

        moving, turning = _pair(translation, rotation)
        out = np.empty((element.size, moving.size, 2 * self.size, 2 * self.size), moving.dtype)
        place_transfer_matrices(self.lengths, self.coefficients, element, fractions, moving, turning, out)
        return out

    def growth(self, frequency: float) -> FloatArray:
        """Bound on the exponential growth of motion along the elements at ω, (e,): the root of a bound on |λ²|."""
        largest = np.abs(self.coefficients).sum(axis=2) * self.lengths[:, None]
        if self.size == 1:
            return np.asarray(frequency * np.sqrt(largest[:, 0] * largest[:, 1]))
        a, b, m, j, k, axial = largest.T
        m, j = frequency**2 * m, frequency**2 * j + axial
        return np.asarray(np.sqrt(a * m + b * j + np.sqrt(b * m * (a * j + k * k))))

    def coefficients_along(self, fractions: FloatArray) -> FloatArray:
        """Coefficients at the same fractions (k,) of every element, (e, k, 6) or (e, k, 2)."""
        kinds, fields, order = self.coefficients.shape
        if order == 1:
            return np.broadcast_to(self.coefficients.reshape(kinds, 1, fields), (kinds, fractions.size, fields))
        powers = (2.0 * fractions[:, None] - 1.0) ** np.arange(order)
        return np.asarray(np.einsum("efj,kj->ekf", self.coefficients, powers))

    def coefficients_at(self, element: IndexArray, fractions: FloatArray) -> FloatArray:
        """Coefficients at fractions (z,) of some elements (z,), (z, 6) or (z, 2)."""
        selected = self.coefficients[element]
        if selected.shape[2] == 1:
            return selected[:, :, 0]
        powers = (2.0 * fractions[:, None] - 1.0) ** np.arange(selected.shape[2])
        return np.asarray(np.einsum("zfj,zj->zf", selected, powers))


def _pair(translation: npt.ArrayLike, rotation: npt.ArrayLike | None) -> tuple[NumberArray, NumberArray]:
    moving = np.atleast_1d(np.asarray(translation))
    turning = moving if rotation is None else np.atleast_1d(np.asarray(rotation))
    kind = np.result_type(moving, turning, np.float64)
    moving, turning = np.broadcast_arrays(moving.astype(kind), turning.astype(kind))
    return np.ascontiguousarray(moving), np.ascontiguousarray(turning)
