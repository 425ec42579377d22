"""Mounts, joints, lumped masses and dashpots in a case: errors, the resolved form, and what they do to modes."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.case import CaseError, dump_case, load_case, parse_case
from gearwhine.case.checks.whole_case import warnings_of
from gearwhine.from_case.fixtures import build_fixtures
from gearwhine.meshes import BoxGeometry, Mesh, WallThickness, mesh_box, write_mesh
from gearwhine.output.terminal import shown_by
from gearwhine.results import check
from gearwhine.results.check import check_document
from gearwhine.results.housing import modes_document
from gearwhine.solve.housing_modes import solve_housing

STEEL = {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}
BOX: dict[str, Any] = {
    "title": "A box with everything on it",
    "material": {"steel": STEEL},
    "housing": {
        "material": "steel",
        "modes": 8,
        "box": {
            "size": ["200 mm", "160 mm", "240 mm"],
            "wall": "25 mm",
            "mesh_size": "80 mm",
            "feet": {"size": ["40 mm", "20 mm", "40 mm"]},
        },
        "support": [{"name": "foot", "surface": "foot-1", "damping": {"y": "2 kN*s/m"}}],
        "mount": [
            {
                "name": "rubber",
                "surface": "foot-2",
                "axis": "y",
                "stiffness": {"axial": "4e6 N/m", "shear": "1e6 N/m", "tilting": "100 N*m/rad"},
                "damping": {"axial": "300 N*s/m"},
            },
            {
                "name": "bush",
                "surface": "foot-3",
                "axes": [[1, 1, 0], [0, 1, 0]],
                "center": ["0 mm", "-20 mm", "0 mm"],
                "stiffness": {"x": "4e6 N/m", "y": "4e6 N/m", "z": "1e6 N/m", "rz": "90 N*m/rad"},
            },
        ],
        "joint": [{"name": "tie", "surfaces": ["left", "right"], "axis": [1, 0, 0], "stiffness": {"axial": "1e8 N/m"}}],
        "mass": [
            {
                "name": "motor",
                "surface": "top",
                "mass": "6 kg",
                "inertia": {"xx": "0.02 kg*m^2", "yy": "0.03 kg*m^2", "zz": "0.02 kg*m^2", "xy": "-0.001 kg*m^2"},
                "offset": ["0 mm", "60 mm", "10 mm"],
            },
            {"name": "probe", "position": ["20 mm", "80 mm", "120 mm"], "mass": "120 g"},
        ],
    },
}
GONE = object()


def changed(*changes: tuple[str, Any]) -> dict[str, Any]:
    document = copy.deepcopy(BOX)
    for path, value in changes:
        *way, last = [int(step) if step.isdecimal() else step for step in path.split(".")]
        here: Any = document["housing"]
        for step in way:
            here = here[step]
        if value is GONE:
            del here[last]
        else:
            here[last] = value
    return document


ONE_WRONG = {
    "fixed and damped": ("support.0.fixed", ["x"], "housing.support[0]", "either 'fixed', or 'stiffness' or 'damping'"),
    "held by nothing": ("support.0.damping", GONE, "housing.support[0]", "either 'fixed', or 'stiffness'"),
    "no damping": ("support.0.damping", {"y": 0}, "housing.support[0].damping", "above 0 N*s/m"),
    "damping as stiffness": ("support.0.damping.y", "2 N/m", "housing.support[0].damping.y", "a damping"),
    "mount nowhere": ("mount.0.surface", GONE, "housing.mount[0]", "exactly one of 'box', 'surface' and 'plane'"),
    "mount of nothing": ("mount.1.stiffness", GONE, "housing.mount[1]", "a stiffness or a damping above 0"),
    "mount of zeros": ("mount.1.stiffness", {"x": 0}, "housing.mount[1]", "a stiffness or a damping above 0"),
    "negative": ("mount.1.stiffness.rz", "-1 N*m/rad", "housing.mount[1].stiffness.rz", "of at least 0 N*m/rad"),
    "two forms": ("mount.0.damping", {"x": "3 N*s/m"}, "housing.mount[0].damping", "the keys of 'stiffness'"),
    "mixed form": ("mount.0.stiffness.x", "1 N/m", "housing.mount[0].stiffness.x", "no such key"),
    "no axis": ("mount.0.axis", GONE, "housing.mount[0].axis", "the direction of 'axial'"),
    "null axis": ("mount.0.axis", [0, 0, 0], "housing.mount[0].axis", "a vector with a direction"),
    "axis for six": ("mount.1.axis", "x", "housing.mount[1].axis", "'axes', two directions"),
    "axes for one": ("mount.0.axes", [[1, 0, 0], [0, 1, 0]], "housing.mount[0].axes", "'axis' alone"),
    "one axis twice": ("mount.1.axes", [[1, 0, 0], [-2, 0, 0]], "housing.mount[1].axes", "at an angle to each other"),
    "mount off the box": (
        "mount.0",
        {"name": "m", "box": [["1 m"] * 3, ["2 m"] * 3], "stiffness": {"x": 1.0}},
        "housing.mount[0].box",
        "a box that meets the housing",
    ),
    "mount on no surface": ("mount.0.surface", "foot-9", "housing.mount[0].surface", "did you mean 'foot-4'?"),
    "joint to itself": ("joint.0.surfaces", ["left", "left"], "housing.joint[0].surfaces", "two different surfaces"),
    "joint to nothing": ("joint.0.surfaces.1", "rihgt", "housing.joint[0].surfaces[1]", "did you mean 'right'?"),
    "joint of two kinds": ("joint.0.diameter", "10 mm", "housing.joint[0]", "exactly one of 'surfaces'"),
    "joint of one": ("joint.0.surfaces", ["left"], "housing.joint[0].surfaces[1]", "a name or text"),
    "mass of nothing": ("mass.0.mass", "0 kg", "housing.mass[0].mass", "above 0 kg"),
    "mass nowhere": ("mass.1.position", GONE, "housing.mass[1]", "exactly one of 'position', 'box', 'surface'"),
    "mass in two places": ("mass.1.surface", "top", "housing.mass[1]", "exactly one of 'position', 'box'"),
    "point that turns": ("mass.1.offset", ["1 mm", "0 mm", "0 mm"], "housing.mass[1].offset", "does not turn a body"),
    "no such body": ("mass.0.inertia.xx", "0.2 kg*m^2", "housing.mass[0].inertia", "sum of the two others"),
    "products alone": ("mass.0.inertia", {"xy": "1 kg*m^2"}, "housing.mass[0].inertia", "that a body can have"),
    "mass in the cavity": (
        "mass.1.position",
        ["0 mm", "80 mm", "0 mm"],
        "housing.mass[1].position",
        "this one is in its cavity",
    ),
    "same name": ("mass.1.name", "motor", "housing.mass[1].name", "housing.mass[0] has this one"),
    "misspelt": ("mass.0.inertai", {}, "housing.mass[0].inertai", "did you mean 'inertia'?"),
}


@pytest.mark.parametrize("kind", ONE_WRONG)
def test_one_wrong_attachment_is_named_with_its_place(kind: str) -> None:
    path, value, key, expected = ONE_WRONG[kind]
    with pytest.raises(CaseError) as caught:
        parse_case(changed((path, value)), source="case.toml")
    lines = str(caught.value).splitlines()
    assert len(lines) == 1, lines
    assert lines[0].startswith((f"case.toml: {key}:", f"case.toml: {key} (")), lines
    assert expected in lines[0]


def test_all_that_is_wrong_comes_at_once() -> None:
    names = ("mount of zeros", "joint to nothing", "mass of nothing", "point that turns")
    with pytest.raises(CaseError) as caught:
        parse_case(changed(*(ONE_WRONG[name][:2] for name in names)))
    keys = {problem.key for problem in caught.value.problems}
    assert keys == {ONE_WRONG[name][2] for name in names}


ANYTHING = st.one_of(
    st.none(),
    st.floats(),
    st.sampled_from(["x", "top", "3 mm", "3 kg", "1 N/m", "2 N*m/rad", "1 N*s/m", "1 kg*m^2", "bush", [], {}]),
    st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3),
    st.dictionaries(st.sampled_from(["x", "rx", "axial", "tilting", "xx", "xy"]), st.floats(-1.0, 1e9), max_size=3),
)


@given(st.data())
@settings(max_examples=100, deadline=None)
def test_anything_anywhere_makes_a_case_or_a_case_error(data: st.DataObject) -> None:
    document = copy.deepcopy(BOX)
    for _ in range(data.draw(st.integers(1, 3))):
        here: Any = document["housing"][data.draw(st.sampled_from(["support", "mount", "joint", "mass"]))]
        while isinstance(here, (dict, list)) and here:
            step = data.draw(st.sampled_from(sorted(here) if isinstance(here, dict) else range(len(here))))
            if not isinstance(here[step], (dict, list)) or data.draw(st.booleans()):
                here[step] = data.draw(ANYTHING)
                break
            here = here[step]
    try:
        case = parse_case(document, source="any.toml")
    except CaseError as error:
        lines = str(error).splitlines()
    else:
        # What the case lets pass, the housing takes: no second opinion on amounts, axes and inertias.
        entries = sum(len(document["housing"][kind]) for kind in ("support", "mount", "joint", "mass"))
        assert len(build_fixtures(case.housing, case.material)) == entries
        lines = []
    assert all(": expected " in line for line in lines)


def test_the_resolved_case_loads_back_equal(tmp_path: Path) -> None:
    case = parse_case(BOX)
    (tmp_path / "case.toml").write_text(dump_case(case), encoding="utf-8")
    assert load_case(tmp_path / "case.toml").case == case


def test_check_says_what_is_fastened(capsys: pytest.CaptureFixture[str]) -> None:
    case = parse_case(BOX)
    document = check_document(case)
    rubber = document["housing"]["mounts"][0]
    assert rubber["stiffness_n_per_m"] == {"axial": 4e6, "shear": 1e6}
    assert rubber["stiffness_n_m_per_rad"] == {"tilting": 100.0}
    assert rubber["damping_n_s_per_m"] == {"axial": 300.0}
    shown_by(check.sections)(document)
    shown = capsys.readouterr().out
    assert "joint tie (left to right): axial 1e+08 N/m" in shown
    assert "masses: motor 6 kg, probe 0.12 kg" in shown
    assert warnings_of(case) == ()
    creeping = parse_case(changed(("mount", GONE)))
    assert any("dashpots alone" in warning for warning in warnings_of(creeping))
    floating = parse_case(changed(("mount", GONE), ("support", GONE)))
    assert any("floats freely" in warning for warning in warnings_of(floating))


def test_masses_and_dashpots_of_a_case_reach_its_modes() -> None:
    bare = solve_housing(parse_case(changed(("mass", GONE), ("support", GONE), ("joint", GONE))))
    full = solve_housing(parse_case(BOX))
    assert full.mass == pytest.approx(bare.mass + 6.12, rel=1e-12)
    document = modes_document(full)
    assert document["attached_mass_kg"] == pytest.approx(6.12)
    assert document["certificate"]["complete"]
    assert full.damping_matrix is not None
    ratios = [mode["damping_ratio"] for mode in document["modes"]]
    elastic = full.modes.frequencies > 0.0
    expected = 0.01 + full.damping_matrix.diagonal()[elastic] / (2 * full.modes.frequencies[elastic])
    np.testing.assert_allclose(np.array(ratios)[elastic], expected, rtol=1e-12)
    undamped = solve_housing(parse_case(changed(("mount.0.damping", GONE), ("support", GONE))))
    assert undamped.damping_matrix is None
    np.testing.assert_allclose(undamped.modes.frequencies[:6], full.modes.frequencies[:6], rtol=1e-9)


def test_damping_ratios_of_more_modes_than_there_are_are_warned_of() -> None:
    """A free box below 500 Hz has its six rigid motions."""
    steel = {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}
    box = {"size": ["300 mm", "250 mm", "200 mm"], "wall": "10 mm", "mesh_size": "80 mm"}

    def solved(count: int) -> Any:
        ratios = [0.01 * number for number in range(1, 1 + count)]
        table = {"material": "steel", "frequency_limit": "500 Hz", "box": box, "damping_ratio": ratios}
        return solve_housing(parse_case({"material": {"steel": steel}, "housing": table}))

    longer = solved(8)
    (found,) = (warning for warning in longer.result_warnings if warning["name"] == "damping")
    assert "lists 8 ratios for 6 modes: the first 6 are taken in order" in found["message"]
    assert longer.damping_ratios.tolist() == pytest.approx([0.01, 0.02, 0.03, 0.04, 0.05, 0.06])
    assert not [warning for warning in solved(6).result_warnings if warning["name"] == "damping"]
    with pytest.raises(
        CaseError, match=r"damping_ratio: expected a ratio for each of the 6 modes found, got '5 ratios'"
    ):
        solved(5)


@pytest.fixture(scope="module")
def two_parts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A mesh file of two separate hollow boxes, the second 5 mm above the first; facing surfaces lower and upper."""
    one = mesh_box(BoxGeometry((0.1, 0.08, 0.12), WallThickness.uniform(0.03)), 0.05)
    n = len(one.points)
    shifted = one.points + [0.0, 0.085, 0.0]
    cells, bottom, top = (part[0].nodes for part in (one.blocks, one.surface("bottom"), one.surface("top")))
    surfaces = {"lower": top, "upper": bottom + n, "base": bottom}
    mesh = Mesh.of_tetrahedra(np.vstack([one.points, shifted]), np.vstack([cells, cells + n]), surfaces)
    path = tmp_path_factory.mktemp("mesh") / "parts.msh"
    write_mesh(mesh, path)
    return path


def _of_parts(path: Path, **housing: Any) -> dict[str, Any]:
    joint = {
        "name": "bolt",
        "surfaces": ["lower", "upper"],
        "axis": "y",
        "stiffness": {"axial": "1e8 N/m", "shear": "5e7 N/m", "tilting": "1e5 N*m/rad", "torsional": "1e5 N*m/rad"},
    }
    table = {"material": "steel", "modes": 12, "mesh": {"file": str(path)}, "joint": [joint]} | housing
    return {"material": {"steel": STEEL}, "housing": table}


def test_a_joint_makes_one_housing_of_two_parts_of_a_mesh_file(two_parts: Path) -> None:
    modes = solve_housing(parse_case(_of_parts(two_parts))).modes
    assert modes.certificate.complete
    assert np.count_nonzero(modes.frequencies == 0.0) == 6
    assert modes.frequencies[6] > 100.0


def test_what_does_not_fit_the_mesh_file_is_told_all_at_once(two_parts: Path) -> None:
    housing = {
        "support": [
            {"name": "s", "surface": "bse", "fixed": ["x"]},
            {"name": "t", "box": [["1 m"] * 3, ["2 m"] * 3], "fixed": ["y"]},
        ],
        "mount": [{"name": "m", "surface": "uper", "stiffness": {"x": "1 N/m"}}],
        "mass": [{"name": "p", "mass": "1 kg", "position": ["1 m", "0 m", "0 m"]}],
    }
    with pytest.raises(CaseError) as caught:
        solve_housing(parse_case(_of_parts(two_parts, **housing)))
    found = {problem.key: problem.message for problem in caught.value.problems}
    assert "did you mean 'base'?" in found["housing.support[0].surface"]
    assert "no facet of the surface lies in the box" in found["housing.support[1].box"]
    assert "did you mean 'upper'?" in found["housing.mount[0].surface"]
    assert "within" in found["housing.mass[0].position"]
    assert len(found) == 4


def test_too_fine_a_patch_is_told_by_its_entry(tmp_path: Path) -> None:
    """A slab of 45 x 45 cells, six tetrahedra each: 2116 nodes on its upper face."""
    n, thickness = 45, 0.02
    x, y, z = np.meshgrid(np.arange(n + 1), np.arange(n + 1), np.arange(2), indexing="ij")
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3) * [0.01, 0.01, thickness]
    node = np.arange(len(points)).reshape(n + 1, n + 1, 2)
    corner = {(i, j, k): node[i : n + i, j : n + j, k].ravel() for i in (0, 1) for j in (0, 1) for k in (0, 1)}
    # Kuhn's six: from the first corner to the last, one step along each axis in every order.
    tetrahedra = []
    for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
        steps = [(0, 0, 0)]
        for axis in order:
            step = list(steps[-1])
            step[axis] = 1
            steps.append((step[0], step[1], step[2]))
        if order in ((0, 2, 1), (2, 1, 0), (1, 0, 2)):
            steps[1], steps[2] = steps[2], steps[1]
        tetrahedra.append(np.stack([corner[step] for step in steps], axis=1))
    mesh = Mesh.of_tetrahedra(points, np.concatenate(tetrahedra))
    boundary = mesh.boundary[0].nodes
    top = boundary[(points[boundary, 2] == thickness).all(axis=1)]
    write_mesh(Mesh.of_tetrahedra(points, np.concatenate(tetrahedra), {"top": top}), tmp_path / "slab.msh")
    mount = {"name": "m", "surface": "top", "stiffness": {"x": "1 N/m"}}
    housing = {"joint": [], "mount": [mount]}
    with pytest.raises(CaseError, match=r'mount "m"\): expected what fits the mesh; .* ties 2116 nodes'):
        solve_housing(parse_case(_of_parts(tmp_path / "slab.msh", **housing)))
