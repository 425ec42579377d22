"""Surveys as programs write them: analysis results, points and shapes and responses apart, frequencies alone."""

from pathlib import Path

import numpy as np
import pytest
from universal_layouts import (
    elements_2412,
    function_58,
    header,
    points_15,
    points_2411,
    results_2414,
    shape_55,
    systems_2420,
    trace_82,
    units,
    write,
)

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured import read_survey, read_universal

PLACES = {11: [0.0, 0.0, 5.0], 12: [100.0, 0.0, 5.0], 13: [0.0, 200.0, 5.0], 28: [100.0, 200.0, 5.0]}
METRES = np.array(list(PLACES.values())) / 1000.0
MILLIMETRES = units(5, 1000.0, 1000.0)  # mm and mN
RNG = np.random.default_rng(3)
FIRST = {node: RNG.normal(size=3).round(4).tolist() for node in PLACES}
SECOND = {node: RNG.normal(size=3).round(4).tolist() for node in PLACES}
TWISTED = {node: (RNG.normal(size=3) + 1j * RNG.normal(size=3)).round(4).tolist() for node in PLACES}
RESPONSE = (RNG.normal(size=7) + 1j * RNG.normal(size=7)).round(3)


def flat(shape: dict[int, list[complex]]) -> np.ndarray:
    return np.array([value for values in shape.values() for value in values])


def test_modes_as_analysis_results_are_read(tmp_path: Path) -> None:
    """As NX and Simcenter write them: 2411 in mm, shells 2412, each mode a data set 2414 with three values a node."""
    path = write(
        tmp_path / "nx.unv",
        header(),
        MILLIMETRES,
        points_2411(PLACES),
        elements_2412({1: [11, 12, 28, 13]}),
        results_2414(SECOND, hertz=1049.0, viscous=0.02, mode=2),
        results_2414(FIRST, hertz=658.125, viscous=0.01),
        ending="\r\n",
    )
    found = read_universal(path)
    np.testing.assert_allclose(found.geometry.positions, METRES, rtol=1e-15)
    np.testing.assert_allclose(found.modes.frequencies, 2 * np.pi * np.array([658.125, 1049.0]), rtol=1e-6)
    np.testing.assert_allclose(found.modes.damping_ratios, [0.01, 0.02])
    np.testing.assert_allclose(found.modes.shapes, [flat(FIRST), flat(SECOND)])
    assert [found.geometry.labels[point] for point in found.geometry.points[::3]] == ["11", "12", "13", "28"]
    assert found.remarks == ("1 of dataset 2412 not read",)


def test_analysis_results_and_data_at_nodes_read_alike(tmp_path: Path) -> None:
    """Six values a node, real and complex; eigenvalue -30 + 40i has ω = 50 rad/s, ζ = 0.6."""
    with_rotations = {node: [*values, 0.1, 0.2, 0.3] for node, values in FIRST.items()}
    twisted = {node: [*values, 0.1j, 0.2 + 0j, 0.3j] for node, values in TWISTED.items()}
    found = []
    for name, mode in (("old.unv", shape_55), ("new.unv", results_2414)):
        datasets = mode(with_rotations, hertz=120.0), mode(twisted, eigenvalue=-30 + 40j, mode=2)
        found.append(read_universal(write(tmp_path / name, MILLIMETRES, points_15(PLACES), *datasets)))
    for survey in found:
        np.testing.assert_allclose(survey.modes.frequencies, [50.0, 2 * np.pi * 120.0])
        np.testing.assert_allclose(survey.modes.damping_ratios, [0.6, 0.0])
        np.testing.assert_allclose(survey.modes.shapes, [flat(TWISTED), flat(FIRST)])
        assert survey.remarks == ("rotations of the shapes not read",)


def test_numbers_that_touch_and_fortran_exponents_are_read(tmp_path: Path) -> None:
    """E13.5 of -1.2E-101 leaves no blank before it; some programs write D for E."""
    shape = {11: [-1.25, -2.5, -3.75], 12: [1.0, -1.0, 0.5]}
    text = results_2414(shape, hertz=100.0)
    text = text.replace(" -1.25000E+00 -2.50000E+00 -3.75000E+00", "-1.250000E+00-2.500000D+00-3.750000D+00")
    found = read_universal(write(tmp_path / "touch.unv", MILLIMETRES, points_15(PLACES), text)).modes
    np.testing.assert_allclose(found.shapes[0], [-1.25, -2.5, -3.75, 1.0, -1.0, 0.5])


def test_results_that_are_no_modes_at_nodes_are_passed_over(tmp_path: Path) -> None:
    path = write(
        tmp_path / "all.unv",
        MILLIMETRES,
        points_2411(PLACES),
        results_2414(FIRST, hertz=100.0),
        results_2414(SECOND, hertz=100.0, location=2),  # on elements
        results_2414(SECOND, hertz=100.0, result=9),  # reaction forces
        results_2414(SECOND, analysis=1),  # static
        results_2414({node: [1.0] for node in PLACES}, hertz=100.0, result=5),  # temperatures
        results_2414(SECOND, hertz=0.0),  # a rigid motion
    )
    found = read_universal(path)
    np.testing.assert_allclose(found.modes.shapes, [flat(FIRST)])
    assert found.remarks == (
        "4 of dataset 2414 not read: no modes with motions at nodes",
        "1 mode at 0 Hz not read: a rigid motion",
    )


@pytest.mark.parametrize("mode", [shape_55, results_2414])
def test_hysteretic_damping_counts_where_there_is_no_other(tmp_path: Path, mode) -> None:
    """A loss factor η is the viscous ratio η / 2 at resonance."""
    datasets = mode(FIRST, hertz=100.0, loss=0.04), mode(SECOND, hertz=200.0, viscous=0.01, loss=0.04)
    found = read_universal(write(tmp_path / "h.unv", MILLIMETRES, points_15(PLACES), *datasets))
    np.testing.assert_allclose(found.modes.damping_ratios, [0.02, 0.01])
    assert any("half of the hysteretic" in remark for remark in found.remarks)


def test_analysis_results_stand_in_the_common_frame_and_modal_tests_in_the_points_own(tmp_path: Path) -> None:
    """System 4 has its x along y, its y along z and its z along x; a shape (1, 2, 3) in it is (3, 1, 2)."""
    system = systems_2420({4: [[0, 1, 0], [0, 0, 1], [1, 0, 0], [0, 0, 0]]})
    shape, common = {11: [1.0, 2.0, 3.0]}, np.array([3.0, 1.0, 2.0])
    for name, mode, frame, expected in (
        ("a", results_2414, None, [1.0, 2.0, 3.0]),
        ("b", results_2414, "local", common),
        ("c", shape_55, None, common),
        ("d", shape_55, "global", [1.0, 2.0, 3.0]),
    ):
        path = write(tmp_path / f"{name}.unv", MILLIMETRES, system, points_2411(PLACES, 4), mode(shape, hertz=100.0))
        found = read_universal(path, shape_frame=frame)
        np.testing.assert_allclose(found.modes.shapes[0].real @ found.geometry.directions, expected, atol=1e-12)
    both = shape_55(shape, hertz=100.0), results_2414({11: common.tolist()}, hertz=200.0)
    found = read_universal(write(tmp_path / "e.unv", MILLIMETRES, system, points_2411(PLACES, 4), *both))
    np.testing.assert_allclose(found.modes.shapes.real @ found.geometry.directions, [common, common], atol=1e-12)


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
def test_points_shapes_and_responses_may_stand_in_files_of_their_own(tmp_path: Path, order: tuple[int, ...]) -> None:
    """Points in mm and mN; shapes without units; responses in SI: their axes do not name units."""
    geometry = MILLIMETRES, points_15(PLACES), trace_82([11, 12, 28, 13, 0, 11])
    shapes = shape_55(FIRST, hertz=658.0, viscous=0.01), shape_55(SECOND, hertz=1049.0, viscous=0.02)
    function = function_58(RESPONSE, response=(12, 3), reference=(11, -2), double=True)
    apart = [
        write(tmp_path / "geometry.unv", header(), *geometry),
        write(tmp_path / "shapes.uff", header(), *shapes),
        write(tmp_path / "responses.uff", header(), units(1, 1.0, 1.0), function),
    ]
    found = read_survey([apart[place] for place in order])
    whole = read_universal(write(tmp_path / "whole.uff", *geometry, *shapes))
    np.testing.assert_array_equal(found.geometry.positions, whole.geometry.positions)
    np.testing.assert_array_equal(found.modes.shapes, whole.modes.shapes)
    assert found.geometry.lines == ((0, 1, 3, 2),)
    np.testing.assert_allclose(found.responses.values[0, 0], RESPONSE)  # m/s² by N, and not mm/s² by mN
    np.testing.assert_array_equal(found.responses.reference_directions, [[0, -1, 0]])
    assert found.remarks == ()


def test_a_file_of_a_survey_without_units_has_those_of_the_first_that_states_some(tmp_path: Path) -> None:
    geometry = write(tmp_path / "geometry.unv", points_15(PLACES))
    function = function_58(RESPONSE, response=(12, 3), reference=(11, 3))
    responses = write(tmp_path / "responses.unv", MILLIMETRES, function)
    found = read_survey([geometry, responses])
    np.testing.assert_allclose(found.geometry.positions, METRES)
    np.testing.assert_allclose(found.responses.values[0, 0], RESPONSE)  # mm/s² by mN
    assert found.remarks == ("geometry.unv states no units (dataset 164): taken in those of the first file that does",)
    assert read_survey([geometry, responses], unit="cm").geometry.positions[1, 0] == 1.0


def test_files_of_a_survey_that_do_not_fit_are_named(tmp_path: Path) -> None:
    geometry = write(tmp_path / "geometry.unv", MILLIMETRES, points_15(PLACES))
    moved = write(tmp_path / "moved.unv", MILLIMETRES, points_15({11: [9.0, 0.0, 0.0]}))
    other = write(tmp_path / "shapes.unv", shape_55({99: [1.0, 0.0, 0.0]}, hertz=100.0))
    table = tmp_path / "modes.csv"
    table.write_text("frequency_hz\n658\n")
    with pytest.raises(MeasuredDataError, match="point 11 stands twice"):
        read_survey([geometry, moved])
    with pytest.raises(MeasuredDataError, match="mode 1 names node 99"):
        read_survey([geometry, other])
    with pytest.raises(MeasuredDataError, match=r"modes\.csv is a table, which stands alone"):
        read_survey([geometry, table])


@pytest.mark.parametrize("mode", [shape_55, results_2414])
@pytest.mark.parametrize(
    ("shape", "points", "said"),
    [
        (FIRST, "", "no points"),
        ({}, points_15(PLACES), "shapes are zero"),
        ({node: [0.0, 0.0, 0.0] for node in PLACES}, points_15(PLACES), "shapes are zero"),
    ],
)
def test_frequencies_alone_are_read_without_shapes(tmp_path: Path, mode, shape, points: str, said: str) -> None:
    datasets = mode(shape, hertz=1049.0, viscous=0.02, mode=2), mode(shape, hertz=658.0, viscous=0.01)
    found = read_universal(write(tmp_path / "modes.unv", units(1, 1.0, 1.0), points, *datasets))
    np.testing.assert_allclose(found.modes.frequencies, 2 * np.pi * np.array([658.0, 1049.0]))
    np.testing.assert_allclose(found.modes.damping_ratios, [0.01, 0.02])
    assert found.modes.shapes is None
    assert [said in remark for remark in found.remarks] == [True]


@pytest.mark.parametrize("double", [False, True])
@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("count", [2, 5, 7])
def test_lines_filled_with_zeros_hold_no_values(tmp_path: Path, count: int, even: bool, double: bool) -> None:
    """Seven complex values are 14 numbers; six to a line, 4 zeros fill the third one."""
    values = RESPONSE[:count]
    for filling in (None, 0.0):
        function = function_58(values, response=(12, 3), reference=(11, 3), even=even, double=double, filling=filling)
        path = write(tmp_path / "f.uff", units(1, 1.0, 1.0), points_15(PLACES), function)
        found = read_universal(path).responses
        np.testing.assert_allclose(found.values[0, 0], values)
        np.testing.assert_allclose(found.frequencies, 2 * np.pi * (1.0 + np.arange(count)))


def test_more_values_than_a_function_says_are_refused_where_they_are_no_filling(tmp_path: Path) -> None:
    function = function_58(RESPONSE, response=(12, 3), reference=(11, 3), filling=1.0)
    with pytest.raises(MeasuredDataError, match="says 7 values and holds 9"):
        read_universal(write(tmp_path / "f.uff", units(1, 1.0, 1.0), points_15(PLACES), function))


@pytest.mark.parametrize(
    ("was", "becomes", "match"),
    [
        ("  6.58125E+02", "  -1.0000E+02", "frequency -100 Hz"),
        ("  1.00000E-02", "  1.00000E+00", "damping ratio 1"),
        ("         2         8", "         x         8", "expected 6 whole numbers"),
        ("        13\n", "        1x\n", "no node's number"),
        ("        13\n", "", "cut short"),
        ("  6.58125E+02", "  nonsense   ", "expected numbers"),
    ],
)
def test_a_damaged_analysis_result_is_named(tmp_path: Path, was: str, becomes: str, match: str) -> None:
    text = results_2414(FIRST, hertz=658.125, viscous=0.01)
    assert was in text
    path = write(tmp_path / "d.unv", MILLIMETRES, points_2411(PLACES), text.replace(was, becomes, 1))
    with pytest.raises(MeasuredDataError, match=rf"dataset 3 of d\.unv \(2414, analysis results\).*{match}"):
        read_universal(path)
