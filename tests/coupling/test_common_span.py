"""The common subspace of many matrices, such as those of a machine at all speeds of its bearings' tables."""

import tracemalloc

import numpy as np
import pytest

from gearwhine.coupling.time.condensation import common_span


def test_matrices_of_few_directions_are_made_again_from_their_cores() -> None:
    """Springs along three directions among ten coordinates, each matrix with other stiffnesses, one unsymmetric."""
    random = np.random.default_rng(3)
    along = np.zeros((10, 3))
    along[2:8] = random.normal(size=(6, 3))
    matrices = [along @ random.normal(size=(3, 3)) @ along.T for _ in range(5)]
    directions, cores = common_span(matrices)
    assert directions.shape == (10, 3)
    assert directions.T @ directions == pytest.approx(np.eye(3), abs=1e-14)
    for matrix, core in zip(matrices, cores, strict=True):
        assert directions @ core @ directions.T == pytest.approx(matrix, abs=1e-12 * np.abs(matrix).max())


def test_memory_goes_with_the_number_of_matrices_and_not_with_its_square() -> None:
    stiffness = np.diag(np.arange(1.0, 11.0))
    matrices = [scale * stiffness for scale in np.linspace(1.0, 2.0, 300)]
    tracemalloc.start()
    directions, _ = common_span(matrices)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert directions.shape == (10, 10)
    assert most < 50 * sum(matrix.nbytes for matrix in matrices)
