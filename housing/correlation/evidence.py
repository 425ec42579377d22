"""Shape correlation beyond the pairs: all MACs, unpaired and double modes, close modes, quality of the survey."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.correlation.assurance import largest_off_diagonal

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class LookAlikes:
    """Two modes of one set whose shapes the survey finds alike.

    Attributes
    ----------
    first, second : int
        Their numbers, from 1.
    mac : float
        Of one with the other.
    one_frequency : bool
        Whether they are as close in frequency as close modes are, or an estimate's scatter: then of a test they are
        most likely one mode found twice. Otherwise the survey has too few points, or in the wrong places, to tell
        them apart.
    """

    first: int
    second: int
    mac: float
    one_frequency: bool


@dataclass(frozen=True)
class CloseModes:
    """Modes close to each other, of the model or of the test, and their partners, compared as spaces.

    Attributes
    ----------
    model, measured : tuple of int
        Their numbers, from 1.
    largest_angle : float
        Between the spaces that they span [rad]: 0 where the measured ones are combinations of the model's; NaN where
        they were measured at too few degrees of freedom in common.
    """

    model: tuple[int, ...]
    measured: tuple[int, ...]
    largest_angle: float


@dataclass(frozen=True)
class ShapeCorrelation:
    """Correlation of all model shapes with all measured ones.

    Attributes
    ----------
    model_frequencies, measured_frequencies : ndarray, shapes (a,) and (b,)
        [rad/s].
    mac : ndarray, shape (a, b)
    model_auto_mac, measured_auto_mac : ndarray, shapes (a, a) and (b, b)
        The survey cannot distinguish modes with large values off the diagonal.
    unpaired_measured : tuple of int
        Numbers of measured modes that no model mode is like: the model lacks them, or they are no modes.
    unpaired_model : tuple of int
        Numbers of model modes between the first and the last measured frequency that no measured mode is: the test
        missed them, or they are wrong.
    measured_look_alikes, model_look_alikes : tuple of LookAlikes
    close : tuple of CloseModes
    comac, enhanced_comac : ndarray, shape (n_dofs,), or None
        Over the pairs, close modes turned to each other; None without pairs.
    collinearity : ndarray, shape (b,)
        Modal phase collinearity of each measured shape: 1 where it is real.
    cross_orthogonality : ndarray, shape (c, b), or None
        Of the measured shapes with the model's modes in ``orthogonality_modes``, in the SEREP-reduced mass.
    orthogonality_modes : tuple of int
        Numbers of the model's modes, c of them.
    outside : ndarray, shape (b,), or None
        Part of each measured shape that these modes do not span.
    no_orthogonality : str
        Reason where there is no cross-orthogonality; else empty.
    """

    model_frequencies: FloatArray
    measured_frequencies: FloatArray
    mac: FloatArray
    model_auto_mac: FloatArray
    measured_auto_mac: FloatArray
    unpaired_measured: tuple[int, ...]
    unpaired_model: tuple[int, ...]
    measured_look_alikes: tuple[LookAlikes, ...]
    model_look_alikes: tuple[LookAlikes, ...]
    close: tuple[CloseModes, ...]
    comac: FloatArray | None
    enhanced_comac: FloatArray | None
    collinearity: FloatArray
    cross_orthogonality: FloatArray | None
    orthogonality_modes: tuple[int, ...]
    outside: FloatArray | None
    no_orthogonality: str = ""

    @property
    def largest_measured_likeness(self) -> float:
        """Largest MAC between different measured modes."""
        return largest_off_diagonal(self.measured_auto_mac)

    @property
    def largest_model_likeness(self) -> float:
        """Largest MAC between different modes of the model in the band: those far outside need not be told apart."""
        which = np.array(self.orthogonality_modes, dtype=np.int64) - 1
        return largest_off_diagonal(self.model_auto_mac[np.ix_(which, which)]) if which.size else 0.0
