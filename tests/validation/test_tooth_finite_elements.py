"""Tooth compliance against a plane finite-element model of the whole gear, and the contact's dent with it.

The gear of NASA TM-104434, Table I (28 teeth, module 3.175 mm, bore 40 mm as in the bundled case), and the 62-tooth
gear of Ma et al. (2014): all teeth and fillets, quadratic triangles with curved edges, finest along the loaded flank
and its fillets, held at the bore.  The load is Hertz's pressure over a strip of 0.1 module, in the
direction of the line of action.

Under the load the surface sinks further than the tooth moves: a dent that a finer strip deepens without end.  It is no
part of a tooth's compliance.  The tooth's motion is read where the line of action crosses its axis; the rest is the
dent against that point, which Weber's formula for the same strip meets (a check of it, and of the choice).

Held at the bore, the ring twists: its share, ``rb^2 (1/r_i^2 - 1/r_f^2) / (4 pi G b)``, is in both models.

Two neighbouring teeth are loaded one after the other on the same mesh: what the load on one moves the next one's axis
is the cross compliance of the two. With it and Weber's contact, which the tool has too, the mesh of two pairs follows
from the compliance matrix of elements alone.

In plane strain slices cannot widen: the modulus along the plane is E / (1 - nu^2) in bending and compression, G is
unchanged, and Kolosov's constant of the ring is 3 - 4 nu.  The tooth model takes the same state as the elements.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from plane_gears import STRIP, Deflections, deflections, loaded_radii

from gearwhine.coupling.gears import (
    ElasticRingStiffness,
    Gear,
    GearPairGeometry,
    PotentialEnergyStiffness,
    loaded_transmission_error,
    mesh_stiffness,
    tooth_contact,
)
from gearwhine.coupling.gears.geometry.profile import flank_points, load_angle
from gearwhine.coupling.gears.stiffness.beam import PlaneState

pytestmark = pytest.mark.slow

ALPHA = math.radians(20.0)
RIG = Gear("28 teeth", 28, 3.175e-3, ALPHA, 6.35e-3, root_radius=1.35e-3, bore=40e-3)
MA = Gear("62 teeth", 62, 2e-3, ALPHA, 20e-3, bore=35e-3, youngs_modulus=206e9)


@dataclass(frozen=True)
class Solved:
    gear: Gear
    state: PlaneState
    radii: np.ndarray
    found: Deflections


@pytest.fixture(
    scope="module",
    params=[(gear, state) for gear in (RIG, MA) for state in ("plane-strain", "plane-stress")],
    ids=lambda case: f"{case[0].name}, {case[1]}",
)
def solved(request: pytest.FixtureRequest) -> Solved:
    gear, state = request.param
    radii = loaded_radii(gear)
    return Solved(gear, state, radii, deflections(gear, radii, state=state))


def test_tooth_compliance_along_the_profile(solved: Solved, published: Any, remark: Any) -> None:
    model = ElasticRingStiffness(solved.state).tooth(solved.gear, solved.radii).total
    source = "Plane finite elements of our own, gmsh and scikit-fem"
    remark(
        source,
        "Not published, but independent: a tooth and its body under loads from the start of the active profile to the "
        "tip. The finite-element value stands as published, the energy method on an elastic ring as ours.",
    )
    for radius, value, ours in zip(solved.radii, solved.found.axis, model, strict=True):
        quantity = f"tooth compliance, {solved.gear.teeth} teeth, {solved.state}, at radius {1e3 * radius:.2f} mm"
        published(source, quantity, 1e12 * value, 1e12 * ours, "pm/N", rel=0.1)


def test_the_published_body_is_softer(solved: Solved) -> None:
    # What the elastic ring mends: Sainsot's body with the lever to the flank is beyond the bar above.
    softer = PotentialEnergyStiffness("trochoid").tooth(solved.gear, solved.radii).total / solved.found.axis - 1.0
    assert np.all((softer > 0.07) & (softer < 0.35))
    assert softer.max() > 0.1


def test_what_the_surface_sinks_more_is_webers_dent(solved: Solved) -> None:
    gear, radii, found = solved.gear, solved.radii, solved.found
    if solved.state == "plane-stress":
        return  # the formula is of plane strain
    beta = load_angle(gear, radii)
    depth = flank_points(gear, beta).half_thickness / np.cos(beta)
    nu = gear.poisson_ratio
    # Weber's is of the middle of the strip.  Under Hertz's pressure the surface rises from there as (x/a)^2, in the
    # mean over the pressure by a quarter.  A tooth is no half plane: it dents some tenth more.
    dent = np.log(2.0 * depth / (STRIP * gear.module)) - 0.5 * nu / (1.0 - nu) - 0.25
    dent *= 2.0 * (1.0 - nu**2) / (math.pi * gear.youngs_modulus * gear.face_width)
    np.testing.assert_allclose(found.surface - found.axis, dent, rtol=0.13)


@pytest.mark.parametrize("rim", [3e-3, 9e-3])
def test_a_rim_on_a_web_yields_what_elements_of_two_widths_do(rim: float) -> None:
    # In the plane: a web of a quarter of the face, one and three modules below the root.
    gear = replace(RIG, rim_thickness=rim, web_thickness=0.25 * RIG.face_width)
    radii = loaded_radii(gear, 4)
    found = deflections(gear, radii, state="plane-stress").axis
    tooth = ElasticRingStiffness().tooth(gear, radii)
    assert np.all(tooth.rim > 0.1 * tooth.total)  # or nothing would be tried
    np.testing.assert_allclose(tooth.total, found, rtol=0.05)


def test_the_mesh_is_fine_enough() -> None:
    radii = loaded_radii(RIG, 5)
    coarse, medium, fine = (deflections(RIG, radii, fineness) for fineness in (2.0, 1.4, 0.9))
    assert coarse.dofs < medium.dofs < fine.dofs
    first, second = (np.max(np.abs(mesh.axis / fine.axis - 1.0)) for mesh in (coarse, medium))
    assert second < 5e-4
    assert first < 2e-3


# --------------------------------------------------------------------------------------------- two teeth on one body


def fifty(bore: float) -> Gear:
    return Gear("50 teeth", 50, 3e-3, ALPHA, 20e-3, bore=bore)


PAIRS = {
    "28/28, bore 40 mm": GearPairGeometry(RIG, RIG),
    "50/50, bore 30 mm": GearPairGeometry(fifty(30e-3), fifty(30e-3)),
    "50/50, bore 40 mm": GearPairGeometry(fifty(40e-3), fifty(40e-3)),
    "50/50, bore 80 mm": GearPairGeometry(fifty(80e-3), fifty(80e-3)),
    "24/60, bores 25 and 50 mm": GearPairGeometry(
        Gear("24 teeth", 24, 3e-3, ALPHA, 20e-3, bore=25e-3), Gear("60 teeth", 60, 3e-3, ALPHA, 20e-3, bore=50e-3)
    ),
}
LINE_LOAD = 300e3
"""At which Weber's contact is taken, of the elements and of the tool [N/m]."""


@dataclass(frozen=True)
class MeshOfElements:
    """Mesh compliance [m/N] at phases with two pairs and with one."""

    two: np.ndarray
    one: np.ndarray
    phases_two: np.ndarray
    phases_one: np.ndarray


@pytest.fixture(scope="module", params=PAIRS, ids=str)
def two_teeth(request: pytest.FixtureRequest) -> tuple[str, GearPairGeometry, MeshOfElements]:
    pair = PAIRS[request.param]
    eps = pair.contact_ratio
    two = np.linspace(0.1, eps - 1.1, 3)  # the strip of the load stays below the tips
    one = np.linspace(eps - 0.95, 0.95, 3)
    places = np.concatenate([two, two + 1.0, one])
    driver = deflections(pair.driver, pair.driver_radius(places), 2.0, "plane-stress")
    driven = deflections(pair.driven, pair.driven_radius(places), 2.0, "plane-stress")
    own = driver.axis + driven.axis + ElasticRingStiffness().contact_compliance(pair, places)
    first, second = np.arange(3), np.arange(3, 6)
    # The driver is pushed back: its next tooth in that sense entered later.
    cross = driver.next_axis[second, first] + driven.next_axis[first, second]
    a, b = own[first], own[second]
    found = (a * b - cross**2) / (a + b - 2.0 * cross)
    return request.param, pair, MeshOfElements(found, own[6:], two, one)


def test_two_pairs_on_the_same_bodies(two_teeth: Any, published: Any, remark: Any) -> None:
    name, pair, elements = two_teeth
    contact = tooth_contact(pair, ElasticRingStiffness())
    source = "Plane finite elements of whole gears with two teeth loaded, of our own"
    remark(
        source,
        "Not published, but independent: compliance matrices of neighbouring teeth from whole gears in plane stress, "
        "held at their bores. The finite-element value stands as published, the contact law as ours. The step is that "
        "of the transmission error from two pairs to one under 300 N/mm.",
    )
    force = LINE_LOAD * pair.face_width
    stiffness = 1.0 / elements.two.mean()
    ours = 1.0 / np.mean(1.0 / mesh_stiffness(contact, elements.phases_two))
    published(source, f"stiffness of two pairs, {name}", 1e-6 * stiffness, 1e-6 * ours, "MN/m", rel=0.06)
    step = force * (elements.one.mean() - elements.two.mean())
    error = loaded_transmission_error(contact, force, np.concatenate([elements.phases_two, elements.phases_one]))
    ours = float(error.transmission_error[3:].mean() - error.transmission_error[:3].mean())
    published(source, f"step of the transmission error, {name}", 1e6 * step, 1e6 * ours, "µm", rel=0.15)
    # Bodies of their own are far beyond both bars.
    apart = replace(contact, shared_compliance=0.0)
    assert np.all(mesh_stiffness(apart, elements.phases_two) * elements.two > 1.1)


@pytest.mark.parametrize("bore", [10e-3, 30e-3, 80e-3])
def test_the_swing_of_the_error_does_not_know_the_bore(bore: float) -> None:
    """Under a constant torque the twist about the bore is constant."""
    pair, other = (GearPairGeometry(fifty(size), fifty(size)) for size in (bore, 40e-3))
    swings = [
        loaded_transmission_error(tooth_contact(p, ElasticRingStiffness()), 6000.0).peak_to_peak_transmission_error
        for p in (pair, other)
    ]
    assert swings[0] == pytest.approx(swings[1], rel=0.02)
