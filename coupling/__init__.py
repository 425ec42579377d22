"""The coupling: housing modes, rotor modes and gears in one modal system, and its motion.

What the room offers:

- :func:`housing_component`, :func:`rotor_component` -- components in mass-normalised coordinates.
- :func:`couple` with :class:`MountedBearing`, :class:`GearMesh` and the loads of :mod:`coupling.loads` -- the
  :class:`CoupledMachine` and its :class:`CoupledSystem`; every tie is a connector, see :mod:`coupling.connector`.
- :class:`RollingLaw`, :class:`GapLaw` -- bearings with laws of their own, beside the linear ones of their tangents.
- :func:`coupled_modes` -- complex natural modes about the mean contact, or that of an instant (:func:`contact_at`),
  with energies by component, bearing and gear mesh; :func:`stability` -- which grow, and what feeds them.
- :func:`system_campbell` -- these over speed, with the crossings of shaft and mesh orders.
- :func:`mesh_error_response`, :func:`unbalance_response`, :func:`sensor_force_response`, :func:`receptance` -- over
  frequency, from what excites to mesh forces, bearing forces and sensors.
- :func:`static_equilibrium`, :func:`simulate` -- where it rests, and how it moves from there.
- :mod:`coupling.periodic` -- the steady state directly: :func:`periodic_response`, its Floquet multipliers, and
  :func:`response_curve` over speed.
- :func:`transient_outputs`, :func:`histories`, :func:`amplitude_spectrum` -- what the sensors, gears and bearings
  show; :func:`modal_rows` -- the same motion by each rotor's modes.
- :mod:`coupling.signature` -- what the lines of a spectrum are and where they come from; orders, sidebands, levels.
- :mod:`coupling.gears` -- tooth geometry, mesh stiffness and the contact law.

numba is imported only when one of :func:`simulate`, :func:`static_equilibrium` and :mod:`coupling.periodic` runs.
"""

from coupling.base_motion import BaseHarmonic, BaseHistory, BaseMotion
from coupling.basis_error import BasisError
from coupling.bearing_law import BearingLaw, GapLaw, RollingLaw
from coupling.boundaries import SAMPLES_PER_BLOCK
from coupling.campbell import SystemCampbell, SystemCrossing, system_campbell
from coupling.component import Component, HousingComponent, RotorComponent, housing_component, rotor_component
from coupling.connector import ContactConnector, LinearConnector, NonlinearConnector, Sliding, SpeedTable
from coupling.contact_state import (
    ContactState,
    contact_at,
    linear_matrices,
    mean_contact,
    time_of_phase,
    unloaded_contact,
)
from coupling.decimation import Decimation, decimation
from coupling.description import Driving, Machine, Shaft, ShaftGear
from coupling.errors import CouplingError, ModesError, PeriodicError, TransientError
from coupling.exact_march import march_method
from coupling.excitation import ExcitationLine, excitation_lines
from coupling.free_speed import free_speed
from coupling.gear_train import Output
from coupling.histories import Histories, Recorded, histories, nothing_recorded, transient_outputs
from coupling.loads import AnyTorque, BowReactions, Drive, Torque, TorqueHistory, TorqueRipple, TorqueSlope, Unbalance
from coupling.machine import CoupledMachine, couple
from coupling.march_run import Checkpoint, sample_times
from coupling.marching import Block, march_blocks, march_key
from coupling.modal_motion import ModalRecord, ModalRows, modal_record, modal_rows, with_modal_rows
from coupling.modes import CoupledModes, ModesCertificate, coupled_modes
from coupling.motion import Motion
from coupling.mounted import GearMesh, MountedBearing, MountedGear
from coupling.periodic import (
    LONGEST_COMMON_PERIOD,
    ExcitationGroup,
    GroupMotion,
    PeriodicResponse,
    ResponseCurve,
    SuperposedResponse,
    common_cycles,
    excitation_groups,
    periodic_response,
    response_curve,
    superposed_response,
)
from coupling.receptance import receptance, resonance_grid
from coupling.settings import TransientOutputs, TransientSettings
from coupling.shaft_dashpots import ShaftDashpots
from coupling.shares import ModeShares, Part
from coupling.spectrum import (
    Peak,
    SignalParts,
    Spectrum,
    Window,
    amplitude_spectrum,
    averaged_spectrum,
    lines_at,
    signal_parts,
    spectrum_peaks,
)
from coupling.stability import GrowingMode, Stability, stability
from coupling.statics import static_equilibrium
from coupling.system import CoupledSystem, HarmonicLoad, TimedLoad
from coupling.thrust import AxialForces, ThrustPair, axial_forces, require_thrust_carried
from coupling.transient import (
    EnergyBalance,
    TransientFigures,
    TransientResult,
    simulate,
    transient_figures,
)
from coupling.transmissibility import (
    FrequencyResponse,
    mesh_error_response,
    sensor_force_response,
    unbalance_response,
)
from coupling.turning import Turning

__all__ = [
    "LONGEST_COMMON_PERIOD",
    "SAMPLES_PER_BLOCK",
    "AnyTorque",
    "AxialForces",
    "BaseHarmonic",
    "BaseHistory",
    "BaseMotion",
    "BasisError",
    "BearingLaw",
    "Block",
    "BowReactions",
    "Checkpoint",
    "Component",
    "ContactConnector",
    "ContactState",
    "CoupledMachine",
    "CoupledModes",
    "CoupledSystem",
    "CouplingError",
    "Decimation",
    "Drive",
    "Driving",
    "EnergyBalance",
    "ExcitationGroup",
    "ExcitationLine",
    "FrequencyResponse",
    "GapLaw",
    "GearMesh",
    "GroupMotion",
    "GrowingMode",
    "HarmonicLoad",
    "Histories",
    "HousingComponent",
    "LinearConnector",
    "Machine",
    "ModalRecord",
    "ModalRows",
    "ModeShares",
    "ModesCertificate",
    "ModesError",
    "Motion",
    "MountedBearing",
    "MountedGear",
    "NonlinearConnector",
    "Output",
    "Part",
    "Peak",
    "PeriodicError",
    "PeriodicResponse",
    "Recorded",
    "ResponseCurve",
    "RollingLaw",
    "RotorComponent",
    "Shaft",
    "ShaftDashpots",
    "ShaftGear",
    "SignalParts",
    "Sliding",
    "Spectrum",
    "SpeedTable",
    "Stability",
    "SuperposedResponse",
    "SystemCampbell",
    "SystemCrossing",
    "ThrustPair",
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
    "averaged_spectrum",
    "axial_forces",
    "common_cycles",
    "contact_at",
    "couple",
    "coupled_modes",
    "decimation",
    "excitation_groups",
    "excitation_lines",
    "free_speed",
    "histories",
    "housing_component",
    "linear_matrices",
    "lines_at",
    "march_blocks",
    "march_key",
    "march_method",
    "mean_contact",
    "mesh_error_response",
    "modal_record",
    "modal_rows",
    "nothing_recorded",
    "periodic_response",
    "receptance",
    "require_thrust_carried",
    "resonance_grid",
    "response_curve",
    "rotor_component",
    "sample_times",
    "sensor_force_response",
    "signal_parts",
    "simulate",
    "spectrum_peaks",
    "stability",
    "static_equilibrium",
    "superposed_response",
    "system_campbell",
    "time_of_phase",
    "transient_figures",
    "transient_outputs",
    "unbalance_response",
    "unloaded_contact",
    "with_modal_rows",
]
