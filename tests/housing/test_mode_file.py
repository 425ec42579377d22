"""Mode sets on file: what is read is what was written, bit for bit, and anything else is refused."""

import json
import os
from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from gearwhine.housing import Certificate, HousingError, ModeSet, Seat, Sensor, read_modes, solve_modes, write_modes
from gearwhine.housing.errors import ModeFileError
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.seats import seat_matrix, sensor_port
from gearwhine.housing.storage.mesh_arrays import mesh_digest
from gearwhine.housing.storage.mode_file import ModeRecord, with_sensors
from gearwhine.housing.storage.netcdf import LabelledArray
from gearwhine.meshes import ElementBlock, Mesh
from gearwhine.meshes.elements import Facets

SEATS = (Seat("front-seat", (-0.03, 0.08, 0.12)), Seat("back-seat", (0.0, 0.08, -0.12)))


@pytest.fixture(scope="module")
def record(box: Mesh, box_matrices: Matrices) -> ModeRecord:
    modes = solve_modes(box_matrices, count=8)
    motions = np.stack([modes.project(seat_matrix(box, seat)) for seat in SEATS], axis=1)
    bare = ModeRecord(
        mesh=replace(box, volumes=dict(box.volumes) | {"nothing": np.empty(0, dtype=np.int64)}),
        modes=modes,
        mass=box_matrices.total_mass,
        seats=SEATS,
        seat_motions=motions,
        inputs={"material": {"Stahl, weiß": 207e9}, "third": 1 / 3},
        notes={"seconds": {"mesh": 0.1}},
        extras={"damping": LabelledArray(("mode", "other_mode"), np.eye(8) / 3, "s-1", "modal damping")},
    )
    sensors = (Sensor("top, middle", (0.0, 0.16, 0.0)), Sensor("side", (0.1, 0.05, 0.01), (1.0, 2.0, 2.0)))
    return with_sensors(bare, [sensor_port(box, sensor) for sensor in sensors])


@pytest.fixture(scope="module")
def file(record: ModeRecord, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("modes") / "modes.nc"
    write_modes(path, record)
    return path


def the_same(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two arrays are equal bit for bit, in type and shape too."""
    return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()


def blocks_the_same(some: Facets, others: Facets) -> bool:
    return [block.kind for block in some] == [block.kind for block in others] and all(
        the_same(one.nodes, other.nodes) for one, other in zip(some, others, strict=True)
    )


def check_equal(found: ModeRecord, expected: ModeRecord) -> None:
    for field in fields(ModeSet):
        one, other = getattr(found.modes, field.name), getattr(expected.modes, field.name)
        assert the_same(one, other) if isinstance(other, np.ndarray) else one == other, field.name
    assert the_same(found.mesh.points, expected.mesh.points)
    assert blocks_the_same(found.mesh.blocks, expected.mesh.blocks)
    assert list(found.mesh.surfaces) == list(expected.mesh.surfaces)
    assert all(blocks_the_same(found.mesh.surfaces[name], facets) for name, facets in expected.mesh.surfaces.items())
    assert list(found.mesh.volumes) == list(expected.mesh.volumes)
    assert all(the_same(found.mesh.volumes[name], members) for name, members in expected.mesh.volumes.items())
    assert (found.seats, found.sensors, found.mass) == (expected.seats, expected.sensors, expected.mass)
    assert the_same(found.seat_motions, expected.seat_motions)
    assert the_same(found.sensor_motions, expected.sensor_motions)
    assert (found.inputs, found.notes, found.key) == (expected.inputs, expected.notes, expected.key)
    assert list(found.extras) == list(expected.extras)
    for name, array in expected.extras.items():
        assert the_same(found.extras[name].values, array.values)
        assert replace(found.extras[name], values=array.values) == array


def test_what_is_read_is_what_was_written(file: Path, record: ModeRecord) -> None:
    check_equal(read_modes(file), record)
    assert [path.name for path in file.parent.iterdir()] == ["modes.nc"]


@pytest.mark.parametrize("order", [1, 2])
def test_a_bare_record_holds_no_ports_and_no_regions(
    block: Callable[..., Mesh], cube: tuple[Mesh, Matrices], order: int, tmp_path: Path
) -> None:
    mesh = replace(block((0.1, 0.1, 0.1), order=order), surfaces={}, volumes={})
    modes = solve_modes(cube[1], count=7)
    shapes = np.ascontiguousarray(modes.shapes[:, : len(mesh.points)])
    plain = ModeRecord(mesh, replace(modes, shapes=shapes), 7.85)
    write_modes(tmp_path / "new" / "modes.nc", plain)
    found = read_modes(tmp_path / "new" / "modes.nc")
    assert (found.seats, found.sensors, found.extras, dict(found.mesh.surfaces)) == ((), (), {}, {})
    assert the_same(found.modes.shapes, shapes)
    assert found.modes.frequencies[0] == 0.0


def test_other_tools_read_it_with_sense(file: Path, record: ModeRecord) -> None:
    with xr.open_dataset(file) as data:
        assert data["shape"].dims == ("mode", "node", "component")
        assert data["shape"].attrs["units"] == "kg-0.5"
        assert data.frequency.attrs["units"] == "Hz"
        assert data.frequency.sel(mode=7).item() == record.modes.frequencies_hz[6]
        assert data.seat_motion.sel(seat="back-seat", motion="about z").dims == ("mode",)
        # A displacement at a sensor is the shape there: by hand, from the nearest node of the shape.
        place = data.sensor_position.sel(sensor="top, middle").values
        assert place[1] == pytest.approx(0.16)
        assert all({"units", "long_name"} <= set(data[name].attrs) for name in data.variables)
        assert data.attrs["complete"] == "yes"
        assert json.loads(data.attrs["inputs"]) == record.inputs


@pytest.fixture(scope="module")
def content(file: Path) -> xr.Dataset:
    """What another tool reads of the file."""
    with xr.open_dataset(file, decode_cf=False) as data:
        return data.load()


def changed(content: xr.Dataset, target: Path, change: Callable[[xr.Dataset], xr.Dataset]) -> Path:
    """A copy of a mode file after a change by somebody who leaves its digest alone."""
    change(content.copy()).to_netcdf(target, engine="h5netcdf", encoding={})
    return target


CHANGES: list[tuple[str, Callable[[xr.Dataset], xr.Dataset], str]] = [
    ("another schema", lambda data: data.assign_attrs(schema="0"), "schema 0; this version reads schema 1"),
    ("another kind", lambda data: data.assign_attrs(format="mesh"), "something else than a mode set"),
    ("a variable less", lambda data: data.drop_vars("mass"), "digest"),
    ("another number", lambda data: data.assign(mass=data.mass * (1 + 2**-52)), "digest"),
    ("another unit", lambda data: data.assign(mass=data.mass.assign_attrs(units="lb")), "digest"),
    ("another name", lambda data: data.assign_coords(seat=("seat", ["a", "b"], data.seat.attrs)), "digest"),
    ("another note", lambda data: data.assign_attrs(notes="{}"), "digest"),
]


@pytest.mark.parametrize(("change", "said"), [row[1:] for row in CHANGES], ids=[row[0] for row in CHANGES])
def test_a_changed_file_is_refused(
    content: xr.Dataset, tmp_path: Path, change: Callable[[xr.Dataset], xr.Dataset], said: str
) -> None:
    with pytest.raises(ModeFileError, match=said):
        read_modes(changed(content, tmp_path / "changed.nc", change))


def test_an_unchanged_copy_by_another_tool_is_accepted(content: xr.Dataset, record: ModeRecord, tmp_path: Path) -> None:
    """What the digest guards is the content, not how HDF5 lays it out."""

    def keep(data: xr.Dataset) -> xr.Dataset:
        for name in data.variables:
            data[name].encoding = {"_FillValue": None}
        return data

    check_equal(read_modes(changed(content, tmp_path / "copy.nc", keep)), record)


@pytest.mark.parametrize("part", [0.0, 0.1, 0.999])
def test_a_file_cut_short_is_refused(file: Path, tmp_path: Path, part: float) -> None:
    content = file.read_bytes()
    path = tmp_path / "short.nc"
    path.write_bytes(content[: int(part * len(content))])
    with pytest.raises(ModeFileError, match="no NetCDF4 file, or a damaged one"):
        read_modes(path)


SEALED = -72
"""Where the seal of a file begins."""


def spots(size: int, count: int) -> Iterator[tuple[int, int]]:
    chance = np.random.default_rng(7)
    for place, bit in zip(chance.integers(size, size=count), chance.integers(8, size=count), strict=True):
        yield int(place), 1 << int(bit)


def test_a_flipped_bit_anywhere_is_found_or_changes_nothing(file: Path, record: ModeRecord, tmp_path: Path) -> None:
    """Where it is in HDF5's own structure its readers may run for ever: the seal keeps them from it."""
    content = file.read_bytes()
    for place, bit in spots(len(content), 60):
        damaged = bytearray(content)
        damaged[place] ^= bit
        (tmp_path / "damaged.nc").write_bytes(damaged)
        with pytest.raises(ModeFileError, match="digest at its end"):
            read_modes(tmp_path / "damaged.nc")
    mark = bytearray(content)
    mark[SEALED] ^= 1
    (tmp_path / "unmarked.nc").write_bytes(mark)
    check_equal(read_modes(tmp_path / "unmarked.nc"), record)


@pytest.mark.parametrize("content", [b"", b"not a file of this kind", b"\x89HDF\r\n\x1a\n" + bytes(200)])
def test_a_foreign_file_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "modes.nc").write_bytes(content)
    with pytest.raises(ModeFileError, match="no NetCDF4 file, or a damaged one"):
        read_modes(tmp_path / "modes.nc")


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ModeFileError, match=r"none\.nc: no such file"):
        read_modes(tmp_path / "none.nc")


@pytest.mark.parametrize(
    "spoilt", [{"found": 7}, {"expected": 9}, {"max_residual": 1e-3}, {"max_residual": float("nan")}]
)
def test_modes_without_a_proof_are_refused(record: ModeRecord, tmp_path: Path, spoilt: dict[str, float]) -> None:
    certificate = replace(record.modes.certificate, **spoilt)
    write_modes(tmp_path / "modes.nc", replace(record, modes=replace(record.modes, certificate=certificate)))
    with pytest.raises(ModeFileError, match="certificate is not complete"):
        read_modes(tmp_path / "modes.nc")


def test_a_failed_write_leaves_the_earlier_file(file: Path, record: ModeRecord, tmp_path: Path) -> None:
    path = tmp_path / "modes.nc"
    write_modes(path, record)
    before = path.read_bytes()
    misfit = LabelledArray(("mode",), np.zeros(3), "1", "three numbers for eight modes")
    with pytest.raises(HousingError, match="do not fit each other"):
        write_modes(path, replace(record, extras={"wrong": misfit}))
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["modes.nc"]


def test_a_record_that_does_not_fit_itself_is_refused(record: ModeRecord) -> None:
    with pytest.raises(HousingError, match=r"seat_motions have shape \(8, 1, 6\); expected \(8, 2, 6\)"):
        replace(record, seat_motions=record.seat_motions[:, :1])
    with pytest.raises(HousingError, match=r"sensor_motions have shape"):
        replace(record, sensor_motions=record.sensor_motions[:7])
    with pytest.raises(HousingError, match=r"modes\.shapes have shape"):
        replace(record, modes=replace(record.modes, shapes=record.modes.shapes[:, 1:]))
    with pytest.raises(HousingError, match="sensors top have no direction"):
        replace(record, sensors=(Sensor("top", (0.0, 0.16, 0.0)), record.sensors[1]))


def test_every_field_of_a_mode_set_has_its_place_in_the_file() -> None:
    """Whoever adds a field must say how it stands in the file, or re-used modes would lack it."""
    assert {field.name for field in fields(ModeSet)} == {
        "frequencies", "shapes", "certificate", "residual_modes", "seconds", "backend", "shift", "threads",
        "discretisation_errors",
    }  # fmt: skip
    assert {field.name for field in fields(Certificate)} == {
        "limit", "expected", "found", "max_residual", "max_overlap",
    }  # fmt: skip


def test_the_digest_of_a_mesh_is_that_of_its_content(box: Mesh) -> None:
    assert mesh_digest(box) == mesh_digest(replace(box, points=box.points.copy()))
    points = box.points.copy()
    points[5, 1] = np.nextafter(points[5, 1], 1.0)
    others = [
        replace(box, points=points),
        replace(box, surfaces={}),
        replace(box, surfaces={name.upper(): facets for name, facets in box.surfaces.items()}),
        replace(box, volumes={}),
        replace(box, blocks=(ElementBlock(box.blocks[0].kind, box.blocks[0].nodes[::-1].copy()),)),
    ]
    assert len({mesh_digest(mesh) for mesh in [box, *others]}) == 6
