"""No root is missed, and none invented: the modes of rotors drawn to be hard, against the reference's own count.

The reference is the finite-element model of `finite_element_rotor`, in thirty-one digits, counted by Sylvester's law
of inertia. It is counted just below and just above every frequency found, and at the limit: so each frequency is a
root to 1e-10 of itself, with its multiplicity, and there are no others. Its own error is 1e-13.
Frequencies nearer to each other than that are held together, as one root of their number.

Drawn are shafts of lengths, diameters and materials many decades apart, with cones, axial forces and couplings, discs
that are points or huge, supports from none to rigid, mirrored and nearly mirrored shafts, twins tied by a hair or by
pins, free shafts, tiny segments. The number of examples is `EXAMPLES`, or that of the environment's
NO_MISSED_ROOTS_EXAMPLES.
"""

import itertools
import math
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from finite_element_rotor import PlaneModel, bending_model, rod_model
from hypothesis import HealthCheck, assume, given, reject, settings
from hypothesis import strategies as st

from gearwhine.rotors import (
    AxisSpring,
    Bearing,
    Coupling,
    Disc,
    IncompleteModesError,
    RadialSupport,
    Rotor,
    Segment,
    ShaftMaterial,
    rest_frequencies,
    solve_axial_modes,
    solve_lateral_modes,
    solve_torsional_modes,
)

# As close as the package itself calls two roots one.
CLOSE = 1e-10
# Parts that differ more than this are extreme: a diameter thinner than `HAIR` of another, a disc of `HEAVY` times the
# shaft's own inertia. Then eight digits are kept, as they are of any frequency below `SLOW` of the limit; and the modes
# may be refused, never miscounted.
HAIR, HEAVY, SLOW, CLOSE_IF_EXTREME = 1e-2, 1e8, 1e-6, 1e-7
EXAMPLES = int(os.environ.get("NO_MISSED_ROOTS_EXAMPLES", "24"))
# The suite draws the same rotors each time; a search for new ones is asked for by its number.
MANY = settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize="NO_MISSED_ROOTS_EXAMPLES" not in os.environ,
    suppress_health_check=list(HealthCheck),
)
MATERIALS = [
    ShaftMaterial(207e9, 79.6e9, 7850.0),
    ShaftMaterial(70e9, 26e9, 2700.0),
    ShaftMaterial(100e9, 37e9, 8500.0),
    ShaftMaterial(3e9, 1.1e9, 1400.0),
    ShaftMaterial(5e6, 1.7e6, 1100.0),
]
Case = tuple[Rotor, list[RadialSupport]]


def powers(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers whose decimal logarithms are uniform, four digits each."""
    return st.floats(low, high).map(lambda power: float(f"{10.0**power:.4g}"))


DIFFERENCES = st.sampled_from([0.0, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6])
STIFFNESSES = st.one_of(st.just(math.inf), powers(4.0, 9.0), powers(-1.0, 15.0))
TILTS = st.one_of(st.just(0.0), st.just(0.0), st.just(math.inf), powers(-1.0, 12.0))


@st.composite
def segment_rows(draw: st.DrawFn) -> list[Segment | Coupling]:
    one_material = draw(st.booleans())
    material = draw(st.sampled_from(MATERIALS))
    row: list[Segment | Coupling] = []
    for _ in range(draw(st.integers(1, 5))):
        outer = draw(powers(-2.0, -0.7) | powers(-3.0, -0.5))
        ratio = draw(st.sampled_from([0.0, 0.0, 0.5, 0.95]))
        own = material if one_material else draw(st.sampled_from(MATERIALS))
        part = Segment(draw(powers(-1.3, 0.0) | powers(-5.0, 0.3)), outer, ratio * outer, own)
        kind = draw(st.sampled_from(["cylinder", "cylinder", "cone", "pulled"]))
        if kind == "cone":
            right = outer * draw(st.sampled_from([0.2, 0.7, 1.5, 5.0]))
            part = replace(
                part, right_outer_diameter=right, right_inner_diameter=draw(st.sampled_from([0.8, 1.0])) * ratio * right
            )
        elif kind == "pulled":
            # Up to a hundredth of E A: tension only, for compression may buckle.
            part = replace(part, axial_force=draw(powers(-8.0, -2.0)) * part.section(0.0).axial_stiffness)
        row.append(part)
    if draw(st.integers(0, 5)) == 5:
        spring = draw(powers(4.0, 9.0))
        length = draw(powers(-2.0, -0.5))
        weight = draw(st.sampled_from([0.0, 2.0]))
        tilt, twist = spring * length**2, 0.5 * spring * length**2
        joint = Coupling(length, spring, tilt, twist, spring, weight, 0.1 * weight, 0.06 * weight)
        # One that weighs is under tension: k L is that in which it has half its shear.
        row.append(replace(joint, axial_force=0.5 * weight * spring * length))
        row.append(Segment(0.2, 0.05, 0.0, material))
    # A shaft, not a plate.
    assume(sum(part.length for part in row) > 0.05 * max(thicknesses(row)))
    return row


@st.composite
def disc_sets(draw: st.DrawFn, shaft: Rotor) -> list[Disc]:
    discs = []
    for _ in range(draw(st.integers(0, 3))):
        mass = draw(powers(-1.0, 2.0) | powers(-4.0, 5.0))
        size = draw(st.one_of(st.just(0.0), powers(-2.0, 0.0)))
        discs.append(Disc(draw(places(shaft)), mass, mass * size**2, 0.5 * mass * size**2))
    return discs


def thicknesses(row: Sequence[Segment | Coupling]) -> list[float]:
    """Diameters at both ends of all segments, m."""
    return [outer for part in row if isinstance(part, Segment) for outer, _ in part.end_diameters]


def places(shaft: Rotor) -> st.SearchStrategy[float]:
    """Joints, ends among them, and twelfths of the length."""
    return st.sampled_from([*shaft.joints.tolist(), *(shaft.length * np.arange(13) / 12.0).tolist()])


@st.composite
def any_rotors(draw: st.DrawFn) -> Case:
    shaft = Rotor("any", draw(segment_rows()))
    supports = [
        RadialSupport(draw(places(shaft)), draw(STIFFNESSES), draw(TILTS)) for _ in range(draw(st.integers(0, 3)))
    ]
    return replace(shaft, discs=draw(disc_sets(shaft))), supports


@st.composite
def twins(draw: st.DrawFn) -> Case:
    """A rotor and its mirror image, nearly or exactly, joined end to end, by a hair, or by a pinned shaft."""
    half, supports = draw(any_rotors())
    off = 1.0 + draw(DIFFERENCES)
    joint = draw(st.sampled_from(["nothing", "hair", "pins"]))
    middle: list[Segment] = []
    if joint == "hair":
        middle = [Segment(draw(powers(-2.0, 0.0)), draw(powers(-6.0, -3.0)), 0.0, MATERIALS[0])]
    elif joint == "pins":
        middle = [Segment(0.05, 0.05, 0.0, MATERIALS[0])] * draw(st.integers(1, 12))
    rotor = Rotor("twins", [*half.segments, *middle, *map(turned, half.segments[::-1])])
    length = rotor.length
    discs = [*half.discs]
    discs += [
        Disc(max(length - d.at, 0.0), off * d.mass, off * d.polar_inertia, off * d.diametral_inertia) for d in discs
    ]
    held = [*supports, *(replace(s, at=max(length - s.at, 0.0), stiffness=off * s.stiffness) for s in supports)]
    if joint == "pins":
        first = len(half.segments)
        held += [RadialSupport(float(at), math.inf) for at in rotor.joints[first : first + len(middle) + 1]]
    return replace(rotor, discs=discs), held


def turned(part: Segment | Coupling) -> Segment | Coupling:
    """A segment seen from its other end."""
    if isinstance(part, Coupling) or not part.is_conical:
        return part
    (outer, inner), (right_outer, right_inner) = part.end_diameters
    return replace(
        part,
        outer_diameter=right_outer,
        inner_diameter=right_inner,
        right_outer_diameter=outer,
        right_inner_diameter=inner,
    )


def cases() -> st.SearchStrategy[Case]:
    return any_rotors() | twins()


@contextmanager
def refusal_allowed_of_extremes(rotor: Rotor) -> Iterator[None]:
    """Pass over an extreme rotor whose modes fail their own proof; any other must pass it."""
    try:
        yield
    except IncompleteModesError:
        if not is_extreme(rotor):
            raise
        reject()


def assert_these_are_all(
    frequencies: npt.NDArray[np.float64], limit: float, models: Sequence[PlaneModel], zeros: int, close: float
) -> None:
    """Assert that the frequencies below ``limit`` of the models together are these, each with its multiplicity."""
    elastic = frequencies[zeros:]
    assert (frequencies[:zeros] == 0.0).all()
    each = np.where(elastic < SLOW * limit, CLOSE_IF_EXTREME, close)
    breaks = np.flatnonzero(np.diff(elastic) > 4.0 * each[:-1] * elastic[1:]) + 1
    edges = [0, *breaks.tolist(), elastic.size] if elastic.size else [0]
    probes, expected = [limit], [frequencies.size]
    for first, after in itertools.pairwise(edges):
        probes += [elastic[first] * (1.0 - each[first]), elastic[after - 1] * (1.0 + each[after - 1])]
        expected += [zeros + first, zeros + after]
    counted = sum(model.wittrick_williams_count(probes) for model in models)
    np.testing.assert_array_equal(counted, expected, err_msg=f"at {probes} rad/s")


def is_extreme(rotor: Rotor) -> bool:
    """Whether a section is a hair beside another, or a disc heavy beside the shaft."""
    diameters = thicknesses(rotor.segments)
    heaviest = max((disc.polar_inertia for disc in rotor.discs), default=0.0)
    own = sum(part.polar_inertia for part in rotor.segments)
    return min(diameters) < HAIR * max(diameters) or heaviest > HEAVY * own


def closeness(rotor: Rotor) -> float:
    """Part of each frequency to which it is held."""
    return CLOSE_IF_EXTREME if is_extreme(rotor) else CLOSE


def assert_every_root(
    rotor: Rotor,
    solve: Callable[..., npt.NDArray[np.float64]],
    models: Callable[[float], list[PlaneModel]],
    zeros: int,
    count: int,
    part: float,
) -> None:
    """Assert that ``solve`` has all of the lowest ``count``, and all below a limit beyond them, as the models say.

    The limit is beyond by a ``part`` of the last frequency, or by as little more as keeps it off the next.
    """
    close = closeness(rotor)
    with refusal_allowed_of_extremes(rotor):
        lowest = solve(count=count)
    limit = float(lowest[-1]) * (1.0 + max(part, 4.0 * close)) if lowest[-1] > 0.0 else 1.0
    reference = models(limit * (1.0 + 32.0 * close))
    around = limit * (1.0 + close * np.arange(-2.0, 31.0, 4.0))
    same = np.flatnonzero(np.diff(sum(model.wittrick_williams_count(around) for model in reference)) == 0)
    assume(same.size > 0)
    limit = 0.5 * float(around[same[0]] + around[same[0] + 1])
    with refusal_allowed_of_extremes(rotor):
        found = solve(frequency_limit=limit)
    assert_these_are_all(found, limit, reference, zeros, close)
    np.testing.assert_allclose(found[: lowest.size], lowest, rtol=2.0 * close, atol=CLOSE_IF_EXTREME * SLOW * limit)


PARTS = powers(-9.0, 0.0)


@pytest.mark.slow
@MANY
@given(cases(), st.integers(3, 9), PARTS)
def test_every_root_of_bending(case: Case, count: int, part: float) -> None:
    rotor, supports = case
    assert_every_root(
        rotor,
        lambda **wanted: solve_lateral_modes(rotor, supports, **wanted).frequencies,
        lambda highest: [bending_model(rotor, supports, highest)],
        rigid_motions(rotor, supports),
        count,
        part,
    )


@MANY
@given(cases(), st.integers(3, 8), PARTS)
def test_every_root_of_torsion(case: Case, count: int, part: float) -> None:
    rotor = case[0]
    assert_every_root(
        rotor,
        lambda **wanted: solve_torsional_modes(rotor, **wanted).frequencies,
        lambda highest: [rod_model(rotor, "torsion", highest)],
        1,
        count,
        part,
    )


@MANY
@given(cases(), st.integers(3, 8), PARTS)
def test_every_root_of_axial_motion(case: Case, count: int, part: float) -> None:
    rotor, supports = case
    springs = [AxisSpring(support.at, support.stiffness) for support in supports]
    pairs = [(spring.at, spring.stiffness) for spring in springs]
    assert_every_root(
        rotor,
        lambda **wanted: solve_axial_modes(rotor, springs, **wanted).frequencies,
        lambda highest: [rod_model(rotor, "axial", highest, springs=pairs)],
        0 if springs else 1,
        count,
        part,
    )


@pytest.mark.slow
@MANY
@given(cases(), DIFFERENCES, st.integers(6, 14), PARTS)
def test_every_root_of_both_planes(case: Case, difference: float, count: int, part: float) -> None:
    rotor, supports = case
    bearings = [
        Bearing(str(number), s.at, np.diag([s.stiffness, s.stiffness * (1.0 + difference)]), np.zeros((2, 2)))
        for number, s in enumerate(supports)
        if math.isfinite(s.stiffness)
    ]
    planes = [[bearing.plane_support(plane) for bearing in bearings] for plane in (0, 1)]
    assert_every_root(
        rotor,
        lambda **wanted: rest_frequencies(rotor, bearings, **wanted).frequencies,
        lambda highest: [bending_model(rotor, plane, highest) for plane in planes],
        2 * rigid_motions(rotor, planes[0]),
        count,
        part,
    )


def rigid_motions(rotor: Rotor, supports: Sequence[RadialSupport]) -> int:
    """Two, less what the supports hold of shift and tilt; a pulled shaft resists tilting by itself."""
    held = [support.at for support in supports if support.stiffness > 0.0]
    apart = bool(held) and max(held) - min(held) > 1e-9 * rotor.length
    pulled = any(part.axial_force > 0.0 for part in rotor.segments)
    tilt = pulled or any(support.tilt_stiffness > 0.0 for support in supports)
    return 2 - min(2, (2 if apart else len(held[:1])) + tilt)


def test_the_reference_would_notice_a_missed_root() -> None:
    rotor = Rotor("bar", [Segment(1.0, 0.05, 0.0, MATERIALS[0])])
    modes = solve_lateral_modes(rotor, count=6).frequencies
    limit = 1.01 * float(modes[-1])
    model = bending_model(rotor, [], limit)
    assert_these_are_all(modes, limit, [model], 2, CLOSE)
    doubled = np.sort(np.append(modes, modes[3]))
    moved = modes * np.where(np.arange(6) == 4, 1.0 + 3.0 * CLOSE, 1.0)
    for wrong in (np.delete(modes, 3), doubled, moved):
        with pytest.raises(AssertionError, match="rad/s"):
            assert_these_are_all(wrong, limit, [model], 2, CLOSE)
