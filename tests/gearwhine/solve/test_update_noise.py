"""A fit that leaves more than the noise explains says that its standard deviations are too small."""

import numpy as np

from gearwhine.housing.updating import UNPAIRED, Misfit
from gearwhine.solve.updating import noise_warnings


def misfit(*errors: float) -> Misfit:
    pairs = [UNPAIRED if np.isnan(error) else number for number, error in enumerate(errors)]
    return Misfit(1.0, np.array(pairs), np.array(errors), 1.0, 1.0, 0)


def test_residuals_beyond_the_noise_are_told() -> None:
    noise = np.full(4, 0.005)
    assert noise_warnings(misfit(0.009, -0.004, 0.0, np.nan), noise) == []
    (told,) = noise_warnings(misfit(0.004, -0.011, 0.0101, np.nan), noise)
    assert told["name"] == "fit beyond noise"
    assert told["frequencies"] == 2
    assert "2 of 3 frequencies" in told["message"]
    assert "the worst by 1.10 % where frequency_noise is 0.5 %" in told["message"]
    # A frequency that takes no part explains nothing.
    assert noise_warnings(misfit(0.004, -0.011, 0.0), np.array([0.005, np.inf, 0.005])) == []
