"""Aims and limits of statistics over the gearboxes about a design, by closed forms of a shaft under two pulls.

Its left bearing has a force of 0.8 of the one pull and 0.2 of the other, which is normal about its designed value.
"""

from pathlib import Path

import pytest
from scipy import stats

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.case.optimisation import Aim
from gearwhine.coupling import CouplingError
from gearwhine.numerics.distributions import Discrete, Normal, Uniform
from gearwhine.optimisation.goals import goals_of
from gearwhine.optimisation.scatter import Scatter
from gearwhine.results.optimisation import sections
from gearwhine.variation.named_quantities import part_of, shown_quantity, statistic_of
from tests.machines.belted_shaft import BELTED_SHAFT

LEFT = "bearing.left.force_n"
DEVIATION = 0.2 * 50.0
DESIGN = """
[optimisation]
[optimisation.design]
"operation.force[0].x" = { values = ["800 N", "960 N", "980 N", "990 N"] }
[optimisation.robust]
samples = 32
[variation.vary]
"operation.force[1].x" = { normal = ["500 N", "50 N"] }
"""


def _found(tmp_path: Path, goals: str) -> "gw.Result":
    path = tmp_path / "shaft.toml"
    path.write_text(BELTED_SHAFT + DESIGN + goals)
    return gw.load(path).optimise(folder=tmp_path / "out", workers=1)


def test_statistics_are_those_of_the_normal_distribution(tmp_path: Path) -> None:
    goals = f"""
[optimisation.aim]
"mean of {LEFT}" = {{ sense = "least" }}
[optimisation.limit]
"standard deviation of {LEFT}" = {{ at_most = 20 }}
"quantile 0.9 of bearing.*.force_n" = {{ at_least = 1 }}
"""
    solved = _found(tmp_path, goals).solved
    mean = 0.8 * 800.0 + 0.2 * 500.0
    sides = solved.best.sides
    assert sides[f"mean of {LEFT}"] == pytest.approx((mean, mean), abs=0.05 * DEVIATION)
    assert sides[f"standard deviation of {LEFT}"][0] == pytest.approx(DEVIATION, rel=0.05)
    high = mean + stats.norm.ppf(0.9) * DEVIATION
    assert sides[f"quantile 0.9 of {LEFT}"][0] == pytest.approx(high, abs=0.15 * DEVIATION)
    # Without a measure of their own the two sides are two standard deviations away.
    assert sides[LEFT] == pytest.approx((mean - 2.0 * DEVIATION, mean + 2.0 * DEVIATION), abs=0.1 * DEVIATION)


def test_a_yield_holds_the_mean_from_the_limit_as_far_as_the_normal_distribution_says(tmp_path: Path) -> None:
    goals = f"""
[variation.limit]
"{LEFT}" = {{ at_most = 900 }}
[optimisation.aim]
"mean of {LEFT}" = {{ sense = "most" }}
[optimisation.limit]
"yield" = {{ at_least = 0.9 }}
"""
    found = _found(tmp_path, goals)
    yields = [design.sides["yield"][0] for design in found.solved.designs]
    means = [0.8 * pull + 0.2 * 500.0 for pull in (800.0, 960.0, 980.0, 990.0)]
    assert yields == pytest.approx([stats.norm.cdf((900.0 - mean) / DEVIATION) for mean in means], abs=2 / 32)
    assert [row["designs"] for row in found.document["keys"]] == [["980 N"]]
    (limit,) = found.document["limits"]
    assert (limit["name"], limit["designs"]) == ("yield", [yields[2]])
    # Clopper and Pearson: both ends are quantiles of beta distributions.
    good = round(32 * yields[2])
    low, high = stats.beta.ppf(0.025, good, 33 - good), stats.beta.ppf(0.975, good + 1, 32 - good)
    said = f"Yield: {good} of 32 gearboxes about the best design are within all limits, 95 % interval "
    assert any(
        f"{said}{100 * low:.0f} to {100 * high:.0f} %" in str(one) for one in sections(found.document)[0].content
    )
    assert list(found.dataset["quantity"].values[-2:]) == [f"mean of {LEFT}", "yield"]


def test_a_statistic_without_gearboxes_and_a_yield_without_limits_are_refused(tmp_path: Path) -> None:
    aims = {f"mean of {LEFT}": "least", "yield": "most"}
    with pytest.raises(CaseError) as refused:
        gw.optimise(lambda values: values, {"a": Uniform(0.0, 1.0)}, aims)
    assert len([one for one in refused.value.problems if "optimisation.robust" in one.expected]) == 2
    goals = '[optimisation.aim]\n"yield" = { sense = "most" }\n'
    with pytest.raises(CaseError, match=r"optimisation.aim.yield.*variation.limit"):
        _found(tmp_path, goals)


def test_a_statistic_is_shown_by_its_quantity() -> None:
    least = {"quantile 0.95 of sensor.t*.level_db": Aim(sense="least")}
    (goal,) = goals_of(least, {}, ["sensor.top of box.level_db", "sensor.top.level_db"]).aims
    assert goal.quantities == tuple(f"quantile 0.95 of sensor.{one}.level_db" for one in ("top of box", "top"))
    assert [statistic_of(one)[1] for one in goal.quantities] == ["sensor.top of box.level_db", "sensor.top.level_db"]
    assert part_of(goal.quantities[0]) == "sensor top of box"
    assert shown_quantity(goal.quantities[1])[0] == "quantile 0.95 of highest level over speed [dB re 1 µm/s²]"
    assert shown_quantity("standard deviation of sensor.top.level_db")[0].endswith("over speed [dB]")
    assert shown_quantity(f"mean of {LEFT}")[0] == "mean of force [N]"
    assert statistic_of("mean of ") == ("", "mean of ")


def test_numbers_of_python_scatter_about_their_designed_values() -> None:
    """A margin of a - b with both scattering, and a yield of it being positive, that the normal distribution gives."""

    def margin(values: dict[str, float]) -> dict[str, float]:
        return {"margin_m": values["a"] - values["b"]}

    scatter = Scatter({"a": Normal(0.0, 3.0), "b": Normal(10.0, 4.0)}, samples=256, good={"margin_m": (0.0, None)})
    steps = {"a": Discrete([10.0, 16.0, 18.0, 22.0])}
    found = gw.optimise(margin, steps, {"mean of margin_m": "least"}, limits={"yield": (0.9, None)}, scatter=scatter)
    designs = found.solved.designs
    assert [one.sides["mean of margin_m"][0] for one in designs] == pytest.approx([0.0, 6.0, 8.0, 12.0], abs=0.1)
    expected = [stats.norm.cdf(mean / 5.0) for mean in (0.0, 6.0, 8.0, 12.0)]
    assert [one.sides["yield"][0] for one in designs] == pytest.approx(expected, abs=0.02)
    assert found.document["keys"][0]["designs"] == ["18"]
    assert found.document["gearboxes_about_each"] == 256
    low, high = designs[1].sides["margin_m"]
    assert (low, high) == pytest.approx((6.0 - 2.0 * 5.0, 6.0 + 2.0 * 5.0), abs=0.4)


def test_a_scatter_that_cannot_be_is_refused() -> None:
    with pytest.raises(CouplingError, match=r"'a' as 3\.0; expected distributions"):
        Scatter({"a": 3.0})  # type: ignore[dict-item]
    with pytest.raises(CouplingError, match=r"quantile = 0\.4; expected"):
        Scatter({"a": Normal(0.0, 1.0)}, quantile=0.4)
    with pytest.raises(CouplingError, match="samples = 1"):
        Scatter({"a": Normal(0.0, 1.0)}, 1)
