"""Own block Lanczos against scipy's eigsh on the same factor with the same certificate, in turn, in one process.

    OMP_NUM_THREADS=1 python benchmarks/eigensolvers.py

Each run goes from the matrices in memory to certified modes: factor, eigensolver and certificate.
"""

import statistics
import time

from benchmark_box import STEEL, benchmark_box
from timing import arguments, machine

from gearwhine.housing.fem.assembly import assemble
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.modes.eigensolver import Solver
from gearwhine.housing.modes.natural_modes import solve_modes

SOLVERS: tuple[Solver, ...] = ("eigsh", "lanczos")


def seconds(matrices: Matrices, limit: float, solver: Solver, threads: int) -> tuple[float, float]:
    """Wall-clock and processor time of one certified set of modes [s]."""
    wall, processor = time.perf_counter(), time.process_time()
    modes = solve_modes(matrices, frequency_limit=limit, solver=solver, threads=threads)
    spent = time.perf_counter() - wall, time.process_time() - processor
    assert modes.certificate.complete
    return spent


def main() -> None:
    options = arguments(
        __doc__.splitlines()[0],
        mesh_sizes=(str, "34,19,12", "sizes of the elements [mm]"),
        modes=(int, 30, "number of modes below the limit"),
        repeats=(int, 5, "runs of each solver, of which the median is shown"),
        threads=(int, 2, "of the factorisation"),
    )
    print(f"{machine()}; {options.modes} modes below a limit, {options.threads} threads, median of {options.repeats}\n")
    print("| degrees of freedom | eigsh, s | Lanczos, s | ratio | ratio of processor times |")
    print("|---|---|---|---|---|")
    for mesh_size in map(float, options.mesh_sizes.split(",")):
        problem = benchmark_box(1e-3 * mesh_size)
        matrices = assemble(problem.mesh, STEEL).held(problem.fixed)
        limit = solve_modes(matrices, count=options.modes, threads=options.threads).certificate.limit
        taken: dict[Solver, list[tuple[float, float]]] = {solver: [] for solver in SOLVERS}
        for _ in range(options.repeats):
            for solver, runs in taken.items():
                runs.append(seconds(matrices, limit, solver, options.threads))
        wall, processor = ({name: statistics.median(column) for name, column in _columns(taken, k)} for k in (0, 1))
        print(
            f"| {problem.freedoms} | {wall['eigsh']:.2f} | {wall['lanczos']:.2f} "
            f"| {wall['eigsh'] / wall['lanczos']:.2f} | {processor['eigsh'] / processor['lanczos']:.2f} |",
            flush=True,
        )


def _columns(taken: dict[Solver, list[tuple[float, float]]], which: int) -> list[tuple[Solver, list[float]]]:
    return [(solver, [run[which] for run in runs]) for solver, runs in taken.items()]


if __name__ == "__main__":
    main()
