"""Survey plan of the housing: its quantities, and how the terminal shows it."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from gearwhine.output.quantity import Part, Quantity, Rows, document_of
from gearwhine.output.sections import Column, Document, Section, columns_of, counted, table_of
from gearwhine.results.housing import ORIGIN

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from gearwhine.housing import HousingModes
    from gearwhine.housing.modal_test import PlannedSurvey


class _Sensor(NamedTuple):
    """Sensor of the plan: its label, position [m], direction, and share in the independence of the modes."""

    point: str
    position: "npt.NDArray[np.float64]"
    direction: "npt.NDArray[np.float64]"
    independence: float


class _Hammer(NamedTuple):
    """Place for the hammer: its position [m], its direction, and the least residue of a mode there."""

    position: "npt.NDArray[np.float64]"
    direction: "npt.NDArray[np.float64]"
    least_residue: float


SENSOR = (
    Quantity("point", heading="point"),
    Quantity("position_m"),
    Quantity("direction", heading="direction", shown=lambda row: _axis(row["direction"])),
    Quantity("independence", heading="independence", shown=".3f"),
)
"""Quantities of a sensor."""

HAMMER = (
    Quantity("position_m"),
    Quantity("direction"),
    Quantity("least_residue"),
)
"""Quantities of a place for the hammer."""


def _sensors(planned: "PlannedSurvey") -> list[_Sensor]:
    geometry = planned.geometry
    columns = (geometry.labels, geometry.positions, geometry.directions, planned.plan.independence)
    return [_Sensor(*row) for row in zip(*columns, strict=True)]


def _hammer(planned: "PlannedSurvey") -> list[_Hammer]:
    places = planned.plan.driving_points
    columns = (planned.candidates.positions[places], planned.candidates.directions[places], planned.plan.residues)
    return [_Hammer(*row) for row in zip(*columns, strict=True)]


PLAN = (
    Quantity("modes"),
    Quantity("modes_hz", "frequencies_hz"),
    Quantity("candidates", lambda planned: len(planned.candidates.labels)),
    Rows("sensors", _sensors, SENSOR),
    Rows("hammer", _hammer, HAMMER),
    Part(
        "",
        "plan",
        (
            Quantity("auto_mac_largest", "worst_likeness"),
            Quantity("condition"),
        ),
    ),
)
"""Quantities of a survey plan and of its quality."""


def plan_document(planned: "PlannedSurvey", solved: "HousingModes") -> dict[str, Any]:
    """Return the survey plan as the command's JSON."""
    return document_of(PLAN, planned) | document_of(ORIGIN, solved)


_POINT, *_ALONG = columns_of(SENSOR)
_SENSORS = (_POINT, *(Column(f"{axis} [mm]", f"position_m.{at}", ".1f", 1e3) for at, axis in enumerate("xyz")), *_ALONG)


def sections(document: Document) -> tuple[Section, ...]:
    """Return sensor positions, the hammer position, and how well they separate the modes."""
    return (Section("", (*table_of(_SENSORS, document["sensors"]), *_sentences(document))),)


def _sentences(document: Document) -> Iterator[str]:
    yield (
        f"{counted(len(document['sensors']), 'sensor')} of {document['candidates']} places for "
        f"{counted(len(document['modes']), 'mode')} up to {document['modes_hz'][-1]:.0f} Hz: modes look at most "
        f"{document['auto_mac_largest']:.3f} alike (auto-MAC), condition {document['condition']:.3g}."
    )
    for number, place in enumerate(document["hammer"]):
        where = ", ".join(f"{1e3 * value:.1f}" for value in place["position_m"])
        yield (
            f"{'and' if number else 'Hammer:'} at ({where}) mm along {_axis(place['direction'])}: "
            f"the least excited mode has {100.0 * place['least_residue']:.2g} % of its largest driving-point residue"
        )


def _axis(direction: Sequence[float]) -> str:
    """Return an axis by its name, any other direction by its numbers."""
    for axis, value in zip("xyz", direction, strict=True):
        if abs(value) > 1.0 - 1e-9:
            return axis if value > 0.0 else f"-{axis}"
    return " ".join(f"{value:.3f}" for value in direction)
