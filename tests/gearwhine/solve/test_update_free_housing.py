"""Updating of a housing that nothing holds, or hardly anything: rigid modes take no part and shift no number of a mode.

Reference is the housing solved anew beside the design, its modes followed by frequency.
"""

from dataclasses import replace

import numpy as np
import pytest

from gearwhine.case import Case, case_document, load_case, parse_case
from gearwhine.from_case.mesh import build_mesh, materials_of
from gearwhine.from_case.parametric_housing import HousingAtParameters, ParametricHousing, fitted_case
from gearwhine.housing import HousingError, assemble, solve_modes
from gearwhine.housing.updating import ModeCount, Target, measure
from gearwhine.numerics.arrays import FloatArray
from gearwhine.solve.updating import update_housing

HERTZ, NOISE, MODES, RIGID = 2.0 * np.pi, 0.005, 20, 6
WALLS = {"top": "9 mm", "left": "10 mm", "right": "11 mm", "bottom": "13 mm", "back": "12 mm", "front": "10.5 mm"}


def free_box(measured: FloatArray, modes: int = MODES) -> Case:
    """The bundled steel box, coarser, with six different walls and no supports."""
    document = case_document(load_case("steel-box", ["housing.box.mesh_size=50 mm"]).case)
    del document["housing"]["support"]
    document["housing"]["box"]["wall"] = WALLS
    document["measured"] = {"frequencies": (measured / HERTZ).tolist()}
    document["update"] = {
        "modes": modes,
        "solves": 1,
        "gap": 0.0,
        "frequency_noise": NOISE,
        "parameter": [
            {"name": "top", "keys": ["housing.box.wall.top"], "range": ["7 mm", "12 mm"]},
            {"name": "left", "keys": ["housing.box.wall.left"], "range": ["7 mm", "13 mm"]},
        ],
    }
    return parse_case(document)


@pytest.fixture(scope="module")
def designs() -> ParametricHousing:
    return ParametricHousing(fitted_case(free_box(np.array([HERTZ]))), MODES, threads=1)


@pytest.fixture(scope="module")
def design(designs: ParametricHousing) -> HousingAtParameters:
    return designs.solve(designs.start)


@pytest.fixture(scope="module")
def all_modes(designs: ParametricHousing) -> FloatArray:
    """Frequencies [rad/s] of the box as it stands, from its matrices."""
    given = designs.housing_at(designs.start)
    mesh = build_mesh(given.table, given.materials, given.files)
    parts = materials_of(given.table, given.materials, mesh)
    return solve_modes(assemble(*parts, threads=1), count=MODES).frequencies


@pytest.fixture(scope="module")
def measured(all_modes: FloatArray, design: HousingAtParameters) -> FloatArray:
    """The three dominant ones of the first five elastic modes."""
    elastic = all_modes[all_modes > 0.0]
    strong = design.state.dominance.strongest(3, (0.9 * elastic[0], elastic[4]))
    return design.state.frequencies[strong]


@pytest.fixture(scope="module")
def slopes(designs: ParametricHousing, design: HousingAtParameters, measured: FloatArray) -> FloatArray:
    """Slopes d ln ω by z of the measured modes, shape (3, 2), by differences of solved designs."""
    step, columns = 0.02, []
    for way in np.eye(2):
        either = [designs.solve(design.coordinates + sign * step * way, design).state for sign in (1.0, -1.0)]
        nearest = [np.abs(np.log(one.frequencies[:, None] / measured)).argmin(axis=0) for one in either]
        above, below = (np.log(one.frequencies[places]) for one, places in zip(either, nearest, strict=True))
        columns.append((above - below) / (2.0 * step))
    return np.array(columns).T


def test_rigid_modes_are_left_out_and_counted(all_modes: FloatArray, design: HousingAtParameters) -> None:
    assert np.count_nonzero(all_modes == 0.0) == design.state.n_rigid == RIGID
    assert design.state.frequencies == pytest.approx(all_modes[RIGID:], rel=1e-7)
    assert design.shapes is not None
    assert len(design.shapes) == len(design.state.seats) == len(design.state.skin) == MODES - RIGID


@pytest.mark.slow
@pytest.mark.parametrize("modes", [MODES, 12])
def test_uncertainties_are_those_of_the_measured_modes(
    measured: FloatArray, slopes: FloatArray, all_modes: FloatArray, modes: int
) -> None:
    """C = (I + Sᵀ S / σ²)⁻¹ with S by differences; also with as few elastic modes as there are rigid ones."""
    covariance = np.linalg.inv(np.eye(2) + slopes.T @ slopes / NOISE**2)
    solved = update_housing(free_box(measured, modes), threads=1)
    assert [row.left for row in solved.found] == pytest.approx(np.sqrt(np.diag(covariance)).tolist(), rel=1e-3)
    left = np.sqrt(np.einsum("mi,ij,mj->m", slopes, covariance, slopes))
    assert [pair.uncertainty for pair in solved.pairs] == pytest.approx(left.tolist(), rel=1e-3)
    numbers = [1 + int(np.abs(all_modes - frequency).argmin()) for frequency in measured]
    assert [pair.mode for pair in solved.pairs] == numbers


def test_a_number_of_modes_is_that_of_the_housing_on_the_surrogate_too(
    design: HousingAtParameters, all_modes: FloatArray, measured: FloatArray
) -> None:
    limit = 0.5 * (all_modes[13] + all_modes[14])
    near = design.surrogate().at(design.coordinates)
    target = Target(measured, np.full(3, NOISE), (0.9 * measured[0], 1.01 * measured[-1]))
    for known, met in ((14, True), (13, False), (8, False), (0, False)):
        counted = replace(target, count=ModeCount(limit, known, known))
        solved, predicted = (measure(counted, one.state, design.coordinates) for one in (design, near))
        assert solved.count == predicted.count == 14
        assert predicted.value == pytest.approx(solved.value, rel=1e-6, abs=1e-9)
        assert (solved.value < 1e-9) == met


def test_no_measured_shape_is_paired_with_a_rigid_motion(
    designs: ParametricHousing, design: HousingAtParameters
) -> None:
    """A rocking on the suspension is no mode of the model: it has no partner, and the misfit stays finite."""
    normals = np.array([[1.0, 0.0, 0.0]] * 3 + [[0.0, 1.0, 0.0]] * 3 + [[0.0, 0.0, 1.0]] * 3)
    places = np.random.default_rng(3).choice(len(design.mesh.points), 9, replace=False)
    assert design.shapes is not None
    motions = np.einsum("mni,ni->mn", design.shapes[:, places], normals)
    rocking = np.einsum("ni,ni->n", np.cross([0.3, 1.0, -0.2], design.mesh.points[places]), normals)
    state = replace(design.state, measured=motions)
    shapes = np.array([rocking, motions[0], motions[1]])
    frequencies = np.array([30.0, *design.state.frequencies[:2]])
    misfit = measure(Target(frequencies, np.full(3, NOISE), (1.0, 1e6), shapes), state, design.coordinates)
    assert misfit.pairs.tolist()[1:] == [0, 1]
    assert np.isfinite(misfit.value)


def test_a_soft_suspension_takes_part_with_the_modes_far_above_it() -> None:
    """On springs of 1e5 N/m, six modes of 17 to 45 Hz below 1.7 kHz, a wall one standard deviation thicker.

    The walls' mass couples them all: modes a hundred times apart barely mix by it, and all are predicted.
    """
    document = case_document(free_box(np.array([HERTZ])))
    document["housing"]["support"] = [
        {"name": f"spring {n}", "surface": f"foot-{n}", "stiffness": {"x": 1e5, "y": 2e5, "z": 1.3e5}}
        for n in range(1, 5)
    ]
    designs = ParametricHousing(fitted_case(parse_case(document)), MODES, threads=1)
    start = designs.solve(designs.start)
    there = designs.start + [1.0, 0.0]
    solved, predicted = designs.solve(there, start).state, start.surrogate().at(there).state
    assert start.state.n_rigid == 0
    assert start.state.frequencies[6] > 30.0 * start.state.frequencies[5]
    moved = np.abs(np.log(solved.frequencies / start.state.frequencies))
    errors = np.abs(np.log(predicted.frequencies / solved.frequencies))
    assert moved[:14].max() > 0.02
    assert errors[:14].max() < 0.003


def test_a_surrogate_of_rigid_modes_alone_is_refused(designs: ParametricHousing) -> None:
    with pytest.raises(HousingError, match="all 6 modes are rigid"):
        replace(designs, modes=RIGID).solve(designs.start)
