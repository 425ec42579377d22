"""The small gearbox with a quick sound: the estimate by its walls' velocity, or Rayleigh's integral of its top."""

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from coupled_cases import about_operating_point

import gearwhine as gw
from gearwhine.analyses.result import Result
from gearwhine.analyses.run_solution import RunSolution
from gearwhine.case import Case
from gearwhine.coupling import CoupledMachine
from gearwhine.coupling.sweep.reduced_motion import ReducedMotion
from gearwhine.housing import HousingModes
from gearwhine.sweep.solution import PointResult

QUICK: dict[str, Any] = {
    "acoustics.method": "erp",
    "acoustics.mesh_size": "24 mm",
    "acoustics.highest_frequency": "3 kHz",
    "rotor.0.unbalance": [{"at": "100 mm", "moment": "5e-2 kg*m"}],
    "operation.speed": "5400 rpm",
}
EAR = {"name": "ear", "position": ["0.1 m", "1.2 m", "0.2 m"]}
TOP = {
    "acoustics.method": "rayleigh",
    "acoustics.faces": ["top"],
    "acoustics.microphone": [EAR],
    "acoustics.highest_frequency": "3 kHz",
}


@cache
def small_gearbox() -> gw.CaseStudy:
    """The gearbox with the housing of all these."""
    return gw.load("small-gearbox")


def sounding_housing() -> HousingModes:
    """Its solved housing."""
    housing = small_gearbox().housing
    assert housing is not None
    return housing


def sounding_gearbox(changes: dict[str, Any]) -> gw.CaseStudy:
    """Load the gearbox with changes that leave its housing as it is."""
    return small_gearbox().changed(changes)


def swept_point(case: Case, text: str, outcome: PointResult | None = None, *, modes_key: str = "") -> Any:
    """A point of a sweep with the value of its key, whose motion has no lines by default."""
    speed = None if case.operation is None else case.operation.speed
    point = SimpleNamespace(case=case, texts=(text,), modes_key=modes_key, speed=speed)
    return SimpleNamespace(outcome=outcome or PointResult({}, ReducedMotion(np.zeros(0))), point=point)


@cache
def sounding_machine() -> CoupledMachine:
    """Assemble its machine, as the quick run has it."""
    case = sounding_gearbox(QUICK).case
    return about_operating_point(case, sounding_housing()).coupled


@cache
def quick_run(revolutions: float) -> Result[RunSolution]:
    """Run it over these turns after sixteen; 24 are whole ones of both shafts."""
    turns = {"transient.revolutions": revolutions, "transient.discard": 16.0}
    return sounding_gearbox(QUICK | turns).run()


@cache
def heard_run() -> Result[RunSolution]:
    """Run one of larger elements over eight turns with a microphone above it."""
    changes = {"housing.box.mesh_size": "45 mm", "transient.revolutions": 16.0, "transient.discard": 8.0}
    with pytest.MonkeyPatch.context() as patch:
        # Fewer frequencies than of a user's run, whose sound over time is the closer.
        patch.setattr("gearwhine.solve.kept_radiation.POINTS", 25)
        return gw.load("small-gearbox", TOP | changes).run()
