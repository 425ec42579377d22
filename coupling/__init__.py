"""Coupled machine by component mode synthesis: housing, rotors and gears in one modal system, and its motion.

- :class:`Machine` lists :class:`Shaft`, :class:`ShaftGear`, ``coupling.gears.GearPair``, :class:`MountedBearing` and a
  housing; it derives speeds, torques, axes and mesh phases and refuses a machine that cannot exist.
- :func:`assemble_machine` makes the :class:`CoupledMachine` and its :class:`CoupledSystem`: components in
  mass-normalised modal coordinates, joined by connectors.
- :func:`static_equilibrium` finds the static equilibrium under the mean load.
- :func:`coupled_modes` finds the complex natural modes, :func:`stability` which of them grow,
  :func:`system_campbell` their course over speed, and :func:`receptance` the frequency response.
- :func:`simulate` integrates a transient by Newmark's method or by exact exponential steps.
- :func:`periodic_response` finds the steady state by shooting, :func:`response_curve` its branch over speed.
- :func:`amplitude_spectrum` evaluates signals.

Sub-packages and modules, each of which imports only those before it:

- ``coupling.gears``: geometry, choice of the tooth model, tooth stiffness, tooth contact force, loaded transmission
  error.
- ``coupling.machine``: parts, gear train, components (projection onto modes), connectors (5x5 bearing stiffness),
  loads, speed profile, equations of motion.
- ``coupling.connector_forces``: forces of tooth contacts, rolling bearings and gaps, compiled.
- ``coupling.statics``: static equilibrium, operating point, mean mesh stiffness; below the assembly, which takes loaded
  flanks and mean mesh forces from it.
- ``coupling.assembly``: assembly of the coupled machine.
- ``coupling.linear``: complex modes, stability, Campbell diagram, frequency response, excitation orders.
- ``coupling.signals``: spectra, order tracking, sidebands, names of spectral lines, transfer paths.
- ``coupling.collocation``: elements of the exponential collocation.
- ``coupling.time``: Newmark's method, exponential collocation, energy balance, time histories.
- ``coupling.periodic``: shooting, Floquet multipliers, continuation over speed.
- ``coupling.machine_description``: the description of a machine, and its analyses.

numba is imported when a motion or an equilibrium is computed, not before.
"""

from coupling.assembly import CoupledMachine as CoupledMachine
from coupling.assembly import assemble_machine as assemble_machine
from coupling.errors import CouplingError as CouplingError
from coupling.errors import ModesError as ModesError
from coupling.errors import PeriodicError as PeriodicError
from coupling.errors import TransientError as TransientError
from coupling.linear.campbell import system_campbell as system_campbell
from coupling.linear.complex_modes import coupled_modes as coupled_modes
from coupling.linear.complex_modes import stability as stability
from coupling.linear.frequency_response import receptance as receptance
from coupling.machine.base_motion import BaseMotion as BaseMotion
from coupling.machine.bearing_laws import GapLaw as GapLaw
from coupling.machine.bearing_laws import RollingLaw as RollingLaw
from coupling.machine.coupled_system import CoupledSystem as CoupledSystem
from coupling.machine.gear_train import Output as Output
from coupling.machine.loads import MachineLoads as MachineLoads
from coupling.machine.loads import ShaftForce as ShaftForce
from coupling.machine.loads import Torque as Torque
from coupling.machine.loads import Unbalance as Unbalance
from coupling.machine.mounted_parts import GearMesh as GearMesh
from coupling.machine.mounted_parts import MountedBearing as MountedBearing
from coupling.machine.mounted_parts import MountedGear as MountedGear
from coupling.machine.parts import Shaft as Shaft
from coupling.machine.parts import ShaftGear as ShaftGear
from coupling.machine.speed_profile import SpeedProfile as SpeedProfile
from coupling.machine_description import Machine as Machine
from coupling.periodic.continuation import response_curve as response_curve
from coupling.periodic.shooting import periodic_response as periodic_response
from coupling.signals.spectrum import amplitude_spectrum as amplitude_spectrum
from coupling.statics.static_equilibrium import static_equilibrium as static_equilibrium
from coupling.time.settings import TransientOutputs as TransientOutputs
from coupling.time.settings import TransientSettings as TransientSettings
from coupling.time.transient import simulate as simulate
