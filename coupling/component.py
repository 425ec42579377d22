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
        For each coordinate what it moves: ``housing``, ``rotor`` (lateral), ``torsion``, or ``residual``: an
        attachment of the housing, which stands for the static response of all that its modes leave out. Its own
        frequency is no natural frequency of the housing, and motion at that frequency means nothing.
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
    """The housing on its supports: its modes, then its residual attachments where it has them.

    Attributes
    ----------
    seats : mapping of str to ndarray, shape (n, 6)
        Coordinates' motions at each seat: translations x, y, z, rotations about x, y, z, at the seat's centre.
    seat_z : mapping of str to float
        z of each seat's centre [m].
    sensors : mapping of str to ndarray, shape (n,)
        Coordinates' motions along each sensor.
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

    def seat_tilt(self, seat: str, axis: int) -> FloatArray:
        """Rotation of a seat about x (axis 0) or y (1)."""
        return np.asarray(self.seats[seat][:, 3 + axis])


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

    def tilt(self, at: float, axis: int) -> FloatArray:
        """Rotation of the section about x (axis 0) or y (1), shape (n,).

        The slope in x is the rotation about y; the slope in y is minus that about x.
        """
        row = np.zeros(self.size)
        m = len(self.lateral.frequencies)
        slope = self.mixture.T @ self.lateral.evaluate(np.array([at]))[1][:, 0]
        plane = 1 - axis
        row[plane * m : (plane + 1) * m] = slope if axis == 1 else -slope
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
    """The housing from its modes and attachments: K = diag(ω²), C = diag(2 ζ ω) + Φᵀ C Φ.

    Parameters
    ----------
    modes : ModeSet
        With m modes and, where it has attachments, k of them: n = m + k coordinates.
    damping_ratios : ndarray, shape (m,)
        Parts of critical. Attachments take the highest of them.
    seats, seat_z, sensors
        See :class:`HousingComponent`; by :meth:`housing.ModeSet.project_all`.
    damping_matrix : ndarray, shape (n, n), optional
        Φᵀ C Φ of dashpots, mounts and joints [1/s], which couples the coordinates.

    Raises
    ------
    CouplingError
        Where the damping does not fit the modes, the matrix would drive them, or there are not as many motions as
        coordinates.
    """
    m = len(modes.frequencies)
    if damping_ratios.shape != (m,):
        raise CouplingError(f"{len(damping_ratios)} damping ratios for {m} housing modes; expected as many")
    omega, ratios = modes.frequencies, damping_ratios
    if modes.attachments is not None:
        omega = np.concatenate([omega, modes.attachments.frequencies])
        ratios = np.concatenate([ratios, np.full(len(omega) - m, damping_ratios.max(initial=0.0))])
    n = len(omega)
    for place, motion in [*seats.items(), *sensors.items()]:
        if len(motion) != n:
            raise CouplingError(f"{place!r}: motions of {len(motion)} coordinates; expected {n}, attachments included")
    damping = np.diag(2.0 * ratios * omega)
    if damping_matrix is not None:
        _check_damping(damping_matrix, n)
        damping = damping + damping_matrix
    return HousingComponent(
        name=name,
        kinds=("housing",) * m + ("residual",) * (n - m),
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
