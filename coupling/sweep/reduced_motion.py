"""Motion of a machine, reduced to the quantities that a sweep collects over its points."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from gearwhine.coupling.analyses.transient import SolvedTransient
from gearwhine.coupling.signals.line_names import LineName
from gearwhine.coupling.signals.spectrum import Window
from gearwhine.coupling.sweep.resonances import Resonances, find_resonances
from gearwhine.numerics.arrays import FloatArray

if TYPE_CHECKING:
    from gearwhine.coupling.sound.acoustics import Acoustics

_TWO_PI = 2.0 * np.pi


@dataclass(frozen=True)
class ReducedMotion:
    """A motion, reduced to the quantities that a sweep collects.

    Attributes
    ----------
    orders : ndarray, shape (m,)
        Lines of the spectra, in cycles for each turn of the first driver, up to the trusted limit. The record holds a
        number of its turns, so these are the same at every speed.
    sensor_spectra : dict of str to ndarray, shape (m,)
        Peak amplitude of acceleration [m/s²].
    force_spectra : dict of str to ndarray, shape (m,)
        Peak amplitude of the gear-mesh force [N], its mean at order zero.
    bearing_force_mean, bearing_force_rms : dict of str to ndarray, shape (5,)
        Mean loads along x, y, z [N] and about x, y [N m], and their rms values without the mean.
    housing_frequencies_hz : ndarray, shape (n_modes,)
        Natural frequencies of the housing [Hz]; empty without a housing.
    window : {"uniform", "hann"}
        Window of the spectra.
    line_frequencies : ndarray, shape (l,)
        Frequencies of the lines whose sound is wanted [Hz]; empty without acoustics.
    line_rates : ndarray, shape (l, n, 2)
        Rates of the housing's coordinates there, real and imaginary part.
    line_names, line_kinds : tuple of str
        Names and causes of these lines, see :class:`gearwhine.coupling.signals.line_names.LineName`.
    resonances : Resonances or None
        Resonances of the machine, linear about its mean contact; None where no mesh drives a sensor or a sound.
    """

    orders: FloatArray
    sensor_spectra: dict[str, FloatArray] = field(default_factory=dict)
    force_spectra: dict[str, FloatArray] = field(default_factory=dict)
    bearing_force_mean: dict[str, FloatArray] = field(default_factory=dict)
    bearing_force_rms: dict[str, FloatArray] = field(default_factory=dict)
    housing_frequencies_hz: FloatArray = field(default_factory=lambda: np.empty(0))
    window: Window = "uniform"
    line_frequencies: FloatArray = field(default_factory=lambda: np.empty(0))
    line_rates: FloatArray = field(default_factory=lambda: np.empty((0, 0, 2)))
    line_names: tuple[str, ...] = ()
    line_kinds: tuple[str, ...] = ()
    resonances: Resonances | None = None


def reduce_motion(solved: SolvedTransient, acoustics: "Acoustics | None" = None) -> ReducedMotion:
    """Reduce a motion; ``acoustics`` are those of its sound, where that is wanted."""
    turning_hz = abs(solved.speed) / _TWO_PI
    machine, forces = solved.machine, solved.histories.bearing_load
    spectra = [*solved.sensor_spectra.values(), *solved.force_spectra.values()]
    lines = spectra[0].frequencies if spectra else np.empty(0)
    count = int(np.searchsorted(lines, solved.trusted_limit * (1.0 + 1e-9), side="right"))
    contacts = machine.system.contacts
    # Forces have the drive flanks' name at every point, whichever flanks are loaded there.
    pressed = {contacts[i].name: contacts[number].name for i, number in enumerate(machine.loaded_contacts)}
    frequencies, rates, names = sounding_lines(solved, acoustics)
    return ReducedMotion(
        orders=lines[:count] / turning_hz,
        sensor_spectra={name: spectrum.amplitude[:count] for name, spectrum in solved.sensor_spectra.items()},
        force_spectra={name: solved.force_spectra[contact].amplitude[:count] for name, contact in pressed.items()},
        bearing_force_mean={name: force.mean(axis=0) for name, force in forces.items()},
        bearing_force_rms={name: force.std(axis=0) for name, force in forces.items()},
        housing_frequencies_hz=np.empty(0) if machine.housing is None else machine.housing.frequencies_hz,
        window=spectra[0].window if spectra else "uniform",
        line_frequencies=frequencies,
        line_rates=rates,
        line_names=tuple(line.name for line in names),
        line_kinds=tuple(line.kind for line in names),
        resonances=find_resonances(
            machine, solved.trusted_limit, speed_of_sound=None if acoustics is None else acoustics.speed_of_sound
        ),
    )


def sounding_lines(
    solved: SolvedTransient, acoustics: "Acoustics | None"
) -> tuple[FloatArray, FloatArray, list[LineName]]:
    """Return the strongest lines of a motion, for its sound; none where that is not wanted or is left out.

    See :func:`gearwhine.coupling.sound.motion_lines.strongest_lines`.
    """
    machine = solved.machine
    steady = machine.speed_profile is None and machine.loads.base is None
    if acoustics is None or machine.housing is None or not steady:
        return np.empty(0), np.empty((0, 0, 2)), []
    from gearwhine.coupling.sound.motion_lines import strongest_lines

    return strongest_lines(acoustics, solved)
