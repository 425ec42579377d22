"""A case whose housing is reduced matrices: `[housing.reduced]`, its machine, and what is refused by key."""

import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reduced_frames import write_dmig

import gearwhine as gw
from gearwhine.case import CaseError, dump_case
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.housing.reduced import read_matrix, reduced_matrices
from gearwhine.results.first_page import machine_section

SEATS = {"input-back": 11, "input-front": 12, "output-back": 21, "output-front": 22}
SEAT_MASS, SEAT_INERTIA, SPRING, TILT_SPRING = 6.0, 0.02, 3e8, 2e6


def uncoupled(path: Path, scale: float = 1.0) -> Path:
    """Write a body at each seat, each of them to be held by springs of the case, in SI."""
    coordinates = [(node, axis) for node in SEATS.values() for axis in range(1, 7)]
    mass = scale * np.diag([SEAT_MASS if axis <= 3 else SEAT_INERTIA for _, axis in coordinates])
    # A weak beam between the two seats of each shaft, along z, so that there is stiffness in the file.
    stiffness = np.zeros_like(mass)
    for one in (2, 14):
        stiffness[np.ix_([one, one + 6], [one, one + 6])] = [[1e5, -1e5], [-1e5, 1e5]]
    return write_dmig(path, {"MAAX": mass, "KAAX": stiffness}, coordinates, field="large")


@pytest.fixture
def document(tmp_path: Path) -> dict[str, Any]:
    uncoupled(tmp_path / "housing.pch")
    case = tomllib.loads((files("gearwhine.cases") / "small-gearbox.toml").read_text("utf-8"))
    centers = {seat["name"]: seat["center"] for seat in case["housing"]["seat"]}
    springs = dict.fromkeys("xyz", SPRING) | dict.fromkeys(("rx", "ry", "rz"), TILT_SPRING)
    case["housing"] = {
        "frequency_limit": "3 kHz",
        "damping_ratio": 0.0,
        "reduced": {
            "mass": str(tmp_path / "housing.pch"),
            "stiffness": str(tmp_path / "housing.pch"),
            "mass_name": "MAAX",
            "stiffness_name": "KAAX",
        },
        "seat": [{"name": name, "node": node, "center": centers[name]} for name, node in SEATS.items()],
        "support": [
            {"name": f"under {name}", "node": node, "position": centers[name], "stiffness": springs}
            for name, node in SEATS.items()
        ],
        "sensor": [{"name": "top", "node": 11, "position": centers["input-back"], "direction": "y"}],
    }
    case.pop("provenance", None)
    case.pop("acoustics", None)
    return case


def test_frequencies_of_bodies_on_springs(document: dict[str, Any]) -> None:
    """Four bodies of √(k/m) in each translation; along z two on a weak spring s between them have √((k + 2 s)/m)."""
    study = gw.build(**document)
    checked = study.check().document["reduced_housing"]
    plain, paired = np.sqrt([SPRING / SEAT_MASS, (SPRING + 2e5) / SEAT_MASS]) / (2.0 * np.pi)
    tilting = np.sqrt(TILT_SPRING / SEAT_INERTIA) / (2.0 * np.pi)
    expected = sorted([plain] * 10 + [paired] * 2 + [tilting] * 12)
    np.testing.assert_allclose(checked["frequencies_hz"], expected, rtol=1e-7)
    assert checked["seats"] == list(SEATS)
    assert checked["certificate"]["mass_kg"] == pytest.approx(4.0 * SEAT_MASS)
    housing = study.machine.housing
    assert isinstance(housing, HousingComponent)
    assert housing.kinds == ("housing",) * 24


def test_check_holds_the_interface_against_a_static_stiffness(document: dict[str, Any], tmp_path: Path) -> None:
    """Along z the weak beams between the seats of each shaft are all the stiffness that the files have."""
    coordinates = [(node, 3) for node in SEATS.values()]
    beams = 1e5 * np.kron(np.eye(2), [[1.0, -1.0], [-1.0, 1.0]])
    write_dmig(tmp_path / "static.pch", {"KAAX": 1.25 * beams}, coordinates, field="large")
    document["housing"]["reduced"]["static"] = str(tmp_path / "static.pch")
    checked = gw.build(**document).check()
    assert checked.document["reduced_housing"]["certificate"]["static_difference"] == pytest.approx(0.2)
    assert "held_frequency_hz" not in checked.document["reduced_housing"]["certificate"]
    assert any("differs by up to 20 %" in one for one in checked.warnings)
    write_dmig(tmp_path / "other.pch", {"KAAX": beams[:1, :1]}, [(99, 3)], field="large")
    document["housing"]["reduced"]["static"] = str(tmp_path / "other.pch")
    with pytest.raises(CaseError, match=r"housing.reduced.static: expected .* lack component 3 of node 99"):
        gw.build(**document).check()


def test_a_mapping_names_the_rows(document: dict[str, Any], tmp_path: Path) -> None:
    """The bodies at the seats by order, with their nodes in a file of their own; one row less is refused by its key."""
    read = {kind: read_matrix(tmp_path / "housing.pch", kind=kind) for kind in ("mass", "stiffness")}
    matrices = reduced_matrices(read)
    np.savez(tmp_path / "box.npz", mass=matrices.mass, stiffness=matrices.stiffness)
    lines = [f"{node}.123456" for node in SEATS.values()]
    (tmp_path / "rows.dof").write_text("\n".join(lines))
    named = gw.build(**document).check().document["reduced_housing"]["frequencies_hz"]
    files = {key: str(tmp_path / "box.npz") for key in ("mass", "stiffness")}
    document["housing"]["reduced"] = files | {"mapping": str(tmp_path / "rows.dof")}
    np.testing.assert_allclose(
        gw.build(**document).check().document["reduced_housing"]["frequencies_hz"], named, rtol=1e-12
    )
    (tmp_path / "rows.dof").write_text("\n".join(lines[:3]))
    with pytest.raises(CaseError, match=r"housing.reduced.mass: .* is of order 24; expected 18, the rows"):
        gw.build(**document).check()


def test_the_load_deflects_the_seats_by_their_springs(document: dict[str, Any]) -> None:
    """Across the shaft each seat stands on its own springs and moves by the bearing's force over their stiffness."""
    document["housing"]["support"][0]["stiffness"] = document["housing"]["support"][0]["stiffness"] | {"y": 5e7}
    bearings = gw.build(**document).operating_point().document["bearings"]
    for bearing in bearings:
        stiffness = np.array([SPRING, 5e7 if bearing["seat"] == "input-back" else SPRING])
        expected = np.array(bearing["force_n"][:2]) / stiffness
        np.testing.assert_allclose(bearing["seat_displacement_m"][:2], expected, rtol=1e-6, atol=1e-15)
    assert max(abs(bearing["force_n"][1]) for bearing in bearings) > 100.0


def test_tables_without_effect_are_warned_of(document: dict[str, Any]) -> None:
    document["acoustics"] = {"method": "erp"}
    document["housing"].pop("sensor")
    warnings = gw.build(**document).warnings
    assert any(one.startswith("[acoustics] has no effect: [housing.reduced] has no shapes") for one in warnings)
    assert any(one.startswith("[housing] has no [[housing.sensor]]") for one in warnings)


def test_its_damping_is_listed(document: dict[str, Any]) -> None:
    document["housing"]["damping_ratio"] = 0.03
    listed = gw.build(**document).check().document["damping"]
    (of_housing,) = [one for one in listed if one["part"] == "housing"]
    assert of_housing["damping"] == "3 % of critical in every mode"


def test_the_report_names_it(document: dict[str, Any]) -> None:
    words = "2 shafts, 4 bearings and 1 gear pair in a housing of reduced matrices on 4 supports; 1 sensor."
    assert words in machine_section(gw.build(**document).case).content


def test_it_is_written_and_read_again(document: dict[str, Any]) -> None:
    case = gw.build(**document).case
    again = gw.build(**tomllib.loads(dump_case(case))).case
    assert again.reduced_housing == case.reduced_housing
    assert again.housing is None


@pytest.mark.parametrize("command", ["mesh", "sound", "render"])
def test_commands_that_need_shapes_say_so(document: dict[str, Any], command: str) -> None:
    with pytest.raises(CaseError, match=f"housing.reduced: expected a box, CAD or mesh file: '{command}' needs a mesh"):
        getattr(gw.build(**document), command)()


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (
            ("reduced", "mass_name"),
            "MBBX",
            r"housing.reduced.mass: expected a file of the mass matrix; .* it has 'MAAX'",
        ),
        (("reduced", "nodes"), [11], r"housing.reduced.nodes: expected none beside files that name their nodes"),
        (("reduced", "units"), "inch", r"housing.reduced.units: expected one of 'SI' or 'mm-t-s', got 'inch'"),
        (("reduced", "stiff"), 1, r"housing.reduced.stiff: expected no such key"),
        (("seat", 1, "node"), 99, r'housing.seat\[1\].node \(seat "input-front"\): expected an interface node'),
        (
            ("sensor", 0, "position"),
            [0, 0, 0],
            r'housing.sensor\[0\].position \(sensor "top"\): expected the one place',
        ),
        (("frequency_limit",), -1.0, "housing.frequency_limit: expected a frequency above 0 Hz"),
        (("box",), {"size": ["1 m"] * 3}, "expected exactly one of"),
    ],
)
def test_refused_by_key(document: dict[str, Any], path: tuple[Any, ...], value: Any, words: str) -> None:
    table = document["housing"]
    for step in path[:-1]:
        table = table[step]
    table[path[-1]] = value
    with pytest.raises(CaseError, match=words):
        gw.build(**document).check()


def test_mass_of_a_mountain(document: dict[str, Any]) -> None:
    uncoupled(Path(document["housing"]["reduced"]["mass"]), 1e9)
    with pytest.raises(
        CaseError, match=r"housing.reduced.mass \(total \[kg\]\): expected a housing of 0.001 to 1e\+06 kg"
    ):
        gw.build(**document).check()


def test_key_of_the_library_is_none_of_a_case(document: dict[str, Any]) -> None:
    document["reduced_housing"] = document.pop("housing")
    with pytest.raises(CaseError, match=r"reduced_housing: expected no such key: matrices are the table"):
        gw.build(**document)
