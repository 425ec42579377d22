"""Static equilibrium of whole machines against an independent assembly, closed forms and ISO 6336-1."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from own_statics import (
    FULL,
    MODULE,
    STEEL,
    STIFFNESS,
    TEETH,
    OwnStatics,
    distance,
    linear_bearing,
    one_stage,
    toothed,
)
from scipy.linalg import block_diag
from scipy.optimize import nnls
from scipy.sparse.linalg import splu

from gearwhine.coupling import Machine, MountedBearing, Output, Shaft, ShaftForce, ShaftGear
from gearwhine.coupling.gears import ConstantStiffness, HelixDeviation, TipRelief, tooth_contact
from gearwhine.coupling.gears.contact.face_slices import FaceSlices, face_slices
from gearwhine.coupling.gears.geometry.toothed_section import toothed_section
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.gears.stiffness.models import stiffness_under_load
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.housing import Housing, HousingModes, Material, Seat, Support
from gearwhine.meshes import BoxGeometry, mesh_box
from gearwhine.meshes.box.parts import Bore, WallThickness
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Pedestal, Rotor, Segment
from gearwhine.rotors.rolling_bearings import BallRow, RollerRow, RollingBearing, paired

GRAVITY = (1.0, -9.81, 0.3)
JOURNAL = np.array([[2.0e7, 3.5e7], [-1.2e7, 6.0e7]])
"""Stiffness of a journal bearing, by which a force along x also moves the shaft along y."""


def assert_agrees(
    point: OperatingPoint,
    own: OwnStatics,
    gravity: Sequence[float] | None = None,
    tolerance: float = 1e-9,
    sag: FloatArray | None = None,
) -> None:
    """Bearing forces, motions of shafts and seats, and misalignment are those of the independent assembly."""
    x = own.solve(own.loads(gravity, sag))
    assert point.residual < 1e-9
    size = max(float(np.abs(bearing.force[:3]).max()) for bearing in point.bearings)
    for bearing in point.bearings:
        moved = own.bearing(bearing.name) @ x
        expected = bearing.mounted.bearing.spatial_stiffness @ moved
        np.testing.assert_allclose(bearing.force, expected, rtol=0.0, atol=tolerance * size)
        np.testing.assert_allclose(bearing.deflection, moved, rtol=0.0, atol=tolerance * np.abs(x).max())
        np.testing.assert_allclose(
            bearing.seat_motion, own.seat(bearing.name) @ x, rtol=0.0, atol=tolerance * np.abs(x).max()
        )
    for shaft in point.shafts:
        nodes = own.nodes[shaft.name]
        found = shaft.motions(nodes)
        expected = np.array([own.section(shaft.name, at) @ x for at in nodes.tolist()]).T
        # The rotation that nothing holds may stand anywhere.
        np.testing.assert_allclose(found[:5], expected[:5], rtol=0.0, atol=tolerance * np.abs(expected[:5]).max())
    for pair, given, torque in zip(point.pairs, own.machine.gear_pairs, own.machine.pair_torques, strict=True):
        over, _ = own.approach(given, pair.z)
        assert pair.force == pytest.approx(abs(torque) / own.base_radius(own.gears[given.driver].gear), rel=1e-8)
        slope = float(pair.z @ over @ x) / float(pair.z @ pair.z)
        assert pair.misalignment == pytest.approx(-slope, rel=0.0, abs=tolerance * np.abs(x).max() / np.ptp(pair.z))
        assert sum(pair.misalignment_by_cause.values()) == pytest.approx(pair.misalignment, rel=1e-9)


def on_pedestals(stiffness: npt.ArrayLike) -> list[MountedBearing]:
    foot = Pedestal(np.asarray(stiffness), np.zeros((2, 2)), 2.0)
    held = one_stage().bearings
    return [
        replace(one, bearing=replace(one.bearing, pedestal=foot)) if n % 3 == 0 else one for n, one in enumerate(held)
    ]


def journal(cross: float = 1.0, *, pedestal: npt.ArrayLike | None = None) -> list[MountedBearing]:
    """Journal bearings with an axial spring; their cross-coupling is multiplied."""
    stiffness = np.zeros((5, 5))
    stiffness[:2, :2] = JOURNAL * [[1.0, cross], [cross, 1.0]]
    stiffness[2, 2] = 1e7
    held = one_stage().bearings if pedestal is None else on_pedestals(pedestal)
    return [replace(one, bearing=replace(one.bearing, stiffness=stiffness)) for one in held]


CHANGES: dict[str, tuple[dict[str, Any], Sequence[float] | None]] = {
    "full bearings": ({}, None),
    "left hand": ({"hand": -1.0}, None),
    "turning the other way": ({"speed": -300.0}, None),
    "braking, on the back flanks": ({"torque": -150.0}, None),
    "spur": ({"hand": 0.0}, None),
    "weight": ({}, GRAVITY),
    "a belt and a weight on the shafts": (
        {"forces": [ShaftForce("in", 0.0, (800.0, -300.0, 0.0)), ShaftForce("out", 0.12, (0.0, -500.0, 250.0))]},
        None,
    ),
    "torque in the middle": ({"torque_at": 0.1, "outputs": [Output("out", 150.0 * 41 / 23, 0.03)]}, None),
    "pedestals": ({"bearings": on_pedestals([[3e8, 2e7], [2e7, 5e8]])}, None),
    "journal bearings": ({"bearings": journal()}, None),
    "journal bearings, no potential at all": ({"bearings": journal(-3.0)}, GRAVITY),
    "journal bearings on unsymmetric pedestals": ({"bearings": journal(pedestal=[[3e8, 8e7], [-2e7, 5e8]])}, None),
}


@pytest.mark.parametrize(("changes", "gravity"), CHANGES.values(), ids=CHANGES)
def test_linear_machines(changes: dict[str, Any], gravity: Sequence[float] | None) -> None:
    machine = one_stage(**changes)
    assert_agrees(replace(machine, gravity=gravity).operating_point(), OwnStatics(machine), gravity)


def test_a_wide_gear_between_narrow_and_wide_ones() -> None:
    """An idler meshes over 25 mm with one gear and over 45 mm with another, and drives a third that takes no torque."""
    teeth = {"first": 23, "idler": 41, "last": 31, "idle": 19}
    widths = {"first": 25e-3, "idler": 45e-3, "last": 45e-3, "idle": 20e-3}
    hands = {"first": 1.0, "idler": -1.0, "last": 1.0, "idle": 1.0}
    reach = {name: distance(teeth["idler"], teeth[name], 1.0) for name in ("first", "last", "idle")}
    axes = {
        "first": (-reach["first"], 0.0),
        "idler": (0.0, 0.0),
        "last": (0.3 * reach["last"], 0.9539392 * reach["last"]),
    }
    axes["idle"] = (0.0, -reach["idle"])
    shafts = [Shaft(Rotor(name, [Segment(0.18, 0.04, 0.0, STEEL)]), axes[name]) for name in teeth]
    held = [
        MountedBearing(linear_bearing(f"{name} {at}", at, FULL), name, None) for name in teeth for at in (0.01, 0.17)
    ]
    gears = [ShaftGear(toothed(name, teeth[name], hands[name], widths[name]), name, 0.07) for name in teeth]
    pairs = [
        GearPair(driver, driven, ConstantStiffness(STIFFNESS))
        for driver, driven in (("first", "idler"), ("idler", "last"), ("idler", "idle"))
    ]
    machine = Machine(
        shafts, held, gears, pairs, speed=-200.0, torque=120.0, outputs=[Output("last", 120.0 * 31 / 23, 0.18)]
    )
    point = machine.operating_point()
    # The idle flanks stay where they are: alone, without their pair, the others are the same.
    loaded = replace(
        machine,
        shafts=shafts[:3],
        bearings=held[:6],
        gears=gears[:3],
        gear_pairs=pairs[:2],
    )
    alone = loaded.operating_point()
    assert_agrees(alone, OwnStatics(loaded))
    assert point.pairs[2].force == pytest.approx(0.0, abs=1e-6 * point.pairs[0].force)
    for one in alone.bearings:
        np.testing.assert_allclose(point.bearing(one.name).force, one.force, atol=1e-6 * point.pairs[0].force)


def test_the_thrusts_of_two_hands_cancel() -> None:
    """A double-helical pair: its axial forces only stretch the shafts, and neither half is loaded more."""
    apart = distance(*TEETH, 1.0)
    shafts = [
        Shaft(Rotor(name, [Segment(0.2, 0.04, 0.0, STEEL)]), (x, 0.0)) for name, x in (("in", 0.0), ("out", apart))
    ]
    stiffness = np.diag([2e8, 2e8, 5e7, 0.0, 0.0])
    held = [
        MountedBearing(linear_bearing(f"{name} {at}", at, stiffness), name, None)
        for name in ("in", "out")
        for at in (0.01, 0.19)
    ]
    gears, pairs = [], []
    for half, at, hand in (("left", 0.08, 1.0), ("right", 0.12, -1.0)):
        gears += [
            ShaftGear(toothed(f"{half} pinion", TEETH[0], hand), "in", at),
            ShaftGear(toothed(f"{half} wheel", TEETH[1], -hand), "out", at),
        ]
        pairs.append(GearPair(f"{half} pinion", f"{half} wheel", ConstantStiffness(STIFFNESS)))
    # Both torques enter in the middle, so that the machine is its own mirror image.
    machine = Machine(
        shafts,
        held,
        gears,
        pairs,
        speed=100.0,
        torque=200.0,
        torque_at=0.1,
        outputs=[Output("out", 200.0 * TEETH[1] / TEETH[0], 0.1)],
    )
    point = machine.operating_point()
    assert_agrees(point, OwnStatics(machine))
    left, right = point.pairs
    assert left.force == pytest.approx(right.force, rel=1e-9)
    assert left.misalignment == pytest.approx(-right.misalignment, rel=1e-6)
    for name in ("in", "out"):
        first, last = (point.bearing(f"{name} {at}").force[2] for at in (0.01, 0.19))
        assert first == pytest.approx(-last, rel=1e-6)
        assert 0.0 < abs(first) < 1e-2 * left.force


FEET = (Support("base", surface="bottom", fixed=(True, True, True)),)
SEAT_Z = 0.074


def box(fixtures: Sequence[Support]) -> Housing:
    """A small box with four seats, for the shafts of `one_stage` side by side."""
    apart = distance(*TEETH, 1.0)
    places = {
        f"{shaft} {end}": (x, 0.08, z)
        for shaft, x in (("in", -apart / 2), ("out", apart / 2))
        for end, z in (("back", -SEAT_Z), ("front", SEAT_Z))
    }
    bores = tuple(Bore(name, (x, y, math.copysign(0.08, z)), 0.05) for name, (x, y, z) in places.items())
    mesh = mesh_box(BoxGeometry((0.26, 0.16, 0.16), WallThickness.uniform(0.012), bores), 0.05, order=1)
    seats = [Seat(name, centre) for name, centre in places.items()]
    return Housing(mesh, Material(2.1e11, 0.3, 7850.0), fixtures=fixtures, seats=seats)


@pytest.fixture(scope="module")
def grounded() -> HousingModes:
    return box(FEET).modes(count=4)


def in_box(modes: HousingModes, stiffness: npt.ArrayLike = FULL, **changes: Any) -> Machine:
    """`one_stage` in the seats of a box, off their centres by 2 to 6 mm."""
    machine = one_stage(stiffness=stiffness)
    apart = distance(*TEETH, 1.0)
    shafts = [replace(machine.shafts[0], axis=(-apart / 2, 0.08)), replace(machine.shafts[1], axis=(apart / 2, 0.08))]
    held = [replace(one, seat=f"{one.rotor} {'back' if one.bearing.at < 0.1 else 'front'}") for one in machine.bearings]
    return replace(machine, shafts=shafts, bearings=held, housing=modes, **changes)


def condensed(machine: Machine, gravity: Sequence[float]) -> tuple[FloatArray, FloatArray]:
    """Compliance of the housing at its bearings (5 b, 5 b) and their sag (5 b,), by a sparse factorisation."""
    assert isinstance(machine.housing, HousingModes)
    housing = machine.housing.housing
    matrices, ports, rows = housing.matrices(), housing.seat_ports(), []
    heights = {seat.name: seat.center[2] for seat in housing.seats}
    for one in machine.bearings:
        assert one.seat is not None
        port = ports[one.seat].toarray()
        arm = machine.shaft(one.rotor).start + one.bearing.at - heights[one.seat]
        rows += [port[0] + arm * port[4], port[1] - arm * port[3], *port[2:5]]
    loads = np.array(rows)
    free = np.setdiff1d(np.arange(loads.shape[1]), matrices.fixed)
    factor = splu(matrices.stiffness.tocsc()[free][:, free])
    weight = matrices.mass @ np.tile(gravity, loads.shape[1] // 3)
    return loads[:, free] @ factor.solve(loads[:, free].T), loads[:, free] @ factor.solve(weight[free])


def test_a_machine_in_its_housing(grounded: HousingModes) -> None:
    """Four modes of the housing and its residual ones hold its static stiffness, condensed by a sparse factor."""
    machine = in_box(grounded)
    names = [one.bearing.name for one in machine.bearings]
    gravity = (0.0, -9.81e3, 2e3)  # a thousand times the earth's, so that the box sags by as much as it bends
    compliance, sag = condensed(machine, gravity)
    own = OwnStatics(machine, compliance=compliance, seated=names)
    assert_agrees(replace(machine, gravity=gravity).operating_point(), own, gravity, 1e-7, sag)
    point = machine.operating_point()
    assert_agrees(point, own, tolerance=1e-7)
    for one in point.bearings:
        assert np.abs(one.seat_motion[:3]).max() > 1e-7
    assert abs(point.pairs[0].misalignment_by_cause["housing"]) > 1e-2 * abs(point.pairs[0].misalignment)


def overhung(width: float, torque_at: float, stiffness: float = 1e6, at: float = 0.13) -> Machine:
    """A pinion beside two bearings as hard as a clamp, and a wheel on a shaft as hard as a wall."""
    apart = distance(20, 60, 0.0)
    shafts = [
        Shaft(Rotor("in", [Segment(0.2, 0.02, 0.0, STEEL)])),
        Shaft(Rotor("out", [Segment(0.2, 0.16, 0.0, STEEL)]), (0.0, apart)),
    ]
    clamp = np.diag([1e13, 1e13, 1e13, 1e11, 1e11])
    places = [("in", 0.01), ("in", 0.02), ("out", 0.05), ("out", 0.19)]
    held = [MountedBearing(linear_bearing(f"{name} {z}", z, clamp), name, None) for name, z in places]
    gears = [
        ShaftGear(toothed("pinion", 20, 0.0, width), "in", at),
        ShaftGear(toothed("wheel", 60, 0.0, width), "out", at),
    ]
    return Machine(
        shafts,
        held,
        gears,
        [GearPair("pinion", "wheel", ConstantStiffness(stiffness))],
        speed=10.0,
        torque=100.0,
        torque_at=torque_at,
        outputs=[Output("out", 300.0, at)],
    )


def test_an_overhung_pinion_opens_its_free_end() -> None:
    """Cantilever of length L under the force F in the plane of action: its end tilts by F L² / 2 E I.

    F is spread over the face b, so that its bending moment ends at the face with the slope F (L² - b²/4) / 2 E I; the
    thick pinion is sheared by F / 2 kappa G A in the middle.
    """
    width, length = 3e-3, 0.11
    point = overhung(width, torque_at=0.0).operating_point()
    (pair,) = point.pairs
    bent = pair.force * (length**2 - width**2 / 4) / (2.0 * STEEL.youngs_modulus * math.pi / 64 * 0.02**4)
    ratio = STEEL.poisson_ratio
    root = MODULE * (20 - 2.5)
    shear_stiffness = 6 * (1 + ratio) / (7 + 6 * ratio) * STEEL.shear_modulus * math.pi / 4 * root**2
    bent += pair.force / (2.0 * shear_stiffness)
    # The flanks open towards +z, where the shaft ends.
    assert pair.misalignment_by_cause["shafts"] == pytest.approx(bent, rel=1e-3)
    assert pair.misalignment == pytest.approx(bent + pair.misalignment_by_cause["bodies"], rel=1e-3)
    assert abs(pair.misalignment_by_cause["bearings"]) < 1e-4 * bent
    assert pair.misalignment_by_cause["housing"] == 0.0
    # On the other side of the bearings the same force opens the other end.
    mirrored = overhung(width, torque_at=0.0, at=0.13)
    moved = [
        replace(one, bearing=replace(one.bearing, at=0.2 - z))
        for one, z in zip(mirrored.bearings, (0.01, 0.02, 0.05, 0.19), strict=True)
    ]
    gears = [replace(one, at=0.07) for one in mirrored.gears]
    other = replace(mirrored, bearings=moved, gears=gears, torque_at=0.2, outputs=[Output("out", 300.0, 0.07)])
    assert other.operating_point().pairs[0].misalignment == pytest.approx(-pair.misalignment, rel=1e-6)


@pytest.mark.parametrize(("torque_at", "side"), [(0.0, 1.0), (0.2, -1.0)])
def test_the_wind_up_of_a_pinion(monkeypatch: pytest.MonkeyPatch, torque_at: float, side: float) -> None:
    """Torsion of a solid pinion under an even load q per width, its teeth as stiff at the ends of the face as within.

    The torque q r_b (b/2 -+ z) twists it along a parabola; by least squares the line through r_b theta over the face
    has its slope in the middle, F r_b² / 2 G J. The end where the torque leaves the shaft lags.
    """
    for length in ("_END_LENGTH", "_SPREAD_BENDING", "_SPREAD_TORSION"):
        monkeypatch.setattr(f"gearwhine.coupling.gears.geometry.toothed_section.{length}", 0.0)
    width = 40e-3
    machine = overhung(width, torque_at)
    beside = [
        replace(one, bearing=replace(one.bearing, at=z))
        for one, z in zip(machine.bearings, (0.1, 0.16, 0.1, 0.16), strict=True)
    ]
    (pair,) = replace(machine, bearings=beside).operating_point().pairs
    gear = pair.pair.geometry.driver
    polar = math.pi / 32 * toothed_section(gear).torsion_diameter ** 4
    radius = 0.5 * MODULE * 20 * math.cos(gear.pressure_angle)
    expected = side * pair.force * radius**2 / (2.0 * STEEL.shear_modulus * polar)
    assert pair.misalignment_by_cause["bodies"] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("excess", [0.2, 0.9, 1.0, 2.0, 8.0])
def test_the_face_load_factor_of_iso_6336(excess: float) -> None:
    """ISO 6336-1:2019, 7.5: K_Hβ by F_βy c_γβ b / 2 F_m, for a constant stiffness and a straight gap.

    A foundation of the stiffness c per width and area carries q = c (delta - mu z) where it is pressed. Over the whole
    face, K = q_max / q_mean = 1 + F_βy c b / 2 F with F_βy = mu b; where it is pressed over l < b only, F = c mu l² / 2
    and q_max = c mu l give K = sqrt(2 F_βy c b / F). Slices of the width w sample q at their middles.
    """
    machine = one_stage(hand=0.0, stiffness=1e12 * np.eye(5))
    pair = machine.operating_point().pairs[0].pair
    width, force = pair.geometry.face_width, 5e3
    per_width = STIFFNESS / width
    misalignment = 2.0 * excess * force / (per_width * width**2)
    shape = -misalignment * np.append(pair.contact.stations, 0.0)
    load = pair.contact.under_force(force, shape).line_load.mean(axis=0)
    factor = float(load.max() * width / force)
    iso = 1.0 + excess if excess <= 1.0 else 2.0 * math.sqrt(excess)
    half = 0.5 * width / pair.contact.z.size
    assert factor == pytest.approx(iso - per_width * misalignment * half * width / force, rel=5e-4)
    if excess < 1.0:
        exact = 1.0 + per_width * misalignment * (0.5 * width - half) * width / force
        assert factor == pytest.approx(exact, rel=1e-10)
    assert load.argmax() == 0  # the end at -z, as the gap opens towards +z


BALL = BallRow(9, 11e-3, 46e-3, clearance=12e-6)
ANGULAR = BallRow(13, 9.5e-3, 46e-3, contact_angle=math.radians(25.0))
ROLLERS = RollerRow(12, 9e-3, 10e-3, 55e-3, clearance=10e-6, profile="straight")
DEEP = BallRow(9, 12e-3, 55e-3, clearance=8e-6)
ROLLING = (
    RollingBearing([BALL], name="ball bearing with clearance"),
    paired(ANGULAR, "back to back", 18e-3, preload=300.0, name="preloaded pair"),
    RollingBearing([ROLLERS], name="cylindrical rollers"),
    RollingBearing([DEEP], name="deep-groove bearing"),
)


def rolling_machine(**changes: Any) -> Machine:
    """`one_stage` on rolling bearings that have no stiffness but by their elements, with crowned compliant teeth."""
    held = [
        MountedBearing(
            linear_bearing(one.bearing.name, one.bearing.at, np.zeros((5, 5))), one.rotor, None, rolling=made
        )
        for one, made in zip(one_stage().bearings, ROLLING, strict=True)
    ]
    crowned = {"helix_deviation": HelixDeviation(crowning=12e-6), "tip_relief": TipRelief(15e-6, length=2e-3)}
    gears = [
        ShaftGear(toothed("pinion", TEETH[0], 1.0, **crowned), "in", 0.07),
        ShaftGear(toothed("wheel", TEETH[1], -1.0), "out", 0.07),
    ]
    pairs = [GearPair("pinion", "wheel", "potential-energy", backlash=1e-4)]
    return one_stage(**{"bearings": held, "gears": gears, "gear_pairs": pairs} | changes)


def rolling_energy(bearing: RollingBearing, q: FloatArray) -> float:
    """Energy of the elements one by one: Hertz's point contacts of balls, ISO 16281's lines of rollers [J]."""
    total = -bearing.axial_preload * q[2]
    for row in bearing.rows:
        for number in range(row.count):
            angle = 2.0 * math.pi * number / row.count
            outward = np.array([math.cos(angle), math.sin(angle), 0.0])
            if isinstance(row, BallRow):
                span = (row.inner_groove + row.outer_groove - 1.0) * row.ball_diameter
                arm = (row.inner_groove - 0.5) * row.ball_diameter
                radius = 0.5 * row.pitch_diameter + arm * math.cos(row.contact_angle)
                z = row.position + row.direction * arm * math.sin(row.contact_angle)
                moved = q[:3] + np.cross([q[3], q[4], 0.0], radius * outward + [0.0, 0.0, z])
                radial = span * math.cos(row.contact_angle) - 0.5 * row.clearance + outward @ moved
                axial = row.direction * (span * math.sin(row.contact_angle) + row.axial_offset) + moved[2]
                approach = max(math.hypot(radial, axial) - span, 0.0)
                total += 0.4 * row.stiffness * approach**2.5
                continue
            for part in range(row.slices):
                z = row.position + row.length * ((part + 0.5) / row.slices - 0.5)
                moved = q[:3] + np.cross([q[3], q[4], 0.0], [0.0, 0.0, z])
                approach = max(outward @ moved - 0.5 * row.clearance, 0.0)
                line = 35948.0 * (1e3 * row.length) ** (8.0 / 9.0)  # N and mm
                total += 9.0 / 19.0 * line / row.slices * (1e3 * approach) ** (19.0 / 9.0) * 1e-3
    return float(total)


def central_differences(function: Callable[[FloatArray], float], at: FloatArray, steps: FloatArray) -> FloatArray:
    return np.array([(function(at + step) - function(at - step)) / (2.0 * step.max()) for step in np.diag(steps)])


def line_loads(faces: FaceSlices, base: FloatArray, depth: FloatArray) -> FloatArray:
    """Load per width on the slices of p tooth pairs pressed in by a depth (p, n), 0 or more, by quadratic programming.

    All pairs stand on the same bodies, which tilt and bend over the face.
    """
    pairs, count = base.shape
    chain = 2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    chain[0, 0] = chain[-1, -1] = 1.0
    each = [np.linalg.inv(np.diag(one) + faces.coupling / faces.width**2 * chain) for one in base]
    bodies = faces.width * faces.shapes @ faces.shared @ faces.shapes.T
    compliance = block_diag(*each) + np.eye(base.size) / faces.flattening + np.tile(bodies, (pairs, pairs))
    lower = np.linalg.cholesky(compliance)
    found, _ = nnls(lower.T, np.linalg.solve(lower, depth.ravel()))
    return np.asarray(found).reshape(base.shape)


def tooth_forces(point: OperatingPoint, own: OwnStatics, x: FloatArray) -> FloatArray:
    """Forces of the teeth on all coordinates, mean over the phases, by their own quadratic programs (n,).

    Stiffness and gaps of the slices are those of the tooth model. The depth of each phase is the one found, at which
    the programs must carry the mesh force.
    """
    (pair,), (given,) = point.pairs, own.machine.gear_pairs
    torque = own.machine.pair_torques[0]
    geometry, (push, axial) = pair.pair.geometry, (own.plane(given)[0], own.plane(given)[1])
    assert push == pytest.approx(pair.pair.push)
    sense = 1 if own.machine.speeds["in"] > 0 else -1
    model = stiffness_under_load("potential-energy", geometry, abs(torque) / geometry.driver.base_radius)
    contact = tooth_contact(geometry, model, corner_contact=True, faces=face_slices(geometry, sense=sense))
    faces = contact.faces
    assert faces is not None
    over, tilt = own.approach(given, faces.z)
    found, phases = np.zeros(own.size), pair.mean.phases
    states = contact.pairs(phases)
    assert states.faces is not None
    rows = np.argwhere(states.present)
    shape = over @ x - float((over @ x).mean())
    # The load does not move the mean approach, which has the shared compliance of an even load in it.
    shared = contact.shared_compliance * pair.force
    carried = np.zeros(phases.size)
    for phase in range(phases.size):
        these = np.flatnonzero(rows[:, 0] == phase)
        places = states.position[phase, rows[these, 1]][:, None] + faces.shift
        xi = (places - geometry.pitch_point_position) * geometry.base_pitch
        depth = pair.mean.deflection[phase] - shared + shape - axial * xi * (tilt @ x) - states.faces.gap[these]
        depth = np.where(states.faces.meeting[these], depth, -1.0)
        load = line_loads(faces, states.faces.base[these], depth)
        carried[phase] = faces.width * load.sum()
        found += faces.width * np.einsum("pn,pnx->x", load, over - axial * xi[:, :, None] * tilt) / phases.size
    np.testing.assert_allclose(carried, pair.force, rtol=1e-6)
    return found


@pytest.mark.parametrize("torque", [20.0, 150.0])
def test_rolling_bearings_and_crowned_teeth(torque: float) -> None:
    """The equilibrium found is one of a machine whose every force is computed here: bearings by differences of energy.

    The energy is convex, so it has no other. At 20 N m part of the face and half of the balls carry nothing.
    """
    machine = rolling_machine(torque=torque)
    point, own = machine.operating_point(), OwnStatics(machine)
    assert point.residual < 1e-9
    x = np.concatenate([point.shaft(name).motions(nodes).T.ravel() for name, nodes in own.nodes.items()])
    left = own.linear @ x - own.loads()
    for bearing, made in zip(point.bearings, ROLLING, strict=True):
        rows = own.bearing(bearing.name)
        np.testing.assert_allclose(rows @ x, bearing.deflection, rtol=0.0, atol=1e-12)
        steps = 2e-9 * np.array([1.0, 1.0, 1.0, 20.0, 20.0])
        force = central_differences(lambda q, made=made: rolling_energy(made, q), rows @ x, steps)
        np.testing.assert_allclose(bearing.force, force, rtol=0.0, atol=1e-5 * np.abs(force).max())
        left += rows.T @ force
    teeth = tooth_forces(point, own, x)
    left += teeth
    largest = np.abs(teeth.reshape(-1, 6)[:, :3]).max()
    assert np.abs(left.reshape(-1, 6)[:, :3]).max() < 1e-7 * largest
    assert np.abs(left.reshape(-1, 6)[:, 3:]).max() < 1e-7 * largest * 0.05
    if torque == 20.0:
        assert point.pairs[0].line_load.min() == 0.0
        assert point.bearing("in 0.016").rolling.loaded < BALL.count
