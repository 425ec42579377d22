"""Detectability of a fault: healthy scatter, thresholds, and the probability of detection over the fault's size.

* :mod:`~gearwhine.detection.samples`: gearboxes with and without the fault, and the records of their sensors.
* :mod:`~gearwhine.detection.records`: those records with noise, and the condition indicators of them.
* :mod:`~gearwhine.detection.detectability`: thresholds and probabilities of detection by sensor and indicator.
"""
