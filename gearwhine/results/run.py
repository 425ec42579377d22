"""Run of a case: quantities of the transient, its spectra and the origin of their lines, and how they are shown."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import h5netcdf
import numpy as np

from gearwhine.coupling.signals.peaks import Peak
from gearwhine.coupling.signals.spectrum import at_time_zero
from gearwhine.coupling.time.histories import HISTORY_QUANTITIES, HistoryQuantity
from gearwhine.housing.storage.netcdf import Variables, reserve_space
from gearwhine.output.quantity import ABSENT, RPM, Fields, Part, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import Column, Curves, Document, Picture, Section, Table, columns_of, counted, table_of
from gearwhine.results import comparison, condition, operating_point, sound
from gearwhine.results.housing import line_picture, modes_sentence
from gearwhine.results.line_columns import line_frequency
from gearwhine.results.motion import (
    BEARING,
    MECHANISM,
    MESH,
    SENSOR_COLUMNS,
    MeshFigures,
    NamedParts,
    closing,
    damping_sentence,
    leading_lines,
    line_table,
    mesh_sentence,
    path_place,
    sensor_columns,
    shape_column,
)

if TYPE_CHECKING:
    import numpy.typing as npt

    from gearwhine.coupling.analyses.recording import Signals
    from gearwhine.coupling.analyses.run_up import OrderPeak, RunSignature
    from gearwhine.coupling.analyses.signature import ShaftSidebands, SolvedSignature, TracedLine
    from gearwhine.coupling.analyses.transient import SolvedTransient
    from gearwhine.coupling.linear.complex_modes import CoupledModes
    from gearwhine.coupling.signals import LineName
    from gearwhine.coupling.signals.sidebands import Sideband
    from gearwhine.coupling.signals.spectrum import Spectrum

MODAL_COORDINATE = "modal coordinate by unit modal mass; of torsion by unit modal inertia [rad kg0.5 m]"
_HERTZ_LONG = ("Hz", "frequency")


class TracedTransient(NamedTuple):
    """Transient and, where lines are traced, their signature; over a run its orders, where they can be told apart."""

    transient: "SolvedTransient"
    signature: "SolvedSignature | None" = None
    orders: "RunSignature | None" = None


class _Peak(NamedTuple):
    """Peak of a spectrum: with the name of its line and the coupled modes, or, over a run, as what it stands.

    Attributes
    ----------
    peak : Peak
        Over a run with orders the highest amplitude of one, at the frequency that it has there.
    named : LineName or None
        Name of the line; None where lines are not traced.
    modes : CoupledModes or None
        Coupled modes that the name refers to.
    line : TracedLine or None
        The traced line of a sensor.
    over_run : bool
        Whether the speed varies, so that the peak is no line at a constant speed.
    order : OrderPeak or None
        Order of a run of which it is the highest amplitude; None where it is a mean over the run.
    """

    peak: "Peak"
    named: "LineName | None" = None
    modes: "CoupledModes | None" = None
    line: "TracedLine | None" = None
    over_run: bool = False
    order: "OrderPeak | None" = None

    @property
    def frequency_hz(self) -> float:
        """Frequency of the peak [Hz]."""
        return self.peak.frequency

    @property
    def traced(self) -> "_Peak | None":
        """The peak where its line has a name."""
        return None if self.named is None else self

    @property
    def of_run(self) -> "_Peak | None":
        """The peak where it is one over a run."""
        return self if self.over_run else None

    @property
    def over_run_kind(self) -> str:
        """What a peak over a run is."""
        return MEAN_PEAK if self.order is None else ORDER_PEAK

    @property
    def near_mode(self) -> "_NearMode | None":
        """The coupled mode that the line is near to."""
        if self.named is None or self.modes is None or self.named.mode is None:
            return None
        return _NearMode(self.modes, self.named.mode)


class _NearMode(NamedTuple):
    """Coupled modes, and the number of one of them from 0."""

    modes: "CoupledModes"
    mode: int


def _unnamed(row: "_Sensor | _Pair", signal: str, peaks: "list[Peak]") -> list[_Peak]:
    """Peaks without a signature: over a run the highest of its orders; without them the means over the run."""
    if row.orders is None:
        return [_Peak(peak, over_run=row.transient.speed_profile is not None) for peak in peaks]
    return [
        _Peak(Peak(order.frequency_hz, order.highest_amplitude), over_run=True, order=order)
        for order in row.orders.highest_of(signal)
    ]


ORDER_PEAK, MEAN_PEAK = "highest of an order along the run", "mean over the run"
OVER_RUN = (
    Quantity("kind", "over_run_kind"),
    Quantity("name", "order.name", optional=True),
    Quantity("order", "order.order", optional=True),
    Quantity("at_rpm", "order.at_rpm", optional=True),
)
"""Quantities of a peak over a run, which say what it is: no line at a constant speed."""

NAMED = (
    Quantity("name", "named.name"),
    Quantity("kind", "named.kind"),
    Quantity("order", "named.order"),
    Part(
        "near_mode",
        "near_mode",
        (
            Quantity("number", lambda near: near.mode + 1),
            Quantity("kind", lambda near: near.modes.kinds[near.mode]),
            Quantity("where", lambda near: near.modes.where[near.mode]),
            Quantity("frequency_hz", lambda near: near.modes.frequencies_hz[near.mode]),
        ),
    ),
)
"""Quantities of a named peak."""

CONTRIBUTION = (
    Quantity("name"),
    Quantity("amplitude_m_per_s2", lambda part: abs(part.value)),
    Quantity("share"),
    Quantity("number", "mode", optional=True),
)
TRACED = (
    *NAMED,
    Quantity("phase_rad", lambda row: np.angle(row.line.value)),
    Quantity("level_db", "line.level_db"),
    Part(
        "contributions",
        "line",
        (
            Rows("housing_modes", "listed_modes", CONTRIBUTION),
            Rows("bearings", "listed_bearings", CONTRIBUTION),
            Part("free_vibration", "free", CONTRIBUTION),
        ),
    ),
)
"""Quantities of a traced peak."""


def _peaks(key: str, named: Fields) -> Fields:
    """Declare the quantities of a peak, with its amplitude under a key."""
    return (
        Quantity("frequency_hz", "frequency_hz"),
        Quantity(key, "peak.amplitude"),
        Part("", "traced", named),
        Part("", "of_run", OVER_RUN),
    )


class _Sidebands(NamedTuple):
    """Pair of sidebands of a gear mesh, and the shafts that they come from."""

    shafts: "ShaftSidebands"
    pair: "Sideband"


def _sidebands(unit: str) -> tuple[Quantity, ...]:
    """Declare the quantities of a mesh's shaft and one pair of sidebands."""
    return (
        Quantity("gear_pair", "shafts.mesh"),
        Quantity("shafts", "shafts.shafts"),
        Quantity("carrier_hz", lambda row: row.pair.carrier),
        Quantity("number", "pair.number"),
        Quantity("distance_hz", lambda row: row.pair.distance),
        Quantity(f"carrier_amplitude_{unit}", "pair.carrier_amplitude"),
        Quantity(f"lower_amplitude_{unit}", "pair.lower"),
        Quantity(f"upper_amplitude_{unit}", "pair.upper"),
        Quantity("amplitude_modulation", "pair.amplitude_modulation"),
        Quantity("phase_modulation_rad", "pair.phase_modulation"),
    )


class _Sensor(NamedTuple):
    """Transient, its signature where lines are traced, orders of a run, and the name of a sensor."""

    transient: "SolvedTransient"
    signature: "SolvedSignature | None"
    orders: "RunSignature | None"
    name: str


def _sensor_peaks(row: _Sensor) -> list[_Peak]:
    peaks, signature = row.transient.sensor_peaks(row.name).rows, row.signature
    if signature is None:
        return _unnamed(row, row.name, peaks)
    lines = zip(peaks, signature.lines[row.name], strict=True)
    return [_Peak(peak, line.named, signature.modes, line) for peak, line in lines]


def _sensor_sidebands(row: _Sensor) -> Any:
    if row.signature is None:
        return ABSENT
    return _clear(row.signature, row.signature.sidebands[row.name])


def _clear(signature: "SolvedSignature", sidebands: "tuple[ShaftSidebands, ...]") -> list[_Sidebands]:
    return [_Sidebands(*each) for each in signature.clear_sidebands(sidebands)]


SENSOR = (
    Quantity("name"),
    Quantity("rms_m_per_s2", lambda row: row.transient.sensor_rms(row.name)),
    Rows("peaks", _sensor_peaks, _peaks("amplitude_m_per_s2", TRACED)),
    Rows("sidebands", _sensor_sidebands, _sidebands("m_per_s2")),
)
"""Quantities of a sensor."""


class _Pair(NamedTuple):
    """Transient, its signature where lines are traced, orders of a run, and a gear pair's loaded contact and number."""

    transient: "SolvedTransient"
    signature: "SolvedSignature | None"
    orders: "RunSignature | None"
    contact: int
    number: int


def _mesh_figures(row: _Pair) -> MeshFigures:
    return MeshFigures(row.transient.machine.meshes[row.number], row.transient.result, row.contact)


class _OtherFlanks(NamedTuple):
    """Figures of the flanks of a pair that the mean load presses, and of the others."""

    pressed: MeshFigures
    other: MeshFigures

    @property
    def net_mean_force(self) -> float:
        """Mean force of both together [N]."""
        return self.pressed.mean_force - self.other.mean_force

    @property
    def both_apart_fraction(self) -> float:
        """Part of the time that both are apart: the backlash lies between them, so that they never touch at once."""
        return max(self.pressed.contact_loss_fraction + self.other.contact_loss_fraction - 1.0, 0.0)


def _other_flanks(row: _Pair) -> _OtherFlanks | None:
    """Return the flanks that the mean load does not press, where they touched."""
    back, pressed = row.transient.back_flanks(row.number), _mesh_figures(row)
    if back is None:
        return None
    other = pressed._replace(contact=back if row.contact == row.number else row.number)
    return _OtherFlanks(pressed, other) if other.peak_force > 0.0 else None


OTHER_FLANKS = (
    Quantity("mean_force_n", "other.mean_force"),
    Quantity("peak_force_n", "other.peak_force"),
    Quantity("contact_loss_fraction", "other.contact_loss_fraction"),
    Quantity("net_mean_force_n"),
    Quantity("both_apart_fraction"),
)
"""Quantities of the flanks that the mean load does not press; a row is an :class:`_OtherFlanks`."""


def _contact(row: _Pair) -> str:
    """Return the name of the contact that the mean load presses."""
    return str(row.transient.machine.system.contacts[row.contact].name)


def _force_peaks(row: _Pair) -> list[_Peak]:
    peaks, signature = row.transient.force_peaks(_contact(row)).rows, row.signature
    if signature is None:
        return _unnamed(row, _contact(row), peaks)
    names = list(signature.force_lines.values())[row.number]
    return [_Peak(peak, named, signature.modes) for peak, named in zip(peaks, names, strict=True)]


def _force_sidebands(row: _Pair) -> Any:
    if row.signature is None:
        return ABSENT
    return _clear(row.signature, list(row.signature.force_sidebands.values())[row.number])


PAIR = (
    Part("", _mesh_figures, MESH),
    Quantity("flanks", lambda row: "drive" if row.contact == row.number else "back"),
    Part(
        "friction",
        # Force and power over the record.
        lambda row: row.transient.histories.mesh_friction.get(_contact(row)),
        (
            Quantity("mean_power_w", lambda friction: friction[:, 1].mean()),
            Quantity("peak_power_w", lambda friction: friction[:, 1].max()),
            Quantity("peak_force_n", lambda friction: np.abs(friction[:, 0]).max()),
        ),
    ),
    Quantity("back_flank_peak_force_n", lambda row: row.transient.back_flank_peak(row.number)),
    Part("other_flanks", _other_flanks, OTHER_FLANKS),
    Rows("force_peaks", _force_peaks, _peaks("amplitude_n", NAMED)),
    Rows("sidebands", _force_sidebands, _sidebands("n")),
)
"""Quantities of a gear pair."""
MESH_COLUMNS = (*columns_of(MESH), Column("friction takes [W]", "friction.mean_power_w", ".3g"))

CONVENTIONS = {
    "amplitude": "peak: a cosine a cos(2 pi f t + phase) has the amplitude a",
    "phase": "of the cosine at t = 0 of the histories' time axis, also where the record begins later",
    "rms": "without the mean, up to trusted_below_hz",
    "level_db": "20 lg of the rms value of the line over 1e-6 m/s2 (ISO 1683)",
    "parts": "amplitude of the line by each mechanism alone, by the linear model about the mean load, see "
    "coupling.linear.line_mechanisms; parts_together_m_per_s2 is that of their sum with phase, and part_shares are the "
    "parts in phase with the sum, which add up to 1",
    "band_db": "change of the line by all damping doubled and halved, below and above, by the linear model",
    "share": "part of the line in phase with it; shares of modes, and of bearings with free vibration, add up to 1",
}
SIGNATURE = (
    Rows("bearings", lambda row: [NamedParts(*each) for each in row.transient.bearing_parts()], BEARING),
    Rows(
        "gears",
        lambda row: [NamedParts(*each) for each in row.transient.gear_parts()],
        (
            Quantity("name"),
            Quantity("mean_displacement_m", "parts.mean"),
            Quantity("peak_displacement_m", "parts.peak"),
        ),
    ),
    Quantity("conventions", lambda row: CONVENTIONS),
)

RUN = (
    Quantity("from_rpm", lambda solved: solved.speed * solved.speed_profile.speed_ratios[0] * RPM),
    Quantity("to_rpm", lambda solved: solved.speed * solved.speed_profile.speed_ratios[-1] * RPM),
    Quantity("seconds", lambda solved: solved.speed_profile.times[-1]),
    Quantity("revolutions"),
    Quantity("train_inertia_kg_m2", "machine.train_inertia"),
    Part(
        "accelerating_torque_n_m",
        "accelerating_torque",
        (Quantity("least", "0"), Quantity("largest", "1")),
    ),
)
"""Speeds of the first driver's rotor over a run, and the torque on it that changes them."""


def _acceleration(run: Document) -> str:
    """Return a sentence on the driving torque of a run."""
    least, largest = (run["accelerating_torque_n_m"][key] for key in ("least", "largest"))
    between = f"{largest:.3g}" if math.isclose(least, largest, rel_tol=1e-6) else f"{least:.3g} to {largest:.3g}"
    return (
        f"Beside the load, {between} N·m at the first driver accelerate the train, of "
        f"{run['train_inertia_kg_m2']:.3g} kg m² there"
    )


RECORD = (
    Quantity("samples", "record.samples"),
    Quantity("interval_s", "record.sampling.interval"),
    Quantity("decimation", "record.sampling.decimation.factor"),
    Part(
        "spectra",
        ".",
        (
            Quantity("window", "record.sampling.window"),
            Quantity("samples", lambda solved: min(solved.record.sampling.stretch, solved.record.samples)),
            Quantity("averages"),
        ),
    ),
)
"""Length and fineness of the record, and of the stretches that the spectra were taken over."""

ENERGY = tuple(Quantity(key) for key in ("change", "loads", "lost", "teeth", "friction"))


def _trusted(row: TracedTransient) -> dict[str, Any]:
    """Return the frequency up to which a spectrum is complete [Hz]: above it modes of the housing are missing."""
    limit = row.transient.machine.complete_below_hz
    return {} if limit is None else {"trusted_below_hz": limit}


def _spectra(of: Any, name: str, dimension: str, unit: str, quantity: str) -> tuple[Quantity, ...]:
    """Peak amplitudes and phases of the spectra of like signals."""

    def of_each(row: TracedTransient, part: str) -> dict[str, Any] | None:
        return {label: getattr(spectrum, part) for label, spectrum in of(row.transient).items()} or None

    def phases(row: TracedTransient) -> dict[str, Any] | None:
        start = row.transient.record_start
        return {
            label: np.angle(at_time_zero(spectrum.lines, spectrum.frequencies, start))
            for label, spectrum in of(row.transient).items()
        } or None

    def attributes(row: TracedTransient) -> dict[str, Any]:
        first, sampling = next(iter(of(row.transient).values())), row.transient.record.sampling
        values: dict[str, Any] = {"window": first.window} | _trusted(row)
        if sampling.is_long:
            values |= {
                "averages": first.averages,
                "averaged_samples": sampling.stretch,
                "averaging": "root mean square over stretches of whole revolutions, the last of the record",
            }
        return values

    return (
        Quantity(
            "",
            lambda row: next((spectrum.frequencies for spectrum in of(row.transient).values()), None),
            "frequency",
            ("frequency",),
            *_HERTZ_LONG,
        ),
        in_file(
            name,
            (dimension, "frequency"),
            lambda row: of_each(row, "amplitude"),
            f"peak amplitude of {quantity}",
            unit,
            attributes=attributes,
        ),
        in_file(
            f"{name}_phase",
            (dimension, "frequency"),
            phases,
            f"phase of {quantity}: the cosine's at t = 0",
            "rad",
            attributes=_trusted,
        ),
    )


def _load_spectrum(name: str, rows: Any, axis: tuple[str, ...], unit: str, quantity: str) -> Quantity:
    """Peak amplitudes of the loads on bearings; ``rows`` of x, y, z and the moments about x and y."""
    return in_file(
        f"bearing_{name}_spectrum",
        ("bearing", *axis, "frequency"),
        lambda row: (
            {label: load[rows] for label, load in row.signature.bearing_amplitudes(row.transient).items()} or None
        ),
        f"peak amplitude of the {quantity}",
        unit,
        attributes=lambda row: {"window": next(iter(row.signature.bearing_spectra.values())).window} | _trusted(row),
    )


_COMPLEX = in_file("part", "part", lambda table: ["real", "imaginary"])
_LINE = ("sensor", "line")
LINES = (
    in_file("line", "line", "ranks", unit="1"),
    _COMPLEX,
    in_file("mode_path", "mode_path", "modes"),
    in_file("bearing_path", "bearing_path", "bearings"),
    in_file("line_frequency", _LINE, lambda table: table.frequency, "frequency of the sensor's line", "Hz"),
    in_file("line_name", _LINE, "names"),
    in_file("line_amplitude", (*_LINE, "part"), "value", unit="m/s2"),
    in_file("line_by_mode", (*_LINE, "mode_path", "part"), "by_mode", unit="m/s2"),
    in_file("line_by_bearing", (*_LINE, "bearing_path", "part"), "by_bearing", unit="m/s2"),
)
"""Quantities of the lines of all sensors with their parts."""


class _ModalSpectrum(NamedTuple):
    """Names of modal coordinates, their spectrum, and the limit up to which it is whole, as attributes."""

    names: list[str]
    spectrum: "Spectrum"
    trusted: dict[str, Any]


def _modal_spectrum(row: TracedTransient) -> _ModalSpectrum | None:
    spectrum = row.transient.modal_spectrum()
    return None if spectrum is None else _ModalSpectrum(*spectrum, _trusted(row))


MODAL = (
    in_file("modal_coordinate", "modal_coordinate", "names"),
    Quantity("", lambda row: row.spectrum.frequencies, "frequency", ("frequency",), *_HERTZ_LONG),
    in_file(
        "modal_displacement_spectrum",
        "modal_coordinate frequency",
        "spectrum.amplitude",
        f"peak amplitude of the {MODAL_COORDINATE}; its d.c. part at 0 Hz",
        "m kg0.5",
        attributes=lambda row: {"window": row.spectrum.window} | row.trusted,
    ),
)
"""Quantities of the modal spectrum."""


class _HousingLines(NamedTuple):
    """Frequencies up to the limit [Hz], the lines of the housing modes there, their window, and the record's start."""

    frequencies: "npt.NDArray[np.float64]"
    lines: "npt.NDArray[np.complex128]"
    window: str
    record_start: float


def _housing_lines(signature: "SolvedSignature", limit_hz: float) -> _HousingLines | None:
    lines = signature.housing_lines(limit_hz)
    return None if lines is None else _HousingLines(*lines, signature.record_start)


HOUSING_LINES = (
    Quantity("", lambda row: row.frequencies, "housing_line", ("housing_line",), *_HERTZ_LONG),
    _COMPLEX,
    in_file(
        "housing_acceleration_spectrum",
        "housing_mode housing_line part",
        lambda row: np.stack([row.lines.real, row.lines.imag], axis=-1),
        "complex peak amplitude of a housing mode's acceleration at t = 0, by unit modal mass",
        "m kg0.5 s-2",
        attributes=lambda row: {"window": row.window, "record_start_s": row.record_start},
    ),
)
"""Quantities of the spectrum of the housing modes, for operating shapes."""

TRANSIENT: Fields = (
    Quantity("speed_rpm", "transient.speed"),
    Part("run", lambda row: None if row.transient.speed_profile is None else row.transient, RUN),
    Quantity("method", "transient.method"),
    Quantity("steps", "transient.result.steps"),
    Quantity("rejected_steps", "transient.result.rejected"),
    Quantity("smallest_step_s", "transient.result.smallest_step"),
    Quantity("steps_per_second", "transient.steps_per_second"),
    Quantity("energy_error", "transient.result.energy.error"),
    Part("energy_j", "transient.result.energy", ENERGY),
    Quantity("coordinates", "transient.machine.system.size"),
    Quantity("trusted_below_hz", "transient.machine.complete_below_hz"),
    Part("record", "transient", RECORD),
    Rows(
        "sensors",
        lambda row: [_Sensor(row.transient, row.signature, row.orders, name) for name in row.transient.sensor_spectra],
        SENSOR,
    ),
    Rows(
        "gear_pairs",
        lambda row: [
            _Pair(row.transient, row.signature, row.orders, pressed, number)
            for number, pressed in enumerate(row.transient.machine.loaded_contacts)
        ],
        PAIR,
    ),
    *_spectra(lambda solved: solved.sensor_spectra, "sensor_spectrum", "sensor", "m/s2", "acceleration"),
    *_spectra(lambda solved: solved.force_spectra, "mesh_force_spectrum", "contact", "N", "the gear-mesh force"),
    Part(
        "",
        lambda row: None if row.signature is None else row,
        (
            *SIGNATURE,
            Quantity(
                "",
                lambda row: next((spectrum.frequencies for spectrum in row.signature.bearing_spectra.values()), None),
                "frequency",
                ("frequency",),
                *_HERTZ_LONG,
            ),
            _load_spectrum("force", slice(0, 2), ("axis",), "N", "force of the shaft on its bearing"),
            _load_spectrum("axial_force", 2, (), "N", "force of the shaft on its bearing along z"),
            _load_spectrum(
                "moment", slice(3, 5), ("moment_axis",), "N m", "moment of the shaft on its bearing about x and y"
            ),
            Part("", _modal_spectrum, MODAL),
            Part("", lambda row: row.signature.line_table(), LINES),
            Part("", lambda row: _housing_lines(row.signature, row.transient.trusted_limit), HOUSING_LINES),
        ),
    ),
)
"""Quantities of a transient; a row is a :class:`TracedTransient`."""


def transient_document(
    solved: "SolvedTransient", signature: "SolvedSignature | None" = None, orders: "RunSignature | None" = None
) -> dict[str, Any]:
    """Return the transient as the command's JSON; with a signature also the origin of its lines.

    Over a run the peaks of sensors and mesh forces are the highest of its orders, where these are given.
    """
    return document_of(TRANSIENT, TracedTransient(solved, signature, orders))


ORDER = (
    Quantity("signal", heading="signal"),
    Quantity("name", heading="order"),
    Quantity("order"),
    Quantity("highest_amplitude", heading="highest [peak]", shown=".3g"),
    Quantity("unit", heading="unit"),
    Quantity("level_db", "level_db", heading="level [dB]", shown=".1f"),
    Quantity("at_rpm", "at_rpm", heading="at [rpm]", shown=".0f"),
    Quantity("frequency_hz", "frequency_hz", heading="that is [Hz]", shown=".0f"),
)
"""Quantities of the highest amplitude of an order along a run."""

OVERALL = (
    Quantity("signal", heading="signal"),
    Quantity("highest_rms", heading="highest [rms]", shown=".3g"),
    Quantity("unit", heading="unit"),
    Quantity("level_db", "level_db", heading="level [dB]", shown=".1f"),
    Quantity("at_rpm", "at_rpm", heading="at [rpm]", shown=".0f"),
)
"""Quantities of the highest overall level of a signal along a run."""
_LEVELS = "Levels are of rms values, in dB re 1 µm/s² and 1 µN."

_EACH_UNIT = "see run_unit"  # signals differ in their unit


def _run_attributes(signature: "RunSignature") -> dict[str, Any]:
    # Not `trusted_below_hz`: mesh forces among the signals go on beyond it.
    return {"window": "hann", "sensors_complete_below_hz": float(signature.limit)}


def _run_table(name: str, tables: str, dimensions: tuple[str, ...], quantity: str) -> Quantity:
    return in_file(
        name,
        ("run_signal", *dimensions),
        lambda signature: np.array(
            [table.amplitude for table in getattr(signature, tables).values()], dtype=np.float32
        ),
        f"peak amplitude {quantity}",
        _EACH_UNIT,
        attributes=_run_attributes,
    )


def _first(tables: Any) -> Any:
    return next(iter(tables.values()))


RUN_SIGNATURE = (
    Quantity("from_rpm", "speeds_rpm.0"),
    Quantity("to_rpm", lambda signature: signature.speeds_rpm[-1]),
    Quantity("stretches", lambda signature: len(signature.speeds_rpm)),
    Quantity("window_turns", "turns"),
    Quantity("trusted_below_hz", lambda signature: signature.limit),
    Rows("orders", lambda signature: signature.highest(), ORDER),
    Rows("overall", lambda signature: signature.loudest(), OVERALL),
    in_file("run_signal", "run_signal", lambda signature: list(signature.spectra)),
    in_file("run_speed", "run_speed", "speeds_rpm", unit="rpm"),
    Quantity(
        "", lambda signature: _first(signature.spectra).frequencies, "run_frequency", ("run_frequency",), *_HERTZ_LONG
    ),
    in_file(
        "order_speed",
        "order_speed",
        lambda signature: 60.0 * _first(signature.orders).speeds,
        "speed of the leading shaft in the middle of each window",
        "rpm",
    ),
    in_file(
        "order",
        "order",
        lambda signature: _first(signature.orders).orders,
        "cycles each turn of the leading shaft",
        "1",
    ),
    in_file(
        "run_unit", "run_signal", lambda signature: list(signature.units.values()), "unit of the signal's amplitudes"
    ),
    _run_table("run_spectrum", "spectra", ("run_speed", "run_frequency"), "of stretches along the run"),
    in_file(
        "run_overall",
        "run_signal run_speed",
        lambda signature: np.array(list(signature.overall.values()), dtype=np.float32),
        "root mean square over the lines of each stretch, without the mean",
        _EACH_UNIT,
        attributes=_run_attributes,
    ),
    _run_table("run_orders", "orders", ("order_speed", "order"), "by order along the run"),
    in_file("named_order", "named_order", lambda signature: list(signature.named)),
    in_file(
        "run_order_number",
        "named_order",
        lambda signature: list(signature.named.values()),
        "cycles each turn of the leading shaft",
        "1",
    ),
    in_file(
        "run_order_amplitude",
        "run_signal named_order order_speed",
        lambda signature: signature.followed().astype(np.float32),
        "peak amplitude of a shaft's or a mesh's order along the run",
        _EACH_UNIT,
        attributes=_run_attributes,
    ),
)
"""Spectra along a run and orders over its speed, of all signals."""


def run_signature_document(signature: "RunSignature") -> dict[str, Any]:
    """Return the orders of a run as the command's JSON: where each of them is highest."""
    return document_of(RUN_SIGNATURE, signature)


_MODAL = HistoryQuantity(
    "modal_displacement", ("modal_coordinate", "time"), lambda coordinates: coordinates, "m kg0.5", MODAL_COORDINATE
)


@dataclass(frozen=True)
class HistoryStream:
    """Histories of a transient, which are written piece by piece.

    Histories have single precision, seven digits, since there are many; times have double precision.
    """

    solved: "SolvedTransient"

    def labels(self) -> Variables:
        """Coordinates: the names of the signals."""
        coordinates: Variables = {}
        for history, values in _recorded(self.solved.signals):
            coordinates |= history.coordinates(list(values))
        return coordinates

    def append_to(self, path: Path) -> None:
        """Append the histories to a file that holds their coordinates, one piece at a time."""
        record = self.solved.record
        rows = sum(len(values) for _, values in _recorded(self.solved.signals))
        reserve_space(path, record.samples * (8 + 4 * rows))
        with h5netcdf.File(path, "a") as file:
            # As xarray does for the file's other variables.
            beside = {"coordinates": "speed"} if "speed" in file.variables else {}
            file.dimensions["time"] = record.samples
            times = file.create_variable("time", ("time",), "f8", fillvalue=np.nan)
            times.attrs.update(_TIME)
            for history, _ in _recorded(self.solved.signals):
                variable = file.create_variable(history.name, history.dimensions, "f4", fillvalue=np.float32(np.nan))
                variable.attrs.update(self._attributes(history) | beside)
            done = 0
            for piece in record.pieces():
                span = slice(done, done + len(piece.times))
                times[span] = piece.times
                for history, values in _recorded(piece):
                    file.variables[history.name][:, span] = np.array(list(values.values()), dtype=np.float32)
                done = span.stop

    def add_to(self, variables: Variables) -> None:
        """Add the histories in memory, as :meth:`append_to` writes them."""
        times, values_by_name = [], {}  # type: list[Any], dict[str, list[Any]]
        for piece in self.solved.record.pieces():
            times.append(piece.times)
            for history, values in _recorded(piece):
                values_by_name.setdefault(history.name, []).append(np.array(list(values.values()), dtype=np.float32))
        variables["time"] = ("time", np.concatenate(times), dict(_TIME))
        for history, _ in _recorded(self.solved.signals):
            variables[history.name] = (
                history.dimensions,
                np.concatenate(values_by_name[history.name], axis=1),
                self._attributes(history),
            )

    def _attributes(self, history: HistoryQuantity) -> dict[str, Any]:
        """Return the attributes of a history; a filtered one also has its decimation and its own frequency limit."""
        attributes: dict[str, Any] = {"units": history.unit, "long_name": history.what}
        if self.solved.machine.complete_below_hz is not None:
            attributes["trusted_below_hz"] = self.solved.machine.complete_below_hz
        sampling = self.solved.record.sampling
        if sampling.is_long:
            attributes |= {"decimated_by": sampling.decimation.factor, "complete_below_hz": self.solved.trusted_limit}
        return attributes


_TIME = {"units": "s", "long_name": "time from static equilibrium"}


def _recorded(signals: "Signals") -> list[tuple[HistoryQuantity, Any]]:
    """Return every recorded history with the values of each of its signals."""
    recorded = [(history, history.of(signals.histories)) for history in HISTORY_QUANTITIES]
    recorded.append((_MODAL, signals.modal.coordinates))
    return [(history, values) for history, values in recorded if values]


_STEPS = {"newmark": "steps", "exact": "exact elements"}
SPECTRUM = Picture(
    "spectrum",
    "Acceleration of each sensor over frequency, the highest lines with their names; dashed: mesh frequencies and "
    "their multiples, triangles: housing modes. A mesh line close to a mode is loud.",
)
_PICTURES = (
    SPECTRUM,
    Picture(
        "mesh-force",
        "Mesh force over some mesh periods and its spectrum; flanks part where it falls to zero. Lines beside a mesh "
        "harmonic are sidebands where they are whole turns of an imperfect gear's shaft off it, and may else be "
        "harmonics of another mesh.",
    ),
    Picture("orbits", "Orbits of the gears: from rest to their mean place, and about it."),
    Picture("modal-coordinates", "Modal coordinates over time, and their spectra: the modes that answer most."),
    Picture("friction", "Friction between the teeth: force and power over time."),
    Picture(
        "run-up-map",
        "Level over frequency and speed: lines through the origin are orders, upright ones are modes; they meet in "
        "resonances.",
    ),
    Picture("run-up-orders", "Level of each order along the run, and the overall level: peaks are resonances."),
)
_CONTRIBUTIONS = Picture(
    "contributions",
    "Share of housing modes, left, and of bearings, right, in the highest lines of each sensor; red parts are in "
    "opposite phase and cancel others.",
)
_CURVES = (
    Curves("sensor_spectrum", ("frequency",), "Acceleration of the sensors."),
    Curves("mesh_force_spectrum", ("frequency",), "Mesh force."),
    Curves("run_spectrum", ("run_frequency", "run_speed"), "Spectra along the run."),
    Curves("run_order_amplitude", ("order_speed",), "Orders along the run."),
    Curves("run_overall", ("run_speed",), "Overall level along the run."),
)


def report(document: Document) -> Section:
    """Chapter of the report: the motion as the terminal shows it, with meshes, lines and bearings as tables."""
    sentences = [
        f"{document['steps']} steps at {document['speed_rpm']:.0f} rpm, {document['coordinates']} modal coordinates; "
        f"the energy balance closes {closing(document['energy_error'], '.1e')}."
    ]
    if document.get("trusted_below_hz"):
        sentences.append(f"The model's modes are complete up to {document['trusted_below_hz']:.0f} Hz.")
    if document.get("run") is not None:
        sentences.append(f"{_acceleration(document['run'])}.")
    sentences += _basis_error(document)
    sentences += damping_sentence(document)
    tables = (
        *table_of(MESH_COLUMNS, document.get("gear_pairs", ()), "Gear meshes"),
        *_line_table(document),
        *table_of(columns_of(BEARING), document.get("bearings", ()), "Bearings"),
        *table_of(columns_of(OVERALL), document.get("run_signature", {}).get("overall", ()), "Highest overall levels"),
        *table_of(columns_of(ORDER), document.get("run_signature", {}).get("orders", ()), "Orders along the run"),
    )
    if "run_signature" in document:
        sentences.append(_LEVELS)
    inner = _paths(document)
    if "condition" in document:
        inner = (*inner, condition.report(document["condition"]))
    return Section("Motion", (*sentences, *tables), pictures=_PICTURES, inner=inner, curves=_CURVES)


def _line_table(document: Document) -> tuple[Table, ...]:
    """Return the highest lines of the sensors; none over a run with orders, and means over one without."""
    if "run_signature" in document:
        return ()
    caption = "Highest lines of each sensor" if document.get("run") is None else _MEANS
    return line_table(document.get("sensors", ()), "peaks", caption)


def _paths(document: Document) -> tuple[Section, ...]:
    """Return the transfer paths of the highest lines: what each is, and which modes and bearings it comes through."""
    rows = [row for row in leading_lines(document.get("sensors", ()), "peaks") if "contributions" in row]
    note = "Shares in phase with the line, which add up to it: parts above 100 % are cancelled by those below zero."
    columns = (
        Column("sensor", "sensor"),
        line_frequency(),
        *_LINE_COLUMNS,
        *_PATH_COLUMNS,
        shape_column("the housing there"),
    )
    table = table_of(columns, rows, anchor=lambda row: path_place(row["sensor"], row["frequency_hz"]))
    named = {round(row["frequency_hz"], 1): row["name"] for row in rows}
    pictures = (_CONTRIBUTIONS, *(line_picture(hertz, name) for hertz, name in sorted(named.items())))
    return (Section("Paths of the lines", (*table, note), pictures=pictures),) if table else ()


def _basis_error(document: Document) -> list[str]:
    """Return lines on the modal truncation error in responses, the largest in each band."""
    parts = []
    for band in document.get("basis_error", ()):
        largest = max((sensor["largest"] for sensor in band["sensors"]), default=0.0)
        parts.append(f"{100.0 * largest:.2g} % up to {band['to_hz']:.0f} Hz")
    return [f"Error left by the modal basis, at the worst sensor and frequency: {', '.join(parts)}."] if parts else []


SOUND_LEFT_OUT = (
    "Sound: left out of the run; the command sound finds that of the steady motion, run with "
    "acoustics.in_run = true that of its own"
)


def sections(document: Document) -> tuple[Section, ...]:
    """Return the measured comparison, mesh forces, the sensors' lines and their origin, and the proofs."""
    housing = (modes_sentence(document["housing"]),) if "housing" in document else ()
    compared = comparison.sections(document["compare"]) if "compare" in document else ()
    return (Section("", housing), *compared, Section("", tuple(_content(document))))


def _content(document: Document) -> Iterator[str | Table]:
    if "load" in document:
        yield from operating_point.brief(document["load"])
    for pair in document.get("gear_pairs", ()):
        yield mesh_sentence(pair)
        if pair.get("friction"):
            yield f"  friction between its teeth takes {pair['friction']['mean_power_w']:.3g} W"
    run = document.get("run_signature")
    # Over a run whose speed varies a spectrum of the whole record has no lines.
    means = run is None and document.get("run") is not None
    columns = sensor_columns(document)
    columns = columns if run is None and not means else columns[:-1]
    yield from table_of((*columns, _MEAN_COLUMN) if means else columns, document.get("sensors", ()))
    if means and document.get("sensors"):
        yield _MEANS
    yield from _traced_lines(document)
    if document.get("run") is not None:
        yield _acceleration(document["run"])
    if run is not None:
        yield from table_of(columns_of(OVERALL), run.get("overall", ()), "Highest overall levels along the run")
        yield from table_of(columns_of(ORDER), _highest_orders(run["orders"]), "Highest of the orders along the run")
        yield _LEVELS
        yield f"Speed from {run['from_rpm']:.0f} to {run['to_rpm']:.0f} rpm between the first and the last spectrum"
        if any(order["unit"] == "m/s²" for order in run["orders"]) and "trusted_below_hz" in run:
            yield (
                f"Orders of sensors up to {run['trusted_below_hz']:.0f} Hz, where the model is complete; those of mesh "
                "forces go on beyond it"
            )
        if "window_turns" in run:
            yield (
                f"Orders are fitted to windows of {run['window_turns']} turns of the leading shaft: a resonance passed "
                "within one turn is lower than it was"
            )
    if "condition" in document:
        yield from condition.content(document["condition"])
    if "steps" in document:
        yield (
            f"Transient: {document['steps']} {_STEPS[document['method']]}, "
            f"{document['steps_per_second']:.0f} a second; energy balance closes "
            f"{closing(document['energy_error'], '.1e')}; {document['coordinates']} modal coordinates"
        )
    elif "system" in document:
        yield f"Coupled system: {counted(len(document['system']['modes']), 'mode')}"
    if "sound" in document:
        yield from sound.brief(document["sound"])
    if "sound_not_solved" in document:
        yield document["sound_not_solved"]


def _highest_orders(orders: list[Document]) -> list[Document]:
    """Return the orders of each signal with the highest amplitudes, in the sequence of the signals."""
    by_signal: dict[str, list[Document]] = {}
    for order in sorted(orders, key=lambda row: -float(row["highest_amplitude"])):
        by_signal.setdefault(order["signal"], []).append(order)
    signals = dict.fromkeys(order["signal"] for order in orders)
    return [order for signal in signals for order in by_signal[signal][:_HIGHEST_ORDERS]]


_HIGHEST_ORDERS = 3  # of a signal on the terminal
_MEAN_COLUMN = replace(SENSOR_COLUMNS[-1], heading="means over the run: Hz (m/s², peak)")
_MEANS = "Spectrum of the whole run: means over its speeds, at some of which an order reaches more"
_BAND = ("band_db.0", "band_db.1")
_LINE_COLUMNS = (
    Column("dB", "level_db", shown=lambda row: f"{row['level_db']:.0f}{_band(row)}", numbers=_BAND),
    Column("what it is", lambda row: row["name"] if row["kind"] != "mode" else f"free {row['name']}"),
    MECHANISM,
    Column("near", lambda row: _near(row["near_mode"]), numbers=("near_mode.frequency_hz",)),
)
_PATH_COLUMNS = (
    Column(
        "by housing modes",
        lambda row: ", ".join(
            f"{part.get('number', 'local')}: {_share(part)}" for part in row["contributions"]["housing_modes"][:3]
        ),
        numbers=("contributions.housing_modes",),
    ),
    Column(
        "by bearings",
        lambda row: ", ".join(f"{part['name']}: {_share(part)}" for part in _with_free(row["contributions"])[:3]),
        numbers=("contributions.bearings", "contributions.free_vibration"),
    ),
)


def _traced_lines(document: Document) -> Iterator[Table | str]:
    """Yield the leading lines with what excites them, and the housing modes and bearings that they come through."""
    rows = [
        peak | {"sensor": sensor["name"]}
        for sensor in document.get("sensors", ())
        for peak in sensor["peaks"][:3]
        if "contributions" in peak
    ]
    place = (Column("sensor", "sensor"), Column("Hz", "frequency_hz", ".0f"))
    yield from table_of((*place, *_LINE_COLUMNS), rows, "Highest lines: levels, and what excites them")
    yield from table_of((*place, *_PATH_COLUMNS), rows, "Paths of the highest lines: leading parts of each")
    if rows:
        yield (
            "Levels of rms values re 1 µm/s², with what all damping doubled and halved changes. What excites a line by "
            "the linear model, each alone; with phase they add up to it. Shares are in phase with the line and add up "
            "to it; of parts that cancel each other some exceed 100 %."
        )


def _band(row: Document) -> str:
    """Return a line's band by damping in whole decibels, such as `` -3 +1``; empty where there is none."""
    band = row.get("band_db")
    return "" if band is None else " {:+z.0f} {:+z.0f}".format(*band)


def _near(mode: Document | None) -> str:
    return "" if mode is None else f"{mode['frequency_hz']:.0f} Hz {mode['kind']}"


def _with_free(parts: Document) -> list[Document]:
    """Bearings, and free vibration where it counts."""
    return sorted([*parts["bearings"], parts["free_vibration"]], key=lambda part: -abs(part["share"]))


def _share(part: Document) -> str:
    return f"{100.0 * part['share']:z.0f} %"
