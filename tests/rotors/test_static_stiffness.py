"""Static shaft between stations, against closed forms, an independent beam, the static deflection and quadrature."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.integrate import quad

from gearwhine.numerics.arrays import FloatArray, IndexArray
from gearwhine.rotors import (
    Bearing,
    Coupling,
    Disc,
    RadialSupport,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    solve_lateral_modes,
    static_deflection,
)
from gearwhine.rotors.analyses.static_stiffness import StaticShaft, static_shaft
from gearwhine.rotors.analyses.statics import StaticForce

STEEL = ShaftMaterial(2.1e11, 8.0e10, 7850.0)
BRASS = ShaftMaterial(1.0e11, 3.7e10, 8500.0)
GRAVITY = (3.0, -9.81, 1.5)
UNIFORM = Segment(0.4, 0.03, 0.01, STEEL, 0.85)
STEPS = [UNIFORM, Segment(0.12, 0.05, 0.0, BRASS, 0.9), Segment(0.2, 0.04, 0.02, STEEL, 0.8)]
MASSES = {0.0: 1.5, 0.25: 4.0, 0.52: 2.0, 0.72: 0.7}
CONE = Segment(0.15, 0.03, 0.0, STEEL, "cowper", right_outer_diameter=0.06, right_inner_diameter=0.02)
JAW = Coupling(0.05, 2e7, 4e4, 9e3, 5e7, mass=1.2, polar_inertia=1e-3, diametral_inertia=8e-4)


def solve(stiffness: FloatArray, loads: FloatArray, held: Sequence[int] | IndexArray = ()) -> FloatArray:
    """Displacements under loads (..., k), some held; scaled, because forces and moments have units of their own."""
    free = np.setdiff1d(np.arange(stiffness.shape[0]), held)
    scale = 1.0 / np.sqrt(np.diag(stiffness)[free])
    inner = scale[:, None] * stiffness[np.ix_(free, free)] * scale
    displacement = np.zeros(loads.shape)
    displacement[..., free] = scale * np.linalg.solve(inner, (scale * loads[..., free]).T).T
    return displacement


def assert_alike(found: FloatArray, expected: FloatArray, tolerance: float) -> None:
    """Stiffnesses or loads of nodes agree, with a decimetre between forces and moments, to a part of the largest."""
    unit = np.tile([1.0, 1.0, 1.0, 0.1, 0.1, 0.1], found.shape[0] // 6)
    scale = np.outer(unit, unit) if found.ndim == 2 else unit
    assert np.abs((found - expected) / scale).max() <= tolerance * np.abs(expected / scale).max()


def own_element(part: Segment, length: float) -> FloatArray:
    """Stiffness (12, 12) of a uniform Timoshenko element (Przemieniecki 1968, chapter 5) over both ends."""
    outer, inner = part.outer_diameter, part.inner_diameter
    area, second = math.pi / 4 * (outer**2 - inner**2), math.pi / 64 * (outer**4 - inner**4)
    E, G = part.material.youngs_modulus, part.material.shear_modulus
    assert isinstance(part.shear_coefficient, float)
    shear = 12 * E * second / (part.shear_coefficient * G * area * length**2)
    matrix = np.zeros((12, 12))
    for index, stiffness in ((2, E * area), (5, 2 * G * second)):
        matrix[np.ix_([index, index + 6], [index, index + 6])] = stiffness / length * np.array([[1, -1], [-1, 1]])
    near, far = (4 + shear) * length**2, (2 - shear) * length**2
    arm = 6 * length
    bent = np.array([[12, arm, -12, arm], [arm, near, -arm, far], [-12, -arm, 12, -arm], [arm, far, -arm, near]])
    for displacements, sign in (([0, 4, 6, 10], 1.0), ([1, 3, 7, 9], -1.0)):
        turn = np.array([1.0, sign, 1.0, sign])
        matrix[np.ix_(displacements, displacements)] += (
            E * second / (1 + shear) / length**3 * bent * np.outer(turn, turn)
        )
    return matrix


def own_weight(part: Segment, length: float) -> FloatArray:
    """Loads (2, 6, 3) of an element's weight per acceleration over x, y, z, on clamped ends: q h / 2 and q h² / 12."""
    mass = part.material.density * math.pi / 4 * (part.outer_diameter**2 - part.inner_diameter**2) * length
    weight = np.zeros((2, 6, 3))
    weight[:, [0, 1, 2], [0, 1, 2]] = mass / 2
    # Moments turn the slope, which is the rotation about y in the plane of x, and minus that about x in that of y.
    weight[:, 4, 0] = mass * length / 12 * np.array([1.0, -1.0])
    weight[:, 3, 1] = -weight[:, 4, 0]
    return weight


@dataclass(frozen=True)
class OwnShaft:
    """A finite-element shaft: the part of each element, places, stiffness, and weight under `GRAVITY`, (6n,)."""

    parts: Sequence[Segment]
    places: FloatArray
    stiffness: FloatArray
    weight: FloatArray

    @classmethod
    def of(cls, parts: Sequence[Segment], cuts: Sequence[float], masses: Mapping[float, float]) -> "OwnShaft":
        joints = np.cumsum([0.0, *(part.length for part in parts)])
        places = np.unique(np.round(np.concatenate([joints, cuts, list(masses)]), 12))
        stiffness, weight = np.zeros((6 * places.size, 6 * places.size)), np.zeros((places.size, 6, 3))
        own = [parts[index] for index in np.searchsorted(joints, 0.5 * (places[1:] + places[:-1])) - 1]
        for k, (part, length) in enumerate(zip(own, np.diff(places).tolist(), strict=True)):
            stiffness[6 * k : 6 * k + 12, 6 * k : 6 * k + 12] += own_element(part, length)
            weight[k : k + 2] += own_weight(part, length)
        for at, mass in masses.items():
            weight[int(np.abs(places - at).argmin()), [0, 1, 2], [0, 1, 2]] += mass
        return cls(own, places, stiffness, (weight @ GRAVITY).ravel())

    def numbers(self, stations: FloatArray) -> IndexArray:
        """Indices of the displacements of some places."""
        nodes = np.abs(self.places - stations[:, None]).argmin(axis=1)
        return (6 * nodes[:, None] + np.arange(6)).ravel()

    def condensed(self, kept: IndexArray) -> tuple[FloatArray, FloatArray]:
        """Stiffness and weight left on some displacements when all others are free."""
        loads = np.column_stack([self.stiffness[:, kept], self.weight])
        moved = solve(self.stiffness, loads.T, kept).T
        left = (loads - self.stiffness @ moved)[kept]
        return left[:, :-1], left[:, -1]


def test_a_cantilever_bends_twists_and_stretches_as_in_closed_form() -> None:
    shaft = static_shaft(Rotor("shaft", [UNIFORM]), [0.4, 0.0])
    section, L = UNIFORM.section(0.0), 0.4
    loads = np.concatenate([np.zeros(6), [2.0, -3.0, 5.0, 0.7, -0.4, 0.9]])
    tip = solve(shaft.stiffness, loads, range(6))[6:]
    EI, S = section.bending_stiffness, section.shear_stiffness
    # Force and moment in the plane of x act with the rotation about y; in that of y, with minus that about x.
    for shift, turn, force, moment in ((tip[0], tip[4], 2.0, -0.4), (tip[1], -tip[3], -3.0, -0.7)):
        assert shift == pytest.approx(force * (L**3 / (3 * EI) + L / S) + moment * L**2 / (2 * EI), rel=1e-12)
        assert turn == pytest.approx(force * L**2 / (2 * EI) + moment * L / EI, rel=1e-12)
    assert tip[2] == pytest.approx(5.0 * L / section.axial_stiffness, rel=1e-12)
    assert tip[5] == pytest.approx(0.9 * L / section.torsional_stiffness, rel=1e-12)
    # Everywhere the part to the right puts the tip's loads on the part to the left, the moments with their arms.
    forces = shaft.internal_forces(np.concatenate([np.zeros(6), tip]), [0.1])[:, 0]
    expected = [2.0, -3.0, 5.0, 0.7 - 0.3 * -3.0, -0.4 + 0.3 * 2.0, 0.9]
    np.testing.assert_allclose(forces, expected, rtol=1e-10)


def test_a_simply_supported_beam_sags_by_bending_and_shear_under_its_weight() -> None:
    shaft, gravity, L = static_shaft(Rotor("shaft", [UNIFORM]), [0.0, 0.4]), (0.0, -9.81, 0.0), 0.4
    displacement = solve(shaft.stiffness, shaft.weight(gravity), [0, 1, 2, 5, 6, 7])
    section = UNIFORM.section(0.0)
    q = section.mass_per_length * 9.81
    sag = 5 * q * L**4 / (384 * section.bending_stiffness) + q * L**2 / (8 * section.shear_stiffness)
    middle = shaft.motions(displacement, [0.2], gravity)[:, 0]
    np.testing.assert_allclose(middle, [0.0, -sag, 0.0, 0.0, 0.0, 0.0], atol=1e-12 * sag)
    # The part to the right of the middle lifts no shear; EI β' in the plane of y is minus the moment about x.
    forces = shaft.internal_forces(displacement, [0.0, 0.2, 0.4], gravity)
    np.testing.assert_allclose(forces[1] / (q * L), [-0.5, 0.0, 0.5], atol=1e-12)
    np.testing.assert_allclose(-forces[3] / (q * L**2 / 8), [0.0, 1.0, 0.0], atol=1e-11)


def test_the_weight_of_overhangs_acts_at_their_station_as_force_and_moment() -> None:
    shaft = static_shaft(Rotor("shaft", [UNIFORM], [Disc(0.05, 2.0), Disc(0.4, 3.0)]), [0.1])
    assert not shaft.stiffness.any()
    section, length = UNIFORM.section(0.0), 0.3
    line = section.mass_per_length
    mass, moment = 0.4 * line + 5.0, 0.4 * line * 0.1 + 2.0 * -0.05 + 3.0 * 0.3
    expected = np.array([*(mass * np.array(GRAVITY)), -moment * GRAVITY[1], moment * GRAVITY[0], 0.0])
    np.testing.assert_allclose(shaft.weight(GRAVITY), expected, rtol=1e-13)
    # The right overhang bends and stretches under itself and the disc at its tip; the left one likewise.
    EI, S = section.bending_stiffness, section.shear_stiffness
    tips = shaft.motions(np.zeros(6), [0.0, 0.4], GRAVITY)
    right = line * (length**4 / (8 * EI) + length**2 / (2 * S)) + 3.0 * (length**3 / (3 * EI) + length / S)
    left = line * (0.1**4 / (8 * EI) + 0.1**2 / (2 * S))
    left += 2.0 * (0.05**3 / (3 * EI) + 0.05**2 / (2 * EI) * 0.05 + 0.05 / S)
    np.testing.assert_allclose(tips[:2], np.outer(GRAVITY[:2], [left, right]), rtol=1e-12)
    stretch = (line * length**2 / 2 + 3.0 * length) / section.axial_stiffness
    assert tips[2, 1] == pytest.approx(stretch * GRAVITY[2], rel=1e-12)


@pytest.mark.parametrize("stations", [[0.0, 0.72], [0.1, 0.25, 0.3, 0.52, 0.7], [0.6, 0.05], [0.3], [0.0, 0.4, 0.72]])
def test_a_stepped_shaft_agrees_with_an_own_finite_element_shaft(stations: list[float]) -> None:
    shaft = static_shaft(Rotor("shaft", STEPS, [Disc(at, mass, 0.1, 0.05) for at, mass in MASSES.items()]), stations)
    own = OwnShaft.of(STEPS, stations, MASSES)
    kept = own.numbers(shaft.places)
    stiffness, weight = own.condensed(kept)
    if len(stations) > 1:
        assert_alike(shaft.stiffness, stiffness, 1e-10)
    assert_alike(shaft.weight(GRAVITY), weight, 1e-10)
    # The field between them, under displacements that balance nothing in particular.
    moved = np.zeros(own.weight.size)
    moved[kept] = np.random.default_rng(3).normal(size=kept.size) * 1e-5
    moved += solve(own.stiffness, own.weight - own.stiffness @ moved, kept)
    found = shaft.motions(moved[kept], own.places, GRAVITY)
    np.testing.assert_allclose(found.T, moved.reshape(-1, 6), atol=1e-9 * np.abs(moved).max())
    forces = shaft.internal_forces(moved[kept], own.places[:-1], GRAVITY)
    for k, (part, length) in enumerate(zip(own.parts, np.diff(own.places).tolist(), strict=True)):
        ends = own_element(part, length) @ moved[6 * k : 6 * k + 12] - (own_weight(part, length) @ GRAVITY).ravel()
        assert_alike(forces[:, k], -ends[:6], 1e-7)


def test_shape_functions_superpose() -> None:
    shaft = static_shaft(Rotor("shaft", STEPS), [0.1, 0.3, 0.5])
    moved, z = np.linspace(-1.0, 1.0, 18) ** 3, np.linspace(0.0, 0.72, 7)
    shapes = shaft.motions(np.eye(18), z)
    assert shapes.shape == (18, 6, 7)
    np.testing.assert_allclose(np.tensordot(moved, shapes, 1), shaft.motions(moved, z), atol=1e-12)
    np.testing.assert_allclose(shaft.motions(moved, shaft.places).T.ravel(), moved, atol=1e-13)


def test_spans_of_a_micrometre_keep_their_digits() -> None:
    cone = Segment(0.3, 0.04, 0.0, STEEL, 0.9, right_outer_diameter=0.06)
    stations = [0.0, 0.2, 0.2 + 1e-6, 0.5, 0.5 + 1e-6, 0.7, 0.7 - 1e-11, 0.2 - 1e-11]
    shaft = static_shaft(Rotor("shaft", [UNIFORM, cone]), stations)
    assert shaft.places.size == 6
    for node, part, tolerance in ((1, UNIFORM, 1e-11), (3, replace(UNIFORM, outer_diameter=0.04 + 0.2 / 30), 2e-4)):
        part = replace(part, inner_diameter=0.0, shear_coefficient=0.9) if node == 3 else part
        expected = own_element(part, float(shaft.places[node + 1] - shaft.places[node]))[6:, :6]
        found = shaft.stiffness[6 * node + 6 : 6 * node + 12, 6 * node : 6 * node + 6]
        np.testing.assert_allclose(found[expected != 0.0], expected[expected != 0.0], rtol=tolerance)


@pytest.mark.parametrize("mass_model", ["distributed", "lumped"])
@pytest.mark.parametrize("force", [0.0, 4e5, -2e4])
def test_on_bearings_it_deflects_like_the_static_deflection(mass_model: str, force: float) -> None:
    cone, *pulled = [replace(part, axial_force=force) for part in (CONE, *STEPS)]
    jaw = replace(JAW, axial_force=force)
    parts = [cone, pulled[0], jaw, pulled[1], pulled[2], cone, pulled[0]]
    rotor = Rotor("shaft", parts, [Disc(0.1, 3.0), Disc(0.4, 5.0, 0.1, 0.06)], mass_model)  # type: ignore[arg-type]
    matrix = np.diag([3e8, 2e8, 5e7, 2e4, 3e4])
    matrix[0, 1] = matrix[1, 0] = 4e7
    matrix[0, 4] = matrix[4, 0] = 1e6
    bearings = [Bearing(name, at, matrix, np.zeros((5, 5))) for name, at in (("left", 0.08), ("right", 0.9))]
    load = StaticForce(0.5, 300.0, -200.0, 150.0, 4.0, -7.0)
    reference = static_deflection(rotor, bearings, [load], gravity=GRAVITY)

    shaft = static_shaft(rotor, [0.9, 0.5, 0.08])
    stiffness, loads = shaft.stiffness.copy(), shaft.weight(GRAVITY)
    for at in (0.08, 0.9):
        own = slice(6 * shaft.node(at), 6 * shaft.node(at) + 5)
        stiffness[own, own] += matrix
    loads[6 : 6 + 5] += [300.0, -200.0, 150.0, 4.0, -7.0]
    # The torsion is free and unloaded.
    displacement = solve(stiffness, loads, [5])
    for at, expected in zip((0.08, 0.9), reference.bearing_loads, strict=True):
        moved = displacement[6 * shaft.node(at) :][:5]
        np.testing.assert_allclose(matrix @ moved, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    z = np.linspace(0.0, rotor.length, 23)
    motions, forces = shaft.motions(displacement, z, GRAVITY), shaft.internal_forces(displacement, z, GRAVITY)
    size = float(np.abs(reference.evaluate(z)).max())
    np.testing.assert_allclose(motions[:3], reference.evaluate(z), atol=1e-9 * size)
    np.testing.assert_allclose([motions[4], -motions[3]], reference.slopes(z), atol=1e-8 * size)
    np.testing.assert_allclose(forces[:2], reference.shear_forces(z), atol=1e-7 * float(np.abs(forces[:2]).max()))
    moments = reference.bending_moments(z)
    np.testing.assert_allclose([forces[4], -forces[3]], moments, atol=1e-7 * float(np.abs(moments).max()))


def test_a_coupling_is_a_spring_in_the_shaft() -> None:
    halves = [replace(UNIFORM, length=0.2), JAW, replace(UNIFORM, length=0.1)]
    shaft = static_shaft(Rotor("shaft", halves), [0.0, 0.35])
    section = UNIFORM.section(0.0)
    tip = solve(shaft.stiffness, np.repeat([0.0, 1.0], 6), range(6))[6:]
    assert tip[5] == pytest.approx(0.3 / section.torsional_stiffness + 1 / JAW.torsional_stiffness, rel=1e-12)
    assert tip[2] == pytest.approx(0.3 / section.axial_stiffness + 1 / JAW.axial_stiffness, rel=1e-12)
    # The moment along the shaft of a unit force at the tip, and of a unit moment, times the compliances 1/EI.
    bend = [(0.0, 0.2, 1 / section.bending_stiffness), (0.2, 0.25, 1 / (JAW.tilt_stiffness * JAW.length))]
    bend.append((0.25, 0.35, 1 / section.bending_stiffness))
    turn = sum(c * ((0.35 - a) ** 2 - (0.35 - b) ** 2) / 2 + c * (b - a) for a, b, c in bend)
    assert tip[4] == pytest.approx(turn, rel=1e-12)
    assert shaft.weight([0.0, 1.0, 0.0])[[1, 7]].sum() == pytest.approx(0.3 * section.mass_per_length + JAW.mass)


@pytest.mark.parametrize("phase", [2.0, 6.0])
def test_a_coupling_soft_in_shear_resists_an_offset_under_compression_as_its_field_does(phase: float) -> None:
    """Compliance under a shear force F of ends that do not tilt, z from the middle, C the compression, kL > C > kL / 2.

    EI β'' + g C β = −g F with g = kL / (kL − C) and q² = g C / EI gives β = −F/C (1 − cos qz / cos(qL/2)), and
    x' = g β + F / (kL − C) the offset ∫ x' dz. Beyond qL = π the resistance is negative, at 2π the coupling buckles.
    """
    shear, part, length, mass = 8e5, 0.97, 0.1, 2.0
    share, compression = 1.0 / (1.0 - part), part * shear
    bending = share * compression * (length / phase) ** 2
    coupling = Coupling(length, shear / length, bending / length, 1e4, 1e6, axial_force=-compression)
    rotor = Rotor("pair", [coupling], [Disc(0.0, mass), Disc(length, mass)])
    shaft = static_shaft(rotor, [0.0, length])
    wave = phase / length
    sheared = length / (shear - compression)
    bent = share / compression * (2.0 * math.tan(0.5 * phase) / wave - length)
    assert shaft.stiffness[6, 6] == pytest.approx(1.0 / (bent + sheared), rel=1e-10)
    assert shaft.stiffness[6, 0] == pytest.approx(-1.0 / (bent + sheared), rel=1e-10)
    # And a mass on it, beside a spring to ground.
    spring = 2.0 / abs(bent + sheared)
    supports = [RadialSupport(0.0, math.inf, math.inf), RadialSupport(length, spring, math.inf)]
    omega = math.sqrt((spring + 1.0 / (bent + sheared)) / mass)
    assert solve_lateral_modes(rotor, supports, count=1).frequencies[0] == pytest.approx(omega, rel=1e-10)


def test_a_cone_stretches_twists_and_bends_as_its_compliance_integrates() -> None:
    shaft = static_shaft(Rotor("shaft", [CONE]), [0.0, CONE.length])
    L = CONE.length
    tip = solve(shaft.stiffness, np.repeat([0.0, 1.0], 6), range(6))[6:]

    def integral(what: str, arm: int) -> float:
        return quad(lambda z: (L - z) ** arm / getattr(CONE.section(z / L), what), 0.0, L, epsrel=1e-13)[0]

    assert tip[2] == pytest.approx(integral("axial_stiffness", 0), rel=1e-11)
    assert tip[5] == pytest.approx(integral("torsional_stiffness", 0), rel=1e-11)
    bent = [integral("bending_stiffness", arm) for arm in range(3)]
    assert tip[4] == pytest.approx(bent[0] + bent[1], rel=1e-11)
    assert tip[0] == pytest.approx(bent[1] + bent[2] + integral("shear_stiffness", 0), rel=1e-11)


@pytest.mark.parametrize(
    ("stations", "message"),
    [
        ([], "no stations"),
        ([0.1, 0.8], r"station position is 0\.8; expected a place on the shaft"),
        ([math.nan], "station position is nan"),
    ],
)
def test_bad_input_is_refused(stations: list[float], message: str) -> None:
    with pytest.raises(RotorError, match=message):
        static_shaft(Rotor("shaft", STEPS), stations)


def test_a_place_that_is_no_node_and_a_wrong_gravity_are_refused() -> None:
    shaft: StaticShaft = static_shaft(Rotor("shaft", STEPS), [0.3, 0.1])
    assert (shaft.node(0.1), shaft.node(0.3 + 1e-11)) == (0, 1)
    with pytest.raises(RotorError, match=r"node position is 0\.2; expected one of \[0\.1, 0\.3\] m"):
        shaft.node(0.2)
    with pytest.raises(RotorError, match="gravity"):
        shaft.weight([0.0, -9.81])
    with pytest.raises(RotorError, match="on the shaft"):
        shaft.motions(np.zeros(12), [0.8])
