"""Solving a case: each module takes a case, and what is solved before it, to results.

:mod:`gearwhine.solve.housing_modes` meshes and solves the housing and compares it with measured modes,
:mod:`gearwhine.solve.rotors` solves each rotor, :mod:`gearwhine.from_case.gear_pairs` each gear pair, which
:mod:`gearwhine.solve.gear_pairs` and :mod:`gearwhine.solve.gear_pairs` look at from all sides,
:mod:`gearwhine.from_case.machine` couples them, and :mod:`gearwhine.solve.transient` sets them in motion.
"""
