"""The plain arrays that the time-stepping kernels take, by name.

n coordinates, c contacts, h harmonic loads; :mod:`coupling.step` fills them from a coupled system.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


class StepMatrices(NamedTuple):
    """What the step needs for each of m step sizes; n coordinates, c contacts, h harmonic loads."""

    size: FloatArray  # (m,) h [s]
    propagator: FloatArray  # (m, 2 n, n) Pᵀ: rows for q*, then for v*
    constant: FloatArray  # (m, n) S⁻¹ F of the constant load
    cosine: FloatArray  # (m, h, n) S⁻¹ Re F_w
    sine: FloatArray  # (m, h, n) S⁻¹ Im F_w
    contact: FloatArray  # (m, c, n) Wᵀ
    flexibility: FloatArray  # (m, c, c) H


class Dynamics(NamedTuple):
    """The system itself."""

    stiffness: FloatArray  # (n, n) Kᵀ
    damping: FloatArray  # (n, n) Cᵀ
    skew: FloatArray  # (n, n) (K - Kᵀ) / 2, transposed
    has_skew: bool
    loss_diagonal: FloatArray  # (n,) symmetric part of C: diagonal ...
    loss_rows: FloatArray  # (r, n) ... plus rows of low rank ...
    loss_weights: FloatArray  # (r,) ... with these weights
    constant: FloatArray  # (n,) F
    resolved: IntArray  # numbers of the coordinates that the error measure looks at
    frequency: FloatArray  # (h,) w [rad/s]
    cosine: FloatArray  # (h, n) Re F_w
    sine: FloatArray  # (h, n) Im F_w
    beta: float
    gamma: float


class Contacts(NamedTuple):
    """The tooth contacts, padded to common lengths."""

    direction: FloatArray  # (c, n) Dᵀ
    reach: FloatArray  # (c, 3): first and last position of a pair [base pitches], rows of the curves per base pitch
    curves: FloatArray  # (c, kinds of pairs, pieces + 1, 11): `coupling.gears.law_table`
    damping: FloatArray  # (c,)
    damping_depth: FloatArray  # (c,)
    phase: FloatArray  # (c,)
    rate: FloatArray  # (c,)
    errors: FloatArray  # (c, harmonics, 3): amplitude, frequency, phase
    clearance: FloatArray  # (c,)
    entering: FloatArray  # (c, pairs, 2): gap and kind of each pair of teeth
    faces: FloatArray  # (c, kinds of pairs, depths, pieces, 20): cells where the load spreads over the face
    face_depth: FloatArray  # (c,) 0 where it does not
    pairs: IntArray  # (c,) pairs of teeth in a hunting period; 0 where all are alike


class Segments(NamedTuple):
    """Stretches of time between events, each cut into equal steps."""

    start: FloatArray  # (s,)
    end: FloatArray  # (s,)
    steps: IntArray  # (s,)
    kind: IntArray  # (s,) which step matrices


class Outputs(NamedTuple):
    """What is written at each sample."""

    displacement: FloatArray  # (k0, n)
    velocity: FloatArray  # (k1, n)
    acceleration: FloatArray  # (k2, n)


class Samples(NamedTuple):
    """Where it is written; row i is the time first + i * interval."""

    first: float
    interval: float
    displacement: FloatArray  # (samples, k0)
    velocity: FloatArray  # (samples, k1)
    acceleration: FloatArray  # (samples, k2)
    compression: FloatArray  # (samples, c)
    force: FloatArray  # (samples, c)
