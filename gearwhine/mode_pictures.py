"""Mode pictures: the selection of mode shapes, and their drawing as pictures, films or animated models."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from gearwhine.case import CaseError, Problem
from gearwhine.case.errors import UNSAID
from gearwhine.coupling.linear.line_outputs import SensorAmplitude
from gearwhine.housing import HousingModes
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress
from gearwhine.numerics.result_warnings import warning
from gearwhine.output import file_stems
from gearwhine.output.files import MODE_CACHE_FILE
from gearwhine.output.report import MovingShape
from gearwhine.view_names import ModeFormat as ModeFormat
from gearwhine.view_names import View as View

if TYPE_CHECKING:
    from gearwhine.case.measured import Measured
    from gearwhine.coupling.load_analysis.influences import LoadSensitivity
    from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
    from gearwhine.coupling.sound.solution import SolvedSound
    from gearwhine.housing.correlation.comparison import Comparison
    from gearwhine.housing.modal_test import ComparedTest
    from gearwhine.housing.pictures.drawn_shapes import DrawnHousing, DrawnShape
    from gearwhine.solve.operating_shapes import RunLine

_TWO_PI = 2.0 * np.pi
_MICRO = 1e6
_PER_MM_DM2 = 10.0  # µrad by mm dm², in one rad/m³
_SHOWN_PART = 0.98  # quantile of a density that ends its scale, since densities are unbounded in sharp edges
_DECADES = 1.0 / np.log(10.0)  # decades of a relative change
_LOUDEST, _HEARD = 3, 1e-3  # lines whose intensity is drawn, and their least part of the loudest one's power
_MOST_MODES = 5000

_DOMINANT = 8
_OPPOSITE = {"iso": "iso-opposite"}  # opposite view, for pictures of both sides
_MOVING_LINES, _MOVING_MODES = 6, 60  # largest numbers of operating shapes and modes that move in a report
_BYTES, _BYTES_OF_TRIANGLE = 4e6, 20.0  # size of all their models, and of a triangle, compressed and in base64
_TRIANGLES = 1500, 10000  # least and largest number of triangles of a model


def check_request(which: str | None, mode_format: ModeFormat, lines: Sequence[float]) -> None:
    """Refuse requests that cannot be drawn, before anything is solved.

    Raises
    ------
    CaseError
        For numbers of modes that are none, and lines as models or below zero.
    gearwhine.housing.errors.RendererUnavailableError, gearwhine.housing.errors.EncoderUnavailableError
        Where no renderer or encoder is available.
    """
    if which not in (None, "dominant", "all"):
        parse_numbers(str(which), None)
    if lines and mode_format == "glb":
        raise CaseError(
            [Problem("--format", mode_format, "png, gif or mp4 with --line, whose points need not move in phase")]
        )
    for line in lines:
        if not 0.0 < line < np.inf:
            raise CaseError([Problem("--line", line, "a frequency above zero [Hz]")])
    if mode_format != "glb" and (which is not None or lines):
        from gearwhine.housing.pictures.scene import find_renderer

        find_renderer()
    if mode_format == "mp4":
        from gearwhine.housing.pictures.images import find_encoder

        find_encoder()


def require_survey(measured: "Measured") -> None:
    """Refuse measured shapes without a survey.

    Raises
    ------
    CaseError
        Where the measured modes have no points.
    """
    if measured.survey is None or measured.survey.geometry is None:
        raise CaseError([Problem("measured.file", UNSAID, "a survey with points and shapes, for render --measured")])


def draw_modes(
    housing: HousingModes,
    comparison: "Comparison | None",
    which: str,
    view: str,
    mode_format: ModeFormat,
    place: Path,
    progress: Progress,
    besides: Iterable[int] = (),
    *,
    with_sheet: bool = True,
    drawn: Collection[str] = (),
) -> list[str]:
    """Draw modes into a folder and name the files.

    Parameters
    ----------
    housing : HousingModes
    comparison : Comparison or None
        Comparison with measured modes; modes with a measured partner count as the dominant ones, as the picture notes.
    which : str
        ``dominant``, ``all``, or numbers as :func:`parse_numbers` reads them.
    view : str
        Direction of view of pictures and films.
    mode_format : {"png", "glb", "gif", "mp4"}
        A picture of each mode and one sheet of all; or a model, or a film, of each.
    place : path
    progress : callable
    besides : iterable of int
        Numbers of further modes.
    with_sheet : bool
        Whether pictures of several modes have a sheet of all.
    drawn : collection of str
        Names of pictures that are drawn already, without ending.
    """
    notes = {}
    if comparison is not None:
        notes = {
            pair.mode: f"measured {pair.measured / _TWO_PI:.0f} Hz ({pair.error_percent:+.1f} %"
            + (")" if pair.mac is None else f", MAC {pair.mac:.2f})")
            for pair in comparison.pairs
        }
    count = len(housing.modes.frequencies)
    if which == "all":
        numbers = list(range(1, count + 1))
    elif which == "dominant":
        numbers = sorted(notes) if notes else housing.strongest_modes(_DOMINANT)
    else:
        numbers = parse_numbers(which, count)
    numbers = sorted({*numbers, *besides})
    if mode_format == "glb":
        from gearwhine.housing.pictures.gltf import write_mode_models

        return [path.name for path in write_mode_models(housing.mesh, housing.modes, numbers, place, housing.up)]
    from gearwhine.drawing_process import draw_in_process
    from gearwhine.housing.pictures.drawn_shapes import drawn_housing, drawn_modes

    surface = drawn_housing(housing.mesh, housing.up)
    shapes = drawn_modes(surface, housing.modes, numbers, notes)
    sheet = "modes.png" if with_sheet and len(numbers) > 1 and mode_format == "png" else None
    return draw_in_process(surface, shapes, place, mode_format, view, progress, sheet=sheet, drawn=drawn)


def draw_lines(
    housing: HousingModes,
    folder: Path,
    frequencies: Sequence[float],
    view: str,
    mode_format: ModeFormat,
    place: Path,
    progress: Progress,
) -> list[dict[str, Any]]:
    """Draw operating shapes at lines of the run in ``folder`` into ``place``; return their documents.

    Raises
    ------
    CaseError
        As :func:`gearwhine.solve.operating_shapes.read_spectrum_lines`.
    """
    from gearwhine.housing.pictures.drawn_shapes import drawn_housing
    from gearwhine.solve.operating_shapes import lines_document, read_spectrum_lines

    lines = read_spectrum_lines(folder, frequencies, housing)
    draw_operating_shapes(housing, lines, view, mode_format, place, progress)
    return lines_document(lines, housing, drawn_housing(housing.mesh, housing.up))


def draw_operating_shapes(
    housing: HousingModes,
    lines: "Sequence[RunLine]",
    view: str,
    mode_format: ModeFormat,
    place: Path,
    progress: Progress,
) -> list[str]:
    """Draw the housing at lines of a run into ``place``, and name the files: ``line-1283.3Hz.png`` and so on."""
    from gearwhine.drawing_process import draw_in_process
    from gearwhine.housing.pictures.drawn_shapes import drawn_housing
    from gearwhine.solve.operating_shapes import operating_shape_of_line

    surface = drawn_housing(housing.mesh, housing.up)
    shapes = [operating_shape_of_line(line, housing.modes, surface) for line in lines]
    return draw_in_process(surface, shapes, place, mode_format, view, progress)


def moving_shapes(folder: Path) -> list[MovingShape]:
    """Return all modes stored in a results folder, and the operating shapes at a run's highest lines, as 3D models.

    Parameters
    ----------
    folder : path
        Results folder; the list is empty where it holds no readable modes of a housing.
    """
    from gearwhine.housing.errors import ModeFileError
    from gearwhine.housing.pictures.drawn_shapes import drawn_housing, drawn_modes
    from gearwhine.housing.pictures.gltf import light_model
    from gearwhine.housing.storage.mode_file import read_modes
    from gearwhine.solve.operating_shapes import operating_shape_of_line, stored_lines

    try:
        record = read_modes(folder / MODE_CACHE_FILE)
    except (OSError, ModeFileError):
        return []
    surface = drawn_housing(record.mesh)
    lines = stored_lines(folder, record, _MOVING_LINES)
    shapes = [operating_shape_of_line(line, record.modes, surface) for line in lines]
    shapes += drawn_modes(surface, record.modes, range(1, min(len(record.modes.shapes), _MOVING_MODES) + 1))
    triangles = int(np.clip(_BYTES / (_BYTES_OF_TRIANGLE * len(shapes)), *_TRIANGLES))
    return [
        MovingShape(shape.name, shape.title, shape.note, light_model(surface, shape, triangles)) for shape in shapes
    ]


def draw_load_pictures(
    housing: HousingModes | None, solved: "SolvedLoad", place: Path, progress: Progress
) -> list[dict[str, Any]]:
    """Draw a housing at an operating point, and its sensitivity where that is known; return warnings.

    Without a renderer a warning says that pictures are missing; numbers and figures remain.
    """
    from gearwhine.drawing_process import one_process
    from gearwhine.housing.errors import RendererUnavailableError

    if housing is None or solved.point.housing is None:
        return []
    try:
        with one_process():
            draw_deflection(housing, solved.point.housing, "iso", place, progress)
            if solved.sensitivity is not None:
                draw_sensitivity(housing, solved, "iso", place, progress)
    except RendererUnavailableError as error:
        return [warning("pictures", f"no picture of the housing: {error}")]
    return []


def draw_deflection(
    housing: HousingModes, coordinates: FloatArray, view: str, place: Path, progress: Progress
) -> list[str]:
    """Draw the housing under a static load as ``load-housing.png``, from two opposite sides.

    Parameters
    ----------
    housing : HousingModes
    coordinates : ndarray, shape (n_modes + n_residual,)
        Coordinates of its modes and its residual modes.
    view : str
        Direction of view.
    place : path
    progress : callable

    Raises
    ------
    gearwhine.housing.errors.RendererUnavailableError
        Where no renderer is available.
    """
    from gearwhine.drawing_process import draw_in_process
    from gearwhine.housing.pictures.drawn_shapes import DRAWN_SCALE, DrawnShape, drawn_housing

    surface = drawn_housing(housing.mesh, housing.up)
    motion = housing.modes.displacement(coordinates, surface.nodes)
    largest = _MICRO * float(np.linalg.norm(motion, axis=1).max())
    if largest == 0.0:
        return []
    factor = DRAWN_SCALE * surface.diagonal * _MICRO / largest
    title = "Housing under the mean load"
    note = f"largest {largest:.3g} µm, drawn {float(f'{factor:.2g}'):.0f} times as large"
    shape = DrawnShape("load-housing", title, note, motion, "Displacement [µm]", largest)
    return draw_in_process(surface, [shape], place, "png", view, progress, beside=_OPPOSITE.get(view))


def draw_sensitivity(
    housing: HousingModes, solved: "SolvedLoad", view: str, place: Path, progress: Progress
) -> list[str]:
    """Draw where material on the housing changes the misalignment of each pair, a sensor's line and the sound power.

    They are ``load-sensitivity-PAIR.png``, ``load-sensitivity-line.png`` and ``load-sensitivity-sound.png``, each from
    two opposite sides.

    Parameters
    ----------
    housing : HousingModes
    solved : SolvedLoad
        Operating point in this housing, with its sensitivity.
    view : str
        Direction of view.
    place : path
    progress : callable

    Raises
    ------
    gearwhine.housing.errors.RendererUnavailableError
        Where no renderer is available.
    """
    from gearwhine.drawing_process import draw_in_process
    from gearwhine.figures.style import shortened
    from gearwhine.housing.pictures.drawn_shapes import DrawnShape, drawn_housing

    if solved.sensitivity is None or solved.sensitivity.density is None or solved.point.housing is None:
        return []
    surface = drawn_housing(housing.mesh, housing.up)
    motion = housing.modes.displacement(solved.point.housing, surface.nodes)
    names = [f"{pair.pair.driver.name}-{pair.pair.driven.name}" for pair in solved.point.pairs]
    shapes = []
    for stem, pair, density in zip(
        file_stems(names, "load-sensitivity-"), solved.point.pairs, solved.sensitivity.density, strict=True
    ):
        values = _PER_MM_DM2 * density[surface.nodes]
        largest = float(np.quantile(np.abs(values), _SHOWN_PART))
        if largest == 0.0 or not motion.any():
            continue
        driver, driven = (shortened(name, 14) for name in pair.names)
        title = f"{driver} on {driven}: misalignment by added material"
        note = (
            f"{_MICRO * pair.misalignment:.3g} µrad now; blue lowers, red raises it by each mm on a dm² of surface. "
            f"{100.0 * (1.0 - _SHOWN_PART):.2g} % lie beyond the scale."
        )
        quantity = "Change [µrad/(mm·dm²)]"
        shapes.append(DrawnShape(stem, title, note, motion, quantity, largest, values))
    # The shapes of one call have one scale and one quantity.
    groups = [group for group in (shapes, *_line_shapes(solved.sensitivity, surface.nodes)) if group]
    return [
        name
        for group in groups
        for name in draw_in_process(surface, group, place, "png", view, progress, beside=_OPPOSITE.get(view))
    ]


def _line_shapes(sensitivity: "LoadSensitivity", nodes: npt.NDArray[np.int64]) -> "Iterator[list[DrawnShape]]":
    """Change of the level of the sensor's line and of the sound that are ranked, by material on the surface."""
    from gearwhine.figures.style import shortened
    from gearwhine.housing.acoustics.sound_levels import power_level

    if sensitivity.lines is None:
        return
    if sensitivity.line_density is not None:
        line = sensitivity.sensor_lines[sensitivity.line]
        assert isinstance(line.output, SensorAmplitude)
        title = f"{shortened(line.output.sensor, 20)} at {line.frequency / _TWO_PI:.0f} Hz: level by added material"
        values = 20.0 * _DECADES / line.value * sensitivity.line_density[nodes]
        now = f"{line.value:.3g} m/s²"
        yield _level_shape("load-sensitivity-line", title, now, sensitivity.lines.field(line.motion)[nodes], values)
    if sensitivity.sound_density is not None:
        powers = sensitivity.sound_weights * [loud.line.value for loud in sensitivity.loudest_lines]
        line = sensitivity.loudest_lines[int(np.argmax(powers))].line
        level, values = (
            float(power_level(powers.sum())),
            10.0 * _DECADES / powers.sum() * sensitivity.sound_density[nodes],
        )
        if sensitivity.sound_line is None:
            subject, now = f"{len(powers)} loudest lines", f"{level:.1f} dB(A)"
        else:
            subject, now = f"Sound at {line.frequency / _TWO_PI:.0f} Hz", f"{level:.1f} dB"
        title = f"{subject}: sound power level by added material"
        yield _level_shape("load-sensitivity-sound", title, now, sensitivity.lines.field(line.motion)[nodes], values)


def _level_shape(
    name: str, title: str, now: str, motion: npt.NDArray[np.complex128], density: FloatArray
) -> "list[DrawnShape]":
    """Change of a level by material on the surface [dB/m³], on the housing's motion at its line."""
    from gearwhine.housing.pictures.drawn_shapes import DrawnShape

    values = _PER_MM_DM2 * 1e-6 * density
    largest = float(np.quantile(np.abs(values), _SHOWN_PART))
    if largest == 0.0:
        return []
    # At the instant of the largest motion.
    turned = motion * np.exp(-0.5j * np.angle(np.sum(motion**2)))
    note = (
        f"{now} now; blue lowers, red raises it by each mm on a dm² of surface. "
        f"{100.0 * (1.0 - _SHOWN_PART):.2g} % lie beyond the scale."
    )
    return [DrawnShape(name, title, note, turned.real, "Change [dB/(mm·dm²)]", largest, values)]


def draw_sound_pictures(
    solved: "SolvedSound", place: Path, progress: Progress, up: Sequence[float] = (0.0, 1.0, 0.0)
) -> list[dict[str, Any]]:
    """Draw where the housing radiates; return warnings.

    They are ``sound-faces-all.png`` over all lines and ``sound-faces-123.4Hz.png`` at each of the loudest, each on
    a scale of its own and from two opposite sides: red places send sound out, blue ones take it in. Without a renderer
    a warning says so.

    Parameters
    ----------
    solved : SolvedSound
    place : path
    progress : callable
    """
    from gearwhine.drawing_process import draw_in_process
    from gearwhine.housing.errors import RendererUnavailableError

    shapes = _intensity_shapes(solved)
    try:
        if shapes:
            surface = _radiating_surface(solved, up)
            # Flat faces radiate to one side; another surface is closed, and the first view shows half of it.
            beside = None if solved.radiation.method == "rayleigh" else _OPPOSITE["iso"]
            draw_in_process(surface, shapes, place, "png", "iso", progress, beside=beside)
    except RendererUnavailableError as error:
        return [warning("pictures", f"no picture of the radiating surface: {error}")]
    return []


def _radiating_surface(solved: "SolvedSound", up: Sequence[float] = (0.0, 1.0, 0.0)) -> "DrawnHousing":
    """Return the triangles of all radiating surfaces."""
    from gearwhine.housing.pictures.drawn_shapes import DrawnHousing

    surfaces = [elements.surface for elements in solved.radiation.elements]
    starts = np.cumsum([0, *(len(surface.points) for surface in surfaces)])
    triangles = [surface.triangles + start for surface, start in zip(surfaces, starts, strict=False)]
    points = np.concatenate([surface.points for surface in surfaces])
    return DrawnHousing(points, np.concatenate(triangles), np.arange(len(points)), np.array(up))


def _intensity_shapes(solved: "SolvedSound") -> "list[DrawnShape]":
    """Mean sound intensity out of the surface over all lines, and at each of the loudest."""
    from gearwhine.housing.acoustics.sound_levels import power_level
    from gearwhine.housing.pictures.drawn_shapes import DrawnShape

    lines = sorted((line for line in solved.lines if line.sound.power > 0.0), key=lambda line: -line.sound.power)
    if not lines:
        return []
    loudest = [line for line in lines[:_LOUDEST] if line.sound.power >= _HEARD * lines[0].sound.power]
    surface = _radiating_surface(solved)
    areas = np.concatenate([elements.surface.areas for elements in solved.radiation.elements])
    corners, weights = surface.triangles.ravel(), np.repeat(areas, 3)
    total = np.bincount(corners, weights, len(surface.rest))

    def at_points(intensity: FloatArray) -> FloatArray:
        """Mean of the triangles around each point, by area."""
        return np.asarray(np.bincount(corners, np.repeat(intensity * areas, 3), len(surface.rest)) / total)

    every = at_points(np.sum([line.sound.intensity for line in lines], axis=0))
    power = sum(line.sound.power for line in lines)
    entries = [("sound-faces-all", "Sound intensity, all lines", every, power)]
    for line in loudest:
        name, title = f"sound-faces-{line.frequency_hz:.1f}Hz", f"Sound intensity at {line.frequency_hz:.0f} Hz"
        entries.append((name, title, at_points(line.sound.intensity), line.sound.power))
    ends = [float(np.quantile(np.abs(values), _SHOWN_PART)) for *_, values, _ in entries]
    if min(ends) == 0.0:
        return []
    units = ((1.0, "W"), (1e3, "mW"), (1e6, "µW"), (1e9, "nW"))
    factor, unit = next((scale for scale in units if scale[0] * ends[0] >= 1.0), units[-1])
    # The estimate ρ c v² is nowhere negative.
    takes_in = "the estimate absorbs nowhere" if solved.radiation.method == "erp" else "blue absorbs"
    beyond = f"{100.0 * (1.0 - _SHOWN_PART):.2g} % lie beyond the scale."
    return [
        DrawnShape(
            name,
            title,
            f"{power_level(power):.1f} dB re 1 pW; red radiates, {takes_in}. {beyond}",
            np.zeros_like(surface.rest),
            f"Intensity [{unit}/m²]",
            factor * end,
            factor * values,
        )
        for (name, title, values, power), end in zip(entries, ends, strict=True)
    ]


def draw_measured(
    title: str, housing: HousingModes, compared: "ComparedTest | None", view: str, place: Path
) -> list[str]:
    """Draw measured shapes beside those of the model that they are paired with, as ``measured-and-model.png``.

    Raises
    ------
    CaseError
        Where no measured mode has a partner.
    """
    from gearwhine.figures import ShapePair, draw_measured_shapes, save
    from gearwhine.housing.pictures.drawn_shapes import laid_over, point_motions, wireframe
    from gearwhine.housing.pictures.views import viewing_direction

    shapes = None if compared is None else compared.test.modes.shapes
    if compared is None or compared.survey is None or shapes is None or not compared.comparison.pairs:
        raise CaseError([Problem("measured.file", UNSAID, "measured shapes of which some are like the model's")])
    geometry, of_model = compared.survey.geometry, compared.survey.shapes(housing.modes.shapes)
    shape_pairs = []
    for pair in compared.comparison.pairs:
        model = of_model[pair.mode - 1]
        laid = laid_over(shapes[pair.measured_mode - 1], model)
        likeness = "" if pair.mac is None else f", MAC {pair.mac:.2f}"
        shape_pairs.append(
            ShapePair(
                f"{pair.measured / _TWO_PI:.0f} Hz measured, mode {pair.mode} at {pair.model / _TWO_PI:.0f} Hz "
                f"({pair.error_percent:+.1f} %{likeness})",
                point_motions(geometry, laid),
                # Directions that are not measured are left out of both.
                point_motions(geometry, np.where(np.isfinite(laid), model, np.nan)),
            )
        )
    up = np.array(housing.up)
    figure = draw_measured_shapes(
        f"Measured and model shapes: {title}",
        geometry.positions,
        wireframe(geometry),
        shape_pairs,
        viewing_direction(view, up),
        up,
    )
    return [save(figure, place / "measured-and-model.png")]


def parse_numbers(text: str, count: int | None) -> list[int]:
    """Mode numbers from text such as ``1,4-6``; ``count`` is how many modes there are, where that is known.

    Raises
    ------
    CaseError
        For anything else, or a mode that does not exist.
    """
    numbers: list[int] = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        if not first.strip().isdecimal() or (last and not last.strip().isdecimal()):
            raise CaseError([Problem("--modes", text, "'dominant', 'all', or numbers such as '1,4,9' or '1-6'")])
        if int(last or first) > _MOST_MODES:
            raise CaseError([Problem("--modes", text, f"mode numbers of at most {_MOST_MODES}")])
        numbers += range(int(first), int(last or first) + 1)
    missing = [number for number in numbers if number < 1 or (count is not None and number > count)]
    if missing or not numbers:
        raise CaseError(
            [Problem("--modes", text, f"mode numbers from 1 to {count if count is not None else 'the last'}")]
        )
    return numbers
