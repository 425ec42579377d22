"""Load analysis of a machine at rest: equilibrium, lives of bearings, and influences of parts on gears and lines.

- :mod:`~gearwhine.coupling.load_analysis.modelled_housing`: a housing's model with its modes, by which walls count.
- :mod:`~gearwhine.coupling.load_analysis.line_model`: lines of the sensors and of the sound about the equilibrium.
- :mod:`~gearwhine.coupling.load_analysis.ranking`: influences of walls, bearing stiffness and positions, as
  :mod:`~gearwhine.coupling.load_analysis.influences`.
"""
