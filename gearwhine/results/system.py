"""Coupled system: quantities of its modes, stability, responses and Campbell diagram, and how they are shown."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gearwhine.output.quantity import ABSENT, HERTZ, RPM, Fields, Getter, Part, Quantity, Rows, document_of, in_file
from gearwhine.output.sections import (
    Column,
    Curves,
    Document,
    Picture,
    Section,
    Table,
    arrowed,
    columns_of,
    counted,
    significant,
    table_of,
)
from gearwhine.output.store import Option, kept_sentence
from gearwhine.results.housing import STATIC_ERROR, static_error, static_error_sentence
from gearwhine.results.mesh_lines import LINE_LIMITS, line_content
from gearwhine.results.motion import damping_sentence, gear_body_lines
from gearwhine.results.operating_point import brief

if TYPE_CHECKING:
    import numpy.typing as npt

    from gearwhine.coupling.analyses.modes_and_responses import SolvedSystem
    from gearwhine.coupling.linear.campbell import SystemCampbell, SystemCrossing
    from gearwhine.coupling.linear.frequency_response import FrequencyResponse
    from gearwhine.coupling.linear.lines_over_speed import LinesOverSpeed
    from gearwhine.coupling.linear.mesh_harmonics import ResponseParts
    from gearwhine.housing import HousingModes

_GROUPS = {"component": "components", "connector": "bearings", "contact": "gear_meshes"}


class _Mode(NamedTuple):
    """Coupled system, and the number of a mode from 0."""

    system: "SolvedSystem"
    mode: int

    @property
    def number(self) -> int:
        """Number of the coupled mode."""
        return self.mode + 1

    @property
    def frequency_hz(self) -> float:
        """Coupled natural frequency [Hz]."""
        return float(self.system.modes.frequencies_hz[self.mode])

    @property
    def damping_ratio(self) -> float:
        """Coupled damping ratio."""
        return float(self.system.modes.damping_ratios[self.mode])

    @property
    def exponent(self) -> complex | None:
        """Floquet exponent of the mode in the machine whose directions turn [1/s]."""
        exponents = self.system.exponents
        return None if exponents is None or np.isnan(exponents[self.mode]) else complex(exponents[self.mode])

    @property
    def damped_frequency(self) -> float:
        """Frequency of the damped motion [rad/s]."""
        return abs(float(self.system.modes.eigenvalues[self.mode].imag))

    @property
    def kind(self) -> str:
        """What moves most."""
        return self.system.modes.kinds[self.mode]

    @property
    def planetary(self) -> str:
        """Kind of the mode in a planetary set, and the set's carrier; empty for other modes."""
        return self.system.modes.planetary[self.mode]

    @property
    def where(self) -> str:
        """Where it moves most."""
        return self.system.modes.where[self.mode]

    @property
    def energy(self) -> Any:
        """Shares of the kinetic energy by kind, and of the teeth in the strain energy."""
        return self.system.modes.energy[self.mode]

    @property
    def strained_most(self) -> dict[str, Any] | None:
        """Part with the most strain energy; None in a rigid mode, which strains nothing."""
        if self.kind == "rigid":
            return None
        shares = self.system.modes.shares
        part, share = max(zip(shares.parts, shares.strain[self.mode].tolist(), strict=True), key=lambda pair: pair[1])
        return {"kind": _GROUPS[part.kind], "name": part.name, "share": share}

    @property
    def whirl(self) -> float | None:
        """Circularity of the rotor that the mode bends; None of a mode of something else."""
        names = [component.name for component in self.system.machine.system.components]
        if self.kind != "rotor" or self.where not in names:
            return None
        whirl = float(self.system.modes.whirl[self.mode][names.index(self.where)])
        return None if np.isnan(whirl) else whirl


def _of_components(name: str, long_name: str, of: Any) -> Quantity:
    """Declare a quantity of every component in a mode, for the file; ``of`` takes the values of all modes."""

    def values(row: _Mode) -> dict[str, float]:
        system, mode = row
        names = [component.name for component in system.machine.system.components]
        return dict(zip(names, of(system.modes)[mode].tolist(), strict=True))

    return in_file(f"system_{name}", "machine_component", values, long_name, "1")


def _of_parts(name: str, long_name: str, of: Any) -> Quantity:
    """Declare a quantity of every component, connector and contact in a mode, for the file."""

    def values(row: _Mode) -> dict[str, float]:
        system, mode = row
        names = [f"{part.kind}: {part.name}" for part in system.modes.shares.parts]
        return dict(zip(names, of(system.modes.shares)[mode].tolist(), strict=True))

    return in_file(f"system_{name}", "machine_part", values, long_name, "1")


def _turning(of: Callable[[complex], float]) -> Getter:
    """Return the getter of a figure of a mode's exponent: absent where no directions turn, null where not solved."""

    def figure(row: _Mode) -> Any:
        if row.system.exponents is None:
            return ABSENT
        return None if row.exponent is None else of(row.exponent)

    return figure


MODE = (
    in_file("system_mode", "", "number", unit="1"),
    Quantity("frequency_hz", "frequency_hz", "system_frequency", heading="frequency [Hz]", shown="z.2f"),
    Quantity("damping_ratio", "damping_ratio", "system_damping_ratio", unit="1", heading="damping ratio", shown="z.4f"),
    Quantity("damped_frequency_hz"),
    Quantity("turning_frequency_hz", _turning(lambda exponent: abs(exponent) / HERTZ)),
    Quantity("turning_damping_ratio", _turning(lambda exponent: -exponent.real / abs(exponent))),
    Quantity("kind", "kind", "system_kind", heading="kind", shown=lambda row: _named(row)),
    Quantity("where", "where", "system_where"),
    Quantity("planetary", lambda row: row.planetary or ABSENT),
    Quantity("energy"),
    Quantity("strained_most"),
    Quantity("whirl", optional=True),
    _of_components("kinetic_share", "share of the kinetic energy", lambda modes: modes.shares.kinetic),
    _of_parts("strain_share", "share of the strain energy", lambda shares: shares.strain),
    _of_parts("damping_share", "part of the damping ratio", lambda shares: shares.damping),
    _of_components("whirl", "bending: 1 counter-clockwise, -1 clockwise circles", lambda modes: modes.whirl),
)
"""Quantities of a mode."""


def _mesh_stiffness(solved: "SolvedSystem") -> list[dict[str, Any]]:
    """Return the mesh stiffness at which each loaded flank is linearised, beside its mean without load.

    It is that between the rims; the gears' bodies on their shafts are in series with it.
    """
    contact, unloaded = solved.contact, solved.unloaded.stiffness
    rows = []
    for number, tooth in enumerate(solved.machine.system.contacts):
        if not tooth.loaded:
            continue
        force = None if contact.force is None else float(contact.force[number])
        behind = solved.machine.meshes[solved.machine.flanks(number)[0]].behind_rims
        if force is None:
            linearisation = "tangent at the mesh phase"
        elif contact.stiffness[number] == 0.0:
            linearisation = "parted by the mean load"
        else:
            linearisation = "mean under load" if force else "mean without load"
        rows.append(
            {
                "name": tooth.name,
                "taken": linearisation,
                "stiffness_n_per_m": contact.stiffness[number],
                "unloaded_mean_n_per_m": unloaded[number],
                "bodies_n_per_m": None if behind == 0.0 else 1.0 / behind,
                "force_n": force,
            }
        )
    return rows


CERTIFICATE = (
    Quantity("expected"),
    Quantity("found"),
    Quantity("zeros"),
    Quantity("max_residual"),
    Quantity("sum_rule"),
    Quantity("complete", "is_complete"),
)

STABILITY = (
    Quantity("stable", "stability.stable"),
    Rows(
        "growing",
        "stability.growing",
        (
            Quantity("frequency_hz", lambda mode: abs(mode.eigenvalue) / HERTZ),
            Quantity("damping_ratio"),
            Quantity("doubling_time_s"),
            Quantity("kind"),
            Quantity("where"),
            Quantity(
                "fed_by",
                lambda mode: [{"kind": part.kind, "name": part.name, "share": share} for part, share in mode.feeders],
            ),
        ),
    ),
    Part(
        "least_damped",
        lambda solved: None if solved.stability.least_damped is None else _Mode(solved, solved.stability.least_damped),
        tuple(
            replace(quantity, name="")
            for quantity in MODE
            if quantity.key in ("frequency_hz", "damping_ratio", "kind", "where")
        ),
    ),
)


class _Response(NamedTuple):
    """Frequency response, and its abscissa: frequencies [Hz], or absolute speeds of the first driver [rpm]."""

    response: "FrequencyResponse"
    along: "npt.NDArray[np.float64]"


def _response(name: str, abscissa: str, key: str, per: str) -> Fields:
    """Declare the fields of a frequency response: its curves in the file, and their peaks in the document.

    Complex curves are declared as amplitude and phase; ``key`` is the abscissa of the peaks.
    """

    def curves(
        of: Any, signal: str, kind: str, planes: tuple[str, ...], unit: str, quantity: str
    ) -> Iterator[Quantity]:
        dimensions = (f"{name}_{signal}", abscissa, *planes)
        for suffix, part, units, long_name in (
            ("", np.abs, f"{unit} {per}".strip(), f"{quantity}, peak"),
            ("_phase", np.angle, "rad", f"phase of the {quantity}"),
        ):

            def values(row: _Response, part: Any = part) -> dict[str, Any] | None:
                return {label: part(curve) for label, curve in of(row.response).items()} or None

            yield in_file(f"{name}_{signal}_{kind}{suffix}", dimensions, values, long_name, units)

    def loads(columns: Any) -> Any:
        return lambda response: {label: load[:, columns] for label, load in response.bearing_load.items()}

    def peaks(row: _Response, curve: Any) -> list[dict[str, float]]:
        response, along = row
        return [{key: along[place], "amplitude": abs(curve[place])} for place in response.peaks(curve)]

    def along_axes(first: int, axes: str) -> Any:
        return lambda row: {
            label: {axis: peaks(row, load[:, first + place]) for place, axis in enumerate(axes)}
            for label, load in row.response.bearing_load.items()
        }

    force = "force of the shaft on its bearing"
    return (
        Quantity("excitation", "response.excitation"),
        Quantity("per", "response.unit"),
        Quantity(
            "mesh_force_n", lambda row: {label: peaks(row, force) for label, force in row.response.mesh_force.items()}
        ),
        Quantity("bearing_force_n", along_axes(0, "xyz")),
        Quantity("bearing_moment_n_m", along_axes(3, "xy")),
        Quantity(
            "sensor_acceleration_m_per_s2",
            lambda row: {label: peaks(row, signal) for label, signal in row.response.sensor_acceleration.items()},
        ),
        *curves(
            lambda response: response.sensor_acceleration,
            "sensor",
            "acceleration",
            (),
            "m s-2",
            "acceleration along the sensor",
        ),
        *curves(loads(slice(0, 2)), "bearing", "force", ("plane",), "N", force),
        *curves(loads(2), "bearing", "axial_force", (), "N", f"{force} along z"),
        *curves(
            loads(slice(3, 5)),
            "bearing",
            "moment",
            ("plane",),
            "N m",
            "moment of the shaft on its bearing about x and y",
        ),
        *curves(
            lambda response: response.mesh_force, "mesh", "force", (), "N", "gear-mesh force along the line of action"
        ),
        in_file("plane", "plane", lambda row: ["x", "y"] if row.response.bearing_load else None, common=True),
    )


TRANSMISSIBILITY = (
    in_file("mesh_error", "", "response.excitation"),
    in_file("response_frequency", "response_frequency", lambda row: row.along, "frequency", "Hz", common=True),
    *_response("transmissibility", "response_frequency", "frequency_hz", "m-1"),
)
"""Quantities of the response to the error of one mesh."""

_PARTS = (
    ("by_transmission_error", "transmission_error", "by transmission error alone"),
    ("by_varying_stiffness", "varying_stiffness", "by the mesh stiffness that varies alone"),
    ("by_load_shuttling", "load_shuttling", "by load shuttling alone"),
    ("by_friction", "friction", "by tooth friction alone"),
    ("together", None, "by all of these mechanisms of its meshes together, without what else excites there"),
)
_LINE_CONVENTIONS = {
    "together": "with by_...: what the meshes that drive a line make of it, teeth alike, summed with phase",
    "parts_together_m_per_s2": "with parts: all that excites at the frequency, pitch deviations, runout, unbalance, "
    "ripple and base too, summed with phase",
}


class _Line(NamedTuple):
    """Coupled system, and its response at a mesh harmonic."""

    system: "SolvedSystem"
    line: "ResponseParts"


def _line_part(name: str, mechanism: str | None, part: str) -> Quantity:
    """Declare the amplitudes of the sensors by a mechanism of a line, or by all."""

    def of(row: _Line) -> dict[str, float] | object:
        motion = row.line.motion if mechanism is None else row.line.parts.get(mechanism)
        if motion is None:
            return ABSENT
        motion = row.line.frequency**2 * motion
        return {sensor: abs(sensor_row @ motion) for sensor, sensor_row in row.system.machine.sensor_rows.items()}

    long_name = f"amplitude of the sensor's acceleration at a mesh harmonic, {part}"
    return Quantity(name, of, f"system_line_{name}", ("system_line_sensor",), "m s-2", long_name=long_name)


def _of_turning(attribute: str) -> Any:
    """Return the getter of an attribute that lines have where directions turn with a carrier."""

    def value(row: _Line) -> Any:
        found = getattr(row.line, attribute) if row.line.sidebands else None
        return ABSENT if found is None else found

    return value


LINE = (
    Quantity(
        "frequency_hz", "line.frequency", "system_line_frequency", long_name="frequency of a mesh harmonic at operation"
    ),
    Quantity(
        "cause",
        lambda row: row.line.cause(row.system.machine),
        "system_line_cause",
        long_name="mesh harmonics that drive the line, and the turns of carriers that it is off them",
    ),
    Quantity("kind", _of_turning("kind"), "system_line_kind"),
    Quantity("order", lambda row: row.line.frequency / abs(row.system.speed), "system_line_order", unit="1"),
    Quantity("harmonic", _of_turning("harmonic")),
    Quantity("turns", _of_turning("turns")),
    Quantity(
        "phasing",
        _of_turning("phasing"),
        "system_line_phasing",
        unit="1",
        long_name="motion of the housing by all planets over the sum of its motions by each planet's meshes alone",
    ),
    Quantity("ideal_phasing", _of_turning("ideal_phasing")),
    Quantity("suppressed", _of_turning("is_suppressed")),
    Part("sensor_acceleration_m_per_s2", ".", tuple(_line_part(*part) for part in _PARTS)),
)
"""Quantities of a mesh harmonic at operation."""

UNBALANCE = (
    in_file("unbalance_of", "", "response.excitation"),
    in_file(
        "unbalance_response_frequency",
        "unbalance_speed",
        lambda row: np.abs(row.response.frequencies) / HERTZ,
        "frequency of the motion at each speed",
        "Hz",
    ),
    *_response("unbalance_response", "unbalance_speed", "speed_rpm", ""),
)
"""Quantities of the response to one rotor's unbalances over absolute speeds of the first driver."""


class _Crossing(NamedTuple):
    """Crossing of the Campbell diagram, and the speed of operation [rad/s]."""

    crossing: "SystemCrossing"
    operation: float


CROSSING = (
    Quantity("speed_rpm", "crossing.speed", "system_crossing_speed"),
    Quantity("line", "crossing.line.name", "system_crossing_line"),
    Quantity("order", "crossing.line.order", "system_crossing_order", unit="1"),
    Quantity(
        "frequency_hz",
        "crossing.eigenvalue.imag",
        "system_crossing_frequency",
        long_name="damped frequency at the crossing",
    ),
    Quantity("damping_ratio", "crossing.damping_ratio", "system_crossing_damping_ratio", unit="1"),
    Quantity("branch", "crossing.branch"),
    Quantity("kind", "crossing.kind"),
    Quantity("where", "crossing.where"),
    Quantity("teeth", "crossing.teeth"),
    Quantity("margin", lambda row: row.crossing.speed / row.operation - 1.0),
)
"""Quantities of a crossing of the Campbell diagram."""


def _diagram(name: str, of: Getter, unit: str, long_name: str = "") -> Quantity:
    """Declare a quantity of every branch over speed, for the file."""
    return in_file(f"system_campbell_{name}", "system_speed system_branch", of, long_name, unit)


def _turning_diagram(name: str, of: str, unit: str, long_name: str) -> Quantity:
    """Declare a quantity of the exponents of every branch over speed, for the file; absent where no directions turn."""
    dimensions = ("system_speed", "system_branch")
    return in_file(f"system_campbell_turning_{name}", dimensions, of, long_name, unit, optional=True)


class _Campbell(NamedTuple):
    """Campbell diagram, and the speed of operation [rad/s]."""

    diagram: "SystemCampbell"
    operation: float


class _Branch(NamedTuple):
    """Campbell diagram, and the number of a branch from 0."""

    diagram: "SystemCampbell"
    branch: int


def _along_branch(attribute: str) -> Getter:
    """Return the getter of a figure of the exponents along a branch: absent where no directions turn."""

    def figures(row: _Branch) -> Any:
        values = getattr(row.diagram, attribute)
        if values is None:
            return ABSENT
        return [None if np.isnan(value) else float(value) for value in values[:, row.branch]]

    return figures


CAMPBELL = (
    Quantity("speeds_rpm", "diagram.speeds", "system_campbell_speed", ("system_speed",)),
    _diagram("frequency", "diagram.frequencies_hz", "Hz", "damped frequency of the coupled modes over speed"),
    _diagram("damping_ratio", "diagram.damping_ratios", "1", "damping ratio of the coupled modes over speed"),
    _turning_diagram("frequency", "diagram.turning_frequencies_hz", "Hz", "damped frequency with turning carriers"),
    _turning_diagram("damping_ratio", "diagram.turning_damping_ratios", "1", "damping ratio with turning carriers"),
    _turning_diagram("observed", "diagram.observed_hz", "Hz", "frequency at which fixed sensors see the mode most"),
    _diagram("whirl", "diagram.whirl", "1", "sense of the rotor that bends most, 1 counter-clockwise"),
    _diagram("teeth", "diagram.teeth", "1"),
    _diagram("kind", lambda row: row.diagram.kinds.astype(str), "", "kind"),
    _diagram("where", lambda row: row.diagram.where.astype(str), "", "where"),
    Rows(
        "branches",
        lambda row: [_Branch(row.diagram, branch) for branch in range(row.diagram.eigenvalues.shape[1])],
        (
            Quantity("frequency_hz", lambda row: row.diagram.frequencies_hz[:, row.branch]),
            Quantity("damping_ratio", lambda row: row.diagram.damping_ratios[:, row.branch]),
            Quantity("turning_frequency_hz", _along_branch("turning_frequencies_hz")),
            Quantity("turning_damping_ratio", _along_branch("turning_damping_ratios")),
            Quantity("observed_hz", _along_branch("observed_hz")),
            Quantity("kind", lambda row: row.diagram.kinds[:, row.branch]),
            Quantity("where", lambda row: row.diagram.where[:, row.branch]),
        ),
    ),
    Quantity(
        "lines", lambda row: [{"name": line.name, "kind": line.kind, "order": line.order} for line in row.diagram.lines]
    ),
    Rows(
        "crossings",
        lambda row: [_Crossing(crossing, row.operation) for crossing in row.diagram.crossings],
        CROSSING,
        "system_crossing",
    ),
    Quantity("unsettled", "diagram.unsettled"),
)
"""Quantities of the Campbell diagram."""


def _unbalance(solved: "SolvedSystem") -> Any:
    if solved.unbalance_speeds is None:
        return ABSENT
    along = np.abs(solved.unbalance_speeds * RPM)
    return [_Response(response, along) for response in solved.unbalance]


class _OrderLine(NamedTuple):
    """Mesh harmonics over speed, and one of them."""

    over: "LinesOverSpeed"
    number: int

    def highest(self) -> dict[str, dict[str, float]]:
        """Highest amplitude [m/s²] at each sensor, and the speed [rpm] and frequency [Hz] of it."""
        found = {}
        for sensor, amplitudes in zip(self.over.sensors, self.over.amplitudes[:, :, self.number], strict=True):
            place = int(np.nanargmax(amplitudes))
            speed = abs(float(self.over.speeds[place]))
            frequency = float(self.over.orders[self.number]) * speed / HERTZ
            found[sensor] = {
                "amplitude_m_per_s2": float(amplitudes[place]),
                "speed_rpm": speed * RPM,
                "frequency_hz": frequency,
            }
        return found


ORDER_LINE = (
    Quantity("order", lambda row: row.over.orders[row.number], "order_line_order", unit="1"),
    Quantity(
        "cause",
        lambda row: row.over.causes[row.number],
        "order_line_cause",
        long_name="mesh harmonics that drive the line",
    ),
    Quantity("highest", lambda row: row.highest()),
    in_file(
        "order_line_amplitude",
        ("order_line_sensor", "order_line_speed"),
        lambda row: dict(zip(row.over.sensors, row.over.amplitudes[:, :, row.number], strict=True)),
        "amplitude of the sensor's acceleration at a mesh harmonic; none, as NaN, above the limit of the modes",
        "m s-2",
    ),
)
"""Quantities of a mesh harmonic at the sensors over speed."""


def _order_lines(solved: "SolvedSystem") -> Any:
    if solved.order_lines is None:
        return ABSENT
    known = np.isfinite(solved.order_lines.amplitudes).any(axis=(0, 1))
    return [_OrderLine(solved.order_lines, number) for number in np.flatnonzero(known).tolist()]


SYSTEM = (
    Quantity("speed_rpm"),
    Quantity("mesh_phase"),
    Quantity("mesh_stiffness", _mesh_stiffness),
    in_file(
        "machine_component",
        "machine_component",
        lambda solved: [component.name for component in solved.machine.system.components],
        "component of the machine",
    ),
    in_file(
        "machine_part",
        "machine_part",
        lambda solved: [f"{part.kind}: {part.name}" for part in solved.modes.shares.parts],
        "component, connector or contact",
    ),
    Rows("modes", lambda solved: [_Mode(solved, mode) for mode in range(len(solved.modes.kinds))], MODE, "system_mode"),
    Quantity("coordinates", "machine.system.size"),
    Part("certificate", "modes.certificate", CERTIFICATE),
    Part("stability", ".", STABILITY),
    Rows(
        "transmissibility",
        lambda solved: [_Response(response, response.frequencies / HERTZ) for response in solved.responses],
        TRANSMISSIBILITY,
        "mesh_error",
    ),
    Rows(
        "mesh_lines",
        lambda solved: [_Line(solved, line) for line in solved.lines] if solved.lines else ABSENT,
        LINE,
        "system_line",
    ),
    Quantity("conventions", lambda solved: _LINE_CONVENTIONS if solved.lines else ABSENT),
    LINE_LIMITS,
    Quantity("superposition_error"),
    Quantity("trusted_below_hz", "machine.complete_below_hz"),
    Part(
        "campbell",
        lambda solved: ABSENT if solved.campbell is None else _Campbell(solved.campbell, solved.speed),
        CAMPBELL,
    ),
    in_file(
        "unbalance_speed",
        "unbalance_speed",
        lambda solved: solved.unbalance_speeds * RPM if solved.unbalance else None,
        "speed of the first driver",
        "rpm",
    ),
    Rows("unbalance_response", _unbalance, UNBALANCE, "unbalance_of"),
    in_file(
        "order_line_speed",
        "order_line_speed",
        lambda solved: None if solved.order_lines is None else np.abs(solved.order_lines.speeds) * RPM,
        "speed of the first driver",
        "rpm",
    ),
    in_file(
        "order_line_rms",
        ("order_line_sensor", "order_line_speed"),
        lambda solved: (
            None
            if solved.order_lines is None
            else dict(zip(solved.order_lines.sensors, solved.order_lines.rms, strict=True))
        ),
        "rms of the sensor's acceleration by all lines of the meshes below the limit of the modes",
        "m s-2",
    ),
    Rows("order_lines", _order_lines, ORDER_LINE, "order_line"),
)
"""Quantities of the coupled system, linear about a contact."""


SYSTEM_OPTIONS = (
    Option(
        ("campbell", "unbalance_response", "order_lines"),
        ("system_speed", "system_branch", "system_crossing", "unbalance_", "order_line"),
        "system-[co]*.png",
    ),
)
"""Options of the coupled system."""

SYSTEM_SAME = ("speed_rpm", "mesh_phase", "mesh_stiffness", "modes")
"""Keys of the coupled system that no option over speed changes."""


def system_document(solved: "SolvedSystem", housing: "HousingModes | None" = None) -> dict[str, Any]:
    """Return the coupled system as the command's JSON, without the curves of the results file.

    ``housing`` gives the static error of its modes at the bearings.
    """
    of_housing = (Part("static_error", static_error, STATIC_ERROR),)
    return document_of(SYSTEM, solved) | document_of(of_housing, housing)


_NAMES = {"components": "", "bearings": "", "gear_meshes": "teeth of "}
_CROSSINGS = 30  # shown at most, those nearest to operation
_ORDER_LINES = 3  # mesh harmonics over speed shown of each sensor
_NEAR_MODE = 0.02  # part of a line's frequency that a mode near it is off at most
_WHIRL = 0.5  # circularity from which a sense of whirl is named
UNDAMPED_RATIO = 1e-3
"""Damping ratio of a mode below which the height of its peak says nothing: the model lacks what damps it."""
_PEAK_OF_MODE = 5e-3  # part of a peak's frequency that the mode behind it is off


def report(document: Document) -> Section:
    """Chapter of the report."""
    content = (*_content(document), *damping_sentence(document))
    return Section("Coupled system", content, pictures=_PICTURES, curves=_CURVES)


_PICTURES = (
    Picture(
        "campbell",
        "Campbell diagram of the coupled machine: an order that meets a mode at a speed is a resonance there.",
    ),
    Picture(
        "system-order-lines",
        "Lines of the meshes over speed at each sensor, by linear response about the mean load: the highest mesh "
        "harmonics, and all together.",
    ),
    Picture(
        "transmissibility",
        "Response to 1 µm of transmission error alone at any frequency: mesh force, bearing forces and sensors; "
        "dashed: mesh frequencies at operation. A peak at a dashed line is a loud mesh. Load shuttling of helical, "
        "crowned or misaligned teeth excites beside it and may lead: see the lines of the sensors.",
    ),
    Picture(
        "system-lines",
        "Lines of the sensors at operation: mesh harmonics and their sidebands by the turning of the carriers.",
    ),
    Picture("system", "Coupled modes of the machine."),
)
_CURVES = (
    Curves(
        "transmissibility_sensor_acceleration",
        ("response_frequency",),
        "Acceleration of the sensors by transmission error alone.",
    ),
    Curves("transmissibility_mesh_force", ("response_frequency",), "Dynamic mesh force by transmission error alone."),
)


def sections(document: Document) -> tuple[Section, ...]:
    """Coupled modes, up to twice the frequency below which the housing's modes are all there, and what follows."""
    return (Section("", tuple(_content(document))),)


def _content(document: Document) -> Iterator[str | Table]:
    if "stability" in document:
        yield from _stability(document["stability"], document["modes"], document.get("trusted_below_hz"))
    yield from _highest_line(document)
    if "load" in document:
        yield from brief(document["load"])
    modes, trusted = document["modes"], document.get("trusted_below_hz")
    within = [mode for mode in modes if not trusted or mode["frequency_hz"] <= 2.0 * trusted]
    listed = [mode for mode in within if mode["kind"] != "residual"]
    phase = document.get("mesh_phase")
    about = "" if phase is None else f", the first pair's teeth at {phase:g} of their period"
    yield f"{document['coordinates']} coordinates at {document['speed_rpm']:.0f} rpm{about}"
    meshes = document.get("mesh_stiffness", ())
    if len(meshes) > _MOST_MESH_SENTENCES:
        yield from table_of(_MESH_COLUMNS, meshes, "Mesh stiffness [N/µm] between the rims, in series with the bodies")
    else:
        yield from map(_mesh_sentence, meshes)
    yield from (f"Gear body {line}." for line in gear_body_lines(document))
    yield from table_of(mode_columns(listed), listed)
    yield "Shares of the kinetic energy; teeth: share of the strain energy." + _whirl_legend(listed)
    if sets := sorted({carrier for mode in listed if (carrier := _set_of(mode))}):
        yield (
            f"Rotational, translational, planet and mixed modes: those of the planetary set{'s' * (len(sets) > 1)} of "
            f"{', '.join(sets)}; mixed ones are none of the three, as where planets or the housing differ all round."
        )
    if residual := len(within) - len(listed):
        yield f"Left out: {counted(residual, 'residual mode')}, local compliance at the seats, no modes of the housing."
    if certificate := document.get("certificate"):
        yield (
            f"{certificate['found']} of {certificate['expected']} eigenvalues found, {certificate['zeros']} of them "
            f"zero; residuals up to {certificate['max_residual']:.0e}, sum rule {_sum_rule(certificate)}."
        )
    if error := document.get("static_error"):
        yield static_error_sentence(error)
    if trusted and len(within) < len(modes):
        yield f"{counted(len(modes) - len(within), 'more mode')} above {2.0 * trusted:.5g} Hz."
    responses = document.get("transmissibility", ())
    turning = any("turning_frequency_hz" in mode for mode in modes)
    if turning and len(responses) > 1:
        yield from _peaks_of_all(responses, modes)
    else:
        for response in responses:
            yield from _peaks(response, modes)
    if any(_is_undamped(peak, modes) for response in responses for peak in _listed_peaks(response)):
        yield (
            f"Undamped: peaks at modes whose damping ratio is below {UNDAMPED_RATIO:g}, which come last, as damping "
            "that the model lacks decides their height. Often nothing damps the motion along an axis: give bearings "
            "damping along z."
        )
    if responses:
        yield (
            "These are by transmission error alone. Load shuttling, the moments of a load that moves along the face, "
            "excites at the same frequencies and may lead in helical, crowned or misaligned teeth: "
            "`load --sensitivity` has the lines by all of these and what changes them, `steady` the motion."
        )
    if responses and turning:
        yield "They are the motions at the frequency of the error; the lines below have the sidebands beside it."
    yield from line_content(document)
    if campbell := document.get("campbell"):
        yield from _crossings(campbell)
        if turning and "order_lines" not in document:
            yield (
                "Lines of the meshes over speed are left out where carriers turn: `sweep` over the speed has them with "
                "their sidebands"
            )
    yield from _over_speed(document)
    yield from kept_sentence(document, SYSTEM_OPTIONS, "modes")


def _sum_rule(certificate: Document) -> str:
    """Return how well the modes keep their sum rule, and what follows where they miss it."""
    size = f"{certificate['sum_rule']:.0e}"
    if certificate["complete"]:
        return f"kept to {size}"
    return (
        f"missed by {size}: two of the modes are all but one, as at critical damping, so that the rule does not prove "
        "them complete; responses are solved directly, without them"
    )


_MOST_MESH_SENTENCES = 3  # meshes beyond which their stiffness is a table
_MESH_COLUMNS = (
    Column("mesh", "name"),
    Column("force [N]", "force_n", ".5g"),
    Column("stiffness [N/µm]", "stiffness_n_per_m", ".4g"),
    Column("taken", "taken"),
    Column("mean without load [N/µm]", "unloaded_mean_n_per_m", ".4g"),
    Column("gears' bodies behind the rims [N/µm]", "bodies_n_per_m", ".4g"),
)


def _mesh_sentence(mesh: Document) -> str:
    """Return the mesh stiffness of the linearised contact, and the mean without load beside it."""
    stiffness, unloaded = 1e-6 * mesh["stiffness_n_per_m"], 1e-6 * mesh["unloaded_mean_n_per_m"]
    under = f" of {mesh['force_n']:.5g} N" if mesh["force_n"] else ""
    beside = "" if mesh["taken"] == "mean without load" else f"; mean without load {unloaded:.4g} N/µm"
    bodies = mesh.get("bodies_n_per_m")
    between, twist = "", ""
    if bodies is not None:
        between = " between the rims"
        twist = (
            f"; in series with it the gears' bodies behind the rims, {1e-6 * bodies:.4g} N/µm (`gears` and `load` tell "
            "both together)"
        )
    return f"Mesh stiffness of {mesh['name']}{between}: {stiffness:.4g} N/µm, {mesh['taken']}{under}{beside}{twist}."


def _number_or_blank(key: str, shown: str) -> Callable[[Document], str]:
    return lambda mode: "" if mode.get(key) is None else format(mode[key], shown)


_TURNING_MODE_COLUMNS = (
    Column("turning [Hz]", "turning_frequency_hz", shown=_number_or_blank("turning_frequency_hz", ".2f")),
    Column("damping ratio, turning", "turning_damping_ratio", shown=_number_or_blank("turning_damping_ratio", ".4f")),
)
"""Columns of modes where directions turn: their exponents beside the values of frozen carriers."""


def mode_columns(modes: list[Document]) -> tuple[Column, ...]:
    """Columns of coupled modes: frequency, damping, kind, the shares of what moves, and what is strained most."""
    # Few machines have motions along the axis or pedestals: no columns of zeros for the others.
    some = {kind for mode in modes for kind, share in mode["energy"].items() if share > 0.0}
    rare = [kind for kind in ("axial", "body", "pedestal") if kind in some]
    kinds = ("housing", "rotor", "torsion", *rare, "residual", "mesh")
    turning = any("turning_frequency_hz" in mode for mode in modes)
    sets = {_set_of(mode) for mode in modes}
    named = _named if len(sets - {""}) > 1 else _named_in_only_set
    return (
        *(replace(column, shown=named) if column.heading == "kind" else column for column in columns_of(MODE)),
        *(_TURNING_MODE_COLUMNS if turning else ()),
        *(Column("teeth" if kind == "mesh" else kind, f"energy.{kind}", shown=partial(_share, kind)) for kind in kinds),
        Column("strained most", _strained, numbers=("strained_most.share",)),
    )


def _share(kind: str, mode: Document) -> str:
    # A rigid mode is the free turning of the train: its shares say nothing of vibration.
    return "" if mode["kind"] == "rigid" else f"{100 * mode['energy'][kind]:z.0f} %"


def _named(mode: Document) -> str:
    """Return a mode's kind, its place, and the sense of its whirl about z."""
    kind, where = mode["kind"], mode.get("where")
    if "planetary" in mode and kind != "rigid":
        return f"{mode['planetary'].partition(': ')[0]}{_in_set(mode)}"
    if not where or where == kind or kind in ("rigid", "mesh", "residual"):
        return str(kind)
    whirl = mode.get("whirl", 0.0)
    sense = "" if abs(whirl) < _WHIRL else " ↺" if whirl > 0.0 else " ↻"
    return f"{kind}: {where}{sense}"


def _whirl_legend(listed: Sequence[Document]) -> str:
    """Return what the arrows of whirling modes mean; empty where no mode has one."""
    arrows = any(arrow in _named(mode) for mode in listed for arrow in "↺↻")
    return " Whirl seen from +z: ↺ counter-clockwise, ↻ clockwise." if arrows else ""


def _set_of(mode: Document) -> str:
    """Return the carrier of a mode's planetary set; empty of modes of no set."""
    return str(mode.get("planetary", "")).partition(": ")[2]


def _named_in_only_set(mode: Document) -> str:
    """Return a mode's kind and place as `_named`, of a machine with one planetary set, which need not be named."""
    return _named(mode).removesuffix(_in_set(mode))


def _in_set(mode: Document) -> str:
    return f" (planetary set of {_set_of(mode)})"


def _strained(mode: Document) -> str:
    """Return the part with the most strain energy."""
    most = mode.get("strained_most")
    return "" if most is None else f"{_NAMES[most['kind']]}{most['name']} {100 * most['share']:.0f} %"


def _highest_line(document: Document) -> Iterator[str]:
    """Yield the highest line of all sensors at operation."""
    highest = max(
        (
            (level, sensor, line)
            for line in document.get("mesh_lines", ())
            for sensor, level in line["sensor_acceleration_m_per_s2"]["together"].items()
        ),
        key=lambda one: one[0],
        default=None,
    )
    if highest is not None:
        level, sensor, line = highest
        yield (
            f"Highest line at operation: {level:.3g} m/s² at {line['frequency_hz']:.1f} Hz at {sensor}, "
            f"{arrowed(line['cause'])}."
        )


def _stability(stability: Document, modes: Sequence[Document] = (), trusted: float | None = None) -> Iterator[str]:
    if stability["stable"]:
        least, within = stability["least_damped"], ""
        sentence = "Stable: no mode grows."
        if least is not None and trusted is not None and least["frequency_hz"] > trusted:
            # Damping of modes beyond those of the housing is as little trusted as their frequency.
            swinging = [mode for mode in modes if 0.0 < mode["frequency_hz"] <= trusted and mode["damping_ratio"] < 1.0]
            least = min(swinging, key=lambda mode: mode["damping_ratio"], default=None)
            within = f" up to {trusted:.0f} Hz"
        if least is not None:
            sentence += (
                # Rounding leaves a mode without damping as much below zero as above.
                f" Least damped{within}: {max(least['damping_ratio'], 0.0):.2g} at {least['frequency_hz']:.1f} Hz "
                f"({_named(least)})."
            )
        yield sentence
        return
    growing = len(stability["growing"])
    yield f"UNSTABLE: {counted(growing, 'mode')} grow{'s' * (growing == 1)} from any disturbance."
    for mode in stability["growing"]:
        fed = ", ".join(f"{feeder['name']} ({feeder['share']:.2g})" for feeder in mode["fed_by"][:3])
        yield (
            f"  {mode['frequency_hz']:.2f} Hz ({_named(mode)}), damping ratio {mode['damping_ratio']:.2g}, "
            f"doubling in {mode['doubling_time_s']:.3g} s; fed by {fed or 'nothing single'}"
        )


def _is_undamped(peak: Document, modes: list[Document]) -> bool:
    """Whether a peak of a response is that of a mode that hardly anything damps."""
    at = peak["frequency_hz"]
    nearest = min(modes, key=lambda mode: abs(mode["damped_frequency_hz"] - at), default=None)
    if nearest is None or nearest["damping_ratio"] >= UNDAMPED_RATIO:
        return False
    return bool(abs(nearest["damped_frequency_hz"] - at) <= _PEAK_OF_MODE * at)


_RESPONSES = (
    ("mesh_force_n", "mesh force [N/µm]"),
    ("sensor_acceleration_m_per_s2", "acceleration [m/s²/µm]"),
)


def _listed_peaks(response: Document) -> Iterator[Document]:
    for key, _ in _RESPONSES:
        for peaks in response[key].values():
            yield from peaks


def _peaks_of_all(responses: Sequence[Document], modes: list[Document]) -> Iterator[str | Table]:
    """Yield the highest damped response of any mesh force and of each sensor to the error of each mesh, in one table.

    The meshes of planets answer much alike: apart they are as many tables of nearly the same numbers.
    """

    def highest(peaks: Mapping[str, Sequence[Document]]) -> tuple[Document | None, str]:
        damped = [(peak, name) for name, of in peaks.items() for peak in of if not _is_undamped(peak, modes)]
        return max(damped, key=lambda one: one[0]["amplitude"], default=(None, ""))

    def words(peaks: Mapping[str, Sequence[Document]], named: bool = False) -> str:
        peak, name = highest(peaks)
        if peak is None:
            return "undamped" if any(peaks.values()) else "none"
        where = f" at {name}" if named else ""
        return f"{peak['frequency_hz']:.0f} ({significant(1e-6 * peak['amplitude'])}){where}"

    (force, force_unit), (acceleration, unit) = _RESPONSES

    def at_sensor(sensor: str) -> Column:
        return Column(f"{sensor} {unit.split()[-1]}", lambda row: words({sensor: row[acceleration][sensor]}))

    columns = (
        Column("by 1 µm of", "excitation"),
        Column(force_unit, lambda row: words(row[force], named=True)),
        *map(at_sensor, responses[0][acceleration]),
    )
    yield "Highest response to the error of each mesh at any frequency: Hz, and in brackets by 1 µm:"
    yield from table_of(columns, list(responses))


def _peaks(response: Document, modes: list[Document]) -> Iterator[str | Table]:
    """Yield the highest responses of mesh forces and sensors to a micrometre of mesh error, damped ones first."""
    rows: list[dict[str, Any]] = []
    for key, quantity in _RESPONSES:
        for name, peaks in response[key].items():
            scaled = [
                peak | {"amplitude": 1e-6 * peak["amplitude"], "undamped": _is_undamped(peak, modes)} for peak in peaks
            ]
            rows.append({"what": quantity, "name": name, "peaks": sorted(scaled, key=lambda peak: peak["undamped"])})

    def words(peak: Document) -> str:
        height = "undamped" if peak["undamped"] else significant(peak["amplitude"])
        return f"{peak['frequency_hz']:.0f} ({height})"

    columns = (
        Column("peak amplitude of", "what"),
        Column("at", "name"),
        Column(
            "highest: Hz (by 1 µm)",
            lambda row: "  ".join(map(words, row["peaks"][:4])),
            numbers=tuple(f"peaks.{place}.{key}" for place in range(4) for key in ("frequency_hz", "amplitude")),
        ),
    )
    yield f"Response to the {response['excitation']}, 1 µm at any frequency:"
    yield from table_of(columns, rows)


_ORDER_LINE_COLUMNS = (
    Column("sensor", "sensor"),
    Column("mesh harmonic", "cause"),
    Column("highest [m/s²]", "amplitude_m_per_s2", ".3g"),
    Column("speed [rpm]", "speed_rpm", ".0f"),
    Column("frequency [Hz]", "frequency_hz", ".1f"),
    Column("near, as at operation", "near"),
)


def _over_speed(document: Document) -> Iterator[str | Table]:
    """Yield the mesh harmonics that are highest over speed at each sensor, and the modes near them."""
    lines = document.get("order_lines", ())
    modes = [mode for mode in document["modes"] if mode["kind"] not in ("rigid", "residual")]
    rows = []
    for sensor in lines[0]["highest"] if lines else ():
        highest = sorted(lines, key=lambda line: -line["highest"][sensor]["amplitude_m_per_s2"])
        for line in highest[:_ORDER_LINES]:
            peak = line["highest"][sensor]
            near = min(modes, key=lambda mode: abs(mode["frequency_hz"] - peak["frequency_hz"]), default=None)
            is_near = near is not None and abs(near["frequency_hz"] / peak["frequency_hz"] - 1.0) <= _NEAR_MODE
            mode = f"{near['frequency_hz']:.0f} Hz {_named(near)}" if near is not None and is_near else ""
            rows.append({"sensor": sensor, "cause": arrowed(line["cause"]), "near": mode} | peak)
    if rows:
        yield "Mesh harmonics of the sensors over speed, each at its highest; linear response about the mean load:"
        yield from table_of(_ORDER_LINE_COLUMNS, rows)


_CROSSING_COLUMNS = (
    Column("speed [rpm]", "speed_rpm", shown=lambda row: f"{abs(row['speed_rpm']):.1f}"),
    Column("from operation", "margin", shown=lambda row: f"{100 * row['margin']:+.1f} %"),
    Column("order", "line"),
    Column("frequency [Hz]", "frequency_hz", ".2f"),
    Column("damping ratio", "damping_ratio", ".4f"),
    Column("mode", _named),
    Column("teeth", "teeth", shown=lambda row: f"{100 * row['teeth']:.1f} %"),
)


def _harmonics(campbell: Document) -> str:
    """Return how many harmonics of each mesh a diagram has, and how to see more."""
    meshes = {line["name"].split(" ", 1)[-1] for line in campbell["lines"] if line["kind"] == "mesh"}
    if not meshes:
        return ""
    count = sum(line["kind"] == "mesh" for line in campbell["lines"]) // len(meshes)
    return f", mesh orders up to {count}× (more: --mesh-harmonics)"


def _crossings(campbell: Document) -> Iterator[str | Table]:
    """Resonant speeds: mesh orders on all modes of the machine, shaft orders on those that bend shafts."""
    kinds = {line["name"]: line["kind"] for line in campbell["lines"]}
    met = [
        crossing
        for crossing in campbell["crossings"]
        if crossing["kind"] == "rotor" or (crossing["kind"] != "residual" and kinds[crossing["line"]] == "mesh")
    ]
    nearest = sorted(met, key=lambda crossing: abs(crossing["margin"]))[:_CROSSINGS]
    speeds = [abs(speed) for speed in campbell["speeds_rpm"]]
    span = f"{min(speeds):.0f} to {max(speeds):.0f} rpm"
    if not met:
        yield f"No order of a shaft or mesh meets a mode that it excites from {span}."
    else:
        yield f"Resonant speeds from {span} (of the first driver), modes about the mean contact{_harmonics(campbell)}:"
        yield from table_of(_CROSSING_COLUMNS, sorted(nearest, key=lambda crossing: abs(crossing["speed_rpm"])))
    if rest := len(campbell["crossings"]) - len(nearest):
        yield f"{counted(rest, 'more crossing')} in the JSON, further off or of orders that hardly excite the mode."
    yield from campbell["unsettled"]
