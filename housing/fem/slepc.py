"""Factor and modes by PETSc, SLEPc and MUMPS on the ranks of MPI: for housings larger than one machine's memory.

The ranks run beside this process, started by the command of the environment variable ``GEARWHINE_SLEPC``, such as
``mpiexec -n 16 --hostfile hosts python3``, to which the program of :mod:`gearwhine.housing.fem.slepc_ranks` is added.
By default it is ``mpiexec`` with as many ranks as the factorisation has threads, of this Python. Matrices and vectors
go through files of a temporary folder, which for several machines is to lie where all see it (``TMPDIR``).

What comes back is certified as from any other solver: the inertia is that of MUMPS' pivots, and the residuals are
computed here.
"""

import contextlib
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import weakref
from pathlib import Path
from typing import IO, Any, cast

import numpy as np

from gearwhine.housing.errors import FactorizationError, HousingError, IncompleteModesError
from gearwhine.housing.fem.linear_algebra import SymmetricMatrix
from gearwhine.numerics.arrays import FloatArray

COMMAND = "GEARWHINE_SLEPC"
"""Environment variable with the command that starts a Python on all ranks."""

_PROGRAM = Path(__file__).resolve().with_name("slepc_ranks.py")
_WORDS_OF_AN_ERROR = 40


class SlepcUnavailableError(HousingError):
    """The ranks of SLEPc cannot be started; the message says what is missing."""


class SlepcRanks:
    """Ranks of MPI that hold a problem K φ = λ M φ and the factor of K - σM; they end with this object.

    Parameters
    ----------
    stiffness, mass : SymmetricMatrix
        K [N/m] and M [kg] on one pattern.
    threads : int
        Number of ranks, where the environment has no command.

    Raises
    ------
    SlepcUnavailableError
        Where the command cannot be run, or its Python has no petsc4py, slepc4py or MUMPS.
    """

    def __init__(self, stiffness: SymmetricMatrix, mass: SymmetricMatrix, threads: int = 2) -> None:
        command = shlex.split(os.environ.get(COMMAND, "")) or ["mpiexec", "-n", str(threads), sys.executable]
        self._folder = Path(tempfile.mkdtemp(prefix="gearwhine-slepc-"))
        self.size = stiffness.shape[0]
        self._shift = np.nan
        arrays = {"pointer": stiffness.pointer, "rows": stiffness.rows}
        for name, array in (arrays | {"stiffness": stiffness.values, "mass": mass.values}).items():
            np.save(self._folder / f"{name}.npy", array)
        self._errors = self._folder / "errors.txt"
        try:
            with self._errors.open("w") as errors:
                self._process = subprocess.Popen(
                    [*command, str(_PROGRAM), str(self._folder)],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=errors,
                    text=True,
                    start_new_session=True,  # an mpiexec that fails may signal its whole group
                )
        except OSError as error:
            shutil.rmtree(self._folder, ignore_errors=True)
            raise SlepcUnavailableError(_missing(command, str(error))) from error
        self._requests, self._answers = cast("IO[str]", self._process.stdin), cast("IO[str]", self._process.stdout)
        self._end = weakref.finalize(self, _end, self._process, self._folder)
        try:
            self.ranks = int(self._answer()["ranks"])
        except FactorizationError as error:
            self._end()
            raise SlepcUnavailableError(_missing(command, str(error))) from error

    def factor(self, shift: float) -> "SlepcFactor":
        """Factor K - σM; the ranks hold one factor at a time, and make one of before again where it is used."""
        answer = self._ask(do="factor", shift=shift)
        self._shift = shift
        return SlepcFactor(self, shift, int(answer["negative"]), int(answer["fill"]))

    def solve(self, shift: float, right: FloatArray) -> FloatArray:
        """Solve (K - σM) X = Y, shape (n,) or (n, m)."""
        self._hold(shift)
        np.save(self._folder / "right.npy", right.reshape(self.size, -1))
        self._ask(do="solve")
        return np.asarray(np.load(self._folder / "left.npy").reshape(right.shape))

    def modes(self, shift: float, count: int, *, above: bool, seed: int) -> tuple[FloatArray, FloatArray]:
        """Find the modes next to a shift on one side of it.

        Parameters and values are as of :func:`gearwhine.housing.modes.eigensolver.block_lanczos`; each seed doubles the
        basis.

        Raises
        ------
        IncompleteModesError
            Where the modes do not converge.
        """
        self._hold(shift)
        found = int(self._ask(do="modes", count=count, above=above, seed=seed)["found"])
        if found < count:
            raise IncompleteModesError(
                f"SLEPc converged to {found} of {count} modes; ask for fewer, move the limit or refine the mesh"
            )
        return np.load(self._folder / "values.npy"), np.asfortranarray(np.load(self._folder / "left.npy"))

    def _hold(self, shift: float) -> None:
        if shift != self._shift:
            self.factor(shift)

    def peak_memory(self) -> list[int]:
        """Largest memory of each rank so far, by the operating system [bytes]."""
        return [int(peak) for peak in self._ask(do="memory")["peak"]]

    def _ask(self, **request: Any) -> dict[str, Any]:
        try:
            self._requests.write(json.dumps(request) + "\n")
            self._requests.flush()
        except OSError:
            pass  # the ranks have ended, and the answer says why
        return self._answer()

    def _answer(self) -> dict[str, Any]:
        for line in self._answers:
            if line.startswith("{"):
                answer: dict[str, Any] = json.loads(line)
                if "error" in answer:
                    raise FactorizationError(f"the ranks of SLEPc report: {answer['error']}")
                return answer
        self._process.wait()
        lines = self._errors.read_text().splitlines()
        named = [line for line in lines if "Error" in line]  # a Python's, among what mpiexec says about its end
        said = " ".join(" ".join(named[:1] + lines[:3]).split()[:_WORDS_OF_AN_ERROR])
        raise FactorizationError(f"the ranks of SLEPc ended with code {self._process.returncode}: {said}")


class SlepcFactor:
    """Factor of K - σM on the ranks."""

    def __init__(self, ranks: SlepcRanks, shift: float, negative: int, fill: int) -> None:
        self._ranks, self._shift, self.negative, self.fill = ranks, shift, negative, fill

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve for right-hand sides, shape (n,) or (n, m)."""
        return self._ranks.solve(self._shift, right)


def _end(process: "subprocess.Popen[str]", folder: Path) -> None:
    """Let the ranks end, by the end of their requests."""
    for stream in (process.stdin, process.stdout):
        with contextlib.suppress(OSError):  # what is still to be written to ranks that have ended
            cast("IO[str]", stream).close()
    try:
        process.wait(timeout=10.0)
    except subprocess.TimeoutExpired:  # such as in a factorisation that nobody waits for any longer
        process.terminate()  # mpiexec then ends all ranks
        process.wait()
    shutil.rmtree(folder, ignore_errors=True)


def _missing(command: list[str], finding: str) -> str:
    return (
        "the solver 'slepc' needs MPI and a Python with petsc4py and slepc4py, PETSc built with MUMPS: "
        "`pip install gearwhine[slepc]`, or a Python that has them as the command of the environment variable "
        f"{COMMAND}, such as 'mpiexec -n 2 /usr/bin/python3'; {shlex.join(command)!r} fails: {finding}"
    )
