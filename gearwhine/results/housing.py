"""Housing modes: their quantities, and the mesh with the mode shapes as a file."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.output.quantity import Part, Quantity

if TYPE_CHECKING:
    from gearwhine.stages.housing import SolvedHousing


def _survey_shapes(solved: "SolvedHousing") -> Any:
    """Mode shapes at the survey points, shape (modes, points, 3)."""
    count = len(solved.modes.frequencies)
    return (solved.survey.matrix @ solved.modes.shapes.reshape(count, -1).T).T.reshape(count, -1, 3)


_MODE = ("housing_mode",)
HOUSING = (
    Quantity(
        "",
        lambda solved: np.arange(1, len(solved.modes.frequencies) + 1),
        "housing_mode",
        _MODE,
        "1",
        "number of the housing mode",
    ),
    Quantity("", lambda solved: ["x", "y", "z"], "component", ("component",)),
    Quantity(
        "",
        lambda solved: solved.modes.frequencies_hz,
        "housing_frequency",
        _MODE,
        "Hz",
        "housing natural frequency",
    ),
    Quantity(
        "",
        lambda solved: solved.total_damping_ratios,
        "housing_damping_ratio",
        _MODE,
        "1",
        "housing modal damping ratio",
    ),
    Part(
        "",
        lambda solved: solved.strengths,
        (
            Quantity(
                "",
                lambda strengths: strengths.acceleration,
                "housing_strength",
                _MODE,
                "kg-1",
                "lateral acceleration strength",
            ),
        ),
    ),
    Quantity(
        "",
        lambda solved: solved.survey.positions,
        "survey_position",
        ("survey_point", "component"),
        "m",
        "survey points on the housing's outer faces",
    ),
    Quantity(
        "", lambda solved: solved.survey.normals, "survey_normal", ("survey_point", "component"), "1", "outward normals"
    ),
    Quantity(
        "",
        _survey_shapes,
        "survey_shape",
        (*_MODE, "survey_point", "component"),
        "kg-0.5",
        "mass-normalised mode shapes at the survey points",
    ),
)
"""Of the housing's modes."""


def write_shapes(path: Path, housing: "SolvedHousing") -> None:
    """Write the mesh with every mode shape as a point array, for ParaView and its like."""
    import meshio

    shapes = {
        f"mode {number:02d}, {frequency:.1f} Hz": shape
        for number, (frequency, shape) in enumerate(
            zip(housing.modes.frequencies_hz, housing.modes.shapes, strict=True), start=1
        )
    }
    cells = [(block.kind, block.nodes) for block in housing.mesh.blocks]
    # Uncompressed: packing shapes takes ten times as long as writing them, and saves a tenth.
    content = meshio.Mesh(housing.mesh.points, cells, point_data=shapes)
    meshio.write(path, content, file_format="vtu", compression=None)
