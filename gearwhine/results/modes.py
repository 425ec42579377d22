"""Natural modes of a housing: the quantities of those of reduced matrices, and how all are shown.

Those of a mesh are declared in :mod:`gearwhine.results.housing`.
"""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.output.quantity import Fields, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import Document, Section, columns_of, table_of
from gearwhine.results import housing
from gearwhine.results.check import REDUCED_HOUSING, reduced_lines

if TYPE_CHECKING:
    from gearwhine.housing.reduced import ReducedHousing

_AXES = ("x", "y", "z")


class _Mode(NamedTuple):
    """Mode of a reduced housing.

    Attributes
    ----------
    number : int
        Number of the housing mode.
    frequency_hz : float
        Housing natural frequency [Hz].
    damping_ratio : float or None
        Housing modal damping ratio.
    moves_most : str
        Node and axis of the largest motion; rotations count at the arm of the housing's extent.
    translations : ndarray, shape (n_nodes, 3)
        Translations of the interface nodes by the mass-normalised mode [1/√kg].
    """

    number: int
    frequency_hz: float
    damping_ratio: float | None
    moves_most: str
    translations: FloatArray


def _modes(reduced: "ReducedHousing") -> list[_Mode]:
    nodes = reduced.matrices.nodes
    motions = reduced.node_motions()
    arm = reduced.extent
    modes = []
    for place, (frequency, ratio) in enumerate(zip(reduced.frequencies_hz, reduced.damping_ratios(), strict=True)):
        node, motion = divmod(int((np.abs(motions[place]) * ([1.0] * 3 + [arm] * 3)).argmax()), 6)
        where = f"node {nodes[node]} {'along' if motion < 3 else 'about'} {_AXES[motion % 3]}"
        damping = float(ratio) if np.isfinite(ratio) else None
        modes.append(_Mode(place + 1, float(frequency), damping, where, motions[place, :, :3]))
    return modes


MODE = (
    Quantity("number", "number", "housing_mode", unit="1", heading="mode", shown="d"),
    Quantity("frequency_hz", "frequency_hz", "housing_frequency", heading="frequency [Hz]", shown=".2f"),
    Quantity("damping_ratio", "damping_ratio", "housing_damping_ratio", unit="1", heading="damping ratio", shown=".4f"),
    Quantity("moves_most", heading="moves most"),
    in_file("node_translation", "node component", "translations", unit="kg-0.5"),
)
"""Quantities of one mode."""

REDUCED_MODES: Fields = (
    in_file("component", "component", lambda reduced: ["x", "y", "z"]),
    in_file("node", "node", lambda reduced: np.array(reduced.matrices.nodes), "interface node", "1"),
    Rows("modes", _modes, MODE, "housing_mode"),
    *REDUCED_HOUSING,
)
"""Quantities of a housing of reduced matrices with its modes."""


def reduced_modes_document(reduced: "ReducedHousing") -> dict[str, Any]:
    """Return the modes as the command's JSON."""
    return {"reduced_housing": document_of(REDUCED_MODES, reduced)}


def report(document: Document) -> Section:
    """Chapter of the report: the modes, and what is proved of the matrices."""
    lines = [line for line in reduced_lines(document) if not line.startswith("natural frequencies")]
    return Section("Housing modes", (*table_of(columns_of(MODE), document["reduced_housing"]["modes"]), *lines))


def sections(document: Document) -> tuple[Section, ...]:
    """Return the modes, and the checks of the model or what is proved of the matrices."""
    if "reduced_housing" not in document:
        return housing.sections(document)
    return (Section("", report(document).content),)


def detailed_sections(document: Document) -> tuple[Section, ...]:
    """Return the modes with all that is known of them."""
    return sections(document) if "reduced_housing" in document else housing.detailed_sections(document)
