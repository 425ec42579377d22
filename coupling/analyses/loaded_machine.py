"""Machine about its operating point: parts linearised there, gear pairs under load, and the coupled system."""

from dataclasses import dataclass, replace
from functools import cached_property

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.description.excitation import Run
from gearwhine.coupling.errors import CouplingError, EquilibriumNotFoundError
from gearwhine.coupling.gears import GearError
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
from gearwhine.coupling.linear.damping_band import DampingBand
from gearwhine.coupling.linear.frequency_response import BasisError
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.numerics.progress import Progress, silent
from gearwhine.rotors import EquilibriumError, RotorError

NO_OPERATING_POINT = (CouplingError, EquilibriumNotFoundError, EquilibriumError, GearError, RotorError)
"""Errors of a machine whose equilibrium is not found."""

_MORE_MODES = 2.0  # limit factor of the shafts' modes in the basis for comparison, which gives the error


def point_of_flanks(
    machine: Machine, progress: Progress = silent, *, is_needed: bool | None = None
) -> OperatingPoint | None:
    """Return the operating point of a machine where a pair has its misalignment or its share from there; else None.

    A machine that has none has aligned flanks, unless the point ``is_needed``; by default it is where a bearing has its
    stiffness from its load.

    Raises
    ------
    CouplingError, EquilibriumNotFoundError
        Where it is needed, and the machine has none.
    """
    if not machine.leaves_flanks_to_load:
        return None
    progress("load of the flanks at the operating point")
    try:
        return machine.operating_point()
    except NO_OPERATING_POINT:
        if any(one.needs_load for one in machine.bearings) if is_needed is None else is_needed:
            raise
        return None


@dataclass(frozen=True, eq=False)
class LoadedMachine:
    """Machine about its operating point: its parts, its gear pairs under load, and the coupled system.

    Attributes
    ----------
    machine : Machine
        Bearings and flanks that are left to the operating point are those of it.
    pairs : tuple of LoadedGearPair
    coupled : CoupledMachine
        Assembled for its run.
    run : SpeedRun, FreeRun or None
        None at constant speed.
    """

    machine: Machine
    pairs: tuple[LoadedGearPair, ...]
    coupled: CoupledMachine
    run: Run | None

    @cached_property
    def basis_error(self) -> BasisError | None:
        """Estimate the modal truncation error by a machine of other residual attachments and more shaft modes.

        None where there is no housing, and so no sensor.
        """
        housing = self.machine.housing_component
        if housing is None or housing.coarser is None or not housing.sensors:
            return None
        other = replace(self.machine, housing=housing.coarser)
        components = other.rotor_components(limit_factor=_MORE_MODES)
        return BasisError(self.coupled, other.assemble(self.pairs, components, self.run))

    @cached_property
    def bands(self) -> DampingBand:
        """Bands of the lines of its sensors by damping, and what excites them."""
        return DampingBand(LineMechanisms(self.coupled))


def load_machine(
    machine: Machine,
    point: OperatingPoint | None,
    run: Run | None = None,
    progress: Progress = silent,
) -> LoadedMachine:
    """Assemble a machine about its operating point.

    Parameters
    ----------
    machine : Machine
    point : OperatingPoint or None
        None where nothing loads the machine, or where it is not found: flanks are aligned then.
    run : SpeedRun or FreeRun, optional
    progress : callable

    Raises
    ------
    gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError
        Where the parts do not make a machine, or a bearing is left to an operating point that is not there.
    gearwhine.coupling.TransientError
        Where a free speed cannot start or stalls.
    """
    about = machine.linearised(point)
    pairs = about.loaded_pairs(progress)
    coupled = about.assemble(pairs, about.rotor_components(progress=progress), run)
    return LoadedMachine(about, pairs, coupled, run)
