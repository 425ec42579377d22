"""Cases: those whose housings are alike share its modes; figures are rendered where a test is of them."""

import pytest


@pytest.fixture(scope="module", autouse=True)
def _modes_solved_once(modes_solved_once: None) -> None:
    """Modes of a housing that another test of this process has solved are not solved again."""


@pytest.fixture(scope="module", autouse=True)
def _periodic_motions_found_once(periodic_motions_found_once: None) -> None:
    """Periodic motions of a machine that another test of this process has found are not sought again."""


@pytest.fixture(scope="module", autouse=True)
def _figures_unrendered(unrendered: None) -> None:
    """Render no figures, but in a module marked ``rendered``."""


@pytest.fixture(scope="module", autouse=True)
def _texts_read_back(texts_read_back: None) -> None:
    """Hold the numbers in the texts of every result against its document."""
