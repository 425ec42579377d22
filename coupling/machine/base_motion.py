"""Base excitation and gravity: inertia loads on coordinates that are relative to a moving base.

With u = q + R s, R the six rigid motions of the base about a point, the coordinates are loaded by -P a, where P = ∫ φ R
dm is their participation and a the acceleration, three components along and three about x, y and z. Rotations of the
base are small: terms quadratic in them, and Coriolis forces on the vibration, are neglected. The gyroscopic moment of a
shaft that rotates at Ω on a base that tilts at the speeds ω_x and ω_y is kept: Ω ∫ β dI_p ω_x on the x plane and Ω ∫ β
dI_p ω_y on the y plane, at the nominal speed. Gravity loads the same masses, by P g.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.components import Component, HousingComponent, PedestalComponent, RotorComponent
from gearwhine.coupling.machine.coupled_system import HarmonicLoad, TimedLoad
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.findings import Finding, Number, Numbers, attribute_findings, kind_findings, refuse
from gearwhine.numerics.own_copies import keep_arrays, keep_tuples

Point = tuple[float, float, float]
_VELOCITY_PIECES = 16  # number of chords that replace the velocity's parabola between two accelerations


@dataclass(frozen=True)
class BaseHarmonic:
    """Re(amplitude e^{iwt}), w in rad/s, amplitude (6,) in m/s² and rad/s²."""

    frequency: float
    amplitude: ComplexArray

    def __post_init__(self) -> None:
        """Keep own copies; require a frequency above 0 and six finite amplitudes."""
        keep_arrays(self, "amplitude")
        part = ("base motion", "")
        findings = [*attribute_findings(part, self, frequency=Number(above=0.0, unit="rad/s"))]
        if np.shape(self.amplitude) != (6,) or not np.isfinite(self.amplitude).all():
            findings.append(Finding(part, "amplitude", self.amplitude, "6 numbers, each finite"))
        refuse(findings, CouplingError)


@dataclass(frozen=True)
class BaseHistory:
    """Accelerations (l, 6) in m/s² and rad/s², linear between times (l,) in s and constant beyond them."""

    times: FloatArray
    values: FloatArray

    def __post_init__(self) -> None:
        """Keep own copies; require six accelerations for each time, and times that ascend."""
        keep_arrays(self, "times", "values")
        fits = self.values.shape == (len(self.times), 6) and len(self.times) > 0
        if not fits or not np.isfinite(self.values).all() or not np.all(np.diff(self.times) > 0.0):
            expected = "six finite accelerations for each time, and times that ascend"
            refuse([Finding(("base motion", ""), "values", self.values, expected)], CouplingError)


@dataclass(frozen=True)
class BaseMotion:
    """Motion of the base: acceleration of a point of it [m], and angular acceleration about axes through this point.

    Attributes
    ----------
    parts : tuple
        Parts of the motion, whose accelerations add up.
    point : tuple of float
    """

    parts: tuple[BaseHarmonic | BaseHistory, ...]
    point: Point = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        """Keep own copies; require parts that move, about a point."""
        keep_tuples(self, "parts", "point")
        part = ("base motion", "")
        kinds = kind_findings(part, self, parts=(BaseHarmonic, BaseHistory))
        refuse([*kinds, *attribute_findings(part, self, point=Numbers(3))], CouplingError)

    def acceleration(self, times: FloatArray) -> FloatArray:
        """Acceleration of the base at some times [m/s², rad/s²], shape (s, 6)."""
        total = np.zeros((len(times), 6))
        for part in self.parts:
            if isinstance(part, BaseHarmonic):
                total += (np.exp(1j * part.frequency * times)[:, None] * part.amplitude).real
            else:
                total += np.column_stack([np.interp(times, part.times, column) for column in part.values.T])
        return total

    def acceleration_at(self, position: FloatArray, direction: FloatArray, times: FloatArray) -> FloatArray:
        """Acceleration along a direction at a place that moves with the base [m/s²], shape (s,)."""
        return np.asarray(self.acceleration(times) @ self.row_at(position, direction))

    def row_at(self, position: FloatArray, direction: FloatArray) -> FloatArray:
        """Acceleration along a direction at a place by unit accelerations of the base, shape (6,)."""
        return np.concatenate([direction, np.cross(np.subtract(position, self.point), direction)])

    def harmonic_amplitude(self, frequency: float) -> ComplexArray:
        """Complex amplitude of the base's acceleration at a frequency [rad/s], shape (6,) [m/s², rad/s²]."""
        parts = (part for part in self.parts if isinstance(part, BaseHarmonic) and part.frequency == frequency)
        return np.asarray(sum((part.amplitude for part in parts), np.zeros(6, dtype=np.complex128)))


def base_loads(
    components: Sequence[Component], speeds: Sequence[float], base: BaseMotion, places: dict[str, Point]
) -> tuple[list[HarmonicLoad], list[TimedLoad]]:
    """Inertia loads of a moving base; ``places`` are the positions of the pedestals [m]."""
    carried = participations(components, base.point, places)
    tilting = _gyroscopic(components, speeds)
    harmonic: list[HarmonicLoad] = []
    timed: list[TimedLoad] = []
    for part in base.parts:
        if isinstance(part, BaseHarmonic):
            velocity = part.amplitude / (1j * part.frequency)
            load = tilting @ velocity - carried @ part.amplitude
            harmonic.append(HarmonicLoad(part.frequency, load, mechanism="base_motion"))
            continue
        moved = np.flatnonzero(np.any(part.values != 0.0, axis=0))
        timed += [TimedLoad(part.times, part.values[:, k], -carried[:, k]) for k in moved]
        times, velocities = _velocities(part)
        timed += [TimedLoad(times, velocities[:, k], tilting[:, k]) for k in moved if np.any(tilting[:, k])]
    return harmonic, timed


def gravity_load(components: Sequence[Component], gravity: Sequence[float], places: dict[str, Point]) -> FloatArray:
    """Weight under an acceleration along x, y, z [m/s²], shape (n,)."""
    return participations(components, (0.0, 0.0, 0.0), places)[:, :3] @ np.array(gravity, dtype=np.float64)


def participations(components: Sequence[Component], point: Point, places: dict[str, Point]) -> FloatArray:
    """Participation P of all coordinates in rigid motions of a base about a point [√kg, √kg m], shape (n, 6).

    Raises
    ------
    CouplingError
        Where a component has no participation.
    """
    rows = []
    for component in components:
        if isinstance(component, RotorComponent):
            rows.append(rotor_participation(component, point))
        elif isinstance(component, HousingComponent):
            if component.participation is None:
                raise CouplingError(f"{component.name}: expected its participation in the motions of its base")
            rows.append(_about(component.participation, point))
        elif isinstance(component, PedestalComponent):
            whole = np.zeros((2, 6))
            whole[:, :2] = np.linalg.inv(component.motion)
            x, y, z = np.subtract(places[component.name], point)
            whole[:, 3:] = whole[:, :2] @ np.array([[0.0, z, -y], [-z, 0.0, x]])
            rows.append(whole)
        else:
            # The mass of a pin belongs to its carrier.
            rows.append(np.zeros((component.size, 6)))
    return np.vstack(rows)


def _about(participation: FloatArray, point: Point) -> FloatArray:
    """Participation about a point from that about the origin."""
    x, y, z = point
    # α × (r - p) = α × r + p × α.
    moved = participation.copy()
    moved[:, 3:] += participation[:, :3] @ np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return moved


def rotor_participation(rotor: RotorComponent, point: Point) -> FloatArray:
    """Participation of a rotor's coordinates in rigid motions about a point, (n, 6), as `participations`."""
    participation = rotor.modal.participation
    if participation is None:
        raise CouplingError(f"{rotor.name}: expected its participation in the motions of its base")
    m, (x, y) = rotor.plane_size, np.subtract(rotor.axis, point[:2])
    carried = np.array([(body.shift.coupling_inertia, body.at) for body in rotor.bodies if body.shift]).reshape(-1, 2)
    tilted = np.array([mode.coupling for body in rotor.bodies for mode in body.plates_with(1)])
    shift = rotor.plane_basis.T @ np.concatenate([participation.displacement, carried[:, 0], 0.0 * tilted])
    tilt = rotor.plane_basis.T @ np.concatenate([participation.tilt, carried.prod(axis=1), tilted])
    tilt = tilt + (rotor.start - point[2]) * shift
    whole = np.zeros((rotor.size, 6))
    whole[:m, 0], whole[:m, 4], whole[:m, 5] = shift, tilt, -y * shift
    whole[m : 2 * m, 1], whole[m : 2 * m, 3], whole[m : 2 * m, 5] = shift, -tilt, x * shift
    whole[:, 5] += rotor.turning
    along, axial = rotor.axial, participation.axial
    if axial.size:
        umbrellas = [mode.coupling for body in rotor.bodies for mode in body.plates_with(0)]
        axial = rotor.axial_basis.T @ np.concatenate([axial, umbrellas])
    whole[along, 2], whole[along, 3], whole[along, 4] = axial, y * axial, -x * axial
    return whole


def _gyroscopic(components: Sequence[Component], speeds: Sequence[float]) -> FloatArray:
    """Gyroscopic load of a base that turns at 1 rad/s about each axis, in the rotations' columns, shape (n, 6)."""
    rows = []
    for component, speed in zip(components, speeds, strict=True):
        whole = np.zeros((component.size, 6))
        if isinstance(component, RotorComponent) and component.modal.participation is not None:
            m, spin = component.plane_size, component.modal.participation.spin
            tilts = [mode.coupling_spin for body in component.bodies for mode in body.plates_with(1)]
            shifts = np.zeros(m - spin.size - len(tilts))
            moment = speed * component.plane_basis.T @ np.concatenate([spin, shifts, tilts])
            whole[:m, 3], whole[m : 2 * m, 4] = moment, moment
        rows.append(whole)
    return np.vstack(rows)


def _velocities(part: BaseHistory) -> tuple[FloatArray, FloatArray]:
    """Velocities from a table of accelerations, at rest at its first time."""
    gaps = np.arange(_VELOCITY_PIECES) / _VELOCITY_PIECES
    times = np.append((part.times[:-1, None] + np.diff(part.times)[:, None] * gaps).ravel(), part.times[-1])
    values = np.column_stack([np.interp(times, part.times, column) for column in part.values.T])
    gained = 0.5 * (values[1:] + values[:-1]) * np.diff(times)[:, None]
    return times, np.vstack([np.zeros(6), np.cumsum(gained, axis=0)])
