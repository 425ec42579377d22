"""Solutions that span the sound of a housing's modes: kept beside the modes, and read in place of solving."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sounding_gearbox import sounding_housing

from gearwhine.cli import run_command
from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.housing import HousingModes
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


def with_modes(housing: HousingModes, **changes: object) -> HousingModes:
    """The housing with other modes, of the same number on the same nodes, and with all that its record keeps."""
    modes = replace(housing.record.modes, **changes)  # type: ignore[arg-type]
    return replace(housing, record=replace(housing.record, modes=modes))


def with_mesh(housing: HousingModes) -> HousingModes:
    mesh = replace(housing.housing.mesh, points=housing.housing.mesh.points * 1.01)
    return replace(housing, housing=replace(housing.housing, mesh=mesh))


@pytest.mark.parametrize(
    "change",
    [
        lambda housing: with_modes(housing, shapes=housing.modes.shapes[::-1].copy()),
        lambda housing: with_modes(housing, frequencies=1.001 * housing.modes.frequencies),
        lambda housing: with_modes(
            housing,
            residual_modes=replace(housing.modes.residual_modes, shapes=1.001 * housing.modes.residual_modes.shapes),
        ),
        with_mesh,
    ],
    ids=["shapes", "frequencies", "residual modes", "mesh"],
)
def test_another_housing_of_the_same_number_of_modes_takes_no_old_span(
    radiation: HousingRadiation,
    spans: KeptSpan,
    monkeypatch: pytest.MonkeyPatch,
    change: Callable[[HousingModes], HousingModes],
) -> None:
    monkeypatch.setattr(BoundaryElements, "solve", None)
    changed = change(spans.housing)
    assert changed.record.extras.keys() == spans.housing.record.extras.keys()
    with pytest.raises(TypeError, match="NoneType"):
        KeptSpan(Acoustics(), changed).spanned(radiation, WANTED, BETWEEN)


@pytest.mark.slow
def test_a_second_command_in_the_folder_takes_the_kept_solutions(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its numbers are those of the first; those of another housing are its own."""
    changes = {
        "housing.box.mesh_size": "45 mm",
        "acoustics.mesh_size": "14 mm",
        "acoustics.highest_frequency": "2.8 kHz",
        "acoustics.lines": "12",
        "operation.speed": "1100 rpm",
    }
    words = [word for key, value in changes.items() for word in ("--set", f"{key}={value}")]

    def sound(folder: str, *further: str) -> tuple[dict[str, object], str]:
        assert run_command(["sound", "small-gearbox", "-o", str(tmp_path / folder), *words, *further]) == 0
        document = json.loads((tmp_path / folder / "summary.json").read_text(encoding="utf-8"))
        return {key: document[key] for key in NUMBERS}, capsys.readouterr().err

    first, told = sound("out")
    assert SOLVING in told
    second, told = sound("out")
    assert SOLVING not in told
    assert "modes read from" in told
    assert second == first
    # The walls are thicker by a tenth of a per mille: as many modes, and none of them are the same.
    other, told = sound("out", "--set", "housing.box.wall=10.001 mm")
    assert SOLVING in told
    assert other != first


SOLVING = "sound of all modes at"
NUMBERS = ("lines", "total_db", "total_db_a", "modes", "third_octaves", "faces_w")
