"""Coupled machines of cases, for tests of what is computed with them."""

import numpy as np

import gearwhine as gw
from gearwhine.case import Case
from gearwhine.coupling import CoupledMachine
from gearwhine.coupling.analyses.loaded_machine import LoadedMachine, load_machine
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
    """Level of all mesh harmonics at a sensor [dB re 1 µm/s²], of the lines that ``system`` gives."""
    lines = study.system().document["mesh_lines"]
    sizes = np.array([line["sensor_acceleration_m_per_s2"]["together"][sensor] for line in lines])
    return float(20.0 * np.log10(np.sqrt(0.5 * np.sum(sizes**2)) / 1e-6))
