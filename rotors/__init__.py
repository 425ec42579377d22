"""Rotors: shafts, discs and bearings; their bending, torsion and whirl by exact transfer matrices.

A shaft is described by what can be measured on it::

    steel = ShaftMaterial(youngs_modulus=211e9, shear_modulus=81.2e9, density=7810.0)
    shaft = Rotor("shaft", [Segment(0.5, 0.05, 0.0, steel)] * 3,
                  [Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, 7810.0)])
    bearings = [Bearing.isotropic("left", 0.0, 1e6), Bearing.isotropic("right", 1.5, 1e6)]

and answered for by frozen results, each with the certificate that no mode is missing::

    solve_lateral_modes(shaft, [b.mean_support for b in bearings], frequency_limit=5e3)
    solve_torsional_modes(shaft, count=5)
    solve_axial_modes(shaft, [AxisSpring(0.0, 1e8)], count=5)
    buckling_factor(shaft, [b.mean_support for b in bearings])
    rest_frequencies(shaft, bearings, count=8)
    solve_whirl(shaft, bearings, speed=418.9, count=8)
    critical_speeds(shaft, bearings, speed_limit=1e3)
    campbell(shaft, bearings, speeds=np.linspace(0.0, 600.0, 100)).crossings()
    unbalance_response(shaft, bearings, [Unbalance(at=0.5, moment=1e-4)], speeds)
    static_deflection(shaft, bearings).bearing_loads

Segments may be cones, carry an axial force, and stand between flexible couplings; `rotors.rolling` makes bearings from
the geometry of rolling ones. The compiled parts load when a first question is asked. Lengths are m, frequencies and
speeds rad/s. The frame is right-handed with z along the shaft; slopes and the gyroscopic sign are those of
`rotors.whirl`.
"""

from .attachment import add_attachment_modes, add_rod_attachment_modes
from .axial import AxialModes, solve_axial_modes
from .axis_spring import AxisSpring
from .bearing import Bearing, Pedestal, RadialSupport
from .buckling import buckling_factor
from .campbell import Campbell, Crossing, campbell
from .certificate import ModeCertificate
from .critical import CriticalSpeeds, critical_speeds
from .critical_map import CriticalSpeedMap, critical_speed_map
from .errors import EquilibriumError, IncompleteModesError, RotorError
from .harmonic import HarmonicResponse, Orbit, frequency_response, harmonic_response, orbit_of
from .lateral import LateralModes, solve_lateral_modes
from .loads import Bow, HarmonicForce, Unbalance
from .material import ShaftMaterial, shear_coefficient
from .modal import ModalRotor, modal_rotor
from .participation import Participation, participation
from .planes import RestFrequencies, rest_frequencies
from .projection import whirl_basis
from .ross_files import RossModel, read_ross, write_ross
from .section import Section
from .segment import Segment
from .shaft import Disc, Rotor
from .shaft_coupling import Coupling
from .spatial_field import ShaftMotion
from .statics import StaticDeflection, StaticForce, static_deflection
from .torsion import TorsionalModes, solve_torsional_chain, solve_torsional_modes
from .torsional_response import Torque, TorsionalDashpot, TorsionalResponse, torsional_response
from .unbalance import BowShape, SynchronousResponse, bow_shape, unbalance_response
from .whirl import MOSTLY_AXIAL, WhirlModes, WhirlSolver, solve_whirl
from .whirl_energy import StrainShares

__all__ = [
    "MOSTLY_AXIAL",
    "AxialModes",
    "AxisSpring",
    "Bearing",
    "Bow",
    "BowShape",
    "Campbell",
    "Coupling",
    "CriticalSpeedMap",
    "CriticalSpeeds",
    "Crossing",
    "Disc",
    "EquilibriumError",
    "HarmonicForce",
    "HarmonicResponse",
    "IncompleteModesError",
    "LateralModes",
    "ModalRotor",
    "ModeCertificate",
    "Orbit",
    "Participation",
    "Pedestal",
    "RadialSupport",
    "RestFrequencies",
    "RossModel",
    "Rotor",
    "RotorError",
    "Section",
    "Segment",
    "ShaftMaterial",
    "ShaftMotion",
    "StaticDeflection",
    "StaticForce",
    "StrainShares",
    "SynchronousResponse",
    "Torque",
    "TorsionalDashpot",
    "TorsionalModes",
    "TorsionalResponse",
    "Unbalance",
    "WhirlModes",
    "WhirlSolver",
    "add_attachment_modes",
    "add_rod_attachment_modes",
    "bow_shape",
    "buckling_factor",
    "campbell",
    "critical_speed_map",
    "critical_speeds",
    "frequency_response",
    "harmonic_response",
    "modal_rotor",
    "orbit_of",
    "participation",
    "read_ross",
    "rest_frequencies",
    "shear_coefficient",
    "solve_axial_modes",
    "solve_lateral_modes",
    "solve_torsional_chain",
    "solve_torsional_modes",
    "solve_whirl",
    "static_deflection",
    "torsional_response",
    "unbalance_response",
    "whirl_basis",
    "write_ross",
]
