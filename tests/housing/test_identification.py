"""Modes found in responses that were synthesised from known ones."""

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.housing import HousingError
from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured import MeasuredGeometry, MeasuredResponses, StabilityRule, identify_modes
from gearwhine.housing.measured.residues import fit_residues, refine_poles

FREQUENCIES_HZ = np.array([120.3, 180.0, 196.0, 401.7, 610.2, 890.5])
RATIOS = np.array([0.01, 0.008, 0.012, 0.005, 0.02, 0.003])
COUNT = 20
SHAPES = np.random.default_rng(0).normal(size=(6, COUNT))
POWERS = {"displacement": 0, "velocity": 1, "acceleration": 2}


def responses(
    motion: str = "acceleration",
    references: tuple[int, ...] = (0,),
    first: int = 80,
    noise: float = 0.0,
) -> MeasuredResponses:
    """H = (iω)ᵖ Σ φ φᵀ / (ω₀² - ω² + 2iζω₀ω), the textbook sum, with noise as a part of its mean size."""
    rng = np.random.default_rng(5)
    omega, natural = 2 * np.pi * np.arange(first, 1001.0), 2 * np.pi * FREQUENCIES_HZ
    terms = 1.0 / (natural[:, None] ** 2 - omega**2 + 2j * (RATIOS * natural)[:, None] * omega)
    values = np.einsum("md,mr,mw->drw", SHAPES, SHAPES[:, list(references)], terms) * (1j * omega) ** POWERS[motion]
    disturbance = rng.normal(size=values.shape) + 1j * rng.normal(size=values.shape)
    values += noise * np.abs(values).mean() * disturbance / np.sqrt(2.0)
    up = np.tile([0.0, 0.0, 1.0], (COUNT, 1))
    labels = tuple(str(number) for number in range(1, COUNT + 1))
    geometry = MeasuredGeometry(labels, rng.normal(size=(COUNT, 3)), np.arange(COUNT), up)
    return MeasuredResponses(geometry, np.array(references), up[: len(references)], omega, values, motion)  # type: ignore[arg-type]


def macs(found: npt.NDArray[np.complex128], true: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    norms = np.linalg.norm(found, axis=1) * np.linalg.norm(true, axis=1)
    return np.abs((found * true).sum(axis=1) / norms) ** 2


@pytest.mark.parametrize("references", [(0,), (0, 3)])
@pytest.mark.parametrize("motion", list(POWERS))
def test_clean_responses_give_back_their_modes(motion: str, references: tuple[int, ...]) -> None:
    found = identify_modes(responses(motion, references))
    np.testing.assert_allclose(found.modes.frequencies, 2 * np.pi * FREQUENCIES_HZ, rtol=1e-7)
    np.testing.assert_allclose(found.modes.damping_ratios, RATIOS, rtol=1e-5)
    assert macs(found.modes.shapes, SHAPES).min() > 1 - 1e-9
    assert found.misfit < 1e-6
    assert found.rank.min() > 1 - 1e-9


@pytest.mark.parametrize("first", [0, 1])
def test_lines_may_begin_at_any_multiple_of_their_spacing(first: int) -> None:
    begun = identify_modes(responses(first=first))
    np.testing.assert_allclose(begun.modes.frequencies, 2 * np.pi * FREQUENCIES_HZ, rtol=1e-7)


def test_noise_brings_no_modes_and_costs_little() -> None:
    """Noise of 2 % of the mean response, the close pair 1.3 half-power widths apart at both."""
    found = identify_modes(responses("displacement", (0, 3), noise=0.02))
    np.testing.assert_allclose(found.modes.frequencies, 2 * np.pi * FREQUENCIES_HZ, rtol=5e-4)
    np.testing.assert_allclose(found.modes.damping_ratios, RATIOS, rtol=0.05)
    assert macs(found.modes.shapes, SHAPES).min() > 0.999


def test_a_band_holds_only_its_modes() -> None:
    found = identify_modes(responses(), band=(2 * np.pi * 300, 2 * np.pi * 700))
    np.testing.assert_allclose(found.modes.frequencies, 2 * np.pi * FREQUENCIES_HZ[3:5], rtol=1e-4)


def test_pairs_not_measured_are_left_out() -> None:
    given = responses("displacement", (0, 3))
    values = given.values.copy()
    values[5, 1] = values[6, 0] = values[7, 0] = np.nan
    holes = MeasuredResponses(
        given.geometry, given.reference_points, given.reference_directions, given.frequencies, values, "displacement"
    )
    found = identify_modes(holes)
    np.testing.assert_allclose(found.modes.frequencies, 2 * np.pi * FREQUENCIES_HZ, rtol=1e-7)
    # A zero in place of what is missing would cost some percent of MAC.
    assert macs(found.modes.shapes, SHAPES).min() > 1 - 1e-9
    assert found.rank.min() > 1 - 1e-9


def test_noise_alone_is_no_mode() -> None:
    given = responses()
    rng = np.random.default_rng(2)
    noise = rng.normal(size=given.values.shape) + 1j * rng.normal(size=given.values.shape)
    with pytest.raises(MeasuredDataError, match="no pole between 80 and 1000 Hz is stable"):
        identify_modes(
            MeasuredResponses(
                given.geometry, given.reference_points, given.reference_directions, given.frequencies, noise
            )
        )


def test_uneven_frequencies_and_nonsense_rules_are_refused() -> None:
    given = responses()
    uneven = given.frequencies.copy()
    uneven[10:] += 0.4 * np.diff(uneven)[0]
    with pytest.raises(MeasuredDataError, match="whole multiples of one spacing"):
        identify_modes(
            MeasuredResponses(given.geometry, given.reference_points, given.reference_directions, uneven, given.values)
        )
    with pytest.raises(HousingError, match="is no rule"):
        StabilityRule(orders=0)


@pytest.mark.parametrize("power", [0, 1, 2])
def test_residues_stand_beside_a_residual_mass_and_stiffness(power: int) -> None:
    """(iω)ᵖ [A/(iω - λ) + A*/(iω - λ*) - B/ω² + C] with complex B and C, of which the fit is one."""
    rng = np.random.default_rng(1)
    omega, pole = 2 * np.pi * np.arange(20.0, 200.0), 2 * np.pi * 90.0 * complex(-0.02, 1.0)
    residues, mass, stiffness = rng.normal(size=(3, 5, 1)) + 1j * rng.normal(size=(3, 5, 1))
    s = 1j * omega
    terms = residues / (s - pole) + residues.conj() / (s - np.conj(pole)) + 9e4 * mass / s**2 + 0.01 * stiffness
    fit = fit_residues(s**power * terms, omega, np.array([pole]), power)
    assert fit.misfit < 1e-10
    np.testing.assert_allclose(fit.residues, residues, rtol=1e-8)
    away = refine_poles(s**power * terms, omega, np.array([pole * complex(1.01, 0.002)]), power)
    np.testing.assert_allclose(away, [pole], rtol=1e-7)
