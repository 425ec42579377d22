"""Memory that is available, from what the system tells, and work that would not fit in it."""

import subprocess
import sys
from pathlib import Path

import pytest

from gearwhine.failures import explain
from gearwhine.housing.fem import memory
from gearwhine.housing.fem.memory import available_memory, check_memory

GB = 1e9


def told(system: Path, files: dict[str, str]) -> float:
    for name, text in files.items():
        (system / name).parent.mkdir(parents=True, exist_ok=True)
        (system / name).write_text(text)
    return available_memory(system=system)


def test_the_least_of_machine_and_groups_counts(tmp_path: Path) -> None:
    """The limit may be that of a group around the process's own; files in its cache can be dropped."""
    assert told(tmp_path, {}) == float("inf")
    assert told(tmp_path, {"proc/meminfo": "MemTotal: 16000000 kB\nMemAvailable: 8000000 kB\n"}) == 8000000 * 1024
    swap = "MemAvailable: 8000000 kB\nSwapFree: 1000 kB\n"
    assert told(tmp_path, {"proc/meminfo": swap}) == 8001000 * 1024
    job = "sys/fs/cgroup/jobs"
    files = {"proc/self/cgroup": "0::/jobs/mine\n", f"{job}/mine/memory.max": "max\n", f"{job}/memory.max": "6000\n"}
    files |= {f"{job}/mine/memory.current": "100\n", f"{job}/memory.current": "5000\n"}
    assert told(tmp_path, files) == 1000.0
    assert told(tmp_path, {f"{job}/memory.stat": "anon 1\ninactive_file 500\n"}) == 1500.0
    assert told(tmp_path, {f"{job}/memory.current": "9000\n"}) == 0.0


def test_the_first_version_of_control_groups_is_read_as_well(tmp_path: Path) -> None:
    group = "sys/fs/cgroup/memory/mine"
    files = {"proc/self/cgroup": "12:cpu,cpuacct:/other\n4:memory:/mine\n"}
    files |= {f"{group}/memory.limit_in_bytes": "7000", f"{group}/memory.usage_in_bytes": "3000"}
    assert told(tmp_path, files) == 4000.0


def test_what_does_not_fit_is_refused_with_both_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "available_memory", lambda: 2.0 * GB)
    check_memory(2.0 * GB, "the factor")
    with pytest.raises(
        MemoryError, match=r"the factor needs 3 GB of memory, and 2 GB are available; .*mesh_size"
    ) as no:
        check_memory(3.0 * GB, "the factor")
    assert explain(no.value) == (1, f"out of memory: {no.value}")


def test_an_array_that_does_not_fit_is_a_sentence() -> None:
    code, message = explain(MemoryError("Unable to allocate 7 TiB"))
    assert (code, message is not None and "Unable to allocate 7 TiB; a larger mesh_size" in message) == (1, True)


_FACTOR = """
import resource
import numpy as np
from scipy import sparse
from gearwhine.housing.fem.factorization import Factorizer
from gearwhine.housing.fem.linear_algebra import SymmetricMatrix

n = 16
line = sparse.diags_array([-np.ones(n - 1), 2.0 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1])
one = sparse.eye_array(n)
field = sum(sparse.kron(sparse.kron(a, b), c) for a, b, c in ((line, one, one), (one, line, one), (one, one, line)))
matrix = SymmetricMatrix.of(sparse.csr_array(sparse.kron(field, np.ones((3, 3)) + 3.0 * np.eye(3))))
factorizer = Factorizer(backend="rslab")
factorizer.factor(matrix)
taken = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (taken + SPARE, resource.RLIM_INFINITY))
try:
    factorizer.factor(matrix)
except MemoryError as error:
    print(error)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="reads the process's size where Linux has it")
def test_a_factor_beyond_the_limit_is_refused_where_the_library_would_abort() -> None:
    """The process lives, and says the sentence; with room enough it factors."""
    pytest.importorskip("rslab")
    for spare, said in (
        (4_000_000, "the factor of a matrix of order 12288 in single precision needs 0.0"),
        (2_000_000_000, ""),
    ):
        command = [sys.executable, "-c", _FACTOR.replace("SPARE", str(spare))]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert done.stdout.startswith(said)
        assert bool(done.stdout) == bool(said)
