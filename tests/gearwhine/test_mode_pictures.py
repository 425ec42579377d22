"""Pictures of a housing: which modes are drawn, and the captions, motions and densities of each shape.

The housing is a block that moves as a rigid body, so that every number is known; nothing is rendered.
"""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from gearwhine import drawing_process, figures, mode_pictures
from gearwhine.coupling.linear.line_outputs import SensorAmplitude
from gearwhine.coupling.load_analysis.influences import LoadSensitivity
from gearwhine.housing.measured.survey_data import MeasuredGeometry
from gearwhine.housing.pictures.drawn_shapes import DrawnShape
from gearwhine.numerics.progress import silent

UP = (0.0, 0.0, 1.0)
HZ = np.array([100.0, 250.0, 400.0, 650.0])


@pytest.fixture
def housing(block_of: Callable[..., Any]) -> Any:
    """A block of 2 m by 1 m by 2 m, diagonal 3 m, whose coordinates are its translation; four modes."""
    mesh = block_of("hexahedron", (2.0, 1.0, 2.0))
    shapes = np.ones((4, len(mesh.points), 3)) * np.arange(1.0, 5.0)[:, None, None]
    modes = SimpleNamespace(
        frequencies=2.0 * np.pi * HZ,
        frequencies_hz=HZ,
        shapes=shapes,
        displacement=lambda coordinates, nodes: np.tile(coordinates, (len(nodes), 1)),
    )
    return SimpleNamespace(mesh=mesh, up=UP, modes=modes, strongest_modes=lambda count: [4, 2][:count])


class Drawn(list[tuple[DrawnShape, dict[str, Any]]]):
    """Shapes that were to be rendered, each with the options of its call."""

    def __call__(self, surface: Any, shapes: Any, place: Path, form: str, view: str, *_: Any, **how: Any) -> list[str]:
        assert np.ptp(surface.rest, axis=0).tolist() == [2.0, 1.0, 2.0]
        assert surface.up.tolist() == list(UP)
        self += [(shape, how | {"place": place, "form": form, "view": view}) for shape in shapes]
        return [f"{shape.name}.{form}" for shape in shapes]


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> Drawn:
    drawn = Drawn()
    monkeypatch.setattr(drawing_process, "draw_in_process", drawn)
    return drawn


COMPARED = SimpleNamespace(
    pairs=[
        SimpleNamespace(mode=3, measured=2.0 * np.pi * 412.0, error_percent=-2.91, mac=0.875),
        SimpleNamespace(mode=1, measured=2.0 * np.pi * 98.0, error_percent=2.04, mac=None),
    ]
)


@pytest.mark.parametrize(
    ("which", "compared", "besides", "numbers"),
    [
        ("dominant", COMPARED, (), [1, 3]),
        ("dominant", None, (), [2, 4]),
        ("all", COMPARED, (), [1, 2, 3, 4]),
        ("2", COMPARED, (), [2]),
        ("2,4", None, (3, 4), [2, 3, 4]),
    ],
)
def test_modes_that_are_drawn(
    housing: Any, drawn: Drawn, which: str, compared: Any, besides: tuple[int, ...], numbers: list[int]
) -> None:
    names = mode_pictures.draw_modes(
        housing, compared, which, "front", "png", Path("p"), silent, besides, drawn=["mode-09-9Hz"]
    )
    assert names == [f"mode-{number:02d}-{HZ[number - 1]:.0f}Hz.png" for number in numbers]
    for number, (shape, how) in zip(numbers, drawn, strict=True):
        assert shape.title == f"Mode {number}   {HZ[number - 1]:.0f} Hz"
        notes = {1: "measured 98 Hz (+2.0 %)", 3: "measured 412 Hz (-2.9 %, MAC 0.88)"} if compared else {}
        assert shape.note == notes.get(number, "")
        assert (shape.motion == float(number)).all()
        sheet = "modes.png" if len(numbers) > 1 else None
        assert how == {"place": Path("p"), "form": "png", "view": "front", "sheet": sheet, "drawn": ["mode-09-9Hz"]}
    mode_pictures.draw_modes(housing, None, "all", "front", "gif", Path(), silent)
    mode_pictures.draw_modes(housing, None, "all", "front", "png", Path(), silent, with_sheet=False)
    assert [how["sheet"] for _, how in drawn[len(numbers) :]] == [None] * 8


def test_a_deflected_housing(housing: Any, drawn: Drawn) -> None:
    """5 µm are drawn as 7 % of the diagonal of 3 m: 42,000 times as large."""
    translation = np.array([3e-6, 0.0, -4e-6])
    assert mode_pictures.draw_deflection(housing, translation, "iso", Path(), silent) == ["load-housing.png"]
    mode_pictures.draw_deflection(housing, translation, "top", Path(), silent)
    assert mode_pictures.draw_deflection(housing, 0.0 * translation, "iso", Path(), silent) == []
    (shape, how), (_, from_above) = drawn
    assert (shape.title, shape.note) == ("Housing under the mean load", "largest 5 µm, drawn 42000 times as large")
    assert (shape.quantity, shape.largest, shape.values) == ("Displacement [µm]", pytest.approx(5.0), None)
    np.testing.assert_array_equal(shape.motion, np.tile(translation, (8, 1)))
    assert (how["beside"], from_above["beside"]) == ("iso-opposite", None)


def _solved(**changes: Any) -> Any:
    """A pair, a sensor's line and two of the sound, with densities that are even but at two nodes of eight."""
    part = np.array([-1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    line = SimpleNamespace(output=SensorAmplitude("roof", np.zeros(1), slice(0)), frequency=2.0 * np.pi * 1234.0)
    line.value, line.motion = 0.25, np.tile([0.0, 3j, 0.0], (8, 1))
    heard = [
        SimpleNamespace(frequency=2.0 * np.pi * f, value=p, motion=q)
        for f, p, q in ((700.0, 2e-6, 1.0), (900.0, 3e-6, 2.0))
    ]
    for one in heard:
        one.motion = np.tile([one.motion + 0j, 0.0, 0.0], (8, 1))
    sound = [SimpleNamespace(line=one, weighting=weight) for one, weight in zip(heard, (1.0, 0.5), strict=True)]
    lines = SimpleNamespace(of_sensors=(line,), sound=tuple(sound), field=lambda motion: motion)
    entries = {"density": 2.5 * part[None], "line_density": 125.0 * part, "sound_density": 7e-4 * part}
    pair = SimpleNamespace(driver=SimpleNamespace(name="pinion"), driven=SimpleNamespace(name="wheel"))
    at_point = SimpleNamespace(pair=pair, names=("a pinion of many letters", "wheel"), misalignment=12.5e-6)
    sensitivity = LoadSensitivity((), **cast(Any, {"lines": lines, **entries, **changes}))
    return SimpleNamespace(point=SimpleNamespace(housing=np.ones(3), pairs=[at_point]), sensitivity=sensitivity)


_BESIDE = "blue lowers, red raises it by each mm on a dm² of surface. 2 % lie beyond the scale."


def test_material_that_changes_misalignment_lines_and_sound(housing: Any, drawn: Drawn) -> None:
    """A mm on a dm² is 1e-5 m³; levels change by 20 lg of amplitudes and 10 lg of powers."""
    names = mode_pictures.draw_sensitivity(housing, _solved(), "iso", Path(), silent)
    stems = ["load-sensitivity-pinion-wheel", "load-sensitivity-line", "load-sensitivity-sound"]
    assert names == [f"{stem}.png" for stem in stems]
    of_pair, of_line, of_sound = (shape for shape, _ in drawn)
    assert {how["beside"] for _, how in drawn} == {"iso-opposite"}
    assert of_pair.title == "a pinion of m… on wheel: misalignment by added material"
    assert of_pair.note == f"12.5 µrad now; {_BESIDE}"
    assert (of_pair.quantity, of_pair.largest) == ("Change [µrad/(mm·dm²)]", pytest.approx(1e6 * 1e-5 * 2.5))
    assert (of_line.title, of_line.note) == ("roof at 1234 Hz: level by added material", f"0.25 m/s² now; {_BESIDE}")
    small = 1e-6  # of a mm dm²
    db_of_line = 20.0 * np.log10(1.0 + small * 1e-5 * 125.0 / 0.25) / small
    assert (of_line.quantity, of_line.largest) == ("Change [dB/(mm·dm²)]", pytest.approx(db_of_line))
    # Two lines of 2 µW and half of 3 µW together, on the motion of the more powerful.
    assert of_sound.title == "2 loudest lines: sound power level by added material"
    assert of_sound.note == f"{10.0 * np.log10(3.5e-6 / 1e-12):.1f} dB(A) now; {_BESIDE}"
    assert of_sound.largest == pytest.approx(10.0 * np.log10(1.0 + small * 1e-5 * 7e-4 / 3.5e-6) / small)
    assert of_sound.values is not None
    assert sorted(of_sound.values / of_sound.largest) == pytest.approx([-1.0] * 3 + [1.0] * 5)
    assert np.abs(of_sound.motion[:, 0]).tolist() == [1.0] * 8
    # At the instant of the largest motion, a quarter of a period from the real part.
    np.testing.assert_allclose(np.abs(of_line.motion), np.tile([0.0, 3.0, 0.0], (8, 1)), atol=1e-12)


def test_material_that_changes_one_line_of_the_sound(housing: Any, drawn: Drawn) -> None:
    mode_pictures.draw_sensitivity(housing, _solved(sound_line=1, line_density=None), "front", Path(), silent)
    _, (shape, how) = drawn
    assert shape.title == "Sound at 900 Hz: sound power level by added material"
    assert shape.note.startswith(f"{10.0 * np.log10(3e-6 / 1e-12):.1f} dB now; ")
    assert np.abs(shape.motion[:, 0]).tolist() == [2.0] * 8
    assert how["beside"] is None
    # Of a density that is zero there is no picture, nor of none.
    still = _solved(density=np.zeros((1, 8)), line_density=np.zeros(8), sound_density=None)
    assert mode_pictures.draw_sensitivity(housing, still, "iso", Path(), silent) == []
    assert mode_pictures.draw_sensitivity(housing, _solved(density=None), "iso", Path(), silent) == []


def test_measured_shapes_stand_beside_those_of_the_model(
    housing: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two points with three components; a measured shape at 90° to the model's lies over it, unmeasured ones rest."""
    axes = np.tile(np.eye(3), (2, 1))
    positions = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    geometry = MeasuredGeometry(("a", "b"), positions, np.repeat([0, 1], 3), axes, ((0, 1),))
    of_model = np.zeros((3, 6))
    of_model[2] = [1.0, 2.0, 2.0, 4.0, 0.0, 0.0]
    measured = np.array([2j * of_model[2]])
    measured[0, 3] = np.nan
    pair = SimpleNamespace(measured_mode=1, model=2.0 * np.pi * 400.0, **vars(COMPARED.pairs[0]))
    compared = SimpleNamespace(
        test=SimpleNamespace(modes=SimpleNamespace(shapes=measured)),
        survey=SimpleNamespace(geometry=geometry, shapes=lambda shapes: of_model),
        comparison=SimpleNamespace(pairs=[pair]),
    )
    seen = list[Any]()
    draw = figures.draw_measured_shapes
    monkeypatch.setattr(figures, "draw_measured_shapes", lambda *given: seen.append(given) or draw(*given))
    names = mode_pictures.draw_measured("lid", housing, cast(Any, compared), "front", tmp_path)
    assert names == ["measured-and-model.png"]
    ((title, places, edges, (drawn,), _, up),) = seen
    assert places is positions
    assert (title, edges.tolist(), up.tolist()) == ("Measured and model shapes: lid", [[0, 1]], list(UP))
    assert drawn.heading == "412 Hz measured, mode 3 at 400 Hz (-2.9 %, MAC 0.88)"
    np.testing.assert_allclose(drawn.measured, [[1.0, 2.0, 2.0], [0.0, 0.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(drawn.model, [[1.0, 2.0, 2.0], [0.0, 0.0, 0.0]], atol=1e-12)
    pair.mac = None
    mode_pictures.draw_measured("lid", housing, cast(Any, compared), "front", tmp_path)
    assert seen[1][3][0].heading.endswith("(-2.9 %)")
