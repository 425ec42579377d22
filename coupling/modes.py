"""Complex natural modes of the coupled system about its mean contact."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

COORDINATE_KINDS = ("housing", "rotor", "torsion", "axial", "pedestal", "residual")

_MESH_SHARE = 0.3  # a mode with more of its strain energy than this in the teeth is called a mesh mode


@dataclass(frozen=True)
class CoupledModes:
    """Damped natural modes, ascending in frequency; one of each conjugate pair.

    Attributes
    ----------
    eigenvalues : ndarray of complex, shape (m,)
        λ [1/s], with a frequency of |λ| and a damping ratio of -Re λ / |λ|.
    shapes : ndarray of complex, shape (m, n)
        Coordinates, of unit norm.
    kinds : tuple of str
        What moves: ``housing``, ``rotor``, ``torsion``, ``axial``, ``pedestal``, ``mesh``, or ``rigid`` where nothing
        resists; ``residual`` where it is the local compliance that the housing's modes leave out, and the frequency
        means nothing.
    energy : tuple of dict
        Share of each kind of coordinate in the mode's kinetic energy, and under ``mesh`` the teeth's share in its
        strain energy.
    """

    eigenvalues: ComplexArray
    shapes: ComplexArray
    kinds: tuple[str, ...]
    energy: tuple[dict[str, float], ...]

    @property
    def frequencies_hz(self) -> FloatArray:
        """Undamped natural frequencies |λ| / 2π [Hz], shape (m,)."""
        return np.asarray(np.abs(self.eigenvalues) / (2.0 * np.pi))

    @property
    def damping_ratios(self) -> FloatArray:
        """Parts of critical, shape (m,); negative where the mode grows."""
        size = np.abs(self.eigenvalues)
        return np.asarray(-self.eigenvalues.real / np.where(size > 0.0, size, 1.0))


def coupled_modes(system: CoupledSystem) -> CoupledModes:
    """Eigenvalues of λ² q + λ C q + K q = 0, the teeth at their mean stiffness.

    Overdamped motions come as two real eigenvalues and are both listed, with a damping ratio of 1 (or -1).
    """
    stiffness, damping, n = system.mean_stiffness(), system.mean_damping(), system.size
    companion = np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]])
    values, vectors = np.linalg.eig(companion)
    scale = float(np.abs(values).max())
    # A rigid motion is a double zero, which rounding splits by about the square root of the precision.
    rigid = np.abs(values) < 1e-6 * scale
    upper = (values.imag > 1e-9 * scale) | ((np.abs(values.imag) <= 1e-9 * scale) & ~rigid)
    zeros = np.flatnonzero(rigid)[: (np.count_nonzero(rigid) + 1) // 2]
    chosen = np.concatenate([zeros, np.flatnonzero(upper & ~rigid)])
    chosen = chosen[np.argsort(np.abs(values[chosen]), kind="stable")]
    shapes = vectors[:n, chosen].T
    shapes = shapes / np.linalg.norm(shapes, axis=1)[:, None]
    kinds, energy = [], []
    contact_stiffness = stiffness - system.stiffness
    for value, shape in zip(values[chosen], shapes, strict=True):
        share = _shares(system, stiffness, contact_stiffness, shape)
        energy.append(share)
        if abs(value) < 1e-6 * scale:
            kinds.append("rigid")
        elif share["mesh"] > _MESH_SHARE:
            kinds.append("mesh")
        else:
            kinds.append(max(COORDINATE_KINDS, key=lambda kind: share[kind]))
    values = np.where(np.abs(values) < 1e-6 * scale, 0.0, values)
    return CoupledModes(np.asarray(values[chosen]), np.asarray(shapes), tuple(kinds), tuple(energy))


def _shares(
    system: CoupledSystem, stiffness: FloatArray, contact_stiffness: FloatArray, shape: ComplexArray
) -> dict[str, float]:
    kinetic = np.abs(shape) ** 2
    labels = np.array(system.kinds)
    share = {kind: float(kinetic[labels == kind].sum() / kinetic.sum()) for kind in COORDINATE_KINDS}
    strain = float((shape.conj() @ (stiffness @ shape)).real)
    mesh = float((shape.conj() @ (contact_stiffness @ shape)).real)
    share["mesh"] = mesh / strain if strain > 0.0 else 0.0
    return share
