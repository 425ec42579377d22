"""Ranks of MPI that factor K - σM by MUMPS and find its modes by SLEPc: a program of its own, started by `slepc`.

It imports nothing of this package, so that any Python with numpy, petsc4py and slepc4py serves. The first rank reads
requests from standard input, a line of JSON each, and answers with a line of JSON; arrays go through files of a folder
that all ranks see. Each rank reads its own rows of the matrices:

    pointer.npy, rows.npy                  lower triangle by columns, which is the upper one by rows
    stiffness.npy, mass.npy                K and M on this pattern

| request | answer |
|---|---|
| `{"do": "factor", "shift": σ}` | `negative`: negative eigenvalues of K - σM; `fill`: entries of its factor |
| `{"do": "solve"}` | solution of (K - σM) X = Y, from `right.npy` to `left.npy` |
| `{"do": "modes", "count": m, "above": true, "seed": 0}` | `found`: modes below σ, in `values.npy` and `left.npy` |
| `{"do": "memory"}` | `peak`: largest memory of each rank [bytes] |
"""

import json
import pathlib
import resource
import sys
from typing import Any

import numpy as np


def main() -> None:
    """Answer requests until there are none."""
    import slepc4py

    slepc4py.init([sys.argv[0]])
    from petsc4py import PETSc

    comm = PETSc.COMM_WORLD.tompi4py()
    ranks = Ranks(pathlib.Path(sys.argv[1]), comm)
    answer: dict[str, object] = {"ranks": comm.size, "petsc": ".".join(map(str, PETSc.Sys.getVersion()))}
    if not PETSc.Sys.hasExternalPackage("mumps"):
        answer = {"error": "this PETSc has no MUMPS"}
    while True:
        if comm.rank == 0:
            sys.stdout.write(json.dumps(answer) + "\n")
            sys.stdout.flush()
        line = comm.bcast(sys.stdin.readline() if comm.rank == 0 else None)
        if not line.strip():
            return
        request = json.loads(line)
        try:
            answer = getattr(ranks, request.pop("do"))(**request)
        except PETSc.Error as error:
            answer = {"error": " ".join(str(error).split())}


class Ranks:
    """The matrices of a problem, its factor and its eigensolver, distributed by rows."""

    def __init__(self, folder: pathlib.Path, comm: Any) -> None:
        self._folder, self._comm = folder, comm
        self._eps: Any = None
        self._matrices: tuple[Any, ...] = ()

    def factor(self, shift: float) -> dict[str, object]:
        """Factor K - σM; SLEPc's spectral transformation holds the factor, for modes and solutions."""
        # A transformation that has a factor does not always make another for another shift (SLEPc 3.18).
        if self._eps is not None:
            self._eps.destroy()
        self._eps = self._solver()
        transformation = self._eps.getST()
        transformation.setShift(shift)
        self._eps.setTarget(shift)
        self._eps.setUp()
        self._eps.setUp()
        transformation.getKSP().setUp()
        factor = transformation.getKSP().getPC().getFactorMatrix()
        negative, zero, _ = factor.getInertia()
        if zero:
            return {"error": f"{zero} pivots vanish"}
        return {"negative": int(negative), "fill": int(factor.getMumpsInfog(29))}

    def solve(self) -> dict[str, object]:
        """Solve for each column of the right-hand sides."""
        right = np.load(self._folder / "right.npy", mmap_mode="r")
        ksp = self._eps.getST().getKSP()
        given, solution = self._eps.getOperators()[0].createVecs()
        first, last = given.getOwnershipRange()
        write = _Columns(self._folder / "left.npy", self._comm, solution, right.shape[1])
        for column in range(right.shape[1]):
            given.setArray(right[first:last, column])
            ksp.solve(given, solution)
            write(column, solution)
        write.close()
        return {}

    def modes(self, count: int, above: bool, seed: int) -> dict[str, object]:
        """Find the modes next to the shift on one side: with ``above`` those below it."""
        eps = self._eps
        shift = eps.getST().getShift()
        side = -1.0 if above else 1.0

        def preferred(one: complex, other: complex, *_: object) -> int:
            """Order eigenvalues: those on the right side by their distance, then the others by theirs."""
            ranks = [(side * (value.real - shift) <= 0.0, abs(value.real - shift)) for value in (one, other)]
            return int(ranks[0] > ranks[1]) - int(ranks[0] < ranks[1])

        from slepc4py import SLEPc

        eps.setWhichEigenpairs(SLEPc.EPS.Which.USER)
        eps.setEigenvalueComparison(preferred)
        size = eps.getOperators()[0].getSize()[0]
        eps.setDimensions(count, min(size, max(2 * count, count + 20) * 2**seed))
        start, vector = eps.getOperators()[0].createVecs()
        first, last = start.getOwnershipRange()
        start.setArray(np.random.default_rng([seed, first]).standard_normal(last - first))
        eps.setInitialSpace(start)
        eps.solve()
        found = min(count, eps.getConverged())
        values = np.array([eps.getEigenvalue(place).real for place in range(found)])
        write = _Columns(self._folder / "left.npy", self._comm, vector, found)
        for column, place in enumerate(np.argsort(values)):
            eps.getEigenvector(int(place), vector)
            write(column, vector)
        write.close()
        if self._comm.rank == 0:
            np.save(self._folder / "values.npy", np.sort(values))
        return {"found": found}

    def memory(self) -> dict[str, object]:
        """Largest memory of each rank, by the operating system."""
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
        return {"peak": self._comm.allgather(peak)}

    def _solver(self) -> Any:
        from petsc4py import PETSc
        from slepc4py import SLEPc

        options = PETSc.Options()
        # The inertia needs the pivots of the last front too, which a distributed dense solver would not count.
        options["st_mat_mumps_icntl_13"] = 1
        options["st_mat_mumps_icntl_24"] = 1  # pivots that vanish are found, which would be an inertia of chance
        options["st_mat_mumps_icntl_14"] = 50  # per cent of memory beyond the estimate, for delayed pivots
        eps = SLEPc.EPS().create(PETSc.COMM_WORLD)
        self._matrices = self._matrices or (self._matrix("stiffness"), self._matrix("mass"))
        eps.setOperators(*self._matrices)
        eps.setProblemType(SLEPc.EPS.ProblemType.GHEP)
        eps.setType(SLEPc.EPS.Type.KRYLOVSCHUR)
        eps.setTolerances(1e-11, 200)
        transformation = eps.getST()
        transformation.setType(SLEPc.ST.Type.SINVERT)
        transformation.setMatStructure(PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        ksp = transformation.getKSP()
        ksp.setType(PETSc.KSP.Type.PREONLY)
        ksp.getPC().setType(PETSc.PC.Type.CHOLESKY)
        ksp.getPC().setFactorSolverType("mumps")
        transformation.setFromOptions()
        return eps

    def _matrix(self, name: str) -> Any:
        """Read a symmetric matrix, of which each rank has some rows."""
        from petsc4py import PETSc

        pointer, rows, values = (
            np.load(self._folder / f"{part}.npy", mmap_mode="r") for part in ("pointer", "rows", name)
        )
        size = len(pointer) - 1
        first, last = (size * rank // self._comm.size for rank in (self._comm.rank, self._comm.rank + 1))
        begin, end = pointer[first], pointer[last]
        matrix = PETSc.Mat().create(PETSc.COMM_WORLD)
        matrix.setSizes(((last - first, size), (last - first, size)))
        matrix.setType(PETSc.Mat.Type.SBAIJ)
        index = PETSc.IntType
        matrix.setPreallocationCSR(
            ((pointer[first : last + 1] - begin).astype(index), rows[begin:end].astype(index), values[begin:end])
        )
        matrix.assemble()
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        return matrix


class _Columns:
    """Distributed vectors that the first rank writes to a file, one after another."""

    def __init__(self, path: pathlib.Path, comm: Any, like: Any, count: int) -> None:
        from petsc4py import PETSc

        self._scatter, self._whole = PETSc.Scatter.toZero(like)
        self._file: Any = None
        if comm.rank == 0:
            self._file = np.lib.format.open_memmap(
                path, mode="w+", dtype=np.float64, shape=(like.getSize(), count), fortran_order=True
            )

    def __call__(self, column: int, vector: Any) -> None:
        from petsc4py import PETSc

        self._scatter.scatter(vector, self._whole, PETSc.InsertMode.INSERT, PETSc.ScatterMode.FORWARD)
        if self._file is not None:
            self._file[:, column] = self._whole.getArray()

    def close(self) -> None:
        if self._file is not None:
            self._file.flush()


if __name__ == "__main__":
    main()
