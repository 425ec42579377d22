"""Simulated motion of a machine as a labelled dataset."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from coupling.histories import HISTORY_QUANTITIES, Histories
from coupling.machine import CoupledMachine
from coupling.spectrum import Spectrum, amplitude_spectrum
from coupling.transient import TransientResult

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Motion:
    """Motion of a machine over whole revolutions of its first driver.

    Attributes
    ----------
    machine : CoupledMachine
    result : TransientResult
        Steps, energy balance, contact figures.
    histories : Histories
        Signals of sensors, bearings, gears and gear pairs by name.
    """

    machine: CoupledMachine
    result: TransientResult
    histories: Histories

    @property
    def energy_error(self) -> float:
        """Part of the energy that is missing from the balance of the time integration."""
        return self.result.energy.error

    @cached_property
    def dataset(self) -> "xr.Dataset":
        """Every signal with its dimensions, unit and long name."""
        import xarray as xr

        variables: dict[str, Any] = {}
        coordinates: dict[str, Any] = {
            "time": ("time", self.histories.times, {"units": "s", "long_name": "time from static equilibrium"})
        }
        for quantity in HISTORY_QUANTITIES:
            if values := quantity.of(self.histories):
                coordinates |= quantity.coordinates(list(values))
                labels = {"units": quantity.unit, "long_name": quantity.what}
                variables[quantity.name] = (quantity.dimensions, np.array(list(values.values())), labels)
        return xr.Dataset(variables, coordinates)

    def spectrum(self, quantity: str, signal: str) -> Spectrum:
        """Amplitude spectrum of one signal, for instance ``("mesh_force", "pinion -> wheel")``.

        Raises
        ------
        KeyError
            Where there is no such quantity or signal.
        """
        values = self.dataset[quantity].sel({self.dataset[quantity].dims[0]: signal}).values
        return amplitude_spectrum(values, float(self.histories.times[1] - self.histories.times[0]))
