"""Rates of a whole case by its fitted numbers, against differences of solved designs."""

from typing import Any

import numpy as np
import pytest

from gearwhine.case import case_document, load_case, parse_case
from gearwhine.from_case.mesh import build_mesh, materials_of
from gearwhine.from_case.parametric_housing import ParametricHousing, _followed, fitted_case
from gearwhine.housing import HousingError, assemble
from gearwhine.housing.updating.parameters import coordinate_bounds, values_at

NUMBERS: list[tuple[list[str], list[Any], Any]] = [
    (["housing.box.wall.top"], ["6 mm", "20 mm"], "3 mm"),
    (["housing.seat.*.boss.diameter"], ["60 mm", "90 mm"], "5 mm"),
    (["housing.box.feet.size[1]"], ["10 mm", "40 mm"], "4 mm"),
    (["housing.box.size[2]", "housing.seat.*.center[2]"], [0.9, 1.1], 0.02),
    (["housing.support.*.stiffness.y"], ["1e8 N/m", "1e10 N/m"], "5e8 N/m"),
    (["housing.mass.cover.mass"], ["0.5 kg", "4 kg"], "0.5 kg"),
    (["material.steel.youngs_modulus"], ["190 GPa", "220 GPa"], "5 GPa"),
    (["material.steel.poisson_ratio"], [0.2, 0.4], 0.02),
    (["material.iron.density"], ["7000 kg/m^3", "7500 kg/m^3"], "100 kg/m^3"),
]


@pytest.fixture(scope="module")
def designs() -> ParametricHousing:
    document = case_document(load_case("steel-box", ["housing.box.mesh_size=50 mm"]).case)
    document["housing"]["support"] = [
        {"name": f"mount {n}", "surface": f"foot-{n}", "stiffness": {"x": 3e8, "y": 1e9, "z": 4e8}} for n in range(1, 5)
    ]
    document["housing"]["mass"] = [{"name": "cover", "mass": "2 kg", "surface": "top", "offset": [0.0, 0.02, 0.01]}]
    document["material"]["iron"] = {"youngs_modulus": "110 GPa", "poisson_ratio": 0.25, "density": "7200 kg/m^3"}
    document["housing"]["region"] = [
        {"name": "left half", "box": [["-1 m", "-1 m", "-1 m"], ["0 m", "1 m", "1 m"]], "material": "iron"}
    ]
    document["measured"] = {"frequencies": ["700 Hz"]}
    document["update"] = {
        "modes": 20,
        "parameter": [
            {"name": f"p{place}", "keys": keys, "range": span, "spread": spread, "factor": len(keys) > 1}
            for place, (keys, span, spread) in enumerate(NUMBERS)
        ],
    }
    case = parse_case(document)
    assert case.update is not None
    return ParametricHousing(fitted_case(case), case.update.modes, threads=1)


@pytest.mark.slow
def test_slopes_of_all_numbers_together_are_those_of_solved_designs(designs: ParametricHousing) -> None:
    """Geometry, springs, a mass, moduli and a density at once, along two directions: to 1e-6 of the largest."""
    start = designs.solve(designs.start)
    slopes = start.surrogate().at(start.coordinates).slopes
    for seed in range(2):
        way = np.random.default_rng(seed).normal(size=len(NUMBERS))
        way /= np.linalg.norm(way)
        quotients = []
        for step in (0.02, 0.01):
            either = [designs.solve(start.coordinates + sign * step * way, start) for sign in (1.0, -1.0)]
            assert all(np.array_equal(one.mesh.blocks[0].nodes, start.mesh.blocks[0].nodes) for one in either)
            frequencies = [np.log(one.state.frequencies[:12]) for one in either]
            quotients.append((frequencies[0] - frequencies[1]) / (2.0 * step))
        expected = (4.0 * quotients[1] - quotients[0]) / 3.0
        assert np.abs(way @ slopes[:, :12] - expected).max() < 1e-6 * np.abs(slopes).max()


@pytest.mark.slow
def test_a_light_design_is_the_same_without_its_shapes(designs: ParametricHousing) -> None:
    start = designs.solve(designs.start)
    light = start.light()
    assert light.shapes is None
    assert np.array_equal(light.surrogate().rates, start.surrogate().rates)
    assert np.array_equal(light.state.skin, start.state.skin)
    near = start.coordinates + 0.1
    assert np.array_equal(designs.solve(near, light).mesh.points, designs.solve(near, start).mesh.points)
    assert light.light().surrogate() is light.surrogate()


def test_where_the_neighbours_mesh_would_fold_a_new_one_is_made(designs: ParametricHousing) -> None:
    start = designs.solve(designs.start)
    narrow = designs.start.copy()
    narrow[1] = coordinate_bounds(designs.parameters)[0, 1]
    given = designs.housing_at(narrow)
    followed = _followed(start, given.table)
    assert followed is not None
    with pytest.raises(HousingError, match="folded"):
        assemble(*materials_of(given.table, given.materials, followed))
    afresh = build_mesh(given.table, given.materials, given.files)
    assert np.array_equal(designs.solve(narrow, start).mesh.points, afresh.points)


def test_a_design_that_is_no_sound_housing_is_said(designs: ParametricHousing) -> None:
    wide = designs.start.copy()
    wide[1] = 100.0  # as wide a boss as its range allows is still sound
    assert designs.housing_at(wide).table.box is not None
    broken = ParametricHousing(designs.case, 10_000)
    with pytest.raises(HousingError):
        broken.solve(designs.start)


@pytest.mark.parametrize("bolts", [None, "bolt"])
def test_bolts_of_a_cover_change_with_their_material(bolts: str | None) -> None:
    """Bolts of the housing's own material: f grows as √E whatever the shape. Of another one: as solved designs do."""
    steel = {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7800 kg/m^3"}
    cover: dict[str, Any] = {"diameter": "4 mm", "patch_diameter": "9 mm", "per_edge": [2, 2], "material": bolts}
    if bolts is None:
        del cover["material"]
    box = {
        "size": ["300 mm", "200 mm", "250 mm"],
        "wall": "10 mm",
        "mesh_size": "80 mm",
        "cover": {"face": "top", "bolts": cover},
    }
    key = f"material.{bolts or 'steel'}.youngs_modulus"
    case = parse_case(
        {
            "material": {"steel": steel, "bolt": {**steel, "youngs_modulus": "150 GPa"}},
            "housing": {"material": "steel", "modes": 8, "box": box},
            "measured": {"frequencies": ["300 Hz"]},
            "update": {"parameter": [{"name": "E", "keys": [key], "range": ["50 GPa", "300 GPa"]}]},
        }
    )
    designs = ParametricHousing(fitted_case(case), 12, draft=True, threads=1)
    start = designs.solve(designs.start)
    slopes = start.surrogate().at(start.coordinates).slopes[0]
    step = 0.01
    beside = [designs.solve(designs.start + way * step, start) for way in (1.0, -1.0)]
    if bolts is None:
        (above,), (below,) = (values_at(designs.parameters, other.coordinates) for other in beside)
        np.testing.assert_allclose(slopes, np.log(above / below) / (4.0 * step), rtol=1e-3)
    else:
        elastic = [np.log(other.state.frequencies) for other in beside]
        quotients = (elastic[0] - elastic[1]) / (2.0 * step)
        np.testing.assert_allclose(slopes, quotients, rtol=2e-2)
        assert quotients.max() > 5e-4
