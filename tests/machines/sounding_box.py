"""A coarse steel box and its sound: seven lines of two forces on its bores, without rotors."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

import gearwhine as gw
from gearwhine.analyses.result import Result
from gearwhine.coupling.sound.solution import SolvedSound, SoundLine

PLACES = [("1.2 m", "0.3 m", "0 m"), ("0 m", "1.3 m", "0 m"), ("0.1 m", "0.2 m", "-1.4 m")]
COARSE: dict[str, Any] = {
    "housing.box.mesh_size": "45 mm",
    "acoustics.mesh_size": "45 mm",
    "acoustics.highest_frequency": "2.3 kHz",
    "acoustics.microphone": [{"name": f"ear {n}", "position": list(at)} for n, at in enumerate(PLACES, start=1)],
}
NAMES = {
    92.0: "1× input",
    520.0: "2× input",
    1000.0: "1× pinion -> wheel",
    1560.0: "2× pinion -> wheel - 1× input",
    1645.0: "2× pinion -> wheel",
    2100.0: "3× pinion -> wheel - 1× input",
    2300.0: "3× pinion -> wheel",
}


@cache
def sound_of_modes() -> Result[SolvedSound]:
    """Sound of the modes alone, with microphones."""
    return gw.load("steel-box", COARSE).sound()


@cache
def sound_of_lines() -> SolvedSound:
    """The same with lines: modes driven at random by two forces, 1 % of damping."""
    solved = sound_of_modes().solved
    natural, generator = 2.0 * np.pi * solved.mode_frequencies, np.random.default_rng(1)
    count = solved.radiation.modal[0].shape[1]
    lines = []
    for hertz, name in NAMES.items():
        omega = 2.0 * np.pi * hertz
        gains = 20.0 * omega / (natural**2 - omega**2 + 0.02j * natural * omega)
        rates = np.zeros((count, 2), dtype=complex)
        rates[: len(natural)] = gains[:, None] * generator.standard_normal((len(natural), 2))
        rates[len(natural) :] = 1e-6
        sound = solved.radiation.solve(hertz, rates)
        places = np.array(list(solved.microphones.values()))
        heard, off = sound.pressure_at(places), sound.source_error_at(places)
        lines.append(SoundLine(hertz, name, hertz / 92.0, sound, heard, off))
    return replace(solved, lines=tuple(lines), bearings=("front bore", "back bore"), covered=0.97)
