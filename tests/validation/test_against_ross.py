"""Side by side with ROSS 2.3 (Rotordynamic Open Source Software), on rotors that it loads from our files.

ROSS solves finite elements after Genta (1988) and Friswell et al. (2010): cubic shape functions of the static
Timoshenko beam, a consistent mass. Within an element the shear strain is constant and no inertia bends the shape, so
that an eigenvalue carries an error of h² a + h⁴ b + … in the element's length h; a cone's begins to fall so once its
elements are shorter than a third of their diameter. Each rotor is solved by ROSS on three meshes, each of half the
elements' length of the one before. Against ours, which has no mesh,

- the difference falls at least with h² (by more than 3.3 for each halving),
- on the finest mesh it is less than ROSS's own last change, which for h² is three times its error,
- the three values extrapolated to h = 0, (64 λ₃ − 20 λ₂ + λ₁)/45 without a and b, come at least four times nearer.

Shear coefficients are Cowper's in both. The matrices are those that ``run_modal`` takes to its eigensolver; its results
object compiles for half a minute before it shows the first of them.
"""

import contextlib
import functools
import io
import sys
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy import linalg

from gearwhine.rotors import (
    AxisSpring,
    Bearing,
    Coupling,
    Disc,
    Pedestal,
    Rotor,
    Segment,
    ShaftMaterial,
    Unbalance,
    critical_speeds,
    read_ross,
    rest_frequencies,
    solve_axial_modes,
    solve_torsional_modes,
    solve_whirl,
    unbalance_response,
    write_ross,
)

pytestmark = pytest.mark.slow

Published = Callable[..., None]
Array = npt.NDArray[Any]
Meshes = Callable[[str], tuple[Any, Any, Any]]

SOURCE = "ROSS 2.3.0, run side by side and extrapolated to no mesh"
STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
COUNT = 6
# Part of an eigenvalue that the dense eigensolver of a finely meshed state matrix leaves uncertain.
ROUNDING = 2e-9
LATERAL = (0, 1, 3, 4)
AXIAL = (2,)
TORSIONAL = (5,)


@dataclass(frozen=True)
class Case:
    """A rotor on its bearings, its speed, and the length of ROSS's longest elements on the first mesh."""

    segments: Sequence[Segment | Coupling]
    discs: Sequence[Disc]
    bearings: Sequence[Bearing]
    element: float
    speed: float = 0.0

    @property
    def rotor(self) -> Rotor:
        return Rotor("rotor", self.segments, self.discs)


def tube(length: float, outer: float, inner: float = 0.0, **more: Any) -> Segment:
    return Segment(length, outer, inner, STEEL, **more)


def held(at: float, stiffness: npt.ArrayLike, damping: npt.ArrayLike = 0.0, **more: Any) -> Bearing:
    """Of numbers for every direction, of pairs for x and y, or of whole matrices."""
    matrices = []
    for given in (np.asarray(stiffness, dtype=float), np.asarray(damping, dtype=float)):
        matrices.append(given if given.ndim == 2 else np.diag(np.broadcast_to(given, 2)))
    return Bearing(f"bearing at {at:g} m", at, *matrices, **more)


FRISWELL = [tube(0.5, 0.05)] * 3
FRISWELL_DISCS = [
    Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, 7810.0),
    Disc.from_dimensions(1.0, 0.07, 0.35, 0.05, 7810.0),
]
RPM_4000 = 4000 * 2 * np.pi / 60
# So short that it does not matter that ROSS's spring has no length.
COUPLING = Coupling(1e-7, 5e7, 2e4, 1e5, 8e7, mass=3.0, polar_inertia=0.004, diametral_inertia=0.003)
TABLE = np.array([[[4e5, 1e5], [-1e5, 5e5]], [[8e5, 1e5], [-2e5, 9e5]], [[1e6, 2e5], [-2e5, 1.2e6]]])

CASES = {
    "uniform, at rest": Case([tube(1.2, 0.05)], [], [held(0.0, 1e7), held(1.2, 1e7)], 0.2),
    "stepped, at rest": Case(
        [tube(0.3, 0.04), tube(0.6, 0.08), tube(0.3, 0.05)],
        [Disc(0.6, 20.0, 0.2, 0.12)],
        [held(0.15, 5e7), held(1.05, 4e7)],
        0.15,
    ),
    "bored": Case(
        [tube(0.6, 0.1, 0.07), tube(0.6, 0.1, 0.02)],
        [Disc(0.6, 15.0, 0.15, 0.1)],
        [held(0.0, 1e8), held(1.2, 1e8)],
        0.2,
        800.0,
    ),
    "overhung": Case(
        [tube(0.8, 0.05), tube(0.2, 0.04)], [Disc(1.0, 25.0, 0.6, 0.32)], [held(0.2, 5e7), held(0.8, 5e7)], 0.2, 700.0
    ),
    "gyroscopic, two discs": Case(FRISWELL, FRISWELL_DISCS, [held(0.0, 1e6), held(1.5, 1e6)], 0.25, RPM_4000),
    "orthotropic bearings": Case(
        FRISWELL, FRISWELL_DISCS, [held(0.0, (1e6, 8e5)), held(1.5, (1e6, 8e5))], 0.25, RPM_4000
    ),
    "damped": Case(
        FRISWELL,
        FRISWELL_DISCS,
        [held(0.0, (1e6, 8e5), (800.0, 500.0)), held(1.5, (1e6, 8e5), (300.0, 900.0))],
        0.25,
        RPM_4000,
    ),
    "cross-coupled": Case(
        FRISWELL,
        FRISWELL_DISCS,
        [
            held(0.0, [[1e6, 2e5], [-2e5, 1e6]], 600.0),
            held(1.5, [[1e6, 1e5], [-3e5, 8e5]], [[500.0, 100.0], [50.0, 400.0]]),
        ],
        0.25,
        RPM_4000,
    ),
    "heavy disc, point mass": Case(
        [tube(0.6, 0.03)], [Disc(0.2, 40.0, 1.2, 0.65), Disc(0.5, 3.0)], [held(0.0, 1e8), held(0.6, 1e8)], 0.1, 200.0
    ),
    "tapered, at rest": Case(
        [tube(0.12, 0.12, 0.04, right_outer_diameter=0.08, right_inner_diameter=0.02), tube(0.12, 0.08, 0.02)],
        [Disc(0.24, 5.0, 0.04, 0.025)],
        [held(0.0, 1e9), held(0.18, 5e8)],
        0.02,
    ),
    "tapered": Case(
        [tube(0.12, 0.06, right_outer_diameter=0.12), tube(0.12, 0.12, right_outer_diameter=0.09)],
        [Disc(0.24, 20.0, 0.5, 0.3)],
        [held(0.0, 1e9), held(0.12, 5e8)],
        0.02,
        2000.0,
    ),
    "under tension": Case([tube(1.2, 0.03, axial_force=8e4)], [Disc(0.4, 4.0)], [held(0.0, 1e8), held(1.2, 1e8)], 0.2),
    "under thrust": Case(
        [tube(0.8, 0.03), tube(0.4, 0.03, axial_force=-3e4)],
        [Disc(0.6, 8.0, 0.1, 0.06)],
        [held(0.0, 1e8), held(1.2, 1e8)],
        0.2,
        300.0,
    ),
    "two shafts coupled": Case(
        [tube(0.6, 0.05), COUPLING, tube(0.6, 0.04)],
        [Disc(0.3, 12.0, 0.15, 0.09)],
        [held(at, 1e8) for at in (0.0, 0.5, 0.7 + COUPLING.length, 1.2 + COUPLING.length)],
        0.1,
        500.0,
    ),
    "on pedestals": Case(
        FRISWELL,
        FRISWELL_DISCS,
        [
            held(0.0, (2e6, 1.5e6), 300.0, pedestal=Pedestal(np.diag([4e6, 8e6]), np.diag([200.0, 400.0]), 10.0)),
            held(1.5, (1e6, 2e6), 200.0, pedestal=Pedestal([[5e6, 1e6], [1e6, 6e6]], np.zeros((2, 2)), 25.0)),
        ],
        0.25,
        RPM_4000,
    ),
    "thrust bearing": Case(
        [tube(0.6, 0.06, 0.02), tube(0.6, 0.05)],
        [Disc(0.6, 15.0, 0.15, 0.1)],
        [
            Bearing("thrust", 0.0, np.diag([1e8, 1e8, 3e8, 0.0, 0.0]), np.zeros((2, 2))),
            held(1.2, 1e8),
        ],
        0.2,
        400.0,
    ),
    "bearing table over speed": Case(
        FRISWELL,
        FRISWELL_DISCS,
        [
            Bearing("left", 0.0, TABLE, np.stack([900.0 * np.eye(2)] * 3), speeds=np.array([0.0, 300.0, 600.0])),
            held(1.5, 1e6, 300.0),
        ],
        0.25,
        300.0,
    ),
}


@pytest.fixture(scope="module")
def ross() -> Any:
    """ROSS itself, which says much as it is imported, without properties of gases, which take longest to load."""
    with (
        warnings.catch_warnings(),
        contextlib.redirect_stdout(io.StringIO()),
        pytest.MonkeyPatch.context() as patch,
    ):
        warnings.simplefilter("ignore")
        patch.setitem(sys.modules, "ccp", ModuleType("ccp"))
        return pytest.importorskip("ross", reason="ROSS is not installed; make install-dev installs it")


@dataclass(frozen=True)
class Matrices:
    """Those of ROSS at one speed, of some of its six degrees of freedom at each node."""

    mass: Array
    damping: Array
    stiffness: Array

    @property
    def eigenvalues(self) -> Array:
        """Oscillating ones by size, of positive imaginary part."""
        n = len(self.mass)
        below = linalg.solve(self.mass, np.hstack([-self.stiffness, -self.damping]), assume_a="pos")
        values = linalg.eigvals(np.vstack([np.eye(n, 2 * n, n), below]))
        kept = values[values.imag > 1.0]
        return kept[np.argsort(np.abs(kept))]


def loaded(ross: Any, file: Path) -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return ross.Rotor.load(file)


def matrices(model: Any, speed: float, components: Sequence[int]) -> Matrices:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        mass, stiffness = model.M(speed), model.K(speed)
        damping = model.C(speed) + model.G() * speed
    # Nodes of the shaft have six degrees of freedom, those of supports, which come last, three.
    on_shaft = 6 * len(model.nodes)
    chosen = [n for n in range(len(mass)) if (n % 6 if n < on_shaft else (n - on_shaft) % 3) in components]
    return Matrices(*(matrix[np.ix_(chosen, chosen)] for matrix in (mass, damping, stiffness)))


@pytest.fixture(scope="module")
def meshes(ross: Any, tmp_path_factory: pytest.TempPathFactory) -> Meshes:
    """Of a case the three models that ROSS loads: first mesh, elements of half, and of a quarter of the length."""
    folder = tmp_path_factory.mktemp("meshes")

    @functools.cache
    def of(name: str) -> tuple[Any, Any, Any]:
        case, models = CASES[name], []
        for parts in (1, 2, 4):
            file = folder / f"{parts}.toml"
            remarks = write_ross(file, case.rotor, case.bearings, element_length=case.element / parts)
            assert all("spring of a coupling has no length" in remark for remark in remarks)
            models.append(loaded(ross, file))
        return models[0], models[1], models[2]

    return of


def assert_approached(found: Callable[[Any], Array], models: tuple[Any, Any, Any], ours: Array) -> Array:
    """Hold what is found in ROSS's three models to fall towards ours, and return it extrapolated."""
    coarse, middle, fine = (found(model)[: ours.size] for model in models)
    size = np.abs(ours)
    errors = [np.abs(values - ours) / size for values in (coarse, middle, fine)]
    for before, after in ((0, 1), (1, 2)):
        np.testing.assert_array_less(errors[after], errors[before] / 3.3 + ROUNDING)
    np.testing.assert_array_less(errors[2], np.abs(fine - middle) / size + ROUNDING)
    extrapolated: Array = (64.0 * fine - 20.0 * middle + coarse) / 45.0
    np.testing.assert_array_less(np.abs(extrapolated - ours) / size, 0.25 * errors[2] + ROUNDING)
    # The comparison is one of discretisation, not of rounding, where the mesh tells at all.
    assert errors[0].max() > 1e3 * ROUNDING
    return extrapolated


@pytest.mark.parametrize("name", CASES)
def test_whirl_is_what_ross_approaches(name: str, meshes: Meshes, published: Published) -> None:
    case = CASES[name]
    bearings = [bearing.at_speed(case.speed) for bearing in case.bearings]
    ours = solve_whirl(case.rotor, bearings, case.speed, count=COUNT).eigenvalues

    def found(model: Any) -> Array:
        return matrices(model, case.speed, LATERAL).eigenvalues

    extrapolated = assert_approached(found, meshes(name), ours)
    for number, (theirs, value) in enumerate(zip(extrapolated, ours, strict=True), 1):
        if number % 2:
            published(SOURCE, f"{name}: {number}", abs(theirs), abs(value), "rad/s", rel=5e-6)


@pytest.mark.parametrize("name", [name for name in CASES if "at rest" in name])
def test_at_rest_ross_is_too_stiff(name: str, meshes: Meshes) -> None:
    # Its shapes are admissible and its mass consistent: Rayleigh's quotient is an upper bound.
    case = CASES[name]
    ours = rest_frequencies(case.rotor, case.bearings, count=COUNT).frequencies
    for model in meshes(name):
        theirs = np.abs(matrices(model, 0.0, LATERAL).eigenvalues[:COUNT])
        np.testing.assert_array_less(ours * (1.0 - ROUNDING), theirs)


@pytest.mark.parametrize("name", ["stepped, at rest", "bored", "tapered", "two shafts coupled"])
def test_torsion_is_what_ross_approaches(name: str, meshes: Meshes) -> None:
    ours = solve_torsional_modes(CASES[name].rotor, count=4).frequencies[1:]
    assert_approached(lambda model: matrices(model, 0.0, TORSIONAL).eigenvalues.imag, meshes(name), ours)


@pytest.mark.parametrize("name", ["stepped, at rest", "tapered", "two shafts coupled", "thrust bearing"])
def test_axial_motion_is_what_ross_approaches(name: str, meshes: Meshes) -> None:
    case = CASES[name]
    springs = [AxisSpring(bearing.at, bearing.spatial_stiffness[2, 2]) for bearing in case.bearings]
    free = int(all(spring.stiffness == 0.0 for spring in springs))
    ours = solve_axial_modes(case.rotor, [spring for spring in springs if spring.stiffness], count=3 + free)
    assert_approached(lambda model: matrices(model, 0.0, AXIAL).eigenvalues.imag, meshes(name), ours.frequencies[free:])


@pytest.mark.parametrize("name", ["overhung", "orthotropic bearings"])
def test_critical_speeds_are_what_ross_approaches(name: str, meshes: Meshes) -> None:
    case = CASES[name]

    def found(model: Any) -> Array:
        # At Ω = ω the gyroscopic term joins the mass: K q = ω² (M − i G) q, with G from a unit speed.
        at_rest, turning = (matrices(model, speed, LATERAL) for speed in (0.0, 1.0))
        mass = at_rest.mass - 1j * (turning.damping - at_rest.damping)
        squared = linalg.eigvals(at_rest.stiffness, mass).real
        return np.sort(np.sqrt(squared[squared > 1.0]))

    assert_approached(found, meshes(name), critical_speeds(case.rotor, case.bearings, count=4).speeds)


UNBALANCE = Unbalance(0.5, 2e-4, 0.7)


@pytest.mark.parametrize("name", ["damped", "cross-coupled", "on pedestals"])
def test_unbalance_moves_the_discs_as_ross_approaches(name: str, meshes: Meshes) -> None:
    case, places, speeds = CASES[name], [0.5, 1.0], [60.0, 240.0, 500.0]
    ours = unbalance_response(case.rotor, case.bearings, [UNBALANCE], speeds).evaluate(places)

    def found(model: Any) -> Array:
        nodes = [int(np.argmin(np.abs(np.array(model.nodes_pos) - place))) for place in places]
        amplitudes = []
        for speed in speeds:
            of_ross = matrices(model, speed, LATERAL)
            force = np.zeros(len(of_ross.mass), dtype=complex)
            # Turning from x to y it is real in x and a quarter turn later in y.
            force[4 * nodes[0] : 4 * nodes[0] + 2] = UNBALANCE.vector * speed**2 * np.array([1.0, -1j])
            dynamic = of_ross.stiffness + 1j * speed * of_ross.damping - speed**2 * of_ross.mass
            amplitudes.append(linalg.solve(dynamic, force))
        rows = np.array(amplitudes)
        return np.stack([rows[:, [4 * node + plane for node in nodes]] for plane in (0, 1)]).ravel()

    assert_approached(found, meshes(name), np.stack(ours).ravel())


def test_a_rotor_that_ross_saved_has_the_frequencies_that_ross_finds(ross: Any, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        steel = ross.Material("Steel", rho=7810.0, E=211e9, G_s=81.2e9)
        shaft = [ross.ShaftElement(0.05, 0.0, 0.05, material=steel) for _ in range(24)]
        model = ross.Rotor(
            shaft,
            [ross.DiskElement.from_geometry(n, steel, 0.07, 0.05, 0.28) for n in (8, 16)],
            [
                ross.BearingElement(0, kxx=1e6, kyy=8e5, kxy=1e5, kyx=-1e5, cxx=200.0, cyy=100.0, tag="left"),
                ross.SealElement(12, kxx=2e4, cxx=30.0, tag="seal"),
                ross.BearingElement(24, kxx=1e6, cxx=300.0, tag="right"),
            ],
        )
        model.save(tmp_path / "saved.toml")
        model.save(tmp_path / "saved.json")
    rotor, bearings, remarks = read_ross(tmp_path / "saved.toml")
    assert remarks == ()
    assert [bearing.name for bearing in bearings] == ["left", "seal", "right"]
    assert rotor.mass == pytest.approx(model.m, rel=1e-12)
    assert rotor.centre_of_mass == pytest.approx(model.CG, rel=1e-12)
    assert rotor.polar_inertia == pytest.approx(model.Ip, rel=1e-12)
    ours = solve_whirl(rotor, bearings, 300.0, count=COUNT).eigenvalues
    # 24 elements: the third pair of this rotor is within 2e-5, by the convergence that the other tests show.
    np.testing.assert_allclose(matrices(model, 300.0, LATERAL).eigenvalues[:COUNT], ours, rtol=2e-5)
    as_json = read_ross(tmp_path / "saved.json")
    assert as_json.rotor == rotor
    assert as_json.bearings == bearings


def test_what_is_written_ross_writes_back_alike(ross: Any, tmp_path: Path) -> None:
    case = CASES["bearing table over speed"]
    write_ross(tmp_path / "ours.toml", case.rotor, case.bearings)
    loaded(ross, tmp_path / "ours.toml").save(tmp_path / "theirs.toml")
    ours, theirs = read_ross(tmp_path / "ours.toml"), read_ross(tmp_path / "theirs.toml")
    assert theirs.rotor.segments == ours.rotor.segments
    assert theirs.rotor.discs == ours.rotor.discs
    assert theirs.bearings == ours.bearings
    assert theirs.warnings == ()


def test_sleeves_bend_with_their_shaft_as_ross_approaches(ross: Any, tmp_path: Path) -> None:
    """Elements between the same nodes, of one material and of two, on ever finer meshes; a seal that pushes away.

    Shaft and sleeve shear by shape functions of their own in an element, so that its error begins to fall with h² once
    the element is shorter than their diameters.
    """

    def model(per_part: int) -> Any:
        steel = ross.Material("Steel", rho=7810.0, E=211e9, G_s=81.2e9)
        bronze = ross.Material("Bronze", rho=8800.0, E=110e9, G_s=41e9)
        shaft, node = [], 0
        for length, layers in (
            (0.3, [(0.0, 0.05, steel)]),
            (0.4, [(0.0, 0.05, steel), (0.05, 0.08, steel)]),
            (0.3, [(0.0, 0.05, steel), (0.05, 0.07, bronze)]),
        ):
            for _ in range(per_part):
                for inner, outer, material in layers:
                    shaft.append(
                        ross.ShaftElement(
                            length / per_part, inner, outer, material=material, n=node, tag=f"{len(shaft)}"
                        )
                    )
                node += 1
        supports = [
            ross.BearingElement(0, kxx=2e7, cxx=200.0, tag="left"),
            ross.SealElement(per_part, kxx=-1e5, cxx=300.0, tag="seal"),
            ross.BearingElement(node, kxx=2e7, cxx=200.0, tag="right"),
        ]
        disk = ross.DiskElement.from_geometry(2 * per_part, steel, 0.07, 0.05, 0.28)
        return ross.Rotor(shaft, [disk], supports)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = [model(count) for count in (8, 16, 32)]
        found[0].save(tmp_path / "sleeves.toml")
    rotor, bearings, remarks = read_ross(tmp_path / "sleeves.toml")
    assert rotor.mass == pytest.approx(found[0].m, rel=1e-12)
    assert rotor.polar_inertia == pytest.approx(found[0].Ip, rel=1e-12)
    ours = solve_whirl(rotor, bearings, 300.0, count=COUNT).eigenvalues
    theirs = [matrices(one, 300.0, LATERAL).eigenvalues[:COUNT] for one in found]
    away = [np.abs(one / ours - 1.0).max() for one in theirs]
    assert away[0] > 3.3 * away[1] > 3.3**2 * away[2]
    assert np.abs((64.0 * theirs[2] - 20.0 * theirs[1] + theirs[0]) / (45.0 * ours) - 1.0).max() < 0.25 * away[2]
    assert len(remarks) == 2
