"""Design optimisation: values of keys within bounds by aims and limits of what follows from them.

* :mod:`~gearwhine.optimisation.search`: points of the unit cube; differential evolution, trust region, NSGA-II, grid.
* :mod:`~gearwhine.optimisation.design`: designed keys of a case; a point becomes changes of the case.
* :mod:`~gearwhine.optimisation.goals`: aims and limits of quantities, with scatter or without.
* :mod:`~gearwhine.optimisation.evaluations`: designs, their record, and the workers.
* :mod:`~gearwhine.optimisation.optimised`: the best design, the Pareto front, bounds and limits that hold it back.
* :mod:`~gearwhine.optimisation.verification`: the transient of the start and of the proposed designs.
"""
