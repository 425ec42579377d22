"""Harmonic response of a machine with directions that turn: harmonic balance over the turning of its carriers.

Planets circle with their carrier, so that their meshes push parts that stand still, such as the housing, in directions
and at places that turn. The machine linear about its mean load has then periodic coefficients, at one or several rates
of turning f (Hill's equation). An excitation at ω moves it at all ω_m = ω + m·f, m whole numbers. With the connectors
that turn, of directions D(t) = Σ D_l e^{i l·f t} and laws φ = k δ + c δ', and Z(ω) the dynamic stiffness of all others,

    Z(ω_m) q_m + Σ_l D_l φ_{m-l} = F_m,     φ_m = (k + i ω_m c) (Σ_l D_lᵀ q_{m-l} - e_m),

F the loads and e the transmission errors. Only the few φ are sought, those of tooth contacts that stand still too: with
the compliances D_lᵀ Z⁻¹ D_l' between them, (I + S (k + iωc)) δ = δ_free. Without the connectors sought, parts of a
train turn freely: at orders where ω_m is all but zero, springs κ on these motions are added to Z, and springs -κ to the
connectors sought. Z falls into parts that these alone couple, each solved on its own
(:mod:`gearwhine.coupling.linear.dynamic_stiffness`).

It is the amplitudes of the sidebands ω + m·f that a sensor on the housing shows; a frozen picture of the carrier would
put all of them into one line.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.linear.dynamic_stiffness import DynamicStiffness
from gearwhine.coupling.machine.connectors import TurningPart
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.statics.mean_mesh import ContactState

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]
Order = tuple[int, ...]
Excitation = tuple[Mapping[Order, ComplexArray], Mapping[int, complex]]
"""Loads on the coordinates by the order of their frequency, and errors of contacts by their number [m]."""

SIDEBANDS = 6
"""Number of times that connectors hand a motion on to other orders."""

_LARGEST_MULTIPLE = 12  # of a rate of turning that is a multiple of another one
_LARGEST_DENOMINATOR = 3  # of the ratio of two rates that are both multiples of a third
_SAME_RATE = 1e-9  # relative difference of rates that are one
_DEPENDENT = 1e-14  # singular value of columns of size one that is rounding
_RESTRAINT = 17.3  # frequency of a free motion on its spring, over the largest rate
_FREE_MOTION = 1e-9  # part of the largest stiffness up to which a motion is free
_STANDSTILL = 1e-9  # part of the largest rate up to which a frequency is zero
_SLOW = 0.1  # part of the largest rate up to which free motions have springs
_SAME_SHIFT = 1e-6  # part of the largest rate by which shifts of one order differ from rounding


@dataclass(frozen=True, eq=False)
class _Sought:
    """A connector whose force is sought: its stiffness and damping, and its directions by their order, (n, d) each."""

    stiffness: FloatArray
    damping: FloatArray
    directions: Mapping[Order, ComplexArray]


@dataclass(frozen=True, eq=False)
class _Part:
    """Coordinates that the connectors sought alone couple to all others, and the columns that touch them.

    Attributes
    ----------
    coordinates : ndarray of int, shape (n,)
    columns : ndarray of int, shape (c,)
        Numbers of the columns among all.
    basis : ndarray, shape (n, r)
        Basis of the columns: many are sums of others.
    mix : ndarray of complex, shape (r, c)
        The columns as sums of the basis.
    free, restrained : DynamicStiffness
        Without the connectors sought, and with springs on free motions too.
    """

    coordinates: IntArray
    columns: IntArray
    basis: FloatArray
    mix: ComplexArray
    free: DynamicStiffness
    restrained: DynamicStiffness


@dataclass(frozen=True, eq=False)
class _Reach:
    """Columns of a part by which its motion of an order deflects connectors, and by which their forces act on it.

    With each column, a number among those of the part, stands the place of the connector's direction and order among
    the unknowns: of the order m + l that a motion of m deflects, and of m - l whose force acts on it.
    """

    seen: IntArray
    deflected: IntArray
    acting: IntArray
    acted: IntArray


@dataclass(frozen=True, eq=False)
class _Balance:
    """Harmonic balance about an excitation: the unknowns are deflections of the connectors sought by order.

    Attributes
    ----------
    frequencies : mapping of order to complex
        ω_m [rad/s].
    stands : bool
        Whether one of these is zero.
    unknowns : mapping of order to slice
        Unknowns of each order.
    sought : ndarray of int
        Unknown of each direction at each order; -1 where none is.
    reaches : mapping of order to list of _Reach
        Of each part.
    compliance : ndarray of complex, shape (u, u)
        S transposed: by force and deflection, without the connectors sought.
    by_loads : list of (ndarray of int, ndarray of complex)
        Unknowns, and their deflections by the loads without the connectors sought.
    motions : mapping of order to list of ndarray of complex
        Motions of each part under unit forces along its basis, and under the loads, of each order that is asked for.
    """

    frequencies: Mapping[Order, complex]
    stands: bool
    unknowns: Mapping[Order, slice]
    sought: IntArray
    reaches: Mapping[Order, list[_Reach]]
    compliance: ComplexArray
    by_loads: list[tuple[IntArray, ComplexArray]]
    motions: Mapping[Order, list[ComplexArray]]

    def deflected(self, count: int) -> ComplexArray:
        """Deflections by some loads without the connectors sought, (u, i)."""
        found = np.zeros((len(self.compliance), count), dtype=np.complex128)
        for unknowns, deflections in self.by_loads:
            found[unknowns] += deflections
        return found


@dataclass(frozen=True, eq=False)
class TurningResponse:
    """A machine with directions that turn, linear about its mean load.

    Attributes
    ----------
    system : CoupledSystem
    contact : ContactState
        Tooth contacts about their mean forces.
    sidebands : int
        Number of times that connectors that turn may hand a motion on, each time by the orders of their directions.
        Sums of as many of these orders are followed, up to that number or half again the highest of them.
    """

    system: CoupledSystem
    contact: ContactState
    sidebands: int = SIDEBANDS

    @cached_property
    def rates(self) -> tuple[float, ...]:
        """Rates of turning f of which all others are multiples [rad/s], ascending.

        Rates of one carrier, such as 2 f and 3 f of a ring that bends, have its speed f as their base.
        """
        found: list[float] = []
        turning = [one.turning for one in self.system.linear] + [one.turning for one in self.system.contacts]
        parts = [part for some in turning for part in some]
        for rate in sorted({abs(part.rate) for part in parts}):
            if any(0 < self._multiple(rate, base) <= _LARGEST_MULTIPLE for base in found):
                continue
            for place, base in enumerate(found):
                parts_of_base = [base / q for q in range(2, _LARGEST_DENOMINATOR + 1)]
                divided = [part for part in parts_of_base if 0 < self._multiple(rate, part) <= _LARGEST_MULTIPLE]
                if divided:
                    found[place] = divided[0]
                    break
            else:
                found.append(rate)
        return tuple(sorted(found))

    @staticmethod
    def _multiple(rate: float, base: float) -> int:
        """Return the whole number that a rate is of another one; 0 where it is none."""
        number = round(rate / base)
        near = abs(rate - number * base) <= _SAME_RATE * abs(rate)
        return number if near else 0

    @cached_property
    def orders(self) -> tuple[Order, ...]:
        """Orders m of the motions beside an excitation: m = 0 is the excitation's own frequency."""
        # A bore's high orders reach far in few steps. Half again as far, sensors of the bundled planetary stage move as
        # with twice as far, but for 3e-4.
        farthest = np.abs(self._offsets).max(axis=0, initial=0)
        bounds = np.maximum(self.sidebands, (3 * farthest + 1) // 2)
        reached = {self.still}
        for _ in range(self.sidebands):
            next_orders = {plus(order, step) for order in reached for step in self._offsets}
            reached |= {order for order in next_orders if np.all(np.abs(order) <= bounds)}
        return tuple(sorted(reached))

    @property
    def still(self) -> Order:
        """Order of the excitation itself, and of directions that stand still."""
        return tuple(0 for _ in self.rates)

    @cached_property
    def _places(self) -> dict[Order, int]:
        """Place of each order among all."""
        return {order: place for place, order in enumerate(self.orders)}

    def shift(self, order: Order) -> float:
        """Frequency m·f of an order over the excitation's [rad/s]."""
        return float(np.dot(order, self.rates)) if order else 0.0

    @cached_property
    def _unrestrained(self) -> tuple[FloatArray, FloatArray]:
        """Stiffness and damping without the connectors sought, (n, n) both."""
        system = self.system
        stiffness, damping = system.own_stiffness.copy(), system.own_damping + system.gyroscopic
        for (directions, law_stiffness, law_damping, _), sought in zip(self._laws, self._is_sought, strict=True):
            if not sought:
                stiffness += directions @ law_stiffness @ directions.T
                damping += directions @ law_damping @ directions.T
        return stiffness, damping

    @cached_property
    def _restraint(self) -> tuple[FloatArray, float]:
        """Motions that no connector but those sought resists, (n, r), and the stiffness κ that is put on them."""
        stiffness = self._unrestrained[0]
        free_motions = [np.zeros((len(stiffness), 0))]
        for block in self._blocks:
            own = stiffness[np.ix_(block, block)]
            values, vectors = np.linalg.eigh(0.5 * (own + own.T))
            free = np.abs(values) <= _FREE_MOTION * max(abs(values[-1]), 1e-300)
            motions = np.zeros((len(stiffness), np.count_nonzero(free)))
            motions[block] = vectors[:, free]
            free_motions.append(motions)
        # No multiple of the rates is near √κ; small beside other springs, κ costs no digits.
        return np.concatenate(free_motions, axis=1), (_RESTRAINT * max(self.rates, default=1.0)) ** 2

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

    @property
    def _is_sought(self) -> list[bool]:
        """Whether the force of each law is sought: connectors that turn, and all contacts."""
        linear = [bool(connector.turning) for connector in self.system.linear]
        return linear + [True] * len(self.system.contacts)

    @cached_property
    def _connectors(self) -> list[_Sought]:
        """Springs that undo those on free motions, then the connectors sought, linear ones first, in their order."""
        free, spring = self._restraint
        count = free.shape[1]
        undoing = _Sought(-spring * np.eye(count), np.zeros((count, count)), {self.still: free.astype(np.complex128)})
        return [
            *([undoing] if count else []),
            *(
                _Sought(stiffness, damping, self.directions_by_order(directions, turning))
                for (directions, stiffness, damping, turning), sought in zip(self._laws, self._is_sought, strict=True)
                if sought
            ),
        ]

    def directions_by_order(self, directions: FloatArray, turning: Sequence[TurningPart]) -> dict[Order, ComplexArray]:
        """Fourier coefficients D_l of directions by their order l, (n, d) each."""
        still = self.still
        found: dict[Order, ComplexArray] = {still: directions.astype(np.complex128)}
        for part in turning:
            found[still] = found[still] - part.cosine
            for order, sense in self._pair(part):
                half = np.asarray(0.5 * (part.cosine - 1j * sense * part.sine), dtype=np.complex128)
                found[order] = found.get(order, np.zeros_like(half)) + half
        return found

    @cached_property
    def _columns(self) -> tuple[ComplexArray, list[Order], IntArray]:
        """Directions D_l that are not zero, (n, c), the order l of each, and its number among the d directions."""
        columns, orders, numbers = [np.zeros((self.system.size, 0), dtype=np.complex128)], [], []
        first = 0
        for one in self._connectors:
            for order, directions in one.directions.items():
                moving = np.flatnonzero(np.any(directions != 0.0, axis=0))
                columns.append(directions[:, moving])
                orders += [order] * len(moving)
                numbers += (first + moving).tolist()
            first += len(one.stiffness)
        return np.concatenate(columns, axis=1), orders, np.array(numbers, dtype=np.int64)

    @cached_property
    def _reached(self) -> dict[tuple[Order, bool], list[_Reach]]:
        """Columns of each part by which motions of an order and connectors meet, with those of free motions or not.

        Directions of free motions stand still, and meet the motion of their own order alone.
        """
        _, orders, numbers = self._columns
        places = self._places

        def reached(
            order: Order, step: Callable[[Order, Order], Order], part: _Part, first: int
        ) -> tuple[IntArray, IntArray]:
            meeting = [(n, column) for n, column in enumerate(part.columns.tolist()) if numbers[column] >= first]
            at = [(n, places.get(step(order, orders[column]), -1)) for n, column in meeting]
            columns = np.array([n for n, place in at if place >= 0], dtype=np.int64)
            places_of = np.array([place for _, place in at if place >= 0], dtype=np.int64)
            return columns, places_of * self._width + numbers[part.columns[columns]]

        return {
            (order, restrained): [
                _Reach(*reached(order, plus, part, first), *reached(order, _minus, part, first)) for part in self._parts
            ]
            for restrained, first in ((True, 0), (False, self._restraint[0].shape[1]))
            for order in self.orders
        }

    @cached_property
    def _parts(self) -> list[_Part]:
        """Parts of the machine that the connectors sought alone couple; coordinates without any coupling are one."""
        stiffness, damping = self._unrestrained
        free, spring = self._restraint
        columns = self._columns[0]
        blocks = [block for block in self._blocks if block.size > 1]
        alone = [block for block in self._blocks if block.size == 1]
        parts = []
        for block in [*blocks, *([np.concatenate(alone)] if alone else [])]:
            touching = np.flatnonzero(np.any(columns[block] != 0.0, axis=0))
            own = columns[np.ix_(block, touching)]
            sizes = np.linalg.norm(own, axis=0)
            # With each column its conjugate is one too, so that the real and imaginary parts have no larger span.
            left, values, _ = np.linalg.svd(np.concatenate([own.real / sizes, own.imag / sizes], axis=1))
            basis = left[:, : int(np.count_nonzero(values > _DEPENDENT * values.max(initial=0.0)))]
            square = np.ix_(block, block)
            diagonals = np.array([np.diag(self.system.own_stiffness)[block], np.diag(self.system.own_damping)[block]])
            dynamic = DynamicStiffness(stiffness[square], damping[square], diagonals)
            restrained = replace(dynamic, stiffness=dynamic.stiffness + spring * free[block] @ free[block].T)
            parts.append(_Part(block, touching, basis, basis.T @ own, dynamic, restrained))
        return parts

    @cached_property
    def _offsets(self) -> list[Order]:
        """Orders l of the directions."""
        turning = [*(one.turning for one in self.system.linear), *(one.turning for one in self.system.contacts)]
        return sorted({self.still, *(order for parts in turning for part in parts for order, _ in self._pair(part))})

    def _pair(self, part: TurningPart) -> Iterator[tuple[Order, int]]:
        """Yield both orders of a part of directions that turns, each with its sense."""
        base = next(place for place, rate in enumerate(self.rates) if self._multiple(abs(part.rate), rate))
        number = self._multiple(abs(part.rate), self.rates[base]) * (1 if part.rate > 0.0 else -1)
        for sense in (1, -1):
            yield tuple(sense * number if place == base else 0 for place in range(len(self.rates))), sense

    @cached_property
    def _width(self) -> int:
        """Number d of the directions sought."""
        return sum(len(one.stiffness) for one in self._connectors)

    @cached_property
    def _blocks(self) -> list[IntArray]:
        """Coordinates of parts that are coupled by the connectors sought alone, or not at all."""
        coupled = sparse.csr_array(np.any([part != 0.0 for part in self._unrestrained], axis=0))
        count, labels = sparse.csgraph.connected_components(coupled, directed=False)
        return [np.flatnonzero(labels == number) for number in range(count)]

    def respond(
        self,
        frequency: complex,
        excitations: Sequence[Excitation],
        orders: Sequence[Order] | None = None,
    ) -> dict[Order, ComplexArray]:
        """Solve the motions at ω + m·f of excitations at ω.

        Parameters
        ----------
        frequency : complex
            ω [rad/s]; complex for the motion e^{iωt} of growing or decaying excitations.
        excitations : sequence of (mapping of order to ndarray of complex, shape (n,), mapping of int to complex)
            Of each excitation, loads on the coordinates by the order m of their frequency ω + m·f, and transmission
            errors at ω of contacts, by the number of the contact [m].
        orders : sequence of order, optional
            Orders of the motions that are asked for; by default all.

        Returns
        -------
        dict of order to ndarray of complex, shape (i, n)
            Coordinates q_m of each excitation; the motion is Re Σ q_m e^{i(ω + m·f)t}.

        Raises
        ------
        CouplingError
            For a load of an order that is not followed.
        """
        unknown = {order for loads, _ in excitations for order in loads} - set(self.orders)
        if unknown:
            raise CouplingError(f"loads of orders {sorted(unknown)}; expected orders among those that are followed")
        loads = {
            order: np.array([one.get(order, np.zeros(self.system.size)) for one, _ in excitations]).T.astype(complex)
            for order in self.orders
            if any(order in one for one, _ in excitations)
        }
        balance = self._balance(frequency, loads, set(self.orders if orders is None else orders))
        deflections = balance.deflected(len(excitations))
        errors = np.array([self._error(errors) for _, errors in excitations]).T
        still = balance.unknowns[self.still]
        deflections[still] -= errors[_last(still, self._width)]
        solved = self._solved(balance, deflections)
        forces = np.concatenate([self._law(balance, order) @ solved[own] for order, own in balance.unknowns.items()])
        motion = {}
        for order, motions in balance.motions.items():
            total = np.zeros((self.system.size, len(excitations)), dtype=np.complex128)
            for part, reach, alone in zip(self._parts, balance.reaches[order], motions, strict=True):
                rank = part.basis.shape[1]
                own_motion = -alone[:, :rank] @ (part.mix[:, reach.acting] @ forces[balance.sought[reach.acted]])
                total[part.coordinates] = own_motion + alone[:, rank:] if order in loads else own_motion
            motion[order] = total.T
        return motion

    def compressions(
        self, frequency: float, contacts: Sequence[int], excitation: Mapping[Order, ComplexArray]
    ) -> tuple[ComplexArray, ComplexArray]:
        """Compressions of contacts at ω + m·f, with all connectors as they are.

        Parameters
        ----------
        frequency : float
            ω [rad/s]. At 0, what is constant in time leaves the train's own turning open, which compresses nothing.
        contacts : sequence of int
            Numbers of the contacts.
        excitation : mapping of order to ndarray of complex, shape (n,)
            Loads on the coordinates by the order of their frequency.

        Returns
        -------
        (ndarray of complex, shape (m, c, m, c), ndarray of complex, shape (m, c))
            By order and contact those by unit forces along each contact at each order [m/N], and by the excitation [m].
        """
        balance = self._balance(frequency, {order: load[:, None] for order, load in excitation.items()}, set())
        first = self._width - len(self.system.contacts)
        places = np.arange(len(self.orders))[:, None] * self._width + first + np.asarray(contacts, dtype=np.int64)
        unknowns = balance.sought[places.ravel()]
        deflections = np.concatenate([balance.compliance[unknowns].T, balance.deflected(1)], axis=1)
        found = self._solved(balance, deflections)[unknowns]
        return found[:, :-1].reshape(*places.shape, *places.shape), found[:, -1].reshape(places.shape)

    def _balance(self, frequency: complex, loads: Mapping[Order, ComplexArray], asked: Set[Order]) -> _Balance:
        """Set up the harmonic balance of loads at ω by order, (n, i) each, with motions at the orders asked for."""
        scale = max(self.rates, default=0.0)
        at = {order: frequency + self.shift(order) for order in self.orders}
        stands = min(map(abs, at.values())) <= _STANDSTILL * scale
        # Free motions have springs, which are undone, where nothing else but little inertia resists them.
        is_restrained = {order: bool(stands or abs(w) <= _SLOW * scale) for order, w in at.items()}
        unknowns, sought = {}, np.full(len(self.orders) * self._width, -1, dtype=np.int64)
        end = 0
        for place, order in enumerate(self.orders):
            free = 0 if is_restrained[order] else self._restraint[0].shape[1]
            unknowns[order] = slice(end, end + self._width - free)
            end += self._width - free
            sought[place * self._width + free : (place + 1) * self._width] = np.arange(end)[unknowns[order]]
        compliance = np.zeros((end, end), dtype=np.complex128)
        deflections, moved = [], {}
        reaches = {order: self._reached[order, is_restrained[order]] for order in self.orders}
        for order, w in at.items():
            motions = []
            for part, reach in zip(self._parts, reaches[order], strict=True):
                basis, mix, rank = part.basis, part.mix, part.basis.shape[1]
                pushed = np.concatenate([basis, loads[order][part.coordinates]], axis=1) if order in loads else basis
                alone = (part.restrained if is_restrained[order] else part.free).solve(w, pushed)
                motions.append(alone)
                # Deflections of all directions; the columns are complex, and not conjugated.
                seen_by = mix[:, reach.seen].T @ (basis.T @ alone)
                # Forces of order p act on this one by D_{m-p}; its motion deflects connectors of order p' by D_{p'-m}.
                seen = sought[reach.deflected]
                compliance[np.ix_(sought[reach.acted], seen)] += (seen_by[:, :rank] @ mix[:, reach.acting]).T
                if order in loads:
                    deflections.append((seen, seen_by[:, rank:]))
            if order in asked:
                moved[order] = motions
        return _Balance(at, stands, unknowns, sought, reaches, compliance, deflections, moved)

    def _solved(self, balance: _Balance, deflections: ComplexArray) -> ComplexArray:
        """Solve the deflections with the connectors sought by those without, both by unknown, (u, i)."""
        between = balance.compliance.copy()
        for order, own in balance.unknowns.items():
            between[own] = self._law(balance, order).T @ between[own]
        between[np.diag_indices(len(between))] += 1.0
        if balance.stands:
            # What is constant in time leaves the train's own turning open.
            return np.asarray(np.linalg.lstsq(between.T, deflections, rcond=_STANDSTILL)[0])
        return np.asarray(np.linalg.solve(between.T, deflections))

    def force_along(self, number: int, force: complex) -> dict[Order, ComplexArray]:
        """Split a harmonic force along the line of action of a contact into loads by order, (n,) each."""
        tooth = self.system.contacts[number]
        parts = self.directions_by_order(tooth.direction[:, None], tooth.turning)
        return {order: np.asarray(force * direction[:, 0]) for order, direction in parts.items()}

    def at_order(self, loads: Mapping[Order, ComplexArray], order: Order) -> dict[Order, ComplexArray]:
        """Shift the loads by order of a force to those of one at ω + m·f, m an order; those that are followed."""
        shifted = {plus(order, step): load for step, load in loads.items()}
        return {place: load for place, load in shifted.items() if place in self._places}

    def deflection(
        self,
        motion: Mapping[Order, ComplexArray],
        directions: FloatArray,
        turning: Sequence[TurningPart],
        order: Order | None = None,
    ) -> ComplexArray:
        """Deflection Σ_l D_lᵀ q_{m-l} of a connector at an order m, by default that of the excitation.

        Parameters
        ----------
        motion : mapping of order to ndarray of complex, shape (..., n)
            Coordinates at all orders.
        directions : ndarray, shape (n, d)
            Directions D(0).
        turning : sequence of TurningPart
            Their parts that turn.
        order : order, optional

        Returns
        -------
        ndarray of complex, shape (..., d)
        """
        at = self.still if order is None else order
        parts = self.directions_by_order(directions, turning)
        found = np.zeros((*motion[self.still].shape[:-1], directions.shape[1]), dtype=np.complex128)
        for gap, direction in parts.items():
            if (source := _minus(at, gap)) in motion:
                found += motion[source] @ direction
        return found

    def order_of(self, shift: float) -> Order | None:
        """Order m of a shift m·f of frequency [rad/s]; None where no order that is followed has it."""
        scale = max(self.rates, default=1.0)
        near = [order for order in self.orders if abs(self.shift(order) - shift) <= _SAME_SHIFT * scale]
        return min(near, key=lambda order: sum(map(abs, order)), default=None)

    @cached_property
    def _law_matrices(self) -> tuple[FloatArray, FloatArray]:
        """Stiffness and damping of the connectors sought, (d, d) both."""
        stiffness, damping = np.zeros((self._width, self._width)), np.zeros((self._width, self._width))
        begin = 0
        for one in self._connectors:
            own = slice(begin, begin + len(one.stiffness))
            stiffness[own, own], damping[own, own] = one.stiffness, one.damping
            begin = own.stop
        return stiffness, damping

    def _law(self, balance: _Balance, order: Order) -> ComplexArray:
        """Law k + i ω_m c of the connectors sought at an order."""
        last = _last(balance.unknowns[order], self._width)
        stiffness, damping = (matrix[last, last] for matrix in self._law_matrices)
        return np.asarray(stiffness + 1j * balance.frequencies[order] * damping, dtype=np.complex128)

    def _error(self, errors: Mapping[int, complex]) -> ComplexArray:
        """Errors of contacts over all directions that are sought, the last of which are those of contacts, (d,)."""
        found = np.zeros(self._width, dtype=np.complex128)
        first = self._width - len(self.system.contacts)
        for number, error in errors.items():
            found[first + number] = error
        return found


def _last(unknowns: slice, width: int) -> slice:
    """Last of all directions, as many as there are unknowns: those without the directions of free motions."""
    return slice(width - (unknowns.stop - unknowns.start), width)


def _minus(first: Order, second: Order) -> Order:
    return tuple(a - b for a, b in zip(first, second, strict=True))


def plus(first: Order, second: Order) -> Order:
    """Sum of two orders."""
    return tuple(a + b for a, b in zip(first, second, strict=True))
