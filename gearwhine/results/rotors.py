"""Rotors: quantities of modes, whirl, critical speeds and responses, and how terminal and report show them."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gearwhine.numerics.result_warnings import warning
from gearwhine.output.files import file_stems
from gearwhine.output.quantity import ABSENT, HERTZ, RPM, Part, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import Column, Document, Picture, Section, Table, columns_of, counted, table_of
from gearwhine.results.bearing_lives import life_quantities
from gearwhine.results.housing import COUNT_CERTIFICATE

if TYPE_CHECKING:
    import numpy.typing as npt

    from gearwhine.rotors.analyses.campbell import Crossing
    from gearwhine.rotors.analyses.solved_rotor import Crossings, ProbeReading, SolvedResponse, SolvedRotor
    from gearwhine.rotors.rolling_bearings import RollingState
    from gearwhine.rotors.rolling_bearings.rated_life import BearingLife
    from gearwhine.rotors.whirl.whirl_modes import WhirlModes

_ROTATING = (
    "rotor {!r}: the damping of its coupling across the axis turns with the shaft and feeds forward whirl at speeds "
    "above its frequency; whirl and its stability are told without it here, and with it by `gearwhine system`"
)


class _Whirl(NamedTuple):
    """Rotor, and its whirl modes at one speed."""

    solved: "SolvedRotor"
    whirl: "WhirlModes"


def _strain_shares(row: _Whirl) -> dict[str, Any]:
    """Return the shares in each whirl mode's strain energy by kind of part, mean over a cycle; a row for each mode."""
    solved, whirl = row
    shares = whirl.strain_energy_shares(solved.rotor.joints)
    parts = {"segment": shares.lengths, "bearing": shares.bearings}
    pedestals = any(bearing.pedestal is not None for bearing in solved.bearings)
    return parts | ({"pedestal": shares.pedestals} if pedestals else {})


def _most_strained(row: _Whirl) -> Any:
    """Part with the largest share of the strain energy of each whirl mode; None for a mode that strains nothing.

    Only the speed that terminal and report show has it: operation, or else the last of the sweep.
    """
    solved, whirl = row
    if whirl is not solved.whirl[0 if solved.operation is not None else -1]:
        return ABSENT
    bearing_names = [bearing.name for bearing in solved.bearings]
    names = {
        "segment": [f"segment {number}" for number in range(1, len(solved.rotor.segments) + 1)],
        "bearing": bearing_names,
        "pedestal": [f"pedestal of {name}" for name in bearing_names],
    }
    shares = _strain_shares(row)
    most_strained = []
    for mode in range(len(shares["segment"])):
        parts = [
            (float(share), name)
            for kind, of in shares.items()
            for share, name in zip(of[mode], names[kind], strict=True)
        ]
        share, name = max(parts)
        most_strained.append({"part": name, "share": share} if share > 0.0 else None)
    return most_strained


def _strain(kind: str) -> Quantity:
    """Declare the shares of one kind of part in the strain energy of whirl modes."""
    return in_file(
        f"whirl_{kind}_strain_share",
        ("whirl_number", f"strained_{kind}"),
        lambda row: _strain_shares(row).get(kind),
        f"share of a {kind} in the strain energy of the whirl mode",
        "1",
    )


class _Crossing(NamedTuple):
    """Rotor, and a damped critical speed of it."""

    solved: "SolvedRotor"
    crossing: "Crossing"


CROSSING = (
    Quantity("speed_rpm", "crossing.speed"),
    Quantity("direction", "crossing.direction"),
    Quantity("axial_share", "crossing.axial_share"),
    Quantity("log_decrement", "crossing.log_decrement"),
    Quantity(
        "margin", lambda row: abs(row.crossing.speed / row.solved.operation) - 1.0 if row.solved.operation else None
    ),
)
"""Quantities of a damped critical speed."""


class _Order(NamedTuple):
    """Rotor, an order, and the damped critical speeds of that order, or why there are none."""

    solved: "SolvedRotor"
    order: float
    crossings: "Crossings"


def _crossings(row: _Order) -> list[_Crossing] | None:
    return None if isinstance(row.crossings, str) else [_Crossing(row.solved, crossing) for crossing in row.crossings]


CRITICAL_SPEEDS = (
    Rows("critical_speeds", _crossings, CROSSING),
    Quantity("why_no_critical_speeds", lambda row: row.crossings if isinstance(row.crossings, str) else None),
)
"""Damped critical speeds of a rotor for one order, or why there are none."""

WHIRL = (
    in_file("whirl_state", "", lambda row: f"{row.solved.rotor.name} at {row.whirl.speed * RPM:.6g} rpm"),
    Quantity("speed_rpm", "whirl.speed", "whirl_speed"),
    Quantity("frequency_hz", "whirl.frequencies", "whirl_frequency", ("whirl_number",)),
    Quantity("damped_frequency_hz", "whirl.damped_frequencies"),
    Quantity("damping_ratio", "whirl.damping_ratios"),
    Quantity("log_decrement", "whirl.log_decrements"),
    Quantity("direction", "whirl.direction"),
    Quantity("axial_share", "whirl.axial_share"),
    Quantity("stable", "whirl.stable"),
    Quantity("most_strained", _most_strained),
    _strain("segment"),
    _strain("bearing"),
    _strain("pedestal"),
)
"""Quantities of whirl at one speed."""

_STEPS = ("campbell_step", "whirl_branch")
CAMPBELL = (
    Quantity("speed_rpm", "campbell.speeds", "campbell_speed", _STEPS[:1]),
    in_file("campbell_frequency", _STEPS, "campbell.frequencies", unit="Hz"),
    in_file("campbell_log_decrement", _STEPS, "campbell.log_decrements", unit="1"),
    in_file("campbell_direction", _STEPS, "campbell.direction", unit="1"),
    in_file("campbell_axial_share", _STEPS, "campbell.axial_share", unit="1"),
    Quantity("unstable_from_rpm", "campbell.unstable_from"),
    Quantity("proved_at_rpm", lambda solved: solved.campbell.speeds[solved.campbell.proved] * RPM),
    Part("", lambda solved: _Order(solved, 1.0, solved.crossings), CRITICAL_SPEEDS),
    Rows(
        "orders",
        lambda solved: [_Order(solved, order, crossings) for order, crossings in solved.orders.items()],
        (Quantity("order"), *CRITICAL_SPEEDS),
    ),
)
"""Whirl over speed: a row for each speed, a column for each branch, which keeps its place through its crossings."""


class _Rolling(NamedTuple):
    """Rotor, and the name of one of its rolling bearings."""

    solved: "SolvedRotor"
    name: str

    @property
    def label(self) -> str:
        """Rotor and bearing."""
        return f"{self.solved.rotor.name}: {self.name}"

    @property
    def loaded(self) -> "RollingState":
        """The bearing under its load."""
        return self.solved.rolling[self.name]

    @property
    def rated(self) -> "BearingLife":
        """Ratings and lives at the speed of operation."""
        return self.solved.lives[self.name]

    @property
    def elements(self) -> int:
        """Number of rolling elements."""
        return sum(each.count for each in self.loaded.bearing.rows)

    @property
    def characteristic_frequencies_hz(self) -> dict[str, float] | None:
        """Characteristic frequencies of the first row at the speed of operation [Hz]."""
        from gearwhine.rotors.rolling_bearings import frequencies_in_seat

        operation = self.solved.operation
        if not operation:
            return None
        frequencies = frequencies_in_seat(self.loaded.bearing.rows[0], operation)
        return {name: frequency / HERTZ for name, frequency in frequencies.named().items()}


ROLLING = (
    in_file("rolling_bearing", "", "label"),
    Quantity("name", heading="bearing"),
    Quantity(
        "load_n",
        lambda row: row.loaded.load[:3],
        heading="x, y, z [N]",
        shown=lambda row: ", ".join(f"{load:z.5g}" for load in row["load_n"]),
    ),
    Quantity("elements"),
    Quantity(
        "loaded_elements",
        "loaded.loaded",
        heading="loaded",
        shown=lambda row: f"{row['loaded_elements']} of {row['elements']}",
        numbers=("elements",),
    ),
    Quantity("peak_pressure_pa", "loaded.peak_pressure", heading="peak [GPa]", shown=".3g"),
    Quantity(
        "stiffness",  # over x, y, z and the rotations about x and y, in N/m, N/rad and N m/rad
        "loaded.stiffness",
        heading="stiffness [N/m]",
        shown=lambda row: ", ".join(f"{row['stiffness'][motion][motion]:.3g}" for motion in range(3)),
    ),
    *life_quantities("rolling_bearing", ("rated life L10 [h]", "L10r [h]")),
    Quantity("estimated", "loaded.bearing.estimated"),
    Quantity("characteristic_frequencies_hz", "characteristic_frequencies_hz"),
    Quantity("displacement_m", lambda row: row.loaded.displacement[:3]),
    Quantity("residual", "loaded.residual"),
)
"""Quantities of a rolling bearing under its load."""

_PLANE = in_file("plane", "plane", lambda _: ["x", "y"], common=True)
_SAG = ("static_step",)


class _BearingLoad(NamedTuple):
    """Name of a bearing, and its load: forces along x, y, z [N] and moments about x, y [N m]."""

    name: str
    load: "npt.NDArray[np.float64]"


STATIC = (
    Quantity("gravity_m_per_s2", "weight.deflection.gravity"),
    Rows("forces", "weight.forces", (Quantity("at_m"), Quantity("force_n", lambda force: [force.x, force.y, force.z]))),
    Quantity("bearings_at_rpm", lambda solved: None if solved.rest_speed is None else solved.weight.speed * RPM),
    Rows(
        "bearings",
        lambda solved: [
            _BearingLoad(*each)
            for each in zip(solved.weight.deflection.bearings, solved.weight.deflection.bearing_loads, strict=True)
        ],
        (
            Quantity("name", heading="bearing carries"),
            Quantity("load_n", lambda row: row.load[:3]),
            Quantity("moment_n_m", lambda row: row.load[3:]),
        ),
    ),
    Quantity("largest_deflection_m", "weight.largest.0"),
    Quantity("largest_deflection_at_m", "weight.largest.1"),
    in_file("static_place", _SAG, "weight.places", unit="m"),
    in_file("static_deflection", ("plane", *_SAG), "weight.displacement", unit="m"),
    _PLANE,
)
"""Bearing loads under gravity and constant forces, and the shaft's sag."""

_PROBE = ("response_step",)


class _Probe(NamedTuple):
    """Reading of a probe over speed, and the one at operation where there is any."""

    reading: "ProbeReading"
    at_operation: "ProbeReading | None"


PROBE = (
    in_file("probe", "", "reading.label"),
    in_file("response_speed", _PROBE, "reading.speeds", unit="rpm"),
    Quantity("name", "reading.probe.name"),
    Quantity("at_m", "reading.probe.at"),
    Quantity("angle_deg", "reading.probe.angle"),
    in_file("probe_amplitude", _PROBE, "reading.size", unit="m"),
    in_file("probe_phase_lag", _PROBE, "reading.phase_lag", unit="rad"),
    in_file("orbit_major_axis", _PROBE, "reading.major_axis", unit="m"),
    Quantity("largest_amplitude_m", "reading.largest.0"),
    Quantity("largest_at_rpm", "reading.largest.1"),
    Quantity("operation_amplitude_m", "at_operation.size.0"),
    Quantity("operation_phase_lag_deg", "at_operation.phase_lag.0"),
)
"""Quantities of a probe."""


def _readings(solved: "SolvedResponse") -> list[_Probe]:
    at_operation = solved.at_operation or [None] * len(solved.readings)
    return [_Probe(*each) for each in zip(solved.readings, at_operation, strict=True)]


class _BearingForce(NamedTuple):
    """Force on a bearing by unbalance and bow.

    Attributes
    ----------
    solved : SolvedResponse
    name : str
    force : ndarray, shape (2, b)
        Force on the bearing along x and y, zero to peak [N].
    """

    solved: "SolvedResponse"
    name: str
    force: "npt.NDArray[np.float64]"


RESPONSE = (
    Quantity("from_rpm", "response.speeds.0"),
    Quantity("to_rpm", lambda solved: solved.response.speeds[-1] * RPM),
    Quantity("amplitude_convention", lambda solved: "zero to peak"),
    Rows("probes", _readings, PROBE, "probe"),
    Rows(
        "bearings",
        lambda solved: [
            _BearingForce(solved, name, np.abs(solved.response.bearing_forces[:, place, :2]).T)
            for place, name in enumerate(solved.response.bearings)
        ],
        (
            in_file("unbalance_bearing", "", "name"),
            Quantity("name"),
            Quantity("largest_force_n", lambda row: row.force.max(axis=1)),
            in_file("unbalance_bearing_force", ("plane", *_PROBE), "force", unit="N"),
            in_file("unbalance_bearing_speed", _PROBE, "solved.response.speeds", "speed of the rotor", "rpm"),
            _PLANE,
        ),
        "unbalance_bearing",
    ),
)
"""Readings of probes over speed under unbalance and bow; forces on the bearings along x and y."""

_TORSION = ("torsion_step",)
TORSION_PROBE = (
    in_file("torsion_probe", "", "label"),
    in_file("torsion_frequency", _TORSION, "frequencies", unit="Hz"),
    Quantity("name", "probe.name"),
    Quantity("at_m", "probe.at"),
    in_file("torsion_angle", _TORSION, "angle_size", unit="rad"),
    in_file("torsion_angle_phase", _TORSION, "angle_phase", unit="rad"),
    in_file("torsion_torque", _TORSION, "torque_size", unit="N m"),
    in_file("torsion_torque_phase", _TORSION, "torque_phase", unit="rad"),
    Quantity("largest_angle_rad", "largest_angle.0"),
    Quantity("largest_angle_at_hz", "largest_angle.1"),
    Quantity("largest_torque_n_m", "largest_torque.0"),
    Quantity("largest_torque_at_hz", "largest_torque.1"),
)
"""Angle and torque at a probe over frequency."""

TORSION = (
    Quantity("from_hz", "response.frequencies.0"),
    Quantity("to_hz", lambda solved: solved.response.frequencies[-1] / HERTZ),
    Quantity("damping_ratio", "response.damping_ratio"),
    Quantity("amplitude_convention", lambda solved: "zero to peak"),
    Rows("probes", "readings", TORSION_PROBE, "torsion_probe"),
    Quantity("largest_torque_n_m", "worst.0"),
    Quantity("largest_torque_at_m", "worst.1"),
    Quantity("largest_torque_at_hz", "worst.2"),
)
"""Torsional response to harmonic torques."""


def _rest_strain(kind: str, place: int) -> Quantity:
    """Declare the shares of one kind of part in the strain energy of planar modes."""
    return in_file(
        f"rotor_{kind}_strain_share",
        ("lateral_mode", f"strained_{kind}"),
        lambda solved: solved.lateral.strain_energy_shares(solved.rotor.joints)[place],
        f"share of a {kind} in the strain energy of the lateral mode",
        "1",
    )


def _critical_speed_map(whirl: str, direction: int) -> Quantity:
    """Critical speeds over the stiffness of all bearings, in one sense of whirl."""
    return Quantity(
        f"{whirl}_critical_speeds_rpm",
        lambda speed_map: speed_map.speeds * RPM if speed_map.direction == direction else ABSENT,
        "map_critical_speed",
        ("map_step", "map_curve"),
        "rpm",
        long_name=f"undamped critical speeds of {whirl} whirl",
    )


STIFFNESS_MAP = (
    Quantity(
        "stiffness_n_per_m",
        "stiffnesses",
        "map_stiffness",
        ("map_step",),
        long_name="stiffness of every bearing",
        common=True,
    ),
    _critical_speed_map("forward", 1),
    _critical_speed_map("backward", -1),
)

ROTOR = (
    Quantity("name", "rotor.name", "rotor", heading="rotor"),
    Quantity("mass_kg", "rotor.mass", heading="mass [kg]", shown=".3f"),
    Quantity("length_m", "rotor.length"),
    Quantity("bearings", lambda solved: [bearing.name for bearing in solved.bearings]),
    in_file("rotor_rest_frequency", "rest_mode", "rest.frequencies", unit="Hz"),
    Quantity("lateral_hz", "bending_frequencies", heading="bending at rest [Hz]", shown=".1f"),
    Quantity("lateral_axial_share", "bending_axial_share"),
    Quantity(
        "torsional_hz",
        "torsional.frequencies",
        "rotor_torsional_frequency",
        ("torsional_mode",),
        heading="torsion [Hz]",
        shown=".1f",
    ),
    Quantity("axial_hz", heading="along the axis [Hz]", shown=".1f"),
    in_file("rotor_place", "place", "places", unit="m"),
    in_file("rest_direction", "rest_direction", lambda _: ["x", "y", "z"], common=True),
    in_file(
        "rotor_rest_shape",
        "rest_mode rest_direction place",
        "rest_shapes",
        "shape of the mode at rest of rotor_rest_frequency",
        "kg-0.5",
    ),
    in_file(
        "rotor_lateral_frequency",
        "lateral_mode",
        "lateral.frequencies",
        "natural frequency in one plane, on bearings with the mean stiffness of both planes",
        "Hz",
    ),
    in_file(
        "rotor_lateral_shape",
        "lateral_mode place",
        "lateral_shapes",
        "shape of the mode of rotor_lateral_frequency",
        "kg-0.5",
    ),
    in_file("rotor_torsional_shape", "torsional_mode place", "torsional_shapes", unit="kg-0.5 m-1"),
    _rest_strain("segment", 0),
    _rest_strain("bearing", 1),
    Quantity("rest_bearings_at_rpm", "rest_speed"),
    Quantity("operation_rpm"),
    Rows("whirl", lambda solved: [_Whirl(solved, whirl) for whirl in solved.whirl], WHIRL, "whirl_state"),
    in_file("rotor_whirl_deflection", "whirl_mode place", "whirl_deflection", unit="kg-0.5"),
    in_file("rotor_whirl_moment", "whirl_mode place", "whirl_moment", unit="N kg-0.5"),
    Quantity("critical_speeds_rpm", "critical.speeds", heading="critical speeds [rpm]", shown=".0f"),
    Quantity("critical_directions", lambda solved: solved.critical.direction.round(6)),
    Quantity("critical_axial_share", "critical.axial_share"),
    Quantity("critical_margins", "margins"),
    Part("campbell", lambda solved: None if solved.campbell is None else solved, CAMPBELL),
    Part("static", lambda solved: ABSENT if isinstance(solved.weight, str) else solved, STATIC),
    Part(
        "static",
        lambda solved: solved if isinstance(solved.weight, str) else ABSENT,
        (Quantity("bearings", lambda solved: None), Quantity("why_not", "weight")),
    ),
    Part("unbalance_response", "response", RESPONSE),
    Rows(
        "rolling_bearings",
        lambda solved: [_Rolling(solved, name) for name in solved.rolling],
        ROLLING,
        "rolling_bearing",
    ),
    Quantity(
        "damping", lambda solved: "of the bearings; that of the shaft and of its couplings acts in the coupled system"
    ),
    Part("torsional_response", "torsion", TORSION),
    Part("stiffness_map", "stiffness_map", STIFFNESS_MAP),
    Part("certificate", "rest.certificate", COUNT_CERTIFICATE),
    Quantity("seats", lambda solved: "rigid"),
)
"""Quantities of one rotor on grounded bearings."""


def _numbers(dimension: str, of: Any, kind: str) -> Quantity:
    """Declare the numbers of modes, from 1; as many as the rotor with most modes has."""

    def numbers(solved: Any) -> Any:
        count = max((len(modes) for modes in map(of, solved) if modes is not None), default=0)
        return np.arange(1, count + 1) if count else None

    return in_file(dimension, (dimension,), numbers, f"number of the {kind}", "1")


ROTORS = (
    _numbers("rest_mode", lambda rotor: rotor.rest.frequencies, "lateral mode at rest"),
    _numbers("lateral_mode", lambda rotor: rotor.lateral.frequencies, "lateral mode on round bearings"),
    _numbers("torsional_mode", lambda rotor: rotor.torsional.frequencies, "torsional mode"),
    _numbers("whirl_mode", lambda rotor: rotor.whirl_deflection, "whirl mode"),
    Rows("rotors", ".", ROTOR, "rotor"),
)
"""Quantities of all rotors of a case."""


def _stability_warnings(rotor: "SolvedRotor") -> Iterator[dict[str, Any]]:
    """Warn of a rotor whose whirl grows by itself, at the lowest speed that is known of."""
    onset = None if rotor.campbell is None else rotor.campbell.unstable_from
    if onset is None:
        onset = min((state.speed for state in rotor.whirl if not np.all(state.stable)), key=abs, default=None)
    if onset is not None:
        message = (
            f'rotor "{rotor.rotor.name}" is unstable from {abs(onset) * RPM:.6g} rpm on: a whirl mode has negative '
            "damping and grows by itself; motions of this rotor mean nothing beyond"
        )
        yield warning("unstable rotor", message, rotor=rotor.rotor.name, unstable_from_rpm=abs(float(onset)) * RPM)


def rotors_document(solved: tuple["SolvedRotor", ...]) -> dict[str, Any]:
    """Return the rotors as the command's JSON, with warnings."""
    warnings = [
        warning("rotating damping", _ROTATING.format(rotor.rotor.name), rotor=rotor.rotor.name)
        for rotor in solved
        if rotor.damps_across
    ]
    warnings += [entry for rotor in solved for entry in _stability_warnings(rotor)]
    return document_of(ROTORS, solved) | {"warnings": warnings}


_MOST_TABLE_ROWS = 12  # rows of a table
_MAP_ROWS = 5  # rows of the critical-speed map
_REACH = 2.0  # multiple of the speed of operation above which critical speeds are only counted
_MOSTLY_AXIAL, _PARTLY_AXIAL = 0.5, 0.05  # axial share of kinetic energy from which a motion is axial, or partly so
_PLANAR = 1e-3  # a whirl direction this near to zero is a line, neither forward nor backward
_NEUTRAL = 1e-9  # a damping ratio this near to zero neither grows nor decays
_TORQUE_ROUNDING = 1e-9  # part of the largest torque up to which a torque counts as zero
_SAME_FREQUENCY_DIFFERENCE = 1e-9  # relative difference up to which two frequencies are one of both planes


def report(document: Document) -> Section:
    """Chapter of the report: all rotors beside each other, then each as the terminal shows it."""
    overview = table_of(columns_of(ROTOR), document["rotors"])
    stems = file_stems([rotor["name"] for rotor in document["rotors"]], "rotor-")
    inner = tuple(
        replace(section, pictures=tuple(Picture(f"{stem}-{kind}", caption) for kind, caption in _PICTURES.items()))
        for section, stem in zip(sections(document), stems, strict=True)
    )
    return Section("Rotors", overview, pictures=(Picture("rotor-", "Rotor."),), inner=inner)


_PICTURES = {
    "shaft": "Shaft to scale with its gears, discs and bearings.",
    "modes": "Modes at rest of the table, in both planes and along the axis, each to a scale of its own.",
    "torsional-response": "Response to torques that vary, over their frequency: peaks are torsional resonances.",
    "torsion": "Torsional modes: angle of twist along the shaft.",
    "whirl": "Whirl at the speed of operation: orbits along the shaft, forward or backward.",
    "campbell": "Campbell diagram: whirl frequencies over speed; a critical speed stands where an order meets one.",
    "critical-map": "Undamped critical speeds over the stiffness of the bearings: flat branches do not depend on it.",
    "unbalance": "Response to unbalance and bow over speed: peaks stand at critical speeds.",
    "static": "Deflection of the rotor under its weight and constant forces, and the forces that hold it.",
}
"""Captions of a rotor's figures, by the last part of their names."""


def sections(document: Document) -> tuple[Section, ...]:
    """Each rotor at rest and at speed, its critical speeds, and the proof of the list."""
    return tuple(
        Section(
            rotor["name"],
            tuple(_content(rotor)),
            note=f"  {rotor['mass_kg']:.5g} kg, {1e3 * rotor['length_m']:.5g} mm long",
        )
        for rotor in document["rotors"]
    )


def _content(rotor: Document) -> Iterator[str | Table]:
    yield from _at_rest(rotor)
    yield from _whirl(rotor)
    yield from _critical_speeds(rotor)
    yield from table_of(
        columns_of(ROLLING), rotor["rolling_bearings"], "Rolling bearings under their loads, in rigid seats"
    )
    yield from _weight(rotor["static"])
    if response := rotor["unbalance_response"]:
        yield from table_of(_PROBES, response["probes"][:_MOST_TABLE_ROWS], "Response to unbalance and bow")
    if response := rotor["torsional_response"]:
        yield from _torsion(response)
    if speed_map := rotor["stiffness_map"]:
        yield from _map(speed_map)
    if campbell := rotor["campbell"]:
        yield _stability(campbell)
    certificate = rotor["certificate"]
    yield (
        f"Bending at rest complete below {certificate['limit_hz']:.5g} Hz: {certificate['found']} found, "
        f"{certificate['expected']} counted"
    )


def _at_rest(rotor: Document) -> tuple[Table, ...]:
    """Frequencies at rest with their kind, ascending as far as bending and torsion are both listed."""
    bending = list(_bending(rotor["lateral_hz"], rotor["lateral_axial_share"]))
    torsion = [(hertz, "torsion" if hertz > 0.0 else "turns freely") for hertz in rotor["torsional_hz"]]
    axial = [(hertz, "axial") for hertz in rotor["axial_hz"]]
    highest = min(rows[-1][0] for rows in (bending, torsion) if rows) if bending or torsion else 0.0
    by_frequency = sorted([*bending, *torsion, *axial], key=lambda row: row[0])
    rows = [{"frequency_hz": hertz, "kind": kind} for hertz, kind in by_frequency if hertz <= highest]
    columns = (Column("frequency [Hz]", "frequency_hz", ".5g"), Column("kind", "kind"))
    return table_of(columns, rows[:_MOST_TABLE_ROWS], f"At rest{_with_bearings_at(rotor['rest_bearings_at_rpm'])}")


def _with_bearings_at(speed: float | None) -> str:
    """Return the speed at which the bearings' coefficients are taken, in words; nothing without tables."""
    return "" if speed is None else f", with the bearings' coefficients at {speed:.6g} rpm"


def _bending(frequencies: Sequence[float], axial_shares: Sequence[float]) -> Iterator[tuple[float, str]]:
    place = 0
    while place < len(frequencies):
        frequency = frequencies[place]
        double = (
            place + 1 < len(frequencies)
            and frequencies[place + 1] - frequency <= _SAME_FREQUENCY_DIFFERENCE * frequencies[place + 1]
        )
        if frequency > 0.0 and axial_shares[place] > _MOSTLY_AXIAL:
            yield frequency, f"axial{_with_axial(axial_shares[place])}"
            place += 1
            continue
        kind = "bending" if frequency > 0.0 else "moves freely"
        planes = "both planes" if double else "one plane"
        yield frequency, f"{kind}, {planes}{_with_axial(axial_shares[place])}"
        place += 2 if double else 1


_WHIRL_COLUMNS = (
    Column("frequency [Hz]", "frequency_hz", ".5g"),
    Column("whirl", lambda row: _whirl_name(math.copysign(1.0, row["speed_rpm"]) * row["direction"], row)),
    Column(
        "log decrement",
        "log_decrement",
        shown=lambda row: "0" if _state(row) == "undamped" else f"{row['log_decrement']:.3g}",
    ),
    Column("", lambda row: _state(row)),
    Column(
        "most strain energy",
        lambda row: (
            "" if row["strained"] is None else f"{100.0 * row['strained']['share']:.0f} % {row['strained']['part']}"
        ),
        numbers=("strained.share",),
    ),
)


def _whirl(rotor: Document) -> tuple[Table, ...]:
    """Whirl at operation, which comes first; without operation, at the last speed of the sweep."""
    if not rotor["whirl"]:
        return ()
    whirl = rotor["whirl"][0 if rotor["operation_rpm"] is not None else -1]
    keys = ("frequency_hz", "direction", "axial_share", "log_decrement", "damping_ratio")
    values = zip(*(whirl[key] for key in (*keys, "most_strained")), strict=True)
    rows = [{"speed_rpm": whirl["speed_rpm"]} | dict(zip((*keys, "strained"), row, strict=True)) for row in values]
    return table_of(_WHIRL_COLUMNS, rows[:_MOST_TABLE_ROWS], f"Turning at {whirl['speed_rpm']:.6g} rpm")


def _state(row: Document) -> str:
    damping = row["damping_ratio"]
    return "GROWS" if damping < -_NEUTRAL else "undamped" if damping <= _NEUTRAL else "decays"


_CRITICAL_COLUMNS = (
    Column("speed [rpm]", "speed_rpm", shown=lambda row: f"{abs(row['speed_rpm']):.5g}"),
    Column("whirl", lambda row: _whirl_name(row["way"], row)),
    Column(
        "log decrement",
        "log_decrement",
        shown=lambda row: (
            ""
            if "log_decrement" not in row
            else f"{row['log_decrement']:.3g}"
            if abs(row["log_decrement"]) > _NEUTRAL
            else "0"
        ),
    ),
    Column("from operation", "margin", shown=lambda row: "" if row["margin"] is None else _beside(row["margin"])),
)


def _critical_speeds(rotor: Document) -> Iterator[str | Table]:
    """Critical speeds: where the Campbell diagram has them, damped; without a diagram, undamped."""
    campbell = rotor["campbell"]
    if campbell is None or campbell["critical_speeds"] is None:
        yield from _undamped(rotor)
        if campbell is not None:
            yield f"No damped critical speeds: {campbell['why_no_critical_speeds']}"
    else:
        rows = [
            crossing | {"way": _turning(campbell) * crossing["direction"]} for crossing in campbell["critical_speeds"]
        ]
        yield from table_of(_CRITICAL_COLUMNS, rows[:_MOST_TABLE_ROWS], f"Critical speeds from {_span(campbell)}")
        if not rows:
            lowest = ""
            if rotor["critical_speeds_rpm"]:
                way = _whirl_name(rotor["critical_directions"][0], {"axial_share": rotor["critical_axial_share"][0]})
                lowest = f"; undamped, the lowest is {rotor['critical_speeds_rpm'][0]:.5g} rpm, {way}"
            yield f"No critical speed from {_span(campbell)}{lowest}"
        yield from _nearest(rows)
    if campbell is not None and campbell["orders"]:
        yield from _orders(campbell)


def _undamped(rotor: Document) -> Iterator[str | Table]:
    """Yield undamped critical speeds and their margins; of those far above operation only the first."""
    speeds, margins = rotor["critical_speeds_rpm"], rotor["critical_margins"]
    values = zip(
        speeds,
        rotor["critical_directions"],
        rotor["critical_axial_share"],
        [None] * len(speeds) if margins is None else margins,
        strict=True,
    )
    rows = [dict(zip(("speed_rpm", "way", "axial_share", "margin"), row, strict=True)) for row in values]
    reach = len(rows) if margins is None else sum(margin <= _REACH - 1.0 for margin in margins) + 1
    yield from table_of(_CRITICAL_COLUMNS, rows[: min(reach, _MOST_TABLE_ROWS)], "Undamped critical speeds")
    yield from _nearest(rows)


def _nearest(rows: Sequence[Document]) -> Iterator[str]:
    """Yield the critical speed nearest to operation of those that unbalance excites."""
    # Circular backward whirl takes no work from unbalance.
    excited = [row for row in rows if row["margin"] is not None and row["way"] >= -1.0 + _PLANAR]
    if excited:
        row = min(excited, key=lambda crossing: (abs(crossing["margin"]), abs(crossing["speed_rpm"])))
        speed, margin = abs(row["speed_rpm"]), row["margin"]
        yield f"Of those that unbalance excites, {speed:.5g} rpm is nearest: {_beside(margin)} operation"


def _orders(campbell: Document) -> Iterator[str | Table]:
    """Yield the crossings of whirl frequencies with other multiples of the speed of rotation."""
    rows: list[dict[str, Any]] = []
    for entry in campbell["orders"]:
        order = f"{entry['order']:g}×"
        if entry["critical_speeds"] is None:
            rows.append({"order": order, "speed": entry["why_no_critical_speeds"], "whirl": ""})
        for crossing in entry["critical_speeds"] or ():
            whirl = _whirl_name(_turning(campbell) * crossing["direction"], crossing)
            rows.append({"order": order, "speed": f"{abs(crossing['speed_rpm']):.5g}", "whirl": whirl})
    columns = (Column("order", "order"), Column("speed [rpm]", "speed"), Column("whirl", "whirl"))
    yield from table_of(columns, rows[: 2 * _MOST_TABLE_ROWS], f"Other orders from {_span(campbell)}")
    if not rows:
        yield f"None of the other orders meets a whirl frequency from {_span(campbell)}"


def _weight(static: Document) -> Iterator[str | Table]:
    """Yield the bearing reactions to the rotor's weight and constant forces, and its sag."""
    if static["bearings"] is None:
        yield f"No static deflection: {static['why_not']}"
        return
    along = any(bearing["load_n"][2] for bearing in static["bearings"])
    columns = (
        Column("bearing carries", "name"),
        *(Column(f"{axis} [N]", f"load_n.{at}", "z.5g") for at, axis in enumerate("xyz" if along else "xy")),
    )
    pulled = static.get("forces", ())
    under = f"Under its weight and {counted(len(pulled), 'constant force')}" if pulled else "Under its weight"
    yield from table_of(columns, static["bearings"], f"{under}{_with_bearings_at(static['bearings_at_rpm'])}")
    sag, place = 1e6 * static["largest_deflection_m"], 1e3 * static["largest_deflection_at_m"]
    yield f"It sags most at {place:.5g} mm, by {sag:.3g} µm"


_PROBES = (
    Column(
        "probe",
        lambda row: f"{row['name']}, {1e3 * row['at_m']:.5g} mm, {row['angle_deg']:.0f}°",
        numbers=("at_m", "angle_deg"),
    ),
    Column("at operation [µm, peak]", "operation_amplitude_m", ".3g"),
    Column(
        "lag",
        "operation_phase_lag_deg",
        shown=lambda row: (
            "" if row["operation_phase_lag_deg"] is None else f"{round(row['operation_phase_lag_deg']) % 360}°"
        ),
    ),
    Column(
        "largest [µm, peak]",
        "largest_amplitude_m",
        shown=lambda row: f"{1e6 * row['largest_amplitude_m']:.3g} at {row['largest_at_rpm']:.5g} rpm",
        numbers=("largest_at_rpm",),
    ),
)


def _torsion(response: Document) -> Iterator[str | Table]:
    """Yield the largest angle and torque at each probe, and the largest torque of the whole shaft."""
    nothing = _TORQUE_ROUNDING * response["largest_torque_n_m"]
    columns = (
        Column("probe", lambda row: f"{row['name']}, {1e3 * row['at_m']:.5g} mm", numbers=("at_m",)),
        Column(
            "largest angle [mrad, peak]",
            "largest_angle_rad",
            shown=lambda row: f"{1e3 * row['largest_angle_rad']:.3g} at {row['largest_angle_at_hz']:.5g} Hz",
            numbers=("largest_angle_at_hz",),
        ),
        Column(
            "largest torque [N·m, peak]",
            "largest_torque_n_m",
            shown=lambda row: (
                f"{row['largest_torque_n_m']:.4g} at {row['largest_torque_at_hz']:.5g} Hz"
                if row["largest_torque_n_m"] > nothing
                else "0"
            ),
            numbers=("largest_torque_at_hz",),
        ),
    )
    title = f"Response to torques from {response['from_hz']:.5g} to {response['to_hz']:.5g} Hz"
    yield from table_of(columns, response["probes"][:_MOST_TABLE_ROWS], title)
    yield (
        f"The shaft carries most at {1e3 * response['largest_torque_at_m']:.5g} mm: "
        f"{response['largest_torque_n_m']:.4g} N·m at {response['largest_torque_at_hz']:.5g} Hz"
    )


def _map(speed_map: Document) -> tuple[Table, ...]:
    """Critical speeds from the softest to the stiffest bearings; the rest is in the files."""
    whirl = "forward" if "forward_critical_speeds_rpm" in speed_map else "backward"
    stiffnesses, speeds = speed_map["stiffness_n_per_m"], speed_map[f"{whirl}_critical_speeds_rpm"]
    chosen = sorted({round(part * (len(stiffnesses) - 1) / (_MAP_ROWS - 1)) for part in range(_MAP_ROWS)})
    rows = [
        {
            "stiffness": stiffnesses[row],
            "speeds": "  ".join(f"{speed:.5g}" for speed in speeds[row] if speed is not None and math.isfinite(speed)),
        }
        for row in chosen
    ]
    columns = (Column("stiffness [N/m]", "stiffness", ".3g"), Column(f"{whirl} critical speeds [rpm]", "speeds"))
    return table_of(columns, rows, "Over the stiffness of all bearings")


def _beside(margin: float) -> str:
    """Return the distance of a critical speed from operation, which it exceeds by ``margin`` times operation."""
    if margin > _REACH - 1.0:
        return f"{1.0 + margin:.3g} times"
    return f"{100.0 * abs(margin):.3g} % {'above' if margin > 0.0 else 'below'}"


def _whirl_name(direction: float, row: Document) -> str:
    """Sense of a whirl beside that of rotation, or along the axis."""
    if row["axial_share"] > _MOSTLY_AXIAL:
        return "along the axis"
    way = "in a plane" if abs(direction) <= _PLANAR else "forward" if direction > 0.0 else "backward"
    return way + _with_axial(row["axial_share"])


def _with_axial(share: float) -> str:
    """Return the axial share of a lateral motion in words; empty where it is small."""
    return f", {100.0 * share:.0f} % along the axis" if share >= _PARTLY_AXIAL else ""


def _stability(campbell: Document) -> str:
    """Return the speed up to which no mode grows."""
    span = f"{counted(len(campbell['speed_rpm']), 'speed')} from {_span(campbell)}"
    onset = campbell["unstable_from_rpm"]
    return f"Stable at {span}" if onset is None else f"UNSTABLE from {onset:.6g} rpm on, of {span}"


def _turning(campbell: Document) -> float:
    """Sense of rotation."""
    return -1.0 if min(campbell["speed_rpm"]) < 0.0 else 1.0


def _span(campbell: Document) -> str:
    speeds = [abs(speed) for speed in campbell["speed_rpm"]]
    return f"{min(speeds):.6g} to {max(speeds):.6g} rpm"
