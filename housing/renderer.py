"""Off-screen renderer: search for EGL or OSMesa, and PyVista set up for it."""

import ctypes
import os
from typing import Any

from housing.errors import RendererUnavailableError

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
