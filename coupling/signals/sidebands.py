"""Sidebands of a mesh harmonic: amplitude and phase modulation by a shaft, as by runout or misalignment of a gear.

A harmonic whose strength and phase vary with the shaft's turn, Re C (1 + a(t)) e^{i(wt + b(t))} with small
a = m cos(Ωt + α) and b = β cos(Ωt + γ), has the lines C u at w + Ω and C l at w - Ω. The envelope is
1 + u e^{iΩt} + l e^{-iΩt} ≈ 1 + a + i b, so

    m = |u + l*|    and    β = |u - l*|,

m exactly for a pure modulation of amplitude, β to first order (exactly 2 J₁(β)/J₀(β)); see Randall, *Vibration-based
Condition Monitoring*, 2011.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.signals.spectrum import Window, lines_at
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True)
class Sideband:
    """A pair of sidebands of a carrier.

    Attributes
    ----------
    carrier : float
        Frequency [Hz].
    number : int
        Number of the pair: n for the lines at n times the modulating frequency from the carrier.
    distance : float
        Distance from the carrier [Hz].
    carrier_amplitude, lower, upper : float
        Peak amplitudes in the signal's unit.
    amplitude_modulation : float
        Amplitude modulation m, relative to the carrier; NaN without a carrier.
    phase_modulation : float
        Phase modulation β [rad].
    """

    carrier: float
    number: int
    distance: float
    carrier_amplitude: float
    lower: float
    upper: float
    amplitude_modulation: float
    phase_modulation: float


def sidebands(
    signal: FloatArray,
    interval: float,
    carriers: Sequence[float],
    modulating: float,
    *,
    count: int = 3,
    window: Window = "uniform",
) -> list[Sideband]:
    """Sidebands of a signal of shape (s,), carrier by carrier, nearest first.

    Parameters
    ----------
    signal : ndarray, shape (s,)
    interval : float
        Between samples [s].
    carriers : sequence of float
        Mesh frequency and harmonics [Hz].
    modulating : float
        Frequency of a shaft [Hz].
    count : int
        Number of pairs for each carrier. Pairs that would reach 0 Hz or half the sampling rate are left out.
    window : {"uniform", "hann"}
        Window of the spectrum; uniform where the record holds whole periods of all these lines.

    Raises
    ------
    CouplingError
        Where the modulating frequency is not positive, or the record is too short to separate the lines.
    """
    length = signal.shape[-1] * interval
    apart = 1.0 if window == "uniform" else 2.0
    if not modulating * length >= apart * (1.0 - 1e-9):
        raise CouplingError(
            f"sidebands {modulating:g} Hz apart in a record of {length:g} s; expected one of {apart:g} periods at least"
        )
    places = [
        (carrier, number)
        for carrier in carriers
        for number in range(1, count + 1)
        if carrier - number * modulating > 0.0 and carrier + number * modulating < 0.5 / interval
    ]
    wanted = sorted({carrier + sign * n * modulating for carrier, n in places for sign in (-1, 0, 1)})
    amplitudes = dict(zip(wanted, lines_at(signal, interval, np.array(wanted), window).tolist(), strict=True))
    result = []
    for carrier, number in places:
        middle = amplitudes[carrier]
        lower, upper = amplitudes[carrier - number * modulating], amplitudes[carrier + number * modulating]
        below, above = (complex(np.nan, np.nan),) * 2 if middle == 0.0 else (lower / middle, upper / middle)
        result.append(
            Sideband(
                carrier=carrier,
                number=number,
                distance=number * modulating,
                carrier_amplitude=abs(middle),
                lower=abs(lower),
                upper=abs(upper),
                amplitude_modulation=abs(above + below.conjugate()),
                phase_modulation=abs(above - below.conjugate()),
            )
        )
    return result
