"""Moving models of modes: valid glTF 2.0 by the specification's rules, and what an independent reader makes of them."""

import gzip
import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import KDTree

from gearwhine.housing import HousingError, ModeSet, solve_modes
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.pictures.drawn_shapes import (
    _CUTS,
    DRAWN_SCALE,
    DrawnShape,
    drawn_housing,
    outer_skin,
    peak_displacement,
)
from gearwhine.housing.pictures.gltf import light_model, write_mode_models
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import facet_nodes

COMPONENTS = {5126: "<f4", 5125: "<u4"}
WIDTHS = {"SCALAR": 1, "VEC3": 3}


@pytest.fixture(scope="module")
def modes(box_matrices: Matrices) -> ModeSet:
    return solve_modes(box_matrices, count=8)


@pytest.fixture(scope="module")
def file(box: Mesh, modes: ModeSet, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_mode_models(box, modes, [7], tmp_path_factory.mktemp("models"))[0]


class Model:
    """A GLB file taken apart by the rules of the specification."""

    def __init__(self, content: bytes) -> None:
        magic, version, length = struct.unpack_from("<4sII", content)
        assert (magic, version, length) == (b"glTF", 2, len(content))
        size, kind = struct.unpack_from("<I4s", content, 12)
        assert kind == b"JSON"
        assert size % 4 == 0
        text = content[20 : 20 + size]
        self.document: dict[str, Any] = json.loads(text)
        assert text.rstrip(b" ").endswith(b"}")
        start = 20 + size
        size, kind = struct.unpack_from("<I4s", content, start)
        assert kind == b"BIN\0"
        assert size % 4 == 0
        assert start + 8 + size == len(content)
        self.binary = content[start + 8 :]

    def array(self, accessor: int) -> np.ndarray:
        given = self.document["accessors"][accessor]
        view = self.document["bufferViews"][given["bufferView"]]
        width = WIDTHS[given["type"]]
        kind = np.dtype(COMPONENTS[given["componentType"]])
        assert view["byteLength"] == given["count"] * width * kind.itemsize
        flat = np.frombuffer(self.binary, kind, given["count"] * width, view["byteOffset"])
        return flat.reshape(-1, width) if width > 1 else flat

    @property
    def primitive(self) -> dict[str, Any]:
        (mesh,) = self.document["meshes"]
        (primitive,) = mesh["primitives"]
        return primitive

    def attribute(self, name: str) -> np.ndarray:
        return self.array(self.primitive["attributes"][name])

    @property
    def triangles(self) -> np.ndarray:
        return self.array(self.primitive["indices"]).reshape(-1, 3)


@pytest.fixture(scope="module")
def model(file: Path) -> Model:
    return Model(file.read_bytes())


def test_views_lie_one_after_another_on_whole_words(model: Model) -> None:
    (buffer,) = model.document["buffers"]
    assert buffer["byteLength"] <= len(model.binary) < buffer["byteLength"] + 4
    end = 0
    for view in model.document["bufferViews"]:
        assert view["buffer"] == 0
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] == end
        end += view["byteLength"]
    assert end == buffer["byteLength"]


def test_everything_that_is_named_is_there(model: Model) -> None:
    document = model.document
    assert document["asset"]["version"] == "2.0"
    assert document["scenes"][document["scene"]]["nodes"] == [0]
    assert document["nodes"][0]["mesh"] == 0
    assert model.primitive["material"] < len(document["materials"])
    named = [*model.primitive["attributes"].values(), *model.primitive["targets"][0].values()]
    (sampler,) = document["animations"][0]["samplers"]
    named += [model.primitive["indices"], sampler["input"], sampler["output"]]
    assert sorted(named) == list(range(len(document["accessors"])))
    assert [accessor["bufferView"] for accessor in document["accessors"]] == list(range(len(document["bufferViews"])))


def test_bounds_are_those_of_the_numbers(model: Model) -> None:
    bounded = [number for number, accessor in enumerate(model.document["accessors"]) if "min" in accessor]
    animation = model.document["animations"][0]["samplers"][0]["input"]
    positions = [model.primitive["attributes"]["POSITION"], model.primitive["targets"][0]["POSITION"]]
    assert set(bounded) == {*positions, animation}  # where the specification demands them
    for number in bounded:
        accessor, values = model.document["accessors"][number], model.array(number)
        assert accessor["min"] == np.atleast_1d(values.min(axis=0)).tolist()
        assert accessor["max"] == np.atleast_1d(values.max(axis=0)).tolist()


def test_arrays_of_vertices_are_equally_long_and_indices_in_range(model: Model, box: Mesh) -> None:
    count = len(model.attribute("POSITION"))
    assert count == len(facet_nodes(box.boundary))
    assert {len(model.attribute(name)) for name in ("NORMAL", "COLOR_0")} == {count}
    assert {len(model.array(number)) for number in model.primitive["targets"][0].values()} == {count}
    assert len(model.triangles) == 4 * len(box.boundary[0].nodes)
    assert set(np.unique(model.triangles)) == set(range(count))
    colours = model.attribute("COLOR_0")
    assert colours.min() >= 0.0
    assert colours.max() <= 1.0


def test_the_surface_is_closed_and_turned_outward(model: Model, box: Mesh) -> None:
    """Each edge is shared by two triangles that run along it in opposite ways; the enclosed volume is the mesh's."""
    edges = np.concatenate([model.triangles[:, [i, j]] for i, j in ((0, 1), (1, 2), (2, 0))])
    forward, backward = (set(map(tuple, pairs.tolist())) for pairs in (edges, edges[:, ::-1]))
    assert len(forward) == len(edges)
    assert forward == backward
    a, b, c = np.moveaxis(model.attribute("POSITION").astype(float)[model.triangles], 1, 0)
    enclosed = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
    assert enclosed == pytest.approx(box.corner_volumes.sum(), rel=0.01)  # the bores are curved between corners


def test_normals_of_a_cube_point_out_of_it(cube: tuple[Mesh, Matrices]) -> None:
    mesh = cube[0]
    skin = outer_skin(mesh)
    normals = skin.normals(mesh.points[skin.nodes])
    outward = mesh.points[skin.nodes] - 0.05
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0)
    assert np.all(np.einsum("ij,ij->i", normals, outward) > 0.0)
    inside_a_face = np.count_nonzero(np.isclose(np.abs(outward), 0.05), axis=1) == 1
    axis = np.argmax(np.abs(outward[inside_a_face]), axis=1)
    expected = np.sign(outward[inside_a_face]) * (np.arange(3) == axis[:, None])
    assert normals[inside_a_face] == pytest.approx(expected)


def test_the_target_is_the_shape_at_the_scale_of_the_pictures(model: Model, box: Mesh, modes: ModeSet) -> None:
    nodes = facet_nodes(box.boundary)
    shape = modes.shapes[6][nodes]
    moved = model.array(model.primitive["targets"][0]["POSITION"])
    lengths = np.linalg.norm(moved, axis=1)
    diagonal = np.linalg.norm(box.bounds[1] - box.bounds[0])
    assert lengths.max() == pytest.approx(0.07 * diagonal, rel=1e-6)
    assert moved / lengths.max() == pytest.approx(shape / np.linalg.norm(shape, axis=1).max(), abs=1e-6)
    assert model.attribute("POSITION") == pytest.approx(box.points[nodes], abs=1e-7)
    # The brightest end of viridis, (253, 231, 37) of 255, in linear light: where the shape is largest.
    brightest = model.attribute("COLOR_0")[np.argmax(lengths)]
    assert brightest == pytest.approx([0.9823, 0.7991, 0.0185], abs=0.01)
    extras = model.document["meshes"][0]["extras"]
    assert extras["mode"] == 7
    assert extras["frequency_hz"] == modes.frequencies_hz[6]


def test_the_animation_is_one_sine_that_closes(model: Model) -> None:
    (animation,) = model.document["animations"]
    (channel,), (sampler,) = animation["channels"], animation["samplers"]
    assert channel["target"] == {"node": 0, "path": "weights"}
    times, weights = model.array(sampler["input"]), model.array(sampler["output"])
    assert times[0] == 0.0
    assert np.all(np.diff(times) > 0.0)
    assert weights == pytest.approx(np.sin(2 * np.pi * times / times[-1]), abs=1e-6)
    assert (weights.min(), weights.max()) == pytest.approx((-1.0, 1.0))
    # Straight pieces stay within (2π/n)²/8 of a sine.
    assert (2 * np.pi / (len(times) - 1)) ** 2 / 8 < 3e-3


def test_vtk_reads_and_moves_it(file: Path, model: Model) -> None:
    """VTK's own reader of glTF applies the animation: rest, one extreme, the other."""
    vtk = pytest.importorskip("vtkmodules.vtkIOGeometry")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

    reader = vtk.vtkGLTFReader()
    reader.SetFileName(str(file))
    reader.ApplyDeformationsToGeometryOn()
    reader.UpdateInformation()
    assert reader.GetNumberOfAnimations() == 1
    duration = reader.GetAnimationDuration(0)
    assert duration == pytest.approx(2.0)
    reader.EnableAnimation(0)
    reader.SetFrameRate(60)

    def places(time: float) -> np.ndarray:
        information = reader.GetExecutive().GetOutputInformation(0)
        information.Set(vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP(), time)
        reader.UpdateTimeStep(time)
        leaves = reader.GetOutput().NewTreeIterator()
        leaves.InitTraversal()
        surface = leaves.GetCurrentDataObject()
        assert surface.GetNumberOfCells() == len(model.triangles)
        return vtk_to_numpy(surface.GetPoints().GetData()).copy()

    rest, moved = model.attribute("POSITION"), model.array(model.primitive["targets"][0]["POSITION"])
    assert places(0.0) == pytest.approx(rest, abs=1e-7)
    assert places(duration / 4) == pytest.approx(rest + moved, abs=1e-5)
    assert places(3 * duration / 4) == pytest.approx(rest - moved, abs=1e-5)


def test_one_file_for_each_mode_and_no_other(box: Mesh, modes: ModeSet, tmp_path: Path) -> None:
    folder = tmp_path / "new"
    files = write_mode_models(box, modes, [1, 8], folder)
    assert [path.name for path in files] == ["mode-01-0Hz.glb", f"mode-08-{modes.frequencies_hz[7]:.0f}Hz.glb"]
    assert sorted(folder.iterdir()) == sorted(files)
    for numbers in ([0], [9], []):
        with pytest.raises(HousingError, match="give numbers from 1 to 8"):
            write_mode_models(box, modes, numbers, tmp_path)


def test_four_node_tetrahedra_serve_too(block: Callable[..., Mesh]) -> None:
    mesh = block((0.1, 0.1, 0.1), order=1)
    skin = outer_skin(mesh)
    assert skin.nodes[skin.triangles].tolist() == mesh.boundary[0].nodes.tolist()


@pytest.mark.parametrize(("corners", "middles"), [(3, 0), (3, 1), (4, 0), (4, 1), (4, 2)])
def test_facets_of_every_kind_are_cut_whole(corners: int, middles: int) -> None:
    """Cut into triangles that cover the facet once, all turned its way; each node is a corner of some triangle."""
    ring = np.array([[0, 0], [1, 0], [1, 1], [0, 1]] if corners == 4 else [[0, 0], [1, 0], [0, 1]], float)
    nodes = [ring, 0.5 * (ring + np.roll(ring, -1, axis=0)), ring[:4].mean(axis=0, keepdims=True)][: middles + 1]
    points = np.concatenate(nodes)
    cuts = np.array(_CUTS[len(points)])
    a, b, c = np.moveaxis(points[cuts], 1, 0)
    areas = 0.5 * np.linalg.det(np.stack([b - a, c - a], axis=1))
    assert np.all(areas > 0.0)
    assert areas.sum() == pytest.approx(1.0 if corners == 4 else 0.5)
    assert set(cuts.ravel()) == set(range(len(points)))


def test_a_light_model_runs_around_as_its_motion_does(box: Mesh) -> None:
    """Targets by their weights are Re U e^{iθ} of the points that are left, which were there before."""
    surface = drawn_housing(box)
    places = surface.rest / surface.diagonal
    motion = np.stack([np.exp(3j * places[:, 1]), 1j * places[:, 0], places[:, 2] + 0j], axis=1)
    shape = DrawnShape("line", "runs around", "", motion)
    most = len(surface.triangles) // 3
    model = Model(light_model(surface, shape, most))
    assert 0.5 * most < len(model.triangles) <= most
    rest = model.attribute("POSITION")
    distance, kept = KDTree(surface.rest).query(rest)
    assert distance.max() < 1e-3 * surface.diagonal  # of eleven binary digits
    assert len(set(kept)) == len(rest)
    cosine, sine = (model.array(target["POSITION"]).astype(float) for target in model.primitive["targets"])
    (sampler,) = model.document["animations"][0]["samplers"]
    angles = 2.0 * np.pi * model.array(sampler["input"]) / model.array(sampler["input"])[-1]
    weights = model.array(sampler["output"]).reshape(-1, 2)
    np.testing.assert_allclose(weights, np.stack([np.cos(angles), np.sin(angles)], axis=1), atol=1e-6)
    # cosine cos + sine sin = Re (cosine - i sine) e^{iθ}: that is U but for its size and the start of its phase.
    drawn, given = cosine - 1j * sine, motion[kept]
    factor = np.vdot(given, drawn) / np.vdot(given, given)
    np.testing.assert_allclose(drawn, factor * given, atol=2e-3 * np.abs(drawn).max())
    assert peak_displacement(drawn).max() == pytest.approx(DRAWN_SCALE * surface.diagonal, rel=0.02)


def test_a_light_model_is_smaller(box: Mesh, modes: ModeSet, file: Path) -> None:
    surface = drawn_housing(box)
    shape = DrawnShape("mode-07", "mode 7", "", modes.shapes[6][surface.nodes])
    packed = len(gzip.compress(light_model(surface, shape, 10**9)))
    assert packed < 0.6 * len(gzip.compress(file.read_bytes()))
