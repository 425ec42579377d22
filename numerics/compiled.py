"""Compilation of kernels by numba: decorators :func:`counted`, :func:`uncounted` and :func:`inner`, and the cache.

Importing this module imports numba. A kernel that is compiled, which takes seconds, is logged at the level INFO.

Numba counts references to every array that enters or leaves a function, atomically; with tuples of a dozen arrays that
costs several times the arithmetic of a step, and most of the compile time. Kernels that make no arrays need no counts:
the first caller holds all arrays meanwhile. numba refuses to compile one that does make an array, even for the message
of an error that ``a[:] = b`` could raise: write a loop.

numba optimises a called kernel on its own and makes machine code of it, and does both again within every kernel that
calls it, however indirectly. A kernel that only kernels call has no entry points from Python or C, and is optimised in
its callers alone. ``forceinline`` inlines it there; numba's ``inline="always"`` would infer its types at every call.

Kernel cache: numba stamps a cached kernel with its own source file only. Its machine code also holds the kernels that
it calls and the constants that it reads from other files, and would stay outdated when one of those changes. Here the
kernels of a file have a folder whose name is a digest of the file, of the files with kernels that it reaches by
imports, of what these import from, and of the versions of numba, llvmlite and NumPy, so that changed sources find an
empty folder. numba itself separates Python versions and processors. The folders stand below ``NUMBA_CACHE_DIR`` where
that is set, else beside the sources, else, where these are read-only, in the user's cache. Those that no process has
used for a month are removed.

numba numbers the files of one kernel's machine code, a file for each signature. Two processes that compile different
signatures at once choose the same number, and the index of the one may come to name the code of the other: arrays are
then read by the wrong layout or type, which neither numba nor the processor notices. Here each file that is written has
a name of its own; the index that is written last stands, and what it does not name is compiled again.
"""

import hashlib
import logging
import os
import re
import shutil
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import llvmlite
import numba
import numpy as np
from llvmlite.binding import parse_assembly
from numba import njit
from numba.core import event
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler

Kernel = TypeVar("Kernel", bound=Callable[..., Any])
# A product and the sum it goes into may be rounded once.
FUSED = {"contract"}
# Also without infinities and NaN, so that products with the zero imaginary part of a real factor vanish.
FINITE = {"contract", "nnan", "ninf", "nsz"}
_ALL: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}

_UNUSED = 30 * 86400.0
"""Age of a folder that is removed [s]."""
_KERNELS = re.compile(rb"^from [\w.]*\.compiled import", re.MULTILINE)
_IMPORT = re.compile(rb"^from (?:gearwhine\.)?((?:numerics|rotors|coupling)?\.?[\w.]*) import", re.MULTILINE)


class _Log(event.Listener):
    """Logs each kernel of this program that is compiled, not one that is read from the cache."""

    def on_start(self, event: Any) -> None:
        function = event.data["dispatcher"].py_func
        if function.__module__.partition(".")[0] == "gearwhine":
            logging.getLogger(__name__).info("compiling %s", function.__qualname__)

    def on_end(self, event: Any) -> None:
        pass


event.register("numba:compile", _Log())


class _LinkedCode(JITCodeLibrary):
    """Code that callers link and optimise with their own: machine code is made of its environment alone."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalized = True
        linked = self._get_module_for_linking()
        environment = [str(value) for value in linked.global_variables if value.name.startswith("_ZN08NumbaEnv")]
        self._final_module = parse_assembly(
            "\n".join([str(self._codegen._create_empty_module(self.name)), *environment])
        )
        super()._finalize_final_module()


class _LinkedCompiler(Compiler):
    """Compiler of a kernel that only kernels call."""

    def compile_extra(self, function: Any) -> Any:
        self.state.library = _LinkedCode(self.state.targetctx.codegen(), function.__qualname__)
        self.state.library.enable_object_caching()
        return super().compile_extra(function)


def counted(**options: Any) -> Callable[[Kernel], Kernel]:
    """Compile a function that makes arrays; further options are numba's."""
    if options.get("no_cpython_wrapper"):
        options["pipeline_class"] = _LinkedCompiler

    def compiled(function: Kernel) -> Kernel:
        # numba reads the cache folder when it decorates; functions of other packages keep theirs.
        config: Any = numba.config
        previous, config.CACHE_DIR = config.CACHE_DIR, cache_folder(Path(function.__code__.co_filename))
        try:
            kernel: Any = njit(**(_ALL | options))(function)
        finally:
            config.CACHE_DIR = previous
        _name_code_files_apart(kernel)
        return cast(Kernel, kernel)

    return compiled


def _name_code_files_apart(kernel: Any) -> None:
    """Let no two processes write a kernel's machine code under one name; without a cache there is nothing to do."""
    files = getattr(getattr(kernel, "_cache", None), "_cache_file", None)
    if files is not None:
        stem = files._index_name.removesuffix(".nbi")
        files._data_name = lambda number: f"{stem}.{number}.{uuid.uuid4().hex}.nbc"


def uncounted(**options: Any) -> Callable[[Kernel], Kernel]:
    """Compile a function without counting references; Python may call it."""
    return counted(_nrt=False, **options)


def inner(**options: Any) -> Callable[[Kernel], Kernel]:
    """Compile as `uncounted` does, for a function that kernels alone call."""
    return uncounted(no_cpython_wrapper=True, **options)


def has_kernels(path: Path) -> bool:
    """Whether a file has kernels."""
    return _KERNELS.search(path.read_bytes()) is not None


def kernel_sources(root: Path, path: Path) -> list[Path]:
    """List the sources of the machine code of a file's kernels.

    Parameters
    ----------
    root : Path
        The folder that holds the packages ``numerics``, ``rotors`` and ``coupling``.
    path : Path
        The file.

    Returns
    -------
    list of Path
        Paths, ascending: the file, the files with kernels that it reaches by imports, and what these import from.
    """
    sources, reached = {path}, [path]
    while reached:
        new = set(_imported(root, reached.pop())) - sources
        sources |= new
        reached.extend(filter(has_kernels, new))
    return sorted(sources)


@cache
def _imported(root: Path, path: Path) -> tuple[Path, ...]:
    """Files of the packages that a file imports names from."""
    found: list[Path] = []
    for match in _IMPORT.findall(path.read_bytes()):
        name = match.decode()
        dots = len(name) - len(name.lstrip("."))
        folder = path.parents[dots - 1] if dots else root
        module = folder.joinpath(*filter(None, name.split(".")))
        found += [source for source in (module.with_suffix(".py"), module / "__init__.py") if source.is_file()]
    return tuple(found)


def sources_digest(root: Path, path: Path) -> str:
    """Digest of the bytes of the sources of a file's kernels, and of the compiler's versions."""
    digest = hashlib.sha256(f"{numba.__version__} {llvmlite.__version__} {np.__version__}".encode())
    for source in kernel_sources(root, path):
        text = source.read_bytes()
        digest.update(f"\n{source.relative_to(root).as_posix()} {len(text)}\n".encode())
        digest.update(text)
    return digest.hexdigest()[:16]


@cache
def cache_folder(path: Path) -> str:
    """Folder of the kernels of a file, made where it can be; empty where there is none to write to."""
    path, root = path.resolve(), Path(__file__).resolve().parents[1]
    name = f"kernels-{sources_digest(root, path)}"
    configured = str(numba.config.CACHE_DIR)  # type: ignore[attr-defined]  # numba takes it from the environment
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()) / "gearwhine"
    for base in [Path(configured)] if configured else [root / "numerics" / "__pycache__", user]:
        folder = base / name
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            if os.access(folder, os.W_OK):
                os.utime(folder)
                _remove_unused(base)
                return str(folder)
    return configured


@cache
def _remove_unused(base: Path) -> None:
    """Remove folders of kernels that no process has used for a month."""
    for folder in base.glob("kernels-*"):
        with suppress(OSError):
            if time.time() - folder.stat().st_mtime > _UNUSED:
                shutil.rmtree(folder, ignore_errors=True)
