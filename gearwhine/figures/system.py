"""Figures of the coupled system: Campbell diagram and transmissibility."""

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from gearwhine.case import Case, mesh_frequencies
from gearwhine.figures.style import shortened
from gearwhine.figures.system_campbell import draw_system_campbell
from gearwhine.figures.transmissibility import draw_transmissibility
from gearwhine.output import file_stems
from gearwhine.stages.system import SolvedSystem


def draw_system(case: Case, solved: SolvedSystem) -> Iterator[tuple[str, Figure]]:
    """Draw the linear analyses of a case.

    Parameters
    ----------
    case : Case
    solved : SolvedSystem
        Of the case.

    Yields
    ------
    str
        Name of the figure: ``system-campbell`` where there is a diagram, ``transmissibility-PAIR`` for each gear pair
        that touches.
    matplotlib.figure.Figure
    """
    assert case.operation is not None
    if solved.campbell is not None:
        speed = case.operation.speed
        yield (
            "system-campbell",
            draw_system_campbell("Coupled modes over speed", solved.campbell, operating_speed=speed),
        )
    meshes = [frequency for frequency in mesh_frequencies(case) if frequency > 0.0] if case.gear_pair else []
    pairs = [one.excitation.removeprefix("transmission error of ") for one in solved.responses]
    # An arrow is no letter of a file's name.
    named = [name.replace(" -> ", "-") for name in pairs]
    for stem, name, response in zip(file_stems(named, "transmissibility-"), pairs, solved.responses, strict=True):
        limit = float(response.frequencies[-1] / (2.0 * np.pi))
        heading = f"From the transmission error of {shortened(name, 26)}"
        yield stem, draw_transmissibility(heading, response, mesh_frequencies=meshes, limit=limit)
