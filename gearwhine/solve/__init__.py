"""Solution of a case: each module takes a case, and what is solved before it, to results as plain objects.

Library objects come from :mod:`gearwhine.from_case`; documents and arrays of the results are made by
:mod:`gearwhine.results`.

- :mod:`~gearwhine.solve.case_summary`: check of a case, without solving.
- :mod:`~gearwhine.solve.housing_modes`: the housing's modes and their checks.
- :mod:`~gearwhine.solve.comparison`, :mod:`~gearwhine.solve.updating`: measured modes beside the model's with the plan
  of a survey, and model updating.
- :mod:`~gearwhine.solve.rotors`: each rotor alone.
- :mod:`~gearwhine.solve.gear_pairs`: each gear pair, and its best tip relief.
- :mod:`~gearwhine.solve.machine`: operating point, plan and run of the case's machine, whose modes, periodic motions
  and transients are solved in :mod:`gearwhine.coupling`.
- :mod:`~gearwhine.solve.damping`, :mod:`~gearwhine.solve.gear_bodies`, :mod:`~gearwhine.solve.part_fits`: damping of
  the parts, bodies of the gears, and fits of parts.
- :mod:`gearwhine.solve.sensitivity`: changes of the housing by its parameters, which are ranked in
  :mod:`gearwhine.coupling.load_analysis`.
- :mod:`~gearwhine.solve.acoustics`: settings of the sound, which is solved in :mod:`gearwhine.coupling.sound`;
  :mod:`~gearwhine.solve.kept_radiation`: its table over frequency, kept with the modes.
- :mod:`~gearwhine.solve.operating_shapes`: operating shapes of the machine's motion.
"""
