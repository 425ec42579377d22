"""Harmonic response of a machine with directions that turn: harmonic balance over the turning of its carriers.

Planets circle with their carrier, so that their meshes push parts that stand still, such as the housing, in directions
and at places that turn. The machine linear about its mean load has then periodic coefficients, at one or several rates
of turning f (Hill's equation). An excitation at ω moves it at all ω_m = ω + m·f, m whole numbers. With the connectors
that turn, of directions D(t) = Σ D_l e^{i l·f t} and laws φ = k δ + c δ', and Z(ω) the dynamic stiffness of all others,

    Z(ω_m) q_m + Σ_l D_l φ_{m-l} = F_m,     φ_m = (k + i ω_m c) (Σ_l D_lᵀ q_{m-l} - e_m),

F the loads and e the transmission errors of the connectors that turn. Only the few φ are sought: with the compliances
D_lᵀ Z⁻¹ D_l' between them, (I + S (k + iωc)) δ = δ_free. It is the amplitudes of the sidebands ω + m·f that a sensor on
the housing shows; a frozen picture of the carrier would put all of them into one line.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError, ModesError
from gearwhine.coupling.linear.eigenpairs import Eigenpairs, quadratic_eigenpairs
from gearwhine.coupling.linear.modal_superposition import SUM_RULE, superposed
from gearwhine.coupling.machine.connectors import TurningPart
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.statics.mean_mesh import ContactState

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Order = tuple[int, ...]
Excitation = tuple[Mapping[Order, ComplexArray], Mapping[int, complex]]
"""Loads on the coordinates by the order of their frequency, and errors of contacts that turn by their number [m]."""

SIDEBANDS = 6
"""Number of multiples of each rate of turning on either side of an excitation."""

_LARGEST_MULTIPLE = 12  # of a rate of turning that is a multiple of another one
_SAME_RATE = 1e-9  # relative difference of rates that are one


@dataclass(frozen=True, eq=False)
class _Turning:
    """A connector that turns: its stiffness and damping, and its directions by their order, (n, d) each."""

    stiffness: FloatArray
    damping: FloatArray
    directions: Mapping[Order, ComplexArray]


@dataclass(frozen=True, eq=False)
class TurningResponse:
    """A machine with directions that turn, linear about its mean load.

    Attributes
    ----------
    system : CoupledSystem
    contact : ContactState
        Tooth contacts about their mean forces.
    sidebands : int
        Number of multiples of each rate of turning that are followed on either side of an excitation.
    """

    system: CoupledSystem
    contact: ContactState
    sidebands: int = SIDEBANDS

    @cached_property
    def rates(self) -> tuple[float, ...]:
        """Rates of turning f of which all others are multiples [rad/s], ascending."""
        found: list[float] = []
        turning = [one.turning for one in self.system.linear] + [one.turning for one in self.system.contacts]
        parts = [part for some in turning for part in some]
        for rate in sorted({abs(part.rate) for part in parts}):
            if not any(self._multiple(rate, base) for base in found):
                found.append(rate)
        return tuple(found)

    @staticmethod
    def _multiple(rate: float, base: float) -> int:
        """Return the whole number that a rate is of another one; 0 where it is none."""
        number = round(rate / base)
        near = abs(rate - number * base) <= _SAME_RATE * abs(rate)
        return number if near and 1 <= abs(number) <= _LARGEST_MULTIPLE else 0

    @cached_property
    def orders(self) -> tuple[Order, ...]:
        """Orders m of the motions beside an excitation: m = 0 is the excitation's own frequency."""
        reach = range(-self.sidebands, self.sidebands + 1)
        return tuple(product(reach, repeat=len(self.rates)))

    @property
    def still(self) -> Order:
        """Order of the excitation itself, and of directions that stand still."""
        return tuple(0 for _ in self.rates)

    def shift(self, order: Order) -> float:
        """Frequency m·f of an order over the excitation's [rad/s]."""
        return float(np.dot(order, self.rates)) if order else 0.0

    @cached_property
    def _constant(self) -> tuple[FloatArray, FloatArray]:
        """Stiffness and damping without the connectors that turn, (n, n) both."""
        system = self.system
        stiffness, damping = system.own_stiffness.copy(), system.own_damping + system.gyroscopic
        for directions, law_stiffness, law_damping, turning in self._laws:
            if not turning:
                stiffness += directions @ law_stiffness @ directions.T
                damping += directions @ law_damping @ directions.T
        return stiffness, damping

    @cached_property
    def _laws(self) -> list[tuple[FloatArray, FloatArray, FloatArray, tuple[TurningPart, ...]]]:
        """Directions at t = 0, stiffness, damping and turning parts of linear connectors, then of contacts."""
        laws = []
        for connector in self.system.linear:
            # Flanks that are apart resist no tilting either.
            apart = connector.of_contact is not None and self.contact.stiffness[connector.of_contact] == 0.0
            factor = 0.0 if apart else 1.0
            laws.append(
                (connector.directions, factor * connector.stiffness, factor * connector.damping, connector.turning)
            )
        for number, tooth in enumerate(self.system.contacts):
            stiffness, damping = self.contact.stiffness[number], self.contact.damping[number]
            laws.append((tooth.direction[:, None], np.array([[stiffness]]), np.array([[damping]]), tooth.turning))
        return laws

    @cached_property
    def _turning(self) -> list[_Turning]:
        """The connectors that turn, linear ones first, in their order."""
        return [
            _Turning(stiffness, damping, self._by_order(directions, turning))
            for directions, stiffness, damping, turning in self._laws
            if turning
        ]

    def _by_order(self, directions: FloatArray, turning: Sequence[TurningPart]) -> dict[Order, ComplexArray]:
        """Fourier coefficients D_l of directions by their order l, (n, d) each."""
        still = self.still
        found: dict[Order, ComplexArray] = {still: directions.astype(np.complex128)}
        for part in turning:
            base = next(place for place, rate in enumerate(self.rates) if self._multiple(abs(part.rate), rate))
            number = self._multiple(abs(part.rate), self.rates[base]) * (1 if part.rate > 0.0 else -1)
            found[still] = found[still] - part.cosine
            for sense in (1, -1):
                order = tuple(sense * number if place == base else 0 for place in range(len(self.rates)))
                half = np.asarray(0.5 * (part.cosine - 1j * sense * part.sine), dtype=np.complex128)
                found[order] = found.get(order, np.zeros_like(half)) + half
        return found

    @cached_property
    def _columns(self) -> ComplexArray:
        """Directions D_l of all connectors that turn, side by side for each order l of them, (n, l d)."""
        parts = [
            one.directions.get(order, np.zeros((self.system.size, len(one.stiffness)), dtype=np.complex128))
            for order in self._offsets
            for one in self._turning
        ]
        return np.concatenate([np.zeros((self.system.size, 0)), *parts], axis=1)

    @cached_property
    def _offsets(self) -> list[Order]:
        """Orders l of the directions."""
        return sorted({order for one in self._turning for order in one.directions})

    @cached_property
    def _width(self) -> int:
        """Number d of the directions that turn."""
        return sum(len(one.stiffness) for one in self._turning)

    @cached_property
    def _pairs(self) -> Eigenpairs | None:
        """Eigenpairs without the connectors that turn; None where they cannot be superposed."""
        try:
            pairs = quadratic_eigenpairs(*self._constant)
        except ModesError:
            return None
        return pairs if pairs.sum_rule <= SUM_RULE else None

    @cached_property
    def _modal_columns(self) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Left and right vectors of the eigenpairs on the columns, (m, l d) both, and the drift between columns."""
        assert self._pairs is not None
        columns = self._columns
        drift = columns.T @ self._pairs.drift @ columns
        return self._pairs.left.conj() @ columns, self._pairs.right @ columns, np.asarray(drift)

    def _dynamic(self, w: float) -> ComplexArray:
        """Z at a frequency without the connectors that turn, (n, n)."""
        stiffness, damping = self._constant
        dynamic = np.asarray(stiffness + 1j * w * damping, dtype=np.complex128)
        dynamic[np.diag_indices(len(dynamic))] -= w**2
        return dynamic

    def _compliance(self, w: float) -> ComplexArray:
        """Compliance between all directions at a frequency, (l, d, l, d)."""
        shape = (len(self._offsets), self._width) * 2
        if self._pairs is None or w == 0.0:
            return np.asarray(self._columns.T @ np.linalg.solve(self._dynamic(w), self._columns)).reshape(shape)
        left, right, drift = self._modal_columns
        s = 1j * w
        gains = self._pairs.values / (s * (s - self._pairs.values))
        return np.asarray((right.T * gains) @ left + drift / s**2).reshape(shape)

    def _moved(self, w: float, loads: ComplexArray) -> ComplexArray:
        """Coordinates (n, i) under loads (n, i) at a frequency, without the connectors that turn."""
        if self._pairs is None or w == 0.0:
            return np.asarray(np.linalg.solve(self._dynamic(w), loads))
        return np.asarray(superposed(self._pairs, loads.T[None], np.array([w]))[0].T)

    def mesh_error(self, number: int, frequency: float) -> Excitation:
        """Load of a unit transmission error of a contact at ω [rad/s]: on coordinates by order, or as its own error.

        The error of flanks that turn is a deflection of their own connector; that of others is a load (k + iωc) d.
        """
        tooth = self.system.contacts[number]
        if tooth.turning:
            return {}, {number: 1.0}
        law = complex(self.contact.stiffness[number], frequency * self.contact.damping[number])
        return {self.still: np.asarray(law * tooth.direction, dtype=np.complex128)}, {}

    def respond(
        self,
        frequency: float,
        excitations: Sequence[Excitation],
        orders: Sequence[Order] | None = None,
    ) -> dict[Order, ComplexArray]:
        """Solve the motions at ω + m·f of excitations at ω.

        Parameters
        ----------
        frequency : float
            ω [rad/s].
        excitations : sequence of (mapping of order to ndarray of complex, shape (n,), mapping of int to complex)
            Of each excitation, loads on the coordinates by the order m of their frequency ω + m·f, and transmission
            errors at ω of contacts that turn, by the number of the contact [m].
        orders : sequence of order, optional
            Orders of the motions that are asked for; by default all.

        Returns
        -------
        dict of order to ndarray of complex, shape (i, n)
            Coordinates q_m of each excitation; the motion is Re Σ q_m e^{i(ω + m·f)t}.

        Raises
        ------
        CouplingError
            For an error of a contact that does not turn, or a load of an order that is not followed.
        """
        unknown = {order for loads, _ in excitations for order in loads} - set(self.orders)
        if unknown:
            raise CouplingError(f"loads of orders {sorted(unknown)}; expected orders among those that are followed")
        places = {order: number for number, order in enumerate(self.orders)}
        count, width = len(self.orders), self._width
        law = self._law(frequency)
        free = np.zeros((count, width, len(excitations)), dtype=np.complex128)
        between = np.zeros((count, width, count, width), dtype=np.complex128)
        loads = {
            order: np.array([one.get(order, np.zeros(self.system.size)) for one, _ in excitations]).T.astype(complex)
            for order in self.orders
            if any(order in one for one, _ in excitations)
        }
        for order in self.orders:
            w = frequency + self.shift(order)
            compliance = self._compliance(w)
            # Forces of order p act on this one by D_{m-p}; its motion deflects connectors of order p' by D_{p'-m}.
            gaps = list(enumerate(self._offsets))
            acting = [(n, places[other]) for n, gap in gaps if (other := _minus(order, gap)) in places]
            seen = [(n, places[other]) for n, gap in gaps if (other := _plus(order, gap)) in places]
            alone = None
            if order in loads:
                alone = (self._columns.T @ self._moved(w, loads[order])).reshape(len(self._offsets), width, -1)
            for row, deflected in seen:
                if alone is not None:
                    free[deflected] += alone[row]
                for column, force in acting:
                    between[deflected, :, force, :] += compliance[row, :, column, :]
        free[places[self.still]] -= np.array([self._error(errors) for _, errors in excitations]).T
        matrix = np.einsum("apbq,bqr->apbr", between, law, optimize=True).reshape(count * width, count * width)
        deflections = np.linalg.solve(np.eye(count * width) + matrix, free.reshape(count * width, -1))
        forces = np.einsum("bqr,bri->bqi", law, deflections.reshape(count, width, -1), optimize=True)
        motion = {}
        for order in self.orders if orders is None else orders:
            acting_load = loads.get(order, np.zeros((self.system.size, len(excitations)), dtype=np.complex128)).copy()
            for n, gap in enumerate(self._offsets):
                source = _minus(order, gap)
                if source in places:
                    acting_load -= self._columns[:, n * width : (n + 1) * width] @ forces[places[source]]
            motion[order] = self._moved(frequency + self.shift(order), acting_load).T
        return motion

    def _law(self, frequency: float) -> ComplexArray:
        """Laws k + i ω_m c of the connectors that turn by order, (m, d, d)."""
        law = np.zeros((len(self.orders), self._width, self._width), dtype=np.complex128)
        for number, order in enumerate(self.orders):
            w, begin = frequency + self.shift(order), 0
            for one in self._turning:
                own = slice(begin, begin + len(one.stiffness))
                law[number, own, own] = one.stiffness + 1j * w * one.damping
                begin = own.stop
        return law

    def _error(self, errors: Mapping[int, complex]) -> ComplexArray:
        """Errors of the contacts that turn over the directions of the connectors that do, (d,)."""
        found = np.zeros(self._width, dtype=np.complex128)
        turning = [number for number, tooth in enumerate(self.system.contacts) if tooth.turning]
        for number, error in errors.items():
            if number not in turning:
                raise CouplingError(
                    f"an error of {self.system.contacts[number].name}, which does not turn; expected its load instead"
                )
            found[self._width - len(turning) + turning.index(number)] = error
        return found


def _minus(first: Order, second: Order) -> Order:
    return tuple(a - b for a, b in zip(first, second, strict=True))


def _plus(first: Order, second: Order) -> Order:
    return tuple(a + b for a, b in zip(first, second, strict=True))
