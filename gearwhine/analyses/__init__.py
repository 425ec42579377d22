"""Results of analyses: what each says of its solution, draws and writes.

- :mod:`~gearwhine.analyses.result`: the :class:`Result`; :mod:`~gearwhine.analyses.origin`: what it is of.
- :mod:`~gearwhine.analyses.machine_results`: rotors, gear pairs, and the machine under load.
- :mod:`~gearwhine.analyses.housing`: mesh, modes, comparison, survey, update and pictures; imported without rotors.
- :mod:`~gearwhine.analyses.run_solution`: a whole run; :mod:`~gearwhine.analyses.sweep_result`: a sweep.
"""
