"""Reduced housings beside closed forms: two bodies on a beam, springs in a row; and what there cannot be."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reduced_frames import (
    AREA,
    FRAME_COORDINATES,
    LENGTH,
    MASS,
    PLACES,
    POLAR_INERTIA,
    SECOND_MOMENT,
    SHEAR_MODULUS,
    TILT_INERTIA,
    TORSION_CONSTANT,
    YOUNGS_MODULUS,
    frame,
    write_dmig,
    write_matrix_market,
)
from scipy import sparse

from gearwhine.housing import HousingError
from gearwhine.housing.reduced import (
    LabelledMatrix,
    NodeSeat,
    NodeSensor,
    NodeSpring,
    ReducedHousing,
    ReducedMatrices,
    StaticStiffness,
    read_matrix,
    reduced_matrices,
    static_stiffness,
)
from gearwhine.housing.reduced.certificate import _held_frequency

SEATS = (NodeSeat("back", 101, PLACES[101]), NodeSeat("front", 205, PLACES[205]))


def free_frame(**changes: Any) -> ReducedHousing:
    parts = {"matrices": ReducedMatrices(*frame(), tuple(FRAME_COORDINATES)), "seats": SEATS, "limit": 1e6}
    return ReducedHousing(**parts | changes)


def closed_form() -> list[float]:
    """Elastic frequencies of two equal bodies on a beam [rad/s], ascending.

    Along: 2 EA/(L m), twist: 2 GJ/(L I_p), both ends tilted against each other: 2 EI/(L I_t). Tilted alike by θ with
    the ends' shifts ±v: the strain is θ + 2 v/L, so that ω² = 12 EI/L (1/(2 I_t) + (2/L)²/(2 m)).
    """
    bending = YOUNGS_MODULUS * SECOND_MOMENT / LENGTH
    squares = [
        2.0 * YOUNGS_MODULUS * AREA / (LENGTH * MASS),
        2.0 * SHEAR_MODULUS * TORSION_CONSTANT / (LENGTH * POLAR_INERTIA),
        *[2.0 * bending / TILT_INERTIA] * 2,
        *[12.0 * bending * (0.5 / TILT_INERTIA + 2.0 / (MASS * LENGTH**2))] * 2,
    ]
    return sorted(np.sqrt(squares).tolist())


def test_two_bodies_on_a_beam() -> None:
    housing = free_frame()
    assert housing.modes.frequencies[:6].tolist() == [0.0] * 6
    np.testing.assert_allclose(housing.modes.frequencies[6:], closed_form(), rtol=1e-10)
    certificate = housing.certificate
    assert certificate is not None
    assert certificate.is_free
    assert certificate.massless_count == 0
    assert certificate.mass == pytest.approx(2.0 * MASS, rel=1e-12)
    # Inertia about x through the origin, at the first body: that of both, and the second one's m L².
    assert certificate.rigid_mass[3, 3] == pytest.approx(2.0 * TILT_INERTIA + MASS * LENGTH**2, rel=1e-12)
    assert certificate.rigid_mass[5, 5] == pytest.approx(2.0 * POLAR_INERTIA, rel=1e-12)


def test_units_of_millimetres_tonnes_and_seconds(tmp_path: Path) -> None:
    mass, stiffness = frame(length=1e-3, mass=1e3)
    path = write_dmig(tmp_path / "r.bdf", {"M": mass, "K": stiffness}, FRAME_COORDINATES, field="free")
    read = {"mass": read_matrix(path, name="M"), "stiffness": read_matrix(path, name="K")}
    matrices = reduced_matrices(read, units="mm-t-s")
    expected_mass, expected_stiffness = frame()
    np.testing.assert_allclose(matrices.mass, expected_mass, rtol=1e-12)
    np.testing.assert_allclose(matrices.stiffness, expected_stiffness, rtol=1e-12)
    # Taken for SI it is a housing of 0.024 kg whose nodes do not move as a body by their places in metres.
    wrong = free_frame(matrices=reduced_matrices(read))
    assert wrong.certificate is not None
    assert not wrong.certificate.is_free
    assert any("resists" in one for one in wrong.warnings)


def test_support_and_its_damping() -> None:
    """On springs at both nodes along z, the frame moves as one on them, 2 k/(2 m); the dashpots damp it by c/m."""
    springs = [
        NodeSpring(f"foot {node}", node, place, (0, 0, 3e4, 0, 0, 0), (0, 0, 50.0, 0, 0, 0))
        for node, place in PLACES.items()
    ]
    housing = free_frame(supports=springs, damping_ratio=0.0)
    along = int(np.argmax(np.abs(housing.seat_motions()["back"][:6, 2])))
    assert housing.modes.frequencies[along] == pytest.approx(np.sqrt(3e4 / MASS), rel=1e-8)
    assert housing.damping_matrix()[along, along] == pytest.approx(50.0 / MASS, rel=1e-8)
    assert housing.result_warnings[0]["count"] == 5


def test_damping_ratio_and_matrix_add() -> None:
    mass, stiffness = frame()
    matrices = ReducedMatrices(mass, stiffness, tuple(FRAME_COORDINATES), 2e-6 * stiffness)
    housing = free_frame(matrices=matrices, damping_ratio=0.02)
    frequencies = housing.modes.frequencies
    expected = np.diag(0.04 * frequencies + 2e-6 * frequencies**2)
    np.testing.assert_allclose(housing.damping_matrix(), expected, atol=1e-9 * expected.max())


def test_motion_without_mass_responds_statically() -> None:
    """A body on a spring k to a massless node that stands on K: k K/(k + K), and the node's compliance at rest.

    Across x and y the node's springs are coupled by c: along the diagonals they have K + c and K - c.
    """
    one, other, across, body = 4e6, 1e7, 3e6, 20.0
    mass, stiffness = np.zeros((12, 12)), np.zeros((12, 12))
    for axis in range(6):
        mass[axis, axis] = body if axis < 3 else 0.1
        pair = [axis, axis + 6]
        stiffness[np.ix_(pair, pair)] = [[one, -one], [-one, one + other]]
    stiffness[6, 7] = stiffness[7, 6] = across
    matrices = ReducedMatrices(mass, stiffness, tuple(FRAME_COORDINATES))
    housing = free_frame(matrices=matrices)
    ground = np.array([other - across, other, other + across])
    series = one * ground / (one + ground)
    np.testing.assert_allclose(housing.modes.frequencies[:3], np.sqrt(series / body), rtol=1e-10)
    assert len(housing.modes.all_frequencies) == 12
    assert housing.certificate is not None
    assert housing.certificate.massless_count == 6
    row = housing.seat_motions()["front"][:, 0]
    compliance = np.sum((row / housing.modes.all_frequencies) ** 2)
    # From the node to the ground; the body's spring leads nowhere.
    assert compliance == pytest.approx(other / (other**2 - across**2), rel=1e-10)


def test_arrays_whose_rows_are_given_by_node() -> None:
    # The frame's rows shuffled, with a mass on a spring of three motions between them: its node has three rows.
    mass, stiffness = (np.pad(one, (0, 4)) for one in frame())
    mass[12:, 12:], stiffness[12:, 12:] = np.eye(4), np.diag([4e6, 5e6, 6e6, 7e6])
    order = np.random.default_rng(1).permutation(16)
    place = np.argsort(order)
    nodes = {101: place[:6], 205: place[6:12], 7: place[12:15]}
    shuffled = {"mass": sparse.csc_array(mass[np.ix_(order, order)]), "stiffness": stiffness[np.ix_(order, order)]}
    matrices = reduced_matrices(shuffled, nodes)
    sensor = NodeSensor("mass", 7, (0.0, 1.0, 0.0), (0.0, 1.0, 0.0))
    housing = free_frame(matrices=matrices, sensors=[sensor])
    expected = np.sort([*closed_form(), *np.sqrt([4e6, 5e6, 6e6, 7e6])])
    np.testing.assert_allclose(housing.modes.frequencies[6:], expected, rtol=1e-8)
    moved = np.flatnonzero(np.abs(housing.sensor_motions()["mass"]) > 0.5)
    np.testing.assert_allclose(housing.modes.frequencies[moved], np.sqrt(5e6), rtol=1e-8)


def test_wrong_rows_of_arrays_are_named() -> None:
    mass, stiffness = frame()
    for nodes in ({1: range(6), 2: range(5, 11)}, {1: range(4)}, {1: range(7, 13)}):
        with pytest.raises(HousingError, match="six rows or three for each node, from 0 to 11"):
            reduced_matrices({"mass": mass, "stiffness": stiffness}, nodes)
    with pytest.raises(HousingError, match="expected 'stiffness', with 'mass'"):
        reduced_matrices({"mass": mass, "K": stiffness}, (1, 2))
    with pytest.raises(HousingError, match="as an array of NumPy or SciPy"):
        reduced_matrices({"mass": mass, "stiffness": stiffness[0]}, (1, 2))
    counted_from_0 = [(node, axis) for node in (1, 2) for axis in range(6)]
    for coordinates in (counted_from_0, [(0, axis) for axis in range(7, 19)], range(12)):
        with pytest.raises(HousingError, match="1 to 3 along x, y, z, 4 to 6 about them") as refused:
            ReducedMatrices(mass, stiffness, coordinates)  # type: ignore[arg-type]
        assert len(str(refused.value).splitlines()) == 1


def test_rows_by_order_with_internal_coordinates(tmp_path: Path) -> None:
    mass, stiffness = (np.pad(matrix, (0, 1)) for matrix in frame())
    mass[12, 12], stiffness[12, 12] = 1.0, 4e6
    files = {"mass": mass, "stiffness": stiffness}
    read = {name: read_matrix(write_matrix_market(tmp_path / f"{name}.mtx", one)) for name, one in files.items()}
    matrices = reduced_matrices(read, nodes=(101, 205))
    assert matrices.nodes == (101, 205)
    assert matrices.coordinates[-1] == (13, 0)
    housing = free_frame(matrices=matrices)
    assert np.isclose(housing.modes.frequencies, 2000.0, rtol=1e-12).sum() == 1
    with pytest.raises(HousingError, match="six rows for each: the order of the stiffness is 13"):
        reduced_matrices(read, nodes=(1, 2, 3))


def changed(kind: str, row: int, column: int, value: float) -> dict[str, Any]:
    matrices = dict(zip(("mass", "stiffness"), frame(), strict=True))
    matrices[kind][row, column] = value
    return matrices


@pytest.mark.parametrize(
    ("matrices", "words"),
    [
        (changed("stiffness", 0, 6, 0.0), r"'stiffness': expected a symmetric matrix; row 1, column 7 is 0 and its"),
        (changed("stiffness", 2, 2, 1.0), "'stiffness': expected no negative eigenvalue"),
        (changed("mass", 3, 3, -1.0), "'mass': expected no negative eigenvalue"),
        (changed("mass", 3, 4, np.nan), "'mass': row 4, column 5 is nan; expected a finite number"),
        ({"mass": np.eye(11), "stiffness": np.eye(12)}, r"'mass': expected a square matrix of order 12"),
        ({"mass": np.zeros((12, 12)), "stiffness": np.eye(12)}, "'mass': expected numbers other than zero"),
    ],
)
def test_matrices_of_no_housing(matrices: dict[str, Any], words: str) -> None:
    with pytest.raises(HousingError, match=words):
        ReducedMatrices(coordinates=tuple(FRAME_COORDINATES), **matrices)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"seats": [NodeSeat("back", 7, PLACES[101])]}, "seat 'back': node is 7; expected an interface node of the"),
        ({"seats": [SEATS[0], replace(SEATS[1], name="back")]}, "seat 'back': name is 'back'; expected each name once"),
        ({"sensors": [NodeSensor("top", 101, (0, 1, 0), (0, 1, 0))]}, "sensor 'top': position .* one place of node"),
        ({"supports": [NodeSpring("foot", 9, (0, 0, 0))]}, "support 'foot': node is 9"),
        ({"limit": 0.0}, "limit is 0; expected a finite number above 0 rad/s"),
        ({"damping_ratio": 1.5}, "damping_ratio is 1.5"),
        ({"matrices": 3}, "matrices is 3; expected reduced matrices"),
    ],
)
def test_parts_that_do_not_fit(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(HousingError, match=words):
        free_frame(**changes)


def test_mass_of_other_units() -> None:
    mass, stiffness = frame()
    with pytest.raises(HousingError, match=r"total \[kg\] is 2.4e\+10; expected a housing of 0.001 to 1e\+06 kg"):
        free_frame(matrices=ReducedMatrices(1e9 * mass, stiffness, tuple(FRAME_COORDINATES)))


def test_motion_without_mass_and_stiffness() -> None:
    mass, stiffness = frame()
    mass[11, 11] = 0.0
    stiffness[[5, 11]] = stiffness[:, [5, 11]] = 0.0
    with pytest.raises(HousingError, match="stiffness of every motion that has no mass; one has neither"):
        _ = free_frame(matrices=ReducedMatrices(mass, stiffness, tuple(FRAME_COORDINATES))).modes


def test_files_that_name_their_nodes_beside_one_that_does_not() -> None:
    mass, stiffness = frame()
    labelled = LabelledMatrix(stiffness, tuple(FRAME_COORDINATES))
    with pytest.raises(HousingError, match="'mass': expected node numbers in its file as in that of the stiffness"):
        reduced_matrices({"mass": LabelledMatrix(mass), "stiffness": labelled})
    with pytest.raises(HousingError, match=r"nodes is .*; expected none beside files that name their nodes"):
        reduced_matrices({"mass": replace(labelled, values=mass), "stiffness": labelled}, nodes=(101, 205))
    with pytest.raises(HousingError, match="units is 'inches'; expected one of SI, mm-t-s"):
        reduced_matrices({"mass": replace(labelled, values=mass), "stiffness": labelled}, units="inches")


def one_node_known() -> ReducedHousing:
    """The frame with its front body as internal coordinates, mixed with each other and with the motions of the back."""
    mass, stiffness = frame()
    mixed = np.eye(12)
    mixed[6:] += 0.3 * np.random.default_rng(7).normal(size=(6, 12))
    coordinates = [*FRAME_COORDINATES[:6], *((number, 0) for number in range(6))]
    matrices = ReducedMatrices(mixed.T @ mass @ mixed, mixed.T @ stiffness @ mixed, tuple(coordinates))
    return free_frame(matrices=matrices, seats=SEATS[:1], limit=6000.0)


def test_rigid_motions_by_one_node_of_known_place() -> None:
    """What is not known to move rigidly follows without a load, so that the mass is that of both bodies."""
    beside = ReducedMatrices(*frame(), tuple(FRAME_COORDINATES))
    for housing in (one_node_known(), free_frame(matrices=beside, seats=SEATS[:1])):
        certificate = housing.certificate
        assert certificate is not None
        assert certificate.is_free
        assert certificate.mass == pytest.approx(2.0 * MASS, rel=1e-9)
        assert certificate.rigid_mass[3, 3] == pytest.approx(2.0 * TILT_INERTIA + MASS * LENGTH**2, rel=1e-9)
        assert certificate.rigid_mass[5, 5] == pytest.approx(2.0 * POLAR_INERTIA, rel=1e-9)


def test_an_internal_coordinate_that_nothing_resists_stays_out_of_rigid_motions() -> None:
    """A mass on no spring beside the frame: neither the mass of the motion nor its freedom changes."""
    known = one_node_known().matrices
    mass, stiffness = np.zeros((13, 13)), np.zeros((13, 13))
    mass[:12, :12], stiffness[:12, :12], mass[12, 12] = known.mass, known.stiffness, 3.0
    matrices = ReducedMatrices(mass, stiffness, (*known.coordinates, (99, 0)))
    certificate = free_frame(matrices=matrices, seats=SEATS[:1], limit=6000.0).certificate
    assert certificate is not None
    assert certificate.is_free
    assert certificate.mass == pytest.approx(2.0 * MASS, rel=1e-9)


def test_internal_coordinates_without_mass_have_no_mode_with_the_nodes_held() -> None:
    """A spring to a massless internal coordinate beside the frame: the last mode is that of the front body."""
    known = one_node_known().matrices
    mass, stiffness = np.zeros((13, 13)), np.zeros((13, 13))
    mass[:12, :12], stiffness[:12, :12], stiffness[12, 12] = known.mass, known.stiffness, 1e12
    matrices = ReducedMatrices(mass, stiffness, (*known.coordinates, (99, 0)))
    certificate = free_frame(matrices=matrices, seats=SEATS[:1], limit=6000.0).certificate
    assert certificate is not None
    assert certificate.held_frequency == pytest.approx(np.sqrt(YOUNGS_MODULUS * AREA / (LENGTH * MASS)), rel=1e-9)


def test_the_last_mode_with_the_nodes_held_bounds_the_band() -> None:
    """The front body on the beam whose back is held moves along at √(EA/(L m)), above its tilt and its twist."""
    housing = one_node_known()
    assert housing.certificate is not None
    along = np.sqrt(YOUNGS_MODULUS * AREA / (LENGTH * MASS))
    assert housing.certificate.held_frequency == pytest.approx(along, rel=1e-9)
    assert not any("nodes held" in one for one in housing.warnings)
    beyond = replace(housing, limit=1.3 * along).warnings
    assert any("keeps modes with its nodes held up to 1153 Hz" in one for one in beyond)
    assert free_frame().certificate.held_frequency is None  # type: ignore[union-attr]


def test_static_stiffness_of_the_interface() -> None:
    """The back pulls the beam along and a spring k to the ground behind it: 1/(L/EA + 1/k)."""
    spring = 3e8
    mass, stiffness = frame()
    stiffness[6:, 6:] += spring * np.eye(6)
    series = 1.0 / (LENGTH / (YOUNGS_MODULUS * AREA) + 1.0 / spring)
    in_millimetres = LabelledMatrix(np.array([[1.02 * series * 1e-3]]), ((101, 3),))
    housings = [
        free_frame(matrices=ReducedMatrices(mass, stiffness, tuple(FRAME_COORDINATES)), static=static)
        for static in (
            StaticStiffness(np.array([[series]]), ((101, 3),)),
            static_stiffness(in_millimetres, units="mm-t-s"),
        )
    ]
    differences = [one.certificate.static_difference for one in housings]  # type: ignore[union-attr]
    np.testing.assert_allclose(differences, [0.0, 0.02 / 1.02], atol=1e-10)
    assert not any("static" in one for one in housings[0].warnings)
    assert any("differs by up to 1.96 % from the one given" in one for one in housings[1].warnings)


def test_static_stiffness_that_there_cannot_be() -> None:
    with pytest.raises(HousingError, match="these lack component 3 of node 7"):
        free_frame(static=StaticStiffness(np.eye(1), ((7, 3),)))
    with pytest.raises(HousingError, match="six rows for each of the 1 nodes; its order is 5"):
        static_stiffness(LabelledMatrix(np.eye(5)), [101])
    with pytest.raises(HousingError, match="expected finite numbers"):
        static_stiffness(LabelledMatrix(np.full((1, 1), np.nan), ((1, 1),)))
    with pytest.raises(HousingError, match="a symmetric matrix"):
        static_stiffness(LabelledMatrix(np.array([[1.0, 2.0], [0.0, 1.0]]), ((1, 1), (1, 2))))


def test_a_stiffness_alone_is_a_static_housing() -> None:
    """Its coordinates keep the static compliance Φ Φᵀ/Ω², which is the inverse of the stiffness; no mode is its own."""
    stiffness = frame()[1] + 1e7 * np.eye(12)
    made = reduced_matrices({"stiffness": LabelledMatrix(stiffness, tuple(FRAME_COORDINATES))})
    housing = free_frame(matrices=made, limit=2.0 * np.pi * 1000.0)
    assert made.is_static
    assert len(housing.frequencies_hz) == 0
    vectors = housing.modes.vectors
    np.testing.assert_allclose(
        vectors @ vectors.T / housing.modes.static_frequency**2 @ stiffness, np.eye(12), atol=1e-10
    )
    assert any("without resonances of its own" in one for one in housing.warnings)
    with pytest.raises(HousingError, match="stiffness of every motion that has no mass"):
        _ = free_frame(matrices=replace(made, stiffness=frame()[1])).modes
    with pytest.raises(HousingError, match="a mass of zero of a static housing"):
        replace(made, mass=np.eye(12))


def test_numbers_beyond_all_quantities_are_refused_by_their_place() -> None:
    mass, stiffness = frame()
    stiffness[3, 3] = 1e200
    with pytest.raises(HousingError, match="row 4, column 4"):
        ReducedMatrices(mass, stiffness, tuple(FRAME_COORDINATES))


def test_internal_coordinates_whose_mass_is_rounding_have_no_mode() -> None:
    """Masses of 1 and 4 kg on springs of 9 and 100 N/m, beside three whose mass is a rounding error."""
    matrices: Any = SimpleNamespace(
        coordinates=[(number, 0) for number in range(5)],
        mass=np.diag([1.0, -1e-18, 4.0, -2e-18, 1e-18]),
        stiffness=np.diag([9.0, 5.0, 100.0, 7.0, 6.0]),
    )
    assert _held_frequency(matrices) == pytest.approx(5.0)
    matrices.mass = np.diag([-1e-18] * 5)
    assert _held_frequency(matrices) is None
