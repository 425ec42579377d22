"""Pictures of a free block's modes against references that were looked at, with a tolerance that a wrong mode fails.

The block has a mesh laid by hand and modes that lie apart, so that neither mesher nor solver changes a picture. They
are compared as means over squares of six pixels: another rasteriser's edges and letters differ less than modes do.
After a change of style, copy the new pictures from the folder that a failed test names, once they have been looked at.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from gearwhine.housing import Material, ModeSet, assemble, solve_modes
from gearwhine.housing.errors import RendererUnavailableError
from gearwhine.housing.pictures.drawn_shapes import drawn_housing, drawn_modes
from gearwhine.housing.pictures.images import render_shapes
from gearwhine.housing.pictures.scene import find_renderer
from gearwhine.meshes import Mesh

REFERENCES = Path(__file__).parent / "references"
NUMBERS = (7, 8, 9, 10)
TOLERANCE = 2.5  # mean difference of two pictures, of 255
APART = 2.0  # times the tolerance by which pictures of two modes differ at least


def _squares(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB").reduce(6), dtype=float)


def _difference(one: Path, other: Path) -> float:
    """Mean over the part of the pictures that is not white in both."""
    first, second = _squares(one), _squares(other)
    inked = (first < 250.0).any(axis=2) | (second < 250.0).any(axis=2)
    return float(np.abs(first - second)[inked].mean())


@pytest.fixture(scope="module")
def solved(block: Callable[..., Mesh], steel: Material) -> tuple[Mesh, ModeSet]:
    mesh = block((0.30, 0.12, 0.20), (3, 1, 2))
    return mesh, solve_modes(assemble(mesh, steel), count=max(NUMBERS))


def render_modes(mesh: Mesh, modes: ModeSet, numbers: Sequence[int], folder: Path, **how: Any) -> list[Path]:
    housing = drawn_housing(mesh)
    return render_shapes(housing, drawn_modes(housing, modes, numbers, how.pop("notes", None)), folder, **how)


@pytest.fixture(scope="module")
def drawn(solved: tuple[Mesh, ModeSet], tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    try:
        find_renderer()
    except RendererUnavailableError as error:
        pytest.skip(str(error))
    mesh, modes = solved
    assert np.diff(modes.frequencies[NUMBERS[0] - 1 :]).min() > 0.02 * modes.frequencies[NUMBERS[0] - 1]
    files = render_modes(mesh, modes, NUMBERS, tmp_path_factory.mktemp("drawn"), size=(300, 240))
    return dict(zip(NUMBERS, files, strict=True))


@pytest.mark.parametrize("number", NUMBERS)
def test_a_mode_looks_like_its_reference_and_no_other(drawn: dict[int, Path], number: int) -> None:
    reference = REFERENCES / f"block-mode-{number}.png"
    assert reference.stat().st_size < 60_000
    assert _difference(drawn[number], reference) < TOLERANCE, drawn[number]
    others = [_difference(drawn[other], reference) for other in NUMBERS if other != number]
    assert min(others) > APART * TOLERANCE


def test_the_same_mode_upside_down_or_from_elsewhere_fails(
    drawn: dict[int, Path], solved: tuple[Mesh, ModeSet], tmp_path: Path
) -> None:
    from dataclasses import replace

    mesh, modes = solved
    reference = REFERENCES / "block-mode-7.png"
    turned = replace(modes, shapes=-modes.shapes)
    (upside_down,) = render_modes(mesh, turned, [7], tmp_path / "turned", size=(300, 240))
    (elsewhere,) = render_modes(mesh, modes, [7], tmp_path / "front", size=(300, 240), view="front")
    assert min(_difference(upside_down, reference), _difference(elsewhere, reference)) > TOLERANCE
