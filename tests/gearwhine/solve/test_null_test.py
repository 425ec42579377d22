"""Test of an update by random frequencies: the parts of the random sets that are fitted as well."""

import numpy as np

from gearwhine.housing.updating import NullFit
from gearwhine.solve.updating import NullTest


def fit(rms: float, largest: float, gap: float = 0.5, *, agree: bool = True, met: bool = False) -> NullFit:
    return NullFit(np.array([1.0]), rms, largest, gap, agree, 1, met)


def test_parts_of_random_sets_are_counted_by_their_own_errors() -> None:
    """Of four sets, errors by hand: one within 1 %, three within 2 % (one a clear choice), four within 5 %."""
    fits = [fit(0.5, 0.9, gap=0.05), fit(1.0, 1.8, met=True), fit(1.4, 2.0, agree=False), fit(3.0, 4.0)]
    test = NullTest(fit(1.2, 1.9), fits)
    assert [test.within(percent) for percent in (1.0, 2.0, 5.0)] == [0.25, 0.75, 1.0]
    assert test.within(2.0, clear=True) == 0.25
    assert test.as_good_in_rms == 0.5
    assert test.all_met == 0.25
    assert test.median_rms_percent == 1.2
