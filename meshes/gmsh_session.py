"""gmsh session: gmsh is imported when it is needed, silent, deterministic, and finalised after errors too."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from meshes.errors import GeometryError, MesherUnavailableError

# Libraries that gmsh's wheel links against but does not contain, as Debian and Ubuntu package names.
SYSTEM_PACKAGES = (
    "libglu1-mesa",
    "libgl1",
    "libx11-6",
    "libxext6",
    "libxrender1",
    "libxcursor1",
    "libxfixes3",
    "libxft2",
    "libxinerama1",
    "libfontconfig1",
    "libgomp1",
)


def load_gmsh() -> Any:
    """Import gmsh.

    Raises
    ------
    MesherUnavailableError
        Where a system library that gmsh needs is missing; the message names the packages to install.
    """
    try:
        import gmsh
    except (ImportError, OSError) as error:
        packages = " ".join(SYSTEM_PACKAGES)
        raise MesherUnavailableError(
            f"gmsh cannot be loaded: {error}. On Debian or Ubuntu install its system libraries with\n"
            f"    sudo apt-get install {packages}"
        ) from error
    return gmsh


@contextmanager
def gmsh_session(name: str) -> Iterator[Any]:
    """A gmsh model that is finalised at the end; gmsh's own failures become :class:`GeometryError`.

    The session runs on one thread so that the same geometry gives the same mesh, bit for bit.
    """
    gmsh = load_gmsh()
    # interruptible=False leaves the signal handlers alone, so it works off the main thread and Ctrl-C stays ours.
    with _signals_kept():
        gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.option.setNumber("Mesh.RandomSeed", 1)
        gmsh.model.add(name)
        yield gmsh
    except GeometryError:
        raise
    except Exception as error:  # gmsh raises bare Exception for every failure of its kernel
        if type(error) is not Exception:
            raise
        raise GeometryError(f"gmsh could not mesh {name}: {error}") from error
    finally:
        with _signals_kept():
            gmsh.finalize()


@contextmanager
def _signals_kept() -> Iterator[None]:
    """Restore the process's signal handlers: gmsh resets SIGTERM's, and a killed run could not clean up."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in handlers.items():
            if handler is not None:
                signal.signal(number, handler)
