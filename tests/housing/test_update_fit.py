"""Parameters, misfit, search and posterior, on systems whose answers are known in closed form."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.housing import HousingError
from gearwhine.housing.updating import (
    UNPAIRED,
    Effort,
    ModalState,
    ModeCount,
    Parameter,
    Procedure,
    Surrogate,
    Target,
    leave_one_out,
    measure,
    null_fits,
    posterior,
    search,
    values_at,
)
from gearwhine.housing.updating.cross_validation import random_frequencies
from gearwhine.housing.updating.misfit import is_met
from gearwhine.housing.updating.parameters import coordinate_bounds
from gearwhine.housing.updating.trust_region import Design
from gearwhine.numerics.arrays import FloatArray

# Three uncoupled oscillators, ω_i = ω0_i exp(½ z_i): the surrogate is exact, and so is every answer.
OWN = np.array([100.0, 200.0, 300.0])
FREE = [Parameter(name, 0.01, 100.0, 1.0, 1.0) for name in "abc"]


@dataclass(frozen=True)
class Oscillators:
    """Springs e^(s z) on unit masses, with strengths of their own; s is the slope of ln λ by z."""

    coordinates: FloatArray
    slope: float = 1.0
    strengths: tuple[float, ...] = (3.0, 2.0, 1.0)

    def surrogate(self) -> Surrogate:
        n = len(OWN)
        rates = np.zeros((n, n, n))
        rates[np.arange(n), np.arange(n), np.arange(n)] = self.slope
        strengths = np.array(self.strengths)
        state = ModalState(OWN, np.stack([strengths, 0 * strengths], axis=1)[:, None], np.diag(strengths), np.eye(n))
        return Surrogate(np.zeros(n), state, rates, np.zeros((n, n, n)))

    @property
    def state(self) -> ModalState:
        return self.surrogate().at(self.coordinates).state


def solve(coordinates: FloatArray, near: Design | None) -> Oscillators:
    return Oscillators(coordinates)


def target_at(frequencies: Sequence[float], noise: float = 0.01, **more: object) -> Target:
    measured = np.array(frequencies)
    return replace(Target(measured, np.full(len(measured), noise), (1.0, 1e4)), **more)


@given(st.floats(1e-3, 1e3), st.floats(1.01, 10.0), st.floats(1.01, 10.0), st.floats(0.05, 2.0), st.floats(0.0, 1.0))
@settings(deadline=None, max_examples=25)
def test_coordinates_go_back_and_forth(nominal: float, down: float, up: float, spread: float, part: float) -> None:
    parameter = Parameter("p", nominal / down, nominal * up, nominal, spread * nominal)
    value = parameter.low + part * (parameter.high - parameter.low)
    assert parameter.value(parameter.coordinate(value)) == pytest.approx(value)
    assert parameter.coordinate(nominal) == 0.0
    assert parameter.coordinate(nominal * (1.0 + spread)) == pytest.approx(1.0)
    assert parameter.value(1e3) == pytest.approx(parameter.high)
    assert parameter.value(-1e3) == pytest.approx(parameter.low)


def test_a_parameter_of_either_sign_is_linear() -> None:
    parameter = Parameter("offset", -2.0, 3.0, 1.0, 0.5)
    assert parameter.bounds == pytest.approx((-6.0, 4.0))
    assert parameter.value(2.0) == pytest.approx(2.0)
    assert values_at([parameter, parameter], np.array([0.0, -2.0])) == pytest.approx([1.0, 0.0])
    assert coordinate_bounds([parameter]).shape == (2, 1)


@pytest.mark.parametrize(
    ("numbers", "said"),
    [((2.0, 1.0, 1.5, 1.0), "ascending"), ((1.0, 2.0, 3.0, 1.0), "within"), ((1.0, 2.0, 1.5, 0.0), "spread")],
)
def test_wrong_parameters_are_refused(numbers: tuple[float, float, float, float], said: str) -> None:
    with pytest.raises(HousingError, match=said):
        Parameter("p", *numbers)


def test_the_misfit_is_the_sum_that_it_says() -> None:
    z = np.array([0.1, -0.2, 0.3])
    model = OWN * np.exp(0.5 * z)
    found = measure(target_at(OWN), solve(z, None).state, z)
    assert found.pairs.tolist() == [0, 1, 2]
    assert found.value == pytest.approx(((0.5 * z / 0.01) ** 2).sum() + z @ z)
    assert found.max_percent == pytest.approx(100.0 * np.abs(model / OWN - 1.0).max())
    assert found.rms_percent == pytest.approx(100.0 * np.sqrt(np.mean((model / OWN - 1.0) ** 2)))


def test_a_gap_too_small_measures_that_disagree_and_a_wrong_count_cost() -> None:
    z, state = np.zeros(3), solve(np.zeros(3), None).state
    two = target_at(OWN[:2])
    gap = 2.0 * np.log(2.0 / 1.0)  # seats and skin both go with the strength
    assert measure(two, state, z).gap == pytest.approx(gap)
    assert measure(replace(two, gap=gap + 0.02), state, z).value == pytest.approx(1.0)
    few, many = (replace(target_at(OWN), count=ModeCount(250.0, *known)) for known in ((3, 5), (0, 1)))
    assert measure(few, state, z).count == 2
    clear = 0.005
    assert measure(few, state, z).value == pytest.approx(((np.log(300.0 / 250.0) + clear) / 0.01) ** 2)
    assert measure(many, state, z).value == pytest.approx(((np.log(250.0 / 200.0) + clear) / 0.01) ** 2)
    assert measure(replace(few, count=ModeCount(250.0, 2, 2)), state, z).value == pytest.approx(0.0, abs=1e-12)
    # Near-equal strengths at far frequencies: velocity, strength over frequency, chooses another mode.
    even = Oscillators(z, strengths=(3.0, 2.0, 2.01)).state
    # Acceleration chooses the first and the third, velocity would have the second at 200 in place of the third at 300.
    judged = measure(two, even, z, strict=True)
    assert judged.pairs.tolist() == [0, 2]
    assert not judged.measures_agree
    assert judged.margin == pytest.approx(np.log((2.01 / 2.0) ** 2 / (300.0 / 200.0)))


def test_a_mode_held_back_costs_nothing_and_a_design_without_modes_much() -> None:
    z, state = np.zeros(3), solve(np.zeros(3), None).state
    held = replace(target_at([100.0, 200.0, 500.0]), noise=np.array([0.01, 0.01, np.inf]))
    assert measure(held, state, z).value == pytest.approx(0.0, abs=1e-12)
    assert measure(replace(held, band=(1.0, 250.0)), state, z).value >= 1e6


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"frequencies": np.array([2.0, 1.0, 3.0])}, "ascending"),
        ({"noise": np.array([0.01])}, "noise"),
        ({"shapes": np.eye(2)}, "2 measured shapes"),
    ],
)
def test_wrong_targets_are_refused(change: dict[str, FloatArray], said: str) -> None:
    with pytest.raises(HousingError, match=said):
        replace(target_at(OWN), **change)


def test_shapes_pair_modes_whatever_their_order_and_scale() -> None:
    z = np.array([1.6, 0.0, 0.0])  # the first oscillator is above the second
    target = target_at([200.0, 222.0, 300.0], shapes=np.array([[0, -3.0, 0], [0.5, 0, 0], [0, 0, 7.0]]))
    found = measure(target, solve(z, None).state, z)
    assert found.pairs.tolist() == [0, 1, 2]
    assert found.mac == pytest.approx(np.ones(3))
    none = replace(target, shapes=np.array([[0, 1.0, 0], [0.5, 0, 0], [1.0, 1.0, 0.05]]))
    assert measure(none, solve(z, None).state, z).pairs[2] == UNPAIRED
    with pytest.raises(HousingError, match="degrees of freedom"):
        measure(replace(target, shapes=np.ones((3, 5))), solve(z, None).state, z)


def test_a_shape_held_back_costs_nothing_whether_it_has_a_partner_or_none() -> None:
    z = np.zeros(3)
    held = replace(target_at(OWN, shapes=np.eye(3)), noise=np.array([0.01, 0.01, np.inf]), shape_noise=0.05)
    apart = replace(held, shapes=np.array([[1.0, 0, 0], [0, 1.0, 0], [1.0, 1.0, 0.05]]))
    own, other = (measure(target, solve(z, None).state, z) for target in (held, apart))
    assert (own.pairs[2], other.pairs[2]) == (2, UNPAIRED)
    assert own.value == pytest.approx(0.0, abs=1e-12)
    assert other.value == pytest.approx(0.0, abs=1e-12)
    # One that counts costs more than an error of five standard deviations.
    assert measure(replace(apart, noise=held.noise[:1].repeat(3)), solve(z, None).state, z).value > 25.0


def test_no_shape_is_cheaper_for_being_lost() -> None:
    """As a measured shape turns away from the model's, J grows to the place where it loses its partner, and beyond."""
    z = np.zeros(3)
    target = replace(target_at(OWN), shape_noise=0.05)
    values = []
    for turned in (0.0, 0.7, 0.78, 0.79):  # MAC = cos² of it: a half at π/4
        shape = [np.cos(turned), np.sin(turned) / np.sqrt(2.0), np.sin(turned) / np.sqrt(2.0)]
        found = measure(
            replace(target, shapes=np.array([shape, [0, 1.0, -1.0], [0, 1.0, 1.0]])), solve(z, None).state, z
        )
        values.append((found.value, found.pairs[0] == UNPAIRED))
    assert [lost for _, lost in values] == [False, False, False, True]
    assert values == sorted(values)


def test_the_search_ends_where_prior_and_data_balance() -> None:
    """J_i = (½ z - d)² / σ² + z² is least at z = 2 d / (1 + 4 σ²)."""
    wanted, noise = np.array([0.3, -0.2, 0.1]), 0.2
    target = target_at(OWN * np.exp(wanted), noise=noise)
    found = search(solve, target, FREE, solve(np.zeros(3), None), Effort(trust=0.4, solves=20, starts=4))
    assert found.design.coordinates == pytest.approx(2.0 * wanted / (1.0 + 4.0 * noise**2), abs=0.02)
    values = [step.found for step in found.steps if step.accepted]
    assert values == sorted(values, reverse=True)


def test_the_search_keeps_to_the_range_and_survives_designs_that_are_none() -> None:
    narrow = [replace(parameter, low=0.9, high=1.1) for parameter in FREE]
    target = target_at(OWN * 1.5)
    calls: list[FloatArray] = []

    def fails_once(coordinates: FloatArray, near: Design | None) -> Oscillators:
        calls.append(coordinates)
        if len(calls) == 1:
            raise HousingError("walls meet")
        return Oscillators(coordinates)

    found = search(fails_once, target, narrow, solve(np.zeros(3), None), Effort(trust=1.0, solves=20))
    assert found.steps[0].found == np.inf
    assert found.design.coordinates == pytest.approx(coordinate_bounds(narrow)[1], abs=1e-6)


def test_the_posterior_is_gauss_own() -> None:
    """C_ii = 1 / (1 + (½ / σ)²) for uncoupled oscillators; what is not measured keeps its prior."""
    z, target = np.zeros(3), target_at(OWN, noise=0.25)
    held = replace(target, noise=np.array([0.25, 0.5, np.inf]))
    near = solve(z, None).surrogate().at(z)
    after = posterior(held, measure(held, near.state, z), z, near)
    variances = np.array([1.0 / (1.0 + 4.0), 1.0 / (1.0 + 1.0), 1.0])
    assert after.covariance == pytest.approx(np.diag(variances))
    assert after.information == pytest.approx([4.0, 1.0, 0.0])
    assert after.n_learned == 1
    assert after.frequency_deviations() == pytest.approx(0.5 * np.sqrt(variances))
    assert after.distance(np.array([1.0, 1.0, 2.0])) == pytest.approx(5.0 + 2.0 + 4.0)
    assert after.values(FREE)[0] == pytest.approx((1.0, np.log(2.0) * np.sqrt(0.2)))
    assert after.confounded == []


def test_two_springs_in_parallel_are_told_by_their_sum_only() -> None:
    """One frequency that both move alike: C = I - s sᵀ / (1 + |s|²), correlated by -s² / (1 + s²)."""
    rates = np.zeros((2, 1, 1))
    rates[:] = 1.0
    state = ModalState(np.array([100.0]), np.ones((1, 1, 2)), np.ones((1, 1)))
    z = np.zeros(2)
    near = Surrogate(z, state, rates, np.zeros((2, 1, 1))).at(z)
    target = target_at([100.0], noise=0.05)
    after = posterior(target, measure(target, near.state, z), z, near)
    s = 0.5 / 0.05
    assert after.correlations[0, 1] == pytest.approx(-(s**2) / (1.0 + s**2))
    assert after.confounded[0][:2] == (0, 1)
    assert np.abs(after.directions[0]) == pytest.approx(np.sqrt([0.5, 0.5]))
    assert after.n_learned == 1


@pytest.mark.slow
def test_a_mode_that_nothing_else_tells_of_is_predicted_no_better_than_before() -> None:
    """Each oscillator has a parameter of its own: held back, it stays where the prior has it, with its uncertainty."""
    target = target_at(OWN * np.array([1.2, 0.9, 1.1]), noise=0.01)
    rows = leave_one_out(Procedure(solve, FREE, solve(np.zeros(3), None), Effort(trust=0.4, solves=20), 2), target)
    assert [row.error_percent for row in rows] == pytest.approx([row.start_error_percent for row in rows], abs=0.2)
    assert [row.deviation for row in rows] == pytest.approx([np.hypot(0.5, 0.01)] * 3)
    assert [row.prior_deviation for row in rows] == pytest.approx([np.hypot(0.5, 0.01)] * 3)
    assert max(row.rms_percent for row in rows) < 0.1


def test_a_mode_that_the_others_tell_of_is_predicted() -> None:
    """One parameter moves all three alike, and the truth is of that kind."""

    def common(coordinates: FloatArray, near: Design | None) -> "Common":
        return Common(coordinates)

    target = target_at(OWN * 1.1, noise=0.005)
    rows = leave_one_out(Procedure(common, FREE[:1], common(np.zeros(1), None), Effort(), 1), target)
    assert max(abs(row.error_percent) for row in rows) < 0.1
    assert max(abs(row.start_error_percent) for row in rows) > 9.0
    assert max(row.deviation for row in rows) < 0.007


@dataclass(frozen=True)
class Common:
    """All springs with one and the same parameter."""

    coordinates: FloatArray

    def surrogate(self) -> Surrogate:
        base = Oscillators(np.zeros(3)).surrogate()
        return Surrogate(np.zeros(1), base.state, np.eye(3)[None], np.zeros((1, 3, 3)))

    @property
    def state(self) -> ModalState:
        return self.surrogate().at(self.coordinates).state


@pytest.mark.slow
def test_the_null_test_tells_a_model_that_fits_anything_from_one_that_does_not() -> None:
    target = target_at([100.0, 200.0, 300.0], noise=0.005)
    few = Effort(starts=4)
    anything = null_fits(Procedure(solve, FREE, solve(np.zeros(3), None), few, 2), target, 3)

    def common(coordinates: FloatArray, near: Design | None) -> Common:
        return Common(coordinates)

    stiff = null_fits(Procedure(common, FREE[:1], common(np.zeros(1), None), few, 1), target, 3)
    assert anything[0].frequencies == pytest.approx(target.frequencies)
    assert len(anything[1]) == 3
    assert all(fit.is_met and fit.max_percent < 1.0 for fit in anything[1])
    assert np.median([fit.max_percent for fit in stiff[1]]) > 5.0
    assert not any(fit.is_met for fit in stiff[1])


@given(st.integers(0, 2**32 - 1))
@settings(deadline=None)
def test_random_frequencies_are_a_survey_could_have_told(seed: int) -> None:
    measured = np.array([658.0, 1049.0, 1710.0, 2000.0, 2276.0, 2536.0, 2722.0, 2962.0])
    drawn = random_frequencies(measured, np.random.default_rng(seed))
    assert len(drawn) == len(measured)
    assert measured[0] <= drawn[0]
    assert drawn[-1] <= measured[-1]
    assert (np.diff(np.log(drawn)) > 0.01).all()


def test_what_is_asked_for_is_met_only_by_all_of_it() -> None:
    z, state = np.zeros(3), solve(np.zeros(3), None).state
    two = replace(target_at(OWN[:2]), gap=0.5, margin=0.1, count=ModeCount(250.0, 2, 2))

    def met(target: Target) -> bool:
        return is_met(target, measure(target, state, z, strict=True))

    assert met(two)
    assert met(replace(two, frequencies=OWN[:2] * 1.015))
    assert not met(replace(two, frequencies=OWN[:2] * 1.025))
    assert met(replace(two, frequencies=OWN[:2] * [1.0, 1.025], noise=np.array([0.01, np.inf])))
    assert not met(replace(two, gap=2.0))
    assert not met(replace(two, count=ModeCount(250.0, 3, 3)))
    # Velocity prefers another mode: acceleration alone is clear, but the measures do not agree.
    even = Oscillators(z, strengths=(3.0, 2.0, 2.5)).state
    third = replace(two, frequencies=OWN[[0, 2]], gap=0.1, count=None)
    judged = measure(third, Oscillators(z, strengths=(3.0, 2.0, 2.3)).state, z, strict=True)
    assert judged.gap > 0.1 > 0.0 > judged.margin
    assert not is_met(third, judged)
    assert is_met(third, measure(third, even, z, strict=True))
    # Where shapes were measured nothing is asked for but the least misfit.
    assert not met(replace(target_at(OWN), shapes=np.eye(3)))
