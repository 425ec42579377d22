"""Rims of gears on their hubs, against own models with elastic annuli, shafts and bearings."""

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy import linalg

from gearwhine.coupling import CoupledMachine, Machine, MountedBearing, Shaft, ShaftGear, static_equilibrium
from gearwhine.coupling.gears import Gear, SquareStiffness, loaded_transmission_error
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.gears.stiffness.rim_on_hub import rotation_shares, shift_compliance, shift_shares
from gearwhine.coupling.machine.components import _kinds, rotor_component
from gearwhine.coupling.statics.mean_mesh import mean_meshes
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial

E, NU, DENSITY = 207e9, 0.3, 7850.0
G = E / (2.0 * (1.0 + NU))
STEEL = ShaftMaterial.from_poisson_ratio(E, NU, DENSITY)
HALF, BEARING, RINGS, ANGLE = 0.06, 5e8, 20, math.radians(20.0)


def gear(name: str, teeth: int, module: float, width: float, bore: float, **more: float) -> Gear:
    return Gear(
        name,
        teeth,
        module,
        math.radians(20.0),
        width,
        bore=bore,
        youngs_modulus=E,
        poisson_ratio=NU,
        density=DENSITY,
        **more,  # type: ignore[arg-type]
    )


def pair_machine(wheels: tuple[Gear, Gear], **more: object) -> Machine:
    """Two shafts as thick as the bores, on two bearings each, with the gears in their middles."""
    apart = 0.5 * wheels[0].module * (wheels[0].teeth + wheels[1].teeth)
    shafts = [
        Shaft(Rotor(name, [Segment(HALF, wheel.bore, 0.0, STEEL)] * 2), (at, 0.0))
        for name, wheel, at in zip(("in", "out"), wheels, (0.0, apart), strict=True)
    ]
    held = [
        MountedBearing(Bearing(f"{name} {at}", at, BEARING * np.eye(2), np.zeros((2, 2))), name, None)
        for name in ("in", "out")
        for at in (0.0, 2.0 * HALF)
    ]
    gears = [
        ShaftGear(wheel, name, HALF, stiffens_shaft=False) for wheel, name in zip(wheels, ("in", "out"), strict=True)
    ]
    pair = GearPair(wheels[0].name, wheels[1].name, **more)  # type: ignore[arg-type]
    return Machine(shafts, held, gears, [pair], speed=1.0, torque=200.0)


def circles(wheel: Gear) -> tuple[FloatArray, FloatArray]:
    """Radii of the nodes of quadratic elements of the body, and the elements' widths [m]."""
    inner, outer = 0.5 * wheel.bore, wheel.root_circle_radius
    inside, web = wheel.rim_inner_radius or inner, wheel.web_thickness or wheel.face_width
    ends = np.unique(np.concatenate([np.linspace(inner, inside, RINGS), np.linspace(inside, outer, RINGS)]))
    r = np.zeros(2 * ends.size - 1)
    r[::2], r[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
    return r, np.where(r[1::2] > inside, wheel.face_width, web)


def annulus(wheel: Gear) -> tuple[FloatArray, FloatArray]:
    """In-plane torsion of the body between bore and root circle, by the rotations of its circles: K and M.

    Quadratic elements of the displacement u; the shear strain is u' - u/r. The teeth are rigid on the root circle.
    """
    r, widths = circles(wheel)
    stiffness, mass = np.zeros((r.size, r.size)), np.zeros((r.size, r.size))
    points, weights = np.polynomial.legendre.leggauss(5)
    for element, width in enumerate(widths):
        here = slice(2 * element, 2 * element + 3)
        h = 0.5 * (r[here][2] - r[here][0])
        for x, weight in zip(points, weights, strict=True):
            shape = np.array([0.5 * x * (x - 1.0), 1.0 - x**2, 0.5 * x * (x + 1.0)])
            slope = np.array([x - 0.5, -2.0 * x, x + 0.5]) / h
            at = shape @ r[here]
            strain = slope - shape / at
            area = 2.0 * math.pi * at * width * weight * h
            stiffness[here, here] += G * area * np.outer(strain, strain)
            mass[here, here] += DENSITY * area * np.outer(shape, shape)
    stiffness, mass = r[:, None] * stiffness * r, r[:, None] * mass * r
    mass[-1, -1] += 0.5 * math.pi * DENSITY * wheel.face_width * (wheel.pitch_radius**4 - r[-1] ** 4)
    return stiffness, mass


def rod(diameter: float, elements: int) -> tuple[FloatArray, FloatArray]:
    """Torsion of the shaft by linear elements."""
    h, polar = 2.0 * HALF / elements, math.pi / 32.0 * diameter**4
    stiffness, mass = np.zeros((elements + 1,) * 2), np.zeros((elements + 1,) * 2)
    for n in range(elements):
        here = slice(n, n + 2)
        stiffness[here, here] += G * polar / h * np.array([[1.0, -1.0], [-1.0, 1.0]])
        mass[here, here] += DENSITY * polar * h / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    return stiffness, mass


def beam(diameter: float, elements: int) -> tuple[FloatArray, FloatArray]:
    """Timoshenko beam by displacement and slope: stiffness of two-node elements, mass of cubic Hermite ones."""
    h, area, second = 2.0 * HALF / elements, math.pi / 4.0 * diameter**2, math.pi / 64.0 * diameter**4
    kappa = 6.0 * (1.0 + NU) / (7.0 + 6.0 * NU)
    phi = 12.0 * E * second / (kappa * G * area * h**2)
    bent = np.array(
        [
            [12.0, 6.0 * h, -12.0, 6.0 * h],
            [6.0 * h, (4.0 + phi) * h**2, -6.0 * h, (2.0 - phi) * h**2],
            [-12.0, -6.0 * h, 12.0, -6.0 * h],
            [6.0 * h, (2.0 - phi) * h**2, -6.0 * h, (4.0 + phi) * h**2],
        ]
    ) * (E * second / ((1.0 + phi) * h**3))
    # Displacement and slope linear over short elements.
    linear = np.array([[2.0, 1.0], [1.0, 2.0]]) * h / 6.0
    heavy = np.zeros((4, 4))
    heavy[np.ix_([0, 2], [0, 2])] = DENSITY * area * linear
    heavy[np.ix_([1, 3], [1, 3])] = DENSITY * second * linear
    stiffness, mass = np.zeros((2 * elements + 2,) * 2), np.zeros((2 * elements + 2,) * 2)
    for n in range(elements):
        here = slice(2 * n, 2 * n + 4)
        stiffness[here, here] += bent
        mass[here, here] += heavy
    return stiffness, mass


def wave_across(wheel: Gear) -> tuple[FloatArray, FloatArray]:
    """In-plane motion (U cos t, V sin t) of the body on a hub that moves along t = 0, in plane stress: K and M.

    The first coordinate is the hub's motion, the others are U and V of each circle outward, those of the root circle
    last. The teeth are a ring of mass on it.
    """
    r, widths = circles(wheel)
    stiffness, mass = np.zeros((2 * r.size,) * 2), np.zeros((2 * r.size,) * 2)
    elastic = E / (1.0 - NU**2) * np.array([[1.0, NU, 0.0], [NU, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - NU)]])
    points, weights = np.polynomial.legendre.leggauss(5)
    for element, width in enumerate(widths):
        here, own = slice(2 * element, 2 * element + 3), slice(4 * element, 4 * element + 6)
        h = 0.5 * (r[here][2] - r[here][0])
        for x, weight in zip(points, weights, strict=True):
            shape = np.array([0.5 * x * (x - 1.0), 1.0 - x**2, 0.5 * x * (x + 1.0)])
            slope = np.array([x - 0.5, -2.0 * x, x + 0.5]) / h
            at = shape @ r[here]
            strain, moved = np.zeros((3, 6)), np.zeros((2, 6))
            strain[0, ::2], strain[1, ::2], strain[1, 1::2] = slope, shape / at, shape / at
            strain[2, ::2], strain[2, 1::2] = -shape / at, slope - shape / at
            moved[0, ::2], moved[1, 1::2] = shape, shape
            area = math.pi * at * width * weight * h
            stiffness[own, own] += area * strain.T @ elastic @ strain
            mass[own, own] += DENSITY * area * moved.T @ moved
    teeth = 0.5 * math.pi * DENSITY * wheel.face_width * (wheel.pitch_radius**2 - r[-1] ** 2)
    mass[-2:, -2:] += teeth * np.eye(2)
    hub = np.zeros((2 * r.size, 2 * r.size - 1))
    hub[0, 0], hub[1, 0] = 1.0, -1.0
    hub[2:, 1:] = np.eye(2 * r.size - 2)
    return hub.T @ stiffness @ hub, hub.T @ mass @ hub


def joined(shaft: tuple[FloatArray, FloatArray], node: int, body: tuple[FloatArray, FloatArray]) -> list[FloatArray]:
    """Join the first coordinate of a body to a coordinate of a shaft: K and M, the shaft's coordinates first."""
    n, m = len(shaft[0]), len(body[0])
    join = np.zeros((n + m, n + m - 1))
    join[:n, :n], join[n, node], join[n + 1 :, n:] = np.eye(n), 1.0, np.eye(m - 1)
    return [join.T @ linalg.block_diag(one, two) @ join for one, two in zip(shaft, body, strict=True)]


def own_frequencies(machine: Machine, mesh_stiffness: float) -> FloatArray:
    """Natural frequencies at rest [Hz], and the mesh's share of their energy.

    Shafts bend across and along the radius to the tooth, and twist; the bodies on them are elastic in the waves 0 and 1
    around them. ``mesh_stiffness`` is that of the teeth and the waves beyond.
    """
    elements, blocks, rows = 60, list[list[FloatArray]](), list[FloatArray]()
    middle, across, along = elements // 2, math.cos(ANGLE), math.sin(ANGLE)
    for mounted, side in zip(machine.gears, (1.0, -1.0), strict=True):
        wheel = mounted.gear
        blocks.append(joined(rod(wheel.bore, elements), middle, annulus(wheel)))
        rows.append(np.eye(len(blocks[-1][0]))[-1] * wheel.base_radius)
        for last, part in ((-1, -side * across), (-2, side * along)):
            bend, mass = beam(wheel.bore, elements)
            for end in (0, 2 * elements):
                bend[end, end] += BEARING
            inside = wheel.rim_inner_radius or 0.5 * wheel.bore
            for width, low, high in (
                (wheel.web_thickness or 0.0, 0.5 * wheel.bore, inside),
                (wheel.face_width, inside, wheel.pitch_radius),
            ):
                weight = DENSITY * math.pi * width * (high**2 - low**2)
                mass[2 * middle + 1, 2 * middle + 1] += weight * (0.25 * (high**2 + low**2) + width**2 / 12.0)
            blocks.append(joined((bend, mass), 2 * middle, wave_across(wheel)))
            rows.append(np.eye(len(blocks[-1][0]))[last] * part)
    stiffness, mass = (linalg.block_diag(*parts) for parts in zip(*blocks, strict=True))
    direction = np.concatenate(rows)
    values, vectors = linalg.eigh(
        stiffness + mesh_stiffness * np.outer(direction, direction), mass, subset_by_index=[0, 40]
    )
    strain = mesh_stiffness * (direction @ vectors) ** 2 / np.maximum(values, 1.0)
    return np.array([np.sqrt(np.maximum(values, 0.0)) / (2.0 * math.pi), strain])


def ring_twist(wheel: Gear) -> float:
    """Twist of a body under a torque of one unit of load on the base circle, along the line of action [m/N]."""
    inner, outer = 0.5 * wheel.bore, wheel.root_circle_radius
    inside, web = wheel.rim_inner_radius or inner, wheel.web_thickness or wheel.face_width
    soft = (inner**-2 - inside**-2) / web + (inside**-2 - outer**-2) / wheel.face_width
    return wheel.base_radius**2 * soft / (4.0 * math.pi * G)


def ring_shift(wheel: Gear, across: float = math.cos(ANGLE), along: float = math.sin(ANGLE)) -> float:
    """Motion of the root circle by wave 1 on a hub at rest, under a unit load at an angle to the tooth [m/N]."""
    stiffness, _ = wave_across(wheel)
    compliance = np.linalg.solve(stiffness[1:, 1:], np.eye(len(stiffness) - 1)[:, -2:])[-2:]
    return float(across**2 * compliance[1, 1] + along**2 * compliance[0, 0])


def mean_stiffness_without(machine: Machine, compliance: float) -> float:
    """Mean over the period of the static mesh stiffness without a compliance in series [N/m]."""
    (pair,) = machine.loaded_pairs()
    tangent = pair.static.tangent_stiffness / (1.0 - compliance * pair.static.tangent_stiffness)
    phases = np.append(pair.static.phases, pair.static.phases[0] + 1.0)
    return float(np.trapezoid(np.append(tangent, tangent[0]), phases))


def teeth_stiffness(machine: Machine) -> float:
    """Mean mesh stiffness without the waves 0 and 1 of both bodies [N/m]."""
    return mean_stiffness_without(machine, sum(ring_twist(one.gear) + ring_shift(one.gear) for one in machine.gears))


def mesh_mode(machine: Machine) -> float:
    """Frequency of the mode with the largest part of its energy in the teeth [Hz]."""
    modes = machine.modes()
    teeth = [number for number, part in enumerate(modes.shares.parts) if part.kind == "contact"]
    first = int(np.argmax(modes.shares.strain[:, teeth].sum(axis=1)))
    return float(abs(modes.eigenvalues[first]) / (2.0 * math.pi))


def own_mesh_mode(machine: Machine) -> float:
    frequencies, strain = own_frequencies(machine, teeth_stiffness(machine))
    return float(frequencies[int(np.argmax(strain))])


@cache
def twins(bore: float) -> Machine:
    return pair_machine((gear("pinion", 50, 3e-3, 20e-3, bore), gear("wheel", 50, 3e-3, 20e-3, bore)))


@pytest.mark.parametrize("bore", [40e-3, 30e-3, 20e-3])
def test_mesh_mode_of_two_equal_gears_is_that_of_elastic_annuli(bore: float) -> None:
    machine = twins(bore)
    assert mesh_mode(machine) == pytest.approx(own_mesh_mode(machine), rel=0.015)


def test_all_modes_of_the_pair_are_those_of_elastic_annuli_on_shafts_and_bearings() -> None:
    machine = twins(30e-3)
    own = own_frequencies(machine, teeth_stiffness(machine))[0]
    found = np.abs(machine.modes().eigenvalues) / (2.0 * math.pi)
    own = own[(own > 1.0) & (own < 11000.0)]
    assert own.size == 9
    assert np.array([found[np.argmin(np.abs(found - one))] for one in own]) == pytest.approx(own, rel=0.02)


@pytest.mark.parametrize(
    "wheels",
    [
        pytest.param([(28, 3.175e-3, 6.35e-3, 40e-3)] * 2, id="gear noise rig"),
        pytest.param([(24, 2e-3, 34e-3, 22e-3), (72, 2e-3, 34e-3, 40e-3)], id="wheel of 72 teeth"),
    ],
)
def test_mesh_modes_of_other_gears(wheels: list[tuple[int, float, float, float]]) -> None:
    machine = pair_machine((gear("pinion", *wheels[0]), gear("wheel", *wheels[1])))
    assert mesh_mode(machine) == pytest.approx(own_mesh_mode(machine), rel=0.015)


def test_mesh_mode_with_rims_on_thin_webs() -> None:
    """On a thin web the rim's own deformation in wave 1, which stays with the teeth, has 1.5 per cent."""
    body = {"rim_thickness": 9e-3, "web_thickness": 5e-3}
    machine = pair_machine(
        (gear("pinion", 50, 3e-3, 20e-3, 30e-3, **body), gear("wheel", 60, 3e-3, 20e-3, 40e-3, **body))
    )
    assert mesh_mode(machine) == pytest.approx(own_mesh_mode(machine), rel=0.02)


@pytest.mark.parametrize(
    ("teeth", "bore", "more"),
    [
        (50, 40e-3, {}),
        (50, 20e-3, {}),
        (28, 60e-3, {}),
        (50, 30e-3, {"rim_thickness": 9e-3, "web_thickness": 5e-3}),
    ],
)
def test_rim_on_a_hub_at_rest_has_the_first_frequency_of_the_annulus(
    teeth: int, bore: float, more: dict[str, float]
) -> None:
    wheel = gear("wheel", teeth, 3e-3, 20e-3, bore, **more)
    stiffness, mass = annulus(wheel)
    exact = float(np.sqrt(linalg.eigh(stiffness[1:, 1:], mass[1:, 1:], eigvals_only=True)[0]))
    shares, twist = rotation_shares(wheel), ring_twist(wheel)
    found = math.sqrt(wheel.base_radius**2 / twist / (shares.rim * wheel.polar_inertia))
    assert exact < found < 1.02 * exact
    # Static shape of a torque at the root circle on a hub at rest, with the inertia of the annulus.
    shape = np.append(0.0, np.linalg.solve(stiffness[1:, 1:], np.eye(len(stiffness))[1:, -1]))
    shape /= shape[-1]
    assert np.sum(mass) == pytest.approx(wheel.polar_inertia, rel=1e-9)
    assert shares.coupling * wheel.polar_inertia == pytest.approx(np.sum(mass @ shape), rel=1e-5)
    assert shares.rim * wheel.polar_inertia == pytest.approx(shape @ mass @ shape, rel=1e-5)


@pytest.mark.parametrize(
    ("bore", "more"), [(40e-3, {}), (20e-3, {}), (30e-3, {"rim_thickness": 9e-3, "web_thickness": 5e-3})]
)
def test_rim_shifts_on_a_hub_at_rest_as_wave_one_of_the_annulus(bore: float, more: dict[str, float]) -> None:
    """The static shape under tractions (cos t, -sin t) at the root circle, by finite elements of wave 1."""
    wheel = gear("wheel", 50, 3e-3, 20e-3, bore, **more)
    stiffness, mass = wave_across(wheel)
    load = np.zeros(len(stiffness))
    load[-2:] = 0.5, -0.5
    shape = np.append(0.0, np.linalg.solve(stiffness[1:, 1:], load[1:]))
    shift = 0.5 * (shape[-2] - shape[-1])
    assert shift_compliance(wheel, "plane-stress") == pytest.approx(shift, rel=1e-5)
    shares, hub = shift_shares(wheel, "plane-stress"), np.zeros(len(mass))
    hub[0] = 1.0
    hub[1::2], hub[2::2] = 1.0, -1.0
    assert hub @ mass @ hub == pytest.approx(wheel.mass, rel=1e-9)
    assert shares.coupling * wheel.mass == pytest.approx(hub @ mass @ shape / shift, rel=1e-4)
    assert shares.rim * wheel.mass == pytest.approx(shape @ mass @ shape / shift**2, rel=1e-4)
    exact = float(np.sqrt(linalg.eigh(stiffness[1:, 1:], mass[1:, 1:], eigvals_only=True)[0]))
    assert exact < math.sqrt(1.0 / (shift * shares.rim * wheel.mass)) < 1.04 * exact


def with_twist_in_the_mesh(machine: Machine) -> CoupledMachine:
    """The machine with rigid bodies on the shafts, whose twist is in the complete contact law of the statics."""
    rigid = [rotor_component(one.name, one.modal, start=one.start, axis=one.axis) for one in machine.rotor_components()]
    return machine.assemble(components=rigid)


def wind_up(coupled: CoupledMachine, q: FloatArray) -> float:
    """Rotations of both shafts under their gears times the base radii [m]."""
    (mesh,) = coupled.meshes
    total = 0.0
    for mounted, wheel in ((mesh.driver, mesh.geometry.driver), (mesh.driven, mesh.geometry.driven)):
        rotor = next(one for one in coupled.rotors if one.name == mounted.rotor)
        total += wheel.base_radius * float(coupled.rows(rotor.name, rotor.rotation(mounted.at)) @ q)
    return total


def test_static_equilibrium_is_that_of_the_complete_contact_law() -> None:
    machine = twins(20e-3)
    moving, standing = machine.assembled, with_twist_in_the_mesh(machine)
    assert len(machine.gear_bodies) == 2
    wheel, body = machine.gears[0].gear, machine.gear_bodies[0]
    assert body.twist is not None
    assert body.shift is not None
    assert wheel.base_radius**2 / body.twist.stiffness == pytest.approx(ring_twist(wheel), rel=1e-9)
    assert moving.meshes[0].behind_rims == pytest.approx(2.0 * body.compliance(wheel.base_radius), rel=1e-12)
    for phase in (0.1, 0.4, 0.8):
        time = phase / moving.system.contacts[0].mesh_frequency
        q, expected = static_equilibrium(moving.system, time), static_equilibrium(standing.system, time)
        assert wind_up(moving, q) == pytest.approx(wind_up(standing, expected), rel=1e-8)
        # The deflection between the rims and the twist of the bodies make up the loaded transmission error.
        contact = moving.system.contacts[0]
        force = machine.torque / moving.meshes[0].geometry.driver.base_radius
        whole = loaded_transmission_error(
            machine.loaded_pairs()[0].contact, force, np.array([contact.phase_after(time)])
        )
        between = float(contact.direction @ q)
        assert between + moving.meshes[0].behind_rims * force == pytest.approx(whole.transmission_error[0], rel=1e-7)


def test_a_rotation_of_the_whole_turns_shaft_and_rim_alike() -> None:
    rotor = twins(20e-3).rotor_components()[0]
    whole = rotor.turning
    assert np.sum(whole**2) == pytest.approx(twins(20e-3).rotor("in").polar_inertia, rel=1e-12)
    assert rotor.rotation(0.02) @ whole == pytest.approx(1.0, rel=1e-12)
    assert rotor.rim_section("pinion", HALF) @ whole == pytest.approx([0.0, 0.0, 0.0, 0.0, 0.0, 1.0], abs=1e-12)
    assert rotor.rim_section("another", HALF)[5] == pytest.approx(rotor.rotation(HALF), rel=0.0)
    assert rotor.stiffness @ whole == pytest.approx(0.0 * whole, abs=1e-9)


def with_gears(machine: Machine, **changes: object) -> Machine:
    return replace(machine, gears=[replace(one, **changes) for one in machine.gears])  # type: ignore[arg-type]


def test_given_inertia_is_spread_over_the_body_as_its_own() -> None:
    machine = twins(30e-3)
    mass, polar, diametral = machine.gears[0].body_inertia
    heavy = with_gears(machine, inertia=(2.0 * mass, 2.0 * polar, 2.0 * diametral))
    one, two = machine.gear_bodies[0], heavy.gear_bodies[0]
    for before, after in ((one.twist, two.twist), (one.shift, two.shift)):
        assert before is not None
        assert after is not None
        assert after.rim_inertia == pytest.approx(2.0 * before.rim_inertia)
        assert after.coupling_inertia == pytest.approx(2.0 * before.coupling_inertia)
        assert after.stiffness == before.stiffness
    # Twice the density.
    wheels = tuple(replace(each.gear, density=2.0 * DENSITY) for each in machine.gears)
    dense = pair_machine(wheels)  # type: ignore[arg-type]
    assert np.abs(heavy.modes().eigenvalues) == pytest.approx(np.abs(dense.modes().eigenvalues), rel=1e-6, abs=1e-3)


def test_a_disc_of_the_rotor_stands_for_a_gear_without_inertia() -> None:
    machine = twins(30e-3)
    shafts = [
        replace(shaft, rotor=replace(shaft.rotor, discs=[Disc(HALF, *one.body_inertia)]))
        for shaft, one in zip(machine.shafts, machine.gears, strict=True)
    ]
    carried = with_gears(replace(machine, shafts=shafts), inertia=(0.0, 0.0, 0.0))
    assert carried.gear_bodies == machine.gear_bodies
    without = with_gears(machine, inertia=(0.0, 0.0, 0.0))
    # Without inertia the twist is in series with the mesh.
    assert without.gear_bodies == ()
    shared = without.loaded_pairs()[0].contact.shared_compliance
    assert without.assembled.meshes[0].contact.shared_compliance == shared > 2.0 * ring_twist(without.gears[0].gear)


@pytest.mark.parametrize(
    "changes",
    [{"bore": 0.0}, {"stiffness": "weber-banaschek"}, {"stiffness": SquareStiffness(3e8)}, {"bore": 136e-3}],
    ids=["in one piece with its shaft", "teeth on a half plane", "given spring", "thin and stiff"],
)
def test_bodies_that_do_not_twist_or_twist_statically_are_left_alone(changes: dict[str, Any]) -> None:
    bore = changes.get("bore", 30e-3)
    wheels = [replace(one.gear, bore=bore) for one in twins(30e-3).gears]
    machine = twins(30e-3)
    machine = replace(
        machine,
        gears=[replace(one, gear=wheel) for one, wheel in zip(machine.gears, wheels, strict=True)],
        gear_pairs=[replace(machine.gear_pairs[0], stiffness=changes.get("stiffness", "elastic-ring"))],
    )
    assert machine.gear_bodies == ()
    assert machine.assembled.meshes[0].behind_rims == 0.0


def test_mesh_damping_is_that_of_the_rims() -> None:
    machine = twins(20e-3)
    (pair,) = machine.loaded_pairs()
    equivalent = 0.5 * machine.gears[0].gear.polar_inertia / machine.gears[0].gear.base_radius ** 2
    behind = sum(
        body.compliance(one.gear.base_radius) for body, one in zip(machine.gear_bodies, machine.gears, strict=True)
    )
    expected = 2.0 * 0.05 * math.sqrt(mean_stiffness_without(machine, behind) * equivalent)
    assert pair.contact.damping == pytest.approx(expected, rel=1e-3)


def chain(*places: tuple[float, float], bores: tuple[float, ...], pairs: list[GearPair], **more: Any) -> Machine:
    """Shafts at these places with a gear of 30 teeth and this bore each."""
    names = [f"g{number}" for number in range(len(bores))]
    shafts = [
        Shaft(Rotor(name, [Segment(HALF, 0.03, 0.0, STEEL)] * 2), place)
        for name, place in zip(names, places, strict=True)
    ]
    held = [
        MountedBearing(
            Bearing(f"{name} {at}", at, (1.0 + 0.3 * number) * BEARING * np.eye(2), np.zeros((2, 2))), name, None
        )
        for number, name in enumerate(names)
        for at in (0.0, 2.0 * HALF)
    ]
    gears = [
        ShaftGear(gear(name, 30, 3e-3, 20e-3, bore), name, HALF, stiffens_shaft=False)
        for name, bore in zip(names, bores, strict=True)
    ]
    return Machine(shafts, held, gears, pairs, speed=1.0, torque=200.0, **more)


def mean_forces(machine: Machine) -> FloatArray:
    """Mean force of every pair in motion [N]."""
    means = mean_meshes(machine.assembled.system)
    return np.array([0.0 if mean is None else mean.force for mean in means])


def test_an_idler_passes_its_torque_on_without_a_twist() -> None:
    step = 3e-3 * 30
    machine = chain(
        (0.0, 0.0),
        (step, 0.0),
        (2.0 * step, 0.0),
        bores=(0.0, 20e-3, 0.0),
        pairs=[GearPair("g0", "g1"), GearPair("g1", "g2")],
    )
    coupled = machine.assembled
    q = static_equilibrium(coupled.system)
    idler = coupled.rotors[1]
    twist = coupled.rows("g1", idler.rim_section("g1", HALF)[5] - idler.rotation(HALF)) @ q
    force = machine.torque / coupled.meshes[0].geometry.driver.base_radius
    alone = force * coupled.meshes[0].geometry.driver.base_radius / idler.bodies[0].twist.stiffness  # type: ignore[union-attr]
    assert twist == pytest.approx(0.0, abs=1e-6 * alone)


@pytest.mark.parametrize("bore", [0.0, 22e-3])
def test_paths_that_join_at_a_wheel_share_the_load_at_rest_as_in_motion(bore: float) -> None:
    """A driver with two wheels on either side that drive one wheel: its body twists under both forces at once."""
    step, half = 3e-3 * 30, math.radians(48.0)
    up = (step * math.cos(half), step * math.sin(half))
    machine = chain(
        (0.0, 0.0),
        up,
        (up[0], -up[1]),
        (2.0 * up[0], 0.0),
        bores=(0.0, 0.0, 0.0, bore),
        pairs=[GearPair("g0", "g1"), GearPair("g0", "g2"), GearPair("g1", "g3"), GearPair("g2", "g3")],
    )
    point = machine.operating_point()
    still = np.array([pair.force for pair in point.pairs])
    # The dents of the teeth stiffen with the load of each path, at rest as in motion.
    assert mean_forces(machine) == pytest.approx(still, rel=1e-5)
    assert still[2] != pytest.approx(still[3], rel=0.01)
    if not bore:
        return
    # The twist is the same for both paths: it changes neither their shares nor what each says of its own mesh.
    rigid = replace(machine, gears=[replace(one, gear=replace(one.gear, bore=0.0)) for one in machine.gears])
    assert np.array([pair.force for pair in rigid.operating_point().pairs]) == pytest.approx(still, rel=2e-3)
    for pair, loaded in zip(point.pairs, machine.loaded_pairs(), strict=True):
        assert pair.mean_stiffness == pytest.approx(loaded.static.mean_mesh_stiffness, rel=0.05)


def test_a_mode_as_high_as_the_shaft_s_highest_is_its_own_whatever_rounding_does() -> None:
    highest = 1234.5
    frequencies = np.array([10.0, highest * (1.0 - 1e-12), highest, highest * (1.0 + 1e-12), highest * (1.0 + 1e-6)])
    assert _kinds("torsion", frequencies, highest) == ("torsion",) * 4 + ("residual",)
