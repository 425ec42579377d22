"""What every criterion of likeness keeps to: bounds, scales, order, conjugation, mixing."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.housing.correlation import (
    PairingRule,
    auto_mac,
    comac,
    cross_orthogonality,
    enhanced_comac,
    frac,
    modal_assurance_criterion,
    pair_modes,
    phase_collinearity,
    real_shapes,
)
from gearwhine.housing.correlation.modal_assurance_criterion import mean_phase

SEEDS = st.integers(0, 2**32 - 1)
SIZES = st.tuples(st.integers(1, 4), st.integers(1, 4), st.integers(6, 12))


def _shapes(random: np.random.Generator, *size: int) -> np.ndarray:
    return random.normal(size=size) + 1j * random.normal(size=size)


@settings(max_examples=25, deadline=None)
@given(SEEDS, SIZES)
def test_mac(seed: int, size: tuple[int, int, int]) -> None:
    random = np.random.default_rng(seed)
    n, m, dofs = size
    a, b = _shapes(random, n, dofs), _shapes(random, m, dofs)
    b[random.random(b.shape) < 0.2] = np.nan
    b[:, 0] = 1.0 + random.random(m)
    value = modal_assurance_criterion(a, b)
    assert ((value >= 0.0) & (value <= 1.0)).all()
    assert modal_assurance_criterion(b, a) == pytest.approx(value.T)
    scale = _shapes(random, n, 1)
    assert modal_assurance_criterion(scale * a, b) == pytest.approx(value)
    assert modal_assurance_criterion(a.conj(), b.conj()) == pytest.approx(value)
    places = random.permutation(dofs)
    assert modal_assurance_criterion(a[:, places], b[:, places]) == pytest.approx(value)
    order = random.permutation(n)
    assert modal_assurance_criterion(a[order], b) == pytest.approx(value[order])
    assert auto_mac(a).diagonal() == pytest.approx(np.ones(n))


@settings(max_examples=25, deadline=None)
@given(SEEDS, SIZES)
def test_criteria_are_blind_to_the_scale_of_the_measured(seed: int, size: tuple[int, int, int]) -> None:
    random = np.random.default_rng(seed)
    n, _, dofs = size
    model, test = random.normal(size=(n, dofs)), _shapes(random, n, dofs)
    scale = _shapes(random, n, 1)
    for criterion in (comac, enhanced_comac, cross_orthogonality, frac):
        value = criterion(model, test)
        assert ((value >= 0.0) & (value <= 1.0 + 1e-12)).all()
        assert criterion(model, scale * test) == pytest.approx(value)
    assert (cross_orthogonality(model, test) ** 2).sum(axis=0) == pytest.approx(np.ones(n))
    assert phase_collinearity(scale * test) == pytest.approx(phase_collinearity(test), abs=1e-12)
    turned = mean_phase(np.exp(0.3j) * test) - mean_phase(test) - 0.3
    assert np.sin(turned) == pytest.approx(np.zeros(n), abs=1e-9)
    real = real_shapes(test)
    any_phase = np.exp(1j * random.uniform(0.0, 2.0 * np.pi, (n, 1)))
    assert (np.linalg.norm(real, axis=1) >= np.linalg.norm((any_phase * test).real, axis=1) - 1e-12).all()


@settings(max_examples=25, deadline=None)
@given(SEEDS)
def test_pairs_do_not_depend_on_scales_or_places(seed: int) -> None:
    random = np.random.default_rng(seed)
    model = random.normal(size=(6, 15))
    frequencies = np.sort(random.uniform(100.0, 300.0, 6))
    test = model[:4] + 0.3 * _shapes(random, 4, 15)
    measured = np.sort(random.uniform(100.0, 300.0, 4))
    pairs = pair_modes(frequencies, model, measured, test)
    places = random.permutation(15)
    again = pair_modes(
        7.0 * frequencies,
        (random.normal(size=(6, 1)) * model)[:, places],
        7.0 * measured,
        (1j * test.conj())[:, places],
    )
    assert [(pair.model, pair.measured) for pair in again] == [(pair.model, pair.measured) for pair in pairs]
    assert [pair.confidence for pair in again] == pytest.approx([pair.confidence for pair in pairs])
    assert len({pair.model for pair in pairs}) == len({pair.measured for pair in pairs}) == len(pairs)


@settings(max_examples=60, deadline=None)
@given(SEEDS, st.sampled_from([0.0, 0.01, 0.03]), st.sampled_from([0.2, 0.5]))
def test_every_pair_keeps_the_rule(seed: int, closeness: float, least_mac: float) -> None:
    """Crowded modes, mixed and noisy, in groups of all sizes: one partner each, alike enough, sure within bounds."""
    random = np.random.default_rng(seed)
    a, b = random.integers(1, 9, 2)
    frequencies, measured = (np.sort(random.uniform(100.0, 140.0, count)) for count in (a, b))
    model = random.normal(size=(a, 20))
    test = random.normal(size=(b, a)) @ model + 0.3 * _shapes(random, b, 20)
    test[random.random(test.shape) < 0.1] = np.nan
    rule = PairingRule(closeness=closeness, least_mac=least_mac)
    pairs = pair_modes(frequencies, model, measured, test, rule)
    assert len({pair.model for pair in pairs}) == len({pair.measured for pair in pairs}) == len(pairs)
    assert all(pair.mac >= least_mac - 1e-12 for pair in pairs)
    assert all(0.0 <= pair.confidence <= 1.0 for pair in pairs)
    assert all(
        pair.mac >= modal_assurance_criterion(model[pair.model], test[pair.measured])[0, 0] - 1e-12 for pair in pairs
    )
