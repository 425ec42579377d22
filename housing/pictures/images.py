"""Pictures and animations of mode shapes and operating deflection shapes, drawn off-screen with PyVista.

Pictures are single or on a sheet; animations are GIF by Pillow, or MP4 by ffmpeg where there is one.
"""

import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import EncoderUnavailableError
from gearwhine.housing.pictures.drawn_shapes import DrawnHousing, DrawnShape
from gearwhine.housing.pictures.scene import Scene
from gearwhine.housing.pictures.views import AUTO
from gearwhine.housing.storage.atomic_file import atomic_file

FilmFormat = Literal["gif", "mp4"]
Image = npt.NDArray[np.uint8]

_COLUMNS = 4  # columns of a sheet
_TILE = 0.52  # size of a picture on a sheet, as a part of its own
_FRAMES = 24  # frames of one period; even, so that half of them mirror the others where the motion has one phase
_FRAME = 80  # duration of each frame [ms]
_PAPER = 240  # a pixel with all three colours above it is background or its soft edge
_PERIODS = 4  # periods of an MP4, which players show once; a GIF goes round


def render_shapes(
    housing: DrawnHousing,
    shapes: Sequence[DrawnShape],
    folder: Path,
    *,
    view: str = AUTO,
    beside: str | None = None,
    size: tuple[int, int] = (1000, 780),
    progress: Callable[[str], None] = lambda message: None,
) -> list[Path]:
    """Draw one picture of each shape, where it is widest, named after it, into a folder; return the files.

    The colours are titled by the quantity of the first. With a view ``beside``, such as the opposite one, each picture
    is two of that size side by side, with one scale of colours.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / f"{shape.name}.png" for shape in shapes]
    saving: Future[None] | None = None
    # While one picture is shrunk and written, the next is drawn.
    with Scene(housing, view, size, quantity=shapes[0].quantity) as scene, ThreadPoolExecutor(1) as pool:
        for shape, path in zip(shapes, files, strict=True):
            progress(f"drawing {shape.title}")
            scene.show(shape)
            if beside is not None:
                scene.look(view, bar=False)
            drawn = [scene.drawn(shape)]
            if beside is not None:
                scene.look(beside, beside=True)
                drawn.append(scene.drawn(shape))
            if saving is not None:
                saving.result()
            saving = pool.submit(_shrink_and_save, scene, drawn, path)
        if saving is not None:
            saving.result()
    return files


def render_sheet(files: Sequence[Path], path: Path) -> Path:
    """Put pictures of one size on one sheet, smaller, up to four in a row."""
    from PIL import Image

    with Image.open(files[0]) as first:
        width, height = (round(_TILE * length) for length in first.size)
    columns = min(_COLUMNS, len(files))
    sheet = Image.new("RGB", (columns * width, -(-len(files) // columns) * height), "white")
    for place, file in enumerate(files):
        row, column = divmod(place, columns)
        with Image.open(file) as picture:
            smaller = picture.convert("RGB").resize((width, height), Image.Resampling.HAMMING)
        sheet.paste(smaller, (column * width, row * height))
    _save(np.asarray(sheet), path)
    return path


def _shrink_and_save(scene: Scene, drawn: Sequence[Image], path: Path) -> None:
    """Write images side by side, each in the size of a picture."""
    _save(np.concatenate([scene.shrunk(one) for one in drawn], axis=1), path)


def _save(image: npt.NDArray[np.uint8], path: Path) -> None:
    """Write a PNG that appears whole or not at all."""
    from PIL import Image

    with atomic_file(path) as staged:
        Image.fromarray(image).save(staged, format="PNG", compress_level=2)


def find_encoder() -> str:
    """Find ffmpeg on this machine, or the one that comes with the package imageio-ffmpeg.

    Raises
    ------
    EncoderUnavailableError
        Where there is neither.
    """
    if path := shutil.which("ffmpeg"):
        return path
    try:
        import imageio_ffmpeg

        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        raise EncoderUnavailableError(
            "MP4 needs ffmpeg, and it is not here: install it (sudo apt-get install ffmpeg, or "
            "pip install imageio-ffmpeg), or choose --format gif, which needs nothing more"
        ) from None


def animate_shapes(
    housing: DrawnHousing,
    shapes: Sequence[DrawnShape],
    folder: Path,
    film: FilmFormat,
    *,
    view: str = AUTO,
    size: tuple[int, int] = (640, 500),
    progress: Callable[[str], None] = lambda message: None,
) -> list[Path]:
    """Film one period of each shape, from where it is widest; colours are amplitudes and stand still.

    Parameters
    ----------
    housing : DrawnHousing
    shapes : sequence of DrawnShape
        Shapes, each of which names a file. The colours are titled by the quantity of the first.
    folder : path
        Folder of the films; made where it is missing.
    film : {"gif", "mp4"}
    view : str
        One of :data:`gearwhine.housing.pictures.views.VIEWS`.
    size : tuple of int
        Width and height [pixels], both even.
    progress : callable
        Called with a line of text before each shape.

    Returns
    -------
    list of path

    Raises
    ------
    RendererUnavailableError, EncoderUnavailableError
        Where no library draws without a screen, or no program encodes MP4.
    """
    encoder = find_encoder() if film == "mp4" else ""
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    with Scene(housing, view, size, quantity=shapes[0].quantity) as scene:
        for shape in shapes:
            progress(f"filming {shape.title}")
            frames = list(_frames(scene, shape))
            path = folder / f"{shape.name}.{film}"
            with atomic_file(path) as staged:
                if film == "gif":
                    _write_gif(frames, staged)
                else:
                    _write_mp4(encoder, frames, staged)
            files.append(path)
    return files


def _frames(scene: Scene, shape: DrawnShape) -> Iterator[Image]:
    """Draw the frames of one period; a motion in one phase comes back the way it went, so that half are drawn."""
    scene.show(shape)
    drawn: list[Image] = []
    for number in range(_FRAMES):
        if np.isrealobj(shape.motion) and number > _FRAMES // 2:
            yield drawn[_FRAMES - number]
            continue
        drawn.append(scene.picture(shape, 2.0 * np.pi * number / _FRAMES))
        yield drawn[-1]


def _write_gif(frames: Sequence[Image], path: Path) -> None:
    """Write a GIF with one palette, from three frames: no colour flickers, and only moving parts are stored anew."""
    from PIL import Image as Pillow

    # Each colour counts once, however much of it there is: most of a frame is white.
    pixels = np.concatenate([frame.reshape(-1, 3) for frame in frames[:: len(frames) // 3]])
    pixels = pixels[(pixels < _PAPER).any(axis=1)]  # nearly white pixels become white
    palette = Pillow.fromarray(np.unique(pixels, axis=0)[None]).quantize(colors=255, method=Pillow.Quantize.MEDIANCUT)
    palette.putpalette([255, 255, 255, *(palette.getpalette() or [])[: 3 * 255]])
    images = [Pillow.fromarray(frame).quantize(palette=palette, dither=Pillow.Dither.NONE) for frame in frames]
    images[0].save(path, format="GIF", save_all=True, append_images=images[1:], duration=_FRAME, loop=0, optimize=False)


def _write_mp4(encoder: str, frames: Sequence[Image], path: Path) -> None:
    height, width = frames[0].shape[:2]
    command = [
        *(encoder, "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}"),
        *("-r", f"{1000 / _FRAME:g}", "-i", "-", "-an", "-pix_fmt", "yuv420p", "-movflags", "+faststart"),
        *("-f", "mp4", str(path)),
    ]
    pixels = b"".join(frame.tobytes() for frame in frames) * _PERIODS
    try:
        done = subprocess.run(command, input=pixels, capture_output=True, check=False)
    except OSError as error:
        raise EncoderUnavailableError(f"{encoder} cannot be run: {error.strerror}") from error
    if done.returncode != 0:
        said = done.stderr.decode(errors="replace").strip().splitlines()
        raise EncoderUnavailableError(f"{encoder} could not write MP4: {said[-1] if said else done.returncode}")
