"""Transient figures: spectra, mesh forces, orbits."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from gearwhine.case import Case, mesh_frequencies
from gearwhine.figures.contributions import draw_contributions
from gearwhine.figures.friction import draw_friction
from gearwhine.figures.modal_coordinates import draw_modal_coordinates
from gearwhine.figures.orbits import draw_orbits
from gearwhine.figures.sensor_spectra import draw_sensor_spectra
from gearwhine.figures.spectrum_lines import draw_lines
from gearwhine.figures.style import BLUE, RED, tidy
from gearwhine.stages.housing import SolvedHousing
from gearwhine.stages.signature import SolvedSignature, TracedLine
from gearwhine.stages.transient import SolvedTransient
from housing import Comparison

FloatArray = npt.NDArray[np.float64]

_ORBIT_SAMPLES = 1 << 14  # of a long record: a path of hundreds of thousands takes long to draw, and memory


def draw_transient(
    case: Case,
    solved: SolvedTransient,
    signature: SolvedSignature | None,
    housing: SolvedHousing | None,
    comparison: Comparison | None,
) -> Iterator[tuple[str, Figure]]:
    """Draw what a transient shows: yields the name of each figure, such as ``spectrum``, and the figure."""
    lines: dict[str, tuple[TracedLine, ...]] = dict.fromkeys(solved.sensor_spectra, ())
    if signature is not None:
        lines = signature.lines
    meshes = mesh_frequencies(case) if case.gear_pair else ()
    speed = _speed(case, solved)
    # Along a run no line stands still.
    marks = meshes if solved.turning is None else ()
    if solved.sensor_spectra:
        marked = _marked_modes(housing, comparison)
        found = "dominant" if comparison is None or comparison.shapes is None else "measured"
        legend = "housing modes" if comparison is None else f"{found} housing modes"
        heading = f"{case.title}, {speed}"
        spectra = draw_sensor_spectra(heading, solved, lines, mesh_frequencies=marks, marked=marked, marked_as=legend)
        yield "spectrum", spectra
    if any(lines.values()):
        parts = draw_contributions(f"{case.title}, {speed}", lines)
        yield "contributions", parts
    if solved.force_spectra:
        yield "mesh-force", _mesh_force(case, solved, meshes)
    carrying = [contact for contact in solved.machine.system.contacts if contact.name in solved.histories.mesh_friction]
    if rates := {contact.name: abs(contact.rate) for contact in carrying if contact.drives and contact.rate}:
        heading = f"{case.title}\nfriction between the teeth at {speed}"
        yield "friction", draw_friction(heading, solved.histories, rates)
    if solved.histories.gear_motion:
        motions = solved.histories.gear_motion
        if solved.record.sampling.is_long:
            motions = {name: motion[-_ORBIT_SAMPLES:] for name, motion in motions.items()}
        orbits = draw_orbits(f"{case.title}: orbits of the gears", motions)
        yield "orbits", orbits
    if solved.modal.coordinates:
        window = next(iter(solved.force_spectra.values())).window if solved.force_spectra else "hann"
        limit = min(solved.trusted_limit, 1.2 * max(meshes)) if meshes else solved.trusted_limit
        heading = f"{case.title}: modal coordinates"
        modal = draw_modal_coordinates(heading, solved.histories.times, solved.modal.coordinates, limit, window)
        yield "modal-coordinates", modal


def _mesh_force(case: Case, solved: SolvedTransient, meshes: tuple[float, ...]) -> Figure:
    drives = [solved.machine.system.contacts[number].name for number in solved.machine.loaded_contacts]
    figure = Figure(figsize=(9.0, 0.7 + 2.8 * len(drives)), layout="constrained")
    rows = figure.subplots(len(drives), 2, squeeze=False)
    times, speed = solved.histories.times, _speed(case, solved)
    for (left, right), name, frequency in zip(rows, drives, meshes, strict=True):
        shown, what = times <= times[0] + 6.0 / frequency, "six mesh periods"
        if solved.turning is not None:
            what = f"its first {6e3 / frequency:.3g} ms"
        left.plot(1e3 * (times[shown] - times[0]), solved.histories.mesh_force[name][shown], color=BLUE, lw=1.0)
        left.set(xlabel="time [ms]", ylabel="mesh force [N]")
        left.set_title(f"{name}: {what}", fontsize=10, loc="left")
        limit = min(4.2 * frequency, float(solved.force_spectra[name].frequencies[-1]))
        draw_lines(right, solved.force_spectra[name], limit)
        tidy(right)
        if solved.turning is None:
            _mark(right, meshes, limit)
        right.set(xlabel="frequency [Hz]", ylabel="mesh force [N, peak]")
        right.set_title("spectrum without its mean", fontsize=10, loc="left")
        tidy(left)
    figure.suptitle(f"{case.title}: gear-mesh force at {speed}", fontsize=11)
    return figure


def _mark(axes: Any, meshes: tuple[float, ...], limit: float) -> None:
    for frequency in meshes:
        for harmonic in range(1, int(limit / frequency) + 1):
            axes.axvline(harmonic * frequency, color=RED, lw=0.8, ls=(0, (4, 3)), zorder=0)


def _marked_modes(housing: SolvedHousing | None, comparison: Comparison | None) -> FloatArray:
    if comparison is not None:
        return np.array([pair.model for pair in comparison.pairs]) / (2.0 * np.pi)
    return np.empty(0) if housing is None else housing.modes.frequencies_hz


def _speed(case: Case, solved: SolvedTransient) -> str:
    """Speed and torque for a caption; of a run, the speeds that its record goes through."""
    assert case.operation is not None
    if solved.turning is not None:
        rates = solved.turning.at(solved.histories.times[[0, -1]])[1]
        first, last = case.operation.speed * rates * 60.0 / (2.0 * np.pi)
        return f"{first:.0f} to {last:.0f} rpm, averaged over the run"
    return f"{case.operation.speed * 60.0 / (2.0 * np.pi):.0f} rpm, {case.operation.torque:.4g} N·m"
