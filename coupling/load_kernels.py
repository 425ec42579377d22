"""Loads at a time, compiled; s is the turned time, s' the speed and α = s'' the angular acceleration.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from coupling.kernel_arrays import BY_TIME, BY_UNBALANCE, Dynamics
from rotors.compiled import inner

FloatArray = npt.NDArray[np.float64]


@inner(forceinline=True)
def load_at(dynamics: Dynamics, time: float, turned: float, speed: float, alpha: float, out: FloatArray) -> None:
    """All loads at a time."""
    n = out.size
    for i in range(n):
        out[i] = dynamics.constant[i] + alpha * dynamics.acceleration_load[i]
    for w in range(dynamics.frequency.size):
        frequency, follows = dynamics.frequency[w], dynamics.follows[w]
        angle = frequency * (time if follows == BY_TIME else turned)
        cosine, sine = math.cos(angle), math.sin(angle)
        if follows == BY_UNBALANCE:
            # (s'² - i s''/w) e^{iws}: inertia force of an eccentric mass, by differentiating twice.
            square, side = speed * speed, alpha / frequency
            cosine, sine = square * cosine + side * sine, square * sine - side * cosine
        for i in range(n):
            out[i] += cosine * dynamics.cosine[w, i] - sine * dynamics.sine[w, i]
    for m in range(dynamics.timed_sizes.size):
        last = dynamics.timed_sizes[m] - 1
        low, high = 0, last
        while high - low > 1:
            middle = (low + high) // 2
            if dynamics.timed_times[m, middle] <= time:
                low = middle
            else:
                high = middle
        begin, end = dynamics.timed_times[m, low], dynamics.timed_times[m, high]
        part = min(max((time - begin) / (end - begin), 0.0), 1.0) if end > begin else 0.0
        value = dynamics.timed_values[m, low] + part * (dynamics.timed_values[m, high] - dynamics.timed_values[m, low])
        for i in range(n):
            out[i] += value * dynamics.timed_rows[m, i]
