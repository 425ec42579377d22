"""The bundled two-stage reducer: its drawing, the parts that must fit into each other, its loads and its modes."""

import importlib.util
import math
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from gearwhine.case import Case, load_case
from gearwhine.case.bearings import RollingCatalogue, RollingStiffness
from gearwhine.from_case.machine import describe_machine
from gearwhine.meshes.gmsh_meshing import gmsh_session

ROOT = Path(__file__).parents[2]
NAME = "two-stage-reducer"
MM = 1e3


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("drawing", ROOT / "scripts" / "make_two_stage_reducer.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case(NAME).case


def _solids(gmsh: Any, path: Path) -> list[tuple[int, int]]:
    solids = gmsh.model.occ.importShapes(str(path))
    gmsh.model.occ.synchronize()
    return sorted(solids)


def _measures(path: Path) -> dict[str, list[Any]]:
    """Volume [mm³], number of faces, and bounds [mm] of each solid, by the end of its name."""
    with gmsh_session("file") as gmsh:
        found = {}
        for dimension, tag in _solids(gmsh, path):
            faces = gmsh.model.getBoundary([(dimension, tag)], oriented=False)
            bounds = gmsh.model.getBoundingBox(dimension, tag)
            name = gmsh.model.getEntityName(dimension, tag).rpartition("/")[2]
            found[name] = [gmsh.model.occ.getMass(dimension, tag), len(faces), *bounds]
        return found


@pytest.mark.slow
def test_the_script_draws_the_bundled_file(script: ModuleType, tmp_path: Path) -> None:
    """The same solids by volume, faces and bounds: another version of the kernel may write other bytes."""
    script.write(tmp_path / "drawn.step")
    bundled, drawn = _measures(script.TARGET), _measures(tmp_path / "drawn.step")
    assert set(bundled) == set(drawn) == set(script.SOLIDS)
    for name, measures in bundled.items():
        np.testing.assert_allclose(measures, drawn[name], rtol=1e-6, atol=1e-4)
    # The cover is a plate with rounded corners; the halves meet in the plane of the shafts.
    size = script.Reducer()
    _, x, z, width = size.opening
    a, b = (2.0 * (half + 0.7 * width) for half in (x, z))
    assert bundled["inspection cover"][0] == pytest.approx((a * b - (4.0 - math.pi) * 10.0**2) * size.plate, rel=1e-6)
    assert bundled["lower housing"][6] == pytest.approx(size.shaft_height, abs=1e-5)
    assert bundled["upper housing"][3] == pytest.approx(size.shaft_height, abs=1e-5)
    assert bundled["lower housing"][3] == pytest.approx(0.0, abs=1e-5)
    assert bundled["lower housing"][2:8:3] == pytest.approx(
        [-size.x - size.flange[0], size.x + size.flange[0]], abs=1e-5
    )


def test_the_gears_have_room_in_the_housing_and_the_bearings_fill_their_seats(script: ModuleType, case: Case) -> None:
    """Blanks of the gears with 8 mm of air around share nothing with the housing."""
    rotors = {rotor.name: rotor for rotor in case.rotor}
    air = 8.0
    with gmsh_session("file") as gmsh:
        solids = _solids(gmsh, script.TARGET)
        blanks = []
        for gear in case.gear:
            rotor = rotors[gear.rotor or ""]
            x, y = (MM * place for place in rotor.axis)
            width = MM * (gear.face_width or 0.0) + 2.0 * air
            start = MM * (rotor.start + (gear.at or 0.0)) - 0.5 * width
            blanks.append((3, gmsh.model.occ.addCylinder(x, y, start, 0, 0, width, MM * gear.build().tip_radius + air)))
        shared, _ = gmsh.model.occ.intersect(solids, blanks)
        assert shared == []
    assert case.housing is not None
    seats = {seat.name: seat for seat in case.housing.seat}
    inner, outer = script.Reducer().z - script.Reducer().wall, script.Reducer().boss_face
    for bearing in case.bearing:
        if bearing.grounded:
            continue
        assert isinstance(bearing.stiffness, RollingStiffness)
        rolling = bearing.stiffness.rolling
        assert isinstance(rolling, RollingCatalogue)
        assert rolling.catalogue.outer_diameter == seats[bearing.seat].diameter
        width = rolling.catalogue.width + (rolling.spacing or 0.0)
        at = abs(rotors[bearing.rotor].start + bearing.at)
        assert inner <= MM * (at - 0.5 * width)
        assert MM * (at + 0.5 * width) <= outer


# Statics of each shaft on its two bearings under the forces of the teeth alone, which press with F_b = T / r_b along
# the line of action and F_b tan(beta_b) along the shaft. Stage 1: T = 7500 W / 151.8 rad/s = 49.39 N m, F_t = 2496 N,
# F_r = 1015 N and F_a = 629 N at the working pitch circles, z = 40 mm; stage 2: T = 200.2 N m, F_t = 6550 N,
# F_r = 2593 N, F_a = 1284 N, z = -27.5 mm.
BY_HAND = {
    "input-back": (-342.0, -661.0),
    "input-front": (-673.0, -1835.0),
    "intermediate-back": (-1970.0, 5184.0),
    "intermediate-front": (392.0, 3861.0),
    "output-back": (738.0, -4334.0),
    "output-front": (1854.0, -2215.0),
}
THRUST = {"input": -629.0, "intermediate": 629.0 - 1284.0, "output": 1284.0}


def test_the_operating_point_finds_the_loads_by_hand(case: Case) -> None:
    """Radial loads to 8 %, as by hand no moment acts in bearings and couplings; thrusts of a shaft in all to 0.2 %."""
    point = describe_machine(case).operating_point()
    for name, given in BY_HAND.items():
        np.testing.assert_allclose(point.bearing(name).force[:2], given, rtol=0.0, atol=0.08 * np.linalg.norm(given))
    for shaft, thrust in THRUST.items():
        found = sum(one.force[2] for one in point.bearings if one.mounted.rotor == shaft)
        assert found == pytest.approx(thrust, rel=2e-3)


def test_check_tells_mesh_frequencies_and_speeds(gearwhine: Any) -> None:
    """Closed forms z n / 60. A shaft that turns the other way has a speed of 0, not of -0."""
    shown = gearwhine("check", NAME, "-q", "--verbose", "--set", "housing=", "--set", "bearing.*.seat=ground").out
    assert f"{19 * 1450 / 60:.2f} Hz" in shown
    assert f"{17 * 1450 * 19 / 77 / 60:.2f} Hz" in shown
    assert "Campbell diagram at 51 speeds, -536.688 to 0 rpm" in shown
