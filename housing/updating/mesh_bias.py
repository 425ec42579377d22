"""Mesh bias: discretisation error of a coarse mesh's frequencies, learned at one design and corrected at others.

A coarse mesh is too stiff, for some modes more than for others, and nearly alike at all designs. At a design solved on
both meshes b_k = ln(ω_fine / ω_coarse) of each mode is known. Another design's modes are combinations of these, as
far as the motions of seats and skin show it, φ ≈ T φ_known; with b̄ the mean of all b their shifts are the matrix

    B = b̄ I + T diag(b - b̄) Tᵀ,

and ln Λ + 2 B has the eigenvalues 2 ln ω and the eigenvectors of the fine mesh. As a matrix it mixes as the modes do,
so that nothing jumps where two of them cross; a mode unlike all the known ones has their mean. So the search on the
coarse mesh ends where one on the fine mesh would (space mapping: Bandler et al. 2004, IEEE Transactions on Microwave
Theory and Techniques 52(1), 337-361).
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Generic

import numpy as np
from scipy import linalg
from scipy.optimize import linear_sum_assignment

from gearwhine.housing.correlation import modal_assurance_criterion
from gearwhine.housing.updating.surrogate import ModalState, Surrogate
from gearwhine.housing.updating.trust_region import AnyDesign, Solve
from gearwhine.numerics.arrays import FloatArray

_LEAST_MAC = 0.5  # below it two modes of the two meshes are no pair
# Part of the strongest combination of the known modes below which one is not observable at seats and skin.
_OBSERVABLE_SHARE = 0.1


@dataclass(frozen=True)
class MeshBias:
    """Error of a mesh's frequencies, as a function of the modes' motions.

    Attributes
    ----------
    reading : ndarray, shape (n_motions, n_known)
        Matrix from motions of seats and skin to coefficients of the known modes.
    shifts : ndarray, shape (n_known,)
        ln(ω_fine / ω_coarse).
    """

    reading: FloatArray
    shifts: FloatArray

    @classmethod
    def between(cls, coarse: ModalState, fine: ModalState) -> "MeshBias":
        """Learn the mesh bias at a design solved on both meshes; modes without a partner get the mean of the others."""
        motions, fine_motions = _motions(coarse), _motions(fine)
        table = modal_assurance_criterion(motions, fine_motions)
        rows, columns = linear_sum_assignment(-table)
        sound = table[rows, columns] >= _LEAST_MAC
        rows, columns = rows[sound], columns[sound]
        differences = np.log(fine.frequencies[columns] / coarse.frequencies[rows])
        shifts = np.full(len(motions), differences.mean() if len(differences) else 0.0)
        shifts[rows] = differences
        return cls(np.asarray(np.linalg.pinv(motions, rcond=_OBSERVABLE_SHARE), dtype=np.float64), shifts)

    def matrix(self, state: ModalState) -> FloatArray:
        """B among the modes of a coarse state, shape (n_modes, n_modes)."""
        mean = float(self.shifts.mean())
        parts = _motions(state) @ self.reading
        return np.asarray(mean * np.eye(len(parts)) + (parts * (self.shifts - mean)) @ parts.T)

    def turned(self, state: ModalState) -> tuple[FloatArray, FloatArray]:
        """Frequencies [rad/s] of the modes on the fine mesh, and their coefficients: (n,) and (n, n)."""
        whole = 2.0 * self.matrix(state)
        diagonal = np.arange(len(whole))
        whole[diagonal, diagonal] += 2.0 * np.log(state.frequencies)
        values, mixture = linalg.eigh(whole)
        return np.exp(0.5 * values), mixture


@dataclass(frozen=True)
class Debiased(Generic[AnyDesign]):
    """A design of a coarse mesh, corrected to the fine mesh.

    Attributes
    ----------
    design : Design
    bias : MeshBias, or None
        Bias; None where there is one mesh only, and the design stays as it is.
    """

    design: AnyDesign
    bias: MeshBias | None

    @property
    def coordinates(self) -> FloatArray:
        """Coordinates z, shape (n_parameters,)."""
        return self.design.coordinates

    @cached_property
    def _turned(self) -> tuple[FloatArray, FloatArray]:
        assert self.bias is not None
        return self.bias.turned(self.design.state)

    @cached_property
    def _state(self) -> ModalState:
        state = self.design.state
        return state if self.bias is None else _mixed(state, *self._turned)

    @property
    def state(self) -> ModalState:
        """Modes of the design."""
        return self._state

    @cached_property
    def _surrogate(self) -> Surrogate:
        surrogate = self.design.surrogate()
        if self.bias is None:
            return surrogate
        frequencies, mixture = self._turned
        return Surrogate(
            surrogate.center,
            _mixed(surrogate.state, frequencies, mixture),
            mixture.T @ surrogate.rates @ mixture,
            mixture.T @ surrogate.mass @ mixture,
        )

    def surrogate(self) -> Surrogate:
        """Return the surrogate about the design, corrected by the bias."""
        return self._surrogate


def debiased(solve: Solve[AnyDesign], bias: MeshBias | None) -> Solve[Debiased[AnyDesign]]:
    """Solver of designs on a coarse mesh that corrects its bias."""

    def without(coordinates: FloatArray, near: Debiased[AnyDesign] | None) -> Debiased[AnyDesign]:
        return Debiased(solve(coordinates, None if near is None else near.design), bias)

    return without


def _mixed(state: ModalState, frequencies: FloatArray, mixture: FloatArray) -> ModalState:
    n = len(frequencies)
    return replace(
        state,
        frequencies=frequencies,
        seats=(mixture.T @ state.seats.reshape(n, -1)).reshape(state.seats.shape),
        skin=mixture.T @ state.skin,
        measured=None if state.measured is None else mixture.T @ state.measured,
    )


def _motions(state: ModalState) -> FloatArray:
    """Motions of seats and skin, and of measured degrees of freedom, shape (n_modes, n_motions)."""
    n = len(state.frequencies)
    parts = [state.seats.reshape(n, -1), state.skin]
    if state.measured is not None:
        parts.append(state.measured)
    return np.concatenate(parts, axis=1)
