"""Run-up and run-down figures: level map over frequency and speed, order cuts and overall level."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure

from gearwhine.coupling.analyses.run_up import RunSignature
from gearwhine.coupling.analyses.transient import SolvedTransient
from gearwhine.coupling.signals import OrderMap, Spectrogram, decibels, peak_of_rms
from gearwhine.figures.spectra import draw_level_map
from gearwhine.figures.style import (
    FOOT,
    HEAD,
    INK,
    SERIES,
    legend_below,
    legend_height,
    name_in_legend,
    panel,
    sheet,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.output import file_stems
from gearwhine.output.sections import arrowed

_HEIGHT = 80.0  # height of the panel of order slices [mm of paper]
_COLUMNS = 3  # columns of their legend
_LEAST_SPEED_STEP = 0.2  # least step of the speed between two spectra for an axis of speed, as a part of the mean step
_FAINT_ORDER = 40.0  # decibels below the overall level at the same speed from which on an order is left out
_LEVELS = 100.0  # decibels below the highest level that they show at most
_TIME = "time [s]"


def draw_run(title: str, solved: SolvedTransient, run: RunSignature) -> Iterator[tuple[str, Figure]]:
    """Draw the level map and the orders of every signal of a run.

    Yields ``run-up-map-SIGNAL`` and ``run-up-orders-SIGNAL``, each with its figure.
    """
    machine = solved.machine
    turns_per_second = abs(solved.speed) / (2.0 * np.pi)
    contacts = machine.system.contacts[: len(machine.meshes)]
    mesh_orders = [abs(contact.mesh_frequency) / turns_per_second for contact in contacts]
    modes = None if machine.housing is None else machine.housing.frequencies_hz
    names = [name.replace(" -> ", "-") for name in run.spectra]
    pairs = [f"{mesh.driver.name} → {mesh.driven.name}" for mesh in machine.meshes]
    for stem, (name, spectra) in zip(file_stems(names), run.spectra.items(), strict=True):
        unit, signal_name, remark = run.units[name], arrowed(name), f"{title}; {run_words(run, free=solved.free_run)}"
        level_map = draw_run_up_map(
            f"{signal_name}: level over frequency and speed",
            spectra,
            run.speeds_rpm,
            note=remark,
            mesh_names=pairs,
            unit=unit,
            mesh_orders=mesh_orders,
            housing_frequencies=modes,
        )
        yield f"run-up-map-{stem}", level_map
        if any(np.isnan(table).any() for table in run.orders[name].followed.values()):
            remark = f"{remark}; up to {run.limit:.0f} Hz, where the model is complete"
        slices = draw_order_slices(
            f"{signal_name}: orders",
            run.orders[name],
            run.named,
            unit=unit,
            note=remark,
            overall=(spectra.times, run.overall[name]),
        )
        yield f"run-up-orders-{stem}", slices


def run_words(signature: RunSignature, *, free: bool) -> str:
    """Return the kind of a run and the range of its spectra in words."""
    first, last = float(signature.speeds_rpm[0]), float(signature.speeds_rpm[-1])
    kind = "run-up" if abs(last) > abs(first) else "run-down"
    if free:
        kind = "free run"
    return f"{kind}, spectra from {first:.0f} to {last:.0f} rpm"


def _axis(speeds_rpm: FloatArray, times: FloatArray) -> tuple[FloatArray, str]:
    """Values and name of the axis along a run: the speed where it changes evenly enough, else the time.

    Spectra of a machine that settles at a speed, or returns to one, would lie on each other over the speed.
    """
    steps = np.diff(speeds_rpm)
    even = steps.size > 0 and np.abs(steps).min() >= _LEAST_SPEED_STEP * np.abs(steps).mean()
    if even and (np.all(steps > 0.0) or np.all(steps < 0.0)):
        return speeds_rpm, "speed of the first driver [rpm]"
    return times, _TIME


def draw_run_up_map(
    title: str,
    spectra: Spectrogram,
    speeds_rpm: FloatArray,
    *,
    unit: str,
    note: str = "",
    mesh_orders: Sequence[float] = (),
    mesh_names: Sequence[str] = (),
    housing_frequencies: FloatArray | None = None,
) -> Figure:
    """Draw the level of spectra along a run over frequency and speed, or time where the speed settles.

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
    note : str
        Note below the title.
    mesh_orders, mesh_names : sequence
        Orders of each gear pair in cycles each turn of the leading shaft, and names of the pairs.
    housing_frequencies : ndarray, shape (n,), optional
        Natural frequencies of the housing [Hz].
    """
    values, value_name = _axis(speeds_rpm, spectra.times)
    return draw_level_map(
        title,
        values,
        spectra.frequencies,
        spectra.amplitude,
        value_name=value_name,
        unit=unit,
        note=note,
        mesh_names=mesh_names,
        mesh_frequencies=np.outer(np.abs(speeds_rpm) / 60.0, mesh_orders) if mesh_orders else (),
        housing_frequencies=housing_frequencies,
    )


def draw_order_slices(
    title: str,
    orders: OrderMap,
    named: dict[str, float],
    *,
    unit: str,
    note: str = "",
    overall: tuple[FloatArray, FloatArray] | None = None,
) -> Figure:
    """Draw the level of some orders over the speed of the leading shaft, or the time where it settles.

    Orders that nowhere reach the lower end of the axis, or 40 dB below the overall level, are left out, and so is what
    is not known of one, its NaN.

    Parameters
    ----------
    title : str
        Title of the sheet.
    orders : OrderMap
        Order spectra along the run.
    named : dict of str to float
        Orders by their names.
    unit : str
        Unit of the amplitudes; levels are re a millionth of it.
    note : str
        Note below the title.
    overall : (times, rms), ndarrays of shape (t,), optional
        Overall rms at times of the run [s].

    Raises
    ------
    gearwhine.coupling.CouplingError
        Where an order is not a line of the map.
    """
    courses = {name: decibels(orders.order_slice(order)) for name, order in named.items()}
    known = {name: course[np.isfinite(course)] for name, course in courses.items()}
    values, value_name = _axis(60.0 * orders.speeds, orders.times)
    whole = np.empty(0) if overall is None else decibels(peak_of_rms(overall[1]))
    top = max((float(course.max()) for course in (*known.values(), whole) if course.size), default=0.0)
    bottom = top - _LEVELS
    level = np.full(values.size, -np.inf) if overall is None else np.interp(orders.times, overall[0], whole)
    visible = [
        name
        for name, course in courses.items()
        if known[name].size and known[name].max() > bottom and np.nanmax(course - level) > -_FAINT_ORDER
    ]
    below = legend_height(len(visible) + bool(whole.size), _COLUMNS)
    figure = sheet(HEAD + _HEIGHT + FOOT + below, title, note)
    axes = panel(figure, FOOT + below, _HEIGHT)
    handles = []
    for number, name in enumerate(visible):
        style = "-" if number < len(SERIES) else (0, (4, 2))
        handles += axes.plot(
            values, courses[name], color=SERIES[number % len(SERIES)], ls=style, lw=1.2, label=name_in_legend(name, 40)
        )
    if overall is not None:
        at = overall[0] if value_name == _TIME else np.interp(overall[0], orders.times, values)
        handles += axes.plot(at, whole, color=INK, lw=1.8, zorder=1.5, label="overall")
    axes.set_xlim(float(values.min()), float(values.max()))
    axes.set(xlabel=value_name, ylabel=f"level [dB re 1 µ{unit}]")
    lowest = min((float(known[name].min()) for name in visible), default=bottom)
    axes.set_ylim(max(lowest - 3.0, bottom), top + 5.0)
    legend_below(figure, handles, _COLUMNS)
    return figure
