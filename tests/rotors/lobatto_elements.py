"""Polynomial finite elements of high degree for a rotor's bending, torsion and axial motion.

Displacement x and rotation β of the section are separate polynomials of one degree in every element, over Lobatto's
hierarchic shape functions (Szabó and Babuška 1991): two that are linear, one for either end, and bubbles

    N_k = (P_k − P_{k−2}) / (2k − 1),   N_k' = P_{k−1},   k = 2 … p,

that vanish at both. Energies are those of Timoshenko, with the work of an axial force N on the slope of the line,

    2 U = ∫ κGA (x' − β)² + EI β'² + N x'² dz,     2 T = ∫ ρA ẋ² + ρI β̇² dz,

by Gauss's rule, so that cones are nothing special. Nothing here is shared with the transfer matrices but the diameters
and materials. A rigid motion has no strain at any Gauss point, to thirty-one digits: what rounds are weights, which
change each stiffness a little but none's kernel.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np
import numpy.typing as npt
from double_double import DoubleDouble

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Coupling, Rotor, Segment
from gearwhine.rotors.model.material import Section

DEGREE = 8
# Wave number times length of an element, at most. The relative error of ω² is about (p! / 2p!)² (k h)^2p / (2p + 1)
# (Ainsworth 2004): 1e-14 at degree 8.
REACH = 2.0
# Most that a diameter or a wall changes along an element of a cone: at degree 8 the error is 3e-14.
TAPER = 1.2
SAME_PLACE = 1e-9


@dataclass(frozen=True)
class Elements:
    """A rotor cut into elements: nodes (e + 1,) in m, and of each its segment and its part of that.

    `fractions` is (e, 2): where each begins and ends along its segment. Lengths (e,) follow from these, since
    differences of nodes would have lost the digits of a short one.
    """

    nodes: FloatArray
    segment: npt.NDArray[np.intp]
    fractions: FloatArray
    lengths: FloatArray

    def node(self, at: float) -> int:
        """Index of the node at a place, m."""
        return int(np.argmin(np.abs(self.nodes - at)))


@dataclass(frozen=True)
class Matrices:
    """Matrices of all elements, each (e, n, n), unknowns in the order left end, right end, bubbles.

    `size` is how many displacements a node has: 2, x before β, or 1.
    """

    size: int
    stiffness: DoubleDouble
    mass: DoubleDouble
    polar: DoubleDouble


def cut(rotor: Rotor, places: Sequence[float], highest: float, *, bends: bool = True) -> Elements:
    """Elements with nodes at every joint, disc and place, short enough for vibration at ``highest`` rad/s.

    Waves of torsion and of axial motion are longer than those of bending: without ``bends`` only they are heeded.
    """
    slack = SAME_PLACE * rotor.length
    wanted = sorted([*places, *(disc.at for disc in rotor.discs)])
    nodes, segments, fractions, lengths = [0.0], [], [], []
    for index, part in enumerate(rotor.segments):
        left, right = float(rotor.joints[index]), float(rotor.joints[index + 1])
        stops = [0.0]
        for place in wanted:
            if left + slack < place < right - slack and (place - left) / part.length > stops[-1] + slack / part.length:
                stops.append((place - left) / part.length)
        stops.append(1.0)
        for start, stop in itertools.pairwise(stops):
            for near, far in itertools.pairwise([start, *_edges(part, (start, stop), highest, bends)]):
                segments.append(index)
                fractions.append((near, far))
                lengths.append((far - near) * part.length)
                nodes.append(left + far * part.length)
    return Elements(np.array(nodes), np.array(segments), np.array(fractions), np.array(lengths))


def bending_matrices(rotor: Rotor, elements: Elements) -> Matrices:
    """Of one plane; `polar` is the gyroscopic matrix per rad/s."""
    value, slope, weight, per_length = _at_gauss_points(rotor, elements)
    n = value.high.shape[-1]
    order = _by_ends(2, n)
    nothing = DoubleDouble.of(np.zeros_like(value.high))
    strain = _side_by_side(slope, -value)[..., order]
    bend = _side_by_side(nothing, slope)[..., order]
    line = _side_by_side(slope, nothing)[..., order]
    moving = _side_by_side(value, nothing)[..., order]
    turning = _side_by_side(nothing, value)[..., order]
    stiffness = _gram(strain, weight * per_length["kGA"]) + _gram(bend, weight * per_length["EI"])
    if bool(per_length["N"].any()):
        stiffness = stiffness + _gram(line, weight * per_length["N"])
    rotary = _gram(turning, weight * per_length["rhoI"])
    mass = _gram(moving, weight * per_length["rhoA"]) + rotary
    return Matrices(2, stiffness, mass, rotary + rotary)


def rod_matrices(rotor: Rotor, elements: Elements, motion: str) -> Matrices:
    """Of twisting (``motion`` "torsion") or of stretching ("axial")."""
    value, slope, weight, per_length = _at_gauss_points(rotor, elements)
    stiff, heavy = {"torsion": ("GJ", "rhoJ"), "axial": ("EA", "rhoA")}[motion]
    mass = _gram(value, weight * per_length[heavy])
    return Matrices(1, _gram(slope, weight * per_length[stiff]), mass, mass - mass)


def _edges(part: Segment | Coupling, stretch: tuple[float, float], highest: float, bends: bool) -> list[float]:
    """Right ends of the elements of a stretch of a segment, as fractions of the segment."""
    start, stop = stretch
    if isinstance(part, Coupling):
        # Its own field has the wave number √(N/EI), N = P L / (k_t L²).
        stretched = abs(part.axial_force) / (part.tilt_stiffness * part.length)
        count = max(1, math.ceil(math.sqrt(stretched) * (stop - start) * part.length / REACH))
        return [*(start + (stop - start) * np.arange(1, count) / count).tolist(), stop]
    ends = [part.section(start), part.section(stop)]
    diameters = sorted(section.outer_diameter for section in ends)
    walls = sorted(section.outer_diameter - section.inner_diameter for section in ends)
    if max(diameters[1] / diameters[0], walls[1] / walls[0]) > TAPER:
        middle = 0.5 * (start + stop)
        halves = ((start, middle), (middle, stop))
        return [edge for half in halves for edge in _edges(part, half, highest, bends)]
    # Torsion is slower than axial motion.
    wave = highest * math.sqrt(part.material.density / part.material.shear_modulus)
    if bends:
        wave = max(_bending_wave(section, part.axial_force, highest) for section in ends)
    count = max(1, math.ceil(wave * (stop - start) * part.length / REACH))
    return [*(start + (stop - start) * np.arange(1, count) / count).tolist(), stop]


def _bending_wave(section: Section, force: float, omega: float) -> float:
    """Larger root in size of k⁴ − (s + b + n) k² − …, with the force's part n taken at its worst, 1/m."""
    heavy, rotary = section.mass_per_length, 0.5 * section.polar_inertia_per_length
    shear, bend = omega**2 * heavy / section.shear_stiffness, omega**2 * rotary / section.bending_stiffness
    stretched = abs(force) / section.bending_stiffness
    product = omega**2 * heavy / section.bending_stiffness
    root = math.sqrt((shear - bend) ** 2 + stretched**2 + 4.0 * product)
    return math.sqrt(0.5 * (shear + bend + stretched + root))


def _at_gauss_points(
    rotor: Rotor, elements: Elements
) -> tuple[DoubleDouble, DoubleDouble, FloatArray, dict[str, FloatArray]]:
    """Shape functions and their slopes (e, q, p + 1), weights and sections (e, q)."""
    value, derived, points, weights = _reference()
    count = elements.lengths.size
    ones = DoubleDouble.of(np.ones((count, 1, 1)))
    scale = DoubleDouble.of((2.0 / elements.lengths)[:, None, None])
    names = ("kGA", "EI", "N", "rhoA", "rhoI", "GJ", "rhoJ", "EA")
    rows = np.empty((count, points.size, len(names)))
    for element, index in enumerate(elements.segment):
        near, far = elements.fractions[element]
        rows[element] = _section_rows(rotor, int(index), near + 0.5 * (far - near) * (points + 1.0))
    per_length = {name: rows[:, :, column] for column, name in enumerate(names)}
    return value[None] * ones, derived[None] * scale, 0.5 * elements.lengths[:, None] * weights, per_length


def _section_rows(rotor: Rotor, index: int, fractions: FloatArray) -> list[tuple[float, ...]]:
    part = rotor.segments[index]
    if isinstance(part, Coupling):
        springs = (part.lateral_stiffness, part.tilt_stiffness, part.torsional_stiffness, part.axial_stiffness)
        shear, bend, twist, stretch = (stiffness * part.length for stiffness in springs)
        return [(shear, bend, part.axial_force, 0.0, 0.0, twist, 0.0, stretch)] * fractions.size
    present = float(rotor.mass_model == "distributed")
    rows = []
    for fraction in fractions.tolist() if part.is_conical else [0.0]:
        section = part.section(fraction)
        heavy, polar = present * section.mass_per_length, present * section.polar_inertia_per_length
        stiff = (section.shear_stiffness, section.bending_stiffness, part.axial_force)
        rows.append(
            (*stiff, heavy, 0.5 * polar, section.torsional_stiffness, polar, section.axial_stiffness),
        )
    return rows if part.is_conical else rows * fractions.size


@cache
def _reference() -> tuple[DoubleDouble, DoubleDouble, FloatArray, FloatArray]:
    """Shape functions and derivatives on [−1, 1] at Gauss's points (q, p + 1), rational at these doubles; weights."""
    points, weights = np.polynomial.legendre.leggauss(DEGREE + 4)
    values, slopes = [], []
    for point in points.tolist():
        xi = Fraction(point)
        legendre = [Fraction(1), xi]
        for k in range(2, DEGREE + 1):
            legendre.append(((2 * k - 1) * xi * legendre[-1] - (k - 1) * legendre[-2]) / k)
        bubbles = [(legendre[k] - legendre[k - 2]) / (2 * k - 1) for k in range(2, DEGREE + 1)]
        values.append([(1 - xi) / 2, (1 + xi) / 2, *bubbles])
        slopes.append([Fraction(-1, 2), Fraction(1, 2), *legendre[1:DEGREE]])
    return DoubleDouble.of_fractions(values), DoubleDouble.of_fractions(slopes), points, weights


def _by_ends(size: int, n: int) -> npt.NDArray[np.intp]:
    """From field by field to left end, right end, bubbles."""
    return np.arange(size * n).reshape(size, n).T.ravel()


def _side_by_side(left: DoubleDouble, right: DoubleDouble) -> DoubleDouble:
    return DoubleDouble(
        np.concatenate([left.high, right.high], axis=-1), np.concatenate([left.low, right.low], axis=-1)
    )


def _gram(strain: DoubleDouble, weight: FloatArray) -> DoubleDouble:
    """Σ over Gauss points of w sᵢ sⱼ, (e, n, n)."""
    total = DoubleDouble.of(np.zeros((strain.high.shape[0], strain.high.shape[2], strain.high.shape[2])))
    for point in range(weight.shape[1]):
        here = strain[:, point]
        weighted = here * DoubleDouble.of(weight[:, point, None])
        total = total + weighted[:, :, None] * here[:, None, :]
    return total
