"""Run-up and run-down figures: waterfall over speed, and order slices."""

from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from coupling.signals import OrderMap, Spectrogram
from gearwhine.case import Case, mesh_frequencies
from gearwhine.figures.spectra import draw_waterfall
from gearwhine.figures.style import SERIES, tidy
from gearwhine.output import file_stems
from gearwhine.solve.housing_modes import SolvedHousing
from gearwhine.solve.run_up import RunSignature

FloatArray = npt.NDArray[np.float64]


def draw_run(case: Case, found: RunSignature, housing: SolvedHousing | None) -> Iterator[tuple[str, Figure]]:
    """Draw the waterfall and the orders of every signal of a run.

    Yields ``run-up-waterfall-SIGNAL`` and ``run-up-orders-SIGNAL``, each with its figure.
    """
    assert case.operation is not None
    turns_per_second = abs(case.operation.speed) / (2.0 * np.pi)
    mesh_orders = [frequency / turns_per_second for frequency in mesh_frequencies(case)]
    modes = None if housing is None else housing.modes.frequencies_hz
    names = [name.replace(" -> ", "-") for name in found.spectra]
    for stem, (name, spectra) in zip(file_stems(names), found.spectra.items(), strict=True):
        unit, title = found.units[name], f"{case.title}: {name}"
        waterfall = draw_run_up_waterfall(
            title,
            spectra,
            found.speeds_rpm,
            unit=unit,
            limit=float(spectra.frequencies[-1]),
            mesh_orders=mesh_orders,
            housing_frequencies=modes,
        )
        yield f"run-up-waterfall-{stem}", waterfall
        slices = draw_order_slices(title, found.orders[name], found.named, unit=unit)
        yield f"run-up-orders-{stem}", slices


def draw_run_up_waterfall(
    title: str,
    spectra: Spectrogram,
    speeds_rpm: FloatArray,
    *,
    unit: str,
    limit: float,
    mesh_orders: Sequence[float] = (),
    housing_frequencies: FloatArray | None = None,
) -> Figure:
    """Draw spectra along a run as rows over the speed, as :func:`draw_waterfall` does those of a sweep.

    Parameters
    ----------
    title
        Of the figure.
    spectra
        Of stretches along the run.
    speeds_rpm
        (t,): of the leading shaft in the middle of each stretch, distinct.
    unit
        Of the amplitudes.
    limit
        Of the frequency axis, Hz.
    mesh_orders
        Of each gear pair, cycles each turn of the leading shaft.
    housing_frequencies
        (n,): Hz.
    """
    shown = spectra.frequencies <= limit * (1.0 + 1e-9)
    rows = len(speeds_rpm)
    modes = np.empty(0) if housing_frequencies is None else housing_frequencies
    return draw_waterfall(
        title,
        speeds_rpm,
        np.tile(spectra.frequencies[shown], (rows, 1)),
        spectra.amplitude[:, shown],
        value_name="speed [rpm]",
        unit=unit,
        mesh_frequencies=np.outer(speeds_rpm / 60.0, mesh_orders) if mesh_orders else (),
        housing_frequencies=np.tile(modes, (rows, 1)) if modes.size else (),
    )


def draw_order_slices(title: str, orders: OrderMap, named: dict[str, float], *, unit: str) -> Figure:
    """Draw the amplitude of some orders over the speed of the leading shaft.

    Parameters
    ----------
    title
        Of the figure.
    orders
        Order spectra along the run.
    named
        Orders by their names.
    unit
        Of the amplitudes.

    Raises
    ------
    coupling.CouplingError
        Where an order is not a line of the map.
    """
    figure = Figure(figsize=(9.0, 4.6), layout="constrained")
    axes = figure.subplots()
    for number, (name, order) in enumerate(named.items()):
        color = SERIES[number % len(SERIES)]
        axes.plot(60.0 * orders.speeds, orders.order_slice(order), color=color, lw=1.2, label=name)
    axes.set_yscale("log")
    axes.set(xlabel="speed [rpm]", ylabel=f"amplitude [{unit}, peak]")
    tidy(axes)
    legend = figure.legend(loc="outside lower center", ncols=4, frameon=False, fontsize=8)
    for text in legend.get_texts():
        text.set_parse_math(False)
    figure.suptitle(title, fontsize=11, parse_math=False)
    return figure
