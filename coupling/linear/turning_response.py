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

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.connectors import TurningPart
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.statics.mean_mesh import ContactState

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Order = tuple[int, ...]

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
    def _still(self) -> Order:
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
        still = self._still
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

    def _columns(self, order: Order) -> ComplexArray:
        """Directions D_l of all connectors that turn, side by side, (n, d)."""
        parts = [
            one.directions.get(order, np.zeros((self.system.size, len(one.stiffness)), dtype=np.complex128))
            for one in self._turning
        ]
        return np.concatenate([np.zeros((self.system.size, 0)), *parts], axis=1)

    def mesh_error_load(self, number: int, frequency: float) -> tuple[dict[Order, ComplexArray], dict[int, complex]]:
        """Load of a unit transmission error of a contact at ω [rad/s]: on coordinates by order, or as its own error.

        The error of flanks that turn is a deflection of their own connector; that of others is a load (k + iωc) d.
        """
        tooth = self.system.contacts[number]
        if tooth.turning:
            return {}, {number: 1.0}
        law = complex(self.contact.stiffness[number], frequency * self.contact.damping[number])
        return {self._still: np.asarray(law * tooth.direction, dtype=np.complex128)}, {}

    def respond(
        self, frequency: float, loads: Mapping[Order, ComplexArray], errors: Mapping[int, complex] | None = None
    ) -> dict[Order, ComplexArray]:
        """Solve the motions at ω + m·f of an excitation at ω.

        Parameters
        ----------
        frequency : float
            ω [rad/s].
        loads : mapping of order to ndarray of complex, shape (n,)
            Loads on the coordinates, by the order m of their frequency ω + m·f.
        errors : mapping of int to complex, optional
            Transmission errors at ω of contacts that turn, by the number of the contact [m].

        Returns
        -------
        dict of order to ndarray of complex, shape (n,)
            Coordinates q_m; the motion is Re Σ q_m e^{i(ω + m·f)t}.

        Raises
        ------
        CouplingError
            For an error of a contact that does not turn, or a load of an order that is not followed.
        """
        unknown = set(loads) - set(self.orders)
        if unknown:
            raise CouplingError(f"loads of orders {sorted(unknown)}; expected orders among those that are followed")
        stiffness, damping = self._constant
        offsets = sorted({order for one in self._turning for order in one.directions})
        columns = {order: self._columns(order) for order in offsets}
        width = columns[offsets[0]].shape[1] if offsets else 0
        places = {order: number for number, order in enumerate(self.orders)}
        count = len(self.orders)
        free = np.zeros((count, width), dtype=np.complex128)
        between = np.zeros((count, width, count, width), dtype=np.complex128)
        alone: dict[Order, ComplexArray] = {}
        answers: dict[Order, dict[Order, ComplexArray]] = {}
        for order in self.orders:
            w = frequency + self.shift(order)
            dynamic = np.asarray(stiffness + 1j * w * damping, dtype=np.complex128)
            dynamic[np.diag_indices(len(dynamic))] -= w**2
            # Forces of order p act on this one by D_{m-p}, and this motion deflects connectors of order p' by D_{p'-m}.
            acting = {other: columns[gap] for other in self.orders if (gap := _minus(order, other)) in columns}
            seen = {other: columns[gap] for other in self.orders if (gap := _minus(other, order)) in columns}
            load = loads.get(order, np.zeros(self.system.size, dtype=np.complex128))
            driven = np.column_stack([load, *acting.values()])
            solved: ComplexArray = np.asarray(np.linalg.solve(dynamic, driven), dtype=np.complex128)
            alone[order] = np.asarray(solved[:, 0])
            answers[order] = {other: solved[:, 1 + n * width : 1 + (n + 1) * width] for n, other in enumerate(acting)}
            for deflected, rows in seen.items():
                free[places[deflected]] += rows.T @ alone[order]
                for other, answer in answers[order].items():
                    between[places[deflected], :, places[other], :] += rows.T @ answer
        free[places[self._still]] -= self._errors(errors or {}, width)
        law = self._law_of(frequency, width)
        matrix = np.einsum("apbq,bqr->apbr", between, law).reshape(count * width, count * width)
        deflections = np.linalg.solve(np.eye(count * width) + matrix, free.ravel()).reshape(count, width)
        forces = np.einsum("bqr,br->bq", law, deflections)
        return {
            order: alone[order]
            - sum(
                (answer @ forces[places[other]] for other, answer in answers[order].items()),
                np.zeros(self.system.size, dtype=np.complex128),
            )
            for order in self.orders
        }

    def _law_of(self, frequency: float, width: int) -> ComplexArray:
        """Laws k + i ω_m c of the connectors that turn by order, (m, d, d)."""
        law = np.zeros((len(self.orders), width, width), dtype=np.complex128)
        for number, order in enumerate(self.orders):
            w, begin = frequency + self.shift(order), 0
            for one in self._turning:
                own = slice(begin, begin + len(one.stiffness))
                law[number, own, own] = one.stiffness + 1j * w * one.damping
                begin = own.stop
        return law

    def _errors(self, errors: Mapping[int, complex], width: int) -> ComplexArray:
        """Errors of the contacts that turn over the directions of the connectors that do, (d,)."""
        found = np.zeros(width, dtype=np.complex128)
        turning = [number for number, tooth in enumerate(self.system.contacts) if tooth.turning]
        for number, error in errors.items():
            if number not in turning:
                raise CouplingError(
                    f"an error of {self.system.contacts[number].name}, which does not turn; expected its load instead"
                )
            found[width - len(turning) + turning.index(number)] = error
        return found


def _minus(first: Order, second: Order) -> Order:
    return tuple(a - b for a, b in zip(first, second, strict=True))
