"""Operating point: quantities of bearings, gear pairs and shafts under the mean load, and how they are shown."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gearwhine.coupling.analyses.gear_pairs import TakenMisalignment
from gearwhine.coupling.description.gear_train import EQUAL_MESHES
from gearwhine.coupling.statics.operating_point import CAUSES, PairLoad
from gearwhine.housing.acoustics.sound_levels import power_level
from gearwhine.output.attributes import meaning_of, value_at
from gearwhine.output.quantity import ABSENT, Fields, Part, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import (
    Column,
    Document,
    Picture,
    Row,
    Section,
    Table,
    columns_of,
    counted,
    table_of,
)
from gearwhine.output.store import Option, kept_sentence
from gearwhine.results.bearing_lives import life_quantities
from gearwhine.results.planetary import MEMBER

if TYPE_CHECKING:
    from gearwhine.coupling.description.parts import SupportBolt
    from gearwhine.coupling.linear.line_sensitivity import Line
    from gearwhine.coupling.load_analysis.influences import Influence, LoadSensitivity
    from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
    from gearwhine.coupling.sound.mesh_harmonics import HarmonicSound
    from gearwhine.coupling.statics.operating_point import OperatingPoint

_AXES, _TILTS = ("x", "y", "z"), ("about x", "about y")
_MICRO, _MEGA = 1e6, 1e-6
_DIRECTION, _ROTATION, _MOTION = ("direction",), ("rotation",), ("bearing_motion", "other_bearing_motion")
_MOTIONS = (*_AXES, *_TILTS)


def _along(key: str, of: str, name: str, long_name: str, *, optional: bool = False) -> Quantity:
    """Declare the components along x, y, z of a load or motion."""
    return _components(key, of, name, long_name, _DIRECTION, dict(zip(_AXES, range(3), strict=True)), optional)


def _about(key: str, of: str, name: str, long_name: str) -> Quantity:
    """Declare the components about x and y of a load or motion."""
    return _components(key, of, name, long_name, _ROTATION, dict(zip(_TILTS, (3, 4), strict=True)), False)


def _components(
    key: str, of: str, name: str, long_name: str, along: tuple[str, ...], places: dict[str, int], optional: bool
) -> Quantity:
    def labelled(row: Any) -> Any:
        values = value_at(row, of)
        return None if values is None else {label: float(values[place]) for label, place in places.items()}

    def listed(values: dict[str, float]) -> list[float]:
        return list(values.values())

    return Quantity(key, labelled, name, along, long_name=long_name, document=listed, optional=optional)


BEARING = (
    Quantity("name", "load.name", "loaded_bearing", heading="bearing"),
    Quantity("shaft", "load.mounted.rotor"),
    Quantity("seat", lambda bearing: bearing.load.mounted.seat or "ground"),
    _along("force_n", "load.force", "bearing_mean_force", "force of the shaft on the bearing"),
    _along(
        "given_load_n",
        "given_load",
        "bearing_given_load",
        "force on the bearing for which the case has its stiffness made",
        optional=True,
    ),
    _about("moment_n_m", "load.force", "bearing_mean_moment", "moment of the shaft on the bearing"),
    _along("displacement_m", "load.deflection", "bearing_displacement", "displacement of the shaft in its seat"),
    _about("rotation_rad", "load.deflection", "bearing_rotation", "rotation of the shaft in its seat"),
    _along("seat_displacement_m", "load.seat_motion", "seat_displacement", "displacement of the seat"),
    _about("seat_rotation_rad", "load.seat_motion", "seat_rotation", "rotation of the seat"),
    Quantity("tilt_rad", "load.tilt", "bearing_tilt", heading="tilt\n[µrad]", shown=".0f"),
    # Over x, y, z and the rotations about x and y.
    Quantity("stiffness", "load.stiffness", "bearing_tangent_stiffness", _MOTION),
    Quantity("peak_pressure_pa", "peak_pressure", "bearing_peak_pressure", heading="pressure\n[GPa]", shown=".3g"),
    Quantity("preload_n", "preload", "bearing_preload", heading="preload [N]", shown=".0f"),
    Quantity("most_loaded_element", "most_loaded"),
    in_file("bearing_element_load", "rolling_element", "element_loads", unit="N"),
    Quantity("equivalent_load_n", "rated.equivalent_load"),
    *life_quantities("bearing", ("L10\n[h]", "L10r\n[h]")),
)
"""Quantities of a bearing at the operating point; a row is a :class:`LoadedBearing`."""


def _stiffness(row: Row) -> str:
    """Tangent stiffness along x, y and z of a rolling bearing [N/µm]."""
    diagonal = [_MEGA * row["stiffness"][axis][axis] for axis in range(3)]
    return "" if row["peak_pressure_pa"] is None else ", ".join(f"{value:.4g}" for value in diagonal)


_DIAGONAL = tuple(f"stiffness.{axis}.{axis}" for axis in range(3))
_NAME, _TILT, *_OF_ELEMENTS = columns_of(BEARING)
_BEARING_COLUMNS = (
    _NAME,
    *(Column(f"{_AXES[axis]} [N]", f"force_n.{axis}", "z.0f") for axis in range(3)),
    *(Column(f"{_TILTS[axis]} [N·m]", f"moment_n_m.{axis}", "z.1f") for axis in range(2)),
    _TILT,
)
_ROLLING_COLUMNS = (_NAME, *_OF_ELEMENTS, Column("x, y, z [N/µm]", _stiffness, numbers=_DIAGONAL))

_SLICE, _PHASE = ("face_slice",), ("load_phase",)


_MISALIGNMENT = Quantity("misalignment_rad", "misalignment", "misalignment", heading="misaligned\n[µrad]", shown="z.2f")
_K_H_BETA = Quantity("k_h_beta", "loaded.k_h_beta", "face_load_factor", unit="1", heading="K_Hβ", shown=".3f")
_MEAN_STIFFNESS = Quantity(
    "mean_stiffness_n_per_m",
    "loaded.mean_stiffness",
    "mesh_mean_stiffness",
    heading="mesh stiffness\nunder load [N/µm]",
    shown=".1f",
)
_PEAK_TO_PEAK = Quantity(
    "transmission_error_peak_to_peak_m",
    "loaded.peak_to_peak_transmission_error",
    "transmission_error_peak_to_peak",
    heading="TE p-p\n[µm]",
    shown=".3f",
)
_OUTCOMES = (_MISALIGNMENT, _K_H_BETA, _MEAN_STIFFNESS, _PEAK_TO_PEAK)
"""Quantities of a pair that are followed over torque; a row is a :class:`PairLoad`, of an idle pair without most."""

_GEARS = (
    Quantity("driver", "pair.driver.name", heading="driver"),
    Quantity("driven", "pair.driven.name", heading="driven"),
)
PAIR = (
    in_file("loaded_pair", "", "label"),
    *_GEARS,
    Quantity("force_n", "force", "mesh_mean_force", heading="force\n[N]", shown=".0f"),
    Quantity("thrust_n", "thrust", "mesh_thrust"),
    Quantity("face_width_m", "known_face.pair.geometry.face_width"),
    _MISALIGNMENT,
    Quantity(
        "misalignment_by_cause_rad",
        lambda load: {cause: load.misalignment_by_cause[cause] for cause in CAUSES},
        "misalignment_by_cause",
        ("cause",),
        long_name="part of the misalignment",
    ),
    Quantity("misalignment_over_face_m", heading="misaligned\n[µm]", shown="z.2f"),
    _K_H_BETA,
    _MEAN_STIFFNESS,
    Part(
        "transmission_error_m",
        "loaded",
        (Quantity("mean", "mean_transmission_error"), Quantity("peak_to_peak", "peak_to_peak_transmission_error")),
    ),
    # Transverse loads along the line of action, by face width.
    Part(
        "line_load_n_per_m",
        "loaded_face",
        (
            Quantity("mean", "mean_line_load", "mean_line_load", unit="N/m"),
            Quantity("maximum", "maximum_line_load", "maximum_line_load", unit="N/m"),
            Quantity("peak", "peak_line_load", "peak_line_load", unit="N/m"),
            Quantity("peak_of_tooth_pair", "fine.peak_line_load", "peak_line_load_of_tooth_pair", unit="N/m"),
        ),
    ),
    Quantity("contact_pressure_max_pa", "loaded_face.peak_pressure"),
    Quantity("carrying_part", "loaded.carrying_part"),
    in_file("face_slice_place", _SLICE, "z", unit="m"),
    in_file("face_gap", _SLICE, "gap", unit="m"),
    in_file("flank_gap", _SLICE, "pair.contact.flank_gap", unit="m"),
    in_file("face_mean_line_load", _SLICE, "loaded.line_load", unit="N/m"),
    in_file("face_line_load", (*_PHASE, *_SLICE), "loaded.fine.line_load", unit="N/m"),
    in_file("load_phase", _PHASE, "fine.phases", unit="1", common=True),
    in_file("loaded_transmission_error", _PHASE, "loaded.transmission_error", unit="m"),
)
"""Quantities of a gear pair at the operating point; a row is a :class:`PairLoad`."""

_OVER_TURN = (Quantity("mean"), Quantity("min", "least"), Quantity("max", "most"))
"""Mean and range over a turn of the carriers; a row is an :class:`OverTurn`."""


def _mean_and_range(heading: str, key: str, form: str, scale: float = 1.0) -> Column:
    """Return the mean over a turn of the carriers with the range in brackets; empty where there is none."""

    def shown(row: Document) -> str:
        values = row["over_turn"][key]
        if values is None:
            return ""
        mean, least, most = (f"{scale * values[part]:{form}}" for part in ("mean", "min", "max"))
        return mean if least == most else f"{mean} ({least} to {most})"

    return Column(heading, shown, numbers=tuple(f"over_turn.{key}.{part}" for part in ("mean", "min", "max")))


_TAKEN_ANGLE = Quantity("misalignment_taken_rad", "misalignment.taken", "misalignment_taken")
TAKEN = (
    _TAKEN_ANGLE,
    Quantity("misalignment_taken_from", "misalignment.origin", "misalignment_taken_from"),
    Part(
        "transmission_error_over_hunting_period_m",
        "hunting",
        (Quantity("mean", "mean_transmission_error"), Quantity("peak_to_peak", "peak_to_peak_transmission_error")),
    ),
    Part(
        "over_turn",
        "over_turn",
        (
            Part("force_n", "force", _OVER_TURN),
            Part("misalignment_rad", "misalignment", _OVER_TURN),
            Part("k_h_beta", "k_h_beta", _OVER_TURN),
        ),
        optional=True,
    ),
)
"""Misalignment that the motion takes of a gear pair, its static transmission error over the hunting period, and its
load over a turn of the carriers."""

_TURN_COLUMNS = (
    *columns_of(_GEARS),
    _mean_and_range("force\n[N]", "force_n", ".0f"),
    _mean_and_range("misaligned\n[µrad]", "misalignment_rad", "z.1f", _MICRO),
    _mean_and_range("K_Hβ", "k_h_beta", ".2f"),
)

SWEPT_PAIR = (
    replace(_MISALIGNMENT, long_name=meaning_of(PairLoad, "misalignment")),
    replace(_TAKEN_ANGLE, long_name=meaning_of(TakenMisalignment, "taken")),
    replace(_K_H_BETA, long_name=meaning_of(PairLoad, "k_h_beta")),
)
"""Quantities of a pair that a sweep has of every point."""

_PAIR_COLUMNS = (
    *columns_of(field for field in PAIR if field is not _MISALIGNMENT),
    Column(_PEAK_TO_PEAK.heading, "transmission_error_m.peak_to_peak", ".3f", _MICRO),
)


def _where_not_zero(cause: str) -> Column:
    """Return the misalignment by a cause that few machines have: by a carrier and its pins, by errors of seats."""

    def shown(row: Document) -> str:
        part = row["misalignment_by_cause_rad"][cause]
        return "" if part == 0.0 else f"{_MICRO * part:z.2f}"

    return Column(f"by\n{cause}", f"misalignment_by_cause_rad.{cause}", "z.2f", _MICRO, shown=shown)


_CAUSE_COLUMNS = (
    *columns_of((*_GEARS, _MISALIGNMENT)),
    *(Column(f"by\n{cause}", f"misalignment_by_cause_rad.{cause}", "z.2f", _MICRO) for cause in CAUSES[:3]),
    *map(_where_not_zero, CAUSES[3:5]),
    Column("by\nbodies", "misalignment_by_cause_rad.bodies", "z.2f", _MICRO),
)

_PLACE = ("shaft_place",)
SHAFT = (
    Quantity("name", "name", "deflected_shaft", heading="shaft"),
    Quantity("largest_deflection_m", "largest.0", heading="largest [µm]", shown=".4g"),
    Quantity("largest_deflection_at_m", "largest.1", heading="at, from its left end [mm]", shown=".4g"),
    Quantity("twist_rad", heading="twist [µrad]", shown=".0f"),
    in_file("shaft_position", _PLACE, "at", unit="m"),
    in_file("shaft_z", _PLACE, "z", unit="m"),
    in_file(
        "shaft_displacement",
        (*_DIRECTION, *_PLACE),
        lambda shaft: dict(zip(_AXES, shaft.motion[:3], strict=True)),
        "displacement of the shaft",
        "m",
    ),
    in_file(
        "shaft_rotation",
        ("shaft_rotation_axis", *_PLACE),
        lambda shaft: dict(zip((*_TILTS, "about z"), shaft.motion[3:], strict=True)),
        "rotation of the shaft",
        "rad",
    ),
)
"""Quantities of a deflected shaft."""


class _Torque(NamedTuple):
    """Operating point at a torque.

    Attributes
    ----------
    torque : float
        Torque of the first driver [N m].
    point : OperatingPoint
    """

    torque: float
    point: "OperatingPoint"


TORQUE = (Quantity("torque_n_m", "torque"), Rows("gear_pairs", "point.pairs", (*_GEARS, *_OUTCOMES)))
"""Quantities of an operating point over torque."""


class _SensorLine(NamedTuple):
    """Line of a sensor, its mesh harmonics in words, and whether parameters are ranked by it."""

    line: "Line"
    excitation: str
    ranked: bool


SENSOR_LINE = (
    Quantity("sensor", "line.output.sensor", "line_sensor", heading="sensor"),
    Quantity("excitation", "excitation", "line_excitation", heading="excitation"),
    Quantity("frequency_hz", "line.frequency", "line_frequency", heading="[Hz]", shown=".1f"),
    Quantity("amplitude_m_per_s2", "line.value", "line_amplitude", heading="[m/s²]", shown=".3g"),
    Quantity("ranked"),
)
"""Quantities of a sensor's line."""


class _LoudestLine(NamedTuple):
    """One of the loudest lines, its mesh harmonics in words, and whether parameters are ranked by it."""

    sound: "HarmonicSound"
    excitation: str
    ranked: bool


SOUND_LINE = (
    Quantity("excitation", "excitation", "loudest_line_excitation", heading="excitation"),
    Quantity("frequency_hz", "sound.line.frequency", "loudest_line_frequency", heading="[Hz]", shown=".1f"),
    in_file(
        "loudest_line_power", "", "sound.line.value", "sound power of the line, linear about the operating point", "W"
    ),
    Quantity("sound_power_db", lambda row: float(power_level(row.sound.line.value)), heading="L_W [dB]", shown=".1f"),
    Quantity(
        "sound_power_db_a",
        lambda row: float(power_level(row.sound.weighting * row.sound.line.value)),
        heading="L_WA [dB]",
        shown=".1f",
    ),
    Quantity("ranked"),
)
"""Quantities of a loudest line."""


_LEVELS = (
    Quantity("level_db"),
    Quantity("first_order_db", "first_order_level"),
    Quantity("reverse_level_db"),
    Quantity("first_order_is_off"),
)


class _Influence(NamedTuple):
    """Influence of a parameter, the gear pairs, and the sensitivity that it is of."""

    influence: "Influence"
    pairs: tuple[PairLoad, ...]
    sensitivity: "LoadSensitivity"


class _PairChange(NamedTuple):
    """Gear pair, and the changes of its misalignment [rad], of K_Hβ and of its transmission error, p-p [m]."""

    load: PairLoad
    misalignment: float
    k_h_beta: float
    transmission_error: float


def _pair_changes(row: _Influence) -> list[_PairChange]:
    changes = zip(row.pairs, row.influence.changes.tolist(), strict=True)
    return [_PairChange(load, *of_pair) for load, of_pair in changes]


INFLUENCE = (
    Quantity("parameter", "influence.parameter"),
    Quantity("kind", "influence.kind"),
    Quantity("step", "influence.step_text"),
    Quantity("step_words", "influence.words.0"),
    Quantity("reverse_words", "influence.words.1"),
    Rows(
        "lines",
        lambda row: row.sensitivity.sensor_changes(row.influence) if row.sensitivity.sensor_lines else ABSENT,
        (
            Quantity("sensor", "line.output.sensor"),
            Quantity("frequency_hz", "line.frequency"),
            Quantity("amplitude_m_per_s2", "change"),
            Quantity("first_order_m_per_s2"),
            Quantity("reverse_amplitude_m_per_s2", lambda change: _unless_none(change.reverse)),
            *_LEVELS,
        ),
    ),
    Rows(
        "sound",
        lambda row: row.sensitivity.sound_changes(row.influence) if row.sensitivity.loudest_lines else ABSENT,
        (
            Quantity("frequency_hz", "line.frequency"),
            Quantity("power_w", "change"),
            Quantity("first_order_w"),
            Quantity("reverse_power_w", lambda change: _unless_none(change.reverse)),
            *_LEVELS,
        ),
    ),
    Part(
        "sound_a",
        lambda row: row.sensitivity.total_sound_change(row.influence) if row.sensitivity.loudest_lines else ABSENT,
        _LEVELS,
    ),
    Rows(
        "gear_pairs",
        _pair_changes,
        (
            Quantity("driver", "load.pair.driver.name"),
            Quantity("driven", "load.pair.driven.name"),
            Quantity("misalignment_rad"),
            Quantity("k_h_beta", lambda row: _unless_idle(row.k_h_beta)),
            Quantity("transmission_error_peak_to_peak_m", lambda row: _unless_idle(row.transmission_error)),
        ),
    ),
)
"""Changes by a step of a parameter.

Changes of gear pairs are to first order, so that the reverse step has the opposite ones.
"""


def _unless_none(value: float) -> float | None:
    return None if math.isnan(value) else value


def _unless_idle(value: float) -> Any:
    return ABSENT if np.isnan(value) else value


def _change(outcome: Quantity, column: int) -> Quantity:
    """Declare the change of an outcome of every gear pair by every parameter's step, for the file."""

    def changes(solved: "SolvedLoad") -> Any:
        if solved.sensitivity is None or not solved.point.pairs:
            return None
        return np.array([influence.changes[:, column] for influence in solved.sensitivity.influences])

    long_name = f"change by a step of the parameter, to first order: {_meaning(outcome)}"
    return in_file(f"{outcome.name}_change", "influence loaded_pair", changes, long_name, outcome.file_unit)


def _line_changes(name: str, of: str, long_name: str, unit: str, changes: str, dimension: str) -> Quantity:
    """Declare changes of every line by every parameter's step, for the file."""

    def values(solved: "SolvedLoad") -> Any:
        sensitivity = solved.sensitivity
        if sensitivity is None or not getattr(sensitivity, f"{dimension}s"):
            return None
        return np.array(
            [
                [getattr(line, of) for line in getattr(sensitivity, changes)(influence)]
                for influence in sensitivity.influences
            ]
        )

    how = "to first order" if of == "first_order" else "the response solved anew"
    step = "reverse step" if of == "reverse" else "step"
    long_name = f"change of the line's {long_name} by a {step} of the parameter, {how}"
    return in_file(name, ("influence", dimension), values, long_name, unit)


def _sensor_lines(solved: "SolvedLoad") -> Any:
    """Lines of the sensors with their causes, where there are any."""
    sensitivity = solved.sensitivity
    if sensitivity is None or sensitivity.lines is None or not sensitivity.sensor_lines:
        return ABSENT
    return [
        _SensorLine(line, sensitivity.lines.cause(line), n == sensitivity.line)
        for n, line in enumerate(sensitivity.sensor_lines)
    ]


def _loudest_lines(solved: "SolvedLoad") -> Any:
    """Loudest lines with their causes, where there are any."""
    sensitivity = solved.sensitivity
    if sensitivity is None or sensitivity.lines is None or not sensitivity.loudest_lines:
        return ABSENT
    ranked = (sensitivity.sound_weights > 0.0).tolist()
    return [
        _LoudestLine(loud, sensitivity.lines.cause(loud.line), is_ranked)
        for loud, is_ranked in zip(sensitivity.loudest_lines, ranked, strict=True)
    ]


def _loudest_level(solved: "SolvedLoad") -> Any:
    """A-weighted sound power level of the loudest lines together, where there are any [dB]."""
    lines = _loudest_lines(solved)
    if lines is ABSENT:
        return ABSENT
    return float(power_level(sum(row.sound.weighting * row.sound.line.value for row in lines)))


def _lines_without(solved: "SolvedLoad") -> Any:
    sensitivity = solved.sensitivity
    return ABSENT if sensitivity is None or sensitivity.lines is None else sensitivity.lines.held


def _over_torque(outcome: Quantity) -> Quantity:
    """Declare an outcome of every gear pair over torque, for the file."""

    def values(solved: "SolvedLoad") -> Any:
        if not solved.over_torque or not solved.point.pairs:
            return None
        rows = [[outcome.value_of(pair) for pair in point.pairs] for point in solved.over_torque.values()]
        return np.array(rows, dtype=np.float64)  # NaN of pairs that carry nothing

    along, long_name = ("load_torque", "loaded_pair"), f"over torque: {_meaning(outcome)}"
    return in_file(f"{outcome.name}_over_torque", along, values, long_name, outcome.file_unit)


def _meaning(outcome: Quantity) -> str:
    return meaning_of(PairLoad, outcome.attribute.removeprefix("loaded."))


_OF_SENSORS = ("amplitude of acceleration", "m/s2", "sensor_changes", "sensor_line")
_OF_SOUND = ("sound power", "W", "sound_changes", "loudest_line")

PLANET = (
    Quantity("name", "shaft", heading="planet"),
    Quantity("angle_rad", "angle"),
    Quantity("torque_n_m", "torque", heading="torque\n[N·m]", shown=".4g"),
    Quantity("load_share", heading="load share", shown=".4f"),
    Quantity("bearing_force_n", "bearing_force", heading="on its pin\n[N]", shown=".0f"),
    Quantity("pin_error_m", "pin_error", document=list),
)
"""Quantities of a planet at the operating point; a row is a :class:`PlanetLoad`."""

PLANETARY = (
    Quantity("name"),
    Quantity("mesh_load_factor"),
    Rows("members", "members", MEMBER),
    Rows("planets", "planets", PLANET),
)
"""Quantities of a planetary set at the operating point; a row is a :class:`PlanetaryLoad`."""

PLANETARY_OVER_TURN = (
    Quantity("name", "loads.0.name"),
    Part("mesh_load_factor", "mesh_load_factor", _OVER_TURN),
    Rows("load_shares", "load_shares", _OVER_TURN),
)
"""Quantities of a planetary set over a turn of the carriers; a row is a :class:`PlanetaryLoadOverTurn`."""


BOLT = (
    in_file("support_bolt", "", "name"),
    Quantity("shaft", heading="shaft"),
    Quantity(
        "angle_rad",
        "bolt.angle",
        "support_bolt_angle",
        heading="bolt at",
        shown=lambda row: f"{math.degrees(row['angle_rad']):.4g}°",
    ),
    Quantity(
        "radial_force_n",
        "radial",
        "support_bolt_radial_force",
        long_name="force outwards of the shaft on the bolt",
        heading="radial\n[N]",
        shown="z.0f",
    ),
    Quantity(
        "tangential_force_n",
        "tangential",
        "support_bolt_tangential_force",
        long_name="force along the circle, counter-clockwise, of the shaft on the bolt",
        heading="tangential\n[N]",
        shown="z.0f",
    ),
    Quantity(
        "axial_force_n",
        "axial",
        "support_bolt_axial_force",
        long_name="force along z of the shaft on the bolt",
        heading="axial\n[N]",
        shown="z.0f",
    ),
)
"""Quantities of a bolt of a torque support: force of the shaft on it; a row is a :class:`_Bolt`."""


class _Bolt(NamedTuple):
    """Bolt of a torque support, its shaft and number, and its force outwards, along the circle and along z [N]."""

    name: str
    shaft: str
    bolt: "SupportBolt"
    radial: float
    tangential: float
    axial: float


def _bolts(solved: "SolvedLoad") -> Any:
    """Bolts of all torque supports; absent where no support has any."""
    return [
        _Bolt(f"{load.support.shaft} {number}", load.support.shaft, bolt, *force)
        for load in solved.point.supports
        for number, (bolt, force) in enumerate(zip(load.support.bolts, load.bolt_forces.tolist(), strict=True), start=1)
    ] or ABSENT


def _over_turns(solved: "SolvedLoad") -> Any:
    """Load shares, mesh forces and misalignments over the turn of each carrier, where they are asked for."""
    return [
        {
            "carrier": turn.carrier,
            "angle_rad": turn.angles.tolist(),
            "sets": [{"name": one.name, "load_share": turn.load_shares(one.name).T.tolist()} for one in turn.sets[0]],
            "mesh_force_n": {name: force.tolist() for name, force in turn.mesh_forces.items()},
            "misalignment_rad": {name: angle.tolist() for name, angle in turn.misalignments.items()},
            "bearing_force_n": {name: force.tolist() for name, force in turn.bearing_forces.items()},
        }
        for turn in solved.carrier_turns
    ] or ABSENT


def _turn_angles(solved: "SolvedLoad") -> Any:
    """Angles of each carrier at which the equilibria over a turn stand; absent where nothing changes with them."""
    points = solved.point.over_turn
    if len(points) < 2:
        return ABSENT
    return {name: [point.turned_by.get(name, 0.0) for point in points] for name in points[-1].turned_by}


def _of_planets(name: str, of: Callable[[Any], Any], unit: str, long_name: str) -> Quantity:
    """Declare a quantity of the planets of all sets, for the file."""

    def values(solved: "SolvedLoad") -> Any:
        found = [of(planet) for one in solved.planetary for planet in one.planets]
        return (np.array(found) if unit else found) if found else None

    return in_file(name, "loaded_planet", values, long_name, unit)


def _shares_over_turn(solved: "SolvedLoad") -> Any:
    """Load shares of the planets of all sets over the turns of their carriers, where they are asked for."""
    if not solved.carrier_turns:
        return None
    turns = {one.name: turn for turn in solved.carrier_turns for one in turn.sets[0]}
    return np.concatenate([turns[one.name].load_shares(one.name).T for one in solved.planetary])


LOAD: Fields = (
    Quantity("speed_rpm", lambda solved: solved.machine.speed * 30.0 / np.pi),
    Quantity("torque_n_m", "machine.torque"),
    Quantity("gravity_m_per_s2", optional=True),
    Quantity("seats", lambda solved: "housing" if solved.on_housing else "rigid"),
    Quantity("residual", "point.residual"),
    Quantity("iterations", "point.iterations"),
    Quantity("free_motions", "point.free"),
    in_file(_MOTION[0], _MOTION[:1], lambda solved: list(_MOTIONS)),
    in_file(_MOTION[1], _MOTION[1:], lambda solved: list(_MOTIONS)),
    Rows("shafts", "shafts", SHAFT, "deflected_shaft"),
    Rows("bearings", "bearings", BEARING, "loaded_bearing"),
    Rows("gear_pairs", "pairs", (Part("", "load", PAIR), *TAKEN), "loaded_pair"),
    Rows("planetary", lambda solved: list(solved.planetary) or ABSENT, PLANETARY),
    Rows("planetary_over_turn", lambda solved: list(solved.planetary_over_turn) or ABSENT, PLANETARY_OVER_TURN),
    Quantity("turn_angles_rad", _turn_angles),
    Rows("support_bolts", _bolts, BOLT, "support_bolt"),
    Quantity("carrier_turns", _over_turns),
    _of_planets("loaded_planet", lambda planet: planet.shaft, "", ""),
    _of_planets("planet_load_share", lambda planet: planet.load_share, "1", "part of the set's torque"),
    _of_planets("planet_bearing_force", lambda planet: planet.bearing_force, "N", "force of the planet on its pin"),
    in_file(
        "carrier_angle",
        "carrier_angle",
        lambda solved: solved.carrier_turns[0].angles if solved.carrier_turns else None,
        "angle by which the carrier has turned",
        "rad",
    ),
    in_file(
        "planet_load_share_over_turn",
        "loaded_planet carrier_angle",
        _shares_over_turn,
        "part of the set's torque over a turn of the carrier",
        "1",
    ),
    Rows("over_torque", lambda solved: [_Torque(*each) for each in solved.over_torque.items()] or ABSENT, TORQUE),
    Rows("sensor_lines", lambda solved: _sensor_lines(solved), SENSOR_LINE, "sensor_line"),
    Rows("loudest_lines", _loudest_lines, SOUND_LINE, "loudest_line"),
    Quantity("loudest_lines_db_a", _loudest_level),
    Quantity("lines_without", _lines_without),
    Rows(
        "sensitivity",
        lambda solved: (
            ABSENT
            if solved.sensitivity is None
            else [
                _Influence(influence, solved.point.pairs, solved.sensitivity)
                for influence in solved.sensitivity.influences
            ]
        ),
        INFLUENCE,
    ),
    in_file(
        "influence",
        "influence",
        lambda solved: (
            None
            if solved.sensitivity is None or not solved.point.pairs
            else [
                f"{influence.kind}: {influence.parameter}, {influence.step_text}"
                for influence in solved.sensitivity.influences
            ]
        ),
    ),
    *(
        _change(outcome, column)
        for column, outcome in enumerate((_MISALIGNMENT, _K_H_BETA, _PEAK_TO_PEAK))  # as in `OUTCOMES`
    ),
    _line_changes("line_amplitude_change", "change", *_OF_SENSORS),
    _line_changes("line_amplitude_first_order_change", "first_order", *_OF_SENSORS),
    _line_changes("line_amplitude_reverse_change", "reverse", *_OF_SENSORS),
    _line_changes("loudest_line_power_change", "change", *_OF_SOUND),
    _line_changes("loudest_line_power_first_order_change", "first_order", *_OF_SOUND),
    _line_changes("loudest_line_power_reverse_change", "reverse", *_OF_SOUND),
    in_file(
        "load_torque",
        "load_torque",
        lambda solved: np.array(list(solved.over_torque)) if solved.over_torque else None,
        "torque of the first driver",
        "N m",
    ),
    *(_over_torque(outcome) for outcome in _OUTCOMES),
)
"""Quantities of the operating point."""


def load_document(title: str, solved: "SolvedLoad") -> dict[str, Any]:
    """Return the operating point as the command's JSON."""
    return {"title": title} | document_of(LOAD, solved)


LOAD_OPTIONS = (
    Option(("over_torque",), ("load_torque",), "load-over-torque.png"),
    Option(("carrier_turns",), ("carrier_angle",), "load-carrier-turn-*.png"),
    Option(
        ("sensitivity", "sensor_lines", "loudest_lines", "loudest_lines_db_a", "lines_without"),
        ("influence", "sensor_line", "loudest_line"),
        "load-sensitivity-*.png",
    ),
)
"""Options of the operating point."""

LOAD_SAME = ("seats", "bearings", "gear_pairs", "shafts")
"""Keys of the operating point that no option changes."""


def load_part(solved: "SolvedLoad") -> dict[str, Any]:
    """Return the operating point as the key ``load`` of another analysis's JSON."""
    return document_of(LOAD, solved)


def brief(load: Document) -> Iterator[str]:
    """Yield the operating point in sentences, for the terminal of another analysis."""
    forces = ", ".join(
        f"{bearing['name']}: {math.hypot(*bearing['force_n'][:2]):.4g} N"
        for bearing in load["bearings"][:_MOST_BEARINGS]
    )
    more = len(load["bearings"]) - _MOST_BEARINGS
    others = f" and of {more} more bearings" if more > 0 else ""
    yield f"Operating point {_seats(load)}: radial loads {forces}{others}"
    yield from _misalignments(load)


def _misalignments(load: Document, *, with_turn: bool = True) -> Iterator[str]:
    """Yield the misalignment that the motion takes of every pair, beside that of the operating point.

    ``with_turn`` is false where those that change over a turn of carriers stand in a table.
    """
    turning = []
    for pair in load["gear_pairs"]:
        label, origin = f"{pair['driver']} → {pair['driven']}", pair["misalignment_taken_from"]
        if origin == "operating point" and "over_turn" in pair:
            mean, least, most = (
                _MICRO * pair["over_turn"]["misalignment_rad"][part] for part in ("mean", "min", "max")
            )
            turning.append(f"{label} {mean:z.2f} ({least:z.2f} to {most:z.2f})")
        else:
            words = misalignment_words(pair["misalignment_taken_rad"], origin, pair["misalignment_rad"])
            yield f"  {label}: {words}"
        over_hunting_period = pair.get("transmission_error_over_hunting_period_m")
        if over_hunting_period is not None:
            yield (
                f"  {label}: {_MICRO * over_hunting_period['peak_to_peak']:.3f} µm of transmission error p-p over the "
                "hunting period, with the pitch deviations and faults that the equilibrium leaves out"
            )
    if turning and with_turn:
        yield (
            "  misalignment [µrad] and curvature of the flank gap taken as the operating point has them, in the mean "
            f"over a turn of {' and '.join(load['turn_angles_rad'])} (range): {', '.join(turning)}"
        )


def share_words(origin: str | None) -> str:
    """Return what the mean force of a pair in a loop of pairs assumes; nothing for others."""
    if origin != EQUAL_MESHES:
        return ""
    return ", if the meshes of its loop of pairs are equally stiff; `gearwhine load` finds the shares"


def misalignment_words(misalignment: float | None, origin: str, at_operating_point: float | None) -> str:
    """Return the misalignment that the motion takes, its origin, and that of the operating point.

    Parameters
    ----------
    misalignment, at_operating_point : float or None
        [rad]; None where the operating point is not solved.
    origin : str
        See :class:`gearwhine.coupling.analyses.gear_pairs.TakenMisalignment`.
    """
    beside = "" if at_operating_point is None else f" (found: {_MICRO * at_operating_point:z.2f} µrad)"
    if origin == "default":
        return f"misalignment taken as 0, as the case gives none{beside}"
    if origin == "case":
        return f"misalignment of {_MICRO * (misalignment or 0.0):z.4g} µrad taken, as the case gives it{beside}"
    if at_operating_point is None:
        return "misalignment left to the operating point"
    taken = f"misalignment of {_MICRO * at_operating_point:z.2f} µrad"
    return f"{taken} and the curvature of the flank gap taken, as the operating point has them"


def _seats(load: Document) -> str:
    return "on its housing" if load["seats"] == "housing" else "in rigid seats (no housing)"


def sections(document: Document) -> tuple[Section, ...]:
    """Return the loads of bearings and gear pairs, and the proof of equilibrium."""
    return (Section("", tuple(_content(document))),)


def report(document: Document) -> Section:
    """Chapter of the report: as on the terminal, with the pictures."""
    return Section("Operating point", tuple(_content(document)), pictures=_PICTURES)


_PICTURES = (
    Picture("load-misalignment", "Misalignment of the flanks by its causes, which may cancel; black: their sum."),
    Picture("load-face", "Gap of the flanks before the load, and the load over the face: the more even, the better."),
    Picture("load-pattern", "Contact pattern over the face and the path of contact: loaded edges shorten life."),
    Picture("load-shaft", "Deflected shaft in both planes, enlarged; arrows: forces on it."),
    Picture("load-housing", "Housing under the mean load, enlarged; colour: displacement."),
    Picture(
        "load-sensitivity-line",
        "Material added on blue places lowers the sensor's line, on red ones raises it; the shape is its motion.",
    ),
    Picture(
        "load-sensitivity-sound",
        "Material added on blue places lowers the sound power, on red ones raises it; shape: the loudest line.",
    ),
    Picture(
        "load-sensitivity", "Material added on blue places lowers the misalignment of the pair, on red ones raises it."
    ),
    Picture("load-planetary", "Front view of the set: mesh forces on the planets and their forces on the pins."),
    Picture("load-carrier-turn", "Load share of each planet over a turn of the carrier."),
    Picture("load-over-torque", "Misalignment, K_Hβ, mesh stiffness and transmission error over the torque."),
)


_TORQUE_COLUMNS = (Column("torque\n[N·m]", "torque_n_m", ".4g"), Column("pair", "pair"), *columns_of(_OUTCOMES))

_MOST_INFLUENCES = 10  # parameters of a table
_MOST_BEARINGS = 8  # of a sentence


def _short_step(row: Document) -> str:
    """Return the step of a wall or face in words; of a bearing its size, since names are long."""
    return str(row["step"]) if str(row["kind"]).startswith("bearing") else str(row["step_words"])


_STEP_KEYS = ("parameter", "kind", "step", "step_words", "reverse_words")
_INFLUENCE_COLUMNS = (
    Column("parameter", "parameter"),
    Column("of", lambda row: str(row["kind"]).removeprefix("bearing ")),
    Column("step", _short_step),
    Column("pair", "pair"),
    Column("misaligned\n[µrad]", "misalignment_rad", "+z.3f"),
    Column("K_Hβ", "k_h_beta", "+z.4f"),
    Column("TE p-p\n[nm]", "transmission_error_peak_to_peak_m", "+z.2f"),
)


def _influences(document: Document) -> Iterator[str | Table]:
    """Yield the changes of the gear pairs by the strongest parameters, of the housing and of the bearings."""
    for of_bearings, place in ((False, "the housing"), (True, "a bearing")):
        influences = [
            influence
            for influence in document.get("sensitivity", ())
            if influence["kind"].startswith("bearing") is of_bearings
        ]
        rows = [
            {key: influence[key] for key in _STEP_KEYS if key in influence}
            | {"pair": f"{pair['driver']} → {pair['driven']}"}
            | pair
            for influence in influences[:_MOST_INFLUENCES]
            for pair in influence["gear_pairs"]
        ]
        yield from table_of(
            _INFLUENCE_COLUMNS,
            rows,
            f"Change by a step of one parameter of {place}, to first order; the opposite by the reverse step",
        )
        if rows and len(influences) > _MOST_INFLUENCES:
            yield f"{len(influences) - _MOST_INFLUENCES} weaker parameters of {place} are in the files only"


def _first_order(row: Document) -> str:
    return f"{row['first_order_db']:+.2f}" + (" (off)" if row.get("first_order_is_off") else "")


_LINE_COLUMNS = (
    Column("parameter", "parameter"),
    Column("of", lambda row: str(row["kind"]).removeprefix("bearing ")),
    Column("step", "step_words"),
    Column("level\n[dB]", "level_db", "+z.2f"),
    Column("first order\n[dB]", "first_order_db", shown=_first_order),
    Column("reverse", "reverse_words"),
    Column("level\n[dB]", "reverse_level_db", "+z.2f"),
)
_OFF_NOTE = (
    "(off): the level at a step differs from the first order by more than 1 dB, or by more than 0.3 dB and in sign, "
    "since a resonance moves within the step. Take the levels, and solve the changed case before relying on them"
)


def _lines(document: Document) -> Iterator[str | Table]:
    """Yield the lines of sensors and sound, and the strongest parameters of those that are ranked."""
    lines, loudest = document.get("sensor_lines", ()), document.get("loudest_lines", ())
    shown: list[Table] = []
    if lines:
        caption = "Sensors' lines at mesh harmonics, linear about the mean load"
        yield from table_of(columns_of(SENSOR_LINE), lines, caption)
        number = next(n for n, row in enumerate(lines) if row["ranked"])
        chosen = f"the line of {lines[number]['sensor']} at {lines[number]['frequency_hz']:.0f} Hz"
        shown += _ranked(document, chosen, lambda row: row["lines"][number])
        yield from shown
    if loudest:
        caption = "Loudest mesh harmonics, A-weighted, linear about the mean load: sound power level re 1 pW"
        yield from table_of(columns_of(SOUND_LINE), loudest, caption)
        ranked = [n for n, row in enumerate(loudest) if row["ranked"]]
        if len(ranked) > 1:
            quantity = f"the A-weighted sound power of {counted(len(loudest), 'line')} together"
            by_sound = _ranked(document, quantity, lambda row: row["sound_a"])
        else:
            chosen = f"the sound power at {loudest[ranked[0]]['frequency_hz']:.0f} Hz"
            by_sound = _ranked(document, chosen, lambda row: row["sound"][ranked[0]])
        yield from by_sound
        shown += by_sound
    if lines or loudest:
        if any(row.get("first_order_is_off") for table in shown for row in table.rows):
            yield _OFF_NOTE
        case_fixes = document["lines_without"]
        fixed = "" if case_fixes is None else f"; the case fixes {case_fixes}, which do not follow the walls"
        surface = ", and the radiating surface is held" if loudest else ""
        yield f"In these changes damping ratios, friction of the teeth and mean mesh forces are kept{surface}{fixed}"


def _ranked(document: Document, quantity: str, change: Callable[[Document], dict[str, Any]]) -> list[Table]:
    """Return the parameters of the housing and of the bearings that change a level most."""
    tables: list[Table] = []
    for of_bearings, place in ((False, "the housing"), (True, "a bearing")):
        rows = [
            {key: influence[key] for key in _STEP_KEYS if key in influence} | change(influence)
            for influence in document["sensitivity"]
            if influence["kind"].startswith("bearing") is of_bearings
        ]
        rows.sort(key=lambda row: -max(abs(row["level_db"]), abs(row.get("reverse_level_db") or 0.0)))
        caption = f"Change of {quantity} by a step of one parameter of {place}"
        tables += table_of(_LINE_COLUMNS, rows[:_MOST_INFLUENCES], caption)
    return tables


def _content(document: Document) -> Iterator[str | Table]:
    torque, loads = document["torque_n_m"], "preload and weight" if "gravity_m_per_s2" in document else "preload"
    if torque == 0.0 and not document["gear_pairs"]:
        yield f"Static equilibrium without torque, under {loads} alone, {_seats(document)}; no flanks carry"
    else:
        yield f"Static equilibrium at {torque:.5g} N·m, {_seats(document)}; friction of the teeth is left out"
    caption = "Force and tilting moment of the shafts on their bearings"
    yield from table_of(_BEARING_COLUMNS, document["bearings"], caption)
    rolling = [row for row in document["bearings"] if row["peak_pressure_pa"] is not None]
    yield from table_of(_ROLLING_COLUMNS, rolling, "Rolling bearings: elements, life, tangent stiffness along x, y, z")
    caption = "Gear pairs, means over the mesh period, with the misalignment found (as of unmodified flanks)"
    yield from table_of(_PAIR_COLUMNS, document["gear_pairs"], caption)
    yield from table_of(_CAUSE_COLUMNS, document["gear_pairs"], "Misalignment of the flanks, open towards +z [µrad]")
    if angles := document.get("turn_angles_rad"):
        count = len(next(iter(angles.values())))
        caption = f"Gear pairs over a turn of {' and '.join(angles)}: mean and range of {count} angles"
        yield from table_of(_TURN_COLUMNS, document["gear_pairs"], caption)
        yield (
            "Mesh stiffness and motion take these means, with the curvature of the flank gap. Lives of bearings count "
            "all angles. All else here is of the first one, at which the planets stand where the case puts them"
        )
    yield from _misalignments(document, with_turn=False)
    yield from _planetary(document)
    yield from table_of(columns_of(BOLT), document.get("support_bolts", ()), "Forces on the bolts of torque supports")
    rows = [
        {"torque_n_m": point["torque_n_m"], "pair": f"{pair['driver']} → {pair['driven']}"} | pair
        for point in document.get("over_torque", ())
        for pair in point["gear_pairs"]
    ]
    yield from table_of(_TORQUE_COLUMNS, rows, "Over torque")
    yield from _influences(document)
    yield from _lines(document)
    yield from table_of(columns_of(SHAFT), document["shafts"], "Deflection of the shafts")
    yield from _pin_error_note(document)
    yield from kept_sentence(document, LOAD_OPTIONS, "equilibrium")
    yield f"Forces balance to {document['residual']:.0e} of the largest load"
    if document["free_motions"]:
        yield f"Free motions, which nothing holds and no load drives: {_grouped(document['free_motions'])}"


_SHARE_OVER_TURN = _mean_and_range("share over a turn", "load_share", ".4f")


def _planetary(document: Document) -> Iterator[str | Table]:
    """Yield the members of every planetary set, and how its planets share the load."""
    turns = {one["name"]: one for turn in document.get("carrier_turns", ()) for one in turn["sets"]}
    means = {one["name"]: one for one in document.get("planetary_over_turn", ())}
    for one in document.get("planetary", ()):
        yield from table_of(columns_of(MEMBER), one["members"], f"Members of planetary set {one['name']}")
        planets, factor = one["planets"], f"{one['mesh_load_factor']:.4f}"
        if mean := means.get(one["name"]):
            each = zip(planets, mean["load_shares"], strict=True)
            planets = [planet | {"over_turn": {"load_share": share}} for planet, share in each]
            values = mean["mesh_load_factor"]
            factor += f", over a turn {values['mean']:.4f} in the mean and {values['max']:.4f} at most"
        columns = (*columns_of(PLANET), *((_SHARE_OVER_TURN,) if mean else ()))
        yield from table_of(columns, planets, f"Planets of {one['name']} under load")
        yield f"Mesh load factor K_γ of {one['name']}: {factor} (1 where all planets carry alike)"
        if one["name"] in turns:
            shares = np.array(turns[one["name"]]["load_share"])
            yield (
                f"Over a turn of the carrier the load shares are {shares.min():.4f} to {shares.max():.4f}, K_γ at most "
                f"{len(shares) * shares.max():.4f}"
            )


def _pin_error_note(document: Document) -> Iterator[str]:
    """Yield that deflections of planets have the errors of their pins in them."""
    errors = [
        (planet["name"], float(np.hypot(*planet["pin_error_m"])))
        for one in document.get("planetary", ())
        for planet in one["planets"]
    ]
    if listed := [f"{name} {_MICRO * error:.3g} µm" for name, error in errors if error > 0.0]:
        yield f"Deflections are from the places of pins without errors, which they contain: {', '.join(listed)}"


def _grouped(motions: list[str]) -> str:
    """Return free motions by their kind: ``the rotation of shaft 'a'; the axial motion of shaft 'a', 'b'``."""
    kinds: dict[str, list[str]] = {}
    for motion in motions:
        kind, _, shaft = motion.partition(" of shaft ")
        kinds.setdefault(kind, []).append(shaft)
    return "; ".join(f"{kind} of {', '.join(shafts)}" if any(shafts) else kind for kind, shafts in kinds.items())
