"""The coupling: housing modes, rotor modes and gears in one modal system, and its motion.

What the room offers:

- :func:`housing_component`, :func:`rotor_component` -- components in mass-normalised coordinates.
- :func:`couple` with :class:`MountedBearing`, :class:`GearMesh` and the loads of :mod:`coupling.loads` -- the
  :class:`Machine` and its :class:`CoupledSystem`; every tie is a connector, see :mod:`coupling.connector`.
- :func:`coupled_modes` -- complex natural modes about the mean contact.
- :func:`static_equilibrium`, :func:`simulate` -- where it rests, and how it moves from there.
- :func:`transient_outputs`, :func:`histories`, :func:`amplitude_spectrum` -- what the sensors, gears and bearings
  show.
- :mod:`coupling.gears` -- tooth geometry, mesh stiffness and the contact law.

numba is imported only when :func:`simulate` or :func:`static_equilibrium` runs.
"""

from coupling.base_motion import BaseHarmonic, BaseHistory, BaseMotion
from coupling.component import Component, HousingComponent, RotorComponent, housing_component, rotor_component
from coupling.connector import ContactConnector, LinearConnector, SpeedTable
from coupling.errors import CouplingError, TransientError
from coupling.free_speed import free_speed
from coupling.histories import Histories, histories, transient_outputs
from coupling.loads import AnyTorque, BowReactions, Drive, Torque, TorqueHistory, TorqueRipple, TorqueSlope, Unbalance
from coupling.machine import GearMesh, Machine, MountedBearing, MountedGear, couple
from coupling.marching import Block, Checkpoint, march_blocks
from coupling.modes import CoupledModes, coupled_modes
from coupling.settings import TransientOutputs, TransientSettings
from coupling.spectrum import Peak, Spectrum, Window, amplitude_spectrum, spectrum_peaks
from coupling.statics import static_equilibrium
from coupling.system import CoupledSystem, HarmonicLoad, TimedLoad
from coupling.transient import (
    EnergyBalance,
    TransientFigures,
    TransientResult,
    sample_times,
    simulate,
    transient_figures,
)
from coupling.turning import Turning

__all__ = [
    "AnyTorque",
    "BaseHarmonic",
    "BaseHistory",
    "BaseMotion",
    "Block",
    "BowReactions",
    "Checkpoint",
    "Component",
    "ContactConnector",
    "CoupledModes",
    "CoupledSystem",
    "CouplingError",
    "Drive",
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
    "RotorComponent",
    "Spectrum",
    "SpeedTable",
    "TimedLoad",
    "Torque",
    "TorqueHistory",
    "TorqueRipple",
    "TorqueSlope",
    "TransientError",
    "TransientFigures",
    "TransientOutputs",
    "TransientResult",
    "TransientSettings",
    "Turning",
    "Unbalance",
    "Window",
    "amplitude_spectrum",
    "couple",
    "coupled_modes",
    "free_speed",
    "histories",
    "housing_component",
    "march_blocks",
    "rotor_component",
    "sample_times",
    "simulate",
    "spectrum_peaks",
    "static_equilibrium",
    "transient_figures",
    "transient_outputs",
]
