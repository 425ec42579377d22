"""Compiled kernels are cached by all that reaches their machine code."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from rotors import kernel_cache

COMPILED = Path(kernel_cache.__file__).parent


def packages(root: Path) -> Path:
    """Copies of the decorators, and a kernel in one file that calls one in another and reads a constant of a third."""
    package = root / "rotors"
    package.mkdir()
    (root / "coupling").mkdir()
    (package / "__init__.py").touch()
    for name in ("compiled.py", "kernel_cache.py"):
        (package / name).write_bytes((COMPILED / name).read_bytes())
    (package / "constants.py").write_text("OFFSET = 1.0\n")
    (package / "called.py").write_text(
        "from .compiled import counted\nfrom .constants import OFFSET\n\n@counted()\ndef f(x):\n    return x + OFFSET\n"
    )
    (package / "caller.py").write_text(
        "from .called import f\nfrom .compiled import counted\n\n@counted()\ndef g(x):\n    return 2.0 * f(x)\n"
    )
    return package


def run(root: Path) -> tuple[float, int]:
    """What the calling kernel gives in a process of its own, and how often it was read from the cache."""
    environment = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
    code = "from rotors.caller import g; print(g(1.0), sum(g.stats.cache_hits.values()))"
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=root,
        env=environment | {"PYTHONPATH": str(root)},
        capture_output=True,
        text=True,
        check=True,
    )
    value, hits = done.stdout.split()
    return float(value), int(hits)


def test_a_changed_called_kernel_or_constant_is_compiled_anew(tmp_path: Path) -> None:
    package = packages(tmp_path)
    assert run(tmp_path) == (4.0, 0)
    assert run(tmp_path) == (4.0, 1)
    called = package / "called.py"
    called.write_text(called.read_text().replace("x + OFFSET", "x - OFFSET"))
    assert run(tmp_path) == (0.0, 0)
    (package / "constants.py").write_text("OFFSET = 3.0\n")
    assert run(tmp_path) == (-4.0, 0)


def test_the_digest_covers_every_kernel_and_what_it_imports() -> None:
    root = COMPILED.parent
    sources = {path.relative_to(root).as_posix() for path in kernel_cache.kernel_sources(root)}
    assert {
        "coupling/gears/kernels.py",
        "coupling/gears/friction_kernels.py",
        "coupling/gears/law_table.py",
        "coupling/contact_kernels.py",
        "coupling/periodic/switches.py",
        "rotors/banded_kernels.py",
        "rotors/compiled.py",
    } <= sources


def test_folders_not_used_for_a_month_go(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old, recent = tmp_path / "kernels-old", tmp_path / "kernels-recent"
    for folder in (old, recent):
        folder.mkdir()
    month_ago = time.time() - 40 * 86400
    os.utime(old, (month_ago, month_ago))
    import numba

    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    kernel_cache.cache_folder.cache_clear()
    try:
        folder = Path(kernel_cache.cache_folder())
    finally:
        kernel_cache.cache_folder.cache_clear()
    assert folder.parent == tmp_path
    assert folder.is_dir()
    assert recent.is_dir()
    assert not old.exists()
