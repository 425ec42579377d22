"""First page of the report: the machine, its proofs, the highest and the loudest lines, and measured modes."""

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from gearwhine.case import Bearing, Case, Operation
from gearwhine.output.quantity import RPM
from gearwhine.output.sections import (
    NOTHING,
    Column,
    Document,
    Finding,
    Picture,
    Section,
    Table,
    arrowed,
    counted,
    percent,
    table_of,
)
from gearwhine.results.bearing_lives import LONGEST_LIFE
from gearwhine.results.comparison import LINKED_PAIR
from gearwhine.results.line_columns import LINE_NAME
from gearwhine.results.motion import (
    MECHANISM,
    amplitude_words,
    band_words,
    closing,
    leading_lines,
    mechanism_words,
    path_place,
    shape_column,
)
from gearwhine.results.optimisation import summary as summary_of_optimisation
from gearwhine.results.run import SPECTRUM
from gearwhine.results.sound import LOUDEST_COLUMNS, loudest_lines, total_sentence
from gearwhine.results.steady_state import change_by_refining
from gearwhine.results.summaries import Summary
from gearwhine.results.variation import summary as summary_of_variation
from gearwhine.solve.case_summary import checked_pairs, checked_rotors

if TYPE_CHECKING:
    from gearwhine.coupling.machine.loads import Torque
    from gearwhine.solve.case_summary import CheckedPair, CheckedRotor

_MM = 1e3
_LINES = 3  # lines of each sensor
_OPPOSED = 0.1  # least share of a line against it that is named
_LOUDEST = 5  # lines of the sound
_MOST_ERROR = 1e-2  # largest error of the energy balance that passes
_LARGEST_ERROR = 0.03  # largest error of a line by the modal basis that passes
_LARGEST_RESIDUAL = 1e-6  # largest residual of the equilibrium that passes, as a part of the largest load
_SAME_POWER = 0.5  # difference of a line's sound power levels by two ways that passes [dB]
_LEAK = 0.1  # pressure inside the radiating surface over that on it that passes
_SOURCE_OFF = 10.0 ** (2.0 / 20.0) - 1.0  # error of a known source's pressure that passes: 2 dB
_SOURCE_LOST = 1.0  # the same, from which the check has failed
_PERIODIC = 1e-3  # part by which a periodic motion may miss itself, or change with finer elements

_CHAPTERS = {
    "Housing modes": ("geometry", "size", "load", "modes file"),
    "Gears": ("thin tip", "undercut", "backlash", "gear faces", "runout", "overload"),
    "Rotors": ("rotating damping", "ross"),
    "Coupled system": ("unstable mode",),
    "Motion": ("bearing load", "run signature"),
    "Steady state": ("superposition",),
    "Sound": (
        "interior_pressure",
        "known_source",
        "microphone_known_source",
        "microphone_interpolation",
        "sound_left_out",
    ),
    "Sweep": ("sound_of_sweep", "sound_left_out", "sweep_resolution"),
    "Updated numbers": ("shapes",),
    "Varied gearboxes": ("failed samples", "few samples", "loudest speed", "runout twice"),
    "Operating point": (
        "sensitivity",
        "static rating",
        "bearing tilt",
        "bearing life",
        "bearing stiffness",
        "uneven face",
        "part of the face",
        "misalignment",
        "free motion",
        "pictures",
    ),
}
"""Chapters that the warnings of each name belong to."""

_PICTURES = (
    SPECTRUM,
    Picture("sound-power", "Sound power level of each line, the loudest with names, and of third octaves."),
    Picture("steady-motion", "Mesh force of the motion over a period or some teeth, and its harmonics."),
    Picture("sweep-rms", "Level of each sensor over the sweep: peaks are resonances of the machine."),
    Picture("load-misalignment", "Misalignment of the flanks by its causes, which may cancel; black: their sum."),
    Picture("modes", "Modes side by side, each to a scale of its own; grey lines: at rest."),
    Picture(
        "transmissibility",
        "Response to 1 µm of transmission error alone at any frequency; load shuttling excites beside it.",
    ),
    Picture("comparison", "Frequencies of the model over measured ones, and their errors."),
    Picture("vary-distributions", "How the quantities scatter, with their limits and the gearbox without changes."),
)
"""Candidates for the picture of the first page, in order of preference: the first that exists is shown."""


def first_page(case: Case | None, documents: Sequence[Document], stale: Sequence[str]) -> tuple[Section, ...]:
    """Return the sections of the first page.

    Parameters
    ----------
    case : Case or None
        None leaves the machine out.
    documents : sequence of document
        Documents of all commands in the folder, the newest first.
    stale : sequence of str
        Sentences on results that do not fit the case any more.
    """
    summaries = [Summary(document) for document in documents]
    studies = {one.get("command"): one for one in documents}
    varied, optimised = studies.get("vary"), studies.get("optimise")
    sections = (
        Section("Optimised design in short", () if optimised is None else tuple(summary_of_optimisation(optimised))),
        Section("Varied gearboxes in short", () if varied is None else tuple(summary_of_variation(varied))),
        machine_section(case, documents),
        Section("Are the results sound?", _findings(summaries, stale)),
        Section("Highest lines", _lines(summaries)),
        Section("Loudest lines", _sound(summaries)),
        Section("", pictures=_PICTURES),
        Section("Measured and modelled", _compared(summaries)),
    )
    return tuple(section for section in sections if section.content or section.pictures)


def machine_section(case: Case | None, documents: Sequence[Document] = ()) -> Section:
    """Return the machine of a case in a paragraph and tables; ``documents`` know the size and mass of its housing."""
    if case is None:
        return Section("Machine")
    try:
        rotors, pairs = checked_rotors(case.parts), tuple(checked_pairs(case.parts))
    except (ValueError, RuntimeError) as error:
        return Section("Machine", (Finding(f"The machine of the case cannot be built: {error}", passed=False),))
    summaries = [Summary(document) for document in documents]
    content: list[str | Finding | Table] = [_paragraph(case, rotors, pairs, summaries)]
    if case.operation is not None and case.rotor:
        content.append(_operation(case.operation, case.parts.torques))
    content += _under_load(summaries)
    content += table_of(SHAFT_COLUMNS, [_shaft(rotor, case.bearing) for rotor in rotors], "Shafts")
    content += table_of(PAIR_COLUMNS, [_pair(pair) for pair in pairs], "Gear pairs")
    return Section("Machine", tuple(content))


def _paragraph(
    case: Case, rotors: Sequence["CheckedRotor"], pairs: Sequence["CheckedPair"], summaries: Sequence[Summary]
) -> str:
    """Return the components of the machine in a sentence or two."""
    parts = [
        counted(number, noun)
        for number, noun in ((len(rotors), "shaft"), (len(case.bearing), "bearing"), (len(pairs), "gear pair"))
        if number
    ]
    machine = ", ".join(parts[:-1]) + (" and " if len(parts) > 1 else "") + parts[-1] if parts else ""
    if (reduced := case.reduced_housing) is not None:
        on = f" on {counted(len(reduced.support), 'support')}" if reduced.support else ""
        sensors = f"; {counted(len(reduced.sensor), 'sensor')}" if reduced.sensor else ""
        inside = f"{machine} in a " if machine else "A "
        return f"{inside}housing of reduced matrices{on}{sensors}."
    if case.housing is None:
        return f"{machine}; no housing.".capitalize()
    solved = next((summary.housing for summary in summaries if summary.housing), {})
    kind = "box" if case.housing.box is not None else "housing from CAD" if case.housing.cad else "meshed housing"
    size = case.housing.box.size if case.housing.box is not None else solved.get("size_m")
    of_size = "" if size is None else f" of {' × '.join(f'{_MM * side:.4g}' for side in size)} mm"
    mass = f", {solved['mass_kg']:.4g} kg" if solved.get("mass_kg") else ""
    supports = len(case.housing.support) + len(case.housing.mount)
    on = f" on {counted(supports, 'support')}" if supports else ", free"
    sensors = f"; {counted(len(case.housing.sensor), 'sensor')}" if case.housing.sensor else ""
    inside = f"{machine} in a " if machine else "A "
    return f"{inside}{kind}{of_size}{mass}, of {case.housing.material}{on}{sensors}."


def _operation(operation: Operation, torques: Sequence["Torque"]) -> str:
    speed = f"{operation.speed * RPM:.5g} rpm of the first driver"
    if not torques or not operation.torque:
        return f"Operation: {speed}."
    # A torque drives in the sense of rotation, whichever that is; a negative one brakes.
    power = abs(operation.speed) * operation.torque
    applied = ", ".join(f"{torque.value:+.4g} N·m on {torque.rotor}" for torque in torques)
    return f"Operation: {speed}, {applied}; {power / 1e3:.4g} kW."


def _under_load(summaries: Sequence[Summary]) -> list[str]:
    """Return the largest face load factor, and the shortest bearing life of the newest operating point."""
    load = next((summary.load for summary in summaries if summary.load), {})
    clauses = []
    if pairs := [pair for pair in load.get("gear_pairs", ()) if pair.get("k_h_beta") is not None]:
        most_uneven = max(pairs, key=lambda pair: float(pair["k_h_beta"]))
        # A thousandth of a micrometre: less is rounding of an equilibrium.
        out_of_line = round(abs(most_uneven["misalignment_over_face_m"]) * 1e6, 3)
        clauses.append(
            f"K_Hβ {most_uneven['k_h_beta']:.3g} of {most_uneven['driver']} → {most_uneven['driven']}, whose flanks "
            f"stand {out_of_line:.3g} µm out of line over the face"
        )
    if bearings := [bearing for bearing in load.get("bearings", ()) if bearing.get("life_h")]:
        shortest = min(bearings, key=lambda bearing: float(bearing["life_h"]))
        life = min(float(format(shortest["life_h"], ".3g")), LONGEST_LIFE)
        hours = ("over " if shortest["life_h"] > LONGEST_LIFE else "") + f"{life:,.0f}".replace(",", " ")
        clauses.append(f"shortest bearing life L10 {hours} h, of {shortest['name']}")
    for one in load.get("planetary", ()):
        most = max(one["planets"], key=lambda planet: float(planet["load_share"]))
        clauses.append(
            f"mesh load factor K_γ {one['mesh_load_factor']:.4g} of planetary set {one['name']}, whose {most['name']} "
            f"carries {percent(most['load_share'])} of the torque"
        )
    return [f"Under load: {'; '.join(clauses)}."] if clauses else []


SHAFT_COLUMNS = (
    Column("shaft", "name"),
    Column("speed [rpm]", "speed_rpm", "z.5g"),
    Column("length [mm]", "length_mm", ".4g"),
    Column("mass [kg]", "mass_kg", ".4g"),
    Column("bearings", "bearings"),
    Column("gears", "gears"),
)
PAIR_COLUMNS = (
    Column("driver → driven", "name"),
    Column("teeth", "teeth"),
    Column("ratio", "ratio", ".4f"),
    Column("contact ratio", "contact_ratio", ".3f"),
    Column("mesh frequency [Hz]", "mesh_frequency_hz", ".2f"),
    Column("torque of the driver [N·m]", "torque_n_m", ".4g"),
    Column("force of the flanks [N]", "force_n", ".0f"),
)


def _shaft(rotor: "CheckedRotor", bearings: Iterable[Bearing]) -> Document:
    return {
        "name": rotor.built.name,
        "speed_rpm": None if rotor.speed is None else rotor.speed * RPM,
        "length_mm": _MM * rotor.built.length,
        "mass_kg": float(rotor.built.mass),
        "bearings": ", ".join(bearing.name for bearing in bearings if bearing.rotor == rotor.built.name),
    }


def _pair(pair: "CheckedPair") -> Document:
    geometry = pair.geometry
    return {
        "name": f"{geometry.driver.name} → {geometry.driven.name}",
        "teeth": f"{geometry.driver.teeth} : {geometry.driven.teeth}",
        "ratio": abs(float(geometry.ratio)),
        "contact_ratio": float(geometry.total_contact_ratio),
        "mesh_frequency_hz": pair.mesh_frequency,
        "torque_n_m": pair.torque,
        "force_n": pair.mean_force,
    }


def _findings(summaries: Sequence[Summary], stale: Sequence[str]) -> tuple[str | Finding, ...]:
    """Return the verdict in a sentence, and the findings that it counts."""
    findings = tuple(_distinct_findings(summaries, stale))
    passed, failed, warned = (sum(finding.passed is kind for finding in findings) for kind in (True, False, None))
    if not findings:
        return ()
    if not passed and not failed:
        return (f"No result here has a proof of its own; {counted(warned, 'warning')}.", *findings)
    verdict = f"{counted(passed, 'check')} passed" + (f", {failed} did not" if failed else ", none failed")
    return (f"{verdict}; {counted(warned, 'warning') if warned else 'no warnings'}.", *findings)


def _distinct_findings(summaries: Sequence[Summary], stale: Sequence[str]) -> Iterator[Finding]:
    """Yield the proofs of all results without repetition, then the stale results, then the warnings."""
    seen: set[str] = set()
    for summary in summaries:
        for finding in _proofs(summary):
            if finding.text not in seen:
                seen.add(finding.text)
                yield finding
    for sentence in stale:
        yield Finding(sentence, passed=False)
    for summary in summaries:
        for warning in summary.warnings:
            if (text := str(warning.get("message", warning))) not in seen:
                seen.add(text)
                yield Finding(_sentence(text), passed=None, link=(*_chapter(warning.get("name")), "section Warnings"))


def _chapter(name: object) -> tuple[str, ...]:
    return tuple(f"section {chapter}" for chapter, names in _CHAPTERS.items() if name in names)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}" + ("" if text.endswith((".", "!", "?")) else ".")


def _proofs(summary: Summary) -> Iterator[Finding]:
    if certificate := summary.housing.get("certificate"):
        yield Finding(
            f"Housing: {certificate['found']} modes found below {certificate['limit_hz']:.5g} Hz, "
            f"{certificate['expected']} counted by the matrix's inertia; residuals up to "
            f"{certificate['max_residual']:.0e}.",
            passed=bool(certificate["complete"]),
            link=("section Housing modes",),
        )
    if summary.rotors:
        missing = [rotor["name"] for rotor in summary.rotors if not rotor["certificate"]["complete"]]
        statement = (
            f"modes are missing of {', '.join(missing)}" if missing else "all bending modes below a limit are found"
        )
        yield Finding(f"Shafts at rest: {statement}.", passed=not missing, link=("section Rotors",))
    if certificate := summary.system.get("certificate"):
        found = certificate["found"] == certificate["expected"]
        defective = (
            f"; two modes are all but one, and miss their sum rule by {certificate['sum_rule']:.0e}"
            if found and not certificate["complete"]
            else ""
        )
        yield Finding(
            f"Coupled system: {certificate['found']} of {certificate['expected']} eigenvalues found, residuals up to "
            f"{certificate['max_residual']:.0e}{defective}.",
            passed=None if defective else found,
            link=("section Coupled system",),
        )
    if stability := summary.system.get("stability"):
        growing = len(stability["growing"])
        statement = "no mode grows" if stability["stable"] else f"{counted(growing, 'mode')} grow{'s' * (growing == 1)}"
        yield Finding(f"Stability: {statement}.", passed=bool(stability["stable"]), link=("section Coupled system",))
    if (residual := summary.load.get("residual")) is not None:
        yield Finding(
            f"Operating point: forces balance to {residual:.0e} of the largest load (bound: {_LARGEST_RESIDUAL:.0e}).",
            passed=residual < _LARGEST_RESIDUAL,
            link=("section Operating point",),
        )
    if (error := summary.energy_error) is not None:
        yield Finding(
            f"Motion: the energy balance closes {closing(error)} over {summary.steps} steps (bound: "
            f"{percent(_MOST_ERROR)}).",
            passed=error < _MOST_ERROR,
            link=("section Motion",),
        )
    yield from _point_proofs(summary)
    for motion in summary.motions:
        if (error := motion.get("error")) is not None and motion.get("residual") is not None:
            yield Finding(
                f"Steady state: the motion closes {closing(motion['residual'])} and {change_by_refining(motion)} "
                f"(bound: {_PERIODIC:.0e}); {_stability(motion)}.",
                passed=max(error, motion["residual"]) < _PERIODIC and bool(motion["stable"]),
                link=("section Steady state",),
            )
    yield from _sound_proofs(summary)
    yield from _basis(summary)


def _stability(motion: Document) -> str:
    """Return whether a periodic motion is stable, or that its largest multiplier leaves this open."""
    undecided = "stability not decided within the error of the largest Floquet multiplier"
    verdict = motion.get("stability", "stable" if motion["stable"] else "unstable")
    return undecided if verdict == "not decided" else str(verdict)


def _point_proofs(summary: Summary) -> Iterator[Finding]:
    """Yield the energy balance of a sweep's points and the balance of their forces, each at its worst point."""
    points = summary.points
    balances = [(point["energy_error"], point) for point in points if point.get("energy_error") is not None]
    if balances:
        largest, worst = max(balances, key=lambda balance: float(balance[0]))
        yield Finding(
            f"Sweep: the energy balance of {counted(len(balances), 'point')} closes to {largest:.0e} or better; worst "
            f"at {_settings(worst)}, over {worst['steps']} steps (bound: {percent(_MOST_ERROR)}).",
            passed=largest < _MOST_ERROR,
            link=("section Sweep",),
        )
    residuals = [(load["residual"], point) for point in points if (load := point.get("load", {})).get("residual")]
    if residuals:
        residual, worst = max(residuals, key=lambda balance: float(balance[0]))
        yield Finding(
            f"Sweep: at the operating points forces balance to {residual:.0e} of the largest load or better; worst at "
            f"{_settings(worst)} (bound: {_LARGEST_RESIDUAL:.0e}).",
            passed=residual < _LARGEST_RESIDUAL,
            link=("section Sweep",),
        )


def _settings(point: Document) -> str:
    return ", ".join(f"{key}={text}" for key, text in point["settings"].items())


def _sound_proofs(summary: Summary) -> Iterator[Finding]:
    """Yield the power balance, the pressure inside the surface and the error of a known source, each at its worst."""
    sounds = [summary.sound, *(point.get("sound", {}) for point in summary.points)]
    balances = [abs(sound["power_balance_db"]) for sound in sounds if sound.get("power_balance_db") is not None]
    leaks = [sound["interior_pressure"] for sound in sounds if sound.get("interior_pressure") is not None]
    if balances:
        yield Finding(
            f"Sound: powers through the surface and into the far field differ by at most {max(balances):.2f} dB "
            f"(bound: {_SAME_POWER:g} dB).",
            passed=max(balances) < _SAME_POWER,
            link=("section Sound", "section Sweep"),
        )
    if leaks:
        yield Finding(
            f"Sound: the pressure inside the radiating surface, where zero is exact, is at most {percent(max(leaks))} "
            f"of that on it (bound: {percent(_LEAK)}).",
            passed=max(leaks) < _LEAK,
            link=("section Sound", "section Sweep"),
        )
    sources = [sound for sound in sounds if sound.get("known_source_error") is not None]
    if sources:
        worst_source = max(sources, key=lambda sound: float(sound["known_source_error"]))
        error = worst_source["known_source_error"]
        yield Finding(
            f"Sound: the pressure of a known source inside is off by at most {percent(error)} on the radiating "
            f"surface, {percent(worst_source['known_source_rms'])} in the root mean square (bound: "
            f"{percent(_SOURCE_OFF)}, 2 dB).",
            passed=True if error < _SOURCE_OFF else None if error < _SOURCE_LOST else False,
            link=("section Sound", "section Sweep"),
        )


def _basis(summary: Summary) -> Iterator[Finding]:
    """Yield the largest error that the modal basis may leave in the lines that the page lists."""
    lines = leading_lines(summary.sensors, "peaks", _LINES)
    errors = [line["uncertainty"] for line in lines if "uncertainty" in line]
    if errors and math.isfinite(largest := max(errors)):
        yield Finding(
            f"Modal basis: the highest lines are known to {percent(largest)} or better "
            f"(bound: {percent(_LARGEST_ERROR)}).",
            passed=largest < _LARGEST_ERROR,
            link=("section Motion",),
        )


def _lines(summaries: Sequence[Summary]) -> tuple[str | Table, ...]:
    """Return the highest lines of each sensor of the newest motion, with their cause."""
    for summary in summaries:
        for sensors, key in summary.lines:
            if rows := leading_lines(sensors, key, _LINES):
                return (*_highest(rows), *table_of(_CAUSES, rows))
    return ()


def _highest(rows: Sequence[Document]) -> list[str]:
    """Return the highest line of all sensors and its cause as a sentence, which a narrow screen shows whole."""
    row = max(rows, key=lambda line: float(line["amplitude_m_per_s2"]))
    if not row.get("name"):
        return []
    near = f", near a mode of the coupled machine ({_near(row)})" if _near(row) else ""
    by = f"; largest part by {row['by']}" if row["by"] else ""
    between = f" ({band} dB with all damping doubled or halved)" if (band := band_words(row)) else ""
    excited = f", excited by {words} m/s²" if (words := mechanism_words(row)) != NOTHING else ""
    return [
        f"Highest is {row['frequency_hz']:.1f} Hz at {row['sensor']}, {amplitude_words(row)} m/s² peak"
        f"{between}: "
        f"{arrowed(str(row['name']))}{excited}{near}{by}."
    ]


def _sound(summaries: Sequence[Summary]) -> tuple[str | Table, ...]:
    """Return the sound power level of the newest sound with lines, and its loudest lines with their cause."""
    for summary in summaries:
        if (sound := summary.sound) and sound["lines"]:
            rows = loudest_lines(sound)[:_LOUDEST]
            return (f"{total_sentence(sound)}.", *table_of(LOUDEST_COLUMNS, rows))
    return ()


def _paths_of(row: Document) -> tuple[str, ...]:
    return path_place(row["sensor"], row["frequency_hz"]), "section Motion", "section Steady state"


def _through(row: Document) -> str:
    """Return the bearing with the largest share of a line, and the one that works against it most."""
    bearings = row.get("contributions", {}).get("bearings", ())
    if not bearings:
        return ""
    most, least = (choose(bearings, key=lambda part: part["share"]) for choose in (max, min))
    against = f", against it {_of_line(least)}" if least["share"] < -_OPPOSED else ""
    return f"{_of_line(most)}{against}"


def _of_line(part: Document) -> str:
    return f"{part['name']} {100.0 * part['share']:.0f} %"


def _near(row: Document) -> str:
    """Return the mode of the coupled machine that a line is near enough to be raised by it."""
    if not (mode := row.get("near_mode")):
        return ""
    where = "" if mode["where"] in ("", mode["kind"]) else f": {mode['where']}"
    return f"{mode['frequency_hz']:.0f} Hz, {mode['kind']}{where}"


_CAUSES = (
    Column("sensor", "sensor"),
    Column("frequency [Hz]", "frequency_hz", ".1f", link=_paths_of),
    Column("amplitude [m/s², peak]", "amplitude_m_per_s2", shown=amplitude_words),
    Column("by damping × 2 and / 2 [dB]", band_words, numbers=("band_db.0", "band_db.1")),
    LINE_NAME,
    MECHANISM,
    Column("coupled mode near it", _near),
    Column("mostly through bearing", _through),
    shape_column("mostly by"),
)


def _compared(summaries: Sequence[Summary]) -> tuple[str | Table, ...]:
    """Return the pairs of measured modes and the model's, and their errors, of the newest comparison."""
    for summary in summaries:
        compared = summary.compared
        if pairs := compared.get("pairs"):
            sentence = (
                f"Errors of the frequencies: {compared['rms_error_percent']:.2f} % root mean square, "
                f"{compared['max_error_percent']:.2f} % at most; paired by {compared['pairing_rule']}."
            )
            return (sentence, *table_of(LINKED_PAIR, pairs))
    return ()
