"""Analyses of a machine: each takes the machine and settings of its own, and gives a result with its proofs.

- :mod:`~gearwhine.coupling.analyses.operating_point`: static equilibrium under the mean load, lives of bearings.
- :mod:`~gearwhine.coupling.analyses.loaded_machine`: the machine about that equilibrium, assembled.
- :mod:`~gearwhine.coupling.analyses.modes_and_responses`: complex modes, stability, Campbell diagram, responses.
- :mod:`~gearwhine.coupling.analyses.steady_state`: periodic motions, and their branch over speed.
- :mod:`~gearwhine.coupling.analyses.transient`: motion over time, by the blocks and the sampling of
  :mod:`~gearwhine.coupling.analyses.recording`.
"""
