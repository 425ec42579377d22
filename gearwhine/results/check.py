"""Check of a case or a machine: quantities known by arithmetic alone, and how the terminal shows them."""

import math
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gearwhine.case import Case, amounts, rotor_speeds
from gearwhine.coupling.description.axial_location import ARRANGEMENTS
from gearwhine.exchange.rexs.notes import Note, in_words
from gearwhine.numerics.progress import Progress, silent
from gearwhine.output.quantity import ABSENT, HERTZ, RPM, Part, Quantity, Rows, document_of
from gearwhine.output.sections import Document, Section, counted
from gearwhine.results.gears import BACKLASH, GEOMETRY, backlash_words
from gearwhine.results.housing import MESH_SIZE
from gearwhine.results.mesh import BORE, bore_line, bores, kinds_of_elements
from gearwhine.results.motion import damping_lines, gear_body_lines
from gearwhine.results.operating_point import misalignment_words, share_words
from gearwhine.results.planetary import PLANETARY, set_lines, set_summary
from gearwhine.rotors import Coupling
from gearwhine.rotors.rolling_bearings import static_rating
from gearwhine.solve.case_summary import check_case
from gearwhine.solve.damping import damping_document, part_dampings
from gearwhine.solve.gear_bodies import gear_body_document

if TYPE_CHECKING:
    from gearwhine.case import Joint, Mount
    from gearwhine.case.rotors import Rotor as CaseRotor
    from gearwhine.coupling.machine.loads import Torque
    from gearwhine.housing import Joint as BuiltJoint


def _bushing(bushing: "Mount | Joint") -> dict[str, Any]:
    """Return the springs and dashpots that are not zero, by motion; each key has its unit."""
    document: dict[str, Any] = {"name": bushing.name}
    for key, turning_unit, unit in (("stiffness", "n_m_per_rad", "n_per_m"), ("damping", "n_m_s_per_rad", "n_s_per_m")):
        table = getattr(bushing, key)
        if table is None:
            continue
        for motion, amount in zip(type(table).model_fields, amounts(table), strict=True):
            if amount:
                turning = motion in ("rx", "ry", "rz", "tilting", "torsional")
                document.setdefault(f"{key}_{turning_unit if turning else unit}", {})[motion] = amount
    return document


def _joint(joint: "Joint") -> dict[str, Any]:
    """Return a joint with the surfaces that it connects."""
    if joint.surfaces is not None:
        return _bushing(joint) | {"surfaces": joint.surfaces}
    return _bushing(joint) | {"diameter_m": joint.diameter, "center_m": joint.center}


def _bolt(joint: "BuiltJoint") -> dict[str, Any]:
    """Return a bolt of a box's cover with its springs."""
    shear, _, axial, tilting, _, torsional = joint.bushing.stiffness
    return {
        "name": joint.name,
        "position_m": joint.center,
        "stiffness_n_per_m": {"axial": axial, "shear": shear},
        "stiffness_n_m_per_rad": {"tilting": tilting, "torsional": torsional},
    }


def _names(key: str, table: str) -> Quantity:
    return Quantity(key, lambda checked: [member.name for member in getattr(checked.case.housing, table)])


def _of_mesh(key: str, of: Any) -> Quantity:
    """Declare a quantity of the mesh of a file."""
    return Quantity(key, lambda checked: None if checked.mesh.mesh is None else of(checked.mesh.mesh), optional=True)


HOUSING = (
    Quantity(
        "geometry",
        lambda checked: "box" if checked.case.housing.box else "mesh" if checked.case.housing.mesh else "cad",
    ),
    Quantity("material", "case.housing.material"),
    Quantity("frequency_limit_hz", lambda checked: checked.case.housing.frequency_limit),
    Quantity("modes", "case.housing.modes"),
    _names("seats", "seat"),
    _names("supports", "support"),
    Quantity("mounts", lambda checked: [_bushing(mount) for mount in checked.case.housing.mount]),
    Quantity("joints", lambda checked: [_joint(joint) for joint in checked.case.housing.joint]),
    Rows(
        "masses",
        "case.housing.mass",
        (Quantity("name"), Quantity("mass_kg")),
    ),
    _names("sensors", "sensor"),
    Quantity(
        "regions", lambda checked: [f"{region.name} of {region.material}" for region in checked.case.housing.region]
    ),
    Quantity("size_m", "mesh.size"),
    Quantity("mesh_size_m", "mesh.mesh_size", optional=True),
    Quantity("accuracy", "case.housing.accuracy", optional=True),
    Quantity(
        "cover_bolts",
        lambda checked: None if checked.mesh.bolts is None else [*map(_bolt, checked.mesh.bolts)],
        optional=True,
    ),
    Rows("bores", lambda checked: ABSENT if checked.mesh.mesh is None else bores(checked.mesh.mesh), BORE),
    _of_mesh("surfaces", lambda mesh: sorted(mesh.surfaces)),
    _of_mesh("volumes", lambda mesh: sorted(mesh.volumes)),
    Part("mesh", lambda checked: checked.mesh.mesh if checked.case.housing.mesh else None, MESH_SIZE, optional=True),
    Quantity("kinds", lambda checked: checked.mesh.mesh.kinds if checked.case.housing.mesh else None, optional=True),
)
"""Quantities of a housing as the case gives it, and of its mesh as far as that is known."""

REDUCED_HOUSING = (
    Quantity("coordinates", "matrices.size"),
    Quantity("nodes", lambda housing: list(housing.matrices.nodes)),
    Quantity("frequency_limit_hz", "limit"),
    Quantity("frequencies_hz", lambda housing: housing.frequencies_hz.tolist()),
    Quantity("damping_ratio"),
    Quantity("seats", lambda housing: [seat.name for seat in housing.seats]),
    Quantity("supports", lambda housing: [support.name for support in housing.supports]),
    Quantity("sensors", lambda housing: [sensor.name for sensor in housing.sensors]),
    Part(
        "certificate",
        "certificate",
        (
            Quantity("least_mass_eigenvalue"),
            Quantity("least_stiffness_eigenvalue"),
            Quantity("massless_coordinates", "massless_count"),
            Quantity("free_rigid_motions", "free_motions"),
            Quantity("mass_kg"),
            Quantity("held_frequency_hz", "held_frequency", optional=True),
            Quantity("static_difference", optional=True),
        ),
        optional=True,
    ),
)
"""Quantities of a housing of reduced matrices, and what is proved of these."""

ROTOR = (
    Quantity("name", "built.name"),
    Quantity("length_m", "built.length"),
    Quantity("segments", lambda rotor: len(rotor.built.segments)),
    Quantity("couplings", lambda rotor: sum(isinstance(segment, Coupling) for segment in rotor.built.segments)),
    Quantity("mass_kg", "built.mass"),
    Quantity("polar_inertia_kg_m2", "built.polar_inertia"),
    Quantity("speed_rpm"),
    Quantity("mass_model", "built.mass_model"),
)
"""Quantities of a rotor."""


def _ends(speeds: Sequence[float] | None) -> list[float] | None:
    """First and last speed of a table."""
    return None if speeds is None else [float(speed) * RPM for speed in (speeds[0], speeds[-1])]


def _span(speeds: Sequence[float]) -> list[float] | None:
    """First speed, last one and their number."""
    return [min(speeds) * RPM, max(speeds) * RPM, len(speeds)] if speeds else None


class _Analysis(NamedTuple):
    """Case, and one of its rotors."""

    case: Case
    rotor: "CaseRotor"


def _response_speeds(row: _Analysis) -> Sequence[float]:
    case, rotor = row
    return rotor_speeds(case, rotor.name).response if rotor.unbalance or rotor.bow else ()


def _swinging_torques(row: _Analysis) -> int:
    case, rotor = row
    torsion = None if case.rotor_analysis is None else case.rotor_analysis.torsional_response
    return 0 if torsion is None else sum(torque.rotor == rotor.name for torque in torsion.torques)


ANALYSIS = (
    Quantity("rotor", "rotor.name"),
    Quantity("campbell_rpm", lambda row: _span(rotor_speeds(row.case, row.rotor.name).campbell)),
    Quantity("response_rpm", lambda row: _span(_response_speeds(row))),
    Quantity("torques", _swinging_torques),
)
"""Quantities of the analyses that ``gearwhine rotors`` makes of a rotor."""

ROLLING = (
    Quantity("elements", lambda bearing: [row.count for row in bearing.rows]),
    Quantity("element_diameter_m", "rows.0.element_diameter"),
    Quantity("pitch_diameter_m", "rows.0.pitch_diameter"),
    Quantity("contact_angle_rad", lambda bearing: bearing.rows[0].contact_angle),
    Quantity("clearance_m", "rows.0.clearance"),
    Quantity("dynamic_rating_n"),
    Quantity("dynamic_rating_from", lambda bearing: "geometry" if bearing.catalogue_rating is None else "case"),
    Quantity("static_rating_n", lambda bearing: sum(map(static_rating, bearing.rows))),
    Quantity("estimated"),
)
"""Quantities of the inside of a rolling bearing; those of one row are of the first, the static rating by ISO 76."""

BEARING = (
    Quantity("name", "bearing.name"),
    Quantity("rotor"),
    Quantity("seat", lambda mounted: mounted.seat or "ground"),
    Quantity("table_rpm", lambda mounted: _ends(mounted.bearing.speeds)),
    Quantity("pedestal_kg", "bearing.pedestal.mass"),
    Part("rolling", "rolling", ROLLING, optional=True),
)
"""Quantities of a bearing in its seat."""

LOCATION = (
    Quantity("rotor", "shaft"),
    Quantity("arrangement"),
    Quantity("thrust_plus_z", lambda location: location.carrying(1)),
    Quantity("thrust_minus_z", lambda location: location.carrying(-1)),
    Quantity(
        "rows",
        lambda location: {bearing.name: bearing.arrangement for bearing in location.bearings if bearing.arrangement},
    ),
)
"""Quantities of a rotor's location: bearings that take its thrust towards +z and -z, and arrangements of rows."""

PAIR = (
    Quantity("driver", "geometry.driver.name"),
    Quantity("driven", "geometry.driven.name"),
    Quantity("ratio", lambda pair: abs(pair.geometry.ratio)),
    Quantity("contact_ratio", "geometry.contact_ratio"),
    Quantity("overlap_ratio", "geometry.overlap_ratio"),
    Quantity("total_contact_ratio", "geometry.total_contact_ratio"),
    Quantity("centre_distance_m", lambda pair: abs(pair.geometry.working_centre_distance)),
    Quantity("working_pressure_angle_deg", "geometry.working_pressure_angle"),
    Part("backlash_m", lambda pair: pair, BACKLASH),
    Quantity("mesh_frequency_hz", lambda pair: pair.mesh_frequency),
    Quantity("mean_force_n"),
    Quantity("mean_force_from", "force_origin"),
    Quantity("misalignment_rad", "misalignment.taken"),
    Quantity("misalignment_from", "misalignment.origin"),
    Quantity("stiffness_model"),
    Part("geometry", "geometry", GEOMETRY),
)
"""Quantities of a gear pair."""

_TORQUE_LINE = (
    Quantity("speed_rpm", lambda line: np.array(line.speed) * RPM),
    Quantity("torque_n_m"),
)


class _AppliedTorque(NamedTuple):
    """Torque from outside, and its place on the rotor [m]; without rotors torques have no place."""

    torque: "Torque"
    at: float | None


OPERATION = (
    Quantity("speed_rpm", "operation.speed"),
    Quantity("torque_n_m", "operation.torque"),
    Rows(
        "torques",
        lambda case: [_AppliedTorque(torque, torque.at if case.rotor else None) for torque in case.parts.torques],
        (
            Quantity("rotor", "torque.rotor"),
            Quantity("at_m"),
            Quantity("torque_n_m", "torque.value"),
        ),
    ),
    Quantity("gravity_m_per_s2", "operation.gravity", optional=True),
    Part(
        "base",
        "operation.base",
        (
            Quantity("point_m"),
            Quantity("harmonics_hz", lambda base: [harmonic.frequency for harmonic in base.harmonic]),
            Quantity("over_time", lambda base: base.over_time is not None),
        ),
        optional=True,
    ),
    Part("motor", "operation.motor", _TORQUE_LINE, optional=True),
    Part("load", "operation.load", _TORQUE_LINE, optional=True),
)
"""Quantities of the operation; motor and load by their torque over speed, which drives a run of free speed."""

TRANSIENT = (
    Quantity("revolutions", lambda transient: transient.revolutions if transient.run is None else None, optional=True),
    Quantity(
        "recorded_revolutions",
        lambda transient: transient.revolutions - transient.discard if transient.run is None else None,
        optional=True,
    ),
    Part(
        "run",
        "run",
        (
            Quantity("seconds", "duration"),
            Quantity("free"),
            Quantity("times_s", "line.0"),
            Quantity("speeds_rpm", lambda run: np.array(run.line[1]) * RPM),
        ),
        optional=True,
    ),
    Quantity(
        "discarded_revolutions", lambda transient: None if transient.run is None else transient.discard, optional=True
    ),
    Quantity("tolerance"),
)
"""Quantities of a transient at one speed, or of a run over speed."""

_SURVEY = (
    Quantity("remarks"),
    Part(
        "",
        "modes",
        (
            Quantity("frequencies_hz"),
            Quantity("damping_ratios"),
            Quantity("complex", lambda modes: modes.shapes is not None and np.any(np.nan_to_num(modes.shapes).imag)),
        ),
    ),
    Part(
        "",
        "geometry",
        (
            Quantity("points", lambda geometry: len(geometry.positions)),
            Quantity("degrees_of_freedom", lambda geometry: len(geometry.points)),
            Quantity("extent_m", lambda geometry: np.ptp(geometry.positions, axis=0)),
        ),
    ),
    Part(
        "responses",
        "responses",
        (
            Quantity("of", "motion"),
            Quantity("references", lambda responses: len(responses.reference_points)),
            Quantity("lines", lambda responses: len(responses.frequencies)),
            Quantity("from_hz", "frequencies.0"),
            Quantity("to_hz", lambda responses: responses.frequencies[-1] / HERTZ),
        ),
        optional=True,
    ),
)


def _alignment(measured: Any) -> bool | str | None:
    if measured.survey is None or measured.survey.geometry is None:
        return None
    return measured.align if isinstance(measured.align, bool) else "landmarks"


MEASURED = (
    Quantity(
        "frequencies_hz",
        lambda measured: list(measured.frequencies or ()) if measured.survey is None else None,
        optional=True,
    ),
    Quantity("file", lambda measured: None if measured.survey is None else measured.file_names, optional=True),
    Part("", "survey", _SURVEY),
    Quantity("align", _alignment, optional=True),
    Quantity("pairing", "paired_by"),
)
"""Quantities of the measurement on the housing."""

IMPORTED = (
    Quantity("origin"),
    Quantity("load_cases"),
    Rows("notes", "notes", (Quantity("kind"), Quantity("about"), Quantity("text"))),
)
"""Quantities of a gear unit that was imported: the file, its load cases, and what was assumed, changed and left out."""


def _keys(key: str, table: str) -> Quantity:
    """Declare the keys of a table of a study of many gearboxes."""
    return Quantity(key, lambda study: list(getattr(study, table)))


_ROTORS = Rows("rotors", lambda checked: checked.rotors or ABSENT, ROTOR)
_TRAIN = (
    Rows(
        "axial_location",
        lambda checked: [location for location in checked.locations if location.bearings] or ABSENT,
        LOCATION,
    ),
    Rows("gear_pairs", lambda checked: checked.pairs or ABSENT, PAIR),
    Rows("planetary", lambda checked: checked.sets or ABSENT, PLANETARY),
)
_GEAR_BODIES = Quantity(
    "gear_bodies", lambda checked: (checked.machine and gear_body_document(checked.machine)) or None, optional=True
)
_TORQUE = (Quantity("rotor"), Quantity("at_m", "at"), Quantity("torque_n_m", "value"))

CHECKED_MACHINE = (
    Quantity("title", "settings.title"),
    _ROTORS,
    Rows("bearings", lambda checked: checked.machine.bearings or ABSENT, BEARING),
    *_TRAIN,
    Part(
        "operation",
        "machine",
        (
            Quantity("speed_rpm", "speed"),
            Quantity("torque_n_m", "torque"),
            Rows("torques", "constant_torques", _TORQUE),
            Quantity("gravity_m_per_s2", "gravity", optional=True),
        ),
    ),
    Part(
        "transient",
        lambda checked: ABSENT if (plan := checked.settings.transient) is None or plan.run is not None else plan,
        (
            Quantity("revolutions"),
            Quantity("recorded_revolutions", lambda plan: plan.revolutions - plan.discarded),
            Quantity("tolerance"),
        ),
    ),
    _GEAR_BODIES,
    Quantity("warnings", lambda checked: checked.warnings or None, optional=True),
)
"""Quantities of a machine of Python, by the same keys."""

_LIMITS = _keys("limits", "limit")

CHECK = (
    Quantity("title", "case.title"),
    Part("imported", "imported", IMPORTED, optional=True),
    Part("housing", lambda checked: ABSENT if checked.mesh is None else checked, HOUSING),
    Part("reduced_housing", "reduced", REDUCED_HOUSING, optional=True),
    _ROTORS,
    Rows(
        "rotor_analysis",
        lambda checked: [_Analysis(checked.case, rotor) for rotor in checked.case.rotor] or ABSENT,
        ANALYSIS,
    ),
    Rows("bearings", lambda checked: checked.case.parts.bearings or ABSENT, BEARING),
    *_TRAIN,
    Part("operation", lambda checked: ABSENT if checked.case.operation is None else checked.case, OPERATION),
    Part("transient", "case.transient", TRANSIENT, optional=True),
    Part("sweep", "case.sweep", (Quantity("speeds", lambda sweep: len(sweep.speeds)),), optional=True),
    Part("variation", "case.variation", (Quantity("samples"), _LIMITS, _keys("keys", "vary")), optional=True),
    Part(
        "optimisation",
        "case.optimisation",
        (Quantity("evaluations"), _LIMITS, _keys("keys", "design"), _keys("aims", "aim")),
        optional=True,
    ),
    Part("detection", "case.detection", (Quantity("fault"), Quantity("severities")), optional=True),
    Part("measured", "case.measured", MEASURED, optional=True),
    Quantity("provenance", lambda checked: checked.case.provenance or None, optional=True),
    _GEAR_BODIES,
    Quantity("damping", lambda checked: damping_document(part_dampings(checked.case)) or None, optional=True),
    Quantity("warnings", lambda checked: checked.warnings or None, optional=True),
)
"""Quantities of a checked case."""


def check_document(case: Case, progress: Progress = silent) -> dict[str, Any]:
    """Return all quantities that follow from the case by arithmetic, and the contents of its geometry's file."""
    return document_of(CHECK, check_case(case, progress))


_WIDTH = 12  # of the column with the names of parts
_MOST_TURNS = 10_000  # of the first driver until a carrier has made whole turns


def sections(document: Document) -> tuple[Section, ...]:
    """Return the parts of a case in words, a part's name before its first line."""
    return _in_words(_parts(document))


def summary(document: Document) -> tuple[Section, ...]:
    """Return the case in about a dozen lines: parts counted, bearings that locate their shafts, meshes, operation."""
    return (*_in_words(_summed(document)), Section("", ("All of it: gearwhine check CASE --verbose",)))


def _in_words(parts: Iterable[tuple[str, list[str]]]) -> tuple[Section, ...]:
    return tuple(
        Section(part, tuple(f"{'':{_WIDTH - 2}}{line}" for line in lines), note=f"{'':{_WIDTH - len(part)}}{first}")
        for part, (first, *lines) in parts
    )


def _summed(document: Document) -> Iterator[tuple[str, list[str]]]:
    """Yield the parts with a line or a few each; others than here have all their lines."""
    thrust = [location for location in document.get("axial_location", ()) if _is_worth_a_line(location)]
    carriers = [one["carrier"] for one in document.get("planetary", ())]
    rotors = [one["name"] for one in document.get("rotors", ())]
    shorter = {
        "housing": _housing_summary(document["housing"]) if "housing" in document else reduced_lines(document),
        "bearings": _bearing_summary(document.get("bearings", ()), carriers, rotors),
        "thrust": list(map(_location_line, thrust)),
        "gear pairs": list(map(_pair_summary, _listed_pairs(document))),
        "planetary": [line for one in document.get("planetary", ()) for line in set_summary(one)],
        "operation": [", ".join(_operation_lines(document["operation"]))] if "operation" in document else [],
    }
    for part, lines in _parts(document):
        if part not in ("analysis", "gear bodies", "standing") and (shown := shorter.get(part, lines)):
            yield part, shown


def imported_lines(imported: Document) -> list[str]:
    """Return the origin of an imported case, its load cases and notes, those of the same text as one."""
    notes = [Note(**note) for note in imported["notes"]]
    return [f"from {imported['origin']}", *imported["load_cases"], *in_words(notes)]


def _housing_summary(housing: Document) -> list[str]:
    """Return the kind of the housing, and the number of its parts."""
    first = _housing_lines(housing)[0]
    counts = [
        counted(len(housing[key]), word)
        for key, word in (
            ("seats", "seat"),
            ("supports", "support"),
            ("mounts", "mount"),
            ("joints", "joint"),
            ("sensors", "sensor"),
        )
        if housing[key]
    ]
    counts += [f"{len(housing['masses'])} lumped mass" + "es" * (len(housing["masses"]) > 1)] * bool(housing["masses"])
    counts += [counted(len(housing["bores"]), "bore") + " in the drawing"] if housing.get("bores") else []
    return [first, ", ".join(counts)] if counts else [first]


def _bearing_summary(bearings: Sequence[Document], carriers: Sequence[str], rotors: Sequence[str]) -> list[str]:
    if not bearings:
        return []
    on_ground = sum(bearing["seat"] == "ground" for bearing in bearings)
    on_pins = sum(bearing["seat"] in carriers for bearing in bearings)
    between = sum(bearing["seat"] in rotors for bearing in bearings) - on_pins
    seated = len(bearings) - on_ground - on_pins - between
    counts = (
        (seated, "in seats of the housing"),
        (on_ground, "on the ground"),
        (between, "between shafts"),
        (on_pins, "on pins of planets"),
    )
    return [", ".join(f"{count} {where}" for count, where in counts if count)]


def _is_worth_a_line(location: Document) -> bool:
    """Whether the summary has a line on a rotor's location: for rows in an arrangement, or thrust held one way only."""
    return bool(location["rows"]) or bool(location["thrust_plus_z"]) != bool(location["thrust_minus_z"])


def _listed_pairs(document: Document) -> Iterator[Document]:
    """Yield the gear pairs, those that are alike by the symmetry of a set as one with the names of all.

    These are between like members of one set and read alike but for their names.
    """
    kinds: dict[tuple[str, str], tuple[str, str]] = {}
    for one in document.get("planetary", ()):
        for mesh in one["meshes"]:
            kinds.setdefault((mesh["driver"], mesh["driven"]), (one["name"], mesh["kind"]))
    alike: dict[object, list[Document]] = {}
    for number, pair in enumerate(document.get("gear_pairs", ())):
        kind = kinds.get((pair["driver"], pair["driven"]))
        words = () if kind is None else tuple(_pair_lines(_named_pair(pair, ("", "")), on_bearings=True))
        alike.setdefault((kind, words) if kind is not None else number, []).append(pair)
    for pairs in alike.values():
        drivers, drivens = (", ".join(dict.fromkeys(pair[end] for pair in pairs)) for end in ("driver", "driven"))
        yield _named_pair(pairs[0], (drivers, drivens))


def _named_pair(pair: Document, names: tuple[str, str]) -> Document:
    """Return a gear pair with other names of driver and driven gear."""
    gears = [{**gear, "name": name} for gear, name in zip(pair["geometry"]["gears"], names, strict=True)]
    driver, driven = names
    return {**pair, "driver": driver, "driven": driven, "geometry": {**pair["geometry"], "gears": gears}}


def _pair_summary(pair: Document) -> str:
    teeth = " : ".join(str(gear["teeth"]) for gear in pair["geometry"]["gears"])
    line = f"{pair['driver']} → {pair['driven']}: {teeth} teeth, contact ratio {pair['total_contact_ratio']:.3f}"
    if pair["mesh_frequency_hz"] is not None:
        line += f", mesh frequency {pair['mesh_frequency_hz']:.2f} Hz, mean force {pair['mean_force_n']:.1f} N"
        line += share_words(pair.get("mean_force_from"))
    return line


def _parts(document: Document) -> Iterator[tuple[str, list[str]]]:
    on_bearings = bool(document.get("bearings"))
    parts = {
        "imported": imported_lines(document["imported"]) if "imported" in document else [],
        "housing": _housing_lines(document["housing"]) if "housing" in document else reduced_lines(document),
        "rotors": [_rotor_line(rotor) for rotor in document.get("rotors", ())],
        "bearings": [line for bearing in document.get("bearings", ()) for line in _bearing_lines(bearing)],
        "thrust": [_location_line(location) for location in document.get("axial_location", ())],
        "analysis": [line for analysis in document.get("rotor_analysis", ()) for line in _analysis_lines(analysis)],
        "gear pairs": [line for pair in _listed_pairs(document) for line in _pair_lines(pair, on_bearings)],
        "planetary": [line for one in document.get("planetary", ()) for line in set_lines(one)],
        "gear bodies": gear_body_lines(document),
        "damping": damping_lines(document.get("damping", ())),
        "operation": list(_operation_lines(document["operation"])) if "operation" in document else [],
        "transient": [_transient_line(document)] if "transient" in document else [],
        "sweep": [counted(document["sweep"]["speeds"], "speed")] if "sweep" in document else [],
        "vary": _study_lines(document, "variation", "gearboxes", "samples", ("keys", "limits")),
        "optimise": _study_lines(
            document, "optimisation", "designs at most", "evaluations", ("keys", "aims", "limits")
        ),
        "detect": [
            f"{study['fault']}: {', '.join(map(str, study['severities']))}"
            for study in (document.get("detection"),)
            if study
        ],
        "measured": list(_measured_lines(document["measured"])) if "measured" in document else [],
        "standing": [f"{key}: {text}" for key, text in document.get("provenance", {}).items()],
    }
    return ((part, lines) for part, lines in parts.items() if lines)


def _study_lines(document: Document, table: str, what: str, count: str, lists: Sequence[str]) -> list[str]:
    """Return the number of gearboxes of a study, and its keys and the quantities that are limited by name."""
    if (study := document.get(table)) is None:
        return []
    return [f"{study[count]} {what}", *(f"{kind}: {', '.join(study[kind])}" for kind in lists if study[kind])]


def _operation_lines(operation: Document) -> Iterator[str]:
    yield f"{operation['speed_rpm']:.6g} rpm, {operation['torque_n_m']:.6g} N·m"
    for torque in operation["torques"]:
        place = "" if torque["at_m"] is None else f" at {1e3 * torque['at_m']:.4g} mm"
        yield f"torque on {torque['rotor']}{place}: {torque['torque_n_m']:+.6g} N·m about z"
    for key in ("motor", "load"):
        if key in operation:
            points = zip(operation[key]["speed_rpm"], operation[key]["torque_n_m"], strict=True)
            yield f"{key}: " + ", ".join(f"{torque:.6g} N·m at {speed:.6g} rpm" for speed, torque in points)
    if "gravity_m_per_s2" in operation:
        yield "gravity: " + ", ".join(f"{part:g}" for part in operation["gravity_m_per_s2"]) + " m/s²"
    if "base" in operation:
        base = operation["base"]
        moves = [f"{frequency:.6g} Hz" for frequency in base["harmonics_hz"]]
        yield "base moves: " + ", ".join(moves + ["a table over time"] * base["over_time"])


_PAIRED_BY = {
    "shapes": "shapes",
    "nearest": "nearest frequencies in order",
    "order": "order of frequency",
    "dominance": "dominance",
}


def _measured_lines(measured: Document) -> list[str]:
    """Return lines on the measured modes; for a file also on the content that was read."""
    lines = []
    if "frequencies_hz" in measured:
        listed = ", ".join(f"{frequency:.6g}" for frequency in measured["frequencies_hz"])
        lines.append(f"{listed} Hz; paired with the model's by {_PAIRED_BY[measured['pairing']]}")
    if "points" in measured:
        kind = "" if "frequencies_hz" not in measured else f"; {'complex' if measured['complex'] else 'real'} shapes"
        size = " x ".join(f"{1e3 * side:.4g}" for side in measured["extent_m"])
        points = f"{counted(measured['points'], 'point')} over {size} mm"
        lines.append(f"{points}, {counted(measured['degrees_of_freedom'], 'measured direction')}{kind}")
    if "responses" in measured:
        responses = measured["responses"]
        lines.append(
            f"responses in {responses['of']} to {counted(responses['references'], 'force')}, "
            f"{responses['lines']} lines from {responses['from_hz']:.6g} to {responses['to_hz']:.6g} Hz"
        )
    return lines


def _carrier_turns(document: Document, recorded: float) -> Iterator[str]:
    """Yield the turns of each carrier in a record, and after how many revolutions they are whole."""
    for one in document.get("planetary", ()):
        speeds = {member["role"]: abs(member["speed_rpm"]) for member in one["members"]}
        if speeds.get("carrier") and (lead := abs(document["operation"]["speed_rpm"])):
            ratio = speeds["carrier"] / lead
            whole = Fraction(ratio).limit_denominator(_MOST_TURNS).denominator
            yield f", {recorded * ratio:.5g} turns of {one['carrier']}, whole ones in multiples of {whole} revolutions"


def _transient_line(document: Document) -> str:
    transient = document["transient"]
    tolerance = f"tolerance {transient['tolerance']:g}"
    if "run" not in transient:
        recorded = transient["recorded_revolutions"]
        turns = "".join(_carrier_turns(document, recorded))
        return f"{transient['revolutions']:g} revolutions, the last {recorded:g} recorded{turns}; {tolerance}"
    run = transient["run"]
    speeds = " → ".join(f"{speed:.6g}" for speed in dict.fromkeys(run["speeds_rpm"]))
    line = f"free from {speeds} rpm" if run["free"] else f"{speeds} rpm"
    discarded = transient["discarded_revolutions"]
    first = f", the first {discarded:g} revolutions not recorded" if discarded else ""
    return f"{line} in {run['seconds']:g} s{first}; {tolerance}"


def _housing_lines(housing: Document) -> list[str]:
    shape = {"box": "box", "cad": "CAD file", "mesh": "mesh"}[housing["geometry"]]
    if "size_m" in housing:
        shape += f" of {' x '.join(f'{1e3 * length:.6g}' for length in housing['size_m'])} mm"
    if "mesh_size_m" in housing:
        shape += f", elements of {1e3 * housing['mesh_size_m']:g} mm"
    if "accuracy" in housing:
        shape += f", elements as small as modes within {100 * housing['accuracy']:g} % need"
    if "mesh" in housing:
        shape += f", {housing['mesh']['nodes']} nodes, {kinds_of_elements(housing['kinds'])}"
    limit, count = housing["frequency_limit_hz"], housing["modes"]
    modes = f"all modes below {limit:g} Hz" if limit else f"the lowest {counted(count, 'mode')}"
    lines = [f"{shape}, {housing['material']}; {modes}"]
    lines += [f"{kind}: {', '.join(housing[kind])}" for kind in ("regions", "seats", "supports") if housing[kind]]
    for kind in ("mounts", "joints"):
        lines += [_bushing_line(kind[:-1], bushing) for bushing in housing[kind]]
    if housing.get("cover_bolts"):
        first, *others = housing["cover_bolts"]
        lines.append(_bushing_line("cover", first) + (f"; so {counted(len(others), 'more bolt')}" if others else ""))
    lines += [bore_line(bore) for bore in housing.get("bores", ())]
    if housing["masses"]:
        lines.append("masses: " + ", ".join(f"{mass['name']} {mass['mass_kg']:g} kg" for mass in housing["masses"]))
    return lines + ([f"sensors: {', '.join(housing['sensors'])}"] if housing["sensors"] else [])


def reduced_lines(document: Document) -> list[str]:
    """Return the lines of a housing of reduced matrices; none without one."""
    housing = document.get("reduced_housing")
    if housing is None:
        return []
    size = f"{counted(housing['coordinates'], 'coordinate')}, {counted(len(housing['nodes']), 'interface node')}"
    lines = [f"reduced matrices of {size}; modes below {housing['frequency_limit_hz']:g} Hz"]
    if (proved := housing.get("certificate")) is not None:
        free = f"{proved['free_rigid_motions']} of 6 rigid motions free without the supports"
        massless = f", {proved['massless_coordinates']} without mass" if proved["massless_coordinates"] else ""
        lines.append(f"proved: symmetric, no negative eigenvalue, {free}{massless}; {proved['mass_kg']:.6g} kg")
        if (held := proved.get("held_frequency_hz")) is not None:
            lines.append(f"modes with the nodes held: up to {held:.5g} Hz")
        if (difference := proved.get("static_difference")) is not None:
            lines.append(f"static stiffness of the interface: within {100.0 * difference:.2g} % of the one given")
    frequencies = housing["frequencies_hz"]
    shown = ", ".join(f"{frequency:.2f}" for frequency in frequencies[:_REDUCED_FREQUENCIES])
    more = f" and {len(frequencies) - _REDUCED_FREQUENCIES} more" if len(frequencies) > _REDUCED_FREQUENCIES else ""
    lines.append(f"natural frequencies: {shown} Hz{more}" if frequencies else "no natural frequency below the limit")
    return lines + [f"{kind}: {', '.join(housing[kind])}" for kind in ("seats", "supports", "sensors") if housing[kind]]


_REDUCED_FREQUENCIES = 12  # natural frequencies of a reduced housing that are shown


def _bushing_line(kind: str, bushing: Document) -> str:
    between = f" ({' to '.join(bushing['surfaces'])})" if "surfaces" in bushing else ""
    if "diameter_m" in bushing:
        place = ", ".join(f"{1e3 * value:.6g}" for value in bushing["center_m"])
        between = f" (circles of {1e3 * bushing['diameter_m']:.6g} mm at {place} mm)"
    parts = [
        f"{motion} {amount:.4g} {unit}"
        for key, unit in (
            ("stiffness_n_per_m", "N/m"),
            ("stiffness_n_m_per_rad", "N·m/rad"),
            ("damping_n_s_per_m", "N·s/m"),
            ("damping_n_m_s_per_rad", "N·m·s/rad"),
        )
        for motion, amount in bushing.get(key, {}).items()
    ]
    return f"{kind} {bushing['name']}{between}: {', '.join(parts)}"


def _rotor_line(rotor: Document) -> str:
    speed = "" if rotor["speed_rpm"] is None else f", {rotor['speed_rpm']:+z.6g} rpm"
    length = f"{1e3 * rotor['length_m']:g} mm"
    parts = f" with {counted(rotor['couplings'], 'coupling')}" if rotor["couplings"] else ""
    return f"{rotor['name']}: {length}{parts}, {rotor['mass_kg']:.4g} kg, {rotor['mass_model']}{speed}"


def _bearing_lines(bearing: Document) -> Iterator[str]:
    line = f"{bearing['name']}: {bearing['rotor']} on {bearing['seat']}"
    if bearing["pedestal_kg"] is not None:
        line += f", by a pedestal of {bearing['pedestal_kg']:g} kg"
    if bearing["table_rpm"] is not None:
        line += ", tables over {:.6g} to {:.6g} rpm".format(*bearing["table_rpm"])
    yield line
    if "rolling" in bearing:
        yield f"  {_rolling_words(bearing['rolling'])}"


def _rolling_words(rolling: Document) -> str:
    """Return the inside of a rolling bearing, its clearance and ratings."""
    estimated = "estimated inside: " if rolling["estimated"] else ""
    elements = " + ".join(map(str, rolling["elements"]))
    angle = math.degrees(rolling["contact_angle_rad"])
    source = "given" if rolling["dynamic_rating_from"] == "case" else "ISO 281"
    return (
        f"{estimated}{elements} elements of {1e3 * rolling['element_diameter_m']:.4g} mm "
        f"on {1e3 * rolling['pitch_diameter_m']:.4g} mm{f' at {angle:.3g}°' if angle else ''}, "
        f"clearance {1e6 * rolling['clearance_m']:.3g} µm; C {1e-3 * rolling['dynamic_rating_n']:.4g} kN ({source}), "
        f"C₀ {1e-3 * rolling['static_rating_n']:.4g} kN (ISO 76, of this inside)"
    )


def _location_line(location: Document) -> str:
    """Return a rotor's arrangement of bearings, and which of them takes its thrust in which sense."""
    plus, minus = (
        [
            f"{name} ({arrangement}, {ARRANGEMENTS[arrangement]})"
            if (arrangement := location["rows"].get(name))
            else name
            for name in location[key]
        ]
        for key in ("thrust_plus_z", "thrust_minus_z")
    )
    line = f"{location['rotor']}: "
    if not plus and not minus:
        return f"{line}no bearing holds it along its axis"
    if plus == minus:
        return f"{line}thrust both ways on {', '.join(plus)}"
    if arrangement := location["arrangement"]:
        line += f"{arrangement} arrangement, {ARRANGEMENTS[arrangement]}; "
    sides = [f"{way} on {', '.join(names)}" for way, names in (("+z", plus), ("-z", minus)) if names]
    missing = "" if plus and minus else f"; nothing holds it towards {'-z' if plus else '+z'}"
    return f"{line}thrust towards {', towards '.join(sides)}{missing}"


def _analysis_lines(analysis: Document) -> Iterator[str]:
    for key, analysis_name in (("campbell_rpm", "Campbell diagram"), ("response_rpm", "response to unbalance and bow")):
        if analysis[key] is not None:
            low, high, count = analysis[key]
            low, high = low + 0.0, high + 0.0  # of a shaft that turns the other way, no -0
            yield f"{analysis['rotor']}: {analysis_name} at {counted(count, 'speed')}, {low:.6g} to {high:.6g} rpm"
    if analysis["torques"]:
        yield f"{analysis['rotor']}: torsional response to {counted(analysis['torques'], 'torque')}"


def _pair_lines(pair: Document, on_bearings: bool) -> list[str]:
    lines = [
        f"{pair['driver']} → {pair['driven']}: ratio {pair['ratio']:.6g}, {_contact_ratios(pair)}, "
        f"stiffness {pair['stiffness_model']}",
        f"shafts {1e3 * pair['centre_distance_m']:.6g} mm apart, working pressure angle "
        f"{pair['working_pressure_angle_deg']:.4g}°",
    ]
    # Where there is any that could be measured.
    if abs(pair["backlash_m"]["circumferential"]) >= 1e-9:
        lines.append(f"backlash {backlash_words(pair['backlash_m'])}")
    lines += [_tooth_line(gear) for gear in pair["geometry"]["gears"]]
    if pair["mesh_frequency_hz"] is not None:
        lines.append(f"mesh frequency {pair['mesh_frequency_hz']:.2f} Hz, mean mesh force {pair['mean_force_n']:.1f} N")
        lines[-1] += share_words(pair.get("mean_force_from"))
    origin = pair.get("misalignment_from", "default")
    if origin != "default" or (pair["mean_force_n"] and on_bearings):
        words = misalignment_words(pair.get("misalignment_rad"), origin, None)
        lines.append(words + ("" if origin == "case" else "; `gearwhine load` finds it"))
    return lines


def _contact_ratios(pair: Document) -> str:
    """Return the contact ratio; of helical gears with the overlap."""
    text = f"contact ratio {pair['contact_ratio']:.5f}"
    if pair["overlap_ratio"] == 0.0:
        return text
    return f"{text} + overlap {pair['overlap_ratio']:.5f} = {pair['total_contact_ratio']:.5f}"


def _tooth_line(gear: Document) -> str:
    """Return a gear's circles, and the span over its teeth."""
    angle = math.degrees(gear["helix_angle_rad"])
    helix = f", helix {abs(angle):.6g}° {'right' if angle > 0.0 else 'left'}" if angle else ""
    circles = ", ".join(f"{name} {1e3 * gear['diameters_m'][name]:.6g}" for name in ("tip", "form", "root"))
    span = gear["span"]
    measured = "" if span is None else f"; span of {span['teeth']}: {1e3 * span['length_m']:.6g} mm"
    cut = " (undercut)" if gear["undercut"] else ""
    outside = gear["diameters_m"].get("rim_outside")
    rim = "" if outside is None else f"; outside of the rim {1e3 * outside:.6g}"
    return f"{gear['name']}: {gear['teeth']} teeth{helix}, diameters {circles} mm{rim}{cut}{measured}"
