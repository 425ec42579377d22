"""Lightly damped whirl of a projected rotor whose planes are coupled by the gyroscopic moment alone.

Let Λ_x and Λ_y be the squared frequencies of both planes at rest, and all matrices be those of their modes. With
states p = (Λ_x^½ q_x, q̇_y) and s = (q̇_x, −Λ_y^½ q_y), undamped motion at the speed Ω is

    ṗ = C s,    ṡ = −Cᵀp,    C = [[Λ_x^½, 0], [Ω G, Λ_y^½]],

so that its frequencies are the singular values of C = U σ Vᵀ, and its motions p = u_k, s = ± i v_k: a symmetric
eigenproblem CᵀC of half the order of the system in q and q̇. Damping is −D_y on q̇_y in p and −D_x on q̇_x in s; with
A = Uᵀ(−D)U / 2 and B = Vᵀ(−D)V / 2 of either, perturbation to second order makes

    λ_k = iσ_k + A_kk + B_kk + Σ_{j≠k} (A + B)_kj (A + B)_jk / i(σ_k − σ_j) + Σ_j (A − B)_kj (A − B)_jk / i(σ_k + σ_j).

The error is of third order, provided that damping couples modes by a small part of the distance of their eigenvalues.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]

# Most that damping may couple modes, squared, relative to their distance: starting values then err by a thousandth of
# the distance. Checked for the lower half: above are responses to loads, which stand for all higher modes and start no
# root.
MOST_MIXED = 0.01
# Squared frequencies below this part of the largest lose their digits in CᵀC.
LEAST_SQUARED = 1e-10
# Stiffness may lack this part of its size to be symmetric, from rounding.
ROUNDING = 1e-12


@dataclass(frozen=True)
class CoupledPlanes:
    """Both planes at rest, with gyroscopic coupling and light damping.

    Attributes
    ----------
    frequencies
        (x + y,): of both planes at rest, ascending in each, rad/s.
    gyroscopic
        (y, x): G, per rad/s of the speed.
    damping_x, damping_y
        (x, x) and (y, y): D, 1/s.
    """

    frequencies: FloatArray
    gyroscopic: FloatArray
    damping_x: FloatArray
    damping_y: FloatArray

    @classmethod
    def of(
        cls, mass: FloatArray, stiffness: FloatArray, damping: FloatArray, gyroscopic: FloatArray, in_x: BoolArray
    ) -> "CoupledPlanes | None":
        """From diagonal mass (N,) and matrices (N, N), ``in_x`` marking one plane; None where it does not apply."""
        x, y = np.flatnonzero(in_x), np.flatnonzero(~in_x)
        apart = np.ix_(x, y), np.ix_(y, x)
        within = np.ix_(x, x), np.ix_(y, y)
        if any(matrix[place].any() for matrix in (stiffness, damping) for place in apart):
            return None
        skewed = np.abs(stiffness - stiffness.T).max() > ROUNDING * np.abs(stiffness).max()
        if skewed or any(gyroscopic[place].any() for place in within):
            return None
        unit = 1.0 / np.sqrt(mass)
        stiffness, damping, gyroscopic = (unit[:, None] * m * unit for m in (stiffness, damping, gyroscopic))
        (squared_x, shapes_x), (squared_y, shapes_y) = (np.linalg.eigh(stiffness[place]) for place in within)
        squared = np.concatenate([squared_x, squared_y])
        if squared.min() <= LEAST_SQUARED * squared.max():
            return None
        return cls(
            np.sqrt(squared),
            -shapes_y.T @ gyroscopic[apart[1]] @ shapes_x,
            shapes_x.T @ damping[within[0]] @ shapes_x,
            shapes_y.T @ damping[within[1]] @ shapes_y,
        )

    def eigenvalues(self, speeds: FloatArray) -> tuple[ComplexArray, BoolArray]:
        """All λ with conjugates, (speeds, 2N), rad/s, and the speeds at which damping couples modes too strongly."""
        from .tied_kernels import damped, squares

        squared, right = np.linalg.eigh(squares(self.frequencies, self.gyroscopic, speeds))
        tie = self.frequencies, self.gyroscopic, speeds
        values, mixed = damped(squared, right, *tie, self.damping_x, self.damping_y)
        return values, mixed > MOST_MIXED
