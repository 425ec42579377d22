"""Coupled machines of cases, for tests of what is computed with them."""

import numpy as np

import gearwhine as gw
from gearwhine.case import Case
from gearwhine.coupling import CoupledMachine
from gearwhine.coupling.analyses.loaded_machine import LoadedMachine, load_machine
from gearwhine.coupling.linear.lines_over_speed import sensor_rms
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.from_case.machine import describe_machine
from gearwhine.housing import HousingModes
from gearwhine.solve.machine import reduce_housing, run_of


def loaded(case: Case, housing: HousingModes | HousingComponent | None = None) -> LoadedMachine:
    """The machine of a case with aligned flanks, its bearings about the operating point where they are left to it."""
    part = reduce_housing(case, housing) if isinstance(housing, HousingModes) else housing
    machine = describe_machine(case, part).with_flanks_of(None)
    point = machine.operating_point() if machine.needs_operating_point else None
    return load_machine(machine, point, run_of(case.transient))


def coupled(case: Case, housing: HousingModes | HousingComponent | None = None) -> CoupledMachine:
    """The coupled system of :func:`loaded`."""
    return loaded(case, housing).coupled


def about_operating_point(case: Case, housing: HousingModes | HousingComponent | None = None) -> LoadedMachine:
    """The machine of a case as its commands assemble it."""
    part = reduce_housing(case, housing) if isinstance(housing, HousingModes) else housing
    machine = describe_machine(case, part)
    point = machine.operating_point() if machine.needs_operating_point else None
    return load_machine(machine, point, run_of(case.transient))


def sensor_level(study: gw.CaseStudy, sensor: str) -> float:
    """Level of all lines of the teeth at a sensor [dB re 1 µm/s²], of the linear machine about its operating point."""
    machine = study.machine
    coupled, housing = load_machine(machine, machine.operating_point()).coupled, machine.housing_component
    assert housing is not None
    assert housing.complete_below is not None
    rms = sensor_rms(coupled, housing.complete_below)[[*coupled.sensor_rows].index(sensor)]
    return float(20.0 * np.log10(rms / 1e-6))
