"""Model of a machine's lines: the machine linear about its operating point, and the derivatives of its housing.

Lines are those of the sensors and, where its sound is sought, of the sound power. The gradients are those of
:mod:`gearwhine.coupling.linear.line_sensitivity`, whose motion and adjoint fields must be exact in the housing's basis.
Residual modes of the sensors, which the modes of a solved housing do not have, bring the fields close; then the
responses of the housing's finite-element matrices at the lines' frequencies to the loads in both fields join the basis,
and the lines are solved again. The adjoint load of a sensor is one on a point, that of the sound power one on the whole
skin.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from gearwhine.coupling.description.excitation import Run
from gearwhine.coupling.linear.housing_rates import HousingRates
from gearwhine.coupling.linear.line_outputs import SensorAmplitude
from gearwhine.coupling.linear.line_sensitivity import Line, LineModel
from gearwhine.coupling.load_analysis.housing_fields import bearing_ports
from gearwhine.coupling.machine.components import component_of_housing
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.statics.operating_point import FlankGap, OperatingPoint
from gearwhine.housing import HousingModes, ModeSet, modal_damping
from gearwhine.housing.housing import RESPONSE_ORDERS
from gearwhine.housing.modes.housing_field import HousingField
from gearwhine.housing.modes.natural_modes import ModeSetExtension
from gearwhine.housing.updating import modal_sensitivities
from gearwhine.housing.updating.housing_change import HousingChange
from gearwhine.housing.updating.static_sensitivity import StaticSensitivity
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.progress import Progress, silent

if TYPE_CHECKING:
    from gearwhine.coupling.sound.acoustics import Acoustics
    from gearwhine.coupling.sound.mesh_harmonics import HarmonicSound
    from gearwhine.housing.acoustics.radiation import HousingRadiation

LINES = 3
"""Number of lines of each sensor, the highest ones."""

_TWO_PI = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class SolvedLines:
    """Lines of a machine's sensors and of its sound, with the model that they are of.

    Attributes
    ----------
    model : LineModel
    of_sensors : tuple of Line
        Lines of the sensors, the highest first.
    sound : tuple of HarmonicSound
        Lines of the sound, the loudest by their A-weighted power first.
    housing : HousingModes
        Housing with residual modes of the sensors, and the harmonic responses at the lines.
    responses : mapping of str to ndarray
        Responses by which the housing's modes were extended, for a next solution.
    """

    model: LineModel
    of_sensors: tuple[Line, ...]
    sound: "tuple[HarmonicSound, ...]"
    housing: HousingModes
    responses: Mapping[str, FloatArray] = field(default_factory=dict)

    @property
    def lines(self) -> tuple[Line, ...]:
        """Lines of the sensors, and then of the sound."""
        return (*self.of_sensors, *(sound.line for sound in self.sound))

    def cause(self, line: Line) -> str:
        """Return the mesh harmonics that drive a line, in words."""
        return line.cause(self.model.machine)

    @property
    def held(self) -> str | None:
        """Parts whose flanks or stiffness are given, so that they do not follow the operating point, in words."""
        pairs = [
            pair.geometry.label
            for pair, is_found in zip(self.model.pairs, self.model.found, strict=True)
            if not is_found
        ]
        bearings = [
            bearing.name
            for bearing in self.model.point.bearings
            if bearing.rolling is not None and not bearing.mounted.needs_load
        ]
        parts = [f"the flanks of {', '.join(pairs)} (misalignment)"] if pairs else []
        parts += [f"the stiffness of bearings {', '.join(bearings)}"] if bearings else []
        return " and ".join(parts) or None

    def field(self, coordinates: ComplexArray) -> ComplexArray:
        """Displacement of the housing's nodes by the coordinates of the machine, shape (n_nodes, 3)."""
        assert self.model.machine.housing is not None
        name = self.model.machine.housing.name
        housing_motion = self.model.machine.rows(name, np.eye(self.model.machine.housing.size)) @ coordinates
        every = np.arange(len(self.housing.mesh.points))
        displacement = self.housing.modes.displacement
        return np.asarray(displacement(housing_motion.real, every) + 1j * displacement(housing_motion.imag, every))

    def rates(
        self,
        fields: StaticSensitivity,
        changes: Sequence[HousingChange],
        report: Callable[[float], None] = lambda fraction: None,
    ) -> HousingRates:
        """Project derivatives of the housing by the coordinates of parameters on its modes and residual modes.

        Parameters
        ----------
        fields : StaticSensitivity
            Fields with the housing's material and its displacement at the operating point.
        changes : sequence of HousingChange
        report : callable
            Called with the completed fraction.
        """
        modes, ratios = self.housing.modes, self.housing.damping_ratios
        shapes, omega = modes.shapes, modes.frequencies
        assert modes.residual_modes is not None
        shapes = np.concatenate([shapes, modes.residual_modes.shapes])
        # As in the housing's component.
        extra = len(modes.residual_modes.frequencies)
        omega = np.concatenate([omega, modes.residual_modes.frequencies])
        ratios = np.concatenate([ratios, np.full(extra, ratios.max(initial=0.0))])
        rates = [change.rate for change in changes]
        sensitivities = modal_sensitivities(self.housing.mesh, fields.constants, shapes, rates, report)
        motions = [self.field(harmonic.line.motion) for harmonic in self.sound]
        powers = [
            {}
            if rate.velocity is None
            else {
                harmonic.line.frequency: harmonic.by_sliding(motion, rate.velocity)
                for harmonic, motion in zip(self.sound, motions, strict=True)
            }
            for rate in rates
        ]
        flat, displacement = shapes.reshape(len(shapes), -1).T, fields.displacement.ravel()
        return HousingRates(
            omega,
            ratios,
            sensitivities.stiffness,
            sensitivities.mass,
            [{name: np.asarray(rows @ flat) for name, rows in change.bearings.items()} for change in changes],
            [{name: np.asarray(rows @ flat)[0] for name, rows in change.sensors.items()} for change in changes],
            [{name: np.asarray(rows @ displacement) for name, rows in change.bearings.items()} for change in changes],
            powers,
        )


def turning_carriers(machine: Machine) -> tuple[str, ...]:
    """Return the carriers that turn, whose planets meet the housing in turning directions."""
    carriers = dict.fromkeys(shaft.carrier for shaft in machine.shafts if shaft.carrier is not None)
    return tuple(name for name in carriers if machine.speeds[name] != 0.0)


def solve_lines(
    machine: Machine,
    point: OperatingPoint,
    housing: HousingModes | None,
    acoustics: "Acoustics | None" = None,
    run: Run | None = None,
    progress: Progress = silent,
    *,
    count: int = LINES,
) -> SolvedLines | None:
    """Solve the highest lines of each sensor and the loudest of the sound.

    None where no mesh drives any, and where a carrier turns: a line's gradient is that of a machine whose directions
    stand still.

    Parameters
    ----------
    machine : Machine
    point : OperatingPoint
        Operating point of the machine.
    housing : HousingModes or None
        Housing that the machine stands in.
    acoustics : Acoustics, optional
        Method and medium of the sound, whose lines are sought where it is given.
    run : SpeedRun or FreeRun, optional
        Course of the speed that the machine is assembled for.
    progress : callable
    count : int
        Number of lines of each sensor.

    Raises
    ------
    gearwhine.coupling.errors.AcousticsError
        Where the radiating surface cannot be made.
    gearwhine.housing.HousingError
        Where a line fails its proofs, see :meth:`gearwhine.housing.acoustics.radiation.RadiatedSound.require_proofs`.
    """
    if housing is None or not machine.gear_pairs or machine.speed == 0.0 or turning_carriers(machine):
        return None
    loaded = bearing_ports(housing.housing, machine)
    if not loaded or not (housing.sensors or acoustics):
        return None
    work = "residual modes of the sensors"
    progress(work)
    matrices = housing.housing.matrices()
    extension = ModeSetExtension(matrices, housing.modes, known=housing.responses)
    modes = housing.modes
    if housing.sensors:
        ports = [sensor.matrix for sensor in housing.sensors.values()]
        modes = extension.with_ports(
            modes, ports, orders=RESPONSE_ORDERS, progress=lambda step: progress(f"{work}: {step}")
        )
    about = machine.at_operating_point(point)
    # Flanks that nearly carry evenly keep their gap here, whose derivative is sought.
    gaps = {pair.names: FlankGap(pair.station_gap, (), pair.path_slope) for pair in point.pairs}
    flanks = [
        replace(pair, **gaps.get((pair.driver, pair.driven), FlankGap())._asdict())
        if given.misalignment is None
        else pair
        for pair, given in zip(about.gear_pairs, machine.gear_pairs, strict=True)
    ]
    pairs = replace(about, gear_pairs=flanks).loaded_pairs(progress)
    components = about.rotor_components(progress=progress)
    gap_is_found = tuple(pair.misalignment is None for pair in machine.gear_pairs)
    rows = zip(machine.gear_pairs, machine.train.shares_torque, strict=True)
    is_share = tuple(shares and pair.mean_force is None for pair, shares in rows)
    limit = _TWO_PI * housing.trusted_limit_hz
    radiation = _radiation(acoustics, housing.with_modes(modes, None).displacement_field, progress)

    def solved(modes: ModeSet, heard: Sequence[float] | None = None) -> SolvedLines:
        extended = housing.with_modes(modes, modal_damping(modes, matrices) if matrices.damping.nnz else None)
        part = component_of_housing(extended, participates=about.moves_housing_as_a_body, with_coarser=False)
        stands = replace(about, housing=part)
        model = LineModel(stands.assemble(pairs, components, run), point, pairs, gap_is_found, is_share)
        lines = model.lines(limit, count)
        field = extended.displacement_field
        return SolvedLines(model, lines, _sound(acoustics, field, model, radiation, heard, progress), extended)

    progress("lines of the sensors")
    first = solved(modes)
    if not first.lines:
        return None
    progress("responses of the housing at the lines")
    exact = extension.with_harmonic_responses(
        modes, _housing_loads(first, loaded), lambda step: progress(f"responses of the housing at the lines: {step}")
    )
    lines = solved(exact, [sound.line.frequency for sound in first.sound])
    return replace(lines, responses=extension.responses)


def _radiation(acoustics: "Acoustics | None", field: HousingField, progress: Progress) -> "HousingRadiation | None":
    """Return the radiating surface of a housing whose sound is sought."""
    if acoustics is None:
        return None
    # The acoustics' kernels are for these machines alone.
    from gearwhine.coupling.sound.solution import build_radiation

    return build_radiation(acoustics, field, progress)


def _sound(
    acoustics: "Acoustics | None",
    field: HousingField,
    model: LineModel,
    radiation: "HousingRadiation | None",
    heard: Sequence[float] | None,
    progress: Progress,
) -> "tuple[HarmonicSound, ...]":
    """Solve for the loudest lines with the modes of a housing, or for those of known frequencies [rad/s]."""
    if acoustics is None or radiation is None:
        return ()
    from gearwhine.coupling.sound.mesh_harmonics import loudest_lines

    progress("sound of the lines")
    limit = min(acoustics.limit_hz(field), field.complete_below_hz)
    return loudest_lines(model, radiation.with_shapes(field.shapes), _TWO_PI * limit, heard)


def _housing_loads(solved: SolvedLines, loaded: Mapping[str, sparse.csr_array]) -> list[tuple[float, FloatArray]]:
    """Return the loads on the housing's nodes in the motions and adjoint fields of lines, by frequency.

    Parameters
    ----------
    solved : SolvedLines
    loaded : mapping of str to scipy.sparse.csr_array
        Motions of the bearings' places from the nodes'.

    Returns
    -------
    list of (float, ndarray of shape (3 n_nodes, m))
        Frequencies [rad/s], and real and imaginary parts of the loads.
    """
    loads_by_frequency: dict[float, list[ComplexArray]] = {}
    limit = solved.housing.modes.certificate.limit
    loads = [_sensor_load(solved, line) for line in solved.of_sensors]
    loads += [harmonic.nodal_load() for harmonic in solved.sound]
    for line, adjoint_load in zip(solved.lines, loads, strict=True):
        # At the limit itself residual modes have the responses.
        if line.frequency >= limit:
            continue
        motion = np.zeros(3 * len(solved.housing.mesh.points), dtype=np.complex128)
        against = adjoint_load
        for name, port in loaded.items():
            load, adjoint = solved.model.bearing_loads(line, name)
            motion += np.asarray(port.T @ load)
            against = against + np.asarray(port.T @ adjoint)
        # The motion is the same for every output.
        loads_by_frequency.setdefault(line.frequency, [motion]).append(against)
    return [
        (w, np.concatenate([np.array(columns).real, np.array(columns).imag]).T)
        for w, columns in loads_by_frequency.items()
    ]


def _sensor_load(solved: SolvedLines, line: Line) -> ComplexArray:
    """Adjoint load of a sensor's line on the housing's nodes, shape (3 n_nodes,)."""
    assert isinstance(line.output, SensorAmplitude)
    port = solved.housing.sensors[line.output.sensor].matrix.toarray()[0]
    return np.asarray(line.output.weight(line.frequency, line.motion) * port)
