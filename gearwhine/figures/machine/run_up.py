"""Run-up and run-down figures: waterfall over speed, and order slices."""

from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from coupling.signals import OrderMap, Spectrogram
from gearwhine.case import Case, mesh_frequencies
from gearwhine.figures.spectra import draw_waterfall
from gearwhine.figures.style import (
    FOOT,
    HEAD,
    SERIES,
    legend_below,
    legend_height,
    log_axis,
    name_in_legend,
    panel,
    sheet,
)
from gearwhine.output import file_stems
from gearwhine.output.sections import arrowed
from gearwhine.solve.housing_modes import SolvedHousing
from gearwhine.solve.run_up import RunSignature

FloatArray = npt.NDArray[np.float64]

_HEIGHT = 80.0  # height of the panel of order slices [mm of paper]
_COLUMNS = 3  # columns of their legend
_EVEN = 0.2  # least step of the speed between two spectra for an axis of speed, as a part of the mean step
_DECADES = 5.0  # decades of amplitude that they show at most


def draw_run(case: Case, run: RunSignature, housing: SolvedHousing | None) -> Iterator[tuple[str, Figure]]:
    """Draw the waterfall and the orders of every signal of a run.

    Yields ``run-up-waterfall-SIGNAL`` and ``run-up-orders-SIGNAL``, each with its figure.
    """
    assert case.operation is not None
    turns_per_second = abs(case.operation.speed) / (2.0 * np.pi)
    mesh_orders = [frequency / turns_per_second for frequency in mesh_frequencies(case)]
    modes = None if housing is None else housing.modes.frequencies_hz
    names = [name.replace(" -> ", "-") for name in run.spectra]
    pairs = [f"{pair.driver} → {pair.driven}" for pair in case.gear_pair]
    for stem, (name, spectra) in zip(file_stems(names), run.spectra.items(), strict=True):
        unit, signal_name, remark = run.units[name], arrowed(name), f"{case.title}; {run_words(case, run)}"
        waterfall = draw_run_up_waterfall(
            f"{signal_name}: spectra along the run",
            spectra,
            run.speeds_rpm,
            note=remark,
            mesh_names=pairs,
            unit=unit,
            limit=float(spectra.frequencies[-1]),
            mesh_orders=mesh_orders,
            housing_frequencies=modes,
        )
        yield f"run-up-waterfall-{stem}", waterfall
        if any(np.isnan(table).any() for table in run.orders[name].followed.values()):
            remark = f"{remark}; up to {run.limit:.0f} Hz, where the model is complete"
        slices = draw_order_slices(f"{signal_name}: orders", run.orders[name], run.named, unit=unit, note=remark)
        yield f"run-up-orders-{stem}", slices


def run_words(case: Case, signature: RunSignature) -> str:
    """Return the kind of a run and the range of its spectra in words."""
    first, last = float(signature.speeds_rpm[0]), float(signature.speeds_rpm[-1])
    run = None if case.transient is None else case.transient.run
    kind = "run-up" if abs(last) > abs(first) else "run-down"
    if run is not None and run.free:
        kind = "free run"
    return f"{kind}, spectra from {first:.0f} to {last:.0f} rpm"


def _axis(speeds_rpm: FloatArray, times: FloatArray) -> tuple[FloatArray, str]:
    """Values and name of the axis along a run: the speed where it changes evenly enough, else the time.

    Spectra of a machine that settles at a speed, or returns to one, would lie on each other over the speed.
    """
    steps = np.diff(speeds_rpm)
    even = steps.size > 0 and np.abs(steps).min() >= _EVEN * np.abs(steps).mean()
    if even and (np.all(steps > 0.0) or np.all(steps < 0.0)):
        return speeds_rpm, "speed of the first driver [rpm]"
    return times, "time [s]"


def draw_run_up_waterfall(
    title: str,
    spectra: Spectrogram,
    speeds_rpm: FloatArray,
    *,
    unit: str,
    limit: float,
    note: str = "",
    mesh_orders: Sequence[float] = (),
    mesh_names: Sequence[str] = (),
    housing_frequencies: FloatArray | None = None,
) -> Figure:
    """Draw spectra along a run as rows over speed or time, as :func:`draw_waterfall` does those of a sweep.

    Parameters
    ----------
    title : str
        Title of the figure.
    spectra : Spectrogram
        Spectra of stretches along the run.
    speeds_rpm : ndarray, shape (t,)
        Speeds of the leading shaft in the middle of each stretch [rpm].
    unit : str
        Unit of the amplitudes.
    limit : float
        Limit of the frequency axis [Hz].
    note : str
        Begin of the note below the title.
    mesh_orders, mesh_names : sequence
        Orders of each gear pair in cycles each turn of the leading shaft, and names of the pairs.
    housing_frequencies : ndarray, shape (n,), optional
        Natural frequencies of the housing [Hz].
    """
    inside = spectra.frequencies <= limit * (1.0 + 1e-9)
    rows = len(speeds_rpm)
    modes = np.empty(0) if housing_frequencies is None else housing_frequencies
    values, value_name = _axis(speeds_rpm, spectra.times)
    return draw_waterfall(
        title,
        values,
        np.tile(spectra.frequencies[inside], (rows, 1)),
        spectra.amplitude[:, inside],
        value_name=value_name,
        unit=unit,
        note=note,
        mesh_names=mesh_names,
        mesh_frequencies=np.outer(np.abs(speeds_rpm) / 60.0, mesh_orders) if mesh_orders else (),
        housing_frequencies=np.tile(modes, (rows, 1)) if modes.size else (),
    )


def draw_order_slices(title: str, orders: OrderMap, named: dict[str, float], *, unit: str, note: str = "") -> Figure:
    """Draw the amplitude of some orders over the speed of the leading shaft, or the time where it settles.

    Orders that nowhere reach the lower end of the axis are left out, and so is what is not known of one, its NaN.

    Parameters
    ----------
    title : str
        Title of the sheet.
    orders : OrderMap
        Order spectra along the run.
    named : dict of str to float
        Orders by their names.
    unit : str
        Unit of the amplitudes.
    note : str
        Note below the title.

    Raises
    ------
    coupling.CouplingError
        Where an order is not a line of the map.
    """
    courses = {name: orders.order_slice(order) for name, order in named.items()}
    known = {name: course[np.isfinite(course)] for name, course in courses.items()}
    top = max((float(course.max(initial=0.0)) for course in known.values()), default=0.0)
    bottom = top * 10.0**-_DECADES
    visible = [name for name, course in known.items() if course.size and (course.max() > bottom or top == 0.0)]
    below = legend_height(len(visible), _COLUMNS)
    figure = sheet(HEAD + _HEIGHT + FOOT + below, title, note)
    axes = panel(figure, FOOT + below, _HEIGHT)
    values, value_name = _axis(60.0 * orders.speeds, orders.times)
    handles = []
    for number, name in enumerate(visible):
        style = "-" if number < len(SERIES) else (0, (4, 2))
        handles += axes.plot(
            values, courses[name], color=SERIES[number % len(SERIES)], ls=style, lw=1.2, label=name_in_legend(name, 40)
        )
    axes.set_xlim(float(values.min()), float(values.max()))
    axes.set(xlabel=value_name, ylabel=f"amplitude [{unit}, peak]")
    if top > 0.0:
        least = min(float(known[name].min()) for name in visible)
        log_axis(axes, max(0.7 * least, bottom), 2.0 * top)
    legend_below(figure, handles, _COLUMNS)
    return figure
