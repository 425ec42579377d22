"""Sound of single lines of motions, each by the rates of the housing's coordinates: solved, or interpolated.

A sweep has thousands of lines, so that of each only figures are kept. Its radiation over frequency may be known as a
table (:mod:`gearwhine.housing.acoustics.modal_radiation`), which gives the figures where its interpolation and its
proofs hold.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.sound.motion_lines import pulsating_efficiency
from gearwhine.coupling.sound.proofs import (
    doubts,
    interior_pressure,
    known_source,
    known_source_at,
    microphone_doubts,
    power_balance_db,
)
from gearwhine.housing import HousingError
from gearwhine.housing.acoustics.modal_radiation import ModalRadiation
from gearwhine.housing.acoustics.radiation import (
    LEAK,
    POWERS_AGREE,
    SOURCE_HEARD,
    SOURCE_OFF,
    HousingRadiation,
    RadiatedSound,
)
from gearwhine.housing.acoustics.sound_levels import a_weighting, power_level, sum_of_levels
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.result_warnings import ResultWarning

_FAINT = 1e-6  # part of the power of all lines that is left out
_LARGEST_INTERPOLATION_ERROR = 0.02  # estimated error of an interpolation up to which it holds: a tenth of a decibel


@dataclass(frozen=True, eq=False)
class LineSound:
    """Figures of the sound of a line.

    Attributes
    ----------
    frequency_hz : float
    power, surface_power : float
        Sound power in the far field and through the surface [W].
    radiation_efficiency : float
    heard : mapping of str to complex
        Pressure at each microphone [Pa], peak.
    by_mode : ndarray, shape (n,)
        Part of each mode and residual mode in the power [W].
    power_balance_db : float or None
        Level of the power through the surface over that in the far field [dB].
    interior_pressure : float or None
        Pressure inside the closed surface over that on it.
    known_source_error, known_source_rms : float or None
        Largest and root-mean-square error at the vertices of the pressure of a known source inside.
    warnings : tuple of dict
    refused : HousingError or None
        Refusal of its proofs.
    """

    frequency_hz: float
    power: float
    surface_power: float
    radiation_efficiency: float
    heard: Mapping[str, complex]
    by_mode: FloatArray
    power_balance_db: float | None = None
    interior_pressure: float | None = None
    known_source_error: float | None = None
    known_source_rms: float | None = None
    warnings: tuple[ResultWarning, ...] = ()
    refused: HousingError | None = None


def line_sound(sound: RadiatedSound, positions: Mapping[str, FloatArray]) -> LineSound:
    """Return the figures of a solved sound, with microphones at positions [m], without the sound itself."""
    refused = None
    try:
        sound.require_proofs()
    except HousingError as error:
        refused = error
    places = np.array(list(positions.values())).reshape(-1, 3)
    heard = sound.pressure_at(places) if len(places) else np.zeros(0, dtype=np.complex128)
    proof, off = known_source(sound), known_source_at(sound, places)
    warnings = doubts(sound, "a line")
    if off is not None:
        warnings += microphone_doubts(sound.frequency_hz, dict(zip(positions, off.tolist(), strict=True)))
    return LineSound(
        sound.frequency_hz,
        sound.power,
        sound.surface_power,
        sound.radiation_efficiency,
        dict(zip(positions, heard, strict=True)),
        sound.by_mode,
        power_balance_db(sound),
        interior_pressure(sound),
        None if proof is None else proof.largest,
        None if proof is None else proof.rms,
        tuple(warnings),
        refused,
    )


def interpolated_line_sound(
    table: ModalRadiation,
    radiation: HousingRadiation,
    hertz: float,
    rates: ComplexArray,
    positions: Mapping[str, FloatArray],
) -> LineSound | None:
    """Return the figures of a line by interpolation; None where that or a proof is doubtful.

    Parameters
    ----------
    table : ModalRadiation
        Radiation of the modes over frequency, with the microphones as its points.
    radiation : HousingRadiation
    hertz : float
    rates : ndarray of complex, shape (n,)
        Rates of the housing's coordinates.
    positions : mapping of str to ndarray, shape (3,)
        Microphones [m].
    """
    if not table.holds(hertz):
        return None
    power, surface_power, error = table.power(hertz, rates)
    leak, off, rms, heard_off = (
        table.around(hertz, values)
        for values in (table.interior_residual, table.source_error, table.source_rms, table.point_source_error)
    )
    if (
        max(error, table.pressure_error) > _LARGEST_INTERPOLATION_ERROR
        or abs(surface_power / power - 1.0) > POWERS_AGREE
    ):
        return None
    if leak > LEAK or off > SOURCE_OFF or heard_off > SOURCE_HEARD:
        return None
    heard = table.pressure_at(np.array([hertz]))[0] @ rates
    efficiency = power / float(radiation.equivalent_power(rates[:, None])[0])
    by_elements = radiation.method == "boundary-elements"
    return LineSound(
        hertz,
        power,
        surface_power,
        efficiency,
        dict(zip(positions, heard, strict=True)),
        table.by_mode(hertz, rates),
        float(power_level(surface_power) - power_level(power)),
        leak if by_elements else None,
        off if by_elements else None,
        rms if by_elements else None,
    )


def radiated_level(
    radiation: HousingRadiation, table: ModalRadiation | None, hertz: float, rates: ComplexArray
) -> float:
    """Sound power level of rates of the housing's coordinates without a solution [dB].

    Interpolated where the radiation is known over frequency, else by their equivalent power.
    """
    if table is not None and table.holds(hertz):
        power, _, error = table.power(hertz, rates)
        if error <= _LARGEST_INTERPOLATION_ERROR:
            return float(power_level(power))
    sphere = pulsating_efficiency(np.array([hertz]), radiation.area, radiation.medium.speed_of_sound)
    return float(power_level(radiation.equivalent_power(rates[:, None])[0] * sphere[0]))


@dataclass(frozen=True, eq=False)
class RadiatedPower:
    """Radiation of a housing, by which the sound power of lines follows without a further solution.

    Attributes
    ----------
    radiation : HousingRadiation
    table : ModalRadiation or None
        Radiation over frequency; None of the method ``erp``, whose power is the equivalent one.
    lowest_hz, highest_hz : float
        Range of the sound; lines outside are left out [Hz].
    """

    radiation: HousingRadiation
    table: ModalRadiation | None
    lowest_hz: float
    highest_hz: float

    def levels(self, hertz: FloatArray, rates: ComplexArray) -> tuple[float, float]:
        """Sound power level of lines together, and that by the frequency weighting A [dB re 1 pW].

        Parameters
        ----------
        hertz : ndarray, shape (l,)
        rates : ndarray of complex, shape (l, n)
            Rates of the housing's coordinates.
        """
        heard = (hertz >= self.lowest_hz) & (hertz <= self.highest_hz)
        hertz, rates = hertz[heard], rates[heard]
        # Lines between mesh harmonics may be thousands, of which few are of any matter.
        estimate = self.radiation.equivalent_power(rates.T)
        if self.radiation.method != "erp":
            sound_speed = self.radiation.medium.speed_of_sound
            estimate = estimate * pulsating_efficiency(hertz, self.radiation.area, sound_speed)
        loud = _loud(estimate) | _loud(estimate * 10.0 ** (0.1 * a_weighting(hertz)))
        single = [
            (level, level + float(a_weighting(frequency)))
            for frequency, rate in zip(hertz[loud].tolist(), rates[loud], strict=True)
            if np.isfinite(level := self._level(frequency, rate))
        ]
        return sum_of_levels(one for one, _ in single), sum_of_levels(one for _, one in single)

    def _level(self, hertz: float, rates: ComplexArray) -> float:
        if self.radiation.method == "erp":
            return float(power_level(self.radiation.equivalent_power(rates[:, None])[0]))
        return radiated_level(self.radiation, self.table, hertz, rates)


def _loud(power: FloatArray) -> npt.NDArray[np.bool_]:
    """Whether lines are among those that have all but a millionth of the power together."""
    order = np.argsort(-power)
    left = power.sum() - np.cumsum(power[order])
    loud = np.zeros(len(power), dtype=np.bool_)
    loud[order[: 1 + np.count_nonzero(left > _FAINT * power.sum())]] = True
    return loud
