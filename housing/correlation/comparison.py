"""Comparison of model and measured modes: pairs, frequency errors, and confidence of the pairing."""

from dataclasses import dataclass

import numpy as np

from housing.correlation.evidence import ShapeCorrelation


@dataclass(frozen=True)
class ModePair:
    """A measured mode and the model's.

    Attributes
    ----------
    measured, model : float
        Circular frequencies [rad/s].
    measured_mode, mode : int
        Numbers of the measured and of the model mode, from 1.
    strength : float or None
        The model mode's lateral acceleration strength [1/kg]; None where nothing drives the housing.
    mac : float or None
        Modal assurance criterion, with the close modes together where there are any; None without shapes.
    confidence : float or None
        Margin of this pair over the next best assignment, from 0 to 1, not a probability; None without shapes.
    close_modes : tuple of int
        Numbers of the model modes close to each other that the pair's is one of; empty where it stands apart.
    mixed : bool
        Whether shapes cannot identify the single modes of the close group.
    """

    measured: float
    model: float
    measured_mode: int
    mode: int
    strength: float | None
    mac: float | None = None
    confidence: float | None = None
    close_modes: tuple[int, ...] = ()
    mixed: bool = False

    @property
    def error_percent(self) -> float:
        """Model minus measured, in per cent of measured."""
        return 100.0 * (self.model / self.measured - 1.0)


@dataclass(frozen=True)
class Comparison:
    """Pairs of measured and model modes, and the confidence of the pairing.

    Attributes
    ----------
    pairs : tuple of ModePair
        Ascending in the measured frequency.
    pairing : str
        The rule by which they were paired.
    band : tuple of float
        Band of possible partners [rad/s].
    gap : float or None
        Of a pairing by dominance: ln(strength of the last chosen mode / strength of the first left out); below 0.1 the
        choice is a coin toss.
    measures_agree : bool or None
        Of a pairing by dominance: whether acceleration, velocity and mean absolute strength all choose these modes.
    shapes : ShapeCorrelation or None
        Correlation of the shapes, where there are any.
    """

    pairs: tuple[ModePair, ...]
    pairing: str
    band: tuple[float, float]
    gap: float | None = None
    measures_agree: bool | None = None
    shapes: ShapeCorrelation | None = None

    @property
    def rms_error_percent(self) -> float:
        """Root-mean-square of the errors; NaN without pairs."""
        errors = [pair.error_percent**2 for pair in self.pairs]
        return float(np.sqrt(np.mean(errors))) if errors else float("nan")

    @property
    def max_error_percent(self) -> float:
        """Largest absolute error; NaN without pairs."""
        return max((abs(pair.error_percent) for pair in self.pairs), default=float("nan"))
