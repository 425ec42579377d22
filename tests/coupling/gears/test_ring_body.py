"""The elastic ring under a tooth against closed forms of rings and half planes, and against Sainsot's polynomials."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.errors import StiffnessModelError
from gearwhine.coupling.gears.stiffness import elastic_ring
from gearwhine.coupling.gears.stiffness import foundation as sainsot
from gearwhine.coupling.gears.stiffness.ring_body import (
    Annulus,
    neighbour_flexibility,
    rim_compliance,
    ring_compliance,
    root_flexibility,
)

NU = 0.3
STRESS, STRAIN = (3.0 - NU) / (1.0 + NU), 3.0 - 4.0 * NU
GEAR = Gear("wheel", 60, 3e-3, math.radians(20.0), 30e-3, bore=40e-3)


def ring(thickness: float) -> tuple[Annulus]:
    return (Annulus(1.0 / thickness, 1.0, 1.0),)


def waves_of(rings: tuple[Annulus, ...], count: int, kappa: float) -> np.ndarray:
    first, others = np.arange(1, 2), np.arange(2, count + 1)
    return np.concatenate([elastic_ring.wave_flexibility(rings, numbers, kappa) for numbers in (first, others)])


@pytest.mark.parametrize("kappa", [STRESS, STRAIN])
def test_short_waves_see_a_half_plane(kappa: float) -> None:
    # exp(i n x) on a half plane: 2 mu n u = (kappa + 1)/2 on the diagonal, (kappa - 1)/2 beside it.
    found = 4000.0 * elastic_ring._short_wave_flexibility(np.array([4000]), kappa)[0]
    np.testing.assert_allclose(np.diag(found), (kappa + 1.0) / 2.0, rtol=1e-3)
    np.testing.assert_allclose(abs(found[[0, 1], [1, 0]]), (kappa - 1.0) / 2.0, rtol=2e-3)


@pytest.mark.parametrize("thickness", [1.05, 1.5, 3.0])
def test_waves_obey_reciprocity_and_store_energy(thickness: float) -> None:
    flexibility = waves_of(ring(thickness), 60, STRESS)
    np.testing.assert_allclose(flexibility, np.swapaxes(flexibility, 1, 2), rtol=1e-9, atol=1e-12)
    assert np.all(np.linalg.eigvalsh(flexibility) > 0.0)
    long = elastic_ring._short_wave_flexibility(np.array([2000]), STRESS)
    np.testing.assert_allclose(
        elastic_ring.wave_flexibility(ring(thickness), np.array([2000]), STRESS), long, rtol=1e-9
    )


def test_uniform_tractions_are_lames_and_the_twist_of_a_tube() -> None:
    inner = 0.4
    # Lame: u = A r + B/r, held inside, s_r = 1 outside; 2 mu u with E = 1 in plane stress.
    modulus, shear = 1.0, 1.0 / (2.0 * (1.0 + NU))
    system = np.array([[inner, 1.0 / inner], [modulus / (1.0 - NU), -modulus / (1.0 + NU)]])
    a, b = np.linalg.solve(system, [0.0, 1.0])
    assert elastic_ring.breathing_flexibility(ring(1.0 / inner), STRESS) == pytest.approx(
        2.0 * shear * (a + b), rel=1e-12
    )
    assert elastic_ring.twist_flexibility(ring(1.0 / inner)) == pytest.approx(1.0 / inner**2 - 1.0, rel=1e-12)


def test_a_bonded_stamp_on_an_incompressible_half_plane_turns_by_a_known_angle() -> None:
    # nu = 1/2: bonded or smooth is the same, and a strip of width S turns by 16 (1 - nu^2)/pi M / (E S^2).
    theta, thickness, nu = 0.004, 3.0, 0.5
    arc = root_flexibility(ring(thickness), theta, nu, 1.0)
    twist = (1.0 + nu) / (2.0 * math.pi) * (thickness**2 - 1.0)
    turning = (arc.lateral[1, 1] - twist) * (2.0 * theta) ** 2
    assert turning == pytest.approx(16.0 / math.pi * (1.0 - nu**2), rel=5e-3)


@pytest.mark.parametrize("theta", [0.03, 0.12])
def test_more_shapes_and_waves_change_nothing(theta: float, monkeypatch: pytest.MonkeyPatch) -> None:
    # A force at one root thickness above the root circle.
    load = np.array([1.0, 1.0 + 2.0 * theta])
    coarse = root_flexibility(ring(2.0), theta, NU, STRESS)
    monkeypatch.setattr(elastic_ring, "_SHAPES", 16)
    monkeypatch.setattr(elastic_ring, "_WAVES_ACROSS", 240.0)
    monkeypatch.setattr(elastic_ring, "_POINTS", 300)
    fine = root_flexibility(ring(2.0), theta, NU, STRESS)
    assert load @ coarse.lateral @ load == pytest.approx(load @ fine.lateral @ load, rel=2e-3)
    assert coarse.radial == pytest.approx(fine.radial, rel=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("thickness", "theta"), [(2.0, 0.03), (2.0, 0.09), (3.0, 0.06), (5.0, 0.06)])
def test_sainsots_polynomials_are_the_middle_of_the_arc_in_plane_strain(thickness: float, theta: float) -> None:
    # Displacements where the tooth's axis meets the root circle under a linear normal, a constant shear and a constant
    # normal traction, by their Fourier series.  M is not found so: their coupling of shear and turning is larger.
    terms = np.array([theta**-2, thickness**2, thickness / theta, 1.0 / theta, thickness, 1.0])
    turning, _, shearing, radial = sainsot._COEFFICIENTS @ terms
    n = np.arange(1, 4000)
    flexibility = waves_of(ring(thickness), 3999, STRAIN)
    x, w = np.polynomial.legendre.leggauss(2000)
    t, w = theta * x, theta * w
    linear = -x / np.sum(w * x * t) * 2.0 * theta  # moment of one thickness
    constant = np.ones_like(t) / (2.0 * theta)
    odd = np.sin(np.outer(n, t)) @ (w * linear) / math.pi
    even = np.cos(np.outer(n, t)) @ (w * constant) / math.pi
    turn = -np.sum(n * flexibility[:, 0, 0] * odd) * 2.0 * theta
    shear = np.sum(flexibility[:, 1, 1] * even) + (thickness**2 - 1.0) / (2.0 * math.pi)
    push = np.sum(flexibility[:, 0, 0] * even) + elastic_ring.breathing_flexibility(ring(thickness), STRAIN) / (
        2.0 * math.pi
    )
    found = (1.0 + NU) * np.array([turn, shear, push])
    np.testing.assert_allclose(found, [turning, shearing, shearing * radial], rtol=0.04)


def test_a_web_as_wide_as_the_teeth_is_no_web() -> None:
    radius = np.linspace(GEAR.form_radius, GEAR.tip_radius, 4)
    plain = ring_compliance(GEAR)(radius)

    def share(web: float, rim: float) -> np.ndarray:
        return rim_compliance(replace(GEAR, web_thickness=web, rim_thickness=rim))(radius) / plain

    np.testing.assert_allclose(share(30e-3, 10e-3), 0.0, atol=1e-12)
    assert np.all(share(10e-3, 10e-3) > share(20e-3, 10e-3))
    assert np.all(share(10e-3, 5e-3) > share(10e-3, 10e-3))
    assert np.all(share(10e-3, 20e-3) > 0.0)
    np.testing.assert_array_equal(rim_compliance(GEAR)(radius), 0.0)
    # A rim alone is held at its inside.
    held = replace(GEAR, bore=2.0 * (GEAR.root_circle_radius - 15e-3))
    alone = replace(GEAR, rim_thickness=15e-3)
    np.testing.assert_allclose(ring_compliance(alone)(radius), ring_compliance(held)(radius))
    np.testing.assert_allclose(ring_compliance(replace(alone, bore=0.0))(radius), ring_compliance(held)(radius))


def test_a_thin_rim_on_a_thin_web_bends_like_a_curved_beam_on_an_elastic_foundation() -> None:
    # Winkler and Bernoulli: on a foundation of stiffness k per length a radial push in its middle yields
    # P / (8 E I lambda^3), lambda^4 = k / (4 E I): as k to the power -3/4.  Hoop tension is not in that.
    rim, web = Annulus(0.97, 1.0, 1.0), Annulus(0.5, 0.97, 0.004)
    yielding = root_flexibility((web, rim), 0.01, NU, STRESS).radial
    assert yielding > 5.0 * root_flexibility(ring(2.0), 0.01, NU, STRESS).radial
    thinner = root_flexibility((replace(web, width=0.002), rim), 0.01, NU, STRESS).radial
    assert math.log2(thinner / yielding) == pytest.approx(0.75, abs=0.12)


def test_a_web_inside_the_bore_is_refused() -> None:
    solid = replace(GEAR, bore=0.0, web_thickness=10e-3, rim_thickness=0.8 * GEAR.root_circle_radius)
    with pytest.raises(StiffnessModelError, match="leave out the rim"):
        rim_compliance(solid)(np.array([GEAR.pitch_radius]))


# --------------------------------------------------------------------------------------------- two arcs on one ring

TWO_RINGS = {
    "a ring": (Annulus(0.4, 1.0, 1.0),),
    "a rim on a web": (Annulus(0.4, 0.85, 0.25), Annulus(0.85, 1.0, 1.0)),
}


@pytest.mark.parametrize("rings", TWO_RINGS.values(), ids=TWO_RINGS)
def test_an_arc_on_itself_is_its_own_neighbour(rings: tuple[Annulus, ...]) -> None:
    own = root_flexibility(rings, 0.05, 0.3, 2.0)
    itself = neighbour_flexibility(rings, 0.05, 0.3, 2.0, 0.0)
    # Waves beyond the last, which do not reach another arc, are summed for the arc itself alone: some 1 %.
    np.testing.assert_allclose(itself[:2, :2], own.lateral, rtol=0.015)
    assert itself[2, 2] == pytest.approx(own.radial, rel=0.015)
    np.testing.assert_allclose(itself[2, :2], 0.0, atol=1e-12)


@pytest.mark.parametrize("rings", TWO_RINGS.values(), ids=TWO_RINGS)
@pytest.mark.parametrize("angle", [0.2, 0.5, 2.0, math.pi])
def test_two_arcs_work_on_each_other_alike(rings: tuple[Annulus, ...], angle: float) -> None:
    """Betti's theorem, the mirror's sign of a force along the axis, and energy that is positive for all loads."""
    there, back = (neighbour_flexibility(rings, 0.05, 0.3, 2.0, side * angle) for side in (1.0, -1.0))
    np.testing.assert_allclose(there, back.T, rtol=1e-10, atol=1e-12)
    mirror = np.diag([1.0, 1.0, -1.0])
    np.testing.assert_allclose(mirror @ there @ mirror, back, rtol=1e-10, atol=1e-12)
    own = root_flexibility(rings, 0.05, 0.3, 2.0)
    alone = np.zeros((3, 3))
    alone[:2, :2], alone[2, 2] = own.lateral, own.radial
    assert np.linalg.eigvalsh(np.block([[alone, there], [there.T, alone]])).min() > 0.0


def test_teeth_all_around_only_twist_the_ring() -> None:
    """Loads on arcs all around leave the uniform part: of a torque the twist, of a force across nothing."""
    rings, nu, count = (Annulus(0.4, 1.0, 1.0),), 0.3, 512  # more arcs than waves
    angles = 2.0 * math.pi * np.arange(count) / count
    mean = np.mean([neighbour_flexibility(rings, 0.2, nu, 2.0, float(angle)) for angle in angles], axis=0)
    assert mean[1, 1] == pytest.approx((1.0 + nu) / (2.0 * math.pi) * (0.4**-2 - 1.0), rel=1e-9)
    np.testing.assert_allclose([mean[0, 0], mean[0, 1], mean[1, 0], mean[1, 2]], 0.0, atol=1e-9)
