"""Gradients of a case's operating point by its housing, against equilibria of housings that are solved anew."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from case_housings import mesh_of

import gearwhine as gw
from gearwhine.case import Case, UpdateParameter, case_document, load_case, parse_case
from gearwhine.case.box import FACES
from gearwhine.case.model import housing_table
from gearwhine.coupling.load_analysis.housing_fields import housing_fields
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.coupling.statics.sensitivity import OUTCOMES, pair_adjoints
from gearwhine.from_case.given_housing import given_housing
from gearwhine.from_case.machine import describe_machine
from gearwhine.from_case.parametric_housing import FittedCase, MeshedParameters, fitted_case, geometry_of
from gearwhine.housing import HousingModes
from gearwhine.housing.updating.housing_change import by_changes, face_changes
from gearwhine.housing.updating.static_sensitivity import StaticSensitivity
from gearwhine.meshes import Mesh
from gearwhine.results.operating_point import sections
from gearwhine.solve import housing_modes
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import reduce_housing
from gearwhine.solve.sensitivity.housing_changes import (
    case_changes,
    housing_parameters,
)

KEYS = ("misalignment_rad", "k_h_beta", "transmission_error_peak_to_peak_m")
PARAMETERS = [
    UpdateParameter(name="front wall", keys=("housing.box.wall.front",), range=("5 mm", "20 mm")),
    UpdateParameter(name="bottom wall", keys=("housing.box.wall.bottom",), range=("5 mm", "20 mm")),
    UpdateParameter(name="bosses", keys=("housing.seat.*.boss.diameter",), range=("60 mm", "80 mm")),
    UpdateParameter(
        name="length", keys=("housing.box.size[2]", "housing.seat.*.center[2]"), range=(0.9, 1.1), factor=True
    ),
    UpdateParameter(name="feet", keys=("housing.support.*.stiffness.y",), range=(0.5, 2.0), factor=True),
    UpdateParameter(name="modulus", keys=("material.iron.youngs_modulus",), range=("90 GPa", "130 GPa")),
]


@pytest.fixture(scope="module")
def case() -> Case:
    """The small gearbox with bosses, its gears out of the middle, and softer feet on one side."""
    overrides = ["housing.box.mesh_size=60 mm", "gear.*.at=70 mm", "housing.frequency_limit=1.6 kHz"]
    document = case_document(load_case("small-gearbox", overrides).case)
    for seat in document["housing"]["seat"]:
        seat["boss"] = {"diameter": "70 mm", "length": "20 mm"}
    document["material"]["iron"] = {"youngs_modulus": "110 GPa", "poisson_ratio": 0.25, "density": "7200 kg/m^3"}
    document["housing"]["material"] = "iron"
    document["housing"]["support"][0]["stiffness"]["y"] = 2e9
    return parse_case(document)


@pytest.fixture(scope="module")
def fitted(case: Case) -> FittedCase:
    return fitted_case(case, parameters=PARAMETERS)


Solve = Callable[[Case, Mesh], tuple[HousingModes, OperatingPoint]]


@pytest.fixture(scope="module")
def solve() -> Solve:
    def solved(case: Case, mesh: Mesh) -> tuple[HousingModes, OperatingPoint]:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(housing_modes, "build_mesh", lambda *_: mesh)
            housing = solve_housing(case)
        return housing, describe_machine(case, reduce_housing(case, housing)).operating_point()

    return solved


@pytest.fixture(scope="module")
def fields(case: Case, solve: Solve) -> StaticSensitivity:
    housing, point = solve(case, mesh_of(case))
    (pair,) = pair_adjoints(point)
    return housing_fields(housing, point, list(pair.values()))


@pytest.mark.slow
def test_numbers_of_the_housing(case: Case, fitted: FittedCase, fields: StaticSensitivity, solve: Solve) -> None:
    """Walls, bosses, a length with its seats, springs and a modulus together, along a direction: to 1e-5."""
    own = by_changes(fields, case_changes(case, fields.mesh, PARAMETERS))
    meshed = MeshedParameters(fitted, fitted.start, given_housing(case), fields.mesh)
    values = np.array([number.start for number in fitted.numbers])
    way = values * np.random.default_rng(1).normal(size=len(values))
    either = []
    for step in (3e-4, -3e-4):
        there = fitted.at((values + step * way).tolist())
        geometry = geometry_of(housing_table(there, "update"))
        assert geometry is not None
        (pair,) = solve(there, meshed.morph.moved(geometry))[1].pairs
        either.append([pair.misalignment, pair.k_h_beta, np.ptp(pair.transmission_error)])
    expected = (np.array(either[0]) - either[1]) / 6e-4
    error = np.abs(own @ way - expected) / np.abs(own * way).max(axis=1)
    # A misaligned spur gear keeps its transmission error while all of its face carries.
    assert (error[:2] < 1e-5).all()
    assert abs(own[2] @ way) < 1e-13
    assert abs(expected[2]) < 1e-13


@pytest.mark.slow
def test_the_weight_of_the_housing(case: Case, solve: Solve) -> None:
    """Its density, by which weight alone acts, to 1e-6."""
    document = case_document(case)
    document["operation"]["gravity"] = [3.0, -9.81, 0.0]
    density = [UpdateParameter(name="density", keys=("material.iron.density",), range=("6000 kg/m^3", "8000 kg/m^3"))]
    fitted = fitted_case(parse_case(document), parameters=density)
    mesh = mesh_of(case)
    lighter, heavy, heavier = (solve(fitted.at([value]), mesh) for value in (7100.0, 7200.0, 7300.0))
    (pair,) = pair_adjoints(heavy[1])
    weighed = parse_case(document)
    fields = housing_fields(heavy[0], heavy[1], [pair["misalignment"]])
    own = by_changes(fields, case_changes(weighed, mesh, density))[0, 0]
    either = [point.pairs[0].misalignment for _, point in (heavier, lighter)]
    assert own == pytest.approx((either[0] - either[1]) / 200.0, rel=1e-6)


def test_material_on_a_face_is_a_thicker_wall(case: Case, fields: StaticSensitivity) -> None:
    """Of the bottom's inner face, against the wall's thickness, by which all nodes of the mesh move."""
    seats = [seat.name for seat in case.housing.seat] if case.housing is not None else []
    changes = face_changes(fields.mesh, seats)
    faces = dict(zip([change.parameter for change in changes], by_changes(fields, changes).T, strict=True))
    own = faces["inside of bottom at 0, 10, 0 mm"]
    wall = by_changes(fields, case_changes(case, fields.mesh, PARAMETERS[1:2]))
    np.testing.assert_allclose(own[:2], wall[:2, 0], rtol=0.05)
    # Outer faces have the names of the box's own surfaces, inner ones those of the walls too.
    inner = {name for name in faces if " at " in name}
    walls = {"left", "right", "bottom", "top", "back", "front"}
    assert {name.removeprefix("inside of ").partition(" at ")[0] for name in inner} == walls
    assert set(faces) - inner <= set(fields.mesh.surfaces)


def test_the_density_of_even_strains(fields: StaticSensitivity) -> None:
    """Linear fields u = A x and λ = B x have the density -σ(A) : ε(B) everywhere, with gravity ρ g · λ."""
    gradient, other = np.random.default_rng(2).normal(size=(2, 3, 3))
    points, gravity = fields.mesh.points, np.array([1.0, -9.81, 0.5])
    linear = replace(fields, displacement=points @ gradient.T, adjoint=(points @ other.T)[None], gravity=gravity)
    lam, mu, density = fields.constants[:, 0]
    strain, against = 0.5 * (gradient + gradient.T), 0.5 * (other + other.T)
    stress = lam * np.trace(strain) * np.eye(3) + 2.0 * mu * strain
    expected = density * points @ other.T @ gravity - np.sum(stress * against)
    np.testing.assert_allclose(linear.surface_density()[0], expected, rtol=1e-9)


def test_the_document_ranks_what_changes_the_pair_most() -> None:
    """Rigid seats: bearings alone, by the library's derivatives and the steps of the table."""
    result = gw.load("helical-pair").operating_point(sensitivity=True)
    rows = result.document["sensitivity"]
    (pair,) = pair_adjoints(result.solved.point)
    found = {(row["parameter"], row["kind"]): row["gear_pairs"][0] for row in rows}
    for bearing in result.document["bearings"]:
        name = bearing["name"]
        for outcome, key in zip(OUTCOMES, KEYS, strict=True):
            expected = 0.1 * pair[outcome].by_bearing_stiffness(name)
            assert found[name, "bearing stiffness"][key] == pytest.approx(expected)
            expected = 1e-3 * pair[outcome].by_bearing_position(name)
            assert found[name, "bearing position"][key] == pytest.approx(expected)
    changes = [abs(row["gear_pairs"][0]["misalignment_rad"]) for row in rows]
    assert changes == sorted(changes, reverse=True)
    assert {row["step"] for row in rows} == {"+10 %", "+1 mm"}
    data = result.dataset["misalignment_change"]
    assert (data.dims, data.attrs["units"]) == (("influence", "loaded_pair"), "rad")
    np.testing.assert_allclose(np.abs(data.values[:, 0]), changes)
    (section,) = sections(result.document)
    (table,) = [one for one in section.tables if one.caption.startswith("Change by a step")]
    assert len(table.rows) == min(len(rows), 10)
    assert "sensitivity" not in gw.load("helical-pair").operating_point().document


def test_walls_of_a_box_and_parameters_of_a_fit() -> None:
    box = housing_table(load_case("small-gearbox").case, "load").box
    assert [one.name for one in housing_parameters(None, box)] == [f"{face} wall" for face in FACES]
    fit = load_case("nasa-gear-noise-rig-nominal").case
    assert fit.update is not None
    assert housing_parameters(fit.update, box) == fit.update.parameter
    assert housing_parameters(None, None) == ()


@pytest.mark.slow
def test_a_box_that_cannot_follow_its_walls_has_faces() -> None:
    changes = {"housing.box.mesh_size": "60 mm", "housing.box.fillets": {"inside": "8 mm"}}
    result = gw.load("small-gearbox", changes).operating_point(sensitivity=True)
    kinds = {row["kind"] for row in result.document["sensitivity"]}
    assert kinds == {"face", "bearing stiffness", "bearing position"}
    assert any("flat faces stand in their place" in message for message in result.warnings)
