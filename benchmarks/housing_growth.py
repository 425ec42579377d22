"""How time and memory grow with the number of degrees of freedom: the exponent over several mesh sizes.

    python benchmarks/housing_growth.py 24 17 12 8.5

Each mesh is solved in a process of its own, so that its peak memory is its own; that of meshing is not counted.
"""

import json
import resource
import subprocess
import sys

import numpy as np
from benchmark_box import STEEL, benchmark_box
from timing import machine, timed

from gearwhine.housing import assemble, solve_modes

_MODES = 30
_LIMIT = 2.0 * np.pi * 3984.0


def solve(mesh_size: float) -> dict[str, float]:
    """One mesh, all modes below about the thirtieth."""
    problem = benchmark_box(1e-3 * mesh_size)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    modes, seconds = timed(
        lambda: solve_modes(assemble(problem.mesh, STEEL).held(problem.fixed), frequency_limit=_LIMIT)
    )
    return {
        "freedoms": problem.freedoms,
        "modes": modes.certificate.found,
        "seconds": seconds,
        "factorisation": modes.seconds["factorisation"],
        "eigensolver": modes.seconds["eigensolver"],
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        "meshing_mb": before / 1024.0,
        "residual": modes.certificate.max_residual,
    }


def main() -> None:
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(solve(float(sys.argv[2]))))
        return
    sizes = [float(size) for size in sys.argv[1:]] or [24.0, 17.0, 12.0, 8.5]
    print(f"{machine()}; all modes below {_LIMIT / 2 / np.pi:.0f} Hz\n")
    print(f"{'mesh':>8}{'dofs':>10}{'modes':>7}{'factor':>9}{'Lanczos':>9}{'in all':>9}{'peak':>9}{'residual':>10}")
    rows = []
    for size in sizes:
        ended = subprocess.run(
            [sys.executable, __file__, "--one", str(size)], check=True, capture_output=True, text=True
        )
        row = json.loads(ended.stdout.splitlines()[-1])
        rows.append(row)
        print(
            f"{size:5.3g} mm{row['freedoms']:10.0f}{row['modes']:7.0f}{row['factorisation']:8.2f}s"
            f"{row['eigensolver']:8.2f}s{row['seconds']:8.2f}s{row['peak_mb']:6.0f} MB{row['residual']:10.0e}",
            flush=True,
        )
    if len(rows) > 1:
        freedoms = np.log([row["freedoms"] for row in rows])
        for key, name in (("seconds", "time"), ("peak_mb", "peak memory")):
            print(f"{name} grows with the power {np.polyfit(freedoms, np.log([row[key] for row in rows]), 1)[0]:.2f}")


if __name__ == "__main__":
    main()
