"""Transient figures: sensor spectra, transfer paths, tooth friction, modal coordinates and orbits.

- Sensor spectra, a panel each, with their leading lines named above.
- Transfer-path contributions of housing modes and bearings to the leading lines of the sensors, as bars.
- Tooth friction over time: force across the line of action, and power loss.
- Modal coordinates in time and frequency, after Figs. 7, 8, 10 and 11 of NASA TM-101442.
- Orbits of gears: the mean position of each centre, and its motion about it.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from numpy.lib.stride_tricks import sliding_window_view

from gearwhine.coupling import amplitude_spectrum
from gearwhine.coupling.analyses.signature import Contribution, SolvedSignature, TracedLine
from gearwhine.coupling.analyses.transient import SolvedTransient
from gearwhine.coupling.signals import decibels
from gearwhine.coupling.signals.spectrum import Window, signal_parts
from gearwhine.coupling.time.histories import Histories
from gearwhine.figures.spectra import draw_lines
from gearwhine.figures.style import (
    BLUE,
    FOOT,
    GREY,
    HEAD,
    INK,
    LABEL,
    LEFT,
    MICRO,
    MILLI,
    NOTE,
    PANEL_WIDTH,
    RED,
    SERIES,
    SHEET_WIDTH,
    Label,
    arrange,
    draw_row,
    legend,
    panel,
    panel_pair,
    panel_size,
    panel_title,
    plain,
    sheet,
    sheet_height,
    shortened,
)
from gearwhine.housing import HousingModes
from gearwhine.housing.correlation.comparison import Comparison
from gearwhine.numerics.arrays import FloatArray
from gearwhine.output.sections import arrowed, counted

_HEIGHT, _BETWEEN, _RIGHT = 34.0, 6.5, 14.0  # height of a panel, gap above it, and width beside it for levels [mm]
_ABOVE = 4.5  # height above the first panel for the name of its sensor [mm]
_MOST_NAMED_LINES = 5  # named lines of a sensor
_LEAST_NAMED_LINE = 1e-4  # part of the highest line below which no line is named
_SAME_LINE = 1.0  # difference between the frequencies that two sensors' spectra give one line, at most [Hz]


def draw_sensor_spectra(
    title: str,
    solved: SolvedTransient,
    lines: dict[str, tuple[TracedLine, ...]],
    *,
    mesh_frequencies: Sequence[float] = (),
    marked: FloatArray,
    marked_as: str = "housing modes",
) -> Figure:
    """Draw amplitudes in m/s² with levels in dB beside them, a panel for each sensor; name the leading lines above all.

    Parameters
    ----------
    title : str
        Title of the sheet.
    solved : SolvedTransient
    lines : dict of str to tuple of TracedLine
        Lines of each sensor, highest first.
    mesh_frequencies : sequence of float
        Mesh frequencies [Hz]; they and their multiples are marked.
    marked : ndarray, shape (n,)
        Frequencies of modes [Hz].
    marked_as : str
        Name of these modes in the legend.
    """
    width, limit = SHEET_WIDTH - LEFT - _RIGHT, solved.trusted_limit
    named = {
        name: [line for line in sensor_lines if abs(line.value) >= _LEAST_NAMED_LINE * abs(sensor_lines[0].value)][
            :_MOST_NAMED_LINES
        ]
        for name, sensor_lines in lines.items()
    }
    colors = {"mesh": RED}
    labels = [
        Label(_text(line), line.frequency, 1.0, colors.get(line.named.kind, INK))
        for line in _each_once(line for sensor_lines in named.values() for line in sensor_lines)
    ]
    row = arrange(labels, [label.x / limit * width for label in labels], width)
    count = len(solved.sensor_spectra)
    height = HEAD + FOOT + row.height + count * _HEIGHT + (count - 1) * _BETWEEN + _ABOVE
    note = f"{title}; peak amplitudes, levels of their rms values re 1 µm/s²"
    figure = sheet(height, "Housing acceleration", note)
    bottom = FOOT
    for number, (name, spectrum) in enumerate(reversed(solved.sensor_spectra.items())):
        axes = panel(figure, bottom, _HEIGHT, width=width)
        draw_lines(axes, spectrum, limit)
        low, high = axes.get_ylim()
        for base in mesh_frequencies:
            for harmonic in range(1, int(limit / base * (1.0 + 1e-9)) + 1):
                axes.axvline(harmonic * base, color=RED, lw=0.7, ls=(0, (4, 3)), zorder=0)
        inside = marked[marked <= limit]
        places = np.full(inside.size, 0.04)
        across = axes.get_xaxis_transform()
        axes.plot(inside, places, marker="^", color=INK, mec="white", mew=0.4, ms=4, ls="", transform=across, zorder=4)
        for label in row.labels:
            axes.axvline(label.x, color=GREY, lw=0.4, zorder=0)
        leading = [(line.frequency, abs(line.value)) for line in named[name]]
        axes.plot(*np.reshape(leading, (-1, 2)).T, marker="o", color=BLUE, ms=2.6, ls="", zorder=3)
        axes.set_ylabel("acceleration [m/s²]", fontsize=LABEL)
        beside = axes.twinx()
        beside.set_ylim(*decibels([low, high]).tolist())
        beside.set_ylabel("level [dB]", fontsize=LABEL, color=INK)
        beside.tick_params(labelsize=NOTE, colors=INK)
        beside.spines[["top"]].set_visible(False)
        axes.set_title(shortened(name, 40), fontsize=LABEL, loc="left", pad=2.0, parse_math=False)
        if number:
            axes.tick_params(labelbottom=False)
        else:
            axes.set_xlabel("frequency [Hz]")
        if number == count - 1:
            above = panel(figure, bottom, _HEIGHT, width=width)
            above.set(xlim=axes.get_xlim(), ylim=(0.0, 1.0))
            above.set_axis_off()
            draw_row(above, row, panel_size(axes)[1] + _ABOVE)
        bottom += _HEIGHT + _BETWEEN
    handles = []
    if len(mesh_frequencies):
        handles.append(Line2D([], [], color=RED, lw=0.7, ls=(0, (4, 3)), label="mesh harmonic"))
    if marked.size:
        handles.append(Line2D([], [], color=INK, marker="^", ms=4, ls="", label=marked_as))
    legend(figure, handles)
    return figure


def _each_once(lines: Iterable[TracedLine]) -> list[TracedLine]:
    """Return lines without those of the same name at the same frequency, as all sensors have them."""
    once: list[TracedLine] = []
    for line in lines:
        if not any(
            line.named.name == one.named.name and abs(line.frequency - one.frequency) < _SAME_LINE for one in once
        ):
            once.append(line)
    return once


def _text(line: TracedLine) -> str:
    name = line.named.name.replace(" mode of ", " ").replace(" -> ", "→").replace("planets' meshes", "planets")
    return f"{line.frequency:.0f} Hz {'free ' if line.named.kind == 'mode' else ''}{name}"


_LINES, _MOST_LINES = 3, 8  # lines of each sensor, and of all on a sheet
_PARTS = 6  # parts of each kind
_BAR, _NAMES, _BARS_GAP = 3.4, 31.0, 15.0  # height of a bar, width of its name, and gap above a panel [mm]
_MARGIN = 4.0
_ROOM_OF_LETTER = 0.07  # part of the bars' range that a letter of a value takes beside a bar
_VISIBLE_PART = 0.05  # size below which a part counts as zero [%]


def draw_contributions(title: str, lines: dict[str, tuple[TracedLine, ...]]) -> Figure:
    """Draw the parts of modes and of bearings in phase with each line, in percent of it, largest first.

    Bars to the left work against the line. The smaller parts of each kind are one bar together. Of many sensors fewer
    lines each are drawn, the highest, so that the sheet stays a page.
    """
    width = (SHEET_WIDTH - 2.0 * _MARGIN) / 2.0 - _NAMES - 3.0
    traced = [name for name, named in lines.items() if named]
    each = max(1, min(_LINES, _MOST_LINES // len(traced)))
    highest = sorted(
        ((name, line) for name in traced for line in lines[name][:each]), key=lambda pair: -abs(pair[1].value)
    )[:_MOST_LINES]
    leading_lines = sorted(highest, key=lambda pair: traced.index(pair[0]))
    groups = [
        (name, line, _gathered(line.modes), _gathered((*line.bearings, line.free))) for name, line in leading_lines
    ]
    heights = [_BAR * max(len(modes), len(bearings)) for _, _, modes, bearings in groups]
    height = HEAD + FOOT + sum(heights) + _BARS_GAP * len(groups)
    note = f"{title}; parts in phase with the line in percent of it; left: housing modes, right: forces on the housing"
    if any(part > 1.0 for _, _, *sides in groups for side in sides for _, part in side):
        note += "; each side sums to 100 %, parts in red take from it"
    figure = sheet(height, "Where the lines come from", note)
    up = height - HEAD
    for (name, line, modes, bearings), tall in zip(groups, heights, strict=True):
        up -= _BARS_GAP - 5.0 + tall
        heading = f"{name}: {line.frequency:.0f} Hz, {abs(line.value):.3g} m/s² peak, {arrowed(line.named.name)}"
        figure.text(
            _MARGIN / SHEET_WIDTH,
            (up + tall + 1.2) / sheet_height(figure),
            shortened(heading, 100),
            fontsize=NOTE + 1.0,
            color=INK,
            parse_math=False,
        )
        for side, parts in enumerate((modes, bearings)):
            left = _MARGIN + side * (width + _NAMES + 3.0) + _NAMES
            _draw(panel(figure, up, tall, left=left, width=width), parts, BLUE if side == 0 else SERIES[2])
        up -= 5.0
    return figure


def _gathered(parts: Sequence[Contribution]) -> list[tuple[str, float]]:
    """Names and shares of the largest parts, and of all others together where they count."""
    ranked = sorted(parts, key=lambda part: -abs(part.share))
    named = [(part.name, part.share) for part in ranked[:_PARTS]]
    rest = ranked[_PARTS:]
    together = sum(part.share for part in rest)
    if 100.0 * abs(together) < _VISIBLE_PART:
        return named
    return [*named, (counted(len(rest), "other"), together)]


def _draw(axes: Axes, parts: list[tuple[str, float]], color: str) -> None:
    names, shares = [shortened(name, 26) for name, _ in parts], [100.0 * share for _, share in parts]
    axes.barh(range(len(parts)), shares, color=[color if share >= 0.0 else RED for share in shares], height=0.72)
    axes.set_yticks(range(len(parts)), names, fontsize=NOTE, parse_math=False)
    axes.tick_params(axis="y", length=0.0)
    axes.invert_yaxis()
    axes.axvline(0.0, color=GREY, lw=0.7)
    low, high = min(0.0, *shares), max(0.0, *shares)
    longest = max(len(_percent(share)) for share in shares)
    room = max(0.2, _ROOM_OF_LETTER * longest) * (high - low) or 1.0
    # A value stands beyond its bar, on the left of negative ones.
    axes.set_xlim(low - (room if min(shares) <= -_VISIBLE_PART else 0.0), high + room)
    for place, share in enumerate(shares):
        axes.annotate(
            _percent(share), (share, place), (2.0 if share > -_VISIBLE_PART else -2.0, 0.0), textcoords="offset points",
            fontsize=NOTE - 0.5, color=INK, va="center", ha="left" if share > -_VISIBLE_PART else "right",
        )  # fmt: skip
    axes.grid(visible=False, axis="y")


def _percent(share: float) -> str:
    return "0" if abs(share) < _VISIBLE_PART else f"{share:.{0 if abs(share) >= 10.0 else 1}f}"


_PERIODS = 6  # mesh periods that are drawn
_LEAST_POINTS_PER_MESH_PERIOD = 40  # least number of a curve's points in a mesh period
_LEAST_ORBIT_POINTS_PER_MESH_PERIOD = 24  # least number of an orbit's points in a mesh period
_EDGE = 10  # samples on either side from which a point between samples is interpolated
_BETA = 8.0  # parameter of Kaiser's window over them
_ROW, _ROW_GAP = 42.0, 18.0  # height of a row of panels, and gap with axis and title between two [mm of paper]
_FIRST = 5.0  # height of the first row's titles [mm of paper]


def _rows_of_pairs(count: int, title: str, note: str) -> tuple[Figure, list[tuple[Axes, Axes]]]:
    """Return a sheet with rows of two panels, the uppermost row first."""
    figure = sheet(HEAD + _FIRST + count * _ROW + (count - 1) * _ROW_GAP + FOOT, title, note)
    bottoms = [FOOT + number * (_ROW + _ROW_GAP) for number in reversed(range(count))]
    return figure, [panel_pair(figure, bottom, _ROW) for bottom in bottoms]


def between_samples(times: FloatArray, values: FloatArray, end: float, period: float) -> tuple[FloatArray, FloatArray]:
    """Return a signal from its first sample to a time, with enough points to show its form in each period.

    Too few samples are joined by the band-limited curve through them (Shannon's series, tapered by Kaiser's window), so
    that no peak of the signal falls between two points, as it does where samples are joined by straight lines.

    Parameters
    ----------
    times, values : ndarray, shape (s,)
        Evenly spaced times [s], and the signal.
    end : float
        Time up to which the signal is drawn [s].
    period : float
        Period of the signal [s].

    Returns
    -------
    times, values : ndarray, shape (n,)
        Times [s] and values, the samples among them.
    """
    interval = float(times[1] - times[0])
    n_samples = int(np.searchsorted(times, end + 1e-9 * interval, side="right"))
    factor = int(np.ceil(_LEAST_POINTS_PER_MESH_PERIOD * interval / period))
    if factor <= 1 or n_samples < 2:
        return times[:n_samples], values[:n_samples]
    count = factor * (n_samples - 1) + 1
    return times[0] + interval / factor * np.arange(count), _refined(values[: n_samples + _EDGE], factor)[:count]


def _refined(values: FloatArray, factor: int) -> FloatArray:
    """Return a signal (s, ...) at ``factor`` times its rate, from the first to the last of its samples.

    Each point between two samples is a sum over ten samples on either side,

        y(k + p / factor) = sum over j of h(p / factor - j) x[k + j],   h(u) = sinc(u) w(u / 10),

    where w is Kaiser's window.
    """
    reach = min(_EDGE, len(values) - 1)
    # The signal is mirrored about its ends against ringing; beyond the mirrored samples of a short one it is zero.
    begin, after = values[1 : reach + 1][::-1], values[-reach - 1 : -1][::-1]
    nothing = np.zeros((_EDGE - reach, *values.shape[1:]))
    whole = np.concatenate([nothing, 2.0 * values[:1] - begin, values, 2.0 * values[-1:] - after, nothing])
    # scipy.signal.resample_poly does the same, but importing it takes longer than drawing a figure.
    taps = np.sinc(np.arange(-_EDGE * factor, _EDGE * factor + 1) / factor) * np.kaiser(2 * _EDGE * factor + 1, _BETA)
    taps *= factor / taps.sum()
    refined = np.zeros((factor * (len(values) - 1) + 1, *values.shape[1:]))
    refined[::factor] = values
    between = sliding_window_view(whole, 2 * _EDGE, axis=0)[1 : len(values)]
    for part in range(1, factor):
        refined[part::factor] = between @ taps[part::factor][::-1]
    return refined


def draw_friction(title: str, histories: Histories, mesh_frequencies: dict[str, float], *, note: str = "") -> Figure:
    """Draw six mesh periods of each contact with friction.

    Parameters
    ----------
    title : str
        Title of the sheet.
    histories : Histories
        Histories with friction.
    mesh_frequencies : dict of str to float
        Mesh frequencies of the contacts [Hz].
    note : str
        Note below the title.
    """
    records = {name: record for name, record in histories.mesh_friction.items() if name in mesh_frequencies}
    figure, rows = _rows_of_pairs(len(records), title, note)
    for (left, right), (name, record) in zip(rows, records.items(), strict=True):
        period = 1.0 / mesh_frequencies[name]
        mean = float(np.mean(record[:, 1]))
        for axes, column, color, quantity in (
            (left, 0, BLUE, "friction force [N]"),
            (right, 1, RED, "power that friction takes [W]"),
        ):
            times, values = between_samples(
                histories.times - histories.times[0], record[:, column], _PERIODS * period, period
            )
            axes.plot(MILLI * times, values, color=color, lw=1.0, label=f"_{quantity}")
            axes.set(xlabel="time [ms]", ylabel=quantity, xlim=(0.0, MILLI * _PERIODS * period))
        left.axhline(0.0, color=GREY, lw=0.6)
        right.axhline(mean, color=GREY, lw=0.8, ls="--")
        panel_title(left, f"{name}: across the line of action")
        panel_title(right, f"{mean:.3g} W in the mean")
    return figure


_MODES = 4  # largest number of modes in a panel
_MOST_CURVE_POINTS = 6000  # largest number of points of a curve
_LEGEND_BAND = 3.4  # height of a legend's line for a mode [mm of paper]


def outlined(times: FloatArray, values: FloatArray, most: int) -> tuple[FloatArray, FloatArray]:
    """Return a signal in at most ``most`` points: of each stretch the least and the largest sample, in their order.

    A picture of these looks like that of all samples; every tenth sample would show aliases.

    Parameters
    ----------
    times, values : ndarray, shape (s,)
    most : int
        Number of points, 2 or more.
    """
    if times.size <= most:
        return times, values
    stretch = -(-2 * times.size // most)
    whole = times.size // stretch * stretch
    starts = np.arange(0, whole, stretch)
    groups = values[:whole].reshape(-1, stretch)
    ends = np.sort(np.stack([groups.argmin(axis=1), groups.argmax(axis=1)], axis=1), axis=1)
    chosen = (starts[:, None] + ends).ravel()
    return times[chosen], values[chosen]


def draw_modal_coordinates(
    title: str,
    times: FloatArray,
    coordinates: Mapping[str, FloatArray],
    limit: float,
    window: Window,
    *,
    note: str = "",
) -> Figure:
    """Draw the coordinates of each part by kind: over time at the left, their spectra without mean at the right.

    Parameters
    ----------
    title : str
        Title of the sheet.
    times : ndarray, shape (s,)
        Evenly spaced times [s].
    coordinates : mapping of str to ndarray, shape (s,)
        Coordinates by names ``part: kind number``, with an axis after a comma.
    limit : float
        Limit of the frequency axis [Hz].
    window : Window
        Window of the spectra.
    note : str
        Note below the title.
    """
    groups: dict[str, dict[str, FloatArray]] = {}
    for name, values in coordinates.items():
        kind, _, axis = name.partition(", ")
        head, _, number = kind.rpartition(" ")
        groups.setdefault(f"{head}, {axis}" if axis else head, {})[number] = values
    unit = "m √kg; of torsion rad √(kg m²)"
    figure, rows = _rows_of_pairs(len(groups), title, f"{note}; {unit}" if note else unit)
    interval = float(times[1] - times[0])
    for (left, right), (name, group) in zip(rows, groups.items(), strict=True):
        top = 0.0
        for color, (number, values) in zip(SERIES, list(group.items())[:_MODES], strict=False):
            parts = signal_parts(values)
            label = f"mode {number}: d.c. {float(parts.mean):.2e}, a.c. {float(parts.rms):.1e} rms"
            at, outline = outlined(times - times[0], values, _MOST_CURVE_POINTS)
            left.plot(MILLI * at, outline, color=color, lw=0.7, label=label)
            spectrum = amplitude_spectrum(values, interval, window)
            inside = (spectrum.frequencies > 0.0) & (spectrum.frequencies <= limit)
            right.plot(spectrum.frequencies[inside], spectrum.amplitude[inside], color=color, lw=0.8)
            top = max(top, float(spectrum.amplitude[inside].max(initial=0.0)))
        if top > 0.0:
            right.set_yscale("log")
            right.set_ylim(1e-5 * top, 3.0 * top)
        right.set_xlim(0.0, limit)
        left.set_xlim(0.0, MILLI * float(times[-1] - times[0]))
        left.legend(fontsize=NOTE, frameon=False, loc="upper left", borderaxespad=0.2, handlelength=1.6)
        # Room for the legend above the curves.
        low, high = left.get_ylim()
        legend_part = _LEGEND_BAND * min(len(group), _MODES) / _ROW
        left.set_ylim(low, low + (high - low) / (1.0 - legend_part))
        panel_title(left, f"{name} over time")
        panel_title(right, "peak amplitudes")
        left.set_xlabel("time [ms]")
        right.set_xlabel("frequency [Hz]")
    return figure


_ORBIT_ROWS = 20.0  # gap between both rows, for an axis and a title of two lines [mm]
_ORBITS_IN_ROW, _ORBIT_GAP, _LARGEST_ORBIT = 4, 11.0, 56.0  # panels in a row, gap between them, largest side [mm]


def draw_orbits(title: str, motions: Mapping[str, FloatArray], *, note: str = "", refined: int = 1) -> Figure:
    """Draw each gear's centre from where it stands without load, and below enlarged about its mean.

    Parameters
    ----------
    title : str
        Title of the sheet.
    motions : mapping of str to ndarray, shape (s, 2 or more)
        Motion of each gear's centre, x and y in the first columns [m]. Gears of a row have one scale.
    note : str
        Begin of the note below the title.
    refined : int
        Points drawn for each sample, on the band-limited curve through them.
    """
    orbits = {
        name: MICRO * (motion[:, :2] if refined == 1 else _refined(motion[:, :2], refined))
        for name, motion in motions.items()
    }
    columns = min(len(orbits), _ORBITS_IN_ROW)
    bands = -(-len(orbits) // columns)
    side = min((PANEL_WIDTH - (columns - 1) * _ORBIT_GAP) / columns, _LARGEST_ORBIT)
    height = 2.0 * side + _ORBIT_ROWS
    legend_text = "above: from where the shaft stands without load; below: enlarged about the mean"
    figure = sheet(
        HEAD + _FIRST + bands * height + (bands - 1) * _ROW_GAP + FOOT,
        title,
        f"{note}; {legend_text}" if note else legend_text,
    )
    reach = [1.12 * max(float(np.abs(orbit).max()) for orbit in orbits.values()) or 1.0, 0.0]
    reach[1] = 1.12 * max(float(np.abs(orbit - orbit.mean(axis=0)).max()) for orbit in orbits.values()) or 1.0
    rows: list[list[Axes]] = []
    for up in (side + _ORBIT_ROWS, 0.0):
        places = [divmod(number, columns) for number in range(len(orbits))]
        bottoms = [FOOT + (bands - 1 - band) * (height + _ROW_GAP) + up for band, _ in places]
        lefts = [LEFT + column * (side + _ORBIT_GAP) for _, column in places]
        rows.append(
            [panel(figure, bottom, side, left=left, width=side) for bottom, left in zip(bottoms, lefts, strict=True)]
        )
    for number, (name, orbit) in enumerate(orbits.items()):
        above, below = (row[number] for row in rows)
        center = orbit.mean(axis=0)
        above.annotate("", center, (0.0, 0.0), arrowprops={"arrowstyle": "->", "color": RED, "lw": 0.9})
        above.plot([0.0], [0.0], marker="+", color=GREY, ms=7)
        above.plot(orbit[:, 0], orbit[:, 1], color=BLUE, lw=0.8)
        below.plot(*(orbit - center).T, color=BLUE, lw=0.5)
        below.plot([0.0], [0.0], marker="+", color=RED, ms=7)
        for axes, size in ((above, reach[0]), (below, reach[1])):
            axes.set(xlim=(-size, size), ylim=(-size, size), aspect="equal", xlabel="x [µm]")
            axes.yaxis.set_major_locator(MaxNLocator(4))
            axes.xaxis.set_major_locator(MaxNLocator(4))
            if number % columns == 0:
                axes.set_ylabel("y [µm]")
        above.set_title(shortened(name, 20), fontsize=LABEL, loc="left", pad=3.0, parse_math=False)
        swing = 0.5 * np.ptp(orbit, axis=0)
        # The mean has as many digits as can be seen.
        digits = max(0, 2 - int(np.floor(np.log10(reach[0]))))
        mean = ", ".join(f"{part:z.{digits}f}" for part in center)
        about = f"mean {mean} µm\n± {plain(swing[0], 2)}, {plain(swing[1], 2)} µm"
        below.set_title(about, fontsize=NOTE, loc="left", pad=3.0)
    return figure


_ORBIT_SAMPLES = 1 << 14  # samples drawn of a long record: hundreds of thousands take long to draw, and memory


def draw_transient(
    title: str,
    solved: SolvedTransient,
    signature: SolvedSignature | None,
    housing: HousingModes | None,
    comparison: Comparison | None,
) -> Iterator[tuple[str, Figure]]:
    """Draw the figures of a transient: yield the name of each, such as ``spectrum``, and the figure."""
    lines: dict[str, tuple[TracedLine, ...]] = dict.fromkeys(solved.sensor_spectra, ())
    if signature is not None:
        lines = signature.lines
    machine = solved.machine
    meshes = tuple(abs(contact.mesh_frequency) for contact in machine.system.contacts[: len(machine.meshes)])
    speed = _speed(solved)
    # Along a run no line stands still.
    marks = meshes if solved.speed_profile is None else ()
    if solved.sensor_spectra:
        marked = _marked_modes(housing, comparison)
        kind = "dominant" if comparison is None or comparison.pairing == "dominance" else "measured"
        legend = "housing modes" if comparison is None else f"{kind} housing modes"
        heading = f"{title}, {speed}"
        spectra = draw_sensor_spectra(heading, solved, lines, mesh_frequencies=marks, marked=marked, marked_as=legend)
        yield "spectrum", spectra
    if any(lines.values()):
        parts = draw_contributions(f"{title}, {speed}", lines)
        yield "contributions", parts
    if solved.force_spectra:
        yield "mesh-force", _mesh_force(title, solved, meshes)
    carrying = [contact for contact in solved.machine.system.contacts if contact.name in solved.histories.mesh_friction]
    if rates := {
        contact.name: abs(contact.mesh_frequency) for contact in carrying if contact.loaded and contact.mesh_frequency
    }:
        yield (
            "friction",
            draw_friction(
                "Friction between the teeth", solved.histories, rates, note=f"{title}, {speed}; six mesh periods"
            ),
        )
    if solved.histories.gear_motion:
        motions = solved.histories.gear_motion
        if solved.record.sampling.is_long:
            motions = {name: motion[-_ORBIT_SAMPLES:] for name, motion in motions.items()}
        most = max((frequency for frequency in meshes), default=0.0)
        times = solved.histories.times
        refined = int(np.ceil(_LEAST_ORBIT_POINTS_PER_MESH_PERIOD * most * float(times[1] - times[0]))) or 1
        # Beyond that a path takes long to draw, and memory.
        refined = min(refined, max(_ORBIT_SAMPLES // len(times), 1))
        yield "orbits", draw_orbits("Orbits of the gears", motions, note=f"{title}, {speed}", refined=refined)
    if solved.modal.coordinates:
        window = next(iter(solved.force_spectra.values())).window if solved.force_spectra else "hann"
        limit = min(solved.trusted_limit, 1.2 * max(meshes)) if meshes else solved.trusted_limit
        modal = draw_modal_coordinates(
            "Modal coordinates",
            solved.histories.times,
            solved.modal.coordinates,
            limit,
            window,
            note=f"{title}, {speed}",
        )
        yield "modal-coordinates", modal


def _mesh_force(title: str, solved: SolvedTransient, meshes: tuple[float, ...]) -> Figure:
    drives = [solved.machine.system.contacts[number].name for number in solved.machine.loaded_contacts]
    times = solved.histories.times
    figure, rows = _rows_of_pairs(len(drives), "Gear-mesh force", f"{title}, {_speed(solved)}")
    for (left, right), name, frequency in zip(rows, drives, meshes, strict=True):
        period, span = 1.0 / frequency, "six mesh periods"
        if solved.speed_profile is not None:
            span = f"its first {_PERIODS * MILLI * period:.3g} ms"
        at, force = between_samples(times - times[0], solved.histories.mesh_force[name], _PERIODS * period, period)
        left.plot(MILLI * at, force, color=BLUE, lw=1.0)
        left.set(xlabel="time [ms]", ylabel="mesh force [N]", xlim=(0.0, MILLI * _PERIODS * period))
        panel_title(left, f"{name}: {span}")
        limit = min(4.2 * frequency, float(solved.force_spectra[name].frequencies[-1]))
        draw_lines(right, solved.force_spectra[name], limit)
        if solved.speed_profile is None:
            _mark(right, meshes, limit)
        right.set(xlabel="frequency [Hz]", ylabel="mesh force [N, peak]")
        panel_title(right, "spectrum without its mean")
    if solved.speed_profile is None:
        legend(figure, [Line2D([], [], color=RED, lw=0.8, ls=(0, (4, 3)), label="mesh harmonic")])
    return figure


def _mark(axes: Axes, meshes: tuple[float, ...], limit: float) -> None:
    for frequency in meshes:
        for harmonic in range(1, int(limit / frequency) + 1):
            axes.axvline(harmonic * frequency, color=RED, lw=0.8, ls=(0, (4, 3)), zorder=0)


def _marked_modes(housing: HousingModes | None, comparison: Comparison | None) -> FloatArray:
    if comparison is not None:
        return np.array([pair.model for pair in comparison.pairs]) / (2.0 * np.pi)
    return np.empty(0) if housing is None else housing.modes.frequencies_hz


def _speed(solved: SolvedTransient) -> str:
    """Speed and torque for a caption; of a run, the speeds that its record goes through."""
    if solved.speed_profile is not None:
        rates = solved.speed_profile.at(solved.histories.times[[0, -1]])[1]
        first, last = solved.speed * rates * 60.0 / (2.0 * np.pi)
        return f"{first:.0f} to {last:.0f} rpm, averaged over the run"
    return f"{solved.speed * 60.0 / (2.0 * np.pi):.0f} rpm, {solved.machine.input_torque:.4g} N·m"
