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

Segments may be cones, carry an axial force, and stand between flexible couplings. The compiled parts load when a
first question is asked. Lengths are m, frequencies and speeds rad/s. The frame is right-handed with z along the
shaft; slopes and the gyroscopic sign are those of `rotors.whirl`.
"""

from .attachment import attach_loads
from .axial import AxialModes, solve_axial_modes
from .axis_spring import AxisSpring
from .bearing import Bearing, Pedestal, RadialSupport
from .buckling import buckling_factor
from .certificate import ModeCertificate
from .errors import IncompleteModesError, RotorError
from .lateral import LateralModes, solve_lateral_modes
from .material import ShaftMaterial, shear_coefficient
from .planes import CriticalSpeeds, RestFrequencies, critical_speeds, rest_frequencies
from .section import Section
from .segment import Segment
from .shaft import Disc, Rotor
from .shaft_coupling import Coupling
from .torsion import TorsionalModes, solve_torsional_chain, solve_torsional_modes
from .whirl import WhirlModes, solve_whirl, whirl_basis

__all__ = [
    "AxialModes",
    "AxisSpring",
    "Bearing",
    "Coupling",
    "CriticalSpeeds",
    "Disc",
    "IncompleteModesError",
    "LateralModes",
    "ModeCertificate",
    "Pedestal",
    "RadialSupport",
    "RestFrequencies",
    "Rotor",
    "RotorError",
    "Section",
    "Segment",
    "ShaftMaterial",
    "TorsionalModes",
    "WhirlModes",
    "attach_loads",
    "buckling_factor",
    "critical_speeds",
    "rest_frequencies",
    "shear_coefficient",
    "solve_axial_modes",
    "solve_lateral_modes",
    "solve_torsional_chain",
    "solve_torsional_modes",
    "solve_whirl",
    "whirl_basis",
]
