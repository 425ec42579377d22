"""A ring gear on bolts: equal ones share its torque, unequal ones by the equilibrium of a rigid ring."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.coupling import CouplingError, Machine, MountedBearing, SupportBolt, TorqueSupport
from gearwhine.coupling.linear.carriers.turning_response import TurningResponse
from gearwhine.coupling.statics.mean_mesh import mean_contact
from gearwhine.coupling.statics.operating_point import OperatingPoint, SupportLoad
from gearwhine.coupling.statics.static_equilibrium import static_equilibrium
from gearwhine.rotors import Bearing
from tests.machines.plane_planetary_set import STEEL, equal_angles, plane_set

FloatArray = npt.NDArray[np.float64]

RADIUS, TORQUE, MIDDLE = 0.11, 200.0, 0.05
EQUAL = tuple(SupportBolt(RADIUS, angle, 2e8, 1e8, 3e8) for angle in (0.1 + equal_angles(6)).tolist())
UNEQUAL = tuple(
    SupportBolt(RADIUS, angle, stiffness, 0.5 * stiffness, 1.5 * stiffness)
    for angle, stiffness in zip(
        np.radians([10.0, 65.0, 140.0, 190.0, 260.0, 330.0]).tolist(), [4e8, 1e8, 2e8, 1e8, 3e8, 2e8], strict=True
    )
)


def bolted(bolts: tuple[SupportBolt, ...]) -> Machine:
    """A set whose ring has no bearing: the bolts alone hold it."""
    parts = plane_set(
        equal_angles(3),
        pressure_angle=np.radians(20.0),
        with_ring=True,
        damping=1e-5,
        material=STEEL,
        diameter=0.05,
        mode_count=1,
    )
    parts["bearings"] = [one for one in parts["bearings"] if one.rotor != "ring"]
    parts["torque_supports"] = [TorqueSupport("ring", MIDDLE, bolts=bolts)]
    return Machine(**parts, speed=300.0, torque=TORQUE)


def load_on_ring(point: OperatingPoint) -> FloatArray:
    """Force and torque of all meshes on the ring, (3,): along x and y, about z."""
    total = np.zeros(6)
    for number, pair in enumerate(point.pairs):
        if "ring gear" in pair.names:
            total += point.gear_forces(number)[pair.names.index("ring gear")]
    return total[[0, 1, 5]]


def support_of(point: OperatingPoint) -> SupportLoad:
    (support,) = point.supports
    return support


def test_equal_bolts_share_the_torque_of_the_ring() -> None:
    machine = bolted(EQUAL)
    support = support_of(machine.operating_point())
    # Teeth of sun and ring, 24 and 84, by Willis with the carrier as output: the ring holds T z_r / z_s.
    held = TORQUE * 84.0 / 24.0
    assert abs(support.torque) == pytest.approx(held, rel=1e-9)
    forces = support.bolt_forces
    assert np.abs(forces[:, 1]) == pytest.approx(np.full(6, held / (6.0 * RADIUS)), rel=1e-3)
    assert np.abs(forces[:, [0, 2]]).max() < 1e-3 * held / RADIUS


def test_unequal_bolts_carry_by_the_equilibrium_of_a_rigid_ring() -> None:
    """Three unknowns in the plane, with the compliance of every bolt at its place."""
    point = bolted(UNEQUAL).operating_point()
    load, support = load_on_ring(point), support_of(point)
    places = RADIUS * np.array([[np.cos(bolt.angle), np.sin(bolt.angle)] for bolt in UNEQUAL])
    outward = places / RADIUS
    along = np.stack([-outward[:, 1], outward[:, 0]], axis=1)
    radial, tangential = (np.array([getattr(bolt, name) for bolt in UNEQUAL]) for name in ("radial", "tangential"))
    # Each bolt resists the motion of its place: of the shift of the ring, and of its turn along the circle.
    stiffness = np.zeros((3, 3))
    for out, tang, k_r, k_t in zip(outward, along, radial, tangential, strict=True):
        for k, row in ((k_r, np.array([*out, 0.0])), (k_t, np.array([*tang, RADIUS]))):
            stiffness += k * np.outer(row, row)
    x, y, turn = np.linalg.solve(stiffness, load)
    expected = np.stack([radial * (outward @ [x, y]), tangential * (along @ [x, y] + RADIUS * turn)], axis=1)
    forces = support.bolt_forces
    assert forces[:, :2] == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())
    assert np.ptp(expected[:, 1]) > 0.3 * np.abs(expected).max()
    # They balance the load on the ring.
    total = (forces[:, :1] * outward + forces[:, 1:2] * along).sum(axis=0)
    assert [*total, RADIUS * forces[:, 1].sum()] == pytest.approx(load, abs=1e-6 * np.abs(load).max() + 1e-3)
    assert support.torque == pytest.approx(load[2], rel=1e-6)


def test_modes_on_unequal_bolts_are_those_of_a_rigid_ring() -> None:
    """The connector of the motion has the matrix that the equilibrium has."""
    system = bolted(UNEQUAL).assembled.system
    (connector,) = (one for one in system.linear if one.name == "torque support of ring")
    expected = np.zeros((6, 6))
    for bolt in UNEQUAL:
        c, s = np.cos(bolt.angle), np.sin(bolt.angle)
        place = RADIUS * np.array([c, s, 0.0])
        for k, unit in ((bolt.radial, [c, s, 0.0]), (bolt.tangential, [-s, c, 0.0]), (bolt.axial, [0.0, 0.0, 1.0])):
            row = np.concatenate([unit, np.cross(place, unit)])
            expected += k * np.outer(row, row)
    assert connector.stiffness == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    assert connector.directions.shape[1] == 6


def test_the_motion_rests_where_the_equilibrium_is() -> None:
    """Assembled from modes, the machine at rest loads the bolts as the exact shafts of the operating point do."""
    machine = bolted(UNEQUAL)
    system, expected = machine.assembled.system, support_of(machine.operating_point()).force
    (connector,) = (one for one in system.linear if one.name == "torque support of ring")
    force = connector.stiffness @ connector.directions.T @ static_equilibrium(system)
    assert force[[0, 1]] == pytest.approx(expected[[0, 1]], abs=0.01 * abs(expected[5]) / RADIUS)
    assert force[5] == pytest.approx(expected[5], rel=1e-6)


def test_planets_pass_bolts_that_stand_still() -> None:
    """Bolts alike in pairs have no coupling of turn and shift: a bearing of their matrix and a spring do the same."""
    bolts = tuple(
        SupportBolt(RADIUS, angle, k, 0.5 * k, 1.5 * k)
        for angle, k in zip(equal_angles(6).tolist(), [4e8, 1e8, 1e8] * 2, strict=True)
    )
    machine = bolted(bolts)
    matrix = machine.torque_supports[0].stiffness_matrix
    assert np.abs(matrix[:5, 5]).max() < 1e-9 * matrix[5, 5]
    assert matrix[0, 0] / matrix[1, 1] != pytest.approx(1.0, abs=0.2)
    holding = Bearing("ring fit", MIDDLE, matrix[:5, :5], np.zeros((5, 5)))
    by_bearing = replace(
        machine,
        bearings=[*machine.bearings, MountedBearing(holding, "ring", None)],
        torque_supports=[TorqueSupport("ring", MIDDLE, float(matrix[5, 5]))],
    )
    w, found = 2.0 * np.pi * 700.0, []
    for one in (machine, by_bearing):
        system = one.assembled.system
        assert system.turns
        model = TurningResponse(system, mean_contact(system))
        number = next(n for n, contact in enumerate(system.contacts) if contact.name == "planet gear 1 -> ring gear")
        motion = model.respond(w, [({}, {number: 1.0})])
        rotor = next(part for part in one.assembled.rotors if part.name == "ring")
        rows = one.assembled.rows("ring", rotor.motions(MIDDLE)[:2])
        found.append({order: rows @ q[0] for order, q in motion.items()})
    size = max(np.abs(shift).max() for shift in found[1].values())
    for order, shift in found[1].items():
        assert found[0][order] == pytest.approx(shift, abs=1e-6 * size)
    # One planet's error shakes the ring to either side of its frequency, and unequal directions beyond.
    assert max(np.abs(found[0][order]).max() for order in ((1,), (-1,))) > 0.1 * size


def test_a_stiffness_beside_bolts_and_a_bolt_without_one_are_refused() -> None:
    with pytest.raises(CouplingError, match="none beside bolts, which have their own"):
        TorqueSupport("ring", stiffness=1e7, bolts=EQUAL)
    with pytest.raises(CouplingError, match="tangential"):
        replace(EQUAL[0], tangential=0.0)
    with pytest.raises(CouplingError, match="bolts"):
        TorqueSupport("ring", bolts=[1.0])  # type: ignore[list-item]
