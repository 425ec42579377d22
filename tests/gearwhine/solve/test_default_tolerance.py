"""The default tolerance of a transient: what is reported to 0.1 dB does not depend on it."""

import numpy as np
import pytest
from coupled_cases import coupled
from scipy.signal import argrelmax

from gearwhine.case import load_case
from gearwhine.coupling.analyses.transient import SolvedTransient, solve_transient
from gearwhine.solve.machine import plan_of


def solved(tolerance: str) -> SolvedTransient:
    settings = ("transient.revolutions=12", "transient.discard=10", f"transient.tolerance={tolerance}")
    case = load_case("helical-pair", settings).case
    return solve_transient(coupled(case), plan_of(case))


@pytest.mark.slow
def test_levels_do_not_depend_on_it() -> None:
    """Peaks within 40 dB of the highest agree with a march of seven times the steps to half of the last digit told."""
    default, fine = solved(""), solved("5e-6")
    assert default.result.steps * 7 < fine.result.steps
    for name, spectrum in fine.force_spectra.items():
        trusted = (spectrum.frequencies > 0.0) & (spectrum.frequencies <= fine.trusted_limit)
        reference, found = spectrum.amplitude[trusted], default.force_spectra[name].amplitude[trusted]
        if not reference.any():
            continue
        (peaks,) = argrelmax(reference)
        peaks = peaks[reference[peaks] > 1e-2 * reference.max()]
        assert peaks.size >= 3
        assert np.abs(20.0 * np.log10(found[peaks] / reference[peaks])).max() < 0.05
