"""Sweeps: motions at many speeds, loads or dimensions, and what their points pass by or radiate.

- :mod:`~gearwhine.coupling.sweep.reduced_motion`: a motion, reduced to the quantities that a sweep collects.
- :mod:`~gearwhine.coupling.sweep.resonances`, :mod:`~gearwhine.coupling.sweep.missed_peaks`: coupled modes with the
  mesh harmonics near them, and peaks between two neighbouring speeds.
- :mod:`~gearwhine.coupling.sweep.line_sound`: sound of single lines, solved or interpolated over frequency.
"""
