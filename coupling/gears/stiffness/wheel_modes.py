r"""Out-of-plane vibration of a gear's body on its hub: axisymmetric finite elements by Fourier harmonics.

The body is a solid of revolution, a rim on a web or a disc, whose hub, the circle where it is held, moves with the
shaft. In the harmonic n of the angle θ its displacement along r, θ and z is

    u = (U cos nθ, V sin nθ, W cos nθ)        (the cosine; the sine has sin, -cos, sin)

with the amplitudes U, V, W over the section (Zienkiewicz & Taylor, The Finite Element Method, ch. on semi-analytical
methods; Wilson 1965). Its strains are

    ε_r = U_r,  ε_θ = (U + n V)/r,  ε_z = W_z,  γ_rz = U_z + W_r,  γ_rθ = V_r - (V + n U)/r,  γ_θz = V_z - n W/r.

A section that is symmetric about the middle of the face has motions in its plane and out of it, which do not couple.
Those in the plane are in :mod:`gearwhine.coupling.gears.stiffness.rim_on_hub` and, beyond rotation and shift, in the
static compliance of the teeth. Out of the plane, with U = V = 0 at z = 0, are

- n = 0, the *umbrella*: the rim moves along the axis, which exchanges a force with the hub,
- n = 1, one nodal diameter: the rim tilts, which exchanges a moment with the hub,
- n = 2, 3, ... nodal diameters, which balance themselves.

Each is followed by modes with nodal circles, the first of them the roll of the rim's section. All are natural modes φ
on a hub at rest, of unit modal mass (fixed-interface modes of Craig & Bampton 1968). With the rigid motion r of the
body by its hub, along the axis or a tilt, the coupling inertia is Γ = r M φ.

In a body that rotates at Ω, a cosine and a sine in directions at rest have the gyroscopic term 2 Ω g between them,

    g = ∫ ρ u_c · ∂u_s/∂θ dV = π ∫ ρ [n (U² + V² + W²) + 2 U V] r dr dz,

the derivative that of the vector: n by transport less the part c = -2π ∫ ρ U V r dr dz of the Coriolis force. For one
nodal diameter 2 g takes the place of the polar inertia in the gyroscopic moment, and Γ_p = r G φ that of Γ. Coriolis
force between different modes is neglected, and so is what the rotation adds to the stiffness of the body itself: it
changes a natural frequency ω by some n² Ω²/(2 ω²) of itself (Lamb & Southwell 1921).

Teeth are a mass on the root circle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from scipy import linalg, sparse

from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.stiffness.foundation import held_radius
from gearwhine.numerics.arrays import FloatArray

_FIRST, _MOST = 3, 12  # nodal diameters that are always solved, and the most
_ALONG, _THROUGH = 8, 2  # elements of second order along web or disc, and along the rim and through half a width
_MODES = 6  # most modes of a harmonic


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
    boss, boss_width : float
        Outer radius and width of the ring around the bore [m]; 0 where the web begins at the bore.
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
    boss: float = 0.0
    boss_width: float = 0.0


@dataclass(frozen=True)
class PlateMode:
    """Natural mode of a body out of its plane on a hub at rest: a cosine and a sine; without nodal diameter one alone.

    Attributes
    ----------
    nodal_diameters, nodal_circles : int
        n, and the number of the mode in its harmonic.
    frequency : float
        ω [rad/s].
    coupling : float
        Γ [√kg] of the umbrella, [√kg m] with one nodal diameter; 0 beyond.
    coupling_spin : float
        Γ_p [√kg m] with one nodal diameter; 0 otherwise.
    rotation : float
        g.
    axial : float
        W at the root circle in the middle of the face [1/√kg].
    slopes : tuple of float
        Slopes U_z and V_z of the root circle over the face [1/(m √kg)].
    radius : float
        Root circle radius [m].
    """

    nodal_diameters: int
    nodal_circles: int
    frequency: float
    coupling: float
    coupling_spin: float
    rotation: float
    axial: float
    slopes: tuple[float, float]
    radius: float

    @property
    def size(self) -> int:
        """Number of coordinates: cosine and sine, or one."""
        return 2 if self.nodal_diameters else 1

    @property
    def name(self) -> str:
        """Name in words: ``umbrella``, ``2 nodal diameters``, ``umbrella, 1 nodal circle``."""
        n, circles = self.nodal_diameters, self.nodal_circles
        diameters = f"{n} nodal diameter{'s' * (n > 1)}" if n else "umbrella"
        return f"{diameters}, {circles} nodal circle{'s' * (circles > 1)}" if circles else diameters

    def rows(self, arm: tuple[float, float]) -> FloatArray:
        """Motion of the root circle by the coordinates, shape (5, 2) or (5, 1) [1/√kg, 1/(m √kg)].

        Along z in the middle of the face; slopes of the motions along x and y over the face; slopes along x and y of
        the motion against z, at a point that lies at ``arm`` from the centre along x and y [m]. In a body that tilts
        rigidly both slopes are its tilt.
        """
        n, angle = self.nodal_diameters, math.atan2(arm[1], arm[0])
        cosine, sine = math.cos(n * angle), math.sin(n * angle)
        along, around = np.array([cosine, sine]), np.array([sine, -cosine])
        outward, onward = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
        radial, tangential = np.outer(outward, self.slopes[0] * along), self.slopes[1] * np.outer(onward, around)
        across = n * self.axial / self.radius * np.outer(onward, around)
        return np.vstack([self.axial * along, radial + tangential, radial + across])[:, : self.size]

    def scaled(self, ratio: float) -> PlateMode:
        """Return the mode of a body whose density is this times as high."""
        root = math.sqrt(ratio)
        return replace(
            self,
            frequency=self.frequency / root,
            coupling=self.coupling * root,
            coupling_spin=self.coupling_spin * root,
            axial=self.axial / root,
            slopes=(self.slopes[0] / root, self.slopes[1] / root),
        )


@dataclass(frozen=True)
class WheelModes:
    """Modes of a body out of its plane, by nodal diameters, and its inertia by its elements.

    Attributes
    ----------
    modes : tuple of PlateMode
        The first one with up to three nodal diameters, and all below a limit.
    mass, diametral_inertia : float
        [kg] and [kg m²].
    """

    modes: tuple[PlateMode, ...]
    mass: float
    diametral_inertia: float


def wheel_section(gear: Gear) -> WheelSection | None:
    """Section of a gear's body; None of a gear in one piece with its shaft, of a rim without a web, or of a ring."""
    hub = held_radius(gear)
    if hub is None or gear.is_internal or (gear.rim_inner_radius is not None and gear.web_thickness is None):
        return None
    root, face = gear.root_circle_radius, gear.face_width
    teeth = gear.density * math.pi * face * (gear.pitch_radius**2 - root**2)
    rim = gear.rim_inner_radius or root
    material = gear.youngs_modulus, gear.poisson_ratio, gear.density
    boss = (0.0, 0.0) if gear.hub_diameter is None else (0.5 * gear.hub_diameter, gear.hub_width or face)
    return WheelSection(hub, rim, root, gear.web_thickness or face, face, *material, max(teeth, 0.0), *boss)


@lru_cache(maxsize=64)
def wheel_modes(section: WheelSection, limit: float = 0.0) -> WheelModes:
    """Solve the modes of a body out of its plane below a limit [rad/s], once for a section.

    Raises
    ------
    ValueError
        For radii that do not ascend.
    """
    if not 0.0 < section.hub < section.rim <= section.root:
        raise ValueError(f"radii {section.hub:g}, {section.rim:g} and {section.root:g} m of a wheel do not ascend")
    elements = _section_elements(section)
    modes, inertias = list[PlateMode](), list[float]()
    for n in range(_MOST + 1):
        found, inertia = _harmonic(section, elements, n, limit)
        if n > _FIRST and not found:
            break
        modes += found
        inertias.append(inertia)
    return WheelModes(tuple(modes), *inertias[:2])


@dataclass(frozen=True)
class _Elements:
    """Finite elements over half the section: shapes of e freedoms at q points.

    Attributes
    ----------
    r, z : ndarray, shape (e,)
        Places of the freedoms [m].
    at : ndarray, shape (q,)
        Radii of the points [m].
    area : ndarray, shape (q,)
        Their weights times the radius [m³].
    value, along_r, along_z : sparse matrix, shape (q, e)
        Shapes and their derivatives.
    rim_value, rim_area : sparse matrix and ndarray
        Shapes and weights on the root circle.
    """

    r: FloatArray
    z: FloatArray
    at: FloatArray
    area: FloatArray
    value: sparse.csr_matrix
    along_r: sparse.csr_matrix
    along_z: sparse.csr_matrix
    rim_value: sparse.csr_matrix
    rim_area: FloatArray


def _section_elements(section: WheelSection) -> _Elements:
    import skfem

    def cuts(start: float, end: float) -> FloatArray:
        return np.linspace(start, end, _THROUGH + 1)

    # Narrower towards the hub and the rim, where the web bends most.
    web = 0.5 * (1.0 - np.cos(np.pi * np.arange(_ALONG + 1) / _ALONG))
    inside = max(section.hub, section.boss)
    r, z = inside + (section.rim - inside) * web, np.zeros(1)
    if section.rim < section.root:
        r = np.append(r, cuts(section.rim, section.root)[1:])
    if section.hub < inside:
        r = np.append(cuts(section.hub, inside)[:-1], r)
    for width in sorted({section.web, section.face, section.boss_width} - {0.0}):
        z = np.append(z, cuts(z[-1], 0.5 * width)[1:])
    mesh = skfem.MeshQuad.init_tensor(r, z)
    at_r, at_z = mesh.p[:, mesh.t].mean(axis=1)
    widths = np.select([at_r > section.rim, at_r < inside], [section.face, section.boss_width], section.web)
    mesh = mesh.restrict(np.flatnonzero(at_z < 0.5 * widths))
    basis = skfem.Basis(mesh, skfem.ElementQuad2())
    rim = basis.boundary(lambda x: np.isclose(x[0], section.root))

    def operator(of: Any, fields: list[FloatArray]) -> sparse.csr_matrix:
        """Shapes, (cells, points) each, as a matrix from freedoms to points."""
        points = np.arange(fields[0].size)
        columns = [np.repeat(freedoms, fields[0].shape[1]) for freedoms in of.element_dofs]
        entries = np.concatenate([field.ravel() for field in fields])
        rows = np.tile(points, len(fields))
        return sparse.csr_matrix((entries, (rows, np.concatenate(columns))), shape=(points.size, of.N))

    shapes, rim_shapes = ([part[0] for part in of.basis] for of in (basis, rim))
    at = np.asarray(basis.global_coordinates())[0]
    along_r, along_z = (operator(basis, [np.asarray(shape.grad)[axis] for shape in shapes]) for axis in (0, 1))
    return _Elements(
        basis.doflocs[0],
        basis.doflocs[1],
        at.ravel(),
        (basis.dx * at).ravel(),
        operator(basis, [np.asarray(shape) for shape in shapes]),
        along_r,
        along_z,
        operator(rim, [np.asarray(shape) for shape in rim_shapes]),
        (rim.dx * section.root).ravel(),
    )


def _matrices(section: WheelSection, elements: _Elements, n: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Stiffness, mass and spin (2 g) of a harmonic over U, V and W at the freedoms of half a section, for the body."""
    shear = section.youngs_modulus / (2.0 * (1.0 + section.poisson_ratio))
    lame = 2.0 * shear * section.poisson_ratio / (1.0 - 2.0 * section.poisson_ratio)
    around = 2.0 * (2.0 * math.pi if n == 0 else math.pi)  # both halves, and the mean of cos² over the angle
    by_r, by_z = elements.along_r, elements.along_z
    over_r = sparse.diags(1.0 / elements.at) @ elements.value
    strains = (
        [by_r, None, None],
        [over_r, n * over_r, None],
        [None, None, by_z],
        [by_z, None, by_r],
        [-n * over_r, by_r - over_r, None],
        [None, by_z, -n * over_r],
    )
    empty = 0.0 * by_r
    rows = [sparse.hstack([empty if part is None else part for part in strain]).tocsr() for strain in strains]
    weights = sparse.diags(around * elements.area)
    dilation = rows[0] + rows[1] + rows[2]
    stiffness = lame * dilation.T @ weights @ dilation
    for row, modulus in zip(rows, (2.0, 2.0, 2.0, 1.0, 1.0, 1.0), strict=True):
        stiffness = stiffness + modulus * shear * row.T @ weights @ row
    teeth = section.teeth / (2.0 * math.pi * section.root * section.face)
    inertia = section.density * elements.value.T @ weights @ elements.value
    inertia = inertia + teeth * elements.rim_value.T @ sparse.diags(around * elements.rim_area) @ elements.rim_value
    spin = np.array([[n, 1.0, 0.0], [1.0, n, 0.0], [0.0, 0.0, n]])
    dense = inertia.toarray()
    return stiffness.toarray(), np.kron(np.eye(3), dense), np.kron(2.0 * spin, dense)


def _harmonic(section: WheelSection, elements: _Elements, n: int, limit: float) -> tuple[list[PlateMode], float]:
    """Modes of a harmonic below a limit, of the first few harmonics one at least; inertia of the rigid motion."""
    stiffness, mass, spin = _matrices(section, elements, n)
    r, z = elements.r, elements.z
    held, middle = np.isclose(r, section.hub), np.isclose(z, 0.0, atol=1e-12)
    free = np.flatnonzero(~np.concatenate([held | middle, held | middle | (n == 0), held]))
    rigid = np.concatenate({0: (0.0 * z, 0.0 * z, 1.0 + 0.0 * z), 1: (z, -z, -r)}.get(n, (0.0 * z,) * 3))
    among = np.ix_(free, free)
    values, vectors = linalg.eigh(stiffness[among], mass[among], subset_by_index=[0, _MODES - 1])
    half, outside = 0.5 * section.face, np.isclose(r, section.root)
    edge = int(np.flatnonzero(outside & np.isclose(z, half))[0])
    centre = 2 * r.size + int(np.flatnonzero(outside & middle)[0])
    modes = []
    for number, frequency in enumerate(np.sqrt(values).tolist()):
        if frequency >= limit and (number or n > _FIRST):
            break
        shape = np.zeros(3 * r.size)
        shape[free] = vectors[:, number]
        shape *= math.copysign(1.0, shape[centre])
        mode = PlateMode(
            n,
            number,
            frequency,
            float(rigid @ mass @ shape),
            float(rigid @ spin @ shape) if n == 1 else 0.0,
            0.5 * float(shape @ spin @ shape),
            float(shape[centre]),
            (float(shape[edge]) / half, float(shape[r.size + edge]) / half),
            section.root,
        )
        modes.append(mode)
    return modes, float(rigid @ mass @ rigid)
