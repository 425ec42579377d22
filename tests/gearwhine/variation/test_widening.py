"""What wider tolerances cost: against the closed form of a sum of uniform forces, and the interval of a difference."""

from pathlib import Path

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.numerics.distributions import Discrete, Measured, Normal, Rayleigh, Triangular, Uniform, widened
from gearwhine.variation.statistics import Difference
from tests.machines.belted_shaft import BELTED_SHAFT

SHAFT = (
    BELTED_SHAFT
    + """
[variation]
samples = 256
[variation.vary]
"operation.force[0].x" = { uniform = ["900 N", "1100 N"] }
"operation.force[1].x" = { uniform = ["100 N", "900 N"] }
"rotor.shaft.segments[0].diameter" = { values = ["29 mm", "31 mm"] }
[variation.limit]
"bearing.left.force_n" = { at_most = 1000 }
"""
)
LEFT = "bearing.left.force_n"


def _within(first: float, second: float, limit: float) -> float:
    """Probability that 0.8 F1 + 0.2 F2 is within the limit, uniform about 1 kN and 500 N with these half widths."""
    f1 = np.linspace(1000.0 - first, 1000.0 + first, 400001)
    return float(np.mean(np.clip(((limit - 0.8 * f1) / 0.2 - (500.0 - second)) / (2.0 * second), 0.0, 1.0)))


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    place = tmp_path_factory.mktemp("widened")
    (place / "shaft.toml").write_text(SHAFT)
    return gw.load(place / "shaft.toml").vary(256, widen=1.5, folder=place / "out", workers=1).document


@pytest.mark.slow
def test_the_yield_with_a_wider_force_is_that_of_the_closed_form(found: dict[str, object]) -> None:
    rows = found["widened"]
    # The wider second force costs more; a diameter of two values has no tolerance.
    assert [row["input"] for row in rows] == ["operation.force[1].x", "operation.force[0].x"]
    before = _within(100.0, 400.0, 1000.0)
    assert found["yield"]["share"] == pytest.approx(before, abs=0.01)
    for row, first, second in zip(rows, (100.0, 150.0), (600.0, 400.0), strict=True):
        after = _within(first, second, 1000.0)
        assert row["yield"]["share"] == pytest.approx(after, abs=0.01)
        assert row["change"]["low"] <= after - before <= row["change"]["high"]
        assert row["change"]["difference"] == pytest.approx(after - before, abs=0.01)
        assert row["change"]["high"] - row["change"]["low"] < 0.13


@pytest.mark.slow
def test_the_scatter_with_a_wider_force_is_that_of_the_sum(found: dict[str, object]) -> None:
    for row, first, second in zip(found["widened"], (100.0, 150.0), (600.0, 400.0), strict=True):
        (quantity,) = [one for one in row["quantities"] if one["name"] == LEFT]
        assert quantity["std"] == pytest.approx(np.hypot(0.8 * first, 0.2 * second) / np.sqrt(3.0), rel=0.01)
        assert quantity["std_before"] == pytest.approx(np.hypot(80.0, 80.0) / np.sqrt(3.0), rel=0.01)
        assert quantity["quantile"] > quantity["quantile_before"]
    # The table of distributions is of the gearboxes as they are.
    assert found["samples"] == 3 * 256
    assert found["representative"] == 256
    (left,) = [one for one in found["quantities"] if one["name"] == LEFT]
    assert left["std"] == pytest.approx(np.hypot(80.0, 80.0) / np.sqrt(3.0), rel=0.01)


def test_machines_of_python_are_widened_too() -> None:
    def shaft(values: dict[str, float]) -> gw.Machine:
        rotor = gw.Rotor("shaft", [gw.Segment(0.5, values["diameter"], 0.0, gw.STEEL)])
        held = [gw.Bearing.isotropic(f"at {at}", at, 1e10) for at in (0.0, 0.5)]
        return gw.Machine([gw.Shaft(rotor)], [gw.MountedBearing(one, "shaft", None) for one in held], speed=100.0)

    name = "rotor.shaft.critical_speed_1_rpm"
    laws = {"diameter": Uniform(0.0298, 0.0302)}
    speed = gw.vary(shaft, laws, 16, analyses=["rotors"], widen=2.0, limits={name: (0.0, None)}).solved
    (row,) = speed.widened
    # The critical speed of a slender shaft on stiff bearings is in proportion to its diameter.
    assert row.quantities[0].deviation / row.quantities[0].deviation_before == pytest.approx(2.0, rel=1e-2)
    # Of a least value the bad end is the low one.
    assert row.quantities[0].end < row.quantities[0].end_before
    assert (row.change.difference, row.share.share) == (0.0, 1.0)


def test_distributions_are_widened_about_their_middle() -> None:
    assert widened(Normal(1.0, 0.25, 0.5, 2.0), 2.0) == Normal(1.0, 0.5, 0.0, 3.0)
    assert widened(Uniform(1.0, 3.0), 1.5) == Uniform(0.5, 3.5)
    assert widened(Triangular(0.0, 1.0, 3.0), 2.0) == Triangular(-1.0, 1.0, 5.0)
    assert widened(Rayleigh(1.0, 3.0), 2.0) == Rayleigh(2.0, 6.0)
    assert widened(Discrete([1.0, 2.0]), 2.0) is None
    assert widened(Measured([1.0, 2.0]), 2.0) is None


def test_pitches_of_a_wider_class_are_larger_by_its_factor(tmp_path: Path) -> None:
    from gearwhine.case import load_case
    from gearwhine.case.load import bundled_case
    from gearwhine.variation.inputs import varied_inputs

    bundled = bundled_case("helical-pair")
    assert bundled is not None
    path = tmp_path / "pair.toml"
    path.write_text(bundled.read_text() + '[variation.vary]\n"gear.pinion.errors.pitch" = { class = 7 }\n')
    loaded = load_case(path)
    assert loaded.case.variation is not None
    (pitch,) = varied_inputs(loaded.source, loaded.case.variation)
    wider = pitch.widened(1.5)
    assert wider is not None
    assert wider.value(0.3) == pytest.approx(1.5 * pitch.value(0.3), rel=1e-9)


def test_the_interval_of_a_difference_holds_it_as_often_as_it_says() -> None:
    rng, truth, held = np.random.default_rng(4), 0.1, 0
    for _ in range(2000):
        u = rng.random(60)
        before, after = u < 0.7, (u > 0.05) & (u < 0.85)  # 0.15 gained, 0.05 lost
        difference = Difference.of(before, after)
        held += difference.low <= truth <= difference.high
    assert 0.93 <= held / 2000 <= 0.985
    by_hand = Difference.of(np.array([True] * 8 + [False] * 2), np.array([True] * 6 + [False] * 3 + [True]))
    # One gained and two lost of ten: -1/12 +- 1.96 sqrt((4/12 - 1/144)/12).
    assert by_hand.difference == pytest.approx(-0.1)
    assert by_hand.high - by_hand.low == pytest.approx(2.0 * 1.959964 * np.sqrt((4 / 12 - 1 / 144) / 12.0), rel=1e-6)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"widen": 1.0}, "widen is 1; expected a finite number above 1"),
        ({"widen": 99.0}, "at most 10"),
        ({"widen": 2.0, "indices": True}, "one of indices and widen"),
    ],
)
def test_impossible_wider_studies_are_refused(tmp_path: Path, options: dict[str, object], said: str) -> None:
    (tmp_path / "shaft.toml").write_text(SHAFT)
    with pytest.raises(ValueError, match=said):
        gw.load(tmp_path / "shaft.toml").vary(8, folder=tmp_path / "out", workers=1, **options)


def test_values_without_a_tolerance_cannot_be_widened(tmp_path: Path) -> None:
    text = SHAFT[: SHAFT.index("[variation.vary]")]
    text += '[variation.vary]\n"rotor.shaft.segments[0].diameter" = { values = ["29 mm", "31 mm"] }\n'
    (tmp_path / "shaft.toml").write_text(text)
    with pytest.raises(CaseError, match="an input with a tolerance"):
        gw.load(tmp_path / "shaft.toml").vary(8, widen=2.0, folder=tmp_path / "out", workers=1)
