"""No machine that cannot be, or hardly is, passes without a word: it is refused by key, or warned of."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from broken_cases import broken
from odd_but_sound import bundled, changed, shaft
from semantic_nonsense import NONSENSE

import gearwhine as gw
from gearwhine.case import CaseError, parse_case
from gearwhine.case.checks.whole_case import warnings_of
from gearwhine.case.load import bundled_names, load_case
from gearwhine.coupling import Machine, MountedBearing, Output, Shaft, ShaftForce, ShaftGear
from gearwhine.coupling.errors import TransientError
from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.sound import Acoustics
from gearwhine.from_case.parametric_housing import fitted_case
from gearwhine.housing import Support
from gearwhine.housing.material import STEEL, Material
from gearwhine.rotors import Bearing, Disc, Rotor, Segment
from gearwhine.rotors.rolling_bearings import BallRow, RollerRow, paired


def test_there_are_a_hundred() -> None:
    assert len(NONSENSE) >= 100


@pytest.mark.parametrize("name", NONSENSE)
def test_nonsense_is_not_silent(name: str) -> None:
    try:
        case = parse_case(NONSENSE[name], source="case.toml")
    except CaseError as error:
        for problem in error.problems:
            assert problem.source == "case.toml"
            assert problem.key != "the case"
            assert problem.expected
        return
    warnings = warnings_of(case)
    assert warnings
    assert all(": " in text for text in warnings)


@pytest.mark.parametrize("name", bundled_names())
def test_bundled_cases_are_neither_refused_nor_doubted(name: str) -> None:
    assert not [text for text in load_case(name).warnings if "unusual = " in text]


@pytest.mark.parametrize("sign", ["", "-"])
def test_a_torque_that_no_shaft_bears_is_refused_whatever_its_sign(sign: str) -> None:
    with pytest.raises(CaseError, match=rf"expected a torque of at most 1e\+10 N\*m, got '{sign}1e30 N\*m'"):
        gw.load("spur-pair", [f"operation.torque={sign}1e30 N*m"])


def test_what_is_unusual_can_be_meant() -> None:
    light = changed("steel-box", ("material.steel.density", "30 kg/m^3"))
    (text,) = [text for text in warnings_of(parse_case(light)) if "density" in text]
    assert text.startswith("material.steel.density: expected a density of 300 to 23000 kg/m^3")
    for path in ("material.steel.density", "material.*", "material.steel"):
        assert not [text for text in warnings_of(parse_case(light | {"unusual": [path]})) if "density" in text]
    assert [text for text in warnings_of(parse_case(light | {"unusual": ["material.brass"]})) if "density" in text]
    thick = changed("spur-pair", *((f"rotor.{i}.segments.0.diameter", "95 mm") for i in (0, 1)))
    with pytest.raises(CaseError, match="a shaft clear of shaft"):  # what cannot be is not accepted
        parse_case(thick | {"unusual": ["*"]})


@pytest.mark.parametrize(("speed", "told"), [(1500, True), (-1500, True), (376, False), ("14323.9 rpm", False)])
def test_a_number_of_rpm_without_its_unit_is_doubted(speed: object, *, told: bool) -> None:
    """1500 rad/s are 14324 rpm; 376 rad/s are those of a motor of two poles at 60 Hz, 3591 rpm."""
    document = changed("spur-pair", ("operation.speed", speed))
    texts = [text for text in warnings_of(parse_case(document)) if text.startswith("operation.speed: ")]
    assert len(texts) == told
    assert not told or (f"is '{speed} rpm' meant" in texts[0] and 'unusual = ["operation.speed"]' in texts[0])
    assert all("operation.speed" not in t for t in warnings_of(parse_case(document | {"unusual": ["operation.speed"]})))


def test_the_way_in_which_teeth_differ_is_told_without_a_name_as_value() -> None:
    with pytest.raises(CaseError) as caught:
        parse_case(changed("spur-pair", ("gear.1.module", "3 mm")))
    (problem,) = caught.value.problems
    assert str(problem).endswith('"wheel" 3 mm')


def test_a_ring_without_the_minus_of_its_teeth_is_told_of_it() -> None:
    with pytest.raises(CaseError, match="a ring has a negative number of teeth, teeth = -75"):
        parse_case(changed("planetary-stage", ("gear.2.teeth", 75)))


def test_all_impossible_places_are_told_at_once() -> None:
    document = changed("spur-pair", ("gear.0.at", "20 mm"), ("gear.1.at", "180 mm"), ("gear_pair", []))
    document.pop("operation")
    document.pop("transient")
    with pytest.raises(CaseError) as caught:
        parse_case(document, source="case.toml")
    assert [problem.key for problem in caught.value.problems] == ["gear[0].at", "gear[1].at"]


ROTOR = Rotor("in", [Segment(0.2, 0.03, 0.0, STEEL)])
GEAR = Gear("pinion", 28, 3.175e-3, math.radians(20.0), 6.35e-3)
LOOSE = {"name": "b", "at": 0.02, "stiffness": 1e8 * np.eye(2), "damping": np.zeros((2, 2))}


def spur(**changes: Any) -> Machine:
    shafts = [Shaft(ROTOR), Shaft(replace(ROTOR, name="out"), axis=(88.9e-3, 0.0))]
    bearings = [
        MountedBearing(Bearing.isotropic(f"{shaft} {at}", at, 1e8), shaft, None)
        for shaft in ("in", "out")
        for at in (0.02, 0.18)
    ]
    gears = [ShaftGear(GEAR, "in", 0.1), ShaftGear(replace(GEAR, name="wheel"), "out", 0.1)]
    parts = {"gears": gears, "gear_pairs": [GearPair("pinion", "wheel")], "speed": 100.0, "torque": 50.0}
    return Machine(shafts, bearings, **(parts | changes))


IN_PYTHON: dict[str, tuple[Callable[[], object], str]] = {
    "negative backlash": (lambda: GearPair("p", "w", backlash=-1e-4), "gear pair 'p -> w': backlash is -0.0001"),
    "infinite backlash": (lambda: GearPair("p", "w", backlash=math.inf), "backlash is inf"),
    "negative damping": (lambda: GearPair("p", "w", damping=-1.0), "damping is -1"),
    "damping that is none": (lambda: GearPair("p", "w", damping_ratio=math.nan), "damping_ratio is nan"),
    "friction as a word": (lambda: GearPair("p", "w", friction="oil"), "friction is 'oil'"),  # type: ignore[arg-type]
    "no such model": (lambda: GearPair("p", "w", "stiff"), "unknown stiffness model 'stiff'"),
    "misalignment in degrees": (lambda: GearPair("p", "w", misalignment=3.0), "misalignment is 3"),
    "gear pair of numbers": (lambda: GearPair(1, 2), "driver is 1"),  # type: ignore[arg-type]
    "speed that is none": (lambda: spur(speed=math.nan), "machine: speed is nan"),
    "infinite speed": (lambda: spur(speed=math.inf), "machine: speed is inf"),
    "torque as a word": (lambda: spur(torque="much"), "machine: torque is 'much'"),
    "gear in place of a mounted one": (lambda: spur(gears=[GEAR]), "machine: gears[0]"),
    "housing as a name": (lambda: spur(housing="box"), "machine: housing is 'box'"),
    "bursting gears": (lambda: spur(speed=5e4), "expected a pitch-line speed at which no rim bursts"),
    "gear on a bearing": (
        lambda: spur(gears=[ShaftGear(GEAR, "in", 0.02), ShaftGear(replace(GEAR, name="wheel"), "out", 0.02)]),
        "gear 'pinion': at: expected a gear clear of bearing \"in 0.02\"",
    ),
    "backlash of a tooth": (lambda: spur(gear_pairs=[GearPair("pinion", "wheel", backlash=0.01)]), "backlash is 0.01"),
    "shaft as a number": (lambda: Shaft(3), "rotor is 3"),  # type: ignore[arg-type]
    "shaft nowhere": (lambda: Shaft(ROTOR, start=math.nan), "shaft 'in': start is nan"),
    "axis of one number": (lambda: Shaft(ROTOR, axis=(1.0,)), "shaft 'in': axis"),  # type: ignore[arg-type]
    "shaft damped by -1": (lambda: Shaft(ROTOR, damping_ratio=-1.0), "damping_ratio is -1"),
    "gear at NaN": (lambda: ShaftGear(GEAR, "in", math.nan), "gear 'pinion': at is nan"),
    "inertia of no body": (lambda: ShaftGear(GEAR, "in", 0.1, (1.0, 1.0, 0.1)), "inertia is 1; expected at most twice"),
    "seat as a number": (
        lambda: MountedBearing(Bearing(**LOOSE), "in", 7),  # type: ignore[arg-type]
        "bearing 'b': seat is 7",
    ),
    "stiffness in place of a bearing": (lambda: MountedBearing(1e8, "in", None), "bearing is"),  # type: ignore[arg-type]
    "stiffness that is none": (
        lambda: Bearing("b", 0.0, np.full((2, 2), math.nan), np.zeros((2, 2))),
        "bearing 'b': stiffness",
    ),
    "output of NaN": (lambda: Output("out", math.nan), "output 'out': torque is nan"),
    "force as a number": (lambda: ShaftForce("in", 0.1, 5.0), "force 'in': force is 5"),  # type: ignore[arg-type]
    "force of two numbers": (lambda: ShaftForce("in", 0.1, (5.0, 1.0)), "force"),  # type: ignore[arg-type]
    "disc of no body": (lambda: Disc(0.1, 1.0, 1.0, 0.1), "expected at most twice the diametral_inertia"),
    "relief of a tooth": (
        lambda: replace(GEAR, eccentricity=2e-3),
        "gear 'pinion': eccentricity is 0.002; expected at most a quarter of the module",
    ),
    "rollers of a metre": (lambda: RollerRow(9, 8e-3, 1.0, 46e-3), "roller length is 1.0"),
    "rows in each other": (lambda: paired(BallRow(9, 8e-3, 46e-3, 0.4), "back to back", 2e-3), "distance of two rows"),
    "support by a word": (lambda: Support("foot", surface="bottom", fixed="xyz"), "support 'foot': fixed is 'xyz'"),  # type: ignore[arg-type]
    "support by a number": (lambda: Support("foot", surface="bottom", stiffness=1e8), "support 'foot': stiffness"),  # type: ignore[arg-type]
    "material of NaN": (lambda: Material(math.nan, 0.3, 7850.0), "material: youngs_modulus is nan"),
    "material of 207 Pa": (lambda: Material(207.0, 0.3, 7850.0), "at least 1 kPa"),
    "density as text": (lambda: Material(207e9, 0.3, "7850"), "density is '7850'"),  # type: ignore[arg-type]
}


@pytest.mark.parametrize("name", IN_PYTHON)
def test_constructors_refuse_with_part_attribute_and_value(name: str) -> None:
    make, words = IN_PYTHON[name]
    with pytest.raises(ValueError) as caught:  # its words are compared below
        make()
    assert words in str(caught.value)


def test_findings_carry_part_attribute_value_and_expectation() -> None:
    with pytest.raises(ValueError, match="backlash") as caught:
        GearPair("p", "w", backlash=-1e-4, friction=2.0)
    found = caught.value.findings  # type: ignore[attr-defined]
    assert [(one.part, one.attribute, one.value) for one in found] == [
        (("gear pair", "p -> w"), "backlash", -1e-4),
        (("gear pair", "p -> w"), "friction", 2.0),
    ]
    assert all(one.severity == "error" for one in found)


def test_a_machine_doubts_its_load() -> None:
    assert not [text for text in spur().warnings if "teeth bear" in text]
    (text,) = [text for text in spur(torque=7e3).warnings if "teeth bear" in text]
    assert "press their flanks with" in text


PLAIN_BEARING: dict[str, Any] = {"name": "plain", "rotor": "input", "at": "20 mm"}


@pytest.mark.parametrize(
    ("key", "value", "attribute"),
    [
        ("operation.gravity", [0.0, -98.1, 0.0], "gravity"),
        ("bearing.0.stiffness.xx", "-1.2e8 N/m", "stiffness.xx"),
        ("bearing.0", PLAIN_BEARING | {"stiffness": {"xx": "1.2e8 N/m", "yy": 0.0}}, "stiffness.yy"),
    ],
)
def test_a_machine_doubts_what_its_case_doubts(key: str, value: Any, attribute: str) -> None:
    case = parse_case(changed("spur-pair", (key, value)))
    machine = case.parts.machine
    assert machine is not None
    (found,) = (one for one in machine.findings if one.attribute == attribute)
    assert found.severity == "warning"
    assert [text for text in warnings_of(case) if attribute in text and found.expected in text]


def test_a_medium_that_is_no_gas_is_doubted_as_in_a_case() -> None:
    document = changed("steel-box", ("acoustics", {"density": "998 kg/m^3", "speed_of_sound": "1480 m/s"}))
    told = warnings_of(parse_case(document))
    for finding in Acoustics(density=998.0, speed_of_sound=1480.0).findings:
        assert [text for text in told if f"acoustics.{finding.attribute}" in text and finding.expected in text]
    assert not list(Acoustics().findings)


def test_one_error_for_a_wrong_segment() -> None:
    document = broken(("rotor.0.segments.0.diameter", "thick"), sound=bundled("spur-pair"))
    with pytest.raises(CaseError) as caught:
        parse_case(document)
    assert [problem.key for problem in caught.value.problems] == ["rotor[0].segments[0].diameter"]


def test_a_dotted_key_of_thousands_of_tables_is_refused_before_it_is_parsed(tmp_path: Path) -> None:
    """The parser takes time with the square of their number: half a minute for twenty thousand."""
    file = tmp_path / "case.toml"
    inline = "x = { " + '"a" . ' * 20_000 + "a = 1}"
    for text in ("a." * 20_000 + "a = 1", "[" + "a." * 20_000 + "a]", inline):
        file.write_text(text, encoding="utf-8")
        begin = time.perf_counter()
        with pytest.raises(CaseError, match="at most 32 deep"):
            load_case(file)
        assert time.perf_counter() - begin < 2.0
    file.write_text('notes = """\n' + "e. g. " * 40 + '"""\n[material.a]\n', encoding="utf-8")
    with pytest.raises(CaseError, match=r"material.a.density"):
        load_case(file)


def test_one_thickness_of_all_walls_is_fitted() -> None:
    document = changed("steel-box", ("housing.box.wall", "9 mm"))
    parameter = {"name": "walls", "keys": ["housing.box.wall"], "range": ["5 mm", "20 mm"]}
    tables = {"update": {"parameter": [parameter]}, "measured": {"frequencies": ["600 Hz"]}}
    (number,) = fitted_case(parse_case(document | tables)).numbers
    assert {place[-1] for place in number.places} == {"left", "right", "bottom", "top", "back", "front"}
    assert number.own == pytest.approx([9e-3] * 6)


def test_an_unstable_rotor_is_warned_of() -> None:
    unstable = shaft()
    for held in unstable["bearing"]:
        held["stiffness"] |= {"xy": "2e6 N/m", "yx": "-2e6 N/m"}
    document = gw.build(**unstable, rotor_analysis={"modes": 4, "speed": ["100 rpm", "3000 rpm"]}).rotors().document
    (entry,) = [entry for entry in document["warnings"] if entry["name"] == "unstable rotor"]
    assert entry["rotor"] == "s"
    assert entry["unstable_from_rpm"] == pytest.approx(100.0, rel=1e-6)


@pytest.mark.parametrize("key", ["highest_frequency", "mesh_size"])
def test_triangles_longer_than_the_housing_are_no_traceback(key: str) -> None:
    value = {"highest_frequency": "100 Hz", "mesh_size": "1 m"}[key]
    study = gw.build(**changed("small-gearbox", ("acoustics", {key: value})))
    if key == "mesh_size":
        with pytest.raises(CaseError, match=r"acoustics.mesh_size: expected an edge of at most 53.3333 mm"):
            study.check()
    else:
        assert [text for text in study.check().warnings if "highest_frequency" in text]


def test_a_shaft_that_swings_about_its_only_bearing_is_doubted() -> None:
    """Without the second bearing the machine has no equilibrium; a bearing that resists tilting holds the shaft."""
    document = bundled("spur-pair")
    del document["bearing"][1]
    (told,) = [text for text in warnings_of(parse_case(document)) if "swings" in text]
    assert told.startswith('rotor[0] (rotor "input"): expected a second bearing')
    stiffness = [[1e8 if i == j else 0.0 for j in range(5)] for i in range(5)]
    document["bearing"][0]["stiffness"] = {"matrix": stiffness}
    assert not [text for text in warnings_of(parse_case(document)) if "swings" in text]
    assert not [text for text in warnings_of(parse_case(bundled("spur-pair"))) if "swings" in text]


@pytest.mark.slow
def test_a_run_under_a_load_that_no_tooth_bears_says_so_where_it_ends() -> None:
    changes = {"operation.torque": "3 kN*m", "transient.revolutions": 4, "transient.discard": 2}
    with pytest.raises(TransientError, match=r"^operation\.torque: expected a load that teeth bear: .*no motion under"):
        gw.load("spur-pair", changes).run()


def test_what_is_nearly_incompressible_is_refused_by_its_key() -> None:
    with pytest.raises(CaseError, match=r"poisson_ratio: expected a Poisson ratio of at least 0 and below 0\.4999"):
        gw.load("steel-box", {"material.steel.poisson_ratio": 0.49999})
