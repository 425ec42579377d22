"""The coupling: housing modes, rotor modes and gears in one modal system, and its motion.

What the room offers:

- :func:`housing_component`, :func:`rotor_component` -- components in mass-normalised coordinates.
- :func:`couple` with :class:`MountedBearing`, :class:`GearMesh`, :class:`Unbalance`, :class:`Torque` -- the
  :class:`Machine` and its :class:`CoupledSystem`; every tie is a connector, see :mod:`coupling.connector`.
- :func:`coupled_modes` -- complex natural modes about the mean contact.
- :func:`static_equilibrium`, :func:`simulate` -- where it rests, and how it moves from there.
- :func:`transient_outputs`, :func:`histories`, :func:`amplitude_spectrum` -- what the sensors, gears and bearings
  show; :func:`modal_rows` -- the same motion by each rotor's modes.
- :mod:`coupling.gears` -- tooth geometry, mesh stiffness and the contact law.

numba is imported only when :func:`simulate` or :func:`static_equilibrium` runs.
"""

from coupling.component import Component, HousingComponent, RotorComponent, housing_component, rotor_component
from coupling.connector import ContactConnector, LinearConnector
from coupling.errors import CouplingError, TransientError
from coupling.histories import Histories, histories, transient_outputs
from coupling.machine import GearMesh, Machine, MountedBearing, MountedGear, Torque, Unbalance, couple
from coupling.modal_motion import ModalRows, modal_rows
from coupling.modes import CoupledModes, coupled_modes
from coupling.spectrum import Peak, Spectrum, Window, amplitude_spectrum, spectrum_peaks
from coupling.statics import static_equilibrium
from coupling.system import CoupledSystem, HarmonicLoad
from coupling.transient import EnergyBalance, TransientOutputs, TransientResult, TransientSettings, simulate

__all__ = [
    "Component",
    "ContactConnector",
    "CoupledModes",
    "CoupledSystem",
    "CouplingError",
    "EnergyBalance",
    "GearMesh",
    "HarmonicLoad",
    "Histories",
    "HousingComponent",
    "LinearConnector",
    "Machine",
    "ModalRows",
    "MountedBearing",
    "MountedGear",
    "Peak",
    "RotorComponent",
    "Spectrum",
    "Torque",
    "TransientError",
    "TransientOutputs",
    "TransientResult",
    "TransientSettings",
    "Unbalance",
    "Window",
    "amplitude_spectrum",
    "couple",
    "coupled_modes",
    "histories",
    "housing_component",
    "modal_rows",
    "rotor_component",
    "simulate",
    "spectrum_peaks",
    "static_equilibrium",
    "transient_outputs",
]
