"""Scratch arrays of a collocation element."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]


class Work(NamedTuple):
    """Scratch arrays: n = s c unknown forces of an element, m amplitudes, c contacts, s places."""

    base: FloatArray  # (2 n,) compressions and rates without the excess forces
    excess: FloatArray  # (n,)
    move: FloatArray  # (n,) Newton's last step
    slope: FloatArray  # (n,) of the excess by compression ...
    rate_slope: FloatArray  # (n,) ... and by rate
    delta: FloatArray  # (s + 2, c) compressions at the places and both ends
    rate: FloatArray  # (s + 2, c)
    looked: FloatArray  # (4, c) compressions and rates just after the start, and just before the end
    laws: FloatArray  # (n + 2 c + 1, 6) at the places, just after the start, at the end, and one for trials
    matrix: FloatArray  # (n, n)
    right: FloatArray  # (n, 1)
    end: FloatArray  # (2 m,) amplitudes
    end_error: FloatArray  # (2 m,)
    measure: FloatArray  # (2,)
    cut_decay: FloatArray  # (1, 2, m) to a part of an element
    cut_source: FloatArray  # (1, n, 2 m)
    integral: ComplexArray  # (s + 2,)
    values: ComplexArray  # (s,)
    coefficient: FloatArray  # (s, c) of the excess as a power series
    term: FloatArray  # (2 m,) of the amplitudes' power series
    shares: FloatArray  # (n, 2 n) of the slopes in the forces
    feedback: FloatArray  # (n, 2 m) forces by disturbances; of no rows without disturbances ...
    sent: FloatArray  # (n, 2 m) ... amplitudes at the end by these forces ...
    decay: FloatArray  # (2, m) ... and the decay of the disturbances
    moved: FloatArray  # (n,)
    active: IntArray  # (n,) rows of forces that disturbances change


def element_work(m: int, s: int, c: int, *, varied: bool = False) -> Work:
    """Scratch arrays for elements of some shape, and for their disturbances."""
    n = s * c
    rows = n if varied else 0
    return Work(
        base=np.zeros(2 * n),
        excess=np.zeros(n),
        move=np.zeros(n),
        slope=np.zeros(n),
        rate_slope=np.zeros(n),
        delta=np.zeros((s + 2, c)),
        rate=np.zeros((s + 2, c)),
        looked=np.zeros((4, c)),
        laws=np.zeros((n + 2 * c + 1, 6)),
        matrix=np.zeros((n, n)),
        right=np.zeros((n, 1)),
        end=np.zeros(2 * m),
        end_error=np.zeros(2 * m),
        measure=np.zeros(2),
        cut_decay=np.zeros((1, 2, m)),
        cut_source=np.zeros((1, n, 2 * m)),
        integral=np.zeros(s + 2, dtype=np.complex128),
        values=np.zeros(s, dtype=np.complex128),
        coefficient=np.zeros((s, c)),
        term=np.zeros(2 * m),
        shares=np.zeros((rows, 2 * n)),
        feedback=np.zeros((rows, 2 * m)),
        sent=np.zeros((rows, 2 * m)),
        decay=np.zeros((2, m)),
        moved=np.zeros(n),
        active=np.zeros(n, dtype=np.int64),
    )
