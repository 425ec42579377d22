"""Results of a sweep as one labelled dataset, and as a document."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine import __version__
from gearwhine.case import Case, SweptKey, dump_case
from gearwhine.coupling.linear.carriers.frozen_directions import FROZEN_CARRIER
from gearwhine.coupling.linear.line_mechanisms import MECHANISMS
from gearwhine.coupling.sweep.missed_peaks import MissedPeak, speeds_to_add
from gearwhine.numerics.arrays import FloatArray
from gearwhine.output.dataset import PHASE_CONVENTION
from gearwhine.output.quantity import Quantity, document_of
from gearwhine.results.operating_point import SWEPT_PAIR
from gearwhine.results.sound import SWEPT_LINE, SweptLine
from gearwhine.results.sweep import PEAK
from gearwhine.solutions import Failure
from gearwhine.sweep.grid import SweptPoint
from gearwhine.sweep.points import GridPoint, axis_name
from gearwhine.sweep.resolution import over_with, peak_warnings
from gearwhine.sweep.solution import POINTS, PointResult

if TYPE_CHECKING:
    import xarray as xr


_PEAKS = 10  # number of highest peaks of each sensor
_SAME_ORDER = 9  # decimals to which orders of one line agree

# Quantities of the points' documents, by key.
_POINT = (
    Quantity("speed_rpm", name="rotation_speed", long_name="speed of the first driver"),
    Quantity(
        "trusted_below_hz", name="trusted_limit", long_name="frequency up to which the housing's modes are complete"
    ),
    Quantity(
        "energy_error",
        name="energy_error",
        unit="1",
        long_name="part of the energy that is missing from the balance",
    ),
    Quantity("steps", name="steps", unit="1", long_name="time steps"),
)
_PEAK = (
    Quantity("frequency_hz", name="sensor_peak_frequency", long_name="frequency of the highest lines"),
    Quantity("amplitude_m_per_s2", name="sensor_peak_amplitude", long_name="peak amplitude of the highest lines"),
)
_MESH = (
    Quantity("mean_force_n", name="mesh_force_mean", long_name="mean gear-mesh force"),
    Quantity("peak_force_n", name="mesh_force_peak", long_name="largest gear-mesh force"),
    Quantity("mesh_frequency_hz", name="mesh_frequency", long_name="tooth-mesh frequency"),
    Quantity(
        "contact_loss_fraction",
        name="contact_loss",
        unit="1",
        long_name="part of the time in which the flanks are apart",
    ),
)
_SOUND = (
    Quantity("total_db", name="sound_power_level", long_name="sound power level of all lines re 1 pW"),
    Quantity("total_db_a", name="sound_power_level_a", long_name="A-weighted sound power level of all lines re 1 pW"),
)


def collected_sweep(
    case: Case | None,
    keys: Sequence[SweptKey],
    swept: Sequence[SweptPoint[GridPoint]],
    peaks: Sequence[MissedPeak] = (),
    title: str = "",
) -> xr.Dataset:
    """Collect every point of a sweep over its swept keys; NaN where a point failed or has no such line.

    Spectra stand over *order*, cycles for each turn of the first driver: records hold a number of its turns, so the
    lines of all speeds fall on each other without any interpolation. ``frequency`` has each point's in Hz. The title is
    that of the case, where there is one.
    """
    import xarray as xr

    names = tuple(axis_name(key.key) for key in keys)
    grid = _Grid(names, tuple(len(key.texts) for key in keys), swept)
    coordinates: dict[str, Any] = {
        name: (name, list(key.values), _unit(key.unit or ("1" if key.is_numeric else ""), key.key))
        for name, key in zip(names, keys, strict=True)
    }
    variables: dict[str, Any] = {}
    variables |= grid.quantities(_POINT, (), (), _entry)
    variables["done"] = (names, grid.filled(False, lambda outcome: isinstance(outcome, PointResult)), {})
    variables["failure"] = (names, grid.filled("", _failure), {"long_name": "why there is no result"})
    orders = _orders(grid.results())
    if orders.size:
        coordinates["order"] = ("order", orders, _unit("1", "cycles for each turn of the first driver"))
        turning = np.abs(np.asarray(variables["rotation_speed"][1])[..., None]) / 60.0
        coordinates["frequency"] = ((*names, "order"), turning * orders, _unit("Hz", "frequency of each order"))
    _add_sensors(grid, orders, variables, coordinates)
    _add_meshes(grid, orders, variables, coordinates)
    _add_bearings(grid, variables, coordinates)
    _add_operating_points(grid, variables, coordinates)
    _add_sound(grid, variables, coordinates)
    _add_missed_peaks(peaks, variables)
    modes = max((result.motion.housing_frequencies_hz.size for result in grid.results()), default=0)
    if modes:
        coordinates["housing_mode"] = ("housing_mode", np.arange(1, modes + 1), _unit("1", "number of the mode"))
        variables["housing_frequency"] = grid.rows(
            ("housing_mode",),
            (modes,),
            lambda result: _padded(result.motion.housing_frequencies_hz, modes),
            _unit("Hz", "housing natural frequency"),
        )
    attributes = {
        "title": title if case is None else case.title,
        "source": f"gearwhine {__version__}",
        **({} if case is None else {"case": dump_case(case)}),
        "amplitude_convention": "peak: the amplitude of a cosine a cos(2 pi f t + phase) is a",
        "phase_convention": PHASE_CONVENTION,
        "window": ", ".join(sorted({result.motion.window for result in grid.results()})),
    }
    return xr.Dataset(variables, coordinates, attributes)


def sweep_document(
    keys: Sequence[SweptKey], swept: Sequence[SweptPoint[GridPoint]], peaks: Sequence[MissedPeak] = ()
) -> dict[str, Any]:
    """Return a sweep as the command's JSON, with the peaks that lie between its points."""
    rows = []
    for swept_point in swept:
        values = {
            axis_name(key.key): key.values[place] for key, place in zip(keys, swept_point.point.place, strict=True)
        }
        row: dict[str, Any] = {
            "values": values,
            "settings": _settings(keys, swept_point),
            "resumed": swept_point.resumed,
        }
        if swept_point.point.file:
            row["file"] = f"{POINTS}/{swept_point.point.file}"
        if isinstance(swept_point.outcome, Failure):
            row |= {"status": "failed", "failure": swept_point.outcome.message}
            if swept_point.outcome.traceback:
                row["traceback"] = swept_point.outcome.traceback
        else:
            row |= {"status": "done"} | {
                key: value for key, value in swept_point.outcome.document.items() if key != "warnings"
            }
        rows.append(row)
    missed: dict[str, Any] = {"missed_peaks": [document_of(PEAK, peak) for peak in peaks]}
    if peaks:
        speeds = speeds_to_add(peaks)
        missed |= {"speeds_to_add_rpm": speeds, "over_with_peaks": over_with(keys, swept, speeds)}
    return {
        "axes": [
            {"key": key.key, "name": axis_name(key.key), "unit": key.unit, "values": list(key.values)} for key in keys
        ],
        "done": sum(row["status"] == "done" for row in rows),
        "failed": sum(row["status"] == "failed" for row in rows),
        "resumed": sum(row["resumed"] for row in rows),
        "points": rows,
        **missed,
        "warnings": [*_warnings(swept), *peak_warnings(peaks)],
    }


class _Grid:
    """Grid of the swept keys, which is filled point by point."""

    def __init__(self, names: tuple[str, ...], shape: tuple[int, ...], swept: Sequence[SweptPoint[GridPoint]]) -> None:
        self.names, self.shape, self.swept = names, shape, swept

    def results(self) -> list[PointResult]:
        return [swept_point.outcome for swept_point in self.swept if isinstance(swept_point.outcome, PointResult)]

    def rows(
        self,
        dimensions: tuple[str, ...],
        shape: tuple[int, ...],
        of: Callable[[PointResult], Any],
        attributes: dict[str, str],
    ) -> Any:
        """Return a variable with further dimensions, NaN where there is no result."""
        values = np.full((*self.shape, *shape), np.nan)
        for swept_point in self.swept:
            if isinstance(swept_point.outcome, PointResult):
                values[swept_point.point.place] = of(swept_point.outcome)
        return ((*self.names, *dimensions), values, attributes)

    def quantities(
        self,
        quantities: Sequence[Quantity],
        dimensions: tuple[str, ...],
        shape: tuple[int, ...],
        of: Callable[[str], Callable[[PointResult], Any]],
    ) -> dict[str, Any]:
        """Return the variables of quantities; ``of`` takes a key to the function that has its values of a point."""
        return {
            row.name: self.rows(dimensions, shape, of(row.key), _unit(row.file_unit, row.long_name))
            for row in quantities
        }

    def words(
        self,
        dimensions: tuple[str, ...],
        shape: tuple[int, ...],
        of: Callable[[PointResult], Sequence[str]],
        attributes: dict[str, str],
    ) -> Any:
        """Return a variable of texts with a further dimension, empty where there are fewer or is no result."""
        values = np.full((*self.shape, *shape), "", dtype=object)
        for swept_point in self.swept:
            if isinstance(swept_point.outcome, PointResult):
                texts = of(swept_point.outcome)
                values[swept_point.point.place][: len(texts)] = texts
        return ((*self.names, *dimensions), values.astype(str), attributes)

    def filled(self, start: Any, of: Callable[[PointResult | Failure], Any]) -> Any:
        values = np.full(self.shape, start, dtype=object if isinstance(start, str) else None)
        for swept_point in self.swept:
            values[swept_point.point.place] = of(swept_point.outcome)
        return values.astype(str) if isinstance(start, str) else values


def _add_sensors(grid: _Grid, orders: FloatArray, variables: dict[str, Any], coordinates: dict[str, Any]) -> None:
    names = _union(list(result.motion.sensor_spectra) for result in grid.results())
    if not names:
        return
    coordinates["sensor"] = ("sensor", names, {})
    coordinates["peak"] = ("peak", np.arange(1, _PEAKS + 1), _unit("1", "rank of the line, highest first"))

    def rms(result: PointResult) -> FloatArray:
        by_name = {sensor["name"]: sensor["rms_m_per_s2"] for sensor in result.document["sensors"]}
        return np.array([by_name.get(name, np.nan) for name in names], dtype=np.float64)

    def peaks(key: str) -> Callable[[PointResult], FloatArray]:
        def of(result: PointResult) -> FloatArray:
            by_name = {sensor["name"]: [peak[key] for peak in sensor["peaks"]] for sensor in result.document["sensors"]}
            return np.array([_padded(np.array(by_name.get(name, [])), _PEAKS) for name in names])

        return of

    within = "up to the trusted limit"
    variables["sensor_rms"] = grid.rows(
        ("sensor",), (len(names),), rms, _unit("m/s2", f"root mean square of acceleration {within}, without its mean")
    )
    variables["sensor_spectrum"] = grid.rows(
        ("sensor", "order"),
        (len(names), orders.size),
        lambda result: _on_orders(orders, result, result.motion.sensor_spectra, names),
        _unit("m/s2", f"peak amplitude of acceleration {within}"),
    )
    variables |= grid.quantities(_PEAK, ("sensor", "peak"), (len(names), _PEAKS), peaks)
    _add_mechanisms(grid, names, variables, coordinates)


def _add_mechanisms(grid: _Grid, names: Sequence[str], variables: dict[str, Any], coordinates: dict[str, Any]) -> None:
    """Add the amplitudes of the sensors' highest lines by what excites them; 0 where it does not excite a line."""
    lines = [
        line for result in grid.results() for sensor in result.document["sensors"] for line in sensor["peaks"][:_PEAKS]
    ]
    found = [name for name in MECHANISMS if any(name in line.get("parts", ()) for line in lines)]
    if not found:
        return
    coordinates["mechanism"] = ("mechanism", found, {})

    def parts(result: PointResult) -> FloatArray:
        by_sensor = {sensor["name"]: sensor["peaks"] for sensor in result.document["sensors"]}
        values = np.full((len(names), _PEAKS, len(found)), np.nan)
        for row, name in enumerate(names):
            for rank, line in enumerate(by_sensor.get(name, ())[:_PEAKS]):
                values[row, rank] = [line.get("parts", {}).get(mechanism, 0.0) for mechanism in found]
        return values

    long_name = "amplitude of the highest lines by each mechanism alone, linear about the mean load"
    shape = (len(names), _PEAKS, len(found))
    variables["sensor_peak_part"] = grid.rows(("sensor", "peak", "mechanism"), shape, parts, _unit("m/s2", long_name))


def _add_meshes(grid: _Grid, orders: FloatArray, variables: dict[str, Any], coordinates: dict[str, Any]) -> None:
    names = _union(list(result.motion.force_spectra) for result in grid.results())
    if not names:
        return
    coordinates["contact"] = ("contact", names, {})

    def figures(key: str) -> Callable[[PointResult], FloatArray]:
        def of(result: PointResult) -> FloatArray:
            # Pairs and the contacts of their drive flanks stand in one order.
            pairs = zip(result.motion.force_spectra, result.document["gear_pairs"], strict=True)
            by_name = {name: pair[key] for name, pair in pairs}
            return np.array([by_name.get(name, np.nan) for name in names], dtype=np.float64)

        return of

    variables |= grid.quantities(_MESH, ("contact",), (len(names),), figures)
    variables["mesh_force_spectrum"] = grid.rows(
        ("contact", "order"),
        (len(names), orders.size),
        lambda result: _on_orders(orders, result, result.motion.force_spectra, names),
        _unit("N", "peak amplitude of the gear-mesh force"),
    )


def _add_bearings(grid: _Grid, variables: dict[str, Any], coordinates: dict[str, Any]) -> None:
    names = _union(list(result.motion.bearing_force_mean) for result in grid.results())
    if not names:
        return
    coordinates["bearing"] = ("bearing", names, {})
    coordinates["axis"] = ("axis", ["x", "y", "z"], {})
    coordinates["moment_axis"] = ("moment_axis", ["x", "y"], {})
    missing = np.full(5, np.nan)

    def loads(group: str, parts: slice) -> Callable[[PointResult], FloatArray]:
        return lambda result: np.array([getattr(result.motion, group).get(name, missing)[parts] for name in names])

    for kind, axis, unit, parts in (("force", "axis", "N", slice(3)), ("moment", "moment_axis", "N m", slice(3, 5))):
        size = (len(names), parts.stop - (parts.start or 0))
        for mean, long_name in (
            ("mean", "mean {} of the shaft on its bearing"),
            ("rms", "rms of that {} without its mean"),
        ):
            of = loads(f"bearing_force_{mean}", parts)
            variables[f"bearing_{kind}_{mean}"] = grid.rows(
                ("bearing", axis), size, of, _unit(unit, long_name.format(kind))
            )


def _add_operating_points(grid: _Grid, variables: dict[str, Any], coordinates: dict[str, Any]) -> None:
    """Add misalignment and K_Hβ of every gear pair, and the bearing forces, of each point's equilibrium."""
    loads = [result.document["load"] for result in grid.results() if "load" in result.document]
    pairs = _union([_pair_name(pair) for pair in load["gear_pairs"]] for load in loads)
    bearings = _union([bearing["name"] for bearing in load["bearings"]] for load in loads)

    def of_pairs(key: str) -> Callable[[PointResult], FloatArray]:
        def of(result: PointResult) -> FloatArray:
            by_name = {_pair_name(pair): pair[key] for pair in result.document.get("load", {}).get("gear_pairs", ())}
            return np.array([by_name.get(name, np.nan) for name in pairs], dtype=np.float64)

        return of

    def forces(result: PointResult) -> FloatArray:
        by_name = {
            bearing["name"]: bearing["force_n"] for bearing in result.document.get("load", {}).get("bearings", ())
        }
        return np.array([by_name.get(name, [np.nan] * 3) for name in bearings])

    if pairs:
        coordinates["loaded_pair"] = ("loaded_pair", pairs, {})
        variables |= grid.quantities(SWEPT_PAIR, ("loaded_pair",), (len(pairs),), of_pairs)
    if bearings:
        coordinates |= {"loaded_bearing": ("loaded_bearing", bearings, {}), "axis": ("axis", ["x", "y", "z"], {})}
        attributes = _unit("N", "force of the shaft on its bearing at the operating point")
        variables["bearing_operating_force"] = grid.rows(
            ("loaded_bearing", "axis"), (len(bearings), 3), forces, attributes
        )


def _add_sound(grid: _Grid, variables: dict[str, Any], coordinates: dict[str, Any]) -> None:
    """Add sound power levels of every point, in all and of its loudest lines."""
    sounds = [result.document["sound"] for result in grid.results() if "sound" in result.document]
    if not sounds:
        return
    count = min(_PEAKS, max(len(sound["lines"]) for sound in sounds))
    coordinates["sound_line"] = ("sound_line", np.arange(1, count + 1), _unit("1", "rank of the line, loudest first"))

    def total(key: str) -> Callable[[PointResult], float]:
        return lambda result: result.document.get("sound", {}).get(key, np.nan)

    def rows(result: PointResult) -> list[dict[str, Any]]:
        lines = result.document.get("sound", {}).get("lines", ())[:count]
        return [document_of(SWEPT_LINE, SweptLine(line, result.motion.housing_frequencies_hz)) for line in lines]

    variables |= grid.quantities(_SOUND, (), (), total)

    def numbers(key: str) -> Callable[[PointResult], FloatArray]:
        return lambda result: _padded(np.array([row[key] for row in rows(result)], dtype=np.float64), count)

    def words(key: str) -> Callable[[PointResult], list[str]]:
        return lambda result: [str(row[key]) for row in rows(result)]

    along, size = ("sound_line",), (count,)
    variables |= grid.quantities([row for row in SWEPT_LINE if row.file_unit], along, size, numbers)
    for quantity in SWEPT_LINE:
        if not quantity.file_unit:
            variables[quantity.name] = grid.words(along, size, words(quantity.key), {"long_name": quantity.long_name})
    harmonics = _union([line["name"] for line in sound["lines"] if line["kind"] == "mesh"] for sound in sounds)
    if not harmonics:
        return

    def of_harmonics(result: PointResult) -> FloatArray:
        lines = result.document.get("sound", {}).get("lines", ())
        levels = {line["name"]: line["sound_power_db"] for line in lines}
        return np.array([levels.get(name, np.nan) for name in harmonics])

    coordinates["mesh_harmonic"] = ("mesh_harmonic", harmonics, {})
    long_name = "sound power level of each mesh harmonic re 1 pW; none where its part of the point's power is too small"
    variables["mesh_harmonic_level"] = grid.rows(
        ("mesh_harmonic",), (len(harmonics),), of_harmonics, _unit("dB", long_name)
    )


def _add_missed_peaks(peaks: Sequence[MissedPeak], variables: dict[str, Any]) -> None:
    """Add the peaks between the points of a sweep over speed, the one that rises most first."""
    if not peaks:
        return
    along = "missed_peak"
    for quantity in PEAK:
        if quantity.name:
            values = [quantity.value_of(peak) for peak in peaks]
            attributes = {"units": quantity.file_unit} if quantity.file_unit else {}
            variables[quantity.name] = (along, values, attributes | {"long_name": quantity.meaning_in(peaks[0])})


def _pair_name(pair: Mapping[str, Any]) -> str:
    return f"{pair['driver']} -> {pair['driven']}"


def _orders(results: Sequence[PointResult]) -> FloatArray:
    """Return every order at which some point has a line."""
    lines = [np.round(result.motion.orders, _SAME_ORDER) for result in results]
    return np.unique(np.concatenate(lines)) if lines else np.empty(0)


def _on_orders(
    orders: FloatArray, result: PointResult, spectra: Mapping[str, FloatArray], names: Sequence[str]
) -> FloatArray:
    rows = np.full((len(names), orders.size), np.nan)
    at = np.searchsorted(orders, np.round(result.motion.orders, _SAME_ORDER))
    for row, name in zip(rows, names, strict=True):
        if name in spectra:
            row[at] = spectra[name]
    return rows


def _padded(values: FloatArray, count: int) -> FloatArray:
    padded = np.full(count, np.nan)
    padded[: min(count, values.size)] = values[:count]
    return padded


def _union(lists: Any) -> list[str]:
    return list(dict.fromkeys(name for names in lists for name in names))


def _entry(key: str) -> Callable[[PointResult], float]:
    return lambda result: result.document[key]


def _failure(outcome: PointResult | Failure) -> str:
    return outcome.message if isinstance(outcome, Failure) else ""


def _settings(keys: Sequence[SweptKey], swept_point: SweptPoint[GridPoint]) -> dict[str, str]:
    return {key.key: text for key, text in zip(keys, swept_point.point.texts, strict=True)}


def _warnings(swept: Sequence[SweptPoint[GridPoint]]) -> list[dict[str, Any]]:
    """Warnings of the points' housings, each once; that of frozen carriers, whose figures follow the speed, too."""
    kept: dict[str, dict[str, Any]] = {}
    points: dict[str, int] = {}
    for swept_point in swept:
        if isinstance(swept_point.outcome, PointResult):
            for warning in swept_point.outcome.document.get("warnings", ()):
                frozen = warning["name"] == FROZEN_CARRIER
                key = " ".join([FROZEN_CARRIER, *warning["turning"]]) if frozen else warning["message"]
                kept.setdefault(key, warning)
                points[key] = points.get(key, 0) + frozen
    several = {key for key, count in points.items() if count > 1}
    return [
        one | {"message": f"{one['message']} (the first of {points[key]} points)"} if key in several else one
        for key, one in kept.items()
    ]


def _unit(unit: str, long_name: str) -> dict[str, str]:
    return {"units": unit, "long_name": long_name}
