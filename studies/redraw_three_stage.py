"""Redraw Figs. 4 to 12 of TM-101442 from the case `three-stage`: redraw_three_stage.py OUT [key.path=value ...]

Writes OUT/figure-04.png, orbits of the gears over the last revolutions; 05 and 06, mesh forces in time and frequency;
07 and 08, the first three torsional modal coordinates of stage 1 in time and frequency; 09, their shapes; 10, 11, 12,
the first lateral mode of each stage likewise. Frequency axes end at 1024 Hz, as the source's do.

Found: nine figures to lay beside the source's; which of its statements on them hold, and which do not, is listed in
docs/three-stage.md and tested in tests/validation/test_three_stage.py.
"""

import sys
from pathlib import Path

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import gearwhine as gw
from gearwhine.coupling import amplitude_spectrum
from gearwhine.coupling.signals.peaks import spectral_peaks

ORBIT_REVOLUTIONS = 5
LAST_HZ = 1024.0


def main(folder: str, *changes: str) -> None:
    study = gw.load("three-stage", ["transient.modal_coordinates=3", *changes])
    data = study.simulate().dataset
    forces = data["mesh_force"].isel(contact=slice(2))
    modal = data["modal_displacement"]
    torsion = modal.sel(modal_coordinate=[name for name in names(modal) if name.startswith("stage-1: torsion")])
    bending = modal.sel(modal_coordinate=[name for name in names(modal) if "bending 1," in name])
    last = ORBIT_REVOLUTIONS * 60.0 / float(data["speed"])
    figures = {
        4: orbits(data["gear_displacement"].sel(time=slice(float(data["time"][-1]) - last, None))),
        5: histories(forces, "mesh force [N]"),
        6: spectra(forces, "mesh force [N, peak]"),
        7: histories(torsion, "modal coordinate [rad √(kg m²)]"),
        8: spectra(torsion, "[rad √(kg m²), peak]"),
        9: shapes(data, "rotor_torsional_shape", [0], 3),
        10: histories(bending, "modal coordinate [m √kg]"),
        11: spectra(bending, "[m √kg, peak]"),
        12: shapes(data, "rotor_lateral_shape", [0, 1, 2], 1),
    }
    Path(folder).mkdir(parents=True, exist_ok=True)
    for number, figure in figures.items():
        figure.savefig(Path(folder) / f"figure-{number:02d}.png", dpi=150)
        print(Path(folder) / f"figure-{number:02d}.png")


def names(signals: xr.DataArray) -> list[str]:
    return [str(name) for name in signals[signals.dims[0]].values]


def rows(count: int, width: float = 10.0) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(width, 1.8 * count + 0.6), layout="constrained")
    return figure, list(figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0])


def orbits(motion: xr.DataArray) -> Figure:
    """The gears' centres about their means, all on one scale."""
    figure = Figure(figsize=(4.0 * motion.sizes["gear"], 4.2), layout="constrained")
    panels = figure.subplots(1, motion.sizes["gear"], sharex=True, sharey=True)
    for axes, name in zip(panels, names(motion), strict=True):
        gear = motion.sel(gear=name)
        orbit = 1e6 * (gear - gear.mean("time"))
        axes.plot(orbit.sel(axis="x"), orbit.sel(axis="y"), lw=0.6)
        axes.set(title=name, xlabel="x [µm]", ylabel="y [µm]", aspect="equal")
    return figure


def histories(signals: xr.DataArray, label: str) -> Figure:
    """The whole record, start included, with its mean."""
    figure, panels = rows(len(signals))
    for axes, name, signal in zip(panels, names(signals), signals.values, strict=True):
        axes.plot(signals["time"], signal, lw=0.4)
        axes.axhline(signal.mean(), color="red", lw=0.8)
        axes.set_title(f"{name}; red: the mean", fontsize=9, loc="left")
    panels[-1].set_xlabel("time [s]")
    figure.supylabel(label)
    return figure


def spectra(signals: xr.DataArray, label: str) -> Figure:
    """Amplitudes of the whole record under Hann's window; the mean stands in the title."""
    interval = float(signals["time"][1] - signals["time"][0])
    figure, panels = rows(len(signals))
    for axes, name, signal in zip(panels, names(signals), signals.values, strict=True):
        spectrum = amplitude_spectrum(signal, interval, "hann")
        # Hann's window spreads the mean over the line beside it.
        shown = (spectrum.frequencies > 2.0 * spectrum.frequencies[1]) & (spectrum.frequencies <= LAST_HZ)
        axes.plot(spectrum.frequencies[shown], spectrum.amplitude[shown], lw=0.9)
        for peak in spectral_peaks(spectrum, count=3, limit=LAST_HZ).rows:
            axes.annotate(f"{peak.frequency:.0f}", (peak.frequency, peak.amplitude), fontsize=8)
        axes.set_title(f"{name}; mean {signal.mean():.3g}", fontsize=9, loc="left")
        axes.set(xlim=(0.0, LAST_HZ), ylim=(0.0, None))
    panels[-1].set_xlabel("frequency [Hz]")
    figure.supylabel(label)
    return figure


def shapes(data: xr.Dataset, quantity: str, stages: list[int], count: int) -> Figure:
    """The first mode shapes of some stages along the shaft."""
    figure, panels = rows(len(stages), width=8.0)
    for axes, stage in zip(panels, stages, strict=True):
        rotor = data.isel(rotor=stage)
        axes.plot(1e3 * rotor["rotor_place"], rotor[quantity].values[:count].T)
        axes.axhline(0.0, color="grey", lw=0.6)
        axes.set_title(str(rotor["rotor"].values), fontsize=9, loc="left")
    panels[-1].set_xlabel("z from the left end [mm]")
    figure.supylabel(data[quantity].attrs["units"])
    return figure


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])
