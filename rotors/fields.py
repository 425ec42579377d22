"""Exact fields along a chain: from the states at its nodes to any place, and their energies.

A field is the state (displacements, then forces) at the left end of every piece at one ω²; inside a
piece the transfer matrix continues it. Quadrature over a piece is Gauss–Legendre, which integrates
products of two such fields on pieces this short to rounding.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .chain import Chain
from .timoshenko import transfer_matrices

FloatArray = npt.NDArray[np.float64]

GAUSS_POINTS = 12


@dataclass(frozen=True)
class Fields:
    """Fields along one chain, in its scaled units.

    Attributes
    ----------
    chain
        The shaft.
    frequency_squared
        (k,): ω² of each field.
    states
        (k, p + 1, 2n): state just right of each node.
    """

    chain: Chain
    frequency_squared: FloatArray
    states: FloatArray

    def at(self, positions: FloatArray) -> FloatArray:
        """States at positions (z,) in m on the shaft, (k, z, 2n)."""
        chain = self.chain
        piece = np.clip(np.searchsorted(chain.nodes, positions, side="right") - 1, 0, chain.lengths.size - 1)
        offset = (positions - chain.nodes[piece]) / chain.length_unit
        return self._inside(piece, offset)

    def energies(self, mixture: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mass and stiffness matrices of combinations of the fields, in the chain's units.

        Kinetic energy is ½ q̇ᵀ M q̇ and strain energy, springs to ground included, ½ qᵀ K q. The
        fields are combined before they are squared: a combination that cancels keeps its digits.

        Parameters
        ----------
        mixture
            (m, k): rows are the combinations.

        Returns
        -------
        mass, stiffness
            Both (m, m).
        """
        chain, n = self.chain, self.chain.size
        piece, weight, inside = self._quadrature(mixture)
        nodal = np.tensordot(mixture, self.states[:, :, :n], axes=1)
        mass = _gram(inside[:, :, :n], weight * chain.inertia[piece]) + _gram(nodal, chain.node_inertia)
        strain = _gram(inside[:, :, n:], weight * chain.flexibility[piece])
        return mass, strain + _gram(nodal, chain.finite_stiffness)

    def polar_matrix(self, mixture: FloatArray) -> FloatArray:
        """∫ ρI_p βᵢ βⱼ dz plus the nodes' polar inertias, of combinations of bending fields, (m, m)."""
        chain = self.chain
        piece, weight, inside = self._quadrature(mixture)
        slopes = np.tensordot(mixture, self.states[:, :, 1:2], axes=1)
        # A round section's polar moment of area is twice its diametral one.
        along = _gram(inside[:, :, 1:2], 2.0 * weight * chain.inertia[piece, 1:2])
        return along + _gram(slopes, chain.node_polar[:, None])

    def joined(self, other: "Fields") -> "Fields":
        """These fields followed by those of ``other``, on the same chain."""
        return Fields(
            self.chain,
            np.concatenate([self.frequency_squared, other.frequency_squared]),
            np.concatenate([self.states, other.states]),
        )

    def on(self, chain: Chain) -> "Fields":
        """The same fields on a chain that differs by further nodes only."""
        return Fields(chain, self.frequency_squared, self.at(chain.nodes))

    def _quadrature(self, mixture: FloatArray) -> tuple[npt.NDArray[np.intp], FloatArray, FloatArray]:
        """Piece (z,) and weight (z, 1) of every Gauss point, and the combined states there (m, z, 2n)."""
        points, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
        lengths = self.chain.lengths
        piece = np.repeat(np.arange(lengths.size), GAUSS_POINTS)
        inside = self._inside(piece, (0.5 * lengths[:, None] * (points + 1.0)).ravel())
        weight = (0.5 * lengths[:, None] * weights).ravel()[:, None]
        return piece, weight, np.tensordot(mixture, inside, axes=1)

    def _inside(self, piece: npt.NDArray[np.intp], offset: FloatArray) -> FloatArray:
        chain = self.chain
        flexibility, inertia = chain.flexibility[piece], chain.inertia[piece]
        inside = np.empty((self.frequency_squared.size, piece.size, 2 * chain.size))
        # One field at a time: the transfer matrices of all at once would be the largest array by far.
        for field, squared in enumerate(self.frequency_squared):
            transfer = transfer_matrices(flexibility, inertia, offset, np.full(piece.size, squared))
            inside[field] = np.einsum("zij,zj->zi", transfer, self.states[field, piece])
        return inside


def _gram(values: FloatArray, weights: FloatArray) -> FloatArray:
    """Σ over places and components of w vᵢ vⱼ; values (k, z, c), weights (z, c)."""
    fields = values.shape[0]
    rows = (values * weights).reshape(fields, -1)
    return np.asarray(rows @ values.reshape(fields, -1).T)
