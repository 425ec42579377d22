"""The housing's material."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError


@dataclass(frozen=True)
class Material:
    """A linear elastic, isotropic material.

    Attributes
    ----------
    youngs_modulus : float
        E [Pa].
    poisson_ratio : float
        ν, at least 0 and below 0.5.
    density : float
        ρ [kg/m³].
    """

    youngs_modulus: float
    poisson_ratio: float
    density: float

    def __post_init__(self) -> None:
        if not (self.youngs_modulus > 0.0 and self.density > 0.0):
            raise HousingError(f"E = {self.youngs_modulus} Pa and ρ = {self.density} kg/m³ must be positive")
        if not 0.0 <= self.poisson_ratio < 0.5:
            raise HousingError(f"Poisson's ratio {self.poisson_ratio} must be at least 0 and below 0.5")

    @property
    def lame(self) -> tuple[float, float]:
        """Lamé's constants λ and μ [Pa]."""
        e, nu = self.youngs_modulus, self.poisson_ratio
        return e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu))

    @property
    def elasticity(self) -> npt.NDArray[np.float64]:
        """The tensor c_ijkl = λ δ_ij δ_kl + μ (δ_ik δ_jl + δ_il δ_jk) [Pa], shape (3, 3, 3, 3)."""
        lam, mu = self.lame
        d = np.eye(3)
        return np.asarray(
            lam * np.einsum("ij,kl->ijkl", d, d)
            + mu * (np.einsum("ik,jl->ijkl", d, d) + np.einsum("il,jk->ijkl", d, d))
        )
