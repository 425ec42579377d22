"""Sweeps: a case at many speeds, or over any of its keys, by many processes.

- :func:`sweep_points` -- the case at every point of the grid, checked, each with the key of its content.
- :func:`run_sweep` -- points on file are read, the others go to the workers, each point is written as it ends.
- :func:`missed_peaks` -- resonances that a sweep over speed passes by between its points.
- :func:`collected_sweep`, :func:`sweep_document` -- all points in one labelled dataset, and as JSON.

A point is identified by its content (:mod:`gearwhine.sweep.points`), is solved wherever a worker is
(:mod:`gearwhine.workers`), and lives in a file of its own (both in :mod:`gearwhine.sweep.solution`).
"""

from gearwhine.sweep.collect import collected_sweep, sweep_document
from gearwhine.sweep.grid import SweptPoint
from gearwhine.sweep.points import Point, axis_name, sweep_points
from gearwhine.sweep.resolution import missed_peaks
from gearwhine.sweep.run import run_sweep
from gearwhine.sweep.solution import PointResult

__all__ = [
    "Point",
    "PointResult",
    "SweptPoint",
    "axis_name",
    "collected_sweep",
    "missed_peaks",
    "run_sweep",
    "sweep_document",
    "sweep_points",
]
