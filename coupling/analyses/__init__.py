"""Analyses of a machine: each takes the machine and settings of its own, and gives a result with its proofs.

- :mod:`~gearwhine.coupling.analyses.loaded_machine`: the machine about its operating point, assembled.
- :mod:`~gearwhine.coupling.analyses.modes_and_responses`: complex modes, stability, Campbell diagram, responses.
- :mod:`~gearwhine.coupling.analyses.steady_state`: periodic motions, and their branch over speed.
- :mod:`~gearwhine.coupling.analyses.transient`: motion over time, by the blocks and the sampling of
  :mod:`~gearwhine.coupling.analyses.recording`.
- :mod:`~gearwhine.coupling.analyses.signature`: lines of that motion by their origin.
- :mod:`~gearwhine.coupling.analyses.run_up`: spectra and orders along a run.
- :mod:`~gearwhine.coupling.analyses.operation_warnings`, :mod:`~gearwhine.coupling.analyses.motion_warnings`: doubtful
  loads and motions.
"""
