"""The ``gearwhine`` command."""

import gc
import os
import sys
from contextlib import suppress

_BLAS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def main() -> None:
    """Run the command and leave with its exit code."""
    if "OMP_NUM_THREADS" not in os.environ:
        # Read when numpy is loaded, later than here. Factorisations and products of the housing have threads of their
        # own; those of BLAS wait for each other in the small matrices of a machine, on a busy processor for minutes.
        for name in _BLAS:
            os.environ.setdefault(name, "1")
    # Imports and figures make a million objects, most of which stay: by Python's own threshold a seventh of the time
    # of a short run would go into looking for those that do not.
    gc.set_threshold(20_000, 20, 20)
    from gearwhine.cli import run_command
    from gearwhine.interruption import INTERRUPTED

    code = run_command(sys.argv[1:], is_process=True)
    if code == INTERRUPTED:
        # Python would wait for threads that are in compiled code, such as one that finds an ordering.
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError):
                stream.flush()
        os._exit(code)
    sys.exit(code)


if __name__ == "__main__":
    main()
