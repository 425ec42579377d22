"""Shaft elements of a ROSS file: cylinders, cones and couplings in a row, their nodes and shear coefficients.

ROSS has two formulas for the shear coefficient κ. Its ``cowper`` is Cowper's, as in
`gearwhine.rotors.model.material.shear_coefficient`. Its ``hutchinson`` has the denominator of Hutchinson (J. Appl.
Mech. 68, 2001) but a factor 1 + ν less in the numerator,

    κ = 6 (1 + ν)(1 + m²)² / [(1 + m²)²(7 + 12ν + 4ν²) + 4 m²(5 + 6ν + 2ν²)],

0.71 for a solid section of ν = 0.3 where Hutchinson's is 0.93. The results of ROSS follow from it, and so does a rotor
read from its files. Elements without shear deflection (``shear_effects`` false) have a κ so large that they are
rigid in shear to ten digits.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise
from typing import Final

import numpy as np

from gearwhine.rotors.errors import RotorError
from gearwhine.rotors.model.material import ElasticMaterial, Section, ShaftMaterial, ShearFormula
from gearwhine.rotors.model.segment import Coupling, Segment, forces_beside
from gearwhine.rotors.model.shaft import Disc
from gearwhine.rotors.ross.sleeves import side_by_side
from gearwhine.rotors.ross.tables import Entry, Remarks

RIGID_IN_SHEAR: Final = 1e9
"""Shear coefficient of an element without shear deflection."""

_SAME_DIAMETER_DIFFERENCE = 1e-9


def ross_hutchinson(bore_ratio: float, poisson_ratio: float) -> float:
    """Shear coefficient κ of ROSS's ``hutchinson`` for a bore over outer diameter m and a Poisson ratio ν."""
    m2, nu = bore_ratio**2, poisson_ratio
    squared = (1.0 + m2) ** 2
    below = squared * (7.0 + 12.0 * nu + 4.0 * nu**2) + 4.0 * m2 * (5.0 + 6.0 * nu + 2.0 * nu**2)
    return 6.0 * squared * (1.0 + nu) / below


def ross_formula(segment: Segment) -> tuple[str, bool, float]:
    """Return the formula of ROSS that is closest to a segment's shear coefficient.

    Returns
    -------
    name : str
        ``"cowper"`` or ``"hutchinson"``.
    shear_effects : bool
        False where the segment is rigid in shear.
    difference : float
        Relative difference of its κ from that of the segment at the middle of its length.
    """
    middle = segment.section(0.5)
    factor = middle.shear_factor
    if factor >= RIGID_IN_SHEAR:
        return "cowper", False, 0.0
    of_ross = {
        "cowper": Section(middle.outer_diameter, middle.inner_diameter, middle.material, "cowper").shear_factor,
        "hutchinson": ross_hutchinson(
            middle.inner_diameter / middle.outer_diameter, middle.material.poisson_ratio
        ),
    }  # fmt: skip
    name = min(of_ross, key=lambda formula: abs(of_ross[formula] - factor))
    difference = of_ross[name] / factor - 1.0
    return name, True, 0.0 if abs(difference) < _SAME_DIAMETER_DIFFERENCE else difference


SHAFT = "ShaftElement"
COUPLING = "CouplingElement"

_SHAFT_KEYS = frozenset(
    ("L", "idl", "odl", "idr", "odr", "material", "n", "axial_force", "torque", "shear_effects", "rotary_inertia")
    + ("gyroscopic", "shear_method_calc", "tag", "alpha", "beta", "color")
)
_STIFFNESSES = ("kt_x", "kt_y", "kt_z", "kr_x", "kr_y", "kr_z")
_DAMPINGS = ("ct_x", "ct_y", "ct_z", "cr_x", "cr_y", "cr_z")
_COUPLING_KEYS = frozenset(
    ("m_l", "m_r", "Ip_l", "Ip_r", "Id_l", "Id_r", "o_d", "L", "n", "tag", "scale_factor", "color")
    + _STIFFNESSES
    + _DAMPINGS
)
# Length that ROSS gives to a coupling without one, and the distance of its nodes.
_COUPLING_LENGTH = 0.2
_AXIAL_ERROR = 1e-3  # relative error of the axial stiffness of elements between the same nodes, beyond which it is said


@dataclass(frozen=True)
class ReadShaft:
    """A row of segments and the positions of the file's nodes on it.

    Attributes
    ----------
    segments : tuple of Segment or Coupling
        Segments from the left end.
    discs : tuple of Disc
        Discs at the ends of couplings whose halves differ.
    first_node : int
        Number of the node at the left end.
    positions : tuple of float, shape (segments + 1,)
        Positions of the nodes [m].
    """

    segments: tuple[Segment | Coupling, ...]
    discs: tuple[Disc, ...]
    first_node: int
    positions: tuple[float, ...]

    @property
    def last_node(self) -> int:
        """Number of the node at the right end."""
        return self.first_node + len(self.segments)

    def position(self, node: int) -> float:
        """Distance of a node from the left end [m]."""
        return self.positions[node - self.first_node]


def read_shaft(entries: Sequence[Entry], remarks: Remarks) -> ReadShaft:
    """Read the shaft's elements and couplings, one or more, given in the order of the file.

    Raises
    ------
    RotorError
        Elements that are not one row, or one that cannot be a segment.
    """
    row = _in_a_row(entries)
    segments: list[Segment | Coupling] = []
    halves = []
    for beside in row:
        first = beside[0]
        try:
            if first.kind == COUPLING:
                coupling, ends = _coupling(first, remarks)
                segments.append(coupling)
                halves.append((len(segments), ends))
            elif len(beside) == 1:
                segments.append(_segment(first, remarks))
            else:
                segments.append(_together(beside, remarks))
        except RotorError as error:
            raise error if first.file in str(error) else RotorError(f"{first.file}: {first.key}: {error}") from None
    segments = _passing_on([beside[0] for beside in row], segments, remarks)
    lengths = np.array([0.0, *(segment.length for segment in segments)], dtype=np.longdouble)
    positions = tuple(np.cumsum(lengths).astype(np.float64).tolist())
    discs = [
        Disc(positions[number - 1 + side], mass, polar, diametral)
        for number, ends in halves
        for side, (mass, polar, diametral) in enumerate(ends)
    ]
    return ReadShaft(tuple(segments), tuple(discs), row[0][0].node() or 0, positions)


def _in_a_row(entries: Sequence[Entry]) -> list[list[Entry]]:
    """Sort the elements by their left nodes, those between the same two together; by the file if none is given."""
    nodes = [entry.node() for entry in entries]
    if all(node is None for node in nodes):
        return [[entry] for entry in entries]
    for entry, node in zip(entries, nodes, strict=True):
        if node is None:
            raise entry.error("n", "a node, since other elements of the shaft have one")
    row = [list(beside) for _, beside in groupby(sorted(entries, key=Entry.required_node), key=Entry.required_node)]
    for left, right in pairwise(row):
        if right[0].required_node() != left[0].required_node() + 1:
            gap = f"{left[0].required_node() + 1}: one shaft, its elements end to end"
            raise right[0].error("n", gap)
    for beside in row:
        for entry in beside if len(beside) > 1 else ():
            if entry.kind == COUPLING:
                other = next(one for one in beside if one is not entry)
                raise entry.error(
                    "n", f"a node of its own; {other.key} is there too, and a coupling has none beside it"
                )
    return row


def _together(beside: Sequence[Entry], remarks: Remarks) -> Segment:
    """Read elements between the same two nodes as one segment."""
    segment, axial_error = side_by_side([_segment(entry, remarks) for entry in beside])
    text = "is one segment with what stands between the same nodes: stiffness and mass of all, which bend as one"
    if abs(axial_error) > _AXIAL_ERROR:
        text += f"; its axial stiffness is {'lower' if axial_error < 0.0 else 'higher'} than theirs"
    remarks.add(beside[0].place, text)
    return segment


def _segment(entry: Entry, remarks: Remarks) -> Segment:
    _note_unknown(entry, _SHAFT_KEYS, remarks)
    outer, inner = entry.number("odl"), entry.number("idl")
    right_outer, right_inner = entry.number("odr", outer), entry.number("idr", inner)
    material = _material(entry.inner("material"))
    return Segment(
        length=entry.number("L"),
        outer_diameter=outer,
        inner_diameter=inner,
        material=material,
        shear_coefficient=_shear(entry, material, (outer, inner, right_outer, right_inner), remarks),
        right_outer_diameter=None if right_outer == outer else right_outer,
        right_inner_diameter=None if right_inner == inner else right_inner,
        axial_force=entry.number("axial_force", 0.0),
    )


def _material(entry: Entry) -> ShaftMaterial:
    """Read the material, for which two of E, G and Poisson's ratio are enough, as in ROSS."""
    density = entry.number("rho")
    if "E" not in entry.values:
        shear = entry.number("G_s")
        return ShaftMaterial(2.0 * shear * (1.0 + entry.number("Poisson")), shear, density)
    if "G_s" not in entry.values:
        return ShaftMaterial.from_poisson_ratio(entry.number("E"), entry.number("Poisson"), density)
    return ShaftMaterial(entry.number("E"), entry.number("G_s"), density)


def _shear(
    entry: Entry, material: ElasticMaterial, diameters: tuple[float, float, float, float], remarks: Remarks
) -> float | ShearFormula:
    """Shear coefficient as in ROSS, with remarks on properties that the exact segment cannot have."""
    for flag, property_name in (("rotary_inertia", "rotary inertia"), ("gyroscopic", "gyroscopic moment")):
        if not entry.flag(flag):
            remarks.add(entry.place, f"{flag} is false; the segment keeps its {property_name}")
    for name, term in (("torque", "torque"), ("alpha", "mass-proportional damping"), ("beta", "internal damping")):
        if (value := entry.number(name, 0.0)) != 0.0:
            remarks.add(entry.place, f"{name} is {value:g}; the shaft's {term} is left out")
    if not entry.flag("shear_effects"):
        return RIGID_IN_SHEAR
    method = entry.values.get("shear_method_calc", "cowper")
    if method == "hutchinson":
        outer, inner, right_outer, right_inner = diameters
        factor = ross_hutchinson((inner + right_inner) / (outer + right_outer), material.poisson_ratio)
        remarks.add(
            entry.place,
            "shear_method_calc is 'hutchinson', in which ROSS leaves out a factor 1 + ν; taken as ROSS computes it, "
            f"{factor:.6g}",
        )
        return factor
    if method != "cowper":
        raise entry.error("shear_method_calc", "'cowper' or 'hutchinson'")
    return "cowper"


def _coupling(entry: Entry, remarks: Remarks) -> tuple[Coupling, tuple[tuple[float, float, float], ...]]:
    """Read a coupling, and mass, polar and diametral inertia of its two halves where these differ."""
    _note_unknown(entry, _COUPLING_KEYS, remarks)
    for name in _DAMPINGS:
        if entry.number(name, 0.0) < 0.0:
            raise entry.error(name, "damping that is not negative")
    for x, y in (("kt_x", "kt_y"), ("kr_x", "kr_y"), ("ct_x", "ct_y"), ("cr_x", "cr_y")):
        if entry.number(x, 0.0) != entry.number(y, 0.0):
            raise entry.error(y, f"{entry.number(x, 0.0):g}, the value of {x}: a coupling turns with the shaft")
    for name in ("kt_x", "kt_z", "kr_x", "kr_z"):
        if entry.number(name, 0.0) <= 0.0:
            raise entry.error(name, "a positive stiffness: shafts not connected in a direction are rotors of their own")
    length = entry.number("L", _COUPLING_LENGTH)
    remarks.add(
        entry.place,
        f"is read as a springy piece of {length:g} m, in equilibrium under its shear force; the spring of ROSS has no "
        "length, and resists a tilt of the whole shaft",
    )
    ends = []
    for side in ("l", "r"):
        polar = entry.number(f"Ip_{side}")
        # As in ROSS, a diametral inertia of zero is half the polar one.
        ends.append((entry.number(f"m_{side}"), polar, entry.number(f"Id_{side}", 0.0) or 0.5 * polar))
    alike = ends[0] == ends[1]
    mass, polar, diametral = (2.0 * value if alike else 0.0 for value in ends[0])
    coupling = Coupling(
        length=length,
        lateral_stiffness=entry.number("kt_x"),
        tilt_stiffness=entry.number("kr_x"),
        torsional_stiffness=entry.number("kr_z"),
        axial_stiffness=entry.number("kt_z"),
        mass=mass,
        polar_inertia=polar,
        diametral_inertia=diametral,
        lateral_damping=entry.number("ct_x", 0.0),
        tilt_damping=entry.number("cr_x", 0.0),
        torsional_damping=entry.number("cr_z", 0.0),
        axial_damping=entry.number("ct_z", 0.0),
    )
    return coupling, () if alike else tuple(ends)


def _passing_on(
    row: Sequence[Entry], parts: Sequence[Segment | Coupling], remarks: Remarks
) -> list[Segment | Coupling]:
    """Give couplings the axial force that the segments on both sides have; one of ROSS carries none."""
    passed = list(parts)
    for number, (entry, part) in enumerate(zip(row, parts, strict=True)):
        if not isinstance(part, Coupling):
            continue
        left, right = forces_beside(parts, number)
        if left is None or right is None:
            continue
        if left != right:
            text = f"carries no axial force, between a shaft with {left:g} N and one with {right:g} N"
            remarks.add(entry.place, text)
        elif left != 0.0:
            passed[number] = replace(part, axial_force=left)
            text = f"carries the axial force of {left:g} N of the shafts beside it, which ROSS leaves out there"
            remarks.add(entry.place, text)
    return passed


def _note_unknown(entry: Entry, known_names: frozenset[str], remarks: Remarks) -> None:
    """Remark on keys that are unknown for this class of element."""
    for name in entry.values:
        if name not in known_names:
            remarks.add(entry.place, f"{name} is not read")
