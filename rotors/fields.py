"""Exact fields along a discretised shaft: continued from node states to any place, with their energies.

A field is the state (displacements, then forces) at the left end of every piece at one ω²; inside a
piece the transfer matrix continues it. Quadrature over a piece is Gauss–Legendre, which integrates
products of two such fields on pieces this short to rounding.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from .chain import GAUSS_FRACTIONS, DiscretisedShaft

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ShaftFields:
    """Exact fields along one discretised shaft, in its scaled units.

    Attributes
    ----------
    chain
        The shaft.
    frequency_squared
        (k,): ω² of each field.
    states
        (k, p + 1, 2n): state just right of each node.
    """

    chain: DiscretisedShaft
    frequency_squared: FloatArray
    states: FloatArray

    def at(self, positions: FloatArray) -> FloatArray:
        """States at positions (z,) in m on the shaft, (k, z, 2n)."""
        piece, fraction = self.chain.places(positions)
        transfer_matrices = self.chain.transfer_matrices_to(piece, fraction, self.frequency_squared)
        return np.asarray(np.einsum("zkij,kzj->kzi", transfer_matrices, self.states[:, piece]))

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
        motion, strain = self._rows
        if mixture is not None:
            motion, strain = mixture @ motion, mixture @ strain
        weights = self.chain.energy_weights
        return (motion * weights.mass) @ motion.T, (strain * weights.strain) @ strain.T

    def mass_products(self, rows: FloatArray, others: FloatArray) -> FloatArray:
        """Entries of the mass matrix between two sets of combinations (a, k) and (b, k), (a, b)."""
        motion = self._rows[0]
        weighted = (rows @ motion) * self.chain.energy_weights.mass
        return np.asarray(weighted @ (others @ motion).T)

    def mass_norms(self, rows: FloatArray) -> FloatArray:
        """Norms in mass of combinations (a, k), (a,)."""
        motion = rows @ self._rows[0]
        return np.sqrt((motion**2) @ self.chain.energy_weights.mass)

    def polar_matrix(self, mixture: FloatArray) -> FloatArray:
        """∫ ρI_p βᵢ βⱼ dz plus the nodes' polar inertias, of combinations of bending fields, (m, m)."""
        motion = mixture @ self._rows[0]
        return np.asarray((motion * self.chain.energy_weights.polar) @ motion.T)

    def strain_of_pieces(self, mixture: FloatArray) -> FloatArray:
        """Twice the strain energy in each piece of combinations of the fields, springs left out, (m, p)."""
        strain, weights = mixture @ self._rows[1], self.chain.energy_weights.strain
        inside = weights.size - self.chain.finite_stiffness.size
        pieces = (strain**2 * weights)[:, :inside]
        return np.asarray(pieces.reshape(mixture.shape[0], self.chain.element.size, -1).sum(axis=2))

    def joined(self, other: "ShaftFields") -> "ShaftFields":
        """These fields followed by those of ``other``, on the same shaft."""
        return ShaftFields(
            self.chain,
            np.concatenate([self.frequency_squared, other.frequency_squared]),
            np.concatenate([self.states, other.states]),
        )

    def on(self, chain: DiscretisedShaft) -> "ShaftFields":
        """The same fields on a discretised shaft with further nodes."""
        if chain is self.chain:
            return self
        return ShaftFields(chain, self.frequency_squared, self.at(chain.nodes))

    @cached_property
    def _rows(self) -> tuple[FloatArray, FloatArray]:
        """Motion and strain of every field at the Gauss points and the nodes, as of `energy_rows`."""
        from .energy_kernels import energy_rows

        table, weights, count = self.chain.table, self.chain.energy_weights, self.frequency_squared.size
        motion, strain = np.empty((count, weights.mass.size)), np.empty((count, weights.strain.size))
        energy_rows(
            self.frequency_squared,
            self.states,
            GAUSS_FRACTIONS,
            table.lengths,
            table.coefficients,
            self.chain.element,
            motion,
            strain,
        )
        return motion, strain
