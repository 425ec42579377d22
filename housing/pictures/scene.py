"""Scene: one housing before one camera, drawn off-screen shape by shape for pictures and films.

The off-screen renderer is PyVista on EGL, or on OSMesa where EGL is missing.
"""

import ctypes
import os
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import RendererUnavailableError
from gearwhine.housing.pictures.drawn_shapes import DRAWN_SCALE, MODE_QUANTITY, DrawnHousing, DrawnShape, Skin
from gearwhine.housing.pictures.views import (
    AUTO,
    IN_WORDS,
    check_view,
    seen_areas,
    view_of_most_motion,
    viewing_direction,
)
from gearwhine.numerics.arrays import FloatArray

_LIBRARIES = (
    ("libEGL.so.1", "vtkEGLRenderWindow"),
    ("libOSMesa.so.8", "vtkOSOpenGLRenderWindow"),
)


def find_renderer() -> str:
    """Name VTK's window for the first library here that draws without a screen; imports nothing.

    Raises
    ------
    RendererUnavailableError
        Where neither EGL nor OSMesa can be loaded. (VTK itself would end the process.)
    """
    for library, window in _LIBRARIES:
        try:
            ctypes.CDLL(library)
        except OSError:
            continue
        return window
    raise RendererUnavailableError(
        "pictures need EGL or OSMesa, and neither library is here. On Debian or Ubuntu install one with\n"
        "    sudo apt-get install libegl1 libegl-mesa0 libgl1"
    )


def load_pyvista() -> Any:
    """Import PyVista, set up to draw without a screen.

    Raises
    ------
    RendererUnavailableError
        As :func:`find_renderer`.
    """
    # Naming the window keeps VTK from asking an X server first.
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", find_renderer())
    import pyvista

    pyvista.OFF_SCREEN = True
    return pyvista


Image = npt.NDArray[np.uint8]

_SHADE = 0.35, 0.75  # ambient and diffuse light
_SIGNED_SHADE = 0.75, 0.3
_COLOURS, _SIGNED_COLOURS = "viridis", "RdBu_r"
_INK = "#202428"
_FINER = 1.5  # pictures are drawn this many times larger than shown
_LOWER = 0.1  # how far below the middle the housing stands, as a part of half the height: captions are above it
_HIGHEST, _LOWEST = 0.72, -0.97  # where the housing ends below the captions and above the edge, likewise
_FULL, _GROWTH = 1000.0, 0.6  # letters have their full size at this width [pixels], and grow slower than the picture
_SHARP_EDGE_ANGLE = 30.0  # angle between faces from which an edge is drawn as one [degrees]


class Scene:
    """The housing, its outline at rest, captions and colours; a context manager, since it holds a window.

    Everything is built once: a shape moves points, colours and letters. Scale, camera and colours are therefore the
    same for all shapes: the largest displacement is drawn as 7 % of the housing's diagonal.

    Parameters
    ----------
    housing : DrawnHousing
    view : str
        One of :data:`gearwhine.housing.pictures.views.VIEWS`.
    size : tuple of int
        Width and height [pixels].
    quantity : str
        Title of the colour bar.
    """

    def __init__(
        self,
        housing: DrawnHousing,
        view: str,
        size: tuple[int, int],
        *,
        quantity: str = MODE_QUANTITY,
    ) -> None:
        check_view(view)
        pyvista = load_pyvista()
        self._housing, self._view = housing, view
        faces = np.hstack([np.full((len(housing.triangles), 1), 3), housing.triangles])
        rest = pyvista.PolyData(housing.rest, faces)
        # A flat face has its rim.
        outline = rest.extract_feature_edges(feature_angle=_SHARP_EDGE_ANGLE, boundary_edges=True, manifold_edges=False)
        # Points on sharp edges stand once for each side, so that shading is smooth on faces and not across edges.
        rest["origin"] = np.arange(len(housing.rest))
        self._solid = rest.compute_normals(
            cell_normals=False, split_vertices=True, feature_angle=_SHARP_EDGE_ANGLE, consistent_normals=False
        )
        self._origin = np.array(self._solid["origin"])
        self._skin = Skin(self._origin, self._solid.regular_faces.astype(np.int64))
        self._solid["shown"] = np.zeros(len(self._origin))
        self._size, self._finer, self._aimed = size, _FINER, ""
        finer = [round(self._finer * length) for length in size]
        self._plotter = pyvista.Plotter(off_screen=True, window_size=finer)
        try:
            self._furnish(outline, quantity)
            self._bounds = rest.bounds
            self._aim(view)
        except BaseException:
            self._plotter.close()
            raise

    def __enter__(self) -> Self:
        """Return the scene itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the renderer."""
        self._plotter.close()

    @cached_property
    def _seen_areas(self) -> dict[str, FloatArray]:
        """Areas of the triangles that are seen from each corner."""
        return seen_areas(self._housing)

    def show(self, shape: DrawnShape) -> None:
        """Put a shape's captions, colours and, where it is to show most motion, view in place."""
        note = shape.note
        if self._view == AUTO:
            view = view_of_most_motion(self._housing, shape, self._seen_areas)
            note = "; ".join(filter(None, (note, IN_WORDS.get(view))))
            self._aim(view)
        self._title.input, self._note.input = shape.title, note
        values = shape.largest * shape.amplitude if shape.values is None else shape.values
        self._solid["shown"] = values[self._origin]
        self._actor.mapper.lookup_table.apply_cmap(_COLOURS if shape.values is None else _SIGNED_COLOURS, 256)
        # Signed colours are read on faces of every direction: shade makes a face look as if it had another value.
        self._actor.prop.ambient, self._actor.prop.diffuse = _SHADE if shape.values is None else _SIGNED_SHADE
        self._actor.mapper.scalar_range = (0.0 if shape.values is None else -shape.largest, shape.largest)

    def picture(self, shape: DrawnShape, angle: float = 0.0) -> Image:
        """Draw a shape at a phase angle [rad], as pixels of shape (height, width, 3)."""
        return self.shrunk(self.drawn(shape, angle))

    def drawn(self, shape: DrawnShape, angle: float = 0.0) -> Image:
        """Draw a shape in the larger size of the renderer."""
        reach = DRAWN_SCALE * self._housing.diagonal
        points = (self._housing.rest + reach * shape.at(angle))[self._origin]
        self._solid.points = points
        self._solid.point_data.active_normals = self._skin.normals(points)
        self._plotter.render_window.Render()  # a screenshot alone shows the previous image
        return np.asarray(self._plotter.screenshot(None, return_img=True))

    def shrunk(self, drawn: Image) -> Image:
        """Reduce a rendered image to the picture's own size."""
        from PIL import Image as Pillow

        return np.array(Pillow.fromarray(drawn).resize(self._size, Pillow.Resampling.HAMMING))

    def _furnish(self, outline: Any, quantity: str) -> None:
        plotter = self._plotter
        plotter.set_background("white")
        # Drawn larger and shrunk: without a GPU VTK's own samples at each pixel take twice as long.
        plotter.render_window.SetMultiSamples(0)
        self._actor = plotter.add_mesh(
            self._solid,
            scalars="shown",
            cmap=_COLOURS,
            clim=(0.0, 1.0),
            smooth_shading=True,
            ambient=_SHADE[0],
            diffuse=_SHADE[1],
            show_scalar_bar=False,
        )
        # The far side of a closed skin is never seen, and costs a third of the drawing.
        self._actor.prop.culling = "back"
        if outline.n_points:  # a smooth body has none
            plotter.add_mesh(outline, color="#707070", line_width=self._finer)
        grown = self._finer * (self._size[0] / _FULL) ** _GROWTH
        letters = 13.5 * grown, 9.0 * grown
        self._title, self._note = (
            plotter.add_text(
                " ", position=(0.03, up), viewport=True, font_size=round(size), color=_INK, font_file=_font_file()
            )
            for up, size in zip((0.97, 0.915), letters, strict=True)
        )
        for text in (self._title, self._note):
            text.prop.justification_vertical = "top"
        # The bar has its part of the width, and so must its letters.
        letter = round(max(9.0, 18.0 * self._size[0] / _FULL) * self._finer)
        plotter.add_scalar_bar(
            title=quantity.replace(" ", "\n", 1) + "\n",
            mapper=self._actor.mapper,
            vertical=True,
            color=_INK,
            n_labels=5,
            fmt="%.3g",
            title_font_size=letter,
            label_font_size=letter,
            position_x=0.885,
            position_y=0.22,
            width=0.06,
            height=0.5,
        )
        plotter.add_axes(color=_INK, xlabel="x", ylabel="y", zlabel="z")

    def look(self, view: str, *, beside: bool = False, bar: bool = True) -> None:
        """Look from another direction.

        Parameters
        ----------
        view : str
            One of :data:`gearwhine.housing.pictures.views.VIEWS`.
        beside : bool
            Whether the picture stands beside one that has the captions; it names its view in their place.
        bar : bool
            Whether the colour bar is drawn.
        """
        if beside:
            self._title.input, self._note.input = " ", "The other side, in the same colours"
        for scalar_bar in self._plotter.scalar_bars.values():
            scalar_bar.SetVisibility(bar)
        self._aim(view)

    def _aim(self, view: str) -> None:
        if view == self._aimed:
            return
        self._aimed = view
        # The plotter's own functions of these names draw the scene anew, whatever is said of that.
        towards, renderer = viewing_direction(view, self._housing.up), self._plotter.renderer
        renderer.view_vector(towards, viewup=self._housing.up, render=False)
        camera = self._plotter.camera
        camera.parallel_projection = True
        renderer.reset_camera(bounds=_frame(self._bounds), render=False)
        camera.zoom(1.2)
        camera.SetWindowCenter(0.0, _LOWER)
        corners = np.stack(np.meshgrid(*np.reshape(self._bounds, (3, 2))), axis=-1).reshape(-1, 3)
        upwards = (corners - np.array(camera.focal_point)) @ _upwards(camera)
        # Few shapes move the highest corner most, and straight upwards.
        room = 0.4 * DRAWN_SCALE * float(np.linalg.norm(np.diff(self._bounds)[::2]))
        fitting = max((upwards.max() + room) / (_HIGHEST + _LOWER), (upwards.min() - room) / (_LOWEST + _LOWER))
        camera.parallel_scale = max(camera.parallel_scale, fitting)


def _upwards(camera: Any) -> FloatArray:
    """Return the unit vector in space that points upwards in the picture."""
    towards = np.subtract(camera.position, camera.focal_point)
    towards /= np.linalg.norm(towards)
    up = np.array(camera.up) - np.dot(camera.up, towards) * towards
    return np.asarray(up / np.linalg.norm(up))


def _font_file() -> str:
    """Return the file of a font with arrows and µ, which the renderer's own lacks."""
    import matplotlib as mpl

    return str(Path(mpl.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf"))


def _frame(bounds: Sequence[float]) -> list[float]:
    """Return the bounds at rest with room for the largest displacement, so that every shape has the same scale."""
    low, high = np.array(bounds[::2]), np.array(bounds[1::2])
    room = DRAWN_SCALE * float(np.linalg.norm(high - low))
    return [float(value) for pair in zip(low - room, high + room, strict=True) for value in pair]
