"""Sound of a case: its lines and modes, at microphones, of mesh harmonics, and the proofs of all."""

from collections.abc import Callable

from gearwhine.case import Case
from gearwhine.meshes import Mesh


def is_in_run(case: Case) -> bool:
    """Whether `run` finds the sound of a case's motion."""
    return case.housing is not None and case.acoustics is not None and case.acoustics.is_in_run


def check_before_modes(case: Case) -> Callable[[Case, Mesh], None] | None:
    """Return what refuses a case's `[acoustics]` on its mesh; None where it has none."""
    if case.acoustics is None:
        return None
    # The acoustics' kernels are for these cases alone.
    from gearwhine.solve.sound.acoustics_checks import require_acoustics

    return require_acoustics
