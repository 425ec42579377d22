"""Where a law changes its branch: found in few looks where a pair comes or goes, by halving elsewhere."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from gearwhine.coupling.collocation.arrays import INSIDE, ORDER, POINTS, Reference, element_work
from gearwhine.coupling.collocation.element_kernels import interpolated, law
from gearwhine.coupling.collocation.switch_kernels import branch, by_pairs, next_part, placed
from gearwhine.coupling.connector_forces.kernel_arrays import Contacts
from gearwhine.coupling.gears import Gear, GearPairGeometry, PotentialEnergyStiffness, TipRelief, tooth_contact
from gearwhine.coupling.gears.contact.tooth_force_kernels import ranked_penetration, tooth_force

GEAR = Gear("gear", 28, 3.175e-3, math.radians(20.0), 6.35e-3, tip_relief=TipRelief(2e-5, math.radians(24.0)))
CONTACT = replace(
    tooth_contact(GearPairGeometry(GEAR, GEAR), PotentialEnergyStiffness(), damping=300.0), damping_depth=2e-6
)
LAW, AT = CONTACT.kernel_arguments
LENGTH, NEAR = 1e-4, 1e-14
APART, HELD, FADING, FULL = 0, 1, 2, 3
REFERENCE = Reference(
    np.zeros(0, dtype=np.complex128), np.zeros((0, 1), dtype=np.complex128), *np.zeros((2, 1, 0)), *np.zeros((2, 1)),
    np.full(1, 300.0),
)  # fmt: skip


def contacts(phase: float, turned: float) -> Contacts:
    """One, of some phase at t = 0, that turns by so much through an element [mesh periods]."""
    no, number = np.zeros((1, 0)), np.zeros(1, dtype=np.int64)
    return Contacts(
        direction=no, spans=np.zeros((1, 2), dtype=np.int64), law=LAW, law_at=number + AT, shares_at=number - 1,
        phase=np.array([phase]), mesh_frequency=np.array([turned / LENGTH]), errors=np.zeros((1, 0, 3)),
        clearance=np.zeros(1), friction_row=number - 1, friction=np.zeros((1, 3)), sliding=np.zeros((1, 2)),
    )  # fmt: skip


# A motion that rises first, so that its damping is full for a while, and then parts the flanks.
@example(phase=0.3125, turned=0.25, begin=1e-5, end=0.0, swing=1e-5, before=0.03125, after=1.0)
# Where rounding has how near the flanks are and the law part.
@example(
    phase=0.5972819124346805,
    turned=0.0381913593211316,
    begin=1.7198259610530312e-05,
    end=1.8986978223300205e-05,
    swing=-9.851665412168155e-06,
    before=0.015625,
    after=1.0,
)
@settings(deadline=None, max_examples=400)
@given(
    phase=st.floats(0.0, 1.0),
    turned=st.floats(-0.3, 0.3),
    begin=st.floats(-1e-5, 4e-5),
    end=st.floats(-1e-5, 4e-5),
    swing=st.floats(-1e-5, 1e-5),
    before=st.floats(INSIDE, 0.4),
    after=st.floats(0.6, 1.05),
)
def test_the_branch_is_left_just_there(
    phase: float, turned: float, begin: float, end: float, swing: float, before: float, after: float
) -> None:
    """Through whatever lies between: pairs that come and go, flanks that part, damping that fades or is held back."""
    mesh, work, row = contacts(phase, turned), element_work(0, ORDER, 1), ORDER
    work.delta[:, 0] = begin + (end - begin) * POINTS + swing * np.sin(5.0 * POINTS)
    work.rate[:, 0] = ((end - begin) + 5.0 * swing * np.cos(5.0 * POINTS)) / LENGTH

    def at(u: float) -> int:
        delta, rate = interpolated(work.delta, 0, u), interpolated(work.rate, 0, u)
        law(mesh, 0, min(u * LENGTH, 2.0 * LENGTH), delta, rate, work.laws, row)
        return int(branch(REFERENCE, 0, work.laws, row))

    old, new = at(before), at(after)
    assume(old != new)
    found = placed(REFERENCE, mesh, 0, 0.0, LENGTH, 2.0 * LENGTH, before, after, old, new, NEAR, work)
    assert before < found <= after
    assert at(found) != old
    assert at(found - NEAR) == old or at(found - 2.0 * NEAR) == old


@settings(deadline=None)
@given(st.floats(-3.0, 3.0), st.floats(-1e-5, 6e-5), st.integers(1, 4))
def test_as_many_pairs_touch_as_are_near(phase: float, compression: float, rank: int) -> None:
    touching = tooth_force(phase, compression, 0.0, LAW, AT)[5]
    penetration = ranked_penetration(phase, compression, LAW, AT, rank)
    assert (penetration > 0.0) == (touching >= rank)
    assert ranked_penetration(phase, compression + 1e-6, LAW, AT, rank) - penetration == pytest.approx(
        1e-6, rel=1e-6
    ) or (penetration == -math.inf)
    assert ranked_penetration(phase, compression, LAW, AT, rank + 1) <= penetration


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (4 + FULL, 8 + FULL, True),
        (8 + FULL, 4 + FULL, True),
        # Flanks meet before their damping grows, and part after it has faded.
        (APART, 4 + FULL, True),
        (4 + FADING, APART, True),
        (4 + FULL, APART, False),
        (4 + HELD, APART, False),
        (4 + FULL, 4 + FADING, False),
        (4 + FULL, 8 + FADING, False),
    ],
)
def test_what_the_pairs_tell(old: int, new: int, told: bool) -> None:
    assert by_pairs(old, new) == told


@pytest.mark.parametrize(
    ("curve", "most"),
    [
        (lambda x: x, 6),
        (lambda x: math.exp(8.0 * x) - 1.0, 14),
        (lambda x: math.atan(40.0 * x), 14),
        # So flat that halving is the best: that takes 44 looks.
        (lambda x: x**9, 46),
    ],
)
def test_a_zero_takes_few_looks(curve: Callable[[float], float], most: int) -> None:
    def f(x: float) -> float:
        return curve(x - 0.3)

    x, other, third, part, looks = 1.0, 0.0, 0.0, 0.5, 0
    while abs(x - other) > 1e-13:
        u = x + part * (other - x)
        third, other = (x, other) if (f(u) > 0.0) == (f(x) > 0.0) else (other, x)
        x, looks = u, looks + 1
        part = next_part(x, other, third, f(x), f(other), f(third), 1e-13)
    assert x == pytest.approx(0.3, abs=1e-13)
    assert looks <= most
