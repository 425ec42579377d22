"""Solving a case: each module takes a case, and what is solved before it, to results.

:mod:`gearwhine.stages.housing` meshes and solves the housing and compares it with measured modes,
:mod:`gearwhine.stages.rotors` solves each rotor, :mod:`gearwhine.stages.gears` each gear pair, which
:mod:`gearwhine.stages.gear_analysis` and :mod:`gearwhine.stages.gear_torques` look at from all sides,
:mod:`gearwhine.stages.machine` couples them, and :mod:`gearwhine.stages.transient` sets them in motion.
"""
