"""Cases: those whose housings are alike share its modes; figures are rendered where a test is of them."""

import pytest


@pytest.fixture(scope="module", autouse=True)
def _solved_once(solved_once: None) -> None:
    """Solve nothing again that another test has solved."""


@pytest.fixture(scope="module", autouse=True)
def _figures_unrendered(unrendered: None) -> None:
    """Render no figures, but in a module marked ``rendered``."""


@pytest.fixture(scope="module", autouse=True)
def _texts_read_back(texts_read_back: None) -> None:
    """Hold the numbers in the texts of every result against its document."""
