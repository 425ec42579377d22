"""Dynamic stiffness of coordinates that few directions couple, solved by the formula of Sherman, Morrison and Woodbury.

Component modes have diagonal matrices, and connectors and gyroscopic terms act in few directions U beside them:

    Z = K + iω C - ω² I = D + U E Uᵀ,        Z⁻¹ = D⁻¹ - D⁻¹ U (I + E Uᵀ D⁻¹ U)⁻¹ E Uᵀ D⁻¹.

Near an undamped resonance of D alone, which Z need not have, digits are lost: Z is solved as it is there.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwhine.numerics.arrays import ComplexArray, FloatArray

_FEW = 0.4  # part of the coordinates up to which the directions between them are few
_ROUNDING = 1e-13  # part of a matrix's largest singular value that is rounding
_NEAR_RESONANCE = 1e-6  # part of its terms to which the dynamic stiffness of one coordinate may cancel


@dataclass(frozen=True, eq=False)
class DynamicStiffness:
    """Z = K + iω C - ω² I of some coordinates.

    Attributes
    ----------
    stiffness, damping : ndarray, shape (n, n)
        K [1/s²] and C [1/s].
    diagonals : ndarray, shape (2, n)
        Diagonals of K and C without the connectors, beside which K and C act in few directions.
    """

    stiffness: FloatArray
    damping: FloatArray
    diagonals: FloatArray

    @cached_property
    def _beside_diagonal(self) -> tuple[FloatArray, FloatArray, FloatArray] | None:
        """Directions U (n, r) in which K and C act beside the diagonals, and these parts in them; None of many."""
        matrices = zip((self.stiffness, self.damping), self.diagonals, strict=True)
        parts = [matrix - np.diag(diagonal) for matrix, diagonal in matrices]
        scaled = [part / largest for part in parts if (largest := np.abs(part).max(initial=0.0)) > 0.0]
        if not scaled:
            none = np.zeros((0, 0))
            return np.zeros((len(self.stiffness), 0)), none, none
        left, sizes, _ = np.linalg.svd(np.hstack([half for part in scaled for half in (part, part.T)]))
        rank = int(np.count_nonzero(sizes > _ROUNDING * sizes[0]))
        if rank > _FEW * len(left):
            return None
        directions = left[:, :rank]
        return directions, *(directions.T @ part @ directions for part in parts)

    def solve(self, w: complex, loads: FloatArray | ComplexArray) -> ComplexArray:
        """Coordinates (n, i) under loads (n, i) at a frequency [rad/s]."""
        terms = self.diagonals[0], 1j * w * self.diagonals[1], -(w**2)
        diagonal = terms[0] + terms[1] + terms[2]
        is_clear = np.all(np.abs(diagonal) > _NEAR_RESONANCE * (np.abs(terms[0]) + np.abs(terms[1]) + abs(terms[2])))
        if self._beside_diagonal is None or not is_clear:
            dynamic = np.asarray(self.stiffness + 1j * w * self.damping, dtype=np.complex128)
            dynamic[np.diag_indices(len(dynamic))] -= w**2
            return np.asarray(np.linalg.solve(dynamic, loads))
        directions, stiffness, damping = self._beside_diagonal
        moved = loads / diagonal[:, None]
        if directions.shape[1]:
            held = stiffness + 1j * w * damping
            along = directions / diagonal[:, None]
            between = np.eye(len(held)) + held @ (directions.T @ along)
            moved = moved - along @ np.linalg.solve(between, held @ (directions.T @ moved))
        return np.asarray(moved, dtype=np.complex128)
