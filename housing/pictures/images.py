"""Pictures of mode shapes and operating deflection shapes, drawn off-screen with PyVista: single or on a sheet."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import numpy.typing as npt

from housing.modes.natural_modes import ModeSet
from housing.pictures.drawn_shapes import DrawnHousing, DrawnShape, drawn_housing, drawn_modes
from housing.pictures.scene import STRIP, VIEWS, Scene, check_view, colour_strip
from housing.storage.atomic_file import atomic_file
from meshes import Mesh

__all__ = ["VIEWS", "render_gallery", "render_modes", "render_shapes", "render_sheet"]

_COLUMNS = 4  # of a sheet


def render_modes(
    mesh: Mesh,
    modes: ModeSet,
    numbers: Sequence[int],
    folder: Path,
    *,
    notes: Mapping[int, str] | None = None,
    view: str = "iso",
    size: tuple[int, int] = (1000, 780),
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
    notes : mapping of int to str, optional
        A second line under a mode's title.
    view : str
        One of :data:`VIEWS`.
    size : tuple of int
        Width and height of a picture [pixels].
    progress : callable
        Called with a line of text before each mode.

    Returns
    -------
    list of path
        The files, in the order of ``numbers``.

    Raises
    ------
    HousingError
        Where there is no mode of that number, or no view of that name.
    RendererUnavailableError
        Where no library draws without a screen.
    """
    check_view(view)
    housing = drawn_housing(mesh)
    shapes = drawn_modes(housing, modes, numbers, notes)
    return render_shapes(housing, shapes, folder, view=view, size=size, progress=progress)


def render_gallery(
    mesh: Mesh,
    modes: ModeSet,
    numbers: Sequence[int],
    path: Path,
    *,
    notes: Mapping[int, str] | None = None,
    view: str = "iso",
    tile: tuple[int, int] = (520, 420),
) -> Path:
    """Draw several modes on one sheet, up to four in a row, over a colour bar; see :func:`render_modes`."""
    check_view(view)
    housing = drawn_housing(mesh)
    return render_sheet(housing, drawn_modes(housing, modes, numbers, notes), path, view=view, tile=tile)


def render_shapes(
    housing: DrawnHousing,
    shapes: Sequence[DrawnShape],
    folder: Path,
    *,
    view: str = "iso",
    size: tuple[int, int] = (1000, 780),
    progress: Callable[[str], None] = lambda message: None,
) -> list[Path]:
    """Draw one picture of each shape, where it is widest, named after it; see :func:`render_modes`.

    The colours are titled by the quantity of the first.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / f"{shape.name}.png" for shape in shapes]
    saving: Future[None] | None = None
    # While one picture is shrunk and written, the next is drawn.
    with Scene(housing, view, size, quantity=shapes[0].quantity) as scene, ThreadPoolExecutor(1) as pool:
        for shape, path in zip(shapes, files, strict=True):
            progress(f"drawing {shape.title}")
            scene.show(shape)
            drawn = scene.drawn(shape)
            if saving is not None:
                saving.result()
            saving = pool.submit(_shrink_and_save, scene, drawn, path)
        if saving is not None:
            saving.result()
    return files


def render_sheet(
    housing: DrawnHousing,
    shapes: Sequence[DrawnShape],
    path: Path,
    *,
    view: str = "iso",
    tile: tuple[int, int] = (520, 420),
) -> Path:
    """Draw shapes on one sheet, up to four in a row, over a colour bar; each is coloured by part of its largest."""
    columns = min(_COLUMNS, len(shapes))
    rows = -(-len(shapes) // columns)
    width, height = tile
    sheet = np.full((rows * height + STRIP, columns * width, 3), 255, dtype=np.uint8)
    with Scene(housing, view, tile, tile=True) as scene:
        for place, shape in enumerate(shapes):
            scene.show(shape)
            row, column = divmod(place, columns)
            sheet[row * height : (row + 1) * height, column * width : (column + 1) * width] = scene.picture(shape)
    sheet[rows * height :] = colour_strip(columns * width)
    _save(sheet, path)
    return path


def _shrink_and_save(scene: Scene, drawn: npt.NDArray[np.uint8], path: Path) -> None:
    _save(scene.shrunk(drawn), path)


def _save(image: npt.NDArray[np.uint8], path: Path) -> None:
    """Write a PNG that appears whole or not at all."""
    from PIL import Image

    with atomic_file(path) as staged:
        Image.fromarray(image).save(staged, format="PNG", compress_level=2)
