"""Universal files of others: pyuff's, a test program's and a public one; in other units, frames and byte orders."""

import os
from pathlib import Path

import numpy as np
import pytest
import pyuff
from universal_surveys import FUNCTION, MILLIMETRES, POINTS, SHAPE, SIX_DIGITS, by_pyuff, one_function

from gearwhine.housing.measured import read_universal, write_universal

# Public files are read where they are at hand: the folder `data` of https://github.com/ladisk/pyuff (MIT).
PUBLIC = Path(os.environ.get("GEARWHINE_PYUFF_DATA", "")) / "TestLab 161 164 18 15 82.uff"
at_hand = pytest.mark.skipif(not PUBLIC.is_file(), reason="GEARWHINE_PYUFF_DATA names no folder with pyuff's files")


def test_a_file_by_pyuff_in_millimetres(tmp_path: Path) -> None:
    path = by_pyuff(tmp_path / "survey.uff", MILLIMETRES, POINTS, SHAPE, FUNCTION)
    found = read_universal(path)
    np.testing.assert_allclose(found.geometry.positions[1], [0.1, 0.0, 0.005])
    np.testing.assert_allclose(found.modes.frequencies, [2 * np.pi * 120.0])
    assert found.modes.damping_ratios is None
    # x stays at rest everywhere, so it was not measured; z moves at point 2 alone.
    assert [found.geometry.labels[point] for point in found.geometry.points] == ["1", "2", "2", "3"]
    np.testing.assert_array_equal(found.modes.shapes, [[1.0, 2.0, 0.5, 3.0]])
    # mm/s² per mN is m/s² per N: the factor is F / L = 1.
    np.testing.assert_allclose(found.responses.values[0, 0], FUNCTION["data"], rtol=1e-9)
    np.testing.assert_array_equal(found.responses.reference_directions, [[0, -1, 0]])
    np.testing.assert_array_equal(found.responses.geometry.directions, [[0, 0, 1]])


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # pyuff leaves its file open
@pytest.mark.parametrize("spacing", [0, 1])
@pytest.mark.parametrize("binary", [0, 1])
def test_functions_of_any_form_read_alike(tmp_path: Path, binary: int, spacing: int) -> None:
    path = by_pyuff(tmp_path / "f.uff", POINTS, FUNCTION | {"binary": binary, "abscissa_spacing": spacing})
    found = read_universal(path).responses
    np.testing.assert_allclose(found.values[0, 0], FUNCTION["data"], rtol=1e-9)
    np.testing.assert_allclose(found.frequencies, 2 * np.pi * FUNCTION["x"], rtol=SIX_DIGITS)


@pytest.mark.parametrize(("kind", "order"), [("<f8", 1), (">f8", 2), ("<f4", 1), (">f4", 2)])
def test_binary_parts_of_either_byte_order_and_precision_are_read(tmp_path: Path, kind: str, order: int) -> None:
    """A block laid by hand after the format's text: record 1 fields 3 and 4, record 7 field 1 (5 single, 6 double)."""
    path = one_function(tmp_path / "kinds.uff")
    expected = read_universal(path).responses
    content = path.read_bytes()
    start = content.index(b"    58b") + 12 * 81
    numbers = np.frombuffer(content[start : start + 50 * 3 * 8], dtype="<f8").astype(kind).tobytes()
    header = content[:start].replace(
        b"    58b     1     2          11        1200", b"    58b%6d     2          11%12d" % (order, len(numbers))
    )
    if kind.endswith("4"):
        header = header.replace(b"         6        50", b"         5        50")
    path.write_bytes(header + numbers + content[start + 50 * 3 * 8 :])
    found = read_universal(path).responses
    digits = 1e-15 if kind.endswith("8") else 1e-7
    np.testing.assert_allclose(found.values, expected.values, rtol=digits)
    np.testing.assert_allclose(found.frequencies, expected.frequencies, rtol=digits)


@pytest.mark.parametrize(
    ("numerator", "denominator", "factor"), [("g", "N", 9.80665), ("m/s^2", "lbf", 1 / 4.4482216152605), ("", "", 1.0)]
)
def test_an_axis_that_names_its_unit_is_taken_in_it(
    tmp_path: Path, numerator: str, denominator: str, factor: float
) -> None:
    labels = {"ordinate_axis_units_lab": numerator, "orddenom_axis_units_lab": denominator}
    found = read_universal(by_pyuff(tmp_path / "f.uff", POINTS, FUNCTION | labels))
    np.testing.assert_allclose(found.responses.values[0, 0], factor * FUNCTION["data"], rtol=1e-9)
    assert any("as their axis says" in remark for remark in found.remarks) == (factor != 1.0)


@pytest.mark.parametrize(
    ("label", "angular", "said"),
    [
        ("Hz", 2.0 * np.pi, None),
        ("NONE", 2.0 * np.pi, None),
        ("rad/s", 1.0, "taken in rad/s, as their axis says"),
        ("RPM", np.pi / 30.0, "taken in rpm, as their axis says"),
        ("order", 2.0 * np.pi, "'order' of the functions' frequencies not known, taken in Hz"),
    ],
)
def test_frequencies_are_taken_in_the_unit_that_their_axis_names(
    tmp_path: Path, label: str, angular: float, said: str | None
) -> None:
    found = read_universal(by_pyuff(tmp_path / "f.uff", POINTS, FUNCTION | {"abscissa_axis_units_lab": label}))
    np.testing.assert_allclose(found.responses.frequencies, angular * FUNCTION["x"], rtol=1e-5)
    told = [remark for remark in found.remarks if "frequencies" in remark]
    assert len(told) == (said is not None)
    assert all(said in remark for remark in told)


@pytest.mark.parametrize(("label", "factor", "known"), [("ft/s^2", 0.3048, True), ("furlong/s^2", 1e-3, False)])
def test_a_unit_that_is_not_known_is_said(tmp_path: Path, label: str, factor: float, known: bool) -> None:
    """It counts as one of the file's system, here of millimetres and newtons."""
    units = MILLIMETRES | {"force": 1.0}
    function = FUNCTION | {"ordinate_axis_units_lab": label}
    found = read_universal(by_pyuff(tmp_path / "f.uff", POINTS, units, function))
    np.testing.assert_allclose(found.responses.values[0, 0], factor * FUNCTION["data"], rtol=1e-5)
    assert any(f"unit {label!r} not known" in remark for remark in found.remarks) != known


def test_a_complex_eigenvalue_gives_frequency_and_damping(tmp_path: Path) -> None:
    """λ = ω (-ζ + i √(1 - ζ²)): of -30 ± 40i, ω = 50 rad/s and ζ = 0.6."""
    shape = {key: value for key, value in SHAPE.items() if key != "freq"} | {"analysis_type": 3, "eig": -30 + 40j}
    shape |= {"r1": np.zeros(3, dtype=complex), "r2": np.array([1j, 2.0, 3.0])}
    found = read_universal(by_pyuff(tmp_path / "c.uff", POINTS, shape)).modes
    np.testing.assert_allclose(found.frequencies, [50.0])
    np.testing.assert_allclose(found.damping_ratios, [0.6])
    np.testing.assert_allclose(found.shapes[0, 0], 1j)


def test_directions_of_local_systems_are_resolved(tmp_path: Path) -> None:
    """A cylindrical system about z through (1, 0, 0): at (1, 2, 0) outward is y, around is -x."""
    system = {"type": 18, "cs_num": [4], "cs_type": [1], "ref_cs_num": [0], "ref_o": [[1.0, 0, 0]]}
    system |= {"x_point": [[2.0, 0, 0]], "xz_point": [[1.0, 0, 1.0]]}
    points = {"type": 15, "node_nums": [1], "def_cs": [4], "disp_cs": [4], "x": [2.0], "y": [90.0], "z": [0.0]}
    shape = SHAPE | {"node_nums": [1], "r1": np.array([1.0]), "r2": np.array([2.0]), "r3": np.array([3.0])}
    path = by_pyuff(tmp_path / "local.uff", system, points, shape)
    found = read_universal(path)
    np.testing.assert_allclose(found.geometry.positions, [[1.0, 2.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(found.geometry.directions, [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], atol=1e-12)
    assert any("own frame" in remark for remark in found.remarks)
    common = read_universal(path, shape_frame="global")
    np.testing.assert_allclose(common.geometry.directions, np.eye(3))


def test_a_spherical_system_and_one_within_another(tmp_path: Path) -> None:
    """System 5 is turned by 90° about z within 4, which is shifted by (0, 0, 3)."""
    system = {"type": 18, "cs_num": [4, 5], "cs_type": [0, 2], "ref_cs_num": [0, 4]}
    system |= {"ref_o": [[0, 0, 3.0], [0, 0, 0]], "x_point": [[1.0, 0, 3.0], [0, 1.0, 0]]}
    system |= {"xz_point": [[0, 0, 4.0], [0, 0, 1.0]]}
    points = {"type": 15, "node_nums": [1], "def_cs": [5], "disp_cs": [5], "x": [2.0], "y": [0.0], "z": [90.0]}
    shape = SHAPE | {"node_nums": [1], "r1": np.array([1.0]), "r2": np.array([2.0]), "r3": np.array([3.0])}
    found = read_universal(by_pyuff(tmp_path / "local.uff", system, points, shape))
    np.testing.assert_allclose(found.geometry.positions, [[0.0, 2.0, 3.0]], atol=1e-12)
    np.testing.assert_allclose(found.geometry.directions, [[0, 1, 0], [-1, 0, 0], [0, 0, -1]], atol=1e-12)


AS_BY_A_TEST_PROGRAM = """\
    -1                                                                          {0}
   151                                                                          {0}
Gearbox{0}
NONE{0}
TEST PROGRAM{0}
11-Oct-17 09:34:21{0}
11-Oct-17 09:34:21{0}
TEST PROGRAM{0}
17-Oct-17 13:50:13 {0}
    -1                                                                          {0}
    -1{0}
   164{0}
         9USER_DEFINED{0}
  1.00000000000000000D+03  1.00000000000000000D+00  1.00000000000000000D+00{0}
 -2.73149999999999960D+02{0}
    -1{0}
    -1{0}
    18{0}
         1         0         0         8         1{0}
SIDE{0}
  1.00000e+02  0.00000e+00  0.00000e+00  1.00000e+02  1.00000e+00  0.00000e+00{0}
  1.00000e+02  0.00000e+00  1.00000e+00{0}
    -1{0}
    -1{0}
    15{0}
       101         1         1         8  2.00000e+01  3.00000e+00  4.00000e+00{0}
       102         0         0         8 -1.50000e+02  0.00000e+00  2.50000e+02{0}
    -1{0}
    -1{0}
    82{0}
         1         4         8{0}
NONE{0}
       101       102         0       101{0}
    -1{0}
    -1{0}
    55{0}
NONE{0}
NONE{0}
NONE{0}
NONE{0}
NONE{0}
         1         3         2        12         5         3{0}
         2         6         1         1{0}
 -6.00000e+00  8.00000e+00  1.00000e+00  0.00000e+00  1.00000e+00  0.00000e+00{0}
       101{0}
  1.00000e+00  2.00000e+00  0.00000e+00  0.00000e+00 -3.00000e-01  0.00000e+00{0}
       102{0}
  0.00000e+00  0.00000e+00  5.00000e-01 -5.00000e-01  0.00000e+00  0.00000e+00{0}
    -1{0}
"""


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_a_file_as_test_programs_write_it(tmp_path: Path, ending: str) -> None:
    """Padded markers, Fortran exponents, lines of either kind; a side whose x is along y and whose y is along -x."""
    path = tmp_path / "program.unv"
    path.write_bytes(AS_BY_A_TEST_PROGRAM.replace("\n", "").replace("{0}", ending).encode("ascii"))
    found = read_universal(path)
    np.testing.assert_allclose(found.geometry.positions, [[0.097, 0.02, 0.004], [-0.15, 0.0, 0.25]], atol=1e-12)
    assert found.geometry.lines == ((0, 1),)
    np.testing.assert_array_equal(found.geometry.points, [0, 0, 1])
    np.testing.assert_allclose(found.geometry.directions, [[0, 1, 0], [0, 0, 1], [0, 1, 0]], atol=1e-12)
    np.testing.assert_allclose(found.modes.shapes, [[1 + 2j, -0.3, 0.5 - 0.5j]])
    np.testing.assert_allclose(found.modes.frequencies, [10.0])
    np.testing.assert_allclose(found.modes.damping_ratios, [0.6])


@at_hand
def test_a_public_file_of_a_test_program_reads_as_its_text_says() -> None:
    """pyuff's "TestLab 161 164 18 15 82.uff" (MIT): points by fixed columns, systems by their three points."""
    found = read_universal(PUBLIC)
    lines = PUBLIC.read_text(encoding="ascii").splitlines()
    start = next(index for index, line in enumerate(lines) if line.strip() == "15") + 1
    stop = next(index for index in range(start, len(lines)) if lines[index].strip() == "-1")
    records = [line.split() for line in lines[start:stop]]
    assert found.geometry.labels == tuple(record[0] for record in records)
    systems = next(index for index, line in enumerate(lines) if line.strip() == "18") + 1
    for record, position in zip(records, found.geometry.positions, strict=True):
        number, local = int(record[1]), np.array([float(cell) for cell in record[4:7]])
        if number == 0:
            np.testing.assert_allclose(position, local)
            continue
        at = systems + 4 * (number - 1)
        assert int(lines[at].split()[0]) == number
        cells = np.array([float(cell) for cell in (lines[at + 2] + lines[at + 3]).split()]).reshape(3, 3)
        x, xz = cells[1] - cells[0], cells[2] - cells[0]
        z = xz - (xz @ x) * x / (x @ x)
        axes = np.array([x / np.linalg.norm(x), np.cross(z, x) / np.linalg.norm(np.cross(z, x)), z / np.linalg.norm(z)])
        np.testing.assert_allclose(position, cells[0] + local @ axes, atol=1e-9)
    assert len(found.geometry.lines) >= 11


@at_hand
def test_the_public_file_written_by_us_and_by_pyuff_reads_alike(tmp_path: Path) -> None:
    found = read_universal(PUBLIC)
    write_universal(tmp_path / "ours.uff", found)
    ours = read_universal(tmp_path / "ours.uff")
    np.testing.assert_allclose(ours.geometry.positions, found.geometry.positions, rtol=1e-15)
    sets = pyuff.UFF(str(PUBLIC)).read_sets()
    for dataset in sets:
        if dataset["type"] == 82:
            dataset["nodes"] = dataset["nodes"].astype(int)
        if dataset["type"] == 15:
            for key in ("node_nums", "def_cs", "disp_cs", "color"):
                dataset[key] = [int(value) for value in dataset[key]]
    theirs = read_universal(by_pyuff(tmp_path / "theirs.uff", *[one for one in sets if one["type"] != 151]))
    for other in (ours, theirs):
        assert other.geometry.labels == found.geometry.labels
        np.testing.assert_allclose(other.geometry.positions, found.geometry.positions, atol=1e-5)
    assert ours.geometry.lines == found.geometry.lines


def test_units_not_stated_are_assumed_aloud_and_can_be_told(tmp_path: Path) -> None:
    path = by_pyuff(tmp_path / "p.uff", POINTS, SHAPE)
    assert any("taken in metres" in remark for remark in read_universal(path).remarks)
    told = read_universal(path, unit="mm")
    np.testing.assert_allclose(told.geometry.positions[2], [0.0, 0.2, 0.005])
    stated = read_universal(by_pyuff(tmp_path / "q.uff", MILLIMETRES, POINTS, SHAPE), unit="in")
    np.testing.assert_allclose(stated.geometry.positions[1, 0], 2.54)
    assert any("not as the file's dataset 164 states" in remark for remark in stated.remarks)
