"""The coupling: housing modes, rotor modes and gears in one modal system, and its motion.

What the room offers:

- :func:`housing_component`, :func:`rotor_component` -- components in mass-normalised coordinates.
- :func:`couple` with :class:`MountedBearing`, :class:`GearMesh`, :class:`Unbalance`, :class:`Torque` -- the
  :class:`Machine` and its :class:`CoupledSystem`; every tie is a connector, see :mod:`coupling.connector`.
- :func:`coupled_modes` -- complex natural modes about the mean contact.
- :func:`static_equilibrium`, :func:`simulate` -- where it rests, and how it moves from there.
- :mod:`coupling.periodic` -- the steady state directly: :func:`periodic_response`, its Floquet multipliers, and
  :func:`response_curve` over speed.
- :func:`transient_outputs`, :func:`histories`, :func:`amplitude_spectrum` -- what the sensors, gears and bearings
  show.
- :mod:`coupling.gears` -- tooth geometry, mesh stiffness and the contact law.

numba is imported only when one of :func:`simulate`, :func:`static_equilibrium` and :mod:`coupling.periodic` runs.
"""

from coupling.component import Component, HousingComponent, RotorComponent, housing_component, rotor_component
from coupling.connector import ContactConnector, LinearConnector
from coupling.errors import CouplingError, PeriodicError, TransientError
from coupling.histories import Histories, histories, transient_outputs
from coupling.machine import GearMesh, Machine, MountedBearing, MountedGear, Torque, Unbalance, couple
from coupling.modes import CoupledModes, coupled_modes
from coupling.periodic import PeriodicResponse, ResponseCurve, periodic_response, response_curve
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
    "MountedBearing",
    "MountedGear",
    "Peak",
    "PeriodicError",
    "PeriodicResponse",
    "ResponseCurve",
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
    "periodic_response",
    "response_curve",
    "rotor_component",
    "simulate",
    "spectrum_peaks",
    "static_equilibrium",
    "transient_outputs",
]
