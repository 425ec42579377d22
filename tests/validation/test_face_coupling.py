"""The coupling of a face against three-dimensional finite elements of one wide tooth, held at its foot.

The tooth of the 28-tooth rig gear (TM-104434, Table I), 12 modules wide, of 27-node bricks: a load on a short piece of
the face, at the height of the pitch circle and spread through the thickness so that it dents nothing; deflections in
the middle plane. The slices' foundation gets k_b from the same elements under an even load, and T from theory alone.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import pytest
from scipy import sparse

from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.contact.face_slices import FaceSlices, face_equilibrium, tooth_coupling
from gearwhine.coupling.gears.geometry.profile import tooth_outline
from gearwhine.coupling.gears.stiffness.hertz import line_contact
from gearwhine.housing import Material, assemble
from gearwhine.housing.fem.factorization import Factorization, Factorizer
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray

SOURCE = "Solid finite elements of one wide tooth, of our own"
GEAR = Gear("rig", 28, 3.175e-3, math.radians(20.0), 6.35e-3)
THICK, HIGH, LONG = 3, 6, 30
WIDTH = 12.0 * GEAR.module


@dataclass(frozen=True)
class Tooth:
    """The factored model: middle-plane places and deflections at the load's height."""

    factor: Factorization
    free: npt.NDArray[np.intp]
    places: FloatArray
    at_height: npt.NDArray[np.intp]
    z: FloatArray
    middle: npt.NDArray[np.intp]

    def deflection(self, share: FloatArray) -> FloatArray:
        """Middle-plane deflection under a load with given shares of its quadratic nodes along the face, N."""
        load = np.zeros(self.places.shape[1])
        through = _simpson(2 * THICK + 1)
        ratios = np.unique(np.round(self.places[0, self.at_height] / self.places[0, self.at_height].max(), 9))
        for dof in self.at_height:
            along = int(np.abs(self.z - self.places[2, dof]).argmin())
            across = int(np.abs(ratios - self.places[0, dof] / self.places[0, self.at_height].max()).argmin())
            load[dof] = share[along] * through[across]
        answer = np.zeros_like(load)
        answer[self.free] = self.factor.solve(load[self.free])
        return np.asarray(answer[self.middle])


def _simpson(count: int) -> FloatArray:
    weights = np.ones(count)
    weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
    return weights / weights.sum()


@pytest.fixture(scope="module")
def tooth(block_of: Callable[..., Mesh]) -> Tooth:
    across, along = tooth_outline(GEAR)[:119].T
    height, half = along - along[0], -across
    load = float(np.interp(GEAR.pitch_radius, np.hypot(across, along), height))
    below = round(HIGH * load / height[-1])
    levels = np.concatenate([np.linspace(0, load, below + 1), np.linspace(load, height[-1], HIGH - below + 1)[1:]])
    halves = np.interp(levels, height, half)

    def shaped(points: FloatArray) -> FloatArray:
        level = HIGH * points[:, 1]
        wide = np.interp(level, np.arange(HIGH + 1), halves)
        high = np.interp(level, np.arange(HIGH + 1), levels)
        return np.column_stack([(2.0 * points[:, 0] - 1.0) * wide, high, (points[:, 2] - 0.5) * WIDTH])

    mesh = block_of("hexahedron27", cells=(THICK, HIGH, LONG), bend=shaped)
    matrices = assemble(mesh, Material(GEAR.youngs_modulus, GEAR.poisson_ratio, 7850.0), threads=1)
    places = np.repeat(mesh.points, 3, axis=0).T
    free = np.flatnonzero(np.abs(places[1]) > 1e-9)
    at_height = 3 * np.flatnonzero(np.abs(mesh.points[:, 1] - load) < 1e-9)
    middle = at_height[np.abs(places[0, at_height]) < 1e-12]
    middle = middle[np.argsort(places[2, middle])]
    factor = Factorizer(threads=1).factor(sparse.csr_array(matrices.stiffness[free][:, free]))
    z = np.unique(np.round(places[2, at_height], 12))
    return Tooth(factor, free, places, at_height, z, middle)


# At the load, one module and two modules along the face from it.
@pytest.mark.parametrize(("place", "bars"), [(0.0, (0.12, 0.12, 0.3)), (-0.5, (0.17, 0.12, 0.3))])
def test_a_short_load_spreads_as_far_as_theory_says(tooth: Tooth, place: float, bars: tuple[float, ...]) -> None:
    even = tooth.deflection(_simpson(tooth.z.size))
    base = 1.0 / (float(even[even.size // 2]) * WIDTH)
    node = int(np.abs(tooth.z - place * (WIDTH - WIDTH / LONG)).argmin())
    node += node % 2 == 0
    share = np.zeros(tooth.z.size)
    share[node] = 1.0
    found = tooth.deflection(share)

    coupling = tooth_coupling(GEAR, GEAR.pitch_radius)
    away = GEAR.module * np.arange(3.0)
    theirs = np.interp(tooth.z[node] + away, tooth.z, found)
    ours, third = (on_foundation(base, share * coupling, tooth.z[node], away) for share in (1.0, 1.0 / 3.0))
    np.testing.assert_array_less(np.abs(ours / theirs - 1.0), bars)
    # A coupling of a third would not do.
    assert np.all(np.abs(third / theirs - 1.0) > bars)


def test_a_tilted_tooth_presses_at_its_ends_as_in_solid_elements(tooth: Tooth, published: Callable[..., None]) -> None:
    """K_Hβ of flanks that approach like 1 + z / b, on the elements and on slices with Weber's flattening.

    Half of the flattening belongs to either tooth. The nodes' shares of the load make the end's load per width.
    """
    count = tooth.z.size
    share = _simpson(count)
    pair = GearPairGeometry(GEAR, replace(GEAR, name="wheel"))
    weber = line_contact(pair, [0.5 * pair.contact_ratio]).secant_compliance(300e3 * GEAR.face_width)
    flattening = 2.0 / (float(weber[0]) * GEAR.face_width)
    each = np.array([tooth.deflection(row) for row in np.eye(count)])
    approaches = np.column_stack([1.0 + tooth.z / WIDTH, np.ones(count)])
    tilted, even = (np.linalg.solve(each + np.diag(1.0 / (flattening * WIDTH * share)), approaches).T) / share
    theirs = float((tilted / even)[-1] * (share @ even) / (share @ tilted))

    deflection = tooth.deflection(share)
    base = 1.0 / (float(deflection[count // 2]) * WIDTH)
    slices, step = 61, WIDTH / 61
    z = step * (np.arange(slices) + 0.5) - 0.5 * WIDTH
    faces = FaceSlices(z, step, np.zeros(slices), np.zeros(slices), flattening, tooth_coupling(GEAR, GEAR.pitch_radius))
    meeting, owner = np.ones((1, slices), dtype=np.bool_), np.zeros(1, dtype=np.intp)
    # Under this force the mean approach is 10 µm.
    force = 1e-5 * WIDTH / (1.0 / base + 1.0 / flattening)
    gap = -1e-5 * (z / WIDTH)[None]
    _, loads = face_equilibrium(faces, np.full((1, slices), base), gap, meeting, owner, np.array([force]))
    load = loads.line_load[0]
    assert np.all(load > 0.0)
    ours = float(np.array([15.0, -10.0, 3.0]) @ load[:-4:-1]) / 8.0 / float(load.mean())
    published(SOURCE, "K_Hβ of a tooth under a straight approach, 1.5 without twist", theirs, ours, rel=0.03)
    assert theirs > 1.52


def on_foundation(base: float, coupling: float, at: float, away: FloatArray) -> FloatArray:
    """Deflection [m] at distances from a piece of the face that carries 1 N, on Pasternak's foundation."""
    count = 40 * LONG
    width = WIDTH / count
    z = width * (np.arange(count) + 0.5) - WIDTH / 2
    link = coupling / width**2
    matrix = np.diag(np.full(count, base + 2.0 * link)) - link * (np.eye(count, k=1) + np.eye(count, k=-1))
    matrix[0, 0] -= link
    matrix[-1, -1] -= link
    loaded = np.where(np.abs(z - at) < 0.5 * WIDTH / LONG, 1.0, 0.0)
    deflection = np.linalg.solve(matrix, loaded / (loaded.sum() * width))
    return np.interp(at + away, z, deflection)
