"""Rotor: round shaft segments end to end with rigid discs on them, its inertias and its stiffness along the axis.

Stiffness and inertia along the shaft enter the transfer matrices as piecewise polynomials. A cylinder or a coupling has
constants. Along a cone 1/EI, 1/κGA and their like are rational functions; each is interpolated at Chebyshev points, and
the cone halved until the last coefficients of every interpolant are rounding. The interpolants converge geometrically,
at a rate set by how far beyond its interval the nearest pole lies (the apex of a cone, or the place where a bore would
meet the surface), so this takes an interval for every change of a diameter by about a third.
"""

import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from rotors.errors import RotorError, require, require_finite
from rotors.model.material import ShaftMaterial
from rotors.model.segment import Coupling, Segment

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

DEGREE = 16
TAIL = 2e-15
ROUNDING = 2e-15
MOST_HALVINGS = 40

_ANGLES = np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1)
_FRACTIONS = 0.5 * (1.0 + np.cos(_ANGLES))
# Values at the Chebyshev points to coefficients of T_0, T_1, ...; and from these to those of 1, s, s², ...
_TO_CHEBYSHEV = 2.0 / (DEGREE + 1) * np.cos(np.outer(np.arange(DEGREE + 1), _ANGLES))
_TO_CHEBYSHEV[0] *= 0.5
_TO_POWERS = np.zeros((DEGREE + 1, DEGREE + 1))
for _row in range(DEGREE + 1):
    _TO_POWERS[_row, : _row + 1] = np.polynomial.chebyshev.cheb2poly(np.eye(DEGREE + 1)[_row, : _row + 1])

# Rows of a table of coefficients: six of bending, two of torsion, two of the axial rod.
BENDING, TORSION, AXIAL = slice(0, 6), slice(6, 8), slice(8, 10)


@dataclass(frozen=True)
class Profile:
    """A shaft as spans of uniform or mildly tapering section; equal spans share one kind.

    Attributes
    ----------
    edges
        (s + 1,): ends of the spans, m from the left end; all joints are among them.
    lengths
        (s,): m, of whole segments exactly as given, so that equal segments are equal here.
    kind
        (s,): index of each span's kind.
    coefficients
        (k, 10, j): of every kind, SI, the coefficients of 1, s, s², ... with s from −1 to 1 along the span: in
        bending 1/(κGA + P), 1/EI, ρA, ρI, g, g P (`rotors.transfer_matrix.timoshenko`); 1/GJ, ρJ; 1/EA, ρA.
    extremes
        (k, 5): least κGA and EI, largest ρA and ρI, axial force P.
    uniform
        (k,).
    """

    edges: FloatArray
    lengths: FloatArray
    kind: IntArray
    coefficients: FloatArray
    extremes: FloatArray
    uniform: npt.NDArray[np.bool_]

    @cached_property
    def mean_bending_stiffness(self) -> float:
        """Geometric mean of the spans' least EI, N·m²."""
        return float(np.exp(np.log(self.extremes[self.kind, 1]).mean()))


def stiffness_profile(parts: Sequence[Segment | Coupling], joints: FloatArray) -> Profile:
    """Profile of segments and couplings between the given joints (parts + 1,), m."""
    kinds: dict[tuple[object, ...], int] = {}
    tables: list[tuple[FloatArray, FloatArray]] = []
    edges, lengths, kind = [float(joints[0])], [], []
    for part, left, right in zip(parts, joints[:-1].tolist(), joints[1:].tolist(), strict=True):
        if isinstance(part, Segment) and part.is_conical:
            pieces = _taper(part, 0.0, 1.0, 0)
        else:
            key = _identity(part)
            if key not in kinds:
                kinds[key] = len(tables)
                values = _coupling_values(part) if isinstance(part, Coupling) else _segment_values(part, 0.5)
                tables.append((values[0][:, None], values[1]))
            edges.append(right)
            lengths.append(part.length)
            kind.append(kinds[key])
            continue
        for start, end, powers, extremes in pieces:
            kind.append(len(tables))
            tables.append((powers, extremes))
            edges.append(left + end * (right - left) if end < 1.0 else right)
            lengths.append((end - start) * part.length)
    order = max(powers.shape[1] for powers, _ in tables)
    coefficients = np.zeros((len(tables), 10, order))
    for row, (powers, _) in enumerate(tables):
        coefficients[row, :, : powers.shape[1]] = powers
    return Profile(
        edges=np.array(edges),
        lengths=np.array(lengths),
        kind=np.array(kind, dtype=np.intp),
        coefficients=coefficients,
        extremes=np.array([extremes for _, extremes in tables]),
        uniform=np.array([powers.shape[1] == 1 for powers, _ in tables]),
    )


def restricted(coefficients: FloatArray, centre: FloatArray, half: FloatArray) -> FloatArray:
    """Polynomials over parts of their spans: p(centre + half · s), for (e, f, j) and (e,) each."""
    order = coefficients.shape[2]
    if order == 1:
        return coefficients
    # Horner's rule on polynomials: the result grows by one factor (centre + half s) at a time.
    result = np.zeros_like(coefficients)
    middle, reach = centre[:, None, None], half[:, None, None]
    for k in range(order - 1, -1, -1):
        raised = middle * result
        raised[:, :, 1:] += reach * result[:, :, :-1]
        raised[:, :, 0] += coefficients[:, :, k]
        result = raised
    return result


def _identity(part: Segment | Coupling) -> tuple[object, ...]:
    """Key that two uniform parts of one section share, whatever their lengths."""
    if isinstance(part, Coupling):
        stiffnesses = (part.lateral_stiffness, part.tilt_stiffness, part.torsional_stiffness, part.axial_stiffness)
        return (part.length, *stiffnesses)
    return (part.outer_diameter, part.inner_diameter, part.material, part.shear_coefficient, part.axial_force)


def _segment_values(part: Segment, fraction: float) -> tuple[FloatArray, FloatArray]:
    """Return the ten coefficients of a cross-section, and its κGA, EI, ρA, ρI and axial force."""
    section, force = part.section(fraction), part.axial_force
    shear, bending = section.shear_stiffness, section.bending_stiffness
    mass, polar = section.mass_per_length, section.polar_inertia_per_length
    expected = f"a compression below half of its shear stiffness, {0.5 * shear:g} N"
    require(-2.0 * force < shear, "segment axial_force", force, expected)
    share = shear / (shear + force)
    bent = [1.0 / (shear + force), 1.0 / bending, mass, 0.5 * polar, share, share * force]
    rods = [1.0 / section.torsional_stiffness, polar, 1.0 / section.axial_stiffness, mass]
    return np.array(bent + rods), np.array([shear, bending, mass, 0.5 * polar, force])


def _coupling_values(part: Coupling) -> tuple[FloatArray, FloatArray]:
    """Return the values of `_segment_values` for a coupling: massless, its compliances spread over its length."""
    shear, bending = part.lateral_stiffness * part.length, part.tilt_stiffness * part.length
    twist, stretch = part.torsional_stiffness * part.length, part.axial_stiffness * part.length
    values = [1.0 / shear, 1.0 / bending, 0.0, 0.0, 1.0, 0.0, 1.0 / twist, 0.0, 1.0 / stretch, 0.0]
    return np.array(values), np.array([shear, bending, 0.0, 0.0, 0.0])


def _taper(part: Segment, start: float, end: float, halvings: int) -> list[tuple[float, float, FloatArray, FloatArray]]:
    """Start and end (fractions of the cone), coefficients and extremes of intervals short enough to interpolate."""
    fractions = [start + fraction * (end - start) for fraction in (*_FRACTIONS.tolist(), 0.0, 1.0)]
    samples = [_segment_values(part, fraction) for fraction in fractions]
    values, rows = np.array([value for value, _ in samples[:-2]]), np.array([row for _, row in samples])
    chebyshev = _TO_CHEBYSHEV @ values
    # Towards a tip or a thin wall, the diameters themselves are rounded to a part of the largest.
    walls = [part.section(fraction) for fraction in (start, end)]
    thinnest = min(section.outer_diameter - section.inner_diameter for section in walls)
    largest = max(outer for outer, _ in part.end_diameters)
    tolerance = max(TAIL, ROUNDING * largest / thinnest) * np.abs(chebyshev).max(axis=0)
    if not bool((np.abs(chebyshev[-2:]) <= tolerance).all()):
        if halvings == MOST_HALVINGS:
            raise RotorError(f"segment {part!r} tapers too sharply; expected diameters further from zero")
        middle = 0.5 * (start + end)
        return _taper(part, start, middle, halvings + 1) + _taper(part, middle, end, halvings + 1)
    # Coefficients of the size of rounding are zero.
    chebyshev[np.abs(chebyshev) < 0.1 * tolerance] = 0.0
    extremes = np.array([*rows[:, :2].min(axis=0), *rows[:, 2:4].max(axis=0), part.axial_force])
    return [(start, end, (chebyshev.T @ _TO_POWERS), extremes)]


MassModel = Literal["distributed", "lumped"]

# Two positions closer than this fraction of the rotor's length are one station: sums of printed segment lengths differ
# from printed positions by rounding alone.
STATION_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Disc:
    """A rigid body fixed to the shaft at a point; with zero inertias, a point mass.

    Parameters
    ----------
    at
        Position from the rotor's left end, m.
    mass
        kg.
    polar_inertia, diametral_inertia
        About the axis and about a diameter, kg·m².
    """

    at: float
    mass: float
    polar_inertia: float = 0.0
    diametral_inertia: float = 0.0

    def __post_init__(self) -> None:
        """Check that position, mass and inertias are finite and not negative."""
        require_finite("disc position", self.at, minimum=0.0)
        require_finite("disc mass", self.mass, minimum=0.0)
        require_finite("disc polar_inertia", self.polar_inertia, minimum=0.0)
        require_finite("disc diametral_inertia", self.diametral_inertia, minimum=0.0)

    @classmethod
    def from_dimensions(
        cls, at: float, width: float, outer_diameter: float, inner_diameter: float, density: float
    ) -> "Disc":
        """Disc of a round ring of the given width and diameters (m) and density (kg/m³)."""
        ring = Segment(width, outer_diameter, inner_diameter, ShaftMaterial(1.0, 0.5, density))
        return cls(at, ring.mass, ring.polar_inertia, ring.diametral_inertia)


@dataclass(frozen=True)
class Rotor:
    """A shaft of segments, left to right, carrying discs.

    Parameters
    ----------
    name
        Name in messages.
    segments
        At least one `Segment`, from the left end; a `Coupling` may stand between them.
    discs
        Any number of `Disc`; several may share a place.
    mass_model
        ``"distributed"``: every segment is an exact Timoshenko beam and rod with its own mass.
        ``"lumped"``: every segment is massless and its inertias go to its two ends (`station_inertias`).

    Raises
    ------
    RotorError
        No segments, a disc beyond the shaft, an unknown mass model, or a rotor without mass.
    """

    name: str
    segments: Sequence[Segment | Coupling]
    discs: Sequence[Disc] = ()
    mass_model: MassModel = "distributed"

    def __post_init__(self) -> None:
        """Check for segments, the mass model, discs on the shaft and a positive mass; keep tuples."""
        object.__setattr__(self, "segments", tuple(self.segments))
        object.__setattr__(self, "discs", tuple(self.discs))
        where = f"rotor {self.name!r}"
        if not self.segments:
            raise RotorError(f"{where} has no segments; expected at least one")
        known = self.mass_model in ("distributed", "lumped")
        require(known, f"{where} mass_model", self.mass_model, "'distributed' or 'lumped'")
        for disc in self.discs:
            self.require_on_shaft(f"{where} disc", disc.at)
        require(self.mass > 0.0, f"{where} mass", self.mass, "a positive mass, of segments or of discs")

    def require_on_shaft(self, what: str, at: float) -> None:
        """Raise `RotorError` unless ``at`` (m from the left end) is a finite place on the shaft."""
        slack = STATION_TOLERANCE * self.length
        inside = math.isfinite(at) and -slack <= at <= self.length + slack
        require(inside, f"{what} position", at, f"a place on the shaft, 0 to {self.length:g} m")

    @cached_property
    def joints(self) -> FloatArray:
        """Positions of the segments' ends, (segments + 1,), m."""
        # Extended precision, because 400 rounded additions would move the right end.
        lengths = np.array([0.0, *(segment.length for segment in self.segments)], dtype=np.longdouble)
        return np.cumsum(lengths).astype(np.float64)

    @cached_property
    def profile(self) -> Profile:
        """Stiffness and inertia along the shaft, as its transfer matrices take them."""
        return stiffness_profile(self.segments, self.joints)

    @cached_property
    def spans(self) -> "ShaftSpans":
        """The shaft between the places where its section changes or an inertia sits."""
        return shaft_spans(self)

    @property
    def length(self) -> float:
        """Length of the shaft, m."""
        return float(self.joints[-1])

    @property
    def stations(self) -> FloatArray:
        """Segment ends and disc positions, ascending, each place once, (stations,), m."""
        return merged_positions(self.joints, [disc.at for disc in self.discs])

    @cached_property
    def mass(self) -> float:
        """Total mass, kg."""
        return math.fsum([part.mass for part in self.segments] + [disc.mass for disc in self.discs])

    @cached_property
    def is_compressed(self) -> bool:
        """Whether an axial force compresses some part of the shaft."""
        return any(isinstance(part, Segment) and part.axial_force < 0.0 for part in self.segments)

    @property
    def polar_inertia(self) -> float:
        """Total moment of inertia about the axis, kg·m²."""
        return math.fsum([part.polar_inertia for part in self.segments] + [d.polar_inertia for d in self.discs])

    @property
    def centre_of_mass(self) -> float:
        """Distance of the centre of mass from the left end, m."""
        lefts = self.joints[:-1].tolist()
        moments = [part.mass * (left + part.mass_centre) for part, left in zip(self.segments, lefts, strict=True)]
        return math.fsum([*moments, *(disc.mass * disc.at for disc in self.discs)]) / self.mass


@dataclass(frozen=True)
class ShaftSpans:
    """A rotor's spans between the places where its section changes or an inertia sits.

    Attributes
    ----------
    nodes
        (s + 1,): ends of the spans, m.
    kind, start, end, lengths
        (s,): as in `rotors.transfer_matrix.discretised_shaft.ContinuousShaft`, the kinds those of the rotor's profile.
    inertias
        (s + 1, 3): mass (kg), diametral and polar moment of inertia (kg·m²) at the nodes.
    """

    nodes: FloatArray
    kind: IntArray
    start: FloatArray
    end: FloatArray
    lengths: FloatArray
    inertias: FloatArray


def merged_positions(joints: FloatArray, others: Sequence[float]) -> FloatArray:
    """Joints and other positions, ascending; one that lies on a joint or another position is that one.

    Parameters
    ----------
    joints
        Ascending positions that stay exactly as they are, (n,), m.
    others
        Further positions on the shaft, m.
    """
    known = joints.tolist()
    slack = STATION_TOLERANCE * known[-1]
    kept: list[float] = []
    for place in sorted(float(other) for other in others):
        right = min(max(bisect_left(known, place), 1), len(known) - 1)
        near = min(abs(place - known[right - 1]), abs(place - known[right])) <= slack
        if not near and (not kept or place - kept[-1] > slack):
            kept.append(place)
    return np.sort(np.concatenate([joints, kept])) if kept else joints


def station_index(stations: FloatArray, at: float) -> int:
    """Index of the station at the position ``at`` (m), which must be one of them."""
    return int(np.abs(stations - at).argmin())


def shaft_spans(rotor: Rotor) -> ShaftSpans:
    """Spans of a rotor; neighbours of one uniform kind with nothing between them are one.

    So a plain shaft given in sixty elements costs no more than one given whole. The transfer matrix of a uniform span
    is exact at any length, and the field inside it is exact too.
    """
    profile = rotor.profile
    edges = profile.edges
    nodes = merged_positions(edges, [disc.at for disc in rotor.discs])
    inertias = station_inertias(rotor, nodes)
    span = np.clip(np.searchsorted(edges, 0.5 * (nodes[1:] + nodes[:-1])) - 1, 0, edges.size - 2)
    left, width, kind = edges[span], np.diff(edges)[span], profile.kind[span]
    start, end = (nodes[:-1] - left) / width, (nodes[1:] - left) / width
    lengths = np.where((start == 0.0) & (end == 1.0), profile.lengths[span], np.diff(nodes))
    first = np.ones(kind.size, dtype=np.bool_)
    first[1:] = (kind[1:] != kind[:-1]) | ~profile.uniform[kind[1:]] | inertias[1:-1].any(axis=1)
    if first.all():
        return ShaftSpans(nodes, kind, start, end, lengths, inertias)
    index = np.flatnonzero(first)
    kept = np.append(index, nodes.size - 1)
    tapers = ~profile.uniform[kind[index]]
    return ShaftSpans(
        nodes=nodes[kept],
        kind=kind[index],
        start=np.where(tapers, start[index], 0.0),
        end=np.where(tapers, end[index], 1.0),
        lengths=np.add.reduceat(lengths, index),
        inertias=inertias[kept],
    )


def station_inertias(rotor: Rotor, stations: FloatArray) -> FloatArray:
    """Lumped inertias at the stations (Myklestad–Prohl).

    They are those of the discs, and half of a coupling at each of its ends. In the lumped model each segment also gives
    its own inertia to its two ends: mass in the shares that keep its centre of mass where it is, polar inertia in
    those that keep its centre, and the diametral inertia about its own centre of mass,
    I_p/2 + m l²/12 of a cylinder, as the mass. A cylinder is thus halved; in the seven-station table of the
    RAPPID example this rule gives the printed 0.020568 kg·m² at a plain station and 0.010284 kg·m² at an end.

    Parameters
    ----------
    rotor
        The rotor.
    stations
        Positions that hold at least its segment ends and discs, (s,), m.

    Returns
    -------
    (s, 3)
        Mass (kg), diametral and polar moment of inertia (kg·m²).
    """
    inertias = np.zeros((stations.size, 3))
    for disc in rotor.discs:
        inertias[station_index(stations, disc.at)] += disc.mass, disc.diametral_inertia, disc.polar_inertia
    # Joints are stations to the last digit.
    ends = np.searchsorted(stations, rotor.joints).tolist()
    for part, left, right in zip(rotor.segments, ends[:-1], ends[1:], strict=True):
        if rotor.mass_model == "lumped" or isinstance(part, Coupling):
            own = np.array([part.mass, part.diametral_inertia, part.polar_inertia])
            centres = np.array([part.mass_centre, part.mass_centre, part.polar_centre])
            to_right = own * (centres / part.length)
            inertias[left] += own - to_right
            inertias[right] += to_right
    return inertias
