"""Varied cases: gearboxes that differ as production makes them, and what of it matters.

* :mod:`~gearwhine.variation.inputs`: keys and their distributions; a point of the unit cube becomes changes of a case.
* :mod:`~gearwhine.variation.named_quantities`, :mod:`~gearwhine.variation.quantities`: names and numbers of a gearbox.
* :mod:`~gearwhine.variation.samples`, :mod:`~gearwhine.variation.run`: samples, their record, and the workers.
* :mod:`~gearwhine.variation.statistics`: distributions, correlations, Sobol' indices, yield.
"""
