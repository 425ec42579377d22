"""Loudest mesh harmonics of a case's sound: lines of its machine that is linear about its operating point.

Candidates are the mesh harmonics of the most power by an estimate; their sound is solved, and the loudest by their
A-weighted power are taken. Of these the sound of every mode and residual mode is known, and with it the gradient of
the power, :mod:`gearwhine.housing.acoustics.power_gradient`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.linear.line_outputs import SoundPower
from gearwhine.coupling.linear.line_sensitivity import Line, LineModel
from gearwhine.coupling.linear.mesh_harmonics import Response
from gearwhine.coupling.sound.motion_lines import AUDIBLE, pulsating_efficiency
from gearwhine.housing.acoustics.power_gradient import PowerGradient
from gearwhine.housing.acoustics.radiation import HousingRadiation, RadiatedSound
from gearwhine.housing.acoustics.sound_levels import a_weighting
from gearwhine.numerics.arrays import ComplexArray, FloatArray

LINES = 3
"""Number of lines of the sound, the loudest ones."""

_CANDIDATES = 6  # lines that are solved to find the loudest
_TWO_PI = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class HarmonicSound:
    """Sound power of a mesh harmonic, and its gradient.

    Attributes
    ----------
    line : Line
        Line whose output is a :class:`gearwhine.coupling.linear.line_outputs.SoundPower`.
    power : PowerGradient
        Gradient of the power at its frequency.
    """

    line: Line
    power: PowerGradient

    @property
    def weighting(self) -> float:
        """Factor of the power by the frequency weighting A."""
        return float(10.0 ** (0.1 * a_weighting(self.power.unit.frequency_hz)))

    @property
    def rates(self) -> ComplexArray:
        """Rates q̇ of the housing's coordinates."""
        output = self.line.output
        assert isinstance(output, SoundPower)
        return np.asarray(1j * self.line.frequency * self.line.motion[output.housing])

    @property
    def sound(self) -> RadiatedSound:
        """Sound of the line, superposed of the modes."""
        return self.power.sound(self.rates)

    def nodal_load(self) -> ComplexArray:
        """Adjoint load of the power on the housing's nodes, shape (3 n_nodes,)."""
        return self.power.nodal_load(self.rates)

    def by_sliding(self, motion: ComplexArray, velocity: FloatArray) -> float:
        """Differentiate the power as the mesh slides along the radiating surface, its nodes' motion given."""
        return self.power.by_sliding(self.rates, motion, velocity)


def loudest_lines(
    model: LineModel, radiation: HousingRadiation, limit: float, chosen: Sequence[float] | None = None
) -> tuple[HarmonicSound, ...]:
    """Solve for the sound of the loudest mesh harmonics, the loudest first.

    Parameters
    ----------
    model : LineModel
    radiation : HousingRadiation
        Radiation with the modes and residual modes of its housing.
    limit : float
        Highest frequency [rad/s].
    chosen : sequence of float, optional
        Frequencies of the lines [rad/s], if they are known.

    Raises
    ------
    gearwhine.housing.HousingError
        Where a line fails its proofs, see :meth:`gearwhine.housing.acoustics.radiation.RadiatedSound.require_proofs`.
    """
    responses = [response for response in model.responses(limit) if response.frequency >= _TWO_PI * AUDIBLE]
    if chosen is None:
        responses = _candidates(model.housing, radiation, responses)
    else:
        responses = [response for response in responses if response.frequency in chosen]
    sounds = []
    for response in responses:
        power = PowerGradient.at(radiation, response.frequency / _TWO_PI)
        output = SoundPower(response.frequency, power.resistance, model.housing)
        if output.value(response.frequency, response.motion) > 0.0:
            sounds.append(HarmonicSound(model.line(output, response), power))
    sounds.sort(key=lambda sound: -sound.weighting * sound.line.value)
    for loud in sounds[:LINES]:
        loud.sound.require_proofs()
    return tuple(sounds[:LINES])


def _candidates(housing: slice, radiation: HousingRadiation, responses: Sequence[Response]) -> list[Response]:
    """Return the responses of the most A-weighted power by an estimate."""
    if not responses:
        return []
    hertz = np.array([response.frequency for response in responses]) / _TWO_PI
    rates = np.array([1j * response.frequency * response.motion[housing] for response in responses]).T
    efficiency = pulsating_efficiency(hertz, radiation.area, radiation.medium.speed_of_sound)
    estimate = radiation.equivalent_power(rates) * efficiency * 10.0 ** (0.1 * a_weighting(hertz))
    order = np.argsort(-estimate, kind="stable")[:_CANDIDATES]
    return [responses[n] for n in order]
