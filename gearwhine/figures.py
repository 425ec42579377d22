"""Figures of a run: spectra, mesh forces, orbits, mesh stiffness."""

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from coupling import Spectrum
from coupling.gears import mesh_stiffness
from gearwhine.case import Case, mesh_frequencies
from gearwhine.stages.gears import SolvedPair
from gearwhine.stages.housing import SolvedHousing
from gearwhine.stages.transient import SolvedTransient
from housing import Comparison

FloatArray = npt.NDArray[np.float64]

_INK, _BLUE, _RED, _GREY = "#202428", "#1f5a96", "#b5382a", "#8a9097"
_DECADES = 5.0  # of a logarithmic amplitude axis, below its highest line


def draw_transient(
    folder: Path,
    case: Case,
    solved: SolvedTransient,
    housing: SolvedHousing | None,
    comparison: Comparison | None,
) -> list[str]:
    """Draw what a transient shows; returns the files' names."""
    files = []
    meshes = mesh_frequencies(case) if case.gear_pair else ()
    if solved.sensor_spectra:
        marked = _marked_modes(housing, comparison)
        legend = "housing modes" if comparison is None else "dominant housing modes"
        files.append(_save(_spectra(case, solved, meshes, marked, legend), folder / "spectrum.png"))
    if solved.force_spectra:
        files.append(_save(_mesh_force(case, solved, meshes), folder / "mesh-force.png"))
    if solved.histories.gear_motion:
        files.append(_save(_orbits(solved), folder / "orbits.png"))
    return files


def draw_gear_pairs(folder: Path, pairs: tuple[SolvedPair, ...]) -> list[str]:
    """Draw mesh stiffness and static transmission error of each pair over a mesh period."""
    figure = Figure(figsize=(8.0, 0.6 + 2.9 * len(pairs)), layout="constrained")
    rows = figure.subplots(len(pairs), 2, squeeze=False)
    for (left, right), pair in zip(rows, pairs, strict=True):
        phases = pair.static.phases
        left.plot(phases, 1e-6 * mesh_stiffness(pair.contact, phases), color=_GREY, label="all pairs on the path")
        left.plot(phases, 1e-6 * pair.static.tangent_stiffness, color=_BLUE, label="pairs that touch under load")
        left.set(xlabel="mesh period", ylabel="mesh stiffness [N/µm]", xlim=(0.0, 1.0), ylim=(0.0, None))
        left.set_title(f"{pair.given.driver} → {pair.given.driven}, {pair.given.stiffness.model}", fontsize=10)
        left.legend(frameon=False, fontsize=8)
        right.plot(phases, 1e6 * pair.static.transmission_error, color=_BLUE)
        right.set(xlabel="mesh period", ylabel="transmission error [µm]", xlim=(0.0, 1.0))
        right.set_title(_static_title(pair), fontsize=10)
        for axes in (left, right):
            _tidy(axes)
    return [_save(figure, folder / "gear-pairs.png")]


def _static_title(pair: SolvedPair) -> str:
    title = f"static, at a mesh force of {pair.static.force:.0f} N"
    if pair.hunting is None:
        return title
    mean, swing = pair.hunting.mean_transmission_error, pair.hunting.peak_to_peak_transmission_error
    return (
        f"{title}, in the first mesh period\n"
        f"over the hunting period: {1e6 * mean:.3f} µm in the mean, {1e6 * swing:.3f} µm peak to peak"
    )


def _spectra(
    case: Case, solved: SolvedTransient, meshes: tuple[float, ...], marked: FloatArray, marked_as: str
) -> Figure:
    count = len(solved.sensor_spectra)
    figure = Figure(figsize=(9.0, 0.9 + 2.5 * count), layout="constrained")
    axes_list = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    limit = solved.trusted_limit
    for axes, (name, spectrum) in zip(axes_list, solved.sensor_spectra.items(), strict=True):
        _draw_lines(axes, spectrum, limit)
        axes.set_ylabel("acceleration\n[m/s², peak]")
        axes.set_title(name, fontsize=10, loc="left")
        _mark(axes, meshes, limit)
        for frequency in marked:
            axes.plot([frequency], [0.985], marker=7, color=_GREY, markersize=6, transform=axes.get_xaxis_transform())
    axes_list[-1].set_xlabel("frequency [Hz]")
    figure.suptitle(f"{case.title}: housing acceleration at {_speed(case)}", fontsize=11)
    legend = "dashed: mesh frequency and its harmonics"
    if marked.size:
        legend += f"    ▾ {marked_as}"
    axes_list[0].set_title(legend, fontsize=8, loc="right", color=_GREY)
    return figure


def _mesh_force(case: Case, solved: SolvedTransient, meshes: tuple[float, ...]) -> Figure:
    drives = [contact.name for contact in solved.machine.system.contacts[: len(solved.machine.meshes)]]
    figure = Figure(figsize=(9.0, 0.7 + 2.8 * len(drives)), layout="constrained")
    rows = figure.subplots(len(drives), 2, squeeze=False)
    times = solved.histories.times
    for (left, right), name, frequency in zip(rows, drives, meshes, strict=True):
        shown = times <= times[0] + 6.0 / frequency
        left.plot(1e3 * (times[shown] - times[0]), solved.histories.mesh_force[name][shown], color=_BLUE, lw=1.0)
        left.set(xlabel="time [ms]", ylabel="mesh force [N]")
        left.set_title(f"{name}: six mesh periods", fontsize=10, loc="left")
        limit = 4.2 * frequency
        _draw_lines(right, solved.force_spectra[name], limit)
        _mark(right, meshes, limit)
        right.set(xlabel="frequency [Hz]", ylabel="mesh force [N, peak]")
        right.set_title("spectrum without its mean", fontsize=10, loc="left")
        _tidy(left)
    figure.suptitle(f"{case.title}: gear-mesh force at {_speed(case)}", fontsize=11)
    return figure


def _orbits(solved: SolvedTransient) -> Figure:
    motions = solved.histories.gear_motion
    figure = Figure(figsize=(4.2 * len(motions), 4.4), layout="constrained")
    row = figure.subplots(1, len(motions), squeeze=False)[0]
    reach = 0.0
    for axes, (name, motion) in zip(row, motions.items(), strict=True):
        center = motion[:, :2].mean(axis=0)
        orbit = 1e6 * (motion[:, :2] - center)
        axes.plot(orbit[:, 0], orbit[:, 1], color=_BLUE, lw=0.5)
        axes.set(xlabel="x [µm]", ylabel="y [µm]", aspect="equal")
        axes.set_title(f"{name}\nabout its mean at ({1e6 * center[0]:.1f}, {1e6 * center[1]:.1f}) µm", fontsize=10)
        _tidy(axes)
        reach = max(reach, 1.08 * float(np.abs(orbit).max()))
    for axes in row:
        axes.set(xlim=(-reach, reach), ylim=(-reach, reach))
    return figure


def _draw_lines(axes: Any, spectrum: Spectrum, limit: float) -> None:
    shown = (spectrum.frequencies > 0.0) & (spectrum.frequencies <= limit)
    frequencies, amplitude = spectrum.frequencies[shown], spectrum.amplitude[shown]
    top = float(amplitude.max(initial=0.0))
    if top > 0.0:
        axes.set_yscale("log")
        axes.set_ylim(top * 10.0**-_DECADES, top * 3.0)
        floor = top * 10.0**-_DECADES
        axes.vlines(frequencies, floor, np.maximum(amplitude, floor), color=_BLUE, lw=0.9)
    axes.set_xlim(0.0, limit)
    _tidy(axes)


def _mark(axes: Any, meshes: tuple[float, ...], limit: float) -> None:
    for frequency in meshes:
        for harmonic in range(1, int(limit / frequency) + 1):
            axes.axvline(harmonic * frequency, color=_RED, lw=0.8, ls=(0, (4, 3)), zorder=0)


def _marked_modes(housing: SolvedHousing | None, comparison: Comparison | None) -> FloatArray:
    if comparison is not None:
        return np.array([pair.model for pair in comparison.pairs]) / (2.0 * np.pi)
    return np.empty(0) if housing is None else housing.modes.frequencies_hz


def _tidy(axes: Any) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(colors=_INK, labelsize=9)
    axes.grid(visible=True, color="#e4e7ea", lw=0.6)
    axes.set_axisbelow(True)


def _speed(case: Case) -> str:
    assert case.operation is not None
    return f"{case.operation.speed * 60.0 / (2.0 * np.pi):.0f} rpm, {case.operation.torque:.4g} N·m"


def _save(figure: Figure, path: Path) -> str:
    figure.savefig(path, dpi=130)
    return path.name
