"""Uneven faces: the spur law as the limit, the slices against dense quadratic programming, and the compiled table."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.linalg import block_diag
from scipy.optimize import nnls

from gearwhine.coupling.gears import (
    Gear,
    GearPairGeometry,
    HelixDeviation,
    PotentialEnergyStiffness,
    Spall,
    TipRelief,
    ToothContact,
    loaded_transmission_error,
    mesh_stiffness,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import (
    FaceSlices,
    face_equilibrium,
    face_loads,
    face_slices,
    slice_stiffness,
    tooth_coupling,
)
from gearwhine.coupling.gears.contact.lookup_tables import TILT_PERIOD
from gearwhine.coupling.gears.contact.tooth_force_kernels import ranked_penetration, tooth_force, tooth_force_history
from gearwhine.numerics.arrays import ComplexArray, FloatArray

ALPHA = math.radians(20.0)
MODEL = PotentialEnergyStiffness()
PINION = Gear("pinion", 24, 3e-3, ALPHA, 24e-3, tip_relief=TipRelief(10e-6, length=3e-3))
WHEEL = replace(PINION, name="wheel", teeth=37)
SPUR = GearPairGeometry(PINION, WHEEL)
PHASES = np.arange(64) / 64.0
FORCE = 6000.0


def helical(degrees: float, **changes: object) -> GearPairGeometry:
    angle = math.radians(degrees)
    return GearPairGeometry(
        replace(PINION, helix_angle=angle, **changes),  # type: ignore[arg-type]
        replace(WHEEL, helix_angle=-angle),
    )


def test_even_faces_are_the_spur_law() -> None:
    plain = tooth_contact(SPUR, MODEL, corner_contact=True)
    slices = face_slices(SPUR)
    # Load per width over the flattening of equal materials, by Yang and Sun.
    assert slices.flattening == pytest.approx(math.pi * PINION.youngs_modulus / (4.0 * (1.0 - PINION.poisson_ratio**2)))
    sliced = tooth_contact(SPUR, MODEL, corner_contact=True, faces=slices)
    for force in (50.0, FORCE):
        one, other = (loaded_transmission_error(contact, force, PHASES) for contact in (plain, sliced))
        np.testing.assert_allclose(other.transmission_error, one.transmission_error, rtol=1e-9)
        np.testing.assert_allclose(other.pair_forces, one.pair_forces, atol=1e-6 * force)
        np.testing.assert_allclose(other.tangent_stiffness, one.tangent_stiffness, rtol=1e-9)


def test_helix_angle_to_nothing_is_a_spur_gear() -> None:
    spur = loaded_transmission_error(tooth_contact(SPUR, MODEL, corner_contact=True), FORCE, PHASES)
    apart = []
    for degrees in (1.0, 0.1, 0.01):
        pair = helical(degrees)
        contact = tooth_contact(pair, MODEL, corner_contact=True, faces=face_slices(pair))
        error = loaded_transmission_error(contact, FORCE, PHASES).transmission_error
        apart.append(np.abs(error - spur.transmission_error).max() / spur.mean_transmission_error)
    assert apart[2] < 1e-3
    assert apart[2] < 0.2 * apart[1] < 0.1 * apart[0]


def test_helical_teeth_have_slices_without_being_given_any() -> None:
    pair = helical(20.0, helix_deviation=HelixDeviation(crowning=4e-6))
    given = tooth_contact(pair, MODEL, corner_contact=True, faces=face_slices(pair))
    unasked = tooth_contact(pair, MODEL, corner_contact=True)
    as_spur = replace(unasked, faces=None)
    # Teeth that enter over their face in turn swing the mesh much less than one line of contact at a time.
    errors = [loaded_transmission_error(contact, FORCE, PHASES) for contact in (unasked, given, as_spur)]
    np.testing.assert_array_equal(errors[0].transmission_error, errors[1].transmission_error)
    assert errors[0].peak_to_peak_transmission_error < 0.5 * errors[2].peak_to_peak_transmission_error


def random_face(seed: int) -> tuple[FaceSlices, np.ndarray, np.ndarray, float]:
    random = np.random.default_rng(seed)
    n = 24
    slices = FaceSlices(np.linspace(-1.0, 1.0, n) * 1e-2, 8e-4, np.zeros(n), np.zeros(n), 1.6e11, 1.3e5)
    base = random.uniform(8e9, 2e10, n)
    gap = random.uniform(0.0, 2e-5, n) + random.uniform(-1.0, 1.0) * np.linspace(-1e-5, 1e-5, n)
    return slices, base, gap, float(random.uniform(5e-6, 3e-5))


@pytest.mark.parametrize("seed", range(6))
def test_slices_against_a_dense_solution_of_the_unilateral_problem(seed: int) -> None:
    # q >= 0, delta - gap - w - q/k_h <= 0, complementary: the minimum of a quadratic form, here by non-negative
    # least squares on its Cholesky factor.
    slices, base, gap, compression = random_face(seed)
    n = base.size
    link = slices.coupling / slices.width**2
    matrix = np.diag(base + link * np.r_[1.0, np.full(n - 2, 2.0), 1.0]) - link * (np.eye(n, k=1) + np.eye(n, k=-1))
    flexibility = np.linalg.inv(matrix) + np.eye(n) / slices.flattening
    factor = np.linalg.cholesky(flexibility)
    expected = nnls(factor.T, np.linalg.solve(factor, compression - gap), maxiter=1000)[0]
    found = face_loads(slices, base[None], gap[None], np.ones((1, n), dtype=np.bool_), np.array([compression]))
    np.testing.assert_allclose(found.line_load[0], expected, atol=1e-8 * expected.max())
    assert (expected == 0.0).any()  # some slices stand clear
    step = 1e-10
    ahead = face_loads(slices, base[None], gap[None], np.ones((1, n), dtype=np.bool_), np.array([compression + step]))
    assert (ahead.force[0] - found.force[0]) / step == pytest.approx(found.tangent[0], rel=1e-4)


@pytest.mark.parametrize("seed", range(4))
def test_pairs_on_bodies_that_tilt_against_a_dense_solution(seed: int) -> None:
    """Two pairs with one body, whose deflection is that of all their loads, by quadratic programming."""
    (slices, base, gap, _), (_, other_base, other_gap, _) = random_face(seed), random_face(seed + 10)
    random = np.random.default_rng(seed)
    n = base.size
    bases, gaps = np.stack([base, other_base]), np.stack([gap, other_gap])
    factor = 4e-10 * random.uniform(-1.0, 1.0, (3, 3)) ** 2
    slices = replace(slices, shared=factor + factor.T + 4e-9 * np.diag([1.0, 0.4, 0.3]))
    z = slices.z / slices.z.max()
    shapes = np.linalg.qr(np.column_stack([np.ones(n), z, z**2, z**3]))[0][:, 1:] * math.sqrt(n)
    np.testing.assert_allclose(np.abs(slices.shapes.T @ shapes / n), np.eye(3), atol=1e-12)
    link = slices.coupling / slices.width**2
    chain = link * (np.diag(np.r_[1.0, np.full(n - 2, 2.0), 1.0]) - np.eye(n, k=1) - np.eye(n, k=-1))
    own = block_diag(*(np.linalg.inv(np.diag(one) + chain) for one in bases)) + np.eye(2 * n) / slices.flattening
    body = slices.width * slices.shapes @ slices.shared @ slices.shapes.T
    lower = np.linalg.cholesky(own + np.tile(body, (2, 2)))
    meeting, owner = np.ones((2, n), dtype=np.bool_), np.zeros(2, dtype=np.intp)

    def program(compression: float) -> np.ndarray:
        return nnls(lower.T, np.linalg.solve(lower, compression - gaps.ravel()), maxiter=2000)[0]

    compression, loads = face_equilibrium(slices, bases, gaps, meeting, owner, np.array([2000.0]))
    expected = program(float(compression[0]))
    assert expected.sum() * slices.width == pytest.approx(2000.0, rel=1e-6)
    np.testing.assert_allclose(loads.line_load.ravel(), expected, atol=1e-6 * expected.max())
    assert (expected == 0.0).any()
    step = 1e-10
    slope = (program(float(compression[0]) + step) - expected).sum() * slices.width / step
    assert loads.tangent.sum() == pytest.approx(slope, rel=1e-3)
    # Bodies that do not tilt carry otherwise.
    rigid = face_equilibrium(replace(slices, shared=np.zeros((0, 0))), bases, gaps, meeting, owner, np.array([2000.0]))
    assert np.abs(rigid[1].line_load - loads.line_load).max() > 0.02 * expected.max()


def test_an_even_load_does_not_see_how_bodies_tilt() -> None:
    contact = tooth_contact(SPUR, MODEL, corner_contact=True, faces=face_slices(SPUR))
    assert contact.faces is not None
    assert contact.faces.shared.shape == (3, 3)
    assert np.all(np.linalg.eigvalsh(contact.faces.shared) > 0.0)
    one, other = (loaded_transmission_error(law, FORCE, PHASES) for law in (contact, rigid_bodies(contact)))
    np.testing.assert_allclose(one.transmission_error, other.transmission_error, rtol=1e-13)
    np.testing.assert_allclose(one.pair_forces, other.pair_forces, atol=1e-11 * FORCE)


def rigid_bodies(contact: ToothContact) -> ToothContact:
    """The same contact on bodies that do not tilt, as the table for the motion has it."""
    assert contact.faces is not None
    return replace(contact, faces=replace(contact.faces, shared=np.zeros((0, 0))))


def test_a_point_load_spreads_by_the_foundations_own_length() -> None:
    # Far from the ends w falls with e^{-|z|/l}, l = sqrt(T/k_b): the closed form of Pasternak's foundation.
    n, k_b = 401, 1.2e10
    width = 0.1 / n
    z = width * (np.arange(n) - 200)
    slices = FaceSlices(z, width, np.zeros(n), np.zeros(n), 1e13, 1.5e5)
    gap = np.where(z == 0.0, 0.0, 1.0)
    meeting = (z == 0.0)[None]
    load = face_loads(slices, np.full((1, n), k_b), gap[None], meeting, np.array([1e-5]))
    length = math.sqrt(slices.coupling / k_b)
    stiffness = 2.0 * math.sqrt(k_b * slices.coupling)  # of a line load at one place of an endless face
    assert load.force[0] / 1e-5 == pytest.approx(stiffness, rel=2.0 * width / length)


def test_coupling_grows_with_the_square_of_the_size() -> None:
    # A force over a slope: modulus times length squared.
    coupling = tooth_coupling(PINION, PINION.pitch_radius)
    double = replace(PINION, module=6e-3, youngs_modulus=0.5 * PINION.youngs_modulus)
    assert tooth_coupling(double, double.pitch_radius) == pytest.approx(2.0 * coupling, rel=1e-9)


def test_crowning_brings_the_load_to_the_middle_and_misalignment_to_one_end() -> None:
    crowned = GearPairGeometry(replace(PINION, helix_deviation=HelixDeviation(crowning=12e-6)), WHEEL)
    contact = tooth_contact(crowned, MODEL, corner_contact=True, faces=face_slices(crowned))
    mesh = loaded_transmission_error(contact, FORCE, [0.8])
    assert mesh.line_loads is not None
    loads = mesh.line_loads[0].sum(axis=0)
    assert loads.argmax() == loads.size // 2
    np.testing.assert_allclose(loads, loads[::-1], rtol=1e-6, atol=1e-6 * loads.max())
    tilted = tooth_contact(SPUR, MODEL, corner_contact=True, faces=face_slices(SPUR, misalignment=1e-3))
    mesh = loaded_transmission_error(tilted, FORCE, [0.8])
    assert mesh.line_loads is not None
    assert mesh.line_loads[0].sum(axis=0).argmax() == 0  # the gap opens towards +z
    assert mesh.tangent_stiffness[0] < tooth_contact(SPUR, MODEL).unloaded_mean_mesh_stiffness


def test_a_helix_deviation_undoes_a_misalignment() -> None:
    angle, b = 0.8e-3, PINION.face_width
    mended = GearPairGeometry(replace(PINION, helix_deviation=HelixDeviation(slope=angle * b)), WHEEL)
    faces = face_slices(mended, misalignment=angle)
    np.testing.assert_allclose(faces.gap, 0.0, atol=1e-18)


def test_turning_the_other_way_mirrors_the_face() -> None:
    pair = helical(15.0, helix_deviation=HelixDeviation(slope=9e-6))
    mirrored = helical(-15.0, helix_deviation=HelixDeviation(slope=9e-6))
    errors = [
        loaded_transmission_error(
            tooth_contact(p, MODEL, corner_contact=True, faces=face_slices(p, sense=sense)), FORCE, PHASES
        ).transmission_error
        for p, sense in ((pair, 1), (mirrored, -1), (pair, -1))
    ]
    np.testing.assert_allclose(errors[1], errors[0], rtol=1e-9)
    assert np.abs(errors[2] - errors[0]).max() > 1e-9


def test_whole_overlap_keeps_the_length_of_contact_and_so_the_error() -> None:
    # With an overlap of one pitch the lines of contact are as long at every phase.
    whole = math.degrees(math.asin(math.pi * PINION.module / PINION.face_width))
    swings = []
    for degrees in (0.01, 8.0, whole):
        pair = helical(degrees, tip_relief=None)
        contact = tooth_contact(pair, MODEL, corner_contact=True, faces=face_slices(pair))
        swings.append(loaded_transmission_error(contact, FORCE, PHASES).peak_to_peak_transmission_error)
    assert pair.overlap_ratio == pytest.approx(1.0)
    assert swings[0] > swings[1] > 5.0 * swings[2]


def test_without_load_the_first_slice_touches() -> None:
    pair = helical(14.0, helix_deviation=HelixDeviation(crowning=6e-6, slope=3e-6))
    contact = tooth_contact(pair, MODEL, corner_contact=True, faces=face_slices(pair))
    mesh = loaded_transmission_error(contact, 0.0, PHASES)
    light = loaded_transmission_error(contact, 1e-3, PHASES)
    np.testing.assert_allclose(mesh.transmission_error, light.transmission_error, atol=1e-9)
    np.testing.assert_array_equal(mesh.pair_forces, 0.0)
    assert np.all(mesh.tangent_stiffness > 0.0)


def test_mean_mesh_stiffness_is_that_of_the_period() -> None:
    pair = helical(11.0)
    contact = tooth_contact(pair, MODEL, corner_contact=True, faces=face_slices(pair))
    over_period = mesh_stiffness(contact, np.arange(997) / 997.0)
    assert over_period.mean() == pytest.approx(contact.unloaded_mean_mesh_stiffness, rel=1e-3)


@pytest.fixture(scope="module")
def uneven() -> object:
    pair = helical(14.0, helix_deviation=HelixDeviation(crowning=6e-6))
    return tooth_contact(pair, MODEL, 100.0, corner_contact=True, faces=face_slices(pair, misalignment=2e-4))


def test_the_table_carries_what_the_slices_carry(uneven) -> None:  # type: ignore[no-untyped-def]
    random = np.random.default_rng(8)
    law = uneven.with_damping(0.0).kernel_arguments
    for phase, force in zip(random.uniform(0.0, 1.0, 40), random.uniform(100.0, 2.0 * FORCE, 40), strict=True):
        compression = loaded_transmission_error(rigid_bodies(uneven), force, [phase]).transmission_error[0]
        assert tooth_force(phase, compression, 0.0, *law)[0] == pytest.approx(force, abs=3e-3 * FORCE)
        # On bodies that tilt the slices are a little softer.
        tilted = loaded_transmission_error(uneven, force, [phase]).transmission_error[0]
        assert force - 3e-3 * FORCE < tooth_force(phase, tilted, 0.0, *law)[0] < 1.02 * force + 3e-3 * FORCE


@pytest.mark.parametrize(("degrees", "miss"), [(0.0, 1e-3), (0.02, 0.02), (14.0, 0.01)])
def test_the_table_carries_what_the_slices_carry_beside_a_deep_spall(degrees: float, miss: float) -> None:
    middle = PINION.roll_angle(PINION.pitch_radius)
    pair = helical(degrees, faults=(Spall(3, middle - 0.02, middle + 0.03, 0.2e-3),))
    contact = tooth_contact(pair, MODEL, corner_contact=True, faces=face_slices(pair, misalignment=2e-4))
    contact = rigid_bodies(contact)
    phases = np.arange(2.0, 6.0, 0.013)
    mesh = loaded_transmission_error(contact, FORCE, phases)
    law = contact.kernel_arguments
    found = [tooth_force(at, deep, 0.0, *law)[0] for at, deep in zip(phases, mesh.transmission_error, strict=True)]
    np.testing.assert_allclose(found, FORCE, rtol=miss)


@pytest.mark.slow
def test_what_a_table_misses_beside_a_spall_is_what_the_slices_miss() -> None:
    """A slice is in the pit or out of it: the table of twice as many is no farther from few than both from many."""
    middle = PINION.roll_angle(PINION.pitch_radius)
    pair = helical(14.0, faults=(Spall(3, middle - 0.02, middle + 0.03, 0.2e-3),))
    phases = np.arange(3.552, 3.72, 0.013)
    laws = [
        rigid_bodies(tooth_contact(pair, MODEL, corner_contact=True, faces=face_slices(pair, count=count)))
        for count in (61, 122, 721)
    ]
    meshes = [loaded_transmission_error(law, FORCE, phases) for law in laws]
    misses = []
    for law, mesh in zip(laws, meshes, strict=True):
        found = [
            tooth_force(at, deep, 0.0, *law.kernel_arguments)[0]
            for at, deep in zip(phases, mesh.transmission_error, strict=True)
        ]
        misses.append(float(np.abs(np.array(found) / FORCE - 1.0).max()))
    apart = [
        np.abs(mesh.transmission_error - meshes[-1].transmission_error) * meshes[-1].tangent_stiffness / FORCE
        for mesh in meshes[:2]
    ]
    assert (apart[0] + apart[1]).max() > 0.8 * misses[0]
    assert misses[-1] < 0.3 * misses[0]


@pytest.mark.parametrize("back", [False, True])
def test_at_the_mean_load_the_table_carries_what_slices_on_tilting_bodies_carry(uneven, back: bool) -> None:  # type: ignore[no-untyped-def]
    """On the flanks that carry it; the others have no mean load."""
    given = uneven.with_damping(0.0).under_load(-FORCE if back else FORCE)
    loaded, other = (given.back_flanks, given) if back else (given, given.back_flanks)
    assert other.body_tilt is None
    without = loaded.under_load(0.0)
    mesh = loaded_transmission_error(loaded, FORCE, PHASES)
    forces = np.array(
        [
            [tooth_force(at, deep, 0.0, *law.kernel_arguments)[0] for law in (loaded, without)]
            for at, deep in zip(PHASES, mesh.transmission_error, strict=True)
        ]
    )
    misses = np.abs(forces / FORCE - 1.0).max(axis=0)
    assert misses[0] < 1e-3
    assert misses[1] > 4.0 * misses[0]


@pytest.fixture(scope="module")
def unequal(uneven) -> object:  # type: ignore[no-untyped-def]
    """Every pair of teeth with a gap of its own."""
    z1, z2 = PINION.teeth, WHEEL.teeth
    random = np.random.default_rng(3)
    of_driver, of_driven = random.normal(0.0, 4e-6, z1), random.normal(0.0, 4e-6, z2)
    number = np.arange(math.lcm(z1, z2))
    gaps = of_driver[number % z1] + of_driven[number % z2]
    return replace(
        uneven.with_damping(0.0).under_load(FORCE), pitch_gaps=gaps, back_pitch_gaps=gaps, tooth_counts=(z1, z2)
    )


@pytest.mark.parametrize(("whole", "better"), [(True, 2.0), (False, 1.3)])
def test_at_the_mean_load_the_table_carries_what_unequal_teeth_carry(unequal, whole, better, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    """Tooth by tooth, as these move the load along the face; by the teeth of each gear where there are too many."""
    if not whole:
        monkeypatch.setattr("gearwhine.coupling.gears.contact.contact_law._MOST_HUNTING", 1)
    law = replace(unequal)
    phases = np.random.default_rng(5).uniform(-unequal.hunting_period, 2.0 * unequal.hunting_period, 200)
    mesh = loaded_transmission_error(unequal, FORCE, phases)
    misses = [
        np.std(tooth_force_history(phases, mesh.transmission_error, 0.0 * phases, *kernel)[:, 0] / FORCE)
        for kernel in (law.kernel_arguments, frozen(law))
    ]
    assert misses[0] < 2e-3
    assert misses[1] > better * misses[0]


def test_teeth_with_the_same_gap_tilt_the_bodies_as_teeth_alike(uneven, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    """By the teeth of both together, or of each gear: a gap of all pairs moves no load."""
    same = replace(uneven.under_load(FORCE), pitch_gaps=np.full(6, 5e-6), tooth_counts=(2, 3))
    for most in (6, 0):
        monkeypatch.setattr("gearwhine.coupling.gears.contact.contact_law._MOST_HUNTING", most)
        tilts = replace(same).tooth_tilts
        assert [len(tilt) for tilt in tilts] == ([6] if most else [2, 3])
        assert max(np.abs(tilt).max() for tilt in tilts) < 1e-14


def frozen(law) -> tuple[FloatArray, int]:  # type: ignore[no-untyped-def]
    """Law with the bodies' tilt of teeth alike."""
    numbers, at = law.kernel_arguments
    alike = numbers.copy()
    alike[TILT_PERIOD] = 0
    return alike, at


def test_unequal_teeth_move_as_with_the_statics_at_every_step(uneven) -> None:  # type: ignore[no-untyped-def]
    """A mass on the mesh, with the force of static solutions about the load, and with that of the table."""
    pairs, steps = 6, 64
    gaps = np.random.default_rng(3).normal(0.0, 3e-6, pairs)
    law = replace(uneven.with_damping(0.0).under_load(FORCE), pitch_gaps=gaps, tooth_counts=(pairs, pairs + 1))
    phases = np.arange(pairs * steps) / steps
    loads = FORCE * np.array([0.7, 0.85, 0.95, 1.0, 1.05, 1.15, 1.3])
    depths = np.array([loaded_transmission_error(law, load, phases).transmission_error for load in loads])
    stiffness = (loads[4] - loads[2]) / (depths[4] - depths[2]).mean()
    step = 2.0 * math.pi / 0.4 / steps  # times the natural frequency, of which the mesh frequency is 0.4
    statics = [CubicSpline(column, loads) for column in depths.T]

    def lines(force: Callable[[int, float], float]) -> ComplexArray:
        x, rate, path = depths[3, 0], 0.0, []
        for at in 10 * list(range(phases.size)):
            rate += ((FORCE - force(at, x)) / stiffness - 0.2 * rate) * step
            x += rate * step
            path.append(x)
        return np.fft.rfft(path[-phases.size :])[1 : 4 * pairs + 1]

    def table_force(kernel: tuple[FloatArray, int], at: int, x: float) -> float:
        return tooth_force(float(phases[at]), x, 0.0, *kernel)[0]

    expected = lines(lambda at, x: float(statics[at](x)))
    misses = []
    for kernel in (law.kernel_arguments, frozen(law)):
        found = lines(partial(table_force, kernel))
        misses.append(np.linalg.norm(found - expected) / np.linalg.norm(expected))
    assert misses[0] < 5e-3
    assert misses[1] > 3.0 * misses[0]


@pytest.mark.parametrize("whole", [True, False])
def test_the_force_of_unequal_teeth_is_the_slope_of_their_energy(unequal, whole, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    """And the pairs that touch are those whose penetration is positive."""
    if not whole:
        monkeypatch.setattr("gearwhine.coupling.gears.contact.contact_law._MOST_HUNTING", 1)
    law, at = replace(unequal).kernel_arguments
    random = np.random.default_rng(6)
    phases, depths, still = random.uniform(-9.0, 90.0, 60), random.uniform(4e-6, 30e-6, 60), np.zeros(60)

    def evaluated(later: float, deeper: float) -> FloatArray:
        return tooth_force_history(phases + later, depths + deeper, still, law, at)

    force, slope, touching = evaluated(0.0, 0.0)[:, [0, 4, 5]].T
    by_depth = (evaluated(0.0, 1e-10) - evaluated(0.0, -1e-10))[:, 3] / 2e-10
    by_phase = (evaluated(1e-6, 0.0) - evaluated(-1e-6, 0.0))[:, 3] / 2e-6
    np.testing.assert_allclose(by_depth, force, atol=1e-5 * FORCE)
    np.testing.assert_allclose(by_phase, slope, atol=1e-5 * np.abs(slope).max())
    for phase, depth, count in zip(phases, depths, touching, strict=True):
        ranks = [ranked_penetration(phase, depth, law, at, rank) > 0.0 for rank in (int(max(count, 1)), int(count) + 1)]
        assert ranks == [count > 0, False]


@pytest.mark.slow
@pytest.mark.parametrize("load", [0.0, FORCE])
@pytest.mark.parametrize("depth", [2e-6, 14e-6, 60e-6, 300e-6])
@pytest.mark.parametrize("phase", [0.11, 0.52, 0.87])
def test_the_tables_force_is_its_energys_slope(uneven, phase: float, depth: float, load: float) -> None:  # type: ignore[no-untyped-def]
    law = uneven.with_damping(0.0).under_load(load).kernel_arguments
    step = 1e-4 * depth
    before, here, after = (tooth_force(phase, depth + change, 0.0, *law) for change in (-step, 0.0, step))
    assert (after[3] - before[3]) / (2.0 * step) == pytest.approx(here[0], rel=1e-6)
    assert (after[0] - before[0]) / (2.0 * step) == pytest.approx(here[1], rel=1e-5)
    before, after = (tooth_force(phase + change, depth, 0.0, *law) for change in (-1e-6, 1e-6))
    assert (after[3] - before[3]) / 2e-6 == pytest.approx(here[4], rel=1e-4, abs=1e-7 * here[3])


def test_an_uneven_spur_face_enters_and_meets_its_reliefs_at_once() -> None:
    """The energy's slope by the phase jumps where that of the even face does, and nowhere else."""
    pair = GearPairGeometry(replace(PINION, helix_deviation=HelixDeviation(crowning=12e-6)), WHEEL)
    plain = tooth_contact(SPUR, MODEL, corner_contact=True)
    uneven = tooth_contact(pair, MODEL, corner_contact=True, faces=face_slices(pair, misalignment=2e-4))
    assert uneven.event_phases == plain.event_phases
    assert uneven.corner_phases == plain.corner_phases
    marks = np.unique([*plain.event_phases, *plain.corner_phases])
    assert marks.size == 4
    phases = np.arange(20_001) / 20_000 + 1.23e-5
    history = np.array([tooth_force(phase, 20e-6, 0.0, *uneven.kernel_arguments) for phase in phases])
    trapezoids = 0.5 * (history[1:, 4] + history[:-1, 4]) * np.diff(phases)
    missed = np.abs(np.diff(history[:, 3]) - trapezoids)
    at_marks = np.searchsorted(phases, marks + (marks < phases[0])) - 1
    relief = np.searchsorted(phases, plain.corner_phases) - 1
    assert missed[relief].min() > 100.0 * np.delete(missed, at_marks).max()


def test_a_helical_pair_enters_slice_by_slice(uneven) -> None:  # type: ignore[no-untyped-def]
    assert uneven.event_phases == uneven.corner_phases == ()


def test_stiffness_without_flattening_gives_the_whole_back() -> None:
    slices = face_slices(SPUR)
    whole = np.array([3e8, 1e12])
    base = slice_stiffness(slices, whole)
    back = slices.face_width / (1.0 / base + 1.0 / slices.flattening)
    assert back[0] == pytest.approx(whole[0], rel=1e-12)
    assert np.all(base > 0.0)
