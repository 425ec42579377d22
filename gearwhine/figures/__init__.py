"""Figures by matplotlib, without a display: arrays and results in, a `Figure` or a file out.

``draw_transient``, ``draw_run``, ``draw_gear_pairs``, ``draw_system``, ``draw_steady``, ``draw_sweep``,
``draw_rotors`` and ``draw_comparison_figures`` yield the figures of an analysis with their names, which
:func:`save_all` writes. The others, and more in the modules of each topic, return a figure for print, 160 mm wide,
that :func:`save` writes::

    assembly = RotorAssembly(rotor, bearings)
    save(draw_shaft(assembly), Path("shaft.png"))
    save(draw_lateral_modes(assembly, solve_lateral_modes(rotor, supports)), Path("modes.png"))
"""

from gearwhine.figures.gears import draw_gear_pairs
from gearwhine.figures.housing import (
    ShapePair,
    draw_comparison,
    draw_comparison_figures,
    draw_coordinate_criteria,
    draw_mac_matrix,
    draw_measured_shapes,
)
from gearwhine.figures.machine.condition import draw_envelopes
from gearwhine.figures.machine.operating_point import draw_load
from gearwhine.figures.machine.run_up import draw_run
from gearwhine.figures.machine.sound import draw_sound
from gearwhine.figures.machine.steady_state import draw_steady
from gearwhine.figures.machine.sweep import draw_sweep
from gearwhine.figures.machine.system import draw_system
from gearwhine.figures.machine.transient import draw_transient
from gearwhine.figures.rotors import draw_rotors
from gearwhine.figures.rotors.assembly import RotorAssembly
from gearwhine.figures.rotors.campbell import draw_campbell
from gearwhine.figures.rotors.critical_speed_map import draw_critical_map
from gearwhine.figures.rotors.mode_shapes import draw_lateral_modes
from gearwhine.figures.rotors.responses import ProbeResponse, draw_unbalance_response
from gearwhine.figures.rotors.shaft import draw_shaft
from gearwhine.figures.style import save, save_all

__all__ = [
    "ProbeResponse",
    "RotorAssembly",
    "ShapePair",
    "draw_campbell",
    "draw_comparison",
    "draw_comparison_figures",
    "draw_coordinate_criteria",
    "draw_critical_map",
    "draw_envelopes",
    "draw_gear_pairs",
    "draw_lateral_modes",
    "draw_load",
    "draw_mac_matrix",
    "draw_measured_shapes",
    "draw_rotors",
    "draw_run",
    "draw_shaft",
    "draw_sound",
    "draw_steady",
    "draw_sweep",
    "draw_system",
    "draw_transient",
    "draw_unbalance_response",
    "save",
    "save_all",
]
