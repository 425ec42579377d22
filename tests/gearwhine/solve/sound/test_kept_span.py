"""Solutions that span the sound of a housing's modes: kept beside the modes, and read in place of solving."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sounding_gearbox import sounding_housing

from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.housing.acoustics.boundary_elements import BoundaryElements
from gearwhine.housing.acoustics.medium import AIR
from gearwhine.housing.acoustics.radiation import HousingRadiation
from gearwhine.housing.storage.mode_file import read_modes
from gearwhine.output.files import MODE_CACHE_FILE
from gearwhine.solve.housing_modes import write_mode_cache
from gearwhine.solve.kept_radiation import KeptSpan
from tests.housing.acoustics.surfaces import at_corners, box

BETWEEN = (20.0, 1200.0)
WANTED = np.linspace(80.0, 1150.0, 12)


def walls(points, normals):
    """Three walls that move as a whole, and one that bends."""
    return np.column_stack([normals, normals[:, 0] * np.cos(20.0 * points[:, 1])])


@pytest.fixture(scope="module")
def radiation() -> HousingRadiation:
    elements = BoundaryElements(box((0.4, 0.3, 0.2), 0.034), AIR)
    modal = np.ascontiguousarray(at_corners(elements.surface, walls).real)
    return HousingRadiation("boundary-elements", (elements,), (modal,), ("wall",) * len(elements.surface.triangles), ())


@pytest.fixture(scope="module")
def spans(radiation: HousingRadiation) -> KeptSpan:
    kept = KeptSpan(Acoustics(), sounding_housing())
    assert kept.spanned(radiation, WANTED, BETWEEN).reduced is not None
    return kept


def test_the_next_command_in_a_folder_solves_no_whole_equations(radiation, spans, monkeypatch, tmp_path: Path) -> None:
    """Its numbers are those of the first one, bit for bit, of whatever microphones and lines."""
    assert not spans.housing.source_holds
    write_mode_cache(tmp_path, spans.housing)
    record = read_modes(tmp_path / MODE_CACHE_FILE)
    first = spans.spanned(radiation, WANTED, BETWEEN).solve(500.0, np.eye(4))
    monkeypatch.setattr(BoundaryElements, "solve", None)
    lines = Acoustics(lines=7, floor=None)
    again = KeptSpan(lines, replace(spans.housing, record=record, source_holds=True))
    found = again.spanned(radiation, WANTED[:3], BETWEEN)
    assert again.housing.source_holds  # nothing to write
    assert found.solve(500.0, np.eye(4)).power == first.power


@pytest.mark.parametrize("change", [{"caps": "rest"}, {"density": 1.1}, {"mesh_size": 0.03}])
def test_other_air_or_another_surface_is_solved_anew(radiation, spans, monkeypatch, change) -> None:
    monkeypatch.setattr(BoundaryElements, "solve", None)
    with pytest.raises(TypeError, match="NoneType"):
        KeptSpan(Acoustics(**change), spans.housing).spanned(radiation, WANTED, BETWEEN)


def test_frequencies_beyond_the_kept_ones_are_solved_anew(radiation, spans, monkeypatch) -> None:
    monkeypatch.setattr(BoundaryElements, "solve", None)
    with pytest.raises(TypeError, match="NoneType"):
        KeptSpan(Acoustics(), spans.housing).spanned(radiation, np.append(WANTED, 1250.0), BETWEEN)
