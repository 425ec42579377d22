"""Compiled quadrature of kinetic and strain energy along a discretised shaft.

Importing this module imports numba. The arrays of a chain come in the order of `rotors.count_kernels`.
"""

import math

import numpy as np
import numpy.typing as npt

from .compiled import counted
from .piece_kernels import element_transfer_matrices

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]


@counted(error_model="python")
def energy_weights(
    fractions: FloatArray,
    weights: FloatArray,
    lengths: FloatArray,
    given: FloatArray,
    element: IntArray,
    stiffness: FloatArray,
    inertia: FloatArray,
    polar: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Weights of the squares of `energy_rows`: mass and polar inertia for motion, compliance or stiffness for strain.

    ``weights`` (g,) are those of the quadrature over a piece; infinite ``stiffness`` (p + 1, n) stores nothing.
    """
    n, pieces, points = stiffness.shape[1], element.size, fractions.size
    motion_size, strain_size = pieces * points * n, pieces * points * (2 * n - 1)
    nodal = (pieces + 1) * n
    mass, turning = np.zeros(motion_size + nodal), np.zeros(motion_size + nodal)
    strain = np.zeros(strain_size + nodal)
    values = np.empty((lengths.size, points, given.shape[1]))
    for e in range(lengths.size):
        for g in range(points):
            for row in range(given.shape[1]):
                total = 0.0
                for j in range(given.shape[2] - 1, -1, -1):
                    total = total * (2.0 * fractions[g] - 1.0) + given[e, row, j]
                values[e, g, row] = total * lengths[e] * weights[g]
    at_motion, at_strain = 0, 0
    for piece in range(pieces):
        for g in range(points):
            value = values[element[piece], g]
            if n == 2:
                mass[at_motion], mass[at_motion + 1] = value[2], value[3]
                # A round section's polar moment of area is twice its diametral one.
                turning[at_motion + 1] = 2.0 * value[3]
                strain[at_strain], strain[at_strain + 1], strain[at_strain + 2] = value[5], value[0], value[1]
            else:
                mass[at_motion], strain[at_strain] = value[1], value[0]
            at_motion += n
            at_strain += 2 * n - 1
    for node in range(pieces + 1):
        for k in range(n):
            mass[at_motion] = inertia[node, k]
            strain[at_strain] = 0.0 if math.isinf(stiffness[node, k]) else stiffness[node, k]
            if k == 1:
                turning[at_motion] = polar[node]
            at_motion += 1
            at_strain += 1
    return mass, turning, strain


@counted(error_model="python")
def energy_rows(
    squared: FloatArray,
    states: FloatArray,
    fractions: FloatArray,
    lengths: FloatArray,
    given: FloatArray,
    element: IntArray,
    motion: FloatArray,
    strain: FloatArray,
) -> None:
    """Fill in the terms whose weighted squares are the energies of fields with node states (k, p + 1, 2n).

    Piece by piece and at every fraction (g,) of it, ``motion`` (k, p g n + ...) takes the displacements and
    ``strain`` (k, p g (2n − 1) + ...) the rotation (of a beam) and the forces; both end with the displacements of
    the nodes, n each.
    """
    size, pieces = states.shape[2], element.size
    n = size // 2
    transfer_matrices = np.empty((lengths.size, fractions.size, size, size))
    state = np.empty(size)
    for k in range(squared.size):
        if k == 0 or squared[k] != squared[k - 1]:
            for e in range(lengths.size):
                element_transfer_matrices(lengths[e], given[e], squared[k], squared[k], fractions, transfer_matrices[e])
        at_motion, at_strain = 0, 0
        for piece in range(pieces):
            for g in range(fractions.size):
                transfer = transfer_matrices[element[piece], g]
                for row in range(size):
                    state[row] = 0.0
                    for column in range(size):
                        state[row] += transfer[row, column] * states[k, piece, column]
                for row in range(n):
                    motion[k, at_motion + row] = state[row]
                for row in range(1, size):
                    strain[k, at_strain + row - 1] = state[row]
                at_motion += n
                at_strain += size - 1
        for node in range(pieces + 1):
            for row in range(n):
                motion[k, at_motion + row] = strain[k, at_strain + row] = states[k, node, row]
            at_motion += n
            at_strain += n
