"""The worked examples of housings against masses, twins and an independent eigensolver."""

from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.sparse.linalg import eigsh

from gearwhine.notebook import machine_html, modes_html
from gearwhine.solve import updating


@pytest.mark.slow
def test_modes_of_a_step_file_are_those_of_its_solid(example: Any) -> None:
    found = example("housing_modes_of_a_step_file")
    housing, modes = found["housing"], found["modes"]
    volume = 0.2 * 0.12 * 0.16 - 0.18 * 0.1 * 0.14 - np.pi * 0.025**2 * 0.01
    matrices = housing.matrices()
    # Ten-node tetrahedra take the bore's circle as parabolas.
    assert matrices.total_mass == pytest.approx(7850.0 * volume, rel=1e-4)
    free = np.setdiff1d(np.arange(3 * matrices.n_nodes), matrices.fixed)
    stiffness, mass = (matrix.tocsc()[free][:, free] for matrix in (matrices.stiffness, matrices.mass))
    eigenvalues = eigsh(stiffness, k=4, M=mass, sigma=0.0, return_eigenvectors=False)
    frequencies = np.sqrt(np.sort(eigenvalues)) / (2.0 * np.pi)
    below = frequencies[frequencies < 4000.0]
    assert modes.frequencies_hz == pytest.approx(below, rel=1e-7)


@pytest.mark.slow
def test_update_finds_the_modulus_of_the_twin(example: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """All frequencies are as √E, so that both the error before the fit and the fit itself have closed forms."""
    # In this process: to start others takes longer than the fit, and changes nothing.
    monkeypatch.setattr(updating, "default_workers", lambda: 1)
    found = example("compare_and_update")
    before, fit = found["before"].document, found["fit"]
    assert before["rms_error_percent"] == pytest.approx(100.0 * (np.sqrt(207.0 / 196.0) - 1.0), rel=1e-6)

    def misfit(modulus: float) -> float:
        """Six frequencies with 0.5 % of noise each, and the prior: 207 GPa, a third of the way to 180 GPa."""
        error = (np.sqrt(modulus / 196.0) - 1.0) / 0.005
        return 6.0 * error**2 + ((modulus - 207.0) / 9.0) ** 2

    expected = minimize_scalar(misfit, bounds=(180.0, 230.0), method="bounded", options={"xatol": 1e-9}).x
    assert float(fit.dataset["value_after"][0]) == pytest.approx(1e9 * expected, rel=1e-4)


@pytest.mark.slow
def test_modes_of_shafts_in_a_housing_are_those_of_its_matrices(example: Any) -> None:
    found = example("housing_and_shafts_coupled")
    system = found["machine"].assembled.system
    n = system.size
    state = np.block([[np.zeros((n, n)), np.eye(n)], [-system.mean_stiffness, -system.mean_damping]])
    eigenvalues = np.linalg.eigvals(state)
    frequencies = np.sort(np.abs(eigenvalues[eigenvalues.imag > 1.0])) / (2.0 * np.pi)
    elastic = found["modes"].frequencies_hz[found["modes"].frequencies_hz > 1.0]
    assert elastic[:20] == pytest.approx(frequencies[:20], rel=1e-6)
    assert found["machine"].mesh_frequencies[0] == pytest.approx(30 * 3000 / 60)
    # As notebooks show them.
    assert "<td>1500.00</td>" in machine_html(found["machine"])
    modes = found["machine"].housing
    assert f"<td>{modes.frequencies_hz[2]:.1f}</td>" in modes_html(modes)


@pytest.mark.slow
def test_sound_of_a_housing_is_what_crosses_a_half_sphere(example: Any) -> None:
    """Near pressures over a half sphere on the floor, p²/ρc where waves run outwards; nine places come near it."""
    found = example("sound_of_a_housing")
    middle, radius = np.array([0.0, -0.022, 0.0]), 8.0
    heights, weights = np.polynomial.legendre.leggauss(24)
    heights, weights = 0.5 * (heights + 1.0), 0.5 * weights
    around = np.arange(48) * np.pi / 24.0
    level = np.sqrt(1.0 - heights**2)
    directions = np.stack(
        [np.outer(level, np.cos(around)), np.outer(heights, np.ones(48)), np.outer(level, np.sin(around))], axis=-1
    )
    for sound, power in zip(found["solved"], found["powers"], strict=True):
        squared = np.abs(sound.pressure_at(middle + radius * directions.reshape(-1, 3))) ** 2 / 2.0
        mean = weights @ squared.reshape(24, 48).mean(axis=1)
        through = 2.0 * np.pi * radius**2 * mean / (1.204 * 343.2)
        assert power == pytest.approx(10.0 * np.log10(through / 1e-12), abs=0.1)
    together = [10.0 * np.log10(sum(10.0 ** (0.1 * np.array(found[name])))) for name in ("powers", "measured")]
    assert together[1] == pytest.approx(together[0], abs=2.0)
