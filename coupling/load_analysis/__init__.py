"""Load analysis of a machine at rest: equilibrium, lives of bearings, and influences of parts on gears and lines.

- :mod:`~gearwhine.coupling.load_analysis.solved_load`, :mod:`~gearwhine.coupling.load_analysis.load_warnings`: the
  operating point with lives of bearings, and its plausibility.
- :mod:`~gearwhine.coupling.load_analysis.housing_fields`: displacements of a housing's nodes, by which walls count.
- :mod:`~gearwhine.coupling.load_analysis.box_walls`: the walls of a box as changes of its housing.
- :mod:`~gearwhine.coupling.load_analysis.line_model`: lines of the sensors and of the sound about the equilibrium.
- :mod:`~gearwhine.coupling.load_analysis.ranking`: influences of walls, bearing stiffness and positions, as
  :mod:`~gearwhine.coupling.load_analysis.influences`.
"""
