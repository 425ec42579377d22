"""Sound of a housing's modes over a floor: radiation efficiency, sound power, and what nine microphones would measure.

The microphones stand on a box around the housing, as ISO 3744 has them. Pure tones have lobes that nine places miss by
some decibels; over several modes together the measurement comes near.
"""

import numpy as np

import gearwhine as gw
from gearwhine.housing.acoustics.sound_levels import measurement_box, power_level, pressure_level, sum_of_levels

COARSE = {"housing.box.mesh_size": "45 mm", "acoustics.mesh_size": "45 mm", "acoustics.floor": "-22 mm"}
study = gw.load("steel-box", COARSE | {"acoustics.highest_frequency": "2.3 kHz"})
sound = study.sound()

radiation = sound.solved.radiation
places, area = measurement_box(*study.housing.mesh.bounds, 1.0)  # 1 m away
solved, powers, measured = [], [], []
for mode in sound.solved.modes:
    rates = np.zeros(radiation.modal[0].shape[1])
    rates[mode.number - 1] = 1e-3  # of the mode's coordinate [m √kg/s]
    solved.append(radiation.solve(mode.frequency_hz, rates))
    powers.append(float(power_level(solved[-1].power)))
    mean = sum_of_levels(pressure_level(solved[-1].pressure_at(places))) - 10.0 * np.log10(len(places))
    measured.append(float(mean + 10.0 * np.log10(area)))
    faces = ", ".join(f"{face} {100.0 * part:.0f} %" for face, part in list(mode.face_shares.items())[:3])
    print(f"mode {mode.number}, {mode.frequency_hz:.0f} Hz: efficiency {mode.radiation_efficiency:.2f}; {faces}")
    print(f"  {powers[-1]:.1f} dB re 1 pW, by the microphones {measured[-1]:.1f} dB")
print(f"all modes: {sum_of_levels(powers):.1f} dB re 1 pW, by the microphones {sum_of_levels(measured):.1f} dB")
