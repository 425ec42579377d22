"""Steady state: quantities of periodic motions and of their branch over speed, and how they are shown."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from gearwhine.coupling.signals.line_names import line_names
from gearwhine.output.quantity import ABSENT, RPM, Part, Quantity, Rows, add_warnings, document_of, in_file
from gearwhine.output.sections import (
    Column,
    Document,
    Picture,
    Section,
    Table,
    columns_of,
    counted,
    percent,
    rms_of_band,
    table_of,
)
from gearwhine.output.store import Option, kept_sentence
from gearwhine.results.motion import (
    BEARING,
    CAUSE_COLUMNS,
    MESH,
    MeshFigures,
    NamedParts,
    closing,
    damping_sentence,
    leading_lines,
    line_table,
    mesh_sentence,
    sensor_columns,
)
from gearwhine.results.operating_point import brief

if TYPE_CHECKING:
    from gearwhine.coupling.analyses.steady_state import SolvedSteady, SteadyMotion
    from gearwhine.coupling.assembly import CoupledMachine
    from gearwhine.coupling.machine.mounted_parts import GearMesh
    from gearwhine.coupling.periodic.continuation import ResponseCurve
    from gearwhine.coupling.periodic.response import PeriodicResponse
    from gearwhine.coupling.periodic.superposition import SuperposedResponse

_TILTS = ("about x", "about y")
_EXACT_LINE_DISTANCE = 1e-6  # rounding of the frequency of a line of a periodic motion, over the spacing of lines
_LINES_SHOWN = 3  # highest lines of each sensor on the terminal, with what excites them

PROOF = (
    Quantity("period_s"),
    Quantity("stable"),
    Quantity("stability", "floquet.stability"),
    Quantity("largest_multiplier", "floquet.largest"),
    Quantity("largest_multiplier_error", "floquet.largest_error", optional=True),
    Quantity("instability", "floquet.leaving"),
    Quantity("residual"),
    Quantity("error"),
    Quantity("elements"),
    Quantity("switches", optional=True),
    Quantity("newton_steps"),
)
"""Quantities of a periodic response: its period, stability and accuracy."""


class _Pair(NamedTuple):
    """Figures of a gear mesh, the lines of its force, and the figures where they are of superposed motions."""

    flanks: MeshFigures
    lines: list[dict[str, Any]]
    superposed: "SuperposedResponse | None"

    @property
    def mean_compression(self) -> float:
        """Mean compression of the mesh [m]."""
        return float(self._compressed.mean_compression[self.flanks.contact])

    @property
    def rms_compression(self) -> float:
        """Root mean square of the compression of the mesh about its mean [m]."""
        return float(self._compressed.rms_compression[self.flanks.contact])

    @property
    def neglected_force(self) -> float | None:
        """Part of the force that superposition leaves out, root mean square [N]."""
        return None if self.superposed is None else float(self.superposed.neglected_force[self.flanks.contact])

    @property
    def neglected_part(self) -> float | None:
        """That force as a part of the varying force."""
        return None if self.superposed is None else float(self.superposed.neglected_part[self.flanks.contact])

    @property
    def _compressed(self) -> "PeriodicResponse | SuperposedResponse":
        return cast("PeriodicResponse | SuperposedResponse", self.flanks.figures)


PAIR = (
    Part("", "flanks", MESH),
    Quantity("mean_compression_m"),
    Quantity("rms_compression_m", heading="a.c. compression [µm rms]", shown=".3g"),
    Quantity("neglected_force_n", optional=True),
    Quantity("neglected_part", optional=True),
    Quantity("force_lines", "lines"),
)
"""Quantities of a gear mesh."""


def _pairs(
    solved: "SolvedSteady", motions: "tuple[SteadyMotion, ...]", figures: "PeriodicResponse | SuperposedResponse"
) -> list[_Pair]:
    """Gear meshes of one motion with its response, or of all motions with what is superposed of them."""
    superposed = solved.superposed if figures is solved.superposed else None
    rows = []
    for number, mesh in zip(solved.machine.loaded_contacts, solved.machine.meshes, strict=True):
        name = solved.machine.system.contacts[number].name
        forces = [motion.histories.mesh_force[name] for motion in motions]
        lines = _lines(solved.machine, motions, forces, "amplitude_n")
        rows.append(_Pair(MeshFigures(mesh, figures, number), lines, superposed))
    return rows


def _sensors(solved: "SolvedSteady", motion: "SteadyMotion | None") -> list[dict[str, Any]]:
    """Sensors of one motion, or of all that are superposed."""
    motions = solved.motions if motion is None else (motion,)
    return [
        {
            "name": name,
            "rms_m_per_s2": solved.rms_of_sum(name) if motion is None else motion.sensor_rms[name],
            "lines": _lines(
                solved.machine,
                motions,
                [motion.histories.sensor_acceleration[name] for motion in motions],
                "amplitude_m_per_s2",
                motions[0].trusted_limit,
            ),
        }
        | (_neglected(solved, name) if motion is None and name in solved.neglected_acceleration else {})
        for name in motions[0].histories.sensor_acceleration
    ]


def _neglected(solved: "SolvedSteady", sensor: str) -> dict[str, Any]:
    """Acceleration of a sensor by what the sum of motions leaves out: rms, and highest lines over a common period."""
    from gearwhine.coupling.analyses.steady_state import highest_lines

    spectrum = solved.neglected_acceleration[sensor]
    told: dict[str, Any] = {"neglected_rms_m_per_s2": float(spectrum.rms(np.inf))}
    if solved.neglected_settles:
        highest = highest_lines(spectrum)
        tolerance = _EXACT_LINE_DISTANCE * float(spectrum.frequencies[0])
        names = line_names(solved.machine, [line[0] for line in highest], tolerance)
        told["neglected_lines"] = [
            {"frequency_hz": frequency, "amplitude_m_per_s2": amplitude, "name": name.name, "order": name.order}
            for (frequency, amplitude, _), name in zip(highest, names, strict=True)
        ]
    return told


def _lines(
    machine: "CoupledMachine", motions: "tuple[SteadyMotion, ...]", signals: list[Any], key: str, limit: float = np.inf
) -> list[dict[str, Any]]:
    """Return the highest lines of all motions together up to a limit [Hz], each with its name and its excitations."""
    from gearwhine.coupling.analyses.steady_state import REPORTED_LINES, highest_lines, spectra_of_sum

    found = sorted(
        (
            (frequency, amplitude, phase, motion)
            for motion, spectrum in zip(motions, spectra_of_sum(motions, signals), strict=True)
            for frequency, amplitude, phase in highest_lines(spectrum, limit)
        ),
        key=lambda line: -line[1],
    )[:REPORTED_LINES]
    if not found:
        return []
    within = np.array([_EXACT_LINE_DISTANCE / motion.response.period for *_, motion in found])
    names = line_names(machine, [frequency for frequency, *_ in found], within)
    return [
        {"frequency_hz": frequency, key: amplitude, "phase_rad": phase, "name": name.name, "order": name.order}
        | ({"excitation": motion.excitation} if motion.excitation else {})
        for (frequency, amplitude, phase, motion), name in zip(found, names, strict=True)
    ]


class _Motion(NamedTuple):
    """Steady state, one of its periodic motions, and the motion's number from 1."""

    steady: "SolvedSteady"
    motion: "SteadyMotion"
    number: int


def _multipliers(row: _Motion) -> Any:
    values = row.motion.response.floquet.values
    return np.stack([values.real, values.imag], axis=-1)


def _signals(of: Any, name: str, dimension: str, unit: str, long_name: str) -> Quantity:
    """One period of the signals of a motion."""
    return in_file(name, (dimension, "period_time"), lambda row: of(row.motion.histories) or None, long_name, unit)


def _bearing_load(kind: str, rows: slice, along: str, labels: Sequence[str], unit: str, long_name: str) -> Part:
    """Declare one period of the loads on all bearings: forces along x, y, z or moments about x, y, with labels."""
    return Part(
        "",
        ".",
        (
            in_file(along, (along,), lambda row: list(labels), common=True),
            in_file(
                f"steady_bearing_{kind}",
                ("bearing", along, "period_time"),
                lambda row: {name: load[:, rows].T for name, load in row.motion.histories.bearing_load.items()} or None,
                long_name,
                unit,
            ),
        ),
    )


MOTION = (
    in_file("steady_motion", "", "number", "motion at operation", "1"),
    in_file("period_time", "period_time", "motion.histories.times", "time in the period", "s", common=True),
    in_file("steady_stable", "", "motion.response.stable"),
    in_file("part", "part", lambda row: ["real", "imaginary"], common=True),
    in_file(
        "floquet_multiplier",
        "multiplier part",
        _multipliers,
        "Floquet multiplier: growth of a disturbance in a period",
        "1",
    ),
    _signals(
        lambda histories: histories.mesh_force,
        "steady_mesh_force",
        "contact",
        "N",
        "gear-mesh force along the line of action",
    ),
    _signals(
        lambda histories: histories.sensor_acceleration,
        "steady_sensor_acceleration",
        "sensor",
        "m/s2",
        "acceleration along the sensor",
    ),
    _bearing_load("force", slice(0, 3), "direction", "xyz", "N", "force of the shaft on its bearing"),
    _bearing_load("moment", slice(3, 5), "rotation", _TILTS, "N m", "moment of the shaft on its bearing"),
    Part("", "motion.response", PROOF),
    Rows("gear_pairs", lambda row: _pairs(row.steady, (row.motion,), row.motion.response), PAIR),
    Rows("bearings", lambda row: [NamedParts(*each) for each in row.steady.bearing_parts(row.motion)], BEARING),
    Quantity("sensors", lambda row: _sensors(row.steady, row.motion)),
)
"""Quantities of a periodic motion."""


class _Excitation(NamedTuple):
    """Motion of one group of excitations, and its number of samples."""

    motion: "SteadyMotion"
    samples: int


def _resampled(of: Any, name: str, dimension: str, unit: str, quantity: str) -> Quantity:
    """Declare one period of the signals of a motion, resampled to the most samples of any motion."""

    def values(row: _Excitation) -> dict[str, Any] | None:
        motion, samples = row
        return {label: motion.resampled(signal, samples) for label, signal in of(motion.histories).items()} or None

    whole = f"{quantity} in the motion of each group of excitations"
    return in_file(f"excitation_{name}", (dimension, "period_part"), values, whole, unit)


EXCITATION = (
    Quantity("name", "motion.excitation", "excitation"),
    Quantity(
        "weight",
        "motion.group.weight",
        "excitation_weight",
        (),
        "1",
        "number of times that the motion counts in the sum",
    ),
    in_file("excitation_period", "", "motion.response.period", "period of the motion", "s"),
    in_file("excitation_stable", "", "motion.response.stable"),
    in_file(
        "period_part",
        "period_part",
        lambda row: np.arange(row.samples) / row.samples,
        "time as a part of the motion's period",
        "1",
        common=True,
    ),
    _resampled(
        lambda histories: histories.mesh_force, "mesh_force", "contact", "N", "gear-mesh force along the line of action"
    ),
    _resampled(
        lambda histories: histories.sensor_acceleration,
        "sensor_acceleration",
        "sensor",
        "m/s2",
        "acceleration along the sensor",
    ),
    Part("", "motion.response", PROOF),
)
"""Quantities of the motion of one group of excitations.

The sum of these motions has no period.
"""


def _excitations(solved: "SolvedSteady") -> list[_Excitation]:
    samples = max(len(motion.histories.times) for motion in solved.motions)
    return [_Excitation(motion, samples) for motion in solved.motions]


SUPERPOSED = (
    Quantity("hunting_mesh_cycles", optional=True),
    Quantity("stable", "superposed.stable"),
    Rows("excitations", _excitations, EXCITATION, "excitation"),
    Rows("gear_pairs", lambda solved: _pairs(solved, solved.motions, solved.superposed), PAIR),
    Rows("bearings", lambda solved: [NamedParts(*each) for each in solved.bearing_parts()], BEARING),
    Quantity("sensors", lambda solved: _sensors(solved, None)),
)
"""Quantities of superposed motions: figures by the contact law at their sum, and the lines of all groups."""

_POINT = ("branch_point",)


def _of_contacts(name: str, of: Any, unit: str, long_name: str) -> Quantity:
    return in_file(
        f"branch_{name}",
        (*_POINT, "contact"),
        lambda solved: of(solved.curve) if solved.machine.system.contacts else None,
        long_name,
        unit,
    )


def _sensor_rms(solved: "SolvedSteady") -> Any:
    names = list(solved.motions[0].histories.sensor_acceleration)
    return np.stack([solved.branch_rms[name] for name in names], axis=-1) if names else None


EVENT = (
    Quantity("speed_rpm", heading="speed [rpm]", shown=".1f"),
    Quantity("kind", heading="what happens"),
)
LOUDEST = (
    Quantity("sensor", heading="sensor"),
    Quantity("speed_rpm", heading="loudest at [rpm]", shown=".0f"),
    Quantity("rms_m_per_s2", heading="rms [m/s²]", shown=".3g"),
    Quantity("frequency_hz", lambda point: point.frequency, heading="highest line [Hz]", shown=".1f"),
    Quantity("amplitude_m_per_s2", heading="[m/s², peak]", shown=".3g"),
    Quantity("excitation", heading="excitation"),
    Quantity(
        "housing_mode",
        "mode",
        heading="most of it by",
        shown=lambda row: f"mode {row['housing_mode']}, {row['mode_hz']:.1f} Hz ({percent(row['share'])})",
        numbers=("mode_hz", "share"),
    ),
    Quantity("mode_hz", "mode_hz"),
    Quantity("share"),
)
"""Quantities of the point of a branch at which a sensor is loudest."""


class _Branch(NamedTuple):
    """Gear mesh, the branch over speed, and the number of the loaded contact."""

    mesh: "GearMesh"
    curve: "ResponseCurve"
    contact: int


CURVE = (
    Quantity(
        "speed_rpm",
        "curve.speeds",
        "branch_speed",
        _POINT,
        long_name="speed of the first driver",
        attributes=lambda solved: {
            "ending": solved.curve.ending,
            "account": solved.curve.description(1.0 / RPM, "rpm"),
        },
    ),
    Quantity("stable", "curve.stable", "branch_stable", _POINT, long_name="whether no small disturbance grows"),
    Quantity("stability", lambda solved: [motion.floquet.stability for motion in solved.curve.responses]),
    Quantity("ending", "curve.ending"),
    Quantity(
        "piece",
        "curve.piece_numbers",
        "branch_piece",
        _POINT,
        long_name="number of the piece, from 1: between two pieces nothing is followed",
    ),
    Quantity("gaps_rpm", lambda solved: [[end * RPM for end in gap] for gap in solved.curve.gaps]),
    Quantity("account", lambda solved: solved.curve.description(1.0 / RPM, "rpm")),
    in_file("contact", "contact", lambda solved: [contact.name for contact in solved.machine.system.contacts] or None),
    _of_contacts("compression", lambda curve: curve.rms_compression, "m", "a.c. rms of the compression of the mesh"),
    _of_contacts("peak_force", lambda curve: curve.peak_force, "N", "largest gear-mesh force"),
    _of_contacts("contact_loss", lambda curve: curve.contact_loss, "1", "part of the period that the flanks are apart"),
    in_file("branch_sensor_rms", (*_POINT, "sensor"), _sensor_rms, "rms of the sensor's acceleration", "m/s2"),
    Rows(
        "gear_pairs",
        lambda solved: [
            _Branch(mesh, solved.curve, number)
            for number, mesh in zip(solved.machine.loaded_contacts, solved.machine.meshes, strict=True)
        ],
        (
            Quantity("driver", "mesh.driver.name"),
            Quantity("driven", "mesh.driven.name"),
            Quantity("rms_compression_m", lambda row: row.curve.rms_compression[:, row.contact]),
            Quantity("peak_force_n", lambda row: row.curve.peak_force[:, row.contact]),
            Quantity("contact_loss_fraction", lambda row: row.curve.contact_loss[:, row.contact]),
        ),
    ),
    Quantity(
        "sensors", lambda solved: [{"name": name, "rms_m_per_s2": values} for name, values in solved.branch_rms.items()]
    ),
    Quantity("assumed_mesh_damping", lambda solved: list(solved.assumed_damping)),
    Rows("loudest", "loudest", LOUDEST),
    Rows("bifurcations", "curve.bifurcations", EVENT),
    in_file("branch_event", "branch_event", lambda solved: [event.kind for event in solved.curve.bifurcations]),
    in_file(
        "branch_event_speed",
        "branch_event",
        lambda solved: np.array([event.speed for event in solved.curve.bifurcations]) * RPM,
        "where the branch turns or its stability changes",
        "rpm",
    ),
)
"""Quantities of the branch over speed."""


def _method(solved: "SolvedSteady") -> str:
    """Return how the motion was found: by shooting ("periodic"), by settling, or as a superposed one."""
    if solved.superposed is not None:
        return "superposed"
    return "settled" if solved.motions[0].response.switches is None else "periodic"


STEADY = (
    Quantity("speed_rpm", "motions.0.speed"),
    Quantity("coordinates", "machine.system.size"),
    Quantity("trusted_below_hz", "machine.complete_below_hz"),
    Quantity("method", _method),
    Rows(
        "motions",
        lambda solved: (
            [_Motion(solved, motion, number) for number, motion in enumerate(solved.motions, start=1)]
            if solved.superposed is None
            else ABSENT
        ),
        MOTION,
        "steady_motion",
    ),
    Rows("motions", lambda solved: ABSENT if solved.superposed is None else [solved], SUPERPOSED, "motion"),
    Part("curve", lambda solved: ABSENT if solved.curve is None else solved, CURVE),
)
"""Quantities of the steady state at the speed of operation, and of its branch over speed."""


STEADY_OPTIONS = (Option(("curve",), ("branch_",), "steady-curve.png"),)
"""Options of the steady state."""

STEADY_SAME = ("speed_rpm", "coordinates", "load")
"""Keys of the steady state that no option changes: a branch may have several motions at the speed of operation."""


def steady_document(title: str, solved: "SolvedSteady") -> dict[str, Any]:
    """Return the steady state as the command's JSON, with warnings where it was not followed or superposition fails."""
    document = {"title": title} | document_of(STEADY, solved)
    add_warnings(document, [*solved.branch_warnings(), *solved.superposition_warnings()])
    return document


_EVENTS = {
    "fold": "the motion jumps to another one",
    "period doubling": "the motion is taken over by one of twice the period",
    "Neimark-Sacker": "a second frequency comes in",
}
# A multiplier beyond +1 alone is no proof of a fold: over many mesh periods it may be an even power of one beyond -1.
_UNSTABLE = {**_EVENTS, "fold": "disturbances grow without turning, the motion leaves for another one"}


def report(document: Document) -> Section:
    """Chapter of the report: as on the terminal, with the meshes, lines and events as tables."""
    tables: tuple[Table, ...] = ()
    for motion in document["motions"]:
        tables += table_of(columns_of((*MESH, *PAIR)), motion["gear_pairs"])
        tables += table_of(columns_of(BEARING), motion.get("bearings", ()), "Bearings")
        tables += line_table(motion["sensors"], "lines")
    tables += table_of(columns_of(EVENT), document.get("curve", {}).get("bifurcations", ()), "Over speed")
    return Section("Steady state", (*_content(document), *damping_sentence(document), *tables), pictures=_PICTURES)


_PICTURES = (
    Picture(
        "steady-motion",
        "Mesh force of the motion over a period or some teeth, zero where flanks part, and its harmonics. Superposed "
        "motions are drawn as their sum, with the lines of each.",
    ),
    Picture(
        "steady-curve",
        "Periodic motions over speed, dashed where disturbances grow: the machine jumps where a branch turns back.",
    ),
)


def sections(document: Document) -> tuple[Section, ...]:
    """Return the periodic motions, their stability, and the events of a branch."""
    return (Section("", tuple(_content(document))),)


def _content(document: Document) -> Iterator[str | Table]:
    if "load" in document:
        yield from brief(document["load"])
    motions = document["motions"]
    noun = "steady motion" if document.get("method") == "superposed" else "periodic motion"
    yield (
        f"{counted(len(motions), noun)} at {document['speed_rpm']:.0f} rpm; {document['coordinates']} modal coordinates"
    )
    for number, motion in enumerate(motions, start=1):
        yield from _motion(motion, f"Motion {number}: " if len(motions) > 1 else "", sensor_columns(document))
    if curve := document.get("curve"):
        yield from curve_sentences(curve, document.get("trusted_below_hz"))
    yield from kept_sentence(document, STEADY_OPTIONS, "case")


def _motion(motion: Document, name: str, columns: tuple[Column, ...]) -> Iterator[str | Table]:
    if "excitations" in motion:
        yield (
            "The excitations have no short common period: each has its own motion, other meshes linear about their "
            "mean load, and these are superposed"
        )
        if cycles := motion.get("hunting_mesh_cycles"):
            yield (
                f"The same teeth meet after {cycles} mesh cycles: the unequal teeth of each gear have a motion of "
                "their own, to the first order, and the mesh of teeth that are alike counts once"
            )
        for excitation in motion["excitations"]:
            yield _proof(excitation, f"  {excitation['name']}: ")
        for pair in motion["gear_pairs"]:
            yield (
                f"  left out in {pair['driver']} → {pair['driven']}: {pair['neglected_force_n']:.3g} N rms, "
                f"{percent(pair['neglected_part'])} of its varying force"
            )
        for sensor in motion["sensors"]:
            highest = [
                f", highest {line['amplitude_m_per_s2']:.3g} m/s² at {line['frequency_hz']:.1f} Hz ({line['name']})"
                for line in sensor.get("neglected_lines", ())[:1]
            ]
            rms = f"{sensor['neglected_rms_m_per_s2']:.3g} m/s² rms"
            yield f"  by that at {sensor['name']}, estimated: {rms}{''.join(highest)}"
    else:
        yield _proof(motion, name)
    yield from map(mesh_sentence, motion["gear_pairs"])
    yield from table_of(columns, motion["sensors"])
    yield from table_of(CAUSE_COLUMNS, leading_lines(motion["sensors"], "lines", _LINES_SHOWN))


def _proof(motion: Document, name: str) -> str:
    if motion["stable"]:
        stability = f"stable, {_decay(motion['largest_multiplier'], motion['period_s'])}"
    elif motion.get("stability") == "not decided":
        stability = "stability not decided"
    else:
        stability = f"unstable: {_UNSTABLE.get(motion['instability'] or '', 'disturbances grow')}"
    if (error := motion.get("largest_multiplier_error")) is not None:
        stability += f" (largest Floquet multiplier {motion['largest_multiplier']:.4g} ± {error:.1g})"
    return (
        f"{name}period {1e3 * motion['period_s']:.6g} ms, {stability}; closes {closing(motion['residual'])}, "
        f"{change_by_refining(motion)}"
    )


def change_by_refining(motion: Document) -> str:
    """Say by how much a motion changes with elements, or steps of one that settles, of half the length."""
    return f"changes by {motion['error']:.0e} with {'elements' if 'switches' in motion else 'steps'} half as long"


def _decay(multiplier: float, period: float) -> str:
    """Return the time in which the slowest disturbance falls to a tenth, by its Floquet multiplier."""
    if not 0.0 < multiplier < 1.0:
        return "disturbances fall at once" if multiplier <= 0.0 else "the slowest disturbance stays"
    periods = math.log(10.0) / -math.log(multiplier)
    return f"the slowest disturbance falls to a tenth in {periods * period:.3g} s"


def curve_sentences(curve: Document, limit: float | None = None) -> Iterator[str | Table]:
    """Yield sentences on a branch over speed: its range, largest forces, loudest points of sensors, bifurcations.

    The rms values of sensors are up to a limit [Hz].
    """
    speeds = curve["speed_rpm"]
    undecided = curve.get("stability", []).count("not decided")
    unstable = sum(not stable for stable in curve["stable"]) - undecided
    yield (
        f"Followed from {speeds[0]:.0f} to {speeds[-1]:.0f} rpm in {counted(len(speeds), 'point')}, "
        f"{unstable} of them unstable" + (f", {undecided} not decided" if undecided else "")
    )
    if curve["ending"] != "end":
        yield f"Left before the end of the range: {curve['account']}"
    for pair in curve["gear_pairs"]:
        highest = max(range(len(speeds)), key=pair["peak_force_n"].__getitem__)
        yield (
            f"Gear mesh {pair['driver']} → {pair['driven']}: largest force {pair['peak_force_n'][highest]:.0f} N at "
            f"{speeds[highest]:.0f} rpm"
        )
    if assumed := curve.get("assumed_mesh_damping"):
        yield (
            f"Mesh damping of {', '.join(assumed)} is the default, a ratio of 0.05, as the case gives none; the "
            "literature has 0.03 to 0.17, and folds and jumps come and go with it"
        )
    rms = f"{rms_of_band([limit])} [m/s²]"
    columns = (replace(one, heading=rms) if one.of == "rms_m_per_s2" else one for one in columns_of(LOUDEST))
    yield from table_of(tuple(columns), curve.get("loudest", ()))
    for event in curve["bifurcations"]:
        yield f"{event['speed_rpm']:9.1f} rpm: {event['kind']}; {_EVENTS.get(event['kind'], 'stability changes')}"
