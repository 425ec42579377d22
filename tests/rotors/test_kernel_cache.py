"""Compiled kernels are cached by all that reaches their machine code."""

import copy
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from gearwhine.coupling.collocation.switch_kernels import by_pairs
from gearwhine.coupling.connector_forces.contact_kernels import evaluate_contact
from gearwhine.coupling.gears.contact.lookup_tables import law_table
from gearwhine.coupling.gears.contact.tooth_force_kernels import friction_history, penetration
from gearwhine.numerics import compiled
from gearwhine.numerics.banded_kernels import factor
from gearwhine.numerics.compiled import counted

COMPILED = Path(compiled.__file__).parent
HOME = compiled.__name__.rpartition(".")[0]
ROOMS = COMPILED.resolve().parent
BANDED = ROOMS / "numerics" / "banded_kernels.py"


def packages(root: Path) -> Path:
    """Copies of the decorators, and a kernel in one file that calls one in another and reads a constant of a third."""
    package = root / "gearwhine" / "rotors"
    package.mkdir(parents=True)
    (root / "gearwhine" / "coupling").mkdir()
    (package.parent / "__init__.py").touch()
    (package / "__init__.py").touch()
    home = package.parent / COMPILED.name
    home.mkdir(parents=True, exist_ok=True)
    (home / "__init__.py").touch()
    (home / "compiled.py").write_bytes((COMPILED / "compiled.py").read_bytes())
    decorator = f"from {HOME}.compiled import counted\n"
    (package / "constants.py").write_text("OFFSET = 1.0\n")
    (package / "called.py").write_text(
        f"from .constants import OFFSET\n{decorator}\n@counted()\ndef f(x):\n    return x + OFFSET\n"
    )
    (package / "caller.py").write_text(
        f"from .called import f\n{decorator}\n@counted()\ndef g(x):\n    return 2.0 * f(x)\n"
    )
    return package


def run(root: Path) -> tuple[float, int, list[str]]:
    """What the calling kernel gives in a process of its own, how often it was read from the cache, and what it logs."""
    environment = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
    code = "import logging; logging.basicConfig(level='INFO', format='%(message)s')\n"
    code += "from gearwhine.rotors.caller import g; print(g(1.0), sum(g.stats.cache_hits.values()))"
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=root,
        env=environment | {"PYTHONPATH": str(root)},
        capture_output=True,
        text=True,
        check=True,
    )
    value, hits = done.stdout.split()
    return float(value), int(hits), done.stderr.splitlines()


@pytest.mark.slow
def test_a_changed_called_kernel_or_constant_is_compiled_anew(tmp_path: Path) -> None:
    package, compiling = packages(tmp_path), ["compiling g", "compiling f"]
    assert run(tmp_path) == (4.0, 0, compiling)
    assert run(tmp_path) == (4.0, 1, [])
    caller, called = package / "caller.py", package / "called.py"
    called.write_text(called.read_text().replace("x + OFFSET", "x - OFFSET"))
    assert run(tmp_path) == (0.0, 0, compiling)
    caller.write_text(caller.read_text().replace("2.0", "5.0"))
    assert run(tmp_path) == (0.0, 0, compiling[:1])
    (package / "constants.py").write_text("OFFSET = 3.0\n")
    assert run(tmp_path) == (-10.0, 0, compiling)


def test_the_digest_covers_every_kernel_that_a_file_reaches_and_what_it_imports() -> None:
    kernels = [factor, evaluate_contact, friction_history, penetration, by_pairs]
    files = {Path(kernel.py_func.__code__.co_filename).resolve() for kernel in kernels}  # type: ignore[attr-defined]
    files |= {Path(function.__code__.co_filename).resolve() for function in (counted, law_table)}
    assert len(files) >= 6
    integration = ROOMS / "coupling" / "collocation" / "integration_kernels.py"
    assert files - set(compiled.kernel_sources(ROOMS, integration)) == {BANDED}
    assert compiled.kernel_sources(ROOMS, BANDED) == sorted([BANDED, COMPILED.resolve() / "compiled.py"])


def test_folders_not_used_for_a_month_go(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old, recent = tmp_path / "kernels-old", tmp_path / "kernels-recent"
    for folder in (old, recent):
        folder.mkdir()
    month_ago = time.time() - 40 * 86400
    os.utime(old, (month_ago, month_ago))
    import numba

    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    compiled.cache_folder.cache_clear()
    try:
        folder = Path(compiled.cache_folder(BANDED))
    finally:
        compiled.cache_folder.cache_clear()
    assert folder.parent == tmp_path
    assert folder.is_dir()
    assert recent.is_dir()
    assert not old.exists()


def test_processes_that_compile_at_once_do_not_mix_their_machine_code(tmp_path: Path) -> None:
    """One process writes the index of its signature, another then writes its own signature, and the first its code."""

    def process() -> Any:
        # As a process on its own sees the cache of a kernel.
        files: Any = copy.copy(factor._cache._cache_file)  # type: ignore[attr-defined]
        files._cache_path = str(tmp_path)
        files._index_path = str(tmp_path / files._index_name)
        return files

    first, second = process(), process()
    second._load_index = dict  # read before the first one wrote
    write = first._save_data

    def late(name: str, code: str) -> None:
        second.save("real arrays", "code for real arrays")
        write(name, code)

    first._save_data = late
    first.save("complex arrays", "code for complex arrays")
    assert process().load("real arrays") == "code for real arrays"
    assert process().load("complex arrays") in (None, "code for complex arrays")
