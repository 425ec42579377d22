"""Housing modes: quantities of the modes, their proof and the model's health, how they are shown; shapes as a file."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gearwhine.output.quantity import ABSENT, HERTZ, Fields, Part, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import Column, Document, Picture, Section, Table, columns_of, counted, table_of
from gearwhine.results.housing_checks import effective_mass_document, health_document
from gearwhine.results.line_columns import LINE_NAME, line_frequency

if TYPE_CHECKING:
    import numpy.typing as npt

    from gearwhine.housing import HousingModes


class _Mode(NamedTuple):
    """Mode of the housing.

    Attributes
    ----------
    number : int
        Number of the housing mode.
    frequency_hz : float
        Housing natural frequency [Hz].
    damping_ratio : float
        Housing modal damping ratio.
    discretisation_error : float or None
        Estimate of the natural frequency's relative error by the mesh.
    strength : float or None
        Lateral acceleration strength [1/kg].
    effective_mass : array_like
    survey_shape : ndarray, shape (n_points, 3)
        Mass-normalised mode shapes at the survey points [1/√kg].
    """

    number: int
    frequency_hz: float
    damping_ratio: float
    discretisation_error: float | None
    strength: float | None
    effective_mass: Any
    survey_shape: "npt.NDArray[np.float64]"


def _modes(solved: "HousingModes") -> list[_Mode]:
    frequencies, ratios = solved.modes.frequencies_hz, solved.total_damping_ratios
    numbers = range(1, len(frequencies) + 1)
    strengths = [None] * len(numbers) if solved.strengths is None else solved.strengths.acceleration
    errors = solved.modes.discretisation_errors
    masses = solved.effective_mass.fractions
    return [
        _Mode(*row)
        for row in zip(
            numbers,
            frequencies,
            ratios,
            [None] * len(numbers) if errors is None else errors,
            strengths,
            masses,
            solved.survey_shapes,
            strict=True,
        )
    ]


MODE = (
    Quantity("number", "number", "housing_mode", unit="1", heading="mode", shown="d"),
    Quantity("frequency_hz", "frequency_hz", "housing_frequency", heading="frequency [Hz]", shown=".2f"),
    Quantity("damping_ratio", "damping_ratio", "housing_damping_ratio", unit="1", heading="damping ratio", shown=".4f"),
    Quantity(
        "discretisation_error",
        "discretisation_error",
        "housing_discretisation_error",
        unit="1",
        heading="mesh error [%]",
        shown=".2g",
    ),
    Quantity("strength", "strength", "housing_strength", unit="kg-1", heading="strength [1/kg]", shown=".4g"),
    Quantity("effective_mass"),
    in_file("survey_shape", "survey_point component", "survey_shape", unit="kg-0.5"),
)
"""Quantities of one mode."""

COUNT_CERTIFICATE = (
    Quantity("limit_hz"),
    Quantity("expected"),
    Quantity("found"),
    Quantity("complete"),
    Quantity("max_residual"),
)
"""Proof of modes by their count below a limit, of a housing or of a rotor."""

CERTIFICATE = (*COUNT_CERTIFICATE, Quantity("max_overlap"))
"""Proof of the housing's modes by the inertia count."""

MESH_SIZE = (
    Quantity("nodes", lambda mesh: len(mesh.points)),
    Quantity("elements", "n_elements"),
    Quantity("dofs", lambda mesh: 3 * len(mesh.points)),
)
"""Quantities of a mesh."""

_MOTIONS = ["x", "y", "z", "rotation_x", "rotation_y"]  # of a bearing
STATIC_ERROR = (
    Quantity("without_attachments", lambda solved: solved.missing_compliance.max()),
    Quantity("with_attachments", "modes.residual_modes.proof.error"),
    Quantity("attachments", lambda solved: len(solved.modes.residual_modes.frequencies)),
    Quantity(
        "without_attachments_at",
        lambda solved: dict(zip(solved.loaded, solved.missing_compliance.max(axis=1), strict=True)),
    ),
    Quantity("directions", lambda solved: _MOTIONS),
    Quantity(
        "without_attachments_along", lambda solved: dict(zip(solved.loaded, solved.missing_compliance, strict=True))
    ),
)
"""Part of the static compliance that the modes lack where the machine bears on the housing."""

SELECTION = (
    Quantity("from", lambda solved: list(solved.loaded)),
    Quantity("to", lambda solved: list(solved.sensors)),
    Part(
        "",
        "selection",
        (
            Quantity("band_hz", lambda chosen: [edge / HERTZ for edge in chosen.band]),
            Quantity("tolerance"),
            Quantity("keep", lambda chosen: chosen.kept + 1),
            Quantity("ranking", lambda chosen: chosen.ranking + 1),
            Quantity("strength_m_per_n", "strength"),
            Quantity("error_left"),
        ),
    ),
)
"""Modes that carry the motion from bearings to sensors, by number from 1."""

ORIGIN = (
    Quantity("reused", lambda solved: solved.source is not None),
    Quantity("modes_read_from", lambda solved: ABSENT if solved.source is None else str(solved.source)),
    Quantity("seconds_when_solved", lambda solved: ABSENT if solved.source is None else solved.record.notes["seconds"]),
    Quantity("warnings", "result_warnings"),
)
"""Origin of the modes, for every command that uses them."""


def static_error(solved: "HousingModes | None") -> "HousingModes | None":
    """Return the housing where it has residual attachments of known static error, else None."""
    return None if solved is None or solved.modes.residual_modes is None else solved


SOLID = (
    Quantity("mass_kg", lambda solid: solid.mass),
    Quantity("center_of_mass_m", lambda solid: solid.center),
)
"""Mass and centre of mass of the solid alone."""

HOUSING: Fields = (
    in_file("component", "component", lambda solved: ["x", "y", "z"]),
    Rows("modes", _modes, MODE, "housing_mode"),
    Part("certificate", "modes.certificate", CERTIFICATE),
    Part("mesh", "mesh", MESH_SIZE),
    Quantity("refinement", lambda solved: solved.refinement or ABSENT),
    Quantity("size_m", lambda solved: np.ptp(solved.mesh.points, axis=0)),
    Quantity("mass_kg"),
    Quantity("center_of_mass_m", "health.body.center"),
    Quantity("attached_mass_kg", "housing.attached_mass"),
    Quantity(
        "effective_mass",
        lambda solved: effective_mass_document(solved.effective_mass),
    ),
    Part("static_error", static_error, STATIC_ERROR),
    Quantity("health", lambda solved: health_document(solved.health)),
    Part("solid", lambda solved: solved.housing.solid(), SOLID),
    Quantity("seconds"),
    in_file(
        "survey_position",
        "survey_point component",
        "survey.positions",
        "survey points on the housing's outer faces",
        "m",
    ),
    in_file("survey_normal", "survey_point component", "survey.normals", "outward normals", "1"),
    in_file(
        "sensor_position",
        "sensor component",
        lambda solved: {name: port.position for name, port in solved.sensors.items()} or None,
        "point of the surface that the sensor is on",
        "m",
    ),
    in_file(
        "sensor_direction",
        "sensor component",
        lambda solved: {name: port.direction for name, port in solved.sensors.items()} or None,
        "direction of the sensor's acceleration",
        "1",
    ),
    Part("", ".", ORIGIN),
)
"""Quantities of a solved housing."""

_SELECTED: Fields = (Part("selection", lambda solved: None if solved.selection is None else solved, SELECTION),)


def modes_document(solved: "HousingModes", *, detail: bool = False) -> dict[str, Any]:
    """Return the modes as the command's JSON; in detail also the modes that carry motion from bearings to sensors."""
    return document_of((*HOUSING, *_SELECTED) if detail else HOUSING, solved)


def origin_document(solved: "HousingModes | None") -> dict[str, Any]:
    """Return the origin of a housing's modes, as every command's JSON has it; nothing without a housing."""
    return {} if solved is None else document_of(ORIGIN, solved)


def write_shapes(path: Path, housing: "HousingModes") -> None:
    """Write the mesh with every mode shape as a point array, for ParaView and its like."""
    from gearwhine.meshes.formats.meshio_formats import load_meshio

    meshio = load_meshio()
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


_SHORT_DIRECTION_NAMES = {"rotation_x": "rot x", "rotation_y": "rot y", "rotation_z": "rot z"}
_SHOWN = 1e-3  # smallest share of the effective mass that is shown


def report(document: Document) -> Section:
    """Chapter of the report: the modes and the proof that none is missing."""
    sentences = []
    if certificate := document.get("certificate"):
        complete = "complete" if certificate.get("complete") else "NOT complete"
        sentences.append(
            f"{certificate['found']} modes below {certificate['limit_hz']:.0f} Hz, {complete}: the inertia count "
            f"demands {certificate['expected']}; largest relative residual {certificate['max_residual']:.0e}."
        )
    if mesh := document.get("mesh"):
        sentences.append(
            f"{mesh['elements']} elements, {mesh['dofs']} degrees of freedom, {document.get('mass_kg', 0.0):.2f} kg."
        )
    modes = document.get("modes", ())
    tables = table_of(_LINKED, modes, anchor=lambda mode: mode_place(mode["number"]))
    pictures = (
        Picture("modes", "Modes side by side, each to a scale of its own; grey lines: at rest.", sheet_of="mode-"),
        *(mode_picture(mode["number"], mode["frequency_hz"], mode.get("damping_ratio")) for mode in modes),
        Picture("mode-", "Mode shape, deformed; grey lines: at rest.", small=True),
    )
    return Section("Housing modes", (*sentences, *tables), pictures=pictures)


def render_report(document: Document) -> Section:
    """Chapter of the report on pictures that were asked for: modes, operating shapes, measured shapes."""
    lines = document.get("lines", ())
    pictures = (
        Picture("modes", "Modes side by side, each to a scale of its own; grey: at rest.", sheet_of="mode-"),
        Picture("mode-", "Mode shape; grey: at rest, colour: displacement over the largest.", small=True),
        *(line_picture(line["frequency_hz"], line["name"]) for line in lines),
        Picture("line-", "Operating shape; grey: at rest, colour: displacement.", small=True),
        Picture("measured-and-model", "Measured shapes, left, and their partners in the model, right."),
    )
    return Section("Shapes", table_of(_LINES, lines, "Operating shapes"), pictures=pictures)


def line_picture(frequency_hz: float, name: str | None) -> Picture:
    """Return the picture of an operating shape with its caption."""
    named = f", {name}" if name else ""
    caption = f"Operating shape at {frequency_hz:.1f} Hz{named}; grey: at rest, colour: displacement."
    return Picture(f"line-{frequency_hz:.1f}Hz", caption, small=True)


_LINES = (
    line_frequency(lambda line: (line_picture(line["frequency_hz"], None).place,)),
    LINE_NAME,
    Column("largest [µm, peak]", "largest_displacement_m", ".3g"),
    Column("largest [m/s², peak]", "largest_acceleration_m_per_s2", ".3g"),
    Column(
        "kinetic energy by mode",
        lambda line: ", ".join(
            f"{mode['number']} ({mode['frequency_hz']:.0f} Hz) {100.0 * mode['kinetic_energy_share']:.0f} %"
            for mode in line["modes"][:3]
        ),
        numbers=tuple(
            f"modes.{place}.{key}" for place in range(3) for key in ("number", "frequency_hz", "kinetic_energy_share")
        ),
    ),
)


def mode_place(number: int) -> str:
    """Return the name of a housing mode's place in the report."""
    return f"housing mode {number}"


def mode_picture(number: int, frequency_hz: float, damping_ratio: float | None) -> Picture:
    """Return the picture of a housing mode with its caption."""
    damped = "" if damping_ratio is None else f", damping ratio {damping_ratio:.3g}"
    caption = f"Mode {number}, {frequency_hz:.0f} Hz{damped}; grey: at rest, colour: displacement over the largest."
    return Picture(f"mode-{number:02d}-", caption, small=True)


def shape_places(number: int) -> tuple[str, str]:
    """Return the names of a housing mode's places in the report: its picture, else its row."""
    return f"picture mode-{number:02d}-", mode_place(number)


_LINKED = (
    Column("mode", "number", "d", link=lambda mode: shape_places(mode["number"])[:1]),
    *columns_of(MODE)[1:],
)


_MODES = (
    Column("mode", "number", "d"),
    Column("frequency [Hz]", "frequency_hz", ".2f"),
    Column("damping", "damping_ratio", ".4g"),
    Column("mesh error [%]", "discretisation_error", ".2g"),
    Column("strength [1/kg]", "strength", ".3e"),
)
_CHECKS = (
    Column("check", "name"),
    Column(
        "value", "value", shown=lambda line: f"{line['value']:.0f}" if line["bound"] == 0 else f"{line['value']:.1e}"
    ),
    Column(
        "bound",
        "bound",
        shown=lambda line: "" if line["bound"] is None else f"{line['bound']:.0e}" if line["bound"] else "0",
    ),
    Column("", lambda line: "" if line["bound"] is None else "ok" if line["ok"] else "look"),
    Column("what it says", "why"),
)


def sections(document: Document) -> tuple[Section, ...]:
    """Return the modes, the checks of the model that break their bounds, and the static compliance at the bearings."""
    lines = [line for line in document["health"]["lines"] if line["bound"] is not None]
    broken = [line for line in lines if not line["ok"]]
    health: tuple[str | Table, ...] = (
        *table_of(_CHECKS, broken),
        f"Health of the model: {len(lines) - len(broken)} of {len(lines)} checks keep their bounds "
        "(--detail shows all).",
    )
    return (Section("", (*_modes_content(document), *health, *_static_error(document))),)


def detailed_sections(document: Document) -> tuple[Section, ...]:
    """Return the modes with every check, effective masses, the supports, and the modes that carry the forces."""
    content: tuple[str | Table, ...] = (
        *_modes_content(document),
        *table_of(_CHECKS, document["health"]["lines"]),
        *_static_error(document),
        *_effective_mass(document),
        *_supports(document["health"]["supports"], document["effective_mass"]["directions"]),
    )
    selection = document["selection"]
    return (Section("", content if selection is None else (*content, _selection(selection))),)


def _modes_content(document: Document) -> tuple[str | Table, ...]:
    return (*table_of(_MODES, document["modes"]), modes_sentence(document), *_refinement(document))


def _refinement(document: Document) -> Iterator[str]:
    if steps := document.get("refinement"):
        meshes = ", ".join(f"{1e3 * step['mesh_size_m']:.3g} mm {100 * step['largest_error']:.2g} %" for step in steps)
        yield f"Refined until every mode is within its accuracy; largest estimated error by elements of {meshes}"


def modes_sentence(document: Document) -> str:
    """Return the number of modes, their proof and their cost in words."""
    certificate, mesh = document["certificate"], document["mesh"]
    return (
        f"Housing: {counted(certificate['found'], 'mode')} below {certificate['limit_hz']:.5g} Hz, the inertia demands "
        f"{certificate['expected']}; largest residual {certificate['max_residual']:.0e}; {document['mass_kg']:.2f} kg, "
        f"{mesh['dofs']} degrees of freedom, {document['seconds']['total']:.1f} s"
    )


def _static_error(document: Document) -> Iterator[str]:
    if error := document["static_error"]:
        yield static_error_sentence(error)


def static_error_sentence(error: Document) -> str:
    """Return the static compliance at the bearings in words."""
    return (
        f"Static compliance at the bearings: the modes alone lack up to {100 * error['without_attachments']:.3g} %; "
        f"with {counted(error['attachments'], 'residual attachment')} {error['with_attachments']:.0e} of it is left."
    )


def _effective_mass(document: Document) -> tuple[Table, ...]:
    """Return the effective masses of each mode, and the sums of these, of higher modes and of the supports."""
    mass = document["effective_mass"]
    columns = (
        Column("mode", "mode"),
        Column("frequency [Hz]", "frequency"),
        *(
            Column(_SHORT_DIRECTION_NAMES.get(name, name), f"parts.{place}", shown=partial(_percent, "parts", place))
            for place, name in enumerate(mass["directions"])
        ),
    )
    rows = [
        {"mode": mode["number"], "frequency": f"{mode['frequency_hz']:.2f}", "parts": mode["effective_mass"]}
        for mode in document["modes"]
    ]
    rows += [{"frequency": "these modes", "parts": mass["captured"]}]
    rows += [{"frequency": "higher modes", "parts": mass["missing"]}]
    if any(mass["held_by_supports"]):
        rows += [{"frequency": "fixed patches", "parts": mass["held_by_supports"]}]
    caption = "Effective modal mass, as a part of the whole; rotations about the centre of gravity"
    return table_of(columns, rows, caption)


def _supports(supports: list[Document], directions: list[str]) -> tuple[Table, ...]:
    columns = (
        Column("support", "name"),
        Column("fixes", "fixes", shown=lambda support: f"{support['fixes']} of 6" if support["fixes"] else ""),
        *(
            Column(_SHORT_DIRECTION_NAMES.get(name, name), f"share.{name}", shown=partial(_percent, "share", name))
            for name in directions
        ),
    )
    caption = "What the supports hold of the housing as a whole; shares of the springs' stiffness"
    return table_of(columns, supports, caption)


def _selection(selection: Document) -> str:
    retained = len(selection["keep"])
    modes = ", ".join(str(number) for number in selection["keep"]) or "none"
    low, high = selection["band_hz"]
    return (
        f"From {', '.join(selection['from'])} to {', '.join(selection['to'])}, {low:.4g} to {high:.4g} Hz: "
        f"{retained} of {len(selection['ranking'])} modes carry the receptance to "
        f"{100 * selection['error_left'][retained]:.2g} % of its largest: {modes}."
    )


def _percent(key: str, direction: str | int, row: Document) -> str:
    part = row[key][direction]
    return f"{100 * part:.1f} %" if abs(part) >= _SHOWN else ""
