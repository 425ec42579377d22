"""Gear pairs as the command's JSON: keys with their units, angles in rad, positions in base pitches."""

from typing import Any

import numpy as np
import numpy.typing as npt

import coupling.gears as room
from coupling.gears.gear_pair import LoadedGearPair
from gearwhine.stages.gear_analysis import PairAnalysis
from gearwhine.stages.gear_shapes import doubts, gear_document, path_document, relief_document
from gearwhine.stages.gears import backlash_doubts

FloatArray = npt.NDArray[np.float64]

_MOST_YIELDING = 0.1
"""In modules: what no teeth yield before they break."""


def gears_document(pairs: tuple[PairAnalysis, ...]) -> dict[str, Any]:
    """The gear pairs as the command's JSON."""
    warnings = [doubt for pair in pairs for doubt in _all_doubts(pair)]
    return {"pairs": [_pair_document(pair) for pair in pairs]} | ({"warnings": warnings} if warnings else {})


def _all_doubts(pair: PairAnalysis) -> list[dict[str, str]]:
    geometry = pair.solved.geometry
    return [*doubts(geometry), *backlash_doubts(pair.given, geometry), *_left_out(pair)]


def _pair_document(pair: PairAnalysis) -> dict[str, Any]:
    solved, geometry = pair.solved, pair.solved.geometry
    phases = solved.static.phases
    stiffness = room.mesh_stiffness(solved.contact, phases)
    return {
        "driver": solved.pair.driver,
        "driven": solved.pair.driven,
        "model": pair.given.stiffness.model,
        "contact_ratio": geometry.contact_ratio,
        "overlap_ratio": geometry.overlap_ratio,
        "total_contact_ratio": geometry.total_contact_ratio,
        "centre_distance_m": geometry.working_centre_distance,
        "working_pressure_angle_rad": geometry.working_pressure_angle,
        "backlash_m": solved.backlash,
        "mesh_frequency_hz": solved.mesh_frequency,
        "torque_n_m": solved.torque,
        "mean_force_n": solved.static.force,
        "gears": [
            gear_document(geometry, gear, wide=wide)
            for gear, wide in zip((geometry.driver, geometry.driven), pair.widths_given, strict=True)
        ],
        "path_of_contact": path_document(geometry),
        "stiffness_n_per_m": {
            "mean": solved.contact.mean_stiffness,
            "min": float(stiffness.min()),
            "max": float(stiffness.max()),
            "loaded_mean": solved.static.mean_stiffness,
        },
        "transmission_error_m": {
            "mean": solved.static.mean_transmission_error,
            "peak_to_peak": solved.static.peak_to_peak_transmission_error,
            "harmonics": pair.harmonics.tolist(),
            "unloaded_peak_to_peak": float(np.ptp(pair.unloaded)),
            "over_hunting_period": _over_hunting_period(solved),
        },
        "load_sharing": _load_sharing(pair),
        "contact_pressure_pa": _pressure(pair),
        "harris_map": None if pair.harris is None else _harris_map(geometry, pair.harris),
        "optimal_tip_relief": None if pair.optimum is None else _optimum(pair, pair.optimum),
        "roll_angle_rad": (2.0 * np.pi * phases / geometry.driver.teeth).tolist(),
        "stiffness": stiffness.tolist(),
        "loaded_stiffness": solved.static.tangent_stiffness.tolist(),
        "transmission_error": solved.static.transmission_error.tolist(),
        "unloaded_transmission_error": pair.unloaded.tolist(),
    }


def _left_out(pair: PairAnalysis) -> list[dict[str, str]]:
    """What the case has and the mesh at rest does not show, or cannot bear."""
    solved, geometry = pair.solved, pair.solved.geometry
    found = []
    for gear in (geometry.driver, geometry.driven):
        if gear.eccentricity > 0.0:
            message = (
                f"gear {gear.name!r}: its eccentricity adds {1e6 * gear.eccentricity:.4g} µm once per turn, either "
                "way, to the transmission error; the motion has it, the curves here are without it"
            )
            found.append({"name": "runout", "message": message})
    yielding = solved.static.mean_transmission_error - float(pair.unloaded.mean())
    if yielding > _MOST_YIELDING * geometry.driver.module:
        message = (
            f"{geometry.label}: the teeth yield {1e6 * yielding:.4g} µm under {solved.torque:.4g} N·m, "
            f"{yielding / geometry.driver.module:.2g} modules; none bear so much, and the model is of small deflections"
        )
        found.append({"name": "overload", "message": message})
    return found


def _over_hunting_period(solved: LoadedGearPair) -> dict[str, float] | None:
    if solved.hunting is None:
        return None
    return {
        "mean": solved.hunting.mean_transmission_error,
        "peak_to_peak": solved.hunting.peak_to_peak_transmission_error,
    }


def _load_sharing(pair: PairAnalysis) -> dict[str, Any] | None:
    """How many pairs carry for how long, and the part of the load that one has along its path."""
    static = pair.solved.static
    if static.force == 0.0 or not pair.solved.has_single_pairs:
        return None
    present = pair.solved.contact.pairs(static.phases).present
    order = np.argsort(static.positions[present], kind="stable")
    positions, shares = static.positions[present][order], static.load_shares[present][order]
    return {
        "pairs_in_contact": {str(count): part for count, part in pair.pairs_in_contact.items()},
        "loaded_contact_ratio": pair.loaded_contact_ratio,
        "largest_share": float(shares.max()),
        "corner_force_n": pair.corner_force,
        "position_base_pitches": positions.tolist(),
        "driver_roll_angle_rad": pair.solved.geometry.driver_roll_angle(positions).tolist(),
        "share": shares.tolist(),
    }


def _pressure(pair: PairAnalysis) -> dict[str, float | None] | None:
    """The largest pressure on the path of contact and where it is, and the largest at the pitch point."""
    if pair.pressure is None:
        return None
    geometry, faces = pair.solved.geometry, pair.solved.contact.faces
    positions = pair.solved.static.positions
    if faces is not None:
        positions = positions[..., None] + faces.shift
    known = np.nan_to_num(pair.pressure, nan=0.0, posinf=np.inf)
    place = np.unravel_index(int(known.argmax()), known.shape)
    return {
        "max": float(known[place]),
        "at_driver_roll_angle_rad": float(geometry.driver_roll_angle(positions[place])),
        "pitch_point": pair.pitch_pressure,
    }


def _harris_map(geometry: room.GearPairGeometry, harris: room.HarrisMap) -> dict[str, Any]:
    torques = harris.forces * geometry.driver.base_radius
    return {
        "torque_n_m": torques.tolist(),
        "peak_to_peak_m": harris.peak_to_peak.tolist(),
        "quietest_torque_n_m": harris.quietest * geometry.driver.base_radius,
    }


def _optimum(pair: PairAnalysis, optimum: room.ReliefOptimum) -> dict[str, Any]:
    """The relief that suits the torque, beside that of the case and none at all."""
    gears = pair.solved.geometry.driver, pair.solved.geometry.driven
    relief, given = optimum.relief, pair.given.relief_aim
    starts = (None if relief is None else relief_document(gear, relief)["start_roll_angle_rad"] for gear in gears)
    kind = "peak-to-peak" if given is None else "harmonics" if given.sensor is None else "sensor"
    unit = "m/s^2" if kind == "sensor" else "m"
    return {
        "aim": {
            "kind": kind,
            "sensor": None if given is None else given.sensor,
            "weights": None if given is None else {str(n): weight for n, weight in given.weights.items()},
            "unit": unit,
            "without_relief": float(optimum.value_unmodified[0]),
            "best": float(optimum.value[0]),
        },
        "shape": None if relief is None else relief.shape,
        "amount_m": 0.0 if relief is None else relief.amount,
        "length_m": None if relief is None else relief.length,
        **dict(zip(("driver_start_roll_angle_rad", "driven_start_roll_angle_rad"), starts, strict=True)),
        "torque_n_m": pair.solved.torque,
        "peak_to_peak_m": float(optimum.peak_to_peak[0]),
        "peak_to_peak_without_relief_m": float(optimum.unmodified[0]),
        "peak_to_peak_as_given_m": pair.as_given,
    }
