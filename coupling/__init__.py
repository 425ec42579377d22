"""Coupled machine by component mode synthesis: housing, rotors and gears in one modal system, and its motion.

- :class:`Machine` lists :class:`Shaft`, :class:`ShaftGear`, ``gearwhine.coupling.gears.GearPair``,
  :class:`MountedBearing` and a housing; it derives speeds, torques, axes and mesh phases and refuses a machine that
  cannot exist.
- :func:`assemble_machine` makes the :class:`CoupledMachine` and its :class:`CoupledSystem`: components in
  mass-normalised modal coordinates, joined by connectors.
- :func:`static_equilibrium` finds the static equilibrium under the mean load.
- :func:`coupled_modes` finds the complex natural modes, :func:`stability` which of them grow,
  :func:`system_campbell` their course over speed, and :func:`receptance` the frequency response.
- :func:`simulate` integrates a transient by Newmark's method or by exact exponential steps.
- :func:`periodic_response` finds the steady state by shooting, :func:`response_curve` its branch over speed;
  :func:`settled_response` that of a machine whose carriers turn.
- :func:`amplitude_spectrum` evaluates signals.

Sub-packages and modules, each of which imports only those before it:

- ``gearwhine.coupling.gears``: geometry, choice of the tooth model, tooth stiffness, tooth contact force, loaded
  transmission error.
- ``gearwhine.coupling.machine``: parts, gear train, components (projection onto modes), connectors (5x5 bearing
  stiffness), loads, speed profile, equations of motion.
- ``gearwhine.coupling.connector_forces``: forces of tooth contacts, rolling bearings and gaps, compiled.
- ``gearwhine.coupling.statics``: static equilibrium, operating point, mean mesh stiffness; below the assembly, which
  takes loaded flanks and mean mesh forces from it.
- ``gearwhine.coupling.assembly``: assembly of the coupled machine.
- ``gearwhine.coupling.linear``: complex modes, stability, Campbell diagram, frequency response, excitation orders.
- ``gearwhine.coupling.signals``: spectra, order tracking, sidebands, names of spectral lines, transfer paths.
- ``gearwhine.coupling.collocation``: elements of the exponential collocation.
- ``gearwhine.coupling.time``: Newmark's method, exponential collocation, energy balance, time histories.
- ``gearwhine.coupling.periodic``: shooting, Floquet multipliers, continuation over speed.
- ``gearwhine.coupling.machine_description``: the description of a machine.
- ``gearwhine.coupling.analyses``: what commands and studies ask of a machine, with all that belongs to the answer.
- ``gearwhine.coupling.sound``: sound that the housing radiates: of its modes, and of the lines of the machine's motion.
- ``gearwhine.coupling.sweep``: what a sweep keeps of each motion, peaks between its points, and the sound of its lines.
- ``gearwhine.coupling.load_analysis``: the machine at rest under load, and influences of its parts on gears and lines.

numba is imported when a motion or an equilibrium is computed, not before.
"""

from gearwhine.coupling.assembly import CoupledMachine as CoupledMachine
from gearwhine.coupling.assembly import assemble_machine as assemble_machine
from gearwhine.coupling.description.gear_train import GivenSpeed as GivenSpeed
from gearwhine.coupling.description.gear_train import Output as Output
from gearwhine.coupling.description.parts import Shaft as Shaft
from gearwhine.coupling.description.parts import ShaftGear as ShaftGear
from gearwhine.coupling.description.parts import SupportBolt as SupportBolt
from gearwhine.coupling.description.parts import TorqueSupport as TorqueSupport
from gearwhine.coupling.description.planet_copies import planet_copies as planet_copies
from gearwhine.coupling.description.planetary import PlanetarySet as PlanetarySet
from gearwhine.coupling.errors import CouplingError as CouplingError
from gearwhine.coupling.errors import ModesError as ModesError
from gearwhine.coupling.errors import PeriodicError as PeriodicError
from gearwhine.coupling.errors import TransientError as TransientError
from gearwhine.coupling.linear.campbell import system_campbell as system_campbell
from gearwhine.coupling.linear.complex_modes import coupled_modes as coupled_modes
from gearwhine.coupling.linear.complex_modes import stability as stability
from gearwhine.coupling.linear.frequency_response import receptance as receptance
from gearwhine.coupling.machine.base_motion import BaseMotion as BaseMotion
from gearwhine.coupling.machine.bearing_laws import GapLaw as GapLaw
from gearwhine.coupling.machine.bearing_laws import RollingLaw as RollingLaw
from gearwhine.coupling.machine.coupled_system import CoupledSystem as CoupledSystem
from gearwhine.coupling.machine.loads import MachineLoads as MachineLoads
from gearwhine.coupling.machine.loads import Ripple as Ripple
from gearwhine.coupling.machine.loads import ShaftForce as ShaftForce
from gearwhine.coupling.machine.loads import Torque as Torque
from gearwhine.coupling.machine.loads import TorqueOverTime as TorqueOverTime
from gearwhine.coupling.machine.loads import Unbalance as Unbalance
from gearwhine.coupling.machine.mounted_parts import GearMesh as GearMesh
from gearwhine.coupling.machine.mounted_parts import MountedBearing as MountedBearing
from gearwhine.coupling.machine.mounted_parts import MountedGear as MountedGear
from gearwhine.coupling.machine.pins import PinBeam as PinBeam
from gearwhine.coupling.machine.pins import PinSprings as PinSprings
from gearwhine.coupling.machine.speed_profile import FreeRun as FreeRun
from gearwhine.coupling.machine.speed_profile import SpeedProfile as SpeedProfile
from gearwhine.coupling.machine.speed_profile import SpeedRun as SpeedRun
from gearwhine.coupling.machine.speed_profile import TorqueLine as TorqueLine
from gearwhine.coupling.machine_description import Machine as Machine
from gearwhine.coupling.periodic.continuation import response_curve as response_curve
from gearwhine.coupling.periodic.settling import SettledMotion as SettledMotion
from gearwhine.coupling.periodic.settling import settled_response as settled_response
from gearwhine.coupling.periodic.shooting import periodic_response as periodic_response
from gearwhine.coupling.signals.spectrum import amplitude_spectrum as amplitude_spectrum
from gearwhine.coupling.statics.static_equilibrium import static_equilibrium as static_equilibrium
from gearwhine.coupling.time.settings import TransientOutputs as TransientOutputs
from gearwhine.coupling.time.settings import TransientSettings as TransientSettings
from gearwhine.coupling.time.transient import simulate as simulate
