"""Pictures of modes: they exist, have their size, show something, and differ."""

import subprocess
import sys
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from PIL import Image

from gearwhine.housing import HousingError, ModeSet, solve_modes
from gearwhine.housing.errors import RendererUnavailableError
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.pictures.drawn_shapes import DrawnHousing, DrawnShape, drawn_housing, drawn_modes
from gearwhine.housing.pictures.images import render_shapes, render_sheet
from gearwhine.housing.pictures.scene import find_renderer
from gearwhine.housing.pictures.views import VIEWS
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import facet_nodes
from gearwhine.view_names import View


@pytest.fixture(scope="module")
def modes(box_matrices: Matrices) -> ModeSet:
    return solve_modes(box_matrices, count=8)


@pytest.fixture(scope="module")
def renderer() -> None:
    try:
        find_renderer()
    except RendererUnavailableError as error:
        pytest.skip(str(error))


def _pixels(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        assert image.format == "PNG"
        return np.asarray(image.convert("RGB"))


def render_modes(mesh: Mesh, modes: ModeSet, numbers: Sequence[int], folder: Path, **how: Any) -> list[Path]:
    housing = drawn_housing(mesh)
    return render_shapes(housing, drawn_modes(housing, modes, numbers, how.pop("notes", None)), folder, **how)


@pytest.mark.usefixtures("renderer")
def test_two_modes_make_two_different_pictures(box: Mesh, modes: ModeSet, tmp_path: Path) -> None:
    told: list[str] = []
    folder = tmp_path / "pictures"
    files = render_modes(box, modes, [7, 8], folder, notes={8: "strong"}, size=(320, 240), progress=told.append)
    hertz = modes.frequencies_hz
    assert [path.name for path in files] == [f"mode-07-{hertz[6]:.0f}Hz.png", f"mode-08-{hertz[7]:.0f}Hz.png"]
    assert sorted(folder.iterdir()) == sorted(files)
    assert told == [f"drawing Mode 7   {hertz[6]:.0f} Hz", f"drawing Mode 8   {hertz[7]:.0f} Hz"]
    first, second = (_pixels(path) for path in files)
    assert first.shape == second.shape == (240, 320, 3)
    for image in (first, second):
        colours = np.unique(image.reshape(-1, 3), axis=0)
        assert len(colours) > 50
        grey = np.ptp(image.astype(int), axis=2) < 12
        assert np.count_nonzero(~grey) > 0.05 * grey.size  # the coloured solid fills part of the sheet
    assert np.mean(np.any(first != second, axis=2)) > 0.02


@pytest.mark.usefixtures("renderer")
def test_a_tall_housing_stands_below_its_captions(block: Callable[..., Mesh], tmp_path: Path) -> None:
    """Captions take the highest seventh of a picture, whatever the proportions of the housing."""
    for size in ((0.2, 0.5, 0.2), (0.3, 0.3, 0.3), (0.1, 0.8, 0.6)):
        surface = drawn_housing(block(size, (2, 2, 2)))
        shape = DrawnShape("high", "", "", 0.0 * surface.rest, "I", 1.0, np.ones(len(surface.rest)))
        image = _pixels(render_shapes(surface, [shape], tmp_path, size=(320, 240))[0])[:, :280]
        rows = np.flatnonzero((image < 250).any(axis=(1, 2)))
        assert 34 <= rows[0] < 100
        assert rows[-1] < 238


@pytest.mark.usefixtures("renderer")
def test_views_differ_and_a_picture_is_repeatable(box: Mesh, modes: ModeSet, tmp_path: Path) -> None:
    images = {
        name: _pixels(render_modes(box, modes, [7], tmp_path / name, size=(160, 120), view=view)[0])
        for name, view in (("once", "iso"), ("again", "iso"), ("top", "top"))
    }
    assert np.array_equal(images["once"], images["again"])
    assert not np.array_equal(images["once"], images["top"])


@pytest.mark.usefixtures("renderer")
def test_values_of_either_sign_have_their_own_colours(box: Mesh, modes: ModeSet, tmp_path: Path) -> None:
    """Red at the greater x, where the values are positive and on the right of the picture from the front."""
    surface = drawn_housing(box)
    values = surface.rest[:, 0] - surface.rest[:, 0].mean()
    shape = DrawnShape("signed", "", "", modes.shapes[6][surface.nodes], "x [m]", float(values.max()), values)
    image = _pixels(render_shapes(surface, [shape], tmp_path, view="front", size=(320, 240))[0]).astype(int)
    redder = image[..., 0] - image[..., 2]
    right = np.arange(280) > 140
    red, blue = redder[:, :280] > 60, redder[:, :280] < -60
    assert np.count_nonzero(red[:, right]) > 500
    assert np.count_nonzero(blue[:, ~right]) > 500
    assert not red[60:180, :100].any()  # above the axes


@pytest.mark.usefixtures("renderer")
def test_two_opposite_views_show_every_face_in_one_scale(box: Mesh, tmp_path: Path) -> None:
    """Left the top, right and front, right the underside, left and back: red faces are where the values are."""
    surface = drawn_housing(box)
    low, high = surface.rest.min(axis=0), surface.rest.max(axis=0)
    found = {}
    for name, on in (("top", surface.rest[:, 1] == high[1]), ("underside", surface.rest[:, 1] == low[1])):
        shape = DrawnShape(name, "", "", 0.0 * surface.rest, "I", 1.0, np.where(on, 1.0, 0.0))
        (path,) = render_shapes(surface, [shape], tmp_path, beside="iso-opposite", size=(320, 240))
        image = _pixels(path).astype(int)
        assert image.shape == (240, 640, 3)
        redder = (image[..., 0] - image[..., 2])[40:]
        found[name] = [np.count_nonzero(half[:, :280] > 30) for half in (redder[:, :320], redder[:, 320:])]
        # One bar, on the right.
        bars = [np.count_nonzero(np.abs(half[:, 283:302]) > 60) for half in (redder[:, :320], redder[:, 320:])]
        assert bars[0] == 0
        assert bars[1] > 100
    # The other side shows the rim alone.
    assert found["top"][0] > 3 * found["top"][1]
    assert found["underside"][1] > 3 * found["underside"][0]
    assert min(found["top"][0], found["underside"][1]) > 500


@pytest.mark.usefixtures("renderer")
def test_a_flat_face_alone_is_drawn_with_its_rim(tmp_path: Path) -> None:
    """It has no edge between faces; its rim is grey in front of its red."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    face = DrawnHousing(corners, np.array([[0, 1, 2], [0, 2, 3]]), np.arange(4))
    shape = DrawnShape("flat", "", "", 0.0 * corners, "I", 1.0, np.ones(4))
    image = _pixels(render_shapes(face, [shape], tmp_path, view="front", size=(320, 240))[0]).astype(int)[40:, :280]
    red = image[..., 0] - image[..., 2] > 60
    assert np.count_nonzero(red) > 500
    rows, columns = np.nonzero(red)
    rim = image[rows.min() - 2 : rows.min() + 1, columns.min() : columns.max()].min(axis=0)
    assert np.median(rim.max(axis=1)) < 200


@pytest.mark.usefixtures("renderer")
def test_an_arrow_in_a_title_is_drawn(box: Mesh, modes: ModeSet, tmp_path: Path) -> None:
    """Dark pixels where the arrow is, which are none for a space or for a letter that the font lacks."""
    surface = drawn_housing(box)
    dark = []
    for number, title in enumerate(("→→→→", " ")):
        shape = DrawnShape(f"shape-{number}", title, "", modes.shapes[6][surface.nodes], "d", 1.0)
        image = _pixels(render_shapes(surface, [shape], tmp_path, size=(640, 480))[0])
        dark.append(np.count_nonzero(image[:40, :200].max(axis=2) < 128))
    assert dark[1] == 0
    assert dark[0] > 50


def test_a_sheet_has_its_pictures_four_in_a_row(tmp_path: Path) -> None:
    colours = [(40 * number, 200 - 30 * number, 90) for number in range(5)]
    for colour in colours:
        Image.new("RGB", (200, 100), colour).save(tmp_path / f"{colour[0]}.png")
    sheet = _pixels(render_sheet([tmp_path / f"{colour[0]}.png" for colour in colours], tmp_path / "sheet.png"))
    assert sheet.shape == (104, 416, 3)
    white = (255, 255, 255)
    assert [tuple(sheet[y, x]) for y in (26, 78) for x in (52, 156, 260, 364)] == [*colours, white, white, white]


def test_pictures_of_modes_that_are_not_there_are_refused(box: Mesh, modes: ModeSet, tmp_path: Path) -> None:
    for numbers in ([0], [-1], [9], []):
        with pytest.raises(HousingError, match="give numbers from 1 to 8"):
            render_modes(box, modes, numbers, tmp_path)
    with pytest.raises(HousingError, match="no view 'below'; there are auto, iso"):
        render_modes(box, modes, [7], tmp_path, view="below")
    assert sorted(get_args(View)) == sorted(VIEWS)
    assert not list(tmp_path.iterdir())


def _run(script: str) -> subprocess.CompletedProcess[str]:
    command = "import sys; sys.path[:0] = " + repr(sys.path) + "\n" + textwrap.dedent(script)
    return subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, timeout=60, check=False)


def test_without_egl_and_osmesa_the_packages_to_install_are_named() -> None:
    done = _run("""
        def refuse(event, arguments):
            if event == "ctypes.dlopen" and arguments[0] and ("EGL" in arguments[0] or "OSMesa" in arguments[0]):
                raise OSError(f"{arguments[0]}: cannot open shared object file")
        sys.addaudithook(refuse)
        from gearwhine.housing.errors import RendererUnavailableError
        from gearwhine.housing.pictures.scene import load_pyvista
        try:
            load_pyvista()
        except RendererUnavailableError as error:
            print(error)
        print("pyvista" in sys.modules)
    """)
    assert "sudo apt-get install libegl1" in done.stdout, done.stderr
    assert done.stdout.strip().endswith("False")


def test_middle_nodes_bend_the_drawn_surface(block: Callable[..., Mesh]) -> None:
    mesh = block((0.1, 0.1, 0.1))
    drawn = drawn_housing(mesh)
    assert set(drawn.nodes) == set(facet_nodes(mesh.boundary))
    assert len(drawn.triangles) == 4 * len(mesh.boundary[0])
    corners = drawn.rest[drawn.triangles]
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    assert areas.sum() == pytest.approx(6 * 0.1**2)
    assert drawn.diagonal == pytest.approx(0.1 * np.sqrt(3.0))
