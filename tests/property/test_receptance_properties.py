"""The whole housing between its ports: reciprocal, and the same in every frame.

Two bores with six motions each and two sensors; on mounts with springs and dashpots of their own axes, a strut, a motor
off its patch, a sensor's mass, a patch held fast and one on springs; modes with residual attachments at all ports.
"""

from dataclasses import dataclass, replace
from itertools import permutations, product

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy import sparse
from scipy.linalg import block_diag
from scipy.sparse.linalg import splu
from scipy.spatial.transform import Rotation

from gearwhine.housing import (
    Bushing,
    Joint,
    LumpedMass,
    Material,
    ModeSet,
    Mount,
    Patch,
    Seat,
    Sensor,
    Support,
    assemble,
    attach_fixtures,
    modal_damping,
    receptance,
    solve_modes,
)
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.fixtures import Fixture
from gearwhine.housing.model.seats import seat_matrix, sensor_port
from gearwhine.housing.model.supports import fixed_freedoms
from gearwhine.housing.modes.effective_mass import damping_ratios
from gearwhine.meshes import Bore, BoxGeometry, Feet, Mesh, WallThickness, mesh_box
from gearwhine.numerics.arrays import ComplexArray, FloatArray

Point = tuple[float, float, float]

STEEL = Material(207e9, 0.3, 7850.0)
SEATS = {"drive": (0.01, 0.08, 0.105), "free": (-0.02, 0.08, -0.105)}
LIMIT = 2 * np.pi * 4000.0
RECIPROCAL = 1e-10  # of sqrt(|H_aa H_bb|)
SAME = 1e-9  # of a frequency, and of sqrt(|H_aa H_bb|)
# All rotations that take axes to axes.
CUBIC = [
    turn
    for order in permutations(range(3))
    for signs in product((1.0, -1.0), repeat=3)
    if np.linalg.det(turn := np.diag(signs)[list(order)]) > 0.0
]


@dataclass(frozen=True)
class Frame:
    """A rotation followed by a shift [m]."""

    turn: FloatArray
    shift: FloatArray

    def point(self, *place: float) -> Point:
        return _three(self.turn @ place + self.shift)

    def vector(self, *components: float) -> Point:
        return _three(self.turn @ components)

    def tensor(self, rows: FloatArray) -> tuple[Point, Point, Point]:
        turned = self.turn @ rows @ self.turn.T
        first, second, third = (_three(row) for row in 0.5 * (turned + turned.T))
        return first, second, third


HERE = Frame(np.eye(3), np.zeros(3))


def _three(values: FloatArray) -> Point:
    return float(values[0]), float(values[1]), float(values[2])


@dataclass(frozen=True, repr=False)
class Solved:
    """A housing with its modes and all its ports one after the other.

    Without its arrays in words, which a failing example would print by the thousand.
    """

    mesh: Mesh
    matrices: Matrices
    fixed: npt.NDArray[np.int64]
    ports: sparse.csr_array
    modes: ModeSet

    def receptance(self, frequencies: FloatArray) -> ComplexArray:
        """Between all ports, with the dashpots' own share of each mode's damping."""
        count = len(self.modes.frequencies)
        added = modal_damping(self.modes, self.matrices)[:count, :count]
        ratios = damping_ratios(self.modes.frequencies, np.full(count, 0.01), added)
        return receptance(self.modes, ratios, self.ports, self.ports, frequencies)


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    bores = (Bore("drive", (0.01, 0.08, 0.12), 0.06), Bore("free", (-0.02, 0.08, -0.12), 0.05))
    box = BoxGeometry((0.20, 0.16, 0.24), WallThickness.uniform(0.03), bores, Feet((0.04, 0.02, 0.05)))
    return mesh_box(box, 0.09)


@pytest.fixture(scope="module")
def solved(mesh: Mesh) -> Solved:
    return _solve(mesh, HERE, _fastened(HERE), [Support("pad", surface="foot-4", fixed=(True, True, True))])


def _fastened(frame: Frame) -> list[Fixture]:
    tilted = Rotation.from_euler("xyz", (0.3, -0.5, 1.1)).as_matrix()
    axes = tuple(frame.vector(*row) for row in tilted)
    springs = Bushing((1e8, 2e8, 3e8, 1e5, 2e5, 3e5), (2e3, 1e3, 4e3, 5.0, 3.0, 1.0), axes)
    inertia = np.array([[0.02, 0.003, 0.0], [0.003, 0.03, 0.002], [0.0, 0.002, 0.025]])
    return [
        Mount("mount", Patch("foot-1"), springs),
        Mount("other", Patch("foot-3"), springs, frame.point(0.02, -0.05, 0.1)),
        Joint("strut", Patch("foot-2"), Patch("left"), springs),
        LumpedMass("motor", 4.0, Patch("right"), inertia=frame.tensor(inertia), offset=frame.vector(0.06, 0.01, -0.02)),
        LumpedMass("sensor", 0.3, position=frame.point(0.013, 0.16, 0.031)),
        Support("base", surface="bottom", stiffness=(4e7,) * 3, damping=(300.0,) * 3),
    ]


def _solve(mesh: Mesh, frame: Frame, fastened: list[Fixture], supports: list[Support]) -> Solved:
    moved = replace(mesh, points=mesh.points @ frame.turn.T + frame.shift)
    matrices = attach_fixtures(assemble(moved, STEEL), moved, [*fastened, *supports])
    ports = [seat_matrix(moved, Seat(name, frame.point(*center))) for name, center in SEATS.items()]
    ports.append(sensor_port(moved, Sensor("normal", frame.point(0.03, 0.16, 0.05))).matrix)
    slanted = Sensor("slanted", frame.point(-0.10, 0.09, 0.02), frame.vector(1.0, -2.0, 0.5))
    ports.append(sensor_port(moved, slanted).matrix)
    whole = sparse.csr_array(sparse.vstack(ports, format="csr"))
    fixed = fixed_freedoms(moved, supports)
    return Solved(mesh, matrices, fixed, whole, solve_modes(matrices.held(fixed), frequency_limit=LIMIT, ports=whole))


def _asymmetry(values: ComplexArray) -> float:
    """Largest |H_ab - H_ba| / sqrt(|H_aa H_bb|) of matrices of shape (f, n, n)."""
    return float((np.abs(values - values.transpose(0, 2, 1)) / _size(values)).max())


def _size(values: ComplexArray) -> FloatArray:
    own = np.sqrt(np.abs(np.einsum("faa->fa", values)))
    return np.asarray(own[:, :, None] * own[:, None, :])


@settings(max_examples=30, deadline=None)
@given(frequency=st.floats(0.0, 8000.0), near=st.integers(0, 11))
def test_receptances_of_modes_and_attachments_are_reciprocal(solved: Solved, frequency: float, near: int) -> None:
    """At any frequency, and at a resonance."""
    assert solved.modes.residual_modes is not None
    assert solved.matrices.damping.nnz
    grid = np.array([2 * np.pi * frequency, solved.modes.frequencies[near % len(solved.modes.frequencies)]])
    values = solved.receptance(grid)
    assert values.shape == (2, 14, 14)
    assert _asymmetry(values) < RECIPROCAL


@pytest.mark.parametrize("part", [0.0, 0.05, 0.13, 0.4])
def test_receptances_of_all_degrees_of_freedom_are_reciprocal_and_those_of_the_modes(
    solved: Solved, part: float
) -> None:
    """K + iωC - ω²M itself, with every dashpot where it stands, against modes coupled by the dashpots."""
    w = part * LIMIT
    free = np.setdiff1d(np.arange(3 * solved.matrices.n_nodes), solved.fixed)
    matrices = solved.matrices
    dynamic = (matrices.stiffness + 1j * w * matrices.damping - w**2 * matrices.mass)[free][:, free]
    ports = solved.ports[:, free].toarray()
    direct = ports @ splu(sparse.csc_matrix(dynamic)).solve(ports.T.astype(np.complex128))
    assert _asymmetry(direct[None]) < RECIPROCAL
    modes = solved.modes
    assert modes.residual_modes is not None
    stiffness = np.concatenate([modes.frequencies, modes.residual_modes.frequencies]) ** 2
    motion = modes.project_all(solved.ports)
    coupled = np.diag(stiffness - w**2) + 1j * w * modal_damping(modes, matrices)
    modal = motion.T @ np.linalg.solve(coupled, motion)
    assert _asymmetry(modal[None]) < RECIPROCAL
    # Beyond rest the modes left out would move at the dashpots, which are no ports.
    allowed = 1e-9 if part == 0.0 else 0.02
    assert (np.abs(modal - direct) / _size(direct[None])[0]).max() < allowed


def _compare(here: Solved, there: Solved, turn: FloatArray) -> None:
    np.testing.assert_allclose(there.modes.frequencies, here.modes.frequencies, rtol=SAME)
    assert there.modes.certificate.expected == here.modes.certificate.expected
    grid = np.concatenate([np.linspace(0.0, 1.2 * LIMIT, 40), here.modes.frequencies])
    components = block_diag(turn, turn, turn, turn, 1.0, 1.0)
    expected = components @ here.receptance(grid) @ components.T
    assert (np.abs(there.receptance(grid) - expected) / _size(expected)).max() < SAME


@pytest.mark.slow
@settings(max_examples=5, deadline=None)
@given(angles=st.tuples(*[st.floats(-np.pi, np.pi)] * 3), shift=st.tuples(*[st.floats(-0.5, 0.5)] * 3))
@example(angles=(0.0, 1.0, -1.0), shift=(0.0, 0.0, 0.0))
@example(angles=(0.0, -1.0, 1.0), shift=(0.0, 0.0, 0.0))
def test_turning_and_moving_the_whole_case_changes_no_frequency_and_no_receptance(
    solved: Solved, angles: Point, shift: Point
) -> None:
    """Also where the search ends with modes as coarse as it leaves them, as in the two frames named."""
    frame = Frame(Rotation.from_euler("xyz", angles).as_matrix(), np.array(shift))
    pad = Support("pad", surface="foot-4", fixed=(True, True, True))
    _compare(solved, _solve(solved.mesh, frame, _fastened(frame), [pad]), frame.turn)


def test_supports_by_components_turn_with_the_case(mesh: Mesh) -> None:
    """Of each quarter turn, where global components remain global ones: x of the case may become -z."""

    def supports(turn: FloatArray) -> list[Support]:
        of = np.abs(turn)
        held = of @ [0.0, 1.0, 1.0] > 0.5
        return [
            Support("slide", surface="foot-4", fixed=(bool(held[0]), bool(held[1]), bool(held[2]))),
            Support(
                "rail", surface="foot-2", stiffness=_three(of @ [2e8, 5e6, 0.0]), damping=_three(of @ [0, 4e2, 9e2])
            ),
        ]

    here = _solve(mesh, HERE, _fastened(HERE), supports(np.eye(3)))
    for turn in np.random.default_rng(3).permutation(np.array(CUBIC))[:5]:
        frame = Frame(turn, np.array([0.2, -0.1, 0.4]))
        _compare(here, _solve(mesh, frame, _fastened(frame), supports(turn)), turn)
