"""Search for the operating point: coordinates, stiffness, loads and connectors of the static machine, solved.

The model of :mod:`gearwhine.coupling.statics.operating_point` in coordinates: six at each node of a shaft, the
housing's modes, and two of each pedestal. Connectors are bearings, gear pairs and pedestals
(:mod:`gearwhine.coupling.statics.static_model`).
"""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from scipy import linalg

from gearwhine.coupling.description.parts import TorqueSupport
from gearwhine.coupling.errors import CouplingError, EquilibriumNotFoundError
from gearwhine.coupling.machine.components import HousingComponent, seat_in_section
from gearwhine.coupling.machine.gear_bodies import GearBody
from gearwhine.coupling.machine.loads import ShaftForce, Torque
from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.coupling.machine.pins import MountedPin, rigid_motion
from gearwhine.coupling.statics.connector_equilibrium import ConnectedStructure
from gearwhine.coupling.statics.operating_point import (
    CAUSES,
    BearingLoad,
    OperatingPoint,
    PairLoad,
    ShaftDeflection,
    StaticTangent,
    SupportLoad,
)
from gearwhine.coupling.statics.static_model import (
    ConnectorLaw,
    FaceContactLaw,
    LinearLaw,
    RollingElementLaw,
    StaticBearing,
    StaticPair,
    StaticShaftPart,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.own_copies import unchecked
from gearwhine.rotors.rolling_bearings import RollingState
from gearwhine.rotors.rolling_bearings.equilibrium import state_of_elements

RESIDUAL_BOUND = 1e-9
"""Largest force out of balance, relative to the largest load, beyond the rounding of elastic forces."""

_ROUNDINGS = 8.0  # rounding of an elastic force, in units of rounding of its terms
_LARGEST_ROUNDING = 1e-6  # part of the largest load out of balance that may be rounding
_HOUSING_MOTION = "the motion of the housing as a whole"
_FREE_MOTION_STIFFNESS = 1e-10  # part of the largest stiffness of a rigid motion below which nothing holds it
_CARRIED = 1e-7  # part of the loads' work in a free motion that is rounding
_IDLE_PAIR_FORCE = 1e-3  # part of the largest mesh force, under which the face of an idle pair is looked at


def solve_operating_point(
    shafts: Sequence[StaticShaftPart],
    bearings: Sequence[StaticBearing],
    pairs: Sequence[StaticPair],
    housing: HousingComponent | None,
    torques: Sequence[Torque],
    gravity: Sequence[float] | None = None,
    forces: Sequence[ShaftForce] = (),
    rims: Sequence[GearBody] = (),
    torque_supports: Sequence[TorqueSupport] = (),
) -> OperatingPoint:
    """Find the static equilibrium of a machine.

    Parameters
    ----------
    shafts, bearings, pairs
        The static model; :meth:`gearwhine.coupling.Machine.operating_point` makes it.
    housing : HousingComponent or None
        Housing with its residual modes.
    torques : sequence of Torque
        Constant ones.
    gravity : sequence of float, optional
        Acceleration of free fall along x, y, z [m/s²].
    forces : sequence of ShaftForce
        Constant ones.
    rims : sequence of GearBody
        Gears that several pairs share: their rims move on their hubs. Of one pair alone that is in the contact. And
        bodies with modes out of the plane.
    torque_supports : sequence of TorqueSupport
        Springs that hold shafts from rotation.

    Raises
    ------
    CouplingError
        Where a load drives a motion that nothing holds, such as a shaft without axial location.
    EquilibriumNotFoundError
        Where no equilibrium is found, or the forces do not balance to `RESIDUAL_BOUND`.
    """
    model = _StaticModel(shafts, bearings, pairs, housing, torques, gravity, forces, rims, torque_supports)
    return model.solve()


class _StaticModel:
    """Coordinates, stiffness, loads and connectors of the static machine.

    Attributes
    ----------
    first : dict of str to int
        First coordinate of each shaft: six of each of its nodes, along and about x, y, z.
    housing_first, pedestal_first : int, dict of str to int
        First coordinate of the housing's modes, and of each pedestal's motion along x and y.
    rims : dict of str to ndarray, shape (6, n)
        Motion of each rim on its hub along and about x, y, z by all coordinates, by gear; they are the last ones.
    rims_first : int
        First coordinate of the rims.
    plates : list of (str, PlateMode, slice)
        Modes of gear bodies out of the plane: gear, mode, and coordinates.
    size : int
        Number n of coordinates.
    stiffness, load : ndarray, shape (n, n) and (n,)
        Stiffness and load without the connectors.
    laws : list of ConnectorLaw
        Laws of bearings, gear pairs, pedestals and torque supports, in this order.
    directions : list of ndarray, shape (n, d)
        Deflections of each connector by the coordinates.
    twists : list of ndarray, shape (n, d)
        The part of each gear pair's directions that is rotation of its shafts.
    nominal : ndarray
        Nominal stiffness of all connectors, which starts the search.
    parts : list of slice
        Deflections of each connector among those of all.
    """

    def __init__(
        self,
        shafts: Sequence[StaticShaftPart],
        bearings: Sequence[StaticBearing],
        pairs: Sequence[StaticPair],
        housing: HousingComponent | None,
        torques: Sequence[Torque],
        gravity: Sequence[float] | None,
        forces: Sequence[ShaftForce],
        rims: Sequence[GearBody],
        torque_supports: Sequence[TorqueSupport],
    ) -> None:
        self.shafts, self.bearings, self.pairs, self.housing = shafts, bearings, pairs, housing
        self.torque_supports = torque_supports
        self.gravity = None if gravity is None else tuple(gravity)
        self.first: dict[str, int] = {}
        size = 0
        for part in shafts:
            self.first[part.name] = size
            size += 6 * part.shaft.places.size
        self.housing_first = size
        size += 0 if housing is None else housing.size
        pedestals = {
            bearing.mounted.bearing.name: LinearLaw(bearing.mounted.bearing.pedestal.stiffness)
            for bearing in bearings
            if bearing.mounted.bearing.pedestal is not None
        }
        self.pedestal_first = {name: size + 2 * n for n, name in enumerate(pedestals)}
        size += 2 * len(pedestals)
        pins = [(part, part.pin) for part in shafts if part.pin is not None]
        ends = size + np.cumsum([0, *(pin.size for _, pin in pins)])
        self.pins = {
            part.name: slice(*indices) for (part, _), indices in zip(pins, pairwise(ends.tolist()), strict=True)
        }
        size = int(ends[-1])
        springs = [
            (rim.gear, axis, spring.stiffness)
            for rim in rims
            for spring, axes in ((rim.shift, (0, 1)), (rim.twist, (5,)))
            if spring is not None
            for axis in axes
        ]
        plates = [(rim.gear, mode) for rim in rims for mode in rim.plates]
        ends = size + len(springs) + np.cumsum([0, *(mode.size for _, mode in plates)])
        self.plates = [
            (gear, mode, slice(*indices)) for (gear, mode), indices in zip(plates, pairwise(ends.tolist()), strict=True)
        ]
        self.rims_first, self.size = size, int(ends[-1])
        self.stiffness = self._linear_stiffness()
        self.rims = {rim.gear: np.zeros((6, self.size)) for rim in rims}
        for number, (gear, axis, stiffness) in enumerate(springs, size):
            self.stiffness[number, number] = stiffness
            self.rims[gear][axis, number] = 1.0
        for _, mode, indices in self.plates:
            self.stiffness[indices, indices] = mode.frequency**2 * np.eye(mode.size)
        self.load = self._loads(torques, forces)
        self.directions = [
            np.asarray((self._section(mounted.rotor, mounted.bearing.at)[:5] - self.seat_motion(mounted)).T)
            for mounted in (bearing.mounted for bearing in bearings)
        ]
        approaches = [self._pair_directions(pair) for pair in pairs]
        self.directions += [rows for rows, _ in approaches]
        self.directions += [np.eye(self.size)[:, first : first + 2] for first in self.pedestal_first.values()]
        self.directions += [self._torque_direction(support) for support in torque_supports]
        self.directions += [self._pin_directions(part, pin) for part, pin in pins]
        self.twists = [twist for _, twist in approaches]
        self.laws: list[ConnectorLaw] = [bearing.placed_law for bearing in bearings]
        self.laws += [FaceContactLaw(pair.between_rims, pair.clearance) for pair in pairs]
        self.laws += pedestals.values()
        held = [LinearLaw(support.stiffness_matrix) for support in torque_supports]
        held += [LinearLaw(pin.stiffness) for _, pin in pins]
        self.laws += held
        nominal = [bearing.nominal for bearing in bearings]
        nominal += [_uniform_stiffness(pair) for pair in pairs]
        nominal += [law.nominal for law in (*pedestals.values(), *held)]
        self.nominal: FloatArray = linalg.block_diag(*nominal)
        self.all_directions = np.concatenate(self.directions, axis=1)
        ends = np.cumsum([rows.shape[1] for rows in self.directions])
        self.parts = [slice(end - rows.shape[1], end) for end, rows in zip(ends.tolist(), self.directions, strict=True)]

    def _linear_stiffness(self) -> FloatArray:
        whole = np.zeros((self.size, self.size))
        for part in self.shafts:
            rows = self._indices_of(part.name)
            whole[rows, rows] = part.shaft.stiffness
        if self.housing is not None:
            rows = slice(self.housing_first, self.housing_first + self.housing.size)
            whole[rows, rows] = self.housing.stiffness
        return whole

    def _loads(self, torques: Sequence[Torque], forces: Sequence[ShaftForce]) -> FloatArray:
        load = np.zeros(self.size)
        for force in forces:
            load += force.force @ self._section(force.rotor, force.at)[:3]
        for torque in torques:
            part = self._part(torque.rotor)
            load[self.first[part.name] + 6 * part.shaft.node(torque.at) + 5] += torque.value
        for part in self.shafts:
            if part.acceleration is not None:
                load[self._indices_of(part.name)] += part.shaft.weight(part.acceleration)
        if self.gravity is None:
            return load
        if self.housing is not None:
            if self.housing.participation is None:
                raise CouplingError(f"{self.housing.name}: expected its participation in rigid motions, for its weight")
            rows = slice(self.housing_first, self.housing_first + self.housing.size)
            load[rows] += self.housing.participation[:, :3] @ np.array(self.gravity)
        for one in self.bearings:
            bearing = one.mounted.bearing
            if bearing.pedestal is not None:
                first = self.pedestal_first[bearing.name]
                load[first : first + 2] += bearing.pedestal.mass * np.array(self.gravity[:2])
        return load

    def _part(self, shaft: str) -> StaticShaftPart:
        return next(part for part in self.shafts if part.name == shaft)

    def _indices_of(self, shaft: str) -> slice:
        first = self.first[shaft]
        return slice(first, first + 6 * self._part(shaft).shaft.places.size)

    def _section(self, shaft: str, at: float) -> FloatArray:
        """Motion of a station along and about x, y, z by all coordinates, (6, n)."""
        rows = np.zeros((6, self.size))
        first = self.first[shaft] + 6 * self._part(shaft).shaft.node(at)
        rows[:, first : first + 6] = np.eye(6)
        return rows

    def seat_motion(self, mounted: MountedBearing) -> FloatArray:
        """Motion of a bearing's seat, (5, n): x, y, z and the rotations about x and y."""
        rows = np.zeros((5, self.size))
        part = self._part(mounted.rotor)
        holding = part.carrier or mounted.seat
        if part.pin is not None:
            rows[:, self.pins[part.name]] = part.pin.motions(part.start + mounted.bearing.at)
            return rows
        if holding in self.first:
            return self._seat_in_shaft(holding, part.axis, part.start + mounted.bearing.at)
        if mounted.seat is not None:
            assert self.housing is not None
            z = part.start + mounted.bearing.at
            columns = slice(self.housing_first, self.housing_first + self.housing.size)
            rows[:, columns] = self.housing.seat_motions(mounted.seat, z)
        elif mounted.bearing.pedestal is not None:
            first = self.pedestal_first[mounted.bearing.name]
            rows[0, first] = rows[1, first + 1] = 1.0
        return rows

    def _seat_in_shaft(self, holding: str, axis: tuple[float, float], z: float) -> FloatArray:
        """Motion of a seat in a shaft, (5, n), its axis at (x, y) and its middle at z [m]."""
        around = self._part(holding)
        at = min(max(z - around.start, 0.0), around.shaft.length)
        return seat_in_section(self._section(holding, at), np.subtract(axis, around.axis), z - around.start - at)

    def _pin_directions(self, planet: StaticShaftPart, pin: MountedPin) -> FloatArray:
        """Motions of a pin and of the walls of its carrier by all coordinates, (n, d)."""
        own = np.zeros((pin.size, self.size))
        own[:, self.pins[planet.name]] = np.eye(pin.size)
        walls = [self._seat_in_shaft(planet.carrier or "", planet.axis, wall) for wall in pin.walls]
        return np.asarray(np.vstack([own, *walls]).T)

    def _torque_direction(self, support: TorqueSupport) -> FloatArray:
        """Motions of a shaft against the seat that holds it, (n, d): its rotation, or all six where bolts do."""
        rows = self._section(support.shaft, support.at)
        if support.seat is not None:
            assert self.housing is not None
            z = self._part(support.shaft).start + support.at
            own = slice(self.housing_first, self.housing_first + self.housing.size)
            rows[:, own] -= self.housing.section_motions(support.seat, z)
        return np.asarray(rows[support.held_motions].T)

    def _pair_directions(self, pair: StaticPair) -> tuple[FloatArray, FloatArray]:
        """Approach of the flanks at the stations of the face, and relative tilt, by all coordinates, (n, j + 1).

        The second array, of the same shape, is the part by rotation about z: its slope is the twist over the face.
        """
        stations = pair.contact.stations
        rows, twist = np.zeros((stations.size + 1, self.size)), np.zeros((stations.size + 1, self.size))
        for gear, flank in ((pair.driver, pair.line.driver), (pair.driven, pair.line.driven)):
            middle = self._section(gear.shaft, gear.at)
            axial = flank.axial(middle)
            for number, (carrier, arm) in enumerate(zip(gear.carriers.tolist(), gear.arms.tolist(), strict=True)):
                section = self._section(gear.shaft, carrier)
                turned = flank.turning(section[5])
                rows[number] += flank.across(section) + arm * flank.tilting(section) + turned + axial
                twist[number] += turned
            rows[-1] += flank.tilting(middle)
            seat = self._part(gear.shaft).rim_seat
            if seat is not None and self.housing is not None:
                place = math.atan2(flank.arm[1], flank.arm[0])
                deformed = sum(part for part, _ in self.housing.ring_harmonics(seat, flank.push, place))
                rows[:-1, self.housing_first : self.housing_first + self.housing.size] += flank.side * deformed
            if gear.name in self.rims:
                rim = self.rims[gear.name]
                rows[:-1] += flank.across(rim) + flank.turning(rim[5])
            for name, mode, own in self.plates:
                if name == gear.name:
                    body = mode.rows(flank.arm)
                    rows[:-1, own] += flank.along(body[0]) + np.outer(gear.arms, flank.across(body[1:3]))
                    rows[-1, own] += flank.across(body[3:])
        return np.asarray(rows.T), np.asarray(twist.T)

    def _hold_free_motions(self) -> tuple[FloatArray, tuple[str, ...]]:
        """Stiffness that fixes the motions which no connector holds, (n, n), and these motions in words.

        Every motion without elastic energy is a rigid one of the shafts, or one of the housing's modes at rest.
        """
        motions, words = self._rigid_motions()
        connected = motions.T @ self.all_directions
        whole = connected @ self.nominal @ connected.T
        whole = 0.5 * (whole + whole.T)
        values, vectors = np.linalg.eigh(whole)
        # Without any connector, every rigid motion is free.
        stiff = float(values[-1]) if values.size and values[-1] > 0.0 else 1.0
        # A spring as soft as the softest connector leaves the least rounding in the balance of forces.
        spring = float(min(values[values > _FREE_MOTION_STIFFNESS * stiff], default=stiff))
        # One row for each free motion; where several are free, rows are any mixture of them.
        free = vectors.T[values <= _FREE_MOTION_STIFFNESS * stiff]
        works = free @ motions.T @ self.load
        # Rounding leaves parts of other motions in a free one, which the loads drive as well.
        scale = float(np.abs(motions).max(axis=1) @ np.abs(self.load))
        if np.linalg.norm(works) > _CARRIED * scale:
            driven = words[int(np.argmax(np.abs(works @ free)))]
            if driven == _HOUSING_MOTION:
                expected = "supports that hold it, [[housing.support]] of a case"
            else:
                expected = (
                    "a bearing that holds it, such as one with axial stiffness on every shaft that helical gears or "
                    "its weight push along its axis, and torques that balance"
                )
            raise CouplingError(f"nothing holds {driven}, and the loads drive it; expected {expected}")
        extra = np.zeros((self.size, self.size))
        for motion in free @ motions.T:
            extra += spring * np.outer(motion, motion) / float(motion @ motion) ** 2
        *_, named = linalg.qr(free, mode="economic", pivoting=True)
        return extra, tuple(words[number] for number in sorted(named[: len(free)]))

    def _rigid_motions(self) -> tuple[FloatArray, list[str]]:
        """Motions without elastic energy by all coordinates, (n, r), of about a metre at most, and their names."""
        columns, words = [], []
        names = ("motion along x", "motion along y", "axial motion", "tilt about x", "tilt about y", "rotation")
        for part in self.shafts:
            places = part.shaft.places - part.shaft.places.mean()
            length = max(float(np.ptp(part.shaft.places)), 1e-3)
            rigid = np.zeros((places.size, 6, 6))
            rigid[:, np.arange(6), np.arange(6)] = np.array([1.0, 1.0, 1.0, 1 / length, 1 / length, 1 / length])
            # A rotation about x moves what lies at larger z along -y, one about y along +x.
            rigid[:, 1, 3] = -places / length
            rigid[:, 0, 4] = places / length
            for number, name in enumerate(names):
                column = np.zeros(self.size)
                column[self._indices_of(part.name)] = rigid[:, :, number].ravel()
                columns.append(column)
                words.append(f"the {name} of shaft {part.name!r}")
        for planet, rows in self.pins.items():
            pin = self._part(planet).pin
            assert pin is not None
            for number, motion in enumerate(pin.rigid_motions.T):
                column = np.zeros(self.size)
                column[rows] = motion
                columns.append(column)
                words.append(f"the {names[number]} of the pin of {planet!r}")
        if self.housing is not None:
            diagonal = np.diag(self.housing.stiffness)
            for mode in np.flatnonzero(diagonal <= 1e-12 * diagonal.max(initial=0.0)).tolist():
                column = np.zeros(self.size)
                column[self.housing_first + mode] = 1.0
                columns.append(column)
                words.append(_HOUSING_MOTION)
        return np.array(columns).T, words

    def solve(self) -> OperatingPoint:
        """Find the equilibrium and prove the balance of forces."""
        extra, free = self._hold_free_motions()
        # The nominal laws start the search near closed flanks.
        offset = np.concatenate([self._offset(n) for n in range(len(self.laws))])
        structure = ConnectedStructure(
            self.stiffness + extra, self.load, self.all_directions, self.laws, self.parts, self.nominal, offset
        )
        x, iterations = structure.equilibrium()
        return self._result(x, extra, free, iterations)

    def _offset(self, number: int) -> FloatArray:
        """Deflection z0 at which the nominal law of a connector has no force: flanks just touch at their clearance."""
        first = len(self.bearings)
        if not first <= number < first + len(self.pairs):
            return np.zeros(self.directions[number].shape[1])
        pair = self.pairs[number - first]
        return (pair.clearance + pair.contact.touch) * pair.contact.uniform

    def _result(self, x: FloatArray, extra: FloatArray, free: tuple[str, ...], iterations: int) -> OperatingPoint:
        deflections = [rows.T @ x for rows in self.directions]
        states = [law.at(z) for law, z in zip(self.laws, deflections, strict=True)]
        residual = self._require_balance(x, extra, deflections, [force for _, force, _ in states], iterations)
        in_seats = [z - one.displacement for one, z in zip(self.bearings, deflections, strict=False)]
        bearings = tuple(
            BearingLoad(
                bearing.mounted,
                force,
                deflection,
                self.seat_motion(bearing.mounted) @ x + bearing.displacement,
                tangent,
                _rolling_state(bearing, deflection),
            )
            for bearing, deflection, (_, force, tangent) in zip(self.bearings, in_seats, states, strict=False)
        )
        housing_rows = slice(
            self.housing_first, self.housing_first + (0 if self.housing is None else self.housing.size)
        )
        of_pairs = slice(len(self.bearings), len(self.bearings) + len(self.pairs))
        tangent = StaticTangent(
            self.stiffness
            + extra
            + sum(rows @ slope @ rows.T for rows, (_, _, slope) in zip(self.directions, states, strict=True)),
            {part.name: self._indices_of(part.name) for part in self.shafts},
            housing_rows,
            {bearing.mounted.bearing.name: rows for bearing, rows in zip(self.bearings, self.directions, strict=False)},
            tuple(self.directions[of_pairs]),
        )
        return OperatingPoint(
            tuple(ShaftDeflection(part, x[self._indices_of(part.name)]) for part in self.shafts),
            bearings,
            self._pair_loads(x, deflections[of_pairs], [loads for _, loads, _ in states[of_pairs]], bearings),
            None if self.housing is None else x[housing_rows],
            residual,
            iterations,
            free,
            tangent,
            self.gravity,
            self._support_loads(states, deflections),
        )

    def _support_loads(
        self, states: Sequence[tuple[float, FloatArray, FloatArray]], deflections: Sequence[FloatArray]
    ) -> tuple[SupportLoad, ...]:
        """Return the loads of the torque supports, whose laws stand after those of bearings, pairs and pedestals."""
        first = len(self.bearings) + len(self.pairs) + len(self.pedestal_first)
        return tuple(
            SupportLoad(support, force, deflection)
            for support, (_, force, _), deflection in zip(
                self.torque_supports, states[first:], deflections[first:], strict=False
            )
        )

    def _require_balance(
        self,
        x: FloatArray,
        extra: FloatArray,
        deflections: Sequence[FloatArray],
        forces: Sequence[FloatArray],
        iterations: int,
    ) -> float:
        """Return the largest force out of balance over the largest load; refuse more than `RESIDUAL_BOUND`."""
        residual = self.load - (self.stiffness + extra) @ x
        for rows, force in zip(self.directions, forces, strict=True):
            residual = residual - rows @ force
        # Where a part is short and stiff, elastic forces are differences of large ones: their rounding, on whatever
        # node, is no imbalance.
        terms = np.abs(self.stiffness + extra) @ np.abs(x)
        # Without loads the preloads are the scale, also of rows that press each other within a bearing.
        laws = [] if np.any(self.load) else zip((one.law for one in self.bearings), deflections, strict=False)
        pressing = max(
            (float(law.elements.at(z).force) for law, z in laws if isinstance(law, RollingElementLaw)), default=0.0
        )
        rounding = _ROUNDINGS * np.finfo(np.float64).eps * float(terms[: self.housing_first].max())
        beyond, _ = self._relative(np.maximum(np.abs(residual) - rounding, 0.0), forces, pressing)
        relative, where = self._relative(residual, forces, pressing)
        if not (beyond <= RESIDUAL_BOUND and relative <= _LARGEST_ROUNDING):
            raise EquilibriumNotFoundError(
                f"no static equilibrium of the machine: {relative:.3g} of the largest load is out of balance on "
                f"{where} after {iterations} steps; expected at most {RESIDUAL_BOUND:g}. The load may be more than "
                "bearings or teeth can carry, a bearing may be missing, or play may leave a shaft loose"
            )
        return relative

    def _pair_loads(
        self,
        x: FloatArray,
        approaches: Sequence[FloatArray],
        loads: Sequence[FloatArray],
        bearings: Sequence[BearingLoad],
    ) -> tuple[PairLoad, ...]:
        """Return the loads of all gear pairs by approach and loads at the stations of their faces."""
        causes = self._causes(x, bearings)
        largest = max((float(load[:-1].sum()) for load in loads), default=0.0)
        if self.pairs and largest <= RESIDUAL_BOUND * float(np.abs(self.load).max(initial=0.0)):
            names = ", ".join(pair.label for pair in self.pairs)
            turned = float(np.abs(self.load[5 : self.housing_first : 6]).max())
            raise CouplingError(f"{names}: no flanks carry a load under a torque of {turned:g} N·m; expected a torque")
        directions = self.directions[len(self.bearings) : len(self.bearings) + len(self.pairs)]
        return tuple(
            self._pair(
                pair, approach, load, {cause: rows.T @ part for cause, part in causes.items()}, twist.T @ x, largest
            )
            for pair, approach, load, rows, twist in zip(
                self.pairs, approaches, loads, directions, self.twists, strict=True
            )
        )

    def _relative(self, residual: FloatArray, forces: Sequence[FloatArray], least: float) -> tuple[float, str]:
        """Largest force out of balance over the largest load, moments over that load times the longest shaft; where.

        The largest load is at least ``least`` [N].
        """
        longest = max(float(np.ptp(part.shaft.places)) for part in self.shafts) or 1.0
        largest = max(least, 1e-300)
        for part in self.shafts:
            load = self.load[self._indices_of(part.name)].reshape(-1, 6)
            largest = max(largest, float(np.abs(load[:, :3]).max()), float(np.abs(load[:, 3:]).max()) / longest)
        for rows, force in zip(self.directions, forces, strict=True):
            for part in self.shafts:
                on_shaft = (rows @ force)[self._indices_of(part.name)].reshape(-1, 6)
                largest = max(largest, float(np.abs(on_shaft[:, :3]).max()))
        imbalances = []
        for part in self.shafts:
            left = residual[self._indices_of(part.name)].reshape(-1, 6)
            moment = float(np.abs(left[:, 3:]).max()) / longest
            imbalances.append((max(float(np.abs(left[:, :3]).max()), moment), f"shaft {part.name!r}"))
        if self.housing is not None:
            housing_rows = slice(self.housing_first, self.housing_first + self.housing.size)
            # A modal force is scaled by the largest seat motion of its shape.
            size = max(float(np.abs(rows[housing_rows]).max()) for rows in self.directions) or 1.0
            imbalances.append((float(np.abs(residual[housing_rows]).max(initial=0.0)) / size, "the housing"))
        for name, first in self.pedestal_first.items():
            imbalances.append((float(np.abs(residual[first : first + 2]).max()), f"the pedestal of bearing {name!r}"))
        for planet, among in self.pins.items():
            left = residual[among].reshape(-1, 5)
            moment = float(np.abs(left[:, 3:]).max()) / longest
            imbalances.append((max(float(np.abs(left[:, :3]).max()), moment), f"the pin of {planet!r}"))
        worst, where = max(imbalances)
        return worst / largest, where

    def _causes(self, x: FloatArray, bearings: Sequence[BearingLoad]) -> dict[str, FloatArray]:
        """Parts of the shafts' motion by `CAUSES`, (n,) each; their sum is that of all stations.

        The rigid motion of a shaft is the one that fits the motion at its bearings, with their tangent stiffness as
        weights; it is linear in the motions of the seats and the deflections of the bearings. The rest is elastic.
        `_pair` separates the twist.
        """
        parts = {cause: np.zeros(self.size) for cause in CAUSES}
        parts["bodies"][self.rims_first :] = x[self.rims_first :]
        for part in self.shafts:
            columns = self._indices_of(part.name)
            places = part.shaft.places
            bearings_of_shaft = [bearing for bearing in bearings if bearing.mounted.rotor == part.name]
            of_seats = "housing" if part.carrier is None else "carrier"
            rigid_by = {"bearings": np.zeros(5), of_seats: np.zeros(5), "seats": np.zeros(5)}
            matrix = np.zeros((5, 5))
            for bearing in bearings_of_shaft:
                moved = rigid_motion(bearing.mounted.bearing.at)
                metric = 0.5 * (bearing.stiffness + bearing.stiffness.T)
                matrix += moved.T @ metric @ moved
                rigid_by["bearings"] += moved.T @ metric @ bearing.deflection
                of_error = bearing.mounted.seat_displacement
                rigid_by[of_seats] += moved.T @ metric @ (bearing.seat_motion - of_error)
                rigid_by["seats"] += moved.T @ metric @ of_error
            rigid = np.linalg.lstsq(matrix, np.column_stack([*rigid_by.values()]), rcond=1e-12)[0]
            whole = np.zeros((places.size, 6, len(rigid_by)))
            whole[:, :5] = np.array([rigid_motion(at) for at in places.tolist()]) @ rigid
            for number, cause in enumerate(rigid_by):
                parts[cause][columns] = whole[:, :, number].ravel()
            parts["shafts"][columns] = x[columns] - whole.sum(axis=2).ravel()
        return parts

    def _pair(
        self,
        pair: StaticPair,
        approach: FloatArray,
        load: FloatArray,
        causes: Mapping[str, FloatArray],
        twisted: FloatArray,
        pressed: float,
    ) -> PairLoad:
        contact = pair.contact
        slope = -contact.face_slope
        by_cause = {cause: float(slope @ part) for cause, part in causes.items()}
        twist = float(slope @ twisted)
        by_cause["shafts"] -= twist
        by_cause["bodies"] += twist
        touched = approach - pair.clearance * contact.uniform
        force = float(load @ contact.uniform)
        # The rims on their hubs are a part of the approach by the complete contact.
        behind = pair.behind_rims * force * contact.uniform
        approach, touched = approach + behind, touched + behind
        # The force of an idle pair is rounding below the residual of the balance.
        force = force if force > RESIDUAL_BOUND * pressed else 0.0
        shape = touched - contact.uniform * float(contact.face_mean @ touched)
        # An idle pair is solved under a small force, which moves nothing else.
        loading = force if force > 0.0 else _IDLE_PAIR_FORCE * pressed
        return PairLoad(pair, force, approach, float(slope @ approach), by_cause, loading, shape)


def _rolling_state(bearing: StaticBearing, deflection: FloatArray) -> RollingState | None:
    if not isinstance(bearing.law, RollingElementLaw):
        return None
    elements = bearing.law.elements
    # Messages name the bearing by its place in the machine.
    named = unchecked(elements.bearing, name=f"bearing {bearing.mounted.bearing.name!r}")
    return state_of_elements(unchecked(elements, {"contacts"}, bearing=named), deflection)


def _uniform_stiffness(pair: StaticPair) -> FloatArray:
    """Nominal stiffness over the components of the approach: spread evenly over the face, (m, m)."""
    over = pair.contact.over_face
    whole = np.zeros((pair.contact.size, pair.contact.size))
    whole[:-1, :-1] = pair.nominal * over.T @ over / over.shape[0]
    return whole
