"""How time and memory grow with the number of degrees of freedom: the exponent over several mesh sizes.

    python benchmarks/housing_growth.py 24 17 12 8.5
    python benchmarks/housing_growth.py 12 8.5 5.3 --precision single --limit 3000
    python benchmarks/housing_growth.py 5.3 --precision single --limit 3000 --parts    # a million degrees of freedom

Each mesh is made in a process of its own, and solved in another, so that the peak of its memory is that of the solution
alone, from the assembly to the certificate: the largest resident set, as the operating system has it. With --parts
each row is followed by the wall-clock and processor time of its parts; those of solutions are within others.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from benchmark_box import STEEL, Problem, benchmark_box
from timing import machine, timed

from gearwhine.housing import assemble, solve_modes
from gearwhine.housing.fem import factorization
from gearwhine.housing.modes import certificate
from gearwhine.meshes import ElementBlock, Mesh

Parts = dict[str, list[float]]


def measured(work: Callable[..., Any], name: str, parts: Parts) -> Callable[..., Any]:
    """Work that adds its calls, wall-clock and processor time to a part."""

    def run(*given: Any, **named: Any) -> Any:
        start = time.perf_counter(), time.process_time()
        try:
            return work(*given, **named)
        finally:
            spent = 1.0, time.perf_counter() - start[0], time.process_time() - start[1]
            parts[name] = [a + b for a, b in zip(parts.get(name, [0.0, 0.0, 0.0]), spent, strict=True)]

    return run


def solve(problem: Problem, limit: float, precision: str | None, threads: int) -> dict[str, object]:
    """All modes below a limit [Hz], with time and memory."""
    said: list[str] = []
    parts: Parts = {}
    for owner, function, name in (
        (factorization.RslabSolver, "order", "ordering, beside the pattern"),
        (factorization.RslabSolver, "factor", "factor, with the entries"),
        (factorization, "_prove_inertia", "proof of the inertia"),
        (factorization, "_check", "check of the factor"),
        (factorization._RslabFactor, "solve", "solutions, in other parts"),
        (certificate, "davidson_modes", "modes by Davidson"),
        (certificate, "nearest_modes", "modes by Lanczos"),
        (certificate, "_refined", "certificate"),
    ):
        setattr(owner, function, measured(getattr(owner, function), name, parts))
    processor = time.process_time()
    modes, seconds = timed(
        lambda: solve_modes(
            measured(assemble, "assembly", parts)(problem.mesh, STEEL, threads=threads).held(problem.fixed),
            frequency_limit=2.0 * np.pi * limit,
            precision=precision,
            threads=threads,
            progress=said.append,
        )
    )
    return {
        "freedoms": problem.freedoms,
        "modes": modes.certificate.found,
        "complete": modes.certificate.complete,
        "backend": modes.backend,
        "seconds": seconds,
        "processor": time.process_time() - processor,
        "factorisation": modes.seconds["factorisation"],
        "eigensolver": modes.seconds["eigensolver"],
        "peak_gb": 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e9,
        "residual": modes.certificate.max_residual,
        "parts": parts,
        "said": [one for one in said if "precision" in one],
    }


def write_problem(file: Path, problem: Problem) -> None:
    """Write a problem as plain arrays."""
    (block,) = problem.mesh.blocks
    np.savez(file, points=problem.mesh.points, kind=block.kind, nodes=block.nodes, fixed=problem.fixed)


def read_problem(file: Path) -> Problem:
    """Read a problem that :func:`write_problem` wrote."""
    with np.load(file, allow_pickle=False) as arrays:
        block = ElementBlock(str(arrays["kind"]), arrays["nodes"])
        return Problem(Mesh(arrays["points"], (block,)), arrays["fixed"])


def separately(*words: str) -> str:
    """Output of this program in a process of its own."""
    return subprocess.run([sys.executable, __file__, *words], check=True, capture_output=True, text=True).stdout


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh_size", nargs="*", type=float, default=[24.0, 17.0, 12.0, 8.5], help="sizes [mm]")
    parser.add_argument("--limit", type=float, default=3984.0, help="of the frequencies [Hz]")
    parser.add_argument("--precision", choices=["double", "single"], help="of the factor; by default as memory allows")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--parts", action="store_true", help="show the time of each part too")
    parser.add_argument("--mesh", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--solve", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.mesh is not None:
        write_problem(options.mesh, benchmark_box(1e-3 * options.mesh_size[0]))
        return
    if options.solve is not None:
        print(json.dumps(solve(read_problem(options.solve), options.limit, options.precision, options.threads)))
        return
    print(f"{machine()}; all modes below {options.limit:.0f} Hz, {options.threads} threads\n")
    columns = [
        "mesh size",
        "degrees of freedom",
        "modes",
        "factor",
        "eigensolver",
        "in all",
        "processor",
        "peak memory",
    ]
    print(f"| {' | '.join([*columns, 'residual', 'solver'])} |")
    print("|---" * (len(columns) + 2) + "|")
    rows = []
    for size in options.mesh_size:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "mesh.npz"
            _, seconds_of_mesh = timed(lambda: separately(str(size), "--mesh", str(file)))  # noqa: B023
            words = ["--solve", str(file), "--limit", str(options.limit), "--threads", str(options.threads)]
            precision = [] if options.precision is None else ["--precision", options.precision]
            row = json.loads(separately(*words, *precision).splitlines()[-1])
        rows.append(row)
        assert row["complete"]
        print(
            f"| {size:g} mm | {row['freedoms']} | {row['modes']} | {row['factorisation']:.1f} s "
            f"| {row['eigensolver']:.1f} s | {row['seconds']:.1f} s | {row['processor']:.1f} s "
            f"| {row['peak_gb']:.2f} GB | {row['residual']:.0e} | {row['backend']} |",
            flush=True,
        )
        for one in row["said"]:
            print(f"    {one}")
        if options.parts:
            print(f"    {'mesh, beside the rest':32}      {seconds_of_mesh:7.1f} s")
            for name, (calls, wall, processor) in row["parts"].items():
                print(f"    {name:32} {calls:4.0f} {wall:7.1f} s, processor {processor:7.1f} s")
    if len(rows) > 1:
        freedoms = np.log([row["freedoms"] for row in rows])
        for key, name in (("processor", "processor time"), ("peak_gb", "peak memory")):
            print(f"{name} grows with the power {np.polyfit(freedoms, np.log([row[key] for row in rows]), 1)[0]:.2f}")


if __name__ == "__main__":
    main()
