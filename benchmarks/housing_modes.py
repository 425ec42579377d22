"""Thirty certified modes of a housing against the stock way and against one bare factorisation, in one run.

    python benchmarks/housing_modes.py --stock

The stock way is what scikit-fem's documentation shows: its own forms on a basis of P2 vector elements, and scipy's
``eigsh`` about zero, which factors with SuperLU. It takes minutes; without ``--stock`` it is left out.
"""

import resource
import statistics

import numpy as np
from benchmark_box import STEEL, Problem, benchmark_box
from scipy.sparse.linalg import eigsh
from timing import arguments, machine, timed

from gearwhine.housing import ModeSet, assemble, solve_modes
from gearwhine.housing.fem.factorization import Factorizer
from gearwhine.housing.fem.matrices import FreeSystem


def ours(problem: Problem, *, limit: float | None, count: int | None) -> ModeSet:
    """From the mesh in memory to certified modes."""
    return solve_modes(assemble(problem.mesh, STEEL).held(problem.fixed), frequency_limit=limit, count=count)


def stock(problem: Problem, count: int) -> np.ndarray:
    """From the mesh in memory to frequencies [Hz], without a proof that they are all."""
    from skfem import Basis, BilinearForm, ElementTetP2, ElementVector, MeshTet2, condense
    from skfem.helpers import ddot, dot, eye, sym_grad, trace

    lame = STEEL.youngs_modulus * STEEL.poisson_ratio / ((1 + STEEL.poisson_ratio) * (1 - 2 * STEEL.poisson_ratio))
    shear = STEEL.youngs_modulus / (2 * (1 + STEEL.poisson_ratio))

    @BilinearForm
    def stiffness(u, v, w):
        strain = sym_grad(u)
        return ddot(lame * eye(trace(strain), 3) + 2 * shear * strain, sym_grad(v))

    @BilinearForm
    def mass(u, v, w):
        return STEEL.density * dot(u, v)

    nodes = problem.mesh.blocks[0].nodes
    corners = MeshTet2(problem.mesh.points.T, np.ascontiguousarray(nodes.T))
    basis = Basis(corners, ElementVector(ElementTetP2()), intorder=4)
    k, m = stiffness.assemble(basis), mass.assemble(basis)
    places = basis.doflocs.T[::1]
    held = problem.mesh.points[np.unique(problem.fixed // 3)]
    known = {tuple(row) for row in np.round(held, 9).tolist()}
    fixed = np.array([number for number, row in enumerate(np.round(places, 9).tolist()) if tuple(row) in known])
    start = np.random.default_rng(0).standard_normal(k.shape[0] - len(fixed))
    inner_k, inner_m, *_ = condense(k, m, D=fixed)
    values = eigsh(inner_k, k=count, M=inner_m, sigma=0.0, v0=start, return_eigenvectors=False)
    return np.sqrt(np.sort(values)) / (2 * np.pi)


def main() -> None:
    options = arguments(
        __doc__.splitlines()[0],
        mesh_size=(float, 12.0, "size of the elements [mm]"),
        modes=(int, 30, "how many"),
        repeats=(int, 3, "runs of each, of which the median is shown"),
        stock=(bool, False, "compare with the stock way too"),
    )
    problem = benchmark_box(1e-3 * options.mesh_size)
    print(f"{machine()}\n{problem.freedoms} degrees of freedom, {len(problem.fixed)} fixed; {options.modes} modes\n")
    by_count, first = timed(lambda: ours(problem, limit=None, count=options.modes))
    # The same modes by a limit halfway to the next: certified, as every set is.
    limit = by_count.certificate.limit
    system = FreeSystem(assemble(problem.mesh, STEEL).held(problem.fixed))
    shifted = system.shifted(limit**2)
    rows: dict[str, list[float]] = {"bare factorisation": [], "by frequency limit": [], "by number": [first]}
    for _ in range(options.repeats):
        rows["bare factorisation"].append(timed(lambda: Factorizer().factor(shifted))[1])
        by_limit, seconds = timed(lambda: ours(problem, limit=limit, count=None))
        rows["by frequency limit"].append(seconds)
        rows["by number"].append(timed(lambda: ours(problem, limit=None, count=options.modes))[1])
    assert by_limit.certificate.complete
    assert by_limit.certificate.found == by_count.certificate.found
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    if options.stock:
        frequencies, seconds = timed(lambda: stock(problem, options.modes))
        rows["scikit-fem and eigsh"] = [seconds]
        found = by_count.frequencies_hz[: options.modes]
        print(f"largest difference of a frequency from the stock way: {np.abs(frequencies / found - 1.0).max():.1e}")
    bare, least = (statistics.median(rows[name]) for name in ("bare factorisation", "by frequency limit"))
    print(f"{'':24}{'median':>9}{'least':>9}{'/ bare':>9}{'/ ours':>9}")
    for name, seconds_taken in rows.items():
        median = statistics.median(seconds_taken)
        print(f"{name:24}{median:8.2f}s{min(seconds_taken):8.2f}s{median / bare:9.2f}{median / least:9.2f}")
    proof = by_limit.certificate
    print(f"\ncertificate: {proof.found} of {proof.expected} below {proof.limit / 2 / np.pi:.1f} Hz, ", end="")
    print(f"largest residual {proof.max_residual:.0e}; peak memory of ours {peak:.0f} MB")


if __name__ == "__main__":
    main()
