"""Figures of gear pairs: mesh stiffness and static transmission error."""

from pathlib import Path

from matplotlib.figure import Figure

from coupling.gears import mesh_stiffness
from gearwhine.figures.style import BLUE, GREY, save, tidy
from gearwhine.stages.gears import SolvedPair


def draw_gear_pairs(folder: Path, pairs: tuple[SolvedPair, ...]) -> list[str]:
    """Draw mesh stiffness and static transmission error of each pair over a mesh period."""
    figure = Figure(figsize=(8.0, 0.6 + 2.9 * len(pairs)), layout="constrained")
    rows = figure.subplots(len(pairs), 2, squeeze=False)
    for (left, right), pair in zip(rows, pairs, strict=True):
        phases = pair.static.phases
        left.plot(phases, 1e-6 * mesh_stiffness(pair.contact, phases), color=GREY, label="all pairs on the path")
        left.plot(phases, 1e-6 * pair.static.tangent_stiffness, color=BLUE, label="pairs that touch under load")
        left.set(xlabel="mesh period", ylabel="mesh stiffness [N/µm]", xlim=(0.0, 1.0), ylim=(0.0, None))
        left.set_title(f"{pair.given.driver} → {pair.given.driven}, {pair.given.stiffness.model}", fontsize=10)
        left.legend(frameon=False, fontsize=8)
        right.plot(phases, 1e6 * pair.static.transmission_error, color=BLUE)
        right.set(xlabel="mesh period", ylabel="transmission error [µm]", xlim=(0.0, 1.0))
        right.set_title(_static_title(pair), fontsize=10)
        for axes in (left, right):
            tidy(axes)
    return [save(figure, folder / "gear-pairs.png")]


def _static_title(pair: SolvedPair) -> str:
    title = f"static, at a mesh force of {pair.static.force:.0f} N"
    if pair.hunting is None:
        return title
    mean, swing = pair.hunting.mean_transmission_error, pair.hunting.peak_to_peak_transmission_error
    return (
        f"{title}, in the first mesh period\n"
        f"over the hunting period: {1e6 * mean:.3f} µm in the mean, {1e6 * swing:.3f} µm peak to peak"
    )
