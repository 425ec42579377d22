"""Coupled dynamics: a geared machine of housing modes, rotor modes, bearings and gears, and its motion.

- :class:`Machine` -- shafts, gears, gear pairs, bearings and a housing; it derives speeds, torques and mesh geometry,
  and refuses parts that cannot form a machine. :func:`assemble_machine` assembles a :class:`CoupledMachine` of components.
- :func:`static_equilibrium` -- rest position under the mean load, at which the mean mesh stiffness is taken.
- :func:`coupled_modes`, :func:`stability`, :func:`system_campbell`, :func:`receptance` -- linear dynamics about it.
- :func:`simulate` -- transient by Newmark's method or exponential collocation.
- :func:`periodic_response`, :func:`response_curve` -- steady state by shooting, and its continuation over speed.
- :func:`amplitude_spectrum` and :mod:`coupling.signature` -- spectra, orders, sidebands, transfer paths.
- :mod:`coupling.gears` -- tooth geometry, mesh stiffness and the contact law.

numba is imported only when :func:`simulate`, :func:`static_equilibrium` or :mod:`coupling.periodic` runs.
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
from coupling.description import Machine
from coupling.errors import CouplingError, ModesError, PeriodicError, TransientError
from coupling.exact_march import integration_method
from coupling.excitation import ExcitationLine, excitation_lines
from coupling.free_speed import free_speed
from coupling.gear_train import Output
from coupling.histories import Histories, empty_record, histories, transient_outputs
from coupling.loads import AnyTorque, BowReactions, Drive, Torque, TorqueHistory, TorqueRipple, TorqueSlope, Unbalance
from coupling.machine import CoupledMachine, assemble_machine
from coupling.march_run import Checkpoint, sample_times
from coupling.marching import Block, integrate_blocks, integration_key
from coupling.modal_motion import ModalRecord, ModalRows, modal_record, modal_rows, with_modal_rows
from coupling.modes import CoupledModes, ModesCertificate, coupled_modes
from coupling.motion import Motion
from coupling.mounted import GearMesh, MountedBearing, MountedGear
from coupling.parts import Driving, Shaft, ShaftGear
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
from coupling.settings import MotionRecord, TransientOutputs, TransientSettings
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
from coupling.turning import SpeedProfile

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
    "MotionRecord",
    "MountedBearing",
    "MountedGear",
    "NonlinearConnector",
    "Output",
    "Part",
    "Peak",
    "PeriodicError",
    "PeriodicResponse",
    "ResponseCurve",
    "RollingLaw",
    "RotorComponent",
    "Shaft",
    "ShaftDashpots",
    "ShaftGear",
    "SignalParts",
    "Sliding",
    "Spectrum",
    "SpeedProfile",
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
    "Unbalance",
    "Window",
    "amplitude_spectrum",
    "assemble_machine",
    "averaged_spectrum",
    "axial_forces",
    "common_cycles",
    "contact_at",
    "coupled_modes",
    "decimation",
    "empty_record",
    "excitation_groups",
    "excitation_lines",
    "free_speed",
    "histories",
    "housing_component",
    "integrate_blocks",
    "integration_key",
    "integration_method",
    "linear_matrices",
    "lines_at",
    "mean_contact",
    "mesh_error_response",
    "modal_record",
    "modal_rows",
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
