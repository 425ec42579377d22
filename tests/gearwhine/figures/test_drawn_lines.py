"""Lines of a spectrum as they are drawn, where there are more of them than a path has points."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from gearwhine.coupling.signals.spectrum import Spectrum
from gearwhine.figures.spectra import draw_lines


@pytest.mark.parametrize("count", [3 * 4096 - 1, 8192, 8193, 20_001])
def test_the_last_lines_below_the_limit_are_drawn(count: int) -> None:
    """One line of 5 among 1e-3: wherever it stands it is the highest that is drawn, at its own frequency."""
    frequencies = 0.25 * np.arange(count + 1)
    for place in (1, count // 2, count - 1, count):
        amplitude = np.full(count + 1, 1e-3)
        amplitude[place] = 5.0
        figure, axes = plt.subplots(figsize=(8.0, 3.0))
        draw_lines(axes, Spectrum(frequencies, amplitude, np.zeros(count + 1), "uniform"), float(frequencies[-1]))
        points = np.concatenate([np.column_stack(line.get_data()) for line in axes.lines]).astype(float)
        highest = points[np.nanargmax(points[:, 1])]
        np.testing.assert_allclose(highest, [frequencies[place], 5.0])
        plt.close(figure)
