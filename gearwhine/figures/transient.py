"""Figures of a transient: spectra, mesh forces, orbits."""

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from coupling import Spectrum
from gearwhine.case import Case, mesh_frequencies
from gearwhine.figures.style import BLUE, GREY, RED, save, tidy
from gearwhine.stages.housing import SolvedHousing
from gearwhine.stages.transient import SolvedTransient
from housing import Comparison

FloatArray = npt.NDArray[np.float64]

_ORBIT_SAMPLES = 1 << 14  # of a long record: a path of hundreds of thousands takes long to draw, and memory
_MOST_LINES = 1 << 12
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
        files.append(save(_spectra(case, solved, meshes, marked, legend), folder / "spectrum.png"))
    if solved.force_spectra:
        files.append(save(_mesh_force(case, solved, meshes), folder / "mesh-force.png"))
    if solved.histories.gear_motion:
        files.append(save(_orbits(solved), folder / "orbits.png"))
    return files


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
            axes.plot([frequency], [0.985], marker=7, color=GREY, markersize=6, transform=axes.get_xaxis_transform())
    axes_list[-1].set_xlabel("frequency [Hz]")
    figure.suptitle(f"{case.title}: housing acceleration at {_speed(case)}", fontsize=11)
    legend = "dashed: mesh frequency and its harmonics"
    if marked.size:
        legend += f"    ▾ {marked_as}"
    axes_list[0].set_title(legend, fontsize=8, loc="right", color=GREY)
    return figure


def _mesh_force(case: Case, solved: SolvedTransient, meshes: tuple[float, ...]) -> Figure:
    drives = [contact.name for contact in solved.machine.system.contacts[: len(solved.machine.meshes)]]
    figure = Figure(figsize=(9.0, 0.7 + 2.8 * len(drives)), layout="constrained")
    rows = figure.subplots(len(drives), 2, squeeze=False)
    times = solved.histories.times
    for (left, right), name, frequency in zip(rows, drives, meshes, strict=True):
        shown = times <= times[0] + 6.0 / frequency
        left.plot(1e3 * (times[shown] - times[0]), solved.histories.mesh_force[name][shown], color=BLUE, lw=1.0)
        left.set(xlabel="time [ms]", ylabel="mesh force [N]")
        left.set_title(f"{name}: six mesh periods", fontsize=10, loc="left")
        limit = min(4.2 * frequency, float(solved.force_spectra[name].frequencies[-1]))
        _draw_lines(right, solved.force_spectra[name], limit)
        _mark(right, meshes, limit)
        right.set(xlabel="frequency [Hz]", ylabel="mesh force [N, peak]")
        right.set_title("spectrum without its mean", fontsize=10, loc="left")
        tidy(left)
    figure.suptitle(f"{case.title}: gear-mesh force at {_speed(case)}", fontsize=11)
    return figure


def _orbits(solved: SolvedTransient) -> Figure:
    motions = solved.histories.gear_motion
    if solved.record.sampling.is_long:
        motions = {name: motion[-_ORBIT_SAMPLES:] for name, motion in motions.items()}
    figure = Figure(figsize=(4.2 * len(motions), 4.4), layout="constrained")
    row = figure.subplots(1, len(motions), squeeze=False)[0]
    reach = 0.0
    for axes, (name, motion) in zip(row, motions.items(), strict=True):
        center = motion[:, :2].mean(axis=0)
        orbit = 1e6 * (motion[:, :2] - center)
        axes.plot(orbit[:, 0], orbit[:, 1], color=BLUE, lw=0.5)
        axes.set(xlabel="x [µm]", ylabel="y [µm]", aspect="equal")
        axes.set_title(f"{name}\nabout its mean at ({1e6 * center[0]:.1f}, {1e6 * center[1]:.1f}) µm", fontsize=10)
        tidy(axes)
        reach = max(reach, 1.08 * float(np.abs(orbit).max()))
    for axes in row:
        axes.set(xlim=(-reach, reach), ylim=(-reach, reach))
    return figure


def _draw_lines(axes: Any, spectrum: Spectrum, limit: float) -> None:
    shown = (spectrum.frequencies > 0.0) & (spectrum.frequencies <= limit)
    frequencies, amplitude = spectrum.frequencies[shown], spectrum.amplitude[shown]
    if (together := len(amplitude) // _MOST_LINES) > 1:
        # Of lines closer than the eye can part the highest is drawn: a path of all takes hundreds of megabytes.
        groups = amplitude[: len(amplitude) // together * together].reshape(-1, together)
        highest = np.arange(len(groups)) * together + groups.argmax(axis=1)
        frequencies, amplitude = frequencies[highest], amplitude[highest]
    top = float(amplitude.max(initial=0.0))
    if top > 0.0:
        axes.set_yscale("log")
        axes.set_ylim(top * 10.0**-_DECADES, top * 3.0)
        floor = top * 10.0**-_DECADES
        # One broken line, which is drawn several times sooner than thousands of them.
        heights = np.stack(
            [np.full_like(amplitude, floor), np.maximum(amplitude, floor), np.full_like(amplitude, np.nan)]
        )
        axes.plot(np.repeat(frequencies, 3), heights.T.ravel(), color=BLUE, lw=0.9, solid_capstyle="butt")
    axes.set_xlim(0.0, limit)
    tidy(axes)


def _mark(axes: Any, meshes: tuple[float, ...], limit: float) -> None:
    for frequency in meshes:
        for harmonic in range(1, int(limit / frequency) + 1):
            axes.axvline(harmonic * frequency, color=RED, lw=0.8, ls=(0, (4, 3)), zorder=0)


def _marked_modes(housing: SolvedHousing | None, comparison: Comparison | None) -> FloatArray:
    if comparison is not None:
        return np.array([pair.model for pair in comparison.pairs]) / (2.0 * np.pi)
    return np.empty(0) if housing is None else housing.modes.frequencies_hz


def _speed(case: Case) -> str:
    assert case.operation is not None
    return f"{case.operation.speed * 60.0 / (2.0 * np.pi):.0f} rpm, {case.operation.torque:.4g} N·m"
