"""How far a body in one piece with its shaft stiffens it, against finite elements of bodies of revolution."""

import math
from typing import Any

import numpy as np
import pytest
import skfem

from gearwhine.coupling.gears.geometry.toothed_section import bare_lengths
from gearwhine.numerics.arrays import FloatArray

NU = 0.3
SHEAR = 1.0 / (2.0 * (1.0 + NU))  # over Young's modulus
LAME = NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
OVERHANG = 1.5  # of bare shaft beyond the body, in shaft diameters


def half_plane(body: float, width: float) -> skfem.MeshQuad:
    """Meridian of a shaft of diameter 1 with a body in its middle, right half, fine towards the corner between them."""

    def towards(corner: float, far: float) -> FloatArray:
        steps, size = [0.0], 0.008
        while steps[-1] < abs(far - corner):
            steps.append(steps[-1] + size)
            size = min(1.4 * size, 0.08)
        return corner + (far - corner) * np.array(steps) / steps[-1]

    r = np.unique(np.concatenate([towards(0.5, 0.0), towards(0.5, 0.5 * body)]))
    z = np.unique(np.concatenate([towards(0.5 * width, 0.0), towards(0.5 * width, 0.5 * width + OVERHANG)]))
    mesh = skfem.MeshQuad.init_tensor(r, z)
    middle = mesh.p[:, mesh.t].mean(axis=1)
    return mesh.restrict(np.nonzero((middle[0] < 0.5) | (middle[1] < 0.5 * width))[0])


def twist(body: float, width: float) -> float:
    """Length of bare shaft that twists as half of the body, by the displacement around the axis."""
    mesh = half_plane(body, width)
    basis = skfem.Basis(mesh, skfem.ElementQuad2(), intorder=6)

    def strain(u: skfem.DiscreteField, v: skfem.DiscreteField, w: Any) -> FloatArray:
        r = w.x[0]
        return ((u.grad[0] - u / r) * (v.grad[0] - v / r) + u.grad[1] * v.grad[1]) * r  # type: ignore[no-any-return]

    stiffness = skfem.BilinearForm(strain).assemble(basis)
    at_end = mesh.facets_satisfying(lambda x: np.isclose(x[1], 0.5 * width + OVERHANG))
    end = skfem.FacetBasis(mesh, basis.elem, facets=at_end, intorder=6)
    load = skfem.LinearForm(lambda v, w: w.x[0] ** 2 * v).assemble(end)
    held = basis.get_dofs(lambda x: np.isclose(x[1], 0.0) | np.isclose(x[0], 0.0))
    moved = skfem.solve(*skfem.condense(stiffness, load, D=held))
    return float(load @ moved) / (0.5**4 / 4.0) - OVERHANG


def bend(body: float, width: float) -> float:
    """Length of bare shaft that bends as half of the body; displacements go around as cos θ, sin θ and cos θ."""
    mesh = half_plane(body, width)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2(), 3), intorder=6)

    def strains(u: skfem.DiscreteField, r: FloatArray) -> list[FloatArray]:
        slope, (out, around, along) = u.grad, (u[0], u[1], u[2])
        direct = [slope[0][0], (out + around) / r, slope[2][1]]
        return [*direct, slope[0][1] + slope[2][0], slope[1][0] - (around + out) / r, slope[1][1] - along / r]

    def energy(u: skfem.DiscreteField, v: skfem.DiscreteField, w: Any) -> FloatArray:
        ours, theirs = strains(u, w.x[0]), strains(v, w.x[0])
        direct = sum(2.0 * SHEAR * a * b for a, b in zip(ours[:3], theirs[:3], strict=True))
        sheared = sum(SHEAR * a * b for a, b in zip(ours[3:], theirs[3:], strict=True))
        return (LAME * sum(ours[:3]) * sum(theirs[:3]) + direct + sheared) * w.x[0]  # type: ignore[no-any-return]

    stiffness = skfem.BilinearForm(energy).assemble(basis)
    at_end = mesh.facets_satisfying(lambda x: np.isclose(x[1], 0.5 * width + OVERHANG))
    end = skfem.FacetBasis(mesh, basis.elem, facets=at_end, intorder=6)
    load = skfem.LinearForm(lambda v, w: w.x[0] ** 2 * v[2]).assemble(end)
    # The middle stays plane, and the whole may move across.
    plane = basis.get_dofs(lambda x: np.isclose(x[1], 0.0)).all(["u^3"])
    corner = basis.get_dofs(lambda x: np.isclose(x[1], 0.0) & np.isclose(x[0], 0.5)).all(["u^1"])
    moved = skfem.solve(*skfem.condense(stiffness, load, D=np.union1d(plane, corner)))
    return float(load @ moved) / (0.5**4 / 4.0) - OVERHANG


@pytest.mark.parametrize(
    ("body", "width", "tolerance"), [(1.25, 0.5, 0.03), (2.0, 0.2, 0.08), (2.0, 2.0, 0.01), (4.0, 0.5, 0.03)]
)
def test_a_body_stiffens_its_shaft_as_its_finite_elements(body: float, width: float, tolerance: float) -> None:
    """Compliances of half of the body, to a part of those of the bare shaft."""
    for bare, found in zip(bare_lengths(1.0, body, width), (bend(body, width), twist(body, width)), strict=True):
        compliance = bare + (0.5 * width - bare) / body**4
        assert compliance == pytest.approx(found, abs=tolerance * 0.5 * width)


def test_bounds() -> None:
    """A body no wider than its shaft adds no bare length; a narrow one leaves the shaft bare, a wide one a length."""
    assert bare_lengths(0.05, 0.05, 0.03) == (0.0, 0.0)
    assert bare_lengths(0.05, 0.04, 0.03) == (0.0, 0.0)
    assert bare_lengths(0.05, 0.5, 1e-4) == pytest.approx((0.5e-4, 0.5e-4), rel=5e-3)
    half_space = bare_lengths(0.05, 50.0, 50.0)
    assert half_space == pytest.approx((0.243 * 0.05, 0.158 * 0.05), rel=1e-6)
    # A rigid disc on a half-space twists by 3 T / 16 G a³ (Reissner & Sagoci 1944) and tilts by 3 (1 − ν) M / 8 G a³
    # (Borowicka 1943); the end of a shaft is softer, and near.
    a = 0.025
    assert half_space[1] == pytest.approx(3.0 * math.pi * a / 32.0, rel=0.1)
    assert half_space[0] == pytest.approx(3.0 * math.pi * (1.0 - NU**2) * a / 16.0, rel=0.1)
