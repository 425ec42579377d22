"""Measured and model modes: quantities of their pairs, MAC and responses; their display, and CSV tables of them."""

import csv
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gearwhine.output.csv_cells import plain_cells
from gearwhine.output.quantity import ABSENT, HERTZ, Part, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import Column, Document, Picture, Section, columns_of, counted, table_of
from gearwhine.results.housing import shape_places

if TYPE_CHECKING:
    import numpy.typing as npt

    from gearwhine.housing import HousingModes
    from gearwhine.housing.correlation.comparison import Comparison, ShapeCorrelation
    from gearwhine.housing.measured import MappedSurvey, MeasuredGeometry
    from gearwhine.housing.modal_test import ResponseCorrelation
    from gearwhine.housing.reduced import ReducedHousing

PAIR = (
    Quantity(
        "measured_hz",
        "measured",
        "measured_frequency",
        long_name="measured frequency",
        heading="measured [Hz]",
        shown=".1f",
    ),
    Quantity(
        "model_hz", "model", "model_frequency", long_name="frequency of the model", heading="model [Hz]", shown=".1f"
    ),
    Quantity(
        "error_percent",
        "error_percent",
        "frequency_error",
        long_name="error of the model's frequency",
        heading="error [%]",
        shown="+.2f",
    ),
    Quantity("measured_mode", "measured_mode", "measured_mode", unit="1", long_name="number of the measured mode"),
    Quantity("mode", "mode", "model_mode", unit="1", long_name="number of the housing mode", heading="mode", shown="d"),
    Quantity("mac", heading="MAC", shown=".3f"),
    Quantity("confidence", heading="confidence", shown=".2f"),
    Quantity("strength", heading="strength [1/kg]", shown=".4g"),
    Quantity("close_modes"),
    Quantity("mixed"),
)
"""Quantities of a measured mode and its partner in the model."""

ALIKE = (Quantity("modes", lambda pair: [pair.first, pair.second]), Quantity("mac"))
"""Quantities of two modes of one set that look alike at the points of the survey."""


def _alike(key: str, of: Any, *, one_frequency: bool | None = None) -> Rows:
    """Declare modes that look alike; ``one_frequency`` selects those that may be one mode found twice, or others."""
    return Rows(key, lambda shapes: [pair for pair in of(shapes) if one_frequency in (None, pair.one_frequency)], ALIKE)


def _numbers(frequencies: "npt.NDArray[np.float64]") -> Any:
    return np.arange(1, 1 + len(frequencies))


class _Mode(NamedTuple):
    """Correlation of mode shapes, and the number of a measured mode or of one of the model, from 1."""

    shapes: "ShapeCorrelation"
    number: int


SHAPES = (
    in_file(
        "measured", "measured", lambda shapes: _numbers(shapes.measured_frequencies), "number of the measured mode", "1"
    ),
    in_file(
        "housing_mode",
        "housing_mode",
        lambda shapes: _numbers(shapes.model_frequencies),
        "number of the housing mode",
        "1",
    ),
    Rows(
        "unpaired_measured",
        lambda shapes: [_Mode(shapes, number) for number in shapes.unpaired_measured],
        (
            Quantity("measured_mode", "number"),
            Quantity("measured_hz", lambda row: row.shapes.measured_frequencies[row.number - 1] / HERTZ),
            Quantity("most_like", lambda row: np.argmax(row.shapes.mac[:, row.number - 1]) + 1),
            Quantity("mac", lambda row: row.shapes.mac[:, row.number - 1].max()),
        ),
    ),
    Rows(
        "unpaired_model",
        lambda shapes: [_Mode(shapes, number) for number in shapes.unpaired_model],
        (
            Quantity("mode", "number"),
            Quantity("model_hz", lambda row: row.shapes.model_frequencies[row.number - 1] / HERTZ),
        ),
    ),
    _alike("duplicates", lambda shapes: shapes.measured_look_alikes, one_frequency=True),
    Part(
        "look_alikes",
        ".",
        (
            _alike("measured", lambda shapes: shapes.measured_look_alikes, one_frequency=False),
            _alike("model", lambda shapes: shapes.model_look_alikes),
        ),
    ),
    Rows(
        "close_modes",
        "close",
        (
            Quantity("modes", "model"),
            Quantity("measured_modes", "measured"),
            Quantity("largest_angle_deg"),
        ),
    ),
    Part(
        "auto_mac_off_diagonal",
        ".",
        (
            Quantity("model", "largest_model_likeness"),
            Quantity("measured", "largest_measured_likeness"),
        ),
    ),
    Part(
        "cross_orthogonality",
        ".",
        (
            Quantity("modes", "orthogonality_modes"),
            Quantity("values", "cross_orthogonality"),
            Quantity("outside"),
            Quantity("missing_because", lambda shapes: shapes.no_orthogonality or None),
        ),
    ),
    Quantity("phase_collinearity", "collinearity"),
    Quantity("mac", "mac", "mac", ("housing_mode", "measured"), "1", long_name="modal assurance criterion"),
    in_file("comac", "degree_of_freedom", "comac", "coordinate modal assurance criterion", "1"),
)
"""Quantities of measured shapes beside the model's: missing, double, close and similar modes; quality of the survey."""


def _or_absent(value: Any) -> Any:
    return ABSENT if value is None else value


COMPARISON = (
    Rows("pairs", "pairs", PAIR, "pair"),
    Quantity("rms_error_percent", "rms_error_percent"),
    Quantity("max_error_percent", "max_error_percent"),
    Quantity("pairing"),
    Quantity("pairing_rule", "rule"),
    Quantity("band_hz", lambda comparison: [edge / HERTZ for edge in comparison.band]),
    Quantity("gap", lambda comparison: _or_absent(comparison.gap)),
    Quantity("measures_agree", lambda comparison: _or_absent(comparison.measures_agree)),
    Quantity("chance_error_percent", lambda comparison: _or_absent(comparison.chance_error_percent)),
    Rows(
        "unpaired_measured",
        lambda comparison: _or_absent(comparison.unpaired_measured),
        (
            Quantity("measured_mode", "number"),
            Quantity("measured_hz", "frequency"),
        ),
    ),
    Rows(
        "unpaired_model",
        lambda comparison: _or_absent(comparison.unpaired_model),
        (Quantity("mode", "number"), Quantity("model_hz", "frequency")),
    ),
    Part("", "shapes", SHAPES),
)
"""Quantities of the pairs of measured and model modes."""

SURVEY = (
    Quantity("points", lambda survey: len(survey.distances)),
    Quantity("degrees_of_freedom", "matrix.shape.0"),
    Quantity("rms_distance_m"),
    Quantity("worst_distance_m", lambda survey: survey.distances.max()),
    Quantity("worst_point", lambda survey: survey.geometry.labels[int(np.argmax(survey.distances))]),
    Quantity("tolerance_m"),
    Quantity("far_points", "far"),
    Part(
        "alignment",
        "alignment",
        (
            Quantity("by"),
            Quantity("rotation", "motion.rotation"),
            Quantity("translation_m", "motion.translation"),
            Quantity("turned_degrees", "motion.angle_degrees"),
            Quantity("rms_m"),
            Quantity("largest_m"),
            Quantity("other_positions", lambda alignment: len(alignment.others)),
            Quantity("remarks"),
        ),
        optional=True,
    ),
)
"""Quantities of a survey on the model."""

RESPONSES = (
    Quantity("criterion", lambda likeness: "FRAC"),
    Quantity("lines", "n_lines"),
    Quantity("from_hz", "band.0"),
    Quantity("to_hz", "band.1"),
    Quantity("measured", "n_measured"),
    Quantity("mean"),
    Quantity("frac", document=lambda frac: [[None if np.isnan(value) else value for value in row] for row in frac]),
)
"""Quantities of measured responses beside the model's."""


_BY_MESH = "discretisation_error"
_MESH_ERROR = Column("mesh error [%]", _BY_MESH, ".2g", 100.0)


def comparison_document(comparison: "Comparison", solved: "HousingModes | ReducedHousing") -> dict[str, Any]:
    """Return the comparison as the command's JSON."""
    shapes = comparison.shapes
    last = comparison.pairs[-1].measured if shapes is None else float(shapes.measured_frequencies[-1])
    last = max([last, *(mode.frequency for mode in comparison.unpaired_measured or ())])
    # Counted below the next full kilohertz over the measured modes, as far as the model's modes are known.
    highest = min(float(np.ceil(last / HERTZ / 1000.0) * 1000.0), solved.trusted_limit_hz)
    count = int(np.count_nonzero(solved.modes.frequencies_hz < highest))
    document = document_of(COMPARISON, comparison)
    errors = solved.modes.discretisation_errors
    if errors is not None:
        # Beside each difference: how much of it the mesh may make.
        document["pairs"] = [pair | {_BY_MESH: float(errors[pair["mode"] - 1])} for pair in document["pairs"]]
    return document | {"model_modes": {"below_hz": highest, "count": count}}


def survey_document(survey: "MappedSurvey") -> dict[str, Any]:
    """Return the fit of a survey to the model, as the command's JSON."""
    return document_of(SURVEY, survey)


def responses_document(likeness: "ResponseCorrelation | str") -> dict[str, Any]:
    """Return the correlation of the responses as the command's JSON, or the reason why there is none."""
    return {"missing_because": likeness} if isinstance(likeness, str) else document_of(RESPONSES, likeness)


_POOR = 0.3  # MAC between different modes above which the survey confuses them
_REAL = 0.9  # modal phase collinearity below which a shape is called complex


def report(document: Document) -> Section:
    """Chapter of the report: the pairs, and how clear the pairing is."""
    sentences = [f"Paired by {document['pairing_rule']}."]
    if document.get("rms_error_percent") is not None:
        sentences.append(
            f"Errors: {document['rms_error_percent']:.2f} % root mean square, "
            f"{document['max_error_percent']:.2f} % at most."
        )
    if document.get("gap") is not None:
        agree = "agree" if document.get("measures_agree") else "do not agree"
        sentences.append(f"Gap of dominance {document['gap']:.3f}; the three measures {agree}.")
    if "auto_mac_off_diagonal" not in document:
        sentences += _by_frequency(document)
    tables = table_of(LINKED_PAIR, document.get("pairs", ()))
    return Section("Measured and modelled", (*sentences, *tables), pictures=_PICTURES)


LINKED_PAIR = tuple(
    replace(column, link=lambda pair: shape_places(pair["mode"])) if column.of == "mode" else column
    for column in (*columns_of(PAIR), _MESH_ERROR)
)
"""Columns of a measured mode and its partner, with a link to the partner's shape."""
_PICTURES = (
    Picture(
        "comparison",
        "Frequencies of the model over measured ones, the grey band within 5 %, and their errors; ticks: modes of the "
        "model without a partner.",
    ),
    Picture("mac", "MAC of model and measured shapes: dark where they are alike, pairs outlined in red."),
    Picture("auto-mac", "MAC of measured shapes with each other: dark off the diagonal where modes look alike."),
    Picture("cross-orthogonality", "Cross-orthogonality in the model's mass: close to 1 for pairs, to 0 elsewhere."),
    Picture("comac", "COMAC by measured direction: low where the model's shapes and the measured ones differ."),
    Picture("measured-and-model", "Measured shapes, left, and their partners in the model, right."),
)


_PAIRS = (
    Column("mode", "mode", "d"),
    Column("measured [Hz]", "measured_hz", ".0f"),
    Column("model [Hz]", "model_hz", ".1f"),
    Column("error", "error_percent", shown=lambda pair: f"{pair['error_percent']:+.2f} %"),
    _MESH_ERROR,
    Column("MAC", "mac", ".3f"),
    Column("confidence", "confidence", ".2f"),
    Column("strength [1/kg]", "strength", ".2e"),
)


def sections(document: Document) -> tuple[Section, ...]:
    """Return the pairs, how clear the pairing is, and how the measured survey lies on the model."""
    evidence = _by_shapes(document) if "auto_mac_off_diagonal" in document else _by_frequencies_alone(document)
    survey = _survey(document["survey"]) if "survey" in document else ()
    return (Section("", (*table_of(_PAIRS, document["pairs"]), *evidence, *survey)),)


def _by_frequencies_alone(document: Document) -> Iterator[str]:
    count = document["model_modes"]
    yield (
        f"Paired by {document['pairing_rule']}: largest error {document['max_error_percent']:.2f} %, "
        f"rms {document['rms_error_percent']:.2f} %; "
        f"{counted(count['count'], 'model mode')} below {count['below_hz']:.0f} Hz."
    )
    if "gap" in document:
        yield _gap(document)
        yield "Such a match is weak evidence where the model was calibrated to these frequencies: see the case's notes."
    yield from _by_frequency(document)


def _gap(document: Document) -> str:
    gap, agree = document["gap"], "agree" if document["measures_agree"] else "do not all agree"
    distance = "no other mode in the band"
    if gap is not None and math.isfinite(gap):
        distance = f"ln {gap:.3f} (below 0.1 the choice is a coin toss)"
    return f"Gap between the last chosen mode and the next: {distance}; the three measures of dominance {agree}."


def _by_frequency(document: Document) -> Iterator[str]:
    """Yield lines on modes without a partner, and on how weak the evidence of frequencies alone is."""
    if document.get("unpaired_measured"):
        names = ", ".join(
            f"{mode['measured_mode']} ({mode['measured_hz']:.0f} Hz)" for mode in document["unpaired_measured"]
        )
        yield f"Measured modes for which the model has none: {names}."
    if document.get("unpaired_model"):
        names = ", ".join(f"{mode['mode']} ({mode['model_hz']:.0f} Hz)" for mode in document["unpaired_model"])
        yield f"Model modes between the measured ones that are left out of the pairs: {names}."
    if document.get("chance_error_percent") is not None:
        yield (
            f"Weak evidence: a frequency at random in the band is {document['chance_error_percent']:.2g} % (rms) from "
            "the nearest mode of the model."
        )
    elif document["pairing"] == "order":
        yield "Weak evidence where either side lacks a mode: all pairs above it are then shifted by one."


def _by_shapes(document: Document) -> Iterator[str]:
    """Yield lines on missing, double, close and similar modes, and on the quality of the survey."""
    count = document["model_modes"]
    model_modes = counted(count["count"], "model mode")
    if document["pairs"]:
        yield (
            f"Paired by {document['pairing_rule']}: largest error {document['max_error_percent']:.2f} %, "
            f"rms {document['rms_error_percent']:.2f} %; {model_modes} below {count['below_hz']:.0f} Hz."
        )
        if "gap" in document:
            yield _gap(document)
        if any(pair.get("confidence") is not None for pair in document["pairs"]):
            yield "Confidence: what the best assignment loses without the pair, as a part of its score; no probability."
    else:
        yield f"Paired by {document['pairing_rule']}: no measured mode is like one of {model_modes}."
    for mode in document["unpaired_measured"]:
        yield (
            f"Measured mode {mode['measured_mode']} ({mode['measured_hz']:.0f} Hz) has no partner: most like mode "
            f"{mode['most_like']}, MAC {mode['mac']:.2f}."
        )
    if document["unpaired_model"]:
        names = ", ".join(f"{mode['mode']} ({mode['model_hz']:.0f} Hz)" for mode in document["unpaired_model"])
        yield f"Model modes in the measured band that no measured mode is: {names}."
    for pair in document["duplicates"]:
        yield f"Measured modes {_both(pair)} may be one mode found twice (MAC {pair['mac']:.2f})."
    for whose, pairs in document["look_alikes"].items():
        for pair in pairs:
            yield (
                f"The survey cannot tell {whose} modes {_both(pair)} apart (MAC {pair['mac']:.2f}): "
                "it needs more points."
            )
    for group in document["close_modes"]:
        angle = group["largest_angle_deg"]
        apart = "" if angle is None or math.isnan(angle) else f", largest angle {angle:.1f}°"
        yield (
            f"Modes {_listed(group['modes'])} are close and compared as one space: measured "
            f"{_listed(group['measured_modes'])}{apart}."
        )
    yield from _survey_quality(document)
    if "responses" in document:
        yield from _responses(document["responses"])
    if document["cross_orthogonality"]["missing_because"]:
        yield f"No cross-orthogonality: {document['cross_orthogonality']['missing_because']}."


def _survey_quality(document: Document) -> Iterator[str]:
    largest_mac = document["auto_mac_off_diagonal"]
    remark = "; a survey with more points would tell modes apart better" if largest_mac["model"] > _POOR else ""
    yield (
        f"Largest MAC between different modes: {largest_mac['measured']:.2f} of the test, "
        f"{largest_mac['model']:.2f} of the model{remark}."
    )
    bent = [number for number, value in enumerate(document["phase_collinearity"], start=1) if value < _REAL]
    if bent:
        yield f"Complex shapes (phase collinearity below {_REAL:g}): measured {_listed(bent)}."


def _responses(responses: Document) -> Iterator[str]:
    if "missing_because" in responses:
        yield f"No likeness of responses: {responses['missing_because']}."
    elif responses["mean"] is not None:
        values = [value for row in responses["frac"] for value in row if value is not None]
        yield (
            f"Likeness of {counted(len(values), 'response')} over {responses['lines']} lines from "
            f"{responses['from_hz']:.0f} to {responses['to_hz']:.0f} Hz (FRAC): mean {responses['mean']:.2f}, from "
            f"{min(values):.2f} to {max(values):.2f}; a resonance a few per cent off costs most of it."
        )


def _millimetres(length: float) -> str:
    """Return a length to three digits, none below a micrometre."""
    return f"{round(1e3 * length, 3):.3g} mm"


def _survey(survey: Document) -> Iterator[str]:
    """Yield lines on the alignment of the measured survey with the model."""
    yield (
        f"Survey: {counted(survey['points'], 'point')}, {counted(survey['degrees_of_freedom'], 'measured direction')}; "
        f"{_millimetres(survey['rms_distance_m'])} from the surface in the mean, "
        f"{_millimetres(survey['worst_distance_m'])} at worst (point {survey['worst_point']})."
    )
    if far := survey["far_points"]:
        names = ", ".join(far[:10]) + (", …" if len(far) > 10 else "")
        yield f"Farther than {1e3 * survey['tolerance_m']:.3g} mm: {names}."
    if "alignment" in survey:
        alignment = survey["alignment"]
        yield (
            f"Aligned by {alignment['by']}, turned by {alignment['turned_degrees']:.1f}°; "
            f"{1e3 * alignment['rms_m']:.3g} mm left in the mean, {1e3 * alignment['largest_m']:.3g} mm at most."
        )
        for remark in alignment["remarks"]:
            yield f"Note: {remark}."


def _both(pair: Document) -> str:
    return " and ".join(str(number) for number in pair["modes"])


def _listed(numbers: list[int]) -> str:
    return ", ".join(str(number) for number in numbers)


_PAIR_COLUMNS = ("measured_mode", "measured_hz", "model_hz", "error_percent", "mode", "mac", "confidence", "strength")
_ALONG = 1e-4  # deviation from an axis up to which a direction is named after it


def write_comparison(folder: Path, comparison: "Comparison", geometry: "MeasuredGeometry | None" = None) -> list[str]:
    """Write ``comparison.csv``; with shapes also the MAC matrix, and COMAC at each point.

    Parameters
    ----------
    folder : path
    comparison : Comparison
    geometry : housing.measured.MeasuredGeometry, optional
        Geometry of the survey, which names the degrees of freedom; without it they are numbered.

    Returns
    -------
    list of str
        The files' names: ``mac.csv`` with shapes, ``comac.csv`` where there are pairs.
    """
    _write_table(folder / "comparison.csv", _PAIR_COLUMNS, _pair_rows(comparison))
    files, shapes = ["comparison.csv"], comparison.shapes
    if shapes is not None:
        files.append(_write_mac(folder, shapes))
        if shapes.comac is not None and shapes.enhanced_comac is not None:
            names = coordinate_names(len(shapes.comac), geometry)
            cells = [map(_cell, row) for row in zip(shapes.comac, shapes.enhanced_comac, strict=True)]
            rows = [[name, *row] for name, row in zip(names, cells, strict=True)]
            _write_table(folder / "comac.csv", ["degree_of_freedom", "comac", "enhanced_comac"], rows)
            files.append("comac.csv")
    return files


def write_response_correlation(folder: Path, likeness: "ResponseCorrelation") -> str:
    """Write ``frac.csv``, a row for each degree of freedom and a column for each force; the file's name."""
    heads = ["response", *dof_names(likeness.references)]
    rows = [
        [name, *("" if np.isnan(value) else _cell(value) for value in values)]
        for name, values in zip(dof_names(likeness.geometry), likeness.frac, strict=True)
    ]
    _write_table(folder / "frac.csv", heads, rows)
    return "frac.csv"


def dof_names(geometry: "MeasuredGeometry") -> list[str]:
    """Each measured degree of freedom by its point and direction, such as ``12 +z`` or ``12 (0.71 0.00 0.71)``."""
    names = []
    for point, direction in zip(geometry.points, geometry.directions, strict=True):
        axis = int(np.argmax(np.abs(direction)))
        sign = "-" if direction[axis] < 0.0 else "+"
        along = f"{sign}{'xyz'[axis]}"
        if np.abs(np.delete(direction, axis)).max() > _ALONG:
            along = "({:.2f} {:.2f} {:.2f})".format(*direction)
        names.append(f"{geometry.labels[point]} {along}")
    return names


def _pair_rows(comparison: "Comparison") -> list[list[object]]:
    """Return the rows of the source's Table II with the evidence for each pair; unpaired modes have rows too."""
    of = {quantity.key: quantity.value_of for quantity in PAIR}
    rows: list[list[object]] = [[_cell(of[key](pair)) for key in _PAIR_COLUMNS] for pair in comparison.pairs]
    for mode in comparison.unpaired_measured or ():
        rows.append([mode.number, _cell(mode.frequency / HERTZ), *[""] * 6])
    if (shapes := comparison.shapes) is not None:
        hertz = shapes.measured_frequencies / HERTZ
        rows += [[number, _cell(hertz[number - 1]), *[""] * 6] for number in shapes.unpaired_measured]
    return sorted(rows, key=lambda row: int(str(row[0])))


def _write_mac(folder: Path, shapes: "ShapeCorrelation") -> str:
    heads = ["mode", "model_hz", *(f"measured_{number + 1}" for number in range(len(shapes.measured_frequencies)))]
    model = shapes.model_frequencies / HERTZ
    table = [[mode + 1, _cell(model[mode]), *map(_cell, shapes.mac[mode])] for mode in range(len(model))]
    _write_table(folder / "mac.csv", heads, table)
    return "mac.csv"


def coordinate_names(count: int, geometry: "MeasuredGeometry | None") -> list[str]:
    """Names of the measured degrees of freedom; their numbers where no geometry names them."""
    return [str(dof + 1) for dof in range(count)] if geometry is None else dof_names(geometry)


def _cell(value: float | None) -> str | int:
    """Return a value with six digits, more than any measurement has; an integer as it is; no value as an empty cell."""
    if isinstance(value, int):
        return value
    return "" if value is None or not np.isfinite(value) else f"{value:.6g}"


def _write_table(path: Path, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(plain_cells(heads))
        writer.writerows(plain_cells(row) for row in rows)
