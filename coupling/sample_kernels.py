"""Samples within a step of Newmark's method, compiled: interpolation of the output rows.

Importing this module imports numba.
"""

import numpy as np
import numpy.typing as npt

from coupling.contact_kernels import FORCE, evaluate_contact, flank_deviation
from coupling.kernel_arrays import Contacts, Outputs, Samples, Scratch
from coupling.row_kernels import project
from rotors.compiled import inner

FloatArray = npt.NDArray[np.float64]


@inner()
def write_samples(
    contacts: Contacts,
    outputs: Outputs,
    samples: Samples,
    number: int,
    t: float,
    h: float,
    turned0: float,
    speed0: float,
    alpha: float,
    q: FloatArray,
    v: FloatArray,
    displaced: float,
    moved: float,
    scratch: Scratch,
) -> int:
    """Write the samples that fall into the step from t to t + h.

    Displacement and velocity by cubic Hermite interpolation, acceleration linear: errors below the step's own.
    """
    q0, v0, a, a1, x, y = scratch.q0, scratch.v0, scratch.a, scratch.free, scratch.x, scratch.y
    teeth, laws, work = contacts.direction[: contacts.phase.size], scratch.spare, scratch.delta_free
    n = q.size
    while number - samples.offset < samples.force.shape[0]:
        time = samples.first + number * samples.interval
        if time > t + h:
            break
        row = number - samples.offset
        s = max((time - t) / h, 0.0)
        old, slope_old = (1.0 + 2.0 * s) * (1.0 - s) ** 2, s * (1.0 - s) ** 2 * h
        new, slope_new = s * s * (3.0 - 2.0 * s), s * s * (s - 1.0) * h
        for i in range(n):
            q1, v1 = q0[i] + displaced * a1[i], v0[i] + moved * a1[i]
            x[i] = old * q[i] + slope_old * v[i] + new * q1 + slope_new * v1
            y[i] = old * v[i] + slope_old * a[i] + new * v1 + slope_new * a1[i]
        project(outputs.displacement, x, samples.displacement[row])
        project(outputs.velocity, y, samples.velocity[row])
        if contacts.phase.size > 0:
            after = s * h
            speed = speed0 + alpha * after
            turned = turned0 + after * (speed0 + 0.5 * alpha * after)
            project(teeth, x, samples.compression[row])
            project(teeth, y, work)
            for k in range(contacts.phase.size):
                gone, slip = flank_deviation(contacts.clearance, contacts.errors, k, turned, speed)
                samples.compression[row, k] -= gone
                evaluate_contact(contacts, k, turned, samples.compression[row, k], work[k] - slip, laws, k)
                samples.force[row, k] = laws[k, FORCE]
        for i in range(n):
            x[i] = (1.0 - s) * a[i] + s * a1[i]
        project(outputs.acceleration, x, samples.acceleration[row])
        number += 1
    return number
