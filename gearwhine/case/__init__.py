"""Case file: TOML with units, read into one checked, frozen object in SI.

What the room offers:

- :func:`load_case` -- a file or a bundled case, with changes from the command line; :func:`parse_case` for a
  dictionary. Everything wrong comes in one :class:`CaseError`, a :class:`Problem` each.
- :class:`Case` -- the tables of the file as frozen models, attributes named as the keys: :class:`Material`,
  :class:`Housing` (:class:`Box`, :class:`CadFile`, :class:`MeshFile`, :class:`Seat`, :class:`Support`,
  :class:`Mount`, :class:`Joint`, :class:`LumpedMass`, :class:`Sensor`), :class:`Rotor`, :class:`Bearing`,
  :class:`Gear`, :class:`GearPair`, :class:`Operation`, :class:`Transient`, :class:`Sweep`, :class:`RotorAnalysis`,
  :class:`Measured`, :class:`Update`.
- :func:`dump_case` -- the resolved case as TOML that loads back equal.
- :func:`rotor_speeds`, :func:`mesh_frequencies`, :func:`applied_torques`, :func:`pair_torques` -- what follows
  without solving anything.
- :func:`whirl_speeds`, :func:`campbell_speeds`, :func:`response_speeds` -- at which speeds a rotor is looked at.
- :func:`swept_keys` -- the keys that a sweep goes through, each a :class:`SweptKey` with its values.
- :func:`require` -- the error for what a command needs and a case lacks.
- :func:`bundled_cases` -- the examples that ship with the package.

Inside, lengths are in m, masses in kg, forces in N, angles in rad, speeds in rad/s; frequencies are in Hz.
"""

from gearwhine.case.analysed_speeds import campbell_speeds, response_speeds, table_range, whirl_speeds
from gearwhine.case.analysis import (
    Probe,
    RotorAnalysis,
    StiffnessMap,
    TorsionalAnalysis,
    TorsionProbe,
    UnbalanceResponse,
)
from gearwhine.case.attachments import (
    AxialDashpots,
    AxialSprings,
    Bushing,
    InertiaTensor,
    Joint,
    LumpedMass,
    Mount,
    SixDashpots,
    SixSprings,
    amounts,
)
from gearwhine.case.base_motion import Base, BaseHarmonic, BaseHistory
from gearwhine.case.box import Box, Feet, Walls
from gearwhine.case.bundled import bundled_case, bundled_cases
from gearwhine.case.dump import case_document, dump_case
from gearwhine.case.flanks import Fault, GearErrors, HelixErrors, ProfileErrors, Relief
from gearwhine.case.gears import Gear, GearPair, ToothStiffness
from gearwhine.case.housing import (
    Boss,
    CadFile,
    Dashpots,
    Housing,
    Material,
    MeshFile,
    Seat,
    Sensor,
    Springs,
    Support,
)
from gearwhine.case.load import LoadedCase, load_case, parse_case
from gearwhine.case.measured import Align, Landmark, Measured
from gearwhine.case.model import Case
from gearwhine.case.motion import (
    AppliedTorque,
    applied_torques,
    gears_on,
    mesh_frequencies,
    pair_torques,
    rotor_speeds,
    speed_ratios,
)
from gearwhine.case.patches import Patch
from gearwhine.case.problems import CaseError, Problem, did_you_mean
from gearwhine.case.require import require
from gearwhine.case.rolling import BearingLoad, Catalogue, RollingCatalogue, RollingGeometry
from gearwhine.case.rotors import (
    Bow,
    Coupling,
    CouplingSegment,
    Disc,
    Rotor,
    RoundDisc,
    Segment,
    Unbalance,
)
from gearwhine.case.running import Operation, Output, SpeedRange, Sweep, Transient
from gearwhine.case.shafts import (
    Bearing,
    MatrixDamping,
    MatrixStiffness,
    Pedestal,
    RadialDamping,
    RadialStiffness,
    RollingStiffness,
    StopStiffness,
)
from gearwhine.case.swept_keys import SPEED_KEY, SweptKey, swept_keys
from gearwhine.case.torques import Run, TorqueHistory, TorqueLine, TorqueRipple
from gearwhine.case.train import shaft_of
from gearwhine.case.updating import ModelModes, Update, UpdateParameter

__all__ = [
    "SPEED_KEY",
    "Align",
    "AppliedTorque",
    "AxialDashpots",
    "AxialSprings",
    "Base",
    "BaseHarmonic",
    "BaseHistory",
    "Bearing",
    "BearingLoad",
    "Boss",
    "Bow",
    "Box",
    "Bushing",
    "CadFile",
    "Case",
    "CaseError",
    "Catalogue",
    "Coupling",
    "CouplingSegment",
    "Dashpots",
    "Disc",
    "Fault",
    "Feet",
    "Gear",
    "GearErrors",
    "GearPair",
    "HelixErrors",
    "Housing",
    "InertiaTensor",
    "Joint",
    "Landmark",
    "LoadedCase",
    "LumpedMass",
    "Material",
    "MatrixDamping",
    "MatrixStiffness",
    "Measured",
    "MeshFile",
    "ModelModes",
    "Mount",
    "Operation",
    "Output",
    "Patch",
    "Pedestal",
    "Probe",
    "Problem",
    "ProfileErrors",
    "RadialDamping",
    "RadialStiffness",
    "Relief",
    "RollingCatalogue",
    "RollingGeometry",
    "RollingStiffness",
    "Rotor",
    "RotorAnalysis",
    "RoundDisc",
    "Run",
    "Seat",
    "Segment",
    "Sensor",
    "SixDashpots",
    "SixSprings",
    "SpeedRange",
    "Springs",
    "StiffnessMap",
    "StopStiffness",
    "Support",
    "Sweep",
    "SweptKey",
    "ToothStiffness",
    "TorqueHistory",
    "TorqueLine",
    "TorqueRipple",
    "TorsionProbe",
    "TorsionalAnalysis",
    "Transient",
    "Unbalance",
    "UnbalanceResponse",
    "Update",
    "UpdateParameter",
    "Walls",
    "amounts",
    "applied_torques",
    "bundled_case",
    "bundled_cases",
    "campbell_speeds",
    "case_document",
    "did_you_mean",
    "dump_case",
    "gears_on",
    "load_case",
    "mesh_frequencies",
    "pair_torques",
    "parse_case",
    "require",
    "response_speeds",
    "rotor_speeds",
    "shaft_of",
    "speed_ratios",
    "swept_keys",
    "table_range",
    "whirl_speeds",
]
