"""The pictures of the coupled system: its Campbell diagram, and what transmission errors do."""

from pathlib import Path

import numpy as np

from gearwhine.case import Case, mesh_frequencies
from gearwhine.figures.style import save, shortened
from gearwhine.figures.system_campbell import draw_system_campbell
from gearwhine.figures.transmissibility import draw_transmissibility
from gearwhine.output import file_stems
from gearwhine.stages.system import SolvedSystem


def draw_system(folder: Path, case: Case, solved: SolvedSystem) -> list[str]:
    """Draw the linear analyses of a case.

    Parameters
    ----------
    folder : path
        Where the files go: ``system-campbell.png`` where there is a diagram, ``transmissibility-PAIR.png`` for each
        gear pair that touches.
    case : Case
    solved : SolvedSystem
        Of the case.

    Returns
    -------
    list of str
        The files' names.
    """
    assert case.operation is not None
    files = []
    if solved.campbell is not None:
        figure = draw_system_campbell("Coupled modes over speed", solved.campbell, operating_speed=case.operation.speed)
        files.append(save(figure, folder / "system-campbell.png"))
    meshes = [frequency for frequency in mesh_frequencies(case) if frequency > 0.0] if case.gear_pair else []
    pairs = [one.excitation.removeprefix("transmission error of ") for one in solved.responses]
    # An arrow is no letter of a file's name.
    named = [name.replace(" -> ", "-") for name in pairs]
    for stem, name, response in zip(file_stems(named, "transmissibility-"), pairs, solved.responses, strict=True):
        limit = float(response.frequencies[-1] / (2.0 * np.pi))
        figure = draw_transmissibility(
            f"From the transmission error of {shortened(name, 26)}", response, mesh_frequencies=meshes, limit=limit
        )
        files.append(save(figure, folder / f"{stem}.png"))
    return files
