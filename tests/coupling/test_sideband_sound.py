"""Sound of sidebands by turning carriers: each radiates at its own frequency, by the resistance of the modes there."""

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.coupling.linear.carriers.carrier_sidebands import Sideband
from gearwhine.coupling.linear.line_outputs import SoundPower
from gearwhine.coupling.linear.mesh_harmonics import Response
from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.coupling.sound.mesh_harmonics import sideband_sounds
from gearwhine.coupling.sound.solution import build_radiation
from gearwhine.housing.acoustics.power_gradient import PowerGradient
from gearwhine.housing.acoustics.sound_levels import a_weighting
from gearwhine.meshes import BoxGeometry, WallThickness

TURN = 11.0  # Hz
HARMONIC = 900.0
BEFORE = 4
"""Coordinates of rotors before those of the housing."""


def test_sidebands_have_the_power_of_their_own_frequencies() -> None:
    box = BoxGeometry((0.2, 0.15, 0.18), WallThickness(*[0.02] * 6))
    modes = gw.Housing.from_box(box, 0.06, gw.STEEL).modes(count=9)
    acoustics = Acoustics(mesh_size=0.05, highest_frequency=1.1e3)
    radiation = build_radiation(acoustics, modes.displacement_field)
    count = radiation.modal[0].shape[1]
    housing = slice(BEFORE, BEFORE + count)
    generator = np.random.default_rng(3)
    shape = generator.standard_normal(BEFORE + count) + 1j * generator.standard_normal(BEFORE + count)
    responses = [
        Response(
            2.0 * np.pi * (HARMONIC + turns * TURN),
            ((0, 1),),
            size * 1e-9 * shape,
            sidebands=(Sideband((("carrier", turns),)),),
        )
        for turns, size in ((-3.0, 1.0), (0.0, 0.5), (3.0, 2.0), (-81.0, 1e3))
    ]
    found = sideband_sounds(responses, housing, radiation)
    # The one of 9 Hz is not heard.
    assert [round(dict(one.response.sidebands[0].turns)["carrier"]) for one in found] == [3, -3, 0]
    for one in found:
        w = one.response.frequency
        resistance = PowerGradient.at(radiation, w / (2.0 * np.pi)).resistance
        expected = SoundPower(w, resistance, housing).value(w, one.response.motion)
        assert one.power == pytest.approx(expected, rel=1e-9)
        weighting = 10.0 ** (0.1 * a_weighting(w / (2.0 * np.pi)))
        assert one.weighted_power == pytest.approx(weighting * expected, rel=1e-9)
    # At one frequency both would differ by the squares of their sizes alone.
    assert found[0].power / found[1].power != pytest.approx(4.0, rel=1e-2)
