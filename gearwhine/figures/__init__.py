"""Figures by matplotlib, without a screen: arrays and results in, a `Figure` or a file out.

``draw_transient``, ``draw_run``, ``draw_gear_pairs``, ``draw_system``, ``draw_steady``, ``draw_sweep`` and
``draw_rotors`` yield the figures of an analysis with their names, which :func:`save_all` writes; the others return a
figure for print, 160 mm wide, that :func:`save` writes::

    assembly = RotorAssembly(rotor, bearings)
    save(draw_shaft(assembly), Path("shaft.png"))
    save(draw_lateral_modes(assembly, solve_lateral_modes(rotor, supports)), Path("modes.png"))
"""

from .assembly import DrawnGear, DrawnProbe, DrawnUnbalance, RotorAssembly
from .campbell import draw_campbell
from .comparison import draw_comparison
from .contact_path import draw_contact_path
from .contact_pattern import draw_contact_pattern
from .coordinate_criteria import draw_coordinate_criteria
from .critical_map import draw_critical_map
from .flank_charts import draw_flank_charts
from .gear_pairs import draw_gear_pairs
from .harris_map import draw_harris_map
from .mac_matrix import draw_mac_matrix
from .measured_shapes import ShapePair, draw_measured_shapes
from .mesh_stiffness import draw_mesh_stiffness
from .mode_shapes import draw_lateral_modes, draw_torsional_modes
from .rotors import draw_rotors
from .run_up import draw_order_slices, draw_run, draw_run_up_waterfall
from .shaft import draw_shaft
from .static_deflection import draw_static_deflection
from .steady import draw_response_curve, draw_steady
from .style import save, save_all
from .sweep import draw_sweep
from .system import draw_system
from .system_campbell import draw_system_campbell
from .tooth_pair import draw_tooth_pair
from .torsional_response import TorsionalReading, draw_torsional_response
from .transient import draw_transient
from .transmissibility import draw_transmissibility
from .transmission_error import draw_transmission_error
from .unbalance import ProbeResponse, draw_unbalance_response
from .whirl_shapes import draw_whirl_modes

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
