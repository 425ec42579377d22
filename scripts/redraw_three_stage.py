"""Redraw Figs. 4 to 12 of TM-101442 from the case `three-stage`: redraw_three_stage.py OUT [key.path=value ...]

Writes OUT/figure-04.png, orbits at the gears over the last revolutions; 05 and 06, mesh forces in time and frequency;
07 and 08, the first three torsional modal coordinates of stage 1 in time and frequency; 09, their shapes; 10, 11, 12,
the first lateral mode of each stage likewise. Frequency axes end at 1024 Hz, as the source's do.
"""

import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

import coupling as room
from gearwhine.case import load_case
from gearwhine.failures import run_script
from gearwhine.figures.style import BLUE, GREY, RED, save, tidy
from gearwhine.output import staging
from gearwhine.stages.gears import solve_gears
from gearwhine.stages.machine import build_machine
from gearwhine.stages.transient import starting_state

FloatArray = npt.NDArray[np.float64]

_PER_REVOLUTION = 4096
_ORBIT = 5  # last revolutions of the orbits
_LAST_HZ = 1024.0
_NAMES = ("rigid rotation", "first elastic mode", "second elastic mode")


def main(folder: str, *changes: str) -> None:
    case = load_case("three-stage", changes).case
    if case.transient is None or case.operation is None:
        sys.exit("the case has no [transient] or no [operation]")
    machine = build_machine(case, None, solve_gears(case))
    period = 2.0 * np.pi / abs(case.operation.speed)
    settings = room.TransientSettings(
        duration=case.transient.revolutions * period,
        record_from=case.transient.discard * period,
        sample_interval=period / _PER_REVOLUTION,
        largest_step=period / case.transient.points_per_revolution,
        tolerance=case.transient.tolerance,
    )
    stages = [room.modal_rows(machine, rotor.name) for rotor in machine.rotors]
    lateral = [rows for stage in stages for rows in (stage.x[:1], stage.y[:1])]
    outputs = room.transient_outputs(machine)
    recorded = np.concatenate([outputs.displacement, stages[0].torsion[:3], *lateral])
    print("marching through the transient", file=sys.stderr)
    result = room.simulate(
        machine.system,
        settings,
        room.TransientOutputs(recorded, outputs.velocity, outputs.acceleration),
        initial=starting_state(case, machine),
    )
    named, modal = room.histories(machine, result), result.displacement[:, len(outputs.displacement) :].T
    forces = {name: named.mesh_force[name] for name in (contact.name for contact in machine.system.contacts[:2])}
    torsion = {f"{machine.rotors[0].name}, {name}": signal for name, signal in zip(_NAMES, modal[:3], strict=True)}
    bending = {
        f"{rotor.name}, first lateral mode in {plane}": modal[3 + 2 * number + side]
        for number, rotor in enumerate(machine.rotors)
        for side, plane in enumerate("xy")
    }
    figures = {
        4: _orbits(named, int(_ORBIT * _PER_REVOLUTION)),
        5: _histories(result.times, forces, "mesh force [N]"),
        6: _spectra(settings.sample_interval, forces, "mesh force [N, peak]"),
        7: _histories(result.times, torsion, "modal coordinate [rad √(kg m²)]"),
        8: _spectra(settings.sample_interval, torsion, "[rad √(kg m²), peak]"),
        9: _torsional_shapes(machine.rotors[0]),
        10: _histories(result.times, bending, "modal coordinate [m √kg]"),
        11: _spectra(settings.sample_interval, bending, "[m √kg, peak]"),
        12: _lateral_shapes(machine.rotors),
    }
    with staging(Path(folder)) as place:
        files = [save(figure, place / f"figure-{number:02d}.png") for number, figure in figures.items()]
    for file in files:
        print(Path(folder) / file)


def _orbits(named: room.Histories, last: int) -> Figure:
    """The gears' centres over the last samples, about their means, all on one scale."""
    figure = Figure(figsize=(4.0 * len(named.gear_motion), 4.2), layout="constrained")
    row = figure.subplots(1, len(named.gear_motion), sharex=True, sharey=True)
    for axes, (name, motion) in zip(row, named.gear_motion.items(), strict=True):
        orbit = 1e6 * (motion[-last:, :2] - motion[-last:, :2].mean(axis=0))
        axes.plot(orbit[:, 0], orbit[:, 1], color=BLUE, lw=0.6)
        axes.set(title=name, xlabel="x [µm]", aspect="equal")
        tidy(axes)
    row[0].set_ylabel("y [µm]")
    return figure


def _histories(times: FloatArray, signals: dict[str, FloatArray], unit: str) -> Figure:
    """The whole record, start included, with its mean."""
    figure = Figure(figsize=(10.0, 1.8 * len(signals) + 0.6), layout="constrained")
    rows = figure.subplots(len(signals), 1, sharex=True)
    for axes, (name, signal) in zip(rows, signals.items(), strict=True):
        axes.plot(times, signal, color=BLUE, lw=0.4)
        axes.axhline(signal.mean(), color=RED, lw=0.8)
        axes.set_title(f"{name}; red: the mean", fontsize=9, loc="left")
        tidy(axes)
    rows[-1].set_xlabel("time [s]")
    figure.supylabel(unit, fontsize=10)
    return figure


def _spectra(interval: float, signals: dict[str, FloatArray], unit: str) -> Figure:
    """Amplitudes of the whole record under Hann's window, without the mean, which is written beside the name."""
    figure = Figure(figsize=(10.0, 1.8 * len(signals) + 0.6), layout="constrained")
    rows = figure.subplots(len(signals), 1, sharex=True)
    for axes, (name, signal) in zip(rows, signals.items(), strict=True):
        spectrum = room.amplitude_spectrum(signal, interval, "hann")
        # Hann's window spreads the mean over the line beside it.
        shown = (spectrum.frequencies > 2.0 * spectrum.frequencies[1]) & (spectrum.frequencies <= _LAST_HZ)
        axes.plot(spectrum.frequencies[shown], spectrum.amplitude[shown], color=BLUE, lw=0.9)
        for peak in room.spectrum_peaks(spectrum, count=3, limit=_LAST_HZ):
            axes.annotate(f"{peak.frequency:.0f}", (peak.frequency, peak.amplitude), fontsize=8, color=GREY)
        axes.set_title(f"{name}; mean {signal.mean():.3g}", fontsize=9, loc="left")
        axes.set(xlim=(0.0, _LAST_HZ), ylim=(0.0, None))
        tidy(axes)
    rows[-1].set_xlabel("frequency [Hz]")
    figure.supylabel(unit, fontsize=10)
    return figure


def _torsional_shapes(rotor: room.RotorComponent) -> Figure:
    """Orthonormal torsional shapes of a stage."""
    z = np.linspace(0.0, rotor.modal.lateral.stations[-1], 400)
    figure = Figure(figsize=(8.0, 4.5), layout="constrained")
    axes = figure.subplots()
    shapes, frequencies = rotor.modal.torsional.evaluate(z)[:3], rotor.modal.torsional.frequencies[:3] / (2.0 * np.pi)
    for shape, frequency in zip(shapes, frequencies, strict=True):
        axes.plot(1e3 * z, shape, label=f"{frequency:.0f} Hz")
    axes.axhline(0.0, color=GREY, lw=0.6)
    axes.set(title=f"{rotor.name}: torsional modes", xlabel="z from the left end [mm]", ylabel="rad / √(kg m²)")
    axes.legend()
    tidy(axes)
    return figure


def _lateral_shapes(rotors: tuple[room.RotorComponent, ...]) -> Figure:
    """The first lateral shape of each stage on averaged supports, with its bearings."""
    figure = Figure(figsize=(8.0, 2.2 * len(rotors) + 0.4), layout="constrained")
    for axes, rotor in zip(figure.subplots(len(rotors), 1), rotors, strict=True):
        modes = rotor.modal.lateral
        z = np.linspace(0.0, modes.stations[-1], 400)
        axes.plot(1e3 * z, modes.evaluate(z)[0][0], color=BLUE)
        for support in modes.supports:
            axes.axvline(1e3 * support.at, color=GREY, lw=1.0, ls="--")
        axes.axhline(0.0, color=GREY, lw=0.6)
        axes.set_title(f"{rotor.name}, {modes.frequencies[0] / (2.0 * np.pi):.0f} Hz; dashed: bearings", fontsize=9)
        axes.set(xlabel="z from the left end [mm]", ylabel="1 / √kg")
        tidy(axes)
    return figure


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    run_script(main, sys.argv[1:])
