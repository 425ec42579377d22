"""Export of a results folder: tables as CSV, histories and spectra as universal files, signals as sound.

Everything is made from what commands left in the folder: the tables of their documents, and the labelled arrays of
their NetCDF files. Nothing is solved.
"""

from __future__ import annotations

import csv
import io
import math
import re
import struct
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, product
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray
from gearwhine.output.csv_cells import plain_cells
from gearwhine.output.files import file_stems
from gearwhine.output.manifest import opened_dataset
from gearwhine.output.sections import Column, Document, Section, Table, value_at
from gearwhine.output.store import DATA, stored_results

if TYPE_CHECKING:
    import xarray as xr

    from gearwhine.housing.measured.universal_writing import UniversalFunction

Chapters = Callable[[Document], Iterable[Section]]
Signals = Literal["sensors", "all"]
_Places = dict[tuple[str, str], tuple[int, int]]  # point and direction by kind and name

AUDIO_RATE = 48_000
"""Sampling rate of sound files [Hz]."""

SOUND_SECONDS = 5.0
"""Least length of the sound file of a record that repeats [s]."""

LONGEST_SOUND = 600.0
"""Longest sound file that may be asked for [s], which has 115 MB."""

_FIRST_DIGITS = (1.0, 2.0, 5.0, 10.0)  # first digits of a full scale
_RATIO_LIMIT = 10_000  # largest term of a resampling ratio: the pitch is right to 1e-8
_HALF_LENGTH = 32  # zero crossings of the interpolating sinc on either side
_ATTENUATION = 100.0  # attenuation of aliases, and of what is cut off [dB]
_TRANSITION = 0.1  # width of the cut, as a part of its frequency
_LISTED_COMPONENTS = re.compile(r"\w+(?:, \w+)+(?=$| \[)")  # names of components in a heading, before its unit
_LIMITS = ("trusted_below_hz", "complete_below_hz")  # attributes with the frequency below which a signal is complete
_MEASURED = ("sensor", "microphone")  # dimensions of quantities that are measured on real machines
_KINDS: dict[str, Literal["time response", "spectrum"]] = {"s": "time response", "Hz": "spectrum"}


def write_tables(folder: Path, chapters: Chapters, place: Path) -> list[Document]:
    """Write every table of the report as a CSV file: a row of headings with units, numbers with all their digits.

    A column whose values are lists has one for each component, by its name in the heading or counted from 1. A number
    that the page shows in words or in per cent has its key, and so its unit, in the heading. Texts that tell several
    numbers are followed by a column for each of these, headed by its key.

    Parameters
    ----------
    folder : path
        Results folder.
    chapters : callable
        Returns the chapters of a command's document.
    place : path
        Folder for the files.

    Returns
    -------
    list of dict
        File, title and number of rows of each table.
    """
    titled_tables = [
        (title, table)
        for _, document in stored_results(folder)
        for title, table in _tables(str(document.get("command", "results")), chapters(document))
    ]
    written: list[Document] = []
    titles = _told_apart(titled_tables)
    for stem, title, (_, table) in zip(file_stems(titles), titles, titled_tables, strict=True):
        (place / f"{stem}.csv").write_text(_csv(table), encoding="utf-8", newline="")
        written.append({"file": f"{stem}.csv", "title": title, "rows": len(table.rows)})
    return written


def _tables(title: str, sections: Iterable[Section]) -> Iterator[tuple[str, Table]]:
    """Yield the tables of sections and of those inside them, each under the titles that lead to it."""
    for section in sections:
        path = " ".join(part for part in (title, section.title) if part)
        for table in section.tables:
            yield " ".join(part for part in (path, table.caption) if part), table
        yield from _tables(path, section.inner)


def _told_apart(titled_tables: Sequence[tuple[str, Table]]) -> list[str]:
    """Return the titles; of tables that share one, each followed by the table's first heading without its unit."""
    shared = Counter(title for title, _ in titled_tables)

    def first_heading(table: Table) -> str:
        columns, _ = table.filled()
        return " ".join(columns[0].heading.partition("[")[0].split()) if columns else ""

    return [f"{title} {first_heading(table)}".strip() if shared[title] > 1 else title for title, table in titled_tables]


def _csv(table: Table) -> str:
    columns, _ = table.filled()
    spread = [cells for column in columns for cells in _spread(column, table.rows)]
    file = io.StringIO()
    writer = csv.writer(file)
    writer.writerow(plain_cells(heading for heading, _ in spread))
    writer.writerows(plain_cells(row) for row in zip(*(cells for _, cells in spread), strict=True))
    return file.getvalue()


def _spread(column: Column, rows: Sequence[Document]) -> Iterator[tuple[str, list[str]]]:
    """Yield a column of a table as those of the file, each with its heading and cells."""
    values = [column.value(row) for row in rows]
    if any(isinstance(value, list | tuple | Mapping) and any(_numbers(value)) for value in values):
        yield from _components(column.heading, values)
    else:
        is_told = column.shown is not None and "[" not in column.heading
        are_numbers = all(value is None or _is_number(value) for value in values) and any(map(_is_number, values))
        yield (
            f"{column.heading} ({column.of})".strip() if is_told and are_numbers else column.heading,
            [repr(value) if _is_number(value) else column.text(row) for value, row in zip(values, rows, strict=True)],
        )
    for key in column.numbers:
        yield from _components(key, [value_at(row, key) for row in rows])


def _components(heading: str, values: Sequence[Any]) -> Iterator[tuple[str, list[str]]]:
    """Yield a column for each number in values of several; empty cells where a row has none.

    A heading that lists as many names before its unit as there are numbers gives each the one of its own.
    """
    found = [dict(_numbers(value)) for value in values]
    places = list(dict.fromkeys(place for numbers in found for place in numbers))
    listed = _LISTED_COMPONENTS.search(heading)
    names = listed[0].split(", ") if listed else []
    named = places == [(str(number),) for number in range(1, len(names) + 1)]
    for number, place in enumerate(places):
        cells = [repr(numbers[place]) if place in numbers else "" for numbers in found]
        if listed and named:
            yield heading[: listed.start()] + names[number] + heading[listed.end() :], cells
        else:
            yield " ".join([heading, *place]), cells


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _numbers(value: Any, place: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], int | float]]:
    """Yield every number in lists and tables with its place, in lists counted from 1."""
    if _is_number(value):
        yield place, value
    elif isinstance(value, Mapping):
        for key, entry in value.items():
            yield from _numbers(entry, (*place, str(key)))
    elif isinstance(value, list | tuple):
        for number, entry in enumerate(value, start=1):
            yield from _numbers(entry, (*place, str(number)))


def write_universal_files(folder: Path, place: Path, signals: Signals = "sensors") -> list[Document]:
    """Write histories, spectra and transmissibilities as universal files with datasets 58.

    Each file has the points of its own result: those of the surface that the sensors were on, then the microphones.

    Parameters
    ----------
    folder : path
        Results folder.
    place : path
        Folder for the files.
    signals : {"sensors", "all"}
        Whether to leave out all but sensors and microphones: forces and motions of bearings, gears and meshes.

    Returns
    -------
    list of dict
        File and number of functions of each, and the sensors whose points the result does not hold.
    """
    from gearwhine.housing.measured.universal_writing import write_functions

    written: list[Document] = []
    for command, _, data in _datasets(folder):
        count = 0
        places, points = _sensor_places(data)

        def counted(functions: Iterable[UniversalFunction]) -> Iterator[UniversalFunction]:
            nonlocal count
            for function in functions:
                count += 1
                yield function

        path = place / f"{command}.uff"
        heard, positions = _microphone_places(data, len(points))
        functions = chain(_functions(data, places | heard, signals), _heard_lines(data, heard))
        write_functions(path, counted(functions), [*points, *positions])
        if count:
            without = [name for name in _labels(data, "sensor") if ("sensor", name) not in places]
            written.append({"file": path.name, "functions": count} | ({"without_point": without} if without else {}))
        else:
            path.unlink()
    return written


def _datasets(folder: Path) -> Iterator[tuple[str, Document, xr.Dataset]]:
    for place, document in stored_results(folder):
        path = folder / place / DATA
        if path.is_file() and not path.is_symlink():
            with opened_dataset(path) as data:
                yield str(document.get("command", "results")), document, data


def _labels(data: xr.Dataset, dimension: str) -> list[str]:
    return [str(name) for name in data[dimension].values] if dimension in data.coords else []


def _sensor_places(data: xr.Dataset) -> tuple[_Places, list[tuple[float, float, float]]]:
    """Return points and directions of sensors by name, numbered from 1, and their positions [m].

    Both are empty where the result does not hold them.
    """
    if "sensor_position" not in data:
        return {}, []
    rows = [
        (name, *(data[key].sel(sensor=name).values.tolist() for key in ("sensor_position", "sensor_direction")))
        for name in _labels(data, "sensor")
    ]
    places = {("sensor", name): (number, _direction(unit)) for number, (name, _, unit) in enumerate(rows, start=1)}
    return places, [(float(x), float(y), float(z)) for _, (x, y, z), _ in rows]


def _direction(unit_vector: Sequence[float] | None) -> int:
    """Return 1, 2, 3 for x, y, z with a sign; 0 for another direction, and for a normal that is not known."""
    for number, share in enumerate(unit_vector or (), start=1):
        if abs(share) > 1.0 - 1e-9:
            return number if share > 0.0 else -number
    return 0


def _microphone_places(data: xr.Dataset, before: int) -> tuple[_Places, list[tuple[float, float, float]]]:
    """Return the points of microphones by name, numbered from ``before`` on, and their positions [m]."""
    if "microphone_position" not in data:
        return {}, []
    names = _labels(data, "microphone")
    rows = data["microphone_position"].transpose("microphone", ...).values.tolist()
    places = {("microphone", name): (number, 0) for number, name in enumerate(names, start=before + 1)}
    return places, [(float(x), float(y), float(z)) for x, y, z in rows]


def _heard_lines(data: xr.Dataset, places: _Places) -> Iterator[UniversalFunction]:
    """Yield the lines of the sound at each microphone as a spectrum."""
    from gearwhine.housing.measured.universal_writing import UniversalFunction

    if "sound_pressure" not in data:
        return
    frequencies = np.asarray(data["sound_frequency"].values, dtype=np.float64)
    for name in [str(name) for name in data["microphone"].values]:
        parts = data["sound_pressure"].sel(microphone=name).transpose("sound_line", "part").values
        yield UniversalFunction(
            "spectrum",
            frequencies,
            parts[:, 0] + 1j * parts[:, 1],
            "Pa",
            "sound pressure",
            (name, "sound pressure of the lines", "amplitudes are peaks, phases at t = 0"),
            (name, *places[("microphone", name)]),
        )


def _functions(data: xr.Dataset, places: _Places, signals: Signals) -> Iterator[UniversalFunction]:
    """Yield every real history and every complex or real spectrum along an axis in s or Hz."""
    from gearwhine.housing.measured.universal_writing import UniversalFunction

    for name, variable in data.data_vars.items():
        axis = next((dimension for dimension in variable.dims if _axis_unit(data, dimension) in _KINDS), None)
        other_axes = [dimension for dimension in variable.dims if dimension != axis]
        measured = next((kind for kind in _MEASURED if any(kind in str(dimension) for dimension in other_axes)), None)
        if axis is None or str(name).endswith("_phase") or (signals == "sensors" and measured is None):
            continue
        if any(dimension not in data.coords or data[dimension].dtype.kind not in "UO" for dimension in other_axes):
            continue  # along numbers, such as those of modes
        phase = data.get(f"{name}_phase")
        # The array is loaded at once: row by row each read would search the file anew.
        variable.load()
        if phase is not None:
            phase.load()
        abscissa = np.asarray(data[axis].values, dtype=np.float64)
        for labels in product(*(data[dimension].values.tolist() for dimension in other_axes)):
            at = dict(zip(other_axes, labels, strict=True))
            values = np.asarray(variable.sel(at).values, dtype=np.float64)
            if phase is not None:
                values = values * np.exp(1j * np.asarray(phase.sel(at).values))
            error = at.get("mesh_error")
            label = next((at[dimension] for dimension in at if measured and measured in str(dimension)), labels[0])
            unit = str(variable.attrs.get("units", ""))
            long_name = str(variable.attrs.get("long_name", name))
            yield UniversalFunction(
                _KINDS[_axis_unit(data, axis)] if error is None else "frequency response function",
                abscissa,
                values,
                _response_unit(unit) if error is not None else unit,
                _quantity(str(name)),
                (
                    ", ".join(map(str, labels)),
                    long_name,
                    _remarks(variable, abscissa, _axis_unit(data, axis), phases=phase is not None and error is None),
                ),
                (str(label), *places.get((measured or "", str(label)), (0, 0))),
                *(() if error is None else (("mesh", 0, 0), "m", "transmission error")),
            )


def _axis_unit(data: xr.Dataset, dimension: Any) -> str:
    return str(data[dimension].attrs.get("units", "")) if dimension in data.coords else ""


def _response_unit(unit: str) -> str:
    """Return the unit of a response to one metre of transmission error from that of the response per metre."""
    return {"m s-2 m-1": "m/s2", "N m-1": "N", "N m m-1": "N m"}.get(unit, unit)


def _quantity(name: str) -> str:
    """Return the name of a variable without the parts that its axis names."""
    for part in ("transmissibility_", "_spectrum"):
        name = name.replace(part, "")
    return name.replace("_", " ")


def _remarks(variable: xr.DataArray, abscissa: FloatArray, unit: str, *, phases: bool) -> str:
    """Return a title with what the values are; ``phases`` says whether they have phases of their own."""
    remarks = [f"window {variable.attrs['window']}"] if "window" in variable.attrs else []
    if unit == "s":
        remarks.append(f"sampling interval {float(abscissa[1] - abscissa[0])!r} s")
    else:
        remarks.append("amplitudes are peaks, phases at t = 0" if phases else "amplitudes are peaks")
    if (limit := _limit(variable)) is not None:
        remarks.append(f"complete below {limit:.0f} Hz")
    return "; ".join(remarks)


def write_sounds(folder: Path, place: Path, *, seconds: float = SOUND_SECONDS) -> list[Document]:
    """Write the histories of sensors and microphones as sound files in 32-bit floating point, to hear and to measure.

    A record of whole turns at steady speed is a period of the motion: it is repeated without a seam until the file is
    as long as asked for. Any other record is as long as it is. The history less its mean is cut off at the frequency
    below which the model's modes are complete, as rms and peaks of the run are, resampled to an audio rate by a
    band-limited interpolation and divided by a full scale, the first of 1, 2, 5, 10, 20, … (and 0.5, 0.2, 0.1, …)
    m/s² or Pa above its peak. The full scale stands in the file's name, in its comment (chunk LIST INFO ICMT) and in
    what is returned: the signal is the sample times the full scale. The frequency of the cut stands in the comment and
    in what is returned.

    Parameters
    ----------
    folder : path
        Results folder.
    place : path
        Folder for the files.
    seconds : float
        Least length of the file of a record that repeats [s]; 0 for one period.

    Returns
    -------
    list of dict
        File, sensor or microphone, full scale, peak and root mean square [m/s² or Pa], length [s], number of periods,
        sampling rate [Hz] and the frequency below which the sound is complete [Hz], where it is cut off there.
    """
    written: list[Document] = []
    for command, document, data in _datasets(folder):
        for kind in _SOUNDS:
            if kind.variable not in data or kind.time not in data:
                continue
            times = np.asarray(data[kind.time].values, dtype=np.float64)
            names = [str(name) for name in data[kind.label].values]
            for stem, name in zip(file_stems(names, f"{command}-"), names, strict=True):
                signal = np.asarray(data[kind.variable].sel({kind.label: name}).values, dtype=np.float64)
                interval = (times[-1] - times[0]) / (len(times) - 1)
                count = periods(len(times) * interval, seconds, AUDIO_RATE) if _repeats(document) else 0
                limit = _complete_below(data, kind)
                signal -= signal.mean()
                if limit is not None:
                    signal = low_passed(signal, interval, limit, repeats=count > 0)
                sound = repeated(signal, interval, AUDIO_RATE, count)
                scale = full_scale(float(np.abs(sound).max()))
                path = place / f"{stem}-full-scale-{scale:g}-{kind.suffix.replace('_', '-')}.wav"
                comment = f"{kind.quantity} at {name}; full scale (sample 1.0) is {scale:g} {kind.unit}"
                comment += "" if limit is None else f"; complete below {limit:.0f} Hz, cut off there"
                comment += f"; gearwhine {command}"
                _write_wav(path, (sound / scale).astype("<f4"), AUDIO_RATE, comment)
                written.append(
                    {
                        "file": path.name,
                        kind.label: name,
                        f"full_scale_{kind.suffix}": scale,
                        f"peak_{kind.suffix}": float(np.abs(sound).max()),
                        f"rms_{kind.suffix}": float(np.sqrt(np.mean(sound**2))),
                        "seconds": len(sound) / AUDIO_RATE,
                        "periods": max(count, 1),
                        "sampling_rate_hz": AUDIO_RATE,
                    }
                    | ({} if limit is None else {"complete_below_hz": limit})
                )
    return written


@dataclass(frozen=True)
class _Sound:
    """Kind of histories that become sound files."""

    variable: str
    label: str
    spectrum: str
    time: str
    quantity: str
    unit: str
    suffix: str


_SOUNDS = (
    _Sound("sensor_acceleration", "sensor", "sensor_spectrum", "time", "acceleration", "m/s2", "m_per_s2"),
    _Sound("microphone_pressure", "microphone", "sound_pressure", "microphone_time", "sound pressure", "Pa", "pa"),
)


def _complete_below(data: xr.Dataset, kind: _Sound) -> float | None:
    """Return the frequency below which signals are complete [Hz]; None where they are by their making."""
    found = [_limit(data[name]) for name in (kind.variable, kind.spectrum) if name in data]
    return next((limit for limit in found if limit is not None), None)


def _limit(variable: xr.DataArray) -> float | None:
    return next((float(variable.attrs[key]) for key in _LIMITS if key in variable.attrs), None)


def low_passed(signal: FloatArray, interval: float, limit: float, *, repeats: bool) -> FloatArray:
    """Remove from a signal without mean what is above a frequency.

    Of a period nothing else changes: its lines above are left out. Any other signal goes through a symmetric filter,
    which passes up to the limit and attenuates by 100 dB from a tenth above it.

    Parameters
    ----------
    signal : ndarray, shape (n,)
    interval : float
        Time between its samples [s].
    limit : float
        Frequency [Hz].
    repeats : bool
        Whether the signal is a period.
    """
    if limit * interval >= 0.5:
        return signal
    if repeats:
        lines = np.fft.rfft(signal)
        lines[np.fft.rfftfreq(len(signal), interval) > limit * (1.0 + 1e-9)] = 0.0
        return np.asarray(np.fft.irfft(lines, len(signal)))
    from scipy.signal import firwin, kaiserord, oaconvolve

    half = 2.0 * interval  # of the sampling rate, as its inverse
    taps, beta = kaiserord(_ATTENUATION, _TRANSITION * limit * half)
    middle = min(limit * (1.0 + 0.5 * _TRANSITION) * half, 0.999)
    weights = firwin(taps | 1, middle, window=("kaiser", beta))
    return np.asarray(oaconvolve(signal, weights, mode="same"))


def _repeats(document: Document) -> bool:
    """Whether the record of a command holds whole turns of every shaft at steady speed."""
    return str(document.get("record", {}).get("spectra", {}).get("window")) == "uniform"


def periods(period: float, seconds: float, rate: int) -> int:
    """Return the number of periods of a sound that is as long as asked for, or longer where that closes it better.

    The end of the last period lies a fraction of a sample beside a sample. Of the numbers up to half as many again, the
    one with the smallest fraction is taken.

    Parameters
    ----------
    period : float
        Length of a period [s].
    seconds : float
        Least length [s].
    rate : int
        Sampling rate [Hz].
    """
    least = max(math.ceil(seconds / period - 1e-9), 1)
    apart = [
        abs(count * period * rate - round(count * period * rate)) for count in range(least, least + least // 2 + 1)
    ]
    # The first of those that are equal to a thousandth of a sample.
    return least + min(range(len(apart)), key=lambda place: round(apart[place], 3))


def repeated(signal: FloatArray, interval: float, rate: int, count: int) -> FloatArray:
    """Resample a signal, of which `count` periods follow each other; 0 for one that does not repeat.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        One period, or a record that does not repeat.
    interval : float
        Time between its samples [s].
    rate : int
        Sampling rate of the result [Hz].
    count : int
    """
    if count == 0:
        return resampled(signal, interval, rate)
    # The signal is extended on both sides by the reach of the filter, so that its ends are not heard.
    reach = math.ceil((_HALF_LENGTH + 1) * max(1.0 / rate, interval) / (len(signal) * interval))
    sound = resampled(np.tile(signal, count + 2 * reach), interval, rate)
    period = len(signal) * interval * rate
    first = round(reach * period)
    return np.ascontiguousarray(sound[first : first + round(count * period)])


def full_scale(peak: float) -> float:
    """Return the first of 1, 2, 5 by powers of ten that is not below a peak; 1 for silence."""
    if peak <= 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(peak))
    return next(float(f"{first * power:.1g}") for first in _FIRST_DIGITS if first * power >= peak)


def resampled(signal: FloatArray, interval: float, rate: int) -> FloatArray:
    """Resample a signal by polyphase filtering, with a Kaiser window of 100 dB against folding.

    Parameters
    ----------
    signal : ndarray, shape (n,)
    interval : float
        Time between its samples [s].
    rate : int
        Sampling rate of the result [Hz].

    References
    ----------
    A. V. Oppenheim, R. W. Schafer, Discrete-Time Signal Processing, 3rd ed., Pearson, 2010, sections 4.6 and 7.5.
    """
    from scipy.signal import firwin, kaiser_beta, resample_poly

    ratio = Fraction(rate * interval).limit_denominator(_RATIO_LIMIT)
    up, down = ratio.numerator, ratio.denominator
    if up == 0:
        raise ValueError(f"{rate} Hz is below a ten-thousandth of the signal's own rate, {1.0 / interval:.6g} Hz")
    widest = max(up, down)
    # The stubs of resample_poly know windows by name only; it takes the taps of a filter, too.
    taps: Any = firwin(2 * _HALF_LENGTH * widest + 1, 0.95 / widest, window=("kaiser", kaiser_beta(_ATTENUATION)))
    return np.asarray(resample_poly(signal, up, down, window=taps))


def _write_wav(path: Path, samples: npt.NDArray[np.float32], rate: int, comment: str) -> None:
    """Write a mono sound file in floating point with a comment.

    References
    ----------
    Multimedia Programming Interface and Data Specifications 1.0, IBM and Microsoft, 1991: RIFF WAVE, LIST INFO.
    """
    from scipy.io import wavfile

    wavfile.write(path, rate, samples)
    text = comment.encode("ascii", "replace") + b"\0"
    text += b"\0" * (len(text) % 2)
    info = b"INFO" + b"ICMT" + struct.pack("<I", len(text)) + text
    with path.open("r+b") as file:
        file.seek(0, 2)
        file.write(b"LIST" + struct.pack("<I", len(info)) + info)
        size = file.tell() - 8
        file.seek(4)
        file.write(struct.pack("<I", size))
