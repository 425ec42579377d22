"""Modes of reduced matrices beside measured ones, at nodes and recovered points: a whole model is the reference."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy import linalg
from scipy.spatial.transform import Rotation

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.cli import run_command
from gearwhine.housing import HousingError
from gearwhine.housing.measured import MeasuredGeometry, MeasuredModes, SurveyData, write_survey
from gearwhine.housing.modal_test import ModalTest
from gearwhine.housing.reduced import LabelledMatrix, NodeSeat, ReducedHousing, reduced_matrices
from gearwhine.housing.reduced.recovery import RecoveryFile, read_recovery
from gearwhine.housing.reduced_modal_test import compare_reduced
from gearwhine.numerics.arrays import FloatArray

RANDOM = np.random.default_rng(11)
NODES, INNER = (31, 12), 4
"""Interface nodes, and points of the whole model inside."""
PLACES = RANDOM.uniform(-0.2, 0.2, (2 + INNER, 3))
COUNT = 6 * (2 + INNER)
SIZE = np.tile([1.0] * 3 + [8.0] * 3, 2 + INNER)
"""Units of the whole model's motions: a rotation of 8 rad stands for a translation of 1 m."""
TURNED = RANDOM.normal(size=(COUNT - 12, COUNT - 12))
"""Amplitudes of the internal coordinates in the motions inside, which are no motions of single points themselves."""


def whole_model() -> tuple[FloatArray, FloatArray]:
    """Mass and stiffness of six points, distinct frequencies from some 300 Hz on."""
    root = RANDOM.normal(size=(COUNT, COUNT))
    mass = np.diag(np.tile([4.0] * 3 + [4.0 / 64.0] * 3, 2 + INNER))
    stiffness = (root @ root.T / COUNT + 0.1 * np.eye(COUNT)) * 4e7 / np.outer(SIZE, SIZE)
    return mass, stiffness


MASS, STIFFNESS = whole_model()
T = linalg.block_diag(np.eye(12), TURNED)
SQUARES, SHAPES = linalg.eigh(STIFFNESS, MASS)
FREQUENCIES = np.sqrt(SQUARES)
KEPT = 8


def rows_of_points() -> FloatArray:
    """Translations of the points inside by all coordinates, (4, 3, 36)."""
    return np.stack([T[6 * point : 6 * point + 3] for point in range(2, 2 + INNER)])


def in_units(units: str, rows: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mass, stiffness and recovery rows of the coordinates in SI or in N, mm, t."""
    mass, stiffness = T.T @ MASS @ T, T.T @ STIFFNESS @ T
    if units == "SI":
        return mass, stiffness, rows
    length = np.ones(COUNT)
    length[:12] = np.tile([1e-3] * 3 + [1.0] * 3, 2)
    return 1e3 * length[:, None] * mass * length, 1e3 * length[:, None] * stiffness * length, 1e3 * rows * length


def reduced(units: str = "SI", *, named: bool = False, recovered: bool = True) -> ReducedHousing:
    mass, stiffness, rows = in_units(units, rows_of_points())
    matrices = reduced_matrices({"mass": LabelledMatrix(mass), "stiffness": LabelledMatrix(stiffness)}, NODES, units)
    columns, names = np.arange(COUNT), None
    if named:
        columns = np.random.default_rng(3).permutation(COUNT)
        names = tuple(matrices.coordinates[column] for column in columns)
    file = RecoveryFile(PLACES[2:], rows[:, :, columns], names)
    points = file.points(matrices.coordinates, units=units) if recovered else None
    seats = [NodeSeat(str(node), node, tuple(place)) for node, place in zip(NODES, PLACES[:2].tolist(), strict=True)]
    return ReducedHousing(matrices, seats, limit=1.5 * float(FREQUENCIES[KEPT - 1]), recovered=points)


def measured(*, shift: float = 0.0, frame: FloatArray | None = None) -> MeasuredModes:
    """The whole model's own modes 2 % lower, along skew directions of all points, seen in a frame of axes as rows."""
    frame = np.eye(3) if frame is None else frame
    ways = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    points = np.repeat(np.arange(2 + INNER), 3)
    turned = np.tile(ways, (2 + INNER, 1))
    motions = SHAPES.reshape(2 + INNER, 6, COUNT)[:, :3, :KEPT]
    shapes = np.einsum("di,dim->md", turned, motions[points])
    # The survey lists its points in an order of its own.
    listed = np.array([4, 0, 5, 2, 1, 3])
    labels = tuple(str(point + 1) for point in listed)
    positions = PLACES[listed] @ frame.T + shift
    geometry = MeasuredGeometry(labels, positions, np.argsort(listed)[points], turned @ frame.T)
    return MeasuredModes(0.98 * FREQUENCIES[:KEPT], np.full(KEPT, 0.01), (1.7 - 0.4j) * shapes, geometry)


@pytest.mark.parametrize("units", ["SI", "mm-t-s"])
@pytest.mark.parametrize("named", [False, True])
def test_modes_are_those_of_the_whole_model(units: str, named: bool) -> None:
    housing = reduced(units, named=named)
    np.testing.assert_allclose(housing.modes.frequencies[:KEPT], FREQUENCIES[:KEPT], rtol=1e-9)
    comparison = compare_reduced(housing, ModalTest(measured())).comparison
    assert comparison.pairing == "shapes"
    assert [(pair.measured_mode, pair.mode) for pair in comparison.pairs] == [(n, n) for n in range(1, KEPT + 1)]
    np.testing.assert_allclose([pair.mac for pair in comparison.pairs], 1.0, atol=1e-9)
    np.testing.assert_allclose([pair.error_percent for pair in comparison.pairs], 100.0 / 0.98 - 100.0, rtol=1e-6)


def test_by_landmarks_and_in_a_frame_of_its_own() -> None:
    """Seen from elsewhere the points have other places; three of them with their places on the housing align all."""
    with pytest.raises(HousingError, match=r"points within .* mm of nodes and recovered points .* mm off"):
        compare_reduced(reduced(), ModalTest(measured(shift=5.0)))
    turned = Rotation.from_euler("xyz", [0.5, 1.0, -2.0]).as_matrix()
    landmarks = {label: tuple(place) for label, place in zip("1234", PLACES.tolist(), strict=False)}
    test = ModalTest(measured(shift=5.0, frame=turned), align=landmarks)
    comparison = compare_reduced(reduced(), test).comparison
    assert len(comparison.pairs) == KEPT
    np.testing.assert_allclose([pair.mac for pair in comparison.pairs], 1.0, atol=1e-9)


def test_only_points_of_known_motion_are_compared() -> None:
    """Without recovery rows the two nodes are left, six motions of 18."""
    compared = compare_reduced(reduced(recovered=False), ModalTest(measured()))
    kept = compared.test.modes.geometry
    assert kept is not None
    assert [kept.labels[point] for point in kept.points] == ["1", "1", "1", "2", "2", "2"]
    assert compared.comparison.shapes is not None
    expected = np.abs(np.sum(SHAPES[[0, 1, 2, 6, 7, 8], 0] * SHAPES[[0, 1, 2, 6, 7, 8], 4])) ** 2
    sizes = [np.sum(SHAPES[[0, 1, 2, 6, 7, 8], mode] ** 2) for mode in (0, 4)]
    assert compared.comparison.shapes.mac[0, 4] == pytest.approx(expected / np.prod(sizes), rel=1e-6)


def test_frequencies_alone_and_by_order() -> None:
    alone = replace(measured(), shapes=None, geometry=None)
    assert compare_reduced(reduced(), ModalTest(alone)).comparison.pairing == "nearest"
    by_order = compare_reduced(reduced(), ModalTest(measured(), pairing="order")).comparison
    assert [pair.mode for pair in by_order.pairs] == list(range(1, KEPT + 1))
    np.testing.assert_allclose([pair.mac for pair in by_order.pairs], 1.0, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"align": "surface"}, "landmarks, or points in the frame of the matrices"),
        ({"pairing": "dominance"}, "the skin of a reduced housing is not known"),
        ({"tolerance": 1e-9, "align": None}, "points within 1e-06 mm"),
    ],
)
def test_what_only_a_mesh_has_is_refused(change: dict[str, Any], words: str) -> None:
    with pytest.raises(HousingError, match=words):
        compare_reduced(reduced(), ModalTest(measured(shift=1e-4), **change))


def test_a_limit_below_the_measured_modes_is_refused() -> None:
    low = replace(reduced(), limit=float(FREQUENCIES[KEPT - 1]))
    with pytest.raises(HousingError, match=r"at least .* Hz: measured modes are paired with the model's up to there"):
        compare_reduced(low, ModalTest(measured()))


def archive(path: Path, **changes: Any) -> Path:
    arrays = {"positions": PLACES[2:], "recovery": rows_of_points().reshape(3 * INNER, -1)} | changes
    if path.suffix == ".nc":
        names = iter(range(100))
        xr.Dataset(
            {key: ([f"d{next(names)}" for _ in range(np.ndim(one))], one) for key, one in arrays.items()}
        ).to_netcdf(path, engine="h5netcdf")
    else:
        np.savez(path, **arrays)
    return path


@pytest.mark.parametrize("ending", [".npz", ".nc"])
def test_recovery_rows_are_read(tmp_path: Path, ending: str) -> None:
    read = read_recovery(archive(tmp_path / f"points{ending}"))
    np.testing.assert_array_equal(read.positions, PLACES[2:])
    np.testing.assert_array_equal(read.rows, rows_of_points())
    assert read.coordinates is None
    axes = np.array([1, 2, 3, 4, 5, 6] * 2 + [0] * (COUNT - 12))
    nodes = np.array([31] * 6 + [12] * 6 + list(range(COUNT - 12)))
    named = read_recovery(archive(tmp_path / f"named{ending}", nodes=nodes, axes=axes))
    assert named.coordinates == tuple(zip(nodes.tolist(), axes.tolist(), strict=True))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda folder: folder / "absent.npz", "expected a readable file"),
        (lambda folder: folder / "rows.op4", "a file that ends in one of .npz, .nc"),
        (lambda folder: archive(folder / "r.npz", positions=PLACES[2:, :2]), r"positions of shape \(4, 2\)"),
        (lambda folder: archive(folder / "r.npz", recovery=np.zeros((11, 36))), "expected 12 rows, three each point"),
        (lambda folder: archive(folder / "r.npz", recovery=np.full((12, 36), np.nan)), "finite numbers"),
        (lambda folder: archive(folder / "r.npz", recovery=np.zeros((12, 36), complex)), "is of complex128"),
        (lambda folder: archive(folder / "r.nc", recovery=np.zeros((11, 36))), "expected 12 rows"),
        (
            lambda folder: archive(folder / "r.npz", nodes=np.arange(3), axes=np.zeros(3, int)),
            "nodes of 3 columns; expected 36",
        ),
    ],
)
def test_wrong_recovery_rows(tmp_path: Path, make: Callable[[Path], Path], words: str) -> None:
    with pytest.raises(HousingError, match=words):
        read_recovery(make(tmp_path))


def test_arrays_that_are_missing_or_unpack_to_much(tmp_path: Path) -> None:
    np.savez(tmp_path / "r.npz", positions=PLACES)
    with pytest.raises(HousingError, match=r"r.npz: expected an array 'recovery'"):
        read_recovery(tmp_path / "r.npz")
    np.savez_compressed(tmp_path / "bomb.npz", positions=PLACES, recovery=np.zeros((6000, 6000), dtype=np.int8))
    with pytest.raises(HousingError, match=r"bomb.npz: array 'recovery' has 36000000 entries; expected at most"):
        read_recovery(tmp_path / "bomb.npz")


def test_columns_that_the_matrices_do_not_have() -> None:
    coordinates = reduced().matrices.coordinates
    with pytest.raises(HousingError, match="recovery rows of 35 columns; expected 36"):
        RecoveryFile(PLACES[2:], np.zeros((4, 3, 35))).points(coordinates)
    others = ((99, 1), *coordinates[1:])
    with pytest.raises(HousingError, match="without a column of component 1 of node 31"):
        RecoveryFile(PLACES[2:], np.zeros((4, 3, 36)), others).points(coordinates)


def case(folder: Path) -> dict[str, Any]:
    """A case of the housing alone, measured at its nodes and inside."""
    mass, stiffness, rows = in_units("mm-t-s", rows_of_points())
    np.savez(folder / "box.npz", mass=mass, stiffness=stiffness)
    archive(folder / "points.npz", recovery=rows.reshape(3 * INNER, -1))
    survey = measured()
    write_survey(folder / "survey.unv", SurveyData(survey.geometry, survey))
    files = {"stiffness": "box.npz", "mass": "box.npz", "recovery": "points.npz"}
    seats = [
        {"name": f"seat {node}", "node": node, "center": [f"{value} m" for value in place]}
        for node, place in zip(NODES, PLACES.tolist(), strict=False)
    ]
    limit = 1.5 * float(FREQUENCIES[KEPT - 1]) / (2.0 * np.pi)
    housing = {
        "frequency_limit": f"{limit} Hz",
        "damping_ratio": 0.02,
        "reduced": {key: str(folder / name) for key, name in files.items()} | {"units": "mm-t-s", "nodes": list(NODES)},
        "seat": seats,
    }
    return {"title": "A reduced box", "housing": housing, "measured": {"file": str(folder / "survey.unv")}}


def test_the_commands_show_modes_and_pairs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    document = case(tmp_path)
    study = gw.build(**document)
    modes = study.modes()
    table = modes.document["reduced_housing"]["modes"]
    np.testing.assert_allclose(
        [mode["frequency_hz"] for mode in table[:KEPT]], FREQUENCIES[:KEPT] / (2.0 * np.pi), rtol=1e-9
    )
    np.testing.assert_allclose([mode["damping_ratio"] for mode in table], 0.02, rtol=1e-9)
    shapes = modes.dataset["node_translation"].sel(node=12).values[:KEPT]
    np.testing.assert_allclose(np.abs(shapes), np.abs(SHAPES[6:9, :KEPT].T), rtol=1e-6, atol=1e-8)
    compared = study.compare().document
    # Universal files have six digits.
    assert len(compared["pairs"]) == KEPT
    np.testing.assert_allclose([pair["mac"] for pair in compared["pairs"]], 1.0, atol=1e-8)
    assert compared["pairs"][0]["error_percent"] == pytest.approx(100.0 / 0.98 - 100.0, rel=1e-4)
    assert compared["model_modes"]["count"] >= KEPT
    study.compare().write(tmp_path / "out")
    assert {"comparison.csv", "mac.png"} <= {path.name for path in (tmp_path / "out").iterdir()}
    lines = [f"{key} = {value!r}" for key, value in document["housing"]["reduced"].items()]
    text = 'title = "A box"\n[measured]\nfile = "survey.unv"\n[housing]\nfrequency_limit = '
    text += f'"{document["housing"]["frequency_limit"]}"\n[housing.reduced]\n' + "\n".join(lines) + "\n"
    for seat in document["housing"]["seat"]:
        text += f'[[housing.seat]]\nname = "{seat["name"]}"\nnode = {seat["node"]}\ncenter = {seat["center"]}\n'
    (tmp_path / "box.toml").write_text(text)
    monkeypatch.chdir(tmp_path)
    assert run_command(["modes", "box.toml"]) == 0
    shown = capsys.readouterr().out
    assert "moves most" in shown
    assert f"{FREQUENCIES[0] / (2.0 * np.pi):.2f}" in shown
    assert run_command(["compare", "box.toml"]) == 0
    assert "Paired by MAC and frequency" in capsys.readouterr().out


def test_motions_that_are_left_out_are_named_and_wrong_files_refused_by_key(tmp_path: Path) -> None:
    document = case(tmp_path)
    recovery = document["housing"]["reduced"].pop("recovery")
    (told,) = (one for one in gw.build(**document).compare().document["warnings"] if one["name"] == "survey")
    assert told["message"].startswith("12 of 18 measured motions are left out")
    document["housing"]["reduced"]["recovery"] = recovery
    archive(tmp_path / "points.npz", recovery=np.zeros((12, 30)))
    with pytest.raises(CaseError, match=r"reduced.recovery: expected rows of the matrices; recovery rows of 30"):
        gw.build(**document).modes()
    document["housing"]["reduced"]["recovery"] = str(tmp_path / "box.npz")
    with pytest.raises(CaseError, match=r"reduced.recovery: expected recovery rows; box.npz: expected an array"):
        gw.build(**document).modes()
    document["housing"]["reduced"].pop("recovery")
    document["measured"]["align"] = True
    with pytest.raises(CaseError, match=r"measured.align: expected landmarks"):
        gw.build(**document).compare()
