"""Exact fields along a chain: from the states at its nodes to any place, and their energies.

A field is the state (displacements, then forces) at the left end of every piece at one ω²; inside a
piece the transfer matrix continues it. Quadrature over a piece is Gauss–Legendre, which integrates
products of two such fields on pieces this short to rounding.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from .chain import Chain

FloatArray = npt.NDArray[np.float64]

GAUSS_POINTS = 10
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(GAUSS_POINTS)


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
        piece, fraction = self.chain.places(positions)
        transfers = self.chain.transfers_to(piece, fraction, self.frequency_squared)
        return np.asarray(np.einsum("zkij,kzj->kzi", transfers, self.states[:, piece]))

    def energies(self, mixture: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
        """Mass and stiffness matrices of combinations of the fields, in the chain's units.

        Kinetic energy is ½ q̇ᵀ M q̇ and strain energy, springs to ground and the work of an axial force
        included, ½ qᵀ K q. In bending the energies per length are ½ (ρA x² + ρI β²) ω² and
        ½ [f_x²/(κGA + P) + f_β²/EI + g P β²]. The fields are combined before they are squared: a combination
        that cancels keeps its digits.

        Parameters
        ----------
        mixture
            (m, k): rows are the combinations; without it, the fields themselves.

        Returns
        -------
        mass, stiffness
            Both (m, m).
        """
        chain, n = self.chain, self.chain.size
        inside, nodal = self._combined(mixture)
        weighted = self._weighted_coefficients
        mass = _gram(inside[:, :, :n], weighted[:, chain.inertia_rows]) + _gram(nodal, chain.node_inertia)
        if n == 1:
            strain = _gram(inside[:, :, 1:], weighted[:, :1])
        else:
            strain = _gram(inside[:, :, 1:], weighted[:, [5, 0, 1]])
        return mass, strain + _gram(nodal, chain.finite_stiffness)

    def polar_matrix(self, mixture: FloatArray) -> FloatArray:
        """∫ ρI_p βᵢ βⱼ dz plus the nodes' polar inertias, of combinations of bending fields, (m, m)."""
        inside, nodal = self._combined(mixture)
        # A round section's polar moment of area is twice its diametral one.
        along = _gram(inside[:, :, 1:2], 2.0 * self._weighted_coefficients[:, 3:4])
        return along + _gram(nodal[:, :, 1:2], self.chain.node_polar[:, None])

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

    @cached_property
    def _inside(self) -> FloatArray:
        """States at the Gauss points of every piece, (k, z, 2n)."""
        from .shape_kernels import inside_states

        table, states = self.chain.table, self.states
        inside = inside_states(
            self.frequency_squared,
            states,
            0.5 * (_POINTS + 1.0),
            table.lengths,
            table.coefficients,
            self.chain.element,
        )
        return np.asarray(inside.reshape(states.shape[0], -1, states.shape[2]))

    @cached_property
    def _weighted_coefficients(self) -> FloatArray:
        """Coefficients of the chain's pieces at the Gauss points, times the weights, (z, 6) or (z, 2)."""
        table = self.chain.table
        element = np.repeat(np.arange(table.lengths.size), GAUSS_POINTS)
        values = table.coefficients_at(element, np.tile(0.5 * (_POINTS + 1.0), table.lengths.size))
        values = values * (0.5 * table.lengths[:, None] * _WEIGHTS).reshape(-1, 1)
        return values.reshape(table.lengths.size, GAUSS_POINTS, -1)[self.chain.element].reshape(-1, values.shape[1])

    def _combined(self, mixture: FloatArray | None) -> tuple[FloatArray, FloatArray]:
        """States at the Gauss points (m, z, 2n) and displacements at the nodes (m, p + 1, n)."""
        nodal = self.states[:, :, : self.chain.size]
        if mixture is None:
            return self._inside, nodal
        return np.tensordot(mixture, self._inside, axes=1), np.tensordot(mixture, nodal, axes=1)


def _gram(values: FloatArray, weights: FloatArray) -> FloatArray:
    """Σ over places and components of w vᵢ vⱼ; values (k, z, c), weights (z, c)."""
    fields = values.shape[0]
    rows = (values * weights).reshape(fields, -1)
    return np.asarray(rows @ values.reshape(fields, -1).T)
