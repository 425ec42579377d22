"""Reduced housing: matrices of another program on springs at its nodes, with named bearing seats and sensors.

It has no mesh and no shapes: what needs these, such as sound and pictures, is not known of it.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy import linalg

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.certificate import ReducedCertificate, certify, rigid_motions
from gearwhine.housing.reduced.matrices import MASSLESS, ReducedMatrices, StaticStiffness, scaled
from gearwhine.housing.reduced.recovery import RecoveredPoints
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import (
    Finding,
    Instance,
    Number,
    Numbers,
    Rule,
    Text,
    attribute_findings,
    kind_findings,
    refuse,
)
from gearwhine.numerics.own_copies import keep_tuples
from gearwhine.numerics.result_warnings import ResultWarning, warning

Point = tuple[float, float, float]

_TWO_PI = 2.0 * np.pi
_SIX = (0.0,) * 6
_PART = ("reduced housing", "")

LIGHTEST, HEAVIEST = 1e-3, 1e6
"""Masses outside of which the units of a housing's matrices are others than said [kg]."""

STATIC_RATIO = 10.0
"""Frequency of a coordinate without mass, over the highest natural frequency: it responds statically below."""

REACH_OF_HELD_MODES = 1.2
"""Frequency limit over that of the last mode with the nodes held, beyond which modes of the housing may be missing."""

STATIC_DIFFERENCE = 1e-3
"""Difference from a static stiffness of the interface that is warned of: Craig and Bampton keep it exactly."""

_RIGID = 1e-12  # eigenvalue over the largest stiffness in the eigenproblem's own coordinates: a motion that is free


def _check(part: tuple[str, str], owner: object, **rules: Rule) -> None:
    refuse(attribute_findings(part, owner, **rules), HousingError)


@dataclass(frozen=True)
class NodeSeat:
    """A bearing seat at an interface node, whose six motions are those of the seat's centre.

    Attributes
    ----------
    name : str
    node : int
        Number of the node.
    center : tuple of float
        Place of the node, which is the seat's centre [m].
    """

    name: str
    node: int
    center: Point

    def __post_init__(self) -> None:
        """Keep own copies; check name, node and centre."""
        keep_tuples(self, "center")
        _check(("seat", str(self.name)), self, name=Text(), node=Number(at_least=0, whole=True), center=Numbers(3))


@dataclass(frozen=True)
class NodeSensor:
    """An accelerometer at an interface node.

    Attributes
    ----------
    name : str
    node : int
    position : tuple of float
        Place of the node [m].
    direction : tuple of float
        Measured direction, of any length above zero; kept as a unit vector.
    """

    name: str
    node: int
    position: Point
    direction: Point

    def __post_init__(self) -> None:
        """Keep own copies; check name, node, place and direction."""
        keep_tuples(self, "position", "direction")
        rules: dict[str, Rule] = {"name": Text(), "node": Number(at_least=0, whole=True)}
        _check(("sensor", str(self.name)), self, **rules, position=Numbers(3), direction=Numbers(3))
        length = float(np.linalg.norm(self.direction))
        if length == 0.0:
            expected = "a vector that is not zero"
            refuse([Finding(("sensor", self.name), "direction", self.direction, expected)], HousingError)
        object.__setattr__(self, "direction", tuple(one / length for one in self.direction))


@dataclass(frozen=True)
class NodeSpring:
    """A support: springs and dashpots between an interface node and the ground.

    Attributes
    ----------
    name : str
    node : int
    position : tuple of float
        Place of the node [m].
    stiffness : sequence of float
        Along x, y, z [N/m] and about them [N m/rad].
    damping : sequence of float
        Along x, y, z [N s/m] and about them [N m s/rad].
    """

    name: str
    node: int
    position: Point
    stiffness: Sequence[float] = _SIX
    damping: Sequence[float] = _SIX

    def __post_init__(self) -> None:
        """Keep own copies; check name, node, place and amounts."""
        keep_tuples(self, "position", "stiffness", "damping")
        amount = Numbers(6, Number(at_least=0.0))
        rules: dict[str, Rule] = {"name": Text(), "node": Number(at_least=0, whole=True), "position": Numbers(3)}
        _check(("support", str(self.name)), self, **rules, stiffness=amount, damping=amount)


@dataclass(frozen=True)
class ReducedModes:
    """Natural modes of a reduced housing on its supports, and the static response of coordinates without mass.

    Attributes
    ----------
    frequencies : ndarray, shape (m,)
        Natural frequencies, ascending; zero of a free rigid motion [rad/s].
    static_frequency : float
        Frequency given to the k static coordinates, above all others [rad/s].
    vectors : ndarray, shape (n, m + k)
        Motion of the matrices' coordinates by those of the modes, mass-normalised.
    known : int
        Number of modes below the frequency limit.
    """

    frequencies: FloatArray
    static_frequency: float
    vectors: FloatArray
    known: int

    @property
    def frequencies_hz(self) -> FloatArray:
        """Natural frequencies, shape (m,) [Hz]."""
        return self.frequencies / _TWO_PI

    @property
    def discretisation_errors(self) -> None:
        """Not known: the mesh is another program's."""
        return None

    @property
    def all_frequencies(self) -> FloatArray:
        """Frequencies of the modes and of the static coordinates, shape (m + k,) [rad/s]."""
        static = self.vectors.shape[1] - len(self.frequencies)
        return np.concatenate([self.frequencies, np.full(static, self.static_frequency)])


@dataclass(frozen=True)
class ReducedHousing:
    """A housing given by reduced matrices with interface nodes.

    Attributes
    ----------
    matrices : ReducedMatrices
        Mass, stiffness and damping in SI; x, y, z are those of the machine, whose shafts lie along z.
    seats : sequence of NodeSeat
    sensors : sequence of NodeSensor
    supports : sequence of NodeSpring
    damping_ratio : float
        Fraction of critical damping of every elastic mode, in addition to the damping matrix and dashpots.
    limit : float
        Frequency below which the reduction is accurate, as whoever made it knows [rad/s]. Modes above it are kept for
        their static response.
    static : StaticStiffness, optional
        Static stiffness of interface nodes from another computation, which the certificate holds the matrices against.
    recovered : RecoveredPoints, optional
        Points beside the nodes whose motions the coordinates give.

    Raises
    ------
    HousingError
        Where a part is of another kind, a name is given twice, a node is missing or has two places, a seat's node
        lacks a motion, a support acts on a motion that there is not, or the mass is none of a housing.
    """

    matrices: ReducedMatrices
    seats: Sequence[NodeSeat]
    sensors: Sequence[NodeSensor] = ()
    supports: Sequence[NodeSpring] = ()
    damping_ratio: float = 0.01
    limit: float = field(kw_only=True)
    static: StaticStiffness | None = None
    recovered: RecoveredPoints | None = None

    def __post_init__(self) -> None:
        """Keep own copies; check names, nodes, places and the mass."""
        keep_tuples(self, "seats", "sensors", "supports")
        rules: dict[str, Rule] = {
            "matrices": Instance(ReducedMatrices, "reduced matrices"),
            "damping_ratio": Number(at_least=0.0, below=1.0),
            "limit": Number(above=0.0, unit="rad/s"),
        }
        kinds = kind_findings(_PART, self, seats=NodeSeat, sensors=NodeSensor, supports=NodeSpring)
        refuse([*attribute_findings(_PART, self, **rules), *kinds], HousingError)
        refuse(self._node_findings(), HousingError)
        refuse(self._mass_findings(), HousingError)
        if self.recovered is not None and self.recovered.rows.shape[2] != self.matrices.size:
            columns, expected = self.recovered.rows.shape[2], f"rows of {self.matrices.size} columns"
            refuse([Finding(("reduced housing", "recovery"), "", columns, expected)], HousingError)

    def _needed(self) -> dict[tuple[str, str], list[int]]:
        """Components that the node of each seat and sensor must have."""
        needed = {("seat", seat.name): list(range(1, 7)) for seat in self.seats}
        for sensor in self.sensors:
            needed["sensor", sensor.name] = [axis for axis, part in enumerate(sensor.direction, start=1) if part]
        return needed

    def _ports(self) -> Iterator[tuple[str, str, int, Point]]:
        """Yield kind, name, node and place of all that is at a node."""
        for seat in self.seats:
            yield "seat", seat.name, seat.node, seat.center
        for sensor in self.sensors:
            yield "sensor", sensor.name, sensor.node, sensor.position
        for support in self.supports:
            yield "support", support.name, support.node, support.position

    def _node_findings(self) -> Iterator[Finding]:
        """Yield names given twice, nodes that are missing or have two places, and motions that a node lacks."""
        if self.static is not None and not set(self.static.coordinates) <= set(self.matrices.coordinates):
            node, axis = min(set(self.static.coordinates) - set(self.matrices.coordinates))
            expected = f"motions that the reduced matrices have; these lack component {axis} of node {node}"
            yield Finding(("reduced housing", "static"), "", None, expected)
        nodes, places, needed = self.matrices.nodes, self._places, self._needed()
        seen: set[tuple[str, str]] = set()
        for kind, name, node, place in self._ports():
            if (kind, name) in seen:
                yield Finding((kind, name), "name", name, "each name once")
            seen.add((kind, name))
            if node not in nodes:
                listed = ", ".join(map(str, nodes[:20])) + ", …" * (len(nodes) > 20)
                yield Finding((kind, name), "node", node, f"an interface node of the matrices, one of {listed}")
                continue
            if not np.allclose(place, places[node], rtol=0.0, atol=1e-6):
                attribute = "center" if kind == "seat" else "position"
                expected = f"the one place of node {node}, {places[node]} m elsewhere"
                yield Finding((kind, name), attribute, place, expected)
            rows = self.matrices.rows(node)
            if missing := [axis for axis in needed.get((kind, name), ()) if axis not in rows]:
                motions = ", ".join(map(str, missing))
                expected = f"a node with the motions of a {kind}; the matrices have no component {motions} of it"
                yield Finding((kind, name), "node", node, expected)
        for support in self.supports:
            rows = self.matrices.rows(support.node)
            for attribute in ("stiffness", "damping"):
                for axis, amount in enumerate(getattr(support, attribute), start=1):
                    if rows and amount and axis not in rows:
                        expected = f"zero for component {axis}, which node {support.node} does not have"
                        yield Finding(("support", support.name), attribute, amount, expected)

    def _mass_findings(self) -> Iterator[Finding]:
        """Yield a mass that no housing has, as of other units."""
        translations = [row for row, (_, axis) in enumerate(self.matrices.coordinates) if 1 <= axis <= 3]
        shift = np.zeros((self.matrices.size, 3))
        for row in translations:
            shift[row, self.matrices.coordinates[row][1] - 1] = 1.0
        mass = float(np.diag(shift.T @ self.matrices.mass @ shift).mean())
        if not self.matrices.is_static and not LIGHTEST <= mass <= HEAVIEST:
            expected = (
                f"a housing of {LIGHTEST:g} to {HEAVIEST:g} kg in all translations; the files may have other units"
            )
            yield Finding(("reduced housing", "mass"), "total [kg]", mass, expected)

    @cached_property
    def _places(self) -> dict[int, Point]:
        """Place of each node that something is at [m]; the first one given."""
        places: dict[int, Point] = {}
        for _, _, node, place in self._ports():
            places.setdefault(node, place)
        return places

    @cached_property
    def certificate(self) -> ReducedCertificate | None:
        """What is proved of the matrices; None where no node with six motions has a known place."""
        if not any(len(self.matrices.rows(node)) == 6 for node in self._places):
            return None
        return certify(self.matrices, self._places, self.static)

    @property
    def participation_motions(self) -> FloatArray | None:
        """Rigid motions through the origin, shape (n, 6); None where the matrices do not prove them free.

        Base motion and weight act by them.
        """
        if self.certificate is None or not self.certificate.is_free:
            return None
        return rigid_motions(self.matrices, self._places)

    @cached_property
    def supported(self) -> tuple[FloatArray, FloatArray]:
        """Stiffness and damping matrices with those of the supports, shape (n, n)."""
        n = self.matrices.size
        stiffness = self.matrices.stiffness.copy()
        damping = np.zeros((n, n)) if self.matrices.damping is None else self.matrices.damping.copy()
        for support in self.supports:
            for axis, row in self.matrices.rows(support.node).items():
                stiffness[row, row] += support.stiffness[axis - 1]
                damping[row, row] += support.damping[axis - 1]
        return stiffness, damping

    @cached_property
    def modes(self) -> ReducedModes:
        """Natural modes K φ = ω² M φ on the supports, mass-normalised.

        Combinations N of coordinates without mass, M N = 0, follow the others statically. With P beside them,

            q = (P - N (Nᵀ K N)⁻¹ Nᵀ K P) p + N r,

        which leaves p and r uncoupled. The compliance N (Nᵀ K N)⁻¹ Nᵀ of r is kept by coordinates of one high
        frequency.

        Raises
        ------
        HousingError
            Where a combination without mass has no stiffness either, as of a static housing that nothing holds.
        """
        stiffness, _ = self.supported
        mass = self.matrices.mass
        # Rows of unit mass, or of unit stiffness where there is none, so that units do not matter.
        diagonal = np.diag(mass)
        heavy = diagonal > 0.0
        per_row = np.where(heavy, diagonal, np.maximum(np.diag(stiffness), 1e-300)) ** -0.5
        values, basis = np.linalg.eigh(scaled(mass))
        moving, still = per_row[:, None] * basis[:, values >= MASSLESS], per_row[:, None] * basis[:, values < MASSLESS]
        static_values, static_vectors = np.zeros(0), np.zeros((0, 0))
        if still.shape[1]:
            inner = still.T @ stiffness @ still
            static_values, static_vectors = np.linalg.eigh(inner)
            if static_values[0] <= _RIGID * static_values[-1]:
                expected = "stiffness of every motion that has no mass; one has neither"
                refuse([Finding(("reduced housing", "stiffness"), "", None, expected)], HousingError)
            moving = moving - still @ np.linalg.solve(inner, still.T @ stiffness @ moving)
        if not moving.shape[1] and not self.matrices.is_static:
            refuse([Finding(("reduced housing", "mass"), "", None, "mass of one motion at least")], HousingError)
        reduced_stiffness = moving.T @ stiffness @ moving
        squares, vectors = np.zeros(0), np.zeros((0, 0))
        if moving.shape[1]:
            squares, vectors = linalg.eigh(reduced_stiffness, moving.T @ mass @ moving)
        squares = np.where(squares < _RIGID * max(float(squares.max(initial=0.0)), 0.0), 0.0, squares)
        frequencies = np.sqrt(squares)
        highest = STATIC_RATIO * max(float(frequencies.max(initial=0.0)), self.limit)
        static = still @ (static_vectors * (highest / np.sqrt(static_values)))
        return ReducedModes(
            frequencies, highest, np.hstack([moving @ vectors, static]), int((frequencies <= self.limit).sum())
        )

    @property
    def frequencies_hz(self) -> FloatArray:
        """Natural frequencies below the limit [Hz], shape (known,)."""
        return self.modes.frequencies[: self.modes.known] / _TWO_PI

    def seat_motions(self) -> Mapping[str, FloatArray]:
        """Six motions of each seat's centre by the modes, shape (m + k, 6)."""
        return {seat.name: self._node_motions(seat.node) for seat in self.seats}

    def sensor_motions(self) -> Mapping[str, FloatArray]:
        """Motion along each sensor by the modes, shape (m + k,)."""
        return {one.name: self._node_motions(one.node)[:, :3] @ np.array(one.direction) for one in self.sensors}

    def _node_motions(self, node: int) -> FloatArray:
        motions = np.zeros((self.modes.vectors.shape[1], 6))
        for axis, row in self.matrices.rows(node).items():
            motions[:, axis - 1] = self.modes.vectors[row]
        return motions

    @property
    def trusted_limit_hz(self) -> float:
        """Frequency up to which the modes are known [Hz]."""
        return self.limit / _TWO_PI

    @property
    def points(self) -> RecoveredPoints:
        """Nodes of known place that move along x, y and z, and the recovered points."""
        positions, rows = [], []
        for node, place in self._places.items():
            at = self.matrices.rows(node)
            if {1, 2, 3} <= set(at):
                positions.append(place)
                rows.append(np.eye(self.matrices.size)[[at[1], at[2], at[3]]])
        if self.recovered is not None:
            positions += list(self.recovered.positions)
            rows += list(self.recovered.rows)
        n = self.matrices.size
        return RecoveredPoints(np.array(positions).reshape(-1, 3), np.array(rows).reshape(-1, 3, n))

    def node_motions(self) -> FloatArray:
        """Six motions of each interface node by the modes below the limit, shape (known, n_nodes, 6)."""
        motions = np.stack([self._node_motions(node) for node in self.matrices.nodes], axis=1)
        return np.asarray(motions[: self.modes.known])

    @property
    def extent(self) -> float:
        """Largest distance between points of known motion along an axis [m]; 0 of fewer than two."""
        positions = self.points.positions
        return float(np.ptp(positions, axis=0).max()) if len(positions) else 0.0

    def damping_ratios(self) -> FloatArray:
        """Modal damping ratio of each mode below the limit, with damping matrix and dashpots, shape (known,)."""
        known = self.modes.known
        omegas = self.modes.frequencies[:known]
        own = np.diag(self.damping_matrix())[:known]
        return np.asarray(np.divide(own, 2.0 * omegas, out=np.full(known, np.nan), where=omegas > 0.0))

    def damping_matrix(self) -> FloatArray:
        """Damping 2 ζ ω of each mode, and Φᵀ C Φ of the damping matrix and dashpots, shape (m + k, m + k) [1/s]."""
        vectors = self.modes.vectors
        own = vectors.T @ self.supported[1] @ vectors
        return np.asarray(np.diag(2.0 * self.damping_ratio * self.modes.all_frequencies) + 0.5 * (own + own.T))

    @property
    def warnings(self) -> list[str]:
        """Sentences of :attr:`result_warnings`."""
        return [str(entry["message"]) for entry in self.result_warnings]

    @property
    def result_warnings(self) -> list[ResultWarning]:
        """Warnings of rigid motions that nothing holds, and of matrices whose rigid motions are strained in part."""
        warnings = []
        if self.matrices.is_static:
            message = "the reduced housing has a stiffness alone: it follows its loads without resonances of its own"
            warnings.append(warning("reduced-housing", message))
        free = int((self.modes.frequencies == 0.0).sum())
        if free:
            message = f"the reduced housing has {free} motions that nothing holds: it floats freely in them"
            warnings.append(warning("reduced-housing", message, count=free))
        certificate = self.certificate
        if certificate is not None and 0 < certificate.free_motions < 6:
            message = (
                f"the stiffness of the reduced housing resists {6 - certificate.free_motions} of its six rigid motions "
                "and leaves the others free: check the nodes' places, their axes and the units"
            )
            warnings.append(warning("reduced-housing", message, count=certificate.free_motions))
        if certificate is not None and certificate.held_frequency is not None:
            held, limit = certificate.held_frequency / _TWO_PI, self.limit / _TWO_PI
            if limit > REACH_OF_HELD_MODES * held:
                message = (
                    f"the reduced housing keeps modes with its nodes held up to {held:.4g} Hz, fewer than a limit of "
                    f"{limit:.4g} Hz takes: modes of the housing above {held:.4g} Hz may be missing"
                )
                warnings.append(warning("reduced-housing", message, held_hz=held, limit_hz=limit))
        if certificate is not None and (certificate.static_difference or 0.0) > STATIC_DIFFERENCE:
            message = (
                f"the static stiffness of the reduced housing at its interface differs by up to "
                f"{100.0 * (certificate.static_difference or 0.0):.3g} % from the one given beside it"
            )
            warnings.append(warning("reduced-housing", message, difference=certificate.static_difference))
        return warnings
