"""Figures by matplotlib, without a display: arrays and results in, a `Figure` or a file out.

``draw_transient``, ``draw_run``, ``draw_gear_pairs``, ``draw_system``, ``draw_steady``, ``draw_sweep`` and
``draw_rotors`` yield the figures of an analysis with their names, which :func:`save_all` writes; the others return a
figure for print, 160 mm wide, that :func:`save` writes::

    assembly = RotorAssembly(rotor, bearings)
    save(draw_shaft(assembly), Path("shaft.png"))
    save(draw_lateral_modes(assembly, solve_lateral_modes(rotor, supports)), Path("modes.png"))
"""

from gearwhine.figures.gears.contact import draw_contact_path, draw_contact_pattern
from gearwhine.figures.gears.figure_set import draw_gear_pairs
from gearwhine.figures.gears.teeth import draw_flank_charts, draw_tooth_pair
from gearwhine.figures.gears.transmission_error import draw_harris_map, draw_mesh_stiffness, draw_transmission_error
from gearwhine.figures.housing import (
    ShapePair,
    draw_comparison,
    draw_coordinate_criteria,
    draw_mac_matrix,
    draw_measured_shapes,
)
from gearwhine.figures.machine.operating_point import draw_load
from gearwhine.figures.machine.run_up import draw_order_slices, draw_run, draw_run_up_waterfall
from gearwhine.figures.machine.steady_state import draw_response_curve, draw_steady
from gearwhine.figures.machine.sweep import draw_sweep
from gearwhine.figures.machine.system import draw_system, draw_system_campbell, draw_transmissibility
from gearwhine.figures.machine.transient import draw_transient
from gearwhine.figures.rotors.assembly import DrawnGear, DrawnProbe, DrawnUnbalance, RotorAssembly
from gearwhine.figures.rotors.campbell import draw_campbell
from gearwhine.figures.rotors.critical_speed_map import draw_critical_map
from gearwhine.figures.rotors.figure_set import draw_rotors
from gearwhine.figures.rotors.mode_shapes import draw_lateral_modes, draw_static_deflection, draw_torsional_modes
from gearwhine.figures.rotors.responses import (
    ProbeResponse,
    TorsionalReading,
    draw_torsional_response,
    draw_unbalance_response,
)
from gearwhine.figures.rotors.shaft import draw_shaft
from gearwhine.figures.rotors.whirl_shapes import draw_whirl_modes
from gearwhine.figures.style import save, save_all

__all__ = [
    "DrawnGear",
    "DrawnProbe",
    "DrawnUnbalance",
    "ProbeResponse",
    "RotorAssembly",
    "ShapePair",
    "TorsionalReading",
    "draw_campbell",
    "draw_comparison",
    "draw_contact_path",
    "draw_contact_pattern",
    "draw_coordinate_criteria",
    "draw_critical_map",
    "draw_flank_charts",
    "draw_gear_pairs",
    "draw_harris_map",
    "draw_lateral_modes",
    "draw_load",
    "draw_mac_matrix",
    "draw_measured_shapes",
    "draw_mesh_stiffness",
    "draw_order_slices",
    "draw_response_curve",
    "draw_rotors",
    "draw_run",
    "draw_run_up_waterfall",
    "draw_shaft",
    "draw_static_deflection",
    "draw_steady",
    "draw_sweep",
    "draw_system",
    "draw_system_campbell",
    "draw_tooth_pair",
    "draw_torsional_modes",
    "draw_torsional_response",
    "draw_transient",
    "draw_transmissibility",
    "draw_transmission_error",
    "draw_unbalance_response",
    "draw_whirl_modes",
    "save",
    "save_all",
]
