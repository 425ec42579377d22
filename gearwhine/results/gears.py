"""Gear pairs: quantities of geometry, mesh stiffness, transmission error and load, and how they are shown."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gearwhine.coupling.analyses.gear_pairs import geometry_warnings
from gearwhine.coupling.gears import Gear, GearError, GearPairGeometry, TipRelief, path_of_contact
from gearwhine.coupling.gears.geometry.path_of_contact import POINTS_OF_CONTACT, PathOfContact
from gearwhine.coupling.gears.geometry.thickness import normal_tooth_thickness, over_balls, span_measurement
from gearwhine.output.files import file_stems
from gearwhine.output.quantity import ABSENT, Part, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import Column, Document, Picture, Section, Table, columns_of, percent, table_of
from gearwhine.results.operating_point import misalignment_words, share_words

if TYPE_CHECKING:
    import numpy.typing as npt

    from gearwhine.coupling.analyses.gear_pairs import PairAnalysis

_MOST_YIELDING = 0.1
"""Deflection of the teeth above which an overload is warned of, in modules: teeth break before."""


def _start(gear: Gear, relief: TipRelief) -> float:
    """Return the roll angle at which a tip relief begins [rad]."""
    return relief.start(gear.roll_angle(gear.tip_radius), gear.base_radius)


class _Gear(NamedTuple):
    """Geometry of a gear pair, and one of its gears."""

    geometry: GearPairGeometry
    gear: Gear


def _span(row: _Gear) -> dict[str, Any] | None:
    # Some measurements are impossible on some gears: the face is too narrow or the teeth are too short.
    with suppress(GearError):
        span = span_measurement(row.gear)
        return {"teeth": span.teeth, "length_m": span.length}
    return None


def _over_balls(row: _Gear) -> dict[str, Any] | None:
    with suppress(GearError):
        balls = over_balls(row.gear)
        return {"ball_diameter_m": balls.diameter, "length_m": balls.length}
    return None


def _relief(row: _Gear) -> dict[str, Any] | None:
    gear = row.gear
    relief = gear.tip_relief
    if relief is None:
        return None
    return {"amount_m": relief.amount, "start_roll_angle_rad": _start(gear, relief), "shape": relief.shape}


_MM, _MICRO, _MEGA = 1e3, 1e6, 1e-6

GEAR = (
    Quantity("name", "gear.name", heading="[mm]"),
    Quantity("teeth", "gear.teeth", heading="teeth", shown="d"),
    Quantity("virtual_teeth", "gear.virtual_teeth"),
    Quantity("module_m", "gear.module"),
    Quantity("pressure_angle_rad", "gear.pressure_angle"),
    Quantity("helix_angle_rad", "gear.helix_angle"),
    Quantity("lead_m", lambda row: None if row.gear.helix_angle == 0.0 else row.gear.lead),
    Quantity("profile_shift", "gear.profile_shift", heading="shift [modules]"),
    Quantity("rack_tip_radius_m", "gear.rack_tip_radius"),
    Quantity("undercut", "gear.is_undercut"),
    Quantity(
        "face_width_m",
        lambda row: row.gear.face_width if row.gear.has_face else None,
        heading="face",
        shown=".5g",
        scale=_MM,
    ),
    Quantity(
        "diameters_m",
        lambda row: {
            name: 2.0 * abs(radius)
            for name, radius in {
                "tip": row.gear.tip_radius,
                "reference": row.gear.pitch_radius,
                "base": row.gear.base_radius,
                "form": row.gear.form_radius,
                "root": row.gear.root_circle_radius,
                "rim_outside": row.gear.rim_outer_radius,
            }.items()
            if radius is not None
        },
    ),
    Quantity(
        "normal_thickness_m",
        lambda row: {
            "reference": normal_tooth_thickness(row.gear, row.gear.pitch_radius),
            "tip": normal_tooth_thickness(row.gear, row.gear.tip_radius),
        },
    ),
    Quantity(
        "tip_clearance_m", lambda row: row.geometry.tip_clearance(row.gear), heading="clearance", shown=".3f", scale=_MM
    ),
    Quantity(
        "span",
        _span,
        heading="span (teeth)",
        shown=lambda row: (
            "" if row["span"] is None else f"{_MM * row['span']['length_m']:.3f} ({row['span']['teeth']})"
        ),
    ),
    Quantity("over_balls", _over_balls),
    Quantity("tip_relief", _relief),
)
"""Proportions and measures of a gear."""

_CIRCLES = (
    *(Column(f"{head} ⌀", f"diameters_m.{key}", ".3f", _MM) for head, key in (("tip", "tip"), ("pitch", "reference"))),
    *(Column(f"{key} ⌀", f"diameters_m.{key}", ".3f", _MM) for key in ("base", "root")),
    Column("tip width", "normal_thickness_m.tip", ".3f", _MM),
)

_PATH_KEYS = {
    "position_base_pitches": "position",
    "driver_roll_angle_rad": "driver_roll_angle",
    "driven_roll_angle_rad": "driven_roll_angle",
    "driver_radius_m": "driver_radius",
    "driven_radius_m": "driven_radius",
    "driver_specific_sliding": "driver_sliding",
    "driven_specific_sliding": "driven_sliding",
}


def _of_point(path: PathOfContact, name: str) -> "npt.NDArray[np.float64]":
    """Return an attribute of the points by name; radii as lengths, which are signed of internal gears."""
    values: npt.NDArray[np.float64] = getattr(path, name)
    return np.abs(values) if name.endswith("_radius") else values


def _points(path: PathOfContact) -> list[dict[str, Any]]:
    return [
        {"point": point} | {key: _of_point(path, name)[row] for key, name in _PATH_KEYS.items()}
        for row, point in enumerate(POINTS_OF_CONTACT)
    ]


def _of_sides(name: str, unit: str, quantity: str) -> Quantity:
    """Declare a quantity of the named points on both gears."""
    return in_file(
        f"contact_point_{name}",
        "side contact_point",
        lambda path: np.array([_of_point(path, f"{side}_{name}") for side in ("driver", "driven")]),
        f"{quantity} of the point",
        unit,
    )


PATH = (
    in_file("contact_point", "contact_point", lambda path: list(POINTS_OF_CONTACT), "of the driver", common=True),
    in_file("side", "side", lambda path: ["driver", "driven"], common=True),
    in_file("contact_point_position", "contact_point", "position", "place on the path of contact in base pitches", "1"),
    _of_sides("roll_angle", "rad", "roll angle"),
    _of_sides("radius", "m", "distance from the gear's centre"),
    _of_sides("sliding", "1", "specific sliding"),
)
"""Quantities of the named points of a path of contact, on both gears."""


def _gears(geometry: GearPairGeometry) -> list[_Gear]:
    gears = (geometry.driver, geometry.driven)
    return [_Gear(geometry, gear) for gear in gears]


GEOMETRY = (
    Rows("gears", _gears, GEAR),
    Quantity("path_of_contact", lambda geometry: _points(path_of_contact(geometry))),
)
"""Shape of both gears of a pair, and the named points of their path of contact."""

_PHASE, _TOOTH = ("mesh_phase",), ("mesh_phase", "tooth_pair")
CURVES = (
    in_file("mesh_phase", _PHASE, "phases", unit="1", common=True),
    in_file("mesh_stiffness", _PHASE, "stiffness", unit="N/m"),
    in_file("loaded_flank_stiffness", _PHASE, "mesh.tangent_stiffness", unit="N/m"),
    in_file("transmission_error", _PHASE, "mesh.transmission_error", unit="m"),
    in_file("unloaded_transmission_error", _PHASE, "unloaded", unit="m"),
    in_file("tooth_pair_position", _TOOTH, "position", unit="1"),
    in_file("load_share", _TOOTH, "share", unit="1"),
    in_file("contact_pressure", _TOOTH, "pressure", unit="Pa"),
    in_file("face_place", "slice", "face_place", unit="m"),
    in_file("line_load", (*_TOOTH, "slice"), "mesh.line_loads", unit="N/m"),
)
"""Quantities of a pair at even phases of the mesh period."""

_SEATS = {"rigid": " in rigid seats", "housing": " on the modes of the housing"}

HUNTING = (
    in_file("hunting_phase", "hunting_step", "phases", "mesh periods", "1"),
    in_file(
        "hunting_transmission_error",
        "hunting_step",
        "transmission_error",
        "static transmission error under the mean torque",
        "m",
    ),
    Quantity("mean", "mean_transmission_error"),
    Quantity("peak_to_peak", "peak_to_peak_transmission_error"),
)
"""Transmission error over the whole hunting period."""

_LOADS = ("harris_load",)
HARRIS_MAP = (
    Quantity(
        "torque_n_m",
        lambda pair: pair.harris.forces * abs(pair.solved.geometry.driver.base_radius),
        "harris_torque",
        _LOADS,
        long_name="torque on the driver",
    ),
    in_file("harris_phase", "harris_step", "harris.phases", unit="1"),
    in_file(
        "harris_transmission_error",
        (*_LOADS, "harris_step"),
        "harris.transmission_error",
        "static transmission error under the torque",
        "m",
    ),
    Quantity("peak_to_peak_m", "harris.peak_to_peak"),
    Quantity("quietest_torque_n_m", lambda pair: pair.harris.quietest * abs(pair.solved.geometry.driver.base_radius)),
)
"""The transmission error over the mesh period for a range of torques."""

STIFFNESS = (
    Quantity("mean"),
    Quantity("min", "least"),
    Quantity("max", "greatest"),
    Quantity("loaded_mean"),
    Quantity("sound_mean", lambda figures: ABSENT if figures.sound_mean is None else figures.sound_mean),
    Quantity("over_hunting_period"),
)
"""Mesh stiffness of all teeth, over the hunting period where mesh periods differ."""
TRANSMISSION_ERROR = (
    Quantity("mean", "solved.static.mean_transmission_error"),
    Quantity("peak_to_peak", "solved.static.peak_to_peak_transmission_error"),
    Quantity("harmonics", "harmonics", "transmission_error_harmonic", ("harmonic",), "m"),
    Quantity("unloaded_peak_to_peak", lambda pair: float(np.ptp(pair.unloaded))),
    Part("over_hunting_period", "solved.hunting", HUNTING),
)
_PATH = ("path_step",)
LOAD_SHARING = (
    Quantity("pairs_in_contact"),
    Quantity("loaded_contact_ratio"),
    Quantity("largest_share", lambda pair: pair.shares[1].max()),
    Quantity("corner_force_n"),
    in_file("path_position", _PATH, "shares.0", "place on the path of contact in base pitches", "1"),
    in_file(
        "path_roll_angle",
        _PATH,
        lambda pair: pair.solved.geometry.driver_roll_angle(pair.shares[0]),
        "roll angle of the driver there",
        "rad",
    ),
    in_file("path_load_share", _PATH, "shares.1", "part of the load on a tooth pair there", "1"),
)
"""Number of tooth pairs in contact, and the load share of one of them along its path."""
PRESSURE = (
    Quantity("max", "largest_pressure.0"),
    Quantity("at_driver_roll_angle_rad", "largest_pressure.1"),
    Quantity("pitch_point", "pitch_pressure"),
)


BACKLASH = (
    Quantity("along_line_of_action", "backlash"),
    Quantity("circumferential", lambda pair: pair.backlash / math.cos(pair.geometry.working_pressure_angle)),
    Quantity("normal", lambda pair: pair.backlash * math.cos(pair.geometry.driver.base_helix_angle)),
)
"""Acting backlash (ISO 21771): gap of the back flanks along their line of action in the transverse plane; j_wt on
the working pitch circles; j_bn, the shortest distance of the flanks."""


def _aim(pair: "PairAnalysis") -> dict[str, Any] | None:
    """Return the aim of the relief search; None without one."""
    if (optimum := pair.optimum) is None:
        return None
    sensor = getattr(pair.aim, "sensor", None)
    weights: dict[int, float] | None = getattr(pair.aim, "weights", None)
    return {
        "kind": "sensor" if sensor is not None else "peak-to-peak" if weights is None else "harmonics",
        "given": pair.aim_given,
        "sensor": sensor,
        "weights": None if weights is None else {str(n): weight for n, weight in weights.items()},
        "unit": "m" if sensor is None else "m/s^2",
        "as_given": pair.aimed_as_given,
        "without_relief": float(optimum.value_unmodified[0]),
        "best": float(optimum.value[0]),
    }


def _best_start(side: str) -> Quantity:
    def of(pair: "PairAnalysis") -> float | None:
        relief = None if pair.optimum is None else pair.optimum.relief
        return None if relief is None else _start(getattr(pair.solved.geometry, side), relief)

    return Quantity(f"{side}_start_roll_angle_rad", of)


RELIEF = (
    Quantity("aim", _aim),
    Quantity("shape", "optimum.relief.shape"),
    Quantity("amount_m", lambda pair: 0.0 if pair.optimum.relief is None else pair.optimum.relief.amount),
    Quantity("length_m", "optimum.relief.length"),
    _best_start("driver"),
    _best_start("driven"),
    Quantity("torque_n_m", "solved.torque"),
    Quantity("peak_to_peak_m", "optimum.peak_to_peak.0"),
    Quantity("peak_to_peak_without_relief_m", "optimum.unmodified.0"),
    Quantity("peak_to_peak_as_given_m", "as_given"),
)
"""The relief that suits the torque, beside that of the case and none at all."""


def _where(present: Any, pair: Any) -> Any:
    return None if present is None else pair


class _Flanks(NamedTuple):
    """Roll angles of driver and driven gear [rad], and the material over the involute there [m], shape (2, n)."""

    roll_angle: "npt.NDArray[np.float64]"
    deviation: "npt.NDArray[np.float64]"


PAIR = (
    in_file("gear_pair", "", lambda pair: pair.label.replace("→", "->")),
    Quantity("driver", "solved.pair.driver", heading="driver"),
    Quantity("driven", "solved.pair.driven", heading="driven"),
    Quantity("model", "solved.model.name"),
    Quantity("contact_ratio", "solved.geometry.contact_ratio", heading="contact ratio", shown=".4f"),
    Quantity("overlap_ratio", "solved.geometry.overlap_ratio"),
    Quantity("total_contact_ratio", "solved.geometry.total_contact_ratio"),
    Quantity("centre_distance_m", lambda pair: abs(pair.solved.geometry.working_centre_distance)),
    Quantity("working_pressure_angle_rad", "solved.geometry.working_pressure_angle"),
    Part("backlash_m", lambda pair: _where(pair.solved.backlash, pair.solved), BACKLASH),
    Quantity("mesh_frequency_hz", lambda pair: pair.solved.mesh_frequency, heading="mesh frequency [Hz]", shown=".2f"),
    Quantity("torque_n_m", "solved.torque"),
    Quantity(
        "misalignment_rad",
        "misalignment.taken",
        "pair_misalignment",
        long_name="misalignment of the flanks that mesh stiffness and motion take",
    ),
    Quantity("misalignment_over_turn_rad", "misalignment.over_turn", optional=True),
    Quantity("misalignment_from", "misalignment.origin"),
    Quantity("mean_force_n", "solved.static.force"),
    Quantity("mean_force_from", "force_origin"),
    Rows("gears", lambda pair: _gears(pair.solved.geometry), GEAR),
    Quantity("path_of_contact", lambda pair: _points(path_of_contact(pair.solved.geometry))),
    Part("", lambda pair: path_of_contact(pair.solved.geometry), PATH),
    Part("", lambda pair: pair.curves(), CURVES),
    Part(
        "",
        lambda pair: _Flanks(*pair.flanks),
        (
            in_file("flank_roll_angle", "side flank_place", "roll_angle", "roll angle from form circle to tip", "rad"),
            in_file("flank_deviation", "side flank_place", "deviation", "material over the involute", "m"),
        ),
    ),
    Part("stiffness_n_per_m", "stiffness_figures", STIFFNESS),
    Part("transmission_error_m", ".", TRANSMISSION_ERROR),
    Part("load_sharing", lambda pair: _where(pair.shares, pair), LOAD_SHARING),
    Part("contact_pressure_pa", lambda pair: _where(pair.pressure, pair), PRESSURE),
    Part("harris_map", lambda pair: _where(pair.harris, pair), HARRIS_MAP),
    Part("optimal_tip_relief", lambda pair: _where(pair.optimum, pair), RELIEF),
    Quantity(
        "roll_angle_rad", lambda pair: 2.0 * np.pi * pair.solved.static.phases / pair.solved.geometry.driver.tooth_count
    ),
    Quantity("stiffness"),
)
"""Quantities of one gear pair under the case's torque; angles in rad, positions in base pitches."""

GEARS = (Rows("pairs", ".", PAIR, "gear_pair"),)
"""Quantities of all gear pairs of a case."""


def gears_document(pairs: "Sequence[PairAnalysis]") -> dict[str, Any]:
    """Return the gear pairs as the command's JSON, with warnings where there are any."""
    warnings = [entry for pair in pairs for entry in _warnings(pair)]
    return document_of(GEARS, pairs) | ({"warnings": warnings} if warnings else {})


def _warnings(pair: "PairAnalysis") -> Iterator[dict[str, str]]:
    """Warn of the teeth's shape, the backlash, a runout that the curves leave out, and an overload."""
    solved, geometry = pair.solved, pair.solved.geometry
    yield from geometry_warnings(solved.pair, geometry)
    for gear in (geometry.driver, geometry.driven):
        if gear.eccentricity > 0.0:
            message = (
                f"gear {gear.name!r}: its eccentricity adds {1e6 * gear.eccentricity:.4g} µm once per turn, either "
                "way, to the transmission error; the motion has it, the curves here are without it"
            )
            yield {"name": "runout", "message": message}
    yielding = solved.static.mean_transmission_error - float(pair.unloaded.mean())
    if yielding > _MOST_YIELDING * geometry.driver.module:
        message = (
            f"{geometry.label}: the teeth yield {1e6 * yielding:.4g} µm under {solved.torque:.4g} N·m, "
            f"{yielding / geometry.driver.module:.2g} modules; none bear so much, and the model is of small deflections"
        )
        yield {"name": "overload", "message": message}


_HARMONICS = 4  # harmonics of the transmission error that a line lists
_TRANSMISSION_ERROR_ALONE = "of transmission error alone: load shuttling excites too, which the aim at a sensor counts"
_WORTH_IT = 0.9  # a relief with less than this part of the given one's error is worth naming as better
OVERVIEW = (
    *columns_of(PAIR),
    Column("mean stiffness [N/µm]", "stiffness_n_per_m.mean", ".1f"),
    Column("mean transmission error [µm]", "transmission_error_m.mean", ".2f"),
    Column("peak to peak [µm]", "transmission_error_m.peak_to_peak", ".3f"),
)


def report(document: Document) -> Section:
    """Chapter of the report: all pairs beside each other, then each as the terminal shows it."""
    overview = table_of(OVERVIEW, document["pairs"])
    inner = sections(document) if all("path_of_contact" in pair for pair in document["pairs"]) else ()
    stems = file_stems([f"{pair['driver']}-{pair['driven']}" for pair in document["pairs"]], "gears-")
    inner = tuple(
        replace(section, pictures=tuple(Picture(f"{stem}-{kind}", caption) for kind, caption in _PICTURES.items()))
        for section, stem in zip(inner, stems, strict=False)
    )
    return Section("Gears", overview, pictures=(Picture("gears-", "Gear pair."),), inner=inner)


_PICTURES = {
    "teeth": "Teeth in mesh, to scale: circles, line of action and the points where contact begins and ends.",
    "stiffness": "Mesh stiffness over a mesh period: it drops where a pair of teeth leaves, which excites the machine.",
    "transmission-error": "Transmission error over a mesh period without load and under it, and its harmonics: the "
    "less it varies, the quieter the pair.",
    "path": "Share of the load, contact pressure and sliding along the path of contact.",
    "pattern": "Contact pattern over the face and the path of contact.",
    "flanks": "Flanks against the perfect involute, from the form circle to the tip, and errors of pitch by tooth.",
    "harris-map": "Harris map: transmission error over a mesh period by torque: least where the pair is quiet. Flanks "
    "are out of line as at the torque of operation; load --over-torque has the equilibrium of each torque.",
}
"""Captions of a pair's figures, by the last part of their names."""


def sections(document: Document) -> tuple[Section, ...]:
    """Each gear pair: geometry, path of contact, stiffness, transmission error, load, and the best relief."""
    return tuple(
        Section(
            f"{pair['driver']} → {pair['driven']}",
            (*_proportions(pair), *_path(pair), *_mesh(pair), *_load(pair), *_best_relief(pair)),
            note=f"  mesh stiffness by the model {pair['model']!r}",
        )
        for pair in document["pairs"]
    )


def _proportions(pair: Document) -> tuple[Table, ...]:
    """Return the proportions of both gears, and the span measured over some of their teeth."""
    first = pair["gears"][0]
    title = f"Gears: module {_MM * first['module_m']:.5g} mm, pressure angle {_degrees(first['pressure_angle_rad'])}"
    if helix := first["helix_angle_rad"]:
        title += f", helix angle {_degrees(abs(helix))}, the driver's {'right' if helix > 0.0 else 'left'}-hand"
    shifted = any(gear["profile_shift"] for gear in pair["gears"])
    columns = [column for column in columns_of(GEAR) if shifted or column.of != "profile_shift"]
    return table_of((*columns[:-2], *_CIRCLES, *columns[-2:]), pair["gears"], title)


def _path(pair: Document) -> tuple[Table, ...]:
    """Return the named points of the path of contact on both gears."""
    columns = [Column("", "point")]
    for side in ("driver", "driven"):
        columns += [
            Column(f"{side}: roll", f"{side}_roll_angle_rad", shown=partial(_roll, f"{side}_roll_angle_rad")),
            Column("⌀ [mm]", f"{side}_radius_m", ".3f", 2 * _MM),
            Column("sliding", f"{side}_specific_sliding", shown=partial(_sliding, f"{side}_specific_sliding")),
        ]
    title = "Path of contact, with roll angles and specific sliding"
    return table_of(tuple(columns), pair["path_of_contact"], title)


def _degrees(angle: float, form: str = ".5g") -> str:
    return f"{math.degrees(angle):{form}}°"


def _roll(key: str, point: Document) -> str:
    return _degrees(point[key], ".2f")


def _sliding(key: str, point: Document) -> str:
    """Return the specific sliding to two places; it is infinite where the flank does not roll."""
    value = point[key]
    return f"{value:z.2f}" if value is not None and math.isfinite(value) else "-∞"


def _mesh(pair: Document) -> list[str]:
    """Return lines on centre distance, contact ratio, mesh stiffness and transmission error."""
    ratio = f"Contact ratio {pair['contact_ratio']:.5f}"
    if pair["overlap_ratio"]:
        ratio += f", with the overlap of {pair['overlap_ratio']:.4f} in all {pair['total_contact_ratio']:.4f}"
    ratio += f"; shafts {_MM * pair['centre_distance_m']:.4f} mm apart"
    ratio += f", working pressure angle {_degrees(pair['working_pressure_angle_rad'], '.6g')}"
    lines = [ratio]
    if pair["backlash_m"] is not None:
        lines.append(f"Backlash {backlash_words(pair['backlash_m'])}")
    if pair["mesh_frequency_hz"] is not None:
        lines.append(f"Mesh frequency {pair['mesh_frequency_hz']:.2f} Hz")
        lines[-1] += f", torque on the driver {pair['torque_n_m']:.5g} N·m, mesh force {pair['mean_force_n']:.1f} N"
        lines[-1] += share_words(pair.get("mean_force_from"))
    origin = pair.get("misalignment_from", "default")
    if origin != "default" or pair["mean_force_n"]:
        misalignment = pair.get("misalignment_rad")
        words = misalignment_words(misalignment, origin, misalignment if origin == "operating point" else None)
        seats = _SEATS.get(pair.get("misalignment_seats", ""), "") if origin == "operating point" else ""
        if over_turn := pair.get("misalignment_over_turn_rad"):
            words += (
                f", in the mean over a turn of the carrier; from {_MICRO * over_turn[0]:z.2f} to "
                f"{_MICRO * over_turn[1]:z.2f} µrad over it"
            )
        if origin == "case":
            words += "; `gearwhine load` has the loaded teeth with the one that it finds, by the tilt of the shafts"
        lines.append(words[0].upper() + words[1:] + seats)
    stiffness, error = pair["stiffness_n_per_m"], pair["transmission_error_m"]
    over = ", over the hunting period" if stiffness.get("over_hunting_period") else ""
    lines.append(
        f"Mesh stiffness, with the gears' bodies{over}: without load, of all pairs on the path, "
        f"{_MEGA * stiffness['mean']:.2f} N/µm in the mean, {_MEGA * stiffness['min']:.2f} to "
        f"{_MEGA * stiffness['max']:.2f}"
    )
    if "sound_mean" in stiffness:
        lines[-1] += f", {_MEGA * stiffness['sound_mean']:.2f} in the mean of sound teeth"
    if pair["mean_force_n"]:
        lines[-1] += f"; under load, of the teeth that touch, {_MEGA * stiffness['loaded_mean']:.2f} in the mean"
    state = "Static transmission error" if pair["mean_force_n"] else "Transmission error without load"
    lines.append(f"{state} {_error(error)}")
    if error["over_hunting_period"]:
        lines[-1] += " in the first mesh period"
        lines.append(f"  over the hunting period: {_error(error['over_hunting_period'])}")
    if error["peak_to_peak"] > 0.0:
        named = ", ".join(f"{_MICRO * amplitude:.3f}" for amplitude in error["harmonics"][:_HARMONICS])
        lines.append(f"  at the mesh frequency and its multiples: {named} µm")
    return lines


def backlash_words(backlash: Document) -> str:
    """Return a backlash by its names (ISO 21771)."""
    around, normal, along = (
        f"{_MM * backlash[key]:.4g} mm" for key in ("circumferential", "normal", "along_line_of_action")
    )
    places = ("on the working pitch circle", "normal to the flanks", "along the line of action")
    return f"j_wt {around} {places[0]}, j_bn {normal} {places[1]}, {along} {places[2]}"


def _error(error: Document) -> str:
    return f"{_MICRO * error['mean']:.3f} µm in the mean, {_MICRO * error['peak_to_peak']:.3f} µm peak to peak"


def _load(pair: Document) -> list[str]:
    """Return lines on load sharing and contact pressure."""
    lines = []
    over = " in the first mesh period" if pair["transmission_error_m"]["over_hunting_period"] else ""
    if sharing := pair["load_sharing"]:
        parts = ", ".join(f"{count} for {percent(part)}" for count, part in sharing["pairs_in_contact"].items() if part)
        lines.append(
            f"Pairs of teeth that carry{over}: {parts} of the time, {sharing['loaded_contact_ratio']:.4f} in the mean; "
            f"one carries {percent(sharing['largest_share'])} at most"
        )
        if sharing["corner_force_n"]:
            lines.append(f"Corners carry up to {sharing['corner_force_n']:.4g} N beyond the path of contact")
    if pressure := pair["contact_pressure_pa"]:
        where = _degrees(pressure["at_driver_roll_angle_rad"], ".2f")
        lines.append(f"Contact pressure {_MEGA * pressure['max']:.0f} MPa at most{over}, at {where} roll of the driver")
        if pressure["pitch_point"] is not None:
            lines[-1] += f"; {_MEGA * pressure['pitch_point']:.0f} MPa at the pitch point"
    return lines


def _best_relief(pair: Document) -> list[str]:
    """Return lines on the given relief's effect, its best torque, and the best relief for the case's torque."""
    best = pair["optimal_tip_relief"]
    if best is None:
        return []
    without, as_given, least = (
        _MICRO * best[f"peak_to_peak_{which}"] for which in ("without_relief_m", "as_given_m", "m")
    )
    at = f"at {best['torque_n_m']:.4g} N·m"
    alike = ", all teeth alike" if pair["transmission_error_m"]["over_hunting_period"] else ""
    if any(gear["tip_relief"] for gear in pair["gears"]):
        lines = [
            f"The relief of {_reliefs(pair)} leaves {as_given:.2f} µm peak to peak {at}{alike}, none {without:.2f} µm",
        ]
        # Every pair is quiet at the lowest torque.
        harris = pair["harris_map"]
        if harris is not None and (quietest := harris["quietest_torque_n_m"]) > harris["torque_n_m"][0]:
            lines.append(f"  it is quietest near {quietest:.3g} N·m")
    else:
        lines = [f"Without relief {as_given:.2f} µm peak to peak {at}{alike}"]
    aim = best["aim"]
    if best["length_m"] is None:
        return [*lines, f"No tip relief, the same on both gears, lowers the {_aim_in_words(aim)}: leave it out"]
    starts = [math.degrees(best[f"{side}_start_roll_angle_rad"]) for side in ("driver", "driven")]
    text = (
        f"{_MM * best['amount_m']:.4f} mm on both gears from {_alike(starts, '.2f', '°')} of roll, over "
        f"{_MM * best['length_m']:.2f} mm of the line of action: {least:.2f} µm"
    )
    if aim["kind"] != "peak-to-peak":
        as_given, without_relief, with_best = (_value(aim, key) for key in ("as_given", "without_relief", "best"))
        lines.append(
            f"Aim, the {_aim_in_words(aim)}: {as_given} as given, {without_relief} without relief, {with_best} with "
            "the best"
        )
        if aim["kind"] == "harmonics":
            lines.append(f"  {_TRANSMISSION_ERROR_ALONE}")
        return [*lines, f"Best {best['shape']} relief: {text} peak to peak"]
    close = least > _WORTH_IT * as_given
    return [*lines, f"Hardly better would be {text}" if close else f"Best {best['shape']} relief: {text}"]


def _aim_in_words(aim: Document) -> str:
    """Return the aim of the relief search in words."""
    if aim["kind"] == "peak-to-peak":
        return "peak-to-peak transmission error"
    if aim["kind"] == "sensor":
        loudest = "" if aim["given"] else ", the loudest sensor,"
        return (
            f"level at {aim['sensor']}{loudest} by transmission error and load shuttling, rms over the mesh harmonics"
        )
    weights = ", ".join(f"{weight:.4g} at {n}" for n, weight in aim["weights"].items())
    return f"weighted harmonics of the mesh frequency ({weights})"


def _value(aim: Document, key: str) -> str:
    return f"{aim[key]:.4g} m/s²" if aim["kind"] == "sensor" else f"{_MICRO * aim[key]:.3f} µm"


def _reliefs(pair: Document) -> str:
    """Return the reliefs of both gears in short, such as ``0.023/0.025 mm from 24°``."""
    reliefs = [gear["tip_relief"] for gear in pair["gears"]]
    amounts = [_MM * relief["amount_m"] if relief else 0.0 for relief in reliefs]
    starts = [math.degrees(relief["start_roll_angle_rad"]) for relief in reliefs if relief]
    return f"{_alike(amounts, '.4g', ' mm')} from {_alike(starts, '.4g', '°')}"


def _alike(values: Sequence[float], form: str, unit: str) -> str:
    """Return both values with a stroke between them, or one value where their texts are equal."""
    texts = list(dict.fromkeys(f"{value:{form}}" for value in values))
    return "/".join(texts) + unit
