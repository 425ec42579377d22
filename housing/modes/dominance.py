"""Dominant modes, ranked by the transfer of a force at the bearing seats to the motion of the housing's skin.

The eight modes that TM-104434 keeps of its 25 "represent a major part of the total global vibration"; the rule
by which they were chosen is not printed. Dominance in this module is the lateral acceleration strength

    strength = rms over the seats of |φ_x, φ_y| times rms over the survey of φ_normal     [1/kg],

with φ mass-normalised: at resonance a harmonic force F at the seats makes an acceleration of about
F strength / (2ζ) at the skin. Two other measures stand beside it as a check on the choice: velocity (strength
divided by ω), and mean absolute values in place of the root-mean-squares.
"""

from dataclasses import dataclass

import numpy as np

from gearwhine.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class Dominance:
    """Strength of each mode, by three measures.

    Attributes
    ----------
    acceleration : ndarray, shape (n_modes,)
        The measure that decides [1/kg].
    velocity : ndarray, shape (n_modes,)
        Strength as a velocity [s/kg].
    absolute : ndarray, shape (n_modes,)
        Mean absolute strength [1/kg].
    frequencies : ndarray, shape (n_modes,)
        Circular frequencies [rad/s].
    """

    acceleration: FloatArray
    velocity: FloatArray
    absolute: FloatArray
    frequencies: FloatArray

    def strongest(self, count: int, band: tuple[float, float], measure: FloatArray | None = None) -> IntArray:
        """Numbers of the ``count`` strongest modes in a band of circular frequency, ascending in frequency."""
        strength = self.acceleration if measure is None else measure
        inside = np.flatnonzero((self.frequencies >= band[0]) & (self.frequencies <= band[1]))
        return np.sort(inside[np.argsort(-strength[inside], kind="stable")][:count])

    def gap(self, count: int, band: tuple[float, float]) -> float:
        """Return ln of the ratio of the last chosen strength to the first one left out; infinite where none is."""
        inside = (self.frequencies >= band[0]) & (self.frequencies <= band[1])
        ranked = np.sort(self.acceleration[inside])[::-1]
        return float(np.log(ranked[count - 1] / ranked[count])) if len(ranked) > count else float("inf")

    def gaps(self, chosen: IntArray, band: tuple[float, float]) -> tuple[float, float]:
        """Gaps between some modes and the others in a band: by acceleration, and the smaller one of the other measures.

        ln(weakest chosen / strongest left out); negative where the measure would choose other modes, infinite where
        there are no others.
        """
        left = (self.frequencies >= band[0]) & (self.frequencies <= band[1])
        left[chosen] = False
        if not left.any():
            return float("inf"), float("inf")
        measures = (self.acceleration, self.velocity, self.absolute)
        deciding, *others = (float(np.log(measure[chosen].min() / measure[left].max())) for measure in measures)
        return deciding, min(others)

    def measures_agree(self, count: int, band: tuple[float, float]) -> bool:
        """Whether all three measures choose the same modes."""
        chosen = self.strongest(count, band)
        others = (self.velocity, self.absolute)
        return all(np.array_equal(chosen, self.strongest(count, band, measure)) for measure in others)


def dominance(frequencies: FloatArray, seats: FloatArray, skin: FloatArray) -> Dominance:
    """Strength of modes between the seats and the skin.

    Parameters
    ----------
    frequencies : ndarray, shape (n_modes,)
        Circular frequencies [rad/s].
    seats : ndarray, shape (n_modes, n_seats, 2)
        x and y translation of each seat in the mass-normalised shapes [1/√kg].
    skin : ndarray, shape (n_modes, n_points)
        Outward normal motion at the survey points [1/√kg].
    """
    radial = np.linalg.norm(seats, axis=2)
    acceleration = np.sqrt((radial**2).mean(axis=1)) * np.sqrt((skin**2).mean(axis=1))
    with np.errstate(divide="ignore"):
        velocity = np.where(frequencies > 0.0, acceleration / np.where(frequencies > 0.0, frequencies, 1.0), 0.0)
    absolute = radial.mean(axis=1) * np.abs(skin).mean(axis=1)
    return Dominance(acceleration, velocity, absolute, frequencies)
