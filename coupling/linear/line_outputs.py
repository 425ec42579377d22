r"""Outputs of a harmonic motion, the amplitude at a sensor and the sound power, with their adjoint loads.

An output J(q) of the complex motion q at ω is real, and changes by

    dJ = Re gᵀ dq,      g its adjoint load.

- *Sensor*, y = -ω² sᵀ q: J = |y| and g = -ω² (y* / |y|) s, at one point.
- *Sound power* of the rates iω q with the radiation resistance R, real and symmetric: J = ½ ω² qᴴ R q and
  g = ω² R q*, over the whole housing.

Both depend on the housing beyond its motion: a sensor moves with it, and so do the points that a radiating surface
moves with.
"""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from gearwhine.coupling.linear.housing_rates import HousingRates
from gearwhine.numerics.arrays import ComplexArray, FloatArray


class LineOutput(Protocol):
    """Real function J of the motion of the machine at a frequency."""

    @property
    def decibels(self) -> float:
        """Change of the output's level for a factor of ten [dB]."""
        ...

    def value(self, w: float, motion: ComplexArray) -> float:
        """J of a motion of shape (n,) at a frequency [rad/s]."""
        ...

    def adjoint_load(self, w: float, motion: ComplexArray) -> ComplexArray:
        """G = g of a motion, with dJ = Re gᵀ dq, shape (n,)."""
        ...

    def by_housing(self, rates: HousingRates, number: int, w: float, motion: ComplexArray) -> float:
        """Differentiate J by a parameter of the housing at the same motion."""
        ...

    def moved(self, rates: HousingRates, number: int, step: float) -> "LineOutput":
        """Return the output of the housing with a step of a parameter."""
        ...


@dataclass(frozen=True, eq=False)
class SensorAmplitude:
    """Amplitude of the acceleration of a sensor [m/s²].

    Attributes
    ----------
    sensor : str
    row : ndarray, shape (n,)
        Displacement s of the sensor by the coordinates of the machine.
    housing : slice
        Place of the housing's coordinates among those of the machine.
    """

    sensor: str
    row: FloatArray
    housing: slice

    decibels = 20.0

    def value(self, w: float, motion: ComplexArray) -> float:
        """Amplitude |y| [m/s²]."""
        return w**2 * abs(complex(self.row @ motion))

    def weight(self, w: float, motion: ComplexArray) -> complex:
        """Factor -ω² y* / |y| from a displacement of the sensor to the change of the amplitude [1/s²]."""
        displacement = complex(self.row @ motion)
        return w**2 * displacement.conjugate() / abs(displacement)

    def adjoint_load(self, w: float, motion: ComplexArray) -> ComplexArray:
        """Adjoint load -ω² (y* / |y|) s [1/s²]."""
        return np.asarray(self.weight(w, motion) * self.row)

    def by_housing(self, rates: HousingRates, number: int, w: float, motion: ComplexArray) -> float:
        """Differentiate the amplitude as the sensor moves on the housing."""
        change = rates.sensors[number].get(self.sensor)
        if change is None:
            return 0.0
        return (self.weight(w, motion) * complex(change @ motion[self.housing])).real

    def moved(self, rates: HousingRates, number: int, step: float) -> "SensorAmplitude":
        """Move the sensor on the housing."""
        change = rates.sensors[number].get(self.sensor)
        if change is None:
            return self
        row = self.row.copy()
        row[self.housing] += step * change
        return replace(self, row=row)


@dataclass(frozen=True, eq=False)
class SoundPower:
    """Sound power of the housing at one frequency [W].

    Attributes
    ----------
    frequency : float
        Circular frequency ω of the resistance [rad/s].
    resistance : ndarray, shape (h, h)
        Radiation resistance R of the rates of the housing's coordinates [W s²], real and symmetric.
    housing : slice
        Place of the housing's coordinates among those of the machine.
    added : float
        Power by the points that the radiating surface moves with, to first order [W].
    """

    frequency: float
    resistance: FloatArray
    housing: slice
    added: float = 0.0

    decibels = 10.0

    def value(self, w: float, motion: ComplexArray) -> float:
        """Sound power ½ ω² qᴴ R q + `added` [W]."""
        housing_motion = motion[self.housing]
        return 0.5 * w**2 * float((housing_motion.conj() @ self.resistance @ housing_motion).real) + self.added

    def adjoint_load(self, w: float, motion: ComplexArray) -> ComplexArray:
        """Adjoint load ω² R q* [W/m of the coordinates]."""
        load = np.zeros_like(motion)
        load[self.housing] = w**2 * (self.resistance @ motion[self.housing].conj())
        return load

    def by_housing(self, rates: HousingRates, number: int, w: float, motion: ComplexArray) -> float:
        """Differentiate the power by the points that the radiating surface moves with."""
        return rates.powers[number].get(self.frequency, 0.0)

    def moved(self, rates: HousingRates, number: int, step: float) -> "SoundPower":
        """Add the power by the points that the radiating surface moves with."""
        return replace(self, added=self.added + step * rates.powers[number].get(self.frequency, 0.0))
