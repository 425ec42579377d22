"""Drawing process: VTK in a process of its own, so that its crash is reported and the command goes on.

The process reads the names of folders, one a line, and in each folder plain data: a file of arrays (``.npz``, without
pickled objects) and a file of JSON. It answers in lines of JSON: its progress, and at last the names of the files, or
the error. A command that is to draw at its end may start it at its beginning, and have it draw while other work goes on
(:meth:`_DrawingProcess.beside`).
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from contextvars import ContextVar, copy_context
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, NamedTuple, Self, TypeVar

import numpy as np

import gearwhine
from gearwhine.housing.errors import EncoderUnavailableError, HousingError, RendererUnavailableError
from gearwhine.housing.pictures.drawn_shapes import DrawnHousing, DrawnShape
from gearwhine.housing.pictures.scene import load_pyvista
from gearwhine.interruption import cleared_at_the_end
from gearwhine.numerics.progress import Progress, silent

if TYPE_CHECKING:
    from matplotlib.figure import Figure

T = TypeVar("T")

_ERRORS = (EncoderUnavailableError, HousingError, RendererUnavailableError)
_CAPTIONS = ("name", "title", "note", "quantity", "largest")


@contextmanager
def one_process() -> Iterator["_DrawingProcess"]:
    """Draw all shapes of this block in one process, which takes longer to start than to draw a dozen shapes.

    It starts with the first, and ends with the block, whatever ends that.
    """
    if (kept := _kept.get()) is not None:
        yield kept
        return
    with _DrawingProcess() as process, cleared_at_the_end(process.stop):
        token = _kept.set(process)
        try:
            yield process
        finally:
            _kept.reset(token)


def draw_in_process(
    housing: DrawnHousing,
    shapes: Sequence[DrawnShape],
    folder: Path,
    file_format: str,
    view: str,
    progress: Progress,
    *,
    sheet: str | None = None,
    beside: str | None = None,
    drawn: Collection[str] = (),
) -> list[str]:
    """Draw shapes into a folder, and with a name for it also the ``sheet`` of all; the files' names.

    With a view ``beside`` each picture shows both sides, see :func:`gearwhine.housing.pictures.images.render_shapes`.
    Shapes whose names are among those ``drawn`` have their picture in the folder already.

    Raises
    ------
    RendererUnavailableError
        Where no library draws without a display, or the drawing process dies.
    EncoderUnavailableError
        Where MP4 is asked for and no encoder is available.
    OSError
        Where a file cannot be written.
    """
    task = {
        "folder": str(folder),
        "format": file_format,
        "view": view,
        "beside": beside,
        "sheet": sheet,
        "drawn": list(drawn),
        "shapes": [{key: getattr(shape, key) for key in _CAPTIONS} for shape in shapes],
    }
    with one_process() as process, tempfile.TemporaryDirectory() as task_folder:
        arrays: dict[str, Any] = {f"motion_{i}": shape.motion for i, shape in enumerate(shapes)}
        arrays |= {f"values_{i}": shape.values for i, shape in enumerate(shapes) if shape.values is not None}
        arrays |= {"rest": housing.rest, "triangles": housing.triangles, "up": housing.up}
        np.savez(Path(task_folder) / "arrays.npz", **arrays)
        (Path(task_folder) / "task.json").write_text(json.dumps(task), encoding="utf-8")
        answer = process.answer(task_folder, progress)
        if "reason" in answer:  # without a name of a file: the caller knows the folder, not the process's own ones
            raise OSError(answer["reason"], answer["message"])
        if "failed" in answer:
            kind = {error.__name__: error for error in _ERRORS}[answer["failed"]]
            raise kind(answer["message"])
    return [str(name) for name in answer["files"]]


class _DrawingProcess:
    """A process that starts when it is first asked, and is replaced where it has died; a context manager."""

    def __init__(self) -> None:
        self._running: _Running | None = None
        self._is_stopped = False
        self._thread = ThreadPoolExecutor(1)

    def __enter__(self) -> Self:
        """Return the process itself, which need not run yet."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the process: its pictures are on file, or no longer wanted."""
        self.stop()
        self._thread.shutdown(cancel_futures=True)
        self._end()

    def start(self) -> "_Running":
        """Start the process where it does not run, which loads its libraries before it is asked."""
        if self._running is None:
            self._running = _start()
        return self._running

    def beside(self, draw: Callable[..., T], *arguments: Any, **named: Any) -> Future[T]:
        """Call a function that draws on a thread, which waits for the process most of the time; one after the other."""
        return self._thread.submit(copy_context().run, partial(draw, *arguments, **named))

    def stop(self) -> None:
        """Kill the process, whatever it draws, and start no other; from any thread."""
        self._is_stopped = True
        if (running := self._running) is not None:
            running.process.kill()

    def answer(self, folder: str, progress: Progress) -> dict[str, Any]:
        """Have the process draw the task in a folder.

        Raises
        ------
        RendererUnavailableError
            Where the process dies of it, or is stopped.
        """
        if self._is_stopped:
            raise RendererUnavailableError("the renderer was stopped")
        running = self.start()
        with suppress(BrokenPipeError):  # of one that has died: it has no answer, and its last words are told
            running.tasks.write(json.dumps(folder) + "\n")
            running.tasks.flush()
        reply = _follow(running.answers, progress)
        if not reply:
            code = running.process.wait()
            running.troubles.seek(0)
            errors = running.troubles.read()
            self._end()
            raise RendererUnavailableError(_how_it_died(code, errors))
        return reply

    def _end(self) -> None:
        running, self._running = self._running, None
        if running is not None:
            # The process is killed: closing its window takes longer than drawing a shape.
            running.process.kill()
            running.process.wait()
            for pipe in (running.tasks, running.answers, running.troubles):
                with suppress(BrokenPipeError):
                    pipe.close()


class EarlyPictures:
    """Pictures that are drawn beside other work, in a folder of their own until the results are written.

    Parameters
    ----------
    process : _DrawingProcess
    folder : path
    """

    def __init__(self, process: _DrawingProcess, folder: Path) -> None:
        self._process, self._folder = process, folder
        self._drawings: list[Future[Any]] = []
        # Figures take the interpreter, which the drawings of the process do not.
        self._figures = ThreadPoolExecutor(1)
        self._is_ended = False

    def load_figures(self) -> None:
        """Import matplotlib and the figures, which takes longer than to draw one, beside work in compiled code."""
        self._figures.submit(import_module, "gearwhine.figures")

    def draw_figures(self, figures: Callable[[], Iterable[tuple[str, "Figure"]]]) -> None:
        """Draw named figures into the folder, each as NAME.png, on a thread of their own."""
        self._drawings.append(self._figures.submit(copy_context().run, self._save, figures))

    def _save(self, figures: Callable[[], Iterable[tuple[str, "Figure"]]]) -> None:
        from gearwhine.figures.style import save

        for name, figure in figures():
            if self._is_ended:
                return
            save(figure, self._folder / f"{name}.png")

    def end(self) -> None:
        """Draw no more figures than the one in hand."""
        self._is_ended = True
        self._figures.shutdown(cancel_futures=True)

    def wait(self) -> None:
        """Wait for all pictures.

        Raises
        ------
        RendererUnavailableError, OSError
            As :func:`draw_in_process`.
        """
        for drawing in self._drawings:
            drawing.result()

    def draw(self, draw: Callable[..., Any], *arguments: Any, **named: Any) -> None:
        """Have a function draw into the folder, which takes that as ``place``, and says nothing of its progress."""
        drawing = self._process.beside(draw, *arguments, place=self._folder, progress=silent, **named)
        self._drawings.append(drawing)

    def move_to(self, place: Path) -> set[str]:
        """Wait for the pictures, and move them into a folder; their names without ending.

        Raises
        ------
        RendererUnavailableError, OSError
            As :func:`draw_in_process`.
        """
        self.wait()
        files = list(self._folder.glob("*"))
        for file in files:
            shutil.move(file, place / file.name)
        return {file.stem for file in files}


@contextmanager
def early_pictures() -> Iterator[EarlyPictures]:
    """Start the drawing process of this block, and draw beside its other work."""
    with tempfile.TemporaryDirectory() as folder, one_process() as process:
        process.start()
        early = EarlyPictures(process, Path(folder))
        try:
            yield early
        finally:
            early.end()


class _Running(NamedTuple):
    """A process that runs, with its pipes: names of folders go in, answers come out, troubles are kept in a file."""

    process: subprocess.Popen[str]
    tasks: IO[str]
    answers: IO[str]
    troubles: IO[str]


def _start() -> _Running:
    troubles = tempfile.TemporaryFile("w+", encoding="utf-8")  # noqa: SIM115 - closed with the process
    process = subprocess.Popen(
        [sys.executable, "-m", "gearwhine.drawing_process"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=troubles,
        text=True,
        env=_environment(),
    )
    assert process.stdin is not None  # pipes, as asked for
    assert process.stdout is not None
    return _Running(process, process.stdin, process.stdout, troubles)


_kept: ContextVar[_DrawingProcess | None] = ContextVar("_kept", default=None)


def _follow(lines: IO[str], progress: Progress) -> dict[str, Any]:
    """Forward progress up to the answer; empty where there is none."""
    for line in lines:
        try:
            report = json.loads(line)
        except ValueError:  # a library's own chatter
            continue
        if isinstance(report, dict):
            if "files" in report or "failed" in report:
                return report
            progress(str(report.get("progress", "drawing")))
    return {}


def _how_it_died(code: int, troubles: str) -> str:
    how = f"ended with exit code {code}"
    if code < 0:
        how = f"was ended by signal {-code} ({signal.strsignal(-code)})"
    lines = [line for line in troubles.splitlines() if line.strip()]
    last = f"; its last words: {lines[-1].strip()[:300]}" if lines else ""
    return (
        f"the renderer {how}{last}\n"
        "Pictures need a working EGL or OSMesa: on Debian or Ubuntu sudo apt-get install libegl1 libegl-mesa0 libgl1; "
        "VTK_DEFAULT_OPENGL_WINDOW must not name a window that needs a screen"
    )


def _environment() -> dict[str, str]:
    """Return the environment of the process, in which the same code is imported wherever the command was started."""
    root = str(Path(gearwhine.__file__).parent.parent)
    return os.environ | {"PYTHONPATH": os.pathsep.join([root, *filter(None, [os.environ.get("PYTHONPATH")])])}


def _tell(document: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(document) + "\n")
    sys.stdout.flush()


def _draw(desk: Path) -> list[str]:
    """Draw the task in a folder."""
    from gearwhine.housing.pictures.images import animate_shapes, render_shapes, render_sheet

    task = json.loads((desk / "task.json").read_text(encoding="utf-8"))
    with np.load(desk / "arrays.npz", allow_pickle=False) as arrays:
        rest, triangles, up = arrays["rest"], arrays["triangles"], arrays["up"]
        shapes = [
            DrawnShape(motion=arrays[f"motion_{i}"], values=arrays.get(f"values_{i}"), **words)
            for i, words in enumerate(task["shapes"])
        ]
    housing = DrawnHousing(rest, triangles, np.arange(len(rest)), up)
    folder, view = Path(task["folder"]), task["view"]

    def progress(message: str) -> None:
        _tell({"progress": message})

    if task["format"] == "png":
        new = [shape for shape in shapes if shape.name not in task["drawn"]]
        files = render_shapes(housing, new, folder, view=view, beside=task["beside"], progress=progress) if new else []
        if task["sheet"] is not None:
            progress("drawing all on one sheet")
            files.append(render_sheet([folder / f"{shape.name}.png" for shape in shapes], folder / task["sheet"]))
    else:
        files = animate_shapes(housing, shapes, folder, task["format"], view=view, progress=progress)
    return [path.name for path in files]


def _warm_up() -> None:
    """Draw a few pixels: what the first picture loads takes longer than a picture."""
    from gearwhine.housing.pictures.scene import Scene

    corners = np.eye(4, 3)
    housing = DrawnHousing(corners, np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]), np.arange(4))
    with Scene(housing, "iso", (16, 16)) as scene:
        scene.picture(DrawnShape("", "", "", corners))


def _main() -> None:
    # An interruption of the command ends this process by the command's own hand.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(RendererUnavailableError):  # the answer to the first task says that
        load_pyvista()
        _warm_up()
    for line in sys.stdin:
        try:
            _tell({"files": _draw(Path(json.loads(line)))})
        except _ERRORS as error:
            _tell({"failed": type(error).__name__, "message": str(error)})
        except OSError as error:
            _tell({"failed": "OSError", "reason": error.errno, "message": error.strerror or str(error)})


if __name__ == "__main__":
    _main()
