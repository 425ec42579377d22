"""Sizes of a refinement: by the order that the errors show, and no further than meshes that can be solved."""

import pytest

from gearwhine.housing import HousingError
from gearwhine.housing.mesh_refinement import RefinementStep, next_size


def test_steps_follow_the_order_that_errors_show() -> None:
    """h (0.85 a / e)^(1/q): q = 2 at first, then as two steps have it; never less than 0.4, never more than 0.85."""
    first = RefinementStep(0.02, 10_000, 8, 0.02)
    assert next_size([first], 0.01) == pytest.approx(0.02 * (0.425) ** 0.5)
    second = RefinementStep(0.01, 60_000, 8, 0.014)
    order = 0.5145731728  # log2(0.02 / 0.014), below the least that is believed
    assert order < 0.7
    assert next_size([first, second], 0.01) == pytest.approx(0.01 * (0.85 / 1.4) ** (1 / 0.7))
    assert next_size([RefinementStep(0.02, 10_000, 8, 0.4)], 0.05) == pytest.approx(0.02 * 0.4)


def test_what_no_mesh_reaches_is_refused_with_what_was_reached() -> None:
    with pytest.raises(HousingError, match=r"such as '2\.2 %' of elements of 5 mm with 355914 degrees of freedom"):
        next_size([RefinementStep(0.013, 61_071, 12, 0.035), RefinementStep(0.005, 355_914, 12, 0.022)], 0.002)
    creeping = [RefinementStep(0.02 * 0.9**n, 1000, 8, 0.05) for n in range(8)]
    creeping[-2] = RefinementStep(0.02, 1000, 8, 0.06)
    with pytest.raises(HousingError, match="8 meshes do not come near"):
        next_size(creeping, 0.04)
