"""Gradients of the sound power of mesh harmonics, against that of machines whose housing is moved and solved anew."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from case_housings import mesh_of
from kept_mesh_stiffness import without_stiffness

import gearwhine as gw
from gearwhine.case import Case, CaseError, UpdateParameter, case_document, load_case, parse_case
from gearwhine.case.model import housing_table
from gearwhine.coupling.linear.housing_rates import HousingRates
from gearwhine.coupling.linear.line_sensitivity import LineModel
from gearwhine.coupling.load_analysis.housing_fields import housing_fields
from gearwhine.coupling.load_analysis.influences import LineChange
from gearwhine.coupling.load_analysis.line_model import SolvedLines, solve_lines
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.sound import solution
from gearwhine.coupling.sound.mesh_harmonics import HarmonicSound
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.coupling.statics.sensitivity import adjoint
from gearwhine.from_case.given_housing import given_housing
from gearwhine.from_case.machine import describe_machine
from gearwhine.from_case.parametric_housing import MeshedParameters, fitted_case, geometry_of
from gearwhine.housing import HousingModes
from gearwhine.housing.acoustics.radiation import HousingRadiation
from gearwhine.housing.acoustics.sound_levels import a_weighting
from gearwhine.housing.updating.housing_change import by_changes, slopes_of
from gearwhine.meshes import Mesh
from gearwhine.meshes.shape_functions import shape_functions
from gearwhine.numerics.arrays import FloatArray
from gearwhine.output.sections import Table
from gearwhine.results.operating_point import sections
from gearwhine.solve import housing_modes
from gearwhine.solve.acoustics import acoustics_of
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import reduce_housing
from gearwhine.solve.sensitivity.housing_changes import case_changes

PARAMETERS = [
    UpdateParameter(name="front wall", keys=("housing.box.wall.front",), range=("5 mm", "20 mm")),
    UpdateParameter(name="bottom wall", keys=("housing.box.wall.bottom",), range=("5 mm", "20 mm")),
    UpdateParameter(name="top wall", keys=("housing.box.wall.top",), range=("5 mm", "20 mm")),
    UpdateParameter(name="feet", keys=("housing.support.*.stiffness.y",), range=(0.5, 2.0), factor=True),
]

Solved = tuple[HousingModes, OperatingPoint, SolvedLines]


def sounding(acoustics: dict[str, object]) -> Case:
    """The small gearbox without sensors, its gears out of the middle; its modes reach up to 8 kHz."""
    overrides = ["housing.box.mesh_size=60 mm", "gear.*.at=70 mm", "housing.frequency_limit=8 kHz"]
    document = case_document(load_case("small-gearbox", overrides).case)
    document["material"]["iron"] = {"youngs_modulus": "110 GPa", "poisson_ratio": 0.25, "density": "7200 kg/m^3"}
    document["housing"]["material"] = "iron"
    document["housing"]["support"][0]["stiffness"]["y"] = 2e9
    document["housing"]["sensor"] = []
    document["acoustics"] = acoustics
    return parse_case(document)


def solve_at_rest(case: Case, mesh: Mesh) -> tuple[HousingModes, Machine, OperatingPoint]:
    """Solve a case anew on a mesh as far as it is the same for all sounds: modes, machine and equilibrium."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(housing_modes, "build_mesh", lambda *_: mesh)
        housing = solve_housing(case)
    machine = describe_machine(case, reduce_housing(case, housing))
    return housing, machine, machine.operating_point()


def solve_sound(
    case: Case,
    at_rest: tuple[HousingModes, Machine, OperatingPoint],
    base: HousingRadiation | None = None,
) -> Solved:
    """Solve the lines of a case, its radiating surface anew, or as one whose points keep their facets."""
    housing, machine, point = at_rest
    with pytest.MonkeyPatch.context() as patch:
        if base is not None:
            patch.setattr(solution, "build_radiation", lambda *_: on_same_facets(base, housing.mesh))
        lines = solve_lines(machine, point, housing, acoustics_of(case))
    assert lines is not None
    return housing, point, lines


def on_same_facets(radiation: HousingRadiation, mesh: Mesh) -> HousingRadiation:
    """The radiating surface, with its points where they are in space, in the same triangles of a moved mesh.

    The choice of the nearest facet jumps at a few points as the mesh moves, beside holes, by 1e-4 of the power.
    """
    kinds = {block.nodes.shape[1]: block.kind for block in mesh.boundary}
    skins = []
    for skin in radiation.skins:
        groups = []
        for group in skin.groups:
            places = np.einsum("mc,mci->mi", group.shares, skin.places[group.corners])
            first, *others = np.moveaxis(mesh.points[group.corners], 1, 0)
            edges = np.stack([one - first for one in others], axis=2)
            two = np.einsum("mki,mi->mk", np.linalg.pinv(edges), places - first)
            shares = np.column_stack([1.0 - two.sum(axis=1), two])
            reference = np.einsum("mc,mci->im", shares, group.reference)
            shape, gradients = shape_functions(kinds[group.nodes.shape[1]], reference)
            groups.append(replace(group, shape=shape, gradients=gradients, shares=shares))
        skins.append(replace(skin, places=mesh.points, groups=tuple(groups)))
    return replace(radiation, skins=tuple(skins))


def sound_lines(solved: Solved) -> list[HarmonicSound]:
    return sorted(solved[2].sound, key=lambda one: one.line.frequency)


def derivatives(case: Case, solved: Solved, model: LineModel) -> tuple[FloatArray, HousingRates, FloatArray]:
    """Derivatives of the lines by the parameters, shape (n_lines, n_parameters), of the housing, and their slopes."""
    housing, point, found = solved
    lines = [one.line for one in sound_lines(solved)]
    fields = housing_fields(housing, point, [adjoint(point, model.by_static(one)) for one in lines])
    changes = case_changes(case, housing.mesh, PARAMETERS)
    rates, slopes = found.rates(fields, changes), slopes_of(changes)
    own = by_changes(fields, changes) + np.array([found.model.by_housing(one, rates) for one in lines]) / slopes
    return own, rates, slopes


CHAINS = {
    "erp": ({"method": "erp", "mesh_size": "30 mm", "highest_frequency": "6 kHz"}, 1e-5),
    "boundary elements": ({"mesh_size": "30 mm", "highest_frequency": "3 kHz"}, 1e-3),
}
"""Acoustics, and error relative to the sum of the parts.

The gradient by the modes' resistance is exact, so that of the equivalent power is; where the mesh slides along the
surface, reciprocity of the integrals takes part.
"""


class Beside(NamedTuple):
    """A case without a sound at a part of the way by all parameters, and what is the same of it for all sounds."""

    case: Case
    at_rest: tuple[HousingModes, Machine, OperatingPoint]


@pytest.fixture(scope="module")
def way() -> tuple[float, FloatArray, list[Beside]]:
    """A step, all parameters' parts of the way, and the case as it is, a step ahead and a step back."""
    case = sounding(CHAINS["erp"][0])
    mesh = mesh_of(case)
    fitted = fitted_case(case, parameters=PARAMETERS)
    meshed = MeshedParameters(fitted, fitted.start, given_housing(case), mesh)
    values = np.array([number.start for number in fitted.numbers])
    way = values * np.random.default_rng(1).normal(size=len(values))
    # So short that the curvature adds a part of 1e-6; modes to 1e-10 and better leave as much.
    step = 1e-4
    cases = [Beside(case, solve_at_rest(case, mesh))]
    for size in (step, -step):
        there = fitted.at((values + size * way).tolist())
        geometry = geometry_of(housing_table(there, "update"))
        assert geometry is not None
        cases.append(Beside(there, solve_at_rest(there, meshed.morph.moved(geometry))))
    return step, way, cases


def with_acoustics(case: Case, acoustics: dict[str, object]) -> Case:
    return parse_case(case_document(case) | {"acoustics": acoustics})


@pytest.mark.slow
@pytest.mark.parametrize("chain", CHAINS)
def test_the_whole_chain_by_the_housing(chain: str, way: tuple[float, FloatArray, list[Beside]]) -> None:
    """Walls and feet together: differences of mesh, modes, equilibrium, assembly, line and sound.

    The mean mesh stiffness, which moves in steps, is constant over this one, as no slice of a face comes into touch.
    Its mean slope, which the derivatives have, is a part of 5e-5 here.
    """
    acoustics, bound = CHAINS[chain]
    step, along, (here, *beside) = way
    case = with_acoustics(here.case, acoustics)
    solved = solve_sound(case, here.at_rest)
    model = solved[2].model
    lines, (own, rates, slopes) = sound_lines(solved), derivatives(case, solved, model)
    kept, _, _ = derivatives(case, solved, without_stiffness(model))
    assert len(lines) == (2 if chain == "erp" else 1)
    base = lines[0].power.radiation
    either = []
    for one in beside:
        moved = solve_sound(with_acoustics(one.case, acoustics), one.at_rest, base)
        either.append(np.array([found.line.value for found in sound_lines(moved)]))
    expected = (either[0] - either[1]) / (2.0 * step)
    parts = np.abs(own * along).sum(axis=1)
    assert (np.abs(kept @ along - expected) < bound * parts).all()
    assert (np.abs((own - kept) @ along) < 1e-4 * parts).all()
    # Each line answers to a step as its slope says, and to a bearing that is stiffer.
    for one, slope in zip(lines, own[:, 1] * slopes[1], strict=True):
        small = 1e-7 / slopes[1]
        assert model.stepped_housing(one.line, rates, 1, small) == pytest.approx(small * slope, rel=1e-3)
        name = case.bearing[0].name
        stiffer = model.stepped_bearing_stiffness(one.line, name, 1e-6)
        assert stiffer == pytest.approx(1e-6 * model.by_bearing_stiffness(one.line, name), rel=1e-3)


SOUNDING = {
    "housing.box.mesh_size": "60 mm",
    "housing.frequency_limit": "8 kHz",
    "acoustics.method": "erp",
    "acoustics.mesh_size": "40 mm",
    "acoustics.highest_frequency": "6 kHz",
}


@pytest.fixture(scope="module")
def study(lines_solved_once: None) -> gw.CaseStudy:
    """The gearbox with a quick sound, whose housing is solved once."""
    return gw.load("small-gearbox", SOUNDING)


@pytest.mark.slow
def test_the_document_ranks_by_the_sound(study: gw.CaseStudy) -> None:
    result = study.operating_point(sensitivity=True)
    loudest = result.document["loudest_lines"]
    assert [one["excitation"] for one in loudest] == ["2× pinion -> wheel", "1× pinion -> wheel"]
    # The steady motion follows the whole law of the teeth, whose stiffness varies by a third here.
    steady = {one["name"]: one["sound_power_db"] for one in study.sound().document["lines"]}
    assert loudest[1]["sound_power_db"] == pytest.approx(steady["1× pinion -> wheel"], abs=1.0)
    for one in loudest:
        weight = float(a_weighting(one["frequency_hz"]))
        assert one["sound_power_db_a"] == pytest.approx(one["sound_power_db"] + weight)
        assert one["ranked"]
    powers = np.array([1e-12 * 10.0 ** (0.1 * one["sound_power_db"]) for one in loudest])
    weighted = np.array([10.0 ** (0.1 * (one["sound_power_db_a"] - one["sound_power_db"])) for one in loudest])
    total = float(weighted @ powers)
    assert result.document["loudest_lines_db_a"] == pytest.approx(10.0 * np.log10(total / 1e-12))
    levels = {}
    for row in result.document["sensitivity"]:
        change = np.array([one["power_w"] for one in row["sound"]])
        first = np.array([one["first_order_w"] for one in row["sound"]])
        own = [one["level_db"] for one in row["sound"]]
        assert own == pytest.approx(list(10.0 * np.log10(1.0 + change / powers)))
        back = np.array([one["reverse_power_w"] for one in row["sound"]])
        own = [one["reverse_level_db"] for one in row["sound"]]
        assert own == pytest.approx(list(10.0 * np.log10(1.0 + back / powers)))
        # Half the difference of both steps has no even part: for a short step it is the slope.
        if row["kind"] == "bearing position":
            assert 0.5 * (change - back) == pytest.approx(first, rel=0.02, abs=1e-3 * total)
        assert row["sound_a"]["reverse_level_db"] == pytest.approx(10.0 * np.log10(1.0 + weighted @ back / total))
        for one in (*row["sound"], row["sound_a"]):
            apart = [one["level_db"] - one["first_order_db"], one["reverse_level_db"] + one["first_order_db"]]
            turned = [one["level_db"] * one["first_order_db"], -one["reverse_level_db"] * one["first_order_db"]]
            off = [abs(a) > 1.0 or (b < 0.0 and abs(a) > 0.3) for a, b in zip(apart, turned, strict=True)]
            assert one["first_order_is_off"] is any(off)
        assert row["sound_a"]["level_db"] == pytest.approx(10.0 * np.log10(1.0 + weighted @ change / total))
        expected = 10.0 / np.log(10.0) * (weighted @ first) / total
        assert row["sound_a"]["first_order_db"] == pytest.approx(expected)
        both = row["sound_a"]["level_db"], row["sound_a"]["reverse_level_db"]
        levels[row["parameter"], row["kind"]] = max(map(abs, both))
    (section,) = sections(result.document)
    tables = [one for one in section.tables if "A-weighted sound power of 2 lines together" in one.caption]
    assert len(tables) == 2
    for table in tables:
        shown = [levels[row["parameter"], row["kind"]] for row in table.rows]
        assert shown == sorted(shown, reverse=True)
    words = {row["kind"]: (row["step_words"], row["reverse_words"]) for row in result.document["sensitivity"]}
    assert words == {
        "housing": ("1 mm thicker", "1 mm thinner"),
        "bearing stiffness": ("10 % stiffer", "10 % softer"),
        "bearing position": ("1 mm to +z", "1 mm to -z"),
    }
    marked = [row["first order\n[dB]"].endswith(" (off)") for table in tables for row in shown_rows(table)]
    assert marked == [row["first_order_is_off"] for table in tables for row in table.rows]
    assert any("(off): the level" in sentence for sentence in section.sentences) is any(marked)
    data = result.dataset["loudest_line_power_change"]
    assert (data.dims, data.attrs["units"]) == (("influence", "loudest_line"), "W")
    assert data.values[-1] == pytest.approx([one["power_w"] for one in result.document["sensitivity"][-1]["sound"]])


def test_a_wall_thinner_than_the_step_has_no_reverse() -> None:
    change = LineChange(2.0, 10.0, 0.1, 0.2, np.nan)
    assert change.reverse_level is None
    assert not change.first_order_is_off
    assert LineChange(2.0, 10.0, 0.1, 0.2, -0.2).reverse_level == pytest.approx(10.0 * np.log10(0.9))


def shown_rows(table: Table) -> list[dict[str, str]]:
    """Rows of a table by the headings of its columns."""
    columns = {column.heading: column for column in table.columns}
    return [{heading: column.text(row) for heading, column in columns.items()} for row in table.rows]


@pytest.mark.slow
def test_a_wall_by_either_step_is_near_what_solving_all_anew_finds() -> None:
    """The back wall by 1 mm: mesh, modes, equilibrium, lines and sound of the changed case.

    At a speed whose mesh line meets a mode of larger elements, so that either step counts for decibels.
    """
    changes = {"acoustics.method": "erp", "acoustics.mesh_size": "30 mm", "housing.box.mesh_size": "45 mm"}
    changes |= {"operation.speed": "5650 rpm"}
    result = gw.load("small-gearbox", changes).operating_point(sensitivity=True).document
    (before,) = result["loudest_lines"]
    (row,) = [row for row in result["sensitivity"] if row["parameter"] == "back wall"]
    for key, thickness in (("level_db", "11 mm"), ("reverse_level_db", "9 mm")):
        other = gw.load("small-gearbox", changes | {"housing.box.wall.back": thickness}).case
        (after,) = sound_lines(solve_sound(other, solve_at_rest(other, mesh_of(other))))
        found = 10.0 * np.log10(after.line.value / 1e-12) - before["sound_power_db"]
        assert row["sound"][0][key] == pytest.approx(found, abs=0.8)
        assert abs(found) > 2.5


@pytest.mark.slow
def test_a_line_of_the_sound_is_chosen(study: gw.CaseStudy) -> None:
    result = study.operating_point(line="sound@5133")
    assert [one["ranked"] for one in result.document["loudest_lines"]] == [True, False]
    (section,) = sections(result.document)
    table = next(one for one in section.tables if one.caption.startswith("Change of the sound power at 5133 Hz"))
    levels = {(row["parameter"], row["kind"]): row["sound"][0]["level_db"] for row in result.document["sensitivity"]}
    assert [row["level_db"] for row in table.rows] == [levels[row["parameter"], row["kind"]] for row in table.rows]
    sensitivity = result.solved.sensitivity
    assert sensitivity is not None
    assert sensitivity.sound_weights.tolist() == [1.0, 0.0]
    with pytest.raises(CaseError, match="'sound@2567'"):
        study.operating_point(line="sound@100")
