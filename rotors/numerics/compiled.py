"""Compilation of kernels by numba: the decorators :func:`counted`, :func:`uncounted` and :func:`inner`.

Importing this module imports numba.

Numba counts references to every array that enters or leaves a function, atomically; with tuples of a dozen arrays that
costs several times the arithmetic of a step, and most of the compile time. Kernels that make no arrays need no counts:
the first caller holds all arrays meanwhile. numba refuses to compile one that does make an array, even for the message
of an error that ``a[:] = b`` could raise: write a loop.

A called kernel is compiled on its own, and again within every kernel that inlines it. So few kernels call many, and
kernels that only kernels call have no entry points from Python or C.

Compiled kernels are cached by :mod:`rotors.numerics.kernel_cache`.
"""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numba import njit

from rotors.numerics.kernel_cache import cache_folder

Kernel = TypeVar("Kernel", bound=Callable[..., Any])

# A product and the sum it goes into may be rounded once.
FUSED = {"contract"}
# The same without infinities and NaN, so that products with the zero imaginary part of a real factor vanish.
FINITE = {"contract", "nnan", "ninf", "nsz"}

_ALL: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}


def counted(**options: Any) -> Callable[[Kernel], Kernel]:
    """Compile a function that makes arrays; further options are numba's."""

    def compiled(function: Kernel) -> Kernel:
        # numba reads the cache folder when it decorates; functions of other packages keep theirs.
        config: Any = numba.config
        given, config.CACHE_DIR = config.CACHE_DIR, cache_folder()
        try:
            return cast(Kernel, njit(**(_ALL | options))(function))
        finally:
            config.CACHE_DIR = given

    return compiled


def uncounted(**options: Any) -> Callable[[Kernel], Kernel]:
    """Compile a function without counting references; Python may call it."""
    return counted(_nrt=False, **options)


def inner(**options: Any) -> Callable[[Kernel], Kernel]:
    """Compile as `uncounted` does, for a function that kernels alone call."""
    return uncounted(no_cpython_wrapper=True, **options)
