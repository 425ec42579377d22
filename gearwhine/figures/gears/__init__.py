"""Figures of gear pairs: teeth, flanks, contact, mesh stiffness, transmission error; and all of a case as a set."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure

from gearwhine.coupling.analyses.gear_pairs import PairAnalysis
from gearwhine.coupling.gears.loaded.contact_pressure import mesh_pressure
from gearwhine.figures.gears.contact import draw_contact_path, draw_contact_pattern
from gearwhine.figures.gears.teeth import draw_flank_charts, draw_tooth_pair, has_charts
from gearwhine.figures.gears.transmission_error import draw_harris_map, draw_mesh_stiffness, draw_transmission_error
from gearwhine.figures.style import shortened
from gearwhine.numerics.progress import Progress, silent
from gearwhine.output import file_stems


def draw_gear_pairs(pairs: Sequence[PairAnalysis], progress: Progress = silent) -> Iterator[tuple[str, Figure]]:
    """Draw each pair: its teeth, stiffness, transmission error and flanks, and its analyses under load and over torque.

    Parameters
    ----------
    pairs : sequence of PairAnalysis
        Analyses that a pair lacks are not drawn.
    progress : callable
        Receives the name of the pair being drawn.

    Yields
    ------
    str
        Name of the figure: ``gears-DRIVER-DRIVEN-teeth`` and so on.
    matplotlib.figure.Figure
    """
    stems = file_stems([f"{pair.solved.pair.driver}-{pair.solved.pair.driven}" for pair in pairs], "gears-")
    for stem, pair in zip(stems, pairs, strict=True):
        progress(f"drawing gear pair {pair.label}")
        for kind, figure in _figures(pair):
            yield f"{stem}-{kind}", figure


def _figures(pair: PairAnalysis) -> Iterator[tuple[str, Figure]]:
    solved, geometry, contact = pair.solved, pair.solved.geometry, pair.solved.carrying_flanks
    name = f"{shortened(solved.pair.driver, 16)} → {shortened(solved.pair.driven, 16)}"
    loaded = solved.static.force > 0.0
    yield "teeth", draw_tooth_pair(geometry)
    yield (
        "stiffness",
        draw_mesh_stiffness(
            f"{name}: mesh stiffness",
            contact,
            solved.static,
            shared=loaded and solved.has_single_pairs,
            figures=pair.stiffness_figures,
        ),
    )
    harmonics = {"unloaded": pair.unloaded_harmonics}
    if loaded:
        harmonics["loaded"] = pair.harmonics
    yield (
        "transmission-error",
        draw_transmission_error(
            f"{name}: transmission error",
            solved.static.phases,
            pair.unloaded,
            harmonics,
            loaded=solved.static if loaded else None,
            hunting=solved.hunting,
        ),
    )
    if loaded and solved.has_single_pairs:
        # Over a face it has a picture of its own.
        pressure = pair.pressure if pair.pressure is not None and pair.pressure.ndim == 2 else None
        along = f"{name}: along the path of contact"
        mesh = pair.along_one_pair[0]
        if pressure is not None and mesh is not solved.static:
            pressure = mesh_pressure(geometry, contact, mesh)
        sheet = draw_contact_path(along, geometry, contact, pair.along_one_pair, pressure)
        yield "path", sheet
    if solved.static.line_loads is not None and loaded:
        sheet = draw_contact_pattern(f"{name}: contact pattern", geometry, contact, solved.static)
        yield "pattern", sheet
    best = None if pair.optimum is None else pair.optimum.relief
    if best is not None or has_charts(geometry):
        yield "flanks", draw_flank_charts(f"{name}: flanks", geometry, best)
    if pair.harris is not None and np.ptp(pair.harris.forces) > 0.0:
        sheet = draw_harris_map(
            f"{name}: Harris map", pair.harris, abs(geometry.driver.base_radius), torque=solved.torque
        )
        yield "harris-map", sheet
