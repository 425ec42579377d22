"""Figures by matplotlib, each made without a screen and, where a command draws it, written to a folder."""

from .gears import draw_gear_pairs
from .transient import draw_transient

__all__ = ["draw_gear_pairs", "draw_transient"]
