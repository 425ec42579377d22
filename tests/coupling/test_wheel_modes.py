"""Gear bodies out of the plane, against plates, solid finite elements and a machine with a solid wheel."""

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
import skfem
from scipy import linalg, optimize, sparse
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from scipy.special import ivp, jvp, kvp, yvp
from skfem.models.elasticity import lame_parameters

from gearwhine.coupling import Machine, MountedBearing, Shaft, ShaftGear
from gearwhine.coupling.gears import Gear, GearError
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.gears.stiffness.rim_on_hub import rotation_shares, shift_shares
from gearwhine.coupling.gears.stiffness.ring_body import twist_compliance
from gearwhine.coupling.gears.stiffness.wheel_modes import WheelSection, wheel_modes, wheel_section
from gearwhine.coupling.machine.components import rotor_component
from gearwhine.coupling.machine.gear_bodies import transport
from gearwhine.coupling.statics.mean_mesh import mean_equilibrium, mean_meshes
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial, modal_rotor

E, NU, DENSITY = 207e9, 0.3, 7850.0
STEEL = ShaftMaterial.from_poisson_ratio(E, NU, DENSITY)
HALF, HELIX, MODULE = 0.06, 0.2, 3e-3
HERTZ = 2.0 * math.pi


def annular_plate(ratio: float, nu: float, n: int) -> float:
    """λ² of ω = λ² √(D / ρ h) / a² for the first mode of a plate clamped at ``ratio`` a and free at a.

    From J, Y, I and K of order n (Leissa, Vibration of Plates, NASA SP-160, ch. 2).
    """

    def determinant(wave: float) -> float:
        matrix = np.zeros((4, 4))
        for column, (function, sign) in enumerate(((jvp, -1.0), (yvp, -1.0), (ivp, 1.0), (kvp, 1.0))):
            value, slope, curvature = (wave**k * function(n, wave, k) for k in range(3))
            moment = curvature + nu * (slope - n**2 * value)
            shear = sign * wave**2 * slope - (1.0 - nu) * n**2 * (slope - value)
            matrix[:, column] = function(n, wave * ratio, 0), wave * function(n, wave * ratio, 1), moment, shear
        return float(np.linalg.det(matrix / np.abs(matrix).max(axis=0)))

    waves = np.linspace(1.0, 8.0, 200)
    values = np.array([determinant(wave) for wave in waves.tolist()])
    first = int(np.flatnonzero(values[:-1] * values[1:] < 0.0)[0])
    return float(optimize.brentq(determinant, waves[first], waves[first + 1])) ** 2


@pytest.mark.parametrize("ratio", [0.3, 0.5])
def test_a_thin_disc_has_the_modes_of_an_annular_plate(ratio: float) -> None:
    radius, width, nu = 0.2, 2e-3, 1.0 / 3.0
    found = wheel_modes(WheelSection(ratio * radius, radius, radius, width, width, E, nu, DENSITY)).modes
    unit = math.sqrt(E * width**2 / (12.0 * (1.0 - nu**2) * DENSITY)) / radius**2
    frequencies = [mode.frequency for mode in found]
    expected = [annular_plate(ratio, nu, n) for n in range(4)]
    assert np.array(frequencies) / unit == pytest.approx(expected, rel=0.012)
    # Of a plate that moves along its axis alone, the rotation is transport without Coriolis force.
    assert [mode.rotation for mode in found] == pytest.approx([0.0, 1.0, 2.0, 3.0], rel=1e-3)


def test_modes_have_the_inertia_of_the_body_that_leaves_the_hub() -> None:
    """Σ Γ² of all modes is the inertia of a body whose hub has none (effective modal mass)."""
    section, gear = wheel_section(wheel()), wheel()
    assert section is not None
    found = wheel_modes(section, 1e9)
    assert found.mass == pytest.approx(gear.mass, rel=1e-9)
    # The blank's teeth lie a little outside the root circle, where the elements have them.
    assert found.diametral_inertia == pytest.approx(gear.diametral_inertia, rel=0.015)
    for n, inertia in ((0, found.mass), (1, found.diametral_inertia)):
        carried = sum(mode.coupling**2 for mode in found.modes if mode.nodal_diameters == n)
        assert 0.93 * inertia < carried < inertia
    tilt = next(mode for mode in found.modes if mode.nodal_diameters == 1)
    # Gyroscopic moment of a rim that tilts rigidly: its polar inertia, about twice the diametral one.
    assert tilt.coupling_spin / tilt.coupling == pytest.approx(gear.polar_inertia / gear.diametral_inertia, rel=0.01)
    # The rim tilts, and its section rolls.
    assert tilt.slopes[1] == pytest.approx(tilt.axial / tilt.radius, rel=0.02)
    assert tilt.slopes[0] < -tilt.axial / tilt.radius


def test_a_hub_as_wide_as_the_web_is_a_part_of_it() -> None:
    plain, hub = wheel(), replace(wheel(), hub_diameter=70e-3, hub_width=5e-3)
    assert hub.inertia == pytest.approx(plain.inertia, rel=1e-12)
    assert twist_compliance(hub) == pytest.approx(twist_compliance(plain), rel=1e-12)
    assert rotation_shares(hub) == pytest.approx(rotation_shares(plain), rel=1e-12)
    assert shift_shares(hub, "plane-stress") == pytest.approx(shift_shares(plain, "plane-stress"), rel=1e-6)
    assert frequencies_of(hub) == pytest.approx(frequencies_of(plain), rel=0.01)


def test_a_hub_stiffens_the_web_as_far_as_it_reaches() -> None:
    plain, hub, held = wheel(), replace(wheel(), hub_diameter=70e-3, hub_width=30e-3), replace(wheel(), bore=70e-3)
    ring = math.pi * DENSITY * 25e-3 * (35e-3**2 - 20e-3**2)
    assert hub.mass == pytest.approx(plain.mass + ring, rel=1e-12)
    assert twist_compliance(held) < twist_compliance(hub) < 0.6 * twist_compliance(plain)
    soft, found, stiff = frequencies_of(plain), frequencies_of(hub), frequencies_of(held)
    assert np.all(1.2 * soft[:2] < found[:2])
    assert np.all(found < stiff)
    # The root of the web in the hub yields.
    assert found == pytest.approx(stiff, rel=0.08)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"hub_diameter": 39e-3}, "hub_diameter is 0.039; expected between a bore, 40 mm, and the inside"),
        ({"hub_diameter": 170e-3}, "expected between a bore"),
        ({"hub_diameter": 60e-3, "hub_width": 4e-3}, "at least that of the web"),
        ({"hub_width": 30e-3}, "a hub with a hub_diameter"),
        ({"hub_diameter": 60e-3, "web_thickness": None}, "expected no hub, or a web around it"),
    ],
)
def test_hubs_that_do_not_fit_are_refused(changes: dict[str, float], message: str) -> None:
    with pytest.raises(GearError, match=message):
        replace(wheel(), **changes)


def frequencies_of(gear: Gear) -> FloatArray:
    section = wheel_section(gear)
    assert section is not None
    return np.array([mode.frequency for mode in wheel_modes(section).modes])


def wheel(web: float | None = 5e-3) -> Gear:
    more = {} if web is None else {"rim_thickness": 9e-3, "web_thickness": web}
    return _gear("wheel", 60, -HELIX, bore=40e-3, **more)


def _gear(name: str, teeth: int, helix: float, **more: float) -> Gear:
    return Gear(
        name,
        teeth,
        MODULE,
        math.radians(20.0),
        20e-3,
        helix_angle=helix,
        youngs_modulus=E,
        poisson_ratio=NU,
        density=DENSITY,
        **more,  # type: ignore[arg-type]
    )


def machine(web: float | None = 5e-3, speed: float = 1.0, limit: float | None = None) -> Machine:
    """A helical pinion and a wheel with a web, each in the middle of its shaft."""
    gears = [_gear("pinion", 25, HELIX), wheel(web)]
    apart = 0.5 * MODULE * 85 / math.cos(HELIX)
    shafts = [
        Shaft(Rotor(name, [Segment(HALF, thick, 0.0, STEEL)] * 2), (at, 0.0), frequency_limit=limit)
        for name, thick, at in (("in", 0.03, 0.0), ("out", 0.04, apart))
    ]
    return Machine(
        shafts,
        [
            MountedBearing(
                Bearing(f"{name} {at}", at, np.diag([5e8, 5e8, thrust, 1e5, 1e5]), np.zeros((5, 5))), name, None
            )
            for name in ("in", "out")
            for at, thrust in ((0.0, 3e8), (2.0 * HALF, 0.0))
        ],
        [ShaftGear(gear, shaft, HALF) for gear, shaft in zip(gears, ("in", "out"), strict=True)],
        [GearPair("pinion", "wheel")],
        speed=speed,
        torque=100.0,
    )


@cache
def webbed() -> Machine:
    return machine()


def test_modes_below_twice_the_limit_are_kept_and_the_others_rigid() -> None:
    modes = webbed().bodies_out_of_plane["wheel"].modes
    first = {mode.nodal_diameters: mode for mode in reversed(modes)}
    names = ["umbrella", "1 nodal diameter", "2 nodal diameters", "3 nodal diameters"]
    assert [first[n].name for n in range(4)] == names
    assert "umbrella, 1 nodal circle" in [mode.name for mode in modes]
    assert max(mode.frequency for mode in modes) < 2.0 * HERTZ * 8000.0
    limit = 0.25 * (first[0].frequency + first[2].frequency)
    some = machine(limit=limit)
    outward = some.bodies_out_of_plane["wheel"]
    assert [mode.name for mode in outward.modes] == names
    assert [mode.name for mode in outward.kept] == names[:2]
    (body,) = [one for one in some.gear_bodies if one.gear == "wheel"]
    assert body.plates == outward.kept
    rigid = machine(limit=0.4 * first[1].frequency)
    assert rigid.bodies_out_of_plane["wheel"].kept == ()
    assert not any(one.plates for one in rigid.gear_bodies)


def test_a_disc_without_a_web_is_rigid() -> None:
    disc = machine(web=None)
    assert disc.bodies_out_of_plane == {}
    assert not any(body.plates for body in disc.gear_bodies)


def test_motion_has_the_load_and_the_misalignment_of_the_equilibrium() -> None:
    """The axial force tilts the rim at rest as in motion."""
    point = webbed().operating_point()
    means, motion = mean_equilibrium(webbed().assembled.system)
    assert means[0] is not None
    assert means[0].force == pytest.approx(point.pairs[0].force, rel=1e-6)
    face = webbed().assembled.face(0, webbed().assembled.system.contacts[0].contact)
    misalignment = point.pairs[0].misalignment
    assert abs(misalignment) > 1e-4
    assert -float(face.tilting[0] @ motion) == pytest.approx(misalignment, rel=0.02)
    assert abs(machine(web=None).operating_point().pairs[0].misalignment) < 0.2 * abs(misalignment)


def test_an_observer_at_rest_sees_a_standing_wave_of_the_body_as_two() -> None:
    """Body-fixed waves with their Coriolis force and damping, z'' + (2 i Ω c + 2 ζ ω) z' + ω² z = 0, turned by n Ω."""
    section = wheel_section(wheel())
    assert section is not None
    speed, ratio = 400.0, 0.01
    for mode in wheel_modes(section).modes[2:]:
        n, omega = mode.nodal_diameters, mode.frequency
        stiffness, damping = transport(mode, ratio, speed)
        stiffness, damping = stiffness + omega**2 * np.eye(2), damping + 2.0 * ratio * omega * np.eye(2)
        state = np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness, -damping]])
        found = np.linalg.eigvals(state)
        found = found[np.argsort(found.imag)][2:]
        # With u = q_c cos nθ + q_s sin nθ at rest, the body's amplitudes are (q_c + i q_s) exp(-i n Ω t).
        own = np.roots([1.0, 2.0 * ratio * omega - 2.0j * speed * (mode.rotation - n), omega**2])
        expected = np.array([*(own + 1j * n * speed), *(own + 1j * n * speed).conj()])
        expected = expected[np.argsort(expected.imag)][2:]
        assert found == pytest.approx(expected, rel=1e-9)
        # Nearly f ± n Ω / 2 π: the Coriolis force within the body is small.
        assert found.imag == pytest.approx(np.array([omega - n * speed, omega + n * speed]), rel=0.02)


def test_the_machine_shows_the_split_of_nodal_diameters_over_speed() -> None:
    mode = next(one for one in webbed().gear_bodies[-1].plates if one.nodal_diameters == 3)
    turning = machine(speed=200.0)
    speed = abs(turning.speeds["out"])
    modes = turning.modes()
    bodies = [
        number
        for number, (kind, share) in enumerate(zip(modes.kinds, modes.energy, strict=True))
        if kind == "body" and share["body"] > 0.9 and abs(modes.eigenvalues[number].imag) / mode.frequency - 1.0 < 0.1
    ][-2:]
    split = np.diff(np.sort(modes.eigenvalues[bodies].imag))
    assert split.size == 1
    still = webbed().modes()
    pair = [abs(v.imag) for v, kind in zip(still.eigenvalues, still.kinds, strict=True) if kind == "body"]
    pair = sorted(one for one in pair if one < 1.1 * mode.frequency)
    # The teeth already split the pair of the wheel at rest.
    apart = pair[-1] - pair[-2]
    assert split[0] == pytest.approx(math.hypot(2.0 * mode.rotation * speed, apart), rel=0.01)


@dataclass(frozen=True)
class Solid:
    """A wheel of solid elements with its bore at rest: modes, coupling with rigid motions of the bore, and inertia."""

    places: FloatArray
    frequencies: FloatArray
    shapes: FloatArray
    coupling: FloatArray
    inertia: FloatArray


@cache
def solid_wheel(count: int, teeth: bool = True) -> Solid:
    """Solid of revolution by hexahedra of second order, 28 round the axis, with the bore's face at rest."""
    gear, sectors = wheel(), 28
    hub, rim, root = 0.5 * gear.bore, gear.rim_inner_radius or 0.0, gear.root_circle_radius
    web, face = 0.5 * (gear.web_thickness or 0.0), 0.5 * gear.face_width
    r = np.concatenate([np.linspace(hub, rim, 6), [0.5 * (rim + root), root]])
    z = np.array([-face, -0.5 * (face + web), -web, web, 0.5 * (face + web), face])
    plane = skfem.MeshQuad.init_tensor(r, z)
    at_r, at_z = plane.p[:, plane.t].mean(axis=1)
    plane = plane.restrict(np.flatnonzero((at_r > rim) | (np.abs(at_z) < web)))
    angles = 2.0 * np.pi * np.arange(sectors) / sectors
    # Flat elements between the angles: as much volume as the round ones.
    wide = math.sqrt(2.0 * np.pi / sectors / math.sin(2.0 * np.pi / sectors))
    points = np.concatenate(
        [np.array([wide * plane.p[0] * np.cos(a), wide * plane.p[0] * np.sin(a), plane.p[1]]) for a in angles], axis=1
    )
    corners = plane.t[[0, 1, 3, 2]]  # a quadrilateral's corners go round; a hexahedron's lie opposite
    size = plane.p.shape[1]
    near, after = (
        [corners + size * s for s in range(sectors)],
        [corners + size * ((s + 1) % sectors) for s in range(sectors)],
    )
    cells = np.concatenate(
        [np.array([a[0], a[1], a[2], b[0], a[3], b[1], b[2], b[3]]) for a, b in zip(near, after, strict=True)], axis=1
    )
    mesh = skfem.MeshHex(points, cells)
    basis = skfem.Basis(mesh, skfem.ElementHex2(), intorder=4)
    # A form for each pair of directions, of one displacement: all of x, then y, then z.
    slopes = {
        (i, j): skfem.BilinearForm(lambda u, v, w, i=i, j=j: v.grad[i] * u.grad[j]).assemble(basis)
        for i in range(3)
        for j in range(i, 3)
    }
    slopes |= {(j, i): one.T for (i, j), one in slopes.items()}
    lame, shear = lame_parameters(E, NU)
    even = shear * (slopes[0, 0] + slopes[1, 1] + slopes[2, 2])
    stiffness = sparse.block_array(
        [[lame * slopes[i, j] + shear * slopes[j, i] + (i == j) * even for j in range(3)] for i in range(3)]
    ).tocsr()
    product = skfem.BilinearForm(lambda u, v, w: u * v)
    density = DENSITY * product.assemble(basis)
    outside = mesh.facets_satisfying(lambda p: np.hypot(p[0], p[1]) > 0.99 * wide * root, boundaries_only=True)
    if teeth:
        area = 2.0 * np.pi * root * gear.face_width
        of_teeth = DENSITY * np.pi * gear.face_width * (gear.pitch_radius**2 - root**2) / area
        density = density + of_teeth * product.assemble(basis.boundary(outside))
    mass = sparse.kron(sparse.eye_array(3), density).tocsr()
    held = np.zeros((3, basis.N), dtype=bool)
    inside = mesh.facets_satisfying(lambda p: np.hypot(p[0], p[1]) < 1.01 * wide * hub, boundaries_only=True)
    held[:, basis.get_dofs(facets=inside).all()] = True
    free = np.flatnonzero(~held.ravel())
    k, m = stiffness[free][:, free].tocsc(), mass[free][:, free].tocsc()
    solver = splu(k, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    inverse = LinearOperator(k.shape, matvec=solver.solve, dtype=np.float64)
    values, vectors = eigsh(k, count, m, sigma=0.0, OPinv=inverse, v0=np.ones(free.size))
    shapes = np.zeros((3 * basis.N, count))
    shapes[free] = vectors
    x, y, height = basis.doflocs
    zero, one = np.zeros(basis.N), np.ones(basis.N)
    fields = [
        (one, zero, zero),
        (zero, one, zero),
        (zero, zero, one),
        (zero, -height, y),
        (height, zero, -x),
        (-y, x, zero),
    ]
    rigid = np.array([np.concatenate(field) for field in fields]).T
    assert np.abs(stiffness @ rigid).max() < 1e-9 * np.abs(stiffness).max()
    order = np.argsort(values)
    outer = np.flatnonzero(np.hypot(x, y) > 0.99 * wide * root)
    moved = shapes.reshape(3, -1, count)[:, outer].transpose(1, 0, 2)
    return Solid(
        basis.doflocs[:, outer],
        np.sqrt(values[order]),
        moved[:, :, order],
        (rigid.T @ (mass @ shapes))[:, order],
        rigid.T @ (mass @ rigid),
    )


@pytest.mark.slow
def test_first_modes_are_those_of_solid_elements() -> None:
    solid = solid_wheel(60)
    assert solid.inertia[0, 0] == pytest.approx(wheel().mass, rel=2e-3)
    section = wheel_section(wheel())
    assert section is not None
    found = [mode.frequency for mode in wheel_modes(section, 7000.0 * HERTZ).modes for _ in range(mode.size)]
    # Of the solid's first modes one is the rotation of the rim and two are its shift, in the plane.
    own = solid.frequencies[:17][[*range(5), *range(6, 13), 15, 16]]
    assert np.sort(found)[: own.size] == pytest.approx(own, rel=0.03)


def machine_with_solid_wheel() -> tuple[FloatArray, FloatArray, FloatArray, list[FloatArray]]:
    """Mass, stiffness, damping and rows of the output bearings' x and y, of the machine with the wheel of elements."""
    coupled, solid = webbed().assembled, solid_wheel(60)
    driver, bare = coupled.rotors[0], webbed().shaft("out").rotor
    bearings = [held.bearing for held in webbed().bearings if held.rotor == "out"]
    at = [HALF]
    modal = modal_rotor(bare, bearings, frequency_limit=1e5, gears_at=at, moments_at=at, thrusts_at=at)
    shaft = rotor_component("out", modal, start=0.0)
    first, second, count = driver.size, shaft.size, solid.frequencies.size
    n = first + second + count
    hub = np.zeros((6, n))
    hub[:5, first : first + second], hub[5, first : first + second] = shaft.motions(HALF), shaft.rotation(HALF)
    wheel_only = np.zeros((count, n))
    wheel_only[:, first + second :] = np.eye(count)
    mass = np.eye(n) + hub.T @ solid.inertia @ hub
    mass += hub.T @ solid.coupling @ wheel_only + wheel_only.T @ solid.coupling.T @ hub
    stiffness = linalg.block_diag(driver.stiffness, shaft.stiffness, np.diag(solid.frequencies**2))
    outputs = []
    for held in webbed().bearings:
        rows = np.zeros((5, n))
        if held.rotor == "in":
            rows[:, :first] = driver.motions(held.bearing.at)
        else:
            rows[:, first : first + second] = shaft.motions(held.bearing.at)
            outputs += [5e8 * rows[0], 5e8 * rows[1]]
        stiffness += rows.T @ held.bearing.stiffness @ rows
    # Motion of points of the root circle by the hub and by the modes.
    x, y, z = solid.places

    def moved(which: npt.NDArray[np.bool_]) -> FloatArray:
        zero, one = np.zeros(int(which.sum())), np.ones(int(which.sum()))
        a, b, c = x[which], y[which], z[which]
        rigid = np.array(
            [[one, zero, zero, zero, c, -b], [zero, one, zero, -c, zero, a], [zero, zero, one, b, -a, zero]]
        )
        return np.einsum("ckp,kn->pcn", rigid, hub) + solid.shapes[which] @ wheel_only

    everywhere, radius = moved(np.ones(x.size, dtype=bool)), float(np.hypot(x, y).mean())
    turn = np.mean((x[:, None] * everywhere[:, 1] - y[:, None] * everywhere[:, 0]) / radius**2, axis=0)
    about_x = 2.0 * np.mean(y[:, None] * everywhere[:, 2], axis=0) / radius**2
    about_y = -2.0 * np.mean(x[:, None] * everywhere[:, 2], axis=0) / radius**2
    teeth = (x < 0.0) & (np.abs(y) < 1e-9)
    contact = coupled.system.contacts[0]
    line = coupled.meshes[0].line_of_action(1)
    gear, (push_x, push_y) = wheel(), line.push
    at_teeth, heights = moved(teeth), z[teeth]
    across = push_x * at_teeth[:, 0] + push_y * at_teeth[:, 1]
    approach = across.mean(axis=0) - push_y * turn * (gear.pitch_radius - radius)
    approach = approach + line.axial * at_teeth[np.argmin(np.abs(heights)), 2]
    slope = (heights - heights.mean()) @ across / float(np.sum((heights - heights.mean()) ** 2))
    face = coupled.face(0, contact.contact)
    rows = np.zeros((3, n))
    rows[:, :first] = face.rows[:, :first]
    rows -= [approach, slope, push_x * about_y - push_y * about_x]
    (mean,) = [one for one in mean_meshes(coupled.system) if one is not None]
    law = face.law(mean.force, mean.stiffness)
    stiffness += rows.T @ law @ rows
    damping = contact.contact.damping / mean.stiffness * rows.T @ law @ rows
    return mass, stiffness, damping, [*outputs, law[0] @ rows]


@pytest.mark.slow
def test_modes_and_response_are_those_of_the_machine_with_a_solid_wheel() -> None:
    mass, stiffness, damping, (*outputs, load) = machine_with_solid_wheel()
    own = np.sqrt(np.maximum(linalg.eigh(stiffness, mass, eigvals_only=True), 0.0)) / HERTZ
    modes = webbed().modes()
    found = np.abs(modes.eigenvalues[[kind != "residual" for kind in modes.kinds]].imag) / HERTZ
    found, own = found[found > 1.0], own[own > 1.0]
    assert int(np.sum(found < 4000.0)) == int(np.sum(own < 4000.0)) == 13
    assert found[:13] == pytest.approx(own[:13], rel=0.02)
    frequencies = HERTZ * np.array([300.0, 900.0, 1500.0, 2000.0, 2700.0])
    response = webbed().mesh_error_response(frequencies)
    loads = np.hstack([force for name, force in response.bearing_force.items() if name.startswith("out")])
    for frequency, load_on_bearings in zip(frequencies.tolist(), loads, strict=True):
        q = np.linalg.solve(stiffness - frequency**2 * mass + 1j * frequency * damping, load)
        # Along y, where the most is: the mesh's twist of solid elements, whose static part is that of a plane ring.
        for number in (1, 3):
            assert abs(load_on_bearings[number]) == pytest.approx(abs(outputs[number] @ q), rel=0.05)
