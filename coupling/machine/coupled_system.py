"""Coupled system: components, connectors and loads in one set of modal coordinates, with its stiffness and damping."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector, NonlinearConnector, standing
from gearwhine.numerics.arrays import ComplexArray, FloatArray

AnyConnector = ContactConnector | LinearConnector | NonlinearConnector

_RIGID_MOTION_STIFFNESS = 1e-12  # stiffness below this part of the largest is a motion that nothing resists
_FREE_OVER_TURN = 1e-10  # force on a motion that nothing resists at all angles, over the largest stiffness
_WAVES, _WAVES_OF_TWO = 6, 4  # number of waves in a carrier's turn, and together in two's, that a mean is exact for
_TURNS = 1000  # largest number of turns of the slowest carrier until all stand as at first
_WHOLE = 1e-6  # distance from a whole number below which a ratio of rates is whole


def times_over_turn(rates: Sequence[float]) -> FloatArray:
    """Return times for means over a common turn of what turns at rates [rad/s], (t,) [s]; 0 where nothing turns.

    With p_i turns of the rate i in the common turn of duration T, the times are k T / t. A mean over them is exact for
    waves cos(a p_i + b p_j) 2πk/t unless t divides a p_i + b p_j, which is not zero: t is the least number at which
    none of |a| ≤ `_WAVES` and |a| + |b| ≤ `_WAVES_OF_TWO` is so, a rank-1 lattice over the angles of two carriers.
    Multiples of another rate are left out; rates without a common turn within `_TURNS` of the slowest have so many.
    """
    own, rate = _common_turns(rates)
    if not own:
        return np.zeros(1)
    among = range(-_WAVES_OF_TWO, _WAVES_OF_TWO + 1)
    waves = {a * p for p in own for a in range(1, _WAVES + 1)}
    waves |= {a * p + b * q for p in own for q in own for a in among for b in among if abs(a) + abs(b) <= _WAVES_OF_TWO}
    waves -= {0}
    count = next(count for count in itertools.count(_WAVES + 1) if not any(wave % count == 0 for wave in waves))
    return np.asarray(2.0 * np.pi / rate * np.arange(count) / count)


def _common_turns(rates: Sequence[float]) -> tuple[list[int], float]:
    """Count the turns in a common turn of rates that are no multiples of another one; rate of that turn [rad/s]."""
    sizes = np.unique(np.abs([rate for rate in rates if rate != 0.0]))
    if not sizes.size:
        return [], 0.0
    ratios = sizes / sizes[0]
    common = (n for n in range(1, _TURNS) if np.all(np.abs(n * ratios - np.rint(n * ratios)) < _WHOLE * n))
    turns = next(common, _TURNS)
    whole = np.rint(turns * ratios).astype(np.int64)
    own = [p for i, p in enumerate(whole.tolist()) if not any(p % other == 0 for other in whole[:i].tolist())]
    return own, float(sizes[0]) / turns


@dataclass(frozen=True)
class HarmonicLoad:
    """A harmonic load F(t) = Re(amplitude e^{i w t}) on the coordinates, such as an unbalance.

    Attributes
    ----------
    frequency : float
        Circular frequency w at the nominal speeds [rad/s].
    amplitude : ndarray of complex, shape (n,)
    follows : "time", "turning" or "unbalance"
        Dependence on the speed where it is not the nominal one, see
        :mod:`gearwhine.coupling.machine.speed_profile`: constant frequency; phase that follows the rotation,
        e^{iws}; or inertia force of an eccentric mass, (s'² - i s''/Ω) e^{iws}.
    mechanism : str
        What makes it, see :mod:`gearwhine.coupling.linear.line_mechanisms`.
    circling : float or None
        Rate Ω at which an eccentric mass circles in space [rad/s]; None where it is w. In coordinates of a frame that
        turns w is another.
    """

    frequency: float
    amplitude: ComplexArray
    follows: Literal["time", "turning", "unbalance"] = "time"
    mechanism: Literal[
        "unbalance",
        "shaft_bow",
        "torque_ripple",
        "base_motion",
        "load_shuttling",
        "transmission_error",
        "friction",
        "load",
    ] = "load"
    circling: float | None = None

    def harmonic_of(self, mesh_frequency: float) -> int:
        """Return the harmonic of a mesh frequency [Hz] that the load has."""
        return round(self.frequency / (2.0 * np.pi * abs(mesh_frequency)))

    @property
    def stands_in_a_frame(self) -> bool:
        """Whether it is a constant load that acts on coordinates of another frame."""
        return self.follows == "turning" and self.mechanism == "load"


@dataclass(frozen=True)
class TimedLoad:
    """A load that varies in time: direction times a value that is linear between the times, constant beyond them.

    Attributes
    ----------
    times : ndarray, shape (l,)
        Times [s], ascending.
    values : ndarray, shape (l,)
    direction : ndarray, shape (n,)
    """

    times: FloatArray
    values: FloatArray
    direction: FloatArray

    def __post_init__(self) -> None:
        """Require a value for each time, and times that ascend."""
        if self.times.shape != self.values.shape or self.times.ndim != 1 or not self.times.size:
            raise CouplingError(f"a load of {self.values.shape} values at {self.times.shape} times; expected as many")
        if np.any(np.diff(self.times) <= 0.0):
            raise CouplingError("the times of a load do not ascend")

    def at(self, time: float) -> FloatArray:
        """Interpolate the load at a time, shape (n,)."""
        return np.asarray(np.interp(time, self.times, self.values) * self.direction)


@dataclass(frozen=True)
class CoupledSystem:
    """All components, connectors and loads in one set of coordinates.

    The equation of motion is q'' + C q' + K q + Σ d f(δ, δ', t) = F + Σ Re(F_w e^{iwt}) with the tooth contacts and the
    nonlinear parts of bearings in the sum; all linear terms are in C and K.

    Attributes
    ----------
    components : tuple of Component
        Components, whose coordinates follow each other.
    speeds : tuple of float
        Signed speed of rotation of each component [rad/s]; 0 for the housing.
    linear : tuple of LinearConnector
    contacts : tuple of ContactConnector
    load : ndarray, shape (n,)
        Load F that is constant at the nominal speeds; zero by default.
    centrifugal_load : ndarray, shape (n,)
        The part of it that is proportional to s'²; zero by default.
    harmonic_loads : tuple of HarmonicLoad
    timed_loads : tuple of TimedLoad
    acceleration_load : ndarray, shape (n,)
        Load of an angular acceleration s'' = 1/s of the nominal speeds: the shafts' own inertia, and the torque that
        the drive adds to overcome it; zero by default.
    nonlinear : tuple of NonlinearConnector

    The directions d of connectors that turn change with the nominal time. All matrices here are those at the nominal
    time 0.
    """

    components: tuple[Component, ...]
    speeds: tuple[float, ...]
    linear: tuple[LinearConnector, ...] = ()
    contacts: tuple[ContactConnector, ...] = ()
    load: FloatArray = field(default_factory=lambda: np.zeros(0))
    harmonic_loads: tuple[HarmonicLoad, ...] = ()
    timed_loads: tuple[TimedLoad, ...] = ()
    acceleration_load: FloatArray = field(default_factory=lambda: np.zeros(0))
    centrifugal_load: FloatArray = field(default_factory=lambda: np.zeros(0))
    nonlinear: tuple[NonlinearConnector, ...] = ()

    def __post_init__(self) -> None:
        """Require a speed for each component, and loads of shape (n,); loads that are not given are zero."""
        if len(self.speeds) != len(self.components):
            raise CouplingError(f"{len(self.speeds)} speeds for {len(self.components)} components; expected as many")
        for attribute in ("load", "acceleration_load", "centrifugal_load"):
            if getattr(self, attribute).shape == (0,):
                object.__setattr__(self, attribute, np.zeros(self.size))
            if getattr(self, attribute).shape != (self.size,):
                raise CouplingError(f"a {attribute} of shape {getattr(self, attribute).shape}; expected ({self.size},)")

    @cached_property
    def size(self) -> int:
        """Number of coordinates, n."""
        return sum(component.size for component in self.components)

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """Kind of each coordinate."""
        return tuple(kind for component in self.components for kind in component.kinds)

    @cached_property
    def resolved(self) -> npt.NDArray[np.bool_]:
        """Coordinates whose own vibration is resolved in time, shape (n,): all but the residual ones.

        A residual coordinate responds as a spring. The frequency of its stiffness and mass is an artefact of the
        reduction, above every valid frequency of the component.
        """
        return np.array([kind != "residual" for kind in self.kinds])

    @cached_property
    def own_stiffness(self) -> FloatArray:
        """K of the components alone, with the terms of frames that turn [1/s²], shape (n, n)."""
        return self._blocks(
            [one.stiffness if one.frame is None else one.stiffness + one.frame.stiffness for one in self.components]
        )

    @cached_property
    def own_damping(self) -> FloatArray:
        """C of the components alone, without gyroscopic terms [1/s], shape (n, n)."""
        return self._blocks([component.damping for component in self.components])

    @cached_property
    def stiffness(self) -> FloatArray:
        """K without the tooth contacts [1/s²], shape (n, n)."""
        return self.own_stiffness + self.connector_matrices()[0]

    @cached_property
    def damping(self) -> FloatArray:
        """C with the gyroscopic terms and without the tooth contacts [1/s], shape (n, n)."""
        return self.own_damping + self.gyroscopic + self.connector_matrices()[1]

    @cached_property
    def gyroscopic(self) -> FloatArray:
        """G of all components, each times its nominal speed, and Coriolis terms [1/s], (n, n): skew, a part of C."""
        terms = []
        for component, speed in zip(self.components, self.speeds, strict=True):
            own = speed * component.gyroscopic
            terms.append(own if component.frame is None else own + component.frame.coriolis)
        return self._blocks(terms)

    @cached_property
    def connector_speed_ratios(self) -> FloatArray:
        """Speeds, as parts of the nominal ones, between which the linear connectors change linearly, shape (t,)."""
        tables = [connector.over_speed.speed_ratios for connector in self.linear if connector.over_speed is not None]
        return np.unique(np.concatenate(tables)) if tables else np.ones(1)

    def connector_matrices(self, speed_ratio: float = 1.0) -> tuple[FloatArray, FloatArray]:
        """Stiffness and damping of the linear connectors at a part of the nominal speeds, shapes (n, n)."""
        stiffness, damping = np.zeros((self.size, self.size)), np.zeros((self.size, self.size))
        for connector in self.linear:
            law = (connector.stiffness, connector.damping)
            if connector.over_speed is not None:
                law = connector.over_speed.at(speed_ratio)
            for total, matrix in zip((stiffness, damping), law, strict=True):
                total += connector.directions @ matrix @ connector.directions.T
        return stiffness, damping

    @cached_property
    def contact_directions(self) -> FloatArray:
        """Directions of the tooth contacts, shape (n, n_contacts)."""
        return np.array([contact.direction for contact in self.contacts]).reshape(-1, self.size).T

    @cached_property
    def turning_names(self) -> tuple[str, ...]:
        """Names of the connectors whose directions turn, once each."""
        connectors: list[AnyConnector] = [*self.contacts, *self.linear, *self.nonlinear]
        names = [one.name for one in connectors if one.turning]
        names += [one.name for one in self.contacts if one.sliding is not None and one.sliding.turning]
        return tuple(dict.fromkeys(names))

    @cached_property
    def turning_rates(self) -> tuple[float, ...]:
        """Rates at which directions turn at the nominal speeds, ascending [rad/s]."""
        connectors: list[AnyConnector] = [*self.contacts, *self.linear, *self.nonlinear]
        turning = [one.turning for one in connectors]
        turning += [one.sliding.turning for one in self.contacts if one.sliding is not None]
        return tuple(sorted({part.rate for parts in turning for part in parts}))

    @property
    def turns(self) -> bool:
        """Whether directions of connectors turn, as of planets against a housing that stands still."""
        return any(connector.turning for connector in self.linear) or any(contact.turning for contact in self.contacts)

    @cached_property
    def turn_times(self) -> FloatArray:
        """Nominal times for means over a common turn of the directions [s], (t,), see `times_over_turn`."""
        return times_over_turn(self.turning_rates if self.turns else ())

    @property
    def base_rates(self) -> tuple[float, ...]:
        """Rates of turning of which all others are multiples, as `turn_times` has them [rad/s], ascending."""
        own, rate = _common_turns(self.turning_rates if self.turns else ())
        return tuple(number * rate for number in own)

    @cached_property
    def over_turn(self) -> tuple["CoupledSystem", ...]:
        """The system as it stands at each of `turn_times`, see `standing`."""
        return tuple(map(self.standing, self.turn_times.tolist())) if self.turns else (self,)

    @cached_property
    def free_over_turn(self) -> tuple[FloatArray, ...]:
        """Rigid-body motions of each system of `over_turn`, mostly the same, see `rigid_body_motions`."""
        rigid, stiffest = self.rigid_body_motions
        largest = _FREE_OVER_TURN * stiffest
        return tuple(
            rigid if np.abs(one.mean_stiffness @ rigid).max(initial=0.0) <= largest else one.rigid_body_motions[0]
            for one in self.over_turn
        )

    def standing(self, time: float) -> "CoupledSystem":
        """Return the system as it stands at a nominal time [s], with the loads that are constant in any frame.

        A load that stands still, such as weight, is a harmonic one on coordinates that turn; where the carriers stand
        it is constant.
        """
        circling = [load for load in self.harmonic_loads if load.stands_in_a_frame]
        if not circling and not self.turns:
            return self
        load = sum(((one.amplitude * np.exp(1j * one.frequency * time)).real for one in circling), self.load)
        return replace(
            self,
            load=load,
            harmonic_loads=tuple(one for one in self.harmonic_loads if not one.stands_in_a_frame),
            linear=tuple(standing(one, time) for one in self.linear),
            contacts=tuple(one.standing(time) for one in self.contacts),
            nonlinear=tuple(standing(one, time) for one in self.nonlinear),
        )

    @property
    def is_smooth(self) -> bool:
        """Whether the tooth contacts, without friction, are the only nonlinearity."""
        return not self.nonlinear and all(contact.sliding is None for contact in self.contacts)

    @cached_property
    def loaded_flank_stiffness(self) -> FloatArray:
        """Unloaded mean mesh stiffness of the flanks that carry, 0 of the others [N/m], shape (c,)."""
        return np.array(
            [contact.contact.unloaded_mean_mesh_stiffness * contact.loaded for contact in self.contacts],
            dtype=np.float64,
        )

    @cached_property
    def loaded_flank_damping(self) -> FloatArray:
        """Mesh damping of the flanks that carry, 0 of the others [N s/m], shape (c,)."""
        return np.array([contact.contact.damping * contact.loaded for contact in self.contacts], dtype=np.float64)

    @cached_property
    def mean_stiffness(self) -> FloatArray:
        """K with the flanks that carry at their unloaded mean mesh stiffness [1/s²], shape (n, n)."""
        return self.stiffness + (self.contact_directions * self.loaded_flank_stiffness) @ self.contact_directions.T

    @cached_property
    def mean_damping(self) -> FloatArray:
        """C with the damping of the loaded flanks [1/s], shape (n, n)."""
        return self.damping + (self.contact_directions * self.loaded_flank_damping) @ self.contact_directions.T

    @cached_property
    def highest_frequency(self) -> float:
        """Highest natural frequency of the resolved coordinates, with the residual ones fixed [rad/s]."""
        stiffness = self.mean_stiffness[np.ix_(self.resolved, self.resolved)]
        return float(np.sqrt(np.abs(np.linalg.eigvals(stiffness)).max(initial=0.0)))

    @cached_property
    def rigid_body_motions(self) -> tuple[FloatArray, float]:
        """Rigid-body motions: orthonormal motions that no spring resists, in columns; and the largest stiffness [1/s²].

        Teeth and nonlinear bearings count with their linear stiffness.
        """
        values, vectors = np.linalg.eigh(0.5 * (self.mean_stiffness + self.mean_stiffness.T))
        return vectors[:, np.abs(values) < _RIGID_MOTION_STIFFNESS * max(abs(values[-1]), 1e-300)], float(values[-1])

    def _blocks(self, matrices: Sequence[FloatArray]) -> FloatArray:
        total = np.zeros((self.size, self.size))
        start = 0
        for matrix in matrices:
            end = start + len(matrix)
            total[start:end, start:end] = matrix
            start = end
        return total


def embed(components: Sequence[Component], which: int, directions: FloatArray) -> FloatArray:
    """Directions of one component, shape (..., m), as directions of the whole system, shape (..., n)."""
    whole = np.zeros((*directions.shape[:-1], sum(component.size for component in components)))
    start = sum(component.size for component in components[:which])
    whole[..., start : start + components[which].size] = directions
    return whole
