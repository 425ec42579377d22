"""Pictures of mode shapes, drawn off-screen with PyVista."""

import ctypes
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError
from housing.modes import ModeSet
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]

_VIEWS = {
    "iso": (1.0, 0.75, 1.25),
    "front": (0.0, 0.0, 1.0),
    "back": (0.0, 0.0, -1.0),
    "left": (-1.0, 0.0, 0.0),
    "right": (1.0, 0.0, 0.0),
    "top": (0.0, 1.0, 0.001),
}
VIEWS = tuple(_VIEWS)
_COLOURS = "viridis"
_SCALE = 0.07  # largest displacement drawn, as a part of the housing's diagonal
_STRIP = 34  # height of the colour bar's strip under a sheet of modes [pixels]
_INK = "#202428"
# Triangles between neighbouring nodes of each kind of facet, so that its middle nodes bend too.
_PIECES = {
    "triangle": [[0, 1, 2]],
    "triangle6": [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
    "quad": [[0, 1, 2], [0, 2, 3]],
    "quad8": [[0, 4, 7], [1, 5, 4], [2, 6, 5], [3, 7, 6], [4, 5, 6], [4, 6, 7]],
    "quad9": [[0, 4, 8], [0, 8, 7], [4, 1, 5], [4, 5, 8], [8, 5, 2], [8, 2, 6], [7, 8, 6], [7, 6, 3]],
}


class RendererUnavailableError(RuntimeError):
    """No library that draws without a screen is on this machine; the message says which to install."""


def load_pyvista() -> Any:
    """Import PyVista, set up to draw without a screen.

    Raises
    ------
    RendererUnavailableError
        Where neither EGL nor OSMesa can be loaded. (VTK itself would end the process.)
    """
    for library, window in (
        ("libEGL.so.1", "vtkEGLRenderWindow"),
        ("libOSMesa.so.8", "vtkOSOpenGLRenderWindow"),
    ):
        try:
            ctypes.CDLL(library)
        except OSError:
            continue
        # Naming the window keeps VTK from asking an X server first.
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", window)
        break
    else:
        raise RendererUnavailableError(
            "pictures need EGL or OSMesa, and neither library is here. On Debian or Ubuntu install one with\n"
            "    sudo apt-get install libegl1 libegl-mesa0 libgl1"
        )
    import pyvista

    pyvista.OFF_SCREEN = True
    return pyvista


def render_modes(
    mesh: Mesh,
    modes: ModeSet,
    numbers: Sequence[int],
    folder: Path,
    *,
    notes: dict[int, str] | None = None,
    view: str = "iso",
    size: tuple[int, int] = (1100, 850),
    progress: Callable[[str], None] = lambda message: None,
) -> list[Path]:
    """Draw one picture for each mode: ``mode-03-1007Hz.png`` and so on.

    Parameters
    ----------
    mesh, modes
        The housing and its modes.
    numbers : sequence of int
        Which modes, from 1.
    folder : path
        Where the pictures go; made where it is missing.
    notes : dict of int to str, optional
        A second line under a mode's title.
    view : str
        One of :data:`VIEWS`.
    size : tuple of int
        Width and height of a picture [pixels].
    progress : callable
        Told which mode is drawn.

    Returns
    -------
    list of path
        The files, in the order of ``numbers``.

    Raises
    ------
    HousingError
        Where there is no mode of that number, or no view of that name.
    """
    _check(modes, numbers, view)
    pyvista = load_pyvista()
    folder.mkdir(parents=True, exist_ok=True)
    surface, nodes = _outer_surface(pyvista, mesh)
    outline = surface.extract_feature_edges(feature_angle=30.0, boundary_edges=False, manifold_edges=False)
    files = []
    for number in numbers:
        progress(f"drawing mode {number}")
        path = folder / f"mode-{number:02d}-{modes.frequencies_hz[number - 1]:.0f}Hz.png"
        plotter = pyvista.Plotter(off_screen=True, window_size=size)
        try:
            shape, note = modes.shapes[number - 1][nodes], (notes or {}).get(number, "")
            _draw(plotter, surface, outline, shape, _title(modes, number), note, view)
            _save(plotter.screenshot(None, return_img=True), path)
        finally:
            plotter.close()
        files.append(path)
    return files


def render_gallery(
    mesh: Mesh,
    modes: ModeSet,
    numbers: Sequence[int],
    path: Path,
    *,
    notes: dict[int, str] | None = None,
    view: str = "iso",
    tile: tuple[int, int] = (520, 440),
) -> Path:
    """Draw several modes on one sheet, up to four in a row, over a colour bar; see :func:`render_modes`."""
    _check(modes, numbers, view)
    pyvista = load_pyvista()
    surface, nodes = _outer_surface(pyvista, mesh)
    outline = surface.extract_feature_edges(feature_angle=30.0, boundary_edges=False, manifold_edges=False)
    columns = min(4, len(numbers))
    rows = -(-len(numbers) // columns)
    plotter = pyvista.Plotter(
        off_screen=True,
        shape=(rows + 1, columns),
        row_weights=[(rows * tile[1] - _STRIP) / rows] * rows + [_STRIP],
        groups=[(rows, slice(None))],
        window_size=(columns * tile[0], rows * tile[1]),
        border=False,
    )
    try:
        for place, number in enumerate(numbers):
            plotter.subplot(*divmod(place, columns))
            shape, note = modes.shapes[number - 1][nodes], (notes or {}).get(number, "")
            _draw(plotter, surface, outline, shape, _title(modes, number), note, view, bar=False)
        plotter.subplot(rows, 0)
        _draw_bar(pyvista, plotter, columns * tile[0] / _STRIP)
        _save(plotter.screenshot(None, return_img=True), path)
    finally:
        plotter.close()
    return path


def _check(modes: ModeSet, numbers: Sequence[int], view: str) -> None:
    missing = [number for number in numbers if not 1 <= number <= len(modes.shapes)]
    if missing or not numbers:
        raise HousingError(f"modes {missing or 'none'} asked for; give numbers from 1 to {len(modes.shapes)}")
    if view not in _VIEWS:
        raise HousingError(f"no view {view!r}; there are {', '.join(VIEWS)}")


def _outer_surface(pyvista: Any, mesh: Mesh) -> tuple[Any, npt.NDArray[np.int64]]:
    """The boundary as triangles between neighbouring nodes, and the nodes that it uses."""
    pieces = [block.nodes[:, _PIECES[block.kind]].reshape(-1, 3) for block in mesh.boundary]
    nodes, triangles = np.unique(np.concatenate(pieces), return_inverse=True)
    triangles = triangles.reshape(-1, 3)
    faces = np.hstack([np.full((len(triangles), 1), 3), triangles])
    return pyvista.PolyData(mesh.points[nodes], faces), nodes


def _title(modes: ModeSet, number: int) -> str:
    return f"Mode {number}   {modes.frequencies_hz[number - 1]:.0f} Hz"


def _draw(
    plotter: Any,
    surface: Any,
    outline: Any,
    shape: FloatArray,
    title: str,
    note: str,
    view: str,
    *,
    bar: bool = True,
) -> None:
    amplitude = np.linalg.norm(shape, axis=1)
    largest = float(amplitude.max())
    deformed = surface.copy()
    deformed.points = surface.points + shape * (_SCALE * surface.length / largest)
    deformed["displacement"] = amplitude / largest
    plotter.set_background("white")
    plotter.add_mesh(
        deformed,
        scalars="displacement",
        cmap=_COLOURS,
        clim=(0.0, 1.0),
        smooth_shading=True,
        split_sharp_edges=True,
        ambient=0.35,
        diffuse=0.75,
        show_scalar_bar=False,
    )
    plotter.add_mesh(outline, color="#707070", line_width=1.0)
    plotter.add_text(title, position=(0.03, 0.93), viewport=True, font_size=15 if bar else 10, color=_INK, shadow=False)
    if note:
        plotter.add_text(note, position=(0.03, 0.885), viewport=True, font_size=10 if bar else 7, color=_INK)
    if bar:
        plotter.add_scalar_bar(
            title="Displacement\n/ largest\n",
            vertical=True,
            color=_INK,
            n_labels=5,
            fmt="%.2f",
            title_font_size=18,
            label_font_size=18,
            position_x=0.885,
            position_y=0.22,
            width=0.06,
            height=0.5,
        )
        plotter.add_axes(color=_INK, xlabel="x", ylabel="y", zlabel="z")
    plotter.view_vector(_VIEWS[view], viewup=(0.0, 1.0, 0.0))
    plotter.enable_parallel_projection()
    plotter.reset_camera(bounds=_frame(surface.bounds))
    plotter.camera.zoom(1.25)


def _draw_bar(pyvista: Any, plotter: Any, width: float) -> None:
    """A thin colour bar with its ends named, across a strip ``width`` times as wide as high."""
    bar = pyvista.ImageData(dimensions=(256, 2, 1), spacing=(5.0 / 255, 0.3, 1.0), origin=(0.5, -0.15, 0.0))
    bar["displacement"] = bar.points[:, 0]
    plotter.set_background("white")
    plotter.add_mesh(bar, scalars="displacement", cmap=_COLOURS, lighting=False, show_scalar_bar=False)
    for text, edge, side in (("displacement / largest   0 ", 0.5, "right"), (" 1", 5.5, "left")):
        position = (0.5 + edge / width, 0.5)
        actor = plotter.add_text(text, position=position, viewport=True, font_size=9, color=_INK)
        actor.prop.justification_horizontal = side
        actor.prop.justification_vertical = "center"
    plotter.view_xy()
    plotter.enable_parallel_projection()
    plotter.camera.focal_point, plotter.camera.position = (0.0, 0.0, 0.0), (0.0, 0.0, 10.0)
    plotter.camera.parallel_scale = 0.5  # the strip is one unit high


def _frame(bounds: Sequence[float]) -> list[float]:
    """The undeformed bounds with room for the largest displacement, so that every mode has the same scale."""
    low, high = np.array(bounds[::2]), np.array(bounds[1::2])
    room = _SCALE * float(np.linalg.norm(high - low))
    return [float(value) for pair in zip(low - room, high + room, strict=True) for value in pair]


def _save(image: npt.NDArray[np.uint8], path: Path) -> None:
    """Write a PNG that appears whole or not at all."""
    from PIL import Image

    temporary = path.with_name(f".{path.name}.part")
    Image.fromarray(image).save(temporary, format="PNG", optimize=False)
    os.replace(temporary, path)
