"""Bearings as linear springs and dashpots: 2x2 or 5x5 matrices, pedestals, supports in one plane, axis springs.

A `Bearing` holds the shaft in both planes by its stiffness and damping matrices, over speed where they are tables, and
may stand on a `Pedestal`. A `RadialSupport` is a spring to ground in one plane. An `AxisSpring` is an axial or a
torsional spring from the shaft to ground.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PchipInterpolator

from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Instance, Number, Part, Text, attribute_findings, refuse
from gearwhine.rotors.errors import RotorError, require, require_finite


@dataclass(frozen=True)
class AxisSpring:
    """A spring from the shaft to ground: along its axis in axial motion, about it in torsion.

    Parameters
    ----------
    at : float
        Position from the rotor's left end [m].
    stiffness : float
        Stiffness [N/m], in torsion [N·m/rad]; zero is allowed, and ``math.inf`` holds the shaft there exactly.
    """

    at: float
    stiffness: float

    def __post_init__(self) -> None:
        """Check the position, and that the stiffness is not negative; it may be infinite."""
        require_finite("axis spring position", self.at, minimum=0.0)
        require(self.stiffness >= 0.0, "axis spring stiffness", self.stiffness, "zero, a positive number or infinity")


@dataclass(frozen=True)
class RadialSupport:
    """A spring from the shaft to ground in one plane.

    Parameters
    ----------
    at : float
        Position from the rotor's left end [m].
    stiffness : float
        Stiffness [N/m]; zero is allowed, and ``math.inf`` pins the shaft there exactly.
    tilt_stiffness : float
        Stiffness against the slope of the section [N·m/rad]; ``math.inf`` with an infinite stiffness is a clamp.
    """

    at: float
    stiffness: float
    tilt_stiffness: float = 0.0

    def __post_init__(self) -> None:
        """Check the position, and that no stiffness is negative; they may be infinite."""
        require_finite("support position", self.at, minimum=0.0)
        for attribute, value in (("stiffness", self.stiffness), ("tilt_stiffness", self.tilt_stiffness)):
            require(value >= 0.0, f"support {attribute}", value, "zero, a positive number or infinity")


@dataclass(frozen=True, eq=False)
class Pedestal:
    """A bearing's pedestal: a mass on springs and dashpots, free to move in x and y.

    Parameters
    ----------
    stiffness, damping : ndarray, shape (2, 2)
        Stiffness [N/m] and damping [N·s/m] to the ground, over x, y.
    mass : float
        Moving mass [kg].
    """

    stiffness: FloatArray
    damping: FloatArray
    mass: float = 0.0

    def __post_init__(self) -> None:
        """Check the mass, and that 2×2 stiffness holds the pedestal in x and y; freeze the matrices."""
        refuse(attribute_findings(("pedestal", ""), self, mass=Number(at_least=0.0, unit="kg")), RotorError)
        for attribute in ("stiffness", "damping"):
            matrix = _frozen(("pedestal", ""), attribute, getattr(self, attribute))
            require(
                matrix.shape == (2, 2), f"pedestal {attribute} shape", matrix.shape, "(2, 2), rows and columns x, y"
            )
            object.__setattr__(self, attribute, matrix)
        if self.stiffness.diagonal().min() <= 0.0:
            expected = "a matrix whose direct stiffnesses along x and y are above 0 N/m"
            refuse([Finding(("pedestal", ""), "stiffness", self.stiffness.tolist(), expected)], RotorError)
        is_held = bool(np.linalg.det(self.stiffness) != 0.0)
        require(is_held, "pedestal stiffness", self.stiffness.tolist(), "a matrix that holds it in x and y")


@dataclass(frozen=True, eq=False)
class Bearing:
    """A linear bearing between the shaft and its carrier: a pedestal, the housing or the ground.

    Parameters
    ----------
    name : str
        Name in messages.
    at : float
        Position from the rotor's left end [m].
    stiffness, damping : ndarray
        Force on the carrier per displacement or velocity of the shaft, which need not be symmetric: (2, 2) over x, y in
        N/m and N·s/m; or (5, 5) over x, y, z and the rotations about x and about y, also in N/rad, N·m/rad and their
        like; or (s, 2, 2) or (s, 5, 5), tabulated over ``speeds``. Both need not be of one form.
    speeds : ndarray, shape (s,) or None
        Ascending speeds of rotation of the tables [rad/s]; between them the coefficients follow a monotone cubic
        (Fritsch and Carlson 1980).
    pedestal : Pedestal or None
        The pedestal, if it is not rigid.

    Raises
    ------
    RotorError
        A matrix of another shape or not finite, or speeds that do not fit the tables or do not ascend. Direct
        stiffness may be zero, as of a damper, or negative, as of a seal or a magnetic bearing.
    """

    name: str
    at: float
    stiffness: FloatArray
    damping: FloatArray
    speeds: FloatArray | None = None
    pedestal: Pedestal | None = None

    def __post_init__(self) -> None:
        """Check position, speeds and shapes of the tables; freeze the arrays."""
        part, label = ("bearing", str(self.name)), f"bearing {self.name!r}"
        pedestal = Instance(Pedestal, "a pedestal, or None", optional=True)
        at = Number(at_least=0.0, unit="m")
        refuse(attribute_findings(part, self, name=Text(), at=at, pedestal=pedestal), RotorError)
        if self.speeds is not None:
            speeds = _frozen(part, "speeds", self.speeds)
            fits = speeds.ndim == 1 and speeds.size >= 2 and bool((np.diff(speeds) > 0.0).all())
            require(fits, f"{label} speeds", speeds.tolist(), "two or more speeds in rad/s, ascending")
            object.__setattr__(self, "speeds", speeds)
        for attribute in ("stiffness", "damping"):
            matrix = _frozen(part, attribute, getattr(self, attribute))
            shapes: list[tuple[int, ...]] = [(2, 2), (5, 5)]
            if self.speeds is not None:
                shapes += [(self.speeds.size, 2, 2), (self.speeds.size, 5, 5)]
            require(matrix.shape in shapes, f"{label} {attribute} shape", matrix.shape, f"one of {shapes}")
            object.__setattr__(self, attribute, matrix)
        if (self.damping[..., (0, 1), (0, 1)] < 0.0).any():
            expected = "a damping of at least 0 N s/m along x and along y: a negative one feeds energy in"
            refuse([Finding(part, "damping", self.damping.tolist(), expected)], RotorError)
        tabled = self.stiffness.ndim == 3 or self.damping.ndim == 3
        require(
            tabled or self.speeds is None, f"{label} speeds", self.speeds, "a table of stiffness or damping with them"
        )

    def __eq__(self, other: object) -> bool:
        """Equal in name, place and every coefficient."""
        return isinstance(other, Bearing) and self._identity == other._identity

    def __hash__(self) -> int:
        """Hash that agrees with equality."""
        return self._hash

    @property
    def findings(self) -> Iterator[Finding]:
        """Unlikely stiffness of a radial bearing: none in a direction without damping either, or a negative one."""
        if self.stiffness.shape[-1] != 2:
            return
        for axis, key in enumerate(("xx", "yy")):
            values = self.stiffness[..., axis, axis]
            expected = ""
            if not values.any() and not self.damping[..., axis, axis].any():
                expected = "a stiffness, or a damping beside it: this bearing does nothing in this direction"
            elif values.min() < 0.0:
                expected = "a stiffness that pushes back; a negative one is of seals and magnetic bearings"
            if expected:
                yield Finding(("bearing", self.name), f"stiffness.{key}", values.tolist(), expected, "warning")

    @classmethod
    def isotropic(cls, name: str, at: float, stiffness: float, damping: float = 0.0) -> "Bearing":
        """Bearing alike in every direction: one stiffness [N/m] and one damping [N·s/m].

        Raises
        ------
        RotorError
            As :class:`Bearing`; or either is not one number.
        """
        for attribute, value in (("stiffness", stiffness), ("damping", damping)):
            require_finite(f"bearing {name!r}: {attribute}", value)
        return cls(name, at, stiffness * np.eye(2), damping * np.eye(2))

    def at_speed(self, speed: float) -> "Bearing":
        """Interpolate the tables: the bearing with constant coefficients at a speed [rad/s] of either sense.

        Raises
        ------
        RotorError
            The speed is beyond the tables.
        """
        if self.speeds is None:
            return self
        low, high = float(self.speeds[0]), float(self.speeds[-1])
        turning = abs(speed)
        inside = low * (1.0 - 1e-12) <= turning <= high * (1.0 + 1e-12)
        require(inside, f"speed of bearing {self.name!r}", speed, f"a speed in its table, {low:g} to {high:g} rad/s")
        turning = min(max(turning, low), high)
        stiffness, damping = (
            table if curve is None else np.asarray(curve(turning))
            for table, curve in zip((self.stiffness, self.damping), self._curves, strict=True)
        )
        return replace(self, stiffness=stiffness, damping=damping, speeds=None)

    @cached_property
    def _curves(self) -> tuple[PchipInterpolator | None, ...]:
        """Stiffness and damping over speed, None where one is constant."""
        assert self.speeds is not None
        return tuple(
            PchipInterpolator(self.speeds, table) if table.ndim == 3 else None
            for table in (self.stiffness, self.damping)
        )

    @property
    def radial_stiffness(self) -> FloatArray:
        """Stiffness matrix (2, 2) over x, y [N/m]."""
        return self._constant(self.stiffness)[:2, :2]

    @property
    def radial_damping(self) -> FloatArray:
        """Damping matrix (2, 2) over x, y [N·s/m]."""
        return self._constant(self.damping)[:2, :2]

    @property
    def spatial_stiffness(self) -> FloatArray:
        """Stiffness matrix (5, 5) over x, y, z and the rotations about x and y."""
        return _spatial(self._constant(self.stiffness))

    @property
    def spatial_damping(self) -> FloatArray:
        """Damping matrix (5, 5) over x, y, z and the rotations about x and y."""
        return _spatial(self._constant(self.damping))

    @cached_property
    def axes(self) -> tuple[int, ...]:
        """Motions of the shaft that it takes part in, of x, y, z and the rotations about x and y as 0 to 4, ascending.

        A motion takes part if it causes a force or moment (a column of stiffness or damping) or if one acts along it
        (a row), at any speed of the tables. Matrices that are not symmetric may have the one without the other.
        """
        coupled = np.zeros(5, dtype=np.bool_)
        for matrix in (self.stiffness, self.damping):
            acts = (matrix != 0.0).reshape(-1, *matrix.shape[-2:]).any(axis=0)
            coupled[: acts.shape[0]] |= acts.any(axis=0) | acts.any(axis=1)
        return tuple(np.flatnonzero(coupled).tolist())

    @property
    def mean_stiffness(self) -> float:
        """Mean stiffness (k_xx + k_yy) / 2 of the planar modal basis (TM-101442 Eq. 7) [N/m]."""
        return 0.5 * float(np.trace(self.radial_stiffness))

    @property
    def mean_tilt_stiffness(self) -> float:
        """Mean stiffness of the rotations about x and y [N·m/rad]."""
        return 0.5 * float(np.trace(self.spatial_stiffness[3:, 3:]))

    @property
    def mean_support(self) -> RadialSupport:
        """The planar spring of the modal basis: none where the mean stiffness is negative.

        The basis is of a shaft on springs that hold it; the difference from the bearing's own matrix acts through it.
        """
        return RadialSupport(self.at, max(self.mean_stiffness, 0.0), max(self.mean_tilt_stiffness, 0.0))

    def plane_support(self, direction: int) -> RadialSupport:
        """Return the bearing's own direct spring in x (``direction`` 0) or y (1)."""
        # The section's slope in x is its rotation about y; the slope in y is minus that about x.
        direct = self._constant(self.stiffness).diagonal().tolist()
        return RadialSupport(self.at, direct[direction], direct[4 - direction] if len(direct) == 5 else 0.0)

    def _constant(self, matrix: FloatArray) -> FloatArray:
        if matrix.ndim == 3:
            raise RotorError(f"bearing {self.name!r} has a table over speed; expected one speed of it, by at_speed")
        return matrix

    @cached_property
    def _identity(self) -> tuple[object, ...]:
        arrays = [self.stiffness, self.damping, self.speeds]
        if self.pedestal is not None:
            arrays += [self.pedestal.stiffness, self.pedestal.damping, np.array(self.pedestal.mass)]
        return (self.name, self.at, *(None if array is None else (array.shape, array.tobytes()) for array in arrays))

    @cached_property
    def _hash(self) -> int:
        return hash(self._identity)


def undamped(bearing: Bearing) -> Bearing:
    """Return the bearing and its pedestal without damping."""
    pedestal = bearing.pedestal
    if pedestal is None and not bearing.damping.any():
        return bearing
    if pedestal is not None:
        pedestal = replace(pedestal, damping=np.zeros((2, 2)))
    return replace(bearing, damping=np.zeros_like(bearing.damping), pedestal=pedestal)


def _frozen(part: Part, attribute: str, value: npt.ArrayLike) -> FloatArray:
    """Return a read-only copy of an array, after a check that it is finite."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if not np.isfinite(array).all():
        refuse([Finding(part, attribute, value, "finite numbers")], RotorError)
    array.setflags(write=False)
    return array


def _spatial(matrix: FloatArray) -> FloatArray:
    if matrix.shape == (5, 5):
        return matrix
    whole = np.zeros((5, 5))
    whole[:2, :2] = matrix
    return whole
