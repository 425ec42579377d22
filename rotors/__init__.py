"""Rotors: lateral, torsional and axial modes, whirl and responses of shafts by exact transfer matrices.

A :class:`Rotor` is a row of shaft segments (:class:`Segment`, :class:`Coupling`) with discs (:class:`Disc`) on it. It
turns in bearings (:class:`Bearing`)::

    import numpy as np

    steel = ShaftMaterial(youngs_modulus=211e9, shear_modulus=81.2e9, density=7810.0)
    shaft = Rotor("shaft", [Segment(0.5, 0.05, 0.0, steel)] * 3,
                  [Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, 7810.0)])
    bearings = [Bearing.isotropic("left", 0.0, 1e6), Bearing.isotropic("right", 1.5, 1e6)]

Each analysis returns a frozen result with the certificate that no mode is missing::

    solve_lateral_modes(shaft, [b.mean_support for b in bearings], frequency_limit=5e3)
    solve_torsional_modes(shaft, count=5)
    solve_axial_modes(shaft, [AxisSpring(0.0, 1e8)], count=5)
    rest_frequencies(shaft, bearings, count=8)
    solve_whirl(shaft, bearings, speed=418.9, count=8)
    critical_speeds(shaft, bearings, speed_limit=1e3)
    speeds = np.linspace(0.0, 600.0, 100)
    campbell(shaft, bearings, speeds).crossings()
    unbalance_response(shaft, bearings, [Unbalance(at=0.5, moment=1e-4)], speeds)
    static_deflection(shaft, bearings).bearing_loads

Sub-packages, each of which imports only those before it: ``gearwhine.rotors.model``
(description), ``gearwhine.rotors.transfer_matrix`` (Timoshenko elements, Wittrick-Williams count),
``gearwhine.rotors.rolling_bearings``, ``gearwhine.rotors.ross`` (file exchange), ``gearwhine.rotors.modes`` (undamped
modes, modal rotor), ``gearwhine.rotors.whirl`` (damped gyroscopic whirl), ``gearwhine.rotors.analyses``.

The compiled kernels load with the first analysis. Lengths are in m, frequencies and speeds in rad/s. The frame is
right-handed with z along the shaft.
"""

from gearwhine.rotors.analyses.campbell import Campbell as Campbell
from gearwhine.rotors.analyses.campbell import campbell as campbell
from gearwhine.rotors.analyses.critical_speeds import critical_speeds as critical_speeds
from gearwhine.rotors.analyses.rest_frequencies import rest_frequencies as rest_frequencies
from gearwhine.rotors.analyses.statics import static_deflection as static_deflection
from gearwhine.rotors.analyses.torsional_response import torsional_response as torsional_response
from gearwhine.rotors.analyses.unbalance import unbalance_response as unbalance_response
from gearwhine.rotors.errors import EquilibriumError as EquilibriumError
from gearwhine.rotors.errors import IncompleteModesError as IncompleteModesError
from gearwhine.rotors.errors import RotorError as RotorError
from gearwhine.rotors.model.bearing import AxisSpring as AxisSpring
from gearwhine.rotors.model.bearing import Bearing as Bearing
from gearwhine.rotors.model.bearing import Pedestal as Pedestal
from gearwhine.rotors.model.bearing import RadialSupport as RadialSupport
from gearwhine.rotors.model.loads import Unbalance as Unbalance
from gearwhine.rotors.model.material import ElasticMaterial as ElasticMaterial
from gearwhine.rotors.model.material import ShaftMaterial as ShaftMaterial
from gearwhine.rotors.model.segment import Coupling as Coupling
from gearwhine.rotors.model.segment import Segment as Segment
from gearwhine.rotors.model.shaft import Disc as Disc
from gearwhine.rotors.model.shaft import Rotor as Rotor
from gearwhine.rotors.modes.lateral import solve_lateral_modes as solve_lateral_modes
from gearwhine.rotors.modes.modal_rotor import ModalRotor as ModalRotor
from gearwhine.rotors.modes.modal_rotor import modal_rotor as modal_rotor
from gearwhine.rotors.modes.torsional_and_axial import solve_axial_modes as solve_axial_modes
from gearwhine.rotors.modes.torsional_and_axial import solve_torsional_modes as solve_torsional_modes
from gearwhine.rotors.ross.reading import read_ross as read_ross
from gearwhine.rotors.ross.writing import write_ross as write_ross
from gearwhine.rotors.whirl.whirl_modes import WhirlModes as WhirlModes
from gearwhine.rotors.whirl.whirl_modes import WhirlSolver as WhirlSolver
from gearwhine.rotors.whirl.whirl_modes import solve_whirl as solve_whirl
