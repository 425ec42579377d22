"""How the kernels that march elements are compiled: without counting references to arrays.

Importing this module imports numba.

Numba counts every array that changes hands, in and out of each function, atomically; with tuples of a dozen arrays that
costs several times the arithmetic of an element. Kernels that make no arrays need no counts: whoever calls the first of
them holds all arrays meanwhile. numba refuses to compile one that does make an array.
"""

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

Kernel = TypeVar("Kernel", bound=Callable[..., Any])


def uncounted(**options: Any) -> Callable[[Kernel], Kernel]:
    """Compile a function so; further options are numba's."""
    every: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "_nrt": False, **options}

    def compiled(function: Kernel) -> Kernel:
        return cast(Kernel, njit(**every)(function))

    return compiled
