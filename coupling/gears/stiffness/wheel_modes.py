r"""Out-of-plane vibration of a gear's body on its hub: axisymmetric finite elements by Fourier harmonics.

The body is a solid of revolution, a rim on a web or a disc, whose hub, the circle where it is held, moves with the
shaft. In the harmonic n of the angle θ its displacement along r, θ and z is

    u = (U cos nθ, V sin nθ, W cos nθ)        (the cosine; the sine has sin, -cos, sin)

with the amplitudes U, V, W over the section (Zienkiewicz & Taylor, The Finite Element Method, ch. on semi-analytical
methods; Wilson 1965). Its strains are

    ε_r = U_r,  ε_θ = (U + n V)/r,  ε_z = W_z,  γ_rz = U_z + W_r,  γ_rθ = V_r - (V + n U)/r,  γ_θz = V_z - n W/r.

A section that is symmetric about the middle of the face has motions in its plane and out of it, which do not couple.
Those in the plane are in :mod:`coupling.gears.stiffness.rim_on_hub` and, beyond rotation and shift, in the static
compliance of the teeth. Out of the plane, with U = V = 0 at z = 0, are

- n = 0, the *umbrella*: the rim moves along the axis,
- n = 1, one nodal diameter: the rim tilts,
- n = 2, 3, two and three nodal diameters.

The first two exchange force or moment with the hub. They have the static shape x of a force, or moment, spread over the
root circle as the rigid motion r of the rim spreads, whose conjugate motion is 1: the stiffness k is exact, and the
inertias are S = r M x and J_r = x M x (Guyan 1965; Craig & Bampton 1968 with static shapes for the ports). The others
have their natural modes φ on the hub at rest, of unit modal mass.

In a body that rotates at Ω, a cosine and a sine in directions at rest have the gyroscopic term 2 Ω g between them,

    g = ∫ ρ u_c · ∂u_s/∂θ dV = π ∫ ρ [n (U² + V² + W²) + 2 U V] r dr dz,

the derivative that of the vector: n by transport less the part c = -2π ∫ ρ U V r dr dz of the Coriolis force. A rim that
tilts rigidly has 2 g = J_p. What the rotation adds to the stiffness of the body itself is neglected: it changes a
natural frequency ω by some n² Ω²/(2 ω²) of itself (Lamb & Southwell 1921).

Teeth are a mass on the root circle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from scipy import linalg

from coupling.gears.geometry.gear import Gear
from coupling.gears.stiffness.foundation import held_radius

if TYPE_CHECKING:
    from skfem import Basis

FloatArray = npt.NDArray[np.float64]

MOST_NODAL_DIAMETERS = 3
_ALONG, _THROUGH = 6, 2  # elements of second order along a ring and through half its width


@dataclass(frozen=True)
class WheelSection:
    """Half of the section of a wheel, z from 0: its hub at rest, a web or a disc, and where there is one a rim.

    Attributes
    ----------
    hub, rim, root : float
        Radii where the body is held, of the inside of the rim, and of the root circle [m]; of a disc the rim's is the
        root circle's.
    web, face : float
        Widths of web and rim [m]; of a disc both are the face width.
    youngs_modulus, poisson_ratio, density : float
    teeth : float
        Mass of the teeth [kg].
    """

    hub: float
    rim: float
    root: float
    web: float
    face: float
    youngs_modulus: float
    poisson_ratio: float
    density: float
    teeth: float = 0.0


@dataclass(frozen=True)
class RimMotion:
    """Motion of the rim out of the plane as one body: along the axis, or tilt.

    Attributes
    ----------
    stiffness : float
        k [N/m] or [N m].
    coupling, rim : float
        S and J_r over the body's mass or diametral inertia.
    coupling_spin, rim_spin : float
        The same of the gyroscopic moment, over the body's polar inertia; 0 along the axis.
    frequency : float
        Natural frequency of the body on a hub at rest in this harmonic [rad/s].
    """

    stiffness: float
    coupling: float
    rim: float
    coupling_spin: float
    rim_spin: float
    frequency: float


@dataclass(frozen=True)
class PlateMode:
    """Natural mode of the body with two nodal diameters or more on a hub at rest: a cosine and a sine.

    Attributes
    ----------
    nodal_diameters : int
        n.
    frequency : float
        ω [rad/s].
    rotation : float
        g.
    axial : float
        W at the root circle in the middle of the face [1/√kg].
    slopes : tuple of float
        Slopes U_z and V_z of the root circle over the face [1/(m √kg)].
    """

    nodal_diameters: int
    frequency: float
    rotation: float
    axial: float
    slopes: tuple[float, float]

    def rows(self, arm: tuple[float, float]) -> FloatArray:
        """Motion of the root circle by the cosine and the sine, shape (3, 2) [1/√kg, 1/(m √kg)].

        Along z in the middle of the face, and slopes of the motions along x and y over the face, at a point that lies
        at ``arm`` from the centre along x and y [m].
        """
        angle = math.atan2(arm[1], arm[0])
        cosine, sine = math.cos(self.nodal_diameters * angle), math.sin(self.nodal_diameters * angle)
        radial, tangential = self.slopes[0] * np.array([cosine, sine]), self.slopes[1] * np.array([sine, -cosine])
        return np.array(
            [
                self.axial * np.array([cosine, sine]),
                math.cos(angle) * radial - math.sin(angle) * tangential,
                math.sin(angle) * radial + math.cos(angle) * tangential,
            ]
        )

    def scaled(self, mass_ratio: float) -> PlateMode:
        """Return the mode of a body whose density is this times as high."""
        root = math.sqrt(mass_ratio)
        slopes = self.slopes[0] / root, self.slopes[1] / root
        return PlateMode(self.nodal_diameters, self.frequency / root, self.rotation, self.axial / root, slopes)


@dataclass(frozen=True)
class WheelModes:
    """Out-of-plane motions of a body: of its rim as one body, and modes with two and three nodal diameters."""

    axial: RimMotion
    tilt: RimMotion
    plates: tuple[PlateMode, ...]


def wheel_section(gear: Gear) -> WheelSection | None:
    """Section of a gear's body; None of a gear in one piece with its shaft, or of a rim without a web."""
    hub = held_radius(gear)
    if hub is None or (gear.rim_inner_radius is not None and gear.web_thickness is None):
        return None
    root, face = gear.root_circle_radius, gear.face_width
    teeth = gear.density * math.pi * face * (gear.pitch_radius**2 - root**2)
    rim = gear.rim_inner_radius or root
    material = gear.youngs_modulus, gear.poisson_ratio, gear.density
    return WheelSection(hub, rim, root, gear.web_thickness or face, face, *material, max(teeth, 0.0))


@lru_cache(maxsize=64)
def wheel_modes(section: WheelSection) -> WheelModes:
    """Solve the out-of-plane motions of a body, once for a section.

    Raises
    ------
    ValueError
        For radii that do not ascend.
    """
    if not 0.0 < section.hub < section.rim <= section.root:
        raise ValueError(f"radii {section.hub:g}, {section.rim:g} and {section.root:g} m of a wheel do not ascend")
    basis = _section_basis(section)
    plates = [_plate_mode(section, basis, n) for n in range(2, MOST_NODAL_DIAMETERS + 1)]
    return WheelModes(_rim_motion(section, basis, 0), _rim_motion(section, basis, 1), tuple(plates))


def _section_basis(section: WheelSection) -> Basis:
    """Finite elements over half the section, with U, V, W at each node."""
    import skfem

    def cuts(start: float, end: float, count: int) -> FloatArray:
        return np.linspace(start, end, count + 1)

    r, z = cuts(section.hub, section.rim, _ALONG), cuts(0.0, 0.5 * section.web, _THROUGH)
    if section.rim < section.root:
        r = np.append(r, cuts(section.rim, section.root, _THROUGH)[1:])
    if section.web < section.face:
        z = np.append(z, cuts(0.5 * section.web, 0.5 * section.face, _THROUGH)[1:])
    mesh = skfem.MeshQuad.init_tensor(r, z)
    at_r, at_z = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.restrict(np.flatnonzero((at_r > section.rim) | (at_z < 0.5 * section.web)))
    return skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2(), 3))


def _matrices(section: WheelSection, basis: Basis, n: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Stiffness, mass and spin (2 g) of a harmonic over the freedoms of half the section, for the whole body."""
    import skfem

    shear = section.youngs_modulus / (2.0 * (1.0 + section.poisson_ratio))
    lame = 2.0 * shear * section.poisson_ratio / (1.0 - 2.0 * section.poisson_ratio)
    around = 2.0 * (2.0 * math.pi if n == 0 else math.pi)  # both halves, and the mean of cos² over the angle

    def strains(u: Any, r: Any) -> tuple[Any, ...]:
        value, slope = u, u.grad
        direct = slope[0, 0], (value[0] + n * value[1]) / r, slope[2, 1]
        return (
            *direct,
            slope[0, 1] + slope[2, 0],
            slope[1, 0] - (value[1] + n * value[0]) / r,
            slope[1, 1] - n * value[2] / r,
        )

    def elastic(u: Any, v: Any, w: Any) -> Any:
        a, b = strains(u, w.x[0]), strains(v, w.x[0])
        normal = lame * sum(a[:3]) * sum(b[:3]) + 2.0 * shear * sum(p * q for p, q in zip(a[:3], b[:3], strict=True))
        return around * w.x[0] * (normal + shear * sum(p * q for p, q in zip(a[3:], b[3:], strict=True)))

    def product(u: Any, v: Any) -> Any:
        return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]

    def spinning(u: Any, v: Any) -> Any:
        return 2.0 * (n * product(u, v) + u[0] * v[1] + u[1] * v[0])

    teeth = section.teeth / (2.0 * math.pi * section.root * section.face)
    rim = basis.boundary(lambda x: np.isclose(x[0], section.root))
    stiffness = skfem.BilinearForm(elastic).assemble(basis).toarray()
    inertias = [
        skfem.BilinearForm(lambda u, v, w, form=form: around * section.density * w.x[0] * form(u, v)).assemble(basis)
        + skfem.BilinearForm(lambda u, v, w, form=form: around * teeth * w.x[0] * form(u, v)).assemble(rim)
        for form in (product, spinning)
    ]
    return stiffness, inertias[0].toarray(), inertias[1].toarray()


def _free(section: WheelSection, basis: Basis, n: int) -> npt.NDArray[np.int64]:
    """Freedoms that move out of the plane on a hub at rest."""
    r, z = basis.doflocs
    part = np.zeros(basis.N, dtype=np.int64)
    for number in range(3):
        part[_of_component(basis, number)] = number
    held = np.isclose(r, section.hub) | (np.isclose(z, 0.0, atol=1e-12) & (part < 2)) | ((part == 1) & (n == 0))
    return np.flatnonzero(~held)


def _of_component(basis: Basis, number: int) -> npt.NDArray[np.int64]:
    """Freedoms of U, V or W: those of each node follow each other."""
    return np.sort(np.concatenate([kind[number::3].ravel() for kind in _kinds_of_freedoms(basis) if kind.size]))


def _kinds_of_freedoms(basis: Basis) -> list[npt.NDArray[np.int64]]:
    return [basis.dofs.nodal_dofs, basis.dofs.facet_dofs, basis.dofs.interior_dofs]


def _rigid(basis: Basis, n: int) -> FloatArray:
    """Rigid motion of the whole body: along the axis for n = 0, tilt for n = 1."""
    motion = np.zeros(basis.N)
    r, z = basis.doflocs
    for number, values in enumerate((0.0 * z, 0.0 * z, 1.0 + 0.0 * z) if n == 0 else (z, -z, -r)):
        of = _of_component(basis, number)
        motion[of] = values[of]
    return motion


def _rim_motion(section: WheelSection, basis: Basis, n: int) -> RimMotion:
    import skfem

    stiffness, mass, spin = _matrices(section, basis, n)
    free, rigid = _free(section, basis, n), _rigid(basis, n)
    around = 2.0 * (2.0 * math.pi if n == 0 else math.pi)
    rim = basis.boundary(lambda x: np.isclose(x[0], section.root))
    spread = skfem.BilinearForm(lambda u, v, w: around * w.x[0] * (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]))
    load = spread.assemble(rim) @ rigid
    load /= rigid @ load  # conjugate to a motion that is 1 where the rim moves rigidly
    among = np.ix_(free, free)
    shape = np.zeros(basis.N)
    shape[free] = linalg.solve(stiffness[among], load[free], assume_a="pos")
    compliance = float(load @ shape)
    shape /= compliance
    whole, polar = float(rigid @ mass @ rigid), float(rigid @ spin @ rigid)
    first = float(linalg.eigh(stiffness[among], mass[among], eigvals_only=True, subset_by_index=[0, 0])[0])
    return RimMotion(
        1.0 / compliance,
        float(rigid @ mass @ shape) / whole,
        float(shape @ mass @ shape) / whole,
        0.0 if n == 0 else float(rigid @ spin @ shape) / polar,
        0.0 if n == 0 else float(shape @ spin @ shape) / polar,
        math.sqrt(first),
    )


def _plate_mode(section: WheelSection, basis: Basis, n: int) -> PlateMode:
    stiffness, mass, spin = _matrices(section, basis, n)
    free = _free(section, basis, n)
    among = np.ix_(free, free)
    values, vectors = linalg.eigh(stiffness[among], mass[among], subset_by_index=[0, 0])
    shape = np.zeros(basis.N)
    shape[free] = vectors[:, 0]
    r, z = basis.doflocs

    def at_root(component: int, height: float) -> float:
        of = _of_component(basis, component)
        place = np.isclose(r[of], section.root) & np.isclose(z[of], height, atol=1e-12)
        return float(shape[of[place]][0])

    half = 0.5 * section.face
    axial = at_root(2, 0.0)
    turned = math.copysign(1.0, axial)
    slopes = turned * at_root(0, half) / half, turned * at_root(1, half) / half
    return PlateMode(n, math.sqrt(float(values[0])), 0.5 * float(shape @ spin @ shape), abs(axial), slopes)
