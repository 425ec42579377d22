"""Case file: TOML with units, read into one checked, frozen object in SI.

Public names:

- :func:`load_case` -- a file or a bundled case, with changes from the command line; :func:`parse_case` for a
  dictionary, and :class:`CaseSource` for later changes. Everything wrong comes in one :class:`CaseError`, a
  :class:`Problem` each.
- :class:`Case` -- the tables of the file as frozen models, attributes named as the keys: :class:`Material`,
  :class:`Housing` (:class:`Box`, :class:`CadFile`, :class:`MeshFile`, :class:`Seat`, :class:`Support`,
  :class:`Mount`, :class:`Joint`, :class:`LumpedMass`, :class:`Sensor`), :class:`Rotor`, :class:`Bearing`,
  :class:`Gear`, :class:`GearPair`, :class:`Operation`, :class:`Transient`, :class:`Sweep`, :class:`RotorAnalysis`,
  :class:`Measured`, :class:`Update`. The tables within these stand in the modules of their topics.
- :func:`dump_case` -- the resolved case as TOML that loads back equal.
- :attr:`Case.parts` -- the library's objects of the tables, and what follows from them without a solution: gear train,
  speeds, torques.
- :func:`rotor_speeds` -- speeds at which a rotor is analysed.
- :func:`swept_keys` -- the keys of a sweep, each a :class:`SweptKey` with its values.
- :func:`require` -- the error for tables that a command needs and a case lacks.
- :func:`bundled_cases` -- the examples that ship with the package.

Inside, lengths are in m, masses in kg, forces in N, angles in rad, speeds in rad/s; frequencies are in Hz.
"""

from gearwhine.case.analysis_speeds import rotor_speeds
from gearwhine.case.bearings import Bearing, MatrixDamping, RollingStiffness, StopStiffness
from gearwhine.case.box import Box
from gearwhine.case.errors import CaseError, Problem
from gearwhine.case.fixtures import Joint, LumpedMass, Mount, amounts
from gearwhine.case.gears import Gear, GearPair, shaft_of
from gearwhine.case.housing import CadFile, Housing, Material, MeshFile, Seat, Sensor, Support
from gearwhine.case.load import (
    CaseSource,
    LoadedCase,
    bundled_case,
    bundled_cases,
    bundled_files,
    load_case,
    parse_case,
)
from gearwhine.case.measured import Measured, Update, UpdateParameter
from gearwhine.case.model import Case, case_document, dump_case, require
from gearwhine.case.operation import Operation, OrderTracking, Sweep, TorqueLine, Transient
from gearwhine.case.rotors import CouplingSegment, Probe, Rotor, RotorAnalysis, Segment, TorsionalAnalysis, TorsionProbe
from gearwhine.case.swept_keys import SPEED_KEY, SweptKey, swept_keys

__all__ = [
    "SPEED_KEY",
    "Bearing",
    "Box",
    "CadFile",
    "Case",
    "CaseError",
    "CaseSource",
    "CouplingSegment",
    "Gear",
    "GearPair",
    "Housing",
    "Joint",
    "LoadedCase",
    "LumpedMass",
    "Material",
    "MatrixDamping",
    "Measured",
    "MeshFile",
    "Mount",
    "Operation",
    "OrderTracking",
    "Probe",
    "Problem",
    "RollingStiffness",
    "Rotor",
    "RotorAnalysis",
    "Seat",
    "Segment",
    "Sensor",
    "StopStiffness",
    "Support",
    "Sweep",
    "SweptKey",
    "TorqueLine",
    "TorsionProbe",
    "TorsionalAnalysis",
    "Transient",
    "Update",
    "UpdateParameter",
    "amounts",
    "bundled_case",
    "bundled_cases",
    "bundled_files",
    "case_document",
    "dump_case",
    "load_case",
    "parse_case",
    "require",
    "rotor_speeds",
    "shaft_of",
    "swept_keys",
]
