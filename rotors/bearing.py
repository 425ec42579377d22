"""What holds a rotor: springs of one plane, and radial bearings of both."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .errors import require, require_finite

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class RadialSupport:
    """A spring from the shaft to ground in one plane.

    Parameters
    ----------
    at
        Position from the rotor's left end, m.
    stiffness
        N/m; zero is allowed, and ``math.inf`` pins the shaft there exactly.
    tilt_stiffness
        Against the slope of the section, N·m/rad; ``math.inf`` with an infinite stiffness is a clamp.
    """

    at: float
    stiffness: float
    tilt_stiffness: float = 0.0

    def __post_init__(self) -> None:
        require_finite("support position", self.at, minimum=0.0)
        for what, value in (("stiffness", self.stiffness), ("tilt_stiffness", self.tilt_stiffness)):
            require(value >= 0.0, f"support {what}", value, "zero, a positive number or infinity")


@dataclass(frozen=True)
class Bearing:
    """A linear radial bearing between the shaft and whatever carries it.

    Parameters
    ----------
    name
        What messages call it.
    at
        Position from the rotor's left end, m.
    stiffness, damping
        (2, 2), rows and columns x, y: force on the carrier per displacement (N/m) or velocity (N·s/m)
        of the shaft. They need not be symmetric.

    Raises
    ------
    RotorError
        A matrix of another shape or not finite, or a direct stiffness that is negative.
    """

    name: str
    at: float
    stiffness: FloatArray
    damping: FloatArray

    def __post_init__(self) -> None:
        require_finite(f"bearing {self.name!r} position", self.at, minimum=0.0)
        for what in ("stiffness", "damping"):
            matrix = np.array(getattr(self, what), dtype=np.float64)
            label = f"bearing {self.name!r} {what}"
            require(matrix.shape == (2, 2), f"{label} shape", matrix.shape, "(2, 2), rows and columns x, y")
            require(bool(np.isfinite(matrix).all()), label, matrix.tolist(), "finite numbers")
            matrix.setflags(write=False)
            object.__setattr__(self, what, matrix)
        direct = np.diag(self.stiffness)
        expected = "not negative in xx and yy"
        require(bool((direct >= 0.0).all()), f"bearing {self.name!r} stiffness", direct.tolist(), expected)

    def __eq__(self, other: object) -> bool:
        """Equal in name, place and every coefficient."""
        if not isinstance(other, Bearing):
            return NotImplemented
        same = (self.name, self.at) == (other.name, other.at)
        matrices = np.array_equal(self.stiffness, other.stiffness)
        return same and matrices and np.array_equal(self.damping, other.damping)

    def __hash__(self) -> int:
        """Hash that agrees with equality."""
        return hash((self.name, self.at, self.stiffness.tobytes(), self.damping.tobytes()))

    @classmethod
    def isotropic(cls, name: str, at: float, stiffness: float, damping: float = 0.0) -> "Bearing":
        """Bearing alike in every direction: one stiffness (N/m) and one damping (N·s/m)."""
        return cls(name, at, stiffness * np.eye(2), damping * np.eye(2))

    @property
    def mean_stiffness(self) -> float:
        """(k_xx + k_yy) / 2, the stiffness of the planar modal basis (TM-101442 Eq. 7), N/m."""
        return 0.5 * float(self.stiffness[0, 0] + self.stiffness[1, 1])

    @property
    def has_cross_stiffness(self) -> bool:
        """Whether a displacement in x is answered in y, or the reverse."""
        return bool(self.stiffness[0, 1] != 0.0 or self.stiffness[1, 0] != 0.0)

    @property
    def mean_support(self) -> RadialSupport:
        """The planar spring of the modal basis."""
        return RadialSupport(self.at, self.mean_stiffness)

    def plane_support(self, direction: int) -> RadialSupport:
        """The bearing's own direct spring in x (``direction`` 0) or y (1)."""
        return RadialSupport(self.at, float(self.stiffness[direction, direction]))
