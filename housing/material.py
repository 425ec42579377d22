"""Material of a housing: linear elastic and isotropic; Lamé's constants, and mass properties of a meshed solid.

Each element of a mesh has the constants of its material. Mass and centre of mass follow from the geometry of the
elements; the enclosed volume and its centroid follow from the boundary alone, by the divergence theorem.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import HousingError
from gearwhine.meshes import Mesh
from gearwhine.meshes.shape_functions import element_moments, quadrature, shape_functions
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, refuse
from gearwhine.numerics.materials import material_findings


@dataclass(frozen=True)
class Material:
    """A linear elastic, isotropic material, of a housing and of anything else: a shaft's segments take it as it is.

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
        """Refuse what no solid is."""
        refuse(self.findings, HousingError)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is impossible or unlikely of the material."""
        numbers = self.youngs_modulus, self.poisson_ratio, self.density
        return tuple(material_findings(("material", ""), *numbers))

    @property
    def shear_modulus(self) -> float:
        """G = E / 2(1 + ν) [Pa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def lame(self) -> tuple[float, float]:
        """Lamé's constants λ and μ [Pa]."""
        e, nu = self.youngs_modulus, self.poisson_ratio
        return e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), self.shear_modulus

    @property
    def elasticity(self) -> npt.NDArray[np.float64]:
        """The tensor c_ijkl = λ δ_ij δ_kl + μ (δ_ik δ_jl + δ_il δ_jk) [Pa], shape (3, 3, 3, 3)."""
        lam, mu = self.lame
        d = np.eye(3)
        return np.asarray(
            lam * np.einsum("ij,kl->ijkl", d, d)
            + mu * (np.einsum("ik,jl->ijkl", d, d) + np.einsum("il,jk->ijkl", d, d))
        )


STEEL = Material(youngs_modulus=207e9, poisson_ratio=0.3, density=7850.0)
"""Steel, of housings, shafts and gears alike."""


def element_constants(mesh: Mesh, material: Material, materials: Mapping[str, Material]) -> npt.NDArray[np.float64]:
    """λ, μ [Pa] and ρ [kg/m³] of each element, shape (3, n_elements).

    ``materials`` has those of named volumes of the mesh, ``material`` is that of all other elements.

    Raises
    ------
    HousingError
        Where the mesh has no volume of a name, or two volumes share elements.
    """
    constants = np.tile(np.array([*material.lame, material.density])[:, None], mesh.n_elements)
    owner: dict[int, str] = {}
    volume_number = np.zeros(mesh.n_elements, dtype=np.int64)
    for number, (name, volume_material) in enumerate(materials.items(), start=1):
        if name not in mesh.volumes:
            names = ", ".join(sorted(mesh.volumes)) or "none"
            raise HousingError(f"the mesh has no volume {name!r} to be of its own material; it has: {names}")
        members = np.asarray(mesh.volumes[name])
        both = members[volume_number[members] > 0]
        if len(both):
            other = owner[int(volume_number[both[0]])]
            raise HousingError(f"volumes {other!r} and {name!r} share {len(both)} elements; each has one material only")
        owner[number], volume_number[members] = name, number
        constants[:, members] = np.array([*volume_material.lame, volume_material.density])[:, None]
    return constants


_DEGREE = 6  # degree of p (p·n) on a curved quadratic facet: nothing is left to the quadrature


def enclosed_volume(mesh: Mesh) -> tuple[float, FloatArray]:
    """Volume and centroid enclosed by the boundary: V = ∮ p·n dA / 3 and V c = ∮ p (p·n) dA / 4.

    The result is independent of the elements' own quadrature and so checks it. With n dA the cross product of the
    facet's tangents both integrands are polynomials, integrated exactly on curved facets too.

    Returns
    -------
    volume : float
        Volume [m³].
    centroid : ndarray, shape (3,)
        Centroid [m].
    """
    # About the middle of the body, where the sums cancel least.
    middle = mesh.bounds.mean(axis=0)
    volume, moment = 0.0, np.zeros(3)
    for block in mesh.boundary:
        places, weights = quadrature(block.kind, _DEGREE)
        values, gradients = shape_functions(block.kind, places)
        nodes = mesh.points[block.nodes] - middle
        points = np.einsum("fai,qa->fqi", nodes, values, optimize=True)
        tangents = np.einsum("fai,qaj->fqij", nodes, gradients, optimize=True)
        flux = np.einsum("fqi,fqi,q->fq", points, np.cross(tangents[..., 0], tangents[..., 1]), weights)
        volume += float(flux.sum() / 3.0)
        moment += np.einsum("fqi,fq->i", points, flux) / 4.0
    return volume, np.asarray(middle + moment / volume)


@dataclass(frozen=True)
class MassProperties:
    """Mass and centre of mass of a solid.

    Attributes
    ----------
    mass : float
        ∫ ρ dV [kg].
    center : ndarray, shape (3,)
        ∫ ρ x dV / mass [m].
    """

    mass: float
    center: FloatArray


def mass_properties(mesh: Mesh, material: Material, materials: Mapping[str, Material] | None = None) -> MassProperties:
    """Mass and centre of mass of a meshed solid, curved sides included.

    They need no mass matrix, and serve to check one: its rigid-body mass must be the same.

    Parameters
    ----------
    mesh, material, materials
        As for :func:`gearwhine.housing.assemble`.
    """
    density = element_constants(mesh, material, materials or {})[2]
    moments = [element_moments(mesh.points, block.nodes, block.kind) for block in mesh.blocks]
    mass = density @ np.concatenate([moment.volume for moment in moments])
    first = density @ np.concatenate([moment.first for moment in moments])
    return MassProperties(float(mass), np.asarray(first / mass))
