"""The coupling: housing modes, rotor modes and gears in one modal system, and its motion.

What the room offers:

- :func:`housing_component`, :func:`rotor_component` -- components in mass-normalised coordinates.
- :func:`couple` with :class:`MountedBearing`, :class:`GearMesh`, :class:`Unbalance`, :class:`Torque` -- the
  :class:`Machine` and its :class:`CoupledSystem`; every tie is a connector, see :mod:`coupling.connector`.
- :func:`coupled_modes` -- complex natural modes about the mean contact.
- :func:`static_equilibrium`, :func:`simulate` -- where it rests, and how it moves from there.
- :func:`transient_outputs`, :func:`histories`, :func:`amplitude_spectrum` -- what the sensors, gears and bearings
  show.
- :mod:`coupling.gears` -- tooth geometry, mesh stiffness and the contact law.

numba is imported only when :func:`simulate` or :func:`static_equilibrium` runs.
"""

from coupling.boundaries import SAMPLES_PER_BLOCK
from coupling.component import Component, HousingComponent, RotorComponent, housing_component, rotor_component
from coupling.connector import ContactConnector, LinearConnector, SpeedTable
from coupling.decimation import Decimation, decimation
from coupling.errors import CouplingError, TransientError
from coupling.histories import Histories, Recorded, empty_histories, histories, transient_outputs
from coupling.machine import GearMesh, Machine, MountedBearing, MountedGear, Torque, Unbalance, couple
from coupling.marching import Block, Checkpoint, march_blocks, march_key, sample_times
from coupling.modes import CoupledModes, coupled_modes
from coupling.settings import TransientOutputs, TransientSettings
from coupling.spectrum import Peak, Spectrum, Window, amplitude_spectrum, averaged_spectrum, spectrum_peaks
from coupling.statics import static_equilibrium
from coupling.system import CoupledSystem, HarmonicLoad, TimedLoad
from coupling.transient import (
    EnergyBalance,
    TransientFigures,
    TransientResult,
    simulate,
    transient_figures,
)
from coupling.turning import Turning

__all__ = [
    "SAMPLES_PER_BLOCK",
    "Block",
    "Checkpoint",
    "Component",
    "ContactConnector",
    "CoupledModes",
    "CoupledSystem",
    "CouplingError",
    "Decimation",
    "EnergyBalance",
    "GearMesh",
    "HarmonicLoad",
    "Histories",
    "HousingComponent",
    "LinearConnector",
    "Machine",
    "MountedBearing",
    "MountedGear",
    "Peak",
    "Recorded",
    "RotorComponent",
    "Spectrum",
    "SpeedTable",
    "TimedLoad",
    "Torque",
    "TransientError",
    "TransientFigures",
    "TransientOutputs",
    "TransientResult",
    "TransientSettings",
    "Turning",
    "Unbalance",
    "Window",
    "amplitude_spectrum",
    "averaged_spectrum",
    "couple",
    "coupled_modes",
    "decimation",
    "empty_histories",
    "histories",
    "housing_component",
    "march_blocks",
    "march_key",
    "rotor_component",
    "sample_times",
    "simulate",
    "spectrum_peaks",
    "static_equilibrium",
    "transient_figures",
    "transient_outputs",
]
