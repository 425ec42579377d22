"""Rotors read from files in the form of ROSS's: what each key becomes, what is remarked on, what is refused.

The tables follow what ``Rotor.save`` of ROSS 2.3 writes; `tests/validation/test_against_ross.py` has ROSS itself.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from gearwhine.rotors import Coupling, Disc, RotorError, Segment, ShaftMaterial, read_ross, rest_frequencies
from gearwhine.rotors.model.material import shear_coefficient

Document = dict[str, Any]

STEEL = {"name": "Steel", "rho": 7810.0, "E": 211e9, "G_s": 81.2e9, "color": "#525252"}
OURS = ShaftMaterial(211e9, 81.2e9, 7810.0)


def element(node: int, **changes: Any) -> Document:
    """As ROSS writes one, with changes; those to None are left out."""
    plain = {"L": 0.25, "idl": 0.0, "odl": 0.05, "idr": 0.0, "odr": 0.05, "n": node, "axial_force": 0, "torque": 0}
    flags = {"shear_effects": True, "rotary_inertia": True, "gyroscopic": True, "shear_method_calc": "cowper"}
    rest = {"tag": f"Shaft Element {node}", "alpha": 0.0, "beta": 0.0, "material": dict(STEEL)}
    return {key: value for key, value in (plain | flags | rest | changes).items() if value is not None}


def bearing(n: int, tag: str, **changes: Any) -> Document:
    """All fifteen coefficients are always written, each as a list."""
    size = len(changes.get("frequency", [0]))
    names = [letter + place for letter in "kcm" for place in ("xx", "xy", "yx", "yy", "zz")]
    zeros = {name: [0.0] * size for name in names}
    return (
        zeros
        | {"n": n, "tag": tag, "color": "#355d7a", "scale_factor": 1, "kxx": [1e6] * size, "kyy": [1e6] * size}
        | changes
    )


def document(*shaft: Document, **others: Document) -> Document:
    elements = {f"ShaftElement_{one.get('tag', number)}": one for number, one in enumerate(shaft)}
    return {"ross_version": "2.3.0", "parameters": {}} | elements | others


def saved(folder: Path, content: Document, name: str = "rotor.toml") -> Path:
    path = folder / name
    path.write_text(tomli_w.dumps(content), encoding="utf-8")
    return path


def two_elements(**others: Document) -> Document:
    return document(element(0), element(1), **others)


def test_each_element_becomes_a_segment_with_its_own_ends_and_material(tmp_path: Path) -> None:
    cone = element(1, L=0.1, idl=0.01, odl=0.05, idr=0.02, odr=0.08, axial_force=2500.0)
    other = element(2, material={"rho": 4500.0, "E": 110e9, "Poisson": 0.3}, idr=None, odr=None)
    rotor, bearings, remarks = read_ross(saved(tmp_path, document(element(0), cone, other), "fan.toml"))
    titanium = ShaftMaterial.from_poisson_ratio(110e9, 0.3, 4500.0)
    assert rotor.name == "fan"
    assert rotor.segments == (
        Segment(0.25, 0.05, 0.0, OURS),
        Segment(0.1, 0.05, 0.01, OURS, "cowper", 0.08, 0.02, 2500.0),
        Segment(0.25, 0.05, 0.0, titanium),
    )
    assert bearings == ()
    assert remarks == ()


def test_elements_stand_in_the_order_of_their_nodes_or_of_the_file(tmp_path: Path) -> None:
    lengths = [0.3, 0.1, 0.2]
    by_node = document(*(element(n, L=lengths[n]) for n in (2, 0, 1)))
    unnumbered = document(*(element(n, L=length, n=None) for n, length in enumerate(lengths)))
    for content in (by_node, unnumbered):
        assert [segment.length for segment in read_ross(saved(tmp_path, content)).rotor.segments] == lengths


def test_disks_gears_and_masses_become_discs_at_their_nodes(tmp_path: Path) -> None:
    rotor, _, remarks = read_ross(
        saved(
            tmp_path,
            two_elements(
                **{
                    "DiskElement_Disk 0": {"n": 1, "m": 12.0, "Id": 0.1, "Ip": 0.2, "tag": "Disk 0"},
                    "GearElement_g": {"n": 2, "m": 3.0, "Id": 0.01, "Ip": 0.02, "n_teeth": 20},
                    "PointMass_p": {"n": 0, "m": 1.5},
                }
            ),
        )
    )
    assert rotor.discs == (Disc(0.25, 12.0, 0.2, 0.1), Disc(0.5, 3.0, 0.02, 0.01), Disc(0.0, 1.5))
    assert remarks == ("rotor.toml: GearElement_g: is read as a disc; its teeth are left out",)


def test_bearings_keep_their_matrices_tables_and_names(tmp_path: Path) -> None:
    content = two_elements(
        BearingElement_a=bearing(0, "left", kxy=[2e5], kyx=[-1e5], kyy=[8e5], cxx=[300.0], cyy=[200.0]),
        SealElement_b=bearing(1, "seal", kxx=[-2e5], seal_leakage=0.1),  # a seal may push the shaft away
        BearingElement_c=bearing(
            2, "thrust", frequency=[0.0, 100.0], kxx=[1e6, 2e6], kyy=[3e6, 4e6], kzz=[5e6, 6e6], czz=[7.0, 8.0]
        ),
        # As a user may write it by hand: y like x.
        BearingElement_d={"n": 2, "kxx": 1e5, "cxx": 50},
    )
    _, (left, seal, thrust, plain), remarks = read_ross(saved(tmp_path, content))
    np.testing.assert_array_equal(left.stiffness, [[1e6, 2e5], [-1e5, 8e5]])
    np.testing.assert_array_equal(left.damping, np.diag([300.0, 200.0]))
    assert (left.name, left.at, seal.name, seal.at) == ("left", 0.0, "seal", 0.25)
    assert seal.stiffness[0, 0] == -2e5
    np.testing.assert_array_equal(thrust.speeds, [0.0, 100.0])
    np.testing.assert_array_equal(thrust.stiffness, [np.diag([1e6, 3e6, 5e6, 0, 0]), np.diag([2e6, 4e6, 6e6, 0, 0])])
    np.testing.assert_array_equal(thrust.damping[:, 2, 2], [7.0, 8.0])
    np.testing.assert_array_equal(plain.stiffness, 1e5 * np.eye(2))
    np.testing.assert_array_equal(plain.damping, 50.0 * np.eye(2))
    assert remarks == ()


def test_a_linked_bearing_stands_on_a_pedestal(tmp_path: Path) -> None:
    content = two_elements(
        BearingElement_a=bearing(0, "left"),
        BearingElement_b=bearing(2, "right", n_link=3, kzz=[1e5]),
        BearingElement_c=bearing(3, "foot", kxx=[1e8], kyy=[2e8], cxx=[500.0]),
        PointMass_d={"n": 3, "m": 8.0, "mx": 8.0, "my": 8.0, "mz": 8.0},
    )
    _, (left, right), remarks = read_ross(saved(tmp_path, content))
    assert left.pedestal is None
    assert right.pedestal is not None
    assert right.pedestal.mass == 8.0
    np.testing.assert_array_equal(right.pedestal.stiffness, np.diag([1e8, 2e8]))
    np.testing.assert_array_equal(right.pedestal.damping, np.diag([500.0, 0.0]))
    assert len(remarks) == 1
    assert "BearingElement_b: kzz stands on the ground" in remarks[0]


def test_a_coupling_keeps_its_stiffness_and_what_its_halves_weigh(tmp_path: Path) -> None:
    halves = {"m_l": 2.0, "m_r": 2.0, "Ip_l": 0.02, "Ip_r": 0.02, "Id_l": 0.0, "Id_r": 0.0}
    springs = {"kt_x": 1e8, "kt_y": 1e8, "kt_z": 2e7, "kr_x": 1e5, "kr_y": 1e5, "kr_z": 3e5}
    content = document(element(0), element(2, tag="last"), CouplingElement_c={"n": 1, "L": 0.1} | springs | halves)
    rotor, _, remarks = read_ross(saved(tmp_path, content))
    # A diametral inertia of zero is half the polar one to ROSS.
    assert rotor.segments[1] == Coupling(0.1, 1e8, 1e5, 3e5, 2e7, mass=4.0, polar_inertia=0.04, diametral_inertia=0.02)
    assert rotor.discs == ()
    assert len(remarks) == 1
    content["CouplingElement_c"] |= {"m_r": 5.0}
    rotor, _, _ = read_ross(saved(tmp_path, content))
    assert rotor.segments[1].mass == 0.0
    assert rotor.discs == (Disc(0.25, 2.0, 0.02, 0.01), Disc(0.35, 5.0, 0.02, 0.01))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"alpha": 1.5}, "alpha is 1.5; the shaft's mass-proportional damping is left out"),
        ({"beta": 1e-5}, "beta is 1e-05; the shaft's internal damping is left out"),
        ({"torque": 10.0}, "torque is 10; the shaft's torque is left out"),
        ({"rotary_inertia": False}, "rotary_inertia is false; the segment keeps its rotary inertia"),
        ({"gyroscopic": False}, "gyroscopic is false; the segment keeps its gyroscopic moment"),
        ({"colour": "red"}, "colour is not read"),
    ],
)
def test_what_a_segment_cannot_hold_is_said_once(change: Document, said: str, tmp_path: Path) -> None:
    content = document(element(0), element(1, **change), element(2, **change))
    assert read_ross(saved(tmp_path, content)).warnings == (
        f"rotor.toml: ShaftElement_Shaft Element 1 and 1 more: {said}",
    )


def test_added_mass_of_a_seal_is_remarked_on(tmp_path: Path) -> None:
    (said,) = read_ross(saved(tmp_path, two_elements(SealElement_s=bearing(1, "s", mxx=[0.25])))).warnings
    assert said == "rotor.toml: SealElement_s: mxx is up to 0.25 kg; the added mass is left out"


def test_a_shaft_rigid_in_shear_is_that_of_rayleigh(tmp_path: Path) -> None:
    """A pinned-pinned shaft without shear: ω² = (n π / L)⁴ EI / (ρA + ρI (n π / L)²), in closed form."""
    content = document(*(element(n, shear_effects=False) for n in range(4)))
    content |= {f"BearingElement_{n}": bearing(n, str(n), kxx=[1e14], kyy=[1e14]) for n in (0, 4)}
    rotor, bearings, remarks = read_ross(saved(tmp_path, content))
    area, second = math.pi / 4 * 0.05**2, math.pi / 64 * 0.05**4
    waves = (np.arange(1, 4) * math.pi) ** 2
    expected = waves * np.sqrt(211e9 * second / (7810.0 * (area + second * waves)))
    np.testing.assert_allclose(rest_frequencies(rotor, bearings, count=6).frequencies[::2], expected, rtol=1e-6)
    assert remarks == ()


def test_hutchinson_is_taken_as_ross_computes_it(tmp_path: Path) -> None:
    rotor, _, (said,) = read_ross(
        saved(tmp_path, document(element(0, shear_method_calc="hutchinson", idl=0.02, idr=0.02)))
    )
    # ROSS leaves out a factor 1 + ν of Hutchinson's formula, which is coded independently in `shear_coefficient`.
    expected = shear_coefficient("hutchinson", 0.4, OURS.poisson_ratio) / (1.0 + OURS.poisson_ratio)
    assert rotor.segments[0].shear_coefficient == pytest.approx(expected, rel=1e-12)
    assert "leaves out a factor 1 + ν" in said


def without(content: Document, *path: str) -> Document:
    inner = content
    for step in path[:-1]:
        inner = inner[step]
    del inner[path[-1]]
    return content


FIRST = "ShaftElement_Shaft Element 0"
WHOLE = {"n": 2, "m_l": 1.0, "m_r": 1.0, "Ip_l": 0.1, "Ip_r": 0.1,
         "kt_x": 1e8, "kt_y": 1e8, "kt_z": 1e7, "kr_x": 1e5, "kr_y": 1e5, "kr_z": 1e5}  # fmt: skip
COUPLED = {"n": 2, "m_l": 1.0, "m_r": 1.0, "Ip_l": 0.1, "Ip_r": 0.1, "kr_z": 1e5}
WRONG: dict[str, tuple[Document, str]] = {
    "no length": (without(two_elements(), FIRST, "L"), f"{FIRST}.L is 'missing'; expected a finite number"),
    "text for a number": (document(element(0, L="0.25")), f"{FIRST}.L is '0.25'; expected a finite number"),
    "a flag for a number": (document(element(0, odl=True)), f"{FIRST}.odl is True"),
    "not finite": (document(element(0, odl=math.nan)), f"{FIRST}.odl is nan"),
    "too large an integer": (document(element(0, odl=10**400)), f"{FIRST}.odl is 1000"),
    "bore as large as the shaft": (document(element(0, idl=0.05)), f"{FIRST}: segment: inner_diameter is 0.05"),
    "negative length": (document(element(0, L=-0.25)), f"{FIRST}: segment: length is -0.25"),
    "no material": (without(two_elements(), FIRST, "material"), f"{FIRST}.material is 'missing'; expected a table"),
    "no modulus": (without(two_elements(), FIRST, "material", "E"), f"{FIRST}.material.Poisson is 'missing'"),
    "unknown shear formula": (document(element(0, shear_method_calc="x")), f"{FIRST}.shear_method_calc is 'x'"),
    "flag that is none": (document(element(0, gyroscopic=1)), f"{FIRST}.gyroscopic is 1; expected true or false"),
    "side by side of two lengths": (document(element(0), element(1), element(1, tag="b", L=0.3)),
                                    "elements between the same two nodes have lengths 0.25, 0.3 m"),
    "beside a coupling": (document(element(0), element(1), element(2), CouplingElement_c=WHOLE),
                          "CouplingElement_c.n is 2; expected a node of its own; ShaftElement_Shaft Element 2 is"),
    "cones of two materials": (document(element(0, odr=0.06), element(0, tag="b", idl=0.05, idr=0.06, odl=0.08,
                               odr=0.08, material={"rho": 1.0, "E": 1e9, "Poisson": 0.3})), "expected them to be of"),
    "lists of unlike length": (two_elements(BearingElement_b=bearing(0, "b", kxx=[[1.0, 2.0], [3.0]])), "lists of"),
    "frequencies beside the speeds": (two_elements(BearingElement_b=bearing(0, "b", speed=[0.0, 9.0],
        kxx=[[1.0, 2.0], [3.0, 4.0]], kyy=0.0, frequency=[50.0, 60.0])), "b.frequency is [50.0, 60.0]; expected asc"),
    "two shafts": (document(element(0), element(2)), "Shaft Element 2.n is 2; expected 1: one shaft"),
    "one unnumbered": (document(element(0), element(1, n=None)), "Shaft Element 1.n is 'missing'"),
    "half a node": (document(element(0, n=0.5)), f"{FIRST}.n is 0.5; expected a node: a whole number from 0"),
    "no shaft": ({"DiskElement_d": {"n": 0, "m": 1.0, "Id": 0.0, "Ip": 0.0}}, "no ShaftElement"),
    "disk off the shaft": (two_elements(DiskElement_d={"n": 3, "m": 1.0, "Id": 0.0, "Ip": 0.0}), "Element_d.n is 3"),
    "negative inertia": (two_elements(DiskElement_d={"n": 0, "m": 1.0, "Id": -1.0, "Ip": 0.0}), "_d: disc: diametral"),
    "unknown class": (two_elements(RodElement_d={"n": 0}), "RodElement_d is an element of class 'RodElement'"),
    "no damping": (without(two_elements(BearingElement_b=bearing(0, "b")), "BearingElement_b", "cxx"), "b.cxx is"),
    "tables that differ": (two_elements(BearingElement_b=bearing(0, "b", frequency=[0.0, 1.0], kxy=[1.0, 2.0, 3.0])),
                           "b.kxy is [1.0, 2.0, 3.0]; expected 2 values"),
    "list without speeds": (two_elements(BearingElement_b=bearing(0, "b", kxx=[1.0, 2.0])), "expected one value"),
    "speeds that fall": (two_elements(BearingElement_b=bearing(0, "b", frequency=[1.0, 0.0])), "bearing 'b' speeds"),
    "endless stiffness": (two_elements(BearingElement_b=bearing(0, "b", kxx=[math.inf])), "b.kxx is [inf]; expected"),
    "bearing in the air": (two_elements(BearingElement_b=bearing(5, "b")), "b.n is 5; expected a node of"),
    "bearing between shafts": (two_elements(BearingElement_b=bearing(0, "b", n_link=1)), "b.n_link is 1; expected"),
    "link to nothing": (two_elements(BearingElement_b=bearing(0, "b", n_link=3)), "BearingElement_b.n_link is 3"),
    "two on one support": (two_elements(BearingElement_b=bearing(0, "b", n_link=3), BearingElement_s=bearing(3, "s"),
                                        BearingElement_c=bearing(2, "c", n_link=3)), "BearingElement_c.n_link is 3"),
    "support on a support": (two_elements(BearingElement_b=bearing(0, "b", n_link=3),
                                          BearingElement_s=bearing(3, "s", n_link=4)), "BearingElement_s.n_link is 4"),
    "table of a support": (two_elements(BearingElement_b=bearing(0, "b", n_link=3),
                                        BearingElement_s=bearing(3, "s", frequency=[0.0, 1.0])), "s.frequency is"),
    "mass unlike in y": (two_elements(PointMass_p={"n": 0, "mx": 1.0, "my": 2.0}), "PointMass_p.my is 2.0; expected 1"),
    "loose coupling": (two_elements(CouplingElement_c=dict(COUPLED)), "CouplingElement_c.kt_x is 'missing'; expected"),
    "coupling damped unlike in y": (two_elements(CouplingElement_c=WHOLE | {"ct_x": 5.0}), "_c.ct_y is 'missing'"),
    "coupling that drives": (two_elements(CouplingElement_c=WHOLE | {"cr_z": -5.0}), "c.cr_z is -5"),
    "coupling unlike in y": (two_elements(CouplingElement_c=COUPLED | {"kt_x": 1e5, "kt_y": 2e5}), "c.kt_y is 200000"),
    "a value at the top": ({"shaft": 3}, "shaft is 3; expected a table"),
    "nothing": ({}, "no elements; expected a rotor saved by ROSS"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_wrong_files_name_file_key_and_value(name: str, tmp_path: Path) -> None:
    content, said = WRONG[name]
    with pytest.raises(RotorError) as raised:
        read_ross(saved(tmp_path, content, "wrong.toml"))
    assert said in str(raised.value)
    assert str(raised.value).startswith("wrong.toml: ")


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("rotor.toml", b"[parameters\n", "expected TOML"),
        ("rotor.json", b"[1, 2", "expected JSON"),
        ("rotor.json", b"[1, 2]", "expected a table of elements"),
        ("rotor.toml", b"\xff\xfe", "is not UTF-8"),
    ],
)
def test_what_is_no_such_file_is_said(name: str, content: bytes, said: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(RotorError, match=said):
        read_ross(tmp_path / name)
    with pytest.raises(RotorError, match="expected a rotor saved by ROSS"):
        read_ross(tmp_path / "missing.toml")


def together(folder: Path, *beside: Document) -> tuple[Segment, tuple[str, ...]]:
    (segment,), _, remarks = (lambda read: (read.rotor.segments, read.bearings, read.warnings))(
        read_ross(saved(folder, document(*beside)))
    )
    return segment, remarks


def test_a_sleeve_of_the_same_material_makes_one_section_with_its_shaft(tmp_path: Path) -> None:
    """Areas and second moments of a shaft of 50 mm and a sleeve of 50 to 80 mm are those of one of 80 mm."""
    sleeve = element(0, tag="sleeve", idl=0.05, idr=0.05, odl=0.08, odr=0.08, axial_force=50.0)
    segment, remarks = together(tmp_path, element(0, axial_force=100.0), sleeve)
    assert (segment.outer_diameter, segment.inner_diameter, segment.length) == (0.08, 0.0, 0.25)
    assert segment.axial_force == 150.0
    nu = 211.0 / (2.0 * 81.2) - 1.0
    shares = [
        (25.0, shear_coefficient("cowper", 0.0, nu)),
        (39.0, shear_coefficient("cowper", 0.625, nu)),
    ]  # 5², 8² - 5²
    assert segment.shear_coefficient == pytest.approx(sum(area * factor for area, factor in shares) / 64.0)
    assert len(remarks) == 1
    assert "one segment with what stands between the same nodes" in remarks[0]
    assert "axial" not in remarks[0]


def test_a_conical_sleeve_keeps_both_ends(tmp_path: Path) -> None:
    sleeve = element(0, tag="sleeve", idl=0.05, idr=0.06, odl=0.08, odr=0.1)
    segment, _ = together(tmp_path, sleeve, element(0, odr=0.06, idl=0.01, idr=0.02))
    assert segment.end_diameters == ((0.08, 0.01), (0.1, 0.02))


@pytest.mark.parametrize("density", [2700.0, 11300.0])
def test_a_sleeve_of_another_material_adds_its_stiffness_and_mass(tmp_path: Path, density: float) -> None:
    """Sums of E I, G J, κ G A, ρ A and ρ I, computed here from diameters in a file's own terms."""
    soft = {"rho": density, "E": 70e9, "G_s": 26e9}
    sleeve = element(0, tag="sleeve", idl=0.05, idr=0.05, odl=0.08, odr=0.08, material=soft)
    segment, remarks = together(tmp_path, element(0), sleeve)
    rings = [(0.05, 0.0, 211e9, 81.2e9, 7810.0), (0.08, 0.05, 70e9, 26e9, density)]
    areas = [math.pi / 4 * (outer**2 - inner**2) for outer, inner, *_ in rings]
    moments = [math.pi / 64 * (outer**4 - inner**4) for outer, inner, *_ in rings]
    factors = [shear_coefficient("cowper", inner / outer, e / (2 * g) - 1.0) for outer, inner, e, g, _ in rings]
    section = segment.section(0.5)
    assert section.bending_stiffness == pytest.approx(sum(r[2] * i for r, i in zip(rings, moments, strict=True)))
    assert section.torsional_stiffness == pytest.approx(2 * sum(r[3] * i for r, i in zip(rings, moments, strict=True)))
    assert section.shear_stiffness == pytest.approx(
        sum(k * r[3] * a for k, r, a in zip(factors, rings, areas, strict=True))
    )
    assert section.mass_per_length == pytest.approx(sum(r[4] * a for r, a in zip(rings, areas, strict=True)))
    assert section.polar_inertia_per_length == pytest.approx(
        2 * sum(r[4] * i for r, i in zip(rings, moments, strict=True))
    )
    assert (segment.inner_diameter > 0.0) == (density > 7810.0)
    assert "its axial stiffness is lower than theirs" in remarks[0]


def test_nodes_are_counted_by_places_and_not_by_elements(tmp_path: Path) -> None:
    """A bearing at node 2 stands at the end of two elements, however many are beside the first one."""
    rings = [(0.05, 0.06), (0.06, 0.07), (0.07, 0.08)]
    sleeves = [element(0, tag=f"to {d}", idl=b, idr=b, odl=d, odr=d) for b, d in rings]
    read = read_ross(saved(tmp_path, document(element(1), element(0), *sleeves, BearingElement_b=bearing(2, "b"))))
    assert [segment.outer_diameter for segment in read.rotor.segments] == [0.08, 0.05]
    assert read.bearings[0].at == 0.5


@pytest.mark.parametrize("version", ["3.1.0", "2.3.0", "1.6.1", None])
def test_files_of_every_version_are_read(tmp_path: Path, version: str | None) -> None:
    """ROSS 3 calls the axis of a table over the speed of rotation `speed`; before it was `frequency`."""
    axis = "speed" if version == "3.1.0" else "frequency"
    table = bearing(0, "b", **{axis: [0.0, 50.0, 100.0]}) | {"kxx": [1e6, 2e6, 4e6], "kyy": [1e6] * 3}
    for name in ("kxy", "kyx", "kzz", "cxx", "cxy", "cyx", "cyy", "czz", "mxx", "mxy", "myx", "myy", "mzz"):
        table[name] = [0.0] * 3
    if axis == "speed":
        table |= {"interpolation": "pchip", "radial_clearance": 1e-4}
    content = two_elements(BearingElement_b=table)
    del content["ross_version"]
    if version == "3.1.0":
        content["parameters"] = {"default_damping_ratio": 0.0, "alpha": 0.0, "beta": 0.0}
    _, (read,), remarks = read_ross(
        saved(tmp_path, content if version is None else {"ross_version": version} | content)
    )
    np.testing.assert_array_equal(read.speeds, [0.0, 50.0, 100.0])
    np.testing.assert_array_equal(read.stiffness[:, 0, 0], [1e6, 2e6, 4e6])
    assert remarks == ()


def test_rounding_below_zero_in_the_damping_of_a_table_is_zero(tmp_path: Path) -> None:
    """ROSS 3.1 saves a magnetic bearing with a damping of -4.6e-8 N s/m at 1 rad/s beside others of 3 N s/m."""
    speeds = [0.0, 50.0, 100.0]
    table = bearing(0, "b", frequency=speeds) | {"cxx": [-4.6e-8, 1.5, 3.0], "kxx": [-4e3, 1e4, 2e4]}
    content = two_elements(MagneticBearingElement_b=table) | {"ross_version": "3.1.0"}
    _, (read,), _ = read_ross(saved(tmp_path, content))
    np.testing.assert_array_equal(read.damping[:, 0, 0], [0.0, 1.5, 3.0])
    np.testing.assert_array_equal(read.stiffness[:, 0, 0], [-4e3, 1e4, 2e4])
    table["cxx"][0] = -4.6e-3
    with pytest.raises(RotorError, match="a negative one feeds energy in"):
        read_ross(saved(tmp_path, content))


def test_damping_of_the_shaft_in_a_file_of_version_3_is_said(tmp_path: Path) -> None:
    content = two_elements() | {"ross_version": "3.1.0", "parameters": {"alpha": 0.0, "beta": 1e-5}}
    (remark,) = read_ross(saved(tmp_path, content)).warnings
    assert remark.endswith("parameters: beta is not read")


def test_a_table_over_the_frequency_of_whirl_is_taken_as_synchronous_and_said(tmp_path: Path) -> None:
    """Magnetic bearings and squeeze-film dampers of ROSS 3; its other interpolation is said, too."""
    table = bearing(0, "b", frequency=[0.0, 100.0]) | {"kxx": [1e6, 2e6], "kyy": [1e6, 2e6], "interpolation": "linear"}
    content = two_elements(MagneticBearingElement_b=table) | {"ross_version": "3.1.0"}
    _, (read,), remarks = read_ross(saved(tmp_path, content))
    np.testing.assert_array_equal(read.speeds, [0.0, 100.0])
    assert sorted("as if synchronous" in remark for remark in remarks) == [False, True]
    assert any("interpolation is 'linear'" in remark for remark in remarks)


def test_a_table_over_speed_and_frequency_is_taken_where_both_are_the_same(tmp_path: Path) -> None:
    """k = 1e6 + 1e3 speed + 1e2 frequency is 1e6 + 1.1e3 ω; speeds beyond the frequencies are left out."""
    speed, frequency = [0.0, 40.0, 80.0, 300.0], [0.0, 50.0, 100.0]
    stiffness = [[1e6 + 1e3 * s + 1e2 * f for f in frequency] for s in speed]
    names = [letter + place for letter in "kcm" for place in ("xx", "xy", "yx", "yy", "zz")]
    table = {name: [[0.0] * 3 for _ in speed] for name in names} | {"kxx": stiffness, "kyy": stiffness}
    table |= {"n": 0, "tag": "b", "speed": speed, "frequency": frequency}
    _, (read,), remarks = read_ross(saved(tmp_path, two_elements(BearingElement_b=table)))
    np.testing.assert_array_equal(read.speeds, [0.0, 40.0, 80.0])
    np.testing.assert_allclose(read.stiffness[:, 1, 1], 1e6 + 1.1e3 * np.array([0.0, 40.0, 80.0]), rtol=1e-12)
    assert any("left out" in remark for remark in remarks)


@pytest.mark.parametrize(
    ("kind", "kxx", "cxx"),
    [("SealElement", -2e5, 300.0), ("SqueezeFilmDamper", 0.0, 5e4), ("MagneticBearingElement", -4e6, 10.0)],
)
def test_seals_dampers_and_magnetic_bearings_keep_their_sign(tmp_path: Path, kind: str, kxx: float, cxx: float) -> None:
    others = {f"{kind}_x": bearing(1, "x", kxx=[kxx], kyy=[kxx], cxx=[cxx], cyy=[cxx])}
    _, (read,), _ = read_ross(saved(tmp_path, two_elements(**others)))
    np.testing.assert_array_equal(read.stiffness, kxx * np.eye(2))
    np.testing.assert_array_equal(read.damping, cxx * np.eye(2))
