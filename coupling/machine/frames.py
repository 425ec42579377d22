"""Rotating frames: coordinates of rotors whose axes turn with a planet carrier, and connectors between two frames.

The lateral coordinates of a rotor come in pairs that turn about z like x and y. With Q the quarter turn of all pairs
and n the order of each (1; the nodal diameters of a gear body's mode), J = n Q turns a motion at unit speed, and
coordinates y in a frame at the speed f have q = e^{J f t} y. A rotor of revolution that spins at Ω,

    q'' + (C + Ω G) q' + K q = F,

has in this frame, as C, G and K are alike in all directions,

    y'' + (C + Ω G + 2 f J) y' + (K + f (C + Ω G) J - f² n²) y = e^{-J f t} F:

Coriolis and centripetal terms, and the turning of gyroscopic moment and damping (Lin & Parker, J. Vib. Acoust. 121,
316, 1999, Eqs. 1 to 9, for rigid bodies in a plane). The frames coincide with the ground at t = 0. Where the speeds
change with the nominal time s, f and Ω are multiplied by s', and the frame's angular acceleration adds s'' f J y.

A connector fixed in a frame at f_c has the directions e^{J (f_c - f) t} D in the coordinates of a frame at f.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.components import (
    Component,
    FrameTerms,
    PedestalComponent,
    PinComponent,
    RotorComponent,
)
from gearwhine.coupling.machine.connectors import ContactConnector, TurningPart
from gearwhine.coupling.machine.coordinates import CoordinateLoads
from gearwhine.coupling.machine.coupled_system import CoupledSystem, HarmonicLoad
from gearwhine.numerics.arrays import ComplexArray, FloatArray, IntArray

_SAME_SPEED = 1e-12  # part of the larger of two speeds by which they differ from rounding


def orders_and_quarter_turn(component: Component) -> tuple[IntArray, FloatArray]:
    """Order n of each coordinate under a rotation about z, (m,), and the quarter turn Q of their pairs, (m, m).

    Coordinates of order 0, such as those of torsion and of the housing, stay as they are.
    """
    orders, quarter = np.zeros(component.size, dtype=np.int64), np.zeros((component.size, component.size))
    pairs: list[tuple[int, int, int]] = []
    if isinstance(component, RotorComponent):
        pairs += [(number, number + component.plane_size, 1) for number in range(component.plane_size)]
        pairs += [(own.start, own.start + 1, mode.nodal_diameters) for _, mode, own in component.plates]
    elif isinstance(component, PedestalComponent):
        pairs.append((0, 1, 1))
    elif isinstance(component, PinComponent):
        pairs += [(first + axis, first + axis + 1, 1) for first in range(0, component.size, 5) for axis in (0, 3)]
    for first, second, order in pairs:
        orders[[first, second]] = order
        quarter[second, first], quarter[first, second] = 1.0, -1.0
    return orders, quarter


def in_frame(component: Component, speed: float, frame: float) -> Component:
    """Return a component in the coordinates of a frame.

    Parameters
    ----------
    component : Component
    speed : float
        Its speed of rotation Ω [rad/s].
    frame : float
        Speed f of the frame [rad/s].
    """
    if frame == 0.0:
        return component
    orders, quarter = orders_and_quarter_turn(component)
    turn = orders[:, None] * quarter
    gyroscopic = frame * speed * component.gyroscopic @ turn
    terms = FrameTerms(
        coriolis=2.0 * frame * turn,
        circulatory=frame * component.damping @ turn,
        centripetal=gyroscopic - np.diag(frame**2 * orders.astype(np.float64) ** 2),
        angular=frame * turn,
    )
    return replace(component, frame=terms)


_TURN = np.zeros((5, 5))
"""Quarter turn of motions along x, y, z and about x and y."""
_TURN[1, 0] = _TURN[4, 3] = 1.0
_TURN[0, 1] = _TURN[3, 4] = -1.0


def is_isotropic(matrix: FloatArray) -> bool:
    """Whether a matrix (5, 5) over x, y, z and the rotations about x and y is the same in all directions."""
    scale = float(np.abs(matrix).max(initial=0.0))
    return bool(np.abs(matrix @ _TURN - _TURN @ matrix).max() <= _SAME_SPEED * scale)


def stiffness_in_frame(stiffness: FloatArray, damping: FloatArray, frame: float) -> FloatArray:
    """Stiffness (5, 5) of an isotropic bearing on the ground in the coordinates of a frame, K + f C J.

    A dashpot that stands still resists the turning of a deflection that stands still in the frame.
    """
    return np.asarray(stiffness + frame * damping @ _TURN)


@dataclass(frozen=True)
class Frames:
    """Frames of the components of a machine.

    Attributes
    ----------
    components : sequence of Component
    speeds : mapping of str to float
        Speed of each component's frame [rad/s]; those without one stand still.
    """

    components: Sequence[Component]
    speeds: Mapping[str, float]

    def of(self, name: str) -> float:
        """Speed of a component's frame [rad/s]."""
        return self.speeds.get(name, 0.0)

    def of_motion(self, directions: FloatArray) -> float:
        """Speed of the frame of the component that moves by directions (n, d) within it [rad/s]."""
        moved = np.flatnonzero(np.any(directions != 0.0, axis=1))
        return float(self._own_speeds[moved[0]]) if moved.size else 0.0

    @property
    def turn(self) -> bool:
        """Whether a component has a frame that turns."""
        return any(self.speeds.values())

    @cached_property
    def _orders(self) -> IntArray:
        return np.concatenate([orders_and_quarter_turn(part)[0] for part in self.components])

    @cached_property
    def _own_speeds(self) -> FloatArray:
        """Speed of the frame of each coordinate, (n,) [rad/s]."""
        return np.concatenate([np.full(part.size, self.of(part.name)) for part in self.components])

    def _quarter(self, columns: FloatArray) -> FloatArray:
        """Turn columns (n, d) by a quarter."""
        turned, start = np.zeros_like(columns), 0
        for part in self.components:
            own = slice(start, start + part.size)
            if np.any(columns[own]):
                turned[own] = orders_and_quarter_turn(part)[1] @ columns[own]
            start += part.size
        return turned

    def turning_parts(self, directions: FloatArray, frame: float) -> tuple[TurningPart, ...]:
        """Parts by which directions that are fixed in a frame turn in the components' coordinates.

        Parameters
        ----------
        directions : ndarray, shape (n, d)
            Directions D(0), where all frames coincide.
        frame : float
            Speed of the connector's frame [rad/s].
        """
        rates = self._orders * (frame - self._own_speeds)
        rates[np.abs(rates) <= _SAME_SPEED * np.abs(self._orders) * max(abs(frame), 1e-300)] = 0.0
        rates[~np.any(directions != 0.0, axis=1)] = 0.0
        quarter = self._quarter(directions)
        parts = []
        for rate in np.unique(rates[rates != 0.0]).tolist():
            among = (rates == rate)[:, None]
            parts.append(TurningPart(rate, np.where(among, directions, 0.0), np.where(among, quarter, 0.0)))
        return tuple(parts)

    def loads(self, acting: CoordinateLoads) -> CoordinateLoads:
        """Return loads that stand still as loads on the coordinates of the frames.

        Raises
        ------
        CouplingError
            Where a load over time, as of a base motion, acts on coordinates that turn.
        """
        if not self.turn:
            return acting
        turned = self._orders * self._own_speeds != 0.0
        for timed in acting.timed:
            if np.any(timed.direction[turned]):
                names = np.repeat([part.name for part in self.components], [part.size for part in self.components])
                first = str(names[turned & (timed.direction != 0.0)][0])
                raise CouplingError(
                    f"a base motion over time moves {first!r}, whose coordinates turn with the carrier of a "
                    "planetary set; expected a base motion given by harmonics"
                )
        still = HarmonicLoad(0.0, acting.constant.astype(np.complex128), "turning")
        moved = CoordinateLoads(
            np.zeros_like(acting.constant), timed=list(acting.timed), dashpots=list(acting.dashpots)
        )
        for load in (part for whole in [still, *acting.harmonic] for part in self.harmonics(whole, 0.0)):
            if load.frequency == 0.0:
                moved.constant += load.amplitude.real
                if load.circling:
                    # An eccentric mass that circles with the frame.
                    moved.centrifugal = moved.centrifugal + load.amplitude.real
                    moved.angular = moved.angular + load.amplitude.imag / load.circling
            else:
                moved.harmonic.append(load)
        return moved

    def harmonics(self, load: HarmonicLoad, frame: float) -> Iterator[HarmonicLoad]:
        """Yield a harmonic load of a frame on the coordinates of the components; constant ones have frequency 0.

        On a pair of coordinates a load is a circular part with the sense of the frame's turning, Q v = i v, and one
        against it. In coordinates of a frame that turns by f more than the load's own,
        e^{-J f t} a e^{iwt} = a₊ e^{i(w - n f)t} + a₋ e^{i(w + n f)t}.
        """
        shifts = self._orders * (self._own_speeds - frame)
        turned = shifts != 0.0
        if not np.any(load.amplitude[turned]):
            yield load
            return
        if load.follows == "unbalance" and load.circling is None:
            load = replace(load, circling=load.frequency)
        stands = np.where(turned, 0.0, load.amplitude)
        if np.any(stands):
            yield replace(load, amplitude=stands)
        amplitude = np.where(turned, load.amplitude, 0.0)
        quarter = self._quarter(amplitude.real) + 1j * self._quarter(amplitude.imag)
        for sense in (1.0, -1.0):
            circular = 0.5 * (amplitude - 1j * sense * quarter)
            rates = load.frequency - sense * shifts
            rates[np.abs(rates) <= _SAME_SPEED * abs(load.frequency)] = 0.0
            for rate in np.unique(rates[circular != 0.0]).tolist():
                yield replace(load, frequency=rate, amplitude=np.where(rates == rate, circular, 0.0))

    def turned(self, system: CoupledSystem, linear: Sequence[float], contacts: Sequence[float]) -> CoupledSystem:
        """Return a system assembled for t = 0 with connectors that turn with their frames.

        Parameters
        ----------
        system : CoupledSystem
        linear, contacts : sequence of float
            Speed of the frame of each linear connector and of each tooth contact [rad/s].
        """
        load, harmonic = system.load.copy(), list(system.harmonic_loads)
        connectors = []
        for connector, frame in zip(system.linear, linear, strict=True):
            parts = self.turning_parts(connector.directions, frame)
            connectors.append(replace(connector, turning=parts))
            if connector.offset is None:
                continue
            # The constant loads hold the connector's force at t = 0; it turns with the connector.
            for part in parts:
                load += part.cosine @ connector.offset
                phasor: ComplexArray = np.asarray(1j * part.sine - part.cosine, dtype=np.complex128)
                harmonic.append(HarmonicLoad(part.rate, np.asarray(phasor @ connector.offset), "turning"))
        frames = {connector.name: frame for connector, frame in zip(system.linear, linear, strict=True)}
        return replace(
            system,
            linear=tuple(connectors),
            contacts=tuple(
                self._turned_contact(contact, frame) for contact, frame in zip(system.contacts, contacts, strict=True)
            ),
            nonlinear=tuple(
                replace(law, turning=self.turning_parts(law.directions, frames[law.name])) for law in system.nonlinear
            ),
            load=load,
            harmonic_loads=tuple(harmonic),
        )

    def _turned_contact(self, contact: ContactConnector, frame: float) -> ContactConnector:
        sliding = contact.sliding
        if sliding is not None:
            sliding = replace(sliding, turning=self.turning_parts(sliding.directions, frame))
        turning = self.turning_parts(contact.direction[:, None], frame)
        return replace(contact, turning=turning, sliding=sliding)
