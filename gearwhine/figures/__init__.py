"""Figures by matplotlib, made without a screen: plain arrays and the rooms' own results in, a `Figure` or a file out.

``draw_transient``, ``draw_gear_pairs``, ``draw_teeth_of_pairs`` and ``draw_rotors`` write what a command shows into a
folder; the others return a figure for print, 160 mm wide, that :func:`save` writes::

    assembly = RotorAssembly(rotor, bearings)
    save(draw_shaft(assembly), Path("shaft.png"))
    save(draw_lateral_modes(assembly, solve_lateral_modes(rotor, supports)), Path("modes.png"))
"""

from .assembly import DrawnGear, DrawnProbe, DrawnUnbalance, RotorAssembly
from .campbell import draw_campbell
from .critical_map import draw_critical_map
from .gears import draw_gear_pairs
from .mode_shapes import draw_lateral_modes, draw_torsional_modes
from .rotors import draw_rotors
from .shaft import draw_shaft
from .static_deflection import draw_static_deflection
from .style import save
from .teeth import draw_teeth, draw_teeth_of_pairs
from .transient import draw_transient
from .unbalance import ProbeResponse, draw_unbalance_response
from .whirl_shapes import draw_whirl_modes

__all__ = [
    "DrawnGear",
    "DrawnProbe",
    "DrawnUnbalance",
    "ProbeResponse",
    "RotorAssembly",
    "draw_campbell",
    "draw_critical_map",
    "draw_gear_pairs",
    "draw_lateral_modes",
    "draw_rotors",
    "draw_shaft",
    "draw_static_deflection",
    "draw_teeth",
    "draw_teeth_of_pairs",
    "draw_torsional_modes",
    "draw_transient",
    "draw_unbalance_response",
    "draw_whirl_modes",
    "save",
]
