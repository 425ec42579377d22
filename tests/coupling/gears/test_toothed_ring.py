"""The ring under internal teeth and its support, against closed forms and limits, and all models of internal pairs."""

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from gearwhine.coupling.gears import (
    ElasticRingStiffness,
    Gear,
    GearPairGeometry,
    loaded_transmission_error,
    stiffness_model,
    tooth_contact,
)
from gearwhine.coupling.gears.errors import GearError
from gearwhine.coupling.gears.geometry.ring_support import RingSupport
from gearwhine.coupling.gears.stiffness import toothed_ring
from gearwhine.coupling.gears.stiffness.elastic_ring import (
    Annulus,
    neighbour_flexibility,
    root_flexibility,
    twist_flexibility,
)
from gearwhine.coupling.gears.stiffness.elastic_tooth import tooth_flexibility
from gearwhine.coupling.gears.stiffness.hertz import line_contact
from gearwhine.coupling.gears.stiffness.iso6336 import iso6336_stiffness
from gearwhine.coupling.gears.stiffness.rim_on_hub import rotation_shares, shift_compliance, shift_shares
from gearwhine.coupling.gears.stiffness.ring_body import support_compliance, twist_compliance
from gearwhine.coupling.gears.stiffness.toothed_ring import RingSection, ring_flexibility

NU = 0.3
STRESS = (3.0 - NU) / (1.0 + NU)
ALPHA = math.radians(20.0)
PINION = Gear("pinion", 28, 3e-3, ALPHA, 20e-3, profile_shift=0.3, bore=30e-3)
RING = Gear("ring", -82, 3e-3, ALPHA, 20e-3, profile_shift=-0.3, addendum=0.8, rim_thickness=10e-3)
BOLTS = RingSupport("bolts", 6, 15e-3)


def section(teeth: int, half_angle: float, outside: float, **more: Any) -> RingSection:
    """A ring with rectangular teeth as high as wide."""
    side = ((1.0, half_angle), (1.0 - half_angle, half_angle), (1.0 - 2.0 * half_angle, half_angle))
    return RingSection(teeth, half_angle, outside, side, NU, STRESS, **more)


def bolted(support: RingSupport) -> Gear:
    return replace(RING, ring_support=support)


def test_a_bore_far_inside_an_unbounded_plate_breathes_as_lame_says() -> None:
    # Internal pressure p moves the edge of a hole by p r / (2 mu) outward; held far away.
    held = root_flexibility((Annulus(1e3, 1.0, 1.0),), 0.05, NU, STRESS)
    assert held.radial > 0.0
    ring = (Annulus(1e3, 1.0, 1.0),)
    found = toothed_ring.breathing_flexibility(ring, STRESS)
    assert found == pytest.approx(1.0, rel=1e-5)


@pytest.mark.parametrize("outside", [1.05, 1.3, 3.0])
def test_an_inner_circle_turns_as_the_torque_asks(outside: float) -> None:
    # 2 mu u_t = s_rt r^3 (1/a^2 - 1/b^2): the same between two circles whichever is loaded.
    assert twist_flexibility((Annulus(outside, 1.0, 1.0),)) == pytest.approx(1.0 - outside**-2, rel=1e-12)


@pytest.mark.parametrize("b", [1.1, 1.3, 3.0])
def test_a_free_ring_breathes_as_lame_says(b: float) -> None:
    """Under a pressure p within the radius 1, and under a tension p around the radius b, each by p times its radius.

    2 mu u_r = p / (b^2 - 1) ((kappa - 1) r / 2 + b^2 / r), and p b^2 / (b^2 - 1) ((kappa - 1) r / 2 + 1 / r).
    """
    found = toothed_ring._free_ring(section(16, 0.01, b), 3)[0, ::2, ::2].real
    even = (STRESS - 1.0) / 2.0
    inside = [even + b**2, even * b + b]
    outside = [(even + 1.0) * b, even * b**2 + 1.0]
    np.testing.assert_allclose(found, np.array([inside, outside]).T / (b**2 - 1.0), rtol=1e-12)


@pytest.mark.parametrize("outside", [1.2, 3.0])
def test_few_narrow_teeth_are_arcs_alone(monkeypatch: pytest.MonkeyPatch, outside: float) -> None:
    """With teeth as rigid as stamps and far apart the ring is that of a single arc, and of two."""
    monkeypatch.setattr(toothed_ring, "tooth_flexibility", lambda *_: 0.0)
    found = ring_flexibility.__wrapped__(section(16, 0.01, outside))
    rings = (Annulus(outside, 1.0, 1.0),)
    alone = root_flexibility(rings, 0.01, NU, STRESS)
    np.testing.assert_allclose(found.own[0][:2, :2], alone.lateral, rtol=2e-3)
    assert found.own[0, 2, 2] == pytest.approx(alone.radial, rel=2e-3)
    beside = neighbour_flexibility(rings, 0.01, NU, STRESS, math.pi / 8.0)
    # The sum over the waves ends elsewhere.
    np.testing.assert_allclose(found.beside[0], beside, atol=1e-6 * alone.lateral.max())


def test_an_unloaded_tooth_yields_to_what_has_no_resultant() -> None:
    """No resultant of a load works on it, none of its energy is negative, and a half plane is somewhat stiffer."""
    theta = 0.04
    resultants = toothed_ring._resultants(toothed_ring.arc_waves(theta, 1)[1], theta)
    radius, angle = np.linspace(1.0, 0.92, 60), np.full(60, theta)
    flexibility = tooth_flexibility(radius, angle, STRESS, resultants)
    assert np.linalg.eigvalsh(flexibility).min() > -1e-12 * np.linalg.norm(flexibility)
    # Of a half plane under the traction T_1 / sqrt(1 - x^2), 2 mu times the work is pi theta^2 (kappa + 1) / 4.
    stretch = flexibility[9, 9]
    assert 0.25 * math.pi * theta**2 * (STRESS + 1.0) < stretch < 0.6 * math.pi * theta**2 * (STRESS + 1.0)
    # The tractions of a beam's root do no work: linear normal stress, and shear as a parabola.
    places = np.cos(math.pi * (np.arange(400) + 0.5) / 400)
    for first, traction in ((0, places), (8, 1.0 - places**2)):
        beam = np.zeros(16)
        for k in range(8):
            weight = (1.0 if k == 0 else 2.0) * np.sqrt(1.0 - places**2)
            beam[first + k] = np.mean(weight * traction * np.cos(k * np.arccos(places)))
        assert abs(beam @ flexibility @ beam) < 1e-6 * (beam @ beam) * stretch


def test_seats_all_around_clamp_the_ring() -> None:
    clamped = ring_flexibility(section(24, 0.1, 1.6))
    around = ring_flexibility(section(24, 0.1, 1.6, bolts=8, seat=math.radians(22.47)))
    for name in ("own", "beside"):
        ours, theirs = getattr(around, name).mean(axis=0), getattr(clamped, name)[0]
        np.testing.assert_allclose(ours, theirs, atol=0.01 * np.abs(theirs).max())
    assert around.twist == pytest.approx(clamped.twist, rel=0.01)


@pytest.mark.parametrize("kind", ["springs", "bolts", "pins"])
def test_on_soft_springs_the_ring_is_rigid(kind: str) -> None:
    radial, tangential = 2e5, 5e5
    if kind == "springs":
        gear = bolted(RingSupport("springs", radial_stiffness=6 * radial, tangential_stiffness=6 * tangential))
    else:
        gear = bolted(RingSupport(kind, 6, 2e-3, radial, tangential))  # type: ignore[arg-type]
    lever = gear.base_radius / gear.rim_outer_radius
    assert twist_compliance(gear) == pytest.approx(lever**2 / (6 * tangential), rel=2e-3)
    # Half of the springs' stiffness of each kind is along a shift.
    assert shift_compliance(gear, "plane-stress") == pytest.approx(1.0 / (3 * (radial + tangential)), rel=5e-3)
    for shares in (rotation_shares(gear), shift_shares(gear, "plane-stress")):
        np.testing.assert_allclose(shares, 1.0, rtol=3e-3)


def ring_of_beams(radius: float, height: float, pins: int, place: float, count: int = 360) -> float:
    """Radial deflection by a radial force, times E and width, of a ring of straight beams, at an angle from a pin."""
    angle = 2.0 * math.pi / count * np.arange(count)
    points = radius * np.array([np.cos(angle), np.sin(angle)]).T
    stiffness = np.zeros((3 * count, 3 * count))
    for first in range(count):
        second = (first + 1) % count
        along = points[second] - points[first]
        length = float(np.hypot(*along))
        c, s = along / length
        area, bend = height / length, height**3 / 12.0 / length**3
        local = np.zeros((6, 6))
        local[np.ix_([0, 3], [0, 3])] = area * np.array([[1, -1], [-1, 1]])
        local[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = bend * np.array(
            [
                [12, 6 * length, -12, 6 * length],
                [6 * length, 4 * length**2, -6 * length, 2 * length**2],
                [-12, -6 * length, 12, -6 * length],
                [6 * length, 2 * length**2, -6 * length, 4 * length**2],
            ]
        )
        turn = np.kron(np.eye(2), np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))
        dofs = np.concatenate([3 * first + np.arange(3), 3 * second + np.arange(3)])
        stiffness[np.ix_(dofs, dofs)] += turn.T @ local @ turn
    # A pin holds the outer fibre: its beam's node moves with the rotation alone.
    motions = np.eye(3 * count)
    for node in count // pins * np.arange(pins):
        motions[3 * node, 3 * node + 2] = 0.5 * height * math.sin(angle[node])
        motions[3 * node + 1, 3 * node + 2] = -0.5 * height * math.cos(angle[node])
    motions = np.delete(motions, [3 * node + k for node in count // pins * np.arange(pins) for k in (0, 1)], axis=1)
    load = np.zeros(3 * count)
    node = round(place / (2.0 * math.pi) * count)
    load[3 * node : 3 * node + 2] = np.cos(angle[node]), np.sin(angle[node])
    return float(load @ motions @ np.linalg.solve(motions.T @ stiffness @ motions, motions.T @ load))


@pytest.mark.parametrize("step", [6, 12])
def test_a_thin_smooth_ring_on_pins_bends_as_beams_do(monkeypatch: pytest.MonkeyPatch, step: int) -> None:
    """Four pins, a radial force a quarter and half of the way between two of them, on arcs that are hardly wide."""
    monkeypatch.setattr(toothed_ring, "tooth_flexibility", lambda *_: 0.0)
    outside = 1.04
    found = ring_flexibility.__wrapped__(section(8, 0.01, outside, bolts=4, seat=0.01, pinned=True))
    place = 0.5 * math.pi * step / len(found.own)
    beams = ring_of_beams(0.5 * (1.0 + outside), outside - 1.0, 4, place)
    assert found.own[step, 2, 2] == pytest.approx(beams, rel=0.04)


def test_the_course_between_bolts_has_the_harmonics_of_their_number() -> None:
    gear, radius = bolted(BOLTS), np.array([RING.pitch_radius])
    mean = support_compliance(gear).own(radius)
    pitch = math.pi / 3.0
    course = np.array([support_compliance(gear, place=place).own(radius)[0] for place in np.linspace(0.0, pitch, 25)])
    assert course[0] == pytest.approx(course[-1], rel=1e-12)
    assert np.mean(course[:-1]) == pytest.approx(float(mean[0]), rel=1e-9)
    assert course.max() > 1.5 * course.min() > 0.0
    # Stiffest at a bolt; not symmetric about the middle, since a load has a sense.
    assert min(range(24), key=course.__getitem__) in (0, 1, 23)
    assert abs(course[6] - course[18]) > 0.01 * course[6]


def test_more_support_is_stiffer() -> None:
    radius = np.array([RING.pitch_radius])
    order = [
        bolted(RingSupport("pins", 3, 15e-3)),
        bolted(RingSupport("pins", 6, 15e-3)),
        bolted(BOLTS),
        bolted(RingSupport("housing")),
    ]
    values = [float(ElasticRingStiffness().tooth(gear, radius).total[0]) for gear in order]
    assert all(softer > stiffer for softer, stiffer in pairwise(values))
    soft = bolted(replace(BOLTS, radial_stiffness=1e9, tangential_stiffness=1e9))
    assert ElasticRingStiffness().tooth(soft, radius).total[0] > values[2]
    assert values[-1] == ElasticRingStiffness().tooth(RING, radius).total[0]


# ------------------------------------------------------------------------------------------------------------- pairs


@pytest.mark.parametrize("name", ["potential-energy", "elastic-ring", "cornell", "weber-banaschek", "iso6336"])
@pytest.mark.parametrize("ring", [RING, bolted(BOLTS)], ids=["clamped", "bolted"])
def test_all_models_take_internal_pairs(name: str, ring: Gear) -> None:
    pair, back = GearPairGeometry(PINION, ring), GearPairGeometry(ring, PINION)
    model = stiffness_model(name)
    stiffness = model.pair_stiffness(pair)
    places = np.linspace(0.05, pair.contact_ratio - 0.05, 9)
    values = stiffness(places)
    assert np.all((values > 2e9 * pair.face_width) & (values < 25e9 * pair.face_width))
    # The ring drives: the same pairs in the opposite order.
    np.testing.assert_allclose(model.pair_stiffness(back)(pair.contact_ratio - places), values, rtol=1e-7)
    error = loaded_transmission_error(tooth_contact(pair, model), 6000.0)
    assert error.peak_to_peak_transmission_error > 0.0


def test_the_norm_takes_the_reciprocal_of_an_internal_gears_teeth_as_zero() -> None:
    pair = GearPairGeometry(PINION, RING)
    z1, x1, x2 = 28, 0.3, -0.3
    flexibility = 0.04723 + 0.15551 / z1 - 0.00635 * x1 - 0.11654 * x1 / z1 - 0.00193 * x2
    flexibility += 0.00529 * x1**2 + 0.00182 * x2**2
    norm = iso6336_stiffness(pair)
    assert norm.theoretical == pytest.approx(1e9 / flexibility, rel=1e-12)
    rack = (1.0 + 0.5 * (1.2 - 1.25)) * (207.0 / 206.0)
    assert norm.single_pair == pytest.approx(0.8 * 1e9 / flexibility * rack, rel=1e-3)
    assert iso6336_stiffness(GearPairGeometry(RING, PINION)) == norm


def test_convex_and_concave_flanks_touch_over_the_difference_of_their_curvatures() -> None:
    pair = GearPairGeometry(PINION, RING)
    place = np.array([pair.pitch_point_position])
    w = pair.working_pressure_angle
    of_pinion, of_ring = PINION.base_radius * math.tan(w), -RING.base_radius * math.tan(w)
    contact = line_contact(pair, place)
    assert contact.curvature_radius[0] == pytest.approx(1.0 / (1.0 / of_pinion - 1.0 / of_ring), rel=1e-9)
    assert np.all(contact.depths > 0.0)


def test_helical_rings_are_the_limit_of_spur_ones_and_bend_in_their_transverse_section() -> None:
    model, radius = ElasticRingStiffness(), np.array([RING.pitch_radius])
    slight = replace(bolted(BOLTS), helix_angle=1e-4)
    spur = GearPairGeometry(PINION, bolted(BOLTS))
    helical = GearPairGeometry(replace(PINION, helix_angle=1e-4), slight)
    middle = 0.5 * spur.contact_ratio
    assert model.pair_compliance(helical, middle) == pytest.approx(float(model.pair_compliance(spur, middle)), rel=1e-4)
    steep = replace(bolted(BOLTS), helix_angle=math.radians(20.0), module=3e-3 * math.cos(math.radians(20.0)))
    ratio = support_compliance(steep).own(np.array([steep.pitch_radius])) / support_compliance(bolted(BOLTS)).own(
        radius
    )
    assert 0.8 < float(ratio[0]) < 1.2


def test_what_pairs_share_includes_the_support() -> None:
    model = ElasticRingStiffness()
    clamped, held = (GearPairGeometry(PINION, gear) for gear in (RING, bolted(BOLTS)))
    added = model.shared_compliance(held) - model.shared_compliance(clamped)
    radius = np.array([RING.pitch_radius])
    assert added == pytest.approx(float(support_compliance(bolted(BOLTS)).beside(radius, radius)[0]), rel=0.1)
    np.testing.assert_allclose(model.shared_over_face(held), model.shared_over_face(clamped))
    rim = model.rim_compliances(held)[1]
    assert 0.0 < rim.twist + rim.shift <= model.shared_compliance(held)


def test_shares_of_a_clamped_rings_inertia() -> None:
    """Against quadrature of the static rotation ``(1/r^2 - 1/b^2) / (1/a^2 - 1/b^2)`` over the blank."""
    a, b, pitch = -RING.root_circle_radius, RING.outer_radius, -RING.pitch_radius
    r = np.linspace(a, b, 20001)
    s = (r**-2 - b**-2) / (a**-2 - b**-2)
    teeth = 0.25 * (a**4 - pitch**4)
    whole = teeth + np.trapezoid(r**3, r)
    shares = rotation_shares(RING)
    assert shares.coupling == pytest.approx((teeth + np.trapezoid(s * r**3, r)) / whole, rel=1e-7)
    assert shares.rim == pytest.approx((teeth + np.trapezoid(s**2 * r**3, r)) / whole, rel=1e-7)


def test_shares_of_a_ring_on_springs() -> None:
    """The outside turns by the springs' part; the ring between is as a smooth one, within what its teeth stiffen it."""
    stiffness = 1e11
    gear = bolted(RingSupport("springs", radial_stiffness=stiffness, tangential_stiffness=stiffness))
    a, b, pitch = -RING.root_circle_radius, RING.outer_radius, -RING.pitch_radius
    shear = RING.youngs_modulus / (2.0 * (1.0 + RING.poisson_ratio))
    r = np.linspace(a, b, 20001)
    rotation = 1.0 / (stiffness * b**2) + (r**-2 - b**-2) / (4.0 * math.pi * shear * RING.face_width)
    s = rotation / rotation[0]
    assert 0.2 < s[-1] < 0.8  # or nothing would be tried
    teeth = 0.25 * (a**4 - pitch**4)
    whole = teeth + np.trapezoid(r**3, r)
    shares = rotation_shares(gear)
    assert shares.coupling == pytest.approx((teeth + np.trapezoid(s * r**3, r)) / whole, rel=0.01)
    assert shares.rim == pytest.approx((teeth + np.trapezoid(s**2 * r**3, r)) / whole, rel=0.01)


@pytest.mark.parametrize(
    ("words", "values"),
    [
        ("kind is 'glued'; expected one of", {"kind": "glued"}),
        ("count is 'None'; expected a value beside kind = 'bolts'", {"kind": "bolts", "seat_width": 10e-3}),
        ("count is 1; expected a whole number of at least 2", {"kind": "pins", "count": 1, "seat_width": 10e-3}),
        (
            "tangential_stiffness is 'None'; expected a value beside kind = 'springs'",
            {"kind": "springs", "radial_stiffness": 1e9},
        ),
        ("count is 6; expected none beside kind = 'clamped'", {"kind": "clamped", "count": 6}),
        ("seat_width is 0; expected .* above 0", {"kind": "bolts", "count": 6, "seat_width": 0.0}),
    ],
)
def test_bad_supports_are_refused(words: str, values: dict[str, Any]) -> None:
    with pytest.raises(GearError, match=words):
        RingSupport(**values)


def test_supports_that_do_not_fit_are_refused() -> None:
    with pytest.raises(
        GearError, match=r"ring_support.seat_width is 0.2; expected below .* mm, as 6 seats stand around"
    ):
        bolted(replace(BOLTS, seat_width=0.2))
    with pytest.raises(GearError, match=r"ring_support is .*; expected none of an external gear"):
        replace(PINION, ring_support=RingSupport("clamped"))
