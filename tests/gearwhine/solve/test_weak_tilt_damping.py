"""A damping force of a bearing that turns with its tilt, which hardly moves the roots of a shaft."""

import numpy as np

import gearwhine as gw


def test_the_rates_of_whirl_hardly_move() -> None:
    # Roots in pairs at rest: on the way to one, a correction of exactly zero tells no order of convergence.
    damped = gw.load("helical-pair", {"bearing[2].damping.matrix[3][0]": 1}).rotors().dataset
    without = gw.load("helical-pair").rotors().dataset
    shaft = {"rotor": "output"}
    frequencies = [one["campbell_frequency"].sel(shaft).values for one in (damped, without)]
    assert np.isfinite(frequencies[0]).sum() == np.isfinite(frequencies[1]).sum() > 50
    np.testing.assert_allclose(*frequencies, rtol=3e-4)
    np.testing.assert_array_equal(*(one["rotor_rest_frequency"].sel(shaft).values for one in (damped, without)))
