"""Films of shapes: their frames by the rules of the motion, and what is said where nothing encodes them."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

from gearwhine.housing.errors import EncoderUnavailableError, RendererUnavailableError
from gearwhine.housing.pictures.drawn_shapes import DrawnHousing, DrawnShape, drawn_housing
from gearwhine.housing.pictures.images import animate_shapes, find_encoder
from gearwhine.housing.pictures.scene import find_renderer
from gearwhine.meshes import Mesh


@pytest.fixture(scope="module")
def housing(block: Callable[..., Mesh]) -> DrawnHousing:
    try:
        find_renderer()
    except RendererUnavailableError as error:
        pytest.skip(str(error))
    return drawn_housing(block((0.3, 0.1, 0.2), (2, 1, 1)))


def _bent(housing: DrawnHousing) -> np.ndarray:
    bend = np.zeros_like(housing.rest)
    bend[:, 1] = np.sin(np.pi * housing.rest[:, 0] / 0.3)
    return bend


def _film(housing: DrawnHousing, motion: np.ndarray, folder: Path) -> list[np.ndarray]:
    shape = DrawnShape("bent", "Bent", "", motion)
    (path,) = animate_shapes(housing, [shape], folder, "gif", size=(160, 120))
    assert [entry.name for entry in folder.iterdir()] == ["bent.gif"]
    with Image.open(path) as film:
        assert film.info["loop"] == 0
        return [np.asarray(frame.convert("RGB"), dtype=int) for frame in ImageSequence.Iterator(film)]


def test_a_mode_swings_there_and_back_on_white(housing: DrawnHousing, tmp_path: Path) -> None:
    frames = _film(housing, _bent(housing), tmp_path)
    assert len(frames) == 24
    for number in range(1, 12):
        assert np.array_equal(frames[number], frames[24 - number])
    assert np.abs(frames[0] - frames[12]).mean() > 2.0
    assert frames[0][-1, -1].tolist() == [255, 255, 255]


def test_a_running_wave_does_not_come_back_the_way_it_went(housing: DrawnHousing, tmp_path: Path) -> None:
    wave = np.zeros(housing.rest.shape, dtype=complex)
    wave[:, 1] = np.exp(-2.0j * np.pi * housing.rest[:, 0] / 0.3)
    frames = _film(housing, wave, tmp_path)
    assert np.abs(frames[6] - frames[18]).mean() > 1.0


def test_without_ffmpeg_mp4_names_it_and_gif(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(__import__("sys").modules, "imageio_ffmpeg", None)
    with pytest.raises(EncoderUnavailableError, match=r"ffmpeg.*--format gif"):
        find_encoder()


def test_an_encoder_that_fails_is_quoted(
    housing: DrawnHousing, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    encoder = tmp_path / "bin" / "ffmpeg"
    encoder.parent.mkdir()
    encoder.write_text("#!/bin/sh\ncat > /dev/null\necho 'no such codec' >&2\nexit 3\n", encoding="ascii")
    encoder.chmod(0o755)
    monkeypatch.setenv("PATH", f"{encoder.parent}:/bin:/usr/bin")
    with pytest.raises(EncoderUnavailableError, match="no such codec"):
        animate_shapes(
            housing, [DrawnShape("bent", "Bent", "", _bent(housing))], tmp_path / "out", "mp4", size=(64, 48)
        )
    assert not (tmp_path / "out" / "bent.mp4").exists()
