"""Bending moments and strain energies of whirl modes: equilibrium, closed forms, sensitivities, finite elements."""

import math
from dataclasses import replace

import numpy as np
import pytest
from finite_element_whirl import spatial_matrices
from scipy import linalg

from gearwhine.rotors import (
    Bearing,
    Disc,
    Pedestal,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    WhirlModes,
    solve_lateral_modes,
    solve_whirl,
)

STEEL = ShaftMaterial(2.1e11, 8.1e10, 7850.0)
RIGID = ShaftMaterial(2e20, 8e19, 0.0)
SEGMENTS = [Segment(0.4, 0.05, 0.0, STEEL), Segment(0.3, 0.06, 0.02, STEEL), Segment(0.35, 0.045, 0.0, STEEL)]
SHAFT = Rotor("shaft", SEGMENTS, [Disc(0.4, 12.0, 0.15, 0.08), Disc(1.05, 6.0, 0.06, 0.03)])
PLAIN = [
    Bearing("left", 0.0, np.array([[2e7, 1e6], [1e6, 1.2e7]]), np.zeros((2, 2))),
    Bearing("right", 0.7, np.diag([1.5e7, 3e7]), np.zeros((2, 2))),
]


def whole(modes: WhirlModes, rotor: Rotor) -> np.ndarray:
    """Shares of segments, bearings and pedestals in one row for each mode."""
    shares = modes.strain_energy_shares(rotor.joints)
    return np.hstack([shares.lengths, shares.bearings, shares.pedestals])


def test_loads_balance_the_inertia_along_the_turning_shaft() -> None:
    """f' = λ² ρA r, m±' = (λ² ∓ 2iΩλ) ρI β± − f± and m = EI β', by central differences inside a segment."""
    speed = 900.0
    damped = [replace(one, damping=np.diag([900.0, 500.0])) for one in PLAIN]
    modes = solve_whirl(SHAFT, damped, speed, count=6)
    z, h = np.linspace(0.45, 0.65, 5), 1e-4
    section, at = SEGMENTS[1].section(0.0), modes.eigenvalues[:, None]
    circular = np.array([[1.0, 1.0j], [1.0, -1.0j]]) / math.sqrt(2.0)

    def turned(pair: object) -> np.ndarray:
        return np.einsum("ij,jwz->iwz", circular, np.array(pair))

    shear, moment = modes.section_loads(z)
    ahead, behind = modes.section_loads(z + h), modes.section_loads(z - h)
    slopes = [turned(modes.motion.evaluate_slopes(places)) for places in (z - h, z, z + h)]
    forces, moments = [turned(each[0]) for each in (ahead, behind)], [turned(each[1]) for each in (ahead, behind)]
    inertia = 0.5 * section.polar_inertia_per_length
    turning = np.stack([at**2 - 2j * speed * at, at**2 + 2j * speed * at])
    for found, expected in (
        ((forces[0] - forces[1]) / (2.0 * h), at**2 * section.mass_per_length * turned(modes.evaluate(z))),
        ((moments[0] - moments[1]) / (2.0 * h), turning * inertia * slopes[1] - turned(shear)),
        (turned(moment), section.bending_stiffness * (slopes[2] - slopes[0]) / (2.0 * h)),
    ):
        scale = np.abs(expected).max(axis=(0, 2), keepdims=True)
        assert np.abs((found - expected) / scale).max() < 1e-5


def test_ends_carry_what_bearings_press_and_free_ends_nothing() -> None:
    modes = solve_whirl(SHAFT, PLAIN, 700.0, count=6)
    shear, moment = modes.section_loads([0.0, 0.5])
    pressed = np.einsum("ij,jw->iw", PLAIN[0].stiffness, np.array(modes.evaluate([0.0]))[:, :, 0])
    assert np.abs(shear[:, :, 0] - pressed).max() < 1e-9 * np.abs(shear).max()
    assert np.abs(moment[:, :, 0]).max() < 1e-9 * np.abs(moment).max()


def test_at_rest_the_shares_are_those_of_the_planar_modes() -> None:
    alike = [Bearing.isotropic(one.name, one.at, 2e7) for one in PLAIN]
    planar = solve_lateral_modes(SHAFT, [one.mean_support for one in alike], count=3)
    lengths, supports = planar.strain_energy_shares(SHAFT.joints)
    shares = solve_whirl(SHAFT, alike, 0.0, count=6).strain_energy_shares(SHAFT.joints)
    np.testing.assert_allclose(shares.lengths, np.repeat(lengths, 2, axis=0), atol=1e-9)
    np.testing.assert_allclose(shares.bearings, np.repeat(supports, 2, axis=0), atol=1e-9)


def test_a_rigid_rotor_strains_its_bearings_by_their_stiffness() -> None:
    """Bouncing on k and 3k with the disc over their centre: a quarter and three quarters of it, at any speed."""
    rotor = Rotor("rigid", [Segment(1.0, 0.2, 0.0, RIGID)], [Disc(0.75, 30.0, 0.5, 0.8)])
    bearings = [Bearing.isotropic("soft", 0.0, 1e6, 100.0), Bearing.isotropic("stiff", 1.0, 3e6, 300.0)]
    modes = solve_whirl(rotor, bearings, 500.0)
    bounce = np.abs(modes.frequencies - math.sqrt(4e6 / 30.0)) < 1e-6 * modes.frequencies
    assert int(bounce.sum()) == 2
    np.testing.assert_allclose(modes.strain_energy_shares([0.0, 1.0]).bearings[bounce], [[0.25, 0.75]] * 2, atol=1e-8)
    # It swings about the same centre with a k a² = 3 k (L − a)² of either: their arms are as 3 to 1.
    np.testing.assert_allclose(modes.strain_energy_shares([0.0, 1.0]).bearings[~bounce], [[0.75, 0.25]] * 2, atol=1e-8)


@pytest.mark.parametrize("speed", [0.0, 800.0, -2500.0])
def test_undamped_shares_are_the_sensitivities_of_the_frequency(speed: float) -> None:
    """∂ω/∂ln k of every part over their sum, by central differences of the frequencies themselves."""
    count, step = 6, 1e-4
    pedestal = Pedestal(np.diag([4e7, 6e7]), np.zeros((2, 2)), 8.0)
    bearings = [PLAIN[0], replace(PLAIN[1], pedestal=pedestal)]
    modes = solve_whirl(SHAFT, bearings, speed, count=count)

    def frequencies(part: int, factor: float) -> np.ndarray:
        segments, held = list(SEGMENTS), list(bearings)
        if part < 3:
            stiffer = ShaftMaterial(factor * STEEL.youngs_modulus, factor * STEEL.shear_modulus, STEEL.density)
            segments[part] = replace(segments[part], material=stiffer)
        elif part < 5:
            held[part - 3] = replace(held[part - 3], stiffness=factor * held[part - 3].stiffness)
        else:
            held[1] = replace(held[1], pedestal=replace(pedestal, stiffness=factor * pedestal.stiffness))
        return solve_whirl(replace(SHAFT, segments=segments), held, speed, count=count).frequencies

    parts = range(6)
    slopes = np.array([frequencies(part, 1.0 + step) - frequencies(part, 1.0 - step) for part in parts]).T
    shares = whole(modes, SHAFT)
    assert not shares[:, 5].any()  # the left bearing's, which has none
    np.testing.assert_allclose(shares[:, [0, 1, 2, 3, 4, 6]], slopes / slopes.sum(axis=1, keepdims=True), atol=1e-6)


@pytest.mark.parametrize("axial", [False, True])
def test_damped_shares_are_those_of_finite_elements(axial: bool) -> None:
    """Cross-coupled and damped, on a pedestal, or tied to axial motion: Re(qᴴ K q) of the elements' vectors."""
    speed, count = 1200.0, 6
    held = [
        Bearing("left", 0.0, np.array([[2e7, 4e6], [-4e6, 1.2e7]]), np.diag([3e3, 5e3])),
        Bearing(
            "right",
            0.7,
            np.diag([1.5e7, 3e7]),
            np.diag([2e3, 2e3]),
            pedestal=Pedestal(np.diag([4e7, 6e7]), 1e3 * np.eye(2), 8.0),
        ),
    ]
    if axial:
        matrix = np.diag([2e7, 3e7, 1e7, 2e4, 3e4])
        matrix[0, 2] = matrix[2, 0] = 6e6
        matrix[1, 3] = matrix[3, 1] = 2e5
        held[0] = Bearing("left", 0.0, matrix, np.diag([3e3, 5e3, 2e3, 0.0, 0.0]))
    modes = solve_whirl(SHAFT, held, speed, count=count)
    bare = [replace(one, stiffness=np.zeros_like(one.stiffness)) for one in held]
    limit = 3.0 * float(modes.frequencies[-1])
    full, parts = (spatial_matrices(SHAFT, some, limit, axial=axial) for some in (held, bare))
    order = full.mass.shape[0]
    system = np.block([[np.zeros((order, order)), np.eye(order)], [np.zeros((order, 2 * order))]])
    system[order:] = -np.linalg.solve(full.mass, np.hstack([full.stiffness, full.damping + speed * full.gyroscopic]))
    values, vectors = linalg.eig(system)
    found = modes.strain_energy_shares(SHAFT.joints)
    for mode in range(count):
        near = int(np.abs(values - modes.eigenvalues[mode]).argmin())
        assert abs(values[near] - modes.eigenvalues[mode]) < 1e-6 * abs(values[near])
        q = vectors[:order, near]
        stored = (q.conj() @ full.stiffness @ q).real
        # Without the bearings' springs, the shaft and the pedestal are left, the last two coordinates.
        foot = (q[-2:].conj() @ np.diag([4e7, 6e7]) @ q[-2:]).real
        shaft = (q.conj() @ parts.stiffness @ q).real - foot
        assert found.lengths[mode].sum() == pytest.approx(shaft / stored, abs=1e-6)
        assert found.pedestals[mode].sum() == pytest.approx(foot / stored, abs=1e-6)
        assert found.bearings[mode].sum() == pytest.approx(1.0 - (shaft + foot) / stored, abs=1e-6)


def test_cut_anywhere_the_parts_add_up_and_places_must_be_on_the_shaft() -> None:
    modes = solve_whirl(SHAFT, PLAIN, 300.0, count=4)
    coarse = modes.strain_energy_shares(SHAFT.joints).lengths
    finer = modes.strain_energy_shares([0.0, 0.11, 0.4, 0.55, 0.7, 1.05]).lengths
    np.testing.assert_allclose(finer[:, :2].sum(axis=1), coarse[:, 0], rtol=1e-9)
    np.testing.assert_allclose(whole(modes, SHAFT).sum(axis=1), 1.0, rtol=1e-12)
    with pytest.raises(RotorError, match="places on the shaft"):
        modes.strain_energy_shares([0.0, 2.0])
    with pytest.raises(RotorError, match="places on the shaft"):
        modes.section_loads([1.2])


def test_in_a_free_rotor_the_shaft_alone_is_strained() -> None:
    modes = solve_whirl(SHAFT, [], 400.0, count=4)
    shares = modes.strain_energy_shares(SHAFT.joints)
    assert shares.bearings.shape == shares.pedestals.shape == (modes.frequencies.size, 0)
    np.testing.assert_allclose(shares.lengths.sum(axis=1), 1.0, rtol=1e-9)
