"""Profile of a shaft: its stiffness and inertia along the axis.

Stiffness and inertia along the shaft enter the transfer matrices as piecewise polynomials. A cylinder or a coupling has
constants. Along a cone 1/EI, 1/κGA and their like are rational functions; each is interpolated at Chebyshev points, and
the cone halved until the last coefficients of every interpolant are rounding. The interpolants converge geometrically,
at a rate set by how far beyond its interval the nearest pole lies (the apex of a cone, or the place where a bore would
meet the surface), so this takes an interval for every change of a diameter by about a third.

Rotor dynamics tells apart the diameter that has the mass of a section and the one that has its stiffness (API 684,
*mass diameter* and *stiffness diameter*): a gear in one piece with its shaft stiffens it, while a disc has its mass.
"""

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray, IndexArray
from gearwhine.rotors.errors import RotorError, require, require_finite
from gearwhine.rotors.model.segment import Coupling, Segment

_DEGREE = 16  # degree of the interpolants along a cone
_TAIL = 2e-15  # last coefficients of an interpolant that is exact, relative to the largest
_WALL_ROUNDING = 2e-15  # the same bound for a wall as thick as the largest diameter; a thinner wall has a larger one
_MOST_HALVINGS = 40  # largest number of halvings of a cone

_ANGLES = np.pi * (np.arange(_DEGREE + 1) + 0.5) / (_DEGREE + 1)
_FRACTIONS = 0.5 * (1.0 + np.cos(_ANGLES))
# Matrices from values at the Chebyshev points to coefficients of T_0, T_1, ..., and from these to those of 1, s, ...
_TO_CHEBYSHEV = 2.0 / (_DEGREE + 1) * np.cos(np.outer(np.arange(_DEGREE + 1), _ANGLES))
_TO_CHEBYSHEV[0] *= 0.5
_TO_POWERS = np.zeros((_DEGREE + 1, _DEGREE + 1))
for _row in range(_DEGREE + 1):
    _TO_POWERS[_row, : _row + 1] = np.polynomial.chebyshev.cheb2poly(np.eye(_DEGREE + 1)[_row, : _row + 1])

# Two positions closer than this fraction of the rotor's length are one station: sums of printed segment lengths differ
# from printed positions by rounding alone.
STATION_TOLERANCE = 1e-9

# Rows of a table of coefficients: six of bending, two of torsion, two of the axial rod.
BENDING, TORSION, AXIAL = slice(0, 6), slice(6, 8), slice(8, 10)
# Rows of the inertias: ρA and ρI of bending, ρJ, ρA of the rod.
INERTIAS = [2, 3, 7, 9]


@dataclass(frozen=True)
class StiffnessDiameter:
    """A length of shaft that is at least this thick against deformation, while its mass is that of its segments.

    It stands for a body in one piece with the shaft whose mass is elsewhere, such as a pinion given as a disc. A body
    of another material is a sleeve around the segments, whose stiffnesses it adds to. Where several overlap, the
    stiffest applies; one thinner than its segment, or over a coupling, has no effect.

    Parameters
    ----------
    left, right : float
        Distances of the ends from the rotor's left end [m].
    bending, torsion : float
        Outer diameter in bending, shear and tension, and in torsion [m]; 0 leaves the shaft as it is.
    youngs_modulus, shear_modulus : float, optional
        Moduli of the body [Pa]; by default those of the segments under it.
    """

    left: float
    right: float
    bending: float
    torsion: float
    youngs_modulus: float | None = None
    shear_modulus: float | None = None

    def __post_init__(self) -> None:
        """Check the order of the ends, the diameters and the moduli."""
        require(self.left < self.right, "stiffness diameter", (self.left, self.right), "its left end before its right")
        require_finite("stiffness diameter in bending", self.bending, minimum=0.0)
        require_finite("stiffness diameter in torsion", self.torsion, minimum=0.0)
        for name in ("youngs_modulus", "shear_modulus"):
            modulus = getattr(self, name)
            if modulus is not None:
                require_finite(f"{name} of a stiffness diameter", modulus)
                require(modulus > 0.0, f"{name} of a stiffness diameter", modulus, "a positive number")


class _Deformation(NamedTuple):
    """How stiffness diameters stiffen a shaft against one deformation.

    Its stiffness is modulus times diameter to the power; ``rows`` of the coefficients and ``bounds`` depend on it.
    """

    diameter: str
    modulus: str
    power: int
    rows: list[int]
    bounds: list[int]


_DEFORMATIONS = (
    _Deformation("bending", "youngs_modulus", 4, [1], [1]),
    _Deformation("bending", "shear_modulus", 2, [0, 4, 5], [0]),
    _Deformation("torsion", "shear_modulus", 4, [6], []),
    _Deformation("bending", "youngs_modulus", 2, [8], []),
)
"""Bending, shear, torsion and tension."""


@dataclass(frozen=True)
class Profile:
    """A shaft as spans of uniform or mildly tapering section; spans of equal section share one.

    Attributes
    ----------
    edges : ndarray, shape (s + 1,)
        Ends of the spans from the left end [m]; all joints are among them.
    lengths : ndarray, shape (s,)
        Lengths [m], of whole segments exactly as given, so that equal segments are equal here.
    section_of_span : ndarray of int, shape (s,)
        Index of each span's section.
    coefficients : ndarray, shape (k, 10, j)
        Coefficients of 1, s, s², ... of every section, SI, with s from −1 to 1 along the span: in bending 1/(κGA +
        P), 1/EI, ρA, ρI, g, g P (`gearwhine.rotors.transfer_matrix.timoshenko`); 1/GJ, ρJ; 1/EA, ρA.
    bounds : ndarray, shape (k, 5)
        Least κGA and EI, largest ρA and ρI, axial force P.
    uniform : ndarray of bool, shape (k,)
        Whether the section does not taper.
    """

    edges: FloatArray
    lengths: FloatArray
    section_of_span: IndexArray
    coefficients: FloatArray
    bounds: FloatArray
    uniform: npt.NDArray[np.bool_]

    @cached_property
    def mean_bending_stiffness(self) -> float:
        """Geometric mean of the spans' least EI, N·m²."""
        return float(np.exp(np.log(self.bounds[self.section_of_span, 1]).mean()))

    def spans(self, nodes: FloatArray) -> IndexArray:
        """Span that holds each interval between nodes (p + 1,), which hold the edges; (p,)."""
        middles = 0.5 * (nodes[1:] + nodes[:-1])
        return np.clip(np.searchsorted(self.edges, middles) - 1, 0, self.section_of_span.size - 1)

    def between(self, nodes: FloatArray) -> FloatArray:
        """Coefficients (p, 10, j) of the intervals between nodes (p + 1,), which hold the edges."""
        span = self.spans(nodes)
        width = np.diff(self.edges)[span]
        start, part = (nodes[:-1] - self.edges[span]) / width, np.diff(nodes) / width
        return restricted(self.coefficients[self.section_of_span[span]], 2.0 * start + part - 1.0, part)


def shaft_profile(
    parts: Sequence[Segment | Coupling], joints: FloatArray, stiff: Sequence[StiffnessDiameter] = ()
) -> Profile:
    """Profile of segments and couplings between joints (parts + 1,), m, with stiffness diameters."""
    unstiffened = _profile_of(parts, joints)
    if not stiff:
        return unstiffened
    profiles = [unstiffened, *(_profile_of(*_thickened(parts, joints, stiff, against)) for against in _DEFORMATIONS)]

    edges = merged_positions(unstiffened.edges, [edge for profile in profiles[1:] for edge in profile.edges.tolist()])
    spans = np.column_stack([profile.spans(edges) for profile in profiles])
    sections = np.column_stack([profile.section_of_span[span] for profile, span in zip(profiles, spans.T, strict=True)])
    uniform = np.all([profile.uniform[section] for profile, section in zip(profiles, sections.T, strict=True)], axis=0)
    # Every tapering interval is a separate section.
    keys = np.column_stack([sections, np.where(uniform, -1, np.arange(uniform.size))])
    _, first, section_of_span = np.unique(keys, axis=0, return_index=True, return_inverse=True)

    coefficients = np.zeros((edges.size - 1, 10, max(profile.coefficients.shape[2] for profile in profiles)))
    bounds = unstiffened.bounds[sections[:, 0]]
    rows_of = [INERTIAS, *(against.rows for against in _DEFORMATIONS)]
    for profile, rows in zip(profiles, rows_of, strict=True):
        restricted_coefficients = profile.between(edges)[:, rows]
        coefficients[:, rows, : restricted_coefficients.shape[2]] = restricted_coefficients
    for profile, section, against in zip(profiles[1:], sections.T[1:], _DEFORMATIONS, strict=True):
        bounds[:, against.bounds] = profile.bounds[section][:, against.bounds]
    whole = (edges[:-1] == unstiffened.edges[spans[:, 0]]) & (edges[1:] == unstiffened.edges[spans[:, 0] + 1])
    return Profile(
        edges=edges,
        lengths=np.where(whole, unstiffened.lengths[spans[:, 0]], np.diff(edges)),
        section_of_span=section_of_span.reshape(-1).astype(np.intp),
        coefficients=coefficients[first],
        bounds=bounds[first],
        uniform=uniform[first],
    )


def _thickened(
    parts: Sequence[Segment | Coupling],
    joints: FloatArray,
    stiff: Sequence[StiffnessDiameter],
    against: _Deformation,
) -> tuple[list[Segment | Coupling], FloatArray]:
    """Parts and joints of a shaft of the segments' materials that is as stiff against one deformation."""
    bodies = [(one.left, one.right, getattr(one, against.diameter), getattr(one, against.modulus)) for one in stiff]
    places = [end for left, right, *_ in bodies for end in (left, right)]
    for part, start in zip(parts, joints[:-1].tolist(), strict=True):
        if isinstance(part, Segment):
            (first, _), (last, _) = part.end_diameters
            crossed = [outer for *_, outer, _ in bodies if min(first, last) < outer < max(first, last)]
            places += [start + part.length * (outer - first) / (last - first) for outer in crossed]
    ends = merged_positions(joints, places)
    pieces: list[Segment | Coupling] = []
    for start, end in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        middle = 0.5 * (start + end)
        index = int(np.searchsorted(joints, middle)) - 1
        part, origin = parts[index], float(joints[index])
        if isinstance(part, Segment):
            sections = [part.section((place - origin) / part.length) for place in (start, end)]
            outers = [section.outer_diameter for section in sections]
            modulus_of_part = getattr(part.material, against.modulus)
            thicker = [
                [
                    _as_stiff(bare, outer, 1.0 if modulus is None else modulus / modulus_of_part, against.power)
                    for bare in outers
                ]
                for left, right, outer, modulus in bodies
                if left < middle < right and outer > 0.5 * sum(outers)
            ]
            outers = max(thicker, key=sum, default=outers)
            part = replace(
                part,
                length=end - start,
                outer_diameter=outers[0],
                right_outer_diameter=outers[1],
                inner_diameter=sections[0].inner_diameter,
                right_inner_diameter=sections[1].inner_diameter,
            )
        pieces.append(part)
    return pieces, ends


def _as_stiff(bare: float, outer: float, ratio: float, power: int) -> float:
    """Diameter of a shaft as stiff as one of a ``bare`` diameter in a sleeve of ``ratio`` times its modulus."""
    if ratio == 1.0:
        return outer
    return float((bare**power + ratio * (outer**power - bare**power)) ** (1.0 / power))


def _profile_of(parts: Sequence[Segment | Coupling], joints: FloatArray) -> Profile:
    """Profile of segments and couplings between joints, m, of which uniform ones of equal section share one."""
    shared: dict[tuple[object, ...], int] = {}
    powers: list[FloatArray] = []
    bounds: list[FloatArray] = []
    edges, lengths, section_of_span = [float(joints[0])], [], []
    for part, left, right in zip(parts, joints[:-1].tolist(), joints[1:].tolist(), strict=True):
        for start, end, own_powers, own_bounds in _spans(part):
            section = len(powers)
            if own_powers.shape[1] == 1:
                section = shared.setdefault(_identity(part), section)
            if section == len(powers):
                powers.append(own_powers)
                bounds.append(own_bounds)
            section_of_span.append(section)
            edges.append(left + end * (right - left) if end < 1.0 else right)
            lengths.append((end - start) * part.length)
    coefficients = np.zeros((len(powers), 10, max(power.shape[1] for power in powers)))
    for row, power in enumerate(powers):
        coefficients[row, :, : power.shape[1]] = power
    return Profile(
        edges=np.array(edges),
        lengths=np.array(lengths),
        section_of_span=np.array(section_of_span, dtype=np.intp),
        coefficients=coefficients,
        bounds=np.array(bounds),
        uniform=np.array([power.shape[1] == 1 for power in powers]),
    )


def _spans(part: Segment | Coupling) -> Iterator[tuple[float, float, FloatArray, FloatArray]]:
    """Start and end (fractions of the part), coefficients and bounds of a part's spans; a cone has one or several."""
    if isinstance(part, Segment) and part.is_conical:
        yield from _taper(part, 0.0, 1.0, 0)
        return
    values, bounds = _coupling_values(part) if isinstance(part, Coupling) else _segment_values(part, 0.5)
    yield 0.0, 1.0, values[:, None], bounds


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
    """Key that two segments of one section share, whatever their lengths; couplings share it at one length alone."""
    if isinstance(part, Coupling):
        stiffnesses = (part.lateral_stiffness, part.tilt_stiffness, part.torsional_stiffness, part.axial_stiffness)
        return (part.length, *stiffnesses, part.axial_force)
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
    force, bearable = part.axial_force, part.clamped_buckling_load
    expected = f"a compression below {bearable:g} N, at which the coupling buckles between clamped shafts"
    require(-force < bearable, "coupling axial_force", force, expected)
    share = shear / (shear + force)
    bent = [1.0 / (shear + force), 1.0 / bending, 0.0, 0.0, share, share * force]
    rods = [1.0 / twist, 0.0, 1.0 / stretch, 0.0]
    return np.array(bent + rods), np.array([shear, bending, 0.0, 0.0, force])


def _taper(part: Segment, start: float, end: float, halvings: int) -> list[tuple[float, float, FloatArray, FloatArray]]:
    """Start and end (fractions of the cone), coefficients and bounds of intervals short enough to interpolate."""
    fractions = [start + fraction * (end - start) for fraction in (*_FRACTIONS.tolist(), 0.0, 1.0)]
    samples = [_segment_values(part, fraction) for fraction in fractions]
    values, rows = np.array([value for value, _ in samples[:-2]]), np.array([row for _, row in samples])
    chebyshev = _TO_CHEBYSHEV @ values
    # Towards a tip or a thin wall, the diameters themselves are rounded to a part of the largest.
    walls = [part.section(fraction) for fraction in (start, end)]
    thinnest = min(section.outer_diameter - section.inner_diameter for section in walls)
    largest = max(outer for outer, _ in part.end_diameters)
    tolerance = max(_TAIL, _WALL_ROUNDING * largest / thinnest) * np.abs(chebyshev).max(axis=0)
    if not bool((np.abs(chebyshev[-2:]) <= tolerance).all()):
        if halvings == _MOST_HALVINGS:
            raise RotorError(f"segment {part!r} tapers too sharply; expected diameters further from zero")
        middle = 0.5 * (start + end)
        return _taper(part, start, middle, halvings + 1) + _taper(part, middle, end, halvings + 1)
    # Coefficients of the size of rounding are zero.
    chebyshev[np.abs(chebyshev) < 0.1 * tolerance] = 0.0
    bounds = np.array([*rows[:, :2].min(axis=0), *rows[:, 2:4].max(axis=0), part.axial_force])
    return [(start, end, (chebyshev.T @ _TO_POWERS), bounds)]


def merged_positions(joints: FloatArray, others: Sequence[float]) -> FloatArray:
    """Joints and other positions, ascending; positions that coincide are merged, onto a joint where there is one.

    Parameters
    ----------
    joints : ndarray, shape (n,)
        Ascending positions that stay exactly as they are [m].
    others : sequence of float
        Further positions on the shaft [m].
    """
    joint_list = joints.tolist()
    slack = STATION_TOLERANCE * joint_list[-1]
    added: list[float] = []
    for place in sorted(float(other) for other in others):
        right = min(max(bisect_left(joint_list, place), 1), len(joint_list) - 1)
        near = min(abs(place - joint_list[right - 1]), abs(place - joint_list[right])) <= slack
        if not near and (not added or place - added[-1] > slack):
            added.append(place)
    return np.sort(np.concatenate([joints, added])) if added else joints
