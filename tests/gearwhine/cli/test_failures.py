"""Exit codes and messages of failures: 2 for what the user can mend in the input, 1 for what the machine lacks."""

import errno
import os

import pytest

from gearwhine.case import CaseError, Problem
from gearwhine.coupling.errors import CouplingError, EquilibriumNotFoundError, ModesError, PeriodicError, TransientError
from gearwhine.coupling.gears.errors import ContactAccuracyError, GearError
from gearwhine.failures import PartlyFailedError, WorkersError, explain
from gearwhine.housing.errors import (
    EncoderUnavailableError,
    FactorizationError,
    HealthError,
    HousingError,
    IncompleteModesError,
    ReductionError,
    RendererUnavailableError,
)
from gearwhine.meshes.errors import GeometryError, MesherUnavailableError
from gearwhine.rotors.errors import EquilibriumError, RotorError
from gearwhine.rotors.errors import IncompleteModesError as RotorIncompleteModesError

INPUT = [
    CouplingError,
    GearError,
    HousingError,
    GeometryError,
    RotorError,
]
PROOFS = [
    ModesError,
    PeriodicError,
    TransientError,
    ContactAccuracyError,
    EncoderUnavailableError,
    FactorizationError,
    HealthError,
    IncompleteModesError,
    ReductionError,
    RendererUnavailableError,
    MesherUnavailableError,
    EquilibriumError,
    EquilibriumNotFoundError,
    RotorIncompleteModesError,
    PartlyFailedError,
    WorkersError,
]


def made(kind: type[Exception]) -> Exception:
    """An error of a kind with a message, whatever else it is made of."""
    error = kind.__new__(kind)
    Exception.__init__(error, "what is wrong")
    return error


@pytest.mark.parametrize("kind", INPUT)
def test_wrong_input_is_two(kind: type[Exception]) -> None:
    assert explain(made(kind)) == (2, "what is wrong")


@pytest.mark.parametrize("kind", PROOFS)
def test_what_the_machine_or_a_proof_lacks_is_one(kind: type[Exception]) -> None:
    assert explain(made(kind)) == (1, "what is wrong")


def test_problems_of_a_case_are_counted_and_listed() -> None:
    one, two = Problem("a.b", "3", "a positive number"), Problem("c", "x", "a name")
    code, text = explain(CaseError([one]))
    assert (code, text) == (2, f"the case cannot be used as it stands:\n  {one}")
    code, text = explain(CaseError([one, two]))
    assert (code, text) == (2, f"2 problems in the case:\n  {one}\n  {two}")


def test_the_system_s_failures_name_their_file() -> None:
    error = OSError(errno.EACCES, os.strerror(errno.EACCES), "out/results.nc")
    assert explain(error) == (1, "Permission denied: out/results.nc")
    assert explain(OSError("no room")) == (1, "no room")


def test_want_of_memory_says_what_needs_less() -> None:
    assert explain(MemoryError("the factor; take a larger mesh_size")) == (
        1,
        "out of memory: the factor; take a larger mesh_size",
    )
    code, text = explain(MemoryError())
    assert code == 1
    assert text is not None
    assert "mesh_size" in text


def test_what_nobody_foresaw_has_its_traceback() -> None:
    assert explain(ZeroDivisionError("division by zero")) == (1, None)
