"""Compiled kinetic-energy shares of complex motions, for `rotors.spatial_field`.

Importing this module imports numba.
"""

import numpy as np
import numpy.typing as npt

from .compiled import counted
from .piece_kernels import element_transfer_matrices

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
ComplexArray = npt.NDArray[np.complex128]


@counted(error_model="python")
def inertia_shares(
    pieces: tuple[FloatArray, FloatArray, IntArray],
    translation: ComplexArray,
    rotation: ComplexArray,
    states: ComplexArray,
    fractions: FloatArray,
    along: FloatArray,
    nodal: FloatArray,
) -> FloatArray:
    """Weighted sums of |r|² and |β|² over Gauss points and nodes, for every motion, (w,).

    ``states`` (w, p + 1, 4) continue from the left end of every piece at ω² of (w,) ``translation`` and ``rotation``;
    the weights are ``along`` (e, g, 2) at the ``fractions`` (g,) of the pieces and ``nodal`` (p + 1, 2).
    """
    lengths, given, element = pieces
    transfer_matrices = np.empty((lengths.size, fractions.size, 4, 4), dtype=np.complex128)
    totals = np.zeros(states.shape[0])
    for w in range(states.shape[0]):
        for e in range(lengths.size):
            element_transfer_matrices(
                lengths[e], given[e], translation[w], rotation[w], fractions, transfer_matrices[e]
            )
        for piece in range(element.size):
            state, e = states[w, piece], element[piece]
            for g in range(fractions.size):
                transfer = transfer_matrices[e, g]
                for row in range(2):
                    value = transfer[row, 0] * state[0] + transfer[row, 1] * state[1]
                    value += transfer[row, 2] * state[2] + transfer[row, 3] * state[3]
                    totals[w] += along[e, g, row] * (value.real**2 + value.imag**2)
        for node in range(states.shape[1]):
            for row in range(2):
                value = states[w, node, row]
                totals[w] += nodal[node, row] * (value.real**2 + value.imag**2)
    return totals
