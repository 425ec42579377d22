"""Components: each part of the machine as a set of mass-normalised coordinates.

A component's own equation of motion, with no connector attached, is

    q'' + (C + Ω G) q' + K q = f,

the mass being the identity. A *direction* is a row vector d such that d q is a motion of the component at one of
its ports; by virtual work a force F along it adds F d to f.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from housing import ModeSet
from rotors import LateralModes, TorsionalModes

FloatArray = npt.NDArray[np.float64]

_ROUNDING = 1e-10  # part of the largest entry that a damping matrix may miss of being symmetric and without gain


@dataclass(frozen=True)
class Component:
    """A part of the machine in modal coordinates.

    Attributes
    ----------
    name : str
    kinds : tuple of str
        For each coordinate what it moves: ``housing``, ``rotor`` (lateral) or ``torsion``.
    stiffness : ndarray, shape (n, n)
        K [1/s²], symmetric.
    damping : ndarray, shape (n, n)
        C [1/s], symmetric.
    gyroscopic : ndarray, shape (n, n)
        G, skew: multiplied by the speed of rotation [rad/s] it joins the damping.
    """

    name: str
    kinds: tuple[str, ...]
    stiffness: FloatArray
    damping: FloatArray
    gyroscopic: FloatArray

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.kinds)


@dataclass(frozen=True)
class HousingComponent(Component):
    """The housing on its supports.

    Attributes
    ----------
    seats : mapping of str to ndarray, shape (n, 6)
        Modes' motions at each seat: translations x, y, z, rotations about x, y, z, at the seat's centre.
    seat_z : mapping of str to float
        z of each seat's centre [m].
    sensors : mapping of str to ndarray, shape (n,)
        Modes' motions along each sensor.
    """

    seats: Mapping[str, FloatArray]
    seat_z: Mapping[str, float]
    sensors: Mapping[str, FloatArray]

    def seat_direction(self, seat: str, axis: int, z: float) -> FloatArray:
        """Lateral motion (axis 0: x, 1: y) of a seat's rigid motion, taken at height z of the shaft [m]."""
        motion = self.seats[seat]
        arm = z - self.seat_z[seat]
        # A rotation about y moves a point above the centre towards +x, one about x towards -y.
        return np.asarray(motion[:, 0] + arm * motion[:, 4] if axis == 0 else motion[:, 1] - arm * motion[:, 3])


@dataclass(frozen=True)
class RotorComponent(Component):
    """A rotor: lateral modes in the x and in the y plane, torsional modes, in this order.

    Attributes
    ----------
    lateral : LateralModes
        Planar modes on averaged supports, the basis in both planes.
    torsional : TorsionalModes
        Free-free, the rigid rotation first.
    start : float
        z of the rotor's left end [m].
    mixture : ndarray, shape (m, m)
        The plane's coordinates in terms of the planar modes, orthogonal: columns diagonalise the free shaft.
    """

    lateral: LateralModes
    torsional: TorsionalModes
    start: float
    mixture: FloatArray

    def direction(self, at: float, axis: int) -> FloatArray:
        """Lateral motion (axis 0: x, 1: y) at a distance from the left end [m], shape (n,)."""
        row = np.zeros(self.size)
        m = len(self.lateral.frequencies)
        row[axis * m : (axis + 1) * m] = self.mixture.T @ self.lateral.evaluate(np.array([at]))[0][:, 0]
        return row

    def rotation(self, at: float) -> FloatArray:
        """Rotation about z at a distance from the left end [m], shape (n,)."""
        row = np.zeros(self.size)
        row[2 * len(self.lateral.frequencies) :] = self.torsional.evaluate(np.array([at]))[:, 0]
        return row


def housing_component(
    modes: ModeSet,
    damping_ratios: FloatArray,
    *,
    seats: Mapping[str, FloatArray],
    seat_z: Mapping[str, float],
    sensors: Mapping[str, FloatArray],
    damping_matrix: FloatArray | None = None,
    name: str = "housing",
) -> HousingComponent:
    """The housing from its modes: K = diag(ω²), C = diag(2 ζ ω) + Φᵀ C Φ.

    Parameters
    ----------
    modes : ModeSet
        With n modes.
    damping_ratios : ndarray, shape (n,)
        Parts of critical.
    seats, seat_z, sensors
        See :class:`HousingComponent`.
    damping_matrix : ndarray, shape (n, n), optional
        Φᵀ C Φ of dashpots, mounts and joints [1/s], which couples the modes.

    Raises
    ------
    CouplingError
        Where the damping does not fit the modes, or the matrix would drive them.
    """
    omega = modes.frequencies
    if damping_ratios.shape != omega.shape:
        raise CouplingError(f"{len(damping_ratios)} damping ratios for {len(omega)} housing modes; expected as many")
    n = len(omega)
    damping = np.diag(2.0 * damping_ratios * omega)
    if damping_matrix is not None:
        _check_damping(damping_matrix, n)
        damping = damping + damping_matrix
    return HousingComponent(
        name=name,
        kinds=("housing",) * n,
        stiffness=np.diag(omega**2),
        damping=damping,
        gyroscopic=np.zeros((n, n)),
        seats=seats,
        seat_z=seat_z,
        sensors=sensors,
    )


def _check_damping(matrix: FloatArray, n: int) -> None:
    """Refuse a damping matrix of another order, or one that is not symmetric and free of gain."""
    if matrix.shape != (n, n):
        raise CouplingError(f"damping matrix of shape {matrix.shape} for {n} housing modes; expected ({n}, {n})")
    scale = float(np.abs(matrix).max(initial=0.0))
    if not np.isfinite(scale) or np.abs(matrix - matrix.T).max(initial=0.0) > _ROUNDING * scale:
        raise CouplingError("the damping matrix of the housing modes is not symmetric, or not finite")
    if n and np.linalg.eigvalsh(matrix)[0] < -_ROUNDING * n * scale:
        raise CouplingError("the damping matrix of the housing modes has a negative eigenvalue: it feeds energy in")


def rotor_component(
    name: str,
    lateral: LateralModes,
    torsional: TorsionalModes,
    *,
    start: float,
    damping_ratio: float = 0.0,
) -> RotorComponent:
    """A rotor from its planar and torsional modes, freed of the springs that its basis was found on.

    The planar modes are those at averaged support stiffness k̄ (TM-101442 Eq. 7). The springs come back with the
    bearings' connectors, so they are taken out here, K = diag(ω²) - Σ k̄ φ(z_b) φ(z_b)ᵀ in each plane (the
    *compensation* of TM-104434 Eqs. 11 to 15), and the same span is taken in coordinates that diagonalise K: the free
    shaft's own. Its damping acts on these, so that it resists bending and twisting but no motion of the shaft as a
    whole. The gyroscopic coupling of the planes is +G in the x rows and -G in the y rows, G_ij = ∫ φ'_i dI_p φ'_j, so
    that C + ΩG gives the terms G_v of Eqs. 1 and 2.

    Parameters
    ----------
    name : str
    lateral, torsional
        m and t modes: the component has 2 m + t coordinates.
    start : float
        z of the rotor's left end [m].
    damping_ratio : float
        Of the shaft's own material and fits, on every mode of the free shaft.
    """
    m, t = len(lateral.frequencies), len(torsional.frequencies)
    n = 2 * m + t
    values, mixture = np.linalg.eigh(np.diag(lateral.frequencies**2) - lateral.support_matrix)
    # Motions of the whole shaft have no stiffness; what rounding leaves of it is taken off.
    values = np.where(np.abs(values) < 1e-9 * values[-1], 0.0, np.maximum(values, 0.0))
    squared = np.concatenate([values, values, torsional.frequencies**2])
    gyroscopic = np.zeros((n, n))
    polar = mixture.T @ lateral.polar_inertia_matrix @ mixture
    gyroscopic[:m, m : 2 * m] = polar
    gyroscopic[m : 2 * m, :m] = -polar
    return RotorComponent(
        name=name,
        kinds=("rotor",) * (2 * m) + ("torsion",) * t,
        stiffness=np.diag(squared),
        damping=np.diag(2.0 * damping_ratio * np.sqrt(squared)),
        gyroscopic=gyroscopic,
        lateral=lateral,
        torsional=torsional,
        start=start,
        mixture=mixture,
    )
