"""Acoustics of a case: `[acoustics]` as settings of the sound, and their refusals by the keys of the case."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from gearwhine.case import Case, CaseError, Housing, Problem
from gearwhine.case.acoustics import Acoustics
from gearwhine.case.errors import UNSAID, key_of
from gearwhine.coupling.errors import AcousticsError
from gearwhine.coupling.sound.acoustics import Acoustics as AcousticsSettings
from gearwhine.meshes import Mesh
from gearwhine.numerics.findings import Finding, in_mm

_LENGTHS = ("mesh_size", "floor", "microphone_box", "position")


def acoustics_of(case: Case) -> AcousticsSettings:
    """Return the settings of a case's sound; without `[acoustics]` boundary elements in free air."""
    return (case.acoustics or Acoustics()).build()


def check_before_modes(acoustics: Acoustics | None, housing: Housing | None) -> Callable[[Mesh], None] | None:
    """Return what refuses `[acoustics]` on the mesh of a housing; None without one of the two."""
    if acoustics is None or housing is None:
        return None
    bore = max((seat.diameter for seat in housing.seat), default=None)
    return partial(_require_on_mesh, acoustics.build(), bore, housing.frequency_limit)


def _require_on_mesh(acoustics: AcousticsSettings, bore: float | None, limit_hz: float | None, mesh: Mesh) -> None:
    """Refuse a radiating surface or microphones that cannot be, before the modes are solved.

    Parameters
    ----------
    acoustics : Acoustics
    bore : float or None
        Diameter of the widest seat [m].
    limit_hz : float or None
        Frequency below which modes are wanted [Hz].
    mesh : Mesh
        Mesh of the housing; straight elements suffice.

    Raises
    ------
    CaseError
        With everything that is wrong.
    """
    # The acoustics' kernels are for these cases alone.
    from gearwhine.coupling.sound.acoustics_checks import require_acoustics

    with refused_by_key(acoustics):
        require_acoustics(acoustics, mesh, bore, acoustics.highest_frequency or limit_hz)


@contextmanager
def refused_by_key(acoustics: AcousticsSettings) -> Iterator[None]:
    """Refuse acoustics that do not fit the housing by the keys of a case.

    Raises
    ------
    CaseError
        With everything that is wrong.
    """
    try:
        yield
    except AcousticsError as error:
        if not error.findings:
            raise
        raise CaseError([_problem(acoustics, finding) for finding in error.findings]) from error


def _problem(acoustics: AcousticsSettings, finding: Finding) -> Problem:
    kind, name = finding.part
    if kind == "microphone":
        number = [microphone.name for microphone in acoustics.microphone].index(name)
        place = key_of(("acoustics", "microphone", number, finding.attribute))
        return Problem(f'{place} (microphone "{name}")', _value(finding), finding.expected)
    steps = [int(step) if step.isdecimal() else step for step in finding.attribute.split(".") if step]
    return Problem(key_of(("acoustics", *steps)), _value(finding), finding.expected)


def _value(finding: Finding) -> Any:
    """Return the value of a finding as a case would have it."""
    if finding.value is None:
        return UNSAID
    if finding.attribute not in _LENGTHS:
        return finding.value
    lengths = finding.value if isinstance(finding.value, tuple) else (finding.value,)
    return ", ".join(in_mm(length) for length in lengths)
